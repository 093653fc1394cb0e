"""Equations 11 to 16: the angular momentum, and the angular velocity of a rotation."""

from __future__ import annotations

from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture.symbols import BODY_OMEGA, RELATIVE_RATE, SPIN, f, statement

_MOMENTUM = "The angular momentum"
_VELOCITY = "The angular velocity of a rotation"

STATEMENTS: tuple[Statement, ...] = (
    statement(
        11,
        "momentum_splits",
        _MOMENTUM,
        (
            "The angular momentum of the body is the sum of ",
            f(r"\mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i)", "rᵢ × (mᵢ ṙᵢ)"),
            " over its particles. With ",
            f(r"\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i", "rᵢ = r_C + xᵢ"),
            " the mixed terms sum to nothing again, and it has two parts,",
        ),
        (
            f(r"\mathbf{L}", "L"),
            f(r"\mathbf{L}_C + \mathbf{L}_R", "L_C + L_R"),
        ),
        (
            "no_mixed_momentum",
            f(
                r"\sum_i m_i(\mathbf{r}_C\times\dot{\mathbf{x}}_i + "
                r"\mathbf{x}_i\times\dot{\mathbf{r}}_C) = \mathbf{0}",
                "Σ mᵢ (r_C × ẋᵢ + xᵢ × ṙ_C) = 0",
            ),
        ),
        place="section 3.1",
    ),
    statement(
        12,
        "parts_of_the_momentum",
        _MOMENTUM,
        ("These are the momentum of the mass in its centre and that of the motion about it:",),
        (
            f(
                r"\mathbf{L}_C = \mathbf{r}_C\times(M\dot{\mathbf{r}}_C), \qquad \mathbf{L}_R",
                "L_C = r_C × (M ṙ_C), L_R",
            ),
            f(r"\sum_i \mathbf{x}_i\times(m_i\dot{\mathbf{x}}_i)", "Σ xᵢ × (mᵢ ẋᵢ)"),
        ),
        (
            "momentum_splits",
            f(
                r"\sum_i \mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i) = \mathbf{L}_C + \mathbf{L}_R",
                "Σ rᵢ × (mᵢ ṙᵢ) = L_C + L_R",
            ),
        ),
        place="section 3.1",
    ),
    statement(
        13,
        "momentum_of_rotation",
        _MOMENTUM,
        (
            "With (3) the second part is linear in the angular velocity, and the tensor is that "
            "of (4):",
        ),
        (
            f(r"\mathbf{L}_R", "L_R"),
            f(r"\mathbf{I}\,\boldsymbol{\Omega}", "I Ω"),
        ),
        (
            "momentum_is_linear",
            f(
                r"\sum_i m_i\,\mathbf{x}_i\times(\boldsymbol{\Omega}\times\mathbf{x}_i) = "
                r"\mathbf{I}\,\boldsymbol{\Omega}",
                "Σ mᵢ xᵢ × (Ω × xᵢ) = I Ω",
            ),
        ),
        (
            "twice_the_energy",
            f(
                r"\mathbf{L}_R\cdot\boldsymbol{\Omega} = \sum_i m_i|\dot{\mathbf{x}}_i|^2 = 2E_R",
                "L_R·Ω = Σ mᵢ |ẋᵢ|² = 2 E_R",
            ),
        ),
        place="section 3.1",
    ),
    statement(
        14,
        "momentum_in_principal_axes",
        _MOMENTUM,
        ("In principal axes each component has a factor of its own,",),
        (
            f(
                r"L_{R,1} = I_{11}\Omega_1, \qquad L_{R,2} = I_{22}\Omega_2, \qquad L_{R,3}",
                "L_R,1 = I₁₁ Ω₁, L_R,2 = I₂₂ Ω₂, L_R,3",
            ),
            f(r"I_{33}\Omega_3", "I₃₃ Ω₃"),
        ),
        (
            "components_of_momentum",
            f(
                r"(\mathbf{I}\,\boldsymbol{\Omega})_k = I_{kk}\Omega_k",
                "(I Ω)_k = I_kk Ω_k",
            ),
        ),
        place="section 3.1",
    ),
    statement(
        15,
        "velocity_by_the_rotation",
        _VELOCITY,
        (
            "Let coordinates ",
            f(r"\mathbf{q}(t)", "q(t)"),
            " say how the body has turned from where its principal axes lay along the basis, ",
            f(r"\mathbf{x}_i = \mathbf{R}(\mathbf{q}(t))\,\mathbf{x}'_i", "xᵢ = R(q(t)) x′ᵢ"),
            ". Then",
        ),
        (
            RELATIVE_RATE,
            f(r"\frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i", "dR/dt x′ᵢ"),
            f(r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}\,\mathbf{x}_i", "dR/dt·Rᵀ xᵢ"),
        ),
        (
            "velocity",
            f(
                r"\frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i = "
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}\,\mathbf{R}\,\mathbf{x}'_i",
                "dR/dt x′ᵢ = dR/dt·Rᵀ R x′ᵢ",
            ),
        ),
        (
            "operator",
            f(
                r"\mathbf{C}(\mathbf{u})\,\mathbf{v} = \mathbf{u}\times\mathbf{v}",
                "C(u) v = u × v",
            ),
        ),
        place="section 3.2",
    ),
    statement(
        16,
        "angular_velocity_of_the_rotation",
        _VELOCITY,
        (
            "Beside (3) this says that ",
            SPIN,
            " is the matrix ",
            f(r"\mathbf{C}(\boldsymbol{\Omega})", "C(Ω)"),
            " of ",
            f(r"\boldsymbol{\Omega}\times", "Ω ×"),
            ". Its vector, which ",
            f(r"\mathbf{C}^{-1}", "C⁻¹"),
            " takes from the entries below the diagonal, has space components; along the axes of "
            "the body, by (7),",
        ),
        (
            BODY_OMEGA,
            f(
                r"\mathbf{R}^{\mathsf T}\,\mathbf{C}^{-1}\left(\frac{d\mathbf{R}}{dt}"
                r"\mathbf{R}^{\mathsf T}\right)",
                "Rᵀ C⁻¹(dR/dt·Rᵀ)",
            ),
        ),
        (
            "spin",
            f(
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T} = \mathbf{C}(\boldsymbol{\Omega})",
                "dR/dt·Rᵀ = C(Ω)",
            ),
        ),
        (
            "body_spin",
            f(
                r"\mathbf{R}^{\mathsf T}\frac{d\mathbf{R}}{dt} = \mathbf{C}(\boldsymbol{\Omega}')",
                "Rᵀ·dR/dt = C(Ω′)",
            ),
        ),
        place="section 3.2",
    ),
)
