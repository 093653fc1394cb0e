"""The formulas in source files: matrices and vectors in Python, C, C++ and MATLAB.

Files are read as text and never run. Assignments are followed from top to bottom, so that
`cphi = cos(phi)` and `R[0][1] = ...` are understood; what cannot be read is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, RequestError
from rigidsym.tools.compare.language import read_formula, spelled_out
from rigidsym.tools.compare.matching import Comparison, identified
from rigidsym.tools.compare.plain import name_of, plain
from rigidsym.tools.compare.targets import KnownQuantity, stem_of

SUFFIXES = (".py", ".c", ".h", ".cc", ".cpp", ".cxx", ".hpp", ".ino", ".m")
_MOST_BYTES = 300_000  # of a file
_MOST_FILES = 5_000
_MARKS = re.compile(r"[()\[\]{},;\n]|(?<![=!<>])=(?!=)")
_DEEPEST = 12  # nested brackets
_LONGEST = 4_000  # characters of a statement
_MOST_SYMBOLS = 12
_NUMPY = re.compile(r"^\s*(?:import|from) (?:numpy|jax)\b", re.MULTILINE)
_MATRICES = re.compile(
    r"\bsympy\b|\bcasadi\b|\b(?:np|numpy)\.mat\(|[mM]atrix\("
)  # whose * is the product of matrices
_SHAPES = {9: (3, 3), 12: (4, 3), 16: (4, 4)}
_TRIGONOMETRIC = (sp.sin, sp.cos, sp.tan)

_QUOTED = r"\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'"
_COMMENTS = {
    ".py": rf"\"\"\".*?(?:\"\"\"|\Z)|'''.*?(?:'''|\Z)|{_QUOTED}|#[^\n]*",
    ".m": r"%[^\n]*|\"[^\"\n]*\"|(?<![\w)\]}.'])'[^'\n]*'",
    ".c": rf"/\*.*?(?:\*/|\Z)|//[^\n]*|{_QUOTED}|^[ \t]*#[^\n]*",
}
_NAME = r"\b[A-Za-z_]\w*(?:(?:\.|->|::)[A-Za-z_]\w*){0,5}"
_INDEX = r"[ \t]*\d+[ \t]*(?:,[ \t]*\d+[ \t]*)?"
_STATEMENT = re.compile(
    r"(?P<scope>^(?:[ \t]*(?:def|class|function)\b|\}))"
    r"|\breturn\b[ \t]*"
    rf"|(?P<names>{_NAME}(?:[ \t]*,[ \t]*{_NAME}){{0,8}})[ \t]*"
    rf"(?P<index>(?:\[{_INDEX}\])+|\({_INDEX}\))?(?:\[\w*\])*"
    r"[ \t]*(?:=(?!=)|(?P<stream><<))[ \t\n]*",
    re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class FormulaInFile:
    """A formula, and where it begins."""

    path: Path
    line: int
    name: str
    comparison: Comparison

    def __str__(self) -> str:
        name = f"{self.name}: " if self.name else ""
        return f"{self.path}:{self.line}: {name}{self.comparison.text()}"

    def record(self) -> dict[str, Any]:
        """For JSON."""
        place = {"path": str(self.path), "line": self.line, "name": self.name}
        return place | self.comparison.record()


def source_files(paths: Sequence[Path]) -> Iterator[Path]:
    """The source files among the paths and below them, in order, without hidden folders.

    Raises RequestError for a file in another language or of more than 300 kB and if there are no
    source files, and ExpressionError if there are more than can be searched.
    """
    for path in paths:
        if path.is_file() and path.suffix not in SUFFIXES:
            raise RequestError(f"{path}: expected a folder, or a file {', '.join(SUFFIXES)}")
        if path.is_file() and path.stat().st_size > _MOST_BYTES:
            raise RequestError(
                f"{path}: {path.stat().st_size} bytes; expected {_MOST_BYTES} at most"
            )
    files = [
        file
        for path in paths
        for file in (sorted(path.rglob("*")) if path.is_dir() else [path])
        if file.suffix in SUFFIXES
        and not any(part.startswith(".") for part in file.relative_to(path).parts)
        and file.is_file()
        and file.stat().st_size <= _MOST_BYTES
    ]
    if not files:
        where = ", ".join(map(str, paths))
        raise RequestError(f"{where}: no source files; looked for {', '.join(SUFFIXES)}")
    if len(files) > _MOST_FILES:
        raise ExpressionError(f"{len(files)} source files; expected at most {_MOST_FILES}")
    yield from dict.fromkeys(files)


def search(path: Path, also: Sequence[KnownQuantity] = ()) -> Iterator[FormulaInFile]:
    """The formulas of a file that are a known quantity, or close to one."""
    text = path.read_text(encoding="utf-8", errors="replace")
    for line, name, matrix in formulas(text, path.suffix):
        try:
            found = identified(matrix, also=also, is_in_program=True)
        except ExpressionError:  # a function without values
            continue
        if found.found is not None:
            yield FormulaInFile(path, line, name, found)


def formulas(text: str, suffix: str) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
    """(line, name, matrix) of each matrix and vector that may be one of kinematics."""
    language = suffix if suffix in _COMMENTS else ".c"
    comments = re.compile(_COMMENTS[language], re.DOTALL | re.MULTILINE)
    text = comments.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    is_numpy = bool(language == ".py" and _NUMPY.search(text) and not _MATRICES.search(text))
    reader = _FileReader(is_numpy=is_numpy)
    found: list[tuple[int, str, sp.ImmutableMatrix]] = []
    place, line, counted = 0, 1, 0
    while match := _STATEMENT.search(text, place):
        place = match.end()
        line += text.count("\n", counted, match.start())
        counted = match.start()
        if match["scope"] is not None:
            found += reader.finished()
            reader = _FileReader(is_numpy=is_numpy)
            continue
        end = _end(text, place, is_c=language == ".c")
        if end > place:
            found += reader.read(line, match, text[place:end])
            place = end
    found += reader.finished()
    for line, name, matrix in sorted(found, key=lambda each: each[0]):
        spelled = _block(spelled_out(matrix))
        if _may_be_known(spelled):
            yield line, name, spelled


def _end(text: str, start: int, *, is_c: bool) -> int:
    """The end of a statement, a semicolon or a line outside brackets; `start` if it is none.

    A chain a = b = c is none: its last part is a statement. In C a declaration may hold several,
    as in double s = sin(a), c = cos(a).
    """
    depth, comma = 0, start
    for match in _MARKS.finditer(text, start, start + _LONGEST):
        at, mark = match.start(), match[0]
        depth += (mark in "([{") - (mark in ")]}")
        if depth < 0 or (depth == 0 and mark == ";"):
            return at
        if depth > _DEEPEST or (depth == 0 and mark == "="):
            return comma if is_c and depth == 0 else start
        if depth == 0 and mark == ",":
            comma = at
        is_line = mark == "\n" and not is_c
        if depth == 0 and is_line and not text.endswith(("...", "\\"), start, at):
            return at
    return start if depth or start + _LONGEST < len(text) else len(text)


@dataclass
class _FileReader:
    """What is known at a place of a file: short names, and the entries of unfinished matrices."""

    is_numpy: bool = False  # whether * is a product entry by entry
    known: dict[str, Any] = field(default_factory=dict)
    entries: dict[str, dict[tuple[int, ...], sp.Expr]] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    run: list[tuple[str, sp.Expr]] = field(default_factory=list)  # scalars in a row

    def read(
        self, line: int, match: re.Match[str], text: str
    ) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
        """One assignment, or what is returned; gives the formulas that are complete with it."""
        names = [name_of(name.strip()) for name in (match["names"] or "returned").split(",")]
        name = names[-1]
        if match["stream"]:
            text = f"[{text}]"
        try:
            value = _shaped(
                read_formula(plain(text, is_numpy=self.is_numpy), self.known, free=True)
            )
        except ExpressionError:
            self.known.pop(name, None)
            return
        if isinstance(self.known.get(text.strip()), sp.MatrixBase):  # found before
            return
        if value.shape == (len(names), 1):
            for each, entry in zip(names, value, strict=True):
                yield from self._assigned(line, each, match["index"], entry)
        elif len(names) > 1:  # w, x, y, z = q: the names are free
            for each in names:
                self.known.pop(each, None)
        else:
            self.known[name] = value
            yield line, name, value

    def _assigned(
        self, line: int, name: str, index: str | None, value: sp.Expr
    ) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
        """A scalar, or an entry of a matrix."""
        if index is None:
            yield from self._scalar(line, name, value)
            return
        place = tuple(int(part) for part in re.findall(r"\d+", index))
        if place in self.entries.get(name, {}):
            yield from self._complete(name)
        self.entries.setdefault(name, {})[place] = value
        self.lines.setdefault(name, line)

    def _scalar(
        self, line: int, name: str, value: sp.Expr
    ) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
        self.known.pop(name, None)
        if _is_short(value) and sp.Symbol(name, real=True) not in value.free_symbols:
            self.known[name] = value
        self.run = [*self.run, (name, value)][-4:]
        for length in (3, 4):
            names = [each for each, _ in self.run[-length:]]
            if len(names) == length and _are_components(names):
                column = sp.ImmutableMatrix([each for _, each in self.run[-length:]])
                yield line, ", ".join(names), column

    def finished(self) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
        for name in list(self.entries):
            yield from self._complete(name)

    def _complete(self, name: str) -> Iterator[tuple[int, str, sp.ImmutableMatrix]]:
        entries, line = self.entries.pop(name), self.lines.pop(name)
        widths = {len(index) for index in entries}
        if len(widths) != 1:
            return
        grid = sorted(entries)
        rows = sorted({index[0] for index in grid})
        columns = sorted({index[-1] for index in grid}) if widths == {2} else [0]
        if len(rows) * len(columns) == len(grid):
            values = [entries[index] for index in grid]
            flat = sp.ImmutableMatrix(len(rows), len(columns), values)
            yield line, name, _shaped(flat)


def _shaped(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Nine, twelve or sixteen numbers in a row are a matrix."""
    is_flat = 1 in matrix.shape and len(matrix) in _SHAPES
    return matrix.reshape(*_SHAPES[len(matrix)]) if is_flat else matrix


def _block(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The rotation in a homogeneous transformation."""
    is_homogeneous = matrix.shape == (4, 4) and tuple(matrix[3, :]) == (0, 0, 0, 1)
    return matrix[:3, :3] if is_homogeneous else matrix


def _is_short(value: sp.Expr) -> bool:
    """Whether a name may stand for this: cos(phi), 2*q0, x[3], but no number and no sum."""
    functions = value.atoms(sp.Function)
    return (
        not value.is_Add
        and not value.is_Symbol
        and not value.is_number
        and all(isinstance(function, _TRIGONOMETRIC) for function in functions)
    )


def _are_components(names: Sequence[str]) -> bool:
    """Whether scalars in a row are one vector: rates, or components of an angular velocity."""
    if tuple(names) in (("p", "q", "r"), ("P", "Q", "R")):
        return True
    last = "".join(name[-1] for name in names)
    is_vector = last in ("xyz", "wxyz", "xyzw") or last in ("012", "123", "0123", "1234")
    same = len({name[:-1] for name in names}) == 1
    return (is_vector and same) or all(map(stem_of, names))


def _may_be_known(matrix: sp.ImmutableMatrix) -> bool:
    """Whether it is worth comparing: sines and cosines, or products of four or more names."""
    if not 0 < len(matrix.free_symbols) <= _MOST_SYMBOLS:
        return False
    if matrix.shape not in ((3, 3), (3, 1), (4, 1), (4, 3), (3, 4), (4, 4)):
        return False
    count = sum(entry.has(*_TRIGONOMETRIC) for entry in matrix)
    if count:
        return count >= (2 if matrix.cols == 1 else 4)
    varied = sum(not entry.is_number for entry in matrix)
    if matrix.shape == (3, 1):  # an angular velocity, or rates, without sines
        return varied == 3 and len(matrix.free_symbols) >= 6
    return len(matrix.free_symbols) >= 3 and varied >= (4 if matrix.cols == 1 else 6)
