"""The targets that kernels can be printed for: one file and one template each.

The file defines `RESERVED`, the words of its language that no name may be, `render(program)`, the
text of a module, and `load(name, source)`, the module itself. It is imported when it is asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import Protocol, cast

from rigidsym.errors import KernelError
from rigidsym.kernels.conversions import ConversionProgram
from rigidsym.kernels.ir import Program


@dataclass(frozen=True, kw_only=True, slots=True)
class Target:
    """One language that kernels are printed in."""

    about: str
    ending: str  # of the file, without a dot


TARGETS: Mapping[str, Target] = MappingProxyType(
    {"numpy": Target(about="a Python module that needs NumPy alone", ending="py")}
)


class Printer(Protocol):
    """What the file of a target defines."""

    RESERVED: frozenset[str]

    def render(self, program: Program, conversions: ConversionProgram | None = None) -> str: ...

    def load(self, name: str, source: str) -> ModuleType: ...


def printer(target: str) -> Printer:
    """The file of a target; raises KernelError, naming those there are, where there is none."""
    if target not in TARGETS:
        raise KernelError(f"no target {target!r}; there is {', '.join(TARGETS)}")
    return cast(Printer, import_module(f"{__name__}.{target}"))
