"""Kernels as a Python module that Numba compiles: the NumPy module with compiled blocks."""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType

from rigidsym.errors import MissingExtra
from rigidsym.kernels import loaded
from rigidsym.kernels.ir import Choice, Kernel, Program, functions_of, last_order
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text.precision import DOUBLE

TEMPLATE = "numba/module.py.jinja"
RESERVED = numpy.RESERVED | {"njit", "types"}
_BLOCK = numpy.BLOCK._replace(
    functions={**numpy.BLOCK.functions, "atan2": "_arctan2", "eps": "_eps_of"},
    guard="_or_nan_of",
    where="_where",
    eps="_eps",
)


def render(program: Program) -> dict[str, str]:
    """The module."""
    last, called = last_order(program.kernels), functions_of(program.kernels)
    values = [a.value for kernel in program.kernels for a in kernel.assignments]
    text = numpy.module_text(
        program,
        TEMPLATE,
        block=_BLOCK,
        double=DOUBLE.filled(last),
        orders=", ".join(f"c{k}" for k in range(max(last, 2) + 1)) if last >= 0 else "",
        has_arctangents="atan2" in called,
        has_eps="eps" in called,
        has_choices=any(isinstance(value, Choice) for value in values),
        has_guards=any(kernel.guards for kernel in program.kernels),
        kernels=list(map(_compiled, program.kernels)),
    )
    return {f"{program.name}_numba.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra without Numba."""
    if TARGETS["numba"].missing:
        raise MissingExtra("a module that Numba compiles", "numba")
    return loaded.load(f"{name}_numba", files)


def _compiled(kernel: Kernel) -> dict[str, str]:
    """The loop over the columns of its vectors."""
    widths = {argument.name: len(argument.components) for argument in kernel.arguments}
    taken = [f"_take({name}, _i, {width})" for name, width in widths.items()]
    taken += ["_eps"] if numpy.needs_eps(kernel) else []
    return {"name": kernel.name, "vectors": ", ".join(widths), "taken": ", ".join(taken)}
