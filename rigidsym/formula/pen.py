"""What all pens have in common: the walk over the tree, and where a long formula may break.

A piece that has been written knows how wide it is and holds its lines' possible starts: before a
sign between two terms, in how many brackets. Nobody has to read it again to find them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import lru_cache
from itertools import pairwise
from typing import ClassVar, Self

from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.tree import (
    Apply,
    Big,
    Bracket,
    Differential,
    Formula,
    Fraction,
    FunctionCall,
    Gap,
    Indexed,
    Matrix,
    Numeral,
    Power,
    Radical,
    Rate,
    Row,
    Sign,
    Symbol,
    Words,
    row,
)

DIVISOR = 50  # a divisor's brackets are as deep as so many others: 1/(1 + n²) is broken last
RELATIONS = "=≤<⇔"
_BREAKS = f"+−±{RELATIONS}"


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
    RATE = 1  # dφ/dt, which large brackets of a fixed size embrace
    TALL = 2
    ROOTED = 3  # with a root, which is deeper


@dataclass(frozen=True, slots=True)
class Segment:
    """Part of a line that is never broken; a line may end before it."""

    text: str
    width: float
    level: int = 0  # in how many brackets the sign stands that it starts with


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a formula that has been written."""

    chunks: tuple[Segment, ...]
    width: float
    binding: Binding = Binding.NAME
    height: Height = Height.FLAT

    @property
    def text(self) -> str:
        return " ".join(chunk.text for chunk in self.chunks).rstrip()

    def solid(self) -> Piece:
        """The same, which nothing can break."""
        return replace(self, chunks=(Segment(self.text, self.width),))


class Pen:
    """Writes formulas in one language; a subclass spells, this class walks."""

    blank: ClassVar[float] = 0.0  # width of the blank between two chunks

    def __init__(
        self, notation: Notation = DEFAULT, *, loose: bool = False, short: bool = False
    ) -> None:
        self.notation = notation
        self.loose = loose  # whether a line may end within high brackets
        self.short = short  # whether s_θ and c_θ stand for sine and cosine

    def write(self, formula: Formula) -> Piece:
        """The formula in the notation of this pen."""
        pen: Callable[..., Pen] = type(self)
        return _written(pen, self.notation, self.loose, self.short, formula)

    def but(self, *, loose: bool = False, short: bool = False) -> Self:
        """The same pen, which lets lines end within high brackets, or abbreviates functions."""
        return type(self)(self.notation, loose=loose or self.loose, short=short or self.short)

    def node(self, formula: Formula) -> Piece:
        """One node, whose notation is settled."""
        match formula:
            case Symbol():
                return self.symbol(formula)
            case Row(parts):
                return self.row(parts)
            case Numeral(digits):
                return self.number(digits)
            case FunctionCall(function, argument, exponent):
                return self.call(function, self.node(argument), exponent, argument)
            case Power(base, exponent):
                return self.power(base, exponent)
            case Fraction(above, below):
                return self.fraction(self.node(above), self.node(below))
            case Bracket(inside, kind):
                return self.bracket(self.node(inside), kind)
            case Rate():
                return self.rate(formula)
            case Radical(inside):
                return self.root(self.node(inside))
            case Apply(head, inside):
                applied = self.bracket(self.node(inside), "()")
                return self.glued((self.node(head), applied), Binding.BRACKET)
            case Indexed(base, index):
                return self.indexed(self.node(base), self.indices(index))
            case Matrix(rows):
                return self.matrix([[self.node(entry) for entry in line] for line in rows])
            case Big(sign, below, above):
                bounds = (self.node(bound) if bound else None for bound in (below, above))
                return self.big(sign, *bounds)
            case Words(words):
                return self.words(words)
            case Differential(letter):
                return self.differential(letter)
            case Sign(character):
                return self.sign(character, is_binary=False)
            case Gap():
                return self.gap()
        raise TypeError(f"no pen for {type(formula).__name__}")

    def row(self, parts: Sequence[Formula], *, is_tight: bool = False) -> Piece:
        """Factors, and signs at which a line may end; `is_tight` in an index."""
        pieces: list[Piece] = []
        before: Formula | None = None
        for place, part in enumerate(parts):
            if isinstance(part, Sign):
                is_binary = before is not None and not isinstance(before, Sign)
                sign = self.sign(part.character, is_binary=is_binary and not is_tight)
                if is_binary and part.character in _BREAKS:
                    sign = replace(sign, chunks=(Segment("", 0.0), *sign.chunks))
                pieces.append(sign)
            else:
                if before is not None and not isinstance(before, Sign | Gap) and not is_tight:
                    pieces.append(self.between(before, part))
                is_alone = _is_alone(parts, place)
                pieces.append(self.node(part) if is_alone else self.factor(part))
            before = part
        return self.glued(pieces, _binding(parts))

    def indices(self, index: Formula) -> Piece:
        """An index, whose parts stand close together."""
        return self.row(index.parts if isinstance(index, Row) else (index,), is_tight=True)

    def glued(self, pieces: Iterable[Piece], binding: Binding = Binding.CALL) -> Piece:
        """Pieces side by side, which break where each of them does."""
        chunks = [Segment("", 0.0)]
        height = Height.FLAT
        for piece in pieces:
            first, *others = piece.chunks
            last = chunks[-1]
            chunks[-1] = Segment(last.text + first.text, last.width + first.width, last.level)
            chunks += others
            height = max(height, piece.height)
        return self.whole(chunks, binding, height)

    def whole(
        self, chunks: Sequence[Segment], binding: Binding, height: Height = Height.FLAT
    ) -> Piece:
        width = sum(chunk.width for chunk in chunks) + self.blank * (len(chunks) - 1)
        return Piece(tuple(chunks), width, binding, height)

    def atom(
        self,
        text: str,
        width: float,
        binding: Binding = Binding.NAME,
        height: Height = Height.FLAT,
    ) -> Piece:
        return Piece((Segment(text, width),), width, binding, height)

    def within(self, opening: Piece, inside: Piece, closing: Piece, level: int = 1) -> Piece:
        """A piece in brackets, whose signs stand deeper by `level`."""
        return self.glued((opening, self.deeper(inside, level), closing), Binding.BRACKET)

    def deeper(self, piece: Piece, level: int) -> Piece:
        """The same, so many brackets deeper."""
        first, *others = piece.chunks
        chunks = (first, *(replace(chunk, level=chunk.level + level) for chunk in others))
        return replace(piece, chunks=chunks)

    def factor(self, part: Formula) -> Piece:
        """One of several factors."""
        return self.node(part)

    def rate(self, rate: Rate) -> Piece:
        """The quotient of differentials; the whole of a bracket stands behind it."""
        raise NotImplementedError

    def differentials(self, rate: Rate) -> tuple[Formula, Formula]:
        """What stands above and below the line: d²x and dt²."""
        d, time = Differential(), Symbol("t")
        if rate.order == 1:
            return row(d, rate.of), row(d, time)
        order = Numeral(str(rate.order))
        return row(Power(d, order), rate.of), row(d, Power(time, order))

    def symbol(self, symbol: Symbol) -> Piece:
        raise NotImplementedError

    def indexed(self, base: Piece, index: Piece) -> Piece:
        raise NotImplementedError

    def number(self, digits: str) -> Piece:
        raise NotImplementedError

    def sign(self, character: str, *, is_binary: bool) -> Piece:
        raise NotImplementedError

    def between(self, before: Formula, after: Formula) -> Piece:
        """The space between two factors."""
        raise NotImplementedError

    def call(self, function: str, argument: Piece, exponent: int, given: Formula) -> Piece:
        raise NotImplementedError

    def power(self, base: Formula, exponent: Formula) -> Piece:
        raise NotImplementedError

    def fraction(self, above: Piece, below: Piece) -> Piece:
        raise NotImplementedError

    def bracket(self, inside: Piece, kind: str) -> Piece:
        raise NotImplementedError

    def root(self, inside: Piece) -> Piece:
        raise NotImplementedError

    def matrix(self, rows: Sequence[Sequence[Piece]]) -> Piece:
        raise NotImplementedError

    def big(self, sign: str, below: Piece | None, above: Piece | None) -> Piece:
        raise NotImplementedError

    def words(self, words: str) -> Piece:
        raise NotImplementedError

    def differential(self, letter: str) -> Piece:
        raise NotImplementedError

    def gap(self) -> Piece:
        raise NotImplementedError


@lru_cache(maxsize=16384)
def _written(
    pen: Callable[..., Pen], notation: Notation, loose: bool, short: bool, formula: Formula
) -> Piece:
    return pen(notation, loose=loose, short=short).node(notation.applied(formula))


def _is_alone(parts: Sequence[Formula], place: int) -> bool:
    """Whether a part stands between signs, with no other factor beside it."""
    beside = [parts[k] for k in (place - 1, place + 1) if 0 <= k < len(parts)]
    return all(isinstance(part, Sign | Gap | Words) and part != Sign("·") for part in beside)


def _binding(parts: Sequence[Formula]) -> Binding:
    if len(parts) == 2 and isinstance(parts[0], Differential):
        return Binding.CALL
    signs = {part.character for part in parts if isinstance(part, Sign)}
    if signs - {"/"}:
        return Binding.SUM
    return Binding.QUOTIENT if signs else Binding.PRODUCT


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a broken formula, and in how many open brackets it starts."""

    text: str
    width: float
    depth: int = 0


def break_lines(piece: Piece, width: float, indent: float, blank: float = 0.0) -> list[Line]:
    """The lines of a formula; each after the first starts with its sign.

    `indent` is what a line loses for each open bracket, `blank` the width between two chunks.
    What has no place to break stays whole, so that a line may still be too wide.
    """
    return [
        Line(
            " ".join(chunk.text for chunk in chunks),
            _width(chunks, blank),
            0 if not place else chunks[0].level % DIVISOR + chunks[0].level // DIVISOR,
        )
        for place, chunks in enumerate(_lines(piece.chunks, width, indent, blank))
    ]


def _width(chunks: Sequence[Segment], blank: float) -> float:
    return sum(chunk.width for chunk in chunks) + blank * (len(chunks) - 1)


def _lines(
    chunks: Sequence[Segment], width: float, indent: float, blank: float
) -> list[Sequence[Segment]]:
    if len(chunks) == 1 or _width(chunks, blank) <= width:
        return [chunks]
    level = min(chunk.level for chunk in chunks[1:])
    cuts = [0, *(k for k, chunk in enumerate(chunks) if k and chunk.level == level), len(chunks)]
    lines: list[list[Segment]] = []
    for start, end in pairwise(cuts):
        part = list(chunks[start:end])
        if lines and _width([*lines[-1], *part], blank) <= width:
            lines[-1] += part
        elif _width(part, blank) <= width:
            lines.append(part)
        else:
            # only a term that is too wide for a line of its own is broken inside its brackets
            room = width - indent * (level % DIVISOR)
            lines += map(list, _lines(part, room, indent, blank))
    return lines  # type: ignore[return-value]
