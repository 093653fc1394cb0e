"""Singular orientations, for every rotation: ranks, directions and completeness, by numbers.

The witness builds R and the rate matrix from exponentials of skew matrices and differences.
"""

from __future__ import annotations

import json
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

from helpers.parametrisations import CHAINS, WITNESSES, constants_of, motion_of
from helpers.witness import evaluate, mp, number
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.notes.formats.record import record

Array = np.ndarray[Any, Any]

MORE_CHAINS = (
    "z(phi) y(2*theta/3) x(psi)",
    "z(phi) x(theta + alpha0) z(psi)",
    "z(phi) x(theta) [1,2,2](psi)",
    "z(phi) x(theta) z(theta)",
    "x(a) z(b + pi/4) x(c) y(d)",
    "z(a) z(b)",
)
TURNS = ("ZXZ", "zyx", "aerospace", *CHAINS, *MORE_CHAINS)
EVERY = (*PARAMETRISATIONS, *TURNS)
UNDECIDED = (
    "z(phi) [a,b,c](beta) [1,2,2](psi)",  # a cosine and a sine by any constants
    "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5)",  # five turns: W is not multiplied out
)


@cache
def turns_of(text: str) -> tuple[tuple[Array, Array, float], ...]:
    """Axis, the multiples of the coordinates in its angle, and what is added, of each turn."""
    motion = motion_of(text)
    model, constants = motion.model, constants_of(motion)
    found = []
    for turn in model.turns:
        axis = np.array([float(number(sp.sympify(e), dict(constants))) for e in turn.direction])
        weights = [float(sp.diff(turn.angle, q)) for q in model.coordinates]
        rest = turn.angle.xreplace(dict.fromkeys(model.coordinates, sp.S.Zero))
        found.append((axis, np.array(weights), float(number(rest, dict(constants)))))
    return tuple(found)


def rate_matrix(text: str, q: Array) -> Array:
    """W of the rates that the constraints allow, one column for each of them."""
    if text in WITNESSES:
        return by_differences(text, q)
    turned, result = Rotation.identity(), np.zeros((3, len(q)))
    for axis, weights, rest in turns_of(text):
        result += np.outer(turned.apply(axis), weights)
        turned = turned * Rotation.from_rotvec(axis * (weights @ q + rest))
    return result


def by_differences(text: str, q: Array) -> Array:
    """Columns (∂R Rᵀ)∨ along an orthonormal basis of the allowed rates, at 50 digits."""
    _, build = WITNESSES[text]
    columns, point, step = [], [mp.mpf(float(x)) for x in q], mp.mpf(10) ** -20
    here = build(point)
    for direction in allowed(text, q).T:
        ahead = build([x + step * float(d) for x, d in zip(point, direction, strict=True)])
        spin = (ahead - here) * here.T / step
        columns.append([float(spin[i, j] - spin[j, i]) / 2 for i, j in ((2, 1), (0, 2), (1, 0))])
    return np.array(columns).T


def allowed(text: str, q: Array) -> Array:
    """An orthonormal basis, in columns, of the rates that keep to the constraints."""
    if text == "unit_quaternion":
        normals = q[None, :]
    elif text == "axis_angle":
        normals = np.array([[*q[:3], 0.0]])
    elif text == "direction_cosines":
        rows = q.reshape(3, 3)
        pairs = [(i, j) for i in range(3) for j in range(i, 3)]
        normals = np.zeros((6, 9))
        for place, (i, j) in enumerate(pairs):
            normals[place, 3 * i : 3 * i + 3] += rows[j]
            normals[place, 3 * j : 3 * j + 3] += rows[i]
    else:
        return np.eye(len(q))
    return np.linalg.svd(normals)[2][len(normals) :].T


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


@pytest.mark.parametrize("text", EVERY)
def test_away_from_the_points_the_rank_is_the_stated_one(text):
    found = motion_of(text).singularities
    assert found.is_solved == (text not in UNDECIDED)
    for seed in range(5):
        assert rank(rate_matrix(text, somewhere(text, seed))) == found.rank


@pytest.mark.parametrize("text", EVERY)
def test_at_the_points_the_rank_and_the_directions_are_the_stated_ones(text):
    motion = motion_of(text)
    for k, point in product((0, 1), motion.singularities.points):
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


EIGHTHS = np.arange(-4, 4) * (np.pi / 4)


@pytest.mark.parametrize("text", [text for text in TURNS if text not in UNDECIDED])
def test_on_a_grid_the_rank_falls_at_the_stated_points_alone(text):
    """Eighths of a turn, through a whole period, of those coordinates that lie inside."""
    found = motion_of(text).singularities
    coordinates = motion_of(text).model.coordinates
    periods = {place.coordinate: place.period for p in found.points for place in p.places}
    inside = coordinates[1:-1] if len(coordinates) > 3 else coordinates[1:]
    steps = [EIGHTHS if q not in periods else grid(periods[q]) for q in inside]
    stated = [at(text, point) for point in found.points if point.places]
    fixed = [[coordinates.index(place.coordinate) for place in p.places] for p in found.points]
    for values in product(*steps):
        q = np.array([0.3, *values, 0.4])[: len(coordinates)]
        is_stated = any(
            np.allclose(np.exp(1j * (q - s)[places] * scale(periods, coordinates, places)), 1)
            for s, places in zip(stated, fixed, strict=False)
        )
        assert (rank(rate_matrix(text, q)) < found.rank) == is_stated, q


def grid(period: sp.Expr) -> Array:
    return np.arange(float(period / (sp.pi / 4))) * (np.pi / 4)


def scale(periods: dict[sp.Expr, sp.Expr], coordinates: Any, places: list[int]) -> Array:
    """What makes the period of each coordinate a whole turn."""
    return np.array([float(2 * sp.pi / periods[coordinates[place]]) for place in places])


@pytest.mark.parametrize("angle", np.arange(-9, 27) * (np.pi / 4))
def test_rotation_vector_and_axis_fail_at_whole_turns_alone(angle):
    axis, is_whole = np.array([2, -1, 2]) / 3, np.isclose(np.cos(angle), 1)
    assert rank(rate_matrix("axis_angle", np.array([*axis, angle]))) == (1 if is_whole else 3)
    is_whole &= angle != 0
    assert rank(rate_matrix("rotation_vector", axis * angle)) == (1 if is_whole else 3)


def test_the_record_says_where_the_rotation_vector_fails():
    """At 2π, 4π, ..., but not at 0: a value modulo 2π with a least one."""
    found = json.loads(json.dumps(record(motion_of("rotation_vector"), {})))["singularities"]
    (point,) = found["points"]
    length = "sqrt(v1**2 + v2**2 + v3**2)"
    whole = dict.fromkeys(("value", "modulo", "least"), "2*pi")
    assert point["at"] == [{"coordinate": length, **whole}]
    assert point["rank"] == 1
    assert found["measure"] == "det W"
    halves = record(motion_of("z(phi) x(theta/2) z(psi)"), {})["singularities"]["points"]
    assert [point["at"][0]["modulo"] for point in halves] == ["4*pi", "4*pi"]
    assert [point["at"][0]["least"] for point in halves] == [None, None]


# Kernels.


def moving(text: str) -> bool:
    found = motion_of(text).singularities
    return any(point.places for point in found.points) or not found.is_solved


@cache
def kernels(text: str) -> Any:
    return motion_of(text).kernels().load()


def arguments(text: str, name: str, q: Array, dtype: Any) -> list[Array]:
    """Coordinates, constants and a given angular velocity, as far as the function takes them."""
    constants = [float(constants_of(motion_of(text))[s]) for s in motion_of(text).model.constants]
    omega = {key: [0.7, -1.1, 0.4] for key in ("omega_space", "omega_body")}
    inputs = {"q": q, "parameters": constants, **omega}
    code = getattr(kernels(text), name).__code__
    return [np.asarray(inputs[word], dtype) for word in code.co_varnames[: code.co_argcount]]


@pytest.mark.parametrize("text", EVERY)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_margin_is_zero_at_the_points_and_a_volume_elsewhere(text, dtype):
    """|det W| up to a factor, or the product of the singular values of W; none for nothing."""
    assert hasattr(kernels(text), "singularity_margin") == moving(text)
    if not moving(text):
        return
    eps = float(np.finfo(dtype).eps)
    margin = kernels(text).singularity_margin
    for point in motion_of(text).singularities.points:
        given = arguments(text, "singularity_margin", at(text, point), dtype)
        assert 0 <= margin(*given) <= 40 * eps
    ratios = []
    for seed in range(4):
        q = somewhere(text, seed)
        found = float(margin(*arguments(text, "singularity_margin", q, dtype)))
        ratios.append(found / np.prod(np.linalg.svd(rate_matrix(text, q))[1]))
    np.testing.assert_allclose(ratios, ratios[0], rtol=300 * eps)


INVERSES = [
    f"{name}_{frame}"
    for name in ("inverse_rate_matrix", "rates_from_angular_velocity")
    for frame in ("space", "body")
]


@pytest.mark.parametrize("text", EVERY)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_at_the_points_rates_are_nan_and_never_huge(text, dtype):
    found = motion_of(text).singularities
    for place, point in enumerate(found.points if found.rank == 3 else ()):
        q = at(text, point, seed=place)
        for name in INVERSES:
            values = getattr(kernels(text), name)(*arguments(text, name, q, dtype))
            assert np.isnan(values).any(), (q, values)
            assert np.abs(values[~np.isnan(values)]).max(initial=0) < 100, (q, values)
