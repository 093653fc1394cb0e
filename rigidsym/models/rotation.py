"""Rotations as data: turns about axes, and models of coordinates q with the R(q) they define."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import lru_cache, reduce
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import TIME as TIME, added, in_names, is_identically_zero, rate_of
from rigidsym.errors import ModelError
from rigidsym.system.files import table_beside
from rigidsym.system.records import NamedTuple, Record
from rigidsym.text.names import A_MODULE_NAME, MODULE_NAME, lettered

AXES = ("x", "y", "z")
OMEGA_BODY = sp.symbols("Omega_body_1:4")  # Ω′ as an argument
_NUMBERS = (sp.NumberSymbol, type(sp.I))


class Citation(NamedTuple):
    """Where a formula comes from."""

    text: str  # author, title
    equation: str = ""  # its number there, if it has one
    section: str = ""  # where in the source, if it is not in the text

    def __str__(self) -> str:
        equation = f"eq. {self.equation}" if self.equation else ""
        return ", ".join(filter(None, (self.text, self.section, equation)))


WORDS: Mapping[str, Mapping[str, Any]] = table_beside(__file__, "rotations.toml")


class _Sources(dict[str, Citation]):
    """Citations by book and section: "Landau 35", or with an equation "Landau 32 (32.12)"."""

    def __missing__(self, place: str) -> Citation:
        book, section, equation = f"{place}  ".split(" ", 3)[:3]
        section = section and f"section {section}"
        self[place] = Citation(WORDS["books"][book], equation.strip("()"), section)
        return self[place]


SOURCES = _Sources()


def lecture(equation: str = "", section: str = "") -> Citation:
    """A citation of the lecture notes."""
    return SOURCES["lecture"]._replace(equation=equation, section=section)


_ALONG = dict(zip(AXES, map(tuple, sp.eye(3).tolist()), strict=True))


class Turn(Record, kw_only=True):
    """One turn of a product of turns: right-handed, by `angle` about a constant axis.

    The axis is a coordinate axis (x, y, z), or any unit vector, by its `components`.
    """

    axis: str  # x, y, z, or how the axis is printed
    angle: sp.Expr  # radians
    components: tuple[sp.Expr, ...] = ()  # of the axis, if it is not a coordinate axis

    def __post_init__(self) -> None:
        object.__setattr__(self, "angle", symbolic(self.angle, "the angle of a turn"))
        if not isinstance(self.components, (Iterable, sp.MatrixBase)):
            raise ModelError(f"an axis has three components, got {self.components!r}")
        axis = tuple(symbolic(part, "the axis of a turn") for part in self.components)
        object.__setattr__(self, "components", axis)
        if not axis and self.axis not in AXES:
            raise ModelError(f"{self.axis!r} is not an axis: expected x, y, z or components")
        if axis and len(axis) != 3:
            raise ModelError(f"an axis has three components, got {len(axis)}")
        if sp.Tuple(*axis).has(sp.Float):
            raise ModelError(f"the axis {axis} has decimals; expected exact numbers, such as 3/5")
        square = sum(part**2 for part in axis) if axis else sp.S.One
        if square.is_number and square != 1 and not is_identically_zero(square - 1):
            raise ModelError(f"the axis {self.axis} has the length {sp.sqrt(square)}; expected 1")

    @property
    def rate(self) -> sp.Expr:
        """The time derivative of the angle."""
        return rate_of(self.angle)

    @property
    def direction(self) -> tuple[sp.Expr, ...]:
        """The components of the axis along x, y, z."""
        return self.components or _ALONG[self.axis]

    @property
    def matrix(self) -> sp.ImmutableMatrix:
        """The matrix (3, 3) that takes components after the turn to those before it."""
        if self.components:
            return rodrigues(self.components, self.angle)
        return elementary(self.axis, self.angle)

    @property
    def angle_text(self) -> str:
        """The angle in plain text: 2φ − ψ for 2*phi - psi."""
        text = re.sub(r"[A-Za-z]\w*", lambda name: lettered(name[0]), str(in_names(self.angle)))
        text = re.sub(r"(?<=\d)\*(?!\*)", "", text).replace("**", "^").replace("*", " ")
        return text.replace("-", "−")

    def __str__(self) -> str:
        return f"R{self.axis}({self.angle_text})"


def product_of(turns: tuple[Turn, ...]) -> sp.ImmutableMatrix:
    """R as the product of turns, left to right as given."""
    return reduce(_times, (turn.matrix for turn in turns))


def by_axis(turns: tuple[Turn, ...], angle: sp.Expr) -> list[tuple[Turn, sp.ImmutableMatrix]]:
    """A turn by the angle about each axis of the turns, with its matrix; x, y and z come first."""
    axes = {(turn.components, turn.axis): turn for turn in turns}
    ordered = sorted(axes, key=lambda key: (bool(key[0]), key[1]))
    by_angle = (replace(axes[key], angle=angle) for key in ordered)
    return [(turn, turn.matrix) for turn in by_angle]


def carried_axes(turns: tuple[Turn, ...]) -> list[sp.ImmutableMatrix]:
    """The axis of each turn in space components (3, 1), carried along by the turns before it."""
    # Turn k is about nₖ in axes that the turns before it have moved: R₁ ⋯ Rₖ₋₁ nₖ in space.
    before, axes = sp.ImmutableMatrix(sp.eye(3)), []
    for turn in turns:
        axes.append(_times(before, sp.ImmutableMatrix(turn.direction)))
        before = _times(before, turn.matrix)
    return axes


@lru_cache(maxsize=128)
def _times(first: sp.ImmutableMatrix, second: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The product, remembered, since several sequences begin with the same two turns.

    Zeros are left out, since SymPy would ask of each whether its partner is finite.
    """
    rows, columns = first.tolist(), second.T.tolist()
    pairs = (zip(row, column, strict=True) for row in rows for column in columns)
    entries = [added(*(a * b for a, b in each if a and b)) for each in pairs]
    return sp.ImmutableMatrix(len(rows), len(columns), entries, copy=False)


class Pullback(NamedTuple):
    """Bound coordinates as functions of others that reach every allowed value of them.

    What vanishes after the substitution vanishes wherever the coordinates are allowed to be, and
    nothing else does: a proof where the relations between the coordinates themselves are many.
    """

    coordinates: tuple[sp.Expr, ...]  # the coordinates of the model, in terms of the others
    constraints: tuple[sp.Expr, ...]  # on the others


class RotationModel(Record, kw_only=True):
    """Coordinates q(t) and the rotation R(q) they stand for.

    R takes body components to space components: x = R x' (lecture, eq. 15). With `passive` the
    derivation presents the transpose, the direction cosine matrix; R itself is the same.
    """

    name: str  # names files and the generated module: lower case, digits, underscores
    title: str  # "Euler angles ZXZ, intrinsic"
    convention: tuple[str, ...]  # the convention in words, a sentence an entry
    coordinates: tuple[sp.Expr, ...]  # functions of time
    matrix: sp.ImmutableMatrix  # R, (3, 3)
    source: Citation
    turns: tuple[Turn, ...] = ()  # if R is a product of turns: left to right as multiplied
    definition: str = ""  # without turns, R as certificates name it: "quaternion(w, x, y, z)"
    constraints: tuple[sp.Expr, ...] = ()  # each vanishes for all time
    units: tuple[str, ...] = ()  # of the coordinates; radians by default
    passive: bool = False
    pullback: Pullback | None = None  # if the coordinates are bound, in place of constraints
    vector: tuple[sp.Expr, ...] = ()  # the three coordinates that are components of one vector
    z_down: bool = False  # whether figures show the z-axis of space pointing down
    example: tuple[tuple[sp.Expr, sp.Expr], ...] = ()  # (symbol, value): a real point, if known
    # what asks for it in a file; another may ask for the same
    request: Mapping[str, Any] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        if not MODULE_NAME.fullmatch(self.name):
            raise ModelError(f"{self.name!r} cannot name a model: {A_MODULE_NAME}")
        try:
            self._check()
        except ModelError as error:
            raise ModelError(f"{self.name}: {error}") from None

    def _check(self) -> None:
        """Raises ModelError for what is wrong; each check relies on those before it."""
        if self.matrix.shape != (3, 3):
            raise ModelError(f"a rotation matrix is 3x3, got {self.matrix.shape}")
        if not self.coordinates:
            raise ModelError("a model needs at least one coordinate, a function of time as phi(t)")
        if self.units and len(self.units) != len(self.coordinates):
            raise ModelError(f"{len(self.coordinates)} coordinates, but {len(self.units)} units")
        for place, coordinate in enumerate(self.coordinates):
            if coordinate in self.coordinates[:place]:
                raise ModelError(f"the coordinate {coordinate} is named twice")
            if not isinstance(coordinate, AppliedUndef) or coordinate.args != (TIME,):
                raise ModelError(
                    f"the coordinate {coordinate} is not a function of t; "
                    "make it with sympy.physics.vector.dynamicsymbols"
                )
        moving = {coordinate.func.__name__ for coordinate in self.coordinates}
        for constant in self.constants:
            if constant.name in moving:
                raise ModelError(f"{constant} is both a coordinate and a constant")
        numbers = set().union(*(part.atoms(*_NUMBERS) for part in self._parts))
        if sp.I in numbers:
            raise ModelError("a rotation is real, but the matrix contains the number i")
        # π and e are transcendental, and no algebraic equation between them is known. The golden
        # ratio, say, is algebraic, and the ring would not know its equation.
        for number in numbers - {sp.pi, sp.E}:
            raise ModelError(
                f"the matrix contains the number {number}, which is not in the ring; "
                f"expected roots, as in {sp.expand_func(sp.GoldenRatio)}, or a symbol"
            )
        if self.turns and product_of(self.turns) != self.matrix:
            raise ModelError(f"the matrix is not the product of its turns, {self.product}")

    @property
    def _parts(self) -> tuple[sp.Basic, ...]:
        """The parts of the rotation; turns are shorter to read than their product."""
        # A product of many turns has 2ⁿ terms, and the same symbols as its angles and axes.
        turns = [part for turn in self.turns for part in (turn.angle, *turn.components)]
        return (*(turns or [self.matrix]), *self.constraints)

    @property
    def constants(self) -> tuple[sp.Symbol, ...]:
        """The symbols in R or its conditions that do not move: fixed angles, parts of an axis."""
        return _constants(self._parts)

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        return self.units or ("rad",) * len(self.coordinates)

    @property
    def product(self) -> str:
        """R as a product of turns in plain text, "Rz(φ) Rx(θ) Rz(ψ)"; empty if it is not one."""
        return " ".join(str(turn) for turn in self.turns)

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions on coordinates and constants in plain text: "c**2 + s**2 = 1"."""
        parts = (in_names(constraint).as_coeff_Add() for constraint in self.constraints)
        return tuple(f"{rest} = {-number}" for number, rest in parts)

    @property
    def names(self) -> set[str]:
        """Of the coordinates and constants."""
        names = {coordinate.func.__name__ for coordinate in self.coordinates}
        return names | {symbol.name for symbol in self.matrix.free_symbols}

    def __repr__(self) -> str:
        """One line, for a prompt."""
        return f"<RotationModel {self.name}: {self.title}>"

    def __str__(self) -> str:
        return self.name


@lru_cache(maxsize=256)
def _constants(parts: tuple[sp.Basic, ...]) -> tuple[sp.Symbol, ...]:
    """The symbols that do not move; asked for again and again in one derivation."""
    return tuple(sp.ordered(set().union(*(part.free_symbols for part in parts)) - {TIME}))


@lru_cache(maxsize=256)
def time_function(name: str) -> sp.Expr:
    """The function of time `name`(t), the same object that dynamicsymbols(name) gives."""
    return sp.Function(name)(TIME)


def unit_example(parts: Sequence[sp.Expr], variant: int = 0) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
    """Rational values for the parts of a unit vector, none of them special; another each variant.

    They are the stereographic image of a point whose coordinates are one over a prime.
    """
    # The inverse stereographic projection takes t to (2t, 1 − t·t)/(1 + t·t), a unit vector, which
    # is rational whenever t is.
    flat = [sp.Rational(1, sp.prime(k + variant)) for k in range(1, len(parts))]
    square = sp.Add(*(number**2 for number in flat))
    values = [*(2 * number / (1 + square) for number in flat), (1 - square) / (1 + square)]
    return tuple(zip(parts, values, strict=True))


def depends_on_time(value: sp.Basic) -> bool:
    """Whether t occurs in it by itself, not only as the argument of a coordinate."""
    moving = value.atoms(sp.Derivative, AppliedUndef)
    return bool(value.xreplace({function: sp.Dummy() for function in moving}).has(TIME))


def as_typed(value: sp.Basic) -> str:
    """The expression as in a derivation file: theta, and theta_dot for its rate."""
    return str(in_names(value))


def symbolic(value: object, what: str) -> sp.Expr:
    """A SymPy expression or a number from a caller. Raises ModelError for anything else."""
    try:
        return sp.sympify(value, strict=True)
    except sp.SympifyError:
        raise ModelError(f"{what}: expected a SymPy expression, got {value!r}") from None


def hat(vector: sp.MatrixBase) -> sp.ImmutableMatrix:
    """C(u), shape (3, 3), with C(u) v = u × v (lecture, section 3.2)."""
    x, y, z = vector
    return sp.ImmutableMatrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def rotation_of(parts: Sequence[sp.Expr]) -> sp.Matrix:
    """(w² − v·v) 1 + 2 v vᵀ + 2 w C(v): the matrix of a quaternion (w, v), times its square."""
    # q x q̄ for the vector x, multiplied out; for a unit quaternion this is the rotation.
    w, *vector = parts
    v = sp.Matrix(vector)
    return (w**2 - v.dot(v)) * sp.eye(3) + 2 * v * v.T + 2 * w * hat(v)


@lru_cache(maxsize=256)
def elementary(axis: str, angle: sp.Expr) -> sp.ImmutableMatrix:
    """Right-handed active turn by `angle` (radians) about the coordinate axis x, y or z.

    For z and x it is the R_z(β) and R_x(β) printed in the lecture, section 3.2.
    """
    # The turn takes the second axis towards the third, in cyclic order: y to z about x, z to x
    # about y, x to y about z.
    first = AXES.index(axis)
    second, third = (first + 1) % 3, (first + 2) % 3
    cosine, sine = sp.cos(angle), sp.sin(angle)
    entries = {(first, first): 1, (second, second): cosine, (third, third): cosine}
    entries |= {(second, third): -sine, (third, second): sine}
    return sp.ImmutableMatrix(3, 3, lambda row, column: entries.get((row, column), 0))


@lru_cache(maxsize=256)
def rodrigues(axis: tuple[sp.Expr, ...], angle: sp.Expr) -> sp.ImmutableMatrix:
    """Right-handed active turn by `angle` (radians) about a unit axis (3,), Rodrigues' formula.

    1 + sin β C(e) + (1 − cos β) C(e)², which is a rotation where e·e = 1 and not otherwise.
    """
    # The product (1 − cos β) C² is multiplied out term by term, so that entries are sums of
    # products, as the ring and the printers hold them.
    skew = hat(axis)
    sine, rest = sp.sin(angle), 1 - sp.cos(angle)
    parts = zip(sp.eye(3), skew, skew * skew, strict=True)
    return sp.ImmutableMatrix(
        3, 3, [sp.Add(e, sine * s, *(rest * t for t in sp.Add.make_args(q))) for e, s, q in parts]
    )
