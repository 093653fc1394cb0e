"""Where the rate matrix loses rank, which direction is lost, and which rates turn nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from math import ceil
from typing import Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.entire import at_zero, rewriter_for
from rigidsym.algebra.matrix import RingMatrix, Row, cross
from rigidsym.algebra.present import Presenter
from rigidsym.algebra.ring import Monomial
from rigidsym.algebra.shorten import shortest
from rigidsym.mechanics.derivation import Singularities, Singularity

Zero = tuple[sp.Expr, sp.Expr, dict[int, int]]  # coordinate, value, what the generators become


def singularities_of(
    matrix: RingMatrix,
    rotation: RingMatrix,
    presenter: Presenter,
    codec: Codec,
    coordinates: tuple[sp.Expr, ...],
) -> Singularities:
    """The zeros of det W, for a square rate matrix in space components.

    Solved where every factor of the determinant is a number, a reciprocal, the sine or cosine of a
    rational multiple of one coordinate, or sin n, cos n or 1 ± cos n of one coordinate or of the
    length n of all of them; otherwise the determinant is reported and nothing is guessed.
    """
    determinant = matrix.det()
    shown = presenter.element(determinant)
    zeros, is_solved = _zeros(shortest(codec.ring, determinant), codec, coordinates)
    length = _length(coordinates)
    if any(zero[0] == length for zero in zeros):
        is_solved = is_solved and _is_regular_at_zero(shown, codec)
    return Singularities(
        determinant=shown,
        points=tuple(_at(zero, matrix, rotation, presenter) for zero in zeros),
        is_solved=is_solved,
        length=next((zero[0] for zero in zeros if zero[0] == length), None),
    )


@lru_cache(maxsize=128)
def _length(coordinates: tuple[sp.Expr, ...]) -> sp.Expr:
    return sp.sqrt(sp.Add(*(coordinate**2 for coordinate in coordinates)))


def _is_regular_at_zero(determinant: sp.Expr, codec: Codec) -> bool:
    """Whether the determinant is not zero where all coordinates are, by its entire form."""
    rewriter = rewriter_for(codec)
    form = rewriter.rewritten(determinant) if rewriter else None
    return form is not None and bool(at_zero(form) != 0)


def _zeros(
    determinant: PolyElement, codec: Codec, coordinates: tuple[sp.Expr, ...]
) -> tuple[list[Zero], bool]:
    zeros: list[Zero] = []
    is_solved = True
    for factor in _factors(determinant):
        found = _zeros_of_factor(factor, codec, coordinates)
        is_solved = is_solved and found is not None
        zeros.extend(found or ())
    return zeros, is_solved


def _factors(element: PolyElement) -> list[PolyElement]:
    """The irreducible factors that are not numbers; a product of generators needs no search."""
    if len(element) == 1:
        (powers,) = element
        return [gen for gen, power in zip(element.ring.gens, powers, strict=True) if power]
    return [factor for factor, _ in element.factor_list()[1]]


def _zeros_of_factor(
    factor: PolyElement, codec: Codec, coordinates: tuple[sp.Expr, ...]
) -> list[Zero] | None:
    """Zeros of one irreducible factor in (−π, π]; None where they are not known.

    For a length they lie in (0, 2π].
    """
    if _is_reciprocal(factor, codec):
        return []
    length = _length(coordinates)
    for sine, cosine in codec.angle_pairs:
        argument = codec.ring.generators[sine].expression.args[0]
        if argument == length or argument in coordinates:
            turned = _quarter_turns(factor, codec, sine, cosine)
            if turned:
                return [(argument, _placed(turn, argument == length), b) for turn, b in turned]
    for sine, cosine in codec.angle_pairs:
        argument = codec.ring.generators[sine].expression.args[0]
        rate, coordinate = argument.as_coeff_Mul()
        if coordinate not in coordinates or rate.q != 1:
            continue  # sin θ/3 does not vanish again after a whole turn
        for place, other, offset in ((sine, cosine, Fraction(0)), (cosine, sine, Fraction(1, 2))):
            if factor.monic() == codec.ring.generator(place):
                return [
                    (coordinate, sp.Rational(turn) * sp.pi, {place: 0, other: sign})
                    for turn, sign in _half_turns(offset, Fraction(int(rate.p), int(rate.q)))
                ]
    return None


def _is_reciprocal(factor: PolyElement, codec: Codec) -> bool:
    """Whether it is 1/d for a d of the ring: their product is one, so that it is never zero."""
    for place, generator in enumerate(codec.ring.generators):
        if factor.monic() == codec.ring.generator(place):
            expression = generator.expression
            return bool(expression.is_Pow and expression.exp.is_negative)
    return False


def _quarter_turns(
    factor: PolyElement, codec: Codec, sine: int, cosine: int
) -> list[tuple[int, dict[int, int]]]:
    """Quarters of a turn in (−2, 2] at which a factor 1 ± cos n, sin n or cos n vanishes."""
    ring = codec.ring
    quarters = {0: (0, 1), 1: (1, 0), 2: (0, -1), -1: (-1, 0)}
    zeros = {
        ring.generator(cosine) - 1: (0,),
        ring.generator(cosine) + 1: (2,),
        ring.generator(sine): (0, 2),
        ring.generator(cosine): (-1, 1),
    }
    return [
        (turn, dict(zip((sine, cosine), quarters[turn], strict=True)))
        for turn in zeros.get(factor.monic(), ())
    ]


def _placed(quarters: int, is_length: bool) -> sp.Expr:
    """The angle in (−π, π]; of a length, which is no angle below zero, in (0, 2π]."""
    return sp.Rational(quarters + 4 if is_length and quarters <= 0 else quarters, 2) * sp.pi


def _half_turns(offset: Fraction, rate: Fraction) -> Iterator[tuple[Fraction, int]]:
    """(offset + k)/rate in (−1, 1], in half turns, with the ±1 of what does not vanish there."""
    reach = ceil(rate) + 1
    for k in range(-reach, reach + 1):
        turn = (offset + k) / rate
        if -1 < turn <= 1:
            yield turn, -1 if k % 2 else 1


def _at(zero: Zero, matrix: RingMatrix, rotation: RingMatrix, presenter: Presenter) -> Singularity:
    coordinate, value, becomes = zero
    reduce = matrix.ring.reduce
    there = matrix.map(lambda entry: reduce(_substituted(entry, becomes)))
    lost = _normal_to(there.T)
    idle = _normal_to(there)
    rank = 2 if idle is not None else int(any(there.entries))  # less than 3, since det W vanishes
    body = None
    if lost is not None:
        turned = rotation.T @ RingMatrix.column(matrix.ring, lost)
        body = turned.map(lambda entry: _substituted(entry, becomes))
    return Singularity(
        coordinate=coordinate,
        value=value,
        rank=rank,
        lost_space=_presented(lost, matrix, presenter),
        lost_body=None if body is None else presenter.matrix(body),
        undetermined=_presented(idle, matrix, presenter),
        reached=_presented(_line(there) if rank == 1 else None, matrix, presenter),
    )


def _substituted(element: PolyElement, becomes: dict[int, int]) -> PolyElement:
    """The element with some generators replaced by whole numbers."""
    terms: dict[Monomial, Any] = {}
    for monomial, coefficient in element.items():
        powers = list(monomial)
        for place, value in becomes.items():
            coefficient *= value ** powers[place]
            powers[place] = 0
        rest = tuple(powers)
        terms[rest] = terms.get(rest, 0) + coefficient
    return element.new({monomial: c for monomial, c in terms.items() if c})


def _normal_to(matrix: RingMatrix) -> Row | None:
    """A direction at right angles to three rows that span a plane; None where they do not."""
    for u, v in combinations(matrix.rows, 2):
        normal = cross(matrix.ring, u, v)
        if any(normal):
            return _primitive(normal)
    return None


def _line(matrix: RingMatrix) -> Row:
    """The direction of the columns of a matrix of rank one."""
    column = next(row for row in matrix.T.rows if any(row))
    return _primitive([shortest(matrix.ring, entry) for entry in column])


def _primitive(entries: Sequence[PolyElement]) -> Row:
    """The entries without their common factor, the first of them with a plus sign."""
    first, *others = (entry for entry in entries if entry)
    common = first
    for entry in others:
        if not common.is_ground:  # a search that can find nothing
            common = common.gcd(entry)
    common *= 1 if first.LC * common.LC > 0 else -1
    if len(common) == 1:
        (term,) = common.items()
        return tuple(entry.quo_term(term) for entry in entries)
    return tuple(entry.exquo(common) for entry in entries)


def _presented(
    entries: Row | None, matrix: RingMatrix, presenter: Presenter
) -> sp.ImmutableMatrix | None:
    return None if entries is None else presenter.matrix(RingMatrix.column(matrix.ring, entries))
