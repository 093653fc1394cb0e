"""What this process may use (time, memory, cores), and its progress on a terminal.

`in_processes` does the same work on many items, by copies of this process on the other cores.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from math import isfinite
from time import monotonic
from types import FrameType
from typing import Any, TypeVar

from rigidsym.errors import LimitReached, RequestError, printable

T = TypeVar("T")
R = TypeVar("R")
_PATIENCE = 5.0  # seconds for a copy to end what it started


def cores() -> int:
    """The cores that this process may use; one where the system makes no copies of processes."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1


def in_processes(work: Callable[[T], R], items: Sequence[T]) -> Iterator[R]:
    """The result of each item, in order; work, items, results and errors can be pickled.

    The first item is done before this process is copied, so that the copies have all that it
    imported and kept for the next.
    """
    yield from map(work, items[:1])
    # the threads of JAX are not copied, and a copy would wait for them
    count = 1 if "jax" in sys.modules else min(cores(), len(items) - 1)
    if count < 2:
        yield from map(work, items[1:])
        return
    from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
    from multiprocessing import active_children, get_context

    done = 1
    with ProcessPoolExecutor(count, get_context("fork"), _obey_this_process) as pool:
        try:
            for result in pool.map(partial(_done, work), items[1:]):
                yield result
                done += 1
        except BrokenProcessPool:  # the system ended a copy, for want of memory for instance
            yield from map(work, items[done:])
        except BaseException:  # an interrupt does not wait for results
            copies = active_children()
            for copy in copies:
                copy.terminate()
            for copy in copies:
                copy.join(_PATIENCE)
                copy.kill()
            raise


def _done(work: Callable[[T], R], item: T) -> R:
    try:
        return work(item)
    except SystemExit:  # the executor would go on with the next item
        os._exit(1)


def _obey_this_process() -> None:
    """Ctrl-C reaches only the first process, which ends its copies and what they started.

    Errors are pickled; all that multiprocessing would print is that it was interrupted.
    """
    sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end_once)


def _end_once(_signal: int, _frame: FrameType | None) -> None:
    # the executor ends the copies a second time, which must not stop their cleaning up
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sys.exit(1)


Progress = Callable[[float], None]  # receives the share done, from 0 to 1
_DRAWING = ContextVar("a bar is drawn", default=False)


def is_drawing() -> bool:
    """Whether a bar is on the terminal now."""
    return _DRAWING.get()


@contextmanager
def bar(label: str) -> Iterator[Progress | None]:
    """A bar while the work goes on; None without a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn

    text = TextColumn("{task.description}", markup=False)
    with _drawn(text, BarColumn(), TaskProgressColumn(), TimeRemainingColumn()) as shown:
        task = shown.add_task(printable(label), total=1.0)
        yield lambda share: shown.update(task, completed=share)


@contextmanager
def counter(total: int) -> Iterator[Callable[[str], None]]:
    """A bar that counts tasks; the function it gives is called with the name of each task."""
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn

    text = TextColumn("{task.description:<28}", markup=False)
    with _drawn(text, BarColumn(), MofNCompleteColumn()) as shown:
        task = shown.add_task("", total=total, completed=-1)
        yield lambda name: shown.update(task, description=name, advance=1)


@contextmanager
def _drawn(*columns: Any) -> Iterator[Any]:
    from rich.console import Console
    from rich.progress import Progress as Bar

    token = _DRAWING.set(True)
    try:
        with Bar(*columns, console=Console(stderr=True), transient=True) as shown:
            yield shown
    finally:
        _DRAWING.reset(token)


_TICK = 1.0  # seconds between two looks at the clock


class _TimeIsUp(BaseException):
    """Raised inside the work, past handlers of ordinary exceptions."""


@contextmanager
def time_limit(seconds: float, *, label: str = "") -> Iterator[None]:
    """Stop what runs inside after some seconds; with a label, count the seconds on a terminal.

    Without timers in the system (Windows) there is no limit.
    Raises LimitReached when the time is up, and RequestError for a time that is not positive or
    outside the main thread, since only that receives signals.
    """
    if not (isinstance(seconds, int | float) and seconds > 0):
        raise RequestError(f"timeout: expected a positive number of seconds, got {seconds!r}")
    if threading.current_thread() is not threading.main_thread():
        raise RequestError("timeout works only in the main thread")
    if not hasattr(signal, "setitimer"):  # Windows: no limit
        yield
        return
    start = monotonic()
    is_shown = bool(label) and sys.stderr.isatty()

    def tick(_signal: int, _frame: FrameType | None) -> None:
        passed = monotonic() - start
        if passed >= seconds:
            raise _TimeIsUp
        if is_shown and not is_drawing():
            os.write(2, f"\r{label}: {passed:.0f} s".encode())

    lost = sys.unraisablehook

    def ignored(unraisable: sys.UnraisableHookArgs) -> None:
        """Say nothing of a stop that a finalizer lost; the next tick stops the work."""
        if unraisable.exc_type is not _TimeIsUp:
            lost(unraisable)

    first = min(_TICK, seconds)
    sys.unraisablehook = ignored
    handler = signal.signal(signal.SIGALRM, tick)
    before = signal.setitimer(signal.ITIMER_REAL, first, first if isfinite(first) else _TICK)
    try:
        yield
    except _TimeIsUp:
        raise LimitReached(
            f"stopped after {seconds:g} s; raise the time limit if it needs longer"
        ) from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)
        signal.signal(signal.SIGALRM, handler)
        sys.unraisablehook = lost
        if is_shown and monotonic() - start > _TICK:
            os.write(2, b"\r\x1b[K")


@contextmanager
def memory_limit(gigabytes: float) -> Iterator[None]:
    """Stop what runs inside when this process needs more memory, if the system can limit it.

    Raises LimitReached.
    """
    if sys.platform == "win32" or not isfinite(gigabytes):
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = int(gigabytes * (1 << 30))
    resource.setrlimit(resource.RLIMIT_DATA, (most if hard < 0 else min(most, hard), hard))
    try:
        yield
    except MemoryError:
        message = f"stopped at {gigabytes:g} GB of memory; raise the memory limit if it needs more"
        raise LimitReached(message) from None
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
