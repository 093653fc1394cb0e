"""Derivation -> plain data for programs: what `--json` prints and `NAME.json` holds.

Expressions are strings in the plain names of the arguments ("sin(theta)*phi_dot"), which
`rigidsym.text.expression` reads back. A change that breaks readers raises SCHEMA_VERSION.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.formula.sentence import text_of
from rigidsym.mechanics.derivation import (
    Argument,
    Derivation,
    Place,
    Proof,
    Singularities,
    Singularity,
    Step,
    VectorForm,
)
from rigidsym.version import OWNERSHIP, __version__

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions
    from rigidsym.models.body import RigidBody
    from rigidsym.models.rotation import RotationModel, Turn

SCHEMA = "rigidsym.derivation"
SCHEMA_VERSION = 2

Names = Mapping[sp.Expr, sp.Symbol]


def record(
    derivation: Derivation, request: Mapping[str, Any], conversions: Conversions | None = None
) -> dict[str, Any]:
    """All of a derivation as dictionaries, lists, strings, numbers and booleans.

    `request` is the data that asked for it, from which `rigidsym check` derives it again;
    `conversions` stand in it where they were asked for.
    """
    names = _plain_names(derivation.arguments)
    return {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "generator": f"rigidsym {__version__}",
        "ownership": OWNERSHIP,
        "name": derivation.name,
        "title": derivation.title,
        "presentation": "passive" if derivation.model.passive else "active",
        "convention": list(derivation.model.convention),
        "source": str(derivation.model.source),
        "rotation": _rotation(derivation.model, names),
        "is_proved": derivation.is_proved and (not conversions or conversions.is_proved),
        "request": dict(request),
        **({"theory": _theory(derivation)} if derivation.theory else {}),
        "arguments": [_argument(argument) for argument in derivation.arguments],
        "quantities": [_step(step, names) for step in derivation.steps],
        "first_integrals": [
            {
                "name": integral.name,
                "expression": _plain(integral.expression, names),
                "proof": _proof(integral.proof, names),
            }
            for integral in derivation.first_integrals
        ],
        "definitions": [
            {"name": d.symbol.name, "expression": _plain(d.expression, names)}
            for d in derivation.definitions
        ],
        "singularities": _singularities(derivation.singularities, names),
        **({"body": _body(derivation.body, names)} if derivation.body else {}),
        **_motion(derivation, names),
        **({"conversions": _conversions(conversions, names)} if conversions else {}),
    }


def _rotation(model: RotationModel, names: Names) -> dict[str, Any]:
    """R as a certificate's checker builds it: turns from left to right, or nine entries."""
    matrix, conditions = model.matrix, list(model.constraints)
    if model.pullback:
        products = matrix * matrix.T - sp.eye(3)
        conditions = [products[i, j] for i in range(3) for j in range(i + 1)] + [matrix.det() - 1]
    texts = [text for turn in model.turns for text in _turn(turn, names)]
    found = texts or ([model.definition] if model.definition else [])
    return {
        **({"turns": found} if found else {"matrix": _entries(matrix, names, is_vector=False)}),
        "conditions": [_plain(condition, names) for condition in conditions],
    }


def _turn(turn: Turn, names: Names) -> Iterator[str]:
    """One turn, or two about the same axis where a number is part of the angle."""
    constant, moving = sp.expand(turn.angle).as_coeff_add()
    constant += sum(term for term in moving if term.is_number)
    angle = _plain(turn.angle - constant, names)
    axis = ", ".join(_plain(part, names) for part in turn.direction)
    if turn.angle != constant:
        yield f"axis_angle({axis}, {angle})" if turn.components else f"{turn.axis}({angle})"
    if constant:
        yield f"constant_turn({axis}, {sp.cos(constant)}, {sp.sin(constant)})"


def _body(body: RigidBody, names: Names) -> dict[str, Any]:
    """The body itself; its principal axes in numbers, where all its parameters have values."""
    from rigidsym.mechanics.mass.numbers import in_numbers, parts_of

    found, parts = in_numbers(body), parts_of(body)
    return {
        "title": body.title,
        "mass": _plain(body.mass, names),
        "centre": _vector(body.centre, names),
        "inertia": _entries(body.inertia, names, is_vector=False),
        **({"parts": [_part(part, names) for part in parts]} if parts else {}),
        "parameters": [
            {"name": p.symbol.name, "about": p.about, "unit": p.unit, "value": p.value}
            for p in body.parameters
        ],
        "in_numbers": None if found is None else found.record(),
    }


def _part(part: Sequence[Any], names: Names) -> dict[str, Any]:
    """A part about its centre of mass; `turn` takes its axes to those of the whole."""
    mass, centre, inertia, turn = part
    return {
        "mass": _plain(mass, names),
        "centre": _vector(centre, names),
        "inertia": _entries(inertia, names, is_vector=False),
        "turn": _entries(turn, names, is_vector=False),
    }


def _motion(derivation: Derivation, names: Names) -> dict[str, Any]:
    """V and the generalised forces, if nothing else enters Lagrange's equations of the body."""
    acting, groups = derivation.forces, {argument.name for argument in derivation.arguments}
    if acting is None or "momenta" not in groups:
        return {}
    if acting.depend_on_time or any(acting.torque) or acting.parts or acting.frame_rate:
        return {}
    coordinates = derivation.model.coordinates
    forces = [_plain(sp.sympify(acting.generalised.get(q, 0)), names) for q in coordinates]
    return {"motion": {"potential": _plain(acting.potential, names), "forces": forces}}


def _conversions(found: Conversions, names: Names) -> dict[str, Any]:
    """How the coordinates go over into the unit quaternion, and come back from it and from R."""
    back, forward = found.inverse, found.quaternion
    return {
        "quaternion": _step(forward, names) if forward else None,
        "quaternion_from_matrix": _proof(found.from_matrix, names),
        "coordinates": {
            "because": text_of(back.because),
            "branch": text_of(back.branch),
            "proofs": [_proof(proof, names) for proof in back.proofs],
        }
        if back
        else None,
        "without": found.without or None,
    }


def _theory(derivation: Derivation) -> list[dict[str, Any]]:
    """The equations for every body and rotation, in order."""
    return [
        {
            "number": statement.number,
            "name": statement.name,
            "section": statement.section,
            "because": text_of(statement.because),
            "sides": [side.markup for side in statement.sides],
            "summands": None
            if statement.summands is None
            else _entries(statement.summands, {}, is_vector=False),
            "source": str(statement.source),
            "proofs": [_proof(proof, {}) for proof in statement.proofs],
        }
        for statement in derivation.theory
    ]


def _plain_names(arguments: tuple[Argument, ...]) -> Names:
    """Symbols in place of functions of time, highest derivatives first to be replaced first."""
    return {
        expression: sp.Symbol(name)
        for argument in reversed(arguments)
        for expression, name in zip(argument.symbols, argument.names, strict=True)
    }


def _argument(argument: Argument) -> dict[str, Any]:
    components = zip(argument.names, argument.units, argument.notation, strict=True)
    return {
        "name": argument.name,
        "about": argument.about,
        "components": [
            {"name": name, "unit": unit, **letters.markup} for name, unit, letters in components
        ],
    }


def _step(step: Step, names: Names) -> dict[str, Any]:
    quantity = step.quantity
    return {
        "number": step.number,
        "name": quantity.name,
        "about": quantity.about,
        "unit": quantity.unit,
        "symbol": quantity.symbol.markup,
        "inputs": list(quantity.inputs),
        "shape": list(step.shape),
        "expression": _expression(step, names),
        "vector_form": _vector_form(step.vector_form, names),
        "because": step.because,
        "source": str(quantity.source) if quantity.source else None,
        "proofs": [_proof(proof, names) for proof in step.proofs],
    }


def _vector_form(form: VectorForm | None, names: Names) -> dict[str, Any] | None:
    """Coefficients as expressions in the length n of the vector v; None where there is no form."""
    if form is None:
        return None
    return {
        "vector": [_plain(part, names) for part in form.components],
        "length": str(form.length),
        "terms": [
            {"coefficient": _plain(term.coefficient, names), "vector": term.vector.markup}
            for term in (*form.terms, *([form.last] if form.last else []))
        ],
    }


def _proof(proof: Proof, names: Names) -> dict[str, Any]:
    left = proof.residual
    return {
        "claim": proof.claim.markup,
        "status": proof.status,
        "residual": None if left is None else _entries(left, names, is_vector=False),
    }


def _singularities(found: Singularities | None, names: Names) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "rank": found.rank,
        "measure": found.measure,
        "determinant": None if found.determinant is None else _plain(found.determinant, names),
        "minors": [_plain(minor, names) for minor in found.minors],
        "is_solved": found.is_solved,
        "points": [_point(point, names) for point in found.points],
    }


def _point(point: Singularity, names: Names) -> dict[str, Any]:
    return {
        "at": [_place(place, names) for place in point.places],
        "rank": point.rank,
        "lost_direction_space": _vector(point.lost_axis_space, names),
        "lost_direction_body": _vector(point.lost_axis_body, names),
        "undetermined_rates": [_vector(idle, names) for idle in _columns(point.null_rates)],
        "reached_direction_space": _vector(point.reachable_axis, names),
    }


def _place(place: Place, names: Names) -> dict[str, Any]:
    """The values are value + k modulo, for whole k; none of them below `least`, if there is one."""
    value = _plain(place.value, names)
    return {
        "coordinate": _plain(place.coordinate, names),
        "value": value,
        "modulo": _plain(place.period, names),
        "least": value if place.is_length else None,
    }


def _columns(matrix: sp.ImmutableMatrix) -> list[sp.ImmutableMatrix]:
    return [matrix[:, place] for place in range(matrix.shape[1])]


def _vector(column: sp.ImmutableMatrix | None, names: Names) -> list[str] | None:
    return None if column is None else [_plain(entry, names) for entry in column]


def _expression(step: Step, names: Names) -> Any:
    """A string, a list of them, or a list of rows, as the shape is."""
    shape = step.quantity.shape
    if shape == "scalar":
        return _plain(step.expression[0], names)
    return _entries(step.expression, names, is_vector=shape == "vector")


def _entries(matrix: sp.ImmutableMatrix, names: Names, *, is_vector: bool) -> list[Any]:
    rows = [[_plain(entry, names) for entry in row] for row in matrix.tolist()]
    return [row[0] for row in rows] if is_vector else rows


def _plain(expression: sp.Expr, names: Names) -> str:
    return _text(expression.xreplace(names))


@lru_cache(maxsize=4096)  # an entry comes up in several quantities, and again in other conventions
def _text(expression: sp.Expr) -> str:
    return str(expression)
