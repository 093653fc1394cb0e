"""Programs as trees of a dozen kinds of nodes, whatever their language.

tree-sitter gives the syntax tree, and `nodes.toml` the kind of each type of its nodes: name,
member, index, call, list, matrix, row, record, unary, binary, choose, transposed, assign, if,
switch, loop, return, break, function; other nodes are blocks of their parts. A node is lowered when
it is looked at, since most of a program holds no formula.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from rigidsym.errors import ExpressionError, MissingExtra
from rigidsym.text.names import spelled

if TYPE_CHECKING:
    from tree_sitter import Node

_TABLES: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("nodes.toml").read_text(encoding="utf-8")
)
GRAMMARS, _KINDS, CALLS, SPELLINGS = (  # of a file, a type of node, a word, and a function
    {word: name for name, words in _TABLES[title].items() for word in words.split()}
    for title in ("grammars", "kinds", "words", "functions")
)
_TYPES = {name: frozenset(types.split()) for name, types in _TABLES["types"].items()}
CHANGES: dict[str, str] = _TABLES["changes"]
patterns = SimpleNamespace(orders=[order for n in _TABLES["orders"].values() for order in n])
for _name, _form in _TABLES["patterns"].items():
    _pattern = [*map(re.compile, _form)] if isinstance(_form, list) else re.compile(_form)
    setattr(patterns, _name, _pattern)
_CHUNK = 2_048  # bytes that the parser reads at once
_MOST_STEPS = 50_000  # of the parser: a megabyte without errors takes half as many


@cache
def _parser(grammar: str) -> Any:
    try:
        from tree_sitter import Language, Parser

        module = import_module(f"tree_sitter_{grammar}")
    except ImportError as error:
        raise MissingExtra("reading formulas in programs", "compare") from error
    language = module.language_typescript if grammar == "typescript" else module.language
    return Parser(Language(language()))


def parsed(text: str, suffix: str) -> Node:
    """The root of the syntax tree of a file with this suffix; raises MissingExtra.

    Raises ExpressionError if it takes too long: recovery from syntax errors can be quadratic.
    """
    parser, data, steps = _parser(GRAMMARS[suffix]), text.encode(), count()
    try:
        root: Node = parser.parse(
            lambda offset, _: data[offset : offset + _CHUNK],
            progress_callback=lambda *_: next(steps) > _MOST_STEPS,
        ).root_node
    except ValueError:
        parser.reset()
        raise ExpressionError("the syntax errors of this file take too long to parse") from None
    return root


def _part(node: Node, fields: str) -> Node | None:
    """The first of some parts that a node has."""
    parts = map(node.child_by_field_name, fields.split())
    return next((part for part in parts if part is not None), None)


def _children(node: Node | None, types: str = "") -> list[Node]:
    """The parts of a node, all or those of some types."""
    nodes = node.named_children if node is not None else []
    return [
        c for c in nodes if (c.type in _TYPES[types] if types else c.type not in _TYPES["ignored"])
    ]


def _text(node: Node | None) -> str:
    return node.text.decode(errors="replace") if node is not None and node.text else ""


@dataclass(eq=False)
class Tree:
    """A node of the common tree."""

    node: Node
    kind: str = "block"
    is_reference: bool = False  # &x, or an argument `out x`
    own: list[Tree] | None = None  # parts that are not those of the node

    @property
    def line(self) -> int:
        return int(self.node.start_point[0]) + 1

    @cached_property
    def span(self) -> tuple[str, int, int]:
        """The name of a function, with its first and last line."""
        last = int(self.node.end_point[0]) + 1
        return (self.word, self.line, last) if self.kind == "function" else ("", 0, 0)

    @cached_property
    def text(self) -> str:
        return _text(self.node)

    @cached_property
    def word(self) -> str:
        """The name of a name, a member or a function, or an operator."""
        node: Node | None = self.node
        if self.kind == "function":
            name = _part(self.node, "name declarator")
            name = name or (self.node.parent and _part(self.node.parent, "left name declarator"))
            return (re.findall(r"\w+", _text(name).partition("(")[0]) or [""])[-1]
        if self.kind == "member":
            node = _part(self.node, "name") or _children(self.node)[-1]
        if self.kind in ("name", "member"):
            text = patterns.type_arguments.sub("", _text(node)).partition("(")[0]
            return spelled(re.split(r"::|\.", text)[-1])
        sign = _part(self.node, "operator")
        return _text(sign or next((c for c in self.node.children if not c.is_named), None))

    @cached_property
    def parts(self) -> list[Tree]:
        """The parts, in an order that depends on the kind."""
        if self.own is not None:
            return self.own
        node, nodes = self.node, _children(self.node)
        fields = _TABLES["fields"].get(self.kind, ())
        parts = [part for names in fields if (part := _part(node, names)) is not None]
        match self.kind:
            case "name":
                return []
            case "call":  # the function, and its arguments
                outer = _part(node, "arguments value initializer")
                outer = outer or next(iter(_children(node, "arguments")), None)
                plain = [c for c in _children(outer) if c.type not in _TYPES["keyword"]]
                return [self._function(parts or nodes), *map(tree_of, plain)]
            case "index":  # the array, and its indices
                return [tree_of(nodes[0]), *_indices(nodes[1:])]
            case "comma":
                while _KINDS.get(nodes[-1].type) == "comma":  # as deep as there are parts
                    nodes += _children(nodes.pop())
            case "choose" if not parts:  # of Python: a if test else b
                nodes = [nodes[k] for k in (1, 0, 2)]
            case "member" if not parts:  # no object, if there is only a name
                nodes = nodes[:-1]
            case "function":
                nodes = parts or _children(node, "body")
            case "assign" if len(parts) == 1 and node.type == "variable_declarator":  # C#
                nodes = nodes[:2]
            case "choose" | "assign" | "member":
                nodes = parts or nodes
            case "record":  # the values
                nodes = [_part(pair, "value right") or pair for pair in self._pairs()]
            case "if":
                return [*self._branches()]
            case "switch":
                cases = [each for each in below(nodes) if each.type in _TYPES["case"]]
                return [*map(tree_of, cases), Tree(node, own=[])]
        return [*map(tree_of, nodes)]

    def _function(self, nodes: list[Node]) -> Tree:
        """The function of a call: a name, or a member of an object."""
        node, outer = self.node, self.node.parent
        if outer is not None and outer.type == "field_expression" and node == _children(outer)[-1]:
            node = outer  # MATLAB: a.b(1)
        is_member = node is outer or _part(node, "object") is not None  # Java
        return Tree(node, "member") if is_member else tree_of(nodes[0])

    def _pairs(self) -> list[Node]:
        nodes = _children(_part(self.node, "body") or self.node)
        return nodes[self.node.type == "struct_pattern" :]  # without its type

    def _branches(self) -> Iterator[Tree]:
        """The blocks of which one is run, each without its condition; an empty one for none."""
        others = self.node.children_by_field_name("alternative")
        blocks = [self.node, *dict.fromkeys([*others, *_children(self.node, "branch")])]
        alternatives = {block.id for block in blocks[1:]}
        for block in blocks:
            condition = _part(block, "condition")
            constant = Tree(condition).constant if condition is not None else None
            if block != self.node and condition is not None and _KINDS.get(block.type) == "if":
                yield tree_of(block)  # else if, which has the other branches in it
                return
            skipped = alternatives | {c.id for c in (condition, _part(block, "name")) if c}
            if constant is not False:
                own = [tree_of(c) for c in _children(block) if c.id not in skipped]
                yield Tree(block, own=own)
            if constant or (block != self.node and condition is None):
                return
        yield Tree(self.node, own=[])

    @cached_property
    def changing(self) -> list[Tree]:
        """All trees below that may change a name."""
        return [*walk(self.node, "assign", "call", "binary")]

    @cached_property
    def called_names(self) -> set[str]:
        """The names of the functions that a text calls."""
        return {*re.findall(r"\w+(?=\s*\()", self.text)}

    @cached_property
    def has_result(self) -> bool:
        """Whether a function may have a value: one in C++ may be run for its effects only."""
        body = _part(self.node, "body")
        has_body = body is not None and body.type == "compound_statement"
        return not has_body or re.search(r"\breturn\b\s*[^\s;]", self.text) is not None

    @property
    def constant(self) -> bool | None:
        """The value of a condition, if it is constant."""
        values = {"0": False, "false": False, "1": True, "true": True}
        return values.get(self.text.strip("() ").lower())

    @property
    def keys(self) -> list[str]:
        """The names of the parts of a record."""
        keys = (_part(pair, "key field designator left") or pair for pair in self._pairs())
        return [_text(key).lstrip(".") for key in keys]

    @property
    def declared_type(self) -> str:
        """The type of a new name in C++."""
        return _text(_part(self.node.parent, "type")) if self.node.parent else ""

    @property
    def options(self) -> str:
        """The arguments of a call that have keywords: axis=1."""
        outer = _part(self.node, "arguments")
        return "".join(re.sub(r"\s", "", _text(each)) for each in _children(outer, "keyword"))

    @property
    def called(self) -> str:
        """The name of the function of a call."""
        return self.parts[0].word

    @property
    def owner(self) -> Tree | None:
        """The object whose method is called, or the module of the function."""
        return next(iter(self.parts[0].parts), None) if self.parts[0].kind == "member" else None

    @property
    def base(self) -> str:
        """The path of the owner; "?" for one that is an expression."""
        text = re.sub(r"(?<!\s)\s*(?:->|::|[?!]\.)\s*", ".", self.owner.text) if self.owner else ""
        return text if re.fullmatch(r"[\w.]*", text) else "?"

    @property
    def declared(self) -> set[str]:
        """The names that a statement declares for its block alone."""
        if not self.is_one_of("local"):
            return set()
        return _declared(self.node)

    @property
    def around(self) -> Node:
        """The class, namespace or function that contains a function, or the file."""
        node = self.node.parent or self.node
        while node.parent and node.type not in _TYPES["around"]:
            node = node.parent
        return node

    @property
    def is_integer(self) -> bool:
        """Whether a call has whole numbers: static_cast<int>(a), a.astype(int), dtype=int."""
        if self.kind != "call":
            return False
        text = self.parts[0].text.partition("<")[2].rstrip("> ")
        end = f"{self.options} {self.text[-30:]}"
        return bool(patterns.integer.fullmatch(text) or patterns.integer_entries.search(end))

    def whole_numbers(self) -> dict[tuple[int, str], bool]:
        """Whether names are declared as whole numbers, by the functions that declare them, or 0."""
        names: dict[tuple[int, str], bool] = {}
        around = [self.node]  # asking each node for its parents is quadratic in a flat tree
        for node in below([self.node]):
            while len(around) > 1 and node.start_byte >= around[-1].end_byte:
                around.pop()
            if patterns.declaration.search(node.type) and (outer := _part(node, "type")):
                is_whole = patterns.integer.fullmatch(patterns.qualifier.sub("", _text(outer)))
                place = around[-1].id * (_KINDS.get(around[-1].type) == "function")
                for key in ((place, name) for name in _declared(node)):
                    names[key] = names.get(key, False) or is_whole is not None
            if node.type in _TYPES["around"]:
                around.append(node)
        return names

    @property
    def is_alias(self) -> bool:
        """Whether an assignment gives an object another name: auto& b = a, b = &a."""
        parts = (_part(self.node, fields) for fields in ("declarator", "right value"))
        types = [part.type for part in parts if part is not None]
        return not _TYPES["alias"].isdisjoint(types) or bool(re.search(r"=\s*&", self.text))

    @property
    def targets(self) -> list[Tree]:
        """The parts of a tuple on the left, or the only one."""
        return self.parts if self.kind in ("list", "record") else [self]

    def is_one_of(self, types: str) -> bool:
        return self.node.type in _TYPES[types]

    def covers(self, byte: int) -> bool:
        """Whether a block contains this place of the text."""
        return any(p.node.start_byte <= byte < p.node.end_byte for p in self.parts or [self])


def _declared(node: Node) -> set[str]:
    """The names that a declaration, or a parameter, declares."""
    inner = [c for c in node.named_children if c.type == "variable_declaration"]  # C#
    node = next(iter(inner), node)
    parts = [c for c in node.named_children if c.type == "variable_declarator"]
    names: set[str] = set()
    for own in [*node.children_by_field_name("declarator"), *parts] or [node]:
        while part := _part(own, "declarator name pattern"):
            own = part
        names |= {spelled(_text(n)) for n in below([own]) if _KINDS.get(n.type) == "name"}
    return names


def _flat(nodes: list[Node], kind: str) -> list[Tree]:
    trees = [*map(tree_of, nodes)]
    return [part for tree in trees for part in (tree.parts if tree.kind == kind else [tree])]


def _indices(nodes: list[Node]) -> list[Tree]:
    """m[i, j] has two indices, and m[[i, j]] of Python one, which is a list."""
    return [*map(tree_of, nodes)] if nodes and nodes[0].type == "list" else _flat(nodes, "list")


def tree_of(node: Node) -> Tree:
    """The common tree of a node, without brackets, casts and the like around it."""
    is_reference = False
    while (kind := _KINDS.get(node.type, "block")) == "wrap":
        is_reference |= node.type in _TYPES["reference"]
        if node.type in _TYPES["cast"] and patterns.integer.fullmatch(
            _text(_part(node, "type"))
        ):  # (int)a is another number
            return Tree(node, "cast")
        inner = _part(node, "value declarator") or next(iter(_children(node)[-1:]), None)
        if inner is None:
            return Tree(node)
        node = inner
    if kind == "list" and (pairs := _children(node)) and pairs[0].type in _TYPES["pair"]:
        kind = "record"
    if kind == "member" and _children(node)[-1].type == "function_call":  # MATLAB: a.b(1)
        node, kind = _children(node)[-1], "call"
    if kind not in ("block", "function") and any(c.is_error for c in node.children):
        kind = "error"  # without the parts that it should have
    return Tree(node, kind, is_reference)


def below(nodes: Iterable[Node]) -> Iterator[Node]:
    """Nodes and all that they contain, in the order of the text, without recursion."""
    stack = [*nodes][::-1]
    while stack:
        node = stack.pop()
        yield node
        stack += node.named_children[::-1]


def walk(node: Node, *kinds: str) -> Iterator[Tree]:
    """All trees of some kinds below a node, in the order of the text."""
    return (
        Tree(each, kind)
        for each in below(node.named_children)
        if (kind := _KINDS.get(each.type, "block")) in kinds
    )


def damaged(error: Node) -> Tree:
    """The expression or assignment that is not read because of an error in it."""
    node, around = error, ("block", "function", "if", "switch", "loop")
    while node.parent and _KINDS.get(node.parent.type, "block") not in around:
        node = node.parent
    return Tree(node)


def parameters(function: Node) -> list[str]:
    """The names of the parameters of a function."""
    types = _TYPES["parameters"]
    outer = next((each for each in below(function.named_children) if each.type in types), None)
    outer = _part(function, "parameter") or outer
    names = []
    for each in _children(outer) or [outer] if outer is not None else ():
        own = _part(each, "declarator pattern name") or each
        names += [_text(n) for n in below([own]) if _KINDS.get(n.type) == "name"][:1]
    return [*map(spelled, names)]
