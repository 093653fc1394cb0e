"""Double and float for targets that print their own sines: spellings, and numbers, derived.

An angle x is n quarter turns and a rest r, |r| ≤ π/4. There sin r = r + r z S(z) and
cos r = 1 + z (−1/2 + z C(z)) with z = r². π/2 is cut in parts so short that n times each is exact.

With a ≥ b ≥ 0 the sizes of a point's coordinates, its angle from the nearer axis is atan b/a, or
π/4 + atan (b − a)/(b + a) if b/a > tan π/8. There atan t = t + t z A(z) with z = t². Multiples of
π/4 are added in two parts, of which the first is exact.

S, C and A are the polynomials through these functions in Chebyshev's points.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from functools import cache
from math import pi
from typing import Any, SupportsFloat

from mpmath import mp

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of, taylor

_DECIMALS = 400  # for the largest angles: 2/π in 38 words of 32 bits
_MARGIN = 1.02  # on |r| ≤ π/4: n is rounded from a rounded x
_EDGE = 0.41421  # under tan π/8, where both quotients have this size
_TOP = 0.17158  # over tan² π/8
_WORDS = 38  # of 2/π behind the point, enough for the largest double


@dataclass(frozen=True, slots=True)
class Precision:
    """A type of C, and how its numbers and functions are spelled."""

    real: str
    word: str  # the unsigned type of its size
    suffix: str  # of functions and of literals
    number: str  # the form of a literal
    function: str  # the form of a function's name
    eps: tuple[str, str]  # and its square
    least: str  # the smallest normal number over eps

    def literal(self, value: SupportsFloat) -> str:
        return self.number.format(repr(float(value)))

    def falling(self, coefficients: Iterable[Any]) -> list[str]:
        """The literals of a polynomial from the highest power down, as Horner's rule takes them."""
        return [self.literal(coefficient) for coefficient in coefficients]

    def filled(self, last: int) -> dict[str, Any]:
        """What the templates need; `last` is the highest order of the functions c_k."""
        series = [
            {
                "order": order,
                "before": order - 2,
                "near": self.falling(reversed(series_of(order).coefficients)),
                "start": self.literal(taylor(order - 2)[0]),
                "switch": self.literal(series_of(order).switch),
            }
            for order in range(FIRST_SERIES, last + 1)
        ]
        return {**asdict(self), "eps": self.eps[0], "series": series, **numbers(self)}


DOUBLE = Precision(
    "double", "uint64_t", "", "{}", "{}", (f"{2.0**-52}", f"{2.0**-104}"), f"{2.0**-970}"
)
SINGLE = Precision(
    "float", "uint32_t", "f", "{}f", "{}f", (f"{2.0**-23}f", f"{2.0**-46}f"), f"{2.0**-103}f"
)
PRECISIONS = (DOUBLE, SINGLE)
# Macros of C: one text, compiled for both types.
EITHER = Precision("REAL", "WORD", "", "LIT({})", "FN({})", ("EPS", "EPS * EPS"), "LEAST")


# Bits of the type and of its significand; |n| < 2**turns, else the angle is far; short parts of
# π/2; coefficients of S and C, and of A; the letters of both types for `struct`.
_SIZES = {"double": (64, 53, 21, 2, 6, 12, "dQ"), "float": (32, 24, 13, 3, 3, 5, "fI")}


@cache
def numbers(precision: Precision) -> dict[str, Any]:
    """The numbers of sine, cosine and arctangent in one precision."""
    bits, digits, turns, short, terms, flat_terms, letters = _SIZES[precision.real]
    # Adding and subtracting this number rounds to a whole number. With 1.5 in place of 1, the sum
    # keeps its exponent for negative numbers, too.
    magic = 1.5 * 2.0 ** (digits - 1)  # a float of this size has no fraction
    (word,) = struct.unpack(letters[1], struct.pack(letters[0], magic))
    with mp.workdps(60):
        # The functions are 0/0 at z = 0, but the points of Chebyshev are inside the interval.
        top = (_MARGIN * mp.pi / 4) ** 2
        sine = mp.chebyfit(lambda z: (mp.sinc(mp.sqrt(z)) - 1) / z, [0, top], terms)
        cosine = mp.chebyfit(lambda z: (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2, [0, top], terms)
        flat = mp.chebyfit(
            lambda z: (mp.atan(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, [0, _TOP], flat_terms
        )
        eighth = _cut(mp.pi / 4, digits - 3)
        low, rest, parts = mp.pi / 4 - eighth, mp.pi / 2, []
        # n has at most `turns` bits, and a part of `digits − turns` bits: their product is a float.
        for width in (*[digits - turns] * short, digits):
            parts.append(_cut(rest, width))
            rest -= parts[-1]
    p, q = precision.falling(sine), precision.falling(cosine)
    return {
        "point": f".0{precision.suffix}",
        "sign_shift": bits - 2,
        "reach": f"{2**turns * pi / 2:.0f}",  # the largest angle that the parts reduce
        "shift": turns + 1,
        "magic": precision.literal(magic),
        "least_word": f"{word - 2**turns:#x}u",
        "two_over_pi": precision.literal(2 / pi),
        "parts": list(map(float, parts)),
        "first": (p[0], q[0]),
        "rest": list(zip(p[1:], q[1:], strict=True)),
        "edge": precision.literal(_EDGE),  # up to this quotient it is taken itself
        "arctangent": precision.falling(flat),
        "eighth": precision.falling((eighth, low)),  # up to four times the first is exact
    }


def _cut(number: Any, bits: int) -> Any:
    """The number without all but its first bits."""
    places = bits - mp.mag(number)
    return mp.ldexp(mp.floor(mp.ldexp(number, places)), -places)


def two_over_pi() -> list[int]:
    """2/π in words of 32 bits, after two words of zeros, so that every angle finds its bits."""
    with mp.workdps(_DECIMALS):
        number = int(mp.floor(mp.ldexp(2 / mp.pi, 32 * _WORDS)))
    return [0, 0, *(number >> 32 * k & 0xFFFFFFFF for k in reversed(range(_WORDS)))]
