"""The formulas of a program: an abstract interpreter of its common tree (`syntax`).

It runs each function with symbols in place of numbers. A value is an expression, a matrix, or a
record: the parts of a name by member or index, as far as they are assigned. A name or part without
a value is the symbol of its path; so is a value that is long, that cannot be read, or that a
condition or a loop may change. A formula is therefore right for all values of the names that are
not read, and lists them. Programs are parsed, never run.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy, deepcopy
from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce
from itertools import chain, groupby, islice, product, takewhile
from typing import Any

import sympy as sp

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.tools.compare import language, syntax
from rigidsym.tools.compare.language import as_matrix, called, combined, function_word, rows
from rigidsym.tools.compare.latex import python_of
from rigidsym.tools.compare.quantities import INVERSE, are_angles, grouped, stem_of
from rigidsym.tools.compare.syntax import CALLS, TYPES, Tree, limits, patterns, walk

_AXES: dict[str, Any] = {"x": 0, "y": 1, "z": 2, "X": 0, "Y": 1, "Z": 2}
_AXES |= {f"k{k}{axis}": axis.lower() for k in ("", "_") for axis in "WXYZ"}  # Order::kW
_SIZES = (3, 4, 9, 16)  # of vectors and matrices that are built of numbers
_FLAT = {9: (3, 3), 12: (4, 3), 16: (4, 4)}
_WORDS = {*language.OF_NUMBERS, *language.OF_MATRICES, *CALLS}  # functions, if nothing else
_RETURNED, _ARGUMENT = UNNAMED = ("returned", "argument")  # in place of a name
_ALL, _OBJECTS = slice(None), {"self", "this"}

_COMPLETE = {frozenset(order.split()): order.split() for order in patterns.orders}

Path = tuple[Any, ...]  # of a name and its members and indices: ("R", 0, 1), ("state", "phi")


_Bounded = sp.Function("clamp", real=True)  # x of clamp(x, -1, 1): no other number has an arc sine


def _unbounded(matrix: Any) -> Any:
    """The matrix without the bounds in its arc sines and cosines."""
    return matrix.xreplace({f: f.func(_inner(f.args[0])) for f in matrix.atoms(sp.asin, sp.acos)})


def _inner(value: Any) -> Any:
    """x, also of clamp(x, -1, 1)."""
    return value.args[0] if isinstance(value, _Bounded) else value


class _Record(dict[Any, tuple[Any, int]]):
    """Parts of a value by member or index, each with the line where it was assigned.

    The part at None is a symbol for all other parts, if they are inputs.
    """

    def at(self, *path: Any) -> Any:
        """The part at a path, or None."""
        value: Any = self
        for key in path:
            if isinstance(key, slice) or not isinstance(value, _Record):
                return None
            value = value.get(key, (None, 0))[0]
        return value

    def whole(self, *, is_row: bool = False) -> tuple[Any, list[int]]:
        """The vector, or the matrix of rows, if all is there, and the lines of its entries.

        Entries 1, 2, 3 are a row of a matrix whose rows are 1, 2, 3, or of a quaternion.
        """
        keys = {str(key).lower(): key for key in self if key is not None}
        order = _COMPLETE.get(frozenset(keys)) or [str(k) for k in range(len(keys))]
        parts = [self[keys[name]] for name in order if name in keys]
        is_from_one = order == [*"123"]
        if all(isinstance(part, _Record) for part, _ in parts):
            wholes = [part.whole(is_row=is_from_one) for part, _ in parts]
        else:
            wholes = [(part, [line]) for part, line in parts if is_row or not is_from_one]
        are_vectors = all(_is_scalar(v) or getattr(v, "shape", (0, 0))[1] == 1 for v, _ in wholes)
        if are_vectors and 0 < len(wholes) == len(order):
            with suppress(ExpressionError):  # of rows of different lengths
                values, lines = zip(*wholes, strict=True)
                return rows([*values]), [*chain.from_iterable(lines)]
        return None, []


@dataclass(frozen=True, kw_only=True)
class Formula:
    """A matrix or vector of a program, or the reason why it is not read."""

    lines: tuple[int, ...]  # of the assignments of its components, row by row, or of all
    name: str
    entries: tuple[int, ...] = ()  # lines of its entries in a list or call over several lines
    forms: tuple[sp.ImmutableMatrix, ...] = ()  # in terms of the inputs, and of long values
    reason: str = ""
    is_flat: bool = False  # nine or sixteen numbers in a row, by rows or by columns
    unread: tuple[tuple[str, int], ...] = ()  # names in it whose values are not read, and lines
    function: tuple[str, int, int] = ("", 0, 0)  # around it, with its first and last line
    is_returned: bool = False  # whether its function returns it
    is_bounded: bool = False  # whether it has a bound of an arc sine or cosine
    is_final: bool = True  # not if what is not understood changes it: it may not be complete
    is_end: bool = False  # the reason holds for the rest of the file
    scalar: str = ""  # whether its constructor takes the scalar of a quaternion first or last
    # of the branches that lead to it, in each run; not negative if true
    conditions: frozenset[frozenset[sp.Expr]] = frozenset({frozenset()})
    names: Mapping[sp.Expr, sp.Expr] = field(default_factory=dict)  # of inputs in the program
    computed: Mapping[sp.Expr, sp.Expr] = field(default_factory=dict)  # names and their values

    @property
    def line(self) -> int:
        """Where it begins."""
        return min(self.lines)

    def conditions_beside(self, other: Formula) -> list[frozenset[sp.Expr]]:
        """The conditions of each run that another formula does not share, in the names of this."""
        runs = [run - frozenset.intersection(*other.conditions) for run in self.conditions]
        symbols = {s for run in runs for c in run for s in c.free_symbols if not s.is_Dummy}
        names = {s: sp.Symbol(_last(s.name), real=True) for s in symbols} | {**self.names}
        return [frozenset(c.xreplace(names) for c in run) for run in runs]


def _fault(line: int, reason: str, name: str = "", *, is_end: bool = False) -> Formula:
    return Formula(lines=(line,), name=name, reason=reason, is_end=is_end)


@dataclass
class _Scope:
    """A function, or a whole file, and the branch that a run takes at each of its choices.

    A run prefers the last branch that no run has taken, since guards mostly come first; then one
    that contains an open choice, and then the last. One of two values, `a ? b : c`, waits until the
    blocks of all `if` have been run with the last.
    """

    tree: Tree
    taken: set[tuple[int, int]] = field(default_factory=set)
    now: dict[int, int] = field(default_factory=dict)
    open: dict[int, Tree] = field(default_factory=dict)  # choices with other branches
    is_new: bool = True  # whether the last run took a new branch
    waits: bool = True  # whether values wait

    def choice(self, tree: Tree, blocks: Sequence[Tree], possible: Sequence[int]) -> int:
        """The number of a possible branch."""
        own = tree.node.id
        if own not in self.now:
            free = [k for k in range(len(blocks)) if (own, k) not in self.taken]
            is_late = tree.kind == "choose" and any(t.kind != "choose" for t in self.open.values())
            new = [k for k in possible if k in free and not (self.waits and is_late)]
            open_ = (k for k in possible if any(map(blocks[k].covers, self.open.values())))
            self.now[own] = new[-1] if new else next(open_, possible[-1])
            self.is_new |= bool(new)
            self.taken.add((own, self.now[own]))
            self.open.pop(own, None)
            self.open |= {own: tree} if len(free) > len(new[:1]) else {}
        return self.now[own]


@dataclass(frozen=True)
class _Program:
    """A file, as its functions see it."""

    suffix: str
    functions: Mapping[str, Sequence[Tree]] = field(default_factory=dict)  # by name
    orders: Mapping[str, list[str]] = field(default_factory=dict)  # of arguments
    constants: Mapping[str, int] = field(default_factory=dict)  # q_i = 0 of the whole file
    imported: Mapping[str, str] = field(default_factory=dict)  # from numpy import sin as s
    product: str = "*"  # what * is for matrices: "%" entry by entry, "" if nobody knows
    is_glm: bool = False
    arrays: Collection[str] = ()  # names of arrays of C
    is_formula: bool = False  # a formula on its own, with the functions of `language`
    steps: Counter[str] = field(default_factory=Counter)  # expressions that were read
    integers: Collection[str] = ()  # members and names of the whole file
    written: dict[Any, Path] = field(default_factory=dict)  # what assignments write to, by node


def program_formulas(text: str, suffix: str) -> list[Formula]:
    """All matrices and vectors of a program, in the order of its lines."""
    if suffix == ".rs":  # the body of a macro is code
        text = patterns.macro.sub(lambda m: "mod macros {" + "\n" * m[0].count("\n"), text)
        text = patterns.macro_mark.sub("", text)
    text = re.sub(r"\b\w*LITERAL\(\s*(\w+)\s*\)", r"\1", text)  # a macro for C and C++
    if not _has_material(text, suffix):
        return []
    try:
        # to parse a megabyte takes a second or more
        root = syntax.parsed(text, suffix) if len(text) <= limits.longest_file else None
    except ExpressionError as error:
        return [_fault(1, str(error), is_end=True)]
    if root is None or root.descendant_count > limits.most_nodes:
        return [_fault(1, "the file is too long", is_end=True)]
    functions = [*walk(root, "function")]
    outside = reduce(lambda rest, each: rest.replace(each.text, ""), functions, text)
    by_word = groupby(sorted(functions, key=lambda t: t.word), lambda t: t.word)
    by_name = {word: [*trees] for word, trees in by_word}
    words = (t.class_name if t.word in TYPES["new"] else t.word for t in functions)
    orders = {w: t.parameters for w, t in zip(words, functions, strict=True) if t.parameters[3:]}
    constants = {match[1]: int(match[2]) for match in patterns.index_name.finditer(text)}
    imported = {match[2]: match[1] for match in patterns.imported_name.finditer(text)}
    kinds = _product(text, suffix), bool(patterns.glm.search(text)), patterns.array.findall(text)
    integers = set() if suffix in TYPES["real"] else syntax.integers(outside)
    program = _Program(suffix, by_name, orders, constants, imported, *kinds, integers=integers)
    # A long file of short functions is read to its end; a long function may let a value grow.
    program.steps["read"] = -min(8 * text.count("\n"), 200 * len(functions))
    # functions that may hold a formula, in themselves or in a function that they call
    holders = {tree.word for tree in functions if _has_material(tree.text, suffix)}
    worth = (t for t in functions if holders & {t.word, *re.findall(r"\w+(?=\s*\()", t.text)})
    scopes = [_Scope(tree) for tree in (Tree(root), *worth)]
    # by most errors, such as an unknown macro, no formula is lost
    lost = (t for t in syntax.damaged(root) if {*t.text} & {*"(["} and _has_material(t.text, ""))
    found = [_fault(each.line, "there is a syntax error") for each in islice(lost, 1)]
    # All scopes are run once before any is run again: a long file is not read to its end.
    for count in range(limits.most_runs):
        for scope in scopes:
            scope.now, scope.waits, scope.is_new = {}, scope.waits & scope.is_new, False
            run = _Run(program, scope)
            try:
                run.run_scope()
            except RecursionError:  # SymPy, in a sum that a program nests in itself
                run.formulas.append(_fault(scope.tree.line, "expressions are nested too deeply"))
            tree, last = scope.tree, int(scope.tree.node.end_point[0]) + 1
            span = (tree.word, tree.line, last) if tree.kind == "function" else Formula.function
            named = {f.forms[:1] for f in run.formulas if f.name not in UNNAMED} - {()}
            returned = {f.forms[:1] for f in run.formulas if f.name == _RETURNED}
            own = [f for f in run.cases() if f.name not in UNNAMED or f.forms[:1] not in named]
            found += [replace(f, function=span, is_returned=f.forms[:1] in returned) for f in own]
        if line := program.steps["end"]:  # in a later run, all has been read, with some branches
            reason = "it has too many branches" if count else "the file is too long"
            found.append(_fault(line, reason, is_end=not count))
            break
        scopes = [each for each in scopes if each.open and (each.is_new or each.waits)]
    formulas: dict[Any, Formula] = {}
    for formula in found:
        key = (formula.lines, formula.forms or formula.name)
        same = formulas.get(key, formula)  # in runs with other branches
        either = same.conditions | formula.conditions
        formulas[key] = replace(same if formula.is_final else formula, conditions=either)
    return sorted(formulas.values(), key=lambda each: each.line)


def _has_material(text: str, suffix: str) -> bool:
    """Whether there are words, products or signs enough for a formula, a cheap test."""
    fewest = 1 if suffix in (".py", ".m") else limits.fewest_factors  # which may be matrices
    factors = islice(patterns.factors.finditer(text), fewest)
    return bool(patterns.material.search(text)) or len([*factors]) == fewest


@lru_cache(maxsize=256)  # functions are run several times
def _late(scope: Tree, is_python: bool) -> list[Tree]:
    """Changes of names that do not happen in the order of the text."""
    inner = [scope] if is_python else walk(scope.node, "function")
    late = chain.from_iterable(walk(each.node, "assign", "call", "outer") for each in inner)
    return [t for t in late if t.is_one_of("late" if is_python else "declaration") == is_python]


def _product(text: str, suffix: str) -> str:
    """What * is for matrices: as in `_Program`."""
    if suffix == ".py":
        libraries = {"%": patterns.numpy, "*": patterns.matrices}
        signs = [sign for sign, words in libraries.items() if words.search(text)]
        return signs[0] if len(signs) == 1 else ""
    is_unknown = suffix in TYPES["swizzling"] and re.search(r"\bfloat[34]x[34]\b", text)
    return "" if is_unknown else "*"


def formula_matrix(text: str) -> sp.ImmutableMatrix:
    """The matrix of a single formula in Python, C, MATLAB or LaTeX; a scalar is 1x1.

    Raises ExpressionError for a text in none of these languages, and for one that is too long.
    """
    if len(text) > (most := limits.most_characters):
        raise ExpressionError(f"a formula of {len(text)} characters; expected at most {most}")
    text = python_of(text) if re.search(r"\\[A-Za-z]", text) else text
    is_numpy = bool(re.search(r"\b(?:np|numpy|jnp)\.(?:array|asarray)\b", text))
    for suffix in (".cpp",) if "{" in text else (".py", ".m", ".cpp"):
        if value := _assigned_value(text, suffix):
            program = _Program(suffix, product="%" if is_numpy else "*", is_formula=True)
            matrix = as_matrix(_Run(program, _Scope(value)).read(value))
            matrix = matrix.xreplace(_short_names(matrix.free_symbols))
            return _unflattened(matrix) if "{" in text else matrix  # float R[9] = {...}
    if missing := re.search(r"[)\]]\s*(\w+)", text):
        expected = f"expected an operator such as * between {text[: missing.start(1)].strip()!r}"
        raise ExpressionError(f"{expected} and {missing[1]!r}", column=missing.start(1) + 1)
    raise ExpressionError(f"not a formula in Python, C, MATLAB or LaTeX: {text[:200]}")


def _assigned_value(text: str, suffix: str) -> Tree | None:
    """The right-hand side of `x = text`, where the text may begin with a name and a sign itself."""
    line = re.sub(r"\A[^=({]*=", "", text).strip().rstrip(";")
    line = line if suffix == ".m" else line.replace("\n", " ")  # it ends a row in MATLAB only
    line = line.replace("^", "**") if suffix == ".py" else line  # ^ would bind less than +
    root = syntax.parsed(f"{'auto ' * (suffix == '.cpp')}x = {line};", suffix)
    parts = [part for tree in islice(walk(root, "assign"), 1) for part in tree.parts[1:]]
    return parts[0] if parts and not root.has_error else None


class _Run:
    """One run of a scope, with the branches that the scope chooses."""

    def __init__(self, program: _Program, scope: _Scope, inlined: int = 0) -> None:
        self.program, self.scope, self.inlined = program, scope, inlined
        self.first = int(program.suffix == ".m")  # the first index
        # values of names; names that are changed anywhere; names that may be the same object
        self.values, self.untracked, self.links = _Record(), set[Path](), list[tuple[Path, Path]]()
        self.inputs: set[str] = set()  # names that were read before anything was assigned
        self.definitions: dict[sp.Symbol, sp.Expr | None] = {}  # what symbols stand for, if read
        # components of values that are not read, which are inputs; names without values that
        # are matrices
        self.components, self.tensors = set[sp.Symbol](), set[sp.Symbol]()
        self.divided: dict[sp.Symbol, tuple[Any, set[Any]]] = {}  # x/|v| of x, and x, y, z
        self.squares: dict[sp.Symbol, sp.Symbol] = {}  # |v|² of names without values
        own = set() if program.suffix in TYPES["real"] else syntax.integers(scope.tree.text)
        self.integers = own | ({*program.integers} - {*scope.tree.parameters})
        # lines of names without values; what is known of a formula, by its matrix
        self.unread, self.facts = dict[str, int](), dict[Any, dict[str, Any]]()
        self.tests: dict[str, Tree] = {}  # a comparison by the name that it is given
        # of the results, None for one that is not read
        self.formulas, self.emitted, self.results = list[Formula](), set[Any](), list[Any]()
        self.end, self.depth = "", 0  # "return" or "break" after one
        # of the branches that were taken: x - 1 by x, the least of numbers
        self.conditions: dict[sp.Expr, sp.Expr] = {}

    def unreadable(self, tree: Tree, reason: str = "is not understood") -> ExpressionError:
        text = re.sub(r"\s+", " ", tree.text[:1000])
        text = text if len(text) <= 60 else f"{text[:57]}..."
        where = "" if self.program.is_formula else f" in line {tree.line}"
        return ExpressionError(f"`{text}`{where} {reason}")

    def refuse_if(self, is_so: Any, tree: Tree, reason: str = "is not understood") -> None:
        if is_so:
            raise self.unreadable(tree, reason)

    def is_full(self, line: int) -> bool:
        """Whether a limit on a whole file is reached, in this line or before."""
        steps = self.program.steps
        if steps["read"] > limits.most_steps or steps["formulas"] > limits.most_formulas:
            steps.setdefault("end", line)
        return "end" in steps

    # Statements

    def run_scope(self) -> None:
        """Run a function, or the whole file, and collect the formulas in it."""
        scope = self.scope.tree
        self.untracked = self.written_in(_late(scope, self.program.suffix == ".py"))
        self.inputs |= {*scope.parameters}
        for each in scope.parts if scope.kind == "function" else [scope]:
            self.end = ""  # also before the results of MATLAB
            self.run(each)
        if not self.end:
            self.emit()

    def run(self, tree: Tree) -> None:
        """One statement, or all statements in a block."""
        self.end = "return" if self.is_full(tree.line) else self.end  # later values are unknown
        if self.end or tree.kind == "function":
            return
        self.depth += 1
        try:
            self.refuse_if(self.depth > limits.deepest_block, tree)
            getattr(self, f"run_{tree.kind}", self.run_block)(tree)
        except ExpressionError:  # what the statement does is unknown
            self.forget(tree)
        self.depth -= 1

    def run_block(self, tree: Tree, *, is_value: bool = False) -> Any:
        """Run statements, the last of which may be a value, as in Rust.

        Names that a block declares anew have their values outside again behind it.
        """
        value, outside = None, dict[str, Any]()
        is_scope = self.depth > 1 and tree.is_one_of("scope")
        for each in tree.parts:
            for name in syntax.declared(each.node) - outside.keys() if is_scope else ():
                outside[name] = self.values.get(name)
            value = (self.tried if is_value and each is tree.parts[-1] else self.run)(each)
        if outside:
            self.emit(keys=outside)
            parts = {**self.values, **outside}
            self.values = _Record({name: part for name, part in parts.items() if part})
        return value

    def run_assign(self, tree: Tree) -> None:
        """a = b, a += b, and a, b = c."""
        left, *values = tree.parts
        sign = re.fullmatch(r"([-+*/@]+)=?", tree.word)
        is_other = tree.word.endswith("=") and tree.word not in ("=", ":=")  # %=, ??=
        if sign and values:
            self.update(tree, sign[1])
        elif is_other or (not values and (sign or tree.node.type == "assignment_expression")):
            raise self.unreadable(tree)
        elif values and left.targets != [left]:
            self.unpack(left, values[0])
        elif values:
            self.tests[left.text] = values[0]
            self.integers |= {left.text} if values[0].is_integer else set()
            try:
                value = self.read(values[0])
                source = self.values.at(*(self.path(values[0]) or ("",)))
                if isinstance(source, _Record):  # another name for the same matrix, or a copy
                    value = source if self.program.suffix in TYPES["sharing"] else deepcopy(source)
                if values[0].kind == "list" and patterns.column_matrix.search(tree.declared_type):
                    value = self.columns(tree, value)
                elif values[0].kind == "list":
                    value = self.in_order(tree.declared_type, value)
                self.store(left, value, right=values[0])
            finally:
                self.link(tree)

    def link(self, tree: Tree) -> None:
        """Two names may share one object: a reference, a view, or a copy in C#."""
        left, right = tree.parts
        word = right.called if right.kind == "call" else right.word
        is_view = right.kind == "index" or word in TYPES["views"]
        if right.kind == "call":
            right = right.parts[-1] if patterns.module.match(right.base) else right.owner or right
        names = self.written(left), self.written(right)
        own = self.values.at(*(self.path(left) or names[0]))  # B[0, 1] = v[2] is a number
        may_share = is_view if self.program.suffix == ".py" else self.program.suffix == ".cs"
        is_object = right.kind in ("name", "member", "index", "unary") and names[0] != names[1]
        mark = "|^[&*]" if "declarator" in tree.node.type else ""  # auto& b = a, b = &a
        is_alias = re.search(rf"=\s*&{mark}", tree.text) or (may_share and isinstance(own, _Record))
        if is_object and all(names) and is_alias:
            self.links += [names, names[::-1]]

    def linked(self, path: Path) -> list[Path]:
        """Names that may be another name for what is at a path."""
        return [b for a, b in self.links if all(x == y for x, y in zip(a, path, strict=False))]

    def columns(self, tree: Tree, value: Any) -> Any:
        """mat3(...) of GLM, of which other libraries have rows, as arrays have."""
        if tree.declared_type in self.program.arrays:
            return value
        self.refuse_if(not self.program.is_glm or _is_scalar(value), tree)
        return _unflattened(value).T

    def unpack(self, left: Tree, right: Tree) -> None:
        """w, x, y, z = q; c, s, t = cos(v); {x, y} = q."""
        keys: Sequence[Any] = left.keys if left.kind == "record" else range(len(left.parts))
        parts, value = list[Any]([None] * len(keys)), None
        names = [each.text for each in left.parts if each.text.strip("_~")]
        self.refuse_if(len(names) > len({*names}), left)  # which one was meant?
        if right.kind == left.kind == "list" and len(right.parts) == len(keys):
            parts = [*map(self.tried, right.parts)]  # vectors too, as in a, v = q[0], q[1:]
        elif isinstance(value := self.tried(right), sp.MatrixBase) and len(value) == len(keys):
            parts = [*value]
        elif value is not None:
            is_input = value.is_Symbol and left.kind != "record" and not self.inlined
            is_input &= not patterns.turns.match(str(value))
            parts = parts if is_input else [self.component(value, key) for key in keys]
        for target, part in zip(left.parts, parts, strict=True):
            if part is not None:
                self.store(target, part)
            elif path := self.written(target):  # w, x, y, z = q.as_quat() are inputs
                symbol = self.symbol_for(path, None, target.line)
                self.put(path, symbol, target.line)
                # Of three, each may be a row or a column of a matrix: it has no parts.
                is_given = value not in self.definitions and (value or right.kind != "binary")
                self.components |= {symbol} if len(keys) > 2 and is_given else set()

    def store(self, left: Tree, value: Any, right: Tree | None = None) -> None:
        """An assignment to a name, a member, or an entry."""
        path = self.path(left)
        self.refuse_if(not path, left)
        value = value[0] if isinstance(value, sp.MatrixBase) and len(value) == 1 else value
        is_rounded = self.holds_integers(path) and not getattr(value, "is_Integer", False)
        self.refuse_if(is_rounded, left, "is rounded")
        value = self.vector(value) if path[-1] in ("vec", "imag") else value
        if _is_scalar(value):
            path = tuple(key for key in path if key != _ALL)  # of a batch
            value = self.renamed(path, value)
        if self.by_columns(path) and len(path) > 1 and isinstance(value, sp.MatrixBase):
            raise self.unreadable(left, "may be a column")
        own = self.values.at(*path)
        meant = (own, *map(self.definitions.get, own.free_symbols)) if _is_scalar(own) else ()
        if any(v is not None and v.has(*INVERSE) for v in meant):  # an angle, in another unit then
            self.emit(path[:-1], [], is_final=False)
        # A matrix may be complete only after R = R*S.
        is_own = right is not None and re.search(rf"\b{path[0]}\b", right.text) is not None
        self.emit_at(path, is_final=not is_own)
        for other in self.linked(path):
            self.emit_at(other, is_final=False)
            self.lose(other, left.line)
        self.put(path, value, left.line)

    def put(self, path: Path, value: Any, line: int) -> None:
        place = next((n for n, key in enumerate(path) if isinstance(key, slice)), None)
        if place is not None:
            value = value.whole()[0] if isinstance(value, _Record) else value
            value = self.vector(value) if path[place] != _ALL else value
            whole, start = as_matrix(sp.nan if value is None else value), path[place].start or 0
            parts = _lines(whole)
            if len(whole) == 1 or path[place].stop not in (None, start + len(parts)):
                raise ExpressionError("a block of another size")
            for k, part in enumerate(parts, start):
                self.put((*path[:place], k, *path[place + 1 :]), part, line)
            return
        record = self.values
        for depth, key in enumerate(path[:-1], 1):
            part = record.at(key)
            if not isinstance(part, _Record):
                is_new = part is None and path[0] not in self.inputs
                others = part if part is not None else sp.Symbol(_dotted(path[:depth]), real=True)
                part = _Record({} if is_new else {None: (others, line)})
                record[key] = part, line
            record = part
        record[path[-1]] = _record(value, line), line

    def renamed(self, path: Path, value: sp.Expr) -> sp.Expr:
        """A value, or a symbol: for a long one, in another unit, or divided by a length."""
        own = self.values.at(*path)
        is_first = own is None and path[0] not in self.inputs
        own = sp.Symbol(_dotted(path), real=True) if own is None else own
        if value.is_Mul and _is_scalar(own) and (own in value.args or own.is_Mul):
            ratio = value / own  # other quotients do not cancel, and some take long
            values = [self.definitions.get(s, s) for s in ratio.free_symbols]
            if values == [None] and own not in ratio.free_symbols:  # q0 *= recipNorm
                return self.symbol_for(path, None)
            if not ratio.has(sp.Function):  # whose expansion would take most of the time
                ratio = self.expanded(ratio)
            is_unit = ratio.is_number and ratio.is_finite
            if is_unit and abs(complex(ratio) * 180 / math.pi - 1) < 1e-3:  # radians from degrees
                return own
            # a component is a new name after its division
            is_old = not any(s.is_Dummy for s in ratio.free_symbols)
            is_root = (1 / ratio).is_Pow and is_length(1 / ratio)
            names = tuple((s, s.name) for s in ratio.free_symbols if is_old and is_root)
            firsts = {own, self.part_of(own, 0) if own.is_Symbol else own}
            groups = (each[0] for each in grouped(names) if len(each) == 1)
            for vector in (each for each in groups if len(each) > 2 and firsts & {*each}):
                self.components.add(symbol := self.symbol_for(path, None))
                self.divided[symbol] = value, {*vector}
                return symbol
        if isinstance(path[-1], int):
            return value
        functions = value.atoms(sp.Function) - value.atoms(sp.sin, sp.cos, sp.tan)
        is_sum = is_first and bool(value.is_Add or functions)
        is_long = _size(value) > limits.longest or (value.is_Pow and value.exp == sp.Rational(1, 2))
        return self.symbol_for(path, value) if is_long or is_sum or value.is_number else value

    def symbol_for(self, path: Path, value: sp.Expr | None, line: int = 0) -> sp.Symbol:
        """A symbol for a long value, or for one that is not read (None)."""
        symbol = sp.Symbol(_dotted(path), real=True)
        # A function that is inlined may use a name of its caller for something else.
        if symbol in self.definitions or path[0] in self.inputs or self.inlined:
            symbol = sp.Dummy(symbol.name, real=True)
        self.definitions[symbol] = value
        self.unread.setdefault(symbol.name, line)
        return symbol

    def expanded(self, value: Any) -> Any:
        """An expression or a matrix with long values for their symbols."""
        for _ in range(limits.long_in_long):
            parts = {s: v for s in value.free_symbols if (v := self.definitions.get(s)) is not None}
            value = value.xreplace(parts) if parts and _size(value) <= limits.most_parts else value
        return value

    def update(self, tree: Tree, sign: str) -> None:
        """a += b."""
        left, right = tree.parts
        path, own, change = self.path(left), self.read(left), self.read(right)
        value = combined(self.operation(tree, sign, own, change), own, change)
        if path and sign == "+" and _is_scalar(change):  # q0 += (...)*dt
            name = f"Δ{_dotted(path).removeprefix('self.').removeprefix('this.')}"
            self.put((name,), change, left.line)
            rates = [s for s in change.free_symbols if patterns.rates_name.fullmatch(_last(s.name))]
            if patterns.angles_name.fullmatch(name) and len(rates) == 1 and self.is_step(change):
                parts = [change.xreplace({rates[0]: self.component(rates[0], k)}) for k in "xyz"]
                self.add(name, sp.Matrix(parts), left.line)
        record = self.values.at(path[0]) if len(path) == 1 else None
        if isinstance(record, _Record) and isinstance(value, sp.MatrixBase):
            record.clear()  # also of other names for this matrix
            record |= _record(value, left.line)
        else:
            self.store(left, value, right=left)

    def is_step(self, change: sp.Expr) -> bool:
        """Whether inputs are multiplied by a step of time."""
        has_step = any(patterns.step.fullmatch(s.name) for s in change.free_symbols)
        return has_step and change.free_symbols.isdisjoint(self.definitions)

    def become_unread(self, paths: Iterable[Path], tree: Tree) -> None:
        """Names, and others for the same objects, get new symbols in place of their values.

        The formula of a matrix tells of entries that change in a statement.
        """
        parts = [t.parts[0] for t in tree.changes if t.kind == "assign" and t.parts]
        parts += [tree.owner] if tree.kind == "call" and tree.owner else []
        # but no translation M[:3, 3]
        parts = [t for t in parts if t.kind in ("index", "call") and 3 not in self.path(t)[2:]]
        objects = [each for path in sorted(paths) for each in (path, *self.linked(path))]
        for each in objects:  # while all names have their values
            count = len(self.formulas)
            self.emit_at(each, is_final=False)
            own = [(" ".join(t.text.split()), t.line) for t in parts if self.written(t) == each][:1]
            new = self.formulas[count:]
            self.formulas[count:] = [replace(f, unread=(*f.unread, *own)) for f in new]
        for each in objects:
            self.lose(each, tree.line)

    def lose(self, path: Path, line: int) -> None:
        value = self.values.at(*path)
        names = self.values.items() if isinstance(value, _Record) else ()  # few, of many names
        for each in [(name,) for name, (part, _) in names if part is value] or [path]:
            self.put(each, self.symbol_for(each, None, line), line)

    def forget(self, tree: Tree) -> None:
        """All names that are written to in a statement become unread."""
        self.become_unread(self.written_in(tree.changes), tree)

    run_error = forget

    def written_in(self, trees: Iterable[Tree]) -> set[Path]:
        """Paths that assignments, calls and streams may change."""
        paths: set[Path] = set()
        for tree in trees:
            if tree.kind == "call":
                paths |= self.reached(tree)
            elif tree.kind in ("assign", "outer") or (tree.kind == "binary" and tree.word == "<<"):
                first = tree.parts[0].targets if tree.parts else []
                paths |= {*map(self.written, tree.parts if tree.kind == "outer" else first)}
        return paths - {()}

    def written(self, left: Tree) -> Path:
        """The name that an assignment writes to, also through parts that are not understood."""
        key, known = (left.node.id, left.kind), self.program.written
        if key not in known:
            while not (path := self.path(left)) and left.parts:
                left = left.parts[0]
            known[key] = tuple(takewhile(lambda each: isinstance(each, str), path))
        return known[key]

    def run_if(self, tree: Tree) -> None:
        """if, #if, switch, and handlers of exceptions: each run takes one branch, or none."""
        self.program.steps["read"] += 1 + len(self.values) // limits.names_a_step
        blocks = [each for each in tree.parts if not self.is_bound(each)]
        choice = self.branch(tree, blocks) if len(blocks) > 1 else 0
        block = blocks[choice]
        for each in blocks[choice : None if block.is_one_of("falling") else choice + 1]:
            self.run(each)  # until a break
        self.end = "" if tree.kind == "switch" and self.end == "break" else self.end
        if block.parts:
            self.emit(keys=[])

    run_switch = run_if

    def is_bound(self, block: Tree) -> bool:
        """Whether a branch is no other case: if (x > 1) x = 1, which is done here."""
        condition, only = block.condition, block
        while only.kind == "block" and len(only.parts) == 1:
            only = only.parts[0]
        is_one = only.kind == "assign" and patterns.one.fullmatch(only.parts[-1].text)
        value = self.bounded_value(condition, only.parts[::-1]) if condition and is_one else None
        if value is not None:
            self.store(only.parts[0], value)
        return value is not None

    def branch(self, tree: Tree, blocks: Sequence[Tree], condition: Tree | None = None) -> int:
        """The number of the branch that this run takes: the first whose condition is true."""
        trees = [condition] if condition else [each.condition for each in blocks]
        if self.inlined or len(self.conditions) > limits.most_conditions:
            self.conditions, trees = {sp.Dummy(): sp.S.Zero}, []  # too many to be worth the time
        parts = [(k, *self.condition(t).as_coeff_Add()) for k, t in enumerate(trees) if t]
        known = [(k, (n, x, -x), (-n, -x, x)) for k, n, x in parts]
        ways, least, no = [*range(len(blocks))], self.conditions, limits.near_equal
        needed = [[so if n == k else other for n, so, other in known if n <= k] for k in ways]
        # a branch is impossible if a sum of two conditions is negative
        possible = [
            k for k in ways if all(n + least[y] > no for n, _, y in needed[k] if y in least)
        ]
        choice = self.scope.choice(tree, blocks, possible or ways)
        # also the branches of a switch have names
        own = needed[choice] or [(sp.S.Zero, sp.Symbol(f"{tree.node.start_byte} {choice}"), None)]
        least |= {x: min(n, least.get(x, n)) for n, x, _ in own}
        return choice

    def condition(self, tree: Tree) -> sp.Expr:
        """A number that is not negative if a condition is true, of a name if it is not read."""
        tree = self.tests.get(tree.text, tree)
        sign, parts = tree.word, tree.parts
        if sign in ("!", "not", "~") and parts:
            return -self.condition(parts[-1])
        if sign in ("&&", "and", "||", "or") and len(parts) == 2:
            one, other = map(self.condition, parts)
            least = -1 if sign in ("&&", "and") else 1
            return (one + other + least * language.magnitude(one - other)) / 2
        run, steps = copy(self), self.program.steps["read"]  # a condition adds no formula or input
        run.formulas, run.inputs = [], {*self.inputs}
        own, sign, number = run.sides(tree)
        self.program.steps["read"] = steps
        if not sign:
            return sp.Symbol(str(tree.node.start_byte))
        above = self.expanded(own) - number
        above = limits.near_equal - language.magnitude(above) if sign in "=!" else above
        return above if sign in ">=" else -above

    def run_loop(self, tree: Tree) -> None:
        """A loop may run many times or never: what changes in it is not read before and after."""
        self.forget(tree)
        targets = tree.parts[0].targets if tree.parts else ()
        self.become_unread([(t.word,) for t in targets if t.kind == "name"], tree)  # for x in
        self.run_block(tree)
        self.end = ""
        self.forget(tree)

    def run_break(self, _: Tree) -> None:
        self.end = "break"

    def run_return(self, tree: Tree) -> None:
        for value in tree.parts:
            self.results.append(result := self.tried(value))
            if result is not None and not self.path(value):
                own = [self.values.get(each.word, (None, value.line))[1] for each in value.parts]
                lines = own if self.first and len(own) == len(as_matrix(result)) else [value.line]
                self.add(_RETURNED, result, *lines)
            elif result is None and not self.first and patterns.may_be_matrix.search(value.text):
                self.formulas.append(_fault(value.line, self.reason, _RETURNED))
        self.run_raise(tree)

    def run_raise(self, _: Tree) -> None:
        self.emit()
        self.end = "return"

    def run_call(self, tree: Tree) -> None:
        """m.set(...) is an assignment; other calls may change their object and matrices."""
        name, nodes, meaning = tree.called, tree.parts[1:], CALLS.get(tree.called)
        target = tree.owner or (nodes[-1] if nodes and meaning else Tree(tree.node, "this"))
        is_static, value = "::" in tree.parts[0].text, None  # of a type, not of an object
        is_member = tree.owner is not None and name in [*"WXYZ"] and len(nodes) == 1
        if re.search("sin_?cos", name, re.IGNORECASE) and len(nodes) == 3:  # sincos(a, &s, &c)
            results = [each for each in nodes if each.is_reference]
            results = results if len(results) == 2 else nodes[1:]
            angle = [self.tried(each) for each in nodes if each not in results]
            for left, word in zip(results, ("sin", "cos"), strict=True):
                self.store(left, called(word, angle))
            return
        if meaning == "set_unit":
            value = sp.ImmutableMatrix(sp.eye(4))
        elif is_member or (name.startswith("set") and self.path(tree)):  # v.X(a), v.setX(a)
            target, value = tree.parts[0] if is_member else tree, self.read(nodes[-1])
        elif re.search("scale$", name, re.IGNORECASE) and len(nodes) == 3:  # m33Scale(k, A, B)
            target, value = nodes[2], combined("*", *map(self.read, nodes[:2]))
            self.refuse_if(_is_scalar(value), tree)
        elif not (meaning or is_static) and re.match("set|make|init", name, re.IGNORECASE):
            value = self.built(nodes)[1]
        if value is not None:
            self.store(target, value)
        elif is_static or patterns.may_be_matrix.search(tree.text):
            self.tried(tree)
        if value is None and not (is_static or patterns.harmless.search(f"{tree.base}.{name}")):
            self.become_unread(self.reached(tree), tree)

    def reached(self, tree: Tree) -> set[Path]:
        """Paths that a call may change: its object, matrices, and &name."""
        by_value = self.first or (self.program.suffix == ".rs" and "&mut" not in tree.text)
        trees = [tree.owner, *tree.parts[1 : 1 if by_value else None]]
        paths = {self.written(each): each.is_reference for each in trees if each is not None}
        return {p for p in paths if paths[p] or (p and isinstance(self.values.at(*p), _Record))}

    def run_comma(self, tree: Tree) -> None:
        """a = b, c = d; or R << a, b, c."""
        first, *others = tree.parts if tree.kind == "comma" else [tree]
        if first.kind == "binary" and first.word == "<<":
            left, *right = *first.parts, *others
            parts = self.beside_scalar([*map(self.read, right)])
            sizes = {getattr(each, "shape", (1, 1)) for each in parts}
            word = re.escape(right[0].text)
            is_row = re.search(rf"Row\w*\s[^;]*\b{word}\b", self.scope.tree.text)
            whole = called("stack", parts) if len(sizes) == 2 else _unflattened(rows(parts))
            is_column = sizes == {(3, 1)} and not is_row
            self.store(left, whole.T if is_column else self.place(whole, right))
        else:
            self.run_block(Tree(tree.node, own=[t for t in tree.parts if t.kind != "binary"]))

    run_binary = run_comma

    # Formulas

    def emit_at(self, path: Path, *, is_final: bool) -> None:
        """Collect a matrix before it is assigned again."""
        if len(path) == 1 and isinstance(self.values.at(path[0]), _Record):
            self.emit(keys=path, is_final=is_final)

    def emit(self, path: Path = (), keys: Any = None, *, is_final: bool = True) -> None:
        """Collect the matrices and vectors among the parts of a record."""
        record: _Record = self.values.at(*path)
        for key in [*record] if keys is None else keys:
            part, own = record.at(key), (*path, key)
            if not isinstance(part, _Record):
                continue
            matrix, lines = part.whole()
            if matrix is not None and len(matrix) > 2:
                self.add(_dotted(own), matrix, *lines, is_final=is_final)
            else:
                self.emit(own, is_final=is_final)
            scalar, line = record.get("w", (None, 0))
            is_vector = matrix is not None and matrix.shape == (3, 1) and not are_angles(matrix)
            if is_vector and _is_scalar(scalar):
                whole = sp.Matrix([scalar, *matrix])  # it may be a quaternion
                is_one = bool(path) and key in ("v", "vec", "imag")
                name = _dotted(path) if is_one else f"w, {_dotted(own)}"
                self.add(name, whole, line, *lines, is_final=is_final and is_one)
        for kind, names in _groups(record):
            parts, lines = zip(*map(record.get, names), strict=True)
            values: list[Any] = [self.definitions.get(part, part) for part in parts]
            if None in values:
                continue
            # At a pole, an angle is a number: this is no formula, but another case of one.
            all_angles = all(v.has(*INVERSE, sp.pi) or v.is_number for v in values)
            is_angle = patterns.angles_name.fullmatch(names[0])
            if kind > -2 or all_angles or (is_angle and all(map(self.is_step, values))):
                stem = _dotted(path) or re.sub(r"\d+$", "", names[0])
                name = ", ".join(names) if len(names) < 9 else stem
                self.add(name, sp.Matrix(values), *lines, is_final=is_final)

    def add(self, name: str, value: Any, *lines: int, is_final: bool = True) -> None:
        """A matrix or a vector is a formula; so is each part of a long vector."""
        if self.inlined or not isinstance(value, sp.MatrixBase) or len(value) < 2:
            return
        value = sp.ImmutableMatrix(value)
        self.program.steps["formulas"] += (name, value) not in self.emitted
        if (name, value) in self.emitted or self.is_full(min(lines)):
            return
        self.emitted.add((name, value))
        is_state = value.cols == 1 and _unflattened(value).shape in (value.shape, (4, 3))
        if is_state and 3 < value.rows <= limits.longest_state:  # angles and rates
            for k in range(value.rows - 2):
                part = value[k : k + 3, :]
                # (R v, 1) has a fourth coordinate
                is_sum = not k and value[3].is_Atom and all(entry.is_Add for entry in part)
                if len(value) > 4 or is_sum or are_angles(part):
                    is_known = not any(entry.is_Symbol for entry in value[:k])  # to be one number
                    place = f"{name}[{k}:{k + 3}]" if is_known else f"part of {name}"
                    self.add(place, part, min(lines), is_final=is_final)
        key, value = value, _unflattened(value)
        whole = self.expanded(value)
        is_flat, is_bounded = value.shape != key.shape, whole.has(_Bounded)
        value, whole = map(_unbounded, (value, whole))
        # Of a vector that is not divided as a whole, components are what they are.
        used = whole.free_symbols
        if partly := {s: v for s, (v, own) in self.divided.items() if s in used and own & used}:
            value = whole = self.expanded(whole.xreplace(partly))
        whole = value if _size(whole) > limits.most_parts else whole
        # v sin(|v|) is no quaternion: the length of v is not any angle about an axis v. An entry
        # that is a name `zero` is the number.
        known = {s: v for s, v in self.definitions.items() if v is not None}
        squares = {*self.squares.values()}
        lengths = {s: v for s, v in known.items() if is_length(v) or v.free_symbols & squares}
        value = value.xreplace(lengths)
        value = value.applyfunc(lambda e: known[e] if known.get(e) in (0, 1) else e)
        symbols = whole.free_symbols | value.free_symbols
        inputs = whole.free_symbols - self.components
        unread = {s.name for s in inputs if self.definitions.get(s, s) is None}
        names = _short_names(symbols - squares)
        names |= {s: self.square(v, names) for v, s in self.squares.items()}
        values = [names.get(s, s) for s in self.definitions]
        forms = [language.spelled_out(m.xreplace(names), values) for m in (whole, value)]
        places = tuple((_last(n), self.unread.get(n) or min(lines)) for n in sorted(unread))
        computed = {names[s]: self.expanded(known[s]).xreplace(names) for s in symbols & {*known}}
        title = ", ".join(map(_last, name.split(", ")))
        formula = Formula(lines=lines, name=title, forms=tuple(dict.fromkeys(forms)))
        formula = replace(formula, unread=places, is_final=is_final, is_flat=is_flat, names=names)
        formula = replace(formula, computed=computed, is_bounded=is_bounded)
        formula = replace(formula, **self.facts.get(key, {}))
        conditions = frozenset(map(sum, self.conditions.items()))
        self.formulas.append(replace(formula, conditions=frozenset({conditions})))

    def cases(self) -> Iterator[Formula]:
        """The formulas; one whose names are assigned again has no conditions."""
        for each in self.formulas:
            own = [*zip(each.name.split(", "), each.lines, strict=False)]
            is_changed = any(self.values.get(n, (None, line))[1] != line for n, line in own)
            yield replace(each, conditions=Formula.conditions) if is_changed and own[1:] else each

    def square(self, vector: sp.Symbol, names: Mapping[sp.Expr, sp.Expr]) -> sp.Expr:
        """|v|² of a vector, or of a quaternion if a formula has its fourth component."""
        used = {symbol.name for symbol in names}
        has_letters = any(f"{vector}.{letter}" in used for letter in "xyzw")
        keys = [*"xyzw"] if has_letters else range(self.first, 4 + self.first)
        symbols = [sp.Symbol(f"{vector}.{key}", real=True) for key in keys]
        symbols = symbols[: 3 + (symbols[3].name in used)]
        return sum(names.get(s, sp.Symbol(_last(s.name), real=True)) ** 2 for s in symbols)

    # Expressions

    def read(self, tree: Tree) -> Any:
        """The value of an expression; raises ExpressionError if it is not understood."""
        self.depth += 1
        self.program.steps["read"] += 1
        try:
            self.refuse_if(self.depth > limits.deepest, tree, "is nested too deeply")
            self.refuse_if(self.is_full(tree.line), tree, "is not read, since the file is too long")
            value = getattr(self, f"read_{tree.kind}", self.named)(tree)
            if isinstance(value, sp.MatrixBase) and _size(value) > limits.most_parts:
                self.program.steps["read"] += limits.steps_of_long
            return value
        except ExpressionError as error:
            if str(error).startswith("`"):
                raise
            raise self.unreadable(tree, f"is not read: {error}") from None
        finally:
            self.depth -= 1

    def tried(self, tree: Tree) -> Any:
        """The value, or None if it is not understood."""
        try:
            return self.read(tree)
        except ExpressionError as error:
            self.reason = str(error)
            return None

    def place(self, value: sp.MatrixBase, entries: Sequence[Tree]) -> sp.MatrixBase:
        """A matrix, whose entries have their lines."""
        self.facts[value] = {"entries": tuple(each.line for each in entries)}
        return value

    def read_block(self, tree: Tree) -> Any:
        """A number; in Rust, the last of several statements."""
        digits = patterns.numbers.fullmatch(tree.text) if not tree.parts else None
        if digits:
            text = digits[2].replace("_", "")
            text = text if text.isdigit() else repr(float(text))
            self.refuse_if(text == "inf" or len(text) > limits.longest_number, tree)
            return language.number(digits[1] + text)
        is_rust = tree.parts and self.program.suffix == ".rs"
        value = self.run_block(tree, is_value=True) if is_rust else self.named(tree)
        self.refuse_if(value is None, tree)
        return value

    def read_index(self, tree: Tree) -> Any:
        # np.r_[w, v]
        return self.stacked(tree) if tree.parts[0].word in ("r_", "c_") else self.named(tree)

    def read_if(self, tree: Tree) -> Any:
        return self.read(tree.parts[self.branch(tree, tree.parts)])

    def read_assign(self, tree: Tree) -> Any:
        """a = b inside an expression."""
        self.run(tree)
        return self.read(tree.parts[0])

    def read_list(self, tree: Tree) -> Any:
        self.refuse_if(not 0 < len(tree.parts) <= limits.longest_list, tree)
        values = [value for each in tree.parts for value in self.several(each)]
        is_lone = tree.is_one_of("lone") and len(values) == 1
        return values[0] if is_lone else self.place(rows(values), tree.entries)

    def several(self, tree: Tree) -> Any:
        """The value, or those of *v in [0, *v]."""
        is_vector = tree.kind == "splat"
        return as_matrix(self.vector(self.read(tree.parts[0]))) if is_vector else [self.read(tree)]

    def read_record(self, tree: Tree) -> Any:
        """{w: a, x: b, y: c, z: d} of JavaScript, and Quaternion { x: a, ... } of Rust."""
        if len(tree.parts) == 1:
            return self.read(tree.parts[0])
        self.refuse_if(frozenset(map(str.lower, tree.keys)) not in _COMPLETE, tree)
        return rows([self.read(each) for each in tree.parts])

    def read_matrix(self, tree: Tree) -> Any:
        rows_ = self.beside_scalar([self.read(row) for row in tree.parts])
        return self.place(called("stack", rows_), tree.entries)

    def beside_scalar(self, parts: list[Any]) -> list[Any]:
        """(cos a/2, v sin a/2), where v is a name: beside the cosine of a, v may be a number."""
        pair = parts if len(parts) == 2 else ()
        entries = [as_matrix(part)[0] for part in pair if len(as_matrix(part)) == 1]
        for k, w in enumerate(entries if len(entries) == 2 else ()):
            is_half = isinstance(w, sp.cos) and w.args[0].as_coeff_Mul()[0] != 1
            if (is_half or w == 0) and not entries[1 - k].is_Function:
                parts[1 - k] = as_matrix(self.vector(entries[1 - k]))
        return parts

    def read_row(self, tree: Tree) -> Any:
        return called("stack", [as_matrix(self.read(cell)).T for cell in tree.parts]).T

    def read_transposed(self, tree: Tree) -> Any:
        return self.transposed(self.read(tree.parts[0]))

    def transposed(self, value: Any) -> Any:
        """The transpose; for a name without a value another name, since it may be a matrix."""
        if not _is_scalar(value):
            return (value if self.first else _unflattened(value)).T
        is_number = value in self.components or self.definitions.get(value) is not None
        return self.part_of(value, "T") if value.is_Symbol and not is_number else value

    def read_member(self, tree: Tree) -> Any:
        if tree.word in ("Sin", "Cos", "Tan") and tree.parts:  # angle.Cos
            return called(tree.word.lower(), [self.read(tree.parts[0])])
        if CALLS.get(tree.word) == "unit" and re.search("mat|rot", tree.text, re.IGNORECASE):
            return sp.ImmutableMatrix(sp.eye(3 if "3" in tree.text else 4))
        return self.read_transposed(tree) if tree.word == "T" and tree.parts else self.named(tree)

    def read_unary(self, tree: Tree) -> Any:
        sign = {"+": 1, "-": -1}.get(tree.word)
        return sign * self.read(tree.parts[-1]) if sign else self.named(tree)

    def read_binary(self, tree: Tree) -> Any:
        self.refuse_if(len(tree.parts) != 2, tree)
        left, right = map(self.read, tree.parts)
        sign = tree.word
        is_negative = sign in ("^", ".^") and tree.parts[0].word == "-"
        if is_negative and tree.node.named_children[0].type == "unary_operator":
            return -combined("**", -left, right)  # -x^2, for the grammar of MATLAB (-x)^2
        if sign == "\\" and self.first:  # I \ v
            left, sign = self.of_vectors("inv", [left]), "*"
        is_turn = sign == "%" and _is_scalar(right) and (right / sp.pi).is_number
        if is_turn and self.expanded(left).has(*INVERSE):  # the same angle
            return left
        is_rounded = sign == "/" and self.program.suffix not in TYPES["real"] and _is_scalar(right)
        if is_rounded and not (left / right).is_Integer and all(map(self.is_whole, tree.parts)):
            raise self.unreadable(tree, "is a division of whole numbers, which rounds")
        if sign in ("+", "-"):
            left, right = self.beside(left, right), self.beside(right, left)
        elif sign == "@" and left == right:  # r @ r
            return self.of_vectors("dot", [left, right])
        elif sign in ("*", "@") and (value := self.of_tensor(left, right)) is not None:
            return value
        else:
            is_open = sign in ("*", "@") and self.is_open(tree.parts[0], sign, left, right)
            self.refuse_if(is_open, tree, "may be a product of matrices or of quaternions")
            if isinstance(right, sp.Symbol) and not self.path(tree.parts[0]):
                self.add(_ARGUMENT, left, tree.line)  # the matrix of rates, times them
            left, right = (_unflattened(each) for each in (left, right))
            is_product = sign == "@" or self.program.product == "*"
            if is_product and getattr(left, "shape", ()) == (4, 4):  # of a product, times q
                right = self.vector(right, 4)
        return combined(self.operation(tree, sign, left, right), left, right)

    def is_open(self, first: Tree, sign: str, *sides: Any) -> bool:
        """Whether a name without a value may be a matrix or a quaternion: C P Cᵀ, q r."""
        shapes = [getattr(side, "shape", ()) for side in sides]
        if (4, 1) in shapes:
            names = [_last(side.name) for side in sides if isinstance(side, sp.Symbol)]
            return any(map(patterns.quaternion.fullmatch, names))
        if isinstance(left := sides[0], sp.Symbol) and shapes[1] in ((3, 3), (4, 4)):
            return sign == "@" or _last(left.name)[0].isupper()  # T = T @ turn, in a loop
        if () in shapes or first.kind != "binary" or first.word not in ("*", "@"):
            return False
        outer, middle = map(self.tried, first.parts)
        is_matrix = sign == "@" or first.parts[1].word[:1].isupper()
        return is_matrix and isinstance(outer, sp.MatrixBase) and isinstance(middle, sp.Symbol)

    def is_whole(self, tree: Tree) -> bool:
        """Whether an expression is a whole number by its digits and the types of its names."""
        if tree.kind in ("binary", "unary"):
            return all(map(self.is_whole, tree.parts))
        is_number = patterns.whole_numbers.fullmatch(tree.text) is not None
        return is_number or self.holds_integers(self.path(tree))

    def holds_integers(self, path: Path) -> bool:
        """Whether a name or a member is declared as a whole number, or as an array of them."""
        names = [key for key in path if isinstance(key, str)]
        whole = self.program.integers if len(names) > 1 else self.integers
        return bool(names) and names[-1] in whole

    def beside(self, value: Any, other: Any) -> Any:
        """A summand: c v, where v has no value, in components if it is added to a vector.

        A name without a value is a matrix if it is added to one.
        """
        value = self.moment(value) if _is_scalar(value) and self.is_moment(other) else value
        shape = getattr(other, "shape", ())
        if shape == (3, 3) and isinstance(value, sp.Symbol):
            return self.tensor(value)
        return self.vector(value, 3, other.free_symbols) if shape == (3, 1) else value

    def is_moment(self, value: Any) -> bool:
        """Whether a vector is a sum with w × I w in it."""
        entries = [self.tensor(name)[0, 0] for name in self.tensors]
        return getattr(value, "shape", ()) == (3, 1) and bool(value.has(*entries))

    def moment(self, value: Any, w: Any = None) -> Any:
        """I w, in I w + w × I w, for a product of names that would be a scalar otherwise.

        A program may write I*w, I @ w or dot(I, w); only the vector product tells that I is a
        matrix.
        """
        names = {*value.free_symbols}
        names |= {sp.Symbol(s.name.rpartition(".")[0], real=True) for s in names}
        known, vectors = (self.tensors & names, names) if w is None else (names, [w])
        for tensor, vector in product(known, vectors):
            own, parts = (as_matrix(self.vector(each)) for each in (tensor, vector))
            if len(own) == len(parts) and value in (tensor * vector, own.dot(parts)):
                self.tensors.add(tensor)
                return self.tensor(tensor) * parts
        return value

    def of_tensor(self, left: Any, right: Any) -> Any:
        """n nᵀ, nᵀ n, I⁻¹ (... + w × I w), or C(w) I w; None for another product."""
        for side, other, meaning in ((left, right, "outer"), (right, left, "dot")):
            for name in side.free_symbols if _is_scalar(side) else ():
                is_one = str(other) == f"{name}.T" and name not in (side / name).args
                if is_one and _last(name.name)[0].islower():
                    return side / name * self.of_vectors(meaning, [name, name])
        if self.is_moment(right) and _is_scalar(left):
            inverse = sp.Symbol(f"{1 / left}_inv", real=True) if 1 / left in self.tensors else left
            if inverse.is_Symbol and "inv" in inverse.name:
                return self.tensor(inverse) * right
        # a name between C(w) and w is a tensor, or the product would be zero
        shapes = [getattr(each, "shape", ()) for each in (left, right)]
        if shapes == [(3, 3), (3, 1)] and (left * right).is_zero_matrix:
            for tensor in left.free_symbols - right.free_symbols:
                self.tensors.add(tensor)
                return left.xreplace({tensor: sp.S.One}) * self.tensor(tensor) * right
        return None

    def tensor(self, name: sp.Symbol) -> Any:
        """The nine entries of a matrix without a value."""
        return rows([self.vector(self.component(name, k)) for k in range(3)])

    def vector(self, value: Any, count: int = 3, others: Iterable[Any] = ()) -> Any:
        """Components for a name without a value, the likelier if `others` are components of it."""
        if not _is_scalar(value):
            return value
        stems = {symbol.name.rpartition(".")[0] for symbol in others}
        parts = [self.component(value, key, stems) for key in range(count)]
        return value if None in parts else rows(parts)

    def operation(self, tree: Tree, sign: str, *sides: Any) -> str:
        sign = {".*": "%", "./": "/", ".^": "**", "^": "**"}.get(sign, sign) if self.first else sign
        self.refuse_if(sign not in [*"+-*/@", "**", "%" if self.first else "*"], tree)
        if sign != "*" or not all(isinstance(side, sp.MatrixBase) for side in sides):
            return sign
        is_swizzled = self.program.suffix in TYPES["swizzling"]  # v * w, but not M * v
        product = "%" if is_swizzled and {s.cols for s in sides} == {1} else self.program.product
        self.refuse_if(not product, tree, "is a product of matrices or of their entries")
        return product

    def read_choose(self, tree: Tree, parts: Sequence[Tree] = ()) -> Any:
        """One of two values."""
        condition, *trees = parts or tree.parts
        self.refuse_if(len(trees) != 2, tree)  # a ?: b
        if condition.constant is not None:
            return self.read(trees[not condition.constant])
        value = self.bounded_value(condition, trees)
        return self.read(trees[self.branch(tree, trees, condition)]) if value is None else value

    def bounded_value(self, condition: Tree, trees: Sequence[Tree]) -> Any:
        """One of two values, if the other is a bound of it."""
        own, sign, number = self.sides(condition)
        one, two = map(self.tried, trees) if sign else (None, None)
        bound = {">": 1, "<": -1}.get(sign, math.nan)  # the value if the condition is true
        for limit, other, side in ((one, two, 1), (two, one, -1)):
            is_near = limit == side * bound and abs(number - limit) < 0.01
            if is_near and _inner(own) == _inner(other):
                return _Bounded(_inner(own))
        return None

    def sides(self, condition: Tree) -> tuple[Any, str, Any]:
        """An expression, one of = ! < >, and a number; no sign for another condition."""
        condition = self.tests.get(condition.text, condition)
        sign, parts = condition.word, condition.parts
        if condition.kind == "call" and condition.called == "isclose":
            sign, parts = "==", parts[1:3]
        values = [self.tried(each) for each in parts]
        if re.fullmatch("[<>]=?|[=!~]==?", sign) and [*map(_is_scalar, values)] == [True, True]:
            for own, other, signs in ((*values, "<>!"), (*values[::-1], "><!")):
                small = [s for s in other.free_symbols if patterns.small.search(s.name)]
                number = self.expanded(other).xreplace(dict.fromkeys(small, sp.Float(1e-6)))
                if number.is_number:
                    return own, sign[0].translate(str.maketrans("<>~", signs)), number
        return None, "", None

    # Names, members and indices

    def path(self, tree: Tree) -> Path:
        """The path of R[0][1], q.w(), m.at(0, 1), state["phi"], self.phi or *p; () for others."""
        is_setter = tree.kind == "call" and tree.called.startswith("set")  # whose value may be long
        is_long = tree.node.end_byte - tree.node.start_byte > limits.longest_place and not is_setter
        if tree.kind == "this":
            return ("this",)
        if is_long or (tree.is_reference and self.program.is_formula):  # a + * b
            return ()
        match tree.kind:
            case "name":
                return (tree.word,) if tree.word else ()
            case "assign":
                return self.path(tree.parts[0])
            case "unary" if tree.word in ("*", "&") and not self.program.is_formula:
                return self.path(tree.parts[-1])
            case "member" if tree.parts:
                path = self.path(tree.parts[0])
                return _below(path, tree.word) if path else ()
            case "index":
                return self.indexed(self.path(tree.parts[0]), tree.parts[1:])
            case "call":
                return self.path_of_call(tree)
        return ()

    def path_of_call(self, tree: Tree) -> Path:
        """A call may be an entry, R(1, 2), or a component, q.w()."""
        name, nodes, word = tree.called, tree.parts[1:], function_word(tree.called)
        owner = self.path(tree.owner) if tree.owner else ()
        if tree.owner and not owner:  # (a*b).sum(-1)
            return ()
        if len(nodes) == name.startswith("set"):  # q.w(), R.get01(), v.setX(a)
            match = patterns.getter.fullmatch(name)
            if name == "get" and owner and patterns.angle.fullmatch(str(owner[-1])):  # yaw.get()
                return owner
            own = name if name in [*"WXYZ"] else match and match[1].lower().replace("scalar", "w")
            owner = owner or ("this",)
            if own and own.isdigit():
                return (*owner, *map(int, own))
            return _below(owner, own) if own else ()
        if CALLS.get(name) == "entry" or (name, len(nodes)) == ("set", 2):  # q.set(0, a)
            return self.indexed(owner, nodes[:1] if name == "set" else nodes)
        if name in ("row", "col") and len(nodes) == 1 and owner:
            return (*owner, *(self.index(nodes[0]), _ALL)[:: 1 if name == "row" else -1])
        is_known = word in _WORDS and (len(nodes) != 2 or len(word) > 1)  # T(2), but not t(1, 2)
        is_own = word in self.program.functions and not self.first
        if is_own or (is_known and self.values.at(*owner, name) is None):
            return ()
        return self.indexed((*owner, name), nodes) if len(nodes) <= 2 + self.first else ()

    def indexed(self, path: Path, trees: Sequence[Tree]) -> Path:
        indices: list[Any] = [self.index(tree) for tree in trees]
        if not path or None in indices:
            return ()
        while indices[:1] == [...] or (len(indices) > 2 and indices[0] == _ALL):  # of a batch
            indices = indices[1:]
        shifted = [i - self.first if isinstance(i, int) else i for i in indices[:2]]
        is_place = all(not isinstance(i, int) or 0 <= i < 64 for i in shifted)
        if self.by_columns(path) and isinstance(path[-1], int):
            path, shifted = path[:-1], [*shifted, path[-1]]
        return (*path, *shifted) if is_place and trees else ()

    def by_columns(self, path: Path) -> bool:
        return self.program.is_glm and path[0] not in self.program.arrays

    def index(self, tree: Tree) -> Any:
        """An index as it is written, or the key of a table."""
        text = tree.text
        if text in ("...", "-1"):  # of all before, or the last of a quaternion
            return 3 if text == "-1" else ...
        if match := re.fullmatch(r"(\d?):(\d?)", text):
            ends = [int(end) if end else None for end in match.groups()]
            return slice(ends[0] - self.first if ends[0] else None, ends[1])
        if match := re.fullmatch(r"""["'](\w+)["']|(\d\d?)""", text):
            return match[1] or int(match[2])
        path = self.path(tree)
        if path and path[0] not in {*self.values, *self.inputs}:
            return self.program.constants.get(str(path[-1]), _AXES.get(str(path[-1])))
        value = self.tried(tree) if tree.kind != "assign" else None  # i++
        value = self.definitions.get(value, value)
        return int(value) if isinstance(value, sp.Integer) else None

    def named(self, tree: Tree) -> Any:
        """A name, an entry, a component, or several: q.xyz."""
        path = self.path(tree)
        if not path:
            for each in tree.parts if tree.kind != "function" else ():
                self.add(_ARGUMENT, self.tried(each), each.line)
            raise self.unreadable(tree)
        if isinstance(path[-1], str) and path[-1] in language.CONSTANTS:
            return language.CONSTANTS[path[-1]]
        if any(path[: len(each)] == each for each in self.untracked):  # slices have no hash
            raise self.unreadable(tree, "is changed inside an expression or an inner function")
        start = self.values.at(path[0])
        if start is None:
            self.inputs.add(path[0])
            start = sp.Symbol(path[0], real=True)
        whole = self.values.at(*path[:-1]) if path[-1] in [*"wxyz"] else None
        is_list = isinstance(whole, _Record) and whole.keys() == {0, 1, 2, 3}
        if is_list and self.program.suffix not in TYPES["swizzling"]:  # in which order nobody knows
            return sp.Symbol(_dotted(path), real=True)
        return self.entry(tree, start, path[1:])

    def entry(self, tree: Tree, value: Any, keys: Path) -> Any:
        """A part of a value."""
        if isinstance(value, _Record):
            if self.first and len(keys) == len(value) == 1 and isinstance(value.at(0), _Record):
                value = value.at(0)  # M(2) of a row
            key = keys[0] if keys and not isinstance(keys[0], slice) else None
            if key is not None and key in value:
                return self.entry(tree, value.at(key), keys[1:])
            if None in value and (key is not None or len(value) == 1):  # it is not assigned
                return self.entry(tree, value.at(None), keys)
            value = value.whole()[0]
        self.refuse_if(value is None, tree, "has entries without values")
        if not keys:
            return value
        key, *others = keys
        letters = "xyz" if key in ("vec", "imag", "v") else key
        if isinstance(letters, str) and re.fullmatch("[xyzw]{2,4}", letters):
            parts = rows([self.entry(tree, value, (letter,)) for letter in letters])
            return self.entry(tree, parts, tuple(others))
        lines: list[Any] = []
        if isinstance(value, sp.MatrixBase):
            value = _unflattened(value) if others else value
            if others and 1 in value.shape:  # v(3, 1) of a column
                key, others = next((k for k in keys if k not in (0, _ALL)), key), []
            lines = _lines(value.T if value.rows == 1 else value)
            key = "xyzw".find(key.lower()) if isinstance(key, str) else key
        elif key == _ALL and others:  # a column, or of a batch: q[:, 0]
            if isinstance(others[0], int) and value.is_Symbol:
                value = self.part_of(value, f"@{others.pop(0) + self.first}")
            return self.entry(tree, value, tuple(others))
        if isinstance(key, slice):
            of_name = range(key.start or 0, key.stop or (4 if key.start else 3))
            numbers = range(len(lines))[key] if lines else of_name
            parts = [self.entry(tree, value, (k, *others)) for k in numbers]
            return parts[0] if len(parts) == 1 else rows(parts)
        part = dict(enumerate(lines)).get(key) if lines else self.component(value, key)
        self.refuse_if(part is None, tree, "has no value")
        return self.entry(tree, part, tuple(others))

    def component(self, value: Any, key: int | str, stems: Collection[str] = ()) -> Any:
        """A component of a name v without a value, of v/θ if θ = |v|, of f(v), or None."""
        whole = value if value.is_Symbol else self.expanded(value)
        names = whole.free_symbols - ({*self.squares.values()} - value.free_symbols)
        names = {name for name in value.free_symbols if name.name in stems} or names
        factors = [name for name in names if name not in (value / name).free_symbols]
        vectors = [*names] if value.is_Function else factors  # f(v), or a v
        if len(vectors) != 1 or {*vectors} & self.components:
            return None
        return value.xreplace({vectors[0]: self.part_of(vectors[0], key)})

    def part_of(self, whole: sp.Symbol, key: int | str) -> sp.Symbol:
        """An entry of a name without a value, its transpose R.T, or its column R.@0.

        It is not read if the name is not.
        """
        name = f"{whole.name}.{key + self.first if isinstance(key, int) else key}"
        for view, own in syntax.VIEWS.items():
            name = re.sub(view, own, name)
        part = sp.Symbol(name, real=True)
        part = sp.Dummy(name, whole.dummy_index, real=True) if whole.is_Dummy else part
        if whole in self.definitions:
            self.definitions.setdefault(part, None)
            self.unread.setdefault(name, self.unread.get(whole.name, 0))
        return part

    # Calls

    def read_call(self, tree: Tree) -> Any:
        """A function of numbers, a method of a matrix, a constructor, or a function of the file."""
        if self.path(tree):  # R(0, 1), q.w()
            return self.named(tree)
        self.refuse_if(tree.is_integer, tree, "has whole numbers")
        base, arguments, word = tree.base, tree.parts[1:], tree.called
        if tree.owner is None:  # s, c = np.sin, np.cos
            alias = _last(str(self.values.at(word) or self.program.imported.get(word, "")))
            word = alias if function_word(alias) in FUNCTIONS else word
        name = function_word(word)
        is_own = base in {"", "Self", *_OBJECTS} and tree.called == word in self.program.functions
        if is_own:  # also if a library has a function of this name
            with suppress(ExpressionError):  # of a constructor
                return self.inline(tree)
        is_template = name == "T" and tree.owner is None and not self.program.is_formula
        meaning = "" if is_own else "wrapper" if is_template else CALLS.get(name, "")
        nodes, is_method = arguments, not patterns.module.match(base)
        is_short = name in language.OF_NUMBERS and len(nodes) <= (name in TYPES["of_two"])
        is_first = is_short or (is_method and meaning in TYPES["of_objects"]) or base == "?"
        nodes = [tree.owner, *nodes] if tree.owner is not None and is_first else nodes
        if name in language.OF_NUMBERS and nodes and not is_own:
            values = [self.read(each) for each in nodes]
            # SymPy takes a long argument apart, which costs as much as several expressions.
            self.program.steps["read"] += sum(3 * n for n in map(_size, values) if n > 12)
            return called(name, values)
        match meaning:
            case "pair" if len(nodes) == 1:
                return rows([called(each, [self.read(nodes[0])]) for each in ("sin", "cos")])
            case "number" if not arguments and self.program.suffix == ".rs":  # T::zero()
                return sp.Integer("one" in name)
            case "like" if arguments:  # ones_like(a)
                return as_matrix(self.read(nodes[0])).applyfunc(lambda _: sp.Integer("one" in name))
            case "wrapper" if nodes and (len(nodes) == 1 or nodes[0].kind in ("list", "matrix")):
                return self.read(nodes[0])
            case "same" if nodes:
                self.refuse_if(re.search("order=|[\"']F[\"']", tree.text), tree)  # by columns
                value = self.read(nodes[0])
                if value in self.squares and name.lower().startswith("normal"):
                    return value / sp.sqrt(self.squares[value])
                is_square = re.search(r"\b([34]), *\1\b", tree.text[-12:]) is not None
                is_by_columns = self.first and name == "reshape" and 1 in as_matrix(value).shape
                value = _unflattened(value) if is_square or is_by_columns else value
                return value.T if is_by_columns and as_matrix(value).cols > 1 else value
            case "zeros" | "unit":
                return self.filled(tree)
            case "clamp" | "least" if len(nodes) > 1 or tree.options:
                bounds = [sp.Float(x) for x in re.findall(r"=(-?\d\.?\d*)", tree.options)]
                return self.bounded(tree, meaning, [*map(self.read, nodes), *bounds])
            case "cosine" if self.read(nodes[0]) == called("sin", [a := self.read(nodes[-1])]):
                return called("cos", [a])  # cosFromSin(sin(a), a)
            case "fused" | "fma" if [len(nodes), name != "mul_add"] == [3, len(arguments) == 3]:
                return combined("+", combined("*", *map(self.read, nodes[:2])), self.read(nodes[2]))
            case "solve" if len(nodes) == 2:
                left, right = self.of_vectors("inv", [self.read(nodes[0])]), self.read(nodes[1])
                product = self.of_tensor(left, right)
                return combined("*", left, right) if product is None else product
            case "where" if len(nodes) == 3:
                return self.read_choose(tree, nodes)
            case _ if meaning in TYPES["of_vectors"] and nodes:
                return self.of_vectors(meaning, [self.read(each) for each in nodes])
        is_new = self.program.suffix == ".rs" and name == "new" and len(arguments) in (3, 4)
        is_new = is_new and all(each.kind == "call" for each in arguments)  # of columns
        if meaning == "stack" or patterns.by_columns.search(name) or is_new:
            return self.stacked(tree, is_new)
        values, whole = self.built(arguments)
        whole = self.in_order(base if word == "new" else word, whole)
        if patterns.built.search(f"{base}.{tree.called}"):
            if whole is not None:
                is_glm = self.program.is_glm and len(values) > 4 and name in ("new", "mat")
                return self.columns(tree, whole) if is_glm else whole
            if len(values) == 2:  # float4(v, w)
                return self.stacked(tree)
        if self.program.is_formula and tree.owner is None:
            return called(name, values)  # with an error that offers other names
        # The arguments of what is not understood, or all together, may be formulas of their own.
        for value, each in zip([*values, whole], [*arguments, *arguments[:1]], strict=False):
            self.add(_ARGUMENT, value, each.line)
        raise self.unreadable(tree)

    def built(self, nodes: Sequence[Tree]) -> tuple[list[Any], Any]:
        """The arguments of a constructor, without a flag at the end, and the matrix of them."""
        is_flag = len(nodes) > 4 or (nodes and nodes[-1].text in ("true", "false"))
        count = len(nodes) - bool(is_flag and len(nodes) - 1 in _SIZES)
        values = [*map(self.tried, nodes[:count])]
        with suppress(ExpressionError):  # of matrices that do not fit
            if len(values) in _SIZES and None not in values:
                return values, self.place(rows(values), nodes[:count])
        return values, None

    def in_order(self, name: str, value: Any) -> Any:
        """The arguments of a constructor of this file, with the scalar first or last."""
        name = self.scope.tree.class_name if name in ("cls", "Self") else name
        order = re.sub("self|[q_]", "", "".join(self.program.orders.get(name, "")).lower())
        is_one = sorted(order) == [*"wxyz"] and patterns.quaternion_type.search(name)
        if is_one and getattr(value, "shape", ()) == (4, 1):
            letters, place = ("wxyz", "first") if order[0] == "w" else ("xyzw", "last")
            value = rows([value[order.index(letter)] for letter in letters])
            self.facts.setdefault(value, {})["scalar"] = place
        return value

    def bounded(self, tree: Tree, meaning: str, values: Sequence[Any]) -> Any:
        """x of clamp(x, -1, 1), of min(1, x) or of max(-1, x), for arc sines and cosines."""
        parts = [value.as_coeff_Add() for value in values]  # a bound may be -1 + epsilon
        near = [0.995 < abs(c) < 1.005 and rest.as_coeff_Mul()[1].is_Atom for c, rest in parts]
        signs = [round(c) if is_one else 0 for (c, _), is_one in zip(parts, near, strict=True)]
        least = 1 if re.search("min", tree.called, re.IGNORECASE) else -1
        wanted = ([0, -1, 1],) if meaning == "clamp" else ([0, least], [least, 0])
        self.refuse_if(signs not in wanted, tree)
        return _Bounded(_inner(values[signs.index(0)]))

    def of_vectors(self, meaning: str, values: Sequence[Any]) -> Any:
        """An operation of matrices; a name without a value is a vector."""
        if meaning == "norm":
            return called("sqrt", [self.of_vectors("dot", values)])
        values = [*values, *values] if meaning == "dot" and len(values) == 1 else values
        if meaning == "dot" and values[0] == values[-1] and isinstance(values[0], sp.Symbol):
            return self.squares.setdefault(values[0], sp.Dummy(f"{values[0]}²", positive=True))
        if meaning == "inv":
            return combined("**", _unflattened(values[0]), sp.S.NegativeOne)
        if meaning == "T":
            return self.transposed(values[0])
        values = [self.tensor(values[0])] if meaning == "trace" and values[0].is_Symbol else values
        if meaning == "cross" and len(values) > 1:
            values = [self.moment(values[0], values[1]), self.moment(values[1], values[0])]
        if meaning in ("cross", "dot", "C", "outer"):
            names = [_last(str(s)) for s in values[0].free_symbols] if meaning == "outer" else ()
            is_long = any(getattr(v, "shape", ()) == (4, 4) for v in values)
            is_long |= any(map(patterns.quaternion.fullmatch, names))
            values = [self.vector(value, 3 + is_long) for value in values]
        if meaning == "dot" and any(as_matrix(value).cols > 1 for value in values):
            return combined("@", *map(_unflattened, values))
        return called(meaning, [as_matrix(value) for value in values])

    def filled(self, tree: Tree) -> Any:
        """zeros(3, 3), Matrix3d::Identity()."""
        numbers = [n for each in tree.parts[1:] for n in re.findall(r"\d+", each.text)]
        word, is_zero = tree.parts[0].text, CALLS[tree.called] == "zeros"  # Eigen::Matrix4d::Zero
        sizes = numbers[-2:] or re.findall(r"(?<!\d)[34](?!\d)", word)[:1] or ["3"]
        is_column = len(sizes) == 1 and len(tree.parts) > 1 and is_zero and not self.first
        is_vector = is_column or re.search("vec|quat", word, re.IGNORECASE)
        self.refuse_if(is_vector or not {*sizes} <= {*"34"}, tree)
        return sp.ImmutableMatrix((sp.zeros if is_zero else sp.eye)(int(sizes[0]), int(sizes[-1])))

    def stacked(self, tree: Tree, by_columns: bool = False) -> Any:
        axis, nodes = tree.options, tree.parts[1:]
        if len(nodes) == 2 and nodes[0].kind == "list" and re.fullmatch(r"-?\d", nodes[1].text):
            axis, nodes = f"axis={nodes[1].text}", nodes[:1]
        self.refuse_if(axis and not re.fullmatch(r"(axis|dim)=(0|1|-1|-2)", axis), tree)
        by_columns |= bool(patterns.by_columns.search(tree.called)) ^ axis.endswith(("=1", "=-1"))
        nodes = nodes[0].parts if len(nodes) == 1 and nodes[0].kind in ("list", "matrix") else nodes
        parts = self.beside_scalar([as_matrix(self.read(each)) for each in nodes])
        is_open = all(len(each) == 1 for each in parts) and any(e[0].is_Symbol for e in parts)
        self.refuse_if(tree.kind == "index" and is_open, tree, "may be of numbers or of vectors")
        # Of a batch, 1 is the axis of rows.
        own = [self.tests.get(each.text, each) for each in nodes if axis.endswith("=1")]
        if any(each.kind == "call" and patterns.other_axis.search(each.text) for each in own):
            raise self.unreadable(tree, "may be of a batch")
        if patterns.column_matrix.search(tree.called) and len(parts) in _FLAT:
            return self.columns(tree, rows([*map(sum, parts)]))
        if all(each.cols == 1 for each in parts) and len({each.rows for each in parts}) > 1:
            return sp.ImmutableMatrix(sp.Matrix.vstack(*parts))  # (w, v)
        is_flat = re.search("from_?col", tree.called, re.IGNORECASE)  # but float3x3(...) has rows
        matrix = _unflattened(rows(parts)) if is_flat else rows(parts)
        return matrix.T if by_columns and 1 not in matrix.shape else matrix

    def inline(self, tree: Tree) -> Any:
        """The value of a function of the same file."""
        name, nodes, suffix = tree.called, tree.parts[1:], self.program.suffix
        every = self.program.functions[name]
        others = [(t, [n for n in t.parameters if n not in _OBJECTS]) for t in every]
        own = [(t, n) for t, n in others if len(n) == len(nodes) and t.node != self.scope.tree.node]
        # the count of arguments tells which is called, in some languages
        is_one = len(every) == 1 or suffix not in TYPES["real"] | {".rs"}
        is_one &= len({each.around for each in every}) == len(own) == 1
        self.refuse_if(not is_one or self.inlined >= limits.inlined, tree)
        [(function, names)] = own
        is_known = function.around.start_byte <= tree.node.start_byte < function.around.end_byte
        self.refuse_if(not tree.base and (not is_known or name in self.inputs), tree)  # another's
        scope = replace(self.scope, tree=function)
        inner = _Run(self.program, scope, self.inlined + 1)
        for each, node in zip(names, nodes, strict=True):
            inner.put((each,), self.read(node), 0)
        inner.run_scope()
        self.scope.is_new |= scope.is_new
        is_closed = not inner.inputs - set(names) and None not in inner.definitions.values()
        self.refuse_if(not inner.results or None in inner.results or not is_closed, tree)
        return inner.expanded(inner.results[0])


def _lines(matrix: sp.MatrixBase) -> list[Any]:
    """The entries of a column, or rows as columns."""
    return [*matrix] if matrix.cols == 1 else [matrix[k, :].T for k in range(matrix.rows)]


def _record(value: Any, line: int) -> Any:
    if not isinstance(value, sp.MatrixBase):
        return value
    return _Record({k: (_record(each, line), line) for k, each in enumerate(_lines(value))})


def _groups(record: _Record) -> Iterator[tuple[int, list[str]]]:
    """Names of scalars that may be components of one vector, or entries of one matrix."""
    groups: dict[tuple[int, str], dict[str, str]] = {}
    for name, (value, _) in record.items():
        if isinstance(name, str) and _is_scalar(value):
            for kind, stem, index in _roles(name):
                groups.setdefault((kind, stem), {})[index] = name
    for (kind, stem), members in groups.items():
        order = _COMPLETE.get(frozenset(members)) if kind != -1 else [*members][:4]
        is_row = kind == 2 and len(groups.get((0, re.sub(r"_?\d_?$", "", stem)), ())) > 8
        if order is not None and len(order) > 2 and not is_row:  # m00, m01, m02 is no vector
            yield kind, [members[index] for index in order]


@lru_cache(maxsize=4096)
def _roles(name: str) -> list[tuple[int, str, str]]:
    """The groups to which a scalar may belong by its name, and its index in each."""
    matches = ((kind, pattern.fullmatch(name)) for kind, pattern in enumerate(patterns.scalars))
    roles = [(k, m["stem"], m["index"].replace("_", "")) for k, m in matches if m]
    if stem := stem_of(name):  # a rate, and of which set: p, q, r are not beside phi, theta, psi
        sets = (str(kind) for kind, components in enumerate(_COMPLETE) if stem in components)
        roles += [(-1, of, name) for of in ("", *sets)]
    change = "Δ" * name.startswith("Δ")
    word = re.sub(r"^[Δδ]?_*|_?(val|rad|angle)?_*$", "", name.lower())
    kinds = [kind for kind, angles in enumerate(_COMPLETE) if word in angles]
    kinds = kinds if len(word) > 1 or word in "xyz" or name in [*"ABC"] else []
    return roles + [(-2 - kind, change, word) for kind in kinds]


def _below(path: Path, name: str) -> Path:
    """The path of a member; R[0].x is an entry of a matrix, and q.xyz.x is q.x."""
    path = path[:-1] if path and str(path[-1]).lower() == "xyz" and name in _AXES else path
    if element := re.fullmatch("M([1-4])([1-4])", name):  # of a matrix of C#
        return (*path, int(element[1]) - 1, int(element[2]) - 1)
    return (*path, _AXES.get(name, name) if path and isinstance(path[-1], int) else name)


def _dotted(path: Path) -> str:
    return ".".join(map(str, path))


def _last(name: str) -> str:
    """A short name of a path: phi for state.phi, q_w for q.w, R_0_1 for self.R.0.1."""
    own = re.sub(r"^(?:self|this)\.(?!\d+(?:\.|$))|@|(?<=\d\d)_$", "", name)
    return re.findall(r"[^.]*(?:\.[A-Za-z]?\d?\d?)*$", own)[0].replace(".", "_")


def _short_names(symbols: Collection[sp.Symbol]) -> dict[sp.Expr, sp.Expr]:
    """Short names for symbols of paths, and for the symbols of later values of a name."""
    names: dict[str, sp.Symbol] = {}
    plain = {symbol.name for symbol in symbols}
    shared = {of for of in ("self.", "this.") for n in {*"wxyz"} & plain if of + n in plain}
    count = Counter(_last(name) for name in plain if "." in name)
    for symbol in sorted(symbols, key=lambda s: (s.is_Dummy, s.name.count("."), s.sort_key())):
        name = _last(symbol.name)
        is_long = name in names or count[name] > 1 or symbol.name[:-1] in shared  # also this.w
        name = symbol.name.replace(".", "_") if is_long else name
        while name in names:
            name += "_new"
        names[name] = symbol
    return {symbol: sp.Symbol(name, real=True) for name, symbol in names.items()}


def _unflattened(value: Any) -> Any:
    """Nine, twelve or sixteen numbers in a row are a matrix."""
    if not (isinstance(value, sp.MatrixBase) and 1 in value.shape and len(value) in _FLAT):
        return value
    is_padded = len(value) == 12 and not any(value[3::4])  # rows of four with a zero at the end
    return sp.ImmutableMatrix(value.reshape(*((3, 4) if is_padded else _FLAT[len(value)])))


def _is_scalar(value: Any) -> bool:
    return isinstance(value, sp.Expr) and not isinstance(value, sp.MatrixBase)


@lru_cache(maxsize=4096)
def _size(value: Any) -> int:
    """The number of parts; that of a sum of sums of itself is exponential, and not counted out."""
    return sum(1 for _ in islice(sp.preorder_traversal(value), limits.most_parts + 1))


def is_length(value: sp.Expr) -> bool:
    """Whether this is a sum of squares, or the root of one."""
    terms = sp.Add.make_args(value.base if value.is_Pow and value.exp == sp.S.Half else value)
    return len(terms) > 1 and all(t.is_Pow and t.exp == 2 for t in terms)
