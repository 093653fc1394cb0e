"""Equations 1 to 18 of the lecture: proved in the ring, and true of one cloud of particles.

The cloud moves and turns along a path in 50 digits; nothing of the derivation takes part in it.
"""

from __future__ import annotations

import json
import random
from functools import cache
from typing import Any

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.typesetting import numbered_by_tex
from helpers.witness import (
    cross,
    derivative,
    dot,
    evaluate,
    hat,
    mp,
    paths,
    rotation,
    unhat,
    values_along,
)
from rigidsym.errors import DerivationError, ModelError, SpecError
from rigidsym.mechanics import lecture as theory_of
from rigidsym.mechanics.derivation import Statement
from rigidsym.mechanics.lecture import theory
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.record import record
from rigidsym.pipeline import output_of, read_file, read_spec

(PATH,) = paths(1, size=6, seed=7)
SMALL = mp.mpf(10) ** -38
LECTURE = read_file("lecture")


@cache
def lecture() -> rs.Motion:
    return output_of(LECTURE).motion


def vector(*parts: Any) -> Any:
    return mp.matrix(parts)


def near(first: Any, second: Any) -> bool:
    difference = first - second
    entries = list(difference) if hasattr(difference, "rows") else [difference]
    return all(abs(entry) < SMALL for entry in entries)


class World:
    """A cloud of particles that moves; sums over it are sums over it."""

    def __init__(self) -> None:
        source = random.Random(3)
        self.m = [mp.mpf(source.randint(1, 50)) / 7 for _ in range(6)]
        self.M = sum(self.m)
        free = [vector(*(mp.mpf(source.randint(-50, 50)) / 11 for _ in range(3))) for _ in self.m]
        mean = self.sum(free) / self.M
        self.at_rest = [place - mean for place in free]
        self.R = self.turn(0)
        self.R_dot = derivative(self.turn)
        self.omega = unhat(self.R_dot * self.R.T)
        self.r_C, self.v_C = self.centre(0), derivative(self.centre)
        self.r = [self.place(x)(0) for x in self.at_rest]
        self.v = [derivative(self.place(x)) for x in self.at_rest]
        self.x = [r - self.sum(self.r) / self.M for r in self.r]
        self.x_dot = [v - self.sum(self.v) / self.M for v in self.v]
        self.e = [vector(*(int(j == k) for k in range(3))) for j in range(3)]
        self.I = self.tensor(self.x)

    def turn(self, t: Any) -> Any:
        return rotation("ZXZ", PATH.at(t)[:3])

    def centre(self, t: Any) -> Any:
        return vector(*PATH.at(t)[3:])

    def place(self, x: Any) -> Any:
        return lambda t: self.centre(t) + self.turn(t) * x

    def sum(self, values: list[Any]) -> Any:
        """Σ m of what belongs to the particles."""
        first, *others = (m * value for m, value in zip(self.m, values, strict=True))
        return sum(others, first)

    def tensor(self, places: list[Any]) -> Any:
        """Equation 4, entry by entry."""
        result = mp.matrix(3, 3)
        for j in range(3):
            for k in range(3):
                result[j, k] = self.sum(
                    [dot(cross(self.e[j], x), cross(self.e[k], x)) for x in places]
                )
        return result

    @property
    def energy(self) -> Any:
        return self.sum([dot(v, v) for v in self.v]) / 2

    @property
    def turning(self) -> Any:
        return self.sum([dot(v, v) for v in self.x_dot]) / 2

    @property
    def momentum(self) -> Any:
        return self.sum([cross(x, v) for x, v in zip(self.x, self.x_dot, strict=True)])

    def principal(self) -> tuple[Any, Any, Any]:
        """The principal moments, the rotation to their axes, and Ω along these."""
        moments, axes = mp.eigsy(self.I)
        return moments, axes, axes.T * self.omega

    def values(self) -> dict[sp.Expr, Any]:
        coordinates = dynamicsymbols("phi theta psi X Y Z")
        return values_along(coordinates, PATH)


def equations(w: World) -> dict[int, list[bool]]:
    """Each equation of the lecture, read as a statement on sums over the particles."""
    R, W, e = w.R, w.omega, w.e
    pairs = list(zip(w.x, w.x_dot, strict=True))
    in_body, inverse = R.T * W, mp.inverse(R)
    whole = w.sum([cross(r, v) for r, v in zip(w.r, w.v, strict=True)])
    about_centre = [cross(r - w.r_C, v) for r, v in zip(w.r, w.v, strict=True)]
    moments, axes, along = w.principal()
    printed = {n: evaluate(getattr(lecture(), n), w.values()) for n in PRINTED}
    return {
        1: [near(w.sum(w.r) / w.M, w.r_C)],
        2: [near(w.energy, w.M * dot(w.v_C, w.v_C) / 2 + w.turning)],
        3: [near(v, cross(W, x)) for x, v in pairs],
        4: [near(dot(W, w.I * W) / 2, w.turning)],
        5: [near(vector(*(dot(W, R * axis) for axis in e)), in_body)],
        6: [near(dot(W, R * axis), dot(inverse * W, axis)) for axis in e],
        7: [near(R * (inverse * W), W)],
        8: [near(dot(in_body, R.T * w.I * R * in_body) / 2, w.turning)],
        9: [near(R.T * w.I * R, w.tensor(w.at_rest))],
        10: [near(sum(moments[k] * along[k] ** 2 for k in range(3)) / 2, w.turning)],
        11: [near(whole, cross(w.r_C, w.M * w.v_C) + w.momentum)],
        12: [near(w.sum(about_centre), w.momentum)],  # the momentum about the centre alone is L_R
        13: [near(w.I * W, w.momentum), near(dot(w.momentum, W), 2 * w.turning)],
        14: [near(axes.T * w.momentum, vector(*(moments[k] * along[k] for k in range(3))))],
        15: [near(w.R_dot * R.T * x, v) for x, v in pairs],
        16: [near(hat(in_body), R.T * w.R_dot)],
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


@pytest.mark.parametrize("statement", theory(), ids=lambda statement: statement.name)
def test_what_is_claimed_can_fail(statement: Statement):
    """The same claims with something left over are refuted: no proof passes by being empty."""
    work = theory_of.Equations()
    one = work.codec.ring.one
    for name, claim in statement.claims:
        work.residuals[name] = work.residuals[name].map(lambda entry: entry + one)
        with pytest.raises(DerivationError, match="is false; left over"):
            work.proofs(statement._replace(claims=((name, claim),)))


def test_without_the_centre_of_mass_only_the_splits_of_energy_and_momentum_fail():
    """They rest on Σ m x = 0, and nothing else does."""
    work = theory_of.Equations()
    work.about_centre = {}
    lost = []
    for statement in theory():
        try:
            proved = all(proof.is_exact for proof in work.proofs(statement))
        except DerivationError:
            proved = False
        if not proved:
            lost.append(statement.number)
    assert lost == [2, 11, 12]


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


@pytest.mark.usefixtures("tex")
def test_its_note_through_tex_without_a_warning():
    assert typeset(lecture().note().latex()).warnings == ()
