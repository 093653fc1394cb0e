"""Independent arithmetic at 50 digits, and motions by SciPy, to judge what the package prints.

Nothing here imports the package. Rotations are built from the turns one reads in a textbook,
derivatives are numerical, and expressions are evaluated by a walk over their tree.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import sympy as sp
from mpmath import MPContext
from scipy.integrate import solve_ivp

mp = MPContext()  # a context of its own, so that no other test can change its precision
mp.dps = 50

Matrix = Any  # mp.matrix
Values = Mapping[sp.Expr, Any]

_SEQUENCES = ["".join(a) for a in product("xyz", repeat=3) if a[0] != a[1] != a[2]]
CONVENTIONS = (*(axes.upper() for axes in _SEQUENCES), *_SEQUENCES)
TOLERANCE = mp.mpf(10) ** -40

_TIME = sp.Symbol("t")
_NAMES = ("sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh", "sech", "exp", "atan")
_FUNCTIONS: dict[Any, Callable[[Any], Any]] = {getattr(sp, n): getattr(mp, n) for n in _NAMES}


def turn(axis: str, angle: Any) -> Matrix:
    """The right-handed turn about a coordinate axis, by its three matrices as books print them."""
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix(
        {
            "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
        }[axis]
    )


def rotation(convention: str, angles: Iterable[Any]) -> Matrix:
    """R from body to space components; upper case turns with the body, lower case does not.

    A turn about an axis of the body is a factor on the right, one about a fixed axis on the left.
    """
    result = mp.eye(3)
    for letter, angle in zip(convention, angles, strict=True):
        factor = turn(letter.lower(), angle)
        result = result * factor if letter.isupper() else factor * result
    return result


def unhat(skew: Matrix) -> Matrix:
    """The vector u of a matrix with M v = u × v, from both halves of the matrix."""
    pairs = ((2, 1), (0, 2), (1, 0))
    return mp.matrix([(skew[i, j] - skew[j, i]) / 2 for i, j in pairs])


def hat(vector: Matrix) -> Matrix:
    """The matrix of u ×."""
    a, b, c = vector
    return mp.matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


@dataclass(frozen=True)
class Path:
    """q(t) = q + q̇ t + q̈ t²/2, with q, q̇ and q̈ at t = 0."""

    q: tuple[Any, ...]
    q_dot: tuple[Any, ...]
    q_ddot: tuple[Any, ...]

    def at(self, t: Any) -> tuple[Any, ...]:
        steps = zip(self.q, self.q_dot, self.q_ddot, strict=True)
        return tuple(a + b * t + c * t * t / 2 for a, b, c in steps)

    def rate_at(self, t: Any) -> tuple[Any, ...]:
        return tuple(b + c * t for b, c in zip(self.q_dot, self.q_ddot, strict=True))


def paths(count: int, size: int = 3, seed: int = 1) -> tuple[Path, ...]:
    """Random paths through rational points, the same in every run."""
    source = random.Random(seed)

    def numbers() -> tuple[Any, ...]:
        return tuple(mp.mpf(source.randint(-2999, 2999)) / 1009 for _ in range(size))

    return tuple(Path(numbers(), numbers(), numbers()) for _ in range(count))


def values_along(coordinates: Iterable[sp.Expr], path: Path, t: Any = 0) -> dict[sp.Expr, Any]:
    """What the coordinates and their derivatives are worth at time t of a path."""
    found: dict[sp.Expr, Any] = {}
    for coordinate, q, rate, second in zip(
        coordinates, path.at(t), path.rate_at(t), path.q_ddot, strict=True
    ):
        found[coordinate] = q
        found[sp.Derivative(coordinate, _TIME)] = rate
        found[sp.Derivative(coordinate, (_TIME, 2))] = second
    return found


def evaluate(matrix: sp.MatrixBase, values: Values) -> Matrix:
    """A SymPy matrix in numbers."""
    rows, columns = matrix.shape
    known = dict(values)
    result = mp.matrix(rows, columns)
    for i in range(rows):
        for j in range(columns):
            result[i, j] = number(matrix[i, j], known)
    return result


def number(expression: sp.Expr, known: dict[sp.Expr, Any]) -> Any:
    """One expression in numbers; `known` remembers what was met on the way."""
    if expression not in known:
        known[expression] = _walk(expression, known)
    return known[expression]


def _walk(expression: sp.Expr, known: dict[sp.Expr, Any]) -> Any:
    if expression.is_Rational:
        return mp.mpf(int(expression.p)) / int(expression.q)
    if expression is sp.pi:
        return +mp.pi
    if expression.is_Add:
        return mp.fsum(number(part, known) for part in expression.args)
    if expression.is_Mul:
        return mp.fprod(number(part, known) for part in expression.args)
    if expression.is_Pow:
        return mp.power(*(number(part, known) for part in expression.args))
    if expression.func is sp.atan2:
        return mp.atan2(*(number(part, known) for part in expression.args))
    if expression.func in _FUNCTIONS:
        return _FUNCTIONS[expression.func](number(expression.args[0], known))
    raise TypeError(f"no value is known for {expression!r}")


def distance(first: Matrix, second: Matrix) -> Any:
    """The largest difference between the entries of two matrices of one shape."""
    assert (first.rows, first.cols) == (second.rows, second.cols)
    return max(abs(entry) for entry in first - second)


def agree(first: Matrix, second: Matrix) -> bool:
    """Whether two matrices agree to 40 digits of their size."""
    size = max(1, *(abs(entry) for entry in second))
    return bool(distance(first, second) <= TOLERANCE * size)


def newton_euler(moments, torque, omega, times, rotation=((1, 0, 0), (0, 1, 0), (0, 0, 1))):
    """Ω′ and R at the times, from Ω′ and R at 0, where `torque` gives N′ of R."""
    tensor = np.diag(moments)

    def slopes(_, y):
        matrix, (a, b, c) = y[:9].reshape(3, 3), y[9:]
        turning = matrix @ [[0, -c, b], [c, 0, -a], [-b, a, 0]]
        forces = torque(matrix) - np.cross(y[9:], tensor @ y[9:])
        return [*turning.ravel(), *np.linalg.solve(tensor, forces)]

    start, span = [*np.ravel(rotation), *omega], (0, times[-1])
    y = solve_ivp(slopes, span, start, "DOP853", times, rtol=1e-12, atol=1e-13).y.T
    return y[:, 9:], y[:, :9].reshape(-1, 3, 3)
