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
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from decimal import Decimal, localcontext
from functools import cached_property, lru_cache
from itertools import starmap
from math import prod
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.evaluate import NotReal, RealValues, Unknown, context
from rigidsym.algebra.generators import TIME, in_names, is_identically_zero
from rigidsym.algebra.matrix import RingMatrix, Values
from rigidsym.algebra.ring import Monomial
from rigidsym.errors import ModelError
from rigidsym.system.records import NamedTuple

DIGITS = 50
MORE_DIGITS = 400  # if fewer do not tell a divisor from zero: 10**120 times a hidden zero is one
_GUARD = 20  # digits that evaluations may lose
_SCALES = ("1", "1", "1", "-1", "-1", "1/10", "10", "-10", "1/100", "100")  # of random points
_ATOMS = (sp.Symbol, sp.Derivative, AppliedUndef)
_SMALL = Decimal("1e-45")  # a value of a residual below it is zero
_POINTS = 3  # at which a claim may be refuted
Example = tuple[tuple[sp.Expr, sp.Expr], ...]
Numbers = dict[sp.Expr, sp.Expr]


class Configuration(NamedTuple):
    """Exact real values of coordinates, rates and constants; unbound ones follow from the seed."""

    values: Mapping[sp.Expr, sp.Expr]  # of what the conditions hold
    digits: int
    seed: int

    def intervals(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """Proved bounds on the values of expressions."""
        point = {**_random_point(_atoms_of(expressions), self.seed), **self.values}
        return RealValues(point, self.digits + _GUARD)


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
    points: list[Configuration] = []
    reason: NotReal | None = None
    # Expressions such as √(1 − x²) and √(x − 5) are real only for small or only for large values,
    # so points of several scales and both signs are tried.
    for seed in range(len(_SCALES) * 2):
        point = Configuration(_with_rates(bound, dict(example), seed), digits, seed)
        try:
            values_of_parts(point.intervals(parts), parts)
        except NotReal as error:
            reason = error
        else:
            points.append(point)
            if len(points) == count:
                break
    if points or reason is None:
        return tuple(points)
    # The divisor may only be too small for these digits.
    if reason.reason == "division by zero" and digits < MORE_DIGITS:
        return configurations(name, constraints, parts, example, MORE_DIGITS, count)
    place = ", where the `example` is" if bound else ""
    raise ModelError(
        f"{name}: no real values were found: {reason.reason} in {in_names(reason.part)}{place}; "
        "expected expressions that are real and defined for some values, which an `example` may "
        "give"
    )


def _check(name: str, constraints: Sequence[sp.Expr], example: Mapping[sp.Expr, sp.Expr]) -> None:
    """Raises ModelError unless the example satisfies the constraints, as real numbers, exactly."""
    missing = [str(in_names(atom)) for atom in _atoms_of(constraints) if atom not in example]
    if missing:
        written = ", ".join(f"{in_names(c)} = 0" for c in constraints)
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


def _with_rates(
    constraints: Sequence[sp.Expr], example: Mapping[sp.Expr, sp.Expr], seed: int
) -> Numbers:
    """The example with rates and accelerations that keep to the constraints.

    They solve linear equations. The rates that these leave free are random. All are zero, which
    is right as well, if there is no solution, as where constraints touch: (u − 1)² = 0.
    """
    # f(q) = 0 implies J q̇ = 0 and J q̈ + J̇ q̇ = 0, J = ∂f/∂q. The first is linear in the rates
    # and, with the rates known, the second is linear in the accelerations.
    derivatives = [[sp.diff(c, TIME, order) for c in constraints] for order in (1, 2)]
    values: Numbers = dict(example)
    for equations in derivatives:
        rates = {rate: sp.Dummy() for rate in _atoms_of(equations) if rate not in values}
        linear = [e.xreplace({**values, **rates}) for e in equations]
        for solution in sp.linsolve(linear, *rates.values()) if rates else ():
            numbers = _random_point(list(rates), seed)
            numbers = {rates[rate]: number for rate, number in numbers.items() if rate in rates}
            values |= {r: part.xreplace(numbers) for r, part in zip(rates, solution, strict=True)}
    with suppress(NotReal, Unknown):  # a pivot in disguise was zero, or there is no solution
        work = RealValues(values, DIGITS)
        if all(0 in work(e) for equations in derivatives for e in equations):
            return values
    at_rest = _atoms_of([equation for equations in derivatives for equation in equations])
    return {**dict.fromkeys(at_rest, sp.S.Zero), **example}


def _atoms_of(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Symbols, functions of time and their derivatives, in alphabetical order."""
    atoms = set().union(*(e.atoms(*_ATOMS) for e in expressions)) - {TIME}
    return sorted(atoms, key=str)


def _random_point(atoms: Sequence[sp.Expr], seed: int) -> Numbers:
    """A rational number for each atom, the same for its name and the seed wherever it occurs."""
    scale = sp.Rational(_SCALES[seed % len(_SCALES)])
    # Seeded by the name, so that a symbol has the same value in every ring and every process.
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


@lru_cache(maxsize=64)
def witness_for(
    codec: Codec, name: str, constraints: tuple[sp.Expr, ...] = (), example: Example = ()
) -> Witness:
    """The witness of a ring whose coordinates keep to constraints.

    Raises ModelError if no real configuration is found at which all generators are real.
    """
    # A ring that decides is real everywhere, whatever the model is called: one witness serves all.
    if name and codec.ring.complete and not constraints:
        return witness_for(codec, "")
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
        self._first = Configuration({}, DIGITS, 0)
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
        # An interval without zero proves that the element is not zero. One point at 50 digits
        # decides nearly always; further points and more digits cost more and come later.
        return any(
            0 not in self._interval(at, digits)(element)
            for digits, count in ((DIGITS, 1), (DIGITS, _POINTS), (MORE_DIGITS, 1))
            for at in self._configurations(digits, count)
        )

    def disagrees(self, residual: RingMatrix, known: dict[RingMatrix, Values]) -> bool:
        """Whether a matrix that the ring takes for zero is certainly not zero at the first point.

        It is evaluated product by product, without the ring's reduction; `known` remembers the
        values of matrices from one claim to the next. Decimal numbers are the fastest of so many
        digits; a disagreement is put to intervals.
        """
        # Rounding can make a zero look different from zero, so a disagreement must be confirmed by
        # intervals. An agreement needs no more: the ring has proved the zero already.
        with localcontext(prec=DIGITS + _GUARD):
            rows = residual.values(self._decimal, known)
        if all(abs(entry) < _SMALL for row in rows for entry in row):
            return False
        rows = residual.values(self._interval(self._first, DIGITS), {})
        return any(0 not in entry for row in rows for entry in row)

    def _interval(self, at: Configuration, digits: int) -> Callable[[PolyElement], Any]:
        """Bounds on the values of elements at a point."""
        return _evaluation(self._bounds(at), context(digits, of_intervals=True).mpf)

    @cached_property
    def _decimal(self) -> Callable[[PolyElement], Decimal]:
        """The values of elements at the first point."""
        number = context(DIGITS + _GUARD).mpf
        numbers = [Decimal(str(number(bounds.mid))) for bounds in self._bounds(self._first)]
        return _evaluation(numbers, Decimal)


def _evaluation(values: Sequence[Any], number: Any) -> Callable[[PolyElement], Any]:
    """The values of elements, numbers or intervals, from those of the generators."""

    # Evaluation respects sums and products, so one function serves numbers and intervals. Few
    # terms are new: most occur in many entries.
    @lru_cache(maxsize=1 << 14)
    def term(powers: Monomial, coefficient: Any) -> Any:
        weight = number(int(coefficient.numerator)) / int(coefficient.denominator)
        return prod((value**n for value, n in zip(values, powers, strict=True) if n), start=weight)

    return lambda element: sum(starmap(term, element.items()), number(0))
