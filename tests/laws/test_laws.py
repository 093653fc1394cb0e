"""The laws of rotation, for every rotation that the package knows.

A rotation R(q) takes components along the axes of the body to components along the axes of space:
x = R x′. As the coordinates q(t) move, the body turns with the angular velocity Ω, or Ω′ = Rᵀ Ω
along its own axes.

Below, `m` is a rotation on its way. Its attributes are what the derivation prints, in numbers of
50 digits; `m.turned` is the same rotation built from textbook matrices, exponentials or products
of quaternions by code that shares nothing with the package. "Agree" means to 40 digits.
"""

from __future__ import annotations

import pytest

from helpers.parametrisations import MOVING, Moving, motion_of, nearly_straight, values_on
from helpers.witness import agree, evaluate, hat, mp
from rigidsym.models.parametrisations import EULER_SEQUENCES

ONE = mp.eye(3)
every_rotation = pytest.mark.parametrize("m", MOVING, ids=repr)
in_both_frames = pytest.mark.parametrize("frame", ["space", "body"])


@every_rotation
def test_every_step_is_proved(m: Moving):
    assert m.motion.is_proved
    assert all(step.proofs for step in m.motion.steps)


# The rotation


@every_rotation
def test_the_matrix_is_orthogonal(m: Moving):
    """R Rᵀ = 1"""
    assert agree(m.R * m.R.T, ONE)


@every_rotation
def test_the_matrix_does_not_mirror(m: Moving):
    """det R = 1"""
    assert agree(mp.matrix([mp.det(m.R)]), mp.matrix([1]))


@every_rotation
def test_the_matrix_is_the_rotation_of_its_name(m: Moving):
    """R = R_z(φ) R_x(θ) R_z(ψ) for ZXZ, R x = q x q* for a quaternion q, ..."""
    assert agree(m.R, m.turned)


@every_rotation
def test_the_rate_of_the_matrix_is_its_derivative_along_the_path(m: Moving):
    """Ṙ = dR(q(t))/dt"""
    assert agree(m.R_dot, m.turned_rate)


# The angular velocity


@every_rotation
def test_spin_is_skew(m: Moving):
    """dR/dt Rᵀ + (dR/dt Rᵀ)ᵀ = 0"""
    assert agree(m.spin_matrix, -m.spin_matrix.T)


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


# The rates of the coordinates


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


# One rotation after another

PAIRS = (
    ("z(phi)", "x(theta) z(psi)"),
    ("z(phi) x(theta)", "[1,2,2](psi)"),
    ("x(alpha0) z(phi)", "y(pi/4) x(theta)"),
    ("z(a_1) x(a_2) z(a_3)", "y(a_4) x(a_5)"),
)


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_rotations_compose(first: str, second: str):
    """R = R₁ R₂ and Ω = Ω₁ + R₁ Ω₂: turns about axes that turn along are multiplied in order"""
    whole = motion_of(f"{first} {second}")
    values = values_on(whole, nearly_straight(len(whole.model.coordinates)))

    def part(text: str, quantity: str):
        return evaluate(motion_of(text).spelled(motion_of(text).step(quantity).expression), values)

    R = [part(text, "rotation_matrix") for text in (first, second, f"{first} {second}")]
    omega = [part(text, "angular_velocity_space") for text in (first, second, f"{first} {second}")]
    assert agree(R[2], R[0] * R[1])
    assert agree(omega[2], omega[0] + R[0] * omega[1])


@pytest.mark.parametrize("sequence", EULER_SEQUENCES)
def test_turns_about_fixed_axes_are_turns_about_moving_axes_in_the_opposite_order(sequence: str):
    """xyz(α, β, γ) = ZYX(γ, β, α)"""
    fixed = Moving(sequence, passive=False)
    moving = Moving(sequence[::-1].swapcase(), passive=False)
    angles = fixed.argument("q")
    opposite = [angles[2], angles[1], angles[0]]
    assert agree(fixed.rotation_matrix, moving.at("rotation_matrix", q=opposite))


@pytest.mark.parametrize("sequence", EULER_SEQUENCES)
def test_opposite_angles_in_the_opposite_order_undo_the_rotation(sequence: str):
    """R_z(φ) R_x(θ) R_z(ψ) R_z(−ψ) R_x(−θ) R_z(−φ) = 1"""
    forth = Moving(sequence, passive=False)
    back = Moving(sequence[::-1], passive=False)
    angles = forth.argument("q")
    undoing = [-angles[2], -angles[1], -angles[0]]
    assert agree(forth.rotation_matrix * back.at("rotation_matrix", q=undoing), ONE)
