"""`rigidsym list`: rotations, quantities, targets and shipped derivations."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence

import click

from rigidsym.commands.command import command as make
from rigidsym.formula.unicode_pen import columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities.catalogue import QUANTITIES
from rigidsym.mechanics.quantities.mass import BODY_ALONE
from rigidsym.models.library import ALIASES, PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.models.solids import SHAPES
from rigidsym.system.resources import names, text

_TURNS = 'such as "z(phi) x(theta) [1,1,0](psi) y(pi/4)"; a name such as alpha0 is a constant'


@make("list")
def command() -> None:
    """List rotations, solids, quantities, targets and shipped derivations."""
    click.echo(inventory())


def inventory() -> str:
    """The whole list, as text."""
    aliases = {name: f" or {alias}" for alias, name in ALIASES.items()}
    presets = {name: rotation_from(name) for name in PRESETS}
    passive = {name: "A = Rᵀ, " if model.passive else "" for name, model in presets.items()}
    shipped = {name: text("derivations", f"{name}.toml") for name in names("derivations", ".toml")}
    sections: dict[str, list[tuple[str, ...]]] = {
        "Rotations (upper case: about body axes, lower case: about fixed axes)": [
            (sequence, f"R = {EulerAngles(sequence).product}") for sequence in EULER_SEQUENCES
        ],
        "Other parametrisations": [
            (name + aliases.get(name, ""), f"R = {entry.product}")
            for name, entry in PARAMETRISATIONS.items()
        ],
        "Presets": [
            (name, f"{passive[name]}R = {model.product}: {PRESETS[name].about}")
            for name, model in presets.items()
        ],
        "Any number of turns about any axes": [(_TURNS,)],
        "Solids (shape in [body])": [
            (name, f"{', '.join(length.key for length in shape.lengths)}: {shape.about}")
            for name, shape in SHAPES.items()
        ],
        "Quantities": [
            (BODY_ALONE, "", "all quantities that a body has without a rotation"),
            *((name, entry.symbol.text, entry.about) for name, entry in QUANTITIES.items()),
        ],
        "Targets of the kernels (--target NAME,...)": [
            (name, target.about + (f"; {target.missing} is not installed" * bool(target.missing)))
            for name, target in TARGETS.items()
        ],
        "Shipped derivations (rigidsym run NAME)": [
            (name, tomllib.loads(file).get("title", "")) for name, file in shipped.items()
        ],
    }
    return "\n\n".join(f"{title}\n{_table(rows)}" for title, rows in sections.items())


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Rows with their columns below each other, by the width that they take on a screen."""
    widths = [max(map(columns, column)) for column in zip(*rows, strict=True)]
    widths[-1] = 0
    padded = (
        [text + " " * (width - columns(text)) for text, width in zip(row, widths, strict=True)]
        for row in rows
    )
    return "\n".join(f"  {'  '.join(row)}" for row in padded)
