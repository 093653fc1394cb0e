"""The [body] table of a derivation file, read into a rigid body."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import sympy as sp

from rigidsym.errors import RigidsymError
from rigidsym.models.body import (
    BodyDescription,
    RigidBody,
    general_inertia,
    given_inertia,
    principal_moments,
)
from rigidsym.models.distribution import Distribution
from rigidsym.spec.body_reader import BodyReader, Declared
from rigidsym.spec.derivation_spec import Body
from rigidsym.spec.distribution_table import KINDS as DISTRIBUTIONS, keys_of, read_distribution
from rigidsym.spec.measured_table import read_known
from rigidsym.spec.tables import Table

_MOMENTS = ("A", "B", "C")
_KINDS = ("principal_moments", "inertia", *(kind for kind in DISTRIBUTIONS if kind != "inertia"))


def read_body(body: Table, parameters: Table | None, name: str, folder: Path | None) -> Body | None:
    """The body of a file, called `name`; None if a fault is noted.

    Paths in it start from `folder`; a record names no files. Distributions are not integrated.
    """
    declared = Declared()
    declared.take_names(body.data)
    if parameters is not None:
        declared.read(parameters)
    kinds = [kind for kind in _KINDS if body.value(kind) is not None]
    if len(kinds) != 1:
        got = f"got {' and '.join(kinds)}" if kinds else "got none"
        body.fault(f"expected one of {', '.join(_KINDS)}; {got}")
        return None
    (kind,) = kinds
    own = ("principal_moments", "mass") if kind == _KINDS[0] else keys_of(body.data, kind)
    body.refuse_others((*own, "allow"))
    try:
        given = _read(BodyReader(body, declared, folder), kind, name)
    except RigidsymError as error:
        body.fault(str(error), kind)
        return None
    if given is None:
        return None
    data: dict[str, object] = {"body": declared.without_files(body.data, body.path)}
    request = data | ({"parameters": parameters.data} if parameters else {})
    if isinstance(given, RigidBody):
        return replace(given, request=request)
    return BodyDescription(
        distribution=given,
        name=name,
        parameters=declared.given(),
        allow=bool(body.flag("allow")),
        keeps_numbers=kind == "shape",
        request=request,
    )


def _read(reader: BodyReader, kind: str, name: str) -> RigidBody | Distribution | None:
    if kind == "principal_moments":
        return _read_moments(reader, name)
    return _read_inertia(reader, name) if kind == "inertia" else read_distribution(reader, kind)


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


def _mass(reader: BodyReader) -> sp.Expr | None:
    """The mass, or the symbol M if the file gives none."""
    if reader.table.value("mass") is None:
        return sp.Symbol("M")
    return reader.single("mass", "M", positive=True)
