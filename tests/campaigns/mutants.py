"""Do the tests notice a change of the program? `python tests/campaigns/mutants.py --count 200`.

One operator, constant, comparison, order of arguments or result of a statement is changed at a
time, and the tests that execute this statement run in a forked process until one fails, the
quickest first. A seed draws the same changes as long as the package stays as it is. The tests are
found with the coverage of every test, which a run of the suite writes:

    python -m pytest --cov=rigidsym --cov-context=test --cov-report= --junitxml=times.xml
"""

from __future__ import annotations

import argparse
import ast
import importlib
import os
import random
import resource
import sys
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from itertools import accumulate
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
IMPORTED_ONCE = "sympy numpy scipy.integrate scipy.spatial.transform jinja2 click rich.table mpmath"
OTHER: dict[type[ast.AST], type[ast.AST]] = {
    **{ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.Div: ast.Mult},
    **{ast.Pow: ast.Mult, ast.FloorDiv: ast.Mult, ast.And: ast.Or, ast.Or: ast.And},
    **{ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE},
    **{ast.GtE: ast.Gt, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot},
    **{ast.IsNot: ast.Is, ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr},
}


@dataclass(frozen=True)
class Mutant:
    """A change of one node of a statement."""

    path: Path
    statement: int  # among those of the file
    node: int  # among those of the statement
    about: str  # where it is, and the expressions with the change


def statements(node: ast.AST, scope: str = "") -> Iterator[tuple[str, ast.stmt, list[ast.expr]]]:
    """Every statement with the function around it and its own expressions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt):
            skipped = {id(getattr(child, "annotation", None)), id(getattr(child, "returns", None))}
            parts = [n for n in ast.iter_child_nodes(child) if id(n) not in skipped]
            own = [n for n in parts if isinstance(n, ast.expr)]
            own += [item.context_expr for item in getattr(child, "items", [])]
            is_text = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
            if own and not is_text and not isinstance(child, ast.Raise):
                yield scope, child, own
        is_scope = isinstance(child, ast.FunctionDef | ast.ClassDef)
        yield from statements(child, f"{scope}.{child.name}".strip(".") if is_scope else scope)


def changed(node: ast.expr) -> bool:
    """Change a node in place, if there is something to change."""
    match node:
        case ast.BinOp(op=operator) | ast.BoolOp(op=operator) if type(operator) in OTHER:
            node.op = OTHER[type(operator)]()
        case ast.Compare(ops=[operator, *rest]):
            node.ops = [OTHER[type(operator)](), *rest]
        case ast.UnaryOp(op=ast.USub()):
            node.op = ast.UAdd()
        case ast.Constant(value=bool(value)):
            node.value = not value
        case ast.Constant(value=int(value) | float(value)):
            node.value = value + 1
        case ast.Constant(value=str(value)) if value:
            node.value = f"{value}_"
        case ast.IfExp(body=one, orelse=other):
            node.body, node.orelse = other, one
        case ast.Call(args=[one, other, *rest]) if not isinstance(one, ast.Starred):
            node.args = [other, one, *rest]
        case _:
            return False
    return True


def mutants(package: Path) -> Iterator[Mutant]:
    for path in sorted(package.rglob("*.py")):
        for place, (function, _, own) in enumerate(statements(ast.parse(path.read_text("utf-8")))):
            nodes = [node for part in own for node in ast.walk(part)]
            in_text = {id(n) for f in nodes if isinstance(f, ast.JoinedStr) for n in ast.walk(f)}
            for k, node in enumerate(nodes):
                copies = deepcopy(own)
                copy = [n for part in copies for n in ast.walk(part)][k]
                if id(node) not in in_text and isinstance(copy, ast.expr) and changed(copy):
                    where = f"{path.relative_to(package).as_posix()}:{function}"
                    yield Mutant(path, place, k, f"{where} | {'; '.join(map(ast.unparse, copies))}")


def applied(mutant: Mutant) -> tuple[ast.Module, range]:
    """The module with the change, and the lines that it had."""
    tree = ast.parse(mutant.path.read_text("utf-8"))
    _, node, own = [*statements(tree)][mutant.statement]
    changed([n for part in own for n in ast.walk(part)][mutant.node])
    return tree, range(node.lineno, max(part.end_lineno or 0 for part in own) + 1)


@dataclass(frozen=True)
class Changed(SourceFileLoader):
    """Imports one module with a change."""

    name: str
    path: str
    tree: ast.Module

    def get_code(self, fullname: str) -> object:  # noqa: ARG002
        return compile(self.tree, self.path, "exec")

    def find_spec(self, name: str, *_: object) -> ModuleSpec | None:
        return spec_from_file_location(name, self.path, loader=self) if name == self.name else None


class Tests:
    """Which tests execute a line, the quickest first."""

    def __init__(self, coverage: Path, times: Path) -> None:
        from coverage import CoverageData

        self.data = CoverageData(str(coverage))
        self.data.read()
        self.seconds: dict[str, float] = {}
        for case in ElementTree.parse(times).getroot().iter("testcase"):
            name = f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}"
            if case.find("failure") is None:  # what fails without a change notices none
                self.seconds[name] = float(case.get("time", 0))

    def of(self, path: Path, lines: range, most: float) -> list[str]:
        """Those of the lines, or of the whole file for what runs when it is imported."""
        by_line = self.data.contexts_by_lineno(str(path))
        found = {n.partition("|")[0] for line in lines for n in by_line.get(line, ()) if n}
        names = found or {n.partition("|")[0] for each in by_line.values() for n in each if n}
        quickest = sorted(names & self.seconds.keys(), key=lambda name: self.seconds[name])
        ends = accumulate(0.02 + self.seconds[name] for name in quickest)
        return [name for name, end in zip(quickest, ends, strict=True) if end < most]


@dataclass(frozen=True)
class QuickestFirst:
    """Of all tests in their files, those of a mutant in their order."""

    names: list[str]

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        order = {name: k for k, name in enumerate(self.names)}
        chosen = [item for item in items if item.nodeid in order]
        items[:] = sorted(chosen, key=lambda item: order[item.nodeid])


def is_noticed(loader: Changed, names: list[str], limit: int) -> bool:
    """Whether one of the tests fails, or never ends, in a process of its own."""
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        os.chdir(ROOT)
        sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
        sys.meta_path.insert(0, loader)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        os.environ["PYTHONPATH"] = str(ROOT)
        files = sorted({name.partition("::")[0] for name in names})
        options = ["-qx", "-n0", "-m", "", "-p", "no:cacheprovider"]
        os._exit(int(pytest.main([*options, *files], plugins=[QuickestFirst(names)])))
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert code != pytest.ExitCode.NO_TESTS_COLLECTED, names  # the coverage is of other tests
    return code != 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=26)
    parser.add_argument("--most", type=float, default=12, help="seconds of tests for a mutant")
    options = parser.parse_args()
    chosen = random.Random(options.seed).sample([*mutants(ROOT / "rigidsym")], options.count)
    for name in IMPORTED_ONCE.split():
        importlib.import_module(name)
    tests, count = Tests(ROOT / ".coverage", ROOT / "times.xml"), Counter[str]()
    for mutant in chosen:
        tree, lines = applied(mutant)
        names = tests.of(mutant.path, lines, options.most)
        module = ".".join(mutant.path.relative_to(ROOT).with_suffix("").parts)
        loader = Changed(module.removesuffix(".__init__"), str(mutant.path), tree)
        limit = 30 + 5 * int(sum(tests.seconds[name] for name in names))
        word = "noticed" if names and is_noticed(loader, names, limit) else "missed"
        count[word] += 1
        print(f"{word} | {mutant.about}", flush=True)
    print(*(f"{word}: {number}" for word, number in count.most_common()), sep="\n")


if __name__ == "__main__":
    main()
