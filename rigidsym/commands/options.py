"""Options that several commands share, and what they change in a specification."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from rigidsym.spec.derivation_file import DerivationSpec


class OnceCommand(click.Command):
    """A command that refuses an option given twice of which only the last would count."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        _, _, given = self.make_parser(context).parse_args(list(args))
        for parameter in given:
            is_many = getattr(parameter, "multiple", False) or getattr(parameter, "is_flag", False)
            if not is_many and given.count(parameter) > 1:
                raise click.UsageError(f"{parameter.opts[0]} is given twice", context)
        return super().parse_args(context, args)


OUT = click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("out"),
    show_default=True,
    metavar="DIR",
    help="The folder that receives DIR/NAME/.",
)
PDF = click.option("--pdf", is_flag=True, help="Typeset the note too; needs TeX.")
JSON = click.option("--json", "as_json", is_flag=True, help="Print the results as JSON.")


def _use_templates(context: click.Context, _: click.Parameter, own: Path | None) -> None:
    """Let the templates of a folder stand in for the shipped ones until the command is done."""
    from rigidsym.system.resources import overridden_by

    if own is not None:
        context.with_resource(overridden_by(own))


TEMPLATES = click.option(
    "--templates",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    metavar="DIR",
    expose_value=False,
    callback=_use_templates,
    help="Templates of your own; `rigidsym templates DIR` copies the shipped ones.",
)


_NOTATION = {  # written out here, so that --help loads nothing; a test compares
    "rates": ("dot", "fraction"),
    "vectors": ("bold", "arrow"),
    "body": ("prime", "superscript"),
    "angular_velocity": ("Omega", "omega"),
}


def _keep_choice(context: click.Context, option: click.Parameter, value: str | None) -> None:
    if value is not None:
        context.meta.setdefault(__name__, {})[option.name] = value


def in_notation(command: Callable[..., None]) -> Callable[..., None]:
    """Options for the notation of the note and the terminal; they go before those of a file."""
    for name, known in reversed(_NOTATION.items()):
        command = click.option(
            f"--{name.replace('_', '-')}",
            type=click.Choice(known),
            expose_value=False,
            callback=_keep_choice,
            help=f"Notation: {known[0]}, where nothing is said.",
        )(command)
    return click.option(
        "--frames",
        metavar="SPACE,BODY",
        expose_value=False,
        callback=_keep_frames,
        help="Notation: names of the two frames, such as inertial,spacecraft.",
    )(command)


def _keep_frames(context: click.Context, _: click.Parameter, names: str | None) -> None:
    if names is not None:
        context.meta.setdefault(__name__, {})["frames"] = tuple(names_of(names))


def _keep_conversions(context: click.Context, _: click.Parameter, is_wanted: bool) -> None:
    context.meta[_CONVERSIONS] = is_wanted


_CONVERSIONS = f"{__name__}.conversions"
WITH_CONVERSIONS = click.option(
    "--conversions",
    is_flag=True,
    expose_value=False,
    callback=_keep_conversions,
    help="Functions to and from the unit quaternion and the matrix, and unwrap.",
)


def _keep_derivatives(context: click.Context, _: click.Parameter, texts: tuple[str, ...]) -> None:
    context.meta[_DERIVATIVES] = texts


_DERIVATIVES = f"{__name__}.derivatives"
WITH_DERIVATIVES = click.option(
    "--derivative",
    multiple=True,
    metavar="QUANTITY:VECTOR",
    expose_value=False,
    callback=_keep_derivatives,
    help="The Jacobian of a quantity by q, q_dot, ...; QUANTITY:VECTOR:jvp or :vjp for a product.",
)


def _keep_targets(context: click.Context, _: click.Parameter, targets: tuple[str, ...]) -> None:
    if targets:
        from rigidsym.kernels.targets import check_target

        chosen = list(dict.fromkeys(names_of(",".join(targets))))
        context.meta[_TARGETS] = chosen
        for target in chosen:
            check_target(target)


_TARGETS = f"{__name__}.targets"
FOR_TARGETS = click.option(
    "--target",
    multiple=True,
    metavar="A,B",
    expose_value=False,
    callback=_keep_targets,
    help="Languages of the functions, numpy where nothing is said; `rigidsym list` has them. May "
    "be repeated.",
)


_OF_PRODUCTION = (
    WITH_CONVERSIONS,
    WITH_DERIVATIVES,
    FOR_TARGETS,
    in_notation,
    TEMPLATES,
    OUT,
    PDF,
    JSON,
)


def of_production(command: Callable[..., None]) -> Callable[..., None]:
    """The options of `derive` and `run`: what is printed, how, and where it goes."""
    for option in reversed(_OF_PRODUCTION):
        command = option(command)
    return command


def as_chosen(spec: DerivationSpec) -> DerivationSpec:
    """The specification with the choices of the command line in place of its own."""
    kept = click.get_current_context().meta
    chosen, converts = kept.get(__name__, {}), kept.get(_CONVERSIONS, False)
    targets = kept.get(_TARGETS)
    return replace(
        spec,
        manner=replace(spec.manner, **chosen),
        conversions=spec.conversions or converts,
        kernels=spec.kernels if targets is None else tuple(targets),
        derivatives=_derivatives(spec, kept.get(_DERIVATIVES, ())),
    )


def _derivatives(spec: DerivationSpec, texts: Iterable[str]) -> tuple[str, ...]:
    """Those of the specification, then those of the command line, each once."""
    from rigidsym.errors import QuantityError
    from rigidsym.kernels.lowering.derivatives import read_requests
    from rigidsym.spec.derivation_file import QUANTITIES
    from rigidsym.text.names import offer

    for request in read_requests(texts := tuple(texts)):
        if request.quantity not in QUANTITIES:
            near = offer(request.quantity, QUANTITIES)
            raise QuantityError(f"--derivative: no quantity {request.quantity!r}; {near}")
    return tuple(map(str, read_requests([*spec.derivatives, *texts])))


def names_of(text: str) -> list[str]:
    return [name.strip() for name in text.split(",")]
