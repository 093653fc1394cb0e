"""The body of `rigidsym eval`: from texts to an evaluation, with a bar."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from rigidsym.data.writers import draft_of
from rigidsym.errors import ModelError
from rigidsym.models.body import RigidBody
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import Motion, derive
from rigidsym.system.progress import Progress, bar
from rigidsym.tools.evaluate.evaluate import Evaluated, Evaluation, evaluation


def evaluated(
    rotation: str,
    source: Path,
    path: Path,
    *,
    quantities: Sequence[str],
    columns: str | None,
    given: Sequence[str],
    degrees: bool,
    threads: int,
    scheduler: str | None,
) -> Evaluated:
    """Evaluate quantities of a rotation, or of a derivation file, for each row of a file.

    The numbers of the file's body are known; `given` goes before them.
    """
    model, body = _subject(rotation)
    motion = derive(model, only=quantities, body=body)
    work = evaluation(
        motion,
        quantities,
        source,
        path,
        columns=None if columns is None else [name.strip() for name in columns.split(",")],
        given=_known(motion, quantities) | dict(map(_number, given)),
        degrees=degrees,
        threads=threads,
        scheduler=scheduler,
    )
    if scheduler is not None:
        click.echo(f"rigidsym: connecting to {scheduler}", err=True)
    with bar(source.name) as progress:
        return _run(work, progress)


def _run(work: Evaluation, progress: Progress | None) -> Evaluated:
    try:
        return work.run(progress)
    except (KeyboardInterrupt, OSError):
        if (draft := draft_of(work.path)).exists():
            click.echo(f"rigidsym: {draft} keeps what is done; run it again to go on", err=True)
        raise


def _subject(rotation: str) -> tuple[RotationModel, RigidBody | None]:
    """The rotation, and the body that turns so where a derivation file has one."""
    from rigidsym.spec.derivation_file import spec_of

    spec = spec_of(rotation)
    if len(spec.models) != 1:
        raise ModelError(f"{rotation} has {len(spec.models)} rotations; expected one")
    return spec.models[0], spec.body


def _known(motion: Motion, quantities: Sequence[str]) -> dict[str, float]:
    """The parameters of the body that have a value, where a quantity takes them."""
    taken = {name for quantity in quantities for name in motion.step(quantity).quantity.inputs}
    if motion.body is None or "parameters" not in taken:
        return {}
    return {p.symbol.name: p.value for p in motion.body.parameters if p.value is not None}


def _number(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise click.UsageError(f"--given {text}: expected NAME=NUMBER") from None
