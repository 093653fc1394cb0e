"""Energy and momentum of a turning body, laws for every rotation, and SymPy's own forms."""

from __future__ import annotations

import json
import pathlib
from functools import cache

import pytest
import sympy as sp
from sympy import Rational, cos, sin
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from rigidsym.errors import ModelError
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.models.body import general_inertia, principal_moments
from rigidsym.models.library import PARAMETRISATIONS

ROOT = pathlib.Path(__file__).resolve().parents[1]
A, B, C = sp.symbols("A B C")
BODIES = {
    "general": principal_moments(A, B, C),
    "symmetric": principal_moments(A, A, C),
    "spherical": principal_moments(A, A, A),
    "six entries": general_inertia(),
}
ENERGY = ("inertia_tensor", *ENERGY_QUANTITIES)


@cache
def derived(rotation: str, body: str = "six entries") -> rs.Motion:
    return rs.derive(rotation, ENERGY, body=BODIES[body])


MODELS = (
    # the proof of the direction cosines is long
    *(name for name in PARAMETRISATIONS if name not in ("direction_cosines", "rotation_vector")),
    pytest.param("rotation_vector", marks=pytest.mark.campaign),
    "z(phi) x(theta) z(psi) y(delta)",
    "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5)",
    "z(2*phi - psi) x(theta) z(psi)",
)


@pytest.mark.parametrize("name", MODELS)
def test_laws_over_the_catalogue(name):
    """Proved, and in coordinates and rates: q·q̇ = 0 would bring accelerations in."""
    motion = derived(name)
    assert motion.is_proved
    claims = {proof.claim.text for proof in motion.proofs}
    assert {"L_R·Ω = 2E_R", "L′_R·Ω′ = 2E_R", "½Ωᵀ (R I′ Rᵀ) Ω = E_R"} <= claims
    symbols = [s for n in ("q_dot", "q", "parameters") for s in motion.argument(n).symbols]
    functions = sp.Matrix([motion.rotational_energy, *motion.angular_momentum_rotation])
    plain = functions.xreplace(dict(zip(symbols, sp.symbols(f"s:{len(symbols)}"), strict=True)))
    assert not plain.atoms(sp.Derivative)


@pytest.mark.parametrize("body", ["general", "symmetric", "spherical"])
def test_never_longer_than_sympy_after_simplify(body):
    kept = ROOT / "golden" / "operations_of_sympy.json"  # SymPy takes an hour to simplify them
    for name, shortest in json.loads(kept.read_text("utf-8"))["ZXZ"][body].items():
        expression = derived("ZXZ", body).step(name).expression
        assert sum(int(sp.count_ops(entry)) for entry in expression) <= shortest, name


def test_the_symmetric_body_as_a_textbook_prints_it():
    theta = dynamicsymbols("theta")
    phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)
    energy = Rational(1, 2) * A * (theta_dot**2 + phi_dot**2 * sin(theta) ** 2)
    energy += Rational(1, 2) * C * (psi_dot + phi_dot * cos(theta)) ** 2
    assert derived("ZXZ", "symmetric").rotational_energy == energy
    spherical = theta_dot**2 + phi_dot**2 + psi_dot**2 + 2 * phi_dot * psi_dot * cos(theta)
    assert derived("ZXZ", "spherical").rotational_energy == A * spherical / 2
    squares = sp.Add(*(rate**2 for rate in dynamicsymbols("w x y z", 1)))
    assert derived("unit_quaternion", "spherical").rotational_energy == 2 * A * squares


def test_names_that_stand_for_two_things_are_refused():
    body = principal_moments(A, B, sp.Symbol("X"))
    with pytest.raises(ModelError, match="X is a name both"):
        rs.derive("ZXZ", body=body)
    with pytest.raises(ModelError, match="A is a name both"):
        rs.derive(rs.EulerAngles("ZXZ", ("A", "beta", "gamma")), body=BODIES["general"])
