"""Checks records of rigidsym without rigidsym: `python checker.py FOLDER|RECORD...`

A record NAME.json describes a rotation, perhaps with a body and a potential, and prints
expressions. This program works out the same quantities from their definitions, and compares. It
believes nothing but the description.

Every number is worked out at six random points. Five are real, with 60 digits: what is false there,
or divides by zero, is refused. One is rational, where a cosine is (1 - t²)/(1 + t²) and the sine is
2t/(1 + t²). Both sides of an identity are fractions of polynomials in the numbers that are drawn.
Two different ones, of degree d, agree by chance at most d times in 2⁹⁶ if each number is one of 2⁹⁶
(the lemma of Schwartz and Zippel). The degree is counted, and at most 10⁹; so of 10¹⁹ runs at most
one accepts a false identity, and no forger can choose the point. Cofactors would say no more.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cache, partial, reduce
from itertools import chain
from operator import add, mul, sub, truediv
from pathlib import Path
from random import SystemRandom
from typing import Any

PLACES, DIGITS, CLOSE, SMALL = 5, 60, Decimal("1e-30"), Decimal("1e-40")
BITS, MOST_DEGREE, MOST_BITS, MOST_POWER, MOST_DIGITS, MOST_TURNS = 96, 10**9, 10**5, 60, 40, 12
PI = Decimal("3.1415926535897932384626433832795028841971693993751058209749446")
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
OPERATIONS = {"+": add, "-": sub, "*": mul, "/": truediv}
OMEGA = {frame: [f"omega_{frame}_{k}" for k in (1, 2, 3)] for frame in ("space", "body")}
ROTATION, PRINCIPAL = "R is a rotation", ("principal_axes", "principal_moments")
FUNCTIONS = "cos", "sin", "tan", "cot"
LETTERS = {  # arguments besides coordinates and their rates, with their units
    "omega_space": (OMEGA["space"], "rad/s"),
    "omega_body": (OMEGA["body"], "rad/s"),
    "centre": (["X", "Y", "Z"], "m"),
    "centre_dot": (["X_dot", "Y_dot", "Z_dot"], "m/s"),
    "point": (["p_x", "p_y", "p_z"], "m"),
    "direction": (["n_x", "n_y", "n_z"], ""),
    "torque": (["torque_1", "torque_2", "torque_3"], "N m"),
}
UNITS = {  # of quantities, by their names
    "rotation_matrix|principal_axes": "",
    "rotation_rate": "1/s",
    "spin_matrix|angular_velocity_.*": "rad/s",
    "angular_acceleration_.*": "rad/s^2",
    "mass": "kg",
    "centre_of_mass": "m",
    "inertia_tensor.*|moment_of_inertia|principal_moments": "kg m^2",
    "angular_momentum.*": "kg m^2/s",
    ".*energy|lagrangian|hamiltonian": "J",
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
Values = tuple[Any, ...]  # of a tree: its degree, its exact value, and five decimals


class Refused(ValueError):
    """What is printed is false, or the record contradicts itself."""


class Unproved(ValueError):
    """An expression or a quantity that this program does not know."""


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
        case ast.Name(name):
            return ("name", name[:-1])
        case ast.Constant(int(number)) if number < 10**MOST_DIGITS:
            return ("number", number)
        case ast.Call(ast.Name("tan_"), [angle], []):
            return ("/", ("sin", _tree(angle)), ("cos", _tree(angle)))
        case ast.Call(ast.Name("cot_"), [angle], []):
            return ("/", ("cos", _tree(angle)), ("sin", _tree(angle)))
        case ast.Call(ast.Name("cos_" | "sin_" as name), [angle], []):
            return (name[:-1], _tree(angle))
        case ast.Call(ast.Name("sqrt_"), [_], []):
            raise Unproved("a root")
        case ast.UnaryOp(ast.USub(), operand):
            return ("-", ZERO, _tree(operand))
        case ast.BinOp(base, ast.Pow(), ast.Constant(int(n))) if 0 < n <= MOST_POWER:
            return ("**", _tree(base), n)
        case ast.BinOp(one, operator, two) if type(operator) in OPERATORS:
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


ZERO, ONE, TWO, MINUS = (("number", n) for n in (0, 1, 2, -1))
HALF = ("/", ONE, TWO)


def plus(one: Tree, two: Tree) -> Tree:
    return two if one == ZERO else one if two == ZERO else ("+", one, two)


def times(one: Tree, two: Tree) -> Tree:
    if ZERO in (one, two):
        return ZERO
    return two if one == ONE else one if two == ONE else ("*", one, two)


def once(function: Callable[[Tree], Any]) -> Callable[[Tree], Any]:
    """A function that is worked out once a tree, which is kept, so that its id stays its own."""
    results = dict[int, tuple[Tree, Any]]()

    def remembered(tree: Tree) -> Any:
        if id(tree) not in results:
            results[id(tree)] = tree, function(tree)
        return results[id(tree)][1]

    return remembered


def derivative(rates: Mapping[str, Tree]) -> Callable[[Tree], Tree]:
    """The derivative of trees, from those of names; all other names are constant."""

    @once
    def rate(tree: Tree) -> Tree:
        match tree:
            case ("name", name):
                return rates.get(name, ZERO)
            case ("+", one, two):
                return plus(rate(one), rate(two))
            case ("-", one, two):
                return plus(rate(one), times(MINUS, rate(two)))
            case ("*", one, two):
                return plus(times(rate(one), two), times(one, rate(two)))
            case ("/", one, two):
                return times(plus(rate(one), times(MINUS, times(tree, rate(two)))), ("/", ONE, two))
            case ("**", base, n):
                return times(times(("number", n), rate(base)), ("/", tree, base))
            case ("cos", angle):
                return times(times(MINUS, rate(angle)), ("sin", angle))
            case ("sin", angle):
                return times(rate(angle), ("cos", angle))
        return ZERO

    return rate


class Matrix:
    """Rows of trees; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Iterable[Tree]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))

    def __add__(self, other: Matrix) -> Matrix:
        return Matrix(map(plus, *pair) for pair in zip(self.rows, other.rows, strict=True))

    def __sub__(self, other: Matrix) -> Matrix:
        return self + other.times(MINUS)

    def __mul__(self, other: Matrix) -> Matrix:
        if len(self.entries) == 1 and len(other.rows) > 1:  # a scalar
            return other.times(self.entries[0])
        columns = other.T.rows
        return Matrix([reduce(plus, map(times, row, c)) for c in columns] for row in self.rows)

    def times(self, factor: Tree) -> Matrix:
        return self.each(lambda entry: times(factor, entry))

    def each(self, function: Callable[[Tree], Tree]) -> Matrix:
        return Matrix(map(function, row) for row in self.rows)

    def hat(self) -> Matrix:
        """C(v) of a vector v, the operator v ×."""
        ((x,), (y,), (z,)), (a, b, c) = self.rows, self.times(MINUS).entries
        return Matrix([[ZERO, c, y], [z, ZERO, a], [b, x, ZERO]])

    def vee(self) -> Matrix:
        """v of a skew matrix C(v)."""
        return Matrix([[self.rows[2][1]], [self.rows[0][2]], [self.rows[1][0]]])

    def diagonal(self) -> Matrix:
        """The matrix with the entries of a vector on its diagonal."""
        return Matrix(
            [
                [e if j == k else ZERO for j in range(len(self.rows))]
                for k, e in enumerate(self.entries)
            ]
        )

    def determinant(self) -> Tree:
        """By the first column and its minors; 1 without rows."""
        total = ZERO if self.rows else ONE
        for row in reversed(self.rows):
            minor = Matrix(other[1:] for other in self.rows if other is not row)
            total = plus(times(row[0], minor.determinant()), times(MINUS, total))
        return total


def matrix_of(printed: Any) -> Matrix:
    """A scalar, the column of a vector, or a matrix."""
    rows = printed if isinstance(printed, list) else [printed]
    return Matrix(map(tree_of, row if isinstance(row, list) else [row]) for row in rows)


def column(names: Iterable[str]) -> Matrix:
    return Matrix([("name", name)] for name in names)


IDENTITY = Matrix([[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]])

# What a record describes


def without_twins(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    pairs = [*pairs]
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
    count = len({*re.findall("{.}", " ".join(TURNS.get(kind, ())))})
    if not text.endswith(")") or len(places) != count:
        raise Refused(f"the turn {text!r}")
    for place in places:
        tree_of(place)  # each of them is an expression, and no piece of one
    return kind, [form.format(*(f"({place})" for place in places)) for form in TURNS[kind]]


class Record:
    """A description that does not contradict itself."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content, self.printed = content, printed_in(content)
        self.rotation, self.turns = content["rotation"], content["rotation"].get("turns", ())
        if ("matrix" in self.rotation) == bool(self.turns):
            raise Refused("a rotation has either turns or a matrix")
        definitions = ((each["name"], each["expression"]) for each in content["definitions"])
        self.definitions = without_twins(definitions)
        groups = without_twins((g["name"], g["components"]) for g in content["arguments"])
        names = {group: [c["name"] for c in components] for group, components in groups.items()}
        self.q, self.constants = names["q"], names.get("parameters", [])
        self.rates, self.seconds = ([q + end for q in self.q] for end in ("_dot", "_ddot"))
        self.momenta = [f"p_{q}" for q in self.q]
        letters = {group: letters for group, (letters, _) in LETTERS.items()}
        letters |= {"q_dot": self.rates, "q_ddot": self.seconds, "momenta": self.momenta}
        if any(names.get(group, own) != own for group, own in letters.items()):
            raise Refused("arguments do not have the names that belong to them")
        self.letters = {*chain(*letters.values())}
        own = [*self.q, *self.constants, *self.definitions]
        without_twins((name, "") for name in (*own, *self.letters, *FUNCTIONS, "sqrt", "pi"))
        if not all(re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name, re.ASCII) for name in own):
            raise Refused("a name is not plain ASCII")
        self.spheres = [*map(self.sphere, self.rotation["conditions"])]
        without_twins((name, "") for sphere in self.spheres for name in sphere)
        self.described = list[Matrix]()
        self.factors = [self.turn(turn_of(turn)[1]) for turn in self.turns]
        self.factors = self.factors or [self.describe(self.rotation["matrix"], *self.q)]
        self.R = reduce(mul, self.factors)
        self.refuse_words([*chain(*groups.values())])

    def refuse_words(self, components: Sequence[Mapping[str, str]]) -> None:
        """Refuse words beside the expressions that would give a true claim another meaning."""
        name, presentation = self.content["name"], self.content["presentation"]
        if presentation not in ("active", "passive"):
            raise Refused(f"the presentation {presentation!r}")
        if spelled := re.match("euler_([xyz]+)_(..)trinsic$", name):
            turns = [f"{axis}({q})" for axis, q in zip(spelled[1], self.q, strict=True)]
            if [*self.turns] != (turns[::-1] if spelled[2] == "ex" else turns):
                raise Refused(f"the turns are not those of {name}")
        units = {c["name"]: c["unit"] for c in components}
        expected = {letter: unit for letters, unit in LETTERS.values() for letter in letters}
        for q, rate, second in zip(self.q, self.rates, self.seconds, strict=True):
            expected |= {rate: f"{units[q] or '1'}/s", second: f"{units[q] or '1'}/s^2"}
        trees = [part for R in self.factors for e in R.entries for part in parts_of(e)]
        angles = chain(*(multiples(part[1], 1) for part in trees if part[0] in ("cos", "sin")))
        expected |= dict.fromkeys(self.q, "") | {name: "rad" for name, _ in angles}
        for name, unit in [(c["name"], c["unit"]) for c in components]:
            if unit != expected.setdefault(name, unit) or name in self.definitions:
                raise Refused(f"{name} is in {unit!r}, not in {expected[name]!r}, or is defined")
        for name, unit in [(q["name"], q["unit"]) for q in self.content["quantities"]]:
            if any(re.fullmatch(of, name) and unit != expected for of, expected in UNITS.items()):
                raise Refused(f"{name} is in {unit!r}")

    def sphere(self, condition: str) -> list[str]:
        """The names of a condition x**2 + y**2 + ... - 1, which has real solutions."""
        names = re.findall(r"\w+(?=\*\*2)", condition)
        is_sum = condition == " + ".join(f"{name}**2" for name in names) + " - 1"
        is_alike = {*names} <= {*self.q} or {*names} <= {*self.constants}
        if not is_sum or not is_alike or len(names) < 2:
            raise Unproved(f"the condition {condition!r}, which is no sum of squares less 1")
        return names

    def letters_in(self, tree: Tree) -> set[str]:
        """The names in a tree, and in the definitions of these."""
        names = names_in(tree)
        defined = names.intersection(self.definitions)
        trees = (tree_of(self.definitions[name]) for name in defined)
        return (names - defined).union(*map(self.letters_in, trees))

    def describe(self, printed: Any, *names: str) -> Matrix:
        """What holds no other names than constants and these."""
        self.described.append(matrix_of(printed))
        self.refuse_others(set().union(*map(names_in, self.described[-1].entries)), names)
        return self.described[-1]

    def refuse_others(self, inside: set[str], names: Iterable[str]) -> None:
        if others := inside.difference(names, self.constants, ["pi"]):
            raise Refused(f"{min(others)} must not be in an expression")

    def turn(self, forms: Sequence[str]) -> Matrix:
        """Rodrigues' formula R = 1 + s C(v) + (1 − c) C(v)²; whether R is a rotation is tested."""
        *axis, cosine, sine = self.describe([[*forms]], *self.q).entries
        operator = Matrix([part] for part in axis).hat()
        return IDENTITY + operator.times(sine) + (operator * operator).times(("-", ONE, cosine))


# Values of trees


def drawn(name: str, least: int = -3) -> Values:
    random, scale = SystemRandom(), 10**DIGITS
    reals = [Decimal(random.randrange(least * scale, 3 * scale)) / scale for _ in range(PLACES)]
    return (1, Fraction(random.randrange(1, 2**BITS)), *([PI] * PLACES if name == "pi" else reals))


def combined(operation: Callable[[Any, Any], Any], one: Values, two: Values) -> Values:
    if operation is truediv and (not two[1] or min(map(abs, two[2:])) < SMALL):
        raise Refused("a divisor is zero")
    degree, exact = one[0] + two[0], operation(one[1], two[1])
    if degree > MOST_DEGREE or max(abs(exact.numerator), exact.denominator) >> MOST_BITS:
        raise Unproved("too large an expression")
    return (degree, exact, *map(operation, one[2:], two[2:]))


def circle_of(angle: Decimal) -> tuple[Decimal, Decimal]:
    """The cosine and the sine, by their series."""
    sums, term, k = [Decimal(0)] * 4, Decimal(1), 0
    while abs(term) > Decimal(10) ** -DIGITS:
        sums[k % 4] += term
        k += 1
        term *= angle / k
    return sums[0] - sums[2], sums[1] - sums[3]


def multiples(angle: Tree, count: int) -> Iterator[tuple[str, int]]:
    """The names in a sum of whole multiples, and how often each is in it."""
    match angle:
        case ("+" | "-" as sign, one, two):
            yield from multiples(one, count)
            yield from multiples(two, count if sign == "+" else -count)
        case ("*", ("number", number), part):
            yield from multiples(part, count * number)
        case ("name", name) if abs(count) <= MOST_TURNS:
            yield name, count
        case ("number", number) if abs(count * number) <= MOST_TURNS:
            yield "1", count * number
        case _:
            raise Unproved("an angle that may be a multiple of another one")


class Point:
    """Random values for the names of a record, such that its conditions hold."""

    def __init__(self, record: Record) -> None:
        self.value, self.circle = once(self.worked_out), cache(self.circle_at)
        self.drawn, self.record = cache(drawn), record
        self.names = {*record.q, *record.letters, *record.constants, "pi"}
        self.trees = {name: tree_of(text) for name, text in record.definitions.items()}
        for sphere in record.spheres:
            self.trees |= {name: tree for name, tree in on_sphere(sphere) if name in self.names}

    def worked_out(self, tree: Tree) -> Values:
        match tree:
            case ("number", number):
                return (1, Fraction(number), *[Decimal(number)] * PLACES)
            case ("name", name) if name in self.trees:
                return self.value(self.trees[name])
            case ("name", name) if name in self.names or " " in name:
                return self.drawn(name, 0 if name in self.record.constants else -3)
            case ("name", name):
                raise Refused(f"{name} must not be in an expression")
            case ("**", base, power):
                return reduce(partial(combined, mul), [self.value(base)] * power)
            case ("cos" | "sin" as function, angle):
                return self.circle(angle)[function == "sin"]
        operation, one, two = tree
        return combined(OPERATIONS[operation], self.value(one), self.value(two))

    def circle_at(self, angle: Tree) -> tuple[Values, Values]:
        """The cosine and the sine of an angle, exact ones by the theorems of addition."""
        (cosine, sine), degree = (Fraction(1), Fraction(0)), 1
        for name, count in multiples(angle, 1):
            if name not in ("1", *self.record.q, *self.record.constants):
                raise Unproved(f"an angle that holds {name}")
            t = self.drawn(f"half of {name}")[1]
            c, s = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2) * (1 if count > 0 else -1)
            for _ in range(abs(count)):
                cosine, sine, degree = cosine * c - sine * s, cosine * s + sine * c, degree + 2
        reals = zip(*map(circle_of, self.value(angle)[2:]), strict=True)
        return (degree, cosine, *next(reals)), (degree, sine, *next(reals))


def on_sphere(names: Sequence[str]) -> Iterator[tuple[str, Tree]]:
    """(1 - u², 2 u)/(1 + u²), a unit vector by stereographic projection, and its derivatives."""
    u = [f"u {name}" for name in names[1:]]
    along = rate_along(*([name + end for name in u] for end in ("", "_dot", "_ddot")))
    square = plus(ONE, (column(u).T * column(u)).entries[0])
    vector = [("-", TWO, square), *column(u).times(TWO).entries]
    vector = [("/", each, square) for each in vector]
    for end in ("", "_dot", "_ddot"):
        yield from zip((name + end for name in names), vector, strict=True)
        vector = [*map(along, vector)]


def rate_along(*groups: Sequence[str]) -> Callable[[Tree], Tree]:
    """The derivative by time, if each group of names has the rates of the next."""
    pairs = zip(chain(*groups[:-1]), chain(*groups[1:]), strict=True)
    return derivative({name: ("name", rate) for name, rate in pairs})


# What is claimed: matrices of a printed x, in pairs that are equal if x is right


def is_rotation(A: Matrix) -> tuple[Matrix, ...]:
    return A * A.T, IDENTITY, Matrix([[A.determinant()]]), Matrix([[ONE]])


Law = Callable[[Any, Matrix], tuple[Matrix, ...]]
OF_ROTATION: dict[str, Law] = {
    "rotation_matrix": lambda m, x: (x, m.shown),
    "rotation_rate": lambda m, x: (x, m.shown.each(m.rate)),
    "spin_matrix": lambda m, x: (x, m.shown.each(m.rate) * m.shown.T),
}
OF_FRAME: dict[str, Law] = {  # with Ω in space, or in the body
    "angular_velocity": lambda m, x: (x.hat(), m.spin),
    "angular_acceleration": lambda m, x: (x, m.omega.each(m.rate)),
    # x holds no rates, and these are random: x q̇ = Ω for all q̇, so that x = W
    "rate_matrix": lambda m, x: (x * m.rates, m.omega),
    # A is W, with a row for each condition
    "inverse_rate_matrix": lambda m, x: (m.A * x, m.one),
    "rates_from_angular_velocity": lambda m, x: (m.A * x, m.one * m.letters),
}
OF_BODY: dict[str, Law] = {
    "mass": lambda m, x: (x, m.mass),
    "centre_of_mass": lambda m, x: (x, m.centre),
    "inertia_tensor": lambda m, x: (x, m.inertia),
    "inertia_tensor_space": lambda m, x: (x, m.R * m.inertia * m.R.T),
    "inertia_tensor_point": lambda m, x: (x, m.about_point),
    "moment_of_inertia": lambda m, x: (x, m.direction.T * m.about_point * m.direction),
    **dict.fromkeys(PRINCIPAL, lambda m, _: m.principal()),
    "translational_energy": lambda m, x: (x, m.translational),
    "rotational_energy": lambda m, x: (x, m.energy),
    "kinetic_energy": lambda m, x: (x, m.translational + m.energy),
    "angular_momentum_centre": lambda m, x: (x, m.of_centre),
    "angular_momentum_rotation_body": lambda m, x: (x, m.momentum),
    "angular_momentum_rotation": lambda m, x: (x, m.R * m.momentum),
    "angular_momentum": lambda m, x: (x, m.of_centre + m.R * m.momentum),
    "angular_acceleration_from_torque": lambda m, x: (m.inertia * x, m.torque - m.gyroscopic),
}
OF_MOTION: dict[str, Law] = {
    "potential_energy": lambda m, x: (x, m.potential),
    "lagrangian": lambda m, x: (x, m.energy - m.potential),
    "energy": lambda m, x: (x, m.energy + m.potential),
    "generalised_momenta": lambda m, x: (x, m.momenta),
    "mass_matrix": lambda m, x: (x, m.masses),
    "bias_vector": lambda m, x: (x, m.bias),
    "accelerations": lambda m, x: (m.masses * x + m.bias, m.forces, *m.regular),
    # at p = M q̇, which may be any p if M is regular
    "hamiltonian": lambda m, x: (x, m.energy + m.potential, *m.regular),
    # M q̈ + h - Q, the balance, is zero along a motion; so are dE/dt and dp/dt of a cyclic q
    "constant energy": lambda m, x: (x.each(m.rate), m.rates.T * m.balance),
}
ONLY = {  # groups of names that x may hold besides constants; others could hide a false term
    "rate_matrix|inverse_rate_matrix": ["q"],
    "rates_from_angular_velocity": ["q", "omega"],
    "principal": [],
    "hamiltonian": ["q", "momenta"],
    "constant": ["q", "q_dot"],
}


class Motion:
    """A rotation, its body and what moves it, in the words of the laws.

    Ω has components in a frame. C(Ω) is the spin, and Ω = W q̇ is linear in the rates.
    """

    def __init__(self, record: Record, frame: str) -> None:
        self.record, self.rates = record, column(record.rates)
        self.rate = rate_along(record.q, record.rates, record.seconds)
        R, rate = record.R, record.R.each(self.rate)
        self.R, self.shown = R, R.T if record.content["presentation"] == "passive" else R
        self.spin = rate * R.T if frame == "space" else R.T * rate
        self.omega, self.letters = self.spin.vee(), column(OMEGA[frame])
        columns = (self.omega.each(derivative({name: ONE})).entries for name in record.rates)
        self.W = Matrix(columns).T
        # rates along a radius would leave the sphere of a condition
        radii = [[("name", n) if n in s else ZERO for n in record.q] for s in record.spheres]
        radii = [row for row in radii if any(entry != ZERO for entry in row)]
        self.A, self.is_free = Matrix([*self.W.rows, *radii]), not radii
        self.one = Matrix([*IDENTITY.rows, *([ZERO] * 3 for _ in radii)])
        self.laws = OF_ROTATION | {f"{name}_{frame}": law for name, law in OF_FRAME.items()}
        self.groups = {"q": record.q, "q_dot": record.rates, "momenta": record.momenta}
        self.groups["omega"] = OMEGA[frame]

    def read_body(self, body: Mapping[str, Any]) -> tuple[Matrix, ...]:
        """Pairs that are equal if this can be a body."""
        parts = (self.record.describe(body[part]) for part in ("mass", "centre", "inertia"))
        self.mass, self.centre, self.inertia = parts
        letters = {group: column(names) for group, (names, _) in LETTERS.items()}
        self.torque, self.direction = letters["torque"], letters["direction"]
        arm, velocity = (letters["point"] - self.centre).hat(), letters["centre_dot"]
        self.about_point = self.inertia + self.mass * (arm.T * arm)  # the parallel-axis theorem
        self.momentum = self.inertia * self.omega
        self.energy = (self.omega.T * self.momentum).times(HALF)
        self.translational = (self.mass * velocity.T * velocity).times(HALF)
        self.of_centre = self.mass * (letters["centre"].hat() * velocity)
        self.gyroscopic = self.letters.hat() * self.inertia * self.letters
        self.laws = self.laws | OF_BODY
        return self.inertia, self.inertia.T

    def principal(self) -> tuple[Matrix, ...]:
        """E = (e₁ e₂ e₃) is a rotation, and I E = E diag(I₁, I₂, I₃): the e are eigenvectors."""
        if not {*PRINCIPAL} <= {*self.record.printed}:
            raise Unproved("axes without moments, or moments without axes")
        axes, moments = (matrix_of(self.record.printed[name]) for name in PRINCIPAL)
        return *is_rotation(axes), self.inertia * axes, axes * moments.diagonal()

    def read_motion(self, motion: Mapping[str, Any]) -> tuple[Matrix, ...]:
        """d'Alembert's principle: W'ᵀ (dL'/dt + Ω' × L') + ∂V/∂q = Q, which is M q̈ + h = Q."""
        record, read, q, W = self.record, self.record.describe, self.record.q, self.W
        if not self.is_free or record.definitions or {*record.momenta} & {*LETTERS["point"][0]}:
            raise Unproved("coordinates that depend on one another, or names of two meanings")
        self.potential, forces = read(motion["potential"], *q), [*q, *record.rates]
        self.forces = read(motion["forces"], *forces) + W.T * read(motion["torque"], *forces)
        turning = self.momentum.each(self.rate) + self.omega.hat() * self.momentum
        slopes = (self.potential.each(derivative({name: ONE})).entries for name in q)
        inertial = W.T * turning + Matrix(slopes)
        self.masses, self.momenta = W.T * self.inertia * W, W.T * self.momentum
        self.bias = inertial - self.masses * column(record.seconds)
        self.balance = inertial - self.forces
        self.regular = (Matrix([[("/", ONE, self.masses.determinant())]]),) * 2  # or refused
        self.laws = self.laws | OF_MOTION
        for name, row in zip(q, self.balance.rows, strict=True):
            self.laws[f"constant momentum_{name}"] = has_rate(Matrix([row]))
        # The body turns about a fixed point, from which places are counted.
        return self.centre, self.centre.times(ZERO)

    def claim(self, name: str) -> tuple[Matrix, ...]:
        x, record = matrix_of(self.record.printed[name]), self.record
        inside = set().union(*map(record.letters_in, x.entries))
        for names in (groups for names, groups in ONLY.items() if re.match(names, name)):
            record.refuse_others(inside, chain(*(self.groups[group] for group in names)))
        if name != "hamiltonian" and "motion" in record.content and inside & {*record.momenta}:
            raise Unproved("it holds momenta")  # p = p would say nothing
        # A law may leave out a part of x that it multiplies by 0, so that x stands beside it.
        return (x, x, *self.laws[name](self, x))


def has_rate(rate: Matrix) -> Law:
    return lambda m, x: (x.each(m.rate), rate)


def agree(name: str, matrices: Sequence[Matrix], point: Point) -> None:
    for pair in zip(matrices[::2], matrices[1::2], strict=True):
        if len({tuple(map(len, matrix.rows)) for matrix in pair}) > 1:
            raise Refused(f"{name} has a wrong shape")
        one, two = ([*map(point.value, matrix.entries)] for matrix in pair)
        largest = max(abs(real) for values in (*one, *two) for real in (1, *values[2:]))
        for k, values in enumerate(map(partial(combined, sub), one, two), start=1):
            if max(map(abs, values[2:])) > CLOSE * largest:
                raise Refused(f"{name}: entry {k} is false at a real point")
            if values[1]:
                raise Unproved("it is true to 30 digits, but not exactly")


def verify(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """The names of what is proved, and of what is not, with the reasons.

    Raises one of BROKEN for a record of which something is false.
    """
    proved, reasons, lack = [ROTATION], dict[str, str](), "it has no definition here"
    with localcontext() as context:
        context.prec = DIGITS
        try:
            record = Record(content)
            space, body = (Motion(record, frame) for frame in OMEGA)
            point, kinematics = Point(record), body.laws
            agree(ROTATION, [*chain(*map(is_rotation, record.factors))], point)
        except Unproved as error:
            return [], dict.fromkeys(printed_in(content), str(error))
        try:
            if "body" in content:
                agree("the inertia tensor", body.read_body(content["body"]), point)
            if "motion" in content:
                agree("the centre", body.read_motion(content["motion"]), point)
                point.trees |= zip(record.momenta, body.momenta.entries, strict=True)
            agree(
                "the description",
                [*chain(*zip(record.described, record.described, strict=True))],
                point,
            )
        except Unproved as error:
            lack, body.laws = str(error), kinematics
        for name in record.printed:
            motion = space if name in space.laws else body
            try:
                if name not in motion.laws:
                    raise Unproved(lack)
                agree(name, motion.claim(name), point)
                proved.append(name)
            except (Unproved, RecursionError) as error:
                reasons[name] = str(error)
    return proved, reasons


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text, object_pairs_hook=without_twins, parse_float=str, parse_constant=str)


def answer(path: Path, *, is_named: bool) -> str:
    """What is proved of the record in a file; nothing for another file, unless it `is_named`."""
    record = load(path)
    if not isinstance(record, dict) or record.get("schema") != "rigidsym.derivation":
        if is_named:
            raise Refused("not the record of a derivation")
        return ""
    proved, reasons = verify(record)
    lines = [f"{path}: R is {record['rotation']}", f"  proved: {', '.join(proved) or 'nothing'}"]
    return "\n".join([*lines, *(f"  not proved: {n}, since {why}" for n, why in reasons.items())])


if __name__ == "__main__":
    named, status, answers = [Path(argument) for argument in sys.argv[1:]], 0, list[str]()
    files = [[*place.rglob("*.json")] if place.is_dir() else [place] for place in named]
    for path in sorted(chain(*files)):
        try:
            answers.append(answer(path, is_named=path in named))
        except (*BROKEN, OSError) as error:
            status = 1
            answers.append(f"{path}: REFUSED: {error}")
    print("\n".join(filter(None, answers)) or "REFUSED: there is no record of a derivation here")
    sys.exit(status or not any(answers))
