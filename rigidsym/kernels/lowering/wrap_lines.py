"""Kernels whose every line fits a page: what is too wide for one line gets a name of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rigidsym.kernels.ir import (
    Assignment,
    Compare,
    Expression,
    Kernel,
    Name,
    Negative,
    Product,
    Sum,
    parts,
    rebuilt,
)
from rigidsym.kernels.lowering.naming import Names

_BETWEEN = len(" = ")
_MANY_TERMS = 6  # of a sum that is written in several


def narrowed(
    kernel: Kernel, show: Callable[[Expression], str], *, line: int, output: int
) -> Kernel:
    """The same kernel, the same operations, in lines that fit.

    `show` is how the target writes an expression; an assignment takes at most `line` characters
    and an output at most `output`. The widest part of a wide line is named first, of a sum of many
    terms the first of them; an assignment of long names alone stays as wide as it is.
    """
    narrower = _Narrower(kernel, show, line)
    for assignment in kernel.assignments:
        narrower.assign(assignment.name, assignment.value)
    outputs = tuple(narrower.output(value, output) for value in kernel.outputs)
    assignments = tuple(narrower.assignments)
    if (assignments, outputs) == (kernel.assignments, kernel.outputs):
        return kernel
    return replace(kernel, assignments=assignments, outputs=outputs)


class _Narrower:
    def __init__(self, kernel: Kernel, show: Callable[[Expression], str], line: int) -> None:
        self.assignments: list[Assignment] = []
        self._names = Names([*kernel.components, *(a.name for a in kernel.assignments)])
        self._show = show
        self._line = line

    def assign(self, name: str, value: Expression) -> None:
        room = self._line - len(name) - _BETWEEN
        self.assignments.append(Assignment(name, self.shortened(value, room)))

    def output(self, value: Expression, room: int) -> Expression:
        """An output in at most `room` characters, as a name where it must be."""
        short = self.shortened(value, room)
        if isinstance(short, Name) or len(self._show(short)) <= room:
            return short
        name = self._names.numbered("x")
        self.assign(name, short)
        return Name(name)

    def shortened(self, expression: Expression, room: int) -> Expression:
        """The expression in at most `room` characters, after assignments for its widest parts."""
        while len(self._show(expression)) > room:
            if isinstance(expression, Sum) and len(expression.terms) > _MANY_TERMS:
                expression = self._begun(expression)
                continue
            wide = [part for part in _operands(expression) if isinstance(part, Sum | Product)]
            if not wide:
                break
            widest = max(wide, key=lambda part: len(self._show(part)))
            name = self._names.numbered("x")
            self.assign(name, widest)
            expression = _replaced(expression, widest, Name(name))
        return expression

    def _begun(self, total: Sum) -> Sum:
        """A sum of many terms after an assignment for as many of its first terms as fit in one."""
        name = self._names.numbered("x")
        room, count = self._line - len(name) - _BETWEEN, len(total.terms) - 1
        while count > 2 and len(self._show(Sum(total.terms[:count]))) > room:
            count -= 1
        self.assign(name, Sum(total.terms[:count]))
        return Sum((Name(name), *total.terms[count:]))


def _operands(expression: Expression) -> tuple[Expression, ...]:
    """The parts of an expression, without their signs."""
    whole = expression.operand if isinstance(expression, Negative) else expression
    each = [part for p in parts(whole) for part in (parts(p) if isinstance(p, Compare) else (p,))]
    return tuple(p.operand if isinstance(p, Negative) else p for p in each)


def _replaced(expression: Expression, old: Expression, new: Expression) -> Expression:
    """The expression with one of its operands exchanged."""

    def exchanged(part: Expression) -> Expression:
        if part == old:
            return new
        return rebuilt(exchanged, part) if isinstance(part, Negative | Compare) else part

    if isinstance(expression, Negative):
        return Negative(_replaced(expression.operand, old, new))
    return new if expression == old else rebuilt(exchanged, expression)
