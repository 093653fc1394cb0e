"""Explicit Runge-Kutta steps in C, of many states that a compiled module has the slopes of."""

from __future__ import annotations

import ctypes
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from rigidsym.kernels.targets.c.compiling import compile_library, load_built
from rigidsym.system import resources

Array = NDArray[np.float64]
_SOURCE, _LIBRARY = "steps.c", "steps.so"
_PART = 32  # the size of an array of states is a multiple
_POINTER, _SIZE, _NUMBER = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_double
_ARGUMENTS = (
    *(_POINTER, _SIZE, _SIZE, _SIZE, _POINTER, _NUMBER, _NUMBER, _SIZE, _POINTER),
    *(ctypes.c_ssize_t, ctypes.c_int, _POINTER, _POINTER, _POINTER, _POINTER),
)


class CompiledSteps:
    """Steps of the method with these nodes, weights (n, n) and sums (n,)."""

    def __init__(self, kernels: ModuleType, nodes: Array, weights: Array, sums: Array) -> None:
        """`kernels` is a module of the target c with `state_derivative`. Raises MissingTool."""
        files = {_SOURCE: resources.text("templates/c", _SOURCE), "steps_c.py": ""}
        made = load_built(
            "steps_c", files, lambda at: compile_library([at / _SOURCE], str(at / _LIBRARY))
        )
        self._take = ctypes.CDLL(str(Path(str(made.__file__)).with_name(_LIBRARY))).take_steps
        self._take.argtypes, self._take.restype = _ARGUMENTS, None
        name = kernels.__name__.rpartition(".")[2].removesuffix("_c")
        library = ctypes.CDLL(kernels._compiled.__file__)
        self._slopes = ctypes.cast(library[f"{name}_state_derivative_array"], _POINTER)
        self._method = [np.ascontiguousarray(part, float) for part in (nodes, weights, sums)]

    def moved(self, y: Array, t: float, h: float, count: int, parameters: Array | None) -> Array:
        """The states (m, k) after `count` steps of length h from the time t.

        `parameters`, (p,) or (m, p), are None for slopes without any. Python's lock is released.
        """
        size = -(-y.size // _PART) * _PART
        held = np.zeros(size)
        held[: y.size] = y.ravel()
        nodes, weights, sums = self._method
        room = np.zeros((len(nodes) + 2) * size)
        given = None if parameters is None else np.ascontiguousarray(parameters)
        apart = given.shape[-1] if given is not None and given.ndim > 1 else 0
        self._take(
            *(self._slopes, len(y), y.shape[-1], size, held.ctypes.data, t, h, count),
            *(None if given is None else given.ctypes.data, apart, len(nodes)),
            *(part.ctypes.data for part in (nodes, weights, sums, room)),
        )
        return held[: y.size].reshape(y.shape)
