"""Which convention does each package follow? `identify` names it, from what the package returns.

Every function is called with three angles, or with a quaternion, and returns a matrix or a
quaternion. Nothing is typed by hand: a package that is not installed leaves its row empty.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from benchmarks.measure import Settings
from benchmarks.report import Cell, Column, Report, Table
from rigidsym.tools.identify.identification import identify

A, B, C = 0.3, 0.9, -1.4  # angles, in radians, that no symmetry confuses


@dataclass(frozen=True, slots=True)
class Call:
    """One function of a package that turns three angles into a rotation."""

    package: str  # as it is installed
    module: str
    text: str
    call: Callable[[Any], Any]  # of the module
    is_quaternion: bool = False


CALLS = (
    Call(
        "scipy",
        "scipy.spatial.transform",
        'Rotation.from_euler("xyz", [a, b, c]).as_matrix()',
        lambda m: m.Rotation.from_euler("xyz", [A, B, C]).as_matrix(),
    ),
    Call(
        "scipy",
        "scipy.spatial.transform",
        'Rotation.from_euler("ZXZ", [a, b, c]).as_matrix()',
        lambda m: m.Rotation.from_euler("ZXZ", [A, B, C]).as_matrix(),
    ),
    Call(
        "scipy",
        "scipy.spatial.transform",
        'Rotation.from_euler("xyz", [a, b, c]).as_quat()',
        lambda m: m.Rotation.from_euler("xyz", [A, B, C]).as_quat(),
        is_quaternion=True,
    ),
    Call(
        "sympy",
        "sympy",
        'Quaternion.from_euler([a, b, c], "xyz")',
        lambda m: _floats(m.Quaternion.from_euler([A, B, C], "xyz").args[:4]),
        is_quaternion=True,
    ),
    Call(
        "sympy",
        "sympy.physics.vector",
        'N.orientnew("B", "Body", (a, b, c), "XYZ"); N.dcm(B)',
        lambda m: _matrix(m, "N"),
    ),
    Call(
        "sympy",
        "sympy.physics.vector",
        'N.orientnew("B", "Body", (a, b, c), "XYZ"); B.dcm(N)',
        lambda m: _matrix(m, "B"),
    ),
    Call(
        "transforms3d",
        "transforms3d.euler",
        'euler2mat(a, b, c, "sxyz")',
        lambda m: m.euler2mat(A, B, C, "sxyz"),
    ),
    Call(
        "transforms3d",
        "transforms3d.euler",
        'euler2quat(a, b, c, "rzxz")',
        lambda m: m.euler2quat(A, B, C, "rzxz"),
        is_quaternion=True,
    ),
    Call(
        "pytransform3d",
        "pytransform3d.rotations",
        "matrix_from_euler([a, b, c], 0, 1, 2, extrinsic=True)",
        lambda m: m.matrix_from_euler([A, B, C], 0, 1, 2, True),
    ),
    Call(
        "pytransform3d",
        "pytransform3d.rotations",
        "matrix_from_euler([a, b, c], 2, 0, 2, extrinsic=False)",
        lambda m: m.matrix_from_euler([A, B, C], 2, 0, 2, False),
    ),
    Call(
        "spatialmath-python",
        "spatialmath.base",
        "rpy2r(a, b, c)",
        lambda m: m.rpy2r(A, B, C),
    ),
    Call(
        "spatialmath-python",
        "spatialmath.base",
        'rpy2r(a, b, c, order="xyz")',
        lambda m: m.rpy2r(A, B, C, order="xyz"),
    ),
    Call(
        "spatialmath-python",
        "spatialmath.base",
        "eul2r(a, b, c)",
        lambda m: m.eul2r(A, B, C),
    ),
    Call(
        "trimesh",
        "trimesh.transformations",
        "euler_matrix(a, b, c)",
        lambda m: m.euler_matrix(A, B, C)[:3, :3],
    ),
    Call(
        "trimesh",
        "trimesh.transformations",
        'quaternion_from_euler(a, b, c, "rzyx")',
        lambda m: m.quaternion_from_euler(A, B, C, "rzyx"),
        is_quaternion=True,
    ),
    Call(
        "numpy-quaternion",
        "quaternion",
        "from_euler_angles(a, b, c)",
        lambda m: m.as_float_array(m.from_euler_angles(A, B, C)),
        is_quaternion=True,
    ),
    Call(
        "jaxlie",
        "jaxlie",
        "SO3.from_rpy_radians(a, b, c).as_matrix()",
        lambda m: m.SO3.from_rpy_radians(A, B, C).as_matrix(),
    ),
    Call(
        "ahrs",
        "ahrs",
        "Quaternion(rpy=[a, b, c])",
        lambda m: m.Quaternion(rpy=np.array([A, B, C])),
        is_quaternion=True,
    ),
)


def _floats(values: Any) -> list[float]:
    return [float(value) for value in values]


def _matrix(module: Any, name: str) -> Any:
    frames = {"N": module.ReferenceFrame("N")}
    frames["B"] = frames["N"].orientnew("B", "Body", (A, B, C), "XYZ")
    (other,) = frames.keys() - {name}
    return np.array(frames[name].dcm(frames[other]).tolist(), float)


def row(call: Call) -> tuple[Cell, ...]:
    """Package, call, and the plainest reading with its product; empty cells without the package."""
    try:
        shown = f"{call.package} {version(call.package)}"
        module = import_module(call.module)
    except (PackageNotFoundError, ImportError):
        return call.package, f"`{call.text}`", "", ""
    given = {"quaternion" if call.is_quaternion else "matrix": np.asarray(call.call(module), float)}
    found = identify([A, B, C], names=("a", "b", "c"), tolerance=1e-5, **given)
    if not found.fits:
        return shown, f"`{call.text}`", "no convention fits", ""
    reading = found.record()["answers"][0]["reading"]
    return shown, f"`{call.text}`", reading["words"], reading["product"]


def run(_: Settings) -> Report:
    columns = tuple(map(Column, ("package", "call", "convention", "rotation")))
    table = Table("Conventions of other packages", columns, tuple(map(row, CALLS)))
    return Report("Rosetta", (table,), (), documented=table)
