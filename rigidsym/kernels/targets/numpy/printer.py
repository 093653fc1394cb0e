"""Kernels as a Python module that imports NumPy alone, with scalar twins on plain floats."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from types import ModuleType

from rigidsym.algebra.series import FIRST_SERIES
from rigidsym.kernels.ir import FUNCTIONS, Call, Choice, Guarded, Kernel, Program
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.numpy.function import OPTIONS, NumpyFunction
from rigidsym.kernels.targets.numpy.unwrap import unwrap_text
from rigidsym.kernels.targets.text import python, remarks, statements
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python_layout import (
    WIDTH,
    assignment_lines,
    bracketed,
    docstring,
    exploded,
)
from rigidsym.system import resources

TEMPLATE = "numpy/module.py.jinja"
RESERVED = python.RESERVED | {"np", "tan", "ValueError", "ZeroDivisionError"}

_MATH: Mapping[str, str] = {name: name for name in FUNCTIONS}
_show = partial(infix, functions=_MATH)


def render(program: Program) -> dict[str, str]:
    """The module."""
    return {f"{program.name}.py": module_text(program)}


def module_text(
    program: Program,
    template: str = TEMPLATE,
    *,
    compute: str = "_compute",
    at_once: str = "",
    **more: object,
) -> str:
    """The text of a module, in a template that may extend this one and needs more.

    `compute` is the function there that computes all orientations, `at_once` that of each kernel
    which is tried first.
    """
    kernels = list(map(_fitted, program.kernels))
    unwrap = [unwrap_text(program.unwrapping, _block)] if program.unwrapping else []
    exports = [*_exports(kernels), *(["unwrap"] if unwrap else [])]
    placed = resources.environment().get_template(template)
    return placed.render(
        about=docstring(_about(program)),
        imports=_import(_imports(kernels)),
        exports=python.lines(f'"{name}",' for name in sorted(exports)),
        components=python.lines(map(python.entry, program.arguments)),
        functions=[_function(kernel, at_once) for kernel in kernels],
        has_parts=any(kernel.parts for kernel in kernels),
        helpers="".join(f"\n\n{text}" for text in (*_helpers(kernels), *unwrap)),
        compute=compute,
        **more,
    )


def _import(names: set[str]) -> str:
    """The line for `math`."""
    return f"from math import {', '.join(sorted({'prod', *names}))}\n\n"


def _imports(kernels: Sequence[Kernel]) -> set[str]:
    """What the scalar twins need of `math`."""
    calls = (call for kernel in kernels for call in statements.calls_of(kernel).values())
    functions = {call.function for call in calls}
    named = functions.intersection(FUNCTIONS)
    if any(map(statements.gives_nan, kernels)):
        named.add("nan")
    return (named - {"abs", "eps"}) | ({"sqrt", "tan"} if functions - named else set())


def _helpers(kernels: Sequence[Kernel]) -> list[str]:
    """The functions behind guards and series, if the kernels need them."""
    environment = resources.environment()
    found = []
    if any(map(statements.guards_of, kernels)):
        found.append(environment.get_template("numpy/divisors.py").render())
    last = statements.last_order(kernels)
    if last >= 0:
        table = [f"{python.series_entry(order)}\n" for order in range(FIRST_SERIES, last + 1)]
        series = f"{{\n{''.join(table)}}}" if table else "{}"
        found.append(environment.get_template("numpy/series.py.jinja").render(series=series))
    return found + [f"{text}\n" for text in python.helpers(kernels, "numpy")]


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; it is not entered in `sys.modules`."""
    (source,) = files.values()
    return python.module_from(name, source)


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit: a scalar twin's assignments and the rows of its outputs."""
    deepest = 8 + 4 * len(kernel.shape)
    return narrowed(kernel, _show, line=WIDTH - 8, output=WIDTH - deepest - len(","))


def _exports(kernels: Sequence[Kernel]) -> Iterator[str]:
    for kernel in kernels:
        yield kernel.name
        yield f"{kernel.name}_scalar"


def _function(kernel: Kernel, at_once: str) -> NumpyFunction:
    block, scalar = f"_{kernel.name}", f"{kernel.name}_scalar"
    given = [python.passed(argument, "np") for argument in kernel.arguments]
    each = ((argument, name) for argument in kernel.arguments for name in argument.components)
    floats = [f"{name}{python.default(argument, '0.0')}" for argument, name in each]
    shape = str(kernel.shape)
    return NumpyFunction(
        signature=bracketed(0, f"def {kernel.name}(", [*python.taken(kernel), "*", *OPTIONS], "):"),
        about=docstring(python.about_kernel(kernel), indent=4),
        body=_body(
            kernel,
            [block, scalar, shape, *("out", "threads"), *given],
            at_once.format(kernel.name),
        ),
        ufunc=f'{kernel.name}.signature = "{python.ufunc(kernel)}"',
        scalar_signature=bracketed(0, f"def {scalar}(", floats, "):"),
        scalar_about=docstring(
            [f"`{kernel.name}` of one orientation; floats to {_nesting(kernel)}."], indent=4
        ),
        scalar_body="\n".join([*_scalar_lines(kernel), _scalar_return(kernel)]),
        exceptional=bracketed(8, "return _exceptional(", [block, shape, *kernel.components], ")"),
        block=_block(kernel),
    )


def _block(kernel: Kernel) -> str:
    """The function of arrays, one a component."""
    signature = bracketed(0, f"def _{kernel.name}(", kernel.components, "):")
    lines = _block_lines(_fitted(kernel))
    return "\n".join([signature, *lines, _tuple(4, "return ", _outputs(kernel))])


def _body(kernel: Kernel, arguments: Sequence[str], at_once: str) -> str:
    """The call that computes the result; several results are parts of one array.

    `at_once` is a function that may give the result, or None, with less ado.
    """
    result = "both" if kernel.parts else "result"
    lines = []
    if at_once:
        vectors = [argument.name for argument in kernel.arguments]
        lines = [
            f"    {result} = None",
            "    if threads == 1:",
            bracketed(8, f"{result} = {at_once}(", [*vectors, "out"], ")"),
            f"    if {result} is None:",
            bracketed(8, f"{result} = _apply(", arguments, ")"),
        ]
    elif kernel.parts:
        lines = [bracketed(4, f"{result} = _apply(", arguments, ")")]
    else:
        return bracketed(4, "return _apply(", arguments, ")")
    if kernel.parts:
        parts = [result, *map(str, kernel.parts)]
        return "\n".join([*lines, bracketed(4, "return _parted(", parts, ")")])
    return "\n".join([*lines, f"    return {result}"])


def _nesting(kernel: Kernel) -> str:
    return ("a float", "a tuple", "a tuple of rows")[len(kernel.shape)]


def _scalar_lines(kernel: Kernel) -> Iterator[str]:
    for name, value in statements.grouped(kernel):
        match value:
            case Call("eps"):
                yield f"        {name} = {2.0**-52!r}"
            case Call(function):
                yield python.call_line(8, name, function, value)
            case Choice():
                yield python.choice_lines(8, name, value)
            case Guarded():
                yield python.guard_line(8, name, value, "_or_nan_scalar")
            case dict():
                yield python.entire_line(8, value, "_entire_scalar")
            case _:
                yield assignment_lines(8, name, _show(value))


def _block_lines(kernel: Kernel) -> Iterator[str]:
    """The assignments on arrays, the sine and the cosine of one angle in one call."""
    pairs = _pairs(kernel)
    for name, value in statements.grouped(kernel):
        match value:
            case Guarded():
                yield python.guard_line(4, name, value, "_or_nan")
            case dict():
                yield python.entire_line(4, value, "_entire")
            case Call() if name in pairs:
                yield python.call_line(4, f"{name}, {pairs[name]}", "_sin_cos", value)
            case Call("sqrt" | "abs" | "atan2" as function):
                called = {"atan2": "arctan2"}.get(function, function)
                yield python.call_line(4, name, f"np.{called}", value)
            case Call("eps"):
                yield python.call_line(4, name, "_eps", value)
            case Choice():
                yield python.where_line(4, name, value, "np")
            case Call(function, argument):
                if name not in pairs.values():  # no cosine that came with its sine
                    yield python.call_line(4, name, f"_{function}", value)
                if function == "cos" and name in kernel.delicate:
                    yield bracketed(4, f"{name} = _sharp(", [name, argument.text], ")")
            case _:
                yield assignment_lines(4, name, _show(value))


def _pairs(kernel: Kernel) -> dict[str, str]:
    """sine: cosine of the angles of which both are needed."""
    calls = {call: name for name, call in statements.calls_of(kernel).items()}
    return {
        name: cosine
        for call, name in calls.items()
        if call.function == "sin" and (cosine := calls.get(Call("cos", call.argument))) is not None
    }


def _outputs(kernel: Kernel) -> list[str]:
    return [_show(output) for output in kernel.outputs]


def _scalar_return(kernel: Kernel) -> str:
    outputs = _outputs(kernel)
    if not kernel.shape:
        return f"        return {outputs[0]}"
    if len(kernel.shape) == 1:
        return _tuple(8, "return ", outputs)
    columns = kernel.shape[1]
    rows = [outputs[start : start + columns] for start in range(0, len(outputs), columns)]
    return _tuple(8, "return ", [_row(row) for row in rows])


def _row(items: Sequence[str]) -> str:
    """One row of a matrix: in a line where it fits, else an entry a line."""
    line = python.tuple_of(items)
    return line if len(line) <= WIDTH - 12 - len(",") else _tuple(12, "", items).lstrip()


def _tuple(indent: int, head: str, items: Sequence[str]) -> str:
    if len(items) == 1:
        return f"{' ' * indent}{head}({items[0]},)"
    return exploded(indent, f"{head}(", items, ")")


def _about(program: Program) -> list[str | Sequence[str]]:
    """The paragraphs of the module's docstring."""
    return [
        f"{program.title}: functions of NumPy arrays.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, with the components on the last axis, in radians and SI units:",
        python.about_arguments(program),
        "Leading axes broadcast; inputs need not be contiguous. The result is float32 if every "
        "argument is float32, else float64; integers are converted to float64. `out`, an array of "
        "the result's shape and dtype, is filled and returned; it may overlap the arguments. "
        "`threads` sets the number of worker threads (about 4 MB each). No warnings are issued. "
        "Each function has a twin `..._scalar` for one orientation in plain floats, and an "
        "attribute `signature`, its signature as a generalised ufunc.",
        *remarks.errors(program.kernels),
        *remarks.remarks(program.kernels),
        *program.remarks,
        remarks.GENERATED,
    ]
