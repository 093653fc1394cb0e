"""Small changes that make a wrong formula right: of all of it, or of single entries."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.motion import QUANTITIES
from rigidsym.tools.compare.targets import (
    Array,
    KnownQuantity,
    Names,
    Values,
    agreement,
    evaluated,
    target,
)

_MOST_OPERATIONS = 200  # of an entry in which each part is changed
_MOST_ENTRIES = 3  # that may be wrong, each by one change
_HALF, _TWO = sp.Rational(1, 2), sp.Integer(2)


@dataclass(frozen=True, kw_only=True, slots=True)
class Repair:
    """One change that makes a formula right."""

    kind: str  # "sign", "square", "transpose", ...
    words: str  # a sentence
    formula: sp.ImmutableMatrix  # the formula after it, in the user's names
    goal: KnownQuantity  # what that equals
    place: tuple[int, int] | None = None  # of the entry, counted from 1
    before: sp.Expr | None = None
    after: sp.Expr | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Meaning:
    """A formula under one reading of its names, with numbers."""

    formula: sp.ImmutableMatrix
    goal: KnownQuantity
    names: Names
    values: Values  # of the names, and of all that was evaluated before

    @classmethod
    def of(cls, formula: sp.ImmutableMatrix, goal: KnownQuantity, names: Names) -> Meaning:
        meant = sp.Matrix([[*names.values()]])
        numbers = evaluated(meant, dict(goal.points))[:, 0].T if names else ()
        values = dict(zip(names, numbers, strict=True))
        return cls(formula=formula, goal=goal, names=names, values=values)

    def numbers(self, matrix: sp.MatrixBase) -> Array:
        return evaluated(matrix, self.values)

    def agrees(self, matrix: sp.MatrixBase, goal: KnownQuantity) -> bool:
        return matrix.shape == goal.matrix.shape and bool(
            agreement(self.numbers(matrix), goal.values).all()
        )

    @property
    def right(self) -> NDArray[np.bool_]:
        """Which entries are right."""
        return agreement(self.numbers(self.formula), self.goal.values)

    @property
    def is_whole(self) -> bool:
        """Whether a transpose, a sign or a factor of all entries makes them right."""
        numbers, wanted = self.numbers(self.formula), self.goal.values
        changed = (numbers.transpose(0, 2, 1), -numbers, 2 * numbers, numbers / 2)
        return any(
            each.shape == wanted.shape and bool(agreement(each, wanted).all()) for each in changed
        )


Change = tuple[str, str, sp.ImmutableMatrix]  # kind, words, the formula after it


def whole_repairs(reading: Meaning) -> Iterator[Repair]:
    """A change of all entries together, or another quantity of the rotation, that fits."""
    yield from _fitting(reading, _changes(reading), [("", reading.goal)])
    yield from _fitting(reading, [("", "", reading.formula)], _relatives(reading.goal))


def _fitting(
    reading: Meaning, changes: Iterable[Change], goals: Iterable[tuple[str, KnownQuantity]]
) -> Iterator[Repair]:
    for (kind, words, changed), (relation, goal) in product(changes, goals):
        if reading.agrees(changed, goal):
            if relation:
                words = f"this is {goal}" + (f", but {words}" if words else "")
            kind = ", ".join(filter(None, (kind, relation)))
            yield Repair(kind=kind, words=words, formula=changed, goal=goal)


def _relatives(goal: KnownQuantity) -> Iterator[tuple[str, KnownQuantity]]:
    """(kind, target): the quantity in the other frame, inverted, and with the turns reversed."""
    name = goal.quantity
    swap = {"_body": "_space", "_space": "_body"}
    frame = next((name.replace(one, two) for one, two in swap.items() if one in name), "")
    related = [("frame", frame)] if frame else []
    if "rate_matrix" in name and goal.matrix.shape == (3, 3):
        for each in (name, frame):
            bare = each.removeprefix("inverse_")
            related.append(("inverse", bare if bare != each else f"inverse_{each}"))
    for kind, quantity in related:
        if quantity in QUANTITIES:
            yield kind, goal.sibling(quantity)
    if goal.rotation.isalpha() and len(goal.rotation) == 3 and goal.motion.body is None:
        yield "order of the turns", target(goal.rotation.swapcase(), name)


def _changes(reading: Meaning) -> Iterator[Change]:
    formula = reading.formula
    passive = " (passive)" if reading.goal.quantity == "rotation_matrix" else ""
    yield "transpose", f"the formula is the transpose{passive}", formula.T
    yield "sign", "all signs are the other way round", -formula
    for factor in (_TWO, _HALF):
        yield "factor", f"a factor {factor} is missing", factor * formula


# Single entries


def entry_repairs(reading: Meaning) -> tuple[Repair, ...]:
    """One change in each wrong entry; () if there are none, or too many."""
    if reading.formula.shape != reading.goal.matrix.shape:
        return ()
    wrong = [(int(i), int(j)) for i, j in np.argwhere(~reading.right)]
    if len(wrong) == 2 and (exchanged := _exchanged(reading, *wrong)):
        return (exchanged,)
    if not 0 < len(wrong) <= min(_MOST_ENTRIES, max(1, len(reading.formula) // 3)):
        return ()
    return tuple(_entry(reading, place) for place in wrong)


def _exchanged(reading: Meaning, one: tuple[int, int], two: tuple[int, int]) -> Repair | None:
    changed = reading.formula.as_mutable()
    changed[one], changed[two] = changed[two], changed[one]
    if not reading.agrees(changed, reading.goal):
        return None
    words = f"entries {_from1(one)} and {_from1(two)} are exchanged"
    fixed = sp.ImmutableMatrix(changed)
    return Repair(kind="exchange", words=words, formula=fixed, goal=reading.goal, place=_from1(one))


def _from1(place: tuple[int, int]) -> tuple[int, int]:
    """A place counted from 1, as people do."""
    return place[0] + 1, place[1] + 1


def _entry(reading: Meaning, place: tuple[int, int]) -> Repair:
    """The smallest change of an entry; the entry of the target if no small one is enough."""
    formula, goal, before = reading.formula, reading.goal, reading.formula[place]
    wanted = goal.values[:, [place[0]], [place[1]]][:, None]
    groups = [  # names that may be taken for one another: those of one argument
        [symbol for symbol, meant in reading.names.items() if meant in symbols]
        for symbols in goal.inputs.values()
    ]
    changes = variants(before, groups) if before.count_ops() <= _MOST_OPERATIONS else ()
    back = {meant: symbol for symbol, meant in reading.names.items()}
    kind, after = "entry", goal.matrix[place].xreplace(back)
    for variant in sorted(
        set(changes), key=lambda v: (KINDS.index(v[0]), v[1].count_ops(), str(v[1]))
    ):
        if agreement(reading.numbers(sp.Matrix([[variant[1]]])), wanted).all():
            kind, after = variant
            break
    changed = formula.as_mutable()
    changed[place] = after
    words = f"entry {_from1(place)}: {before} should be {after}"
    if kind != "entry":
        words += f" ({_WORDS[kind]})"
    return Repair(
        kind=kind,
        words=words,
        formula=sp.ImmutableMatrix(changed),
        goal=reading.goal,
        place=_from1(place),
        before=before,
        after=after,
    )


_WORDS = {
    "sign": "a sign",
    "sine and cosine": "sine and cosine exchanged",
    "index": "another name",
    "square": "a square",
    "factor": "a number as factor",
    "half angle": "half or twice the angle",
    "product": "a factor missing or too many",
    "term": "a term too many",
}
KINDS = list(_WORDS)  # the likeliest first


_SWAPPED = {sp.sin: sp.cos, sp.cos: sp.sin}


def variants(
    expression: sp.Expr, groups: Sequence[Sequence[sp.Symbol]], *, inside: bool = False
) -> Iterator[tuple[str, sp.Expr]]:
    """(kind, changed expression) for each single change."""
    yield from _here(expression, groups, inside=inside)
    is_function = expression.is_Function
    for place, part in enumerate(expression.args):
        if expression.is_Pow and place == 1:
            continue
        for kind, changed in variants(part, groups, inside=inside or is_function):
            parts = [*expression.args[:place], changed, *expression.args[place + 1 :]]
            yield kind, expression.func(*parts)


def _here(
    expression: sp.Expr, groups: Sequence[Sequence[sp.Symbol]], *, inside: bool
) -> Iterator[tuple[str, sp.Expr]]:
    yield "sign", -expression
    numbers = "half angle" if inside else "factor"
    yield from ((numbers, factor * expression) for factor in (_HALF, _TWO))
    if expression.is_Symbol:
        group = next((g for g in groups if expression in g), ())
        yield from (("index", other) for other in group if other != expression)
    if expression.func in _SWAPPED:
        yield "sine and cosine", _SWAPPED[expression.func](*expression.args)
    if expression.is_Mul:
        if expression.args[0].is_even:  # two equal terms that have become one
            half = expression / 2
            for kind, changed in variants(half, groups, inside=inside):
                yield from [("index", half + changed)] if kind == "index" else []
        for factor in expression.args:
            yield numbers if factor.is_number else "product", expression / factor
    if expression.is_Add:
        yield from (("term", expression - term) for term in expression.args)
    if expression.is_Pow and expression.exp == 2:
        yield "square", expression.base
        for kind, changed in variants(expression.base, groups, inside=inside):
            yield kind, expression.base * changed
    if inside:
        return
    if expression.is_Function or expression.is_Symbol:
        yield "square", expression**2
    if not expression.is_Add:
        yield from (("product", expression * f(s)) for s in chain(*groups[:1]) for f in _SWAPPED)
