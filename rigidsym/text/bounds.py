"""Arithmetic on expressions that refuses results too large before they are computed.

SymPy computes at once: 9**9**9 in full, the sign of sin(exp(1e40)) to as many digits as needed,
the prime factors of a number under a root. Texts from strangers are read with these operations
instead; each takes the column in the text, for its message.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from math import ceil, comb

import sympy as sp

from rigidsym.errors import ExpressionError
from rigidsym.system.records import NamedTuple

_OPERATIONS: dict[str, Callable[[sp.Expr, sp.Expr], sp.Expr]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}

_LIMITS = {"degree": 64, "number of terms": 2000, "number of binary digits": 4096}
_HIGHEST_EXPONENT = 64
_HIGHEST_INSIDE = 8  # degree of the argument of a function
_LARGEST_CONSTANT = 1000  # as the argument of a function
_LONGEST_ROOT = 64  # binary digits of a number under a root

FUNCTIONS: dict[str, Callable[..., sp.Expr]] = {
    **{name: getattr(sp, name) for name in ("sin", "cos", "tan", "cot")},
    "sec": lambda angle: 1 / sp.cos(angle),  # SymPy's own raises AttributeError for some sums
    "csc": lambda angle: 1 / sp.sin(angle),
    **{name: getattr(sp, name) for name in ("asin", "acos", "atan", "atan2")},
    **{name: getattr(sp, name) for name in ("sinh", "cosh", "tanh", "exp", "log", "sqrt")},
    "abs": sp.Abs,
}


class Sized(NamedTuple):
    """An expression, and bounds on its size when expanded."""

    expression: sp.Expr
    degree: int
    terms: int
    bits: int  # binary digits of the numbers in it

    @classmethod
    def number(cls, value: sp.Rational) -> Sized:
        return cls(value, 0, 1, _bits(value))

    @classmethod
    def atom(cls, expression: sp.Expr, bits: int = 1) -> Sized:
        return cls(expression, 1, 1, bits)


def operate(operation: str, left: Sized, right: Sized, column: int) -> Sized:
    """left + right, -, *, / or **; raises ExpressionError for others and if it is too large."""
    if operation == "**":
        return _power(left, right, column)
    if operation not in _OPERATIONS:
        raise ExpressionError(f"{operation} is not allowed", column=column)
    if operation == "/" and right.expression == 0:
        raise ExpressionError("division by zero", column=column)
    # Bounds for the fully expanded result: a sum has the terms of both, a product every term of one
    # with every term of the other; digits of products add, and a sum of fractions with different
    # denominators is as long as a product.
    bits = left.bits + right.bits + 1
    if operation in "+-":
        degree, terms = max(left.degree, right.degree), left.terms + right.terms
    else:
        degree, terms = left.degree + right.degree, left.terms * right.terms
    _check_size(degree, terms, bits, column)
    return Sized(_OPERATIONS[operation](left.expression, right.expression), degree, terms, bits)


def _power(base: Sized, exponent: Sized, column: int) -> Sized:
    power = exponent.expression
    if not power.is_Rational:
        raise ExpressionError(
            "expected a number as exponent, such as 2 or (1/2); for powers of e write exp(...)",
            column=column,
        )
    if abs(power) > _HIGHEST_EXPONENT or power.q > _HIGHEST_EXPONENT:
        raise ExpressionError(
            f"expected an exponent between -{_HIGHEST_EXPONENT} and {_HIGHEST_EXPONENT}",
            column=column,
        )
    if power < 0 and base.expression == 0:
        raise ExpressionError("division by zero", column=column)
    # SymPy takes squares out of √n by the prime factors of n.
    if power.q > 1 and longest_number(base.expression) > _LONGEST_ROOT:
        raise ExpressionError("too large: a root of a number with too many digits", column=column)
    # (a₁ + ... + a_k)ⁿ has as many terms as there are monomials of degree n in k letters, the
    # binomial coefficient C(k + n − 1, n).
    times = ceil(abs(power))
    degree, bits = base.degree * times, base.bits * times + 1
    terms = comb(base.terms + times - 1, times)
    _check_size(degree, terms, bits, column)
    value = base.expression**power
    _check_value(value, "a power", column)
    return Sized(value, degree, terms, bits)


def longest_number(expression: sp.Expr) -> int:
    """Binary digits of the longest number in it: SymPy factors those under a root."""
    return max(map(_bits, expression.atoms(sp.Rational)), default=0)


def _bits(number: sp.Rational) -> int:
    return int(number.p).bit_length() + int(number.q).bit_length()


def apply(function: str, arguments: Sequence[Sized], column: int) -> Sized:
    """The value of one of FUNCTIONS; raises ExpressionError if it is not finite and real."""
    if function == "sqrt":
        return _power(arguments[0], Sized.number(sp.Rational(1, 2)), column)
    expressions = [argument.expression for argument in arguments]
    if function == "exp" and expressions[0].has(sp.log):
        # SymPy turns exp(n*log(2)) into 2**n at once, however large n is.
        raise ExpressionError("a logarithm inside exp; write a power instead", column=column)
    for argument in arguments:
        _check_argument(argument, column)
    value = FUNCTIONS[function](*expressions)
    _check_value(value, function, column)
    return Sized.atom(value, bits=sum(argument.bits for argument in arguments) + 1)


def _check_argument(argument: Sized, column: int) -> None:
    """Refuse arguments whose sign or real part SymPy would seek for ever: sin(exp(1e40))."""
    most = _LARGEST_CONSTANT
    numbers = [term for term in sp.Add.make_args(argument.expression) if term.is_number]
    if argument.degree > _HIGHEST_INSIDE:
        fault = f"a degree above {_HIGHEST_INSIDE} inside a function"
        raise ExpressionError(f"too large: {fault}", column=column)
    if any(number.has(sp.Function) for number in numbers):
        raise ExpressionError("too large: a function of a function of numbers", column=column)
    if any(not -most <= number <= most for number in numbers):
        fault = f"a number outside -{most} to {most} inside a function"
        raise ExpressionError(f"too large: {fault}", column=column)


def _check_size(degree: int, terms: int, bits: int, column: int) -> None:
    for (name, most), size in zip(_LIMITS.items(), (degree, terms, bits), strict=True):
        if size > most:
            raise ExpressionError(f"too large: expanded, its {name} exceeds {most}", column=column)


def _check_value(value: sp.Expr, what: str, column: int) -> None:
    if value.has(sp.zoo, sp.oo, -sp.oo, sp.nan):
        raise ExpressionError(f"{what} of this is not finite", column=column)
    if value.has(sp.I) or (value.is_number and value.is_real is False):
        raise ExpressionError(f"{what} of this is not a real number", column=column)
