"""Kernels as a Python module that imports NumPy alone, with scalar twins on plain floats."""

from __future__ import annotations

import keyword
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from types import ModuleType
from typing import TYPE_CHECKING

from rigidsym.kernels.ir import FUNCTIONS, Argument, Call, Guarded, Kernel, Program
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets import singular
from rigidsym.kernels.targets.infix import infix
from rigidsym.kernels.targets.layout import WIDTH, assignment_lines, bracketed, docstring, exploded
from rigidsym.kernels.targets.numpy.numpy_function import OPTIONS, Additions, Function
from rigidsym.system import resources
from rigidsym.version import __version__

if TYPE_CHECKING:
    from rigidsym.kernels.conversions.conversions import ConversionProgram

TEMPLATE = "kernels_numpy.py.jinja"
RESERVED = frozenset(
    {*keyword.kwlist, *FUNCTIONS, "np", "tan", "ValueError", "ZeroDivisionError", "l", "O", "I"}
)  # the last three are names that linters refuse

_MATH: Mapping[str, str] = {name: name for name in FUNCTIONS}
_show = partial(infix, functions=_MATH)


def render(program: Program, conversions: ConversionProgram | None = None) -> dict[str, str]:
    """The module, with the conversions where they are asked for."""
    return {f"{program.name}.py": module_text(program, conversions)}


def module_text(
    program: Program,
    conversions: ConversionProgram | None = None,
    template: str = TEMPLATE,
    *,
    fill: str = "_fill",
    **more: object,
) -> str:
    """The text of a module, in a template that may extend this one and needs more.

    `fill` is the function there that goes through the orientations.
    """
    added = _additions(program, conversions)
    converting = conversions.kernels if conversions else ()
    kernels = [_fitted(kernel) for kernel in (*program.kernels, *converting)]
    placed = resources.environment().get_template(template)
    return placed.render(
        about=docstring([*_about(program), *added.remarks]),
        imports=_import(singular.imports(kernels) | added.imports),
        exports=lines(f'"{name}",' for name in sorted((*_exports(kernels), *added.exports))),
        components=lines((*map(entry, arguments(program, conversions)), *added.components)),
        functions=[*map(_function, kernels), *added.functions],
        has_parts=any(kernel.parts for kernel in kernels),
        helpers="".join(
            f"\n\n{text}" for text in (*singular.helpers(kernels), added.helpers) if text
        ),
        fill=fill,
        **more,
    )


def _import(names: set[str]) -> str:
    """The line for `math`."""
    return f"from math import {', '.join(sorted({'prod', *names}))}\n\n"


def arguments(program: Program, conversions: ConversionProgram | None) -> list[Argument]:
    """All arguments that the functions of the module take, each once."""
    more = conversions.arguments if conversions else ()
    return list({a.name: a for a in (*program.arguments, *more)}.values())


def _additions(program: Program, conversions: ConversionProgram | None) -> Additions:
    coordinates = [argument for argument in program.arguments if argument.name == "q"]
    if conversions is None or not coordinates:
        return Additions()
    from rigidsym.kernels.targets.numpy.numpy_conversions import additions

    return additions(conversions, f"({len(coordinates[0].components)},)")


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; it is not entered in `sys.modules`."""
    (source,) = files.values()
    return python_module(name, source)


def python_module(name: str, source: str) -> ModuleType:
    """A Python module from its text."""
    from importlib.abc import ExecutionLoader
    from importlib.util import module_from_spec, spec_from_loader

    class Source(ExecutionLoader):
        def get_source(self, fullname: str) -> str:  # noqa: ARG002  (the loader's interface)
            return source

        def get_filename(self, fullname: str) -> str:
            return f"<rigidsym>/{fullname}.py"

    loader = Source()
    spec = spec_from_loader(name, loader)
    if spec is None:
        raise ImportError(f"{name} has no specification", name=name)
    module = module_from_spec(spec)
    loader.exec_module(module)
    return module


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit: a scalar twin's assignments and the rows of its outputs."""
    deepest = 8 + 4 * len(kernel.shape)
    return narrowed(kernel, _show, line=WIDTH - 8, output=WIDTH - deepest - len(","))


def unpacked(names: Sequence[str], value: str) -> str:
    """_, theta, psi = parts["q"]"""
    left = f"({names[0]},)" if len(names) == 1 else ", ".join(names)
    line = f"    {left} = {value}"
    return line if len(line) <= WIDTH else exploded(4, "(", names, f") = {value}")


def _functions(kernels: Sequence[Kernel]) -> set[str]:
    return {call.function for kernel in kernels for call in singular.calls_of(kernel).values()}


def _exports(kernels: Sequence[Kernel]) -> Iterator[str]:
    for kernel in kernels:
        yield kernel.name
        yield f"{kernel.name}_scalar"


def entry(argument: Argument) -> str:
    names = [f'"{name}"' for name in argument.components]
    line = f'"{argument.name}": {_in_a_line(names)},'
    if len(line) <= WIDTH - 4:
        return line
    return exploded(4, f'"{argument.name}": (', names, "),").lstrip()


def lines(items: Iterable[str]) -> str:
    return "\n".join(f"    {item}" for item in items)


def _function(kernel: Kernel) -> Function:
    block, scalar = f"_{kernel.name}", f"{kernel.name}_scalar"
    vectors = [argument.name for argument in kernel.arguments]
    given = [f"{vector}={vector}" for vector in vectors]
    shape = str(kernel.shape)
    return Function(
        signature=bracketed(0, f"def {kernel.name}(", [*vectors, "*", *OPTIONS], "):"),
        about=docstring(about_kernel(kernel), indent=4),
        body=_body(kernel, [block, scalar, shape, *("out", "threads"), *given]),
        ufunc=f'{kernel.name}.signature = "{ufunc(kernel)}"',
        scalar_signature=bracketed(0, f"def {scalar}(", kernel.components, "):"),
        scalar_about=docstring(
            [f"`{kernel.name}` of one orientation; floats to {_nesting(kernel)}."], indent=4
        ),
        scalar_body="\n".join([*_scalar_lines(kernel), _scalar_return(kernel)]),
        exceptional=bracketed(8, "return _exceptional(", [block, shape, *kernel.components], ")"),
        block_signature=bracketed(0, f"def {block}(", kernel.components, "):"),
        block_body="\n".join([*_block_lines(kernel), _tuple(4, "return ", _outputs(kernel))]),
    )


def _body(kernel: Kernel, arguments: Sequence[str]) -> str:
    """The call that computes the result; several results are parts of one array."""
    if not kernel.parts:
        return bracketed(4, "return _apply(", arguments, ")")
    call = bracketed(4, "both = _apply(", arguments, ")")
    return f"{call}\n{bracketed(4, 'return _parted(', ['both', *map(str, kernel.parts)], ')')}"


def ufunc(kernel: Kernel) -> str:
    """The signature as a generalised ufunc: (3),(3)->(3)."""
    inputs = ",".join(f"({len(argument.components)})" for argument in kernel.arguments)
    results = kernel.parts or (kernel.shape,)
    outputs = ",".join("(" + ",".join(map(str, shape)) + ")" for shape in results)
    return f"{inputs}->{outputs}"


def _nesting(kernel: Kernel) -> str:
    return ("a float", "a tuple", "a tuple of rows")[len(kernel.shape)]


def _scalar_lines(kernel: Kernel) -> Iterator[str]:
    for name, value in singular.grouped(kernel):
        match value:
            case Call(function):
                yield _call_line(8, name, function, value)
            case Guarded():
                yield singular.guard_line(8, name, value, "_or_nan_scalar")
            case dict():
                yield singular.entire_line(8, value, "_entire_scalar")
            case _:
                yield assignment_lines(8, name, _show(value))


def _call_line(indent: int, names: str, function: str, call: Call) -> str:
    return bracketed(indent, f"{names} = {function}(", [call.argument.text], ")")


def _block_lines(kernel: Kernel) -> Iterator[str]:
    """The assignments on arrays, the sine and the cosine of one angle in one call."""
    pairs = _pairs(kernel)
    for name, value in singular.grouped(kernel):
        match value:
            case Guarded():
                yield singular.guard_line(4, name, value, "_or_nan")
            case dict():
                yield singular.entire_line(4, value, "_entire")
            case Call() if name in pairs:
                yield _call_line(4, f"{name}, {pairs[name]}", "_sin_cos", value)
            case Call("sqrt" | "abs" as function):
                yield _call_line(4, name, f"np.{function}", value)
            case Call(function, argument):
                if name not in pairs.values():  # no cosine that came with its sine
                    yield _call_line(4, name, f"_{function}", value)
                if function == "cos" and name in kernel.delicate:
                    yield bracketed(4, f"{name} = _sharp(", [name, argument.text], ")")
            case _:
                yield assignment_lines(4, name, _show(value))


def _pairs(kernel: Kernel) -> dict[str, str]:
    """sine: cosine of the angles of which both are needed."""
    calls = {call: name for name, call in singular.calls_of(kernel).items()}
    return {
        name: cosine
        for call, name in calls.items()
        if call.function == "sin" and (cosine := calls.get(Call("cos", call.argument))) is not None
    }


def _outputs(kernel: Kernel) -> list[str]:
    return [_show(output) for output in kernel.outputs]


def _scalar_return(kernel: Kernel) -> str:
    outputs = _outputs(kernel)
    if not kernel.shape:
        return f"        return {outputs[0]}"
    if len(kernel.shape) == 1:
        return _tuple(8, "return ", outputs)
    columns = kernel.shape[1]
    rows = [outputs[start : start + columns] for start in range(0, len(outputs), columns)]
    return _tuple(8, "return ", [_row(row) for row in rows])


def _row(items: Sequence[str]) -> str:
    """One row of a matrix: in a line where it fits, else an entry a line."""
    line = _in_a_line(items)
    return line if len(line) <= WIDTH - 12 - len(",") else _tuple(12, "", items).lstrip()


def _in_a_line(items: Sequence[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def _tuple(indent: int, head: str, items: Sequence[str]) -> str:
    if len(items) == 1:
        return f"{' ' * indent}{head}({items[0]},)"
    return exploded(indent, f"{head}(", items, ")")


def _about(program: Program) -> list[str | Sequence[str]]:
    """The paragraphs of the module's docstring."""
    return [
        f"{program.title}: functions of NumPy arrays.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, with the components on the last axis, in radians and SI units:",
        arguments_table(program),
        "All other axes broadcast, and any strides will do. Integers count as float64; the "
        "result is float32 where every argument is, else float64. A given `out` of the "
        "result's shape and dtype is filled and returned; it may overlap the arguments. "
        "`threads` share the work, each with some 4 MB of its own. Nothing warns. Each function "
        "has a twin, `..._scalar`, for one orientation in plain floats, and its `signature` as a "
        "generalised ufunc.",
        *singular.errors(program.kernels),
        *singular.remarks(program.kernels),
        f"Generated by rigidsym {__version__}; do not edit. The equations are those of the note "
        "of the same name.",
    ]


def arguments_table(program: Program) -> list[str]:
    """Lines that say what the arguments of all functions are."""
    return _table([(a.name, f"(..., {len(a.components)})", a.about) for a in program.arguments])


def about_kernel(kernel: Kernel) -> list[str | Sequence[str]]:
    """The paragraphs of a function's docstring."""
    is_named = kernel.definition and kernel.definition != kernel.symbol
    definition = f" = {kernel.definition}" if is_named else ""
    rows = [
        (a.name, f"(..., {len(a.components)})", ", ".join(a.components) + _in_unit(a.units))
        for a in kernel.arguments
    ]
    results = [", ".join(["...", *map(str, shape)]) for shape in kernel.parts or (kernel.shape,)]
    unit = f"in {kernel.unit}" if kernel.unit else ""
    returned = ("returns", ", ".join(f"({shape})" for shape in results), unit)
    return [
        f"{kernel.symbol}{definition}: {kernel.about}.",
        _table([*rows, returned]),
        *_both(kernel),
        f"{_place(kernel)}{kernel.operations}.",
        *singular.bound(kernel),
        *singular.poles(kernel),
        "Raises TypeError for a dtype and ValueError for a shape that it cannot take.",
    ]


def _both(kernel: Kernel) -> Iterator[str]:
    if kernel.parts:
        yield f"Both are parts of one array, (..., {kernel.shape[0]}), as `out` is."


def _place(kernel: Kernel) -> str:
    return f"Equation ({kernel.equation}) of the note; " if kernel.equation else ""


def _equation(kernel: Kernel) -> str:
    return "" if kernel.equation is None else f"Equation ({kernel.equation}) of the note; "


def _in_unit(units: Sequence[str]) -> str:
    """The unit of the components behind their names; pure numbers have none."""
    if not any(units):
        return ""
    distinct = dict.fromkeys(units)
    same = len(distinct) == 1
    return f" in {units[0] if same else '(' + ', '.join(unit or '1' for unit in units) + ')'}"


def _table(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Rows with their first two columns aligned."""
    first, second = (max(len(row[k]) for row in rows) for k in (0, 1))
    return [f"  {a:<{first}}  {b:<{second}}  {c}".rstrip() for a, b, c in rows]
