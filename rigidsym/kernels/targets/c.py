"""Kernels in C99: a header and a source without dependencies.

No function allocates memory, recurses or keeps state; the caller owns all arguments and results.
Two more files let `rigidsym build` make a Python module of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import pi
from types import ModuleType
from typing import Any

from rigidsym.kernels.ir import Program, functions_of, last_order
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.lowering.trigonometry import two_over_pi
from rigidsym.kernels.targets import numpy, remarks
from rigidsym.kernels.targets.c_function import Contents, Function, show
from rigidsym.kernels.targets.c_module import module_files
from rigidsym.kernels.targets.expected_values import samples_of
from rigidsym.kernels.targets.precision import EITHER, PRECISIONS, Precision
from rigidsym.system import resources

_WORDS = (
    "out far beyond sin_cos sin_cosf or_nan or_nanf entire entiref sqrtf fabs fabsf NULL angle_of "
    "angle_off SIZE_MAX PTRDIFF_MAX size_t ptrdiff_t uint32_t uint64_t TILE MOST SHUFFLED SHUFFLE "
    "INLINED STREAMED STREAM STREAMf END_STREAM HELPER CLONES CLONE "
    "CLONED expected apart REAL WORD FN LIT EPS LEAST EVALUATE SIN_COS TILED GIVEN "
    "PARAMETERS ORDERS in given count"
)
RESERVED = numpy.RESERVED | {*_WORDS.split()}  # the Python module's, too
_WIDTH = 92
_TILE = 32  # orientations that are evaluated side by side


def render(program: Program, **options: Any) -> dict[str, str]:
    """The source, the header, and what makes a Python module of them, or else a test."""
    contents = Contents(**options)
    room = _WIDTH - len("    const double  = ;")
    kernels = [narrowed(kernel, show, line=room, output=room) for kernel in program.kernels]
    precisions = [p for p in PRECISIONS if contents.precision in ("both", p.real)]
    functions = [
        [Function(f"{program.name}_{kernel.name}", kernel, p, contents) for kernel in kernels]
        for p in precisions
    ]
    return {
        f"{program.name}.c": _source(program, precisions, functions[0]),
        f"{program.name}.h": _header(program, functions),
        **(module_files(program, kernels) if contents.is_module else _test(program, functions)),
    }


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The Python module, compiled once a machine."""
    from rigidsym.kernels.targets.compiling import build, load_built

    return load_built(f"{name}_c", files, lambda folder: build(folder / f"{name}.c"))


def _source(
    program: Program, precisions: Sequence[Precision], functions: Sequence[Function]
) -> str:
    kernels, contents = [function.kernel for function in functions], functions[0].contents
    called, last = functions_of(kernels), last_order(kernels)
    groups = (g for k in kernels for g in (k.outputs, *(a.components for a in k.arguments)))
    typed = EITHER if contents.arrays or len(precisions) > 1 else precisions[0]
    written = [
        f.pieces() if contents.arrays else {"plain": f.plain()}
        for f in (replace(function, precision=typed) for function in functions)
    ]
    return _template("c/source.c.jinja").render(
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
        typed=typed,
        precisions=[{**p.filled(last), "eps": p.of_eps(), "least": p.least} for p in precisions],
        functions=written,
        two_over_pi=_words(),
        half_pi=repr(pi / 2),
        widths=sorted(set(map(len, groups))),
    )


def _words() -> str:
    words = [f"0x{word:08x}" for word in two_over_pi()]
    return ",\n".join("    " + ", ".join(words[k : k + 6]) for k in range(0, len(words), 6))


def _test(program: Program, functions: Sequence[Sequence[Function]]) -> dict[str, str]:
    """NAME_test.c, which compares a few results of each function."""
    precisions = [
        {
            "real": made[0].precision.real,
            "suffix": made[0].precision.suffix,
            "functions": [
                {"name": f.name, "outputs": len(f.kernel.outputs), "samples": samples}
                for f in made
                if (samples := list(samples_of(f)))
            ],
        }
        for made in functions
    ]
    text = _template("c/test.c.jinja").render(name=program.name, precisions=precisions)
    return {f"{program.name}_test.c": text}


def _header(program: Program, functions: Sequence[Sequence[Function]]) -> str:
    contents = functions[0][0].contents
    about = remarks.about_module(
        "c/header.txt.jinja",
        program,
        has_floats=contents.precision != "double",
        arrays=contents.arrays,
        libm=contents.libm,
        tile=_TILE,
    )
    kernels = [one.kernel for one in functions[0]]
    comments = [_comment(remarks.about_kernel("c/function.txt.jinja", k)) for k in kernels]
    each = zip(comments, zip(*functions, strict=True), strict=True)
    return _template("c/header.h.jinja").render(
        about=_comment(about),
        guard=f"{program.name.upper()}_H",
        arrays=contents.arrays,
        functions=[{"about": text, "precisions": both} for text, both in each],
    )


def _template(name: str) -> Any:
    return resources.environment().get_template(name)


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, _safe)


def _safe(text: str) -> str:
    """Text that neither ends a comment nor escapes anything in it."""
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "\\\\").replace("??", "? ?")
