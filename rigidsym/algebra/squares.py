"""Quadratic forms as a textbook prints them: grouped by their weights, the squares kept.

½ vᵀ M v is written ½A(v₁² + v₂²) + ½C v₃², and not multiplied out; a sum of squares of one weight
in the shortest of the forms that are tried: the squares as they come, multiplied out, or with a
square completed. What was chosen is read back into the ring and must be equal there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import reduce
from itertools import combinations

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.generators import is_time_function
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import Presenter
from rigidsym.algebra.ring import Quotient
from rigidsym.algebra.shorten import shortest
from rigidsym.errors import AlgebraError

_MOST_TERMS = 60  # of a form that is tried multiplied out; longer ones are no textbook's
_HALF = sp.Rational(1, 2)


Powers = dict[sp.Expr, sp.Expr]
Scaled = tuple[sp.Rational, sp.Expr]  # a number apart: SymPy would multiply it into a sum


def half_form(present: Presenter, matrix: RingMatrix, vector: RingMatrix) -> sp.Expr:
    """½ vᵀ M v for a constant symmetric M, (3, 3), and v, (3, 1)."""
    entries = vector.entries
    terms = [
        half_of_squares(present, weight, [entries[k] for k in places])
        for weight, places in _by_weight(matrix).items()
    ]
    for j, k in combinations(range(3), 2):
        if matrix[j, k]:
            products = [matrix[j, k], entries[j], entries[k]]
            terms.append(sp.Mul(*map(present.element, products)))
    value = matrix.ring.dot(zip(entries, (matrix @ vector).entries, strict=True))
    return proved(present, sp.Add(*terms), value, _HALF)


def half_of_squares(
    present: Presenter, weight: PolyElement, elements: Sequence[PolyElement]
) -> sp.Expr:
    """½ times a weight times the sum of the squares of some elements, in the shortest form."""
    kept = squares_kept([present.element(element) for element in elements])
    total = present.ring.dot((element, element) for element in elements)
    number, squares = min(
        [kept, *_multiplied_out(present, total)],
        key=lambda scaled: _length(scaled[1]) + (scaled[0] != 1),
    )
    return sp.Mul(_HALF * number, present.element(weight), squares)


def _by_weight(matrix: RingMatrix) -> dict[PolyElement, list[int]]:
    """Places on the diagonal by their entries; zeros left out."""
    groups: dict[PolyElement, list[int]] = {}
    for k in range(3):
        if matrix[k, k]:
            groups.setdefault(matrix[k, k], []).append(k)
    return groups


def squares_kept(roots: Iterable[sp.Expr]) -> Scaled:
    """The sum of squares of expressions, what all of them share taken out."""
    found = [root.as_content_primitive() for root in roots if root != 0]
    if not found:
        return sp.S.One, sp.S.Zero
    number = reduce(sp.gcd, (abs(content) for content, _ in found))
    powers = [rest.as_powers_dict() for _, rest in found]
    common = reduce(_common, powers)
    rests = [
        sp.Mul(content / number, _product({b: e - common.get(b, 0) for b, e in each.items()}))
        for (content, _), each in zip(found, powers, strict=True)
    ]
    shared = sp.Mul(*(base ** (2 * exponent) for base, exponent in common.items()))
    return number**2, sp.Mul(shared, sp.Add(*(rest**2 for rest in rests)))


def _common(first: Powers, second: Powers) -> Powers:
    return {base: exponent for base, exponent in first.items() if second.get(base) == exponent}


def _product(powers: Powers) -> sp.Expr:
    return sp.Mul(*(base**exponent for base, exponent in powers.items()))


def _multiplied_out(present: Presenter, total: PolyElement) -> Iterator[Scaled]:
    """A sum of monomials, and the same with a square completed, if they are not too long."""
    if not total:
        yield sp.S.One, sp.S.Zero
        return
    short = shortest(present.ring, total) if len(total) <= _MOST_TERMS else total
    if len(short) > _MOST_TERMS:
        return
    yield _monomials(present, short)
    for place in _rates(present):
        yield from _completed(present, total, place)


def _monomials(present: Presenter, element: PolyElement) -> Scaled:
    """The terms as they are, but for the factor that all of them share."""
    terms = [present.codec.decode(element.ring.term_new(m, c)) for m, c in element.items()]
    number = reduce(sp.gcd, (abs(term.as_coeff_Mul()[0]) for term in terms))
    powers = reduce(lambda one, other: tuple(map(min, one, other)), element)
    shared = present.codec.decode(element.ring.term_new(powers, 1))
    return number, sp.Mul(shared, sp.Add(*(term / shared / number for term in terms)))


def _rates(present: Presenter) -> list[int]:
    """Places of the derivatives of the coordinates."""
    generators = present.ring.generators
    return [
        place
        for place, generator in enumerate(generators)
        if generator.expression.is_Derivative and is_time_function(generator.expression)
    ]


def _completed(present: Presenter, total: PolyElement, place: int) -> Iterator[Scaled]:
    """n (r + b)² and the rest, for a rate r whose square has a number n before it."""
    ring = present.ring
    rate = ring.generator(place)
    if max(monomial[place] for monomial in total) != 2:
        return
    number = total.diff(place).diff(place)
    if not number.is_ground or not number:
        return
    twice = total.diff(place) - number * rate  # 2 n b
    if not twice:
        return
    n = sp.Rational(*map(int, _ratio(number))) / 2
    slope = present.quotient(Quotient(ring, ring.reduce(twice), ring.reduce(number)))
    # n (r + b)² = n r² + 2 n b r + (2 n b)²/(4 n)
    square = Quotient(ring, ring.dot([(twice, twice)]), 2 * number)
    rest = Quotient.whole(ring, ring.reduce(_without(total, place))) - square
    head = n * (ring.generators[place].expression + slope) ** 2
    if rest.denominator.is_ground:
        number_below = sp.Rational(*map(int, _ratio(rest.denominator)))
        left = ring.reduce(rest.numerator)
        for scale, tail in _multiplied_out(present, left):
            yield sp.S.One, head + scale / number_below * tail


def _without(element: PolyElement, place: int) -> PolyElement:
    """The terms that do not hold a generator."""
    return element.ring.from_dict({m: c for m, c in element.items() if not m[place]})


def _ratio(ground: PolyElement) -> tuple[int, int]:
    number = ground.LC
    return number.numerator, number.denominator


def _length(expression: sp.Expr) -> int:
    return int(sp.count_ops(expression))


def shortest_of(forms: Iterable[Sequence[sp.Expr]]) -> sp.ImmutableMatrix:
    """Of several lists of entries the one with the fewest operations, as a column."""
    best = min(forms, key=lambda entries: sum(map(_length, entries)))
    return sp.ImmutableMatrix(len(best), 1, list(best))


def proved(
    present: Presenter, form: sp.Expr, value: PolyElement, number: sp.Rational = sp.S.One
) -> sp.Expr:
    """The form, if it equals number · value in the ring; raises AlgebraError if it does not."""
    ring = present.ring
    scaled = Quotient.product(
        ring, [present.codec.encode_quotient(number), Quotient.whole(ring, ring.reduce(value))]
    )
    if not present.codec.encode_quotient(form).equals(scaled):
        raise AlgebraError(f"the form {form} differs from its normal form")
    return form


def agrees(present: Presenter, form: sp.Expr, value: PolyElement) -> bool:
    """Whether the ring knows a form to equal a value."""
    known = Quotient.whole(present.ring, present.ring.reduce(value))
    return present.codec.encode_quotient(form).equals(known)
