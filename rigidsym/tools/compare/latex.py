r"""Formulas in LaTeX, translated into Python from left to right.

python_of(r"\dot\phi \sin^2\theta")     phi_dot*sin(theta)**(2)
"""

from __future__ import annotations

import re

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.names import GREEK_LETTERS, spelled
from rigidsym.tools.compare.language import function_word
from rigidsym.tools.compare.syntax import patterns

_FIRST = 0xE000  # a matrix stands in a formula as a letter of the private use area
_MARKS = "\ue000-\uf8ff"
_QUOTE = '"'  # around a name of several letters
_DEEPEST = 60  # nested brackets
_TEX_TOKEN = re.compile(
    rf"\\[A-Za-z]+|{_QUOTE}\w+{_QUOTE}|\d+(?:\.\d+)?|[A-Za-z{GREEK_LETTERS}{_MARKS}]"
    r"|[-+*/=^_(){}\[\]'|,]|(?P<other>\S)"
)
_BRACKETS = {"(": ")", "[": "]", "{": "}"}
_DOTS = {r"\dot": "_dot", r"\ddot": "_ddot"}
_LETTERS = set(map(spelled, GREEK_LETTERS))
_GREEK = {r"\varphi": "phi", r"\vartheta": "theta", r"\top": "T", r"\intercal": "T"}
_ANGLES = {r"\phi", r"\varphi", r"\theta", r"\vartheta", r"\psi", r"\alpha", r"\beta", r"\gamma"}
_SHORT = {"c": "cos", "C": "cos", "s": "sin", "S": "sin"}  # c\theta


def python_of(text: str) -> str:
    """The last side of an equation; if a side contains a matrix, the last such side."""
    if mark := re.search(f"[{_MARKS}]", text):
        raise ExpressionError(f"unexpected {mark[0]!r} in LaTeX")
    matrices: dict[int, str] = {}

    def kept(match: re.Match[str]) -> str:
        lines = [line for line in re.split(r"\\\\(?:\[[^\]]*\])?", match[2]) if line.strip()]
        cells = (", ".join(_Walk(cell).sum() for cell in line.split("&")) for line in lines)
        matrices[_FIRST + len(matrices)] = f"[{', '.join(f'[{row}]' for row in cells)}]"
        return chr(max(matrices))

    sides = patterns.tex_matrix.sub(
        kept, patterns.styled_script.sub("", patterns.tex_comment.sub("", text))
    ).split("=")
    side = next((s for s in reversed(sides) if re.search(f"[{_MARKS}]", s)), sides[-1])
    side = patterns.end_of_side.split(side)[0] if matrices else side
    return _Walk(patterns.punctuation.sub("", side)).sum().translate(matrices)


def _styled(match: re.Match[str]) -> str:
    r"""\mathrm{cos} is a function, \mathbf{x} a letter, \mathrm{yaw} one name."""
    word = match[1] or ""
    if function_word(word) in FUNCTIONS:
        return f"\\{word} "
    return f"{_QUOTE}{word}{_QUOTE}" if len(word) > 1 and word[0] != "\\" else f"{word} "


class _Walk:
    """One entry of a matrix, or a formula in which letters stand for matrices."""

    def __init__(self, text: str) -> None:
        tokens = list(
            _TEX_TOKEN.finditer(patterns.layout.sub(" ", patterns.styled.sub(_styled, text)))
        )
        for match in tokens:
            if match["other"]:
                raise ExpressionError(f"unexpected {match['other']!r} in LaTeX")
        self.tokens = [match[0] for match in tokens][::-1]
        self.depth = 0

    def next(self) -> str:
        return self.tokens[-1] if self.tokens else ""

    def take(self, *expected: str) -> str:
        """The next token if it is an expected one, else nothing."""
        return self.tokens.pop() if self.next() in expected and self.tokens else ""

    def sum(self, end: str = "") -> str:
        """Up to the bracket `end`, or to the end."""
        self.depth += 1
        if self.depth > _DEEPEST:
            raise ExpressionError("operations are nested too deeply")
        total = self.take("+", "-") + self._power()
        while self.next() not in ("", end):
            sign = self.take("+", "-", r"\cdot", "*", "/")  # none between factors
            total += {r"\cdot": "*", "": "*"}.get(sign, sign) + self._power()
        if end and not self.take(end):
            raise ExpressionError(f"expected {end} in LaTeX")
        self.depth -= 1
        return total

    def _power(self) -> str:
        base = self._atom()
        while self.take("^"):
            power = self._argument()
            base = f"({base}).T" if power.strip("()") == "T" else f"{base}**({power})"
        return base

    def _argument(self) -> str:
        """A group in braces, or one token."""
        return self._token() if self.next().isdigit() else self._atom()

    def _token(self) -> str:
        """A word, or the first digit of several: \frac12, x_12."""
        token = self.tokens.pop() if self.tokens else ""
        if token.isdigit() and len(token) > 1:
            self.tokens.append(token[1:])
        return token[0] if token.isdigit() else token.strip(_QUOTE).lstrip("\\")

    def _atom(self) -> str:
        token = self.next()
        if token in _BRACKETS:
            return f"({self.sum(_BRACKETS[self.tokens.pop()])})"
        if self.take(r"\frac", r"\tfrac", r"\dfrac"):
            return f"({self._argument()}/{self._argument()})"
        if token[:1] == "\\" and (name := function_word(token[1:])) in FUNCTIONS:
            self.tokens.pop()
            return self._call(name)
        if token in _SHORT and self.tokens[-2:-1] and self.tokens[-2] in _ANGLES:
            self.tokens.pop()
            return f"{_SHORT[token]}({self._atom()})"
        is_number = token[:1].isdigit() or re.fullmatch(f"[{_MARKS}]", token)
        name = self.tokens.pop() if is_number else self._name()
        return "λ" if name == "lambda" else name  # a keyword of Python

    def _name(self) -> str:
        """A letter or a word, with its dots and its index."""
        token = self.tokens.pop() if self.tokens else ""
        if token in _DOTS:
            is_group = bool(self.take("{"))
            name = self._name()
            if is_group and not self.take("}"):
                raise ExpressionError("expected } in LaTeX")
            return name + self._script() + _DOTS[token]
        if token[:1] == _QUOTE:
            name = spelled(token.strip(_QUOTE))
            if self.next() in ("(", "["):
                raise ExpressionError(f"{name} is not a function that is known")
            return name + self._script()
        name = spelled(_GREEK.get(token, token.lstrip("\\")))
        is_command = token[:1] == "\\"
        if not name.isalpha() or (is_command and name not in _LETTERS and token not in _GREEK):
            raise ExpressionError(f"unexpected {token or 'end'!r} in LaTeX")
        return name + self._script()

    def _script(self) -> str:
        """The index of a name, as part of it."""
        if not self.take("_"):
            return ""
        is_group = self.take("{")
        index = "" if is_group else self._token()
        while is_group and self.next() not in ("", "}"):
            index += self._token()
        self.take("}" if is_group else "")
        index = spelled(index)
        if not index.isalnum():
            raise ExpressionError(f"unexpected index {index!r} in LaTeX")
        return f"_{index}"

    def _call(self, function: str) -> str:
        power = self._argument() if self.take("^") else ""
        if power.strip("()") == "-1":
            # sin⁻¹ is the inverse function, although sin² is a power.
            function, power = f"a{function}", ""
        is_number = self.next().isdigit()
        argument = self._argument() if function == "sqrt" else self._power()
        while is_number and self.next()[:1] == "\\" and self.next() != r"\cdot":  # \sin 2\theta
            is_number = False
            argument += f"*{self._power()}"
        return f"{function}({argument})" + f"**({power})" * bool(power)
