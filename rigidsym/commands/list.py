"""`rigidsym list`: rotations, quantities, targets and shipped derivations."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence

import click

from rigidsym.commands.command import Command, command as make
from rigidsym.formula.unicode_pen import columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities.catalogue import QUANTITIES
from rigidsym.mechanics.quantities.mass import BODY_ALONE
from rigidsym.models.library import ALIASES, PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.models.solids import SHAPES
from rigidsym.system.resources import names, text

_TURNS = 'such as "z(phi) x(theta) [1,1,0](psi) y(pi/4)"; a name such as alpha0 is a constant'


@make("rigidsym list | grep -i quaternion", kind=Command)
def command() -> None:
    """List rotations, solids, quantities, targets and shipped derivations."""
    click.echo(inventory())


def inventory() -> str:
    """The whole list, as text."""
    sections = (
        ("Rotations (upper case: about body axes, lower case: about fixed axes)", _rotations()),
        ("Other parametrisations", _parametrisations()),
        ("Presets", _presets()),
        ("Any number of turns about any axes", [_TURNS]),
        ("Solids (shape in [body])", _solids()),
        ("Quantities", _quantities()),
        ("Targets of the kernels (--target NAME,...)", _targets()),
        ("Shipped derivations (rigidsym run NAME)", _shipped()),
    )
    blocks = ["\n".join([title, *(f"  {line}" for line in lines)]) for title, lines in sections]
    return "\n\n".join(blocks)


def _rotations() -> list[str]:
    models = [(sequence, EulerAngles(sequence)) for sequence in EULER_SEQUENCES]
    return [f"{sequence}  R = {model.product}" for sequence, model in models]


def _parametrisations() -> list[str]:
    short = {name: f" or {alias}" for alias, name in ALIASES.items()}
    entries = PARAMETRISATIONS.items()
    return _table([(name + short.get(name, ""), f"R = {e.product}") for name, e in entries])


def _presets() -> list[str]:
    rows = []
    for name, preset in PRESETS.items():
        model = rotation_from(name)
        shown = "A = Rᵀ, " if model.passive else ""
        rows.append((name, f"{shown}R = {model.product}: {preset.about}"))
        rows.append(("", str(preset.source)))
    return _table(rows)


def _solids() -> list[str]:
    return _table(
        (name, f"{', '.join(length.key for length in shape.lengths)}: {shape.about}")
        for name, shape in SHAPES.items()
    )


def _quantities() -> list[str]:
    rows = [(name, quantity.symbol.text, quantity.about) for name, quantity in QUANTITIES.items()]
    return _table([(BODY_ALONE, "", "all quantities that a body has without a rotation"), *rows])


def _targets() -> list[str]:
    return _table(
        (name, target.about + (f"; {lacking} is not installed" if lacking else ""))
        for name, target in TARGETS.items()
        for lacking in [target.missing]
    )


def _shipped() -> list[str]:
    files = {name: text("derivations", f"{name}.toml") for name in names("derivations", ".toml")}
    return _table((name, tomllib.loads(file).get("title", "")) for name, file in files.items())


def _table(rows: Iterable[Sequence[str]]) -> list[str]:
    """Rows with their columns below each other, by the width that they take on a screen."""
    rows = list(rows)
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    widths[-1] = 0
    padded = (
        [text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)]
        for row in rows
    )
    return ["  ".join(row) for row in padded]
