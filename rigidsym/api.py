"""The Python face: `derive` gives a Motion, which prints its own kernels and its own note."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from rigidsym.derive import kinematics
from rigidsym.derive.derivation import Derivation
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

        Raises TargetError for an unknown target.
        """
        from rigidsym.kernels.module import generate

        return generate(self, target)

    def note(self) -> Note:
        """The document that shows the derivation: `.latex()`."""
        from rigidsym.notes.note import note

        return note(self)


def derive(model: RotationModel) -> Motion:
    """The proved kinematics of a rotation model; see `rigidsym.derive.kinematics.derive`."""
    derivation = kinematics.derive(model)
    return Motion(**{field.name: getattr(derivation, field.name) for field in fields(derivation)})
