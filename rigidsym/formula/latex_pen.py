"""Formulas in LaTeX: for a document, for readers of Markdown, and for MathML in a browser.

Widths are in ems of Latin Modern at 11 points, rounded up. A test sets formulas with TeX and
compares.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import ClassVar

from rigidsym.formula import tree
from rigidsym.formula.pen import BREAKS, Binding, Height, Pen, Piece, atom
from rigidsym.formula.reader import FUNCTIONS, GREEK, LETTERS, SIGNS, VARIANTS

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
COLUMN_GAP = 0.92
TALL_BRACKETS = 1.62
BIG = 1.45
LARGE = 0.25  # by which a large bracket is wider
WIDE_GAP = r"\qquad "

_GREEK_WIDTHS = {
    **dict.fromkeys("ιεδ", 0.49),
    **dict.fromkeys("θξζρητ", 0.56),
    **dict.fromkeys("νυγκλ", 0.6),
    **dict.fromkeys("μπσφβχα", 0.65),
    **dict.fromkeys("ωψΓΞΛ", 0.7),
    **dict.fromkeys("ΩΦΣΠΘΥΨ", 0.78),
    "Δ": 0.84,
}
_WIDTHS = {
    **_GREEK_WIDTHS,
    **dict.fromkeys("lijt", 0.41),
    **dict.fromkeys("bcers", 0.52),
    **dict.fromkeys("adfghknopquvxyz", 0.62),
    **dict.fromkeys("mw", 0.88),
    **dict.fromkeys("MW", 1.16),
    **dict.fromkeys("0123456789", DIGIT),
}
_WORD = 0.87  # width of letters in a word, which are set closer
_CAPITAL, _UNKNOWN = 0.92, 1.0
_SIGN_WIDTHS = {"+": 1.23, "−": 1.23, "±": 1.23, "=": EQUAL, "": 2 * QUAD}
_SIGN_WIDTHS |= {"·": 0.8, "/": 0.5, ",": 0.45, ";": 0.45}
_FUNCTION_WIDTHS = {"sin": 1.24, "cos": 1.34, "tan": 1.46, "cot": 1.34, "det": 1.39}
_FACES = {  # and how much wider they are
    "bold": (r"\mathbf{{{}}}", 1.2),
    "arrow": (r"\vec{{{}}}", 1.0),
    "upright": (r"\mathrm{{{}}}", 1.0),
    "sans": (r"\mathsf {}", 1.05),
    "italic": ("{}", 1.0),
}
_SIGNS = {"−": "-", "": WIDE_GAP} | {sign: f"{macro} " for macro, sign in SIGNS.items()}
_DOTS = ("{}", r"\dot{{{}}}", r"\ddot{{{}}}")
_ROW_GAPS = (2, 5, 10)  # points between the rows of a matrix, by the height of their entries
_BIG = {"∑": r"\sum", "∫": r"\int"}
_RAISED = tree.Row | tree.Fraction | tree.Power | tree.FunctionCall  # in brackets, as a base


_MACROS = {letter: f"\\{name}" for name, letter in (*GREEK.items(), *VARIANTS.items())}
_MACROS |= {"λ": r"\lambda", "Λ": r"\Lambda"}
# omicron and the capitals that look like Latin letters have no macro
_MACROS |= {g: rf"\mathrm{{{x}}}" for g, x in zip("ΑΒΕΖΗΙΚΜΝΟΡΤΧο", "ABEZHIKMNOPTXo", strict=True)}
GREEK_MACROS = {letter: _MACROS[letter] for letter in _GREEK_WIDTHS}
_LETTERS = _MACROS | {letter: macro for macro, letter in LETTERS.items()} | {"∗": "*"}


class LatexPen(Pen):
    """Macros that MathJax knows too."""

    thin: ClassVar[str] = r"\,"
    row_end: ClassVar[str] = r" \\[{}pt]" + "\n"
    script: ClassVar[str] = ""  # what stands before an index
    after_accent: ClassVar[str] = "{}"  # a prime on the accent would be too high

    def symbol(self, node: tree.Symbol) -> Piece:
        text = _LETTERS.get(node.letter, node.letter)
        is_word = len(node.letter) > 1
        face, factor = _FACES[node.face]
        if node.face == "bold" and text.startswith("\\"):
            face = r"\boldsymbol{{{}}}"
        elif node.face == "italic" and is_word:
            face = r"\mathit{{{}}}"
        text = _DOTS[node.dots].format(face.format(text))
        if node.dots and node.prime:
            text += self.after_accent
        if node.prime:
            text += "'"
        width = sum(map(_letter_width, node.letter)) * factor * (_WORD if is_word else 1.0)
        piece = atom(text, width + (PRIME if node.prime else 0.0))
        return piece if node.index is None else self._with_index(piece, node.index)

    def indexed(self, node: tree.Indexed) -> Piece:
        return self._with_index(self.node(node.base), node.index)

    def _with_index(self, base: Piece, node: tree.Formula) -> Piece:
        index = self.indices(node)
        text = f"{base.text}{self.script}_{_braced(index.text)}"
        return atom(text, base.width + SCRIPT * index.width, height=base.height)

    def numeral(self, node: tree.Numeral) -> Piece:
        return atom(node.digits, DIGIT * len(node.digits), Binding.NUMBER)

    def sign(self, node: tree.Sign, *, is_binary: bool = False) -> Piece:
        text = _SIGNS.get(node.character, node.character)
        if not is_binary or node.character in "/·×":
            text = f" {text}" if text.startswith("\\") and is_binary else text
        elif node.character in ",;":
            text = f"{text} "
        else:
            before = "" if node.character in BREAKS else " "
            text = f"{before}{text.rstrip()} "
        return atom(text, _SIGN_WIDTHS.get(node.character, _UNKNOWN))

    def between(self, before: tree.Formula, after: tree.Formula) -> Piece:
        if _is_thin(before, after):
            return atom(" " if isinstance(before, tree.Big) else self.thin, THIN)
        is_parted = isinstance(before, tree.Numeral | tree.Big)
        return atom(" " if is_parted or isinstance(after, tree.FunctionCall) else "", 0.0)

    def functioncall(self, node: tree.FunctionCall) -> Piece:
        name = node.function
        width = _FUNCTION_WIDTHS.get(name) or sum(map(_letter_width, name))
        width += OPERATOR_SPACE
        head = f"\\{name}"
        if name not in FUNCTIONS:
            head = rf"\operatorname{{{name.replace('_', '')}}}"
        if node.exponent != 1:
            width += SCRIPT * DIGIT
            head += f"^{_braced(str(node.exponent))}"
        argument = self.node(node.argument)
        head += " " if argument.text[0].isalnum() else ""
        return self.glued((atom(head, width), argument))

    def power(self, node: tree.Power) -> Piece:
        base, raised = node.base, self.node(node.exponent)
        exponent, room = f"^{_braced(raised.text)}", SCRIPT * raised.width
        if isinstance(base, _RAISED):
            base = tree.Bracket(base)
        if isinstance(base, tree.Bracket):
            return self.around(self.node(base.inside), base.kind, exponent, room)
        inside = self.node(base)
        # a prime is a superscript, and TeX takes one superscript only
        is_whole = isinstance(base, tree.Rate | tree.Radical) or (
            isinstance(base, tree.Symbol) and base.prime and base.index is not None
        )
        text = f"{{{inside.text}}}" if is_whole else inside.text
        return atom(text + exponent, inside.width + room, Binding.POWER, inside.height)

    def fraction(self, node: tree.Fraction) -> Piece:
        above, below = self.node(node.above), self.node(node.below)
        return _quotient(above, below, max(above.height, below.height, Height.TALL))

    def rate(self, node: tree.Rate) -> Piece:
        """The quotient of differentials; it comes before what is in brackets."""
        if isinstance(node.of, tree.Bracket):
            return self.glued((self.rate(tree.Rate(tree.row(), node.order)), self.node(node.of)))
        return _quotient(*self.differentials(node), Height.RATE)

    def around(self, inside: Piece, kind: str, exponent: str = "", room: float = 0.0) -> Piece:
        # A line may break between brackets of a fixed size, but not between \left and \right.
        left, right = (r"\Bigl", r"\Bigr") if inside.height else ("", "")
        width = BRACKET + (LARGE if inside.height else 0.0)
        # the last line may hold nothing else of the bracket
        end = atom(right + kind[1] + exponent, width + room)
        return self.within(atom(left + kind[0], width), inside, end)

    def radical(self, node: tree.Radical) -> Piece:
        inside = self.node(node.inside)
        return atom(rf"\sqrt{{{inside.text}}}", inside.width + ROOT, height=inside.height)

    def matrix(self, node: tree.Matrix) -> Piece:
        rows = [[self.write(entry) for entry in line] for line in node.rows]
        columns = [max(entry.width for entry in column) for column in zip(*rows, strict=True)]
        width = sum(columns) + COLUMN_GAP * (len(columns) - 1) + TALL_BRACKETS
        # fractions in their full height, but for those within others
        size = {True: r"\displaystyle ", False: ""}
        first, *others = (
            " & ".join(size[e.height == Height.TALL] + e.text for e in row) for row in rows
        )
        gaps = map(max, pairwise(max(entry.height for entry in row) for row in rows))
        ends = (self.row_end.format(_ROW_GAPS[height]) for height in gaps)
        text = first + "".join(map("".join, zip(ends, others, strict=True)))
        return atom(environment("pmatrix", text), width, Binding.BRACKET, Height.TALL)

    def big(self, node: tree.Big) -> Piece:
        below, above = (self.node(b).text if b else "" for b in (node.below, node.above))
        lower = f"{self.script}_{_braced(below)}" if below else ""
        return atom(_BIG[node.sign] + lower + (f"^{_braced(above)}" if above else ""), BIG)

    def words(self, node: tree.Words) -> Piece:
        return atom(rf"\text{{{node.words}}}", 0.5 * len(node.words))

    def differential(self, node: tree.Differential) -> Piece:
        return atom(r"\partial " if node.letter == "∂" else node.letter, 0.62)

    def joined(self, lines: Iterable[str], is_high: bool) -> str:
        """Lines below one another; whether they are high."""
        return self.row_end.format(4 if is_high else 2).join(lines)


class MarkdownPen(LatexPen):
    """LaTeX without what Markdown would change: no backslash before punctuation, and no low line
    that could end an emphasis."""

    thin: ClassVar[str] = r"\thinspace "
    row_end: ClassVar[str] = " \\cr\n"
    script: ClassVar[str] = " "


class WebPen(LatexPen):
    """LaTeX that becomes MathML, whose style sheet settles the distance between rows."""

    row_end: ClassVar[str] = " \\\\\n"
    after_accent: ClassVar[str] = ""


def environment(name: str, inside: str) -> str:
    return f"\\begin{{{name}}}\n{inside}\n\\end{{{name}}}"


def _letter_width(letter: str) -> float:
    return _WIDTHS.get(letter) or (_CAPITAL if letter.isalpha() else _UNKNOWN)


def _quotient(above: Piece, below: Piece, height: Height) -> Piece:
    width = max(above.width, below.width) + FRACTION
    return atom(rf"\frac{{{above.text}}}{{{below.text}}}", width, height=height)


def _braced(script: str) -> str:
    return script if len(script) == 1 else f"{{{script}}}"


def _is_thin(before: tree.Formula, after: tree.Formula) -> bool:
    """There is a thin space between letters; numbers, functions and signs bring their own."""
    if isinstance(before, tree.Words) or isinstance(after, tree.Words | tree.FunctionCall):
        return False
    if isinstance(before, tree.Bracket) and isinstance(after, tree.Bracket):
        return False
    if tree.is_differential(before):
        is_word = isinstance(after, tree.Symbol) and len(after.letter) > 1
        return is_word and before == tree.Differential()
    return not isinstance(before, tree.Numeral)
