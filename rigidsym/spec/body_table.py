"""The [body] table of a derivation file: moments, shapes, particles, parts, numbers in files."""

from __future__ import annotations

import stat
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.errors import BodyError, MissingExtra, RigidsymError
from rigidsym.models import body as distribution
from rigidsym.models.body import (
    BodyDescription,
    RigidBody,
    general_inertia,
    given_inertia,
    principal_moments,
)
from rigidsym.models.library import turned_by
from rigidsym.models.parametrisations import axes_example
from rigidsym.models.solids import SHAPES, Length, check_lengths, shape_of, shaped
from rigidsym.spec.body_reader import BodyReader, Declared
from rigidsym.spec.derivation_spec import Body
from rigidsym.spec.tables import Table

if TYPE_CHECKING:
    from rigidsym.data.mass import MassProperties

    Measured = tuple[MassProperties, Mapping[str, object]]  # with the outline of the body

_OF_PARTS = ("shape", "particles", "mesh", "inertia", "parts")
_KINDS = ("principal_moments", "inertia", "shape", "particles", "mesh", "parts")
_OF_MASS = ("mass", "density")
_KEYS = {  # that go with a kind
    "principal_moments": ("mass",),
    "inertia": ("mass", "centre", "outline"),
    "mesh": (*_OF_MASS, "scale"),
    "particles": ("columns",),
    "given": ("coordinates", "place", "bounds", "element", *_OF_MASS),
    "polyhedron": ("vertices", "faces", *_OF_MASS),
}
_AXES = ("x", "y", "z")
_POINT = 'three coordinates, such as [0, 0, "h"]'
_MOMENTS = ("A", "B", "C")
_TENSOR = (("I_11", "I_12", "I_13"), ("I_12", "I_22", "I_23"), ("I_13", "I_23", "I_33"))


def read_body(body: Table, parameters: Table | None, name: str, folder: Path | None) -> Body | None:
    """The body of a file, called `name`; None if a fault is noted.

    Paths in it start from `folder`; a record names no files. Distributions are not integrated.
    """
    declared = Declared(body, parameters)
    kind = _kind_of(body, _KINDS, ("allow",))
    if kind is None:
        return None
    reader, allow = BodyReader(body, declared, folder), bool(body.flag("allow"))
    given: RigidBody | distribution.Distribution | None = None
    with body.noting(kind):
        is_given = kind == "inertia" and body.value("outline") is None
        if kind == "principal_moments" or is_given:
            given = _rigid_body(reader, kind, name, allow=allow)
        else:
            given = _READERS[kind](reader)
    if given is None:
        return None
    request: dict[str, object] = {"body": declared.without_files(body.data, body.path)}
    request |= {"parameters": parameters.data} if parameters else {}
    if isinstance(given, RigidBody):
        return replace(given, request=request)
    return BodyDescription(
        distribution=given,
        name=name,
        parameters=declared.given(),
        allow=allow,
        keeps_numbers=kind == "shape",
        request=request,
    )


def _kind_of(table: Table, kinds: Sequence[str], others: Sequence[str]) -> str | None:
    """The one kind that a table is of; other keys than those of its kind are refused."""
    found = [kind for kind in kinds if table.value(kind) is not None]
    if len(found) != 1:
        table.fault(f"expected one of {', '.join(kinds)}; got {' and '.join(found) or 'none'}")
        return None
    (kind,) = found
    own: tuple[str, ...] = _KEYS.get(kind, ())
    given = table.value(kind)
    if kind == "particles" and not isinstance(given, str):
        own = ()
    if kind == "shape" and isinstance(given, str):
        lengths = SHAPES[given].lengths if given in SHAPES else ()
        own = _KEYS.get(given, (*_OF_MASS, *(length.key for length in lengths)))
    table.refuse_others((kind, *own, *others))
    return kind


def _rigid_body(reader: BodyReader, kind: str, name: str, *, allow: bool) -> RigidBody:
    """The body of principal_moments = ["A", "A", "C"] or of inertia, in these axes."""
    value = reader.table.value(kind)
    if value == "general":
        return general_inertia(mass=_mass(reader), name=name)
    options: dict[str, Any] = {"name": name, "allow": allow}
    if kind == "inertia":
        known = _read_known(reader)
        options |= {"mass": known.mass, "centre": known.centre}
        return given_inertia(known.inertia, parameters=reader.declared.given(), **options)
    slots: Sequence[str] = _MOMENTS
    if isinstance(value, list) and len(value) == 3:
        slots = [_MOMENTS[value.index(entry)] for entry in value]  # equal numbers share a name
    moments = reader.row(kind, slots, "three moments of inertia")
    mass = _mass(reader)
    return principal_moments(*moments, mass=mass, parameters=reader.declared.given(), **options)


def _mass(reader: BodyReader) -> sp.Expr:
    """The mass, or the symbol M if the table has none."""
    if reader.table.value("mass") is None:
        return sp.Symbol("M" + reader.suffix)
    return reader.single("mass", "M", positive=True)


def _mass_or_density(reader: BodyReader) -> dict[str, sp.Expr]:
    """{"mass": ...} or {"density": ...}; the mass M if the table has neither."""
    if reader.table.value("density") is None:
        mass = _mass(reader)
        reader.declared.note([mass], "mass", "kg")
        return {"mass": mass}
    if reader.table.value("mass") is not None:
        reader.table.fault("expected either the mass or the density", "density")
    density = reader.single("density", "rho", positive=True)
    reader.declared.note([density], "density", "")
    return {"density": density}


# shapes


def _read_shape(reader: BodyReader) -> distribution.Distribution:
    name = reader.table.text("shape") or ""
    if name in ("given", "polyhedron"):
        return _read_given(reader) if name == "given" else _read_polyhedron(reader)
    values = [entry for length in shape_of(name).lengths for entry in _lengths(reader, length)]
    mass = _mass_or_density(reader)
    check_lengths(name, [reader.declared.number(value) for value in values])
    return shaped(name, values, **mass)


def _lengths(reader: BodyReader, length: Length) -> list[sp.Expr]:
    """The lengths of one key; if it is missing, their default symbols."""
    key, names = length.key, length.names
    if key == "corners":
        slots = [names[k : k + 3] for k in range(0, len(names), 3)]
        corners = reader.rows(key, slots, "a list of 4 points of three coordinates")
        return [entry for corner in corners for entry in corner]
    if reader.table.value(key) is None:
        values: list[sp.Expr] = [sp.Symbol(name + reader.suffix) for name in names]
    elif len(names) == 1:
        values = [reader.single(key, names[0], positive=True)]
    else:
        values = reader.row(key, names, f"{len(names)} lengths", positive=True)
    reader.declared.note(values, length.about, "m")
    return values


def _read_given(reader: BodyReader) -> distribution.Distribution:
    """A solid by its coordinates, its place in terms of them, bounds, and a density."""
    table = reader.table
    names = [*table.texts("coordinates", "one to three names").values()] or [*_AXES]
    coordinates = tuple(reader.declared.symbol(name) for name in names)
    place: list[sp.Expr] = list(coordinates)
    if table.value("place") is not None or len(names) != 3:
        place = reader.row("place", _AXES, _POINT)
    slots = [(f"low_{k}", f"high_{k}") for k in range(len(names))]
    bounds = reader.rows("bounds", slots, f"{len(names)} pairs of bounds, the outermost first")
    has_element = table.value("element") is not None
    return distribution.Solid(
        title="Given solid",
        coordinates=coordinates,
        place=sp.ImmutableMatrix(place),
        bounds=tuple((low, high) for low, high in bounds),
        element=reader.single("element", "element") if has_element else None,
        **_mass_or_density(reader),
    )


def _read_polyhedron(reader: BodyReader) -> distribution.Distribution:
    points = reader.rows("vertices", 3, "a list of points of three coordinates")
    value = reader.table.value("faces")
    faces = value if isinstance(value, list) else []
    is_fine = all(isinstance(f, list) and all(isinstance(k, int) for k in f) for f in faces)
    if not faces or not is_fine:
        expected = "a list of faces, each a list of corner numbers"
        reader.table.mistyped(value, expected, "faces")
        faces = []
    return distribution.Polyhedron(
        vertices=tuple(map(sp.ImmutableMatrix, points)),
        faces=tuple(map(tuple, faces)),
        **_mass_or_density(reader),
    )


# particles and parts


def _read_particles(reader: BodyReader) -> distribution.Distribution:
    """particles = [{ mass = "m", at = ["a", 0, 0] }, ...], or a file; numbers stay exact."""
    if isinstance(reader.table.value("particles"), str):
        return _read_cloud(reader)
    particles = []
    tables = reader.table.tables("particles", "a list of tables with mass and at, or a file")
    for place, table in enumerate(tables, start=1):
        table.refuse_others(("mass", "at"))
        own = reader.inside(table, f"_{place}", exact=True)
        mass = own.single("mass", "m", positive=True)
        at = own.row("at", _AXES, _POINT)
        particles.append(distribution.Particle(mass=mass, position=sp.ImmutableMatrix(at)))
    return distribution.Particles(particles=tuple(particles))


def _read_parts(reader: BodyReader) -> distribution.Distribution:
    """parts = [{ shape = ..., at = [...], turned = "z(pi/4)", hole = true }, ...]."""
    conditions: list[sp.Expr] = []
    tables = reader.table.tables("parts", "a list of tables, each with a shape or particles")
    parts = [
        _read_part(reader.inside(table, f"_{place}"), conditions)
        for place, table in enumerate(tables, start=1)
    ]
    found = tuple(part for part in parts if part is not None)
    return distribution.Composite(
        parts=found, conditions=tuple(conditions), example=axes_example(conditions)
    )


def _read_part(reader: BodyReader, conditions: list[sp.Expr]) -> distribution.Part | None:
    table = reader.table
    kind = _kind_of(table, _OF_PARTS, ("at", "turned", "hole", "label"))
    if kind is None:
        return None
    what: distribution.Distribution | None = None
    turned = distribution.UPRIGHT
    with table.noting(kind):
        what = _READERS[kind](reader)
    with table.noting("turned"):
        turned, bound = _turned(reader)
        conditions += bound
    at: Sequence[sp.Expr] = [sp.S.Zero] * 3
    if table.value("at") is not None:
        at = reader.row("at", _AXES, _POINT)
    if what is None:
        return None
    return distribution.Part(
        what=what,
        at=sp.ImmutableMatrix(at),
        turned=turned,
        hole=bool(table.flag("hole")),
        label=table.text("label") or "",
    )


def _turned(reader: BodyReader) -> tuple[sp.ImmutableMatrix, tuple[sp.Expr, ...]]:
    """The matrix of turned = "z(pi/4) x(alpha)", or of { rotation = "ZXZ", values = [...] }."""
    value = reader.table.value("turned")
    if isinstance(value, str):
        return turned_by(value)
    inner = reader.table.table("turned")
    if inner is None:
        return distribution.UPRIGHT, ()
    inner.refuse_others(("rotation", "values"))
    values, text = inner.value("values"), inner.text("rotation")
    if text is None or not isinstance(values, list):
        raise BodyError('expected rotation = "ZXZ" or another, and a list of values')
    slots = [f"q_{k}" for k in range(len(values))]
    return turned_by(text, reader.inside(inner, exact=True).entries(values, slots, "values"))


# numbers; the derivation stays exact, since they become parameters that have a value


def _read_known(reader: BodyReader) -> distribution.Known:
    """inertia = [[...], [...], [...]] about the centre of mass, with mass and centre."""
    note = reader.declared.note
    drawn = reader.table.table("outline")
    inertia = reader.rows("inertia", _TENSOR, 'three rows of three expressions, or "general"')
    centre: list[sp.Expr] = [sp.S.Zero] * 3
    if reader.table.value("centre") is not None:
        centre = reader.row("centre", ("x_C", "y_C", "z_C"), "three coordinates")
    mass = _mass(reader)
    note([inertia[k][k] for k in range(3)], "moment of inertia", "kg m^2")
    note([*chain.from_iterable(inertia)], "product of inertia, with its sign", "kg m^2")
    note(centre, "coordinate of the centre of mass", "m")
    note([mass], "mass", "kg")
    return distribution.Known(
        mass=mass,
        centre=sp.ImmutableMatrix(centre),
        inertia=sp.ImmutableMatrix(inertia),
        outline=distribution.Outline() if drawn is None else distribution.outline_from(drawn.data),
    )


def _read_cloud(reader: BodyReader) -> distribution.Known:
    """particles = "cloud.npy": particles in NPY, CSV or Parquet."""
    columns = [*reader.table.texts("columns", "names of the columns").values()] or None
    allow = bool(reader.table.flag("allow"))
    from rigidsym.data.mass import inertia_of  # needs NumPy, which rotations do not

    def measured(path: Path) -> tuple[MassProperties, Mapping[str, object]]:
        return inertia_of(path, columns=columns, allow=allow), {}

    return _in_file(reader, "particles", measured)


def _read_mesh(reader: BodyReader) -> distribution.Known:
    """mesh = "part.stl", with its mass or density, and its length unit in metres as `scale`."""
    table = reader.table
    mass, density, scale = (table.number(key) for key in ("mass", "density", "scale"))
    allow = bool(table.flag("allow"))
    from rigidsym.data.mass import mesh_inertia, outline_of, read_mesh_file

    def measured(path: Path) -> tuple[MassProperties, Mapping[str, object]]:
        mesh = read_mesh_file(path, scale=1.0 if scale is None else scale)
        found = mesh_inertia(mesh, mass=mass, density=density, allow=allow)
        return found, outline_of(mesh)

    return _in_file(reader, "mesh", measured)


def _in_file(
    reader: BodyReader, key: str, measure: Callable[[Path], Measured]
) -> distribution.Known:
    """The body in the file that a key names, read as if the table itself held its numbers.

    The record keeps the numbers, so that it can be checked without the file. A file outside the
    folder of the derivation file is never quoted in a message.
    """
    if reader.folder is None:
        raise BodyError("expected numbers: a record names no files")
    path = reader.folder / (reader.table.text(key) or "")
    try:
        found, outline = measure(path)
    except MissingExtra:
        raise
    except RigidsymError:
        if path.resolve().is_relative_to(reader.folder.resolve()):
            raise
        raise BodyError(f"expected a file with a body, got {_described(path)}") from None
    numbers = found.as_table() | {"outline": outline}
    table = reader.table.instead(numbers)
    reader.declared.files[table.path] = numbers
    return _read_known(BodyReader(table, reader.declared, reader.folder, reader.suffix))


def _described(path: Path) -> str:
    """A file by its kind and size."""
    try:
        status = path.stat()
    except OSError as error:
        return f"{error.strerror}"
    if not stat.S_ISREG(status.st_mode):
        return "a folder" if stat.S_ISDIR(status.st_mode) else "a device"
    return f"a file of {status.st_size} bytes"


_READERS: Mapping[str, Callable[[BodyReader], distribution.Distribution]] = {
    "shape": _read_shape,
    "particles": _read_particles,
    "mesh": _read_mesh,
    "inertia": _read_known,
    "parts": _read_parts,
}
