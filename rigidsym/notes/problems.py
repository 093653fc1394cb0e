"""Problems with worked solutions: each is a template, and every answer comes from a derivation."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_HALF_UP, Context
from math import radians
from random import Random
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.errors import ModelError, offer
from rigidsym.formula.reader import decimal, formula
from rigidsym.formula.tree import Formula, Symbol, equal, indexed
from rigidsym.mechanics.derivation import Argument
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.models.solids import shaped
from rigidsym.notes.document import (
    Document,
    NoteBlock,
    Paragraph,
    Section,
    Strong,
    Text,
    listed,
)
from rigidsym.notes.facts.rotation import product_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.letters import letters_of
from rigidsym.notes.template import sections_of

SEQUENCES = ("ZXZ", "XYX", "YZY", "ZYZ", "XZX", "YXY", "ZYX", "XYZ", "YZX", "ZXY", "XZY", "YXZ")
_RATES = (-3, -2, -1, 1, 2, 3)  # small whole numbers, so that a student can calculate by hand
_DRAWS = 8  # of one kind, before the next one is tried


class Answer(NamedTuple):
    """A number with its symbol and unit."""

    symbol: Formula
    value: float
    unit: str = ""

    @property
    def text(self) -> Text:
        unit = self.unit if self.unit in ("", "°") else f"\u00a0{self.unit}".replace(" ", "\u00a0")
        return (equal(self.symbol, numeral(self.value)), unit)


@dataclass(frozen=True, kw_only=True, slots=True)
class Problem:
    """A question and its solution, which leads to the answers."""

    title: str
    question: tuple[NoteBlock, ...]
    solution: tuple[NoteBlock, ...]
    answers: tuple[Answer | str, ...]
    arguments: tuple[Argument, ...] = ()  # whose letters the formulas have

    @property
    def answer(self) -> Paragraph:
        texts = [(each,) if isinstance(each, str) else each.text for each in self.answers]
        return Paragraph((Strong("Answer:"), " ", *listed(texts), "."))

    @property
    def solved(self) -> tuple[NoteBlock, ...]:
        """The question, its solution and the answers."""
        first, *others = self.solution
        assert isinstance(first, Paragraph)
        worked = Paragraph((Strong("Solution."), " ", *first.text))
        return (*self.question, worked, *others, self.answer)


def _problem(
    template: str,
    answers: Iterable[Answer | str],
    arguments: tuple[Argument, ...] = (),
    **facts: Any,
) -> Problem:
    """The problem that a template of templates/notes/en/problems states, and its solution."""
    letters = letters_of(arguments)
    _, question, solution = sections_of(f"en/problems/{template}", letters, **facts)
    return Problem(
        title=question.title,
        question=question.blocks,
        solution=solution.blocks,
        answers=tuple(answers),
        arguments=arguments,
    )


def which_convention(rng: Random) -> Problem:
    """The sequence of rotations behind a matrix in symbols."""
    sequence = rng.choice(SEQUENCES)
    found = derive(EulerAngles(sequence), ("rotation_matrix",))
    first, middle, last = map(str.lower, sequence)
    # With the first axis i and the last axis j, R_ij = e_i·R e_j depends on the middle angle only:
    # the outer rotations leave e_i and e_j as they are.
    i, j = ("xyz".index(axis) for axis in (first, last))
    return _problem(
        "which_convention",
        [sequence],
        found.arguments,
        matrix=found.rotation_matrix,
        entry=formula(f"R_{{{i + 1}{j + 1}}}"),
        value=found.rotation_matrix[i, j],
        is_proper=first == last,
        first=Symbol(first),
        middle=Symbol(middle),
        last=Symbol(last),
        product=product_of(found.model.turns, letters_of(found.arguments)),
    )


def angular_velocity(rng: Random) -> Problem:
    """Ω or Ω′ from angles and rates in numbers."""
    sequence, frame = rng.choice(SEQUENCES), rng.choice([SPACE, BODY])
    name = f"angular_velocity_{frame.name}"
    found = derive(EulerAngles(sequence), ("angular_velocity_space", name))
    q, q_dot = found.argument("q"), found.argument("q_dot")
    # The middle angle keeps away from 0° and 90°, one of which is gimbal lock.
    angles = [rng.randrange(-170, 171, 10), rng.randrange(20, 80, 5), rng.randrange(-170, 171, 10)]
    rates = [rng.choice(_RATES) for _ in range(3)]
    value = found.step(name).expression.xreplace(dict(zip(q_dot.symbols, rates, strict=True)))
    value = value.xreplace(dict(zip(q.symbols, map(sp.Float, map(radians, angles)), strict=True)))
    entries = indexed(frame.omega, (3,))
    return _problem(
        "angular_velocity",
        [Answer(e, float(part), "rad/s") for e, part in zip(entries, value, strict=True)],
        found.arguments,
        sequence=sequence,
        angles=_values(q.notation, angles),
        rates=_values(q_dot.notation, rates),
        omega=frame.omega,
        is_in_space=frame is SPACE,
        components=found.step(name).expression,
    )


def gimbal_lock(rng: Random) -> Problem:
    """Where the rates are lost, and how large they become nearby."""
    sequence = rng.choice(SEQUENCES)
    found = derive(EulerAngles(sequence))
    facts = singular_facts(found)
    assert facts is not None
    assert facts.found.determinant is not None
    away = rng.randrange(1, 16)  # degrees from gimbal lock
    # |det W| is sin θ for proper Euler angles and cos θ for Tait-Bryan angles.
    theta = away if sequence[0] == sequence[2] else 90 - away
    angle = sp.Float(radians(theta))
    size = abs(float(facts.found.determinant.xreplace({found.model.coordinates[1]: angle})))
    determinant = formula(r"|\det\mathbf{W}|")
    return _problem(
        "gimbal_lock",
        [Answer(determinant, size), Answer(formula("1/#1", determinant), 1 / size)],
        found.arguments,
        sequence=sequence,
        theta=theta,
        singular=facts,
        model=found.model,
    )


def parallel_axis(rng: Random) -> Problem:
    """The moment of a solid about an axis beside its centre of mass."""
    name, count = rng.choice([("cylinder", 2), ("cone", 2), ("sphere", 1), ("hemisphere", 1)])
    lengths = [sp.Rational(rng.randrange(2, 10), 10) for _ in range(count)]
    mass, distance = rng.randrange(1, 20), sp.Rational(rng.randrange(2, 12), 10)
    solid = shaped(name, lengths, mass=sp.Integer(mass))
    own = rigid_body(solid).inertia[2, 2]
    in_letters = rigid_body(shaped(name, sp.symbols("a h")[:count], mass=sp.Symbol("M")))
    return _problem(
        "parallel_axis",
        [
            Answer(formula("I_3"), float(own), "kg m²"),
            Answer(formula("I"), float(own + mass * distance**2), "kg m²"),
        ],
        solid=solid.title.lower(),
        radius=numeral(float(lengths[0])),
        height=numeral(float(lengths[1])) if count > 1 else None,
        mass=mass,
        distance=numeral(float(distance)),
        moment=in_letters.inertia[2, 2],
    )


def rotational_energy(rng: Random) -> Problem:
    """E_R, L and the angle between L and Ω of a body in its principal axes."""
    moments = [sp.Integer(rng.randrange(4, 8)) for _ in range(3)]
    omega = sp.Matrix([rng.choice(_RATES) for _ in range(3)])
    momentum = sp.diag(*moments) * omega
    size, twice_the_energy = momentum.norm(), omega.dot(momentum)
    # cos α = L·Ω/(|L| |Ω|), and L·Ω is twice the energy.
    angle = sp.deg(sp.acos(twice_the_energy / (omega.norm() * size)))
    return _problem(
        "rotational_energy",
        [
            Answer(formula("E_R"), float(twice_the_energy / 2), "J"),
            Answer(formula(r"|\mathbf{L}|"), float(size), "kg m²/s"),
            Answer(formula(r"\alpha"), float(angle), "°"),
        ],
        moments=[numeral(float(moment)) for moment in moments],
        omega=[numeral(float(part)) for part in omega],
    )


Kinds = Sequence[Callable[[Random], Problem]]
_EULER: Kinds = (which_convention, angular_velocity, gimbal_lock)
_BODIES: Kinds = (parallel_axis, rotational_energy)
SUBJECTS: dict[str, tuple[str, Kinds]] = {  # title, and kinds in turn
    "euler": ("Euler angles", _EULER),
    "bodies": ("Moments of inertia", _BODIES),
    "all": ("Rotations and rigid bodies", (*_EULER, *_BODIES)),
}


def sheets_of(subject: str, *, count: int, variant: int) -> tuple[Document, Document]:
    """The sheet of a subject, and the sheet with its solutions.

    The same variant is the same sheet. Raises ModelError for a subject that is not in SUBJECTS.
    """
    if subject not in SUBJECTS:
        raise ModelError(f"no problems on {subject!r}; {offer(subject, [*SUBJECTS])}")
    title, kinds = SUBJECTS[subject]
    problems = problems_of(kinds, count, f"{subject} {variant}")
    sheet = Document(
        name=f"problems_{subject}_{variant}",
        title="Problems",
        subtitle=f"{title}, variant {variant}",
        letters=letters_of([a for problem in problems for a in problem.arguments]),
        sections=tuple(Section(p.title, p.question) for p in problems),
    )
    solved = tuple(Section(p.title, p.solved) for p in problems)
    return sheet, replace(sheet, name=f"{sheet.name}_solutions", title="Solutions", sections=solved)


def problems_of(kinds: Kinds, count: int, seed: str) -> list[Problem]:
    """`count` problems of some kinds in turn, no two of which have one question or one answer.

    A problem is drawn again; if its kind has no other, the next kind follows.
    """
    problems: list[Problem] = []
    for k in range(count):
        for draw in itertools.count():
            kind = kinds[(k + draw // _DRAWS) % len(kinds)]
            drawn = kind(Random(f"{seed} {k} {draw}"))
            if all(p.question != drawn.question and p.answer != drawn.answer for p in problems):
                problems.append(drawn)
                break
    return problems


def numeral(value: float) -> Formula:
    """A number with four digits at most; 18.275 is rounded up, as students do."""
    rounded = Context(prec=4, rounding=ROUND_HALF_UP).create_decimal(f"{value:.12g}")
    return decimal(float(rounded), most=4)


def _values(names: Sequence[Formula], values: Sequence[float]) -> list[Formula]:
    """φ = 30, θ = 40, ψ = 50."""
    return [equal(name, numeral(value)) for name, value in zip(names, values, strict=True)]
