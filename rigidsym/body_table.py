"""The [body] table of a derivation file, read into a rigid body."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import sympy as sp

from rigidsym.body_reader import BodyReader, Declared
from rigidsym.errors import RigidsymError
from rigidsym.models.body import RigidBody, general_inertia, given_inertia, principal_moments
from rigidsym.tables import Table

_MOMENTS = ("A", "B", "C")
_ENTRIES = tuple(f"I_{min(i, j)}{max(i, j)}" for i in (1, 2, 3) for j in (1, 2, 3))
_CENTRE = ("x_C", "y_C", "z_C")
_COMMON = ("mass", "allow")
_KEYS_OF: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"principal_moments": (), "inertia": ("centre",)}
)


def read_body(body: Table, parameters: Table | None, name: str) -> RigidBody | None:
    """The body of a file, called `name`; None where a fault is noted."""
    declared = Declared()
    if parameters is not None:
        declared.read(parameters)
    kinds = [kind for kind in _KINDS if body.value(kind) is not None]
    if len(kinds) != 1:
        known = ", ".join(_KINDS)
        found = f"got {' and '.join(kinds)}" if kinds else "got none"
        body.fault(f"expected one of {known}; {found}")
        return None
    (kind,) = kinds
    body.refuse_others((kind, *_KEYS_OF[kind], *_COMMON))
    try:
        return _KINDS[kind](BodyReader(body, declared), name)
    except RigidsymError as error:
        body.fault(str(error), kind)
        return None


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
    about = dict.fromkeys(_MOMENTS, ("principal moment of inertia", "kg m^2"))
    return principal_moments(
        *moments,
        mass=mass,
        name=name,
        parameters=reader.declared.given(about | _ABOUT),
        allow=bool(reader.table.flag("allow")),
    )


def _read_inertia(reader: BodyReader, name: str) -> RigidBody | None:
    """inertia = [[...], [...], [...]], or "general" for six symbols."""
    table = reader.table
    mass = _mass(reader)
    if table.value("inertia") == "general":
        return None if mass is None else general_inertia(mass=mass, name=name)
    rows = table.value("inertia")
    shapes = [len(row) if isinstance(row, list) else 0 for row in _as_list(rows)]
    if shapes != [3, 3, 3]:
        table.mistyped(rows, 'three rows of three expressions, or "general"', "inertia")
        return None
    read = [
        reader.entries(row, _ENTRIES[3 * k : 3 * k + 3], "inertia", k)
        for k, row in enumerate(_as_list(rows))
    ]
    entries = [entry for row in read if row is not None for entry in row]
    centre = [sp.S.Zero] * 3
    if table.value("centre") is not None:
        centre = reader.row("centre", _CENTRE, "three coordinates") or []
    if len(entries) != 9 or len(centre) != 3 or mass is None:
        return None
    return given_inertia(
        sp.Matrix(3, 3, entries),
        mass=mass,
        centre=sp.Matrix(centre),
        name=name,
        parameters=reader.declared.given(_ABOUT),
        allow=bool(table.flag("allow")),
    )


def _mass(reader: BodyReader) -> sp.Expr | None:
    """The mass, or the symbol M where the file does not say."""
    if reader.table.value("mass") is None:
        return sp.Symbol("M")
    return reader.single("mass", "M", positive=True)


def _as_list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []


_ABOUT = {
    "M": ("mass", "kg"),
    **{
        name: (
            "moment of inertia" if k in (0, 4, 8) else "product of inertia, with its sign",
            "kg m^2",
        )
        for k, name in enumerate(_ENTRIES)
    },
    **dict.fromkeys(_CENTRE, ("coordinate of the centre of mass", "m")),
}
_KINDS: Mapping[str, Callable[[BodyReader, str], RigidBody | None]] = MappingProxyType(
    {"principal_moments": _read_moments, "inertia": _read_inertia}
)
