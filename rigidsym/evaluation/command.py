"""The body of `rigidsym eval`: from texts to an evaluation, with a bar."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from rigidsym.api import derive
from rigidsym.errors import ModelError
from rigidsym.evaluation.evaluate import Evaluated, Evaluation, evaluation
from rigidsym.models.rotation import RotationModel
from rigidsym.progress import Progress, bar
from rigidsym.rotations import rotation_from
from rigidsym.rows.sinks import draft_of


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
    """Evaluate quantities of a rotation, or of a derivation file, for each row of a file."""
    work = evaluation(
        derive(_model(rotation), only=quantities),
        quantities,
        source,
        path,
        columns=None if columns is None else [name.strip() for name in columns.split(",")],
        given=dict(map(_number, given)),
        degrees=degrees,
        threads=threads,
        scheduler=scheduler,
    )
    with bar(source.name) as progress:
        return _run(work, progress)


def _run(work: Evaluation, progress: Progress | None) -> Evaluated:
    try:
        return work.run(progress)
    except KeyboardInterrupt:
        click.echo(f"rigidsym: {draft_of(work.path)} keeps what is done; run it again", err=True)
        raise


def _model(rotation: str) -> RotationModel:
    if not rotation.endswith(".toml"):
        return rotation_from(rotation)
    from rigidsym.spec import read_file

    models = read_file(rotation).models
    if len(models) != 1:
        raise ModelError(f"{rotation} has {len(models)} rotations; expected one")
    return models[0]


def _number(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise click.UsageError(f"--given {text}: expected NAME=NUMBER") from None
