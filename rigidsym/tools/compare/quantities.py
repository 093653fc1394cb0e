"""Known quantities, with numbers at points in all quadrants: one table for `compare`.

Most are quantities of a derivation. The others, with quaternions as a = a₀ + **a**, and with
e = ±1 for a cyclic or anticyclic order of the axes i, j, k (l is the third axis if k = i):

    a b = a₀b₀ − **a**·**b** + a₀**b** + b₀**a** + **a** × **b**     product of quaternions
    q v q* = v + 2 w (u × v) + 2 u × (u × v)                         vector rotated by q = w + u
    I dω/dt + ω × I ω = τ                                            Euler's equations
    I + m (d² 1 − d dᵀ)                                              parallel-axis theorem
    atan2(−e Rⱼₖ, Rₖₖ),  asin(e Rᵢₖ),  atan2(−e Rᵢⱼ, Rᵢᵢ)            angles about three axes
    atan2(Rⱼᵢ, −e Rₗᵢ),  acos(Rᵢᵢ),   atan2(Rᵢⱼ, e Rᵢₗ)             angles with k = i

Angles are compared as points of the unit circle. The sense in which an angle counts is a
convention that no formula can get wrong.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache, reduce
from itertools import chain, permutations, product, starmap
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.core.function import AppliedUndef

from rigidsym.algebra.evaluate import Floats, Unknown, evaluate
from rigidsym.errors import ExpressionError
from rigidsym.mechanics.body import BodyValues
from rigidsym.mechanics.conversions.function import half_turn, outer_product, product as product_of
from rigidsym.models.rotation import rotation_of
from rigidsym.motion import Motion, derive
from rigidsym.tools.compare.syntax import RULES, SHAPES, WAYS_OF, limits, patterns

Array = NDArray[Any]
Values = dict[sp.Expr, Any]  # of expressions, at all points
Names = Mapping[sp.Symbol, sp.Expr]  # of a formula, and what they mean

NEAR_POINTS, POINTS = 4, 20  # with all angles in the first quadrant, and in all
_FLOATS = Floats(np)


# Values of each component of each argument, in all quadrants and of several turns. They keep a
# distance of 0.2 from multiples of π/2: rates grow where a sine or a cosine is small, and digits
# are lost. The last argument holds constants such as masses, which are positive.
_random = np.random.default_rng(1775)
TABLE: Array = _random.uniform(0.2, 1.3, (5, 64, POINTS))
_quadrants = _random.integers(-6, 7, TABLE.shape)
_quadrants[..., :NEAR_POINTS] = _quadrants[-1] = 0
TABLE += _quadrants * np.pi / 2
_THREE = tuple(a + b + c for s in ("XYZ", "xyz") for a, b, c in product(s, repeat=3) if a != b != c)
_SEQUENCES = {2: tuple(f"{a}(first) {b}(second)" for a, b in permutations("xyz", 2)), 3: _THREE}
_SEQUENCES[1] = tuple(f"{a}(angle)" for a in "xyz")
_OF_RATES = (*SHAPES[3, 3][1:], *SHAPES[3, 1])
QUATERNION = "quaternion"  # of turns, of an axis and an angle, or of a matrix
OF_MATRIX = "a rotation matrix"  # in place of the name of a rotation
OF_VECTORS = ("axis_angle", "rotation_vector", OF_MATRIX)
ANGLES = "euler_angles"  # from a rotation matrix or a quaternion
INVERSE = (sp.atan2, sp.asin, sp.acos, sp.atan)
OF_DIRECTIONS = ("rotation_matrix", QUATERNION, ANGLES)  # not changed by the length of a vector


# Ways of writing a quantity: changes of its matrix, in the vectors of its inputs

Way = Callable[..., sp.Matrix]
_NONE = sp.zeros(3, 1)
# Dummies, since a program may have the names R_1_1 or a_0 for something else
_ENTRIES = sp.Matrix(3, 3, sp.symbols("R_1:4_1:4", real=True, cls=sp.Dummy))
_CONJUGATE = sp.diag(1, -1, -1, -1)


def _opposite(vector: int, first: int, end: int) -> Way:
    """The way with the other sign of some entries of an input."""
    return lambda m, *inputs: m.xreplace({s: -s for s in inputs[vector][first:end]})


def _times(*factors: Any) -> Way:
    """The way with entries times one factor, or each row times its own."""
    return lambda m, *_: sp.diag(*map(sp.Rational, factors * (m.rows // len(factors)))) * m


def _in_order(*order: int) -> Way:
    """The way with rows, and as many columns, in another order."""
    return lambda m, *_: m.extract(*(order if n == len(order) else range(n) for n in m.shape))


def _of_conjugate(matrix: sp.Matrix, q: Sequence[sp.Expr], *_: Sequence[sp.Expr]) -> sp.Matrix:
    """Of q*, whose rates are (q̇)*."""
    matrix = _opposite(0, 1, 4)(matrix, q)
    return _CONJUGATE * matrix if matrix.rows == 4 else matrix * _CONJUGATE


def _surplus(q: Sequence[sp.Expr], v: Sequence[sp.Expr]) -> sp.Matrix:
    return (sum(x**2 for x in q) - 1) * sp.Matrix(v)


# by name; `nodes.toml` has the words for them, and says which ways of which quantities there are
_WAYS: dict[str, Way] = {
    "": lambda m, *_: m,
    "transposed": lambda m, *_: m.T,
    "transposed_operator": lambda m, *_: m.T,
    "other_side": lambda m, *_: _CONJUGATE * m.T * _CONJUGATE,
    "of_the_conjugate": _of_conjugate,
    "twice_the_angles": lambda m, q: m.xreplace({a: 2 * a for a in q[3:] or q}),
    "over_the_square": lambda m, _, b: m / sum(x**2 for x in b),
    "times_square": lambda m, *vectors: m + _surplus(*vectors),
    "of_unit_quaternion": lambda m, *vectors: m + 2 * _surplus(*vectors),
    "of_any_length": lambda m, q, v: (m + _surplus(q, v)) / sum(x**2 for x in q),
    "second_solution": lambda m, *_: sp.Matrix(
        [m[0] + sp.pi, -m[1] if m.has(sp.acos) else sp.pi - m[1], m[2] + sp.pi]
    ),
    **{way: _times(*factors) for way, factors in RULES["factors"].items()},
    **{way: _opposite(*place) for way, place in RULES["opposites"].items()},
    **{way: _in_order(*order) for way, order in RULES["orders"].items()},
}


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownQuantity:
    """A quantity of a rotation, or a law in vectors, in one of the ways in which texts write it."""

    quantity: str
    rotation: str = ""  # as it was asked for: "ZYX"; "" for a law
    ways: tuple[str, ...] = ()  # in which it is written: "transposed", "scalar_last", "twice"
    matrix: sp.ImmutableMatrix
    motion: Motion  # in whose ring equality is decided
    inputs: Mapping[str, tuple[sp.Expr, ...]]  # the symbols of each argument that it depends on
    has_own_names: bool = True  # False if the angles may have our names in another order

    @property
    def points(self) -> Values:
        """Values of all inputs, of the entries of R, and of all that was evaluated before."""
        conditions = self.motion.model.constraints if self.rotation else ()
        values = _values_of(tuple(self.inputs.items()), conditions)
        if self.rotation == OF_MATRIX and _ENTRIES[0] not in values:
            values |= named(dict(zip(_ENTRIES, self.motion.rotation_matrix, strict=True)), values)
        return values

    @cached_property
    def values(self) -> Array:
        """Of what is compared; (points, rows, columns)."""
        return self.numbers(self.matrix, self.points)

    def numbers(self, matrix: sp.MatrixBase, values: Values) -> Array:
        """Of a matrix; angles as points of the unit circle."""
        numbers = evaluated(matrix, values)
        with np.errstate(all="ignore"):
            return np.exp(1j * numbers) if self.quantity == ANGLES else numbers

    @cached_property
    def names(self) -> dict[str, sp.Expr]:
        """The inputs by plain name."""
        used = (a for a in self.motion.arguments if self.rotation and a.name in self.inputs)
        names = {name: s for a in used for name, s in zip(a.names, a.symbols, strict=True)}
        return names | {s.name: s for vector in self.inputs.values() for s in vector if s.is_Symbol}

    @property
    def coordinates(self) -> dict[str, str | None]:
        """The axis of the turn by each angle; None for a coordinate that is no angle of a turn."""
        turns, q = {t.angle: t.axis for t in self.motion.model.turns}, self.inputs.get("q", ())
        return {name: turns.get(s) for name, s in self.names.items() if s in q}

    @property
    def is_numeric(self) -> bool:
        """Whether it is no expression of a ring: an angle or a root of entries of R."""
        return self.quantity == ANGLES or self.rotation == OF_MATRIX

    @property
    def axes(self) -> str:
        """Those of the turns, as in "z y x"."""
        return " ".join(turn.axis for turn in self.motion.model.turns)

    def __str__(self) -> str:
        return f"{self.quantity} of {self.rotation}" if self.rotation else self.quantity

    def written(self, ways: Sequence[str]) -> list[KnownQuantity]:
        """The quantity in each combination of ways, one of each group, as it is first."""
        inputs, goals = tuple(self.inputs.values()), []
        for names in product(*(["", *group.split()] for group in ways)):
            matrix = sp.Matrix(self.matrix)
            for name in names:
                matrix = _WAYS[name](matrix, *inputs)
            own = (*self.ways, *filter(None, names))
            goals.append(replace(self, ways=own, matrix=sp.ImmutableMatrix(matrix)))
        return goals

    def in_orders(self) -> list[KnownQuantity]:
        """The quantity, also with the rates backwards if nobody chose the names of the angles.

        ZYX is xyz with the angles in the other order.
        """
        has_order = self.quantity in _OF_RATES and not self.quantity.startswith("angular")
        if not has_order or self.has_own_names:
            return [self]
        step = 1 if self.quantity.startswith("rate_matrix") else -1
        matrix = self.matrix[::step, ::-step]
        return [self, replace(self, ways=(*self.ways, "rates_321"), matrix=matrix)]


Family = tuple[KnownQuantity, ...]  # of the same inputs and shape, compared in one step


def of_motion(motion: Motion, quantity: str, rotation: str) -> KnownQuantity:
    """A quantity of a derivation."""
    if quantity == QUATERNION:
        q = motion.model.coordinates
        length = sp.sqrt(sum(x**2 for x in q))
        axis = (q[:3], q[3]) if q[3:] else (tuple(x / length for x in q), length)
        turns = [(turn.direction, turn.angle) for turn in motion.model.turns] or [axis]
        matrix, uses = sp.Matrix(reduce(product_of, starmap(half_turn, turns))), tuple("q")
    else:
        step = motion.step(quantity)
        matrix, uses = motion.spelled(step.expression), step.quantity.inputs
    arguments = {argument.name: argument.symbols for argument in motion.arguments}
    symbols = {symbol for vector in arguments.values() for symbol in vector}
    constants = matrix.free_symbols - symbols - {s for q in symbols for s in q.args}
    inputs = {name: arguments[name] for name in arguments if name in uses}
    inputs |= {"constants": tuple(sorted(constants, key=str))} if constants else {}
    own = sp.ImmutableMatrix(matrix)
    return KnownQuantity(
        quantity=quantity, rotation=rotation, matrix=own, motion=motion, inputs=inputs
    )


_kinematics = lru_cache(maxsize=256)(derive)


@lru_cache(maxsize=512)
def target(rotation: str, quantity: str) -> KnownQuantity:
    """A quantity of a rotation by name; raises ModelError or QuantityError for unknown names."""
    derived = "rotation_matrix" if quantity == QUATERNION else quantity
    of_rates = rotation in _THREE and quantity in _OF_RATES
    motion = _kinematics(rotation, _OF_RATES if of_rates else (derived,))
    goal = of_motion(motion, quantity, rotation)
    # ZYX names no angles, and those of roll, pitch and yaw often have our names in another order.
    # In proper Euler angles, such as ZXZ, exchanged names are a mistake.
    is_of_three_axes = len(rotation) == len({*rotation}) == 3
    return replace(goal, has_own_names=not is_of_three_axes)


def families(formula: sp.MatrixBase) -> Iterator[Family]:
    """All quantities that a formula may be, in all ways of writing them, plain ones first."""
    if are_angles(formula):
        yield _of_angles()
        return
    if formula.shape == (4, 1) and any(abs(p.exp) == sp.S.Half for p in formula.atoms(sp.Pow)):
        yield _of_matrix()
    shape, count = formula.shape, min(len(formula.free_symbols), len(_SEQUENCES) + 1)
    yield from (law for law in _laws() if law[0].matrix.shape == shape)
    for quantity in SHAPES.get(shape, ()):
        yield from _of_quantity(quantity, shape, formula.has(sp.sin, sp.cos, sp.tan), count)


@lru_cache(maxsize=64)
def _of_quantity(
    quantity: str, shape: tuple[int, int], has_turns: bool, count: int
) -> tuple[Family, ...]:
    # Half an angular velocity would be the vector part of any product of quaternions.
    scaled = WAYS_OF["vector_rates" if shape == (3, 1) else "rates"] * (not has_turns)
    of_rates = WAYS_OF["quaternion_rates"] if 4 in shape else scaled
    is_rates = quantity.startswith("rates_from") and shape == (3, 1)
    ways = WAYS_OF.get(quantity, of_rates + WAYS_OF[ANGLES][-1:] * is_rates)
    same_inputs: dict[Any, list[list[KnownQuantity]]] = {}
    for rotation in _rotations(quantity, shape, has_turns, count):
        goal = target(rotation, quantity)
        if goal.matrix.shape == shape:
            key = (*goal.inputs.items(), goal.motion.model.constraints)
            same_inputs.setdefault(key, []).append(goal.written(ways))
    return tuple(map(_family, same_inputs.values()))


def _family(written: Sequence[Sequence[KnownQuantity]]) -> Family:
    """The plain goals of all rotations come first, then those of each other way."""
    return tuple(chain.from_iterable(zip(*written, strict=True)))


def _rotations(
    quantity: str, shape: tuple[int, int], has_turns: bool, count: int
) -> tuple[str, ...]:
    """The rotations whose quantity has as many names, and sines and cosines if this has."""
    is_matrix = quantity == "rotation_matrix"
    if 4 in shape and quantity != QUATERNION:
        return ("unit_quaternion",)
    if not has_turns:
        others = ("quaternion", "unit_quaternion")[1 - is_matrix :]
        return ("gibbs_vector", "modified_rodrigues", *others) * (quantity != QUATERNION)
    orders = _SEQUENCES.get(count, ()) if is_matrix or quantity == QUATERNION else _THREE
    return (*orders, *OF_VECTORS[: 2 * (count > 2)])


# Laws in vectors


def _product(*factors: sp.MatrixBase) -> sp.Matrix:
    """a b, each a column with the scalar first, or a vector."""
    return sp.Matrix(product_of(*([0] * (4 - len(each)) + [*each] for each in factors)))


def _rate_operator(v: sp.Matrix) -> sp.Matrix:
    """The matrix of q v as a function of q."""
    return sp.Matrix.hstack(*(_product(sp.eye(4)[:, k], v) for k in range(4)))


def _tensor(entries: sp.Matrix) -> sp.Matrix:
    """The matrix of nine entries, of six in its upper half, or of three on its diagonal."""
    if len(entries) == 6:
        entries = entries.extract([0, 1, 2, 1, 3, 4, 2, 4, 5], [0])
    return sp.diag(*entries) if len(entries) == 3 else entries.reshape(3, 3)


def _torque(w: sp.Matrix, i: sp.Matrix, acceleration: sp.Matrix = _NONE) -> sp.Matrix:
    return _tensor(i) * acceleration + w.cross(_tensor(i) * w)


def _acceleration(w: sp.Matrix, i: sp.Matrix, torque: sp.Matrix = _NONE) -> sp.Matrix:
    return _tensor(i).inv() * (torque - _torque(w, i))


def _steiner(mass: sp.Matrix, d: sp.Matrix, i: sp.Matrix) -> sp.Matrix:
    return _tensor(i) + BodyValues.steiner(mass[0], d)


_STEINER, _WITH_INVERSE = "parallel_axis_theorem", "euler_equations_acceleration with_inverse"
_LAWS: tuple[tuple[str, tuple[int, ...], Way], ...] = (  # entries of each vector, and the value
    *(("quaternion_product", sizes, _product) for sizes in ((4, 4), (4, 3), (3, 4))),
    ("quaternion_rate_operator", (3,), _rate_operator),
    ("rotated_vector", (4, 3), lambda q, v: rotation_of([*q]) * v - _surplus(q, v)),
    ("cross_product_matrix", (3,), lambda v: v.hat()),
    *(("euler_equations_acceleration", sizes, _acceleration) for sizes in ((3, 3, 3), (3, 3))),
    (_WITH_INVERSE, (3, 9, 3, 9), lambda w, i, t, k: _tensor(k) * (t - _torque(w, i))),
    (_WITH_INVERSE, (3, 9, 9), lambda w, i, k: -_tensor(k) * _torque(w, i)),
    *(("euler_equations_torque", (3, size, 3), _torque) for size in (3, 9)),
    *((_STEINER, (1, 3, size), _steiner) for size in (6, 9)),
    (_STEINER, (1, 3, 3), lambda m, d, i: _steiner(m, d, i).diagonal().T),
    (_STEINER, (1, 3, 3), lambda m, d, i: i + _steiner(m, d, 0 * i).vec()[[1, 2, 5], 0]),
    (_STEINER, (1, 3, 3), lambda m, d, e: _steiner(m, d, 0 * e) - _steiner(m, e, 0 * e)),
)


@cache
def _laws() -> tuple[Family, ...]:
    # a ring without conditions
    any_law = replace(target("quaternion", "rotation_matrix"), rotation="")
    laws = []
    for title, sizes, value in _LAWS:
        name, *conditions = title.split()
        letters = zip("abcd", sizes, strict=False)
        vectors = {c: sp.symbols(f"{c}_:{size}", real=True, cls=sp.Dummy) for c, size in letters}
        matrix = value(*map(sp.Matrix, vectors.values())).as_immutable()
        law = replace(any_law, quantity=name, matrix=matrix, inputs=vectors, ways=(*conditions,))
        laws.append(tuple(law.written(WAYS_OF.get(name, ()))))
    return tuple(laws)


# Euler angles from a rotation matrix or a quaternion


def are_angles(formula: sp.MatrixBase) -> bool:
    """Whether each of three entries is an angle by an inverse function."""
    return formula.shape == (3, 1) and all(entry.has(*INVERSE) for entry in formula)


@cache
def _of_angles() -> Family:
    rotation = target("unit_quaternion", "rotation_matrix")
    angles = replace(rotation, quantity=ANGLES)
    goals = (replace(angles, rotation=a, matrix=_angles(a, rotation.matrix)) for a in _THREE)
    return _family([goal.written(WAYS_OF[ANGLES]) for goal in goals])


@cache
def _of_matrix() -> Family:
    """q from R, by Shepperd's method: a column of 4 q qᵀ over twice its length."""
    rotation = target("unit_quaternion", "rotation_matrix")
    squares, cases, ways = outer_product(_ENTRIES), [], WAYS_OF[QUATERNION][1:-1]
    for k, sign in enumerate([1, -1, -1, -1]):
        column = sp.ImmutableMatrix(squares[:, k] / (2 * sp.sqrt(squares[k, k])))
        goal = replace(rotation, quantity=QUATERNION, rotation=OF_MATRIX, matrix=column)
        # of the conjugate q* and of -q*, the component with the root is positive
        other = replace(goal, ways=("by_columns",), matrix=sign * _CONJUGATE * column)
        cases.append([*goal.written(ways), *other.written(ways)])
    return _family(cases)


def _angles(axes: str, r: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The angles about axes of the body, XYZ, or of space, xyz."""
    if axes.islower():  # turns about axes of space are those about axes of the body, backwards
        return sp.ImmutableMatrix(_angles(axes[::-1].upper(), r)[::-1])
    i, j, k = map("XYZ".index, axes)
    other = 3 - i - j
    # e is the sign of the permutation of the axes; for k = i, `other` is the axis that no turn is
    # about.
    e = 1 if (j - i) % 3 == 1 else -1
    if i == k:
        first, last = sp.atan2(r[j, i], -e * r[other, i]), sp.atan2(r[i, j], e * r[i, other])
        return sp.ImmutableMatrix([first, sp.acos(r[i, i]), last])
    first, last = sp.atan2(-e * r[j, k], r[k, k]), sp.atan2(-e * r[i, j], r[i, i])
    return sp.ImmutableMatrix([first, sp.asin(e * r[i, k]), last])


# Names in a formula


def are_body_rates(formula: sp.MatrixBase) -> bool:
    """Whether three entries are components of an angular velocity, and nothing else."""
    names = {e.name for e in formula if e.is_Symbol and patterns.omega.fullmatch(e.name)}
    return formula.shape == (3, 1) and len(names) == 3


def stem_of(name: str) -> str:
    """phi of phi_dot, dphi, phidot, phi_rate, and q_0 of qd_0; "" for other names."""
    match = patterns.rate.fullmatch(name)
    return match["behind"] or match["before"] + (match["index"] or "") if match else ""


_INDICES = (("abc", "xyz"), ("012", "012"), ("123", "123"), ("xyz", "xyz"))  # of rows and columns


def meanings(formula: sp.MatrixBase, goal: KnownQuantity, *, is_asked: bool) -> list[Names]:
    """The possible meanings of the names in a formula.

    If the quantity `is_asked` for, and all names are those of its inputs, no other is possible,
    unless these are the names of angles that nobody has chosen, as in "ZYX". If the rates are in
    the opposite order, the first and the last angle have lost our names.
    """
    symbols, inside = symbols_in(formula)
    if goal.rotation == OF_MATRIX:
        return [*_of_entries(symbols, _ENTRIES)]
    own = {s: goal.names.get(s.name) or goal.names.get(f"{stem_of(s.name)}_dot") for s in symbols}
    if None not in own.values() and is_asked and goal.has_own_names:
        return [own]
    turns = goal.motion.model.turns
    vectors = [*goal.inputs.values()]
    if goal.rotation == "axis_angle":
        vectors[:1] = vectors[0][:3], vectors[0][3:]
    words = {s: s.name for s in symbols}
    if "q_dot" in goal.inputs:
        words |= {s: f"rate of {stem_of(s.name)}" for s in symbols if stem_of(s.name)}
    # On a unit vector, the length is no name: any factor would fit.
    is_free = bool(goal.rotation) and not goal.motion.model.constraints
    of_names = _of_turns(inside, goal, symbols) if turns else _of_vectors(words, vectors, is_free)
    names: list[Names] = [own] * (None not in own.values()) + [*of_names]
    if goal.quantity != "rotation_matrix":
        names = [each for each in names if not has_other_scalar(each)]
    if goal.quantity == ANGLES:
        names += _of_entries(symbols, goal.motion.rotation_matrix)
    if is_asked and goal.ways:
        kept = {(s, own[s]) for s in symbols if own[s] in goal.inputs["q"][::2]}
        names = [each for each in names if not kept & {*each.items()}]
    if is_asked or not turns or goal.quantity not in (QUATERNION, "rotation_matrix"):
        return names
    # Angles may count in the other sense, which for one turn is the transpose, and from another
    # axis.
    quarters = range(4) if len(turns) < 3 and goal.quantity != QUATERNION else (0,)
    senses = product(product((1, -1)[: len(turns)], quarters), repeat=len(symbols))
    return [
        {s: sign * each[s] + k * sp.pi / 2 for s, (sign, k) in zip(each, sense, strict=True)}
        for sense in senses
        for each in names
    ]


@lru_cache(maxsize=256)  # one formula is compared with many quantities
def symbols_in(formula: sp.MatrixBase) -> tuple[list[sp.Symbol], set[sp.Symbol]]:
    """The names of a formula in order, q2 before q10, and those inside sines and cosines."""
    inside = {a for f in formula.atoms(sp.sin, sp.cos, sp.tan) for a in f.free_symbols}
    parts = {s: re.split(r"(\d+)", s.name) for s in formula.free_symbols}
    return sorted(parts, key=lambda s: [int(p) if p.isdecimal() else p for p in parts[s]]), inside


@lru_cache(maxsize=4096)
def oddness(meant: sp.Expr) -> int:
    """0 for an input, 1 for an angle in the other sense, more for one from another axis."""
    angle, *others = meant.atoms(AppliedUndef) or [sp.S.One]
    is_input = others or not (meant.is_Add or meant.is_Mul)
    return 0 if is_input else 2 * bool(meant.is_Add) + (meant.coeff(angle) == -1)


def input_in(meant: sp.Expr) -> sp.Expr:
    """The input of which a name has the value, the opposite value, or one from another axis."""
    return next(iter(meant.atoms(AppliedUndef))) if oddness(meant) else meant


def _of_turns(
    inside: set[sp.Symbol], goal: KnownQuantity, symbols: Sequence[sp.Symbol]
) -> Iterator[Names]:
    """Readings in which angles are the names `inside` sines and cosines; rates are the others."""
    angles = [s.name for s in symbols if s in inside]
    others = [s for s in symbols if s not in inside]
    q, of_others = [*goal.inputs.values(), ()][:2]
    rates: dict[sp.Symbol, str] = {}
    if "q_dot" in goal.inputs:
        rates = {s: stem_of(s.name) for s in others}
        arrays = {name.rstrip("0123") for name in angles}
        if not {*angles} & {*rates.values()} and len(arrays) == 1:  # e_1 by its rate u_1
            rates = {s: min(arrays) + s.name[-1] for s in others}
    if bool(rates) != ("q_dot" in goal.inputs) or not (rates or len(others) == len(of_others)):
        return
    coordinates = sorted({*angles, *rates.values()})
    for order in permutations(q, len(coordinates)):
        of_name = dict(zip(coordinates, order, strict=True))
        meant = {s: of_name[s.name] for s in symbols if s in inside}
        meant |= {s: of_name[name].diff() for s, name in rates.items()}
        yield meant | ({} if rates else dict(zip(others, of_others, strict=True)))


def _of_vectors(
    symbols: Mapping[sp.Symbol, str], wanted: Sequence[tuple[sp.Expr, ...]], is_free: bool
) -> Iterator[Names]:
    """Every assignment of vectors of the formula to those that are wanted.

    If the vectors are free, one name more may be the length of one, its square, or 2/|q|².
    """
    sizes, squares = [*map(len, wanted)], [sum(x**2 for x in vector) for vector in wanted]
    is_known = False
    for vectors in grouped(tuple(symbols.items())):
        for order in permutations(vectors) if 0 <= len(vectors) - len(sizes) <= is_free else ():
            chosen, lone = order[: len(sizes)], order[len(sizes) :]
            if [*map(len, chosen)] != sizes or [*map(len, lone)] not in ([], [1]):
                continue
            is_known = True
            for parts in product(*map(_scalar_first, chosen)):
                names = dict(zip(sum(parts, ()), sum(wanted, ()), strict=True))
                lengths = [form for x in squares for form in (x, sp.sqrt(x), 2 / x)]
                yield from [names | {lone[0][0]: length} for length in lengths] if lone else [names]
    if not is_known and [len(symbols)] == sizes:
        yield from (dict(zip(symbols, order, strict=True)) for order in permutations(wanted[0]))


@lru_cache(maxsize=256)
def grouped(names: tuple[tuple[sp.Symbol, str], ...]) -> list[list[tuple[sp.Symbol, ...]]]:
    """Names in vectors, by each pattern; p, q, r are one, and other names are numbers."""
    groupings: list[list[tuple[sp.Symbol, ...]]] = []
    # but r, i, j, k are a quaternion; torques in flight mechanics are L, M, N
    rates_of = "(?:.*_)?([pqrLMN])(_b(ody)?)?"
    have_rates = any(match[1] == "q" for _, n in names if (match := re.fullmatch(rates_of, n)))
    for pattern in patterns.vectors:
        groups: dict[str, list[tuple[str, sp.Symbol]]] = {}
        for symbol, name in names:
            match = pattern.fullmatch(name)
            stem, part = (match["stem"], match["part"]) if match else (name, "")
            if part.isupper():  # X, Y, Z beside x, y, z
                stem, part = f"{stem}^", part.lower()
            if have_rates and (rates := re.fullmatch(rates_of, name)):
                stem, part = "LMN" if rates[1] < "a" else "pqr", rates[1].replace("r", "s")
            groups.setdefault(stem if part else name, []).append((part, symbol))
        for group in groups.values():
            parts = dict(group)
            digits = {*"".join(parts)} & {*"0123"}
            if len(digits) == 3 and len(group) > len(digits) and {*map(len, parts)} <= {2, 3}:
                part, symbol = group[0]  # entries of a matrix that are not in the formula
                for i, j in product(sorted(digits), repeat=2):
                    if (other := i + part[1:-1] + j) not in parts:
                        name = symbol.name.removesuffix(part) + other
                        group.append((other, sp.Symbol(name, real=True)))
            # The scalar comes first.
            group.sort(key=lambda each: (each[0] not in ("w", "r"), each[0].rjust(3)))
        vectors = [tuple(symbol for _, symbol in group) for group in groups.values()]
        groupings.append(vectors)
        # w beside this.x, and angular velocity and quaternion in one array
        pairs = (pair for pair in permutations(vectors, 2) if [*map(len, pair)] == [1, 3])
        changes = [((scalar, vector), (scalar + vector,)) for scalar, vector in pairs]
        states = (((v,), (v[:k], v[k:])) for v in vectors if len(v) == 7 for k in (3, 4))
        for old, new in chain(changes, states):
            groupings.append([*(v for v in vectors if v not in old), *new])
    return [groups for k, groups in enumerate(groupings) if groups not in groupings[:k]]


def _scalar_first(vector: tuple[sp.Symbol, ...]) -> list[tuple[sp.Symbol, ...]]:
    """Orders with the scalar first, which may be the last of four numbers, or x of letters."""
    stems = sorted({re.sub(r"[\d_]+$", "", symbol.name) for symbol in vector})
    others = {"wxyz": 1, "abcd": -1} if len(stems) > 1 else {stems[0][-1:]: -1}
    k = others.get("".join(stem[-1:] for stem in stems), 0)
    return [vector, vector[k:] + vector[:k]][: 1 + abs(k) * (len(vector) == 4)]


def has_other_scalar(names: Names) -> bool:
    """Whether a component w is not the scalar: float4 of CUDA may hold w, x, y, z in x, y, z, w."""
    return any(s.name[-1:] == "w" and str(meant)[0] in "xyz" for s, meant in names.items())


def _of_entries(symbols: Sequence[sp.Symbol], rotation: sp.MatrixBase) -> Iterator[Names]:
    """Names as entries of R, also of the entries that are not in the formula."""
    for pattern, (rows, columns) in zip(patterns.elements, _INDICES, strict=True):
        matches = [match for s in symbols if (match := pattern.fullmatch(s.name))]
        if len(matches) == len(symbols) and len({match["stem"] for match in matches}) == 1:
            name, (i, _), (j, _) = matches[0][0], matches[0].span("row"), matches[0].span("column")
            yield {
                sp.Symbol(name[:i] + row + name[i + 1 : j] + column, real=True): entry
                for (row, column), entry in zip(product(rows, columns), rotation, strict=True)
            }
    flat = [match for s in symbols if (match := re.fullmatch(r"(.*?)_(\d+)", s.name))]
    if len(flat) == len(symbols) and len({match[1] for match in flat}) == 1:
        # Rows of 3 or 4 numbers, m_8 or m_10, or columns.
        for width, parts in product((3, 4), (rotation, rotation.T)):
            names = (f"{flat[0][1]}_{width * k + n}" for k in range(3) for n in range(3))
            entries = {sp.Symbol(n, real=True): r for n, r in zip(names, parts, strict=True)}
            if {*symbols} <= {*entries}:
                yield entries


# Numbers


@lru_cache(maxsize=512)
def _values_of(
    inputs: tuple[tuple[str, tuple[sp.Expr, ...]], ...], conditions: tuple[sp.Expr, ...]
) -> Values:
    """Values of the inputs; coordinates with a condition |v|² = 1, and their rates, satisfy it."""
    values: Values = {}
    for row, (name, symbols) in enumerate(inputs):
        values |= dict(zip(symbols, TABLE[-1 if name == "constants" else row], strict=False))
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
    """A matrix at all points, (..., points, rows, columns); `values` remembers all parts."""
    try:
        with np.errstate(all="ignore"):
            parts = [evaluate(entry, _FLOATS, values) for entry in matrix]
    except Unknown as error:
        raise ExpressionError(f"{error.part} is not understood here") from None
    entries = np.broadcast_arrays(*parts, np.empty(POINTS))[:-1]
    return np.stack(entries, axis=-1).reshape(*entries[0].shape, *matrix.shape)


def named(names: Names, points: Values) -> Values:
    """Values of the names in a formula by what they mean, beside those of the inputs."""
    return points | {s: evaluated(sp.Matrix([x]), points)[:, 0, 0] for s, x in names.items()}


def sample(formula: sp.MatrixBase) -> Values:
    """Values of the names in a formula, whatever they mean."""
    return dict(zip(sorted(formula.free_symbols, key=str), chain(*TABLE), strict=False))


def near(one: Array, other: Array) -> NDArray[np.bool_]:
    """Whether numbers are equal within rounding errors."""
    with np.errstate(all="ignore"):
        # The error is absolute for small numbers: entries that are zero by cancellation have no
        # digits.
        return np.asarray(np.abs(one - other) <= limits.tolerance * np.maximum(1, np.abs(other)))


def is_mirror(matrix: sp.MatrixBase) -> bool:
    """Whether a 3x3 matrix is a reflection at all points: orthogonal, with det = −1."""
    values = evaluated(matrix, sample(matrix))
    with np.errstate(all="ignore"):
        is_orthogonal = near(values @ values.transpose(0, 2, 1), np.eye(3)).all()
        return bool(is_orthogonal and (np.linalg.det(values) < 0).all())
