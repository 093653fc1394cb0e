"""Options that several commands share, each declared once, and what they choose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import JSON, Decorator, Options, flag, names
from rigidsym.formula.notation import CHOICES, DEFAULT
from rigidsym.kernels.lowering.derivatives import read_requests
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.resources import overridden_by

MOST_LINES = 150  # that a terminal shows by default


def _use_templates(context: click.Context, _: object, folder: Path | None) -> None:
    """Use the templates of the directory until the command ends."""
    if folder is not None:
        context.with_resource(overridden_by(folder))


def _notation(name: str, about: str) -> Decorator:
    choices = CHOICES[name]
    about += f"  [default: {choices[0]}]"
    return click.option(f"--{name.replace('_', '-')}", type=click.Choice(choices), help=about)


TEMPLATES = click.option(
    "--templates",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    callback=_use_templates,
    expose_value=False,
    metavar="DIR",
    help="Custom template directory; `rigidsym templates DIR` copies the shipped ones.",
)
OUT = click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("out"),
    show_default=True,
    metavar="DIR",
    help="Write to DIR/NAME/.",
)
QUIET = flag("--quiet", help="Print only the names of the files written.")
FORCE = flag("--force", help="Overwrite files even if they were edited.")
FOLDER = (TEMPLATES, OUT, FORCE, QUIET)
ROTATION = (  # how the text of a rotation is read
    names("--angles", metavar="A,B,C", help="Names of the coordinates, in order."),
    names("--constants", metavar="A,B", help="Names in ROTATION that are constants."),
    flag("--scalar-last", help="Order quaternions as (x, y, z, w)."),
    flag("--passive", help="Present the direction cosine matrix A = Rᵀ."),
)
NOTATION = (  # of the note and the terminal; it takes precedence over that of a file
    _notation("rates", "Print rates as φ̇ or dφ/dt."),
    _notation("vectors", "Print vectors in bold or with arrows."),
    _notation("body", "Print body components as Ω′ or Ωᴮ."),
    _notation("angular_velocity", "Print the angular velocity as Ω or ω."),
)
SELECTION = (
    names(
        "--only",
        help="Derive only these quantities; `rigidsym list` shows the names. May be repeated.",
    ),
    flag(
        "--conversions", help="Add conversions to and from quaternions and matrices, and `unwrap`."
    ),
)
PRINTING = (
    *FOLDER,
    *NOTATION,
    names(
        "--target",
        help="Languages of the kernels; `rigidsym list` shows them. May be repeated.  "
        "[default: numpy]",
    ),
    flag(
        "--lean",
        help="Print C for firmware: one plain function a quantity, double precision, <math.h>.",
    ),
    click.option(
        "--style",
        metavar="NAME",
        help="Style of the note: lecture explains, audit shows every identity and function, and "
        "NAME is a template of yours, en/NAME.md.jinja.  [default: lecture]",
    ),
    flag("--pdf", help="Also typeset the note; needs TeX."),
    flag(
        "--certificates",
        help="Also write NAME.v, theorems about the results that Coq checks.",
    ),
    JSON,
    flag("--full", help=f"Show all lines instead of the first {MOST_LINES}."),
    *SELECTION,
    names(
        "--derivative",
        metavar="QUANTITY:VECTOR,...",
        help="Add the Jacobian of a quantity with respect to q, q_dot, ... May be repeated.",
    ),
)


def of_rotation(options: Options) -> dict[str, Any]:
    """The options of ROTATION that were given, as `spec_for` takes them."""
    keys = ("angles", "constants", "scalar_last", "passive")
    return {key: options[key] for key in keys if options[key]}


def applied(options: Options, spec: DerivationSpec) -> DerivationSpec:
    """The specification with the choices of the command line; those left open stay its own."""
    chosen = {key: value for key, value in options.items() if value}
    requests = read_requests([*spec.derivatives, *chosen.get("derivative", ())])
    notation = {key: chosen[key] for key in CHOICES if key in chosen}
    kernels = chosen.get("target", spec.kernels)
    target_options = spec.target_options
    if "lean" in chosen:
        kernels, target_options = (*kernels, "c"), {**target_options, "c": {"lean": "double"}}
    note = (*spec.note, "pdf") if "pdf" in chosen else spec.note
    return replace(
        spec,
        quantities=tuple(dict.fromkeys(chosen.get("only", spec.quantities))),
        kernels=tuple(dict.fromkeys(kernels)),
        target_options=target_options,
        note=tuple(dict.fromkeys(note)),
        style=chosen.get("style", spec.style),
        conversions=spec.conversions or "conversions" in chosen,
        derivatives=tuple(map(str, requests)),
        certificates=spec.certificates or "certificates" in chosen,
        notation=replace(spec.notation or DEFAULT, **notation) if notation else spec.notation,
    )
