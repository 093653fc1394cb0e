"""Textbook results that follow from the equations of motion, each proved.

First the free body: Poinsot's construction, its principal axes and the exact solutions (Landau and
Lifshitz, Mechanics, sections 33, 36 and 37). Then the motion in one dimension that remains if all
momenta but one are constant, as for the heavy top: the coordinate θ moves in its effective
potential, which also gives the rates of the others, dq_j/dt = ∂V_eff/∂p_j. If θ occurs in sines and
cosines only, u = cos θ makes the energy u̇² = f(u); if f is a cubic polynomial, u is Jacobi's sn,
and a hyperbolic function if two of its roots meet.

The sentences are the macros of these names in templates/notes/en/consequences.md.jinja.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Consequence
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.kinematics import BODY
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.models.rotation import TIME, elementary

_LENGTH, _ENERGY = claims.LENGTH_SYMBOL, claims.ENERGY_SYMBOL
_LONGEST = 40  # operations of a condition for steady motion that tells a reader anything
_SINE = sp.Dummy("sine")
_LAMBDA, _FIRST, _SECOND, _THIRD, _MODULUS = sp.symbols("lambda u_1 u_2 u_3 k")
_TURNS = formula(r"\mathbf{R}(t)")


def _three_turns(*angles: str) -> Formula:
    return formula(claims.THREE_TURNS.format(*angles))


def _consequence(
    subject: str,
    name: str,
    left: Formula | sp.Expr,
    value: Formula | sp.Expr,
    *proofs: tuple[Formula, Sequence[sp.Expr]],
    where: Sequence[tuple[Formula | sp.Expr, sp.Expr]] = (),
    **spans: Any,
) -> Consequence:
    """A consequence for a rotation `subject`, with its claims and their residuals."""
    proved = (identity(sp.ImmutableMatrix([*e]), claim, subject) for claim, e in proofs)
    return Consequence(
        name=name, spans=spans, left=left, value=value, proofs=tuple(proved), where=tuple(where)
    )


# The free body


@dataclass(frozen=True)
class FreeBody:
    """What is known of a body on which nothing acts; `slopes` are dΩ′/dt."""

    inertia: sp.ImmutableMatrix
    slopes: Sequence[sp.Expr]
    name: str  # of the rotation

    def consequences(self) -> Iterator[Consequence]:
        inertia = self.inertia
        yield self._poinsot()
        if not inertia.is_diagonal():
            return
        yield from self._principal_axes()
        if inertia[0, 0] == inertia[1, 1] != inertia[2, 2]:
            yield self._symmetric()
            yield self._symmetric_in_space()
        elif len({inertia[k, k] for k in range(3)}) == 3:
            yield self._asymmetric()
            yield self._orientation()

    def _poinsot(self) -> Consequence:
        """L is normal to the ellipsoid of energy at Ω, whose tangent plane there is at rest."""
        omega = sp.Matrix(OMEGA_BODY)
        momentum = self.inertia * omega
        energy = omega.dot(momentum) / 2
        normal = [sp.diff(energy, w) - part for w, part in zip(omega, momentum, strict=True)]
        return _consequence(
            self.name,
            "poinsot",
            formula("d"),
            2 * _ENERGY / _LENGTH,
            (claims.NORMAL, normal),
            (claims.TWICE_ENERGY, [omega.dot(momentum) - 2 * energy]),
        )

    def _principal_axes(self) -> Iterator[Consequence]:
        """A deviation along the axes i and j obeys dΩ_i/dt = a Ω_j and dΩ_j/dt = b Ω_i, so that it
        grows or turns with λ² = a b; axes that the moments do not fix are left out.
        """
        spin, is_first = sp.Symbol("Omega"), True
        for k, axis in enumerate(("first", "second", "third")):
            i, j = (n for n in range(3) if n != k)
            steady = {s: spin if n == k else sp.S.Zero for n, s in enumerate(OMEGA_BODY)}
            a, b = (
                sp.diff(self.slopes[n], OMEGA_BODY[o]).xreplace(steady) for n, o in ((i, j), (j, i))
            )
            own, one, other = (self.inertia[n, n] for n in (k, i, j))
            squared = spin**2 * (own - one) * (other - own) / (one * other)
            if one == other:
                squared = -((spin * (own - one) / one) ** 2)
            if squared != 0:
                yield _consequence(
                    self.name,
                    ("symmetry_axis" if one == other else "principal_axis")
                    if is_first
                    else "another_axis",
                    claims.SQUARED_RATE,
                    squared,
                    (claims.GROWTH, [a * b - squared]),
                    axis=axis,
                    rate=spin,
                )
                is_first = False

    def _symmetric(self) -> Consequence:
        """Ω′ turns about the axis of symmetry: dΩ₁/dt = −κ Ω₂, dΩ₂/dt = κ Ω₁, Ω₃ constant."""
        first, second, third = OMEGA_BODY
        rate = (self.inertia[2, 2] - self.inertia[0, 0]) / self.inertia[0, 0] * third
        slopes = self.slopes
        residual = [slopes[0] + rate * second, slopes[1] - rate * first, slopes[2]]
        kappa = formula(r"\kappa")
        return _consequence(self.name, "symmetric_body", kappa, rate, (claims.PRECESSION, residual))

    def _symmetric_in_space(self) -> Consequence:
        """R(t) with the third axis of space along L, which is proved to stay constant."""
        across, along, third = self.inertia[0, 0], self.inertia[2, 2], OMEGA_BODY[2]
        angle = sp.Dummy("beta")
        cosine, precession = along * third / _LENGTH, _LENGTH / across
        spin = (across - along) / across * third
        own = spin.xreplace({third: _LENGTH * sp.cos(angle) / along})
        first, second, last = map(elementary, "zxz", (precession * TIME, angle, own * TIME))
        rotation = first * second * last
        skew = rotation.T * rotation.diff(TIME)
        omega = sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
        momentum = rotation * self.inertia * omega
        return _consequence(
            self.name,
            "symmetric_body_in_space",
            _TURNS,
            _three_turns(r"\alpha_0 + \dot{\alpha}t", r"\beta", r"\gamma_0 + \dot{\gamma}t"),
            (claims.CONSTANT_MOMENTUM, [*(momentum - sp.Matrix([0, 0, _LENGTH]))]),
            where=(
                (formula(r"\cos\beta"), cosine),
                (claims.PRECESSION_RATE, precession),
                (formula(r"\dot{\gamma}"), spin),
            ),
        )

    def _asymmetric(self) -> Consequence:
        """Ω′ = (a cn, b sn, c dn) for A < B < C and L² > 2 E B."""
        A, B, C = (self.inertia[k, k] for k in range(3))
        of_c, of_a = 2 * _ENERGY * C - _LENGTH**2, _LENGTH**2 - 2 * _ENERGY * A
        a, b, c = of_c / (A * (C - A)), of_c / (B * (C - B)), of_a / (C * (C - A))
        rate = (C - B) * of_a / (A * B * C)
        modulus = (B - A) * of_c / ((C - B) * of_a)
        s = sp.Dummy("sn")
        residual = [
            A**2 * a * rate - (C - B) ** 2 * b * c,
            B**2 * b * rate - (C - A) ** 2 * a * c,
            C**2 * c * rate * modulus**2 - (B - A) ** 2 * a * b,
            A * a * (1 - s**2) + B * b * s**2 + C * c * (1 - modulus * s**2) - 2 * _ENERGY,
        ]
        names = map(formula, ("a^2", "b^2", "c^2", r"\tau^2", "k^2"))
        return _consequence(
            self.name,
            "asymmetric_body",
            BODY.omega,
            claims.IN_ELLIPTIC_FUNCTIONS,
            (claims.EULER_FREE, residual),
            where=[*zip(names, (a, b, c, rate, modulus), strict=True)],
            moments=(A, B, C),
            least=2 * _ENERGY * B,
            momentum_squared=_LENGTH**2,
        )

    def _orientation(self) -> Consequence:
        """R(t) with the third axis of space along L, as three turns; one needs a quadrature."""
        A, B, C = (self.inertia[k, k] for k in range(3))
        one, two, three = OMEGA_BODY
        rate = _LENGTH * (2 * _ENERGY - C * three**2) / (_LENGTH**2 - C**2 * three**2)
        twice = A * one**2 + B * two**2 + C * three**2
        # L′ = |L| (sin β sin γ, sin β cos γ, cos β)
        turning = (one * A * one + two * B * two) / _LENGTH / (1 - (C * three / _LENGTH) ** 2)
        return _consequence(
            self.name,
            "asymmetric_body_in_space",
            _TURNS,
            _three_turns(r"\alpha(t)", r"\beta(t)", r"\gamma(t)"),
            (claims.PRECESSION_OF_AXIS, [turning - rate.xreplace({_ENERGY: twice / 2})]),
            where=(
                (formula(r"\cos\beta"), C * three / _LENGTH),
                (formula(r"\tan\gamma"), A * one / (B * two)),
                (claims.PRECESSION_RATE, rate),
            ),
        )


# Motion in one dimension


class Introduced(NamedTuple):
    """Symbols that stand for what the user has not named."""

    E: sp.Symbol  # the energy
    u: sp.Symbol  # cos θ
    p: sp.Symbol  # all momenta, if they are equal


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """One coordinate θ and its effective potential, the other momenta p_j being constant."""

    name: str  # of the rotation
    coordinate: sp.Expr  # θ
    ignorable: tuple[sp.Expr, ...]  # the other coordinates
    mass: sp.Expr  # m, of ½ m θ̇²
    potential: sp.Expr  # V_eff in θ and p_j
    symbols: tuple[sp.Symbol, ...]  # p_j
    momenta: tuple[sp.Expr, ...]  # p_j in the coordinates and rates
    energy: sp.Expr  # E in the coordinates and rates
    acceleration: sp.Expr  # of θ

    def consequences(self) -> Iterator[Consequence]:
        value = self.mass * self.rate**2 / 2 + self.potential
        claim = formula(r"E = \tfrac{1}{2}m\dot{q}^2 + V_{\mathrm{eff}}")
        residual = self.letters.E - value
        q = self.coordinate
        yield self._follows("effective_potential", claims.ENERGY, value, claim, residual, q=q)
        yield from self._others()
        yield from self._steady()
        if self.in_cosine is not None and not self.mass.has(self.coordinate):
            yield from self._sleeping()
            yield from self._cosine_equation()

    @cached_property
    def letters(self) -> Introduced:
        """Those that the user has not taken, with a zero where that is needed."""
        taken = {symbol.name for symbol in self.energy.free_symbols}
        names = (name + "_0" * (name in taken) for name in Introduced._fields)
        return Introduced(*map(sp.Symbol, names))

    @property
    def rate(self) -> sp.Expr:
        return sp.diff(self.coordinate, TIME)

    @property
    def rates(self) -> list[sp.Expr]:
        """Of the ignorable coordinates."""
        return [sp.diff(q, TIME) for q in self.ignorable]

    def _follows(
        self,
        name: str,
        left: Formula | sp.Expr,
        value: sp.Expr,
        claim: Formula,
        residual: sp.Expr,
        **more: Any,
    ) -> Consequence:
        """A consequence; in a residual with θ(t), E and p_j are those of the motion, else free."""
        values = dict(zip(self.symbols, self.momenta, strict=True)) | {self.letters.E: self.energy}
        if residual.has(self.coordinate):
            residual = residual.xreplace(values)
        return _consequence(self.name, name, left, value, (claim, [residual]), **more)

    def _others(self) -> Iterator[Consequence]:
        """The rates of the ignorable coordinates, and what is left to integrate."""
        for k, (q, rate, p) in enumerate(
            zip(self.ignorable, self.rates, self.symbols, strict=True)
        ):
            slope = sp.diff(self.potential, p)
            # each term as one fraction, with its factors if that is shorter
            value = sp.Add(
                *(
                    min(sp.cancel(term), sp.factor(term), key=sp.count_ops)
                    for term in sp.Add.make_args(slope)
                )
            )
            yield self._follows(
                "another_coordinate" if k else "other_coordinates",
                rate,
                value,
                claims.RATE_OF_IGNORABLE,
                rate - value,
                own=claims.name_of(self.coordinate),
                angle=claims.name_of(q),
                rate=claims.name_of(q, order=1),
            )

    def _steady(self) -> Iterator[Consequence]:
        """θ at rest: a condition on the rates of the others, quadratic for a top."""
        at_rest = self.acceleration.xreplace({self.rate: sp.S.Zero})
        rates = self.rates
        if len(rates) != 2:
            return
        for spin, turning, p, momentum in zip(
            rates, reversed(rates), self.symbols, self.momenta, strict=True
        ):
            slope = sp.diff(momentum, spin)
            if slope.has(self.coordinate):  # not the spin about an axis of the body
                continue
            own = (p - momentum.xreplace({spin: sp.S.Zero})) / slope
            of_spin = at_rest.xreplace({spin: own})
            x = sp.Dummy()
            condition = _factor(of_spin.xreplace({turning: x}), x)
            if condition is None or condition.degree() != 2:
                continue
            if sp.count_ops(condition.as_expr()) > _LONGEST:
                return
            value = condition.as_expr().xreplace({x: turning})
            residual = of_spin - sp.cancel(of_spin / value) * value
            yield self._follows(
                "steady_motion",
                formula("0"),
                sp.collect(value, turning),
                formula(r"\ddot{q} = 0"),
                residual,
                q=self.coordinate,
            )
            yield from self._both_rates(condition, turning, p)
            return

    def _both_rates(
        self, condition: sp.Poly, turning: sp.Expr, spin: sp.Symbol
    ) -> Iterator[Consequence]:
        """The roots of the quadratic equation for steady motion, with when there are any."""
        a, b, c = condition.all_coeffs()
        below = sp.factor(b**2 - 4 * a * c)
        claim = formula(r"a x^2 + b x + c = 0")
        spans = {"lead": a, "discriminant": below, "momentum": spin}
        spans |= {"slow": sp.cancel(-c / b), "fast": sp.cancel(-b / a)}
        r = sp.Dummy("r")  # the root of the discriminant
        for name, sign in (("slow_precession", -1), ("fast_precession", 1)):
            x = (-b + sign * r) / (2 * a)
            residual = a * x**2 + b * x + c - (r**2 - (b**2 - 4 * a * c)) / (4 * a)
            value = x.xreplace({r: sp.sqrt(below)})
            yield self._follows(name, turning, value, claim, residual, **spans)
        if a.has(self.coordinate):
            single = sp.cancel(-c / b)
            claim = formula("b x + c = 0")
            residual = b * single + c
            yield self._follows("single_precession", turning, single, claim, residual, **spans)

    # in terms of u = cos θ

    @cached_property
    def in_cosine(self) -> sp.Expr | None:
        """V_eff in terms of u; None if it cannot be written so."""
        angle, u = self.coordinate, self.letters.u
        plain = self.potential.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
        plain = plain.replace(sp.cot, lambda x: sp.cos(x) / sp.sin(x))
        plain = plain.xreplace({sp.sin(angle): _SINE, sp.cos(angle): u})
        if plain.has(angle):
            return None

        def even(value: sp.Expr) -> sp.Expr:
            """Even powers of the sine in terms of the cosine."""
            powers = sp.Poly(value, _SINE).terms()
            return sp.Add(*(c * _SINE ** (n % 2) * (1 - u**2) ** (n // 2) for (n,), c in powers))

        parts = []
        for part in sp.Add.make_args(plain):
            above, below = map(even, sp.fraction(sp.together(part)))
            parts.append(sp.cancel(above / below))
        return None if any(part.has(_SINE) for part in parts) else sp.Add(*parts)

    @cached_property
    def right_side(self) -> sp.Expr:
        """f(u) = 2 (1 − u²)(E − V)/m, with what has a pole at u = ±1 apart."""
        u = self.letters.u
        regular, singular = sp.S.Zero, sp.S.Zero
        for part in sp.Add.make_args(self.in_cosine):
            if sp.denom(part).has(u):
                singular += sp.factor(sp.cancel(part * (1 - u**2)))
            else:
                regular += part
        return 2 * ((1 - u**2) * (self.letters.E - regular) - singular) / self.mass

    def _sleeping(self) -> Iterator[Consequence]:
        """V_eff near θ = 0 for equal momenta, if these alone make it regular there."""
        letters, momenta = self.letters, self.symbols
        u, in_cosine = letters.u, self.in_cosine
        assert in_cosine is not None
        equal = sp.cancel(in_cosine.xreplace(dict.fromkeys(momenta, letters.p)))
        below = (sp.denom(sp.together(value)) for value in (in_cosine, equal))
        poles = [divisor.xreplace({u: sp.S.One}) == 0 for divisor in below]
        if len(momenta) != 2 or poles != [True, False]:
            return
        height, slope = (e.xreplace({u: sp.S.One}) for e in (equal, sp.diff(equal, u)))
        line = height + (u - 1) * slope
        rest = sp.cancel((equal - line) / (1 - u) ** 2)  # regular at u = 1
        names = map(claims.momentum_of, self.ignorable)
        yield self._follows(
            "upright_motion",
            formula(r"\kappa"),
            min(sp.expand(-slope), sp.factor(-slope), key=sp.count_ops),
            claims.NEAR_UPRIGHT,
            equal - line - (1 - u) ** 2 * rest,
            q=self.coordinate,
            square=self.coordinate**2,
            momenta=formula("#1 = #2 = #3", *names, claims.integral_symbol(letters.p.name)),
        )

    def _cosine_equation(self) -> Iterator[Consequence]:
        angle, u, value = self.coordinate, self.letters.u, self.right_side
        if not sp.cancel(value).is_polynomial(u):
            return
        f = sp.Poly(sp.expand(value), u)
        if f.degree() != 3:
            return
        name = claims.integral_symbol(u.name)
        spans: dict[str, Any] = {
            "u": name,
            "cosine": formula(r"#1 = \cos #2", name, claims.name_of(angle)),
            "equation": formula(r"\dot{#1}^2 = f(#1)", name),
        }
        yield self._follows(
            "cubic_for_cosine",
            formula("f(#1)", name),
            value,
            spans["equation"],
            (sp.sin(angle) * self.rate) ** 2 - value.xreplace({u: sp.cos(angle)}),
            **spans,
        )
        # u(t) between the roots u₁ ≤ u₂ of the cubic f; its third root is u₃
        one, two, three = _FIRST, _SECOND, _THIRD
        sn, a = sp.Dummy("sn"), sp.Dummy("a")
        between = one + (two - one) * sn**2
        modulus = (two - one) / (three - one)
        rate_squared = a * (three - one) / 4
        slope_squared = 4 * (two - one) ** 2 * sn**2 * (1 - sn**2) * (1 - modulus * sn**2)
        yield self._follows(
            "nutation",
            sp.cos(angle),
            between.xreplace({sn: sp.Function("sn")(_LAMBDA * TIME, _MODULUS)}),
            spans["equation"],
            slope_squared * rate_squared
            - a * (between - one) * (between - two) * (between - three),
            where=((_LAMBDA**2, rate_squared.xreplace({a: f.LC()})), (_MODULUS**2, modulus)),
            **spans,
        )


def _factor(value: sp.Expr, turning: sp.Symbol) -> sp.Poly | None:
    """The factor of the numerator that holds a rate, as a polynomial in it."""
    _, factors = sp.factor_list(sp.numer(sp.cancel(sp.together(value))))
    factors_with_rate = [base for base, _ in factors if base.has(turning)]
    if len(factors_with_rate) != 1:
        return None
    condition = sp.Poly(factors_with_rate[0], turning)
    return -condition if condition.LC().could_extract_minus_sign() else condition
