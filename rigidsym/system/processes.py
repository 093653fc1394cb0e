"""What this process may use (time, memory, cores), and its progress on a terminal.

`in_processes` does the same work on many items, by copies of this process on the other cores.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from math import isfinite
from pathlib import Path
from time import monotonic
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeVar

from rigidsym.errors import LimitReached, RequestError, RigidsymError, printable

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

T = TypeVar("T")
R = TypeVar("R")
_WAITING = 1 << 20  # bytes of results
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
    from fcntl import F_SETPIPE_SZ, fcntl  # of Linux, and few commands have several items
    from multiprocessing import get_context

    context = get_context("fork")
    running, ends = [], []
    gc.freeze()  # no search for cycles touches, and so copies, the memory that all share
    try:
        for share in shares:
            here, there = context.Pipe(duplex=False)
            with suppress(OSError):  # a copy goes on while its results wait, if the system has room
                fcntl(there.fileno(), F_SETPIPE_SZ, _WAITING)
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
_MEBIBYTE = 1 << 20


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
    """Stop what runs inside when it needs this much more memory than is in use now.

    Raises LimitReached, and RequestError for no positive number. Without support by the system
    there is no limit.
    """
    if not (isinstance(gigabytes, int | float) and gigabytes > 0):
        raise RequestError(f"memory: expected a positive number of GB, got {gigabytes!r}")
    used = _memory_in_use()
    if used is None or not isfinite(gigabytes):
        yield
        return
    import resource

    before = resource.getrlimit(resource.RLIMIT_DATA)
    most = used + int(gigabytes * 1024 * _MEBIBYTE)
    if before[1] != resource.RLIM_INFINITY:
        most = min(most, before[1])
    resource.setrlimit(resource.RLIMIT_DATA, (most, before[1]))
    try:
        yield
    except MemoryError:
        raise LimitReached(
            f"stopped at {gigabytes:g} GB of memory; raise the memory limit if it needs more"
        ) from None
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, before)


def _memory_in_use() -> int | None:
    """Bytes of data of this process; None if the system does not say."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    lines = (line.split() for line in status.splitlines() if line.startswith("VmData:"))
    return next((int(line[1]) * 1024 for line in lines), None)
