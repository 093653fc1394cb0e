"""Checks records of rigidsym without rigidsym: `python -I checker.py FOLDER|RECORD...`

A record NAME.json describes a rotation, perhaps with a body and a potential, and prints
expressions. This program works out the same quantities from their definitions at five random real
points, exactly, and compares. It believes nothing but the description.

An angle has a random t = tan(φ/2), so that its cosine (1 - t²)/(1 + t²) and sine 2t/(1 + t²) are
fractions. Each number is one of 2⁵², so that a false entry of degree d passes a point with a
probability of at most d/2⁵² (the lemma of Schwartz and Zippel). As d is counted, and at most 2³⁰,
it passes five with at most 2⁻¹¹⁰. The operating system draws them, so that no forger can.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache, reduce
from itertools import chain, starmap
from operator import add, mul, sub, truediv
from pathlib import Path
from random import SystemRandom
from typing import Any

STRENGTH = "decided at five exact points: a false entry passes with a probability below 2^-100"
POINTS, BITS, MOST_DEGREE, MOST_BITS = 5, 52, 2**30, 10**5
MOST_POWER, MOST_NUMBER, MULTIPLES = 60, 10**40, range(-12, 13)
OPERATIONS = {ast.Add: add, ast.Sub: sub, ast.Mult: mul, ast.Div: truediv}
LETTERS = {  # arguments besides coordinates and what belongs to them, with their units
    "omega_space": (["omega_space_1", "omega_space_2", "omega_space_3"], "rad/s"),
    "omega_body": (["omega_body_1", "omega_body_2", "omega_body_3"], "rad/s"),
    "centre": (["X", "Y", "Z"], "m"),
    "centre_dot": (["X_dot", "Y_dot", "Z_dot"], "m/s"),
    "point": (["p_x", "p_y", "p_z"], "m"),
    "direction": (["n_x", "n_y", "n_z"], ""),
    "torque": (["torque_1", "torque_2", "torque_3"], "N m"),
    "t": (["t"], "s"),
}
RESERVED = dict.fromkeys(("cos", "sin", "tan", "cot", "sqrt", "pi"), "")
PLACES = "q", "parameters"
NAME = "[A-Za-z][A-Za-z0-9_]*"  # "(phi)" and " phi" would be read as phi
PRINCIPAL = "principal_axes", "principal_moments"
# of a body and its motion; others could give these another meaning
KEYS = "mass centre inertia fixed_point parameters title in_numbers potential forces torque"
SUM = "({0}**2 + {1}**2 + {2}**2 + {3}**2)"
TURNS = {  # a vector v and numbers c and s: R = 1 + s C(v) + (1 - c) C(v)²
    "x": ("1", "0", "0", "cos({0})", "sin({0})"),
    "y": ("0", "1", "0", "cos({0})", "sin({0})"),
    "z": ("0", "0", "1", "cos({0})", "sin({0})"),
    "axis_angle": ("{0}", "{1}", "{2}", "cos({3})", "sin({3})"),
    "constant_turn": ("{0}", "{1}", "{2}", "{3}", "{4}"),
    "unit_quaternion": ("{1}", "{2}", "{3}", "-1", "2*{0}"),
    "quaternion": ("{1}", "{2}", "{3}", f"1 - 2/{SUM}", f"2*{{0}}/{SUM}"),
    # here {0} is 1
    "modified_rodrigues": ("2*{1}", "2*{2}", "2*{3}", f"1 - 2/{SUM}**2", f"(4 - 2*{SUM})/{SUM}**2"),
}


class Refused(ValueError):
    """What is printed is false, or the record contradicts itself."""


class Unproved(ValueError):
    """An expression or a quantity that this program does not know."""


BROKEN = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, RecursionError)
Rate = Callable[[str | None], "Number"]  # the derivative by a name, or by the time
Laws = dict[str, tuple[Any, ...]]


def refuse_unless(is_so: object, why: str, error: type[ValueError] = Refused) -> None:
    if not is_so:
        raise error(why)


class Number:
    """Values at all points, and a bound of the degree of their fraction of polynomials."""

    def __init__(self, degree: int, values: Iterable[Fraction], rule: Rate) -> None:
        self.degree, self.values, self.rule = degree, [*values], rule
        self.rates = dict[str | None, Number]()
        size = sum(map(int.bit_length, self.values[0].as_integer_ratio()))
        is_small = degree <= MOST_DEGREE and size <= MOST_BITS
        refuse_unless(is_small, "too large an expression", Unproved)

    def rate(self, by: str | None = None) -> Number:
        if by not in self.rates:
            self.rates[by] = self.rule(by)
        return self.rates[by]

    def combined(self, operation: Callable[..., Any], other: Number, rule: Rate) -> Number:
        values = map(operation, self.values, other.values)
        return Number(self.degree + other.degree, values, rule)

    def __add__(self, other: Number) -> Number:
        if self is ZERO or other is ZERO:
            return other if self is ZERO else self
        return self.combined(add, other, lambda by: self.rate(by) + other.rate(by))

    def __sub__(self, other: Number) -> Number:
        return self + MINUS * other

    def __mul__(self, other: Number) -> Number:
        if self is ZERO or other is ZERO:
            return ZERO
        if self is ONE or other is ONE:
            return other if self is ONE else self
        return self.combined(mul, other, lambda by: self.rate(by) * other + self * other.rate(by))

    def __truediv__(self, other: Number) -> Number:
        refuse_unless(0 not in other.values, "a divisor is zero")
        return self.combined(
            truediv, other, lambda by: (self.rate(by) - self / other * other.rate(by)) / other
        )


@cache
def whole(number: int) -> Number:
    return Number(0, [Fraction(number)] * POINTS, lambda _: ZERO)


ZERO, ONE, TWO, MINUS = map(whole, (0, 1, 2, -1))


def drawn(rate: Number = ZERO) -> Number:
    values = (Fraction(SystemRandom().randrange(1, 2**BITS + 1)) for _ in range(POINTS))
    return Number(1, values, lambda by: ZERO if by else rate)


def on_sphere(u: Sequence[Number]) -> list[Number]:
    """(1 - u², 2 u)/(1 + u²), a unit vector by stereographic projection."""
    square = reduce(add, (each * each for each in u), ONE)
    return [(TWO - square) / square, *(TWO * each / square for each in u)]


class Matrix:
    """Rows of numbers; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Any]) -> None:
        self.rows = [[row] if isinstance(row, Number) else [*row] for row in rows]
        self.entries = [*chain(*self.rows)]
        self.shape = [len(self.rows), *{*map(len, self.rows)}]
        is_whole = len(self.shape) < 3 and 0 not in self.shape[1:]
        refuse_unless(is_whole, "rows of different lengths, or without entries")

    def T(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))

    def __add__(self, other: Matrix) -> Matrix:
        refuse_unless(self.shape == other.shape, "a wrong shape")
        return Matrix(map(add, *pair) for pair in zip(self.rows, other.rows, strict=True))

    def __sub__(self, other: Matrix) -> Matrix:
        return self + other.scaled(MINUS)

    def scaled(self, number: Number) -> Matrix:
        return Matrix([number * entry for entry in row] for row in self.rows)

    def __mul__(self, other: Matrix) -> Matrix:
        refuse_unless(self.shape[1:] == other.shape[:1], "a wrong shape")
        columns = other.T().rows
        return Matrix([reduce(add, map(mul, row, c)) for c in columns] for row in self.rows)

    def rate(self, by: str | None = None) -> Matrix:
        return Matrix([entry.rate(by) for entry in row] for row in self.rows)

    def hat(self) -> Matrix:
        """C(v) of a vector v, the operator v ×."""
        (x,), (y,), (z,) = self.rows
        return Matrix([[ZERO, MINUS * z, y], [z, ZERO, MINUS * x], [MINUS * y, x, ZERO]])

    def axis(self) -> Matrix:
        """The vector v of C(v)."""
        return Matrix([self.rows[2][1], self.rows[0][2], self.rows[1][0]])

    def determinant(self) -> Number:
        """By the first column and its minors; 1 without rows."""
        total = ZERO if self.rows else ONE
        for row in reversed(self.rows):
            minor = Matrix(other[1:] for other in self.rows if other is not row)
            total = row[0] * minor.determinant() - total
        return total

    def refuse_unless_zero(self, name: str, part: str = "entry") -> None:
        for i, row in enumerate(self.rows, start=1):
            for j, number in enumerate(row, start=1):
                place = f"{part} {i}, {j}" if len(row) > 1 else f"{part} {i}"
                refuse_unless(not any(number.values), f"{name}: {place} is false at a real point")

    def refuse_unless_rotation(self, name: str) -> None:
        refuse_unless(self.shape == IDENTITY.shape, f"{name} has a wrong shape")
        (self * self.T() - IDENTITY).refuse_unless_zero(name)
        Matrix([self.determinant() - ONE]).refuse_unless_zero(name)


IDENTITY = Matrix([[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]])


def turn(*numbers: Number) -> Matrix:
    *axis, cosine, sine = numbers
    operator = Matrix(axis).hat()
    return IDENTITY + operator.scaled(sine) + (operator * operator).scaled(ONE - cosine)


def circle(angle: Number) -> Matrix:
    """The turn of a plane; its first column is the cosine and the sine."""
    cosine, sine = on_sphere([drawn()])
    cosine.rule = lambda by: MINUS * sine * angle.rate(by)
    sine.rule = lambda by: cosine * angle.rate(by)
    return Matrix([[cosine, MINUS * sine], [sine, cosine]])


@cache
def read(text: str) -> ast.expr:
    """Python's tree of an expression, whose names end in _ so that none is a keyword."""
    try:
        if not re.fullmatch(r"([A-Za-z]\w*+|\d++(?!\w)|[-+*/() ])*+", text, re.ASCII):
            raise SyntaxError  # for one, 0x1 is a number for Python, but reads as a product
        suffixed = re.sub(r"\b[A-Za-z]\w*", r"\g<0>_", text.strip())
        return ast.parse(suffixed, mode="eval").body
    except (MemoryError, RecursionError) as error:
        raise Unproved("too large an expression") from error
    except SyntaxError as error:
        raise Refused(f"the expression {text[:60]!r} cannot be read") from error


def names_in(*trees: ast.AST) -> set[str]:
    return {node.id[:-1] for node in chain(*map(ast.walk, trees)) if isinstance(node, ast.Name)}


def distinct(pairs: Iterable[tuple[str, Any]], plain: str = "[ -~]*") -> dict[str, Any]:
    pairs = [*pairs]
    names = [name for name, _ in pairs]
    wrong = [n for k, n in enumerate(names) if n in names[:k] or not re.fullmatch(plain, n)]
    refuse_unless(not wrong, f"a name is there twice, or not plain ASCII: {wrong}"[:200])
    return dict(pairs)


def claims_in(content: Mapping[str, Any]) -> dict[str, Any]:
    """The quantities and first integrals by their names."""
    groups = content["quantities"], content["first_integrals"]
    claims, constants = (distinct(((c["name"], c) for c in group), NAME) for group in groups)
    return claims | {"constant " + name: claim for name, claim in constants.items()}


def turn_of(text: str) -> tuple[str, list[str]]:
    """What a turn such as "z(phi)" is about, and the five texts of TURNS."""
    kind, places = text.partition("(")[0], text.partition("(")[2][:-1].split(",")
    count = len({*re.findall("{.}", " ".join(TURNS.get(kind, ())))})
    trees = [*map(read, places)]  # each of them is an expression, and no piece of one
    refuse_unless(text.endswith(")") and len(trees) == count, f"the turn {text!r}")
    return kind, [form.format(*(f"({place})" for place in places)) for form in TURNS[kind]]


class Record:
    """A description that does not contradict itself, with random numbers for its names."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content, rotation = content, content["rotation"]
        are_lists = [*map(type, rotation.values())] == [list, list]
        refuse_unless(are_lists, "a rotation has lists of turns (or a matrix) and of conditions")
        self.turns = [*map(turn_of, rotation.get("turns", []))]
        self.texts = [texts for _, texts in self.turns] or rotation.get("matrix", [])
        self.definitions = distinct((d["name"], d["expression"]) for d in content["definitions"])
        groups = distinct((g["name"], g["components"]) for g in content["arguments"])
        self.listed = {g: [(c["name"], c["unit"]) for c in names] for g, names in groups.items()}
        self.q, self.constants = ([n for n, _ in self.listed.get(g, [])] for g in PLACES)
        # x² + y² + ... - 1 has real roots; it gives an axis or a quaternion the length 1
        parts = (texts if "quaternion" in kind else texts[:3] for kind, texts in self.turns)
        vectors = (sorted(names_in(*map(read, part))) for part in parts)
        spheres = {" + ".join(f"{name}**2" for name in v) + " - 1": v for v in vectors if v[1:]}
        self.spheres = [spheres.get(condition, []) for condition in rotation["conditions"]]
        for names in self.spheres:
            is_length = names and any({*names} <= {*of} for of in (self.q, self.constants))
            refuse_unless(is_length, "a condition, which gives no vector the length 1", Unproved)
        self.arguments = self.all_arguments()
        self.names = {g: {n: drawn() for n, _ in pairs} for g, pairs in self.arguments.items()}
        numbers = self.names["parameters"] | {q: drawn(drawn(drawn())) for q in self.q}
        for sphere in self.spheres:
            numbers |= zip(sphere, on_sphere([numbers[name] for name in sphere[1:]]), strict=True)
        for name, number in numbers.items():
            number.rates[name] = ONE
            self.names["q" if name in self.q else "parameters"][name] = number
        for q in self.q:
            rate = self.names["q_dot"][f"{q}_dot"] = numbers[q].rate()
            rate.rates[f"{q}_dot"] = ONE
            self.names["q_ddot"][f"{q}_ddot"] = rate.rate()
        self.pi = drawn()  # no polynomial has the root pi
        part = TWO if "/2" in str(self.texts) else ONE  # turns by half an angle
        angles = {n: x if part is ONE else x / part for n, x in (numbers | {"1": ONE}).items()}
        self.circles = {name: (angle, circle(angle)) for name, angle in angles.items()}
        self.circle = cache(self.circle_of_sum)
        self.columns = {group: Matrix(numbers.values()) for group, numbers in self.names.items()}

    def all_arguments(self) -> dict[str, list[tuple[str, str]]]:
        """All that a record may list, with the units that follow from its turns."""
        trees = [*map(read, chain(*self.texts))]
        in_turns, nodes = names_in(*trees), chain(*map(ast.walk, trees))
        in_angles = names_in(*(node.args[0] for node in nodes if isinstance(node, ast.Call)))
        angles, lengths = ((n, "rad") for n in in_angles), ((n, "") for n in chain(*self.spheres))
        unit = dict.fromkeys(self.q, "") | distinct([*angles, *lengths])
        groups = {group: [(name, u) for name in names] for group, (names, u) in LETTERS.items()}
        groups |= {
            "q_dot": [(f"{q}_dot", f"{unit[q] or 1}/s") for q in self.q],
            "q_ddot": [(f"{q}_ddot", f"{unit[q] or 1}/s^2") for q in self.q],
            "momenta": [(f"p_{q}", "kg m^2/s") for q in self.q],
        }
        refuse_unless(len(self.turns) <= 25, "more than 25 turns", Unproved)  # 11 s for 24
        constants = [pair for pair in self.listed.get("parameters", []) if pair[0] in in_turns]
        body = self.content.get("body", {"parameters": []})["parameters"]
        constants += [(each["name"], each["unit"]) for each in body]
        groups["parameters"] = [(name, unit.get(name, u)) for name, u in constants]
        groups["q"] = [(q, unit[q]) for q in self.q]
        # listed or not, no name has two meanings, but p_x: `read` never has a momentum and a point
        both = {"point": [*dict(groups["momenta"] + groups["point"]).items()], "momenta": []}
        words = chain(RESERVED.items(), self.definitions.items())
        distinct(chain(words, *(groups | both).values()), NAME)
        states = [groups["q"] + groups[rates] for rates in ("q_dot", "omega_body")]
        for group, pairs in self.listed.items():
            right = states if group == "y" else [groups.get(group)]
            refuse_unless(pairs in right, f"{group} are {pairs}, expected one of {right}")
        refuse_unless(in_turns.isdisjoint(self.definitions), "a turn holds a definition")
        return groups

    def read(self, printed: Any, groups: Iterable[str] = ("parameters",)) -> Matrix:
        """A scalar, the column of a vector, or a matrix, of some groups of names."""
        names = distinct(chain([("pi", self.pi)], *(self.names[g].items() for g in groups)))
        rows = printed if isinstance(printed, list) else [printed]
        refuse_unless(len({*map(type, rows)}) == 1, "neither a vector nor the rows of a matrix")
        rows = [row if isinstance(row, list) else [row] for row in rows]
        return Matrix([self.value(read(text), names) for text in row] for row in rows)

    def value(self, node: ast.expr, names: dict[str, Number]) -> Number:
        match node:
            case ast.Name(suffixed):
                if (name := suffixed[:-1]) not in names:
                    refuse_unless(name in self.definitions, f"the name {name!r} is unknown here")
                    names[name] = self.value(read(self.definitions[name]), names)
                return names[name]
            case ast.Constant(int(number)) if number < MOST_NUMBER:
                return whole(number)
            case ast.UnaryOp(ast.USub(), operand):
                return MINUS * self.value(operand, names)
            case ast.BinOp(base, ast.Pow(), ast.Constant(int(power))) if 0 < power <= MOST_POWER:
                return reduce(mul, [self.value(base, names)] * power)
            case ast.BinOp(one, operator, two) if type(operator) in OPERATIONS:
                return OPERATIONS[type(operator)](self.value(one, names), self.value(two, names))
            case ast.Call(ast.Name("sqrt_"), [_], []):
                raise Unproved("a root")
            case ast.Call(ast.Name("cos_" | "sin_" | "tan_" | "cot_" as function), [angle], []):
                cosine, sine = self.circle(self.value(angle, names))
                if function in ("cos_", "sin_"):
                    return cosine if function == "cos_" else sine
                return sine / cosine if function == "tan_" else cosine / sine
        text = re.sub(r"_\b", "", ast.unparse(node))
        raise Refused(f"the expression {text[:60]!r} cannot be read")

    def circle_of_sum(self, angle: Number) -> tuple[Number, Number]:
        """The cosine and the sine of a sum of whole multiples, by the theorems of addition."""
        total, rest = Matrix([[ONE, ZERO], [ZERO, ONE]]), angle
        for name, (part, plane) in self.circles.items():  # the number 1 comes last
            count = rest / part if name == "1" else angle.rate(name) / part.rate(name)
            rest, turns = rest - count * part, count.values[0]
            is_whole = {*count.values} == {turns} and turns in MULTIPLES
            refuse_unless(is_whole, "an angle that is no sum of whole multiples", Unproved)
            total = reduce(mul, [plane if turns > 0 else plane.T()] * abs(int(turns)), total)
        return total.rows[0][0], total.rows[1][0]

    # What is claimed: the unit of a printed x, or the group of names that has it; 0, 1 or 2 for a
    # number, a vector or a matrix; its value, or what is zero if x is right; and the groups of
    # names that x may depend on besides parameters; others could hide a false term

    def of_rotation(self) -> Laws:
        turns = (self.read(texts, PLACES).entries for _, texts in self.turns)
        factors = [turn(*numbers) for numbers in turns] or [self.read(self.texts, PLACES)]
        for factor in factors:
            factor.refuse_unless_rotation("R")
        R = self.R = reduce(mul, factors)
        presented = {"active": R, "passive": R.T()}[self.content["presentation"]]
        laws: Laws = {
            "rotation_matrix": ("", 2, presented),
            "rotation_rate": ("1/s", 2, presented.rate()),
            "spin_matrix": ("rad/s", 2, presented.rate() * presented.T()),
        }
        for frame, spin in (("space", R.rate() * R.T()), ("body", R.T() * R.rate())):
            laws |= self.of_frame(frame, spin)
        return laws

    def of_frame(self, frame: str, spin: Matrix) -> Laws:
        """Ω with components in space or in the body: C(Ω) is the spin, and Ω = W q̇."""
        omega = spin.axis()  # of a skew matrix, as R Rᵀ = 1
        W = Matrix(omega.rate(f"{q}_dot").entries for q in self.q).T()
        # rates along a radius would leave the sphere of a condition
        spheres = [sphere for sphere in self.spheres if sphere[0] in self.q]
        radii = [[self.names["q"][q] if q in s else ZERO for q in self.q] for s in spheres]
        A, one = Matrix([*W.rows, *radii]), Matrix([*IDENTITY.rows, *([ZERO] * 3 for _ in radii)])
        rates, letters = self.columns["q_dot"], self.columns[f"omega_{frame}"]
        self.W, self.omega, self.is_free = W, omega, not radii  # in the body, which comes last
        rates_of = "q_dot", 1, lambda x: A * x - one * letters, "q", f"omega_{frame}"
        return {
            f"angular_velocity_{frame}": ("rad/s", 1, omega, "q", "q_dot"),
            f"angular_acceleration_{frame}": ("rad/s^2", 1, omega.rate()),
            f"rate_matrix_{frame}": ("", 2, lambda x: x * rates - omega, "q"),
            f"inverse_rate_matrix_{frame}": ("", 2, lambda x: A * x - one, "q"),
            f"rates_from_angular_velocity_{frame}": rates_of,
        }

    def of_body(self) -> Laws:
        body, omega, R, half = self.content["body"], self.omega, self.R, ONE / TWO
        mass, centre, inertia = (self.read(body[part]) for part in ("mass", "centre", "inertia"))
        (m,), is_moving = mass.entries, "motion" in self.content or "y" in self.listed
        (inertia - inertia.T()).refuse_unless_zero("the inertia tensor")

        def moved(tensor: Matrix, vector: Matrix) -> Matrix:
            """To another point, by the parallel-axis theorem."""
            return tensor + (vector.hat().T() * vector.hat()).scaled(m)

        about_point = moved(inertia, self.columns["point"] - centre)
        # in a motion, the body turns about a fixed point, and its tensor is about an unstated one
        is_placed = "fixed_point" in body or not is_moving
        if not is_placed:
            centre.refuse_unless_zero("the centre of mass")
        offset = self.read(body.get("fixed_point", body["centre"])) - centre
        is_free = is_placed and not any(chain(*(each.values for each in offset.entries)))
        inertia = moved(inertia, offset)
        velocity, momentum = self.columns["centre_dot"], inertia * omega
        of_centre = (self.columns["centre"].hat() * velocity).scaled(m)
        energy = (omega.T() * momentum).scaled(half)
        translation = (velocity.T() * velocity).scaled(half * m)
        direction, w = self.columns["direction"], self.columns["omega_body"]
        euler = w.hat() * inertia * w - self.columns["torque"]
        self.inertia, self.momentum, self.energy = inertia, momentum, energy
        free: Laws = {
            "inertia_tensor_point": ("kg m^2", 2, about_point),
            "moment_of_inertia": ("kg m^2", 0, direction.T() * about_point * direction),
            "translational_energy": ("J", 0, translation),
            "kinetic_energy": ("J", 0, translation + energy),
            "angular_momentum_centre": ("kg m^2/s", 1, of_centre),
            "angular_momentum": ("kg m^2/s", 1, of_centre + R * momentum),
        }
        laws = free if is_free else {}
        laws |= {"centre_of_mass": ("m", 1, centre)} if is_placed else {}
        return laws | {
            "mass": ("kg", 0, mass),
            "inertia_tensor": ("kg m^2", 2, inertia),
            "inertia_tensor_space": ("kg m^2", 2, R * inertia * R.T()),
            "principal_axes": ("", 2, self.principal, "parameters"),
            "principal_moments": ("kg m^2", 1, self.principal, "parameters"),
            "rotational_energy": ("J", 0, energy),
            "angular_momentum_rotation_body": ("kg m^2/s", 1, momentum),
            "angular_momentum_rotation": ("kg m^2/s", 1, R * momentum),
            "angular_acceleration_from_torque": ("rad/s^2", 1, lambda x: inertia * x + euler),
        }

    def principal(self, _: Matrix) -> Matrix:
        """E = (e₁ e₂ e₃) is a rotation, and I E = E diag(I₁, I₂, I₃): the e are eigenvectors."""
        claims = claims_in(self.content)
        refuse_unless({*PRINCIPAL} <= {*claims}, "axes without moments, or the reverse", Unproved)
        axes, moments = (self.read(claims[name]["expression"]) for name in PRINCIPAL)
        axes.refuse_unless_rotation("principal axes")
        pairs = (zip(row, moments.entries, strict=True) for row in axes.rows)
        return self.inertia * axes - Matrix(starmap(mul, row) for row in pairs)

    def of_motion(self) -> Laws:
        """d'Alembert's principle: W'ᵀ (dL'/dt + Ω' × L') + ∂V/∂q = Q, which is M q̈ + h = Q."""
        is_plain = self.is_free and len(self.q) <= 3 and not self.definitions
        refuse_unless(is_plain, "coordinates that depend on one another, or definitions", Unproved)
        motion, W, energy, moving = self.content["motion"], self.W, self.energy, (*PLACES, "q_dot")
        rates, seconds = self.columns["q_dot"], self.columns["q_ddot"]
        potential = self.read(motion["potential"], PLACES)
        forces, torque = (self.read(motion[part], moving) for part in ("forces", "torque"))
        turning = self.momentum.rate() + self.omega.hat() * self.momentum
        inertial = W.T() * turning + Matrix(potential.rate(q).entries for q in self.q)
        balance = inertial - forces - W.T() * torque  # zero along a motion
        masses, momenta = W.T() * self.inertia * W, W.T() * self.momentum
        refuse_unless(0 not in masses.determinant().values, "the mass matrix is singular")
        self.names["momenta"] = dict(zip(self.names["momenta"], momenta.entries, strict=True))
        laws: Laws = {
            "potential_energy": ("J", 0, potential),
            "lagrangian": ("J", 0, energy - potential),
            "energy": ("J", 0, energy + potential),
            "generalised_momenta": ("kg m^2/s", 1, momenta),
            "mass_matrix": ("kg m^2", 2, masses),
            "bias_vector": ("N m", 1, inertial - masses * seconds),
            "accelerations": ("q_ddot", 1, lambda x: masses * (x - seconds) + balance, *moving),
            "hamiltonian": ("J", 0, lambda x: x - energy - potential, "q", "momenta"),
        }

        def constant(v: Matrix, rate: Matrix) -> tuple[Any, ...]:
            """The claim equals v, and dv/dt vanishes on every motion."""
            return None, 0, lambda x: Matrix((x - v).rows + (v.rate() - rate).rows), *moving

        for q, p, row in zip(self.q, momenta.rows, balance.rows, strict=True):
            laws[f"constant momentum_{q}"] = constant(Matrix(p), Matrix(row))
        return laws | {"constant energy": constant(energy + potential, rates.T() * balance)}


def verify(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """What is proved, and why other claims are not; raises one of BROKEN if something is false."""
    proved, reasons, laws, lack = list[str](), dict[str, str](), Laws(), "no definition of it"
    try:
        record = Record(content)
        laws |= record.of_rotation()
        proved.append("R is a rotation")
        unknown = {*content.get("body", ()), *content.get("motion", ())} - {*KEYS.split()}
        refuse_unless(not unknown, f"{unknown} of a body or its motion", Unproved)
        laws |= record.of_body() if "body" in content else {}
        laws |= record.of_motion() if "motion" in content else {}
    except Unproved as error:
        lack = str(error)
        reasons |= {} if proved else {"R is a rotation": lack}
    for name, claim in claims_in(content).items():
        try:
            refuse_unless(name in laws, lack, Unproved)
            unit, depth, law, *groups = laws[name]
            allowed = {"parameters", *(groups or {*record.names} - {"momenta", "t"})}
            allowed &= {*record.listed}
            inputs, printed = claim.get("inputs", [*allowed]), claim["expression"]
            are_so = inputs == [*dict.fromkeys(group for group in inputs if group in allowed)]
            refuse_unless(are_so, f"{name} does not depend on {inputs}")
            x = record.read(printed, inputs)
            units = {u for _, u in record.arguments.get(unit, [("", unit)])}
            unit = units.pop() if len(units) == 1 else ""
            nesting = isinstance(printed, list) + isinstance(printed[0], list)
            form = nesting, claim.get("shape", []), claim.get("unit")
            due = depth, x.shape[:depth], unit
            refuse_unless(repr(form) == repr(due), f"{name}: depth, shape, unit {form}, not {due}")
            rest, part = (law(x), "equation") if callable(law) else (x - law, "entry")
            rest.refuse_unless_zero(name, part)
            proved.append(name)
        except (Unproved, RecursionError) as error:
            reasons[name] = str(error)
    return proved, reasons


def reason(error: Exception) -> str:
    """Why a record is refused."""
    is_of_python = isinstance(error, (LookupError, TypeError, AttributeError))
    return f"a key is missing, or of another type: {error!r}" if is_of_python else str(error)


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text, and NaN is no fraction."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text, object_pairs_hook=distinct, parse_float=str, parse_constant=Fraction)


if __name__ == "__main__":
    is_refused, lines, ending = False, list[str](), "*.[jJ][sS][oO][nN]"
    files = [sorted(p.rglob(ending)) if p.is_dir() else [p] for p in map(Path, sys.argv[1:])]
    if not all(files) or not files:
        print("usage: python -I checker.py FOLDER|RECORD... (with NAME.json)", file=sys.stderr)
        sys.exit(2)
    for path in chain(*files):
        try:
            content = load(path)
            is_ours = content.get("schema") == "rigidsym.derivation"
            if not is_ours and not {"rotation", "quantities"} <= {*content}:
                lines.append(f"{path}: skipped, since it is no record of a derivation")
                continue
            refuse_unless(is_ours, "the schema is not rigidsym.derivation")
            proved, reasons = verify(content)
            refuse_unless(proved, f"nothing is proved: {', '.join({*reasons.values()})}")
            lines += [f"{path}: R is {content['rotation']}", STRENGTH]
            lines += ["  proved: " + ", ".join(proved)]
            lines += [f"  not proved, since {why}: {name}" for name, why in reasons.items()]
        except (*BROKEN, OSError) as error:
            is_refused = True
            lines.append(f"{path}: REFUSED: {reason(error)}")
    print(*(line.encode("unicode_escape").decode() for line in lines), sep="\n")
    sys.exit(is_refused or STRENGTH not in lines)
