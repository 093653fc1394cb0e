"""Generated modules of every target, what to feed them, and their errors at 50 digits."""

from __future__ import annotations

import itertools
import os
import shutil
from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import rigidsym as rs
from helpers.motions import derived
from helpers.node import load
from helpers.witness import evaluate, mp
from rigidsym.kernels.targets import TARGETS

FEW = (  # with and without a divisor
    "rotation_matrix",
    "angular_velocity_space",
    "angular_velocity_body",
    "rates_from_angular_velocity_body",
)
INVERSES = [
    f"{name}_{frame}"
    for name in ("inverse_rate_matrix", "rates_from_angular_velocity")
    for frame in ("space", "body")
]
ROTATIONS = {  # and some quantities of each
    "ZXZ": (),  # all
    "rotation_vector": ("rotation_matrix", "angular_acceleration_body", "inverse_rate_matrix_body"),
    "quaternion": ("angular_velocity_space", "rates_from_angular_velocity_body"),
    "z(phi) [1,2,2](theta) x(psi0)": ("rotation_matrix", "angular_velocity_body"),
}
EPS = {np.float64: 2.0**-52, np.float32: 2.0**-23}
MISSING = {name: target.missing for name, target in TARGETS.items()}
MISSING["javascript"] = "" if shutil.which("node") else "node"


def required(programs: str) -> bool:
    """Whether tests fail, rather than skip, without these."""
    return os.environ.get(f"RIGIDSYM_REQUIRE_{programs}") == "1"


def loading(target: str) -> pytest.MarkDecorator:
    """A test that loads kernels of this target is skipped without what loading needs."""
    missing = MISSING[target]
    skipped = missing and not required("NODE" if target == "javascript" else "COMPILERS")
    return pytest.mark.skipif(bool(skipped), reason=f"{target}: {missing} is not installed")


EVERY = [pytest.param(name, marks=loading(name)) for name in TARGETS]
OTHERS = EVERY[1:]  # all but NumPy
_COMPILED = {"c", "numba", "jax"}  # in a second or so for each function


@cache
def motion(rotation: str) -> rs.Motion:
    if rotation == "ZXZ":
        return derived("ZXZ")
    return rs.derive(rotation, only=ROTATIONS.get(rotation, FEW[:1]))


@cache
def module(rotation: str = "ZXZ", target: str = "numpy") -> ModuleType:
    return load(motion(rotation).kernels(target))


def names(rotation: str, target: str = "numpy") -> list[str]:
    every = [step.quantity.name for step in motion(rotation).steps]
    return [name for name in every if target not in _COMPILED or name in FEW or rotation != "ZXZ"]


def inputs(rotation: str, name: str, leading=(7,), dtype=np.float64, seed: int = 1):
    random = np.random.default_rng(seed)
    sizes = [len(motion(rotation).argument(n).names) for n in _inputs(rotation, name)]
    return [random.uniform(-3, 3, (*leading, size)).astype(dtype) for size in sizes]


def _inputs(rotation: str, name: str) -> tuple[str, ...]:
    return ("q",) if name == "singularity_margin" else motion(rotation).step(name).quantity.inputs


def exact(motion: rs.Motion, name: str, arrays) -> list[list[Any]]:
    """The expression at 50 digits, entry by entry, orientation by orientation."""
    step = motion.step(name)
    symbols = [s for n in step.quantity.inputs for s in motion.argument(n).symbols]
    spelled = motion.spelled(step.expression)
    points = zip(*(array.tolist() for array in arrays), strict=True)
    values = (map(mp.mpf, itertools.chain(*point)) for point in points)
    return [list(evaluate(spelled, dict(zip(symbols, v, strict=True)))) for v in values]


def worst_error(found: np.ndarray, truth: list[Any], scales: np.ndarray | None = None) -> float:
    """The largest error in eps of the largest entry of its orientation, or of a given scale."""
    worst = 0.0
    for k, (row, values) in enumerate(
        zip(found.reshape(len(truth), -1).tolist(), truth, strict=True)
    ):
        size = max(map(abs, values)) if scales is None else mp.mpf(float(scales[k]))
        off = max(abs(mp.mpf(a) - b) for a, b in zip(row, values, strict=True))
        worst = max(worst, float(off / size) if size else float(off))
    return worst / EPS[found.dtype.type]


def rows_of(rotation: str, target: str, name: str, arrays) -> np.ndarray:
    return row_by_row(target, getattr(module(rotation, target), name))(*arrays)


def row_by_row(target: str, function: Callable[..., Any]) -> Callable[..., np.ndarray]:
    """The function on arrays with one point a row; its result as one row a point."""
    compute = _jitted(function) if target == "jax" else function

    def call(*arrays: np.ndarray) -> np.ndarray:
        return np.asarray(compute(*arrays)).reshape(len(arrays[0]), -1)

    return call


def _jitted(function: Callable[..., Any]) -> Callable[..., Any]:
    """As jax.jit compiles it, in the precision of the arrays."""
    import jax

    def call(*arrays: np.ndarray) -> Any:
        before = jax.config.jax_enable_x64
        jax.config.update("jax_enable_x64", True)
        try:
            return jax.tree.map(np.asarray, jax.jit(function)(*arrays))
        finally:
            jax.config.update("jax_enable_x64", before)

    return call
