"""A closed triangle mesh as a solid of uniform density: STL, OBJ, PLY, OFF, GLB.

Sums over signed tetrahedra between a point inside and each triangle, after D. Eberly, Polyhedral
Mass Properties (2002), whose integrals are those over the unit simplex.
"""

from __future__ import annotations

import logging
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from warnings import catch_warnings

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.mass.blocks import inertia_from
from rigidsym.data.mass.properties import MassProperties
from rigidsym.errors import BodyError, MissingExtra

Array = NDArray[np.float64]
ENDINGS = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf")
_FAILURES = (  # of trimesh, whose readers trust the counts and types in a file
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    MemoryError,
    NameError,
    OSError,
    RuntimeError,
    StopIteration,
    TypeError,
    ValueError,
    struct.error,
)
_RELATIVE = re.compile(rb"^f\b(?:[^#\n]*\s)?(-\d+|0)(?=[/\s]|$)", re.MULTILINE)  # of a face of OBJ
MOST_DRAWN, _MOST_CELLS = 400, 24
_SIMPLEX = 1 / 6, 1 / 24, 1 / 120  # ∫ 1, ∫ u, ∫ u v over the unit simplex; ∫ u² is twice the last


@dataclass(frozen=True, kw_only=True, slots=True)
class Mesh:
    """Vertices (n, 3), in m, and triangles (k, 3) of their numbers."""

    vertices: Array
    faces: NDArray[np.int64]


def read_mesh_file(path: Path, *, scale: float = 1.0) -> Mesh:
    """A mesh from a file; lengths in it times `scale` are metres.

    Raises MissingExtra without trimesh, BodyError for a file that holds no mesh of finite numbers.
    """
    try:
        import trimesh
    except ImportError:
        raise MissingExtra("reading meshes", "mesh") from None
    log = logging.getLogger("trimesh")
    if not log.handlers:
        log.addHandler(logging.NullHandler())  # else Python prints tracebacks that trimesh logs
    if not path.is_file():
        raise BodyError(f"{path}: no such mesh")
    if path.suffix.lower() not in ENDINGS:
        raise BodyError(f"{path}: expected a mesh, a file that ends in {', '.join(ENDINGS)}")
    if path.suffix.lower() == ".obj":
        _check_relative(path)
    try:
        with np.errstate(all="ignore"), catch_warnings(action="ignore"):
            loaded = trimesh.load(path, force="mesh", process=False, skip_materials=True)
            _check_corners(path, np.asarray(loaded.faces), len(loaded.vertices))
            loaded.process()
            loaded.merge_vertices(merge_tex=True, merge_norm=True)
            vertices = np.asarray(loaded.vertices, dtype=float).reshape(-1, 3) * scale
            faces = np.asarray(loaded.faces, dtype=np.int64).reshape(-1, 3)
    except ImportError as error:
        raise MissingExtra(f"reading {path.name} ({error})", "mesh") from None
    except _FAILURES:
        kind, size = path.suffix[1:].upper(), path.stat().st_size
        raise BodyError(f"{path}: its {size} bytes cannot be read as a mesh in {kind}") from None
    if not len(faces):
        raise BodyError(f"{path}: expected a mesh with triangles, found none")
    if not np.isfinite(vertices).all():
        wrong = int(np.argmin(np.isfinite(vertices).all(axis=1)))
        raise BodyError(f"{path}: vertex {wrong} is not finite: {vertices[wrong].tolist()}")
    return Mesh(vertices=vertices, faces=faces)


def _check_corners(path: Path, faces: NDArray[np.int64], count: int) -> None:
    """Raises BodyError for the first triangle with a corner that is none of the vertices.

    NumPy counts negative numbers from the end.
    """
    for triangle, corner in np.argwhere((faces < 0) | (faces >= count))[:1]:
        raise BodyError(
            f"{path}: triangle {triangle + 1} has the corner {faces[triangle, corner]}; expected "
            f"0 to {count - 1}, since the file has {count} vertices"
        )


def _check_relative(path: Path) -> None:
    """Raises BodyError for a corner 0 of an OBJ file, and one that trimesh would misread.

    Negative numbers count from the last vertex before the face; trimesh counts from the last one.
    """
    if not _RELATIVE.search(content := path.read_bytes()):
        return
    lines = content.split(b"\n")
    last = max((k for k, line in enumerate(lines) if line.startswith(b"v ")), default=0)
    for k, line in enumerate(lines):
        if (found := _RELATIVE.match(line)) and (found[1] == b"0" or k < last):
            what = "corners from 1 on" if found[1] == b"0" else "all vertices before this face"
            raise BodyError(
                f"{path}: line {k + 1}: the corner {found[1].decode()}; expected {what}"
            )


def mesh_inertia(
    mesh: Mesh, *, mass: float | None = None, density: float | None = None, allow: bool = False
) -> MassProperties:
    """Mass, centre, inertia tensor and principal axes of a uniform solid bounded by a mesh.

    `mass` in kg or `density` in kg/m³. Raises BodyError for a surface that is open, whose faces
    are not oriented alike, or that is inside out; `allow` accepts the first two.
    """
    if (mass is None) == (density is None):
        raise BodyError("mesh: expected either the mass or the density")
    for what, given, unit in (("mass", mass, "kg"), ("density", density, "kg/m³")):
        if given is not None and not (np.isfinite(given) and given > 0):
            raise BodyError(f"mesh: the {what} is {given:g} {unit}; expected a positive number")
    if not allow:
        check_closed(mesh)
    inside = mesh.vertices.mean(axis=0)
    triangles = (mesh.vertices - inside)[mesh.faces]
    with np.errstate(all="ignore"):  # numbers that are too large are looked for below
        six = np.linalg.det(triangles)
        volume = float(six.sum() * _SIMPLEX[0])
        if volume <= 0:
            raise BodyError(
                f"mesh: the surface is inside out: its volume is {volume:.6g} m³; flip its faces"
                if volume
                else "mesh: its volume is zero"
            )
        corners = triangles.sum(axis=1)
        first = (six[:, None] * corners).sum(axis=0) * _SIMPLEX[1]
        own = np.einsum("t,tpi,tpj->ij", six, triangles, triangles, optimize=True)
        both = np.einsum("t,ti,tj->ij", six, corners, corners, optimize=True)
        second = (own + both) * _SIMPLEX[2] - np.outer(first, first) / volume
        factor = np.float64(mass) / volume if density is None else density
        inertia = inertia_from((second + second.T) * (factor / 2))
    if not np.isfinite(inertia).all():
        raise BodyError("mesh: its moments are too large or too small for double precision")
    return MassProperties(
        count=len(mesh.faces),
        mass=float(volume * factor),
        centre=inside + first / volume,
        inertia=inertia,
    )


def outline_of(mesh: Mesh) -> dict[str, list[list[float]] | list[list[int]]]:
    """Corners, in m, and at most MOST_DRAWN faces that show what the mesh looks like.

    The vertices of a finer mesh are merged in cells of a grid (Rossignac and Borrel, 1993).
    """
    vertices, faces = mesh.vertices, mesh.faces
    low, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    cells = _MOST_CELLS
    while len(faces) > MOST_DRAWN:
        places = np.floor((mesh.vertices - low) * (cells / size))
        _, cell, count = np.unique(places, axis=0, return_inverse=True, return_counts=True)
        cell = cell.ravel()
        merged = cell[mesh.faces]
        merged = merged[(merged != np.roll(merged, 1, axis=1)).all(axis=1)]
        first = merged.argmin(axis=1)[:, None]  # each triangle from its least corner
        faces = np.unique(np.take_along_axis(merged, (first + np.arange(3)) % 3, axis=1), axis=0)
        sums = [np.bincount(cell, weights=column) for column in mesh.vertices.T]
        vertices = np.stack(sums, axis=1) / count[:, None]
        cells -= 1
    corners = [[float(f"{x:.4g}") for x in vertex] for vertex in vertices.tolist()]
    return {"corners": corners, "faces": faces.tolist()}


def check_closed(mesh: Mesh) -> None:
    """Raises BodyError, with an edge, unless every edge joins two faces of one orientation."""
    faces = mesh.faces
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = len(mesh.vertices)
    forward, backward = edges @ (count, 1), edges @ (1, count)
    found, times = np.unique(forward, return_counts=True)
    if times.max() > 1:
        edge = int(found[np.argmax(times)])
        raise BodyError(
            f"mesh: some faces are turned over: {int((times > 1).sum())} edges have the same "
            f"direction in both of their faces, such as {_edge(edge, mesh)}"
        )
    open_edges = np.setdiff1d(backward, found)
    if len(open_edges):
        raise BodyError(
            f"mesh: the surface is open: {len(open_edges)} edges have only one face, such as "
            f"{_edge(int(open_edges[0]), mesh)}"
        )


def _edge(code: int, mesh: Mesh) -> str:
    start, end = divmod(code, len(mesh.vertices))
    places = (", ".join(f"{x:.6g}" for x in mesh.vertices[k]) for k in (start, end))
    return " to ".join(f"({place})" for place in places)
