"""The Python face: `derive` gives a Motion, which prints its own kernels and its own note."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from rigidsym.mechanics import kinematics
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.rotation import RotationModel

if TYPE_CHECKING:
    from rigidsym.kernels.module import KernelModule
    from rigidsym.notes.note import Note


@dataclass(frozen=True, kw_only=True)
class Motion(Derivation):
    """A derivation with its two ways out: functions and a document.

    It stands above kernels and notes, so that neither has to know of the other, and the
    derivation of neither.
    """

    def kernels(self, target: str = "numpy") -> KernelModule:
        """The module of functions for one target: `.source`, `.load()`, `.write(path)`.

        Raises KernelError for an unknown target.
        """
        from rigidsym.kernels.module import generate

        return generate(self, target)

    def note(self, *, with_kernels: bool = True) -> Note:
        """The document that shows the derivation: `.latex()`.

        `with_kernels` names the functions of the NumPy module beside their equations.
        """
        from rigidsym.notes.note import note

        return note(self, module=f"{self.name}.py" if with_kernels else None)


def derive(model: RotationModel) -> Motion:
    """The proved kinematics of a rotation model.

    Raises NotARotation for a matrix with R Rᵀ ≠ 1 or det R ≠ 1, showing what is left over, and
    AlgebraError for expressions that the ring cannot hold.
    """
    derivation = kinematics.derive(model)
    return Motion(**{field.name: getattr(derivation, field.name) for field in fields(derivation)})
