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
from rigidsym.system.resources import environment
from rigidsym.tools.compare import comparison as comparisons, quantities
from rigidsym.tools.compare.comparison import Comparison, branch, halved, mended
from rigidsym.tools.compare.program import UNNAMED, Formula, program_formulas
from rigidsym.tools.compare.quantities import KnownQuantity, are_angles, are_body_rates
from rigidsym.tools.compare.syntax import GRAMMARS, REMARKS, SHAPES, limits, patterns

_TRIGONOMETRIC = (sp.sin, sp.cos, sp.tan)
# of SymPy or the file system, or by a defect of ours: other files are still read
_FAILURES: tuple[type[Exception], ...] = (ArithmeticError, AssertionError, AttributeError)
_FAILURES += (LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError)

# programs repeat themselves
_identified = lru_cache(maxsize=1024)(partial(comparisons.identified, is_in_program=True))


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
        faults: list[Any] = [*self.comparison.repairs, self.comparison] if self.comparison else []
        places = [each.place for each in faults if each.place]
        own = self.formula.entries or self.formula.lines
        if not places or len(own) not in (len(self.formula.forms[0]), 16):
            return self.formula.line
        columns = 4 if len(own) == 16 else self.formula.forms[0].cols
        return min(own[(row - 1) * columns + column - 1] for row, column in places)

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"

    @property
    def text(self) -> str:
        """The finding without its place; other readings have lines of their own."""
        template = environment().get_template("compare/finding.txt.jinja")
        return str(template.render(finding=self, unread=_in_lines(self.formula.unread)))

    def repeats(self, other: FormulaInFile) -> bool:
        """Whether this vector, or its components, have been found just before."""
        one, two = self.comparison, other.comparison
        if not (one and two) or one.is_wrong > two.is_wrong:
            return False
        places = [(f.function, f.name, f.forms[0].shape) for f in (self.formula, other.formula)]
        if places[0] == places[1] and are_angles(one.formula):  # one may be wrapped to a turn
            return not (one.formula - two.formula).free_symbols
        if sorted(self.formula.lines) == sorted(other.formula.lines):
            return bool(one.formula == two.formula)
        is_near = self.formula.line - other.formula.line <= limits.near_lines
        ends = [(each.formula.function, {*c.formula}) for each, c in ((self, one), (other, two))]
        return is_near and ends[0] == ends[1] and ", " in self.formula.name + other.formula.name

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
        if not path.is_dir() and not (path.is_file() and path.suffix in GRAMMARS):
            raise RequestError(f"{path}: expected a folder, or a file {', '.join(GRAMMARS)}")
    pairs = ((p, f) for p in paths for f in (sorted(p.rglob("*")) if p.is_dir() else [p]))
    shown = (f for p, f in pairs if not any(n.startswith(".") for n in f.relative_to(p).parts))
    files = [f for f in shown if f.suffix in GRAMMARS and f.is_file() and not _is_binary(f)]
    if not files:
        where = ", ".join(map(str, paths))
        raise RequestError(f"{where}: no source files; looked for {', '.join(GRAMMARS)}")
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
    found, text = list[FormulaInFile](), ""
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
    wrong = [each for each in found if each.comparison and each.comparison.is_wrong]
    for finding in found:
        if finding.comparison and (part := _wrong_part(finding, wrong, text)):
            yield FormulaInFile(path, replace(finding.formula, reason=f"it contains {part}"))
        else:
            own = [each for each in found if each.formula.function == finding.formula.function]
            remark = _remark(finding, own, text)
            yield replace(finding, remark="; ".join(filter(None, (finding.remark, remark))))


def _wrong_part(finding: FormulaInFile, wrong: Sequence[FormulaInFile], text: str) -> str:
    """Another wrong matrix in the statement of a wrong one, which is then the only fault.

    Or a wrong vector whose components are names in a formula.
    """
    own, statement = finding.formula, ""
    names = {symbol.name for form in own.forms for symbol in form.free_symbols}
    for line in _lines(text)[own.line - 1 :] if finding in wrong else ():
        statement += line
        if sum(map(statement.count, "([{")) <= sum(map(statement.count, ")]}")):
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
    before = lines[max(0, first - limits.longest_comment) : first - 1]
    above = patterns.comment.search("".join(before))
    inside = patterns.docstring.match("".join(lines[first - 1 : last]))
    comment = (above[1] if above else "") + (inside[0] if inside else "")
    for words, said in (("name", name), ("comment", comment)):
        own = patterns.reference.sub("", said)
        if claims := {_both(match[0]): match[0] for match in patterns.order.finditer(own)}:
            return words, claims
    return "", {}


def _expected(formula: Formula, text: str) -> list[str]:
    """Axes as in "z y x" of the label of a branch, or of words on the function."""
    lines = _lines(text)[max(0, formula.function[1] - 1) : formula.line]
    labels = patterns.order.findall("".join(patterns.label.findall("".join(lines))[-1:]).lower())
    named = [order for own in _claims(formula.function, text)[1] for order in (own, own[::-1])]
    return [*map(" ".join, labels or named)]


def _both(order: str) -> str:
    """An order of axes in a form that is the same for the reversed one.

    ZYX may mean turns about axes of the body, or about those of space, whose product is reversed.
    """
    axes = "".join(re.findall("[xyz]", order.lower().translate(str.maketrans("123", "xyz"))))
    return min(axes, axes[::-1])


def _order(finding: FormulaInFile) -> str:
    """The order of the three axes of a formula; "" if it has none."""
    goal = finding.goal
    axes = _both(goal.axes) if goal and goal.rotation else ""
    return axes if len(axes) == 3 else ""


def _contradiction(one: Comparison, other: Comparison) -> str:
    """How two quaternions from the same matrix contradict one another; "" if they do not."""
    ways = [{*each.found.ways} for each in (one, other) if each.found]
    if {each.found and each.found.rotation for each in (one, other)} != {quantities.OF_MATRIX}:
        return ""
    if len({"by_columns" in own for own in ways}) == 2 - (one.names != other.names):
        return REMARKS["conjugate"]
    return REMARKS["scalar"] * (len({"scalar_last" in own for own in ways}) == 2)


def _with_branches(
    found: Sequence[FormulaInFile], program: Sequence[Formula], text: str
) -> Iterator[FormulaInFile]:
    """Findings with remarks on the domain of arcs, and on branches for poles and small angles.

    A branch that is wrong is a finding of its own. It may follow any of several right formulas. One
    case of Shepperd's method is wrong if it contradicts two others or more.
    """
    right = [(f, f.formula, f.comparison) for f in found if f.comparison and f.comparison.is_equal]
    remarks, verdicts, wrong = dict[int, str](), dict[int, Comparison](), dict[Any, FormulaInFile]()
    for finding, own, regular in right:
        cases = [r for r in right if (r[1].function, r[1].name) == (own.function, own.name)]
        others = {f.line: said for f, _, c in cases if (said := _contradiction(regular, c))}
        if len(others) == len(cases) - 1 > 1:
            said = next(iter(others.values()))
            verdicts[id(finding)] = replace(regular, contradicts=tuple(others), branch=said)
        inside = "".join(_lines(text)[max(0, own.function[1] - 1) : own.function[2] or None])
        # also by a condition on other numbers than the angles, which may be another branch
        common = frozenset.intersection(*own.conditions)
        is_guarded = any(not condition.has(*quantities.INVERSE) for condition in common)
        is_guarded |= own.is_bounded or patterns.guard.search(inside) is not None
        remarks[id(finding)] = "" if is_guarded else comparisons.domain(regular.formula)
    for each in (formula for formula in program if formula.is_final):
        beside = [r for r in right if r[1].function == each.function]
        named = [r for r in beside if each.name == r[1].name or r[1].is_returned & each.is_returned]
        branches = [(f, case) for f, own, regular in named if (case := branch(regular, own, each))]
        for finding, case in sorted(branches, key=lambda judged: judged[1].is_wrong)[:1]:
            line = min({*each.lines} - {*finding.formula.lines} or each.lines)
            parts = f"{remarks[id(finding)]}; the branch in line {line} {case.branch}".split("; ")
            remarks[id(finding)] = "; ".join(dict.fromkeys(filter(None, parts)))
            if case.is_wrong:  # a branch of variables is also one of what they are copied to
                wrong[each.function, case.formula] = FormulaInFile(found[0].path, each, case)
    functions = {function for function, _ in wrong}
    for finding in sorted([*found, *wrong.values()], key=lambda each: each.formula.line):
        remark = remarks.get(id(finding), "") * (finding.formula.function not in functions)
        verdict = verdicts.get(id(finding), finding.comparison)
        yield replace(finding, remark=remark, comparison=verdict)


def _findings(
    path: Path, program: Sequence[Formula], text: str, expected: tuple[str, ...]
) -> Iterator[FormulaInFile]:
    variants: dict[Any, list[Formula]] = {}
    latest: FormulaInFile | None = None
    for formula in program:
        variants.setdefault((formula.line, formula.name, formula.is_end), []).append(formula)
    effort, before = 0, set[Any]()  # for different formulas since the last known one
    for group in variants.values():
        if effort > limits.most_effort:
            reason = "the formulas before it resemble no known one"
            yield FormulaInFile(path, replace(group[0], name="", reason=reason, is_end=True))
            return
        # A formula with the values of all branches may be no quantity, while one branch is.
        is_case = len({each.forms for each in group if each.forms}) > 1
        order = expected or tuple(_expected(group[0], text))
        findings = [_compared(path, each, order, is_case=is_case) for each in group]
        readable = [each for each in findings if each and each.comparison]
        if is_case and not readable:  # a fault that all branches share
            fullest = max(group, key=lambda each: sum(map(_is_formula, [*each.forms, ()][0])))
            regular = _compared(path, fullest, order)
            readable = [regular] if regular and _is_shared(regular.comparison, group) else []
        for finding in [*readable, *filter(None, findings)][:1]:
            # a fault counts once
            if not (latest and finding.repeats(latest)):
                yield finding
            latest = finding if finding.comparison else latest
        new = {form for each in group for form in each.forms if _may_be_known(form)} - before
        before |= new
        effort += sum(limits.effort if form.has(*_TRIGONOMETRIC) else 1 for form in new)
        effort *= not readable


def _is_formula(entry: sp.Expr) -> bool:
    """Not a number or its sign, as at a pole, nor a name that is not read."""
    return not ((entry**2).is_number or entry.is_Symbol)


def _is_shared(comparison: Comparison | None, branches: Sequence[Formula]) -> bool:
    """Whether the wrong entries of a formula are those of all branches that have formulas there."""
    if comparison is None or not comparison.repairs:
        return False
    before, after = comparison.formula, comparison.repairs[-1].formula
    wrong = [k for k, entry in enumerate(before) if entry != after[k]]
    others = [each for b in branches for each in b.forms if each.shape == before.shape]
    return all(own[k] == before[k] or not _is_formula(own[k]) for own in others for k in wrong)


def _compared(
    path: Path, formula: Formula, expected: tuple[str, ...], *, is_case: bool = False
) -> FormulaInFile | None:
    for form in formula.forms:  # a long value may be an angle
        if patterns.angles_name.fullmatch(formula.name) and are_body_rates(form):
            comparison = Comparison(formula=form, asked=None, are_body_rates=True)
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
        if comparison.repairs and comparisons.holds(comparison, formula):
            comparison, is_case = replace(comparison, repairs=(), others=(), is_proved=False), True
        is_twice = goal is not None and "twice_the_angles" in goal.ways and goal.motion.model.turns
        if is_twice and form.free_symbols <= {*formula.names.values()}:  # no sines from elsewhere
            comparison = mended(form, [halved(form, *quantities.symbols_in(form)[0])]) or comparison
        is_last = goal is not None and "scalar_last" in goal.ways
        if goal and len(form) == 4 and formula.scalar == ("first" if is_last else "last"):
            own = comparison.repairs[-1].formula if comparison.repairs else form
            exchanged = sp.ImmutableMatrix([*own[1 + 2 * is_last :], *own[: 1 + 2 * is_last]])
            repair = comparisons.Repair("exchange", REMARKS[formula.scalar], exchanged)
            comparison = replace(comparison, repairs=(*comparison.repairs, repair))
        if goal is not None and formula.is_flat and goal.ways == ("transposed",):
            comparison = replace(comparison, found=replace(goal, ways=("by_columns",)))
        # right matrices of cross products are too many to be worth a line
        is_plain = comparison.is_equal and str(goal) == "cross_product_matrix"
        if (goal is not None and not is_plain) or comparison.is_reflection:
            return FormulaInFile(path, formula, comparison, is_case)
    if formula.unread and any(map(_may_be_known, formula.forms)):
        formula = replace(formula, reason=f"{_in_lines(formula.unread)} cannot be read")
    return FormulaInFile(path, formula) if formula.reason else None


def formulas(text: str, suffix: str) -> Iterator[Formula]:
    """The matrices and vectors that may be one of kinematics, and those that cannot be read."""
    for formula in program_formulas(text, suffix):
        forms = tuple(m for m in map(_block, formula.forms) if len(m.free_symbols))
        line = "".join(_lines(text)[formula.line - 1 : formula.line])
        is_returned = formula.name == UNNAMED[1] and patterns.constructed.match(line)
        if forms or formula.reason:
            name = UNNAMED[0] if is_returned else formula.name
            scalar = formula.scalar or "first" * bool(patterns.scalar_first.search(line))
            yield replace(formula, forms=forms, name=name, scalar=scalar)


def disappointment(comparison: Comparison, expected: str, *, is_active: bool) -> str:
    """How a formula that is right differs from what a user expects; "" if it does not."""
    known = comparison.found
    if known is None or comparison.repairs:
        return ""
    if is_active and "transposed" in known.ways:
        return "expected an active rotation matrix, which takes body to space components"
    if known.quantity == quantities.ANGLES and "of_transpose" not in known.ways:
        known = quantities.target(known.rotation, "rotation_matrix")
    if len(known.axes) != len(expected) or known.axes == expected:
        return ""
    return f"expected the axes {expected} in the product of rotations, not {known.axes}"


def _block(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The rotation in a homogeneous transformation; a row as a column; angles in radians."""
    matrix = matrix.T if matrix.rows == 1 else matrix
    # π mostly converts degrees. With names, or angles, in the other unit it cancels; if it does
    # not in most entries, the formula is left as it is.
    if matrix.has(sp.pi):
        inside = {s for f in matrix.atoms(*_TRIGONOMETRIC) for s in f.free_symbols if f.has(sp.pi)}
        scale = {s: s * 180 / sp.pi for s in inside or matrix.free_symbols}
        has_angles = matrix.shape == (3, 1) and matrix.has(*quantities.INVERSE)
        own = matrix * sp.pi / 180 if has_angles else matrix.xreplace(scale)
        in_radians = own.applyfunc(partial(sp.expand_mul, deep=False)) if has_angles else own
        is_less = in_radians.count(sp.pi) < matrix.count(sp.pi) + has_angles  # 90 becomes π/2
        matrix = in_radians if is_less else matrix
    by_frequency = (s for s in matrix.free_symbols if patterns.frequency.fullmatch(s.name))
    matrix = matrix.xreplace(dict.fromkeys(by_frequency, 1 / sp.Symbol("dt", real=True)))
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
    names, is_vector = len(matrix.free_symbols), matrix.cols == 1
    if matrix.shape not in SHAPES or not 0 < names <= limits.most_symbols * (1 + is_vector):
        return False
    if are_angles(matrix) or are_body_rates(matrix):
        return True
    varied = sum(not entry.is_number for entry in matrix)
    if matrix.has(*_TRIGONOMETRIC):
        return varied >= (2 if is_vector else 4)
    # of three entries without sines, an angular velocity or rates
    fewest = 6 if matrix.shape == (3, 1) else 3
    return names >= fewest and varied >= (matrix.rows if is_vector else 6)
