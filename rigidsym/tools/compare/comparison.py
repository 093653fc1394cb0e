"""Is this formula right? The entry to this folder.

A formula is matched with one quantity or with all, and small changes are tried that make it right.

A change of the whole formula (a transpose, a sign, a factor) is tried before changes of single
entries.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import chain, product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError, DerivationError, ExpressionError, ModelError
from rigidsym.motion import Motion
from rigidsym.system.resources import environment
from rigidsym.tools.compare.language import spelled_out
from rigidsym.tools.compare.program import formula_matrix
from rigidsym.tools.compare.quantities import (
    ANGLES,
    NEAR_POINTS,
    POINTS,
    QUATERNION,
    SHAPES,
    Array,
    KnownQuantity,
    Names,
    Values,
    are_angles,
    catalogue,
    evaluated,
    is_orthogonal,
    near,
    of_motion,
    readings,
    stem_of,
    target,
)

_MOST_REPAIRS = 2  # of a formula that nobody has named
_NEAR = 0.6  # share of entries that must be right for a formula to be close to another
_NEAREST = 16  # readings of which the wrong entries are repaired
_MOST_OPERATIONS = 200  # of an entry in which each part is changed
_MOST_ENTRIES = 3  # that may be wrong, each by one change
_HALF, _TWO = sp.Rational(1, 2), sp.Integer(2)
_WHOLE = {  # changes of all entries together
    "transpose": ("the formula is the transpose", lambda m: m.T),
    "sign": ("all signs are the other way round", lambda m: -m),
    "factor 2": ("a factor 2 is missing", lambda m: 2 * m),
    "factor 1/2": ("a factor 1/2 is missing", lambda m: m / 2),
}
_KINDS = {  # changes of a part of an entry, the likeliest first
    "sign": "a sign",
    "sine and cosine": "sine and cosine exchanged",
    "index": "another name",
    "arguments": "arguments exchanged",
    "square": "a square",
    "factor": "a number as factor",
    "half angle": "half or twice the angle",
    "product": "a factor missing or too many",
    "quadrant": "atan2 in place of atan",
    "term": "a term too many",
}


@dataclass(frozen=True, kw_only=True)
class Repair:
    """One change that makes a formula right."""

    kind: str  # "sign", "square", "transpose", ...
    words: str  # a sentence
    formula: sp.ImmutableMatrix  # the formula after it, in the user's names
    goal: KnownQuantity  # what that equals
    place: tuple[int, int] | None = None  # of the entry, counted from 1
    after: sp.Expr | None = None


@dataclass(frozen=True, kw_only=True)
class Reading:
    """A formula under one meaning of its names, beside a known quantity."""

    formula: sp.ImmutableMatrix
    goal: KnownQuantity
    names: Names
    values: Values  # of the names, and of all that was evaluated before
    own: Array  # the numbers of the formula, (points, rows, columns)

    @classmethod
    def of(cls, formula: sp.ImmutableMatrix, goal: KnownQuantity, names: Names) -> Reading:
        meant = sp.Matrix([[*names.values()]])
        numbers = evaluated(meant, dict(goal.points))[:, 0].T if names else ()
        values: Values = dict(zip(names, numbers, strict=True))
        own = goal.on_circle(evaluated(formula, values))
        return cls(formula=formula, goal=goal, names=names, values=values, own=own)

    def agrees(self, changed: sp.MatrixBase, wanted: Array) -> bool:
        numbers = self.goal.on_circle(evaluated(changed, self.values))
        return numbers.shape == wanted.shape and bool(near(numbers, wanted).all())

    @cached_property
    def agreement(self) -> NDArray[Any]:
        """Where the formula is right: (points, rows, columns)."""
        numbers, wanted = self.own, self.goal.values
        return near(numbers, wanted) if numbers.shape == wanted.shape else np.zeros((1, 1, 1), bool)

    @property
    def is_equal(self) -> bool:
        return bool(self.agreement.all())

    @property
    def share(self) -> float:
        """The part of all entries that is right."""
        return float(self.agreement.all(axis=0).mean())

    @property
    def is_right_for_some(self) -> bool:
        """Whether a formula agrees at all points of the first quadrant, but not at others."""
        is_right = np.asarray(self.agreement.all(axis=(1, 2)))
        return bool(is_right[:NEAR_POINTS].all()) and not is_right.all()


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The quantity that a formula is, or the repairs that make it right."""

    formula: sp.ImmutableMatrix
    asked: KnownQuantity | None  # what it should be
    found: KnownQuantity | None = None  # what it is after the repairs
    names: Names | None = None
    repairs: tuple[Repair, ...] = ()
    is_proved: bool = False  # that the repaired formula is what was found
    counterexample: str = ""  # where the formula is wrong, if it is right for some angles only
    is_reflection: bool = False
    are_body_rates: bool = False  # taken for the rates of Euler angles

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
        return {
            "equal": self.is_equal,
            "proved": self.is_proved,
            "counterexample": self.counterexample or None,
            "reflection": self.is_reflection,
            "rotation": self.found.rotation if self.found else None,
            "quantity": self.found.quantity if self.found else None,
            "arrangement": self.arrangement,
            "names": self._called(),
            "repairs": [
                {
                    "kind": repair.kind,
                    "words": repair.words,
                    "entry": list(repair.place) if repair.place else None,
                    "after": None if repair.after is None else str(repair.after),
                }
                for repair in self.repairs
            ],
        }

    def text(self) -> str:
        """The findings in sentences."""
        asked, found, called = self.asked, self.found, self._called()
        is_of_angles = found and found.rotation and found.quantity != ANGLES
        q = found.inputs["q"] if found and is_of_angles else ()
        own = [name for name, symbol in (found.names if found else {}).items() if symbol in q]
        theirs = [called.get(name) or stem_of(called.get(f"{name}_dot", "")) for name in own]
        facts: dict[str, Any] = {each.name: getattr(self, each.name) for each in fields(self)}
        facts |= {
            "calls": [*zip(own, theirs, strict=True)] if own != theirs and any(theirs) else [],
            "are_all_called": all(theirs),
            "points": POINTS,
            "is_as_asked": found and asked and str(asked) == str(found),
            "shape": in_words(self.formula.shape),
            "expected": in_words(asked.matrix.shape if asked else self.formula.shape),
            "names": sorted(map(str, self.formula.free_symbols)),
        }
        return str(environment().get_template("compare/comparison.txt.jinja").render(facts))

    def _called(self) -> dict[str, str]:
        """Names of the user by those of the quantity that was found."""
        symbols = {meant: str(name) for name, meant in (self.names or {}).items()}
        own = self.found.names if self.found else {}
        return {name: symbols[symbol] for name, symbol in own.items() if symbol in symbols}


def compare(
    formula: str | sp.MatrixBase | Sequence[Any],
    rotation: str | Motion | None = None,
    quantity: str | None = None,
) -> Comparison:
    """Compare a formula with a quantity of a rotation, or with all known quantities.

    `formula` is a text in Python, SymPy, C, MATLAB or LaTeX, a matrix, or rows of texts. Without
    `rotation` the conventions of the catalogue are tried. Raises ExpressionError for a text that is
    not a formula, and for a function: `rigidsym compare FILE` reads it in its file.
    """
    if callable(formula):
        raise ExpressionError(
            "expected a formula, not a function; `rigidsym compare FILE` reads functions in a file"
        )
    matrix = spelled_out(as_matrix(formula))
    if matrix.rows == 1:
        matrix = matrix.T
    if rotation is None and quantity is None:
        return identified(_checked(matrix))
    return against(matrix, _goal(rotation, quantity))


def _checked(formula: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Raises ExpressionError if the formula cannot be a quantity of the catalogue."""
    shape = in_words(formula.shape)
    if formula.shape not in SHAPES:
        read = f"{formula[0]} is {shape}" if len(formula) == 1 else f"the formula is {shape}"
        raise ExpressionError(
            f"{read}; expected a matrix of 3x3, 3x4, 4x3 or 4x4, or a vector of 3 or 4 entries, as "
            "in [c -s 0; s c 0; 0 0 1]"
        )
    if not formula.free_symbols:
        raise ExpressionError(f"{shape} of numbers only; expected a formula with names of angles")
    return formula


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        return formula_matrix(formula)
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
    if quantity == "coriolis_matrix":
        raise ExpressionError("a Coriolis matrix is not unique; compare the bias vector C(q, q̇) q̇")
    if isinstance(rotation, Motion):
        return of_motion(rotation, quantity, rotation.name)
    return target(rotation, quantity)


def in_words(shape: tuple[int, int]) -> str:
    """In words: a 3x3 matrix, a vector of 4 entries, a single expression."""
    if shape == (1, 1):
        return "a single expression"
    return f"a vector of {shape[0]} entries" if shape[1] == 1 else "a {}x{} matrix".format(*shape)


def against(formula: sp.ImmutableMatrix, goal: KnownQuantity) -> Comparison:
    """Compare with one quantity, under all meanings of its names."""
    names = readings(formula, goal, is_asked=True)
    meanings = [Reading.of(formula, goal, each) for each in names]
    if decided := _decided(formula, meanings, goal, is_in_program=False):
        return decided
    own = identified(formula, only_equal=True)
    if own.found:
        words = f"this is {own.found.described}"
        repair = Repair(kind="convention", words=words, formula=formula, goal=own.found)
        return replace(own, asked=goal, repairs=(repair,))
    nearest = max(meanings, key=lambda each: each.share, default=None)
    if nearest and (repairs := entry_repairs(nearest)):
        return _proved(nearest, repairs, goal)
    return Comparison(formula=formula, asked=goal)


def identified(
    formula: sp.ImmutableMatrix, *, only_equal: bool = False, is_in_program: bool = False
) -> Comparison:
    """Compare with all quantities of the catalogue; the nearest if none is equal.

    In a program, a transpose, a sign or a factor of the whole formula may be meant.
    """
    meanings: list[Reading] = []
    of_inputs: dict[Any, list[Reading]] = {}  # Euler angles of all orders have the same inputs
    for goal in catalogue(formula):
        model = goal.motion.model
        inputs = (tuple(goal.inputs.items()), goal.uses, model.constraints)
        if inputs not in of_inputs:
            names = readings(formula, goal, is_asked=False)
            of_inputs[inputs] = [Reading.of(formula, goal, each) for each in names]
        for meaning in (replace(each, goal=goal) for each in of_inputs[inputs]):
            if meaning.is_equal:
                return _proved(meaning, (), None)
            meanings.append(meaning)
    unknown = Comparison(formula=formula, asked=None)
    if only_equal:
        return unknown
    decided = _in_other_senses(formula) or _decided(
        formula, meanings, None, is_in_program=is_in_program
    )
    if decided:
        return decided
    near_ones = [each for each in meanings if each.share >= _NEAR]
    for meaning in sorted(near_ones, key=lambda each: -each.share)[:_NEAREST]:
        repairs = entry_repairs(meaning)
        if 0 < len(repairs) <= _MOST_REPAIRS and all(r.kind != "entry" for r in repairs):
            return _proved(meaning, repairs, None)
    return unknown


def _decided(
    formula: sp.ImmutableMatrix,
    meanings: Sequence[Reading],
    asked: KnownQuantity | None,
    *,
    is_in_program: bool,
) -> Comparison | None:
    """What is known without a look at single entries."""
    if equal := next((each for each in meanings if each.is_equal), None):
        return _proved(equal, (), asked)
    is_mirror, of_angles = is_orthogonal(formula, -1), are_angles(formula)
    # Inverse functions are not changed as a whole: transposes, orders and senses of the angles are
    # already among their conventions.
    if is_mirror or not (is_in_program or of_angles):
        for meaning, (kind, (words, change)) in product(meanings, _WHOLE.items()):
            changed = change(formula)
            if meaning.agrees(changed, meaning.goal.values):
                if is_in_program:  # the negative of a rotation may be meant
                    return None
                goal = meaning.goal
                words += " (passive)" * (goal.quantity == "rotation_matrix" and kind == "transpose")
                repair = Repair(kind=kind.split()[0], words=words, formula=changed, goal=goal)
                return _proved(meaning, [repair], asked)
    # The negative of a reflection may be the wanted rotation. If it is not, det = −1 is the
    # finding, and no repair of entries is looked for.
    if is_mirror:
        return Comparison(formula=formula, asked=asked, is_reflection=True)
    some = next((each for each in meanings if each.is_right_for_some), None)
    if not some or of_angles:
        return None
    # No change makes it right for all angles. The first point where the formula is wrong:
    place = int(some.agreement.all(axis=(1, 2)).argmin())
    points = ((name, some.values[name][place]) for name in sorted(some.names, key=str))
    return Comparison(
        formula=formula,
        asked=asked,
        found=some.goal,
        names=some.names,
        counterexample=", ".join(f"{name} = {value:.4g}" for name, value in points),
    )


def _in_other_senses(formula: sp.ImmutableMatrix) -> Comparison | None:
    """A rotation by angles of which some count in the other sense: a convention, no fault."""
    angles = sorted(formula.free_symbols, key=str)
    if not formula.has(sp.sin) or not 1 < len(angles) + (formula.rows == 4) < 5:
        return None
    if formula.shape != (4, 1) and not is_orthogonal(formula, 1):
        return None
    all_senses = sorted(product((1, -1), repeat=len(angles)), key=lambda s: s.count(-1))
    # Every choice of senses but the given one, those with few opposite angles first.
    for senses in all_senses[1:]:
        turned = {s: sense * s for s, sense in zip(angles, senses, strict=True)}
        comparison = identified(formula.xreplace(turned), only_equal=True)
        if comparison.found and comparison.found.quantity in (QUATERNION, "rotation_matrix"):
            opposite = " and ".join(str(s) for s in angles if turned[s] != s)
            words = f"with the opposite sense of {opposite} (a convention, or wrong signs)"
            arrangement = ", ".join(filter(None, (comparison.arrangement, words)))
            found = replace(comparison.found, arrangement=arrangement)
            return replace(comparison, formula=formula, found=found)
    return None


def _proved(reading: Reading, repairs: Sequence[Repair], asked: KnownQuantity | None) -> Comparison:
    """The comparison, with the proof that the repaired formula is what was found."""
    last = repairs[-1] if repairs else None
    found, changed = (last.goal, last.formula) if last else (reading.goal, reading.formula)
    comparison = Comparison(
        formula=reading.formula,
        asked=asked,
        found=found,
        names=reading.names,
        repairs=tuple(repairs),
    )
    if found.quantity == ANGLES:  # no expressions of the ring
        return comparison
    try:
        theirs = changed.xreplace(dict(reading.names))
        return replace(comparison, is_proved=found.motion.equality(theirs, found.matrix).is_exact)
    except DerivationError:  # it is false, although the numbers agree
        return Comparison(formula=reading.formula, asked=asked)
    except (AlgebraError, ModelError):  # the ring cannot hold it
        return comparison


# Single entries


def entry_repairs(reading: Reading) -> tuple[Repair, ...]:
    """One change in each wrong entry, one after the other; () if there are too many."""
    formula, goal = reading.formula, reading.goal
    if formula.shape != goal.matrix.shape:
        return ()
    wrong = [(int(i), int(j)) for i, j in np.argwhere(~reading.agreement.all(axis=0))]
    # Two exchanged entries are one mistake, not two.
    if len(wrong) == 2:
        one, two = wrong
        changed = formula.as_mutable()
        changed[one], changed[two] = changed[two], changed[one]
        if reading.agrees(changed, goal.values):
            words = f"entries {_from1(one)} and {_from1(two)} are exchanged"
            fixed, place = sp.ImmutableMatrix(changed), _from1(one)
            return (Repair(kind="exchange", words=words, formula=fixed, goal=goal, place=place),)
    if not 0 < len(wrong) <= min(_MOST_ENTRIES, max(1, len(formula) // 3)):
        return ()
    repairs: list[Repair] = []
    changed = formula.as_mutable()
    for place in wrong:
        kind, after = _entry(reading, place)
        where = _from1(place) if formula.cols > 1 else place[0] + 1
        words = f"entry {where}: {changed[place]} should be {after}"
        words += f" ({_KINDS[kind]})" if kind in _KINDS else ""
        changed[place] = after
        fixed = sp.ImmutableMatrix(changed)
        repairs.append(
            Repair(
                kind=kind, words=words, formula=fixed, goal=goal, place=_from1(place), after=after
            )
        )
    return tuple(repairs)


def _from1(place: tuple[int, int]) -> tuple[int, int]:
    """A place counted from 1, as people do."""
    return place[0] + 1, place[1] + 1


def _entry(reading: Reading, place: tuple[int, int]) -> tuple[str, sp.Expr]:
    """The smallest change of an entry; the entry of the target if no small one is enough."""
    goal, before = reading.goal, reading.formula[place]
    wanted = goal.values[:, [place[0]], [place[1]]][:, None]
    groups = [  # names that may be taken for one another: those of one argument
        [symbol for symbol, meant in reading.names.items() if meant in symbols]
        for symbols in goal.inputs.values()
    ]
    groups.append([symbol for symbol, meant in reading.names.items() if meant.is_Add])
    changes = set(variants(before, groups)) if before.count_ops() <= _MOST_OPERATIONS else ()
    kinds = [*_KINDS]
    for kind, after in sorted(
        changes, key=lambda v: (kinds.index(v[0]), v[1].count_ops(), str(v[1]))
    ):
        with suppress(ExpressionError):  # a change without real values, such as 1/0, is no repair
            if reading.agrees(sp.Matrix([[after]]), wanted):
                return kind, after
    # No single change is enough: the entry of the goal is written in the names of the formula.
    back = {meant: symbol for symbol, meant in reading.names.items()}
    return "entry", goal.matrix[place].xreplace(back)


_SWAPPED = {sp.sin: sp.cos, sp.cos: sp.sin}
Groups = Sequence[Sequence[sp.Symbol]]


def variants(e: sp.Expr, groups: Groups, *, inside: bool = False) -> Iterator[tuple[str, sp.Expr]]:
    """(kind, changed expression) for each single change of an expression, or `inside` an angle."""
    for place, part in enumerate(e.args[: 1 if e.is_Pow else None]):
        for kind, changed in variants(part, groups, inside=inside or e.func in _SWAPPED):
            yield kind, e.func(*e.args[:place], changed, *e.args[place + 1 :])
            if e.is_Pow and e.exp == 2:  # x y, mistyped as x x: one of two equal factors
                yield kind, part * changed
    yield "sign", -e
    numbers = "half angle" if inside else "factor"
    yield from ((numbers, factor * e) for factor in (_HALF, _TWO))
    if e.is_Symbol:
        group = next((g for g in groups if e in g), ())
        yield from (("index", other) for other in group if other != e)
    if e.func in _SWAPPED:
        yield "sine and cosine", _SWAPPED[e.func](*e.args)
    if e.func == sp.atan2:
        yield "arguments", sp.atan2(*e.args[::-1])
    if e.func == sp.atan:
        above, below = e.args[0].as_numer_denom()
        yield from (("quadrant", sp.atan2(sign * above, sign * below)) for sign in (1, -1))
    if e.is_Mul:
        if e.args[0].is_even:  # two equal terms that have become one
            half = e / 2
            changes = variants(half, groups, inside=inside)
            yield from ((kind, half + changed) for kind, changed in changes if kind == "index")
        for factor in e.args:
            yield numbers if factor.is_number else "product", e / factor
    if e.is_Add:
        yield from (("term", e - term) for term in e.args)
    if e.is_Pow and e.exp == 2:
        yield "square", e.base
    if not inside and (e.is_Function or e.is_Symbol):
        yield "square", e**2
    if not (inside or e.is_Add):
        yield from (("product", e * f(s)) for s in chain(*groups[:1]) for f in _SWAPPED)
