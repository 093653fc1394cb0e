"""Singular orientations, for every rotation: ranks, directions and completeness, by numbers.

The witness builds R and the rate matrix from exponentials of skew matrices and differences. Zeros
of polynomials in sines and cosines are found all, in closed form.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from sympy import Rational, cos, sin

import rigidsym as rs
from helpers.parametrisations import CHAINS, LONG, constants_of, motion_of, way_of
from helpers.target_modules import INVERSES
from helpers.witness import evaluate, mp, number, unhat
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.zeros import solver_for
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation import time_function

Array = np.ndarray[Any, Any]

TURNS = (
    *("ZXZ", "zyx", "aerospace", *(text for text in CHAINS if text != LONG)),
    "z(phi) y(2*theta/3) x(psi)",
    "z(phi) x(theta + alpha0) z(psi)",
    "z(phi) x(theta) z(theta)",
    "x(a) z(b + pi/4) x(c) y(d)",
)
EVERY = (*PARAMETRISATIONS, *TURNS)
UNDECIDED = "z(phi) [a,b,c](beta) [1,2,2](psi)"  # a cosine and a sine by any constants


def rate_matrix(text: str, q: Array) -> Array:
    """Columns (∂R Rᵀ)∨ along an orthonormal basis of the allowed rates, at 50 digits."""
    _, build = way_of(text)
    columns, point, step = [], [mp.mpf(float(x)) for x in q], mp.mpf(10) ** -20
    here = build(point)
    for direction in allowed(text, q).T:
        ahead = build([x + step * float(d) for x, d in zip(point, direction, strict=True)])
        columns.append([float(part) for part in unhat((ahead - here) * here.T / step)])
    return np.array(columns).T


def allowed(text: str, q: Array) -> Array:
    """An orthonormal basis, in columns, of the rates that keep to the constraints."""
    model = motion_of(text).model
    if not model.constraints:
        return np.eye(len(q))
    normals = numbers(sp.Matrix(model.constraints).jacobian(model.coordinates), text, q)
    return np.linalg.svd(normals)[2][rank(normals) :].T


def rank(matrix: Array) -> int:
    return int(np.linalg.matrix_rank(matrix, tol=1e-9))


def somewhere(text: str, seed: int = 0) -> Array:
    """Coordinates at random, such as the constraints allow."""
    random = np.random.default_rng(seed)
    size = len(motion_of(text).model.coordinates)
    if text == "direction_cosines":
        return Rotation.random(rng=random).as_matrix().ravel()
    q = random.uniform(-2, 2, size)
    bound = {"unit_quaternion": 4, "axis_angle": 3}.get(text, 0)
    q[:bound] /= np.linalg.norm(q[:bound]) if bound else 1
    return q


def at(text: str, point: Any, k: int = 0, seed: int = 1) -> Array:
    """Coordinates at a singular point, k periods on, and otherwise anywhere."""
    q, coordinates = somewhere(text, seed), motion_of(text).model.coordinates
    for place in point.places:
        value = float(number(place.value + k * place.period, constants_of(motion_of(text))))
        if place.is_length:
            q *= value / np.linalg.norm(q)
        else:
            q[coordinates.index(place.coordinate)] = value
    return q


def numbers(matrix: sp.ImmutableMatrix, text: str, q: Array) -> Array:
    values = dict(zip(motion_of(text).model.coordinates, map(mp.mpf, q.tolist()), strict=True))
    return np.array(evaluate(matrix, values | constants_of(motion_of(text))).tolist(), float)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(text, marks=[pytest.mark.campaign] if text == UNDECIDED else [])
        for text in EVERY
    ],
)
def test_the_rank_and_the_directions_are_the_stated_ones(text):
    motion = motion_of(text)
    stated = motion.singularities
    assert stated.is_solved == (text != UNDECIDED)
    for seed in range(3):
        assert rank(rate_matrix(text, somewhere(text, seed))) == stated.rank
    for k, point in product((0, 1), stated.points):
        q = at(text, point, k=k, seed=k)
        matrix, basis = rate_matrix(text, q), allowed(text, q)
        assert rank(matrix) == point.rank
        idle = numbers(point.null_rates, text, q)
        assert rank(idle) == basis.shape[1] - point.rank
        np.testing.assert_allclose(basis @ (basis.T @ idle), idle, atol=1e-9)
        np.testing.assert_allclose(matrix @ basis.T @ idle, 0, atol=1e-9)
        if point.lost_axis_space is not None:
            lost = numbers(point.lost_axis_space, text, q)
            assert np.linalg.norm(lost) > 1e-3
            np.testing.assert_allclose(lost.T @ matrix, 0, atol=1e-9)
            R = numbers(motion.rotation_matrix, text, q)
            turned = R if motion.model.passive else R.T
            in_body = numbers(point.lost_axis_body, text, q)
            # a period on, the stated vector may point the other way along the same line
            same_way = np.sign(np.vdot(turned @ lost, in_body)) if k else 1.0
            np.testing.assert_allclose(same_way * turned @ lost, in_body, atol=1e-9)
        if point.reachable_axis is not None:
            assert point.rank == 1
            reached = numbers(point.reachable_axis, text, q)
            assert rank(np.hstack([matrix, reached])) == 1


@pytest.mark.parametrize("text", [text for text in TURNS if text != UNDECIDED])
def test_on_a_grid_the_rank_falls_at_the_stated_points_only(text):
    """Eighths of a turn, through a whole period, of those coordinates that lie inside."""
    stated = motion_of(text).singularities
    coordinates = motion_of(text).model.coordinates
    periods = dict.fromkeys(coordinates, 2 * np.pi)
    periods |= {p.coordinate: float(p.period) for s in stated.points for p in s.places}
    inside = coordinates[1:-1] if len(coordinates) > 3 else coordinates[1:]
    steps = [np.arange(0.0, periods[q] - 1e-9, np.pi / 4) for q in inside]
    per_turn = np.array([2 * np.pi / periods[q] for q in coordinates])
    for values in product(*steps):
        q = np.array([0.3, *values, 0.4])[: len(coordinates)]
        is_stated = False
        for point in stated.points:
            fixed = [coordinates.index(place.coordinate) for place in point.places]
            away = ((q - at(text, point)) * per_turn)[fixed]
            is_stated |= bool(fixed) and np.allclose(np.exp(1j * away), 1)
        assert (rank(rate_matrix(text, q)) < stated.rank) == is_stated, q


@pytest.mark.parametrize("text", [*PARAMETRISATIONS, *TURNS[:2], *TURNS[-5::2]])
def test_kernels_give_a_margin_and_no_huge_rates(text):
    """|det W| up to a factor, or the product of the singular values of W; zero at the points."""
    motion, eps = motion_of(text), 2.0**-52
    kernels, stated = motion.kernels().load(), motion.singularities
    constants = [float(constants_of(motion)[s]) for s in motion.model.constants]

    def evaluated(name, q):
        inputs = {"q": q, "parameters": constants}
        inputs |= {key: [0.7, -1.1, 0.4] for key in ("omega_space", "omega_body")}
        function = getattr(kernels, name)
        words = function.__code__.co_varnames[: function.__code__.co_argcount]
        return function(*(np.asarray(inputs[word], float) for word in words))

    has_margin = any(point.places for point in stated.points) or not stated.is_solved
    assert hasattr(kernels, "singularity_margin") == has_margin
    if not has_margin:
        return
    for place, point in enumerate(stated.points):
        q = at(text, point, seed=place)
        assert 0 <= evaluated("singularity_margin", q) <= 40 * eps
        for name in INVERSES if stated.rank == 3 else ():
            values = evaluated(name, q)
            assert np.isnan(values).any(), (q, values)
            assert np.abs(values[~np.isnan(values)]).max(initial=0) < 100, (q, values)
    ratios = []
    for q in (somewhere(text, seed) for seed in range(4)):
        volume = np.prod(np.linalg.svd(rate_matrix(text, q))[1])
        ratios.append(evaluated("singularity_margin", q) / volume)
    np.testing.assert_allclose(ratios, ratios[0], rtol=300 * eps)


phi, theta = map(time_function, ("phi", "theta"))
ROOTS = (sp.sqrt(2), sp.sqrt(3))


def zeros(expression: sp.Expr) -> tuple[list[dict[sp.Expr, sp.Expr]], bool]:
    codec = codec_for([expression, *ROOTS], order=0)
    found, is_complete = solver_for(codec, (phi, theta)).common([codec.encode(expression)])
    places = [[root.place for root in zero] for zero in found]
    return [{place.coordinate: place.value for place in zero} for zero in places], is_complete


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
