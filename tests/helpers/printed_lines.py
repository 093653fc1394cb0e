"""What printers write for rotations that need all of it.

The golden files hold one line for each file: how many lines it has, and a digest. The files of the
lecture, tests/golden/kernels, show what changed; tests of values show what is right.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from hashlib import sha256
from typing import Any

import sympy as sp

import rigidsym as rs
from rigidsym.models.library import rotation_from

A, C = sp.symbols("A C", positive=True)
TOP = {"body": rs.principal_moments(A, A, C), "potential": "m*g*l*cos(theta)"}
BOTH = "rotation_matrix", "angular_velocity_body"
RATES = "rotation_matrix", "rates_from_angular_velocity_body"
JACOBIANS = ("rotation_matrix by q", "angular_velocity_body by q_dot")
ROTATIONS: dict[str, tuple[str, tuple[str, ...], dict[str, Any]]] = {  # what acts on them
    "turn": ("z(a)", BOTH, {}),
    "turns": ("y(a) x(b)", BOTH, {}),
    "series": ("rotation_vector", ("rotation_matrix", "inverse_rate_matrix_body"), {}),
    "long": ("x(a) y(b) z(c) x(d) y(e)", ("angular_acceleration_body",), {}),
    "matrix": ("direction_cosines", ("angular_velocity_body",), {}),
    "top": ("ZXZ", ("energy", "accelerations"), TOP),
    "quaternion": ("quaternion", RATES, {}),
    "axis": ("axis_angle", ("rotation_matrix",), {}),
    "constants": ("z(phi) x(alpha0) y(psi)", BOTH, {}),
    "names": ("z(the_first_of_all_angles) x(the_second_of_all_angles)", BOTH, {}),
}
PRINTED: dict[str, list[dict[str, Any]]] = {
    **{name: [{}] for name in ROTATIONS},
    "turn": [{}, {"conversions": True}],
    "turns": [{"derivatives": JACOBIANS}, {"conversions": True}],
    "quaternion": [{}, {"conversions": True}],
    "axis": [{"conversions": True}],
    "constants": [{"conversions": True}],
    "series": [{}, {"conversions": True, "derivatives": ("rotation_matrix by q",)}],
}
_PROSE = re.compile(r'""".*?"""|/\*.*?\*/', re.DOTALL)
LEAN = {"lean": "double"}
OF_C: dict[str, list[dict[str, Any]]] = {
    "turn": [LEAN | {"conversions": True}],
    "series": [LEAN, {"lean": "float"}],
    **{name: [LEAN] for name in ("quaternion", "long", "matrix", "top")},
}


@cache
def motion(name: str) -> rs.Motion:
    text, only, acting = ROTATIONS[name]
    return rs.derive(rotation_from(text), only=only, **acting)


def of_rotations(target: str) -> Iterator[str]:
    """What is printed of each rotation without docstrings and comments, a line for each file."""
    for name, ways in PRINTED.items():
        for way in (*ways, *(OF_C.get(name, ()) if target == "c" else ())):
            for file, text in motion(name).kernels(target, **way).files.items():
                lines = _PROSE.sub("", text).splitlines()
                digest = sha256("\n".join(lines).encode()).hexdigest()[:16]
                yield f"{file} {' '.join(way)}: {len(lines)} {digest}"
