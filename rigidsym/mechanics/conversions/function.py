"""A conversion as a function: its arguments, and its values in order, each in those before it.

Where a formula has cases, such as the poles of Euler angles, a value is a `Where`. The order of
the operations is part of a conversion, since its digits depend on it. Quaternions are
p = (w, x, y, z), scalar first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.mechanics.derivation import Argument, Step
from rigidsym.models.rotation import SOURCES
from rigidsym.system.records import NamedTuple

Vector = tuple[sp.Expr, ...]
Line = tuple[sp.Symbol, sp.Expr]


class ConversionFunction(NamedTuple):
    """One conversion of a vector, or of a matrix (3, 3), its components row by row."""

    name: str
    argument: Argument
    values: tuple[Line, ...]
    outputs: Vector
    about: str
    symbol: str = "q"  # of the result, in Unicode
    is_matrix: bool = False
    remarks: tuple[str, ...] = ()  # paragraphs
    unit: str = ""
    halves: Vector = ()  # of Euler angles, from the argument as it is: a₀ to a₃


class Continuity(NamedTuple):
    """How coordinates are made continuous."""

    kind: str  # "euler", "quaternion", "axis_angle", "rotation_vector" or "modified_rodrigues"
    remarks: tuple[str, ...]
    quarters: int = 0  # of Euler angles: the quarter turns from the middle angle 0 to a pole


class Converted(NamedTuple):
    """What a module offers of conversions."""

    steps: tuple[Step, ...] = ()  # in closed form, like other quantities
    functions: tuple[ConversionFunction, ...] = ()
    continuity: Continuity | None = None
    remarks: tuple[str, ...] = ()  # for the head of the module


class Where(sp.Function):
    """Where(condition, a, b): a where the comparison holds, else b."""

    nargs = 3

    @classmethod
    def eval(cls, condition: sp.Basic, then: sp.Expr, otherwise: sp.Expr) -> sp.Expr | None:
        if condition in (sp.true, sp.false):
            return then if condition == sp.true else otherwise
        return then if then == otherwise else None


class Epsilon(sp.Function):
    """The distance from one to the next float, in the type of the argument."""

    nargs = 1


class NamedValues:
    """The named values of one function, in order, from its inputs."""

    def __init__(self, inputs: Sequence[sp.Expr]) -> None:
        self.lines: list[Line] = []
        self._names: dict[sp.Expr, sp.Symbol] = {}
        self.tiny = 4 * Epsilon(inputs[0])  # four times the distance from one to the next float

    def let(self, name: str, value: sp.Expr) -> sp.Expr:
        """A name for a value that is neither a number nor a symbol."""
        if value.is_number or value.is_Symbol or (-value).is_Symbol:
            return value
        if value not in self._names:
            symbol = self._names[value] = sp.Dummy(name)
            self.lines.append((symbol, value))
        return self._names[value]

    def each(self, names: Iterable[str], values: Iterable[sp.Expr]) -> Vector:
        return tuple(map(self.let, names, values))

    def length(self, name: str, vector: Sequence[sp.Expr]) -> sp.Expr:
        return self.let(name, sp.sqrt(square(vector)))

    def scaled(self, quaternion: Sequence[sp.Expr]) -> Vector:
        """The quaternion over the sum of its parts' sizes: any length will do; zero gives NaN."""
        # The sum |w| + |x| + |y| + |z| needs no root. After the division the parts are between −4
        # and 4, and the largest is at least 1, so their squares neither overflow nor all underflow.
        quarters = [self.let("quarter", sp.Abs(part) / 4) for part in quaternion]  # no overflow
        size = self.let("size", sp.Add(*quarters))
        return self.each(PARTS, [part / size for part in quaternion])

    def angle(self, name: str, sine: sp.Expr, cosine: sp.Expr) -> sp.Expr:
        """The angle in (−π, π] of a multiple of its sine and cosine."""
        # A sine of −0 beside a negative cosine would give −π.
        angle = self.let(name, sp.atan2(sine, cosine))
        return self.let(name, Where(angle <= -sp.pi, -angle, angle))


def square(vector: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(part * part for part in vector))


# Quaternions: their products, and their matrices, and back


Part = TypeVar("Part", sp.Expr, PolyElement)

PARTS = ("w", "x", "y", "z")
MATRIX = tuple(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3))
SHEPPERD = SOURCES["Shepperd"]


def product(first: Sequence[Part], second: Sequence[Part]) -> tuple[Part, ...]:
    """The product of two quaternions, as it comes."""
    # (w, u)(a, v) = (w a − u·v, w v + a u + u × v)
    (w, x, y, z), (a, b, c, d) = first, second
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )


def half_turn(direction: Sequence[sp.Expr], angle: sp.Expr) -> Vector:
    """cos(β/2) + sin(β/2) e, the unit quaternion of the turn by β about the unit axis e."""
    return (sp.cos(angle / 2), *(sp.sin(angle / 2) * part for part in direction))


def outer_product(matrix: sp.MatrixBase) -> sp.Matrix:
    """K(R) = 4 p pᵀ, (4, 4), of a rotation matrix (Shepperd, 1978)."""
    # For R = (w² − v·v) 1 + 2 v vᵀ + 2 w C(v) with w² + v·v = 1:
    # 4 w² = 1 + tr R
    # 4 w C(v) = R − Rᵀ
    # 4 v vᵀ = R + Rᵀ + (1 − tr R) 1
    r, trace = sp.Matrix(matrix), matrix.trace()
    vector = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    block = r + r.T + (1 - trace) * sp.eye(3)
    return sp.Matrix([[1 + trace, *vector], *([v, *block[k, :]] for k, v in enumerate(vector))])


def shepperd(values: NamedValues, matrix: sp.Matrix) -> Vector:
    """The column of 4 p pᵀ with the largest diagonal entry, so that nothing cancels.

    Its scalar is not negative where the first column is taken.
    """
    # Column k of 4 p pᵀ is 4 pₖ p. Its diagonal adds up to 4, so the largest entry 4 pₖ² is at
    # least 1.
    outer = outer_product(matrix)
    names = [[f"k{a}{b}" for b in PARTS] for a in PARTS]
    w, x, y, z = (
        values.each(names[k], [outer[min(j, k), max(j, k)] for j in range(4)]) for k in range(4)
    )
    by_x, by_z = x[1] > w[0], z[3] > y[2]
    upper = values.let("upper", Where(by_x, x[1], w[0]))
    lower = values.let("lower", Where(by_z, z[3], y[2]))
    return values.each(
        PARTS,
        [Where(lower > upper, Where(by_z, z[k], y[k]), Where(by_x, x[k], w[k])) for k in range(4)],
    )


def short_way(values: NamedValues, quaternion: Sequence[sp.Expr]) -> Vector:
    """The same rotation by the quaternion whose scalar is not negative."""
    # p and −p are the same rotation; w ≥ 0 is the one by at most half a turn.
    w, *vector = quaternion
    flipped = [Where(w < 0, -part, part) for part in vector]
    return values.each(PARTS, [sp.Abs(w), *flipped])
