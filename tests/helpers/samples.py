"""Rotations that are not in the catalogue, and matrices that are no rotations, as models."""

from __future__ import annotations

from functools import reduce

import sympy as sp
from sympy import Rational, cos, cosh, pi, sec, sin, sinh, sqrt, tan

from rigidsym.models.rotation import Citation, RotationModel, elementary, hat, time_function

TIME = sp.Symbol("t")
ONE = sp.eye(3)
phi, theta, psi, u = map(time_function, ("phi", "theta", "psi", "u"))
w, x, y, z = map(time_function, ("w", "x", "y", "z"))
m, length, alpha = sp.symbols("m l alpha")


def values(**numbers: int | str) -> dict[sp.Expr, sp.Rational]:
    """Rational values of symbols by name."""
    by_name = {str(getattr(s, "func", s)): s for s in (phi, theta, w, x, y, z)} | {"m": m}
    return {by_name[name]: Rational(number) for name, number in numbers.items()}


def model(matrix, *coordinates, constraints=(), example=None) -> RotationModel:
    """A model with a given matrix in given coordinates; by default, a unit quaternion's example."""
    point = dict(zip((w, x, y, z), (Rational(k, 11) for k in (1, 2, 4, 10)), strict=True))
    return RotationModel(
        name="sample",
        title="Sample",
        convention=("A sample.",),
        coordinates=coordinates,
        matrix=sp.ImmutableMatrix(matrix),
        source=Citation(text="this test"),
        constraints=constraints,
        example=tuple((point if example is None else example).items()) if constraints else (),
    )


def about_z(cosine, sine) -> sp.Matrix:
    """The turn about z with a given cosine and sine."""
    return sp.Matrix([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def chain(*turns) -> sp.Matrix:
    """The product of turns, each an axis and an angle, left to right."""
    return reduce(lambda a, b: a * b, (elementary(axis, angle) for axis, angle in turns), ONE)


def rodrigues(axis, angle) -> sp.Matrix:
    """The turn by an angle about a unit axis."""
    skew = hat(axis)
    return ONE + sin(angle) * skew + (1 - cos(angle)) * skew * skew


VECTOR = sp.Matrix([x, y, z])
SKEW = hat(VECTOR)
SQUARE = VECTOR.dot(VECTOR)
NORM = sqrt(SQUARE)
QUATERNION = (w**2 - SQUARE) * ONE + 2 * VECTOR * VECTOR.T + 2 * w * SKEW
THIRDS = sp.Matrix([Rational(1, 3), Rational(2, 3), Rational(2, 3)])
HYPERBOLA = cosh(u) ** 2 - sinh(u) ** 2 - 1

ROTATIONS = {
    "rotation vector": model(
        ONE + sin(NORM) / NORM * SKEW + (1 - cos(NORM)) / SQUARE * SKEW * SKEW, x, y, z
    ),
    "unit quaternion": model(QUATERNION, w, x, y, z, constraints=(w**2 + SQUARE - 1,)),
    "quaternion of a constant norm": model(
        QUATERNION / m,
        *(w, x, y, z),
        constraints=(w**2 + SQUARE - m,),
        example=values(m=15, w=1, x=1, y=2, z=3),
    ),
    "axis and angle": model(
        rodrigues(VECTOR, phi),
        *(x, y, z, phi),
        constraints=(SQUARE - 1,),
        example=values(x="2/7", y="3/7", z="6/7"),
    ),
    "fixed axis": model(rodrigues(THIRDS, phi), phi),
    "five turns": model(
        chain(*zip("zxyzx", (phi, theta, psi, u, w), strict=True)), phi, theta, psi, u, w
    ),
    "sums and multiples": model(
        chain(("z", 2 * phi), ("x", theta), ("z", phi / 3 + psi)), phi, theta, psi
    ),
    "angle with an offset": model(
        chain(("z", phi), ("x", theta + alpha), ("z", psi)), phi, theta, psi
    ),
    "gear": model(chain(("z", m / length * phi), ("x", theta)), phi, theta),
    "product of coordinates": model(
        chain(("z", phi), ("x", theta), ("z", theta * psi)), phi, theta, psi
    ),
    "function of a coordinate": model(chain(("z", sin(phi)), ("x", theta)), phi, theta),
    "parts of pi": model(
        chain(("z", phi + pi / 3), ("x", pi / 4), ("y", pi / 5), ("x", pi / 8)), phi
    ),
    "roots": model(about_z(sqrt(6) / 3, sqrt(3) / 3) * elementary("x", phi), phi),
    "roots of one number": model(
        about_z(sp.Integer(2) ** Rational(1, 4) / 2, sqrt(1 - sqrt(2) / 4)) * elementary("x", phi),
        phi,
    ),
    "secant and tangent": model(about_z(1 / sec(phi), tan(phi) * cos(phi)), phi),
    "tangent of the half angle": model(
        about_z(
            (1 - tan(phi / 2) ** 2) / (1 + tan(phi / 2) ** 2),
            2 * tan(phi / 2) / (1 + tan(phi / 2) ** 2),
        ),
        phi,
    ),
    "rational": model(about_z((1 - u**2) / (1 + u**2), 2 * u / (1 + u**2)), u),
    "root of a coordinate": model(about_z(sqrt(1 - u**2), u), u),
    "masses": model(about_z(m / sqrt(m**2 + length**2), length / sqrt(m**2 + length**2)), phi),
    "hyperbolic, with its relation": model(
        about_z(1 / cosh(u), sinh(u) / cosh(u)), u, constraints=(HYPERBOLA,)
    ),
    "coupled coordinates": model(
        chain(("z", phi), ("x", theta), ("z", psi)),
        *(phi, theta, psi),
        constraints=(phi - theta,),
        example=values(phi="1/3", theta="1/3"),
    ),
}
TINY = Rational(1, 10**30)
WRONG = {
    "reflection": (model(sp.diag(1, 1, -1) * elementary("z", phi), phi), "det R = 1", "-2"),
    "sign": (
        model(sp.Matrix([[cos(phi), sin(phi), 0], [sin(phi), cos(phi), 0], [0, 0, 1]]), phi),
        "R Rᵀ = 1",
        "2*sin(phi)*cos(phi)",
    ),
    "shear": (model(ONE + hat([0, 0, u]), u), "R Rᵀ = 1", "u**2"),
    "nearly": (model(elementary("z", phi) * (1 + TINY), phi), "R Rᵀ = 1", "1000000000000"),
    "nearly, opaque": (
        model(elementary("z", phi) * (1 + TINY * cosh(u)), phi, u),
        "R Rᵀ = 1",
        "cosh(u)",
    ),
    "wrong vector": (
        model(ONE + sin(NORM) / NORM * SKEW - (1 - cos(NORM)) / SQUARE * SKEW * SKEW, x, y, z),
        "R Rᵀ = 1",
        "cos(sqrt(",
    ),
    "quaternion with a wrong sign": (
        model(
            QUATERNION - 4 * w * SKEW * sp.diag(1, 0, 0),
            w,
            x,
            y,
            z,
            constraints=(w**2 + SQUARE - 1,),
        ),
        "R Rᵀ = 1",
        "w",
    ),
    "quaternion of another norm": (
        model(
            QUATERNION,
            w,
            x,
            y,
            z,
            constraints=(w**2 + SQUARE - 2,),
            example=values(w=1, x="6/7", y="3/7", z="2/7"),
        ),
        "R Rᵀ = 1",
        "3",
    ),
    "quaternion with an opaque factor": (
        model(sp.diag(cosh(u), 1, 1) * QUATERNION, w, x, y, z, u, constraints=(w**2 + SQUARE - 1,)),
        "R Rᵀ = 1",
        "cosh(u)**2 - 1",
    ),
    "masses": (model(about_z(m, length), phi), "R Rᵀ = 1", "m**2"),
}
