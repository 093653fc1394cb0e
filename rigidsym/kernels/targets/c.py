"""Kernels in C99: a header and a source without dependencies.

No function allocates memory, recurses or keeps state; the caller owns all arguments and results.
Two more files let `rigidsym build` make a Python module of them. Lean C is for firmware: one plain
function a quantity, in one type, with the functions of <math.h>.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate
from math import pi

from rigidsym.kernels.ir import Call, Compare, Expression, Kernel, Program
from rigidsym.kernels.lowering.naming import NAMES
from rigidsym.kernels.targets import numpy, remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.kernels.targets.precision import EITHER, PRECISIONS, Precision, two_over_pi
from rigidsym.kernels.targets.python import WIDTH, bracketed
from rigidsym.system import resources

RESERVED = numpy.RESERVED | NAMES["c"]  # the Python module's, too
_WIDTH = 92
_TILE = 32  # orientations that are evaluated side by side


def render(program: Program, *, lean: str = "none") -> dict[str, str]:
    """The source, the header, and what makes a Python module of them."""
    name, is_lean = program.name, lean != "none"
    precisions = [p for p in PRECISIONS if lean in ("none", p.real)]
    facts = {"is_lean": is_lean, "has_floats": precisions[-1].suffix == "f", "tile": _TILE}
    about = _comment(remarks.about_module("c/header.txt.jinja", program, **facts))
    texts = (remarks.about_kernel("c/function.txt.jinja", kernel) for kernel in program.kernels)
    each = zip(program.kernels, map(_comment, texts), strict=True)
    header = _rendered(
        "c/header.h.jinja", program, about=about, each=each, is_lean=is_lean, precisions=precisions
    )
    groups = (g for k in program.kernels for g in (k.outputs, *(a.components for a in k.arguments)))
    digits = [f"0x{word:08x}" for word in two_over_pi()]
    own = precisions[0] if is_lean else EITHER
    source = _rendered(
        "c/lean.c.jinja" if is_lean else "c/source.c.jinja",
        program,
        tile=_TILE,
        precisions=[precision.filled(program.last) for precision in precisions],
        functions=[_function(kernel, own, is_lean=is_lean) for kernel in program.kernels],
        own=own,
        two_over_pi=",\n".join("    " + ", ".join(digits[k : k + 6]) for k in range(0, 40, 6)),
        half_pi=repr(pi / 2),
        widths=sorted(set(map(len, groups))),
    )
    if is_lean:
        return {f"{name}.c": source, f"{name}.h": header}
    bodies = {kernel.name: _called(kernel) for kernel in program.kernels}
    types = [(precision.real, precision.suffix) for precision in precisions]
    return {
        f"{name}.c": source,
        f"{name}.h": header,
        f"{name}_c.py": numpy.module_text(program, "c/module.py.jinja", bodies),
        f"{name}_module.c": _rendered("c/module.c.jinja", program, types=types),
    }


def _rendered(template: str, program: Program, **facts: object) -> str:
    """The text of a file; a title neither ends a comment nor escapes anything in it."""
    facts |= {"signature": _signature, "array_signature": _array_signature}
    source, title = resources.environment().get_template(template), _safe(program.title)
    return source.render(program=program, title=title, name=program.name, **facts)


def _function(
    kernel: Kernel, own: Precision, *, is_lean: bool
) -> tuple[Kernel, list[int], list[str]]:
    """The kernel, the places of its arguments among the inputs, and its statements."""
    places = list(accumulate((len(a.components) for a in kernel.arguments), initial=0))
    entries = [_entry("in", k) for k in range(places[-1])]
    lines = []
    if is_lean:
        entries = [f"{a.name}[{k}]" for a in kernel.arguments for k in range(len(a.components))]
        idle = [a.name for a in kernel.arguments if kernel.used.isdisjoint(a.components)]
        lines = [f"(void){name};" for name in idle]
    named = zip(kernel.components, entries, strict=True)
    read = [f"{name} = {entry}" for name, entry in named if name in kernel.used]
    read = read if is_lean or not read else [", ".join(read)]
    lines += [f"const {own.real} {text};" for text in read]
    lines += _statements(kernel, own, is_lean=is_lean)
    for k, output in enumerate(kernel.outputs):
        entry = f"out[{k}]" if is_lean else _entry("out", k)
        lines.append(f"{entry} = {_text(output, own)};")
    # the template indents them
    fitted = [broken(f"    {line}", _WIDTH, " " * 8).removeprefix("    ") for line in lines]
    return kernel, places, fitted


def _called(kernel: Kernel) -> str:
    """The body in Python: the compiled function, with arguments as they are or prepared for it.

    A matrix has no components on one axis, and is always prepared.
    """
    compiled = f"_compiled.{kernel.name}"
    prepared = numpy.called(kernel, compiled)
    if any(len(argument.shape) > 1 for argument in kernel.arguments):
        return prepared
    vectors = [*(argument.name for argument in kernel.arguments), "out"]
    lines = [
        "    if threads == 1:",
        bracketed(8, f"result = {compiled}(", vectors, ")"),
        "        if result is not None:\n            return result",
        prepared,
    ]
    return "\n".join(lines)


# declarations


def _signature(program: Program, kernel: Kernel, precision: Precision) -> str:
    real, name = precision.real, precision.function.format(f"{program.name}_{kernel.name}")
    given = [f"const {real} {a.name}[{len(a.components)}]" for a in kernel.arguments]
    given.append(f"{real} out[{len(kernel.outputs)}]")
    return _prototype(name, given)


def _array_signature(program: Program, kernel: Kernel, precision: Precision) -> str:
    name = precision.function.format(f"{program.name}_{kernel.name}_array")
    items = ["size_t count"]
    for kind, array in (*(("const ", a.name) for a in kernel.arguments), ("", "out")):
        items.append(f"{kind}{precision.real} *{array}")
        items += [f"ptrdiff_t {array}_step", f"ptrdiff_t {array}_stride"]
    return _prototype(name, items)


def _prototype(name: str, parameters: Sequence[str]) -> str:
    """In lines that end with a parameter."""
    whole = ", ".join(parameter.replace(" ", "\xa0") for parameter in parameters)
    return broken(f"void\xa0{name}({whole})", WIDTH, " " * 4)


# statements


def _statements(kernel: Kernel, precision: Precision, *, is_lean: bool) -> Iterator[str]:
    real, named = precision.real, precision.function.format
    for name, value in kernel.statements:
        match value:
            case dict():  # all functions c_k of one square
                square = next(iter(value.values())).argument.text
                tracked, far = ("", "") if is_lean else ("beyond |= ", "far, ")
                yield f"{real} _entire_{square}[ORDERS];"
                yield f"{tracked}{named('entire')}({far}{square}, _entire_{square});"
                for function, call in value.items():
                    yield f"const {real} {function} = _entire_{square}[{call.order}];"
            case Call("sin" | "cos", argument) if not is_lean:
                both, angle = kernel.sines[argument], argument.text
                if name == next(iter(both.values())):
                    # Both are computed in one call; one that the kernel does not use gets a name of
                    # its own.
                    sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                    yield f"SIN_COS({angle}, {sine}, {cosine});"
            case _:
                kind = "int" if isinstance(value, Compare) else real
                yield f"const {kind} {name} = {_text(value, precision, is_lean=is_lean)};"


def _text(expression: Expression, precision: Precision, *, is_lean: bool = False) -> str:
    own = {"abs": "fabs", "atan2": "atan2" if is_lean else "angle_of"}
    names = {each: own.get(each, each) for each in ("sin", "cos", "sqrt", "abs", "atan2", "or_nan")}
    eps, square = precision.eps
    forms = {
        **{function: precision.function.format(name) + "({})" for function, name in names.items()},
        **{"choice": "{0} ? {1} : {2}", "nan": f"({precision.real})NAN"},  # the macro is a float
        **{"eps": eps, "limit0": precision.least, "limit1": f"{eps} * {{}}"},
        "limit2": f"{square} * {{}}",
    }
    return infix(expression, forms, precision.number)


def _entry(array: str, k: int) -> str:
    """Of components that are `apart` from one to the next."""
    return f"{array}[{f'{k} * ' if k > 1 else ''}{'apart' if k else 0}]"


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, _safe)


def _safe(text: str) -> str:
    """Text that neither ends a comment nor escapes anything in it."""
    # Two question marks may begin a trigraph.
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "\\\\").replace("??", "? ?")
