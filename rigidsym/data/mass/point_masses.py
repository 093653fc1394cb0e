"""Mass, centre, inertia tensor and principal axes of bodies that are given in numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from rigidsym.data.chunk import TableReader
from rigidsym.data.mass.blocks import BLOCK, Block, block_of, cloud_of, named
from rigidsym.data.mass.particle_columns import ParticleColumns
from rigidsym.data.mass.properties import MassProperties
from rigidsym.data.readers import ArrayReader, npy_reader, reader_of
from rigidsym.data.text import TextReader
from rigidsym.errors import BodyError, DataError, MissingExtra
from rigidsym.system.cluster import on_cluster
from rigidsym.system.processes import Progress

_WINDOW = 128 * BLOCK  # particles that a worker takes at once; whole blocks: nothing differs


def inertia_of(
    particles: Any,
    *,
    columns: Sequence[str] | None = None,
    allow: bool = False,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> MassProperties:
    """Mass, centre of mass, inertia tensor about it and principal axes of point masses.

    `particles` is an array (n, 4) of m, x, y, z or (n, 3) of x, y, z with 1 kg each, in kg and m,
    a structured array, a Dask array of this shape, or the path of an NPY, CSV or Parquet file;
    `columns` names the columns if their order differs. Units in their names are converted. An NPY
    file is read in one pass, in bounded memory; with `scheduler`, the address of a Dask cluster,
    its workers read the file. Raises BodyError for NaN, a total mass that is not positive and,
    unless `allow` is set, negative masses.
    """
    if hasattr(particles, "dask"):
        return cloud_of(_of_dask(particles, columns), allow=allow)
    path = Path(particles) if isinstance(particles, str | Path) else None
    try:
        if path is not None and scheduler is not None:
            blocks = _of_cluster(path.resolve(), columns, scheduler, progress)
            return cloud_of(blocks, allow=allow)
        reader = ArrayReader(np.asarray(particles)) if path is None else reader_of(path)
        name = named
        if isinstance(reader, TextReader):
            name = partial(_line, reader)
            reader.quotes = False  # it may be another kind of text
        blocks = _blocks(reader, columns, name, progress)
        return cloud_of(blocks, name, allow=allow)
    except (BodyError, DataError) as error:
        if path is None or str(path) in str(error):
            raise BodyError(str(error)) from None
        raise BodyError(f"{path}: {error}") from None


def _line(reader: TextReader, row: int) -> str:
    return f"{reader.source}, {reader.place(row)}"


def _blocks(
    reader: TableReader,
    names: Sequence[str] | None,
    name: Callable[[int], str],
    progress: Progress | None,
) -> Iterator[Block]:
    for some in ParticleColumns.of(reader, names).read(reader):
        yield block_of(some.masses, some.positions, some.first, name)
        if progress is not None:
            progress(some.share)


def _of_dask(array: Any, names: Sequence[str] | None) -> Iterator[Block]:
    """The blocks of a Dask array (n, 3) or (n, 4), summed by its scheduler.

    Rows are cut into the blocks of a file, so that the result is that of the file, bit for bit.
    """
    try:
        import dask
    except ImportError:
        raise MissingExtra("Dask arrays", "dask") from None
    if array.ndim != 2 or np.isnan(array.shape[0]):
        raise BodyError(f"expected an array (n, 3) or (n, 4) of known length, got {array.shape}")
    columns = ParticleColumns.of(ArrayReader(np.empty((0, array.shape[1]), array.dtype)), names)
    windows = array.rechunk((_WINDOW, -1)).to_delayed().ravel()
    tasks = [dask.delayed(_of_rows)(each, columns, k) for k, each in enumerate(windows)]
    return chain.from_iterable(dask.compute(*tasks))


def _of_cluster(
    path: Path, names: Sequence[str] | None, scheduler: str, progress: Progress | None
) -> Iterator[Block]:
    """The blocks of an NPY file that the workers of a cluster see under the same path."""
    if path.suffix.lower() != ".npy":
        raise BodyError("the workers of a cluster read only NPY files")
    reader = npy_reader(path)
    columns = ParticleColumns.of(reader, names)
    count = -(-len(reader) // _WINDOW)
    found = on_cluster(scheduler, partial(_of_file, path, columns), range(count), int)
    for window, blocks in found:
        yield from blocks
        if progress is not None:
            progress((window + 1) / count)


def _of_rows(rows: Any, columns: ParticleColumns, window: int) -> list[Block]:
    start = window * _WINDOW
    read = columns.read(ArrayReader(np.asarray(rows)))
    return [block_of(some.masses, some.positions, start + some.first) for some in read]


def _of_file(path: Path, columns: ParticleColumns, window: int) -> list[Block]:
    start = window * _WINDOW
    read = columns.read(npy_reader(path), start, start + _WINDOW)
    return [block_of(some.masses, some.positions, some.first) for some in read]
