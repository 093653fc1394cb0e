"""Kernels as a Python module of functions for JAX: pure, so that jit, vmap and grad apply."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import ModuleType

from rigidsym.errors import MissingExtra
from rigidsym.kernels import loaded
from rigidsym.kernels.ir import FUNCTIONS, Kernel, Program, last_order
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.text import python, remarks
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python import WIDTH, bracketed, docstring, exploded
from rigidsym.system import resources

TEMPLATE = "jax/module.py.jinja"
RESERVED = python.RESERVED | {"jax", "jnp", "like", "parts", "both"}
_DERIVATIVES = 2  # that functions of n = |v| have: each takes two functions c_k more

_STATEMENTS = python.Statements(
    indent=4,
    functions={name: f"jnp.{name}" for name in FUNCTIONS} | {"atan2": "jnp.arctan2", "eps": "_eps"},
    library="jnp",
)


def render(program: Program) -> dict[str, str]:
    """The module."""
    kernels = [
        narrowed(kernel, infix, line=WIDTH - 4, output=WIDTH - 8 - len(","))
        for kernel in program.kernels
    ]
    has_parts = any(kernel.parts for kernel in kernels)
    has_series = last_order(kernels) >= 0
    text = (
        resources.environment()
        .get_template(TEMPLATE)
        .render(
            about=docstring(_about(program)),
            imports=_imports(has_parts=has_parts, has_series=has_series),
            exports=python.lines(f'"{name}",' for name in sorted(k.name for k in kernels)),
            components=python.components(program),
            functions=list(map(_function, kernels)),
            has_parts=has_parts,
            has_divisors=any(kernel.guards for kernel in kernels),
            series=python.series_entries(kernels, more=2 * _DERIVATIVES) if has_series else "",
            helpers="".join(f"\n\n{text}" for text in python.helpers(kernels, "jax")),
        )
    )
    return {f"{program.name}_jax.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra if JAX is not installed."""
    if TARGETS["jax"].missing:
        raise MissingExtra("the target jax", "jax")
    return loaded.load(f"{name}_jax", files)


def _imports(*, has_parts: bool, has_series: bool) -> str:
    """The lines before that of jax.numpy."""
    standard = ["from functools import cache"] * has_series + ["from math import prod"] * has_parts
    jax = ["import jax"] * has_series
    return "".join(
        f"{line}\n" for line in [*standard, "from typing import TYPE_CHECKING", "", *jax]
    )


def _function(kernel: Kernel) -> dict[str, str]:
    """The pieces of text that stand for one kernel in the template."""
    taken = list(_taken(kernel))
    head = f"like, {'parts' if taken else '_'} = _components("
    lines = (_STATEMENTS.text(name, value) for name, value in kernel.statements)
    given = bracketed(4, head, python.passed(kernel, "jnp"), ")")
    return {
        "name": kernel.name,
        "ufunc": python.ufunc(kernel),
        "signature": bracketed(
            0,
            f"def {kernel.name}(",
            python.parameters(kernel),
            f") -> {python.returned(kernel)}:",
        ),
        "about": docstring(python.about_function(kernel), indent=4),
        "body": "\n".join([given, *taken, *lines, *_returned(kernel)]),
    }


def _taken(kernel: Kernel) -> Iterator[str]:
    """_, theta, psi = parts["q"]: the components that are used, by argument."""
    for argument in kernel.arguments:
        names = [name if name in kernel.used else "_" for name in argument.components]
        if kernel.used.intersection(names):
            left = ", ".join(names) if len(names) > 1 else f"({names[0]},)"
            line = f'    {left} = parts["{argument.name}"]'
            wide = exploded(4, "(", names, f') = parts["{argument.name}"]')
            yield line if len(line) <= WIDTH else wide


def _returned(kernel: Kernel) -> Iterator[str]:
    """The result, or several results as parts of one array."""
    entries = ["like", str(kernel.shape), *map(infix, kernel.outputs)]
    yield bracketed(4, f"{'both =' if kernel.parts else 'return'} _together(", entries, ")")
    if kernel.parts:
        yield bracketed(4, "return _parted(", ["both", *map(str, kernel.parts)], ")")


def _about(program: Program) -> list[remarks.Paragraph]:
    """The paragraphs of the module's docstring."""
    return remarks.about_module(
        program,
        "functions for JAX",
        python.ARGUMENTS,
        python.about_arguments(program),
        "Leading axes broadcast. The functions are pure, so jax.jit, vmap, grad, jvp and vjp "
        "apply. Types follow JAX: float32, or float64 if jax_enable_x64 is set and an argument is "
        "float64. They run on every device of JAX; they are tested on CPUs only. JAX arrays are "
        "immutable, so there is no `out`; there are no `threads`, since JAX parallelises by "
        "itself, and no scalar twins.",
    )
