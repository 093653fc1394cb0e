"""Rotations that are not in the catalogue.

Whatever is a rotation is proved so without a change to the ring; whatever is not is refused; and
what cannot be told is marked unproved.
"""

from __future__ import annotations

import dataclasses

import pytest
import sympy as sp
from sympy import pi, sech, sin, sqrt, tanh
from sympy.printing.pretty.pretty_symbology import pretty_use_unicode

from helpers.samples import NORM, ROTATIONS, TIME, WRONG, about_z, alpha, chain, length, m, model
from helpers.witness import agree, evaluate, mp, paths, unhat, values_along
from rigidsym.errors import AlgebraError, DerivationError, ModelError, NotARotation
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.models.rotation import elementary, time_function

phi, theta, psi, u = map(time_function, ("phi", "theta", "psi", "u"))
w, x, y, z = map(time_function, "wxyz")


@pytest.mark.parametrize("name", ROTATIONS)
def test_other_rotations_are_data_and_turn_as_the_numbers_do(name):
    """Small coordinates, so that roots and tangents stay where they are real."""
    sample = ROTATIONS[name]
    motion = derive(sample)
    assert motion.is_proved
    assert hasattr(motion, "inverse_rate_matrix_space") == (motion.singularities.rank == 3)
    if sample.constraints:
        return
    (path,) = paths(1, size=len(sample.coordinates), seed=6)
    path = dataclasses.replace(path, q=tuple(value / 9 for value in path.q))
    constants = {m: mp.mpf(3) / 7, length: mp.mpf(5) / 7, alpha: mp.mpf(2) / 3}

    def R(t):
        return evaluate(sample.matrix, {**values_along(sample.coordinates, path, t), **constants})

    def printed(quantity):
        values = {**values_along(sample.coordinates, path), **constants}
        return evaluate(getattr(motion, quantity), values)

    first, second = mp.diff(R, 0), mp.diff(R, 0, 2)
    omega = unhat(first * R(0).T)
    alpha_space = unhat(second * R(0).T + first * first.T)
    assert agree(printed("angular_velocity_body"), R(0).T * omega)
    assert agree(printed("rate_matrix_space") * mp.matrix(path.q_dot), omega)
    assert agree(printed("angular_acceleration_body"), R(0).T * alpha_space)


def test_functions_of_unknown_relations_leave_the_claims_unproved():
    """It is a rotation, but the ring does not know sech² + tanh² = 1."""
    motion = derive(model(about_z(sech(u), tanh(u)), u))
    unproved = [proof for proof in motion.proofs if not proof.is_exact]
    assert not motion.is_proved
    assert {proof.claim.text for proof in unproved} >= {"R Rᵀ = 1", "det R = 1"}
    for proof in unproved:
        assert proof.status == "unproved"
        values = {**values_along([u], paths(1, size=1)[0]), TIME: mp.mpf(0)}
        assert proof.residual is not None
        assert not proof.residual.is_zero_matrix
        assert agree(evaluate(proof.residual, values), mp.zeros(*proof.residual.shape))


@pytest.mark.parametrize(("sample", "claim", "residual"), WRONG.values(), ids=WRONG)
def test_what_is_no_rotation_is_refused_with_what_is_left_over(sample, claim, residual):
    with pytest.raises(NotARotation) as caught:
        derive(sample)
    message = str(caught.value)
    assert message.startswith(f"sample: not a rotation, since {claim} fails; left over: ")
    assert residual in message.split("left over: ", 1)[1]


@pytest.mark.parametrize(
    ("factor", "constraint"),
    [
        (sqrt(4 * x**2 + 4 * y**2 + 4 * z**2) / (2 * NORM), w - phi),  # dependent roots
        (w, (w - 1) ** 2),  # w = 1, which is not in the ideal that it spans
    ],
)
def test_what_the_ring_does_not_know_refutes_no_rotation(factor, constraint):
    example = {w: sp.S.One, phi: sp.S.One}
    turned = factor * elementary("z", phi)
    bound = {"constraints": (constraint,), "example": example}
    assert not derive(model(turned, *(phi, x, y, z, w), **bound)).is_proved


@pytest.mark.parametrize(
    "angle", [phi + TIME, phi + alpha * sin(TIME), phi + psi], ids=["time", "drive", "stranger"]
)
def test_motion_that_the_coordinates_do_not_hold_is_refused(angle):
    with pytest.raises((DerivationError, AlgebraError, ModelError)):
        derive(model(elementary("z", angle), phi))


def test_a_double_zero_of_the_determinant_is_one_singular_point():
    turns = ("z", phi), ("x", theta), ("z", psi * sin(theta))
    found = derive(model(chain(*turns), phi, theta, psi)).singularities
    assert (found.is_solved, found.determinant) == (True, -(sin(theta) ** 2))
    places = {(p.places[0].value, p.places[0].period, p.rank) for p in found.points}
    assert places == {(0, 2 * pi, 2), (pi, 2 * pi, 2)}


def test_a_convention_is_said_in_greek_letters_whatever_the_terminal_shows():
    before = pretty_use_unicode(False)  # as SymPy decides where standard output is ASCII
    try:
        model = EulerAngles("ZXZ", ("phi_1", "theta", "psi"))
        assert model.product == "Rz(φ₁) Rx(θ) Rz(ψ)"
        assert "first by φ₁ about the z-axis, then by θ about the new x-axis" in " ".join(
            model.convention
        )
        assert not pretty_use_unicode(False)  # which stays as it was
    finally:
        pretty_use_unicode(before)
