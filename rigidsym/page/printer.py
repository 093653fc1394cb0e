"""The note within a page: one form of each display, and buttons that copy it."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.document import Document, Equation, Paragraph, Table, Text
from rigidsym.notes.html import Printer, escape
from rigidsym.notes.layout import display

_ROOM = 39.5  # ems of a display; what is wider scrolls in a box of its own


class PagePrinter(Printer):
    """Blocks of a note, but for those in `left_out`; `copied` have buttons."""

    def __init__(
        self,
        document: Document,
        *,
        copied: Collection[str],
        left_out: Iterable[Equation | Table] = (),
    ) -> None:
        super().__init__(document)
        self.copied = copied
        self.left_out = frozenset(left_out)

    def forms(self, equation: Equation) -> str:
        if equation in self.left_out:
            return self._left_out()
        return self.display(equation, display(equation, self.document.notation, _ROOM), "display")

    def table(self, table: Table) -> str:
        return self._left_out() if table in self.left_out else super().table(table)

    def _left_out(self) -> str:
        note = f"<code>{escape(self.document.name)}.html</code>"
        return f'<p class="left-out">Too long for this page; the note, {note}, has it.</p>'

    def tools(self, equation: Equation) -> str:
        """Where the script puts a button a language, if there is something to copy."""
        if equation.label not in self.copied:
            return ""
        return f'<p class="copy" data-of="{escape(equation.label)}">{equation.number}</p>'

    def words(self, text: Text) -> str:
        """A sentence, in the notation of the document."""
        symbol = self.document.notation.manner.symbol
        renamed = (symbol(span) if isinstance(span, Markup) else span for span in text)
        return self._block(Paragraph(tuple(renamed)))
