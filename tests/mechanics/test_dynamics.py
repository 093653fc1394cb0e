"""Energy, momentum and equations of motion: laws, SymPy's own forms, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.command import ROOT
from helpers.motions import solves_lagrange, values_for
from helpers.node import load
from helpers.target_modules import EVERY
from helpers.witness import agree, evaluate, mp
from rigidsym.errors import Defect, ModelError, QuantityError
from rigidsym.mechanics.dynamics import tree
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.models.body import given_inertia
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation import TIME

A, B, C = sp.symbols("A B C")
TOP = "m*g*l*cos(theta)"
ANYWHERE = "m*g*(sin(theta)*(a*sin(psi) + b*cos(psi)) + l*cos(theta))"


def top(sequence: str = "ZXZ", moments=(A, A, C), potential: str = TOP, **more) -> rs.Motion:
    return rs.derive(sequence, body=rs.principal_moments(*moments), potential=potential, **more)


@pytest.mark.parametrize(
    ("sequence", "moments", "potential", "forces"),
    [
        ("ZXZ", (A, A, C), TOP, {}),
        ("ZXZ", (A, B, C), ANYWHERE, {"theta": "-c*theta_dot", "psi": "k"}),
        pytest.param(
            *("zyx", (A, B, C), "m*g*l*sin(theta)*cos(psi)", {"phi": "-c*phi_dot**2"}),
            marks=pytest.mark.campaign,
        ),
        ("ZXZ", (A, A, C), "m*(g + a*sin(omega*t))*cos(theta) - b*t*psi", {"phi": "k*exp(-t)"}),
    ],
)
def test_accelerations_are_those_of_sympy(sequence, moments, potential, forces):
    motion = top(sequence, moments, potential, forces=forces)
    assert motion.is_proved
    q = motion.model.coordinates
    acting = [read(forces.get(c.func.__name__, "0"), q) for c in q]
    assert solves_lagrange(motion, motion.lagrangian, sp.Matrix(acting))


@pytest.mark.parametrize("point", [(0, 0, "-l"), (0.25, "d", 0)], ids=str)
def test_a_stated_fixed_point_is_that_of_sympy(point):
    """T = ½ M |ṙ_C|² + ½ Ω′ᵀ I′_C Ω′ with r_C = R (c − p), which knows no parallel axes."""
    a, b, d, g, length, mass = sp.symbols("a b d g l M")
    exact = {"-l": -length, "d": d, 0.25: sp.Rational(1, 4), 0: 0}
    arm, tensor = sp.Matrix([a, 0, b]) - sp.Matrix([exact[x] for x in point]), sp.diag(A, B, C)
    body = given_inertia(tensor, centre=sp.Matrix([a, 0, b]), mass=mass)
    model = rs.rotation_from("z(phi) x(theta)")
    position = model.matrix * arm
    acting = {"body": body, "potential": mass * g * position[2]}
    names = ("angular_velocity_body", "inertia_tensor", "accelerations")
    motion = rs.derive(model, names, **acting, fixed_point=point)
    assert motion.is_proved
    velocity, omega = position.diff(TIME), motion.angular_velocity_body
    kinetic = (mass * velocity.dot(velocity) + (omega.T * tensor * omega)[0]) / 2
    assert solves_lagrange(motion, kinetic - mass * g * position[2])
    for name in ("kinetic_energy", "inertia_tensor_point"):
        with pytest.raises(QuantityError, match="centre of mass that moves freely"):
            rs.derive(model, name, **acting, fixed_point=point)
    with pytest.raises(ModelError, match=r"no fixed point.* expected fixed_point"):
        rs.derive(model, **acting)


def test_the_body_of_a_derivation_is_the_described_one_wherever_it_turned():
    mass, length = sp.symbols("M l")
    acting = {"body": rs.principal_moments(A, A, C, mass=mass), "potential": "k*cos(theta)"}
    first = rs.derive("ZXZ", "inertia_tensor", **acting, fixed_point=(0, 0, "l"))
    acting["body"] = first.body
    for distance, point in ((2 * length, (0, 0, "2*l")), (0, "centre_of_mass"), (0, None)):
        again = rs.derive("ZXZ", "inertia_tensor", **acting, fixed_point=point)
        assert again.inertia_tensor[0, 0] == A + mass * distance**2


def test_a_body_that_moves_freely_turns_about_its_centre_of_mass():
    body = rs.solid("cone")
    names, acting = ("energy", "rotational_energy"), {"body": body, "potential": 0}
    free = rs.derive("ZXZ", names, **acting, fixed_point="centre_of_mass")
    about = rs.derive("ZXZ", names, **acting, fixed_point=[*body.centre])
    assert free.energy == about.energy == free.rotational_energy


def read(force: str, coordinates) -> sp.Expr:
    names = {q.func.__name__ + "_dot": sp.diff(q, "t") for q in coordinates}
    return sp.sympify(force, locals=names)


def test_the_hamiltonian_of_the_momenta_is_the_energy():
    motion = top(moments=(A, B, C), potential=ANYWHERE, only=["hamiltonian", "energy"])
    momenta = top(moments=(A, B, C), only=["generalised_momenta"]).generalised_momenta
    values = values_for(motion)
    names, numbers = motion.argument("momenta").symbols, evaluate(momenta, values)
    values |= dict(zip(names, numbers, strict=True))
    one, other = (sp.Matrix([e]) for e in (motion.hamiltonian, motion.energy))
    assert agree(evaluate(one, values), evaluate(other, values))


@cache
def flowing() -> rs.Motion:
    """A top whose support vibrates."""
    only = ["state_derivative", "state_jacobian", "first_integrals", "accelerations"]
    return top(potential="m*(g - a*omega**2*cos(omega*t))*l*cos(theta)", only=only)


def test_the_jacobian_of_the_state_is_its_slope():
    values = values_for(flowing())
    exact = evaluate(flowing().state_jacobian, values)
    step, slopes = mp.mpf(10) ** -20, evaluate(flowing().state_derivative, values)
    for k, symbol in enumerate(flowing().argument("y").symbols):
        ahead = evaluate(flowing().state_derivative, values | {symbol: values[symbol] + step})
        column = np.array((ahead - slopes) / step, float)
        assert column == pytest.approx(np.array(exact[:, k], float), abs=1e-12)


@pytest.mark.parametrize(
    "target",
    [
        pytest.param("jax", marks=pytest.mark.campaign) if each.values == ("jax",) else each
        for each in EVERY
    ],
)
def test_every_language_has_the_derivative_of_the_state_for_one_and_for_many(target):
    """state_derivative(t, y, parameters) = (q̇, q̈) and the first integrals; the accelerations of a
    driven top take the time as well
    """
    motion, names = flowing(), ("state_derivative", "first_integrals")
    functions = {name: motion.step(name) for name in names}
    kernels = load(replace(motion.select(["accelerations"]), functions=functions).kernels(target))
    values = {s: float(v) for s, v in values_for(motion).items()}
    y, parameters = ([values[s] for s in motion.argument(n).symbols] for n in ("y", "parameters"))
    time = values[sp.Symbol("t")]
    rel = 1e-5 if target == "jax" else 1e-12  # float32 unless jax_enable_x64 is set
    for name, given in (
        ("state_derivative", (time, y, parameters)),
        ("first_integrals", (y, parameters)),
        ("accelerations", (y[:3], y[3:], time, parameters)),
    ):
        exact = np.array(evaluate(motion.step(name).expression, values).tolist(), float).ravel()
        assert np.asarray(getattr(kernels, name)(*given)) == pytest.approx(exact, rel, abs=rel)
    one, many = (
        kernels.state_derivative(t, x, parameters) for t, x in ((time, y), ([0.0, time], [y, y]))
    )
    assert np.asarray(many)[1] == pytest.approx(np.asarray(one), rel)


@pytest.mark.parametrize(
    ("rotation", "potential"),
    [("unit_quaternion", "k*(w**2 - x**2 - y**2 + z**2)"), ("ZYX", "k*sin(theta)*cos(phi)")],
)
def test_small_errors_of_orientation_and_angular_velocity_grow_by_the_error_state_jacobian(
    rotation, potential
):
    """dδθ/dt = δΩ′ − Ω′ × δθ, and dδΩ′/dt by differences of dΩ′/dt at R exp(C(δθ)) and Ω′ + δΩ′"""
    body = rs.principal_moments(A, B, C)
    only = ["rotation_matrix", "state_derivative", "error_state_jacobian"]
    motion = rs.derive(rotation, only, body=body, potential=potential, method="euler")
    kernels, parameters = motion.kernels(conversions=True).load(), {"A": 1.0, "B": 1.4, "C": 2.1}
    given = np.array([parameters.get(n, 0.8) for n in motion.argument("parameters").names])
    turned, omega = Rotation.from_rotvec([0.4, -0.3, 0.7]), np.array([0.5, -0.8, 1.1])

    def state(delta):
        matrix = (turned * Rotation.from_rotvec(delta[:3])).as_matrix()
        return np.concatenate([kernels.from_rotation_matrix(matrix), omega + delta[3:]])

    def slope(delta):
        return kernels.state_derivative(0.0, state(delta), given)[-3:]

    upper = np.hstack([np.cross(np.eye(3), omega).T, np.eye(3)])
    lower = [(slope(delta) - slope(-delta)) / 2e-5 for delta in 1e-5 * np.eye(6)]
    found = kernels.error_state_jacobian(0.0, state(np.zeros(6)), given)
    assert np.abs(found - np.vstack([upper, np.transpose(lower)])).max() < 1e-8


def test_an_integral_that_depends_on_the_time_is_proved():
    """E − ω p_φ in a potential that turns about the vertical, and nothing near it"""
    energy = "A*(theta_dot**2 + phi_dot**2*sin(theta)**2)/2 + k*sin(theta)*cos(phi - omega*t)"
    energy += " + C*(psi_dot + phi_dot*cos(theta))**2/2"
    momentum = "(A*phi_dot*sin(theta)**2 + C*cos(theta)*(psi_dot + phi_dot*cos(theta)))"
    potential = "k*sin(theta)*cos(phi - omega*t)"
    claimed = {"J": f"{energy} - omega*{momentum}"}
    found = top(potential=potential, only=["first_integrals"], first_integrals=claimed)
    assert {i.name: i.proof.is_exact for i in found.first_integrals}["J"]
    start = {"phi": 0, "theta": 1, "psi": 0, "phi_dot": 0.3, "theta_dot": 0, "psi_dot": 2}
    values = {"A": 1.2, "C": 0.7, "k": 0.8, "omega": 1.5}
    assert found.simulate(start, values, 3.0, samples=31).drift["J"] < 1e-9
    driven = top(potential=potential, only=["energy", "first_integrals"])
    assert [i.name for i in driven.first_integrals] == ["momentum_psi"]
    assert all(proof.is_exact for proof in driven.step("energy").proofs)  # dE/dt = ∂V/∂t
    with pytest.raises(rs.RigidsymError, match="dJ/dt = 0 is false"):
        top(potential=potential, only=["first_integrals"], first_integrals={"J": energy})


@pytest.mark.parametrize("law", ["velocity", "acceleration"])
def test_a_wrong_recursion_over_joints_is_a_defect(monkeypatch, law):
    true = getattr(tree, law)
    monkeypatch.setattr(tree, law, lambda R, own, first, *more: true(R, own, -first, *more))
    with pytest.raises(Defect, match="wrong at a point"):
        rs.derive("z(phi) x(theta)", ["mass_matrix"], body=BODY, parts=[BRANCH])


BODY = rs.principal_moments(A, B, C)
BRANCH = {"rotation": "z(phi) y(2*theta)", "principal_moments": ["1", "2", "2"]}
LAGRANGE = {"method": "lagrange"}
SQUARE = {"velocity": ["theta_dot**2", "a*phi_dot", "0"], "mass": "m"}
ROLLING = {"velocity": ["cos(phi)*psi_dot", "sin(phi)*psi_dot", "0"], "mass": "m"}
HINGED = {"velocity": ["v1_dot", "0", "0"], "mass": "m"}
POINT = {"velocity": ["w_dot", "0", "0"], "mass": "m"}
WRONG_POINTS = ["com", "", "center_of_mass", (), [0, 0], [0, 0, "theta"], 3]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"potential": sp.cos(sp.Symbol("theta"))}, r"theta is a symbol here; .* theta\(t\)"),
        ({"parts": [SQUARE]}, r"the velocity \(theta_dot\*\*2, a\*phi_dot, 0\) is not linear"),
        (
            {"sequence": "direction_cosines", "potential": 0} | LAGRANGE,
            "need independent coordinates",
        ),
        ({"sequence": "unit_quaternion", "parts": [POINT]}, "equations hold for one body"),
        ({"parts": [ROLLING]}, "is that of no position, as in rolling"),
        ({"parts": [HINGED], "sequence": "rotation_vector"}, "expected a product of turns"),
        *(({"fixed_point": p, "potential": 0}, "expected three constants") for p in WRONG_POINTS),
        ({"fixed_point": [0, 0, float("inf")], "potential": 0}, "expected a finite number"),
    ],
)
def test_forces_that_cannot_be_are_refused(given, message):
    given = dict(given)
    rotation = given.pop("sequence", "ZXZ")
    with pytest.raises(rs.RigidsymError, match=message):
        rs.derive(rotation, ["state_derivative"], body=rs.principal_moments(A, A, C), **given)
    with pytest.raises(rs.RigidsymError, match="a body"):
        rs.derive("ZXZ", potential=TOP)


BODIES = {
    "general": rs.principal_moments(A, B, C),
    "symmetric": rs.principal_moments(A, A, C),
    "spherical": rs.principal_moments(A, A, A),
    "six entries": rs.general_inertia(),
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
    kept = ROOT / "tests/golden/operations_of_sympy.json"  # SymPy takes an hour to simplify them
    for name, shortest in json.loads(kept.read_text("utf-8"))["ZXZ"][body].items():
        expression = derived("ZXZ", body).step(name).expression
        assert sum(int(sp.count_ops(entry)) for entry in expression) <= shortest, name


def test_the_symmetric_body_as_a_textbook_prints_it():
    theta = dynamicsymbols("theta")
    phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)
    energy = sp.Rational(1, 2) * A * (theta_dot**2 + phi_dot**2 * sp.sin(theta) ** 2)
    energy += sp.Rational(1, 2) * C * (psi_dot + phi_dot * sp.cos(theta)) ** 2
    assert derived("ZXZ", "symmetric").rotational_energy == energy
    spherical = theta_dot**2 + phi_dot**2 + psi_dot**2 + 2 * phi_dot * psi_dot * sp.cos(theta)
    assert derived("ZXZ", "spherical").rotational_energy == A * spherical / 2
    squares = sp.Add(*(rate**2 for rate in dynamicsymbols("w x y z", 1)))
    assert derived("unit_quaternion", "spherical").rotational_energy == 2 * A * squares


@pytest.mark.parametrize(
    "name", ["energy", "kinetic_energy", "angular_velocity_body_4", "Thetadot"]
)
def test_a_name_that_is_that_of_a_quantity_or_nearly_a_rate_is_no_constant(name):
    with pytest.raises(ModelError, match=r"is a quantity, not a constant|did you mean theta_dot"):
        top(forces={"phi": f"-k*{name}"})


def test_names_that_stand_for_two_things_are_refused():
    body = rs.principal_moments(A, B, sp.Symbol("X"))
    with pytest.raises(ModelError, match="X is a name both"):
        rs.derive("ZXZ", body=body)
    with pytest.raises(ModelError, match="A is a name both"):
        rs.derive(rs.EulerAngles("ZXZ", ("A", "beta", "gamma")), body=BODIES["general"])
