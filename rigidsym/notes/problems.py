"""Problems with worked solutions: a template each, whose numbers come from a derivation."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from decimal import ROUND_HALF_UP, Context
from math import degrees, radians
from random import Random
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from rigidsym.errors import ModelError, offer
from rigidsym.formula.reader import decimal
from rigidsym.formula.tree import Formula, equal, indexed
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.mass.bodies import solid
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.notes.document import Document, Section
from rigidsym.notes.facts.rotation import product_of
from rigidsym.notes.facts.singular import singular_facts
from rigidsym.notes.letters import letters_of
from rigidsym.notes.template import sections_of

Facts = Mapping[str, Any]
Kind = Callable[[Random], Facts]

_SEQUENCES = [sequence for sequence in EULER_SEQUENCES if sequence.isupper()]
_RATES = (-3, -2, -1, 1, 2, 3)  # small whole numbers, so that a student can calculate by hand
_DRAWS = 8  # of one kind, before the next one is tried


class Problem(NamedTuple):
    """A question, and its solution with the answer at its end."""

    question: Section
    solution: Section
    facts: Facts


def which_convention(rng: Random) -> Facts:
    """The sequence of rotations behind a matrix in symbols."""
    sequence = rng.choice(_SEQUENCES)
    derivation = derive(EulerAngles(sequence), ("rotation_matrix",))
    axes = tuple(sequence.lower())
    # With the first axis i and the last axis j, R_ij = e_i·R e_j depends on the middle angle only:
    # the outer rotations leave e_i and e_j as they are.
    i, j = map("xyz".index, (axes[0], axes[2]))
    return {
        "derivation": derivation,
        "sequence": sequence,
        "row": i + 1,
        "column": j + 1,
        "value": derivation.rotation_matrix[i, j],
        "axes": axes,
        "product": product_of(derivation.model.turns, letters_of(derivation.arguments)),
    }


def angular_velocity(rng: Random) -> Facts:
    """Ω or Ω′ from angles and rates in numbers."""
    sequence, frame = rng.choice(_SEQUENCES), rng.choice([SPACE, BODY])
    name = f"angular_velocity_{frame.name}"
    derivation = derive(EulerAngles(sequence), ("angular_velocity_space", name))
    q, q_dot = derivation.argument("q"), derivation.argument("q_dot")
    # The middle angle keeps away from 0° and 90°, one of which is gimbal lock.
    angles = [rng.randrange(-170, 171, 10), rng.randrange(20, 80, 5), rng.randrange(-170, 171, 10)]
    rates = [rng.choice(_RATES) for _ in range(3)]
    components = derivation.step(name).expression
    values = components.xreplace(dict(zip(q_dot.symbols, rates, strict=True)))
    at = zip(q.symbols, map(sp.Float, map(radians, angles)), strict=True)
    values = [float(value) for value in values.xreplace(dict(at))]
    return {
        "derivation": derivation,
        "sequence": sequence,
        "angles": _equations(q.notation, angles),
        "rates": _equations(q_dot.notation, rates),
        "omega": frame.omega,
        "is_in_space": frame is SPACE,
        "components": components,
        "values": values,
        "answers": _equations(indexed(frame.omega, (3,)), values),
    }


def gimbal_lock(rng: Random) -> Facts:
    """Where the rates are lost, and how large they become nearby."""
    sequence = rng.choice(_SEQUENCES)
    derivation = derive(EulerAngles(sequence))
    singular = singular_facts(derivation)
    assert singular is not None
    assert singular.result.determinant is not None
    away = rng.randrange(1, 16)  # degrees from gimbal lock
    # |det W| is sin θ for proper Euler angles and cos θ for Tait-Bryan angles.
    theta = away if sequence[0] == sequence[2] else 90 - away
    angle = {derivation.model.coordinates[1]: sp.Float(radians(theta))}
    size = abs(float(singular.result.determinant.xreplace(angle)))
    return {
        "derivation": derivation,
        "sequence": sequence,
        "theta": theta,
        "singular": singular,
        "model": derivation.model,
        "values": [size, 1 / size],
    }


def parallel_axis(rng: Random) -> Facts:
    """The moment of a solid about an axis beside its centre of mass."""
    name, has_height = rng.choice([("cylinder", 1), ("cone", 1), ("sphere", 0), ("hemisphere", 0)])
    body = solid(name)
    radius, height = (rng.randrange(2, 10) / 10 for _ in "ah")
    mass, distance = rng.randrange(1, 20), rng.randrange(2, 12) / 10
    moment = body.inertia[2, 2]
    own = float(moment.subs({"a": radius, "M": mass}))
    return {
        "solid": body.title.lower(),
        "radius": radius,
        "height": height if has_height else None,
        "mass": mass,
        "distance": distance,
        "moment": moment,
        "values": [own, own + mass * distance**2],
    }


def rotational_energy(rng: Random) -> Facts:
    """E_R, L and the angle between L and Ω of a body in its principal axes."""
    moments = rng.sample(range(4, 9), 3)  # each is less than the sum of the others
    omega = np.array([rng.choice(_RATES) for _ in range(3)])
    momentum = moments * omega
    twice_energy, size = omega @ momentum, np.linalg.norm(momentum)
    # cos α = L·Ω/(|L| |Ω|), and L·Ω is twice the energy.
    angle = degrees(np.arccos(twice_energy / (np.linalg.norm(omega) * size)))
    return {"moments": moments, "omega": omega.tolist(), "values": [twice_energy / 2, size, angle]}


_EULER: tuple[Kind, ...] = (which_convention, angular_velocity, gimbal_lock)
_BODIES: tuple[Kind, ...] = (parallel_axis, rotational_energy)
SUBJECTS = {  # title, and kinds in turn
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
    derivations = [p.facts["derivation"] for p in problems if "derivation" in p.facts]
    sheet = Document(
        name=f"problems_{subject}_{variant}",
        title=("Problems",),
        subtitle=f"{title}, variant {variant}",
        letters=letters_of([argument for d in derivations for argument in d.arguments]),
        sections=tuple(problem.question for problem in problems),
    )
    solved = tuple(
        problem.question._replace(blocks=(*problem.question.blocks, *problem.solution.blocks))
        for problem in problems
    )
    answers = replace(sheet, name=f"{sheet.name}_solutions", title=("Solutions",), sections=solved)
    return sheet, answers


def problems_of(kinds: Sequence[Kind], count: int, seed: str) -> list[Problem]:
    """`count` problems of some kinds in turn, no two of which have one question.

    A problem is drawn again; if its kind has no other, the next kind follows.
    """
    problems: list[Problem] = []
    for k in range(count):
        for draw in itertools.count():
            kind = kinds[(k + draw // _DRAWS) % len(kinds)]
            drawn = problem_of(kind, Random(f"{seed} {k} {draw}"))
            if all(drawn.question != problem.question for problem in problems):
                problems.append(drawn)
                break
    return problems


def problem_of(kind: Kind, rng: Random) -> Problem:
    """A problem of a kind, as the template of this name in templates/notes/en/problems says it."""
    facts = kind(rng)
    letters = letters_of(facts["derivation"].arguments if "derivation" in facts else ())
    template = f"en/problems/{kind.__name__}"
    _, question, solution = sections_of(template, letters, numeral=numeral, **facts)
    return Problem(question, solution, facts)


def numeral(value: float) -> Formula:
    """A number with four digits at most; 18.275 is rounded up, as students do."""
    rounded = Context(prec=4, rounding=ROUND_HALF_UP).create_decimal(f"{value:.12g}")
    return decimal(float(rounded), most=4)


def _equations(names: Sequence[Formula], values: Sequence[float]) -> list[Formula]:
    """φ = 30, θ = 40, ψ = 50."""
    return [equal(name, numeral(value)) for name, value in zip(names, values, strict=True)]
