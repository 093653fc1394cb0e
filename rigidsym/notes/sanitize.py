"""Text that any format can hold: no control characters, no half characters, no hidden direction."""

from __future__ import annotations

import unicodedata

# controls, formats such as a change of direction, surrogates, unassigned; line separators
_HIDDEN = ("C", "Zl", "Zp")


def cleaned(text: str) -> str:
    """The text with a blank in place of each character that is not printed, or ends a line."""
    if text.isprintable() and text.isascii():
        return text
    return "".join(
        " " if unicodedata.category(c).startswith(_HIDDEN) else c
        for c in unicodedata.normalize("NFC", text)
    )
