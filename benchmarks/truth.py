"""What kernels should give, by mpmath to 50 digits; it shares no formula with them.

Rotations are products of quaternions; a product of turns adds up the axes that they have moved.
All other rate matrices and accelerations are differences of R with a step of 10⁻²⁰.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp
from mpmath import MPContext

from rigidsym.models.rotation import RotationModel

mp = MPContext()  # a context of its own, whose precision no other code changes
mp.dps = 100  # second differences with the step below lose 40 digits, and 10⁻⁴⁰ stays
_STEP = mp.mpf(10) ** -20

Vector = list[Any]  # of mpmath numbers
Quaternion = Vector  # scalar first


def times(p: Quaternion, q: Quaternion) -> Quaternion:
    """The product of quaternions, by i² = j² = k² = i j k = −1."""
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


def turned(p: Quaternion, vector: Sequence[Any]) -> Vector:
    """p v p*/|p|²."""
    size = mp.fdot(p, p)
    image = times(times(p, [mp.mpf(0), *vector]), [p[0], -p[1], -p[2], -p[3]])
    return [part / size for part in image[1:]]


def matrix_of(p: Quaternion) -> Any:
    """R, whose columns are the turned axes."""
    units = ([1, 0, 0], [0, 1, 0], [0, 0, 1])
    return mp.matrix([turned(p, unit) for unit in units]).T


def about(axis: Sequence[Any], angle: Any) -> Quaternion:
    """The turn by an angle about a unit axis."""
    return [mp.cos(angle / 2), *(mp.sin(angle / 2) * part for part in axis)]


def _of_vector(v: Vector) -> Quaternion:
    length = mp.sqrt(mp.fdot(v, v))
    return about([part / length for part in v], length) if length else [mp.mpf(1), *v]


def _of_mrp(s: Vector) -> Quaternion:
    return [1 - mp.fdot(s, s), *(2 * part for part in s)]


def _of_cosines(entries: Vector) -> Any:
    """The rotation next to nine rounded entries: two rows made orthonormal, and their product."""
    first, second = entries[:3], entries[3:6]
    first = [x / mp.norm(first) for x in first]
    along = mp.fdot(first, second)
    second = [x - along * y for x, y in zip(second, first, strict=True)]
    second = [x / mp.norm(second) for x in second]
    return mp.matrix([first, second, cross(first, second)])


BUILDERS: dict[str, Callable[[Vector], Any]] = {
    "quaternion": matrix_of,
    "unit_quaternion": matrix_of,
    "cayley_klein": lambda q: matrix_of([q[0], q[3], q[2], q[1]]),
    "axis_angle": lambda q: matrix_of(about([e / mp.norm(q[:3]) for e in q[:3]], q[3])),
    "rotation_vector": lambda q: matrix_of(_of_vector(q)),
    "gibbs_vector": lambda q: matrix_of([mp.mpf(1), *q]),
    "modified_rodrigues": lambda q: matrix_of(_of_mrp(q)),
    "direction_cosines": _of_cosines,
}


def cross(u: Sequence[Any], v: Sequence[Any]) -> Vector:
    return [u[j] * v[k] - u[k] * v[j] for j, k in ((1, 2), (2, 0), (0, 1))]


def unhat(skew: Any) -> Any:
    """The vector of a skew matrix."""
    return mp.matrix([(skew[i, j] - skew[j, i]) / 2 for i, j in ((2, 1), (0, 2), (1, 0))])


@dataclass(frozen=True, slots=True)
class Turning:
    """A turn of the model: its axis, and its angle as a sum of multiples of the coordinates."""

    axis: Vector
    weights: Vector
    rest: Any


def turns_of(model: RotationModel, constants: Sequence[float]) -> list[Turning]:
    """The turns of a model with these constants, in the order of `model.constants`."""
    values = dict(zip(model.constants, constants, strict=True))

    def worth(expression: Any) -> Any:
        exact = {symbol: sp.Float(value, 60) for symbol, value in values.items()}
        return mp.mpf(str(sp.sympify(expression).xreplace(exact).evalf(60)))

    still = dict.fromkeys(model.coordinates, sp.S.Zero)
    return [
        Turning(
            [worth(part) for part in turn.direction],
            [worth(sp.diff(turn.angle, q)) for q in model.coordinates],
            worth(turn.angle.xreplace(still)),
        )
        for turn in model.turns
    ]


class Truth:
    """All quantities of one model at one point; floats are taken as they are."""

    def __init__(
        self, name: str, turns: Sequence[Turning], state: Sequence[Sequence[float]], passive: bool
    ) -> None:
        self.name = name
        self.turns = turns
        self.passive = passive
        self.q, self.rates, self.seconds = ([mp.mpf(x) for x in part] for part in state)

    def at(self, t: Any) -> Any:
        """R on the way q + q̇ t + q̈ t²/2."""
        path = zip(self.q, self.rates, self.seconds, strict=True)
        q = [x + v * t + a * t * t / 2 for x, v, a in path]
        return self.rotation(q)

    def rotation(self, q: Vector) -> Any:
        if not self.turns:
            return BUILDERS[self.name](q)
        whole = [mp.mpf(1), 0, 0, 0]
        for turn in self.turns:
            whole = times(whole, about(turn.axis, mp.fdot(turn.weights, q) + turn.rest))
        return matrix_of(whole)

    @cached_property
    def R(self) -> Any:
        return self.rotation(self.q)

    @cached_property
    def R_dot(self) -> Any:
        return (self.at(_STEP) - self.at(-_STEP)) / (2 * _STEP)

    @cached_property
    def omega(self) -> Any:
        return unhat(self.R_dot * self.R.T)

    @cached_property
    def alpha(self) -> Any:
        second = (self.at(_STEP) - 2 * self.R + self.at(-_STEP)) / _STEP**2
        return unhat(second * self.R.T + self.R_dot * self.R_dot.T)

    @cached_property
    def W(self) -> Any:
        """Columns for the rates of all coordinates; those that leave the conditions say nothing."""
        if not self.turns:
            return mp.matrix([list(self._along(k)) for k in range(len(self.q))]).T
        columns = [[mp.mpf(0)] * 3 for _ in self.q]
        whole = [mp.mpf(1), 0, 0, 0]
        for turn in self.turns:
            axis = turned(whole, turn.axis)
            for column, weight in zip(columns, turn.weights, strict=True):
                column[:] = [x + weight * part for x, part in zip(column, axis, strict=True)]
            whole = times(whole, about(turn.axis, mp.fdot(turn.weights, self.q) + turn.rest))
        return mp.matrix(columns).T

    def _along(self, place: int) -> Any:
        ahead, behind = list(self.q), list(self.q)
        ahead[place] += _STEP
        behind[place] -= _STEP
        change = (self.rotation(ahead) - self.rotation(behind)) / (2 * _STEP)
        return unhat(change * self.R.T)

    @cached_property
    def allowed(self) -> Any:
        """Columns that span the rates which keep to the conditions, (n, k)."""
        n = len(self.q)
        normals = _normals(self.name, self.q)
        if not normals:
            return mp.eye(n)
        basis: list[Vector] = []
        for normal in normals:
            basis.append(_without(normal, basis))
        found: list[Vector] = []
        for place in sorted(range(n), key=lambda k: sum(abs(b[k]) for b in basis)):
            if len(found) < n - len(basis):
                unit = [mp.mpf(k == place) for k in range(n)]
                rest = _without(unit, [*basis, *found])
                if rest:
                    found.append(rest)
        return mp.matrix(found).T

    @cached_property
    def inverse(self) -> Any:
        """Of the allowed rates that give an angular velocity, the smallest; None for fewer."""
        W = self.W * self.allowed
        if W.cols < 3:
            return None
        return self.allowed * W.T * (W * W.T) ** -1


def _without(vector: Vector, basis: Sequence[Vector]) -> Vector:
    """The unit vector along what is at right angles to an orthonormal basis; empty for little."""
    rest = list(vector)
    for unit in basis:
        along = mp.fdot(rest, unit)
        rest = [x - along * y for x, y in zip(rest, unit, strict=True)]
    size = mp.norm(rest)
    return [x / size for x in rest] if size > mp.mpf("0.05") * mp.norm(vector) else []


def _normals(name: str, q: Vector) -> list[Vector]:
    """The gradients of the conditions."""
    if name in ("unit_quaternion", "cayley_klein"):
        return [list(q)]
    if name == "axis_angle":
        return [[*q[:3], mp.mpf(0)]]
    if name == "direction_cosines":
        rows = [q[0:3], q[3:6], q[6:9]]
        found = []
        for i in range(3):
            for j in range(i, 3):
                gradient = [mp.mpf(0)] * 9
                for k in range(3):
                    gradient[3 * i + k] += rows[j][k]
                    gradient[3 * j + k] += rows[i][k]
                found.append(gradient)
        return found
    return []
