"""A generated function over a file of any length, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from rigidsym.data.chunk import ROWS, Piece, Rows, Table
from rigidsym.data.column_names import misnumbered
from rigidsym.data.readers import rows_of
from rigidsym.data.writers import Sink, check_ending, sink_for
from rigidsym.errors import DataError, RequestError
from rigidsym.motion import Motion
from rigidsym.system.files import naming
from rigidsym.system.progress import Progress
from rigidsym.tools.evaluate.claim import claimed
from rigidsym.tools.evaluate.draft import Draft, Marks, asked_of
from rigidsym.tools.evaluate.inputs import inputs_of
from rigidsym.tools.evaluate.outputs import columns_of
from rigidsym.tools.evaluate.work import Work


@dataclass(frozen=True, kw_only=True, slots=True)
class Evaluated:
    """What was written."""

    path: Path
    rows: int
    resumed: int  # rows that an earlier run had done
    columns: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Evaluation:
    """One file to be read, what is computed of each row, and the file to be written."""

    source: Path
    rows: Rows
    work: Work
    path: Path
    piece: int = ROWS  # rows in memory at once
    scheduler: str | None = None
    settle: float = 1.0  # seconds between the marks from which a killed run goes on

    def run(self, progress: Progress | None = None) -> Evaluated:
        """Go through the file, from where an earlier run of the same stopped.

        Rows go to a draft beside the result, PATH.part, which becomes the result when all are
        there. Raises DataError, and then leaves no draft, for rows that are no numbers, and
        DraftInUse while another process writes the same result. Stopped otherwise, it leaves a
        draft with marks to go on from, unless nothing was done.
        """
        with naming(self.path), claimed(self.path):
            return self._run(progress)

    def _run(self, progress: Progress | None) -> Evaluated:
        draft = Draft(self.path, asked_of(self.source, self.work))
        marks = draft.marks()
        begun = marks.rows
        try:
            marks = self._filled(draft, marks, progress)
        except BaseException as error:
            if isinstance(error, DataError) or not draft.marks().rows:
                draft.remove()
            raise
        names = tuple(map(str, self.work.columns))
        return Evaluated(path=self.path, rows=marks.rows, resumed=begun, columns=names)

    def _filled(self, draft: Draft, marks: Marks, progress: Progress | None) -> Marks:
        names = list(map(str, self.work.columns))
        sink = sink_for(self.path, names, self.rows.dtype, marks.sink)
        try:
            marks = self._appended(sink, draft, marks, progress)
            draft.save(marks, sink)
            sink.finish(marks.rows)
        finally:
            sink.close()
        draft.forget()
        return marks

    def _appended(self, sink: Sink, draft: Draft, marks: Marks, progress: Progress | None) -> Marks:
        """All rows; marks are kept now and then, for a disk takes its time, and on the way out."""
        saved = monotonic()
        try:
            pieces = self.rows.pieces(self.work.inputs.columns, marks.source, self.piece)
            for piece, table in self._computed(pieces):
                place = sink.append(table)
                marks = Marks(source=piece.end, sink=place, rows=marks.rows + len(table))
                if monotonic() - saved >= self.settle:
                    draft.save(marks, sink)
                    saved = monotonic()
                if progress is not None:
                    progress(piece.share)
        except BaseException:
            if marks.rows:
                with suppress(OSError):  # where the disk is full, the marks before these hold
                    draft.save(marks, sink)
            raise
        return marks

    def _computed(self, pieces: Iterable[Piece]) -> Iterator[tuple[Piece, Table]]:
        if self.scheduler is None:
            return ((piece, self.work.of(piece.table)) for piece in pieces)
        from rigidsym.tools.evaluate.dask_work import on_cluster

        return on_cluster(self.scheduler, self.work, pieces)


def evaluation(
    motion: Motion,
    quantities: Sequence[str],
    source: Path,
    path: Path,
    *,
    columns: Sequence[str] | None = None,
    given: Mapping[str, float] | None = None,
    degrees: bool = False,
    threads: int = 1,
    target: str = "numpy",
    piece: int = ROWS,
    scheduler: str | None = None,
) -> Evaluation:
    """The quantities of a motion for each row of a file: NPY, Parquet, or text with separators.

    Columns are found by their names, or by `columns`; without either they are the arguments in
    the order of the functions. `given` has numbers for arguments that are in no column.
    `degrees`: angles and their rates are in degrees, in the file and in the result.

    Raises DataError for a file or columns that do not fit, RequestError for what cannot be, such as
    an unknown ending of the result, and QuantityError.
    """
    check_ending(path)
    rows = rows_of(source)
    if columns is not None and len(columns) != rows.width:
        raise DataError(misnumbered(source, rows.width, len(columns)))
    if path.resolve() == source.resolve():
        raise RequestError(f"{path}: the result would take the place of what is read")
    chosen = motion.select(quantities)
    for name in quantities:
        if not chosen.step(name).quantity.inputs:
            raise RequestError(f"{name} takes no input: it is the same for every row")
    try:
        inputs = inputs_of(
            chosen,
            quantities,
            columns or rows.names,
            rows.width,
            given=given or {},
            degrees=degrees,
        )
    except RequestError:
        raise
    except DataError as error:
        raise DataError(f"{source}: {error}") from None
    if not inputs.columns:
        raise RequestError(
            f"{source}: nothing of it is used; the results are the same for every row"
        )
    work = Work(
        kernels=chosen.kernels(target),
        calls=tuple((name, chosen.step(name).quantity.inputs) for name in quantities),
        inputs=inputs,
        columns=columns_of(chosen, quantities, degrees=degrees),
        threads=threads,
    )
    return Evaluation(
        source=source, rows=rows, work=work, path=path, piece=piece, scheduler=scheduler
    )
