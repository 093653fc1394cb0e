"""One kernel in C: its body, inlined into a function of one orientation and into one of many."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

from rigidsym.kernels.ir import Call, Compare, Expression, Guarded, Kernel, names_in
from rigidsym.kernels.targets.infix import infix
from rigidsym.kernels.targets.precision import Precision
from rigidsym.kernels.targets.python import WIDTH

_FORMS = {"choice": "{0} ? {1} : {2}"}
_WIDTH = 92


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


@dataclass(frozen=True, slots=True)
class Function:
    """A kernel in one precision, in the pieces of text that the templates place."""

    name: str  # with the prefix of the module
    kernel: Kernel
    precision: Precision
    contents: Contents

    def pieces(self) -> dict[str, Any]:
        """The texts of a function with arrays; its arguments follow one another in one row."""
        kernel = self.kernel
        return {
            "kernel": kernel.name,
            "inputs": len(kernel.components),
            "outputs": len(kernel.outputs),
            "signature": self.signature,
            "array_signature": self.array_signature,
            "body": self._body(),
            "one": "\n".join(self._one()),
            "many": "\n".join(self._many()),
        }

    def _one(self) -> Iterator[str]:
        """The lines that compute one orientation."""
        named, given = self.precision.named, self.kernel.arguments
        row, place = given[0].name, 0
        if len(given) > 1:
            row = "in"
            yield f"    {self.precision.real} in[{len(self.kernel.components)}];"
            for a in given:
                yield f"    {named('copy')}({len(a.components)}, {a.name}, in + {place});"
                place += len(a.components)
        yield f"    {named(f'evaluate_{self.kernel.name}')}(1, 1, {row}, out);"

    def _many(self) -> Iterator[str]:
        """The lines that compute an array of orientations."""
        named, arguments = self.precision.named, self.kernel.arguments
        yield f"    const {named('array')} given[] = {{"
        for a in arguments:
            yield f"        {{ {a.name}, {a.name}_step, {a.name}_stride, {len(a.components)} }},"
        yield "    };"
        given = f"count, {len(arguments)}, given, out, out_step, out_stride"
        yield f"    {named(f'{self.kernel.name}_of_rows')}({given});"

    @property
    def signature(self) -> str:
        real, head = self.precision.real, f"void {self.precision.named(self.name)}("
        given = [f"const {real} {a.name}[{len(a.components)}]" for a in self.kernel.arguments]
        return _listed(head, [*given, f"{real} out[{len(self.kernel.outputs)}]"])

    @property
    def array_signature(self) -> str:
        real = self.precision.real
        items = ["size_t count"]
        for kind, name in (*(("const ", a.name) for a in self.kernel.arguments), ("", "out")):
            items += [f"{kind}{real} *{name}", f"ptrdiff_t {name}_step", f"ptrdiff_t {name}_stride"]
        return _listed(f"void {self.precision.named(f'{self.name}_array')}(", items)

    def _body(self) -> str:
        kernel, real, word = self.kernel, self.precision.real, self.precision.word
        read = [
            f"{name} = {_entry('in', place)}"
            for place, name in enumerate(kernel.components)
            if name in kernel.used
        ]
        unbroken = ", ".join(item.replace(" ", "\xa0") for item in read)
        lines = wrap(f"    const {real} {unbroken};", _WIDTH, subsequent_indent=" " * 8)
        declared = [line.replace("\xa0", " ") for line in lines if read]
        statements = [f"    {line}" for step in self._steps() for line in step.lines]
        return "\n".join(
            [
                f"EVALUATE({kernel.name})",
                "{",
                f"    {word} beyond = 0;",
                "    (void)far, (void)apart, (void)in;",
                *declared,
                *statements,
                "    return beyond;",
                "}",
            ]
        )

    def plain(self) -> str:
        """The function of one orientation; an entry of the result follows the values it needs.

        So few values wait at a time, and the compiler needs little stack for them.
        """
        kernel, real = self.kernel, self.precision.real
        steps = list(self._steps())
        place = dict.fromkeys(kernel.components, 0)  # how many definitions a value needs
        definitions = [step for step in steps if step.defines]
        for count, step in enumerate(definitions, start=1):
            place |= dict.fromkeys(step.defines, count)
        results: defaultdict[int, list[CStatement]] = defaultdict(list)
        for step in steps:
            if not step.defines:
                results[max((place[name] for name in step.uses), default=0)].append(step)
        ordered = [*results[0]]
        for count, step in enumerate(definitions, start=1):
            ordered += [step, *results[count]]
        used = {name for step in steps for name in step.uses}
        unused = [a.name for a in kernel.arguments if kernel.used.isdisjoint(a.components)]
        components = [(a, k, name) for a in kernel.arguments for k, name in enumerate(a.components)]
        return "\n".join(
            [
                self.signature,
                "{",
                *(f"    (void){name};" for name in unused),
                *(f"    const {real} {n} = {a.name}[{k}];" for a, k, n in components if n in used),
                *(f"    {line}" for step in ordered for line in step.lines),
                "}",
            ]
        )

    def _steps(self) -> Iterator[CStatement]:
        """The statements in order, then the entries of the result."""
        for name, value in self.kernel.statements:
            values = list(value.values()) if isinstance(value, dict) else [value]
            if isinstance(value, Call) and value.function == "eps":
                values = []  # a number here: the type of its argument is known
            used = frozenset(n for each in values for n in names_in(each))
            known = frozenset(value) if isinstance(value, dict) else frozenset(self._named(name))
            yield CStatement(tuple(self._lines(name, value)), known, used)
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
        called = self.precision.named(helper)
        if self.contents.libm:
            return f"{called}({', '.join(arguments)});"
        tracked, far = ("beyond |= ", "far") if self.contents.arrays else ("(void)", "1")
        return f"{tracked}{called}({', '.join((far, *arguments))});"

    def _lines(self, name: str, value: Expression | dict[str, Call]) -> Iterator[str]:
        precision = self.precision
        real, named = precision.real, precision.named
        match value:
            case dict():  # all functions c_k of one square
                (square,) = {call.argument.text for call in value.values()}
                yield f"{real} _entire_{square}[ORDERS];"
                yield self._reduced("entire", square, f"_entire_{square}")
                for called, call in value.items():
                    yield f"const {real} {called} = _entire_{square}[{call.order}];"
            case Guarded(divisor):
                kept = f"{named('or_nan')}({divisor.text}, {self._limit(value)})"
                yield f"const {real} {name} = {kept};"
            case Call("sin" | "cos", argument) if not self.contents.libm:
                both, angle = self.kernel.sines[argument], argument.text
                if name == next(iter(both.values())):
                    sine, cosine = (both.get(f, f"_{f}_{angle}") for f in ("sin", "cos"))
                    if self.contents.arrays:
                        yield f"SIN_COS({angle}, {sine}, {cosine});"
                    else:
                        yield f"{real} {sine}, {cosine};"
                        yield self._reduced("sin_cos", angle, f"&{sine}", f"&{cosine}")
            case Call("eps"):
                yield f"const {real} {name} = {precision.of_eps()};"
            case Call(called):
                own = {} if self.contents.libm else {"atan2": "angle_of"}
                used = {"abs": "fabs", **own}.get(called, called)
                given = ", ".join(argument.text for argument in value.arguments)
                yield f"const {real} {name} = {named(used)}({given});"
            case _:
                kind = "int" if isinstance(value, Compare) else real
                yield f"const {kind} {name} = {self._text(value)};"

    def _limit(self, guard: Guarded) -> str:
        if guard.scale is None:
            return self.precision.least
        return f"{self.precision.of_eps(guard.power)} * {self._text(guard.scale)}"

    def _text(self, expression: Expression) -> str:
        nan = f"({self.precision.real})NAN"  # the macro is a float
        return infix(
            expression,
            {**_FORMS, "nan": nan},
            self.precision.literal,
            explicit=not self.contents.is_module,
        )


def _entry(array: str, k: int) -> str:
    """Of components that are `apart` from one to the next."""
    return f"{array}[{f'{k} * ' if k > 1 else ''}{'apart' if k else 0}]"


def _listed(head: str, parameters: Iterable[str]) -> str:
    """A head with its parameters: in its line, or in the next, or in a line each."""
    items = list(parameters)
    joined = ", ".join(items)
    if len(f"{head}{joined})") <= WIDTH:
        return f"{head}{joined})"
    if len(f"    {joined}") <= WIDTH:
        return f"{head}\n    {joined}\n)"
    return f"{head}\n    " + ",\n    ".join(items) + ")"
