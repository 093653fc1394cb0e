"""Kernels as a Python module that Numba compiles: the NumPy module over compiled functions.

Each kernel is printed once, over floats: of one orientation, which other compiled functions can
call, and in a loop over columns. The loop takes sines without a branch, so that it becomes vector
instructions, and computes the orientations with an angle too large for them anew.
"""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.kernels.ir import Call, Kernel, Program
from rigidsym.kernels.targets import numpy, python
from rigidsym.kernels.targets.precision import DOUBLE
from rigidsym.kernels.targets.python import bracketed
from rigidsym.system import resources

RESERVED = numpy.RESERVED | {"njit", "sin_cos", "values", "lost"}
_WORDS = {
    **{"atan2": "_angle_of({})", "nan": "np.nan", "eps": "eps", "or_nan": "_or_nan({})"},
    "limit0": "2.0**-970 if eps < 2.0**-50 else 2.0**-103",  # the least normal number over eps
    **{"limit1": "eps * {}", "limit2": "eps * eps * {}"},
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = program.kernels
    template = resources.environment().get_template("numba/twins.py.jinja")
    twins = {}
    for kernel in kernels:
        values = [f"values[{k}]" for k in range(len(kernel.outputs))]
        columns = [f"{a.name}[{k}, i]" for a in kernel.arguments for k in range(len(a.components))]
        text = template.render(
            kernel=kernel,
            bracketed=bracketed,
            head=numpy.twin_head(kernel),
            twin=numpy.nested(values, kernel.shape, 4, is_open=True),
            body="\n".join(_body(kernel)),
            columns=columns,
        )
        twins[kernel.name] = text.rstrip()
    text = numpy.module_text(
        program,
        "numba/module.py.jinja",
        {k.name: numpy.called(k, f"_{k.name}_rows", f"{k.name}_scalar") for k in kernels},
        twins,
        of_math={"sin", "cos", "sqrt"},
        double=DOUBLE.filled(program.last),
        orders=", ".join(f"c{k}" for k in range(program.orders)) if program.has_series else "",
    )
    return {f"{program.name}_numba.py": text}


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
