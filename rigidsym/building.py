"""From a rotation, a derivation file or C that is there, to Python modules that are compiled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rigidsym.kernels.targets.c_build import build
from rigidsym.pipeline import product
from rigidsym.spec import DerivationSpec, spec_of
from rigidsym.writing import write_text


def built(asked: str, out: Path, *, portable: bool = False) -> Iterator[Path]:
    """The module NAME_c.py of a file NAME.c, or of each rotation; its files go to out/NAME/.

    What is written stays where the compiler is missing or stops; see `c_build.build`.
    """
    source = Path(asked)
    if source.suffix == ".c":
        yield build(source, portable=portable)
        return
    for single in spec_of(asked).singles():
        yield build(_written(single, out), portable=portable)


def _written(spec: DerivationSpec, out: Path) -> Path:
    """Where the C source of a rotation is, once its files are written."""
    made = product(replace(spec, kernels=("c",)))
    for name, text in made.files.items():
        write_text(out / made.name / name, text)
    return out / made.name / f"{made.name}.c"
