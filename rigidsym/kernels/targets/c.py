"""Kernels in C99: a header and a source without dependencies.

No function allocates memory, recurses or keeps state; the caller owns all arguments and results.
Two more files let `rigidsym build` make a Python module of them. Lean C is for firmware: one plain
function a quantity, in one type, with the functions of <math.h>.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import pi
from types import ModuleType

from rigidsym.kernels.ir import (
    Call,
    Compare,
    Expression,
    Guarded,
    Kernel,
    Program,
    functions_of,
    last_order,
)
from rigidsym.kernels.lowering.trigonometry import two_over_pi
from rigidsym.kernels.targets import numpy, remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.kernels.targets.precision import EITHER, PRECISIONS, Precision
from rigidsym.kernels.targets.python import WIDTH, bracketed
from rigidsym.system import resources

_NAMES = (
    "out far beyond sin_cos sin_cosf or_nan or_nanf entire entiref sqrtf fabs fabsf NULL angle_of "
    "angle_off SIZE_MAX PTRDIFF_MAX size_t ptrdiff_t uint32_t uint64_t TILE MOST SHUFFLED SHUFFLE "
    "INLINED STREAMED STREAMS STREAM STREAMf END_STREAM HELPER CLONES CLONE "
    "CLONED expected apart REAL WORD FN LIT EPS LEAST EVALUATE SIN_COS TILED GIVEN "
    "PARAMETERS ORDERS AHEAD prefetch in given count"
)
RESERVED = numpy.RESERVED | {*_NAMES.split()}  # the Python module's, too
_WIDTH = 92
_TILE = 32  # orientations that are evaluated side by side
_WORDS = {"choice": "{0} ? {1} : {2}"}


def render(program: Program, *, lean: str = "none") -> dict[str, str]:
    """The source, the header, and what makes a Python module of them."""
    name, kernels = program.name, program.kernels
    precisions = [p for p in PRECISIONS if lean in ("none", p.real)]
    header = _header(program, kernels, precisions, is_lean=lean != "none")
    if lean != "none":
        return {f"{name}.c": _lean(program, kernels, precisions[0]), f"{name}.h": header}
    functions = [numpy.function(kernel, _called(kernel)) for kernel in program.kernels]
    return {
        f"{name}.c": _source(program, kernels),
        f"{name}.h": header,
        f"{name}_c.py": numpy.module_text(program, "c/module.py.jinja", functions, name=name),
        f"{name}_module.c": _module(name, kernels),
    }


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The Python module, compiled once a machine."""
    from rigidsym.kernels.targets.compiling import build, load_built

    return load_built(f"{name}_c", files, lambda folder: build(folder / f"{name}.c"))


def _source(program: Program, kernels: Sequence[Kernel]) -> str:
    called, last = functions_of(kernels), last_order(kernels)
    groups = (g for k in kernels for g in (k.outputs, *(a.components for a in k.arguments)))
    digits = [f"0x{word:08x}" for word in two_over_pi()]
    return _rendered(
        "c/source.c.jinja",
        title=_safe(program.title),
        name=program.name,
        tile=_TILE,
        has_angles=last >= 0 or not called.isdisjoint(("sin", "cos")),
        has_arctangents="atan2" in called,
        has_guards=any(kernel.guards for kernel in kernels),
        has_series=last >= 0,
        orders=max(2, last) + 1,
        precisions=[{**p.filled(last), "eps": p.of_eps(), "least": p.least} for p in PRECISIONS],
        functions=[_function(program, kernel) for kernel in kernels],
        two_over_pi=",\n".join("    " + ", ".join(digits[k : k + 6]) for k in range(0, 40, 6)),
        half_pi=repr(pi / 2),
        widths=sorted(set(map(len, groups))),
    )


def _lean(program: Program, kernels: Sequence[Kernel], precision: Precision) -> str:
    functions = []
    for kernel in kernels:
        lines = [
            f"(void){a.name};" for a in kernel.arguments if kernel.used.isdisjoint(a.components)
        ]
        lines += [
            f"const {precision.real} {name} = {a.name}[{k}];"
            for a in kernel.arguments
            for k, name in enumerate(a.components)
            if name in kernel.used
        ]
        for name, value in kernel.statements:
            lines += _statement(kernel, name, value, precision, is_lean=True)
        lines += [f"out[{k}] = {_text(e, precision)};" for k, e in enumerate(kernel.outputs)]
        functions.append(
            {"signature": _signature(program, kernel, precision), "lines": _broken(lines)}
        )
    last = last_order(kernels)
    return _rendered(
        "c/lean.c.jinja",
        title=_safe(program.title),
        name=program.name,
        precision=precision.filled(last),
        has_guards=any(kernel.guards for kernel in kernels),
        has_series=last >= 0,
        orders=max(2, last) + 1,
        functions=functions,
    )


def _header(
    program: Program, kernels: Sequence[Kernel], precisions: Sequence[Precision], *, is_lean: bool
) -> str:
    facts = {"is_lean": is_lean, "has_floats": precisions[-1].suffix == "f", "tile": _TILE}
    about = remarks.about_module("c/header.txt.jinja", program, **facts)
    functions = []
    for kernel in kernels:
        declared = []
        for p in precisions:
            declared.append(_signature(program, kernel, p))
            declared += [] if is_lean else [_array_signature(program, kernel, p)]
        text = remarks.about_kernel("c/function.txt.jinja", kernel)
        functions.append({"about": _comment(text), "declared": declared})
    guard = f"{program.name.upper()}_H"
    return _rendered("c/header.h.jinja", about=_comment(about), guard=guard, functions=functions)


def _module(name: str, kernels: Sequence[Kernel]) -> str:
    """The functions of the Python module; a matrix is a vector of its rows."""
    functions = [
        {
            "name": kernel.name,
            "arguments": len(kernel.arguments),
            "widths": ", ".join(
                "0" if a.is_scalar else str(len(a.components)) for a in kernel.arguments
            ),
            "axes": len(kernel.shape),
            "shape": ", ".join(map(str, kernel.shape)) or "0",
            "entries": len(kernel.outputs),
            "places": range(len(kernel.arguments) + 1),  # of the arguments and the result
        }
        for kernel in kernels
    ]
    return _rendered(
        "c/module.c.jinja",
        name=name,
        functions=functions,
        types=[(p.real, p.suffix) for p in PRECISIONS],
        most_arguments=max(len(kernel.arguments) for kernel in kernels),
    )


def _called(kernel: Kernel) -> str:
    """The body in Python: the compiled function, with arguments as they are or prepared for it.

    A matrix has no components on one axis, and is always prepared.
    """
    compiled = f"_compiled.{kernel.name}"
    prepared = numpy.called(kernel, compiled)
    if any(argument.is_matrix for argument in kernel.arguments):
        return prepared
    vectors = [*(argument.name for argument in kernel.arguments), "out"]
    lines = [
        "    if threads == 1:",
        bracketed(8, f"result = {compiled}(", vectors, ")"),
        "        if result is not None:\n            return result",
        prepared,
    ]
    return "\n".join(lines)


def _named(program: Program, kernel: Kernel, precision: Precision, ending: str = "") -> str:
    return precision.named(f"{program.name}_{kernel.name}{ending}")


def _signature(program: Program, kernel: Kernel, precision: Precision) -> str:
    real, head = precision.real, f"void {_named(program, kernel, precision)}("
    given = [f"const {real} {a.name}[{len(a.components)}]" for a in kernel.arguments]
    return _listed(head, [*given, f"{real} out[{len(kernel.outputs)}]"])


def _array_signature(program: Program, kernel: Kernel, precision: Precision) -> str:
    items = ["size_t count"]
    for kind, name in (*(("const ", a.name) for a in kernel.arguments), ("", "out")):
        items.append(f"{kind}{precision.real} *{name}")
        items += [f"ptrdiff_t {name}_step", f"ptrdiff_t {name}_stride"]
    return _listed(f"void {_named(program, kernel, precision, '_array')}(", items)


def _listed(head: str, items: Sequence[str]) -> str:
    """A head with its parameters: in its line, or in the next, or in a line each."""
    joined = ", ".join(items)
    if len(f"{head}{joined})") <= WIDTH:
        return f"{head}{joined})"
    if len(f"    {joined}") <= WIDTH:
        return f"{head}\n    {joined}\n)"
    return f"{head}\n    " + ",\n    ".join(items) + ")"


def _function(program: Program, kernel: Kernel) -> dict[str, object]:
    """The pieces of text that the template of the source places, for either type."""
    arguments: list[dict[str, object]] = []
    for a in kernel.arguments:
        place = sum(len(before.components) for before in kernel.arguments[: len(arguments)])
        arguments.append({"name": a.name, "size": len(a.components), "place": place})
    return {
        "name": kernel.name,
        "signature": _signature(program, kernel, EITHER),
        "array_signature": _array_signature(program, kernel, EITHER),
        "arguments": arguments,
        "inputs": len(kernel.components),
        "outputs": len(kernel.outputs),
        "lines": _broken(_side_by_side(kernel)),
    }


def _side_by_side(kernel: Kernel) -> Iterator[str]:
    """Of a function of one row among others, whose components are `apart`."""
    components = enumerate(kernel.components)
    read = [f"{name} = {_entry('in', k)}" for k, name in components if name in kernel.used]
    if read:
        yield f"const {EITHER.real} {', '.join(read)};"
    for name, value in kernel.statements:
        yield from _statement(kernel, name, value, EITHER)
    for k, output in enumerate(kernel.outputs):
        yield f"{_entry('out', k)} = {_text(output, EITHER)};"


def _broken(lines: Iterable[str]) -> list[str]:
    return [broken(f"    {line}", _WIDTH, " " * 8).removeprefix("    ") for line in lines]


def _statement(
    kernel: Kernel,
    name: str,
    value: Expression | dict[str, Call],
    precision: Precision,
    *,
    is_lean: bool = False,
) -> Iterator[str]:
    real, named = precision.real, precision.named
    match value:
        case dict():  # all functions c_k of one square
            square = next(iter(value.values())).argument.text
            tracked, far = ("", "") if is_lean else ("beyond |= ", "far, ")
            yield f"{real} _entire_{square}[ORDERS];"
            yield f"{tracked}{named('entire')}({far}{square}, _entire_{square});"
            for called, call in value.items():
                yield f"const {real} {called} = _entire_{square}[{call.order}];"
        case Guarded(divisor, scale, power):
            limit = precision.least
            if scale is not None:
                limit = f"{precision.of_eps(power)} * {_text(scale, precision)}"
            yield f"const {real} {name} = {named('or_nan')}({divisor.text}, {limit});"
        case Call("sin" | "cos", argument) if not is_lean:
            both, angle = kernel.sines[argument], argument.text
            if name == next(iter(both.values())):
                sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                yield f"SIN_COS({angle}, {sine}, {cosine});"
        case Call("eps"):
            yield f"const {real} {name} = {precision.of_eps()};"
        case Call(called):
            own = {} if is_lean else {"atan2": "angle_of"}
            function = {"abs": "fabs", **own}.get(called, called)
            given = ", ".join(argument.text for argument in value.arguments)
            yield f"const {real} {name} = {named(function)}({given});"
        case _:
            kind = "int" if isinstance(value, Compare) else real
            yield f"const {kind} {name} = {_text(value, precision)};"


def _text(expression: Expression, precision: Precision) -> str:
    words = {**_WORDS, "nan": f"({precision.real})NAN"}  # the macro is a float
    return infix(expression, words, precision.literal)


def _entry(array: str, k: int) -> str:
    """Of components that are `apart` from one to the next."""
    return f"{array}[{f'{k} * ' if k > 1 else ''}{'apart' if k else 0}]"


def _rendered(template: str, **facts: object) -> str:
    return resources.environment().get_template(template).render(**facts)


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, _safe)


def _safe(text: str) -> str:
    """Text that neither ends a comment nor escapes anything in it."""
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "\\\\").replace("??", "? ?")
