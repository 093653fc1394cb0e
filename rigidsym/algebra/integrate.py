"""Exact integrals of polynomials in a variable, its sine and its cosine.

Term by term: ∫ uⁿ sᵃ cᵇ du goes back, by parts and by the reduction of the powers of a cosine, to
powers of u (I. S. Gradshteyn and I. M. Ryzhik, Table of Integrals, 2.510 and 2.633). Nothing is
believed: an antiderivative is differentiated, and the difference to the integrand reduced.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.ring import split
from rigidsym.errors import AlgebraError

Bounds = tuple[sp.Expr, sp.Expr]


def integration_codec(
    expressions: Sequence[sp.Expr], variables: Sequence[sp.Symbol], bounds: Sequence[Bounds]
) -> Codec:
    """The ring that holds the expressions, the variables, and both put at their bounds."""
    held = [*expressions, *variables]
    for variable, pair in zip(variables, bounds, strict=True):
        for bound in pair:
            held.append(bound)
            held += [
                function.xreplace({variable: bound})
                for expression in expressions
                for function in expression.atoms(sp.sin, sp.cos)
                if function.has(variable)
            ]
    return codec_for(held)


class Integrator:
    """Derivatives and integrals over one variable of a ring."""

    def __init__(self, codec: Codec, variable: sp.Symbol) -> None:
        self.codec, self.ring, self.variable = codec, codec.ring, variable
        self._place = self.ring.index[variable]
        self._pair: tuple[int, int] | None = None
        self._frequency = sp.S.One
        for sine, cosine in codec.angle_pairs:
            angle = self.ring.generators[sine].expression.args[0]
            if angle.has(variable):
                self._pair, self._frequency = (sine, cosine), angle / variable
        own = {self._place, *(self._pair or ())}
        self._others = [
            place
            for place, generator in enumerate(self.ring.generators)
            if place not in own and generator.expression.has(variable)
        ]
        self._basis = lru_cache(maxsize=None)(self._antiderivative_of_power)

    def derivative(self, element: PolyElement) -> PolyElement:
        """∂/∂u of an element; raises AlgebraError where another function of u is in it."""
        self._refuse_others(element)
        ring = self.ring
        total = element.diff(ring.generator(self._place))
        if self._pair is not None:
            sine, cosine = map(ring.generator, self._pair)
            # The chain rule with s = sin ωu and c = cos ωu: ∂F/∂u + ω (c ∂F/∂s − s ∂F/∂c).
            turned = element.diff(sine) * cosine - element.diff(cosine) * sine
            total += turned * self._number(self._frequency)
        return ring.reduce(total)

    def antiderivative(self, element: PolyElement) -> PolyElement:
        """F with ∂F/∂u = element, for an element in normal form."""
        self._refuse_others(element)
        places = (self._place, *(self._pair or ()))  # of u, sin u and cos u
        parts = (
            self._basis(*powers, *[0] * (3 - len(powers))) * part
            for powers, part in split(element, places).items()
        )
        return self.ring.total(parts)

    def between(self, antiderivative: PolyElement, bounds: Bounds) -> PolyElement:
        """F(upper) − F(lower)."""
        expression = self.codec.decode(antiderivative)
        lower, upper = (
            self.codec.encode(expression.xreplace({self.variable: bound})) for bound in bounds
        )
        return upper - lower

    def _antiderivative_of_power(self, n: int, a: int, b: int) -> PolyElement:
        """∫ uⁿ sᵃ cᵇ du, where a is 0 or 1, since s² = 1 − c² in normal form."""
        ring = self.ring
        u = ring.generator(self._place)
        if a == b == 0:
            return u ** (n + 1) * self._number(sp.Rational(1, n + 1))
        if n:  # by parts
            # ∫ uⁿ f du = uⁿ F − n ∫ uⁿ⁻¹ F du with F = ∫ f du. Each step lowers the power of u by
            # one.
            inner = self._basis(0, a, b)
            rest = self.antiderivative(ring.reduce(u ** (n - 1) * inner))
            return ring.reduce(u**n * inner - rest * n)
        assert self._pair is not None
        assert a < 2
        sine, cosine = map(ring.generator, self._pair)
        # ∫ sin ωu cosᵇ ωu du = −cosᵇ⁺¹ ωu / (ω (b + 1))
        if a == 1:
            return cosine ** (b + 1) * self._number(-1 / (self._frequency * (b + 1)))
        if b == 1:
            return sine * self._number(1 / self._frequency)
        # ∫ cosᵇ ωu du = cosᵇ⁻¹ ωu sin ωu / (ω b) + (b − 1)/b ∫ cosᵇ⁻² ωu du
        first = cosine ** (b - 1) * sine * self._number(1 / (self._frequency * b))
        return first + self._basis(0, 0, b - 2) * self._number(sp.Rational(b - 1, b))

    def _number(self, number: sp.Rational) -> PolyElement:
        return self.codec.encode(number)

    def _refuse_others(self, element: PolyElement) -> None:
        for monomial in element:
            for place in self._others:
                if monomial[place]:
                    function = self.ring.generators[place].expression
                    raise AlgebraError(
                        f"{function} is not integrated over {self.variable}: expected a polynomial "
                        f"in {self.variable}, its sine and its cosine; describe the solid by other "
                        "coordinates"
                    )
