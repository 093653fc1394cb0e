"""Quantities that a formula may be compared with: expressions, and numbers at a few points."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, reduce
from itertools import permutations, product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.evaluate import Floats, Unknown, evaluate
from rigidsym.errors import ExpressionError
from rigidsym.models.rotation import Turn
from rigidsym.motion import Motion, derive

Array = NDArray[np.float64]
Values = dict[sp.Expr, Any]  # of expressions, at all points
Names = Mapping[sp.Symbol, sp.Expr]  # what the names of a formula stand for

NEAR_POINTS, POINTS = 4, 20  # with all angles in the first quadrant, and in all
_TOLERANCE = 1e-9  # of numbers of order one, in double precision


def _points() -> Array:
    """Values of each component of each argument: of both signs, small, and of several turns.

    Points where a sine or a cosine is small are left out: rates grow there, and digits are lost.
    The last argument holds constants such as masses, which are positive.
    """
    random = np.random.default_rng(1775)
    near = random.uniform(0.2, 1.3, (5, 64, NEAR_POINTS))
    size = (5, 64, 8 * (POINTS - NEAR_POINTS))
    drawn = random.choice([0.5, np.pi, 20.0], size) * random.uniform(-1, 1, size)
    is_far_from_poles = np.abs(np.sin(2 * drawn)) > 0.15
    order = np.argsort(~is_far_from_poles, axis=-1, kind="stable")[..., : POINTS - NEAR_POINTS]
    far = np.take_along_axis(drawn, order, axis=-1)
    far[-1] = random.uniform(0.2, 1.3, far[-1].shape)
    return np.concatenate([near, far], axis=-1)


TABLE = _points()
_ROWS = {"q": 0, "q_dot": 1, "q_ddot": 2, "omega_space": 3, "omega_body": 3}
_FLOATS = Floats(np)

_AXES = [a + b + c for a, b, c in product("XYZ", repeat=3) if a != b != c]
_THREE = (*_AXES, *(axes.lower() for axes in _AXES))
_ONE = tuple(f"{a}(angle)" for a in "xyz")
_TWO = tuple(f"{a}(first) {b}(second)" for a, b in permutations("xyz", 2))
_VECTORS = ("gibbs_vector", "modified_rodrigues")
_QUATERNIONS = ("unit_quaternion",)
_ANY_QUATERNIONS = ("quaternion", *_QUATERNIONS)  # also divided by the square of the length
_SERIES = ("rotation_vector",)
_AXIS_ANGLE = ("axis_angle",)
_FRAMES = ("body", "space")
_OF_RATES = tuple(
    f"{name}_{frame}"
    for name in (
        *("rate_matrix", "inverse_rate_matrix"),
        *("angular_velocity", "rates_from_angular_velocity"),
    )
    for frame in _FRAMES
)
OPERATOR = "quaternion_rate_operator"  # A(Ω) with q̇ = A q
QUATERNION = "quaternion"  # of a product of turns
SHAPES: dict[tuple[int, int], tuple[str, ...]] = {  # of formulas, and what each may be
    (3, 3): ("rotation_matrix", *_OF_RATES[:4]),
    (3, 1): _OF_RATES[4:],
    (4, 1): (*_OF_RATES[6:], QUATERNION),
    (4, 3): _OF_RATES[2:4],
    (3, 4): _OF_RATES[:2],
    (4, 4): tuple(f"{OPERATOR}_{frame}" for frame in _FRAMES),
}


@dataclass(frozen=True, kw_only=True)
class KnownQuantity:
    """A quantity of a rotation."""

    motion: Motion
    rotation: str  # as it was asked for: "ZYX"
    quantity: str
    is_named: bool = False  # whether `rotation` says all about it
    arrangement: str = ""  # "transposed", "scalar last", "twice": how it is written

    @cached_property
    def matrix(self) -> sp.ImmutableMatrix:
        matrix = self._derived
        if "conjugated" in self.arrangement:
            matrix = sp.diag(1, -1, -1, -1) * matrix
        if "transposed" in self.arrangement:
            matrix = matrix.T
        if "scalar last" in self.arrangement:
            order = ([1, 2, 3, 0] if count == 4 else [*range(count)] for count in matrix.shape)
            matrix = matrix.extract(*order)
        factor = {"negative": -1, "twice": 2, "half": sp.Rational(1, 2)}.get(
            self.arrangement.rpartition(" ")[2]
        )
        return sp.ImmutableMatrix(matrix * (factor or 1))

    @cached_property
    def arrangements(self) -> tuple[KnownQuantity, ...]:
        """This quantity as it is, and in other ways in which texts write it."""
        words = [""]
        if self.quantity == "rotation_matrix":
            words.append("transposed (passive, the direction cosine matrix)")
        if 4 in self.matrix.shape:
            factors = ("", "twice", "half")[: 3 if self.matrix.rows == 3 else 2]
            if self.quantity == QUATERNION:
                factors = ("", "conjugated (passive)", "negative")
            parts = product(("", "scalar last"), factors)
            words = [", ".join(filter(None, each)) for each in parts]
        return tuple(replace(self, arrangement=each) if each else self for each in words)

    @cached_property
    def _derived(self) -> sp.ImmutableMatrix:
        if self.quantity == QUATERNION:
            return sp.ImmutableMatrix(reduce(quaternion, map(_half_turn, self.motion.model.turns)))
        if self.quantity.startswith(OPERATOR):
            frame = self.quantity.removeprefix(OPERATOR)
            rates = getattr(self.motion, f"rates_from_angular_velocity{frame}")
            return sp.ImmutableMatrix(rates.jacobian(self.motion.argument("q").symbols))
        return self.motion.spelled(self.motion.step(self.quantity).expression)

    @cached_property
    def points(self) -> Values:
        """Values of all inputs; coordinates and rates satisfy the conditions of the model."""
        found: Values = {}
        count = Counter[int]()
        for name, symbols in self.inputs.items():
            row = _ROWS.get(name, len(TABLE) - 1)
            for symbol in symbols:
                found[symbol] = TABLE[row, count[row]]
                count[row] += 1
        for condition in self.motion.model.constraints:
            self._satisfy(condition, found)
        return found

    def _satisfy(self, condition: sp.Expr, found: Values) -> None:
        """Scale the coordinates in a condition |v|² = 1, and take the rates along v away."""
        q = [s for s in self.inputs["q"] if condition.has(s)]
        length = np.sqrt(sum(found[s] ** 2 for s in q))
        found.update({s: found[s] / length for s in q})
        if "q_dot" in self.inputs:
            rates = [sp.diff(s, *s.args) for s in q]
            along = sum(found[s] * found[r] for s, r in zip(q, rates, strict=True))
            found.update({r: found[r] - along * found[s] for s, r in zip(q, rates, strict=True)})

    @cached_property
    def values(self) -> Array:
        """Of what is compared; (points, rows, columns)."""
        return evaluated(self.matrix, dict(self.points))

    @cached_property
    def inputs(self) -> dict[str, tuple[sp.Expr, ...]]:
        """The symbols of each argument, and constants such as lengths."""
        found = {argument.name: argument.symbols for argument in self.motion.arguments}
        known = {symbol for symbols in found.values() for symbol in symbols}
        constants = self.matrix.free_symbols - known - {s for q in known for s in q.args}
        return found | {"constants": tuple(sorted(constants, key=str))}

    @cached_property
    def names(self) -> dict[str, sp.Expr]:
        """The inputs by plain name."""
        arguments = self.motion.arguments
        names = {name: s for a in arguments for name, s in zip(a.names, a.symbols, strict=True)}
        return names | {s.name: s for s in self.inputs["constants"]}

    @property
    def coordinates(self) -> dict[str, sp.Expr]:
        """The coordinates by plain name."""
        q = self.inputs.get("q", ())
        return {name: symbol for name, symbol in self.names.items() if symbol in q}

    def readings(self, matrix: sp.MatrixBase) -> Iterator[Names]:
        """The possible meanings of the names in a formula."""
        return readings(matrix, self)

    def sibling(self, quantity: str) -> KnownQuantity:
        """Another quantity of the same rotation."""
        if self.is_named:
            return target(self.rotation, quantity)
        motion = derive(self.motion.model, quantity, body=self.motion.body)
        return KnownQuantity(motion=motion, rotation=self.rotation, quantity=quantity)

    @property
    def described(self) -> str:
        """The name, and how it is written."""
        return ", ".join(filter(None, (str(self), self.arrangement)))

    def __str__(self) -> str:
        return f"{self.quantity} of {self.rotation}"


@lru_cache(maxsize=512)
def target(rotation: str, quantity: str) -> KnownQuantity:
    """A quantity of a rotation by name; raises ModelError or QuantityError for unknown names."""
    of_rates = rotation in _THREE and quantity in _OF_RATES
    derived = quantity.replace(OPERATOR, "rates_from_angular_velocity")
    derived = "rotation_matrix" if quantity == QUATERNION else derived
    motion = _kinematics(rotation, _OF_RATES if of_rates else (derived,))
    return KnownQuantity(motion=motion, rotation=rotation, quantity=quantity, is_named=True)


@lru_cache(maxsize=256)
def _kinematics(rotation: str, quantities: tuple[str, ...]) -> Motion:
    return derive(rotation, quantities)


def quaternion(a: sp.MatrixBase, b: sp.MatrixBase) -> sp.Matrix:
    """The product a b of two quaternions, each a column with the scalar first."""
    scalar = a[0] * b[0] - a[1:, :].dot(b[1:, :])
    return sp.Matrix([scalar, *(a[0] * b[1:, :] + b[0] * a[1:, :] + a[1:, :].cross(b[1:, :]))])


def _half_turn(turn: Turn) -> sp.Matrix:
    return sp.Matrix(
        [sp.cos(turn.angle / 2), *(sp.sin(turn.angle / 2) * d for d in turn.direction)]
    )


def catalogue(matrix: sp.MatrixBase) -> Iterator[KnownQuantity]:
    """All quantities that a formula of this shape may be, plain ones first."""
    for quantity in SHAPES.get(matrix.shape, ()):
        yield from (target(rotation, quantity) for rotation in _rotations(matrix, quantity))


def _rotations(matrix: sp.MatrixBase, quantity: str) -> tuple[str, ...]:
    """The rotations whose quantity has as many names, and sines and cosines if this has."""
    turns, count = matrix.has(sp.sin, sp.cos, sp.tan), len(matrix.free_symbols)
    if quantity == QUATERNION:
        return {1: _ONE, 2: _TWO, 3: _THREE}.get(count, ()) if turns else ()
    if 4 in matrix.shape:
        return _QUATERNIONS
    if quantity == "rotation_matrix":
        angles = {1: _ONE, 2: _TWO, 3: _THREE}.get(count, _AXIS_ANGLE)
        parts = {3: _VECTORS, 4: (*_ANY_QUATERNIONS, *_VECTORS), 5: _ANY_QUATERNIONS}.get(count, ())
    elif matrix.shape == (3, 3):
        angles, parts = _THREE, _VECTORS[: 2 * (count in (3, 4))]
    else:
        angles, parts = (*_THREE, *_AXIS_ANGLE), (*_VECTORS, *_QUATERNIONS)
    series = _SERIES if matrix.has(sp.sqrt) or (turns and count >= 3) else ()
    return (*(angles if turns else parts), *series)


def evaluated(matrix: sp.MatrixBase, values: Values) -> Array:
    """A matrix at all points, (points, rows, columns); `values` remembers all parts."""
    try:
        with np.errstate(all="ignore"):
            parts = [evaluate(entry, _FLOATS, values) for entry in matrix]
    except Unknown as error:
        raise ExpressionError(f"{error.part} has no value here") from None
    entries = [np.broadcast_to(part, (POINTS,)) for part in parts]
    return np.stack(entries, axis=-1).reshape(POINTS, *matrix.shape)


def agreement(one: Array, other: Array) -> NDArray[np.bool_]:
    """Which entries agree at every point; (rows, columns)."""
    return np.asarray(_near(one, other).all(axis=0))


def agreeing_points(one: Array, other: Array) -> NDArray[np.bool_]:
    """The points at which all entries agree; (points,)."""
    return np.asarray(_near(one, other).all(axis=(1, 2)))


def _near(one: Array, other: Array) -> NDArray[np.bool_]:
    with np.errstate(all="ignore"):
        return np.asarray(np.abs(one - other) <= _TOLERANCE * np.maximum(1, np.abs(other)))


def is_reflection(matrix: sp.MatrixBase) -> bool:
    """Whether a 3x3 matrix is orthogonal with the determinant −1 at all points."""
    if matrix.shape != (3, 3):
        return False
    symbols = sorted(matrix.free_symbols, key=str)
    values = evaluated(matrix, dict(zip(symbols, TABLE[0], strict=False)))
    with np.errstate(all="ignore"):
        products = values @ values.transpose(0, 2, 1)
        is_orthogonal = bool((np.abs(products - np.eye(3)) <= _TOLERANCE).all())
        return is_orthogonal and bool((np.linalg.det(values) < 0).all())


# What the names in a formula stand for

_LENGTHS = ("n", "theta", "angle", "norm")
_RATE = re.compile(
    r"(?:d_?|dot_?)(?P<behind>\w+)|(?P<before>\w+?)_?(?:(?:dot|rates?|d)(?P<index>_?\d)?|p)"
)
_OMEGA = re.compile(
    r"(?:omega|Omega|w|W|gyro|g|rate|Omega_body|omega_(?:body|space))_?[xyz0-3]|[pqr]|[wW][pqr]"
)


def readings(matrix: sp.MatrixBase, goal: KnownQuantity) -> Iterator[Names]:
    """The possible meanings of the names: their own if all are known, else every assignment.

    If the rotation has a vector, n is the length of this vector or of all coordinates, as in notes,
    and so are other names that texts give to a length.
    """
    model = goal.motion.model
    indexed = {s.name.rstrip("123").rstrip("_") for s in matrix.free_symbols if s.name[-1] == "1"}
    lengths = {*_LENGTHS, *indexed} - {*"pqr"}  # sigma of sigma_1, but no body rate
    lengths = {_LENGTHS[0]} if model.constraints else lengths
    length = next((s for s in matrix.free_symbols if s.name in lengths), None)
    if length and model.vector and length.name not in goal.names:
        for names in readings(matrix.xreplace({length: sp.Integer(1)}), goal):
            for parts in dict.fromkeys((model.coordinates, model.vector)):
                yield {**names, length: sp.sqrt(sum(part**2 for part in parts))}
        return
    symbols = sorted(matrix.free_symbols, key=lambda s: _natural(s.name))
    own = {s: goal.names.get(s.name) or goal.names.get(f"{stem_of(s.name)}_dot") for s in symbols}
    if all(own.values()):
        yield {s: value for s, value in own.items() if value is not None}
        return
    arguments, inputs = goal.inputs, _inputs(goal)
    q = arguments.get("q", ())
    angles = {a for f in matrix.atoms(sp.sin, sp.cos, sp.tan) for a in f.free_symbols}
    omega = [s for s in symbols if _OMEGA.fullmatch(s.name) and s not in angles]
    omega = omega if {"omega_body", "omega_space"} & inputs else []
    left = [s for s in symbols if s not in omega]
    rates = {s: stem for s in left if (stem := stem_of(s.name)) and s not in angles}
    rates = rates or _of_arrays([s for s in left if s not in angles], angles)
    rates = rates if "q_dot" in inputs else {}
    stems = sorted({s.name for s in left if s not in rates} | {*rates.values()})
    if len(stems) > len(q) or len(omega) > 3:
        return
    velocity = next((arguments[a] for a in ("omega_body", "omega_space") if a in inputs), ())
    for order in permutations(q, len(stems)):
        of_stem = dict(zip(stems, order, strict=True))
        found: dict[sp.Symbol, sp.Expr] = {s: of_stem[s.name] for s in left if s.name in of_stem}
        found |= {s: sp.diff(of_stem[stem], *of_stem[stem].args) for s, stem in rates.items()}
        yield found | dict(zip(omega, velocity, strict=False))


def _of_arrays(others: Sequence[sp.Symbol], angles: set[sp.Symbol]) -> dict[sp.Symbol, str]:
    """e_1 by its rate u_1, if all angles are in one array and all other names in another."""
    arrays = [{s.name.rpartition("_")[0] for s in part} for part in (angles, others)]
    if any(len(array) != 1 or "" in array for array in arrays):
        return {}
    return {s: f"{min(arrays[0])}_{s.name.rpartition('_')[2]}" for s in others}


def _inputs(goal: KnownQuantity) -> set[str]:
    if goal.quantity == QUATERNION:
        return {"q"}
    if goal.quantity.startswith(OPERATOR):
        return {"q", "omega" + goal.quantity.removeprefix(OPERATOR)}
    return set(goal.motion.step(goal.quantity).quantity.inputs)


def stem_of(name: str) -> str:
    """phi of phi_dot, dphi, phidot, phi_rate, and q_0 of qd_0; "" for other names."""
    match = _RATE.fullmatch(name)
    return match["behind"] or match["before"] + (match["index"] or "") if match else ""


def _natural(name: str) -> tuple[object, ...]:
    return tuple(int(p) if p.isdigit() else p for p in re.split(r"(\d+)", name))
