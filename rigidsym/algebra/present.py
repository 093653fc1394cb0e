"""From normal form to textbook form, each choice proved equal before it is returned.

A normal form is for deciding, not for reading. The shortest of the equivalent polynomials is sought
(`ring.shortest`), and quotients of sine and cosine become tan and cot. Then

1. `folded`: cos α cos β − sin α sin β is written cos(α + β). Terms come in over the generators of a
   ring and leave over more places: after the generators stand, for every two angles, the cosine and
   sine of their sum and of their difference.
2. `collect`: common factors are taken out, in the order of what they save. Terms are Laurent
   monomials (a negative power divides); the result is a sum of products, each of which may hold a
   sum in turn.
3. Quadratic forms keep their squares: ½ vᵀ M v is written ½A(v₁² + v₂²) + ½C v₃², a sum of squares
   of one weight in the shorter of two forms: the squares as they come, or multiplied out.

What was chosen is read back into the ring, and its difference from the value must reduce to zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import combinations
from math import gcd, lcm
from operator import add, sub
from random import Random
from typing import Any, NamedTuple

import sympy as sp
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.generators import is_sum_of
from rigidsym.algebra.matrix import RingMatrix, Row
from rigidsym.algebra.ring import Monomial, Quotient, shortest, split
from rigidsym.errors import AlgebraError

_SHORT_SUM = 12  # terms of a divisor that is factored, since that is done once for many entries
_PRIME = 2**61 - 1  # modulo which images of polynomials are compared
_MORE_TERMS = 2  # that a sum over one denominator may have; with more it is hardly ever shorter


@lru_cache(maxsize=32)
def presenter_for(codec: Codec) -> Presenter:
    """The presenter of one ring, shared like the ring itself."""
    return Presenter(codec)


class Presenter:
    """Textbook forms of the elements of one ring; remembers what it has presented."""

    def __init__(self, codec: Codec) -> None:
        self.codec = codec
        self.ring = codec.ring
        generators = [gen.expression for gen in self.ring.generators]
        self._sums = rules(codec.angle_pairs, generators)
        self._expressions = _Expressions(generators, self._sums)
        self._weights = _Weights(self._expressions)
        self._sums_below = {
            place: codec.encode(1 / expression)
            for place, expression in enumerate(generators)
            if expression.is_Pow
            and expression.exp == -1
            and expression.base.is_Add
            and sp.sqrt(expression.base) not in self.ring.index  # half powers would divide too
        }
        self._matrices: dict[tuple[tuple[Row, ...], PolyElement], sp.ImmutableMatrix] = {}
        self._products: dict[tuple[Monomial, tuple[FactoredTerm, ...]], sp.Expr] = {}
        self._known: dict[tuple[PolyElement, PolyElement], sp.Expr] = {}
        self._factors: dict[PolyElement, list[tuple[PolyElement, int]]] = {}

    def matrix(
        self, matrix: RingMatrix, denominator: PolyElement | None = None
    ) -> sp.ImmutableMatrix:
        """The matrix, or the matrix divided by `denominator`, entry by entry."""
        below = self.ring.one if denominator is None else denominator
        key = matrix.rows, below
        known = self._matrices.get(key)
        if known is None:
            entries = [self._over(entry, below) for entry in matrix.entries]
            known = sp.ImmutableMatrix(*matrix.shape, entries, copy=False)  # the list is ours
            self._matrices[key] = known
        return known

    def element(self, element: PolyElement) -> sp.Expr:
        """The textbook form of one element."""
        return self.quotient(Quotient.whole(self.ring, self.ring.reduce(element)))

    def quotient(self, value: Quotient) -> sp.Expr:
        """The textbook form of a quotient."""
        return self._over(value.numerator, value.denominator)

    def _over(self, above: PolyElement, below: PolyElement) -> sp.Expr:
        """The textbook form of above / below, both in normal form, proved equal."""
        if not above:
            return sp.S.Zero
        known = self._known.get((above, below))
        if known is None:
            known = self._known[above, below] = self._form(above, below)
            if not self.codec.encode_quotient(known).equals(Quotient(self.ring, above, below)):
                raise AlgebraError(f"the form {known} differs from its normal form")
        return known

    def _form(self, above: PolyElement, below: PolyElement) -> sp.Expr:
        above, below = shortest(self.ring, above), shortest(self.ring, below)
        if len(below) > 1:
            above, below = self._cancelled(above, below)
        if len(below) > 1:
            over, under = _leading_number(above), _leading_number(below)
            number = sp.Rational(*(over / under).as_integer_ratio())
            return sp.Mul(number, self._terms(above, over), 1 / self._terms(below, under))
        if self.ring.is_one(below):
            plain, *others = (self._terms(above), *self._over_one(above))
            return min(plain, *others, key=_length) if others else plain
        ((divisor, scale),) = below.items()
        return self._terms(
            {tuple(map(sub, m, divisor)): c for m, c in above.items()}, _fraction(scale)
        )

    def _cancelled(self, above: PolyElement, below: PolyElement) -> tuple[PolyElement, PolyElement]:
        """Both without their common factors; many entries are divided by one short sum."""
        if len(below) > _SHORT_SUM:
            if not _are_coprime(above, below):
                _, above, below = above.cofactors(below)
            return above, below
        factors = self._factors.get(below)
        if factors is None:
            factors = self._factors[below] = below.factor_list()[1]
        polynomials = below.ring
        plain = polynomials.clone(order=lex)  # in which leading terms are found fastest
        above, below = above.set_ring(plain), below.set_ring(plain)
        for factor, power in factors:
            divisor = factor.set_ring(plain)
            for _ in range(power):
                quotient, rest = above.div(divisor)
                if rest:
                    break
                above, below = quotient, below.exquo(divisor)
        return above.set_ring(polynomials), below.set_ring(polynomials)

    def _over_one(self, element: PolyElement) -> Iterator[sp.Expr]:
        """Terms that are divided by different powers of one sum, over the highest of them."""
        for place, divisor in self._sums_below.items():
            above = split(element, [place])
            if len(above) > 1:
                (highest,) = max(above)
                parts = (part * divisor ** (highest - power) for (power,), part in above.items())
                whole = reduce(add, parts)
                if len(whole) <= len(element) + _MORE_TERMS:
                    number = _leading_number(whole)
                    rational = sp.Rational(number.numerator, number.denominator)
                    below = self._expressions[place] ** highest
                    yield sp.Mul(rational, self._terms(whole, number), below)

    def _terms(self, terms: Mapping[Monomial, Any], scale: Fraction = Fraction(1)) -> sp.Expr:
        numbers = terms
        if scale != 1 or self.ring.polynomials.domain.is_Field:
            numbers = {monomial: _fraction(c) / scale for monomial, c in terms.items()}
        return self._sum(collect(folded(numbers, self._sums), self._weights))

    def _sum(self, products: Sequence[FactoredTerm]) -> sp.Expr:
        return sp.Add(*(self._product(product) for product in products))

    def _product(self, product: FactoredTerm) -> sp.Expr:
        key = product.powers, product.bracket
        factors = self._products.get(key)
        if factors is None:
            powers = list(product.powers)
            parts = self._ratios(powers)
            named = self._expressions
            parts += [named[k] if n == 1 else named[k] ** n for k, n in enumerate(powers) if n]
            if product.bracket:
                parts.append(self._sum(product.bracket))
            factors = self._products[key] = sp.Mul(*parts)
        number = product.coefficient
        if abs(number) == 1:
            return factors if number == 1 else -factors
        return sp.Rational(number.numerator, number.denominator) * factors

    def _ratios(self, powers: list[int]) -> list[sp.Expr]:
        """tan and cot for sines over cosines and the reverse, taken out of `powers`."""
        found = []
        for sine, cosine in self.codec.angle_pairs:
            if powers[sine] * powers[cosine] < 0:
                times = min(abs(powers[sine]), abs(powers[cosine]))
                above = sine if powers[sine] > 0 else cosine
                function = sp.tan if above == sine else sp.cot
                found.append(function(self._expressions[sine].args[0]) ** times)
                powers[above] -= times
                powers[cosine if above == sine else sine] += times
        return found


def _are_coprime(one: PolyElement, other: PolyElement) -> bool:
    """Whether images in each generator, at numbers for the others, have no factor in common.

    The image of a common factor divides both images. So coprime images spare the greatest common
    divisor of hundreds of terms, which takes seconds for the accelerations of a gimbal and is
    nearly always one. If the numbers are unlucky, a common factor stays, and the value is the same.
    """
    numbers, modular = Random(1), one.ring.clone(domain=sp.GF(_PRIME))
    sides = [side.clear_denoms()[1].set_ring(modular) for side in (one, other)]
    point = [(gen, numbers.randrange(1, _PRIME)) for gen in modular.gens]
    for place in range(len(point)):
        if all(side.degree(place) > 0 for side in sides):
            others = point[:place] + point[place + 1 :]
            image, other_image = (side.evaluate(others) for side in sides)
            if image.gcd(other_image).degree() > 0:
                return False
    return True


class Rationals:
    """Quotients over the ring of their numerators and denominators: in (`read`) and out (`write`).

    The ring then needs no generator for the inverse of a sum, so that common factors of numerator
    and denominator are seen and cancel.
    """

    def __init__(self, codec: Codec) -> None:
        self.codec, self.ring = codec, codec.ring

    @classmethod
    def of(cls, expressions: Iterable[sp.Expr], constraints: Iterable[sp.Expr] = ()) -> Rationals:
        """The quotients over a ring that holds some expressions."""
        parts = (part for e in expressions for part in sp.sympify(e, strict=True).as_numer_denom())
        return cls(codec_for(parts, constraints=constraints))

    def read(self, expression: sp.Expr) -> Quotient:
        """Raises AlgebraError for an expression that the ring was not built for."""
        above, below = sp.sympify(expression, strict=True).as_numer_denom()
        return self.codec.encode_quotient(above) * self.codec.encode_quotient(below).inverse()

    def read_matrix(self, matrix: sp.MatrixBase) -> list[list[Quotient]]:
        return [[self.read(entry) for entry in row] for row in matrix.tolist()]

    def write(self, value: Quotient) -> sp.Expr:
        return presenter_for(self.codec).quotient(value)

    def total(self, parts: Iterable[Quotient]) -> Quotient:
        return Quotient.sum(self.ring, parts)


class _Expressions(dict[int, sp.Expr]):
    """The expression at each place of a monomial: generators, then folded sums."""

    def __init__(self, generators: Sequence[sp.Expr], sums: Sequence[Rule]) -> None:
        super().__init__(enumerate(generators))
        self._first = len(generators)
        self._sums = sums

    def __missing__(self, place: int) -> sp.Expr:
        expression = self[place] = self._sums[place - self._first].folded
        return expression


class _Weights(dict[int, int]):
    """Operations in the expression at each place, counted when asked for."""

    def __init__(self, expressions: _Expressions) -> None:
        self._expressions = expressions

    def __missing__(self, place: int) -> int:
        weight = self[place] = int(sp.count_ops(self._expressions[place]))
        return weight


def _length(expression: sp.Expr) -> int:
    return int(sp.count_ops(expression))


def _leading_number(element: PolyElement) -> Fraction:
    """The common factor of the numbers in a sum, with a leading minus.

    The term of the lowest degree leads, so that 1 − cos θ is left and not cos θ − 1.
    """
    lowest = element[min(element, key=lambda monomial: (sum(monomial), monomial))]
    numbers = [_fraction(coefficient) for coefficient in element.values()]
    size = Fraction(
        gcd(*(number.numerator for number in numbers)),
        lcm(*(number.denominator for number in numbers)),
    )
    return -size if lowest < 0 else size


def _fraction(coefficient: Any) -> Fraction:
    """A coefficient of Z or Q, whichever number type SymPy holds it in."""
    return Fraction(int(coefficient.numerator), int(coefficient.denominator))


# Sums of angles and common factors


Angle = tuple[int, int]  # places of sine and cosine
Number = int | Fraction
FoldedTerms = dict[Monomial, Number]


class Rule(NamedTuple):
    """first + sign · second = function(alpha ± beta), for products of two generators."""

    first: tuple[int, int]
    second: tuple[int, int]
    sign: int
    function: type[sp.sin] | type[sp.cos]
    angles: tuple[sp.Expr, sp.Expr]  # α and ±β

    @property
    def folded(self) -> sp.Expr:
        """The function of the sum; SymPy takes long to make one, and few are ever needed."""
        return self.function(sp.Add(*self.angles))


def rules(angles: Sequence[Angle], expressions: Sequence[sp.Expr]) -> tuple[Rule, ...]:
    """The addition theorems of every two angles."""
    found: list[Rule] = []
    for (s, c), (sine, cosine) in combinations(angles, 2):
        alpha, beta = expressions[s].args[0], expressions[sine].args[0]
        if not is_sum_of(alpha + beta, alpha, beta):
            continue  # the angles cancel in part, and the ring has other generators for their sum
        plus, minus = (alpha, beta), (alpha, -beta)
        found += [
            Rule((c, cosine), (s, sine), -1, sp.cos, plus),
            Rule((c, cosine), (s, sine), 1, sp.cos, minus),
            Rule((s, cosine), (c, sine), 1, sp.sin, plus),
            Rule((s, cosine), (c, sine), -1, sp.sin, minus),
        ]
    return tuple(found)


def folded(terms: Mapping[Monomial, Number], found: Iterable[Rule]) -> FoldedTerms:
    """The terms with each pair of an addition theorem made one.

    Places for all rules are added, unless no rule can apply.
    """
    if len(terms) < 2:
        return dict(terms)
    found = tuple(found)
    highest = tuple(map(max, zip(*terms, strict=True)))
    present = {place for place, power in enumerate(highest) if power > 0}
    may = [
        (place, rule)
        for place, rule in enumerate(found, start=len(highest))
        if present.issuperset(rule.first) and present.issuperset(rule.second)
    ]
    if not may:
        return dict(terms)
    result = {(*monomial, *[0] * len(found)): value for monomial, value in terms.items()}
    for place, rule in may:
        a, b = rule.first
        for monomial in list(result):  # it may begin a pair
            if monomial not in result or monomial[a] < 1 or monomial[b] < 1:
                continue
            rest = _times(monomial, rule.first, -1)
            other = _times(rest, rule.second, 1)
            if result.get(other) == rule.sign * result[monomial]:
                value = result.pop(monomial)
                del result[other]
                target = _times(rest, (place,), 1)
                result[target] = result.get(target, 0) + value
    return result


def _times(monomial: Monomial, places: Iterable[int], power: int) -> Monomial:
    changed = list(monomial)
    for place in places:
        changed[place] += power
    return tuple(changed)


Weights = Mapping[int, int]  # place of a generator -> operations that one use of it costs


class FactoredTerm(NamedTuple):
    """coefficient · generators^powers · (sum of the factors in `bracket`, where there is one)."""

    coefficient: Number
    powers: Monomial
    bracket: tuple[FactoredTerm, ...] = ()


def collect(terms: Mapping[Monomial, Number], weights: Weights) -> tuple[FactoredTerm, ...]:
    """The terms as a sum of products with common factors taken out."""
    factor = _best_factor(terms, weights) if len(terms) > 1 else None
    if factor is None:
        return tuple(FactoredTerm(coefficient, powers) for powers, coefficient in terms.items())
    place, sign = factor
    inside = {m: c for m, c in terms.items() if m[place] * sign > 0}
    outside = {m: c for m, c in terms.items() if m[place] * sign <= 0}
    return (_take_out(inside, weights), *(collect(outside, weights) if outside else ()))


def _best_factor(terms: Mapping[Monomial, Number], weights: Weights) -> tuple[int, int] | None:
    """(generator, sign of its power) that saves most, of those that occur in several terms.

    A term saves the factor where its lowest power takes all of it; what is taken out is written
    once. Ties go to the generator that comes first.
    """
    powers: dict[tuple[int, int], list[int]] = {}
    for monomial in terms:
        for place, power in enumerate(monomial):
            if power:
                powers.setdefault((place, 1 if power > 0 else -1), []).append(abs(power))
    savings = {
        key: (found.count(min(found)) - 1) * (weights[key[0]] + 1) for key, found in powers.items()
    }
    best = max(savings, key=lambda key: (savings[key], -key[0]), default=None)
    return best if best and savings[best] else None


def _take_out(terms: Mapping[Monomial, Number], weights: Weights) -> FactoredTerm:
    """All that the terms have in common, times what is left of them."""
    common = reduce(_common_powers, terms)
    values = list(terms.values())
    number = Fraction(
        gcd(*(abs(value.numerator) for value in values)),
        lcm(*(value.denominator for value in values)),
    )
    if all(value < 0 for value in values):  # fewer minus signs are left
        number = -number
    rest = {
        tuple(map(sub, monomial, common)): coefficient if number == 1 else coefficient / number
        for monomial, coefficient in terms.items()
    }
    return FactoredTerm(number, common, collect(rest, weights))


def _common_powers(first: Monomial, second: Monomial) -> Monomial:
    """Powers that both hold, of one sign: numerators with numerators."""
    return tuple(
        (min(a, b) if a > 0 else max(a, b)) if a * b > 0 else 0
        for a, b in zip(first, second, strict=True)
    )


# Quadratic forms


_MOST_TERMS = 60  # of a form that is tried multiplied out; longer ones are no textbook's
_HALF = sp.Rational(1, 2)


def half_form(present: Presenter, matrix: RingMatrix, vector: RingMatrix) -> sp.Expr:
    """½ vᵀ M v for a constant symmetric M, (3, 3), and v, (3, 1)."""
    entries = vector.entries
    by_weight: dict[PolyElement, list[PolyElement]] = {}
    for k in range(3):
        if matrix[k, k]:
            by_weight.setdefault(matrix[k, k], []).append(entries[k])
    terms = [half_of_squares(present, *group) for group in by_weight.items()]
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
    forms = [sp.Add(*(present.element(element) ** 2 for element in elements))]
    total = present.ring.dot((element, element) for element in elements)
    if len(total) <= _MOST_TERMS:
        forms.append(present.element(total))
    return sp.Mul(_HALF, present.element(weight), min(map(sp.factor_terms, forms), key=_length))


def shortest_of(forms: Iterable[Sequence[sp.Expr]]) -> sp.ImmutableMatrix:
    """Of several lists of entries the one with the fewest operations, as a column."""
    best = min(forms, key=lambda entries: sum(map(_length, entries)))
    return sp.ImmutableMatrix(len(best), 1, list(best))


def proved(
    present: Presenter, form: sp.Expr, value: PolyElement, number: sp.Rational = sp.S.One
) -> sp.Expr:
    """The form, if it equals number · value in the ring; raises AlgebraError if it does not."""
    if not agrees(present, form / number, value):
        raise AlgebraError(f"the form {form} differs from its normal form")
    return form


def agrees(present: Presenter, form: sp.Expr, value: PolyElement) -> bool:
    """Whether the ring knows a form to equal a value."""
    known = Quotient.whole(present.ring, present.ring.reduce(value))
    return present.codec.encode_quotient(form).equals(known)
