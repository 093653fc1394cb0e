"""The shipped systems against sympy.physics.mechanics at random states, and their integrals."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from scipy.special import ellipj
from sympy.physics.mechanics import ReferenceFrame, dynamicsymbols, inertia

import rigidsym as rs
from helpers.motions import solves_lagrange, values_for
from helpers.witness import agree, evaluate
from rigidsym.mechanics.quantities.dynamics import ENERGY_SYMBOL, LENGTH_SYMBOL
from rigidsym.models.rotation import OMEGA_BODY
from rigidsym.pipeline import motion_of, read

PHI, THETA, PSI, SIGMA = (dynamicsymbols(n) for n in ("phi", "theta", "psi", "sigma"))
A, B, C, m, g, l, a = sp.symbols("A B C m g l a")  # noqa: E741
T = sp.Symbol("t")


@cache
def shipped(name: str) -> rs.Motion:
    return motion_of(read(name))


def frame(*turns) -> list[ReferenceFrame]:
    """Frames after each turn: (axis, angle)."""
    found = [ReferenceFrame("N")]
    for k, (axis, angle) in enumerate(turns):
        found.append(found[-1].orientnew(f"F{k}", "Axis", [angle, getattr(found[-1], axis)]))
    return found


def kinetic(space, turned, moments):
    omega = turned.ang_vel_in(space)
    return omega.dot(inertia(turned, *moments).dot(omega)) / 2


@pytest.mark.campaign
def test_the_dual_spin_satellite_has_the_equations_that_sympy_finds():
    space, _, _, platform, rotor = frame(("z", PHI), ("x", THETA), ("z", PSI), ("z", SIGMA))
    across, along, torque = sp.symbols("J_1 J_3 u")
    lagrangian = kinetic(space, platform, (A, B, C)) + kinetic(
        space, rotor, (across, across, along)
    )
    motion = shipped("dual_spin_satellite")
    forces = sp.Matrix([0, 0, 0, torque])
    assert solves_lagrange(motion, lagrangian, forces)
    assert [integral.name for integral in motion.first_integrals] == ["momentum_phi"]


def test_a_tree_that_branches_has_the_equations_that_sympy_finds():
    """A frame that turns by φ carries the body and, by the angle 2θ, another one, whose moments are
    called what intermediate quantities would be; a mass is off the axes of the body.
    """
    space, outer, turned = frame(("z", PHI), ("x", THETA))
    other = outer.orientnew("G", "Axis", [2 * THETA, outer.y])
    branch = {"rotation": "z(phi) y(2*theta)", "principal_moments": ["h2", "D2", "ddq1"]}
    lagrangian = kinetic(space, turned, sp.symbols("I_11 I_22 I_33 I_12 I_23 I_13"))
    lagrangian += kinetic(space, other, sp.symbols("h2 D2 ddq1"))
    arm = sp.Symbol("a") * turned.x + l * turned.z
    velocity = turned.ang_vel_in(space).cross(arm)
    lagrangian += m * velocity.dot(velocity) / 2
    payload = {"velocity": [velocity.dot(axis) for axis in (space.x, space.y, space.z)], "mass": m}
    omega = turned.ang_vel_in(space).dot(turned.x)
    forces = [-sp.Symbol("k") * omega * omega.diff(x.diff(T)) for x in (PHI, THETA)]
    motion = rs.derive(
        "z(phi) x(theta)",
        ["mass_matrix", "accelerations"],
        body=rs.general_inertia(),
        parts=[branch, payload],
        torque=["-k*omega_body_1", "0", "0"],
        forces={"theta": "u"},
    )
    assert motion.is_proved
    assert solves_lagrange(motion, lagrangian, sp.Matrix(forces) + sp.Matrix([0, sp.Symbol("u")]))


def test_of_two_links_without_weight_only_the_whole_momentum_is_constant():
    across, along = (f"{f}(a)*a_dot + {f}(a + b)*(a_dot + b_dot)" for f in ("cos", "sin"))
    point = {"velocity": ["0", across, along], "mass": "m"}
    body = rs.principal_moments(A, A, A)
    links = rs.derive("x(a) x(b)", ["first_integrals"], body=body, parts=[point])
    assert [each.name for each in links.first_integrals] == ["energy", "momentum_a"]


def test_kovalevskayas_integral_is_proved():
    motion = shipped("kovalevskaya_top")
    proofs = {integral.name: integral.proof for integral in motion.first_integrals}
    assert list(proofs) == ["energy", "momentum_phi", "K"]
    assert proofs["K"].is_exact


def test_the_effective_potential_of_the_heavy_top_and_what_follows_from_it():
    motion = shipped("heavy_symmetric_top")
    found = {each.name: each for each in motion.consequences}
    assert all(proof.is_exact for each in motion.consequences for proof in each.proofs)
    u, energy, p_phi, p_psi, p = sp.symbols("u E p_phi p_psi p")
    textbook = 2 * (1 - u**2) * (energy - p_psi**2 / (2 * C) - m * g * l * u) / A
    textbook -= ((p_phi - p_psi * u) / A) ** 2
    assert sp.expand(found["cubic_for_cosine"].value - textbook) == 0
    assert sp.expand(found["upright_motion"].value - (p**2 / (4 * A) - m * g * l)) == 0
    steady = A * sp.cos(THETA) * PHI.diff(T) ** 2 - p_psi * PHI.diff(T) + m * g * l
    assert sp.expand(found["steady_motion"].value - steady) == 0
    precession = next(c.value for c in motion.consequences if c.left == PHI.diff(T))
    ignorable = (p_phi - p_psi * sp.cos(THETA)) / (A * sp.sin(THETA) ** 2)
    assert sp.cancel(precession - ignorable) == 0


def test_a_potential_with_a_pole_at_the_top_has_no_upright_motion():
    body = rs.principal_moments(A, A, C)
    only = ["effective_potential"]
    motion = rs.derive("ZXZ", only, body=body, potential="k/(1 - cos(theta))")
    names = {each.name for each in motion.consequences}
    assert "effective_potential" in names
    assert "upright_motion" not in names


def test_the_middle_axis_of_a_free_body_is_unstable_and_the_others_are_not():
    found = [c for c in shipped("free_body").consequences if c.left.text == "λ²"]
    values = {A: 1, B: 2, C: 3, sp.Symbol("Omega"): 1}
    assert [sp.sign(each.value.subs(values)) for each in found] == [-1, 1, -1]
    assert all(proof.is_exact for each in found for proof in each.proofs)
    symmetric = rs.derive("unit_quaternion", body=rs.principal_moments(A, A, C), potential=0)
    rate = next(c for c in symmetric.consequences if c.name == "symmetric_body").value
    assert sp.expand(rate - (C - A) / A * sp.Symbol("Omega_body_3")) == 0


def test_the_closed_form_of_a_free_symmetric_body_is_its_motion_in_both_frames():
    """R = Rz(α₀ + α̇ t) Rx(β) Rz(γ₀ + γ̇ t) with the third axis of space along L"""
    motion = shipped("free_symmetric_body")
    shown = next(c for c in motion.consequences if c.name == "symmetric_body_in_space")
    assert shown.proofs[0].is_exact
    cosine, precession, spin = (value for _, value in shown.where)
    size, angle, values = 3.0, 0.8, {A: 1.4, C: 0.9}
    known = values | {LENGTH_SYMBOL: size, OMEGA_BODY[2]: size * np.cos(angle) / values[C]}
    assert float(cosine.subs(known)) == pytest.approx(np.cos(angle))
    rates = [float(rate.subs(known)) for rate in (precession, spin)]
    start = {"phi": 0.3, "theta": angle, "psi": 0.5, "theta_dot": 0.0}
    start |= {"phi_dot": rates[0], "psi_dot": rates[1]}
    found = motion.simulate(start, {"A": values[A], "C": values[C]}, 9.0, samples=19)
    angles = np.stack([0.3 + rates[0] * found.t, 0 * found.t + angle, 0.5 + rates[1] * found.t], 1)
    exact = Rotation.from_euler("ZXZ", angles).as_matrix()
    assert np.abs(found.rotation_matrix - exact).max() < 1e-9
    momentum = found.rotation_matrix @ (found.angular_velocity_body @ found.inertia)[..., None]
    assert np.abs(momentum[..., 0] - [0, 0, size]).max() < 1e-9


def test_the_elliptic_functions_of_a_free_body_are_its_motion():
    """Ω′ = (a cn τt, b sn τt, c dn τt)"""
    motion = shipped("free_body")
    solved = motion.consequences[-1]
    assert all(proof.is_exact for proof in solved.proofs)
    moments, start = np.array([1.0, 1.5, 2.1]), np.array([0.4, 0.0, 1.2])
    known = dict(zip((A, B, C), moments, strict=True))
    known |= {ENERGY_SYMBOL: moments @ start**2 / 2, LENGTH_SYMBOL: np.linalg.norm(moments * start)}
    squares = [float(value.subs(known)) for _, value in solved.where]
    a, b, c, rate = np.sqrt(squares[:4])
    begun = {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": start}
    found = motion.simulate(begun, dict(zip("ABC", moments, strict=True)), 20.0, samples=41)
    sn, cn, dn, _ = ellipj(rate * found.t, squares[4])
    exact = np.stack([a * cn, b * sn, c * dn], axis=1)
    assert np.abs(found.angular_velocity_body - exact).max() < 1e-9


TOP = "m*g*l*cos(theta)"


@pytest.mark.parametrize(
    ("acting", "conserved"),
    [
        # a gyroscopic force does no work: θ̇ k φ̇ − φ̇ k θ̇ = 0
        (
            {"potential": TOP, "forces": {"phi": "k*theta_dot", "theta": "-k*phi_dot"}},
            ["energy", "momentum_psi"],
        ),
        (
            {"potential": TOP, "forces": {"phi": "k*(sin(theta)**2 + cos(theta)**2 - 1)"}},
            ["energy", "momentum_phi", "momentum_psi"],
        ),
        (
            {"potential": TOP + "*(1 + cos(3*psi) - 4*cos(psi)**3 + 3*cos(psi))"},
            ["energy", "momentum_phi", "momentum_psi"],
        ),
        (
            {"potential": "k*abs(theta - 1)", "forces": {"psi": "-k*psi_dot*abs(psi_dot)"}},
            ["momentum_phi"],
        ),
        ({"potential": "k*abs(theta - 1)"}, ["energy", "momentum_phi", "momentum_psi"]),
        ({"potential": TOP, "forces": {"theta": "-k*theta_dot"}}, ["momentum_phi", "momentum_psi"]),
    ],
)
def test_a_zero_that_is_not_written_as_one_is_a_zero(acting, conserved):
    motion = rs.derive("ZXZ", ["first_integrals"], body=rs.principal_moments(A, A, C), **acting)
    assert [integral.name for integral in motion.first_integrals] == conserved
    assert all(integral.proof.is_exact for integral in motion.first_integrals)


def test_the_quadcopter_has_the_equations_that_sympy_finds():
    space, _, _, body = frame(("z", PSI), ("y", THETA), ("x", PHI))
    thrusts, k = sp.symbols("F_1:5"), sp.Symbol("k")
    torque = [l * (thrusts[3] - thrusts[1]), l * (thrusts[0] - thrusts[2])]
    torque.append(k * (thrusts[0] - thrusts[1] + thrusts[2] - thrusts[3]))
    omega = sp.Matrix([body.ang_vel_in(space).dot(axis) for axis in (body.x, body.y, body.z)])
    forces = omega.jacobian([x.diff(T) for x in (PSI, THETA, PHI)]).T * sp.Matrix(torque)
    assert solves_lagrange(shipped("quadcopter_attitude"), kinetic(space, body, (A, B, C)), forces)


def test_the_angular_velocity_in_a_force_is_that_of_the_body_in_every_place():
    """A torque N₃′ about the third axis of the body has the generalised forces N₃′ (cos θ, 0, 1)"""
    body = rs.principal_moments(A, A, C)
    motions = [
        rs.derive("ZXZ", ["accelerations"], body=body, **acting)
        for acting in (
            {"torque": ["0", "0", "-k*omega_body_3"]},
            {"torque": ["0", "0", "-k*angular_velocity_body_3"]},
            {"forces": {"phi": "-k*omega_body_3*cos(theta)", "psi": "-k*omega_body_3"}},
        )
    ]
    values = values_for(motions[0])
    one, *others = (evaluate(motion.accelerations, values) for motion in motions)
    assert all(agree(one, other) for other in others)
