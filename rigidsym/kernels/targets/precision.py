"""What differs between double and float, for targets that print their own sines."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import pi
from typing import Any

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.lowering.trigonometry import arctangent, reduction


@dataclass(frozen=True, slots=True)
class Precision:
    """A type of C, the unsigned type of its size, and its numbers."""

    real: str
    word: str
    suffix: str  # of functions and of literals
    bits: int  # of the type
    digits: int  # of its significand
    packed: tuple[str, str]  # the letters of both types for `struct`
    tiny: float  # the smallest normal number

    @property
    def eps(self) -> float:
        return float(2.0 ** (1 - self.digits))

    def literal(self, value: float) -> str:
        return f"{value!r}{self.suffix}"

    def named(self, function: str) -> str:
        return f"{function}{self.suffix}"

    def of_eps(self, power: int = 1) -> str:
        """A power of eps."""
        return self.literal(self.eps**power)

    @property
    def least(self) -> str:
        """The smallest normal number over eps."""
        return self.literal(self.tiny / self.eps)

    def filled(self, last: int) -> dict[str, Any]:
        """What the templates need; `last` is the highest order of the functions c_k."""
        found = reduction(self.digits)
        sine, cosine = self.falling(found.sine), self.falling(found.cosine)
        magic = 1.5 * 2.0 ** (self.digits - 1)  # a float of this size has no fraction
        letters, words = self.packed
        (word,) = struct.unpack(words, struct.pack(letters, magic))
        angles = arctangent(self.digits)
        return {
            "real": self.real,
            "word": self.word,
            "suffix": self.suffix,
            "point": f".0{self.suffix}",
            "sign_shift": self.bits - 2,
            "reach": f"{found.reach:.0f}",
            "shift": found.turns + 1,
            "magic": self.literal(magic),
            "least_word": f"{word - 2**found.turns:#x}u",
            "two_over_pi": self.literal(2 / pi),
            "parts": list(map(float, found.parts)),
            "first": (sine[0], cosine[0]),
            "rest": list(zip(sine[1:], cosine[1:], strict=True)),
            "edge": self.literal(angles.edge),
            "arctangent": self.falling(angles.coefficients),
            "eighth": list(map(self.literal, angles.eighth)),
            "series": [self._series(order) for order in range(FIRST_SERIES, last + 1)],
        }

    def falling(self, coefficients: Sequence[Fraction]) -> list[str]:
        """The literals of a polynomial from the highest power down, as Horner's rule takes them."""
        return [self.literal(float(coefficient)) for coefficient in reversed(coefficients)]

    def _series(self, order: int) -> dict[str, Any]:
        """c_k below its switch and above it."""
        series = series_of(order)
        return {
            "order": order,
            "before": order - 2,
            "near": self.falling(series.coefficients),
            "start": self.literal(float(taylor(order - 2)[0])),
            "switch": self.literal(float(series.switch)),
        }


PRECISIONS = (
    Precision("double", "uint64_t", "", 64, 53, ("d", "Q"), 2.0**-1022),
    Precision("float", "uint32_t", "f", 32, 24, ("f", "I"), 2.0**-126),
)
DOUBLE, SINGLE = PRECISIONS


class _EitherPrecision(Precision):
    """Macros of C for the type, its numbers and functions: one text, compiled for both types."""

    def literal(self, value: float) -> str:
        return f"LIT({value!r})"

    def named(self, function: str) -> str:
        return f"FN({function})"

    def of_eps(self, power: int = 1) -> str:
        return " * ".join(["EPS"] * power)

    @property
    def least(self) -> str:
        return "LEAST"


EITHER = _EitherPrecision("REAL", "WORD", "", 0, 0, ("", ""), 0.0)
