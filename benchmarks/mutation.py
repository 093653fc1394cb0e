"""Mutants of ring, prover, lowering and printers: `run.py mutation --samples 40`. Do tests notice?

One operator, comparison, sign or constant of a function is changed at a time, and the tests of its
file run in a forked process until one fails. A mutant that no test notices survives. Mutants that
change no value, such as a bound on a search, are in EQUIVALENT with the reason, and not tried.
"""

from __future__ import annotations

import ast
import gc
import importlib
import io
import os
import resource
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from random import Random
from types import CodeType, FunctionType
from typing import Any, Self

import pytest

from benchmarks.measure import ROOT, Settings, progress
from benchmarks.report import Column, Figure, Report, Table

ARITHMETIC = "tests/algebra/test_mutants.py"
CODEC = "tests/algebra/test_codec.py"
FORMS = f"{CODEC}::test_rings_are_as_they_were"
RING = (ARITHMETIC, "tests/algebra/test_ring.py", CODEC)
PRESENT = (
    "tests/algebra/test_present.py::test_forms_are_as_they_were",
    "tests/algebra/test_present.py",
)
PROOFS = (
    "tests/mechanics/test_exactness_of_prover.py",
    "tests/house/test_one_door_for_proofs.py",
)
LOWERING = ("tests/kernels/test_lowering.py",)
FILES = "tests/kernels/test_kernel_files.py::test_the_files_of_the_lecture"
LOWER = (
    "tests/kernels/test_lower.py",
    "tests/kernels/test_degrees.py::test_derivatives_by_an_angle_of_what_is_per_angle_are_per_degree_squared",
    FILES,
    "tests/kernels/test_singular_kernels.py::test_the_margin_of_a_long_chain_takes_constants_that_only_its_axes_hold",
    "tests/kernels/test_singular_kernels.py::test_no_margin_where_the_rates_never_fail",
)
FORMULAS = ("tests/notes/test_formula.py", "tests/notes/test_pens.py")
_OF_PYTHON = (
    *("numpy.printer", "numpy.unwrap"),
    *("text.python", "text.python_layout"),
)
_OF_C = (
    *("c.printer", "c.function", "c.parts", "c.expected_values", "c.module_files"),
    "text.precision",
)


def _printing(*targets: str) -> tuple[str, ...]:
    """The tests of the files in some languages."""
    tests = "lines_of_every_width_are_broken_as_they_were", "each_target_prints_the_same_lines"
    files = [f"tests/kernels/test_kernel_files.py::test_{test}" for test in tests]
    return tuple(f"{test}[{target}]" for test in (*files, FILES) for target in targets)


TESTS: Mapping[str, tuple[str, ...]] = {  # module: the files that test it, the quickest first
    "rigidsym.algebra.ring": RING,
    "rigidsym.algebra.matrix": (*RING, PROOFS[0]),
    "rigidsym.algebra.generators": (FORMS, CODEC),
    "rigidsym.algebra.codec": (FORMS, CODEC),
    "rigidsym.algebra.shorten": PRESENT,
    "rigidsym.algebra.present": PRESENT,
    "rigidsym.algebra.witness": PROOFS,
    "rigidsym.mechanics.prove": PROOFS,
    "rigidsym.formula.scalars": FORMULAS,
    "rigidsym.formula.latex_pen": FORMULAS,
    "rigidsym.formula.mathml_pen": FORMULAS,
    "rigidsym.formula.pen": FORMULAS,
    "rigidsym.formula.unicode_pen": FORMULAS,
    "rigidsym.formula.sheet_pen": FORMULAS,
    "rigidsym.formula.letters": FORMULAS,
    "rigidsym.kernels.lowering.cse": LOWERING,
    "rigidsym.kernels.lowering.schedule": LOWERING,
    "rigidsym.kernels.lowering.rounding": (
        "tests/kernels/test_guard.py",
        "tests/kernels/test_rounding.py",
        *LOWERING,
    ),
    "rigidsym.kernels.lowering.lower": LOWER,
    "rigidsym.kernels.lowering.trigonometry": ("tests/kernels/test_trigonometry.py",),
    "rigidsym.kernels.targets.text.infix": ("tests/kernels/test_infix.py",),
    **{f"rigidsym.kernels.targets.{m}": _printing("numpy", "numba") for m in _OF_PYTHON},
    **{f"rigidsym.kernels.targets.{module}": _printing("c") for module in _OF_C},
    **{f"rigidsym.kernels.targets.{t}.printer": _printing(t) for t in ("javascript", "jax")},
    "rigidsym.kernels.targets.text.remarks": _printing("c", "numpy", "javascript"),
    "rigidsym.kernels.targets.numba.printer": _printing("numba"),
}
GROUPS = {
    "ring and prover": ("rigidsym.algebra.", "rigidsym.mechanics."),
    "lowering": ("rigidsym.kernels.lowering.",),
    "printers": ("rigidsym.formula.", "rigidsym.kernels.targets."),
}
SECONDS = 300  # of processor time for tests without a mutant
LONGER = 4  # times the time of the tests themselves, after which a mutant has given itself away
LEAST = 0.95
_SKIPPED = "not test_only_the_door and not test_a_change"  # of sources, and of mutants themselves

_OPERATORS: dict[type, type] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Add,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Pow: ast.Mult,
    ast.RShift: ast.LShift,
    ast.LShift: ast.RShift,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
_FUNCTIONS = {"any": "all", "all": "any", "min": "max", "max": "min"}


@dataclass(frozen=True)
class Mutant:
    """One change of one function of a module."""

    module: str
    function: str  # "Ring.reduce"
    line: int
    change: str  # "Add -> Sub"
    text: str  # of the line
    code: CodeType

    def __str__(self) -> str:
        return f"{self.module}:{self.line} {self.function}: {self.change} in {self.text}"

    @property
    def is_equivalent(self) -> bool:
        """Whether it changes no value, by EQUIVALENT."""
        return (self.function, self.change, self.text) in EQUIVALENT

    def install(self) -> None:
        """Put the changed code into the function, wherever that is held already."""
        target: Any = importlib.import_module(self.module)
        *path, name = self.function.split(".")
        for part in path:
            target = getattr(target, part)
        _function(vars(target)[name]).__code__ = self.code


def _function(held: Any) -> FunctionType:
    """The function behind a method, a property or a cache."""
    if isinstance(held, cached_property):
        held = held.func
    if isinstance(held, property):
        held = held.fget
    held = getattr(held, "__func__", held)
    held = getattr(held, "__wrapped__", held)
    assert isinstance(held, FunctionType)
    return held


def mutants(module: str) -> list[Mutant]:
    """All mutants of the functions of a module and of its classes."""
    path = ROOT / f"{module.replace('.', '/')}.py"
    source = path.read_text(encoding="utf-8")
    lines = source.splitlines()
    return [
        Mutant(module, name, node.lineno, change, lines[node.lineno - 1].strip(), code)
        for name, function in _functions(ast.parse(source))
        for ignored in [{id(node) for part in _ignored(function) for node in ast.walk(part)}]
        for place, node in enumerate(ast.walk(function))
        if hasattr(node, "lineno") and id(node) not in ignored
        for change, apply in _changes(node)
        for code in [_compiled(function, path, name, place, apply)]
    ]


def _functions(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef]]:
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node
        elif isinstance(node, ast.ClassDef):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef):
                    yield f"{node.name}.{inner.name}", inner


def _changes(node: ast.AST) -> Iterator[tuple[str, Callable[[Any], None]]]:
    """What may be changed at a node, in words and as a function of a copy of the node."""
    if isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in _OPERATORS:
        other = _OPERATORS[type(node.op)]
        yield f"{type(node.op).__name__} -> {other.__name__}", lambda n: setattr(n, "op", other())
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in _OPERATORS:
        other = _OPERATORS[type(node.ops[0])]
        change = f"{type(node.ops[0]).__name__} -> {other.__name__}"
        yield change, lambda n: n.ops.__setitem__(0, other())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "-x -> +x", lambda n: setattr(n, "op", ast.UAdd())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield (
            "not x -> not not x",
            lambda n: setattr(n, "operand", ast.UnaryOp(ast.Not(), n.operand)),
        )
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield f"{node.value} -> {not node.value}", lambda n: setattr(n, "value", not n.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield f"{node.value} -> {node.value + 1}", lambda n: setattr(n, "value", n.value + 1)
    elif isinstance(node, ast.Name) and node.id in _FUNCTIONS:
        other_name = _FUNCTIONS[node.id]
        yield f"{node.id} -> {other_name}", lambda n: setattr(n, "id", other_name)


def _compiled(
    function: ast.FunctionDef, path: Path, name: str, place: int, apply: Callable[[Any], None]
) -> CodeType:
    """The code of a function with one node changed."""
    changed = deepcopy(function)
    apply(list(ast.walk(changed))[place])
    *classes, _ = parts = name.split(".")
    within: ast.stmt = changed
    for each in classes:
        within = ast.ClassDef(each, bases=[], keywords=[], body=[within], decorator_list=[])
    module = ast.fix_missing_locations(ast.Module([within], type_ignores=[]))
    return _code_of(compile(module, str(path), "exec"), parts)


def _ignored(function: ast.FunctionDef) -> Iterator[ast.AST]:
    """Annotations, decorators, defaults, messages, assertions on lengths."""
    yield from function.decorator_list
    yield function.args
    if function.returns is not None:
        yield function.returns
    for node in ast.walk(function):
        if isinstance(node, ast.Raise | ast.JoinedStr):
            yield node
        elif isinstance(node, ast.AnnAssign):
            yield node.annotation
        elif isinstance(node, ast.keyword) and node.arg == "strict":  # the lengths are the same
            yield node


def _code_of(whole: CodeType, path: Sequence[str]) -> CodeType:
    for name in path:
        whole = next(c for c in whole.co_consts if isinstance(c, CodeType) and c.co_name == name)
    return whole


def is_noticed(mutant: Mutant | None, session: pytest.Session, seconds: int) -> bool:
    """Whether a test fails, or does not end, with the mutant in place of its function."""
    child = os.fork()
    if not child:
        os._exit(_in_child(mutant, session, seconds))
    _, status = os.waitpid(child, 0)
    return status != 0


def _in_child(mutant: Mutant | None, session: pytest.Session, seconds: int) -> int:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    gc.disable()
    try:
        if mutant is not None:
            mutant.install()
        for held in _caches():  # nothing that was worked out before the change may hide it
            held.cache_clear()
        for item, following in zip(session.items, [*session.items[1:], None], strict=True):
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            if session.testsfailed:
                return 1
    except BaseException:  # whatever a mutant does, it is noticed
        return 1
    return 0


@cache
def _caches() -> list[Any]:
    """The caches of the package; found once, since a child that looks copies the whole heap."""
    return [
        found
        for found in gc.get_objects()
        if type(found).__name__ == "_lru_cache_wrapper"
        and str(getattr(found, "__module__", "")).startswith("rigidsym")
    ]


def _of_children() -> float:
    """Seconds of processor time of the processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass
class Trial:
    """Some mutants of a module against its tests, which are collected once."""

    module: str
    tests: Sequence[str]
    count: int  # at most so many are tried
    tried: list[Mutant] = field(default_factory=list)
    left: list[Mutant] = field(default_factory=list)

    def run(self) -> Self:
        """Raises RuntimeError if the tests fail without a change."""
        fixed = ("-q", "-n", "0", "-s", "-p", "no:cacheprovider", "-k", _SKIPPED)
        plain = ("--tb=no", "--assert=plain")  # that it fails is enough
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            status = pytest.main([*fixed, *plain, *self.tests], plugins=[self])
        if status or not self.tried:
            raise RuntimeError(f"{' '.join(self.tests)} fail without a mutant")
        return self

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """In place of the tests: each mutant in a process of its own."""
        _caches()
        gc.freeze()  # what is here already is shared by all children
        before = _of_children()
        if is_noticed(None, session, SECONDS):
            raise pytest.UsageError("the tests fail")
        seconds = 2 + int(LONGER * (_of_children() - before))
        found = [mutant for mutant in mutants(self.module) if not mutant.is_equivalent]
        chosen = Random(self.module).sample(found, min(self.count, len(found)))
        for number, mutant in enumerate(chosen, 1):
            progress(f"{self.module}: {number} of {len(chosen)}")
            self.tried.append(mutant)
            if not is_noticed(mutant, session, seconds):
                self.left.append(mutant)
        return True


def run(settings: Settings) -> Report:
    """A sample of the mutants of each module."""
    return report([Trial(m, tests, settings.samples).run() for m, tests in TESTS.items()])


def report(trials: Sequence[Trial]) -> Report:
    rows = []
    for trial in trials:
        found = mutants(trial.module)
        equivalent = sum(mutant.is_equivalent for mutant in found)
        noticed = len(trial.tried) - len(trial.left)
        rows.append((trial.module, len(found), equivalent, len(trial.tried), noticed))
    heads = ("module", "mutants", "equivalent", "tried", "noticed")
    return Report(
        title="Mutation: one change of ring, prover, lowering or printers at a time",
        tables=(Table("Mutants that a test notices", tuple(map(Column, heads)), tuple(rows)),),
        figures=tuple(_figures(trials)),
        notes=tuple(f"survived: {mutant}" for trial in trials for mutant in trial.left),
    )


def _figures(trials: Sequence[Trial]) -> Iterator[Figure]:
    for what, starts in GROUPS.items():
        group = [trial for trial in trials if trial.module.startswith(starts)]
        total = sum(len(trial.tried) for trial in group)
        noticed = total - sum(len(trial.left) for trial in group)
        share = noticed / total if total else 0.0
        yield Figure(
            f"mutants of {what} noticed",
            f"at least {LEAST:.0%}",
            f"{noticed} of {total}, {share:.1%}",
            share >= LEAST,
        )


_EMPTY = "node 0 is the empty product, which is no factor"
_NEVER_ZERO = "no coefficient of a sum is zero"
_MINUSES = "minuses = sum(c < 0 for c in coefficients) - sum(c > 0 for c in coefficients)"
_WHOLE = (
    "if divisor == 1 and all(n.is_Integer for n in numbers) and _constants_in_all(entries) == 1:"
)
_FLAT = (
    "flat = tuple(sorted(n if k > 0 else ~n for n, k in counted.items() for _ in range(abs(k))))"
)
_PARTLY_DIVIDED = "divided = Counter(f for factors in products for f in set(factors) if f < 0)"
_POWERS = "powers = (p for p in angle.atoms(sp.Pow) if not (p.exp.is_Integer and p.exp > 0))"
_POINTS = "which points are tried first"
_EXPONENT = "base = self if exponent >= 0 else self.inverse()"
EQUIVALENT: Mapping[tuple[str, str, str], str] = {  # function, change, line: why it changes nothing
    (
        "MathmlPen._inline",
        "Gt -> GtE",
        "if piece.width > _INLINE and len(inline_parts(piece)) == len(inline_parts(spoken)):",
    ): "no width is exactly the limit",
    (
        "_constants_in_all",
        "Gt -> GtE",
        "if base.is_Symbol and all(p.is_Integer and p > 0 for p in powers):",
    ): "a base to the power of zero is one",
    ("Quotient.__pow__", "0 -> 1", _EXPONENT): "no factor has to be inverted for the power of zero",
    ("Quotient.__pow__", "GtE -> Gt", _EXPONENT): "as before",
    (
        "Witness.disagrees",
        "Lt -> LtE",
        "if all(-_SMALL < entry < _SMALL for row in rows for entry in row):",
    ): "no value is exactly the limit",
    (
        "Witness.is_nonzero",
        "1 -> 2",
        "for digits, count in ((DIGITS, 1), (DIGITS, _POINTS), (MORE_DIGITS, 1))",
    ): "a point more",
    (
        "Witness.__init__",
        "0 -> 1",
        "self._first = Configuration({}, {}, DIGITS, 0)",
    ): "another point",
    ("Witness._number", "0 -> 1", "total = 0"): "2^-240, far below what counts as zero",
    **{
        ("Witness._configurations", change, "if constraints and count == 1:"): _POINTS
        for change in ("Eq -> NotEq", "And -> Or", "1 -> 2")
    },
    ("Witness.is_nonzero", "Or -> And", "if self._decides or element.is_ground:"): "a shortcut",
    (
        "GeneratorSet._add",
        "GtE -> Gt",
        "if len(self.kinds) >= _MOST_GENERATORS:",
    ): "a bound on the search",
    (
        "Codec._multiple",
        "Gt -> GtE",
        "if abs(times) > _HIGHEST_MULTIPLE:",
    ): "a bound on the work",
    (
        "Codec._whole_power",
        "0 -> 1",
        "if exponent < 0 and 1 / base in self.ring.index:",
    ): "SymPy has no powers with the exponent 0",
    (
        "Codec._product",
        "0 -> 1",
        "elif exponent.is_Integer and exponent > 0 and base in self.ring.index:",
    ): "a factor to the power of one is found before",
    **{
        ("is_uncertain", change, _POWERS): "SymPy has no powers with exponents 0 and 1"
        for change in ("Gt -> GtE", "0 -> 1")
    },
    (
        "folded",
        "Gt -> GtE",
        "present = {place for place, power in enumerate(highest) if power > 0}",
    ): "a rule more, which finds nothing",
    (
        "_best_factor",
        "1 -> 2",
        "powers.setdefault((place, 1 if power > 0 else -1), []).append(abs(power))",
    ): "only its sign is asked for",
    (
        "_neighbours",
        "any -> all",
        "if any(highest[k] < power for k, power in needed):",
    ): "each monomial is asked the same",
    ("_leading_number", "Lt -> LtE", "return -size if lowest < 0 else size"): "it is never zero",
    ("Presenter._cancelled", "Gt -> GtE", "if len(below) > _SHORT_SUM:"): "a bound on the work",
    (
        "Presenter._ratios",
        "Gt -> GtE",
        "above = sine if powers[sine] > 0 else cosine",
    ): "neither power is zero here",
    (
        "Presenter._ratios",
        "0 -> 1",
        "if powers[sine] * powers[cosine] < 0:",
    ): "a tangent to the power of zero is one",
    (
        "Presenter._over_one",
        "Gt -> GtE",
        "if len(above) > 1:",
    ): "the same form twice",
    (
        "Presenter.matrix",
        "False -> True",
        "known = sp.ImmutableMatrix(*matrix.shape, entries, copy=False)  # the list is ours",
    ): "a copy more",
    ("Prover._pullback", "3 -> 4", "for order in range(3):"): "no claim has third derivatives",
    ("Ring.difference", "Or -> And", "if not second or first is second:"): "a shortcut",
    (
        "RingMatrix.gram",
        "1 -> 2",
        "[self.ring.dot(zip(row, other, strict=True)) for other in self.rows[: place + 1]]",
    ): "a product more, which nothing takes",
    (
        "RingMatrix.adjugate",
        "Add -> Sub",
        "tuple(tuple((-1) ** (i + j) * self._minor(j, i).det() for j in places) for i in places),",
    ): "i + j and i - j are both even or both odd",
    (
        "factored",
        "1 -> 2",
        _WHOLE,
    ): "a shortcut",
    (
        "_lines",
        "LtE -> Lt",
        "if len(chunks) == 1 or _width(chunks, blank) <= width:",
    ): "the parts of a line that fits are joined again",
    (
        "_shortened",
        "Or -> And",
        "if not node.args or not node.has(*length.components):",
    ): "a shortcut",
    **{
        (
            "_rates",
            change,
            "found += inside * (int(exponent) if exponent.is_Integer and exponent > 0 else 1)",
        ): "SymPy has no powers with exponents 0 and 1"
        for change in ("Gt -> GtE", "0 -> 1")
    },
    **{
        (function, change, line): _EMPTY
        for function, line, changes in (
            ("Graph.product", "if len(flat) == 1 and flat[0] >= 0:", ("GtE -> Gt", "0 -> 1")),
            (
                "Graph.product",
                "counted[max(factor, ~factor)] += 1 if factor >= 0 else -1",
                ("GtE -> Gt", "0 -> 1"),
            ),
            ("Graph._take_reciprocals", _PARTLY_DIVIDED, ("Lt -> LtE", "0 -> 1")),
            ("_Writer._product", "if factor < 0:", ("Lt -> LtE", "0 -> 1")),
        )
        for change in changes
    },
    (
        "Graph.product",
        "Gt -> GtE",
        _FLAT,
    ): "a node that is counted no time is not written",
    ("_common_scale", "Lt -> LtE", _MINUSES): _NEVER_ZERO,
    ("_common_scale", "Gt -> GtE", _MINUSES): _NEVER_ZERO,
    (
        "_common_scale",
        "Lt -> LtE",
        "is_minus = minuses > 0 or (minuses == 0 and coefficients[0] < 0)",
    ): _NEVER_ZERO,
    (
        "_factor_pairs",
        "Gt -> GtE",
        "squares = {(a, a): times // 2 for a, times in counted.items() if times > 1}",
    ): "a pair that occurs no time",
    (
        "_Writer.weighted",
        "Lt -> LtE",
        "return self._negated(expression) if coefficient < 0 else expression",
    ): "zero is written before",
    ("_Writer._rank", "0 -> 1", "return ((_SUM, 0),)"): "all sums have one rank",
    ("_Writer._rank", "0 -> 1", "return ((_NUMBER, 0),)"): "a product has one number",
    (
        "_interpolated",
        "Add -> Sub",
        "points = [top * (1 + Fraction(cos(angle))) / 2 for angle in angles]",
    ): "the same points, the last first",
    (
        "render",
        "Mult -> Add",
        'series=python.series_entries(kernels, more=2 * _DERIVATIVES) if has_series else "",',
    ): "2 times 2 is 2 plus 2",
    ("_values", "50 -> 51", "numbers.dps = 50"): "a digit more",
    (
        "_entry",
        "LtE -> Lt",
        'return line if len(line) <= _WIDTH else f"  {order}: [\\n{inside}  ],"',
    ): "no series has exactly this width",
    (
        "_Guard._is_positive",
        "Gt -> GtE",
        "factor.value > 0 if isinstance(factor, Number) else factors.count(factor) % 2 == 0",
    ): "no factor is zero",
}
