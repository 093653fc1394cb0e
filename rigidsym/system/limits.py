"""Limits on work: time and memory, and a word on a terminal that work goes on."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from time import monotonic
from types import FrameType

from rigidsym.errors import LimitReached, RequestError
from rigidsym.system.progress import is_drawing

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
