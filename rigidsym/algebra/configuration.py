"""A real configuration: a point of the coordinates at which claims are checked.

Coordinates and constants are real. What is proved of them is empty if no real values satisfy the
conditions, or if a root or a quotient has no real value anywhere, and so a point is found before
anything is derived. Newton's method moves random points onto the conditions. That a solution lies
there is then proved: exactly for rational values and fractions of π, or else by Krawczyk's test
in intervals (R. Krawczyk, Computing 4 (1969); R. Moore, SIAM J. Numer. Anal. 14 (1977)).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice
from typing import Any

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.generators import TIME, in_names, is_identically_zero
from rigidsym.algebra.real_values import (
    DIGITS,
    GUARD,
    MORE_DIGITS,
    SCALES,
    Configuration,
    NotReal,
    Numbers,
    RealValues,
    Unknown,
    arithmetic,
    atoms_of,
    random_point,
    values_of_parts,
)
from rigidsym.errors import AlgebraError, ModelError

_STEPS = 90  # of Newton's method, which is slow at double roots
_LONGEST_STEP = 10  # times the size of the point
_FASTEST = 10**6  # a rate that is larger comes from constraints that touch
_DAMPING = 1e-40  # of the normal equations: dependent rows then do no harm
_NEARLY = 1e-20  # of equations at a double root, which is approached slowly
_LARGEST_DENOMINATOR = 1000  # of exact points that are tried


@lru_cache(maxsize=128)
def configurations(
    name: str,
    constraints: tuple[sp.Expr, ...],
    parts: tuple[sp.Expr, ...],
    example: tuple[tuple[sp.Expr, sp.Expr], ...] = (),
    digits: int = DIGITS,
    count: int = 1,
) -> tuple[Configuration, ...]:
    """Up to `count` points at which all constraints vanish and all parts are real.

    Raises ModelError, with the reason, if there is no such point among those that are tried.
    """
    search = _Search(constraints, parts, dict(example), digits)
    found = tuple(islice(search.found(), count))
    if found:
        return found
    if search.is_undecided and digits < MORE_DIGITS:
        return configurations(name, constraints, parts, example, MORE_DIGITS, count)
    raise ModelError(f"{name}: {search.reason()}")


class _Search:
    """One search for points; remembers why points failed."""

    def __init__(
        self,
        constraints: Sequence[sp.Expr],
        parts: Sequence[sp.Expr],
        example: Mapping[sp.Expr, sp.Expr],
        digits: int,
    ) -> None:
        self.constraints = [c for c in constraints if not is_identically_zero(c)]
        self.parts, self.example, self.digits = parts, example, digits
        self.atoms = atoms_of([*self.constraints, *parts])
        self._aids: list[sp.Expr] = []  # arguments of roots, to be squares: they help the search
        self._not_real: NotReal | None = None
        self._unproved = False
        self._unknown = ""

    def found(self) -> Iterator[Configuration]:
        for seed in range(len(SCALES) * (2 if self.parts else 1)):
            try:
                configuration = self._at(seed)
                if configuration is not None:
                    yield configuration
            except Unknown as error:
                self._unknown = str(error)
            except NotReal as error:
                self._not_real = error
                if error.is_sign and error.part not in self._aids and len(self._aids) < 3:
                    self._aids.append(error.part)

    @property
    def is_undecided(self) -> bool:
        """Whether more digits may tell that a divisor is not zero."""
        return self._not_real is not None and self._not_real.reason == "division by"

    def reason(self) -> str:
        """Why no point was found."""
        conditions = ", ".join(f"{in_names(c)} = 0" for c in self.constraints)
        if self._unproved:
            return (
                f"a point that satisfies {conditions} was found to {self.digits} digits, but not "
                "proved to exist; give exact values of one as `example`"
            )
        if self._unknown:
            return f"{self._unknown}, so that no values are known to satisfy {conditions}"
        if self._not_real is not None:
            return (
                f"no real values were found: {self._not_real.reason} "
                f"{in_names(self._not_real.part)}; expected expressions that are real and defined "
                "for some values"
            )
        return (
            f"no real values were found that satisfy {conditions}; expected conditions that hold "
            "for some values"
        )

    def _at(self, seed: int) -> Configuration | None:
        """The configuration that a random point leads to; None if none was reached."""
        point = random_point(self.atoms, seed)
        point |= {atom: value for atom, value in self.example.items() if atom in point}
        reached: Numbers | None = None
        values: Numbers = {}
        radii: Numbers = {}
        if self.constraints or self._aids:
            reached = self._moved_onto(point)
            if reached is None:
                return None
            values = reached
        if self.constraints:
            assert reached is not None
            located = self._exact(reached) or self._enclosed(reached)
            if located is None:
                self._unproved = True
                return None
            values, radii = located
            values, radii = self._with_rates(values, radii, seed)
        configuration = Configuration(values, radii, self.digits, seed)
        values_of_parts(configuration.intervals(self.parts), self.parts)
        self._not_real = None
        return configuration

    def _moved_onto(self, point: Numbers) -> Numbers | None:
        """The point, moved until the constraints vanish; None if that fails."""
        aids = [(part - sp.Dummy(f"s{k}") ** 2) for k, part in enumerate(self._aids)]
        slack = {s: sp.Rational(1, 2) for aid in aids for s in aid.atoms(sp.Dummy)}
        bound = atoms_of([*self.constraints, *aids])
        moved = newton([*self.constraints, *aids], bound, {**point, **slack}, self.digits)
        if moved is None:
            return None
        return {atom: moved[atom] for atom in bound if atom not in slack}

    def _exact(self, reached: Numbers) -> tuple[Numbers, Numbers] | None:
        """The values as rational numbers or fractions of π, if these satisfy the constraints."""
        values = {atom: _simplest(reached[atom]) for atom in atoms_of(self.constraints)}
        if any(value is None for value in values.values()):
            return None
        exact = {atom: value for atom, value in values.items() if value is not None}
        if all(is_identically_zero(c.xreplace(exact)) for c in self.constraints):
            return exact, {}
        return None

    def _enclosed(self, reached: Numbers) -> tuple[Numbers, Numbers] | None:
        """The values with radii within which Krawczyk's test proves a solution.

        With the Jacobian J at the point the test is about c(point + Jᵀ λ) = 0, in as many
        unknowns λ as there are independent constraints c.
        """
        bound, digits = atoms_of(self.constraints), self.digits + GUARD
        thin = RealValues(reached, digits)
        kept = _independent(self.constraints, bound, thin)
        slopes = [[sp.diff(c, atom) for atom in bound] for c in kept]
        rows = thin.numbers.matrix([[thin.middle(entry) for entry in row] for row in slopes])
        try:
            back = thin.context.matrix((rows * rows.T) ** -1)
        except ZeroDivisionError:  # the constraints touch
            return None
        radius = thin.numbers.mpf(10) ** (-(self.digits // 2))
        radii = {atom: radius * sum(map(abs, rows.column(k))) for k, atom in enumerate(bound)}
        wide = RealValues(reached, digits, radii)
        slope = thin.context.matrix([[wide(entry) for entry in row] for row in slopes])
        one = thin.context.eye(len(kept))
        box = thin.context.matrix([thin.around(thin.context.mpf(0), radius)] * len(kept))
        values = thin.context.matrix([thin(c) for c in kept])
        moved = (one - back * slope * thin.context.matrix(rows.T)) * box - back * values
        if not all(entry.a > -radius and entry.b < radius for entry in moved):
            return None
        return dict(reached), radii

    def _with_rates(self, values: Numbers, radii: Numbers, seed: int) -> tuple[Numbers, Numbers]:
        """The same with rates and accelerations that keep to the constraints.

        At rest all of them do; so it is where constraints touch, as (u − 1)² = 0 does.
        """
        radius = arithmetic(self.digits).mpf(10) ** (-(self.digits // 2))
        equations = self.constraints
        found, unknown = dict(values), dict(radii)
        for _ in range(2):
            equations = [sp.diff(c, TIME) for c in equations]
            rates = [atom for atom in atoms_of(equations) if atom not in found]
            start = found | random_point(rates, seed)
            moved = newton(equations, rates, start, self.digits) if rates else start
            if moved is None or any(abs(moved[rate]) > _FASTEST for rate in rates):
                return self._at_rest(values), radii
            found |= {rate: moved[rate] for rate in rates}
            unknown |= dict.fromkeys(rates, radius)
        return found, unknown

    def _at_rest(self, values: Numbers) -> Numbers:
        rates = atoms_of([sp.diff(c, TIME, order) for c in self.constraints for order in (1, 2)])
        return {**dict.fromkeys(rates, sp.S.Zero), **values}


def newton(
    equations: Sequence[sp.Expr], unknowns: Sequence[sp.Expr], start: Numbers, digits: int
) -> Numbers | None:
    """A zero of the equations by steps of least length; None if they do not lead to one.

    Raises NotReal at a point where an equation has no real value.
    """
    slopes = [[sp.diff(e, u) for u in unknowns] for e in equations]
    point = dict(start)
    best = size = None
    for _ in range(_STEPS):
        work = RealValues(point, digits + GUARD)
        values = [work.middle(e) for e in equations]
        size = max(map(abs, values))
        if size < work.numbers.mpf(10) ** (-digits):
            return {atom: work.middle(atom) for atom in point}
        best = size if best is None else min(best, size)
        if not size < 1000 * (1 + best):
            return None
        jacobian = work.numbers.matrix([[work.middle(e) for e in row] for row in slopes])
        gram = jacobian * jacobian.T
        most = max(gram[k, k] for k in range(gram.rows))
        if not most > 0:
            return None
        gram += most * _DAMPING * work.numbers.eye(gram.rows)
        steps = jacobian.T * work.numbers.lu_solve(gram, work.numbers.matrix(values))
        most = _LONGEST_STEP * (1 + max(abs(work.middle(unknown)) for unknown in unknowns))
        shorter = min(1, most / max(most, *map(abs, steps)))
        point |= {
            u: work.middle(u) - shorter * step for u, step in zip(unknowns, steps, strict=True)
        }
    return point if size is not None and size < _NEARLY else None


def _simplest(value: Any) -> sp.Expr | None:
    """The rational number, or the fraction of π, that a value seems to be."""
    for unit, ratio, most in (
        (sp.S.One, value, _LARGEST_DENOMINATOR),
        (sp.pi, value / value.context.pi, 12),
    ):
        exact = sp.Rational(str(ratio)).limit_denominator(most)
        if abs(ratio - value.context.mpf(int(exact.p)) / int(exact.q)) < 1e-12:
            return exact * unit
    return None


def _independent(
    constraints: Sequence[sp.Expr], bound: Sequence[sp.Expr], work: RealValues
) -> list[sp.Expr]:
    """The constraints without those that vanish wherever others do; the steepest come first."""
    kept: list[sp.Expr] = []
    steep = {c: max(abs(work.middle(sp.diff(c, atom))) for atom in bound) for c in constraints}
    for constraint in sorted(constraints, key=lambda c: -steep[c]):
        if not kept or not _follows(constraint, kept):
            kept.append(constraint)
    return kept


def _follows(constraint: sp.Expr, kept: Sequence[sp.Expr]) -> bool:
    """Whether a constraint vanishes wherever others do: decided in the ring of these."""
    try:
        return not codec_for([constraint], constraints=kept, order=0).encode(constraint)
    except AlgebraError:
        return False
