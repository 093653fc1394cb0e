"""Conversions as functions for JAX: pure, and with derivatives where the coordinates have them."""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.kernels.conversions.conversions import ConversionProgram, Formula
from rigidsym.kernels.conversions.formulas import MATRIX
from rigidsym.kernels.targets.numpy.numpy_conversions import (
    about_formula,
    assigned,
    components,
    spelled,
    ufunc,
    unwrap_text,
)
from rigidsym.kernels.targets.text import python
from rigidsym.kernels.targets.text.layout import bracketed, docstring, exploded

LIBRARY = {
    "np": "jnp",
    "running_maximum": "jax.lax.cummax",
    "root": "_root",
    "is_whole": "not len(values)",
}
_SPELLING = {
    "sqrt": "_root",
    "atan2": "jnp.arctan2",
    "hypot": "jnp.hypot",
    "sin": "jnp.sin",
    "cos": "jnp.cos",
    "pick": "jnp.where",
    "wrapped": "_wrapped",
    "tiny": "_tiny(far)",
    "reach": "_reach(far)",
    "nan": "jnp.nan",
    "pi": "jnp.pi",
}
_GIVEN = {
    "matrix": "_entries(matrix)",
    "kept": "jnp.zeros({}, jnp.float32) if kept is None else kept",
}


def functions(program: ConversionProgram, count: int) -> list[dict[str, str]]:
    """The pieces of each formula; `count` is how many coordinates there are."""
    return [_function(formula, count) for formula in program.formulas]


def unwrap(program: ConversionProgram) -> str:
    """The text of `unwrap`; empty where coordinates are unique."""
    unwrapping = program.unwrapping
    return unwrap_text(unwrapping, _SPELLING, LIBRARY) if unwrapping else ""


def entries(program: ConversionProgram) -> tuple[str, ...]:
    """Lines of the table of arguments."""
    return components(program.formulas)


def _function(formula: Formula, count: int) -> dict[str, str]:
    given = ["kept=None" if a == "kept" else a for a in formula.arguments]
    return {
        "name": formula.name,
        "signature": bracketed(0, f"def {formula.name}(", given, "):"),
        "about": docstring(about_formula(formula), indent=4),
        "body": "\n".join(_body(formula)),
        "ufunc": f'{formula.name}.signature = "{ufunc(formula, f"({count},)")}"',
    }


def _body(formula: Formula) -> Iterator[str]:
    passed = [f"{a}={_GIVEN.get(a, a)}".format(len(formula.kept)) for a in formula.arguments]
    yield bracketed(4, f"like, {'parts' if formula.inputs else '_'} = _components(", passed, ")")
    yield from _taken(formula)
    for names, value in formula.lines:
        yield assigned(4, names, spelled(value, _SPELLING))
    outputs = [spelled(output, _SPELLING) for output in formula.outputs]
    yield exploded(4, "return _together(", ["like", f"({len(outputs)},)", *outputs], ")")


def _taken(formula: Formula) -> Iterator[str]:
    """The components of the arguments; without names for them, the entries of their matrix."""
    if not formula.inputs:
        yield bracketed(4, "matrix = rotation_matrix(", formula.arguments, ")")
        value = ["matrix.reshape(*like.shape, 9)", "-1", "0"]
        yield bracketed(4, f"{', '.join(MATRIX)} = jnp.moveaxis(", value, ")")
        return
    for argument, names in formula.components.items():
        yield python.unpacked(names, f'parts["{argument}"]')
