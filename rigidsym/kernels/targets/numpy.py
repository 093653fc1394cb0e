"""Kernels as a Python module that imports NumPy alone, with scalar twins on plain floats."""

from __future__ import annotations

import keyword
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import ModuleType

from rigidsym import __version__, resources
from rigidsym.kernels.infix import infix
from rigidsym.kernels.ir import FUNCTIONS, Argument, Call, Kernel, Program
from rigidsym.kernels.layout import WIDTH, assignment_lines, bracketed, docstring, exploded
from rigidsym.kernels.narrow import narrowed

TEMPLATE = "kernels_numpy.py.jinja"
RESERVED = frozenset(
    {*keyword.kwlist, *FUNCTIONS, "np", "ValueError", "ZeroDivisionError", "l", "O", "I"}
)  # the last three are names that linters refuse

_MATH: Mapping[str, str] = {name: name for name in FUNCTIONS}
_show = partial(infix, functions=_MATH)


@dataclass(frozen=True, kw_only=True, slots=True)
class Function:
    """The pieces of text that stand for one kernel in the template."""

    signature: str
    about: str
    body: str
    scalar_signature: str
    scalar_about: str
    scalar_body: str
    exceptional: str
    block_signature: str
    block_body: str


def render(program: Program) -> str:
    """The text of the module."""
    kernels = [_fitted(kernel) for kernel in program.kernels]
    template = resources.environment().get_template(TEMPLATE)
    return template.render(
        about=docstring(_about(program)),
        imports=", ".join(sorted({"sin", "cos", *_functions(kernels)})),
        exports=_lines(f'"{name}",' for name in sorted(_exports(kernels))),
        components=_lines(map(_entry, program.arguments)),
        functions=[_function(kernel) for kernel in kernels],
    )


def load(name: str, source: str) -> ModuleType:
    """The module itself; it is not entered in `sys.modules`."""
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


def _functions(kernels: Sequence[Kernel]) -> set[str]:
    values = (assignment.value for kernel in kernels for assignment in kernel.assignments)
    return {value.function for value in values if isinstance(value, Call)}


def _exports(kernels: Sequence[Kernel]) -> Iterator[str]:
    for kernel in kernels:
        yield kernel.name
        yield f"{kernel.name}_scalar"


def _entry(argument: Argument) -> str:
    names = [f'"{name}"' for name in argument.components]
    line = f'"{argument.name}": {_in_a_line(names)},'
    if len(line) <= WIDTH - 4:
        return line
    return exploded(4, f'"{argument.name}": (', names, "),").lstrip()


def _lines(items: Iterator[str]) -> str:
    return "\n".join(f"    {item}" for item in items)


def _function(kernel: Kernel) -> Function:
    block, scalar = f"_{kernel.name}", f"{kernel.name}_scalar"
    vectors = [argument.name for argument in kernel.arguments]
    shape = f"({kernel.shape[0]},)" if len(kernel.shape) == 1 else str(kernel.shape)
    return Function(
        signature=bracketed(0, f"def {kernel.name}(", [*vectors, "*", "out=None"], "):"),
        about=docstring(_about_kernel(kernel), indent=4),
        body=bracketed(
            4, "return _apply(", [block, scalar, shape, "out", *(f"{v}={v}" for v in vectors)], ")"
        ),
        scalar_signature=bracketed(0, f"def {scalar}(", kernel.components, "):"),
        scalar_about=docstring(
            [f"`{kernel.name}` of one orientation; floats to {_nesting(kernel)}."], indent=4
        ),
        scalar_body="\n".join([*_scalar_lines(kernel), _scalar_return(kernel)]),
        exceptional=bracketed(8, "return _exceptional(", [block, shape, *kernel.components], ")"),
        block_signature=bracketed(0, f"def {block}(", kernel.components, "):"),
        block_body="\n".join([*_block_lines(kernel), _tuple(4, "return ", _outputs(kernel))]),
    )


def _nesting(kernel: Kernel) -> str:
    return "a tuple" if len(kernel.shape) == 1 else "a tuple of rows"


def _scalar_lines(kernel: Kernel) -> Iterator[str]:
    for assignment in kernel.assignments:
        if isinstance(assignment.value, Call):
            yield _call_line(8, assignment.name, assignment.value.function, assignment.value)
        else:
            yield assignment_lines(8, assignment.name, _show(assignment.value))


def _call_line(indent: int, names: str, function: str, call: Call) -> str:
    return bracketed(indent, f"{names} = {function}(", [call.argument.text], ")")


def _block_lines(kernel: Kernel) -> Iterator[str]:
    """The assignments on arrays, the sine and the cosine of one angle in one call."""
    pairs = _pairs(kernel)
    for assignment in kernel.assignments:
        name, call = assignment.name, assignment.value
        if not isinstance(call, Call):
            yield assignment_lines(4, name, _show(call))
        elif name in pairs:
            yield _call_line(4, f"{name}, {pairs[name]}", "_sin_cos", call)
        elif name not in pairs.values():
            yield _call_line(4, name, _array_function(kernel, name, call), call)


def _pairs(kernel: Kernel) -> dict[str, str]:
    """sine: cosine of the angles of which both are needed, and no cosine divides."""
    calls = {a.value: a.name for a in kernel.assignments if isinstance(a.value, Call)}
    return {
        name: cosine
        for call, name in calls.items()
        if call.function == "sin"
        and (cosine := calls.get(Call("cos", call.argument))) is not None
        and cosine not in kernel.delicate
    }


def _array_function(kernel: Kernel, name: str, call: Call) -> str:
    exact = call.function == "sqrt" or (call.function == "cos" and name in kernel.delicate)
    return f"np.{call.function}" if exact else f"_{call.function}"


def _outputs(kernel: Kernel) -> list[str]:
    return [_show(output) for output in kernel.outputs]


def _scalar_return(kernel: Kernel) -> str:
    outputs = _outputs(kernel)
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
    arguments = [(a.name, f"(..., {len(a.components)})", a.about) for a in program.arguments]
    return [
        f"{program.title}: functions of NumPy arrays.",
        " ".join(program.convention),
        f"Source: {program.source}.",
        "Arguments, with the components on the last axis, in radians and SI units:",
        _table(arguments),
        "All other axes broadcast, and any strides will do. Integers count as float64; the "
        "result is float32 where every argument is, else float64. A given `out` of the "
        "result's shape and dtype is filled and returned; it may overlap the arguments. Each "
        "function has a twin, `..._scalar`, for one orientation in plain floats.",
        "NaN stays NaN, and so does the sine of infinity. Where a function divides by zero it "
        "gives inf or NaN without a warning. Angles such as pi/2 are not exact floats: there "
        "a function with a pole gives numbers of the order of 1e16.",
        f"Generated by rigidsym {__version__}; do not edit. The equations are those of the note "
        "of the same name.",
    ]


def _about_kernel(kernel: Kernel) -> list[str | Sequence[str]]:
    """The paragraphs of a function's docstring."""
    is_named = kernel.definition and kernel.definition != kernel.symbol
    definition = f" = {kernel.definition}" if is_named else ""
    rows = [
        (a.name, f"(..., {len(a.components)})", f"{', '.join(a.components)} in {_unit(a.units)}")
        for a in kernel.arguments
    ]
    shape = ", ".join(map(str, kernel.shape))
    returned = ("returns", f"(..., {shape})", f"in {kernel.unit}" if kernel.unit else "")
    return [
        f"{kernel.symbol}{definition}: {kernel.about}.",
        _table([*rows, returned]),
        f"Equation ({kernel.equation}) of the note; {kernel.operations}.",
        *_poles(kernel),
        "Raises TypeError for a dtype and ValueError for a shape that it cannot take.",
    ]


def _poles(kernel: Kernel) -> list[str]:
    if not kernel.divisors:
        return []
    divisors = ", ".join(map(_show, kernel.divisors))
    return [f"Divides by {divisors}: near its zeros the result grows and loses digits."]


def _unit(units: Sequence[str]) -> str:
    distinct = dict.fromkeys(units)
    return next(iter(distinct)) if len(distinct) == 1 else f"({', '.join(units)})"


def _table(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Rows with their first two columns aligned."""
    first, second = (max(len(row[k]) for row in rows) for k in (0, 1))
    return [f"  {a:<{first}}  {b:<{second}}  {c}".rstrip() for a, b, c in rows]
