"""One run at a time for one result: two would write into the same draft."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigidsym.data.writers import draft_of
from rigidsym.errors import DraftInUse


@contextmanager
def claimed(path: Path) -> Iterator[None]:
    """The sole right to write a result, for a while; makes its folder.

    The operating system gives the right back when a process ends, however it ends, so that the
    file of a dead one, PATH.part.lock, is in nobody's way. Raises DraftInUse, naming the process
    that has it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    lock = draft_of(path).with_name(f"{draft_of(path).name}.lock")
    descriptor = _opened(lock, path)
    try:
        os.truncate(descriptor, 0)
        os.write(descriptor, f"process {os.getpid()} on {platform.node()}".encode())
        yield
    finally:
        lock.unlink(missing_ok=True)  # before it is given back: nobody else has it
        os.close(descriptor)


def _opened(lock: Path, path: Path) -> int:
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _take(descriptor, path)
            if _is_there(lock, descriptor):
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)  # another run ended, and took its file away, in between


def _take(descriptor: int, path: Path) -> None:
    if sys.platform == "win32":  # which has no such locks: there, two runs are not kept apart
        return
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        other = os.read(descriptor, 200).decode(errors="replace") or "another process"
        raise DraftInUse(
            f"{path} is being written by {other}; wait for it, or choose another --out"
        ) from None
    except OSError:  # a file system without locks
        return


def _is_there(lock: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(lock.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False
