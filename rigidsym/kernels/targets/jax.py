"""Kernels as a Python module of functions for JAX: pure, so that jit, vmap and grad apply."""

from __future__ import annotations

import keyword
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from types import ModuleType

from rigidsym import __version__, resources
from rigidsym.algebra.series import FIRST_SERIES
from rigidsym.errors import MissingExtra
from rigidsym.kernels.conversions import ConversionProgram
from rigidsym.kernels.infix import infix
from rigidsym.kernels.ir import FUNCTIONS, Call, Guarded, Kernel, Program, names_in
from rigidsym.kernels.layout import WIDTH, assignment_lines, bracketed, docstring, exploded
from rigidsym.kernels.narrow import narrowed
from rigidsym.kernels.targets import numpy as python
from rigidsym.kernels.targets import numpy_singular as singular

TEMPLATE = "kernels_jax.py.jinja"
RESERVED = frozenset(
    {*keyword.kwlist, *FUNCTIONS, "jax", "jnp", "like", "parts", "both", "l", "O", "I"}
)
_DERIVATIVES = 2  # that functions of n = |v| have: each takes two functions c_k more

_show = partial(infix, functions={name: f"jnp.{name}" for name in FUNCTIONS})


def render(program: Program, conversions: ConversionProgram | None = None) -> dict[str, str]:
    """The module; conversions are the NumPy target's, and the module says so."""
    kernels = [_fitted(kernel) for kernel in program.kernels]
    last = singular.last_order(kernels)
    has_parts = any(kernel.parts for kernel in kernels)
    orders = range(FIRST_SERIES, last + 2 * _DERIVATIVES + 1) if last >= 0 else ()
    text = (
        resources.environment()
        .get_template(TEMPLATE)
        .render(
            about=docstring([*_about(program, has_conversions=conversions is not None)]),
            imports=_imports(has_parts=has_parts, has_series=bool(orders)),
            exports=python.lines(f'"{name}",' for name in sorted(k.name for k in kernels)),
            components=python.lines(map(python.entry, program.arguments)),
            functions=[*map(_function, kernels)],
            has_parts=has_parts,
            has_divisors=any(map(singular.guards_of, kernels)),
            series="\n".join(map(singular.entry, orders)),
        )
    )
    return {f"{program.name}_jax.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra where JAX is not installed."""
    (source,) = files.values()
    try:
        return python.python_module(f"{name}_jax", source)
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
    vectors = [argument.name for argument in kernel.arguments]
    given = [f"{name}={name}" for name in vectors]
    taken = list(_taken(kernel))
    return {
        "signature": bracketed(0, f"def {kernel.name}(", vectors, "):"),
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
        left = f"({names[0]},)" if len(names) == 1 else ", ".join(names)
        line = f'    {left} = parts["{argument.name}"]'
        if len(line) > WIDTH:
            line = exploded(4, "(", names, f') = parts["{argument.name}"]')
        if used.intersection(names):
            yield line


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in singular.grouped(kernel):
        match value:
            case Guarded():
                yield singular.guard_line(4, name, value, "_or_nan")
            case dict():
                yield singular.entire_line(4, value, "_entire")
            case Call(function, argument):
                yield bracketed(4, f"{name} = jnp.{function}(", [argument.text], ")")
            case _:
                yield assignment_lines(4, name, _show(value))


def _about(program: Program, *, has_conversions: bool) -> Iterator[str | Sequence[str]]:
    """The paragraphs of the module's docstring."""
    yield f"{program.title}: functions for JAX."
    yield " ".join(program.convention)
    yield f"Source: {program.source}."
    yield "Arguments, with the components on the last axis, in radians and SI units:"
    yield python.arguments_table(program)
    yield (
        "All other axes broadcast. The functions are pure: jax.jit, vmap, grad, jvp and vjp "
        "apply. Types are those of JAX: float32, or float64 where jax_enable_x64 is set and an "
        "argument is float64. They run where JAX does, on a GPU too; tested on processors alone."
    )
    if has_conversions:
        yield "The conversions stand in the NumPy module."
    yield from singular.remarks(program.kernels)
    yield (
        f"Generated by rigidsym {__version__}; do not edit. The equations are those of the note "
        "of the same name."
    )
