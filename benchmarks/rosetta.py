"""Which convention does each package follow? `identify` names it, from what a call returns.

Each call is Python or JavaScript text that is evaluated as it stands in the table. It gets three
angles a, b, c, or a quaternion q, a rotation vector v, an axis e and an angle t, and returns a
matrix or a quaternion. A package that is not installed leaves its row empty.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from shutil import which
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rigidsym as rs
from benchmarks.measure import Settings
from benchmarks.report import Cell, Column, Report, Table
from rigidsym.tools.identify.identification import identify

ANGLES = np.array([[0.3, 0.9, -1.4], [-0.7, 0.4, 1.1], [1.2, -0.5, 0.8]])  # radians
MODULES = Path(os.environ.get("ROSETTA_NODE", "build/node"))  # npm install --prefix build/node ...
_TOLERANCE = 1e-5  # radians: some packages compute with float32
_ORDERS = {"first": [0, 1, 2, 3], "last": [1, 2, 3, 0]}  # of (w, x, y, z)
_NODE = """
const rows = (e, n) => [0, 1, 2].map(i => [0, 1, 2].map(j => e[n * j + i]));
const found = JSON.parse(process.argv[1]).map(({a, b, c, q, v, e, t}) => (%s));
console.log(JSON.stringify(found.map(value => Array.from(value))));
"""


@dataclass(frozen=True, slots=True)
class Call:
    """One function of a package that makes a rotation of angles, a quaternion or a vector."""

    package: str  # as it is installed
    setup: str  # what to import
    text: str  # the call, an expression

    @property
    def takes(self) -> str:
        """ "a" for angles, "q" for a quaternion, "v" for a vector, or an axis and an angle."""
        words = set(re.findall(r"\b[a-z]\w*", self.text))
        return "q" if "q" in words else "v" if words & {"v", "e", "t"} else "a"

    @property
    def is_javascript(self) -> bool:
        return "from '" in self.setup

    def shown_version(self) -> str:
        """The installed version; raises PackageNotFoundError."""
        if not self.is_javascript:
            return version(self.package)
        path = MODULES / "node_modules" / self.package / "package.json"
        if not path.is_file() or which("node") is None:
            raise PackageNotFoundError(self.package)
        return str(json.loads(path.read_text(encoding="utf-8"))["version"])

    def results(self, inputs: list[dict[str, Any]]) -> NDArray[np.float64]:
        """Matrices (n, 3, 3) or quaternions (n, 4)."""
        if self.is_javascript:
            program = f"{self.setup};{_NODE % self.text}"
            command = ["node", "--input-type=module", "-e", program, json.dumps(inputs)]
            done = subprocess.run(command, cwd=MODULES, capture_output=True, text=True, check=True)
            found = json.loads(done.stdout)
        else:
            names: dict[str, Any] = {"np": np}
            exec(self.setup, names)
            found = [_plain(eval(self.text, names | given)) for given in inputs]
        results = np.array(found, float)
        shape = (-1, 4) if results.size == 4 * len(inputs) else (-1, 3, 3)
        return results.reshape(shape)


_FRAMES = """
from sympy.physics.vector import ReferenceFrame
N = ReferenceFrame("N")
body = lambda a, b, c: N.orientnew("B", "Body", (a, b, c), "XYZ")
"""
_TEXTS = {  # of calls, by package and what to import
    ("scipy", "from scipy.spatial.transform import Rotation"): (
        'Rotation.from_euler("xyz", [a, b, c]).as_matrix()',
        'Rotation.from_euler("ZXZ", [a, b, c]).as_matrix()',
        'Rotation.from_euler("xyz", [a, b, c]).as_quat()',
        "Rotation.from_quat(q).as_matrix()",
        "Rotation.from_rotvec(v).as_matrix()",
    ),
    ("sympy", "from sympy import *"): (
        'Quaternion.from_euler([a, b, c], "xyz").args[:4]',
        "rot_axis3(c) * rot_axis2(b) * rot_axis1(a)",
        "rot_ccw_axis3(c) * rot_ccw_axis2(b) * rot_ccw_axis1(a)",
        "Quaternion(*q).to_rotation_matrix()",
    ),
    ("sympy", _FRAMES): (
        "N.dcm(body(a, b, c))",
        "body(a, b, c).dcm(N)",
    ),
    ("transforms3d", "from transforms3d.euler import *"): (
        'euler2mat(a, b, c, "sxyz")',
        'euler2quat(a, b, c, "rzxz")',
    ),
    ("transforms3d", "from transforms3d.quaternions import *"): ("quat2mat(q)",),
    ("transforms3d", "from transforms3d.axangles import *"): ("axangle2mat(e, t)",),
    ("pytransform3d", "from pytransform3d.rotations import *"): (
        "matrix_from_euler([a, b, c], 0, 1, 2, extrinsic=True)",
        "matrix_from_euler([a, b, c], 2, 0, 2, extrinsic=False)",
        "matrix_from_quaternion(q)",
        "matrix_from_compact_axis_angle(v)",
    ),
    ("spatialmath-python", "from spatialmath.base import *"): (
        "rpy2r(a, b, c)",
        'rpy2r(a, b, c, order="xyz")',
        "eul2r(a, b, c)",
        "q2r(q)",
        "angvec2r(t, e)",
    ),
    ("trimesh", "from trimesh.transformations import *"): (
        "euler_matrix(a, b, c)[:3, :3]",
        'quaternion_from_euler(a, b, c, "rzyx")',
        "quaternion_matrix(q)[:3, :3]",
        "rotation_matrix(t, e)[:3, :3]",
    ),
    ("transformations", "from transformations import *"): (
        "quaternion_matrix(quaternion_from_euler(a, b, c))[:3, :3]",
    ),
    ("numpy-quaternion", "import quaternion"): (
        "quaternion.as_float_array(quaternion.from_euler_angles(a, b, c))",
        "quaternion.as_rotation_matrix(quaternion.quaternion(*q))",
        "quaternion.as_rotation_matrix(quaternion.from_rotation_vector(v))",
    ),
    ("quaternionic", "import quaternionic"): (
        "quaternionic.array.from_euler_angles(a, b, c).ndarray",
        "quaternionic.array(q).to_rotation_matrix",
    ),
    ("pyquaternion", "from pyquaternion import Quaternion"): (
        "Quaternion(q).rotation_matrix",
        "Quaternion(axis=e, angle=t).rotation_matrix",
    ),
    ("rowan", "import rowan"): (
        'rowan.from_euler(a, b, c, convention="zyx", axis_type="intrinsic")',
        "rowan.to_matrix(np.array(q))",
    ),
    ("pyrr", "import pyrr"): (
        "pyrr.matrix33.create_from_eulers([a, b, c])",
        "pyrr.matrix33.create_from_quaternion(np.array(q))",
    ),
    ("navpy", "import navpy"): (
        "navpy.angle2dcm(a, b, c)",
        "np.hstack(navpy.angle2quat(a, b, c))",
    ),
    ("PyGLM", "from pyglm import glm"): (
        "np.array(glm.mat3_cast(glm.quat(glm.vec3(a, b, c))))",
        "np.array(glm.mat3_cast(glm.quat(*q)))",
    ),
    ("jaxlie", "import jaxlie"): (
        "jaxlie.SO3.from_rpy_radians(a, b, c).as_matrix()",
        "jaxlie.SO3(np.array(q)).as_matrix()",
        "jaxlie.SO3.exp(np.array(v)).as_matrix()",
    ),
    ("gtsam", "import gtsam"): (
        "gtsam.Rot3.RzRyRx(a, b, c).matrix()",
        "gtsam.Rot3.Ypr(a, b, c).matrix()",
        "gtsam.Rot3(*q).matrix()",
        "gtsam.Rot3.Expmap(np.array(v)).matrix()",
    ),
    ("ahrs", "import ahrs"): (
        "ahrs.Quaternion(rpy=np.array([a, b, c]))",
        "ahrs.DCM(rpy=[a, b, c])",
        "ahrs.DCM(q=np.array(q))",
    ),
    ("astropy", "from astropy.coordinates.matrix_utilities import rotation_matrix"): (
        "rotation_matrix(np.degrees(t), e)",
    ),
    ("astropy", "from astropy.modeling.rotations import RotationSequence3D"): (
        'np.array(RotationSequence3D(np.degrees([a, b, c]), "xyz")(*np.eye(3)))',
    ),
    ("three", "import * as T from 'three'"): (
        "rows(new T.Matrix4().makeRotationFromEuler(new T.Euler(a, b, c)).elements, 4)",
        "new T.Quaternion().setFromEuler(new T.Euler(a, b, c, 'ZYX'))",
        "rows(new T.Matrix4().makeRotationFromQuaternion(new T.Quaternion(...q)).elements, 4)",
        "rows(new T.Matrix4().makeRotationAxis(new T.Vector3(...e), t).elements, 4)",
    ),
    ("gl-matrix", "import {mat3, quat} from 'gl-matrix'"): (
        "quat.fromEuler(quat.create(), ...[a, b, c].map(x => x * 180 / Math.PI))",
        "rows(mat3.fromQuat(mat3.create(), q), 3)",
    ),
    ("cannon-es", "import {Quaternion} from 'cannon-es'"): (
        "new Quaternion().setFromEuler(a, b, c).toArray()",
    ),
}
CALLS = [Call(*imports, text) for imports, texts in _TEXTS.items() for text in texts]


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else [float(entry) for entry in value]


def inputs(order: str) -> list[dict[str, Any]]:
    """Angles, and the quaternion and vector of the rotation that SciPy calls xyz."""
    kernels = rs.kernels("xyz", conversions=True)
    found = []
    for angles in ANGLES:
        q = kernels.quaternion(angles)
        axis = q[1:] / np.linalg.norm(q[1:])
        angle = 2 * np.arctan2(np.linalg.norm(q[1:]), q[0])
        a, b, c = angles.tolist()
        given = {"a": a, "b": b, "c": c, "q": q[_ORDERS[order]].tolist(), "t": float(angle)}
        found.append(given | {"e": axis.tolist(), "v": (angle * axis).tolist()})
    return found


def row(call: Call) -> tuple[Cell, ...]:
    """Package, call, convention, rotation and how ours is converted into theirs."""
    shown = f"`{call.text}`"
    try:
        package = f"{call.package} {call.shown_version()}"
        tried = {order: call.results(inputs(order)) for order in _ORDERS}
    except (PackageNotFoundError, ImportError):
        return call.package, shown, "", "", "", ""
    for order, results in tried.items():
        given = {"matrix" if results.ndim == 3 else "quaternion": results}
        found = identify(ANGLES, names=("a", "b", "c"), tolerance=_TOLERANCE, **given)
        if not found.fits:
            continue
        readings = [answer["reading"] for answer in found.record()["answers"]]
        plain = next((r for r in readings if r["sequence"] == "xyz"), readings[0])
        if call.takes == "a":
            return package, shown, plain["words"], plain["product"], *conversion(plain, results)
        if plain["sequence"] == "xyz":
            manner = "passive" if plain["passive"] else "active"
            what = f"quaternion, scalar {order}" if call.takes == "q" else "vector"
            ours = "unit_quaternion" if call.takes == "q" else "rotation_vector"
            product = "R(q)" if call.takes == "q" else "exp C(v)"
            shown_product = f"({product})ᵀ" if plain["passive"] else product
            theirs = f'rs.kernels("{ours}")', "Rᵀ" if plain["passive"] else "R"
            return package, shown, f"{what}, {manner}", shown_product, *theirs
    return package, shown, "no convention fits", "", "", ""


def conversion(reading: dict[str, Any], theirs: NDArray[np.float64]) -> tuple[str, str]:
    """Our model, and the expression that turns our result into theirs, checked on the samples.

    Raises ArithmeticError if it does not.
    """
    columns, signs = reading["columns"], reading["signs"]
    kernels = rs.kernels(reading["sequence"], conversions=True)
    angles = ANGLES[:, columns] * signs
    names = [("−" if s < 0 else "") + "abc"[k] for k, s in zip(columns, signs, strict=True)]
    if theirs.ndim == 3:
        ours, text = kernels.rotation_matrix(angles), "R"
        if reading["passive"]:
            ours, text = ours.swapaxes(1, 2), "Rᵀ"
    else:
        ours, text = kernels.quaternion(angles), "q"
        if reading["passive"]:
            ours, text = ours * [1, -1, -1, -1], "q*"
        if reading["scalar_last"]:
            ours, text = ours[:, _ORDERS["last"]], f"{text}[..., [1, 2, 3, 0]]"
        theirs = theirs * np.sign(np.sum(ours * theirs, axis=1))[:, None]
    if not np.allclose(ours, theirs, atol=_TOLERANCE):
        raise ArithmeticError(f"{reading['words']}: the conversion does not hold")
    return f'rs.kernels("{reading["sequence"]}"), q = ({", ".join(names)})', text


def run(_: Settings) -> Report:
    heads = ("package", "call", "convention", "rotation", "ours", "theirs")
    table = Table("Conventions of other packages", tuple(map(Column, heads)), (*map(row, CALLS),))
    return Report("Rosetta", (table,), (), documented=table)
