"""Kernels as an ES module without dependencies, for pages and for node.

Each has its arithmetic once, from one place of flat arrays to another; a function of one
orientation and one of many call it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from math import prod
from types import ModuleType

from rigidsym.algebra.series import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Guarded,
    Kernel,
    KernelArgument,
    Name,
    Number,
    Program,
    names_in,
)
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.javascript.function import (
    WIDTH,
    JavaScriptFunction,
    Paragraph,
    Vector,
    comment,
    placed,
    taken_from,
)
from rigidsym.kernels.targets.text import remarks, statements
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.system import resources

TEMPLATE = "javascript/module.mjs.jinja"
_WORDS = (
    "Infinity Math NaN RangeError TypeError Number ArrayBuffer Float64Array Array atan2 hypot tan "
    "out at"
)
RESERVED = frozenset({*_WORDS.split(), *FUNCTIONS})

_FUNCTIONS = {name: name for name in FUNCTIONS} | {
    "choice": "{0} ? {1} : {2}",
    "nan": "NaN",
    "==": "===",
}
_show = partial(infix, functions=_FUNCTIONS)


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = list(map(_fitted, program.kernels))
    return {f"{program.name}.mjs": _module(_about(program, kernels), kernels)}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The functions as a Python module that runs node; for comparison, each call is a process."""
    from rigidsym.kernels.targets.javascript.node import module

    (source,) = files.values()
    return module(name, source)


def bare(kernels: Sequence[Kernel]) -> str:
    """The functions alone, without a word on them, to be set into other programs."""
    return _module([], [_fitted(kernel) for kernel in kernels])


def _module(about: Sequence[Paragraph], kernels: Sequence[Kernel]) -> str:
    last = max((c.order for c in _calls(kernels) if c.order is not None), default=-1)
    template = resources.environment().get_template(TEMPLATE)
    return template.render(
        about=comment(about),
        functions=list(map(_function, kernels)),
        imports=", ".join(sorted(_of_math(kernels))),
        series=[_entry(order) for order in range(FIRST_SERIES, last + 1)],
        has_series=last >= 0,
        has_divisors=any(map(statements.guards_of, kernels)),
        has_batches=bool(about),
        has_matrices=any(len(shape) > 1 for k in kernels for shape in k.parts or (k.shape,)),
        takes_matrices=any(a.is_matrix for kernel in kernels for a in kernel.arguments),
    )


def _calls(kernels: Sequence[Kernel]) -> Iterator[Call]:
    return (call for kernel in kernels for call in statements.calls_of(kernel).values())


def _of_math(kernels: Sequence[Kernel]) -> set[str]:
    """What the functions and their helpers need of `Math`."""
    called = {call.function for call in _calls(kernels)}
    guards = {"abs"} if any(map(statements.guards_of, kernels)) else set()
    entire = {"sqrt", "tan"} if called.difference(FUNCTIONS) else set()
    return (called.intersection(FUNCTIONS) - {"eps"}) | guards | entire


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit."""
    room = WIDTH - len("  out[at + 10] = ;")
    return narrowed(kernel, _show, line=WIDTH - len("  const ;"), output=room)


def _function(kernel: Kernel) -> JavaScriptFunction:
    names = Names([*kernel.components, *(a.name for a in kernel.assignments), "out", "at"])
    vectors = tuple(_vector(names.fresh(a.name), a) for a in kernel.arguments)
    places = tuple(names.fresh(f"{vector.name}_at") for vector in vectors)
    wholes = [*(assignment.value for assignment in kernel.assignments), *kernel.outputs]
    used = {name for whole in wholes for name in names_in(whole)}
    taken = [
        line
        for vector, place in zip(vectors, places, strict=True)
        for name, line in taken_from(vector, place)
        if name in used
    ]
    given = [f"  out[{placed('at', k)}] = {_show(e)};" for k, e in enumerate(kernel.outputs)]
    return JavaScriptFunction(
        name=kernel.name,
        about=comment(_about_kernel(kernel, vectors)),
        vectors=vectors,
        places=places,
        body="\n".join([*taken, *_lines(kernel), *given]),
        returned=_returned(kernel),
        count=len(kernel.outputs),
    )


def _vector(name: str, argument: KernelArgument) -> Vector:
    distinct = list(dict.fromkeys(unit or "1" for unit in argument.units))
    units = distinct[0] if len(distinct) == 1 else ", ".join(u or "1" for u in argument.units)
    unit = f" in {units}" if any(argument.units) else ""
    return Vector(
        name=name,
        given=argument.name,
        components=argument.components,
        about=f"{', '.join(argument.components)}{unit}"
        + ("; rows, or the entries row by row" if argument.is_matrix else ""),
        entries=f"_flat({name})" if argument.is_matrix else f"[{name}]" * argument.is_scalar,
        default=f"new Array({len(argument.components)}).fill(0)" if argument.is_optional else "",
    )


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in statements.grouped(kernel):
        match value:
            case Guarded():
                yield f"  const {name} = _or_nan({', '.join(_guard(value))});"
            case Call("eps"):
                yield f"  const {name} = Number.EPSILON;"
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
    """The result in the shape of the quantity, or both results of a derivative."""
    if not kernel.parts:
        return _shaped("values", kernel.shape)
    first, second = kernel.parts
    place = prod(first)
    value = _shaped(f"values.slice(0, {place})", first) if first else "values[0]"
    return f"[{value}, {_shaped(f'values.slice({place})', second)}]"


def _shaped(values: str, shape: Sequence[int]) -> str:
    if not shape:
        return f"{values}[0]"
    return values if len(shape) == 1 else f"_rows({values}, {shape[1]})"


def _listed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets: in one line where it fits, else each in one."""
    margin = " " * indent
    line = f"{margin}{head}{', '.join(items)}{tail}"
    if len(line) <= WIDTH:
        return line
    inside = "".join(f"{margin}  {item},\n" for item in items)
    return f"{margin}{head}\n{inside}{margin}{tail}"


def _entry(order: int) -> str:
    """A line of the table: k, the switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
    return _listed(2, f"{order}: [", [repr(float(number)) for number in numbers], "],")


def _about(program: Program, kernels: Sequence[Kernel]) -> list[Paragraph]:
    """The paragraphs of the module's comment."""
    rows = [(a.name, f"({', '.join(map(str, a.shape))})", a.about) for a in program.arguments]
    return [
        f"{program.title}: functions of plain arrays.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, arrays of numbers in radians and SI units:",
        remarks.table(rows),
        "Vectors are arrays, and matrices are arrays of rows.",
        "Each function has a twin ..._batch for many orientations. Its arguments and its result "
        "are flat arrays, row after row, matrices row by row; an argument with a single row is "
        "used for all orientations. It fills and returns `out`, by default a new Float64Array; "
        "`out` must not share memory with an argument. There are no threads (use workers), and no "
        "float32, since JavaScript computes in double precision only.",
        *remarks.errors(program.kernels),
        *remarks.remarks(kernels),
        *program.remarks,
        *([remarks.WITHOUT_UNWRAP] if program.unwrapping else []),
        remarks.GENERATED,
    ]


def _about_kernel(kernel: Kernel, vectors: Sequence[Vector]) -> list[Paragraph]:
    """The paragraphs of a function's comment."""
    return [
        remarks.headline(kernel),
        *kernel.remarks,
        remarks.cost(kernel),
        *remarks.bound(kernel),
        *remarks.poles(kernel),
        [*(f"@param {{number[]}} {v.name} {v.about}" for v in vectors), _returns(kernel)],
    ]


def _returns(kernel: Kernel) -> str:
    unit = f" in {kernel.unit}" if kernel.unit else ""
    kinds = ["number" + "[]" * len(shape) for shape in kernel.parts or (kernel.shape,)]
    shapes = [f"({', '.join(map(str, s))})" for s in kernel.parts or (kernel.shape,) if s]
    kind = f"[{', '.join(kinds)}]" if kernel.parts else kinds[0]
    return " ".join([f"@returns {{{kind}}}", *filter(None, [" and ".join(shapes)])]) + unit
