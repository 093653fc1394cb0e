"""Work on the workers of a Dask cluster that is there already."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from rigidsym.errors import ClusterError, MissingExtra

T = TypeVar("T")
R = TypeVar("R")
PATIENCE = 10  # seconds for a scheduler to answer
_AHEAD = 2  # tasks under way for each thread of a worker, so that none waits


def on_cluster(
    address: str, function: Callable[[Any], R], items: Iterable[T], argument: Callable[[T], Any]
) -> Iterator[tuple[T, R]]:
    """Each item with the function of its argument, in order; workers need rigidsym.

    The function is sent once, and items are taken as workers become free. Raises MissingExtra
    without Dask, and ClusterError if `address`, such as tcp://host:8786, is no address, if nobody
    answers there, and if the cluster has no workers.
    """
    with _connected(address) as client:
        most = _AHEAD * sum(client.nthreads().values())
        waiting: deque[tuple[T, Any]] = deque()
        sent = client.scatter(_Called(function), broadcast=True)
        for item in items:
            if len(waiting) == most:
                first, future = waiting.popleft()
                yield first, future.result()
            waiting.append((item, client.submit(_call, sent, argument(item), pure=False)))
        for first, future in waiting:
            yield first, future.result()


class _Called:
    """A function as data, so that Dask does not take it for a task."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        self.function = function


def _call(sent: _Called, argument: Any) -> Any:
    return sent.function(argument)


@contextmanager
def _connected(address: str) -> Iterator[Any]:
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
            raise ClusterError(f"--scheduler {address}: the cluster has no workers")
        yield client
