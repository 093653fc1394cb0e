"""Syntax trees of programs by tree-sitter, and the names, calls and entries in their text."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from rigidsym.errors import ExpressionError, MissingExtra
from rigidsym.tools.compare.language import SPELLINGS

if TYPE_CHECKING:
    from tree_sitter import Node

GRAMMARS = {
    ".py": "python",
    **dict.fromkeys((".c", ".h"), "cpp"),  # C is read as C++: headers do not tell which it is
    **dict.fromkeys((".cc", ".cpp", ".cxx", ".hh", ".hpp", ".hxx", ".ino", ".inl"), "cpp"),
    **dict.fromkeys((".cu", ".cuh"), "cpp"),  # of CUDA, only the launch of a kernel is no C++
    **dict.fromkeys((".js", ".mjs", ".jsx"), "javascript"),
    **{".m": "matlab", ".ts": "typescript", ".rs": "rust", ".java": "java"},
    ".cs": "c_sharp",
}
_TABLES: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("nodes.toml").read_text(encoding="utf-8")
)
STATEMENTS, EXPRESSIONS = (  # type of a node: the method that gives it its meaning
    {kind: f"_{name}" for name, kinds in _TABLES[title].items() for kind in kinds.split()}
    for title in ("statements", "expressions")
)
PARTS, WORDS = (
    {name: frozenset(words.split()) for name, words in _TABLES[title].items()}
    for title in ("parts", "words")
)
ORDERS = [order for orders in _TABLES["orders"].values() for order in orders]
CALLS = {word: meaning for meaning, words in WORDS.items() for word in words}
_CHUNK = 2_048  # bytes that the parser reads at once
_MOST_STEPS = 50_000  # of the parser: a megabyte without errors takes half as many


@cache
def _parser(grammar: str) -> Any:
    try:
        from tree_sitter import Language, Parser

        module = import_module(f"tree_sitter_{grammar}")
    except ImportError as error:
        raise MissingExtra("reading formulas in Python, C and MATLAB", "compare") from error
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


def below(nodes: Iterable[Node]) -> Iterator[Node]:
    """Nodes and all that they contain, in the order of the text, without recursion."""
    stack = [*nodes][::-1]
    while stack:
        node = stack.pop()
        yield node
        stack += node.named_children[::-1]


def part(node: Node, *fields: str) -> Node | None:
    """The first of some parts that a node has."""
    return next((p for f in fields if (p := node.child_by_field_name(f)) is not None), None)


def text_of(node: Node | None) -> str:
    return node.text.decode(errors="replace") if node is not None and node.text else ""


def line_of(node: Node) -> int:
    return node.start_point[0] + 1


def children(node: Node) -> list[Node]:
    return [c for c in node.named_children if c.type not in PARTS["ignored"]]


def child(node: Node, *kinds: str) -> Node | None:
    return next((c for c in node.named_children if c.type in kinds), None)


def operator(node: Node) -> str:
    own = part(node, "operator")
    return text_of(own or next((c for c in node.children if not c.is_named), None))


def arguments(node: Node) -> list[Node]:
    outer = part(node, "arguments", "value") or child(node, "arguments")
    return children(outer) if outer is not None else []


def targets(left: Node) -> list[Node]:
    """The parts of a tuple on the left, or the only one."""
    return children(left) if left.type in PARTS["tuple"] else [left]


def left_of(node: Node) -> Node | None:
    """The name, entry or tuple that an assignment writes to."""
    left = part(node, "left", "declarator", "name", "pattern", "argument")
    left = left or next(iter(children(node)), None)
    while left and left.type in ("array_declarator", "pointer_declarator", "reference_declarator"):
        left = part(left, "declarator") or next(iter(children(left)), None)
    return left


def function_name(node: Node) -> str:
    name: Node | None
    if node.type in PARTS["unnamed"]:
        name = part(node.parent, "left", "name", "declarator") if node.parent else None
    else:
        name = part(node, "name", "declarator")
        while name is not None and name.type.endswith("declarator"):
            name = part(name, "declarator")
    return text_of(name).rpartition("::")[2]


def parameters(function: Node) -> list[str]:
    """The names of the parameters of a function."""
    outer = part(function, "parameters", "declarator") or child(function, "function_arguments")
    while outer is not None and outer.type.endswith("declarator"):
        outer = part(outer, "parameters", "declarator")
    names = []
    for parameter in children(outer) if outer is not None else ():
        name: Node | None = parameter
        while name is not None and name.type not in PARTS["name"]:
            declarators = (c for c in name.named_children if "declar" in c.type)
            name = (
                part(name, "declarator", "pattern", "name")
                or child(name, *PARTS["name"])
                or next(declarators, None)
            )
        names += [text_of(name)] if name is not None else []
    return names


class Call(NamedTuple):
    """A call: the object of a method, its name, and its arguments."""

    owner: Node | None
    base: str  # the path of the object; "?" for an object that is an expression
    name: str
    arguments: list[Node]
    options: list[Node]  # arguments with keywords

    @property
    def path(self) -> str:
        return f"{self.base}.{self.name}" if self.base else self.name


def call_of(node: Node) -> Call:
    """The parts of a call: np.array(x), Math.sin(x), R.transpose(), new Matrix3(...)."""
    keyword = PARTS["keyword"]
    plain = [each for each in arguments(node) if each.type not in keyword]
    options = [each for each in arguments(node) if each.type in keyword]
    owner = part(node, "object")
    function = part(node, "name") if owner or node.type == "function_call" else None
    function = function or part(node, "function", "constructor", "type")
    if owner is None and function is not None and function.type in PARTS["member"]:
        owner = part(function, "argument", "value", "object", "expression", "scope", "path")
        function = part(function, "attribute", "field", "property", "name")
    name = re.sub(r"<.*>", "", text_of(function)).replace("::", ".")
    if owner is None:
        base, _, name = name.rpartition(".")
    else:
        text = re.sub(r"\s*(?:->|::|[?!]\.)\s*", ".", text_of(owner))
        base = text if re.fullmatch(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", text) else "?"
        name = name.rpartition(".")[2]  # Eigen::Matrix<T, 3, 3>::Zero
    return Call(owner, base, name, plain, options)


_SPELLED = re.compile(  # tf2Sin, arm_cos_f32, FusionArcSin
    r"_?(?:tf2?|bt|b3|mju_|arm_|simd_|safe_?|fast_?|Fusion)?_?(a|arc)?(sin|cos|tan2?|sqrt)(?:_f32|[fFlL])?",
    re.IGNORECASE,
)
_ANGLE_UNITS = re.compile(
    r"\w*?(to)?_?(rad|deg)(?:ian|ree)?s?(?:_?(?:to|2)_?(rad|deg)(?:ian|ree)?s?)?", re.IGNORECASE
)


def function_word(name: str) -> str:
    """The function of numbers that a program calls by this name, or the name itself."""
    if name in SPELLINGS:
        return SPELLINGS[name]
    if match := _SPELLED.fullmatch(name):
        return ("a" if match[1] else "") + match[2].lower()
    match = _ANGLE_UNITS.fullmatch(name)
    if match and (match[1] or match[3] or name in ("radians", "degrees")):
        unit = (match[3] or match[2]).lower()
        return "deg2rad" if unit == "rad" else "rad2deg"
    return name


def short_name(path: str) -> str:
    """One name for a path: sin for np.sin, phi for state.phi, q_w for q.w, r_q0 for r.q0."""
    parts = path.split(".")
    parts = parts[parts[0] in ("self", "this") and len(parts) > 1 :]
    last = SPELLINGS.get(parts[-1], parts[-1])
    is_part = re.fullmatch(r"[A-Za-z]\d?", last) and len(parts) > 1
    return f"{parts[-2]}_{last}" if is_part else last
