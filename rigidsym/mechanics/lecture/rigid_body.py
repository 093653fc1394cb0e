"""Equations 1 to 4: the centre of mass, the kinetic energy, the inertia tensor."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture.symbols import (
    AT_REST,
    CENTRE,
    MASS,
    MASSES,
    NO_MOMENT,
    NO_MOMENTUM,
    OMEGA,
    PLACE,
    RELATIVE,
    RELATIVE_RATE,
    SPIN,
    statement,
)

_KINETIC = "The centre of mass and the kinetic energy"
_TENSOR = "The inertia tensor"

STATEMENTS: tuple[Statement, ...] = (
    statement(
        1,
        "centre_of_mass",
        _KINETIC,
        (
            "A rigid body is a set of particles with masses ",
            MASS,
            " at places ",
            PLACE,
            ", ",
            MASSES,
            ". Their mean, weighted by the masses, is the centre of mass",
        ),
        (CENTRE, formula(r"\frac{1}{M}\sum_i m_i\,\mathbf{r}_i")),
        (
            "no_moment",
            formula(r"\sum_i m_i(\mathbf{r}_i - \mathbf{r}_C) = \mathbf{0}"),
        ),
        (
            "no_momentum",
            formula(r"\sum_i m_i(\dot{\mathbf{r}}_i - \dot{\mathbf{r}}_C) = \mathbf{0}"),
        ),
        place="section 1.1",
    ),
    statement(
        2,
        "energy_splits",
        _KINETIC,
        (
            "Seen from there a particle is at ",
            RELATIVE,
            ", where ",
            formula(r"\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i"),
            ". So ",
            NO_MOMENT,
            " at all times, and ",
            NO_MOMENTUM,
            ": when the velocities are squared, the cross term vanishes, and the energy splits "
            "into that of the total mass moving with the centre of mass and that of the motion "
            "about it,",
        ),
        (
            formula("E_K"),
            formula("E_C + E_R"),
            formula(
                r"\frac{1}{2}M|\dot{\mathbf{r}}_C|^2 + \frac{1}{2}\sum_i m_i|\dot{\mathbf{x}}_i|^2"
            ),
        ),
        (
            "no_mixed_energy",
            formula(r"\sum_i m_i\,\dot{\mathbf{x}}_i\cdot\dot{\mathbf{r}}_C = 0"),
        ),
        (
            "energy_splits",
            formula(r"\frac{1}{2}\sum_i m_i|\dot{\mathbf{r}}_i|^2 = E_C + E_R"),
        ),
        place="section 1.1",
    ),
    statement(
        3,
        "velocity_of_particles",
        _TENSOR,
        (
            "The particles keep their distances, so that by Euler's theorem the motion about the "
            "centre of mass is a rotation, ",
            formula(r"\mathbf{x}_i = \mathbf{R}\,\mathbf{x}'_i"),
            " with ",
            AT_REST,
            " at rest. The derivative of ",
            formula(r"\mathbf{R}\mathbf{R}^{\mathsf T} = \mathbf{1}"),
            " says that ",
            SPIN,
            " is skew. A skew matrix is a cross product; its vector is the angular velocity ",
            OMEGA,
            ", and",
        ),
        (RELATIVE_RATE, formula(r"\boldsymbol{\Omega}\times\mathbf{x}_i")),
        (
            "skew",
            formula(
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T} + \mathbf{R}"
                r"\frac{d\mathbf{R}^{\mathsf T}}{dt} = \mathbf{0}"
            ),
        ),
        (
            "turning",
            formula(
                r"\frac{d\mathbf{R}}{dt}\mathbf{x}'_i = \boldsymbol{\Omega}"
                r"\times\mathbf{R}\mathbf{x}'_i"
            ),
        ),
        place="section 1.2",
    ),
    statement(
        4,
        "inertia_of_particles",
        _TENSOR,
        (
            "With ",
            formula(r"\boldsymbol{\Omega} = \sum_j \Omega_j\mathbf{e}_j"),
            " in any orthonormal basis, ",
            formula(r"E_R = \frac{1}{2}\sum_i m_i|\boldsymbol{\Omega}\times\mathbf{x}_i|^2"),
            " is a quadratic form, ",
            formula(
                r"E_R = \frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}\,\boldsymbol{\Omega}"
            ),
            ". Its coefficients form the inertia tensor, which depends on the mass distribution "
            "only through its second moments:",
        ),
        (
            formula("I_{jk}"),
            formula(
                r"\sum_i m_i(\mathbf{e}_j\times\mathbf{x}_i)\cdot(\mathbf{e}_k\times\mathbf{x}_i)"
            ),
        ),
        (
            "energy_is_a_form",
            formula(
                r"\frac{1}{2}\sum_i m_i|\boldsymbol{\Omega}\times\mathbf{x}_i|^2 = "
                r"\frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}"
                r"\,\boldsymbol{\Omega}"
            ),
        ),
        ("symmetric", formula(r"\mathbf{I}^{\mathsf T} = \mathbf{I}")),
        place="section 1.2",
    ),
)
