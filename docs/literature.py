"""Formulas of the literature: read from `docs/literature/*.toml`, and decided by the prover.

A file is one source. A formula gives the printed expression and ours, as Python with exact numbers,
lists for matrices and entries that count from 1. The quantities of a derivation are names in it.
Whether both are equal is decided by `rigidsym.mechanics.prove.identity`; nothing else makes a
verdict.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import sympy as sp

import rigidsym as rs
from rigidsym.errors import DerivationError
from rigidsym.formula.tree import Words
from rigidsym.mechanics.prove import identity
from rigidsym.models.library import rotation_from
from rigidsym.models.rotation import TIME
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.tools.compare.language import OF_MATRICES

FOLDER = Path(__file__).parent / "literature"
TOPICS = {
    "rotations": "Rotation matrices and their composition",
    "kinematics": "Rates, angular velocity and Jacobians",
    "bodies": "Inertia tensors, energy and equations of motion",
}
SEEN = {
    "original": "compared with the original",
    "copy": "compared with a copy, not with the original",
    "memory": "quoted from memory, not compared with the original",
}


@dataclass(frozen=True, kw_only=True)
class Source:
    """A book, a paper or a program, in one edition."""

    key: str
    title: str
    seen: str  # a key of SEEN
    link: str = ""
    remark: str = ""

    def __post_init__(self) -> None:
        if self.seen not in SEEN:
            raise ValueError(f"{self.key}: seen = {self.seen!r}, expected one of {', '.join(SEEN)}")


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One printed formula, and the derived quantity that it should equal."""

    source: Source
    title: str
    topic: str
    verdict: str  # "correct" or "wrong", as stated; `decide` finds it
    ours: str
    printed: Any  # a text, a column of texts, or rows of texts
    place: str = ""
    rotation: str = ""
    body: str = ""  # a solid, or three principal moments
    potential: str = ""
    symbols: str = ""  # that are no coordinates
    let: Mapping[str, str]
    conditions: tuple[str, ...] = ()  # expressions that are zero
    example: Mapping[str, int] | None = None  # values at which the conditions hold
    repair: Any = None
    right: Mapping[str, str] | None = None  # a definition, if the repair is an equation for it
    term: Any = None  # what is printed less what is right
    about: str = ""


@dataclass(frozen=True)
class Decision:
    """What became of a claim."""

    claim: Claim
    verdict: str
    residual: sp.Matrix | None = None  # printed less ours
    is_repaired: bool = False  # the repair is proved, and differs from what is printed by the term


@cache
def claims() -> tuple[Claim, ...]:
    """Every formula of every file. Raises TypeError for an unknown key."""
    found = []
    for path in sorted(FOLDER.glob("*.toml")):
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        formulas = table.pop("formula")
        source = Source(key=path.stem, **table)
        for entry in formulas:
            entry["conditions"] = tuple(entry.get("conditions", ()))
            found.append(Claim(source=source, **{"let": {}, "verdict": "correct"} | entry))
    return tuple(found)


@cache
def decisions() -> tuple[Decision, ...]:
    return tuple(map(decide, claims()))


def decide(claim: Claim) -> Decision:
    """Prove the printed formula, or show where it fails. Raises ValueError if it is undecided."""
    names = Names(claim)
    ours = names.matrix(claim.ours)
    difference = names.matrix(claim.printed) - ours
    if names.vanishes(difference):
        return Decision(claim, "correct")
    repaired = claim.repair is not None and names.vanishes(names.matrix(claim.repair) - ours)
    if repaired and claim.term is not None:
        repaired = names.vanishes(difference - names.matrix(claim.term))
    return Decision(claim, "wrong", difference, repaired)


class Names:
    """The names of a formula: quantities, coordinates, rates, constants and functions."""

    def __init__(self, claim: Claim) -> None:
        self.claim = claim
        self.values: dict[str, Any] = {}
        self.conditions: list[sp.Expr] = []
        self.example: dict[sp.Expr, sp.Expr] = {}
        if claim.rotation or claim.body:
            self._derive()
        for name in claim.symbols.split():
            self.values.setdefault(name, sp.Symbol(name, real=True))
        for name, given in claim.let.items():
            is_rows = isinstance(given, list)
            self.values[name] = self.matrix(given) if is_rows else value(given, self.values)
        self.conditions += [value(text, self.values) for text in claim.conditions]
        given = (claim.example or {}).items()
        self.example |= {self.values[name]: sp.Integer(number) for name, number in given}

    def _derive(self) -> None:
        claim = self.claim
        moments = sp.symbols(claim.body, positive=True) if " " in claim.body else ()
        body = rs.principal_moments(*moments) if moments else None
        if claim.body and not moments:
            body = rs.solid(claim.body)
        options = {"body": body, "potential": claim.potential or None}
        used = (claim.ours, claim.printed, claim.repair, claim.term, *claim.let.values())
        words = {word for text in _texts(used) for word in _words(text)}
        wanted = sorted(words & _quantities())
        motion = rs.derive(claim.rotation or "ZXZ", wanted, **options)
        self.conditions += motion.model.constraints
        self.example |= dict(motion.model.example)
        found = {name: getattr(motion, name) for name in wanted}
        for coordinate in motion.model.coordinates:
            name = coordinate.func.__name__
            for order, suffix in enumerate(("", "_dot", "_ddot")):
                self.values[name + suffix] = sp.diff(coordinate, TIME, order)
        known = sp.Tuple(*map(sp.sympify, found.values())).free_symbols | {*moments}
        self.values |= {symbol.name: symbol for symbol in known if symbol != TIME}
        self.values |= found

    def matrix(self, given: Any) -> sp.Matrix:
        """A text, a column of texts or rows of texts as a matrix."""
        if isinstance(given, str):
            return sp.Matrix(_matrix(value(given, self.values)))
        rows = [row if isinstance(row, list) else [row] for row in given]
        return sp.Matrix([[value(entry, self.values) for entry in row] for row in rows])

    def vanishes(self, residual: sp.Matrix) -> bool:
        """Raises ValueError if the ring cannot tell."""
        try:
            title, example = self.claim.title, tuple(self.example.items())
            proof = identity(residual, Words("equality"), title, self.conditions, example)
        except DerivationError:
            return False
        if not proof.is_exact:
            raise ValueError(f"{self.claim.title}: undecided; left over: {proof.residual}")
        return True


def value(text: str, names: Mapping[str, Any]) -> Any:
    """The value of an expression: a scalar, or a matrix with more than one entry."""
    tree = ast.fix_missing_locations(_Exact().visit(ast.parse(text.strip(), mode="eval")))
    functions = {**FUNCTIONS, **OF_MATRICES, **_FUNCTIONS, "one": lambda n: sp.eye(int(n))}
    result = eval(compile(tree, text, "eval"), {"__builtins__": {}} | functions | dict(names))
    is_scalar = isinstance(result, sp.MatrixBase) and result.shape == (1, 1)
    return result[0] if is_scalar else result


class _Exact(ast.NodeTransformer):
    """Numbers of SymPy, matrices for lists, and indices from 1."""

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return (
            node
            if isinstance(node.value, str)
            else _applied("number", ast.Constant(str(node.value)))
        )

    def visit_List(self, node: ast.List) -> ast.expr:
        rows = [row.elts if isinstance(row, ast.List) else [row] for row in node.elts]
        cells = [ast.List([self.visit(cell) for cell in row], ast.Load()) for row in rows]
        return _applied("matrix", ast.List(cells, ast.Load()))

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        return _applied("entry", self.visit(node.value), *indices)


def _applied(name: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(ast.Name(name, ast.Load()), [*arguments], [])


def _entry(matrix: sp.MatrixBase, *indices: int) -> sp.Expr:
    return matrix[tuple(index - 1 for index in indices)]


def _texts(given: Any) -> Iterator[str]:
    if isinstance(given, str):
        yield given
    elif given is not None:
        for part in given:
            yield from _texts(part)


def _words(text: str) -> set[str]:
    return {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}


@cache
def _quantities() -> frozenset[str]:
    from rigidsym.motion import QUANTITIES

    return frozenset(QUANTITIES)


def _matrix(given: Any) -> sp.MatrixBase:
    return given if isinstance(given, sp.MatrixBase) else sp.Matrix([[given]])


def _turn(name: str, *coordinates: Any) -> sp.Matrix:
    """R of a rotation by name, at these coordinates."""
    model = rotation_from(name)
    values = [
        entry for part in coordinates for entry in (part if hasattr(part, "shape") else [part])
    ]
    return sp.Matrix(model.matrix).xreplace(dict(zip(model.coordinates, values, strict=True)))


_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "R": _turn,
    "derivative": sp.diff,
    "number": sp.Rational,
    "matrix": sp.Matrix,
    "entry": _entry,
}


# Pages


def wrong_formulas() -> str:
    """Each wrong formula with its error and its repair, in Markdown."""
    return "\n\n".join(_wrong(d) for d in decisions() if d.verdict == "wrong")


def formulas_on(topic: str) -> str:
    return "\n\n".join(_entry(d) for d in decisions() if d.claim.topic == topic)


def rotations_of_literature() -> str:
    return formulas_on("rotations")


def kinematics_of_literature() -> str:
    return formulas_on("kinematics")


def bodies_of_literature() -> str:
    return formulas_on("bodies")


def sources() -> str:
    """A table of the sources: how many formulas, and what they were compared with."""
    lines = ["| source | formulas | wrong | seen |", "| --- | --- | --- | --- |"]
    remarks = []
    for source in dict.fromkeys(claim.source for claim in claims()):
        of_it = [d for d in decisions() if d.claim.source == source]
        wrong = sum(d.verdict == "wrong" for d in of_it)
        title = f"[{source.title}]({source.link})" if source.link else source.title
        lines.append(f"| {title} | {len(of_it)} | {wrong or ''} | {source.seen} |")
        if source.remark:
            remarks.append(f"- {source.title.split(',')[0]}: {source.remark}")
    totals = []
    for seen, words in SEEN.items():
        of_it = [d for d in decisions() if d.claim.source.seen == seen]
        wrong = sum(d.verdict == "wrong" for d in of_it)
        totals.append(f"- {len(of_it)} formulas {words}: {wrong or 'none'} wrong")
    return "\n".join([*totals, "", *lines, "", "Remarks on the sources:", "", *remarks])


def _wrong(decision: Decision) -> str:
    claim = decision.claim
    parts = [_head(claim, 3), claim.about, *_printed(claim), "The right formula is"]
    right = claim.right or {"": claim.repair}
    parts += [_display(f"{_name(k)} = {latex(v)}" if k else latex(v)) for k, v in right.items()]
    if claim.term is not None:
        parts += ["The printed expression exceeds it by", _display(latex(claim.term))]
    return "\n\n".join(parts)


def _entry(decision: Decision) -> str:
    claim = decision.claim
    verdict = "**Correct.**"
    if decision.verdict == "wrong":
        verdict = "**Wrong**, see [the errata](../errata.md)."
    return "\n\n".join([_head(claim, 2), *_printed(claim), f"{verdict} {claim.about}".rstrip()])


def _head(claim: Claim, level: int) -> str:
    source = claim.source.title.split(",")
    author = ", ".join(source[:2]) if len(source) > 1 else source[0]
    place = f", {claim.place}" if claim.place else ""
    return f"{'#' * level} {claim.title}\n\n{author}{place} ({SEEN[claim.source.seen]})."


def _printed(claim: Claim) -> list[str]:
    about = f"For `{claim.rotation}`," if claim.rotation else "Here"
    if claim.body and not claim.rotation:
        about = f"For the solid `{claim.body}`,"
    parts = [about, _display(f"{latex(claim.ours)} = {latex(claim.printed)}")]
    used = {word for text in _texts((claim.ours, claim.printed)) for word in _words(text)}
    for name in reversed(claim.let):  # each may hold those before it
        if name in used:
            used |= {word for text in _texts(claim.let[name]) for word in _words(text)}
    lets = [_display(f"{_name(n)} = {latex(v)}") for n, v in claim.let.items() if n in used]
    return [*parts, *(["with", *lets] if lets else [])]


def _display(text: str) -> str:
    return f"$$\n{text}\n$$"


_NAMES = {
    "rotation_matrix": "R",
    "angular_velocity_space": r"\Omega",
    "angular_velocity_body": r"\Omega'",
    "rate_matrix_space": "W",
    "rate_matrix_body": "W'",
    "inverse_rate_matrix_space": "W^{-1}",
    "inverse_rate_matrix_body": "W'^{-1}",
    "inertia_tensor": "I'",
    "centre_of_mass": "r_C'",
    "rotational_energy": "E_R",
    "lagrangian": "L",
    "generalised_momenta": "p",
    "bias_vector": "h",
    "phi": r"\varphi",
}
_GREEK = {"theta", "psi", "alpha", "beta", "gamma", "pi"}


def latex(given: Any) -> str:
    """An expression of the files as LaTeX."""
    if isinstance(given, list):
        rows = [row if isinstance(row, list) else [row] for row in given]
        return _array([[latex(entry) for entry in row] for row in rows])
    return _latex(ast.parse(given.strip(), mode="eval").body, 0)


def _latex(node: ast.expr, least: int) -> str:
    """In brackets if the node binds less than `least`: 1 a term, 2 a factor, 3 a base."""
    match node:
        case ast.Constant(value=number):
            return str(number)
        case ast.Name(id=name):
            return _name(name)
        case ast.UnaryOp(operand=operand):
            return _bracket(f"-{_latex(operand, 2)}", least > 1)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            sign, below = ("+", 0) if isinstance(op, ast.Add) else ("-", 1)
            return _bracket(f"{_latex(left, 0)} {sign} {_latex(right, below)}", least > 0)
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return _bracket(f"{_latex(left, 1)}\\,{_latex(right, 2)}", least > 2)
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            text = rf"\frac{{{_latex(left, 0)}}}{{{_latex(right, 0)}}}"
            return _bracket(text, least > 2)
        case ast.BinOp(left=ast.Call(func=ast.Name(id="sin" | "cos" as f), args=[inner]), right=p):
            return rf"\{f}^{{{_latex(p, 0)}}} {_latex(inner, 3)}"
        case ast.BinOp(left=left, right=right):
            return f"{_latex(left, 3)}^{{{_latex(right, 0)}}}"
        case ast.Subscript(value=inner, slice=ast.Tuple(elts=elements)):
            return f"{_latex(inner, 3)}_{{{''.join(_latex(e, 0) for e in elements)}}}"
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, arguments, least)
    raise ValueError(ast.unparse(node))


def _call(name: str, arguments: list[ast.expr], least: int) -> str:
    shown = [_latex(argument, 0) for argument in arguments]
    match name, arguments:
        case "sin" | "cos" | "tan", [inner]:
            return _bracket(rf"\{name} {_latex(inner, 2)}", least > 2)
        case "sqrt", _:
            return rf"\sqrt{{{shown[0]}}}"
        case "T", [inner]:
            return rf"{_latex(inner, 3)}^{{\mathsf T}}"
        case "one", _:
            return "1"
        case "dot" | "cross", [a, b]:
            sign = r"\cdot" if name == "dot" else r"\times"
            return _bracket(rf"{_latex(a, 2)} {sign} {_latex(b, 2)}", least > 0)
        case "outer", [a, b]:
            return rf"{_latex(a, 3)}\,{_latex(b, 3)}^{{\mathsf T}}"
        case "col" | "stack", _:
            return _array([[entry] for entry in shown])
        case "derivative", [a, b]:
            return rf"\frac{{\partial}}{{\partial {shown[1]}}} {_latex(a, 3)}"
        case "trace", _:
            return rf"\operatorname{{tr}}({shown[0]})"
        case "R", _:
            return f"R({', '.join(shown[1:])})"
        case "diag", _:
            return rf"\operatorname{{diag}}\left({', '.join(shown)}\right)"
    return f"{name}({', '.join(shown)})"


def _name(name: str) -> str:
    if name in _NAMES:
        return _NAMES[name]
    if name.endswith("_dot"):
        return rf"\dot{{{_name(name[:-4])}}}"
    letters = name.rstrip("0123456789")
    if letters != name:
        return f"{_name(letters)}_{{{name[len(letters) :]}}}"
    if name in _GREEK:
        return f"\\{name}"
    return f"{name[0]}_{{{name[1:]}}}" if len(name) > 1 else name


def _bracket(text: str, is_needed: bool) -> str:
    return rf"\left({text}\right)" if is_needed else text


def _array(rows: list[list[str]]) -> str:
    body = r" \\ ".join(" & ".join(row) for row in rows)
    return rf"\begin{{pmatrix}} {body} \end{{pmatrix}}"
