"""The figures of the house, counted from its sources: `python tests/house/figures.py`.

A *room* is a folder of the package, or a file beside the folders. An *arrow* runs from one room
to another if a file of the first imports one of the second; inside a room, the subfolders and the
files beside them take the part of rooms.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from io import StringIO
from pathlib import Path
from tokenize import COMMENT, DEDENT, ENDMARKER, INDENT, NEWLINE, NL, generate_tokens

Arrows = set[tuple[str, str]]

ROOT = Path(__file__).resolve().parents[2]

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


def circles(house: House) -> list[str]:
    """A circle each of the rooms, and of the parts of each room, if there is one."""
    found = {room: circle(house.arrows(room)) for room in ("", *sorted(house.rooms()))}
    return [f"{room or 'rooms'}: {' -> '.join(way)}" for room, way in found.items() if way]


def lines_of_code(text: str) -> int:
    """Lines that are neither blank nor a comment nor part of a docstring."""
    layout = {COMMENT, NL, NEWLINE, INDENT, DEDENT, ENDMARKER}
    lines: set[int] = set()
    for token in generate_tokens(StringIO(text).readline):
        if token.type not in layout:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(
            node
        ):
            lines.difference_update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return len(lines)


def main() -> None:
    house = House(ROOT / "rigidsym")
    arrows = house.arrows()
    print("rooms               ", len(house.rooms()))
    print("arrows between rooms", len(arrows), *sorted(upward(arrows)))
    print("circles             ", len(circles(house)), *circles(house))
    print("files               ", len(house.sources))
    print("lines of code       ", sum(map(lines_of_code, house.texts.values())))


if __name__ == "__main__":
    main()
