"""One kernel as a few lines of Python on plain floats, to be pasted anywhere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from rigidsym.kernels.ir import FUNCTIONS, Call, Guarded, Kernel, Name, Number
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.text import python, statements
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python_layout import (
    WIDTH,
    assignment_lines,
    bracketed,
    docstring,
    exploded,
)
from rigidsym.page.copy_series import orders_of

_show = partial(infix, functions={name: name for name in FUNCTIONS})


def python_of(kernel: Kernel, series: Mapping[str, str]) -> str:
    """Imports, the functions c_k that it may call, and the function."""
    fitted = narrowed(kernel, _show, line=WIDTH - 4, output=WIDTH - 13)
    imports = ", ".join(sorted(_imports(fitted)))
    head = [f"from math import {imports}\n\n"] if imports else []
    called = [f"{series['python']}\n"] if orders_of(kernel) else []
    return "\n".join([*head, *called, *_function(fitted), ""])


def _imports(kernel: Kernel) -> set[str]:
    calls = {call.function for call in statements.calls_of(kernel).values()}
    named = calls.intersection(FUNCTIONS) - {"abs"}
    guards = {"nan"} if statements.guards_of(kernel) else set()
    return named | guards | ({"sqrt", "tan"} if calls.difference(FUNCTIONS) else set())


def _function(kernel: Kernel) -> Iterator[str]:
    vectors = [argument.name for argument in kernel.arguments]
    yield bracketed(0, f"def {kernel.name}(", vectors, "):")
    yield f'    """{docstring([_about(kernel)], indent=4)}"""'
    for argument in kernel.arguments:
        yield bracketed(4, "(", argument.components, f",) = {argument.name}")
    for name, value in statements.grouped(kernel):
        match value:
            case Guarded():
                yield from _guard(name, value)
            case dict():
                yield python.entire_line(4, value, "_entire")
            case Call(function, angle):
                yield f"    {name} = {function}({angle.text})"
            case _:
                yield assignment_lines(4, name, _show(value))
    yield _returned(kernel)


def _about(kernel: Kernel) -> str:
    unit = f", in {kernel.unit}" if kernel.unit else ""
    return f"{kernel.symbol}: {kernel.about}{unit}."


def _guard(name: str, guard: Guarded) -> Iterator[str]:
    """What divides, or NaN where rounding leaves no digit of it."""
    match guard.scale:
        case Name(scale):
            least = f"2.0**{-52 * guard.power} * abs({scale})"
        case Number(number):
            least = f"2.0**{-52 * guard.power} * {float(number)!r}"
        case _:
            least = "2.0**-970"
    yield f"    {name} = {guard.value.text} if abs({guard.value.text}) > {least} else nan"


def _returned(kernel: Kernel) -> str:
    outputs = [_show(output) for output in kernel.outputs]
    if not kernel.shape:
        return f"    return {outputs[0]}"
    if len(kernel.shape) == 1:
        return exploded(4, "return (", outputs, ")")
    columns = kernel.shape[1]
    rows = [outputs[start : start + columns] for start in range(0, len(outputs), columns)]
    return exploded(4, "return (", [exploded(8, "(", row, ")").lstrip() for row in rows], ")")
