"""The note within a page: blocks that stand in it or are packed, and buttons that copy."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.document.document import (
    Block,
    Document,
    Equation,
    EquationRow,
    Paragraph,
    Table,
    Text,
)
from rigidsym.notes.formats.html import Printer, escape

Packable = Equation | EquationRow | Paragraph | Table


class PagePrinter(Printer):
    """Blocks of a note; of those in `packed` only their places; `copied` have buttons."""

    def __init__(
        self, document: Document, *, copied: Collection[str], packed: Sequence[Packable] = ()
    ) -> None:
        super().__init__(document)
        self.copied = copied
        self._places = {block: place for place, block in enumerate(packed)}

    def unpacked(self, block: Packable) -> str:
        """What stands in the place of a block: of an equation its displays, not its number."""
        return self.forms(block) if isinstance(block, Equation) else self._block(block)

    def forms(self, equation: Equation) -> str:
        return self._place(equation) if equation in self._places else super().forms(equation)

    def _block(self, block: Block) -> str:
        if isinstance(block, EquationRow | Paragraph | Table) and block in self._places:
            return self._place(block)
        return super()._block(block)

    def _place(self, block: Packable) -> str:
        note = f"<code>{escape(self.document.name)}.html</code>"
        words = f"Shown with JavaScript; without, it stands in the note, {note}."
        return f'<p class="packed" data-packed="{self._places[block]}">{words}</p>'

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
