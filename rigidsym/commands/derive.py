"""What `derive` and `run` do: read, derive, write, show."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import click

from rigidsym.commands.options import as_chosen
from rigidsym.commands.output_folder import say_what_was_there, with_what_is_there
from rigidsym.errors import RigidsymError, SpecError
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import PDF, Product, product
from rigidsym.spec.derivation_file import DerivationSpec, read_file
from rigidsym.system.files import write_bytes, write_text


def read_all(files: Iterable[str]) -> list[DerivationSpec]:
    """Read every file; faults of all files are raised together."""
    specs: list[DerivationSpec] = []
    wrong: list[SpecError] = []
    for file in files:
        try:
            specs.append(read_file(file))
        except SpecError as error:
            wrong.append(error)
    if wrong:
        *others, last = wrong
        for other in others:
            click.echo(f"rigidsym: {other}", err=True)
        raise last
    return specs


def produce(specs: list[DerivationSpec], out: Path, *, pdf: bool, as_json: bool) -> None:
    """Derive, write, and show what was asked for; `pdf` asks for it where a file does not."""
    chosen = [_with_pdf(spec) if pdf else spec for spec in map(as_chosen, specs)]
    singles = [single for spec in chosen for single in spec.singles()]
    _check_folders(singles)
    shown_in_full = len(singles) == 1
    missing: RigidsymError | None = None
    singles = [with_what_is_there(single, out) for single in singles]
    for made in _with_progress(singles):
        written, problem = _write(made, out)
        missing = missing or problem
        if as_json:
            click.echo(made.record_text, nl=False)
        elif shown_in_full:
            _show(made, written)
        else:
            click.echo(_summary(made, written))
    if missing:
        raise missing


def _check_folders(singles: Iterable[DerivationSpec]) -> None:
    """Two derivations of one run do not write one folder."""
    first: dict[str, DerivationSpec] = {}
    for single in singles:
        if first.setdefault(single.name, single) != single:
            raise click.UsageError(
                f"two different derivations are named {single.name} and would write one folder; "
                "run them apart, with an --out of their own, or rename a file"
            )


def _with_pdf(spec: DerivationSpec) -> DerivationSpec:
    return replace(spec, note=tuple(dict.fromkeys((*spec.note, PDF))))


def _with_progress(singles: list[DerivationSpec]) -> Iterator[Product]:
    """The products, with a bar on standard error where there are several and it is a terminal."""
    if len(singles) == 1 or not sys.stderr.isatty():
        yield from map(product, singles)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description:<28}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=len(singles))
        for single in singles:
            progress.update(task, description=single.name)
            yield product(single)
            progress.advance(task)


def _write(made: Product, out: Path) -> tuple[list[Path], RigidsymError | None]:
    """Write the files of one product; a missing TeX is reported after all else is written."""
    folder = out / made.name
    say_what_was_there(made, out)
    written = [write_text(folder / name, text) for name, text in made.files.items()]
    if not made.wants_pdf:
        return written, None
    from rigidsym.notes.formats.pdf import typeset  # which few runs need

    try:
        paper = typeset(made.files[f"{made.name}.tex"])
    except RigidsymError as error:
        return written, error
    return [*written, write_bytes(folder / f"{made.name}.pdf", paper.pdf)], None


def _show(made: Product, written: list[Path]) -> None:
    width = shutil.get_terminal_size((88, 24)).columns
    motion, conversions = made.motion, made.conversions
    click.echo(show(motion, width=min(width, 120), manner=motion.manner, conversions=conversions))
    click.echo("\nWritten: " + "\n         ".join(str(path) for path in written))


def _summary(made: Product, written: list[Path]) -> str:
    exact = sum(proof.is_exact for proof in made.proofs)
    return f"{made.name:<28} {exact} of {len(made.proofs)} claims proved  {written[0].parent}"
