"""`rigidsym derive`, and what `run` shares with it: derive, print, write, show."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import Options, command as make, message
from rigidsym.commands.options import (
    MOST_LINES,
    PRINTING,
    ROTATION,
    applied,
    of_rotation,
)
from rigidsym.commands.output_folder import printed, with_existing_files, write
from rigidsym.errors import RigidsymError
from rigidsym.motion import Motion
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.record import record
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import PDF, Output, integrated, motion_of
from rigidsym.spec.derivation_spec import DerivationSpec, spec_for
from rigidsym.system.files import write_bytes
from rigidsym.system.processes import in_processes

Made = tuple[Output, bytes | RigidsymError | None]  # with the PDF, or why there is none


@make(
    'rigidsym derive "z(yaw) y(pitch) x(roll)" --target numpy,c --pdf',
    *PRINTING,
    *ROTATION,
    click.option(
        "--format",
        "equations",
        type=click.Choice(["latex", "text", "json"]),
        help="Print the equations in this format, and write no files; see --only.",
    ),
)
@click.argument("rotation")
def command(rotation: str, equations: str | None, **options: Any) -> None:
    """Derive one rotation, show the result, and write its kernels and note.

    ROTATION is ZXZ or 313 (intrinsic: about the current body axes), zxz (extrinsic: about the
    fixed axes), turns such as "z(phi) x(theta) [1,1,0](psi)", or a name such as quaternion;
    `rigidsym list` shows all of them.
    """
    spec = applied(options, spec_for(rotation, **of_rotation(options)))
    if equations is None:
        produce([spec], options)
    else:
        click.echo(_equations(motion_of(spec), equations))


def produce(specs: Iterable[DerivationSpec], options: Options) -> None:
    """Derive, print, write and show each rotation of some specifications."""
    singles = [single for spec in specs for single in integrated(spec).singles()]
    _check_folders(singles)
    wanted = [with_existing_files(single, options["out"]) for single in singles]
    missing: list[RigidsymError] = []
    count = 0
    try:
        for output, paper in in_processes(_made, wanted):
            written = write(output, options["out"], force=options["force"])
            if isinstance(paper, bytes):
                written.append(write_bytes(written[0].parent / f"{output.name}.pdf", paper))
            elif paper is not None:
                missing.append(paper)
            _report_uncovered(output)
            _show(output, written, options, is_only=len(singles) == 1)
            count += 1
    finally:
        if 0 < count < len(singles):
            finished = f"{count} of {len(singles)} derivations are finished"
            message(f"{finished} and kept in {options['out']}")
    if missing:
        raise missing[0]


def _equations(motion: Motion, form: str) -> str:
    """The equations of a motion, for a paper or a program."""
    if form == "json":
        return json.dumps(record(motion, {})["quantities"], indent=1, ensure_ascii=False)
    return "\n\n".join(step.latex() if form == "latex" else step.text() for step in motion.steps)


def _check_folders(singles: Iterable[DerivationSpec]) -> None:
    """Refuse two different derivations that would write one folder."""
    first: dict[str, DerivationSpec] = {}
    for single in singles:
        if first.setdefault(single.name, single) != single:
            raise click.UsageError(
                f"two different derivations are named {single.name} and would write one folder; "
                "run them separately with different --out, or rename a file"
            )


def _made(single: DerivationSpec) -> Made:
    """The output of a rotation; a missing TeX is reported after all other files are written."""
    output = printed(single)
    if PDF not in output.spec.note:
        return output, None
    try:
        return output, typeset(output.files[f"{output.name}.tex"]).pdf
    except RigidsymError as error:
        return output, error


def _report_uncovered(output: Output) -> None:
    """A message on standard error if the certificate says nothing of some quantities."""
    if output.uncovered:
        message(f"{output.name}: the certificate does not cover {', '.join(output.uncovered)}")


def _show(output: Output, written: Sequence[Path], options: Options, *, is_only: bool) -> None:
    if options["quiet"]:
        click.echo("\n".join(map(str, written)))
    elif options["as_json"]:
        click.echo(output.record_text, nl=False)
    elif is_only:
        click.echo(_shown(output, full=options["full"]))
        click.echo("\nWritten: " + "\n         ".join(map(str, written)))
    else:
        click.echo(f"{output.name:<28} {_proved(output)}  {written[0].parent}")


def _shown(output: Output, *, full: bool) -> str:
    """The derivation for a terminal; its first lines unless all are asked for."""
    width = min(shutil.get_terminal_size((88, 24)).columns, 120)
    motion = output.motion
    text = show(motion, width=width, notation=motion.notation, conversions=output.conversions)
    lines = text.split("\n")
    if full or len(lines) <= MOST_LINES:
        return text
    left = f"... and {len(lines) - MOST_LINES} more lines: use --full, or read the note"
    return "\n".join([*lines[:MOST_LINES], "", f"{left}; {_proved(output)}"])


def _proved(output: Output) -> str:
    exact = sum(proof.is_exact for proof in output.proofs)
    return f"{exact} of {len(output.proofs)} claims proved"
