"""Where polynomials in sines and cosines vanish, and where the rank of a matrix of them falls.

Common zeros are solved factor by factor, or not at all.

A factor is solved if it is the sine or the cosine of a rational multiple of one coordinate (or
of the length n of all of them), 1 plus or minus such a cosine, or a sum of multiples of the two
whose squares add up to a known square. Some forms are recognised as never zero. Several polynomials
are solved one after the other, and the zeros of each are substituted into the others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.generators import TIME, angle_of
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Monomial
from rigidsym.algebra.shorten import shortest
from rigidsym.errors import AlgebraError, ModelError

_QUARTERS = {0: (0, 1), 1: (1, 0), 2: (0, -1), -1: (-1, 0)}  # quarter turns: sine, cosine


class Place(NamedTuple):
    """A coordinate, or the length of all of them, at one value, over and over again.

    The values are value + k period for all whole k; of a length, which is never negative, for
    k = 0, 1, 2, ... alone.
    """

    coordinate: sp.Expr
    value: sp.Expr  # of an angle in (−period/2, period/2]; of a length the least, above zero
    period: sp.Expr  # 2π, a multiple of it where parts of the angle are turned by, or π
    is_length: bool = False


class Root(NamedTuple):
    """One coordinate at one value, and the values of the generators there."""

    place: Place
    becomes: tuple[tuple[int, Any], ...]  # generator: a whole number, or an element of the ring
    order: tuple[int, float, str]  # by coordinates and values; symbols by their text


Zero = tuple[Root, ...]  # all of them at once


class _Angle(NamedTuple):
    """The sine and the cosine of a fraction of one coordinate, or of the length of all."""

    sine: int
    cosine: int
    fraction: sp.Rational
    coordinate: sp.Expr
    is_length: bool


def substituted(element: PolyElement, zero: Zero) -> PolyElement:
    """The element at a zero, not in normal form."""
    becomes = [pair for root in zero for pair in root.becomes]
    if all(isinstance(value, int) for _, value in becomes):
        return _with_numbers(element, becomes)
    result = element.ring.zero
    for monomial, coefficient in element.items():
        powers, factor = list(monomial), element.ring.one
        for place, value in becomes:
            factor *= value ** powers[place]
            powers[place] = 0
        result += element.ring.term_new(tuple(powers), coefficient) * factor
    return result


def _with_numbers(element: PolyElement, becomes: Sequence[tuple[int, int]]) -> PolyElement:
    terms: dict[Monomial, Any] = {}
    for monomial, coefficient in element.items():
        powers = list(monomial)
        for place, value in becomes:
            coefficient *= value ** powers[place]
            powers[place] = 0
        rest = tuple(powers)
        terms[rest] = terms.get(rest, 0) + coefficient
    return element.new({monomial: c for monomial, c in terms.items() if c})


@lru_cache(maxsize=256)
def matrix_at(matrix: RingMatrix, zero: Zero) -> RingMatrix:
    """The matrix at a zero."""
    places = [place for root in zero for place, _ in root.becomes]
    if not any(monomial[k] for entry in matrix.entries for monomial in entry for k in places):
        return matrix
    return RingMatrix.of(matrix.ring, [[substituted(e, zero) for e in row] for row in matrix.rows])


class Stratum(NamedTuple):
    """A zero at which the rank of a matrix falls, the matrix there, and its rank."""

    zero: Zero
    matrix: RingMatrix
    rank: int


class FallingRank:
    """The rank of a matrix over a ring, and the zeros at which it falls.

    `bound` are rows of the matrix: the derivatives of `constraints` by the coordinates. Zeros at
    which these cannot hold do not count.
    """

    def __init__(
        self,
        codec: Codec,
        coordinates: tuple[sp.Expr, ...],
        matrix: RingMatrix,
        *,
        bound: RingMatrix | None = None,
        constraints: tuple[sp.Expr, ...] = (),
        name: str,
    ) -> None:
        self.codec, self.solver = codec, solver_for(codec, coordinates)
        self._bound, self._constraints, self._name = bound, constraints, name
        self.bound_rank = bound.rank_and_minors()[0] if bound is not None else 0
        self.rank, self.minors = matrix.rank_and_minors()
        self.strata: list[Stratum] = []
        self.is_solved = self._search(matrix, (), self.rank, self.minors)

    def _search(
        self, matrix: RingMatrix, zero: Zero, rank: int, minors: Sequence[PolyElement]
    ) -> bool:
        """Enter the zeros at which the rank falls, and further on those at which it falls again.

        Whether these are all.
        """
        if not rank or any(minor.is_ground for minor in minors):
            return True
        if len(minors) > 1 and self.solver.is_never_zero(self.sum_of_squares(minors)):
            return True
        zeros, is_solved = self.solver.common(minors)
        for more in zeros:
            whole = (*zero, *more)
            is_allowed = self._is_allowed(whole)
            if not is_allowed:
                is_solved = is_solved and is_allowed is False
                continue
            there = matrix_at(matrix, more)
            full, smaller = there.rank_and_minors(rank - 1)
            self.strata.append(Stratum(whole, there, full))
            is_solved = self._search(there, whole, full, smaller) and is_solved
        return is_solved

    def sum_of_squares(self, minors: Sequence[PolyElement]) -> PolyElement:
        return self.codec.ring.dot((minor, minor) for minor in minors)

    def _is_allowed(self, zero: Zero) -> bool | None:
        """Whether the conditions on the coordinates can hold at a zero; None if nothing tells.

        Nothing is told of points at which the conditions touch and leave more rates free.
        """
        relations = (substituted(relation, zero) for relation in self.codec.ring.relations)
        if any(relation.is_ground and relation for relation in relations):
            return False
        bound = self._bound
        if bound is not None and matrix_at(bound, zero).rank_and_minors()[0] < self.bound_rank:
            return None
        if not any(c.has(root.place.coordinate) for c in self._constraints for root in zero):
            return True
        places = tuple(root.place.coordinate - root.place.value for root in zero)
        try:
            configurations(self._name, (*self._constraints, *places), ())
        except ModelError:
            return None
        return True


@lru_cache(maxsize=32)
def solver_for(codec: Codec, coordinates: tuple[sp.Expr, ...]) -> Solver:
    """The solver of one ring, shared like the ring itself."""
    return Solver(codec, coordinates)


class Solver:
    """The common zeros of elements of one ring; remembers the roots that it has found."""

    def __init__(self, codec: Codec, coordinates: Sequence[sp.Expr]) -> None:
        self._codec = codec
        self._ring = codec.ring
        self._angles = tuple(self._found(coordinates))
        self._known: dict[PolyElement, list[Root] | None] = {}
        self.missing: set[sp.Expr] = set()  # roots of numbers that the ring would need for more
        self._constant = {
            place for place, gen in enumerate(self._ring.generators) if not gen.expression.has(TIME)
        }

    def _found(self, coordinates: Sequence[sp.Expr]) -> Iterator[_Angle]:
        length = length_of(coordinates)
        for sine, cosine in self._codec.angle_pairs:
            argument = self._ring.generators[sine].expression.args[0]
            fraction, coordinate = argument.as_coeff_Mul()
            if coordinate == length or coordinate in coordinates:
                yield _Angle(sine, cosine, fraction, coordinate, coordinate == length)

    def common(self, elements: Iterable[PolyElement]) -> tuple[list[Zero], bool]:
        """The common zeros of the elements, and whether all were found."""
        found: dict[frozenset[Root], Zero] = {}
        is_complete = self._search(list(elements), (), found)
        zeros = [zero for key, zero in found.items() if not any(other < key for other in found)]
        return sorted(zeros, key=lambda zero: sorted(root.order for root in zero)), is_complete

    def is_never_zero(self, element: PolyElement) -> bool:
        """Whether the form of an element tells that it vanishes nowhere."""
        return element.is_ground or self._roots(shortest(self._ring, element)) == []

    def _search(
        self, elements: Sequence[PolyElement], zero: Zero, found: dict[frozenset[Root], Zero]
    ) -> bool:
        """Enter the common zeros that have the roots of `zero` already; whether these are all."""
        left = self._left(elements, zero)
        if not left:
            found[frozenset(zero)] = zero
            return True
        if any(element.is_ground for element in left):
            return True
        solved = [roots for element in left if (roots := self._roots(element)) is not None]
        if not solved:
            return False
        is_complete = True
        for root in min(solved, key=len):
            is_complete &= self._search(left, (*zero, root), found)
        return is_complete

    def _left(self, elements: Sequence[PolyElement], zero: Zero) -> list[PolyElement]:
        """The elements that are not zero yet, in short forms, each once."""
        last = zero[-1:]
        there = (self._ring.reduce(substituted(e, last)) if last else e for e in elements)
        left = list(dict.fromkeys(element for element in there if element))
        if any(element.is_ground for element in left):
            return left  # never zero
        return list(dict.fromkeys(shortest(self._ring, element) for element in left))

    def _roots(self, element: PolyElement) -> list[Root] | None:
        """The zeros of one element; None if some factor is not solved."""
        roots: dict[Root, None] = {}
        for factor in _factors(element):
            if factor not in self._known:
                self._known[factor] = self._roots_of_factor(factor)
            found = self._known[factor]
            if found is None:
                return None
            roots.update(dict.fromkeys(found))
        return list(roots)

    def _roots_of_factor(self, factor: PolyElement) -> list[Root] | None:
        if self._is_reciprocal(factor) or _is_positive(factor) or self._is_constant(factor):
            return []
        used = [
            angle for angle in self._angles if any(m[angle.sine] or m[angle.cosine] for m in factor)
        ]
        if len(used) != 1:
            return None
        (angle,) = used
        for quarters, element in self._simple(angle):
            if factor.monic() == element:
                return [
                    root
                    for turn in quarters
                    for root in self._rooted(angle, sp.Rational(turn, 2) * sp.pi, _QUARTERS[turn])
                ]
        return self._of_sum(factor, angle) or self._never(factor, angle)

    def _simple(self, angle: _Angle) -> Iterator[tuple[tuple[int, ...], PolyElement]]:
        """The factors that vanish only at quarter turns, and these quarter turns."""
        sine, cosine = self._ring.generator(angle.sine), self._ring.generator(angle.cosine)
        yield from (((0, 2), sine), ((-1, 1), cosine), ((0,), cosine - 1), ((2,), cosine + 1))
        yield from (((1,), sine - 1), ((-1,), sine + 1))

    def _is_reciprocal(self, factor: PolyElement) -> bool:
        """Whether it is 1/d for a d of the ring: their product is one, so that it is never zero."""
        for place, generator in enumerate(self._ring.generators):
            if factor.monic() == self._ring.generator(place):
                expression = generator.expression
                return bool(expression.is_Pow and expression.exp.is_negative)
        return False

    def _is_constant(self, factor: PolyElement) -> bool:
        """Whether it holds only constants of the model, which are assumed not to make it zero."""
        return all(
            place in self._constant or not power
            for monomial in factor
            for place, power in enumerate(monomial)
        )

    def _never(self, factor: PolyElement, angle: _Angle) -> list[Root] | None:
        """No roots, if a polynomial in one sine and cosine has none by Sturm's theorem."""
        others = {angle.sine, angle.cosine}
        if any(power and k not in others for m in factor for k, power in enumerate(m)):
            return None
        if any(monomial[angle.sine] > 1 for monomial in factor):
            factor = self._ring.reduce(factor)
        c = sp.Symbol("c")
        parts = [sp.S.Zero, sp.S.Zero]  # a + b sin, by powers of the cosine
        for monomial, coefficient in factor.items():
            if monomial[angle.sine] > 1:
                return None
            number = sp.Rational(int(coefficient.numerator), int(coefficient.denominator))
            parts[monomial[angle.sine]] += number * c ** monomial[angle.cosine]
        norm = sp.Poly(parts[0] ** 2 - (1 - c**2) * parts[1] ** 2, c)
        return [] if norm.count_roots(-1, 1) == 0 else None

    def _of_sum(self, factor: PolyElement, angle: _Angle) -> list[Root] | None:
        """Roots of A cos + B sin, with constant A and B: cos = ±B/N, sin = ∓A/N, N² = A² + B²."""
        parts = self._weights(factor, angle)
        if parts is None:
            return None
        above, beside = parts
        square = self._ring.reduce(above**2 + beside**2)
        if not square.is_ground:
            return None
        root = sp.sqrt(self._codec.decode(square))
        try:
            cosine, sine = (
                self._codec.encode(self._codec.decode(part) / root) for part in (beside, -above)
            )
        except AlgebraError:
            self.missing.add(root)
            return None
        value = self._codec.decode
        return [
            root
            for s, c in ((sine, cosine), (-sine, -cosine))
            for root in self._rooted(angle, angle_of(value(s), value(c)), (s, c))
        ]

    def _weights(
        self, factor: PolyElement, angle: _Angle
    ) -> tuple[PolyElement, PolyElement] | None:
        """A and B of A cos + B sin; None for any other factor."""
        sums = {angle.cosine: self._ring.zero, angle.sine: self._ring.zero}
        for monomial, coefficient in factor.items():
            moving = [k for k, power in enumerate(monomial) if power and k not in self._constant]
            if len(moving) != 1 or moving[0] not in sums or monomial[moving[0]] != 1:
                return None
            rest = (*monomial[: moving[0]], 0, *monomial[moving[0] + 1 :])
            sums[moving[0]] += factor.ring.term_new(rest, coefficient)
        return sums[angle.cosine], sums[angle.sine]

    def _rooted(
        self, angle: _Angle, value: sp.Expr, sine_and_cosine: tuple[Any, Any]
    ) -> Iterator[Root]:
        """The coordinates within one period whose multiple is the value, up to whole turns."""
        becomes = tuple(zip((angle.sine, angle.cosine), sine_and_cosine, strict=True))
        turns, times = int(angle.fraction.q), int(angle.fraction.p)
        period = 2 * sp.pi * turns
        for k in range(times):
            coordinate = (value + 2 * sp.pi * k) / angle.fraction
            if coordinate.is_number:
                coordinate = _placed(coordinate, period, is_length=angle.is_length)
            place = Place(
                coordinate=angle.coordinate,
                value=coordinate,
                period=period,
                is_length=angle.is_length,
            )
            size = float(coordinate) if coordinate.is_number else 0.0
            yield Root(place, becomes, (self._angles.index(angle), size, str(coordinate)))


def length_of(coordinates: Sequence[sp.Expr]) -> sp.Expr:
    return sp.sqrt(sp.Add(*(coordinate**2 for coordinate in coordinates)))


def _placed(value: sp.Expr, period: sp.Expr, *, is_length: bool) -> sp.Expr:
    """The same angle in (−period/2, period/2]; of a length, which is not negative, above zero."""
    lowest = 0 if is_length else -period / 2
    return value - period * (sp.ceiling((value - lowest) / period) - 1)


def _factors(element: PolyElement) -> list[PolyElement]:
    """The irreducible factors that are not numbers; a product of generators needs no search."""
    if len(element) == 1:
        (powers,) = element
        return [gen for gen, power in zip(element.ring.gens, powers, strict=True) if power]
    return [factor for factor, _ in element.factor_list()[1]]


def _is_positive(factor: PolyElement) -> bool:
    """Whether it is a number and squares, all of one sign."""
    signs = {coefficient > 0 for coefficient in factor.values()}
    is_even = all(power % 2 == 0 for monomial in factor for power in monomial)
    return len(signs) == 1 and is_even and any(not any(monomial) for monomial in factor)
