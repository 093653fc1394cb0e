"""Problems on Euler angles; every answer comes from a derivation."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from random import Random

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, Formula, Matrix, Numeral, Symbol, equal, indexed, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.notes.document.document import Equation
from rigidsym.notes.facts.rotation import turn
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.problems.exercise import Asked, Exercise, exercise, numeral
from rigidsym.notes.sections.compose import equation_of

SEQUENCES = ("ZXZ", "XYX", "YZY", "ZYZ", "XZX", "YXY", "ZYX", "XYZ", "YZX", "ZXY", "XZY", "YXZ")
_PLACES = {"X": 0, "Y": 1, "Z": 2}


def which_convention(rng: Random) -> Exercise:
    """The sequence of turns behind a matrix in symbols."""
    right, *wrong = rng.sample(SEQUENCES, 5)
    found = derive(EulerAngles(right), ("rotation_matrix",))
    letters = letters_of(found.arguments)
    i, j = _PLACES[right[0]] + 1, _PLACES[right[2]] + 1
    entry = found.step("rotation_matrix").expression[i - 1, j - 1]
    product = row(*(turn(each, letters) for each in found.model.turns))
    return exercise(
        "which_convention",
        [Asked(choices=(right, *wrong))],
        found.arguments,
        matrix=_displayed(found, "rotation_matrix"),
        entry=equal(formula(f"R_{{{i}{j}}}"), formula_of(entry, letters)),
        is_proper=right[0] == right[2],
        first=Symbol(right[0].lower()),
        middle=Symbol(right[1].lower()),
        last=Symbol(right[2].lower()),
        product=Equation(sides=(ROTATION, product)),
    )


def angular_velocity(rng: Random) -> Exercise:
    """Ω or Ω′ from angles and rates in numbers."""
    sequence = rng.choice(SEQUENCES)
    frame = rng.choice([SPACE, BODY])
    name = f"angular_velocity_{frame.name}"
    found = derive(EulerAngles(sequence), ("angular_velocity_space", name))
    angles, rates = _angles(rng), [rng.choice((-3, -2, -1, 1, 2, 3)) for _ in range(3)]
    value = _in_numbers(found.step(name).expression, found, angles, rates)
    return exercise(
        "angular_velocity",
        [
            Asked(symbol=entry, value=float(part), unit="rad/s")
            for entry, part in zip(indexed(frame.omega, (3,)), value, strict=True)
        ],
        found.arguments,
        sequence=sequence,
        angles=_values(found.argument("q").notation, angles),
        rates=_values(found.argument("q_dot").notation, rates),
        omega=frame.omega,
        is_in_space=frame is SPACE,
        components=_displayed(found, name),
    )


def gimbal_lock(rng: Random) -> Exercise:
    """Where the rates are lost, and how large they become nearby."""
    sequence = rng.choice(SEQUENCES)
    found = derive(EulerAngles(sequence))
    facts = singular_facts(found)
    assert facts is not None
    determinant = facts.found.determinant
    near = rng.randrange(1, 16)
    theta = near if sequence[0] == sequence[2] else 90 - near
    matrix = sp.ImmutableMatrix([determinant])
    (value,) = _in_numbers(matrix, found, [0, theta, 0], [0, 0, 0])
    letters = letters_of(found.arguments)
    return exercise(
        "gimbal_lock",
        [
            Asked(symbol=formula(r"|\det\mathbf{W}|"), value=abs(float(value))),
            Asked(symbol=formula(r"1/|\det\mathbf{W}|"), value=1 / abs(float(value))),
        ],
        found.arguments,
        sequence=sequence,
        theta=theta,
        determinant=Equation(sides=(*facts.measured, formula_of(determinant, letters))),
        singular=facts,
    )


def identify(rng: Random) -> Exercise:
    """The convention of measured angles, from the attitude that belongs to them."""
    right, *wrong = rng.sample(SEQUENCES, 4)
    angles = _angles(rng)
    derived = {s: derive(EulerAngles(s), ("rotation_matrix",)) for s in (right, *wrong)}
    matrices = {
        s: _in_numbers(found.step("rotation_matrix").expression, found, angles, [0, 0, 0])
        for s, found in derived.items()
    }
    shown = matrices[right].applyfunc(lambda entry: sp.Rational(str(round(float(entry), 3))))
    apart = {s: max(abs(float(e)) for e in m - matrices[right]) for s, m in matrices.items()}
    arguments = derived[right].arguments
    rows = [[_to_three_places(float(entry)) for entry in line] for line in shown.tolist()]
    return exercise(
        "identify",
        [Asked(choices=(right, *wrong))],
        arguments,
        angles=_values(derived[right].argument("q").notation, angles),
        matrix=Equation(sides=(ROTATION, Matrix(tuple(map(tuple, rows))))),
        sequences=sorted(apart),
        deviations=[{"sequence": s, "deviation": f"{apart[s]:.2f}"} for s in sorted(apart)],
    )


def _to_three_places(value: float) -> Formula:
    digits = Numeral(f"{abs(value):.3f}")
    return row(MINUS, digits) if value < 0 else digits


def _angles(rng: Random) -> list[int]:
    return [rng.randrange(-170, 171, 10), rng.randrange(20, 80, 5), rng.randrange(-170, 171, 10)]


def _values(names: Sequence[Formula], values: Sequence[float]) -> list[Formula]:
    """φ = 30, θ = 40, ψ = 50."""
    pairs = zip(names, values, strict=True)
    return [equal(name, numeral(value)) for name, value in pairs]


def _displayed(found: Derivation, name: str) -> Equation:
    equation = equation_of(found.step(name), found.arguments)
    return Equation(sides=equation.sides[:1], matrix=equation.matrix, entries=equation.entries)


def _in_numbers(
    matrix: sp.MatrixBase, found: Derivation, angles: Sequence[float], rates: Sequence[float]
) -> sp.ImmutableMatrix:
    """The matrix at angles in degrees and rates in rad/s."""
    q, q_dot = (found.argument(name).symbols for name in ("q", "q_dot"))
    moving = dict(zip(q_dot, map(sp.Float, rates), strict=True))
    still = dict(zip(q, (sp.Float(radians(angle)) for angle in angles), strict=True))
    return matrix.xreplace(moving).xreplace(still)
