"""Text that any format can hold: no control characters, no half characters, no hidden direction."""

from __future__ import annotations

import unicodedata


def cleaned(text: str) -> str:
    """The text with a blank in place of each character that is not printed, or ends a line."""
    if text.isprintable() and text.isascii():
        return text
    return "".join(" " if _is_hidden(c) else c for c in unicodedata.normalize("NFC", text))


def _is_hidden(character: str) -> bool:
    """Controls, formats such as a change of direction, surrogates, unassigned; line separators."""
    return unicodedata.category(character)[0] == "C" or unicodedata.category(character) in (
        "Zl",
        "Zp",
    )
