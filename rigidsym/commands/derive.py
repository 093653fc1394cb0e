"""`rigidsym derive`, and what `run` and `page` share with it: derive, print, write, show."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import click

from rigidsym.commands.command import Options, command as make, message, of_rotation
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.errors import RigidsymError
from rigidsym.formula.notation import CHOICES, DEFAULT
from rigidsym.kernels.lowering.derivatives import read_requests
from rigidsym.mechanics.derivation import remark
from rigidsym.notes.formats.record import record
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import PDF, integrated, motion_of
from rigidsym.spec.derivation_spec import DerivationSpec, spec_for
from rigidsym.system.files import write_bytes
from rigidsym.system.processes import in_processes
from rigidsym.system.records import NamedTuple
from rigidsym.system.resources import names


@make("derive", **CHOICES)
def command(rotation: str, **options: Any) -> None:
    """Derive one rotation, show the result, and write its kernels and note."""
    if rotation.endswith(".toml") or rotation in names("derivations", ".toml"):
        raise click.UsageError(f"{rotation} is a derivation file; use `rigidsym run {rotation}`")
    spec = applied(options, spec_for(rotation, **of_rotation(options)))
    if options["format"] is None:
        produce([spec], options)
        return
    motion = motion_of(spec)
    if options["format"] == "json":
        click.echo(json.dumps(record(motion, {})["quantities"], indent=1, ensure_ascii=False))
    else:
        one = motion.latex if options["format"] == "latex" else motion.text
        click.echo("\n\n".join(one(step.quantity.name) for step in motion.steps))


def applied(options: Options, spec: DerivationSpec) -> DerivationSpec:
    """The specification with the choices of the command line; those left open stay its own."""
    chosen = {key: value for key, value in options.items() if value}
    own = ("style", "conversions", "certificates")
    changes: dict[str, Any] = {key: chosen[key] for key in own if key in chosen}
    if notation := {key: chosen[key] for key in CHOICES if key in chosen}:
        changes["notation"] = replace(spec.notation or DEFAULT, **notation)
    kernels, note = chosen.get("target", spec.kernels), spec.note
    if "lean" in chosen:
        kernels = (*kernels, "c")
        changes["target_options"] = {**spec.target_options, "c": {"lean": "double"}}
    if "pdf" in chosen:
        note = (*note, PDF)
    return replace(
        spec,
        quantities=tuple(dict.fromkeys(chosen.get("only", spec.quantities))),
        kernels=tuple(dict.fromkeys(kernels)),
        note=tuple(dict.fromkeys(note)),
        derivatives=tuple(
            map(str, read_requests([*spec.derivatives, *chosen.get("derivative", ())]))
        ),
        **changes,
    )


def produce(specs: Iterable[DerivationSpec], options: Options) -> None:
    """Derive, print, write and show each rotation of some specifications."""
    out = options["out"]
    singles: dict[str, DerivationSpec] = {}
    for single in (single for spec in specs for single in integrated(spec).singles()):
        if singles.setdefault(single.name, single) != single:
            raise click.UsageError(
                f"two different derivations are named {single.name} and would write one folder; "
                "run them separately with different --out, or rename a file"
            )
    wanted = [with_existing_files(single, out) for single in singles.values()]
    is_shown = len(wanted) == 1 and not (options["quiet"] or options["json"])
    width = min(shutil.get_terminal_size((88, 24)).columns, 120) if is_shown else 0
    missing: list[RigidsymError] = []
    # to wait for the first derivation would take longer than to import the same beside it
    made = in_processes(partial(_made, width=width), wanted, first=0)
    for single, (files, warning, shown, paper) in zip(wanted, made, strict=True):
        written = write(single, files, out, force=options["force"])
        if isinstance(paper, bytes):
            written.append(write_bytes(written[0].parent / f"{single.name}.pdf", paper))
        elif paper is not None:
            missing.append(paper)
        if warning:
            message(warning)
        if options["quiet"]:
            click.echo("\n".join(map(str, written)))
        elif options["json"]:
            click.echo(files[f"{single.name}.json"], nl=False)
        elif is_shown:
            click.echo(f"{shown}\n\nWritten: " + "\n         ".join(map(str, written)))
        else:
            click.echo(f"{shown}  {written[0].parent}")
    if missing:
        raise missing[0]


class _Printed(NamedTuple):
    """What is printed of a rotation. A copy of this process hands over no derivation."""

    files: Mapping[str, str]
    warning: str  # or nothing
    shown: str  # on standard output: the derivation, or one line of it
    paper: bytes | RigidsymError | None  # the PDF, or why there is none


def _made(single: DerivationSpec, *, width: int) -> _Printed:
    """The texts of a rotation; what is shown is the derivation if the screen has a width for it."""
    output = printed(single)
    steps, proofs = ", ".join(output.uncovered), output.proofs
    paper: bytes | RigidsymError | None = None
    count = f"{sum(proof.is_exact for proof in proofs)} of {len(proofs)} claims proved"
    shown = f"{output.name:<28} {count}"
    if width:
        motion, conversions = output.motion, output.conversions
        shown = show(motion, width=width, notation=motion.notation, conversions=conversions)
    if PDF in single.note:
        from rigidsym.notes.formats.pdf import typeset

        try:
            paper = typeset(output.files[f"{output.name}.tex"]).pdf
        except RigidsymError as error:  # which is reported at the end
            paper = error
    warning = steps and remark("certificate_does_not_cover", name=output.name, steps=steps)
    return _Printed(output.files, warning, shown, paper)
