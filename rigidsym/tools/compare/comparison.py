"""Is this formula right? The entry to this folder.

A formula is evaluated under all meanings of its names, and compared with one quantity or with all.
If none is equal, small changes are tried that make it right: of the whole formula (a transpose, a
sign, a factor) before those of single entries.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import chain, permutations, product
from posixpath import commonprefix
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.generators import in_names
from rigidsym.errors import AlgebraError, DerivationError, ExpressionError, ModelError
from rigidsym.motion import Motion
from rigidsym.system.resources import environment
from rigidsym.tools.compare import quantities as known, syntax
from rigidsym.tools.compare.language import spelled_out
from rigidsym.tools.compare.program import Formula, formula_matrix, is_length, program_formulas
from rigidsym.tools.compare.quantities import ANGLES, QUATERNION, Array, KnownQuantity, Names
from rigidsym.tools.compare.syntax import CHANGES, REMARKS, SHAPES, WAYS, WHOLE, limits, patterns

_read = cache(program_formulas)
# (goals, points, rows, columns)
_values_of = cache(lambda goals: np.stack([goal.values for goal in goals]))
_ANGLES = ["phi", "theta", "psi"]  # if nobody has chosen their names


@dataclass(frozen=True)
class Repair:
    """One change that makes a formula right."""

    kind: str  # "sign", "square", "transpose", ...
    words: str  # a sentence
    formula: sp.ImmutableMatrix  # the formula after it, in the user's names
    place: tuple[int, int] | None = None  # of the entry, counted from 1
    after: sp.Expr | None = None


@dataclass(frozen=True)
class Reading:
    """A formula under one meaning of its names, beside a known quantity."""

    formula: sp.ImmutableMatrix
    goal: KnownQuantity
    names: Names
    agreement: NDArray[np.bool_]  # where the formula is right: (points, rows, columns)

    @cached_property
    def is_right(self) -> NDArray[np.bool_]:
        """Of each entry."""
        return np.asarray(self.agreement.all(axis=0))

    @cached_property
    def values(self) -> known.Values:
        """Values of the names, and of all that was evaluated before."""
        return known.named(self.names, dict(self.goal.points))

    @property
    def keeps_scale(self) -> bool:
        """Whether a formula that divides a vector by its length is the same for twice the vector.

        On unit vectors, v/|v|² and v |v| are right, too.
        """
        rotation = self.goal.motion.model if self.goal.quantity in known.OF_DIRECTIONS else None
        for condition in rotation.constraints if rotation else ():
            own = {s for s, meant in self.names.items() if condition.has(meant)}
            sums = self.formula.atoms(sp.Add)
            if any(is_length(each) and each.free_symbols == own for each in sums):
                twice = {s: self.values[s] * (1 + (s in own)) for s in self.names}
                return self.agrees(self.formula, self.goal.numbers(self.formula, twice))
        return True

    def agrees(self, changed: sp.MatrixBase, wanted: Array) -> bool:
        return bool(known.near(self.goal.numbers(changed, self.values), wanted).all())


class _Trial:
    """A formula under all meanings of its names, beside all quantities of a family."""

    def __init__(self, formula: sp.ImmutableMatrix, family: Any, *, is_asked: bool) -> None:
        goal = family[0]
        self.formula, self.family, self.wanted = formula, family, _values_of(family)
        self.names = known.meanings(formula, goal, is_asked=is_asked)
        # (meanings, points, rows, columns)
        self.numbers = np.empty((0, known.POINTS, *formula.shape))
        if self.names:
            points, values = dict(goal.points), known.Values()
            for symbol in formula.free_symbols:
                meant = sp.Matrix([each[symbol] for each in self.names])
                values[symbol] = known.evaluated(meant, points)[..., 0].T
            numbers = goal.numbers(formula, values)
            self.numbers = np.broadcast_to(numbers, (len(self.names), *numbers.shape[-3:]))
        self.agreement = self.compared(self.numbers)

    def compared(self, numbers: Array) -> Array:
        """Where these are the values of the goals: (meanings, goals, points, rows, columns)."""
        if numbers.shape[1:] != self.wanted.shape[1:]:
            return np.zeros((len(self.names), len(self.family), 1, 1, 1), bool)
        return known.near(numbers[:, None], self.wanted)

    def readings(self, where: Any) -> Iterator[Reading]:
        """The readings for which this is true, (meanings, goals), the plainest first."""
        odd = [sum(map(known.oddness, each.values())) for each in self.names]
        for k, n in sorted(np.argwhere(where).tolist(), key=lambda k_n: (odd[k_n[0]], *k_n[::-1])):
            reading = Reading(self.formula, self.family[n], self.names[k], self.agreement[k, n])
            if reading.keeps_scale:
                yield reading


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The quantity that a formula is, or the repairs that make it right."""

    formula: sp.ImmutableMatrix
    asked: KnownQuantity | None  # what it should be
    found: KnownQuantity | None = None  # what it is after the repairs
    names: Names = field(default_factory=dict)
    repairs: tuple[Repair, ...] = ()
    is_proved: bool = False  # that the repaired formula is what was found
    counterexample: str = ""  # where the formula is wrong, if it is right for some angles only
    contradicts: tuple[int, ...] = ()  # lines of other branches, with the conjugate
    place: tuple[int, int] | None = None  # of the entry that is wrong in a branch
    branch: str = ""  # where another branch is wrong, or a remark on one that is right
    is_reflection: bool = False
    form: str = ""  # how a program writes it: transposed, or with a factor that is left out
    left_out: str = ""  # terms of a program that are not compared
    are_body_rates: bool = False  # taken for the rates of Euler angles
    others: tuple[Comparison, ...] = ()  # with other quantities, which are as near

    @property
    def arrangement(self) -> str:
        """How what was found is written: "transposed", "scalar last", "twice"."""
        odd = [(str(name), known.oddness(meant)) for name, meant in self.names.items()]
        opposite = " and ".join(sorted(name for name, kind in odd if kind % 2))
        turned = " and ".join(sorted(name for name, kind in odd if kind > 1))
        words = (
            *(WAYS[way] for way in (self.found.ways if self.found else ())),
            opposite and f"with the opposite sense of {opposite} (a convention or wrong signs)",
            turned and f"with {turned} from another axis, a quarter or half turn away",
            "".join(f"if {name} = {length}" for name, length in self.supposed.items()),
            self.form,
        )
        return ", ".join(filter(None, words))

    @property
    def supposed(self) -> dict[sp.Symbol, sp.Expr]:
        """Names that are lengths if the formula is right, and these lengths in its own names."""
        lengths = {name: x for name, x in self.names.items() if is_length(x) or is_length(2 / x)}
        own = {x: name for name, x in self.names.items() if name not in lengths}
        return {name: x.xreplace(own) for name, x in lengths.items()}

    @property
    def is_equal(self) -> bool:
        """Whether the formula is right as it stands."""
        return bool(self.found) and not (self.repairs or self.counterexample or self.contradicts)

    @property
    def is_wrong(self) -> bool:
        """Whether it is a fault; a reflection may be meant."""
        return not (self.is_equal or self.is_reflection)

    def record(self) -> dict[str, Any]:
        """The comparison as plain data for JSON."""
        found = self.found
        facts: dict[str, Any] = {"equal": self.is_equal, "proved": self.is_proved}
        facts |= {"counterexample": self.counterexample or None, "branch": self.branch or None}
        facts |= {"reflection": self.is_reflection, "contradicts": [*self.contradicts]}
        facts |= {"rotation": found and found.rotation, "quantity": found and found.quantity}
        facts |= {"arrangement": self.arrangement, "names": self._called()}
        facts |= {"others": [other.record() for other in self.others]}
        repairs = [
            {"kind": each.kind, "words": each.words, "entry": each.place and [*each.place]}
            | {"after": each.after and str(each.after)}
            for each in self.repairs
        ]
        formula = [[str(entry) for entry in row] for row in self.formula.tolist()]
        return {"formula": formula, **facts, "repairs": repairs}

    def text(self) -> str:
        """The findings in sentences."""
        asked, found, called = self.asked, self.found, self._called()
        coordinates = found.coordinates if found else {}
        names = {
            own: called.get(own) or known.stem_of(called.get(f"{own}_dot", ""))
            for own in coordinates
        }
        # the names of coordinates: ours, the user's, and the axis of the turn
        calls = [(own, names[own], axis) for own, axis in coordinates.items() if names[own]]
        product = found.inputs.values() if found and found.quantity == "quaternion_product" else ()
        factors = [[called.get(s.name, "") for s in vector] for vector in product]
        fixed = asked.coordinates.items() if asked and asked.has_own_names else ()
        # w of q_w needs no words
        calls = calls if any(not n.endswith(own) or (a and own != n) for own, n, a in calls) else []
        facts: dict[str, Any] = {"arrangement": self.arrangement, "calls": calls}
        facts |= {"factors": [commonprefix(n).rstrip("_") or f"({', '.join(n)})" for n in factors]}
        facts |= {"fixed": [(own, own, axis) for own, axis in fixed]}
        shapes = (in_words(each.shape) for each in (self.formula, asked and asked.matrix) if each)
        template = environment().get_template("compare/comparison.txt.jinja")
        return str(template.render(vars(self) | facts, points=known.POINTS, shapes=[*shapes]))

    def _called(self) -> dict[str, str]:
        """Names of the user by those of the quantity that was found."""
        symbols = {known.input_in(meant): str(name) for name, meant in self.names.items()}
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
        raise ExpressionError("expected a formula; `rigidsym compare FILE` reads functions")
    matrix = as_matrix(formula)
    matrix = matrix.T if matrix.rows == 1 else matrix
    if rotation is None and quantity is None:
        return identified(_checked(spelled_out(matrix)))
    if rotation is None or quantity is None:
        raise ExpressionError("expected a rotation and a quantity, as in 'ZYX', 'rotation_matrix'")
    if quantity == "coriolis_matrix":
        raise ExpressionError("a Coriolis matrix is not unique; compare the bias vector C(q, q̇) q̇")
    if isinstance(rotation, Motion):
        is_named = rotation.name != rotation.model.name or rotation.model.passive
        axes = None if is_named else rotation.model.request.get("sequence")  # ZYX
        goal = known.of_motion(rotation, quantity, axes or rotation.name)
        chosen = rotation.model.request.get("angles", _ANGLES)
        others = ", ".join(sorted({*map(str, known.symbols_in(matrix)[1])} - {*chosen}))
        if others and chosen != _ANGLES:
            raise ExpressionError(f"angles {','.join(chosen)}: the formula has {others}")
    else:
        goal = known.target(rotation, quantity)
    angles = [*goal.coordinates]
    return identified(spelled_out(matrix, only=angles[0] if len(angles) == 1 else "angle"), goal)


def _checked(formula: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Raises ExpressionError if the formula cannot be a quantity of the catalogue."""
    shape, first = in_words(formula.shape), str(formula[0]) if len(formula) == 1 else "the formula"
    if formula.shape not in SHAPES:
        raise ExpressionError(
            f"{first} is {shape}; expected a matrix of 3x3, 3x4, 4x3 or 4x4, or a vector of 3 or 4 "
            "entries, as in [c -s 0; s c 0; 0 0 1]"
        )
    if not formula.free_symbols:
        raise ExpressionError(f"{shape} of numbers only; expected a formula with names of angles")
    return formula


def as_matrix(formula: Any) -> sp.ImmutableMatrix:
    """The matrix that a formula stands for."""
    if isinstance(formula, str):
        try:
            return formula_matrix(formula)
        except ExpressionError:
            _check_brackets(formula)
            raise
    if isinstance(formula, sp.MatrixBase):
        exact = {number: sp.Rational(str(number)) for number in formula.atoms(sp.Float)}
        return sp.ImmutableMatrix(in_names(formula.xreplace(exact)))
    rows = [row if isinstance(row, list | tuple) else [row] for row in formula]
    return sp.ImmutableMatrix([[as_matrix(entry)[0] for entry in row] for row in rows])


def _check_brackets(text: str) -> None:
    """Raises ExpressionError for a bracket without its other half."""
    ends, stack = {"(": ")", "[": "]", "{": "}", "": "nothing"}, [("", "nothing")]
    for column, letter in enumerate(text, 1):
        this = f"{letter!r} at character {column}"
        if letter in ends:
            stack.append((letter, this))
        elif letter in ends.values():
            begin, other = stack.pop()
            if ends[begin] != letter:
                raise ExpressionError(f"{this} closes {other}")
    if len(stack) > 1:
        raise ExpressionError(f"{stack[-1][1]} is not closed")


def in_words(shape: tuple[int, int]) -> str:
    """In words: a 3x3 matrix, a vector of 4 entries, a single expression."""
    if shape == (1, 1):
        return "a single expression"
    return f"a vector of {shape[0]} entries" if shape[1] == 1 else "a {}x{} matrix".format(*shape)


def identified(
    formula: sp.ImmutableMatrix,
    asked: KnownQuantity | None = None,
    *,
    only_equal: bool = False,
    is_in_program: bool = False,
    expected: Sequence[str] = (),
) -> Comparison:
    """Compare with the quantity that is asked for, or with all; the nearest if none is equal.

    In a program, a transpose, a sign or a factor of the whole formula may be meant. Of several
    nearest rotations, one about the `expected` axes, such as "z y x", is preferred.
    """
    for form, changed in _shifted(formula) if is_in_program and known.are_angles(formula) else ():
        plain = identified(changed, only_equal=True)
        if plain.found and len(plain.found.ways) < 2:
            return replace(plain, form=form)
    trials = []
    for family in known.families(formula) if asked is None else zip(asked.in_orders()):
        trial = _Trial(formula, family, is_asked=asked is not None)
        for equal in trial.readings(trial.agreement.all(axis=(2, 3, 4))):
            return _proved(equal, asked)
        trials.append(trial)
    for form, changed in _ways(formula) if is_in_program else ():
        if (whole := identified(changed, only_equal=True)).found:
            return replace(whole, form=form)
    comparison = mended(formula, () if is_in_program or only_equal else _changes(formula), asked)
    if not only_equal:
        comparison = comparison or _decided(formula, trials, asked)
        comparison = comparison or _close(formula, trials, asked, expected)
        comparison = comparison or _in_terms(formula, trials)
    parts = [*_parts(formula)] if is_in_program and comparison is None else []
    wholes = [(w, identified(part, only_equal=True)) for w, part, _ in parts]
    # of w - b, both the rates and their bias b would do
    for w, whole in sorted((p for p in wholes if p[1].found), key=lambda p: len(p[1].arrangement)):
        return replace(whole, left_out=f"terms without {w}")
    for w, _, changed in parts:
        # The gyroscopic torque may have the wrong sign.
        products = "products of" if formula.cols == 3 else "terms with"
        words = f"the {products} {w} should have the opposite sign"
        if not only_equal and (mend := mended(formula, [Repair("sign", words, changed)])):
            return mend
    return comparison or Comparison(formula=formula, asked=asked)


def mended(
    formula: sp.ImmutableMatrix, changes: Iterable[Repair], asked: KnownQuantity | None = None
) -> Comparison | None:
    """The comparison after the first change that makes a formula right."""
    for change in (each for each in changes if each.formula != formula):
        if (whole := identified(change.formula, asked, only_equal=True)).found:
            return replace(whole, formula=formula, repairs=(change,))
    return None


def _close(
    formula: sp.ImmutableMatrix, trials: Sequence[_Trial], asked: Any, expected: Sequence[str]
) -> Comparison | None:
    """The quantity, or the one asked for, that a few changes would make of a formula."""
    if asked is None:
        comparison = _repaired(_nearest(trials, limits.least_right, expected)[: limits.nearest])
        goals = [trial.family[0] for trial in trials if trial.names]
        are_turns = (g.quantity == QUATERNION or g.rotation in known.OF_VECTORS for g in goals)
        goal = comparison.found if comparison else None
        if any(are_turns) and (goal is None or "twice_the_angles" in goal.ways):
            comparison = mended(formula, _everywhere(formula)) or comparison
        return comparison
    if (other := identified(formula, only_equal=True)).found:
        repair = Repair("convention", f"this is {other.found}", formula)
        return replace(other, asked=asked, repairs=(repair,))
    for nearest in _nearest(trials, 0)[:1]:
        if repairs := entry_repairs(nearest):
            return _proved(nearest, asked, repairs)
    return None


@cache
def _sums(goal: KnownQuantity) -> list[tuple[list[sp.Matrix], Array, Array]]:
    """Terms of a quantity in vector notation, their values at all points, and their factors."""
    q, sums = {sp.Symbol(name, real=True): s for name, s in goal.names.items()}, []
    for text in syntax.SUMS.get(str(goal), ()):
        terms = [f.forms[0].xreplace(q) for f in _read(text, ".py") if f.name.startswith("t_")]
        values = np.stack([known.evaluated(term, goal.points).ravel() for term in terms], axis=1)
        factors = np.linalg.lstsq(values, goal.values.ravel(), rcond=None)[0].round(9) + 0.0
        sums.append((terms, values, factors))
    return sums


def _in_terms(formula: sp.ImmutableMatrix, trials: Sequence[_Trial]) -> Comparison | None:
    """The comparison with a sum in which terms have a wrong factor, as s u × v for 2 s u × v.

    Such a mistake in vectors is one in all components. One term may also be in place of another.
    """
    said = "{} should have the factor {:g}, not {:g}"
    for trial in (each for each in trials if np.isfinite(each.numbers).all()):
        sums = [(k, *each) for k, goal in enumerate(trial.family) for each in _sums(goal)]
        for (n, names), (k, terms, values, wanted) in product(enumerate(trial.names), sums):
            fit = np.linalg.lstsq(values, numbers := trial.numbers[n].ravel(), rcond=None)[0]
            wrong = np.flatnonzero((own := fit.round(9) + 0.0) != wanted)
            ratios = {own[i] / wanted[i] if wanted[i] else 0.0 for i in wrong}
            # -R v of the inverse has the opposite sign in several terms
            is_sure = 0 not in ratios and (len(wrong) == 1 or min(ratios, default=0) > 0)
            is_part = is_sure and len(ratios) == 1 and len(wrong) < np.count_nonzero(wanted)
            is_other = len(wrong) == 2 and ratios == {0} and {*own[wrong]} == {*wanted[wrong]}
            if (is_part or is_other) and known.near(values @ fit, numbers).all():
                goal, back = trial.family[k], {meant: name for name, meant in names.items()}
                entries = [next(filter(None, terms[i].xreplace(back))) for i in wrong]
                words = ", and ".join(map(said.format, entries, wanted[wrong], own[wrong]))
                repair = Repair("factor", f"{words}, in all entries", goal.matrix.xreplace(back))
                return _proved(Reading(formula, goal, names, trial.agreement[n, k]), None, [repair])
    return None


def _repaired(nearest: Sequence[Reading]) -> Comparison | None:
    """The comparison with the nearest quantity, beside others that are as near.

    The mistake in a formula between two conventions may be in one entry or in another.
    """
    candidates: list[tuple[bool, list[Repair], Reading]] = []
    for reading in nearest:
        right = reading.is_right
        if candidates and right.mean() < candidates[0][-1].is_right.mean():
            break
        repairs = entry_repairs(reading)
        is_small = all(repair.kind != "entry" for repair in repairs)
        is_odd = any(known.oddness(meant) > 1 for meant in reading.names.values())
        is_odd |= reading.goal.quantity == "cross_product_matrix"  # of any senses
        # If all other entries are right, and these are many, one may be wrong in any way.
        names = np.array(reading.formula.applyfunc(lambda entry: len(entry.free_symbols)), bool)
        least = limits.most_wrong if reading.formula.cols == 1 else 2 * limits.most_wrong
        is_rich = names[~right].all() and (names & right).sum() >= least
        # Angles from other axes, or senses, are so many conventions that one is near by chance.
        most = limits.most_repairs - is_odd if is_small else is_rich
        if repairs and len(repairs) <= most:
            candidates.append((is_small, repairs, reading))
    small = [each for each in candidates if each[0]]
    comparisons: dict[sp.ImmutableMatrix, Comparison] = {}
    for _, repairs, reading in small or candidates[:1]:
        comparisons.setdefault(repairs[-1].formula, _proved(reading, None, repairs))
    proved = [each for each in comparisons.values() if each.found]
    return replace(proved[0], others=tuple(proved[1 : 1 + limits.most_others])) if proved else None


def _everywhere(formula: sp.ImmutableMatrix) -> Iterator[Repair]:
    """Changes of a part that most entries have, and of an angle in all its sines.

    1 + cos θ in place of 1 − cos θ spoils all entries of Rodrigues' formula.
    """
    for part in sorted(formula.atoms(sp.sin, sp.cos, sp.Add, sp.Pow), key=str):
        terms = part.args if part.is_Add else ()
        changes = [("sign", part, part - 2 * term) for term in terms]
        # of a square root, which has the exponent 1/2 in one entry and -1/2 in others
        changes += [("factor", sp.sqrt(part), k * sp.sqrt(part)) for k in _SCALES if terms[2:]]
        changes += [("factor", part, k * part) for k in _SCALES if part.is_Pow]
        angles = [k * part.args[0] for k in _SCALES if part.is_Function]
        changes += [("half angle", part, part.func(angle)) for angle in angles]
        is_common = sum(entry.has(part) for entry in formula) >= limits.most_wrong
        for kind, before, after in changes if is_common else ():
            words = f"{before} should be {after} in all entries ({CHANGES[kind]})"
            after = after if before == part else after**2
            yield Repair(kind, words, formula.xreplace({part: after}))
    yield from (halved(formula, angle) for angle in known.symbols_in(formula)[0])


def halved(formula: sp.ImmutableMatrix, *angles: sp.Symbol) -> Repair:
    """The change of some angles into half of them, unless their names say that they are."""
    halves = {a: a / 2 for a in angles if patterns.whole_angle.fullmatch(a.name)}
    before, after = (", ".join(map(str, each)) for each in (halves, halves.values()))
    words = f"{before} should be {after} in all entries ({CHANGES['half angle']})"
    return Repair("half angle", words, formula.xreplace(halves))


def _changes(formula: sp.ImmutableMatrix) -> Iterator[Repair]:
    """Changes of all entries together.

    Angles are not changed as a whole: their conventions include transposes, orders and senses.
    """
    for words, (kind, factor) in WHOLE.items() if not known.are_angles(formula) else ():
        changed = formula.T if kind == "transpose" else sp.Rational(factor) * formula
        yield Repair(kind, words, changed)


def _shifted(formula: sp.ImmutableMatrix) -> Iterator[tuple[str, sp.ImmutableMatrix]]:
    """(words, formula): the formula without numbers that are added to its entries."""
    numbers = [e.as_independent(*e.free_symbols, as_Add=True)[0] for e in formula]
    if formula.shape == (3, 1) and any(numbers):  # the declination, or gravity
        entries = " and ".join(str(k) for k, number in enumerate(numbers, 1) if number)
        yield f"without the number added in entry {entries}", formula - sp.Matrix(numbers)


def _ways(formula: sp.ImmutableMatrix) -> Iterator[tuple[str, sp.ImmutableMatrix]]:
    """(words, formula): other ways of writing a formula, which a program may mean."""
    if formula.shape == (3, 3):  # by columns, or for rows of rates
        yield "transposed", formula.T
    yield from _shifted(formula)
    values = known.sample(formula)
    for symbol in values:
        functions = formula.atoms(sp.sin, sp.cos, sp.tan)
        own = {f for f in functions if f.has(symbol)}
        names = {s for f in own for s in f.free_symbols}
        # A factor in one angle of a vector is one in all of them, and nowhere else.
        rest = formula.xreplace({f: sp.Dummy() for f in own})
        if own and (rest.has(symbol) or any(names & f.free_symbols for f in functions - own)):
            continue
        angles = [f.args[0] for f in own if f.args[0] != symbol]  # which is no factor of itself
        # A factor of a whole matrix may be a vector that is not read, unless it is called a scale.
        is_open = formula.cols == 1 or patterns.scale.fullmatch(symbol.name)
        if scaled := sp.Matrix(angles or [*formula] * bool(is_open)):
            is_factor = not any((part / symbol).has(symbol) for part in scaled)
            twice = known.evaluated(scaled, {**values, symbol: 2 * values[symbol]})
            if is_factor or known.near(twice, 2 * known.evaluated(scaled, dict(values))).all():
                yield f"up to the factor {symbol}", formula.xreplace({symbol: sp.S.One})


def _parts(formula: sp.ImmutableMatrix) -> Iterator[tuple[str, Any, sp.ImmutableMatrix]]:
    """("p, q, r", part, changed): the terms with an angular velocity, and their sign changed.

    The others are torques in Euler's equations, and corrections in rates of a quaternion.
    """
    if formula.shape not in ((3, 1), (4, 1), (3, 3)) or formula.has(sp.Function):
        return
    sign = 1 if formula.rows == 3 else -1  # of what is quadratic in ω, or linear
    names = tuple((s, s.name) for s in sorted(formula.free_symbols, key=str))
    for w in chain.from_iterable(known.grouped(names)):
        if len(w) != 3 or not all(e.has(*w) and e.is_polynomial(*w) for e in formula):
            continue
        others = formula.xreplace(dict.fromkeys(w, sp.S.Zero))
        parts = [m - others for m in (formula, formula.xreplace({s: -s for s in w}))]
        own, opposite = (known.evaluated(part, known.sample(formula)) for part in parts)
        if any(others) and known.near(own, sign * opposite).all():
            part = sp.ImmutableMatrix(parts[0].expand())
            # In m (d² 1 − d dᵀ), whose trace is 2 m d², only d dᵀ may have the wrong sign.
            double = part.trace() / 2 * sp.eye(3) if formula.cols == 3 else sp.zeros(*part.shape)
            yield ", ".join(map(str, w)), part, others + double - part


def _nearest(trials: Sequence[_Trial], least: float, expected: Sequence[str] = ()) -> list[Reading]:
    """The readings of which this share of all entries is right, the best first."""
    readings, unusual = list[Reading](), list[Reading]()
    for trial in trials:
        # With one angle, a mirror is as near as the rotation.
        least_odd = 1 - 2 / len(trial.formula) if len(trial.formula.free_symbols) > 1 else 2
        odd = [any(known.oddness(x) > 1 for x in each.values()) for each in trial.names]
        share = trial.agreement.all(axis=2).mean(axis=(-2, -1))
        has_other = np.array([*map(known.has_other_scalar, trial.names)], bool)[:, None]
        unusual += trial.readings(has_other & (share >= least_odd))  # if no other is near
        share = np.where(has_other, -1, share)
        readings += trial.readings(share >= np.where(odd, least_odd, least)[:, None])
        if trial.formula.shape == (3, 1):  # two of three entries exchanged: one is right
            for order in ([1, 0, 2], [2, 1, 0], [0, 2, 1]):
                exchanged = trial.compared(trial.numbers[..., order, :])
                readings += trial.readings(exchanged.all(axis=(2, 3, 4)))

    def rank(each: Reading) -> tuple[Any, ...]:
        odd = sum(map(known.oddness, each.names.values()))
        is_other = each.goal.axes not in (expected or ["z y x"])
        return -each.is_right.mean(), odd, len(each.goal.ways), is_other

    return sorted(readings or unusual, key=rank)


def _decided(
    formula: sp.ImmutableMatrix, trials: Sequence[_Trial], asked: KnownQuantity | None
) -> Comparison | None:
    """What is known without a look at single entries."""
    # The negative of a reflection may be the wanted rotation. If it is not, det = −1 is the
    # finding, and no repair of entries is looked for.
    if formula.shape == (3, 3) and known.is_mirror(formula):
        return Comparison(formula=formula, asked=asked, is_reflection=True)
    for trial in (each for each in trials if not each.family[0].is_numeric):
        is_right: Any = trial.agreement.all(axis=(3, 4))
        for some in trial.readings(is_right[..., : known.NEAR_POINTS].all(axis=2)):
            # No change makes it right for all angles. The point of the smallest angles where the
            # formula is wrong:
            points = {name: some.values[name] for name in sorted(some.names, key=str)}
            sizes = np.abs([*points.values()]).max(axis=0)
            place = int(np.where(some.agreement.all(axis=(1, 2)), np.inf, sizes).argmin())
            example = ", ".join(f"{name} = {value[place]:.4g}" for name, value in points.items())
            wrong = Comparison(formula=formula, asked=asked, counterexample=example)
            return replace(wrong, found=some.goal, names=some.names)
    return None


# Branches at poles and for small angles


def branch(regular: Comparison, own: Formula, each: Formula) -> Comparison | None:
    """A formula beside the right one of another branch; None if it is not compared."""
    goal, runs, names = regular.found, each.conditions_beside(own), {*regular.names}
    if goal is None or regular.form or [f.shape for f in each.forms[:1]] != [goal.matrix.shape]:
        return None
    is_small, case = goal.rotation in known.OF_VECTORS[:2], replace(regular, formula=each.forms[0])
    # Runs without conditions that are not read, such as a flag. If there are others, at least the
    # conditions of all runs hold.
    certain = [run for run in runs if all(c.free_symbols <= names for c in run)]
    least = certain if len(certain) == len(runs) else [frozenset.intersection(*runs)]
    with suppress(ExpressionError):  # a name without a value
        if all(runs) and all(least) and (is_small or goal.quantity == ANGLES):
            return (_small_angles if is_small else _at_poles)(case, goal, least, certain)
    return None


def holds(case: Comparison, own: Formula) -> bool:
    """Whether a formula is right wherever its conditions hold, as an arc tangent for x > 0."""
    runs, goal = own.conditions_beside(Formula(lines=(0,), name="")), case.found
    if goal is None or not all(runs):
        return False
    values = known.named(case.names, dict(goal.points))
    right = known.near(goal.numbers(case.formula, values), goal.values)
    with suppress(ExpressionError):  # a name without a value
        is_there = _truth(runs, values)
        return bool(is_there.any() and right[is_there].all())
    return False


def domain(value: Any) -> str:
    """A remark on arc sines and cosines of what no program has bounded."""
    arcs = (f for f in value.atoms(sp.asin, sp.acos) if f.args[0].func.__name__ != "clamp")
    name = min((str(f.func) for f in arcs), default="")
    return name and f"{name} {REMARKS['domain']}"


def _truth(runs: Sequence[frozenset[sp.Expr]], values: known.Values) -> NDArray[np.bool_]:
    """Where all conditions of a run hold, or nearly; raises ExpressionError for other names."""
    numbers = (known.evaluated(sp.Matrix([[*run]]), {**values}) for run in runs)
    return np.any([(each >= -1e-6).all(axis=(1, 2)) for each in numbers], axis=0)


def _at_poles(case: Comparison, goal: KnownQuantity, runs: Any, certain: Any) -> Comparison | None:
    """Whether the angles of a branch belong to the rotations for which it is taken.

    Far from a pole, a fixed angle, such as 0 or ±π/2, is wrong. At a pole, one of two angles may
    have any value. Two points beside it, almost at the same rotation, tell how the other follows.
    """
    turn = known.target(goal.rotation, QUATERNION)

    def at(*angles: Array) -> known.Values:
        q = known.evaluated(turn.matrix, dict(zip(turn.inputs["q"], angles, strict=True)))[..., 0].T
        q[1:] *= -1 if "of_transpose" in goal.ways else 1
        return known.named(case.names, dict(zip(goal.inputs["q"], q, strict=True)))

    first, last = known.TABLE[0, :2]
    side = np.repeat([1, -1], known.POINTS // 2)
    pole = (side + (len({*goal.rotation}) == 2)) * np.pi / 2  # of proper Euler angles 0 and π
    distance = np.tile(np.linspace(1.25, 0.25, known.POINTS // 2), 2)  # a pole ends at 14°
    exact, turned = at(first, pole, last), at(first + 1, pole, last - 1)
    sign = np.where(abs(sum(exact[x] * turned[x] for x in goal.inputs["q"])) > 0.999, 1, -1)
    beside, far = at(first, pole - 1e-7 * side, last), at(first, pole - side * distance, last)
    is_beside = _truth(runs, beside) & ~_truth(runs, far).any()
    here, is_there = (far, wide) if (wide := _truth(certain, far)).any() else (beside, is_beside)
    own, right = (goal.numbers(m, here)[..., 0] for m in (case.formula, goal.matrix))
    same = goal.numbers(goal.matrix, at(first + 1, pole - 1e-7 * side, last - sign))[..., 0]
    # 1 and ±1, and 0 of the middle angle
    changes = np.round(np.angle(same / right)) * (here is beside)
    # Where both arguments of an arc tangent vanish, rounding decides. If two angles are so, as in
    # the formula beside the poles, they are not compared; one that is so makes the sum wrong.
    squares = [[a.args[0] ** 2 + a.args[1] ** 2 for a in e.atoms(sp.atan2)] for e in case.formula]
    sizes = known.evaluated(sp.Matrix([sp.Mul(*each) for each in squares]), here)[..., 0]
    is_fixed = np.array([here is beside or len({*angle.round(6)}) < 3 for angle in own.T])
    is_any = (~(sizes > 1e-9) | np.isnan(own)) & is_fixed
    free = int((abs(changes[0]) - is_any[is_there].any(axis=0) / 2).argmax())
    wanted = right * ((own / right)[:, [free]] ** changes[:, [free]]) ** changes
    # the middle angle, whatever the others
    is_odd = (changes == 0) & ~is_any & (abs(own - right) > 1e-3) & is_fixed
    is_sure, is_off = is_any.sum(axis=1) < 2, is_any | (abs(own - wanted) > 1e-3) & is_fixed
    is_wrong = is_there & (is_odd.any(axis=1) | is_sure & is_off.any(axis=1))
    if not is_wrong.any():
        # the conditions are false where an arc sine in all of them has no value
        arcs = sorted({domain(c) for run in runs for c in run})
        words = "; ".join(["is right at a pole (gimbal lock)", *arcs * all(arcs)])
        remark = replace(case, branch=words)
        return remark if (is_sure & is_beside).any() else None
    k = is_wrong.argmax()
    place = (int(is_off[k].argmax()) + 1, 1)
    angles = np.round(np.angle([right[k], own[k], wanted[k]]), 4) + 0.0
    angles[1 : 3 - is_sure[k], is_any[k]] = np.nan
    words = "for the rotation by {} it gives {}, right is {}".format(*map(tuple, angles.tolist()))
    words += " if the other formula is right" * ("opposite" in "".join(goal.ways))
    where = "at a pole (gimbal lock)" if here is beside else "far from the poles"
    return replace(case, branch=where, counterexample=words.replace("nan", "any"), place=place)


def _small_angles(case: Comparison, goal: KnownQuantity, runs: Any, _: Any) -> Comparison | None:
    """To which order a polynomial agrees with the true function, by their powers along a line."""
    q, count = goal.inputs["q"], known.POINTS

    def at(size: Array) -> known.Values:
        line = [n / 7 * size ** (not q[3:]) for n in (2, 3, 6)]
        return known.named(case.names, dict(zip(q, [*line, size], strict=False)))

    is_there = _truth(runs, at(np.repeat([1e-12, 1.0], count // 2)))
    circle = at(np.exp(2j * np.pi * np.arange(count) / count) / 2)
    scale = 2.0 ** np.arange(count).reshape(-1, 1, 1) / count
    values = np.stack([known.evaluated(m, circle) for m in (case.formula, goal.matrix)])
    own, true = (np.fft.fft(values, axis=1) * scale).round(9)
    if not is_there[0] or is_there[-1] or own[count // 2 :].any():
        return None
    # -q is the same rotation
    own = -own if goal.quantity == QUATERNION and (own[0] * true[0]).real.sum() < 0 else own
    is_other = ~np.isclose(own, true, rtol=1e-3)[: count // 2]
    # A series may end early, in each of its parts, but not before its first term.
    is_wrong = is_other & (own[: count // 2] != 0)
    is_wrong[0] = is_other[0]
    if not is_wrong.any():
        order = np.append(is_other.any(axis=(1, 2)), True).argmax() - 1
        return replace(case, branch=f"agrees to order {order} for small angles")
    k, i, j = map(int, np.argwhere(is_wrong)[0])
    place = (i + 1, j + 1)
    terms = (f"{x[k, i, j].real + 0:.4g}" + f"*x^{k}" * bool(k) for x in (own, true))
    line = "axis (2, 3, 6)/7 and the angle x" if q[3:] else "vector (2, 3, 6)*x/7"
    entry = place if case.formula.cols > 1 else i + 1
    words = "with the {}, entry {} has the term {}, right is {}".format(line, entry, *terms)
    return replace(case, branch="for small angles", counterexample=words, place=place)


def _proved(
    reading: Reading, asked: KnownQuantity | None = None, repairs: Sequence[Repair] = ()
) -> Comparison:
    """The comparison, with the proof that the repaired formula is what was found."""
    unknown = Comparison(formula=reading.formula, asked=asked)
    found, changed = reading.goal, repairs[-1].formula if repairs else reading.formula
    comparison = replace(unknown, found=found, names=reading.names, repairs=tuple(repairs))
    if found.is_numeric:
        return comparison
    try:
        theirs = changed.xreplace(dict(reading.names))
        return replace(comparison, is_proved=found.motion.equality(theirs, found.matrix).is_exact)
    except DerivationError:  # it is false, although the numbers agree
        return unknown
    except (AlgebraError, ModelError):  # the ring cannot hold it
        return comparison


# Single entries


def entry_repairs(reading: Reading) -> list[Repair]:
    """One change in each wrong entry, one after the other; none if there are too many."""
    formula, changed, goal = reading.formula, reading.formula.as_mutable(), reading.goal
    if formula.shape != goal.matrix.shape:
        return []
    wrong = [(int(i), int(j)) for i, j in np.argwhere(~reading.is_right)]
    places = [(i + 1, j + 1) for i, j in wrong]  # counted from 1, as people do
    called = places if formula.cols > 1 else [row for row, _ in places]
    # Two exchanged entries are one mistake, not two.
    if len(wrong) == 2:
        one, two = wrong
        changed[one], changed[two] = formula[two], formula[one]
        if reading.agrees(changed, goal.values):
            words, fixed = "entries {} and {} are exchanged".format(*called), changed.as_immutable()
            return [Repair("exchange", words, fixed, places[0])]
    if len(wrong) > min(limits.most_wrong, max(1, len(formula) // 3)):
        return []
    repairs: list[Repair] = []
    changed = formula.as_mutable()
    for entry, place, where in zip(wrong, places, called, strict=True):
        kind, changed[entry] = _entry(reading, entry)
        words = f"entry {where}: {formula[entry]} should be {changed[entry]}"
        words += f" ({CHANGES[kind]})" if kind in CHANGES else ""
        repairs.append(Repair(kind, words, changed.as_immutable(), place, changed[entry]))
    return repairs


def _entry(reading: Reading, place: tuple[int, int]) -> tuple[str, sp.Expr]:
    """The smallest change of an entry; the entry of the target if no small one is enough."""
    goal, before = reading.goal, reading.formula[place]
    wanted = goal.values[:, [place[0]], [place[1]]][:, None]
    is_short = before.count_ops() <= limits.most_operations
    turns = sorted(reading.formula.atoms(*_SWAPPED), key=str)
    changes = set(variants(before, [*reading.names], turns)) if is_short else set()
    kinds = [*CHANGES]
    least = sorted(changes, key=lambda v: (kinds.index(v[0]), v[1].count_ops(), str(v[1])))
    for kind, after in least:
        with suppress(ExpressionError):  # a change without real values, such as 1/0, is no repair
            if reading.agrees(sp.Matrix([[after]]), wanted):
                return kind, after
    # No single change is enough: the entry of the goal is written in the names of the formula.
    own = dict[sp.Expr, sp.Expr]()
    for symbol, meant in reading.names.items():
        angle = known.input_in(meant)
        sign = meant.coeff(angle)  # of an angle in the other sense, or from another axis
        own[angle] = sign * (symbol - (meant - sign * angle))
    return "entry", goal.matrix[place].xreplace(own)


_SWAPPED = {sp.sin: sp.cos, sp.cos: sp.sin}
_OTHERS = {**_SWAPPED, sp.asin: sp.acos, sp.acos: sp.asin}
_SCALES = (sp.Rational(1, 2), sp.Integer(2))


def variants(
    e: sp.Expr, names: Sequence[sp.Symbol], turns: Sequence[sp.Expr] = (), *, inside: bool = False
) -> Iterator[tuple[str, sp.Expr]]:
    """(kind, changed expression) for each single change of an expression, or `inside` an angle.

    A factor that is missing is one of the sines and cosines `turns`.
    """
    for place, part in enumerate(e.args[: 1 if e.is_Pow else None]):
        for kind, changed in variants(part, names, turns, inside=inside or e.func in _SWAPPED):
            yield kind, e.func(*e.args[:place], changed, *e.args[place + 1 :])
            if e.is_Pow and e.exp == 2:  # x y, mistyped as x x: one of two equal factors
                yield kind, part * changed
    if e.is_Mul and e.args[0].is_even:  # two equal terms that have become one
        half = variants(e / 2, names, turns, inside=inside)
        yield from ((kind, e / 2 + changed) for kind, changed in half if kind == "index")
    if e.is_Mul and e.has(sp.Abs):  # √(2 x²), of x² + y²
        yield from ((kind, sp.sqrt(changed)) for kind, changed in variants(e**2, names, turns))
    factors, (number, others) = e.args if e.is_Mul else (), e.as_coeff_Add()
    scales = (*_SCALES, *(1 / factor for factor in factors if factor.is_number))
    sums, is_square = ((e, 0), (others, number)), e.is_Pow and e.exp == 2
    are_squares = e.is_Add and all(term.as_coeff_Mul()[1].is_Pow for term in e.args)
    changes: dict[str, list[sp.Expr]] = {
        "sign": [-e, *[number - others, others - number] * bool(number and others)],
        "index": [s for s in names if e.is_Symbol and s != e],
        # y² - z² that has become y² - y², and cos θ sin θ/cos θ
        "cancelled": [e + a**2 - b**2 for a, b in permutations(names, 2) if are_squares],
        "half angle" if inside else "factor": [k * x + y for k in scales for x, y in sums],
        "term": [e - term for term in e.args if e.is_Add],
        "product": [e / factor for factor in factors if not factor.is_number],
        "sine and cosine": [_OTHERS[e.func](*e.args)] if e.func in _OTHERS else [],
        "arguments": [sp.atan2(*e.args[::-1])] if e.func == sp.atan2 else [],
        "square": [e.base] if is_square else [e**2] * bool(e.is_Function or e.is_Symbol),
    }
    if e.func == sp.atan:  # or atan2, if the second argument is positive
        above, below = e.args[0].as_numer_denom()
        yield from variants(sp.atan2(above, below, evaluate=False), names, turns)
        changes["quadrant"] = [sp.atan2(sign * above, sign * below) for sign in (1, -1)]
    if not inside:
        changes["quotient"] = [e * turn**k for turn in turns for k in (2, -2)]
        changes["cancelled"] += [e * turn / _SWAPPED[turn.func](*turn.args) for turn in turns]
        changes["quotient"] += [1 / e] * (e.is_Pow and abs(e.exp) == sp.S.Half)  # 1/s for s
        changes["product"] += [] if e.is_Add else [e * turn for turn in turns]
    yield from ((kind, changed) for kind in changes for changed in changes[kind])
