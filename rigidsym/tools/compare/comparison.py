"""Is this formula right? The entry to this folder."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from rigidsym.errors import ExpressionError
from rigidsym.motion import Motion
from rigidsym.tools.compare.language import read_formula, spelled_out
from rigidsym.tools.compare.plain import plain
from rigidsym.tools.compare.repair import (
    OF_NAMES,
    Meaning,
    Repair,
    entry_repairs,
    whole_repairs,
)
from rigidsym.tools.compare.targets import KnownQuantity, Names, catalogue, readings, target

_NEAR = 0.6  # share of entries that must be right for a formula to be close to another


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """What a formula is, and what makes it right."""

    formula: sp.ImmutableMatrix
    asked: KnownQuantity | None  # what it should be
    found: KnownQuantity | None = None  # what it is after the repairs
    names: Names | None = None
    repairs: tuple[Repair, ...] = ()
    is_proved: bool = False  # that the repaired formula is what was found

    @property
    def is_equal(self) -> bool:
        """Whether the formula is right as it stands."""
        return self.found is not None and not self.repairs

    def record(self) -> dict[str, Any]:
        """For JSON."""
        found = self.found
        return {
            "equal": self.is_equal,
            "proved": self.is_proved,
            "rotation": found.rotation if found else None,
            "quantity": found.quantity if found else None,
            "names": {str(a): _plain(found, b) for a, b in self._renamed()} if found else {},
            "repairs": [
                {
                    "kind": repair.kind,
                    "words": repair.words,
                    "entry": list(repair.place) if repair.place else None,
                    "before": None if repair.before is None else str(repair.before),
                    "after": None if repair.after is None else str(repair.after),
                }
                for repair in self.repairs
            ],
        }

    def text(self) -> str:
        """The findings in sentences."""
        proof = "proved" if self.is_proved else "equal to nine digits at random points"
        if self.found is None:
            head = f"not {self.asked}" if self.asked else "not a known quantity"
            return f"{head}, and no single change makes it one"
        if not self.repairs:
            return f"equal to {self.found}{self._in_names()} ({proof})"
        changes = "; ".join(repair.words for repair in self.repairs)
        if self.asked is None:
            return f"close to {self.found}{self._in_names()}: {changes} (with this, {proof})"
        is_changed = self.asked.quantity == self.found.quantity
        is_changed &= self.asked.rotation == self.found.rotation
        proof = f"with this, {proof}" if is_changed else proof
        return f"not {self.asked}: {changes}{'' if is_changed else self._in_names()} ({proof})"

    def _in_names(self) -> str:
        pairs = [f"{a} for {_plain(self.found, b)}" for a, b in self._renamed()]
        return f" with {', '.join(pairs)}" if pairs else ""

    def _renamed(self) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
        if self.found:
            order = {meant: place for place, meant in enumerate(self.found.names.values())}
            pairs = sorted((self.names or {}).items(), key=lambda p: order.get(p[1], 0))
            yield from ((a, b) for a, b in pairs if _plain(self.found, b) != str(a))


def _plain(found: KnownQuantity | None, meant: sp.Expr) -> str:
    names = {symbol: name for name, symbol in found.names.items()} if found else {}
    return names.get(meant, str(meant))


def compare(
    formula: str | sp.MatrixBase | Sequence[Any] | Callable[..., Any],
    rotation: str | Motion | None = None,
    quantity: str | None = None,
) -> Comparison:
    """Compare a formula with a quantity of a rotation, or with all known quantities.

    `formula` is a text in Python, SymPy, C, MATLAB or LaTeX, a matrix, rows of texts, or a Python
    function of the coordinates (and rates), which is called with numbers. Without `rotation` the
    conventions of the catalogue are tried. Raises ExpressionError for a text that is no formula.
    """
    if callable(formula):
        return _of_function(formula, _goal(rotation, quantity))
    matrix = spelled_out(as_matrix(formula))
    if rotation is None:
        return identified(matrix)
    return against(matrix, _goal(rotation, quantity))


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        return read_formula(plain(formula))
    if isinstance(formula, sp.MatrixBase | sp.Expr):
        return sp.ImmutableMatrix(formula if isinstance(formula, sp.MatrixBase) else [[formula]])
    rows = [row if isinstance(row, list | tuple) else [row] for row in formula]
    return sp.ImmutableMatrix([[as_matrix(entry)[0] for entry in row] for row in rows])


def _goal(rotation: str | Motion | None, quantity: str | None) -> KnownQuantity:
    if rotation is None or quantity is None:
        raise ExpressionError(
            "expected a rotation and a quantity, such as 'ZYX', 'rotation_matrix'"
        )
    if isinstance(rotation, Motion):
        return KnownQuantity(motion=rotation, rotation=rotation.name, quantity=quantity)
    return target(rotation, quantity)


def against(formula: sp.ImmutableMatrix, goal: KnownQuantity) -> Comparison:
    """Compare with one quantity."""
    meant = [Meaning.of(formula, goal, names) for names in readings(formula, goal)]
    for reading in meant:
        if reading.agrees(formula, goal):
            return _made(reading, goal, (), goal)
    nearest = max(meant, key=_count_right, default=None)
    repairs = entry_repairs(nearest) if nearest else ()
    is_small = len(repairs) == 1 and repairs[0].kind != "entry"
    for reading in meant:
        repair = next(whole_repairs(reading), None)
        if repair and not (is_small and repair.kind in OF_NAMES):
            return _made(reading, repair.goal, (repair,), goal)
    if nearest and repairs:
        return _made(nearest, goal, repairs, goal)
    other = identified(formula, only_equal=True)
    if other.found:
        words = f"this is {other.found}"
        repair = Repair(kind="convention", words=words, formula=formula, goal=other.found)
        return Comparison(
            formula=formula,
            asked=goal,
            found=other.found,
            names=other.names,
            repairs=(repair, *other.repairs),
            is_proved=other.is_proved,
        )
    for reading in meant:
        if repair := next(whole_repairs(reading, twofold=True), None):
            return _made(reading, repair.goal, (repair,), goal)
    return Comparison(formula=formula, asked=goal)


def identified(formula: sp.ImmutableMatrix, *, only_equal: bool = False) -> Comparison:
    """Compare with all quantities of the catalogue; the nearest if none is equal."""
    near: list[tuple[float, Meaning]] = []
    for goal in catalogue(formula):
        for names in readings(formula, goal):
            reading = Meaning.of(formula, goal, names)
            right = reading.right
            if right.all():
                return _made(reading, goal, (), None)
            if goal.quantity == "rotation_matrix" and reading.agrees(formula.T, goal):
                words = "this is the direction cosine matrix Rᵀ (passive)"
                passive = Repair(kind="passive", words=words, formula=formula.T, goal=goal)
                return _made(reading, goal, (passive,), None)
            near.append((float(right.mean()), reading))
    near.sort(key=lambda pair: -pair[0])
    for share, reading in near[:8] if not only_equal else ():
        repairs = entry_repairs(reading) if share >= _NEAR else ()
        if repairs and all(repair.kind != "entry" for repair in repairs):
            return _made(reading, reading.goal, repairs, None)
    return Comparison(formula=formula, asked=None)


def _count_right(reading: Meaning) -> int:
    same = reading.formula.shape == reading.goal.matrix.shape
    return int(reading.right.sum()) if same else 0


def _made(
    reading: Meaning,
    found: KnownQuantity,
    repairs: Sequence[Repair],
    asked: KnownQuantity | None,
) -> Comparison:
    """The comparison, with the proof that the repaired formula is what was found."""
    changed = _together(reading.formula, repairs)
    proof = found.motion.equality(changed.xreplace(dict(reading.names)), found.matrix)
    return Comparison(
        formula=reading.formula,
        asked=asked,
        found=found,
        names=reading.names,
        repairs=tuple(repairs),
        is_proved=proof.is_exact,
    )


def _together(formula: sp.ImmutableMatrix, repairs: Iterable[Repair]) -> sp.ImmutableMatrix:
    """The formula after all repairs: of one, or of one entry each."""
    changed = formula.as_mutable()
    for repair in repairs:
        if repair.after is None or repair.place is None:
            return repair.formula
        changed[repair.place[0] - 1, repair.place[1] - 1] = repair.after
    return sp.ImmutableMatrix(changed)


# Functions


def _of_function(function: Callable[..., Any], goal: KnownQuantity) -> Comparison:
    """Compare a Python function: its expression if it takes symbols, else its numbers."""
    arguments = [
        goal.motion.argument(name) for name in goal.motion.step(goal.quantity).quantity.inputs
    ]
    symbols = [np.array(argument.symbols, object) for argument in arguments]
    inputs = _spread(function, symbols)
    try:
        result = sp.ImmutableMatrix(_matrix(function(*inputs)))
    except (TypeError, AttributeError):  # NumPy's sin takes no symbols
        return _by_numbers(function, goal, symbols)
    names = {sp.Symbol(name, real=True): meant for name, meant in goal.names.items()}
    back = {meant: symbol for symbol, meant in names.items()}
    return against(result.xreplace(back), goal)


def _by_numbers(
    function: Callable[..., Any], goal: KnownQuantity, symbols: Sequence[np.ndarray[Any, Any]]
) -> Comparison:
    """Its values in the place of its entries: what can be changed is the whole."""
    count = len(next(iter(goal.points.values())))
    rows = []
    for point in range(count):
        vectors = [np.array([goal.points[s][point] for s in vector]) for vector in symbols]
        rows.append(np.array(_matrix(function(*_spread(function, vectors))), float))
    table = np.stack(rows)
    entries = [
        [sp.Dummy(f"entry_{i + 1}{j + 1}") for j in range(table.shape[2])]
        for i in range(table.shape[1])
    ]
    formula = sp.ImmutableMatrix(entries)
    values = {s: table[:, i, j] for i, row in enumerate(entries) for j, s in enumerate(row)}
    reading = Meaning(formula=formula, goal=goal, names={}, values=values)
    if reading.agrees(formula, goal):
        return Comparison(formula=formula, asked=goal, found=goal)
    repair = next(whole_repairs(reading), None)
    return Comparison(
        formula=formula,
        asked=goal,
        found=repair.goal if repair else None,
        repairs=(repair,) if repair else (),
    )


def _spread(function: Callable[..., Any], vectors: Sequence[Any]) -> list[Any]:
    """The vectors, or their components if the function takes as many arguments.

    Raises ExpressionError for a function that takes neither.
    """
    count = len(inspect.signature(function).parameters)
    components = [part for vector in vectors for part in vector]
    if count not in (len(vectors), len(components)):
        raise ExpressionError(
            f"the function takes {count} arguments; expected {len(vectors)} vectors or "
            f"{len(components)} numbers"
        )
    return list(vectors) if count == len(vectors) else components


def _matrix(value: Any) -> Any:
    """What a function returned, with two axes."""
    if isinstance(value, sp.MatrixBase):
        return value
    array = np.asarray(value)
    return array.reshape(-1, 1) if array.ndim < 2 else array
