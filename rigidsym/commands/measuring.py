"""Errors of the functions of a derivation, measured on request, for `derive`, `run` and `build`."""

from __future__ import annotations

from dataclasses import replace

import click

from rigidsym.errors import RigidsymError
from rigidsym.kernels.accuracy.measure import measure
from rigidsym.pipeline import motion_of
from rigidsym.spec.derivation_file import DerivationSpec
from rigidsym.system.progress import bar


def measured(spec: DerivationSpec) -> tuple[DerivationSpec, RigidsymError | None]:
    """The specification with what was measured here and now, and the first target's failing.

    What a target lacks is said at once; its functions are written without.
    """
    missing: list[RigidsymError] = []

    def is_missing(target: str, error: RigidsymError) -> None:
        click.echo(f"rigidsym: {target} is not measured: {error}", err=True)
        missing.append(error)

    with bar(f"measuring {spec.name}") as report:
        found = measure(
            motion_of(spec),
            spec.kernels,
            derivatives=spec.derivatives,
            conversions=spec.conversions,
            report=report,
            missing=is_missing,
        )
    return replace(spec, measured=found), missing[0] if missing else None
