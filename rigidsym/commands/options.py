"""Options that several commands share: dataclasses whose fields are click options."""

# ruff: noqa: RUF009 -- `option` makes a field, as `dataclasses.field` does

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import click

from rigidsym.commands.command import option, unique
from rigidsym.errors import KernelError, QuantityError
from rigidsym.formula.notation import CHOICES, DEFAULT
from rigidsym.kernels.lowering.derivatives import read_requests
from rigidsym.kernels.targets import check_target
from rigidsym.motion import QUANTITIES, offered
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system.resources import overridden_by

MOST_LINES = 150  # that a terminal shows by default
_LEAN: dict[str, str | bool] = {"precision": "double", "arrays": False, "libm": True}


class SpecOptions:
    """Options that choose something of a specification."""

    def applied_to(self, spec: DerivationSpec) -> DerivationSpec:
        """The specification with the choices of the command line."""
        return replace(spec, **self.chosen(spec))

    def chosen(self, spec: DerivationSpec) -> dict[str, Any]:  # noqa: ARG002
        """The fields of the specification with what is chosen here."""
        return {}


@dataclass(frozen=True, kw_only=True)
class TemplateOptions:
    """Where templates are looked for first."""

    templates: Path | None = option(
        "--templates",
        type=click.Path(file_okay=False, path_type=Path),
        metavar="DIR",
        help="Custom template directory; `rigidsym templates DIR` copies the shipped ones.",
    )

    def __post_init__(self) -> None:
        """Use the templates of the directory until the command ends."""
        if self.templates is None:
            return
        if not self.templates.is_dir():
            raise click.UsageError(
                f"--templates {self.templates}: no such folder; `rigidsym templates "
                f"{self.templates}` makes it, with the shipped templates"
            )
        click.get_current_context().with_resource(overridden_by(self.templates))


@dataclass(frozen=True, kw_only=True)
class FolderOptions(TemplateOptions):
    """Where files are written."""

    out: Path = option(
        "--out",
        type=click.Path(file_okay=False, path_type=Path),
        default=Path("out"),
        metavar="DIR",
        help="Write to DIR/NAME/.",
    )
    force: bool = option("--force", help="Overwrite files even if they were edited.")
    quiet: bool = option("--quiet", help="Print only the names of the files written.")


@dataclass(frozen=True, kw_only=True)
class RotationOptions:
    """How the text of a rotation is read."""

    angles: list[str] | None = option(
        "--angles", "--names", metavar="A,B,C", help="Names of the coordinates, in order."
    )
    constants: list[str] | None = option(
        "--constants", metavar="A,B", help="Names in ROTATION that are constants."
    )
    scalar_last: bool = option("--scalar-last", help="Order quaternions as (x, y, z, w).")
    passive: bool = option("--passive", help="Present the direction cosine matrix A = Rᵀ.")

    def of_rotation(self) -> dict[str, Any]:
        """The options that were given, as `spec_for` takes them."""
        given = {f.name: getattr(self, f.name) for f in fields(RotationOptions)}
        return {name: value for name, value in given.items() if value}


def _notation(name: str, about: str) -> Any:
    known = CHOICES[name]
    flag = f"--{name.replace('_', '-')}"
    return option(flag, type=click.Choice(known), help=f"{about}  [default: {known[0]}]")


@dataclass(frozen=True, kw_only=True)
class NotationOptions(SpecOptions):
    """The notation of the note and the terminal; it takes precedence over that of a file."""

    rates: str | None = _notation("rates", "Print rates as φ̇ or dφ/dt.")
    vectors: str | None = _notation("vectors", "Print vectors in bold or with arrows.")
    body: str | None = _notation("body", "Print body components as Ω′ or Ωᴮ.")
    angular_velocity: str | None = _notation(
        "angular_velocity", "Print the angular velocity as Ω or ω."
    )

    def chosen(self, spec: DerivationSpec) -> dict[str, Any]:
        found = super().chosen(spec)
        notation = {name: getattr(self, name) for name in CHOICES if getattr(self, name)}
        if notation:
            found["notation"] = replace(spec.notation or DEFAULT, **notation)
        return found


@dataclass(frozen=True, kw_only=True)
class SelectionOptions(SpecOptions):
    """What is derived."""

    only: tuple[list[str], ...] = option(
        "--only",
        "--quantity",
        help="Derive only these quantities; `rigidsym list` shows the names. May be repeated.",
    )
    conversions: bool = option(
        "--conversions", help="Add conversions to and from quaternions and matrices, and `unwrap`."
    )

    def chosen(self, spec: DerivationSpec) -> dict[str, Any]:
        only = unique(self.only)
        for name in only:
            _check_quantity(name, "--only")
        return {
            **super().chosen(spec),
            "quantities": only or spec.quantities,
            "conversions": spec.conversions or self.conversions,
        }


@dataclass(frozen=True, kw_only=True)
class KernelOptions(SelectionOptions):
    """What functions are printed."""

    derivative: tuple[list[str], ...] = option(
        "--derivative",
        metavar="QUANTITY:VECTOR,...",
        help="Add the Jacobian of a quantity with respect to q, q_dot, ... May be repeated.",
    )

    def chosen(self, spec: DerivationSpec) -> dict[str, Any]:
        return {
            **super().chosen(spec),
            "derivatives": self._derivatives(spec),
        }

    def _derivatives(self, spec: DerivationSpec) -> tuple[str, ...]:
        """Those of the specification, then those of the command line, each once."""
        asked = unique(self.derivative)
        if not asked:
            return spec.derivatives
        for text in asked:
            if ":" not in text:
                raise KernelError(
                    f"--derivative {text}: expected QUANTITY:VECTOR, such as "
                    "angular_velocity_body:q"
                )
        for request in read_requests(asked):
            _check_quantity(request.quantity, "--derivative")
        return tuple(map(str, read_requests([*spec.derivatives, *asked])))


@dataclass(frozen=True, kw_only=True)
class OutputOptions(SpecOptions):
    """What is printed, and what the terminal shows."""

    target: tuple[list[str], ...] = option(
        "--target",
        help="Languages of the kernels; `rigidsym list` shows them. May be repeated.  "
        "[default: numpy]",
    )
    lean: bool = option(
        "--lean",
        help="Print C for firmware: double precision, one orientation per call, <math.h>, a test.",
    )
    style: str | None = option(
        "--style",
        metavar="NAME",
        help="Style of the note: lecture explains, audit shows every identity and function, and "
        "NAME is a template of yours, en/NAME.md.jinja.  [default: lecture]",
    )
    pdf: bool = option("--pdf", help="Also typeset the note; needs TeX.")
    certificates: bool = option(
        "--certificates",
        help="Also write certificates that other programs can check: NAME.cert.json and "
        "NAME.v (Coq).",
    )
    as_json: bool = option("--json", help="Print the results as JSON.")
    full: bool = option("--full", help=f"Show all lines instead of the first {MOST_LINES}.")


@dataclass(frozen=True, kw_only=True)
class PrintingOptions(FolderOptions, NotationOptions, OutputOptions, KernelOptions):
    """The options of `derive` and `run`: what is printed, how, and where it is written."""

    def chosen(self, spec: DerivationSpec) -> dict[str, Any]:
        targets = unique(self.target)
        for target in targets:
            check_target(target)
        lean = {"c": _LEAN} if self.lean else {}
        asked = ("pdf",) * self.pdf
        return {
            **super().chosen(spec),
            "note": tuple(dict.fromkeys((*spec.note, *asked))),
            "kernels": tuple(dict.fromkeys((*(targets or spec.kernels), *lean))),
            "target_options": {**spec.target_options, **lean},
            "style": self.style or spec.style,
            "certificates": spec.certificates or self.certificates,
        }


def _check_quantity(name: str, flag: str) -> None:
    if name not in QUANTITIES:
        raise QuantityError(f"{flag}: no quantity {name!r}\n{offered(name)}")
