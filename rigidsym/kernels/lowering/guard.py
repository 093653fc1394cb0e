"""Divisors that vanish: at a pole a kernel gives NaN, not a number of 16 digits' noise.

A sine or cosine that divides is not told from zero where it is at most eps times its angle, which
is as far as the rounding of the angle reaches. The functions c_k of n² may be off by 4 eps of n,
a sum by 4 eps of the sizes of its terms; a sum of squares loses digits where it underflows, or
where what is squared is lost to the rounding of its angles.
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
)
from rigidsym.kernels.lowering.naming import Names

_ROUNDINGS = Number(Fraction(4))
_TURNED = ("sin", "cos")
_DOUBLE_ZERO = Number(Fraction(8))  # c₂ near a zero is half the square of the error of n over n


def guarded(kernel: Kernel, names: Names) -> Kernel:
    """The same kernel with its divisors guarded, as far as they can vanish.

    `names` gives out the names that are new.
    """
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
        self._known: dict[Expression, Expression] = {}

    def assign(self, name: str, value: Expression) -> Name:
        self.assignments.append(Assignment(name, value))
        self._values[name] = value
        return Name(name)

    def expression(self, whole: Expression) -> Expression:
        """The expression with its divisors guarded; what that takes is assigned before it."""
        match whole:
            case Negative(operand):
                return Negative(self.expression(operand))
            case Sum(terms):
                return Sum(tuple(map(self.expression, terms)))
            case Product(factors, divisors):
                return Product(
                    tuple(map(self.expression, factors)), tuple(map(self._divisor, divisors))
                )
        return whole

    def _divisor(self, divisor: Expression) -> Expression:
        if divisor not in self._known:
            self._known[divisor] = self._guarded(self.expression(divisor))
        return self._known[divisor]

    def _guarded(self, divisor: Expression) -> Expression:
        value = self._values.get(divisor.text) if isinstance(divisor, Name) else divisor
        if isinstance(value, Call) and isinstance(divisor, Name):
            return self._of_call(divisor, value)
        if isinstance(value, Sum):
            return self._of_sum(divisor, value)
        return divisor

    def _of_call(self, divisor: Name, call: Call) -> Name:
        order = call.order
        if call.function in _TURNED:
            return self._or_nan(divisor, call.argument)
        if order == 0:
            root = self.assign(self._names.numbered("x"), Call("sqrt", call.argument))
            scale = self.assign(self._names.numbered("x"), Product((_ROUNDINGS, root)))
            return self._or_nan(divisor, scale)
        if order == 1:
            return self._or_nan(divisor, _ROUNDINGS)
        return self._or_nan(divisor, _DOUBLE_ZERO, power=2) if order == 2 else divisor

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
        called = {v.argument: None for v in values if isinstance(v, Call) and v.function in _TURNED}
        sizes = [self.assign(self._names.numbered("x"), Call("abs", angle)) for angle in called]
        reach = self.assign(
            self._names.numbered("x"), Product((_ROUNDINGS, Sum((Number(Fraction(1)), *sizes))))
        )
        return self.assign(self._names.numbered("x"), Product((reach, reach)))

    def _parts(self, total: Sum) -> Iterator[Expression]:
        """The terms of a sum and of the sums among them."""
        for term in total.terms:
            value = self._values.get(term.text, term) if isinstance(term, Name) else term
            if isinstance(value, Sum):
                yield from self._parts(value)
            else:
                yield term

    def _is_positive(self, part: Expression) -> bool:
        """Whether it is a positive number, or a number times squares."""
        if isinstance(part, Number):
            return part.value > 0
        factors = [factor for factor in self._factors(part) if not isinstance(factor, Number)]
        numbers = [factor for factor in self._factors(part) if isinstance(factor, Number)]
        is_even = all(factors.count(factor) % 2 == 0 for factor in factors)
        return is_even and all(number.value > 0 for number in numbers)

    def _factors(self, part: Expression) -> Iterator[Expression]:
        """What is multiplied in a part, and in the products among its factors."""
        value = self._values.get(part.text, part) if isinstance(part, Name) else part
        if isinstance(value, Product) and not value.divisors:
            for factor in value.factors:
                yield from self._factors(factor)
        else:
            yield part

    def _sizes(self, total: Sum) -> Name:
        """The sum of the sizes of the terms, times the roundings that each may bring."""
        terms = [term.operand if isinstance(term, Negative) else term for term in total.terms]
        sizes = Product((_ROUNDINGS, Sum(tuple(map(self._size, terms)))))
        return self.assign(self._names.numbered("x"), sizes)

    def _size(self, term: Expression) -> Expression:
        if self._is_positive(term):
            return term
        name = self._named(term)
        return self.assign(self._names.numbered("x"), Call("abs", name))

    def _named(self, expression: Expression) -> Name:
        if isinstance(expression, Name):
            return expression
        return self.assign(self._names.numbered("x"), expression)

    def _or_nan(self, value: Name, scale: Name | Number | None, power: int = 1) -> Name:
        name = self._names.fresh(f"{value.text}_or_nan")
        return self.assign(name, Guarded(value, scale, power))
