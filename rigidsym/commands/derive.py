"""`rigidsym derive`, and what `run` and `page` share with it: derive, print, write, show."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
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
from rigidsym.pipeline import PDF, Output, integrated, motion_of
from rigidsym.spec.derivation_spec import DerivationSpec, spec_for
from rigidsym.system.files import write_bytes
from rigidsym.system.processes import in_processes
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
    missing: list[RigidsymError] = []
    for output, paper in in_processes(_made, wanted):
        written = write(output, out, force=options["force"])
        if isinstance(paper, bytes):
            written.append(write_bytes(written[0].parent / f"{output.name}.pdf", paper))
        elif paper is not None:
            missing.append(paper)
        _show(output, written, options, is_only=len(wanted) == 1)
    if missing:
        raise missing[0]


def _made(single: DerivationSpec) -> tuple[Output, bytes | RigidsymError | None]:
    """The output of a rotation, and its PDF or why there is none, which is reported at the end."""
    output = printed(single)
    if PDF not in output.spec.note:
        return output, None
    from rigidsym.notes.formats.pdf import typeset

    try:
        return output, typeset(output.files[f"{output.name}.tex"]).pdf
    except RigidsymError as error:
        return output, error


def _show(output: Output, written: Sequence[Path], options: Options, *, is_only: bool) -> None:
    """The files, the record, the derivation or one line of it on standard output."""
    if output.uncovered:
        steps = ", ".join(output.uncovered)
        message(remark("certificate_does_not_cover", name=output.name, steps=steps))
    if options["quiet"]:
        click.echo("\n".join(map(str, written)))
    elif options["json"]:
        click.echo(output.record_text, nl=False)
    elif is_only:
        width = min(shutil.get_terminal_size((88, 24)).columns, 120)
        motion, conversions = output.motion, output.conversions
        click.echo(show(motion, width=width, notation=motion.notation, conversions=conversions))
        click.echo("\nWritten: " + "\n         ".join(map(str, written)))
    else:
        proved = sum(proof.is_exact for proof in output.proofs)
        claims = f"{proved} of {len(output.proofs)} claims proved"
        click.echo(f"{output.name:<28} {claims}  {written[0].parent}")
