"""The two files that make a Python module of a C source: its interface, and its way into C."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rigidsym.kernels.ir import Kernel, Program
from rigidsym.kernels.targets import numpy
from rigidsym.kernels.targets.precision import PRECISIONS
from rigidsym.system import resources

_LETTERS = {"double": "NPY_DOUBLE", "float": "NPY_FLOAT"}


def module_files(program: Program, kernels: Sequence[Kernel]) -> dict[str, str]:
    """NAME_c.py, with the interface of the NumPy module, and NAME_module.c behind it."""
    environment = resources.environment()
    name = program.name
    functions = [_ufunc(kernel) for kernel in kernels]
    glue = environment.get_template("c/module.c.jinja").render(
        name=name,
        functions=functions,
        types=[(p.real, p.suffix) for p in PRECISIONS],
        most_types=max(len(function["types"].split(",")) for function in functions),
        most_arguments=max(function["arguments"] for function in functions),
    )
    face = numpy.module_text(
        program,
        "c/module.py.jinja",
        compute="_compute_compiled",
        at_once="_compiled.{}_at_once",
        empty="_compiled.empty(whole, dtype.num)",
        name=name,
    )
    return {f"{name}_c.py": face, f"{name}_module.c": glue}


def _ufunc(kernel: Kernel) -> dict[str, Any]:
    """A kernel as a generalised ufunc; a matrix is a vector of its rows."""
    inputs = ",".join(f"({len(argument.components)})" for argument in kernel.arguments)
    each = [_LETTERS[p.real] for p in PRECISIONS]
    return {
        "name": kernel.name,
        "arguments": len(kernel.arguments),
        "widths": ", ".join(str(len(a.components)) for a in kernel.arguments),
        "axes": len(kernel.shape),
        "shape": ", ".join(map(str, kernel.shape)) or "0",
        "entries": len(kernel.outputs),
        "places": range(len(kernel.arguments) + 1),  # of the arguments and the result
        "signature": f"{inputs}->({len(kernel.outputs)})",
        "types": ", ".join(t for t in each for _ in range(len(kernel.arguments) + 1)),
    }
