"""One kernel in C: its body, inlined into a function of one orientation and into one of many."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Compare,
    Expression,
    Guarded,
    Kernel,
    Name,
    Number,
    names_in,
)
from rigidsym.kernels.targets.c.precision import PRECISIONS, Precision
from rigidsym.kernels.targets.text import statements
from rigidsym.kernels.targets.text.infix import infix, literal
from rigidsym.kernels.targets.text.python_layout import bracketed

_FUNCTIONS = {name: name for name in FUNCTIONS} | {"choice": "{0} ? {1} : {2}", "nan": "NAN"}
show = partial(infix, functions=_FUNCTIONS)

_PLAIN = frozenset({"sqrt", "abs", "atan2", "eps"})  # functions without far angles

Texts = dict[str, str]  # by the suffix of the precision


@dataclass(frozen=True, kw_only=True, slots=True)
class Taken:
    """An argument in an array function: its size, and where it stands in the tile."""

    name: str
    count: int
    offset: str  # " + 3"


@dataclass(frozen=True, kw_only=True, slots=True)
class CFunction:
    """The pieces of text that stand for one kernel in the templates."""

    inputs: int
    outputs: int
    arguments: tuple[Taken, ...]
    signature: Texts
    array_signature: Texts
    body: Texts
    scalar_call: Texts
    tile_call: Texts
    far_call: Texts

    @property
    def entries(self) -> range:
        return range(self.outputs)

    def declared(self) -> dict[str, Texts]:
        return {"signature": self.signature, "array_signature": self.array_signature}


def function(prefix: str, kernel: Kernel) -> CFunction:
    """The text of a kernel for both precisions; names begin with the prefix."""
    name = f"{prefix}_{kernel.name}"
    places = [f"{a.name}[{k}]" for a in kernel.arguments for k in range(len(a.components))]
    columns = [f"tile[{k}][j]" for k in range(len(places))]
    each = {p.suffix: p for p in PRECISIONS}
    return CFunction(
        inputs=len(places),
        outputs=len(kernel.outputs),
        arguments=tuple(_taken(kernel)),
        signature={f: _signature(name, kernel, p) for f, p in each.items()},
        array_signature={f: _array_signature(name, kernel, p) for f, p in each.items()},
        body={f: _body(kernel, p) for f, p in each.items()},
        scalar_call={f: _call(kernel, f, "1", places, "out", 4) + ";" for f in each},
        tile_call={f: _call(kernel, f, "0", columns, "at", 12) for f in each},
        far_call={f: _call(kernel, f, "1", columns, "at", 12) for f in each},
    )


def _taken(kernel: Kernel) -> Iterator[Taken]:
    offset = 0
    for argument in kernel.arguments:
        count = len(argument.components)
        yield Taken(name=argument.name, count=count, offset=f" + {offset}" if offset else "")
        offset += count


def _signature(name: str, kernel: Kernel, precision: Precision) -> str:
    given = [f"const {precision.real} {a.name}[{len(a.components)}]" for a in kernel.arguments]
    filled = f"{precision.real} out[{len(kernel.outputs)}]"
    return listed(0, f"void {name}{precision.suffix}(", [*given, filled])


def _array_signature(name: str, kernel: Kernel, precision: Precision) -> str:
    items = ["size_t count"]
    for argument in (*(f"const {precision.real} *{a.name}" for a in kernel.arguments), ""):
        vector = argument.split("*")[-1] or "out"
        items += [
            argument or f"{precision.real} *out",
            f"ptrdiff_t {vector}_step",
            f"ptrdiff_t {vector}_stride",
        ]
    return listed(0, f"void {name}_array{precision.suffix}(", items)


def _call(
    kernel: Kernel, suffix: str, far: str, places: list[str], result: str, indent: int
) -> str:
    return listed(indent, f"evaluate_{kernel.name}{suffix}(", [far, *places, result]).lstrip()


def listed(indent: int, head: str, items: Sequence[str]) -> str:
    """Parameters or what is given for them; C takes no comma after the last."""
    text = bracketed(indent, head, items, ")")
    return text.replace(f",\n{' ' * indent})", ")")


def _body(kernel: Kernel, precision: Precision) -> str:
    real, suffix = precision.real, precision.suffix
    given = [f"const {real} {name}" for name in kernel.components]
    head = f"INLINED {precision.word} evaluate_{kernel.name}{suffix}("
    items = ["const int far", *given, f"{real} *out"]
    return "\n".join(
        [
            listed(0, head, items),
            "{",
            f"    {precision.word} beyond = 0;",
            *_unused(kernel),
            *_lines(kernel, precision),
            *_outputs(kernel, precision),
            "    return beyond;",
            "}",
        ]
    )


def _unused(kernel: Kernel) -> Iterator[str]:
    """What C is told of the parameters that this kernel has no use for."""
    wholes = [*(assignment.value for assignment in kernel.assignments), *kernel.outputs]
    used = {name for whole in wholes for name in names_in(whole)}
    if all(call.function in _PLAIN for call in statements.calls_of(kernel).values()):
        yield "    (void)far;"
    yield from (f"    (void){name};" for name in kernel.components if name not in used)


def _lines(kernel: Kernel, precision: Precision) -> Iterator[str]:
    real, suffix = precision.real, precision.suffix
    written: set[Call] = set()
    calls = {call: name for name, call in statements.calls_of(kernel).items()}
    for name, value in statements.grouped(kernel):
        match value:
            case dict():
                yield from _entire(value, precision)
            case Guarded():
                yield f"    const {real} {name} = {_guarded(value, precision)};"
            case Call("sin" | "cos", argument):
                if value in written:
                    continue
                pair = [Call("sin", argument), Call("cos", argument)]
                written.update(pair)
                names = [calls.get(call, f"_{call.function}_{argument.text}") for call in pair]
                yield f"    {real} {names[0]}, {names[1]};"
                angle = argument.text
                yield (f"    beyond |= sin_cos{suffix}(far, {angle}, &{names[0]}, &{names[1]});")
            case Call("eps"):
                yield f"    const {real} {name} = {precision.literal(precision.eps)};"
            case Call(called):
                used = {"abs": "fabs", "atan2": "angle_of"}.get(called, called)
                given = ", ".join(argument.text for argument in value.arguments)
                yield f"    const {real} {name} = {used}{suffix}({given});"
            case Compare():
                yield f"    const int {name} = {_text(value, precision)};"
            case _:
                yield f"    const {real} {name} = {_text(value, precision)};"


def _entire(group: dict[str, Call], precision: Precision) -> Iterator[str]:
    """All functions c_k of one square."""
    (square,) = {call.argument.text for call in group.values()}
    held = f"_entire_{square}"
    yield f"    {precision.real} {held}[ORDERS];"
    yield f"    beyond |= entire{precision.suffix}(far, {square}, {held});"
    for name, call in group.items():
        yield f"    const {precision.real} {name} = {held}[{call.order}];"


def _guarded(guard: Guarded, precision: Precision) -> str:
    eps = precision.literal(precision.eps**guard.power)
    match guard.scale:
        case Name(scale):
            limit = f"{eps} * {scale}"
        case Number(number):
            limit = f"{eps} * {literal(number, precision.literal)}"
        case _:
            limit = precision.literal(precision.tiny / precision.eps)
    return f"or_nan{precision.suffix}({guard.value.text}, {limit})"


def _outputs(kernel: Kernel, precision: Precision) -> Iterator[str]:
    for place, output in enumerate(kernel.outputs):
        yield f"    out[{place}] = {_text(output, precision)};"


def _text(expression: Expression, precision: Precision) -> str:
    return show(expression, number=precision.literal)
