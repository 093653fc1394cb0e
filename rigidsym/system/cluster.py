"""A Dask cluster that is there already."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rigidsym.errors import ClusterError, MissingExtra

PATIENCE = 10  # seconds for a scheduler to answer


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """A client of the scheduler at an address such as tcp://host:8786.

    Raises MissingExtra without Dask, and ClusterError for an address that is none, where nobody
    answers, and for a cluster without workers, which would never be done.
    """
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtra("a Dask cluster", "dask") from None
    try:
        client = Client(address, timeout=PATIENCE)
    except OSError:
        raise ClusterError(
            f"--scheduler {address}: no Dask scheduler answered within {PATIENCE} s"
        ) from None
    except ValueError as error:
        raise ClusterError(
            f"--scheduler {address}: expected HOST:PORT or tcp://HOST:PORT ({error})"
        ) from None
    with client:
        if not client.nthreads():
            raise ClusterError(f"--scheduler {address}: its cluster has no workers now")
        yield client
