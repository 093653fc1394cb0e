"""Checks records of rigidsym without rigidsym: `python checker.py FOLDER...`

A record NAME.json describes a rotation, perhaps with a body and a potential, and prints
expressions. This program works out the same quantities from their definitions, at a random point
and in exact numbers, and compares. It believes nothing but the description.

Why one point is enough. The cosine and the sine of an angle are (1 - t²)/(1 + t²) and
2t/(1 + t²), and unit vectors are fractions of polynomials as well. So both sides of an identity
are such fractions in the drawn numbers. Two different ones, of degree d, agree by chance at most d
times in 2¹²⁸ if each number is one of 2¹²⁸ (the lemma of Schwartz and Zippel). MOST_DEGREE keeps
d below 10⁹: of 10²⁹ runs, at most one accepts a false identity. A forger cannot choose the point,
at which every divisor is shown not to be zero, and every root is real and positive.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, cached_property, reduce
from itertools import starmap
from math import gcd, isqrt, lcm
from operator import add, mul
from pathlib import Path
from random import SystemRandom
from typing import Any

BITS, MOST_DEGREE, MOST_DIGITS, MOST_PARTS = 128, 100_000, 40, 12
ANGULAR = "cos", "sin", "tan", "cot"
FUNCTIONS = *ANGULAR, "sqrt"
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
SQUARE = re.compile(r"([A-Za-z]\w*)\*\*2", re.ASCII)
SPHERE = re.compile(rf"{SQUARE.pattern}( \+ {SQUARE.pattern})+", re.ASCII)
UNITS = {"rotation_matrix": "", "rotation_rate": "1/s", "spin_matrix": "rad/s"}
UNITS |= {"angular_velocity": "rad/s", "angular_acceleration": "rad/s^2"}
OF_POSITION = "rate_matrix", "inverse_rate_matrix", "rates_from_angular_velocity"
Tree = tuple[Any, ...]
Number = Any  # a Fraction or a Surd
Turn = tuple[Any, Any]  # a cosine and a sine
UNIT: Tree = ("number", 1)
NO_TURN: Turn = Fraction(1), Fraction(0)


class Refused(ValueError):
    """What is printed is false, or the record contradicts itself."""


class Unreadable(ValueError):
    """An expression or a quantity that this program does not know; it is not proved."""


BROKEN = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, RecursionError)


# Expressions: sums, products, whole powers and FUNCTIONS of names, and no other characters


@cache
def tree_of(text: str) -> Tree:
    """Nested tuples, such as ("*", ("number", 2), ("cos", ("name", "phi")))."""
    try:
        if not re.fullmatch(r"[A-Za-z0-9_+*/() -]*", text, re.ASCII):
            raise SyntaxError
        text = re.sub(r"\b[A-Za-z]\w*", r"\g<0>_", text.strip())  # so that no name is a keyword
        return _tree(ast.parse(text, mode="eval").body)
    except (SyntaxError, MemoryError, RecursionError) as error:
        raise Refused(f"the expression {text[:60]!r} cannot be read") from error


def _tree(node: ast.AST) -> Tree:
    match node:
        case ast.Name(id=name):
            return ("name", name[:-1])
        case ast.Constant(value=number) if type(number) is int and number < 10**MOST_DIGITS:
            return ("number", number)
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if (
            name[:-1] in FUNCTIONS
        ):
            return (name[:-1], _tree(argument))
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return ("-", ("number", 0), _tree(operand))
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=power)) if (
            type(power) is int
        ):
            return ("**", _tree(base), power)
        case ast.BinOp(left=one, op=operator, right=two) if type(operator) in OPERATORS:
            return (OPERATORS[type(operator)], _tree(one), _tree(two))
    raise SyntaxError


def parts_of(tree: Tree) -> Iterator[Tree]:
    """A tree and all trees in it."""
    yield tree
    for part in tree[1:]:
        if isinstance(part, tuple):
            yield from parts_of(part)


def names_in(tree: Tree) -> set[str]:
    return {part[1] for part in parts_of(tree) if part[0] == "name"}


def squared(tree: Tree) -> list[str]:
    """The names of a sum of squares x² + y² + ..., or none."""
    match tree:
        case ("+", one, two):
            first, rest = squared(one), squared(two)
            return first + rest if first and rest else []
        case ("**", ("name", name), 2):
            return [name]
    return []


def texts_in(printed: Any) -> list[str]:
    """The texts of a scalar, a vector or a matrix."""
    if isinstance(printed, list):
        return [text for each in printed for text in texts_in(each)]
    return [printed]


# Exact numbers, power series of them, and matrices of these


class Surd:
    """Sums of roots, such as 1/2 + 3√2: fractions by the number n below the root.

    Every n is a product of different primes. Their roots are independent over the fractions, so
    a sum is zero only without terms.
    """

    def __init__(self, terms: Mapping[int, Fraction]) -> None:
        self.terms = {n: factor for n, factor in terms.items() if factor}

    def __add__(self, other: Number) -> Surd:
        terms = dict(self.terms)
        for n, factor in terms_of(other).items():
            terms[n] = terms.get(n, Fraction(0)) + factor
        return Surd(terms)

    def __mul__(self, other: Number) -> Surd:
        products = [
            Surd({n * m // gcd(n, m) ** 2: one * two * gcd(n, m)})
            for n, one in self.terms.items()
            for m, two in terms_of(other).items()
        ]
        return reduce(add, products, Surd({}))

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Surd:
        return self * -1

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __rtruediv__(self, numerator: Number) -> Surd:
        """By conjugation: (a + b√p)(a - b√p) is free of √p."""
        roots = [n for n in self.terms if n > 1]
        if not roots:
            return Surd({1: 1 / self.terms.get(1, Fraction(0))}) * numerator
        prime = next(p for p in range(2, roots[0] + 1) if roots[0] % p == 0)
        conjugate = Surd({n: -f if n % prime == 0 else f for n, f in self.terms.items()})
        return conjugate * (numerator / (self * conjugate))


def terms_of(number: Number) -> Mapping[int, Fraction]:
    return number.terms if isinstance(number, Surd) else {1: Fraction(number)}


def root(number: Number) -> Number:
    """The positive root of a positive fraction, if it is a fraction or the root of a small one."""
    terms = terms_of(number)
    if [*terms] != [1] or terms[1] < 0:
        raise Unreadable("a root of a number that is not a positive fraction")
    whole, below = terms[1].numerator * terms[1].denominator, terms[1].denominator
    if isqrt(whole) ** 2 == whole:
        return Fraction(isqrt(whole), below)
    if whole > 10**6:
        raise Unreadable("a root that is not a fraction")
    square = next(k for k in range(isqrt(whole), 0, -1) if whole % k**2 == 0)
    return Surd({whole // square**2: Fraction(square, below)})


class Series:
    """c₀ + c₁ s + c₂ s² along a path, as far as it is known."""

    def __init__(self, *parts: Number) -> None:
        self.parts = parts

    def __add__(self, other: Series) -> Series:
        return Series(*map(add, self.parts, other.parts))  # the shorter one is what is known

    def __sub__(self, other: Series) -> Series:
        return self + other * -1

    def __mul__(self, other: Series | Number) -> Series:
        if not isinstance(other, Series):
            return Series(*(part * other for part in self.parts))
        one, two = self.parts, other.parts
        orders = range(min(len(one), len(two)))
        if not any(one) or not any(two):
            return Series(*(0 for _ in orders))
        return Series(*(reduce(add, [one[j] * two[k - j] for j in range(k + 1)]) for k in orders))

    @property
    def change(self) -> Series:
        """h of c₀ + h; its third power is not known."""
        return Series(Fraction(0), *self.parts[1:])

    def rate(self) -> Series:
        if len(self.parts) < 2:
            raise Unreadable("a derivative that is not known")
        return Series(*(part * k for k, part in enumerate(self.parts[1:], start=1)))

    def inverse(self) -> Series:
        """1/(c + h) = (1 - u + u²)/c with u = h/c."""
        if not self.parts[0]:
            raise Refused("a divisor is zero")
        inverse = Fraction(1) / self.parts[0]
        u = self.change * inverse
        return (u * u - u + ONE) * inverse

    def sqrt(self) -> Series:
        """√(c + h) = (1 + u/2 - u²/8) √c with u = h/c."""
        value = root(self.parts[0])
        u = self.change * (Fraction(1) / self.parts[0])
        return (ONE + u * Fraction(1, 2) - u * u * Fraction(1, 8)) * value

    def turn(self, cosine: Number, sine: Number) -> Turn:
        """The cosine and the sine of c + h, from those of c."""
        h = self.change
        even = ONE - h * h * Fraction(1, 2)
        return even * cosine - h * sine, even * sine + h * cosine


ONE, ZERO = Series(Fraction(1), 0, 0), Series(Fraction(0), 0, 0)


class Matrix:
    """Rows of series; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Iterable[Series]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))

    def each(self, change: Callable[[Series], Series]) -> Matrix:
        return Matrix(map(change, row) for row in self.rows)

    def __add__(self, other: Matrix) -> Matrix:
        rows = zip(self.rows, other.rows, strict=True)
        return Matrix([one + two for one, two in zip(*pair, strict=True)] for pair in rows)

    def __sub__(self, other: Matrix) -> Matrix:
        return self + other * -1

    def __mul__(self, other: Matrix | Series | Number) -> Matrix:
        if not isinstance(other, Matrix):
            return self.each(lambda entry: entry * other)
        pairs = ([zip(row, column, strict=True) for column in other.T.rows] for row in self.rows)
        return Matrix([reduce(add, starmap(mul, pair)) for pair in row] for row in pairs)

    def rate(self) -> Matrix:
        return self.each(Series.rate)

    def hat(self) -> Matrix:
        """C(v) of a vector v, the operator v ×."""
        x, y, z = self.entries
        return Matrix([[ZERO, z * -1, y], [z, ZERO, x * -1], [y * -1, x, ZERO]])

    def vee(self) -> Matrix:
        """v of a skew matrix C(v)."""
        return Matrix([[self.rows[2][1]], [self.rows[0][2]], [self.rows[1][0]]])

    def determinant(self) -> Series:
        first, *rest = self.rows
        if not rest:
            return first[0]
        minors = (Matrix([row[:k] + row[k + 1 :] for row in rest]) for k in range(len(first)))
        terms = enumerate(zip(first, minors, strict=True))
        return reduce(add, [entry * minor.determinant() * (-1) ** k for k, (entry, minor) in terms])


IDENTITY = Matrix([[ONE if j == k else ZERO for k in range(3)] for j in range(3)])

# What a record describes


class Names:
    """The names of a record: no two are alike, and rates are named after their coordinates."""

    def __init__(self, record: Mapping[str, Any]) -> None:
        groups = {g["name"]: [c["name"] for c in g["components"]] for g in record["arguments"]}
        if len(groups) < len(record["arguments"]):
            raise Refused("two groups of arguments have one name")
        self.q, self.constant = groups["q"], [*groups.get("parameters", ()), "pi"]
        self.rates, self.second = ([name + end for name in self.q] for end in ("_dot", "_ddot"))
        self.free = {*self.q, *self.constant} - {"pi"}
        self.momenta = [f"p_{name}" for name in self.q]
        self.definitions = {d["name"]: d["expression"] for d in record["definitions"]}
        of_motion = {"q_dot": self.rates, "q_ddot": self.second, "momenta": self.momenta}
        if any(groups.get(name, named) != named for name, named in of_motion.items()):
            raise Refused("rates and momenta are not named after the coordinates, in their order")
        own = [*self.q, *self.rates, *self.second, *self.constant, *self.definitions]
        self.others = sorted({name for names in groups.values() for name in names} - {*own})
        reserved = {*self.momenta, *LETTERS.split(), *OMEGA["space"], *OMEGA["body"]}
        for name in [*own, *self.others]:
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name, re.ASCII):
                raise Refused(f"the name {name!r} is not plain ASCII")
            if own.count(name) > 1 or name in reserved.intersection(own) or name in FUNCTIONS:
                raise Refused(f"the name {name!r} has two meanings")
        self.spheres = [*map(self.sphere, record["rotation"]["conditions"])]
        on_spheres = [name for sphere in self.spheres for name in sphere]
        if len({*on_spheres}) < len(on_spheres):
            raise Refused("a name is in two conditions")

    def sphere(self, condition: str) -> list[str]:
        """The names of a condition x² + y² + ... = 1: all coordinates, or all constant."""
        squares = condition.removesuffix(" - 1")
        names = SQUARE.findall(squares)
        if squares == condition or not SPHERE.fullmatch(squares):
            raise Unreadable(f"the condition {condition!r}, which is no sum of squares less 1")
        if not self.are_alike(names):
            raise Refused(f"the condition {condition!r} on more than coordinates or constants")
        return names

    def are_alike(self, names: Sequence[str]) -> bool:
        """Whether they are all coordinates, or all constant."""
        return {*names} <= {*self.q} or {*names} <= {*self.constant} - {"pi"}

    def inside(self, printed: Any) -> set[str]:
        """The names in texts and in their definitions."""
        names, texts = set[str](), texts_in(printed)
        while texts:
            new = names_in(tree_of(texts.pop())) - names
            names |= new
            texts += [self.definitions[name] for name in new & {*self.definitions}]
        return names - {*self.definitions}

    def holding(self, printed: Any, names: Iterable[str]) -> Any:
        """A text or texts, in which no other names may be."""
        if extra := sorted(self.inside(printed) - {*names}):
            raise Refused(f"{extra[0]} must not be in {printed!r}"[:200])
        return printed


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
OMEGA = {frame: [f"omega_{frame}_{k}" for k in (1, 2, 3)] for frame in ("space", "body")}
PRINCIPAL = "principal_axes", "principal_moments"
ROTATION = "R is a rotation"


def turn_of(text: str) -> tuple[str, list[str]]:
    """What a turn such as "z(phi)" is about, and the five texts of TURNS."""
    kind, _, inside = text.partition("(")
    if kind not in TURNS or not inside.endswith(")"):
        raise Refused(f"the turn {text!r}")
    places = [f"({place})" for place in inside[:-1].split(",")]
    forms = TURNS[kind].replace("N", SQUARES)
    if len(places) != len({*re.findall(r"\{.\}", forms)}):
        raise Refused(f"the turn {text!r}")
    return kind, [form.format(*places) for form in forms.split(";")]


def printed_in(record: Mapping[str, Any]) -> dict[str, Any]:
    """The printed expressions by their names."""
    printed = [(q["name"], q["expression"]) for q in record["quantities"]]
    printed += [("constant " + f["name"], f["expression"]) for f in record["first_integrals"]]
    if len({ROTATION, *dict(printed)}) <= len(printed):
        raise Refused("two quantities have one name")
    return dict(printed)


def summands(tree: Tree, factor: Fraction | int = 1) -> dict[Tree, Fraction]:
    """An angle as a sum of multiples, such as {φ: 2, ψ: -1}; numbers are multiples of UNIT."""
    kind, *parts = tree
    if kind == "number":
        return {UNIT: Fraction(parts[0]) * factor}
    if kind in ("+", "-"):
        one, two = (
            summands(parts[0], factor),
            summands(parts[1], factor if kind == "+" else -factor),
        )
        return {part: one.get(part, Fraction(0)) + two.get(part, 0) for part in {**one, **two}}
    if kind in ("*", "/"):
        one, two = map(summands, parts)
        if [*two] == [UNIT]:
            return summands(parts[0], factor * two[UNIT] if kind == "*" else factor / two[UNIT])
        if [*one] == [UNIT] and kind == "*":
            return summands(parts[1], factor * one[UNIT])
    return {tree: Fraction(factor)}


class Point:
    """Numbers for all names of a record, drawn at random so that its conditions hold.

    Coordinates are power series in time, whose coefficients give rates and accelerations. The
    lengths of vectors are drawn as well, and so are fractions. Other roots of names have no value,
    since √(x²) is x or -x.
    """

    def __init__(self, names: Names, texts: Sequence[str]) -> None:
        trees = [*map(tree_of, texts)]
        self.names, self.circles = names, dict[Fraction, Turn]()
        self.parts, self.vectors = parts_of_angles(names, trees), list[set[str]]()
        start = {name: self.series(name) for name in [*names.q, *names.constant]}
        roots = [part[1] for tree in trees for part in parts_of(tree) if part[0] == "sqrt"]
        for group in [*names.spheres, *filter(None, map(squared, roots))]:
            is_new = all(vector.isdisjoint(group) for vector in self.vectors)
            if is_new and names.are_alike(group) and 1 < len({*group}) == len(group):
                self.vectors.append({*group})
                length = ONE if group in names.spheres else self.series(group[0])
                vector = on_sphere([self.series(name) for name in group[1:]])
                start |= {name: each * length for name, each in zip(group, vector, strict=True)}
        for q, rate, second in zip(names.q, names.rates, names.second, strict=True):
            start |= {rate: start[q].rate(), second: start[q].rate().rate()}
        for name in {*names.others, *LETTERS.split(), *OMEGA["space"], *OMEGA["body"]}:
            start.setdefault(name, Series(self.number()))
        self.time = Course(self, start)
        self.still = self.along("")

    def number(self) -> Fraction:
        """Above 0, since the lengths of vectors are."""
        return Fraction(SystemRandom().randrange(1, 2**BITS))

    def series(self, name: str) -> Series:
        is_constant = name in self.names.constant
        return Series(self.number(), *((0, 0) if is_constant else (self.number(), self.number())))

    def along(self, name: str) -> Course:
        """The course on which one name changes at the rate 1, and no other."""
        values = self.time.meaning.items()
        return Course(self, {each: Series(v.parts[0], int(each == name)) for each, v in values})

    def is_independent(self, angle: Tree) -> bool:
        """Whether its cosine is tied to no other: a product of free names, a length, or 1."""
        kind, *parts = angle
        if kind == "*":
            return all(part != UNIT and self.is_independent(part) for part in parts)
        if kind == "sqrt":
            return {*squared(parts[0])} in self.vectors
        return angle == UNIT or parts[0] in self.names.free

    def turn(self, angle: Fraction, multiple: Fraction) -> Turn:
        """The cosine and the sine of a multiple of an angle, which are independent of the angle."""
        count = multiple * self.parts
        if count.denominator > 1 or abs(count) > MOST_PARTS:
            raise Unreadable("too large a multiple of an angle")
        if angle not in self.circles:
            t = self.number()
            self.circles[angle] = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
        cosine, sine = self.circles[angle]
        part = cosine, sine if count > 0 else -sine
        return reduce(sum_of_turns, [part] * abs(int(count)), NO_TURN)


def sum_of_turns(one: Turn, two: Turn) -> Turn:
    """The cosine and the sine of a sum."""
    return one[0] * two[0] - one[1] * two[1], one[1] * two[0] + one[0] * two[1]


def on_sphere(u: Sequence[Series]) -> list[Series]:
    """The unit vector (1 - u², 2 u)/(1 + u²), by stereographic projection."""
    square = reduce(add, [each * each for each in u])
    scale = (ONE + square).inverse()
    return [(ONE - square) * scale, *(each * scale * 2 for each in u)]


def parts_of_angles(names: Names, trees: Sequence[Tree]) -> int:
    """Into how many parts angles are divided; refuses expressions of too large a degree."""

    @cache
    def degrees(tree: Tree) -> tuple[int, int]:
        """Of numerator and denominator; numbers count, since their digits do."""
        kind, *parts = tree
        if kind == "name" and parts[0] in names.definitions:
            return degrees(tree_of(names.definitions[parts[0]]))
        if kind in ("name", "number", *ANGULAR):
            return 1, int(kind in ("tan", "cot"))
        one, below = degrees(parts[0])
        if kind in ("**", "sqrt"):
            power = parts[1] if kind == "**" else 1
            return one * power, below * power
        two, divisor = degrees(parts[1])
        if kind in ("*", "/"):
            return (one + two, below + divisor) if kind == "*" else (one + divisor, below + two)
        return max(one + divisor, two + below), below + divisor

    if any(max(degrees(tree)) > MOST_DEGREE for tree in trees):
        raise Refused("the degree of an expression is too large")
    angles = {part[1] for tree in trees for part in parts_of(tree) if part[0] in ANGULAR}
    multiples = [multiple for angle in angles for multiple in summands(angle).values()]
    parts = lcm(*(multiple.denominator for multiple in multiples))
    if parts > MOST_PARTS:
        raise Refused(f"an angle is divided by {parts}")
    return parts


class Course:
    """What the expressions of a record are along a path through a point."""

    def __init__(self, point: Point, meaning: dict[str, Series]) -> None:
        self.point, self.meaning, self.values = point, meaning, dict[Tree, Series]()

    def read(self, printed: Any) -> Matrix:
        """A scalar, the column of a vector, or a matrix."""
        rows = printed if isinstance(printed, list) else [printed]
        texts = [row if isinstance(row, list) else [row] for row in rows]
        return Matrix([self.value(tree_of(text)) for text in row] for row in texts)

    def value(self, tree: Tree) -> Series:
        if tree not in self.values:
            self.values[tree] = self.worked_out(*tree)
        return self.values[tree]

    def worked_out(self, kind: str, *parts: Any) -> Series:
        if kind == "number":
            return ONE * parts[0]
        if kind == "name":
            return self.name(parts[0])
        if kind in ANGULAR:
            cosine, sine = self.turn(parts[0])
            if kind in ("cos", "sin"):
                return cosine if kind == "cos" else sine
            return sine * cosine.inverse() if kind == "tan" else cosine * sine.inverse()
        one = self.value(parts[0])
        if kind == "sqrt":
            is_number = all(part[0] not in ("name", *ANGULAR) for part in parts_of(parts[0]))
            if is_number or {*squared(parts[0])} in self.point.vectors:
                return one.sqrt()
            raise Unreadable("a root that may be of either sign")
        if kind == "**":
            return reduce(mul, [one] * parts[1], ONE)
        two = self.value(parts[1])
        if kind == "/":
            return one * two.inverse()
        return one * two if kind == "*" else one + two if kind == "+" else one - two

    def name(self, name: str) -> Series:
        definitions = self.point.names.definitions
        if name in definitions:
            return self.value(tree_of(definitions[name]))
        if name not in self.meaning:
            raise Refused(f"{name} has no meaning here")
        return self.meaning[name]

    def turn(self, angle: Tree) -> Turn:
        """The cosine and the sine of an angle."""
        turn = NO_TURN
        for part, multiple in summands(angle).items():
            if not self.point.is_independent(part):
                raise Unreadable("an angle that may be a multiple of another one")
            turn = sum_of_turns(turn, self.point.turn(self.value(part).parts[0], multiple))
        return self.value(angle).turn(*turn)


# What is claimed: each quantity from its definition


class Motion:
    """The rotation of a record at a point, its body, and what moves it."""

    def __init__(self, record: Mapping[str, Any], names: Names, point: Point) -> None:
        self.record, self.names, self.point = record, names, point
        self.factors = [*self.factors_along(point.time)]
        self.R: Matrix = reduce(mul, self.factors)

    def factors_along(self, course: Course) -> Iterator[Matrix]:
        """The turns whose product R is, or R itself."""
        rotation = self.record["rotation"]
        if "matrix" in rotation:
            yield course.read(rotation["matrix"])
        for text in rotation.get("turns", ()):
            *axis, cosine, sine = course.read(turn_of(text)[1]).entries
            operator = Matrix([[part] for part in axis]).hat()
            yield IDENTITY + operator * sine + operator * operator * (ONE - cosine)

    def shown(self, matrix: Matrix) -> Matrix:
        return matrix.T if self.record["presentation"] == "passive" else matrix

    def velocity(self, frame: str) -> Matrix:
        """Ω of C(Ω) = dR/dt Rᵀ, or Ω' of C(Ω') = Rᵀ dR/dt."""
        R, rate = self.R, self.R.rate()
        return (rate * R.T if frame == "space" else R.T * rate).vee()

    @cached_property
    def slopes(self) -> list[Matrix]:
        """The derivatives of R by the coordinates."""
        courses = map(self.point.along, self.names.q)
        return [reduce(mul, self.factors_along(course)).rate() for course in courses]

    def rate_matrix(self, frame: str) -> Matrix:
        """W with Ω = W q̇."""
        R = self.R
        spins = (slope * R.T if frame == "space" else R.T * slope for slope in self.slopes)
        return Matrix([spin.vee().entries for spin in spins]).T

    def vector(self, letters: str) -> Matrix:
        return self.point.still.read(letters.split())

    def body(self, part: str) -> Matrix:
        if "body" not in self.record:
            raise Unreadable("there is no body")
        constant = self.names.holding(self.record["body"][part], self.names.constant)
        value = self.point.time.read(constant)
        if part == "inertia":
            agree("the inertia tensor is not symmetric", [(value, value.T)])
        return value

    @property
    def momentum(self) -> Matrix:
        """I' Ω'."""
        return self.body("inertia") * self.velocity("body")

    @property
    def tensor_about_point(self) -> Matrix:
        """I' + M (|d|² - d dᵀ), by the parallel-axis theorem."""
        arm = (self.vector("p_x p_y p_z") - self.body("centre")).hat()
        return self.body("inertia") + arm.T * arm * self.body("mass").entries[0]

    @property
    def translational_energy(self) -> Matrix:
        velocity = self.vector("X_dot Y_dot Z_dot")
        return velocity.T * velocity * self.body("mass") * HALF

    @property
    def rotational_energy(self) -> Matrix:
        return self.velocity("body").T * self.momentum * HALF

    @property
    def momentum_of_centre(self) -> Matrix:
        return self.vector("X Y Z").hat() * self.vector("X_dot Y_dot Z_dot") * self.body("mass")

    @property
    def acting(self) -> Mapping[str, Any]:
        """The texts of what acts on a body of one part in independent coordinates."""
        if "motion" not in self.record or self.on_sphere:
            raise Unreadable("there is no motion in independent coordinates")
        names = [*self.names.q, *self.names.constant]
        motion = self.record["motion"]
        self.names.holding(motion["potential"], names)
        self.names.holding([motion["forces"], motion["torque"]], [*names, *self.names.rates])
        return motion

    @property
    def rate_matrix_of_motion(self) -> Matrix:
        """W', if the record describes a motion."""
        _ = self.acting
        return self.rate_matrix("body")

    @property
    def potential(self) -> Matrix:
        return self.point.still.read(self.acting["potential"])

    @property
    def forces(self) -> Matrix:
        """Q, with W'ᵀ N' of a torque N' along the axes of the body."""
        forces, torque = (self.point.still.read(self.acting[part]) for part in ("forces", "torque"))
        return forces + self.rate_matrix("body").T * torque

    @property
    def momenta(self) -> Matrix:
        """p = W'ᵀ I' Ω'."""
        return self.rate_matrix_of_motion.T * self.momentum

    @property
    def mass_matrix(self) -> Matrix:
        W = self.rate_matrix_of_motion
        return W.T * self.body("inertia") * W

    @cached_property
    def inertial(self) -> Matrix:
        """M q̈ + h, by d'Alembert's principle: W'ᵀ (dL'/dt + Ω' × L') + ∂V/∂q with L' = I' Ω'."""
        turning = self.momentum.rate() + self.velocity("body").hat() * self.momentum
        courses = map(self.point.along, self.names.q)
        slopes = [course.read(self.acting["potential"]).rate().entries for course in courses]
        return self.rate_matrix("body").T * turning + Matrix(slopes)

    @property
    def bias(self) -> Matrix:
        return self.inertial - self.mass_matrix * self.vector(" ".join(self.names.second))

    @property
    def torque_left(self) -> Matrix:
        """N' - Ω' × I' Ω' of any Ω' and N'."""
        omega = self.vector(" ".join(OMEGA["body"]))
        return self.vector("torque_1 torque_2 torque_3") - omega.hat() * (
            self.body("inertia") * omega
        )

    @property
    def on_sphere(self) -> list[list[str]]:
        return [sphere for sphere in self.names.spheres if sphere[0] in self.names.q]


HALF = Fraction(1, 2)
DEFINITIONS: dict[str, Callable[[Motion], Matrix]] = {
    "rotation_matrix": lambda m: m.shown(m.R),
    "rotation_rate": lambda m: m.shown(m.R).rate(),
    "spin_matrix": lambda m: m.shown(m.R).rate() * m.shown(m.R).T,
    "angular_velocity_space": lambda m: m.velocity("space"),
    "angular_velocity_body": lambda m: m.velocity("body"),
    "angular_acceleration_space": lambda m: m.velocity("space").rate(),
    "angular_acceleration_body": lambda m: m.velocity("body").rate(),
    "mass": lambda m: m.body("mass"),
    "centre_of_mass": lambda m: m.body("centre"),
    "inertia_tensor": lambda m: m.body("inertia"),
    "inertia_tensor_space": lambda m: m.R * m.body("inertia") * m.R.T,
    "inertia_tensor_point": lambda m: m.tensor_about_point,
    "moment_of_inertia": lambda m: (n := m.vector("n_x n_y n_z")).T * m.tensor_about_point * n,
    "translational_energy": lambda m: m.translational_energy,
    "rotational_energy": lambda m: m.rotational_energy,
    "kinetic_energy": lambda m: m.translational_energy + m.rotational_energy,
    "angular_momentum_centre": lambda m: m.momentum_of_centre,
    "angular_momentum_rotation_body": lambda m: m.momentum,
    "angular_momentum_rotation": lambda m: m.R * m.momentum,
    "angular_momentum": lambda m: m.momentum_of_centre + m.R * m.momentum,
    "potential_energy": lambda m: m.potential,
    "lagrangian": lambda m: m.rotational_energy - m.potential,
    "energy": lambda m: m.rotational_energy + m.potential,
    "generalised_momenta": lambda m: m.momenta,
    "mass_matrix": lambda m: m.mass_matrix,
    "bias_vector": lambda m: m.bias,
}
EQUATIONS: dict[str, Callable[[Motion], tuple[Matrix, Matrix]]] = {  # A x = B
    "accelerations": lambda m: (invertible(m.mass_matrix), m.forces - m.bias),
    "angular_acceleration_from_torque": lambda m: (invertible(m.body("inertia")), m.torque_left),
}


def invertible(matrix: Matrix) -> Matrix:
    """Refuse a matrix with a determinant of zero."""
    matrix.determinant().inverse()
    return matrix


def claims_of(motion: Motion, name: str) -> Iterator[tuple[Matrix, Matrix]]:
    """Pairs of matrices that are equal if what is printed as `name` is right."""
    names, still, printed = motion.names, motion.point.still, printed_in(motion.record)
    kind, _, frame = name.rpartition("_")
    of_position = [*names.q, *names.constant]
    if name in DEFINITIONS:
        yield still.read(printed[name]), DEFINITIONS[name](motion)
    elif name in EQUATIONS:
        matrix, right = EQUATIONS[name](motion)
        yield matrix * still.read(printed[name]), right
    elif name == "hamiltonian":  # H(q, p) for p = M q̇, and so for all p
        text = names.holding(printed[name], [*of_position, *names.momenta])
        momenta = dict(zip(names.momenta, motion.momenta.entries, strict=True))
        yield (
            Course(motion.point, still.meaning | momenta).read(text),
            DEFINITIONS["energy"](motion),
        )
    elif name in PRINCIPAL and {*PRINCIPAL} <= {*printed}:
        texts = (names.holding(printed[each], names.constant) for each in PRINCIPAL)
        axes, moments = map(still.read, texts)
        yield axes * axes.T, IDENTITY
        yield Matrix([[axes.determinant()]]), Matrix([[ONE]])
        scaled = Matrix(map(mul, row, moments.entries) for row in axes.rows)
        yield motion.body("inertia") * axes, scaled
    elif kind in OF_POSITION and frame in OMEGA:
        # W and its inverse hold no rate, in which a false term could vanish
        omega = OMEGA[frame] * (kind == "rates_from_angular_velocity")
        x = still.read(names.holding(printed[name], [*of_position, *omega]))
        if kind == "rate_matrix":
            yield x * still.read(names.rates), motion.velocity(frame)
            return
        yield motion.rate_matrix(frame) * x, still.read(omega) if omega else IDENTITY
        for sphere in motion.on_sphere:  # the rates keep q on it
            row = still.read([[q if q in sphere else "0" for q in names.q]])
            yield row * x, row * x * 0
    elif name in (constants := ["constant energy", *(f"constant momentum_{q}" for q in names.q)]):
        lacking = motion.inertial - motion.forces  # zero along a motion
        rates = [*(still.read([names.rates]) * lacking).entries, *lacking.entries]
        rate = motion.point.time.read(printed[name]).rate()
        yield rate, Matrix([[rates[constants.index(name)]]])
    else:
        raise Unreadable("it has no definition here")


def agree(name: str, pairs: Iterable[tuple[Matrix, Matrix]]) -> None:
    for one, two in pairs:
        for k, difference in enumerate((one - two).entries, start=1):
            if difference.parts[0]:
                raise Refused(f"{name}: entry {k} is false at a real point")


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
        kind, forms = turn_of(turn)
        is_by_angle = kind in ("x", "y", "z", "axis_angle")
        angles = names.inside(forms[4]) & {*names.q} if is_by_angle else ()
        if any(units[name] != "rad" for name in angles):
            raise Refused("an angle is not in radians")
    for one, two in [*zip(names.q, names.rates), *zip(names.rates, names.second)]:  # noqa: B905
        rate = {"": "1/s", "rad/s": "rad/s^2", "1/s": "1/s^2"}.get(units[one], f"{units[one]}/s")
        if two in units and units[one] in ("", "rad", "rad/s", "1/s") and units[two] != rate:
            raise Refused(f"{two} is in {units[two]!r}")
    for quantity in record["quantities"]:
        unit = UNITS.get(re.sub("_(space|body)$", "", quantity["name"]), quantity["unit"])
        if quantity["unit"] != unit:
            raise Refused(f"{quantity['name']} is in {quantity['unit']!r}, not in {unit!r}")


def verify(record: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """The names of what is proved, and of what is not, with the reasons.

    Raises one of BROKEN for a record of which something is false.
    """
    printed, rotation = printed_in(record), record["rotation"]
    forms = [turn_of(turn)[1] for turn in rotation.get("turns", ())]
    definitions = [each["expression"] for each in record["definitions"]]
    texts = texts_in([*printed.values(), definitions, *forms, rotation.get("matrix", [])])
    try:
        names = Names(record)
        refuse_words(record, names)
        motion = Motion(record, names, Point(names, texts))
    except Unreadable as error:
        return [], dict.fromkeys(printed, str(error))
    for turn in motion.factors:
        agree(ROTATION, [(turn * turn.T, IDENTITY)])
        agree(ROTATION, [(Matrix([[turn.determinant()]]), Matrix([[ONE]]))])
    proved, reasons = [ROTATION], dict[str, str]()
    for name in printed:
        try:
            agree(name, claims_of(motion, name))
            proved.append(name)
        except (Unreadable, RecursionError) as error:
            reasons[name] = str(error)
    return proved, reasons


def without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(dict(pairs)) < len(pairs):
        raise Refused(f"a key is there twice: {[key for key, _ in pairs]}"[:200])
    return dict(pairs)


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text, object_pairs_hook=without_twins, parse_float=str, parse_constant=str)


if __name__ == "__main__":
    status = 0
    for path in sorted(path for folder in sys.argv[1:] for path in Path(folder).rglob("*.json")):
        try:
            record = load(path)
            if not isinstance(record, dict) or record.get("schema") != "rigidsym.derivation":
                continue
            proved, reasons = verify(record)
            print(f"{path}: R is {record['rotation']}")
            print(f"  proved: {', '.join(proved) or 'nothing'}")
            for name, reason in reasons.items():
                print(f"  not proved: {name}, since {reason}")
        except (*BROKEN, OSError) as error:
            status = 1
            print(f"{path}: REFUSED: {error}")
    sys.exit(status)
