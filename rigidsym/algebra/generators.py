"""The generators that a set of expressions needs, closed under d/dt.

Nothing here is specific to rotations: the input is any expression, such as a quaternion, a mass or
a potential, and the output the generators of a ring.

Arguments of sine and cosine are rational combinations of atoms. Independent ones are the angles of
generators themselves, such as 2φ − ψ beside ψ/3. Dependent ones are expanded over the smallest
fraction of each atom that occurs, so that cos 2θ and cos θ meet in one ring.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import sympy as sp
from sympy.core.add import _unevaluated_Add
from sympy.core.function import AppliedUndef

from rigidsym.errors import AlgebraError

Combination = dict[sp.Expr, sp.Rational]
_NEARLY_ZERO = 1e-20  # beyond which a number is not zero, and its polynomial need not be found


def added(*terms: sp.Expr) -> sp.Expr:
    """The sum, sooner than by `sp.Add` if no two terms are alike.

    The first sum of `sp.Add` imports tensors and permutation groups, to ask whether terms are any:
    a thirteenth of the time that SymPy itself takes.
    """
    parts = [part for term in terms for part in sp.Add.make_args(term)]
    are_alike = len({part.as_coeff_Mul()[1] for part in parts}) < len(parts)
    return sp.Add(*parts) if are_alike else _unevaluated_Add(*parts)


@lru_cache(maxsize=1024)
def combination(argument: sp.Expr) -> Combination:
    """{atom: rational coefficient} of an angle; the atom π carries a constant part."""
    terms = sp.expand(argument).as_coefficients_dict()
    if any(map(_is_quotient, terms)):
        # What cancels is no atom of its own, beside quotients that do not cancel.
        cancelled = sp.expand(sp.cancel(argument)).as_coefficients_dict()
        terms = min(cancelled, terms, key=lambda parts: sum(map(_is_quotient, parts)))
    # Irrational multiples of one thing are atoms, so that combinations of arguments are those of
    # their atoms; but together they may add up to zero.
    multiples: dict[sp.Expr, sp.Expr] = {}
    for atom, coefficient in terms.items():
        if not coefficient.is_Rational:
            raise not_exact(coefficient)
        number, rest = atom.as_independent(sp.Symbol, AppliedUndef, as_Add=False)
        multiples[rest] = multiples.get(rest, sp.S.Zero) + coefficient * number
    combined: Combination = {}
    for rest, total in multiples.items():
        for number in () if is_identically_zero(total) else sp.Add.make_args(total):
            coefficient, factor = number.as_content_primitive()
            sign = -1 if factor.could_extract_minus_sign() else 1
            atom = sign * factor * rest
            combined[atom] = combined.get(atom, sp.S.Zero) + sign * coefficient
    return {atom: coefficient for atom, coefficient in combined.items() if coefficient}


def exact_angle(argument: sp.Expr) -> Combination:
    """The combination of an angle; raises AlgebraError if its sine has no exact form."""
    terms = combination(argument)
    if sp.S.One in terms:
        raise AlgebraError(
            f"sin and cos of {in_names(argument)} have no exact form: expected a multiple of pi "
            "(angles are in radians, 30° is pi/6), or a symbol for the number"
        )
    cosine_sine_of_pi(terms.get(sp.pi, sp.S.Zero))
    return terms


class Basis:
    """Independent angles, and others as combinations of them."""

    def __init__(self, angles: Iterable[sp.Expr] = ()) -> None:
        # Gaussian elimination: each angle is solved for one of its atoms, which thereby is a
        # combination of angles and of atoms that later angles are solved for.
        self._solutions: dict[sp.Expr, Combination] = {}
        self._angles: set[sp.Expr] = set()
        for angle in angles:
            self.add(angle)

    def add(self, angle: sp.Expr) -> bool:
        """Take an angle if it is independent of those before it; whether it is."""
        parts = self.parts(angle)
        pivot = next((atom for atom in parts if atom not in self._angles), None)
        if pivot is None:
            return False
        by = parts.pop(pivot)
        solution = {part: -coefficient / by for part, coefficient in parts.items()}
        self._solutions[pivot] = {**solution, angle: 1 / by}
        self._angles.add(angle)
        return True

    def parts(self, argument: sp.Expr) -> Combination:
        """{angle: rational coefficient} of an argument; an atom that is in no angle is kept."""
        parts = dict(combination(argument))
        for atom, solution in self._solutions.items():
            times = parts.pop(atom, sp.S.Zero)
            for part, coefficient in solution.items():
                parts[part] = parts.get(part, sp.S.Zero) + times * coefficient
        return {part: coefficient for part, coefficient in parts.items() if coefficient}


def _is_quotient(term: sp.Expr) -> bool:
    """Whether a term is divided by anything but a number."""
    powers = (factor for factor in sp.Mul.make_args(term) if factor.is_Pow)
    return any(p.exp.could_extract_minus_sign() and not p.base.is_number for p in powers)


def is_identically_zero(expression: sp.Expr) -> bool:
    """Whether an expression vanishes by expansion or, of algebraic numbers, by its polynomial."""
    expanded = sp.expand(expression)
    if any(map(_is_quotient, sp.Add.make_args(expanded))):
        expanded = sp.expand(sp.numer(sp.together(expanded)))
    if expanded == 0:
        return True
    # By Euler's formula, identities of sines and cosines become identities of polynomials in
    # exp(ix).
    if expression.has(sp.Function) and sp.expand(expression.rewrite(sp.exp)) == 0:
        return True
    if not expression.is_number or not expression.is_algebraic:
        return False
    # Zero is the only algebraic number whose minimal polynomial is x. To find that polynomial is
    # slow, so the value decides first: it shows that most numbers are not zero.
    return bool(
        abs(sp.N(expression, 30)) < _NEARLY_ZERO and sp.minimal_polynomial(expression).is_Symbol
    )


def angle_of(sine: sp.Expr, cosine: sp.Expr) -> sp.Expr:
    """The angle with a given sine and cosine; atan2 only if they name no angle themselves."""
    # (sin α, cos α) is at α, (−sin α, cos α) at −α, (sin α, −cos α) at π − α and (−sin α, −cos α)
    # at α + π. With sine and cosine exchanged, α is replaced by π/2 − α.
    for sign_of_sine in (1, -1):
        for sign_of_cosine in (1, -1):
            first, second = sign_of_sine * sine, sign_of_cosine * cosine
            if first.func is sp.sin and second == sp.cos(first.args[0]):
                angle = sign_of_sine * sign_of_cosine * first.args[0]
                return angle if sign_of_cosine > 0 else angle + sp.pi
            if first.func is sp.cos and second == sp.sin(first.args[0]):
                return sign_of_sine * (sp.pi / 2 - sign_of_cosine * first.args[0])
    return sp.atan2(sine, cosine)


def not_exact(number: sp.Float) -> AlgebraError:
    """The error for a floating-point number, with the fraction to write for it."""
    fraction = Fraction(str(number)).limit_denominator(10**12)
    return AlgebraError(
        f"{number} is a floating-point number; exact work needs a fraction such as {fraction}"
    )


def cosine_sine_of_pi(turns: sp.Rational) -> tuple[sp.Expr, sp.Expr]:
    """cos(turns·π) and sin(turns·π) by square roots; raises AlgebraError if there are none."""
    values = sp.cos(turns * sp.pi), sp.sin(turns * sp.pi)
    if any(value.has(sp.sin, sp.cos) for value in values):
        raise AlgebraError(
            f"cos and sin of {turns * sp.pi} are not square roots of numbers; "
            "give the angle a name instead"
        )
    return values


TIME = sp.Symbol("t")  # the time symbol of sympy.physics.vector.dynamicsymbols
_MOST_GENERATORS = 300  # a derivative that keeps bringing new functions must end somewhere


class Kind(IntEnum):
    """Kinds of generator, in the order of the monomials: what comes first is eliminated first."""

    INVERSE = 0  # 1/d, with i·d = 1
    RADICAL = 1  # r^(1/k), with g^k = r; also the imaginary unit
    SINE = 2  # with s² + c² = 1
    COSINE = 3
    OPAQUE = 4  # any other function: its relations are not known
    TIME_FUNCTION = 5  # a coordinate, one of its derivatives, or the time itself
    CONSTANT = 6


_QUOTIENTS = {  # function: numerator, denominator
    sp.tan: (sp.sin, sp.cos),
    sp.cot: (sp.cos, sp.sin),
    sp.sec: (None, sp.cos),
    sp.csc: (None, sp.sin),
}


@lru_cache(maxsize=1024)
def rate_of(expression: sp.Expr) -> sp.Expr:
    """d/dt of a generator's expression; the same few come up in every derivation.

    For the commonest generators the rule is applied here: SymPy searches a millisecond for it.
    """
    if is_time_function(expression):
        return sp.Derivative(expression, TIME)
    # The chain rule: d/dt sin u = u̇ cos u and d/dt cos u = −u̇ sin u.
    if isinstance(expression, sp.sin):
        return sp.cos(*expression.args) * rate_of(*expression.args)
    if isinstance(expression, sp.cos):
        return -sp.sin(*expression.args) * rate_of(*expression.args)
    return sp.diff(expression, TIME)


def as_sine_cosine(expression: sp.Expr) -> tuple[sp.Expr, sp.Expr] | None:
    """Numerator and denominator of tan, cot, sec and csc; None for anything else."""
    parts = _QUOTIENTS.get(expression.func)
    if parts is None:
        return None
    argument = expression.args[0]
    return parts[0](argument) if parts[0] else sp.S.One, parts[1](argument)


class GeneratorSet:
    """Generators found so far: `kinds` in order of discovery, and the angles among them."""

    def __init__(self, order: int | None) -> None:
        self.order = order
        self.kinds: dict[sp.Expr, Kind] = {}
        self._directions: Combination = {}  # of the angles, with the common divisor of their sizes
        self._underived: list[sp.Expr] = []
        self._seen: set[sp.Expr] = set()

    def generators(self) -> list[tuple[sp.Expr, Kind]]:
        """All generators in the order of their kinds, sines and cosines of `angles`."""
        generators = list(self.kinds.items())
        for angle in self.angles:
            generators += [(sp.sin(angle), Kind.SINE), (sp.cos(angle), Kind.COSINE)]
        return sorted(generators, key=lambda pair: pair[1])

    @cached_property
    def angles(self) -> tuple[sp.Expr, ...]:
        """The angles of generators; all that were collected are sums of whole multiples of them.

        In the order of the rates of their atoms, where those were asked for, so that rotations of
        the same coordinates share a ring. To be read once all is collected.
        """
        # The greatest common divisor of the coefficients: cos 2θ and sin(θ/3) are polynomials in
        # the cosine and sine of gcd(2, 1/3) θ = θ/3.
        common = self._directions
        if not all(map(Basis().add, common)):  # as of φ, ψ and φ + ψ, which are expanded
            common = {}
            for direction, size in self._directions.items():
                for atom, coefficient in combination(direction).items():
                    common[atom] = common.get(atom, sp.S.Zero).gcd(size * abs(coefficient))
        places = {expression: place for place, expression in enumerate(self.kinds)}

        def place_of(part: sp.Expr) -> int:
            return min(places.get(rate_of(atom), len(places)) for atom in combination(part))

        return tuple(common[part] * part for part in sorted(common, key=place_of))

    def close(self) -> None:
        """Take the time derivatives of all that was found, until nothing new appears."""
        while self._underived and self.order is not None:
            expression = self._underived.pop(0)
            if not is_highest(expression, self.order):
                self.collect(rate_of(expression))

    def collect(self, expression: sp.Expr) -> None:
        """Collect the generators of one expression; raises AlgebraError if no ring can hold it."""
        if expression in self._seen:
            return
        self._seen.add(expression)
        quotient = as_sine_cosine(expression)
        if quotient is not None:
            self.collect(quotient[0])
            self.collect(1 / quotient[1])
        elif expression.is_Add or expression.is_Mul:
            for part in expression.args:
                self.collect(part)
        elif expression.is_Pow and expression.exp.is_Rational:
            # b^(p/q) is (b^(1/q))^p: the root is a generator, and its inverse too if p is negative.
            base, exponent = expression.base, expression.exp
            self.collect(base)
            for root in [base] if exponent.q == 1 else roots_of(base, exponent.q):
                if exponent.q != 1:
                    self._add(root, Kind.RADICAL)
                if exponent.p < 0 and self.order is not None:
                    self._add(1 / root, Kind.INVERSE)
        elif isinstance(expression, sp.sin | sp.cos):
            self._collect_angle(expression.args[0])
        elif not expression.is_Rational:
            self._add(expression, _kind(expression))

    def _collect_angle(self, argument: sp.Expr) -> None:
        terms = exact_angle(argument)
        # By the addition theorem, sin(θ + π/4) = (sin θ + cos θ)/√2, so the ring needs these roots.
        for value in cosine_sine_of_pi(terms.get(sp.pi, sp.S.Zero)):
            self.collect(value)
        moving = [atom for atom in terms if atom is not sp.pi]
        size, direction = sp.Add(*(terms[atom] * atom for atom in moving)).primitive()
        if direction.could_extract_minus_sign():
            direction = -direction
        if moving:
            self._directions[direction] = self._directions.get(direction, sp.S.Zero).gcd(size)
        self._underived += moving

    def _add(self, expression: sp.Expr, kind: Kind) -> None:
        if expression in self.kinds:
            return
        if len(self.kinds) >= _MOST_GENERATORS:
            raise AlgebraError(
                f"more than {_MOST_GENERATORS} generators: the derivatives of "
                f"{in_names(expression)} contain ever new functions"
            )
        self.kinds[expression] = kind
        self._underived.append(expression)


def roots_of(base: sp.Expr, degree: int) -> list[sp.Expr]:
    """The root generators of base^(1/degree): one for each prime factor of a whole number."""
    if base.is_Integer:
        return [sp.Integer(prime) ** sp.Rational(1, degree) for prime in sp.factorint(base)]
    return [base ** sp.Rational(1, degree)]


def is_uncertain(expression: sp.Expr, kind: Kind) -> bool:
    """Whether relations of a generator to the others may be missing.

    √6 and √(x² + 1) may depend on what else there is, and so may the cosine of such a thing, or
    of a quotient; a function that the ring does not know depends on anything.
    """
    if kind in (Kind.RADICAL, Kind.OPAQUE):
        return True
    angle = expression.args[0] if kind in (Kind.SINE, Kind.COSINE) else sp.S.Zero
    powers = (p for p in angle.atoms(sp.Pow) if not (p.exp.is_Integer and p.exp > 0))
    functions = angle.atoms(sp.Function)
    return any(powers) or any(not is_time_function(f) for f in functions)


def is_highest(expression: sp.Expr, order: int) -> bool:
    """Whether this is a coordinate's highest derivative, which the ring cannot derive again."""
    return isinstance(expression, sp.Derivative) and expression.derivative_count >= order


def is_time_function(expression: sp.Expr) -> bool:
    """f(t) or a derivative of it by t, for an undefined function f."""
    if isinstance(expression, sp.Derivative):
        return set(expression.variables) == {TIME} and is_time_function(expression.expr)
    return isinstance(expression, AppliedUndef) and expression.args == (TIME,)


def in_names(value: Any) -> Any:
    """An expression or a matrix in the plain names of functions of time: theta, theta_dot."""
    rates = {
        rate: sp.Symbol(f"{rate.expr.func}_{'d' * rate.derivative_count}ot")
        for rate in filter(is_time_function, value.atoms(sp.Derivative))
    }
    moving = filter(is_time_function, value.atoms(AppliedUndef))
    return value.xreplace(rates).xreplace({f: sp.Symbol(str(f.func)) for f in moving})


@lru_cache(maxsize=1024)
def _kind(expression: sp.Expr) -> Kind:
    if expression is sp.I:
        return Kind.RADICAL
    if expression == TIME or is_time_function(expression):
        return Kind.TIME_FUNCTION
    if expression.is_Symbol or isinstance(expression, sp.NumberSymbol):
        return Kind.CONSTANT
    if expression.is_Float:
        raise not_exact(expression)
    if isinstance(expression, sp.Function | sp.Pow) and not expression.has(sp.zoo, sp.nan, sp.oo):
        return Kind.OPAQUE
    raise AlgebraError(f"{in_names(expression)} ({type(expression).__name__}) is not in the ring")
