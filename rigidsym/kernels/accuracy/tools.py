"""How a target's functions are called to be measured, and what that is done with, in words."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Function = Callable[..., Any]


def tool(target: str) -> str:
    """The program or package that computes, with its version, and the kind of processor."""
    return f"{_PROGRAMS[target]()}, {_processor()}"


def caller(target: str, function: Function) -> Callable[..., Array]:
    """The function on arrays with one point a row; all its results, row by row."""
    compute = called(target, function)

    def call(*arrays: Array) -> Array:
        found = compute(*arrays)
        parts = found if isinstance(found, tuple) else (found,)
        return np.hstack([np.asarray(part).reshape(len(arrays[0]), -1) for part in parts])

    return call


def called(target: str, function: Function) -> Function:
    """The function as it is measured: for JAX under jit."""
    return _jitted(function) if target == "jax" else function


def _jitted(function: Function) -> Function:
    """As jax.jit compiles it, in the precision of the arrays."""
    import jax

    config: Any = jax.config

    def call(*arrays: Array) -> Any:
        before = config.jax_enable_x64
        config.update("jax_enable_x64", True)
        try:
            return jax.tree.map(np.asarray, jax.jit(function)(*arrays))
        finally:
            config.update("jax_enable_x64", before)

    return call


def _compiler() -> str:
    from rigidsym.kernels.targets.c.build import compiler

    return _first_line(compiler(), "--version")


def _first_line(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0].replace(",", "")


_PROGRAMS: dict[str, Callable[[], str]] = {
    "numpy": lambda: f"NumPy {version('numpy')}",
    "c": _compiler,
    "numba": lambda: f"Numba {version('numba')}",
    "jax": lambda: f"JAX {version('jax')} under jit",
    "javascript": lambda: f"node {_first_line('node', '--version')}",
}


def _processor() -> str:
    """What decides which instructions compute."""
    try:
        known = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:  # no Linux
        known = ""
    return platform.machine() + (" with AVX-512" if "avx512f" in known else "")
