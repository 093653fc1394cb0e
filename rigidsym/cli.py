"""The commands. The only place that writes files.

Results go to standard output, progress and messages to standard error. Heavy imports stand in
the functions that need them, so that `rigidsym --help` imports neither SymPy nor NumPy.
"""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rigidsym import __version__
from rigidsym.errors import RigidsymError, SpecError

if TYPE_CHECKING:
    from rigidsym.pipeline import Product
    from rigidsym.spec import DerivationSpec

_INTERRUPTED = 130
_OUT = click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("out"),
    show_default=True,
    metavar="DIR",
    help="The folder that receives DIR/NAME/.",
)
_PDF = click.option("--pdf", is_flag=True, help="Typeset the note too; needs TeX.")
_JSON = click.option("--json", "as_json", is_flag=True, help="Print the results as JSON.")


def main() -> None:
    """The `rigidsym` command: runs, and turns errors into messages and exit codes."""
    try:
        status = commands.main(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        status = error.exit_code
    except RigidsymError as error:
        click.echo(f"rigidsym: {error}", err=True)
        status = error.exit_code
    except (KeyboardInterrupt, click.Abort):
        click.echo("rigidsym: interrupted", err=True)
        status = _INTERRUPTED
    except BrokenPipeError:
        # The reader of a pipe (`| head`) has had enough; nothing is wrong.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 0
    except OSError as error:
        click.echo(f"rigidsym: {error}", err=True)
        status = 1
    sys.exit(status if isinstance(status, int) else 0)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="rigidsym")
@click.pass_context
def commands(context: click.Context) -> None:
    """Derive the kinematics of a rotation, proved step by step; print kernels and notes."""
    if os.environ.get("NO_COLOR"):
        context.color = False


@commands.command()
@click.argument("sequence")
@click.option("--angles", metavar="A,B,C", help="Names of the angles, in the order of the turns.")
@click.option("--passive", is_flag=True, help="Present the direction cosine matrix A = Rᵀ.")
@_OUT
@_PDF
@_JSON
def derive(
    sequence: str, angles: str | None, passive: bool, out: Path, pdf: bool, as_json: bool
) -> None:
    """Derive one rotation, show it, and write its module and note.

    SEQUENCE is ZXZ or 313 (intrinsic: about the turning axes) or zxz (extrinsic: about the
    fixed axes); `rigidsym list` shows all 24.
    """
    from rigidsym.spec import spec_for

    names = None if angles is None else [name.strip() for name in angles.split(",")]
    _produce([spec_for(sequence, angles=names, passive=passive)], out, pdf=pdf, as_json=as_json)


@commands.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@_OUT
@_PDF
@_JSON
def run(files: tuple[str, ...], out: Path, pdf: bool, as_json: bool) -> None:
    """Run derivation files, given by path or by the name of a shipped one.

    All files are checked before any is run; a fault in one writes nothing.
    """
    _produce(_read_all(files), out, pdf=pdf, as_json=as_json)


@commands.command("list")
def list_() -> None:
    """List rotations, quantities, targets and shipped derivations."""
    from rigidsym.inventory import inventory

    click.echo(inventory())


@commands.command()
@click.argument(
    "paths",
    nargs=-1,
    required=True,
    metavar="PATH...",
    type=click.Path(exists=True, path_type=Path),
)
@click.pass_context
def check(context: click.Context, paths: tuple[Path, ...]) -> None:
    """Compare generated files with a fresh derivation.

    PATH is a generated file or a folder; every NAME.json in it says how its neighbours came
    about. Exit code 1 where a file is missing or differs.
    """
    from rigidsym.checking import findings

    results = list(findings(paths))
    for finding in results:
        click.echo(str(finding))
    if not all(finding.is_fine for finding in results):
        context.exit(1)


def _read_all(files: Iterable[str]) -> list[DerivationSpec]:
    """Read every file; faults of all files are raised together."""
    from rigidsym.spec import read_file

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


def _produce(specs: list[DerivationSpec], out: Path, *, pdf: bool, as_json: bool) -> None:
    """Derive, write, and show what was asked for."""
    singles = [single for spec in specs for single in spec.singles()]
    shown_in_full = len(singles) == 1
    missing: RigidsymError | None = None
    for product in _with_progress(singles):
        written, problem = _write(product, out, pdf=pdf or product.wants_pdf)
        missing = missing or problem
        if as_json:
            click.echo(product.record_text, nl=False)
        elif shown_in_full:
            _show(product, written)
        else:
            click.echo(_summary(product, written))
    if missing:
        raise missing


def _with_progress(singles: list[DerivationSpec]) -> Iterator[Product]:
    """The products, with a bar on standard error where there are several and it is a terminal."""
    from rigidsym.pipeline import product

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


def _write(product: Product, out: Path, *, pdf: bool) -> tuple[list[Path], RigidsymError | None]:
    """Write the files of one product; a missing TeX is reported after all else is written."""
    from rigidsym.writing import write_bytes, write_text

    folder = out / product.name
    written = [write_text(folder / name, text) for name, text in product.files.items()]
    if not pdf:
        return written, None
    from rigidsym.typeset import typeset

    try:
        made = typeset(product.motion.note().latex())
    except RigidsymError as error:
        return written, error
    return [*written, write_bytes(folder / f"{product.name}.pdf", made.pdf)], None


def _show(product: Product, written: list[Path]) -> None:
    from rigidsym.notes.terminal import show

    width = shutil.get_terminal_size((88, 24)).columns
    click.echo(show(product.motion, width=min(width, 120)))
    click.echo("\nWritten: " + "\n         ".join(str(path) for path in written))


def _summary(product: Product, written: list[Path]) -> str:
    proofs = list(product.motion.proofs)
    exact = sum(proof.is_exact for proof in proofs)
    return f"{product.name:<28} {exact} of {len(proofs)} claims proved  {written[0].parent}"
