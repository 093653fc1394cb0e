"""Mutants of ring, prover and printers: `run.py mutation --samples 40`. Do tests notice them?

One operator, comparison, sign or constant of a function is changed at a time, and the tests of its
file run in a forked process. A mutant that no test notices survives. Some survivors are no faults:
a cache that is asked for once more, a bound on a search.
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
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from random import Random
from types import CodeType, FunctionType
from typing import Any

import pytest

from benchmarks.measure import ROOT, Settings, progress
from benchmarks.report import Column, Figure, Report, Table

ARITHMETIC = "tests/algebra/test_mutants.py"
RING = (ARITHMETIC, "tests/algebra/test_ring.py", "tests/algebra/test_codec.py")
PRESENT = ("tests/algebra/test_present.py", "tests/algebra/test_codec.py")
PROOFS = ("tests/house/test_one_door_for_proofs.py", "tests/mechanics/test_exactness.py")
READ_BACK = "tests/laws/test_read_back.py::test_{}"
NOTES = [
    f"displays_of_the_note[{r}-{form}]"
    for r in ("quaternion", "davenport")
    for form in ("latex", "html")
]
GOLDEN = "tests/notes/test_notes.py::test_the_note_of_the_lectures_rotation"
FORMULAS = ("tests/notes/test_formula.py", GOLDEN, *map(READ_BACK.format, NOTES))
FUNCTIONS = [f"functions_in_three_languages[{r}]" for r in ("ZXZ", "quaternion", "rotation_vector")]
TESTS: Mapping[str, tuple[str, ...]] = {  # module: the files that test it, the quickest first
    "rigidsym.algebra.ring": RING,
    "rigidsym.algebra.matrix": (*RING, PROOFS[0]),
    "rigidsym.algebra.adjoin": RING,
    "rigidsym.algebra.codec": RING,
    "rigidsym.algebra.shorten": PRESENT,
    "rigidsym.algebra.present": PRESENT,
    "rigidsym.algebra.witness": PROOFS,
    "rigidsym.mechanics.prove": PROOFS,
    "rigidsym.formula.scalars": FORMULAS,
    "rigidsym.formula.latex_pen": FORMULAS,
    "rigidsym.formula.mathml_pen": FORMULAS,
    "rigidsym.kernels.targets.text.infix": (
        *map(READ_BACK.format, FUNCTIONS),
        "tests/kernels/test_lowering.py",
    ),
}
PRINTERS = ("rigidsym.formula.", "rigidsym.kernels.")
SECONDS = 150  # of processor time, after which a mutant has given itself away
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
    code: CodeType

    def __str__(self) -> str:
        return f"{self.module}:{self.line} {self.function}: {self.change}"

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
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [
        Mutant(module, name, node.lineno, change, code)
        for name, function in _functions(tree)
        for place, node in enumerate(ast.walk(function))
        if hasattr(node, "lineno")
        for change, apply in _changes(node)
        if (code := _compiled(tree, path, name, place, apply)) is not None
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
    tree: ast.Module, path: Path, name: str, place: int, apply: Callable[[Any], None]
) -> CodeType | None:
    """The code of a function with one node changed; None if only an annotation or a message is."""
    changed = deepcopy(tree)
    function = dict(_functions(changed))[name]
    node = list(ast.walk(function))[place]
    if any(node in ast.walk(part) for part in _ignored(function)):
        return None
    apply(node)
    whole = compile(ast.fix_missing_locations(changed), str(path), "exec")
    return _code_of(whole, name.split("."))


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


def is_noticed(mutant: Mutant | None, tests: Sequence[str], seconds: int = SECONDS) -> bool:
    """Whether a test fails, or does not end, with the mutant in place of its function."""
    child = os.fork()
    if not child:
        os._exit(_in_child(mutant, tests, seconds))
    _, status = os.waitpid(child, 0)
    return status != 0


def _in_child(mutant: Mutant | None, tests: Sequence[str], seconds: int) -> int:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    try:
        if mutant is not None:
            mutant.install()
        _forget()
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            return int(_pytest("-x", *tests))
    except BaseException:  # whatever a mutant does, it is noticed
        return 1


def _pytest(*arguments: str) -> int:
    fixed = ("-q", "-n", "0", "-p", "no:cacheprovider", "-k", _SKIPPED, "--no-header")
    return int(pytest.main([*fixed, *(str(a) for a in arguments)]))


def _forget() -> None:
    """Nothing that was worked out before the change may hide it."""
    for found in gc.get_objects():
        is_ours = str(getattr(found, "__module__", "")).startswith("rigidsym")
        if is_ours and type(found).__name__ == "_lru_cache_wrapper":
            found.cache_clear()


def survivors(
    module: str, count: int, tests: Sequence[str], seconds: int = SECONDS
) -> tuple[int, list[Mutant]]:
    """How many mutants of a module were tried, at most `count`, and those that no test noticed.

    Raises RuntimeError if the tests fail without a change.
    """
    with redirect_stdout(io.StringIO()):
        _pytest("--collect-only", *tests)  # imported here once, for every child
    if is_noticed(None, tests, 10 * seconds):
        raise RuntimeError(f"{' '.join(tests)} fail without a mutant")
    chosen = Random(module).sample(found := mutants(module), min(count, len(found)))
    left = []
    for number, mutant in enumerate(chosen, 1):
        progress(f"{module}: {number} of {len(chosen)}")
        if not is_noticed(mutant, tests, seconds):
            left.append(mutant)
    return len(chosen), left


def run(settings: Settings) -> Report:
    """A sample of the mutants of each module."""
    tried: dict[str, tuple[int, list[Mutant]]] = {}
    for module, tests in TESTS.items():
        tried[module] = survivors(module, settings.samples, tests)
    return report(tried)


def report(tried: Mapping[str, tuple[int, list[Mutant]]]) -> Report:
    rows = tuple(
        (module, len(mutants(module)), count, count - len(left))
        for module, (count, left) in tried.items()
    )
    columns = (Column("module"), Column("mutants"), Column("tried"), Column("noticed"))
    return Report(
        title="Mutation: one change of ring, prover or printers at a time, against their own tests",
        tables=(Table("Mutants that a test notices", columns, rows),),
        figures=tuple(_figures(tried)),
        notes=tuple(f"survived: {mutant}" for _, left in tried.values() for mutant in left),
    )


def _figures(tried: Mapping[str, tuple[int, list[Mutant]]]) -> Iterator[Figure]:
    for what, is_printer in (("ring and prover", False), ("printers", True)):
        found = [tried[module] for module in tried if module.startswith(PRINTERS) == is_printer]
        total = sum(count for count, _ in found)
        noticed = total - sum(len(left) for _, left in found)
        share = noticed / total if total else 0.0
        yield Figure(
            f"mutants of {what} noticed",
            f"at least {LEAST:.0%}",
            f"{noticed} of {total}, {share:.1%}",
            share >= LEAST,
        )
