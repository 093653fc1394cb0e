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

from rigidsym.kernels.ir import Kernel, Program, functions_of, last_order
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.lowering.trigonometry import two_over_pi
from rigidsym.kernels.targets.c.expected_values import samples_of
from rigidsym.kernels.targets.c.function import Contents, Function, show
from rigidsym.kernels.targets.c.module_files import module_files
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text import remarks
from rigidsym.kernels.targets.text.precision import EITHER, PRECISIONS, Precision
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
    from rigidsym.kernels.targets.c.compiling import build, load_built

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
    return _template("c/header.h.jinja").render(
        about=_comment(_about(program, functions[0][0].contents)),
        guard=f"{program.name.upper()}_H",
        arrays=functions[0][0].contents.arrays,
        functions=[
            {"about": _comment(_about_kernel(both[0].kernel)), "precisions": both}
            for both in zip(*functions, strict=True)
        ],
    )


def _template(name: str) -> Any:
    return resources.environment().get_template(name)


def _about(program: Program, contents: Contents) -> list[remarks.Paragraph]:
    """The paragraphs at the head of the header."""
    arrays = (
        "An array function computes `count` orientations. The `step` of an argument is the "
        "distance from one orientation to the next (0 uses one for all), its `stride` the distance "
        "from one component to the next, both in elements; contiguous rows, with a step of the "
        "row's length and a stride of 1, are the fastest. `out` may not overlap an argument.",
        "No function allocates memory, recurses or keeps state; an array function keeps "
        f"{_TILE} orientations on the stack.",
        "With -DCLONES, gcc and clang for x86-64 compile array functions that choose between AVX2, "
        "AVX-512 and neither when they are called.",
    )
    one = (
        "`out` may not overlap an argument.",
        "No function allocates memory, recurses or keeps state.",
    )
    sines = (
        "Sine, cosine and atan2 are taken from <math.h>; their errors add to the errors of the "
        "functions."
        if contents.libm
        else "Sine and cosine are computed here, within 2 eps of their size (eps is 2^-52 in "
        "double, 2^-23 in float) at any finite angle."
    )
    floats = "" if contents.precision == "double" else "Names that end in f are of type float. "
    first, *others = arrays if contents.arrays else one
    return remarks.about_module(
        program,
        "functions in C99",
        "Arguments, in radians and SI units:",
        [f"  {a.name}[{len(a.components)}]  {a.about}" for a in program.arguments],
        f"Matrices are filled row by row. {floats}{first}",
        *others,
        sines,
    )


def _about_kernel(kernel: Kernel) -> list[remarks.Paragraph]:
    rows = [
        f"  {a.name}[{len(a.components)}]  {', '.join(a.components)}{remarks.in_units(a.units)}"
        for a in kernel.arguments
    ]
    unit = f"  in {kernel.unit}" if kernel.unit else ""
    shape = f"  {' by '.join(map(str, kernel.shape))}, row by row" if len(kernel.shape) > 1 else ""
    return remarks.about_kernel(kernel, [*rows, f"  out[{len(kernel.outputs)}]{shape}{unit}"])


def _comment(paragraphs: Sequence[remarks.Paragraph]) -> str:
    return remarks.comment(paragraphs, _WIDTH, _safe)


def _safe(text: str) -> str:
    """Text that neither ends a comment nor escapes anything in it."""
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "\\\\").replace("??", "? ?")
