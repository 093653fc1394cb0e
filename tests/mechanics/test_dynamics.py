"""Equations of motion: SymPy's own Lagrange, first integrals, and what cannot be asked for."""

from __future__ import annotations

import random
import re
from functools import cache

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from sympy.physics.mechanics import LagrangesMethod

import rigidsym as rs
from helpers.node import load
from helpers.witness import agree, cross, evaluate, mp
from rigidsym.errors import Defect
from rigidsym.mechanics.dynamics import tree
from rigidsym.mechanics.dynamics.lagrange import LagrangeEquations
from rigidsym.mechanics.quantities.dynamics import bias_vector
from rigidsym.models.forces import Forces

A, B, C = sp.symbols("A B C")
TOP = "m*g*l*cos(theta)"
ANYWHERE = "m*g*(sin(theta)*(a*sin(psi) + b*cos(psi)) + l*cos(theta))"


def top(sequence: str = "ZXZ", moments=(A, A, C), potential: str = TOP, **more) -> rs.Motion:
    model = rs.EulerAngles(sequence, angles=("phi", "theta", "psi"))
    return rs.derive(model, body=rs.principal_moments(*moments), potential=potential, **more)


def values_for(motion: rs.Motion, seed: int = 3) -> dict:
    generator = random.Random(seed)
    symbols = [s for argument in motion.arguments for s in argument.symbols]
    return {symbol: mp.mpf(generator.randint(100, 900)) / 700 for symbol in symbols}


@pytest.mark.parametrize(
    ("sequence", "moments", "potential", "forces"),
    [
        ("ZXZ", (A, A, C), TOP, {}),
        ("ZXZ", (A, B, C), ANYWHERE, {"theta": "-c*theta_dot", "psi": "k"}),
        ("zyx", (A, B, C), "m*g*l*sin(theta)*cos(psi)", {"phi": "-c*phi_dot**2"}),
        ("ZXZ", (A, A, C), "m*(g + a*sin(omega*t))*cos(theta) - b*t*psi", {"phi": "k*exp(-t)"}),
    ],
)
def test_accelerations_are_those_of_sympy(sequence, moments, potential, forces):
    motion = top(sequence, moments, potential, forces=forces)
    assert motion.is_proved
    q = list(motion.model.coordinates)
    method = LagrangesMethod(motion.lagrangian, q)
    equations = method.form_lagranges_equations()
    values = values_for(motion)
    known = dict(values)
    for coordinate, acceleration in zip(q, evaluate(motion.accelerations, values), strict=True):
        known[sp.diff(coordinate, "t", 2)] = acceleration
    acting = sp.Matrix([read(forces.get(c.func.__name__, "0"), q) for c in q])
    assert agree(evaluate(equations, known), evaluate(acting, known))


def read(force: str, coordinates) -> sp.Expr:
    names = {q.func.__name__ + "_dot": sp.diff(q, "t") for q in coordinates}
    return sp.sympify(force, locals=names)


def test_the_pieces_of_the_equations_belong_together():
    """M q̈ + h = 0 without forces, p = M q̇, H(q, p) = E = T + V, L = T − V"""
    motion = top(moments=(A, B, C), potential=ANYWHERE)
    values = values_for(motion)

    def at(name):
        return evaluate(sp.Matrix([getattr(motion, name)]), values)

    rates = mp.matrix([values[s] for s in motion.argument("q_dot").symbols])
    assert agree(at("mass_matrix") * at("accelerations"), -at("bias_vector"))
    momenta = at("mass_matrix") * rates
    assert agree(at("generalised_momenta"), momenta)
    assert agree(at("energy") - at("lagrangian"), 2 * at("potential_energy"))
    values |= dict(zip(motion.argument("momenta").symbols, momenta, strict=True))
    assert agree(at("hamiltonian"), at("energy"))


def test_first_integrals_of_the_heavy_symmetric_top_are_found_and_proved():
    motion = top()
    assert [i.name for i in motion.first_integrals] == ["energy", "momentum_phi", "momentum_psi"]
    assert all(integral.proof.is_exact for integral in motion.first_integrals)
    damped = top(forces={"psi": "-c*psi_dot"})
    assert [i.name for i in damped.first_integrals] == ["momentum_phi"]
    asymmetric = top(moments=(A, B, C), potential=ANYWHERE)
    assert [i.name for i in asymmetric.first_integrals] == ["energy", "momentum_phi"]


def test_a_given_tensor_is_about_the_fixed_point_unless_the_centre_is_asked_for():
    motion = top()
    names = {step.quantity.name for step in motion.steps}
    assert motion.about_fixed_point
    assert names.isdisjoint({"translational_energy", "kinetic_energy", "angular_momentum"})
    assert motion.step("inertia_tensor").quantity.about.startswith("inertia tensor about the fixed")
    asked = rs.derive("ZXZ", ["kinetic_energy"], body=rs.principal_moments(A, A, C), potential=TOP)
    assert not asked.about_fixed_point
    assert asked.kinetic_energy


def test_euler_equations_of_any_inertia_tensor():
    """I′ dΩ′/dt + Ω′ × I′ Ω′ = N′"""
    model = rs.EulerAngles("ZXZ")
    motion = rs.derive(model, body=rs.general_inertia(), potential=0)
    values = values_for(motion)
    tensor = evaluate(motion.inertia_tensor, values)
    omega, torque = (
        mp.matrix([values[s] for s in motion.argument(name).symbols])
        for name in ("omega_body", "torque")
    )
    alpha = evaluate(motion.angular_acceleration_from_torque, values)
    assert agree(tensor * alpha + cross(omega, tensor * omega), torque)


@pytest.mark.parametrize("target", ["numpy", "c", "numba", "jax", "javascript"])
def test_every_language_has_the_derivative_of_the_state_for_one_and_for_many(target, request):
    """state_derivative(t, y, parameters) = (q̇, q̈), its Jacobian, and the first integrals; the
    accelerations of a driven top take the time as well
    """
    if target == "javascript":
        request.getfixturevalue("node")
    motion = flowing()
    kernels = load(motion.kernels(target))
    values = {s: float(v) for s, v in values_for(motion).items()}
    y, parameters = ([values[s] for s in motion.argument(n).symbols] for n in ("y", "parameters"))
    time = values[sp.Symbol("t")]
    rel = 1e-5 if target == "jax" else 1e-12  # float32 unless jax_enable_x64 is set

    def at(name):
        return np.array(evaluate(motion.step(name).expression, values).tolist(), float)

    if target == "numpy":
        step, slopes = mp.mpf(10) ** -20, evaluate(motion.state_derivative, values_for(motion))
        for k, symbol in enumerate(motion.argument("y").symbols):
            ahead = values_for(motion)
            ahead[symbol] += step
            column = (evaluate(motion.state_derivative, ahead) - slopes) / step
            assert np.array(column, float) == pytest.approx(at("state_jacobian")[:, k], abs=1e-12)
    for name, given in (
        ("state_derivative", (time, y, parameters)),
        ("state_jacobian", (time, y, parameters)),
        ("first_integrals", (y, parameters)),
        ("accelerations", (y[:3], y[3:], time, parameters)),
    ):
        exact = at(name)
        exact = exact if name == "state_jacobian" else exact.ravel()
        assert np.asarray(getattr(kernels, name)(*given)) == pytest.approx(exact, rel, abs=rel)
    many = kernels.state_derivative([0.0, time], [y, y], parameters)
    assert np.asarray(many)[1] == pytest.approx(at("state_derivative").ravel(), rel)


@cache
def flowing() -> rs.Motion:
    """A top whose support vibrates."""
    only = ["state_derivative", "state_jacobian", "first_integrals", "accelerations"]
    return top(potential="m*(g - a*omega**2*cos(omega*t))*l*cos(theta)", only=only)


@pytest.mark.parametrize(
    ("rotation", "potential"),
    [("unit_quaternion", "k*(w**2 - x**2 - y**2 + z**2)"), ("ZYX", "k*sin(theta)*cos(phi)")],
)
def test_small_errors_of_orientation_and_angular_velocity_grow_by_the_error_state_jacobian(
    rotation, potential
):
    """Two motions side by side: δθ is the rotation vector of RᵀR₂, δΩ′ the difference of Ω′"""
    body = rs.principal_moments(A, B, C)
    motion = rs.derive(rotation, body=body, potential=potential, method="euler")
    kernels = motion.kernels(conversions=True).load()
    parameters = {"A": 1.0, "B": 1.4, "C": 2.1, "k": 0.8}
    given = np.array([parameters.get(n, 1.0) for n in motion.argument("parameters").names])
    turned = Rotation.from_rotvec([0.4, -0.3, 0.7])
    omega, small, dt = np.array([0.5, -0.8, 1.1]), 1e-4, 1e-4

    def accelerated(turned, omega):
        q = kernels.from_rotation_matrix(turned.as_matrix())
        return kernels.state_derivative(0.0, np.concatenate([q, omega]), given)[-3:], q

    def moved(turned, omega, t):
        slope = accelerated(turned, omega)[0]
        return turned * Rotation.from_rotvec((omega + slope * t / 2) * t), omega + slope * t

    def error(delta, t):
        one = moved(turned, omega, t)
        two = moved(turned * Rotation.from_rotvec(delta[:3]), omega + delta[3:], t)
        return np.concatenate([(one[0].inv() * two[0]).as_rotvec(), two[1] - one[1]])

    columns = []
    for k in range(6):
        delta = small * np.eye(6)[k]
        slopes = [(error(d, dt) - error(d, -dt)) / (2 * dt) for d in (delta, -delta)]
        columns.append((slopes[0] - slopes[1]) / (2 * small))
    state = np.concatenate([accelerated(turned, omega)[1], omega])
    found = kernels.error_state_jacobian(0.0, state, given)
    assert np.abs(found - np.array(columns).T).max() < 1e-6


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


def test_a_wrong_bias_is_refuted():
    work = LagrangeEquations(rs.EulerAngles("ZXZ"), rs.principal_moments(A, A, C), Forces())
    work.gyroscopic = work.gyroscopic.scale(work.ring.one + work.ring.one)
    with pytest.raises(rs.RigidsymError, match="is false"):
        work.step(bias_vector)


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
TIMED = {"velocity": ["n*t*phi_dot", "0", "0"], "mass": "m"}
SPINNING = {"rotation": "z(phi)", "principal_moments": ["1", "1", "1"]}
HINGED = {"velocity": ["v1_dot", "0", "0"], "mass": "m"}
POINT = {"velocity": ["w_dot", "0", "0"], "mass": "m"}
NOWHERE = ("did you mean omega_body_2?", "Omega_body_2 omegabody2")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"potential": "m*g*theta_dot"}, r"the potential .*theta_dot depends on rates"),
        ({"potential": "m*g*l*cos(beta)"}, "depends on none of the coordinates phi, theta, psi"),
        ({"potential": sp.cos(sp.Symbol("theta"))}, r"expected a text, or functions of t"),
        ({"potential": TOP, "forces": {"chi": "1"}}, "a force on chi, which is not a coordinate"),
        ({"potential": "w*cos(thets)"}, r"unknown name thets; did you mean theta\?"),
        ({"torque": ["u - h*Theta_dot", "0", "0"]}, r"did you mean theta_dot\?"),
        *(({"torque": ["0", n, "0"]}, re.escape(NOWHERE[0])) for n in NOWHERE[1].split()),
        ({"parts": [SQUARE]}, r"the velocity \(theta_dot\*\*2, a\*phi_dot, 0\) is not linear"),
        (
            {"sequence": "direction_cosines", "potential": 0} | LAGRANGE,
            "need independent coordinates",
        ),
        ({"sequence": "unit_quaternion", "parts": [POINT]}, "equations hold for one body"),
        ({"parts": [ROLLING]}, "is that of no position, as in rolling"),
        ({"parts": [TIMED]}, "depends on t; expected a part that does not"),
        ({"parts": [SPINNING], "first_integrals": {"F": "theta"}}, "are not proved"),
        ({"parts": [HINGED], "sequence": "rotation_vector"}, "expected a product of turns"),
    ],
)
def test_forces_that_cannot_be_are_refused(given, message):
    given = dict(given)
    rotation = given.pop("sequence", rs.EulerAngles("ZXZ", ("phi", "theta", "psi")))
    with pytest.raises(rs.RigidsymError, match=message):
        rs.derive(rotation, ["state_derivative"], body=rs.principal_moments(A, A, C), **given)
    with pytest.raises(rs.RigidsymError, match="a body"):
        rs.derive("ZXZ", potential=TOP)
