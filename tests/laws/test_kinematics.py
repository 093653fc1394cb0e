"""The laws of rotation, over all 24 conventions, active and passive, at 50 digits.

They are asked of the printed expressions, and not of the ring that they come from.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

from helpers.witness import (
    CONVENTIONS,
    Path,
    Values,
    agree,
    derivative,
    evaluate,
    hat,
    mp,
    paths,
    values_along,
)
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.kinematics.derive import derive
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


class Case:
    """One convention: its derivation, and that derivation in numbers at a few points."""

    def __init__(self, convention: str, *, passive: bool) -> None:
        self.convention = convention
        self.passive = passive

    def __repr__(self) -> str:
        return f"{self.convention}-{'passive' if self.passive else 'active'}"

    @cached_property
    def motion(self) -> Derivation:
        return derive(EulerAngles(self.convention, passive=self.passive))

    @cached_property
    def points(self) -> tuple[Point, ...]:
        return tuple(Point(self, path) for path in paths(2))


@dataclass(frozen=True)
class Point:
    """The quantities of a derivation in numbers, as attributes."""

    case: Case
    path: Path

    def values(self, t=0) -> Values:
        return values_along(self.case.motion.model.coordinates, self.path, t)

    def __getattr__(self, name):
        if name not in QUANTITIES:
            raise AttributeError(name)
        return evaluate(getattr(self.case.motion, name), self.values())

    @property
    def R(self):
        """Body to space, whichever of R and its transpose is presented."""
        return self.rotation_matrix.T if self.case.passive else self.rotation_matrix

    @property
    def q_dot(self):
        return mp.matrix(self.path.q_dot)


CASES = [Case(name, passive=passive) for name in CONVENTIONS for passive in (False, True)]
every_case = pytest.mark.parametrize("case", CASES, ids=repr)
in_both_frames = pytest.mark.parametrize("frame", FRAMES)
ONE = mp.eye(3)


def test_the_catalogue_is_whole():
    assert len(set(CONVENTIONS)) == 24
    assert len(CASES) == 48


@every_case
def test_every_quantity_is_there_and_every_step_is_proved(case):
    steps = case.motion.steps
    assert tuple(step.quantity.name for step in steps) == QUANTITIES
    assert [step.number for step in steps] == list(range(1, 14))
    assert all(step.proofs for step in steps)
    assert all(proof.status == "exact" and proof.residual is None for proof in case.motion.proofs)
    assert case.motion.is_proved


@every_case
def test_matrix_is_orthogonal_with_determinant_one(case):
    for point in case.points:
        assert agree(point.rotation_matrix * point.rotation_matrix.T, ONE)
        assert abs(mp.det(point.rotation_matrix) - 1) < mp.mpf(10) ** -40


@every_case
def test_rate_is_the_derivative_of_the_matrix(case):
    for point in case.points:
        moving = derivative(lambda t, p=point: evaluate(case.motion.rotation_matrix, p.values(t)))
        assert agree(point.rotation_rate, moving)


@every_case
def test_spin_is_skew_and_is_the_product_it_is_named_after(case):
    for point in case.points:
        spin = point.spin_matrix
        assert agree(spin, -spin.T)
        assert agree(spin, point.rotation_rate * point.rotation_matrix.T)


@every_case
def test_spin_is_the_operator_of_the_angular_velocity(case):
    """dR/dt Rᵀ = C(Ω), and dA/dt Aᵀ = −C(Ω′) for the direction cosines."""
    for point in case.points:
        if case.passive:
            assert agree(point.spin_matrix, -hat(point.angular_velocity_body))
        else:
            assert agree(point.spin_matrix, hat(point.angular_velocity_space))


@every_case
def test_space_and_body_components_are_one_vector(case):
    for point in case.points:
        assert agree(point.R * point.angular_velocity_body, point.angular_velocity_space)
        assert agree(point.R * point.angular_acceleration_body, point.angular_acceleration_space)
        assert agree(point.R * point.rate_matrix_body, point.rate_matrix_space)


@every_case
@in_both_frames
def test_rate_matrix_maps_rates_to_velocity_and_back(case, frame):
    for point in case.points:
        matrix = getattr(point, f"rate_matrix_{frame}")
        inverse = getattr(point, f"inverse_rate_matrix_{frame}")
        omega = getattr(point, f"angular_velocity_{frame}")
        assert agree(matrix * point.q_dot, omega)
        assert agree(inverse * omega, point.q_dot)
        assert agree(matrix * inverse, ONE)
        assert agree(inverse * matrix, ONE)


@every_case
@in_both_frames
def test_rates_from_a_given_velocity_are_the_rates(case, frame):
    given = case.motion.argument(f"omega_{frame}").symbols
    formula = getattr(case.motion, f"rates_from_angular_velocity_{frame}")
    assert formula.free_symbols <= {*given, sp.Symbol("t")}
    for point in case.points:
        omega = getattr(point, f"angular_velocity_{frame}")
        values = {**point.values(), **dict(zip(given, omega, strict=True))}
        assert agree(evaluate(formula, values), point.q_dot)


@every_case
@in_both_frames
def test_acceleration_is_the_derivative_of_the_velocity(case, frame):
    """In the body too: the components of dΩ/dt there are the derivatives of those of Ω′."""
    formula = getattr(case.motion, f"angular_velocity_{frame}")
    for point in case.points:
        moving = derivative(lambda t, p=point: evaluate(formula, p.values(t)))
        assert agree(getattr(point, f"angular_acceleration_{frame}"), moving)


def numpy_rank(matrix) -> int:
    return int(np.linalg.matrix_rank(np.array(matrix.tolist(), dtype=float), tol=1e-9))


def at_singularity(point: Point, singular):
    """A point of a path, moved to the singular angle."""
    (place,) = singular.places
    return {**point.values(), place.coordinate: evaluate(sp.Matrix([place.value]), {})[0]}


@every_case
def test_rank_at_the_stated_angles_is_the_stated_rank(case):
    for point in case.points:
        assert numpy_rank(point.rate_matrix_space) == 3
        for singular in case.motion.singularities.points:
            values = at_singularity(point, singular)
            for frame in FRAMES:
                matrix = evaluate(getattr(case.motion, f"rate_matrix_{frame}"), values)
                assert numpy_rank(matrix) == singular.rank == 2


@every_case
def test_lost_direction_is_out_of_reach_in_both_frames(case):
    for point in case.points:
        for singular in case.motion.singularities.points:
            values = at_singularity(point, singular)
            R = evaluate(case.motion.rotation_matrix, values)
            lost = evaluate(singular.lost_space, values)
            lost_body = evaluate(singular.lost_body, values)
            assert mp.norm(lost) > 1e-9
            assert agree((R if case.passive else R.T) * lost, lost_body)
            for frame, direction in (("space", lost), ("body", lost_body)):
                matrix = evaluate(getattr(case.motion, f"rate_matrix_{frame}"), values)
                assert agree(direction.T * matrix, mp.zeros(1, 3))


@every_case
def test_undetermined_rates_turn_nothing(case):
    for point in case.points:
        for singular in case.motion.singularities.points:
            values = at_singularity(point, singular)
            idle = evaluate(singular.undetermined, values)
            assert mp.norm(idle) > 1e-9
            for frame in FRAMES:
                matrix = evaluate(getattr(case.motion, f"rate_matrix_{frame}"), values)
                assert agree(matrix * idle, mp.zeros(3, 1))


@every_case
def test_determinant_is_that_of_both_rate_matrices(case):
    determinant = sp.Matrix([case.motion.singularities.determinant])
    for point in case.points:
        value = evaluate(determinant, point.values())[0]
        for frame in FRAMES:
            matrix = getattr(point, f"rate_matrix_{frame}")
            assert abs(mp.det(matrix) - value) < mp.mpf(10) ** -40


@every_case
def test_the_stated_angles_are_all(case):
    """Between them the determinant keeps its sign, so that a count of changes finds them all."""
    found = case.motion.singularities
    middle = case.motion.model.coordinates[1]
    assert found.is_solved
    assert found.determinant.atoms(sp.Function) <= {middle, sp.sin(middle), sp.cos(middle)}
    half = sp.pi / 2
    first, last = case.convention.lower()[0], case.convention.lower()[2]
    expected = {0, sp.pi} if first == last else {-half, half}
    places = [place for point in found.points for place in point.places]
    assert {place.value for place in places} == expected
    assert {place.coordinate for place in places} == {middle}
    assert {place.period for place in places} == {2 * sp.pi}
    grid = [2 * mp.pi * (k + mp.mpf(1) / 3) / 97 for k in range(98)]
    signs = [
        mp.sign(evaluate(sp.Matrix([found.determinant]), {middle: angle})[0]) for angle in grid
    ]
    changes = sum(a != b for a, b in pairwise(signs))
    assert changes == len(found.points)


@every_case
@in_both_frames
def test_velocity_is_short(case, frame):
    """At most 36 operations, the best that other tools reach in their better frame."""
    assert sp.count_ops(getattr(case.motion, f"angular_velocity_{frame}")) <= 36


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_fixed_axes_are_turning_axes_in_the_opposite_order(convention):
    angles = ("alpha", "beta", "gamma")
    one = derive(EulerAngles(convention, angles))
    other = derive(EulerAngles(convention[::-1].swapcase(), angles[::-1]))
    assert one.rotation_matrix == other.rotation_matrix
    assert one.spin_matrix == other.spin_matrix
    assert one.angular_velocity_body == other.angular_velocity_body


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_passive_presents_the_transpose_and_leaves_the_velocities(convention):
    active = derive(EulerAngles(convention))
    passive = derive(EulerAngles(convention, passive=True))
    assert passive.rotation_matrix == active.rotation_matrix.T
    assert passive.rotation_rate == active.rotation_rate.T
    for name in QUANTITIES[3:]:
        assert getattr(passive, name) == getattr(active, name)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_opposite_angles_in_the_opposite_order_undo_the_rotation(convention):
    forth = derive(EulerAngles(convention)).rotation_matrix
    back = derive(EulerAngles(convention[::-1], ("psi", "theta", "phi"))).rotation_matrix
    (path,) = paths(1)
    coordinates = EulerAngles(convention).coordinates
    there = dict(zip(coordinates, path.q, strict=True))
    reversed_turns = {coordinate: -value for coordinate, value in there.items()}
    assert agree(evaluate(forth, there) * evaluate(back, reversed_turns), ONE)
