"""A graph with its common parts -> assignments in order, and outputs, as people would write them.

Factors stand in the order numbers, inputs, intermediate values, sines and cosines, sums; terms
with a plus come before terms with a minus.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction

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
from rigidsym.kernels.lowering.cse import CHOICE, HELD, Graph, Weighted
from rigidsym.kernels.lowering.naming import Names

Rank = tuple[tuple[int, int], ...]

_NUMBER, _INPUT, _VALUE, _CALL, _SUM = range(5)
_LONGEST_ARGUMENT = 20  # letters that the name of a sine repeats; longer ones make wide lines
_ONE = Number(Fraction(1))
_CALL_ORDER = {function: place for place, function in enumerate(FUNCTIONS)}


def write(
    graph: Graph, outputs: Sequence[Weighted], names: Names
) -> tuple[tuple[Assignment, ...], tuple[Expression, ...]]:
    """Assignments for what is used twice, and the outputs in terms of them."""
    writer = _Writer(graph, outputs, names)
    writer.calls_on_inputs()
    writer.held()
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
        for place, (name, node) in enumerate(graph.inputs.items()):
            self._named[node] = Name(name)
            self._ranks[name] = (_INPUT, place)
        roots = [node for _, node in outputs]
        self._reachable = graph.reachable(roots)
        self._sines = {
            arguments[0]: node
            for node, (function, arguments) in graph.calls.items()
            if function == "sin" and node in self._reachable
        }
        parts = (part for node in sorted(self._reachable) for part in graph.parts(node))
        self._uses = Counter([*roots, *parts])

    def calls_on_inputs(self) -> None:
        """Sines and cosines of inputs come first, angle by angle."""
        calls = [
            (arguments[0][1], _CALL_ORDER.get(function, len(_CALL_ORDER)), node)
            for node, (function, arguments) in self.graph.calls.items()
            if node in self._reachable and _is_function(function)
            if all(scale == 1 and argument in self._named for scale, argument in arguments)
        ]
        for _, _, node in sorted(calls):
            self._node(node)

    def held(self) -> None:
        """What is to be assigned in a given order."""
        for node in self.graph.held:
            if node in self._reachable:
                self._node(node)

    def weighted(self, coefficient: Fraction, node: int) -> Expression:
        """A number times a node, with the sign where it costs least."""
        if node == self.graph.one or not coefficient:
            number = Number(abs(coefficient))
            return Negative(number) if coefficient < 0 else number
        size, expression = abs(coefficient), self._node(node)
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
                for place, factor in enumerate(factors):
                    if isinstance(factor, Sum) and any(
                        isinstance(term, Negative) for term in factor.terms
                    ):
                        turned = self._negated(factor)
                        return Product((*factors[:place], turned, *factors[place + 1 :]), divisors)
        return Negative(expression)

    def _node(self, node: int) -> Expression:
        """The name of a node that has or deserves one, else what it is made of."""
        if node in self.graph.irrationals:
            return Number(self.graph.irrationals[node])
        if node not in self._named:
            expression = self._build(node)
            is_call = node in self.graph.calls and not isinstance(expression, Compare)
            if not is_call and self._uses[node] < 2:
                return expression
            self._named[node] = self._assigned(expression, self.graph.held.get(node, ""))
        return self._named[node]

    def _assigned(self, value: Expression, wish: str = "") -> Name:
        if wish:
            name = self.names.wished(wish)
            self._ranks[name] = (_VALUE, len(self._ranks))
        elif isinstance(value, Call):  # sin_phi for sin(phi); a number for a long argument
            is_long = len(value.argument.text) > _LONGEST_ARGUMENT or value.second
            prefix = f"{value.function}_"
            name = (
                self.names.numbered(prefix)
                if is_long
                else self.names.fresh(prefix + value.argument.text)
            )
            # eps is a number: in front of arrays, NumPy multiplies it by other numbers first
            self._ranks[name] = (_NUMBER if value.function == "eps" else _CALL, len(self._ranks))
        else:
            name = self.names.numbered("x")
            self._ranks[name] = (_VALUE, len(self._ranks))
        self.assignments.append(Assignment(name, value))
        return Name(name)

    def _argument(self, weighted: Weighted) -> Name:
        """The name of what functions are called with: half an angle has one for all of them."""
        if weighted not in self._arguments:
            value = self.weighted(*weighted)
            self._arguments[weighted] = value if isinstance(value, Name) else self._assigned(value)
        return self._arguments[weighted]

    def _build(self, node: int) -> Expression:
        if node in self.graph.calls:
            function, arguments = self.graph.calls[node]
            if not _is_function(function):
                values = [self.weighted(*each) for each in arguments]
                if function == HELD:
                    return values[0]
                return Choice(*values) if function == CHOICE else Compare(function, *values)
            names = [self._argument(argument) for argument in arguments]
            if function == "cos" and arguments[0] in self._sines:
                self._node(self._sines[arguments[0]])  # first: both can be taken in one call
            return Call(function, *names)
        if node in self.graph.products:
            return self._product(node)
        if node in self.graph.sums:
            return self._sum(self._terms(node, Fraction(1)))
        raise KernelError(f"node {node} of a kernel has no value")

    def _product(self, node: int) -> Expression:
        factors: list[Expression] = []
        divisors: list[Expression] = []
        for factor in self.graph.products[node]:
            if factor < 0:
                divisors.append(self._node(~factor))
            else:
                above, below = _split(self._node(factor))
                factors += above
                divisors += below
        factors = factors or [_ONE]
        return Product(
            tuple(sorted(factors, key=self._rank)), tuple(sorted(divisors, key=self._rank))
        )

    def _sum(self, terms: list[Expression]) -> Expression:
        if len(terms) == 1:
            return terms[0]
        by_sign = sorted(terms, key=lambda term: (isinstance(term, Negative), self._rank(term)))
        return Sum(tuple(by_sign))

    def _terms(self, node: int, scale: Fraction) -> list[Expression]:
        """The terms of a sum; a sum among them that has no name of its own is taken apart."""
        terms: list[Expression] = []
        for coefficient, part in self.graph.sums[node]:
            if part in self.graph.sums and self._uses[part] < 2:
                terms += self._terms(part, scale * coefficient)
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
    return called.isidentifier() and called not in (HELD, CHOICE)


def _split(expression: Expression) -> tuple[tuple[Expression, ...], tuple[Expression, ...]]:
    """Factors and divisors, without a factor of one."""
    if not isinstance(expression, Product):
        return (expression,), ()
    return tuple(f for f in expression.factors if f != _ONE), expression.divisors
