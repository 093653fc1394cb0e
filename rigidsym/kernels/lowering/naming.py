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

from rigidsym.system.files import table_beside

_WORDS = table_beside(__file__, "reserved_words.toml")
WORDS = frozenset(keyword.kwlist).union(*(text.split() for text in _WORDS["everywhere"].values()))
NAMES = {target: frozenset(text.split()) for target, text in _WORDS["own"].items()}
_NOT_IN_A_NAME = re.compile(r"\W+")


class Names:
    """Gives out names, each once, and never one of `taken` or a word of a language."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.taken = {*WORDS, *taken}

    def copy(self) -> Names:
        return Names(self.taken)

    def fresh(self, wish: str) -> str:
        """The wish as an identifier, with underscores behind it where it is taken."""
        name = identifier(wish)
        while name in self.taken:
            name += "_"
        self.taken.add(name)
        return name

    def wished(self, wish: str) -> str:
        """The wish, with a number behind it where it is taken."""
        return self.fresh(wish) if wish not in self.taken else self.numbered(f"{wish}_")

    def numbered(self, prefix: str) -> str:
        """The first of prefix0, prefix1, ... that is free."""
        return self.fresh(next(n for k in count() if (n := f"{prefix}{k}") not in self.taken))


def identifier(text: str) -> str:
    r"""What a person chose as a name, `\theta'` or `2nd angle`, as an identifier.

    Underscores before it go, since such names are the generated module's own. Python reads
    identifiers in the normal form NFKC, in which ϕ and φ are one letter.
    """
    name = _NOT_IN_A_NAME.sub("_", normalize("NFKC", text)).strip("_")
    return name if name.isidentifier() else f"v{name}"
