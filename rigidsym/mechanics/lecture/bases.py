"""Equations 5 to 10: change of basis, moments of inertia, principal axes."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture.symbols import BODY_INERTIA, INERTIA, OMEGA, R, statement

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
            formula(r"\mathbf{e}'_j = \mathbf{R}\,\mathbf{e}_j"),
            ". The components of ",
            OMEGA,
            " there are its products with the new vectors,",
        ),
        (
            formula(r"\Omega'_j"),
            formula(r"\boldsymbol{\Omega}\cdot\mathbf{e}'_j"),
            formula(r"\boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j"),
        ),
        (
            "keeps_products",
            formula(r"\mathbf{u}\cdot\mathbf{v} = \mathbf{R}\mathbf{u}\cdot\mathbf{R}\mathbf{v}"),
        ),
        place="section 2.1",
    ),
    statement(
        6,
        "rotation_goes_over",
        _BASIS,
        (
            "Rotations preserve scalar products; moved from one factor to the other, a rotation "
            "becomes its inverse:",
        ),
        (
            formula(r"\Omega'_j"),
            formula(r"\mathbf{R}^{-1}\boldsymbol{\Omega}\cdot\mathbf{e}_j"),
        ),
        (
            "goes_over",
            formula(
                r"\mathbf{R}^{-1}\mathbf{u}\cdot\mathbf{v} = \mathbf{u}\cdot\mathbf{R}\mathbf{v}"
            ),
        ),
        (
            "components",
            formula(
                r"\boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j = \mathbf{R}^{-1}"
                r"\boldsymbol{\Omega}\cdot\mathbf{e}_j"
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
            formula(
                r"\boldsymbol{\Omega}' = \mathbf{R}^{-1}\boldsymbol{\Omega} "
                r"\quad\Leftrightarrow\quad \boldsymbol{\Omega}"
            ),
            formula(r"\mathbf{R}\,\boldsymbol{\Omega}'"),
        ),
        (
            "inverse",
            formula(r"\mathbf{R}^{-1} = \mathbf{R}^{\mathsf T}"),
        ),
        (
            "and_back",
            formula(r"\mathbf{R}(\mathbf{R}^{-1}\boldsymbol{\Omega}) = \boldsymbol{\Omega}"),
        ),
        place="section 2.1",
    ),
    statement(
        8,
        "energy_in_another_basis",
        _BASIS,
        ("The energy is a number and does not depend on the basis; by (7)",),
        (
            formula("E_R"),
            formula(r"\frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}\,\boldsymbol{\Omega}"),
            formula(
                r"\frac{1}{2}\boldsymbol{\Omega}'^{\mathsf T}\mathbf{R}^{\mathsf T}"
                r"\mathbf{I}\,\mathbf{R}\,\boldsymbol{\Omega}'"
            ),
        ),
        (
            "same_energy",
            formula(
                r"(\mathbf{R}\boldsymbol{\Omega}')^{\mathsf T}\mathbf{I}\,\mathbf{R}"
                r"\boldsymbol{\Omega}' = \boldsymbol{\Omega}'^{\mathsf T}"
                r"\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R}\,\boldsymbol{\Omega}'"
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
            formula(r"\mathbf{x}'_i = \mathbf{R}^{-1}\mathbf{x}_i"),
            " seen from there:",
        ),
        (
            BODY_INERTIA,
            formula(r"\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R}"),
        ),
        (
            "tensor_turns",
            formula(
                r"\mathbf{R}^{\mathsf T}\,\mathbf{I}(\mathbf{R}\mathbf{x}'_i)"
                r"\,\mathbf{R} = \mathbf{I}(\mathbf{x}'_i)"
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
            formula(r"\mathbf{x}_i = (a_i, b_i, c_i)"),
            " and the product of two cross products, (4) is",
        ),
        (INERTIA,),
        (
            "lagrange",
            formula(
                r"(\mathbf{u}\times\mathbf{v})\cdot(\mathbf{w}"
                r"\times\boldsymbol{\Omega}) = (\mathbf{u}\cdot\mathbf{w})(\mathbf{v}"
                r"\cdot\boldsymbol{\Omega}) - (\mathbf{u}"
                r"\cdot\boldsymbol{\Omega})(\mathbf{v}\cdot\mathbf{w})"
            ),
        ),
        (
            "entries",
            formula(
                r"\mathbf{I} = \sum_i m_i\bigl((\mathbf{x}_i\cdot\mathbf{x}_i)"
                r"\mathbf{1} - \mathbf{x}_i\mathbf{x}_i^{\mathsf T}\bigr)"
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
            formula(r"d^{\perp}_i"),
            " from it. For the line through the centre of mass along a unit vector ",
            formula(r"\mathbf{e}"),
            " the tensor gives it at once; for a vector of the basis it is an entry of the "
            "diagonal. The other entries are the products of inertia.",
        ),
        (
            formula("I"),
            formula(r"\sum_i m_i(d^{\perp}_i)^2"),
            formula(r"\mathbf{e}^{\mathsf T}\mathbf{I}\,\mathbf{e}"),
        ),
        (
            "about_a_line",
            formula(
                r"\sum_i m_i|\mathbf{x}_i - (\mathbf{x}_i\cdot\mathbf{e})"
                r"\mathbf{e}|^2 = \mathbf{e}^{\mathsf T}\mathbf{I}\,\mathbf{e}"
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
            formula("E_R"),
            formula(
                r"\frac{1}{2}\bigl[I'_{11}\Omega_1^2 + I'_{22}\Omega_2^2 + I'_{33}\Omega_3^2\bigr]"
            ),
        ),
        (
            "stays_symmetric",
            formula(
                r"(\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R})^{\mathsf T} = "
                r"\mathbf{R}^{\mathsf T}\mathbf{I}\,\mathbf{R}"
            ),
        ),
        (
            "energy_in_principal_axes",
            formula(
                r"\boldsymbol{\Omega}'^{\mathsf T}\mathbf{I}'\,\boldsymbol{\Omega}' = "
                r"\sum_k I'_{kk}\Omega_k^2"
            ),
        ),
        place="section 2.3",
    ),
)
