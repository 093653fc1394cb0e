"""Sentences on singular orientations and gimbal lock, for the note and the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from math import prod, radians, sin

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.formula.letters import TIME
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.tree import Formula, Numeral, Symbol
from rigidsym.mechanics.derivation import (
    Derivation,
    Measure,
    Place,
    Singularities,
    Singularity,
)
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.notes.document.document import Code, Draft, Text, listed, written
from rigidsym.notes.formula.derivation_letters import letters_of
from rigidsym.notes.prose.rotation_words import are_euler_angles

_AT_ONE_DEGREE = round(1 / sin(radians(1)))  # the determinant of Euler angles is a sine or cosine
_MOST_POINTS = 8  # that are told of one by one
_MOST_PLACES = 2  # of one point that are repeated
WITH_CONDITIONS = formula(r"\mathbf{J}")
_BOTH = r"\det\begin{pmatrix}#1\\#2\end{pmatrix}"
_MEASURED: dict[Measure, tuple[Formula, ...]] = {
    "det W": (formula(r"\det #1", SPACE.matrix), formula(r"\det #1", BODY.matrix)),
    "det [W, J]": (
        formula(_BOTH, SPACE.matrix, WITH_CONDITIONS),
        formula(_BOTH, BODY.matrix, WITH_CONDITIONS),
    ),
    "det W Wᵀ": (
        formula(r"\det(#1#1^{\mathsf T})", SPACE.matrix),
        formula(r"\det(#1#1^{\mathsf T})", BODY.matrix),
    ),
    "det Wᵀ W": (
        formula(r"\det(#1^{\mathsf T}#1)", SPACE.matrix),
        formula(r"\det(#1^{\mathsf T}#1)", BODY.matrix),
    ),
}
_MEANING: dict[Measure, Text] = {
    "det W": ("Both rate matrices have the determinant",),
    "det [W, J]": sentence(
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
}
_HALVES = {sp.pi / 2, -sp.pi / 2}
_CONFINED = {1: "a line", 2: "a plane"}
_WHOLE_TURN = 2 * sp.pi
_COUNT = sp.Symbol("k")
_COUNTED = formula(r"k = 1, 2, \ldots")


def singular_title(derivation: Derivation) -> str:
    """The heading of these sentences."""
    found = derivation.singularities
    is_lock = found is not None and len(derivation.model.turns) > 1 and bool(found.points)
    return "Singular orientations (gimbal lock)" if is_lock else "Singular orientations"


def measured(found: Singularities) -> tuple[Formula, ...]:
    """What is worked out in both frames: det W and det W′, det (W Wᵀ), ..."""
    return _MEASURED.get(found.measure) or (Symbol("Σ", index=Numeral(str(found.rank))),)


def meaning(found: Singularities) -> Text:
    """What the determinant is, before it is written out."""
    return _MEANING.get(found.measure) or (
        f"The rate matrix, with the rows by which conditions bind the rates, has rank "
        f"{found.rank} as long as the following sum of the squares of its minors does not vanish:",
    )


def failures(derivation: Derivation, found: Singularities) -> list[Text]:
    """All that is said of them: where, and then what is lost at each point."""
    letters = letters_of(derivation.arguments, model=derivation.model)
    return written(_failures(derivation, found), letters)


def singular(point: Singularity, derivation: Derivation) -> Text:
    """What is lost at a singular point, and what remains determined."""
    letters = letters_of(derivation.arguments, model=derivation.model)
    return written([_singular(point, derivation)], letters)[0]


def _failures(derivation: Derivation, found: Singularities) -> Iterator[Draft]:
    yield _zeros(found, derivation)
    yield from _geometry(derivation)
    if len(found.points) == 1 and len(found.points[0].places) > _MOST_PLACES:
        yield ("There ", *_loss(found.points[0], derivation.model.coordinates))
        return
    yield from (_singular(point, derivation) for point in found.points[:_MOST_POINTS])
    more = len(found.points) - _MOST_POINTS
    if more > 0:
        yield (f"The other {more} singular points are listed in the JSON record.",)


def _zeros(found: Singularities, derivation: Derivation) -> Draft:
    """Where the determinant vanishes, as far as that was decided."""
    if found.determinant is None and not found.is_solved:
        return (
            "The rates are not determined where the axes of all turns lie in one plane. For this "
            "many turns such orientations are not listed; the function ",
            Code("singularity_margin"),
            " is 0 there.",
        )
    if found.determinant is None and not found.minors:
        return ("The rates follow without any divisor, so that there is no singular orientation.",)
    points = [point for point in found.points if point.places]
    if points:
        where, period = _where(found, points)
        more = "" if found.is_solved else "; other zeros were not determined"
        return (*where, *period, more, *_not_at_zero(points), ".")
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


def _where(found: Singularities, points: Sequence[Singularity]) -> tuple[Draft, Draft]:
    """It vanishes at θ = 0 and θ = π, or where several coordinates have values; the period."""
    values: dict[sp.Expr, dict[sp.Expr, None]] = {}
    for place in (place for point in points for place in point.places):
        values.setdefault(place.coordinate, {})[place.value] = None
    only = "only " if found.is_solved else ""
    what = "It vanishes" if found.determinant else "The axes of all turns lie in one plane"
    is_grid = len(points) == prod(map(len, values.values()))
    if len(values) == 1 or not is_grid:
        multiples = _multiples(values) if found.is_solved else ()
        if multiples:
            return multiples, ()
        at = listed([_at(point) for point in points])
        return (f"{what} {only}at ", *at), _period(points)
    alike: dict[tuple[sp.Expr, ...], list[sp.Expr]] = {}
    for coordinate, several in values.items():
        alike.setdefault(tuple(several), []).append(coordinate)
    choices: list[Draft] = [
        (
            *_listed(coordinates),
            " are " if len(coordinates) > 1 else " is ",
            *_listed(several, " or "),
        )
        for several, coordinates in alike.items()
    ]
    return (f"{what} {only}where ", *listed(choices)), _period(points)


def _multiples(values: Mapping[sp.Expr, Iterable[sp.Expr]]) -> Draft:
    """It vanishes only where θ is a multiple of π; empty for other zeros."""
    (angle, zeros), *_ = values.items()
    for found, multiple in (({sp.S.Zero, sp.pi}, "a multiple"), (_HALVES, "an odd multiple")):
        if set(zeros) == found and len(values) == 1:
            unit = sp.pi if sp.pi in found else sp.pi / 2
            return ("It vanishes only where ", angle, f" is {multiple} of ", unit)
    return ()


def _listed(values: Iterable[sp.Expr], last: str = " and ") -> Draft:
    return listed([(value,) for value in values], last)


def _at(point: Singularity) -> Draft:
    """θ = 0 and ψ = π/2."""
    return listed([_place(place) for place in point.places])


def _place(place: Place) -> Draft:
    if not place.is_length:
        return (sp.Eq(place.coordinate, place.value, evaluate=False),)
    value = place.value + place.period * (_COUNT - 1)
    equation = sp.Eq(place.coordinate, sp.expand(value), evaluate=False)
    return (equation, " with ", _COUNTED)


def _period(points: Sequence[Singularity]) -> Draft:
    """Modulo 2π, or a multiple of it."""
    periods = {p.coordinate: p.period for point in points for p in point.places if not p.is_length}
    if not periods:
        return ()
    if len(set(periods.values())) == 1:
        return (", modulo ", *set(periods.values()))
    longer = {q: period for q, period in periods.items() if period != _WHOLE_TURN}
    multiples: list[Draft] = [(period, " for ", q) for q, period in longer.items()]
    others: list[Draft] = [(_WHOLE_TURN,)] if len(longer) < len(periods) else []
    return (", modulo ", *listed([*others, *multiples]))


def _not_at_zero(points: Sequence[Singularity]) -> Draft:
    """Of a length, which could be taken to be such a place where it is nothing."""
    lengths = dict.fromkeys(p.coordinate for point in points for p in point.places if p.is_length)
    zero = [sp.Eq(length, 0, evaluate=False) for length in lengths]
    return ("; at ", *zero, " it does not") if zero else ()


def _singular(point: Singularity, derivation: Derivation) -> Draft:
    head = ("At ", *_at(point), " ") if point.places else ("Everywhere ",)
    return (*head, *_loss(point, derivation.model.coordinates))


@lru_cache(maxsize=64)  # a page repeats its note
def _loss(point: Singularity, coordinates: tuple[sp.Expr, ...]) -> Draft:
    if not point.rank:
        return ("the body does not turn, whatever the rates are.",)
    return (*_determined(point, coordinates), *_lost(point), ".")


def _determined(point: Singularity, coordinates: tuple[sp.Expr, ...]) -> Draft:
    idle = point.null_rates
    if not all(entry.is_number for entry in idle):
        moved = [q for q, row in zip(coordinates, idle.tolist(), strict=True) if any(row)]
        if len(moved) < len(coordinates):
            undetermined = f" are not determined: the rank is {point.rank}"
            return ("the rates of ", *_listed(moved), undetermined)
        return (f"the rate matrix has rank {point.rank}",)
    kept = determined(point, coordinates)
    verb = "is" if len(kept) == 1 else "are"
    only: Draft = ("only ", *_listed(kept), f" {verb} determined: ") if kept else ()
    return (*only, *_idle(idle, coordinates), " the body at rest")


def _idle(idle: sp.MatrixBase, coordinates: Sequence[sp.Expr]) -> Draft:
    """Changing φ and ψ by opposite amounts leaves; or rates proportional to (1, 2, 0) leave."""
    columns = idle.T.tolist()
    moved = [(q, n) for q, n in zip(coordinates, columns[0], strict=True) if n]
    if len(columns) == 1 and len(moved) == 2 and abs(moved[0][1]) == abs(moved[1][1]):
        how = "equal" if moved[0][1] == moved[1][1] else "opposite"
        return ("changing ", moved[0][0], " and ", moved[1][0], f" by {how} amounts leaves")
    if len(columns) == 1 and len(moved) == 1:
        return ("changing ", moved[0][0], " leaves")
    return ("rates proportional to ", *listed([_vector(c) for c in columns]), " leave")


def determined(point: Singularity, coordinates: Sequence[sp.Expr]) -> list[sp.Expr]:
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
    named = [q.diff(TIME) for q in coordinates] if leaves else coordinates
    kept = sp.Matrix(point.null_rates.T).nullspace()
    found = (sp.Add(*(n * q for n, q in zip(_whole(row), named, strict=True))) for row in kept)
    return [combination for combination in found if combination not in fixed]


def _whole(row: sp.MatrixBase) -> list[sp.Expr]:
    """The multiples of a row of fractions that are as small as can be, the first above zero."""
    common = sp.ilcm(*(entry.q for entry in row))
    sign = next(entry for entry in row if entry).could_extract_minus_sign()
    return [-common * entry if sign else common * entry for entry in row]


def _lost(point: Singularity) -> Draft:
    if point.reachable_axis is not None:
        return (", and the body can only turn about ", *_vector(point.reachable_axis))
    if point.lost_axis_space is None or point.lost_axis_body is None:
        return ()
    return (
        ". No choice of rates yields an angular velocity along ",
        *_vector(point.lost_axis_space),
        " in space, which is ",
        *_vector(point.lost_axis_body),
        " in the body",
    )


def _vector(entries: Iterable[sp.Expr]) -> Draft:
    return ("(", *_listed(entries, ", "), ")")


def _geometry(derivation: Derivation) -> Iterator[Draft]:
    """Why two of three turns lock, and what that means nearby."""
    found, turns = derivation.singularities, derivation.model.turns
    if found is None or not found.points or not are_euler_angles(derivation.model):
        return
    both = (turns[0].angle, " and ", turns[2].angle)
    yield (
        "At these orientations the axes of the first and of the last turn coincide: ",
        *both,
        " turn the body about the same axis, and one degree of freedom is lost. This is gimbal "
        "lock. Nearby, the rates of ",
        *both,
        " needed for a given angular velocity grow like the reciprocal of the determinant: one "
        f"degree away they reach {_AT_ONE_DEGREE} times its magnitude.",
    )
