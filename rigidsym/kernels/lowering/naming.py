"""Names that clash with nothing: not with other names and not with words of any language.

A name is the same in every target: keywords of Python, C, C++ and JavaScript and the identifiers
of C's <math.h> are followed by an underscore everywhere (`lambda_`, `y0_`).
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable
from itertools import count
from unicodedata import normalize

_OF_C = (
    "auto bool break case char const continue default do double else enum extern float for goto if "
    "inline int long register restrict return short signed sizeof static struct switch typedef "
    "union unsigned void volatile while asm typeof"
)
_OF_CPP = (
    "alignas alignof and and_eq bitand bitor catch char8_t char16_t char32_t class co_await "
    "co_return co_yield compl concept consteval constexpr constinit const_cast decltype delete "
    "dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr "
    "operator or or_eq private protected public reinterpret_cast requires static_assert "
    "static_cast template this thread_local throw true try typeid typename using virtual wchar_t "
    "xor xor_eq"
)
_OF_JAVASCRIPT = (
    "arguments await debugger eval extends finally function implements import in instanceof "
    "interface let null package super undefined var with yield"
)
_OF_MATH_H = (
    "j0 j1 jn y0 y1 yn NAN INFINITY HUGE_VAL HUGE_VALF HUGE_VALL math_errhandling M_E M_LOG2E "
    "M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2 MAXFLOAT "
    "FP_NAN FP_INFINITE FP_ZERO FP_SUBNORMAL FP_NORMAL FP_ILOGB0 FP_ILOGBNAN DOMAIN OVERFLOW "
    "UNDERFLOW SING PLOSS TLOSS signgam isnan isinf isfinite isnormal signbit fpclassify"
)
WORDS = frozenset(
    {*keyword.kwlist, *_OF_C.split(), *_OF_CPP.split(), *_OF_JAVASCRIPT.split()}
    | {*_OF_MATH_H.split()}
)
_NOT_IN_A_NAME = re.compile(r"\W+")


class Names:
    """Gives out names, each once, and never one of `taken` or a word of a language."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {*WORDS, *taken}

    def copy(self) -> Names:
        return Names(self._taken)

    @property
    def taken(self) -> frozenset[str]:
        return frozenset(self._taken)

    def fresh(self, wish: str) -> str:
        """The wish as an identifier, with underscores behind it where it is taken."""
        name = identifier(wish)
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name

    def wished(self, wish: str) -> str:
        """The wish, with a number behind it where it is taken."""
        return self.fresh(wish) if wish not in self._taken else self.numbered(f"{wish}_")

    def numbered(self, prefix: str) -> str:
        """The first of prefix0, prefix1, ... that is free."""
        return self.fresh(next(n for k in count() if (n := f"{prefix}{k}") not in self._taken))


def identifier(text: str) -> str:
    r"""What a person chose as a name, `\theta'` or `2nd angle`, as an identifier.

    Underscores before it go, since such names are the generated module's own. Python reads
    identifiers in the normal form NFKC, in which ϕ and φ are one letter.
    """
    name = _NOT_IN_A_NAME.sub("_", normalize("NFKC", text)).strip("_")
    return name if name.isidentifier() else f"v{name}"
