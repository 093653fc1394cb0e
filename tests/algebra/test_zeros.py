"""Zeros of polynomials in sines and cosines: all of them, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from sympy import Rational, cos, sin

import rigidsym as rs
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.zeros import solver_for
from rigidsym.models.rotation import time_function

phi, theta = map(time_function, ("phi", "theta"))
ROOTS = (sp.sqrt(2), sp.sqrt(3))


def zeros(expression: sp.Expr) -> tuple[list[dict[sp.Expr, sp.Expr]], bool]:
    codec = codec_for([expression, *ROOTS], order=0)
    found, is_complete = solver_for(codec, (phi, theta)).common([codec.encode(expression)])
    return [
        {root.place.coordinate: root.place.value for root in zero} for zero in found
    ], is_complete


@pytest.mark.parametrize(
    "expression",
    [
        2 * cos(theta) ** 2 - 1,
        4 * sin(theta) ** 2 - 3,
        2 * sin(theta) - 1,
        2 * cos(theta) + sp.sqrt(2),
        6 * cos(theta / 2) ** 2 - cos(theta / 2) - 1,
        cos(2 * theta),
        sin(3 * theta),
        sin(2 * theta) * (4 * cos(theta) ** 2 - 3),
        2 * cos(theta) ** 2 - 5,
        sp.sqrt(3) * sin(theta) - cos(theta),
    ],
    ids=str,
)
def test_zeros_of_one_angle_are_all_that_there_are(expression):
    found, is_complete = zeros(expression)
    assert is_complete
    for zero in found:
        assert sp.simplify(expression.xreplace(zero)) == 0
    period = 4 * np.pi if expression.has(theta / 2) else 2 * np.pi
    grid = np.linspace(0.001, 0.001 + period, 5000)
    angle = sp.Symbol("angle")
    values = sp.lambdify(angle, expression.xreplace({theta: angle}))(grid)
    assert len(found) == (values[:-1] * values[1:] < 0).sum()


@pytest.mark.parametrize("function", [sin, cos])
@pytest.mark.parametrize("angle", [phi + theta, phi - theta, theta - phi])
def test_zeros_of_a_sum_of_two_angles_name_one_by_the_other(function, angle):
    expression = sp.expand_trig(function(angle))
    found, is_complete = zeros(expression)
    assert is_complete
    assert len({tuple(zero.items()) for zero in found}) == 2
    for zero in found:
        assert len(zero) == 1
        assert sp.expand_trig(expression.xreplace(zero)).expand() == 0


def test_a_polynomial_that_is_not_solved_says_so():
    assert zeros(sin(phi) - sin(theta)) == ([], False)
    assert zeros(cos(phi) ** 3 + 2 * cos(phi) + 1) == ([], False)
    mixed = sin(phi) * cos(phi) + Rational(3, 5) * cos(phi) + Rational(4, 5) * sin(phi)
    assert zeros(mixed) == ([], False)
    assert zeros(cos(phi) ** 3 - 2 * cos(phi) + 3) == ([], True)  # its roots are beyond 1


@pytest.mark.parametrize(
    ("turns", "count"),
    [
        ("z(phi) x(phi + theta) z(psi)", 2),
        ("z(phi) y(2*theta) x(psi)", 4),
        ("z(phi) x(alpha0 - theta) z(psi)", 2),
        ("z(phi) x(theta - zeta0) z(psi)", 2),
        ("z(phi) y(theta - alpha0) x(psi)", 2),
        ("z(phi) y(2*theta - zeta0) x(psi)", 4),
        ("z(phi) y(zeta0 - theta/2) x(psi)", 2),
        ("z(phi) x(2*alpha0 - 2*theta - 2*phi) z(psi)", 4),
    ],
)
def test_singular_orientations_of_turns_by_sums_and_multiples_are_listed(turns, count):
    motion = rs.derive(rs.rotation_from(turns))
    points = motion.singularities.points
    assert motion.singularities.is_solved
    assert len({point.places[0].value for point in points}) == count
    for (place,) in (point.places for point in points):
        there = {theta: theta + place.value - place.coordinate}
        determinant = motion.rate_matrix_space.det().xreplace(there)
        values = dict.fromkeys(determinant.free_symbols, 0.3) | {phi: 0.7}
        assert abs(determinant.xreplace(values).evalf()) < 1e-12
