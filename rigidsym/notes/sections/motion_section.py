"""The section on motion: what moves, the first integrals, and what follows from them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial, reduce

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal, formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.dynamics import LETTERS
from rigidsym.models.example import OMEGA_COMPONENTS, Example, initial_values
from rigidsym.models.forces import OMEGA_BODY, MovingPart
from rigidsym.models.rotation import TIME
from rigidsym.notes.document.document import (
    Equation,
    EquationRow,
    Figure,
    NoteBlock,
    Paragraph,
    Span,
    Strong,
    Text,
    listed,
    said,
)
from rigidsym.notes.figure.motion_picture import motion_picture
from rigidsym.notes.figure.phase_portrait import phase_portrait

_BECAUSE = {True: "Their rates vanish by the equations of motion, which is proved.", False: ""}


def what_moves(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """Parts that move with the body, the frame, and what takes the place of the rates."""
    forces = derivation.forces
    if forces is None:
        return
    for part in forces.parts:
        yield Paragraph(_part(part, letters))
    if forces.frame_rate:
        rate = [formula_of(entry, letters) for entry in forces.frame_rate]
        yield said(
            "The frame of reference turns with the constant angular velocity ({}, {}, {}).", *rate
        )
    if "torque_body" in {step.quantity.name for step in derivation.steps}:
        yield said(
            "The state is ({}, {}): the rates of the coordinates follow from the angular velocity, "
            "and its rate from Euler's equations. They hold for any torque {}.",
            *(formula(typed) for typed in (r"\mathbf{q}", r"\boldsymbol{\Omega}'", r"\mathbf{N}'")),
        )


def _part(part: MovingPart, letters: Letters) -> Text:
    entries = [formula_of(entry, letters) for entry in (*part.velocity, *part.inertia)]
    if part.rotation is None:
        return sentence(
            "A point of mass {} moves with the body, with the velocity ({}, {}, {}) in space.",
            *(entries[3], *entries[:3]),
        )
    turns = listed([(formula_of(turn.angle, letters),) for turn in part.rotation.turns])
    moments = sentence(" only; its principal moments are {}, {} and {}.", *entries)
    return ("Another body turns with it by ", *turns, *moments)


def what_is_constant(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """First integrals."""
    integrals = derivation.first_integrals
    if integrals:
        is_proved = all(integral.proof.is_exact for integral in integrals)
        yield said(
            f"The first integrals are constant along every motion. {_BECAUSE[is_proved]}".strip()
        )
    for integral in integrals:
        yield Equation(sides=(integral.symbol, formula_of(integral.expression, letters)))


def what_follows(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """The motion as a whole: effective potential, steady motions, exact solutions."""
    letters = replace(letters, names={**letters.names, **LETTERS})

    def printed(span: Formula | sp.Expr) -> Formula:
        return span if isinstance(span, Formula) else formula_of(span, letters)

    for found in derivation.consequences:
        head = (Strong(f"{found.title}."), " ") if found.title else ()
        yield Paragraph((*head, *sentence(found.text, *map(printed, found.spans))))
        claims = [proof.claim for proof in found.proofs]
        exact = all(proof.is_exact for proof in found.proofs)
        yield Equation(
            sides=(printed(found.left), printed(found.value)),
            proved=tuple(claims) if exact else (),
            unproved=() if exact else tuple(claims),
        )
        if found.where:
            yield said("Here")
            sides = (tuple(map(printed, pair)) for pair in found.where)
            yield EquationRow(tuple(Equation(sides=pair) for pair in sides))
        if found.title == "The effective potential":
            yield from _phase_portrait(derivation, letters)
    yield from _pictures(derivation, letters)


def _phase_portrait(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    shown = phase_portrait(derivation, letters)
    if shown is not None:
        given = [
            (formula("#1 = #2", letters.name(symbol), formula_of(value, letters)),)
            for symbol, value in shown.momenta.items()
        ]
        caption = sentence(
            "The phase portrait of {}, for constants of 1 and momenta of ", shown.name
        )
        description = sentence(
            "Each curve is the motion with one energy, and the mark in the middle is the steady "
            "motion."
        )
        yield Figure(shown.drawing, (*caption, *listed(given), "."), description)


_TRACES = {
    "axis": "The curve on the unit sphere is the trace of the third body axis, which stays between "
    "the circles of its lowest and highest points.",
    "polhode": "The polhode is the path of the angular velocity on the ellipsoid of energy.",
    "polhodes": "The polhodes, paths of the angular velocity on the ellipsoid of energy, belong to "
    "this motion and to others with the same parameters.",
    "path": "The curve in the plane is the path of the point of mass, seen from above.",
}
_CAPTIONS = {  # whether there are several motions; with neither, one or both of what they share
    False: (
        "The motion in SI units and radians; all initial values are 0.",
        "The motion for {}, in SI units and radians; all other initial values are 0.",
        "The motion for {}, which begins with {}, in SI units and radians; all other initial "
        "values are 0.",
    ),
    True: (
        "Motions in SI units and radians; all initial values are 0 but for these, from left to "
        "right: {}.",
        "Motions for {}, in SI units and radians; all other initial values are 0 but for these, "
        "from left to right: {}.",
        "Motions for {}, which begin with {}, in SI units and radians; all other initial values "
        "are 0 but for these, from left to right: {}.",
    ),
}
_ON_A_SURFACE = "Dashed lines are behind the surface."


def _pictures(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """The examples, with their numbers in the caption."""
    shown = motion_picture(derivation, letters)
    if shown is None or derivation.forces is None:
        return
    given = [_numbers(derivation, letters, e) for e in derivation.forces.examples[: shown.told]]
    parameters, initial = (
        listed([(each,) for each in part if all(each in other[k] for other in given)])
        for k, part in enumerate(given[0])
    )
    own = [
        [
            each
            for k, part in enumerate(one)
            for each in part
            if any(each not in o[k] for o in given)
        ]
        for one in given
    ]
    differing = listed([(reduce(partial(formula, "#1, #2"), each),) for each in own if each])
    shared = [part for part in (parameters, initial) if part]
    caption = _filled(_CAPTIONS[len(given) > 1][len(shared)], *shared, differing)
    traces = [_TRACES[kind] for kind in shown.traces]
    if {*shown.traces} - {"path"}:
        traces.append(_ON_A_SURFACE)
    yield Figure(shown.drawing, caption, sentence(" ".join(traces)))


def _filled(typed: str, *lists: Text) -> Text:
    """The text with a list of formulas for each {}."""
    first, *others = typed.split("{}")
    found: list[Span] = [first]
    for spans, part in zip(lists, others, strict=False):
        found += [*spans, part]
    return tuple(found)


def _numbers(
    derivation: Derivation, letters: Letters, example: Example
) -> tuple[list[Formula], list[Formula]]:
    """The parameters of an example, and its initial values but for those that are 0 in all."""
    forces = derivation.forces
    assert forces is not None
    q = derivation.model.coordinates
    known = {x.func.__name__: letters.name(x) for x in q}
    known |= {f"{x.func.__name__}_dot": letters.name(sp.diff(x, TIME)) for x in q}
    known |= {n: formula_of(w, letters) for n, w in zip(OMEGA_COMPONENTS, OMEGA_BODY, strict=True)}
    start = initial_values(derivation.model, example.initial)
    named = {name for each in forces.examples for name, value in each.initial.items() if value}
    named |= {name for name, value in start.items() if value}
    parameters = [
        formula("#1 = #2", formula_of(sp.Symbol(name), letters), decimal(value))
        for name, value in example.parameters.items()
    ]
    initial = [
        formula("#1 = #2", known[name], decimal(value))
        for name, value in start.items()
        if name in named
    ]
    return parameters, initial
