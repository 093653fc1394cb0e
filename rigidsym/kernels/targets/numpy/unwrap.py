"""`unwrap` in NumPy modules, from the functions of `templates/numpy/unwrap.py`."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence

from rigidsym.kernels.ir import Kernel, Unwrapping
from rigidsym.kernels.targets.text.python import bracketed, docstring
from rigidsym.system import resources

_SOURCE = "numpy/unwrap.py"


def unwrap_text(unwrapping: Unwrapping, block: Callable[[Kernel], str]) -> str:
    """`unwrap`, and the functions that it needs; `block` is how kernels of arrays are written."""
    taken = [argument.name for argument in unwrapping.arguments]
    checked = [f'_checked("{name}", {name})' for name in taken]
    kernels = [k for k in (unwrapping.turns, unwrapping.coordinates) if k is not None]
    given = [f"_{kernel.name}" for kernel in kernels]
    if unwrapping.coordinates is not None:
        given.append(str(len(unwrapping.coordinates.arguments[-1].components)))
    if any("deg" in unit for unit in unwrapping.arguments[0].units) and not kernels:
        checked.append("360.0")
    function = f"_unwrapped_{unwrapping.kind}"
    head = bracketed(0, "def unwrap(", [f"{name}: ArrayLike" for name in taken], ") -> Array:")
    body = bracketed(4, f"return {function}(", [*given, *checked], ")")
    about = docstring(_about(unwrapping), indent=4)
    unwrap = f'{head}\n    """{about}"""\n{body}'
    return "\n\n\n".join([unwrap, *map(block, kernels), *_sources(function)]) + "\n"


def _about(unwrapping: Unwrapping) -> list[str | Sequence[str]]:
    rows = [("q", "(m, ..., n)  the samples on the first axis"), ("returns", "(m, ..., n)")]
    rows[1:1] = [(argument.name, "(..., k)") for argument in unwrapping.arguments[1:]]
    width = max(len(name) for name, _ in rows)
    return [
        "The coordinates along a trajectory, continuous from sample to sample.",
        [f"  {name:<{width}}  {text}" for name, text in rows],
        *unwrapping.remarks,
        "The first sample is not changed. Samples with NaN are skipped.",
    ]


def _sources(wanted: str) -> Iterator[str]:
    """The function and all those of the file that it calls, as they are written there."""
    text = resources.text("templates", _SOURCE)
    functions = {n.name: n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef)}
    needed, waiting = set(), [wanted]
    while waiting:
        name = waiting.pop()
        if name in functions and name not in needed:
            needed.add(name)
            waiting += [n.id for n in ast.walk(functions[name]) if isinstance(n, ast.Name)]
    lines = text.splitlines()
    for name, node in functions.items():
        if name in needed:
            yield "\n".join(lines[node.lineno - 1 : node.end_lineno])
