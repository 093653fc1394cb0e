"""Motion in one dimension, if all momenta but one are constant, as for the heavy top.

The remaining coordinate moves in its effective potential, which also gives the rates of the others:
dq_j/dt = ∂V_eff/∂p_j. See `cosine` for a coordinate that occurs in sines and cosines only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Consequence, Proof
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.rotation import TIME

_LONGEST = 40  # operations of a condition for steady motion that tells a reader anything


class Introduced(NamedTuple):
    """Symbols that stand for what the user has not named."""

    E: sp.Symbol  # the energy
    u: sp.Symbol  # cos θ
    p: sp.Symbol  # all momenta, if they are equal
    gamma: sp.Symbol  # a rate


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

    @property
    def rate(self) -> sp.Expr:
        return sp.diff(self.coordinate, TIME)

    @property
    def rates(self) -> list[sp.Expr]:
        """Of the ignorable coordinates."""
        return [sp.diff(q, TIME) for q in self.ignorable]

    @cached_property
    def letters(self) -> Introduced:
        """Those that the user has not taken, with a prime where that is needed."""
        taken = {symbol.name for symbol in self.energy.free_symbols}
        names = (name + "_0" * (name in taken) for name in Introduced._fields)
        return Introduced(*map(sp.Symbol, names))

    @cached_property
    def turning(self) -> list[sp.Expr]:
        """The rates of the ignorable coordinates in θ and the momenta."""
        slopes = (sp.diff(self.potential, p) for p in self.symbols)
        return [sp.Add(*map(_shorter, sp.Add.make_args(slope))) for slope in slopes]

    def proved(self, residual: sp.Expr, claim: Formula) -> Proof:
        """That a residual vanishes with E and the momenta in terms of the motion."""
        values = dict(zip(self.symbols, self.momenta, strict=True)) | {self.letters.E: self.energy}
        held = sp.ImmutableMatrix([[residual.xreplace(values)]])
        return identity(held, claim, self.name)

    def one_dimension(self) -> Consequence:
        value = self.mass * self.rate**2 / 2 + self.potential
        claim = formula(r"E = \tfrac{1}{2}m\dot{q}^2 + V_{\mathrm{eff}}")
        return Consequence(
            title="The effective potential",
            text="Inserting the conserved momenta into the energy leaves a one-dimensional problem "
            "in {}, with the effective potential {}. {} turns back where {}.",
            spans=(
                *(self.coordinate, claims.EFFECTIVE, self.coordinate),
                formula("#1 = #2", claims.EFFECTIVE, claims.ENERGY),
            ),
            left=claims.ENERGY,
            value=value,
            proofs=(self.proved(self.letters.E - value, claim),),
        )

    def others(self) -> Iterator[Consequence]:
        """The rates of the ignorable coordinates, and what is left to integrate."""
        for k, (q, rate, value) in enumerate(
            zip(self.ignorable, self.rates, self.turning, strict=True)
        ):
            angle = claims.name_of(q)
            own = formula("#1(t)", claims.name_of(self.coordinate))
            integral = formula(
                r"#1(t) = #1(0) + \int_0^t #2\,dt", angle, claims.name_of(q, order=1)
            )
            yield Consequence(
                title="" if k else "The other coordinates",
                text="and {} from"
                if k
                else "The momenta give the rates of the other coordinates. If {} is known, {} "
                "follows by a quadrature from",
                spans=(integral,) if k else (own, integral),
                left=rate,
                value=value,
                proofs=(self.proved(rate - value, claims.RATE_OF_IGNORABLE),),
            )

    def steady(self) -> Iterator[Consequence]:
        """θ at rest: a condition on the rates of the others, quadratic for a top."""
        at_rest = self.acceleration.xreplace({self.rate: sp.S.Zero})
        rates = self.rates
        plain = {rate: sp.Dummy() for rate in rates}
        for k, spin in enumerate(rates):
            others = [rate for rate in rates if rate != spin]
            if len(others) != 1 or not self.symbols:
                return
            (turning,) = others
            given = self.momenta[k].xreplace(plain)
            slope = sp.diff(given, plain[spin])
            if slope.has(self.coordinate):  # not the spin about an axis of the body
                continue
            own = (self.symbols[k] - given.xreplace({plain[spin]: sp.S.Zero})) / slope
            condition = _factor(
                at_rest.xreplace(plain).xreplace({plain[spin]: own}), plain[turning]
            )
            if condition is None or condition.degree() != 2:
                continue
            if sp.count_ops(condition.as_expr()) > _LONGEST:
                return
            value = condition.as_expr().xreplace({plain[turning]: turning})
            of_spin = at_rest.xreplace({spin: own.xreplace({plain[turning]: turning})})
            residual = of_spin - sp.cancel(of_spin / value) * value
            yield Consequence(
                title="Steady motion",
                text="{} stays constant if",
                spans=(self.coordinate,),
                left=formula("0"),
                value=sp.collect(value, turning),
                proofs=(self.proved(residual, formula(r"\ddot{q} = 0")),),
            )
            yield from self._both_rates(condition, turning, self.symbols[k])
            return

    def _both_rates(
        self, condition: sp.Poly, turning: sp.Expr, spin: sp.Symbol
    ) -> Iterator[Consequence]:
        """The roots of the quadratic equation for steady motion, with when there are any."""
        a, b, c = condition.all_coeffs()
        below = sp.factor(b**2 - 4 * a * c)
        root = sp.sqrt(below)
        texts = (
            "If {} is not 0, this quadratic equation has two roots if {} is positive, and none if "
            "it is negative: steady precession at this inclination is then impossible. If {} is "
            "positive and large, the slow rate is nearly {}:",
            "The fast rate is then nearly {}:",
        )
        spans = ((a, below, spin, sp.cancel(-c / b)), (sp.cancel(-b / a),))
        for text, held, sign in zip(texts, spans, (-1, 1), strict=True):
            yield Consequence(
                title="",
                text=text,
                spans=held,
                left=turning,
                value=(-b + sign * root) / (2 * a),
                proofs=(_root_proof(a, b, c, sign, self.name),),
            )
        if a.has(self.coordinate):
            single = sp.cancel(-c / b)
            residual = sp.ImmutableMatrix([[b * single + c]])
            yield Consequence(
                title="",
                text="If {} is 0, there is one rate only:",
                spans=(a,),
                left=turning,
                value=single,
                proofs=(identity(residual, formula("b x + c = 0"), self.name),),
            )


def _shorter(value: sp.Expr) -> sp.Expr:
    """One fraction, with its factors if that is shorter."""
    return min(sp.cancel(value), sp.factor(value), key=sp.count_ops)


def _factor(value: sp.Expr, turning: sp.Symbol) -> sp.Poly | None:
    """The factor of the numerator that holds a rate, as a polynomial in it."""
    _, factors = sp.factor_list(sp.numer(sp.cancel(sp.together(value))))
    factors_with_rate = [base for base, _ in factors if base.has(turning)]
    if len(factors_with_rate) != 1:
        return None
    condition = sp.Poly(factors_with_rate[0], turning)
    lead = condition.LC()
    return condition if not lead.could_extract_minus_sign() else -condition


def _root_proof(a: sp.Expr, b: sp.Expr, c: sp.Expr, sign: int, name: str) -> Proof:
    """That the root of a quadratic equation is one; r stands for the root of the discriminant."""
    r = sp.Dummy("r")
    x = (-b + sign * r) / (2 * a)
    residual = sp.ImmutableMatrix([[a * x**2 + b * x + c - (r**2 - (b**2 - 4 * a * c)) / (4 * a)]])
    return identity(residual, formula(r"a x^2 + b x + c = 0"), name)
