"""What this process may use (time, cores), and its progress on a terminal.

`in_processes` does the same work on many items, by copies of this process on the other cores.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import isfinite
from types import FrameType
from typing import Any, TypeVar

from rigidsym.errors import LimitReached, RequestError, printable

T = TypeVar("T")
R = TypeVar("R")
NEW_OBJECTS = 200_000  # between two searches for cycles; importing SymPy makes 100,000
_THRESHOLDS: list[tuple[int, int, int]] = []  # of Python, at each entry of `rare_collections`
_LOCK = threading.Lock()
_TICK = 1.0  # seconds from a stop that was lost to the next


@contextmanager
def rare_collections() -> Iterator[None]:
    """Inside, Python seldom searches for cycles of objects, of which a derivation leaves few.

    A full search walks through all of SymPy: 50 ms, a tenth of the time of 24 conventions.
    """
    with _LOCK:
        _THRESHOLDS.append(gc.get_threshold())
        first, *others = _THRESHOLDS[-1]
        gc.set_threshold(first and max(first, NEW_OBJECTS), *others)  # 0: the user wants none
    try:
        yield
    finally:
        with _LOCK:
            before = _THRESHOLDS.pop()
            if not _THRESHOLDS:  # the last thread restores what the first one found
                gc.set_threshold(*before)


def cores() -> int:
    """The cores that this process may use; one where the system makes no copies of processes."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1


def in_processes(work: Callable[[T], R], items: Sequence[T], *, first: int = 1) -> Iterator[R]:
    """The result of each item, in order; work, items, results and errors can be pickled.

    The `first` items are done before this process is copied, so that the copies have all that they
    imported and kept for the next. Then it goes on from the front, and they begin at the end:
    neighbours are often alike, and a process that has done one does the next in less time.
    """
    yield from map(work, items[:first])
    # the threads of JAX are not copied, and a copy would wait for them
    count = 1 if "jax" in sys.modules else min(cores(), len(items) - first)
    if count < 2:
        yield from map(work, items[first:])
        return
    from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
    from multiprocessing import active_children, get_context

    gc.freeze()  # a search for cycles would copy the pages of all that the processes share
    waiting, lock = deque(range(first, len(items))), threading.Lock()
    futures: dict[int, Any] = {}

    def hand_out(before: Any = None) -> None:
        """Give the last item that is waiting to a copy, if it has done the one before."""
        if before and before.exception():
            return
        with lock:
            if not waiting:
                return
            last = waiting.pop()
            future = futures[last] = pool.submit(work, items[last])
        future.add_done_callback(hand_out)

    place = first
    with ProcessPoolExecutor(count - 1, get_context("fork"), _obey_this_process) as pool:
        try:
            for _ in range(count - 1):
                hand_out()
            for place in range(first, len(items)):
                with lock:
                    own = waiting.popleft() if waiting else None  # this place
                yield work(items[place]) if own is not None else futures.pop(place).result()
        except BrokenProcessPool:  # the system ended a copy, for want of memory for instance
            yield from map(work, items[place:])
        except BaseException:  # an interrupt does not wait for results
            with lock:  # a copy that ends its item now gets no other: the pool takes no more work
                waiting.clear()
            for copy in active_children():
                copy.terminate()
            raise


def _obey_this_process() -> None:
    """Ctrl-C reaches only the first process, which ends its copies.

    Errors are pickled; all that multiprocessing would print is that it was interrupted.
    """
    sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    signal.signal(signal.SIGINT, signal.SIG_IGN)


Progress = Callable[[float], None]  # receives the share done, from 0 to 1


@contextmanager
def bar(label: str) -> Iterator[Progress | None]:
    """A line with the share that is done, until the work ends; None without a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    name = printable(label)

    def draw(share: float) -> None:
        sys.stderr.write(f"\r{name} {share:4.0%}")
        sys.stderr.flush()

    try:
        yield draw
    finally:
        sys.stderr.write(f"\r{' ' * (len(name) + 5)}\r")


class _TimeIsUp(BaseException):
    """Raised inside the work, past handlers of ordinary exceptions."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Stop what runs inside after some seconds; without timers in the system there is no limit.

    Raises LimitReached when the time is up, and RequestError for a time that is not positive or
    outside the main thread, since only that receives signals.
    """
    if not (isinstance(seconds, int | float) and seconds > 0):
        raise RequestError(f"timeout: expected a positive number of seconds, got {seconds!r}")
    if threading.current_thread() is not threading.main_thread():
        raise RequestError("timeout works only in the main thread")
    if not hasattr(signal, "setitimer") or not isfinite(seconds):
        yield
        return

    def stop(_signal: int, _frame: FrameType | None) -> None:
        if not isinstance(sys.exc_info()[1], _TimeIsUp):  # what the work does at its end is done
            raise _TimeIsUp

    handler = signal.signal(signal.SIGALRM, stop)
    # Python drops what is raised inside a finalizer: the next tick stops the work then.
    before = signal.setitimer(signal.ITIMER_REAL, seconds, _TICK)
    try:
        yield
    except _TimeIsUp:
        raise LimitReached(
            f"stopped after {seconds:g} s; raise the time limit if it needs longer"
        ) from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)
        signal.signal(signal.SIGALRM, handler)
