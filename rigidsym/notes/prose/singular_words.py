"""Sentences on singular orientations and gimbal lock, for the note and the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from math import prod, radians, sin

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.formula.letters import TIME, Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, Numeral, Symbol, equal, transpose_of
from rigidsym.mechanics.derivation import (
    Derivation,
    Measure,
    Place,
    Singularities,
    Singularity,
)
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.notes.document.document import Code, Text, listed, words
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.prose.turn_words import are_euler_angles
from rigidsym.notes.prose.words import vector

_AT_ONE_DEGREE = round(1 / sin(radians(1)))  # the determinant of Euler angles is a sine or cosine
_MOST_POINTS = 8  # that are told of one by one
_MOST_PLACES = 2  # of one point that are repeated
_FRAMES = (SPACE.matrix, BODY.matrix)
WITH_CONDITIONS = formula(r"\mathbf{J}")
_HALVES = {sp.pi / 2, -sp.pi / 2}
_CONFINED = {1: "a line", 2: "a plane"}
_WHOLE_TURN = 2 * sp.pi
_COUNTED = formula(r"k = 1, 2, \ldots")


def singular_title(derivation: Derivation) -> str:
    """The heading of these sentences."""
    found = derivation.singularities
    is_lock = found is not None and len(derivation.model.turns) > 1 and bool(found.points)
    return "Singular orientations (gimbal lock)" if is_lock else "Singular orientations"


def measured(found: Singularities) -> tuple[Formula, ...]:
    """What is worked out in both frames: det W and det W′, det (W Wᵀ), ..."""
    typed = {
        "det W": r"\det #1",
        "det [W, J]": r"\det\begin{pmatrix}#1\\#2\end{pmatrix}",
        "det W Wᵀ": r"\det(#1#3)",
        "det Wᵀ W": r"\det(#3#1)",
    }.get(found.measure)
    if typed is None:
        return (Symbol("Σ", index=Numeral(str(found.rank))),)
    return tuple(formula(typed, m, WITH_CONDITIONS, transpose_of(m)) for m in _FRAMES)


def meaning(found: Singularities) -> Text:
    """What the determinant is, before it is written out."""
    sentences: dict[Measure, Text] = {
        "det W": ("Both rate matrices have the determinant",),
        "det [W, J]": words(
            "The conditions on the coordinates bind the rates by the rows {}. Together with the "
            "rate matrix they have the determinant",
            WITH_CONDITIONS,
        ),
        "det W Wᵀ": (
            "The rate matrix has more columns than rows. It has full rank as long as the "
            "following determinant does not vanish:",
        ),
        "det Wᵀ W": (
            "The rate matrix has more rows than columns. It has full rank as long as the "
            "following determinant does not vanish:",
        ),
        "minors": (
            f"The rate matrix, with the rows by which conditions bind the rates, has rank "
            f"{found.rank} as long as the following sum of the squares of its minors does not "
            "vanish:",
        ),
    }
    return sentences[found.measure]


def failures(derivation: Derivation, found: Singularities) -> Iterator[Text]:
    """All that is said of them: where, and then what is lost at each point."""
    letters = letters_of(derivation.arguments, model=derivation.model)
    yield _zeros(found, derivation, letters)
    if len(found.points) == 1 and len(found.points[0].places) > _MOST_PLACES:
        yield ("There ", *_loss(found.points[0], derivation.model.coordinates, letters))
        return
    yield from (singular(point, derivation) for point in found.points[:_MOST_POINTS])
    more = len(found.points) - _MOST_POINTS
    if more > 0:
        yield (f"The other {more} singular points are listed in the JSON record.",)


def _zeros(found: Singularities, derivation: Derivation, letters: Letters) -> Text:
    """Where the determinant vanishes, as far as that was decided."""
    if found.determinant is None and not found.is_solved:
        return words(
            "The rates are not determined where the axes of all turns lie in one plane. For this "
            "many turns such orientations are not listed; the function {} is 0 there.",
            Code("singularity_margin"),
        )
    if found.determinant is None and not found.minors:
        return ("The rates follow without any divisor, so that there is no singular orientation.",)
    points = [point for point in found.points if point.places]
    if points:
        where, period = _where(found, points, letters)
        more = "" if found.is_solved else "; other zeros were not determined"
        return (*where, *period, more, *_not_at_zero(points, letters), ".")
    if not found.rank:
        return ("The body does not turn, whatever the rates are.",)
    if not found.is_solved:
        return ("Its zeros have no closed form here and were not determined.",)
    if found.determinant is None:
        return ("The axes of all turns never lie in one plane, so there is no singularity.",)
    unless = ", unless the constants make it zero" if _has_constants(found.determinant) else ""
    if found.rank == 3:
        several = "so this parametrisation has no singularity"
        three = "so the singularity that any three coordinates have is at infinity"
        conclusion = three if len(derivation.model.coordinates) == 3 else several
        return (f"It never vanishes{unless}, {conclusion}.",)
    return (
        f"It never vanishes{unless}: the rank is {found.rank} everywhere, and the angular velocity "
        f"is confined to {_CONFINED[found.rank]}.",
    )


def _has_constants(determinant: sp.Expr) -> bool:
    """Whether a factor holds constants of the model and nothing that moves."""
    return any(
        factor.free_symbols and not factor.atoms(AppliedUndef)
        for factor in sp.Mul.make_args(determinant)
    )


def _where(
    found: Singularities, points: Sequence[Singularity], letters: Letters
) -> tuple[Text, Text]:
    """It vanishes at θ = 0 and θ = π, or where several coordinates have values; the period."""
    values: dict[sp.Expr, dict[sp.Expr, None]] = {}
    for place in (place for point in points for place in point.places):
        values.setdefault(place.coordinate, {})[place.value] = None
    only = "only " if found.is_solved else ""
    what = "It vanishes" if found.determinant else "The axes of all turns lie in one plane"
    is_grid = len(points) == prod(map(len, values.values()))
    if len(values) == 1 or not is_grid:
        multiples = _multiples(values, letters) if found.is_solved else ()
        if multiples:
            return multiples, ()
        at = listed([_at(point, letters) for point in points])
        return (f"{what} {only}at ", *at), _period(points, letters)
    alike: dict[tuple[sp.Expr, ...], list[sp.Expr]] = {}
    for coordinate, several in values.items():
        alike.setdefault(tuple(several), []).append(coordinate)
    choices: list[Text] = [
        (
            *listed(_markups(coordinates, letters)),
            " are " if len(coordinates) > 1 else " is ",
            *listed(_markups(several, letters), " or "),
        )
        for several, coordinates in alike.items()
    ]
    return (f"{what} {only}where ", *listed(choices)), _period(points, letters)


def _multiples(values: Mapping[sp.Expr, Iterable[sp.Expr]], letters: Letters) -> Text:
    """It vanishes only where θ is a multiple of π; empty for other zeros."""
    (angle, zeros), *_ = values.items()
    for found, multiple in (({sp.S.Zero, sp.pi}, "a multiple"), (_HALVES, "an odd multiple")):
        if set(zeros) == found and len(values) == 1:
            unit = sp.pi if sp.pi in found else sp.pi / 2
            text = f"It vanishes only where {{}} is {multiple} of {{}}"
            return words(text, formula_of(angle, letters), formula_of(unit, letters))
    return ()


def _markups(values: Iterable[sp.Expr], letters: Letters) -> list[Text]:
    return [(formula_of(value, letters),) for value in values]


def _at(point: Singularity, letters: Letters) -> Text:
    """θ = 0 and ψ = π/2."""
    return listed([_place(place, letters) for place in point.places])


def _place(place: Place, letters: Letters) -> Text:
    coordinate = formula_of(place.coordinate, letters)
    if not place.is_length:
        return (equal(coordinate, formula_of(place.value, letters)),)
    step = formula_of(place.period, letters)
    if place.value == place.period:
        return (equal(coordinate, formula("#1 k", step)), " with ", _COUNTED)
    first = formula_of(place.value - place.period, letters)
    return (equal(coordinate, formula("#1 + #2 k", first, step)), " with ", _COUNTED)


def _period(points: Sequence[Singularity], letters: Letters) -> Text:
    """Modulo 2π, or a multiple of it."""
    periods = {p.coordinate: p.period for point in points for p in point.places if not p.is_length}
    if not periods:
        return ()
    if len(set(periods.values())) == 1:
        return words(", modulo {}", formula_of(*set(periods.values()), letters))
    longer = {q: period for q, period in periods.items() if period != _WHOLE_TURN}
    multiples: list[Text] = [
        words("{} for {}", formula_of(period, letters), formula_of(q, letters))
        for q, period in longer.items()
    ]
    others: list[Text] = [(formula_of(_WHOLE_TURN, letters),)] if len(longer) < len(periods) else []
    return (", modulo ", *listed([*others, *multiples]))


def _not_at_zero(points: Sequence[Singularity], letters: Letters) -> Text:
    """Of a length, which could be taken to be such a place where it is nothing."""
    lengths = {p.coordinate for point in points for p in point.places if p.is_length}
    zero = [equal(formula_of(length, letters), formula("0")) for length in lengths]
    return words("; at {} it does not", *zero) if zero else ()


def singular(point: Singularity, derivation: Derivation) -> Text:
    """What is lost at a singular point, and what remains determined."""
    letters = letters_of(derivation.arguments, model=derivation.model)
    head = ("At ", *_at(point, letters), " ") if point.places else ("Everywhere ",)
    return (*head, *_loss(point, derivation.model.coordinates, letters))


@lru_cache(maxsize=64)  # a page repeats its note
def _loss(point: Singularity, coordinates: tuple[sp.Expr, ...], letters: Letters) -> Text:
    if not point.rank:
        return ("the body does not turn, whatever the rates are.",)
    return (*_determined(point, coordinates, letters), *_lost(point, letters), ".")


def _determined(point: Singularity, coordinates: tuple[sp.Expr, ...], letters: Letters) -> Text:
    idle = point.null_rates
    if not all(entry.is_number for entry in idle):
        moved = [q for q, row in zip(coordinates, idle.tolist(), strict=True) if any(row)]
        names = listed(_markups(moved, letters))
        if len(moved) < len(coordinates):
            return ("the rates of ", *names, f" are not determined: the rank is {point.rank}")
        return (f"the rate matrix has rank {point.rank}",)
    kept = determined(point, coordinates, [q.diff(TIME) for q in coordinates])
    verb = "is" if len(kept) == 1 else "are"
    names = listed(_markups(kept, letters))
    only: Text = ("only ", *names, f" {verb} determined: ") if kept else ()
    return (*only, *_idle(idle, coordinates, letters), " the body at rest")


def _idle(idle: sp.MatrixBase, coordinates: Sequence[sp.Expr], letters: Letters) -> Text:
    """Changing φ and ψ by opposite amounts leaves; or rates proportional to (1, 2, 0) leave."""
    columns = idle.T.tolist()
    moved = [(q, n) for q, n in zip(coordinates, columns[0], strict=True) if n]
    if len(columns) == 1 and len(moved) == 2 and abs(moved[0][1]) == abs(moved[1][1]):
        how = "equal" if moved[0][1] == moved[1][1] else "opposite"
        pair = (formula_of(q, letters) for q, _ in moved)
        return words(f"changing {{}} and {{}} by {how} amounts leaves", *pair)
    if len(columns) == 1 and len(moved) == 1:
        return words("changing {} leaves", formula_of(moved[0][0], letters))
    return ("rates proportional to ", *listed([vector(c, letters) for c in columns]), " leave")


def determined(
    point: Singularity, coordinates: Sequence[sp.Expr], rates: Sequence[sp.Expr]
) -> list[sp.Expr]:
    """The combinations that rates which turn nothing leave as they are, but for the fixed ones.

    They are those of the coordinates where such rates stay at the point: R is then the same all
    along. Where they leave it, only rates are determined, and the combinations are those of rates.
    """
    if not all(entry.is_Rational for entry in point.null_rates):
        return []
    fixed = {place.coordinate for place in point.places}
    leaves = any(
        any(row)
        for q, row in zip(coordinates, point.null_rates.tolist(), strict=True)
        if q in fixed
    )
    named = rates if leaves else coordinates
    kept = sp.Matrix(point.null_rates.T).nullspace()
    found = (sp.Add(*(n * q for n, q in zip(_whole(row), named, strict=True))) for row in kept)
    return [combination for combination in found if combination not in fixed]


def _whole(row: sp.MatrixBase) -> list[sp.Expr]:
    """The multiples of a row of fractions that are as small as can be, the first above zero."""
    common = sp.ilcm(*(entry.q for entry in row))
    sign = next(entry for entry in row if entry).could_extract_minus_sign()
    return [-common * entry if sign else common * entry for entry in row]


def _lost(point: Singularity, letters: Letters) -> Text:
    if point.reachable_axis is not None:
        return (", and the body can only turn about ", *vector(point.reachable_axis, letters))
    if point.lost_axis_space is None or point.lost_axis_body is None:
        return ()
    return (
        ". No choice of rates yields an angular velocity along ",
        *vector(point.lost_axis_space, letters),
        " in space, which is ",
        *vector(point.lost_axis_body, letters),
        " in the body",
    )


def geometry(derivation: Derivation) -> Iterator[Text]:
    """Why two of three turns lock, and what that means nearby."""
    found, turns = derivation.singularities, derivation.model.turns
    if found is None or not found.points or not are_euler_angles(derivation.model):
        return
    letters = letters_of(derivation.arguments, model=derivation.model)
    first, last = (formula_of(turns[k].angle, letters) for k in (0, 2))
    yield words(
        "At these orientations the axes of the first and of the last turn coincide: {} and {} turn "
        "the body about the same axis, and one degree of freedom is lost. This is gimbal lock. "
        "Nearby, the rates of {} and {} needed for a given angular velocity grow like the "
        "reciprocal of the determinant: one degree away they reach "
        f"{_AT_ONE_DEGREE} times its magnitude.",
        *(first, last, first, last),
    )
