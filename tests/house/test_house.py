"""The house: data flows one way, and nothing forbidden is called on the way."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import rigidsym

PACKAGE = Path(rigidsym.__file__).parent

# A room imports only from the rooms above it. Inside a room the only rule is that no circle forms.
ORDER = (
    "version",
    "errors",
    "system",
    "text",
    "algebra",
    "data",
    "models",
    "mechanics",
    "kernels",
    "notes",
    "page",
    "spec",
    "motion",
    "pipeline",
    "tools",
    "commands",
)
SIBLINGS = (("kernels", "notes"),)  # neither has to know of the other

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


def module_of(path: Path) -> str:
    """`algebra.ring` for rigidsym/algebra/ring.py; "" for the package itself."""
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix("__init__")


SOURCES = {module_of(path).removesuffix("."): path for path in sorted(PACKAGE.rglob("*.py"))}
TREES = {module: ast.parse(path.read_text(encoding="utf-8")) for module, path in SOURCES.items()}


def imports_of(tree: ast.AST) -> set[str]:
    """Modules of this package that a file imports, wherever in the file; "" is the package."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are written out, from rigidsym on"
            found |= {_imported(node.module or "", alias.name) for alias in node.names}
    ours = {name for name in found if name.split(".")[0] == "rigidsym"}
    return {name.removeprefix("rigidsym").removeprefix(".") for name in ours}


def _imported(module: str, name: str) -> str:
    """A submodule, where the name imported is one."""
    path = f"{module}.{name}".removeprefix("rigidsym.")
    return f"{module}.{name}" if path in SOURCES and module.startswith("rigidsym") else module


def room_of(module: str) -> int:
    """The place of a module's room in the order."""
    room = floor_of(module)
    assert room in ORDER, f"{module}: give its room a place in ORDER"
    return ORDER.index(room)


def floor_of(module: str) -> str:
    return module.split(".")[0]


def backward_arrows(module: str, imported: set[str]) -> list[str]:
    """The imports of a module that run against the order."""
    return [name for name in sorted(imported) if room_of(name) > room_of(module)]


@pytest.mark.parametrize("module", [module for module in SOURCES if module])
def test_imports_run_one_way(module):
    imported = imports_of(TREES[module]) - {""}  # the package itself holds the version alone
    assert backward_arrows(module, imported) == []


@pytest.mark.parametrize(
    ("module", "name", "is_backward"),
    [
        ("errors", "algebra.ring", True),
        ("algebra.codec", "algebra.ring", False),
        ("algebra.new", "algebra.codec", False),
        ("algebra.ring", "algebra.new", False),
        ("algebra.new", "models.so3", True),
        ("algebra.new", "errors", False),
        ("models.rotation", "mechanics.derivation", True),
        ("mechanics.kinematics", "kernels.lower", True),
        ("kernels.ir", "kernels.lower", False),
        ("notes.formats.latex", "motion", True),
        ("commands.cli", "pipeline", False),
    ],
)
def test_an_arrow_the_other_way_is_seen(module, name, is_backward):
    assert bool(backward_arrows(module, {name})) is is_backward


def test_there_is_no_circle_of_imports():
    graph = {module: imports_of(tree) - {"", module} for module, tree in TREES.items() if module}
    tuple(TopologicalSorter(graph).static_order())  # raises CycleError, and names the circle


@pytest.mark.parametrize("rooms", SIBLINGS, ids=" and ".join)
def test_siblings_do_not_import_one_another(rooms):
    for module, tree in TREES.items():
        if floor_of(module) in rooms:
            other = rooms[1 - rooms.index(floor_of(module))]
            assert not [name for name in imports_of(tree) if floor_of(name) == other]


def test_kernels_import_their_representation_and_not_the_reverse():
    assert not [name for name in imports_of(TREES["kernels.ir"]) if "targets" in name]


def names_in(tree: ast.AST) -> set[str]:
    """Every name, attribute and imported name of a file."""
    found = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    found |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    return found | {alias.name.split(".")[-1] for node in imports for alias in node.names}


@pytest.mark.parametrize("module", SOURCES)
def test_nothing_is_searched_for(module):
    assert not names_in(TREES[module]) & SEARCHES


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


@pytest.mark.parametrize("module", SOURCES)
def test_no_text_is_run(module):
    assert not called_by_name(TREES[module]) & TEXT_READERS


@pytest.mark.parametrize("module", SOURCES)
def test_no_error_is_swallowed_unseen(module):
    handlers = [node for node in ast.walk(TREES[module]) if isinstance(node, ast.ExceptHandler)]
    for handler in handlers:
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


def test_the_order_has_no_entry_twice():
    assert len(set(ORDER)) == len(ORDER)


# tests


TESTS = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize("path", sorted(TESTS.rglob("*.py")), ids=lambda p: p.stem)
def test_tests_share_only_what_helpers_hold(path):
    own = {p.stem for p in TESTS.rglob("*.py")} | {p.name for p in TESTS.iterdir() if p.is_dir()}
    nodes = [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))]
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}
    roots = {name.split(".")[0] for name in names}
    assert roots & own <= {"helpers"}
