"""Commands killed, starved of disk, and run twice at once: `python benchmarks/run.py kills`.

Whole files or none: each file that is there afterwards is the one from before or the one that the
command writes, a record that is new has only new files beside it, and the command then succeeds.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from random import Random
from time import perf_counter, sleep

import numpy as np
from click.testing import CliRunner

from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.commands.cli import commands

Files = dict[str, bytes]

BEFORE = ("derive", "ZXZ", "--angles", "a,b,c", "--target", "numpy,c", "--only", "rotation_matrix")
COMMANDS: dict[str, tuple[str, ...]] = {
    "derive": ("derive", "ZXZ", "--target", "numpy,c"),
    "run": ("run", "top.toml", "--target", "c"),
    "page": ("page", "ZXZ"),
    "build": ("build", "ZXZ", "--only", "rotation_matrix"),
    "eval": ("eval", "ZXZ", "log.npy", "--out", "out/result.npy", "--only", "rotation_matrix"),
}
WAYS = ("killed", "full disk", "two at once")


def run(settings: Settings) -> Report:
    """Each command, killed as often as asked for, and in the other ways a tenth as often."""
    return report(campaign(settings.files))


def campaign(count: int) -> dict[tuple[str, str], Counter[str]]:
    """{(way, command): counts of outcomes}; every failure is on standard error."""
    found: dict[tuple[str, str], Counter[str]] = {}
    rng = Random(count)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name).resolve() / "work"
        for command, words in COMMANDS.items():
            trial = Trial(place, words)
            for way in WAYS:
                outcomes = found[way, command] = Counter()
                for turn in range(count if way == "killed" else max(1, count // 10)):
                    progress(f"{command}, {way}: {turn + 1}")
                    outcome = getattr(trial, way.replace(" ", "_"))(rng)
                    outcomes["sound" if not outcome else "failed"] += 1
                    if outcome:
                        print(f"{command}, {way}: {outcome}", file=sys.stderr, flush=True)
    progress()
    return found


class Trial:
    """One command in a folder that holds the files of an earlier one."""

    def __init__(self, place: Path, words: Sequence[str]) -> None:
        self.place, self.words = place, words
        self._prepare()
        self.before, self.after = self._made_by(BEFORE), self._made_by(words)
        self._restore()
        start = perf_counter()
        _wait(_start(words, place))
        self.seconds = perf_counter() - start

    def _made_by(self, words: Sequence[str]) -> Files:
        """The files after a command in this process, where later ones find all in memory."""
        before = Path.cwd()
        os.chdir(self.place)
        try:
            CliRunner().invoke(commands, words, standalone_mode=False, catch_exceptions=False)
        finally:
            os.chdir(before)
        return _files(self.place)

    def killed(self, rng: Random) -> str:
        """Killed at a random moment; "" if the files are sound."""
        self._restore()
        child = _start(self.words, self.place)
        sleep(rng.uniform(0, 1.1) * self.seconds)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        return self._fault() or self._again()

    def full_disk(self, rng: Random) -> str:
        """With room for only so many bytes in a file."""
        self._restore()
        largest = max(map(len, self.after.values()))
        status = _wait(_start(self.words, self.place, most=rng.randrange(largest)))
        is_whole = _files(self.place) == self.after
        if status == 0 and not is_whole:
            return "it succeeds, and files are missing"
        return self._fault() or self._again()

    def two_at_once(self, rng: Random) -> str:
        """Together with the earlier command, which writes the same folder."""
        self._restore()
        one = _start(self.words, self.place)
        sleep(rng.uniform(0, 1) * self.seconds)
        other = _start(BEFORE, self.place)
        statuses = _wait(one), _wait(other)
        if any(statuses):
            return f"exit codes {statuses}"
        return self._fault(is_either=True)

    def _fault(self, *, is_either: bool = False) -> str:
        there = _files(self.place)
        for name, content in there.items():
            if content not in (self.before.get(name), self.after.get(name)):
                return f"{name} is neither old nor new, {len(content)} bytes"
        for name in self.before.keys() - there.keys():
            return f"{name} is gone"
        for record in (name for name in there if name.endswith(".json")):
            is_new = there[record] != self.before.get(record)
            state = self.after if is_new else self.before
            for file in json.loads(there[record])["files"]:
                name = f"{record.rpartition('/')[0]}/{file}"
                if (is_new or is_either) and there.get(name) != state[name]:
                    return f"{record} is {'new' if is_new else 'old'}, and {name} is not"
        return ""

    def _again(self) -> str:
        """The command run to its end over what is left."""
        status = _wait(_start(self.words, self.place))
        if status or _files(self.place) != self.after:
            return f"the next run ends with {status}"
        return ""

    def _prepare(self) -> None:
        shutil.rmtree(self.place, ignore_errors=True)
        (self.place / "out").mkdir(parents=True)
        (self.place / "top.toml").write_text('[rotation]\nsequence = "ZXZ"\n', "utf-8")
        angles = np.random.default_rng(1).uniform(-1, 1, (300_000, 3))
        np.save(self.place / "log.npy", angles)

    def _restore(self) -> None:
        shutil.rmtree(self.place / "out")
        for name, content in self.before.items():
            path = self.place / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def _files(place: Path) -> Files:
    """All files of the output but drafts, whose names begin with a point."""
    return {
        str(path.relative_to(place)): path.read_bytes()
        for path in sorted((place / "out").rglob("*"))
        if path.is_file() and not path.name.startswith(".") and path.parent.name != "__pycache__"
    }


def _start(words: Sequence[str], place: Path, *, most: int | None = None) -> int:
    """A command in a process of its own, which has all modules already."""
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        os.chdir(place)
        null = os.open(os.devnull, os.O_RDWR)
        for descriptor in (0, 1, 2):
            os.dup2(null, descriptor)
        if most is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
        commands.main(list(words), standalone_mode=False)
        status = 0
    finally:
        os._exit(status)


def _wait(child: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def report(found: dict[tuple[str, str], Counter[str]]) -> Report:
    """Counts by way and command."""
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (way, command, counts["sound"], counts["failed"])
        for (way, command), counts in found.items()
    )
    columns = tuple(map(Column, ("", "command", "sound", "failed")))
    failures = sum(counts["failed"] for counts in found.values())
    return Report(
        title="Commands that do not come to their end",
        tables=(Table("Whole files or none", columns, rows),),
        figures=(Figure("failures", "none", str(failures), failures == 0),),
    )
