"""What the buttons of a page copy: each equation in the languages that people write it in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from textwrap import fill

from rigidsym.algebra.series import FIRST_SERIES, series_of, taylor
from rigidsym.formula.display import display
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Expression,
    Guarded,
    Kernel,
    Number,
    functions_of,
    last_order,
)
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python import (
    WIDTH,
    assignment_lines,
    bracketed,
    docstring,
    exploded,
)
from rigidsym.kernels.targets.text.remarks import filled
from rigidsym.mechanics.derivation import Derivation
from rigidsym.notes.document.document import Document
from rigidsym.system import resources

LANGUAGES: Mapping[str, str] = {"latex": "LaTeX", "python": "Python", "c": "C"}  # as shown

_PAPER = 30.0  # ems of a display on paper
_EPS, _TINY = 2.0**-52, 2.0**-970  # less than this is left of a divisor by rounding


@dataclass(frozen=True, kw_only=True, slots=True)
class _Language:
    """How a statement is written."""

    assigned: str
    guarded: str
    absolute: str
    template: str  # of the functions c_k


_PYTHON = _Language(
    assigned="    {name} = {value}",
    guarded="{value} if abs({value}) > {least} else nan",
    absolute="abs",
    template="page/series.py.jinja",
)
_C = _Language(
    assigned="    const double {name} = {value};",
    guarded="fabs({value}) > {least} ? {value} : NAN",
    absolute="fabs",
    template="page/series.c.jinja",
)


def copies_of(derivation: Derivation, document: Document) -> Mapping[str, Mapping[str, str]]:
    """label: language: text, for each numbered equation that a kernel evaluates."""
    program = lower(derivation, numpy.RESERVED)
    kernels = {
        kernel.name: narrowed(kernel, infix, line=WIDTH - len("    const double ;"), output=66)
        for kernel in program.kernels
    }
    last = last_order(program.kernels)
    return {
        label: {
            "latex": text,
            "python": _python(kernels[label], last),
            "c": _c(kernels[label], last),
        }
        for label, text in _latex(document)
        if label in kernels
    }


def _latex(document: Document) -> Iterator[tuple[str, str]]:
    for equation in document.equations:
        plain = replace(equation, is_result=False)  # who copies it has boxes of their own
        inside = display(plain, document.letters, _PAPER).text
        yield equation.label, f"\\[\n{inside}\n\\]\n"


def _python(kernel: Kernel, last: int) -> str:
    """A function of plain floats, with its imports and the functions c_k that it calls."""
    called = functions_of([kernel])
    names = called.intersection(FUNCTIONS) - {"abs"}
    names |= {"nan"} if kernel.guards else set()
    names |= {"sqrt", "tan"} if called.difference(FUNCTIONS) else set()
    outputs = [infix(output) for output in kernel.outputs]
    width = kernel.shape[1] if len(kernel.shape) == 2 else 1
    rows = [outputs[start : start + width] for start in range(0, len(outputs), width)]
    entries = [exploded(8, "(", row, ")").lstrip() for row in rows] if width > 1 else outputs
    lines = [
        *([f"from math import {', '.join(sorted(names))}\n\n"] if names else []),
        *_series(kernel, last, _PYTHON),
        bracketed(0, f"def {kernel.name}(", [a.name for a in kernel.arguments], "):"),
        f'    """{docstring([_about(kernel)], indent=4)}"""',
        *_statements(kernel, _PYTHON),
        exploded(4, "return (", entries, ")") if kernel.shape else f"    return {outputs[0]}",
    ]
    return "\n".join([*lines, ""])


def _c(kernel: Kernel, last: int) -> str:
    """A function in C99 on the functions of math.h, with the functions c_k that it calls."""
    given = [f"const double {a.name}[{len(a.components)}]" for a in kernel.arguments]
    head = bracketed(0, f"void {kernel.name}(", [*given, f"double out[{len(kernel.outputs)}]"], ")")
    lines = [
        "#include <math.h>\n",
        *_series(kernel, last, _C),
        "/* " + "\n   ".join(filled(_about(kernel), WIDTH - 6)) + " */",
        head.replace(",\n)", "\n)"),  # C takes no comma after the last
        "{",
        *(f"    (void){a.name};" for a in kernel.arguments if kernel.used.isdisjoint(a.components)),
        *_statements(kernel, _C),
        *(f"    out[{place}] = {infix(output)};" for place, output in enumerate(kernel.outputs)),
        "}",
    ]
    return "\n".join([*lines, ""])


def _about(kernel: Kernel) -> str:
    unit = f", in {kernel.unit}" if kernel.unit else ""
    rows = ", row by row" if len(kernel.shape) == 2 else ""
    return f"{kernel.symbol}: {kernel.about}{unit}{rows}."


def _statements(kernel: Kernel, language: _Language) -> Iterator[str]:
    """The components that are used, by name, and what is computed from them."""
    for argument in kernel.arguments:
        for place, name in enumerate(argument.components):
            if name in kernel.used:
                yield language.assigned.format(name=name, value=f"{argument.name}[{place}]")
    for assignment in kernel.assignments:
        value = _value(assignment.value, language)
        line = language.assigned.format(name=assignment.name, value=value)
        is_long = language is _PYTHON and len(line) > WIDTH
        yield assignment_lines(4, assignment.name, value) if is_long else line


def _value(value: Expression, language: _Language) -> str:
    match value:
        case Guarded():
            return language.guarded.format(value=value.value.text, least=_least(value, language))
        case Call(function, argument):
            if value.order is not None:
                return f"entire({value.order}, {argument.text})"
            return f"{language.absolute if function == 'abs' else function}({argument.text})"
    return infix(value)


def _least(guard: Guarded, language: _Language) -> str:
    """What is larger divides; in the rest rounding leaves no digit."""
    if guard.scale is None:
        return repr(_TINY)
    scale = infix(guard.scale)
    size = scale if isinstance(guard.scale, Number) else f"{language.absolute}({scale})"
    return f"{_EPS**guard.power!r} * {size}"


def _series(kernel: Kernel, last: int, language: _Language) -> Iterator[str]:
    """The functions c_k of n², if the kernel calls any; their table has all that the page needs."""
    if last_order([kernel]) < 0:
        return
    rows = [_row(order) for order in range(FIRST_SERIES, max(last, FIRST_SERIES) + 1)]
    template = resources.environment().get_template(language.template)
    numbers = [_wrapped(row) for row in rows]
    yield f"{template.render(rows=numbers, first=FIRST_SERIES, width=max(map(len, rows)))}\n"


def _row(order: int) -> list[float]:
    """The switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    return [float(n) for n in (series.switch, taylor(order - 2)[0], *series.coefficients)]


def _wrapped(numbers: Sequence[float]) -> str:
    margin = " " * 12
    text = ", ".join(map(repr, numbers))
    return fill(text, WIDTH, initial_indent=margin, subsequent_indent=margin)
