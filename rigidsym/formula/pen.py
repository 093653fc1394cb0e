"""What all pens have in common: the walk over the tree, and where a long formula may break.

A piece that has been written knows how wide it is and holds its lines' possible starts: before a
sign between two terms, in how many brackets. Nobody has to read it again to find them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from enum import IntEnum
from functools import lru_cache
from itertools import pairwise
from typing import Any, ClassVar, Self

from rigidsym.formula import tree
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.system.records import NamedTuple

DIVISOR = 50  # a divisor's brackets are as deep as so many others: 1/(1 + n²) is broken last
BREAKS = "+−±=≤<⇔"  # signs that may begin a line


class Binding(IntEnum):
    """How tightly the outermost operation of a piece holds it together, on one line of text."""

    SUM = 0
    QUOTIENT = 1
    PRODUCT = 2
    POWER = 3
    CALL = 4
    NUMBER = 5
    NAME = 6
    BRACKET = 7


class Height(IntEnum):
    """How high a piece stands beside a line of letters."""

    FLAT = 0
    RATE = 1  # dφ/dt, which is in small type within a matrix
    TALL = 2


class Segment(NamedTuple):
    """Part of a line that is never broken (a line may end before it), or a whole line."""

    text: str
    width: float
    level: int = 0  # in how many brackets it starts


_EMPTY = Segment("", 0.0)
_NO_FACTORS, _TIMES = (tree.Sign, tree.Words), tree.Sign("·")


class Piece(NamedTuple):
    """Part of a formula that has been written."""

    chunks: tuple[Segment, ...]
    width: float
    binding: Binding = Binding.NAME
    height: Height = Height.FLAT

    @property
    def text(self) -> str:
        return " ".join(chunk.text for chunk in self.chunks).rstrip()

    def deeper(self, level: int) -> Piece:
        """The same, so many brackets deeper."""
        first, *others = self.chunks
        chunks = (first, *(chunk._replace(level=chunk.level + level) for chunk in others))
        return self._replace(chunks=chunks)


def atom(
    text: str, width: float, binding: Binding = Binding.NAME, height: Height = Height.FLAT
) -> Piece:
    """A piece without a place to break."""
    return Piece((Segment(text, width, 0),), width, binding, height)


class Pen:
    """Writes formulas in one language; a subclass has a method named after each kind of node.

    There is one pen of a language and a notation, so that what it has written is kept for all.
    """

    notation: Notation

    _pens: ClassVar[dict[tuple[type, Notation], Any]] = {}
    blank: ClassVar[float] = 0.0  # width of the blank between two chunks
    sign: ClassVar[Callable[..., Piece]]  # of a Sign; `is_binary` between two parts
    between: ClassVar[Callable[..., Piece]]  # the space between two factors
    around: ClassVar[Callable[..., Piece]]  # a piece in brackets of a kind

    def __new__(cls, notation: Notation = DEFAULT) -> Self:
        pen = cls._pens.setdefault((cls, notation), super().__new__(cls))
        pen.notation = notation
        return pen

    def write(self, formula: tree.Formula) -> Piece:
        """The formula in the notation of this pen."""
        return _written(self, formula)

    def node(self, formula: tree.Formula) -> Piece:
        """One node, whose notation is settled; raises TypeError for a kind without a method."""
        return _node(self, formula)

    def row(self, node: tree.Row, *, is_tight: bool = False) -> Piece:
        """Factors, and signs at which a line may end; `is_tight` in an index."""
        pieces: list[Piece] = []
        before: tree.Formula | None = None
        for place, part in enumerate(node.parts):
            is_behind_sign = before is None or isinstance(before, tree.Sign)
            if isinstance(part, tree.Sign):
                sign = self.sign(part, is_binary=not (is_behind_sign or is_tight))
                if not is_behind_sign and part.character in BREAKS:
                    # An empty chunk before a sign between two terms is a place where a line may
                    # end.
                    sign = sign._replace(chunks=(_EMPTY, *sign.chunks))
                pieces.append(sign)
            else:
                if not (is_behind_sign or is_tight):
                    pieces.append(self.between(before, part))
                beside = (*node.parts[:place][-1:], *node.parts[place + 1 :][:1])
                is_alone = all(isinstance(p, _NO_FACTORS) and p != _TIMES for p in beside)
                pieces.append(self.node(part) if is_alone else self.factor(part))
            before = part
        signs = {part.character for part in node.parts if isinstance(part, tree.Sign)}
        if len(node.parts) == 2 and isinstance(node.parts[0], tree.Differential):
            binding = Binding.CALL
        elif signs - {"/"}:
            binding = Binding.SUM
        else:
            binding = Binding.QUOTIENT if signs else Binding.PRODUCT
        return self.glued(pieces, binding)

    def indices(self, index: tree.Formula) -> Piece:
        """An index, whose parts stand close together, and whose fractions on one line."""
        flat = _on_a_line(index)
        return self.row(flat if isinstance(flat, tree.Row) else tree.Row((flat,)), is_tight=True)

    def glued(self, pieces: Iterable[Piece], binding: Binding = Binding.CALL) -> Piece:
        """Pieces side by side, which break where each of them does."""
        chunks, height = [_EMPTY], Height.FLAT
        for piece in pieces:
            # No line may end between two pieces: the last chunk of one and the first of the next
            # are joined.
            (text, width, level), (first, *others) = chunks.pop(), piece.chunks
            chunks += (Segment(text + first.text, width + first.width, level), *others)
            height = max(height, piece.height)
        return Piece(tuple(chunks), _width(chunks, self.blank), binding, height)

    def within(self, opening: Piece, inside: Piece, closing: Piece, level: int = 1) -> Piece:
        """A piece in brackets, whose signs stand deeper by `level`."""
        return self.glued((opening, inside.deeper(level), closing), Binding.BRACKET)

    def factor(self, part: tree.Formula) -> Piece:
        """One of several factors."""
        return self.node(part)

    def apply(self, node: tree.Apply) -> Piece:
        applied = self.around(self.node(node.inside), "()")
        return self.glued((self.node(node.head), applied), Binding.BRACKET)

    def bracket(self, node: tree.Bracket) -> Piece:
        return self.around(self.node(node.inside), node.kind)

    def differentials(self, rate: tree.Rate) -> tuple[Piece, Piece]:
        """What stands above and below the line: d²x and dt²."""
        d, time = tree.Differential(), tree.Symbol("t")
        if rate.order == 1:
            return self.node(tree.row(d, rate.of)), self.node(tree.row(d, time))
        above, below = (tree.Power(base, tree.Numeral(str(rate.order))) for base in (d, time))
        return self.node(tree.row(above, rate.of)), self.node(tree.row(d, below))


@lru_cache(maxsize=16384)  # the terms of a sum come up in others
def _node(pen: Pen, formula: tree.Formula) -> Piece:
    kind = type(formula).__name__
    method = getattr(pen, kind.lower(), None)
    if method is None:
        raise TypeError(f"no pen for {kind}")
    return method(formula)


@lru_cache(maxsize=16384)
def _written(pen: Pen, formula: tree.Formula) -> Piece:
    return pen.node(pen.notation.applied(formula))


def _on_a_line(index: tree.Formula) -> tree.Formula:
    """√2/2 in place of a fraction, also within brackets."""
    if isinstance(index, tree.Fraction):
        return tree.row(index.above, tree.Sign("/"), index.below)
    if isinstance(index, tree.Bracket):
        return tree.Bracket(_on_a_line(index.inside), index.kind)
    return tree.row(*map(_on_a_line, index.parts)) if isinstance(index, tree.Row) else index


def break_lines(piece: Piece, width: float, indent: float, blank: float = 0.0) -> list[Segment]:
    """The lines of a formula; each after the first starts with its sign.

    `indent` is what a line loses for each open bracket, `blank` the width between two chunks.
    What has no place to break stays whole, so that a line may still be too wide.
    """
    lines = _lines(piece.chunks, width, indent, blank)
    # Brackets in a divisor count DIVISOR in a level; both kinds indent by one step.
    levels = [0, *(sum(divmod(line[0].level, DIVISOR)) for line in lines[1:])]
    return [
        Segment(" ".join(chunk.text for chunk in line), _width(line, blank), level)
        for line, level in zip(lines, levels, strict=True)
    ]


def _width(chunks: Sequence[Segment], blank: float) -> float:
    return sum(chunk.width for chunk in chunks) + blank * (len(chunks) - 1)


def _lines(
    chunks: Sequence[Segment], width: float, indent: float, blank: float
) -> list[Sequence[Segment]]:
    if len(chunks) == 1 or _width(chunks, blank) <= width:
        return [chunks]
    # The outermost signs break first, and as many terms as fit share a line.
    level = min(chunk.level for chunk in chunks[1:])
    cuts = [0, *(k for k, chunk in enumerate(chunks) if k and chunk.level == level), len(chunks)]
    lines: list[Sequence[Segment]] = []
    for start, end in pairwise(cuts):
        part = chunks[start:end]
        if lines and _width([*lines[-1], *part], blank) <= width:
            lines[-1] = [*lines[-1], *part]
        elif _width(part, blank) <= width:
            lines.append(part)
        else:
            # only a term that is too wide for a line of its own is broken inside its brackets
            lines += _lines(part, width - indent * (level % DIVISOR), indent, blank)
    return lines
