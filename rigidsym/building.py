"""From a rotation, or from C that was written before, to a Python module of compiled functions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from rigidsym.kernels.targets.c_build import build
from rigidsym.pipeline import product
from rigidsym.spec import spec_for
from rigidsym.writing import write_text


def built(asked: str, out: Path) -> Path:
    """The module NAME_c.py of a file NAME.c, or of a rotation whose files go to out/NAME/.

    What is written stays where the compiler is missing or stops; see `c_build.build`.
    """
    source = Path(asked)
    return build(source if source.suffix == ".c" else _written(asked, out))


def _written(rotation: str, out: Path) -> Path:
    """Where the C source of a rotation is, once its files are written."""
    made = product(replace(spec_for(rotation), kernels=("c",)))
    for name, text in made.files.items():
        write_text(out / made.name / name, text)
    return out / made.name / f"{made.name}.c"
