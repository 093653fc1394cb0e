"""Formulas as people type them, from text to a matrix: a walk over Python's ast. No text is run.

    read_formula("[[cos(a), -sin(a)], [sin(a), cos(a)]]")          any name is a symbol
    read_formula("one(3) + C(v)/2", {"v": sp.Matrix(...)})          only these names are known

Products of matrices are `*` or `@`, and `%` entry by entry. Known besides the functions of
expressions: C (the matrix of the vector product), T or `.T`, one, col, dot, cross, outer, diag,
stack, trace, pow and `m[i, j]`, counted from 1. Sizes are bounded as in `rigidsym.text.bounds`.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Callable, Collection, Mapping
from functools import reduce, wraps
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.text.bounds import FUNCTIONS, Sized, apply, longest_number, operate
from rigidsym.text.names import spelled

_LARGEST = 20  # rows or columns
_MOST_PARTS = 50_000  # of the entries of a matrix
_LONGEST_NUMBER = 40  # digits
MINUS = Sized.number(sp.S.NegativeOne)


def read_formula(
    text: str,
    names: Mapping[str, Any] | None = None,
    functions: Mapping[str, Callable[..., Any]] | None = None,
    *,
    free: bool = False,
) -> sp.ImmutableMatrix:
    """The matrix in a text; a scalar is 1x1.

    `names` are the known expressions and matrices. None, or `free`, makes symbols of all others.
    `functions` take and return expressions and matrices of SymPy. Raises ExpressionError.
    """
    reader = _FormulaWalk(names or {}, functions or {}, free=free or names is None)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", SyntaxWarning)  # 1or is no formula
            tree = ast.parse(text.strip(), mode="eval")
        return as_matrix(reader.value(tree.body))
    except SyntaxError as error:
        raise _misread(text.strip(), error) from None
    except (ValueError, IndexError) as error:  # NUL in the text, m[9, 9]
        raise ExpressionError(f"not a formula: {error}") from None
    except (RecursionError, MemoryError):
        raise ExpressionError("operations are nested too deeply") from None


def _misread(text: str, error: SyntaxError) -> ExpressionError:
    """What was expected, and where."""
    missing = re.search(r"[)\]]\s*(\w+)", text)
    if missing:
        expected = f"expected an operator such as * between {text[: missing.start(1)].strip()!r}"
        return ExpressionError(f"{expected} and {missing[1]!r}", column=missing.start(1) + 1)
    place = min(error.offset or 1, len(text))
    near = f"unexpected {text[place - 1 : place + 9]!r}" if text else "an empty text"
    return ExpressionError(f"{near}; expected a formula, as in -s*phi_dot + c/2", column=place)


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
}
WRAPPERS = {"array", "asarray", "matrix", "Matrix", "ImmutableMatrix", "mat", "sym", "Array"}
SPELLINGS = {f + end: f for f in FUNCTIONS for end in "fFl"} | {  # of functions in programs
    **{"power": "pow", "powf": "pow", "square": "sq", "SQ": "sq", "fabs": "abs"},
    **{"safe_asin": "asin", "safe_acos": "acos", "safe_sqrt": "sqrt"},  # ArduPilot
    **{"arctan2": "atan2", "arcsin": "asin", "arccos": "acos", "arctan": "atan"},
    **{"Sqrt": "sqrt", "Sin": "sin", "Cos": "cos", "Tan": "tan"},
}
FUNCTION_NAMES = {*FUNCTIONS, "pow", "sq", "pi", "M_PI", "one"}
_SHORT = {"c": "cos", "s": "sin", "t": "tan", "C": "cos", "S": "sin", "T": "tan"}
CONSTANTS = dict.fromkeys(("pi", "M_PI", "PI", "Pi"), sp.pi)
CONSTANTS |= {"M_PI_2": sp.pi / 2, "HALF_PI": sp.pi / 2, "DEG_TO_RAD": sp.pi / 180}


class _FormulaWalk:
    """Values of the nodes of one formula: Sized, ImmutableMatrix, or a word for a function."""

    def __init__(
        self, names: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]], *, free: bool
    ) -> None:
        self.names = names
        self.free = free
        self.functions = functions

    def value(self, node: ast.expr) -> Any:
        column = getattr(node, "col_offset", 0) + 1
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return number(repr(value), column)
            case ast.Constant(value=str() as word) if self.functions:
                return word
            case ast.Name(id=name):
                return self._name(spelled(name), column)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.value(operand)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return combined("*", MINUS, self.value(operand), column)
            case ast.BinOp(left=left, op=op, right=right):
                word = next((w for w, kind in _OPERATORS.items() if isinstance(op, kind)), "")
                return combined(word, self.value(left), self.value(right), column)
            case ast.List(elts=parts) | ast.Tuple(elts=parts) if parts:
                return rows([self.value(part) for part in parts])
            case ast.Attribute(value=inner, attr="T"):
                return as_matrix(self.value(inner)).T
            case ast.Subscript(
                value=inner,
                slice=ast.Tuple(elts=[ast.Constant(value=int(i)), ast.Constant(value=int(j))]),
            ) if min(i, j) > 0:
                return sized(as_matrix(self.value(inner))[i - 1, j - 1])
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                values = [self.value(argument) for argument in arguments]
                return called(spelled(name), values, self.functions, column)
        raise ExpressionError(f"{type(node).__name__} is not allowed", column=column)

    def _name(self, name: str, column: int) -> Any:
        if name in self.names:
            return sized(self.names[name])
        if self.free or name in CONSTANTS:
            return Sized.atom(CONSTANTS.get(name, sp.Symbol(name, real=True)))
        raise ExpressionError(f"unknown name {name!r}; {offer(name, self.names)}", column=column)


_OPERATORS: dict[str, type[ast.operator]] = {
    **{"+": ast.Add, "-": ast.Sub, "*": ast.Mult, "/": ast.Div, "**": ast.Pow},
    **{"@": ast.MatMult, "%": ast.Mod},  # % is the product entry by entry
}


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
def combined(operator: str, left: Any, right: Any, column: int = 1) -> Any:
    """left + right, and so on, of expressions and matrices."""
    if isinstance(left, Sized) and isinstance(right, Sized):
        return operate("*" if operator in "@%" else operator, left, right, column)
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
        case "**" if other in range(1, 9):
            return reduce(lambda a, b: sized(a * b), [one] * int(other))
    raise ExpressionError("this operation is not defined for matrices", column=column)


@_of_fitting_sizes
def called(
    name: str, values: list[Any], functions: Mapping[str, Any] | None = None, column: int = 1
) -> Any:
    """A function of expressions and matrices: its own, or one of `functions`."""
    own = OF_MATRICES | dict(functions or {})
    if len(values) == 1 and isinstance(values[0], Sized):
        name = _SHORT.get(name, name) if name not in (functions or ()) else name
    elif name in WRAPPERS and len(values) == 1:
        return as_matrix(values[0])
    if name in ("pow", "sq"):
        exponent = values[1] if name == "pow" else Sized.number(sp.Integer(2))
        return combined("**", values[0], exponent, column)
    if name in own:
        return sized(own[name](*map(_plain, values)))
    if name not in FUNCTIONS:
        hint = offer(name, [*FUNCTIONS, *own])
        raise ExpressionError(f"{name!r} is not a function; {hint}", column=column)
    if len(values) != 1 + (name == "atan2") or not all(isinstance(v, Sized) for v in values):
        raise ExpressionError(f"{name}: wrong arguments", column=column)
    return apply(name, values, column)


@_of_fitting_sizes
def rows(parts: list[Any]) -> sp.ImmutableMatrix:
    """A column of scalars, or rows; a list inside the list is a row."""
    if all(isinstance(part, Sized) for part in parts):
        return sized(sp.Matrix([part.expression for part in parts]))
    matrices = (as_matrix(part) for part in parts)
    return sized(sp.Matrix.vstack(*(row.T if row.cols == 1 else row for row in matrices)))


def number(text: str, column: int = 1) -> Sized:
    """A number in decimal digits."""
    if len(text) > _LONGEST_NUMBER or not re.fullmatch(r"[\d.]+([eE][+-]?\d\d?)?", text):
        raise ExpressionError(f"a number of more than {_LONGEST_NUMBER} digits", column=column)
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
    found: dict[str, dict[str, sp.Symbol]] = {}
    for symbol in sorted(matrix.free_symbols - set(computed), key=str):
        match = _SHORTENED.fullmatch(symbol.name)
        if match:
            found.setdefault(match[2], {})[match[1][0]] = symbol
    values: dict[sp.Symbol, sp.Expr] = {}
    for stem, letters in found.items():
        if not {"s", "c"} <= letters.keys():
            letters.pop("v", None)  # a versine has a sine and a cosine beside it
        if {"s", "c"} <= letters.keys() or (len(stem) > 1 and ANGLE.fullmatch(stem)):
            angle = sp.Symbol(stem if stem[:1].isalpha() else f"angle{stem}", real=True)
            values |= {symbol: _FULL[letter](angle) for letter, symbol in letters.items()}
    return sp.ImmutableMatrix(matrix.xreplace(values))


def name_of(name: str) -> str:
    """One name for what has dots and arrows: np.sin is sin, state.phi is phi, q.w() is q_w."""
    parts = [part for part in re.split(r"::|->|\.|\(\)", name) if part]
    parts = parts[parts[0] in ("self", "this") and len(parts) > 1 :]
    last = SPELLINGS.get(parts[-1], parts[-1])
    if last in FUNCTION_NAMES or last in WRAPPERS or len(parts) == 1:
        return last
    return f"{parts[-2]}_{last}" if len(last) == 1 else last
