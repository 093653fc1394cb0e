"""Text that all Python modules share, be it for NumPy, Numba, JAX or a compiled module."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.abc import ExecutionLoader
from importlib.util import module_from_spec, spec_from_loader
from types import ModuleType

from rigidsym.algebra.series import series_of, taylor
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Choice,
    Compare,
    Guarded,
    Kernel,
    KernelArgument,
    Name,
    Number,
    Program,
    parts,
)
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python_layout import WIDTH, bracketed, exploded
from rigidsym.kernels.targets.text.remarks import bound, cost, headline, poles, table
from rigidsym.kernels.targets.text.statements import calls
from rigidsym.system import resources

_UNWELCOME = ("l", "O", "I")  # linters refuse these names
RESERVED = frozenset({*FUNCTIONS, *_UNWELCOME, "nan", "max", "min"})


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
    given = [argument.text for argument in call.arguments]
    return bracketed(indent, f"{names} = {function}(", given, ")")


def where_line(indent: int, name: str, choice: Choice, library: str) -> str:
    """x1 = np.where(x0 > 0.0, x0, 0.0)"""
    values = [infix(part, {"nan": f"{library}.nan"}) for part in parts(choice)]
    return bracketed(indent, f"{name} = {library}.where(", values, ")")


def choice_lines(indent: int, name: str, choice: Choice) -> str:
    """x1 = x0 if x0 > 0.0 else 0.0, or the same in three lines."""
    condition, then, otherwise = (infix(part, {}) for part in parts(choice))
    if extreme := _extreme(choice):
        return f"{' ' * indent}{name} = {extreme}({otherwise}, {then})"
    line = f"{' ' * indent}{name} = {then} if {condition} else {otherwise}"
    if len(line) <= WIDTH:
        return line
    inner = "\n" + " " * (indent + 4)
    body = f"{inner}{then}{inner}if {condition}{inner}else {otherwise}"
    return f"{' ' * indent}{name} = ({body}\n{' ' * indent})"


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


def _extreme(choice: Choice) -> str:
    """max or min, if the choice between a and b is max(b, a) or min(b, a), for NaN too."""
    condition, then, otherwise = parts(choice)
    if not isinstance(condition, Compare) or condition.relation not in ("<", ">"):
        return ""
    sides = parts(condition)
    if (then, otherwise) not in (sides, sides[::-1]):
        return ""
    return "max" if (condition.relation == ">") == (then == condition.left) else "min"


# arguments


def default(argument: KernelArgument, value: str) -> str:
    return f"={value}" if argument.is_optional else ""


def taken(kernel: Kernel) -> list[str]:
    """The parameters of a function of arrays."""
    return [f"{argument.name}{default(argument, 'None')}" for argument in kernel.arguments]


def passed(argument: KernelArgument, library: str) -> str:
    """What a function of arrays passes on: name=value."""
    name = value = argument.name
    if argument.is_matrix:
        value = f"_entries({name})"
    if argument.is_scalar:
        value = f"{library}.asarray({name})[..., None]"
    if argument.is_optional:
        zeros = f"{library}.zeros({len(argument.components)}, {library}.float32)"
        value = f"{zeros} if {name} is None else {name}"
    return f"{name}={value}"


def helpers(kernels: Sequence[Kernel], library: str) -> list[str]:
    """The functions for matrices, and for the spacing of floats, if the kernels need them."""
    has_matrix = any(a.is_matrix for kernel in kernels for a in kernel.arguments)
    has_eps = any(calls(kernel, "eps") for kernel in kernels)
    names = ["matrices.py"] * has_matrix + ["epsilon.py"] * has_eps
    return [resources.text("templates", f"{library}/{name}").rstrip() for name in names]


# tables at the head of a module


def entry(argument: KernelArgument) -> str:
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
    inputs = ",".join(_packed(argument.shape) for argument in kernel.arguments)
    results = kernel.parts or (kernel.shape,)
    outputs = ",".join(map(_packed, results))
    return f"{inputs}->{outputs}"


def _packed(shape: Sequence[int]) -> str:
    return f"({','.join(map(str, shape))})"


# docstrings


def about_arguments(program: Program) -> list[str]:
    """Lines that describe the arguments of all functions."""
    return table([(a.name, _leading(a.shape), a.about) for a in program.arguments])


def _leading(shape: Sequence[int]) -> str:
    return f"({', '.join(['...', *map(str, shape)])})"


def about_kernel(kernel: Kernel) -> list[str | Sequence[str]]:
    """The paragraphs of a function's docstring."""
    rows = [
        (a.name, _leading(a.shape), ", ".join(a.components) + _in_unit(a.units))
        for a in kernel.arguments
    ]
    results = map(_leading, kernel.parts or (kernel.shape,))
    unit = f"in {kernel.unit}" if kernel.unit else ""
    returned = ("returns", ", ".join(results), unit)
    both = f"Both are views of one array, (..., {len(kernel.outputs)}), the shape of `out`."
    return [
        headline(kernel),
        table([*rows, returned]),
        *([both] if kernel.parts else []),
        *kernel.remarks,
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
