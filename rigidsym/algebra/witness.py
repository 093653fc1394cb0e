"""Values of ring elements at real configurations: what an identity must survive.

If every generator has a real value at a point that satisfies the conditions, evaluation there
respects sums, products and all relations of the ring. So an identity that is proved in the ring
holds there and says something; a divisor with a value other than zero is no hidden zero; and an
element with such a value is not zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from operator import add, mul, sub
from typing import Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.real_values import (
    DIGITS,
    MORE_DIGITS,
    Configuration,
    NotReal,
    arithmetic,
    values_of_parts,
)
from rigidsym.algebra.ring import Monomial

_BITS = 240  # behind the point of the numbers of a check
_SMALL = 1 << (_BITS - 166)  # a number below 2^−166, some 10^−50, is zero
_POINTS = 3  # at which a claim may be refuted
Rows = Sequence[Sequence[Any]]
Example = tuple[tuple[sp.Expr, sp.Expr], ...]


def witness_for(
    codec: Codec, name: str, constraints: tuple[sp.Expr, ...] = (), example: Example = ()
) -> Witness:
    """The witness of a ring whose coordinates keep to constraints.

    Raises ModelError if no real configuration is found at which all generators are real.
    """
    if codec.ring.complete and not constraints:
        return _shared(codec, "", (), ())
    return _shared(codec, name, constraints, example)


@lru_cache(maxsize=64)
def _shared(codec: Codec, name: str, constraints: tuple[sp.Expr, ...], example: Example) -> Witness:
    return Witness(codec, name, constraints, example)


class Witness:
    """A ring at real configurations of its coordinates.

    A ring that knows every relation decides by itself what is zero, and is real everywhere.
    """

    def __init__(
        self, codec: Codec, name: str, constraints: tuple[sp.Expr, ...], example: Example
    ) -> None:
        self._generators = tuple(gen.expression for gen in codec.ring.generators)
        self._search = name, constraints, example
        self._decides = codec.ring.complete and not constraints
        self._monomials: dict[Monomial, int] = {}
        self._first = Configuration({}, {}, DIGITS, 0)
        if not self._decides:
            (self._first,) = self._configurations(DIGITS, 1)

    def _configurations(self, digits: int, count: int) -> tuple[Configuration, ...]:
        """Points at which the generators are real; those of the constraints, if they are."""
        name, constraints, example = self._search
        if constraints and count == 1:
            (found,) = configurations(name, constraints, (), example, digits)
            try:
                self._bounds(found)
            except NotReal:
                pass
            else:
                return (found,)
        return configurations(name, constraints, self._generators, example, digits, count)

    def _bounds(self, at: Configuration) -> list[Any]:
        """Bounds on the values of the generators."""
        return values_of_parts(at.intervals(self._generators), self._generators)

    def is_nonzero(self, element: PolyElement) -> bool:
        """Whether an element is certainly not zero: by the ring, or by a value at a point."""
        if self._decides or element.is_ground:
            return bool(element)
        return any(
            0 not in _bounds_of(element, self._bounds(at), digits)
            for digits, count in ((DIGITS, 1), (DIGITS, _POINTS), (MORE_DIGITS, 1))
            for at in self._configurations(digits, count)
        )

    def disagrees(self, residual: RingMatrix, known: dict[RingMatrix, Rows]) -> bool:
        """Whether a matrix that the ring takes for zero is certainly not zero at the first point.

        It is evaluated product by product, without the ring's reduction; `known` remembers the
        values of matrices from one claim to the next. Numbers are whole multiples of 2^−240, which
        is fast; a disagreement is put to intervals.
        """
        rows = _values(residual, known, self._number, lambda product: product >> _BITS)
        if all(-_SMALL < entry < _SMALL for row in rows for entry in row):
            return False
        bounds = self._bounds(self._first)
        found = _values(residual, {}, lambda e: _bounds_of(e, bounds, DIGITS), lambda entry: entry)
        return any(0 not in entry for row in found for entry in row)

    @cached_property
    def _numbers(self) -> list[int]:
        """The values of the generators at the first point."""
        work = self._first.numbers(self._generators)
        values_of_parts(work, self._generators)
        ldexp = work.numbers.ldexp
        return [int(ldexp(work.middle(generator), _BITS)) for generator in self._generators]

    def _number(self, element: PolyElement) -> int:
        total = 0
        for monomial, coefficient in element.items():
            value = self._monomials.get(monomial)
            if value is None:
                value = self._monomials[monomial] = self._monomial(monomial)
            total += value * int(coefficient.numerator) // int(coefficient.denominator)
        return total

    def _monomial(self, monomial: Monomial) -> int:
        value = 1 << _BITS
        for place, power in enumerate(monomial):
            for _ in range(power):
                value = (value * self._numbers[place]) >> _BITS
        return value


def _values(
    matrix: RingMatrix,
    known: dict[RingMatrix, Rows],
    element: Callable[[PolyElement], Any],
    settled: Callable[[Any], Any],
) -> Rows:
    """The values of a matrix from those it was made of; `settled` takes sums of products."""
    if matrix in known:
        return known[matrix]
    found: Rows
    if matrix.origin is None:
        found = [list(map(element, row)) for row in matrix.rows]
    else:
        sign, (first, *others) = matrix.origin
        rows = _values(first, known, element, settled)
        if sign == "T":
            found = list(zip(*rows, strict=True))
        elif sign == "*":
            factor = element(others[0])
            found = [[settled(entry * factor) for entry in row] for row in rows]
        else:
            second = _values(others[0], known, element, settled)
            if sign == "@":
                columns = list(zip(*second, strict=True))
                found = [
                    [settled(sum(map(mul, row, column))) for column in columns] for row in rows
                ]
            else:
                change = add if sign == "+" else sub
                found = [list(map(change, *pair)) for pair in zip(rows, second, strict=True)]
    known[matrix] = found
    return found


def _bounds_of(element: PolyElement, bounds: Sequence[Any], digits: int) -> Any:
    """Bounds on an element from those on its generators."""
    number = arithmetic(digits, of_intervals=True).mpf
    total = number(0)
    for monomial, coefficient in element.items():
        term = number(int(coefficient.numerator)) / number(int(coefficient.denominator))
        for value, power in zip(bounds, monomial, strict=True):
            if power:
                term = term * value**power
        total = total + term
    return total
