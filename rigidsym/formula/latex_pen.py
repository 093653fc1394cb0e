"""Formulas in LaTeX, for a document, and for readers of Markdown."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import ClassVar

from rigidsym.formula.pen import BREAKS, Height, Piece
from rigidsym.formula.reader import FUNCTIONS, LETTERS, SIGNS
from rigidsym.formula.sheet_pen import Aligned, SheetPen, Size
from rigidsym.formula.tree import Big, Formula, FunctionCall, Numeral, Radical, Rate, Symbol

_SIGNS = {"−": "-"} | {sign: f"{macro} " for macro, sign in SIGNS.items()}


def _macro(letter: str) -> str:
    kind, _, name = unicodedata.name(letter).partition(" LETTER ")
    macro = name.lower().replace("lamda", "lambda")
    return f"\\{macro.title() if kind == 'GREEK CAPITAL' else macro}"


# without omicron and the capitals that look like Latin letters, which have no macro
GREEK = {letter: _macro(letter) for letter in "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΥΦΨΩ"}
_LETTERS = GREEK | {letter: macro for macro, letter in LETTERS.items()} | {"∗": "*"}
_DOTS = ("", r"\dot", r"\ddot")
_LEFT = {"flat": ("", ""), "large": (r"\Bigl", r"\Bigr"), "stretched": (r"\left", r"\right")}
_BIG = {"∑": r"\sum", "∫": r"\int"}


class LatexPen(SheetPen):
    """Macros that MathJax knows too."""

    wide_gap = r"\qquad "
    thin: ClassVar[str] = r"\,"
    row_end: ClassVar[str] = r" \\[{}pt]" + "\n"
    script: ClassVar[str] = ""  # what stands before an index
    spelt_fraction = r"\frac{{{}}}{{{}}}".format
    spelt_root = r"\sqrt{{{}}}".format
    spelt_words = r"\text{{{}}}".format
    boxed = r"\boxed{{{}}}".format

    def spelt_number(self, digits: str) -> str:
        return digits.replace(",", "{,}")

    def spelt_symbol(self, symbol: Symbol, index: str | None) -> str:
        text = symbol.macro or _LETTERS.get(symbol.letter, symbol.letter)
        if symbol.face == "bold":
            bold = r"\boldsymbol" if text.startswith("\\") else r"\mathbf"
            text = rf"{bold}{{{text}}}"
        elif symbol.face == "arrow":
            text = rf"\vec{{{text}}}"
        elif symbol.face == "upright":
            text = rf"\mathrm{{{text}}}"
        elif symbol.face == "sans":
            text = rf"\mathsf {text}"
        elif len(symbol.letter) > 1 and not symbol.macro:
            text = rf"\mathit{{{text}}}"
        if symbol.dots:
            text = rf"{_DOTS[symbol.dots]}{{{text}}}"
            text += "{}" if symbol.prime else ""  # a prime on the accent would stand too high
        text += {"": "", "′": "'", "ᴮ": r"^{\mathrm{B}}"}[symbol.prime]
        return text if index is None else self.spelt_index(text, index)

    def spelt_index(self, base: str, index: str) -> str:
        return f"{base}{self.script}_{_braced(index)}"

    def spelt_sign(self, character: str, is_binary: bool) -> str:
        text = _SIGNS.get(character, character)
        if not is_binary or character in "/·×":
            return f" {text}" if text.startswith("\\") and is_binary else text
        if character in ",;":
            return f"{text} "
        return f"{text.rstrip()} " if character in BREAKS else f" {text.rstrip()} "

    def spelt_gap(self, before: Formula, after: Formula, is_thin: bool) -> str:
        if is_thin:
            return self.thin if not isinstance(before, Big) else " "
        return " " if isinstance(before, Numeral | Big) or isinstance(after, FunctionCall) else ""

    def spelt_function(self, function: str, exponent: int, argument: Piece) -> str:
        known = function in FUNCTIONS
        head = f"\\{function}" if known else rf"\operatorname{{{function.replace('_', '')}}}"
        if exponent != 1:
            head += f"^{_braced(str(exponent))}"
        return f"{head} " if argument.text[0].isalnum() else head

    def spelt_power(self, base: Formula, inside: str, exponent: str) -> str:
        # a prime is a superscript, and TeX takes one superscript only
        is_raised = isinstance(base, Symbol) and (
            base.prime == "ᴮ" or (base.prime and base.index is not None)
        )
        is_whole = is_raised or isinstance(base, Rate | Radical)
        return f"{{{inside}}}^{_braced(exponent)}" if is_whole else f"{inside}^{_braced(exponent)}"

    def spelt_bracket(self, bracket: str, size: Size, is_open: bool) -> str:
        return _LEFT[size][not is_open] + bracket

    def spelt_matrix(self, rows: Sequence[Sequence[Piece]]) -> str:
        # fractions in their full height, but for those within others
        high = {True: r"\displaystyle ", False: ""}
        lines = [" & ".join(high[e.height >= Height.TALL] + e.text for e in row) for row in rows]
        text = lines[0]
        for (above, below), line in zip(pairwise(rows), lines[1:], strict=True):
            upper, lower = (max(entry.height for entry in cells) for cells in (above, below))
            # points: dots want some air, fractions more, and roots in them most
            if max(upper, lower) == Height.RATE:
                distance = 5
            elif upper:
                distance = 13 if Height.ROOTED in (upper, lower) else 10
            else:
                distance = 7 if lower else 2
            text += self.row_end.format(distance) + line
        return _environment("pmatrix", text)

    def spelt_big(self, sign: str, below: str, above: str) -> str:
        lower = f"{self.script}_{_braced(below)}" if below else ""
        return _BIG[sign] + lower + (f"^{_braced(above)}" if above else "")

    def spelt_differential(self, letter: str) -> str:
        return r"\partial " if letter == "∂" else letter

    def continued(self, text: str, indent: int) -> str:
        return r"\quad" * indent + f" {{}}{text}" if indent else text

    def aligned(self, lines: Sequence[Aligned], is_high: bool) -> str:
        return _environment("aligned", self.joined(map(self.line, lines), is_high))

    def line(self, line: Aligned) -> str:
        """Head, sign and body; a line that goes on is indented."""
        sign = f"{line.sign} " if line.sign else ""
        return f"{line.head} &{sign}{self.body(line)}".strip()

    def gathered(self, lines: Sequence[str], is_high: bool) -> str:
        return _environment("gathered", self.joined(lines, is_high))

    def joined(self, lines: Iterable[str], is_high: bool) -> str:
        return self.row_end.format(4 if is_high else 2).join(lines)


class MarkdownPen(LatexPen):
    """LaTeX without what Markdown would change: no backslash before punctuation, and no low line
    that could end an emphasis."""

    thin: ClassVar[str] = r"\thinspace "
    row_end: ClassVar[str] = " \\cr\n"
    script: ClassVar[str] = " "


def _braced(script: str) -> str:
    return script if len(script) == 1 else f"{{{script}}}"


def _environment(name: str, inside: str) -> str:
    return f"\\begin{{{name}}}\n{inside}\n\\end{{{name}}}"
