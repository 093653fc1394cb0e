"""What the options that several commands share choose."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rigidsym.commands.command import Options
from rigidsym.formula.notation import CHOICES, DEFAULT
from rigidsym.kernels.lowering.derivatives import read_requests
from rigidsym.spec.derivation_spec import DerivationSpec

MOST_LINES = 150  # that a terminal shows without --full


def of_rotation(options: Options) -> dict[str, Any]:
    """The options of ROTATION that were given, as `spec_for` takes them."""
    keys = ("angles", "constants", "scalar_last", "passive")
    return {key: options[key] for key in keys if options[key]}


def applied(options: Options, spec: DerivationSpec) -> DerivationSpec:
    """The specification with the choices of the command line; those left open stay its own."""
    chosen = {key: value for key, value in options.items() if value}
    requests = read_requests([*spec.derivatives, *chosen.get("derivative", ())])
    notation = {key: chosen[key] for key in CHOICES if key in chosen}
    kernels = chosen.get("target", spec.kernels)
    target_options = spec.target_options
    if "lean" in chosen:
        kernels, target_options = (*kernels, "c"), {**target_options, "c": {"lean": "double"}}
    note = (*spec.note, "pdf") if "pdf" in chosen else spec.note
    return replace(
        spec,
        quantities=tuple(dict.fromkeys(chosen.get("only", spec.quantities))),
        kernels=tuple(dict.fromkeys(kernels)),
        target_options=target_options,
        note=tuple(dict.fromkeys(note)),
        style=chosen.get("style", spec.style),
        conversions=spec.conversions or "conversions" in chosen,
        derivatives=tuple(map(str, requests)),
        certificates=spec.certificates or "certificates" in chosen,
        notation=replace(spec.notation or DEFAULT, **notation) if notation else spec.notation,
    )
