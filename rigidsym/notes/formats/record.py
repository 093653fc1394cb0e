"""Derivation -> plain data for programs: what `--json` prints and `NAME.json` holds.

Expressions are strings in the plain names of the arguments ("sin(theta)*phi_dot"), which
`rigidsym.text.expression` reads back. A change that breaks readers raises SCHEMA_VERSION.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy.printing.str import StrPrinter

from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import Formula
from rigidsym.models.rotation import OMEGA_BODY, Citation
from rigidsym.system.files import table_beside
from rigidsym.version import OWNERSHIP, __version__

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions
    from rigidsym.mechanics.derivation import Argument, Derivation
    from rigidsym.models.body import RigidBody
    from rigidsym.models.forces import Forces
    from rigidsym.models.rotation import RotationModel, Turn

SCHEMA = "rigidsym.derivation"
SCHEMA_VERSION = 2


# attributes of each class, "key=attribute" where their names differ
_KEYS: Mapping[str, Sequence[str]] = table_beside(__file__, "record.toml")


class Names(dict[sp.Basic, sp.Basic]):
    """The name of each function of time; the same object for the same arguments."""

    __hash__ = object.__hash__  # type: ignore[assignment]


def record(
    derivation: Derivation, request: Mapping[str, Any], conversions: Conversions | None = None
) -> dict[str, Any]:
    """All of a derivation as dictionaries, lists, strings, numbers and booleans.

    `request` is the data that asked for it, from which `rigidsym check` derives it again. The
    record contains the `conversions`, if requested.
    """
    names, model = _names_of(derivation.arguments), derivation.model
    data = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "generator": f"rigidsym {__version__}",
        "ownership": OWNERSHIP,
        "name": derivation.name,
        "title": derivation.title,
        "presentation": "passive" if model.passive else "active",
        "convention": model.convention,
        "source": model.source,
        "rotation": _rotation(model, names),
        "is_proved": derivation.is_proved and (not conversions or conversions.is_proved),
        "request": request,
        **({"theory": derivation.theory} if derivation.theory else {}),
        "arguments": list(map(_argument, derivation.arguments)),
        "quantities": derivation.steps,
        "first_integrals": derivation.first_integrals,
        "definitions": derivation.definitions,
        "singularities": derivation.singularities,
        **({"body": _body(derivation.body, derivation.forces)} if derivation.body else {}),
        **_motion(derivation),
        **({"conversions": conversions} if conversions else {}),
    }
    return dict(_plain(data, names))


@lru_cache(maxsize=8)
def _names_of(arguments: tuple[Argument, ...]) -> Names:
    pairs = (zip(a.symbols, a.names, strict=True) for a in reversed(arguments))
    return Names({expression: sp.Symbol(name) for each in pairs for expression, name in each})


def _plain(data: Any, names: Names) -> Any:
    """Formulas in both markups, expressions in plain names, matrices as lists of rows."""
    match data:
        case str() | int():  # most of it
            return data
        case _ if type(data).__name__ in _KEYS:
            return _plain(_attributes(data), names)
        case Formula():
            return data.markup
        case Citation():
            return str(data)
        case sp.MatrixBase():
            return _plain(data.tolist(), names)
        case sp.Basic():
            return _PRINTER.doprint(_renamed(data, names))
        case Mapping():
            return {key: _plain(value, names) for key, value in data.items()}
        case list() | tuple():
            return [_plain(value, names) for value in data]
    return data


def _attributes(thing: Any) -> dict[str, Any]:
    entries = (entry.partition("=") for entry in _KEYS[type(thing).__name__])
    record = {key: attrgetter(path or key)(thing) for key, _, path in entries}
    for key, value in record.items():
        if key in ("because", "branch") and not isinstance(value, str):
            record[key] = text_of(value)
        elif "_direction_" in key:
            record[key] = _vector(value)
        elif key == "without":
            record[key] = value or None
        elif key == "shape" and len(value) < 2:
            flat = thing.expression.flat()
            record["expression"] = flat if value else flat[0]
    return record


class _Printer(StrPrinter):
    """As `str`. A part comes up in several quantities, and again in other conventions."""

    _print = lru_cache(maxsize=1 << 13)(StrPrinter._print)


_PRINTER = _Printer({"order": None})


@lru_cache(maxsize=1 << 13)  # conventions have most parts in common
def _renamed(node: sp.Basic, names: Names) -> sp.Basic:
    """The expression in its names, and not evaluated again."""
    if node in names:
        return names[node]
    parts = [_renamed(part, names) for part in node.args]
    make = node._from_args if isinstance(node, sp.Add | sp.Mul) else lambda p: node.func(*p)
    return make(parts) if parts else node


def _vector(column: sp.ImmutableMatrix | None) -> list[sp.Expr] | None:
    return None if column is None else [*column]


def _rotation(model: RotationModel, names: Names) -> dict[str, Any]:
    """R as a certificate's checker builds it: turns from left to right, or nine entries."""
    matrix, conditions = model.matrix, list(model.constraints)
    if model.pullback:
        # Six conditions, since R Rᵀ is symmetric; det R = 1 excludes reflections.
        products = matrix * matrix.T - sp.eye(3)
        conditions = [products[i, j] for i in range(3) for j in range(i + 1)] + [matrix.det() - 1]
    turns = [text for turn in model.turns for text in _turn(turn, names)]
    turns = turns or ([model.definition] if model.definition else [])
    return {**({"turns": turns} if turns else {"matrix": matrix}), "conditions": conditions}


def _turn(turn: Turn, names: Names) -> Iterator[str]:
    """One turn, or two about the same axis where a number is part of the angle."""
    constant, moving = sp.expand(turn.angle).as_coeff_add()
    constant += sum(term for term in moving if term.is_number)
    angle = _renamed(turn.angle - constant, names)
    axis = ", ".join([str(_renamed(part, names)) for part in turn.direction])
    if turn.angle != constant:
        yield f"axis_angle({axis}, {angle})" if turn.components else f"{turn.axis}({angle})"
    if constant:
        yield f"constant_turn({axis}, {sp.cos(constant)}, {sp.sin(constant)})"


def _body(body: RigidBody, acting: Forces | None) -> dict[str, Any]:
    """The body itself; its principal axes in numbers, where all its parameters have values.

    If a point is stated about which it turns, the inertia tensor is about the centre of mass.
    """
    from rigidsym.mechanics.mass.bodies import in_numbers

    numbers = in_numbers(body)
    fixed = body.centre if acting and acting.fixed_point == () else body.fixed_point
    return {
        "title": body.title,
        "mass": body.mass,
        "centre": _vector(body.centre),
        "inertia": body.as_described.inertia,
        **({} if fixed is None else {"fixed_point": _vector(fixed)}),
        "parameters": body.parameters,
        "in_numbers": numbers and numbers.record(),
    }


def _motion(derivation: Derivation) -> dict[str, Any]:
    """V, the forces and the torque in body components, if they depend on q and q̇ only."""
    acting, model = derivation.forces, derivation.model
    if acting is None or acting.depend_on_time or derivation.definitions:
        return {}
    from rigidsym.mechanics.dynamics.lagrange import is_bound

    # Euler's equations, or those of coordinates that depend on one another
    is_euler = "torque_body" in (step.quantity.name for step in derivation.steps)
    has_momenta = "momenta" in (argument.name for argument in derivation.arguments)
    torque = sp.ImmutableMatrix([acting.torque or (0, 0, 0)])
    if is_euler or is_bound(model) or not has_momenta or torque.has(*OMEGA_BODY):
        return {}
    forces = [sp.sympify(acting.generalised.get(q, 0)) for q in model.coordinates]
    return {"motion": {"potential": acting.potential, "forces": forces, "torque": [*torque]}}


def _argument(argument: Argument) -> dict[str, Any]:
    components = zip(argument.names, argument.units, argument.notation, strict=True)
    return {
        "name": argument.name,
        "about": argument.about,
        "components": [{"name": n, "unit": u, **letter.markup} for n, u, letter in components],
    }
