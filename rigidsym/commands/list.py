"""`rigidsym list`: rotations, quantities, targets and shipped derivations."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence

import click

from rigidsym.commands.command import command as make
from rigidsym.formula.unicode_pen import columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities import QUANTITIES
from rigidsym.mechanics.quantities.mass import BODY_ALONE
from rigidsym.models.library import ALIASES, PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.models.solids import SHAPES
from rigidsym.system.resources import environment, names, text


@make("list")
def command() -> None:
    """List rotations, solids, quantities, targets and shipped derivations."""
    click.echo(inventory())


def inventory() -> str:
    """The whole list, as text."""
    aliases = {name: f" or {alias}" for alias, name in ALIASES.items()}
    presets = {name: rotation_from(name) for name in PRESETS}
    shipped = {name: text("derivations", f"{name}.toml") for name in names("derivations", ".toml")}
    template = environment().get_template("list/inventory.txt.jinja")
    return template.render(
        table=_table,
        sequences=[(name, f"R = {EulerAngles(name).product}") for name in EULER_SEQUENCES],
        parametrisations=[
            (name + aliases.get(name, ""), f"R = {entry.product}")
            for name, entry in PARAMETRISATIONS.items()
        ],
        presets=[
            (name, f"{'A = Rᵀ, ' * model.passive}R = {model.product}: {PRESETS[name].about}")
            for name, model in presets.items()
        ],
        solids=[
            (name, f"{', '.join(length.key for length in shape.lengths)}: {shape.about}")
            for name, shape in SHAPES.items()
        ],
        all_of_a_body=BODY_ALONE,
        quantities=[(name, entry.symbol.text, entry.about) for name, entry in QUANTITIES.items()],
        targets=TARGETS,
        derivations=[(n, tomllib.loads(file).get("title", "")) for n, file in shipped.items()],
    ).rstrip()


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Rows with their columns below each other, by the width that they take on a screen."""
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    widths[-1] = 0
    padded = (
        [text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)]
        for row in rows
    )
    return "\n".join(f"  {'  '.join(row)}" for row in padded)
