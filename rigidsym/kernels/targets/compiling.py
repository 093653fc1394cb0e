"""From the files of the target c to a Python module that can be imported, by a C compiler."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import ModuleType

from rigidsym.errors import CheckError, MissingTool, ToolFailed
from rigidsym.kernels.loaded import load
from rigidsym.system.files import whole_file

COMPILERS = ("cc", "gcc", "clang")
TIMEOUT = 300.0  # seconds
_SOURCES = "{}.c", "{}_module.c"
# Vector instructions need leave to compute what a branch would have left out, and NaN keeps its
# meaning: no -ffast-math.
_FLAGS = (
    "-std=c99",
    "-O3",
    # Sines of several angles side by side, with gcc 12: a twentieth faster on Zen 4; R by rows 1.3
    # times as fast on Cascade Lake.
    "-fschedule-insns",
    "-fPIC",
    "-shared",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-trapping-math",
)
# Left out where refused. gcc takes rows of three apart by whole vectors under this tuning alone: a
# twentieth faster on Zen 4, no difference on Cascade Lake. There, vectors of 512 bits make Ω′ and R
# 1.1 (by rows) to 1.4 (by columns) times as fast as those of 256.
_OF_THIS_PROCESSOR = ("-march=native", "-mtune=icelake-server", "-mprefer-vector-width=512")
_LOG_LINES = 15


def build(source: Path) -> Path:
    """Compile NAME.c and the files beside it, and return the module NAME_c.py.

    The binary uses the instruction set of this processor. Raises MissingTool without a C compiler
    or Python's headers, CheckError if a file is missing, and ToolFailed, with the end of the
    compiler's messages, if it stops.
    """
    name, folder = source.stem, source.parent
    needed = [folder / text.format(name) for text in (*_SOURCES, "{}.h", "{}_c.py")]
    if missing := [str(path) for path in needed if not path.is_file()]:
        raise CheckError(
            f"{', '.join(missing)}: not found; rigidsym derive --target c writes them; omit --lean"
        )
    library = folder / f"_{name}_c{sysconfig.get_config_var('EXT_SUFFIX')}"
    with whole_file(library) as draft:
        compile_library(needed[:2], draft.name)
    return needed[3]


def load_built(main: str, files: Mapping[str, str], make: Callable[[Path], object]) -> ModuleType:
    """The module `main` of some files, compiled once a machine and kept in the user's cache folder.

    `make` compiles what is in a folder.
    """
    import numpy as np

    program, processor = Path(compiler()), [platform.processor()]
    with suppress(OSError):  # Linux lists the instructions that -march=native stands for
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        processor += [line for line in lines if line.startswith(("flags", "Features"))][:1]
    machine = sysconfig.get_config_var("EXT_SUFFIX"), sys.version, *processor
    depends = _FLAGS, _OF_THIS_PROCESSOR, str(program), program.stat().st_mtime_ns, *machine
    return load(main, files, make, *depends, np.__version__)


def compiler() -> str:
    """The compiler of the environment's CC, or the first that is installed; empty without one."""
    names = filter(None, (os.environ.get("CC"), *COMPILERS))
    return next(filter(None, map(shutil.which, names)), "")


def missing() -> str:
    """What compiling needs and is not installed here; empty if nothing is missing."""
    if not compiler():
        return f"a C compiler ({', '.join(COMPILERS)})"
    header = Path(sysconfig.get_paths()["include"], "Python.h")  # Debian: in python3-dev
    return "" if header.is_file() else f"Python's header {header}"


def compile_library(sources: Sequence[Path], library: str) -> None:
    """A shared library of C sources. Raises MissingTool and ToolFailed as `build` does."""
    import numpy as np

    if tools := missing():
        raise MissingTool(
            f"a Python module of C functions needs {tools}, which is not installed; "
            f"on Debian: apt install gcc python3-dev"
        )
    folders = sysconfig.get_paths()["include"], np.get_include()
    files = [*(f"-I{folder}" for folder in folders), *map(str, sources), "-o", library, "-lm"]
    plain = [compiler(), *_FLAGS, *files]
    for command in ([*plain, *_OF_THIS_PROCESSOR], plain):
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", timeout=TIMEOUT
            )
        except subprocess.TimeoutExpired as error:
            raise ToolFailed(f"the C compiler was stopped after {TIMEOUT:g} seconds") from error
        if not done.returncode:
            return
    log = "\n".join(done.stderr.splitlines()[-_LOG_LINES:]) or f"exit code {done.returncode}"
    raise ToolFailed(f"the C compiler stopped; the end of what it says:\n{log}")
