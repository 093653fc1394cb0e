"""Generated functions over a file of any length, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

from rigidsym.data.chunk import ROWS, Chunk, Missing, Table, TableReader, without_missing
from rigidsym.data.columns import ColumnNames, names_for
from rigidsym.data.readers import reader_of
from rigidsym.data.text import TextReader
from rigidsym.data.writers import check_ending, table_writer
from rigidsym.errors import DataError, RequestError
from rigidsym.motion import Motion
from rigidsym.system.cluster import on_cluster
from rigidsym.system.processes import Progress
from rigidsym.tools.evaluate.callables import functions_of
from rigidsym.tools.evaluate.inputs import inputs_of
from rigidsym.tools.evaluate.work import Work


@dataclass(frozen=True, kw_only=True, slots=True)
class Evaluated:
    """What was written."""

    path: Path
    rows: int
    columns: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Evaluation:
    """One file to be read, what is computed of each row, and the file to be written."""

    reader: TableReader
    columns: tuple[int, ...]  # that are read
    names: tuple[str, ...]  # of these
    kept: tuple[int, ...]  # columns that are passed through
    kept_names: tuple[str, ...]
    work: Work
    path: Path
    rows: int = ROWS  # in memory at once
    missing: Missing = "error"
    scheduler: str | None = None
    output: BinaryIO | None = None  # in place of the path

    def run(self, progress: Progress | None = None) -> Evaluated:
        """Go through the file; the result is in place when all of it is there, or not at all.

        Raises DataError for rows that are not numbers.
        """
        names = (*self.kept_names, *map(str, self.work.outputs))
        count = 0
        with table_writer(self.path, names, self.reader.dtype, self.output) as writer:
            for chunk, table in self._computed():
                writer.append(table, chunk.kept)
                count += len(table)
                if progress is not None:
                    progress(chunk.share)
        return Evaluated(path=self.path, rows=count, columns=names)

    def _computed(self) -> Iterator[tuple[Chunk, Table]]:
        read = self.reader.chunks(self.columns, self.rows, self.kept)
        chunks = without_missing(self.reader, read, self.names, self.missing)
        if self.scheduler is None:
            return ((chunk, self.work.of(chunk.table)) for chunk in chunks)
        return on_cluster(self.scheduler, self.work.of, chunks, lambda chunk: chunk.table)


def evaluation(
    motion: Motion,
    quantities: Sequence[str],
    source: Path | BinaryIO,
    path: Path | BinaryIO,
    *,
    columns: Sequence[str] | None = None,
    given: Mapping[str, float] | None = None,
    keep: Sequence[str] = (),
    missing: Missing = "error",
    degrees: bool = False,
    threads: int = 1,
    target: str = "numpy",
    rows: int = ROWS,
    scheduler: str | None = None,
) -> Evaluation:
    """Callables of a motion for each row of a file: NPY, Parquet, or text with separators.

    `quantities` are quantities or conversions (`quaternion`, `from_quaternion`,
    `from_rotation_matrix`). `source` and `path` may be binary streams of text with commas. Columns
    are found by their names, or by `columns`; without either they are the arguments in the order
    of the functions. Units in names are converted; without one, angles and their rates are in
    radians, with `degrees` in degrees, as they then are in the result. `given` has numbers for
    arguments that are in no column. Columns to `keep` are written before the result. Rows with
    `missing` numbers are an error, have NaN as their result, or are dropped.

    Raises DataError for a file or columns that do not fit, RequestError for a request that cannot
    be met, such as an unknown ending of the result, and QuantityError.
    """
    reader, path, output = _opened(source, path)
    work, arguments = functions_of(motion, quantities, target, degrees=degrees)
    try:
        names = names_for(columns, reader.width, reader.names)
        header = None if names is None else ColumnNames(names)
        used, inputs = inputs_of(
            arguments, header, reader.width, given=given or {}, degrees=degrees
        )
        kept = dict(_kept(header, name) for name in keep)
    except RequestError:
        raise
    except DataError as error:
        raise DataError(f"{reader.source}: {error}") from None
    if not used:
        raise RequestError(f"{reader.source}: no column is used; every row has the same result")
    return Evaluation(
        reader=reader,
        columns=used,
        names=tuple(n for a in arguments if inputs[a.name].columns for n in a.names),
        kept=tuple(kept),
        kept_names=tuple(kept.values()),
        work=replace(work, inputs=inputs, threads=threads),
        path=path,
        rows=rows,
        missing=missing,
        scheduler=scheduler,
        output=output,
    )


def _opened(
    source: Path | BinaryIO, path: Path | BinaryIO
) -> tuple[TableReader, Path, BinaryIO | None]:
    """The reader of a source, the path of the result, and the stream in place of it."""
    reader: TableReader
    if isinstance(source, Path):
        reader = reader_of(source)
    else:
        reader = TextReader(Path("standard input"), source)
    if not isinstance(path, Path):
        return reader, Path("standard output"), path
    check_ending(path)
    if isinstance(source, Path) and path.resolve() == source.resolve():
        raise RequestError(f"{path}: the result would replace the file that is read")
    return reader, path, None


def _kept(header: ColumnNames | None, name: str) -> tuple[int, str]:
    """A column to keep, and its name in the file."""
    if header is None:
        raise DataError("--keep needs names of columns; --columns gives them")
    if (column := header.find([name])) is None:
        raise DataError(f"no column {name} among {header.listed}")
    return column, header.names[column]
