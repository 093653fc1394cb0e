"""Kernels as a Python module that depends only on NumPy, with scalar twins on plain floats."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from math import prod
from types import ModuleType

from rigidsym.kernels import loaded
from rigidsym.kernels.ir import FUNCTIONS, Call, Kernel, Name, Program, functions_of, last_order
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.targets import python, remarks
from rigidsym.kernels.targets.infix import infix
from rigidsym.kernels.targets.python import WIDTH, bracketed, docstring, exploded, tuple_of
from rigidsym.system import resources

TEMPLATE = "numpy/module.py.jinja"
# the last two: of the functions that a page offers to copy, which are these in Python and C
RESERVED = python.RESERVED | {"np", "tan", "ValueError", "ZeroDivisionError", "entire", "fabs"}

_NESTING = ("a float", "a tuple", "a tuple of rows", "a tuple of matrices")
_SPELLED = len("float, float, float, float")  # longer types are those of tuples of any length

_OF_FLOATS = {"or_nan": "_or_nan_scalar", "entire": "_entire_scalar"}
OF_ARRAYS: Mapping[str, str] = {
    **{"sin": "_sin", "cos": "_cos", "eps": "_eps", "sqrt": "np.sqrt", "abs": "np.abs"},
    **{"atan2": "np.arctan2", "or_nan": "_or_nan", "entire": "_entire", "nan": "np.nan"},
    "choice": "np.where({0}, {1}, {2})",
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    return {f"{program.name}.py": module_text(program)}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself."""
    return loaded.load(name, files)


def module_text(
    program: Program,
    template: str = TEMPLATE,
    *,
    compute: str = "_compute",
    at_once: str = "",
    empty: str = "np.empty(whole, dtype)",
    words: Mapping[str, str] = OF_ARRAYS,
    **more: object,
) -> str:
    """The text of a module, in a template that may extend this one and needs more.

    `compute` is the function there that computes all orientations, `at_once` that of each kernel
    which is tried first, `empty` a new array for results, and `words` how functions of arrays are
    written.
    """
    kernels = list(map(_fitted, program.kernels))
    is_plain = template == TEMPLATE
    names = [f"{kernel.name}{twin}" for kernel in kernels for twin in ("", "_scalar")]
    called, has_series = functions_of(kernels), last_order(kernels) >= 0
    of_math = called.intersection(FUNCTIONS) - {"abs", "eps"} | {"prod"}
    of_math |= {"sqrt", "tan"} if has_series else set()
    of_math |= {"nan"} if any(kernel.gives_nan for kernel in kernels) else set()
    continuity = program.continuity if is_plain else None
    about_unwrap = ""
    if continuity:
        texts = remarks.paragraphs("numpy/unwrap.txt.jinja", continuity=continuity)
        about_unwrap = docstring(texts, indent=4)
    return (
        resources.environment()
        .get_template(template)
        .render(
            about=python.about_module("numpy/module.txt.jinja", program, is_plain=is_plain),
            imports=f"from math import {', '.join(sorted(of_math))}\n",
            exports=python.exports([*names, *(["unwrap"] if continuity else [])]),
            components=python.components(program),
            functions=[_function(kernel, at_once, words) for kernel in kernels],
            has_parts=any(kernel.parts for kernel in kernels),
            has_guards=any(kernel.guards for kernel in kernels),
            has_series=has_series,
            series=python.series(kernels),
            has_matrices=any(a.is_matrix for kernel in kernels for a in kernel.arguments),
            has_eps="eps" in called,
            continuity=continuity,
            about_unwrap=about_unwrap,
            compute=compute,
            empty=empty,
            **more,
        )
    )


def needs_eps(kernel: Kernel) -> bool:
    """Whether its values depend on the eps of the result's type."""
    return bool(kernel.guards) or "eps" in functions_of([kernel])


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit: a scalar twin's assignments and the rows of its outputs."""
    depth = max(map(len, kernel.results)) + (1 if kernel.parts else 0)
    return narrowed(kernel, infix, line=WIDTH - 8, output=WIDTH - 8 - 4 * depth - len(","))


def _function(kernel: Kernel, at_once: str, words: Mapping[str, str]) -> dict[str, str]:
    """The pieces of text that stand for one kernel in the template."""
    block, scalar = f"_{kernel.name}", f"{kernel.name}_scalar"
    numbers = f"_in_a_row({scalar})" if kernel.parts else scalar
    given = [block, numbers, str(kernel.shape), "out", "threads", *python.passed(kernel, "np")]
    floats = [f"{name}: float" for name in kernel.components]
    each = list(map(_floats, kernel.results))
    kind = each[0] if len(each) < 2 else f"tuple[{', '.join(each)}]"
    if len(kind) > WIDTH - len(") -> :"):
        kind = exploded(0, "tuple[", each, "]")
    nesting = " and ".join(_NESTING[len(shape)] for shape in kernel.results)
    twin = [f"`{kernel.name}` of one orientation; floats to {nesting}."]
    return {
        "signature": python.signature(kernel, "out: Array | None = None", "threads: int = 1"),
        "about": python.about_function(kernel),
        "body": _body(kernel, given, at_once.format(kernel.name)),
        "ufunc": python.ufunc(kernel),
        "scalar_signature": bracketed(0, f"def {scalar}(", floats, f") -> {kind}:"),
        "scalar_about": docstring(twin, indent=4),
        "scalar_body": "\n".join(_scalar_body(kernel)),
        "block": "\n".join(_block(kernel, words)),
    }


def _floats(shape: Sequence[int]) -> str:
    """The type of one value in floats: tuple[float, float, float]."""
    if not shape:
        return "float"
    inner = _floats(shape[1:])
    spelled = ", ".join([inner] * shape[0])
    return f"tuple[{spelled if len(spelled) <= _SPELLED else f'{inner}, ...'}]"


def _body(kernel: Kernel, arguments: Sequence[str], at_once: str) -> str:
    """The call that computes the result; several results are parts of one array.

    `at_once` is a function that may give the result, or None, with less ado.
    """
    result = "both" if kernel.parts else "result"
    lines = [bracketed(4, f"{result} = _apply(", arguments, ")")]
    if at_once and not any(argument.is_matrix for argument in kernel.arguments):
        vectors = [argument.name for argument in kernel.arguments]
        lines = [
            f"    {result} = None",
            "    if threads == 1:",
            bracketed(8, f"{result} = {at_once}(", [*vectors, "out"], ")"),
            f"    if {result} is None:",
            bracketed(8, f"{result} = _apply(", arguments, ")"),
        ]
    elif not kernel.parts:
        return bracketed(4, "return _apply(", arguments, ")")
    parts = [result, *map(str, kernel.parts)]
    returned = bracketed(4, "return _parted(", parts, ")") if kernel.parts else "    return result"
    return "\n".join([*lines, returned])


def _scalar_body(kernel: Kernel) -> Iterator[str]:
    """The statements of the scalar function, and its fallback where floats raise an error."""
    yield "    try:"
    for name, value in kernel.statements:
        is_eps = isinstance(value, Call) and value.function == "eps"
        line = f"        {name} = {2.0**-52!r}"
        yield line if is_eps else python.statement(8, name, value, _OF_FLOATS)
    outputs, place = list(map(infix, kernel.outputs)), 0
    values = []
    for shape in kernel.results:
        entries = outputs[place : place + prod(shape)]
        values.append(_nested(entries, shape, 12 if kernel.parts else 8, is_open=not kernel.parts))
        place += prod(shape)
    yield exploded(8, "return (", values, ")") if kernel.parts else f"        return {values[0]}"
    points = [_nested(a.components, (len(a.components),), 12) for a in kernel.arguments]
    given = [f"_{kernel.name}", str(kernel.parts or kernel.shape), *points]
    yield "    except (ValueError, ZeroDivisionError):"
    yield bracketed(8, "return _exceptional(", given, ")")


def _nested(
    items: Sequence[str], shape: Sequence[int], margin: int, *, is_open: bool = False
) -> str:
    """Numbers in the tuples of a shape; a row is in one line if it fits and is not to be open."""
    if not shape:
        return items[0]
    size = prod(shape[1:])
    rows = [items[start : start + size] for start in range(0, len(items), size)]
    entries = [_nested(row, shape[1:], margin + 4) for row in rows]
    line = tuple_of(entries)
    is_short = len(shape) == 1 and not is_open and len(line) <= WIDTH - margin - len(",")
    if is_short or len(entries) == 1:
        return line
    return exploded(margin, "(", entries, ")").lstrip()


def _block(kernel: Kernel, words: Mapping[str, str]) -> Iterator[str]:
    """The function of arrays with the components on their first axis.

    An output that is a component is a copy, since writing results may change the arguments.
    """
    names = Names([*kernel.components, *(a.name for a in kernel.assignments)])
    vectors = [names.fresh(argument.name) for argument in kernel.arguments]
    more = ["_eps=None"] if "_eps" in words["or_nan"] and needs_eps(kernel) else []
    yield bracketed(0, f"def _{kernel.name}(", [*vectors, *more], "):")
    for vector, argument in zip(vectors, kernel.arguments, strict=True):
        yield from _unpacked(vector, argument.components, kernel.used)
    together = _gathered(kernel)
    for name, value in kernel.statements:
        call = value if isinstance(value, Call) and value.function in ("sin", "cos") else None
        if call is None or len(kernel.sines[call.argument]) < 2:
            yield python.statement(4, name, value, words)
        elif name in together:
            angles = together[name]
            both = [kernel.sines[angle][part] for part in ("sin", "cos") for angle in angles]
            given = [angle.text for angle in angles]
            yield bracketed(4, f"{', '.join(both)} = _sin_cos(", given, ")")
        if call is not None and call.function == "cos" and name in kernel.delicate:
            yield bracketed(4, f"{name} = _sharp(", [name, call.argument.text], ")")
    outputs = [
        f"+{output.text}"
        if isinstance(output, Name) and output.text in kernel.components
        else infix(output)
        for output in kernel.outputs
    ]
    yield f"    return {_nested(outputs, (len(outputs),), 4, is_open=True)}"


def _unpacked(vector: str, components: Sequence[str], used: Container[str]) -> Iterator[str]:
    """The components of an array; to index a few costs half of what unpacking does."""
    places = {name: f"{vector}[{k}]" for k, name in enumerate(components) if name in used}
    line = f"    {', '.join(places)} = {', '.join(places.values())}"
    if places and len(line) <= WIDTH:
        yield line
    elif places:
        yield from (f"    {name} = {place}" for name, place in places.items())


def _gathered(kernel: Kernel) -> dict[str, list[Name]]:
    """Angles whose sines and cosines are taken in one call, by the name of their first sine.

    Neighbours of one vector, as many as a line has room for; not with a cosine that divides,
    which is taken anew.
    """
    vectors = {name: a.name for a in kernel.arguments for name in a.components}
    groups: dict[str, list[Name]] = {}
    last, room = "", 0
    for angle, pair in kernel.sines.items():
        if len(pair) < 2:
            continue
        is_alone = angle.text not in vectors or pair["cos"] in kernel.delicate
        vector = "" if is_alone else vectors[angle.text]
        needed = len(", ".join(pair.values())) + len(", ")
        if not vector or vector != last or needed > room:
            first = min(pair.values(), key=[*kernel.calls].index)
            groups[first], room = [], WIDTH - len("     = _of.sin_cos(")
        groups[first].append(angle)
        last, room = vector, room - needed
    return groups
