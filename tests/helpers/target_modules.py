"""Modules of every target, what to feed them, and their errors at 50 digits."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import rigidsym as rs
from helpers.witness import evaluate, mp
from rigidsym.kernels.targets import TARGETS

ROTATIONS = {  # and some quantities of each
    "ZXZ": (  # angles, and divisors that vanish
        "rotation_matrix",
        "angular_velocity_space",
        "angular_velocity_body",
        "inverse_rate_matrix_space",
        "rates_from_angular_velocity_body",
    ),
    "rotation_vector": ("rotation_matrix", "angular_acceleration_body", "inverse_rate_matrix_body"),
    "quaternion": ("angular_velocity_space", "rates_from_angular_velocity_body"),
    "z(phi) [1,2,2](theta) x(psi0)": ("rotation_matrix", "angular_velocity_body"),
}

EPS = {np.float64: 2.0**-52, np.float32: 2.0**-23}

KINEMATICS = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")

FOUR = 4  # eps of the largest entry, for those


@cache
def motion(rotation: str) -> rs.Motion:
    return rs.derive(rotation, only=ROTATIONS[rotation])


@cache
def module(rotation: str, target: str) -> ModuleType:
    return motion(rotation).kernels(target).load()


def names(rotation: str) -> list[str]:
    return [step.quantity.name for step in motion(rotation).steps]


def given(rotation: str, name: str, leading, dtype=np.float64, seed: int = 1, size: float = 3.0):
    random = np.random.default_rng(seed)
    step = motion(rotation).step(name)
    return [
        random.uniform(-size, size, (*leading, len(motion(rotation).argument(n).names))).astype(
            dtype
        )
        for n in step.quantity.inputs
    ]


def exact(rotation: str, name: str, point) -> np.ndarray:
    """The expression at 50 digits of one orientation, as mpmath's numbers."""
    step = motion(rotation).step(name)
    symbols = [s for n in step.quantity.inputs for s in motion(rotation).argument(n).symbols]
    flat = [mp.mpf(float(x)) for vector in point for x in vector]
    spelled = motion(rotation).spelled(step.expression)
    values = evaluate(spelled, dict(zip(symbols, flat, strict=True)))
    return np.array(list(values), dtype=object)


def error(rotation: str, target: str, name: str, arrays) -> float:
    """The largest error of a batch, in eps of the largest entry of each orientation."""
    found = getattr(module(rotation, target), name)(*arrays)
    worst = 0.0
    for k, row in enumerate(found.reshape(len(found), -1)):
        truth = exact(rotation, name, [array[k] for array in arrays])
        size = max(map(abs, truth))
        off = max(abs(mp.mpf(float(a)) - b) for a, b in zip(row, truth, strict=True))
        worst = max(worst, float(off / size) if size else float(off))
    return worst / EPS[found.dtype.type]


EVERY = [
    pytest.param(
        name,
        marks=pytest.mark.skipif(bool(TARGETS[name].missing), reason=TARGETS[name].missing),
    )
    for name in TARGETS
]


def plain(text: str) -> str:
    """Without line ends and the stars of comments."""
    return re.sub(r"\s+(\* )?", " ", text)


STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wshadow", "-Wconversion")
STRICT += ("-Wdouble-promotion",)


def row_by_row(target: str, function: Callable[..., Any]) -> Callable[..., np.ndarray]:
    """The function on arrays with one point a row; all its results as one row a point."""
    compute = _jitted(function) if target == "jax" else function

    def call(*arrays: np.ndarray) -> np.ndarray:
        found = compute(*arrays)
        parts = found if isinstance(found, tuple) else (found,)
        return np.hstack([np.asarray(part).reshape(len(arrays[0]), -1) for part in parts])

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
