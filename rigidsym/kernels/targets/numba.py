"""Kernels as a Python module that Numba compiles: the NumPy module over compiled functions.

Each kernel is printed once, over floats: of one orientation, which other compiled functions can
call, and in a loop over columns. The loop takes sines without a branch, so that it becomes vector
instructions, and computes the orientations with an angle too large for them anew.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import ModuleType

from rigidsym.kernels import loaded
from rigidsym.kernels.ir import Call, Kernel, Program
from rigidsym.kernels.targets import numpy, python
from rigidsym.kernels.targets.precision import DOUBLE
from rigidsym.kernels.targets.python import bracketed

RESERVED = numpy.RESERVED | {"njit", "sin_cos", "values", "lost"}
_WORDS = {
    **{"atan2": "_angle_of({})", "nan": "np.nan", "eps": "eps", "or_nan": "_or_nan({})"},
    "limit0": "2.0**-970 if eps < 2.0**-50 else 2.0**-103",  # the least normal number over eps
    **{"limit1": "eps * {}", "limit2": "eps * eps * {}"},
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = program.kernels
    functions = []
    for kernel in kernels:
        core = bracketed(0, f"def _{kernel.name}(", ["sin_cos", "eps", *kernel.components], "):")
        given = ["_sin_cos", f"{2.0**-52!r}", *kernel.components]
        one = bracketed(4, f"values = _{kernel.name}(", given, ")")
        values = [f"values[{k}]" for k in range(len(kernel.outputs))]
        twin = f"    return {numpy.nested(values, kernel.shape, 4, is_open=True)}"
        twins = [
            "\n".join(["@_jit", numpy.twin_head(kernel), one, twin]),
            "\n".join(["@_inlined", core, *_body(kernel)]),
            "\n".join(["@_jit", *_rows(kernel)]),
        ]
        body = numpy.called(kernel, f"_{kernel.name}_rows", f"{kernel.name}_scalar")
        functions.append(numpy.function(kernel, body, "\n\n\n".join(twins)))
    text = numpy.module_text(
        program,
        "numba/module.py.jinja",
        functions,
        of_math={"sin", "cos", "sqrt"},
        double=DOUBLE.filled(program.last),
        orders=", ".join(f"c{k}" for k in range(program.orders)) if program.has_series else "",
    )
    return {f"{program.name}_numba.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself."""
    return loaded.load(f"{name}_numba", files)


def _body(kernel: Kernel) -> Iterator[str]:
    """The statements over floats, and all values in one tuple."""
    for name, value in kernel.statements:
        match value:
            case dict():  # all functions c_k of one square
                calls = list(value.items())
                yield f"    values = _entire(sin_cos, {calls[0][1].argument.text})"
                yield from (f"    {each} = values[{call.order}]" for each, call in calls)
            case Call("sin" | "cos", angle):
                both = kernel.sines[angle]
                if len(both) == 1:
                    place = 0 if value.function == "sin" else 1
                    yield f"    {name} = sin_cos({angle.text})[{place}]"
                elif name == next(iter(both.values())):
                    yield f"    {both['sin']}, {both['cos']} = sin_cos({angle.text})"
            case _:
                yield python.statement(4, name, value, _WORDS)
    outputs = numpy.outputs(kernel, 8)
    yield f"    return {numpy.nested(outputs, (len(outputs),), 4, is_open=True)}"


def _rows(kernel: Kernel) -> Iterator[str]:
    """The loop over columns."""
    vectors = [argument.name for argument in kernel.arguments]
    columns = [f"{a.name}[{k}, i]" for a in kernel.arguments for k in range(len(a.components))]
    loop = "for i in range(out.shape[1]):"
    yield bracketed(0, f"def _{kernel.name}_rows(", [*vectors, "out", "eps"], "):")
    yield f"    lost = False\n    {loop}"
    yield bracketed(8, f"values = _{kernel.name}(", ["_sin_cos_near", "eps", *columns], ")")
    yield "        lost |= _give(values, out, i)"
    # A second loop for the orientations that the first one, without a branch, left as NaN.
    yield f"    if lost:\n        {loop}\n            if np.any(np.isnan(out[:, i])):"
    yield bracketed(16, f"values = _{kernel.name}(", ["_sin_cos", "eps", *columns], ")")
    yield "                _give(values, out, i)"
