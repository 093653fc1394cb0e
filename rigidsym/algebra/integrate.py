"""Exact integrals of polynomials in a variable, its sine and its cosine.

SymPy integrates powers of them. Nothing is believed: an antiderivative is differentiated, and the
difference to the integrand reduced.
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
    contents = [*expressions, *variables]
    for variable, pair in zip(variables, bounds, strict=True):
        for bound in pair:
            contents.append(bound)
            contents += [
                function.xreplace({variable: bound})
                for expression in expressions
                for function in expression.atoms(sp.sin, sp.cos)
            ]
    return codec_for(contents)


class Integrator:
    """Derivatives and integrals over one variable of a ring."""

    def __init__(self, codec: Codec, variable: sp.Symbol) -> None:
        self.codec, self.variable = codec, variable
        generators = enumerate(codec.ring.generators)
        self._places = [place for place, gen in generators if gen.expression.has(variable)]

    def derivative(self, element: PolyElement) -> PolyElement:
        """∂/∂u of an element."""
        return self.codec.encode(sp.diff(self.codec.decode(element), self.variable))

    def antiderivative(self, element: PolyElement) -> PolyElement:
        """F with ∂F/∂u = element, for an element in normal form.

        Raises AlgebraError if it holds another function of u.
        """
        generators, total = self.codec.ring.generators, self.codec.ring.zero
        for powers, part in split(element, self._places).items():
            factors = zip(self._places, powers, strict=True)
            function = sp.Mul(*(generators[k].expression ** power for k, power in factors))
            if not function.is_polynomial(self.variable, *function.atoms(sp.sin, sp.cos)):
                raise AlgebraError(
                    f"{function} is not integrated over {self.variable}: expected a polynomial "
                    f"in {self.variable}, its sine and its cosine; describe the solid by other "
                    "coordinates"
                )
            total += self.codec.encode(_integrate(function, self.variable)) * part
        return self.codec.ring.reduce(total)

    def between(self, antiderivative: PolyElement, bounds: Bounds) -> PolyElement:
        """F(upper) − F(lower)."""
        expression = self.codec.decode(antiderivative)
        lower, upper = (
            self.codec.encode(expression.xreplace({self.variable: bound})) for bound in bounds
        )
        return upper - lower


_integrate = lru_cache(maxsize=1024)(sp.integrate)
