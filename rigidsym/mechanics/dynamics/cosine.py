"""One coordinate θ that occurs in sines and cosines only: u = cos θ makes the energy u̇² = f(u).

If f is a cubic polynomial, u is Jacobi's sn; if two of its roots meet, a hyperbolic function.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import sympy as sp

from rigidsym.algebra.witness import Example
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Consequence, Proof
from rigidsym.mechanics.dynamics.reduced import Reduced
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.rotation import TIME

_SINE = sp.Dummy("sine")
_LAMBDA, _FIRST, _SECOND, _THIRD, _MODULUS = sp.symbols("lambda u_1 u_2 u_3 k")


class Cosine:
    """What follows for u = cos θ of a motion in one dimension."""

    def __init__(self, motion: Reduced) -> None:
        self.motion = motion
        self.u, self.p = motion.letters.u, motion.letters.p
        self.name = claims.integral_symbol(self.u.name)
        self.of_cosine = formula(r"\dot{#1}^2 = f(#1)", self.name)

    def consequences(self) -> Iterator[Consequence]:
        if self.potential is None or self.motion.mass.has(self.motion.coordinate):
            return
        yield from self._sleeping()
        if not sp.cancel(self.right_side).is_polynomial(self.u):
            return
        f = sp.Poly(sp.expand(self.right_side), self.u)
        yield self._polynomial()
        if f.degree() == 3:
            yield self._elliptic(f.LC())
            yield from self._rising(f)

    @cached_property
    def potential(self) -> sp.Expr | None:
        """V_eff in terms of u; None if it cannot be written so."""
        angle = self.motion.coordinate
        plain = self.motion.potential.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
        plain = plain.replace(sp.cot, lambda x: sp.cos(x) / sp.sin(x))
        plain = plain.xreplace({sp.sin(angle): _SINE, sp.cos(angle): self.u})
        if plain.has(angle):
            return None
        parts = [sp.cancel(self._without_sine(part)) for part in sp.Add.make_args(plain)]
        return None if any(part.has(_SINE) for part in parts) else sp.Add(*parts)

    def _without_sine(self, value: sp.Expr) -> sp.Expr:
        """The same with even powers of the sine in terms of the cosine."""
        above, below = map(self._even, sp.fraction(sp.together(value)))
        return above / below

    def _even(self, value: sp.Expr) -> sp.Expr:
        powers = sp.Poly(value, _SINE).terms()
        return sp.Add(*(c * _SINE ** (n % 2) * (1 - self.u**2) ** (n // 2) for (n,), c in powers))

    @cached_property
    def right_side(self) -> sp.Expr:
        """f(u) = 2 (1 − u²)(E − V)/m, with what has a pole at u = ±1 apart."""
        assert self.potential is not None
        regular, singular = sp.S.Zero, sp.S.Zero
        for part in sp.Add.make_args(self.potential):
            if sp.denom(part).has(self.u):
                singular += sp.factor(sp.cancel(part * (1 - self.u**2)))
            else:
                regular += part
        return (
            2
            * ((1 - self.u**2) * (self.motion.letters.E - regular) - singular)
            / (self.motion.mass)
        )

    def _identity(
        self,
        residual: sp.Expr,
        claim: Formula,
        conditions: Sequence[sp.Expr] = (),
        example: Example = (),
    ) -> Proof:
        matrix = sp.ImmutableMatrix([[residual]])
        return identity(matrix, claim, self.motion.name, conditions, example)

    def _polynomial(self) -> Consequence:
        angle, value = self.motion.coordinate, self.right_side
        kind = "cubic polynomial" if sp.degree(sp.cancel(value), self.u) == 3 else "polynomial"
        residual = (sp.sin(angle) * self.motion.rate) ** 2 - value.xreplace({self.u: sp.cos(angle)})
        return Consequence(
            title="The equation for the cosine",
            text=f"With {{}} the equation of energy becomes {{}}, with the {kind} $f$:",
            spans=(formula(r"#1 = \cos #2", self.name, claims.name_of(angle)), self.of_cosine),
            left=formula("f(#1)", self.name),
            value=value,
            proofs=(self.motion.proved(residual, self.of_cosine),),
        )

    # motions

    @cached_property
    def _upright(self) -> sp.Expr | None:
        """V_eff with equal momenta, if these alone make it regular at θ = 0."""
        equal = dict.fromkeys(self.motion.symbols, self.p)
        assert self.potential is not None
        regular = sp.cancel(self.potential.xreplace(equal))
        below = (sp.denom(sp.together(value)) for value in (self.potential, regular))
        poles = [divisor.xreplace({self.u: sp.S.One}) == 0 for divisor in below]
        return regular if len(equal) == 2 and poles == [True, False] else None

    def _sleeping(self) -> Iterator[Consequence]:
        """V_eff near θ = 0."""
        equal, u = self._upright, self.u
        if equal is None:
            return
        height, slope = (e.xreplace({u: sp.S.One}) for e in (equal, sp.diff(equal, u)))
        line = height + (u - 1) * slope
        rest = sp.cancel((equal - line) / (1 - u) ** 2)  # regular at u = 1
        yield Consequence(
            title="The upright motion",
            text="If {} is 0, the momenta are equal, {}; near 0 the effective potential is a "
            "constant plus half of {} times {}. The motion upright (the sleeping top) is stable if "
            "this coefficient is positive:",
            spans=(
                self.motion.coordinate,
                self._equal_momenta,
                formula(r"\kappa"),
                self.motion.coordinate**2,
            ),
            left=formula(r"\kappa"),
            value=min(sp.expand(-slope), sp.factor(-slope), key=sp.count_ops),
            proofs=(self._identity(equal - line - (1 - u) ** 2 * rest, claims.NEAR_UPRIGHT),),
        )

    def _elliptic(self, lead: sp.Expr) -> Consequence:
        """u(t) between the roots u₁ ≤ u₂ of the cubic f; its third root is u₃."""
        one, two, three = _FIRST, _SECOND, _THIRD
        sn, a = sp.Dummy("sn"), sp.Dummy("a")
        u = one + (two - one) * sn**2
        modulus = (two - one) / (three - one)
        rate_squared = a * (three - one) / 4
        slope_squared = 4 * (two - one) ** 2 * sn**2 * (1 - sn**2) * (1 - modulus * sn**2)
        residual = slope_squared * rate_squared - a * (u - one) * (u - two) * (u - three)
        return Consequence(
            title="Nutation in elliptic functions",
            text="Let {} be the roots of $f$. {} oscillates between the first two. Let the time "
            "begin at {}. Substitution shows that",
            spans=(formula(r"u_1 \le u_2 \le u_3"), self.name, one),
            left=self._cosine,
            value=u.xreplace({sn: sp.Function("sn")(_LAMBDA * TIME, _MODULUS)}),
            proofs=(self._identity(residual, self.of_cosine),),
            where=((_LAMBDA**2, rate_squared.xreplace({a: lead})), (_MODULUS**2, modulus)),
        )

    def _rising(self, f: sp.Poly) -> Iterator[Consequence]:
        """The motion with the energy and the momenta of the upright one: f has a double root 1."""
        if self._upright is None or f.LC().could_extract_minus_sign():
            return
        motion, u, lead = self.motion, self.u, f.LC()
        energy = sp.expand(self._upright.xreplace({u: sp.S.One}))
        known = dict.fromkeys(motion.symbols, self.p) | {motion.letters.E: energy}
        value = self.right_side.xreplace(known)
        simple = sp.Poly(sp.cancel(value / (1 - u) ** 2), u)
        first = sp.expand(-simple.coeff_monomial(1) / simple.LC())
        yield Consequence(
            title="The motion that rises to the vertical",
            text="If the momenta are equal, {}, and the energy is that of the upright motion, {} = "
            "{}, the polynomial $f$ has the double root 1, and the simple root",
            spans=(self._equal_momenta, claims.ENERGY, energy),
            left=_FIRST,
            value=first,
            proofs=(self._identity(value - lead * (1 - u) ** 2 * (u - first), claims.DOUBLE_ROOT),),
        )
        s = sp.Dummy("s")  # 1/cosh λt, with ṡ² = λ² s² (1 − s²)
        rate_squared = lead * (1 - _FIRST) / 4
        rising = 1 - (1 - _FIRST) * s**2
        residual = sp.diff(rising, s) ** 2 * rate_squared * s**2 * (1 - s**2)
        residual -= lead * (1 - rising) ** 2 * (rising - _FIRST)
        yield Consequence(
            title="",
            text="If it is less than 1, the axis rises from there and approaches the vertical in "
            "infinite time. With {} = {}, substitution shows that",
            spans=(_LAMBDA**2, rate_squared),
            left=self._cosine,
            value=rising.xreplace({s: 1 / sp.cosh(_LAMBDA * TIME)}),
            proofs=(self._identity(residual, self.of_cosine),),
        )
        yield from self._from_sixty_degrees(lead, first)

    def _from_sixty_degrees(self, lead: sp.Expr, first: sp.Expr) -> Iterator[Consequence]:
        """The same from u₁ = 1/2, where λ is half of γ, γ² = a/2."""
        motion, gamma, half = self.motion, self.motion.letters.gamma, sp.Rational(1, 2)
        squares = sp.Poly(first - half, self.p)
        if squares.degree() != 2 or squares.coeff_monomial(self.p):
            return
        ratio = -squares.coeff_monomial(1) / squares.LC() / (lead / 2)  # p²/γ²
        plain, back = sp.posify(sp.cancel(ratio))
        momentum = gamma * sp.sqrt(plain).xreplace(back)
        cosine = {sp.sin(motion.coordinate): sp.sqrt(3) / 2, sp.cos(motion.coordinate): half}
        equal = dict.fromkeys(motion.symbols, momentum)
        rates = [sp.factor(sp.cancel(t.xreplace(cosine).xreplace(equal))) for t in motion.turning]
        start = cosine | dict(zip(motion.rates, rates, strict=True)) | {motion.rate: sp.S.Zero}
        values = {motion.letters.E: motion.energy.xreplace(start)}
        values |= {
            p: e.xreplace(start) for p, e in zip(motion.symbols, motion.momenta, strict=True)
        }
        s = sp.Dummy("s")  # 1/cosh γt, with ṡ² = γ² s² (1 − s²)
        rising = 1 / (1 + s)
        residual = sp.diff(rising, s) ** 2 * gamma**2 * s**2 * (1 - s**2)
        residual -= self.right_side.xreplace(values).xreplace({self.u: rising})
        condition = sp.numer(sp.together(gamma**2 - lead / 2))
        constants = sorted(lead.free_symbols, key=str)
        example = dict(zip(constants, map(sp.Integer, range(2, 2 + len(constants))), strict=True))
        example[gamma] = sp.sqrt(lead.xreplace(example) / 2)
        names = [claims.name_of(q, order=1) for q in motion.ignorable]
        listed = " and ".join(["{} = {}"] * len(rates))
        yield Consequence(
            title="",
            text=f"An example is a top that starts at {{}} with {{}}, {listed}, where {{}} = {{}}. "
            "Substitution into $f$ with its energy and momenta shows that",
            spans=(
                formula(r"#1 = \frac{\pi}{3}", claims.name_of(motion.coordinate)),
                formula("#1 = 0", claims.name_of(motion.coordinate, order=1)),
                *(part for pair in zip(names, rates, strict=True) for part in pair),
                *(gamma**2, lead / 2),
            ),
            left=1 / sp.cos(motion.coordinate),
            value=1 + 1 / sp.cosh(gamma * TIME),
            proofs=(
                self._identity(residual, self.of_cosine, (condition,), tuple(example.items())),
            ),
        )

    @property
    def _cosine(self) -> sp.Expr:
        return sp.cos(self.motion.coordinate)

    @property
    def _equal_momenta(self) -> Formula:
        names = map(claims.momentum_of, self.motion.ignorable)
        return formula("#1 = #2 = #3", *names, claims.integral_symbol(self.p.name))
