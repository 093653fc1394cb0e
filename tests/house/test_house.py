"""The house: data flows one way, nothing forbidden is called on the way, and sizes stay small.

A *room* is a folder of the package, or a file beside the folders. An *arrow* runs from one room
to another if a file of the first imports one of the second; inside a room, the subfolders and the
files beside them take the part of rooms.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
import sympy as sp

import rigidsym
from rigidsym.algebra.integrate import Integrator
from rigidsym.errors import DerivationError
from rigidsym.mechanics.kinematics.workspace import forms
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models.solids import shaped

Arrows = set[tuple[str, str]]
PACKAGE = Path(rigidsym.__file__).parent
ROOT = Path(__file__).resolve().parents[2]

# A room imports only from the rooms above it.
ORDER = (
    *("version", "errors", "system", "text", "formula", "algebra", "data", "models", "mechanics"),
    *("kernels", "simulation", "notes", "page", "motion", "spec", "pipeline", "tools", "commands"),
    "__main__",
)

PATHS = {  # by the module without the name of the package; "" is the package itself
    ".".join(p for p in path.relative_to(PACKAGE).with_suffix("").parts if p != "__init__"): path
    for path in sorted(PACKAGE.rglob("*.py"))
}
TEXTS = {module: path.read_text(encoding="utf-8") for module, path in PATHS.items()}


@cache
def trees() -> dict[str, ast.Module]:
    return {module: ast.parse(text) for module, text in TEXTS.items()}


def imported_by(tree: ast.AST) -> set[str]:
    """Modules of the package that are imported, wherever in the tree."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are written out, from rigidsym on"
            paths = {alias.name: f"{node.module}.{alias.name}" for alias in node.names}
            modules = {path: path.removeprefix("rigidsym.") in PATHS for path in paths.values()}
            names |= {
                path if is_module else str(node.module) for path, is_module in modules.items()
            }
    ours = {name for name in names if name.split(".")[0] == "rigidsym"}
    return {name.removeprefix("rigidsym").removeprefix(".") for name in ours}


@cache
def imports() -> dict[str, set[str]]:
    return {module: imported_by(tree) - {module} for module, tree in trees().items()}


def part_of(module: str, inside: str = "") -> str:
    """The room of a module, or the part of the room `inside`; "" if it is outside."""
    steps = module.split(".")
    depth = len(inside.split(".")) if inside else 0
    within = ".".join(steps[:depth]) == inside and len(steps) > depth
    return steps[depth] if within else ""


def arrows(inside: str = "") -> Arrows:
    """Pairs (part that imports, part imported)."""
    pairs = {
        (part_of(module, inside), part_of(name, inside))
        for module, names in imports().items()
        for name in names
    }
    return {(one, other) for one, other in pairs if one and other and one != other}


def graph(pairs: Arrows) -> dict[str, set[str]]:
    return {one: {other for first, other in pairs if first == one} for one, _ in pairs}


SEARCHES = {
    *("simplify", "trigsimp", "exptrigsimp", "trigsimp_groebner", "futrig", "fu", "ratsimp"),
    *("powsimp", "radsimp", "combsimp", "gammasimp", "besselsimp", "hypersimp", "nsolve"),
}
TEXT_READERS = {"eval", "exec", "compile", "parse_expr", "parse_latex", "lambdify"}


def test_imports_run_one_way():
    assert {part_of(module) for module in PATHS} - {""} == set(ORDER)
    assert {pair for pair in arrows() if ORDER.index(pair[1]) > ORDER.index(pair[0])} == set()


def test_nothing_is_imported_in_a_circle():
    rooms = ["", *sorted({part_of(module) for module in PATHS} - {""})]
    for each in (imports(), *(graph(arrows(room)) for room in rooms)):
        tuple(TopologicalSorter(each).static_order())  # raises CycleError, and names them


def test_kernels_and_notes_know_nothing_of_one_another_nor_the_representation_of_targets():
    assert not arrows() & {("kernels", "notes"), ("notes", "kernels")}
    assert not [name for name in imports()["kernels.ir"] if "targets" in name]


BUDGETS = {  # what was reached; who makes the house smaller lowers them
    "files": 182,
    "lines of code": 24_265,
    "lines of tests": 15_850,
    "lines of benchmarks": 2_500,
}


def test_the_house_keeps_within_its_budgets():
    lines = {
        folder: sum(path.read_text("utf-8").count("\n") for path in (ROOT / folder).rglob("*.py"))
        for folder in ("tests", "benchmarks")
    }
    sizes = {
        "files": len(PATHS),
        "lines of code": sum(map(lines_of_code, TEXTS.values())),
        "lines of tests": lines["tests"],
        "lines of benchmarks": lines["benchmarks"],
    }
    assert {name: size for name, size in sizes.items() if size > BUDGETS[name]} == {}


def lines_of_code(text: str) -> int:
    """Lines that are neither blank nor a comment nor part of a docstring."""
    numbered = enumerate(map(str.strip, text.splitlines()), 1)
    lines = {number for number, line in numbered if line and not line.startswith("#")}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            lines.difference_update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return len(lines)


def test_nothing_is_searched_for_and_no_text_is_run():
    kinds = {ast.Name: "id", ast.Attribute: "attr", ast.alias: "name"}
    for module, tree in trees().items():
        nodes = [*ast.walk(tree)]
        names = {getattr(n, kinds[type(n)]).split(".")[-1] for n in nodes if type(n) in kinds}
        calls = {ast.unparse(node.func) for node in nodes if isinstance(node, ast.Call)}
        plain = {call.removeprefix("sp.").removeprefix("sympy.") for call in calls}
        assert not names & SEARCHES | plain & TEXT_READERS, module


def test_no_error_is_swallowed_unseen():
    for module, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ExceptHandler):
                kinds = "Exception" if node.type is None else ast.unparse(node.type)
                assert not re.search(r"\bException\b", kinds), f"{module}:{node.lineno}"


def test_names_of_the_package_are_found_on_first_use():
    for name in rigidsym.__all__:
        assert getattr(rigidsym, name) is not None
        assert name in dir(rigidsym)
    with pytest.raises(AttributeError, match="'rigidsym' has no attribute 'simplify'"):
        rigidsym.simplify  # noqa: B018


def test_tests_share_only_what_helpers_hold():
    paths = [*(ROOT / "tests").rglob("*.py")]
    own = {p.stem for p in paths} | {p.name for p in (ROOT / "tests").iterdir() if p.is_dir()}
    for path in paths:
        nodes = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
        names = {a.name for node in nodes if isinstance(node, ast.Import) for a in node.names}
        names |= {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}
        shared = {name.split(".")[0] for name in names} & own
        assert shared <= {"helpers"}, path


def test_the_tests_that_ci_names_are_there():
    for path, name in re.findall(r"(tests/\S+\.py)::(\w+)", (ROOT / ".ci/run").read_text("utf-8")):
        assert f"def {name}(" in (ROOT / path).read_text("utf-8")


def exact_proofs(tree: ast.Module) -> list[int]:
    """The lines that construct a Proof without a status that is plainly another."""
    found = []
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        name = ast.unparse(call.func).rpartition(".")[2]
        status = {ast.unparse(each.value) for each in call.keywords if each.arg == "status"}
        if "'exact'" in status or (name == "Proof" and "'unproved'" not in status):
            found.append(call.lineno)
    return found


def test_only_the_door_constructs_exact_proofs():
    found = {module for module, tree in trees().items() if exact_proofs(tree)}
    assert found == {"mechanics.prove"}
    for source in ("derivation.Proof(**given)", 'replace(proof, status="exact")'):
        assert exact_proofs(ast.parse(source)) == [1]


def test_a_wrong_coefficient_of_a_vector_form_is_refused(monkeypatch):
    form = forms()["quaternion", 3]
    one, *others = form.rotation
    wrong = (one, *(coefficient + 1 for coefficient in others))
    monkeypatch.setitem(forms(), ("quaternion", 3), form._replace(rotation=wrong))
    with pytest.raises(DerivationError, match=r"in terms of v.* is false"):
        rigidsym.derive("gibbs_vector", ["angular_velocity_space"])


def test_a_wrong_antiderivative_is_refused(monkeypatch):
    right = Integrator.antiderivative

    def wrong(self, element):
        return right(self, element) + self.codec.encode(self.variable)

    monkeypatch.setattr(Integrator, "antiderivative", wrong)
    with pytest.raises(DerivationError, match="for every integral is false"):
        moments_of(shaped("disc", [sp.Symbol("a")], density=sp.S.One))
