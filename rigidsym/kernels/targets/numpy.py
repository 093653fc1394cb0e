"""Kernels as a Python module that depends only on NumPy, with scalar twins on plain floats."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isnan, prod
from types import MappingProxyType

from rigidsym.kernels.ir import FUNCTIONS, Call, Choice, Kernel, Name, Number, Program
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.targets import python, remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.kernels.targets.python import WIDTH, bracketed, docstring, exploded, tuple_of

TEMPLATE = "numpy/module.py.jinja"
# the last two: of the functions that a page offers to copy, which are these in Python and C
RESERVED = python.RESERVED | {"np", "tan", "ValueError", "ZeroDivisionError", "entire", "fabs"}

_NESTING = ("a float", "a tuple", "a tuple of rows", "a tuple of matrices")

_OF_FLOATS = {"or_nan": "_or_nan_scalar({})", "entire": "_entire_scalar({})", "eps": f"{2.0**-52}"}
_OF_ARRAYS = {
    **{"sin": "_sin({})", "cos": "_cos({})", "eps": "_eps({})", "sqrt": "np.sqrt({})"},
    **{"abs": "np.abs({})", "atan2": "np.arctan2({})", "or_nan": "_or_nan({})"},
    **{"entire": "_entire({})", "nan": "np.nan"},
    "choice": "_where({0}, lambda: {1}, {2})",
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = program.kernels
    of_math = program.called.intersection(FUNCTIONS) - {"abs", "eps"}
    of_math |= {"sqrt", "tan"} if program.has_series else set()
    numbers = (node.value for k in kernels for node in k.nodes if isinstance(node, Number))
    of_math |= {"nan"} if any(map(isnan, numbers)) else set()
    lines = {k.name: [twin_head(k), *_scalar_body(k), "\n", *_block(k)] for k in kernels}
    text = module_text(
        program,
        TEMPLATE,
        {k.name: called(k, f"_{k.name}", f"{k.name}_scalar") for k in kernels},
        {name: "\n".join(texts) for name, texts in lines.items()},
        of_math=of_math,
        series=remarks.series(program, python.SERIES, WIDTH),
        has_choices=any(isinstance(v, Choice) for k in kernels for v in k.values),
        has_halves=any(k.halves for k in kernels),
    )
    return {f"{program.name}.py": text}


def module_text(
    program: Program,
    template: str,
    bodies: Mapping[str, str],
    twins: Mapping[str, str] = MappingProxyType({}),
    *,
    of_math: Iterable[str] = (),
    **more: object,
) -> str:
    """The text of a module for NumPy arrays; `of_math` is what it imports from there.

    `twins` are the functions of one orientation, by the names of kernels. The template may extend
    the one of the NumPy module; only this one has `unwrap`.
    """
    kernels, is_plain = program.kernels, template == TEMPLATE
    endings = ("", "_scalar") if twins else ("",)
    names = [f"{kernel.name}{ending}" for kernel in kernels for ending in endings]
    continuity = program.continuity if is_plain else None
    returned = {k.name: k.returned_arguments for k in kernels if is_plain}
    passing = [f"_{name}: {places}" for name, places in returned.items() if places]
    about = "numpy/unwrap.txt.jinja"
    texts = remarks.paragraphs(about, continuity=continuity) if continuity else [""]
    return python.module_text(
        program,
        template,
        about=python.about_module(
            "numpy/module.txt.jinja", program, is_plain=is_plain, has_twins=bool(twins)
        ),
        names=[*names, *(["unwrap"] if continuity else [])],
        bodies=bodies,
        twins=twins,
        passing=bracketed(0, "_PASSING = {", passing, "}"),
        imports=", ".join(sorted({*of_math, "prod"})),
        continuity=continuity,
        about_unwrap=docstring(texts, indent=4),
        **more,
    )


def called(kernel: Kernel, *functions: str) -> str:
    """The body that passes the arguments on."""
    given = [*functions, str(kernel.shape), "out", "threads", *python.passed(kernel, "np")]
    return bracketed(4, "return _apply(", given, ")")


def twin_head(kernel: Kernel) -> str:
    """The signature and the docstring of a function of plain floats."""
    floats = [f"{name}: float" for name in kernel.components]
    nesting = _NESTING[len(kernel.shape)]
    about = docstring([f"`{kernel.name}` of one orientation; floats to {nesting}."], indent=4)
    kind = "float"
    for _ in kernel.shape:
        kind = f"tuple[{kind}, ...]"
    head = bracketed(0, f"def {kernel.name}_scalar(", floats, f") -> {kind}:")
    return f'{head}\n    """{about}"""'


def outputs(kernel: Kernel, margin: int) -> list[str]:
    """The outputs in lines that fit, behind a margin."""
    return [broken(infix(e), WIDTH - margin - 4, " " * (margin + 4)) for e in kernel.outputs]


def _scalar_body(kernel: Kernel) -> Iterator[str]:
    """The statements of the scalar function, and its fallback where floats raise an error."""
    yield "    try:"
    for name, value in kernel.statements:
        yield python.statement(8, name, value, _OF_FLOATS)
    entries = outputs(kernel, 8 + 4 * len(kernel.shape))
    yield f"        return {nested(entries, kernel.shape, 8, is_open=True)}"
    # Python's floats raise exceptions where those of IEEE 754 become NaN or infinite; the function
    # of arrays then computes the orientation.
    points = [nested(a.components, (len(a.components),), 12) for a in kernel.arguments]
    given = [f"_{kernel.name}", str(kernel.shape), *points]
    yield "    except (ValueError, ZeroDivisionError):"
    yield bracketed(8, "return _exceptional(", given, ")")


def nested(
    items: Sequence[str], shape: Sequence[int], margin: int, *, is_open: bool = False
) -> str:
    """Numbers in the tuples of a shape; a row is in one line if it fits and is not to be open."""
    if not shape:
        (item,) = items
        space = " " * margin
        return f"(\n{space}    {item}\n{space})" if "\n" in item else item
    entries, size = list(items), prod(shape[1:])
    if len(shape) > 1:
        rows = [items[start : start + size] for start in range(0, len(items), size)]
        entries = [nested(row, shape[1:], margin + 4) for row in rows]
    line = tuple_of(entries)
    is_short = len(shape) == 1 and not is_open and len(line) <= WIDTH - margin - len(",")
    if is_short or (len(entries) == 1 and "\n" not in line):
        return line
    return exploded(margin, "(", entries, ")").lstrip()


def _block(kernel: Kernel) -> Iterator[str]:
    """The function of arrays with the components on their first axis."""
    names = Names([*kernel.components, *(a.name for a in kernel.assignments)])
    vectors = [names.fresh(argument.name) for argument in kernel.arguments]
    yield bracketed(0, f"def _{kernel.name}(", vectors, "):")
    for vector, argument in zip(vectors, kernel.arguments, strict=True):
        components = enumerate(argument.components)
        places = {name: f"{vector}[{k}]" for k, name in components if name in kernel.used}
        line = f"    {', '.join(places)} = {', '.join(places.values())}"
        if places and len(line) <= WIDTH:  # to index a few costs half of what unpacking does
            yield line
        else:
            yield from (f"    {name} = {place}" for name, place in places.items())
    if kernel.halves:
        yield bracketed(4, "usual = _usual_angles(", [*map(infix, kernel.halves)], ")")
        yield "    if usual is not None:\n        return usual"
    together = _gathered(kernel)
    for name, value in kernel.statements:
        call = value if isinstance(value, Call) and value.function in ("sin", "cos") else None
        if call is None or len(kernel.sines[call.argument]) < 2:
            yield python.statement(4, name, value, _OF_ARRAYS)
        elif name in together:
            angles = together[name]
            both = [kernel.sines[angle][part] for part in ("sin", "cos") for angle in angles]
            yield python.taken_apart(both, f"_sin_cos({', '.join(a.text for a in angles)})")
        if call is not None and call.function == "cos" and name in kernel.delicate:
            yield bracketed(4, f"{name} = _sharp(", [name, call.argument.text], ")")
    entries = outputs(kernel, 8)
    yield f"    return {nested(entries, (len(entries),), 4, is_open=True)}"


def _gathered(kernel: Kernel) -> dict[str, list[Name]]:
    """Angles whose sines and cosines are taken in one call, by the name of their first sine.

    Angles of one vector; not with a cosine that divides, which is taken anew.
    """
    vectors = {name: a.name for a in kernel.arguments for name in a.components}
    groups: dict[Name | str, list[Name]] = {}
    for angle, pair in kernel.sines.items():
        if len(pair) > 1:
            key = angle if pair["cos"] in kernel.delicate else vectors.get(angle.text, angle)
            groups.setdefault(key, []).append(angle)
    return {next(iter(kernel.sines[a[0]].values())): a for a in groups.values()}
