"""Derivation -> plain data for programs: what `--json` prints and `NAME.json` holds.

Expressions are strings in the plain names of the arguments ("sin(theta)*phi_dot"), which
`rigidsym.text.expression` reads back. A change that breaks readers raises SCHEMA_VERSION.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.formula.reader import text_of
from rigidsym.formula.scalars import Names, plain_data
from rigidsym.mechanics.derivation import (
    Argument,
    Derivation,
    Proof,
    Singularities,
    Singularity,
    Step,
)
from rigidsym.mechanics.dynamics.lagrange import is_bound
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.version import OWNERSHIP, __version__

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions
    from rigidsym.models.body import RigidBody
    from rigidsym.models.rotation import RotationModel, Turn

SCHEMA = "rigidsym.derivation"
SCHEMA_VERSION = 2


def record(
    derivation: Derivation, request: Mapping[str, Any], conversions: Conversions | None = None
) -> dict[str, Any]:
    """All of a derivation as dictionaries, lists, strings, numbers and booleans.

    `request` is the data that asked for it, from which `rigidsym check` derives it again;
    `conversions` stand in it where they were asked for.
    """
    names = {  # for functions of time, the highest derivatives first to be replaced first
        expression: sp.Symbol(name)
        for argument in reversed(derivation.arguments)
        for expression, name in zip(argument.symbols, argument.names, strict=True)
    }
    cited = [derivation.model.source, *[step.quantity.source for step in derivation.steps]]
    source, *sources = [place and str(place) for place in cited]
    found = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "generator": f"rigidsym {__version__}",
        "ownership": OWNERSHIP,
        "name": derivation.name,
        "title": derivation.title,
        "presentation": "passive" if derivation.model.passive else "active",
        "convention": derivation.model.convention,
        "source": source,
        "rotation": _rotation(derivation.model, names),
        "is_proved": derivation.is_proved and (not conversions or conversions.is_proved),
        "request": request,
        **({"theory": _theory(derivation)} if derivation.theory else {}),
        "arguments": _arguments(derivation.arguments),
        "quantities": list(map(_step, derivation.steps, sources)),
        "first_integrals": [
            {**_picked(integral, "name", "expression"), "proof": _proof(integral.proof)}
            for integral in derivation.first_integrals
        ],
        "definitions": [
            {"name": d.symbol.name, "expression": d.expression} for d in derivation.definitions
        ],
        "singularities": _singularities(derivation.singularities),
        **({"body": _body(derivation.body)} if derivation.body else {}),
        **_motion(derivation),
        **({"conversions": _conversions(conversions)} if conversions else {}),
    }
    return dict(plain_data(found, names))


def _rotation(model: RotationModel, names: Names) -> dict[str, Any]:
    """R as a certificate's checker builds it: turns from left to right, or nine entries."""
    matrix, conditions = model.matrix, list(model.constraints)
    if model.pullback:
        products = matrix * matrix.T - sp.eye(3)
        conditions = [products[i, j] for i in range(3) for j in range(i + 1)] + [matrix.det() - 1]
    axes = [turn.direction for turn in model.turns]
    texts = [text for pair in zip(model.turns, axes, strict=True) for text in _turn(*pair, names)]
    found = texts or ([model.definition] if model.definition else [])
    return {**({"turns": found} if found else {"matrix": matrix}), "conditions": conditions}


def _turn(turn: Turn, direction: Sequence[sp.Expr], names: Names) -> Iterator[str]:
    """One turn, or two about the same axis where a number is part of the angle."""
    constant, moving = sp.expand(turn.angle).as_coeff_add()
    constant += sum(term for term in moving if term.is_number)
    angle = (turn.angle - constant).xreplace(names)
    axis = ", ".join([str(part.xreplace(names)) for part in direction])
    if turn.angle != constant:
        yield f"axis_angle({axis}, {angle})" if turn.components else f"{turn.axis}({angle})"
    if constant:
        yield f"constant_turn({axis}, {sp.cos(constant)}, {sp.sin(constant)})"


def _body(body: RigidBody) -> dict[str, Any]:
    """The body itself; its principal axes in numbers, where all its parameters have values."""
    from rigidsym.mechanics.mass.bodies import in_numbers, parts_of

    found = in_numbers(body)
    parts = [  # about their centres of mass; `turn` takes the axes of a part to those of the whole
        {"mass": mass, "centre": _vector(centre), "inertia": inertia, "turn": turn}
        for mass, centre, inertia, turn in parts_of(body)
    ]
    return {
        "title": body.title,
        "mass": body.mass,
        "centre": _vector(body.centre),
        "inertia": body.inertia,
        **({"parts": parts} if parts else {}),
        "parameters": [
            {"name": p.symbol.name, "about": p.about, "unit": p.unit, "value": p.value}
            for p in body.parameters
        ],
        "in_numbers": None if found is None else found.record(),
    }


def _motion(derivation: Derivation) -> dict[str, Any]:
    """V, the forces and the torque in body components, if they depend on q and q̇ only."""
    acting, groups = derivation.forces, {argument.name for argument in derivation.arguments}
    if acting is None or "momenta" not in groups:
        return {}
    if acting.depend_on_time or derivation.definitions:
        return {}
    torque = acting.torque or (sp.S.Zero,) * 3
    if any(component.has(*OMEGA_BODY) for component in torque):
        return {}
    if is_bound(derivation.model) or "torque_body" in (s.quantity.name for s in derivation.steps):
        return {}  # Euler's equations, or those of coordinates that depend on one another
    coordinates = derivation.model.coordinates
    forces = [sp.sympify(acting.generalised.get(q, 0)) for q in coordinates]
    return {"motion": {"potential": acting.potential, "forces": forces, "torque": torque}}


def _conversions(found: Conversions) -> dict[str, Any]:
    """How the coordinates go over into the unit quaternion, and come back from it and from R."""
    back, forward = found.inverse, found.quaternion
    source = forward.quantity.source if forward else None
    return {
        "quaternion": _step(forward, source and str(source)) if forward else None,
        "quaternion_from_matrix": _proof(found.from_matrix),
        "coordinates": {
            "because": text_of(back.because),
            "branch": text_of(back.branch),
            "proofs": list(map(_proof, back.proofs)),
        }
        if back
        else None,
        "without": found.without or None,
    }


def _theory(derivation: Derivation) -> list[dict[str, Any]]:
    """The equations for every body and rotation, in order."""
    return [
        {
            **_picked(statement, "number", "name", "section", "sides", "summands"),
            "because": text_of(statement.because),
            "source": str(statement.source),
            "proofs": list(map(_proof, statement.proofs)),
        }
        for statement in derivation.theory
    ]


def _arguments(arguments: Sequence[Argument]) -> list[dict[str, Any]]:
    letters = plain_data([argument.notation for argument in arguments], {})
    return [
        {
            "name": argument.name,
            "about": argument.about,
            "components": [
                {"name": name, "unit": unit, **letter}
                for name, unit, letter in zip(argument.names, argument.units, own, strict=True)
            ],
        }
        for argument, own in zip(arguments, letters, strict=True)
    ]


def _step(step: Step, source: str | None) -> dict[str, Any]:
    quantity, entries = step.quantity, step.expression.flat()
    values = {
        "scalar": ((), *entries[:1]),
        "vector": ((len(entries),), entries),
        "matrix": (step.expression.shape, step.expression),
    }
    shape, expression = values[quantity.shape]
    form = step.vector_form
    return {
        "number": step.number,
        **_picked(quantity, "name", "about", "unit", "symbol", "inputs"),
        "shape": shape,
        "expression": expression,
        # coefficients as expressions in the length n of the vector v
        "vector_form": form
        and {
            "vector": form.components,
            "length": str(form.length),
            "terms": [term._asdict() for term in (*form.terms, form.last) if term],
        },
        "because": step.because,
        "source": source,
        "proofs": list(map(_proof, step.proofs)),
    }


def _proof(proof: Proof) -> dict[str, Any]:
    return _picked(proof, "claim", "status", "residual")


def _singularities(found: Singularities | None) -> dict[str, Any] | None:
    if found is None:
        return None
    own = _picked(found, "rank", "measure", "determinant", "minors", "is_solved")
    return {**own, "points": list(map(_point, found.points))}


def _point(point: Singularity) -> dict[str, Any]:
    return {
        "at": [
            {  # value + k modulo, for whole k; none of them below `least`, if there is one
                "coordinate": place.coordinate,
                "value": place.value,
                "modulo": place.period,
                "least": place.value if place.is_length else None,
            }
            for place in point.places
        ],
        "rank": point.rank,
        "lost_direction_space": _vector(point.lost_axis_space),
        "lost_direction_body": _vector(point.lost_axis_body),
        "undetermined_rates": point.null_rates.T,
        "reached_direction_space": _vector(point.reachable_axis),
    }


def _picked(thing: Any, *names: str) -> dict[str, Any]:
    """Attributes that the record has by the same names."""
    return {name: getattr(thing, name) for name in names}


def _vector(column: sp.ImmutableMatrix | None) -> list[sp.Expr] | None:
    return None if column is None else [*column]
