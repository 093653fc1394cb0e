"""An ES module as a Python module: each call is a run of node, so that it can be compared."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rigidsym.errors import MissingTool

_EXPORTED = re.compile(r"^export function (\w+)\(", re.MULTILINE)
_RUN = """
import { readFileSync } from "node:fs";
import * as kernels from "./kernels.mjs";

const [name, ...sizes] = process.argv.slice(2);
const numbers = new Float64Array(Uint8Array.from(readFileSync(0)).buffer);
const count = sizes.reduce((sum, size) => sum + Number(size), 0);
const results = [];
for (let start = 0; start < numbers.length; start += count) {
  let place = start;
  const vectors = sizes.map((size) => numbers.subarray(place, (place += Number(size))));
  results.push(kernels[name](...vectors));
}
const shape = (value) => (Array.isArray(value) ? [value.length, ...shape(value[0])] : []);
process.stdout.write(JSON.stringify(shape(results[0])) + "\\n");
process.stdout.write(new Uint8Array(Float64Array.from(results.flat(2)).buffer));
"""


def module(name: str, source: str) -> ModuleType:
    """The functions of a module on arrays with components last; their other axes broadcast.

    Raises MissingTool where node is not installed.
    """
    if shutil.which("node") is None:
        raise MissingTool(
            "no program `node` (on Debian: apt install nodejs) to run JavaScript with"
        )
    made = ModuleType(name)
    for function in _EXPORTED.findall(source):
        setattr(made, function, _caller(source, function))
    return made


def _caller(source: str, function: str) -> Callable[..., NDArray[np.float64]]:
    def call(*vectors: ArrayLike) -> Any:
        arrays = [np.asarray(vector, float) for vector in vectors]
        leading = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        rows = [
            np.broadcast_to(a, (*leading, a.shape[-1])).reshape(-1, a.shape[-1]) for a in arrays
        ]
        shape, values = _run(source, function, rows)
        return values.reshape((*leading, *shape))

    return call


def _run(
    source: str, function: str, rows: list[NDArray[np.float64]]
) -> tuple[list[int], NDArray[np.float64]]:
    """Shape and values of the results for all rows, in one run."""
    sizes = [str(array.shape[-1]) for array in rows]
    with TemporaryDirectory(prefix="rigidsym-") as folder:
        (Path(folder) / "kernels.mjs").write_text(source, encoding="utf-8")
        (Path(folder) / "run.mjs").write_text(_RUN, encoding="utf-8")
        done = subprocess.run(
            ["node", "run.mjs", function, *sizes],
            cwd=folder,
            input=np.hstack(rows).astype("<f8").tobytes(),
            capture_output=True,
            check=False,
        )
    if done.returncode:
        raise ValueError(f"{function}: {done.stderr.decode('utf-8', 'replace').strip()}")
    head, _, values = done.stdout.partition(b"\n")
    return json.loads(head), np.frombuffer(values, "<f8")
