"""The same orientation in other conventions: their coordinates from R, and their turns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets.javascript import printer as javascript
from rigidsym.mechanics.conversions.conversion_functions import from_matrix
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.conversions.function import Converted
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.rotation import RotationModel
from rigidsym.models.rotation_text import rotation_from
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.page.stage import has_turns, label, stage_of, turns_step

_COMPARED = ("ZXZ", "ZYX", "unit_quaternion", "rotation_vector")
_TITLES = {"unit_quaternion": "Quaternion", "rotation_vector": "Rotation vector"}


def others(model: RotationModel) -> Iterator[tuple[dict[str, Any], tuple[Kernel, ...]]]:
    """What the script needs of each other convention, and the functions behind it."""
    for name in _COMPARED:
        if _model(name).matrix != model.matrix:
            yield _other(name)


_model = cache(rotation_from)


@cache
def _other(name: str) -> tuple[dict[str, Any], tuple[Kernel, ...]]:
    """Of one convention, once for all pages; nothing is derived, since no quantity is shown."""
    model = _model(name)
    derivation = Derivation(
        name=model.name,
        title=model.title,
        model=model,
        arguments=arguments_of(model),
        steps=(turns_step(model),) if has_turns(model) else (),
        singularities=None,
    )
    return _data(name, derivation), tuple(_kernels(name, derivation))


def _data(name: str, derivation: Derivation) -> dict[str, Any]:
    q = derivation.argument("q")
    letters = letters_of(derivation.arguments)
    are_angles = has_turns(derivation.model)
    return {
        "key": name,
        "title": _TITLES.get(name, name),
        "names": [label(symbol) for symbol in q.notation],
        "unit": "°" if are_angles else "",
        "factor": pi / 180 if are_angles else 1.0,
        "scene": stage_of(derivation.model, letters),
    }


def _kernels(name: str, derivation: Derivation) -> Iterator[Kernel]:
    inverse = Conversions(derivation.model).inverse
    assert inverse is not None
    added = Converted(functions=(from_matrix(derivation, inverse),))
    for kernel in lower(derivation, javascript.RESERVED, added=added).kernels:
        yield replace(kernel, name=f"{kernel.name.removesuffix('_rotation_matrix')}_{name}")
