"""Shapes, particles and parts of a derivation file, read into distributions of mass."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, RigidsymError
from rigidsym.models.distribution import (
    HERE,
    UPRIGHT,
    Composite,
    Distribution,
    Part,
    Particle,
    Particles,
    Polyhedron,
    Solid,
)
from rigidsym.models.placement import turned_by
from rigidsym.models.solids import SHAPES, Length, check_lengths, shape_of, shaped
from rigidsym.spec.body_reader import BodyReader
from rigidsym.spec.measured_table import read_cloud, read_known, read_mesh

KINDS = ("shape", "particles", "mesh", "inertia", "parts")
_OF_MASS = ("mass", "density")
_PLACE = ("at", "turned", "hole", "label")
_AXES = ("x", "y", "z")
_GIVEN = ("coordinates", "place", "bounds", "element")
_POLYHEDRON = ("vertices", "faces")
_POINT = 'three coordinates, such as [0, 0, "h"]'


def read_distribution(reader: BodyReader, kind: str) -> Distribution | None:
    """The distribution that a table describes; None if a fault is noted."""
    return _KINDS[kind](reader)


def keys_of(table: Mapping[str, object], kind: str) -> tuple[str, ...]:
    """The keys that go with a kind, `mass` and `density` among them."""
    if kind == "inertia":
        return ("inertia", "mass", "centre")
    if kind == "mesh":
        return ("mesh", *_OF_MASS, "scale")
    if kind == "particles" and isinstance(table.get("particles"), str):
        return ("particles", "columns")
    if kind != "shape":
        return (kind,)
    shape = table.get("shape")
    if shape == "given":
        return ("shape", *_GIVEN, *_OF_MASS)
    if shape == "polyhedron":
        return ("shape", *_POLYHEDRON, *_OF_MASS)
    known = SHAPES.get(shape) if isinstance(shape, str) else None
    lengths = known.lengths if known is not None else ()
    return ("shape", *_OF_MASS, *(length.key for length in lengths))


def _read_shape(reader: BodyReader) -> Distribution | None:
    name = reader.table.text("shape")
    if name is None:
        return None
    if name == "given":
        return _read_given(reader)
    if name == "polyhedron":
        return _read_polyhedron(reader)
    shape = shape_of(name)
    values = [_lengths(reader, length) for length in shape.lengths]
    mass = _mass_or_density(reader)
    if None in values or mass is None:
        return None
    flat = [entry for value in values if value is not None for entry in value]
    check_lengths(name, [reader.declared.number(value) for value in flat])
    return shaped(name, flat, **mass)


def _lengths(reader: BodyReader, length: Length) -> list[sp.Expr] | None:
    """The lengths of one key; if it is missing, their default symbols."""
    table, count = reader.table, len(length.names)
    corners = length.key == "corners"
    if table.value(length.key) is None:
        if corners:
            table.fault("missing; expected four corners of three coordinates", length.key)
            return None
        symbols = [sp.Symbol(name + reader.suffix) for name in length.names]
        for symbol in symbols:
            reader.declared.note(symbol, length.about, "m")
        return symbols
    if corners:
        return _points(reader, "corners", 4, length.names)
    if count == 1:
        value = reader.single(length.key, length.names[0], positive=True)
        values = None if value is None else [value]
    else:
        values = reader.row(length.key, length.names, f"{count} lengths", positive=True)
    for entry in values or ():
        reader.declared.note(entry, length.about, "m")
    return values


def _mass_or_density(reader: BodyReader) -> dict[str, sp.Expr] | None:
    """{"mass": ...} or {"density": ...}; the mass M if the table has neither."""
    table = reader.table
    if table.value("mass") is not None and table.value("density") is not None:
        table.fault("expected either the mass or the density", "density")
        return None
    if table.value("density") is not None:
        density = reader.single("density", "rho", positive=True)
        if density is None:
            return None
        reader.declared.note(density, "density", "")
        return {"density": density}
    mass: sp.Expr | None = sp.Symbol("M" + reader.suffix)
    if table.value("mass") is not None:
        mass = reader.single("mass", "M", positive=True)
    if mass is None:
        return None
    reader.declared.note(mass, "mass", "kg")
    return {"mass": mass}


def _points(
    reader: BodyReader, key: str, count: int | None, slots: tuple[str, ...] = ()
) -> list[sp.Expr] | None:
    """The coordinates of a list of points, one after the other."""
    value = reader.table.value(key)
    rows = value if isinstance(value, list) else []
    is_fine = rows and all(isinstance(row, list) and len(row) == 3 for row in rows)
    if not is_fine or (count is not None and len(rows) != count):
        number = "points" if count is None else f"{count} points"
        reader.table.mistyped(value, f"a list of {number} of three coordinates", key)
        return None
    names = slots or tuple(f"{axis}_{k}" for k in range(len(rows)) for axis in _AXES)
    read = [reader.entries(row, names[3 * k : 3 * k + 3], key, k) for k, row in enumerate(rows)]
    found = [entry for row in read if row is not None for entry in row]
    return found if len(found) == 3 * len(rows) else None


def _read_given(reader: BodyReader) -> Distribution | None:
    """A solid by its coordinates, its place in terms of them, bounds, and a density."""
    table = reader.table
    names = [text for text in table.texts("coordinates", "one to three names") or [] if text]
    names = names or list(_AXES)
    coordinates = tuple(reader.declared.symbol(name) for name in names)
    place: list[sp.Expr] | None = list(coordinates)
    if table.value("place") is not None or len(names) != 3:
        place = reader.row("place", _AXES, _POINT)
    bounds = _bounds(reader, len(names))
    element = reader.single("element", "element")
    mass = _mass_or_density(reader)
    if place is None or bounds is None or mass is None:
        return None
    return Solid(
        title="Given solid",
        coordinates=coordinates,
        place=sp.ImmutableMatrix(place),
        bounds=bounds,
        element=element,
        **mass,
    )


def _bounds(reader: BodyReader, count: int) -> tuple[tuple[sp.Expr, sp.Expr], ...] | None:
    value = reader.table.value("bounds")
    rows = value if isinstance(value, list) else []
    if len(rows) != count or not all(isinstance(row, list) and len(row) == 2 for row in rows):
        reader.table.mistyped(value, f"{count} pairs of bounds, the outermost first", "bounds")
        return None
    read = [
        reader.entries(row, (f"low_{k}", f"high_{k}"), "bounds", k) for k, row in enumerate(rows)
    ]
    return tuple((row[0], row[1]) for row in read if row) if all(read) else None


def _read_polyhedron(reader: BodyReader) -> Distribution | None:
    points, mass = _points(reader, "vertices", None), _mass_or_density(reader)
    value = reader.table.value("faces")
    faces = value if isinstance(value, list) else []
    is_fine = faces and all(
        isinstance(face, list) and all(isinstance(k, int) for k in face) for face in faces
    )
    if not is_fine:
        reader.table.mistyped(value, "a list of faces, each a list of corner numbers", "faces")
    if points is None or mass is None or not is_fine:
        return None
    return Polyhedron(
        vertices=tuple(sp.ImmutableMatrix(points[k : k + 3]) for k in range(0, len(points), 3)),
        faces=tuple(map(tuple, faces)),
        **mass,
    )


def _read_particles(reader: BodyReader) -> Distribution | None:
    """particles = [{ mass = "m", at = ["a", 0, 0] }, ...], or a file; numbers stay exact."""
    if isinstance(reader.table.value("particles"), str):
        return read_cloud(reader)
    particles = []
    tables = reader.table.tables("particles", "a list of tables with mass and at, or a file")
    for place, table in enumerate(tables):
        table.refuse_others(("mass", "at"))
        own = reader.inside(table, f"_{place + 1}", exact=True)
        mass = own.single("mass", "m", positive=True)
        if table.value("mass") is None:
            table.fault("missing; expected the mass of the particle", "mass")
        at = own.row("at", _AXES, _POINT)
        if mass is not None and at is not None:
            particles.append(Particle(mass=mass, position=sp.ImmutableMatrix(at)))
    if not tables or len(particles) < len(tables):
        return None
    return Particles(particles=tuple(particles))


def _read_parts(reader: BodyReader) -> Distribution | None:
    """parts = [{ shape = ..., at = [...], turned = "z(pi/4)", hole = true }, ...]."""
    parts = []
    conditions: list[sp.Expr] = []
    tables = reader.table.tables("parts", "a list of tables, each with a shape or particles")
    for place, table in enumerate(tables):
        own = reader.inside(table, f"_{place + 1}")
        part = _read_part(own, conditions)
        if part is not None:
            parts.append(part)
    if not tables or len(parts) < len(tables):
        return None
    return Composite(parts=tuple(parts), conditions=tuple(conditions))


def _read_part(reader: BodyReader, conditions: list[sp.Expr]) -> Part | None:
    table = reader.table
    kinds = [kind for kind in KINDS if table.value(kind) is not None]
    if len(kinds) != 1:
        table.fault(f"expected one of {', '.join(KINDS)}")
        return None
    (kind,) = kinds
    table.refuse_others((*keys_of(table.data, kind), *_PLACE))
    try:
        what = read_distribution(reader, kind)
        turned, bound = _turned(reader)
    except ExpressionError as error:
        table.fault(f"column {error.column}: {error.message}", "turned")
        return None
    except RigidsymError as error:
        table.fault(str(error), kind)
        return None
    conditions += bound
    at = HERE
    if table.value("at") is not None:
        row = reader.row("at", ("x", "y", "z"), _POINT)
        if row is None:
            return None
        at = sp.ImmutableMatrix(row)
    if what is None:
        return None
    return Part(
        what=what,
        at=at,
        turned=turned,
        hole=bool(table.flag("hole")),
        label=table.text("label") or "",
    )


def _turned(reader: BodyReader) -> tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]:
    """The matrix of turned = "z(pi/4) x(alpha)", or of { rotation = "ZXZ", values = [...] }."""
    value = reader.table.value("turned")
    if value is None:
        return UPRIGHT, ()
    if isinstance(value, str):
        return turned_by(value)
    inner = reader.table.table("turned")
    if inner is None:
        return UPRIGHT, ()
    inner.refuse_others(("rotation", "values"))
    own = reader.inside(inner, exact=True)
    values: Any = inner.value("values")
    text = inner.text("rotation")
    if text is None or not isinstance(values, list):
        inner.fault('expected rotation = "ZXZ" or another, and a list of values')
        return UPRIGHT, ()
    read = own.entries(values, tuple(f"q_{k}" for k in range(len(values))), "values")
    return turned_by(text, read) if read is not None else (UPRIGHT, ())


_KINDS: Mapping[str, Callable[[BodyReader], Distribution | None]] = MappingProxyType(
    {
        "shape": _read_shape,
        "particles": _read_particles,
        "mesh": read_mesh,
        "inertia": read_known,
        "parts": _read_parts,
    }
)
