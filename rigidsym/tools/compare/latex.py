r"""Formulas in LaTeX, in the words of `language`.

tex_words(r"\dot\phi \sin^2\theta")     "phi_dot*sin(theta)**2"
"""

from __future__ import annotations

import re

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.names import GREEK_LETTERS, spelled
from rigidsym.tools.compare.language import SPELLINGS

_FIRST = 0xE000  # a matrix stands in a formula as a letter of the private use area
_MARKS = "\ue000-\uf8ff"
_QUOTE = '"'  # around a name of several letters
_TEX_TOKEN = re.compile(
    rf"\\[A-Za-z]+|{_QUOTE}\w+{_QUOTE}|\d+(?:\.\d+)?|[A-Za-z{GREEK_LETTERS}{_MARKS}]"
    r"|[-+*/=^_(){}\[\]'|,]|(?P<other>\S)"
)
_LAYOUT = re.compile(
    r"\\(?:left|right|[bB]igg?[lr]?|displaystyle|textstyle|quad|qquad)(?![A-Za-z])"
    r"|\\[,;:! \[\]]|[~$]|\\(?:begin|end)\{(?:align|aligned|equation|gather|split)\*?\}"
    r"|\\(?:tag|label)\{[^{}]*\}|\\(?:nonumber|notag)(?![A-Za-z])"
)
_FONT = r"\\(?:math(?:rm|it|sf|bf)|operatorname|text|boldsymbol|bm)"
_STYLED = re.compile(_FONT + r"(?:\s*\{\s*(\\?[A-Za-z][A-Za-z0-9]*)\s*\}|(?=\s*\{)|(?![A-Za-z]))")
_STYLED_SCRIPT = re.compile(rf"(?<=[_^])\s*{_FONT}\s*(?=\{{)")
_MATRIX = re.compile(r"\\begin\{([pbB]?matrix|array)\}(?:\{[lcr| ]*\})?(.*?)\\end\{\1\}", re.DOTALL)
_COMMENT = re.compile(r"(?<!\\)%[^\n]*")
_END = re.compile(r"(?<!\\),|\\q?quad(?![A-Za-z])|\\\\")  # of a side with a matrix
_PUNCTUATION = re.compile(r"(?:\\[,;:! ]|[\s.,;])+$")
_DOTS = {r"\dot": "_dot", r"\ddot": "_ddot"}
_LETTERS = set(map(spelled, GREEK_LETTERS))
_GREEK = {r"\varphi": "phi", r"\vartheta": "theta", r"\top": "T", r"\intercal": "T"}
_ANGLES = {"\\" + name for name in ("phi", "varphi", "theta", "vartheta", "psi", "alpha", "beta")}
_ANGLES.add(r"\gamma")
_SHORT = {"c": "cos", "C": "cos", "s": "sin", "S": "sin"}  # c\theta


def tex_words(text: str) -> str:
    """LaTeX: the last side of an equation outside of matrices; with a matrix if one has it."""
    if found := re.search(f"[{_MARKS}]", text):
        raise ExpressionError(f"unexpected {found[0]!r} in LaTeX")
    matrices: list[str] = []

    def kept(match: re.Match[str]) -> str:
        rows = [row for row in re.split(r"\\\\(?:\[[^\]]*\])?", match[2]) if row.strip()]
        cells = (", ".join(_TexWalk(cell).sum() for cell in row.split("&")) for row in rows)
        matrices.append(f"[{', '.join(f'[{row}]' for row in cells)}]")
        return chr(_FIRST + len(matrices) - 1)

    text = _STYLED_SCRIPT.sub("", _COMMENT.sub("", text))
    sides = _MATRIX.sub(kept, text).split("=")
    side = next((s for s in reversed(sides) if re.search(f"[{_MARKS}]", s)), sides[-1])
    side = _END.split(side)[0] if matrices else side
    formula = _TexWalk(_PUNCTUATION.sub("", side)).sum()
    return re.sub(f"[{_MARKS}]", lambda match: matrices[ord(match[0]) - _FIRST], formula)


def _styled(match: re.Match[str]) -> str:
    r"""\mathrm{cos} is a function, \mathbf{x} a letter, \mathrm{yaw} one name."""
    word = match[1] or ""
    if SPELLINGS.get(word, word) in FUNCTIONS:
        return f"\\{word} "
    return f"{_QUOTE}{word}{_QUOTE}" if len(word) > 1 and word[0] != "\\" else f"{word} "


class _TexWalk:
    """One entry, from left to right, with the signs of multiplication put in."""

    def __init__(self, text: str) -> None:
        found = list(_TEX_TOKEN.finditer(_LAYOUT.sub(" ", _STYLED.sub(_styled, text))))
        for match in found:
            if match["other"]:
                raise ExpressionError(f"unexpected {match['other']!r} in LaTeX")
        self.tokens = [match[0] for match in found][::-1]

    def sum(self, end: str = "") -> str:
        """Up to the bracket `end`, or to the end."""
        parts: list[str] = []
        while self.tokens and self.tokens[-1] != end:
            if self.tokens[-1] in ("+", "-", "/") or self.tokens[-1] == r"\cdot":
                token = self.tokens.pop()
                parts.append("*" if token == r"\cdot" else token)
            else:
                parts += ["*"] * (bool(parts) and parts[-1] not in "+-*/") + [self._power()]
        if end and (not self.tokens or self.tokens.pop() != end):
            raise ExpressionError(f"expected {end} in LaTeX")
        return "".join(parts)

    def _power(self) -> str:
        base = self._atom()
        while self.tokens and self.tokens[-1] == "^":
            self.tokens.pop()
            power = self._argument()
            is_transposed = power == "T" and re.search(f"[{_MARKS}]", base)
            base = f"{base}.T" if is_transposed else f"{base}**({power})"
        return base

    def _argument(self) -> str:
        """A group in braces, or one token."""
        if self.tokens and self.tokens[-1] == "{":
            self.tokens.pop()
            return self.sum("}")
        if self.tokens and self.tokens[-1].isdigit():  # frac12
            digits = self.tokens.pop()
            self.tokens += [digits[1:]] * (len(digits) > 1)
            return digits[0]
        return self._atom()

    def _atom(self) -> str:
        token = self.tokens.pop() if self.tokens else ""
        if token in ("(", "[", "{"):
            return f"({self.sum({'(': ')', '[': ']', '{': '}'}[token])})"
        if token in (r"\frac", r"\tfrac", r"\dfrac"):
            return f"(({self._argument()})/({self._argument()}))"
        if token == r"\sqrt":
            return f"sqrt({self._argument()})"
        if token in _DOTS:
            return self._argument() + self._script() + _DOTS[token]
        if token[:1] == "\\" and SPELLINGS.get(token[1:], token[1:]) in FUNCTIONS:
            return self._call(SPELLINGS.get(token[1:], token[1:]))
        if token[:1] == _QUOTE:
            word = spelled(token.strip(_QUOTE))
            if self.tokens and self.tokens[-1] in ("(", "["):
                raise ExpressionError(f"{word} is not a function that is known")
            return word + self._script()
        if token in _SHORT and self.tokens and self.tokens[-1] in _ANGLES:
            return f"{_SHORT[token]}({self._atom()})"
        if token[:1].isdigit() or re.fullmatch(f"[{_MARKS}]", token):
            return token
        name = _GREEK.get(token, token.lstrip("\\"))
        if not name.isalpha() or (
            token[0] == "\\" and name not in _LETTERS and token not in _GREEK
        ):
            raise ExpressionError(f"unexpected {token or 'end'!r} in LaTeX")
        return name + self._script()

    def _script(self) -> str:
        """The index of a name, as part of it."""
        if not self.tokens or self.tokens[-1] != "_":
            return ""
        self.tokens.pop()
        index = self._argument().replace("*", "")
        if not index.isalnum():
            raise ExpressionError(f"unexpected index {index!r} in LaTeX")
        return f"_{index}"

    def _call(self, function: str) -> str:
        power = ""
        if self.tokens and self.tokens[-1] == "^":
            self.tokens.pop()
            power = f"**({self._argument()})"
            if power == "**(-1)":
                function, power = f"a{function}", ""
        argument = self._power()
        while argument.isdigit() and self.tokens and self.tokens[-1][0] == "\\":  # sin 2 theta
            argument += "*" + self._power()
        return f"{function}({argument}){power}"
