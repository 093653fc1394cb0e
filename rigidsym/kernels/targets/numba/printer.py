"""Kernels as a Python module that Numba compiles: the NumPy module with compiled blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import ModuleType
from typing import Any

from rigidsym.errors import MissingExtra
from rigidsym.kernels import loaded
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Guarded,
    Kernel,
    Program,
    functions_of,
    last_order,
)
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.precision import DOUBLE

TEMPLATE = "numba/module.py.jinja"
RESERVED = numpy.RESERVED | {"njit"}
_FUNCTIONS = {name: name for name in FUNCTIONS} | {
    "sqrt": "np.sqrt",
    "atan2": "_angle_of",
    "nan": "np.nan",
}


def render(program: Program) -> dict[str, str]:
    """The module; `unwrap` stays with NumPy."""
    last = last_order(program.kernels)
    orders = ", ".join(f"c{k}" for k in range(max(last, 2) + 1)) if last >= 0 else ""
    text = numpy.module_text(
        program,
        TEMPLATE,
        double=DOUBLE.filled(last),
        orders=orders,
        has_arctangents="atan2" in functions_of(program.kernels),
        kernels=list(map(_compiled, program.kernels)),
    )
    return {f"{program.name}_numba.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra without Numba."""
    if TARGETS["numba"].missing:
        raise MissingExtra("a module that Numba compiles", "numba")
    return loaded.load(f"{name}_numba", files)


def _compiled(kernel: Kernel) -> dict[str, Any]:
    """The loop over a block: rows of components in, rows of entries out."""
    rows = [*(f"_{name}_row" for name in kernel.components)]
    rows += [f"_out{k}" for k in range(len(kernel.outputs))]
    lines = [f"{name} = _{name}_row[_i]" for name in kernel.components]
    lines += _lines(kernel)
    outputs = (infix(output, _FUNCTIONS) for output in kernel.outputs)
    lines += [f"_out{k}[_i] = {output}" for k, output in enumerate(outputs)]
    return {
        "name": kernel.name,
        "rows": ", ".join(rows),
        "body": "\n".join(f"        {line}" for line in lines),
        "in_njit": _in_njit(kernel) if _is_plain(kernel) else None,
    }


def _is_plain(kernel: Kernel) -> bool:
    """Whether its arguments are vectors, and its result is one."""
    kinds = (a.is_matrix or a.is_optional or a.is_scalar for a in kernel.arguments)
    return not kernel.parts and not any(kinds)


def _in_njit(kernel: Kernel) -> dict[str, str]:
    """The function as other compiled functions call it, on one orientation or on rows."""
    vectors = [(argument.name, len(argument.components)) for argument in kernel.arguments]
    names = ", ".join(name for name, _ in vectors)
    columns = [f"{name}[:, {k}]" for name, width in vectors for k in range(width)]
    columns += [f"_found[:, {k}]" for k in range(len(kernel.outputs))]
    called = ", ".join(f"np.atleast_2d({name})" for name, _ in vectors)
    rows = f"_{kernel.name}_rows({called})"
    shape = ", ".join(map(str, kernel.shape))
    return {
        "vectors": names,
        "count": ", ".join(f"{name}.shape[0]" for name, _ in vectors),
        "wide": "\n".join(
            f"    {name} = np.broadcast_to({name}, (_count, {width}))" for name, width in vectors
        ),
        "fits": " and ".join(f"{name}.shape[1] == {width}" for name, width in vectors),
        "columns": ", ".join(columns),
        "entries": str(len(kernel.outputs)),
        "is_one": " and ".join(f"{name}.ndim == 1" for name, _ in vectors),
        "one": f"{rows}.reshape({shape})" if shape else f"{rows}[0, 0]",
        "many": f"{rows}.reshape(-1, {shape})" if shape else f"{rows}[:, 0]",
    }


def _lines(kernel: Kernel) -> Iterator[str]:
    for name, value in kernel.statements:
        match value:
            case dict():  # all functions c_k of one square
                (square,) = {call.argument.text for call in value.values()}
                yield f"_c = _entire_near({square})"
                yield "_far |= _c[-1]"
                yield from (f"{called} = _c[{call.order}]" for called, call in value.items())
            case Guarded(divisor, scale, power):
                eps = " * ".join(["_eps"] * power)
                limit = "_least" if scale is None else f"{eps} * {infix(scale)}"
                yield f"{name} = _unless_lost({divisor.text}, {limit})"
            case Call("eps"):
                yield f"{name} = _eps"
            case Call("sin" | "cos", argument):
                both = kernel.sines[argument]
                if name == next(iter(both.values())):
                    sine, cosine = both.get("sin", "_"), both.get("cos", "_")
                    yield f"{sine}, {cosine}, _more = _sin_cos_near({argument.text})"
                    yield "_far |= _more"
            case _:
                yield f"{name} = {infix(value, _FUNCTIONS)}"
