"""Between SymPy expressions and a ring: the ring is built from the expressions it has to hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property, lru_cache

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.generators import (
    Basis,
    GeneratorSet,
    Kind,
    as_sine_cosine,
    cosine_sine_of_pi,
    in_names,
    is_highest,
    is_uncertain,
    rate_of,
    roots_of,
)
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import NUMBERS, Generator, Quotient, Ring
from rigidsym.errors import AlgebraError

_HIGHEST_MULTIPLE = 100  # cos nθ has n terms in cos θ, and products of such polynomials follow
Pair = tuple[PolyElement, PolyElement]  # cosine and sine of one angle


def codec_for(
    expressions: Iterable[sp.Expr], *, constraints: Iterable[sp.Expr] = (), order: int | None = 2
) -> Codec:
    """The ring that holds `expressions`, in which each constraint vanishes for all time.

    `order` is the highest time derivative of a coordinate that the ring can hold. None is for
    quotients: the ring then has neither derivatives nor generators for the inverses of sums, so
    that common factors of numerators and denominators are seen and cancel. Expressions that ask for
    the same generators share one ring, with all that it remembers.
    Raises AlgebraError for an expression that no ring of this kind can hold.
    """
    conditions = tuple(sp.sympify(constraint, strict=True) for constraint in constraints)
    needed = GeneratorSet(order)
    for expression in dict.fromkeys((*expressions, *conditions)):
        needed.collect(sp.sympify(expression, strict=True))
    needed.close()
    return _shared(tuple(needed.generators()), needed.angles, conditions, order)


@lru_cache(maxsize=32)
def _shared(
    kinds: tuple[tuple[sp.Expr, Kind], ...],
    angles: tuple[sp.Expr, ...],
    constraints: tuple[sp.Expr, ...],
    order: int | None,
) -> Codec:
    generators = [Generator(expression=e, opaque=is_uncertain(e, kind)) for e, kind in kinds]
    codec = Codec(Ring(generators), angles)
    codec.settle(kinds, constraints, order)
    return codec


class Codec:
    """A ring, with the way in (`encode`) and out (`decode`). Made by `codec_for`."""

    def __init__(self, ring: Ring, angles: Sequence[sp.Expr]) -> None:
        self.ring = ring
        self._angles, self._basis = angles, Basis(angles)
        self._quotients: dict[sp.Expr, Quotient] = {}
        self._pairs: dict[sp.Expr, Pair] = {}

    def settle(
        self,
        kinds: Sequence[tuple[sp.Expr, Kind]],
        constraints: Sequence[sp.Expr],
        order: int | None,
    ) -> None:
        """Give the ring its relations and derivatives, now that expressions can be read."""
        # Relations come first, since every expression that is read afterwards is reduced by them.
        relations = [r for e, kind in kinds if (r := self._relation(e, kind)) is not None]
        self._set_relations(relations)
        self.ring.derivatives = {
            place: self.encode(rate_of(e))
            for place, (e, _) in enumerate(kinds)
            if order is not None and not is_highest(e, order)
        }
        # constraints and their time derivatives, as far as the ring can derive them
        # f(q) = 0 for all time implies df/dt = 0 and d²f/dt² = 0, which bind the rates and
        # accelerations. With them the ideal is closed under d/dt, and the derivative of a residue
        # class is well defined.
        for element in [self.encode(constraint) for constraint in constraints]:
            while element:
                relations.append(element)
                if not self.ring.can_derive(element):
                    break
                element = self.ring.dt(element)
        if constraints:
            self._set_relations(relations)

    def _set_relations(self, relations: Iterable[PolyElement]) -> None:
        self.ring.set_relations(relations)
        self._quotients.clear()  # what was read before is not in the new normal form
        self._pairs.clear()

    def _relation(self, expression: sp.Expr, kind: Kind) -> PolyElement | None:
        """What vanishes for one generator, by its kind; for a sine, of the pair."""
        ring = self.ring
        gen = ring.generator(ring.index[expression])
        if kind is Kind.INVERSE:
            return gen * self.encode(1 / expression) - 1
        if expression is sp.I:
            return gen**2 + 1
        if kind is Kind.RADICAL:
            base = self.encode_quotient(expression.base)
            return gen**expression.exp.q * base.denominator - base.numerator
        if kind is Kind.SINE:
            cosine = ring.generator(ring.index[sp.cos(expression.args[0])])
            return gen**2 + cosine**2 - 1
        return None

    @cached_property
    def angle_pairs(self) -> tuple[tuple[int, int], ...]:
        """Places of (sine, cosine) of each angle among the generators."""
        index = self.ring.index
        return tuple((index[sp.sin(angle)], index[sp.cos(angle)]) for angle in self._angles)

    def encode(self, expression: sp.Expr) -> PolyElement:
        """Normal form of a polynomial expression; raises AlgebraError for a true quotient."""
        value = self.encode_quotient(expression)
        if not self.ring.is_one(value.denominator):
            raise AlgebraError(
                f"{in_names(expression)} is a quotient, and its inverse is not in the ring"
            )
        return value.numerator

    def column(self, expressions: Iterable[sp.Expr]) -> RingMatrix:
        """Expressions as a column over the ring, (n, 1)."""
        return RingMatrix.column(self.ring, map(self.encode, expressions))

    def matrix(self, expressions: sp.MatrixBase) -> RingMatrix:
        """A matrix of expressions over the ring."""
        return RingMatrix.of(self.ring, [map(self.encode, row) for row in expressions.tolist()])

    def decoded(self, matrix: RingMatrix) -> sp.ImmutableMatrix:
        """A matrix over the ring as expressions."""
        return sp.ImmutableMatrix([list(map(self.decode, row)) for row in matrix.rows])

    def encode_quotient(self, expression: sp.Expr) -> Quotient:
        """An expression as a quotient of two normal forms.

        Raises AlgebraError for an expression with a part that the ring was not built for.
        """
        value = self._quotients.get(expression)
        if value is None:
            value = self._quotients[expression] = self._walk(sp.sympify(expression, strict=True))
        return value

    def _walk(self, expression: sp.Expr) -> Quotient:
        ring = self.ring
        place = ring.index.get(expression)
        if place is not None:
            return Quotient.whole(ring, ring.reduce(ring.generator(place)))
        if expression.is_Rational:
            number = NUMBERS.quo(int(expression.p), int(expression.q))
            return Quotient.whole(ring, ring.polynomials(number))
        if expression.is_Add:
            return Quotient.sum(ring, [self.encode_quotient(part) for part in expression.args])
        if expression.is_Mul:
            return Quotient.product(ring, map(self.encode_quotient, expression.args))
        if expression.is_Pow and expression.exp.is_Rational:
            return self._power(expression.base, expression.exp)
        if isinstance(expression, sp.sin | sp.cos):
            cosine, sine = self._cosine_sine(expression.args[0])
            return Quotient.whole(ring, sine if isinstance(expression, sp.sin) else cosine)
        parts = as_sine_cosine(expression)
        if parts is not None:
            return self.encode_quotient(parts[0]) * self._whole_power(parts[1], -1)
        raise self._foreign(expression)

    def _foreign(self, expression: sp.Expr) -> AlgebraError:
        names = ", ".join(str(in_names(gen.expression)) for gen in self.ring.generators)
        return AlgebraError(f"{in_names(expression)} is not in the ring of {names}")

    def _power(self, base: sp.Expr, exponent: sp.Rational) -> Quotient:
        whole = int(exponent.p)
        if exponent.q == 1:
            return self._whole_power(base, whole)
        # √12 = (√2)² √3. Roots of one degree of different primes are independent over the rational
        # numbers, whereas √2, √3 and √6 are not.
        counts = sp.factorint(base).values() if base.is_Integer else [1]
        roots = roots_of(base, exponent.q)
        if any(root not in self.ring.index for root in roots):
            raise self._foreign(base**exponent)
        factors = [
            self._whole_power(root, count * whole)
            for root, count in zip(roots, counts, strict=True)
        ]
        return Quotient.product(self.ring, factors)

    def _whole_power(self, base: sp.Expr, exponent: int) -> Quotient:
        # With a generator for 1/b the inverse is a polynomial, and no denominator arises.
        if exponent < 0 and 1 / base in self.ring.index:
            return self.encode_quotient(1 / base) ** -exponent
        return self.encode_quotient(base) ** exponent

    def _cosine_sine(self, argument: sp.Expr) -> Pair:
        """Cosine and sine of a rational combination of angles, by addition."""
        if argument in self._pairs:
            return self._pairs[argument]
        pair = self.ring.one, self.ring.zero
        for angle, times in self._basis.parts(argument).items():
            pair = self._added(pair, self._multiple(angle, times))
        self._pairs[argument] = pair
        return pair

    def _multiple(self, angle: sp.Expr, times: sp.Rational) -> Pair:
        if angle is sp.pi:
            cosine, sine = cosine_sine_of_pi(times)
            return self.encode(cosine), self.encode(sine)
        index, ring = self.ring.index, self.ring
        if sp.sin(angle) not in index or not times.is_Integer:
            raise self._foreign(sp.sin(times * angle))
        if abs(times) > _HIGHEST_MULTIPLE:
            raise AlgebraError(
                f"sin and cos of {in_names(times * angle)} beside those of {in_names(angle)}: "
                f"expected multiples up to {_HIGHEST_MULTIPLE}"
            )
        cosine, sine = (ring.generator(index[function(angle)]) for function in (sp.cos, sp.sin))
        single = cosine, sine if times > 0 else -sine
        # cos nθ and sin nθ by n additions of θ to the angle zero.
        pair = ring.one, ring.zero
        for _ in range(abs(int(times))):
            pair = self._added(pair, single)
        return pair

    def _added(self, first: Pair, second: Pair) -> Pair:
        (c, s), (cosine, sine) = first, second
        # cos(α + β) = cos α cos β − sin α sin β and sin(α + β) = sin α cos β + cos α sin β.
        reduce = self.ring.reduce
        return reduce(c * cosine - s * sine), reduce(s * cosine + c * sine)

    def decode(self, element: PolyElement) -> sp.Expr:
        """The polynomial as a SymPy expression, term by term as it is held."""
        expressions = [gen.expression for gen in self.ring.generators]
        return sp.Add(
            *(
                sp.Mul(
                    sp.Rational(int(coefficient.numerator), int(coefficient.denominator)),
                    *(expressions[k] ** power for k, power in enumerate(monomial) if power),
                )
                for monomial, coefficient in element.items()
            )
        )
