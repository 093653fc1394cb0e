"""Kernels as an ES module without dependencies, for pages and for node.

Each has its arithmetic once, from one place of flat arrays to another; a function of one
orientation and one of many call it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from rigidsym.kernels.ir import FUNCTIONS, Kernel, Program
from rigidsym.kernels.lowering.naming import NAMES, Names
from rigidsym.kernels.targets import remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.system import resources
from rigidsym.version import OWNERSHIP

RESERVED = NAMES["javascript"].union(FUNCTIONS)
_WIDTH = 88
_FORMS = {
    **{"choice": "{0} ? {1} : {2}", "nan": "NaN", "==": "===", "eps": "Number.EPSILON"},
    **{"or_nan": "_or_nan({})", "limit0": "null"},
}


def render(program: Program) -> dict[str, str]:
    """The module, and its types for TypeScript."""
    rows = [(a.name, f"({', '.join(map(str, a.shape))})", a.about) for a in program.arguments]
    about = remarks.about_module("javascript/module.txt.jinja", program, table=remarks.table(rows))
    types = resources.environment().get_template("javascript/types.d.mts.jinja")
    return {
        f"{program.name}.mjs": _module(about, program),
        f"{program.name}.d.mts": types.render(program=program, ownership=OWNERSHIP),
    }


def bare(kernels: Sequence[Kernel]) -> str:
    """The functions alone, without a word on them, to be set into other programs."""
    return _module([], Program("", "", (), tuple(kernels)))


def _module(about: Sequence[remarks.Paragraph], program: Program) -> str:
    of_math = program.called.intersection(FUNCTIONS) - {"eps"}
    of_math |= {"abs"} if program.has_guards else set()
    of_math |= {"sqrt", "tan"} if program.has_series else set()
    template = resources.environment().get_template("javascript/module.mjs.jinja")
    return template.render(
        program=program,
        about=_comment(about),
        functions=list(map(_function, program.kernels)),
        imports=", ".join(sorted(of_math)),
        series=remarks.series(program, "  {}: [{}],", _WIDTH),
        has_batches=bool(about),
        gives_matrices=any(len(kernel.shape) > 1 for kernel in program.kernels),
    )


@lru_cache(maxsize=64)  # all pages compare with the same conventions
def _function(kernel: Kernel) -> dict[str, object]:
    """The pieces of text that the template places."""
    names = Names([*kernel.components, *(a.name for a in kernel.assignments), "out", "at"])
    vectors = [names.fresh(argument.name) for argument in kernel.arguments]
    places = [names.fresh(f"{vector}_at") for vector in vectors]
    arguments = tuple(zip(vectors, places, kernel.arguments, strict=True))
    returned = "values" if kernel.shape else "values[0]"
    for size in reversed(kernel.shape[1:]):
        returned = f"_rows({returned}, {size})"
    about = remarks.about_kernel("javascript/function.txt.jinja", kernel, arguments=arguments)
    lines = [
        f"const {name} = {vector}[{_placed(place, k)}];"
        for vector, place, argument in arguments
        for k, name in enumerate(argument.components)
        if name in kernel.used
    ]
    lines += _statements(kernel)
    lines += [
        f"out[{_placed('at', k)}] = {infix(e, _FORMS)};" for k, e in enumerate(kernel.outputs)
    ]
    return {
        "kernel": kernel,
        "arguments": arguments,
        "about": _comment(about),
        "lines": [broken(f"  {line}", _WIDTH, " " * 4) for line in lines],
        "returned": returned,
    }


def _placed(place: str, count: int) -> str:
    return f"{place} + {count}" if count else place


def _statements(kernel: Kernel) -> Iterator[str]:
    for name, value in kernel.statements:
        if isinstance(value, dict):  # all functions c_k of one square
            orders = ", ".join(str(call.order) for call in value.values())
            square = value[name].argument.text
            yield f"const [{', '.join(value)}] = _entire({square}, {orders});"
        else:
            yield f"const {name} = {infix(value, _FORMS)};"


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, lambda text: text.replace("*/", "*\u200b/"))
