"""Where polynomials in sines and cosines vanish, and where the rank of a matrix of them falls.

Common zeros are solved factor by factor, or not at all.

The angles are rational multiples of one coordinate, of a sum of coordinates, or of the length n
of all of them. A factor is solved if it holds one sine or cosine to the first or second power, with
numbers, or is A cos + B sin with a number for A² + B², where A and B may hold other coordinates:
sin φ cos θ + cos φ sin θ vanishes where φ is −θ or π − θ. Some forms are recognised as never zero.
Several polynomials are solved one after the other, and the zeros of each are substituted into the
others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from math import prod

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.generators import TIME, added, angle_of, combination, is_identically_zero
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import shortest, split
from rigidsym.errors import AlgebraError
from rigidsym.system.records import NamedTuple


class Place(NamedTuple):
    """A coordinate, or the length of all of them, at one value, over and over again.

    The values are value + k period for all whole k; of a length, which is never negative, for
    k = 0, 1, 2, ... alone.
    """

    coordinate: sp.Expr  # or a sum of coordinates
    value: sp.Expr  # of an angle in (−period/2, period/2]; of a length the least, above zero
    period: sp.Expr  # 2π, a multiple of it where parts of the angle are turned by, or π
    is_length: bool = False


class Root(NamedTuple):
    """One coordinate at one value, and the values of the generators there."""

    place: Place
    becomes: tuple[tuple[int, PolyElement], ...]  # generator: an element of the ring
    order: tuple[int, float, str]  # by coordinates and values; symbols by their text


Zero = tuple[Root, ...]  # all of them at once
Pairs = list[tuple[sp.Expr, sp.Expr]]  # sines and cosines


class _Angle(NamedTuple):
    """The sine and the cosine of fraction · coordinate + offset."""

    sine: int
    cosine: int
    fraction: sp.Rational
    coordinate: sp.Expr  # or a sum of coordinates, or the length of all
    offset: sp.Expr
    is_length: bool


def substituted(element: PolyElement, zero: Zero) -> PolyElement:
    """The element at a zero, not in normal form."""
    pairs = (pair for root in zero for pair in root.becomes)
    becomes = {place: e for place, e in pairs if any(m[place] for m in element)}
    if not becomes:
        return element
    result = element.ring.zero
    for powers, part in split(element, tuple(becomes)).items():
        factors = (value**n for value, n in zip(becomes.values(), powers, strict=True) if n)
        result += prod(factors, start=part)
    return result


def matrix_at(matrix: RingMatrix, zero: Zero) -> RingMatrix:
    """The matrix at a zero."""
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
        example: tuple[tuple[sp.Expr, sp.Expr], ...] = (),
    ) -> None:
        self.codec, self.solver = codec, solver_for(codec, coordinates)
        self._bound, self._constraints, self._example = bound, constraints, dict(example)
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
        # A minor that is a number other than zero keeps the rank at every point.
        if not rank or any(minor.is_ground for minor in minors):
            return True
        # Real minors vanish together exactly where the sum of their squares does; by Cauchy and
        # Binet this sum is det(W Wᵀ). It is often a number although no minor is: sin² θ + cos² θ.
        if len(minors) > 1 and self.solver.is_never_zero(self.sum_of_squares(minors)):
            return True
        zeros, is_solved = self.solver.common(minors)
        for more in zeros:
            whole = (*zero, *more)
            is_allowed = self._is_allowed(whole)
            if not is_allowed:
                is_solved = is_solved and is_allowed is False
                continue
            # On each zero the rank may fall further: at θ = 0 by one, at θ = 0 and φ = 0 by two.
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
        # A relation that becomes a number other than zero, 1 = 0, excludes the point.
        relations = (substituted(relation, zero) for relation in self.codec.ring.relations)
        if any(relation.is_ground and relation for relation in relations):
            return False
        # If the rank of ∂f/∂q falls as well, the point is a singular point of the constraints, and
        # the implicit function theorem says nothing about the rates that are possible there.
        bound = self._bound
        if bound is not None and matrix_at(bound, zero).rank_and_minors()[0] < self.bound_rank:
            return None
        there = {root.place.coordinate: root.place.value for root in zero}
        moving = {atom for pair in there.items() for e in pair for atom in e.atoms(AppliedUndef)}
        if not any(c.has(*moving) for c in self._constraints):
            return True
        there = self._example | there
        return all(is_identically_zero(c.xreplace(there)) for c in self._constraints) or None


class Solver:
    """The common zeros of elements of one ring; remembers the roots that it has found."""

    def __init__(self, codec: Codec, coordinates: Sequence[sp.Expr]) -> None:
        self._codec = codec
        self._ring = codec.ring
        length, angles = length_of(coordinates), []
        for sine, cosine in codec.angle_pairs:
            argument = self._ring.generators[sine].expression.args[0]
            offset, moving = argument.as_independent(*coordinates, as_Add=True)
            fraction, angle = moving.primitive()
            if angle.could_extract_minus_sign():  # as of α − θ
                fraction, angle = -fraction, -angle
            if angle == length or (moving and set(combination(angle)) <= set(coordinates)):
                angles.append(_Angle(sine, cosine, fraction, angle, offset, angle == length))
        self._angles = tuple(angles)
        self._of_factors: dict[PolyElement, list[Root] | None] = {}
        self.missing: set[sp.Expr] = set()  # roots of numbers that the ring would need for more
        self._constant = {
            place for place, gen in enumerate(self._ring.generators) if not gen.expression.has(TIME)
        }

    def common(self, elements: Iterable[PolyElement]) -> tuple[list[Zero], bool]:
        """The common zeros of the elements, and whether all were found."""
        zeros: dict[frozenset[Root], Zero] = {}
        is_complete = self._search(list(elements), (), zeros)
        # A zero with further conditions, θ = 0 and φ = 0, is part of the larger one with fewer,
        # θ = 0.
        least = [zero for key, zero in zeros.items() if not any(other < key for other in zeros)]
        return sorted(least, key=lambda zero: sorted(root.order for root in zero)), is_complete

    def is_never_zero(self, element: PolyElement) -> bool:
        """Whether the form of an element tells that it vanishes nowhere."""
        return element.is_ground or self._roots(shortest(self._ring, element)) == []

    def _search(
        self, elements: Sequence[PolyElement], zero: Zero, zeros: dict[frozenset[Root], Zero]
    ) -> bool:
        """Enter the common zeros that have the roots of `zero` already; whether these are all."""
        last = zero[-1:]
        there = (self._ring.reduce(substituted(e, last)) if last else e for e in elements)
        remaining = list(dict.fromkeys(element for element in there if element))
        if not remaining:
            zeros[frozenset(zero)] = zero
            return True
        if any(element.is_ground for element in remaining):
            return True
        remaining = list(dict.fromkeys(shortest(self._ring, element) for element in remaining))
        solved = [roots for element in remaining if (roots := self._roots(element)) is not None]
        if not solved:
            return False
        # Every common zero is a zero of each element. To branch over the element with the fewest
        # roots keeps the search tree small.
        is_complete = True
        for root in min(solved, key=len):
            is_complete &= self._search(remaining, (*zero, root), zeros)
        return is_complete

    def _roots(self, element: PolyElement) -> list[Root] | None:
        """The zeros of one element; None if some factor is not solved."""
        roots: dict[Root, None] = {}
        # A product vanishes where one of its factors does.
        if len(element) == 1:  # a product of generators needs no search for its factors
            (powers,) = element
            factors = [gen for gen, power in zip(element.ring.gens, powers, strict=True) if power]
        else:
            factors = [factor for factor, _ in element.factor_list()[1]]
        for factor in factors:
            if factor not in self._of_factors:
                self._of_factors[factor] = self._roots_of_factor(factor)
            of_factor = self._of_factors[factor]
            if of_factor is None:
                return None
            roots.update(dict.fromkeys(of_factor))
        return list(roots)

    def _roots_of_factor(self, factor: PolyElement) -> list[Root] | None:
        if self._is_never_zero(factor):
            return []
        used = [a for a in self._angles if any(m[a.sine] or m[a.cosine] for m in factor)]
        for angle in used:
            pairs = self._of_one(factor, angle) if len(used) == 1 else None
            pairs = self._of_sum(factor, angle) if pairs is None else pairs
            if pairs is not None:
                try:
                    elements = [tuple(map(self._codec.encode, pair)) for pair in pairs]
                except AlgebraError:
                    self.missing |= {part for pair in pairs for part in pair}
                    continue
                return [
                    root
                    for pair, becomes in zip(pairs, elements, strict=True)
                    for root in self._rooted(angle, angle_of(*pair), becomes)
                ]
        return None

    def _is_never_zero(self, factor: PolyElement) -> bool:
        """Whether it is 1/d for a d of the ring, holds only constants, or is a sum of squares.

        The constants of a model are assumed not to make it zero.
        """
        used = {place for m in factor for place, power in enumerate(m) if power}
        if used <= self._constant:
            return True
        expressions = [self._ring.generators[place].expression for place in used]
        if len(expressions) == len(factor) == 1:
            return bool(expressions[0].is_Pow and expressions[0].exp.is_negative)
        # Even powers, coefficients of one sign and a constant term: 1 + x² + 3 y⁴ has no real zero.
        signs = {coefficient > 0 for coefficient in factor.values()}
        is_even = all(power % 2 == 0 for monomial in factor for power in monomial)
        return len(signs) == 1 and is_even and self._ring.polynomials.zero_monom in factor

    def _of_sum(self, factor: PolyElement, angle: _Angle) -> Pairs | None:
        """Roots of A cos + B sin with N² = A² + B² a number: cos = ±B/N, sin = ∓A/N.

        A and B may hold other coordinates. None for any other factor.
        """
        parts = split(factor, (angle.cosine, angle.sine))
        if not parts.keys() <= {(1, 0), (0, 1)}:
            return None
        # A cos + B sin = N sin(angle + δ) with N constant has two zeros in each period. N² must be
        # a number: where N = 0, every angle is a zero.
        above, beside = (parts.get(powers, self._ring.zero) for powers in ((1, 0), (0, 1)))
        square = self._ring.reduce(above**2 + beside**2)
        if not square.is_ground:
            return None
        a, b, size = map(self._codec.decode, (above, beside, square))
        sine, cosine = -a / sp.sqrt(size), b / sp.sqrt(size)
        return [(sine, cosine), (-sine, -cosine)]

    def _of_one(self, factor: PolyElement, angle: _Angle) -> Pairs | None:
        """Roots of a polynomial in one sine or one cosine, up to the second degree, or none."""
        element = self._ring.reduce(factor)
        expressions = [generator.expression for generator in self._ring.generators]
        used = {k for m in element for k, power in enumerate(m) if power}
        moving = [k for k in used if not expressions[k].is_number]
        if len(moving) != 1:
            return None
        (place,), x = moving, sp.Dummy("x")
        polynomial = sp.Poly(self._codec.decode(element).xreplace({expressions[place]: x}), x)
        if polynomial.degree() > 2:
            # Without a zero in [−1, 1] no angle is one; roots of cubics are no textbook's values.
            is_rational = all(c.is_Rational for c in polynomial.coeffs())
            return [] if is_rational and not polynomial.count_roots(-1, 1) else None
        pairs: dict[tuple[sp.Expr, sp.Expr], None] = {}
        for value in sp.roots(polynomial):
            # x = cos α has the two solutions sin α = ±√(1 − x²), and likewise for x = sin α.
            if value.is_real and abs(value) <= 1:
                other = sp.sqrt(sp.expand(1 - value**2))
                for beside in (other, -other):
                    pair = (beside, value) if place == angle.cosine else (value, beside)
                    pairs[pair] = None
        return list(pairs)

    def _rooted(
        self, angle: _Angle, value: sp.Expr, sine_and_cosine: tuple[PolyElement, ...]
    ) -> Iterator[Root]:
        """The coordinates within one period whose multiple is the value, up to whole turns."""
        # (p/q) x + δ = value + 2πk gives x = (value − δ + 2πk) q/p. The period of sin(p x/q) is
        # 2πq/|p|, so there are |p| of these in the common period 2πq.
        becomes = tuple(zip((angle.sine, angle.cosine), sine_and_cosine, strict=True))
        turns, times = int(angle.fraction.q), abs(int(angle.fraction.p))
        period = 2 * sp.pi * turns
        for k in range(times):
            coordinate = (value - angle.offset + 2 * sp.pi * k) / angle.fraction
            # A length is made positive; any other number lies in (−period/2, period/2].
            size, rest = coordinate.as_independent(sp.Symbol, as_Add=True)
            number, unit = size.as_coeff_Mul()
            share = number / (2 * turns) if unit is sp.pi else size / period
            lowest = 0 if angle.is_length else -sp.S.Half
            size -= period * (sp.ceiling(share - lowest) - 1)
            place = Place(angle.coordinate, size + rest, period, is_length=angle.is_length)
            yield Root(place, becomes, (self._angles.index(angle), float(size), str(place.value)))


solver_for = lru_cache(maxsize=32)(Solver)  # shared like the ring itself


def length_of(coordinates: Sequence[sp.Expr]) -> sp.Expr:
    return sp.sqrt(added(*(coordinate**2 for coordinate in coordinates)))
