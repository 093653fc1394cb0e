"""A derivation as a module of functions: the way into this folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from rigidsym.kernels.conversions import lower_conversions
from rigidsym.kernels.lower import lower
from rigidsym.kernels.targets import TARGETS, printer
from rigidsym.mechanics.conversions import conversions_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.writing import write_text


@dataclass(frozen=True, kw_only=True, slots=True)
class KernelModule:
    """The functions of one derivation, as the text of one file."""

    name: str  # of the derivation, and of the file without its ending
    target: str
    source: str

    @property
    def ending(self) -> str:
        """Of the file, without a dot: "py"."""
        return TARGETS[self.target].ending

    def load(self) -> ModuleType:
        """The functions as a Python module, without a file."""
        return printer(self.target).load(self.name, self.source)

    def write(self, path: str | Path) -> Path:
        """Write the file, whole or not at all, and return its path.

        In a folder that exists, the file takes the name of the derivation.
        """
        place = Path(path)
        return write_text(
            place / f"{self.name}.{self.ending}" if place.is_dir() else place, self.source
        )


def generate(
    derivation: Derivation, target: str = "numpy", *, conversions: bool = False
) -> KernelModule:
    """The kernels of all quantities of a derivation, for one target.

    `conversions` adds those between the coordinates, the unit quaternion and the matrix. Raises
    KernelError for an unknown target, and for an expression that kernels cannot hold.
    """
    chosen = printer(target)
    program = lower(derivation, chosen.RESERVED)
    converting = None
    if conversions:
        converting = lower_conversions(
            derivation, conversions_of(derivation.model), chosen.RESERVED
        )
    source = chosen.render(program, converting)
    return KernelModule(name=derivation.name, target=target, source=source)
