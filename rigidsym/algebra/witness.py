"""Real points: what an identity must survive, whatever the ring says.

Coordinates and constants are real. What is proved of them is empty if no real values satisfy the
conditions, or if a root or a quotient has no real value anywhere. So a point is needed before
anything is derived: an `example` that satisfies the conditions exactly, and beyond it random
rational numbers.

If every generator has a real value at such a point, evaluation there respects sums, products and
all relations of the ring. So an identity that is proved in the ring holds there and says something;
a divisor with a value other than zero is no hidden zero; and an element with such a value is not
zero.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import islice
from operator import add, mul, sub
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.evaluate import NotReal, RealValues, Unknown, context
from rigidsym.algebra.generators import TIME, in_names, is_identically_zero
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Monomial
from rigidsym.errors import ModelError

DIGITS = 50
MORE_DIGITS = 400  # if fewer do not tell a divisor from zero: 10**120 times a hidden zero is one
_GUARD = 20  # digits that evaluations may lose
_SCALES = ("1", "1", "1", "-1", "-1", "1/10", "10", "-10", "1/100", "100")  # of random points
_ATOMS = (sp.Symbol, sp.Derivative, AppliedUndef)
_FASTEST = 10**6  # a rate that is larger comes from constraints that touch
_DAMPING = 1e-40  # of the normal equations: dependent rows then do no harm
_STEPS = 20  # of the linear equations of rates, each of which gains 30 digits
_BITS = 240  # behind the point of the numbers of a check
_SMALL = 1 << (_BITS - 166)  # a number below 2^−166, some 10^−50, is zero
_POINTS = 3  # at which a claim may be refuted
Rows = Sequence[Sequence[Any]]
Example = tuple[tuple[sp.Expr, sp.Expr], ...]
Numbers = dict[sp.Expr, Any]


@dataclass(frozen=True, eq=False)
class Configuration:
    """Real values of coordinates, rates and constants; unbound ones follow from the seed."""

    values: Mapping[sp.Expr, Any]  # of what the conditions hold: exact, or with many digits
    radii: Mapping[sp.Expr, Any]  # bounds on the distance of the true values, if not exact
    digits: int
    seed: int

    def numbers(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """The values of expressions to so many digits."""
        return RealValues(self._point(expressions), self.digits + _GUARD)

    def intervals(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """Proved bounds on the values of expressions."""
        return RealValues(self._point(expressions), self.digits + _GUARD, self.radii)

    def _point(self, expressions: Sequence[sp.Expr]) -> Numbers:
        return {**_random_point(_atoms_of(expressions), self.seed), **self.values}


@lru_cache(maxsize=128)
def configurations(
    name: str,
    constraints: tuple[sp.Expr, ...],
    parts: tuple[sp.Expr, ...],
    example: Example = (),
    digits: int = DIGITS,
    count: int = 1,
) -> tuple[Configuration, ...]:
    """Up to `count` points at which all constraints vanish and all parts are real.

    The values of the symbols in the constraints are those of the example. Raises ModelError, with
    the reason, if the example does not satisfy them, or if no part has a real value.
    """
    bound = tuple(c for c in constraints if not is_identically_zero(c))
    _check(name, bound, dict(example))
    reasons: list[NotReal] = []
    points = tuple(islice(_points(bound, parts, dict(example), digits, reasons), count))
    if points:
        return points
    reason = reasons[-1]
    if reason.reason == "division by" and digits < MORE_DIGITS:
        return configurations(name, constraints, parts, example, MORE_DIGITS, count)
    place = ", where the `example` is" if bound else ""
    raise ModelError(
        f"{name}: no real values were found: {reason.reason} {in_names(reason.part)}{place}; "
        "expected expressions that are real and defined for some values, which an `example` may "
        "give"
    )


def _check(name: str, constraints: Sequence[sp.Expr], example: Mapping[sp.Expr, sp.Expr]) -> None:
    """Raises ModelError unless the example satisfies the constraints, as real numbers, exactly."""
    if not constraints:
        return
    written = ", ".join(f"{in_names(c)} = 0" for c in constraints)
    missing = [str(in_names(atom)) for atom in _atoms_of(constraints) if atom not in example]
    if missing:
        raise ModelError(
            f"{name}: {written} needs an `example`: give exact values of {', '.join(missing)} that "
            "satisfy it, in a file as [rotation.example]; for c**2 + s**2 - 1 = 0, these are "
            'c = "3/5" and s = "4/5"'
        )
    for constraint in constraints:
        value = constraint.xreplace(dict(example))
        try:
            has_zero = 0 in RealValues(example, DIGITS)(constraint)
        except (NotReal, Unknown) as error:
            raise ModelError(
                f"{name}: the example has no real value of {in_names(constraint)}: {error}"
            ) from None
        if not has_zero or not is_identically_zero(value):
            is_near = " (to 50 digits it is, but not provably)" if has_zero else ""
            raise ModelError(
                f"{name}: the example does not satisfy {in_names(constraint)} = 0{is_near}; "
                "expected exact values, such as rational numbers, roots, or fractions of pi as "
                "angles"
            )


def _points(
    constraints: Sequence[sp.Expr],
    parts: Sequence[sp.Expr],
    example: Mapping[sp.Expr, sp.Expr],
    digits: int,
    reasons: list[NotReal],
) -> Iterator[Configuration]:
    """Points at which the parts are real; why they were not at others, as `reasons`."""
    for seed in range(len(_SCALES) * 2):
        values, radii = _with_rates(constraints, example, seed, digits)
        configuration = Configuration(values, radii, digits, seed)
        try:
            values_of_parts(configuration.intervals(parts), parts)
        except NotReal as error:
            reasons.append(error)
        else:
            yield configuration


def _with_rates(
    constraints: Sequence[sp.Expr], example: Mapping[sp.Expr, sp.Expr], seed: int, digits: int
) -> tuple[Numbers, Numbers]:
    """The example with rates and accelerations that keep to the constraints, and their radii.

    They solve linear equations, from random values on by steps of least length. At rest all of
    them do; so it is where constraints touch, as (u − 1)² = 0 does.
    """
    values: Numbers = dict(example)
    radii: Numbers = {}
    equations = list(constraints)
    for _ in range(2 if constraints else 0):
        equations = [sp.diff(c, TIME) for c in equations]
        rates = [atom for atom in _atoms_of(equations) if atom not in values]
        solved = _solved(equations, rates, values | _random_point(rates, seed), digits)
        if solved is None or any(abs(solved[rate]) > _FASTEST for rate in rates):
            every = _atoms_of([sp.diff(c, TIME, order) for c in constraints for order in (1, 2)])
            return {**dict.fromkeys(every, sp.S.Zero), **example}, {}
        values |= solved
        radii |= dict.fromkeys(rates, context(digits).mpf(10) ** (-(digits // 2)))
    return values, radii


def _solved(
    equations: Sequence[sp.Expr], unknowns: Sequence[sp.Expr], start: Numbers, digits: int
) -> Numbers | None:
    """The unknowns of linear equations, near their values at the start; None if there are none."""
    point, slopes = dict(start), [[sp.diff(e, u) for u in unknowns] for e in equations]
    for _ in range(_STEPS):
        work = RealValues(point, digits + _GUARD)
        values = [work.middle(e) for e in equations]
        if max(map(abs, values)) < work.numbers.mpf(10) ** (-digits):
            return {unknown: work.middle(unknown) for unknown in unknowns}
        jacobian = work.numbers.matrix([[work.middle(e) for e in row] for row in slopes])
        gram = jacobian * jacobian.T if unknowns else work.numbers.zeros(len(equations))
        largest = max(gram[k, k] for k in range(gram.rows))
        if not largest > 0:
            return None
        gram += largest * _DAMPING * work.numbers.eye(gram.rows)
        steps = jacobian.T * work.numbers.lu_solve(gram, work.numbers.matrix(values))
        point |= {u: work.middle(u) - step for u, step in zip(unknowns, steps, strict=True)}
    return None


def _atoms_of(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Symbols, functions of time and their derivatives, in alphabetical order."""
    atoms = set().union(*(e.atoms(*_ATOMS) for e in expressions)) - {TIME}
    return sorted(atoms, key=str)


def _random_point(atoms: Sequence[sp.Expr], seed: int) -> Numbers:
    """A rational number for each atom, the same for its name and the seed wherever it occurs."""
    scale = sp.Rational(_SCALES[seed % len(_SCALES)])
    drawn = (random.Random(f"{seed} {atom}").randint(101, 999) for atom in atoms)
    numbers = (scale * sp.Rational(number, 1000) for number in drawn)
    return {TIME: sp.Rational(1, 3), **dict(zip(atoms, numbers, strict=True))}


def values_of_parts(work: RealValues, parts: Sequence[sp.Expr]) -> list[Any]:
    """The values of expressions; a function of which none is known has one at random.

    Raises NotReal for an expression that is not real.
    """
    values = []
    for part in parts:
        while True:
            try:
                values.append(work(part))
                break
            except Unknown as error:
                work.set(error.part, work(_random_point([error.part], 0)[error.part]))
    return values


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
        """Points at which the generators are real."""
        name, constraints, example = self._search
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
    number = context(digits, of_intervals=True).mpf
    total = number(0)
    for monomial, coefficient in element.items():
        term = number(int(coefficient.numerator)) / number(int(coefficient.denominator))
        for value, power in zip(bounds, monomial, strict=True):
            if power:
                term = term * value**power
        total = total + term
    return total
