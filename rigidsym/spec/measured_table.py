"""Bodies in numbers: meshes, files of particles, inertia tensors.

The derivation stays exact: measured numbers become parameters that have a value.
"""

from __future__ import annotations

import stat
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.errors import MissingExtra, RigidsymError
from rigidsym.models.distribution import Known
from rigidsym.spec.body_reader import BodyReader

if TYPE_CHECKING:
    from rigidsym.data.mass.properties import MassProperties

_ROUNDING = 1e-14  # relative to the largest moment: smaller numbers are rounding errors
_SLOTS = tuple(f"I_{min(i, j)}{max(i, j)}" for i in (1, 2, 3) for j in (1, 2, 3))
_CENTRE = ("x_C", "y_C", "z_C")
_MOMENT = "moment of inertia", "kg m^2"
_PRODUCT = "product of inertia, with its sign", "kg m^2"
_COORDINATE = "coordinate of the centre of mass", "m"


def read_cloud(reader: BodyReader) -> Known | None:
    """particles = "cloud.npy": particles in NPY, CSV or Parquet."""
    from rigidsym.data.mass.point_masses import inertia_of

    table = reader.table
    columns = table.texts("columns", "names of the columns")
    if columns is not None and None in columns:
        return None
    names = None if columns is None else [name for name in columns if name is not None]
    allow = bool(table.flag("allow"))
    return _in_file(reader, "particles", lambda path: inertia_of(path, columns=names, allow=allow))


def read_mesh(reader: BodyReader) -> Known | None:
    """mesh = "part.stl", with its mass or density, and its length unit in metres as `scale`."""
    from rigidsym.data.mass.mesh import mesh_inertia, read_mesh_file

    table = reader.table
    mass, density, scale = (table.number(key) for key in ("mass", "density", "scale"))
    if any(
        table.value(key) is not None and value is None
        for key, value in (("mass", mass), ("density", density), ("scale", scale))
    ):
        return None
    allow = bool(table.flag("allow"))

    def measured(path: Path) -> MassProperties:
        mesh = read_mesh_file(path, scale=1.0 if scale is None else scale)
        return mesh_inertia(mesh, mass=mass, density=density, allow=allow)

    return _in_file(reader, "mesh", measured)


def _in_file(
    reader: BodyReader, key: str, measure: Callable[[Path], MassProperties]
) -> Known | None:
    """The body in the file that a key names.

    A file outside the folder of the derivation file is never quoted in a message.
    """
    text = reader.table.text(key)
    if text is None:
        return None
    if reader.folder is None:
        reader.table.fault("expected numbers: a record names no files", key)
        return None
    path = reader.folder / text
    try:
        return _known(reader, measure(path))
    except MissingExtra:
        raise
    except RigidsymError:
        if path.resolve().is_relative_to(reader.folder.resolve()):
            raise
        reader.table.fault(f"expected a file with a body, got {_kind(path)}", key)
        return None


def _kind(path: Path) -> str:
    """A file by its kind and size."""
    try:
        status = path.stat()
    except OSError as error:
        return f"{error.strerror}"
    if not stat.S_ISREG(status.st_mode):
        return "a folder" if stat.S_ISDIR(status.st_mode) else "a device"
    return f"a file of {status.st_size} bytes"


def read_known(reader: BodyReader) -> Known | None:
    """inertia = [[...], [...], [...]] about the centre of mass, with mass and centre."""
    table = reader.table
    value = table.value("inertia")
    rows = value if isinstance(value, list) else []
    if [len(row) if isinstance(row, list) else 0 for row in rows] != [3, 3, 3]:
        table.mistyped(value, 'three rows of three expressions, or "general"', "inertia")
        return None
    read = [
        reader.entries(row, _SLOTS[3 * k : 3 * k + 3], "inertia", k) for k, row in enumerate(rows)
    ]
    entries = [entry for row in read if row is not None for entry in row]
    centre: list[sp.Expr] | None = [sp.S.Zero] * 3
    if table.value("centre") is not None:
        centre = reader.row("centre", _CENTRE, "three coordinates")
    mass: sp.Expr | None = sp.Symbol("M" + reader.suffix)
    if table.value("mass") is not None:
        mass = reader.single("mass", "M", positive=True)
    if len(entries) != 9 or centre is None or mass is None:
        return None
    for place, entry in enumerate(entries):
        reader.declared.note(entry, *(_MOMENT if place in (0, 4, 8) else _PRODUCT))
    for entry in centre:
        reader.declared.note(entry, *_COORDINATE)
    reader.declared.note(mass, "mass", "kg")
    return Known(
        mass=mass, centre=sp.ImmutableMatrix(centre), inertia=sp.ImmutableMatrix(3, 3, entries)
    )


def _known(reader: BodyReader, found: MassProperties) -> Known | None:
    """The numbers of a file, read as if the table itself held them.

    The record keeps the numbers instead of the file, so that it can be checked without the file.
    """
    numbers = _cleaned(found.mass, found.centre.tolist(), found.inertia.tolist())
    table = reader.table.instead(numbers)
    reader.declared.files[table.path] = numbers
    return read_known(BodyReader(table, reader.declared, reader.folder, reader.suffix))


def _cleaned(mass: float, centre: list[float], inertia: list[list[float]]) -> dict[str, object]:
    """The values of [body]; rounding errors in place of zeros are removed."""
    scale = max(abs(entry) for row in inertia for entry in row)
    size = max(map(abs, centre)) + (scale / mass) ** 0.5
    return {
        "inertia": [[_clean(entry, scale) for entry in row] for row in inertia],
        "mass": mass,
        "centre": [_clean(value, size) for value in centre],
    }


def _clean(value: float, scale: float) -> float | int:
    return 0 if abs(value) <= scale * _ROUNDING else value
