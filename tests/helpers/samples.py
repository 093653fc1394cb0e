"""Rotations that are not in the catalogue, and matrices that are no rotations, as models."""

from __future__ import annotations

from functools import reduce

import sympy as sp
from sympy import Rational, cos, cosh, pi, sin, sinh, sqrt, tan

from rigidsym.models.rotation import Citation, RotationModel, elementary, hat, time_function

TIME = sp.Symbol("t")
ONE = sp.eye(3)
phi, theta, psi, u = map(time_function, ("phi", "theta", "psi", "u"))
w, x, y, z = map(time_function, ("w", "x", "y", "z"))
m, length, alpha = sp.symbols("m l alpha")


def model(matrix, *coordinates, constraints=(), example=None) -> RotationModel:
    """A model with a given matrix in given coordinates; by default, a unit quaternion's example."""
    unit = {w: Rational(1, 11), x: Rational(2, 11), y: Rational(4, 11), z: Rational(10, 11)}
    point = {symbol: sp.sympify(value) for symbol, value in (example or unit).items()}
    return RotationModel(
        name="sample",
        title="Sample",
        convention=("A sample.",),
        coordinates=coordinates,
        matrix=sp.ImmutableMatrix(matrix),
        source=Citation(text="this test"),
        constraints=constraints,
        example=tuple(point.items()) if constraints and example != {} else (),
    )


def about_z(cosine, sine) -> sp.Matrix:
    return sp.Matrix([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def chain(*turns) -> sp.Matrix:
    """The product of turns, each an axis and an angle, left to right."""
    return reduce(lambda a, b: a * b, (elementary(axis, angle) for axis, angle in turns), ONE)


VECTOR = sp.Matrix([x, y, z])
SKEW = hat(VECTOR)
SQUARE = VECTOR.dot(VECTOR)
NORM = sqrt(SQUARE)
QUATERNION = (w**2 - SQUARE) * ONE + 2 * VECTOR * VECTOR.T + 2 * w * SKEW
HYPERBOLA = cosh(u) ** 2 - sinh(u) ** 2 - 1

ROTATIONS = {
    "quaternion of a constant norm": model(
        QUATERNION / m,
        *(w, x, y, z),
        constraints=(w**2 + SQUARE - m,),
        example={m: 15, w: 1, x: 1, y: 2, z: 3},
    ),
    "sums and multiples": model(
        chain(("z", 2 * phi), ("x", theta), ("z", phi / 3 + psi)), phi, theta, psi
    ),
    "product of coordinates": model(
        chain(("z", phi), ("x", theta), ("z", theta * psi)), phi, theta, psi
    ),
    "parts of pi": model(
        chain(("z", phi + pi / 3), ("x", pi / 4), ("y", pi / 5), ("x", pi / 8)), phi
    ),
    "tangent of the half angle": model(
        about_z(
            (1 - tan(phi / 2) ** 2) / (1 + tan(phi / 2) ** 2),
            2 * tan(phi / 2) / (1 + tan(phi / 2) ** 2),
        ),
        phi,
    ),
    "root of a coordinate": model(about_z(sqrt(1 - u**2), u), u),
    "masses": model(about_z(m / sqrt(m**2 + length**2), length / sqrt(m**2 + length**2)), phi),
    "hyperbolic, with its relation": model(
        about_z(1 / cosh(u), sinh(u) / cosh(u)), u, constraints=(HYPERBOLA,)
    ),
    "coupled coordinates": model(
        chain(("z", phi), ("x", theta), ("z", psi)),
        *(phi, theta, psi),
        constraints=(phi - theta,),
        example={phi: Rational(1, 3), theta: Rational(1, 3)},
    ),
}
TINY = Rational(1, 10**30)
WRONG = {
    "reflection": (model(sp.diag(1, 1, -1) * elementary("z", phi), phi), "det R = 1", "-2"),
    "shear": (model(ONE + hat([0, 0, u]), u), "R Rᵀ = 1", "u**2"),
    "nearly": (model(elementary("z", phi) * (1 + TINY), phi), "R Rᵀ = 1", "1000000000000"),
    "wrong vector": (
        model(ONE + sin(NORM) / NORM * SKEW - (1 - cos(NORM)) / SQUARE * SKEW * SKEW, x, y, z),
        "R Rᵀ = 1",
        "cos(sqrt(",
    ),
    "quaternion with a wrong sign": (
        model(
            QUATERNION - 4 * w * SKEW * sp.diag(1, 0, 0),
            *(w, x, y, z),
            constraints=(w**2 + SQUARE - 1,),
        ),
        "R Rᵀ = 1",
        "w",
    ),
}
