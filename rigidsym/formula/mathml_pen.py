"""Formulas in MathML Core, for the note in a browser."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import replace
from html import escape

from rigidsym.formula.pen import Height, Piece, Segment
from rigidsym.formula.sheet_pen import Aligned, SheetPen, Size
from rigidsym.formula.tree import Big, Bracket, Formula, FunctionCall, Symbol
from rigidsym.formula.unicode_pen import UnicodePen

_THIN, _QUAD = '<mspace width=".1667em"/>', '<mspace width="1em"/>'
_DOTS = ("", "˙", "¨")
_PRIME = {"′": '<mo class="prime">′</mo>', "ᴮ": '<mi mathvariant="normal">B</mi>'}
_HIGH_PRIME = _PRIME | {"′": '<mo class="prime high">′</mo>'}
_TALL = set("bdfhkltβδζθλξφψϕ")  # with all capitals: letters that a dot would touch
_VARIANTS = {"φ": "ϕ", "ε": "ϵ"}  # the letters that \phi and \epsilon are
_UPRIGHT = "ΓΔΘΛΞΠΣΥΦΨΩ"  # as TeX has them
_INLINE = 13.0  # ems of a formula between words on a phone
_LARGE = ' minsize="1.623em" maxsize="1.623em"'
_SIZES = {"flat": ' stretchy="false"', "large": _LARGE, "stretched": ""}
_STYLES = {"bold": "BOLD", "arrow": "", "sans": "SANS-SERIF", "upright": "", "italic": "ITALIC"}


class MathmlPen(SheetPen):
    wide_gap = '<mspace width="2em"/>'
    spelt_number = "<mn>{}</mn>".format
    spelt_root = "<msqrt>{}</msqrt>".format
    spelt_differential = "<mi>{}</mi>".format
    boxed = '<mrow class="boxed">{}</mrow>'.format  # menclose is not in MathML Core

    def inline(self, formula: Formula) -> Piece:
        """As elements; one too wide for a phone in parts that may go on several lines."""
        piece, spoken = self.write(formula), UnicodePen(self.notation).write(formula)
        parts, texts = [piece.text], [spoken.text]
        if piece.width > _INLINE and len(inline_parts(piece)) == len(inline_parts(spoken)):
            parts, texts = inline_parts(piece), inline_parts(spoken)
        is_tall = piece.height > Height.FLAT
        written = (math(p, t, is_tall=is_tall) for p, t in zip(parts, texts, strict=True))
        return piece._replace(chunks=tuple(Segment(text, 0.0) for text in written))

    def spelt_symbol(self, symbol: Symbol, index: str | None) -> str:
        text = _letters(symbol)
        if symbol.dots:
            # browsers centre a dot over the foot of a slanted letter
            slanted = symbol.face == "italic" and len(symbol.letter) == 1
            kinds = [*(["dot"] if slanted else []), *(["high"] if _is_tall(symbol) else [])]
            kind = f' class="{" ".join(kinds)}"' if kinds else ""
            text = f'<mover accent="true">{text}<mo{kind}>{_DOTS[symbol.dots]}</mo></mover>'
        if symbol.face == "arrow":
            arrow = '<mo class="arrow" stretchy="false">→</mo>'
            text = f'<mover accent="true">{text}{arrow}</mover>'
        prime = (_HIGH_PRIME if _is_tall(symbol) else _PRIME).get(symbol.prime, "")
        if index is None:
            return f"<msup>{text}{prime}</msup>" if prime else text
        if prime:
            return f"<msubsup>{text}{_one(index)}{prime}</msubsup>"
        return self.spelt_index(text, index)

    def spelt_index(self, base: str, index: str) -> str:
        return f"<msub>{_one(base)}{_one(index)}</msub>"

    def spelt_sign(self, character: str, is_binary: bool) -> str:
        is_close = (not is_binary and character not in ",;") or character in "/·"
        space = ' lspace="0" rspace="0"' if is_close else ""
        return f"<mo{space}>{escape(character)}</mo>"

    def spelt_gap(self, before: Formula, after: Formula, is_thin: bool) -> str:
        return (
            _THIN
            if is_thin or (isinstance(after, FunctionCall) and not isinstance(before, Big))
            else ""
        )

    def spelt_function(self, function: str, exponent: int, argument: Piece) -> str:
        name = f"<mi>{escape(function)}</mi>"
        if exponent != 1:
            name = f"<msup>{name}<mn>{exponent}</mn></msup>"
        space = "" if argument.text.startswith("<mo") else ' lspace=".1667em"'
        return f"{name}<mo{space}>&ApplyFunction;</mo>"

    def spelt_power(self, base: Formula, inside: str, exponent: str) -> str:
        if isinstance(base, Symbol) and base.prime and base.index is None:
            text = self.node(replace(base, prime="")).text
            primes = _HIGH_PRIME if _is_tall(base) else _PRIME
            return f"<msup>{text}<mrow>{primes[base.prime]}{exponent}</mrow></msup>"
        if isinstance(base, Bracket) and _LARGE in inside:  # browsers would set it small
            return f'{inside}<msup><mspace height="1.1em"/>{_one(exponent)}</msup>'
        return f"<msup>{_one(inside)}{_one(exponent)}</msup>"

    def spelt_fraction(self, above: str, below: str) -> str:
        return f"<mfrac>{_one(above)}{_one(below)}</mfrac>"

    def spelt_bracket(self, bracket: str, size: Size, is_open: bool) -> str:
        kind = _SIZES[size]
        if bracket == "|":
            kind += ' lspace="0" rspace="0"'
        written = f"<mo{kind}>{bracket}</mo>"
        if size != "stretched":
            return written
        return f"<mrow>{written}" if is_open else f"{written}</mrow>"

    def spelt_matrix(self, rows: Sequence[Sequence[Piece]]) -> str:
        high = '<mrow class="tall">{}</mrow>'.format
        inside = "".join(
            _table_row([high(e.text) if e.height >= Height.TALL else e.text for e in line])
            for line in rows
        )
        return f"<mrow><mo>(</mo><mtable>{inside}</mtable><mo>)</mo></mrow>"

    def spelt_big(self, sign: str, below: str, above: str) -> str:
        tag = "under" if sign == "∑" else "sub"
        over = "over" if sign == "∑" else "sup"
        if below and above:
            return f"<m{tag}{over}><mo>{sign}</mo>{_one(below)}{_one(above)}</m{tag}{over}>"
        return f"<m{tag}><mo>{sign}</mo>{_one(below)}</m{tag}>" if below else f"<mo>{sign}</mo>"

    def spelt_words(self, words: str) -> str:
        blank = "\u00a0"
        inside = escape(words.strip())
        start = blank if words.startswith(" ") else ""
        return f"<mtext>{start}{inside}{blank if words.endswith(' ') else ''}</mtext>"

    def continued(self, text: str, indent: int) -> str:
        return _QUAD * indent + text

    def aligned(self, lines: Sequence[Aligned], is_high: bool) -> str:  # noqa: ARG002
        rows = (
            f'<mtr><mtd class="end">{line.head}</mtd><mtd class="start">'
            f"{self.spelt_sign(line.sign, True) if line.sign else ''}"
            f"{self.body(line)}</mtd></mtr>"
            for line in lines
        )
        return f'<mtable displaystyle="true">{"".join(rows)}</mtable>'

    def gathered(self, lines: Sequence[str], is_high: bool) -> str:  # noqa: ARG002
        rows = "".join(_table_row([line]) for line in lines)
        return f'<mtable displaystyle="true">{rows}</mtable>'


def _is_tall(symbol: Symbol) -> bool:
    """Whether a single letter is as high as a capital."""
    return symbol.letter.isupper() or symbol.letter in _TALL


def inline_parts(piece: Piece) -> list[str]:
    """A formula among words, cut before each sign outside all brackets."""
    parts: list[str] = []
    for chunk in piece.chunks:
        if parts and chunk.level:
            parts[-1] += f" {chunk.text}"
        else:
            parts.append(chunk.text)
    return parts


def math(inside: str, spoken: str, *, is_display: bool = False, is_tall: bool = False) -> str:
    """A `math` element, with `spoken` for readers that do not know MathML."""
    kind = ' display="block"' if is_display else ' class="tall"' if is_tall else ""
    return f'<math alttext="{escape(spoken)}"{kind}>{inside}</math>'


def _letters(symbol: Symbol) -> str:
    letters = symbol.letter
    if symbol.face == "upright" or (letters in _UPRIGHT and symbol.face == "italic"):
        return f'<mi mathvariant="normal">{escape(letters)}</mi>'
    if symbol.face == "italic" and len(letters) == 1 and letters.isalpha():
        return f"<mi>{_VARIANTS.get(letters, letters)}</mi>"
    if not letters[0].isalnum():
        return f"<mo>{escape(letters)}</mo>"
    return f"<mi>{''.join(_styled(c, _STYLES[symbol.face]) for c in letters)}</mi>"


def _styled(character: str, style: str) -> str:
    """𝐑 for R in bold; a letter that Unicode has not in this style as it is."""
    if style == "ITALIC" and character == "h":
        return "ℎ"
    name = unicodedata.name(character, "")
    for start in ("LATIN ", "GREEK ", ""):
        for word in ("LETTER ", ""):
            short = name.removeprefix(start).replace(word, "")
            try:
                return unicodedata.lookup(f"MATHEMATICAL {style} {short}") if style else character
            except KeyError:
                continue
    return escape(character)


def _one(text: str) -> str:
    """One element, for the parents that take a fixed number of them."""
    return text if text.count("<") == 2 else f"<mrow>{text}</mrow>"


def _table_row(cells: Sequence[str]) -> str:
    return f"<mtr>{''.join(f'<mtd>{cell}</mtd>' for cell in cells)}</mtr>"
