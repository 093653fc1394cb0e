"""Printed formulas and generated functions, read back as numbers with 50 digits.

These readers know nothing of the package: they read LaTeX, Python, C and JavaScript as a
person does, and compute with what they find.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from helpers.witness import hat, mp, unhat

Value = Any  # a number of mpmath, or a matrix; a vector is one column
Values = dict[str, Value]  # by names as `Formula` reads them: "theta", "v_1", "dot bold q"

_IGNORED = re.compile(
    r"\\(?:displaystyle|left|right|[bB]igg?[lr]?|quad)(?![A-Za-z])|\\[,;!:]|\{\}|\s+"
)
_SKIP = re.compile(r"\\\\\[\d+pt\]")  # to the next row, with room
_TOKEN = re.compile(r"\\(?:begin|end)\{\w+\}|\\\\|\\[A-Za-z]+|\d+|\S")
_FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    rf"\{name}": getattr(mp, name) for name in ("sin", "cos", "tan", "cot", "sec", "csc")
}
_FACES = {r"\mathbf": "bold ", r"\dot": "dot ", r"\ddot": "ddot "}
_ENDS = {"", "}", ")", "&", r"\\", "+", "-", ",", r"\end{pmatrix}"}


class UnreadError(Exception):
    """A formula with a name or a sign that has no value."""


def equations(latex: str, known: Values) -> Iterator[list[Value | None]]:
    """Of each equation in a display: the values of its sides, None for one that cannot be read.

    Lines that go on, and lines that begin with a sign of equality, belong to the one before.
    """
    for row in _rows(latex):
        yield [_read(side, known) for side in _outside(row, "=")]


def define(latex: str, known: Values) -> None:
    """Adds the names that stand alone on the left of equations: k_1, e_z."""
    for row in _rows(latex):
        head, *_, last = _outside(row, "=")
        try:
            formula = Formula(head, known)
            name = formula._name()
            value = None if formula.tokens or name in known else _read(last, known)
        except UnreadError:
            continue
        if value is not None:
            known[name] = value


def _lines(row: list[Value]) -> list[list[Any]]:
    """The lines of a row of a matrix; an entry may be a block of them."""
    blocks = [e.tolist() if isinstance(e, mp.matrix) else [[e]] for e in row]
    return [[entry for line in lines for entry in line] for lines in zip(*blocks, strict=True)]


def _rows(latex: str) -> Iterator[str]:
    """The equations of a display, each on one line."""
    inside = re.sub(r"^\\boxed\{(.*)\}$", r"\1", _clean(latex))
    inside = re.sub(r"\\(begin|end)\{(?:align\*|gathered)\}", r"\\\1{aligned}", inside)
    inside = inside.removeprefix(r"\begin{aligned}").removesuffix(r"\end{aligned}")
    found: list[str] = []
    for line in _outside(inside, r"\\", r"\qquad"):
        parts = _outside(line, "&")
        if parts[0].strip() or not found:
            found.append("")
        found[-1] += " ".join(parts)
    return iter(found)


def _clean(text: str) -> str:
    """Without what only sets room and size."""
    return _IGNORED.sub(" ", _SKIP.sub(r"\\\\", text)).replace("boldsymbol", "mathbf").strip()


def _outside(text: str, *signs: str) -> list[str]:
    """The parts between signs outside all environments, and outside brackets for one "="."""
    parts, depth = [""], 0
    brackets = ("{(", "})") if signs == ("=",) else ("{", "}")
    for token in _TOKEN.findall(text):
        depth += token.startswith(r"\begin") or token in brackets[0]
        depth -= token.startswith(r"\end") or token in brackets[1]
        if token in signs and not depth:
            parts.append("")
        else:
            parts[-1] += f"{token} "
    return parts


def _number(exponent: str) -> Value:
    """A whole number, or one as 3/2."""
    above, _, below = exponent.partition("/")
    return mp.mpf(int(above)) / int(below) if below else int(above)


def _read(side: str, known: Values) -> Value | None:
    try:
        return Formula(side, known).value()
    except UnreadError:
        return None


class Formula:
    """One side of an equation in LaTeX."""

    def __init__(self, text: str, known: Values) -> None:
        self.tokens: list[str] = _TOKEN.findall(_IGNORED.sub(" ", _SKIP.sub(r"\\\\", text)))
        self.known = known

    def value(self) -> Value:
        found = self._sum()
        if self.tokens:
            raise UnreadError(f"{' '.join(self.tokens[:5])} is left over")
        return found

    @property
    def _next(self) -> str:
        return self.tokens[0] if self.tokens else ""

    def _take(self, expected: str = "") -> str:
        if not self.tokens or (expected and self._next != expected):
            raise UnreadError(f"{self._next!r} instead of {expected!r}")
        return self.tokens.pop(0)

    def _has(self, token: str) -> bool:
        return self._next == token and bool(self.tokens.pop(0))

    def _sum(self) -> Value:
        found = -1 * self._product() if self._has("-") else self._product()
        while self._next in ("+", "-"):
            found += (-1 if self._take() == "-" else 1) * self._product()
        return found

    def _product(self) -> Value:
        found = self._factor()
        while self._next not in _ENDS:
            if self._has(r"\times"):
                found = hat(found) * self._factor()
            elif self._has("/"):
                found = found / self._factor()
            elif self._has(r"\cdot"):
                found = (found.T * self._factor())[0]
            else:
                found = found * self._factor()
        return found

    def _factor(self) -> Value:
        found = self._atom()
        while self._has("^"):
            exponent = "".join(self._group())
            found = found.T if exponent == r"\mathsfT" else found ** _number(exponent)
        return found

    def _group(self) -> list[str]:
        """The tokens of one argument, without braces."""
        if not self._has("{"):
            token = self._take()
            return [token, self._take()] if token == r"\mathsf" else [token]
        found, depth = [], 1
        while depth:
            found.append(self._take())
            depth += (found[-1] == "{") - (found[-1] == "}")
        return found[:-1]

    def _inside(self) -> Value:
        return Formula(" ".join(self._group()), self.known).value()

    def _atom(self) -> Value:
        token = self._next
        if token.isdigit():
            return mp.mpf(self._take())
        if token in ("(", "{"):
            self._take()
            found = self._sum()
            self._take(")" if token == "(" else "}")
            return found
        if token == r"\frac":
            return self._fraction()
        if token == r"\sqrt":
            self._take()
            return mp.sqrt(self._inside())
        if token in _FUNCTIONS:
            return self._called(_FUNCTIONS[self._take()])
        if token == r"\begin{pmatrix}":
            return self._matrix()
        name = self._name()
        if name == "bold C":
            is_inverse = self._has("^") and self._group() == ["-", "1"]
            matrix = self._atom()
            return unhat(matrix) if is_inverse else hat(matrix)
        if self.tokens[:2] == ["^", "+"] or self.tokens[:4] == ["^", "{", "+", "}"]:
            self._take()
            name += "".join(self._group())
        return self._known(name)

    def _known(self, name: str) -> Value:
        if name not in self.known:
            raise UnreadError(name)
        return self.known[name]

    def _fraction(self) -> Value:
        self._take()
        above, below = self._group(), self._group()
        if above and above[0] in ("d", r"\partial"):
            plain = (re.sub(r"\\math\w+|[{}\\]", "", "".join(part)) for part in (above, below))
            return self._known("/".join(plain))
        one, two = (Formula(" ".join(part), self.known).value() for part in (above, below))
        return one / two

    def _called(self, function: Callable[[Any], Any]) -> Value:
        """A power of a function; 2φ needs no brackets."""
        exponent = int("".join(self._group())) if self._has("^") else 1
        is_multiple = self._next.isdigit()
        argument = self._atom()
        return function(argument * self._atom() if is_multiple else argument) ** exponent

    def _matrix(self) -> Value:
        self._take()
        rows: list[list[Value]] = [[]]
        while not self._has(r"\end{pmatrix}"):
            if self._has(r"\\"):
                rows.append([])
            elif not self._has("&"):
                rows[-1].append(self._sum())
        return mp.matrix([line for row in rows for line in _lines(row)])

    def _name(self) -> str:
        """A symbol: its face and dots, its letter, its prime, its index."""
        token = self._take()
        if token in _FACES:
            name = _FACES[token] + Formula(" ".join(self._group()), {})._name()
        elif re.fullmatch(r"\\?[A-Za-z]+|1", token):
            name = token.lstrip("\\")
        else:
            raise UnreadError(token)
        prime = "'" if self._has("'") else ""
        index = "_" + "".join(self._group()) if self._has("_") else ""
        return name + ("'" if prime or self._has("'") else "") + index
