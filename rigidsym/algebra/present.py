"""From normal form to textbook form, each choice proved equal before it is returned.

A normal form is for deciding, not for reading. The shortest of the equivalent polynomials is sought
(`ring.shortest`), and quotients of sine and cosine become tan and cot. Then

1. `_folded`: cos α cos β − sin α sin β is written cos(α + β). Terms come in over the generators of
   a ring and leave over more places: behind the generators are, for every two angles, the cosine
   and sine of their sum and of their difference.
2. `_sum`: common factors are taken out, in the order of what they save. Terms are Laurent monomials
   (a negative power divides), and a sum of products may hold sums in turn.
3. Quadratic forms keep their squares: ½ vᵀ M v is written ½A(v₁² + v₂²) + ½C v₃², a sum of squares
   of one weight in the shorter of two forms: the squares as they come, or multiplied out.

What was chosen is read back into the ring, and its difference from the value must reduce to zero.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from itertools import combinations
from math import gcd, lcm
from operator import sub
from random import Random
from typing import Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.generators import added
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import NUMBERS, Monomial, Quotient, shortest
from rigidsym.errors import AlgebraError
from rigidsym.system.records import NamedTuple

_PRIME = 2**61 - 1  # modulo which images of polynomials are compared
_MORE_TERMS = 2  # that a sum over one denominator may have; with more it is hardly ever shorter
Terms = Mapping[Monomial, Any]  # coefficients in Q


class Rule(NamedTuple):
    """first + sign · second = function(alpha ± beta), for products of two generators."""

    first: tuple[int, int]
    second: tuple[int, int]
    sign: int
    function: type[sp.sin] | type[sp.cos]
    angles: tuple[sp.Expr, sp.Expr]  # α and ±β


class Presenter:
    """Textbook forms of the elements of one ring; remembers what it has presented."""

    def __init__(self, codec: Codec) -> None:
        self.codec = codec
        self.ring = codec.ring
        self._generators = [gen.expression for gen in self.ring.generators]
        self._rules = tuple(self._addition_theorems())
        # the expression at a place of a monomial and the operations that one use of it costs; SymPy
        # takes long to make the function of a sum, and few are ever needed
        self._named = cache(self._expression)
        self._weight = cache(lambda place: _operations(self._named(place)))
        self._sum = cache(self._collected)  # many forms have sums in common
        self._sums_below = {
            place: codec.encode(1 / expression)
            for place, expression in enumerate(self._generators)
            if expression.is_Pow
            and expression.exp == -1
            and expression.base.is_Add
            and sp.sqrt(expression.base) not in self.ring.index  # half powers would divide too
        }
        self._known: dict[tuple[PolyElement, PolyElement], sp.Expr] = {}

    def _addition_theorems(self) -> Iterator[Rule]:
        """Those of every two angles."""
        for (s, c), (sine, cosine) in combinations(self.codec.angle_pairs, 2):
            alpha, beta = (self._generators[place].args[0] for place in (s, sine))
            plus, minus = (alpha, beta), (alpha, -beta)
            yield Rule((c, cosine), (s, sine), -1, sp.cos, plus)
            yield Rule((c, cosine), (s, sine), 1, sp.cos, minus)
            yield Rule((s, cosine), (c, sine), 1, sp.sin, plus)
            yield Rule((s, cosine), (c, sine), -1, sp.sin, minus)

    def _expression(self, place: int) -> sp.Expr:
        if place < len(self._generators):
            return self._generators[place]
        rule = self._rules[place - len(self._generators)]
        return rule.function(sp.Add(*rule.angles))

    def matrix(self, matrix: RingMatrix, divisor: PolyElement | None = None) -> sp.ImmutableMatrix:
        """The matrix, or the matrix divided by `divisor`, entry by entry."""
        below = self.ring.one if divisor is None else divisor
        entries = [self._over(entry, below) for entry in matrix.entries]
        return sp.ImmutableMatrix(*matrix.shape, entries, copy=False)

    def element(self, element: PolyElement) -> sp.Expr:
        """The textbook form of one element."""
        return self._over(self.ring.reduce(element), self.ring.one)

    def quotient(self, value: Quotient) -> sp.Expr:
        """The textbook form of a quotient."""
        return self._over(value.numerator, value.denominator)

    def _over(self, above: PolyElement, below: PolyElement) -> sp.Expr:
        """The textbook form of above / below, both in normal form, proved equal."""
        if not above:
            return sp.S.Zero
        form = self._known.get((above, below))
        if form is None:
            form = self._known[above, below] = self._form(above, below)
            if not self.codec.encode_quotient(form).equals(Quotient(self.ring, above, below)):
                raise AlgebraError(f"the form {form} differs from its normal form")
        return form

    def _form(self, above: PolyElement, below: PolyElement) -> sp.Expr:
        # The shortest representatives come first, as common factors are visible only in them:
        # 1 − c² is s², and s²/s cancels.
        above, below = shortest(self.ring, above), shortest(self.ring, below)
        if len(below) > 1 and not _are_coprime(above, below):
            _, above, below = above.cofactors(below)
        if len(below) > 1:
            over, under = _leading_number(above), _leading_number(below)
            return sp.Mul(
                _rational(NUMBERS.quo(over, under)),
                self._terms(above, over),
                1 / self._terms(below, under),
            )
        if self.ring.is_one(below):
            plain, others = self._terms(above), [*self._over_one(above)]
            return min([plain, *others], key=sp.count_ops) if others else plain
        # A single term below the bar divides term by term, as negative powers, so that sin θ/cos θ
        # is found as tan θ inside a sum.
        ((divisor, scale),) = below.items()
        return self._terms({tuple(map(sub, m, divisor)): c for m, c in above.items()}, scale)

    def _over_one(self, element: PolyElement) -> Iterator[sp.Expr]:
        """Terms that are divided by different powers of one sum, over the highest of them."""
        for place, divisor in self._sums_below.items():
            powers = {monomial[place] for monomial in element}
            if len(powers) > 1:
                whole = self.ring.reduce(element * divisor ** max(powers))
                if len(whole) <= len(element) + _MORE_TERMS:
                    number = _leading_number(whole)
                    below = self._generators[place] ** max(powers)
                    yield sp.Mul(_rational(number), self._terms(whole, number), below)

    def _terms(self, terms: Terms, scale: Any = 1) -> sp.Expr:
        scaled = {monomial: NUMBERS.quo(value, scale) for monomial, value in terms.items()}
        return self._sum(*_folded(scaled, self._rules).items())

    def _collected(self, *items: tuple[Monomial, Any]) -> sp.Expr:
        """The terms as a sum of products with common factors taken out."""
        # Greedy Horner scheme: a b + a c + d becomes a (b + c) + d, and both sums are treated
        # likewise.
        terms, products = dict(items), []
        while len(terms) > 1 and (factor := self._best_factor(terms)):
            place, sign = factor
            inside = {m: c for m, c in terms.items() if m[place] * sign > 0}
            terms = {m: c for m, c in terms.items() if m[place] * sign <= 0}
            # all that the terms have in common: the lowest powers of one sign, and their numbers
            common = tuple(max(min(k), 0) + min(max(k), 0) for k in zip(*inside, strict=True))
            number = _content(inside.values())
            if all(value < 0 for value in inside.values()):  # fewer minus signs are left
                number = -number
            rest = [(tuple(map(sub, m, common)), NUMBERS.quo(c, number)) for m, c in inside.items()]
            products.append(self._product(number, common, self._sum(*rest)))
        products += [self._product(number, powers) for powers, number in terms.items()]
        return added(*products)

    def _best_factor(self, terms: Terms) -> tuple[int, int] | None:
        """The place and the sign of the power that save most when taken out of several terms.

        A term saves the factor where its lowest power takes all of it; what is taken out is written
        once. Ties go to the place that comes first.
        """
        best, most = None, 0
        # Taken out of k terms, a factor of w operations saves k − 1 copies and as many
        # multiplications: (k − 1)(w + 1) operations.
        for place, column in enumerate(zip(*terms, strict=True)):
            if column.count(0) > len(column) - 2:  # most places are empty
                continue
            for sign in (1, -1):
                powers = [power for power in column if power * sign > 0]
                lowest = powers.count(min(powers, key=abs, default=0))
                if lowest > 1 and (lowest - 1) * (self._weight(place) + 1) > most:
                    best, most = (place, sign), (lowest - 1) * (self._weight(place) + 1)
        return best

    def _product(self, number: Any, powers: Monomial, *sums: sp.Expr) -> sp.Expr:
        """number · generators^powers · sums; sines over cosines and the reverse are tan and cot."""
        rest, parts = list(powers), []
        for sine, cosine in self.codec.angle_pairs:
            # sinᵃ/cosᵇ = tanᵐ times the rest, with m = min(a, b).
            if rest[sine] * rest[cosine] < 0:
                times = min(abs(rest[sine]), abs(rest[cosine]))
                above, below = (sine, cosine) if rest[sine] > 0 else (cosine, sine)
                function = sp.tan if above == sine else sp.cot
                parts.append(function(self._named(sine).args[0]) ** times)
                rest[above] -= times
                rest[below] += times
        parts += [
            self._named(k) if n == 1 else self._named(k) ** n for k, n in enumerate(rest) if n
        ]
        parts += sums
        if number != 1:
            parts.insert(0, _rational(number))
        return sp.Mul(*parts) if len(parts) != 1 else parts[0]


presenter_for = lru_cache(maxsize=32)(Presenter)  # shared like the ring itself


def _operations(expression: sp.Expr) -> int:
    """As many as `sp.count_ops` counts, which adds names of functions up for it."""
    if expression.is_Function or isinstance(expression, sp.Derivative):
        return 1 + _operations(expression.args[0])
    return 0 if expression.is_Symbol else int(sp.count_ops(expression))


def _leading_number(element: PolyElement) -> Any:
    """The common factor of the numbers in a sum, with a leading minus.

    The term of the lowest degree leads, so that 1 − cos θ is left and not cos θ − 1.
    """
    lowest = element[min(element, key=lambda monomial: (sum(monomial), monomial))]
    size = _content(element.values())
    return -size if lowest < 0 else size


def _are_coprime(one: PolyElement, other: PolyElement) -> bool:
    """Whether images in each generator, at numbers for the others, have no factor in common.

    The image of a common factor divides both images. So coprime images spare the greatest common
    divisor of hundreds of terms, which takes seconds for the accelerations of a gimbal and is
    nearly always one. If the numbers are unlucky, a common factor stays, and the value is the same.
    """
    numbers, modular = Random(1), one.ring.clone(domain=sp.GF(_PRIME))
    sides = [side.clear_denoms()[1].set_ring(modular) for side in (one, other)]
    point = [(gen, numbers.randrange(1, _PRIME)) for gen in modular.gens]
    for place in range(len(point)):
        if all(side.degree(place) > 0 for side in sides):
            images = (side.evaluate(point[:place] + point[place + 1 :]) for side in sides)
            if next(images).gcd(next(images)).degree() > 0:
                return False
    return True


def _content(numbers: Iterable[Any]) -> Any:
    """The positive number that all are whole multiples of, without a common factor."""
    above, below = zip(*((n.numerator, n.denominator) for n in numbers), strict=True)
    return NUMBERS.quo(gcd(*above), lcm(*below))


def _rational(number: Any) -> sp.Rational:
    return sp.Rational(int(number.numerator), int(number.denominator))


def _folded(terms: Terms, rules: Sequence[Rule]) -> Terms:
    """The terms with each pair of an addition theorem made one.

    Places for all rules are added, unless no rule can apply.
    """
    powers = zip(*terms, strict=True) if len(terms) > 1 else ()
    present = {place for place, column in enumerate(powers) if max(column) > 0}
    usable = [k for k, rule in enumerate(rules) if present.issuperset(rule.first + rule.second)]
    if not usable:
        return terms
    result = {(*monomial, *[0] * len(rules)): value for monomial, value in terms.items()}
    for k in usable:
        rule, place = rules[k], k - len(rules)
        a, b = rule.first
        # cos α cos β ∓ sin α sin β are two terms that differ only in one pair of factors, with
        # coefficients of equal size. Both leave, and one term with the new factor enters.
        for monomial in list(result):
            if monomial in result and monomial[a] > 0 and monomial[b] > 0:  # it may begin a pair
                rest = list(monomial)
                rest[a] -= 1
                rest[b] -= 1
                other, target = list(rest), list(rest)
                for part in rule.second:
                    other[part] += 1
                target[place] += 1
                if result.get(tuple(other)) == rule.sign * result[monomial]:
                    del result[tuple(other)]
                    value = result.pop(monomial) + result.get(tuple(target), 0)
                    result[tuple(target)] = value
    return result


# Quadratic forms


_MOST_TERMS = 60  # of a form that is tried multiplied out; longer ones are no textbook's


def half_form(present: Presenter, matrix: RingMatrix, vector: RingMatrix) -> sp.Expr:
    """½ vᵀ M v for a constant symmetric M, (3, 3), and v, (3, 1); proved equal."""
    entries = vector.entries
    # ½ vᵀ M v = ½ Σ_k M_kk v_k² + Σ_{j<k} M_jk v_j v_k. Squares of equal moments are added first,
    # where sin² + cos² = 1 can shorten them: ½A (θ̇² + φ̇² sin² θ).
    by_weight: dict[PolyElement, list[PolyElement]] = {}
    for k in range(3):
        if matrix[k, k]:
            by_weight.setdefault(matrix[k, k], []).append(entries[k])
    terms = [half_of_squares(present, *group) for group in by_weight.items()]
    for j, k in combinations(range(3), 2):
        if matrix[j, k]:
            terms.append(sp.Mul(*map(present.element, [matrix[j, k], entries[j], entries[k]])))
    form = sp.Add(*terms)
    if not agrees(present, 2 * form, (vector.T @ matrix @ vector)[0, 0]):
        raise AlgebraError(f"the form {form} differs from its normal form")
    return form


def half_of_squares(
    present: Presenter, weight: PolyElement, elements: Sequence[PolyElement]
) -> sp.Expr:
    """½ times a weight times the sum of the squares of some elements, in the shortest form."""
    forms = [sp.Add(*(present.element(element) ** 2 for element in elements))]
    total = present.ring.dot((element, element) for element in elements)
    if len(total) <= _MOST_TERMS:
        forms.append(present.element(total))
    squares = min(map(sp.factor_terms, forms), key=sp.count_ops)
    return sp.Mul(sp.Rational(1, 2), present.element(weight), squares)


def shortest_of(forms: Iterable[Sequence[sp.Expr]]) -> sp.ImmutableMatrix:
    """Of several lists of entries the one with the fewest operations, as a column."""
    best = min(forms, key=lambda entries: sum(map(sp.count_ops, entries)))
    return sp.ImmutableMatrix(len(best), 1, list(best))


def agrees(present: Presenter, form: sp.Expr, value: PolyElement) -> bool:
    """Whether the ring knows a form to equal a value."""
    element = Quotient.whole(present.ring, present.ring.reduce(value))
    return present.codec.encode_quotient(form).equals(element)
