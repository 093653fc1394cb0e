"""SymPy expressions -> one graph, with the common subexpressions of all outputs of a kernel.

Expressions are kept as a graph of sums and products in which equal things are one node, whatever
their sign. Common parts of several products or sums become nodes, the most frequent pair first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping
from fractions import Fraction
from functools import lru_cache
from itertools import chain, combinations
from math import nan, prod
from types import MappingProxyType
from typing import TypeVar

import sympy as sp

from rigidsym.algebra.stable_forms import Stumpff
from rigidsym.errors import KernelError
from rigidsym.mechanics.conversions.function import Epsilon, Where

HELD, CHOICE = "held", "choice"  # functions: a value as it is; one of two by a condition
# Divisions by one thing that a reciprocal and as many products replace. A division takes as long as
# two products in vectors (NumPy on AVX-512) and several in scalars, so that two would gain nothing.
_FEWEST_RECIPROCALS = 3

Factors = tuple[int, ...]  # nodes in order; ~node divides
Terms = tuple[tuple[Fraction, int], ...]  # coefficient and node, in the order of the nodes
Weighted = tuple[Fraction, int]  # a number times a node
PairOfTerms = tuple[int, int, Fraction]  # two nodes, and the coefficient of the second

Pair = TypeVar("Pair", bound=Hashable)


class Graph:
    """Products, sums and atoms by number; equal ones have one number."""

    def __init__(self) -> None:
        self.products: dict[int, Factors] = {}
        self.sums: dict[int, Terms] = {}
        self.calls: dict[int, tuple[str, tuple[Weighted, ...]]] = {}
        self.held: dict[int, str] = {}  # nodes that are assigned in this order, and their names
        self.inputs: dict[str, int] = {}
        self.irrationals: dict[int, float] = {}
        self._numbers: dict[Hashable, int] = {}
        self.one = self.atom(())  # the empty product

    def atom(self, key: Hashable) -> int:
        """The number of what has this key."""
        return self._numbers.setdefault(key, len(self._numbers))

    def input(self, name: str) -> int:
        return self.inputs.setdefault(name, self.atom(name))

    def irrational(self, value: float) -> int:
        """A number that no fraction is: a fixed root, a fixed sine."""
        number = self.atom(value)
        self.irrationals.setdefault(number, value)
        return number

    def call(self, function: str, *arguments: Weighted) -> int:
        """A function of weighted nodes, a comparison or a choice."""
        number = self.atom((function, arguments))
        self.calls.setdefault(number, (function, arguments))
        return number

    def hold(self, name: str, value: Weighted) -> Weighted:
        """A value to be assigned as it is, so that sums and products do not reach through it."""
        coefficient, node = value
        is_made = node in self.calls or node in self.products or node in self.sums
        if node == self.one or node in self.held or not is_made:
            return value
        if coefficient != 1 or node not in self.calls:
            coefficient, node = Fraction(1), self.call(HELD, value)
        self.held[node] = name
        return coefficient, node

    def product(self, factors: Iterable[int]) -> int:
        """The product of nodes (~node divides); a node over itself goes away."""
        counted: Counter[int] = Counter()
        for factor in factors:
            counted[max(factor, ~factor)] += 1 if factor >= 0 else -1
        counted.pop(self.one, None)
        flat = tuple(sorted(n if k > 0 else ~n for n, k in counted.items() for _ in range(abs(k))))
        if len(flat) == 1 and flat[0] >= 0:
            return flat[0]
        number = self.atom(flat)
        self.products.setdefault(number, flat)
        return number

    def sum(self, terms: Iterable[Weighted]) -> Weighted:
        """The sum of weighted nodes, as one node whose sign and size have been taken out."""
        total: dict[int, Fraction] = {}
        for coefficient, node in terms:
            total[node] = total.get(node, Fraction(0)) + coefficient
        left = [(c, node) for node, c in sorted(total.items()) if c]
        if len(left) < 2:
            return left[0] if left else (Fraction(0), self.one)
        # the sign of most coefficients, and their size where it is one
        minuses = sum(c < 0 for c, _ in left) - sum(c > 0 for c, _ in left)
        sizes = {abs(c) for c, _ in left}
        scale = sizes.pop() if len(sizes) == 1 else Fraction(1)
        if minuses > 0 or (minuses == 0 and left[0][0] < 0):
            scale = -scale
        scaled = tuple((c / scale, node) for c, node in left)
        number = self.atom(scaled)
        self.sums.setdefault(number, scaled)
        return scale, number

    def factors(self, node: int) -> Factors:
        """What a node is the product of."""
        return self.products.get(node, (node,))

    def parts(self, node: int) -> list[int]:
        """The nodes that a node is made of, as often as it uses them."""
        if node in self.products:
            return [max(factor, ~factor) for factor in self.products[node]]
        if node in self.calls:
            return [part for _, part in self.calls[node][1]]
        return [part for _, part in self.sums.get(node, ())]

    def reachable(self, roots: Iterable[int]) -> set[int]:
        """The nodes that the roots are made of."""
        found: set[int] = set()
        waiting = list(roots)
        while waiting:
            node = waiting.pop()
            if node not in found:
                found.add(node)
                waiting.extend(self.parts(node))
        return found

    def share(self, roots: Iterable[int]) -> None:
        """Give a node of its own to what several products or several sums have in common."""
        roots = list(roots)
        used = self._used(self.products, roots)
        while pair := _most_common(map(_factor_pairs, used.values())):
            self._take_factors(used, *pair)
            used = self._used(self.products, roots)
        self._take_reciprocals(used)
        used_sums = self._used(self.sums, roots)
        while found := _most_common(map(_term_pairs, used_sums.values())):
            self._take_terms(used_sums, *found)
            used_sums = self._used(self.sums, roots)

    def _used(self, table: Mapping[int, Pair], roots: list[int]) -> dict[int, Pair]:
        """The part of a table that the roots are made of, in the order of the nodes."""
        return {node: table[node] for node in sorted(self.reachable(roots) & table.keys())}

    def _take_factors(self, used: Mapping[int, Factors], a: int, b: int) -> None:
        common = self.product((a, b))
        for node, whole in used.items():
            factors = Counter(whole)
            times = 0 if node == common else _factor_pairs(whole)[a, b]
            factors.subtract({a: 2 * times} if a == b else {a: times, b: times})
            factors[common] += times
            self._redefine(self.products, node, tuple(sorted(factors.elements())))

    def _take_terms(self, used: Mapping[int, Terms], a: int, b: int, ratio: Fraction) -> None:
        _, common = self.sum(((Fraction(1), a), (ratio, b)))
        for node, whole in used.items():
            terms = {part: c for c, part in whole}
            if node != common and a in terms and terms.get(b) == ratio * terms[a]:
                terms[common] = terms.pop(a)
                del terms[b]
                self._redefine(self.sums, node, tuple((c, n) for n, c in sorted(terms.items())))

    def _take_reciprocals(self, used: Mapping[int, Factors]) -> None:
        """One reciprocal for several divisions by one thing."""
        divided = Counter(f for factors in used.values() for f in set(factors) if f < 0)
        for divisor in sorted(f for f, n in divided.items() if n >= _FEWEST_RECIPROCALS):
            inverse = self.product((divisor,))
            for node in used:
                if node != inverse:
                    factors = (inverse if f == divisor else f for f in self.products[node])
                    self._redefine(self.products, node, tuple(sorted(factors)))

    def _redefine(self, table: dict[int, Pair], node: int, value: Pair) -> None:
        """Write a node in other terms; it can still be found by its new form."""
        table[node] = value
        self._numbers.setdefault(value, node)


@lru_cache(maxsize=4096)  # a round alters few nodes
def _factor_pairs(factors: Factors) -> Counter[tuple[int, int]]:
    """Pairs of factors, and how often each can be taken out of the product at once."""
    counted = Counter(factors)
    pairs = {(a, b): min(counted[a], counted[b]) for a, b in combinations(sorted(counted), 2)}
    squares = {(a, a): times // 2 for a, times in counted.items() if times > 1}
    return Counter(pairs | squares)


@lru_cache(maxsize=4096)
def _term_pairs(terms: Terms) -> Counter[PairOfTerms]:
    """Pairs of terms up to a common number."""
    return Counter((a, b, d / c) for (c, a), (d, b) in combinations(terms, 2))


def _most_common(found: Iterable[Counter[Pair]]) -> Pair | None:
    """The pair that occurs most often, of those that occur twice.

    Among equals the one that is a whole node already, which comes without a new operation.
    """
    times: Counter[Pair] = Counter()
    wholes: set[Pair] = set()
    for pairs in found:
        times.update(pairs)
        if len(pairs) == 1:
            wholes.update(pairs)
    several = [pair for pair, count in times.items() if count > 1]
    return max(several, key=lambda pair: (times[pair], pair in wholes), default=None)


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
    """From SymPy to one graph; inputs are its atoms, by their names."""

    def __init__(
        self,
        kernel: str,
        inputs: Mapping[sp.Expr, str],
        definitions: Mapping[sp.Expr, sp.Expr] = MappingProxyType({}),
    ) -> None:
        self.graph = Graph()
        self._kernel = kernel
        self._inputs = inputs
        self._definitions = definitions
        self._known: dict[sp.Expr, Monomial] = {
            symbol: (Fraction(1), (self.graph.input(name),)) for symbol, name in inputs.items()
        }

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
            parts = list(map(self._monomial, expression.args))
            coefficient = prod((number for number, _ in parts), start=Fraction(1))
            return coefficient, tuple(chain.from_iterable(factors for _, factors in parts))
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
        if exponent.is_Integer:
            times, (coefficient, factors) = int(exponent), self._monomial(base)
        else:
            root = self.graph.call("sqrt", self.weighted(base))
            times, coefficient, factors = int(2 * exponent), Fraction(1), (root,)
        factors = factors if times > 0 else tuple(~factor for factor in factors)
        return coefficient**times, factors * abs(times)

    def _factored(self, weighted: Weighted) -> Monomial:
        coefficient, node = weighted
        return coefficient, self.graph.factors(node)
