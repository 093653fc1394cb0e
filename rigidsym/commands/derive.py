"""`rigidsym derive`, and what `run` shares with it: derive, print, write, show."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from rigidsym.commands.command import command as make, message, option, with_options
from rigidsym.commands.options import MOST_LINES, PrintingOptions, RotationOptions
from rigidsym.commands.output_folder import CERTIFICATE, printed, with_existing_files, write
from rigidsym.errors import RigidsymError
from rigidsym.motion import Motion
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.record import record
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import PDF, Output, integrated, motion_of
from rigidsym.spec.derivation_spec import DerivationSpec, spec_for
from rigidsym.system.files import write_bytes
from rigidsym.system.processes import counter, in_processes

Made = tuple[Output, bytes | RigidsymError | None]  # with the PDF, or why there is none


@dataclass(frozen=True, kw_only=True)
class DeriveOptions(PrintingOptions, RotationOptions):
    """All options of `derive`."""

    equations: str | None = option(
        "--format",
        type=click.Choice(["latex", "text", "json"]),
        help="Print the equations in this format, and write no files; see --only.",
    )


@make('rigidsym derive "z(yaw) y(pitch) x(roll)" --target numpy,c --pdf')
@click.argument("rotation")
@with_options(DeriveOptions)
def command(rotation: str, options: DeriveOptions) -> None:
    """Derive one rotation, show the result, and write its kernels and note.

    ROTATION is ZXZ or 313 (intrinsic: about the current body axes), zxz (extrinsic: about the
    fixed axes), turns such as "z(phi) x(theta) [1,1,0](psi)", or a name such as quaternion;
    `rigidsym list` shows all of them.
    """
    spec = options.applied_to(spec_for(rotation, **options.of_rotation()))
    if options.equations is None:
        produce([spec], options)
    else:
        click.echo(_equations(motion_of(spec), options.equations))


def produce(specs: Iterable[DerivationSpec], options: PrintingOptions) -> None:
    """Derive, print, write and show each rotation of some specifications."""
    singles = [single for spec in specs for single in integrated(spec).singles()]
    _check_folders(singles)
    missing: list[RigidsymError] = []
    count = 0
    try:
        for output, paper in _outputs([with_existing_files(s, options.out) for s in singles]):
            written = write(output, options.out, force=options.force)
            if isinstance(paper, bytes):
                written.append(write_bytes(written[0].parent / f"{output.name}.pdf", paper))
            elif paper is not None:
                missing.append(paper)
            _report_uncovered(output)
            _show(output, written, options, is_only=len(singles) == 1)
            count += 1
    finally:
        if 0 < count < len(singles):
            message(f"{count} of {len(singles)} derivations are finished and kept in {options.out}")
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


def _outputs(singles: Sequence[DerivationSpec]) -> Iterator[Made]:
    """The output of each rotation, with a bar if there are several and a terminal shows it."""
    found = in_processes(_made, singles)
    if len(singles) == 1 or not sys.stderr.isatty():
        yield from found
        return
    with counter(len(singles)) as begin:
        for single in singles:
            begin(single.name)
            yield next(found)


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
    if output.spec.certificates:
        uncovered = json.loads(output.files[f"{output.name}.{CERTIFICATE}"])["uncovered"]
        if uncovered:
            message(f"{output.name}: the certificate does not cover {', '.join(uncovered)}")


def _show(
    output: Output, written: Sequence[Path], options: PrintingOptions, *, is_only: bool
) -> None:
    if options.quiet:
        click.echo("\n".join(map(str, written)))
    elif options.as_json:
        click.echo(output.record_text, nl=False)
    elif is_only:
        click.echo(_shown(output, full=options.full))
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
