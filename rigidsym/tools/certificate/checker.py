"""Checks certificates without the program that wrote them: `python checker.py FOLDER...`

NAME.json is a record: a rotation, a body, a potential, and printed expressions. NAME.cert.json
lists those that are claimed to be right; nothing in it is believed. `Laws` builds the claims from
definitions, and derivatives from power series in time and dual numbers. Each claim is tested

1. in numbers, at random real points, with 60 digits and bounds of their errors. A false claim,
   and a divisor that is not shown to differ from zero, are refused;
2. exactly, in polynomials over the rationals: cos² = 1 - sin², a root squared is its argument, and
   equations are multiplied by their divisors. Conditions such as x² + y² = 1 are multiplied by
   polynomials in the certificate, the cofactors, and need the example of a real solution.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import (
    ROUND_UP,
    Context,
    Decimal,
    DivisionByZero,
    InvalidOperation,
    Overflow,
    Underflow,
    localcontext,
)
from fractions import Fraction
from functools import cache, cached_property, reduce
from itertools import pairwise
from operator import methodcaller, mul
from pathlib import Path
from random import SystemRandom
from typing import Any

POINTS, TRIES, DIGITS = 5, 60, 70
MOST_POWER, MOST_DIGITS, MOST_DEPTH, MOST_PARTS, MOST_WORK = 40, 40, 60, 12, 300_000
UPWARDS = Context(DIGITS, ROUND_UP, traps=[Overflow, Underflow, InvalidOperation, DivisionByZero])
ROUNDING = Decimal(10) ** (2 - DIGITS)  # more than one rounding error, relative
NEAR, NEGLIGIBLE = Decimal(10) ** -50, Decimal(10) ** -20
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640629")
FUNCTIONS = ("cos", "sin", "tan", "cot", "sqrt")
TOKEN = re.compile(r" *([0-9]+|[A-Za-z][A-Za-z0-9_]*|\*\*|[-+*/()])")
UNITS = {"rotation_matrix": "", "rotation_rate": "1/s", "spin_matrix": "rad/s"}
UNITS |= {"angular_velocity": "rad/s", "angular_acceleration": "rad/s^2"}
Tree = tuple[Any, ...]


class Refused(ValueError):
    """A claim that is false, or that is not shown to be true."""


class Unreadable(ValueError):
    """An expression or a quantity that this program does not know; it is not certified."""


class NotReal(ValueError):
    """A root is not real at a point; another one is drawn."""


BROKEN = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, RecursionError)


@cache
def tree_of(text: str) -> Tree:
    """Sums, products, whole powers and FUNCTIONS of names as nested tuples; no other characters."""
    tokens = TOKEN.findall(text)
    if TOKEN.sub("", text).strip(" ") or any(len(token) > MOST_DIGITS for token in tokens):
        raise Unreadable(f"characters or numbers in {text[:60]!r}")
    tokens.append("the end")

    def expect(token: str) -> None:
        if tokens.pop(0) != token:
            raise Unreadable(f"{token!r} was expected in {text[:60]!r}")

    def operand(depth: int) -> Tree:
        token = tokens.pop(0)
        if depth > MOST_DEPTH or token in ("the end", "+", "*", "/", "**", ")"):
            raise Unreadable(f"{token!r} was not expected in {text[:60]!r}")
        if token == "-":
            return ("-", ("number", 0), operand(depth + 1))
        if token == "(" or token in FUNCTIONS:
            if token != "(":
                expect("(")
            inside = chain("+-", depth + 1)
            expect(")")
            return power(inside if token == "(" else (token, inside))
        return power(("number", int(token)) if token.isdigit() else ("name", token))

    def power(base: Tree) -> Tree:
        if tokens[0] != "**":
            return base
        exponent = re.match(r"\*\* (([0-9]+)|\( - ([0-9]+) \)) ", " ".join(tokens))
        if exponent is None or len(exponent[0]) > 12:
            raise Unreadable(f"an exponent in {text[:60]!r}")
        del tokens[: len(exponent[0].split())]
        return ("**", base, int(exponent[2] or "-" + exponent[3]))

    def chain(signs: str, depth: int) -> Tree:
        value = chain("*/", depth) if signs == "+-" else operand(depth)
        while tokens[0] in tuple(signs):
            sign = tokens.pop(0)
            value = (sign, value, chain("*/", depth) if signs == "+-" else operand(depth))
        return value

    tree = chain("+-", 0)
    expect("the end")
    return tree


def names_in(tree: Tree) -> set[str]:
    if tree[0] == "name":
        return {tree[1]}
    return set().union(*(names_in(part) for part in tree[1:] if isinstance(part, tuple)))


class Interval:
    """All numbers within `radius` of `middle`; rounded up, a radius is never too small."""

    def __init__(self, middle: Decimal | int, radius: Decimal | int = 0) -> None:
        self.middle, self.radius = Decimal(middle), Decimal(radius)

    def number(self, value: Fraction | int) -> Interval:
        middle = Decimal(value.numerator) / value.denominator
        return Interval(middle, abs(middle) * ROUNDING)

    def __add__(self, other: Interval) -> Interval:
        middle = self.middle + other.middle
        return Interval(middle, self.radius + other.radius + abs(middle) * ROUNDING)

    def __mul__(self, other: Interval) -> Interval:
        middle = self.middle * other.middle
        spread = abs(self.middle) * other.radius + self.radius * (abs(other.middle) + other.radius)
        return Interval(middle, spread + abs(middle) * ROUNDING)

    def inverse(self) -> Interval:
        size = abs(self.middle)
        if size <= self.radius:
            raise Refused("a divisor is not shown to differ from zero at a real point")
        radius = 2 * self.radius / (size * (size - self.radius))
        return Interval(1 / self.middle, radius + ROUNDING / size)

    def sqrt(self) -> Interval:
        """The real root that is not negative."""
        if self.middle <= self.radius:
            raise NotReal("a root is not real")
        root = self.middle.sqrt()
        radius = 2 * self.radius / (self.middle - self.radius).sqrt()
        return Interval(root, radius + root * ROUNDING)

    def turn(self) -> tuple[Interval, Interval]:
        """Cosine and sine by their Taylor series; 50 guard digits, since a term is below e^100."""
        if abs(self.middle) > 100:
            raise NotReal("an angle is too large")
        exact, sums, term, k = Context(prec=DIGITS + 50), [Decimal(0)] * 2, Decimal(1), 0
        while k < 2 * abs(self.middle) or abs(term) > ROUNDING / 1000:
            sums[k % 2] = (exact.subtract if k % 4 > 1 else exact.add)(sums[k % 2], term)
            k += 1
            term = exact.divide(exact.multiply(term, self.middle), Decimal(k))
        cosine, sine = (Interval(+value, self.radius + ROUNDING) for value in sums)
        return cosine, sine


class Ring:
    """What the names of polynomials are that stand for roots, cosines and inverses."""

    def __init__(self, parts: dict[str, int]) -> None:
        self.squares, self.divisors = dict[str, Poly](), dict[str, Poly]()
        self.work = 0  # products of terms for one claim
        self.parts = parts  # of an angle φ, cos(φ/n) and sin(φ/n) are names


class Finer(Exception):
    """An angle is divided by more than was known; all is read again."""


class Poly:
    """Coefficients of monomials: tuples of names in order, each as often as it is a factor."""

    def __init__(self, ring: Ring, terms: Mapping[tuple[str, ...], Fraction | int]) -> None:
        self.ring = ring
        self.terms = {names: factor for names, factor in terms.items() if factor}
        self.names = {name for names in self.terms for name in names}

    def number(self, value: Fraction | int) -> Poly:
        return Poly(self.ring, {(): value.numerator if value.denominator == 1 else value})

    def new(self, name: str) -> Poly:
        return Poly(self.ring, {(name,): 1})

    def __str__(self) -> str:
        terms = sorted(self.terms.items())
        return " + ".join("*".join((f"({factor})", *names)) for names, factor in terms) or "0"

    def __add__(self, other: Poly) -> Poly:
        terms = dict(self.terms)
        for names, factor in other.terms.items():
            terms[names] = terms.get(names, 0) + factor
        return Poly(self.ring, terms)

    def __mul__(self, other: Poly) -> Poly:
        """The product, in which no cosine or root has a square."""
        terms: dict[tuple[str, ...], Fraction | int] = {}
        self.ring.work += len(self.terms) * len(other.terms)
        if self.ring.work > MOST_WORK:
            raise Unreadable("the polynomials of a claim are too long")
        for one, factor in self.terms.items():
            for two, times in other.terms.items():
                names = tuple(sorted(one + two))
                terms[names] = terms.get(names, 0) + factor * times
        rest: dict[tuple[str, ...], Fraction | int] = {}
        for names in [*terms]:
            for place, (name, next_name) in enumerate(pairwise(names)):
                if name == next_name and name in self.ring.squares:
                    lower = Poly(self.ring, {names[:place] + names[place + 2 :]: terms.pop(names)})
                    for each, factor in (lower * self.ring.squares[name]).terms.items():
                        rest[each] = rest.get(each, 0) + factor
                    break
        return Poly(self.ring, terms) + Poly(self.ring, rest)

    def inverse(self) -> Poly:
        """A name x for 1/f, with x f = 1; of a product, the product of the inverses."""
        if not self.terms:
            raise Refused("a divisor is zero")
        if len(self.terms) > 1:
            self.ring.divisors[f"1/({self})"] = self
            return self.new(f"1/({self})")
        ((names, factor),) = self.terms.items()
        product = self.number(1 / Fraction(factor))
        for name in names:
            if name in self.ring.divisors:
                product = product * self.ring.divisors[name]
            elif name.startswith("sqrt("):  # 1/√f = √f/f
                product = product * self.new(name) * self.ring.squares[name].inverse()
            else:
                self.ring.divisors[f"1/({name})"] = self.new(name)
                product = product * self.new(f"1/({name})")
        return product

    def sqrt(self) -> Poly:
        """The root that is not negative; of a number, products of the roots of primes."""
        if self.names:
            self.ring.squares[f"sqrt({self})"] = self
            return self.new(f"sqrt({self})")
        number = Fraction(self.terms.get((), 0))
        whole, root = number.numerator * number.denominator, Fraction(1, number.denominator)
        if not 0 < whole < 10**6:
            raise Unreadable(f"the root of {number}")
        product, prime = self.number(1), 2
        while whole > 1:
            if whole % prime**2 == 0:
                whole, root = whole // prime**2, root * prime
            elif whole % prime == 0:
                whole //= prime
                self.ring.squares[f"sqrt({prime})"] = self.number(prime)
                product = product * self.new(f"sqrt({prime})")
            else:
                prime += 1
        return product * self.number(root)

    def turn(self) -> tuple[Poly, Poly]:
        """The cosine and the sine of a sum, by the addition theorems."""
        cosine, sine, minus = self.number(1), self.number(0), self.number(-1)
        for names, factor in sorted(self.terms.items()):
            unit = "*".join(names) or "1"
            part = self.ring.parts.setdefault(unit, 1)
            count = Fraction(factor) * part
            if abs(count) > MOST_PARTS or part * count.denominator > MOST_PARTS:
                raise Unreadable(f"the cosine of {self}")
            if count.denominator > 1:
                self.ring.parts[unit] = part * count.denominator
                raise Finer
            one, other = self.new(f"cos({unit}/{part})"), self.new(f"sin({unit}/{part})")
            self.ring.squares[f"cos({unit}/{part})"] = self.number(1) + other * other * minus
            for _ in range(abs(int(count))):
                turned = other if count > 0 else other * minus
                cosine, sine = cosine * one + sine * turned * minus, cosine * turned + sine * one
        return cosine, sine

    def numerator(self) -> Poly:
        """The value times its divisors, until it has none; they are not zero."""
        value = self
        while inverses := [name for name in self.ring.divisors if name in value.names]:
            name, parts = inverses[-1], dict[int, Poly]()  # earlier ones may be inside the latest
            for names, factor in value.terms.items():
                term = Poly(self.ring, {tuple(each for each in names if each != name): factor})
                power = names.count(name)
                parts[power] = parts[power] + term if power in parts else term
            value, divisor = self.number(0), self.ring.divisors[name]
            for power, part in parts.items():
                value = value + reduce(mul, [divisor] * (max(parts) - power), part)
        return value


class Jet:
    """A power series in time up to an order, with the slopes of a dual number by some names.

    `parts` has the coefficients c[k, ""] of tᵏ and c[k, name] of tᵏ d; products of two d are zero.
    """

    def __init__(self, order: int, parts: Mapping[tuple[int, str], Any]) -> None:
        self.order, self.parts = order, {at: c for at, c in parts.items() if at[0] <= order}

    def __add__(self, other: Jet) -> Jet:
        parts = dict(self.parts)
        for at, part in other.parts.items():
            parts[at] = parts[at] + part if at in parts else part
        return Jet(min(self.order, other.order), parts)

    def __mul__(self, other: Jet) -> Jet:
        parts: dict[tuple[int, str], Any] = {}
        order = min(self.order, other.order)
        for (j, one), factor in self.parts.items():
            for (k, two), times in other.parts.items():
                if j + k <= order and not (one and two):
                    at = j + k, one or two
                    parts[at] = parts[at] + factor * times if at in parts else factor * times
        return Jet(order, parts)

    def number(self, value: Fraction | int) -> Jet:
        return Jet(self.order, {(0, ""): self.parts[0, ""].number(value)})

    def rate(self) -> Jet:
        parts = {(k - 1, name): c * c.number(k) for (k, name), c in self.parts.items() if k}
        if self.order < 1:
            raise Unreadable("a derivative that is not known")
        return Jet(self.order - 1, {(0, ""): self.parts[0, ""].number(0)} | parts)

    def slope(self, name: str) -> Jet:
        parts = {(k, ""): c for (k, by), c in self.parts.items() if by == name}
        return Jet(self.order, {(0, ""): self.parts[0, ""].number(0)} | parts)

    def series(self, derivatives: Sequence[Any]) -> Jet:
        """Σ f⁽ᵏ⁾(c) hᵏ/k! with h = x - c, whose fourth power is zero up to t²."""
        rest = Jet(self.order, {at: c for at, c in self.parts.items() if at != (0, "")})
        value, power = Jet(self.order, {(0, ""): derivatives[0]}), self.number(1)
        for k, derivative in enumerate(derivatives[1:], start=1):
            power = power * rest
            scale = derivative * derivative.number(Fraction(1, math.factorial(k)))
            value = value + power * Jet(self.order, {(0, ""): scale})
        return value

    def inverse(self) -> Jet:
        first = self.parts[0, ""].inverse()
        powers = [reduce(mul, [first] * (k + 1)) for k in range(4)]
        signed = zip(powers, (1, -1, 2, -6), strict=True)
        return self.series([power * power.number(k) for power, k in signed])

    def sqrt(self) -> Jet:
        root = self.parts[0, ""].sqrt()
        value, inverse = self.parts[0, ""], self.parts[0, ""].inverse()
        factors = zip(range(4), (1, Fraction(1, 2), Fraction(-1, 4), Fraction(3, 8)), strict=True)
        return self.series([reduce(mul, [inverse] * k, root * value.number(f)) for k, f in factors])

    def turn(self) -> tuple[Jet, Jet]:
        cosine, sine = self.parts[0, ""].turn()
        less = cosine * cosine.number(-1), sine * sine.number(-1)
        return self.series([cosine, less[1], less[0], sine]), self.series(
            [sine, cosine, less[1], less[0]]
        )


class Array:
    """Rows of jets; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Iterable[Jet]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Array:
        return Array(zip(*self.rows, strict=True))

    def each(self, change: Callable[[Jet], Jet]) -> Array:
        return Array(map(change, row) for row in self.rows)

    def __add__(self, other: Array) -> Array:
        rows = zip(self.rows, other.rows, strict=True)
        return Array([one + two for one, two in zip(*pair, strict=True)] for pair in rows)

    def __mul__(self, other: Array | Fraction | int) -> Array:
        if not isinstance(other, Array):
            return self.each(lambda entry: entry * entry.number(other))
        pairs = ([zip(row, column, strict=True) for column in other.T.rows] for row in self.rows)
        return Array(
            [reduce(Jet.__add__, [a * b for a, b in pair]) for pair in row] for row in pairs
        )

    def rate(self) -> Array:
        return self.each(Jet.rate)

    def slopes(self, names: Iterable[str]) -> Array:
        return Array([entry.slope(name) for name in names] for entry in self.entries)

    def hat(self) -> Array:
        """C(v) of a vector v, the operator v ×."""
        (x, y, z), zero = self.entries, self.entries[0].number(0)
        negative = (self * -1).entries
        return Array([[zero, negative[2], y], [z, zero, negative[0]], [negative[1], x, zero]])

    def vee(self) -> Array:
        """v of a skew matrix C(v)."""
        return Array([[self.rows[2][1]], [self.rows[0][2]], [self.rows[1][0]]])

    def determinant(self) -> Jet:
        first, *rest = self.rows
        if not rest:
            return first[0]
        minors = [Array([row[:k] + row[k + 1 :] for row in rest]) for k in range(len(first))]
        terms = zip(first, minors, strict=True)
        return reduce(
            Jet.__add__,
            [a * a.number((-1) ** k) * m.determinant() for k, (a, m) in enumerate(terms)],
        )


class Names:
    """The names of a record: no two are alike, and rates are named after their coordinates."""

    def __init__(self, record: Mapping[str, Any]) -> None:
        groups = {g["name"]: [c["name"] for c in g["components"]] for g in record["arguments"]}
        self.q, self.constant = groups["q"], [*groups.get("parameters", ()), "pi"]
        self.rates, self.second = ([name + end for name in self.q] for end in ("_dot", "_ddot"))
        self.momenta = [f"p_{name}" for name in self.q]
        self.definitions = {d["name"]: d["expression"] for d in record["definitions"]}
        of_motion = {"q_dot": self.rates, "q_ddot": self.second, "momenta": self.momenta}
        if any(groups.get(name, named) != named for name, named in of_motion.items()):
            raise Refused("rates and momenta are not named after the coordinates, in their order")
        own = [*self.q, *self.rates, *self.second, *self.constant, *self.definitions]
        named = sorted({name for names in groups.values() for name in names} - {*own})
        self.all = [name for name in [*own, *named] if name not in self.definitions]
        reserved = {*FUNCTIONS, *self.momenta, *LETTERS.split()}
        reserved |= {f"omega_{frame}_{k}" for frame in ("space", "body") for k in (1, 2, 3)}
        for name in [*own, *named]:
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name, re.ASCII):
                raise Refused(f"the name {name!r} is not plain ASCII")
            if own.count(name) > 1 or name in reserved.intersection(own) or name in FUNCTIONS:
                raise Refused(f"the name {name!r} has two meanings")


class Language:
    """What the texts of a record mean in some arithmetic, of which `one` is the number 1."""

    def __init__(
        self, names: Names, values: Mapping[str, Any], one: Any, order: int = 2, slopes: Any = ()
    ) -> None:
        self.names, self.one, self.slopes = names, Jet(order, {(0, ""): one}), slopes
        self.meaning, self.calls = dict[str, Jet](), dict[Tree, Jet]()
        for name in names.all:
            self.meaning[name] = Jet(order * (name in names.constant), {(0, ""): values[name]})
            if name in slopes:
                self.meaning[name].parts[0, name] = one
        for q, rate, second in zip(names.q, names.rates, names.second, strict=True):
            half = values[second] * one.number(Fraction(1, 2))
            parts = {(0, ""): values[q], (1, ""): values[rate], (2, ""): half}
            self.meaning[q] = Jet(order, parts | ({(0, q): one} if q in slopes else {}))
            parts = {(0, ""): values[rate], (1, ""): values[second]}
            self.meaning[rate] = Jet(
                min(order, 1), parts | ({(0, rate): one} if rate in slopes else {})
            )

    def read(self, given: Any) -> Array:
        rows = given if isinstance(given, list) else [given]
        texts = [row if isinstance(row, list) else [row] for row in rows]
        return Array([self.value(tree_of(text)) for text in row] for row in texts)

    def value(self, tree: Tree, power: int = 1) -> Jet:
        """The power of what a tree says; a product is raised factor by factor."""
        kind, *parts = tree
        if abs(power) > MOST_POWER:
            raise Unreadable("an exponent is too large")
        if kind in ("*", "/"):
            return self.value(parts[0], power) * self.value(
                parts[1], power if kind == "*" else -power
            )
        if kind == "**":
            return self.value(parts[0], parts[1] * power)
        if kind == "number":
            base = self.one.number(parts[0])
        elif kind in ("+", "-"):
            sign = self.one.number(1 if kind == "+" else -1)
            base = self.value(parts[0]) + self.value(parts[1]) * sign
        else:
            base = self.name(parts[0]) if kind == "name" else self.call(kind, parts[0])
        base = base.inverse() if power < 0 else base
        return reduce(mul, [base] * abs(power)) if power else self.one.number(1)

    def name(self, name: str) -> Jet:
        if name in self.names.definitions and name not in self.meaning:
            self.meaning[name] = self.value(tree_of(self.names.definitions[name]))
        if name not in self.meaning:
            raise Unreadable(f"{name} has no meaning here")
        return self.meaning[name]

    def call(self, function: str, argument: Tree) -> Jet:
        if (function, argument) not in self.calls:
            value = self.value(argument)
            cosine, sine = (value, value) if function == "sqrt" else value.turn()
            self.calls[function, argument] = {
                "sqrt": lambda: value.sqrt(),
                "cos": lambda: cosine,
                "sin": lambda: sine,
                "tan": lambda: sine * cosine.inverse(),
                "cot": lambda: cosine * sine.inverse(),
            }[function]()
        return self.calls[function, argument]


TURNS = {  # a vector v and numbers c and s: R = 1 + s C(v) + (1 - c) C(v)²
    "x": "1; 0; 0; cos({0}); sin({0})",
    "y": "0; 1; 0; cos({0}); sin({0})",
    "z": "0; 0; 1; cos({0}); sin({0})",
    "axis_angle": "{0}; {1}; {2}; cos({3}); sin({3})",
    "constant_turn": "{0}; {1}; {2}; {3}; {4}",
    "unit_quaternion": "{1}; {2}; {3}; -1; 2*{0}",
    "quaternion": "{1}; {2}; {3}; 1 - 2/N; 2*{0}/N",
    "modified_rodrigues": "2*{1}; 2*{2}; 2*{3}; 1 - 2/N**2; 2*(2 - N)/N**2",  # {0} is 1
}
SQUARES = "({0}**2 + {1}**2 + {2}**2 + {3}**2)"  # N
LETTERS = "X Y Z X_dot Y_dot Z_dot n_x n_y n_z p_x p_y p_z torque_1 torque_2 torque_3"
ROTATION, PRINCIPAL, HALF = (
    "R is a rotation",
    ("principal_axes", "principal_moments"),
    Fraction(1, 2),
)
OF_POSITION = ("rate_matrix", "inverse_rate_matrix", "rates_from_angular_velocity")


def factors_of(rotation: Mapping[str, Any], language: Language) -> Iterable[Array]:
    """The turns whose product R is, or R itself."""
    if "matrix" in rotation:
        yield language.read(rotation["matrix"])
    for turn in rotation.get("turns", ()):
        kind, _, inside = turn.partition("(")
        if kind not in TURNS or not inside.endswith(")"):
            raise Unreadable(f"the turn {turn!r}")
        places = [f"({place})" for place in inside[:-1].split(",")]
        form = TURNS[kind].replace("N", SQUARES).format(*places)
        *axis, cosine, sine = language.read(form.split(";")).entries
        operator, versine = (
            Array([[part] for part in axis]).hat(),
            cosine.number(1) + cosine * cosine.number(-1),
        )
        square = operator * operator
        one = Array([cosine.number(int(j == k)) for k in range(3)] for j in range(3))
        yield one + operator.each(sine.__mul__) + square.each(versine.__mul__)


def pairs(one: Array, two: Array) -> list[tuple[Jet, Jet]]:
    return [
        pair for rows in zip(one.rows, two.rows, strict=True) for pair in zip(*rows, strict=True)
    ]


def texts_in(given: Any) -> list[str]:
    return (
        [text for each in given for text in texts_in(each)] if isinstance(given, list) else [given]
    )


def names_of(given: Any, names: Names) -> set[str]:
    """The names in texts and in their definitions."""
    inside, texts = set[str](), texts_in(given)
    while texts:
        new = names_in(tree_of(texts.pop())) - inside
        inside |= new
        texts += [names.definitions[name] for name in new & {*names.definitions}]
    return inside - {*names.definitions}


def printed_in(record: Mapping[str, Any]) -> dict[str, Any]:
    """The printed expressions by their names."""
    printed = [(q["name"], q["expression"]) for q in record["quantities"]]
    printed += [("constant " + f["name"], f["expression"]) for f in record["first_integrals"]]
    if len({ROTATION, *dict(printed)}) <= len(printed):
        raise Refused("two quantities have one name")
    return dict(printed)


class Laws:
    """What each quantity x of a record satisfies, entry by entry: x = B, or A x = B.

    A method `law_of_x` gives (A, B), or (None, B). They are built from earlier quantities as these
    are printed, if they are wanted too, and so proved too.
    """

    def __init__(self, record: Mapping[str, Any], wanted: Sequence[str], *arithmetic: Any) -> None:
        self.record, self.wanted, self.names = record, wanted, arithmetic[0]
        self.arithmetic = arithmetic
        self.still, self.moving = self.language(0), self.language(1)
        self.sloped = self.language(1, *self.names.q, *self.names.rates)
        self.printed, self.one = printed_in(record), self.still.one.number(1)
        self.unit = Array([self.one.number(int(j == k)) for k in range(3)] for j in range(3))
        conditions = record["rotation"]["conditions"]
        inside = names_of(conditions, self.names) & {*self.names.q}
        slopes = self.language(0, *self.names.q).read([*conditions]).slopes(self.names.q)
        self.tangent = slopes if inside else None  # of the conditions on coordinates

    @cache  # noqa: B019  (as long as its laws)
    def language(self, order: int, *slopes: str) -> Language:
        names, values, one = self.arithmetic
        return Language(names, values, one, order, slopes)

    def claim(self, name: str) -> list[tuple[Jet, Jet]]:
        """Pairs that must be equal."""
        kind, _, end = name.rpartition("_")
        text = self.holding(self.printed[name], self.may_hold(kind, end, name))
        if name in PRINCIPAL:
            return self.principal()
        if law := getattr(self, f"law_of_{name.replace(' ', '_')}", None):
            matrix, right = law()
        elif end in ("space", "body") and (law := getattr(self, f"law_of_{kind}", None)):
            matrix, right = law(end)
        elif name in (constants := [f"constant momentum_{q}" for q in self.names.q]):
            matrix, right = None, Array([[self.lacking.entries[constants.index(name)]]])
        else:
            raise Unreadable(f"{name} has no law here")
        if name.startswith("constant "):
            return pairs(self.moving.read(text).rate(), right)
        x, claims = (self.sloped if name == "hamiltonian" else self.still).read(text), []
        if kind == "rate_matrix":
            x = x * self.still.read(self.names.rates)
        elif self.tangent and kind in OF_POSITION:
            claims = [(entry, entry.number(0)) for entry in (self.tangent * x).entries]
        return claims + pairs(matrix * x if matrix else x, right)

    def may_hold(self, kind: str, frame: str, name: str) -> set[str]:
        """The names that may be in a quantity, where more would hide in A x."""
        of_position = {*self.names.q, *self.names.constant}
        if kind in OF_POSITION:
            is_given = kind == "rates_from_angular_velocity"
            return of_position | {f"omega_{frame}_{k}" for k in (1, 2, 3) if is_given}
        if name == "hamiltonian":
            return of_position | {*self.names.momenta}
        return {*self.names.constant} if name in PRINCIPAL else {*self.names.all}

    def holding(self, given: Any, names: Iterable[str]) -> Any:
        """A text or texts, in which no other names may be."""
        if extra := sorted(names_of(given, self.names) - {*names}):
            raise Unreadable(f"{extra[0]} must not be in {given!r}"[:200])
        return given

    def earlier(self, name: str, language: Language) -> Array:
        """A quantity as it is printed, if it is wanted, or by its law."""
        if name in self.wanted:
            return language.read(self.printed[name])
        return self.velocity(name.rpartition("_")[2], language)

    # Kinematics

    def rotations(self) -> list[tuple[Jet, Jet]]:
        """F Fᵀ = 1 and det F = 1 of each turn F, and so of their product."""
        claims = []
        for factor in factors_of(self.record["rotation"], self.still):
            claims += [*pairs(factor * factor.T, self.unit), (factor.determinant(), self.one)]
        return claims

    def shown(self, matrix: Array) -> Array:
        return matrix.T if self.record["presentation"] == "passive" else matrix

    def rotation(self, language: Language) -> Array:
        """R, active."""
        if "rotation_matrix" in self.wanted:
            return self.shown(language.read(self.printed["rotation_matrix"]))
        return reduce(mul, factors_of(self.record["rotation"], language))

    def rotation_rate(self, language: Language) -> Array:
        if "rotation_rate" in self.wanted:
            return self.shown(language.read(self.printed["rotation_rate"]))
        return self.rotation(self.language(language.one.order + 1, *language.slopes)).rate()

    def velocity(self, frame: str, language: Language) -> Array:
        """Ω of C(Ω) = dR/dt Rᵀ, or Ω' of C(Ω') = Rᵀ dR/dt."""
        R, rate = self.rotation(language), self.rotation_rate(language)
        return (rate * R.T if frame == "space" else R.T * rate).vee()

    def rate_matrix(self, frame: str, language: Language) -> Array:
        """W with Ω = W q̇: as it is printed, or from the derivatives of R by the coordinates."""
        if f"rate_matrix_{frame}" in self.wanted:
            return language.read(self.printed[f"rate_matrix_{frame}"])
        R = self.rotation(self.language(language.one.order, *self.names.q))
        slopes = [R.each(methodcaller("slope", name)) for name in self.names.q]
        spins = [each * R.T if frame == "space" else R.T * each for each in slopes]
        return Array([spin.vee().entries for spin in spins]).T

    def law_of_rotation_matrix(self) -> Any:
        return None, self.shown(reduce(mul, factors_of(self.record["rotation"], self.still)))

    def law_of_rotation_rate(self) -> Any:
        return None, self.shown(self.rotation(self.moving)).rate()

    def law_of_spin_matrix(self) -> Any:
        R, rate = self.rotation(self.still), self.rotation_rate(self.still)
        return None, self.shown(rate) * self.shown(R).T

    def law_of_angular_velocity(self, frame: str) -> Any:
        return None, self.velocity(frame, self.still)

    def law_of_angular_acceleration(self, frame: str) -> Any:
        return None, self.earlier(f"angular_velocity_{frame}", self.moving).rate()

    def law_of_rate_matrix(self, frame: str) -> Any:
        return None, self.earlier(f"angular_velocity_{frame}", self.still)

    def law_of_inverse_rate_matrix(self, frame: str) -> Any:
        return self.rate_matrix(frame, self.still), self.unit

    def law_of_rates_from_angular_velocity(self, frame: str) -> Any:
        omega = self.still.read([f"omega_{frame}_{k}" for k in (1, 2, 3)])
        return self.rate_matrix(frame, self.still), omega

    # A body

    def body(self, part: str, language: Language | None = None) -> Array:
        text = self.holding(self.record.get("body", {})[part], self.names.constant)
        return (language or self.still).read(text)

    def vector(self, letters: str) -> Array:
        return self.still.read(letters.split())

    def momentum(self) -> Array:
        return self.body("inertia") * self.earlier("angular_velocity_body", self.still)

    def law_of_mass(self) -> Any:
        return None, self.body("mass")

    def law_of_centre_of_mass(self) -> Any:
        return None, self.body("centre")

    def law_of_inertia_tensor(self) -> Any:
        return None, self.body("inertia")

    def law_of_inertia_tensor_space(self) -> Any:
        R = self.rotation(self.still)
        return None, R * self.body("inertia") * R.T

    def law_of_inertia_tensor_point(self) -> Any:
        """I' + M (|d|² - d dᵀ), by the parallel-axis theorem."""
        arm = (self.vector("p_x p_y p_z") + self.body("centre") * -1).hat()
        return None, self.body("inertia") + (arm.T * arm).each(self.body("mass").entries[0].__mul__)

    def law_of_moment_of_inertia(self) -> Any:
        axis = self.vector("n_x n_y n_z")
        return None, axis.T * self.law_of_inertia_tensor_point()[1] * axis

    def law_of_translational_energy(self) -> Any:
        velocity = self.vector("X_dot Y_dot Z_dot")
        return None, velocity.T * velocity * self.body("mass") * HALF

    def law_of_rotational_energy(self) -> Any:
        omega = self.earlier("angular_velocity_body", self.still)
        return None, omega.T * self.momentum() * HALF

    def law_of_kinetic_energy(self) -> Any:
        return None, self.law_of_translational_energy()[1] + self.law_of_rotational_energy()[1]

    def law_of_angular_momentum_rotation_body(self) -> Any:
        return None, self.momentum()

    def law_of_angular_momentum_rotation(self) -> Any:
        return None, self.rotation(self.still) * self.momentum()

    def law_of_angular_momentum_centre(self) -> Any:
        position, velocity = self.vector("X Y Z"), self.vector("X_dot Y_dot Z_dot")
        return None, position.hat() * velocity * self.body("mass")

    def law_of_angular_momentum(self) -> Any:
        turning = self.rotation(self.still) * self.momentum()
        return None, self.law_of_angular_momentum_centre()[1] + turning

    def law_of_angular_acceleration_from_torque(self) -> Any:
        """I' x + Ω' × I' Ω' = N'."""
        omega, tensor = self.vector("omega_body_1 omega_body_2 omega_body_3"), self.body("inertia")
        torque = self.vector("torque_1 torque_2 torque_3")
        return invertible(tensor), torque + omega.hat() * tensor * omega * -1

    def principal(self) -> list[tuple[Jet, Jet]]:
        """E Eᵀ = 1, det E = 1 and I' e = m e for the columns e of E."""
        if not {*PRINCIPAL} <= {*self.wanted}:
            raise Unreadable("principal axes and moments need each other")
        axes, moments = (self.still.read(self.printed[name]) for name in PRINCIPAL)
        scaled = Array([list(map(mul, row, moments.entries)) for row in axes.rows])
        unit = [*pairs(axes * axes.T, self.unit), (axes.determinant(), self.one)]
        return [*unit, *pairs(self.body("inertia") * axes, scaled)]

    # Lagrange's equations: the rate of ∂L/∂q̇, less ∂L/∂q, is Q

    @cached_property
    def energies(self) -> tuple[Array, Array, Array, Array]:
        """T, V, Q and W', with Ω' = W' q̇."""
        if "motion" not in self.record or self.tangent:
            raise Unreadable("there is no motion in independent coordinates")
        given, names = self.record["motion"], self.names
        potential = self.sloped.read(self.holding(given["potential"], [*names.q, *names.constant]))
        changing = [*names.q, *names.rates, *names.constant]
        forces, torque = (self.holding(given[part], changing) for part in ("forces", "torque"))
        omega = self.earlier("angular_velocity_body", self.sloped)
        if "angular_velocity_body" in self.wanted:
            W = omega.slopes(names.rates)
        else:
            W = self.rate_matrix("body", self.sloped)
        kinetic = omega.T * self.body("inertia", self.sloped) * omega * HALF
        return kinetic, potential, self.sloped.read(forces) + W.T * self.sloped.read(torque), W

    @cached_property
    def momenta(self) -> Array:
        omega = self.earlier("angular_velocity_body", self.sloped)
        return self.energies[3].T * (self.body("inertia", self.sloped) * omega)

    @cached_property
    def inertial(self) -> Array:
        """M q̈ + h."""
        kinetic, potential, _, _ = self.energies
        slopes = (kinetic + potential * -1).slopes(self.names.q)
        return self.momenta.rate() + slopes.T * -1

    def law_of_potential_energy(self) -> Any:
        return None, self.energies[1]

    def law_of_lagrangian(self) -> Any:
        return None, self.energies[0] + self.energies[1] * -1

    def law_of_energy(self) -> Any:
        return None, self.energies[0] + self.energies[1]

    def law_of_hamiltonian(self) -> Any:
        """H(q, p) = T + V, in which the names of momenta mean p = ∂T/∂q̇."""
        self.sloped.meaning |= dict(zip(self.names.momenta, self.momenta.entries, strict=True))
        return self.law_of_energy()

    def law_of_generalised_momenta(self) -> Any:
        return None, self.momenta

    def law_of_mass_matrix(self) -> Any:
        W = self.energies[3]
        return None, W.T * self.body("inertia", self.sloped) * W

    def law_of_bias_vector(self) -> Any:
        seconds = self.sloped.read(self.names.second)
        return None, self.inertial + self.law_of_mass_matrix()[1] * seconds * -1

    def law_of_accelerations(self) -> Any:
        forces = self.energies[2] + self.law_of_bias_vector()[1] * -1
        return invertible(self.law_of_mass_matrix()[1]), forces

    def law_of_coriolis_matrix(self) -> Any:
        """Christoffel symbols: (dM/dt + S - Sᵀ)/2 with S = ∂(M q̇)/∂q."""
        if "mass_matrix" not in self.wanted:
            raise Unreadable("the Coriolis matrix needs the mass matrix")
        mass = self.sloped.read(self.printed["mass_matrix"])
        slopes = (mass * self.sloped.read(self.names.rates)).slopes(self.names.q)
        return None, (mass.rate() + slopes + slopes.T * -1) * HALF

    @property
    def lacking(self) -> Array:
        """Zero along every motion: the rate of p, less ∂L/∂q and Q."""
        return self.inertial + self.energies[2] * -1

    def law_of_constant_energy(self) -> Any:
        return None, self.sloped.read([self.names.rates]) * self.lacking


def invertible(matrix: Array) -> Array:
    """Refuse a matrix whose determinant is not shown to differ from zero at a point."""
    if isinstance(matrix.entries[0].parts[0, ""], Interval):
        matrix.determinant().inverse()
    return matrix


def digest(record: Mapping[str, Any]) -> str:
    """Of a record without the list of files, which names its certificate."""
    content = {key: value for key, value in record.items() if key != "files"}
    content = json.loads(json.dumps(content), parse_float=str)
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def solve(names: Names, conditions: Sequence[str], values: dict[str, Interval]) -> None:
    """Move coordinates, then rates, then their rates to where the conditions hold (Newton)."""
    inside = set().union(*(names_in(tree_of(text)) for text in conditions))
    follow = dict(zip([*names.q, *names.rates], [*names.rates, *names.second], strict=True))
    letters = sorted(inside & {*names.q, *names.constant} - {"pi"})
    for order, attempt in [(0, k) for k in range(9)] + [(k, j) for k in (1, 2) for j in (0, 1)]:
        entries = Language(names, values, Interval(1), 2, letters).read([*conditions]).entries
        targets = {name: name for name in letters if order == 0 or name in names.q}
        for _ in range(order):
            targets = {name: follow[target] for name, target in targets.items()}
        axes: list[tuple[dict[str, Decimal], Decimal]] = []  # orthonormal, and how far to go
        for entry in entries:
            error = entry.parts.get((order, ""), Interval(0)).middle * math.factorial(order)
            row = {name: entry.slope(name).parts[0, ""].middle for name in targets}
            for axis, way in axes:
                share = sum(row[name] * axis[name] for name in targets)
                row = {name: row[name] - share * axis[name] for name in targets}
                error -= share * way
            length = sum((part * part for part in row.values()), Decimal(0)).sqrt()
            if length > NEGLIGIBLE:
                axes.append(({name: part / length for name, part in row.items()}, error / length))
        for name, target in targets.items():
            step = sum((axis[name] * way for axis, way in axes), Decimal(0))
            values[target] = Interval(values[target].middle - step, NEAR * bool(attempt))
    for entry in Language(names, values, Interval(1)).read([*conditions]).entries:
        if any(abs(part.middle) > NEAR for part in entry.parts.values()):
            raise NotReal("the conditions were not solved")


def points(record: Mapping[str, Any], names: Names, example: Mapping[str, str]) -> Iterable[Any]:
    """Random real points that no forger can choose; at the first, the conditions hold exactly."""
    conditions, draw = record["rotation"]["conditions"], SystemRandom()
    place = Language(names, {name: Interval(0) for name in names.all}, Interval(1))
    at = {name: place.read(text).entries[0].parts[0, ""] for name, text in example.items()}
    for attempt in range(TRIES):
        values = {
            name: Interval(Decimal(draw.randrange(-3 * 10**20, 3 * 10**20)) / 10**20)
            for name in names.all
        }
        values |= {name: Interval(abs(values[name].middle)) for name in names.constant}
        for name, value in at.items():
            values[name] = Interval(value.middle + (values[name].middle / 4 if attempt else 0))
        values["pi"] = Interval(PI, ROUNDING)
        if conditions:
            try:
                solve(names, conditions, values)
            except NotReal:
                continue
        yield values


def agree_in_numbers(
    record: Mapping[str, Any], names: Names, certificate: Mapping[str, Any]
) -> None:
    """Refuse a claim that is false at a point, or cannot be evaluated at POINTS of them."""
    with localcontext(UPWARDS):
        done = 0
        for values in points(record, names, certificate["example"]):
            try:
                laws = Laws(record, certificate["claims"], names, values, Interval(1))
                claims = {name: laws.claim(name) for name in certificate["claims"]}
                claims[ROTATION] = laws.rotations()
            except NotReal:
                continue
            close = True
            for name, entries in claims.items():
                for k, (one, two) in enumerate(entries, start=1):
                    difference = (one + two * two.number(-1)).parts[0, ""]
                    if abs(difference.middle) > difference.radius:
                        raise Refused(f"{name}: entry {k} is false at a real point")
                    close &= difference.radius < NEGLIGIBLE
            done += close
            if done == POINTS:
                return
    raise Refused("there are no real points at which all claims can be evaluated")


def residuals(laws: Laws, names: Iterable[str]) -> dict[str, list[Poly]]:
    """Polynomials that the claims say to be zero."""
    residuals, ring = dict[str, list[Poly]](), laws.arithmetic[2].ring
    for name in (ROTATION, *names):
        ring.work = 0
        claims = laws.rotations() if name == ROTATION else laws.claim(name)
        differences = (one + two * two.number(-1) for one, two in claims)
        residuals[name] = [each.parts[0, ""].numerator() for each in differences]
    return residuals


def conditions_of(record: Mapping[str, Any], language: Language) -> list[Poly]:
    """Polynomials that are zero on every motion: the conditions and their derivatives."""
    entries = language.read([*record["rotation"]["conditions"]]).entries
    return [part.numerator() for entry in entries for _, part in sorted(entry.parts.items())]


def exactly(
    record: Mapping[str, Any],
    names: Names,
    work: Callable[[Language, Laws], Any],
    claimed: Sequence[str],
) -> Any:
    """What `work` does with polynomials, again if an angle was divided by more than was known."""
    parts: dict[str, int] = {}
    while True:
        one = Poly(Ring(parts), {(): 1})
        arithmetic = names, {name: one.new(name) for name in names.all}, one
        try:
            return work(Language(*arithmetic), Laws(record, claimed, *arithmetic))
        except Finer:
            continue


def refuse_words(record: Mapping[str, Any], names: Names) -> None:
    """Refuse words beside the expressions that would give a true claim another meaning."""
    rotation, spelled = record["rotation"], re.match("euler_([xyz]+)_(..)trinsic$", record["name"])
    if ("matrix" in rotation) == bool(rotation.get("turns")):
        raise Refused("a rotation has either turns or a matrix")
    if record["presentation"] not in ("active", "passive"):
        raise Refused(f"the presentation {record['presentation']!r}")
    axes = "".join(turn.partition("(")[0] for turn in rotation.get("turns", ()))
    if spelled and axes != spelled[1][:: -1 if spelled[2] == "ex" else 1]:
        raise Refused(f"the turns are not those of {record['name']}")
    units = {c["name"]: c["unit"] for g in record["arguments"] for c in g["components"]}
    for turn in rotation.get("turns", ()):
        kind, _, inside = turn.partition("(")
        if kind in ("x", "y", "z") and any(
            units[name] != "rad" for name in names_of(inside[:-1], names) & {*names.q}
        ):
            raise Refused("an angle is not in radians")
    for one, two in [*zip(names.q, names.rates), *zip(names.rates, names.second)]:  # noqa: B905
        rate = {"": "1/s", "rad/s": "rad/s^2", "1/s": "1/s^2"}.get(units[one], f"{units[one]}/s")
        if two in units and units[one] in ("", "rad", "rad/s", "1/s") and units[two] != rate:
            raise Refused(f"{two} is in {units[two]!r}")
    for quantity in record["quantities"]:
        unit = UNITS.get(re.sub("_(space|body)$", "", quantity["name"]), quantity["unit"])
        if quantity["unit"] != unit:
            raise Refused(f"{quantity['name']} is in {quantity['unit']!r}, not in {unit!r}")


def verify(record: Mapping[str, Any], certificate: Mapping[str, Any]) -> list[str]:
    """The names of the proved claims; raises one of BROKEN if one is not."""
    names, claimed = Names(record), certificate["claims"]
    refuse_words(record, names)
    if certificate["record"] != digest(record) or certificate["name"] != record["name"]:
        raise Refused("the record is not the one of this certificate")
    if len({*claimed}) != len(claimed) or not {*claimed} <= {*printed_in(record)}:
        raise Refused("a claim is made twice, or about a quantity that is not printed")

    def prove(language: Language, laws: Laws) -> list[str]:
        zero = conditions_of(record, language)
        for name, text in certificate["example"].items():
            language.meaning[name] = language.value(tree_of(text))
        for entry in language.read([*record["rotation"]["conditions"]]).entries:
            if entry.parts[0, ""].numerator().terms:
                raise Refused("the example does not satisfy the conditions")
        unproved = residuals(laws, claimed)
        for name, entries in unproved.items():
            for k, residual in enumerate(entries, start=1):
                for place, text in certificate["cofactors"].get(f"{name} {k}", {}).items():
                    residual = (
                        residual + laws.still.value(tree_of(text)).parts[0, ""] * zero[int(place)]
                    )
                if residual.numerator().terms:
                    raise Refused(f"{name}: entry {k} is not proved")
        return [*unproved]

    agree_in_numbers(record, names, certificate)
    proved: list[str] = exactly(record, names, prove, claimed)
    return proved


def plain(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(dict(pairs)) < len(pairs):
        raise Refused(f"a key is there twice: {[key for key, _ in pairs]}"[:200])
    return dict(pairs)


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text, object_pairs_hook=plain, parse_float=str, parse_constant=str)


if __name__ == "__main__":
    refused = 0
    for path in sorted(p for folder in sys.argv[1:] for p in Path(folder).rglob("*.cert.json")):
        try:
            record, certificate = load(path.with_name(path.name.replace(".cert", ""))), load(path)
            print(f"{path}: proved for R by {record['rotation']}: {verify(record, certificate)}")
        except (*BROKEN, OSError) as error:
            refused = 1
            print(f"{path}: REFUSED: {error}")
    sys.exit(refused)
