"""Checks records of rigidsym without rigidsym: `python checker.py FOLDER|RECORD...`

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
from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from fractions import Fraction
from functools import cache, reduce
from math import gcd, isqrt, lcm
from operator import add, mul, sub, truediv
from pathlib import Path
from random import SystemRandom
from typing import Any

BITS, MOST_DEGREE, MOST_POWER = 128, 100_000, 60
MOST_DIGITS, MOST_PARTS, MOST_ROOTS = 40, 12, 6
ANGULAR = "cos", "sin", "tan", "cot"
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
OMEGA = {frame: [f"omega_{frame}_{k}" for k in (1, 2, 3)] for frame in ("space", "body")}
PLACE, VELOCITY, AXIS = ["X", "Y", "Z"], ["X_dot", "Y_dot", "Z_dot"], ["n_x", "n_y", "n_z"]
ABOUT, TORQUE = ["p_x", "p_y", "p_z"], ["torque_1", "torque_2", "torque_3"]
LETTERS = *PLACE, *VELOCITY, *AXIS, *ABOUT, *TORQUE, *OMEGA["space"], *OMEGA["body"], "pi"
PRINCIPAL = "principal_axes", "principal_moments"
DESCRIBED = "matrix", "mass", "centre", "inertia", "potential", "forces", "torque"
ROTATION = "R is a rotation"
UNITS = {
    "": ("rotation_matrix", "principal_axes", *AXIS),
    "1/s": ("rotation_rate",),
    "rad/s": ("spin_matrix", "angular_velocity", *OMEGA["space"], *OMEGA["body"]),
    "rad/s^2": ("angular_acceleration", "angular_acceleration_from_torque"),
    "kg": ("mass",),
    "m": ("centre_of_mass", *PLACE),
    "m/s": VELOCITY,
    "kg m^2": ("inertia_tensor", "inertia_tensor_point", "moment_of_inertia", "principal_moments"),
    "kg m^2/s": [f"angular_momentum{part}" for part in ("", "_centre", "_rotation")],
    "N m": TORQUE,
    "J": [f"{kind}_energy" for kind in ("translational", "rotational", "kinetic", "potential")],
}
SQUARES = "({0}**2 + {1}**2 + {2}**2 + {3}**2)"
TURNS = {  # a vector v and numbers c and s: R = 1 + s C(v) + (1 - c) C(v)²
    "x": ("1", "0", "0", "cos({0})", "sin({0})"),
    "y": ("0", "1", "0", "cos({0})", "sin({0})"),
    "z": ("0", "0", "1", "cos({0})", "sin({0})"),
    "axis_angle": ("{0}", "{1}", "{2}", "cos({3})", "sin({3})"),
    "constant_turn": ("{0}", "{1}", "{2}", "{3}", "{4}"),
    "unit_quaternion": ("{1}", "{2}", "{3}", "-1", "2*{0}"),
    "quaternion": ("{1}", "{2}", "{3}", f"1 - 2/{SQUARES}", f"2*{{0}}/{SQUARES}"),
    "modified_rodrigues": (  # {0} is 1
        *("2*{1}", "2*{2}", "2*{3}"),
        *(f"1 - 2/{SQUARES}**2", f"2*(2 - {SQUARES})/{SQUARES}**2"),
    ),
}
Tree = tuple[Any, ...]
Exact = Any  # a whole number, a fraction or a Surd
Turn = tuple[Exact, Exact]  # a cosine and a sine


class Refused(ValueError):
    """What is printed is false, or the record contradicts itself."""


class Unreadable(ValueError):
    """An expression or a quantity that this program does not know; it is not proved."""


BROKEN = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, RecursionError)

# Expressions: sums, products, powers and functions of names and whole numbers, nothing else


@cache
def tree_of(text: str) -> Tree:
    """Nested tuples, such as ("*", ("number", 2), ("cos", ("name", "phi")))."""
    try:
        if not re.fullmatch(r"([A-Za-z]\w*+|\d++(?!\w)|[-+*/() ])*+", text, re.ASCII):
            raise SyntaxError  # for one, 0x1 is a number for Python, but reads as a product
        text = re.sub(r"\b[A-Za-z]\w*", r"\g<0>_", text.strip())  # so that no name is a keyword
        return _tree(ast.parse(text, mode="eval").body)
    except (SyntaxError, MemoryError, RecursionError) as error:
        raise Refused(f"the expression {text[:60]!r} cannot be read") from error


def _tree(node: ast.AST) -> Tree:
    match node:
        case ast.Name(id=name):
            return ("name", name[:-1])
        case ast.Constant(value=int(number)) if number < 10**MOST_DIGITS:
            return ("number", number)
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name[:-1] in (
            *ANGULAR,
            "sqrt",
        ):
            return (name[:-1], _tree(argument))
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return ("-", ("number", 0), _tree(operand))
        case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(power))) if (
            type(power) is int and 0 < power <= MOST_POWER
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


def texts_in(printed: Any) -> list[str]:
    """The texts of a scalar, a vector or a matrix."""
    if isinstance(printed, list):
        return [text for each in printed for text in texts_in(each)]
    return [printed]


# Exact numbers that change along a path, and matrices of them


class Surd:
    """Sums of roots, such as 1/2 + 3√2: fractions by the number n below the root.

    Every n is a product of different primes. Their roots are independent over the fractions, so
    a sum is zero only without terms.
    """

    def __init__(self, terms: Mapping[int, Fraction]) -> None:
        self.terms = {n: factor for n, factor in terms.items() if factor}

    def __add__(self, other: Exact) -> Surd:
        one, two = self.terms, terms_of(other)
        return Surd({n: one.get(n, 0) + two.get(n, Fraction(0)) for n in {**one, **two}})

    def __mul__(self, other: Exact) -> Surd:
        # √n √m = g √(nm/g²) with g = gcd(n, m), since n and m are products of different primes.
        products = [
            Surd({n * m // gcd(n, m) ** 2: one * two * gcd(n, m)})
            for n, one in self.terms.items()
            for m, two in terms_of(other).items()
        ]
        return reduce(add, products, Surd({}))

    __radd__, __rmul__ = __add__, __mul__

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __rtruediv__(self, one: Exact) -> Surd:
        """By conjugation: (a + b√p)(a - b√p) is free of √p."""
        roots = [n for n in self.terms if n > 1]
        if not roots:
            return Surd({1: 1 / self.terms[1]}) * one
        prime = next(p for p in range(2, roots[0] + 1) if roots[0] % p == 0)
        conjugate = Surd({n: -f if n % prime == 0 else f for n, f in self.terms.items()})
        return conjugate * (one / (self * conjugate))


def terms_of(number: Exact) -> Mapping[int, Fraction]:
    return number.terms if isinstance(number, Surd) else {1: Fraction(number)}


def root_of(number: int) -> Exact:
    """The positive root of a small whole number."""
    if not 0 < number <= 10**6:
        raise Unreadable(f"the root of {number}")
    whole = next(k for k in range(isqrt(number), 0, -1) if number % k**2 == 0)
    return Surd({number // whole**2: Fraction(whole)})


class Number:
    """c₀ + c₁ s + c₂ s², as far as it is known; most of these are zero."""

    def __init__(self, *parts: Exact) -> None:
        self.parts = parts

    def __add__(self, other: Number) -> Number:
        return Number(*map(add, self.parts, other.parts))  # the shorter one is what is known

    def __sub__(self, other: Number) -> Number:
        return self + other * MINUS

    def __mul__(self, other: Number) -> Number:
        one, two = self.parts, other.parts
        # The Cauchy product, broken off at the order to which both factors are known.
        pairs = (zip(one[: k + 1], two[k::-1], strict=True) for k in range(min(len(one), len(two))))
        return Number(*(sum(a * b for a, b in pair if a and b) for pair in pairs))

    def __truediv__(self, other: Number) -> Number:
        return self * other.inverse()

    def inverse(self) -> Number:
        if not self.parts[0]:
            raise Refused("a divisor is zero")
        # 1/(c + h) = 1/c − h/c² + h²/c³
        inverse = Fraction(1) / self.parts[0]
        return self.changed(inverse, -1 * inverse * inverse, inverse * inverse * inverse)

    def rate(self) -> Number:
        if len(self.parts) < 2:
            raise Unreadable("a derivative that is not known")
        return Number(*(k * part for k, part in enumerate(self.parts[1:], start=1)))

    def changed(self, value: Exact, slope: Exact, bend: Exact) -> Number:
        """f(c₀ + h) = f + f' h + f"/2 h², from f, f' and f"/2 at c₀."""
        first, second = self.parts[1:2], self.parts[2:]
        bent = (slope * part + bend * first[0] * first[0] for part in second)
        return Number(value, *(slope * part for part in first), *bent)


ZERO, ONE, MINUS, HALF = (Number(value, 0, 0) for value in (0, 1, -1, Fraction(1, 2)))


class Matrix:
    """Rows of numbers; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Iterable[Number]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))

    def __add__(self, other: Matrix) -> Matrix:
        pairs = zip(self.rows, other.rows, strict=True)
        return Matrix([one + two for one, two in zip(*pair, strict=True)] for pair in pairs)

    def __sub__(self, other: Matrix) -> Matrix:
        return self + other * MINUS

    def __mul__(self, other: Matrix | Number) -> Matrix:
        if isinstance(other, Number):
            return Matrix([entry * other for entry in row] for row in self.rows)
        columns = other.T.rows
        return Matrix([dot(row, column) for column in columns] for row in self.rows)

    def rate(self) -> Matrix:
        return Matrix(map(Number.rate, row) for row in self.rows)

    def hat(self) -> Matrix:
        """C(v) of a vector v, the operator v ×."""
        x, y, z = self.entries
        return Matrix([[ZERO, z * MINUS, y], [z, ZERO, x * MINUS], [y * MINUS, x, ZERO]])

    def vee(self) -> Matrix:
        """v of a skew matrix C(v)."""
        return Matrix([[self.rows[2][1]], [self.rows[0][2]], [self.rows[1][0]]])

    def determinant(self) -> Number:
        """By elimination; zero where a column has no pivot, which is all that its readers ask."""
        rows, product = self.rows, ONE
        if any(len(row) != len(rows) for row in rows):
            raise Refused("a matrix that is not square has no determinant")
        while rows:
            place = next((k for k, row in enumerate(rows) if row[0].parts[0]), None)
            if place is None:
                return ZERO
            # Moving row k to the top is k exchanges of neighbours, each with a change of sign. The
            # rows that remain hold the Schur complement of the pivot.
            pivot, *first = rows[place]
            product *= pivot * MINUS if place % 2 else pivot
            others = ((row[0] / pivot, row[1:]) for k, row in enumerate(rows) if k != place)
            rows = [[b - f * a for a, b in zip(first, rest, strict=True)] for f, rest in others]
        return product


def dot(row: Sequence[Number], column: Sequence[Number]) -> Number:
    return reduce(add, [one * two for one, two in zip(row, column, strict=True)])


IDENTITY = Matrix([[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]])

# What a record describes


def without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(dict(pairs)) < len(pairs):
        raise Refused(f"a name is there twice: {[key for key, _ in pairs]}"[:200])
    return dict(pairs)


def printed_in(content: Mapping[str, Any]) -> dict[str, Any]:
    """The printed expressions by their names."""
    printed = [(q["name"], q["expression"]) for q in content["quantities"]]
    printed += [("constant " + f["name"], f["expression"]) for f in content["first_integrals"]]
    if not all(re.fullmatch(r"[\w ]+", name, re.ASCII) for name, _ in printed):
        raise Refused("the name of a quantity is not plain ASCII")
    return without_twins(printed)


def turn_of(text: str) -> tuple[str, list[str]]:
    """What a turn such as "z(phi)" is about, and the five texts of TURNS."""
    kind, places = text.partition("(")[0], text.partition("(")[2][:-1].split(",")
    if not text.endswith(")") or kind not in TURNS:
        raise Refused(f"the turn {text!r}")
    if len(places) != len({*re.findall("{.}", " ".join(TURNS[kind]))}):
        raise Refused(f"the number of arguments of the turn {text!r}")
    for place in places:
        tree_of(place)  # each of them is an expression, and no piece of one
    return kind, [form.format(*(f"({place})" for place in places)) for form in TURNS[kind]]


class Record:
    """A description that does not contradict itself."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content, self.printed = content, printed_in(content)
        self.rotation, arguments = content["rotation"], content["arguments"]
        definitions = [(each["name"], each["expression"]) for each in content["definitions"]]
        components = [(g["name"], [c["name"] for c in g["components"]]) for g in arguments]
        self.definitions, groups = without_twins(definitions), without_twins(components)
        self.q, self.constants = groups["q"], groups.get("parameters", [])
        self.rates, self.seconds = ([q + end for q in self.q] for end in ("_dot", "_ddot"))
        self.momenta = [f"p_{q}" for q in self.q]
        of_motion = {"q_dot": self.rates, "q_ddot": self.seconds, "momenta": self.momenta}
        if any(groups.get(name, named) != named for name, named in of_motion.items()):
            raise Refused("rates and momenta are not named after the coordinates, in their order")
        own = [*self.q, *self.rates, *self.seconds, *self.constants, *self.definitions]
        self.others = {*self.momenta, *LETTERS, *(n for group in groups.values() for n in group)}
        for name in {*own, *self.others}:
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name, re.ASCII):
                raise Refused(f"the name {name!r} is not plain ASCII")
            if own.count(name) + (name in {*self.momenta, *LETTERS, *ANGULAR, "sqrt"}) > 1:
                raise Refused(f"the name {name!r} has two meanings")
        body = content.get("body", {})
        parameters = {parameter["name"] for parameter in body.get("parameters", ())}
        if (parameters | self.others).intersection(self.definitions):
            raise Refused("an argument or a parameter of the body is defined as well")
        about = {"inertia_tensor_point", "moment_of_inertia"}.intersection(self.printed)
        if about and "hamiltonian" in self.printed and {*self.momenta}.intersection(ABOUT):
            raise Refused("a momentum has the name of a place")
        self.turns = [turn_of(turn) for turn in self.rotation.get("turns", ())]
        self.refuse_words()
        self.spheres = [*map(self.sphere, self.rotation["conditions"])]
        without_twins([(name, "") for sphere in self.spheres for name in sphere])
        parts = [self.rotation, body, content.get("motion", {})]
        texts = [part[name] for part in parts for name in DESCRIBED if name in part]
        if any(names_in(tree_of(text)).intersection(self.definitions) for text in texts_in(texts)):
            raise Refused("what a record describes holds a name that it defines")
        texts += [*self.printed.values(), *self.definitions.values()]
        self.trees = [*map(tree_of, texts_in([*texts, *(forms for _, forms in self.turns)]))]
        self.refuse_degrees()

    def refuse_words(self) -> None:
        """Refuse words beside the expressions that would give a true claim another meaning."""
        name, presentation = self.content["name"], self.content["presentation"]
        if ("matrix" in self.rotation) == bool(self.turns):
            raise Refused("a rotation has either turns or a matrix")
        if presentation not in ("active", "passive"):
            raise Refused(f"the presentation {presentation!r}")
        if spelled := re.match("euler_([xyz]+)_(..)trinsic$", name):
            turns = [f"{axis}({q})" for axis, q in zip(spelled[1], self.q, strict=True)]
            if self.rotation.get("turns") != (turns[::-1] if spelled[2] == "ex" else turns):
                raise Refused(f"the turns are not those of {name}")
        components = [c for group in self.content["arguments"] for c in group["components"]]
        units = {component["name"]: component["unit"] for component in components}
        own = [c for c in components if c["name"] in {*self.q, *self.rates, *self.constants}]
        if any(units[component["name"]] != component["unit"] for component in own):
            raise Refused("a name has two units")
        unit_of = {name: unit for unit, names in UNITS.items() for name in names}
        things = [(q["name"], q["unit"]) for q in self.content["quantities"]]
        things += [(name, unit) for name, unit in units.items() if name not in self.constants]
        checks = [(n, u, unit_of.get(re.sub("_(space|body)$", "", n), u)) for n, u in things]
        for q, rate, second in zip(self.q, self.rates, self.seconds, strict=True):
            for name, unit in ((rate, f"{units[q] or '1'}/s"), (second, f"{units[q] or '1'}/s^2")):
                checks.append((name, units.get(name, unit), unit))
        for kind, (*_, sine) in self.turns:
            if kind in ("x", "y", "z", "axis_angle"):
                angles = names_in(tree_of(sine)).intersection({*self.q, *self.constants})
                checks += [(name, units[name], "rad") for name in angles]
        for name, unit, expected in checks:
            if unit != expected:
                raise Refused(f"{name} is in {unit!r}, not in {expected!r}")

    def sphere(self, condition: str) -> list[str]:
        """The names of a condition x² + y² + ... - 1, which has real solutions."""
        tree = tree_of(condition)
        if tree[0] != "-" or tree[2] != ("number", 1) or not self.vector(tree[1]):
            raise Unreadable(f"the condition {condition!r}, which is no sum of squares less 1")
        return self.vector(tree[1])

    def vector(self, tree: Tree) -> list[str]:
        """The names of x² + y² + ..., if all are coordinates or all are constant."""
        squares = [tree]
        while squares[0][0] == "+":
            squares[:1] = squares[0][1:]
        names = [square[1][1] for square in squares if square[0] == "**" and square[2] == 2]
        is_alike = {*names} <= {*self.q} or {*names} <= {*self.constants}
        return names if is_alike and 1 < len({*names}) == len(squares) else []

    def refuse_degrees(self) -> None:
        """Refuse too large expressions and too small parts of angles."""

        @cache
        def degrees(tree: Tree) -> tuple[int, int]:
            """Of numerator and denominator; numbers count, since their digits do."""
            kind, *parts = tree
            if kind == "name" and parts[0] in self.definitions:
                return degrees(tree_of(self.definitions[parts[0]]))
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

        of_turns = sum(max(degrees(tree_of(form))) for _, forms in self.turns for form in forms)
        if max(of_turns, *(max(degrees(tree)) for tree in self.trees)) > MOST_DEGREE:
            raise Refused("the degree of an expression is too large")
        parts = [part for tree in self.trees for part in parts_of(tree)]
        numbers = {part[1] for part in parts if part[0] == "sqrt" and part[1][0] == "number"}
        if len(numbers) > MOST_ROOTS:  # whose products are as many as the subsets of their primes
            raise Refused(f"there are roots of more than {MOST_ROOTS} different numbers")
        angles = {part[1] for part in parts if part[0] in ANGULAR}
        divided = [part for angle in angles for part in parts_of(angle) if part[0] == "/"]
        self.parts = lcm(*(part[2][1] for part in divided if part[2][0] == "number"))
        if not 0 < self.parts <= MOST_PARTS:
            raise Refused(f"an angle is divided by {self.parts}")


class Point:
    """Random values for the names of a record, such that its conditions hold.

    Coordinates are drawn with their rates and accelerations. The length of a vector is drawn, and
    its components follow. Other roots of names have no value, since √(x²) is x or -x.
    """

    def __init__(self, record: Record) -> None:
        self.record, self.trees = record, dict[Tree, Number]()
        self.circles, self.lengths = dict[str, int](), dict[frozenset[str], int]()
        self.values = {name: Number(drawn()) for name in record.others}
        self.values |= {q: Number(drawn(), drawn(), drawn()) for q in record.q}
        self.values |= {name: Number(drawn(), 0, 0) for name in [*record.constants, "pi"]}
        roots = (part[1] for tree in record.trees for part in parts_of(tree) if part[0] == "sqrt")
        for group in [*record.spheres, *filter(None, map(record.vector, roots))]:
            if all(vector.isdisjoint(group) for vector in self.lengths):
                length = ONE if group in record.spheres else self.values[group[0]]
                self.lengths[frozenset(group)] = length.parts[0]
                # (1 - u², 2 u)/(1 + u²) is a unit vector, by stereographic projection
                u = [self.values[name] for name in group[1:]]
                scale = length / (ONE + dot(u, u))
                vector = [(ONE - dot(u, u)) * scale, *((each + each) * scale for each in u)]
                self.values |= zip(group, vector, strict=True)
        for q, rate, second in zip(record.q, record.rates, record.seconds, strict=True):
            self.values |= {rate: self.values[q].rate(), second: self.values[q].rate().rate()}

    def having(self, values: Mapping[str, Number]) -> Point:
        """The same point, with other values or fewer names."""
        other = copy(self)
        other.values, other.trees = {**values}, {}
        return other

    def only(self, *names: str) -> Point:
        """Without other names than constants and these."""
        names = *names, *self.record.constants, "pi"
        return self.having({name: self.values[name] for name in names})

    def still(self) -> Point:
        """Without what follows from rates, which is faster."""
        return self.having({name: Number(each.parts[0]) for name, each in self.values.items()})

    def along(self, q: str) -> Point:
        """Where one coordinate changes at the rate 1, and nothing else changes."""
        values = self.values.items()
        return self.having({name: Number(v.parts[0], int(name == q)) for name, v in values})

    def read(self, printed: Any) -> Matrix:
        """A scalar, the column of a vector, or a matrix."""
        rows = printed if isinstance(printed, list) else [printed]
        texts = [row if isinstance(row, list) else [row] for row in rows]
        return Matrix([self.value(tree_of(text)) for text in row] for row in texts)

    def value(self, tree: Tree) -> Number:
        if tree not in self.trees:
            self.trees[tree] = self.worked_out(*tree)
        return self.trees[tree]

    def worked_out(self, kind: str, *parts: Any) -> Number:
        if kind == "number":
            return Number(parts[0], 0, 0)
        if kind == "name" and parts[0] in self.record.definitions:
            return self.value(tree_of(self.record.definitions[parts[0]]))
        if kind == "name":
            if parts[0] not in self.values:
                raise Refused(f"{parts[0]} must not be in an expression")
            return self.values[parts[0]]
        if kind == "sqrt":
            return self.root(parts[0])
        if kind in ANGULAR:
            cosine, sine = self.turn(parts[0])
            values = {"cos": (cosine, ONE), "sin": (sine, ONE), "tan": (sine, cosine)}
            return truediv(*values.get(kind, (cosine, sine)))
        if kind == "**":
            return reduce(mul, [self.value(parts[0])] * parts[1], ONE)
        operation = {"+": add, "-": sub, "*": mul, "/": truediv}[kind]
        return operation(*map(self.value, parts))

    def root(self, tree: Tree) -> Number:
        """The positive root of a whole number, or the length of a vector."""
        if tree[0] == "number":
            return Number(root_of(tree[1]), 0, 0)
        length = self.lengths.get(frozenset(self.record.vector(tree)))
        if length is None:
            raise Unreadable("a root that may be of either sign")
        # √(l² + h) = l + h/(2 l) − h²/(8 l³)
        slope = Fraction(1, 2 * length)
        return self.value(tree).changed(length, slope, -(slope**3))

    def turn(self, angle: Tree) -> tuple[Number, Number]:
        """The cosine and the sine of an angle."""
        # cos(a + h) = cos a − h sin a − h²/2 cos a, and sin(a + h) = sin a + h cos a − h²/2 sin a
        value, (cosine, sine) = self.value(angle), self.circle(angle, Fraction(self.record.parts))
        cosines = value.changed(cosine, -sine, -cosine / 2)
        return cosines, value.changed(sine, cosine, -sine / 2)

    def circle(self, angle: Tree, count: Fraction) -> Turn:
        """The cosine and the sine of so many parts of an angle, in numbers drawn for a part."""
        match angle:
            case ("+" | "-" as sign, one, two):
                other = self.circle(two, count if sign == "+" else -count)
                return sum_of_turns(self.circle(one, count), other)
            case ("*", ("number", number), part) | ("*", part, ("number", number)):
                return self.circle(part, count * number)
            case ("/", part, ("number", number)):
                return self.circle(part, count / number)
            case ("number", number):
                name, count = "", count * number
            case ("name", name) if name in (*self.record.q, *self.record.constants):
                pass
            case ("sqrt", squares) if frozenset(self.record.vector(squares)) in self.lengths:
                name = " ".join(sorted(self.record.vector(squares)))
            case _:
                raise Unreadable("an angle that may be a multiple of another one")
        if count.denominator > 1 or abs(count) > MOST_PARTS:
            raise Unreadable("too large a multiple of an angle")
        # The drawn t is the tangent of half of the smallest part. The addition theorems give the
        # cosine and the sine of its multiples, so that angles that depend on one another agree.
        t = self.circles.setdefault(name, drawn())
        part = Fraction(1 - t**2, 1 + t**2), Fraction(2 * t if count > 0 else -2 * t, 1 + t**2)
        return reduce(sum_of_turns, [part] * abs(int(count)), (Fraction(1), Fraction(0)))


def drawn() -> int:
    """Above 0, since the lengths of vectors are."""
    return SystemRandom().randrange(1, 2**BITS)


def sum_of_turns(one: Turn, two: Turn) -> Turn:
    """The cosine and the sine of a sum."""
    return one[0] * two[0] - one[1] * two[1], one[1] * two[0] + one[0] * two[1]


# What is claimed: each quantity from its definition


def spin(R: Matrix) -> dict[str, Matrix]:
    """Ω of C(Ω) = dR/dt Rᵀ, and Ω' of C(Ω') = Rᵀ dR/dt."""
    return {"space": (R.rate() * R.T).vee(), "body": (R.T * R.rate()).vee()}


class Motion:
    """A rotation, its body and what moves it, at a point.

    A printed x is one of the `values`, or solves A x = B of `equations`, or has one of the `rates`.
    What could hide a false term in other names is read at one of the `points`, without these names.
    """

    def __init__(self, record: Record) -> None:
        self.record, self.content, self.point = record, record.content, Point(record)
        self.still, self.lack = self.point.still(), "it has no definition here"
        self.factors = [*self.factors_at(self.point)]
        R = self.R = reduce(mul, self.factors)
        omega = self.omega = spin(R)
        # Ω = W q̇ is linear in the rates: column k of W is Ω for the rate 1 of q_k, and 0 of the
        # others.
        spins = [spin(reduce(mul, self.factors_at(self.point.along(q)))) for q in record.q]
        W = self.W = {frame: Matrix(spin[frame].entries for spin in spins).T for frame in OMEGA}
        shown = R.T if self.content["presentation"] == "passive" else R
        self.values = {
            "rotation_matrix": shown,
            "rotation_rate": shown.rate(),
            "spin_matrix": shown.rate() * shown.T,
            "angular_velocity_space": omega["space"],
            "angular_velocity_body": omega["body"],
            "angular_acceleration_space": omega["space"].rate(),
            "angular_acceleration_body": omega["body"].rate(),
        }
        self.equations, self.rates = dict[str, tuple[Matrix, Matrix]](), dict[str, Matrix]()
        self.position = self.still.only(*record.q)
        self.points = dict.fromkeys(PRINCIPAL, self.still.only())
        spheres = [sphere for sphere in record.spheres if sphere[0] in record.q]
        radii = [[q if q in sphere else "0" for q in record.q] for sphere in spheres]
        self.is_free = not radii
        one = Matrix([*IDENTITY.rows, *([ZERO] * 3 for _ in radii)])
        for frame, letters in OMEGA.items():  # rates along a radius would break a condition
            A = Matrix([*W[frame].rows, *self.still.read(radii).rows])
            inverse, rates = f"inverse_rate_matrix_{frame}", f"rates_from_angular_velocity_{frame}"
            self.equations |= {inverse: (A, one), rates: (A, one * self.still.read(letters))}
            self.points |= dict.fromkeys((inverse, f"rate_matrix_{frame}"), self.position)
            self.points[rates] = self.still.only(*record.q, *letters)

    def factors_at(self, point: Point) -> Iterator[Matrix]:
        """The turns whose product R is, or R itself."""
        if "matrix" in self.record.rotation:
            yield point.read(self.record.rotation["matrix"])
        for _, texts in self.record.turns:
            *axis, cosine, sine = point.read(texts).entries
            # Rodrigues' formula R = 1 + s C(v) + (1 − c) C(v)²; whether R is a rotation is tested
            # separately, since v and the numbers c and s come from the record.
            operator = Matrix([part] for part in axis).hat()
            yield IDENTITY + operator * sine + operator * operator * (ONE - cosine)

    def read_body(self) -> None:
        """Tensors, energies and momenta."""
        parts = (self.content["body"][part] for part in ("mass", "centre", "inertia"))
        mass, centre, inertia = map(self.point.only().read, parts)
        agree("the inertia tensor is not symmetric", [(inertia, inertia.T)])
        if "motion" in self.content:  # about the fixed point, from which places are counted
            agree("the centre of a body that turns about a fixed point", [(centre, centre * ZERO)])
        R, omega = self.R, self.omega["body"]
        momentum, energy = inertia * omega, omega.T * inertia * omega * HALF
        place, velocity, axis, about = map(self.still.read, (PLACE, VELOCITY, AXIS, ABOUT))
        momentum_of_centre = place.hat() * velocity * mass
        translational = velocity.T * velocity * mass * HALF
        arm = (about - centre).hat()
        tensor = inertia + arm.T * arm * mass.entries[0]  # by the parallel-axis theorem
        self.values |= {
            "mass": mass,
            "centre_of_mass": centre,
            "inertia_tensor": inertia,
            "inertia_tensor_space": R * inertia * R.T,
            "inertia_tensor_point": tensor,
            "moment_of_inertia": axis.T * tensor * axis,
            "translational_energy": translational,
            "rotational_energy": energy,
            "kinetic_energy": translational + energy,
            "angular_momentum_centre": momentum_of_centre,
            "angular_momentum_rotation_body": momentum,
            "angular_momentum_rotation": R * momentum,
            "angular_momentum": momentum_of_centre + R * momentum,
        }
        free, torque = map(self.still.read, (OMEGA["body"], TORQUE))
        equation = inertia, torque - free.hat() * inertia * free
        self.equations["angular_acceleration_from_torque"] = equation
        if "motion" in self.content:
            self.read_motion(self.content["motion"], inertia, momentum, energy)

    def read_motion(
        self, motion: Mapping[str, Any], inertia: Matrix, momentum: Matrix, energy: Matrix
    ) -> None:
        """d'Alembert's principle: M q̈ + h = W'ᵀ (dL'/dt + Ω' × L') + ∂V/∂q = Q."""
        if not self.is_free:
            raise Unreadable("coordinates depend on one another")
        q, rates, W = self.record.q, self.record.rates, self.W["body"]
        causes = (motion["forces"], motion["torque"])
        forces, torque = map(self.still.only(*q, *rates).read, causes)
        potential = self.position.read(motion["potential"])
        courses = map(self.point.only(*q).along, q)
        slopes = [course.read(motion["potential"]).rate().entries for course in courses]
        # In the body, the rate of L in space components is dL′/dt + Ω′ × L′.
        turning = momentum.rate() + self.omega["body"].hat() * momentum
        inertial = W.T * turning + Matrix(slopes)
        mass_matrix, momenta = W.T * inertia * W, W.T * momentum
        # The inertial forces are M q̈ + h at the drawn q̈; h is what remains without M q̈.
        bias = inertial - mass_matrix * self.still.read(self.record.seconds)
        self.values |= {
            "potential_energy": potential,
            "lagrangian": energy - potential,
            "energy": energy + potential,
            "hamiltonian": energy + potential,
            "generalised_momenta": momenta,
            "mass_matrix": mass_matrix,
            "bias_vector": bias,
        }
        # H(q, p) = E for p = M q̇, and so for all p
        values = dict(zip(self.record.momenta, momenta.entries, strict=True))
        self.points["hamiltonian"] = self.position.having(self.position.values | values)
        forces += W.T * torque
        self.equations["accelerations"] = mass_matrix, forces - bias
        # A constant has a rate that vanishes along every motion: that of a cyclic momentum is a row
        # of the balance, and dE/dt = q̇·balance.
        balance = inertial - forces  # zero along a motion
        self.rates = {
            f"constant momentum_{n}": Matrix([r]) for n, r in zip(q, balance.rows, strict=True)
        }
        self.rates["constant energy"] = self.still.read([rates]) * balance
        self.points |= dict.fromkeys(self.rates, self.point)

    def claims(self, name: str) -> Iterator[tuple[Matrix, Matrix]]:
        """Pairs of matrices that are equal if what is printed as `name` is right."""
        x = self.points.get(name, self.still).read(self.record.printed[name])
        kind, _, frame = name.rpartition("_")
        if name == "hamiltonian" and name in self.values:
            self.values["mass_matrix"].determinant().inverse()  # which refuses a singular M
        if name in self.values:
            yield x, self.values[name]
        elif name in self.rates:
            yield x.rate(), self.rates[name]
        elif name in self.equations:
            A, B = self.equations[name]
            if len(A.rows) == len(A.T.rows):
                A.determinant().inverse()  # which refuses a singular A
            yield A * x, B
        elif kind == "rate_matrix" and frame in OMEGA:
            # x holds no rates, and q̇ is random: x q̇ = Ω then holds for all q̇, and x = W.
            yield x * self.still.read(self.record.rates), self.omega[frame]
        elif name in PRINCIPAL and "inertia_tensor" in self.values:
            printed = (self.record.printed[each] for each in PRINCIPAL)
            axes, moments = map(self.points[name].read, printed)
            yield axes * axes.T, IDENTITY
            yield Matrix([[axes.determinant()]]), Matrix([[ONE]])
            pairs = [zip(row, moments.entries, strict=True) for row in axes.rows]
            # With A = (e₁ e₂ e₃) in SO(3), I A = A diag(I₁, I₂, I₃) says that the columns are
            # eigenvectors.
            scaled = Matrix([one * two for one, two in pair] for pair in pairs)
            yield self.values["inertia_tensor"] * axes, scaled
        else:
            raise Unreadable(self.lack)


def agree(name: str, pairs: Iterable[tuple[Matrix, Matrix]]) -> None:
    for one, two in pairs:
        for k, difference in enumerate((one - two).entries, start=1):
            if difference.parts[0]:
                raise Refused(f"{name}: entry {k} is false at a real point")


def verify(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """The names of what is proved, and of what is not, with the reasons.

    Raises one of BROKEN for a record of which something is false.
    """
    try:
        motion = Motion(Record(content))
    except Unreadable as error:
        return [], dict.fromkeys(printed_in(content), str(error))
    for turn in motion.factors:
        agree(ROTATION, [(turn * turn.T, IDENTITY)])
        agree(ROTATION, [(Matrix([[turn.determinant()]]), Matrix([[ONE]]))])
    proved, reasons = [ROTATION], dict[str, str]()
    try:
        if "body" in content:
            motion.read_body()
    except Unreadable as error:
        motion.lack = str(error)
    for name in printed_in(content):
        try:
            agree(name, motion.claims(name))
            proved.append(name)
        except (Unreadable, RecursionError) as error:
            reasons[name] = str(error)
    return proved, reasons


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text, object_pairs_hook=without_twins, parse_float=str, parse_constant=str)


if __name__ == "__main__":
    status = count = 0
    places = [Path(argument) for argument in sys.argv[1:]]
    files = [[*place.rglob("*.json")] if place.is_dir() else [place] for place in places]
    for path in sorted(path for each in files for path in each):
        try:
            record = load(path)
            is_record = isinstance(record, dict) and record.get("schema") == "rigidsym.derivation"
            if not is_record and path not in places:
                continue
            count += 1
            if not is_record:
                raise Refused("not the record of a derivation")
            proved, reasons = verify(record)
            print(f"{path}: R is {record['rotation']}")
            print(f"  proved: {', '.join(proved) or 'nothing'}")
            for name, reason in reasons.items():
                print(f"  not proved: {name}, since {reason}")
        except (*BROKEN, OSError) as error:
            status = 1
            print(f"{path}: REFUSED: {error}")
    if not count:
        print("REFUSED: there is no record of a derivation here")
    sys.exit(status or int(not count))
