"""Problems on moments of inertia; every answer comes from the integrals of the body."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import COMMA, Bracket, equal, joined
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.models.body import RigidBody
from rigidsym.models.distribution import Composite, Part
from rigidsym.models.solids import shaped
from rigidsym.notes.document.document import Equation, said
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.problems.exercise import Asked, Exercise, numeral


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
    return Exercise(
        title="A block with a hole",
        question=(
            said(
                f"A block with the edges {_lengths(a, b, c)} along $x$, $y$ and $z$ is made of a "
                f"material of density {density} kg/m³. A hole of radius {_length(radius)} is "
                "drilled through it parallel to $z$, its axis "
                f"{_length(aside)} from the middle along $x$. Find the mass $M$ of the drilled "
                "block, the coordinate $x_C$ of its centre of mass, measured from the middle of "
                "the block, and its moments of inertia $I_1$, $I_2$ and $I_3$ about the axes "
                "through the centre of mass parallel to $x$, $y$ and $z$."
            ),
        ),
        solution=(
            said(
                "The hole is a cylinder of negative mass. The masses of block and cylinder, and "
                "their moments about the axes through their own centres, are"
            ),
            *(_moments(k, body) for k, body in enumerate(of_parts, start=1)),
            said(
                "The block is centred at $x_1 = 0$, the cylinder at {} m. "
                "By $M\\,x_C = m_1 x_1 - m_2 x_2$ the centre of mass moves away from the hole, and "
                "by the parallel-axis theorem each part adds its mass times the square of the "
                "distance of its centre from the axis.",
                equal(formula("x_2"), numeral(float(aside))),
            ),
        ),
        answers=(
            Asked(symbol=formula("M"), value=float(whole.mass), unit="kg"),
            Asked(symbol=formula("x_C"), value=float(whole.centre[0]), unit="m"),
            *_answers(whole),
        ),
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
    sizes = ["a radius $a$", "a height $h$"]
    described = ", ".join(f"{s} of {_length(x)}" for s, x in zip(sizes, lengths, strict=False))
    return Exercise(
        title="The parallel-axis theorem",
        question=(
            said(
                f"A {solid.title.lower()} has {described} and a mass $M$ of {mass} kg. Find its "
                "moment of inertia $I_3$ about its axis of symmetry, and its moment $I$ about a "
                f"parallel axis at the distance $d$ of {_length(distance)}."
            ),
        ),
        solution=(
            said("Integration gives the moment about the axis of symmetry,"),
            Equation(sides=(formula("I_3"), formula_of(general.inertia[2, 2], letters_of(())))),
            said(
                "By the parallel-axis theorem the moment about the other axis is "
                r"$I = I_3 + M\,d^2$."
            ),
        ),
        answers=(
            Asked(symbol=formula("I_3"), value=float(own), unit="kg m²"),
            Asked(symbol=formula("I"), value=float(own + mass * distance**2), unit="kg m²"),
        ),
    )


def rotational_energy(rng: Random) -> Exercise:
    """E_R, L and the angle between L and Ω of a body in its principal axes."""
    moments = [sp.Integer(rng.randrange(4, 8)) for _ in range(3)]
    omega = sp.Matrix([rng.choice((-3, -2, -1, 1, 2, 3)) for _ in range(3)])
    inertia = sp.diag(*moments)
    momentum = inertia * omega
    energy = omega.dot(momentum) / 2
    cosine = 2 * energy / sp.sqrt(omega.dot(omega) * momentum.dot(momentum))
    return Exercise(
        title="Energy and angular momentum",
        question=(
            said(
                "A body has the principal moments $I_1$, $I_2$ and $I_3$ of {}, {} and {} kg m² "
                r"and, along its principal axes, the angular velocity $\boldsymbol{\Omega}'$ = "
                "({}, {}, {}) rad/s. Find the kinetic energy $E_R$ of its rotation, the size "
                r"$|\mathbf{L}|$ of its angular momentum, and the angle $\alpha$ between angular "
                "momentum and angular velocity.",
                *map(numeral, map(float, (*moments, *omega))),
            ),
        ),
        solution=(
            said("In principal axes"),
            Equation(
                sides=(
                    formula("E_R"),
                    formula(
                        r"\tfrac{1}{2}\left(I_1\,{\Omega'_1}^2 + I_2\,{\Omega'_2}^2"
                        r" + I_3\,{\Omega'_3}^2\right)"
                    ),
                )
            ),
            said(
                r"The angular momentum $\mathbf{L}'$ has the components $I_k\,\Omega'_k$. The "
                r"angle follows from $|\mathbf{L}'|\,|\boldsymbol{\Omega}'|\,\cos\alpha = "
                r"\mathbf{L}'\cdot\boldsymbol{\Omega}' = 2 E_R$."
            ),
        ),
        answers=(
            Asked(symbol=formula("E_R"), value=float(energy), unit="J"),
            Asked(
                symbol=formula(r"|\mathbf{L}|"),
                value=float(sp.sqrt(momentum.dot(momentum))),
                unit="kg m²/s",
            ),
            Asked(symbol=formula(r"\alpha"), value=float(sp.deg(sp.acos(cosine))), unit="°"),
        ),
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
    return f"{float(value):g} m"


def _lengths(*values: sp.Rational) -> str:
    *others, last = map(_length, values)
    return f"{', '.join(others)} and {last}"
