"""The [body] table of a derivation file, read into a rigid body."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import sympy as sp

from rigidsym.errors import RigidsymError
from rigidsym.models.body import RigidBody, general_inertia, given_inertia, principal_moments
from rigidsym.spec.body_reader import BodyReader, Declared
from rigidsym.spec.distribution_table import KINDS as DISTRIBUTIONS
from rigidsym.spec.distribution_table import keys_of, read_distribution
from rigidsym.spec.measured_table import numbers_of, read_known
from rigidsym.spec.tables import Table

_MOMENTS = ("A", "B", "C")
_LONGEST = 10**6  # a larger denominator is a measured number's
_KEYS_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"principal_moments": ("mass",), "inertia": ("mass", "centre")}
)
Reading = Callable[[BodyReader, str], RigidBody | None]


def read_body(body: Table, parameters: Table | None, name: str, folder: Path) -> RigidBody | None:
    """The body of a file, called `name`; None where a fault is noted.

    Paths in it start from `folder`.
    """
    declared = Declared()
    declared.take_names(body.data)
    if parameters is not None:
        declared.read(parameters)
    kinds = [kind for kind in _KINDS if body.value(kind) is not None]
    if len(kinds) != 1:
        known = ", ".join(_KINDS)
        got = f"got {' and '.join(kinds)}" if kinds else "got none"
        body.fault(f"expected one of {known}; {got}")
        return None
    (kind,) = kinds
    own = (kind, *_KEYS_OF[kind]) if kind in _KEYS_OF else keys_of(body.data, kind)
    body.refuse_others((*own, "allow"))
    try:
        found = _KINDS[kind](BodyReader(body, declared, folder), name)
    except RigidsymError as error:
        body.fault(str(error), kind)
        return None
    if found is None:
        return None
    asked: dict[str, object] = {"body": declared.without_files(body.data, body.path)}
    return replace(found, request=asked | ({"parameters": parameters.data} if parameters else {}))


def _read_moments(reader: BodyReader, name: str) -> RigidBody | None:
    """principal_moments = ["A", "A", "C"]; equal numbers share a name."""
    value = reader.table.value("principal_moments")
    slots: tuple[str, ...] = _MOMENTS
    if isinstance(value, list) and len(value) == 3:
        slots = tuple(_MOMENTS[value.index(entry)] for entry in value)
    moments = reader.row("principal_moments", slots, "three moments of inertia")
    mass = _mass(reader)
    if moments is None or mass is None:
        return None
    return principal_moments(
        *moments,
        mass=mass,
        name=name,
        parameters=reader.declared.given(),
        allow=bool(reader.table.flag("allow")),
    )


def _read_inertia(reader: BodyReader, name: str) -> RigidBody | None:
    """inertia = [[...], [...], [...]], or "general" for six symbols."""
    table = reader.table
    if table.value("inertia") == "general":
        mass = _mass(reader)
        return None if mass is None else general_inertia(mass=mass, name=name)
    known = read_known(reader)
    if known is None:
        return None
    return given_inertia(
        known.inertia,
        mass=known.mass,
        centre=known.centre,
        name=name,
        parameters=reader.declared.given(),
        allow=bool(table.flag("allow")),
    )


def _is_measured(body: RigidBody) -> bool:
    """Whether a body is given in numbers that nobody wants to see in formulas."""
    entries = (body.mass, *body.inertia, *body.centre)
    long = any(number.q > _LONGEST for entry in entries for number in entry.atoms(sp.Rational))
    return len(body.values) == len(body.parameters) and (bool(body.parameters) or long)


def _mass(reader: BodyReader) -> sp.Expr | None:
    """The mass, or the symbol M where the file does not say."""
    if reader.table.value("mass") is None:
        return sp.Symbol("M")
    return reader.single("mass", "M", positive=True)


def _read_distributed(kind: str) -> Reading:
    """Shapes, particles, a mesh, parts: the mass is where they say."""

    def read(reader: BodyReader, name: str) -> RigidBody | None:
        found = read_distribution(reader, kind)
        if found is None:
            return None
        from rigidsym.mechanics.mass.bodies import body_of

        allow = bool(reader.table.flag("allow"))
        body = body_of(found, name=name, parameters=reader.declared.given(), allow=allow)
        if kind == "shape" or not _is_measured(body):
            return body
        measured = _read_inertia(reader.fresh(numbers_of(body)), name)
        return measured and replace(measured, title=body.title)

    return read


_KINDS: Mapping[str, Reading] = MappingProxyType(
    {
        "principal_moments": _read_moments,
        "inertia": _read_inertia,
        **{kind: _read_distributed(kind) for kind in DISTRIBUTIONS if kind != "inertia"},
    }
)
