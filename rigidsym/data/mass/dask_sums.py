"""The same sums on a Dask cluster that is there already."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rigidsym.data.mass.blocks import BLOCK, Block, Cloud, block_of, cloud_of
from rigidsym.data.mass.particle_files import ArraySource, NpySource
from rigidsym.errors import BodyError, MissingExtra
from rigidsym.system.cluster import connected
from rigidsym.system.progress import Progress

_WINDOW = 128 * BLOCK  # particles that a worker takes at once; whole blocks: nothing differs


def cloud_of_dask(array: Any, names: Sequence[str] | None, *, allow: bool = False) -> Cloud:
    """Of a Dask array (n, 3) or (n, 4), where its scheduler computes.

    Rows are cut into the blocks of a file, so that the result is that of the file, bit for bit.
    """
    try:
        import dask
    except ImportError:
        raise MissingExtra("Dask arrays", "dask") from None
    if array.ndim != 2 or np.isnan(array.shape[0]):
        raise BodyError(f"expected an array (n, 3) or (n, 4) of known length, got {array.shape}")
    ArraySource(np.empty((0, array.shape[1]), dtype=array.dtype), names)  # the columns are right
    windows = array.rechunk((_WINDOW, -1)).to_delayed().ravel()
    tasks = [
        dask.delayed(_of_rows)(window, place * _WINDOW, names)
        for place, window in enumerate(windows)
    ]
    return cloud_of((b for blocks in dask.compute(*tasks) for b in blocks), allow=allow)


def cloud_of_file(
    path: Path,
    names: Sequence[str] | None,
    scheduler: str,
    progress: Progress | None = None,
    *,
    allow: bool = False,
) -> Cloud:
    """Of an NPY file that the workers of a cluster see under the same path."""
    if path.suffix.lower() != ".npy":
        raise BodyError(f"{path}: workers read parts of NPY files alone")
    place = path.resolve()
    total = len(NpySource(place, names))
    blocks: list[Block] = []
    done = 0
    with connected(scheduler) as client:
        from distributed import as_completed

        starts = range(0, total, _WINDOW)
        tasks = client.map(_of_file, [str(place)] * len(starts), starts, names=names, pure=False)
        for _, found in as_completed(tasks, with_results=True):
            blocks += found
            done += sum(block.count for block in found)
            if progress is not None:
                progress(done / total)
    return cloud_of(blocks, allow=allow)


def _of_rows(rows: Any, start: int, names: Sequence[str] | None) -> list[Block]:
    return _blocks(ArraySource(np.asarray(rows), names), 0, None, start)


def _of_file(path: str, start: int, names: Sequence[str] | None) -> list[Block]:
    return _blocks(NpySource(Path(path), names), start, start + _WINDOW, start)


def _blocks(
    source: ArraySource | NpySource, start: int, stop: int | None, first: int
) -> list[Block]:
    found = []
    for piece in source.pieces(start, stop):
        found.append(block_of(piece.masses, piece.places, first))
        first += piece.places.shape[1]
    return found
