"""The formulas in source files that are known quantities, or close to one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError, RequestError
from rigidsym.models.rotation import RotationModel
from rigidsym.tools.compare import quantities
from rigidsym.tools.compare.comparison import Comparison, branch, domain, identified
from rigidsym.tools.compare.program import UNNAMED, Formula, program_formulas
from rigidsym.tools.compare.quantities import KnownQuantity, are_angles, are_body_rates
from rigidsym.tools.compare.syntax import GRAMMARS, REMARKS, limits, patterns

SUFFIXES = tuple(GRAMMARS)
_MOST_SYMBOLS = 13  # of the parallel-axis theorem
_NEAR_LINES = 12  # between the components of a vector and the vector
_MOST_EFFORT, _EFFORT = 250, 10  # of unknown formulas in a row, and of one with sines: 0.3 s
_LONGEST_COMMENT = 40  # lines above a function
_AXES = str.maketrans("123", "xyz")
_TRIGONOMETRIC = (sp.sin, sp.cos, sp.tan)
_FAILURES = (  # of SymPy or the file system, or by a defect of ours: other files are still read
    *(ArithmeticError, AssertionError, AttributeError, LookupError, MemoryError),
    *(OSError, RuntimeError, TypeError, ValueError),
)

# programs repeat themselves
_identified = lru_cache(maxsize=1024)(partial(identified, is_in_program=True))


@dataclass(frozen=True, slots=True)
class FormulaInFile:
    """A formula, where it begins, and what it is, unless it cannot be read."""

    path: Path
    formula: Formula
    comparison: Comparison | None = None
    is_case: bool = False  # whether other branches have other values
    remark: str = ""  # what the names in the program say of it
    is_failure: bool = False  # the rest of the file is not read

    @property
    def goal(self) -> KnownQuantity | None:
        """What was found."""
        return self.comparison.found if self.comparison else None

    @property
    def line(self) -> int:
        """Where the first wrong entry is assigned, or else where the formula begins."""
        places = [r.place for r in self.comparison.repairs if r.place] if self.comparison else []
        own, columns = self.formula.lines, self.formula.forms[0].cols if places else 0
        if not places or len(own) != len(self.formula.forms[0]):
            return self.formula.line
        return min(own[(row - 1) * columns + column - 1] for row, column in places)

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"

    @property
    def text(self) -> str:
        """The finding without its place; other readings have lines of their own."""
        name = f"{self.formula.name}: " if self.formula.name else ""
        what = "compared from here on" if self.formula.is_end else "read"
        reason = f"not {what}, since {self.formula.reason}"
        text = self.comparison.text() if self.comparison else reason
        first, *others = text.split("\n")
        first += "; in one of several branches" * self.is_case
        if self.formula.unread and self.comparison:
            first += f"; not read: {_in_lines(self.formula.unread)}"
        first += f"; {self.remark}" * bool(self.remark)
        return "\n".join([name + first, *others])

    def repeats(self, other: FormulaInFile) -> bool:
        """Whether this vector, or its components, have been found just before."""
        if not (self.comparison and other.comparison):
            return False
        own, others = self.comparison.formula, other.comparison.formula
        if sorted(self.formula.lines) == sorted(other.formula.lines):
            return bool(own == others)
        is_near = self.formula.line - other.formula.line <= _NEAR_LINES
        is_near &= self.formula.function == other.formula.function
        has_parts = ", " in self.formula.name + other.formula.name
        return has_parts and is_near and {*own} == {*others}

    def record(self) -> dict[str, Any]:
        """For JSON."""
        place = {"path": str(self.path), "line": self.line, "name": self.formula.name}
        place |= {"unread": dict(self.formula.unread), "remark": self.remark or None}
        return place | (self.comparison.record() if self.comparison else {})


def _in_lines(unread: Sequence[tuple[str, int]]) -> str:
    return ", ".join(f"{name} in line {line}" for name, line in unread)


def source_files(paths: Sequence[Path]) -> Iterator[Path]:
    """The source files among the paths and below them, in order, but no hidden and no binary ones.

    Raises RequestError for a file in another language, and if there are no source files.
    """
    for path in paths:
        if not path.is_dir() and not (path.is_file() and path.suffix in SUFFIXES):
            raise RequestError(f"{path}: expected a folder, or a file {', '.join(SUFFIXES)}")
    files = [
        file
        for path in paths
        for file in (sorted(path.rglob("*")) if path.is_dir() else [path])
        if not any(part.startswith(".") for part in file.relative_to(path).parts)
        if file.suffix in SUFFIXES and file.is_file() and not _is_binary(file)
    ]
    if not files:
        where = ", ".join(map(str, paths))
        raise RequestError(f"{where}: no source files; looked for {', '.join(SUFFIXES)}")
    yield from dict.fromkeys(files)


def _is_binary(file: Path) -> bool:
    """Whether a file with the suffix of a program is none, as `file` tells it."""
    with suppress(OSError), file.open("rb") as start:  # `search` says what cannot be opened
        return b"\0" in start.read(1024)
    return False


def search(path: Path, expected: tuple[str, ...] = ()) -> Iterator[FormulaInFile]:
    """The formulas of a file that are a known quantity or close to one, and unreadable ones.

    Of several rotations close to one, that about the `expected` axes, such as "z y x", or those
    that its function names, is preferred. If reading fails, the last one says so.
    """
    found: list[FormulaInFile] = []
    text = ""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            text = file.read(limits.longest_file + 1)
        program = [*formulas(text, path.suffix)]
        found.extend(_findings(path, program, text, expected))  # keeps what is before an error
        found = [*_with_branches(found, program, text)]
    except _FAILURES as error:
        reason = f"there was an error in reading it: {type(error).__name__}: {error}"
        whole = Formula(lines=(1,), name="", reason=reason)
        found.append(FormulaInFile(path, whole, is_failure=True))
    of_functions: dict[tuple[str, int, int], list[FormulaInFile]] = {}
    for finding in found:
        of_functions.setdefault(finding.formula.function, []).append(finding)
    wrong = [each for each in found if each.comparison and each.comparison.is_wrong]
    for finding in found:
        if finding.comparison and (part := _wrong_part(finding, wrong, text)):
            yield FormulaInFile(path, replace(finding.formula, reason=f"it contains {part}"))
        else:
            remark = _remark(finding, of_functions[finding.formula.function], text)
            yield replace(finding, remark="; ".join(filter(None, (finding.remark, remark))))


def _wrong_part(finding: FormulaInFile, wrong: Sequence[FormulaInFile], text: str) -> str:
    """Another wrong matrix in the statement of a wrong one, which is then the only fault.

    Or a wrong vector whose components are names in a formula.
    """
    own, depth, statement = finding.formula, 0, ""
    names = {symbol.name for form in own.forms for symbol in form.free_symbols}
    for line in _lines(text)[own.line - 1 :] if finding in wrong else ():
        statement += line
        depth += sum((letter in "([{") - (letter in ")]}") for letter in line)
        if depth <= 0:
            break
    for formula in (each.formula for each in wrong):
        name, end = formula.name, r"\b"
        is_other = formula.line < own.line and name != own.name
        if formula.function[0] and formula.function != own.function:
            name, end, is_other = formula.function[0], r"\s*\(", True
        is_inside = re.search(rf"\b{re.escape(name)}{end}", statement) is not None
        if is_other and (is_inside or names >= {*name.split(", ")}):
            return f"{name}, which is wrong in line {formula.line}"
    return ""


def _remark(finding: FormulaInFile, others: Sequence[FormulaInFile], text: str) -> str:
    """How the name of a function or its comment differ from what its formulas are."""
    (name, first, last), goal = finding.formula.function, finding.goal
    if goal is None or not name:
        return ""
    if goal.quantity == "quaternion_product" and [*map(len, goal.inputs.values())] != [4, 4]:
        own = finding.formula.name.partition(", ")[0]
        is_rate = patterns.derivative.search(name) is not None
        is_rate |= own not in UNNAMED and quantities.stem_of(own) != ""
        is_half = patterns.half.search("".join(_lines(text)[first - 1 : last])) is not None
        return REMARKS["rate"] * (is_rate and not is_half)
    (words, claims), own = _claims(finding.formula.function, text), _order(finding)
    is_certain = len(claims) == 1 and {*map(_order, others)} - {""} == {own}
    said = f"the {words} of {name} says {', '.join(claims.values())}"
    return f"{said}, the formula is {goal.rotation}" * (is_certain and own not in claims)


@lru_cache(maxsize=1)
def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


@lru_cache(maxsize=64)
def _claims(function: tuple[str, int, int], text: str) -> tuple[str, dict[str, str]]:
    """Orders of axes, each as it is written, in the name of a function or in its comment."""
    name, first, last = function
    if not name:
        return "", {}
    lines = _lines(text)
    above = patterns.comment.search("".join(lines[max(0, first - _LONGEST_COMMENT) : first - 1]))
    inside = patterns.docstring.match("".join(lines[first - 1 : last]))
    comment = (above[1] if above else "") + (inside[0] if inside else "")
    for words, said in (("name", name), ("comment", comment)):
        if claims := {_both(match[0]): match[0] for match in patterns.order.finditer(said)}:
            return words, claims
    return "", {}


def _both(order: str) -> str:
    """An order of axes in a form that is the same for the reversed one.

    ZYX may mean turns about axes of the body, or about those of space, whose product is reversed.
    """
    axes = "".join(re.findall("[xyz]", order.lower().translate(_AXES)))
    return min(axes, axes[::-1])


def _order(finding: FormulaInFile) -> str:
    """The order of the three axes of a formula; "" if it has none."""
    goal = finding.goal
    axes = _both(goal.axes) if goal and goal.rotation else ""
    return axes if len(axes) == 3 else ""


def _with_branches(
    found: Sequence[FormulaInFile], program: Sequence[Formula], text: str
) -> Iterator[FormulaInFile]:
    """Findings with remarks on the domain of arcs, and on branches for poles and small angles.

    A branch that is wrong is a finding of its own. It may follow any of several right formulas.
    """
    right = [(f, f.formula, f.comparison) for f in found if f.comparison and f.comparison.is_equal]
    remarks, wrong = dict[int, str](), dict[Any, FormulaInFile]()
    for finding, own, regular in right:
        inside = "".join(_lines(text)[max(0, own.function[1] - 1) : own.function[2] or None])
        remarks[id(finding)] = "" if patterns.guard.search(inside) else domain(regular.formula)
    for each in (formula for formula in program if formula.is_final):
        beside = [r for r in right if (r[1].function, r[1].name) == (each.function, each.name)]
        cases = [(id(f), branch(regular, own, each)) for f, own, regular in beside]
        known = [(key, case) for key, case in cases if case]
        for key, case in sorted(known, key=lambda c: c[1].is_wrong)[:1]:
            said = f"its branch in line {each.line} {case.branch}"
            remarks[key] = "; ".join(dict.fromkeys(filter(None, (remarks[key], said))))
            if case.is_wrong:  # a branch of variables is also one of what they are copied to
                wrong[each.function, case.formula] = FormulaInFile(found[0].path, each, case)
    functions = {function for function, _ in wrong}
    for finding in sorted([*found, *wrong.values()], key=lambda each: each.formula.line):
        is_right = finding.formula.function not in functions
        yield replace(finding, remark=remarks.get(id(finding), "") * is_right)


def _findings(
    path: Path, program: Sequence[Formula], text: str, expected: tuple[str, ...]
) -> Iterator[FormulaInFile]:
    variants: dict[Any, list[Formula]] = {}
    latest: FormulaInFile | None = None
    for formula in program:
        variants.setdefault((formula.line, formula.name, formula.is_end), []).append(formula)
    effort, before = 0, set[Any]()  # for different formulas since the last known one
    for group in variants.values():
        if effort > _MOST_EFFORT:
            reason = "the formulas before it resemble no known one"
            yield FormulaInFile(path, replace(group[0], name="", reason=reason, is_end=True))
            return
        # A formula with the values of all branches may be no quantity, while one branch is.
        is_case = len({each.forms for each in group if each.forms}) > 1
        named = [order for own in _claims(group[0].function, text)[1] for order in (own, own[::-1])]
        order = expected or tuple(map(" ".join, named))
        findings = [_compared(path, each, order, is_case=is_case) for each in group]
        readable = [each for each in findings if each and each.comparison]
        for finding in [*readable, *filter(None, findings)][:1]:
            if latest is None or not finding.repeats(latest):  # a fault counts once
                yield finding
            latest = finding if finding.comparison else latest
        new = {form for each in group for form in each.forms if _may_be_known(form)} - before
        before |= new
        effort += sum(_EFFORT if form.has(*_TRIGONOMETRIC) else 1 for form in new)
        effort *= not readable


def _compared(
    path: Path, formula: Formula, expected: tuple[str, ...], *, is_case: bool
) -> FormulaInFile | None:
    for form in formula.forms:  # a long value may be an angle
        if patterns.angles_name.fullmatch(formula.name) and are_body_rates(form):
            asked = quantities.target("xyz", "rates_from_angular_velocity_body")
            comparison = Comparison(formula=form, asked=asked, are_body_rates=True)
            return FormulaInFile(path, formula, comparison)
        if not _may_be_known(form):
            continue
        try:
            is_equal = is_case or not formula.is_final
            comparison = _identified(form, only_equal=is_equal, expected=expected)
        except (ExpressionError, RecursionError) as error:  # a function without values
            return FormulaInFile(path, replace(formula, reason=str(error)))
        goal = comparison.found
        if any(formula.computed.get(name, x) != x for name, x in comparison.supposed.items()):
            continue
        if goal is not None and formula.is_flat and goal.arrangement == quantities.PASSIVE:
            goal = replace(goal, arrangement=quantities.PASSIVE_OR_BY_COLUMNS)
            comparison = replace(comparison, found=goal)
        if goal is not None or comparison.is_reflection:
            return FormulaInFile(path, formula, comparison, is_case)
    if formula.unread and any(map(_may_be_known, formula.forms)):
        formula = replace(formula, reason=f"{_in_lines(formula.unread)} cannot be read")
    return FormulaInFile(path, formula) if formula.reason else None


def formulas(text: str, suffix: str) -> Iterator[Formula]:
    """The matrices and vectors that may be one of kinematics, and those that cannot be read."""
    for formula in program_formulas(text, suffix):
        forms = tuple(m for m in map(_block, formula.forms) if len(m.free_symbols))
        if forms or formula.reason:
            yield replace(formula, forms=forms)


def disappointment(
    comparison: Comparison, expected: RotationModel | None, *, is_active: bool
) -> str:
    """How a formula that is right differs from what a user expects; "" if it does not."""
    known = comparison.found
    if known is None or comparison.repairs:
        return ""
    if is_active and quantities.PASSIVE in comparison.arrangement:
        return "expected an active rotation matrix, which takes body to space components"
    if known.quantity == quantities.ANGLES and "transposed" not in known.arrangement:
        known = quantities.target(known.rotation, "rotation_matrix")
    model = known.motion.model
    if expected is None or len(model.turns) != len(expected.turns):
        return ""
    wanted, axes = (" ".join(turn.axis for turn in each.turns) for each in (expected, model))
    return f"expected the axes {wanted} in the product of rotations, not {axes}" * (wanted != axes)


def _block(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The rotation in a homogeneous transformation; a row as a column; angles in radians."""
    matrix = matrix.T if matrix.rows == 1 else matrix
    # π mostly converts degrees. With names, or angles, in the other unit it cancels; if it does
    # not in most entries, the formula is left as it is.
    if matrix.has(sp.pi):
        scale = {s: s * 180 / sp.pi for s in matrix.free_symbols}
        has_angles = matrix.shape == (3, 1) and matrix.has(sp.atan2, sp.asin, sp.acos, sp.atan)
        in_radians = matrix * sp.pi / 180 if has_angles else matrix.xreplace(scale)
        is_less = in_radians.count(sp.pi) < matrix.count(sp.pi) + has_angles  # 90 becomes π/2
        matrix = in_radians if is_less else matrix
    step = next((s for s in matrix.free_symbols if patterns.step.fullmatch(s.name)), None)
    # Of q + (...)*dt, but not of g - w - (...)*dt. Derivatives of long expressions are expensive.
    if step is not None and not any(f.has(step) for f in matrix.atoms(sp.Function, sp.Pow)):
        is_sum = any(entry.is_Add for entry in matrix.xreplace({step: sp.S.Zero}))
        rates = matrix if is_sum else matrix.applyfunc(lambda entry: entry.diff(step))
        matrix = matrix if rates.has(step) else rates
    edges = (tuple(matrix[-1, :]), tuple(matrix[:, -1]))  # by rows, or by columns
    is_homogeneous = matrix.shape == (4, 4) and (0, 0, 0, 1) in edges
    is_homogeneous |= matrix.shape == (3, 4) and matrix[:, 3].is_zero_matrix is True
    return matrix[:3, :3] if is_homogeneous else matrix


def _may_be_known(matrix: sp.ImmutableMatrix) -> bool:
    """Whether it is worth comparing: sines and cosines, or products of four or more names."""
    if not 0 < len(matrix.free_symbols) <= _MOST_SYMBOLS * (1 + (matrix.cols == 1)):
        return False
    if are_angles(matrix) or are_body_rates(matrix):
        return True
    if matrix.shape not in ((3, 3), (3, 1), (4, 1), (4, 3), (3, 4), (4, 4)):
        return False
    varied = sum(not entry.is_number for entry in matrix)
    if matrix.has(*_TRIGONOMETRIC):
        return varied >= (2 if matrix.cols == 1 else 4)
    if matrix.shape == (3, 1):  # an angular velocity, or rates, without sines
        return varied == 3 and len(matrix.free_symbols) >= 6
    return len(matrix.free_symbols) >= 3 and varied >= (4 if matrix.cols == 1 else 6)
