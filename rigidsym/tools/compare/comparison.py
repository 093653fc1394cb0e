"""Is this formula right? The entry to this folder."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import ExpressionError
from rigidsym.motion import Motion
from rigidsym.tools.compare.language import spelled_out
from rigidsym.tools.compare.matching import Comparison, Reading, against, identified, in_words
from rigidsym.tools.compare.program import formula_matrix
from rigidsym.tools.compare.quantities import SHAPES, KnownQuantity, of_motion, target


def compare(
    formula: str | sp.MatrixBase | Sequence[Any] | Callable[..., Any],
    rotation: str | Motion | None = None,
    quantity: str | None = None,
) -> Comparison:
    """Compare a formula with a quantity of a rotation, or with all known quantities.

    `formula` is a text in Python, SymPy, C, MATLAB or LaTeX, a matrix, rows of texts, or a Python
    function of the coordinates (and rates), which is called with numbers. Without `rotation` the
    conventions of the catalogue are tried. Raises ExpressionError for a text that is not a formula.
    """
    if callable(formula):
        return _of_function(formula, _goal(rotation, quantity))
    matrix = spelled_out(as_matrix(formula))
    if matrix.rows == 1:
        matrix = matrix.T
    if rotation is None and quantity is None:
        return identified(_checked(matrix))
    return against(matrix, _goal(rotation, quantity))


def _checked(formula: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Raises ExpressionError if the formula cannot be a quantity of the catalogue."""
    shape = in_words(formula.shape)
    if formula.shape not in SHAPES:
        read = f"{formula[0]} is {shape}" if len(formula) == 1 else f"the formula is {shape}"
        raise ExpressionError(
            f"{read}; expected a matrix of 3x3, 3x4, 4x3 or 4x4, or a vector of 3 or 4 entries, as "
            "in [c -s 0; s c 0; 0 0 1]"
        )
    if not formula.free_symbols:
        raise ExpressionError(f"{shape} of numbers only; expected a formula with names of angles")
    return formula


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        return formula_matrix(formula)
    if isinstance(formula, sp.MatrixBase):
        return _in_symbols(formula)
    rows = [row if isinstance(row, list | tuple) else [row] for row in formula]
    return sp.ImmutableMatrix([[as_matrix(entry)[0] for entry in row] for row in rows])


def _in_symbols(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The matrix with symbols for functions of time and their rates, and exact numbers."""
    plain: dict[sp.Expr, sp.Expr] = {f: sp.Rational(str(f)) for f in matrix.atoms(sp.Float)}
    for function in matrix.atoms(sp.Derivative, AppliedUndef):
        order = function.derivative_count if isinstance(function, sp.Derivative) else 0
        name = function.expr.func.__name__ if order else function.func.__name__
        suffix = f"_{'d' * order}ot" if order else ""
        plain[function] = sp.Symbol(name + suffix, real=True)
    return sp.ImmutableMatrix(matrix.xreplace(plain))


def _goal(rotation: str | Motion | None, quantity: str | None) -> KnownQuantity:
    if rotation is None or quantity is None:
        raise ExpressionError(
            "expected a rotation and a quantity, such as 'ZYX', 'rotation_matrix'"
        )
    if quantity == "coriolis_matrix":
        raise ExpressionError("a Coriolis matrix is not unique; compare the bias vector C(q, q̇) q̇")
    if isinstance(rotation, Motion):
        return of_motion(rotation, quantity, rotation.name)
    return target(rotation, quantity)


# Functions


def _of_function(function: Callable[..., Any], goal: KnownQuantity) -> Comparison:
    """Compare a Python function: its expression if it takes symbols, else its numbers."""
    arguments = [
        goal.motion.argument(name) for name in goal.motion.step(goal.quantity).quantity.inputs
    ]
    symbols = [np.array(argument.symbols, object) for argument in arguments]
    inputs = _spread(function, symbols)
    try:
        result = sp.Matrix(_matrix(function(*inputs)))
    except (TypeError, AttributeError):  # NumPy's sin takes no symbols
        return _by_numbers(function, goal, symbols)
    return against(_in_symbols(result), goal)


def _by_numbers(
    function: Callable[..., Any], goal: KnownQuantity, symbols: Sequence[np.ndarray[Any, Any]]
) -> Comparison:
    """Its values in the place of its entries, which have no parts that could be changed."""
    count = len(next(iter(goal.points.values())))
    rows = []
    for point in range(count):
        vectors = [np.array([goal.points[s][point] for s in vector]) for vector in symbols]
        rows.append(np.array(_matrix(function(*_spread(function, vectors))), float))
    table = np.stack(rows)
    entries = [
        [sp.Dummy(f"entry_{i + 1}{j + 1}") for j in range(table.shape[2])]
        for i in range(table.shape[1])
    ]
    formula = sp.ImmutableMatrix(entries)
    values = {s: table[:, i, j] for i, row in enumerate(entries) for j, s in enumerate(row)}
    reading = Reading(formula=formula, goal=goal, names={}, values=values, own=table)
    return against(formula, goal, [reading])


def _spread(function: Callable[..., Any], vectors: Sequence[Any]) -> list[Any]:
    """The vectors, or their components if the function takes as many arguments.

    Raises ExpressionError for a function that takes neither.
    """
    count = len(inspect.signature(function).parameters)
    components = [part for vector in vectors for part in vector]
    if count not in (len(vectors), len(components)):
        raise ExpressionError(
            f"the function takes {count} arguments; expected {len(vectors)} vectors or "
            f"{len(components)} numbers"
        )
    return list(vectors) if count == len(vectors) else components


def _matrix(value: Any) -> Any:
    """What a function returned, with two axes."""
    if isinstance(value, sp.MatrixBase):
        return value
    array = np.asarray(value)
    return array.reshape(-1, 1) if array.ndim < 2 else array


def checked(
    rotation: str | Motion, quantity: str
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compare a function with a quantity of a rotation whenever it is called without arguments.

        @rigidsym.checked("ZYX", "rate_matrix_body")
        def test_rate_matrix(q): ...

    pytest calls tests without arguments; with arguments the function computes as before. If the
    function accepts SymPy symbols, the answer is proved; otherwise it is compared at random
    points. If the function is wrong, the AssertionError says what is wrong.
    """

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        def test(*arguments: Any, **options: Any) -> Any:
            if arguments or options:
                return function(*arguments, **options)
            found = compare(function, rotation, quantity)
            if not found.is_equal:
                raise AssertionError(f"{function.__name__} is {found.text()}")
            return None

        test.__name__, test.__doc__ = function.__name__, function.__doc__
        test.__module__, test.__qualname__ = function.__module__, function.__qualname__
        return test

    return decorate
