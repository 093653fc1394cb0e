"""Kernels as a Python module that Numba compiles: the NumPy module with compiled blocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import pi
from types import ModuleType
from typing import Any

from rigidsym.algebra.series import FIRST_SERIES, series_of, taylor
from rigidsym.errors import MissingExtra
from rigidsym.kernels.ir import FUNCTIONS, Call, Guarded, Kernel, Name, Number, Program
from rigidsym.kernels.lowering.arctangent import arctangent
from rigidsym.kernels.lowering.sincos import reduction
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.numpy import printer as numpy
from rigidsym.kernels.targets.text import python, statements
from rigidsym.kernels.targets.text.infix import infix, literal

TEMPLATE = "numba/module.py.jinja"
RESERVED = numpy.RESERVED | {"njit"}
_FUNCTIONS = {name: name for name in FUNCTIONS} | {
    "sqrt": "np.sqrt",
    "atan2": "_angle_of",
    "nan": "np.nan",
}


def render(program: Program) -> dict[str, str]:
    """The module; `unwrap` stays with NumPy."""
    kernels = program.kernels
    calls = [call for kernel in kernels for call in statements.calls_of(kernel).values()]
    last = max((call.order for call in calls if call.order is not None), default=-1)
    found = reduction(53)
    polynomials = list(zip(_falling(found.sine), _falling(found.cosine), strict=True))
    text = numpy.module_text(
        program,
        TEMPLATE,
        reach=f"{found.reach:.0f}.0",
        two_over_pi=repr(2 / pi),
        magic=repr(1.5 * 2.0**52),  # a float of this size has no fraction
        parts=[repr(float(part)) for part in found.parts],
        first=polynomials[0],
        rest=polynomials[1:],
        series=None if last < 0 else [_series(k) for k in range(FIRST_SERIES, last + 1)],
        orders=", ".join(f"c{k}" for k in range(max(last, 2) + 1)),
        arctangent=_arctangent() if "atan2" in {call.function for call in calls} else None,
        kernels=[_compiled(kernel) for kernel in kernels],
    )
    return {f"{program.name}_numba.py": text}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself; raises MissingExtra without Numba."""
    if TARGETS["numba"].missing:
        raise MissingExtra("a module that Numba compiles", "numba")
    (source,) = files.values()
    return python.module_from(f"{name}_numba", source)


def _falling(coefficients: Sequence[Fraction]) -> list[str]:
    """From the highest power down, as Horner's rule takes them."""
    return [repr(float(coefficient)) for coefficient in reversed(coefficients)]


def _series(order: int) -> dict[str, Any]:
    """c_k below its switch and above it."""
    series = series_of(order)
    return {
        "order": order,
        "before": order - 2,
        "near": _falling(series.coefficients),
        "start": repr(float(taylor(order - 2)[0])),
        "switch": repr(float(series.switch)),
    }


def _arctangent() -> dict[str, Any]:
    """The numbers of the angle of a point."""
    found = arctangent(53)
    high, low = map(repr, found.eighth)
    polynomial = _falling(found.coefficients)
    return {"edge": repr(found.edge), "polynomial": polynomial, "high": high, "low": low}


def _compiled(kernel: Kernel) -> dict[str, Any]:
    """The loop over a block: rows of components in, rows of entries out."""
    rows = [*(f"_{name}_row" for name in kernel.components)]
    rows += [f"_out{k}" for k in range(len(kernel.outputs))]
    lines = [f"{name} = _{name}_row[_i]" for name in kernel.components]
    lines += _lines(kernel)
    lines += [f"_out{k}[_i] = {_show(output)}" for k, output in enumerate(kernel.outputs)]
    return {
        "name": kernel.name,
        "rows": ", ".join(rows),
        "body": "\n".join(f"        {line}" for line in lines),
    }


def _show(expression: Any) -> str:
    return infix(expression, _FUNCTIONS)


def _lines(kernel: Kernel) -> Iterator[str]:
    calls = {call: name for name, call in statements.calls_of(kernel).items()}
    written: set[Call] = set()
    for name, value in statements.grouped(kernel):
        match value:
            case dict():
                yield from _entire(value)
            case Guarded():
                yield f"{name} = _unless_lost({value.value.text}, {_limit(value)})"
            case Call("eps"):
                yield f"{name} = _eps"
            case Call("sin" | "cos", argument):
                if value not in written:
                    pair = [Call("sin", argument), Call("cos", argument)]
                    written.update(pair)
                    sine, cosine = (calls.get(call, "_") for call in pair)
                    yield f"{sine}, {cosine}, _more = _sin_cos_near({argument.text})"
                    yield "_far |= _more"
            case _:
                yield f"{name} = {_show(value)}"


def _entire(group: Mapping[str, Call]) -> Iterator[str]:
    """All functions c_k of one square."""
    (square,) = {call.argument.text for call in group.values()}
    yield f"_c = _entire_near({square})"
    yield "_far |= _c[-1]"
    yield from (f"{name} = _c[{call.order}]" for name, call in group.items())


def _limit(guard: Guarded) -> str:
    eps = " * ".join(["_eps"] * guard.power)
    match guard.scale:
        case Name(scale):
            return f"{eps} * {scale}"
        case Number(number):
            return f"{eps} * {literal(number)}"
    return "_least"
