"""Time of the notes: all conventions in all text formats, and one PDF beside TeX alone."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter

from benchmarks.measure import Settings, interleaved, timed
from benchmarks.report import Column, Figure, Report, Table
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.motion import derive
from rigidsym.notes.formats.pdf import missing_programs, typeset
from rigidsym.notes.note import Note

MOST_SECONDS = 5.0
MOST_BEYOND_TEX = 3.0
REPEATS = 3
FORMATS: Mapping[str, Callable[[Note], str]] = {
    "LaTeX": Note.latex,
    "HTML": Note.html,
    "Markdown": Note.markdown,
}
_TEX = ("latexmk", "-norc", "-pdf", "-interaction=batchmode", "note.tex")


def run(settings: Settings) -> Report:
    """Each note is made once, in one process; the PDF a few times, in turns with TeX alone."""
    rows = [_seconds(sequence, FORMATS) for sequence in EULER_SEQUENCES]
    total = sum(sum(row) for row in rows)
    each = [sum(column) for column in zip(*rows, strict=True)]
    names = ("derived and composed", *FORMATS)
    tables = [
        Table(
            "24 conventions, seconds together",
            (Column("format"), Column("seconds", ".2f")),
            tuple(zip(names, each, strict=True)),
        )
    ]
    figures = [
        Figure(
            name="all notes of all 24 conventions in all text formats",
            target=f"at most {MOST_SECONDS:g} s",
            found=f"{total:.2f} s",
            met=total <= MOST_SECONDS,
        )
    ]
    if not missing_programs():
        table, figure = _pdf(settings.repeats or REPEATS)
        tables.append(table)
        figures.append(figure)
    return Report(title="Notes", tables=tuple(tables), figures=tuple(figures))


def _seconds(sequence: str, formats: Mapping[str, Callable[[Note], str]]) -> tuple[float, ...]:
    """Of the derivation with its note as data, and of each format."""
    start = perf_counter()
    note = derive(EulerAngles(sequence)).note()
    made = perf_counter() - start
    return (made, *(timed(partial(printed, note)) for printed in formats.values()))


def _pdf(repeats: int) -> tuple[Table, Figure]:
    """From the rotation to its PDF, and what TeX takes for the same text."""
    text = derive(EulerAngles("ZXZ")).note().latex()
    ours, tex = "from ZXZ to its PDF", "latexmk alone"
    seconds = interleaved(
        {ours: partial(timed, _whole), tex: partial(timed, partial(_tex_alone, text))},
        repeats,
        warm_up=0,
    )
    middles = {name: median(times) for name, times in seconds.items()}
    beyond = middles[ours] - middles[tex]
    return (
        Table(
            "one PDF, medians in turns",
            (Column("what"), Column("seconds", ".2f")),
            tuple(middles.items()),
        ),
        Figure(
            name="one PDF",
            target=f"at most {MOST_BEYOND_TEX:g} s beyond TeX",
            found=f"{beyond:.2f} s beyond {middles[tex]:.2f} s",
            met=beyond <= MOST_BEYOND_TEX,
        ),
    )


def _whole() -> None:
    typeset(derive(EulerAngles("ZXZ")).note().latex())


def _tex_alone(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "note.tex").write_text(text, encoding="utf-8")
        subprocess.run(_TEX, cwd=folder, check=True, capture_output=True)
