"""Problems on Euler angles; every answer comes from a derivation."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from random import Random

import sympy as sp

from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, Formula, Matrix, Numeral, equal, indexed, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.quantities.kinematics import BODY, ROTATION, SPACE
from rigidsym.models.euler_angles import EulerAngles
from rigidsym.notes.document.document import Equation, Paragraph, Text, listed, said
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.problems.exercise import Asked, Exercise, numeral
from rigidsym.notes.prose.singular_words import failures, measured
from rigidsym.notes.prose.words import turn
from rigidsym.notes.sections.compose import equation_of

SEQUENCES = ("ZXZ", "XYX", "YZY", "ZYZ", "XZX", "YXY", "ZYX", "XYZ", "YZX", "ZXY", "XZY", "YXZ")
_PLACES = {"X": 0, "Y": 1, "Z": 2}
_ANGLES = "the angles $\\phi$, $\\theta$, $\\psi$, in this order"


def which_convention(rng: Random) -> Exercise:
    """The sequence of turns behind a matrix in symbols."""
    right, *wrong = rng.sample(SEQUENCES, 5)
    found = derive(EulerAngles(right), ("rotation_matrix",))
    letters = letters_of(found.arguments)
    i, j = _PLACES[right[0]] + 1, _PLACES[right[2]] + 1
    entry = found.step("rotation_matrix").expression[i - 1, j - 1]
    product = row(*(turn(each, letters) for each in found.model.turns))
    middle = "xyz"[_PLACES[right[1]]]
    first, last = "xyz"[i - 1], "xyz"[j - 1]
    outer = f"the first axis is the ${first}$-axis, the last one the ${last}$-axis"
    if right[0] == right[2]:
        outer = f"both outer turns are about the ${first}$-axis"
        why = (
            "For $\\phi = \\psi = 0$ the turn by $\\theta$ is left, which keeps the "
            f"${middle}$-axis."
        )
    else:
        why = f"The axis of the middle turn is then the third one, the ${middle}$-axis."
    return Exercise(
        title="Which convention?",
        question=(
            said(r"A rotation $\mathbf{R}$ is the product of three turns about axes of the body,"),
            _displayed(found, "rotation_matrix"),
            said(f"with {_ANGLES}. About which axes are the turns?"),
        ),
        solution=(
            said(
                f"Turns about the first axis leave the row of this axis as it is, and turns about "
                f"the last axis the column of that axis. So the entry where both meet depends on "
                f"$\\theta$ only. It is {{}}: {outer}. {why}",
                equal(formula(f"R_{{{i}{j}}}"), formula_of(entry, letters)),
            ),
            said("As a product of turns about these axes the rotation is"),
            Equation(sides=(ROTATION, product)),
        ),
        answers=(Asked(choices=(right, *wrong)),),
        arguments=found.arguments,
    )


def angular_velocity(rng: Random) -> Exercise:
    """Ω or Ω′ from angles and rates in numbers."""
    sequence = rng.choice(SEQUENCES)
    frame, axes = rng.choice([(SPACE, "space"), (BODY, "the body")])
    name = f"angular_velocity_{frame.name}"
    found = derive(EulerAngles(sequence), ("angular_velocity_space", name))
    angles, rates = _angles(rng), [rng.choice((-3, -2, -1, 1, 2, 3)) for _ in range(3)]
    value = _in_numbers(found.step(name).expression, found, angles, rates)
    return Exercise(
        title="The angular velocity",
        question=(
            _paragraph(
                (f"A body is turned by the {sequence} Euler angles ",),
                _values(found.argument("q").notation, angles, "°"),
                (", in this order. They change at the rates ",),
                _values(found.argument("q_dot").notation, rates, " rad/s"),
                sentence(
                    f". Find the components of the angular velocity {{}} along the axes of {axes}.",
                    frame.omega,
                ),
            ),
        ),
        solution=(
            said("Each turn adds its rate about its own axis. In components this is"),
            _displayed(found, name),
            said("The given angles and rates are put in."),
        ),
        answers=tuple(
            Asked(symbol=entry, value=float(part), unit="rad/s")
            for entry, part in zip(indexed(frame.omega, (3,)), value, strict=True)
        ),
        arguments=found.arguments,
    )


def gimbal_lock(rng: Random) -> Exercise:
    """Where the rates are lost, and how large they become nearby."""
    sequence = rng.choice(SEQUENCES)
    found = derive(EulerAngles(sequence))
    assert found.singularities is not None
    determinant = found.singularities.determinant
    near = rng.randrange(1, 16)
    theta = near if sequence[0] == sequence[2] else 90 - near
    matrix = sp.ImmutableMatrix([determinant])
    (value,) = _in_numbers(matrix, found, [0, theta, 0], [0, 0, 0])
    letters = letters_of(found.arguments)
    return Exercise(
        title="Gimbal lock",
        question=(
            said(
                f"Show where the rates of the {sequence} Euler angles $\\phi$, $\\theta$ and "
                "$\\psi$ do not follow from the angular velocity, and what is lost there. How "
                "large is the determinant of the rate matrix $\\mathbf{W}$ at "
                f"$\\theta = {theta}$°, and by which factor may a single rate exceed the angular "
                "velocity there?"
            ),
        ),
        solution=(
            said("Both rate matrices have the determinant"),
            Equation(sides=(*measured(found.singularities), formula_of(determinant, letters))),
            *map(Paragraph, failures(found, found.singularities)),
            said("Solving for the rates divides by this determinant."),
        ),
        answers=(
            Asked(symbol=formula(r"|\det\mathbf{W}|"), value=abs(float(value))),
            Asked(symbol=formula(r"1/|\det\mathbf{W}|"), value=1 / abs(float(value))),
        ),
        arguments=found.arguments,
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
    return Exercise(
        title="Identify the convention",
        question=(
            _paragraph(
                ("A log of attitudes holds the angles ",),
                _values(derived[right].argument("q").notation, angles, "°"),
                (" and, for the same moment, the rotation matrix",),
            ),
            Equation(sides=(ROTATION, Matrix(tuple(map(tuple, rows))))),
            said(f"of three turns about axes of the body. Which of {_words(sorted(apart))} is it?"),
        ),
        solution=(
            _paragraph(
                ("The matrix of each sequence deviates in its worst entry by ",),
                listed([(f"{apart[s]:.2f} for {s}",) for s in sorted(apart)]),
                (".",),
            ),
        ),
        answers=(Asked(choices=(right, *wrong)),),
        arguments=arguments,
    )


def _to_three_places(value: float) -> Formula:
    digits = Numeral(f"{abs(value):.3f}")
    return row(MINUS, digits) if value < 0 else digits


def _words(names: Sequence[str]) -> str:
    """XYZ, XZY and ZXZ."""
    *others, last = names
    return f"{', '.join(others)} and {last}"


def _paragraph(*texts: Text) -> Paragraph:
    return Paragraph(tuple(span for text in texts for span in text))


def _angles(rng: Random) -> list[int]:
    return [rng.randrange(-170, 171, 10), rng.randrange(20, 80, 5), rng.randrange(-170, 171, 10)]


def _values(names: Sequence[Formula], values: Sequence[float], unit: str) -> Text:
    """φ = 30°, θ = 40° and ψ = 50°."""
    pairs = zip(names, values, strict=True)
    return listed([(equal(name, numeral(value)), unit) for name, value in pairs])


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
