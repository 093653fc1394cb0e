"""Names that clash with nothing: not with the inputs, not with the language's own words."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import count
from unicodedata import normalize

_NOT_IN_A_NAME = re.compile(r"\W+")


class Names:
    """Gives out names, each once; what is `taken` already is never given."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def copy(self) -> Names:
        return Names(self._taken)

    def fresh(self, wish: str) -> str:
        """The wish as an identifier, with underscores behind it where it is taken."""
        name = identifier(wish)
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name

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
