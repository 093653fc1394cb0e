"""NPY files, mapped into memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import DataError

_MAGIC = b"\x93NUMPY"


def mapped(path: Path) -> NDArray[Any]:
    """The array of an NPY file, mapped into memory.

    Raises DataError for another file, for one that is cut short, and for one of Python objects.
    """
    with path.open("rb") as file:
        begins = file.read(len(_MAGIC))
    if begins != _MAGIC:
        found = "another kind of file" if begins else "an empty file"
        raise DataError(f"{path}: not an NPY file of numbers, but {found}")
    try:
        array: NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise DataError(f"{path}: not an NPY file of numbers ({error})") from None
    return array
