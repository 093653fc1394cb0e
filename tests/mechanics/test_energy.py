"""Energy and momentum of a turning body, against clouds of particles and against SymPy's own."""

from __future__ import annotations

import json
import pathlib
import random
from functools import cache
from typing import Any

import pytest
import sympy as sp
from sympy import Rational, cos, sin
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.witness import (
    Path,
    agree,
    cross,
    derivative,
    dot,
    evaluate,
    mp,
    paths,
    rotation,
    values_along,
)
from rigidsym.errors import ModelError
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.models.body import general_inertia, principal_moments
from rigidsym.models.library import PARAMETRISATIONS

ROOT = pathlib.Path(__file__).resolve().parents[1]
A, B, C, M = sp.symbols("A B C M")
BODIES = {
    "general": principal_moments(A, B, C),
    "symmetric": principal_moments(A, A, C),
    "spherical": principal_moments(A, A, A),
    "six entries": general_inertia(),
}
ENERGY = ("inertia_tensor", *ENERGY_QUANTITIES)
CENTRE = dynamicsymbols("X Y Z")
(PATH,) = paths(1, size=6, seed=4)


@cache
def derived(rotation: str, body: str = "six entries") -> rs.Motion:
    return rs.derive(rotation, ENERGY, body=BODIES[body])


class Cloud:
    """Five particles whose centre of mass is the origin of the axes of the body."""

    def __init__(self) -> None:
        source = random.Random(9)
        self.masses = [mp.mpf(source.randint(1, 99)) / 17 for _ in range(5)]
        free = [mp.matrix([source.randint(-99, 99) for _ in range(3)]) / 13 for _ in range(4)]
        moment = sum((m * x for m, x in zip(self.masses, free, strict=False)), mp.matrix(3, 1))
        self.places = [*free, -moment / self.masses[-1]]

    @property
    def values(self) -> dict[sp.Expr, Any]:
        """The parameters of the body with six entries."""
        tensor = sum((self._tensor(k) for k in range(5)), mp.matrix(3, 3))
        found = {sp.Symbol(f"I_{i + 1}{j + 1}"): tensor[i, j] for i in range(3) for j in range(3)}
        return {M: sum(self.masses), **found}

    def _tensor(self, k: int) -> Any:
        x = self.places[k]
        return self.masses[k] * ((x.T * x)[0] * mp.eye(3) - x * x.T)

    def moving(self, convention: str, path: Path) -> tuple[list[Any], list[Any]]:
        """Positions and velocities in space, from the turning matrix and its derivative."""

        def place(x: Any) -> Any:
            return lambda t: mp.matrix(path.at(t)[3:]) + rotation(convention, path.at(t)[:3]) * x

        return [place(x)(0) for x in self.places], [derivative(place(x)) for x in self.places]


@pytest.mark.parametrize("convention", ["ZXZ", "zyx"])
def test_the_sums_over_particles_are_what_is_printed(convention):
    motion, cloud = derived(convention), Cloud()
    values = values_along((*motion.argument("q").symbols, *CENTRE), PATH) | cloud.values
    places, velocities = cloud.moving(convention, PATH)
    energy = sum(m * dot(v, v) for m, v in zip(cloud.masses, velocities, strict=True)) / 2
    momentum = mp.matrix(3, 1)
    for m, r, v in zip(cloud.masses, places, velocities, strict=True):
        momentum += m * cross(r, v)
    assert agree(evaluate(sp.Matrix([motion.kinetic_energy]), values), mp.matrix([energy]))
    assert agree(evaluate(motion.angular_momentum, values), momentum)


MODELS = (
    *(name for name in PARAMETRISATIONS if name != "direction_cosines"),  # its proof is long
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
