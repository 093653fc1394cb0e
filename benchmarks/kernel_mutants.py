"""Mutants of shipped kernels: does `rigidsym check` name the file?

In the functions of a generated NumPy or C module every operator, sign, index, number and name is
changed, one at a time. Each mutant is run at some points, and told apart by what it gives: another
value, an error, or the same. The command must name every mutant that gives anything else.
"""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.measure import Settings, progress
from benchmarks.report import Column, Figure, Report, Table
from rigidsym.commands.check import finding_of
from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.lower import lower
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import derive

ROTATIONS = ("ZXZ", "zyx", "quaternion", "rotation_vector")
POINTS = 3
ROOM = 128  # doubles behind `out`, for an index that is too large
_TOKEN = re.compile(r"[A-Za-z_]\w*|\d+(?:\.\d*)?(?:e[-+]?\d+)?|\s+|.")
_OTHER = {"+": "-", "-": "+", "*": "/", "/": "*"}
_HEADS = {"numpy": "\ndef _{}(", "c": "\nEVALUATE({})"}
_ENDS = {"numpy": "\n\n\n", "c": "\n}\n"}


@dataclass(frozen=True, slots=True)
class Mutant:
    """A module with one change in the function of a kernel."""

    kernel: Kernel
    change: str  # "line 7: x0 -> x1"; "" for none
    function: str  # its text
    module: str


def mutants(source: str, kernel: Kernel, target: str) -> Iterator[Mutant]:
    """The function as it is, then with each change."""
    head, end = _HEADS[target].format(kernel.name), _ENDS[target]
    before, _, rest = source.partition(head)
    inside, _, after = rest.partition(end)
    yield Mutant(kernel, "", head + inside + end, source)
    lines = inside.split("\n")
    start = next(k for k, line in enumerate(lines) if line.endswith((":", "{")) or line == "{") + 1
    names = [name for name in kernel.components if re.search(rf"\b{name}\b", inside)]
    for number, line in enumerate(lines[start:], start):
        is_declared = " = in[" in line
        for change, text in _changed(line, [] if is_declared else names):
            function = head + "\n".join((*lines[:number], text, *lines[number + 1 :])) + end
            words = f"{kernel.name}, line {number}: {change}"
            yield Mutant(kernel, words, function, before + function + after)
        names += [] if is_declared else _defined(line)


def _defined(line: str) -> list[str]:
    """The numbers that a line gives names to."""
    if line.lstrip().startswith(("WORD", "out[")):
        return []
    if called := re.search(r"SIN_COS\(\w+, (\w+), (\w+)\)", line):
        return list(called.groups())
    left, sign, _ = line.replace("const REAL", "").partition(" = ")
    return re.findall(r"\w+", left) if sign else []


def _changed(line: str, names: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Each change of a line, in words and as it then reads."""
    if line.lstrip().startswith(("WORD", "(void)", "return beyond")):
        return
    left, sign, _ = line.partition(" = ")
    tokens = _TOKEN.findall(line)
    place = 0
    for number, token in enumerate(tokens):
        is_target = sign and place < len(left)
        place += len(token)
        if is_target and tokens[number - 1] != "[":  # an index of what is stored may change
            continue
        for other in _others(token, tokens[:number], names):
            yield f"{token} -> {other}", "".join((*tokens[:number], other, *tokens[number + 1 :]))


def _others(token: str, before: Sequence[str], names: Sequence[str]) -> Iterator[str]:
    """What may stand in its place: a sign is dropped, a name is the next one."""
    last = next((t for t in reversed(before) if t.strip()), "")
    if token in _OTHER:
        yield _OTHER[token] if re.match(r"[\w.)\]]", last) and last != "return" else ""
    elif re.match(r"\d", token):
        yield str(int(token) + 1) if token.isdecimal() else repr(float(token) + 1)
    elif token in names and len(names) > 1:
        yield names[(names.index(token) + 1) % len(names)]


def values_in_python(found: Sequence[Mutant], points: Any, module: Any) -> list[Any]:
    """What each function gives, one row a mutant; None for an error."""
    return [_called(mutant, points, vars(module)) for mutant in found]


def _called(mutant: Mutant, points: Any, names: dict[str, Any]) -> Any:
    held = dict(names)
    try:
        exec(mutant.function, held)
        given = held[f"_{mutant.kernel.name}"](*(column.copy() for column in points))
        entries = given if isinstance(given, tuple) else (given,)
        return np.array([np.broadcast_to(entry, points[0].shape) for entry in entries], float)
    except Exception:  # whatever a mutant does
        return None


def values_in_c(found: Sequence[Mutant], points: Any, files: dict[str, str]) -> list[Any]:
    """The same for C: all mutants as functions of one library."""
    name = next(file for file in files if file.endswith(".c") and "_module" not in file)
    text = [f'#include "{name}"\n']  # where it ends, the type is double
    for number, mutant in enumerate(found):
        text.append(mutant.function.replace(f"({mutant.kernel.name})", f"(m{number})", 1))
        call = f"FN(evaluate_m{number})(1, 1, in, out);"
        text.append(f"void call{number}(const double *in, double *out) {{ {call} }}\n")
    with TemporaryDirectory() as folder:
        for file, content in files.items():
            Path(folder, file).write_text(content, "utf-8")
        Path(folder, "all.c").write_text("\n".join(text), "utf-8")
        command = ["gcc", "-O0", "-w", "-shared", "-fPIC", "-o", "all.so", "all.c", "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        library = ctypes.CDLL(f"{folder}/all.so")
        size = len(found[0].kernel.outputs)
        return [_rows(getattr(library, f"call{k}"), points, size) for k in range(len(found))]


def _rows(function: Any, points: Any, size: int) -> Any:
    rows = []
    for point in np.ascontiguousarray(points.T):
        out = np.zeros(ROOM)
        function(*(ctypes.c_void_p(array.ctypes.data) for array in (point, out)))
        rows.append(out[: size + 1])  # an index that is too large shows behind them
    return np.array(rows)


def tried(text: str, target: str) -> tuple[int, int, list[str]]:
    """Mutants of one module: how many, how many give an error or another value, and of these the
    changes that `rigidsym check` does not name."""
    motion = derive(rotation_from(text))
    made = motion.kernels(target)
    total, changed, missed = 0, 0, []
    with TemporaryDirectory() as folder:
        path = Path(folder, made.main)
        for kernel in lower(motion).kernels:
            progress(f"{text}, {target}: {kernel.name}")
            found = list(mutants(made.source, kernel, target))
            points = np.random.default_rng(1).uniform(0.2, 1.2, (len(kernel.components), POINTS))
            with np.errstate(all="ignore"):
                values = (
                    values_in_python(found, points, made.load())
                    if target == "numpy"
                    else values_in_c(found, points, dict(made.files))
                )
            for mutant, value in zip(found[1:], values[1:], strict=True):
                total += 1
                if not _same(value, values[0]):
                    changed += 1
                    path.write_text(mutant.module, "utf-8")
                    if not finding_of(path, made.source).problem:
                        missed.append(f"{text}, {target}, {mutant.change}")
    return total, changed, missed


def _same(one: Any, two: Any) -> bool:
    return one is not None and np.allclose(one, two, rtol=1e-13, atol=1e-13, equal_nan=True)


def run(settings: Settings) -> Report:  # noqa: ARG001  (as the others)
    """All mutants of all functions."""
    rows, missed = [], []
    for text in ROTATIONS:
        for target in ("numpy", "c"):
            total, changed, left = tried(text, target)
            rows.append((text, target, total, changed, changed - len(left)))
            missed += left
    progress()
    changed = sum(row[3] for row in rows)
    heads = ("rotation", "target", "mutants", "of other value, or none", "named by check")
    return Report(
        title="Mutation of kernels: one change of a NumPy or C function at a time",
        tables=(Table("Mutants", tuple(map(Column, heads)), tuple(rows)),),
        figures=(
            Figure(
                "mutants of other value that `rigidsym check` names",
                "all",
                f"{changed - len(missed)} of {changed}",
                not missed,
            ),
        ),
        notes=tuple(f"not named: {change}" for change in missed),
    )
