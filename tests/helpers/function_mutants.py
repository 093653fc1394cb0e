"""Functions of a module with one operator, comparison, sign or constant changed."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
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


_EXPONENT = "base = self if exponent >= 0 else self.inverse()"
EQUIVALENT: Mapping[tuple[str, str, str], str] = {  # function, change, line: why it changes nothing
    ("Quotient.__pow__", "0 -> 1", _EXPONENT): "no factor has to be inverted for the power of zero",
    ("Quotient.__pow__", "GtE -> Gt", _EXPONENT): "as before",
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
}
