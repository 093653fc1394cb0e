"""From a rotation or a derivation file to one thing alone: a compiled module, or a page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rigidsym.commands.options import as_chosen
from rigidsym.commands.output_folder import say_what_was_there, with_what_is_there
from rigidsym.kernels.targets.c.build import build
from rigidsym.pipeline import PAGE, page_name, product
from rigidsym.spec.derivation_file import DerivationSpec, spec_of
from rigidsym.system.files import write_text


def built(asked: str, out: Path, *, portable: bool = False) -> Iterator[Path]:
    """The module NAME_c.py of a file NAME.c, or of each rotation; its files go to out/NAME/.

    What is written stays where the compiler is missing or stops; see `c_build.build`.
    """
    source = Path(asked)
    if source.suffix == ".c":
        yield build(source, portable=portable)
        return
    for single in spec_of(asked).singles():
        folder = _written(replace(single, kernels=("c",)), out)
        yield build(folder / f"{single.name}.c", portable=portable)


def paged(asked: str, out: Path) -> Iterator[Path]:
    """The page of each rotation of what was asked for, in out/NAME/ beside its record."""
    for single in as_chosen(spec_of(asked)).singles():
        folder = _written(replace(single, kernels=(), note=(PAGE,)), out)
        yield folder / page_name(single.name)


def _written(spec: DerivationSpec, out: Path) -> Path:
    """The folder of a rotation, once its files are written."""
    made = product(with_what_is_there(spec, out))
    say_what_was_there(made, out)
    for name, text in made.files.items():
        write_text(out / made.name / name, text)
    return out / made.name
