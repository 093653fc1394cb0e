"""Kernels as a Python module of functions for JAX: pure, so that jit, vmap and grad apply."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from types import ModuleType

from rigidsym.algebra.series import FIRST_SERIES
from rigidsym.errors import MissingExtra
from rigidsym.kernels.ir import FUNCTIONS, Call, Choice, Guarded, Kernel, Program, names_in
from rigidsym.kernels.lowering.wrap_lines import narrowed
from rigidsym.kernels.targets.text import python, remarks, statements
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python_layout import (
    WIDTH,
    assignment_lines,
    bracketed,
    docstring,
)
from rigidsym.system import resources

TEMPLATE = "jax/module.py.jinja"
RESERVED = python.RESERVED | {"jax", "jnp", "like", "parts", "both"}
_DERIVATIVES = 2  # that functions of n = |v| have: each takes two functions c_k more

_FUNCTIONS = {name: f"jnp.{name}" for name in FUNCTIONS} | {
    "atan2": "jnp.arctan2",
    "eps": "_eps",
}
_show = partial(infix, functions=_FUNCTIONS)


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = list(map(_fitted, program.kernels))
    last = statements.last_order(kernels)
    has_parts = any(kernel.parts for kernel in kernels)
    orders = range(FIRST_SERIES, last + 2 * _DERIVATIVES + 1) if last >= 0 else ()
    text = (
        resources.environment()
        .get_template(TEMPLATE)
        .render(
            about=docstring(list(_about(program))),
            imports=_imports(has_parts=has_parts, has_series=bool(orders)),
            exports=python.lines(f'"{name}",' for name in sorted(k.name for k in kernels)),
            components=python.lines(map(python.entry, program.arguments)),
            functions=list(map(_function, kernels)),
            has_parts=has_parts,
            has_divisors=any(map(statements.guards_of, kernels)),
            series="\n".join(map(python.series_entry, orders)),
            helpers="".join(f"\n\n{text}\n" for text in python.helpers(kernels, "jax")),
        )
    )
    return {f"{program.name}_jax.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra where JAX is not installed."""
    (source,) = files.values()
    try:
        return python.module_from(f"{name}_jax", source)
    except ModuleNotFoundError as error:
        raise MissingExtra("the target jax", "jax") from error


def _imports(*, has_parts: bool, has_series: bool) -> str:
    """The lines before that of jax.numpy."""
    standard = ["from functools import cache"] * has_series + ["from math import prod"] * has_parts
    jax = ["import jax"] * has_series
    return "".join(f"{line}\n" for line in [*standard, *[""] * bool(standard), *jax])


def _fitted(kernel: Kernel) -> Kernel:
    return narrowed(kernel, _show, line=WIDTH - 4, output=WIDTH - 8 - len(","))


def _function(kernel: Kernel) -> dict[str, str]:
    given = [python.passed(argument, "jnp") for argument in kernel.arguments]
    taken = list(_taken(kernel))
    return {
        "name": kernel.name,
        "ufunc": f'{kernel.name}.signature = "{python.ufunc(kernel)}"',
        "signature": bracketed(0, f"def {kernel.name}(", python.taken(kernel), "):"),
        "about": docstring(python.about_kernel(kernel), indent=4),
        "body": "\n".join(
            [
                bracketed(4, f"like, {'parts' if taken else '_'} = _components(", given, ")"),
                *taken,
                *_lines(kernel),
                *_returned(kernel),
            ]
        ),
    }


def _returned(kernel: Kernel) -> Iterator[str]:
    """The result, or several results as parts of one array."""
    entries = ["like", str(kernel.shape), *map(_show, kernel.outputs)]
    yield bracketed(4, f"{'both =' if kernel.parts else 'return'} _together(", entries, ")")
    if kernel.parts:
        yield bracketed(4, "return _parted(", ["both", *map(str, kernel.parts)], ")")


def _taken(kernel: Kernel) -> Iterator[str]:
    """_, theta, psi = parts["q"]: the components that are used, by argument."""
    values = [*(assignment.value for assignment in kernel.assignments), *kernel.outputs]
    used = {name for value in values for name in names_in(value)}
    for argument in kernel.arguments:
        names = [name if name in used else "_" for name in argument.components]
        if used.intersection(names):
            yield python.unpacked(names, f'parts["{argument.name}"]')


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in statements.grouped(kernel):
        match value:
            case Guarded():
                yield python.guard_line(4, name, value, "_or_nan")
            case dict():
                yield python.entire_line(4, value, "_entire")
            case Choice():
                yield python.where_line(4, name, value, "jnp")
            case Call(function):
                yield python.call_line(4, name, _FUNCTIONS[function], value)
            case _:
                yield assignment_lines(4, name, _show(value))


def _about(program: Program) -> Iterator[str | Sequence[str]]:
    """The paragraphs of the module's docstring."""
    yield f"{program.title}: functions for JAX."
    yield " ".join(program.convention)
    yield f"Source: {program.source}."
    yield "Arguments, with the components on the last axis, in radians and SI units:"
    yield python.about_arguments(program)
    yield (
        "Leading axes broadcast. The functions are pure, so jax.jit, vmap, grad, jvp and vjp "
        "apply. Types follow JAX: float32, or float64 if jax_enable_x64 is set and an argument is "
        "float64. They run on every device of JAX; they are tested on CPUs only. JAX arrays are "
        "immutable, so there is no `out`; there are no `threads`, since JAX parallelises by "
        "itself, and no scalar twins."
    )
    yield from remarks.errors(program.kernels)
    yield from remarks.remarks(program.kernels)
    yield from program.remarks
    if program.unwrapping:
        yield remarks.WITHOUT_UNWRAP
    yield remarks.GENERATED
