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

_EXPORTED = re.compile(
    r"^export function (\w+)\((.*)\) \{\n(?:  const values = .*\n  return (\[))?", re.MULTILINE
)  # name, parameters, and whether two results are returned
_MATRIX = re.compile(r'_flat\("\w+", (\w+?)_*, (\d+)\), (\d+)')  # parameter, columns, entries

Numbers = NDArray[np.float64]
Run = Callable[[list[Numbers]], list[Numbers]]


def load(kernels: KernelModule) -> ModuleType:
    """The functions in Python, which loads all languages but JavaScript itself."""
    if kernels.target == "javascript":
        return module(kernels.name, kernels.source)
    return kernels.load()


def module(name: str, source: str) -> ModuleType:
    """The functions of a module on arrays with components last; their other axes broadcast.

    Those of many orientations, ..._batch, take and give flat arrays as they do in JavaScript;
    with ..._each behind the name, a call for every row, in one process.
    """
    made = ModuleType(name)
    shapes = {n: (int(size) // int(c), int(c)) for n, c, size in _MATRIX.findall(source)}
    for function, listed, parted in _EXPORTED.findall(source):
        names = [name.split(" ")[0].rstrip("_") for name in listed.split(", ")]
        time = str(names.index("t")) if "t" in names else ""
        run = partial(_run, source, function, time, parted)
        is_flat = function.endswith("_batch")
        setattr(made, function, _caller(run, names, shapes, is_flat=is_flat))
        if is_flat:
            setattr(made, f"{function}_each", _caller(run, names, shapes, is_flat=False))
    return made


def _caller(
    run: Run, names: list[str], shapes: Mapping[str, tuple[int, int]], *, is_flat: bool
) -> Callable[..., Any]:
    def call(*vectors: ArrayLike) -> Any:
        arrays = [np.asarray(vector, float) for vector in vectors]
        if is_flat:
            return run([array.reshape(1, -1) for array in arrays])[0][0]
        for k, (name, array) in enumerate(zip(names, arrays, strict=False)):
            if name in shapes and array.shape[-2:] == shapes[name]:
                arrays[k] = array.reshape(*array.shape[:-2], prod(shapes[name]))
        arrays = [a[..., None] if n == "t" else a for n, a in zip(names, arrays, strict=False)]
        leading = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        rows = [
            np.broadcast_to(a, (*leading, a.shape[-1])).reshape(-1, a.shape[-1]) for a in arrays
        ]
        found = [p.reshape((*leading, *p.shape[1:])) for p in run(rows)]
        return found[0] if len(found) == 1 else tuple(found)

    return call


def _run(source: str, function: str, time: str, parted: str, rows: list[Numbers]) -> list[Numbers]:
    """The results for all rows, in one run: of a function that gives several, all of them."""
    sizes = [str(array.shape[-1]) for array in rows]
    with TemporaryDirectory(prefix="rigidsym-") as folder:
        (Path(folder) / "kernels.mjs").write_text(source, encoding="utf-8")
        shutil.copy(Path(__file__).with_name("run.mjs"), folder)
        done = subprocess.run(
            ["node", "run.mjs", function, time, parted, *sizes],
            cwd=folder,
            input=np.hstack(rows).astype("<f8").tobytes(),
            capture_output=True,
            check=False,
        )
    if done.returncode:
        raise ValueError(f"{function}: {done.stderr.decode('utf-8', 'replace').strip()}")
    head, _, values = done.stdout.partition(b"\n")
    shapes = json.loads(head)
    each = np.frombuffer(values, "<f8").reshape(len(rows[0]), sum(map(prod, shapes)))
    ends = np.cumsum([prod(shape) for shape in shapes])[:-1]
    parts = zip(np.split(each, ends, axis=1), shapes, strict=True)
    return [part.reshape(-1, *shape) for part, shape in parts]
