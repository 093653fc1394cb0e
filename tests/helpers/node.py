"""Loaded kernels of every target: an ES module as a Python module, whose calls run node."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable, Mapping
from functools import partial
from math import prod
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.kernels.module import KernelModule

_EXPORTED = re.compile(r"^export function (\w+)\((.*)\) \{\n", re.MULTILINE)  # name, parameters
_MATRIX = re.compile(r'_flat\("\w+", (\w+?)_*, (\d+)\), (\d+)')  # parameter, columns, entries

Numbers = NDArray[np.float64]
Run = Callable[[list[Numbers]], Numbers]


def load(kernels: KernelModule) -> ModuleType:
    """The functions in Python, which loads all languages but JavaScript itself."""
    if kernels.target == "javascript":
        return module(kernels.name, kernels.source)
    return kernels.load()


def module(name: str, source: str) -> ModuleType:
    """The functions of a module on arrays with components last; their other axes broadcast."""
    made = ModuleType(name)
    shapes = {n: (int(size) // int(c), int(c)) for n, c, size in _MATRIX.findall(source)}
    for function, listed in _EXPORTED.findall(source):
        names = [name.split(" ")[0].rstrip("_") for name in listed.split(", ")]
        time = str(names.index("t")) if "t" in names else ""
        run = partial(_run, source, function, time)
        setattr(made, function, _caller(run, names, shapes))
    return made


def _caller(
    run: Run, names: list[str], shapes: Mapping[str, tuple[int, int]]
) -> Callable[..., Any]:
    def call(*vectors: ArrayLike) -> Any:
        arrays = [np.asarray(vector, float) for vector in vectors]
        for k, (name, array) in enumerate(zip(names, arrays, strict=False)):
            if name in shapes and array.shape[-2:] == shapes[name]:
                arrays[k] = array.reshape(*array.shape[:-2], prod(shapes[name]))
        arrays = [a[..., None] if n == "t" else a for n, a in zip(names, arrays, strict=False)]
        leading = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        rows = [
            np.broadcast_to(a, (*leading, a.shape[-1])).reshape(-1, a.shape[-1]) for a in arrays
        ]
        result = run(rows)
        return result.reshape((*leading, *result.shape[1:]))

    return call


def _run(source: str, function: str, time: str, rows: list[Numbers]) -> Numbers:
    """The results for all rows, in one run."""
    sizes = [str(array.shape[-1]) for array in rows]
    with TemporaryDirectory(prefix="rigidsym-") as folder:
        (Path(folder) / "kernels.mjs").write_text(source, encoding="utf-8")
        shutil.copy(Path(__file__).with_name("run.mjs"), folder)
        done = subprocess.run(
            ["node", "run.mjs", function, time, *sizes],
            cwd=folder,
            input=np.hstack(rows).astype("<f8").tobytes(),
            capture_output=True,
            check=False,
        )
    if done.returncode:
        raise ValueError(f"{function}: {done.stderr.decode('utf-8', 'replace').strip()}")
    head, _, values = done.stdout.partition(b"\n")
    return np.frombuffer(values, "<f8").reshape(-1, *json.loads(head))
