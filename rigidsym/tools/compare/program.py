"""The formulas of a program: an abstract interpreter over its syntax tree.

It runs each function with symbols in place of numbers, and keeps the value of each name: an
expression, a matrix, or the reason why the value is unreadable. A condition or a loop makes every
name unreadable that it may change. A new name for an unreadable or a long value becomes an input of
the formulas after it. A formula is therefore only read if the program computes the same.
`nodes.toml` gives the meaning of each type of node. Programs are parsed, never run.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.errors import ExpressionError, MissingExtra
from rigidsym.text.bounds import FUNCTIONS, Sized
from rigidsym.text.names import spelled
from rigidsym.tools.compare.language import (
    ANGLE,
    CONSTANTS,
    FUNCTION_NAMES,
    MINUS,
    OF_MATRICES,
    WRAPPERS,
    as_matrix,
    called,
    combined,
    name_of,
    number,
    read_formula,
    rows,
    sized,
    spelled_out,
)
from rigidsym.tools.compare.latex import tex_words
from rigidsym.tools.compare.targets import stem_of

if TYPE_CHECKING:
    from tree_sitter import Node


GRAMMARS = {
    ".py": "python",
    **dict.fromkeys((".c", ".h"), "cpp"),  # C is read as C++: headers do not tell which it is
    **dict.fromkeys((".cc", ".cpp", ".cxx", ".hpp", ".ino"), "cpp"),
    **dict.fromkeys((".js", ".mjs", ".jsx"), "javascript"),
    **{".m": "matlab", ".ts": "typescript", ".rs": "rust", ".java": "java"},
    ".cs": "c_sharp",
}
_SHARING = (".py", ".js", ".mjs", ".jsx", ".ts", ".java", ".cs")  # b = a is the same matrix
_DEEPEST = 60  # nested nodes of an expression; formulas of real programs have fewer than 30
_DEEPEST_BLOCK = 40
_LONGEST_PATH = 8  # members of members
_MOST_NODES = 400_000  # of a file: a generated megabyte is not worth reading
_MOST_CHARACTERS = 20_000  # of a formula
_LONG_IN_LONG = 3  # names for long values that use other such names
_MOST_PARTS = 2_000  # of a matrix
_INLINED = 3  # calls of functions of the same file inside one another

_NUMBERS = re.compile(r"((?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)_?[fFlLuUdDmM]*(?:32|64)?")
_NUMPY = re.compile(r"^\s*(?:import|from) (?:numpy|jax)\b", re.MULTILINE)
_MATRICES = re.compile(r"\bsympy\b|\bcasadi\b|\b(?:np|numpy)\.mat\(|[mM]atrix\(")  # whose * is @
_MATRIX_NAME = re.compile(r"mat|rot|dcm|basis|tensor|^set|setvalue|new|tf", re.IGNORECASE)
_VECTOR_NAME = re.compile(r"vec|quat|^set|new|array", re.IGNORECASE)
_MAY_BE_MATRIX = re.compile(r"[\[{].*,|(?i:sin|cos|mat|quat|dcm)", re.DOTALL)
_BY_COLUMNS = re.compile(r"from_?col|^f?mat3x?3?$|column_stack|hstack|^c_$", re.IGNORECASE)
_HARMLESS = re.compile(
    r"print|disp|log|assert|plot|show|append|push|test|check|expect", re.IGNORECASE
)
ELEMENT = re.compile(r"(?P<stem>.*?)_?(?P<row>[0-3])_?(?P<column>[0-3])")
_ROW = re.compile(r"(?P<stem>(?:.*\.)?)(?P<row>[abc])\.(?P<column>[xyz])")  # Matrix3 of ArduPilot
_AXES = {"x": 0, "y": 1, "z": 2, "X": 0, "Y": 1, "Z": 2}
_BOOLEANS = {"0": False, "false": False, "False": False, "1": True, "true": True, "True": True}
_BEYOND_ONE = re.compile(r"(?:\w+(?:\.|::))?f?absf?\([\w.>-]+\)>=?1(?:\.0*)?f?")
_NOT_NULL = re.compile(r"\w+(?:!=|isnot)(?:nullptr|NULL|null|None)")
_CLAMPS = re.compile(r"clip|clamp|constrain|math_constrain|clampf", re.IGNORECASE)
_TRIPLES = (
    *(("roll", "pitch", "yaw"), ("phi", "theta", "psi"), ("alpha", "beta", "gamma")),
    *(("x", "y", "z"), ("rx", "ry", "rz")),
)
_INVERSE = (sp.atan2, sp.asin, sp.acos, sp.atan)
_OPERATORS = ("+", "-", "*", "/", "**", "@")
_ELEMENTWISE = {".*": "%", "./": "/", ".^": "**", "^": "**"}  # MATLAB
_FLAT = {9: (3, 3), 12: (4, 3), 16: (4, 4)}

_NODES: dict[str, dict[str, set[str]]] = {
    title: {name: set(words.split()) for name, words in table.items()}
    for title, table in tomllib.loads(
        Path(__file__).with_name("nodes.toml").read_text(encoding="utf-8")
    ).items()
}
_STATEMENTS, _EXPRESSIONS = _NODES["statements"], _NODES["expressions"]
_PARTS, _WORDS = _NODES["parts"], _NODES["words"]
_CALLS, _ASSIGNMENTS = _EXPRESSIONS["call"], _STATEMENTS["assignment"]
_LEFT = ("left", "declarator", "name", "pattern", "argument")
_INNER = ("argument", "value", "object", "expression", "array", "scope", "path")


class _Unreadable(ExpressionError):
    """A part of a program that cannot be followed."""


@dataclass(frozen=True)
class Formula:
    """A matrix or vector of a program, or the reason why it is not read."""

    line: int
    name: str
    matrix: sp.ImmutableMatrix | None
    reason: str = ""
    whole: sp.ImmutableMatrix | None = None  # with names for long values replaced by these values
    unread: tuple[tuple[str, int], ...] = ()  # names in it whose values are not read, and lines


def _unflattened(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Nine, twelve or sixteen numbers in a row are a matrix."""
    is_flat = 1 in matrix.shape and len(matrix) in _FLAT
    return matrix.reshape(*_FLAT[len(matrix)]) if is_flat else matrix


@dataclass
class _Grid:
    """A matrix that may still change, or that is filled entry by entry."""

    line: int
    name: str
    entries: dict[tuple[int, ...], sp.Expr]
    is_whole: bool = False  # assigned at once

    @classmethod
    def of(cls, line: int, matrix: sp.MatrixBase, name: str = "") -> _Grid:
        matrix = _unflattened(matrix)
        places = ((i, j) for i in range(matrix.rows) for j in range(matrix.cols))
        return cls(line, name, {place: matrix[place] for place in places}, is_whole=True)

    def copy(self) -> _Grid:
        return _Grid(self.line, self.name, dict(self.entries), self.is_whole)

    def matrix(self) -> sp.ImmutableMatrix | None:
        """The matrix, if no entry is missing."""
        widths = {len(index) for index in self.entries}
        if len(widths) != 1:
            return None
        grid = sorted(self.entries)
        height = len({index[0] for index in grid})
        width = len({index[-1] for index in grid}) if widths == {2} else 1
        if height * width != len(grid):
            return None
        entries = [self.entries[index] for index in grid]
        return _unflattened(sp.ImmutableMatrix(height, width, entries))


@dataclass
class _State:
    """The values of all names at one place of a function; a text says why a value is unreadable."""

    values: dict[str, sp.Expr | _Grid | str] = field(default_factory=dict)
    is_over: bool = False  # after a return

    def copy(self) -> _State:
        grids = {id(v): v.copy() for v in self.values.values() if isinstance(v, _Grid)}
        return _State({k: grids.get(id(v), v) for k, v in self.values.items()}, self.is_over)


@dataclass(frozen=True)
class _Program:
    """All functions know this of their file."""

    suffix: str
    functions: Mapping[str, Node] = field(default_factory=dict)
    is_numpy: bool = False  # * is the product entry by entry
    is_formula: bool = False  # a formula on its own, with the words of `language`


def program_formulas(text: str, suffix: str) -> list[Formula]:
    """All matrices and vectors of a program, in the order of its lines."""
    root = _parser(GRAMMARS[suffix]).parse(text.encode()).root_node
    if root.descendant_count > _MOST_NODES:
        return []
    functions = [node for node in _below([root]) if node.type in _PARTS["function"]]
    by_name = {name: node for node in functions if (name := _function_name(node))}
    is_numpy = suffix == ".py" and bool(_NUMPY.search(text)) and not _MATRICES.search(text)
    program = _Program(suffix, by_name, is_numpy)
    formulas: dict[tuple[int, str, Any], Formula] = {}
    for scope in (root, *functions):
        for formula in _Interpreter(program).formulas_of(scope):
            formulas.setdefault((formula.line, formula.name, formula.matrix), formula)
    return sorted(formulas.values(), key=lambda each: each.line)


def formula_matrix(text: str) -> sp.ImmutableMatrix:
    """The matrix of a single formula in Python, C, MATLAB or LaTeX; a scalar is 1x1.

    Raises ExpressionError for a text in none of these languages, and for one that is too long.
    """
    if len(text) > _MOST_CHARACTERS:
        raise ExpressionError(
            f"a formula of {len(text)} characters; expected at most {_MOST_CHARACTERS}"
        )
    if re.search(r"\\[A-Za-z]", text):
        return read_formula(tex_words(text))
    is_numpy = bool(re.search(r"\b(?:np|numpy|jnp)\.(?:array|asarray)\b", text))
    for suffix in (".cpp",) if "{" in text else (".py", ".m", ".cpp"):
        value = _assigned_value(text, suffix)
        if value is not None:
            program = _Program(suffix, is_numpy=is_numpy, is_formula=True)
            matrix = as_matrix(_Interpreter(program).read(value))
            return _unflattened(matrix) if "{" in text else matrix  # float R[9] = {...}
    text = text if len(text) < 200 else f"{text[:200]}..."
    raise ExpressionError(f"not a formula in Python, C, MATLAB or LaTeX: {text}")


def _assigned_value(text: str, suffix: str) -> Node | None:
    """The right-hand side, if the text or `x = text` is an assignment in a language."""
    line = text.strip().rstrip(";")
    if suffix != ".m":  # a line ends a row in MATLAB only
        line = line.replace("\n", " ")
    if suffix == ".py":  # in Python, ^ would bind less than +
        line = line.replace("^", "**")
    for program in (f"{'auto ' * (suffix == '.cpp')}x = {line};", f"{line};"):
        root = _parser(GRAMMARS[suffix]).parse(program.encode()).root_node
        first = next((node for node in _below([root]) if node.type in _ASSIGNMENTS), None)
        while first is not None and first.type in _ASSIGNMENTS and not root.has_error:
            first = _part(first, "right", "value")
        if first is not None and not root.has_error:
            return first
    return None


@cache
def _parser(grammar: str) -> Any:
    try:
        from tree_sitter import Language, Parser

        module = import_module(f"tree_sitter_{grammar}")
    except ImportError as error:
        raise MissingExtra("reading formulas in Python, C and MATLAB", "compare") from error
    language = module.language_typescript if grammar == "typescript" else module.language
    return Parser(Language(language()))


# Nodes


def _below(nodes: Iterable[Node]) -> Iterator[Node]:
    """Nodes and all that they contain, in the order of the text, without recursion."""
    stack = [*nodes][::-1]
    while stack:
        node = stack.pop()
        yield node
        stack += node.named_children[::-1]


def _function_name(node: Node) -> str:
    owner: Node | None = node
    if node.type in ("lambda", "arrow_function", "function_expression", "lambda_expression"):
        owner = node.parent
        part = _part(owner, "left", "name", "declarator") if owner is not None else None
    else:
        part = _part(node, "name", "declarator")
        while part is not None and part.type.endswith("declarator"):
            part = _part(part, "declarator")
    return _text(part).rpartition("::")[2]


def _part(node: Node, *fields: str) -> Node | None:
    """The first of some parts that a node has."""
    return next((p for f in fields if (p := node.child_by_field_name(f)) is not None), None)


def _text(node: Node | None) -> str:
    return node.text.decode(errors="replace") if node is not None and node.text else ""


def _line(node: Node) -> int:
    return node.start_point[0] + 1


def _children(node: Node) -> list[Node]:
    return [c for c in node.named_children if c.type not in ("comment", "line_continuation")]


def _child(node: Node, *kinds: str) -> Node | None:
    return next((child for child in node.named_children if child.type in kinds), None)


def _operator(node: Node) -> str:
    own = _part(node, "operator")
    return _text(own or next((c for c in node.children if not c.is_named), None))


def _targets(left: Node) -> list[Node]:
    """The parts of a tuple on the left, or the only one."""
    return _children(left) if left.type in _PARTS["tuple"] else [left]


def _left(node: Node) -> Node | None:
    """The name, entry or tuple that an assignment writes to."""
    left = _part(node, *_LEFT) or next(iter(_children(node)), None)
    while left and left.type in ("array_declarator", "pointer_declarator", "reference_declarator"):
        left = _part(left, "declarator") or next(iter(_children(left)), None)
    return left


def _arguments(node: Node) -> list[Node]:
    outer = _part(node, "arguments", "value") or _child(node, "arguments")
    return _children(outer) if outer is not None else []


def _member(node: Node) -> tuple[Node | None, str]:
    """The object and the name of its member."""
    return _part(node, *_INNER), _text(_part(node, "attribute", "field", "property", "name"))


def _path(node: Node | None, depth: int = 0) -> str | None:
    """self.phi, p->x, q.w() and ns::name with dots, or None for other expressions."""
    if node is None or depth > _LONGEST_PATH:
        return None
    if node.type in _PARTS["name"]:
        return _text(node)
    inner, member, children = None, "", _children(node)
    if node.type in _EXPRESSIONS["wrapped"] and len(children) == 1:
        return _path(children[0], depth + 1)
    if node.type == "pointer_expression" and _operator(node) == "*":
        return _path(children[-1], depth + 1)
    if node.type in _EXPRESSIONS["member_of"]:
        inner, member = _member(node)
        member = "" if member == "T" else member
    elif node.type == "call_expression" and not _arguments(node):
        function = _part(node, "function")
        if function is not None and function.type in _EXPRESSIONS["member_of"]:
            inner, member = _member(function)
            member = member if member in "wxyz" or ANGLE.fullmatch(member) else ""
    elif node.type in _EXPRESSIONS["subscript"] and (
        key := re.search(r"""\[["'](\w+)["']\]$""", _text(node))
    ):
        inner, member = node.named_children[0], key[1]  # state["phi"]
    base = _path(inner, depth + 1)
    return f"{base}.{member}" if base and re.fullmatch(r"\w+", member) else None


def _callee(node: Node) -> str:
    """The path of the function that is called: np.array, Math.sin, R.transpose, ?.transpose."""
    function = _part(node, *(("name",) if node.type == "function_call" else ()))
    function = function or _part(node, "function", "constructor", "type")
    if node.type == "method_invocation":
        inner, name = _part(node, "object"), _text(_part(node, "name"))
        return f"{_path(inner) or '?'}.{name}" if inner is not None else name
    if function is not None and function.type in _EXPRESSIONS["member_of"]:
        inner, name = _member(function)
        return f"{_path(inner) or '?'}.{name}"
    return re.sub(r"<.*>", "", _text(function)).replace("::", ".")


def _truth(condition: Node | None) -> bool | None:
    """Whether a condition always holds, or never does; None if that depends.

    A sine is never 1 outside of the poles, and what a null pointer points to is not written.
    """
    text = re.sub(r"\s", "", _text(condition))
    text = text[1:-1] if text.startswith("(") and text.endswith(")") else text
    if _BEYOND_ONE.fullmatch(text):
        return False
    return True if _NOT_NULL.fullmatch(text) else _BOOLEANS.get(text)


class _Interpreter:
    """One function, or the code of a file outside of all functions."""

    def __init__(self, program: _Program, inlined: int = 0) -> None:
        self.program = program
        self.inlined = inlined
        self.is_matlab = program.suffix == ".m"
        self.state = _State()
        self.formulas: list[Formula] = []
        self.paths: dict[str, str] = {}  # name: its path in the program
        self.inputs: set[str] = set()  # names that were read before anything was assigned
        self.cut: dict[str, sp.Expr | None] = {}  # names that stand for values, if these are read
        self.components: set[str] = set()  # names for components of a value
        self.lines: dict[str, int] = {}  # where a name was first assigned
        self.untracked: set[str] = set()
        self.scalars: list[tuple[str, sp.Expr, int]] = []  # the last ones assigned in a row
        self.runs: list[tuple[int, tuple[str, ...], tuple[sp.Expr, ...]]] = []
        self.result: Any = None
        self.results = 0
        self.depth = 0

    def unreadable(self, node: Node, reason: str = "is not understood") -> _Unreadable:
        text = re.sub(r"\s+", " ", _text(node))
        text = text if len(text) <= 60 else f"{text[:57]}..."
        where = "" if self.program.is_formula else f" in line {_line(node)}"
        return _Unreadable(f"`{text}`{where} {reason}")

    # Statements

    def formulas_of(self, scope: Node) -> list[Formula]:
        """Run a function, or the whole file; the formulas in it."""
        self.untracked = {n for n, is_late in self._writes(scope.named_children) if is_late}
        is_function = scope.type in _PARTS["function"]
        body = (_part(scope, "body") or _child(scope, "block")) if is_function else scope
        if is_function:
            self.inputs |= set(self.parameters(scope))
        if body is None:
            return []
        if is_function and not body.type.endswith(("block", "statement", "body")):
            self._return(body)  # the expression of an arrow
        else:
            self.run(body)
            last = _children(body)[-1:] if self.program.suffix == ".rs" else []
            if last and not last[0].type.endswith(("statement", "declaration")):
                self._return(last[0])
        if not self.state.is_over:
            self._emit(self.state.values)
            self._add_angles()
        self._add_runs()
        self._add_elements()
        return self.formulas

    def parameters(self, node: Node) -> list[str]:
        """The names of the parameters of a function."""
        outer = _part(node, "parameters", "declarator") or _child(node, "function_arguments")
        while outer is not None and outer.type.endswith("declarator"):
            outer = _part(outer, "parameters", "declarator")
        names = []
        for child in _children(outer) if outer is not None else ():
            part: Node | None = child
            while part is not None and part.type not in _PARTS["name"]:
                part = _part(part, "declarator", "pattern", "name") or next(
                    (
                        c
                        for c in part.named_children
                        if c.type in _PARTS["name"] or "declar" in c.type
                    ),
                    None,
                )
            names += [self.name_of_path(_text(part))] if part is not None else []
        return names

    def run(self, node: Node) -> None:
        """One statement, or all statements in a block."""
        if self.state.is_over or node.type in _PARTS["function"]:
            return
        self.depth += 1
        if self.depth > _DEEPEST_BLOCK:
            self._forget([node], f"it changes in line {_line(node)}, which is nested too deeply")
        elif node.type in STATEMENTS:
            STATEMENTS[node.type](self, node)
        else:
            if not node.type.endswith(("statement", "declaration")):
                self.scalars = []
            for child in _children(node):
                self.run(child)
        self.depth -= 1

    def _assignment(self, node: Node) -> None:
        left, right = _left(node), _part(node, "right", "value")
        if right is None and node.type == "variable_declarator":  # C#: no field
            right = next(iter(_children(node)[1:]), None)
        if left is None or right is None:
            if left is not None and node.type == "assignment_expression":
                self._drop(left, self.unreadable(node))
        elif (operator := _operator(node)).endswith("=") and operator != "=":  # C: a += b
            self._update(node)
        else:
            if right.type in _ASSIGNMENTS:  # a = b = c
                self.run(right)
                right = _left(right) or right
            self._assign(left, right)

    def _assign(self, left: Node, right: Node) -> None:
        targets = _targets(left)
        try:
            value = self.value(right)
            if left in targets:
                self._store(left, value)
                return
            matrix = value.matrix() if isinstance(value, _Grid) else None
            if matrix is None or len(matrix) != len(targets) or 1 not in matrix.shape:
                raise self.unreadable(right)  # w, x, y, z = q
            for target, entry in zip(targets, matrix, strict=True):
                self._store(target, entry)
        except ExpressionError as error:
            self._drop(left, error)
            self.components |= set() if left in targets else set(map(self.written, targets))
            self.scalars = []

    def _store(self, left: Node, value: sp.Expr | _Grid) -> None:
        """An assignment to a name, a member, or an entry."""
        index = self.index(left)
        if index is not None:
            self._store_entry(left, *index, value)
            return
        name = self.written(left) if _path(left) is not None else ""
        if not name:
            raise self.unreadable(left)
        if isinstance(value, _Grid) and len(value.entries) == 1:
            (value,) = value.entries.values()
        if isinstance(value, _Grid):
            self._emit([name])
            if not value.name:
                value.line, value.name = _line(left), name
            elif self.program.suffix not in _SHARING:
                value = value.copy()
            self.state.values[name] = value
            self.scalars = []
        else:
            self._store_scalar(name, value, _line(left))

    def _store_scalar(self, name: str, value: sp.Expr, line: int) -> None:
        self.lines.setdefault(name, line)
        if _is_short(value) or name in self.inputs or name in self.cut:
            self.state.values[name] = value
        else:
            self._cut(name, value)
        self.scalars = [*self.scalars, (name, value, line)][-4:]
        for length in (3, 4):
            last = self.scalars[-length:]
            names = tuple(each for each, _, _ in last)
            if len(names) == length and _are_components(names):
                self.runs.append((line, names, tuple(each for _, each, _ in last)))

    def _cut(self, name: str, value: sp.Expr | None) -> None:
        """A new name for a long or an unreadable value is an input of the formulas after it."""
        self.cut[name] = value
        self.state.values[name] = sp.Symbol(name, real=True)

    def _store_entry(
        self, left: Node, base: str, place: tuple[int, ...], value: sp.Expr | _Grid
    ) -> None:
        grid = self.state.values.get(base)
        if isinstance(grid, str):
            return
        if isinstance(value, _Grid):
            raise self.unreadable(left, "is a block that is assigned")
        if isinstance(grid, _Grid) and not grid.is_whole and len(grid.entries) > 1:
            is_anew = place == next(iter(grid.entries)) and grid.matrix() is not None
            if is_anew:
                self._emit([base])
            grid = None if is_anew else grid
        if not isinstance(grid, _Grid):
            grid = _Grid(_line(left), base, {})
            self.state.values[base] = grid
        if grid.is_whole and len(place) == 1 and (place[0], 0) in grid.entries:
            place = (place[0], 0)
        if grid.is_whole and place not in grid.entries:
            raise self.unreadable(left, "is an entry outside of the matrix")
        grid.entries[place] = value

    def _update(self, node: Node) -> None:
        """a += b, or a++."""
        left, right, operator = _left(node), _part(node, "right"), _operator(node)
        if left is None:
            return
        try:
            if right is None:
                raise self.unreadable(node)
            read = combined(self._operation(node, operator[:-1]), self.read(left), self.read(right))
            value = self._valued(node, read)
            grid = self.state.values.get(self.written(left))
            if isinstance(grid, _Grid) and isinstance(value, _Grid):
                grid.entries = value.entries  # also of other names for this matrix
            else:
                self._store(left, value)
        except ExpressionError as error:
            self._drop(left, error)

    def _drop(self, left: Node, reason: object) -> None:
        """The value is unreadable: a new name for it is an input, any other name unreadable."""
        for target in _targets(left):
            name = self.written(target)
            if not name:
                continue
            is_new = name not in self.inputs and name not in self.cut and self.index(target) is None
            if is_new and not isinstance(self.state.values.get(name), _Grid):
                self.lines.setdefault(name, _line(target))
                self._cut(name, None)
            else:
                self._spoil(name, str(reason))

    def _spoil(self, name: str, reason: str) -> None:
        """A name, and all others for the same matrix, become unreadable."""
        held = self.state.values.get(name)
        for other, value in self.state.values.items():
            if value is held and isinstance(held, _Grid):
                self.state.values[other] = reason
        self.state.values[name] = reason

    def _forget(self, nodes: Sequence[Node], reason: str, *, only_known: bool = False) -> None:
        for name, _ in self._writes(nodes):
            if not only_known or name in self.state.values or name in self.inputs:
                self._spoil(name, reason)

    def _writes(self, nodes: Sequence[Node]) -> Iterator[tuple[str, bool]]:
        """Names that are written to, and whether by an inner function or expression.

        When that happens is unknown; Python's inner functions need `nonlocal` for it.
        """
        stack = [(node, False) for node in nodes]
        while stack:
            node, is_inner = stack.pop()
            is_inner |= node.type in _PARTS["function"]
            names: set[str] = set()
            is_late = (
                is_inner and self.program.suffix != ".py" and node.type not in _PARTS["declaration"]
            )
            if node.type == "named_expression":
                names, is_late = {self.written(node)}, True
            elif node.type in ("nonlocal_statement", "global_statement"):
                names, is_late = {_text(child) for child in node.named_children}, True
            elif node.type in _ASSIGNMENTS or node.type in _STATEMENTS["update"]:
                left = _left(node)
                names = set(map(self.written, _targets(left))) if left is not None else set()
            elif node.type in _CALLS or node.type == "binary_expression":
                names, is_late = self._reached(node), False
            yield from ((name, is_late) for name in names if name)
            stack += [(child, is_inner) for child in node.named_children]

    def written(self, left: Node) -> str:
        """The name that an assignment writes to, also through parts that are not understood."""
        node: Node | None = left
        while node is not None:
            path = _path(node)
            if path is not None:
                return self.name_of_path(path)
            node = _part(node, *_INNER, "name") or next(iter(_children(node)), None)
        return ""

    def _branches(self, node: Node) -> None:
        """if, elif, else."""
        first = _part(node, "consequence") or _child(node, "block")
        branches: list[tuple[Node | None, Node]] = []
        if first is not None:
            branches.append((_part(node, "condition"), first))
        branches += [
            (_part(c, "condition"), c) for c in node.named_children if c.type in _PARTS["elif"]
        ]
        other = _child(node, "else_clause") or _part(node, "alternative")
        if other is not None and other.type not in _PARTS["elif"]:
            branches.append((None, other))
        possible, is_sure = [], False
        for condition, block in branches:
            constant = _truth(condition)
            if constant is not False:
                possible.append(block)
            if condition is None or constant:
                is_sure = True
                break
        self._either(possible, node, is_sure=is_sure)

    def _choice(self, node: Node) -> None:
        """switch, match."""
        cases = [each for each in _below(_children(node)) if each.type in _PARTS["case"]]
        known = self.state.values.keys() | self.inputs
        self._either(cases, node, ends_at_break=True)
        for name, _ in self._writes([node]):  # a break inside of a case ends it early
            if name in known:
                self._spoil(name, f"{name} depends on the condition in line {_line(node)}")

    def _loop(self, node: Node) -> None:
        """A loop may run many times or never: what changes in it is unreadable at its start."""
        reason = f"it changes in the loop in line {_line(node)}"
        before = self.state.copy()
        self._forget([node], reason, only_known=True)
        header = _part(node, "left", "initializer", "pattern")
        if header is not None and node.type != "for_statement":
            self._drop(header, reason)
        body = _part(node, "body") or _child(node, "block") or node
        self._either([body], node, before=before, ends_at_break=True)

    def _maybe(self, node: Node) -> None:
        """The handler of an exception."""
        self._either([node], node)

    def _either(
        self,
        blocks: Sequence[Node],
        node: Node,
        *,
        before: _State | None = None,
        is_sure: bool = False,
        ends_at_break: bool = False,
    ) -> None:
        """Run each block from the same state, and merge: differing values are unreadable."""
        start, before = self.state, before or self.state
        paths = [] if is_sure else [before]
        for block in blocks:
            self.state, self.scalars = start.copy(), []
            condition = _part(block, "condition") if block.type in _PARTS["elif"] else None
            is_simple = block.type in STATEMENTS and block != node
            for child in [block] if is_simple else _children(block):
                if child != condition:
                    self.run(child)
            values = self.state.values
            self._emit([k for k, v in values.items() if k not in start.values])
            self._add_angles()
            self.state.is_over &= not ends_at_break  # a break ends only the loop or the choice
            paths.append(self.state)
        self.scalars = []
        alive = [path for path in paths if not path.is_over]
        self.state = (alive or [before])[0].copy()
        self.state.is_over = not alive
        for name in {name for path in alive for name in path.values}:
            values_at_end = [path.values.get(name) for path in alive]
            if all(_same(values_at_end[0], value) for value in values_at_end[1:]):
                continue
            is_new = name not in before.values and name not in self.inputs | self.cut.keys()
            if is_new and not any(isinstance(value, _Grid) for value in values_at_end):
                self.lines.setdefault(name, _line(node))
                self._cut(name, None)
            else:
                self.state.values[name] = f"{name} depends on the condition in line {_line(node)}"

    def _end(self, node: Node) -> None:
        """return, break, raise."""
        value = next(iter(_children(node)), None)
        self._return(value if node.type.startswith("return") else None)

    def _return(self, node: Node | None) -> None:
        if node is not None:
            self.results += 1
            try:
                self.result = self.value(node)
                if isinstance(self.result, _Grid) and _path(node) is None:
                    self._add(_line(node), "returned", self.result.matrix())
            except ExpressionError as error:
                self.result = None
                if _MAY_BE_MATRIX.search(_text(node)):
                    self.formulas.append(Formula(_line(node), "returned", None, str(error)))
        self._emit(self.state.values)
        self._add_angles()
        self.state.is_over = True

    def _call_statement(self, node: Node) -> None:
        """m.set(...) is an assignment; other calls may change their object and matrices."""
        path = _callee(node)
        base, method = path.rpartition(".")[::2]
        if "::" in _text(_part(node, "function")):  # of a type, not of an object
            return
        if base and (_MATRIX_NAME.search(method) or _VECTOR_NAME.search(method)):
            try:
                values = [self.read(argument) for argument in _arguments(node)]
                if len(values) in (3, 4, 9, 16):
                    name = self.name_of_path(base)
                    self._emit([name])
                    self.state.values[name] = _Grid.of(_line(node), rows(values), name)
                    return
            except ExpressionError:
                pass  # the call is taken as any other below
        if not _HARMLESS.search(path):
            for name in self._reached(node):
                if name in self.state.values or name in self.inputs:
                    self._spoil(name, f"{name} may be changed by {path}() in line {_line(node)}")

    def _reached(self, node: Node) -> set[str]:
        """Names that a call, or a stream, may change: its object, matrices, and &name."""
        if node.type not in _CALLS:
            return {self.written(node)} if _operator(node) == "<<" else set()
        paths = [path for path in map(_path, _arguments(node)) if path is not None]
        names = map(self.name_of_path, [_callee(node).rpartition(".")[0], *paths])
        pointers = [each for each in _arguments(node) if each.type == "pointer_expression"]
        return {n for n in names if isinstance(self.state.values.get(n), _Grid)} | set(
            map(self.written, pointers)
        )

    def _comma(self, node: Node) -> None:
        """a = b, c = d; or R << a, b, c."""
        parts = [node]
        while parts[-1].type == "comma_expression":
            parts[-1:] = _children(parts[-1])
        if parts[0].type == "binary_expression":
            self._stream(parts[0], parts[1:])
        else:
            for part in parts:
                self.run(part)

    def _stream(self, node: Node, others: Sequence[Node] = ()) -> None:
        """Eigen's comma initialiser."""
        left, right = _part(node, "left"), _part(node, "right")
        if left is None or right is None or _operator(node) != "<<":
            return
        try:
            read = rows([self.read(part) for part in (right, *others)])
            self._store(left, _Grid.of(_line(node), read))
        except ExpressionError as error:
            self._drop(left, error)

    # Formulas

    def _emit(self, names: Iterable[str]) -> None:
        """The matrices of some names have their final values."""
        for name in names:
            grid = self.state.values.get(name)
            if isinstance(grid, _Grid) and grid.name:  # not the result of a helper
                self._add(grid.line, grid.name, grid.matrix())

    def _add_angles(self) -> None:
        """roll, pitch and yaw by inverse functions are one vector."""
        angles: dict[tuple[str, str], str] = {}
        for name in self.state.values:
            value = self._full(name)
            if value is not None and value.has(*_INVERSE):
                base, _, last = self.paths.get(name, name).rpartition(".")
                angles[base, re.sub(r"^_+|_?(val|rad|angle)?_*$", "", last.lower())] = name
        for base, triple in product({base for base, _ in angles}, _TRIPLES):
            names = [angles[base, each] for each in triple if (base, each) in angles]
            if len(names) == 3:
                line = self.lines.get(names[0], 1)
                column = sp.ImmutableMatrix([self._full(name) for name in names])
                self._add(line, ", ".join(names), column)

    def _full(self, name: str) -> sp.Expr | None:
        """The value of a name, also if the name stands for it."""
        value = self.state.values[name]
        if value == sp.Symbol(name, real=True):
            value = self.cut.get(name, value)
        return value if isinstance(value, sp.Expr) else None

    def _add_runs(self) -> None:
        """Scalars that were assigned in a row and are one vector."""
        long = {sp.Symbol(k, real=True): v for k, v in self.cut.items() if v is not None}
        for line, names, first in self.runs:
            column = []
            for name, value in zip(names, first, strict=True):
                last = self.state.values.get(name)
                if isinstance(last, sp.Expr) and last != sp.Symbol(name, real=True):
                    value = last.xreplace(long)
                column.append(value)
            self._add(line, ", ".join(names), sp.ImmutableMatrix(column))

    def _add_elements(self) -> None:
        """m00 to m22, m11 to m33, and a.x to c.z: nine names that are one matrix."""
        grids: dict[str, _Grid] = {}
        for name in self.state.values:
            value = self._full(name)
            match = _ROW.fullmatch(self.paths.get(name, name)) or ELEMENT.fullmatch(name)
            if match and value is not None:
                place = (int(match["row"], 36) % 10, int(match["column"], 36))
                if match["column"] in _AXES:
                    place = ("abc".index(match["row"]), _AXES[match["column"]])
                stem = match["stem"]
                grid = grids.setdefault(stem, _Grid(self.lines.get(name, 1), stem, {}))
                grid.entries[place] = value
        for stem, grid in grids.items():
            matrix = grid.matrix()
            if matrix is not None and matrix.shape == (3, 3):
                self._add(grid.line, stem.strip("._") or "elements", matrix)

    def _add(self, line: int, name: str, matrix: sp.ImmutableMatrix | None) -> None:
        if matrix is None:
            return
        values = {sp.Symbol(k, real=True): v for k, v in self.cut.items() if v is not None}
        whole: sp.ImmutableMatrix | None = matrix
        for _ in range(_LONG_IN_LONG):
            if whole is not None:
                whole = whole.xreplace(values)
                parts = sum(1 for entry in whole for _ in sp.preorder_traversal(entry))
                whole = whole if parts <= _MOST_PARTS else None
        computed = {sp.Symbol(each, real=True) for each in self.cut}
        unread = tuple(
            (symbol.name, self.lines.get(symbol.name, line))
            for symbol in sorted((whole or matrix).free_symbols & computed, key=str)
            if self.cut[symbol.name] is None and symbol.name not in self.components
        )
        whole = spelled_out(whole, computed) if whole is not None and whole != matrix else None
        self.formulas.append(
            Formula(line, name, spelled_out(matrix, computed), whole=whole, unread=unread)
        )

    # Expressions

    def value(self, node: Node) -> sp.Expr | _Grid:
        """An expression, or a matrix that may be shared; raises ExpressionError."""
        path = _path(node)
        held = self.state.values.get(self.name_of_path(path)) if path is not None else None
        return held if isinstance(held, _Grid) else self._valued(node, self.read(node))

    def _valued(self, node: Node, value: Any) -> sp.Expr | _Grid:
        matrix = as_matrix(value)
        return matrix[0] if len(matrix) == 1 else _Grid.of(_line(node), matrix)

    def read(self, node: Node) -> Any:
        """The value of an expression; raises ExpressionError if it is not understood."""
        self.depth += 1
        try:
            if self.depth > _DEEPEST:
                raise self.unreadable(node, "is nested too deeply")
            digits = _NUMBERS.fullmatch(_text(node)) if not _children(node) else None
            if digits:
                text = digits[1].replace("_", "")
                return number(text if text.isdigit() else repr(float(text)))
            return EXPRESSIONS.get(node.type, _Interpreter._named_node)(self, node)
        except _Unreadable:
            raise
        except ExpressionError as error:
            raise self.unreadable(node, f"is not read: {error}") from None
        finally:
            self.depth -= 1

    def _wrapped(self, node: Node) -> Any:
        children = _children(node)
        if not children:
            raise self.unreadable(node)
        return self.read(_part(node, "value") or children[-1])

    def _list(self, node: Node) -> Any:
        if not _children(node):
            raise self.unreadable(node)
        return rows([self.read(child) for child in _children(node)])

    def _matlab_matrix(self, node: Node) -> Any:
        lines = [row for row in _children(node) if row.type == "row"]
        return rows([rows([self.read(cell) for cell in _children(row)]) for row in lines])

    def _transposed(self, node: Node) -> Any:
        return as_matrix(self.read(_children(node)[0])).T

    def _pointer(self, node: Node) -> Any:
        if _operator(node) != "*":
            raise self.unreadable(node)
        return self.read(_children(node)[-1])

    def _unary(self, node: Node) -> Any:
        if _operator(node) not in ("+", "-"):
            raise self.unreadable(node)
        value = self.read(_children(node)[-1])
        return value if _operator(node) == "+" else combined("*", MINUS, value)

    def _binary(self, node: Node) -> Any:
        left, right = _children(node)[0], _children(node)[-1]
        operator = self._operation(node, _operator(node))
        return combined(operator, self.read(left), self.read(right))

    def _operation(self, node: Node, operator: str) -> str:
        if self.is_matlab:
            operator = _ELEMENTWISE.get(operator, operator)
        elif operator not in _OPERATORS:
            raise self.unreadable(node)
        return "%" if operator == "*" and self.program.is_numpy else operator

    def _conditional(self, node: Node) -> Any:
        if self.program.suffix == ".py":
            first, condition, other = _children(node)
        else:
            parts = (_part(node, f) for f in ("consequence", "condition", "alternative"))
            first, condition, other = (part or node for part in parts)
        constant = _truth(condition)
        if constant is None:
            raise self.unreadable(condition, "is a condition that decides on it")
        return self.read(first if constant else other)

    def _subscript(self, node: Node) -> Any:
        index = self.index(node)
        return self._entry(node, *index) if index is not None else self._named_node(node)

    def index(self, node: Node) -> tuple[str, tuple[int, ...]] | None:
        """The matrix and the indices, from 0, of m[0][1], m(0, 1), m.at(0, 1)."""
        places: list[int | None] = []
        inner, path = node, None
        while inner.type in _EXPRESSIONS["subscript"]:
            base = _part(inner, *_INNER) or inner.named_children[0]
            indices = [c for c in _children(inner) if c != base]
            if len(indices) == 1 and indices[0].type.endswith("argument_list"):
                indices = _children(indices[0])
            places = [*map(self._whole_number, indices), *places] if indices else [None]
            inner = base
        if places:
            path = _path(inner)
        elif inner.type in ("call_expression", "function_call"):
            path = _callee(inner)
            base_path, method = path.rpartition(".")[::2]
            places = [self._whole_number(each) for each in _arguments(inner)]
            is_function = path in self.program.functions and not self.is_matlab
            words = (*FUNCTION_NAMES, *OF_MATRICES, *_WORDS["cast"])
            if is_function or len(places) > 2 or (method and name_of(method) in words):
                return None
            path = base_path if method in _WORDS["entry"] else path
        from0 = tuple(place - self.is_matlab for place in places if place is not None)
        if not path or not from0 or len(from0) < len(places) or min(from0) < 0:
            return None
        return self.name_of_path(path), from0

    def _whole_number(self, node: Node) -> int | None:
        """A constant index: a number, or X, Y, Z."""
        text = _text(node.named_children[0] if node.type == "argument" else node)
        if text.isdecimal() and len(text) < 3:
            return int(text)
        is_axis = text in "XYZ" and text not in self.inputs and text not in self.state.values
        return _AXES[text] + self.is_matlab if is_axis and text else None

    def _entry(self, node: Node, base: str, place: tuple[int, ...]) -> Any:
        grid = self.state.values.get(base)
        if isinstance(grid, str):
            raise _Unreadable(grid)
        if isinstance(grid, _Grid):
            value = grid.entries.get((*place, 0), grid.entries.get(place))
            if value is None:
                raise self.unreadable(node, "has no value")
            return sized(value)
        self.inputs.add(base)
        return self._symbol(node, "_".join([base, *(str(n + self.is_matlab) for n in place)]))

    def _symbol(self, node: Node, name: str) -> Any:
        """The value of a name; an input if nothing was assigned."""
        held = self.state.values.get(name)
        if name in self.untracked:
            raise self.unreadable(node, "is changed inside an expression or an inner function")
        if isinstance(held, str):
            raise _Unreadable(held if held.startswith((f"{name} ", "`")) else f"{name}: {held}")
        if held is None:
            self.inputs.add(name)
        value = held.matrix() if isinstance(held, _Grid) else held
        if value is None and held is not None:
            raise self.unreadable(node, "has entries without values")
        return Sized.atom(sp.Symbol(name, real=True)) if value is None else sized(value)

    def _named_node(self, node: Node) -> Any:
        path = _path(node)
        if path is None:
            raise self.unreadable(node)
        return self._named(node, path)

    def _named(self, node: Node, path: str) -> Any:
        base, _, member = path.rpartition(".")
        if member in CONSTANTS:
            return Sized.atom(CONSTANTS[member])
        grid = self.state.values.get(self.name_of_path(base)) if base else None
        if isinstance(grid, _Grid) and member in _AXES and len(grid.entries) == 3:
            return self._entry(node, self.name_of_path(base), (_AXES[member],))
        return self._symbol(node, self.name_of_path(path))

    def _member_of(self, node: Node) -> Any:
        inner, member = _member(node)
        if inner is None or member != "T":
            return self._named_node(node)
        return as_matrix(self.read(inner)).T

    def name_of_path(self, path: str) -> str:
        """The name of a path, short if no other path of the function has it."""
        path = spelled(path)
        for name in (name_of(path), re.sub(r"\W+", "_", path)) if path else ():
            if self.paths.setdefault(name, path) == path:
                return name
        return re.sub(r"\W+", "__", path)

    # Calls

    def _call(self, node: Node) -> Any:
        """A function of numbers, a method of a matrix, a constructor, or a function of the file."""
        index = self.index(node)
        if index is not None:
            return self._entry(node, *index)
        if (component := _path(node)) is not None:  # q.w()
            return self._named(node, component)
        path = _callee(node)
        base, last = path.rpartition(".")[::2]
        name = name_of(last) if last.isidentifier() else last
        nodes = [each for each in _arguments(node) if each.type != "keyword_argument"]
        options = [_text(each) for each in _arguments(node) if each.type == "keyword_argument"]
        function = _part(node, "function")
        is_member = function is not None and function.type in _EXPRESSIONS["member_of"]
        owner = _member(function)[0] if function and is_member else _part(node, "object")
        held = self.state.values.get(self.name_of_path(base)) if base else None
        is_value = owner is not None and (base == "?" or isinstance(held, _Grid))
        if owner is not None and (is_value or (name in _OF_NUMBERS and len(nodes) < _arity(name))):
            return self._method(node, name, [owner, *nodes], options)
        if name in ("asin", "acos") and nodes:
            nodes = [_unclamped(nodes[0])]
        if name in _OF_NUMBERS and nodes:
            return called(_OF_NUMBERS[name], [self.read(each) for each in nodes])
        is_letter = name in [*"cstCST"] and len(nodes) == 1
        if self.program.is_formula and (name in OF_MATRICES or is_letter):
            return called(name, [self.read(each) for each in nodes])
        is_listed = len(nodes) == 1 or (nodes and nodes[0].type in _EXPRESSIONS["list"])
        if (last in _WORDS["cast"] and len(nodes) == 1) or (
            (name in WRAPPERS or last in ("tensor", "array")) and is_listed
        ):
            return self.read(nodes[0])
        if last in ("dot", "matmul") and len(nodes) == 2:
            return called("dot", [self.read(each) for each in nodes])
        if last == "transpose" and len(nodes) == 1:
            return as_matrix(self.read(nodes[0])).T
        if last in _WORDS["zeros"] | _WORDS["unit"]:
            return self._filled(node, last, nodes)
        if last in _WORDS["stack"] or _BY_COLUMNS.search(last):
            return self._stacked(node, last, nodes, options)
        if last in self.program.functions and base in ("", "self", "this"):
            return self._inline(node, last, nodes)
        return self._constructed(node, path, nodes)

    def _method(self, node: Node, name: str, nodes: Sequence[Node], options: Sequence[str]) -> Any:
        """A method of a matrix or a number; its object is the first of `nodes`."""
        if name in ("transpose", "transposed", "t", "T"):
            return as_matrix(self.read(nodes[0])).T
        if name in _WORDS["same"] and not any(option.startswith("order") for option in options):
            return self.read(nodes[0])
        if name in ("dot", "matmul", "mul", "multiply") and len(nodes) == 2:
            return called("dot", [self.read(each) for each in nodes])
        if name in _OF_NUMBERS:
            return called(_OF_NUMBERS[name], [self.read(each) for each in nodes])
        if len(nodes) > 1:
            return self._constructed(node, name, nodes[1:])  # new Matrix3().set(...)
        raise self.unreadable(node)

    def _filled(self, node: Node, name: str, nodes: Sequence[Node]) -> Any:
        sizes = [int(digits) for digits in re.findall(r"\d+", " ".join(map(_text, nodes)))] or [3]
        is_column = (
            len(sizes) == 1 and bool(nodes) and name in _WORDS["zeros"] and not self.is_matlab
        )
        height, width = sizes[0], 1 if is_column else sizes[-1]
        if not {height, width} <= {3, 4} or _VECTOR_NAME.search(_callee(node)):
            raise self.unreadable(node)
        filled = sp.zeros(height, width) if name in _WORDS["zeros"] else sp.eye(height, width)
        return sp.ImmutableMatrix(filled)

    def _stacked(self, node: Node, name: str, nodes: Sequence[Node], options: Sequence[str]) -> Any:
        axis = re.sub(r"\s", "", "".join(options))
        if axis and not re.fullmatch(r"(axis|dim)=(0|1|-1|-2)", axis):
            raise self.unreadable(node)
        by_columns = bool(_BY_COLUMNS.search(name)) ^ axis.endswith(("=1", "=-1"))
        is_listed = len(nodes) == 1 and nodes[0].type in _EXPRESSIONS["list"]
        matrix = self.read(nodes[0]) if is_listed else rows([self.read(each) for each in nodes])
        return as_matrix(matrix).T if by_columns and 1 not in as_matrix(matrix).shape else matrix

    def _constructed(self, node: Node, path: str, nodes: Sequence[Node]) -> Any:
        """A matrix of nine numbers or three rows, or a vector of three or four numbers."""
        count = len(nodes)
        is_vector = count in (3, 4) and bool(_VECTOR_NAME.search(path))
        is_matrix = count in (3, 9, 16) and bool(_MATRIX_NAME.search(path))
        if not (is_vector or is_matrix):
            raise self.unreadable(node)
        return rows([self.read(each) for each in nodes])

    def _inline(self, node: Node, name: str, nodes: Sequence[Node]) -> Any:
        """The value of a function of the same file."""
        function = self.program.functions[name]
        inner = _Interpreter(self.program, self.inlined + 1)
        names = [each for each in inner.parameters(function) if each not in ("self", "this")]
        if len(names) != len(nodes) or self.inlined >= _INLINED:
            raise self.unreadable(node)
        for each, argument in zip(names, nodes, strict=True):
            value = self.value(argument)
            inner.state.values[each] = value.copy() if isinstance(value, _Grid) else value
        inner.formulas_of(function)
        result = inner.result.matrix() if isinstance(inner.result, _Grid) else inner.result
        if inner.results != 1 or result is None or inner.inputs - set(names) or inner.cut:
            raise self.unreadable(node)
        return sized(result)


def _unclamped(node: Node) -> Node:
    """x of clamp(x, -1, 1): the arc sine of any other number does not exist."""
    arguments = _arguments(node) if node.type in _CALLS else []
    bounds = [re.sub(r"\.0*|[\sfF]|T\(|\)|static_cast<\w+>\(", "", _text(a)) for a in arguments[1:]]
    is_clamp = bounds == ["-1", "1"] and _CLAMPS.search(_callee(node))
    return arguments[0] if is_clamp else node


_OF_NUMBERS = {
    **{name: name for name in FUNCTIONS},
    **{"pow": "pow", "powi": "pow", "powf": "pow", "sq": "sq"},
}


def _arity(name: str) -> int:
    return 2 if _OF_NUMBERS[name] in ("pow", "atan2") else 1


STATEMENTS, EXPRESSIONS = (
    {kind: getattr(_Interpreter, f"_{name}") for name, kinds in table.items() for kind in kinds}
    for table in (_STATEMENTS, _EXPRESSIONS)
)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, _Grid) and isinstance(other, _Grid):
        return one.entries == other.entries
    return type(one) is type(other) and bool(one == other)


_TRIGONOMETRIC = (sp.sin, sp.cos, sp.tan)


def _is_short(value: sp.Expr) -> bool:
    """Whether a name may stand for this: cos(phi), 2*q0, x[3], but no number and no sum."""
    return (
        not value.is_Add
        and not value.is_number
        and all(isinstance(function, _TRIGONOMETRIC) for function in value.atoms(sp.Function))
    )


def _are_components(names: Sequence[str]) -> bool:
    """Whether scalars in a row are one vector: rates, or components of an angular velocity."""
    if tuple(names) in (("p", "q", "r"), ("P", "Q", "R")):
        return True
    last = "".join(name[-1] for name in names)
    is_vector = last in ("xyz", "wxyz", "xyzw") or last in ("012", "123", "0123", "1234")
    same = len({name[:-1] for name in names}) == 1
    return (is_vector and same) or all(map(stem_of, names))
