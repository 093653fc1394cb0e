"""The [body] table of a derivation file: moments, shapes, particles, parts, numbers in files.

Texts and integers are exact. A number with a decimal point is measured: it becomes a parameter with
this value, named after its key, so that the derivation stays exact and its formulas short.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, count
from pathlib import Path
from typing import Any

import sympy as sp

from rigidsym.errors import BodyError, MissingExtra, RigidsymError
from rigidsym.models import body as distribution
from rigidsym.models.body import (
    BodyDescription,
    Parameter,
    RigidBody,
    general_inertia,
    given_inertia,
    principal_moments,
)
from rigidsym.models.library import turned_by
from rigidsym.models.solids import SHAPES, check_lengths, shaped
from rigidsym.spec.faults import Place
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name

Data = Mapping[str, Any]
Body = RigidBody | BodyDescription
Slots = str | Sequence[Any]  # names that numbers get, nested as the expressions are

_OF_PARTS = ("shape", "particles", "mesh", "inertia")
_KINDS = ("principal_moments", "inertia", "shape", "particles", "mesh", "parts")
_OF_MASS = ("mass", "density")
_OTHER_KEYS = {  # that go with a kind, or with a shape
    "principal_moments": ("mass",),
    "inertia": ("mass", "centre", "outline"),
    "mesh": (*_OF_MASS, "scale"),
    "particles": ("columns",),
    "given": ("coordinates", "place", "bounds", "element", *_OF_MASS),
} | {
    shape: (*_OF_MASS, *(length.key for length in entry.lengths)) for shape, entry in SHAPES.items()
}
_AXES = ("x", "y", "z")
_MOMENTS = ("A", "B", "C")
_TENSOR = (("I_11", "I_12", "I_13"), ("I_12", "I_22", "I_23"), ("I_13", "I_23", "I_33"))
_UNREAD = sp.Symbol("unread")  # in place of an expression whose fault is noted
_WORD = re.compile(r"[^\W\d]\w*")


def read_body(
    data: Data, parameters: Mapping[str, Data], place: Place, name: str, folder: Path | None
) -> Body | None:
    """The body of a file, called `name`; None if a fault is noted.

    Paths in it start from `folder`; a record names no files. Distributions are not integrated.
    """
    allow = bool(data.get("allow"))
    own = place.at("body")
    data = _prepared(data, own, _KINDS, ("allow",), folder, allow=allow)
    kind = next((kind for kind in _KINDS if kind in data), None)
    if kind is None:
        return None
    declared = {}
    for key, entry in parameters.items():
        about = {name: value for name, value in (entry or {}).items() if value is not None}
        with place.at("parameters").at(key).noting():
            symbol = check_name(key)
            declared[symbol] = Parameter(symbol=sp.Symbol(symbol), **about)
    known = _Parameters({*_words(data), *declared}, declared)
    table = _Table(data, own, known)
    options: dict[str, Any] = {"name": name, "allow": allow}
    request = {"body": data} | ({"parameters": parameters} if parameters else {})
    with own.noting(kind):
        if kind == "principal_moments" or (kind == "inertia" and "outline" not in data):
            return replace(_rigid_body(table, kind, options), request=request)
        return BodyDescription(
            distribution=_parts(table) if kind == "parts" else _distribution(table, kind),
            parameters=known.described(),
            keeps_numbers=kind == "shape",
            request=request,
            **options,
        )
    return None


@dataclass
class _Parameters:
    """The parameters of one file: declared in [parameters], or made from numbers."""

    taken: set[str]  # names that no number may have
    by_name: dict[str, Parameter]
    numbers: dict[str, float] = field(default_factory=dict)
    meanings: dict[str, tuple[str, str]] = field(default_factory=dict)  # meaning and unit

    def measured(self, slot: str, value: float, *, positive: bool) -> sp.Symbol:
        """The parameter for a number; raises BodyError if it should be positive and is not.

        It has the name of its slot, or a similar one if that has another meaning or value.
        """
        name = next(
            name
            for name in chain([slot], (f"{slot}_{k}" for k in count(2)))
            if name not in self.taken and self.numbers.get(name, value) == value
        )
        self.numbers[name] = value
        symbol = sp.Symbol(name)
        is_positive = positive or value > 0
        self.by_name[name] = Parameter(symbol=symbol, positive=is_positive, value=float(value))
        return symbol

    def explain(self, expressions: Sequence[sp.Expr], about: str, unit: str) -> None:
        """Note the meaning of expressions that are single symbols, unless it is known."""
        for expression in expressions:
            if expression.is_Symbol:
                self.meanings.setdefault(expression.name, (about, unit))

    def value_of(self, expression: sp.Expr) -> float | None:
        """The value of an expression; None unless all its symbols have values."""
        values = {p.symbol: p.value for p in self.by_name.values() if p.value is not None}
        value = expression.xreplace({s: sp.Float(v, 17) for s, v in values.items()})
        return float(value) if value.is_number else None

    def described(self) -> tuple[Parameter, ...]:
        """All parameters with a declaration, a value or a meaning."""
        explained = {
            name: Parameter(symbol=sp.Symbol(name), positive=unit != "m" or "coord" not in about)
            for name, (about, unit) in self.meanings.items()
        }
        return tuple(
            replace(p, about=p.about or about, unit=p.unit or unit)
            for name, p in (explained | self.by_name).items()
            for about, unit in [self.meanings.get(name, ("", ""))]
        )


def _words(data: object) -> Iterator[str]:
    """All words in the texts of a table."""
    if isinstance(data, str):
        yield from _WORD.findall(data)
    elif isinstance(data, Mapping | list):
        for entry in data.values() if isinstance(data, Mapping) else data:
            yield from _words(entry)


@dataclass
class _Table:
    """Reads the expressions of one table. If one is wrong, something else is read instead."""

    data: Data  # checked by the schema: the value of a wrong key is None
    place: Place
    parameters: _Parameters
    suffix: str = ""  # of the names of numbers: "_2" in the second part
    is_exact: bool = False  # whether numbers with a point stay numbers

    def read(self, key: str, slots: Slots, *, positive: bool = False) -> Any:
        """The exact expressions of a key, nested as the names of their slots are."""
        return self._read(self.required(key), slots, self.place.at(key), positive)

    def required(self, key: str) -> Any:
        """The value of a key; a missing one is noted."""
        if key not in self.data:
            self.place.at(key).fault(f'missing; shape = "{self.data["shape"]}" needs it')
        return self.data.get(key)

    def _read(self, value: Any, slots: Slots, place: Place, positive: bool) -> Any:
        if isinstance(slots, str):
            return self._expression(value, slots, place, positive)
        if value is not None and len(value) != len(slots):
            place.mistyped(value, f"a list of {len(slots)} expressions")
            value = None
        entries = zip(slots, value or [None] * len(slots), strict=True)
        return [self._read(v, slot, place.at(k), positive) for k, (slot, v) in enumerate(entries)]

    def _expression(self, value: Any, slot: str, place: Place, positive: bool) -> sp.Expr:
        with place.noting():
            if isinstance(value, str):
                names = {name: sp.Symbol(check_name(name)) for name in names_in(value)}
                return parse_expression(value, names)
            if isinstance(value, float) and value != 0 and not self.is_exact:
                return self.parameters.measured(slot + self.suffix, value, positive=positive)
            if value is not None and positive and value <= 0:
                place.fault(f"expected a positive number, got {sp.Rational(str(value))}")
            elif value is not None:
                return sp.Rational(str(value))
        return _UNREAD

    def mass(self) -> sp.Expr:
        """The mass, or the symbol M if the table has none."""
        if "mass" not in self.data:
            return sp.Symbol("M" + self.suffix)
        return self.read("mass", "M", positive=True)

    def mass_or_density(self) -> dict[str, sp.Expr]:
        """{"mass": ...} or {"density": ...}; the mass M if the table has neither."""
        if "density" not in self.data:
            mass = self.mass()
            self.parameters.explain([mass], "mass", "kg")
            return {"mass": mass}
        if "mass" in self.data:
            self.place.at("density").fault("expected either the mass or the density")
        density = self.read("density", "rho", positive=True)
        self.parameters.explain([density], "density", "")
        return {"density": density}


def _rigid_body(table: _Table, kind: str, options: dict[str, Any]) -> RigidBody:
    """The body of principal_moments = ["A", "A", "C"] or of inertia, in these axes."""
    value = table.data[kind]
    if value == "general":
        return general_inertia(mass=table.mass(), name=options["name"])
    if kind == "inertia":
        known = _known(table)
        options |= {"mass": known.mass, "centre": known.centre}
        return given_inertia(known.inertia, **options, parameters=table.parameters.described())
    slots = [_MOMENTS[value.index(entry)] for entry in value]  # equal numbers share a name
    moments, mass = table.read(kind, slots), table.mass()
    parameters = table.parameters.described()
    return principal_moments(*moments, mass=mass, parameters=parameters, **options)


def _distribution(table: _Table, kind: str) -> distribution.Distribution:
    if kind == "particles":
        return _particles(table)
    if kind == "inertia":
        return _known(table)
    name = table.data["shape"]
    return _given(table) if name == "given" else _shape(table, name)


def _shape(table: _Table, name: str) -> distribution.Distribution:
    """A shipped solid; lengths that the table lacks are their default symbols."""
    values: list[sp.Expr] = []
    for length in SHAPES[name].lengths:
        key, names = length.key, length.names
        if key == "corners":  # coordinates may have any sign
            points = [names[k : k + 3] for k in range(0, len(names), 3)]
            values += chain.from_iterable(table.read(key, points))
            continue
        if key not in table.data:
            own: list[sp.Expr] = [sp.Symbol(name + table.suffix) for name in names]
        else:
            read = table.read(key, names if names[1:] else names[0], positive=True)
            own = read if names[1:] else [read]
        table.parameters.explain(own, length.about, "m")
        values += own
    mass = table.mass_or_density()
    check_lengths(name, [table.parameters.value_of(value) for value in values])
    return shaped(name, values, **mass)


def _given(table: _Table) -> distribution.Distribution:
    """A solid by its coordinates, its place in terms of them, bounds, and a density."""
    data = table.data
    names = [name for name in data.get("coordinates") or _AXES if name is not None]
    coordinates = tuple(sp.Symbol(check_name(name)) for name in names)
    is_mapped = "place" in data or len(names) != len(_AXES)
    bounds = table.read("bounds", [(f"low_{k}", f"high_{k}") for k in range(len(names))])
    return distribution.Solid(
        title="Given solid",
        coordinates=coordinates,
        place=sp.ImmutableMatrix(table.read("place", _AXES) if is_mapped else coordinates),
        bounds=tuple((low, high) for low, high in bounds),
        element=table.read("element", "element") if "element" in data else None,
        **table.mass_or_density(),
    )


def _particles(table: _Table) -> distribution.Distribution:
    """particles = [{ mass = "m", at = ["a", 0, 0] }, ...]; numbers stay exact."""
    particles = []
    for k, entry in enumerate(table.data["particles"]):
        own = replace(
            table,
            data=entry or {"mass": None, "at": None},
            place=table.place.at("particles", k),
            suffix=f"{table.suffix}_{k + 1}",
            is_exact=True,
        )
        mass = own.read("mass", "m", positive=True)
        position = sp.ImmutableMatrix(own.read("at", _AXES))
        particles.append(distribution.Particle(mass=mass, position=position))
    return distribution.Particles(particles=tuple(particles))


def _parts(table: _Table) -> distribution.Distribution:
    """parts = [{ shape = ..., at = [...], turned = "z(pi/4)", hole = true }, ...]."""
    parts: list[distribution.Part] = []
    for k, entry in enumerate(table.data["parts"]):
        kind = next((kind for kind in _OF_PARTS if kind in entry), None)
        if kind is None:
            continue
        place = table.place.at("parts", k)
        own = replace(table, data=entry, place=place, suffix=f"{table.suffix}_{k + 1}")
        turned = distribution.UPRIGHT
        with place.at("turned").noting():
            turned = turned_by(entry["turned"]) if entry.get("turned") else turned
        at = own.read("at", _AXES) if "at" in entry else distribution.HERE
        with place.noting(kind):
            part = distribution.Part(
                what=_distribution(own, kind),
                at=sp.ImmutableMatrix(at),
                turned=turned,
                hole=bool(entry.get("hole")),
                label=entry.get("label") or "",
            )
            parts.append(part)
    return distribution.Composite(parts=tuple(parts))


def _known(table: _Table) -> distribution.Known:
    """inertia = [[...], [...], [...]] about the centre of mass, with mass and centre."""
    inertia = table.read("inertia", _TENSOR)
    has_centre = "centre" in table.data
    centre = table.read("centre", ("x_C", "y_C", "z_C")) if has_centre else [*distribution.HERE]
    mass = table.mass()
    for expressions, about, unit in (
        ([inertia[k][k] for k in range(3)], "moment of inertia", "kg m^2"),
        ([*chain.from_iterable(inertia)], "product of inertia, with its sign", "kg m^2"),
        (centre, "coordinate of the centre of mass", "m"),
        ([mass], "mass", "kg"),
    ):
        table.parameters.explain(expressions, about, unit)
    outline = table.data.get("outline")
    return distribution.Known(
        mass=mass,
        centre=sp.ImmutableMatrix(centre),
        inertia=sp.ImmutableMatrix(inertia),
        outline=distribution.outline_from(outline) if outline else distribution.Outline(),
    )


# Files of numbers, which become parameters that have a value


def _prepared(
    data: Data,
    place: Place,
    kinds: Sequence[str],
    others: Sequence[str],
    folder: Path | None,
    *,
    allow: bool,
) -> Data:
    """The table of one kind, with numbers instead of the file it names; {} if a fault is noted.

    The record contains these numbers, so that it can be checked without the file.
    """
    present = [kind for kind in kinds if kind in data]
    if len(present) != 1:
        got = " and ".join(present) or "none"
        place.fault(f"expected one of {', '.join(kinds)}; got {got}")
        return {}
    (kind,) = present
    value = data[kind]
    is_file = kind == "mesh" or (kind == "particles" and isinstance(value, str))
    own = _OTHER_KEYS.get(value if kind == "shape" else kind, ())
    if kind == "particles" and not is_file:
        own = ()
    for key in data.keys() - {kind, *own, *others}:
        place.at(key).fault(f"unknown key; known: {', '.join((kind, *own, *others))}")
    if value is None:
        return {}
    if kind == "parts":
        what = (_OF_PARTS, ("at", "turned", "hole", "label"), folder)
        steps = enumerate(value)
        parts = [_prepared(p or {}, place.at(kind, k), *what, allow=allow) for k, p in steps]
        return {**data, "parts": parts}
    if is_file:
        with place.at(kind).noting():
            rest = {key: data[key] for key in others if key in data}
            return rest | _numbers(data, kind, folder, allow=allow)
        return {}
    return data


def _numbers(data: Data, kind: str, folder: Path | None, *, allow: bool) -> dict[str, Any]:
    """Mass, centre, inertia tensor and outline of the body in a file.

    A file outside the folder of the derivation file is never quoted in a message.
    """
    if folder is None:
        raise BodyError("expected numbers: a record names no files")
    path = folder / data[kind]
    from rigidsym.data import mass  # needs NumPy, which rotations do not

    try:
        if kind == "particles":
            properties = mass.inertia_of(path, columns=data.get("columns"), allow=allow)
            return properties.as_table() | {"outline": {}}
        mesh = mass.read_mesh_file(path, scale=data.get("scale", 1.0))
        amount = {key: data.get(key) for key in _OF_MASS}
        properties = mass.mesh_inertia(mesh, **amount, allow=allow)
        return properties.as_table() | {"outline": mass.outline_of(mesh)}
    except MissingExtra:
        raise
    except RigidsymError:
        if path.resolve().is_relative_to(folder.resolve()):
            raise
        raise BodyError("no body can be read from this file") from None
