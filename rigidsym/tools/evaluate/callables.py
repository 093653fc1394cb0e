"""The functions that `eval` can call: quantities of a derivation, and conversions."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from rigidsym.errors import QuantityError, RequestError
from rigidsym.motion import KernelModule, Motion
from rigidsym.tools.evaluate.work import ResultColumn, Work

CONVERSIONS = ("quaternion", "from_quaternion", "from_rotation_matrix")


@dataclass(frozen=True, slots=True)
class FunctionArgument:
    """A vector or matrix that a function takes, with a name and a unit for each component."""

    name: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    shape: tuple[int, ...] = (-1,)


_QUATERNION = FunctionArgument("quaternion", ("qw", "qx", "qy", "qz"), ("",) * 4)
_ENTRIES = ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")
_MATRIX = FunctionArgument("matrix", _ENTRIES, ("",) * 9, (3, 3))


def derived_for(names: Sequence[str]) -> tuple[str, ...]:
    """The quantities to derive for some functions."""
    return tuple(name for name in names if name not in CONVERSIONS) or ("rotation_matrix",)


def functions_of(
    motion: Motion, names: Sequence[str], target: str, *, degrees: bool
) -> tuple[Work, tuple[FunctionArgument, ...]]:
    """Some functions of a motion, which has derived what they need, and all their arguments.

    Raises QuantityError for an unknown name, and RequestError for a quantity without inputs.
    """
    chosen = motion.select(derived_for(names))
    kernels = chosen.kernels(target, conversions=not {*CONVERSIONS}.isdisjoint(names))
    calls = tuple((name, _inputs(chosen, kernels, name)) for name in names)
    wanted = {argument for _, taken in calls for argument in taken}
    of_motion = [FunctionArgument(a.name, a.names, a.units) for a in chosen.arguments]
    outputs = tuple(
        ResultColumn(name, unit, degrees and is_angle(unit))
        for function in names
        for name, unit in _results(chosen, function)
    )
    known = (*of_motion, _QUATERNION, _MATRIX)
    arguments = tuple(argument for argument in known if argument.name in wanted)
    return Work(kernels=kernels, calls=calls, outputs=outputs), arguments


def is_angle(unit: str) -> bool:
    """Whether a unit holds radians: rad, rad/s, rad/s^2."""
    return unit.split("/")[0] == "rad"


def _inputs(motion: Motion, kernels: KernelModule, name: str) -> tuple[str, ...]:
    if name not in CONVERSIONS:
        if not (inputs := motion.step(name).quantity.inputs):
            raise RequestError(f"{name} takes no input: it is the same for every row")
        return inputs
    function = getattr(kernels.load(), name, None)
    if function is None:
        raise QuantityError(f"this rotation has no function {name}")
    taken = [
        p.name for p in inspect.signature(function).parameters.values() if p.kind != p.KEYWORD_ONLY
    ]
    first = {"from_quaternion": "quaternion", "from_rotation_matrix": "matrix"}.get(name, taken[0])
    return (first, *taken[1:])


def _results(derivation: Motion, name: str) -> Iterable[tuple[str, str]]:
    """The names and units of the columns of a result, entries row by row."""
    if name == "quaternion":
        return zip(_QUATERNION.names, _QUATERNION.units, strict=True)
    of_coordinates = {"from_quaternion": "q", "from_rotation_matrix": "q"}
    of_coordinates |= {f"rates_from_angular_velocity_{f}": "q_dot" for f in ("space", "body")}
    if name in of_coordinates:
        argument = derivation.argument(of_coordinates[name])
        return zip(argument.names, argument.units, strict=True)
    step = derivation.step(name)
    indices = product(*(range(1, size + 1) for size in step.shape))
    names = ["_".join(filter(None, [name, "".join(map(str, index))])) for index in indices]
    return [(each, step.quantity.unit) for each in names]
