"""Text that all Python modules share: for NumPy, Numba, JAX and compiled modules.

Signatures and calls have the layout that `ruff format` gives them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from rigidsym.kernels.ir import FUNCTIONS, Call, Expression, Kernel, Program
from rigidsym.kernels.targets import remarks
from rigidsym.kernels.targets.infix import broken, infix
from rigidsym.system import resources

WIDTH = 88
MANY = 8  # components
_UNWELCOME = ("l", "O", "I")  # linters refuse these names
RESERVED = frozenset({*FUNCTIONS, *_UNWELCOME, "nan", "max", "min"})
_CALL = re.compile(r"([A-Za-z_][\w.]*\()(.*)\)")
_QUOTES = '"""'
SERIES = "    {}: ({}),"


def statement(
    indent: int, name: str, value: Expression | dict[str, Call], words: Mapping[str, str]
) -> str:
    """One assignment, or that of all functions c_k of one square, which words["entire"] computes.

    What is too wide for a line is broken in the brackets of its call, or in brackets of its own.
    """
    if isinstance(value, dict):
        calls = list(value.values())
        name = ", ".join(value) if len(calls) > 1 else f"({name},)"
        given = [calls[0].argument.text, *(str(call.order) for call in calls)]
        text = words["entire"].format(", ".join(given))
    else:
        text = infix(value, words)
    margin, inner = " " * indent, " " * (indent + 4)
    line = f"{margin}{name} = {text}"
    if len(line) <= WIDTH:
        return line
    if call := _CALL.fullmatch(text):
        return bracketed(indent, f"{name} = {call[1]}", call[2].split(", "), ")")
    return f"{margin}{name} = (\n{broken(inner + text, WIDTH, inner)}\n{margin})"


def taken_apart(names: Sequence[str], text: str) -> str:
    """The assignment of several values to names, in lines that fit."""
    line = f"    {', '.join(names) if len(names) > 1 else f'({names[0]},)'} = {text}"
    return (
        line if len(line) <= WIDTH else broken(f"    ({', '.join(names)}) = {text}", WIDTH, " " * 8)
    )


def signature(kernel: Kernel, *options: str) -> str:
    """Of a function of arrays, with types."""
    arrays = [f"{a.name}: ArrayLike" for a in kernel.arguments]
    given = [*arrays, *(["*", *options] if options else [])]
    return bracketed(0, f"def {kernel.name}(", given, ") -> Array:")


def passed(kernel: Kernel, library: str) -> list[str]:
    """What a function of arrays passes on: name=value."""
    values = {a.name: a.name for a in kernel.arguments}
    for a in kernel.arguments:
        if len(a.shape) > 1:
            values[a.name] = f'_entries("{a.name}", {a.name}, {a.shape})'
        if not a.shape:
            values[a.name] = f"{library}.asarray({a.name})[..., None]"
    return [f"{name}={value}" for name, value in values.items()]


def module_text(
    program: Program, template: str, *, about: str, names: Sequence[str], **facts: object
) -> str:
    """The text of a module that exports some names, with the tables that all modules have."""
    components = []
    for argument in program.arguments:
        quoted = [f'"{name}"' for name in argument.components]
        components.append(broken(f'    "{argument.name}": {tuple_of(quoted)},', WIDTH, " " * 8))
    facts |= {"about": about, "names": sorted(names), "components": components}
    facts |= {"signature": signature, "about_function": about_function}
    return resources.environment().get_template(template).render(program=program, **facts)


# docstrings


def about_module(template: str, program: Program, **facts: object) -> str:
    """The inside of a module's docstring."""
    rows = [(a.name, _leading(a.shape), a.about) for a in program.arguments]
    table = remarks.table(rows)
    return docstring(remarks.about_module(template, program, table=table, **facts))


def about_function(kernel: Kernel) -> str:
    """The inside of a function's docstring; of many components it names the ends."""
    rows = []
    for a in kernel.arguments:
        names = a.components
        names = names if len(names) <= MANY else (*names[:2], "...", names[-1])
        units = remarks.in_units(a.units)
        rows.append((a.name, _leading(a.shape), ", ".join(names) + units))
    unit = f"in {kernel.unit}" if kernel.unit else ""
    rows.append(("returns", _leading(kernel.shape), unit))
    texts = remarks.about_kernel("python/function.txt.jinja", kernel, table=remarks.table(rows))
    return docstring(texts, indent=4)


def _leading(shape: Sequence[int]) -> str:
    return f"({', '.join(['...', *map(str, shape)])})"


def docstring(paragraphs: Sequence[remarks.Paragraph], indent: int = 0) -> str:
    """The inside of a docstring: paragraphs are filled, sequences of lines kept."""
    room = WIDTH - indent
    first = remarks.filled(paragraphs[0], room - len(_QUOTES) * (2 if len(paragraphs) == 1 else 1))
    blocks = [first, *(remarks.filled(paragraph, room) for paragraph in paragraphs[1:])]
    margin = " " * indent
    text = "\n\n".join("\n".join(margin + line for line in block) for block in blocks)
    text = text.strip().replace("\\", "\\\\").replace(_QUOTES, r"\"\"\"")
    return f"{text}\n{margin}" if "\n" in text else text


# layout


def bracketed(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets: in one line, or in a line of their own, or each in one."""
    margin, inner = " " * indent, " " * (indent + 4)
    joined = ", ".join(items)
    if len(f"{margin}{head}{joined}{tail}") <= WIDTH:
        return f"{margin}{head}{joined}{tail}"
    if len(inner + joined) <= WIDTH:
        return f"{margin}{head}\n{inner}{joined}\n{margin}{tail}"
    return exploded(indent, head, items, tail)


def exploded(indent: int, head: str, items: Sequence[str], tail: str) -> str:
    """Items between brackets, each in a line of its own; an item may hold lines already."""
    margin, inner = " " * indent, " " * (indent + 4)
    lines = "".join(f"{inner}{item},\n" for item in items)
    return f"{margin}{head}\n{lines}{margin}{tail}"


def tuple_of(items: Sequence[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"
