"""Divisors that vanish: at a pole a kernel returns NaN instead of a number of pure rounding error.

A sine or cosine cannot be distinguished from zero if it is at most eps times its angle, the size of
the rounding error of the angle. The functions c_k of n² have errors of up to 4 eps of n, a sum of
up to 4 eps of the sizes of its terms; a sum of squares loses its digits if it underflows, or if
its terms are smaller than the rounding errors of their angles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from rigidsym.kernels.ir import (
    Assignment,
    Call,
    Expression,
    Guarded,
    Kernel,
    Name,
    Negative,
    Number,
    Product,
    Sum,
    rebuilt,
)
from rigidsym.kernels.lowering.naming import Names

_ROUNDINGS = Number(Fraction(4))
_DOUBLE_ZERO = Number(Fraction(8))  # c₂ near a zero is half the square of the error of n over n


def guarded(kernel: Kernel, names: Names) -> Kernel:
    """The same kernel with its divisors guarded, as far as they can vanish.

    `names` gives out the names that are new.
    """
    if not kernel.divisors:
        return kernel
    guard = _Guard(names)
    for assignment in kernel.assignments:
        value = guard.expression(assignment.value)
        guard.assign(assignment.name, value)
    outputs = tuple(map(guard.expression, kernel.outputs))
    return replace(kernel, assignments=tuple(guard.assignments), outputs=outputs)


class _Guard:
    def __init__(self, names: Names) -> None:
        self.assignments: list[Assignment] = []
        self._names = names
        self._values: dict[str, Expression] = {}
        self._known: dict[Expression, Expression] = {}  # divisors
        self._made: dict[Expression, Name] = {}  # sizes and limits

    def assign(self, name: str, value: Expression) -> Name:
        self.assignments.append(Assignment(name, value))
        self._values[name] = value
        return Name(name)

    def expression(self, whole: Expression) -> Expression:
        """The expression with its divisors guarded; what that takes is assigned before it."""
        if isinstance(whole, Product):
            factors = tuple(map(self.expression, whole.factors))
            return Product(factors, tuple(map(self._divisor, whole.divisors)))
        return rebuilt(self.expression, whole) if isinstance(whole, Negative | Sum) else whole

    def _divisor(self, divisor: Expression) -> Expression:
        if divisor not in self._known:
            self._known[divisor] = self._guarded(self.expression(divisor))
        return self._known[divisor]

    def _guarded(self, divisor: Expression) -> Expression:
        value = self._value(divisor)
        match value:
            case Sum():
                return self._of_sum(divisor, value)
            case Call("sin" | "cos", angle):
                return self._or_nan(divisor, angle)
            case Call("c0", square):
                root = self._new(Call("sqrt", square))
                return self._or_nan(divisor, self._new(Product((_ROUNDINGS, root))))
            case Call("c1"):
                return self._or_nan(divisor, _ROUNDINGS)
            case Call("c2"):
                return self._or_nan(divisor, _DOUBLE_ZERO, power=2)
        return divisor

    def _value(self, expression: Expression) -> Expression:
        """What is behind a name, if it is not an input."""
        if not isinstance(expression, Name):
            return expression
        return self._values.get(expression.text, expression)

    def _of_sum(self, divisor: Expression, total: Sum) -> Expression:
        """A sum of squares and a number never vanishes; one of squares alone may underflow."""
        parts = list(self._parts(total))
        is_positive = all(map(self._is_positive, parts))
        if is_positive and any(isinstance(part, Number) for part in parts):
            return divisor
        name = self._named(divisor)
        if is_positive and not all(map(self._is_given, parts)):
            return self._or_nan(name, self._reach(), power=2)
        return self._or_nan(name, None if is_positive else self._sizes(total))

    def _is_given(self, part: Expression) -> bool:
        """Whether a product is one of inputs alone, which hold no rounding."""
        names = (factor for factor in self._factors(part) if isinstance(factor, Name))
        return not any(name.text in self._values for name in names)

    def _reach(self) -> Name:
        """The square of how far rounding reaches where sines and cosines are squared, over eps²."""
        values = self._values.values()
        called = {
            v.argument: None for v in values if isinstance(v, Call) and v.function in ("sin", "cos")
        }
        sizes = [self._new(Call("abs", angle)) for angle in called]
        reach = self._new(Product((_ROUNDINGS, Sum((Number(Fraction(1)), *sizes)))))
        return self._new(Product((reach, reach)))

    def _parts(self, total: Sum) -> Iterator[Expression]:
        """The terms of a sum and of the sums among them."""
        for term in total.terms:
            value = self._value(term)
            if isinstance(value, Sum):
                yield from self._parts(value)
            else:
                yield term

    def _is_positive(self, part: Expression) -> bool:
        """Whether it is a positive number, or a number times squares."""
        factors = list(self._factors(part))
        return all(
            factor.value > 0 if isinstance(factor, Number) else factors.count(factor) % 2 == 0
            for factor in factors
        )

    def _factors(self, part: Expression) -> Iterator[Expression]:
        """What is multiplied in a part, and in the products among its factors."""
        value = self._value(part)
        if isinstance(value, Product) and not value.divisors:
            for factor in value.factors:
                yield from self._factors(factor)
        else:
            yield part

    def _sizes(self, total: Sum) -> Name:
        """The sum of the sizes of the terms, times the roundings that each may bring."""
        sizes = []
        for term in total.terms:
            part = term.operand if isinstance(term, Negative) else term
            is_size = self._is_positive(part)
            sizes.append(part if is_size else self._new(Call("abs", self._named(part))))
        return self._new(Product((_ROUNDINGS, Sum(tuple(sizes)))))

    def _named(self, expression: Expression) -> Name:
        return expression if isinstance(expression, Name) else self._new(expression)

    def _new(self, value: Expression) -> Name:
        if value not in self._made:
            self._made[value] = self.assign(self._names.numbered("x"), value)
        return self._made[value]

    def _or_nan(self, divisor: Expression, scale: Name | Number | None, power: int = 1) -> Name:
        value = self._named(divisor)
        return self.assign(self._names.fresh(f"{value.text}_or_nan"), Guarded(value, scale, power))
