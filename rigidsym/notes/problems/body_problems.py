"""Problems on moments of inertia; every answer comes from the integrals of the body."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Bracket, equal, joined
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.models.body import Composite, Part, RigidBody
from rigidsym.models.solids import shaped
from rigidsym.notes.document.document import Equation
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.problems.exercise import Asked, Exercise, exercise, numeral


def drilled_block(rng: Random) -> Exercise:
    """The moments of a block with a hole drilled beside its centre."""
    a, b, c = (sp.Rational(rng.randrange(4, 11, 2), 10) for _ in range(3))
    radius, aside = a / 8, a / 4
    density = 100 * rng.randrange(5, 28)
    block = shaped("box", (a, b, c), density=sp.Integer(density))
    hole = shaped("cylinder", (radius, c), density=sp.Integer(density))
    at = sp.ImmutableMatrix([aside, 0, 0])
    parts = (Part(what=block), Part(what=hole, at=at, hole=True))
    whole = rigid_body(Composite(parts=parts))
    of_parts = [rigid_body(part.what) for part in parts]
    return exercise(
        "drilled_block",
        [
            Asked(symbol=formula("M"), value=float(whole.mass), unit="kg"),
            Asked(symbol=formula("x_C"), value=float(whole.centre[0]), unit="m"),
            *_answers(whole),
        ],
        edges=[_length(edge) for edge in (a, b, c)],
        density=density,
        radius=_length(radius),
        aside=_length(aside),
        parts=[_moments(k, body) for k, body in enumerate(of_parts, start=1)],
        place=equal(formula("x_2"), numeral(float(aside))),
    )


def parallel_axis(rng: Random) -> Exercise:
    """The moment of a solid about an axis beside its centre of mass."""
    name, count = rng.choice([("cylinder", 2), ("cone", 2), ("sphere", 1), ("hemisphere", 1)])
    lengths = [sp.Rational(rng.randrange(2, 10), 10) for _ in range(count)]
    mass, distance = rng.randrange(1, 20), sp.Rational(rng.randrange(2, 12), 10)
    solid = shaped(name, lengths, mass=sp.Integer(mass))
    body = rigid_body(solid)
    own = body.inertia[2, 2]
    names = sp.symbols("a h")[:count]
    general = rigid_body(shaped(name, names, mass=sp.Symbol("M")))
    moment = formula_of(general.inertia[2, 2], letters_of(()))
    return exercise(
        "parallel_axis",
        [
            Asked(symbol=formula("I_3"), value=float(own), unit="kg m²"),
            Asked(symbol=formula("I"), value=float(own + mass * distance**2), unit="kg m²"),
        ],
        solid=solid.title.lower(),
        radius=_length(lengths[0]),
        height=_length(lengths[1]) if count > 1 else "",
        mass=mass,
        distance=_length(distance),
        moment=Equation(sides=(formula("I_3"), moment)),
    )


def rotational_energy(rng: Random) -> Exercise:
    """E_R, L and the angle between L and Ω of a body in its principal axes."""
    moments = [sp.Integer(rng.randrange(4, 8)) for _ in range(3)]
    omega = sp.Matrix([rng.choice((-3, -2, -1, 1, 2, 3)) for _ in range(3)])
    inertia = sp.diag(*moments)
    momentum = inertia * omega
    energy = omega.dot(momentum) / 2
    cosine = 2 * energy / sp.sqrt(omega.dot(omega) * momentum.dot(momentum))
    return exercise(
        "rotational_energy",
        [
            Asked(symbol=formula("E_R"), value=float(energy), unit="J"),
            Asked(
                symbol=formula(r"|\mathbf{L}|"),
                value=float(sp.sqrt(momentum.dot(momentum))),
                unit="kg m²/s",
            ),
            Asked(symbol=formula(r"\alpha"), value=float(sp.deg(sp.acos(cosine))), unit="°"),
        ],
        moments=[numeral(float(moment)) for moment in moments],
        omega=[numeral(float(part)) for part in omega],
    )


def _moments(place: int, body: RigidBody) -> Equation:
    """m₁ = 36 kg, J₁ = (0.4, 1.2, 1.5) kg m²."""
    entries = [numeral(float(moment)) for moment in body.inertia.diagonal()]
    typed = rf"m_{place} = #1\text{{ kg}}\qquad\mathbf{{J}}_{place} = #2\text{{ kg m}}^2"
    moments = Bracket(joined(entries, COMMA))
    return Equation(sides=(formula(typed, numeral(float(body.mass)), moments),))


def _answers(whole: RigidBody) -> Iterator[Asked]:
    for k, moment in enumerate(whole.inertia.diagonal(), start=1):
        yield Asked(symbol=formula(f"I_{k}"), value=float(moment), unit="kg m²")


def _length(value: sp.Rational) -> str:
    return f"{float(value):g}"
