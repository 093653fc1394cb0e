"""Equations 1 to 18 of the lecture: proved in the ring, and true of one cloud of particles.

The formulas typed from its page are those of the derivation by ==, which is equality of the form.

The cloud moves and turns along a path in 50 digits; nothing of the derivation takes part in it.
"""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from sympy import cos, sin
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.typesetting import numbered_by_tex
from helpers.witness import evaluate, hat, mp, paths, rotation, unhat, values_along
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.errors import DerivationError, ModelError, SpecError
from rigidsym.mechanics import lecture as theory_of
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture import theory
from rigidsym.models.library import PRESETS
from rigidsym.models.rotation import SOURCES, lecture as cited
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.record import record
from rigidsym.pipeline import output_of
from rigidsym.spec.derivation_file import read_file, read_spec

(PATH,) = paths(1, size=6, seed=7)
SMALL = mp.mpf(10) ** -38
LECTURE = read_file("lecture")


@cache
def lecture() -> rs.Motion:
    return output_of(LECTURE).motion


def array(matrix: Any) -> Any:
    """Numbers of 50 digits: (3, 3), or (3,) from a column."""
    return np.array(matrix.tolist()).squeeze()


def near(first: Any, second: Any) -> bool:
    return max(map(abs, np.ravel(first - second))) < SMALL


def dot(first: Any, second: Any) -> Any:
    return (first * second).sum(axis=-1)


class World:
    """A cloud of particles that moves; sums over it are sums over it."""

    def __init__(self) -> None:
        whole = np.random.default_rng(3).integers(-50, 50, (6, 4)).astype(object) * mp.mpf(1)
        self.m = abs(whole[:, 3]) + 1
        self.M = self.m.sum()
        self.at_rest = whole[:, :3] - self.sum(whole[:, :3]) / self.M
        self.R, self.R_dot = map(array, (turn(0), mp.diff(turn, 0)))
        self.omega = array(unhat(mp.diff(turn, 0) * turn(0).T))
        self.r_C, self.v_C = map(array, (centre(0), mp.diff(centre, 0)))
        self.r = self.r_C + self.at_rest @ self.R.T
        self.v = self.v_C + self.at_rest @ self.R_dot.T
        self.x, self.x_dot = self.r - self.sum(self.r) / self.M, self.v - self.v_C
        self.I = self.tensor(self.x)
        self.turning = self.sum(dot(self.x_dot, self.x_dot)) / 2
        self.momentum = self.sum(np.cross(self.x, self.x_dot))

    def sum(self, values: Any) -> Any:
        """Σ m of what belongs to the particles."""
        return (self.m * values.T).sum(axis=-1)

    def tensor(self, places: Any) -> Any:
        """Equation 4, entry by entry."""
        crossed = [np.cross(e, places) for e in np.eye(3, dtype=int)]
        return np.array([[self.sum(dot(u, v)) for v in crossed] for u in crossed])


def turn(t: Any) -> Any:
    return rotation("ZXZ", PATH.at(t)[:3])


def centre(t: Any) -> Any:
    return mp.matrix(PATH.at(t)[3:])


def equations(w: World) -> dict[int, list[bool]]:
    """Each equation of the lecture, read as a statement on sums over the particles."""
    R, W, e = w.R, w.omega, np.eye(3, dtype=int)
    in_body, inverse = R.T @ W, array(mp.inverse(turn(0)))
    whole, about_centre = np.cross(w.r, w.v), np.cross(w.r - w.r_C, w.v)
    moments, axes = map(array, mp.eigsy(mp.matrix(w.I.tolist())))
    along = axes.T @ W
    values = values_along(dynamicsymbols("phi theta psi X Y Z"), PATH)
    printed = {name: array(evaluate(getattr(lecture(), name), values)) for name in PRINTED}
    return {
        1: [near(w.sum(w.r) / w.M, w.r_C)],
        2: [near(w.sum(dot(w.v, w.v)) / 2, w.M * dot(w.v_C, w.v_C) / 2 + w.turning)],
        3: [near(w.x_dot, np.cross(W, w.x))],
        4: [near(dot(W, w.I @ W) / 2, w.turning)],
        5: [near(np.array([dot(W, R @ axis) for axis in e]), in_body)],
        6: [near(dot(W, R @ axis), dot(inverse @ W, axis)) for axis in e],
        7: [near(R @ (inverse @ W), W)],
        8: [near(dot(in_body, R.T @ w.I @ R @ in_body) / 2, w.turning)],
        9: [near(R.T @ w.I @ R, w.tensor(w.at_rest))],
        10: [near(dot(moments, along**2) / 2, w.turning)],
        11: [near(w.sum(whole), np.cross(w.r_C, w.M * w.v_C) + w.momentum)],
        12: [near(w.sum(about_centre), w.momentum)],  # the momentum about the centre alone is L_R
        13: [near(w.I @ W, w.momentum), near(dot(w.momentum, W), 2 * w.turning)],
        14: [near(axes.T @ w.momentum, moments * along)],
        15: [near(w.x @ (w.R_dot @ R.T).T, w.x_dot)],
        16: [near(array(hat(in_body)), R.T @ w.R_dot)],
        17: [near(printed["rotation_matrix"], R)],
        18: [near(printed["angular_velocity_body"], in_body)],
    }


PRINTED = ("rotation_matrix", "angular_velocity_body")


def test_every_equation_is_proved_and_true_of_the_cloud():
    true = equations(World())
    steps = {s.number: s for s in lecture().steps if s.quantity.name in PRINTED}
    stated = {s.number: s for s in theory() if s.number} | steps
    assert [*true] == [*stated] == list(range(1, 19))
    for number, statement in stated.items():
        assert all(true[number]), number
        assert statement.proofs
    for statement in (*theory(), *steps.values()):
        assert all(proof.is_exact and proof.residual is None for proof in statement.proofs)


def test_energy_and_momentum_of_any_tensor_are_the_sums_over_particles():
    cloud, letters = World(), dynamicsymbols("phi theta psi X Y Z")
    body, names = rs.general_inertia(), ["kinetic_energy", "angular_momentum"]
    motion = rs.derive("ZXZ", names, body=body)
    tensor = cloud.tensor(cloud.at_rest)
    values = values_along(letters, PATH) | {sp.Symbol("M"): cloud.M}
    values |= {sp.Symbol(f"I_{i + 1}{k + 1}"): tensor[i, k] for i in range(3) for k in range(3)}
    energy, momentum = (array(evaluate(motion.step(n).expression, values)) for n in names)
    assert near(energy, cloud.sum(dot(cloud.v, cloud.v)) / 2)
    assert near(momentum, cloud.sum(np.cross(cloud.r, cloud.v)))


@pytest.mark.parametrize("statement", theory(), ids=lambda statement: statement.name)
def test_what_is_claimed_can_fail(statement: Statement):
    """The same claims with something left over are refuted: no proof passes by being empty."""
    work = theory_of.Equations()
    ring = work.codec.ring
    for name, claim in statement.claims:
        rows = [[entry + ring.one for entry in row] for row in work.residuals[name].rows]
        work.residuals[name] = RingMatrix.of(ring, rows)
        with pytest.raises(DerivationError, match="is false; left over"):
            work.proofs([(name, claim)])


def test_the_note_numbers_the_equations_as_the_lecture_does():
    note = lecture().note()
    numbers = {equation.label: equation.number for equation in note.document.equations}
    assert set(range(1, 19)) <= set(numbers.values())
    assert numbered_by_tex(note.latex()) == numbers
    statements = json.loads(json.dumps(record(lecture(), {})))["theory"]
    assert [s["number"] for s in statements if s["number"]] == list(range(1, 17))


def test_the_theory_goes_with_any_rotation_and_says_what_it_cannot():
    motion = rs.derive("unit_quaternion", ["rotation_matrix"], theory=True)
    assert motion.is_proved
    assert "principal axes" in motion.note().markdown()
    with pytest.raises(ModelError, match="active"):
        rs.derive(rs.EulerAngles("ZXZ", passive=True), theory=True)
    text = 'theory = true\n[rotation]\nsequence = "ZXZ"\npassive = true'
    with pytest.raises(SpecError, match=r"theory: .*active"):
        read_spec(text, source="file", name="mine")


phi, theta, psi = dynamicsymbols("phi theta psi")
phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)


def typed(*rows: str) -> sp.ImmutableMatrix:
    """A matrix in the letters c and s of the angles f, t and p, with their rates F, T and P."""
    names = {
        f"{name}{angle}": function(q)
        for name, function in (("c", cos), ("s", sin))
        for angle, q in (("f", phi), ("t", theta), ("p", psi))
    }
    names |= {"F": phi_dot, "T": theta_dot, "P": psi_dot}
    return sp.ImmutableMatrix([[sp.sympify(e, names) for e in row.split(",")] for row in rows])


TYPED = {
    "rotation_matrix": typed(
        "cf*cp - sf*sp*ct, -cf*sp - sf*cp*ct, sf*st",
        "sf*cp + cf*sp*ct, cf*cp*ct - sf*sp, -cf*st",
        "sp*st, cp*st, ct",
    ),
    "spin_matrix": typed(
        "0, -F - P*ct, sf*T - P*cf*st",
        "F + P*ct, 0, -P*sf*st - cf*T",
        "P*cf*st - sf*T, P*sf*st + cf*T, 0",
    ),
    "angular_velocity_space": typed("P*sf*st + cf*T", "sf*T - P*cf*st", "F + P*ct"),
    "angular_velocity_body": typed("F*sp*st + T*cp", "F*st*cp - T*sp", "F*ct + P"),
}


@pytest.mark.parametrize("quantity", TYPED)
def test_the_printed_formulas_are_derived_term_by_term(quantity):
    derived = getattr(lecture(), quantity)
    assert derived.shape == TYPED[quantity].shape
    assert [*derived] == [*TYPED[quantity]]


def test_equation_17_is_the_product_as_written():
    """Of R_z and R_x as the lecture prints them below it."""

    def turn_z(beta):
        return sp.Matrix([[cos(beta), -sin(beta), 0], [sin(beta), cos(beta), 0], [0, 0, 1]])

    turn_x = sp.Matrix([[1, 0, 0], [0, cos(theta), -sin(theta)], [0, sin(theta), cos(theta)]])
    motion = rs.derive("ZXZ")
    assert motion.model.matrix == turn_z(phi) * turn_x * turn_z(psi)
    assert rs.EulerAngles("313") == motion.model
    # "for θ = 0 all φ and ψ of one sum lead to one orientation"
    assert [p.places[0].value for p in motion.singularities.points] == [0, sp.pi]
    assert [tuple(p.null_rates) for p in motion.singularities.points] == [(1, 0, -1), (1, 0, 1)]
    level = motion.rotation_matrix.subs(theta, 0) - turn_z(phi + psi).applyfunc(sp.expand_trig)
    assert level.applyfunc(sp.expand) == sp.zeros(3)


def test_sources_are_published_books_and_the_lecture_for_its_own_angles():
    sources = {step.quantity.name: step.quantity.source for step in lecture().steps}
    assert sources["rotation_matrix"] == SOURCES["Landau 35"]
    assert sources["spin_matrix"] == sources["angular_velocity_body"] == SOURCES["Murray 2.4"]
    assert PRESETS["lecture_angles"].source == cited("17", "section 3.2")


@pytest.mark.usefixtures("tex")
def test_its_note_through_tex_without_a_warning():
    assert typeset(lecture().note().latex()).warnings == ()
