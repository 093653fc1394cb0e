"""Files that are whole or not there: written beside their place, then moved into it."""

from __future__ import annotations

import errno
import os
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO


def table_beside(module: str, name: str) -> dict[str, Any]:
    """The content of a TOML file in the folder of a module, which gives its `__file__`."""
    return tomllib.loads(Path(module).with_name(name).read_text(encoding="utf-8"))


def read_bytes(path: Path, most: int = -1) -> bytes:
    """The content of a regular file, or its first `most` bytes.

    Raises OSError; a FIFO or a device is refused, since reading from it could wait for ever.
    """
    if not path.is_file() and path.exists() and not path.is_dir():
        raise OSError(errno.EINVAL, "not a regular file", str(path))
    with path.open("rb") as file:
        return file.read(most)


def write_text(path: Path, text: str) -> Path:
    """Write text as UTF-8 with the line ends it has; returns the path. Makes its folder."""
    return write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, content: bytes) -> Path:
    """Write bytes to a new file and move it into place; an older file stays until then."""
    with whole_file(path) as file:
        file.write(content)
    return path


def cache_folder(kind: str) -> Path | None:
    """The user's folder (XDG_CACHE_HOME) for one kind of files; None if it cannot be written."""
    import tempfile  # with all that `rigidsym --help` needs none of

    try:
        cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        home = cache / "rigidsym" / kind
        home.mkdir(parents=True, exist_ok=True)
        Path(tempfile.mkdtemp(dir=home, prefix=".")).rmdir()  # it can be written
    except (OSError, RuntimeError):  # no permission, or no home
        return None
    return home


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write into, moved into place if the block succeeds, removed if not.

    Makes its folder. Errors of the system that name no file, or the draft, name the file that was
    to be.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.urandom(4).hex()}")
    try:
        with draft.open("xb") as file:
            yield file
        draft.replace(path)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(draft)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):  # it has its place, or was never made
            draft.unlink()
