"""What a formula is: matched with one quantity or with all, and the repairs that make it so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import chain, islice, product
from typing import Any

import sympy as sp

from rigidsym.errors import AlgebraError, DerivationError, ModelError
from rigidsym.system.resources import environment
from rigidsym.tools.compare.laws import laws
from rigidsym.tools.compare.repair import (
    Meaning,
    Repair,
    entry_repairs,
    whole_repairs,
)
from rigidsym.tools.compare.targets import (
    NEAR_POINTS,
    POINTS,
    QUATERNION,
    KnownQuantity,
    Names,
    agreeing_points,
    catalogue,
    is_reflection,
)

_MOST_REPAIRS = 2  # of a formula that nobody has named
_NEAR = 0.6  # share of entries that must be right for a formula to be close to another


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The quantity that a formula is, or the repairs that make it right."""

    formula: sp.ImmutableMatrix
    asked: KnownQuantity | None  # what it should be
    found: KnownQuantity | None = None  # what it is after the repairs
    names: Names | None = None
    repairs: tuple[Repair, ...] = ()
    as_it_stands: KnownQuantity | None = None  # what it is before a repair of its entries
    is_proved: bool = False  # that the repaired formula is what was found
    counterexample: str = ""  # where the formula is wrong, if it is right for some angles only
    is_reflection: bool = False

    @property
    def arrangement(self) -> str:
        """How what was found is written: "transposed", "scalar last", "twice"."""
        return self.found.arrangement if self.found else ""

    @property
    def is_equal(self) -> bool:
        """Whether the formula is right as it stands."""
        return self.found is not None and not self.repairs and not self.counterexample

    def record(self) -> dict[str, Any]:
        """The comparison as plain data for JSON."""
        found = self.found
        return {
            "equal": self.is_equal,
            "proved": self.is_proved,
            "counterexample": self.counterexample or None,
            "reflection": self.is_reflection,
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
        asked, found = self.asked, self.found
        symbols = self.formula.free_symbols
        facts: dict[str, Any] = {each.name: getattr(self, each.name) for each in fields(self)}
        facts |= {
            "calls": self._in_names(),
            "points": POINTS,
            "is_as_asked": found and asked and str(asked) == str(found),
            "shape": in_words(self.formula.shape),
            "expected": in_words(asked.matrix.shape if asked else self.formula.shape),
            "names": sorted(str(s) for s in symbols if not isinstance(s, sp.Dummy)),
        }
        return str(environment().get_template("compare/comparison.txt.jinja").render(facts))

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


def in_words(shape: tuple[int, int]) -> str:
    """In words: a 3x3 matrix, a vector of 4 entries, a single expression."""
    if shape == (1, 1):
        return "a single expression"
    return f"a vector of {shape[0]} entries" if shape[1] == 1 else "a {}x{} matrix".format(*shape)


def against(formula: sp.ImmutableMatrix, goal: KnownQuantity) -> Comparison:
    """Compare with one quantity."""
    meant = [Meaning.of(formula, goal, names) for names in goal.readings(formula)]
    if is_reflection(formula) and not any(reading.is_whole for reading in meant):
        return Comparison(formula=formula, asked=goal, is_reflection=True)
    found = next(likely(meant, goal), None)
    if not found and (reading := next(filter(is_right_at_some, meant), None)):
        return for_some_angles(reading, goal)
    if found and not any(repair.place for repair in found[1]):
        return _made(*found, goal)
    other = identified(formula, only_equal=True)
    if found:
        return replace(_made(*found, goal), as_it_stands=other.found)
    if other.found:
        words = f"this is {other.found.described}"
        repair = Repair(kind="convention", words=words, formula=formula, goal=other.found)
        return replace(other, asked=goal, repairs=(repair, *other.repairs))
    return Comparison(formula=formula, asked=goal)


def likely(
    meant: Sequence[Meaning], goal: KnownQuantity
) -> Iterator[tuple[Meaning, tuple[Repair, ...]]]:
    """Readings with the repairs that make them right, the smallest first."""
    yield from ((m, ()) for m in meant if m.agrees(m.formula, goal))
    if any(map(is_right_at_some, meant)):  # no change of a formula that is right for some angles
        return
    yield from ((m, (r,)) for m in meant for r in whole_repairs(m))
    nearest = max(meant, key=_count_right, default=None)
    entries = entry_repairs(nearest) if nearest else ()
    if nearest and entries:
        yield nearest, entries


def identified(
    formula: sp.ImmutableMatrix,
    *,
    only_equal: bool = False,
    is_in_program: bool = False,
) -> Comparison:
    """Compare with all quantities of the catalogue; the nearest if none is equal.

    In a program, a transpose, a sign or a factor of the whole formula may be meant.
    """
    near: list[tuple[float, Meaning]] = []
    whole: Meaning | None = None
    some: Meaning | None = None
    goals = chain(catalogue(formula), laws(formula.shape))
    known = (goal for goal in goals if goal.matrix.shape == formula.shape)
    for goal in chain.from_iterable(goal.arrangements for goal in known):
        for names in goal.readings(formula):
            reading = Meaning.of(formula, goal, names)
            right = reading.right
            if right.all():
                return _made(reading, (), None)
            some = some or (reading if is_right_at_some(reading) else None)
            whole = whole or (reading if reading.is_whole else None)
            near.append((float(right.mean()), reading))
    if only_equal:
        return Comparison(formula=formula, asked=None)
    if (turned := _in_other_senses(formula)) is not None:
        return turned
    if not whole and is_reflection(formula):
        return Comparison(formula=formula, asked=None, is_reflection=True)
    if some:
        return for_some_angles(some, None)
    if whole and not is_in_program:
        return _made(whole, tuple(islice(whole_repairs(whole), 1)), None)
    near.sort(key=lambda each: -each[0])
    for share, reading in near[:8]:
        repairs = entry_repairs(reading) if share >= _NEAR else ()
        if 0 < len(repairs) <= _MOST_REPAIRS and all(r.kind != "entry" for r in repairs):
            return _made(reading, repairs, None)
    return Comparison(formula=formula, asked=None)


def _in_other_senses(formula: sp.ImmutableMatrix) -> Comparison | None:
    """A quaternion of angles of which some count in the other sense: a convention, no fault.

    In a rotation matrix more entries would differ than a repair may change.
    """
    angles = sorted(formula.free_symbols, key=str)
    if formula.shape != (4, 1) or not formula.has(sp.sin) or len(angles) > 3:
        return None
    for senses in islice(product((1, -1), repeat=len(angles)), 1, None):
        turned = {s: sense * s for s, sense in zip(angles, senses, strict=True)}
        comparison = identified(formula.xreplace(turned), only_equal=True)
        if comparison.found is not None and comparison.found.quantity == QUATERNION:
            opposite = " and ".join(str(s) for s in angles if turned[s] != s)
            words = f"with the opposite sense of {opposite}"
            arrangement = ", ".join(filter(None, (comparison.arrangement, words)))
            found = replace(comparison.found, arrangement=arrangement)
            return replace(comparison, formula=formula, found=found)
    return None


def is_right_at_some(reading: Meaning) -> bool:
    """Whether a formula agrees at all points of the first quadrant, but not at others."""
    if reading.formula.shape != reading.goal.matrix.shape:
        return False
    agrees = agreeing_points(reading.numbers(reading.formula), reading.goal.values)
    return bool(agrees[:NEAR_POINTS].all()) and not agrees.all()


def for_some_angles(reading: Meaning, asked: KnownQuantity | None) -> Comparison:
    agrees = agreeing_points(reading.numbers(reading.formula), reading.goal.values)
    place = int(agrees.argmin())  # the first point where it is wrong
    called = {meant: str(name) for name, meant in reading.names.items()}
    point = ", ".join(
        f"{called.get(symbol, name)} = {reading.goal.points[symbol][place]:.4g}"
        for name, symbol in reading.goal.coordinates.items()
    )
    return Comparison(
        formula=reading.formula,
        asked=asked,
        found=reading.goal,
        names=reading.names,
        counterexample=point,
    )


def _count_right(reading: Meaning) -> int:
    same = reading.formula.shape == reading.goal.matrix.shape
    return int(reading.right.sum()) if same else 0


def _made(reading: Meaning, repairs: Sequence[Repair], asked: KnownQuantity | None) -> Comparison:
    """The comparison, with the proof that the repaired formula is what was found."""
    found = repairs[0].goal if repairs else reading.goal
    changed = _together(reading.formula, repairs)
    theirs = changed.xreplace(dict(reading.names))
    try:
        is_proved = found.motion.equality(theirs, found.matrix).is_exact
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
