"""Files that are whole or not there: written beside their place, then moved into it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def write_text(path: Path, text: str, *, is_lasting: bool = False) -> Path:
    """Write text as UTF-8 with the line ends it has; returns the path. Makes its folder."""
    return write_bytes(path, text.encode("utf-8"), is_lasting=is_lasting)


def write_bytes(path: Path, content: bytes, *, is_lasting: bool = False) -> Path:
    """Write bytes to a new file and move it into place; what was there before stays until then.

    `is_lasting` waits until the bytes would outlast a power cut.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with naming(path):
        _write(path, content, is_lasting=is_lasting)
    return path


def _write(path: Path, content: bytes, *, is_lasting: bool) -> None:
    descriptor, draft = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            if is_lasting:
                file.flush()
                os.fsync(file.fileno())
        Path(draft).chmod(0o666 & ~_umask())
        os.replace(draft, path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Errors of the system that name no file, or its draft, name the file that is to be."""
    try:
        yield
    except OSError as error:
        named = Path(error.filename).name if error.filename else ""
        if error.errno is None or (named and not named.startswith(f".{path.name}.")):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def to_disk(path: Path) -> None:
    """Wait until a file, or the names in a folder, would outlast a power cut."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
