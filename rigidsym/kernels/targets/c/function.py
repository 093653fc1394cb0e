"""One kernel in C: its body, inlined into a function of one orientation and into one of many."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

from rigidsym.kernels.ir import Call, Compare, Expression, Guarded, Kernel, names_in
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.precision import Precision
from rigidsym.kernels.targets.text.python_layout import bracketed

_FORMS = {"choice": "{0} ? {1} : {2}"}
_WIDTH = 92
_PLAIN = frozenset({"sqrt", "abs", "atan2", "eps"})  # functions without far angles


def show(expression: Expression) -> str:
    """An expression in double precision."""
    return infix(expression, _FORMS)


@dataclass(frozen=True, kw_only=True, slots=True)
class Contents:
    """What a source holds; the values are those of the target's options."""

    precision: str = "both"
    arrays: bool = True
    libm: bool = False

    @property
    def is_module(self) -> bool:
        """Whether a Python module can be made of it."""
        return self.arrays and self.precision == "both"


@dataclass(frozen=True, slots=True)
class CStatement:
    """A statement or an entry of the result, in lines of C."""

    lines: tuple[str, ...]
    defines: frozenset[str]
    uses: frozenset[str]
    is_condition: bool = False  # else a number


@dataclass(frozen=True, slots=True)
class Function:
    """A kernel in one precision, in the pieces of text that the templates place."""

    name: str  # with the prefix of the module
    kernel: Kernel
    precision: Precision
    contents: Contents

    def pieces(self) -> dict[str, Any]:
        kernel, arguments = self.kernel, list(self._arguments())
        columns = [f"tile{a['offset']} + j" for a in arguments]
        return {
            "name": self.name,
            "inputs": len(kernel.components),
            "outputs": len(kernel.outputs),
            "arguments": arguments,
            "signature": self.signature,
            "array": self._array,
            "array_parameters": listed(4, "(", self._array_parameters).lstrip(),
            "array_given": listed(4, "(", map(_name, self._array_parameters)).lstrip(),
            "body": self._body(),
            "scalar_call": self._call(4, "1", "1", *(a["name"] for a in arguments), "out") + ";",
            "tile_call": self._call(12, "0", "TILE", *columns, "found + j"),
            "far_call": self._call(12, "1", "TILE", *columns, "found + j"),
        }

    @property
    def signature(self) -> str:
        real, outputs = self.precision.real, len(self.kernel.outputs)
        given = [f"const {real} {a.name}[{len(a.components)}]" for a in self.kernel.arguments]
        head = f"void {self.name}{self.precision.suffix}("
        return listed(0, head, [*given, f"{real} out[{outputs}]"])

    @property
    def array_signature(self) -> str:
        return listed(0, f"void {self._array}(", self._array_parameters)

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
            place = f" + {offset} * TILE" if offset else ""
            yield {"name": argument.name, "count": count, "offset": place}
            offset += count

    def _call(self, indent: int, *given: str) -> str:
        head = f"evaluate_{self.kernel.name}{self.precision.suffix}("
        return listed(indent, head, given).lstrip()

    def _body(self) -> str:
        kernel, real, word = self.kernel, self.precision.real, self.precision.word
        given = [f"const {real} *in{k}" for k in range(len(kernel.arguments))]
        head = f"INLINED {word} evaluate_{kernel.name}{self.precision.suffix}("
        called = (call.function for call in kernel.calls.values())
        has_far = not self.contents.libm and not _PLAIN.issuperset(called)
        read = [
            f"{name} = {_entry(f'in{k}', place)}"
            for k, argument in enumerate(kernel.arguments)
            for place, name in enumerate(argument.components)
            if name in kernel.used
        ]
        unused = [f"in{k}" for k in range(len(given)) if f" in{k}[" not in "".join(read)]
        unbroken = ", ".join(item.replace(" ", "\xa0") for item in read)
        lines = wrap(f"    const {real} {unbroken};", _WIDTH, subsequent_indent=" " * 8)
        declared = [line.replace("\xa0", " ") for line in lines if read]
        return "\n".join(
            [
                listed(0, head, ["const int far", "const ptrdiff_t apart", *given, f"{real} *out"]),
                "{",
                f"    {word} beyond = 0;",
                *(
                    f"    (void){name};"
                    for name in (*([] if has_far else ["far"]), "apart", *unused)
                ),
                *declared,
                *(f"    {line}" for step in self.steps() for line in step.lines),
                "    return beyond;",
                "}",
            ]
        )

    def steps(self) -> Iterator[CStatement]:
        """The statements in order, then the entries of the result."""
        for name, value in self.kernel.statements:
            values = list(value.values()) if isinstance(value, dict) else [value]
            if isinstance(value, Call) and value.function == "eps":
                values = []  # a number here: the type of its argument is known
            used = frozenset(n for each in values for n in names_in(each))
            known = frozenset(value) if isinstance(value, dict) else frozenset(self._named(name))
            yield CStatement(
                tuple(self._lines(name, value)), known, used, isinstance(value, Compare)
            )
        for k, value in enumerate(self.kernel.outputs):
            place = _entry("out", k) if self.contents.arrays else f"out[{k}]"
            line = f"{place} = {self._text(value)};"
            yield CStatement((line,), frozenset(), frozenset(names_in(value)))

    def _named(self, name: str) -> Iterable[str]:
        """The names of a statement: own sines and cosines of one angle come together."""
        call = self.kernel.calls.get(name)
        if self.contents.libm or call is None or call.function not in ("sin", "cos"):
            return (name,)
        both = self.kernel.sines[call.argument]
        return both.values() if name == next(iter(both.values())) else ()

    def _reduced(self, helper: str, *arguments: str) -> str:
        """A call of a helper that reduces angles, in arrays the far ones later."""
        if self.contents.libm:
            return f"{helper}{self.precision.suffix}({', '.join(arguments)});"
        tracked, far = ("beyond |= ", "far") if self.contents.arrays else ("(void)", "1")
        return f"{tracked}{helper}{self.precision.suffix}({', '.join((far, *arguments))});"

    def _lines(self, name: str, value: Expression | dict[str, Call]) -> Iterator[str]:
        precision = self.precision
        real, suffix = precision.real, precision.suffix
        match value:
            case dict():  # all functions c_k of one square
                (square,) = {call.argument.text for call in value.values()}
                yield f"{real} _entire_{square}[ORDERS];"
                yield self._reduced("entire", square, f"_entire_{square}")
                for called, call in value.items():
                    yield f"const {real} {called} = _entire_{square}[{call.order}];"
            case Guarded(divisor):
                yield f"const {real} {name} = or_nan{suffix}({divisor.text}, {self._limit(value)});"
            case Call("sin" | "cos", argument) if not self.contents.libm:
                both, angle = self.kernel.sines[argument], argument.text
                if name == next(iter(both.values())):
                    sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                    yield f"{real} {sine}, {cosine};"
                    yield self._reduced("sin_cos", angle, f"&{sine}", f"&{cosine}")
            case Call("eps"):
                yield f"const {real} {name} = {precision.literal(precision.eps)};"
            case Call(called):
                own = {} if self.contents.libm else {"atan2": "angle_of"}
                used = {"abs": "fabs", **own}.get(called, called)
                given = ", ".join(argument.text for argument in value.arguments)
                yield f"const {real} {name} = {used}{suffix}({given});"
            case _:
                kind = "int" if isinstance(value, Compare) else real
                yield f"const {kind} {name} = {self._text(value)};"

    def _limit(self, guard: Guarded) -> str:
        literal, eps = self.precision.literal, self.precision.eps
        if guard.scale is None:
            return literal(self.precision.tiny / eps)
        return f"{literal(eps**guard.power)} * {self._text(guard.scale)}"

    def _text(self, expression: Expression) -> str:
        nan = f"({self.precision.real})NAN"  # the macro is a float
        return infix(expression, {**_FORMS, "nan": nan}, self.precision.literal)


def _entry(array: str, k: int) -> str:
    """Of components that are `apart` from one to the next."""
    return f"{array}[{f'{k} * ' if k > 1 else ''}{'apart' if k else 0}]"


def _name(parameter: str) -> str:
    return parameter.split()[-1].lstrip("*")


def listed(indent: int, head: str, items: Iterable[str]) -> str:
    """Parameters or what is given for them; C takes no comma after the last."""
    text = bracketed(indent, head, list(items), ")")
    return text.replace(f",\n{' ' * indent})", ")")
