"""`unwrap` in NumPy modules, from the functions of `templates/numpy/unwrap.py`."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from rigidsym.kernels.ir import Program
from rigidsym.kernels.targets.text.python import docstring
from rigidsym.system import resources

_SOURCE = "numpy/unwrap.py"


def unwrap_text(program: Program) -> str:
    """`unwrap`, and the functions that it needs."""
    continuity = program.continuity
    assert continuity is not None
    inputs = ['_checked("q", q)']
    if continuity.kind == "euler":
        inputs.append(str(continuity.quarters))
    function = f"_unwrapped_{continuity.kind}"
    about = [
        "The coordinates along a trajectory, continuous from sample to sample.",
        ["  q        (m, ..., n)  the samples on the first axis", "  returns  (m, ..., n)"],
        *continuity.remarks,
        "The first sample is not changed. Samples with NaN are skipped.",
    ]
    unwrap = (
        f'def unwrap(q: ArrayLike) -> Array:\n    """{docstring(about, indent=4)}"""\n'
        f"    return {function}({', '.join(inputs)})"
    )
    return "\n\n\n".join([unwrap, *_sources(function)]) + "\n"


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
