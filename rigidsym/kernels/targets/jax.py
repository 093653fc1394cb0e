"""Kernels as a Python module of functions for JAX: pure, so that jit, vmap and grad apply."""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.kernels.ir import FUNCTIONS, Kernel, Program
from rigidsym.kernels.targets import python, remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.kernels.targets.python import WIDTH, bracketed

RESERVED = python.RESERVED | {"jax", "jnp", "like", "parts"}
_DERIVATIVES = 2  # that functions of n = |v| have: each takes two functions c_k more
_WORDS = {
    **{name: f"jnp.{name}({{}})" for name in FUNCTIONS},
    **{"atan2": "jnp.arctan2({})", "eps": "_eps({})", "or_nan": "_or_nan({})"},
    **{"entire": "_entire({})", "nan": "jnp.nan", "choice": "jnp.where({0}, {1}, {2})"},
}


def render(program: Program) -> dict[str, str]:
    """The module."""
    text = python.module_text(
        program,
        "jax/module.py.jinja",
        about=python.about_module("jax/module.txt.jinja", program),
        names=[kernel.name for kernel in program.kernels],
        bodies={kernel.name: "\n".join(_body(kernel)) for kernel in program.kernels},
        series=remarks.series(program, python.SERIES, WIDTH, more=2 * _DERIVATIVES),
    )
    return {f"{program.name}_jax.py": text}


def _body(kernel: Kernel) -> Iterator[str]:
    """The components that are used, by argument; the assignments; and what is returned."""
    is_used = not kernel.used.isdisjoint(kernel.components)
    head = f"like, {'parts' if is_used else '_'} = _components("
    yield bracketed(4, head, python.passed(kernel, "jnp"), ")")
    for argument in kernel.arguments:
        names = [name if name in kernel.used else "_" for name in argument.components]
        if kernel.used.intersection(names):
            yield python.taken_apart(names, f'parts["{argument.name}"]')
    for name, value in kernel.statements:
        yield python.statement(4, name, value, _WORDS)
    outputs = (broken(infix(e), WIDTH - 12, " " * 12) for e in kernel.outputs)
    entries = ["like", str(kernel.shape), *outputs]
    yield bracketed(4, "return _together(", entries, ")")
