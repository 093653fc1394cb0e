"""Expressions -> lines of sums of products, in the spelling of `formulas`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import sympy as sp

from rigidsym.errors import KernelError
from rigidsym.kernels.conversions.formulas import Line
from rigidsym.kernels.lowering.naming import Names

_DIGITS = 30
_ZERO = sp.Float("1e-25")  # what has all digits is larger or zero
Vector = tuple[sp.Expr, ...]


def number(exact: sp.Expr) -> float:
    """The nearest float; what is zero is zero, whatever radicals it is written in."""
    value = sp.N(exact, _DIGITS)
    return 0.0 if abs(value) < _ZERO else float(value)


class Local(sp.Symbol):
    """The name of a line; no symbol of a model equals it, though it be called the same."""


class LineWriter:
    """Collects lines; what is neither a number nor a name inside a product gets a line of its own.

    `names` are those of the inputs, which may be any words; `taken` are the names that lines use.
    """

    def __init__(self, names: Mapping[sp.Expr, str], taken: Iterable[str]) -> None:
        self.lines: list[Line] = []
        self._inputs = {e: sp.Dummy(name) for e, name in names.items()}
        self._words: dict[sp.Expr, str] = {d: names[e] for e, d in self._inputs.items()}
        self._free = Names((*taken, *names.values()))
        self._known: dict[sp.Expr, sp.Expr] = {}

    def fresh(self, prefix: str) -> str:
        return self._free.numbered(prefix)

    def let(self, names: Sequence[str], values: Iterable[sp.Expr]) -> Vector:
        """The names for the values; names that the values are made of change together."""
        texts = [self.text(value) for value in values]
        old = {symbol.name for value in values for symbol in value.free_symbols}
        if len(names) > 1 and old.intersection(names):
            held = [self.fresh("v") for _ in names]
            self.lines += zip(held, texts, strict=True)
            texts = held
        self.lines += zip(names, texts, strict=True)
        return tuple(map(Local, names))

    def shared(self, values: Iterable[sp.Expr]) -> Vector:
        """The values as numbers, inputs, or names of lines that hold them."""
        return tuple(self._atom(value.xreplace(self._inputs)) for value in values)

    def whole(self, values: Iterable[sp.Expr]) -> Vector:
        """The same, each number rounded once, so that the terms it is a sum of do not part."""
        return tuple(
            sp.Float(number(value)) if value.is_number else self.shared([value])[0]
            for value in values
        )

    def text(self, expression: sp.Expr) -> str:
        """A sum of products of numbers and names."""
        terms = sp.Add.make_args(sp.expand(expression.xreplace(self._inputs)))
        written = [text for term in terms if (text := self._term(term))]
        joined = " ".join(written).removeprefix("+ ") or "0.0"
        return "-" + joined.removeprefix("- ") if joined.startswith("- ") else joined

    def _term(self, term: sp.Expr) -> str:
        """`+ 2.0 * a * b`; empty where the number is zero."""
        parts = sp.Mul.make_args(term)
        size = number(sp.Mul(*(part for part in parts if part.is_number)))
        if not size:
            return ""
        factors = [f for part in parts if not part.is_number for f in self._factors(part)]
        if abs(size) != 1 or not factors:
            factors = [repr(abs(size)), *factors]
        return ("- " if size < 0 else "+ ") + " * ".join(factors)

    def _factors(self, part: sp.Expr) -> list[str]:
        if part.is_Pow and part.exp.is_Integer and part.exp > 0:
            return [self._word(self._atom(part.base))] * int(part.exp)
        return [self._word(self._atom(part))]

    def _word(self, atom: sp.Expr) -> str:
        return self._words.get(atom, str(atom))

    def _atom(self, expression: sp.Expr) -> sp.Expr:
        """A number, a name, or the name of a line that is written for it."""
        sign, size = expression.as_coeff_Mul()
        if expression.is_number or expression.is_Symbol or (size.is_Symbol and abs(sign) == 1):
            return expression
        if expression not in self._known:
            value = self._called(expression)
            name = self.fresh("v")
            self.lines.append((name, value))
            self._known[expression] = Local(name)
        return self._known[expression]

    def _called(self, expression: sp.Expr) -> str:
        if isinstance(expression, sp.sin | sp.cos):
            inside = self.text(expression.args[0])
            return f"${type(expression).__name__}({inside})"
        if expression.is_Pow and expression.exp == sp.S.Half:
            return f"$sqrt({self.text(expression.base)})"
        if expression.is_Pow and expression.exp.is_negative:
            return f"1.0 / {self._word(self._atom(1 / expression))}"
        if expression.is_Add or expression.is_Mul or expression.is_Pow:
            return self.text(expression)
        raise KernelError(f"a conversion cannot compute {expression}")

    def angle(self, name: str, first: Vector, second: Vector) -> str:
        """The angle between two unit vectors, as a number or as a line of this name."""
        cosine = sum(a * b for a, b in zip(first, second, strict=True))
        cross = sp.Matrix(first).cross(sp.Matrix(second))
        if all(part.is_number for part in (*first, *second)):
            return repr(number(sp.atan2(sp.sqrt(cross.dot(cross)), cosine)))
        parts = [self.let([self.fresh("v")], [part])[0] for part in cross]
        square = " + ".join(f"{part} * {part}" for part in parts)
        along = self.let([self.fresh("v")], [cosine])[0]
        self.lines += [(name, f"$sqrt({square})"), (name, f"$atan2({name}, {along})")]
        return name

    def flat(self, name: str, first: Vector, middle: Vector, last: Vector) -> str:
        """The middle angle at which the first axis, the middle one and the turned last are in
        one plane, the outer ones on one side: atan2(B, A)."""
        one, two, three = map(sp.Matrix, (first, middle, last))
        across, along = one.dot(two.cross(three)), one.dot(three) - one.dot(two) * two.dot(three)
        if all(part.is_number for part in (*first, *middle, *last)):
            return repr(number(sp.atan2(number(across), number(along))))
        upper, lower = self.let([self.fresh("v"), self.fresh("v")], [across, along])
        self.lines.append((name, f"$atan2({upper}, {lower})"))
        return name
