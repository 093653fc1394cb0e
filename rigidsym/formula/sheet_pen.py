"""What is common to the pens that typeset: sizes of brackets, widths, lines below one another.

Widths are in ems of Latin Modern at 11 points, rounded up. A test sets formulas with TeX and
compares.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

from rigidsym.formula import tree
from rigidsym.formula.pen import Binding, Height, Pen, Piece, atom
from rigidsym.formula.tree import Symbol

SCRIPT = 0.8  # size of indices and exponents
OPERATOR_SPACE = 0.34  # thin spaces on both sides of a function
THIN = 0.17
QUAD = 1.0
EQUAL = 1.34
PRIME = 0.26
FRACTION = 0.26  # beyond the wider of its two parts
ROOT = 0.9
DIGIT = 0.5
BRACKET = 0.39
LARGE = {"flat": 0.0, "large": 0.25, "stretched": 0.35}  # beyond the bracket
COLUMN_GAP = 0.92
TALL_BRACKETS = 1.62
BIG = 1.45

_GREEK = {
    **dict.fromkeys(("iota", "epsilon", "delta"), 0.49),
    **dict.fromkeys(("theta", "xi", "zeta", "rho", "eta", "tau"), 0.56),
    **dict.fromkeys(("nu", "upsilon", "gamma", "kappa", "lamda"), 0.6),
    **dict.fromkeys(("mu", "pi", "sigma", "phi", "beta", "chi", "alpha"), 0.65),
    **dict.fromkeys(("omega", "psi", "Gamma", "Xi", "Lamda"), 0.7),
    **dict.fromkeys(("Omega", "Phi", "Sigma", "Pi", "Theta", "Upsilon", "Psi"), 0.78),
    "Delta": 0.84,
}
_LETTERS = {
    **dict.fromkeys("lijt", 0.41),
    **dict.fromkeys("bcers", 0.52),
    **dict.fromkeys("adfghknopquvxyz", 0.62),
    **dict.fromkeys("mw", 0.88),
    **dict.fromkeys("MW", 1.16),
    **dict.fromkeys("0123456789", DIGIT),
}
_SIGNS = {"+": 1.23, "−": 1.23, "±": 1.23, "=": EQUAL, "·": 0.8, "/": 0.5, ",": 0.45, ";": 0.45}
_FUNCTIONS = {"sin": 1.24, "cos": 1.34, "tan": 1.46, "cot": 1.34, "det": 1.39}
_FACES = {"bold": 1.2, "sans": 1.05}
_WORD = 0.87
_CAPITAL = 0.92
_UNKNOWN = 1.0


def letter_width(symbol: Symbol) -> float:
    """Of a symbol without its prime and index."""
    width = sum(map(_letter, symbol.letter)) * _FACES.get(symbol.face, 1.0)
    return width * _WORD if len(symbol.letter) > 1 else width


def _letter(letter: str) -> float:
    if letter in _LETTERS:
        return _LETTERS[letter]
    kind, _, name = unicodedata.name(letter, "").partition(" LETTER ")
    greek = {"GREEK SMALL": name.lower(), "GREEK CAPITAL": name.title()}.get(kind, "")
    return _GREEK.get(greek) or (_CAPITAL if letter.isalpha() else _UNKNOWN)


def function_width(name: str) -> float:
    own = _FUNCTIONS.get(name)
    return (own if own else sum(map(_letter, name))) + OPERATOR_SPACE


Size = Literal["flat", "large", "stretched"]


class Aligned(NamedTuple):
    """A line of a display: what stands before its first sign, and what behind; or all in one."""

    head: str
    body: str
    sign: str = ""  # "=" where the line starts a side
    indent: int = 0  # quads, of a line that goes on
    height: Height = Height.FLAT


class SheetPen(Pen):
    """Subclasses spell, from the texts of the parts; widths are those of the note's font in ems."""

    wide_gap: str
    spelt_symbol: Callable[[tree.Symbol, str | None], str]  # with its index
    spelt_index: Callable[[str, str], str]
    spelt_number: Callable[[str], str]
    spelt_sign: Callable[[str, bool], str]  # whether it is binary
    # Between two factors, and whether it is thin.
    spelt_gap: Callable[[tree.Formula, tree.Formula, bool], str]
    spelt_function: Callable[[str, int, Piece], str]  # with its exponent, before the argument
    spelt_power: Callable[[tree.Formula, str, str], str]  # base, its text, exponent
    spelt_fraction: Callable[[str, str], str]
    spelt_bracket: Callable[[str, Size, bool], str]  # whether it opens
    spelt_root: Callable[[str], str]
    spelt_matrix: Callable[[Sequence[Sequence[Piece]]], str]
    spelt_big: Callable[[str, str, str], str]  # sign, below, above
    spelt_words: Callable[[str], str]
    spelt_differential: Callable[[str], str]
    boxed: Callable[[str], str]  # a result that a reader looks up
    continued: Callable[[str, int], str]  # a line that goes on, so many quads to the right
    # lines below one another, aligned at their signs or each in the middle; whether they are high
    aligned: Callable[[Sequence[Aligned], bool], str]
    gathered: Callable[[Sequence[str], bool], str]

    def inline(self, formula: tree.Formula) -> Piece:
        """A formula as it stands among words, in chunks between which a line may end."""
        return self.write(formula).solid()

    def body(self, line: Aligned) -> str:
        """What stands behind the sign of a line, if it has one."""
        return self.continued(line.body, line.indent)

    def symbol(self, node: tree.Symbol) -> Piece:
        index = None
        width = letter_width(node)
        if node.prime:
            width += PRIME if node.prime == "′" else SCRIPT
        if node.index is not None:
            written = self.indices(node.index)
            index = written.text
            width += SCRIPT * written.width
        return atom(self.spelt_symbol(node, index), width)

    def indexed(self, node: tree.Indexed) -> Piece:
        base, index = self.node(node.base), self.indices(node.index)
        width = base.width + SCRIPT * index.width
        return atom(self.spelt_index(base.text, index.text), width, height=base.height)

    def numeral(self, node: tree.Numeral) -> Piece:
        width = DIGIT * len(node.digits)
        return atom(self.spelt_number(node.digits), width, Binding.NUMBER)

    def sign(self, node: tree.Sign, *, is_binary: bool = False) -> Piece:
        text = self.spelt_sign(node.character, is_binary)
        return atom(text, _SIGNS.get(node.character, _UNKNOWN))

    def between(self, before: tree.Formula, after: tree.Formula) -> Piece:
        is_thin = _is_thin(before, after) or self._is_short(after)
        return atom(self.spelt_gap(before, after, is_thin), THIN if is_thin else 0.0)

    def functioncall(self, node: tree.FunctionCall) -> Piece:
        if self._is_short(node):
            letter = tree.Symbol(node.function[0], index=node.argument)
            power = tree.Power(letter, tree.Numeral(str(node.exponent)))
            return self.node(letter if node.exponent == 1 else power)
        width = function_width(node.function)
        if node.exponent != 1:
            width += SCRIPT * DIGIT
        argument = self.node(node.argument)
        head = self.spelt_function(node.function, node.exponent, argument)
        return self.glued((atom(head, width), argument))

    def _is_short(self, part: tree.Formula) -> bool:
        """Whether a function is abbreviated to a letter, and so stands as one among factors."""
        return (
            self.short and isinstance(part, tree.FunctionCall) and part.function in ("sin", "cos")
        )

    def power(self, node: tree.Power) -> Piece:
        base, raised = node.base, self.node(node.exponent)
        if isinstance(base, tree.Row | tree.Fraction | tree.Power | tree.FunctionCall):
            base = tree.Bracket(base)
        if isinstance(base, tree.Bracket):
            within = self.node(base.inside)
            if self.size_around(within) != "stretched":
                return self.around(within, base.kind, raised)
        inside = self.node(base)
        text = self.spelt_power(base, inside.text, raised.text)
        width = inside.width + SCRIPT * raised.width
        return atom(text, width, Binding.POWER, inside.height)

    def fraction(self, node: tree.Fraction) -> Piece:
        above, below = self.node(node.above), self.node(node.below)
        return self._quotient(above, below, max(above.height, below.height, Height.TALL))

    def rate(self, node: tree.Rate) -> Piece:
        """The quotient of differentials; the whole of a bracket stands behind it."""
        if isinstance(node.of, tree.Bracket):
            return self.glued((self.rate(tree.Rate(tree.row(), node.order)), self.node(node.of)))
        whole = self._quotient(*self.differentials(node), Height.RATE)
        size = SCRIPT if self.small else 1.0
        return atom(whole.text, size * whole.width, height=Height.RATE)

    def _quotient(self, above: Piece, below: Piece, height: Height) -> Piece:
        width = max(above.width, below.width) + FRACTION
        return atom(self.spelt_fraction(above.text, below.text), width, height=height)

    def bracket(self, node: tree.Bracket) -> Piece:
        return self.around(self.node(node.inside), node.kind)

    def around(self, inside: Piece, kind: str, exponent: Piece | None = None) -> Piece:
        size = self.size_around(inside)
        width = BRACKET + LARGE[size]
        left = atom(self.spelt_bracket(kind[0], size, True), width)
        end = self.spelt_bracket(kind[1], size, False)
        if exponent is not None:  # the last line may hold nothing else of the bracket
            end = self.spelt_power(tree.Bracket(tree.row()), end, exponent.text)
            width += SCRIPT * exponent.width
        whole = self.within(left, inside, atom(end, width))
        return whole.solid() if size == "stretched" else whole

    def size_around(self, inside: Piece) -> Size:
        """No line can end within brackets that are stretched."""
        if inside.height == Height.FLAT:
            return "flat"
        return "large" if inside.height == Height.RATE or self.loose else "stretched"

    def radical(self, node: tree.Radical) -> Piece:
        inside = self.node(node.inside)
        height = Height.ROOTED if inside.height >= Height.TALL else inside.height
        return atom(self.spelt_root(inside.text), inside.width + ROOT, height=height)

    def matrix(self, node: tree.Matrix) -> Piece:
        small = replace(self, small=True)
        rows = [[self._entry(entry, small.write(entry)) for entry in line] for line in node.rows]
        columns = [max(entry.width for entry in column) for column in zip(*rows, strict=True)]
        gaps = COLUMN_GAP * (len(columns) - 1)
        width = sum(columns) + gaps + TALL_BRACKETS
        return atom(self.spelt_matrix(rows), width, Binding.BRACKET, Height.TALL)

    def _entry(self, entry: tree.Formula, small: Piece) -> Piece:
        """A rate in a matrix is in small type, unless a fraction beside it is not."""
        return small if small.height <= Height.RATE else self.write(entry)

    def big(self, node: tree.Big) -> Piece:
        below, above = (self.node(b).text if b else "" for b in (node.below, node.above))
        return atom(self.spelt_big(node.sign, below, above), BIG)

    def words(self, node: tree.Words) -> Piece:
        return atom(self.spelt_words(node.words), 0.5 * len(node.words))

    def differential(self, node: tree.Differential) -> Piece:
        return atom(self.spelt_differential(node.letter), 0.62)

    def gap(self, _: tree.Gap) -> Piece:
        return atom(self.wide_gap, 2 * QUAD)


def _is_thin(before: tree.Formula, after: tree.Formula) -> bool:
    """A thin space stands between letters; numbers, functions and signs bring their own."""
    if isinstance(before, tree.Words) or isinstance(after, tree.Words | tree.FunctionCall):
        return False
    if isinstance(before, tree.Bracket) and isinstance(after, tree.Bracket):
        return False
    if tree.is_differential(before):
        return (
            isinstance(after, tree.Symbol)
            and len(after.letter) > 1
            and before == tree.Differential()
        )
    return not isinstance(before, tree.Numeral)
