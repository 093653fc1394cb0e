"""What a benchmark hands back, and how it is printed: aligned text, or JSON."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

Cell = str | int | float | None


@dataclass(frozen=True, slots=True)
class Column:
    """Heading, and the format of the values below it."""

    heading: str
    format: str = ""

    def text(self, value: Cell) -> str:
        return "" if value is None else format(value, "" if isinstance(value, str) else self.format)


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of values under columns; numbers stand right, words left."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @property
    def grid(self) -> list[list[str]]:
        """The headings, then the values as text; what was not measured stays empty."""
        body = (zip(self.columns, row, strict=True) for row in self.rows)
        texts = [[column.text(value) for column, value in row] for row in body]
        return [[column.heading for column in self.columns], *texts]

    def lines(self) -> Iterator[str]:
        grid = self.grid
        widths = [max(map(len, texts)) for texts in zip(*grid, strict=True)]
        yield self.title
        for texts in grid:
            padded = (self._padded(k, texts[k], width) for k, width in enumerate(widths))
            yield ("  " + "  ".join(padded)).rstrip()

    def markdown(self) -> str:
        """The same for a Markdown file."""
        head, *body = self.grid
        lines = [head, ["---"] * len(head), *body]
        return "".join(f"| {' | '.join(texts)} |\n" for texts in lines)

    def _padded(self, place: int, text: str, width: int) -> str:
        is_words = any(isinstance(row[place], str) for row in self.rows)
        return text.ljust(width) if is_words else text.rjust(width)


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure to reach, and what was found."""

    name: str
    target: str
    found: str
    met: bool

    def line(self) -> str:
        mark = "met    " if self.met else "NOT MET"
        return f"  {mark}  {self.name}: {self.found} (to reach: {self.target})"


@dataclass(frozen=True, slots=True)
class Report:
    """The outcome of one benchmark."""

    title: str
    tables: tuple[Table, ...]
    figures: tuple[Figure, ...]
    notes: tuple[str, ...] = ()
    data: tuple[dict[str, Cell], ...] = ()  # for programs, where the tables are too coarse
    documented: Table | None = None  # goes into a page of docs/reference/, between its marks

    def text(self) -> str:
        parts = [[self.title, "=" * len(self.title)], *(list(t.lines()) for t in self.tables)]
        if self.notes:
            parts.append([f"  {note}" for note in self.notes])
        if self.figures:
            parts.append(["Figures to reach", *(figure.line() for figure in self.figures)])
        return "\n\n".join("\n".join(part) for part in parts)


def machine() -> dict[str, str]:
    """Versions and processor, for the head of every print."""
    found = {"python": platform.python_version()}
    found |= {name: importlib.metadata.version(name) for name in ("numpy", "sympy", "mpmath")}
    return found | {"processor": _processor(), "cores": str(os.cpu_count())}


def _processor() -> str:
    """Make, family, vectors and caches: several generations of processors share a name."""
    facts: dict[str, str] = {}
    if Path("/proc/cpuinfo").is_file():
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            key, _, value = line.partition(":")
            facts.setdefault(key.strip(), value.strip())
    if "model name" not in facts:
        return platform.processor() or platform.machine()
    parts = [f"{facts['model name']} {facts.get('cpu family', '')}/{facts.get('model', '')}"]
    widths = {"avx512f": "AVX-512", "avx2": "AVX2"}
    parts += [name for flag, name in widths.items() if flag in facts.get("flags", "").split()][:1]
    caches = Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size")
    sizes = sorted({int(path.read_text().strip().rstrip("K")) for path in caches})
    return ", ".join([*parts, *([f"caches {'/'.join(map(str, sizes))} kB"] if sizes else [])])


def spread_columns(unit: str, digits: int = 3) -> tuple[Column, ...]:
    """Least, median and largest of one measured value."""
    return tuple(Column(f"{end} {unit}", f".{digits}f") for end in ("least", "median", "largest"))


def summary(reports: Mapping[str, Report]) -> str:
    """Every figure to reach, met or not, in one place."""
    lines = [figure.line() for report in reports.values() for figure in report.figures]
    met = sum(figure.met for report in reports.values() for figure in report.figures)
    return "\n".join([f"{met} of {len(lines)} figures met", *lines])
