"""What a note and a terminal say of a body: how its mass is spread, and its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.data.mass.properties import MassProperties
from rigidsym.mechanics.derivation import Derivation, Markup
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.mechanics.mass.numbers import in_numbers
from rigidsym.mechanics.quantities.mass import PLACE
from rigidsym.models.body import RigidBody
from rigidsym.models.distribution import (
    UPRIGHT,
    Composite,
    Known,
    Part,
    Particles,
    Polyhedron,
    Solid,
)
from rigidsym.notes.document.document import Block, Equation, Paragraph, Table, Text
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.layout.entries import indexed
from rigidsym.notes.prose.words import listed, unit_in_words, words

_KINDS = ("the length", "the area", "the volume")
_DIGITS = 6


def blocks_of_body(derivation: Derivation, notation: Notation) -> Iterator[Block]:
    """How the mass of the body is spread, with its integrals, and its values in numbers."""
    body = derivation.body
    if body is None:
        return
    match body.distribution:
        case Solid():
            yield from _solid(body.distribution, notation)
        case Composite():
            yield Paragraph((f"{body.title}: it is put together from parts.",))
            yield _parts(body.distribution.parts, notation)
            solids = (part.what for part in body.distribution.parts)
            for solid in dict.fromkeys(what for what in solids if isinstance(what, Solid)):
                yield from _solid(solid, notation)
        case Particles():
            yield _particles(body.distribution, notation)
        case Polyhedron():
            yield Paragraph(
                (
                    "The solid is bounded by plane faces; it is the sum of the tetrahedra between "
                    "the origin and its faces, those outside with a minus sign.",
                )
            )
    yield from _numbers(body, notation)


def _solid(solid: Solid, notation: Notation) -> Iterator[Block]:
    """The map, its bounds, the element and the integrals of a solid."""
    yield Paragraph((f"{solid.title}: its points are",))
    yield Equation(sides=(PLACE,), matrix=solid.place, entries=indexed(PLACE, (3,)))
    bounds = [
        _between(u, pair, notation) for u, pair in zip(solid.coordinates, solid.bounds, strict=True)
    ]
    yield Paragraph(("for ", *listed(bounds), "."))
    element = moments_of(solid).element
    assert element is not None
    yield Paragraph(_element(solid, element, notation))
    density = sp.S.One if solid.density is None else solid.density
    integrand = _bracketed(markup(density * element, notation))
    total = markup(_total(solid), notation)
    yield Equation(sides=(_integral(solid, integrand, notation), total))


def _total(solid: Solid) -> sp.Expr:
    """What the integral of the density, or of the element alone, comes to."""
    plain = solid if solid.mass is None else replace(solid, mass=None, density=sp.S.One)
    return moments_of(plain).mass


def _element(solid: Solid, element: sp.Expr, notation: Notation) -> Text:
    """What a unit of the coordinates measures, and what the mass has to do with it."""
    count = len(solid.coordinates)
    kind, value = _KINDS[count - 1], markup(element, notation)
    differentials = "".join(f"d{u}" for u in solid.coordinates)
    spread = Markup(
        r"\," + r"\,".join(rf"d{markup(u, notation).latex}" for u in solid.coordinates),
        differentials,
    )
    how = (
        ", the determinant of this map," if count == 3 else ", whose square is det JᵀJ of this map,"
    )
    head = words(f"To {{}} belongs {kind} {{}} {{}}{how} ", spread, value, spread)
    if solid.mass is not None:
        mass = markup(solid.mass, notation)
        return (*head, *words("and the mass {} is spread evenly over", mass), f" {kind}")
    return (*head, "and the mass is the integral")


def _between(u: sp.Symbol, pair: tuple[sp.Expr, sp.Expr], notation: Notation) -> Text:
    low, high = (markup(bound, notation) for bound in pair)
    name = markup(u, notation)
    return (
        Markup(
            rf"{low.latex} \le {name.latex} \le {high.latex}",
            f"{low.text} ≤ {name.text} ≤ {high.text}",
        ),
    )


def _integral(solid: Solid, integrand: Markup, notation: Notation) -> Markup:
    """∫∫∫ of an integrand, the outermost first."""
    signs, texts = "", ""
    for low, high in solid.bounds:
        below, above = markup(low, notation), markup(high, notation)
        signs += rf"\int_{{{below.latex}}}^{{{above.latex}}}"
        texts += "∫"
    ends = [markup(u, notation) for u in reversed(solid.coordinates)]
    return Markup(
        signs + integrand.latex + "".join(rf"\,d{u.latex}" for u in ends),
        f"{texts} {integrand.text}" + "".join(f" d{u.text}" for u in ends),
    )


def _bracketed(formula: Markup) -> Markup:
    """A sum in brackets; a product without."""
    if " + " not in formula.text and " − " not in formula.text:
        return formula
    return Markup(rf"\left({formula.latex}\right)", f"({formula.text})")


def _parts(parts: Sequence[Part], notation: Notation) -> Table:
    return Table(
        caption="The parts, each in its own axes, then turned and moved",
        head=(("Part",), ("Mass",), ("Moved by",), ("Turned",)),
        rows=tuple(
            (
                (_named(part),),
                (*(("−",) if part.hole else ()), markup(moments_of(part.what).mass, notation)),
                _triple(part.at, notation),
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


def _particles(given: Particles, notation: Notation) -> Table:
    return Table(
        caption="The particles",
        head=(("Mass",), ("Place",)),
        rows=tuple(
            ((markup(particle.mass, notation),), _triple(particle.position, notation))
            for particle in given.particles
        ),
    )


def _triple(column: sp.MatrixBase, notation: Notation) -> Text:
    return ("(", *listed([(markup(entry, notation),) for entry in column], ", "), ")")


def _numbers(body: RigidBody, notation: Notation) -> Iterator[Block]:
    """The values of the parameters, and what follows from them in numbers."""
    if body.values:
        yield Table(
            caption="The parameters in numbers",
            head=(("Parameter",), ("Meaning",), ("Value",), ("Unit",)),
            rows=tuple(
                (
                    (markup(p.symbol, notation),),
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


def _principal(found: MassProperties) -> Table:
    """The principal moments in ascending order, each with its axis."""
    principal = found.principal
    return Table(
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


def lines_of_body(derivation: Derivation, notation: Notation) -> Iterator[str]:
    """For a terminal: the values, and the principal axes in numbers."""
    body = derivation.body
    if body is None:
        return
    for p in body.parameters:
        if p.value is not None:
            unit = f" {unit_in_words(p.unit)}" if p.unit else ""
            about = f"   {p.about}" if p.about else ""
            yield f"{markup(p.symbol, notation).text} = {number(p.value)}{unit}{about}"
    found = in_numbers(body)
    if found is None:
        return
    names = ("₁", "₂", "₃")
    for name, moment, axis in zip(
        names, found.principal.moments, found.principal.axes.T, strict=True
    ):
        along = ", ".join(number(float(part)) for part in axis)
        yield f"I{name} = {number(float(moment))} kg m² about ({along})"
    if found.principal.repeated:
        yield found.principal.repeated
