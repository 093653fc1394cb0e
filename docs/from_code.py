"""The reference, read from the code: each function returns a piece of Markdown."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Sequence
from types import NoneType

import click
from gallery import (  # noqa: F401
    conventions_gallery,
    motions_gallery,
    parametrisations_gallery,
    solids_gallery,
)
from literature import (  # noqa: F401
    bodies_of_literature,
    kinematics_of_literature,
    rotations_of_literature,
    sources,
    wrong_formulas,
)
from schema import rows, schema

import rigidsym
from rigidsym import errors
from rigidsym.commands.cli import commands as cli
from rigidsym.commands.list import inventory
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.models.solids import SHAPES


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", r"\|").replace("\n", " ")


def literal(text: str) -> str:
    return f"`{text}`"


def prose(text: str) -> str:
    """Plain text with indented examples, as Markdown."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(p if p.startswith("    ") else _plain(p) for p in paragraphs)


def _plain(text: str) -> str:
    pieces = re.split(r"(`[^`]+`)", text)
    return "".join(p if p.startswith("`") else re.sub(r"([*_<\[\]])", r"\\\1", p) for p in pieces)


# commands


def commands() -> str:
    context = click.Context(cli)
    found = [cli.get_command(context, name) for name in cli.list_commands(context)]
    return "\n".join(_command(command) for command in found if command)


def _command(command: click.Command) -> str:
    context = click.Context(command, info_name=f"rigidsym {command.name}")
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    options = [p.get_help_record(context) for p in command.get_params(context)]
    rows = [(literal(names), _plain(text)) for names, text in filter(None, options)]
    return "\n".join(
        [
            f"## {command.name}",
            f"```text\n{usage}\n```",
            prose((command.help or "").replace("\b\n", "")),
            "",
            table(("option", "meaning"), rows),
        ]
    )


# rotations, quantities, solids, targets


def conventions() -> str:
    models = [(sequence, EulerAngles(sequence)) for sequence in EULER_SEQUENCES]
    rows = [(literal(sequence), f"R = {model.product}") for sequence, model in models]
    half = len(rows) // 2
    both = zip(rows[:half], rows[half:], strict=True)
    head = ("about the turning axes", "", "about the fixed axes", "")
    return table(head, [(*left, *right) for left, right in both])


def parametrisations() -> str:
    entries = PARAMETRISATIONS.items()
    return table(
        ("name", "rotation"), [(literal(k), f"R = {_plain(e.product)}") for k, e in entries]
    )


def presets() -> str:
    rows = []
    for name, preset in PRESETS.items():
        model = rotation_from(name)
        shown = "A = Rᵀ, " if model.passive else ""
        product = _plain(f"{shown}R = {model.product}")
        rows.append((literal(name), product, _plain(preset.about), _plain(str(preset.source))))
    return table(("name", "rotation", "angles", "source"), rows)


def quantities() -> str:
    parts = []
    for title, found in (
        ("Kinematics", KINEMATICS),
        ("Mass", INERTIA_QUANTITIES),
        ("Energy and momentum", ENERGY_QUANTITIES),
    ):
        rows = [(literal(q.name), q.symbol.text, q.unit or "", q.about) for q in found.values()]
        parts.append(f"## {title}\n\n{table(('name', 'symbol', 'unit', 'meaning'), rows)}")
    return "\n".join(parts)


def solids() -> str:
    rows = [
        (literal(name), ", ".join(literal(length.key) for length in shape.lengths), shape.about)
        for name, shape in SHAPES.items()
    ]
    return table(("shape", "lengths", "position"), rows)


def targets() -> str:
    """As `rigidsym list` describes them, whatever is installed here."""
    lines = [line.strip().partition(" ") for line in inventory().splitlines()]
    about = {name: text.strip() for name, _, text in lines}
    rows = [
        (literal(name), _plain(about[name].removesuffix(f"; {target.missing} is not installed")))
        for name, target in TARGETS.items()
    ]
    return table(("target", "what it writes"), rows)


# derivation files


def derivation_file() -> str:
    found = [(literal(key), kind, _plain(about)) for key, kind, about in rows(schema())]
    return table(("key", "value", "meaning"), found)


# errors


def exceptions() -> str:
    found = [
        value
        for value in vars(errors).values()
        if inspect.isclass(value) and issubclass(value, errors.RigidsymError)
    ]
    rows = [(literal(e.__name__), str(e.exit_code), _plain(inspect.getdoc(e) or "")) for e in found]
    return table(("exception", "exit code", "raised for"), rows)


# Python


def api() -> str:
    return "\n".join(_documented(name) for name in sorted(rigidsym.__all__, key=str.lower))


def _documented(name: str) -> str:
    value = getattr(rigidsym, name)
    if inspect.isclass(value) and issubclass(value, Exception):
        return f"## {name}\n\n{prose(inspect.getdoc(value) or '')}\n"
    if name == "__version__":
        return ""
    if not callable(value):
        return f"## {name}\n\n`rigidsym.{name}`: {type(value).__name__} of {len(value)} names.\n"
    members = _members(value) if inspect.isclass(value) else []
    return "\n".join(
        [
            f"## {name}",
            f"```python\n{name}{_signature(value)}\n```",
            prose(inspect.getdoc(value) or ""),
            "",
            *members,
        ]
    )


def _signature(value: object) -> str:
    """Names and simple defaults; the docstring says what each may be."""
    signature = inspect.signature(value)  # type: ignore[arg-type]
    bare = [_bare(parameter) for parameter in signature.parameters.values()]
    return str(signature.replace(parameters=bare, return_annotation=inspect.Signature.empty))


def _bare(parameter: inspect.Parameter) -> inspect.Parameter:
    is_simple = isinstance(parameter.default, str | int | float | tuple | NoneType)
    default = parameter.default if is_simple else "..."
    has_default = parameter.default is not inspect.Parameter.empty
    return parameter.replace(
        annotation=inspect.Parameter.empty,
        default=default if has_default else inspect.Parameter.empty,
    )


def _members(cls: type) -> list[str]:
    found = []
    for name, member in sorted(vars(cls).items()):
        if name.startswith("_") or not inspect.getdoc(member):
            continue
        if inspect.isfunction(member):
            found.append(f"`.{name}{_signature(member)}`\n: {_indented(inspect.getdoc(member))}\n")
        elif isinstance(member, property):
            found.append(f"`.{name}`\n: {_indented(inspect.getdoc(member))}\n")
    return found


def _indented(text: str | None) -> str:
    return prose(text or "").replace("\n", "\n  ")
