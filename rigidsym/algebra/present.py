"""From normal form to textbook form, each choice proved equal before it is returned.

The shortest of the equivalent polynomials is sought, common factors are taken out, quotients of
sine and cosine become tan and cot. What was chosen is then read back into the ring, and its
difference from the value must reduce to zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache, reduce
from math import gcd, lcm
from operator import add, sub
from typing import Any

import sympy as sp
from sympy.polys.orderings import lex
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix, Row
from rigidsym.algebra.ring import Monomial, Quotient
from rigidsym.algebra.shorten import FactoredTerm, Rule, collect, folded, rules, shortest
from rigidsym.errors import AlgebraError

_SHORT_SUM = 12  # terms of a divisor that is factored, since that is done once for many entries
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
            if expression.is_Pow and expression.exp == -1 and self._is_plain_sum(expression.base)
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

    def _is_plain_sum(self, expression: sp.Expr) -> bool:
        """Not so a sum whose root is in the ring too: what it divides, half its powers divide."""
        return bool(expression.is_Add and sp.sqrt(expression) not in self.ring.index)

    def _over_one(self, element: PolyElement) -> Iterator[sp.Expr]:
        """Terms that are divided by different powers of one sum, over the highest of them."""
        for place, divisor in self._sums_below.items():
            above = self._by_power(element, place)
            if len(above) > 1:
                highest = max(above)
                parts = (part * divisor ** (highest - power) for power, part in above.items())
                whole = reduce(add, parts)
                if len(whole) <= len(element) + _MORE_TERMS:
                    number = _leading_number(whole)
                    rational = sp.Rational(number.numerator, number.denominator)
                    below = self._expressions[place] ** highest
                    yield sp.Mul(rational, self._terms(whole, number), below)

    def _by_power(self, element: PolyElement, place: int) -> dict[int, PolyElement]:
        """power of a generator: what it multiplies"""
        found: dict[int, PolyElement] = {}
        for monomial, coefficient in element.items():
            part = found.setdefault(monomial[place], self.ring.polynomials.zero)
            part[(*monomial[:place], 0, *monomial[place + 1 :])] = coefficient
        return found

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
            factors = self._products[key] = self._multiplied(*key)
        number = product.coefficient
        if abs(number) == 1:
            return factors if number == 1 else -factors
        return sp.Rational(number.numerator, number.denominator) * factors

    def _multiplied(self, given: Monomial, bracket: Sequence[FactoredTerm]) -> sp.Expr:
        powers = list(given)
        factors = self._ratios(powers)
        factors += [self._power(place, power) for place, power in enumerate(powers) if power]
        if bracket:
            factors.append(self._sum(bracket))
        return sp.Mul(*factors)

    def _power(self, place: int, power: int) -> sp.Expr:
        expression = self._expressions[place]
        return expression if power == 1 else expression**power

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


class Rationals:
    """Quotients over the ring of their numerators and denominators: in (`read`) and out (`write`).

    The ring then needs no generator for the inverse of a sum, so that common factors of numerator
    and denominator are seen and cancel.
    """

    def __init__(self, expressions: Iterable[sp.Expr], constraints: Iterable[sp.Expr] = ()) -> None:
        parts = (part for e in expressions for part in sp.sympify(e, strict=True).as_numer_denom())
        self._take(codec_for(parts, constraints=constraints))

    @classmethod
    def over(cls, codec: Codec) -> Rationals:
        """The quotients over a ring that is there already."""
        made = cls.__new__(cls)
        made._take(codec)
        return made

    def _take(self, codec: Codec) -> None:
        self.codec, self.ring = codec, codec.ring

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
