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
from rigidsym.notes.formats.terminal import show
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

    def equation_1(self) -> bool:
        return near(self.sum(self.r) / self.M, self.r_C)

    def equation_2(self) -> bool:
        return near(self.energy, self.M * dot(self.v_C, self.v_C) / 2 + self.turning)

    def equation_3(self) -> bool:
        pairs = zip(self.x, self.x_dot, strict=True)
        return all(near(v, cross(self.omega, x)) for x, v in pairs)

    def equation_4(self) -> bool:
        squares = [[x[1] ** 2 + x[2] ** 2, -x[0] * x[1], -x[0] * x[2]] for x in self.x]
        first_row = [self.sum([row[k] for row in squares]) for k in range(3)]
        is_a_form = near(dot(self.omega, self.I * self.omega) / 2, self.turning)
        return is_a_form and near(vector(*first_row), self.I[0, :].T)

    def equation_5(self) -> bool:
        along = [dot(self.omega, self.R * e) for e in self.e]
        return near(vector(*along), self.R.T * self.omega)

    def equation_6(self) -> bool:
        inverse = mp.inverse(self.R)
        return all(near(dot(self.omega, self.R * e), dot(inverse * self.omega, e)) for e in self.e)

    def equation_7(self) -> bool:
        return near(self.R * (mp.inverse(self.R) * self.omega), self.omega)

    def equation_8(self) -> bool:
        in_body = self.R.T * self.omega
        return near(dot(in_body, self.R.T * self.I * self.R * in_body) / 2, self.turning)

    def equation_9(self) -> bool:
        return near(self.R.T * self.I * self.R, self.tensor(self.at_rest))

    def equation_10(self) -> bool:
        moments, _, omega = self.principal()
        return near(sum(moments[k] * omega[k] ** 2 for k in range(3)) / 2, self.turning)

    def equation_11(self) -> bool:
        whole = self.sum([cross(r, v) for r, v in zip(self.r, self.v, strict=True)])
        return near(whole, cross(self.r_C, self.M * self.v_C) + self.momentum)

    def equation_12(self) -> bool:
        """The parts of 11: the momentum about the centre alone is L_R."""
        about_centre = [cross(r - self.r_C, v) for r, v in zip(self.r, self.v, strict=True)]
        return near(self.sum(about_centre), self.momentum)

    def equation_13(self) -> bool:
        return near(self.I * self.omega, self.momentum) and near(
            dot(self.momentum, self.omega), 2 * self.turning
        )

    def equation_14(self) -> bool:
        moments, axes, omega = self.principal()
        parts = vector(*(moments[k] * omega[k] for k in range(3)))
        return near(axes.T * self.momentum, parts)

    def equation_15(self) -> bool:
        pairs = zip(self.x, self.x_dot, strict=True)
        return all(near(self.R_dot * self.R.T * x, v) for x, v in pairs)

    def equation_16(self) -> bool:
        return near(hat(self.R.T * self.omega), self.R.T * self.R_dot)

    def equation_17(self) -> bool:
        return near(evaluate(lecture().rotation_matrix, self.values()), self.R)

    def equation_18(self) -> bool:
        printed = evaluate(lecture().angular_velocity_body, self.values())
        return near(printed, self.R.T * self.omega)


@cache
def world() -> World:
    return World()


def proofs_of(number: int) -> list[Any]:
    found = [p for s in theory() if s.number == number for p in s.proofs]
    return found + [p for s in lecture().steps if s.number == number for p in s.proofs]


@pytest.mark.parametrize("number", range(1, 19))
def test_equation(number):
    """Proved, with nothing left over, and true of the cloud."""
    proofs = proofs_of(number)
    assert proofs
    assert all(proof.is_exact and proof.residual is None for proof in proofs)
    assert getattr(world(), f"equation_{number}")()


def test_the_equations_stand_in_order():
    numbers = [statement.number for statement in theory() if statement.number]
    assert numbers == list(range(1, 17))
    steps = {step.quantity.name: step.number for step in lecture().steps}
    assert (steps["rotation_matrix"], steps["angular_velocity_body"]) == (17, 18)
    assert all(str(s.number) == s.source.equation for s in theory() if s.number)


def test_the_tensor_of_section_2_2_is_the_one_printed():
    m, a, b, c = sp.symbols("m_i a_i b_i c_i")
    (found,) = [s.summands for s in theory() if s.summands is not None]
    assert found == m * sp.Matrix(
        [
            [b**2 + c**2, -a * b, -a * c],
            [-a * b, a**2 + c**2, -b * c],
            [-a * c, -b * c, a**2 + b**2],
        ]
    )


def test_the_moment_about_a_line_is_a_sum_of_squared_distances():
    e = vector(2, 3, 6) / 7
    across = [x - dot(x, e) * e for x in world().x]
    moment = world().sum([dot(d, d) for d in across])
    assert near(dot(e, world().I * e), moment)


def test_the_intermediate_lines_are_true_of_the_cloud():
    """The lines between the numbers, each typed here again and summed over the particles."""
    w, half = world(), mp.mpf(1) / 2
    moving = [w.v_C + v for v in w.x_dot]
    squares = w.sum([dot(w.v_C, w.v_C) + 2 * dot(v, w.v_C) + dot(v, v) for v in w.x_dot])
    energies = [half * w.sum([dot(v, v) for v in moving]), half * squares]
    energies += [half * w.M * dot(w.v_C, w.v_C) + dot(w.v_C, w.sum(w.x_dot)) + w.turning]
    assert all(near(energy, w.energy) for energy in energies)
    entries = [w.omega[j] * w.omega[k] * w.I[j, k] for j in range(3) for k in range(3)]
    assert near(half * sum(entries), w.turning)
    pairs = list(zip(w.x, w.x_dot, strict=True))
    products = w.sum([cross(w.r_C + x, w.v_C + v) for x, v in pairs])
    parts = cross(w.r_C, w.M * w.v_C) + cross(w.r_C, w.sum(w.x_dot)) + cross(w.sum(w.x), w.v_C)
    assert near(products, parts + w.momentum)
    assert near(w.sum([dot(x, x) * w.omega - dot(x, w.omega) * x for x in w.x]), w.momentum)


def test_every_line_between_the_numbers_has_a_proof_of_its_own():
    between = [s for s in theory() if s.number is None]
    assert {s.name for s in between} >= {"energy_expanded", "energy_as_a_form", "momentum_expanded"}
    assert all(s.proofs and all(p.is_exact for p in s.proofs) for s in between)


@pytest.mark.parametrize("statement", theory(), ids=lambda statement: statement.name)
def test_what_is_claimed_can_fail(statement: Statement):
    """The same claims with something left over are refuted: no proof passes by being empty."""
    work = theory_of.Equations()
    one = work.codec.ring.one
    for name, claim in statement.claims:
        work.residuals[name] = work.residuals[name].map(lambda entry: entry + one)
        with pytest.raises(DerivationError, match="is false; left over"):
            work.proofs(statement._replace(claims=((name, claim),)))


def is_proved(work: Any, statement: Statement) -> bool:
    try:
        return all(proof.is_exact for proof in work.proofs(statement))
    except DerivationError:
        return False


def test_without_the_centre_of_mass_nothing_splits():
    """Σ m x = 0 is what the splits of energy and momentum rest on, and nothing else does."""
    work = theory_of.Equations()
    work.about_centre = {}
    lost = [statement.number for statement in theory() if not is_proved(work, statement)]
    assert lost == [2, 11, 12]


def test_the_note_holds_every_number_once():
    note = lecture().note()
    latex = note.latex()
    numbers = {equation.label: equation.number for equation in note.document.equations}
    assert set(range(1, 19)) <= set(numbers.values())
    assert len(set(numbers.values())) == len(numbers)
    assert numbered_by_tex(latex) == numbers
    assert "is proved for the generic summand" in latex
    assert "used here, and not proved" in latex  # principal axes exist


def test_the_terminal_and_the_record_hold_the_theory():
    shown = show(lecture())
    assert "(2)   E_K = E_C + E_R = ½M |ṙ_C|² + ½ Σ mᵢ |ẋᵢ|²" in shown
    assert "✓ (2)  exact     ½ Σ mᵢ |ṙᵢ|² = E_C + E_R" in shown
    data = json.loads(json.dumps(record(lecture(), {})))
    assert [s["number"] for s in data["theory"] if s["number"]] == list(range(1, 17))
    assert {p["status"] for s in data["theory"] for p in s["proofs"]} == {"exact"}


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
