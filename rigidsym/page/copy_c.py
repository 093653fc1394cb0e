"""One kernel as a function in C99 on the functions of math.h, to be pasted anywhere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Expression,
    Guarded,
    Kernel,
    KernelArgument,
    Name,
    Number,
    names_in,
)
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.text import statements
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python_layout import WIDTH, bracketed, filled
from rigidsym.page.copy_series import orders_of

_show = partial(infix, functions={name: name for name in FUNCTIONS})


def c_of(kernel: Kernel, series: Mapping[str, str]) -> str:
    """The header that it needs, the functions c_k that it may call, and the function."""
    fitted = narrowed(kernel, _show, line=WIDTH - len("    const double ;"), output=WIDTH - 14)
    called = [f"{series['c']}\n"] if orders_of(kernel) else []
    return "\n".join(["#include <math.h>\n", *called, *_function(fitted), ""])


def _listed(head: str, items: list[str]) -> str:
    """Parameters between brackets; C takes no comma after the last."""
    return bracketed(0, head, items, ")").replace(",\n)", "\n)")


def _function(kernel: Kernel) -> Iterator[str]:
    yield from _about(kernel)
    given = [f"const double {a.name}[{len(a.components)}]" for a in kernel.arguments]
    result = f"double out[{len(kernel.outputs)}]"
    yield _listed(f"void {kernel.name}(", [*given, result])
    yield "{"
    used = {name for value in _expressions(kernel) for name in names_in(value)}
    for argument in kernel.arguments:
        yield from _taken(argument, used)
    for name, value in statements.grouped(kernel):
        yield from _assigned(name, value)
    for place, output in enumerate(kernel.outputs):
        yield f"    out[{place}] = {_show(output)};"
    yield "}"


def _about(kernel: Kernel) -> Iterator[str]:
    unit = f", in {kernel.unit}" if kernel.unit else ""
    rows = ", row by row" if len(kernel.shape) == 2 else ""
    text = "\n   ".join(filled(f"{kernel.symbol}: {kernel.about}{unit}{rows}.", WIDTH - 6))
    yield f"/* {text} */"


def _expressions(kernel: Kernel) -> Iterator[Expression]:
    yield from (assignment.value for assignment in kernel.assignments)
    yield from kernel.outputs


def _taken(argument: KernelArgument, used: set[str]) -> Iterator[str]:
    """The components that are used; a compiler warns of others."""
    taken = [
        f"{name} = {argument.name}[{place}]"
        for place, name in enumerate(argument.components)
        if name in used
    ]
    lines = filled(", ".join(taken), WIDTH - len("    const double ;"))
    if not taken:
        yield f"    (void){argument.name};"
    yield from (f"    const double {line.removesuffix(',')};" for line in lines)


def _assigned(name: str, value: statements.Value) -> Iterator[str]:
    match value:
        case dict():
            for called, call in value.items():
                yield f"    const double {called} = entire({call.order}, {call.argument.text});"
        case Guarded():
            least, given = _least(value), value.value.text
            yield f"    const double {name} = fabs({given}) > {least} ? {given} : NAN;"
        case Call(function, angle):
            called = "fabs" if function == "abs" else function
            yield f"    const double {name} = {called}({angle.text});"
        case _:
            yield f"    const double {name} = {_show(value)};"


def _least(guard: Guarded) -> str:
    """What is larger divides; in the rest rounding leaves no digit."""
    eps = repr(2.0 ** (-52 * guard.power))
    match guard.scale:
        case Name(scale):
            return f"{eps} * fabs({scale})"
        case Number(number):
            return f"{eps} * {float(number)!r}"
    return repr(2.0**-970)
