"""The shipped systems against sympy.physics.mechanics at random states, and their integrals."""

from __future__ import annotations

import random
from functools import cache

import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import rigidsym as rs
from helpers.witness import agree, evaluate, mp
from rigidsym.pipeline import motion_of, read

PHI, THETA, PSI, SIGMA = (dynamicsymbols(n) for n in ("phi", "theta", "psi", "sigma"))
A, B, C, m, g, l, a, n = sp.symbols("A B C m g l a n")  # noqa: E741
T = sp.Symbol("t")


@cache
def shipped(name: str) -> rs.Motion:
    return motion_of(read(name))


def values_for(motion: rs.Motion) -> dict:
    generator = random.Random(7)
    symbols = [s for argument in motion.arguments for s in argument.symbols]
    return {symbol: mp.mpf(generator.randint(100, 900)) / 700 for symbol in symbols}


def frame(*turns) -> list[ReferenceFrame]:
    """Frames after each turn: (axis, angle)."""
    found = [ReferenceFrame("N")]
    for k, (axis, angle) in enumerate(turns):
        unit = dict(zip("xyz", (found[-1].x, found[-1].y, found[-1].z), strict=True))[axis]
        found.append(found[-1].orientnew(f"F{k}", "Axis", [angle, unit]))
    return found


def kinetic(space, turned, moments):
    omega = turned.ang_vel_in(space)
    return omega.dot(inertia(turned, *moments).dot(omega)) / 2


def satisfied(motion: rs.Motion, lagrangian, q, forces=None) -> bool:
    """Whether the accelerations solve SymPy's equations."""
    equations = LagrangesMethod(lagrangian, q).form_lagranges_equations()
    values = values_for(motion)
    values |= dict(
        zip([sp.diff(x, T, 2) for x in q], evaluate(motion.accelerations, values), strict=True)
    )
    acting = sp.zeros(len(q), 1) if forces is None else forces
    return agree(evaluate(equations, values), evaluate(acting, values))


def test_the_gyroscope_in_gimbals_has_the_equations_that_sympy_finds():
    space, outer, inner, rotor = frame(("z", PHI), ("x", THETA), ("z", PSI))
    lagrangian = kinetic(space, outer, sp.symbols("O_1:4"))
    lagrangian += kinetic(space, inner, sp.symbols("G_1:4")) + kinetic(space, rotor, (A, A, C))
    motion = shipped("gyroscope")
    assert satisfied(motion, lagrangian - m * g * l * sp.cos(THETA), [PHI, THETA, PSI])
    names = [integral.name for integral in motion.first_integrals]
    assert names == ["energy", "momentum_phi", "momentum_psi"]


def test_the_dual_spin_satellite_has_the_equations_that_sympy_finds():
    space, _, _, platform, rotor = frame(("z", PHI), ("x", THETA), ("z", PSI), ("z", SIGMA))
    across, along, torque = sp.symbols("J_1 J_3 u")
    lagrangian = kinetic(space, platform, (A, B, C)) + kinetic(
        space, rotor, (across, across, along)
    )
    motion = shipped("dual_spin_satellite")
    forces = sp.Matrix([0, 0, 0, torque])
    assert satisfied(motion, lagrangian, [PHI, THETA, PSI, SIGMA], forces)
    assert [integral.name for integral in motion.first_integrals] == ["momentum_phi"]


def test_the_gravity_gradient_satellite_has_the_equations_that_sympy_finds():
    space, orbit, _, _, body = frame(("z", n * T), ("z", PSI), ("y", THETA), ("x", PHI))
    radial = [orbit.x.dot(axis) for axis in (body.x, body.y, body.z)]
    potential = (
        sp.Rational(3, 2) * n**2 * sum(k * r**2 for k, r in zip((A, B, C), radial, strict=True))
    )
    motion = shipped("gravity_gradient_satellite")
    assert satisfied(motion, kinetic(space, body, (A, B, C)) - potential, [PSI, THETA, PHI])
    assert [integral.name for integral in motion.first_integrals] == ["energy"]


def test_the_rolling_disc_has_the_accelerations_of_kanes_method():
    speeds = dynamicsymbols("u1:4")
    q = [PHI, THETA, PSI]
    space, _, tilted, disc = frame(("z", PHI), ("x", THETA), ("z", PSI))
    disc.set_ang_vel(
        space, disc.ang_vel_in(space).subs(dict(zip([x.diff(T) for x in q], speeds, strict=True)))
    )
    contact, centre = Point("P"), Point("O")
    contact.set_vel(space, 0)
    centre.set_pos(contact, a * tilted.y)
    centre.v2pt_theory(contact, space, disc)
    body = RigidBody("D", centre, disc, m, (inertia(tilted, A, A, C), centre))
    rates = [x.diff(T) - u for x, u in zip(q, speeds, strict=True)]
    method = KanesMethod(space, q_ind=q, u_ind=speeds, kd_eqs=rates)
    method.kanes_equations([body], [(centre, -m * g * space.z)])
    motion = shipped("rolling_disc")
    values = values_for(motion)
    known = values | {u: values[x.diff(T)] for x, u in zip(q, speeds, strict=True)}
    left, right = (evaluate(part, known) for part in (method.mass_matrix, method.forcing))
    assert agree(left * evaluate(motion.accelerations, values), right)
    assert [integral.name for integral in motion.first_integrals] == ["energy"]


def test_the_coriolis_matrix_of_the_quadcopter_is_that_of_a_passive_system():
    motion = shipped("quadcopter_attitude")
    values = values_for(motion)
    rates = mp.matrix([values[s] for s in motion.argument("q_dot").symbols])
    coriolis = evaluate(motion.coriolis_matrix, values)
    assert agree(coriolis * rates, evaluate(motion.bias_vector, values))
    mass_rate = evaluate(sp.diff(sp.Matrix(motion.mass_matrix), T), values)
    skew = mass_rate - 2 * coriolis
    assert agree(skew, -skew.T)
    assert motion.is_proved


def test_kovalevskayas_integral_is_proved_and_a_wrong_one_refuted():
    motion = shipped("kovalevskaya_top")
    proofs = {integral.name: integral.proof for integral in motion.first_integrals}
    assert list(proofs) == ["energy", "momentum_phi", "K"]
    assert proofs["K"].is_exact
    with pytest.raises(rs.RigidsymError, match="dK/dt = 0 is false"):
        rs.derive(
            "ZXZ",
            ["energy"],
            body=rs.principal_moments(2 * C, 2 * C, C),
            potential="m*g*a*sin(theta)*sin(psi)",
            first_integrals={"K": "omega_body_1**2 - omega_body_2**2"},
        )


def test_the_effective_potential_of_the_heavy_top_and_what_follows_from_it():
    motion = shipped("heavy_symmetric_top")
    found = {each.title: each for each in motion.consequences}
    assert all(proof.is_exact for each in motion.consequences for proof in each.proofs)
    u, energy, p_phi, p_psi, p = sp.symbols("u E p_phi p_psi p")
    textbook = 2 * (1 - u**2) * (energy - p_psi**2 / (2 * C) - m * g * l * u) / A
    textbook -= ((p_phi - p_psi * u) / A) ** 2
    assert sp.expand(found["The equation for the cosine"].value - textbook) == 0
    assert sp.expand(found["The upright motion"].value - (p**2 / (4 * A) - m * g * l)) == 0
    steady = A * sp.cos(THETA) * PHI.diff(T) ** 2 - p_psi * PHI.diff(T) + m * g * l
    assert sp.expand(found["Steady motion"].value - steady) == 0
    assert found["Nutation in elliptic functions"].value == 2 * m * g * l / A


def test_the_top_that_rises_for_ever_solves_the_equation_for_the_cosine():
    """1/cos θ = 1 + 1/cosh γt, by substitution of s = 1/cosh γt with ṡ² = γ² s² (1 − s²)"""
    motion = shipped("heavy_symmetric_top")
    cubic = next(c for c in motion.consequences if c.title == "The equation for the cosine").value
    gamma, s, u = sp.symbols("gamma s u")
    start = {THETA: sp.pi / 3, THETA.diff(T): 0, PHI.diff(T): 2 * gamma / sp.sqrt(3)}
    start[PSI.diff(T)] = (3 * A - C) * gamma / (C * sp.sqrt(3))
    weight = {m: A * gamma**2 / (g * l)}
    names = {"energy": "E", "momentum_phi": "p_phi", "momentum_psi": "p_psi"}
    constants = {
        sp.Symbol(names[i.name]): i.expression.subs(start).subs(weight)
        for i in motion.first_integrals
    }
    value = 1 / (1 + s)
    left = sp.diff(value, s) ** 2 * gamma**2 * s**2 * (1 - s**2)
    assert sp.cancel(cubic.subs(constants).subs(weight).subs(u, value) - left) == 0


def test_a_pendulum_and_its_effective_potential_need_no_third_coordinate():
    motion = rs.derive("x(theta)", body=rs.principal_moments(A, B, C), potential="m*g*l*cos(theta)")
    assert motion.accelerations[0] - m * g * l * sp.sin(THETA) / A == 0
    found = motion.simulate(
        {"theta": 3.0, "theta_dot": 0.0},
        {"A": 1, "B": 1, "C": 1, "m": 1, "g": 9.81, "l": 1},
        5.0,
        samples=11,
    )
    assert found.drift["energy"] < 1e-10


def test_the_middle_axis_of_a_free_body_is_unstable_and_the_others_are_not():
    found = [c for c in shipped("free_body").consequences if c.left.text == "λ²"]
    values = {A: 1, B: 2, C: 3, sp.Symbol("Omega"): 1}
    assert [sp.sign(each.value.subs(values)) for each in found] == [-1, 1, -1]
    assert all(proof.is_exact for each in found for proof in each.proofs)
    symmetric = rs.derive("unit_quaternion", body=rs.principal_moments(A, A, C), potential=0)
    rate = next(c for c in symmetric.consequences if c.title == "The symmetric body").value
    assert sp.expand(rate - (C - A) / A * sp.Symbol("Omega_body_3")) == 0
