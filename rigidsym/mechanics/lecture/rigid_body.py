"""Equations 1 to 4: the centre of mass, the kinetic energy, the inertia tensor."""

from __future__ import annotations

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
    f,
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
        (CENTRE, f(r"\frac{1}{M}\sum_i m_i\,\mathbf{r}_i", "1/M Σ mᵢ rᵢ")),
        (
            "no_moment",
            f(r"\sum_i m_i(\mathbf{r}_i - \mathbf{r}_C) = \mathbf{0}", "Σ mᵢ (rᵢ − r_C) = 0"),
        ),
        (
            "no_momentum",
            f(
                r"\sum_i m_i(\dot{\mathbf{r}}_i - \dot{\mathbf{r}}_C) = \mathbf{0}",
                "Σ mᵢ (ṙᵢ − ṙ_C) = 0",
            ),
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
            f(r"\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i", "rᵢ = r_C + xᵢ"),
            ". So ",
            NO_MOMENT,
            " at all times, and ",
            NO_MOMENTUM,
            ": when the velocities are squared, the mixed term sums to nothing, and the energy "
            "is that of the mass in its centre and that of the motion about it,",
        ),
        (
            f("E_K", "E_K"),
            f("E_C + E_R", "E_C + E_R"),
            f(
                r"\frac{1}{2}M|\dot{\mathbf{r}}_C|^2 + \frac{1}{2}\sum_i m_i|\dot{\mathbf{x}}_i|^2",
                "½ M |ṙ_C|² + ½ Σ mᵢ |ẋᵢ|²",
            ),
        ),
        (
            "no_mixed_energy",
            f(r"\sum_i m_i\,\dot{\mathbf{x}}_i\cdot\dot{\mathbf{r}}_C = 0", "Σ mᵢ ẋᵢ·ṙ_C = 0"),
        ),
        (
            "energy_splits",
            f(
                r"\frac{1}{2}\sum_i m_i|\dot{\mathbf{r}}_i|^2 = E_C + E_R",
                "½ Σ mᵢ |ṙᵢ|² = E_C + E_R",
            ),
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
            f(r"\mathbf{x}_i = \mathbf{R}\,\mathbf{x}'_i", "xᵢ = R x′ᵢ"),
            " with ",
            AT_REST,
            " at rest. The derivative of ",
            f(r"\mathbf{R}\mathbf{R}^{\mathsf T} = \mathbf{1}", "R Rᵀ = 1"),
            " says that ",
            SPIN,
            " is skew. A skew matrix is a cross product; its vector is the angular velocity ",
            OMEGA,
            ", and",
        ),
        (RELATIVE_RATE, f(r"\boldsymbol{\Omega}\times\mathbf{x}_i", "Ω × xᵢ")),
        (
            "skew",
            f(
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T} + "
                r"\mathbf{R}\frac{d\mathbf{R}^{\mathsf T}}{dt} = \mathbf{0}",
                "dR/dt Rᵀ + R dRᵀ/dt = 0",
            ),
        ),
        (
            "turning",
            f(
                r"\frac{d\mathbf{R}}{dt}\mathbf{x}'_i = "
                r"\boldsymbol{\Omega}\times\mathbf{R}\mathbf{x}'_i",
                "dR/dt x′ᵢ = Ω × R x′ᵢ",
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
            f(r"\boldsymbol{\Omega} = \sum_j \Omega_j\mathbf{e}_j", "Ω = Σ Ω_j e_j"),
            " in any orthonormal basis, ",
            f(
                r"E_R = \frac{1}{2}\sum_i m_i|\boldsymbol{\Omega}\times\mathbf{x}_i|^2",
                "E_R = ½ Σ mᵢ |Ω × xᵢ|²",
            ),
            " is a quadratic form, ",
            f(
                r"E_R = \frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}\,\boldsymbol{\Omega}",
                "E_R = ½ Ωᵀ I Ω",
            ),
            ". Its coefficients, the inertia tensor, are of second order in the places of the "
            "particles and know nothing else of the body:",
        ),
        (
            f("I_{jk}", "I_jk"),
            f(
                r"\sum_i m_i(\mathbf{e}_j\times\mathbf{x}_i)\cdot(\mathbf{e}_k\times\mathbf{x}_i)",
                "Σ mᵢ (e_j × xᵢ)·(e_k × xᵢ)",
            ),
        ),
        (
            "energy_is_a_form",
            f(
                r"\frac{1}{2}\sum_i m_i|\boldsymbol{\Omega}\times\mathbf{x}_i|^2 = "
                r"\frac{1}{2}\boldsymbol{\Omega}^{\mathsf T}\mathbf{I}\,\boldsymbol{\Omega}",
                "½ Σ mᵢ |Ω × xᵢ|² = ½ Ωᵀ I Ω",
            ),
        ),
        ("symmetric", f(r"\mathbf{I}^{\mathsf T} = \mathbf{I}", "Iᵀ = I")),
        place="section 1.2",
    ),
)
