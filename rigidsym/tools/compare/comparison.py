"""Is this formula right? The entry to this folder."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError, DerivationError, ExpressionError, ModelError
from rigidsym.motion import Motion
from rigidsym.tools.compare.language import read_formula, spelled_out
from rigidsym.tools.compare.plain import plain
from rigidsym.tools.compare.repair import (
    Meaning,
    Repair,
    entry_repairs,
    renamings,
    twofold_repairs,
    whole_repairs,
)
from rigidsym.tools.compare.targets import KnownQuantity, Names, catalogue, readings, target

_MOST_REPAIRS = 2  # of a formula that nobody has named
_NEAR = 0.6  # share of entries that must be right for a formula to be close to another


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """What a formula is, and what makes it right."""

    formula: sp.ImmutableMatrix
    asked: KnownQuantity | None  # what it should be
    found: KnownQuantity | None = None  # what it is after the repairs
    names: Names | None = None
    repairs: tuple[Repair, ...] = ()
    arrangement: str = ""  # "transposed", "scalar last", "twice": what it is of what was found
    as_it_stands: KnownQuantity | None = None  # what it is before a repair of its entries
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
            "arrangement": self.arrangement,
            "as_it_stands": str(self.as_it_stands) if self.as_it_stands else None,
            "names": self._called(),
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
        what = f"{self.found}{self._in_names()}"
        if self.arrangement:
            what += f", {self.arrangement}"
        if not self.repairs:
            return f"equal to {what} ({proof})"
        changes = "; ".join(repair.words for repair in self.repairs)
        if self.asked is None:
            return f"close to {what}: {changes} (with this, {proof})"
        if self.as_it_stands:
            changes += f"; as it stands this is {self.as_it_stands}"
        is_changed = self.asked.quantity == self.found.quantity
        is_changed &= self.asked.rotation == self.found.rotation
        proof = f"with this, {proof}" if is_changed else proof
        return f"not {self.asked}: {changes}{'' if is_changed else self._in_names()} ({proof})"

    def _in_names(self) -> str:
        """The coordinates as the user calls them, in the order of the rotation."""
        called = self._called()
        own = self.found.coordinates if self.found else {}
        names = [called.get(name, name) for name in own]
        return f" in ({', '.join(names)})" if names != list(own) else ""

    def _called(self) -> dict[str, str]:
        """Names of the user by those of the quantity that was found."""
        symbols = {meant: str(name) for name, meant in (self.names or {}).items()}
        known = self.found.names if self.found else {}
        return {name: symbols[symbol] for name, symbol in known.items() if symbol in symbols}


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
    goal = _goal(rotation, quantity)
    found = against(matrix, goal)
    return found if found.found or not isinstance(formula, str) else _in_text(found, plain(formula))


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        return read_formula(plain(formula))
    if isinstance(formula, sp.MatrixBase):
        return _in_symbols(formula)
    rows = [row if isinstance(row, list | tuple) else [row] for row in formula]
    return sp.ImmutableMatrix([[as_matrix(entry)[0] for entry in row] for row in rows])


def _in_symbols(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The matrix with symbols for functions of time and their rates, and exact numbers."""
    plain: dict[sp.Expr, sp.Expr] = {f: sp.Rational(str(f)) for f in matrix.atoms(sp.Float)}
    for function in matrix.atoms(sp.Derivative, AppliedUndef):
        order = function.derivative_count if isinstance(function, sp.Derivative) else 0
        name = function.expr.func.__name__ if order else function.func.__name__
        suffix = f"_{'d' * order}ot" if order else ""
        plain[function] = sp.Symbol(name + suffix, real=True)
    return sp.ImmutableMatrix(matrix.xreplace(plain))


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
    found = next(_likely(meant, goal), None)
    if found and not any(repair.place for repair in found[1]):
        return _made(*found, goal)
    other = identified(formula, only_equal=True)
    if found:
        return replace(_made(*found, goal), as_it_stands=other.found)
    if other.found:
        words = f"this is {other.found}"
        repair = Repair(kind="convention", words=words, formula=formula, goal=other.found)
        return replace(other, asked=goal, repairs=(repair, *other.repairs))
    if found := next(((m, (r,)) for m in meant for r in twofold_repairs(m)), None):
        return _made(*found, goal)
    return Comparison(formula=formula, asked=goal)


def _likely(
    meant: Sequence[Meaning], goal: KnownQuantity
) -> Iterator[tuple[Meaning, tuple[Repair, ...]]]:
    """Readings with the repairs that make them right, the smallest first."""
    yield from ((m, ()) for m in meant if m.agrees(m.formula, goal))
    yield from ((m, (r,)) for m in meant for r in whole_repairs(m))
    nearest = max(meant, key=_count_right, default=None)
    entries = entry_repairs(nearest) if nearest else ()
    if nearest and len(entries) == 1 and entries[0].kind != "entry":
        yield nearest, entries
    yield from ((m, (r,)) for m in meant for r in renamings(m))
    if nearest and entries:
        yield nearest, entries


def identified(
    formula: sp.ImmutableMatrix, *, only_equal: bool = False, also: Sequence[KnownQuantity] = ()
) -> Comparison:
    """Compare with all quantities of the catalogue, and `also`; the nearest if none is equal."""
    near: list[tuple[float, str, Meaning]] = []
    for goal in (*catalogue(formula), *also):
        for arrangement, arranged in _arranged(formula, goal):
            for names in readings(arranged, goal):
                reading = Meaning.of(arranged, goal, names)
                right = reading.right
                if right.all():
                    return replace(_made(reading, (), None), arrangement=arrangement)
                near.append((float(right.mean()), arrangement, reading))
    near.sort(key=lambda each: -each[0])
    for share, arrangement, reading in near[:8] if not only_equal else ():
        repairs = entry_repairs(reading) if share >= _NEAR else ()
        if 0 < len(repairs) <= _MOST_REPAIRS and all(r.kind != "entry" for r in repairs):
            found = _made(reading, repairs, None)
            return replace(found, arrangement=arrangement)
    return Comparison(formula=formula, asked=None)


def _arranged(
    formula: sp.ImmutableMatrix, goal: KnownQuantity
) -> Iterator[tuple[str, sp.ImmutableMatrix]]:
    """(what the formula is of the quantity, the formula as the quantity is written)."""
    if formula.shape != goal.matrix.shape:
        return
    yield "", formula
    if goal.quantity == "rotation_matrix":
        yield "transposed (passive, the direction cosine matrix)", formula.T
    if formula.rows == 4:
        last = [3, 0, 1, 2]
        moved = formula[last, last] if formula.cols == 4 else formula[last, :]
        for words, each in (("", formula), ("scalar last", moved)):
            yield from ((words, each),) if words else ()
            yield ", ".join(filter(None, (words, "twice"))), each / 2


_SIGNS = {"+": "-", "-": "+", "sin": "cos", "cos": "sin", "**2": ""}


def _in_text(unknown: Comparison, text: str) -> Comparison:
    """The comparison after one change in the text, such as a sign between matrices."""
    goal = unknown.asked
    assert goal is not None
    for match in re.finditer(r"[+-]|\b(?:sin|cos)\b|\*\*2\b", text):
        changed = text[: match.start()] + _SIGNS[match[0]] + text[match.end() :]
        formula = spelled_out(read_formula(changed))
        for names in readings(formula, goal):
            reading = Meaning.of(formula, goal, names)
            if reading.agrees(formula, goal):
                before = text[max(0, match.start() - 15) : match.end() + 15]
                after = changed[max(0, match.start() - 15) : match.end() + 15]
                words = f"...{before}... should be ...{after}..."
                kind = {"s": "sine and cosine", "c": "sine and cosine", "*": "square"}
                change = Repair(
                    kind=kind.get(match[0][0], "sign"), words=words, formula=formula, goal=goal
                )
                return replace(_made(reading, (change,), goal), formula=unknown.formula)
    return unknown


def _count_right(reading: Meaning) -> int:
    same = reading.formula.shape == reading.goal.matrix.shape
    return int(reading.right.sum()) if same else 0


def _made(reading: Meaning, repairs: Sequence[Repair], asked: KnownQuantity | None) -> Comparison:
    """The comparison, with the proof that the repaired formula is what was found."""
    found = repairs[0].goal if repairs else reading.goal
    changed = _together(reading.formula, repairs)
    ours, theirs = map(found.applied, (found.matrix, changed.xreplace(dict(reading.names))))
    try:
        is_proved = found.motion.equality(theirs, ours).is_exact
    except DerivationError:  # it is false, although the numbers agree
        return Comparison(formula=reading.formula, asked=asked)
    except (AlgebraError, ModelError):  # the ring cannot hold it
        is_proved = False
    return Comparison(
        formula=reading.formula,
        asked=asked,
        found=found,
        names=reading.names,
        repairs=tuple(repairs),
        is_proved=is_proved,
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
        result = sp.Matrix(_matrix(function(*inputs)))
    except (TypeError, AttributeError):  # NumPy's sin takes no symbols
        return _by_numbers(function, goal, symbols)
    return against(_in_symbols(result), goal)


def _by_numbers(
    function: Callable[..., Any], goal: KnownQuantity, symbols: Sequence[np.ndarray[Any, Any]]
) -> Comparison:
    """Its values in the place of its entries, which have no parts that could be changed."""
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
    _, repairs = next(_likely([reading], goal), (reading, None))
    if repairs is None:
        return Comparison(formula=formula, asked=goal)
    found = repairs[0].goal if repairs else goal
    return Comparison(formula=formula, asked=goal, found=found, repairs=repairs)


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


def checked(
    rotation: str | Motion, quantity: str
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compare a function with a quantity of a rotation whenever it is called without arguments.

        @rigidsym.checked("ZYX", "rate_matrix_body")
        def test_rate_matrix(q): ...

    pytest calls tests without arguments; with arguments the function computes as before. A
    function that takes SymPy symbols is proved, another one is compared at random points.
    The comparison raises AssertionError, which says what is wrong.
    """

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        def test(*arguments: Any, **options: Any) -> Any:
            if arguments or options:
                return function(*arguments, **options)
            found = compare(function, rotation, quantity)
            if not found.is_equal:
                raise AssertionError(f"{function.__name__} is {found.text()}")
            return None

        test.__name__, test.__doc__ = function.__name__, function.__doc__
        test.__module__, test.__qualname__ = function.__module__, function.__qualname__
        return test

    return decorate
