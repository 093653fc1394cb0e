r"""Formulas in Python, SymPy, C, C++, MATLAB and LaTeX, in the words of `language`.

    plain("{{cosf(a), -sinf(a)}, {sinf(a), cosf(a)}}")     "[[cos(a), -sin(a)], [sin(a), cos(a)]]"
    plain("[1 -s; 0 q(2)^2]")                              "[[1, -s], [0, q_2**2]]"
    plain(r"\dot\phi \sin^2\theta")                        "phi_dot*sin(theta)**2"

Names with dots, arrows or constant indices become one name: x[3] is x_3, state.phi is phi.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.names import GREEK_LETTERS, spelled
from rigidsym.tools.compare.language import WRAPPERS

MOST_CHARACTERS = 20_000
_TOKEN = re.compile(
    r"(?P<space>(?:\s|\.\.\.[^\n]*\n|\\\n)+)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[fFlLuUdm]*(?![A-Za-z_])"
    r"|(?P<name>[^\W\d]\w*(?:(?:::|->|\.(?!T\b))[^\W\d]\w*)*(?:\(\))?)"
    r"|(?P<operator>\.T\b|\*\*|\.\*|\./|\.\^|\.'|[-+*/@^()\[\]{},;'=])"
)
_SAME = {"^": "**", ".^": "**", ".*": "%", "./": "/", "{": "[", "}": "]", "'": ".T", ".'": ".T"}
_NAMES = {f + "f": f for f in FUNCTIONS} | {"power": "pow", "powf": "pow", "square": "sq"}
_NAMES |= {"arctan2": "atan2", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "SQ": "sq"}
_NAMES |= {"fabs": "abs", "Sqrt": "sqrt", "Sin": "sin", "Cos": "cos", "Tan": "tan"}
_CALLS = {*FUNCTIONS, "pow", "sq", "pi", "M_PI", "one"}
_OPTION = re.compile(r",\s*\w+\s*=\s*[\w.]+")  # dtype=float
_COMPONENT = re.compile(r"\b(?P<name>[^\W\d]\w*)(?P<index>(?:\[\s*\d+\s*\])+|\(\s*\d+\s*\))")
_BLANKS = (" ", "\n")
_NUMPY_ARRAY = re.compile(r"\b(?:np|numpy|jnp)\.(?:array|asarray)\b")
_OPEN, _CLOSE = "([", ")]"


def plain(text: str, *, is_numpy: bool = False) -> str:
    """The formula for `read_formula`; raises ExpressionError for characters without a meaning
    and for a text that is too long.

    With `is_numpy`, and for the arrays of NumPy, * is a product entry by entry, which is written %.
    """
    if len(text) > MOST_CHARACTERS:
        raise ExpressionError(
            f"a formula of {len(text)} characters; expected at most {MOST_CHARACTERS}"
        )
    if "\\" in text and re.search(r"\\[A-Za-z]", text):
        return _tex(text)
    tokens = _tokens(_COMPONENT.sub(_component, _OPTION.sub("", text)))
    if is_numpy or _NUMPY_ARRAY.search(text):
        tokens = ["%" if token == "*" else token for token in tokens]
    return "".join(_rows(tokens))


def _component(match: re.Match[str]) -> str:
    """x[3] or R[0][1], and q(2) of MATLAB and Eigen, as one name."""
    is_call = match["name"] in _CALLS and match["index"].startswith("(")
    numbers = re.findall(r"\d+", match["index"])
    return match[0] if is_call else "_".join([match["name"], *numbers])


def _tokens(text: str) -> list[str]:
    """The tokens, in the words of the language; blanks stay, since they part columns in MATLAB."""
    found: list[str] = []
    place = 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise ExpressionError(f"unexpected {text[place]!r} in a formula", column=place + 1)
        place = match.end()
        if match["name"]:
            found.append(name_of(match["name"]))
        else:
            blank = "\n" if "\n" in text[match.start() : place].replace("...", "") else " "
            token = (match["space"] and blank) or match["number"] or match["operator"]
            found.append(_SAME.get(token, token))
    return found


def name_of(name: str) -> str:
    """One name for what has dots and arrows: np.sin is sin, state.phi is phi, q.w() is q_w."""
    parts = [part for part in re.split(r"::|->|\.|\(\)", name) if part]
    parts = parts[parts[0] in ("self", "this") and len(parts) > 1 :]
    last = _NAMES.get(parts[-1], parts[-1])
    if last in _CALLS or last in WRAPPERS or len(parts) == 1:
        return last
    return f"{parts[-2]}_{last}" if len(last) == 1 else last


def _rows(tokens: Sequence[str]) -> list[str]:
    """The tokens with rows of MATLAB, [a b; c d], as lists of lists."""
    found: list[str] = []
    at = 0
    while at < len(tokens):
        if tokens[at] == "[":
            end = _closing(tokens, at)
            inside = tokens[at + 1 : end]
            rows = _matlab_rows(inside)
            cells = [f"[{','.join(row)}]" for row in rows]
            found += ["[", *([",".join(cells)] if rows else _rows(inside)), "]"]
            at = end
        elif tokens[at] not in _BLANKS:
            found.append(tokens[at])
        at += 1
    return found


def _closing(tokens: Sequence[str], start: int) -> int:
    depth = 0
    for at in range(start, len(tokens)):
        depth += (tokens[at] in _OPEN) - (tokens[at] in _CLOSE)
        if depth == 0:
            return at
    raise ExpressionError("unclosed bracket")


def _matlab_rows(inside: Sequence[str]) -> list[list[str]]:
    """The rows of [a b; c d], which may also end with their lines; none for other lists."""
    if ";" in inside:
        return [_columns(row) for row in _split(inside, (";",))]
    rows = [_columns(row) for row in _split(inside, ("\n",))]
    has_commas = len(_split(inside, (",",))) > 1
    is_table = len(rows) > 1 and len({len(row) for row in rows}) == 1 < len(rows[0])
    ends = any(row and row[-1] == "," for row in map(_stripped, _split(inside, ("\n",))))
    if is_table and not ends:
        return rows
    return rows if not has_commas and len(rows) == 1 < len(rows[0]) else []


def _stripped(tokens: Sequence[str]) -> list[str]:
    return [token for token in tokens if token not in _BLANKS]


def _split(tokens: Sequence[str], marks: Sequence[str]) -> list[list[str]]:
    """The parts between marks outside all brackets, but for empty ones."""
    parts: list[list[str]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token in _OPEN) - (token in _CLOSE)
        if depth == 0 and token in marks:
            parts.append([])
        else:
            parts[-1].append(token)
    return [part for part in parts if _stripped(part)]


def _columns(row: Sequence[str]) -> list[str]:
    """The columns of a row: between commas, or between blanks as MATLAB sees them."""
    marked: list[str] = []
    depth = 0
    for at, token in enumerate(row):
        depth += (token in _OPEN) - (token in _CLOSE)
        after = row[at + 1] if at + 1 < len(row) else ""
        is_sign = after in ("+", "-") and at + 2 < len(row) and row[at + 2] not in _BLANKS
        ends = bool(marked) and (marked[-1][-1].isalnum() or marked[-1] in (")", "]", ".T"))
        begins = after[:1].isalnum() or after in ("(", "[") or is_sign
        is_mark = token in _BLANKS and depth == 0 and ends and begins
        marked.append("," if is_mark else token)
    return ["".join(_stripped(part)) for part in _split(marked, (",",))]


# LaTeX

_FIRST = 0xE000  # a matrix stands in a formula as a letter of the private use area
_MARKS = "\ue000-\uf8ff"
_TEX_TOKEN = re.compile(
    rf"\\[A-Za-z]+|\d+(?:\.\d+)?|[A-Za-z{GREEK_LETTERS}{_MARKS}]|[-+*/=^_(){{}}\[\]'|,]|(?P<other>\S)"
)
_LAYOUT = re.compile(
    r"\\(?:left|right|[bB]igg?[lr]?|displaystyle|textstyle|quad|qquad)(?![A-Za-z])"
    r"|\\[,;:! \[\]]|[~$]|\\(?:begin|end)\{(?:align|aligned|equation|gather|split)\*?\}"
    r"|\\(?:tag|label)\{[^{}]*\}|\\(?:nonumber|notag)(?![A-Za-z])"
)
_FONT = r"\\(?:math(?:rm|it|sf|bf)|operatorname|text|boldsymbol|bm)"
_STYLED = re.compile(_FONT + r"(?:\s*\{\s*(\\?[A-Za-z]+)\s*\}|(?=\s*\{)|(?![A-Za-z]))")
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


def _tex(text: str) -> str:
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


class _TexWalk:
    """One entry, from left to right, with the signs of multiplication put in."""

    def __init__(self, text: str) -> None:
        found = list(_TEX_TOKEN.finditer(_LAYOUT.sub(" ", _STYLED.sub(r"\1 ", text))))
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
        if token[1:] in FUNCTIONS and token[0] == "\\":
            return self._call(token[1:])
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
