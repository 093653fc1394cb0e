"""SymPy scalars as people write them.

What is written and in which order is settled here.

A sum never starts with a minus sign if it has a positive term, and no rate ever follows a sine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import sympy as sp

from rigidsym.formula import tree
from rigidsym.formula.letters import (
    FUNCTIONS,
    NO_RATE,
    Letters,
    is_application,
    is_negative,
    ordered_factors,
    ordered_terms,
    power_of,
)

# Kinds that have brackets around them, beside sums, as the argument of a function and as a base.
_ARGUMENTS = (tree.Row, tree.Power, tree.FunctionCall)
_BASES = (*_ARGUMENTS, tree.Numeral, tree.Fraction, tree.Rate)


@lru_cache(maxsize=8192)
def formula_of(expression: sp.Basic, letters: Letters) -> tree.Formula:
    """The expression or equation as a tree; raises AlgebraError for a node that has no form."""
    if isinstance(expression, sp.Eq):
        return tree.equal(*(formula_of(side, letters) for side in expression.args))
    return _ScalarWalk(letters).expression(letters.shortened(expression))


@lru_cache(maxsize=1024)
def factored(matrix: sp.ImmutableMatrix) -> tuple[sp.Expr, sp.ImmutableMatrix]:
    """What is in all entries, such as ½ M or 2/(n² + w²), and the matrix behind it."""
    entries = [entry for entry in matrix.flat() if entry != 0]
    below = set(map(_below, entries))
    if len(below) == 2 and any(_below(t) != 1 for e in entries if e.is_Add for t in e.args):
        below = {_below(sp.together(entry)) for entry in entries}  # 1 − 2 y²/d, 2 x y/d
    if len(entries) < 2 or len(below) > 1:
        return sp.S.One, matrix
    (divisor,) = below
    if divisor == 1 and all(map(_is_whole, entries)) and _constants_in_all(entries) == 1:
        return sp.S.One, matrix
    contents = [_over(entry, divisor).as_content_primitive() for entry in matrix]
    # Zeros divide by anything, and are left out of the common divisor.
    number = sp.gcd_list([content for content, rest in contents if rest != 0])
    constants = _constants_in_all([rest for _, rest in contents if rest != 0])
    if divisor == 1 and number.is_Integer and constants == 1:
        return sp.S.One, matrix
    rest = [
        content / number * sp.Add(*(term / constants for term in sp.Add.make_args(primitive)))
        for content, primitive in contents
    ]
    return number * constants / divisor, sp.ImmutableMatrix(*matrix.shape, rest)


@lru_cache(maxsize=8192)
def _is_whole(node: sp.Basic) -> bool:
    """Whether all numbers in it are whole, so that no fraction is in front of all of it."""
    return node.is_Integer if node.is_Number else all(map(_is_whole, node.args))


@lru_cache(maxsize=8192)
def _below(expression: sp.Expr) -> sp.Expr:
    """The denominator without its number."""
    return sp.fraction(expression)[1].as_coeff_Mul()[1]


def _over(entry: sp.Expr, divisor: sp.Expr) -> sp.Expr:
    """The numerator of an entry over a divisor."""
    if divisor == 1 or not entry.is_Add or divisor not in map(_below, entry.args):
        return entry * divisor
    return sp.Add(*(sp.expand(term * divisor) for term in entry.args))


def _constants_in_all(entries: Sequence[sp.Expr]) -> sp.Expr:
    """The product of the powers of symbols that every entry has as factors."""
    terms = [term for entry in entries for term in sp.Add.make_args(entry)]
    first, *others = (dict(map(power_of, sp.Mul.make_args(term))) for term in terms)
    common = sp.S.One
    for base, power in first.items():
        powers = [power, *(other.get(base, sp.S.Zero) for other in others)]
        if base.is_Symbol and all(p.is_Integer and p > 0 for p in powers):
            common *= base ** min(powers)
    return common


def listed_entries(
    names: Sequence[tree.Formula], matrix: sp.ImmutableMatrix
) -> list[tuple[tree.Formula, sp.Expr]]:
    """Each entry with its name, row by row; of a symmetric matrix six in place of nine.

    Two entries that are equal by symmetry have both names: I₁₂ = I₂₁.
    """
    rows, columns = matrix.shape
    places = [(i, j) for i in range(rows) for j in range(columns)]
    if matrix != matrix.T:
        return [*zip(names, matrix, strict=True)]
    return [
        (tree.equal(*dict.fromkeys((names[columns * i + j], names[columns * j + i]))), matrix[i, j])
        for i, j in places
        if i <= j
    ]


@lru_cache(maxsize=1024)
def matrix_of(matrix: sp.ImmutableMatrix, letters: Letters) -> tree.Matrix:
    return tree.Matrix(
        tuple(tuple(formula_of(entry, letters) for entry in line) for line in matrix.tolist())
    )


class _ScalarWalk:
    """One walk over an expression."""

    def __init__(self, letters: Letters) -> None:
        self.letters = letters

    def expression(self, node: sp.Expr) -> tree.Formula:
        if node.is_Rational:
            return _rational(node)
        if node.is_Add:
            first, *others = ordered_terms(node.args, self.letters)
            parts = [self.expression(first)]
            for term in others:
                minus = is_negative(term)
                value = self.expression(-term if minus else term)
                parts += [tree.MINUS if minus else tree.PLUS, tree.bracketed(value)]
            return tree.row(*parts)
        if node.is_Mul or _is_reciprocal(node):
            return self._product(node)
        if node.is_Pow:
            return self._power(node)
        if node.func in FUNCTIONS:
            angle = node.args[0]
            number, rest = angle.as_coeff_Mul()
            argument = self.expression(angle)
            # a number and a name need no brackets: sin 2θ
            if not (number.is_Integer and number.is_positive and _is_name(rest)):
                argument = tree.bracketed(argument, _ARGUMENTS)
            return tree.FunctionCall(FUNCTIONS[node.func], argument)
        if is_application(node):
            inside = tree.joined([self.expression(part) for part in node.args], tree.COMMA)
            return tree.FunctionCall(node.func.__name__, tree.Bracket(inside))
        return self.letters.name(node)

    def _product(self, node: sp.Expr) -> tree.Formula:
        if is_negative(node):
            return tree.row(tree.MINUS, tree.bracketed(self.expression(-node)))
        coefficient, rest = node.as_coeff_Mul()
        factors = ordered_factors(sp.Mul.make_args(rest), self.letters)
        below = [sp.Pow(f.base, -f.exp) for f in factors if _is_reciprocal(f)]
        above = [factor for factor in factors if not _is_reciprocal(factor)]
        if below or (len(above) == 1 and self._goes_above(above[0])):
            numerator = self._many(_scaled(coefficient.p, above))
            denominator = _scaled(coefficient.q, below)
            return tree.Fraction(numerator, self._many(denominator)) if denominator else numerator
        roots = [factor for factor in above if _is_root(factor)]
        others = [factor for factor in above if not _is_root(factor)]
        return self._many(_scaled(sp.Mul(coefficient, *roots), others))  # √2/2 is one number

    def _goes_above(self, factor: sp.Expr) -> bool:
        """Whether θ/2 and √2/2 are written so; ½ dθ/dt and ½ sin θ are not."""
        is_name = _is_name(factor) and isinstance(self.expression(factor), tree.Symbol)
        is_dotted = self.letters.notation.rates == "fraction" and bool(
            self.letters.places.get(factor, NO_RATE)[0]
        )
        return (is_name and not is_dotted) or _is_root(factor)

    def _many(self, factors: Sequence[sp.Expr]) -> tree.Formula:
        """The product of factors in order; a single factor is not bracketed."""
        if len(factors) < 2:
            return self.expression(factors[0] if factors else sp.S.One)
        return tree.row(*(tree.bracketed(self.expression(factor)) for factor in factors))

    def _power(self, node: sp.Pow) -> tree.Formula:
        base, exponent = node.base, node.exp
        if exponent == sp.Rational(1, 2):
            return tree.Radical(self.expression(base))
        if not exponent.is_Rational:
            self.letters.name(node)  # raises: a general power has no name
        if (base.func in FUNCTIONS or is_application(base)) and exponent.is_Integer:
            call = self.expression(base)
            assert isinstance(call, tree.FunctionCall)
            return replace(call, exponent=int(exponent))
        whole = tree.bracketed(self.expression(base), _BASES)
        if exponent.is_Integer:
            return tree.Power(whole, tree.Numeral(str(exponent.p)))
        above, below = (tree.Numeral(str(n)) for n in (exponent.p, exponent.q))
        return tree.Power(whole, tree.row(above, tree.Sign("/"), below))


def _rational(number: sp.Rational) -> tree.Formula:
    if number.is_negative:
        return tree.row(tree.MINUS, _rational(-number))
    if number.is_Integer:
        return tree.Numeral(str(number))
    return tree.Fraction(tree.Numeral(str(number.p)), tree.Numeral(str(number.q)))


def _scaled(number: sp.Expr, factors: Sequence[sp.Expr]) -> list[sp.Expr]:
    """The factors behind a number; 1 is not written."""
    return list(factors) if number == 1 else [sp.sympify(number), *factors]


def _is_reciprocal(node: sp.Expr) -> bool:
    return bool(node.is_Pow and node.exp.is_Rational and node.exp.is_negative)


def _is_name(node: sp.Expr) -> bool:
    return not (node.is_Add or node.is_Mul or node.is_Pow or is_application(node))


def _is_root(node: sp.Expr) -> bool:
    """Whether a node is the root of a number, which goes above the line: √2/2."""
    return bool(node.is_Pow and node.base.is_Number and node.exp == sp.Rational(1, 2))
