"""Inputs of functions and their results, rounded once from 50 digits, for a test in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import isfinite
from operator import eq, ge, gt, le, lt
from textwrap import fill
from typing import Any

import mpmath

from rigidsym.kernels.ir import (
    Call,
    Choice,
    Compare,
    Expression,
    Guarded,
    Kernel,
    Name,
    Negative,
    Number,
    Product,
    Sum,
)
from rigidsym.kernels.targets.precision import Precision

_POINTS, _TRIED = 2, 12  # of each function; where a result is not real, the next is tried
_ALLOWED = 1024  # eps of the largest entry
_TERMS = 40  # of the series of c_k
_RELATIONS = {"<": lt, "<=": le, ">": gt, ">=": ge, "==": eq}
_ROTATION = (12 / 13, -3 / 13, 4 / 13, 4 / 13, 12 / 13, -3 / 13, -3 / 13, 4 / 13, 12 / 13)


def samples_of(kernel: Kernel, precision: Precision) -> Iterator[dict[str, Any]]:
    """What the test of a function gives to it and expects of it."""
    arguments, samples = kernel.arguments, 0
    for point in range(_TRIED):
        inputs = [
            _row(a.shape == (3, 3), len(a.components), point + k) for k, a in enumerate(arguments)
        ]
        values = _values(kernel, [x for row in inputs for x in row], precision.eps)
        if samples < _POINTS and all(map(isfinite, values)):
            samples += 1
            rows = {a.name: row for a, row in zip(arguments, inputs, strict=True)}
            yield {
                "arrays": [
                    (name, len(row), _wrapped(map(precision.literal, row)))
                    for name, row in (rows | {"expected": values}).items()
                ],
                "given": ", ".join((*rows, "out")),
                "most": precision.literal(_ALLOWED * precision.eps * max(1.0, *map(abs, values))),
            }


def _row(is_rotation: bool, count: int, point: int) -> list[float]:
    """A rotation matrix, or components in (0.2, 1.2) that are exact in both types."""
    if is_rotation:
        first = 3 * (point % 3)
        return [*_ROTATION[first:], *_ROTATION[:first]]
    return [(13 + (29 * point + 17 * k) % 64) / 64 for k in range(count)]


def _wrapped(literals: Iterable[str]) -> str:
    margin = " " * 12
    return fill(", ".join(literals), 88, initial_indent=margin, subsequent_indent=margin)


def _values(kernel: Kernel, given: Sequence[float], eps: float) -> list[float]:
    """The entries of the result; NaN where they are not real numbers."""
    numbers = mpmath.mp.__class__()
    numbers.dps = 50
    known: dict[str, Any] = dict(zip(kernel.components, map(numbers.mpf, given), strict=True))

    def value(e: Expression) -> Any:
        match e:
            case Name(text):
                return known[text]
            case Number(number):
                return numbers.convert(number)
            case Negative(operand):
                return -value(operand)
            case Sum(terms):
                return numbers.fsum(map(value, terms))
            case Product(factors, divisors):
                return numbers.fprod(map(value, factors)) / numbers.fprod(map(value, divisors))
            case Call("eps"):
                return numbers.mpf(eps)
            case Call("sin" | "cos" | "sqrt" | "atan2" | "abs" as name):
                function = getattr(numbers, {"abs": "fabs"}.get(name, name))
                return function(*map(value, e.arguments))
            case Call(_, square):
                powers = ((j, 2 * j + (e.order or 0)) for j in range(_TERMS))
                return numbers.fsum((-value(square)) ** j / numbers.factorial(k) for j, k in powers)
            case Guarded(divisor):
                return value(divisor)
            case Compare(relation, left, right):
                return _RELATIONS[relation](value(left), value(right))
            case Choice(condition, then, otherwise):
                return value(then) if value(condition) else value(otherwise)

    try:
        for assignment in kernel.assignments:
            known[assignment.name] = value(assignment.value)
        return [float(value(output)) for output in kernel.outputs]
    except (ArithmeticError, TypeError):  # a zero divisor, the root of a negative number
        return [float("nan")]
