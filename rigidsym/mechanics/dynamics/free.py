"""The free body: Poinsot's construction, the principal axes, and exact solutions.

L. Landau, E. Lifshitz, Mechanics (1976), sections 33, 36 and 37.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Consequence
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.models.rotation import TIME, elementary

_LENGTH = claims.LENGTH_SYMBOL


def of_free_body(
    inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr], name: str
) -> Iterator[Consequence]:
    """What is known of the free body; `slopes` are dΩ′/dt."""
    yield _poinsot(inertia, name)
    if not inertia.is_diagonal():
        return
    yield from _principal_axes(inertia, slopes, name)
    if inertia[0, 0] == inertia[1, 1] != inertia[2, 2]:
        yield _in_body(inertia, slopes, name)
        yield _in_space(inertia, name)
    elif len({inertia[k, k] for k in range(3)}) == 3:
        yield _elliptic(inertia, name)
        yield _orientation(inertia, name)


def _poinsot(inertia: sp.ImmutableMatrix, name: str) -> Consequence:
    """L is normal to the ellipsoid of energy at Ω, whose tangent plane there is at rest."""
    omega = sp.Matrix(OMEGA_BODY)
    energy = (omega.T * inertia * omega)[0] / 2
    slopes = sp.Matrix([sp.diff(energy, w) for w in OMEGA_BODY]) - inertia * omega
    return Consequence(
        title="Poinsot's construction",
        text="In the body, {} moves on the ellipsoid of constant energy and on that of constant "
        "{}. It follows a curve in which they meet, a polhode. The angular momentum is normal to "
        "the ellipsoid of energy, {}. Seen from space, the tangent plane at {} is therefore "
        "normal to {}, and since {} is constant, it has a constant distance from the fixed point. "
        "The ellipsoid rolls on this invariable plane without slipping, since its point of contact "
        "is on the axis of rotation; the track in the plane is the herpolhode. The distance is",
        spans=(
            *(BODY.omega, claims.MOMENTUM_SQUARED, claims.NORMAL),
            *(SPACE.omega, claims.MOMENTUM, claims.TWICE_ENERGY),
        ),
        left=formula("d"),
        value=2 * claims.ENERGY_SYMBOL / _LENGTH,
        proofs=(
            identity(sp.ImmutableMatrix(slopes), claims.NORMAL, name),
            identity(
                sp.ImmutableMatrix(omega.T * inertia * omega) - sp.ImmutableMatrix([[2 * energy]]),
                *(claims.TWICE_ENERGY, name),
            ),
        ),
    )


def _principal_axes(
    inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr], name: str
) -> Iterator[Consequence]:
    """A deviation along the axes i and j obeys dΩ_i/dt = a Ω_j and dΩ_j/dt = b Ω_i, so that it
    grows or turns with λ² = a b; axes that the moments do not fix are left out.
    """
    spin = sp.Symbol("Omega")
    title = "Rotation about the principal axes"
    for k, axis in enumerate(("first", "second", "third")):
        i, j = (n for n in range(3) if n != k)
        steady = {s: spin if n == k else sp.S.Zero for n, s in enumerate(OMEGA_BODY)}
        a, b = (sp.diff(slopes[n], OMEGA_BODY[o]).xreplace(steady) for n, o in ((i, j), (j, i)))
        own, one, other = inertia[k, k], inertia[i, i], inertia[j, j]
        squared = spin**2 * (own - one) * (other - own) / (one * other)
        if one == other:
            squared = -((spin * (own - one) / one) ** 2)
        if squared == 0:
            continue
        grows = (
            "does not grow, since {} is negative:"
            if one == other
            else "grows if {} is positive, as it is for the intermediate one of three moments only:"
        )
        yield Consequence(
            title=title,
            text=f"A small deviation from the rotation about the {axis} axis at the rate {{}} is "
            f"proportional to {{}}. It {grows}"
            if title
            else f"About the {axis} axis,",
            spans=(spin, formula(r"\exp(\lambda t)"), claims.SQUARED_RATE) if title else (),
            left=claims.SQUARED_RATE,
            value=squared,
            proofs=(identity(sp.ImmutableMatrix([[a * b - squared]]), claims.GROWTH, name),),
        )
        title = ""


def _in_body(inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr], name: str) -> Consequence:
    """Ω′ turns about the axis of symmetry: dΩ₁/dt = −κ Ω₂, dΩ₂/dt = κ Ω₁, Ω₃ constant."""
    first, second, third = OMEGA_BODY
    rate = (inertia[2, 2] - inertia[0, 0]) / inertia[0, 0] * third
    residual = [slopes[0] + rate * second, slopes[1] - rate * first, slopes[2]]
    turning = formula(
        r"\Omega'_1 + i\Omega'_2 = \left(\Omega'_1(0) + i\Omega'_2(0)\right)e^{i\kappa t}"
    )
    return Consequence(
        title="The symmetric body",
        text="{} is constant, and the other two components turn about the axis of symmetry, {}, "
        "with the rate",
        spans=(formula(r"\Omega'_3"), turning),
        left=formula(r"\kappa"),
        value=rate,
        proofs=(identity(sp.ImmutableMatrix(residual), claims.PRECESSION, name),),
    )


def _in_space(inertia: sp.ImmutableMatrix, name: str) -> Consequence:
    """R(t) with the third axis of space along L, which is proved to stay constant."""
    across, along, third, angle = inertia[0, 0], inertia[2, 2], OMEGA_BODY[2], sp.Dummy("beta")
    cosine, precession = along * third / _LENGTH, _LENGTH / across
    spin = (across - along) / across * third
    own = spin.xreplace({third: _LENGTH * sp.cos(angle) / along})
    first, second, last = map(elementary, "zxz", (precession * TIME, angle, own * TIME))
    rotation = first * second * last
    skew = rotation.T * rotation.diff(TIME)
    omega = sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
    residual = sp.ImmutableMatrix(rotation * inertia * omega - sp.Matrix([0, 0, _LENGTH]))
    return Consequence(
        title="The symmetric body in space",
        text="The angular momentum is a sum of multiples of {} and of the axis of symmetry {}, so "
        "that these three are in one plane, which turns about {} (regular precession). With the "
        "third axis of space along {}, the orientation is that of two turns at constant rates, the "
        "precession {} and the spin {}:",
        spans=(
            *(SPACE.omega, formula(r"\mathbf{e}'_3"), claims.MOMENTUM, claims.MOMENTUM),
            *(claims.PRECESSION_RATE, formula(r"\dot{\gamma}")),
        ),
        left=formula(r"\mathbf{R}(t)"),
        value=formula(
            claims.THREE_TURNS.format(
                r"\alpha_0 + \dot{\alpha}t", r"\beta", r"\gamma_0 + \dot{\gamma}t"
            )
        ),
        proofs=(identity(residual, claims.CONSTANT_MOMENTUM, name),),
        where=(
            (formula(r"\cos\beta"), cosine),
            (claims.PRECESSION_RATE, precession),
            (formula(r"\dot{\gamma}"), spin),
        ),
    )


def _elliptic(inertia: sp.ImmutableMatrix, name: str) -> Consequence:
    """Ω′ = (a cn, b sn, c dn) for A < B < C and L² > 2 E B."""
    A, B, C = (inertia[k, k] for k in range(3))
    energy = claims.ENERGY_SYMBOL
    of_c, of_a = 2 * energy * C - _LENGTH**2, _LENGTH**2 - 2 * energy * A
    a, b, c = of_c / (A * (C - A)), of_c / (B * (C - B)), of_a / (C * (C - A))
    rate = (C - B) * of_a / (A * B * C)
    modulus = (B - A) * of_c / ((C - B) * of_a)
    s = sp.Dummy("sn")
    residual = [
        A**2 * a * rate - (C - B) ** 2 * b * c,
        B**2 * b * rate - (C - A) ** 2 * a * c,
        C**2 * c * rate * modulus**2 - (B - A) ** 2 * a * b,
        A * a * (1 - s**2) + B * b * s**2 + C * c * (1 - modulus * s**2) - 2 * energy,
    ]
    squares = zip(map(formula, ("a^2", "b^2", "c^2")), (a, b, c), strict=True)
    values = [*squares, (formula(r"\tau^2"), rate), (formula("k^2"), modulus)]
    return Consequence(
        title="The asymmetric body in elliptic functions",
        text="Let {} < {} < {} and {} < {}, and let the time begin where {} is 0. Substitution "
        "shows that Euler's equations have the solution, where $a$, $b$ and $c$ are positive, or "
        "two of them are negative,",
        spans=(*(A, B, C, 2 * energy * B, _LENGTH**2), formula(r"\Omega'_2")),
        left=BODY.omega,
        value=claims.IN_ELLIPTIC_FUNCTIONS,
        proofs=(identity(sp.ImmutableMatrix(residual), claims.EULER_FREE, name),),
        where=tuple(values),
    )


def _orientation(inertia: sp.ImmutableMatrix, name: str) -> Consequence:
    """R(t) with the third axis of space along L, as three turns; one needs a quadrature."""
    A, B, C = (inertia[k, k] for k in range(3))
    one, two, three = OMEGA_BODY
    length, energy = _LENGTH, claims.ENERGY_SYMBOL
    rate = length * (2 * energy - C * three**2) / (length**2 - C**2 * three**2)
    twice = A * one**2 + B * two**2 + C * three**2
    # L′ = |L| (sin β sin γ, sin β cos γ, cos β)
    turning = (one * A * one + two * B * two) / length / (1 - (C * three / length) ** 2)
    residual = turning - rate.xreplace({energy: twice / 2})
    return Consequence(
        title="",
        text="With the third axis of space along {}, the orientation follows from {}. One "
        "quadrature is left, an elliptic integral of the third kind for {}:",
        spans=(claims.MOMENTUM, claims.MOMENTUM_IN_BODY, formula(r"\alpha")),
        left=formula(r"\mathbf{R}(t)"),
        value=formula(claims.THREE_TURNS.format(r"\alpha(t)", r"\beta(t)", r"\gamma(t)")),
        proofs=(identity(sp.ImmutableMatrix([[residual]]), claims.PRECESSION_OF_AXIS, name),),
        where=(
            (formula(r"\cos\beta"), C * three / length),
            (formula(r"\tan\gamma"), A * one / (B * two)),
            (claims.PRECESSION_RATE, rate),
        ),
    )
