"""Kernels as an ES module without dependencies, for pages and for node."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import ModuleType

from rigidsym import __version__, resources
from rigidsym.algebra.series import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.conversions import ConversionProgram
from rigidsym.kernels.infix import infix
from rigidsym.kernels.ir import FUNCTIONS, Argument, Call, Guarded, Kernel, Name, Number, Program
from rigidsym.kernels.layout import filled
from rigidsym.kernels.naming import Names
from rigidsym.kernels.narrow import narrowed
from rigidsym.kernels.targets import numpy_singular as singular

TEMPLATE = "kernels_javascript.mjs.jinja"
_WORDS = (
    "arguments await break case catch class const continue debugger default delete do else "
    "enum eval export extends false finally for function if implements import in instanceof "
    "interface let new null package private protected public return static super switch this "
    "throw true try typeof undefined var void while with yield Infinity Math NaN RangeError "
)
RESERVED = frozenset({*_WORDS.split(), *FUNCTIONS, "tan"})

_WIDTH = 88
_show = partial(infix, functions={name: name for name in FUNCTIONS})


Paragraph = str | Sequence[str]


@dataclass(frozen=True, kw_only=True, slots=True)
class Function:
    """One kernel, in the pieces that the template places."""

    name: str
    about: str  # lines of its comment
    parameters: str
    body: str


def render(program: Program, conversions: ConversionProgram | None = None) -> dict[str, str]:
    """The module; of the conversions, those that are kernels."""
    converting = conversions.kernels if conversions else ()
    kernels = [_fitted(kernel) for kernel in (*program.kernels, *converting)]
    remarks = singular.remarks(kernels)
    about = _about(program, [*remarks, *_without(conversions)])
    return {f"{program.name}.mjs": _module(about, kernels)}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The functions as a Python module that runs node; for comparison, each call is a process."""
    from rigidsym.kernels.targets.javascript_node import module

    (source,) = files.values()
    return module(name, source)


def bare(kernels: Sequence[Kernel]) -> str:
    """The functions alone, without a word on them, to be set into other programs."""
    return _module([], [_fitted(kernel) for kernel in kernels])


def _module(about: Sequence[Paragraph], kernels: Sequence[Kernel]) -> str:
    last = max((c.order for c in _calls(kernels) if c.order is not None), default=-1)
    template = resources.environment().get_template(TEMPLATE)
    return template.render(
        about=_comment(about),
        functions=[*map(_function, kernels)],
        imports=", ".join(sorted(_of_math(kernels))),
        series=[_entry(order) for order in range(FIRST_SERIES, last + 1)],
        has_series=last >= 0,
        has_divisors=any(map(singular.guards_of, kernels)),
    )


def _without(conversions: ConversionProgram | None) -> Iterator[str]:
    """What is not here of what was asked for."""
    if conversions is not None and conversions.formulas:
        names = ", ".join(formula.name for formula in conversions.formulas)
        yield f"Not in this module, but in the one for NumPy: {names}, unwrap."


def _calls(kernels: Sequence[Kernel]) -> Iterator[Call]:
    return (call for kernel in kernels for call in singular.calls_of(kernel).values())


def _of_math(kernels: Sequence[Kernel]) -> set[str]:
    """What the functions and their helpers need of `Math`."""
    called = {call.function for call in _calls(kernels)}
    guards = {"abs"} if any(map(singular.guards_of, kernels)) else set()
    entire = {"sqrt", "tan"} if called.difference(FUNCTIONS) else set()
    return called.intersection(FUNCTIONS) | guards | entire


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit."""
    return narrowed(kernel, _show, line=_WIDTH - len("  const ;"), output=_WIDTH - 6 - len(","))


def _function(kernel: Kernel) -> Function:
    names = Names([*kernel.components, *(a.name for a in kernel.assignments)])
    vectors = {names.fresh(argument.name): argument for argument in kernel.arguments}
    taken = [_taken(name, argument) for name, argument in vectors.items()]
    return Function(
        name=kernel.name,
        about=_comment(_about_kernel(kernel, vectors)),
        parameters=", ".join(vectors),
        body="\n".join([*taken, *_lines(kernel), _returned(kernel)]),
    )


def _taken(name: str, argument: Argument) -> str:
    """const [phi, theta, psi] = _taken("q", q, 3);"""
    tail = f'] = _taken("{argument.name}", {name}, {len(argument.components)});'
    return _listed(2, "const [", argument.components, tail)


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in singular.grouped(kernel):
        match value:
            case Guarded():
                yield f"  const {name} = _or_nan({', '.join(_guard(value))});"
            case dict():
                calls = sorted(value.items(), key=lambda named: named[1].order or 0)
                orders = ", ".join(str(call.order) for _, call in calls)
                (argument,) = {call.argument.text for _, call in calls}
                names = ", ".join(name for name, _ in calls)
                yield f"  const [{names}] = _entire({argument}, {orders});"
            case _:
                yield f"  const {name} = {_show(value)};"


def _guard(guard: Guarded) -> Iterator[str]:
    """What _or_nan is given: the value, its scale, and the power where it is not one."""
    yield guard.value.text
    match guard.scale:
        case Name(scale):
            yield scale
        case Number(number):
            yield repr(float(number))
        case _:
            yield "null"
    if guard.power != 1:
        yield str(guard.power)


def _returned(kernel: Kernel) -> str:
    outputs = [_show(output) for output in kernel.outputs]
    if not kernel.shape:
        return f"  return {outputs[0]};"
    if len(kernel.shape) == 1:
        return _listed(2, "return [", outputs, "];")
    columns = kernel.shape[1]
    rows = [outputs[start : start + columns] for start in range(0, len(outputs), columns)]
    return "\n".join(["  return [", *(_listed(4, "[", row, "],") for row in rows), "  ];"])


def _listed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets: in one line where it fits, else each in one."""
    margin = " " * indent
    line = f"{margin}{head}{', '.join(items)}{tail}"
    if len(line) <= _WIDTH:
        return line
    inside = "".join(f"{margin}  {item},\n" for item in items)
    return f"{margin}{head}\n{inside}{margin}{tail}"


def _entry(order: int) -> str:
    """A line of the table: k, the switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
    return _listed(2, f"{order}: [", [repr(float(number)) for number in numbers], "],")


def _comment(paragraphs: Sequence[Paragraph]) -> str:
    """The lines of a JSDoc comment; no text can end it."""
    margin = " * "
    blocks = (filled(paragraph, _WIDTH - len(margin)) for paragraph in paragraphs)
    text = "\n\n".join("\n".join(block) for block in blocks).replace("*/", "*\u200b/")
    return "\n".join(f"{margin}{line}".rstrip() for line in text.split("\n"))


def _about(program: Program, remarks: Sequence[str]) -> list[Paragraph]:
    """The paragraphs of the module's comment."""
    rows = [(a.name, f"({len(a.components)})", a.about) for a in program.arguments]
    return [
        f"{program.title}: functions of plain arrays.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, arrays of numbers in radians and SI units:",
        _table(rows),
        "Vectors are arrays, matrices arrays of rows. NaN stays NaN, and so does the sine of "
        "infinity.",
        *remarks,
        f"Generated by rigidsym {__version__}; do not edit. The equations are those of the note "
        "of the same name.",
    ]


def _about_kernel(kernel: Kernel, vectors: Mapping[str, Argument]) -> list[Paragraph]:
    """The paragraphs of a function's comment."""
    is_named = kernel.definition and kernel.definition != kernel.symbol
    definition = f" = {kernel.definition}" if is_named else ""
    place = f"Equation ({kernel.equation}) of the note; " if kernel.equation else ""
    return [
        f"{kernel.symbol}{definition}: {kernel.about}.",
        f"{place}{kernel.operations}.",
        *singular.poles(kernel),
        [*(_parameter(name, a) for name, a in vectors.items()), _returns(kernel)],
    ]


def _parameter(name: str, argument: Argument) -> str:
    distinct = list(dict.fromkeys(unit or "1" for unit in argument.units))
    units = distinct[0] if len(distinct) == 1 else ", ".join(u or "1" for u in argument.units)
    unit = f" in {units}" if any(argument.units) else ""
    return f"@param {{number[]}} {name} {', '.join(argument.components)}{unit}"


def _returns(kernel: Kernel) -> str:
    kind = "number" + "[]" * len(kernel.shape)
    shape = f" ({', '.join(map(str, kernel.shape))})" if kernel.shape else ""
    unit = f" in {kernel.unit}" if kernel.unit else ""
    return f"@returns {{{kind}}}{shape}{unit}"


def _table(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Rows with their first two columns aligned."""
    first, second = (max(len(row[k]) for row in rows) for k in (0, 1))
    return [f"  {a:<{first}}  {b:<{second}}  {c}".rstrip() for a, b, c in rows]
