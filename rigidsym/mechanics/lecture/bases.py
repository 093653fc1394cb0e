"""Equations 5 to 10: change of basis, moments of inertia, principal axes."""

from __future__ import annotations

from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture.symbols import BODY_INERTIA, INERTIA, OMEGA, R, f, statement

_BASIS = "Another basis"
_MOMENTS = "Moments of inertia"
_PRINCIPAL = "Principal axes"

STATEMENTS: tuple[Statement, ...] = (
    statement(
        5,
        "components_in_another_basis",
        _BASIS,
        (
            "A rotation ",
            R,
            " takes the basis to another, ",
            f(r"\mathbf{e}'_j = \mathbf{R}\,\mathbf{e}_j", "e′_j = R e_j"),
            ". The components of ",
            OMEGA,
            " there are its products with the new vectors,",
        ),
        (
            f(r"\Omega'_j", "Ω′_j"),
            f(r"\boldsymbol{\Omega}\cdot\mathbf{e}'_j", "Ω·e′_j"),
            f(r"\boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j", "Ω·R e_j"),
        ),
        (
            "keeps_products",
            f(
                r"\mathbf{u}\cdot\mathbf{v} = \mathbf{R}\mathbf{u}\cdot\mathbf{R}\mathbf{v}",
                "u·v = R u·R v",
            ),
        ),
        place="section 2.1",
    ),
    statement(
        6,
        "rotation_goes_over",
        _BASIS,
        (
            "A rotation keeps products, and so it can be moved from one factor to the other, "
            "where it becomes its inverse:",
        ),
        (
            f(r"\Omega'_j", "Ω′_j"),
            f(r"\mathbf{R}^{-1}\boldsymbol{\Omega}\cdot\mathbf{e}_j", "R⁻¹ Ω·e_j"),
        ),
        (
            "goes_over",
            f(
                r"\mathbf{R}^{-1}\mathbf{u}\cdot\mathbf{v} = \mathbf{u}\cdot\mathbf{R}\mathbf{v}",
                "R⁻¹ u·v = u·R v",
            ),
        ),
        (
            "components",
            f(
                r"\boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j = "
                r"\mathbf{R}^{-1}\boldsymbol{\Omega}\cdot\mathbf{e}_j",
                "Ω·R e_j = R⁻¹ Ω·e_j",
            ),
        ),
        place="section 2.1",
    ),
    statement(
        7,
        "angular_velocity_turns",
        _BASIS,
        ("In one line, for all three components,",),
        (
            f(
                r"\boldsymbol{\Omega}' = \mathbf{R}^{-1}\boldsymbol{\Omega} "
                r"\quad\Leftrightarrow\quad \boldsymbol{\Omega}",
                "Ω′ = R⁻¹ Ω ⇔ Ω",
            ),
            f(r"\mathbf{R}\,\boldsymbol{\Omega}'", "R Ω′"),
        ),
        (
            "inverse",
            f(r"\mathbf{R}^{-1} = \mathbf{R}^{\mathsf T}", "R⁻¹ = Rᵀ"),
        ),
        (
            "and_back",
            f(
                r"\mathbf{R}(\mathbf{R}^{-1}\boldsymbol{\Omega}) = \boldsymbol{\Omega}",
                "R (R⁻¹ Ω) = Ω",
            ),
        ),
        place="section 2.1",
    ),
    statement(
        8,
        "energy_in_another_basis",
        _BASIS,
        ("The energy is a number and does not depend on the basis; by (7)",),
        (
            f("E_R", "E_R"),
            f(
                r"\frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}\,\boldsymbol{\Omega}",
                "½ Ωᵀ I Ω",
            ),
            f(
                r"\frac{1}{2}\boldsymbol{\Omega}'^{\mathsf T}\mathbf{R}^{\mathsf T}\mathbf{I}\,"
                r"\mathbf{R}\,\boldsymbol{\Omega}'",
                "½ Ω′ᵀ Rᵀ I R Ω′",
            ),
        ),
        (
            "same_energy",
            f(
                r"(\mathbf{R}\boldsymbol{\Omega}')^{\mathsf T}\mathbf{I}\,\mathbf{R}"
                r"\boldsymbol{\Omega}' = \boldsymbol{\Omega}'^{\mathsf T}\mathbf{R}^{\mathsf T}"
                r"\mathbf{I}\,\mathbf{R}\,\boldsymbol{\Omega}'",
                "(R Ω′)ᵀ I R Ω′ = Ω′ᵀ Rᵀ I R Ω′",
            ),
        ),
        place="section 2.1",
    ),
    statement(
        9,
        "inertia_turns",
        _BASIS,
        (
            "The matrix in the middle is therefore the inertia tensor in the new basis. It is also "
            "what (4) gives for the places ",
            f(r"\mathbf{x}'_i = \mathbf{R}^{-1}\mathbf{x}_i", "x′ᵢ = R⁻¹ xᵢ"),
            " seen from there:",
        ),
        (
            BODY_INERTIA,
            f(r"\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R}", "Rᵀ I R"),
        ),
        (
            "tensor_turns",
            f(
                r"\mathbf{R}^{\mathsf T}\,\mathbf{I}(\mathbf{R}\mathbf{x}'_i)\,\mathbf{R} = "
                r"\mathbf{I}(\mathbf{x}'_i)",
                "Rᵀ I(R x′ᵢ) R = I(x′ᵢ)",
            ),
        ),
        place="section 2.1",
    ),
    statement(
        None,
        "entries_of_inertia",
        _MOMENTS,
        (
            "With ",
            f(r"\mathbf{x}_i = (a_i, b_i, c_i)", "xᵢ = (aᵢ, bᵢ, cᵢ)"),
            " and the product of two cross products, (4) is",
        ),
        (INERTIA,),
        (
            "lagrange",
            f(
                r"(\mathbf{u}\times\mathbf{v})\cdot(\mathbf{w}\times\boldsymbol{\Omega}) = "
                r"(\mathbf{u}\cdot\mathbf{w})(\mathbf{v}\cdot\boldsymbol{\Omega}) - "
                r"(\mathbf{u}\cdot\boldsymbol{\Omega})(\mathbf{v}\cdot\mathbf{w})",
                "(u × v)·(w × Ω) = (u·w)(v·Ω) − (u·Ω)(v·w)",
            ),
        ),
        (
            "entries",
            f(
                r"\mathbf{I} = \sum_i m_i\bigl((\mathbf{x}_i\cdot\mathbf{x}_i)\mathbf{1} - "
                r"\mathbf{x}_i\mathbf{x}_i^{\mathsf T}\bigr)",
                "I = Σ mᵢ ((xᵢ·xᵢ) 1 − xᵢ xᵢᵀ)",
            ),
        ),
        place="section 2.2",
        shows_summands=True,
    ),
    statement(
        None,
        "moment_about_a_line",
        _MOMENTS,
        (
            "The moment of inertia about a line sums the masses times the squares of their "
            "distances ",
            f(r"d^{\perp}_i", "d⊥ᵢ"),
            " from it. For the line through the centre of mass along a unit vector ",
            f(r"\mathbf{e}", "e"),
            " the tensor gives it at once; for a vector of the basis it is an entry of the "
            "diagonal. The other entries are the products of inertia.",
        ),
        (
            f("I", "I"),
            f(r"\sum_i m_i(d^{\perp}_i)^2", "Σ mᵢ (d⊥ᵢ)²"),
            f(r"\mathbf{e}^{\mathsf T}\mathbf{I}\,\mathbf{e}", "eᵀ I e"),
        ),
        (
            "about_a_line",
            f(
                r"\sum_i m_i|\mathbf{x}_i - (\mathbf{x}_i\cdot\mathbf{e})\mathbf{e}|^2 = "
                r"\mathbf{e}^{\mathsf T}\mathbf{I}\,\mathbf{e}",
                "Σ mᵢ |xᵢ − (xᵢ·e) e|² = eᵀ I e",
            ),
        ),
        place="section 2.2",
    ),
    statement(
        10,
        "energy_in_principal_axes",
        _PRINCIPAL,
        (
            "The tensor is real and symmetric, and so there is a rotation that makes it diagonal; "
            "this theorem of linear algebra is used here, and not proved. The new axes are the "
            "principal axes of the body, the entries the principal moments. With the components "
            "of ",
            OMEGA,
            " along these axes,",
        ),
        (
            f("E_R", "E_R"),
            f(
                r"\frac{1}{2}\bigl[I'_{11}\Omega_1^2 + I'_{22}\Omega_2^2 + I'_{33}\Omega_3^2\bigr]",
                "½ [I′₁₁ Ω₁² + I′₂₂ Ω₂² + I′₃₃ Ω₃²]",
            ),
        ),
        (
            "stays_symmetric",
            f(
                r"(\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R})^{\mathsf T} = "
                r"\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R}",
                "(Rᵀ I R)ᵀ = Rᵀ I R",
            ),
        ),
        (
            "energy_in_principal_axes",
            f(
                r"\boldsymbol{\Omega}'^{\mathsf T}\mathbf{I}'\,\boldsymbol{\Omega}' = "
                r"\sum_k I'_{kk}\Omega_k^2",
                "Ω′ᵀ I′ Ω′ = Σ I′_kk Ω_k²",
            ),
        ),
        place="section 2.3",
    ),
)
