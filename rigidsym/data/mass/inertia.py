"""Mass, centre, inertia tensor and principal axes of bodies that are given in numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rigidsym.data.mass.blocks import Block, Cloud, block_of, cloud_of
from rigidsym.data.mass.particle_files import ArraySource, Source, source_of
from rigidsym.data.mass.principal_axes import principal_axes_of
from rigidsym.data.mass.properties import Measured
from rigidsym.system.progress import Progress


def inertia_of(
    particles: Any,
    *,
    columns: Sequence[str] | None = None,
    allow: bool = False,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Measured:
    """Mass, centre of mass, inertia tensor about it and principal axes of point masses.

    `particles` is an array (n, 4) of m, x, y, z or (n, 3) of x, y, z with 1 kg each, in kg and m,
    a Dask array of this shape, or the path of an NPY, CSV or Parquet file; `columns` names the
    columns where they stand otherwise. An NPY file is read in one pass, in pieces, and its memory
    given back; with `scheduler`, the address of a Dask cluster whose workers see the file, they
    read it. Raises BodyError for NaN, a total mass that is not positive and, unless they are to
    `allow`, negative masses.
    """
    if hasattr(particles, "dask"):
        from rigidsym.data.mass.dask_sums import cloud_of_dask

        return measured(cloud_of_dask(particles, columns, allow=allow))
    if isinstance(particles, str | Path):
        if scheduler is not None:
            from rigidsym.data.mass.dask_sums import cloud_of_file

            path = Path(particles)
            return measured(cloud_of_file(path, columns, scheduler, progress, allow=allow))
        source: Source = source_of(Path(particles), columns)
    else:
        source = ArraySource(np.asarray(particles), columns)
    return measured(cloud_of(_blocks(source, progress), source.place, allow=allow))


def measured(cloud: Cloud) -> Measured:
    """A cloud with its principal axes."""
    return Measured(
        count=cloud.count,
        mass=cloud.mass,
        centre=cloud.centre,
        inertia=cloud.inertia,
        principal=principal_axes_of(cloud.inertia),
    )


def _blocks(source: Source, progress: Progress | None) -> Iterator[Block]:
    done = 0
    for piece in source.pieces():
        yield block_of(piece.masses, piece.places, done, source.place)
        done += piece.places.shape[1]
        if progress is not None:
            progress(piece.share)
