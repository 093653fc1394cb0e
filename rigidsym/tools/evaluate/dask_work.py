"""The same work on the workers of a Dask cluster that is there already."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any

from rigidsym.data.chunk import Piece, Table
from rigidsym.system.cluster import connected
from rigidsym.tools.evaluate.work import Work

_AHEAD = 2  # pieces on their way for each thread of a worker, so that none waits


def on_cluster(address: str, work: Work, pieces: Iterable[Piece]) -> Iterator[tuple[Piece, Table]]:
    """Each piece with its result, in order; workers need rigidsym, and no file of ours.

    Raises MissingExtra and ClusterError, as `connected` does.
    """
    with connected(address) as client:
        most = _AHEAD * sum(client.nthreads().values())
        waiting: deque[tuple[Piece, Any]] = deque()
        kept = client.scatter(work, broadcast=True)
        for piece in pieces:
            if len(waiting) == most:
                first, future = waiting.popleft()
                yield first, future.result()
            waiting.append((piece, client.submit(_result, kept, piece.table, pure=False)))
        for first, future in waiting:
            yield first, future.result()


def _result(work: Work, table: Table) -> Table:
    return work.of(table)
