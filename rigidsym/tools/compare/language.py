"""What formulas consist of, in every language: operations, functions and names.

Values are `Sized` expressions and matrices of SymPy, bounded as in `rigidsym.text.bounds`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from functools import reduce, wraps
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.text.bounds import FUNCTIONS, Sized, apply, longest_number, operate

_LARGEST = 20  # rows or columns
_LARGEST_INVERSE = 4
_MOST_PARTS = 50_000  # of the entries of a matrix
_LONGEST_NUMBER = 40  # digits
MINUS = Sized.number(sp.S.NegativeOne)


def as_matrix(value: Any) -> sp.ImmutableMatrix:
    """A scalar is 1x1."""
    return sp.ImmutableMatrix(value if isinstance(value, sp.MatrixBase) else [[_plain(value)]])


def _plain(value: Any) -> Any:
    return value.expression if isinstance(value, Sized) else value


def sized(value: Any) -> Any:
    """A result that may be large, with its size; raises ExpressionError if it is too large."""
    if isinstance(value, sp.MatrixBase):
        if max(value.shape) > _LARGEST:
            raise ExpressionError(f"a matrix of {value.shape}; expected at most {_LARGEST} rows")
        if sum(1 for entry in value for _ in sp.preorder_traversal(entry)) > _MOST_PARTS:
            raise ExpressionError("too large: a matrix with too many terms")
        return sp.ImmutableMatrix(value)
    expression = sp.sympify(value)
    return Sized.atom(expression, bits=longest_number(expression) or 1)


def cross_matrix(vector: sp.MatrixBase) -> sp.Matrix:
    """The matrix C(v) with C(v) u = v x u."""
    x, y, z = vector
    return sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def _unit(size: sp.Expr) -> sp.Matrix:
    if not (size.is_Integer and 0 < size <= _LARGEST):
        raise ExpressionError(f"one(n) takes a whole number up to {_LARGEST}")
    return sp.eye(int(size))


OF_MATRICES: dict[str, Callable[..., Any]] = {
    "C": cross_matrix,
    "T": lambda matrix: matrix.T,
    "one": _unit,
    "col": lambda *entries: sp.Matrix(entries),
    "stack": lambda *parts: sp.Matrix.vstack(*map(as_matrix, parts)),
    "dot": lambda a, b: a.dot(b) if 1 in a.shape else a * b,
    "cross": lambda a, b: a.cross(b),
    "outer": lambda a, b: a * b.T,
    "diag": lambda *entries: sp.diag(*entries),
    "trace": lambda matrix: matrix.trace(),
    "inv": lambda matrix: combined("**", matrix, MINUS),
}
SPELLINGS = {f + end: f for f in FUNCTIONS for end in "fFl"} | {  # of functions in programs
    **{"power": "pow", "powf": "pow", "powi": "pow", "square": "sq", "SQ": "sq", "fabs": "abs"},
    **{"safe_asin": "asin", "safe_acos": "acos", "safe_sqrt": "sqrt"},  # ArduPilot
    **{"arctan2": "atan2", "arcsin": "asin", "arccos": "acos", "arctan": "atan"},
    **{"Sqrt": "sqrt", "Sin": "sin", "Cos": "cos", "Tan": "tan"},
}
_SHORT = {"c": "cos", "s": "sin", "t": "tan", "C": "cos", "S": "sin", "T": "tan"}
CONSTANTS = dict.fromkeys(("pi", "M_PI", "PI", "Pi"), sp.pi)
CONSTANTS |= dict.fromkeys(("M_PI_2", "HALF_PI"), sp.pi / 2)
CONSTANTS |= dict.fromkeys(("DEG_TO_RAD", "DEG2RAD"), sp.pi / 180)
CONSTANTS |= dict.fromkeys(("RAD_TO_DEG", "RAD2DEG"), 180 / sp.pi)


def _of_fitting_sizes(function: Callable[..., Any]) -> Callable[..., Any]:
    """Raises ExpressionError for matrices and arguments that do not fit."""

    @wraps(function)
    def checked(*arguments: Any) -> Any:
        try:
            return function(*arguments)
        except (ValueError, TypeError, IndexError, AttributeError) as error:
            raise ExpressionError(f"not a formula: {error}") from None

    return checked


@_of_fitting_sizes
def combined(operator: str, left: Any, right: Any) -> Any:
    """left + right, and so on, of expressions and matrices; % is the product entry by entry."""
    if isinstance(left, Sized) and isinstance(right, Sized):
        return operate("*" if operator in "@%" else operator, left, right, 1)
    one, other = _plain(left), _plain(right)
    match operator:
        case "%" if Sized not in (type(left), type(right)):
            return sized(sp.matrix_multiply_elementwise(sp.Matrix(one), sp.Matrix(other)))
        case "+":
            return sized(one + other)
        case "-":
            return sized(one - other)
        case "*" | "@" | "%":
            product = one * other
            is_scalar = isinstance(product, sp.MatrixBase) and product.shape == (1, 1)
            return sized(product[0] if is_scalar else product)
        case "/" if isinstance(right, Sized) and other != 0:
            return sized(one / other)
        case "**" if other == -1 and max(one.shape) <= _LARGEST_INVERSE:
            return sized(one.adjugate() / one.det(method="berkowitz"))
        case "**" if other in range(1, 9):
            return reduce(lambda a, b: sized(a * b), [one] * int(other))
    raise ExpressionError("this operation is not defined for matrices")


@_of_fitting_sizes
def called(name: str, values: list[Any], functions: Mapping[str, Any] | None = None) -> Any:
    """A function of expressions and matrices: its own, or one of `functions`."""
    own = OF_MATRICES | dict(functions or {})
    if len(values) == 1 and isinstance(values[0], Sized) and name not in (functions or ()):
        name = _SHORT.get(name, name)
    if name in ("sind", "cosd", "tand"):
        return called(name[:-1], [called("deg2rad", values)])
    if name in ("deg2rad", "rad2deg"):
        return combined("*", Sized.atom(sp.pi / 180 if name == "deg2rad" else 180 / sp.pi), *values)
    if name in ("pow", "sq"):
        exponent = values[1] if name == "pow" else Sized.number(sp.Integer(2))
        return combined("**", values[0], exponent)
    if name in own:
        return sized(own[name](*map(_plain, values)))
    if name not in FUNCTIONS:
        raise ExpressionError(f"{name!r} is not a function; {offer(name, [*FUNCTIONS, *own])}")
    if len(values) != 1 + (name == "atan2") or not all(isinstance(v, Sized) for v in values):
        raise ExpressionError(f"{name}: wrong arguments")
    return apply(name, values, 1)


@_of_fitting_sizes
def rows(parts: list[Any]) -> sp.ImmutableMatrix:
    """A column of scalars, or rows; a list inside the list is a row."""
    if all(isinstance(part, Sized) for part in parts):
        return sized(sp.Matrix([part.expression for part in parts]))
    matrices = (as_matrix(part) for part in parts)
    return sized(sp.Matrix.vstack(*(row.T if row.cols == 1 else row for row in matrices)))


def number(text: str) -> Sized:
    """A number in decimal digits."""
    if len(text) > _LONGEST_NUMBER or not re.fullmatch(r"[\d.]+([eE][+-]?\d\d?)?", text):
        raise ExpressionError(f"a number of more than {_LONGEST_NUMBER} digits")
    return Sized.number(sp.Rational(text))


_SHORTENED = re.compile(r"(sin|cos|tan|[sctv])_?([A-Za-z0-9]\w*|)")
ANGLE = re.compile(
    r"(phi|theta|psi|alpha|beta|gamma|roll|pitch|yaw|th|ph|ps|[abg]|[xyz])_?\d?", re.IGNORECASE
)
_FULL = {"s": sp.sin, "c": sp.cos, "t": sp.tan, "v": lambda angle: 1 - sp.cos(angle)}


def spelled_out(matrix: sp.MatrixBase, computed: Collection[sp.Symbol] = ()) -> sp.ImmutableMatrix:
    """The matrix with sines and cosines for names such as sphi, cos_roll, c1, ct and s, c.

    A name is short for a sine if its cosine is there too, or if it ends as angles are called.
    Names of what a program has `computed` are no abbreviations.
    """
    letters_of: dict[str, dict[str, sp.Symbol]] = {}
    for symbol in sorted(matrix.free_symbols - set(computed), key=str):
        match = _SHORTENED.fullmatch(symbol.name)
        if match:
            letters_of.setdefault(match[2], {})[match[1][0]] = symbol
    values: dict[sp.Symbol, sp.Expr] = {}
    for stem, letters in letters_of.items():
        is_pair = {"s", "c"} <= letters.keys()
        if not is_pair:
            letters.pop("v", None)  # a versine has a sine and a cosine beside it
        if is_pair or (len(stem) > 1 and ANGLE.fullmatch(stem)):
            angle = sp.Symbol(stem if stem[:1].isalpha() else f"angle{stem}", real=True)
            values |= {symbol: _FULL[letter](angle) for letter, symbol in letters.items()}
    return sp.ImmutableMatrix(matrix.xreplace(values))
