"""What generated files say of errors: of each function, and at their head of all of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.rounding import SINE, adds_angles, rounding
from rigidsym.kernels.targets.singular import calls_of

_LARGE = "Angles of any size are right."
_ADDED = (
    "Angles of any size are right as they are given; where they are added or multiplied before a "
    "sine is taken, the rounding of that counts: half an eps of its size."
)
_NAN = "NaN stays NaN, and the sine of infinity is NaN."


def accuracy(kernel: Kernel) -> Iterator[str]:
    """The errors of one function: what is proved, and what was measured."""
    bound = rounding(kernel)
    if bound is not None and bound.error:
        yield str(bound)
    if kernel.measured:
        yield kernel.measured


def remarks(kernels: Sequence[Kernel], tool: str) -> Iterator[str]:
    """Paragraphs for the head of a file; `tool` is what was measured with, where it was."""
    yield " ".join([_NAN, *_of_angles(kernels)])
    if any(rounding(kernel) for kernel in kernels):
        yield (
            "Bounds on rounding are in eps of the result's type, follow from the operations, and "
            f"hold where a sine or cosine is within {SINE:g} eps and inputs are exact as given."
        )
    if tool:
        yield (
            "Measured errors are the largest against 50 digits at points spread over the ranges "
            "that are named, in eps of the result's type, of the largest entry; where terms "
            "cancel, of their sizes together; other points may give more. Single precision is "
            f"measured at every other point. Measured with {tool}."
        )


def _of_angles(kernels: Sequence[Kernel]) -> Iterator[str]:
    called = {call.function for kernel in kernels for call in calls_of(kernel).values()}
    if not called.isdisjoint(("sin", "cos")):
        yield _ADDED if any(map(adds_angles, kernels)) else _LARGE
