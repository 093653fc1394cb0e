"""Sentences on where the rates fail, and what is lost there, for the note and the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import prod

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import (
    Derivation,
    Markup,
    Measure,
    Place,
    Singularities,
    Singularity,
)
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.notes.document.document import Text
from rigidsym.notes.formula.formula import markup
from rigidsym.notes.formula.notation import Notation, notation_of
from rigidsym.notes.prose.words import equal, listed, vector, words

_MOST_POINTS = 8  # that are told of one by one
_FRAMES = (SPACE.matrix, BODY.matrix)
WITH_CONDITIONS = Markup(r"\mathbf{J}", "J")
_WHOLE_TURN = 2 * sp.pi
_COUNTED = Markup(r"k = 1, 2, \ldots", "k = 1, 2, …")


def measured(found: Singularities) -> tuple[Markup, ...]:
    """What is worked out in both frames: det W and det W′, det (W Wᵀ), ..."""
    match found.measure:
        case "det W":
            return tuple(fill(r"\det {0}", "det {0}", matrix) for matrix in _FRAMES)
        case "det [W, J]":
            stacked = r"\det\begin{{pmatrix}}{0}\\{1}\end{{pmatrix}}"
            return tuple(fill(stacked, "det [{0}; {1}]", m, WITH_CONDITIONS) for m in _FRAMES)
        case "det W Wᵀ":
            product = (r"\det\left({0}{1}\right)", "det({0} {1})")
            return tuple(fill(*product, matrix, transpose_of(matrix)) for matrix in _FRAMES)
        case "det Wᵀ W":
            product = (r"\det\left({1}{0}\right)", "det({1} {0})")
            return tuple(fill(*product, matrix, transpose_of(matrix)) for matrix in _FRAMES)
    return (Markup(rf"\Sigma_{{{found.rank}}}", f"Σ{found.rank}"),)


def meaning(found: Singularities) -> Text:
    """What the determinant is, before it is written out."""
    sentences: dict[Measure, Text] = {
        "det W": ("Both rate matrices have the determinant",),
        "det [W, J]": words(
            "Below the rate matrix stand the rows {} by which the conditions bind the rates; the "
            "determinant of the whole is",
            WITH_CONDITIONS,
        ),
        "det W Wᵀ": (
            "The rate matrix is wider than it is high; its rank falls where all its largest "
            "minors vanish, the squares of which add up to",
        ),
        "det Wᵀ W": (
            "The rate matrix is higher than it is wide; its rank falls where all its largest "
            "minors vanish, the squares of which add up to",
        ),
        "minors": (
            f"The squares of the minors of rank {found.rank} of the rate matrix, and of the rows "
            "by which conditions bind the rates, add up to",
        ),
    }
    return sentences[found.measure]


def failures(derivation: Derivation, found: Singularities) -> Iterator[Text]:
    """All that is said of them: where, and then what is lost at each point."""
    notation = notation_of(derivation.arguments, model=derivation.model)
    yield _zeros(found, notation)
    yield from (singular(point, derivation) for point in found.points[:_MOST_POINTS])
    more = len(found.points) - _MOST_POINTS
    if more > 0:
        yield (f"At the other {more} points the like is lost; the record lists them.",)


def _zeros(found: Singularities, notation: Notation) -> Text:
    """Where the determinant vanishes, as far as that was decided."""
    if found.determinant is None:
        return ("The rates follow without any divisor, so that they fail nowhere.",)
    points = [point for point in found.points if point.places]
    if points:
        where, period = _where(points, notation), _period(points, notation)
        unknown = "; where else it vanishes was not decided"
        only = ", and nowhere else" if found.is_solved else unknown
        return (*where, *period, only, *_not_at_zero(points, notation), ".")
    if not found.rank:
        return ("The rates of the coordinates turn nothing.",)
    if not found.is_solved:
        return ("Where it vanishes was not decided: no closed form for that is known here.",)
    unless = ", unless the constants make it zero" if _has_constants(found.determinant) else ""
    if found.rank == 3:
        return (f"It never vanishes{unless}: the rates always follow from the angular velocity.",)
    return (
        f"It never vanishes{unless}: the rank is {found.rank} everywhere, which is how many "
        "directions of the angular velocity can be reached.",
    )


def _has_constants(determinant: sp.Expr) -> bool:
    """Whether a factor holds constants of the model and nothing that moves."""
    return any(
        factor.free_symbols and not factor.atoms(AppliedUndef)
        for factor in sp.Mul.make_args(determinant)
    )


def _where(points: Sequence[Singularity], notation: Notation) -> Text:
    """It vanishes at θ = 0 and θ = π; or, of several coordinates, where they have these values."""
    values: dict[sp.Expr, dict[sp.Expr, None]] = {}
    for place in (place for point in points for place in point.places):
        values.setdefault(place.coordinate, {})[place.value] = None
    is_grid = len(points) == prod(map(len, values.values()))
    if len(values) == 1 or not is_grid:
        return ("It vanishes at ", *listed([_at(point, notation) for point in points]))
    choices: list[Text] = [
        (markup(coordinate, notation), " is ", *listed(_markups(several, notation), " or "))
        for coordinate, several in values.items()
    ]
    return ("It vanishes where ", *listed(choices))


def _markups(values: Iterable[sp.Expr], notation: Notation) -> list[Text]:
    return [(markup(value, notation),) for value in values]


def _at(point: Singularity, notation: Notation) -> Text:
    """θ = 0 and ψ = π/2."""
    return listed([_place(place, notation) for place in point.places])


def _place(place: Place, notation: Notation) -> Text:
    coordinate = markup(place.coordinate, notation)
    if not place.is_length:
        return (equal(coordinate, markup(place.value, notation)),)
    step = markup(place.period, notation)
    if place.value == place.period:
        return (equal(coordinate, fill("{0} k", "{0} k", step)), " with ", _COUNTED)
    first = markup(place.value - place.period, notation)
    return (equal(coordinate, fill("{0} + {1} k", "{0} + {1} k", first, step)), " with ", _COUNTED)


def _period(points: Sequence[Singularity], notation: Notation) -> Text:
    """Up to whole turns, or up to how many of them."""
    periods = {p.coordinate: p.period for point in points for p in point.places if not p.is_length}
    if not periods:
        return ()
    longer = {q: period for q, period in periods.items() if period != _WHOLE_TURN}
    if not longer:
        return (", up to whole turns",)
    multiples: list[Text] = [
        words("multiples of {} for {}", markup(period, notation), markup(q, notation))
        for q, period in longer.items()
    ]
    others: list[Text] = [("whole turns",)] if len(longer) < len(periods) else []
    return (", up to ", *listed([*others, *multiples]))


def _not_at_zero(points: Sequence[Singularity], notation: Notation) -> Text:
    """Of a length, which could be taken to be such a place where it is nothing."""
    lengths = {p.coordinate for point in points for p in point.places if p.is_length}
    zero = [equal(markup(length, notation), Markup("0", "0")) for length in lengths]
    return words("; at {} it does not", *zero) if zero else ()


def singular(point: Singularity, derivation: Derivation) -> Text:
    """What is lost at a singular point, and what remains determined."""
    notation = notation_of(derivation.arguments, model=derivation.model)
    head = ("At ", *_at(point, notation), " ") if point.places else ("Everywhere ",)
    if not point.rank:
        return (*head, "no rates turn the body.")
    return (*head, *_determined(point, derivation, notation), *_lost(point, notation), ".")


def _determined(point: Singularity, derivation: Derivation, notation: Notation) -> Text:
    idle = point.undetermined
    coordinates = derivation.argument("q").symbols
    if not all(entry.is_number for entry in idle):
        moved = [q for q, row in zip(coordinates, idle.tolist(), strict=True) if any(row)]
        names = listed([(markup(q, notation),) for q in moved])
        if len(moved) < len(coordinates):
            return ("the rates of ", *names, f" are not determined: the rank is {point.rank}")
        return (f"the rate matrix has rank {point.rank}",)
    kept = determined(point, coordinates, derivation.argument("q_dot").symbols)
    turning_nothing = listed([vector(column, notation) for column in idle.T.tolist()])
    verb = "is" if len(kept) == 1 else "are"
    names = listed([(markup(combination, notation),) for combination in kept])
    only: Text = ("only ", *names, f" {verb} determined; ") if kept else ()
    return (*only, "rates in proportion to ", *turning_nothing, " turn nothing")


def determined(
    point: Singularity, coordinates: Sequence[sp.Expr], rates: Sequence[sp.Expr]
) -> list[sp.Expr]:
    """The combinations that rates which turn nothing leave as they are, but for the fixed ones.

    They are those of the coordinates where such rates stay at the point: R is then the same all
    along. Where they leave it, only rates are determined, and the combinations are those of rates.
    """
    if not all(entry.is_Rational for entry in point.undetermined):
        return []
    fixed = {place.coordinate for place in point.places}
    leaves = any(
        any(row)
        for q, row in zip(coordinates, point.undetermined.tolist(), strict=True)
        if q in fixed
    )
    named = rates if leaves else coordinates
    kept = sp.Matrix(point.undetermined.T).nullspace()
    found = (sp.Add(*(n * q for n, q in zip(_whole(row), named, strict=True))) for row in kept)
    return [combination for combination in found if combination not in fixed]


def _whole(row: sp.MatrixBase) -> list[sp.Expr]:
    """The multiples of a row of fractions that are as small as can be, the first above zero."""
    common = sp.ilcm(*(entry.q for entry in row))
    sign = next(entry for entry in row if entry).could_extract_minus_sign()
    return [-common * entry if sign else common * entry for entry in row]


def _lost(point: Singularity, notation: Notation) -> Text:
    if point.reached is not None:
        return (", and rates turn the body about ", *vector(point.reached, notation), " alone")
    if point.lost_space is None or point.lost_body is None:
        return ()
    return (
        ", and no rates turn the body about ",
        *vector(point.lost_space, notation),
        " in space, that is ",
        *vector(point.lost_body, notation),
        " in the body",
    )
