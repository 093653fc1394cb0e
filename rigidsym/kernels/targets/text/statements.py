"""The statements of a kernel as printers take them: calls, guarded divisors, groups of c_k."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan

from rigidsym.kernels.ir import Call, Expression, Guarded, Kernel, Name, Number, walk

Value = Expression | dict[str, Call]  # of an assignment, or the functions c_k of one square


def calls_of(kernel: Kernel) -> dict[str, Call]:
    """name: call, of the assignments that are calls."""
    return {a.name: a.value for a in kernel.assignments if isinstance(a.value, Call)}


def guards_of(kernel: Kernel) -> dict[str, Guarded]:
    """name: guarded value, of the assignments that are one."""
    return {a.name: a.value for a in kernel.assignments if isinstance(a.value, Guarded)}


def grouped(kernel: Kernel) -> Iterator[tuple[str, Value]]:
    """The assignments, with all functions c_k of one square in the place of the first."""
    groups: dict[Name, dict[str, Call]] = {}
    for name, call in calls_of(kernel).items():
        if call.order is not None:
            groups.setdefault(call.argument, {})[name] = call
    for assignment in kernel.assignments:
        value = assignment.value
        if not isinstance(value, Call) or value.order is None:
            yield assignment.name, value
        elif assignment.name == next(iter(groups[value.argument])):
            yield assignment.name, groups[value.argument]


def calls(kernel: Kernel, function: str) -> bool:
    """Whether it calls a function."""
    return any(call.function == function for call in calls_of(kernel).values())


def gives_nan(kernel: Kernel) -> bool:
    """Whether NaN is among its numbers."""
    wholes = [*(assignment.value for assignment in kernel.assignments), *kernel.outputs]
    nodes = (node for whole in wholes for node in walk(whole))
    return any(isinstance(node, Number) and isnan(node.value) for node in nodes)


def last_order(kernels: Sequence[Kernel]) -> int:
    """The highest k of the functions c_k that are called; -1 where there are none."""
    orders = (call.order for kernel in kernels for call in calls_of(kernel).values())
    return max((order for order in orders if order is not None), default=-1)


def kinds(kernel: Kernel) -> Iterator[str]:
    """What kinds of divisors are guarded."""
    calls = calls_of(kernel)
    for guard in guards_of(kernel).values():
        call = calls.get(guard.value.text)
        if call is not None:
            yield "angle" if call.order is None else "length"
        else:
            yield "squares" if guard.scale is None else {1: "sum", 2: "minors"}[guard.power]
