"""A derivation with the theory before it: its equations go on where those of the theory end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rigidsym.errors import ModelError
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.lecture.theory import theory

# The equations of the lecture that these evaluate; what stands on the way to 16 has its number.
NUMBERS = {
    "rotation_rate": 15,
    "spin_matrix": 15,
    "angular_velocity_space": 16,
    "rotation_matrix": 17,
    "angular_velocity_body": 18,
}
NEEDED = ("rotation_matrix", "spin_matrix", "angular_velocity_space", "angular_velocity_body")
LAST = 18


def with_theory(derivation: Derivation) -> Derivation:
    """The theory, and the steps with the lecture's numbers; what follows is numbered from 19.

    Raises ModelError for a passive presentation, which the lecture does not have.
    """
    if derivation.model.passive:
        raise ModelError(
            f"{derivation.name}: the theory is that of active rotations; leave passive"
        )
    return replace(derivation, theory=theory(), steps=tuple(_numbered(derivation.steps)))


def _numbered(steps: Sequence[Step]) -> Iterator[Step]:
    number = LAST
    for step in steps:
        number += step.quantity.name not in NUMBERS
        yield replace(step, number=NUMBERS.get(step.quantity.name, number))
