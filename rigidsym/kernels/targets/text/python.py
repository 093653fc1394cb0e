"""Text that all Python modules share: for NumPy, Numba, JAX and compiled modules.

It has the layout that `ruff format` gives it, so that no formatter need run.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Choice,
    Compare,
    Expression,
    Guarded,
    Kernel,
    KernelArgument,
    Program,
    functions_of,
    last_order,
    parts,
)
from rigidsym.kernels.targets.text.infix import guard_arguments, infix
from rigidsym.kernels.targets.text.remarks import Paragraph, about_kernel, filled, in_units, table
from rigidsym.system import resources

MANY = 8  # components
_UNWELCOME = ("l", "O", "I")  # linters refuse these names
RESERVED = frozenset({*FUNCTIONS, *_UNWELCOME, "nan", "max", "min"})
ARGUMENTS = "Arguments, with the components on the last axis, in radians and SI units:"


class Statements(NamedTuple):
    """How a library writes the assignments of a function."""

    indent: int
    functions: Mapping[str, str]  # its names for those of `ir.FUNCTIONS`
    guard: str = "_or_nan"
    series: str = "_entire"
    library: str = ""  # whose NaN a choice may hold; "" for Python's own `if`
    where: str = "{}.where"  # its function that chooses
    eps: str = ""  # a name for the eps of the result, which the values do not tell

    def text(self, name: str, value: Expression | dict[str, Call]) -> str:
        """One assignment, or that of all functions c_k of one square."""
        match value:
            case Call(function):
                return self.call(name, self.functions[function], value)
            case Choice() if self.library:
                values = [infix(part, {"nan": f"{self.library}.nan"}) for part in parts(value)]
                head = f"{name} = {self.where.format(self.library)}("
                return bracketed(self.indent, head, values, ")")
            case Choice():
                return self._choice(name, value)
            case Guarded():
                given = [*guard_arguments(value, "None"), *self._eps]
                return bracketed(self.indent, f"{name} = {self.guard}(", given, ")")
            case dict():
                return self._series(value)
        return assignment_lines(self.indent, name, infix(value))

    @property
    def _eps(self) -> list[str]:
        return [f"eps={self.eps}"] if self.eps else []

    def call(self, names: str, function: str, call: Call) -> str:
        given = [argument.text for argument in call.arguments]
        given += self._eps if call.function == "eps" else []
        return bracketed(self.indent, f"{names} = {function}(", given, ")")

    def _choice(self, name: str, choice: Choice) -> str:
        """x1 = x0 if x0 > 0.0 else 0.0, or the same in three lines."""
        condition, then, otherwise = (infix(part) for part in parts(choice))
        margin = " " * self.indent
        if extreme := _extreme(choice):
            return f"{margin}{name} = {extreme}({otherwise}, {then})"
        line = f"{margin}{name} = {then} if {condition} else {otherwise}"
        if len(line) <= WIDTH:
            return line
        inner = f"\n{margin}    "
        body = f"{inner}{then}{inner}if {condition}{inner}else {otherwise}"
        return f"{margin}{name} = ({body}\n{margin})"

    def _series(self, group: Mapping[str, Call]) -> str:
        """c1_x0, c2_x0 = _entire(x0, 1, 2)"""
        calls = sorted(group.items(), key=lambda named: named[1].order or 0)
        left = ", ".join(name for name, _ in calls) if len(calls) > 1 else f"({calls[0][0]},)"
        given = [calls[0][1].argument.text, *(str(call.order) for _, call in calls)]
        return bracketed(self.indent, f"{left} = {self.series}(", given, ")")


def _extreme(choice: Choice) -> str:
    """max or min, if the choice between a and b is max(b, a) or min(b, a), for NaN too."""
    condition, then, otherwise = parts(choice)
    if not isinstance(condition, Compare) or condition.relation not in ("<", ">"):
        return ""
    sides = parts(condition)
    if (then, otherwise) not in (sides, sides[::-1]):
        return ""
    return "max" if (condition.relation == ">") == (then == condition.left) else "min"


def series_entries(kernels: Iterable[Kernel], *, more: int = 0) -> str:
    """The table of series, a line each: k, the switch, c_{k-2}(0), and the coefficients."""
    lines = []
    for order in range(FIRST_SERIES, last_order(kernels) + more + 1):
        series = series_of(order)
        numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
        lines.append(exploded(4, f"{order}: (", [repr(float(n)) for n in numbers], "),"))
    return "\n".join(lines)


# arguments


def parameters(kernel: Kernel, *options: str) -> list[str]:
    """Of a function of arrays, with their types."""
    arrays = [f"{a.name}: ArrayLike" for a in kernel.arguments]
    return [*arrays, *(["*", *options] if options else [])]


def returned(kernel: Kernel) -> str:
    """The type of the result, or of the value and its derivative."""
    return "tuple[Array, Array]" if kernel.parts else "Array"


def passed(kernel: Kernel, library: str) -> list[str]:
    """What a function of arrays passes on: name=value."""
    values = []
    for argument in kernel.arguments:
        name = value = argument.name
        if argument.is_matrix:
            items = [f'"{name}"', name, str(argument.shape)]
            text = bracketed(8, f"{name}=_entries(", items, "),")
            value = text[text.index("=") + 1 : -1]
        if argument.is_scalar:
            value = f"{library}.asarray({name})[..., None]"
        values.append(f"{name}={value}")
    return values


def helpers(kernels: Sequence[Kernel], library: str) -> list[str]:
    """The functions for matrices, and for the spacing of floats, if the kernels need them."""
    has_matrix = any(a.is_matrix for kernel in kernels for a in kernel.arguments)
    has_eps = "eps" in functions_of(kernels)
    names = ["matrices.py"] * has_matrix + ["epsilon.py"] * has_eps
    return [f"{resources.text('templates', f'{library}/{name}').rstrip()}\n" for name in names]


# tables at the head of a module


def components(program: Program) -> str:
    """The table of components, a line each: "q": ("phi", "theta", "psi"),"""
    return lines(_components(argument) for argument in program.arguments)


def _components(argument: KernelArgument) -> str:
    names = [f'"{name}"' for name in argument.components]
    line = f'"{argument.name}": {tuple_of(names)},'
    if len(line) <= WIDTH - 4:
        return line
    return exploded(4, f'"{argument.name}": (', names, "),").lstrip()


def lines(items: Iterable[str]) -> str:
    return "\n".join(f"    {item}" for item in items)


def ufunc(kernel: Kernel) -> str:
    """A line of the table of signatures as generalised ufuncs: "f": "(3),(3)->(3)","""
    given, results = (
        ",".join(f"({','.join(map(str, shape))})" for shape in shapes)
        for shapes in ([a.shape for a in kernel.arguments], kernel.parts or (kernel.shape,))
    )
    return f'    "{kernel.name}": "{given}->{results}",'


# docstrings


def about_arguments(program: Program) -> list[str]:
    """Lines that describe the arguments of all functions."""
    return table([(a.name, _leading(a.shape), a.about) for a in program.arguments])


def _leading(shape: Sequence[int]) -> str:
    return f"({', '.join(['...', *map(str, shape)])})"


def _listed(names: Sequence[str]) -> str:
    """All names, or of many the ends; the head of the module has them all."""
    shown = names if len(names) <= MANY else (*names[:2], "...", names[-1])
    return ", ".join(shown)


def about_function(kernel: Kernel) -> list[Paragraph]:
    """The paragraphs of a function's docstring."""
    rows = [
        (a.name, _leading(a.shape), _listed(a.components) + in_units(a.units))
        for a in kernel.arguments
    ]
    results = ", ".join(map(_leading, kernel.parts or (kernel.shape,)))
    rows.append(("returns", results, f"in {kernel.unit}" if kernel.unit else ""))
    both = f"Both are views of one array, (..., {len(kernel.outputs)}), the shape of `out`."
    return [
        *about_kernel(kernel, table(rows), *([both] if kernel.parts else [])),
        "Raises TypeError for a dtype and ValueError for a shape that it cannot take.",
    ]


WIDTH = 88
_BEFORE_AN_OPERATOR = re.compile(r" (?=[-+*/] )")
_QUOTES = '"""'


def bracketed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets: in one line, or in a line of their own, or each in one."""
    margin, inner = " " * indent, " " * (indent + 4)
    joined = ", ".join(items)
    if len(f"{margin}{head}{joined}{tail}") <= WIDTH:
        return f"{margin}{head}{joined}{tail}"
    if len(inner + joined) <= WIDTH:
        return f"{margin}{head}\n{inner}{joined}\n{margin}{tail}"
    return exploded(indent, head, items, tail)


def exploded(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets, each in a line of its own; an item may hold lines already."""
    margin, inner = " " * indent, " " * (indent + 4)
    lines = "".join(f"{inner}{item},\n" for item in items)
    return f"{margin}{head}\n{lines}{margin}{tail}"


def tuple_of(items: Sequence[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def assignment_lines(indent: int, name: str, value: str) -> str:
    """One assignment; a value without brackets that is too wide stands in brackets of its own."""
    margin, inner = " " * indent, " " * (indent + 4)
    line = f"{margin}{name} = {value}"
    if len(line) <= WIDTH or "(" in value:
        return line
    pieces = [value] if len(inner + value) <= WIDTH else _BEFORE_AN_OPERATOR.split(value)
    body = "\n".join(inner + piece for piece in pieces)
    return f"{margin}{name} = (\n{body}\n{margin})"


def docstring(paragraphs: Sequence[str | Sequence[str]], indent: int = 0) -> str:
    """The inside of a docstring: paragraphs are filled, sequences of lines kept."""
    room = WIDTH - indent
    first = filled(paragraphs[0], room - len(_QUOTES) * (2 if len(paragraphs) == 1 else 1))
    blocks = [first, *(filled(paragraph, room) for paragraph in paragraphs[1:])]
    margin = " " * indent
    text = "\n\n".join("\n".join(margin + line for line in block) for block in blocks)
    text = text.strip().replace("\\", "\\\\").replace(_QUOTES, r"\"\"\"")
    return f"{text}\n{margin}" if "\n" in text else text
