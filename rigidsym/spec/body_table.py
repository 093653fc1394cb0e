"""The [body] table of a derivation file: moments, shapes, particles, parts, numbers in files.

Texts and integers are exact. A number with a decimal point is measured: it becomes a parameter with
this value, named after its key, so that the derivation stays exact and its formulas short.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, count
from pathlib import Path
from typing import Any

import sympy as sp

from rigidsym.errors import BodyError
from rigidsym.models import body as distribution
from rigidsym.models.body import (
    BodyDescription,
    Parameter,
    RigidBody,
    general_inertia,
    given_inertia,
    principal_moments,
)
from rigidsym.models.library import read_part, turned_by
from rigidsym.models.solids import SHAPES, check_lengths, shaped
from rigidsym.spec.faults import Place
from rigidsym.spec.schema import kind_of
from rigidsym.text.names import check_name

Data = Mapping[str, Any]  # checked by the schema
Body = RigidBody | BodyDescription
Slots = str | Sequence[Any]  # names that numbers get, nested as the expressions are

_AXES = ("x", "y", "z")
_MOMENTS = ("A", "B", "C")
_TENSOR = (("I_11", "I_12", "I_13"), ("I_12", "I_22", "I_23"), ("I_13", "I_23", "I_33"))
_AMOUNTS = {"mass": ("M", "kg"), "density": ("rho", "")}  # symbol and unit
_OF_ANY_KIND = ("at", "turned", "hole", "label", "allow")
_WORD = re.compile(r"[^\W\d]\w*")


def read_body(
    data: Data, parameters: Mapping[str, Data], place: Place, name: str, folder: Path | None
) -> Body | None:
    """The body of a file, called `name`; None if a fault is noted.

    Paths in it start from `folder`; a record names no files. Distributions are not integrated.
    """
    declared = {}
    for key, entry in parameters.items():
        with place.at("parameters", key).noting():
            symbol = check_name(key)
            declared[symbol] = Parameter(symbol=sp.Symbol(symbol), **entry)
    own, kind, allow = place.at("body"), kind_of(data), bool(data.get("allow"))
    body: Body | None = None
    with own.noting(kind):
        data = _in_numbers(data, own, folder, allow=allow)
        kind = kind_of(data)
        table = _Table(data, _Symbols({*_WORD.findall(str(data)), *declared}, declared))
        request = {"body": data} | ({"parameters": parameters} if parameters else {})
        options: dict[str, Any] = {"name": name, "allow": allow}
        if kind in ("principal_moments", "inertia"):
            body = replace(_rigid_body(table, kind, options), request=request)
        else:
            body = BodyDescription(
                distribution=_distribution(table, own),
                parameters=table.symbols.described(),
                keeps_numbers=kind == "shape",
                request=request,
                **options,
            )
    return body


def _in_numbers(data: Data, place: Place, folder: Path | None, *, allow: bool) -> Data:
    """The table with mass, centre and inertia tensor in place of the file it names.

    The record contains these numbers, so that it can be checked without the file.
    """
    if "parts" in data:
        parts = []
        for k, part in enumerate(data["parts"]):
            with place.at("parts", k).noting(kind_of(part)):
                parts.append(_in_numbers(part, place, folder, allow=allow))
        return {**data, "parts": parts}
    file = data.get("mesh") or data.get("particles")
    if not isinstance(file, str):
        return data
    if folder is None:
        raise BodyError("expected numbers: a record names no files")
    from rigidsym.data import mass  # needs NumPy, which rotations do not

    if "mesh" in data:
        mesh = mass.read_mesh_file(folder / file, scale=data.get("scale", 1.0))
        amount = {key: data.get(key) for key in _AMOUNTS}
        properties = mass.mesh_inertia(mesh, **amount, allow=allow)
    else:
        columns = data.get("columns")
        properties = mass.inertia_of(folder / file, columns=columns, allow=allow)
    others = {key: data[key] for key in _OF_ANY_KIND if key in data}
    return others | properties.as_table()


@dataclass
class _Symbols:
    """The parameters of one file: declared in [parameters], or made from numbers."""

    taken: set[str]  # names that no number may have
    parameters: dict[str, Parameter]
    meanings: dict[str, tuple[str, str]] = field(default_factory=dict)  # meaning and unit

    def measured(self, slot: str, value: float) -> sp.Symbol:
        """The parameter for a number.

        It has the name of its slot, or a similar one if that has another meaning or value.
        """
        for name in chain([slot], (f"{slot}_{k}" for k in count(2))):
            same = self.parameters.get(name)
            if name not in self.taken and (same is None or same.value == value):
                break
        symbol = sp.Symbol(name)
        self.parameters[name] = Parameter(symbol=symbol, positive=value > 0, value=float(value))
        return symbol

    def explain(self, expressions: Sequence[sp.Expr], about: str, unit: str) -> None:
        """Note the meaning of expressions that are single symbols, unless it is known."""
        for expression in expressions:
            if expression.is_Symbol:
                self.meanings.setdefault(expression.name, (about, unit))

    def value_of(self, expression: sp.Expr) -> float | None:
        """The value of an expression; None unless all its symbols have values."""
        values = {p.symbol: p.value for p in self.parameters.values() if p.value is not None}
        value = expression.xreplace({s: sp.Float(v, 17) for s, v in values.items()})
        return float(value) if value.is_comparable else None

    def described(self) -> tuple[Parameter, ...]:
        """All parameters with a declaration, a value or a meaning."""
        explained = {
            name: Parameter(symbol=sp.Symbol(name), positive=unit != "m" or "coord" not in about)
            for name, (about, unit) in self.meanings.items()
        }
        return tuple(
            replace(p, about=p.about or about, unit=p.unit or unit)
            for name, p in (explained | self.parameters).items()
            for about, unit in [self.meanings.get(name, ("", ""))]
        )


@dataclass
class _Table:
    """Reads the expressions of one table."""

    data: Data
    symbols: _Symbols
    suffix: str = ""  # of the names of numbers: "_2" in the second part
    is_exact: bool = False  # whether numbers with a point stay numbers

    def read(self, key: str, slots: Slots) -> Any:
        """The exact expressions of a key, nested as the names of their slots are."""
        return self.nested(self.data[key], slots)

    def nested(self, value: Any, slots: Slots) -> Any:
        if not isinstance(slots, str):
            return [self.nested(v, slot) for v, slot in zip(value, slots, strict=True)]
        if isinstance(value, str):
            return read_part(value, ())
        if isinstance(value, float) and value != 0 and not self.is_exact:
            return self.symbols.measured(slots + self.suffix, value)
        return sp.Rational(str(value))

    def amount(self, key: str) -> sp.Expr:
        """The mass or the density; a symbol if the table has none."""
        slot, unit = _AMOUNTS[key]
        amount = self.read(key, slot) if key in self.data else sp.Symbol(slot + self.suffix)
        self.symbols.explain([amount], key, unit)
        return amount


def _rigid_body(table: _Table, kind: str, options: dict[str, Any]) -> RigidBody:
    """The body of principal_moments = ["A", "A", "C"] or of inertia, in these axes."""
    value = table.data[kind]
    if value == "general":
        return general_inertia(mass=table.amount("mass"), name=options["name"])
    if kind == "inertia":
        body = _known(table)
        options |= {"mass": body.mass, "centre": body.centre}
        return given_inertia(body.inertia, **options, parameters=table.symbols.described())
    slots = [_MOMENTS[value.index(entry)] for entry in value]  # equal numbers share a name
    moments, mass = table.read(kind, slots), table.amount("mass")
    parameters = table.symbols.described()
    return principal_moments(*moments, mass=mass, parameters=parameters, **options)


def _distribution(table: _Table, place: Place) -> distribution.Distribution:
    match kind_of(table.data):
        case "particles":
            return _particles(table)
        case "parts":
            return _parts(table, place)
        case "inertia":
            return _known(table)
    return _shape(table, table.data["shape"])


def _shape(table: _Table, name: str) -> distribution.Distribution:
    """A shipped solid; lengths that the table lacks are their default symbols."""
    lengths: list[sp.Expr] = []
    for length in SHAPES[name].lengths:
        values = [name + table.suffix for name in length.names]
        if length.key in table.data:
            values = sp.flatten([table.data[length.key]])
        if len(values) != len(length.names):
            expected = f"expected {len(length.names)} expressions, got {len(values)}"
            raise BodyError(f"{length.key}: {expected}")
        read = table.nested(values, length.names)
        table.symbols.explain(read, length.about, "m")
        lengths += read
    check_lengths(name, [table.symbols.value_of(length) for length in lengths])
    amounts = {key: table.amount(key) for key in _AMOUNTS if key in table.data}
    return shaped(name, lengths, **(amounts or {"mass": table.amount("mass")}))


def _particles(table: _Table) -> distribution.Distribution:
    """particles = [{ mass = "m", at = ["a", 0, 0] }, ...]; numbers stay exact."""
    particles = []
    for entry in table.data["particles"]:
        own = replace(table, data=entry, is_exact=True)
        position = sp.ImmutableMatrix(own.read("at", _AXES))
        particles.append(distribution.Particle(mass=own.read("mass", "m"), position=position))
    return distribution.Particles(particles=tuple(particles))


def _parts(table: _Table, place: Place) -> distribution.Distribution:
    """parts = [{ shape = ..., at = [...], turned = "z(pi/4)", hole = true }, ...]."""
    parts: list[distribution.Part] = []
    for k, entry in enumerate(table.data["parts"]):
        own = replace(table, data=entry, suffix=f"{table.suffix}_{k + 1}")
        with place.at("parts", k).noting(kind_of(entry)):
            at = own.read("at", _AXES) if "at" in entry else distribution.HERE
            part = distribution.Part(
                what=_distribution(own, place),
                at=sp.ImmutableMatrix(at),
                turned=turned_by(entry["turned"]) if "turned" in entry else distribution.UPRIGHT,
                hole=bool(entry.get("hole")),
                label=entry.get("label", ""),
            )
            parts.append(part)
    return distribution.Composite(parts=tuple(parts))


def _known(table: _Table) -> distribution.Known:
    """inertia = [[...], [...], [...]] about the centre of mass, with mass and centre."""
    inertia = table.read("inertia", _TENSOR)
    has_centre = "centre" in table.data
    centre = table.read("centre", ("x_C", "y_C", "z_C")) if has_centre else [*distribution.HERE]
    for expressions, about, unit in (
        ([inertia[k][k] for k in range(3)], "moment of inertia", "kg m^2"),
        ([*chain.from_iterable(inertia)], distribution.PRODUCT, "kg m^2"),
        (centre, distribution.COORDINATE, "m"),
    ):
        table.symbols.explain(expressions, about, unit)
    return distribution.Known(
        mass=table.amount("mass"),
        centre=sp.ImmutableMatrix(centre),
        inertia=sp.ImmutableMatrix(inertia),
    )
