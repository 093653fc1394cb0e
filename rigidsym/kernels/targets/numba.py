"""Kernels as a Python module that Numba compiles: the NumPy module with compiled blocks."""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType

from rigidsym.kernels import loaded
from rigidsym.kernels.ir import Choice, Program, functions_of, last_order
from rigidsym.kernels.targets import numpy
from rigidsym.kernels.targets.precision import DOUBLE

RESERVED = numpy.RESERVED | {"njit", "types"}
_WORDS = {
    **numpy.OF_ARRAYS,
    **{"atan2": "_arctan2", "choice": "_where({0}, {1}, {2})"},
    **{"eps": "_eps_of({}, eps=_eps)", "or_nan": "_or_nan_of({}, eps=_eps)"},
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    last, called = last_order(program.kernels), functions_of(program.kernels)
    values = [a.value for kernel in program.kernels for a in kernel.assignments]
    compiled = []  # loops over the columns of vectors
    for kernel in program.kernels:
        widths = {argument.name: len(argument.components) for argument in kernel.arguments}
        columns = [f"_take({name}, _i, {width})" for name, width in widths.items()]
        columns += ["_eps"] if numpy.needs_eps(kernel) else []
        compiled.append(
            {"name": kernel.name, "vectors": ", ".join(widths), "taken": ", ".join(columns)}
        )
    text = numpy.module_text(
        program,
        "numba/module.py.jinja",
        words=_WORDS,
        double=DOUBLE.filled(last),
        orders=", ".join(f"c{k}" for k in range(max(last, 2) + 1)) if last >= 0 else "",
        has_arctangents="atan2" in called,
        has_choices=any(isinstance(value, Choice) for value in values),
        kernels=compiled,
    )
    return {f"{program.name}_numba.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself."""
    return loaded.load(f"{name}_numba", files)
