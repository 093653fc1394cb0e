"""Text that all Python modules share, be it for NumPy, Numba, JAX or a compiled module."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.abc import ExecutionLoader
from importlib.util import module_from_spec, spec_from_loader
from types import ModuleType

from rigidsym.algebra.series import series_of, taylor
from rigidsym.kernels.conversions.conversions import ConversionProgram
from rigidsym.kernels.ir import FUNCTIONS, Argument, Call, Guarded, Kernel, Name, Number, Program
from rigidsym.kernels.targets.text.layout import WIDTH, bracketed, exploded
from rigidsym.kernels.targets.text.remarks import bound, cost, headline, poles, table

RESERVED = frozenset({*FUNCTIONS, "l", "O", "I"})  # linters refuse the last three


def module_from(name: str, source: str) -> ModuleType:
    """A Python module from its text; it is not entered in `sys.modules`."""

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


# statements


def call_line(indent: int, names: str, function: str, call: Call) -> str:
    return bracketed(indent, f"{names} = {function}(", [call.argument.text], ")")


def guard_line(indent: int, name: str, guard: Guarded, function: str) -> str:
    """x1 = _or_nan(x0, theta)"""
    match guard.scale:
        case Name(scale):
            arguments = [guard.value.text, scale]
        case Number(number):
            arguments = [guard.value.text, repr(float(number))]
        case _:
            arguments = [guard.value.text, "None"]
    power = [str(guard.power)] if guard.power != 1 else []
    return bracketed(indent, f"{name} = {function}(", [*arguments, *power], ")")


def entire_line(indent: int, group: Mapping[str, Call], function: str) -> str:
    """c1_x0, c2_x0 = _entire(x0, 1, 2)"""
    calls = sorted(group.items(), key=lambda named: named[1].order or 0)
    names = ", ".join(name for name, _ in calls)
    (argument,) = {call.argument.text for _, call in calls}
    orders = [str(call.order) for _, call in calls]
    left = names if len(calls) > 1 else f"({names},)"
    return bracketed(indent, f"{left} = {function}(", [argument, *orders], ")")


def series_entry(order: int) -> str:
    """A line of the table of series: k, the switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
    return exploded(4, f"{order}: (", [repr(float(number)) for number in numbers], "),")


def unpacked(names: Sequence[str], value: str) -> str:
    """_, theta, psi = parts["q"]"""
    left = f"({names[0]},)" if len(names) == 1 else ", ".join(names)
    line = f"    {left} = {value}"
    return line if len(line) <= WIDTH else exploded(4, "(", names, f") = {value}")


# tables at the head of a module


def arguments(program: Program, conversions: ConversionProgram | None) -> list[Argument]:
    """All arguments that the functions of the module take, each once."""
    more = conversions.arguments if conversions else ()
    return list({a.name: a for a in (*program.arguments, *more)}.values())


def entry(argument: Argument) -> str:
    """A line of the table of components: "q": ("phi", "theta", "psi"),"""
    names = [f'"{name}"' for name in argument.components]
    line = f'"{argument.name}": {tuple_of(names)},'
    if len(line) <= WIDTH - 4:
        return line
    return exploded(4, f'"{argument.name}": (', names, "),").lstrip()


def lines(items: Iterable[str]) -> str:
    return "\n".join(f"    {item}" for item in items)


def tuple_of(items: Sequence[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def ufunc(kernel: Kernel) -> str:
    """The signature as a generalised ufunc: (3),(3)->(3)."""
    inputs = ",".join(f"({len(argument.components)})" for argument in kernel.arguments)
    results = kernel.parts or (kernel.shape,)
    outputs = ",".join("(" + ",".join(map(str, shape)) + ")" for shape in results)
    return f"{inputs}->{outputs}"


# docstrings


def about_arguments(program: Program) -> list[str]:
    """Lines that describe the arguments of all functions."""
    return table([(a.name, f"(..., {len(a.components)})", a.about) for a in program.arguments])


def about_kernel(kernel: Kernel) -> list[str | Sequence[str]]:
    """The paragraphs of a function's docstring."""
    rows = [
        (a.name, f"(..., {len(a.components)})", ", ".join(a.components) + _in_unit(a.units))
        for a in kernel.arguments
    ]
    results = [", ".join(["...", *map(str, shape)]) for shape in kernel.parts or (kernel.shape,)]
    unit = f"in {kernel.unit}" if kernel.unit else ""
    returned = ("returns", ", ".join(f"({shape})" for shape in results), unit)
    both = f"Both are views of one array, (..., {len(kernel.outputs)}), the shape of `out`."
    return [
        headline(kernel),
        table([*rows, returned]),
        *([both] if kernel.parts else []),
        cost(kernel),
        *bound(kernel),
        *poles(kernel),
        "Raises TypeError for a dtype and ValueError for a shape that it cannot take.",
    ]


def _in_unit(units: Sequence[str]) -> str:
    """The unit of the components behind their names; pure numbers have none."""
    if not any(units):
        return ""
    same = len(dict.fromkeys(units)) == 1
    return f" in {units[0] if same else '(' + ', '.join(unit or '1' for unit in units) + ')'}"
