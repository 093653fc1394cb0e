"""SymPy expressions -> one graph of sums, products and calls."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from fractions import Fraction
from math import nan
from types import MappingProxyType

import sympy as sp

from rigidsym.algebra.stable_forms import Stumpff
from rigidsym.errors import KernelError
from rigidsym.kernels.lowering.cse import CHOICE, Factors, Graph, Weighted
from rigidsym.kernels.lowering.degrees import DEGREE, FACTORS
from rigidsym.mechanics.conversions.function import Epsilon, Where

Monomial = tuple[Fraction, Factors]  # a number times nodes of the graph, ~node dividing

_QUOTIENTS: Mapping[type, tuple[str, str]] = {  # numerator and denominator; "" for one
    sp.tan: ("sin", "cos"),
    sp.cot: ("cos", "sin"),
    sp.sec: ("", "cos"),
    sp.csc: ("", "sin"),
    sp.sin: ("sin", ""),
    sp.cos: ("cos", ""),
}


class Reader:
    """From SymPy to one graph; inputs are its atoms, by their names, some of them in degrees."""

    def __init__(
        self,
        kernel: str,
        inputs: Mapping[sp.Expr, str],
        definitions: Mapping[sp.Expr, sp.Expr] = MappingProxyType({}),
        in_degrees: Collection[str] = (),
    ) -> None:
        self.graph = Graph()
        self._kernel = kernel
        self._inputs = inputs
        self._definitions = definitions
        self._known: dict[sp.Expr, Monomial] = {
            symbol: (Fraction(1), (self.graph.input(name),)) for symbol, name in inputs.items()
        }
        for factor, value in FACTORS.items() if in_degrees else ():
            self._known[factor] = Fraction(1), (self.graph.irrational(value),)
        for symbol, name in inputs.items():
            if name in in_degrees:
                self._known[symbol] = self._times(map(self._known.__getitem__, (DEGREE, symbol)))

    def weighted(self, expression: sp.Expr) -> Weighted:
        """The expression as one node of the graph with a number before it."""
        coefficient, factors = self._monomial(expression)
        return coefficient, self.graph.product(factors)

    def define(self, symbol: sp.Symbol, value: sp.Expr) -> int:
        """A symbol for a value; returns its node."""
        self._known[symbol] = self._monomial(value)
        return self.weighted(value)[1]

    def hold(self, symbol: sp.Symbol, value: sp.Expr) -> None:
        """A symbol for a value that gets an assignment of its own, after those before."""
        weighted = self.graph.hold(symbol.name, self.weighted(value))
        self._known[symbol] = self._factored(weighted)

    def _monomial(self, expression: sp.Expr) -> Monomial:
        known = self._known.get(expression)
        if known is None:
            known = self._known[expression] = self._read(expression)
        return known

    def _read(self, expression: sp.Expr) -> Monomial:
        if expression in self._definitions:
            return self._monomial(self._definitions[expression])
        if expression.is_Rational:
            return Fraction(int(expression.p), int(expression.q)), ()
        if expression is sp.nan:
            return Fraction(1), (self.graph.irrational(nan),)
        if expression.is_number and expression.is_real:
            value = float(expression)
            return Fraction(-1 if value < 0 else 1), (self.graph.irrational(abs(value)),)
        if expression.is_Mul:
            return self._times(self._monomial(factor) for factor in expression.args)
        if expression.is_Add:
            return self._factored(self.graph.sum(map(self.weighted, expression.args)))
        if expression.is_Pow and (2 * expression.exp).is_Integer:
            return self._power(expression.base, expression.exp)
        if isinstance(expression, Stumpff):
            order, square = expression.args
            return Fraction(1), (self.graph.call(f"c{order}", self.weighted(square)),)
        if isinstance(expression, sp.Abs):
            number, node = self.weighted(expression.args[0])
            return abs(number), (self.graph.call("abs", (Fraction(1), node)),)
        if isinstance(expression, sp.atan2 | Epsilon):
            name = "eps" if isinstance(expression, Epsilon) else "atan2"
            return Fraction(1), (self.graph.call(name, *map(self.weighted, expression.args)),)
        if isinstance(expression, Where):
            condition, *others = expression.args
            relation = self.graph.call(
                condition.rel_op, *map(self.weighted, (condition.lhs, condition.rhs))
            )
            values = (Fraction(1), relation), *map(self.weighted, others)
            return Fraction(1), (self.graph.call(CHOICE, *values),)
        if type(expression) in _QUOTIENTS:
            above, below = _QUOTIENTS[type(expression)]
            (argument,) = map(self.weighted, expression.args)
            factors = [self.graph.call(above, argument)] if above else []
            factors += [~self.graph.call(below, argument)] if below else []
            return Fraction(1), tuple(factors)
        raise KernelError(
            f"{self._kernel}: no kernel can compute {expression} ({type(expression).__name__}); "
            "expected sums, products, roots, sines and cosines of "
            + ", ".join(map(str, self._inputs))
        )

    def _power(self, base: sp.Expr, exponent: sp.Rational) -> Monomial:
        if not exponent.is_Integer:
            root = self.graph.call("sqrt", self.weighted(base))
            coefficient, factors = Fraction(1), _factors(root)
        else:
            coefficient, factors = self._monomial(base)
        times = int(exponent) if exponent.is_Integer else int(2 * exponent)
        factors = factors if times > 0 else tuple(~factor for factor in factors)
        return coefficient**times, factors * abs(times)

    def _times(self, monomials: Iterable[Monomial]) -> Monomial:
        coefficient, factors = Fraction(1), _factors()
        for number, more in monomials:
            coefficient, factors = coefficient * number, factors + more
        return coefficient, factors

    def _factored(self, weighted: Weighted) -> Monomial:
        coefficient, node = weighted
        return coefficient, self.graph.factors(node)


def _factors(*nodes: int) -> Factors:
    return nodes
