"""The house: data flows one way, and nothing forbidden is called on the way."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import rigidsym
from house.figures import ORDER, ROOT, House, circles, lines_of_code, upward

HOUSE = House(Path(rigidsym.__file__).parent)
SIBLINGS = (("kernels", "notes"),)  # neither knows of the other

SEARCHES = {
    "simplify",
    "trigsimp",
    "exptrigsimp",
    "trigsimp_groebner",
    "futrig",
    "fu",
    "ratsimp",
    "powsimp",
    "radsimp",
    "combsimp",
    "gammasimp",
    "besselsimp",
    "hypersimp",
    "nsolve",
}
TEXT_READERS = {"eval", "exec", "compile", "parse_expr", "parse_latex", "lambdify"}


# rooms and arrows


def test_imports_run_one_way():
    assert HOUSE.rooms() == set(ORDER)
    assert upward(HOUSE.arrows()) == set()


@pytest.mark.parametrize(
    ("arrow", "is_upward"),
    [
        (("errors", "algebra"), True),
        (("algebra", "errors"), False),
        (("models", "mechanics"), True),
        (("commands", "pipeline"), False),
    ],
)
def test_an_arrow_the_other_way_is_seen(arrow, is_upward):
    assert bool(upward({arrow})) is is_upward


def test_no_file_imports_itself_in_a_circle():
    tuple(TopologicalSorter(HOUSE.imports).static_order())  # raises CycleError, and names them


def test_no_two_rooms_or_subfolders_need_each_other():
    assert circles(HOUSE) == []


def test_circles_of_parts_are_seen(tmp_path):
    for name, text in {
        "a/x": "from house.b import y",
        "b/y": "",
        "b/z": "import house.a.x",
    }.items():
        path = tmp_path / "house" / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    house = House(tmp_path / "house")
    assert house.arrows() == {("a", "b"), ("b", "a")}
    assert len(circles(house)) == 1
    assert house.imports["a.x"] == {"b.y"}
    (tmp_path / "house/b/z.py").write_text("")
    assert circles(House(tmp_path / "house")) == []


@pytest.mark.parametrize("rooms", SIBLINGS, ids=" and ".join)
def test_siblings_do_not_import_one_another(rooms):
    assert not HOUSE.arrows() & {rooms, rooms[::-1]}


def test_kernels_import_their_representation_and_not_the_reverse():
    assert not [name for name in HOUSE.imports["kernels.ir"] if "targets" in name]


# sizes

BUDGETS = {  # what was reached; who makes the house smaller lowers them
    "files": 223,
    "lines of code": 32_970,
    "lines of tests": 27_480,
    "lines of benchmarks": 2_700,
}


def test_the_house_keeps_within_its_budgets():
    lines = {
        folder: sum(path.read_text("utf-8").count("\n") for path in (ROOT / folder).rglob("*.py"))
        for folder in ("tests", "benchmarks")
    }
    sizes = {
        "files": len(HOUSE.sources),
        "lines of code": sum(map(lines_of_code, HOUSE.texts.values())),
        "lines of tests": lines["tests"],
        "lines of benchmarks": lines["benchmarks"],
    }
    assert {name: size for name, size in sizes.items() if size > BUDGETS[name]} == {}


# what is called


def names_in(tree: ast.AST) -> set[str]:
    """Every name, attribute and imported name of a file."""
    found = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    found |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    return found | {alias.name.split(".")[-1] for node in imports for alias in node.names}


def test_nothing_is_searched_for():
    found = {module: names_in(tree) & SEARCHES for module, tree in HOUSE.trees.items()}
    assert not {module: names for module, names in found.items() if names}


def called_by_name(tree: ast.AST) -> set[str]:
    """Functions called by a bare name, and methods of sympy called on it."""
    calls = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    bare = {call.id for call in calls if isinstance(call, ast.Name)}
    of_sympy = {
        call.attr
        for call in calls
        if isinstance(call, ast.Attribute)
        and isinstance(call.value, ast.Name)
        and call.value.id in {"sp", "sympy"}
    }
    return bare | of_sympy


def test_no_text_is_run():
    found = {module: called_by_name(tree) & TEXT_READERS for module, tree in HOUSE.trees.items()}
    assert not {module: names for module, names in found.items() if names}


def test_no_error_is_swallowed_unseen():
    handlers = [
        (module, node)
        for module, tree in HOUSE.trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ExceptHandler)
    ]
    assert len(handlers) > 50
    for module, handler in handlers:
        assert handler.type is not None, f"{module}:{handler.lineno}: a bare except"
        assert "Exception" not in {
            node.id for node in ast.walk(handler.type) if isinstance(node, ast.Name)
        }, f"{module}:{handler.lineno}: except Exception"


def loaded_by(statement: str) -> set[str]:
    """The modules that are loaded once a fresh interpreter has run a statement."""
    run = subprocess.run(
        [sys.executable, "-c", f"{statement}; import sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(run.stdout.split())


@pytest.mark.parametrize(
    "statement",
    ["import rigidsym", "import rigidsym; rigidsym.__version__; dir(rigidsym)"],
)
def test_importing_the_package_loads_neither_sympy_nor_numpy(statement):
    loaded = loaded_by(statement)
    assert "rigidsym" in loaded
    assert not loaded & {"sympy", "numpy", "mpmath", "jinja2", "rich"}


def test_names_of_the_package_are_found_on_first_use():
    assert "sympy" in loaded_by("import rigidsym; rigidsym.EulerAngles")
    for name in rigidsym.__all__:
        assert getattr(rigidsym, name) is not None
        assert name in dir(rigidsym)
    with pytest.raises(AttributeError, match="'rigidsym' has no attribute 'simplify'"):
        rigidsym.simplify  # noqa: B018


# tests


TESTS = Path(__file__).resolve().parents[1]


def test_tests_share_only_what_helpers_hold():
    paths = [*TESTS.rglob("*.py")]
    own = {p.stem for p in paths} | {p.name for p in TESTS.iterdir() if p.is_dir()}
    for path in paths:
        nodes = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
        names = {a.name for node in nodes if isinstance(node, ast.Import) for a in node.names}
        names |= {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}
        shared = {name.split(".")[0] for name in names} & own
        allowed = {"helpers", "house"} if path.parent.name == "house" else {"helpers"}
        assert shared <= allowed, path
