"""The figures of the house, counted from its sources: `python tests/house/figures.py`.

A *room* is a folder of the package, or a file beside the folders. An *arrow* runs from one room
to another if a file of the first imports one of the second; inside a room, the subfolders and the
files beside them take the part of rooms.
"""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

Arrows = set[tuple[str, str]]

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

# A room imports only from the rooms above it.
ORDER = (
    "version",
    "errors",
    "system",
    "text",
    "formula",
    "algebra",
    "data",
    "models",
    "spec",
    "mechanics",
    "kernels",
    "simulation",
    "notes",
    "page",
    "motion",
    "pipeline",
    "tools",
    "commands",
)
# Neighbours do the same thing for different kinds, and so may have the same name.
PARALLEL = {"__init__.py", "derive.py", "printer.py", "conversions.py", "function.py"}


@dataclass(frozen=True)
class House:
    """The sources of a package, by their module without the name of the package; "" is itself."""

    package: Path

    @cached_property
    def sources(self) -> dict[str, Path]:
        return {self._module(path): path for path in sorted(self.package.rglob("*.py"))}

    def _module(self, path: Path) -> str:
        parts = path.relative_to(self.package).with_suffix("").parts
        return ".".join(part for part in parts if part != "__init__")

    @cached_property
    def trees(self) -> dict[str, ast.Module]:
        return {module: ast.parse(text) for module, text in self.texts.items()}

    @cached_property
    def texts(self) -> dict[str, str]:
        return {module: path.read_text(encoding="utf-8") for module, path in self.sources.items()}

    @cached_property
    def imports(self) -> dict[str, set[str]]:
        return {module: self.imported_by(tree) - {module} for module, tree in self.trees.items()}

    def imported_by(self, tree: ast.AST) -> set[str]:
        """Modules of the package that are imported, wherever in the tree."""
        found: set[str] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, "imports are written out, from rigidsym on"
                found |= {self._submodule(node.module or "", alias.name) for alias in node.names}
        ours = {name for name in found if name.split(".")[0] == self.package.name}
        return {name.removeprefix(self.package.name).removeprefix(".") for name in ours}

    def _submodule(self, module: str, name: str) -> str:
        path = f"{module}.{name}".removeprefix(f"{self.package.name}.")
        ours = path in self.sources and module.split(".")[0] == self.package.name
        return f"{module}.{name}" if ours else module

    def rooms(self, inside: str = "") -> set[str]:
        """The rooms, or the subfolders and files of one of them."""
        names = {part_of(module, inside) for module in self.sources}
        return names - {""}

    def arrows(self, inside: str = "") -> Arrows:
        """Pairs (room that imports, room imported)."""
        pairs = {
            (part_of(module, inside), part_of(name, inside))
            for module, names in self.imports.items()
            for name in names
        }
        return {(one, other) for one, other in pairs if one and other and one != other}


def part_of(module: str, inside: str = "") -> str:
    """The part of a room, or of the package, that a module belongs to; "" if it is outside."""
    steps = module.split(".")
    depth = len(inside.split(".")) if inside else 0
    within = ".".join(steps[:depth]) == inside and len(steps) > depth
    return steps[depth] if within else ""


def upward(arrows: Arrows) -> Arrows:
    """The arrows that run against the order of the rooms."""
    return {(one, other) for one, other in arrows if ORDER.index(other) > ORDER.index(one)}


def circle(arrows: Arrows) -> tuple[str, ...]:
    """Rooms that import one another in a circle, or () if there is none."""
    graph: dict[str, set[str]] = {}
    for one, other in arrows:
        graph.setdefault(one, set()).add(other)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return tuple(error.args[1])
    return ()


def floors(arrows: Arrows) -> int:
    """The number of rooms on the longest way down."""

    @cache
    def height(room: str) -> int:
        return 1 + max((height(other) for one, other in arrows if one == room), default=0)

    return max(height(room) for room, _ in arrows)


def lazy_imports(house: House) -> list[str]:
    """`module:line` for each import of an own module inside a function."""
    return [
        f"{module}:{node.lineno}"
        for module, tree in house.trees.items()
        for function in functions(tree)
        for node in own_statements(function)
        if isinstance(node, ast.Import | ast.ImportFrom) and house.imported_by(node)
    ]


def functions(tree: ast.AST) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    kinds = ast.FunctionDef | ast.AsyncFunctionDef
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


def own_statements(function: ast.AST) -> Iterable[ast.AST]:
    """The nodes of a function that are not of a function inside it."""
    for node in ast.iter_child_nodes(function):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
            yield from own_statements(node)


def classes_twice(house: House) -> list[str]:
    names = [
        node.name
        for tree in house.trees.values()
        for node in tree.body
        if isinstance(node, ast.ClassDef)
    ]
    return repeated(names)


def files_twice(house: House) -> list[str]:
    return repeated(path.name for path in house.sources.values() if path.name not in PARALLEL)


def repeated(names: Iterable[str]) -> list[str]:
    return sorted(name for name, count in Counter(names).items() if count > 1)


def lines(house: House) -> dict[str, int]:
    return {module: text.count("\n") for module, text in house.texts.items()}


def longest_functions(house: House) -> dict[str, int]:
    """`module.function`: lines from `def` on."""
    return {
        f"{module}.{node.name}": (node.end_lineno or 0) - node.lineno + 1
        for module, tree in house.trees.items()
        for node in functions(tree)
    }


def files_beside_folders(house: House) -> list[str]:
    return sorted(path.name for path in house.package.glob("*.py"))


INSIDE = {"kernels": 25, "notes": 35, "mechanics": 40}  # arrows, at most


@dataclass(frozen=True)
class Walk:
    """What the interpreter passes through on the way of one command."""

    files: int  # entered by a function call
    changes: int  # of room, from one call to the next


def walk(*command: str) -> Walk:
    """The walk of a command, in a process of its own so that no import is behind it yet."""
    program = [sys.executable, __file__, "--walk", *command]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    return Walk(*map(int, done.stderr.split()[-2:]))


def _walked(command: list[str]) -> Walk:
    import rigidsym
    from rigidsym.commands.cli import main

    package = str(Path(rigidsym.__file__).parent) + "/"
    files: set[str] = set()
    rooms = [""]

    def enter(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        is_function = code.co_flags & inspect.CO_OPTIMIZED  # the body of a module or class is none
        if event == "call" and is_function and code.co_filename.startswith(package):
            files.add(code.co_filename)
            room = code.co_filename.removeprefix(package).split("/")[0]
            if room != rooms[-1]:
                rooms.append(room)

    sys.argv = ["rigidsym", *command]
    sys.setprofile(enter)
    try:
        main()
    except SystemExit as end:
        if end.code:
            raise
    finally:
        sys.setprofile(None)
    return Walk(len(files), len(rooms) - 1)


def report(house: House) -> list[tuple[str, object, str]]:
    """(what, figure, goal) in the order of the plan."""
    arrows, sizes = house.arrows(), lines(house)
    return [
        ("files beside the folders", len(files_beside_folders(house)), "at most 7"),
        ("rooms", len(house.rooms()), "at most 20"),
        ("floors", "a circle" if circle(arrows) else floors(arrows), "at most 10"),
        ("arrows between rooms", len(arrows), "at most 80"),
        ("arrows that run upwards", _listed(upward(arrows)), "0"),
        *((f"arrows inside {r}/", len(house.arrows(r)), f"at most {n}") for r, n in INSIDE.items()),
        ("circles of rooms and subfolders", _listed(circles(house)), "0"),
        ("lines", sum(sizes.values()), "at most 29000"),
        ("imports inside functions", len(lazy_imports(house)), "at most 25"),
        ("class names defined twice", _listed(classes_twice(house)), "0"),
        ("file names used twice", _listed(files_twice(house)), "0, besides parallel files"),
        ("longest file", _largest(sizes), "at most 400"),
        ("longest function", _largest(longest_functions(house)), ""),
    ]


def circles(house: House) -> list[str]:
    """A circle each of the rooms, and of the parts of each room, if there is one."""
    found = {room: circle(house.arrows(room)) for room in ("", *sorted(house.rooms()))}
    return [f"{room or 'rooms'}: {' -> '.join(way)}" for room, way in found.items() if way]


def _largest(sizes: dict[str, int]) -> str:
    name = max(sizes, key=lambda key: sizes[key])
    return f"{sizes[name]} ({name})"


def _listed(found: Iterable[object]) -> str:
    names = sorted(" -> ".join(x) if isinstance(x, tuple) else str(x) for x in found)
    return f"{len(names)}{': ' + ', '.join(names) if names else ''}"


def main() -> None:
    house = House(ROOT / "rigidsym")
    with TemporaryDirectory() as folder:
        way = walk("derive", "ZXZ", "--out", folder)
    rows = [
        *report(house),
        ("files entered by derive ZXZ", way.files, "at most 80"),
        ("changes of room on the way", way.changes, "at most 300"),
    ]
    for what, figure, goal in rows:
        print(f"{what:<34}{figure}{f'   [{goal}]' if goal else ''}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--walk"]:
        found = _walked(sys.argv[2:])
        print(found.files, found.changes, file=sys.stderr)
    else:
        main()
