"""Text in short: what recurs is named once, and spelt again when the page is opened.

Pairs of tokens are named, and pairs of names in turn (N. J. Larsson and A. Moffat, Off-line
dictionary-based compression, Proc. IEEE 88, 2000). Formulas become ten times shorter, about what
base64 leaves of zlib, whose bytes change with its build, and which browsers unpack only after the
page has been shown.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

_TOKEN = re.compile(r"<(?!math)[^>]*>|\\n *|\w+|\s+|.", re.DOTALL)
_FIRST, _DIGITS = ord("#"), 92  # a symbol is two characters from # to ~
_MOST = _DIGITS**2  # symbols
_LEAST = 3  # times that a pair has to occur to be worth a name
_SHARE = 0.5  # of the most frequent pair: others that are named with it are at least as frequent

Symbols = npt.NDArray[np.int64]


def pack(text: str) -> Mapping[str, Sequence[str] | str]:
    """`words` are the first symbols, each pair in `rules` is the next one, `symbols` the text."""
    words: dict[str, int] = {}
    symbols = np.array(
        [words.setdefault(word, len(words)) for word in _TOKEN.findall(text)], np.int64
    )
    rules: list[int] = []
    while (count := len(words) + len(rules)) < _MOST:
        pairs = symbols[:-1] * _MOST + symbols[1:]
        named = [*_worth_a_name(pairs)][: _MOST - count]
        if not named:
            break
        for name, pair in enumerate(named, start=count):
            symbols[:-1][pairs == pair] = name
        symbols = np.delete(symbols, 1 + np.flatnonzero(np.isin(pairs, named)))
        rules += named
    return {
        "words": [*words],
        "rules": _code(symbol for pair in rules for symbol in divmod(pair, _MOST)),
        "symbols": _code(symbols.tolist()),
    }


def _worth_a_name(pairs: Symbols) -> Iterator[int]:
    """The most frequent pairs, of which no two share a symbol, so that no two overlap."""
    found, counts = np.unique(pairs[pairs % (_MOST + 1) != 0], return_counts=True)  # no "aa"
    frequent = counts >= max(_LEAST, _SHARE * counts.max(initial=0))
    taken: set[int] = set()
    for place in np.lexsort((found[frequent], -counts[frequent])):
        pair = int(found[frequent][place])
        if taken.isdisjoint(divmod(pair, _MOST)):
            taken |= {*divmod(pair, _MOST)}
            yield pair


def _code(symbols: Iterable[int]) -> str:
    digits = (digit for symbol in symbols for digit in divmod(symbol, _DIGITS))
    return "".join(chr(_FIRST + digit) for digit in digits)
