"""How far a result has come: marks beside its draft, so that it can be taken up again."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path

from rigidsym.data.writers import Sink, draft_of, reaches
from rigidsym.system.files import to_disk, write_text
from rigidsym.tools.evaluate.work import Work


@dataclass(frozen=True, kw_only=True, slots=True)
class Marks:
    """Places up to which all is done."""

    source: int = 0  # in the file that is read, by its own measure
    sink: int = 0  # in the draft
    rows: int = 0


class Draft:
    """The marks of one result; they hold for one input and one piece of work alone."""

    def __init__(self, path: Path, asked: str) -> None:
        self._path = path
        self._asked = asked
        self._rows = draft_of(path)
        self._marks = self._rows.with_name(f"{self._rows.name}.json")

    def marks(self) -> Marks:
        """Where to go on; from the beginning where there is no draft, or one of other work.

        Marks of other work are forgotten before its draft is written over: they would be taken
        up by that work again, with rows that are not its own.
        """
        marks = self._kept()
        if marks.rows and reaches(self._path, marks.sink):
            return marks
        self.forget()
        return Marks()

    def _kept(self) -> Marks:
        try:
            kept = json.loads(self._marks.read_text(encoding="utf-8"))
            return Marks(**kept["marks"]) if kept["asked"] == self._asked else Marks()
        except (FileNotFoundError, ValueError, KeyError, TypeError):  # none, or half of one
            return Marks()

    def save(self, marks: Marks, sink: Sink) -> None:
        """Keep the marks, once the rows that they speak of are on the disk."""
        sink.settle()
        content = {"asked": self._asked, "marks": asdict(marks)}
        write_text(self._marks, json.dumps(content, indent=1) + "\n", is_lasting=True)

    def forget(self) -> None:
        if self._marks.exists():
            self._marks.unlink()
            to_disk(self._marks.parent)

    def remove(self) -> None:
        """Leave nothing behind."""
        self.forget()
        if self._rows.is_dir():
            shutil.rmtree(self._rows)
        self._rows.unlink(missing_ok=True)


def asked_of(path: Path, work: Work) -> str:
    """What tells one piece of work from another: the file as it is now, and all that is done."""
    stat = path.stat()
    said = (str(path.resolve()), stat.st_size, stat.st_mtime_ns, work.calls, work.inputs)
    source = sorted(work.kernels.files.items())
    return sha256(repr((*said, work.columns, source)).encode()).hexdigest()
