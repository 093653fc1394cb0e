"""The laws of rotation, for every rotation that the package knows.

A rotation R(q) takes components along the axes of the body to components along the axes of space:
x = R x′. As the coordinates q(t) move, the body turns with the angular velocity Ω, or Ω′ = Rᵀ Ω
along its own axes.

Below, `m` is a rotation on its way. Its attributes are what the derivation prints, in numbers of
50 digits; `m.turned` is the same rotation built from textbook matrices, exponentials or products
of quaternions by code that shares nothing with the package. "Agree" means to 40 digits.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from sympy.physics.vector import ReferenceFrame

from helpers.parametrisations import MOVING, Moving
from helpers.witness import CONVENTIONS, agree, evaluate, hat, mp, number
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.singularities import singularities_of

ONE = mp.eye(3)
every_rotation = pytest.mark.parametrize("m", MOVING, ids=repr)
in_both_frames = pytest.mark.parametrize("frame", ["space", "body"])


@every_rotation
def test_every_step_is_proved(m: Moving):
    assert m.motion.is_proved
    assert all(step.proofs for step in m.motion.steps)


@every_rotation
def test_the_matrix_is_the_rotation_of_its_name(m: Moving):
    """R = R_z(φ) R_x(θ) R_z(ψ) for ZXZ, R x = q x q* for a quaternion q, ..."""
    assert agree(m.R, m.turned)


@every_rotation
def test_the_rate_of_the_matrix_is_its_derivative_along_the_path(m: Moving):
    """Ṙ = dR(q(t))/dt"""
    assert agree(m.rotation_rate.T if m.is_passive else m.rotation_rate, m.turned_rate)


@every_rotation
def test_spin_is_the_operator_of_the_angular_velocity(m: Moving):
    """dR/dt Rᵀ = C(Ω), where C(u) v = u × v; and dA/dt Aᵀ = −C(Ω′) for A = Rᵀ"""
    assert agree(m.spin_matrix, m.rotation_rate * m.rotation_matrix.T)
    if m.is_passive:
        assert agree(m.spin_matrix, -hat(m.angular_velocity_body))
    else:
        assert agree(m.spin_matrix, hat(m.angular_velocity_space))


@every_rotation
def test_angular_velocity_is_that_of_the_turning_body(m: Moving):
    """C(Ω) = dR/dt Rᵀ of the rotation built by other means"""
    assert agree(m.angular_velocity_space, m.turned_velocity)


@every_rotation
def test_space_and_body_components_are_one_vector(m: Moving):
    """Ω = R Ω′, dΩ/dt = R dΩ′/dt, and W = R W′ (not for direction cosines: their nine
    rates are not free, and many W say the same of them)
    """
    assert agree(m.angular_velocity_space, m.R * m.angular_velocity_body)
    assert agree(m.angular_acceleration_space, m.R * m.angular_acceleration_body)
    if m.text != "direction_cosines":
        assert agree(m.rate_matrix_space, m.R * m.rate_matrix_body)


@every_rotation
def test_angular_acceleration_is_the_derivative_of_the_velocity(m: Moving):
    """dΩ/dt, from the second derivative of R"""
    assert agree(m.angular_acceleration_space, m.turned_acceleration)


@every_rotation
@in_both_frames
def test_rate_matrix_takes_rates_to_the_velocity(m: Moving, frame: str):
    """W q̇ = Ω"""
    velocity = getattr(m, f"angular_velocity_{frame}")
    assert agree(getattr(m, f"rate_matrix_{frame}") * m.argument("q_dot"), velocity)


@every_rotation
@in_both_frames
def test_inverse_rate_matrix_is_the_inverse(m: Moving, frame: str):
    """W W⁻¹ = 1, and W⁻¹ W = 1 for three coordinates; fewer have no inverse"""
    assert m.has(f"inverse_rate_matrix_{frame}") == m.has_inverse
    if m.has(f"inverse_rate_matrix_{frame}"):
        matrix = getattr(m, f"rate_matrix_{frame}")
        inverse = getattr(m, f"inverse_rate_matrix_{frame}")
        assert agree(matrix * inverse, ONE)
        assert matrix.cols > 3 or agree(inverse * matrix, ONE)


@every_rotation
@in_both_frames
def test_rates_from_a_velocity_give_that_velocity_back(m: Moving, frame: str):
    """W q̇ = Ω for the rates q̇ found from Ω; the shortest, if four coordinates leave a choice"""
    name = f"rates_from_angular_velocity_{frame}"
    assert m.has(name) == m.has_inverse
    if m.has(name):
        velocity = getattr(m, f"angular_velocity_{frame}")
        found = m.at(name, **{f"omega_{frame}": velocity})
        assert agree(getattr(m, f"rate_matrix_{frame}") * found, velocity)
        assert agree(found.T * (m.argument("q_dot") - found), mp.matrix([0]))
        assert agree(m.at("spin_matrix", q_dot=found), m.spin_matrix)


CONVENTIONAL = [m for m in MOVING if m.text in CONVENTIONS]
ACTIVE = [m for m in CONVENTIONAL if not m.passive]
every_convention = pytest.mark.parametrize("m", CONVENTIONAL, ids=repr)


@pytest.mark.parametrize("m", ACTIVE, ids=repr)
def test_scipy_and_sympy_have_the_same_rotation_and_velocities(m: Moving):
    """SciPy's error: up to 5 eps by rounding three angles of up to 3, 12 by two products of
    quaternions with their sines, which count twice, and 2 by the entries; one eps was seen.
    """
    angles = m.motion.model.coordinates
    theirs = Rotation.from_euler(m.text, [float(m.values[q]) for q in angles]).as_matrix()
    assert np.abs(np.array(m.R.tolist(), float) - theirs).max() <= 20 * np.finfo(float).eps
    space = ReferenceFrame("N")
    manner = "Body" if m.text.isupper() else "Space"
    body = space.orientnew("B", manner, angles, m.text.upper())
    omega = body.ang_vel_in(space)
    theirs = {
        "rotation_matrix": space.dcm(body),
        "angular_velocity_space": omega.to_matrix(space),
        "angular_velocity_body": omega.to_matrix(body),
    }
    for quantity, expression in theirs.items():
        assert sp.count_ops(getattr(m.motion, quantity)) <= sp.count_ops(expression)
        assert agree(getattr(m, quantity), evaluate(expression, m.values))


def test_the_witness_tells_the_conventions_apart():
    for some in ([m.turned for m in ACTIVE], [m.turned_velocity for m in ACTIVE]):
        for k, one in enumerate(some):
            assert not any(agree(one, other) for other in some[:k])


@every_convention
def test_determinant_is_that_of_both_rate_matrices(m: Moving):
    value = number(m.motion.singularities.determinant, dict(m.values))
    for matrix in (m.rate_matrix_space, m.rate_matrix_body):
        assert abs(mp.det(matrix) - value) < mp.mpf(10) ** -40


@every_convention
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
    assert sum(a != b for a, b in pairwise(signs)) == len(found.points)


@every_convention
def test_what_conventions_share_is_what_each_derives_alone(m: Moving):
    """Twelve orders of axes have four originals; each is equal in form, whatever came before."""
    alone = Values(m.motion.model)
    for step in m.motion.steps:
        expected = alone.step(KINEMATICS[step.quantity.name])
        assert repr(step.expression) == repr(expected.expression)
        assert step.proofs == expected.proofs
        assert step.quantity.symbol == expected.quantity.symbol
    assert m.motion.singularities == singularities_of(alone)
