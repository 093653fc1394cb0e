"""Forms that keep their digits where a divisor vanishes: Stumpff functions and half angles.

The Stumpff functions of n², on which rotation vectors rest, are c₀ = cos n, c₁ = sin n/n,
c₂ = (1 − cos n)/n², c₃ = (n − sin n)/n³, and on by c_{k+2} = (c_k(0) − c_k)/n². Their closed
forms are 0/0 at n = 0 and lose digits near it; from c₃ on, a Taylor polynomial in x = n² takes over
below a switch. Its length follows from the first term left out (the terms alternate and fall), and
the switch from the rounding of the closed form, in rational numbers.

Quotients with removable singularities at n = 0, n = √(v·v), are written without them: an
expression in sin n, cos n and 1/n without a singularity at n = 0 is a polynomial in the functions
c_k and in the other generators. The form is put back into the ring, and must be equal there.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache, lru_cache
from math import factorial
from operator import mul

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.ring import Quotient, split
from rigidsym.errors import AlgebraError
from rigidsym.system.records import NamedTuple

_EPS = Fraction(1, 2**52)  # of float64; a shorter type needs no more terms
_LEFT_OUT = _EPS / 16  # of the value: the most that the first term left out may be
_CLOSED = Fraction(4)  # eps: the largest rounding error of a closed form above its switch
_ELEMENTARY = Fraction(3)  # eps: of c₁ and c₂ by t = tan(n/2) within 1 eps, see `_closed_error`
_STEP = Fraction(1, 4)
_FURTHEST = 16  # x = n²: switches beyond gain nothing, and Horner's rule would lose
_TERMS = 20  # of the Taylor polynomials
FIRST_SERIES = 3  # c₀, c₁ and c₂ need none


class Series(NamedTuple):
    """c_k below its switch: Σ coefficients[j] x^j, x = n² < switch."""

    order: int  # k
    coefficients: tuple[Fraction, ...]
    switch: Fraction  # in x
    remainder: Fraction  # bound on what the series leaves out, relative to c_k
    error: Fraction  # bound on the relative error on both sides of the switch, in eps


@cache
def series_of(order: int) -> Series:
    """The series of c_k, k ≥ 3, with its switch and its bounds, derived."""
    # The closed form loses digits by cancellation for small x and the series by truncation for
    # large x. The switch is as low as the error of the closed form permits, which keeps the series
    # short.
    switch = _STEP  # the least from which on the closed form keeps its bound
    while switch < _FURTHEST and _closed_error(order, switch) > _CLOSED:
        switch += _STEP
    closed = _closed_error(order, switch)
    value = _enclosed(order, switch)[0]
    terms = taylor(order)
    # Below the switch c_k falls with x while the terms grow, so the relative error is largest at
    # the switch.
    left_out = (abs(term) * switch**place / value for place, term in enumerate(terms))
    length = next(place for place, size in enumerate(left_out) if size <= _LEFT_OUT)
    remainder = abs(terms[length]) * switch**length / value
    # Horner's rule: the term of x^j comes through 2j + 2 roundings of half an eps
    sizes = (abs(term) * switch**j * (j + 1) for j, term in enumerate(terms[:length]))
    horner = sum(sizes, Fraction(0)) / value
    return Series(
        order=order,
        coefficients=terms[:length],
        switch=switch,
        remainder=remainder,
        error=max(closed, horner + remainder / _EPS),
    )


@cache
def taylor(order: int) -> tuple[Fraction, ...]:
    """The Taylor coefficients of c_k in x = n²: (−1)^j/(2j + k)!."""
    return tuple(Fraction((-1) ** j, factorial(2 * j + order)) for j in range(_TERMS))


def closed_form(order: int, angle: sp.Expr) -> sp.Expr:
    """c_k of an angle n in sines and cosines."""
    if order < 2:
        return sp.sin(angle) / angle if order else sp.cos(angle)
    # c_k = (c_{k−2}(0) − c_{k−2})/n² with c_j(0) = 1/j!
    first = taylor(order - 2)[0]
    start = sp.Rational(first.numerator, first.denominator)
    return (start - closed_form(order - 2, angle)) / angle**2


def _closed_error(order: int, x: Fraction) -> Fraction:
    """Bound on the relative rounding error of (c_k(0) − c_k)/x from x on, in eps.

    c_k comes with an error of its own, which counts by its share of the difference; to the right
    of x that share is smaller still, since c_k is. c₁ = 2t/(1 + t²)/n has four roundings of half an
    eps and an error of t that is multiplied by (1 − t²)/(1 + t²); c₂ = 2t²/(1 + t²)/n² one more,
    and the error of t times 2/(1 + t²), at most one where c₂ has a share, n > π/2.
    """
    before, above = taylor(order - 2)[0], _enclosed(order - 2, x)[1]
    inherited = series_of(order - 2).error if order - 2 >= FIRST_SERIES else _ELEMENTARY
    return inherited * above / (before - above) + 1  # the difference and the quotient


def _enclosed(order: int, x: Fraction) -> tuple[Fraction, Fraction]:
    """Bounds on c_k(x): neighbouring partial sums of an alternating series."""
    total = Fraction(0)
    sums = [total := total + term * x**place for place, term in enumerate(taylor(order))]
    return min(sums[-2:]), max(sums[-2:])


# From sines, cosines and 1/n to Stumpff functions


_HIGHEST = 8  # c_8: the highest that is tried
_POWERS = 6  # of 1/n that are looked for below a fraction bar

Orders = tuple[int, ...]  # of the functions c_k in one product, in order
Product = tuple[Orders, int]  # of functions and a power of 1/n²


class Stumpff(sp.Function):
    """The Stumpff function c_k of n², unevaluated: Stumpff(k, n²)."""

    nargs = 2


def stable_forms(
    groups: Iterable[Sequence[sp.Expr]],
    given: Sequence[sp.Expr],
    constraints: Sequence[sp.Expr] = (),
) -> list[list[sp.Expr]]:
    """Groups of entries in Stumpff functions if there is a norm, else over half angles.

    An entry without such a form stays as it is. `given` are the expressions that the entries were
    derived from.
    """
    rewriter = None  # unless there is exactly one norm
    if any(map(_has_root, given)):
        rewriter = rewriter_for(codec_for(given, constraints=constraints, order=2))
    if rewriter is None:
        return [halved(entries, given, constraints) for entries in groups]
    return [[rewriter.stable(entry) for entry in entries] for entries in groups]


def at_zero(form: sp.Expr) -> sp.Expr:
    """A form in Stumpff functions at zero coordinates, where n = 0."""
    flat = form.replace(Stumpff, lambda k, _: sp.Rational(*taylor(int(k))[0].as_integer_ratio()))
    return flat.xreplace(dict.fromkeys(flat.atoms(AppliedUndef), sp.S.Zero))


class _Norm(NamedTuple):
    """The places of n, its powers, sin rn and cos rn among the generators of a ring."""

    expression: sp.Expr  # n
    ratio: sp.Rational  # r
    sine: int
    cosine: int
    powers: Mapping[int, int]  # place: power of n that stands there


@lru_cache(maxsize=1 << 14)
def _has_root(expression: sp.Expr) -> bool:
    """Whether an angle in it is a multiple of a root.

    Remembered part by part: a product of many turns has few different parts, but grows
    exponentially where each of them is visited wherever it occurs, as `atoms` does.
    """
    if isinstance(expression, sp.sin | sp.cos):
        return _is_root(expression.args[0].as_coeff_Mul()[1])
    return any(_has_root(part) for part in expression.args)


def _is_root(expression: sp.Expr) -> bool:
    return bool(expression.is_Pow and expression.exp == sp.Rational(1, 2))


def halved(
    entries: Sequence[sp.Expr], given: Iterable[sp.Expr], constraints: Sequence[sp.Expr] = ()
) -> list[sp.Expr]:
    """The entries over half of each angle whose 1 ± cos divides, proved equal.

    1 − cos θ = 2 sin² θ/2 keeps its digits where it vanishes; over the half angle the quotient
    loses what its two sides have in common, sin θ/(1 − cos θ) = cot θ/2.
    `given` are the expressions that the entries were derived from.
    """
    angles = dict.fromkeys(angle for entry in entries for angle in _vanishing(entry))
    if not angles:
        return list(entries)
    codec = codec_for([*given, *(sp.sin(angle / 2) for angle in angles)], constraints=constraints)
    present = presenter_for(codec)
    return [present.quotient(codec.encode_quotient(entry)) for entry in entries]


@lru_cache(maxsize=4096)  # of the same entries for every language
def _vanishing(entry: sp.Expr) -> tuple[sp.Expr, ...]:
    """The angles of the divisors a ± a cos θ."""
    found = []
    for power in entry.atoms(sp.Pow):
        # a ± a cos θ, which vanishes at θ = π or 0; a + b cos θ with |b| ≠ |a| is left alone.
        number, rest = power.base.as_coeff_Add()
        size, cosine = rest.as_coeff_Mul()
        if power.exp.is_negative and isinstance(cosine, sp.cos) and abs(size) == abs(number):
            found.append(cosine.args[0])
    return tuple(found)


@lru_cache(maxsize=32)
def rewriter_for(codec: Codec) -> Rewriter | None:
    """The rewriter of a ring with sines, cosines and the inverse of one norm; else None."""
    index = codec.ring.index
    norms: list[_Norm] = []  # the roots n with 1/n, sin rn and cos rn in the ring
    for sine, cosine in codec.angle_pairs:
        ratio, root = codec.ring.generators[sine].expression.args[0].as_coeff_Mul()
        if _is_root(root) and 1 / root in index:
            powers = {index[root**k]: k for k in (1, -1, -2) if root**k in index}
            norms.append(_Norm(root, ratio, sine, cosine, powers))
    return Rewriter(codec, norms[0]) if len(norms) == 1 else None


class Rewriter:
    """The way from one ring to polynomials in the functions c_k; remembers what it has found."""

    def __init__(self, codec: Codec, norm: _Norm) -> None:
        self.codec = codec
        self._norm = norm
        angle = norm.ratio * norm.expression
        self._functions = [Stumpff(k, angle**2) for k in range(_HIGHEST + 1)]
        self._closed = {f: closed_form(k, angle) for k, f in enumerate(self._functions)}
        self._symbols = [sp.Dummy(f"c{k}") for k in range(_HIGHEST + 1)]
        # The target ring has c_0, c_1, ... in place of n, 1/n, sin rn and cos rn.
        special = {norm.sine, norm.cosine, *norm.powers}
        others = [g.expression for k, g in enumerate(codec.ring.generators) if k not in special]
        self._plain = codec_for([*self._symbols, *others], order=0)
        self._whole = cache(self._in_functions)

    def stable(self, entry: sp.Expr) -> sp.Expr:
        """The entry in terms of `Stumpff` if it moves and has such a form; else as it is."""
        form = self.rewritten(entry) if entry.has(AppliedUndef) else None
        return entry if form is None else form  # which may be zero

    def rewritten(self, expression: sp.Expr) -> sp.Expr | None:
        """The expression in terms of `Stumpff`, proved equal; None if a singularity remains.

        What stands below a fraction bar may still vanish, but not at n = 0 for all v.
        """
        value, reduce = self.codec.encode_quotient(expression), self.codec.ring.reduce
        # Above and below are both divided by n^power, which leaves the quotient as it is. The
        # highest power at which both stay regular at n = 0 cancels the whole singularity.
        for power in range(_POWERS, -_POWERS - 1, -1):
            below = self._whole(reduce(value.denominator * self._n(-power)))
            if below is None:
                continue
            above = self._whole(reduce(value.numerator * self._n(-power)))
            if above is None:
                continue
            parts = map(self._plain.encode, (above, below))
            form = presenter_for(self._plain).quotient(Quotient(self._plain.ring, *parts))
            form = form.xreplace(dict(zip(self._symbols, self._functions, strict=True)))
            if not self.codec.encode_quotient(form.xreplace(self._closed)).equals(value):
                raise AlgebraError(f"the form {form} differs from its normal form")
            return form
        return None

    def _in_functions(self, element: PolyElement) -> sp.Expr | None:
        """An element as a polynomial in the functions, by their symbols; None if it is none.

        It is split by powers of cos rn = c₀, sin rn = rn c₁ and 1/n². No 1/n² stays beside a
        function, since c_k/n² = c_k(0)/n² − r² c_{k+2}.
        """
        ring, norm = self.codec.ring, self._norm
        parts: dict[Product, PolyElement] = defaultdict(lambda: ring.zero)
        places = (norm.sine, norm.cosine, *norm.powers)
        for (sines, cosines, *others), before in split(element, places).items():
            power = -sines - sum(map(mul, others, norm.powers.values()))
            # An odd power of n, as n² has none, is not analytic in the components of v.
            if power % 2:
                return None
            key = (0,) * cosines + (1,) * sines, power // 2
            parts[key] += before * ring.polynomials(norm.ratio**sines)
        done: dict[Orders, PolyElement] = defaultdict(lambda: ring.zero)
        while parts:
            (orders, power), before = parts.popitem()
            if power <= 0 or not orders or orders[0] + 2 > _HIGHEST:
                done[orders if power <= 0 else ()] += before * self._n(-2 * power)
                continue
            first, *rest = orders
            start = ring.polynomials(sp.Rational(*taylor(first)[0].as_integer_ratio()))
            parts[tuple(rest), power] += before * start
            raised = tuple(sorted((*rest, first + 2)))
            parts[raised, power - 1] -= before * ring.polynomials(norm.ratio**2)
        # Singular parts of different products may cancel here. What remains with a power of n is
        # singular, since n² itself reduces to v·v.
        terms = {orders: ring.reduce(before) for orders, before in done.items()}
        if any(m[place] for before in terms.values() for m in before for place in norm.powers):
            return None
        return sp.Add(
            *(
                self.codec.decode(before) * sp.Mul(*(self._symbols[k] for k in orders))
                for orders, before in terms.items()
            )
        )

    def _n(self, power: int) -> PolyElement:
        """n to a power."""
        ring = self.codec.ring
        norm = self._norm.expression
        return ring.generator(ring.index[norm if power > 0 else 1 / norm]) ** abs(power)
