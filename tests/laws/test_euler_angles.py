"""What holds for the 24 conventions of Euler angles: singular angles, short forms, kinship."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

from helpers.motions import derived
from helpers.parametrisations import MOVING, Moving
from helpers.witness import CONVENTIONS, agree, evaluate, mp, number
from rigidsym.mechanics.derive import derive
from rigidsym.models.euler_angles import EulerAngles

FRAMES = ("space", "body")
QUANTITIES = (
    "rotation_matrix",
    "rotation_rate",
    "spin_matrix",
    "angular_velocity_space",
    "angular_velocity_body",
    "rate_matrix_space",
    "inverse_rate_matrix_space",
    "rates_from_angular_velocity_space",
    "rate_matrix_body",
    "inverse_rate_matrix_body",
    "rates_from_angular_velocity_body",
    "angular_acceleration_space",
    "angular_acceleration_body",
)
POINTS = [m for m in MOVING if m.text in CONVENTIONS]
every_point = pytest.mark.parametrize("m", POINTS, ids=repr)
every_case = pytest.mark.parametrize("m", [m for m in POINTS if not m.point], ids=repr)
every_convention = pytest.mark.parametrize("convention", CONVENTIONS)
in_both_frames = pytest.mark.parametrize("frame", FRAMES)


@every_case
def test_every_quantity_is_there_and_every_step_is_proved(m: Moving):
    steps = m.motion.steps
    assert tuple(step.quantity.name for step in steps) == QUANTITIES
    assert [step.number for step in steps] == list(range(1, 14))
    assert all(step.proofs for step in steps)
    assert all(proof.status == "exact" and proof.residual is None for proof in m.motion.proofs)


@every_case
@in_both_frames
def test_rates_from_a_velocity_speak_of_the_velocity_only(m: Moving, frame: str):
    given = m.motion.argument(f"omega_{frame}").symbols
    formula = m.motion.step(f"rates_from_angular_velocity_{frame}").expression
    assert formula.free_symbols <= {*given, sp.Symbol("t")}


# Singular angles


def rank(matrix) -> int:
    return int(np.linalg.matrix_rank(np.array(matrix.tolist(), dtype=float), tol=1e-9))


def singular_points(m: Moving):
    """(what is said of a singular angle, the values of this point moved to that angle)."""
    for singular in m.motion.singularities.points:
        (place,) = singular.places
        yield singular, m.values | {place.coordinate: number(place.value, {})}


def rate_matrix(m: Moving, frame: str, values):
    return evaluate(m.motion.step(f"rate_matrix_{frame}").expression, values)


@every_point
def test_rank_at_the_stated_angles_is_the_stated_rank(m: Moving):
    assert rank(m.rate_matrix_space) == 3
    for singular, values in singular_points(m):
        for frame in FRAMES:
            assert rank(rate_matrix(m, frame, values)) == singular.rank == 2


@every_point
def test_lost_direction_is_out_of_reach_in_both_frames(m: Moving):
    for singular, values in singular_points(m):
        R = evaluate(m.motion.rotation_matrix, values)
        lost = evaluate(singular.lost_axis_space, values)
        lost_body = evaluate(singular.lost_axis_body, values)
        assert mp.norm(lost) > 1e-9
        assert agree((R if m.is_passive else R.T) * lost, lost_body)
        for frame, direction in (("space", lost), ("body", lost_body)):
            assert agree(direction.T * rate_matrix(m, frame, values), mp.zeros(1, 3))


@every_point
def test_undetermined_rates_turn_nothing(m: Moving):
    for singular, values in singular_points(m):
        idle = evaluate(singular.null_rates, values)
        assert mp.norm(idle) > 1e-9
        for frame in FRAMES:
            assert agree(rate_matrix(m, frame, values) * idle, mp.zeros(3, 1))


@every_point
def test_determinant_is_that_of_both_rate_matrices(m: Moving):
    value = number(m.motion.singularities.determinant, dict(m.values))
    for matrix in (m.rate_matrix_space, m.rate_matrix_body):
        assert abs(mp.det(matrix) - value) < mp.mpf(10) ** -40


@every_case
def test_the_stated_angles_are_all(m: Moving):
    """Between them the determinant keeps its sign, so that a count of changes finds them all."""
    found = m.motion.singularities
    middle = m.motion.model.coordinates[1]
    assert found.is_solved
    assert found.determinant.atoms(sp.Function) <= {middle, sp.sin(middle), sp.cos(middle)}
    half = sp.pi / 2
    first, _, last = m.text.lower()
    expected = {0, sp.pi} if first == last else {-half, half}
    places = [place for point in found.points for place in point.places]
    assert {place.value for place in places} == expected
    assert {place.coordinate for place in places} == {middle}
    assert {place.period for place in places} == {2 * sp.pi}
    grid = [2 * mp.pi * (k + mp.mpf(1) / 3) / 97 for k in range(98)]
    signs = [mp.sign(number(found.determinant, {middle: angle})) for angle in grid]
    changes = sum(a != b for a, b in pairwise(signs))
    assert changes == len(found.points)


# Forms


@every_case
@in_both_frames
def test_velocity_is_short(m: Moving, frame: str):
    """At most 36 operations, the best that other tools reach in their better frame."""
    assert sp.count_ops(m.motion.step(f"angular_velocity_{frame}").expression) <= 36


@every_convention
def test_fixed_axes_are_turning_axes_in_the_opposite_order(convention: str):
    angles = ("alpha", "beta", "gamma")
    one = derive(EulerAngles(convention, angles))
    other = derive(EulerAngles(convention[::-1].swapcase(), angles[::-1]))
    assert one.rotation_matrix == other.rotation_matrix
    assert one.spin_matrix == other.spin_matrix
    assert one.angular_velocity_body == other.angular_velocity_body


@every_convention
def test_passive_presents_the_transpose_and_leaves_the_velocities(convention: str):
    active = derived(convention)
    passive = derived(convention, passive=True)
    assert passive.rotation_matrix == active.rotation_matrix.T
    assert passive.rotation_rate == active.rotation_rate.T
    for name in QUANTITIES[3:]:
        assert getattr(passive, name) == getattr(active, name)
