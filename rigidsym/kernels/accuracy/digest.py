"""The statements of a kernel as a short text, whatever its names are: to know it again."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256

from rigidsym.kernels.ir import (
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

DIGITS = 12  # hexadecimal: of a thousand kernels, two are alike with a probability of 2e-9


def digest(kernel: Kernel) -> str:
    """Equal for kernels that compute the same in the same order, and for no others but by chance.

    Names of components and of what is assigned do not count, nor does the function's own.
    """
    places = {name: f"i{k}" for k, name in enumerate(kernel.components)}
    places |= {assignment.name: f"x{k}" for k, assignment in enumerate(kernel.assignments)}
    pieces = [f"{a.name}:{len(a.components)}" for a in kernel.arguments]
    pieces += [_written(assignment.value, places) for assignment in kernel.assignments]
    pieces += ["=", *(_written(output, places) for output in kernel.outputs)]
    return sha256(";".join(pieces).encode()).hexdigest()[:DIGITS]


def _written(expression: Expression, places: Mapping[str, str]) -> str:
    def inside(*parts: Expression) -> str:
        return ",".join(_written(part, places) for part in parts)

    match expression:
        case Name(text):
            return places[text]
        case Number(value):
            return str(value)
        case Negative(operand):
            return f"-({inside(operand)})"
        case Sum(terms):
            return f"+({inside(*terms)})"
        case Product(factors, divisors):
            return f"*({inside(*factors)}/{inside(*divisors)})"
        case Call(function, argument):
            return f"{function}({inside(argument)})"
        case Guarded(value, scale, power):
            return f"?({inside(value)},{inside(scale) if scale else ''},{power})"
