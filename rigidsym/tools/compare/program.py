"""The formulas of a program: an abstract interpreter over its syntax tree.

It runs each function with symbols in place of numbers, and keeps a table of values for each name:
{(): x} for a scalar, {(0, 1): x, ...} for a matrix. A long value gets a symbol of its own, and so
does one that cannot be read, or that a condition or a loop may change. A formula is therefore right
for every value of what is not read, and says which that is. `nodes.toml` gives the meaning of each
type of node and of the words of libraries. Programs are parsed, never run.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice, pairwise, product
from typing import TYPE_CHECKING, Any, NamedTuple

import sympy as sp

from rigidsym.errors import ExpressionError, offer
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.names import spelled
from rigidsym.tools.compare import syntax as tree
from rigidsym.tools.compare.language import (
    ANGLE,
    CONSTANTS,
    OF_MATRICES,
    as_matrix,
    called,
    combined,
    number,
    rows,
    spelled_out,
)
from rigidsym.tools.compare.latex import python_of
from rigidsym.tools.compare.quantities import stem_of
from rigidsym.tools.compare.syntax import CALLS, EXPRESSIONS, ORDERS, PARTS, STATEMENTS, Call

if TYPE_CHECKING:
    from tree_sitter import Node

_SHARING = (".py", ".js", ".mjs", ".jsx", ".ts", ".java", ".cs")  # b = a is the same matrix
_WITH_SWIZZLES = (".cs", ".cu", ".cuh")  # float4 v has v.x, and v * w is entry by entry
_DEEPEST = 60  # nested nodes of an expression; formulas of real programs have fewer than 30
_DEEPEST_BLOCK = 40
_LONGEST_LIST = 64
_MOST_FORMULAS = 1_000  # of a file
_MOST_STEPS = 12_000  # expressions of a file: what takes some seconds
_MOST_NODES = 400_000  # of a file: a generated megabyte is not worth reading
_MOST_CHARACTERS = 20_000  # of a formula
_LONGEST_PLACE = 120  # characters
_LONGEST = 40  # parts of a value without a symbol of its own
_LONG_IN_LONG = 3  # symbols for long values that use other such symbols
_MOST_PARTS = 2_000  # of a matrix
_LONGEST_STATE = 20  # entries of a vector whose parts are looked at
_MOST_RUNS = 24  # of a function, with other branches
_INLINED = 3  # calls of functions of the same file inside one another

_NUMBERS = re.compile(r"(-?)((?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)_?[fFlLuUdDmM]*(?:32|64)?")
_NUMPY = re.compile(r"^\s*(?:import|from) (?:numpy|jax)\b", re.MULTILINE)
_MATRICES = re.compile(r"\bsympy\b|\bcasadi\b|\b(?:np|numpy)\.mat\(|[mM]atrix\(")  # whose * is @
_MATRIX_NAME = re.compile(r"mat|rot|dcm|basis|tensor|^set|setvalue|new|tf|\dx\d", re.IGNORECASE)
_VECTOR_NAME = re.compile(r"vec|quat|^set|new|array|wxyz|xyzw|float[34]$", re.IGNORECASE)
_MAY_BE_MATRIX = re.compile(r"[\[{].*,|(?i:sin|cos|mat|quat|dcm)", re.DOTALL)
_BY_COLUMNS = re.compile(
    r"from_?col|^f?mat3x?3?$|float[34]x[34]|column_stack|hstack|^c_$", re.IGNORECASE
)
ANGLES_NAME = re.compile(r"rpy|ypr|euler|attitude|angles|Δ_*(roll|phi)", re.IGNORECASE)
_RATES_NAME = re.compile(r"omega|w|gyro|(body_?|angular_?)?rates?|ang(ular)?_?vel(ocity)?", re.I)
_HARMLESS = re.compile("print|disp|log|assert|plot|show|append|push|test|check|expect", re.I)
_TYPE = re.compile(r"[a-z]?vec[234]?|float[34]|Vec\w*|[a-z]*[qQ]uat\w*")  # of a vector
_MODULE = re.compile(
    r"(?:np|numpy|jnp|torch|tf|math|mx|cs|ca|F|self|this)\b|_?[A-Z]+[a-z]|[A-Z]{2,}"
)
_GETTER = re.compile(rf"(?:get)?_?([wxyz]|{ANGLE.pattern}|xyz|vec|imag)_?", re.IGNORECASE)
_SWIZZLE = re.compile(r"[xyzw]{1,4}|[XYZW]")
_INDEX_NAME = re.compile(r"^(?:#define )?(\w+)(?: *= *| +)(\d\d?);?$", re.MULTILINE)
_MACRO = re.compile(r"macro_rules!\s*\w+\s*\{\s*\([^{}]*?\)\s*=>\s*\{")
_PARTS_OF = dict.fromkeys(("vec", "imag", "v"), "xyz")
_AXES = {"x": 0, "y": 1, "z": 2, "X": 0, "Y": 1, "Z": 2}
_SHORT = (sp.sin, sp.cos, sp.tan)  # functions in values that get no symbol
_INVERSE = (sp.atan2, sp.asin, sp.acos, sp.atan)
_OPERATORS = ("+", "-", "*", "/", "**", "@")
_ELEMENTWISE = {".*": "%", "./": "/", ".^": "**", "^": "**"}  # MATLAB
_FLAT = {9: (3, 3), 12: (4, 3), 16: (4, 4)}
_OF_NUMBERS = {*FUNCTIONS, "pow", "sq", "sind", "cosd", "tand", "deg2rad", "rad2deg"}
_RESERVED = (*_OF_NUMBERS, *OF_MATRICES, *CALLS)  # names that no array has
_OF_OBJECTS = [
    "same",
    "transpose",
    "dot",
    "cross",
    "outer",
    "norm",
    "skew",
    "inverse",
    "clamp",
    "least",
    "pair",
]
_RETURNED, _ARGUMENT = "returned", "argument"  # in place of a name
_ALL = slice(None)
_BOOLEANS = {"0": False, "false": False, "False": False, "1": True, "true": True, "True": True}

# Scalars that are one vector or matrix: patterns of a stem and an index. The name of an angle is
# the index of its vector, r.phi beside r.theta.
_GROUPS = (
    re.compile(r"(?P<stem>.*?)_?(?P<index>[0-3]_?[0-3])"),
    re.compile(r"(?P<stem>.*?)(?P<index>[abc]\.[xyz])"),  # Matrix3 of ArduPilot
    re.compile(r"(?P<stem>.*m)(?P<index>\d\d?)"),
    re.compile(r"(?P<stem>.*?)(?P<index>[wxyzWXYZ0-4])"),
    re.compile(r"(?P<stem>)(?P<index>[pqrPQR])"),
)
_COMPLETE = {frozenset(order.split()): order.split() for order in ORDERS}

Indices = tuple[Any, ...]  # whole numbers and slices
Table = dict[tuple[int, ...], sp.Expr]
Values = dict[str, Table]


class Place(NamedTuple):
    """A name or an entry: self.phi, p->x, m[0][1], R(1, 2), R.at(0, 1), q[1:]."""

    path: str  # with dots
    indices: Indices = ()


@dataclass(frozen=True, kw_only=True)
class Formula:
    """A matrix or vector of a program, or the reason why it is not read."""

    lines: tuple[int, ...]  # of the assignments of its components
    of_entries: tuple[int, ...] = ()  # lines, row by row, if they are assigned one by one
    name: str
    forms: tuple[sp.ImmutableMatrix, ...] = ()  # in terms of the inputs, and of long values
    reason: str = ""
    unread: tuple[tuple[str, int], ...] = ()  # names in it whose values are not read, and lines

    @property
    def line(self) -> int:
        """Where it begins."""
        return min(self.lines)

    @property
    def is_named(self) -> bool:
        return self.name not in (_RETURNED, _ARGUMENT)


@dataclass(frozen=True)
class _Program:
    """All functions know this of their file."""

    suffix: str
    functions: Mapping[str, Node] = field(default_factory=dict)
    constants: Mapping[str, int] = field(default_factory=dict)  # q_i = 0 of the whole file
    is_numpy: bool = False  # * is the product entry by entry
    is_formula: bool = False  # a formula on its own, with the functions of `language`
    steps: Counter[str] = field(default_factory=Counter)  # expressions that were read


@dataclass
class _Branches:
    """The branch that a run of a function takes at each node: one that no run has taken.

    If all have been taken, it is one in which a later choice is still open, or the last.
    """

    taken: set[tuple[int, int]] = field(default_factory=set)
    now: dict[int, int] = field(default_factory=dict)
    places: dict[int, int] = field(default_factory=dict)  # of nodes with other branches
    is_new: bool = True  # whether the last run took a new branch

    def choice(self, node: Node, blocks: Sequence[Node | None]) -> int:
        """The number of the branch."""
        if node.id not in self.now:
            free = [k for k in range(len(blocks)) if (node.id, k) not in self.taken]
            starts = [block.start_byte for block in blocks if block] + [node.end_byte]
            spans = pairwise(starts)  # the first is the node itself, which has the others in it
            places = [place for n, place in self.places.items() if n != node.id]
            within = [k for k, (i, j) in enumerate(spans) if any(i <= p < j for p in places)]
            self.now[node.id] = (free or within or [len(blocks) - 1])[0]
            self.is_new |= bool(free)
            self.taken.add((node.id, self.now[node.id]))
            self.places[node.id] = node.start_byte
            if len(free) < 2:
                del self.places[node.id]
        return self.now[node.id]


def program_formulas(text: str, suffix: str) -> list[Formula]:
    """All matrices and vectors of a program, in the order of its lines."""
    if suffix == ".rs":  # the body of a macro is code
        text = _MACRO.sub(lambda m: "mod macros {" + "\n" * m[0].count("\n"), text)
        text = re.sub(r"\$(?=\w)|\$\($|^\s*\)[+*]$", "", text, flags=re.MULTILINE)
    try:
        root = tree.parsed(text, suffix)
    except ExpressionError as error:
        return [Formula(lines=(1,), name="", reason=str(error))]
    if root.descendant_count > _MOST_NODES:
        return [Formula(lines=(1,), name="", reason="the file is too long")]
    functions = [node for node in tree.below([root]) if node.type in PARTS["function"]]
    program = _Program(
        suffix,
        {name: node for node in functions if (name := tree.function_name(node))},
        {match[1]: int(match[2]) for match in _INDEX_NAME.finditer(text)},
        suffix == ".py" and bool(_NUMPY.search(text)) and not _MATRICES.search(text),
    )
    formulas: dict[Any, Formula] = {}
    if root.has_error:
        errors = (node for node in tree.below([root]) if node.is_error or node.is_missing)
        lines = (tree.line_of(next(errors, root)),)
        formulas[lines] = Formula(lines=lines, name="", reason="there is a syntax error")
    scopes = [(scope, _Branches(), list[Formula]()) for scope in (root, *functions)]
    for count in range(_MOST_RUNS):  # first runs first, since a long file is not read to its end
        for scope, branches, own in scopes:
            if count and not (branches.places and branches.is_new):
                continue
            branches.now, branches.is_new = {}, False
            interpreter = _Interpreter(program, branches)
            try:
                interpreter.run_scope(scope)
            except RecursionError:  # SymPy, in a sum that a program nests in itself
                reason = "expressions are nested too deeply"
                own.append(Formula(lines=(tree.line_of(scope),), name="", reason=reason))
            own += interpreter.formulas
    for _, _, own in scopes:
        named = {each.forms for each in own if each.forms and each.is_named}
        for formula in own:
            if formula.is_named or formula.forms not in named:  # a fault counts once
                formulas.setdefault((formula.lines, formula.forms or formula.name), formula)
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
        text = python_of(text)
    is_numpy = bool(re.search(r"\b(?:np|numpy|jnp)\.(?:array|asarray)\b", text))
    for suffix in (".cpp",) if "{" in text else (".py", ".m", ".cpp"):
        value = _assigned_value(text, suffix)
        if value is not None:
            program = _Program(suffix, is_numpy=is_numpy, is_formula=True)
            matrix = as_matrix(_Interpreter(program, _Branches()).read(value))
            return _unflattened(matrix) if "{" in text else matrix  # float R[9] = {...}
    missing = re.search(r"[)\]]\s*(\w+)", text)
    if missing:
        expected = f"expected an operator such as * between {text[: missing.start(1)].strip()!r}"
        raise ExpressionError(f"{expected} and {missing[1]!r}", column=missing.start(1) + 1)
    text = text if len(text) < 200 else f"{text[:200]}..."
    raise ExpressionError(f"not a formula in Python, C, MATLAB or LaTeX: {text}")


def _assigned_value(text: str, suffix: str) -> Node | None:
    """The right-hand side, if the text or `x = text` is an assignment in a language."""
    line = text.strip().rstrip(";")
    if suffix != ".m":  # a line ends a row in MATLAB only
        line = line.replace("\n", " ")
    if suffix == ".py":  # in Python, ^ would bind less than +
        line = line.replace("^", "**")
    # First as the value of a new name, which needs a type in C++, and then as an assignment itself.
    for program in (f"{'auto ' * (suffix == '.cpp')}x = {line};", f"{line};"):
        root = tree.parsed(program, suffix)
        value = next(
            (n for n in tree.below([root]) if STATEMENTS.get(n.type) == "_assignment"), None
        )
        while value is not None and STATEMENTS.get(value.type) == "_assignment":
            value = tree.part(value, "right", "value")
        if value is not None and not root.has_error:
            return value
    return None


class _Interpreter:
    """One function, or the code of a file outside of all functions."""

    def __init__(self, program: _Program, branches: _Branches, inlined: int = 0) -> None:
        self.program, self.branches, self.inlined = program, branches, inlined
        self.is_matlab = program.suffix == ".m"
        self.values: Values = {}
        self.end = ""  # "return" or "break" after one
        self.formulas: list[Formula] = []
        self.paths: dict[str, str] = {}  # name: its path in the program
        self.lines: dict[str, int] = {}  # where a name was assigned
        self.of_entries: dict[tuple[str, Any], int] = {}  # where an entry was
        self.inputs: set[str] = set()  # names that were read before anything was assigned
        self.definitions: dict[sp.Symbol, sp.Expr | None] = {}  # what symbols stand for, if read
        self.components: set[Any] = set()  # symbols of components of a value, which are inputs
        self.squares: dict[str, sp.Symbol] = {}  # |v|² of names without values
        self.later: dict[tuple[sp.Expr, str], sp.Dummy] = {}  # entries of an array assigned anew
        self.groups: dict[tuple[int, str], dict[str, str]] = {}  # names of scalars by index
        self.emitted: set[tuple[Any, ...]] = set()
        self.untracked: set[str] = set()
        self.results: list[Any] = []  # None for one that is not read
        self.depth = 0

    def unreadable(self, node: Node, reason: str = "is not understood") -> ExpressionError:
        text = re.sub(r"\s+", " ", tree.text_of(node))
        text = text if len(text) <= 60 else f"{text[:57]}..."
        where = "" if self.program.is_formula else f" in line {tree.line_of(node)}"
        return ExpressionError(f"`{text}`{where} {reason}")

    # Statements

    def run_scope(self, scope: Node) -> None:
        """Run a function, or the whole file, and collect the formulas in it."""
        inner = [n for n in tree.below(scope.named_children) if n.type in PARTS["function"]]
        late = [n for n in tree.below(scope.named_children) if n.type in PARTS["late"]]
        if self.program.suffix != ".py":
            late += [n for n in tree.below(inner) if n.type not in PARTS["declaration"]]
        self.untracked = self._writes(late)
        is_function = scope.type in PARTS["function"]
        body = (tree.part(scope, "body") or tree.child(scope, "block")) if is_function else scope
        if is_function:
            self.inputs |= set(map(self.name_of, tree.parameters(scope)))
        if body is None:
            return
        if is_function and not body.type.endswith(("block", "statement", "body")):
            self._return(body)  # the expression of an arrow
            return
        self.run(body)
        last = tree.children(body)[-1:] if self.program.suffix == ".rs" else []
        if last and not last[0].type.endswith(("statement", "declaration")):
            self._return(last[0])
        if not self.end:
            self._emit(self.values)

    def run(self, node: Node) -> None:
        """One statement, or all statements in a block."""
        if self.program.steps["read"] > _MOST_STEPS:  # later values are unknown
            self.end = "return"
        if self.end or node.type in PARTS["function"]:
            return
        self.depth += 1
        if self.depth > _DEEPEST_BLOCK:
            self._forget(node)
        elif node.type in STATEMENTS:
            try:
                getattr(self, STATEMENTS[node.type])(node)
            except ExpressionError:  # what the statement does is unknown
                self._forget(node)
        else:
            for each in tree.children(node):
                self.run(each)
        self.depth -= 1

    def _assignment(self, node: Node) -> None:
        left, right = tree.left_of(node), tree.part(node, "right", "value")
        if right is None and node.type == "variable_declarator":  # C#: no field
            right = next(iter(tree.children(node)[1:]), None)
        if left is None or right is None:
            if left is not None and node.type == "assignment_expression":
                self._drop(left)
        elif (sign := tree.operator(node)).endswith("=") and sign != "=":  # C: a += b
            self._update(node)
        else:
            if STATEMENTS.get(right.type) == "_assignment":  # a = b = c
                self.run(right)
                right = tree.left_of(right) or right
            self._assign(left, right)

    def _assign(self, left: Node, right: Node) -> None:
        names = tree.targets(left)
        try:
            value = self.read(right)
            if left not in names:
                for name, entry in zip(names, self._unpacked(value, right, names), strict=True):
                    self._store(name, entry)
                return
            self._store(left, value)
            one, other = self.place(left), self.place(right)
            if one and other and not (one.indices or other.indices):
                copy, source = map(self.name_of, (one.path, other.path))
                table = self.values.get(source, {(): value})
                if () not in table:
                    self.lines[copy] = self.lines.get(source, self.lines[copy])
                    if self.program.suffix in _SHARING:
                        self.values[copy] = table
        except ExpressionError:
            self._drop(left)
            if left not in names:  # components of a value, such as w, x, y, z = q.as_quat()
                places = [self.name_of(each.path) for each in map(self.place, names) if each]
                self.components |= {self.values[name].get(()) for name in places}

    def _unpacked(self, value: Any, node: Node, names: Sequence[Node]) -> list[sp.Expr]:
        """The components of w, x, y, z = q, and of c, s, t = cos(v)."""
        if isinstance(value, sp.Function | sp.Symbol):
            parts = [_part(value, key) for key in range(len(names))]
            if None not in parts and isinstance(value, sp.Function):
                return [part for part in parts if part is not None]
        matrix = as_matrix(value)
        if len(matrix) != len(names) or 1 not in matrix.shape:
            raise self.unreadable(node)
        return list(matrix)

    def _store(self, left: Node, value: Any) -> None:
        """An assignment to a name, a member, or an entry."""
        place, matrix = self.place(left), as_matrix(value)
        if place is None:
            raise self.unreadable(left)
        name, indices = self.name_of(place.path), place.indices
        if any(index != _ALL for index in indices):
            self._store_entries(left, name, indices, matrix)
            return
        if () not in self.values.get(name, {(): 0}):
            self._emit([name])
        if len(matrix) == 1:
            self._join_groups(name)
            value = self._named_value(name, self._renamed(name, matrix[0]))
        self.lines[name] = tree.line_of(left)
        self.values[name] = {(): value} if len(matrix) == 1 else _table(matrix)

    def _store_entries(
        self, left: Node, name: str, indices: Indices, matrix: sp.ImmutableMatrix
    ) -> None:
        table = self.values.get(name, {(): sp.S.Zero})
        if () in table:
            table = self.values[name] = {}
            self.lines[name] = tree.line_of(left)
        if len(matrix) > 1 and not any(isinstance(index, slice) for index in indices):
            indices = (*indices, _ALL)  # a row
        if len(matrix) == 1:  # of a batch
            indices = tuple(index for index in indices if index != _ALL)
        keys = self._keys(table, indices, len(matrix))
        if len(keys) != len(matrix):
            raise self.unreadable(left, "is a block of another size")
        for key, entry in zip(keys, matrix, strict=True):
            place = next((k for k in ((*key, 0), (0, *key)) if k in table), key)
            table[place] = entry
            self.of_entries[name, place] = tree.line_of(left)

    def _named_value(self, name: str, value: sp.Expr) -> sp.Expr:
        """A value, or a symbol for a long one."""
        is_first = name not in self.inputs and name not in self.values
        is_sum = value.is_Add or value.is_number or value.atoms(sp.Function) - value.atoms(*_SHORT)
        is_long = _size(value) > _LONGEST or (value.is_Pow and value.exp == sp.Rational(1, 2))
        return self._symbol_for(name, value) if is_long or (is_first and is_sum) else value

    def _symbol_for(self, name: str, value: sp.Expr | None) -> sp.Symbol:
        """A symbol for a long value, or for one that is not read (None)."""
        symbol = sp.Symbol(name, real=True)
        if symbol in self.definitions or name in self.inputs:
            symbol = sp.Dummy(name, real=True)
        self.definitions[symbol] = value
        return symbol

    def _renamed(self, name: str, value: sp.Expr) -> sp.Expr:
        """The name itself for its value in another unit, or divided by the length of its vector."""
        own = self.values.get(name, {(): sp.Symbol(name, real=True)}).get((), sp.S.One)
        if own.is_number or not value.is_Mul:
            return value
        ratio = value / own
        is_read = all(self.definitions.get(s, s) is not None for s in ratio.free_symbols)
        if not is_read and len(ratio.free_symbols) == 1 and own not in ratio.free_symbols:
            return self._symbol_for(name, None)  # q0 *= recipNorm
        ratio = self._expanded(ratio)
        degree = 180 / sp.pi
        is_unit = (
            ratio.is_number
            and ratio.is_finite
            and any(abs(ratio * c - 1) < 1e-3 for c in (degree, 1 / degree))
        )
        is_divided = _is_length(1 / ratio) and own.free_symbols <= ratio.free_symbols
        is_divided |= ratio.free_symbols == {self.squares.get(str(own))}
        return own if is_unit or is_divided else value

    def _expanded(self, value: Any) -> Any:
        """An expression or a matrix with long values for their symbols."""
        for _ in range(_LONG_IN_LONG):
            symbols = value.free_symbols
            parts = {s: v for s in symbols if (v := self.definitions.get(s)) is not None}
            if not parts or _size(value) > _MOST_PARTS:
                break
            value = value.xreplace(parts)
        return value

    def _update(self, node: Node) -> None:
        """a += b, or a++."""
        left, right = tree.left_of(node), tree.part(node, "right")
        if left is None or right is None:
            raise self.unreadable(node)
        sign, change = self._operation(node, tree.operator(node)[:-1]), self.read(right)
        value = combined(sign, self.read(left), change)
        place = self.place(left)
        if place and sign == "+" and isinstance(change, sp.Expr):  # q0 += (...)*dt
            name = "_".join(["Δ" + self.name_of(place.path), *map(str, place.indices)])
            self.values[name], self.lines[name] = {(): change}, tree.line_of(left)
            self._join_groups(name)
            rates = [s for s in change.free_symbols if _RATES_NAME.fullmatch(s.name)]
            if ANGLES_NAME.search(name) and len(rates) == 1:  # rpy += omega*dt
                parts = [change.xreplace({rates[0]: _part(rates[0], k)}) for k in "xyz"]
                self._add(name, sp.Matrix(parts), tree.line_of(left))
        table = self.values.get(self.written(left), {(): value})
        if () not in table and isinstance(value, sp.MatrixBase):
            table.clear()  # also of other names for this matrix
            table |= _table(value)
        else:
            self._store(left, value)

    def _drop(self, left: Node) -> None:
        """The value of a name, or of the array of an entry, is not read."""
        for target in tree.targets(left):
            if name := self.written(target):
                self._become_unread(name, target)

    def _become_unread(self, name: str, node: Node) -> None:
        """A name, and all others for the same matrix, get new symbols in place of their values."""
        self._emit([name])
        table = self.values.get(name)
        same = [n for n, value in self.values.items() if value is table]
        for each in same or [name]:
            self.lines[each] = tree.line_of(node)
            self.values[each] = {(): self._symbol_for(each, None)}

    def _forget(self, node: Node) -> None:
        """All names that are written to in a statement become unread, if they have been used."""
        for name in self._writes(tree.below([node])):
            if name in self.values or name in self.inputs:
                self._become_unread(name, node)

    def _writes(self, nodes: Iterable[Node]) -> set[str]:
        """Names that statements, and walruses in expressions, may change."""
        names: set[str] = set()
        for node in nodes:
            meaning, left = STATEMENTS.get(node.type), tree.left_of(node)
            if meaning in ("_call_statement", "_stream"):
                names |= self._reached(node)
            elif node.type in ("nonlocal_statement", "global_statement"):
                names |= set(map(tree.text_of, node.named_children))
            elif meaning in ("_assignment", "_update") or node.type in PARTS["late"]:
                names |= set(map(self.written, tree.targets(left) if left is not None else ()))
        return names - {""}

    def written(self, left: Node) -> str:
        """The name that an assignment writes to, also through parts that are not understood."""
        node: Node | None = left
        while node is not None:
            if place := self.place(node):
                return self.name_of(place.path)
            node = tree.part(node, *PARTS["holder"]) or next(iter(tree.children(node)), None)
        return ""

    def _branches(self, node: Node) -> None:
        """if, #if, switch, and handlers of exceptions: each run takes one branch, or none."""
        if node.type in PARTS["choice"]:
            cases = [c for c in tree.below(tree.children(node)) if c.type in PARTS["case"]]
            self._take(node, [*cases, None], ())
            self.end = "" if self.end == "break" else self.end
        else:
            elifs = [each for each in tree.children(node) if each.type in PARTS["elif"]]
            others = [*node.children_by_field_name("alternative"), *elifs]
            blocks = [node, *dict.fromkeys(others)]
            possible: list[Node | None] = []
            for block in blocks:
                condition = tree.part(block, "condition")
                constant = _BOOLEANS.get(tree.text_of(condition).strip("() "))
                possible += [block] if constant is not False else []
                if constant or (block != node and condition is None):
                    break
            else:
                possible.append(None)
            self._take(node, possible, blocks)

    def _take(self, node: Node, possible: Sequence[Node | None], others: Sequence[Node]) -> None:
        """Run one block of several, or none, without its condition and without the others."""
        block = possible[self.branches.choice(node, possible)]
        if block is None:
            return
        start = {name: len(table) for name, table in self.values.items()}
        if block.type in STATEMENTS and block != node:
            self.run(block)
        else:
            skipped = [*others, tree.part(block, "condition"), tree.part(block, "name")]
            for each in tree.children(block):
                if each not in skipped:
                    self.run(each)
        self._emit([name for name in self.values if start.get(name, 0) < 3])

    def _loop(self, node: Node) -> None:
        """A loop may run many times or never: what changes in it is not read before and after."""
        self._forget(node)
        header = tree.part(node, "left", "initializer", "pattern")
        if header is not None and node.type != "for_statement":
            self._drop(header)
        self.run(tree.part(node, "body") or tree.child(node, "block") or node)
        self.end = ""
        self._forget(node)

    def _end(self, node: Node) -> None:
        """return, break, raise."""
        value = next(iter(tree.children(node)), None)
        if node.type.startswith(("break", "continue", "goto")):
            self.end = "break"
        else:
            self._return(value if node.type.startswith("return") else None)

    def _return(self, node: Node | None) -> None:
        if node is not None:
            try:
                self.results.append(self.read(node))
                if self.place(node) is None:
                    self._add(_RETURNED, self.results[-1], tree.line_of(node))
            except ExpressionError as error:
                self.results.append(None)
                if _MAY_BE_MATRIX.search(tree.text_of(node)):
                    unread = Formula(lines=(tree.line_of(node),), name=_RETURNED, reason=str(error))
                    self.formulas.append(unread)
        self._emit(self.values)
        self.end = "return"

    def _call_statement(self, node: Node) -> None:
        """m.set(...) is an assignment; other calls may change their object and matrices."""
        call = tree.call_of(node)
        nodes, meaning = call.arguments, CALLS.get(call.name)
        if re.search("sin_?cos", call.name, re.IGNORECASE) and len(nodes) == 3:
            self._sine_and_cosine(nodes)
            return
        if "::" in tree.text_of(tree.part(node, "function")):  # of a type, not of an object
            return
        target = call.owner or (nodes[-1] if nodes and meaning else None)
        is_set = call.name in ("set", "setValue") if target is None else meaning is None
        value: Any = sp.eye(4) if meaning == "set_unit" else None
        if meaning == "scale":  # m33Scale(factor, A, B)
            value = combined("*", *map(self.read, nodes[:2]))
        if is_set and any(p.search(call.name) for p in (_MATRIX_NAME, _VECTOR_NAME)):
            values = [self._tried(each) for each in nodes]
            value = rows(values) if len(nodes) in (3, 4, 9, 16) and None not in values else None
        if value is not None and target is not None:
            self._store(target, value)
            return
        if value is not None:
            self._emit(["this"])
            self.values["this"], self.lines["this"] = _table(as_matrix(value)), tree.line_of(node)
            return
        if _MAY_BE_MATRIX.search(tree.text_of(node)):
            self._tried(node)
        for name in self._reached(node) if not _HARMLESS.search(call.path) else ():
            if name in self.values or name in self.inputs:
                self._become_unread(name, node)

    def _sine_and_cosine(self, nodes: Sequence[Node]) -> None:
        """sincos(a, &s, &c), sincos(a, out s, out c), or SinCos(&s, &c, a)."""
        results = [each for each in nodes if each.type in PARTS["pointer"]]
        results = results if len(results) == 2 else [*nodes[1:]]
        (angle,) = (self._tried(each) for each in nodes if each not in results)
        for left, word in zip(results, ("sin", "cos"), strict=True):
            if angle is None:
                self._drop(left)
            else:
                self._store(left, called(word, [angle]))

    def _reached(self, node: Node) -> set[str]:
        """Names that a call, or a stream, may change: its object, matrices, and &name."""
        if STATEMENTS[node.type] == "_stream":
            return {self.written(node)} if tree.operator(node) == "<<" else set()
        call = tree.call_of(node)
        places = [place for place in map(self.place, call.arguments) if place is not None]
        names = {self.name_of(path) for path in [call.base, *(place.path for place in places)]}
        pointers = [each for each in call.arguments if each.type in PARTS["pointer"]]
        changed = {n for n in names if () not in self.values.get(n, {(): 0})}
        return changed | set(map(self.written, pointers))

    def _comma(self, node: Node) -> None:
        """a = b, c = d; or R << a, b, c."""
        parts = [node]
        while parts[-1].type == "comma_expression":
            parts[-1:] = tree.children(parts[-1])
        if parts[0].type == "binary_expression":
            self._stream(parts[0], parts[1:])
        else:
            for each in parts:
                self.run(each)

    def _stream(self, node: Node, others: Sequence[Node] = ()) -> None:
        """Eigen's comma initialiser."""
        left, right = tree.part(node, "left"), tree.part(node, "right")
        if left is not None and right is not None and tree.operator(node) == "<<":
            self._store(left, rows([self.read(each) for each in (right, *others)]))

    # Formulas

    def _emit(self, names: Iterable[str]) -> None:
        """Matrices of some names, and scalars that are one, have their final values."""
        for name in names:
            table = self.values.get(name, {})
            if len(table) > 2 and name in self.lines:  # not an argument of this function
                own = [self.of_entries.get((name, k), self.lines[name]) for k in sorted(table)]
                self._add(name, _matrix(table), self.lines[name], of_entries=own)
        self._emit_groups()

    def _join_groups(self, name: str) -> None:
        """A scalar may be a component of a vector, or an entry of a matrix."""
        path = self.paths.get(name, name)
        for kind, pattern in enumerate(_GROUPS):
            if match := pattern.fullmatch(path if "." in pattern.pattern[-9:] else name):
                index = re.sub(r"[._]", "", match["index"]).lower()
                self.groups.setdefault((kind, match["stem"]), {})[index] = name
        if stem_of(name):
            self.groups.setdefault((-1, ""), {})[name] = name
        base, _, last = path.rpartition(".")
        base += "Δ" * (name[0] == "Δ")
        word = re.sub(r"^δ?_*|_?(val|rad|angle)?_*$", "", last.lower())
        for kind, angles in enumerate(_COMPLETE):
            if word in angles and (len(word) > 1 or word in "xyz"):
                self.groups.setdefault((-2 - kind, base), {})[word] = name

    def _emit_groups(self, changed: str | None = None) -> None:
        """Scalars that are one vector or matrix, all or those with a name that will change."""
        lone = [m["w"] for (kind, _), m in self.groups.items() if (kind, *m) == (3, "w")]
        for (kind, stem), members in self.groups.items():
            if kind == 3 and members.keys() == {*"xyz"} and len(set(lone)) == 1:  # v.x beside w
                members = {**members, "w": lone[0]}
            order = _COMPLETE.get(frozenset(members)) if kind != -1 else tuple(members)[:4]
            if order is None or len(order) < 3 or changed not in (None, *members.values()):
                continue
            names = [members[index] for index in order]
            values: list[Any] = [self.values.get(name, {}).get(()) for name in names]
            values = [self.definitions.get(v, v) for v in values]
            if None in values or (kind, stem, *values) in self.emitted:
                continue
            are_angles = all(value.has(*_INVERSE) for value in values)
            is_change = names[0][0] == "Δ" and ANGLES_NAME.search(names[0]) is not None
            if kind > -2 or are_angles or is_change:
                self.emitted.add((kind, stem, *values))
                name = ", ".join(names) if len(names) < 9 else stem.strip("._") or "elements"
                self._add(name, sp.Matrix(values), *(self.lines[name] for name in names))

    def _add(self, name: str, value: Any, *lines: int, of_entries: Iterable[int] = ()) -> None:
        if not isinstance(value, sp.MatrixBase) or len(value) == 1:
            return
        if self.program.steps["formulas"] >= _MOST_FORMULAS:
            return
        self.program.steps["formulas"] += 1
        matrix = _unflattened(sp.ImmutableMatrix(value))
        if matrix.cols == 1 and 4 < matrix.rows <= _LONGEST_STATE:  # angles and rates in a state
            for k in range(matrix.rows - 2):
                self._add(f"{name}[{k}:{k + 3}]", matrix[k : k + 3, :], *lines)
        whole = self._expanded(matrix)
        if _size(whole) > _MOST_PARTS:
            whole = matrix
        symbols = whole.free_symbols
        bases = (self.values.get(re.sub(r"(?:_\d+)+$", "", s.name), {}) for s in symbols)
        used = (symbols | {base[()] for base in bases if () in base}) - self.components
        unread = {s.name for s in used if s.is_Symbol and self.definitions.get(s, s) is None}
        names = {s.name for s in symbols if not isinstance(s, sp.Dummy)}
        plain: dict[sp.Expr, sp.Expr] = {  # symbols of later values as plain symbols
            s: sp.Symbol(s.name + "_new" * (s.name in names), real=True)
            for s in matrix.free_symbols | symbols
            if isinstance(s, sp.Dummy) and s not in self.squares.values()
        }
        plain |= {s: _square(v, names, self.is_matlab) for v, s in self.squares.items()}
        forms = [spelled_out(m, self.definitions).xreplace(plain) for m in (whole, matrix)]
        self.formulas.append(
            Formula(
                lines=lines,
                of_entries=tuple(of_entries),
                name=name,
                forms=tuple(dict.fromkeys(forms)),
                unread=tuple((n, self.lines.get(n, min(lines))) for n in sorted(unread)),
            )
        )

    # Expressions

    def read(self, node: Node) -> Any:
        """The value of an expression; raises ExpressionError if it is not understood."""
        self.depth += 1
        self.program.steps["read"] += 1
        try:
            if self.depth > _DEEPEST:
                raise self.unreadable(node, "is nested too deeply")
            if self.program.steps["read"] > _MOST_STEPS:
                raise self.unreadable(node, "is not read, since the file is too long")
            digits = _NUMBERS.fullmatch(tree.text_of(node)) if not tree.children(node) else None
            if digits:
                text = digits[2].replace("_", "")
                value = number(text if text.isdigit() else repr(float(text)))
                return -value if digits[1] else value
            return getattr(self, EXPRESSIONS.get(node.type, "_named"))(node)
        except ExpressionError as error:
            if str(error).startswith("`"):
                raise
            raise self.unreadable(node, f"is not read: {error}") from None
        finally:
            self.depth -= 1

    def _wrapped(self, node: Node) -> Any:
        if not tree.children(node):
            raise self.unreadable(node)
        return self.read(tree.part(node, "value") or tree.children(node)[-1])

    def _tried(self, node: Node) -> Any:
        """The value, or None if it is not understood."""
        try:
            return self.read(node)
        except ExpressionError:
            return None

    def _assigned(self, node: Node) -> Any:
        """a = b inside an expression."""
        left = tree.left_of(node)
        self.run(node)
        return self.read(left if left is not None else node)

    def _list(self, node: Node) -> Any:
        parts = tree.children(node)
        if not 0 < len(parts) <= _LONGEST_LIST:
            raise self.unreadable(node)
        values = [self.read(each) for each in parts]
        return values[0] if [part.type for part in parts] == ["initializer_pair"] else rows(values)

    def _record(self, node: Node) -> Any:
        """{w: a, x: b, y: c, z: d} of JavaScript, and Quaternion { x: a, ... } of Rust."""
        pairs = tree.children(tree.part(node, "body") or node)
        if "".join(tree.text_of(tree.part(c, "key", "field")) for c in pairs) not in (
            "xyz",
            "wxyz",
            "xyzw",
        ):
            raise self.unreadable(node)
        return rows([self.read(tree.part(c, "value") or node) for c in pairs])

    def _matlab_matrix(self, node: Node) -> Any:
        lines = [as_matrix(self.read(row)) for row in tree.children(node) if row.type == "row"]
        return rows(lines) if len(lines) != 1 else lines[0]

    def _matlab_row(self, node: Node) -> Any:
        cells = [as_matrix(self.read(cell)) for cell in tree.children(node)]
        if len({cell.rows for cell in cells}) != 1:
            raise self.unreadable(node)
        return sp.ImmutableMatrix(sp.Matrix.hstack(*cells))

    def _transposed(self, node: Node) -> Any:
        return as_matrix(self.read(tree.children(node)[0])).T

    def _unary(self, node: Node) -> Any:
        if tree.operator(node) not in ("+", "-"):
            return self._named(node)
        value = self.read(tree.children(node)[-1])
        return value if tree.operator(node) == "+" else -value

    def _binary(self, node: Node) -> Any:
        parts, sign = tree.children(node), tree.operator(node)
        left, right = self.read(parts[0]), self.read(parts[-1])
        is_turn = sign == "%" and not isinstance(right, sp.MatrixBase) and (right / sp.pi).is_number
        if is_turn and self._expanded(left).has(*_INVERSE):  # the same angle
            return left
        if sign in ("+", "-"):
            left, right = self._as_vector(left, right), self._as_vector(right, left)
        are_columns = all(getattr(side, "cols", 0) == 1 for side in (left, right))
        if sign == "*" and are_columns and self.program.suffix in _WITH_SWIZZLES:
            return combined("%", left, right)
        return combined(self._operation(node, sign), left, right)

    def _as_vector(self, value: Any, other: Any) -> Any:
        """c v, where v has no value, in components if it is added to a vector."""
        if not isinstance(value, sp.Expr) or getattr(other, "shape", ()) != (3, 1):
            return value
        factor, vector = value.as_independent(
            *(s for s in value.free_symbols if s not in self.definitions)
        )
        return combined("*", factor, self._vector(vector)) if vector.is_Symbol else value

    def _vector(self, value: Any) -> Any:
        """Three components for a name without a value."""
        keys = [key + self.is_matlab for key in range(3)]
        parts = [_part(value, key) for key in keys] if isinstance(value, sp.Expr) else [None]
        return value if None in parts else rows(parts)

    def _operation(self, node: Node, sign: str) -> str:
        if self.is_matlab:
            sign = _ELEMENTWISE.get(sign, sign)
        if sign not in (*_OPERATORS, "%" if self.is_matlab else "*"):
            raise self.unreadable(node)
        return "%" if sign == "*" and self.program.is_numpy else sign

    def _conditional(self, node: Node) -> Any:
        parts = tree.children(node)
        if self.program.suffix != ".py":
            fields = (tree.part(node, f) for f in ("consequence", "condition", "alternative"))
            parts = [each or node for each in fields]
        constant = _BOOLEANS.get(tree.text_of(parts[1]).strip("() "))
        if constant is None:
            return self._chosen(node, [parts[0], parts[2]])
        return self.read(parts[0 if constant else 2])

    def _chosen(self, node: Node, nodes: Sequence[Node]) -> Any:
        """One of two values: a number belongs to a pole, or is a bound of a sine."""
        values = [self._tried(each) for each in nodes]
        fixed = [isinstance(value, sp.Expr) and value.is_number for value in values]
        if sum(fixed) != 1:
            return self.read(nodes[self.branches.choice(node, nodes)])
        return self.read(nodes[fixed.index(False)])

    # Places

    def place(self, node: Node | None) -> Place | None:
        """The name and the indices of R[0][1], q.w(), m.at(0, 1), state["phi"] or *p."""
        if node is None or node.end_byte - node.start_byte > _LONGEST_PLACE:
            return None
        parts, meaning = tree.children(node), EXPRESSIONS.get(node.type)
        if node.type in PARTS["name"]:
            return Place(spelled(tree.text_of(node)))
        if meaning == "_wrapped" or (tree.operator(node) in ("*", "&") and len(parts) == 1):
            return self.place(parts[-1]) if parts and not self.program.is_formula else None
        if meaning == "_member" and parts:
            return self._below(self.place(parts[0]), re.sub("<.*>", "", tree.text_of(parts[-1])))
        if node.type in PARTS["index"]:
            return self._indexed(self.place(parts[0]), parts[1:])
        if meaning != "_call":
            return None
        call = tree.call_of(node)
        word, owner = tree.function_word(call.name), self.place(call.owner) or Place(call.base)
        if not call.arguments:
            match = _GETTER.fullmatch(call.name)
            return self._below(owner, match[1].lower()) if match else None
        if CALLS.get(call.name) == "entry":
            return self._indexed(owner, call.arguments)
        is_function = word in self.program.functions and not self.is_matlab
        is_entry = len(call.arguments) == 2 and len(word) == 1  # t(1, 2), but not T(2)
        is_new = self.name_of(call.name) not in self.values and not is_entry
        is_function |= word in _RESERVED and is_new
        if is_function or len(call.arguments) > 2 + self.is_matlab:
            return None
        return self._indexed(self._below(owner, call.name), call.arguments)

    def _below(self, place: Place | None, name: str) -> Place | None:
        if place is None or not place.indices:
            return Place(f"{place.path}.{name}" if place.path else name) if place else None
        return Place(place.path, (*place.indices, _AXES[name])) if name in _AXES else None

    def _indexed(self, place: Place | None, nodes: Sequence[Node]) -> Place | None:
        lists = [tree.children(n) if n.type in PARTS["list"] else [n] for n in nodes]
        indices: list[Any] = [self._index(node) for nodes in lists for node in nodes]
        if place is None or None in indices:
            return None
        if any(isinstance(index, str) for index in indices):
            return self._below(place, str(indices[0])) if len(indices) == 1 else None
        while indices[:1] == [...] or (len(indices) > 2 and indices[0] == _ALL):  # of a batch
            indices = indices[1:]
        shifted = [i if isinstance(i, slice) else i - self.is_matlab for i in indices[:2]]
        is_place = bool(indices) and all(isinstance(i, slice) or 0 <= i < 64 for i in shifted)
        return Place(place.path, (*place.indices, *shifted)) if is_place else None

    def _index(self, node: Node) -> Any:
        """An index as it is written, or the key of a table."""
        text, parts = tree.text_of(node), tree.children(node)
        if text in (":", "..."):
            return _ALL if text == ":" else ...
        if match := re.fullmatch(r"(\d?):(\d?)", text):
            ends = [int(end) if end else None for end in match.groups()]
            return slice(ends[0] - 1 if self.is_matlab and ends[0] else ends[0], ends[1])
        if text == "-1":  # of a quaternion
            return 3
        if match := re.fullmatch(r"""["'](\w+)["']|(\d\d?)""", text):
            return match[1] or int(match[2])
        meaning = EXPRESSIONS.get(node.type)
        if meaning == "_wrapped" and parts:
            return self._index(parts[-1])
        if meaning == "_binary":
            sides = [self._index(side) for side in parts]
            if all(isinstance(side, int) for side in sides) and tree.operator(node) in "+-*":
                return int(combined(tree.operator(node), *map(sp.Integer, sides)))
        place = self.place(node) if not text.isdigit() else None
        if place is None or place.indices:
            return None
        name = self.name_of(place.path)
        value: Any = self.values.get(name, {}).get(())
        if name not in self.values and name not in self.inputs:
            value = self.program.constants.get(name, _AXES.get(name))
        value = self.definitions.get(value, value)
        return int(value) if isinstance(value, int | sp.Integer) else None

    def _keys(self, table: Table, indices: Indices, count: int = 3) -> list[tuple[int, ...]]:
        """The places of all entries that indices and slices name."""
        ranges = []
        for axis, index in enumerate(indices):
            if isinstance(index, slice):
                sizes = [key[axis] + 1 for key in table if len(key) > axis]
                stop = max(sizes, default=4 if index.start else count)
                ranges.append(range(index.start or 0, index.stop or stop))
            else:
                ranges.append(range(index, index + 1))
        return [*product(*ranges)]

    def _named(self, node: Node) -> Any:
        """A name, an entry, a component, or several: q.xyz."""
        place = self.place(node)
        is_slip = self.program.is_formula and tree.text_of(node).startswith("*")  # a + * b
        if place is None or is_slip:
            self._add_parts(tree.children(node) if node.type not in PARTS["function"] else ())
            raise self.unreadable(node)
        name, indices = self.name_of(place.path), place.indices
        if indices:
            table = self.values.get(name, {})
            if len(indices) == 2 and indices[0] == _ALL and not any(len(k) == 2 for k in table):
                indices = indices[1:]  # of a batch: q[:, 0]
            return self._entries(node, name, indices)
        base, _, member = place.path.rpartition(".")
        if member in CONSTANTS:
            return CONSTANTS[member]
        if base and _SWIZZLE.fullmatch(member := _PARTS_OF.get(member, member)):
            parts = [self._component(node, base, letter) for letter in member]
            return parts[0] if len(parts) == 1 else rows(parts)
        return self._value_of(node, name)

    def _entries(self, node: Node, name: str, indices: Indices) -> Any:
        """One entry, or those of slices as a column or a matrix."""
        table = self.values.get(name, {})
        if self.program.suffix == ".py" and len(indices) == 1:  # a row
            indices = (*indices, _ALL)[: max(map(len, table), default=1) or 1]
        keys = self._keys(table, indices)
        values = [self._entry(node, name, key) for key in keys]
        height = len({key[0] for key in keys})
        is_matrix = height > 1 and len(keys) > height
        shape = (height, len(keys) // height) if is_matrix else (len(keys), 1)
        return sp.ImmutableMatrix(*shape, values) if len(keys) != 1 else values[0]

    def _value_of(self, node: Node, name: str) -> Any:
        """The value of a name; an input if nothing was assigned."""
        if name in self.untracked:
            raise self.unreadable(node, "is changed inside an expression or an inner function")
        if name not in self.values:
            self.inputs.add(name)
            return sp.Symbol(name, real=True)
        value = _matrix(self.values[name])
        if value is None:
            raise self.unreadable(node, "has entries without values")
        return _unflattened(value) if isinstance(value, sp.ImmutableMatrix) else value

    def _entry(self, node: Node, name: str, key: tuple[int, ...]) -> Any:
        table = self.values.get(name, {})
        if table and () not in table:
            value = next((table[k] for k in (key, (*key, 0), (0, *key)) if k in table), None)
            if value is not None:
                return value
            if name not in self.inputs:
                raise self.unreadable(node, "has no value")
        whole, from_1 = table.get(()), [index + self.is_matlab for index in key]
        value = _part(whole, from_1[0]) if whole is not None and len(key) == 1 else None
        if value is not None:
            return value
        self.inputs.add(name)
        entry = "_".join([name, *map(str, from_1)])
        if isinstance(whole, sp.Dummy) and entry not in self.values:
            return self.later.setdefault((whole, entry), sp.Dummy(entry, real=True))
        return self._value_of(node, entry)

    def _component(self, node: Node, base: str, letter: str) -> Any:
        """x, y, z or w of a vector."""
        vector, name = self.name_of(base), self.name_of(f"{base}.{letter}")
        table = self.values.get(vector, {})
        if len(table) == 3 or (len(table) == 4 and self.program.suffix in _WITH_SWIZZLES):
            return self._entry(node, vector, ("xyzw".index(letter.lower()),))
        if () in table and name not in self.values:
            value = _part(table[()], letter)
            if value is not None:
                return value
        return self._value_of(node, name)

    def _member(self, node: Node) -> Any:
        inner = tree.part(node, "object", "value", "argument", "expression")
        if inner is not None and tree.text_of(node).endswith(".T"):
            return as_matrix(self.read(inner)).T
        return self._named(node)

    def name_of(self, path: str) -> str:
        """The name of a path, short if no other path of the function has it."""
        path = spelled(path)
        for name in (tree.short_name(path), re.sub(r"\W+", "_", path)) if path else ():
            if self.paths.setdefault(name, path) == path:
                return name
        return re.sub(r"\W+", "__", path) + "__"

    # Calls

    def _call(self, node: Node) -> Any:
        """A function of numbers, a method of a matrix, a constructor, or a function of the file."""
        if self.place(node) is not None:  # R(0, 1), q.w()
            return self._named(node)
        call = tree.call_of(node)
        alias = str(self.values.get(call.name, {}).get(()))  # s, c = np.sin, np.cos
        name = tree.function_word(alias if alias in FUNCTIONS else call.name)
        nodes, meaning = call.arguments, CALLS.get(name, "")
        own = self.values.get(self.name_of(call.base), {(): 0}) if call.base else {(): 0}
        is_short = name in _OF_NUMBERS and len(nodes) < 1 + (name in ("pow", "atan2"))
        is_method = is_short or (meaning in _OF_OBJECTS and not _MODULE.match(call.base))
        if call.owner is not None and (call.base == "?" or () not in own or is_method):
            nodes = [call.owner, *nodes]
        is_letter = name in [*"cstCST"] and len(nodes) == 1
        in_formula = self.program.is_formula and (name in OF_MATRICES or is_letter)
        if (name in _OF_NUMBERS or in_formula) and nodes:
            return called(name, [self.read(each) for each in nodes])
        is_listed = bool(nodes) and (len(nodes) == 1 or nodes[0].type in PARTS["list"])
        is_reordered = any(tree.text_of(option).startswith("order") for option in call.options)
        match meaning:
            case "pair" if len(nodes) == 1:
                return rows([called(each, [self.read(nodes[0])]) for each in ("sin", "cos")])
            case "number" if not call.arguments and self.program.suffix == ".rs":  # T::zero()
                return sp.Integer("one" in name.lower())
            case "cast" if len(nodes) == 1:
                return self.read(nodes[0])
            case "wrapper" if is_listed:
                return self.read(nodes[0])
            case "same" if nodes and not is_reordered:
                return self.read(nodes[0])
            case "zeros" | "unit":
                return self._filled(node, call)
            case "row" | "column" if len(call.arguments) == 1 and call.base not in ("", "?"):
                index = self._index(call.arguments[0])
                place = (index, _ALL) if meaning == "row" else (_ALL, index)
                if isinstance(index, int):
                    return self._entries(node, self.name_of(call.base), place)
            case "clamp" | "least" if len(nodes) > 1:
                return self._unclamped(node, [self.read(each) for each in nodes])
            case "where" if len(nodes) == 3:
                return self._chosen(node, nodes[1:])
            case "transpose" | "dot" | "cross" | "outer" | "norm" | "skew" | "inverse" if nodes:
                return self._of_vectors(meaning, [self.read(each) for each in nodes])
        is_new = self.program.suffix == ".rs" and name == "new" and len(call.arguments) == 3
        if is_new and all(EXPRESSIONS.get(n.type) == "_call" for n in nodes):  # of three columns
            return as_matrix(rows([self.read(each) for each in nodes])).T
        if meaning == "stack" or _BY_COLUMNS.search(name):
            return self._stacked(node, call)
        nodes = call.arguments
        if len(nodes) in (4, 5, 10, 17) and tree.text_of(nodes[-1]) in ("true", "false"):  # a flag
            nodes = nodes[:-1]
        is_built = len(nodes) in (3, 4) and bool(_VECTOR_NAME.search(call.path))
        is_built |= len(nodes) in (3, 9, 16) and bool(_MATRIX_NAME.search(call.path))
        if name in self.program.functions and call.base in ("", "self", "this", "Self"):
            with suppress(ExpressionError):  # of a constructor, or of a name of another object
                return self._inline(node, name, nodes)
        if is_built:
            return rows([self.read(each) for each in nodes])
        if _TYPE.fullmatch(name) and 1 < len(nodes) < 4:  # float4(v, w)
            return rows([entry for each in nodes for entry in as_matrix(self.read(each))])
        if self.program.is_formula and call.owner is None:
            hint = offer(name, [*FUNCTIONS, *OF_MATRICES])
            raise ExpressionError(f"{name!r} is not a function; {hint}")
        values = self._add_parts(nodes)
        if len(nodes) in (3, 4, 9, 16) and None not in values:  # a constructor of another library
            self._add(_ARGUMENT, rows(values), tree.line_of(nodes[0]))
        raise self.unreadable(node)

    def _add_parts(self, nodes: Sequence[Node]) -> list[Any]:
        """The parts of what is not understood may be formulas of their own."""
        values = [self._tried(each) for each in nodes]
        for each, value in zip(nodes, values, strict=True):
            self._add(_ARGUMENT, value, tree.line_of(each))
        return values

    def _unclamped(self, node: Node, values: Sequence[Any]) -> Any:
        """x of clamp(x, -1, 1), or of min(1, x): the sine of any other number does not exist."""
        parts = [value.as_coeff_Add() for value in values]  # a bound may be -1 + epsilon
        bounds = [0.99 < abs(c) < 1.01 and rest.as_coeff_Mul()[1].is_Atom for c, rest in parts]
        if bounds.count(False) != 1:
            raise self.unreadable(node)
        return values[bounds.index(False)]

    def _of_vectors(self, meaning: str, values: Sequence[Any]) -> Any:
        """An operation of matrices; a name without a value is a vector."""
        if meaning == "norm":
            return called("sqrt", [self._of_vectors("dot", [*values, *values])])
        if meaning == "dot" and values[0] == values[-1] and isinstance(values[0], sp.Symbol):
            name = values[0].name
            return self.squares.setdefault(name, sp.Dummy(f"{name}²", positive=True))
        if meaning in ("cross", "dot", "skew", "outer"):
            values = [self._vector(value) for value in values]
        if meaning == "dot" and any(as_matrix(value).cols > 1 for value in values):
            return combined("@", *values)
        names = {"transpose": "T", "skew": "C", "inverse": "inv"}
        return called(names.get(meaning, meaning), [as_matrix(value) for value in values])

    def _filled(self, node: Node, call: Call) -> Any:
        """zeros(3, 3), Matrix3d::Identity()."""
        texts = " ".join(map(tree.text_of, call.arguments))
        sizes = [int(digits) for digits in re.findall(r"\d+", texts)][-2:] or [3]
        is_zero = CALLS[call.name] == "zeros"
        is_column = len(sizes) == 1 and bool(texts) and is_zero and not self.is_matlab
        height, width = sizes[0], 1 if is_column else sizes[-1]
        if not {height, width} <= {3, 4} or _VECTOR_NAME.search(call.path):
            raise self.unreadable(node)
        return sp.ImmutableMatrix(sp.zeros(height, width) if is_zero else sp.eye(height, width))

    def _stacked(self, node: Node, call: Call) -> Any:
        axis = re.sub(r"\s", "", "".join(map(tree.text_of, call.options)))
        if axis and not re.fullmatch(r"(axis|dim)=(0|1|-1|-2)", axis):
            raise self.unreadable(node)
        by_columns = bool(_BY_COLUMNS.search(call.name)) ^ axis.endswith(("=1", "=-1"))
        nodes = call.arguments
        is_listed = len(nodes) == 1 and nodes[0].type in PARTS["list"]
        parts = [
            as_matrix(self.read(each)) for each in (tree.children(nodes[0]) if is_listed else nodes)
        ]
        if all(each.cols == 1 for each in parts) and len({each.rows for each in parts}) > 1:
            return sp.ImmutableMatrix(sp.Matrix.vstack(*parts))  # (w, v)
        matrix = rows(parts)
        return matrix.T if by_columns and 1 not in matrix.shape else matrix

    def _inline(self, node: Node, name: str, nodes: Sequence[Node]) -> Any:
        """The value of a function of the same file."""
        function = self.program.functions[name]
        inner = _Interpreter(self.program, self.branches, self.inlined + 1)
        names = [inner.name_of(each) for each in tree.parameters(function)]
        names = [each for each in names if each not in ("self", "this")]
        if len(names) != len(nodes) or self.inlined >= _INLINED:
            raise self.unreadable(node)
        values = [self.read(each) for each in nodes]
        inner.values = {n: _table(as_matrix(v)) for n, v in zip(names, values, strict=True)}
        inner.run_scope(function)
        is_closed = not inner.inputs - set(names) and None not in inner.definitions.values()
        if not inner.results or None in inner.results or not is_closed:
            raise self.unreadable(node)
        return inner._expanded(inner.results[0])


def _table(matrix: sp.MatrixBase) -> Table:
    if len(matrix) == 1:
        return {(): matrix[0]}
    if matrix.cols == 1:
        return {(i,): entry for i, entry in enumerate(matrix)}
    return {(i, j): matrix[i, j] for i, j in product(*map(range, matrix.shape))}


def _matrix(table: Table) -> Any:
    """The value in a table: a scalar or a matrix, None if an entry is missing."""
    if () in table:
        return table[()]
    widths = {len(key) for key in table}
    height, width = len({key[0] for key in table}), len({key[1:] for key in table})
    if len(widths) != 1 or height * width != len(table):
        return None
    return sp.ImmutableMatrix(height, width, [table[key] for key in sorted(table)])


def _unflattened(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Nine, twelve or sixteen numbers in a row are a matrix."""
    is_flat = 1 in matrix.shape and len(matrix) in _FLAT
    return matrix.reshape(*_FLAT[len(matrix)]) if is_flat else matrix


def _square(vector: str, names: set[str], is_matlab: bool) -> sp.Expr:
    """|v|² of a vector, or of a quaternion if a formula has its fourth component."""
    letters = (
        [*"xyzw"]
        if f"{vector}_x" in names or f"{vector}_w" in names
        else range(is_matlab, 4 + is_matlab)
    )
    parts = [f"{vector}_{each}" for each in letters]
    return sum(sp.Symbol(p, real=True) ** 2 for p in parts[: 3 + (parts[3] in names)])


def _part(value: sp.Expr, key: int | str) -> sp.Expr | None:
    """A component of c v, or of a function of it, if v is a name without a value."""
    vector = next(iter(value.free_symbols), None)
    is_simple = len(value.free_symbols) == 1 and not isinstance(vector, sp.Dummy)
    if not is_simple or not (isinstance(value, sp.Function) or (value / vector).is_number):
        return None
    return value.xreplace({vector: sp.Symbol(f"{vector}_{key}", real=True)})


def _size(value: Any) -> int:
    """The number of parts; that of a sum of sums of itself is exponential, and not counted out."""
    return sum(1 for _ in islice(sp.preorder_traversal(value), _MOST_PARTS + 1))


def _is_length(value: sp.Expr) -> bool:
    """Whether this is a sum of squares, or the root of one."""
    terms = sp.Add.make_args(value.base if value.is_Pow and value.exp == sp.S.Half else value)
    return len(terms) > 1 and all(t.is_Pow and t.exp == 2 for t in terms)
