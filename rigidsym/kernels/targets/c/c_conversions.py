"""Conversions in C: the arithmetic of each formula, once for each type."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import pi
from string import Template

from rigidsym.kernels.conversions.conversions import Formula
from rigidsym.kernels.conversions.formulas import MATRIX, Line
from rigidsym.kernels.ir import Argument, Kernel, Number
from rigidsym.kernels.targets.c.function import Function, function, listed
from rigidsym.kernels.targets.c.precision import PRECISIONS, Precision

_NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?:e[-+]?\d+)?")
_WORD = re.compile(r"[A-Za-z_]\w*")
_CALLED = ("sqrt", "atan2", "hypot", "sin", "cos")  # of the C library
_WIDTH = 92


def outline(formula: Formula, known: Mapping[str, Argument]) -> Kernel:
    """A kernel with the arguments and the results of a formula, without its arithmetic.

    `known` are the arguments of the derivation by name.
    """
    arguments = []
    for name, components in formula.components.items():
        found = known.get(name) or Argument(name=name, components=(), units=(), about="")
        components = components or found.components
        units = found.units or ("",) * len(components)
        arguments.append(replace(found, components=components, units=units))
    count = len(formula.outputs)
    return Kernel(
        name=formula.name,
        arguments=tuple(arguments),
        assignments=(),
        outputs=(Number(0.0),) * count,
        shape=(count,),
        about=formula.about,
        unit=formula.unit,
    )


def converting(prefix: str, formula: Formula, kernel: Kernel) -> Function:
    """The pieces of a formula, whose outline is the kernel."""
    body = {p.suffix: _body(formula, kernel, p) for p in PRECISIONS}
    return replace(function(prefix, kernel), body=body)


def _body(formula: Formula, kernel: Kernel, precision: Precision) -> str:
    real = precision.real
    lines = _needed(_singles(formula.lines), formula.outputs)
    changed = Counter(name for names, _ in lines for name in names)
    names = kernel.components if formula.inputs else _apart(kernel.components)
    given = [f"{'' if changed[name] else 'const '}{real} {name}" for name in names]
    head = f"INLINED {precision.word} evaluate_{formula.name}{precision.suffix}("
    texts = [*(value for _, values in lines for value in values), *formula.outputs]
    used = {word for text in texts for word in _WORD.findall(text)}
    known = set(names)
    own: list[str] = []
    if formula.inputs:
        own += [f"    (void){name};" for name in names if name not in used]
    else:
        own += _matrix(names, precision, changed)
        known = set(MATRIX)
    return "\n".join(
        [
            listed(0, head, ["const int always", *given, f"{real} *out"]),
            "{",
            "    (void)always;",
            *own,
            *_assigned(lines, changed, known, precision),
            *(
                _fitted(f"    out[{k}] = {_spelled(output, precision)};")
                for k, output in enumerate(formula.outputs)
            ),
            "    return 0;",
            "}",
        ]
    )


def _apart(names: Sequence[str]) -> tuple[str, ...]:
    """Names that no entry of R has."""
    return tuple(f"given_{k}" for k, _ in enumerate(names))


def _matrix(names: Sequence[str], precision: Precision, changed: Counter[str]) -> Iterator[str]:
    """The entries of R, by the function that stands before."""
    yield f"    {precision.real} matrix[9];"
    head = f"evaluate_rotation_matrix{precision.suffix}("
    yield f"    {listed(4, head, ['1', *names, 'matrix']).lstrip()};"
    for k, name in enumerate(MATRIX):
        yield f"    {'' if changed[name] else 'const '}{precision.real} {name} = matrix[{k}];"


Lines = list[tuple[tuple[str, ...], tuple[str, ...]]]  # names, and their values


def _singles(lines: Sequence[Line]) -> Lines:
    """One assignment a line, but for names that change places."""
    found: Lines = []
    for text, value in lines:
        names = tuple(text.split(", "))
        values = tuple(value.split(", ")) if len(names) > 1 else (value,)
        if set(names).intersection(values):
            found.append((names, values))
        else:
            found += [((n,), (v,)) for n, v in zip(names, values, strict=True)]
    return found


def _needed(lines: Lines, outputs: Sequence[str]) -> Lines:
    """The lines that reach an output: compilers complain of others."""
    wanted = {word for output in outputs for word in _WORD.findall(output)}
    kept: Lines = []
    for names, values in reversed(lines):
        if wanted.intersection(names):
            kept.append((names, values))
            wanted.difference_update(names)
            wanted.update(word for value in values for word in _WORD.findall(value))
    return kept[::-1]


def _assigned(
    lines: Lines, changed: Counter[str], known: set[str], precision: Precision
) -> Iterator[str]:
    real = precision.real
    for names, values in lines:
        if len(names) > 1:
            yield "    {"
            held = [f"held_{name}" for name in names]
            for name, value in zip(held, values, strict=True):
                yield f"        const {real} {name} = {value};"
            yield from (f"        {n} = {h};" for n, h in zip(names, held, strict=True))
            yield "    }"
            continue
        (name,), (value,) = names, values
        kind = "int" if _is_condition(value) else real
        word = f"{'' if changed[name] > 1 else 'const '}{kind} "
        word = "" if name in known else word
        known.add(name)
        yield _fitted(f"    {word}{name} = {_spelled(value, precision)};")


def _is_condition(value: str) -> bool:
    """Whether a value is true or false: it compares outside of all brackets, or joins two such."""
    outside, count = value, 1
    while count:
        outside, count = re.subn(r"\([^()]*\)", "", outside)
    return re.search(r"[<>&]|==", outside) is not None


def _spelled(text: str, precision: Precision) -> str:
    f = precision.suffix
    text = _NUMBER.sub(lambda found: found[0] + f, text)
    words = {name: name + f for name in _CALLED} | {
        "pick": "PICK",
        "wrapped": f"wrapped{f}",
        "tiny": precision.literal(4 * precision.eps),
        "reach": precision.literal(precision.eps**0.5),
        "nan": "NAN",
        "pi": precision.literal(pi),
    }
    text = re.sub(r"\babs\(", f"fabs{f}(", Template(text).substitute(words))
    return text.replace(") & (", ") && (")


def _fitted(line: str) -> str:
    """A line, broken before an operator or after a comma where it is too long."""
    if len(line) <= _WIDTH:
        return line
    pieces, text = [], line
    while len(text) > _WIDTH:
        place = text.rfind(" ", 12, _WIDTH)
        pieces.append(text[:place])
        text = " " * 8 + text[place + 1 :]
    return "\n".join([*pieces, text])
