"""`rigidsym list`: rotations, quantities, targets and shipped derivations."""

from __future__ import annotations

import tomllib

import click

from rigidsym.commands.command import Command, command as make
from rigidsym.formula.unicode_pen import columns
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import quantities
from rigidsym.mechanics.quantities.mass import BODY_ALONE, INERTIA_QUANTITIES
from rigidsym.models.euler_angles import EULER_SEQUENCES, EulerAngles
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.rotation_text import rotation_from
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
    return [f"{name:<20} R = {entry.product}" for name, entry in PARAMETRISATIONS.items()]


def _presets() -> list[str]:
    lines = []
    for name, preset in PRESETS.items():
        model = rotation_from(name)
        shown = "A = Rᵀ, " if model.passive else ""
        lines.append(f"{name:<16} {shown}R = {model.product}: {preset.about}")
        lines.append(f"{'':<16} {preset.source}")
    return lines


def _solids() -> list[str]:
    return [
        f"{name:<16} {', '.join(length.key for length in shape.lengths)}: {shape.about}"
        for name, shape in SHAPES.items()
    ]


def _quantities() -> list[str]:
    return [
        f"{BODY_ALONE:<50} all quantities that a body has without a rotation",
        *(
            f"{quantity.name:<34} {_padded(quantity.symbol.text, 15)} {quantity.about}"
            for table in (quantities(passive=False), INERTIA_QUANTITIES, ENERGY_QUANTITIES)
            for quantity in table.values()
        ),
    ]


def _padded(text: str, width: int) -> str:
    """The text and blanks, by the columns that it takes on a screen."""
    return text + " " * (width - columns(text))


def _targets() -> list[str]:
    return [
        f"{name:<12} {target.about}" + (f"; {lacking} is not installed" if lacking else "")
        for name, target in TARGETS.items()
        for lacking in [target.missing]
    ]


def _shipped() -> list[str]:
    shipped = names("derivations", ".toml")
    titles = [
        tomllib.loads(text("derivations", f"{name}.toml")).get("title", "") for name in shipped
    ]
    return [f"{name:<16} {title}" for name, title in zip(shipped, titles, strict=True)]
