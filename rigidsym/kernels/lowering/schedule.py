"""A graph with its common parts -> assignments in order, and outputs, as people would write them.

Factors stand in the order numbers, inputs, intermediate values, sines and cosines, sums; terms
with a plus come before terms with a minus.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction

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
from rigidsym.kernels.lowering.cse import CHOICE, HELD, INPUT, NUMBER, PRODUCT, SUM, Graph, Weighted
from rigidsym.kernels.lowering.naming import Names

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
