"""Largest errors of all shipped functions in all targets: the table that the package carries.

Rows that the table has already stay as long as they are of shipped functions, unless all are asked
for anew; interrupted, it goes on from where it was.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Report, Table
from rigidsym.kernels.accuracy.digest import digest
from rigidsym.kernels.accuracy.measure import kernels_of, measure
from rigidsym.kernels.accuracy.measure_ways import ways_in
from rigidsym.kernels.accuracy.table import SHIPPED, Measured, Row, shipped
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.euler_angles import EULER_SEQUENCES
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.motion import Motion
from rigidsym.pipeline import motion_of
from rigidsym.spec.derivation_file import spec_for, spec_of
from rigidsym.system import resources
from rigidsym.system.files import write_text

COUNT = 2_000
STAGES = (("numpy", "c", "javascript", "jax"), ("numba",))  # Numba compiles for seconds
FILES = ("composite_body", "lecture", "solid_cone", "yaw_pitch_roll")  # the others are conventions


@dataclass(frozen=True, slots=True)
class Subject:
    """A rotation by name, or the name of a shipped derivation file."""

    text: str
    passive: bool = False

    def motion(self) -> Motion:
        is_file = self.text in resources.names("derivations", ".toml")
        spec = spec_of(self.text) if is_file else spec_for(self.text, passive=self.passive)
        return motion_of(spec)


def subjects() -> Iterator[Subject]:
    """Every convention, active and passive, every preset, and the shipped derivations."""
    for text in (*EULER_SEQUENCES, *PARAMETRISATIONS, *PRESETS):
        yield Subject(text)
        yield Subject(text, passive=True)
    yield from map(Subject, FILES)


def run(settings: Settings) -> Report:
    """Measure what the table lacks, or all that is shipped, and write the table as it grows."""
    digests = {subject: _digests(subject) for subject in subjects()}
    found = Measured() if settings.fresh else shipped().only(set().union(*digests.values()))
    for targets in STAGES:
        for more in _measured(_shares(digests, found, targets), targets):
            found = found.joined(more)
            _write(found)
    _write(found)
    progress()
    return report(found)


def _write(found: Measured) -> None:
    write_text(SHIPPED, "\n".join(found.lines()) + "\n")


def _digests(subject: Subject) -> frozenset[str]:
    """Of all that a subject's modules may hold."""
    progress(f"reading {subject.text}")
    motion = subject.motion()
    kernels = (digest(kernel) for kernel in kernels_of(motion, conversions=True))
    return frozenset((*kernels, *(way.digest for way in ways_in(motion))))


def _shares(
    digests: Mapping[Subject, frozenset[str]], found: Measured, targets: Collection[str]
) -> list[tuple[Subject, frozenset[str]]]:
    """Each subject with the digests that are measured already, or with a subject before it."""
    rows = found.rows.items()
    shares, seen = [], {name for name, row in rows if set(row.errors).issuperset(targets)}
    for subject, own in digests.items():
        if not own <= seen:
            shares.append((subject, frozenset(seen)))
        seen |= own
    return shares


def _measured(
    shares: Collection[tuple[Subject, frozenset[str]]], targets: Collection[str]
) -> Iterator[Measured]:
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        waiting = [pool.submit(_of_one, *share, targets) for share in shares]
        for done, future in enumerate(as_completed(waiting), start=1):
            progress(f"measured {done} of {len(shares)} for {', '.join(targets)}")
            yield future.result()


def _of_one(subject: Subject, known: frozenset[str], targets: Collection[str]) -> Measured:
    return measure(subject.motion(), targets, conversions=True, count=COUNT, known=known)


def report(found: Measured) -> Report:
    """The largest error of each function over all rotations, and how many there are."""
    groups: dict[str, list[Row]] = {}
    for row in found.rows.values():
        groups.setdefault(row.function.split()[-1], []).append(row)
    rows = tuple(_line(name, group) for name, group in sorted(groups.items()))
    columns = (Column("function"), Column("of them"), *(Column(t, ".2f") for t in TARGETS))
    return Report(
        title=f"Measured errors: {len(found.rows)} functions against 50 digits, {SHIPPED.name}",
        tables=(Table("Largest, in eps of the type", columns, rows),),
        figures=(),
        notes=tuple(f"{target}: {tool}." for target, tool in found.tools.items()),
    )


def _line(name: str, rows: Collection[Row]) -> tuple[Cell, ...]:
    errors: list[Mapping[str, tuple[float, ...]]] = [row.errors for row in rows]
    largest = (max((max(e[t]) for e in errors if t in e), default=None) for t in TARGETS)
    return (name, len(rows), *largest)
