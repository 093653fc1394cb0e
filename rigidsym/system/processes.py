"""The same work on many items, by copies of this process on the other cores."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TypeVar

from rigidsym.errors import RigidsymError

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

T = TypeVar("T")
R = TypeVar("R")
_PATIENCE = 2.0  # seconds for a copy to end what it started


def cores() -> int:
    """The cores that this process may use; one where the system makes no copies of processes."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1


def in_processes(work: Callable[[T], R], items: Sequence[T]) -> Iterator[R]:
    """The result of each item, in order. The work writes nothing, and its results can be pickled.

    The first item is done before this process is copied, so that the copies have all that it
    imported and kept for the next. A copy ends at its first error; its items are then done here,
    so that errors are raised as by `map`, in order.
    """
    yield from map(work, items[:1])
    rest = items[1:]
    # the threads of JAX are not copied, and a copy would wait for them
    count = 1 if "jax" in sys.modules else max(min(cores(), len(rest)), 1)
    copy_of = [place % count for place in range(len(rest))]  # 0: it is done here
    if count > 1 and not copy_of[-1]:
        copy_of[-1] = 1  # this process also handles all results
    shares = [[rest[p] for p, k in enumerate(copy_of) if k == copy] for copy in range(1, count)]
    with _copies(work, shares) as copies:
        for item, copy in zip(rest, copy_of, strict=True):
            try:
                yield copies[copy - 1].recv() if copy else work(item)
            except EOFError:
                yield work(item)


@contextmanager
def _copies(
    work: Callable[[T], R], shares: Sequence[Sequence[T]]
) -> Iterator[list[Connection[R, R]]]:
    """Where the results of each share come in; the copies end with the block."""
    if not shares:
        yield []
        return
    from multiprocessing import get_context  # few commands have several items

    context = get_context("fork")
    running, ends = [], []
    gc.freeze()  # no search for cycles touches, and so copies, the memory that all share
    try:
        for share in shares:
            here, there = context.Pipe(duplex=False)
            copy = context.Process(target=_done, args=(work, share, here, there), daemon=True)
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            copy.start()  # Ctrl-C does not reach it: this process ends it
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            there.close()
            running.append(copy)
            ends.append(here)
        yield ends
    finally:
        gc.unfreeze()
        for copy in running:
            copy.terminate()
            copy.join(_PATIENCE)
            copy.kill()
            copy.join()


def _done(
    work: Callable[[T], R], items: Sequence[T], here: Connection[R, R], there: Connection[R, R]
) -> None:
    """The part of a copy: the results of its items, up to the first error.

    If it is ended before, it ends the programs that it started, too.
    """
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    here.close()
    with suppress(RigidsymError, MemoryError, BrokenPipeError):
        for item in items:
            there.send(work(item))
