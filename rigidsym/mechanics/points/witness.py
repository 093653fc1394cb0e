"""Values of ring elements at real configurations: what an identity must survive.

If every generator has a real value at a point that satisfies the conditions, evaluation there
respects sums, products and all relations of the ring. So an identity that is proved in the ring
holds there and says something; a divisor with a value other than zero is no hidden zero; and an
element with such a value is not zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.real_values import Evaluation, NotReal
from rigidsym.mechanics.points.configuration import (
    DIGITS,
    MORE_DIGITS,
    Configuration,
    configurations,
    values_of_parts,
)

_POINTS = 3  # at which a claim may be refuted
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
        self._numbers: dict[PolyElement, Any] = {}

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

    @cached_property
    def _work(self) -> tuple[Evaluation, list[Any]]:
        work = self._first[0].numbers(self._generators)
        return work, values_of_parts(work, self._generators)

    def value(self, element: PolyElement) -> Any:
        """The value of an element at the first configuration, to 50 digits."""
        if element not in self._numbers:
            work, values = self._work
            self._numbers[element] = value_of(element, values, work)
        return self._numbers[element]


def value_of(element: PolyElement, values: Sequence[Any], work: Evaluation) -> Any:
    """An element with numbers or intervals in the place of its generators."""
    total = work.number(0)
    for monomial, coefficient in element.items():
        term = work.number(int(coefficient.numerator)) / work.number(int(coefficient.denominator))
        for value, power in zip(values, monomial, strict=True):
            if power:
                term = term * value**power
        total = total + term
    return total
