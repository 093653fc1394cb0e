"""The operations of kernels, counted as they are written."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from rigidsym.kernels.ir import Call, Choice, Expression, Negative, Product, Sum, walk

_OPERATIONS = {  # in words, one and several
    "trigonometric": ("sine or cosine", "sines and cosines"),
    "inverse": ("arctangent", "arctangents"),
    "entire": ("function c_k", "functions c_k"),
    "roots": ("square root", "square roots"),
    "sizes": ("absolute value", "absolute values"),
    "multiplications": ("multiplication", "multiplications"),
    "divisions": ("division", "divisions"),
    "additions": ("addition", "additions"),
    "negations": ("change of sign", "changes of sign"),
    "choices": ("choice", "choices"),
}
_KINDS = {"sin": "trigonometric", "cos": "trigonometric", "sqrt": "roots", "abs": "sizes"}
_KINDS["atan2"] = "inverse"


class Operations(Counter[str]):
    """What one value of a kernel costs, by kinds; subtractions count as additions."""

    def __str__(self) -> str:
        counts = [
            f"{self[kind]} {one if self[kind] == 1 else many}"
            for kind, (one, many) in _OPERATIONS.items()
            if self[kind]
        ]
        total = f"{self.total()} operation{'' if self.total() == 1 else 's'}"
        return f"{total}: {', '.join(counts)}" if counts else "no operations"


def count(expressions: Iterable[Expression]) -> Operations:
    """The operations in expressions as they are written."""
    counts = Operations()
    for node in (node for expression in expressions for node in walk(expression)):
        match node:
            case Choice():
                counts["choices"] += 1
            case Call("eps"):
                pass  # a constant of the type
            case Call(function):
                counts[_KINDS.get(function, "entire")] += 1
            case Product(factors, divisors):
                counts["multiplications"] += len(factors) - 1 + max(len(divisors) - 1, 0)
                counts["divisions"] += bool(divisors)
            case Sum(terms):
                counts["additions"] += len(terms) - 1
                counts["negations"] -= sum(isinstance(term, Negative) for term in terms[1:])
            case Negative():
                counts["negations"] += 1
    return counts
