"""One kernel in C: its body, inlined into a function of one orientation and into one of many."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from rigidsym.kernels.ir import Call, Compare, Expression, Guarded, Kernel
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.precision import Precision
from rigidsym.kernels.targets.text.python_layout import bracketed

_FORMS = {"choice": "{0} ? {1} : {2}"}
_PLAIN = frozenset({"sqrt", "abs", "atan2", "eps"})  # functions without far angles


def show(expression: Expression) -> str:
    """An expression in double precision."""
    return infix(expression, _FORMS)


@dataclass(frozen=True, slots=True)
class Function:
    """A kernel in one precision, in the pieces of text that the templates place."""

    name: str  # with the prefix of the module
    kernel: Kernel
    precision: Precision

    def pieces(self) -> dict[str, Any]:
        kernel = self.kernel
        places = [f"{a.name}[{k}]" for a in kernel.arguments for k in range(len(a.components))]
        columns = [f"tile[{k}][j]" for k in range(len(places))]
        return {
            "inputs": len(places),
            "outputs": len(kernel.outputs),
            "arguments": list(self._arguments()),
            "signature": self.signature,
            "array": self._array,
            "array_parameters": _listed(4, "(", self._array_parameters).lstrip(),
            "array_given": _listed(4, "(", map(_name, self._array_parameters)).lstrip(),
            "body": self._body(),
            "scalar_call": self._call("1", places, "out", 4) + ";",
            "tile_call": self._call("0", columns, "at", 12),
            "far_call": self._call("1", columns, "at", 12),
        }

    @property
    def signature(self) -> str:
        real, outputs = self.precision.real, len(self.kernel.outputs)
        given = [f"const {real} {a.name}[{len(a.components)}]" for a in self.kernel.arguments]
        head = f"void {self.name}{self.precision.suffix}("
        return _listed(0, head, [*given, f"{real} out[{outputs}]"])

    @property
    def array_signature(self) -> str:
        return _listed(0, f"void {self._array}(", self._array_parameters)

    @property
    def _array(self) -> str:
        return f"{self.name}_array{self.precision.suffix}"

    @property
    def _array_parameters(self) -> list[str]:
        real = self.precision.real
        items = ["size_t count"]
        for kind, name in (*(("const ", a.name) for a in self.kernel.arguments), ("", "out")):
            items += [f"{kind}{real} *{name}", f"ptrdiff_t {name}_step", f"ptrdiff_t {name}_stride"]
        return items

    def _arguments(self) -> Iterator[dict[str, Any]]:
        """Name, size, and place in the tile."""
        offset = 0
        for argument in self.kernel.arguments:
            count = len(argument.components)
            place = f" + {offset}" if offset else ""
            yield {"name": argument.name, "count": count, "offset": place}
            offset += count

    def _call(self, far: str, places: list[str], result: str, indent: int) -> str:
        head = f"evaluate_{self.kernel.name}{self.precision.suffix}("
        return _listed(indent, head, [far, *places, result]).lstrip()

    def _body(self) -> str:
        kernel, real, word = self.kernel, self.precision.real, self.precision.word
        given = [f"const {real} {name}" for name in kernel.components]
        head = f"INLINED {word} evaluate_{kernel.name}{self.precision.suffix}("
        has_far = any(call.function not in _PLAIN for call in kernel.calls.values())
        unused = [name for name in kernel.components if name not in kernel.used]
        return "\n".join(
            [
                _listed(0, head, ["const int far", *given, f"{real} *out"]),
                "{",
                f"    {word} beyond = 0;",
                *(f"    (void){name};" for name in (*([] if has_far else ["far"]), *unused)),
                *self._lines(),
                *(f"    out[{k}] = {self._text(e)};" for k, e in enumerate(kernel.outputs)),
                "    return beyond;",
                "}",
            ]
        )

    def _lines(self) -> Iterator[str]:
        precision = self.precision
        real, suffix = precision.real, precision.suffix
        for name, value in self.kernel.statements:
            match value:
                case dict():  # all functions c_k of one square
                    (square,) = {call.argument.text for call in value.values()}
                    yield f"    {real} _entire_{square}[ORDERS];"
                    yield f"    beyond |= entire{suffix}(far, {square}, _entire_{square});"
                    for called, call in value.items():
                        yield f"    const {real} {called} = _entire_{square}[{call.order}];"
                case Guarded(divisor):
                    limit = self._limit(value)
                    yield f"    const {real} {name} = or_nan{suffix}({divisor.text}, {limit});"
                case Call("sin" | "cos", argument):
                    both, angle = self.kernel.sines[argument], argument.text
                    if name == next(iter(both.values())):
                        sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                        yield f"    {real} {sine}, {cosine};"
                        yield f"    beyond |= sin_cos{suffix}(far, {angle}, &{sine}, &{cosine});"
                case Call("eps"):
                    yield f"    const {real} {name} = {precision.literal(precision.eps)};"
                case Call(called):
                    used = {"abs": "fabs", "atan2": "angle_of"}.get(called, called)
                    given = ", ".join(argument.text for argument in value.arguments)
                    yield f"    const {real} {name} = {used}{suffix}({given});"
                case _:
                    kind = "int" if isinstance(value, Compare) else real
                    yield f"    const {kind} {name} = {self._text(value)};"

    def _limit(self, guard: Guarded) -> str:
        literal, eps = self.precision.literal, self.precision.eps
        if guard.scale is None:
            return literal(self.precision.tiny / eps)
        return f"{literal(eps**guard.power)} * {self._text(guard.scale)}"

    def _text(self, expression: Expression) -> str:
        nan = f"({self.precision.real})NAN"  # the macro is a float
        return infix(expression, {**_FORMS, "nan": nan}, self.precision.literal)


def _name(parameter: str) -> str:
    return parameter.split()[-1].lstrip("*")


def _listed(indent: int, head: str, items: Iterable[str]) -> str:
    """Parameters or what is given for them; C takes no comma after the last."""
    text = bracketed(indent, head, list(items), ")")
    return text.replace(f",\n{' ' * indent})", ")")
