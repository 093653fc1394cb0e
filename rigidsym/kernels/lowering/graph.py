"""SymPy expressions -> one graph -> assignments in order, and outputs, as people would write them.

Expressions are kept as a graph of sums and products in which equal things are one node, whatever
their sign. Common parts of several products or sums become nodes, first the pair that saves most.
Before that, sums may be multiplied out and factored anew: each step saves an operation, so that
they end. Factors are written in the order numbers, inputs, intermediate values, sines and cosines,
sums; terms with a plus come before terms with a minus.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import cache, lru_cache
from itertools import chain, combinations
from math import comb, gcd, nan, prod
from types import MappingProxyType
from typing import Any, TypeVar

import sympy as sp

from rigidsym.algebra.stable_forms import Stumpff
from rigidsym.errors import KernelError
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Assignment,
    Call,
    Choice,
    Compare,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    Sum,
)
from rigidsym.kernels.lowering.naming import Names
from rigidsym.mechanics.conversions.function import Epsilon, Where

# The kinds of nodes: an input has its name, a number its float; a held node is assigned as it is.
# All others are called by weighted nodes: a choice by a condition, a comparison, a function.
INPUT, NUMBER, PRODUCT, SUM, HELD, CHOICE = "input", "number", "product", "sum", "held", "choice"
# Divisions by one thing that a reciprocal and as many products replace. A division takes as long as
# two products in vectors (NumPy on AVX-512) and several in scalars, so that two would gain nothing.
_FEWEST_RECIPROCALS = 3
_MOST_TERMS = 24  # of a sum that is multiplied out
# Of terms, which take 0.1 s; a kernel with more keeps its form. Products of constants are tried
# with a twentieth of them: they made no long kernel shorter.
_MOST_PAIRS = 5000

Factors = tuple[int, ...]  # nodes in order; ~node divides
Weighted = tuple[Fraction, int]  # a number times a node
Monomial = tuple[Fraction, Factors]  # a number times nodes
PairOfTerms = tuple[int, int, int, int]  # two nodes, and the ratio of their numbers

# two terms over their common factors, these, and the operations that they save
Apart = Callable[[int, int], tuple[int, int, Factors, int]]

Pair = TypeVar("Pair", bound=Hashable)

_QUOTIENTS: Mapping[type, tuple[str, str]] = {  # numerator and denominator; "" for one
    sp.tan: ("sin", "cos"),
    sp.cot: ("cos", "sin"),
    sp.sec: ("", "cos"),
    sp.csc: ("", "sin"),
    sp.sin: ("sin", ""),
    sp.cos: ("cos", ""),
    sp.atan2: ("atan2", ""),
    Epsilon: ("eps", ""),
}


class Graph:
    """Nodes by number, read from SymPy; equal ones have one number. Inputs are known by name."""

    def __init__(
        self,
        kernel: str,
        inputs: Mapping[sp.Expr, str],
        definitions: Mapping[sp.Expr, sp.Expr] = MappingProxyType({}),
    ) -> None:
        self.nodes: list[tuple[str, Any]] = []  # their kind and what they are made of
        self.held: dict[int, str] = {}  # nodes that are assigned in this order, and their names
        self._numbers: dict[Hashable, int] = {}
        self._kernel = kernel
        self._inputs = inputs
        self._definitions = definitions
        self.one = self._node(PRODUCT, ())
        self._known: dict[sp.Expr, Monomial] = {
            symbol: (Fraction(1), (self._node(INPUT, name),)) for symbol, name in inputs.items()
        }

    # from SymPy

    def weighted(self, expression: sp.Expr) -> Weighted:
        """The expression as one node of the graph with a number before it."""
        coefficient, factors = self._monomial(expression)
        return coefficient, self._product(factors)

    def hold(self, symbol: sp.Symbol, value: sp.Expr) -> None:
        """A symbol for a value that gets an assignment of its own, after those before.

        Sums and products do not reach through it.
        """
        coefficient, node = weighted = self.weighted(value)
        kind = self.nodes[node][0]
        if node != self.one and node not in self.held and kind not in (INPUT, NUMBER):
            if coefficient != 1 or kind in (PRODUCT, SUM):
                coefficient, node = Fraction(1), self._node(HELD, (weighted,))
            self.held[node] = symbol.name
        self._known[symbol] = coefficient, self._factors(node)

    def _monomial(self, expression: sp.Expr) -> Monomial:
        if expression not in self._known:
            self._known[expression] = self._read(expression)
        return self._known[expression]

    def _read(self, expression: sp.Expr) -> Monomial:
        arguments, one = expression.args, Fraction(1)
        if expression in self._definitions:
            return self._monomial(self._definitions[expression])
        if expression.is_Rational:
            return Fraction(int(expression.p), int(expression.q)), ()
        if expression is sp.nan:
            return one, (self._node(NUMBER, nan),)
        if expression.is_number and expression.is_real:
            value = float(expression)
            return Fraction(-1 if value < 0 else 1), (self._node(NUMBER, abs(value)),)
        if expression.is_Mul:
            parts = list(map(self._monomial, arguments))
            coefficient = prod((number for number, _ in parts), start=one)
            return coefficient, tuple(chain.from_iterable(factors for _, factors in parts))
        if expression.is_Add:
            coefficient, node = self._sum(map(self.weighted, arguments))
            return coefficient, self._factors(node)
        if expression.is_Pow and (2 * expression.exp).is_Integer:
            return self._power(expression.base, expression.exp)
        if isinstance(expression, Stumpff):
            return one, (self._node(f"c{arguments[0]}", (self.weighted(arguments[1]),)),)
        if isinstance(expression, sp.Abs):
            number, node = self.weighted(arguments[0])
            return abs(number), (self._node("abs", ((one, node),)),)
        if isinstance(expression, Where):
            condition, *others = arguments
            sides = self.weighted(condition.lhs), self.weighted(condition.rhs)
            values = (one, self._node(condition.rel_op, sides)), *map(self.weighted, others)
            return one, (self._node(CHOICE, values),)
        if type(expression) in _QUOTIENTS:
            above, below = _QUOTIENTS[type(expression)]
            given = tuple(map(self.weighted, arguments))
            factors = [self._node(above, given)] if above else []
            factors += [~self._node(below, given)] if below else []
            return one, tuple(factors)
        raise KernelError(
            f"{self._kernel}: no kernel can compute {expression} ({type(expression).__name__}); "
            "expected sums, products, roots, sines and cosines of "
            + ", ".join(map(str, self._inputs))
        )

    def _power(self, base: sp.Expr, exponent: sp.Rational) -> Monomial:
        if exponent.is_Integer:
            times, (coefficient, factors) = int(exponent), self._monomial(base)
        else:
            # x^(k/2) = (√x)^k, so that all half-integer powers of a base share one root.
            times, coefficient = int(2 * exponent), Fraction(1)
            factors = (self._node("sqrt", (self.weighted(base),)),)
        factors = factors if times > 0 else tuple(~factor for factor in factors)
        return coefficient**times, factors * abs(times)

    def _factors(self, node: int) -> Factors:
        kind, factors = self.nodes[node]
        return factors if kind == PRODUCT else (node,)

    # nodes

    def _node(self, kind: str, value: Any) -> int:
        """The number of what is made so."""
        number = self._numbers.setdefault((kind, value), len(self.nodes))
        if number == len(self.nodes):
            self.nodes.append((kind, value))
        return number

    def _product(self, factors: Iterable[int]) -> int:
        """The product of nodes (~node divides); a node over itself goes away."""
        counted: dict[int, int] = defaultdict(int)
        for factor in factors:
            # ~n = −n − 1 has the other sign, so that the larger one of the two is the node.
            counted[max(factor, ~factor)] += 1 if factor >= 0 else -1
        counted.pop(self.one, None)
        flat = tuple(sorted(n if k > 0 else ~n for n, k in counted.items() for _ in range(abs(k))))
        return self._of_factors(flat)

    def _of_factors(self, flat: Factors) -> int:
        return flat[0] if len(flat) == 1 and flat[0] >= 0 else self._node(PRODUCT, flat)

    def _sum(self, terms: Iterable[Weighted]) -> Weighted:
        """The sum of weighted nodes, as one node whose sign and size have been taken out."""
        rest = _collected(terms)
        if len(rest) < 2:
            return rest[0] if rest else (Fraction(0), self.one)
        # the sign of most coefficients, and their size where it is one
        minuses = sum(c < 0 for c, _ in rest) - sum(c > 0 for c, _ in rest)
        sizes = {abs(c) for c, _ in rest}
        scale = sizes.pop() if len(sizes) == 1 else Fraction(1)
        if minuses > 0 or (minuses == 0 and rest[0][0] < 0):
            scale = -scale
        return scale, self._node(SUM, tuple((c / scale, node) for c, node in rest))

    def parts(self, node: int) -> list[int]:
        """The nodes that a node is made of, as often as it uses them."""
        kind, value = self.nodes[node]
        if kind == PRODUCT:
            return [max(factor, ~factor) for factor in value]
        return [] if kind in (INPUT, NUMBER) else [part for _, part in value]

    def reachable(self, roots: Iterable[int]) -> set[int]:
        """The nodes that the roots are made of."""
        reached = {*roots}
        waiting = [*reached]
        while waiting:
            parts = {*self.parts(waiting.pop())} - reached
            reached |= parts
            waiting += parts
        return reached

    def operations(self, node: int) -> int:
        """Those of a sum or a product, without its parts; a division counts as two."""
        kind, value = self.nodes[node]
        if kind == SUM:
            return len(value) - 1 + sum(c not in (1, -1) for c, _ in value)
        return len(value) - 1 + (value[0] < 0) if kind == PRODUCT and value else 0

    def divides(self, roots: Iterable[int]) -> bool:
        """Whether the roots have a divisor that is not a number."""
        nodes = map(self.nodes.__getitem__, self.reachable(roots))
        return any(kind == PRODUCT and value[:1] < (0,) for kind, value in nodes if value)

    # common parts

    def share(self, roots: Iterable[int]) -> None:
        """Give a node of its own to what several products or several sums have in common."""
        roots = list(roots)
        used = self._used(roots, PRODUCT)
        while pair := _most_saved(_factor_pairs(self.nodes[node][1]) for node in used):
            self._without_factors(used, *pair)
        self._take_reciprocals(used)
        self._factor(self._used(roots, SUM), lambda a, b: (a, b, (), 1))

    def factored(self, roots: list[int], constants: Iterable[str]) -> Graph | None:
        """The graph with its sums multiplied out and factored anew, if a term holds a sum.

        The product of several `constants` in a term becomes one factor, with a name. Divisors and
        arguments of functions stay, since guards judge the terms of a divisor.
        """
        kept = self.reachable(
            part
            for node in self.reachable(roots)
            for kind, value in [self.nodes[node]]
            for part in self.parts(node)
            if kind != SUM and (kind != PRODUCT or part not in value)
        )
        sums = [node for node in self._used(roots, SUM) if node not in kept]
        graph = copy(self)
        graph.nodes, graph._numbers = self.nodes.copy(), self._numbers.copy()
        fixed = {self._numbers[INPUT, name] for name in constants}
        is_other = [graph._multiply_out(node, sums, fixed) for node in sums]
        sums = [node for node in graph._used(roots, SUM) if node not in kept]
        pairs = sum(comb(len(graph.nodes[node][1]), 2) for node in sums)
        if not any(is_other) or pairs > (_MOST_PAIRS // 20 if fixed else _MOST_PAIRS):
            return None
        graph._factor(sums, cache(graph._apart))
        return graph

    def _multiply_out(self, node: int, sums: list[int], fixed: set[int]) -> bool:
        """Multiply out one sum in each term, unless it has a power; whether there is one."""
        terms: list[Weighted] = []
        for coefficient, term in self.nodes[node][1]:
            factors = self._factors(term)
            inner = [f for f in factors if f in sums and factors.count(f) == 1][:1]
            rest = [f for f in factors if f not in inner]
            parts = self.nodes[inner[0]][1] if inner else ((Fraction(1), self.one),)
            for number, part in parts:
                factors = *rest, *self._factors(part)
                group = self._product(f for f in factors if max(f, ~f) in fixed)
                if len(self._factors(group)) > 1:
                    held = self._node(HELD, ((Fraction(1), group),))
                    factors = held, *(f for f in factors if max(f, ~f) not in fixed)
                    fixed.add(held)
                terms.append((coefficient * number, self._product(factors)))
        is_other = len(self.nodes[node][1]) < len(terms) <= _MOST_TERMS
        if is_other:
            self._set_terms(node, terms)
        return is_other

    def _set_terms(self, node: int, terms: Iterable[Weighted]) -> None:
        self._redefine(node, tuple(_collected(terms)) or ((Fraction(0), self.one),))

    def _factor(self, sums: list[int], apart: Apart) -> None:
        """Give a node to the pair a + b in a d + b d = (a + b) d that saves most, and so on."""
        pairs = {node: _term_pairs(self.nodes[node][1], apart) for node in sums}
        while pair := _most_saved(saved for saved, _ in pairs.values()):
            one, two, above, below = pair
            scale, common = self._sum(((Fraction(1), one), (Fraction(above, below), two)))
            for node, (_, places) in [*pairs.items()]:
                if node != common and pair in places:
                    a, b, coefficient, factors = places[pair]
                    rest = [term for term in self.nodes[node][1] if term[1] not in (a, b)]
                    whole = self._product((*factors, common))
                    self._set_terms(node, (*rest, (coefficient * scale, whole)))
                    pairs[node] = _term_pairs(self.nodes[node][1], apart)
            if common not in pairs:
                pairs[common] = _term_pairs(self.nodes[common][1], apart)

    def _apart(self, a: int, b: int) -> tuple[int, int, Factors, int]:
        """Two terms over their common factors, these, and the operations that they save."""
        first, second, common = [*self._factors(a)], [*self._factors(b)], list[int]()
        for factor in self._factors(a):
            if factor in second:
                common.append(factor)
                first.remove(factor)
                second.remove(factor)
        one, two = self._of_factors(tuple(first)), self._of_factors(tuple(second))
        before, after = (sum(map(self.operations, pair)) for pair in ((a, b), (one, two)))
        return one, two, tuple(common), 1 + before - after - len(common)

    def _used(self, roots: list[int], kind: str) -> list[int]:
        """The nodes of one kind that the roots are made of, in their order."""
        return [node for node in sorted(self.reachable(roots)) if self.nodes[node][0] == kind]

    def _without_factors(self, used: list[int], a: int, b: int) -> None:
        # For a = b, each common part is a square and takes two factors.
        common = self._product((a, b))
        for node in used:
            times = _factor_pairs(self.nodes[node][1])[a, b]
            if times and node != common:
                factors = Counter(self.nodes[node][1])
                factors.subtract({a: 2 * times} if a == b else {a: times, b: times})
                factors[common] += times
                self._redefine(node, tuple(sorted(factors.elements())))
        if common not in used:
            used.append(common)

    def _take_reciprocals(self, used: list[int]) -> None:
        """One reciprocal for several divisions by one thing."""
        divided = Counter(f for node in used for f in set(self.nodes[node][1]) if f < 0)
        for divisor in sorted(f for f, n in divided.items() if n >= _FEWEST_RECIPROCALS):
            inverse = self._product((divisor,))
            for node in used:
                if node != inverse:
                    factors = (inverse if f == divisor else f for f in self.nodes[node][1])
                    self._redefine(node, tuple(sorted(factors)))

    def _redefine(self, node: int, value: Any) -> None:
        """Write a node in other terms; it can still be found by its new form."""
        kind, _ = self.nodes[node]
        self.nodes[node] = kind, value
        self._numbers.setdefault((kind, value), node)


def _collected(terms: Iterable[Weighted]) -> list[Weighted]:
    """The terms by node, each node once."""
    total: dict[int, Fraction] = {}
    for coefficient, node in terms:
        total[node] = total[node] + coefficient if node in total else coefficient
    return [(c, node) for node, c in sorted(total.items()) if c]


@lru_cache(maxsize=4096)  # a round alters few nodes
def _factor_pairs(factors: Factors) -> Counter[tuple[int, int]]:
    """Pairs of factors, and how often each can be taken out of the product at once."""
    counted = Counter(factors)
    pairs = {(a, b): min(counted[a], counted[b]) for a, b in combinations(sorted(counted), 2)}
    # aⁿ holds n // 2 squares. Taking them out round by round computes a power by repeated squaring.
    squares = {(a, a): times // 2 for a, times in counted.items() if times > 1}
    return Counter(pairs | squares)


def _term_pairs(
    terms: tuple[Weighted, ...], apart: Apart
) -> tuple[dict[PairOfTerms, int], dict[PairOfTerms, tuple[int, int, Fraction, Factors]]]:
    """Pairs of terms up to a common number: what each saves, and the terms and what they share."""
    savings, places = {}, {}
    for (c, a), (d, b) in combinations(terms, 2):
        one, two, common, saved = apart(a, b)
        if one > two:
            one, two, a, b, c, d = two, one, b, a, d, c
        above, below = d.numerator * c.denominator, d.denominator * c.numerator
        size = gcd(above, below) if below > 0 else -gcd(above, below)
        pair = one, two, above // size, below // size
        savings[pair], places[pair] = saved, (a, b, c, common)
    return savings, places


def _most_saved(found: Iterable[Mapping[Pair, int]]) -> Pair | None:
    """The pair that saves the most operations, if it saves more than the one that it takes.

    Among equals the one that is a whole node already, which comes without a new operation.
    """
    saved: Counter[Pair] = Counter()
    wholes: set[Pair] = set()
    for pairs in found:
        saved.update(pairs)
        if len(pairs) == 1:
            wholes.update(pairs)
    several = [pair for pair, operations in saved.items() if operations > 1]
    return max(several, key=lambda pair: (saved[pair], pair in wholes), default=None)


# From the graph to assignments

Rank = tuple[tuple[int, int], ...]

_NUMBER, _INPUT, _VALUE, _CALL, _SUM = range(5)
_LONGEST_ARGUMENT = 20  # letters that the name of a sine repeats; longer ones make wide lines
_ONE = Number(Fraction(1))
_CALL_ORDER = {function: place for place, function in enumerate(FUNCTIONS)}


def write(
    graph: Graph, outputs: Sequence[Weighted], names: Names
) -> tuple[tuple[Assignment, ...], tuple[Expression, ...]]:
    """Assignments for what is used twice, and the outputs in terms of them.

    Sines and cosines of inputs come first, angle by angle, then what is held in a given order.
    """
    writer = _Writer(graph, outputs, names)
    for node in (*writer.calls_on_inputs(), *graph.held):
        if node in writer.reachable:
            writer.node(node)
    written = tuple(writer.weighted(*output) for output in outputs)
    return tuple(writer.assignments), written


class _Writer:
    def __init__(self, graph: Graph, outputs: Sequence[Weighted], names: Names) -> None:
        self.graph = graph
        self.names = names
        self.assignments: list[Assignment] = []
        self._named: dict[int, Expression] = {graph.one: _ONE}
        self._ranks: dict[str, tuple[int, int]] = {}
        self._arguments: dict[Weighted, Name] = {}
        self._sines: dict[Weighted, int] = {}
        roots = [node for _, node in outputs]
        self.reachable = graph.reachable(roots)
        for node, (kind, value) in enumerate(graph.nodes):
            if kind == INPUT:
                self._named[node] = Name(value)
                self._ranks[value] = (_INPUT, node)
            elif kind == "sin" and node in self.reachable:
                self._sines[value[0]] = node
        parts = (part for node in sorted(self.reachable) for part in graph.parts(node))
        self._uses = Counter([*roots, *parts])

    def calls_on_inputs(self) -> list[int]:
        calls = [
            (arguments[0][1], _CALL_ORDER.get(kind, len(_CALL_ORDER)), node)
            for node, (kind, arguments) in enumerate(self.graph.nodes)
            if _is_function(kind)
            if all(scale == 1 and argument in self._named for scale, argument in arguments)
        ]
        return [node for _, _, node in sorted(calls)]

    def weighted(self, coefficient: Fraction, node: int) -> Expression:
        """A number times a node, with the sign where it costs least."""
        if node == self.graph.one or not coefficient:
            number = Number(abs(coefficient))
            return Negative(number) if coefficient < 0 else number
        size, expression = abs(coefficient), self.node(node)
        if size != 1:
            factors, divisors = _split(expression)
            if Fraction(float(size)) == size:  # one literal, since a double holds it exactly
                expression = Product((Number(size), *factors), divisors)
            else:
                whole = [] if size.numerator == 1 else [Number(Fraction(size.numerator))]
                divisors = (*divisors, Number(Fraction(size.denominator)))
                expression = Product((*whole, *factors) or (_ONE,), divisors)
        return self._negated(expression) if coefficient < 0 else expression

    def _negated(self, expression: Expression) -> Expression:
        """Minus an expression, without a change of sign where a sum can be turned around."""
        match expression:
            case Negative(operand):
                return operand
            case Sum(terms):
                return self._sum([self._negated(term) for term in terms])
            case Product(factors, divisors):
                # −(a − b) = b − a needs no operation, −(a + b) does.
                for place, factor in enumerate(factors):
                    if isinstance(factor, Sum) and any(
                        isinstance(term, Negative) for term in factor.terms
                    ):
                        turned = self._negated(factor)
                        return Product((*factors[:place], turned, *factors[place + 1 :]), divisors)
        return Negative(expression)

    def node(self, node: int) -> Expression:
        """The name of a node that has or deserves one, else what it is made of."""
        kind, value = self.graph.nodes[node]
        if kind == NUMBER:
            return Number(value)
        if node not in self._named:
            expression = self._build(node)
            is_plain = kind in (PRODUCT, SUM) or isinstance(expression, Compare)
            if is_plain and self._uses[node] < 2:
                return expression
            self._named[node] = self._assigned(expression, self.graph.held.get(node, ""))
        return self._named[node]

    def _assigned(self, value: Expression, wish: str = "") -> Name:
        rank = _VALUE
        if wish:
            name = self.names.wished(wish)
        elif isinstance(value, Call):  # sin_phi for sin(phi); a number for a long argument
            # eps is a number: in front of arrays, NumPy multiplies it by other numbers first
            rank = _NUMBER if value.function == "eps" else _CALL
            prefix, argument = f"{value.function}_", value.argument.text
            is_long = len(argument) > _LONGEST_ARGUMENT or value.second
            name = self.names.numbered(prefix) if is_long else self.names.fresh(prefix + argument)
        else:
            name = self.names.numbered("x")
        self._ranks[name] = (rank, len(self._ranks))
        self.assignments.append(Assignment(name, value))
        return Name(name)

    def _build(self, node: int) -> Expression:
        kind, value = self.graph.nodes[node]
        if kind == PRODUCT:
            return self._product(value)
        if kind == SUM:
            return self._sum(self._terms(value, Fraction(1)))
        if _is_function(kind):
            for each in value:  # half an angle has one name for all functions of it
                if each not in self._arguments:
                    text = self.weighted(*each)
                    name = text if isinstance(text, Name) else self._assigned(text)
                    self._arguments[each] = name
            if kind == "cos" and value[0] in self._sines:
                self.node(self._sines[value[0]])  # first: both can be taken in one call
            return Call(kind, *map(self._arguments.__getitem__, value))
        values = [self.weighted(*each) for each in value]
        if kind == HELD:
            return values[0]
        return Choice(*values) if kind == CHOICE else Compare(kind, *values)

    def _product(self, nodes: Sequence[int]) -> Expression:
        divisors = [self.node(~node) for node in nodes if node < 0]
        factors: list[Expression] = []
        for node in nodes:
            if node >= 0:
                above, below = _split(self.node(node))
                factors += above
                divisors += below
        numerator, denominator = (
            tuple(sorted(side, key=self._rank)) for side in (factors or [_ONE], divisors)
        )
        return Product(numerator, denominator)

    def _sum(self, terms: list[Expression]) -> Expression:
        if len(terms) == 1:
            return terms[0]
        # A term with a plus comes first, so that a sum with one begins without a minus.
        by_sign = sorted(terms, key=lambda term: (isinstance(term, Negative), self._rank(term)))
        return Sum(tuple(by_sign))

    def _terms(self, whole: Sequence[Weighted], scale: Fraction) -> list[Expression]:
        """The terms of a sum; a sum among them that has no name of its own is taken apart."""
        terms: list[Expression] = []
        for coefficient, part in whole:
            kind, value = self.graph.nodes[part]
            if kind == SUM and self._uses[part] < 2:
                terms += self._terms(value, scale * coefficient)
            else:
                terms.append(self.weighted(scale * coefficient, part))
        return terms

    def _rank(self, expression: Expression) -> Rank:
        match expression:
            case Name(text):
                return (self._ranks[text],)
            case Number():
                return ((_NUMBER, 0),)
            case Product(factors, _):
                ranks = [self._rank(f) for f in factors if not isinstance(f, Number)]
                return tuple(place for rank in ranks for place in rank)
            case Negative(operand):
                return self._rank(operand)
        return ((_SUM, 0),)


def _is_function(called: str) -> bool:
    return called.isidentifier() and called not in (INPUT, NUMBER, PRODUCT, SUM, HELD, CHOICE)


def _split(expression: Expression) -> tuple[tuple[Expression, ...], tuple[Expression, ...]]:
    """Factors and divisors, without a factor of one."""
    if not isinstance(expression, Product):
        return (expression,), ()
    return tuple(f for f in expression.factors if f != _ONE), expression.divisors
