"""Known quantities, with numbers at points in all quadrants: one table for `compare`.

Most are quantities of a derivation. The others, with quaternions as a = a₀ + **a**, and with
e = ±1 for a cyclic or anticyclic order of the axes i, j, k (l is the third axis if k = i):

    a b = a₀b₀ − **a**·**b** + a₀**b** + b₀**a** + **a** × **b**     product of quaternions
    q v q* = v + 2 w (u × v) + 2 u × (u × v)                         vector turned by q = w + u
    I dω/dt + ω × I ω = τ                                            Euler's equations
    I + m (d² 1 − d dᵀ)                                              parallel-axis theorem
    atan2(−e Rⱼₖ, Rₖₖ),  asin(e Rᵢₖ),  atan2(−e Rᵢⱼ, Rᵢᵢ)            angles about three axes
    atan2(Rⱼᵢ, −e Rₗᵢ),  acos(Rᵢᵢ),   atan2(Rᵢⱼ, e Rᵢₗ)             angles with k = i

Angles are compared as points of the unit circle. The sense in which an angle counts is a
convention that no formula can get wrong.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache, reduce
from itertools import permutations, product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.evaluate import Floats, Unknown, evaluate
from rigidsym.errors import ExpressionError
from rigidsym.motion import Motion, derive
from rigidsym.tools.compare.language import cross_matrix

Array = NDArray[Any]
Values = dict[sp.Expr, Any]  # of expressions, at all points
Names = Mapping[sp.Symbol, sp.Expr]  # of a formula, and what they mean

NEAR_POINTS, POINTS = 4, 20  # with all angles in the first quadrant, and in all
_TOLERANCE = 1e-9  # of numbers of order one, in double precision
_FLOATS = Floats(np)


def _points() -> Array:
    """Values of each component of each argument, in all quadrants and of several turns.

    They keep a distance of 0.2 from multiples of π/2: rates grow where a sine or a cosine is small,
    and digits are lost. The last argument holds constants such as masses, which are positive.
    """
    random = np.random.default_rng(1775)
    points = random.uniform(0.2, 1.3, (5, 64, POINTS))
    quadrants = random.integers(-6, 7, points.shape)
    quadrants[..., :NEAR_POINTS] = quadrants[-1] = 0
    return points + quadrants * np.pi / 2


TABLE = _points()
_ROWS = {"q": 0, "q_dot": 1, "q_ddot": 2, "omega_space": 3, "omega_body": 3}
_ROWS |= {"a": 0, "b": 1, "c": 2}  # vectors of laws

AXES = [a + b + c for a, b, c in product("XYZ", repeat=3) if a != b != c]
_THREE = (*AXES, *(axes.lower() for axes in AXES))
_SEQUENCES = {
    1: tuple(f"{a}(angle)" for a in "xyz"),
    2: tuple(f"{a}(first) {b}(second)" for a, b in permutations("xyz", 2)),
    3: _THREE,
}
_VECTORS = ("gibbs_vector", "modified_rodrigues")
_QUATERNIONS = ("quaternion", "unit_quaternion")  # also divided by the square of the length
_OF_RATES = tuple(
    f"{name}_{frame}"
    for name in (
        "rate_matrix",
        "inverse_rate_matrix",
        "angular_velocity",
        "rates_from_angular_velocity",
    )
    for frame in ("body", "space")
)
QUATERNION = "quaternion"  # of a product of turns
ANGLES = "euler_angles"  # from a rotation matrix or a quaternion
SHAPES: dict[tuple[int, int], tuple[str, ...]] = {  # of formulas, and what each may be
    (3, 3): ("rotation_matrix", *_OF_RATES[:4]),
    (3, 1): _OF_RATES[4:],
    (4, 1): (*_OF_RATES[6:], QUATERNION),
    (4, 3): _OF_RATES[2:4],
    (3, 4): _OF_RATES[:2],
}
PASSIVE = "transposed (passive, the direction cosine matrix)"
_LAST = [1, 2, 3, 0]
_WAYS: dict[str, Callable[[sp.Matrix], sp.Matrix]] = {  # of writing a quantity
    "": lambda m: m,
    "conjugated (passive)": lambda m: sp.diag(1, -1, -1, -1) * m,
    "negative": lambda m: -m,
    "twice": lambda m: 2 * m,
    "half": lambda m: m / 2,
    "scalar last": lambda m: m.extract(*(_LAST if n == 4 else [*range(n)] for n in m.shape)),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownQuantity:
    """A quantity of a rotation, or a law in vectors, in one of the ways in which texts write it."""

    quantity: str
    rotation: str = ""  # as it was asked for: "ZYX"; "" for a law
    arrangement: str = ""  # "transposed", "scalar last", "twice"
    matrix: sp.ImmutableMatrix
    motion: Motion  # in whose ring equality is decided
    inputs: Mapping[str, tuple[sp.Expr, ...]]  # the symbols of each argument
    uses: frozenset[str] = frozenset()  # the arguments on which a quantity of a rotation depends

    @property
    def points(self) -> Values:
        """Values of all inputs, and of all that was evaluated before."""
        conditions = self.motion.model.constraints if self.rotation else ()
        return _values_of(tuple(self.inputs.items()), conditions)

    @cached_property
    def values(self) -> Array:
        """Of what is compared; (points, rows, columns)."""
        return self.on_circle(evaluated(self.matrix, self.points))

    def on_circle(self, numbers: Array) -> Array:
        """Angles as points of the unit circle; other numbers as they are."""
        with np.errstate(all="ignore"):
            return np.exp(1j * numbers) if self.quantity == ANGLES else numbers

    @cached_property
    def names(self) -> dict[str, sp.Expr]:
        """The inputs by plain name."""
        arguments = self.motion.arguments if self.rotation else ()
        names = {name: s for a in arguments for name, s in zip(a.names, a.symbols, strict=True)}
        plain = (s for symbols in self.inputs.values() for s in symbols if s.is_Symbol)
        return names | {s.name: s for s in plain}

    @property
    def described(self) -> str:
        """The name, and how it is written."""
        return ", ".join(filter(None, (str(self), self.arrangement)))

    def __str__(self) -> str:
        return f"{self.quantity} of {self.rotation}" if self.rotation else self.quantity


def of_motion(motion: Motion, quantity: str, rotation: str) -> KnownQuantity:
    """A quantity of a derivation."""
    arguments = {argument.name: argument.symbols for argument in motion.arguments}
    if quantity == QUATERNION:
        turns = (_quaternion_of(turn.angle, turn.direction) for turn in motion.model.turns)
        matrix, names = reduce(quaternion_product, turns), {"q"}
    else:
        step = motion.step(quantity)
        matrix, names = motion.spelled(step.expression), set(step.quantity.inputs)
    symbols = {symbol for vector in arguments.values() for symbol in vector}
    constants = matrix.free_symbols - symbols - {s for q in symbols for s in q.args}
    return KnownQuantity(
        quantity=quantity,
        rotation=rotation,
        matrix=sp.ImmutableMatrix(matrix),
        motion=motion,
        inputs=arguments | {"constants": tuple(sorted(constants, key=str))},
        uses=frozenset(names),
    )


@lru_cache(maxsize=512)
def target(rotation: str, quantity: str) -> KnownQuantity:
    """A quantity of a rotation by name; raises ModelError or QuantityError for unknown names."""
    derived = "rotation_matrix" if quantity == QUATERNION else quantity
    of_rates = rotation in _THREE and quantity in _OF_RATES
    motion = _kinematics(rotation, _OF_RATES if of_rates else (derived,))
    return of_motion(motion, quantity, rotation)


@lru_cache(maxsize=256)
def _kinematics(rotation: str, quantities: tuple[str, ...]) -> Motion:
    return derive(rotation, quantities)


@lru_cache(maxsize=512)
def _written(rotation: str, quantity: str) -> tuple[KnownQuantity, ...]:
    """A quantity as it is, and in other ways in which texts write it."""
    goal = target(rotation, quantity)
    ways: dict[str, sp.Matrix] = {"": goal.matrix}
    if quantity == "rotation_matrix":
        other = ", or by the opposite angle" if len(goal.motion.model.turns) == 1 else ""
        ways[f"{PASSIVE}{other}"] = goal.matrix.T
    elif 4 in goal.matrix.shape:
        factors = ("", "twice", "half")[: 3 if goal.matrix.rows == 3 else 2]
        if quantity == QUATERNION:
            factors = ("", "conjugated (passive)", "negative")
        for last, factor in product(("", "scalar last"), factors):
            ways[", ".join(filter(None, (last, factor)))] = _WAYS[last](_WAYS[factor](goal.matrix))
    return tuple(
        replace(goal, arrangement=words, matrix=sp.ImmutableMatrix(m)) for words, m in ways.items()
    )


def catalogue(matrix: sp.MatrixBase) -> Iterator[KnownQuantity]:
    """All quantities that a formula may be, in all ways of writing them, plain ones first."""
    if are_angles(matrix):
        yield from _conventions()
        return
    for quantity in SHAPES.get(matrix.shape, ()):
        for rotation in _rotations(matrix, quantity):
            yield from _written(rotation, quantity)
    yield from (law for law in _laws() if law.matrix.shape == matrix.shape)


def _rotations(matrix: sp.MatrixBase, quantity: str) -> tuple[str, ...]:
    """The rotations whose quantity has as many names, and sines and cosines if this has."""
    turns, count = matrix.has(sp.sin, sp.cos, sp.tan), len(matrix.free_symbols)
    if quantity == QUATERNION:
        return _SEQUENCES.get(count, ()) if turns else ()
    if 4 in matrix.shape:
        return _QUATERNIONS[1:]
    if quantity == "rotation_matrix":
        angles = _SEQUENCES.get(count, ("axis_angle",))
        parts = {3: _VECTORS, 4: (*_QUATERNIONS, *_VECTORS), 5: _QUATERNIONS}.get(count, ())
    elif matrix.shape == (3, 3):
        angles, parts = _THREE, _VECTORS[: 2 * (count in (3, 4))]
    else:
        angles, parts = (*_THREE, "axis_angle"), (*_VECTORS, "unit_quaternion")
    series = ("rotation_vector",) if matrix.has(sp.sqrt) or (turns and count >= 3) else ()
    return (*(angles if turns else parts), *series)


# Laws in vectors


def quaternion_product(a: sp.MatrixBase, b: sp.MatrixBase) -> sp.Matrix:
    """a b, each a column with the scalar first."""
    scalar = a[0] * b[0] - a[1:, :].dot(b[1:, :])
    return sp.Matrix([scalar, *(a[0] * b[1:, :] + b[0] * a[1:, :] + a[1:, :].cross(b[1:, :]))])


def _quaternion_of(angle: sp.Expr, direction: Any) -> sp.Matrix:
    return sp.Matrix([sp.cos(angle / 2), *(sp.sin(angle / 2) * d for d in direction)])


Ways = dict[str, sp.Matrix]


def _quaternion_products(a: sp.Matrix, b: sp.Matrix) -> Ways:
    conjugate = _WAYS["conjugated (passive)"]
    ways = {
        "": quaternion_product(a, b),
        "the first conjugated": quaternion_product(conjugate(a), b),
        "the second conjugated": quaternion_product(a, conjugate(b)),
    }
    ways |= {f"{way}, negative".lstrip(", "): -m for way, m in ways.items()}  # the same rotation
    return ways | {f"{way}, scalar last".lstrip(", "): m[_LAST, :] for way, m in ways.items()}


def _turned_vectors(q: sp.Matrix, v: sp.Matrix) -> Ways:
    cross, ways = cross_matrix(q[1:, :]), {}
    for words, sign in (("", 1), ("by the inverse", -1)):
        double = 2 * sign * q[0] * cross * v + 2 * cross * cross * v
        ways[words] = v + double
        ways[f"{words}, times |q|²".lstrip(", ")] = q.dot(q) * v + double
    return ways


def _parallel_axes(mass: sp.Matrix, d: sp.Matrix, tensor: sp.Matrix) -> Ways:
    xx, xy, xz, yy, yz, zz = tensor
    matrix = sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    added = mass[0] * (d.dot(d) * sp.eye(3) - d * d.T)
    return {"": matrix + added, "to the centre of mass": matrix - added}


_LAWS: dict[str, tuple[tuple[int, ...], Callable[..., Ways]]] = {
    "quaternion_product": ((4, 4), _quaternion_products),
    "turned_vector": ((4, 3), _turned_vectors),
    "euler_equations_acceleration": (
        (3, 3, 3),
        lambda w, i, t: {"": sp.diag(*i).inv() * (t - w.cross(sp.diag(*i) * w))},
    ),
    "euler_equations_torque": (
        (3, 3, 3),
        lambda w, i, a: {"": sp.diag(*i) * a + w.cross(sp.diag(*i) * w)},
    ),
    "parallel_axis_theorem": ((1, 3, 6), _parallel_axes),
}  # entries of each vector, and the value for each way of writing it


@cache
def _laws() -> tuple[KnownQuantity, ...]:
    motion = target("quaternion", "rotation_matrix").motion  # a ring without conditions
    laws = []
    for name, (sizes, value) in _LAWS.items():
        letters = zip("abc", sizes, strict=False)
        vectors = {c: sp.symbols(f"{c}_:{size}", real=True) for c, size in letters}
        laws += [
            KnownQuantity(
                quantity=name,
                arrangement=words,
                matrix=sp.ImmutableMatrix(matrix),
                motion=motion,
                inputs=vectors,
            )
            for words, matrix in value(*map(sp.Matrix, vectors.values())).items()
        ]
    return tuple(laws)


# Euler angles from a rotation matrix or a quaternion


def are_angles(formula: sp.MatrixBase) -> bool:
    """Whether each of three entries is an angle by an inverse function."""
    inverse = (sp.atan2, sp.asin, sp.acos, sp.atan)
    return formula.shape == (3, 1) and all(entry.has(*inverse) for entry in formula)


@cache
def _conventions() -> tuple[KnownQuantity, ...]:
    """The angles of twelve orders of axes, in any order and sense, the plain ones first."""
    motion = target("unit_quaternion", "rotation_matrix").motion
    orders = [(0, 1, 2), (2, 1, 0), *((0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1))]
    inputs, rotation = {"q": motion.argument("q").symbols}, motion.rotation_matrix
    conventions = []
    all_senses = sorted(product((1, -1), repeat=3), key=lambda s: s.count(-1))
    for senses, is_transposed, order, axes in product(all_senses, (False, True), orders, AXES):
        angles = _angles(axes, rotation, is_transposed=is_transposed)
        words = ["transposed (passive)"] if is_transposed else []
        if order not in orders[:2]:
            words.append(f"the angles in the order {', '.join(str(k + 1) for k in order)}")
        if opposite := [str(k + 1) for k, sense in enumerate(senses) if sense < 0]:
            words.append(f"with the opposite sense of angle {' and '.join(opposite)}")
        entries = [sense * angles[k] for sense, k in zip(senses, order, strict=True)]
        conventions.append(
            KnownQuantity(
                quantity=ANGLES,
                rotation=axes[::-1].lower() if order == orders[1] else axes,
                arrangement=", ".join(words),
                matrix=sp.ImmutableMatrix(entries),
                motion=motion,
                inputs=inputs,
            )
        )
    return tuple(conventions)


@cache
def _angles(axes: str, matrix: sp.ImmutableMatrix, *, is_transposed: bool) -> tuple[sp.Expr, ...]:
    r = matrix.T if is_transposed else matrix
    i, j, k = map("XYZ".index, axes)
    other = 3 - i - j
    # e is the sign of the permutation of the axes; for k = i, `other` is the axis that no turn is
    # about.
    e = 1 if (j - i) % 3 == 1 else -1
    if i == k:
        first, last = sp.atan2(r[j, i], -e * r[other, i]), sp.atan2(r[i, j], e * r[i, other])
        return first, sp.acos(r[i, i]), last
    first, last = sp.atan2(-e * r[j, k], r[k, k]), sp.atan2(-e * r[i, j], r[i, i])
    return first, sp.asin(e * r[i, k]), last


# Names in a formula

_RATE = re.compile(
    r"(?:d_?|dot_?)(?P<behind>\w+)|(?P<before>\w+?)_?(?:(?:dot|rates?|d)(?P<index>_?\d)?|p)"
)
_OMEGA = re.compile(
    r"(?:omega|Omega|w|W|gyro|g|rate|Omega_body|omega_(?:body|space))_?[xyz0-3]|[pqr]|[wW][pqr]"
)


def are_body_rates(formula: sp.MatrixBase) -> bool:
    """Whether three entries are components of an angular velocity, and nothing else."""
    names = {entry.name for entry in formula if entry.is_Symbol and _OMEGA.fullmatch(entry.name)}
    return formula.shape == (3, 1) and len(names) == 3


_VECTOR_NAMES = (
    re.compile(r"(?P<stem>.*?)_?(?P<part>[xyz]{2}|[0-3]_?[0-3]|[wxyzWXYZ0-4]|)"),
    re.compile(r"(?P<stem>.+)_(?P<part>[wxyzWXYZ0-4])"),  # b1_0
    re.compile(r"(?P<part>[wxyz])_?(?P<stem>\d|[a-z]?)"),  # w1, x1, y1, z1
)
_ELEMENTS = (  # of R
    re.compile(r"(?P<stem>.*?)_?(?P<row>[abc])_(?P<column>[xyz])"),  # Matrix3 of ArduPilot
    re.compile(r"(?P<stem>.*?)_?(?P<row>[0-3])_?(?P<column>[0-3])"),
)
_FLAT = {9: ([*range(9)], False), 16: ([0, 1, 2, 4, 5, 6, 8, 9, 10], True)}  # places, by columns


def readings(matrix: sp.MatrixBase, goal: KnownQuantity, *, is_asked: bool) -> Iterator[Names]:
    """The possible meanings of the names in a formula.

    If the quantity `is_asked` for, and all names are those of its inputs, no other is possible.
    """
    if goal.quantity == ANGLES:
        yield from _of_vectors(matrix, [goal.inputs["q"]])
        yield from _of_entries(matrix, goal.motion.rotation_matrix)
        return
    if not goal.rotation:
        yield from _of_vectors(matrix, [*goal.inputs.values()])
        return
    names = [
        goal.names.get(s.name) or goal.names.get(f"{stem_of(s.name)}_dot")
        for s in matrix.free_symbols
    ]
    if None not in names:
        yield dict(zip(matrix.free_symbols, names, strict=True))
    if None in names or not is_asked:
        yield from _of_rotation(matrix, goal)


def _of_rotation(matrix: sp.MatrixBase, goal: KnownQuantity) -> Iterator[Names]:
    """Every assignment of names to coordinates, their rates and angular velocities."""
    # q2 comes before q10
    symbols = sorted(
        matrix.free_symbols,
        key=lambda s: [int(p) if p.isdigit() else p for p in re.split(r"(\d+)", s.name)],
    )
    q = goal.inputs.get("q", ())
    velocity = next(
        (goal.inputs[name] for name in goal.inputs if name[:5] == "omega" and name in goal.uses), ()
    )
    angles = {a for f in matrix.atoms(sp.sin, sp.cos, sp.tan) for a in f.free_symbols}
    omega = [s for s in symbols if velocity and _OMEGA.fullmatch(s.name) and s not in angles]
    others = [s for s in symbols if s not in omega]
    rates: dict[sp.Symbol, str] = {}
    if "q_dot" in goal.uses:
        plain = [s for s in others if s not in angles]
        rates = {s: stem_of(s.name) for s in plain if stem_of(s.name)} or _of_arrays(plain, angles)
    stems = sorted({s.name for s in others if s not in rates} | {*rates.values()})
    if len(stems) > len(q) or len(omega) > 3:
        return
    if velocity and not omega and len(symbols) == len(q) + 3:  # vel[0] beside quat[0]
        yield from _of_vectors(matrix, [q, velocity])
    is_array = len({stem.rstrip("0123").rstrip("_") for stem in stems}) == 1
    is_array &= all(stem[-1].isdigit() for stem in stems) and len(stems) == len(q) == 4
    orders: Iterator[tuple[sp.Expr, ...]] = permutations(q, len(stems))
    if is_array:  # of a quaternion in an array, the scalar is the first or the last entry
        orders = iter([q, (*q[1:], q[0])])
    for order in orders:
        of_stem = dict(zip(stems, order, strict=True))
        meant: dict[sp.Symbol, sp.Expr] = {s: of_stem[s.name] for s in others if s.name in of_stem}
        meant |= {s: sp.diff(of_stem[stem], *of_stem[stem].args) for s, stem in rates.items()}
        yield meant | dict(zip(omega, velocity, strict=False))


def _of_arrays(others: Sequence[sp.Symbol], angles: set[sp.Symbol]) -> dict[sp.Symbol, str]:
    """e_1 by its rate u_1, if all angles are in one array and all other names in another."""
    arrays = [{s.name.rpartition("_")[0] for s in part} for part in (angles, others)]
    if any(len(array) != 1 or "" in array for array in arrays):
        return {}
    return {s: f"{min(arrays[0])}_{s.name.rpartition('_')[2]}" for s in others}


def stem_of(name: str) -> str:
    """phi of phi_dot, dphi, phidot, phi_rate, and q_0 of qd_0; "" for other names."""
    match = _RATE.fullmatch(name)
    return match["behind"] or match["before"] + (match["index"] or "") if match else ""


def _of_vectors(matrix: sp.MatrixBase, wanted: Sequence[tuple[sp.Expr, ...]]) -> Iterator[Names]:
    """Every assignment of vectors of the formula to those of a law.

    Names with a common stem are a vector, and so are p, q, r; any other name is a number. Of a
    quaternion in an array, the scalar may be the first or the last entry.
    """
    sizes = [len(vector) for vector in wanted]
    for pattern in _VECTOR_NAMES:
        groups: dict[str, list[tuple[str, sp.Symbol]]] = {}
        for symbol in sorted(matrix.free_symbols, key=str):
            match = pattern.fullmatch(symbol.name)
            stem, part = (match["stem"], match["part"].lower()) if match else (symbol.name, "")
            if symbol.name in ("p", "q", "r"):
                stem, part = "p, q, r", symbol.name
            groups.setdefault(stem if part else symbol.name, []).append((part, symbol))
        three = next((g for g in groups.values() if [part for part, _ in g] == [*"xyz"]), None)
        if three and len(groups.get("w", ())) == 1:  # this.x beside w
            three += groups.pop("w")
        vectors = [
            tuple(s for _, s in sorted(group, key=lambda each: (each[0] != "w", each[0])))
            for group in groups.values()
        ]
        for order in permutations(vectors) if len(vectors) == len(sizes) else ():
            if [len(vector) for vector in order] == sizes:
                for parts in product(*map(_scalar_first, order)):
                    yield dict(zip(sum(parts, ()), sum(wanted, ()), strict=True))


def _scalar_first(vector: tuple[sp.Symbol, ...]) -> Iterator[tuple[sp.Symbol, ...]]:
    yield vector
    if len(vector) == 4 and vector[0].name[-1].isdigit():
        yield (vector[3], *vector[:3])


def _of_entries(matrix: sp.MatrixBase, rotation: sp.MatrixBase) -> Iterator[Names]:
    """Names as entries of R: m00, m_1_1, a_x, or m_8 of a flat array."""
    symbols = sorted(matrix.free_symbols, key=str)
    for pattern, words in zip(_ELEMENTS, (("abc", "xyz"), ("0123", "0123")), strict=True):
        matches = [match for s in symbols if (match := pattern.fullmatch(s.name))]
        if len(matches) < len(symbols) or len({match["stem"] for match in matches}) != 1:
            continue
        places = [(words[0].index(m["row"]), words[1].index(m["column"])) for m in matches]
        for first in (0, 1):
            grid = [(i - first, j - first) for i, j in places]
            if all(0 <= index < 3 for place in grid for index in place):
                yield {s: rotation[place] for s, place in zip(symbols, grid, strict=True)}
    flat = [match for s in symbols if (match := re.fullmatch(r"(.*?)_(\d+)", s.name))]
    numbers = [int(match[2]) for match in flat]
    if len(flat) == len(symbols) and len({match[1] for match in flat}) == 1:
        for entries, is_by_columns in _FLAT.values():
            if set(numbers) <= set(entries):
                turned = rotation.T if is_by_columns else rotation
                yield {s: turned[entries.index(n)] for s, n in zip(symbols, numbers, strict=True)}
                break


# Numbers


@lru_cache(maxsize=512)
def _values_of(
    inputs: tuple[tuple[str, tuple[sp.Expr, ...]], ...], conditions: tuple[sp.Expr, ...]
) -> Values:
    """Values of the inputs; coordinates with a condition |v|² = 1, and their rates, satisfy it."""
    values: Values = {}
    count = Counter[int]()
    for name, symbols in inputs:
        row = _ROWS.get(name, len(TABLE) - 1)
        for symbol in symbols:
            values[symbol] = TABLE[row, count[row]]
            count[row] += 1
    for condition in conditions:
        q = [s for s in dict(inputs)["q"] if condition.has(s)]
        # q is scaled to unit length, and q̇ loses its part along q, since q·q̇ = 0 follows from
        # |q|² = 1.
        length = np.sqrt(sum(values[s] ** 2 for s in q))
        values |= {s: values[s] / length for s in q}
        if "q_dot" in dict(inputs):
            rates = [sp.diff(s, *s.args) for s in q]
            along = sum(values[s] * values[r] for s, r in zip(q, rates, strict=True))
            values |= {r: values[r] - along * values[s] for s, r in zip(q, rates, strict=True)}
    return values


def evaluated(matrix: sp.MatrixBase, values: Values) -> Array:
    """A matrix at all points, (points, rows, columns); `values` remembers all parts."""
    try:
        with np.errstate(all="ignore"):
            parts = [evaluate(entry, _FLOATS, values) for entry in matrix]
    except Unknown as error:
        raise ExpressionError(f"{error.part} has no value here") from None
    entries = [np.broadcast_to(part, (POINTS,)) for part in parts]
    return np.stack(entries, axis=-1).reshape(POINTS, *matrix.shape)


def near(one: Array, other: Array) -> NDArray[np.bool_]:
    """Whether numbers are equal within rounding errors."""
    with np.errstate(all="ignore"):
        # The error is absolute for small numbers: entries that are zero by cancellation have no
        # digits.
        return np.asarray(np.abs(one - other) <= _TOLERANCE * np.maximum(1, np.abs(other)))


def is_orthogonal(matrix: sp.MatrixBase, sign: int) -> bool:
    """Whether a 3x3 matrix is orthogonal at all points: a rotation, or with −1 a reflection."""
    if matrix.shape != (3, 3):
        return False
    symbols = sorted(matrix.free_symbols, key=str)
    values = evaluated(matrix, dict(zip(symbols, TABLE[0], strict=False)))
    with np.errstate(all="ignore"):
        is_orthogonal = near(values @ values.transpose(0, 2, 1), np.eye(3)).all()
        return bool(is_orthogonal and (sign * np.linalg.det(values) > 0).all())
