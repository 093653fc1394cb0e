"""Equations 11 to 16: the angular momentum, and the angular velocity of a rotation."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture.symbols import BODY_OMEGA, RELATIVE_RATE, SPIN, statement

_MOMENTUM = "The angular momentum"
_VELOCITY = "The angular velocity of a rotation"

STATEMENTS: tuple[Statement, ...] = (
    statement(
        11,
        "momentum_splits",
        _MOMENTUM,
        (
            "The angular momentum of the body is the sum of ",
            formula(r"\mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i)"),
            " over its particles. With ",
            formula(r"\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i"),
            " the cross terms vanish again, and it has two parts,",
        ),
        (
            formula(r"\mathbf{L}"),
            formula(r"\mathbf{L}_C + \mathbf{L}_R"),
        ),
        (
            "no_mixed_momentum",
            formula(
                r"\sum_i m_i(\mathbf{r}_C\times\dot{\mathbf{x}}_i + "
                r"\mathbf{x}_i\times\dot{\mathbf{r}}_C) = \mathbf{0}"
            ),
        ),
        place="section 3.1",
    ),
    statement(
        12,
        "parts_of_the_momentum",
        _MOMENTUM,
        ("These are the angular momentum of the centre-of-mass motion and that of the rotation:",),
        (
            formula(r"\mathbf{L}_C = \mathbf{r}_C\times(M\dot{\mathbf{r}}_C), \qquad \mathbf{L}_R"),
            formula(r"\sum_i \mathbf{x}_i\times(m_i\dot{\mathbf{x}}_i)"),
        ),
        (
            "momentum_splits",
            formula(
                r"\sum_i \mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i) = \mathbf{L}_C + \mathbf{L}_R"
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
            formula(r"\mathbf{L}_R"),
            formula(r"\mathbf{I}\,\boldsymbol{\Omega}"),
        ),
        (
            "momentum_is_linear",
            formula(
                r"\sum_i m_i\,\mathbf{x}_i\times(\boldsymbol{\Omega}"
                r"\times\mathbf{x}_i) = \mathbf{I}\,\boldsymbol{\Omega}"
            ),
        ),
        (
            "twice_the_energy",
            formula(
                r"\mathbf{L}_R\cdot\boldsymbol{\Omega} = \sum_i m_i|\dot{\mathbf{x}}_i|^2 = 2E_R"
            ),
        ),
        place="section 3.1",
    ),
    statement(
        14,
        "momentum_in_principal_axes",
        _MOMENTUM,
        ("In the principal-axis frame the components are simply",),
        (
            formula(r"L_{R,1} = I_{11}\Omega_1, \qquad L_{R,2} = I_{22}\Omega_2, \qquad L_{R,3}"),
            formula(r"I_{33}\Omega_3"),
        ),
        (
            "components_of_momentum",
            formula(r"(\mathbf{I}\,\boldsymbol{\Omega})_k = I_{kk}\Omega_k"),
        ),
        place="section 3.1",
    ),
    statement(
        15,
        "velocity_by_the_rotation",
        _VELOCITY,
        (
            "Let coordinates ",
            formula(r"\mathbf{q}(t)"),
            " describe the orientation relative to a reference orientation in which the principal "
            "axes coincide with the basis, ",
            formula(r"\mathbf{x}_i = \mathbf{R}(\mathbf{q}(t))\,\mathbf{x}'_i"),
            ". Then",
        ),
        (
            RELATIVE_RATE,
            formula(r"\frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i"),
            formula(r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}\,\mathbf{x}_i"),
        ),
        (
            "velocity",
            formula(
                r"\frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i = \frac{d\mathbf{R}}{dt}"
                r"\mathbf{R}^{\mathsf T}\,\mathbf{R}\,\mathbf{x}'_i"
            ),
        ),
        (
            "operator",
            formula(r"\mathbf{C}(\mathbf{u})\,\mathbf{v} = \mathbf{u}\times\mathbf{v}"),
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
            formula(r"\mathbf{C}(\boldsymbol{\Omega})"),
            " of ",
            formula(r"\boldsymbol{\Omega}\times"),
            ". Its vector, which ",
            formula(r"\mathbf{C}^{-1}"),
            " takes from the entries below the diagonal, has space components; along the axes of "
            "the body, by (7),",
        ),
        (
            BODY_OMEGA,
            formula(
                r"\mathbf{R}^{\mathsf T}\,\mathbf{C}^{-1}\left(\frac{d\mathbf{R}}{dt}"
                r"\mathbf{R}^{\mathsf T}\right)"
            ),
        ),
        (
            "spin",
            formula(
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T} = \mathbf{C}(\boldsymbol{\Omega})"
            ),
        ),
        (
            "body_spin",
            formula(
                r"\mathbf{R}^{\mathsf T}\frac{d\mathbf{R}}{dt} = \mathbf{C}(\boldsymbol{\Omega}')"
            ),
        ),
        place="section 3.2",
    ),
)
