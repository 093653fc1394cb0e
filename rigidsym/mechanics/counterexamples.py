"""Random points at which a claim may be refuted: free ones, and ones that obey constraints.

Only a value that is clearly not zero counts, at a precision far beyond the threshold; a value near
zero proves nothing.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.models.so3 import TIME

_DIGITS = 100
_GUARDED = _DIGITS + 50  # what sums may lose
_ZERO = sp.Float(10, _DIGITS) ** -(_DIGITS // 2)
_POINTS = 3
_STEPS = 60  # of Newton's method, which doubles the digits once it is near

Point = Mapping[sp.Expr, sp.Expr]


def is_nonzero_somewhere(entry: sp.Expr, constraints: Sequence[sp.Expr]) -> bool:
    """Whether an expression is clearly not zero at a point that obeys the constraints.

    False where no such point was found, and for rates of coordinates that are bound.
    """
    if constraints and entry.has(sp.Derivative):
        return False
    unknowns = _unknowns([entry, *constraints])
    return any(abs(_value(entry, point)) > _ZERO for point in points(unknowns, constraints))


def _unknowns(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
    kinds = (sp.Symbol, sp.Derivative, AppliedUndef)
    found = set().union(*(expression.atoms(*kinds) for expression in expressions))
    return sorted(found, key=str)


def points(unknowns: Sequence[sp.Expr], constraints: Sequence[sp.Expr]) -> Iterator[Point]:
    """Points, the same in every run, that obey the constraints."""
    generator = random.Random(20)
    for _ in range(_POINTS):
        point = {u: sp.Rational(generator.randint(1, 999), 1000) for u in unknowns}
        bound = _moved_onto(point, constraints) if constraints else point
        if bound is not None:
            yield bound


def _moved_onto(point: Point, constraints: Sequence[sp.Expr]) -> Point | None:
    """The point, moved onto the constraints by Newton's method; None where that fails."""
    unknowns = [u for u in point if u != TIME]
    slopes = sp.Matrix([[sp.diff(c, u) for u in unknowns] for c in constraints])
    for _ in range(_STEPS):
        values = sp.Matrix([_value(c, point) for c in constraints])
        if max(map(abs, values)) < _ZERO**2:
            return point
        jacobian = slopes.applyfunc(lambda entry, at=point: _value(entry, at))
        gram = jacobian * jacobian.T
        if abs(gram.det()) < _ZERO:
            return None
        step = jacobian.T * gram.LUsolve(values)
        point = {**point, **{u: point[u] - step[place] for place, u in enumerate(unknowns)}}
    return None


def _value(expression: sp.Expr, point: Point) -> sp.Expr:
    """The value at a point; zero where it has none, which refutes nothing.

    Roots of numbers become numbers first, all with as many digits: SymPy would look for the digits
    of a zero again and again.
    """
    exact = sp.sympify(expression, strict=True)
    roots = {r: r.evalf(_GUARDED) for r in exact.atoms(sp.Pow, sp.NumberSymbol) if r.is_number}
    at = {unknown: value.evalf(_GUARDED) for unknown, value in point.items()}
    value = exact.xreplace(roots | at).evalf(_DIGITS)
    return value if value.is_number and value.is_finite else sp.S.Zero
