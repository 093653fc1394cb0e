"""Largest error of every kernel of every rotation in eps: anywhere, near poles, beside switches.

The truth has 50 digits and shares no code with the kernels. Errors are relative to the largest
entry of a matrix, and for vectors to that times the length of what it is applied to. Near a pole
an error counts in multiples of what the text of the module allows: eps times `allowed`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.form import SYMBOLS
from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Report, Table
from benchmarks.truth import Truth, mp, turns_of
from rigidsym.algebra.series import FIRST_SERIES, series_of
from rigidsym.models.euler_angles import EULER_SEQUENCES
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import Motion, derive

Float = type[np.floating[Any]]

CHAINS = (
    "z(phi) x(theta/2) z(psi)",
    "y(phi) x(theta)",
    "z(phi) x(theta) z(psi) y(delta)",
    "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5)",
)
MODELS = (*EULER_SEQUENCES, *PARAMETRISATIONS, "davenport", *CHAINS)
BESIDE = 1e-6  # how far from a switch, as a part of it
NEAREST: dict[Float, int] = {
    np.float64: 12,
    np.float32: 4,
}  # distances go down to ten to minus this
BOUND = {"unit_quaternion": 4, "cayley_klein": 4, "axis_angle": 3}  # leading coordinates, a unit
CONSTANTS = {"b": 0.6, "c": 0.8}
_MOST_POLES = 2  # of one rotation: the others differ in signs alone

Array = NDArray[Any]
Errors = dict[tuple[str, str, str], float]  # where, precision, kernel


@dataclass(frozen=True, slots=True)
class Point:
    """Coordinates, rates, second rates and an angular velocity, in one precision."""

    q: Array
    q_dot: Array
    q_ddot: Array
    omega: Array

    def given(self, inputs: Sequence[str], constants: Array) -> list[Array]:
        vectors = {
            "q": self.q,
            "q_dot": self.q_dot,
            "q_ddot": self.q_ddot,
            "omega_space": self.omega,
            "omega_body": self.omega,
            "parameters": constants,
        }
        return [vectors[name] for name in inputs]


class Subject:
    """One rotation with its module."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.motion: Motion = derive(rotation_from(text))
        self.module: ModuleType = self.motion.kernels("numpy").load()
        self.constants = [CONSTANTS[symbol.name] for symbol in self.motion.model.constants]
        self.turns = turns_of(self.motion.model, self.constants)

    def points(self, dtype: Float, samples: int) -> Iterator[tuple[str, Point]]:
        """Where each point lies, and the point."""
        random = np.random.default_rng(3)
        for _ in range(samples):
            yield "anywhere", self._moving(self._anywhere(random), dtype, random)
        for q in self._near(random, NEAREST[dtype]):
            yield "near poles", self._moving(q, dtype, random)
        for q in self._beside(random):
            yield "at switches", self._moving(q, dtype, random)

    def _anywhere(self, random: np.random.Generator) -> Array:
        size = len(self.motion.model.coordinates)
        q = random.uniform(-2, 2, size)
        if self.text == "direction_cosines":
            return np.linalg.qr(random.normal(size=(3, 3)))[0].ravel()
        return self._bound(q)

    def _bound(self, q: Array) -> Array:
        count = BOUND.get(self.text, 0)
        if count:
            q[:count] /= np.linalg.norm(q[:count])
        return q

    def _near(self, random: np.random.Generator, nearest: int) -> Iterator[Array]:
        """Ever nearer to poles, on both sides."""
        coordinates = self.motion.model.coordinates
        names = dict(zip(self.motion.model.constants, self.constants, strict=True))
        found = self.motion.singularities
        for point in found.points[:_MOST_POLES] if found else ():
            for power in range(1, nearest + 1):
                for sign in (1, -1):
                    q = self._anywhere(random)
                    for place in point.places:
                        away = sign * 10.0**-power
                        value = float(place.value.subs(names)) + away
                        if place.is_length:
                            q *= value / np.linalg.norm(q)
                        else:
                            q[coordinates.index(place.coordinate)] = value
                    if point.places:
                        yield q

    def _beside(self, random: np.random.Generator) -> Iterator[Array]:
        """Just below and above each switch between a series and its closed form, and at zero."""
        if self.text != "rotation_vector":
            return
        switches = [float(series_of(k).switch) ** 0.5 for k in range(FIRST_SERIES, 6)]
        beside = [switch * (1 + side) for switch in switches for side in (-BESIDE, BESIDE)]
        for length in (0.0, 1e-30, 1e-8, 1e-3, *beside):
            q = random.normal(size=3)
            yield q * (length / np.linalg.norm(q))

    def _moving(self, q: Array, dtype: Float, random: np.random.Generator) -> Point:
        """The point in one precision, its rates such as the conditions allow."""
        q = q.astype(dtype)
        rate, second = random.normal(size=(2, len(q)))
        rate, second = self._allowed(q.astype(float), rate, second)
        omega = random.normal(size=3)
        return Point(q, *(v.astype(dtype) for v in (rate, second, omega)))

    def _allowed(self, q: Array, rate: Array, second: Array) -> tuple[Array, Array]:
        if self.text == "direction_cosines":
            R, (w, a) = q.reshape(3, 3), (_hat(rate[:3]), _hat(second[:3]))
            return (w @ R).ravel(), (a @ R + w @ w @ R).ravel()
        count = BOUND.get(self.text, 0)
        if count:
            unit = q[:count]
            rate[:count] -= unit * (unit @ rate[:count])
            second[:count] -= unit * (unit @ second[:count] + rate[:count] @ rate[:count])
        return rate, second

    def errors(self, point: Point, dtype: Float) -> Iterator[tuple[str, float]]:
        """The error of each kernel, in eps; nothing where it says NaN."""
        state = [part.tolist() for part in (point.q, point.q_dot, point.q_ddot)]
        truth = Truth(self.text, self.turns, state, passive=self.motion.model.passive)
        eps = float(np.finfo(dtype).eps)
        constants = np.array(self.constants, dtype)
        for step in self.motion.steps:
            name = step.quantity.name
            function = getattr(self.module, name)
            found = function(*point.given(step.quantity.inputs, constants))
            assert found.dtype == dtype
            if np.isfinite(found).all():
                yield name, self._error(name, found, truth, point) / eps

    def _error(self, name: str, found: Array, truth: Truth, point: Point) -> float:
        exact, scale = _exact(name, truth, point)
        values = mp.matrix(found.tolist())
        if name.startswith("rate_matrix"):
            values = values * truth.allowed
        error = max(abs(x) for x in values - exact)
        return float(error / scale / self.allowed(name, truth))

    def allowed(self, name: str, truth: Truth) -> Any:
        """What the text of the module allows, over eps and the few of a few eps."""
        if self.text == "rotation_vector":
            n = mp.norm(truth.q)
            if name.startswith(("inverse", "rates")):
                return max(1, n / abs(mp.sin(n / 2))) if n > 1 else 1
            return max(1, n)
        if not self.divides_by_sum or not name.startswith(("inverse", "rates")):
            return 1
        if len(truth.q) == 3:
            return max(1, 1 / abs(mp.det(truth.W)))
        reach = 1 + mp.fsum(map(abs, truth.q))
        return max(1, reach / mp.sqrt(mp.det(truth.W * truth.W.T)))

    @property
    def divides_by_sum(self) -> bool:
        """Whether what vanishes at the poles is a sum of sines and cosines."""
        found = self.motion.singularities
        shown = found.determinant if found else None
        return bool(self.turns) and shown is not None and bool(shown.is_Add)


def _hat(vector: Array) -> Array:
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def _exact(name: str, truth: Truth, point: Point) -> tuple[Any, Any]:
    """The value of a quantity, and what its error is relative to."""
    frame, R = name.rpartition("_")[2], truth.R
    back = R.T if frame == "body" else mp.eye(3)
    rate = mp.norm(truth.rates)
    if name.startswith(("inverse", "rates")):
        inverse = truth.inverse * back.T
        size = max(abs(x) for x in inverse)
        if name.startswith("inverse"):
            return inverse, size
        omega = mp.matrix(point.omega.tolist())
        return inverse * omega, size * mp.norm(omega)
    largest = max(abs(x) for x in truth.W * truth.allowed)
    if name.startswith("rate_matrix"):
        return back * truth.W * truth.allowed, largest
    if name.startswith("angular_velocity"):
        return back * truth.omega, largest * rate
    if name.startswith("angular_acceleration"):
        return back * truth.alpha, largest * mp.norm(truth.seconds) + rate**2
    shown, moving = (R.T, truth.R_dot.T) if truth.passive else (R, truth.R_dot)
    values = {
        "rotation_matrix": (shown, mp.mpf(1)),
        "rotation_rate": (moving, largest * rate),
        "spin_matrix": (moving * shown.T, largest * rate),
    }
    return values[name]


def errors(text: str, samples: int) -> Errors:
    """The largest errors of one rotation."""
    subject = Subject(text)
    parts = [errors_of(subject, dtype, samples) for dtype in NEAREST]
    return {key: error for part in parts for key, error in part.items()}


def errors_of(subject: Subject, dtype: Float, samples: int, *, poles: bool = True) -> Errors:
    """The largest errors in one precision; at random points alone without `poles`."""
    found: Errors = {}
    for where, point in subject.points(dtype, samples):
        for name, error in subject.errors(point, dtype) if poles or where == "anywhere" else ():
            key = where, np.dtype(dtype).name, name
            found[key] = max(found.get(key, 0.0), error)
    return found


def run(settings: Settings) -> Report:
    """Every kernel of every rotation."""
    found: dict[str, Errors] = {}
    for text in MODELS:
        progress(f"errors of {text}")
        found[text] = errors(text, settings.samples)
    progress()
    return report(found)


def report(found: Mapping[str, Errors]) -> Report:
    """A table for each kind of points and each precision."""
    kinds = list(dict.fromkeys(key[:2] for errors in found.values() for key in errors))
    return Report(
        title="Precision: largest error of every kernel against 50 digits",
        tables=tuple(_table(found, *kind) for kind in kinds),
        figures=(),
        notes=(
            "In eps of the type, relative to the largest entry of the matrix times what it is "
            "applied to.",
            "W⁻¹ of the rotation vector counts in eps n/|sin(n/2)|; where a sum of sines and "
            "cosines vanishes at the poles, in eps/|det W| (Davenport), or in eps (1 + the sizes "
            "of the angles) over the product of the singular values of W (four turns and more).",
            "Near poles: from 0.1 down to 1e-12 (float64) or 1e-4 (float32), two poles of each.",
            "Coordinates under a condition are rounded, which counts as error of the kernels.",
        ),
    )


def _table(found: Mapping[str, Errors], where: str, precision: str) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for text, errors_of in found.items():
        cells = [errors_of.get((where, precision, name)) for name in SYMBOLS]
        if any(cell is not None for cell in cells):
            rows.append((text, *cells))
    columns = (Column("rotation"), *(Column(short, ".1f") for short in SYMBOLS.values()))
    return Table(f"{where}, {precision}", columns, tuple(rows))
