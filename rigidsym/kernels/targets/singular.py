"""The parts of NumPy modules that keep to the truth where formulas fail: divisors and series.

Divisors that can vanish are NaN where they cannot be told from zero, and functions of n = |v| are
evaluated without their removable singularities.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil

from rigidsym.algebra.series import FIRST_SERIES, Series, series_of, taylor
from rigidsym.kernels.ir import FUNCTIONS, Call, Expression, Guarded, Kernel, Name, Number
from rigidsym.kernels.lowering.rounding import SINE, adds_angles, rounding
from rigidsym.kernels.targets.layout import bracketed, exploded
from rigidsym.system import resources

_DIVISORS = "kernels_numpy_divisors.jinja"
_SERIES = "kernels_numpy_series.jinja"

Value = Expression | dict[str, Call]  # of an assignment, or the functions c_k of one square


def calls_of(kernel: Kernel) -> dict[str, Call]:
    """name: call, of the assignments that are calls."""
    return {a.name: a.value for a in kernel.assignments if isinstance(a.value, Call)}


def guards_of(kernel: Kernel) -> dict[str, Guarded]:
    """name: guarded value, of the assignments that are one."""
    return {a.name: a.value for a in kernel.assignments if isinstance(a.value, Guarded)}


def imports(kernels: Sequence[Kernel]) -> set[str]:
    """What the scalar twins need of `math`."""
    functions = {call.function for kernel in kernels for call in calls_of(kernel).values()}
    named = functions.intersection(FUNCTIONS)
    return (named - {"abs"}) | ({"sqrt", "tan"} if functions - named else set())


def grouped(kernel: Kernel) -> Iterator[tuple[str, Value]]:
    """The assignments, with all functions c_k of one square in the place of the first."""
    groups: dict[Name, dict[str, Call]] = {}
    for name, call in calls_of(kernel).items():
        if call.order is not None:
            groups.setdefault(call.argument, {})[name] = call
    for assignment in kernel.assignments:
        value = assignment.value
        if not isinstance(value, Call) or value.order is None:
            yield assignment.name, value
        elif assignment.name == next(iter(groups[value.argument])):
            yield assignment.name, groups[value.argument]


def guard_line(indent: int, name: str, guard: Guarded, function: str) -> str:
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


def helpers(kernels: Sequence[Kernel]) -> list[str]:
    """The functions behind guards and series, as far as the kernels need them."""
    environment = resources.environment()
    found = []
    if any(map(guards_of, kernels)):
        found.append(environment.get_template(_DIVISORS).render())
    last = last_order(kernels)
    if last >= 0:
        table = [f"{entry(order)}\n" for order in range(FIRST_SERIES, last + 1)]
        series = f"{{\n{''.join(table)}}}" if table else "{}"
        found.append(environment.get_template(_SERIES).render(series=series))
    return found


def last_order(kernels: Sequence[Kernel]) -> int:
    """The highest k of the functions c_k that are called; -1 where there are none."""
    orders = (call.order for kernel in kernels for call in calls_of(kernel).values())
    return max((order for order in orders if order is not None), default=-1)


def entry(order: int) -> str:
    """A line of the table: k, the switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    numbers = [series.switch, taylor(order - 2)[0], *series.coefficients]
    return exploded(4, f"{order}: (", [repr(float(number)) for number in numbers], "),")


_GUARDED = {
    "angle": "Angles such as pi/2 are not exact floats. Where a sine or cosine that divides is at "
    "most eps times its angle, the angle cannot be told from the pole, and what is divided is NaN. "
    "Elsewhere the error is a few eps of the largest entry for angles that are exact as given; "
    "one known to a relative eps brings eps |angle/divisor| more.",
    "length": "Where c2 divides and n is within 4 eps n of a whole turn, what is divided is NaN; "
    "elsewhere the error is a few eps n/|sin(n/2)| of the largest entry.",
    "sum": "Where a sum that divides is at most 4 eps of its terms' sizes together, what is "
    "divided is NaN; elsewhere the error is a few eps of the sizes over the sum.",
    "minors": "Where the root of a sum of squares of sines and cosines divides, squared, and is at "
    "most 4 eps times one plus the sizes of their angles, what is divided is NaN; elsewhere the "
    "error is a few times that over the root, of the largest entry.",
    "squares": "Where a sum of squares that divides is so small that squares underflow, what is "
    "divided is NaN.",
}


def remarks(kernels: Sequence[Kernel]) -> Iterator[str]:
    """What the docstring of the module says of poles and of series."""
    last = last_order(kernels)
    if last >= 0:
        yield (
            "Functions of n = |v| are written in c0 = cos n, c1 = sin n/n and c_(k+2) = "
            "(c_k(0) - c_k)/n², so that n = 0 is a point like any other. The rounding of n "
            "counts as eps n in its sine and cosine."
        )
    if last >= FIRST_SERIES:
        bounds = (_bound(series_of(order)) for order in range(FIRST_SERIES, last + 1))
        yield f"Below a switch c_k is its Taylor polynomial in n²: {'; '.join(bounds)}."
    found = {kind for kernel in kernels for kind in kinds(kernel)}
    yield from (text for kind, text in _GUARDED.items() if kind in found)


def kinds(kernel: Kernel) -> Iterator[str]:
    """What kinds of divisors are guarded."""
    calls = calls_of(kernel)
    for guard in guards_of(kernel).values():
        call = calls.get(guard.value.text)
        if call is not None:
            yield "angle" if call.order is None else "length"
        else:
            yield "squares" if guard.scale is None else {1: "sum", 2: "minors"}[guard.power]


def _bound(series: Series) -> str:
    return (
        f"c{series.order}, {len(series.coefficients)} terms for n² < {float(series.switch):g}, "
        f"error at most {ceil(series.error)} eps on both sides"
    )


def poles(kernel: Kernel) -> Iterator[str]:
    """What the docstring of a kernel says of the divisors that can vanish."""
    guards = {Name(name): guard for name, guard in guards_of(kernel).items()}
    found = [guards[divisor].value.text for divisor in kernel.divisors if divisor in guards]
    if found:
        yield (
            f"Divides by {', '.join(found)}: near its zeros the result grows and loses digits; "
            "at them what is divided is NaN."
        )


_NAN = "NaN in a component makes every entry that depends on it NaN, and so does an infinite angle."
_LARGE = "Results are accurate for angles of any magnitude."
_ADDED = (
    "Results are accurate for angles of any magnitude. Where angles are added or multiplied before "
    "a sine is taken, rounding the sum adds half an eps of its size."
)


def bound(kernel: Kernel) -> Iterator[str]:
    """The proved bound on the rounding error of one function, if there is one."""
    found = rounding(kernel)
    if found is not None and found.error:
        yield str(found)


def errors(kernels: Sequence[Kernel]) -> Iterator[str]:
    """Paragraphs on errors for the head of a file."""
    called = {call.function for kernel in kernels for call in calls_of(kernel).values()}
    has_angles = not called.isdisjoint(("sin", "cos"))
    angles = [_ADDED if any(map(adds_angles, kernels)) else _LARGE] if has_angles else []
    yield " ".join([*angles, _NAN])
    if any(rounding(kernel) for kernel in kernels):
        yield (
            "Bounds on rounding errors are proved from the operations, in eps of the result's "
            f"type, for sines and cosines within {SINE:g} eps and inputs taken as exact."
        )
