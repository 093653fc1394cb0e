"""What formulas consist of, in every language: operations, functions and names.

Values are expressions and matrices of SymPy, bounded as in `rigidsym.text.bounds`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from functools import partial, reduce, wraps
from itertools import chain
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.models.rotation import hat
from rigidsym.text.bounds import FUNCTIONS, Sized, apply, longest_number, operate
from rigidsym.tools.compare.syntax import NUMBERS, SPELLINGS, limits, patterns

magnitude = partial(sp.Abs, evaluate=False)  # whose evaluation takes long


def as_matrix(value: Any) -> sp.ImmutableMatrix:
    """A scalar is 1x1."""
    return sp.ImmutableMatrix(value if isinstance(value, sp.MatrixBase) else [[value]])


def _bounded(value: Any) -> Any:
    """A value; raises ExpressionError if it is too large."""
    if not isinstance(value, sp.MatrixBase):
        return sp.sympify(value)
    if max(value.shape) > limits.largest:
        raise ExpressionError(f"a matrix of {value.shape}; expected at most {limits.largest} rows")
    if sum(1 for entry in value for _ in sp.preorder_traversal(entry)) > limits.entry_parts:
        raise ExpressionError("too large: a matrix with too many terms")
    return sp.ImmutableMatrix(value)


def _sized(value: sp.Expr) -> Sized:
    return Sized.atom(value, bits=longest_number(value) or 1)


OF_MATRICES: dict[str, Callable[..., Any]] = {"C": hat, "T": lambda m: m.T}
OF_MATRICES |= {"diag": lambda *parts: sp.diag(*chain.from_iterable(map(as_matrix, parts)))}
OF_MATRICES |= {"cross": lambda a, b: a.cross(b), "outer": lambda a, b: a * b.T}
OF_MATRICES |= {"dot": lambda a, b: a.dot(b) if 1 in a.shape else a * b}
OF_MATRICES |= {"one": lambda size: sp.eye(min(size, limits.largest + 1))}
OF_MATRICES |= {"col": lambda *entries: sp.Matrix(entries), "trace": lambda m: m.trace()}
OF_MATRICES |= {"stack": lambda *parts: sp.Matrix.vstack(*map(as_matrix, parts))}
OF_MATRICES |= {"hypot": lambda *sides: called("sqrt", [sum(called("sq", [s]) for s in sides)])}
OF_MATRICES |= {"copysign": lambda a, b: combined("*", called("abs", [a]), called("sign", [b]))}
OF_MATRICES |= {"inv": lambda matrix: combined("**", matrix, sp.S.NegativeOne)}
_IN_DEGREES = {f"{name}d": name for name in FUNCTIONS if re.fullmatch("a?(sin|cos|tan2?)", name)}
OF_NUMBERS = {*FUNCTIONS, *_IN_DEGREES, *SPELLINGS.values(), "deg2rad", "rad2deg"}


def function_word(name: str) -> str:
    """The function of numbers that a program calls by this name, or the name itself."""
    if match := patterns.spelled.fullmatch(name):
        return ("a" if match[1] else "") + match[2].lower()
    match = patterns.angle_units.fullmatch(name)
    if match and (match[1] or match[3] or name in ("radians", "degrees")):
        return "deg2rad" if (match[3] or match[2]).lower() == "rad" else "rad2deg"
    return SPELLINGS.get(name, name)


_POWERS = {"pow": None, "sq": sp.Integer(2), "rsqrt": -sp.S.Half, "recip": sp.S.NegativeOne}
_SHORT = {"c": "cos", "s": "sin", "t": "tan", "C": "cos", "S": "sin", "T": "tan"}
CONSTANTS = {word: sp.sympify(value) for word, value in NUMBERS.items()}
_OF_TURNS = {float(value): value for value in CONSTANTS.values()}  # 57.29578 is 180/π


def number(text: str) -> sp.Expr:
    """A decimal number, or a multiple of π that it rounds to four digits or more."""
    value = sp.Rational(text)
    near = (v for x, v in _OF_TURNS.items() if abs(float(value) / x - 1) < limits.near_turn)
    return next(near, value) if "." in text else value


def _of_fitting_sizes(function: Callable[..., Any]) -> Callable[..., Any]:
    """Raises ExpressionError for matrices and arguments that do not fit."""

    @wraps(function)
    def checked(*arguments: Any) -> Any:
        try:
            return function(*arguments)
        except (ValueError, TypeError, IndexError, AttributeError):
            parts = [p for a in arguments for p in (a if isinstance(a, list) else [a])]
            sizes = [str(getattr(p, "shape", "a number")) for p in parts if not isinstance(p, str)]
            raise ExpressionError(f"sizes that do not fit: {' and '.join(sizes)}") from None

    return checked


@_of_fitting_sizes
def combined(operator: str, left: Any, right: Any) -> Any:
    """left + right, and so on, of expressions and matrices; % is the product entry by entry."""
    matrices = [isinstance(value, sp.MatrixBase) for value in (left, right)]
    if not any(matrices):
        sign = "*" if operator in "@%" else operator
        return operate(sign, _sized(left), _sized(right), 1).expression
    match operator:
        case "%" if all(matrices):
            return _bounded(sp.matrix_multiply_elementwise(sp.Matrix(left), sp.Matrix(right)))
        case "+" | "-":
            return _bounded(left + right if operator == "+" else left - right)
        case "*" | "@" | "%":
            product = left * right
            is_scalar = isinstance(product, sp.MatrixBase) and product.shape == (1, 1)
            return _bounded(product[0] if is_scalar else product)
        case "/" if not matrices[1] and right != 0:
            return _bounded(left / right)
        case "**" if right == -1 and max(left.shape) <= limits.largest_inverse:
            # Berkowitz' algorithm does not divide, so that no symbolic pivot has to be told from
            # zero.
            return _bounded(left.adjugate() / left.det(method="berkowitz"))
        case "**" if right in range(1, 9):
            return reduce(lambda a, b: _bounded(a * b), [left] * int(right))
    raise ExpressionError("this operation is not defined for matrices")


@_of_fitting_sizes
def called(name: str, values: list[Any]) -> Any:
    """A function of expressions and matrices."""
    is_matrix = any(isinstance(value, sp.MatrixBase) for value in values)
    name = _SHORT.get(name, name) if len(values) == 1 and not is_matrix else name
    if own := _IN_DEGREES.get(name):
        steps = (own, "rad2deg") if own.startswith("a") else ("deg2rad", own)
        return called(steps[1], [called(steps[0], values)])
    if name in ("deg2rad", "rad2deg"):
        return combined("*", sp.pi / 180 if name == "deg2rad" else 180 / sp.pi, *values)
    if name in _POWERS:
        return combined("**", values[0], _POWERS[name] or values[1])
    if name == "sign" and not is_matrix and values[0] != 0:
        return values[0] / magnitude(values[0])
    if name in OF_MATRICES:
        return _bounded(OF_MATRICES[name](*values))
    if name not in FUNCTIONS:
        hint = offer(name, [*FUNCTIONS, *OF_MATRICES])
        raise ExpressionError(f"{name!r} is not a function; {hint}")
    if is_matrix and len(values) == 1:  # of each entry
        return values[0].applyfunc(lambda entry: called(name, [entry]))
    if len(values) != 1 + (name == "atan2") or is_matrix:
        raise ExpressionError(f"{name}: wrong arguments")
    return apply(name, [_sized(value) for value in values], 1).expression


@_of_fitting_sizes
def rows(parts: list[Any]) -> sp.ImmutableMatrix:
    """A column of scalars, or rows; a list inside the list is a row."""
    if not any(isinstance(part, sp.MatrixBase) for part in parts):
        return _bounded(sp.Matrix(parts))
    matrices = [m.T if m.cols == 1 else m for m in map(as_matrix, parts)]
    return _bounded(sp.Matrix.vstack(*matrices))


_FULL = {"s": sp.sin, "c": sp.cos, "t": sp.tan, "v": lambda angle: 1 - sp.cos(angle)}


def spelled_out(
    matrix: sp.MatrixBase, computed: Collection[sp.Symbol] = (), only: str = "angle"
) -> sp.ImmutableMatrix:
    """The matrix with sines and cosines for names such as sphi, cos_roll, c1, ct and s, c.

    A name is short for a sine if its cosine is there too, or if it ends as angles are called.
    Names of what a program has `computed` are no abbreviations. The angle of s and c is the `only`
    one.
    """
    letters_of: dict[str, dict[str, sp.Symbol]] = {}
    for symbol in sorted(matrix.free_symbols - set(computed), key=str):
        if match := patterns.shortened.fullmatch(symbol.name):
            letters_of.setdefault(match[2], {})[match[1][0]] = symbol
    values: dict[sp.Symbol, sp.Expr] = {}
    for stem, letters in letters_of.items():
        is_pair, is_angle = {"s", "c"} <= letters.keys(), patterns.angle.fullmatch(stem)
        name = stem if stem[:1].isalpha() else f"angle{stem}" if stem else only
        for letter, symbol in letters.items():  # a versine has a sine and a cosine beside it
            if is_pair or (is_angle and len(stem) > 1 and letter != "v"):
                values[symbol] = _FULL[letter](sp.Symbol(name, real=True))
    return sp.ImmutableMatrix(matrix.xreplace(values))
