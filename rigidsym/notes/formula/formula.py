"""SymPy scalars as people read them: LaTeX, or one line of Unicode.

One walk over the expression settles what is written and in which order; a pen writes it. A sum
never starts with a minus sign if it has a positive term, and no rate ever follows a sine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from rigidsym.mechanics.derivation import Markup
from rigidsym.notes.formula.notation import Notation
from rigidsym.notes.formula.order import (
    FUNCTIONS,
    is_application,
    is_negative,
    ordered_factors,
    ordered_terms,
)
from rigidsym.notes.formula.pens import Binding, LatexPen, Pen, Piece, ShorthandPen, TextPen


def latex(expression: sp.Expr, notation: Notation, *, shorthand: bool = False) -> str:
    """The expression in LaTeX; with `shorthand`, s_θ and c_θ for sine and cosine.

    Raises AlgebraError, naming its type, for a node that has no printed form.
    """
    return write(expression, notation, ShorthandPen() if shorthand else LatexPen())


def text(expression: sp.Expr, notation: Notation) -> str:
    """The expression in one line of Unicode; raises AlgebraError as `latex` does."""
    return write(expression, notation, TextPen())


def markup(expression: sp.Expr, notation: Notation) -> Markup:
    """The expression both ways."""
    return Markup(latex(expression, notation), text(expression, notation))


def write(expression: sp.Expr, notation: Notation, pen: Pen) -> str:
    return _written(sp.sympify(expression), notation, type(pen))


@lru_cache(maxsize=8192)
def _written(expression: sp.Expr, notation: Notation, pen: type[Pen]) -> str:
    """One formula; the terminal, the note and its phone layout ask for the same ones again."""
    return _Walk(notation, pen()).expression(notation.shortened(expression)).text


@dataclass(frozen=True, slots=True)
class _Walk:
    """One walk, with one pen."""

    notation: Notation
    pen: Pen

    def expression(self, node: sp.Expr) -> Piece:
        if node.is_Rational:
            return self._rational(node)
        if node.is_Add:
            return self._sum(node)
        if node.is_Mul or _is_reciprocal(node):
            return self._product(node)
        if node.is_Pow:
            return self._power(node)
        if node.func in FUNCTIONS:
            return self._call(node, 1)
        if is_application(node):
            arguments = [self.expression(argument).text for argument in node.args]
            return Piece(self.pen.application(node.func.__name__, arguments), Binding.CALL)
        name = self.notation.name(node)
        binding = Binding.FRACTION if r"\frac" in name.latex else Binding.NAME
        return Piece(self.pen.name(name), binding)

    def _rational(self, number: sp.Rational) -> Piece:
        if number.is_negative:
            return Piece(self.pen.minus + self._rational(-number).text, Binding.SUM)
        if number.is_Integer:
            return Piece(str(number), Binding.NUMBER)
        return self.pen.quotient(str(number.p), str(number.q))

    def _sum(self, node: sp.Add) -> Piece:
        first, *others = ordered_terms(node.args, self.notation)
        text = self.expression(first).text
        for term in others:
            if is_negative(term):
                text += f" {self.pen.minus} " + self._inside_sum(-term)
            else:
                text += " + " + self._inside_sum(term)
        return Piece(text, Binding.SUM)

    def _inside_sum(self, term: sp.Expr) -> str:
        return self._at_least(Binding.QUOTIENT, self.expression(term)).text

    def _product(self, node: sp.Expr) -> Piece:
        if is_negative(node):
            return Piece(self.pen.minus + self._inside_sum(-node), Binding.SUM)
        coefficient, rest = node.as_coeff_Mul()
        factors = ordered_factors(sp.Mul.make_args(rest), self.notation)
        below = [_inverted(factor) for factor in factors if _is_reciprocal(factor)]
        above = [factor for factor in factors if not _is_reciprocal(factor)]
        if below or (len(above) == 1 and self._stands_above(above[0])):
            return self._quotient(_scaled(coefficient.p, above), _scaled(coefficient.q, below))
        roots = [factor for factor in above if _is_root(factor)]
        others = [factor for factor in above if not _is_root(factor)]
        return self._many(_scaled(sp.Mul(coefficient, *roots), others))  # √2/2 is one number

    def _stands_above(self, factor: sp.Expr) -> bool:
        """Whether θ/2 and √2/2 are written so; ½ dθ/dt and ½ sin θ are not."""
        is_name = _is_name(factor) and self.expression(factor).binding == Binding.NAME
        return is_name or _is_root(factor)

    def _quotient(self, above: Sequence[sp.Expr], below: Sequence[sp.Expr]) -> Piece:
        numerator = self._at_least(self.pen.above, self._many(above))
        if not below:
            return numerator
        denominator = self._at_least(self.pen.below, self._many(below))
        return self.pen.quotient(numerator.text, denominator.text)

    def _many(self, factors: Sequence[sp.Expr]) -> Piece:
        """The product of factors that stand in order; one factor alone is not bracketed."""
        if len(factors) < 2:
            return self.expression(factors[0] if factors else sp.S.One)
        return Piece(self.pen.product([self._factor(f) for f in factors]), Binding.PRODUCT)

    def _factor(self, node: sp.Expr) -> Piece:
        if node.is_Rational and not node.is_Integer:
            return self.pen.fraction(int(node.p), int(node.q))
        return self._at_least(Binding.PRODUCT, self.expression(node))

    def _power(self, node: sp.Pow) -> Piece:
        base, exponent = node.base, node.exp
        if exponent == sp.Rational(1, 2):
            return self.pen.root(self.expression(base))
        if not exponent.is_Rational:
            self.notation.name(node)  # raises: no name stands for a general power
        if base.func in FUNCTIONS and exponent.is_Integer:
            return self._call(base, int(exponent))
        whole = self._at_least(Binding.NAME, self.expression(base))
        return Piece(self.pen.power(whole.text, str(exponent)), Binding.POWER)

    def _call(self, node: sp.Function, exponent: int) -> Piece:
        angle = node.args[0]
        argument = self.expression(angle)
        if not _is_multiple(angle):
            argument = self._at_least(Binding.NUMBER, argument)
        return self.pen.call(FUNCTIONS[node.func], exponent, argument)

    def _at_least(self, binding: Binding, piece: Piece) -> Piece:
        """The piece, in brackets where it is held together less tightly."""
        if piece.binding >= binding:
            return piece
        return Piece(self.pen.bracket(piece.text), Binding.BRACKET)


def _scaled(number: sp.Expr, factors: Sequence[sp.Expr]) -> list[sp.Expr]:
    """The factors behind a number; 1 is not written."""
    return list(factors) if number == 1 else [sp.sympify(number), *factors]


def _is_reciprocal(node: sp.Expr) -> bool:
    return bool(node.is_Pow and node.exp.is_Rational and node.exp.is_negative)


def _inverted(node: sp.Pow) -> sp.Expr:
    return sp.Pow(node.base, -node.exp)


def _is_name(node: sp.Expr) -> bool:
    return not (node.is_Add or node.is_Mul or node.is_Pow or is_application(node))


def _is_root(node: sp.Expr) -> bool:
    """Whether a node is the root of a number, which stands above the line: √2/2."""
    return bool(node.is_Pow and node.base.is_Number and node.exp == sp.Rational(1, 2))


def _is_multiple(angle: sp.Expr) -> bool:
    """Whether an angle is written as a number and a name: 2θ."""
    number, rest = angle.as_coeff_Mul()
    return bool(number.is_Integer and number.is_positive and _is_name(rest))
