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
from rigidsym.models.parametrisations import axes_example
from rigidsym.models.solids import SHAPES, Length, check_lengths, shaped
from rigidsym.spec.derivation_spec import Body
from rigidsym.spec.faults import Place
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name

Data = Mapping[str, Any]

_OF_PARTS = ("shape", "particles", "mesh", "inertia")
_KINDS = ("principal_moments", "inertia", "shape", "particles", "mesh", "parts")
_OF_MASS = ("mass", "density")
_OTHER_KEYS = {  # that go with a kind, or with a shape
    "principal_moments": ("mass",),
    "inertia": ("mass", "centre", "outline"),
    "mesh": (*_OF_MASS, "scale"),
    "particles": ("columns",),
    "given": ("coordinates", "place", "bounds", "element", *_OF_MASS),
    "polyhedron": ("vertices", "faces", *_OF_MASS),
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
    data = _prepared(data, place.at("body"), _KINDS, ("allow",), folder, allow=allow)
    kind = next((kind for kind in _KINDS if kind in data), None)
    if kind is None:
        return None
    declared = _Parameters.of(data, parameters, place.at("parameters"))
    reader = _Reader(data, place.at("body"), declared)
    options: dict[str, Any] = {"name": name, "allow": allow}
    request = {"body": data} | ({"parameters": parameters} if parameters else {})
    with reader.place.noting(kind):
        if kind == "principal_moments" or (kind == "inertia" and "outline" not in data):
            return replace(_rigid_body(reader, kind, options), request=request)
        return BodyDescription(
            distribution=_parts(reader) if kind == "parts" else _distribution(reader, kind),
            parameters=declared.described(),
            keeps_numbers=kind == "shape",
            request=request,
            **options,
        )
    return None


@dataclass
class _Parameters:
    """The parameters of one file: declared in [parameters], or made from numbers."""

    taken: set[str]  # names that no number may have
    by_name: dict[str, Parameter] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    meanings: dict[str, tuple[str, str]] = field(default_factory=dict)  # meaning and unit

    @classmethod
    def of(cls, data: Data, declared: Mapping[str, Data], place: Place) -> _Parameters:
        by_name = {}
        for key, entry in declared.items():
            with place.at(key).noting():
                name = check_name(key)
                words = {what: (entry or {}).get(what) or "" for what in ("about", "unit")}
                by_name[name] = Parameter(
                    symbol=sp.Symbol(name),
                    positive=(entry or {}).get("positive") is not False,
                    value=(entry or {}).get("value"),
                    **words,
                )
        return cls({*_words(data), *by_name}, by_name)

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
        self.by_name[name] = Parameter(
            symbol=sp.Symbol(name), positive=positive or value > 0, value=float(value)
        )
        return sp.Symbol(name)

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
class _Reader:
    """Reads the values of one table. If a value is wrong, something else is read instead."""

    data: Data  # checked by `keys`: the value of a wrong key is None
    place: Place
    parameters: _Parameters
    suffix: str = ""  # of the names of numbers: "_2" in the second part
    is_exact: bool = False  # whether numbers with a point stay numbers

    def expression(
        self, value: Any, slot: str, *steps: str | int, positive: bool = False
    ) -> sp.Expr:
        """The exact expression of a text or a number at a path."""
        place = self.place.at(*steps)
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

    def required(self, key: str) -> Any:
        """The value of a key; a missing one is noted."""
        if key not in self.data:
            message = f'missing; shape = "{self.data["shape"]}" needs it'
            self.place.at(key).fault(message)
        return self.data.get(key)

    def single(self, key: str, slot: str, *, positive: bool = False) -> sp.Expr:
        return self.expression(self.required(key), slot, key, positive=positive)

    def row(self, key: str, slots: Sequence[str], *, positive: bool = False) -> list[sp.Expr]:
        """A list of as many expressions as there are slots."""
        return self.entries(self.required(key), slots, key, positive=positive)

    def rows(self, key: str, slots: Sequence[Sequence[str]]) -> list[list[sp.Expr]]:
        values = self._counted(self.required(key), len(slots), key)
        return [self.entries(row, slots[k], key, k) for k, row in enumerate(values)]

    def entries(
        self, values: Any, slots: Sequence[str], *steps: str | int, positive: bool = False
    ) -> list[sp.Expr]:
        values = self._counted(values, len(slots), *steps)
        return [
            self.expression(value, slot, *steps, k, positive=positive)
            for k, (value, slot) in enumerate(zip(values, slots, strict=True))
        ]

    def _counted(self, values: list[Any] | None, size: int, *steps: str | int) -> list[Any]:
        if values is not None and len(values) != size:
            self.place.at(*steps).mistyped(values, f"a list of {size} expressions")
            values = None
        return [None] * size if values is None else values

    def mass(self) -> sp.Expr:
        """The mass, or the symbol M if the table has none."""
        if "mass" not in self.data:
            return sp.Symbol("M" + self.suffix)
        return self.single("mass", "M", positive=True)

    def mass_or_density(self) -> dict[str, sp.Expr]:
        """{"mass": ...} or {"density": ...}; the mass M if the table has neither."""
        if "density" not in self.data:
            mass = self.mass()
            self.parameters.explain([mass], "mass", "kg")
            return {"mass": mass}
        if "mass" in self.data:
            self.place.at("density").fault("expected either the mass or the density")
        density = self.single("density", "rho", positive=True)
        self.parameters.explain([density], "density", "")
        return {"density": density}


def _rigid_body(reader: _Reader, kind: str, options: dict[str, Any]) -> RigidBody:
    """The body of principal_moments = ["A", "A", "C"] or of inertia, in these axes."""
    value = reader.data[kind]
    if value == "general":
        return general_inertia(mass=reader.mass(), name=options["name"])
    if kind == "inertia":
        known = _known(reader)
        options |= {"mass": known.mass, "centre": known.centre}
        options["parameters"] = reader.parameters.described()
        return given_inertia(known.inertia, **options)
    slots = [_MOMENTS[value.index(entry)] for entry in value]  # equal numbers share a name
    moments = reader.row(kind, slots)
    mass = reader.mass()
    return principal_moments(
        *moments, mass=mass, parameters=reader.parameters.described(), **options
    )


def _distribution(reader: _Reader, kind: str) -> distribution.Distribution:
    if kind == "shape":
        name = reader.data["shape"]
        special = {"given": _given, "polyhedron": _polyhedron}
        return special[name](reader) if name in special else _shape(reader, name)
    return _particles(reader) if kind == "particles" else _known(reader)


# shapes


def _shape(reader: _Reader, name: str) -> distribution.Distribution:
    values = [value for length in SHAPES[name].lengths for value in _lengths(reader, length)]
    mass = reader.mass_or_density()
    check_lengths(name, [reader.parameters.value_of(value) for value in values])
    return shaped(name, values, **mass)


def _lengths(reader: _Reader, length: Length) -> list[sp.Expr]:
    """The lengths of one key; if it is missing, their default symbols."""
    key, names = length.key, length.names
    if key == "corners":
        rows = reader.rows(key, [names[k : k + 3] for k in range(0, len(names), 3)])
        return [*chain.from_iterable(rows)]
    if key not in reader.data:
        values: list[sp.Expr] = [sp.Symbol(name + reader.suffix) for name in names]
    elif len(names) == 1:
        values = [reader.single(key, names[0], positive=True)]
    else:
        values = reader.row(key, names, positive=True)
    reader.parameters.explain(values, length.about, "m")
    return values


def _given(reader: _Reader) -> distribution.Distribution:
    """A solid by its coordinates, its place in terms of them, bounds, and a density."""
    data = reader.data
    names = [name for name in data.get("coordinates") or _AXES if name is not None]
    coordinates = tuple(sp.Symbol(check_name(name)) for name in names)
    is_mapped = "place" in data or len(names) != len(_AXES)
    bounds = reader.rows("bounds", [(f"low_{k}", f"high_{k}") for k in range(len(names))])
    return distribution.Solid(
        title="Given solid",
        coordinates=coordinates,
        place=sp.ImmutableMatrix(reader.row("place", _AXES) if is_mapped else coordinates),
        bounds=tuple((low, high) for low, high in bounds),
        element=reader.single("element", "element") if "element" in data else None,
        **reader.mass_or_density(),
    )


def _polyhedron(reader: _Reader) -> distribution.Distribution:
    corners = reader.required("vertices") or []
    slots = [[f"{axis}_{k}" for axis in _AXES] for k in range(len(corners))]
    return distribution.Polyhedron(
        vertices=tuple(map(sp.ImmutableMatrix, reader.rows("vertices", slots))),
        faces=tuple(tuple(face or ()) for face in reader.required("faces") or ()),
        **reader.mass_or_density(),
    )


# particles and parts


def _particles(reader: _Reader) -> distribution.Distribution:
    """particles = [{ mass = "m", at = ["a", 0, 0] }, ...]; numbers stay exact."""
    particles = []
    for k, entry in enumerate(reader.data["particles"]):
        own = _Reader(
            entry or {"mass": None, "at": None},
            reader.place.at("particles", k),
            reader.parameters,
            f"{reader.suffix}_{k + 1}",
            is_exact=True,
        )
        mass = own.single("mass", "m", positive=True)
        position = sp.ImmutableMatrix(own.row("at", _AXES))
        particles.append(distribution.Particle(mass=mass, position=position))
    return distribution.Particles(particles=tuple(particles))


def _parts(reader: _Reader) -> distribution.Distribution:
    """parts = [{ shape = ..., at = [...], turned = "z(pi/4)", hole = true }, ...]."""
    parts: list[distribution.Part] = []
    conditions: list[sp.Expr] = []
    for k, entry in enumerate(reader.data["parts"]):
        kind = next((kind for kind in _OF_PARTS if kind in entry), None)
        if kind is None:
            continue
        place = reader.place.at("parts", k)
        own = _Reader(entry, place, reader.parameters, f"{reader.suffix}_{k + 1}")
        turned = distribution.UPRIGHT
        with place.at("turned").noting():
            turned, bound = _turned(own)
            conditions += bound
        at = own.row("at", _AXES) if "at" in entry else distribution.HERE
        with place.noting(kind):
            part = distribution.Part(
                what=_distribution(own, kind),
                at=sp.ImmutableMatrix(at),
                turned=turned,
                hole=bool(entry.get("hole")),
                label=entry.get("label") or "",
            )
            parts.append(part)
    return distribution.Composite(
        parts=tuple(parts), conditions=tuple(conditions), example=axes_example(conditions)
    )


def _turned(reader: _Reader) -> tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]:
    """The matrix of turned = "z(pi/4) x(alpha)", or of { rotation = "ZXZ", values = [...] }."""
    value = reader.data.get("turned")
    if isinstance(value, str):
        return turned_by(value)
    if not value or None in value.values():
        return distribution.UPRIGHT, ()
    exact = replace(reader, is_exact=True)
    slots = [f"q_{k}" for k in range(len(value["values"]))]
    return turned_by(value["rotation"], exact.entries(value["values"], slots, "turned", "values"))


# numbers; the derivation stays exact, since they become parameters that have a value


def _known(reader: _Reader) -> distribution.Known:
    """inertia = [[...], [...], [...]] about the centre of mass, with mass and centre."""
    inertia = reader.rows("inertia", _TENSOR)
    has_centre = "centre" in reader.data
    centre = reader.row("centre", ("x_C", "y_C", "z_C")) if has_centre else [*distribution.HERE]
    mass = reader.mass()
    for expressions, about, unit in (
        ([inertia[k][k] for k in range(3)], "moment of inertia", "kg m^2"),
        ([*chain.from_iterable(inertia)], "product of inertia, with its sign", "kg m^2"),
        (centre, "coordinate of the centre of mass", "m"),
        ([mass], "mass", "kg"),
    ):
        reader.parameters.explain(expressions, about, unit)
    outline = reader.data.get("outline")
    return distribution.Known(
        mass=mass,
        centre=sp.ImmutableMatrix(centre),
        inertia=sp.ImmutableMatrix(inertia),
        outline=distribution.outline_from(outline) if outline else distribution.Outline(),
    )


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
    is_file = kind == "mesh" or isinstance(value, str)
    own = _OTHER_KEYS.get(value if kind == "shape" else kind, ())
    if kind == "shape" and value in SHAPES:
        own = (*_OF_MASS, *(length.key for length in SHAPES[value].lengths))
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
    if kind in _OTHER_KEYS and is_file and kind != "inertia":
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
        given = {key: data.get(key) for key in _OF_MASS}
        properties = mass.mesh_inertia(mesh, **given, allow=allow)
        return properties.as_table() | {"outline": mass.outline_of(mesh)}
    except MissingExtra:
        raise
    except RigidsymError:
        if path.resolve().is_relative_to(folder.resolve()):
            raise
        raise BodyError("no body can be read from this file") from None
