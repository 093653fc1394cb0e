"""Hostile inputs: `python benchmarks/run.py fuzz --files 1000`. A result or a message, in bounds.

With `--resume FILE` the counts in WHOLE are run, in slices after each of which FILE holds what was
found; the same command goes on from there.

Each input is read in this process, as a command reads it, with a limit on time and memory. Some
derivation files are also derived and printed. An error that is no message, a warning, and work
beyond the limit count as failures, with the number that makes the input again.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from time import process_time
from typing import Any

import click
import numpy as np
import sympy as sp
from click.testing import CliRunner

from benchmarks import inputs
from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from rigidsym.commands.cli import commands
from rigidsym.data.mass.mesh import mesh_inertia, read_mesh_file
from rigidsym.data.mass.point_masses import inertia_of
from rigidsym.errors import LimitReached, RigidsymError
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import derive, kernels
from rigidsym.pipeline import read_record, read_spec
from rigidsym.system.processes import memory_limit, time_limit
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name
from rigidsym.tools.evaluate.evaluation import evaluation
from rigidsym.tools.identify.identification import identify_file

SECONDS, GIGABYTES = 10.0, 1.0
SLACK = 5.0  # seconds beyond the limit: one step of SymPy is not interrupted
DERIVED = 1000  # one derivation file in so many is run
SLICE = 500  # inputs between two writings of the file of a campaign
WHOLE = {
    "expressions": 100_000,
    "derivation files": 1_000_000,
    "data files": 10_000,
    "meshes": 10_000,
    "records": 10_000,
    "command lines": 20_000,
}
MESSAGES = (RigidsymError, click.ClickException, click.exceptions.Exit, click.Abort, OSError)

Work = Callable[[Random, Path], tuple[str, Callable[[], object]]]


@dataclass
class Findings:
    """What became of the inputs of one kind."""

    counts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest: float = 0.0


def run(settings: Settings) -> Report:
    """Every kind of input, as many as asked for."""
    if settings.resume is not None:
        return report(_resumed(settings.resume))
    return report({kind: campaign(kind, settings.files) for kind in KINDS})


def _resumed(file: Path) -> dict[str, Findings]:
    """The whole campaign, all kinds side by side, from where the file ends."""
    found = {kind: Findings() for kind in WHOLE}
    if file.is_file():
        for kind, (counts, failures, slowest) in json.loads(file.read_text("utf-8")).items():
            found[kind] = Findings(Counter(counts), failures, slowest)
    while left := [k for k, each in found.items() if each.counts.total() < WHOLE[k]]:
        kind = min(left, key=lambda k: found[k].counts.total() / WHOLE[k])
        each = found[kind]
        new = campaign(kind, SLICE, each.counts.total())
        each.counts += new.counts
        each.failures += new.failures
        each.slowest = max(each.slowest, new.slowest)
        plain = {k: (f.counts, f.failures, f.slowest) for k, f in found.items()}
        draft = file.with_name(f"{file.name}.draft")
        draft.write_text(json.dumps(plain, indent=1), "utf-8")
        draft.replace(file)
    return found


def campaign(kind: str, count: int, first: int = 0) -> Findings:
    """The inputs of one kind from a number on."""
    findings = Findings()
    with tempfile.TemporaryDirectory() as name, _inside(Path(name)):
        _prepare(Path(name))
        for number in range(first, first + count):
            progress(f"{kind}: {number + 1 - first} of {count}")
            rng = Random(f"{kind}:{number}")
            shown, work = KINDS[kind](rng, Path(name))
            start = process_time()
            outcome, failure = _outcome(work)
            seconds = process_time() - start  # however busy the machine is
            if not failure and seconds > SECONDS + SLACK:
                outcome, failure = "late", f"{seconds:.1f} s"
            findings.counts[outcome] += 1
            findings.slowest = max(findings.slowest, seconds)
            if failure:
                findings.failures.append(f"{kind}:{number}: {failure}\n{shown}")
                print(findings.failures[-1], file=sys.stderr, flush=True)
    progress()
    return findings


def _outcome(work: Callable[[], object]) -> tuple[str, str]:
    """One word on what became of an input, and a traceback if that is a failure."""
    try:
        with warnings.catch_warnings(action="error"), memory_limit(GIGABYTES), time_limit(SECONDS):
            work()
    except LimitReached:
        return "stopped", ""
    except MESSAGES as error:
        if isinstance(error, RigidsymError | OSError) and "\x1b" in str(error):
            return "failed", f"control characters in {error!r}"
        return "refused", ""
    except Exception:
        return "failed", traceback.format_exc()
    return "fine", ""


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def _prepare(folder: Path) -> None:
    """Files that inputs name."""
    angles = np.random.default_rng(1).uniform(-1, 1, (4, 3))
    matrices = kernels("ZXZ", only="rotation_matrix").rotation_matrix(angles).reshape(4, 9)
    table = np.hstack([angles, matrices])
    np.savetxt(folder / "log.csv", table, delimiter=",", header=",".join(COLUMNS), comments="")
    notes = [f'{k},"calm, {k}",{a!r},{b!r},{c!r}' for k, (a, b, c) in enumerate(angles.tolist())]
    notes[2] = "2,gusts,,NA,0.5"
    head = "# flight 7\ntime [s],note,phi [deg],theta [mrad],psi"
    (folder / "notes.csv").write_text("\n".join([head, *notes, ""]), "utf-8")
    np.save(folder / "angles.npy", angles)
    np.save(folder / "cloud.npy", np.abs(table[:, :4]))
    (folder / "part.stl").write_bytes(box())
    (folder / "top.toml").write_text('[rotation]\nsequence = "ZXZ"\n', "utf-8")


COLUMNS = ("phi", "theta", "psi", *(f"r{i}{j}" for i in "123" for j in "123"))


def box() -> bytes:
    """A box as STL in ASCII."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    lines = ["solid box"]
    for a, b, c, d in faces:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += [f"vertex {x:g} {y:g} {z:g}" for x, y, z in corners[list(triangle)]]
            lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""]).encode()


def mutated(content: bytes, rng: Random) -> bytes:
    """One to four bytes or stretches of a file changed."""
    some = bytearray(content)
    for _ in range(rng.randrange(1, 5)):
        at, length = rng.randrange(len(some) + 1), rng.randrange(1, 20)
        new = (
            rng.randbytes(1),
            b"",
            bytes(some[at : at + length]) * 2,
            rng.randbytes(length),
            rng.choice((b"nan", b"-1", b"1e999", b"9" * 11, b"\xff\xfe", b"\0", b"/", b"\n", b",")),
        )
        some[at : at + length] = rng.choice(new)
        if rng.random() < 0.1:
            del some[at:]
    return bytes(some)


# kinds of input


def _derivation_file(rng: Random, folder: Path) -> tuple[str, Callable[[], object]]:
    text = inputs.derivation_file(rng)
    if rng.randrange(DERIVED):
        return text, lambda: read_spec(text, source="file.toml", name="file", folder=folder)
    (folder / "file.toml").write_text(text, "utf-8")
    return text, lambda: _call(["run", "file.toml", "--quiet"])


def _expression(rng: Random, _folder: Path) -> tuple[str, Callable[[], object]]:
    if rng.random() < 0.3:
        text = inputs.spoiled(rng, inputs.rotation(rng))
        return text, lambda: rotation_from(text)
    text = inputs.spoiled(rng, inputs.expression(rng, 4))

    def parse() -> None:
        names = {name: sp.Symbol(check_name(name)) for name in names_in(text)}
        parse_expression(text, names)

    return text, parse


def _data_file(rng: Random, folder: Path) -> tuple[str, Callable[[], object]]:
    choices = _choices(rng)
    name, work = rng.choice(
        (
            ("log.csv", identify_file),
            ("log.csv", _evaluate),
            ("notes.csv", lambda path: _evaluate(path, **choices)),
            ("cloud.npy", inertia_of),
            ("angles.npy", _evaluate),
        )
    )
    path = folder / f"mutated{Path(name).suffix}"
    path.write_bytes(mutated((folder / name).read_bytes(), rng))
    return repr(path.read_bytes()[:2000]), lambda: str(work(path))


def _choices(rng: Random) -> dict[str, Any]:
    keep = rng.choice(((), ("time",), ("note", "time")))
    return {"keep": keep, "missing": rng.choice(("error", "nan", "drop")), "ending": ".csv"}


def _evaluate(path: Path, *, ending: str = ".npy", **choices: Any) -> object:
    motion, result = derive("ZXZ", only="rotation_matrix"), path.with_name(f"result{ending}")
    return evaluation(motion, ("rotation_matrix",), path, result, **choices).run()


def _mesh(rng: Random, folder: Path) -> tuple[str, Callable[[], object]]:
    path = folder / f"mutated.{rng.choice(('stl', 'stl', 'obj', 'ply', 'off', 'glb'))}"
    content = (
        (folder / "part.stl").read_bytes() if path.suffix == ".stl" else _exported(path.suffix)
    )
    path.write_bytes(mutated(content, rng))
    return repr(path.read_bytes()[:2000]), lambda: mesh_inertia(
        read_mesh_file(path), density=1.0, allow=rng.random() < 0.5
    )


def _exported(suffix: str) -> bytes:
    import trimesh

    content = trimesh.creation.box(extents=(1, 2, 3)).export(file_type=suffix[1:])
    return content.encode() if isinstance(content, str) else bytes(content)


def _record(rng: Random, folder: Path) -> tuple[str, Callable[[], object]]:
    text = inputs.spoiled(rng, inputs.record(rng), 0.1)
    (folder / "record.json").write_text(text, "utf-8")
    if rng.random() < 0.9:
        try:
            request = json.loads(text).get("request")
        except (ValueError, AttributeError):
            request = None
        return text, lambda: read_record(request)
    return text, lambda: _call(["check", "record.json"])


def _command_line(rng: Random, _folder: Path) -> tuple[str, Callable[[], object]]:
    words = inputs.command_line(rng)
    if words[0] in ("derive", "page") and "--only" not in words:
        words += ["--only", "rotation_matrix"]  # all quantities of a chain take their time
    return repr(words), lambda: _call(words)


def _call(words: list[str]) -> None:
    """A command in this process, with the limits of the campaign; raises what it raises."""
    is_limited = words[0] in inputs.OPTIONS and words[0] not in ("list", "templates", "integrate")
    limits = ["--timeout", f"{SECONDS}", "--memory", f"{GIGABYTES}"] if is_limited else []
    done = CliRunner().invoke(commands, words[:1] + limits + words[1:], standalone_mode=False)
    if done.exception is not None:
        raise done.exception


KINDS: dict[str, Work] = {
    "derivation files": _derivation_file,
    "expressions": _expression,
    "data files": _data_file,
    "meshes": _mesh,
    "records": _record,
    "command lines": _command_line,
}


def report(found: dict[str, Findings]) -> Report:
    """Counts by kind; every failure is on standard error."""
    heads = ("inputs", "fine", "refused", "stopped", "failed", "late")
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (kind, each.counts.total(), *(each.counts[head] for head in heads[1:]), each.slowest)
        for kind, each in found.items()
    )
    columns = (Column("kind"), *map(Column, heads), Column("slowest, s", ".1f"))
    failures = sum(len(each.failures) for each in found.values())
    return Report(
        title="Hostile inputs",
        tables=(Table("A result, a message, or stopped by a limit", columns, rows),),
        figures=(Figure("failures", "none", str(failures), failures == 0),),
    )
