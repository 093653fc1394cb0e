"""Mass, centre, inertia tensor and principal axes of particles and uniform meshes."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any
from warnings import catch_warnings

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.data.columns import COLUMNS, ColumnNames, names_for
from rigidsym.data.tables import ArrayTable, Table, open_table
from rigidsym.errors import BodyError, DataError, MissingExtra

Array = NDArray[np.float64]
# A product of inertia is a sum of n terms m x y, each rounded by a few u = 1.1e-16 of its size, and
# Σ m |x y| is at most half of the largest moment, since 2 |x y| ≤ x² + y². One that vanishes is
# thus left at up to n u/2 of the largest moment if all roundings agree, and at about √n u/2 as they
# fall. 1e-14 = 90 u covers 180 terms at worst and 30,000 as a rule, and is finer than any datum.
_ROUNDING = 1e-14


@dataclass(frozen=True, kw_only=True, slots=True)
class PrincipalAxes:
    """Moments in ascending order, and their axes."""

    moments: Array  # (3,), kg m²
    axes: Array  # (3, 3), the columns are unit vectors, right-handed


def principal_axes_of(inertia: ArrayLike) -> PrincipalAxes:
    """The principal axes of an inertia tensor of numbers.

    Parameters
    ----------
    inertia : array_like, (3, 3)
        In kg m².

    Returns
    -------
    PrincipalAxes
        `moments` (3,) in ascending order, and `axes` (3, 3), whose columns are right-handed unit
        vectors; the largest component of each of the first two is positive.

    Raises
    ------
    BodyError
        For a matrix that is not 3x3, finite and symmetric.

    Examples
    --------
    >>> import rigidsym as rs
    >>> rs.principal_axes_of([[2.0, 1, 0], [1, 2, 0], [0, 0, 5]]).moments.round(12).tolist()
    [1.0, 3.0, 5.0]
    """
    matrix = np.asarray(inertia, dtype=float)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise BodyError(f"expected an inertia tensor of 3x3 finite numbers, got {matrix.tolist()}")
    skew = np.abs(matrix - matrix.T).max()
    if skew > 1e-12 * np.abs(matrix).max():
        raise BodyError(f"the inertia tensor is not symmetric: entries differ by {skew:g} kg m²")
    if not (matrix - np.diag(np.diag(matrix))).any():  # diagonal already
        order = np.argsort(np.diag(matrix), kind="stable")
        moments, axes = np.diag(matrix)[order], np.eye(3)[:, order]
    else:
        moments, axes = np.linalg.eigh((matrix + matrix.T) / 2)
        moments = _without_rounding(moments, np.abs(moments).max())
    for k in (0, 1):
        axes[:, k] *= np.sign(axes[np.argmax(np.abs(axes[:, k])), k])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return PrincipalAxes(moments=moments, axes=_without_rounding(axes, 1.0))


def _without_rounding(values: Array, size: float) -> Array:
    """The values, with 0 in place of rounding errors of numbers of this size."""
    return np.where(np.abs(values) > _ROUNDING * size, values, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class MassProperties:
    """Mass, centre, inertia tensor and principal axes of a body, in SI units."""

    count: int  # particles, or faces of a mesh
    mass: float  # kg
    centre: Array  # (3,), m
    inertia: Array  # (3, 3), about the centre of mass, kg m²
    principal: PrincipalAxes = field(init=False)

    def __post_init__(self) -> None:
        """What only rounding left of a zero is zero."""
        largest = np.abs(self.inertia).max()
        # the coordinates of the centre are compared with it and with the radius of gyration
        size = np.abs(self.centre).max() + np.sqrt(largest / abs(self.mass))
        inertia = _without_rounding(self.inertia, largest)
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "centre", _without_rounding(self.centre, size))
        object.__setattr__(self, "principal", principal_axes_of(inertia))

    @property
    def radii(self) -> Array:
        """Radii of gyration about the principal axes, (3,), m: √(Iₖ/M)."""
        return np.sqrt(np.maximum(self.principal.moments, 0) / self.mass)

    def __repr__(self) -> str:
        """A few lines for a terminal."""
        matrices: dict[str, Array] = {
            "mass M, kg": np.array([[self.mass]]),
            "centre of mass c, m": self.centre[None],
            "inertia tensor about the centre of mass, kg m²": self.inertia,
            "principal moments, kg m²": self.principal.moments[None],
            "principal axes as columns, right-handed": self.principal.axes,
            "radii of gyration, m": self.radii[None],
        }
        lines: list[str] = []
        for title, matrix in matrices.items():
            numbers = ("".join(f"{x + 0.0:20.12g}" for x in row) for row in matrix)  # −0 + 0 is 0
            lines += [title, *numbers]
        return "\n".join(lines)

    def as_table(self) -> dict[str, object]:
        """The values of [body] in a derivation file."""
        return {"inertia": self.inertia.tolist(), "mass": self.mass, "centre": self.centre.tolist()}

    def record(self) -> dict[str, Any]:
        """The properties as plain data."""
        return {
            **({"count": self.count} if self.count else {}),
            "mass": self.mass,
            "centre_of_mass": self.centre.tolist(),
            "inertia_tensor": self.inertia.tolist(),
            "principal_moments": self.principal.moments.tolist(),
            "principal_axes": self.principal.axes.tolist(),
            "radii_of_gyration": self.radii.tolist(),
        }


# Particles

_AXES = ("x", "y", "z")
_MASSES = ("m", "mass", "masses")


def inertia_of(
    particles: Any, *, columns: Sequence[str] | None = None, allow: bool = False
) -> MassProperties:
    """Mass, centre of mass, inertia tensor about it and principal axes of point masses.

    Parameters
    ----------
    particles : array_like, (n, 4) or (n, 3), data frame, mapping, or path
        m, x, y, z of each particle, or x, y, z with 1 kg each, in kg and m. Columns with names, as
        in a data frame or a file (NPY, CSV, Parquet), are found by these, and units in the names
        are converted.
    columns : sequence of str, optional
        Names of the columns in their order, such as ("x", "y", "z", "m").
    allow : bool, optional
        Accept negative masses.

    Returns
    -------
    MassProperties
        `mass`, `centre` (3,), `inertia` (3, 3) about the centre, and `principal` axes.

    Raises
    ------
    BodyError
        For NaN, a total mass that is not positive, negative masses, and missing columns.

    Examples
    --------
    >>> import rigidsym as rs
    >>> dumbbell = rs.inertia_of([[1.0, 0, 0, -1], [1.0, 0, 0, 1]])
    >>> dumbbell.mass, dumbbell.inertia.diagonal().tolist()
    (2.0, [2.0, 2.0, 0.0])
    """
    path = Path(particles) if isinstance(particles, str | Path) else None
    try:
        table = ArrayTable(particles) if path is None else open_table(path)
        used, factors = _columns(table, columns)
        return _properties(table.read(used).table * factors, table, allow=allow)
    except (BodyError, DataError) as error:
        if path is None or str(path) in str(error):
            raise BodyError(str(error)) from None
        raise BodyError(f"{path}: {error}") from None


def _properties(rows: Array, table: Table, *, allow: bool) -> MassProperties:
    """The body of particles x, y, z, m (n, 4), or x, y, z of 1 kg each (n, 3).

    Σ m x xᵀ is summed about the centre of mass, where differences of coordinates are nearly exact
    however far from the origin the body is; `rest` is what its rounding leaves of Σ m x.
    """
    if not len(rows):
        raise BodyError("expected at least one particle, got none")
    positions = rows[:, :3]
    masses = rows[:, 3] if rows.shape[1] == 4 else np.ones(len(rows))
    is_finite = np.isfinite(rows).all(axis=1)
    for wrong, expected in (
        (~is_finite, "finite numbers"),
        ((masses < 0) & (not allow), "a mass that is not negative"),
    ):
        if wrong.any():
            row = int(np.argmax(wrong))
            place = ", ".join(filter(None, (table.source, table.place(row))))
            at = ", ".join(f"{x:g}" for x in positions[row])
            raise BodyError(f"{place}: expected {expected}, got mass {masses[row]:g} at ({at})")
    with np.errstate(all="ignore"):  # what overflows is refused
        mass = float(masses.sum())
        if not 0 < mass < np.inf:
            raise BodyError(f"the total mass is {mass:g} kg; expected a positive mass")
        start = np.median(positions, axis=0)  # unlike the mean, no outlier moves it away
        about = start + masses @ (positions - start) / mass
        apart = positions - about
        rest = masses @ apart
        second = (apart.T * masses) @ apart - np.outer(rest, rest / mass)
    if not np.isfinite(second).all():
        raise BodyError("the moments are too large for double precision")
    # tr(J) 1 − J for J = Σ m x xᵀ, without adding numbers that cancel
    inertia = -(second + second.T) / 2
    for k in range(3):
        inertia[k, k] = second[(k + 1) % 3, (k + 1) % 3] + second[(k + 2) % 3, (k + 2) % 3]
    return MassProperties(count=len(rows), mass=mass, centre=about, inertia=inertia)


def _columns(table: Table, names: Sequence[str] | None) -> tuple[list[int], Array]:
    """The columns of x, y, z and perhaps the mass, and what converts them to m and kg.

    Raises BodyError if x, y or z is missing, if no column is the mass but one looks like it,
    and for units that are not of length and mass.
    """
    named = names_for(names, table.width, table.names)
    if named is None:
        if table.width not in (3, 4):
            raise BodyError(
                f"expected 3 columns (x, y, z) or 4 (m, x, y, z), got {table.width}; "
                f"{COLUMNS} names them"
            )
        named = ("m", *_AXES)[4 - table.width :]
    header = ColumnNames(named)
    axes, mass = [header.find([name]) for name in _AXES], header.find(_MASSES)
    columns = [column for column in (*axes, mass) if column is not None]
    if missing := [name for name, column in zip(_AXES, axes, strict=True) if column is None]:
        lacking = f"no column {', '.join(missing)} among {header.listed}"
        raise BodyError(f"{lacking}; {COLUMNS} names them in order")
    others = [name for k, name in enumerate(header.plain) if k not in columns]
    if mass is None and (near := get_close_matches("mass", others, n=1)):
        raise BodyError(f"no column m or mass among {header.listed}; is {near[0]} the mass?")
    units = ("m", "m", "m", "kg")[: len(columns)]
    factors = [header.factor(c, unit) or 1.0 for c, unit in zip(columns, units, strict=True)]
    return columns, np.array(factors)


# Meshes

ENDINGS = (".stl", ".obj", ".ply")


def read_mesh_file(path: Path, *, scale: float = 1.0) -> Any:
    """A `trimesh.Trimesh` from a file; lengths in it times `scale` are metres.

    Raises MissingExtra without trimesh, BodyError for a file that holds no mesh of finite numbers.
    """
    log = logging.getLogger("trimesh")
    if not log.handlers:
        log.addHandler(logging.NullHandler())  # else Python prints tracebacks that trimesh logs
    if not path.is_file():
        raise BodyError(f"{path}: no such mesh")
    if path.suffix.lower() not in ENDINGS:
        raise BodyError(f"{path}: expected a mesh, a file that ends in {', '.join(ENDINGS)}")
    try:
        import trimesh

        with np.errstate(all="ignore"), catch_warnings(action="ignore"):
            loaded = trimesh.load(path, force="mesh", process=False, skip_materials=True)
            corners, count = np.asarray(loaded.faces), len(loaded.vertices)
            if ((corners < 0) | (corners >= count)).any():  # NumPy counts -1 from the end
                raise BodyError(f"{path}: a triangle has a corner that is none of {count} vertices")
            loaded.process()
            loaded.merge_vertices(merge_tex=True, merge_norm=True)
            loaded.apply_scale(scale)
    except ImportError as error:
        raise MissingExtra(f"reading {path.name} ({error})", "mesh") from None
    # trimesh trusts the counts and types in a file, so that a damaged one fails anywhere.
    except (ValueError, TypeError, LookupError, ArithmeticError, RuntimeError) as error:
        kind, size = path.suffix[1:].upper(), path.stat().st_size
        raise BodyError(f"{path}: its {size} bytes cannot be read as a mesh in {kind}") from error
    if not len(loaded.faces):
        raise BodyError(f"{path}: expected a mesh with triangles, found none")
    is_finite = np.isfinite(loaded.vertices).all(axis=1)
    if not is_finite.all():
        wrong = int(np.argmin(is_finite))
        raise BodyError(f"{path}: vertex {wrong} is not finite: {loaded.vertices[wrong].tolist()}")
    return loaded


def mesh_inertia(
    mesh: Any, *, mass: float | None = None, density: float | None = None, allow: bool = False
) -> MassProperties:
    """Mass, centre, inertia tensor and principal axes of a uniform solid in a `trimesh.Trimesh`.

    `mass` in kg or `density` in kg/m³. Raises BodyError for a surface that is open, whose faces
    are not oriented alike, or that is inside out; `allow` accepts the first two.
    """
    from trimesh.triangles import mass_properties

    if (mass is None) == (density is None):
        raise BodyError("mesh: expected either the mass or the density")
    for what, value, unit in (("mass", mass, "kg"), ("density", density, "kg/m³")):
        if value is not None and not (np.isfinite(value) and value > 0):
            raise BodyError(f"mesh: the {what} is {value:g} {unit}; expected a positive number")
    if not (allow or mesh.is_watertight):
        raise BodyError("mesh: the surface is open: some edges do not join two faces")
    if not (allow or mesh.is_winding_consistent):
        raise BodyError("mesh: some faces are turned over: neighbours have opposite orientations")
    # Integrals of x² about the origin lose all digits of a body that is far from it.
    inside = mesh.vertices.mean(axis=0)
    triangles = (mesh.vertices - inside)[mesh.faces]
    with np.errstate(all="ignore"):  # numbers that are too large are looked for below
        solid = mass_properties(triangles, density=1.0)
        volume = float(solid.volume)
        if volume <= 0:
            raise BodyError(
                f"mesh: the surface is inside out: its volume is {volume:.6g} m³; flip its faces"
                if volume
                else "mesh: its volume is zero"
            )
        factor = np.float64(mass) / volume if density is None else density
        inertia = np.asarray(solid.inertia) * factor
    if not np.isfinite(inertia).all():
        raise BodyError("mesh: its moments are too large or too small for double precision")
    return MassProperties(
        count=len(mesh.faces),
        mass=float(volume * factor),
        centre=inside + np.asarray(solid.center_mass),
        inertia=(inertia + inertia.T) / 2,
    )
