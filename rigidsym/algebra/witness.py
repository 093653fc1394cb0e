"""Values of ring elements at real configurations: what an identity must survive.

If every generator has a real value at a point that satisfies the conditions, evaluation there
respects sums, products and all relations of the ring. So an identity that is proved in the ring
holds there and says something; a divisor with a value other than zero is no hidden zero; and an
element with such a value is not zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from operator import add, mul, sub
from typing import Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.configuration import (
    DIGITS,
    MORE_DIGITS,
    Configuration,
    configurations,
    values_of_parts,
)
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.real_values import NotReal, RealValues
from rigidsym.algebra.ring import Monomial

_BITS = 240  # behind the point of the numbers of a check
_SMALL_BITS = 166  # a number below 2^−166, some 10^−50, is zero
_POINTS = 3  # at which a claim may be refuted
Rows = Sequence[Sequence[Any]]
Example = tuple[tuple[sp.Expr, sp.Expr], ...]


@lru_cache(maxsize=64)
def witness_for(
    codec: Codec, name: str, constraints: tuple[sp.Expr, ...], example: Example = ()
) -> Witness:
    """The witness of a ring whose coordinates keep to constraints.

    Raises ModelError if no real configuration is found at which all generators are real.
    """
    return Witness(codec, name, constraints, example)


class Witness:
    """A ring at real configurations of its coordinates."""

    def __init__(
        self, codec: Codec, name: str, constraints: tuple[sp.Expr, ...], example: Example
    ) -> None:
        self._generators = tuple(gen.expression for gen in codec.ring.generators)
        self._search = name, constraints, example
        self._first = self._configurations(DIGITS, 1)

    def _configurations(self, digits: int, count: int) -> tuple[Configuration, ...]:
        """Points at which the generators are real; those of the constraints, if they are."""
        name, constraints, example = self._search
        if constraints and count == 1:
            (found,) = configurations(name, constraints, (), example, digits)
            try:
                values_of_parts(found.intervals(self._generators), self._generators)
            except NotReal:
                pass
            else:
                return (found,)
        return configurations(name, constraints, self._generators, example, digits, count)

    def is_nonzero(self, element: PolyElement) -> bool:
        """Whether an element is proved not to vanish at a configuration."""
        if element.is_ground:
            return bool(element)
        for digits, count in ((DIGITS, 1), (DIGITS, _POINTS), (MORE_DIGITS, 1)):
            for configuration in self._configurations(digits, count):
                work = configuration.intervals(self._generators)
                values = values_of_parts(work, self._generators)
                if 0 not in value_of(element, values, work):
                    return True
        return False

    @property
    def configuration(self) -> Configuration:
        return self._first[0]


@lru_cache(maxsize=64)
def check_for(codec: Codec, witness: Witness | None) -> Check:
    """The check of a ring, at the configuration of its witness; anywhere if it has none."""
    anywhere = Configuration({}, {}, DIGITS, 0)
    return Check(codec, anywhere if witness is None else witness.configuration)


class Check:
    """Claims evaluated at one configuration, product by product, without the ring's reduction.

    Numbers are whole multiples of 2^−240, which is fast; a disagreement is put to intervals.
    """

    def __init__(self, codec: Codec, configuration: Configuration) -> None:
        self._generators = tuple(gen.expression for gen in codec.ring.generators)
        self._configuration = configuration
        work = configuration.numbers(self._generators)
        values = values_of_parts(work, self._generators)
        self._values = [int(work.context.ldexp(value, _BITS)) for value in values]
        self._monomials: dict[Monomial, int] = {}

    def disagrees(self, residual: RingMatrix, known: dict[RingMatrix, Rows]) -> bool:
        """Whether a matrix that the ring takes for zero is certainly not zero here.

        `known` remembers the values of matrices from one claim to the next.
        """
        small = 1 << (_BITS - _SMALL_BITS)
        rows = _values(residual, known, self._element, _shifted)
        if all(-small < entry < small for row in rows for entry in row):
            return False
        work = self._configuration.intervals(self._generators)
        values = values_of_parts(work, self._generators)
        bounds = _values(residual, {}, lambda e: value_of(e, values, work), lambda entry: entry)
        return any(0 not in work.number(entry) for row in bounds for entry in row)

    def _element(self, element: PolyElement) -> int:
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
                value = (value * self._values[place]) >> _BITS
        return value


def _shifted(product: int) -> int:
    return product >> _BITS


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


def value_of(element: PolyElement, values: Sequence[Any], work: RealValues) -> Any:
    """An element with numbers or intervals in the place of its generators."""
    total = work.number(0)
    for monomial, coefficient in element.items():
        term = work.number(int(coefficient.numerator)) / work.number(int(coefficient.denominator))
        for value, power in zip(values, monomial, strict=True):
            if power:
                term = term * value**power
        total = total + term
    return total
