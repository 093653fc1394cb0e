"""Kernels in C99: a header and a source that need nothing but the language.

No function allocates, recurses or keeps a state; all take and fill what the caller owns. Beside
them stand the two files with which `rigidsym build` makes a Python module of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import pi
from types import ModuleType

from rigidsym.kernels.ir import Kernel, Program
from rigidsym.kernels.lowering.sincos import two_over_pi
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.c.function import CFunction, function, show
from rigidsym.kernels.targets.c.module_files import module_files
from rigidsym.kernels.targets.c.precision import PRECISIONS
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text import remarks, statements
from rigidsym.kernels.targets.text.python_layout import filled
from rigidsym.system import resources

_WORDS = (
    "out far beyond sin_cos sin_cosf or_nan or_nanf entire entiref sqrtf fabs fabsf NULL angle_of "
    "angle_off SIZE_MAX PTRDIFF_MAX size_t ptrdiff_t uint32_t uint64_t TILE SHUFFLED INLINED tile "
    "found rows count at i j"
)
RESERVED = numpy.RESERVED | {*_WORDS.split()}  # the Python module's, too
_WIDTH = 92
_TILE = 32  # orientations that are evaluated side by side
_WHOLE = frozenset({1, 2, 3, 4, 8})  # lengths of rows that compilers put together by whole vectors


def render(program: Program) -> dict[str, str]:
    """The source, the header, and what makes a Python module of them."""
    kernels = list(map(_fitted, program.kernels))
    functions = [function(program.name, kernel) for kernel in kernels]
    return {
        f"{program.name}.c": _source(program, kernels, functions),
        f"{program.name}.h": _header(program, kernels, functions),
        **module_files(program, kernels),
    }


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The Python module, built in a folder that goes away with the process."""
    from rigidsym.kernels.targets.c.compiling import load_built

    return load_built(name, files)


def _fitted(kernel: Kernel) -> Kernel:
    room = _WIDTH - len("    const double  = ;")
    return narrowed(kernel, show, line=room, output=room)


def _source(
    program: Program,
    kernels: Sequence[Kernel],
    functions: Sequence[CFunction],
) -> str:
    calls = [call for kernel in kernels for call in statements.calls_of(kernel).values()]
    orders = [call.order for call in calls if call.order is not None]
    called = {call.function for call in calls}
    taken = sorted({len(a.components) for kernel in kernels for a in kernel.arguments})
    given = sorted({len(kernel.outputs) for kernel in kernels})
    return _template("c/source.c.jinja").render(
        title=_safe(program.title),
        name=program.name,
        tile=_TILE,
        has_angles=bool(orders) or not called.isdisjoint(("sin", "cos")),
        has_roots=bool(orders) or not called.isdisjoint(("sqrt", "abs", "atan2")),
        has_arctangents="atan2" in called,
        has_guards=any(map(statements.guards_of, kernels)),
        has_series=bool(orders),
        orders=max(2, *orders) + 1 if orders else 0,
        precisions=[precision.filled(max(orders, default=0)) for precision in PRECISIONS],
        two_over_pi=_words(),
        half_pi=repr(pi / 2),
        takes=[(count, range(count)) for count in taken],
        gives=[_columns(count) for count in given],
        has_fours=not _WHOLE.issuperset(given),
        functions=functions,
    )


def _columns(count: int) -> tuple[int, range, range]:
    """A length of rows, the columns written one by one, and the first of each four others."""
    if count in _WHOLE:
        return count, range(count), range(0)
    return count, range(count - count % 4, count), range(0, count - 3, 4)


def _words() -> str:
    words = [f"0x{word:08x}" for word in two_over_pi()]
    return ",\n".join("    " + ", ".join(words[k : k + 6]) for k in range(0, len(words), 6))


def _header(
    program: Program,
    kernels: Sequence[Kernel],
    functions: Sequence[CFunction],
) -> str:
    about = [*_about(program), *remarks.remarks(kernels), *_beside(program)]
    return _template("c/header.h.jinja").render(
        about=comment([*about, remarks.GENERATED]),
        guard=f"{program.name.upper()}_H",
        precisions=PRECISIONS,
        functions=[
            {"about": comment(_about_kernel(kernel)), **made.declared()}
            for kernel, made in zip(kernels, functions, strict=True)
        ],
    )


def _template(name: str):  # type: ignore[no-untyped-def]  # Jinja's own type
    return resources.environment(trim_blocks=True, lstrip_blocks=True).get_template(name)


def _about(program: Program) -> list[str | Sequence[str]]:
    """The paragraphs at the head of the header."""
    return [
        f"{program.title}: functions in C99.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, in radians and SI units:",
        [f"  {a.name}[{len(a.components)}]  {a.about}" for a in program.arguments],
        "Matrices are filled row by row. Names that end in f are of type float. An array function "
        "serves `count` orientations: from one to the next an argument goes on by its `step` (0 "
        "repeats one), from one component to the next by its `stride`, both in elements; rows "
        "without gaps, a step of the row's length and a stride of 1, are the fastest. `out` may "
        "not overlap an argument.",
        "Sine and cosine are evaluated here, within 2 eps of their size (eps is 2^-52 in double, "
        "2^-23 in float) at any finite angle.",
        *remarks.errors(program.kernels),
        "No function allocates, recurses or keeps a state; an array function takes room for "
        f"{_TILE} orientations on the stack.",
    ]


def _about_kernel(kernel: Kernel) -> list[str | Sequence[str]]:
    return [
        remarks.headline(kernel),
        _vectors(kernel),
        *kernel.remarks,
        remarks.cost(kernel),
        *remarks.bound(kernel),
        *remarks.poles(kernel),
    ]


def _vectors(kernel: Kernel) -> list[str]:
    """Lines that say what a function takes and fills."""
    rows = [
        f"  {a.name}[{len(a.components)}]  {', '.join(a.components)}{_units(a.units)}"
        for a in kernel.arguments
    ]
    unit = f"  in {kernel.unit}" if kernel.unit else ""
    shape = f"  {' by '.join(map(str, kernel.shape))}, row by row" if len(kernel.shape) > 1 else ""
    return [*rows, f"  out[{len(kernel.outputs)}]{shape}{unit}"]


def _units(units: Sequence[str]) -> str:
    distinct = list(dict.fromkeys(unit or "1" for unit in units))
    return f" in {', '.join(distinct)}" if any(units) else ""


def _beside(program: Program) -> Iterator[str]:
    """Remarks on conversions."""
    yield from program.remarks
    if program.unwrapping:
        yield "unwrap is only in the Python module, since it needs room for a trajectory."


def comment(paragraphs: Sequence[str | Sequence[str]]) -> str:
    """Lines of a comment, which no text can end."""
    blocks = (filled(paragraph, _WIDTH - 3) for paragraph in paragraphs)
    text = _safe("\n\n".join("\n".join(block) for block in blocks))
    return "\n".join(f" * {line}".rstrip() for line in text.split("\n"))


def _safe(text: str) -> str:
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\\", "\\\\").replace("??", "? ?")
