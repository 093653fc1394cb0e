"""The formulas of a program: a walk over its syntax tree, which follows every assignment.

The walk keeps what each name holds. A name that is changed in a way that cannot be followed, on a
condition or in a loop, holds nothing from there on, and a formula that uses it is unreadable. A new
name for something that is not understood, or is long, is an input of the formulas after it. So a
formula is only read if it says the same in the program. Programs are parsed, never run.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.errors import ExpressionError, MissingExtra
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.tools.compare.language import (
    ANGLE,
    FUNCTION_NAMES,
    OF_MATRICES,
    WRAPPERS,
    name_of,
    read_formula,
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
_DEEPEST = 60  # nested nodes of an expression; formulas of real programs have fewer than 30
_DEEPEST_BLOCK = 40
_LONGEST_PATH = 8  # members of members
_MOST_NODES = 400_000  # of a file: a generated megabyte is not worth reading
_LONG_IN_LONG = 3  # names for long values that use other such names
_MOST_PARTS = 2_000  # of a matrix
_INLINED = 3  # calls of functions of the same file inside one another

_FUNCTIONS = {
    *("function_definition", "function_declaration", "method_definition", "arrow_function"),
    *("function_expression", "function_item", "method_declaration", "constructor_declaration"),
    *("local_function_statement", "lambda", "lambda_expression", "closure_expression"),
}
_NUMBERS = re.compile(r"((?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)_?[fFlLuUdDmM]*(?:32|64)?")
_NAMES = {"identifier", "field_identifier", "property_identifier", "this", "self", "super"}
_MEMBERS = {
    *("attribute", "field_expression", "member_expression", "member_access_expression"),
    *("field_access", "qualified_identifier", "scoped_identifier"),
}
_SUBSCRIPTS = {
    *("subscript", "subscript_expression", "index_expression", "array_access"),
    "element_access_expression",
}
_CALLS = {
    *("call", "call_expression", "function_call", "invocation_expression", "method_invocation"),
    *("object_creation_expression", "new_expression", "compound_literal_expression"),
}
_LISTS = {
    *("list", "tuple", "expression_list", "initializer_list", "array", "array_expression"),
    *("tuple_expression", "array_initializer", "initializer_expression", "argument_list"),
}
_WRAPPED = {  # nodes whose only meaning is their child
    *("parenthesized_expression", "parenthesis", "condition_clause", "as_expression", "argument"),
    *("non_null_expression", "reference_expression", "array_creation_expression", "else_clause"),
}
_ASSIGNMENTS = {"assignment", "assignment_expression", "let_declaration"}
_DECLARATORS = {"init_declarator", "variable_declarator"}
_UPDATES = {"augmented_assignment", "augmented_assignment_expression", "compound_assignment_expr"}
_CHANGES = {*_UPDATES, "update_expression", "assignment_expression"}
_LOOPS = {
    *("for_statement", "while_statement", "do_statement", "for_in_statement", "for_range_loop"),
    *("for_expression", "while_expression", "loop_expression", "foreach_statement"),
    "enhanced_for_statement",
}
_BRANCHES = {"if_statement", "if_expression"}
_CHOICES = {"switch_statement", "switch_expression", "match_statement", "match_expression"}
_CASES = {
    *("case_statement", "switch_case", "switch_default", "case_clause", "match_arm"),
    *("switch_section", "switch_block_statement_group", "switch_rule", "otherwise_clause"),
}
_ENDS = {"raise_statement", "throw_statement", "break_statement", "continue_statement"}
_ENDS |= {"return_statement", "return_expression", "goto_statement"}

_OPERATORS = {"+": "+", "-": "-", "*": "*", "/": "/", "**": "**", "@": "@"}
_ELEMENTWISE = {".*": "%", "./": "/", ".^": "**", "^": "**"}  # MATLAB
_CASTS = {
    *("T", "Scalar", "float", "double", "Real", "real", "real_t", "float32", "float64", "f32"),
    *("f64", "Float", "Double", "btScalar", "static_cast", "Type", "Number", "number", "S"),
}
_SAME = {"copy", "clone", "astype", "to", "reshape", "view", "eval", "noalias", "finished", "into"}
_AXES = {"x": 0, "y": 1, "z": 2, "X": 0, "Y": 1, "Z": 2}
_MATRIX_NAME = re.compile(r"mat|rot|dcm|basis|tensor|^set|setvalue|new|tf", re.IGNORECASE)
_VECTOR_NAME = re.compile(r"vec|quat|^set|new|array", re.IGNORECASE)
_MAY_BE_MATRIX = re.compile(r"[\[{].*,|(?i:sin|cos|mat|quat|dcm)", re.DOTALL)
_BY_COLUMNS = re.compile(r"from_?col|^f?mat3x?3?$|column_stack|hstack|^c_$", re.IGNORECASE)
_HARMLESS = re.compile(
    r"print|disp|log|assert|plot|show|append|push|test|check|expect", re.IGNORECASE
)
_ELEMENT = re.compile(r"(?P<stem>.*?)_?(?P<row>[0-3])_?(?P<column>[0-3])")
_ROW = re.compile(r"(?P<stem>(?:.*\.)?)(?P<row>[abc])\.(?P<column>[xyz])")  # Matrix3 of ArduPilot
SHAPES = {9: (3, 3), 12: (4, 3), 16: (4, 4)}


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


@dataclass
class _Grid:
    """A matrix that may still change, or that is filled entry by entry."""

    line: int
    name: str
    entries: dict[tuple[int, ...], sp.Expr]
    is_whole: bool = False  # assigned at once

    @classmethod
    def of(cls, line: int, name: str, matrix: sp.MatrixBase) -> _Grid:
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
        rows = sorted({index[0] for index in grid})
        columns = sorted({index[-1] for index in grid}) if widths == {2} else [0]
        if len(rows) * len(columns) != len(grid):
            return None
        values = [self.entries[index] for index in grid]
        return shaped(sp.ImmutableMatrix(len(rows), len(columns), values))


def shaped(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Nine, twelve or sixteen numbers in a row are a matrix."""
    is_flat = 1 in matrix.shape and len(matrix) in SHAPES
    return matrix.reshape(*SHAPES[len(matrix)]) if is_flat else matrix


@dataclass
class _State:
    """What the names of a function hold at one place of it."""

    values: dict[str, Any] = field(
        default_factory=dict
    )  # an expression, a _Grid, or a str: why not
    is_over: bool = False  # after a return

    def copy(self) -> _State:
        values = {k: v.copy() if isinstance(v, _Grid) else v for k, v in self.values.items()}
        return _State(values, self.is_over)


def program_formulas(text: str, suffix: str) -> list[Formula]:
    """All matrices and vectors of a program, in the order of its lines."""
    parser = _parser(GRAMMARS[suffix])
    tree = parser.parse(text.encode())
    if tree.root_node.descendant_count > _MOST_NODES:
        return []
    functions = list(_functions(tree.root_node))
    helpers: dict[str, Node] = {}
    for node in functions:
        name = _function_name(node)
        if name:
            helpers[name] = node
    is_numpy = suffix == ".py" and bool(_NUMPY.search(text)) and not _MATRICES.search(text)
    formulas: dict[tuple[int, str, Any], Formula] = {}
    for scope in (tree.root_node, *functions):
        walk = _Walk(suffix, helpers, is_numpy=is_numpy)
        walk.run_scope(scope)
        for formula in walk.formulas:
            formulas.setdefault((formula.line, formula.name, formula.matrix), formula)
    return sorted(formulas.values(), key=lambda each: each.line)


def formula_words(text: str) -> str:
    """A single formula in Python, C, MATLAB or LaTeX, in the words of `read_formula`.

    Raises ExpressionError for a text in none of these languages, and for one that is too long.
    """
    if len(text) > _MOST_CHARACTERS:
        raise ExpressionError(
            f"a formula of {len(text)} characters; expected at most {_MOST_CHARACTERS}"
        )
    if re.search(r"\\[A-Za-z]", text):
        return tex_words(text)
    for suffix in (".cpp",) if "{" in text else (".py", ".m", ".cpp"):
        # a line ends a row in MATLAB only
        line = f"x = {text};" if suffix == ".m" else "x = {};".format(text.replace("\n", " "))
        root = _parser(GRAMMARS[suffix]).parse(f"{'auto ' * (suffix == '.cpp')}{line}".encode())
        stack = [root.root_node]
        while stack and stack[0].type not in (*_ASSIGNMENTS, *_DECLARATORS):
            stack = [*_children(stack[0]), *stack[1:]]
        value = _part(stack[0], "right", "value") if stack else None
        if not root.root_node.has_error and value is not None:
            is_numpy = bool(re.search(r"\b(?:np|numpy|jnp)\.(?:array|asarray)\b", text))
            return _Walk(suffix, {}, is_numpy=is_numpy, is_formula=True).read(value)
    raise ExpressionError(f"not a formula in Python, C, MATLAB or LaTeX: {text[:40]}")


_MOST_CHARACTERS = 20_000  # of a formula
_NUMPY = re.compile(r"^\s*(?:import|from) (?:numpy|jax)\b", re.MULTILINE)
_MATRICES = re.compile(r"\bsympy\b|\bcasadi\b|\b(?:np|numpy)\.mat\(|[mM]atrix\(")  # whose * is @


@cache
def _parser(grammar: str) -> Any:
    try:
        from tree_sitter import Language, Parser

        module = import_module(f"tree_sitter_{grammar}")
    except ImportError as error:
        raise MissingExtra("reading formulas in Python, C and MATLAB", "compare") from error
    language = module.language_typescript if grammar == "typescript" else module.language
    return Parser(Language(language()))


def _functions(root: Node) -> Iterator[Node]:
    """All functions of a file, outer ones first, without recursion."""
    stack = [root]
    while stack:
        node = stack.pop()
        if node.type in _FUNCTIONS:
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
    return _text(part).rpartition("::")[2] if part is not None else ""


def _part(node: Node, *fields: str) -> Node | None:
    """The first of some parts that a node has."""
    return next((p for f in fields if (p := node.child_by_field_name(f)) is not None), None)


def _text(node: Node | None) -> str:
    return node.text.decode(errors="replace") if node is not None and node.text else ""


def _line(node: Node) -> int:
    return node.start_point[0] + 1


def _children(node: Node) -> list[Node]:
    return [c for c in node.named_children if c.type not in ("comment", "line_continuation")]


def _operator(node: Node) -> str:
    return next((_text(c) for c in node.children if not c.is_named), "")


class _Walk:
    """One function, or the code of a file outside of all functions."""

    def __init__(
        self, suffix: str, helpers: Mapping[str, Node], *, is_numpy: bool, is_formula: bool = False
    ) -> None:
        self.suffix = suffix
        self.is_formula = is_formula  # on its own, with the words of `language`
        self.helpers = helpers
        self.is_numpy = is_numpy
        self.shares = suffix in (".py", ".js", ".mjs", ".jsx", ".ts", ".java", ".cs")  # matrices
        self.first = int(suffix == ".m")  # the first index
        self.state = _State()
        self.formulas: list[Formula] = []
        self.paths: dict[str, str] = {}  # name: its path in the program
        self.inputs: set[str] = set()  # names that were read before anything was assigned
        self.cut: set[str] = set()  # names of inputs that stand for something computed
        self.long: dict[str, sp.Expr] = {}  # what they stand for, if that is known
        self.untracked: set[str] = set()
        self.lines: dict[str, int] = {}  # where a name was first assigned
        self.scalars: list[tuple[str, sp.Expr, int]] = []  # the last ones assigned in a row
        self.runs: list[tuple[int, tuple[str, ...], tuple[sp.Expr, ...]]] = []
        self.result: Any = None
        self.depth = 0
        self.inlined = 0

    # Statements

    def run_scope(self, node: Node) -> None:
        self.untracked = self._changed_out_of_order(node)
        if node.type in _FUNCTIONS:
            body = _part(node, "body") or next(
                (c for c in node.named_children if c.type == "block"), None
            )
            if body is None:
                return
            self.inputs |= set(self.parameters(node))
            if not body.type.endswith(("block", "statement", "body")):  # an arrow's expression
                self._return(body)
            else:
                self._run(body)
                last = _children(body)[-1:] if self.suffix == ".rs" else []
                if last and not last[0].type.endswith(("statement", "declaration")):
                    self._return(last[0])
        else:
            self._run(node)
        self._end()

    def _changed_out_of_order(self, scope: Node) -> set[str]:
        """Names that expressions (a := b) or inner functions change: nobody knows when."""
        names: set[str] = set()
        stack = [(child, False) for child in scope.named_children]
        while stack:
            node, is_inner = stack.pop()
            is_inner |= node.type in _FUNCTIONS
            if node.type == "named_expression":
                names.add(self._written(node))
            elif node.type in ("nonlocal_statement", "global_statement"):
                names |= {_text(child) for child in node.named_children}
            elif is_inner and self.suffix != ".py" and node.type in _CHANGES:
                left = _part(node, "left", "argument") or next(iter(_children(node)), None)
                names |= {self._written(left)} if left is not None else set()
            stack += [(child, is_inner) for child in node.named_children]
        return names - {""}

    def parameters(self, node: Node) -> list[str]:
        """The names of the parameters of a function."""
        outer = _part(node, "parameters", "declarator")
        if outer is None:
            outer = next((c for c in node.named_children if c.type == "function_arguments"), None)
        if outer is not None and outer.type.endswith("declarator"):
            while outer is not None and outer.type != "parameter_list":
                outer = _part(outer, "parameters", "declarator")
        return [name for c in (_children(outer) if outer else ()) if (name := self._parameter(c))]

    def _parameter(self, node: Node) -> str:
        while node.type not in _NAMES:
            inner = _part(node, "declarator", "pattern", "name") or next(
                (c for c in node.named_children if c.type in _NAMES or "declarator" in c.type), None
            )
            if inner is None or inner == node:
                return ""
            node = inner
        return self._name_of_path(_text(node))

    def _run(self, node: Node) -> None:
        """One statement, or all statements in a block."""
        if self.state.is_over or (node.type in _FUNCTIONS and self.inlined == 0):
            return
        self.depth += 1
        try:
            if self.depth > _DEEPEST_BLOCK:
                self._forget(node, "nested too deeply")
            else:
                self._statement(node)
        finally:
            self.depth -= 1

    def _statement(self, node: Node) -> None:
        kind = node.type
        if kind in _ASSIGNMENTS or kind in _DECLARATORS:
            self._assignment(node)
        elif kind in _UPDATES or (kind == "update_expression"):
            self._update(node)
        elif kind in _BRANCHES:
            self._branches(node)
        elif kind in _LOOPS:
            self._loop(node)
        elif kind in _CHOICES:
            self._choice(node)
        elif kind in _ENDS:
            self._return(next(iter(_children(node)), None), is_value=kind.startswith("return"))
        elif kind in _CALLS:
            self._call_statement(node)
        elif kind == "binary_expression" and "<<" in (_operator(node),):
            self._stream(node, [])
        elif kind == "comma_expression":
            self._comma(node)
        else:
            self.scalars = self.scalars if kind.endswith(("statement", "declaration")) else []
            for child in _children(node):
                self._run(child)

    def _assignment(self, node: Node) -> None:
        left = _part(node, "left", "declarator", "name", "pattern")
        right = _part(node, "right", "value")
        if right is None and node.type == "variable_declarator":  # C#: no field
            right = next(iter(_children(node)[1:]), None)
        operator = _operator(node)
        if left is None or right is None:
            if left is not None and node.type == "assignment_expression":
                self._drop(left, "not understood")
            return
        if operator not in ("=", ":", "") and operator.endswith("="):  # C: a += b
            self._update(node)
            return
        if right.type in _ASSIGNMENTS:  # a = b = c
            self._run(right)
        while left.type in ("array_declarator", "pointer_declarator", "reference_declarator"):
            inner = _part(left, "declarator") or next(iter(_children(left)), None)
            if inner is None:
                return
            left = inner
        self._assign(left, right)

    def _assign(self, left: Node, right: Node) -> None:
        targets = self._targets(left)
        try:
            value = self.value(right)
        except ExpressionError as error:
            for target in targets or [left]:
                self._drop(target, str(error))
            self.scalars = []
            return
        if targets:
            matrix = value.matrix() if isinstance(value, _Grid) else None
            if matrix is not None and len(matrix) == len(targets) and 1 in matrix.shape:
                for target, entry in zip(targets, matrix, strict=True):
                    self._store(target, entry)
            else:  # w, x, y, z = q
                for target in targets:
                    self._drop(target, "part of a value that is not understood")
            return
        self._store(left, value)

    def _targets(self, left: Node) -> list[Node]:
        """The parts of a tuple on the left."""
        kinds = ("pattern_list", "tuple_pattern", "array_pattern", "multioutput_variable")
        return _children(left) if left.type in (*kinds, "tuple", "list_pattern") else []

    def _store(self, left: Node, value: Any) -> None:
        """An assignment to a name, a member, or an entry."""
        index = self._index(left)
        if index is not None:
            self._store_entry(left, *index, value)
            return
        path = self._path(left)
        if path is None:
            self._drop(left, "an assignment that is not understood")
            return
        name = self._name_of_path(path)
        if isinstance(value, _Grid):
            self._emit(name)
            matrix = value.matrix()
            if not value.name:
                value.line, value.name = _line(left), name
            elif not self.shares:
                value = value.copy()
            if matrix is not None and len(matrix) == 1:
                value = matrix[0]
            else:
                self.state.values[name] = value
                self.scalars = []
                return
        self._store_scalar(name, value, _line(left))

    def _store_scalar(self, name: str, value: sp.Expr, line: int) -> None:
        is_input = name in self.inputs
        self.lines.setdefault(name, line)
        if _is_short(value) or is_input or name in self.cut:
            self.state.values[name] = value
        else:  # a long value, or a number to begin with: an input of the formulas after it
            self.state.values[name] = sp.Symbol(name, real=True)
            self.cut.add(name)
            self.long[name] = value
        self.scalars = [*self.scalars, (name, value, line)][-4:]
        for length in (3, 4):
            names = tuple(each for each, _, _ in self.scalars[-length:])
            if len(names) == length and _are_components(names):
                column = tuple(each for _, each, _ in self.scalars[-length:])
                self.runs.append((line, names, column))

    def _store_entry(self, left: Node, base: str, place: tuple[int, ...], value: Any) -> None:
        if isinstance(value, _Grid):
            self.state.values[base] = "a block of it is assigned"
            return
        grid = self.state.values.get(base)
        if isinstance(grid, str):
            return
        if isinstance(grid, _Grid) and not grid.is_whole:
            matrix = grid.matrix()
            is_anew = place == next(iter(grid.entries)) and matrix is not None
            if is_anew and len(grid.entries) > 1:
                self._emit(base)
                grid = None
        if not isinstance(grid, _Grid):
            grid = _Grid(_line(left), base, {})
            self.state.values[base] = grid
        if grid.is_whole and len(place) == 1 and (place[0], 0) in grid.entries:
            place = (place[0], 0)
        if grid.is_whole and place not in grid.entries:
            self.state.values[base] = "an entry outside of it is assigned"
            return
        grid.entries[place] = value

    def _update(self, node: Node) -> None:
        """a += b, or a++."""
        left = _part(node, "left", "argument", "name") or next(iter(_children(node)), None)
        right = _part(node, "right")
        operator = _operator(node) or _text(_part(node, "operator"))
        if left is None:
            return
        try:
            if right is None or operator[:-1] not in _OPERATORS:
                raise _Unreadable(f"{operator} is not followed")
            text = self._combined(operator[:-1], self.read(left), self.read(right))
            value = self._valued(node, text)
        except ExpressionError as error:
            self._drop(left, str(error))
            return
        if self._index(left) is None:
            self.state.values.pop(self._written(left), None)  # no formula of its own any more
        self._store(left, value)

    def _drop(self, left: Node, reason: str) -> None:
        """What is assigned is not understood: a new name is an input, another holds nothing."""
        for target in self._targets(left):
            self._drop(target, reason)
        index = self._index(left)
        name = index[0] if index else self._written(left)
        if not name:
            return
        reason = f"{name}: {reason}"
        is_new = name not in self.inputs and name not in self.cut and index is None
        if is_new and not isinstance(self.state.values.get(name), _Grid):
            self.cut.add(name)
            self.state.values[name] = sp.Symbol(name, real=True)
        else:
            self.state.values[name] = reason

    def _written(self, left: Node) -> str:
        """The name that an assignment writes to, also through parts that are not understood."""
        node: Node | None = left
        while node is not None:
            path = self._path(node)
            if path is not None:
                return self._name_of_path(path)
            node = _part(node, "argument", "value", "object", "expression", "array", "name") or (
                next(iter(_children(node)), None)
            )
        return ""

    def _branches(self, node: Node) -> None:
        """if, else: each branch from the same state; what differs afterwards holds nothing."""
        branches: list[tuple[Node | None, Node]] = []
        consequence = _part(node, "consequence") or next(
            (c for c in node.named_children if c.type == "block"), None
        )
        if consequence is not None:
            branches.append((_part(node, "condition"), consequence))
        for child in node.named_children:
            if child.type in ("elif_clause", "elseif_clause"):
                branches.append((_part(child, "condition"), child))
        other = next((c for c in node.named_children if c.type == "else_clause"), None)
        other = other or _part(node, "alternative")
        if other is not None and other.type not in ("elif_clause", "elseif_clause"):
            branches.append((None, other))
        before, ends, has_all = self.state, [], False
        for condition, block in branches:
            constant = self._constant(condition)
            if constant == 0:
                continue
            ends.append(self._branch(before, block))
            if condition is None or constant is not None:
                has_all = True
                break
        self._merge(before, ends, has_all=has_all, line=_line(node))

    def _branch(self, before: _State, block: Node) -> _State:
        self.state = before.copy()
        self.scalars = []
        if block.type in ("elif_clause", "elseif_clause", "else_clause"):
            skipped = _part(block, "condition")
            for child in _children(block):
                if child != skipped:
                    self._run(child)
        else:
            self._run(block)
        for name, value in self.state.values.items():
            if isinstance(value, _Grid) and name not in before.values:
                self._emit(name)
        return self.state

    def _constant(self, condition: Node | None) -> int | None:
        """0 or 1 for a constant condition."""
        text = _text(condition).strip("()") if condition is not None else ""
        return {"0": 0, "false": 0, "False": 0, "1": 1, "true": 1, "True": 1}.get(text)

    def _merge(self, before: _State, ends: Sequence[_State], *, has_all: bool, line: int) -> None:
        paths = [*ends, *([] if has_all else [before])]
        alive = [state for state in paths if not state.is_over]
        self.scalars = []
        if not alive:
            self.state = before.copy()
            self.state.is_over = bool(paths)
            return
        self.state = alive[0].copy()
        for name in {name for state in alive for name in state.values}:
            values = [state.values.get(name) for state in alive]
            if all(_same(values[0], value) for value in values[1:]):
                continue
            reason = f"{name} depends on the condition in line {line}"
            is_new = name not in before.values and name not in self.inputs | self.cut
            if is_new and not any(isinstance(value, _Grid) for value in values):
                self.cut.add(name)
                self.state.values[name] = sp.Symbol(name, real=True)
            else:
                self.state.values[name] = reason

    def _loop(self, node: Node) -> None:
        """A loop may run many times or never: what changes in it holds nothing at its start."""
        before = self.state.copy()
        for name in self._assigned(node):
            if name in self.state.values or name in self.inputs:
                self.state.values[name] = f"{name} changes in the loop in line {_line(node)}"
        body = _part(node, "body") or next(
            (c for c in node.named_children if c.type == "block"), node
        )
        for part in ("left", "initializer", "pattern"):
            header = _part(node, part)
            if header is not None and node.type != "for_statement":
                self._drop(header, "changes in a loop")
        start = self.state
        end = self._branch(start, body)
        end.is_over = False
        self._merge(before, [end], has_all=False, line=_line(node))

    def _assigned(self, node: Node) -> set[str]:
        """The names that are written to somewhere in a part of a program."""
        names, stack = set(), [node]
        kinds = {*_ASSIGNMENTS, *_DECLARATORS, *_UPDATES, "update_expression"}
        while stack:
            each = stack.pop()
            if each.type in kinds:
                left = _part(each, "left", "declarator", "name", "pattern", "argument")
                left = left or next(iter(_children(each)), None)
                for target in (self._targets(left) or [left]) if left is not None else ():
                    names.add(self._written(target))
            elif each.type in _CALLS or each.type == "binary_expression":
                names |= self._reached(each)
            stack += each.named_children
        return names - {""}

    def _choice(self, node: Node) -> None:
        before, ends, stack = self.state, [], _children(node)
        while stack:
            each = stack.pop(0)
            if each.type in _CASES:
                end = self._branch(before, each)
                end.is_over = False  # a break leaves only the choice
                ends.append(end)
            elif each.type not in _FUNCTIONS:
                stack = [*_children(each), *stack]
        self._merge(before, ends, has_all=False, line=_line(node))

    def _forget(self, node: Node, reason: str) -> None:
        for name in self._assigned(node):
            self.state.values[name] = reason

    def _return(self, node: Node | None, *, is_value: bool = True) -> None:
        if node is not None and is_value:
            try:
                value = self.value(node)
                self.result = (self.result, value) if self.result is not None else value
                path = self._path(node)
                if isinstance(value, _Grid) and path is None:
                    self._add(_line(node), "returned", value.matrix())
            except ExpressionError as error:
                if _MAY_BE_MATRIX.search(_text(node)):
                    self._add(_line(node), "returned", None, str(error))
        for name, value in self.state.values.items():
            if isinstance(value, _Grid):
                self._emit(name)
        self.state.is_over = True

    def _call_statement(self, node: Node) -> None:
        """A call may change the object and the matrices that it is given."""
        arguments = self._arguments(node)
        function = self._callee(node)
        if "::" in _text(_part(node, "function")):  # of a type, not of an object
            return
        base, method = function.rpartition(".")[::2]
        if base and (_MATRIX_NAME.search(method) or _VECTOR_NAME.search(method)):
            try:
                texts = [self.read(argument) for argument in arguments]
                if len(texts) in (3, 4, 9, 16):
                    name = self._name_of_path(base)
                    matrix = shaped(self._formula(f"[{','.join(texts)}]"))
                    self._emit(name)
                    self.state.values[name] = _Grid.of(_line(node), name, matrix)
                    return
            except ExpressionError:
                pass  # the call is taken as any other below
        if _HARMLESS.search(function):
            return
        for name in self._reached(node):
            if name in self.state.values or name in self.inputs:
                self.state.values[name] = f"{name} may be changed by {function}"

    def _reached(self, node: Node) -> set[str]:
        """Names that a call, or a stream, may change: its object, matrices, and &name."""
        if node.type not in _CALLS:
            return {self._written(node)} if _operator(node) == "<<" else set()
        names = set()
        base = self._callee(node).rpartition(".")[0]
        if base and isinstance(self.state.values.get(self._name_of_path(base)), _Grid):
            names.add(self._name_of_path(base))
        for argument in self._arguments(node):
            path = self._path(argument)
            if argument.type == "pointer_expression" or (
                path is not None
                and isinstance(self.state.values.get(self._name_of_path(path)), _Grid)
            ):
                names.add(self._written(argument))
        return names - {""}

    def _comma(self, node: Node) -> None:
        """a = b, c = d; or R << a, b, c."""
        parts: list[Node] = []
        rest: Node = node
        while rest.type == "comma_expression":
            left, right = _part(rest, "left"), _part(rest, "right")
            if left is None or right is None:
                return
            parts.append(left)
            rest = right
        parts.append(rest)
        if parts[0].type == "binary_expression" and _operator(parts[0]) == "<<":
            self._stream(parts[0], parts[1:])
            return
        for part in parts:
            self._run(part)

    def _stream(self, node: Node, others: Sequence[Node]) -> None:
        """Eigen's comma initialiser."""
        left, right = _part(node, "left"), _part(node, "right")
        if left is None or right is None:
            return
        try:
            texts = [self.read(part) for part in (right, *others)]
            value = _Grid.of(_line(node), "", shaped(self._formula(f"[{','.join(texts)}]")))
        except ExpressionError as error:
            self._drop(left, str(error))
            return
        self._store(left, value)

    # What is found

    def _emit(self, name: str) -> None:
        """A name is about to hold something else, or the function ends."""
        grid = self.state.values.get(name)
        if isinstance(grid, _Grid) and grid.name:  # not what a helper returned
            self._add(grid.line, grid.name, grid.matrix())

    def _end(self) -> None:
        if not self.state.is_over:
            for name in list(self.state.values):
                self._emit(name)
        for line, names, column in self.runs:
            held = [self.state.values.get(name) for name in names]
            values = [
                sp.sympify(last).xreplace(
                    {sp.Symbol(k, real=True): v for k, v in self.long.items()}
                )
                if isinstance(last, sp.Expr) and last != sp.Symbol(name, real=True)
                else first
                for name, last, first in zip(names, held, column, strict=True)
            ]
            self._add(line, ", ".join(names), sp.ImmutableMatrix(values))
        self._add_elements()

    def _add_elements(self) -> None:
        """m00 to m22, m11 to m33, and a.x to c.z: nine names that are one matrix."""
        grids: dict[str, dict[tuple[int, ...], sp.Expr]] = {}
        lines: dict[str, int] = {}
        for name, held in self.state.values.items():
            value = self.long.get(name) if name in self.long else held
            path = self.paths.get(name, name)
            match = _ROW.fullmatch(path) or _ELEMENT.fullmatch(name)
            if match and isinstance(value, sp.Expr):
                place = (int(match["row"], 36) % 10, int(match["column"], 36))
                if match["column"] in _AXES:
                    place = ("abc".index(match["row"]), _AXES[match["column"]])
                grids.setdefault(match["stem"], {})[place] = value
                lines.setdefault(match["stem"], self.lines.get(name, 1))
        for stem, entries in grids.items():
            grid = _Grid(0, stem, entries)
            matrix = grid.matrix() if len(entries) == 9 else None
            if matrix is not None and matrix.shape == (3, 3):
                self._add(lines[stem], stem.strip("._") or "elements", matrix)

    def _add(
        self, line: int, name: str, matrix: sp.ImmutableMatrix | None, reason: str = ""
    ) -> None:
        whole = None
        if matrix is not None:
            computed = {sp.Symbol(name, real=True) for name in self.cut}
            whole, matrix = self._whole(matrix), spelled_out(matrix, computed)
            whole = spelled_out(whole, computed) if whole is not None else None
        if matrix is not None or reason:
            self.formulas.append(Formula(line, name, matrix, reason, whole))

    def _whole(self, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix | None:
        """The matrix with the values of its long names, unless it is then too large to compare."""
        values = {sp.Symbol(name, real=True): value for name, value in self.long.items()}
        whole = matrix
        for _ in range(_LONG_IN_LONG):
            whole = whole.xreplace(values)
            if sum(1 for entry in whole for _ in sp.preorder_traversal(entry)) > _MOST_PARTS:
                return None
        return whole if whole != matrix else None

    # Values

    def value(self, node: Node) -> Any:
        """An expression, or a _Grid; raises ExpressionError if it is not understood."""
        path = self._path(node)
        held = self.state.values.get(self._name_of_path(path)) if path is not None else None
        if isinstance(held, _Grid):
            return held
        return self._valued(node, self.read(node))

    def _valued(self, node: Node, text: str) -> Any:
        matrix = self._formula(text)
        return matrix[0] if len(matrix) == 1 else _Grid.of(_line(node), "", shaped(matrix))

    def _formula(self, text: str) -> sp.ImmutableMatrix:
        names = {
            name: value.matrix() if isinstance(value, _Grid) else value
            for name, value in self.state.values.items()
            if not isinstance(value, str)
        }
        return read_formula(text, {k: v for k, v in names.items() if v is not None}, free=True)

    def read(self, node: Node) -> str:
        """An expression in the words of `read_formula`."""
        self.depth += 1
        try:
            if self.depth > _DEEPEST:
                raise _Unreadable("nested too deeply")
            return self._expression(node)
        finally:
            self.depth -= 1

    def _expression(self, node: Node) -> str:
        kind, children = node.type, _children(node)
        if (match := _NUMBERS.fullmatch(_text(node))) and not children:
            return match[1].replace("_", "")
        if kind in _WRAPPED and children:
            return self.read(_part(node, "value") or children[-1])
        if kind in ("cast_expression", "type_cast_expression", "static_cast_expression"):
            return self.read(_part(node, "value") or children[-1])
        if kind in ("unary_operator", "unary_expression", "prefix_unary_expression"):
            return self._unary(node)
        if kind == "pointer_expression" and _operator(node) == "*":
            return self.read(children[-1])
        if kind in ("binary_operator", "binary_expression"):
            return self._binary(node)
        if kind in ("conditional_expression", "ternary_expression"):
            return self._conditional(node)
        if kind == "matrix":
            rows = [c for c in children if c.type == "row"]
            cells = [[self.read(cell) for cell in _children(row)] for row in rows]
            return "[" + ",".join(f"[{','.join(row)}]" for row in cells) + "]"
        if kind in _LISTS and children:
            return "[" + ",".join(self.read(child) for child in children) + "]"
        if kind == "postfix_operator" and children:
            return f"({self.read(children[0])}).T"
        index = self._index(node)
        if index is not None:
            return self._entry(*index)
        if kind in _CALLS:
            return self._call(node)
        if kind in _MEMBERS:
            inner, member = self._member(node)
            if inner is not None and member == "T":
                return f"({self.read(inner)}).T"
        path = self._path(node)
        if path is None:
            raise _Unreadable(f"{kind.replace('_', ' ')} is not understood")
        return self._named(path)

    def _named(self, path: str) -> str:
        if path.rpartition(".")[2] in ("pi", "PI", "M_PI", "Pi"):
            return "pi"
        base, _, member = path.rpartition(".")
        grid = self.state.values.get(self._name_of_path(base)) if base else None
        if isinstance(grid, _Grid) and member in _AXES and len(grid.entries) == 3:
            return self._entry(self._name_of_path(base), (_AXES[member],))
        name = self._name_of_path(path)
        if name in self.untracked:
            raise _Unreadable(f"{name} is changed inside an expression or an inner function")
        held = self.state.values.get(name)
        if isinstance(held, str):
            raise _Unreadable(held)
        if isinstance(held, _Grid) and held.matrix() is None:
            raise _Unreadable(f"{name} has entries that are not known")
        if held is None:
            self.inputs.add(name)
        return name

    def _unary(self, node: Node) -> str:
        operator = _operator(node)
        if operator not in ("+", "-"):
            raise _Unreadable(f"{operator} is not understood")
        return f"({operator}{self.read(_children(node)[-1])})"

    def _binary(self, node: Node) -> str:
        left, right = _children(node)[0], _children(node)[-1]
        return self._combined(_operator(node), self.read(left), self.read(right))

    def _combined(self, operator: str, left: str, right: str) -> str:
        is_matlab = self.suffix == ".m" or self.is_formula
        word = _ELEMENTWISE.get(operator) if is_matlab else None
        word = word or _OPERATORS.get(operator)
        if word is None:
            raise _Unreadable(f"{operator} is not understood")
        if word == "*" and self.is_numpy:
            word = "%"
        return f"({left}{word}{right})"

    def _conditional(self, node: Node) -> str:
        if self.suffix == ".py":
            first, condition, other = _children(node)
        else:
            parts = (_part(node, f) for f in ("consequence", "condition", "alternative"))
            first, condition, other = (part or node for part in parts)
        constant = self._constant(condition)
        if constant is None:
            raise _Unreadable(f"it depends on a condition: {_text(condition)[:40]}")
        return self.read(first if constant else other)

    def _index(self, node: Node) -> tuple[str, tuple[int, ...]] | None:
        """The matrix and the indices, from 0, of m[0][1], m(0, 1), m.at(0, 1)."""
        places: list[int] = []
        inner: Node | None = node
        while inner is not None and inner.type in _SUBSCRIPTS:
            base = _part(inner, "argument", "value", "object", "expression", "array")
            base = base or inner.named_children[0]
            indices = [c for c in _children(inner) if c != base]
            if len(indices) == 1 and indices[0].type.endswith("argument_list"):
                indices = _children(indices[0])
            numbers = [self._number(index) for index in indices]
            if not numbers or None in numbers:
                return None
            places = [int(n) for n in numbers if n is not None] + places
            inner = base
        if inner is not None and not places and inner.type in ("call_expression", "function_call"):
            function = self._callee(inner)
            if name_of(function.rpartition(".")[2]) in (*FUNCTION_NAMES, *OF_MATRICES, *_CASTS):
                return None
            numbers = [self._number(each) for each in self._arguments(inner)]
            if not numbers or None in numbers or len(numbers) > 2:
                return None
            base_path, method = function.rpartition(".")[::2]
            is_method = method in ("at", "coeff", "coeffRef", "get", "operator()", "element")
            if not function or (function in self.helpers and self.suffix != ".m"):
                return None
            places = [int(n) - self.first for n in numbers if n is not None]
            path: str | None = base_path if is_method else function
        else:
            path = self._path(inner) if inner is not None and places else None
            places = [n - self.first for n in places]
        if path is None or not path or min(places) < 0:
            return None
        return self._name_of_path(path), tuple(places)

    def _number(self, node: Node) -> int | None:
        """A constant index: a number, or x, y, z."""
        text = _text(node.named_children[0] if node.type == "argument" else node)
        if text.isdecimal() and len(text) < 3:
            return int(text)
        is_axis = text in _AXES and text not in self.inputs and text not in self.state.values
        return _AXES[text] + self.first if is_axis and text.isupper() else None

    def _entry(self, base: str, place: tuple[int, ...]) -> str:
        grid = self.state.values.get(base)
        if isinstance(grid, str):
            raise _Unreadable(grid)
        if isinstance(grid, _Grid):
            place = (*place, 0) if (*place, 0) in grid.entries else place
            value = grid.entries.get(place)
            if value is None:
                raise _Unreadable(f"{base} has no entry {place}")
            name = "_".join(["entry", base, *map(str, place)])
        else:
            name = "_".join([base, *(str(n + self.first) for n in place)])
            value = self.state.values.get(name)
            if value is None:
                self.inputs |= {name, base}
                return name
        if isinstance(value, str):
            raise _Unreadable(value)
        self.state.values[name] = value
        return name

    # Calls

    def _callee(self, node: Node) -> str:
        """The path of the function that is called: np.array, Math.sin, R.transpose."""
        function = _part(node, "function", "constructor", "type")
        if node.type == "method_invocation":
            inner, name = _part(node, "object"), _text(_part(node, "name"))
            base = self._path(inner) if inner is not None else ""
            return f"{base}.{name}" if base else name
        if node.type == "function_call":  # MATLAB
            function = _part(node, "name")
        if function is None:
            return ""
        if function.type in _MEMBERS:
            inner, member = self._member(function)
            base = self._path(inner) if inner is not None else ""
            return f"{base}.{member}" if base else f"?.{member}"
        return re.sub(r"<.*>", "", _text(function)).replace("::", ".")

    def _arguments(self, node: Node) -> list[Node]:
        outer = _part(node, "arguments", "value")
        outer = outer or next((c for c in node.named_children if c.type == "arguments"), None)
        return _children(outer) if outer is not None else []

    def _call(self, node: Node) -> str:
        path = self._callee(node)
        base, last = path.rpartition(".")[::2]
        name = name_of(last) if last.isidentifier() else last
        function = _part(node, "function")
        inner = self._member(function)[0] if function is not None and base else None
        inner = inner or _part(node, "object")
        arguments = [a for a in self._arguments(node) if a.type != "keyword_argument"]
        if self._path(node) is not None:  # q.w()
            return self._named(self._path(node) or "")
        if name in FUNCTIONS and arguments:
            return f"{name}({','.join(map(self.read, arguments))})"
        is_value = inner is not None and (base == "?" or self._is_held(base))
        if is_value and inner is not None:
            return self._method(name, inner, arguments)
        if name in FUNCTIONS and inner is not None:  # Rust: a.sin()
            return f"{name}({self.read(inner)})"
        if name in ("powi", "powf") and inner is not None:
            return f"pow({self.read(inner)},{self.read(arguments[0])})"
        if name in ("pow", "sq"):
            return f"{name}({','.join(map(self.read, arguments))})"
        if self.is_formula and (name in OF_MATRICES or (name in "cstCST" and len(arguments) == 1)):
            return f"{name}({','.join(map(self.read, arguments))})"
        if last in _CASTS and len(arguments) == 1:
            return self.read(arguments[0])
        if name in WRAPPERS or last in ("tensor", "array"):
            if len(arguments) == 1 or (arguments and arguments[0].type in _LISTS):
                return self.read(arguments[0])
        elif last in ("dot", "matmul") and len(arguments) == 2:
            return f"dot({','.join(map(self.read, arguments))})"
        elif last in ("transpose",) and len(arguments) == 1:
            return f"({self.read(arguments[0])}).T"
        elif last in ("zeros", "eye", "identity", "Identity", "Zero", "empty"):
            return self._filled(last, arguments)
        if last in ("stack", "vstack", "row_stack", "block", "concatenate") or (
            _BY_COLUMNS.search(last)
        ):
            return self._stacked(node, last, arguments)
        if last in self.helpers and base in ("", "self", "this"):
            return self._inline(last, arguments)
        if _MATRIX_NAME.search(path) or _VECTOR_NAME.search(path):
            return self._constructed(path, arguments)
        raise _Unreadable(f"{path or 'a call'}() is not understood")

    def _is_held(self, base: str) -> bool:
        return isinstance(self.state.values.get(self._name_of_path(base)), _Grid)

    def _method(self, name: str, inner: Node, arguments: Sequence[Node]) -> str:
        """A method of a matrix."""
        if name in ("transpose", "transposed", "t", "T"):
            return f"({self.read(inner)}).T"
        if name in _SAME:
            return self.read(inner)
        if name in ("dot", "matmul", "mul", "multiply") and len(arguments) == 1:
            return f"dot({self.read(inner)},{self.read(arguments[0])})"
        if name in FUNCTIONS and not arguments:
            return f"{name}({self.read(inner)})"
        if name in ("powi", "powf"):
            return f"pow({self.read(inner)},{self.read(arguments[0])})"
        if _MATRIX_NAME.search(name) and arguments:  # new Matrix3().set(...)
            return self._constructed(name, arguments)
        raise _Unreadable(f"{name}() is not understood")

    def _filled(self, name: str, arguments: Sequence[Node]) -> str:
        digits = re.findall(r"\d+", " ".join(map(_text, arguments)))
        sizes = [int(d) for d in digits[:2]] or [3]
        rows, columns = sizes[0], sizes[-1] if len(sizes) > 1 or self.suffix == ".m" else sizes[0]
        if rows not in (3, 4) or columns not in (3, 4) or name == "empty":
            raise _Unreadable(f"{name}() is not understood")
        if name in ("zeros", "Zero"):
            return "[" + ",".join("[" + ",".join("0" * columns) + "]" for _ in range(rows)) + "]"
        return f"one({rows})"

    def _stacked(self, node: Node, name: str, arguments: Sequence[Node]) -> str:
        axis = next((_text(a) for a in self._arguments(node) if a.type == "keyword_argument"), "")
        if axis and not re.fullmatch(r"(axis|dim)\s*=\s*(0|1|-1|-2)", axis):
            raise _Unreadable(f"{name}({axis}) is not understood")
        by_columns = bool(_BY_COLUMNS.search(name)) ^ axis.endswith(("=1", "=-1", "= 1", "= -1"))
        listed = len(arguments) == 1 and arguments[0].type in _LISTS
        text = self.read(arguments[0]) if listed else f"[{','.join(map(self.read, arguments))}]"
        matrix = self._formula(text)
        return f"({text}).T" if by_columns and 1 not in matrix.shape else text

    def _constructed(self, path: str, arguments: Sequence[Node]) -> str:
        """A matrix of nine numbers or three rows, or a vector of three or four numbers."""
        texts = [self.read(argument) for argument in arguments]
        count = len(texts)
        is_vector = count in (3, 4) and bool(_VECTOR_NAME.search(path))
        is_matrix = count in (3, 9, 16) and bool(_MATRIX_NAME.search(path))
        if not (is_vector or is_matrix):
            raise _Unreadable(f"{path}() with {count} arguments is not understood")
        return f"[{','.join(texts)}]"

    def _inline(self, name: str, arguments: Sequence[Node]) -> str:
        """The value of a function of the same file."""
        if self.inlined >= _INLINED:
            raise _Unreadable(f"{name}() calls too many others")
        node = self.helpers[name]
        walk = _Walk(self.suffix, self.helpers, is_numpy=self.is_numpy)
        walk.inlined = self.inlined + 1
        names = [each for each in walk.parameters(node) if each not in ("self", "this")]
        if len(names) != len(arguments):
            raise _Unreadable(f"{name}() is called with {len(arguments)} arguments")
        for each, argument in zip(names, arguments, strict=True):
            value = self.value(argument)
            walk.state.values[each] = value.copy() if isinstance(value, _Grid) else value
        walk.run_scope(node)
        if isinstance(walk.result, tuple) or walk.result is None or walk.inputs - set(names):
            raise _Unreadable(f"{name}() is not understood")
        if walk.cut:
            raise _Unreadable(f"{name}() is not understood")
        word = f"result_{len(self.state.values)}"
        self.state.values[word] = walk.result
        return word

    # Names

    def _member(self, node: Node) -> tuple[Node | None, str]:
        """The object and the name of its member."""
        inner = _part(node, "object", "argument", "value", "expression", "scope", "path")
        member = _part(node, "attribute", "field", "property", "name")
        return inner, _text(member)

    def _path(self, node: Node, depth: int = 0) -> str | None:
        """self.phi, p->x, q.w() and ns::name with dots, or None for other expressions."""
        if node.type in _NAMES:
            return _text(node)
        if depth > _LONGEST_PATH:
            return None
        depth += 1
        if node.type in _WRAPPED and len(_children(node)) == 1:
            return self._path(_children(node)[0], depth)
        if node.type == "pointer_expression" and _operator(node) == "*":
            return self._path(_children(node)[-1], depth)
        if node.type in _MEMBERS:
            inner, member = self._member(node)
            base = self._path(inner, depth) if inner is not None else ""
            is_name = re.fullmatch(r"\w+", member) and member != "T"
            return f"{base}.{member}" if base and is_name else None
        if node.type == "call_expression" and not self._arguments(node):
            function = _part(node, "function")
            if function is not None and function.type in _MEMBERS:
                inner, member = self._member(function)
                base = self._path(inner, depth) if inner is not None else ""
                is_component = member in "wxyz" or ANGLE.fullmatch(member)
                return f"{base}.{member}" if base and is_component else None
        if node.type in _SUBSCRIPTS and _text(node)[-2:-1] in ("'", '"'):  # state["phi"]
            base = self._path(node.named_children[0], depth)
            return f"{base}.{_text(node)[:-2].rpartition(_text(node)[-2])[2]}" if base else None
        return None

    def _name_of_path(self, path: str) -> str:
        """The name of a path, short where no other path of the function has it."""
        for name in (name_of(path), re.sub(r"\W+", "_", path)):
            if self.paths.setdefault(name, path) == path:
                return name
        return re.sub(r"\W+", "__", path)


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
