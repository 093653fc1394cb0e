"""The targets that kernels can be printed for: one file and one template each.

The file defines `RESERVED`, the words of its language that no name may be, `render(program,
conversions)`, the texts of its files by their names, the main one first, and `load(name, files)`,
a Python module of the functions. It is imported when it is asked for.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Protocol, cast

from rigidsym.errors import KernelError
from rigidsym.kernels.ir import Program

if TYPE_CHECKING:
    from rigidsym.kernels.conversions.conversions import ConversionProgram


@dataclass(frozen=True, kw_only=True, slots=True)
class Target:
    """One language that kernels are printed in, and what loading them needs, printing not."""

    about: str
    ending: str  # of the main file, behind the name of the derivation
    package: str = ""  # of Python, which the extra of the target's name brings
    programs: tuple[str, ...] = ()  # of which one will do
    has_single: bool = True  # whether its functions know single precision

    @property
    def missing(self) -> str:
        """What is not installed here of what loading needs; empty where nothing is."""
        if self.package and find_spec(self.package) is None:
            return f"the package {self.package}"
        if self.programs and not any(map(shutil.which, self.programs)):
            return f"one of {', '.join(self.programs)}"
        return ""


TARGETS: Mapping[str, Target] = MappingProxyType(
    {
        "numpy": Target(about="NAME.py: a Python module that needs NumPy alone", ending=".py"),
        "c": Target(
            about="NAME.h, NAME.c: C99; rigidsym build makes the Python module NAME_c.py",
            ending=".c",
            programs=("cc", "gcc", "clang"),
        ),
        "numba": Target(
            about="NAME_numba.py: a Python module that Numba compiles",
            ending="_numba.py",
            package="numba",
        ),
        "javascript": Target(
            about="NAME.mjs: an ES module without dependencies",
            ending=".mjs",
            programs=("node",),
            has_single=False,
        ),
        "jax": Target(
            about="NAME_jax.py: a Python module for JAX; jit, vmap, grad",
            ending="_jax.py",
            package="jax",
        ),
    }
)


class Printer(Protocol):
    """What the file of a target defines."""

    RESERVED: frozenset[str]

    def render(
        self, program: Program, conversions: ConversionProgram | None = None
    ) -> Mapping[str, str]: ...

    def load(self, name: str, files: Mapping[str, str]) -> ModuleType: ...


def check_target(target: str) -> None:
    """Raises KernelError, naming the targets that there are, where this is none of them."""
    if target not in TARGETS:
        raise KernelError(f"no target {target!r}; there is {', '.join(TARGETS)}")


def printer(target: str) -> Printer:
    """The file of a target; raises KernelError where there is none of this name."""
    check_target(target)
    return cast(Printer, import_module(f"{__name__}.{target}.printer"))
