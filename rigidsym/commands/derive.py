"""`rigidsym derive`, and what `run` shares with it: derive, print, write, show."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from rigidsym.commands.command import command as make
from rigidsym.commands.options import (
    MOST_LINES,
    PrintingOptions,
    RotationOptions,
    option,
    with_options,
)
from rigidsym.commands.output_folder import report_other_files, with_existing_files
from rigidsym.errors import RigidsymError
from rigidsym.motion import Motion
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.record import record
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import PDF, Output, integrated, motion_of, output_of
from rigidsym.spec.derivation_spec import DerivationSpec, spec_for
from rigidsym.system.files import write_bytes, write_text
from rigidsym.system.progress import counter


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
    spec = spec_for(rotation, **options.of_rotation())
    if options.equations is None:
        produce([spec], options)
    else:
        click.echo(_equations(motion_of(options.applied_to(spec)), options.equations))


def _equations(motion: Motion, form: str) -> str:
    """The equations of a motion, for a paper or a program."""
    if form == "json":
        return json.dumps(record(motion, {})["quantities"], indent=1, ensure_ascii=False)
    return "\n\n".join(step.latex() if form == "latex" else step.text() for step in motion.steps)


def produce(specs: Sequence[DerivationSpec], options: PrintingOptions) -> None:
    """Derive, print, write and show each rotation of some specifications."""
    asked = [options.applied_to(integrated(spec)) for spec in specs]
    singles = [single for spec in asked for single in spec.singles()]
    _check_folders(singles)
    missing: RigidsymError | None = None
    for output in _outputs([with_existing_files(single, options.out) for single in singles]):
        written, problem = _write(output, options.out)
        missing = missing or problem
        if options.quiet:
            click.echo("\n".join(map(str, written)))
        elif options.as_json:
            click.echo(output.record_text, nl=False)
        elif len(singles) == 1:
            _show(output, written, full=options.full)
        else:
            click.echo(_summary(output, written))
    if missing:
        raise missing


def _check_folders(singles: Iterable[DerivationSpec]) -> None:
    """Refuse two different derivations that would write one folder."""
    first: dict[str, DerivationSpec] = {}
    for single in singles:
        if first.setdefault(single.name, single) != single:
            raise click.UsageError(
                f"two different derivations are named {single.name} and would write one folder; "
                "run them separately with different --out, or rename a file"
            )


def _outputs(singles: Sequence[DerivationSpec]) -> Iterator[Output]:
    """The output of each rotation, with a bar if there are several and a terminal shows it."""
    if len(singles) == 1 or not sys.stderr.isatty():
        yield from map(output_of, singles)
        return
    with counter(len(singles)) as begin:
        for single in singles:
            begin(single.name)
            yield output_of(single)


def _write(output: Output, out: Path) -> tuple[list[Path], RigidsymError | None]:
    """Write the files; a missing TeX is reported after all other files are written."""
    folder = out / output.name
    report_other_files(output, out)
    written = [write_text(folder / name, text) for name, text in output.files.items()]
    if PDF not in output.spec.note:
        return written, None
    try:
        paper = typeset(output.files[f"{output.name}.tex"])
    except RigidsymError as error:
        return written, error
    return [*written, write_bytes(folder / f"{output.name}.pdf", paper.pdf)], None


def _show(output: Output, written: list[Path], *, full: bool) -> None:
    width = min(shutil.get_terminal_size((88, 24)).columns, 120)
    motion = output.motion
    text = show(motion, width=width, notation=motion.notation, conversions=output.conversions)
    lines = text.split("\n")
    left = 0 if full else max(0, len(lines) - MOST_LINES)
    click.echo("\n".join(lines[: len(lines) - left]))
    if left:
        click.echo(f"\n... and {left} more lines: use --full, or read the note; {_proved(output)}")
    click.echo("\nWritten: " + "\n         ".join(str(path) for path in written))


def _summary(output: Output, written: list[Path]) -> str:
    return f"{output.name:<28} {_proved(output)}  {written[0].parent}"


def _proved(output: Output) -> str:
    exact = sum(proof.is_exact for proof in output.proofs)
    return f"{exact} of {len(output.proofs)} claims proved"
