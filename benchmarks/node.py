"""The JavaScript target beside the others: a node that stays, and computes when it is told to."""

from __future__ import annotations

import atexit
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

from benchmarks.peers import Array, Side

_LOOP = """
import { readFileSync, readSync, writeFileSync, writeSync } from "node:fs";
import * as kernels from "./kernels.mjs";

const [name, size, ...files] = process.argv.slice(2);
const read = (file) => new Float64Array(Uint8Array.from(readFileSync(file)).buffer);
const vectors = files.map(read);
const out = new Float64Array(Number(size));
const told = Buffer.alloc(1);
while (readSync(0, told, 0, 1) === 1) {
  if (told.toString() === "r") {
    kernels[`${name}_batch`](...vectors, out);
  } else {
    writeFileSync("out.bin", new Uint8Array(out.buffer));
  }
  writeSync(1, told);
}
"""


def node_side(source: str, function: str, batches: Sequence[Array], entries: int) -> Side:
    """A function of many orientations, over batches (N, n) of its arguments.

    A call takes some 50 µs to be told and to answer, which counts.
    """
    folder = Path(mkdtemp(prefix="rigidsym-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "kernels.mjs").write_text(source, encoding="utf-8")
    (folder / "loop.mjs").write_text(_LOOP, encoding="utf-8")
    for k, batch in enumerate(batches):
        batch.astype("<f8").tofile(folder / f"{k}.bin")
    count = len(batches[0])
    files = [f"{k}.bin" for k in range(len(batches))]
    process = subprocess.Popen(
        ["node", "loop.mjs", function, str(count * entries), *files],
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        bufsize=0,
    )
    atexit.register(process.kill)

    def tell(what: bytes) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(what)
        if process.stdout.read(1) != what:
            raise RuntimeError(f"node stopped at {function}, as it says above")

    def values() -> Array:
        tell(b"v")
        return np.fromfile(folder / "out.bin").reshape(count, entries)

    return Side(lambda: tell(b"r"), values)
