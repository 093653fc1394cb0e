"""Kernels as an ES module without dependencies, for pages and for node.

Each has its arithmetic once, from one place of flat arrays to another; a function of one
orientation and one of many call it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from types import ModuleType

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of, taylor
from rigidsym.errors import KernelError
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Expression,
    Kernel,
    KernelArgument,
    Program,
)
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.targets import remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.system import resources
from rigidsym.version import OWNERSHIP

TEMPLATE = "javascript/module.mjs.jinja"
_WORDS = (
    "Infinity Math NaN RangeError TypeError Number ArrayBuffer Float64Array Array atan2 hypot tan "
    "out at"
)
RESERVED = frozenset({*_WORDS.split(), *FUNCTIONS})
_WIDTH = 88
_TYPES = """type Vector = ArrayLike<number>;
type Matrix = Vector | ArrayLike<Vector>;"""
_SPELLED = {
    **{"choice": "{0} ? {1} : {2}", "nan": "NaN", "==": "==="},
    **{"or_nan": "_or_nan({})", "limit0": "null", "eps": "Number.EPSILON"},
}


def render(program: Program) -> dict[str, str]:
    """The module, and its types for TypeScript."""
    name, kernels = program.name, program.kernels
    rows = [(a.name, f"({', '.join(map(str, a.shape))})", a.about) for a in program.arguments]
    about = remarks.about_module("javascript/module.txt.jinja", program, table=remarks.table(rows))
    declared = "\n".join(line for kernel in kernels for line in _declared(kernel))
    types = f"// The types of {name}.mjs. {OWNERSHIP}\n\n{_TYPES}\n\n{declared}\n"
    return {f"{name}.mjs": _module(about, program), f"{name}.d.mts": types}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """Raises KernelError: Python does not run JavaScript."""
    main = next(iter(files), name)
    raise KernelError(f"{main} runs in browsers and in Node, not in Python; write it to a file")


def bare(kernels: Sequence[Kernel]) -> str:
    """The functions alone, without a word on them, to be set into other programs."""
    return _module([], Program("", "", (), "", (), tuple(kernels)))


def _module(about: Sequence[remarks.Paragraph], program: Program) -> str:
    of_math = program.called.intersection(FUNCTIONS) - {"eps"}
    of_math |= {"abs"} if program.has_guards else set()
    of_math |= {"sqrt", "tan"} if program.has_series else set()
    return (
        resources.environment()
        .get_template(TEMPLATE)
        .render(
            about=_comment(about),
            program=program,
            functions=list(map(_function, program.kernels)),
            imports=", ".join(sorted(of_math)),
            series=[_entry(order) for order in range(FIRST_SERIES, program.last + 1)],
            has_batches=bool(about),
            gives_matrices=any(len(kernel.shape) > 1 for kernel in program.kernels),
        )
    )


def _declared(kernel: Kernel) -> Iterator[str]:
    """The functions of one orientation and of many; vectors may be arrays or typed arrays."""
    kinds = [
        "number" if a.is_scalar else "Matrix" if a.is_matrix else "Vector" for a in kernel.arguments
    ]
    names = [a.name for a in kernel.arguments]
    one = ", ".join(f"{name}: {kind}" for name, kind in zip(names, kinds, strict=True))
    many = ", ".join(f"{name}: Vector" for name in names)
    yield f"export function {kernel.name}({one}): {_kind(kernel)};"
    yield f"export function {kernel.name}_batch({many}, out?: Float64Array): Float64Array;"


def _kind(kernel: Kernel) -> str:
    """The type of what is returned: number[][]."""
    return "number" + "[]" * len(kernel.shape)


def _show(expression: Expression) -> str:
    return infix(expression, _SPELLED)


@lru_cache(maxsize=64)  # all pages compare with the same conventions
def _function(kernel: Kernel) -> dict[str, object]:
    """The pieces of text that the template places."""
    names = Names([*kernel.components, *(a.name for a in kernel.assignments), "out", "at"])
    arguments = kernel.arguments
    vectors = [names.fresh(argument.name) for argument in arguments]
    places = [names.fresh(f"{vector}_at") for vector in vectors]
    sizes = [len(argument.components) for argument in arguments]
    of_one = [_of_one(vector, a) for vector, a in zip(vectors, arguments, strict=True)]
    each = list(zip(vectors, places, sizes, arguments, of_one, strict=True))
    taken = [
        f"  const {name} = {vector}[{_placed(place, k)}];"
        for vector, place, _, argument, _ in each
        for k, name in enumerate(argument.components)
        if name in kernel.used
    ]
    shape = f" ({', '.join(map(str, kernel.shape))})" if kernel.shape else ""
    about = remarks.about_kernel(
        "javascript/function.txt.jinja",
        kernel,
        vectors=list(zip(vectors, arguments, strict=True)),
        returns=f"{{{_kind(kernel)}}}{shape}" + (f" in {kernel.unit}" if kernel.unit else ""),
    )
    given = [f"  out[{_placed('at', k)}] = {_show(e)};" for k, e in enumerate(kernel.outputs)]
    lines = (broken(line, _WIDTH, " " * 4) for line in (*taken, *_lines(kernel), *given))
    return {
        "name": kernel.name,
        "about": _comment(about),
        "parameters": ", ".join(vectors),
        "given": ", ".join(f"{vector}, {place}" for vector, place, *_ in each),
        "taken": ", ".join(f'_taken("{a.name}", {flat}, {n}), 0' for _, _, n, a, flat in each),
        "checked": ", ".join(f'["{a.name}", {vector}, {n}]' for vector, _, n, a, _ in each),
        "stepped": ", ".join(f"{vector}, i * steps[{k}]" for k, vector in enumerate(vectors)),
        "body": "\n".join(lines),
        "returned": _returned(kernel),
        "count": len(kernel.outputs),
    }


def _of_one(vector: str, argument: KernelArgument) -> str:
    """The components of the argument of one orientation."""
    if argument.is_matrix:
        return f'_flat("{argument.name}", {vector}, {argument.shape[1]})'
    return f"[{vector}]" if argument.is_scalar else vector


def _placed(place: str, count: int) -> str:
    return f"{place} + {count}" if count else place


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in kernel.statements:
        match value:
            case dict():  # all functions c_k of one square
                calls = sorted(value.items(), key=lambda named: named[1].order or 0)
                names = ", ".join(name for name, _ in calls)
                orders = ", ".join(str(call.order) for _, call in calls)
                yield f"  const [{names}] = _entire({calls[0][1].argument.text}, {orders});"
            case _:
                yield f"  const {name} = {_show(value)};"


def _returned(kernel: Kernel) -> str:
    """The result in the shape of the quantity."""
    values = "values" if kernel.shape else "values[0]"
    for size in reversed(kernel.shape[1:]):
        values = f"_rows({values}, {size})"
    return values


def _entry(order: int) -> str:
    """The table's entry for c_k, in a line if it fits: k, the switch, c_{k-2}(0), coefficients."""
    series = series_of(order)
    numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
    items = [repr(float(number)) for number in numbers]
    line = f"  {order}: [{', '.join(items)}],"
    inside = "".join(f"    {item},\n" for item in items)
    return line if len(line) <= _WIDTH else f"  {order}: [\n{inside}  ],"


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, lambda text: text.replace("*/", "*\u200b/"))
