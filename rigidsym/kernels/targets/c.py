"""Kernels in C99: a header and a source without dependencies.

No function allocates memory, recurses or keeps state; the caller owns all arguments and results.
Two more files let `rigidsym build` make a Python module of them; without arrays, or in one
precision, there is a test instead.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from textwrap import indent, wrap
from types import ModuleType
from typing import Any

from rigidsym.kernels.ir import (
    Call,
    Compare,
    Expression,
    Guarded,
    Kernel,
    Program,
    functions_of,
    last_order,
    names_in,
)
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.lowering.trigonometry import two_over_pi
from rigidsym.kernels.targets import numpy, remarks
from rigidsym.kernels.targets.expected_values import samples_of
from rigidsym.kernels.targets.infix import infix
from rigidsym.kernels.targets.precision import EITHER, PRECISIONS, Precision
from rigidsym.kernels.targets.python import WIDTH, bracketed
from rigidsym.system import resources

_NAMES = (
    "out far beyond sin_cos sin_cosf or_nan or_nanf entire entiref sqrtf fabs fabsf NULL angle_of "
    "angle_off SIZE_MAX PTRDIFF_MAX size_t ptrdiff_t uint32_t uint64_t TILE MOST SHUFFLED SHUFFLE "
    "INLINED STREAMED STREAM STREAMf END_STREAM HELPER CLONES CLONE "
    "CLONED expected apart REAL WORD FN LIT EPS LEAST EVALUATE SIN_COS TILED GIVEN "
    "PARAMETERS ORDERS AHEAD prefetch in given count"
)
RESERVED = numpy.RESERVED | {*_NAMES.split()}  # the Python module's, too
_WIDTH = 92
_TILE = 32  # orientations that are evaluated side by side
_WORDS = {"choice": "{0} ? {1} : {2}"}


@dataclass(frozen=True, kw_only=True, slots=True)
class Contents:
    """What a source holds; the values are those of the target's options."""

    precision: str = "both"
    arrays: bool = True
    libm: bool = False

    @property
    def is_module(self) -> bool:
        """Whether a Python module can be made of it."""
        return self.arrays and self.precision == "both"


def render(program: Program, **options: Any) -> dict[str, str]:
    """The source, the header, and what makes a Python module of them, or else a test."""
    contents, name = Contents(**options), program.name
    room = _WIDTH - len("    const double  = ;")
    kernels = [
        narrowed(kernel, lambda e: infix(e, _WORDS), line=room, output=room)
        for kernel in program.kernels
    ]
    precisions = [p for p in PRECISIONS if contents.precision in ("both", p.real)]
    files = {
        f"{name}.c": _source(program, kernels, precisions, contents),
        f"{name}.h": _header(program, kernels, precisions, contents),
    }
    if contents.is_module:
        functions = [numpy.function(kernel, _called(kernel)) for kernel in program.kernels]
        face = numpy.module_text(program, "c/module.py.jinja", functions, name=name)
        return files | {f"{name}_c.py": face, f"{name}_module.c": _module(name, kernels)}
    tests = []
    for p in precisions:
        tested = [
            {"name": f"{name}_{k.name}", "outputs": len(k.outputs), "samples": samples}
            for k in kernels
            if (samples := list(samples_of(k, p)))
        ]
        tests.append({"real": p.real, "suffix": p.suffix, "functions": tested})
    test = _rendered("c/test.c.jinja", name=name, precisions=tests)
    return files | {f"{name}_test.c": test}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The Python module, compiled once a machine."""
    from rigidsym.kernels.targets.compiling import build, load_built

    return load_built(f"{name}_c", files, lambda folder: build(folder / f"{name}.c"))


def _source(
    program: Program, kernels: Sequence[Kernel], precisions: Sequence[Precision], contents: Contents
) -> str:
    called, last = functions_of(kernels), last_order(kernels)
    groups = (g for k in kernels for g in (k.outputs, *(a.components for a in k.arguments)))
    typed = EITHER if contents.arrays or len(precisions) > 1 else precisions[0]
    digits = [f"0x{word:08x}" for word in two_over_pi()]
    return _rendered(
        "c/source.c.jinja",
        title=_safe(program.title),
        name=program.name,
        tile=_TILE,
        arrays=contents.arrays,
        libm=contents.libm,
        has_angles=not contents.libm and (last >= 0 or not called.isdisjoint(("sin", "cos"))),
        has_arctangents=not contents.libm and "atan2" in called,
        has_guards=any(kernel.guards for kernel in kernels),
        has_series=last >= 0,
        orders=max(2, last) + 1,
        is_both=len(precisions) > 1,
        is_typed=typed is EITHER,
        precisions=[{**p.filled(last), "eps": p.of_eps(), "least": p.least} for p in precisions],
        functions=[_function(program, kernel, typed, contents) for kernel in kernels],
        two_over_pi=",\n".join("    " + ", ".join(digits[k : k + 6]) for k in range(0, 40, 6)),
        half_pi=repr(pi / 2),
        widths=sorted(set(map(len, groups))),
    )


def _header(
    program: Program, kernels: Sequence[Kernel], precisions: Sequence[Precision], contents: Contents
) -> str:
    has_floats = contents.precision != "double"
    options = {"arrays": contents.arrays, "libm": contents.libm, "has_floats": has_floats}
    about = remarks.about_module("c/header.txt.jinja", program, tile=_TILE, **options)
    functions = []
    for kernel in kernels:
        declared = []
        for p in precisions:
            declared.append(_signature(program, kernel, p))
            declared += [_array_signature(program, kernel, p)] if contents.arrays else []
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
    prepared = numpy.called("_apply", kernel, compiled)
    if any(argument.is_matrix for argument in kernel.arguments):
        return prepared
    vectors = [*(argument.name for argument in kernel.arguments), "out"]
    result = "both" if kernel.parts else "result"
    lines = [
        "    if threads == 1:",
        bracketed(8, f"{result} = {compiled}(", vectors, ")"),
        f"        if {result} is not None:",
        indent(numpy.parted(kernel) if kernel.parts else f"    return {result}", " " * 8),
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


def _function(
    program: Program, kernel: Kernel, precision: Precision, contents: Contents
) -> dict[str, Any]:
    """The pieces of text that the template of the source places."""
    body = _Body(kernel, precision, contents)
    ends = [0]
    for argument in kernel.arguments:
        ends.append(ends[-1] + len(argument.components))
    return {
        "name": kernel.name,
        "signature": _signature(program, kernel, precision),
        "array_signature": _array_signature(program, kernel, precision),
        "arguments": [
            {"name": a.name, "size": len(a.components), "place": place}
            for a, place in zip(kernel.arguments, ends, strict=False)
        ],
        "inputs": ends[-1],
        "outputs": len(kernel.outputs),
        "lines": list(body.side_by_side() if contents.arrays else body.plain()),
    }


@dataclass(frozen=True, slots=True)
class _Body:
    """The statements of a kernel in one precision."""

    kernel: Kernel
    precision: Precision
    contents: Contents

    def side_by_side(self) -> Iterator[str]:
        """Of a function of one row among others, whose components are `apart`."""
        components = enumerate(self.kernel.components)
        read = [f"{name} = {_entry('in', k)}" for k, name in components if name in self.kernel.used]
        unbroken = ", ".join(item.replace(" ", "\xa0") for item in read)
        text = f"    const {self.precision.real} {unbroken};"
        for line in wrap(text, _WIDTH, subsequent_indent=" " * 8) if read else ():
            yield line.replace("\xa0", " ").removeprefix("    ")
        for name, value in self.kernel.statements:
            yield from self._lines(name, value)
        for k, output in enumerate(self.kernel.outputs):
            yield f"{_entry('out', k)} = {self._text(output)};"

    def plain(self) -> Iterator[str]:
        """Of a function of one orientation; an entry of the result follows the values it needs.

        So few values wait at a time, and the compiler needs little stack for them.
        """
        kernel, lines = self.kernel, list[str]()
        waiting = dict(enumerate(kernel.outputs))
        defined = {*kernel.components}
        for name, value in (("", {}), *kernel.statements):
            lines += self._lines(name, value) if name else ()
            defined |= {*value} if isinstance(value, dict) else {*self._defined_by(name)}
            for k, output in tuple(waiting.items()):
                if defined.issuperset(names_in(output)):
                    lines.append(f"out[{k}] = {self._text(waiting.pop(k))};")
        used = set(re.findall(r"\w+", "\n".join(lines)))
        for a in kernel.arguments:
            if kernel.used.isdisjoint(a.components):
                yield f"(void){a.name};"
        for a in kernel.arguments:
            for k, name in enumerate(a.components):
                if name in used:
                    yield f"const {self.precision.real} {name} = {a.name}[{k}];"
        yield from lines

    def _defined_by(self, name: str) -> Iterable[str]:
        """The names of a statement: own sines and cosines of one angle come together."""
        call = self.kernel.calls.get(name)
        if self.contents.libm or call is None or call.function not in ("sin", "cos"):
            return (name,)
        both = self.kernel.sines[call.argument]
        return both.values() if name == next(iter(both.values())) else ()

    def _reduced(self, helper: str, *arguments: str) -> str:
        """A call of a helper that reduces angles, in arrays the far ones later."""
        called = self.precision.named(helper)
        if self.contents.libm:
            return f"{called}({', '.join(arguments)});"
        tracked, far = ("beyond |= ", "far") if self.contents.arrays else ("(void)", "1")
        return f"{tracked}{called}({', '.join((far, *arguments))});"

    def _lines(self, name: str, value: Expression | dict[str, Call]) -> Iterator[str]:
        real, named = self.precision.real, self.precision.named
        match value:
            case dict():  # all functions c_k of one square
                (square,) = {call.argument.text for call in value.values()}
                yield f"{real} _entire_{square}[ORDERS];"
                yield self._reduced("entire", square, f"_entire_{square}")
                for called, call in value.items():
                    yield f"const {real} {called} = _entire_{square}[{call.order}];"
            case Guarded(divisor, scale, power):
                limit = self.precision.least
                if scale is not None:
                    limit = f"{self.precision.of_eps(power)} * {self._text(scale)}"
                yield f"const {real} {name} = {named('or_nan')}({divisor.text}, {limit});"
            case Call("sin" | "cos", argument) if not self.contents.libm:
                both, angle = self.kernel.sines[argument], argument.text
                if name == next(iter(both.values())):
                    sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                    if self.contents.arrays:
                        yield f"SIN_COS({angle}, {sine}, {cosine});"
                    else:
                        yield f"{real} {sine}, {cosine};"
                        yield self._reduced("sin_cos", angle, f"&{sine}", f"&{cosine}")
            case Call("eps"):
                yield f"const {real} {name} = {self.precision.of_eps()};"
            case Call(called):
                own = {} if self.contents.libm else {"atan2": "angle_of"}
                function = {"abs": "fabs", **own}.get(called, called)
                given = ", ".join(argument.text for argument in value.arguments)
                yield f"const {real} {name} = {named(function)}({given});"
            case _:
                kind = "int" if isinstance(value, Compare) else real
                yield f"const {kind} {name} = {self._text(value)};"

    def _text(self, expression: Expression) -> str:
        words = {**_WORDS, "nan": f"({self.precision.real})NAN"}  # the macro is a float
        is_explicit = not self.contents.is_module
        return infix(expression, words, self.precision.literal, explicit=is_explicit)


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
