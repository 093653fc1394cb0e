"""Programs as trees of a dozen kinds of nodes, whatever their language.

tree-sitter gives the syntax tree, and `nodes.toml` the kind of each type of its nodes: name,
member, index, call, list, matrix, row, record, unary, binary, choose, transposed, assign, if,
switch, loop, return, break, function; other nodes are blocks of their parts. A node is lowered when
it is looked at, since most of a program holds no formula.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from importlib import import_module
from itertools import chain, count
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from rigidsym.errors import ExpressionError, MissingExtra
from rigidsym.system.files import table_beside
from rigidsym.text.names import spelled

if TYPE_CHECKING:
    from tree_sitter import Node

_TABLES: dict[str, dict[str, Any]] = table_beside(__file__, "nodes.toml")
GRAMMARS, _KINDS, CALLS, SPELLINGS, NUMBERS = (  # of files, types of nodes, words, and names
    {word: name for name, words in _TABLES[title].items() for word in words.split()}
    for title in ("grammars", "kinds", "words", "functions", "constants")
)
TYPES = {name: frozenset(types.split()) for name, types in _TABLES["types"].items()}
_TITLES = ("changes", "remarks", "rules", "sums", "views", "ways", "ways_of", "whole")
CHANGES, REMARKS, RULES, SUMS, VIEWS, WAYS, WAYS_OF, WHOLE = (_TABLES[title] for title in _TITLES)
SHAPES = {(int(s[0]), int(s[2])): names.split() for s, names in _TABLES["shapes"].items()}
patterns = SimpleNamespace(orders=[order for n in _TABLES["orders"].values() for order in n])
limits = SimpleNamespace(**_TABLES["limits"])
for _name, _form in _TABLES["patterns"].items():
    _pattern = [*map(re.compile, _form)] if isinstance(_form, list) else re.compile(_form)
    setattr(patterns, _name, _pattern)


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
            lambda offset, _: data[offset : offset + limits.chunk],
            progress_callback=lambda *_: next(steps) > limits.parser_steps,
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
    return [c for c in nodes if (c.type in TYPES[types or "ignored"]) == bool(types)]


def _text(node: Node | None) -> str:
    return node.text.decode(errors="replace") if node is not None and node.text else ""


@dataclass(eq=False)
class Tree:
    """A node of the common tree."""

    node: Node
    kind: str = "block"
    is_reference: bool = False  # &x, or an argument `out x`
    own: list[Tree] | None = None  # parts that are not those of the node
    condition: Tree | None = None  # of a branch

    @property
    def line(self) -> int:
        return int(self.node.start_point[0]) + 1

    @cached_property
    def text(self) -> str:
        return _text(self.node)

    @cached_property
    def changes(self) -> list[Tree]:
        """What may change a name: assignments, calls and streams, also the whole."""
        return [self, *walk(self.node, "assign", "call", "binary")]

    @cached_property
    def word(self) -> str:
        """The name of a name, a member or a function, or an operator."""
        node: Node | None = self.node
        if self.kind == "function":
            outer = self.node.parent and _part(self.node.parent, "left name declarator")
            names = (_part(self.node, "name declarator"), outer)
            words = (re.findall(r"\w+", _text(name).partition("(")[0]) for name in names)
            return next((each[-1] for each in words if each), "")
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
        node, fields = self.node, _TABLES["fields"].get(self.kind, ())
        parts = [part for names in fields if (part := _part(node, names)) is not None]
        nodes = parts or _children(node)
        match self.kind:
            case "name":
                return []
            case "call":  # the function, and its arguments
                outer = _part(node, "arguments value initializer")
                outer = outer or next(iter(_children(node, "arguments")), None)
                plain = [c for c in _children(outer) if c.type not in TYPES["keyword"]]
                return [self._function(nodes), *map(tree_of, plain)]
            case "index":  # the array, and its indices
                first, *trees = map(tree_of, nodes)
                is_one = nodes[-1].type == "list"  # m[[i, j]] of Python
                flat = (t.parts if t.kind == "list" and not is_one else [t] for t in trees)
                return [first, *chain.from_iterable(flat)]
            case "comma":
                while _KINDS.get(nodes[-1].type) == "comma":  # as deep as there are parts
                    nodes += _children(nodes.pop())
            case "choose" if not parts:  # of Python: a if test else b
                nodes = [nodes[k] for k in (1, 0, 2)]
            case "member" if not parts:  # no object, if there is only a name
                nodes = nodes[:-1]
            case "function":
                own = [*(parts or _children(node, "body")), *_children(node, "results")]
                return [*map(self._with_result, own)]
            case "assign" if len(parts) == 1 and node.type == "variable_declarator":  # C#
                nodes = _children(node)[:2]
            case "record":  # the values
                nodes = [_part(pair, "value right") or pair for pair in self._pairs()]
            case "if":
                return [*self._branches()]
            case "switch":
                cases = [each for each in below(nodes) if each.type in TYPES["case"]]
                return [*map(tree_of, cases), Tree(node, own=[])]
        return [*map(tree_of, nodes)]

    def _function(self, nodes: list[Node]) -> Tree:
        """The function of a call: a name, or a member of an object."""
        node = self.node
        # MATLAB: a.b(1). To ask for a parent takes as long as a node is deep.
        outer = node.parent if node.type == "function_call" else None
        if outer is not None and outer.type == "field_expression" and node == _children(outer)[-1]:
            return Tree(outer, "member")
        return Tree(node, "member") if _part(node, "object") else tree_of(nodes[0])  # of Java

    def _with_result(self, node: Node) -> Tree:
        """The body of a function, or its value: the last one in Rust, and the outputs of MATLAB."""
        body = tree_of(node)
        if body.kind != "block":
            return Tree(node, "return", own=[body])
        *others, tail = body.parts or [body]
        is_value = self.is_one_of("valued") and tail.kind != "function" and tail is not body
        if not is_value or patterns.statement.search(tail.node.type):
            return body
        return Tree(node, own=[*others, Tree(tail.node, "return", own=[tail])])

    def _pairs(self) -> list[Node]:
        nodes = _children(_part(self.node, "body") or self.node)
        return nodes[self.node.type == "struct_pattern" :]  # without its type

    def _branches(self) -> Iterator[Tree]:
        """The blocks of which one is run; an empty one for none."""
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
                yield Tree(block, own=own, condition=condition and tree_of(condition))
            if constant or (block != self.node and condition is None):
                return
        yield Tree(self.node, own=[])

    @property
    def constant(self) -> bool | None:
        """The value of a condition, if it is constant."""
        word = self.text.strip("() ").lower()
        return word in ("1", "true") if word in ("0", "1", "false", "true") else None

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
    def around(self) -> Node:
        """The class, namespace or function that contains a function, or the file."""
        node = self.node.parent or self.node
        while node.parent and node.type not in TYPES["around"]:
            node = node.parent
        return node

    @property
    def class_name(self) -> str:
        """The name of the class around a function."""
        return _text(_part(self.around, "name type"))

    @property
    def is_integer(self) -> bool:
        """Whether a call has whole numbers: static_cast<int>(a), a.astype(int), dtype=int."""
        if self.kind != "call":
            return False
        text = self.parts[0].text.partition("<")[2].rstrip("> ")
        end = f"{self.options} {self.text[-30:]}"
        return bool(patterns.integer.fullmatch(text) or patterns.integer_entries.search(end))

    @property
    def entries(self) -> list[Tree]:
        """The entries of a list, and of the lists in it."""
        parts = self.parts if self.kind in ("list", "matrix", "row") else ()
        return [entry for part in parts for entry in part.entries] or [self]

    @property
    def targets(self) -> list[Tree]:
        """The parts of a tuple on the left, or the only one."""
        return self.parts if self.kind in ("list", "record") else [self]

    @cached_property
    def parameters(self) -> list[str]:
        """The names of the parameters of a function."""
        nodes = below(self.node.named_children if self.kind == "function" else [])
        outer = next((n for n in nodes if n.type in TYPES["parameters"]), None)
        outer = _part(self.node, "parameter") or outer
        declarators = _children(outer) or [outer] if outer is not None else []
        return [name for each in declarators for name in _names(each)[:1]]

    def is_one_of(self, types: str) -> bool:
        return self.node.type in TYPES[types]

    def covers(self, other: Tree) -> bool:
        """Whether a block contains another tree."""
        byte, own = other.node.start_byte, [each.node for each in self.parts or [self]]
        return any(each.start_byte <= byte < each.end_byte for each in own)


def _names(node: Node) -> list[str]:
    """The names that a declarator declares, without its type and its value."""
    while part := _part(node, "declarator pattern name"):
        node = part
    return [spelled(_text(n)) for n in below([node]) if _KINDS.get(n.type) == "name"]


def tree_of(node: Node) -> Tree:
    """The common tree of a node, without brackets, casts and the like around it."""
    is_reference = False
    while (kind := _KINDS.get(node.type, "block")) == "wrap":
        is_reference |= node.type in TYPES["reference"]
        if node.type in TYPES["cast"] and patterns.integer.fullmatch(_text(_part(node, "type"))):
            return Tree(node, "cast")  # (int)a is another number
        if node.type == "declaration_expression" and "*" in _text(node):  # f(a * b) of C#
            own = [tree_of(each) for each in below([node]) if each.type == "identifier"]
            return Tree(node.named_children[0], "binary", own=own)
        inner = _part(node, "value declarator") or next(iter(_children(node)[-1:]), None)
        if inner is None:
            return Tree(node)
        node = inner
    if kind == "list" and (pairs := _children(node)) and pairs[0].type in TYPES["pair"]:
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
    nodes = ((each, _KINDS.get(each.type, "block")) for each in below(node.named_children))
    return (Tree(each, kind) for each, kind in nodes if kind in kinds)


def damaged(root: Node) -> Iterator[Tree]:
    """The expressions and assignments that are not read because of syntax errors in them."""
    for node in below(root.named_children) if root.has_error else ():
        if node.is_error:
            while node.parent and _KINDS.get(node.parent.type, "block") not in TYPES["blocks"]:
                node = node.parent
            yield Tree(node)


def declared(statement: Node) -> set[str]:
    """The names that a statement declares for its block alone."""
    if statement.type not in TYPES["local"]:
        return set()
    inner = [each for each in below([statement]) if each.type == "variable_declarator"]
    declarators = [*statement.children_by_field_name("declarator"), *inner] or [statement]
    return {name for each in declarators for name in _names(each)}


@lru_cache(maxsize=256)
def integers(text: str) -> set[str]:
    """Names that a text declares as whole numbers, or as arrays of them."""
    kind = f"(?<!\\w)(?:{patterns.integer.pattern})"  # and no sentence with the word `long`
    after = r"[\s&*]+(?=(\w+\s*[=,;:)[][^;(){}]*))"  # up to the next type
    own = rf"{kind}{after}|(\w+) *: *&?(?:mut )?{kind}(?= *[=,;)])"
    lists = (match[2] or match[1] for match in re.finditer(own, text))
    return {name for each in lists for name in re.findall(r"(?:^|,)[\s&*]*(\w+)", each)}
