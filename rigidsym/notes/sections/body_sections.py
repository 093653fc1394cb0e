"""What a note and a terminal say of a body: how its mass is spread, and its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

import sympy as sp

from rigidsym.data.mass.properties import MassProperties
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Big, Differential, Formula, bracketed, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.mechanics.mass.numbers import in_numbers
from rigidsym.mechanics.quantities.mass import PLACE
from rigidsym.models.body import Parameter, RigidBody
from rigidsym.models.distribution import (
    UPRIGHT,
    Composite,
    Known,
    Part,
    Particles,
    Polyhedron,
    Solid,
)
from rigidsym.notes.document.document import (
    Equation,
    NoteBlock,
    NoteTable,
    Paragraph,
    Text,
    listed,
    said,
)
from rigidsym.notes.prose.words import unit_in_words, vector

_KINDS = ("length", "area", "volume")
_DIGITS = 6


def blocks_of_body(derivation: Derivation, letters: Letters) -> Iterator[NoteBlock]:
    """How the mass of the body is spread, with its integrals, and its values in numbers."""
    body = derivation.body
    if body is None:
        return
    yield from _parameters(derivation, body, letters)
    match body.distribution:
        case Solid():
            yield from _solid(body.distribution, letters)
        case Composite():
            yield said("The body is composed of the following parts.")
            yield _parts(body.distribution.parts, letters)
            shown: set[str] = set()
            for part in body.distribution.parts:  # the first of each kind
                if isinstance(part.what, Solid) and part.what.title not in shown:
                    shown.add(part.what.title)
                    yield from _solid(part.what, letters, part.label)
        case Particles():
            yield _particles(body.distribution, letters)
        case Polyhedron():
            yield Paragraph(
                (
                    "The solid is bounded by plane faces. Its integrals are sums over the "
                    "tetrahedra between the origin and the faces, with a minus sign for those "
                    "outside.",
                )
            )
    yield from _numbers(body, letters)


def _parameters(derivation: Derivation, body: RigidBody, letters: Letters) -> Iterator[NoteBlock]:
    """What the letters of the body are; those with a value are in the table of numbers.

    The mass of a body on which forces act may not be in any equation.
    """
    told = [p for p in body.parameters if p.about and p.value is None]
    if derivation.forces is not None:
        shown = [step.expression for step in derivation.steps]
        told = [p for p in told if any(entry.has(p.symbol) for entry in shown)]
    if told:
        yield Paragraph(("Here ", *listed([*_called(told, letters)], ", and "), "."))


def _called(told: Sequence[Parameter], letters: Letters) -> Iterator[Text]:
    """m is the mass, A and C are the principal moments of inertia."""
    for about, alike in groupby(told, key=lambda p: p.about):
        names = [(formula_of(p.symbol, letters),) for p in alike]
        if about == "principal moment of inertia" and len(names) > 1:
            yield (*listed(names), " are the principal moments of inertia")
        else:
            yield from ((*name, f" is the {about}") for name in names)


def _solid(solid: Solid, letters: Letters, label: str = "") -> Iterator[NoteBlock]:
    """The map, its bounds, the element and the integrals of a solid."""
    yield said(f"The points of the {label or solid.title.lower()} are")
    yield Equation(sides=(PLACE,), matrix=solid.place)
    bounds = [
        _between(u, pair, letters) for u, pair in zip(solid.coordinates, solid.bounds, strict=True)
    ]
    yield Paragraph(("for ", *listed(bounds), "."))
    element = moments_of(solid).element
    assert element is not None
    element = sp.factor(element)
    yield Paragraph(_element(solid, element, letters))
    density = sp.S.One if solid.density is None else solid.density
    value = density * element
    integrand = NOTHING if value == 1 else bracketed(formula_of(value, letters))
    total = formula_of(_total(solid), letters)
    yield Equation(sides=(_integral(solid, integrand, letters), total))


def _total(solid: Solid) -> sp.Expr:
    """What the integral of the density, or of the element alone, comes to."""
    plain = solid if solid.mass is None else replace(solid, mass=None, density=sp.S.One)
    return moments_of(plain).mass


def _element(solid: Solid, element: sp.Expr, letters: Letters) -> Text:
    """The element of volume, area or length, and how the mass follows from it."""
    count = len(solid.coordinates)
    spread = _differentials(solid.coordinates, letters)
    whole = row(*([] if element == 1 else [formula_of(element, letters)]), *spread)
    how = (
        "the Jacobian determinant of this map"
        if count == 3
        else "the square root of det JᵀJ, where J is the Jacobian matrix of this map"
    )
    factor = "" if element == 1 else f"; the factor is {how}"
    head = sentence(f"The element of {_KINDS[count - 1]} is {{}}{factor}. ", whole)
    if solid.mass is not None:
        mass = formula_of(solid.mass, letters)
        uniform = (
            "The density is uniform, and its integral is the mass {}. The element integrates to"
        )
        return (*head, *sentence(uniform, mass))
    return (*head, "The mass is the integral of the density,")


def _between(u: sp.Symbol, pair: tuple[sp.Expr, sp.Expr], letters: Letters) -> Text:
    low, high = (formula_of(bound, letters) for bound in pair)
    return (formula(r"#1 \le #2 \le #3", low, formula_of(u, letters), high),)


def _integral(solid: Solid, integrand: Formula, letters: Letters) -> Formula:
    """∫∫∫ of an integrand, the outermost first."""
    bounds = ((formula_of(low, letters), formula_of(high, letters)) for low, high in solid.bounds)
    signs = (Big("∫", low, high) for low, high in bounds)
    return row(*signs, integrand, *_differentials(solid.coordinates[::-1], letters))


def _differentials(coordinates: Sequence[sp.Symbol], letters: Letters) -> list[Formula]:
    """du dv dw."""
    return [part for u in coordinates for part in (Differential(), formula_of(u, letters))]


def _parts(parts: Sequence[Part], letters: Letters) -> NoteTable:
    return NoteTable(
        caption="The parts, each in its own axes, then turned and moved",
        head=(("Part",), ("Mass",), ("Moved by",), ("Turned",)),
        rows=tuple(
            (
                (_named(part),),
                (*(("−",) if part.hole else ()), formula_of(moments_of(part.what).mass, letters)),
                vector(part.at, letters),
                ("no",) if part.turned == UPRIGHT else ("yes",),
            )
            for part in parts
        ),
    )


def _named(part: Part) -> str:
    kinds = {
        Particles: "particles",
        Composite: "composite",
        Polyhedron: "polyhedron",
        Known: "measured",
    }
    kind = part.what.title if isinstance(part.what, Solid) else kinds[type(part.what)]
    return part.label or f"{kind}{' (hole)' if part.hole else ''}"


def _particles(given: Particles, letters: Letters) -> NoteTable:
    return NoteTable(
        caption="The particles",
        head=(("Mass",), ("Position",)),
        rows=tuple(
            ((formula_of(particle.mass, letters),), vector(particle.position, letters))
            for particle in given.particles
        ),
    )


def _numbers(body: RigidBody, letters: Letters) -> Iterator[NoteBlock]:
    """The values of the parameters, and what follows from them in numbers."""
    if body.values:
        yield NoteTable(
            caption="The parameters in numbers",
            head=(("Parameter",), ("Meaning",), ("Value",), ("Unit",)),
            rows=tuple(
                (
                    (formula_of(p.symbol, letters),),
                    (p.about or "—",),
                    (number(p.value),),
                    (unit_in_words(p.unit),),
                )
                for p in body.parameters
                if p.value is not None
            ),
        )
    found = in_numbers(body)
    if found is not None:
        yield _principal(found)
        if found.principal.repeated:
            yield Paragraph((found.principal.repeated,))


def _principal(found: MassProperties) -> NoteTable:
    """The principal moments in ascending order, each with its axis."""
    principal = found.principal
    return NoteTable(
        caption="Principal moments and right-handed principal axes, in numbers",
        head=(("Moment, kg m²",), ("Radius of gyration, m",), ("Axis, body components",)),
        rows=tuple(
            (
                (number(float(moment)),),
                (number(float(radius)),),
                ("(" + ", ".join(number(float(part)) for part in axis) + ")",),
            )
            for moment, radius, axis in zip(
                principal.moments, found.radii, principal.axes.T, strict=True
            )
        ),
    )


def number(value: float) -> str:
    """A number as a reader wants it."""
    return f"{value + 0.0:.{_DIGITS}g}".replace("-", "−")


def lines_of_body(derivation: Derivation, letters: Letters) -> Iterator[str]:
    """For a terminal: the values, and the principal axes in numbers."""
    body = derivation.body
    if body is None:
        return
    for p in body.parameters:
        if p.value is not None:
            unit = f" {unit_in_words(p.unit)}" if p.unit else ""
            about = f"   {p.about}" if p.about else ""
            yield f"{formula_of(p.symbol, letters).text} = {number(p.value)}{unit}{about}"
    found = in_numbers(body)
    if found is None:
        return
    principal = found.principal  # ascending, which the numbers of a formula's moments need not be
    for moment, axis in zip(principal.moments, principal.axes.T, strict=True):
        along = ", ".join(number(float(part)) for part in axis)
        yield f"principal moment {number(float(moment))} kg m² about ({along})"
    if principal.repeated:
        yield principal.repeated
