"""Largest errors as they were measured: rows by the digest of a function, and words for them.

A file of them is text: lines that begin with # say what each target was measured with, and a row
a function follows, commas between what it holds. `benchmarks/run.py accuracy --write` writes the
one that this package carries.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from math import ceil, floor, log10
from pathlib import Path

from rigidsym.errors import CheckError
from rigidsym.kernels.accuracy.digest import DIGITS, digest
from rigidsym.kernels.ir import Kernel, Program
from rigidsym.system import resources

SHIPPED = Path(__file__).with_name("measured.csv")
SMALL, LARGE, LARGEST = 3.0, 1e4, 1e15  # sizes of coordinates that points are taken from
_SIZES = "1e4, 1e6 and 1e15"
_FIGURES = 3  # of an error that is stated
_FIXED = ("digest", "points", "reach", "nearest", "function")


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """The largest errors of one function, in eps of the type, of the largest entry of the result.

    For what is no kernel the result is R of it: see `ways`.
    """

    digest: str
    points: int
    reach: float  # the largest size of a coordinate; all else is at most one
    nearest: float  # how near to a pole; 0 where no point was put near one
    function: str  # one that has it: "euler_zxz_intrinsic rotation_matrix"
    errors: Mapping[str, tuple[float, ...]]  # target: in double precision, and in single

    def words(self, kernel: Kernel, target: str) -> str:
        """The sentence of a docstring."""
        ranges = "; ".join(self._ranges(kernel))
        return f"Measured: {self.largest(target)}; {self.points} points: {ranges}."

    def largest(self, target: str) -> str:
        """The errors of one target in words."""
        double, *single = (f"{error:.3g} eps" for error in self.errors[target])
        return f"at most {double}" + "".join(f", {error} in single precision" for error in single)

    def _ranges(self, kernel: Kernel) -> Iterator[str]:
        names = [argument.name for argument in kernel.arguments]
        if "q" in names:
            yield f"q up to {_SIZES if self.reach > SMALL else f'{SMALL:g}'}"
        others = [name for name in names if name != "q"]
        if others:
            yield f"{' and '.join(others)} up to 1"
        if self.nearest:
            yield f"as near to poles as {self.nearest:.0e}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Measured:
    """Rows by their digests, and what each target was measured with."""

    tools: Mapping[str, str] = field(default_factory=dict)  # target: "NumPy 2.4.6, x86-64"
    rows: Mapping[str, Row] = field(default_factory=dict)

    def stated(self, program: Program, target: str) -> Program:
        """The program with the measured errors of its kernels in words, where they are known."""
        kernels = self.of_kernels(program.kernels, target)
        is_any = any(kernel.measured for kernel in kernels)
        return replace(program, kernels=kernels, measured_with=self.tools[target] if is_any else "")

    def of_kernels(self, kernels: Iterable[Kernel], target: str) -> tuple[Kernel, ...]:
        return tuple(self._stated(kernel, target) for kernel in kernels)

    def _stated(self, kernel: Kernel, target: str) -> Kernel:
        row = self.rows.get(digest(kernel)) if self.rows else None
        if row is None or target not in row.errors:
            return kernel
        return replace(kernel, measured=row.words(kernel, target))

    def joined(self, other: Measured) -> Measured:
        """All rows of both, by function; what the other says of a target goes before."""
        rows = dict(self.rows)
        for name, row in other.rows.items():
            before = rows[name].errors if name in rows else {}
            rows[name] = replace(row, errors={**before, **row.errors})
        ordered = sorted(rows.items(), key=lambda named: named[1].function)
        return Measured(tools={**self.tools, **other.tools}, rows=dict(ordered))

    def only(self, names: Collection[str]) -> Measured:
        """The rows of some digests."""
        kept = {name: row for name, row in self.rows.items() if name in names}
        return replace(self, rows=kept)

    def lines(self) -> list[str]:
        """The text of a file, line by line."""
        columns = (*_FIXED, *self.tools)
        return [
            *(f"# {target}: {tool}" for target, tool in self.tools.items()),
            ",".join(columns),
            *(_line(row, tuple(self.tools)) for row in self.rows.values()),
        ]


def _line(row: Row, targets: tuple[str, ...]) -> str:
    fixed = (row.digest, f"{row.points}", f"{row.reach:g}", f"{row.nearest:g}", row.function)
    errors = ("/".join(f"{e:g}" for e in row.errors.get(target, ())) for target in targets)
    return ",".join((*fixed, *errors))


def read(lines: Iterable[str]) -> Measured:
    """What `Measured.lines` wrote; raises CheckError, naming the line, for anything else."""
    tools: dict[str, str] = {}
    rows: dict[str, Row] = {}
    for place, line in enumerate(lines, start=1):
        try:
            if line.startswith("# "):
                target, tool = line.removeprefix("# ").split(": ", 1)
                tools[target] = tool
            elif line != ",".join((*_FIXED, *tools)):
                row = _row(line.split(","), tuple(tools))
                rows[row.digest] = row
        except ValueError as error:
            raise CheckError(f"measured errors, line {place}: {line!r} is none: {error}") from None
    return Measured(tools=tools, rows=rows)


def _row(cells: list[str], targets: tuple[str, ...]) -> Row:
    name, points, reach, nearest, function, *errors = cells
    found = zip(targets, errors, strict=True)
    return Row(
        digest=name,
        points=int(points),
        reach=float(reach),
        nearest=float(nearest),
        function=function,
        errors={target: tuple(map(float, cell.split("/"))) for target, cell in found if cell},
    )


def rounded_up(error: float) -> float:
    """To a few figures, which is never less."""
    if not 0 < error < float("inf"):
        return error
    step = 10.0 ** (floor(log10(error)) - _FIGURES + 1)
    return float(f"{ceil(error / step) * step:.{_FIGURES}g}")


def shipped(names: Collection[str] | None = None) -> Measured:
    """What was measured of the catalogue when the package was made; of some digests, or all.

    Nothing where templates of the user's own write the functions.
    """
    if resources.is_overridden("kernels_"):
        return Measured()
    lines = _shipped_lines()
    return read(line for line in lines if names is None or line[0] == "#" or line[:DIGITS] in names)


@cache
def _shipped_lines() -> tuple[str, ...]:
    return tuple(SHIPPED.read_text(encoding="utf-8").splitlines()) if SHIPPED.is_file() else ()
