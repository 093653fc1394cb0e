"""Kernels that are loaded, as modules that other processes can import: pools pickle by name.

Each set of files is a package of this one, named by a digest of its content, in the user's cache
folder (XDG_CACHE_HOME). Without such a folder it is in one that goes away with the process.
"""

from __future__ import annotations

import atexit
import os
import shutil
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib import import_module, invalidate_caches
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from types import ModuleType

from rigidsym.system.files import cache_folder

# Packages in the cache folder, some 60 kB each; those unused for the longest time go.
_KEPT = 200


def load(
    main: str,
    files: Mapping[str, str],
    build: Callable[[Path], object] | None = None,
    *depends: object,
) -> ModuleType:
    """The module `main` among some files.

    `build` makes of the folder with the files what else is needed, and `depends` is all that the
    outcome depends on beside the files.
    """
    digest = sha256(repr([*files.items(), *depends]).encode()).hexdigest()
    package = f"kernels_{digest[:32]}"
    home = cache_folder("kernels") or _own()
    if str(home) not in __path__:
        __path__.append(str(home))  # where Python looks for the packages
    kept = home / package
    if not kept.is_dir():
        with TemporaryDirectory(dir=home, prefix=".", ignore_cleanup_errors=True) as folder:
            draft = Path(folder)
            # Built beside its final place and renamed, so that no process imports half of a
            # package.
            for name, text in {"__init__.py": "", **files}.items():
                (draft / name).write_text(text, encoding="utf-8")
            if build is not None:
                build(draft)
            with suppress(OSError):  # another process was faster, with the same content
                draft.rename(kept)
        with suppress(OSError):  # another process removes them
            for old in sorted(home.glob("kernels_*"), key=os.path.getmtime)[:-_KEPT]:
                shutil.rmtree(old, ignore_errors=True)
    with suppress(OSError):
        os.utime(kept)  # it was used now
    invalidate_caches()
    return import_module(f"{__name__}.{package}.{main}")


@cache
def _own() -> Path:
    """The folder of this process, if there is no other."""
    home = Path(mkdtemp(prefix="rigidsym-"))
    atexit.register(shutil.rmtree, home, ignore_errors=True)
    return home


_CACHE = cache_folder("kernels")  # where another process may have put what is unpickled here
__path__ = [] if _CACHE is None else [str(_CACHE)]
