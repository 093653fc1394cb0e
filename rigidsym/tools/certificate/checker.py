"""Checks records of rigidsym without rigidsym: `python checker.py FOLDER|RECORD...`

A record NAME.json describes a rotation, perhaps with a body and a potential, and prints
expressions. This program works out the same quantities from their definitions, and compares. It
believes nothing but the description.

All numbers are worked out at five random real points, exactly: t = tan(φ/2) is drawn for an angle,
so that the cosine (1 - t²)/(1 + t²) and the sine 2t/(1 + t²) are fractions. What is false at a
point, or divides by zero there, is refused. Two fractions of polynomials, whose difference is not
zero and has the degree d, agree at a point with a probability of at most d/2⁵², since each number
is one of 2⁵² (the lemma of Schwartz and Zippel). The degree is counted, and at most 2³⁰, so that a
false entry passes five points with a probability of at most 2⁻¹¹⁰. The operating system draws
them, so that no forger can choose them.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache, reduce
from itertools import chain
from operator import add, mul, sub, truediv
from pathlib import Path
from random import SystemRandom
from typing import Any

STRENGTH = "decided at five exact points: a false entry passes with a probability below 2^-100"
POINTS, BITS, MOST_DEGREE, TIME = 5, 52, 2**30, "by time"  # which is no name
MOST_BITS, MOST_POWER, MOST_NUMBER, MOST_TURNS = 10**5, 60, 10**40, 12
OPERATIONS = {ast.Add: add, ast.Sub: sub, ast.Mult: mul, ast.Div: truediv}
LETTERS = {  # arguments besides coordinates and what belongs to them, with their units
    "omega_space": (["omega_space_1", "omega_space_2", "omega_space_3"], "rad/s"),
    "omega_body": (["omega_body_1", "omega_body_2", "omega_body_3"], "rad/s"),
    "centre": (["X", "Y", "Z"], "m"),
    "centre_dot": (["X_dot", "Y_dot", "Z_dot"], "m/s"),
    "point": (["p_x", "p_y", "p_z"], "m"),
    "direction": (["n_x", "n_y", "n_z"], ""),
    "torque": (["torque_1", "torque_2", "torque_3"], "N m"),
}
PRINCIPAL = "principal_axes", "principal_moments"
ROTATIONS = {"turns", "conditions"}, {"matrix", "conditions"}
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
Rate = Callable[[str], "Number"]
Laws = dict[str, tuple[Any, ...]]


class Number:
    """Values at all points, and a bound of the degree of their fraction of polynomials."""

    def __init__(self, degree: int, values: Any, new_rate: Rate = lambda _: ZERO) -> None:
        self.degree, self.values = degree, [*values]
        self.new_rate, self.rates = new_rate, dict[str, Number]()  # by TIME or a name
        size = sum(map(int.bit_length, self.values[0].as_integer_ratio()))
        if degree > MOST_DEGREE or size > MOST_BITS:
            raise Unproved("too large an expression")

    def rate(self, by: str) -> Number:
        if by not in self.rates:
            self.rates[by] = self.new_rate(by)
        return self.rates[by]

    def combined(self, operation: Callable[..., Any], other: Number, new_rate: Rate) -> Number:
        values = map(operation, self.values, other.values)
        return Number(self.degree + other.degree, values, new_rate)

    def __add__(self, other: Number) -> Number:
        if self is ZERO or other is ZERO:
            return other if self is ZERO else self
        return self.combined(add, other, lambda by: self.rate(by) + other.rate(by))

    def __sub__(self, other: Number) -> Number:
        return self.combined(sub, other, lambda by: self.rate(by) - other.rate(by))

    def __mul__(self, other: Number) -> Number:
        if self is ZERO or other is ZERO:
            return ZERO
        if self is ONE or other is ONE:
            return other if self is ONE else self
        return self.combined(mul, other, lambda by: self.rate(by) * other + self * other.rate(by))

    def __truediv__(self, other: Number) -> Number:
        if 0 in other.values:
            raise Refused("a divisor is zero")
        quotient = self.combined(
            truediv, other, lambda by: (self.rate(by) - quotient * other.rate(by)) / other
        )
        return quotient


@cache
def whole(number: int) -> Number:
    return Number(0, [Fraction(number)] * POINTS)


ZERO: Number = whole(0)
MINUS, ONE, TWO = map(whole, (-1, 1, 2))


def drawn(rate: Number = ZERO) -> Number:
    values = (Fraction(SystemRandom().randrange(1, 2**BITS + 1)) for _ in range(POINTS))
    return Number(1, values, lambda by: rate if by == TIME else ZERO)


def on_sphere(u: Sequence[Number]) -> list[Number]:
    """(1 - u², 2 u)/(1 + u²), a unit vector by stereographic projection."""
    square = reduce(add, (each * each for each in u), ONE)
    return [(TWO - square) / square, *(TWO * each / square for each in u)]


def circle(angle: Number) -> tuple[Number, Number]:
    """The cosine and the sine."""
    on_circle = on_sphere([drawn()])
    cosine = Number(2, on_circle[0].values, lambda by: MINUS * sine * angle.rate(by))
    sine = Number(2, on_circle[1].values, lambda by: cosine * angle.rate(by))
    return cosine, sine


class Matrix:
    """Rows of numbers; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Any]) -> None:
        self.rows = [[row] if isinstance(row, Number) else [*row] for row in rows]
        self.entries = [*chain(*self.rows)]
        self.shape = [len(self.rows), *{*map(len, self.rows)}]
        if len(self.shape) > 2 or 0 in self.shape[1:]:
            raise Refused("rows of different lengths, or without entries")

    @property
    def T(self) -> Matrix:
        return Matrix(zip(*self.rows, strict=True))

    def entrywise(self, operation: Callable[..., Number], other: Matrix) -> Matrix:
        if self.shape != other.shape:
            raise Refused("a wrong shape")
        return Matrix(map(operation, *pair) for pair in zip(self.rows, other.rows, strict=True))

    def __add__(self, other: Matrix) -> Matrix:
        return self.entrywise(add, other)

    def __sub__(self, other: Matrix) -> Matrix:
        return self.entrywise(sub, other)

    def __mul__(self, other: Matrix) -> Matrix:
        if len(self.entries) == 1 and len(other.rows) > 1:  # a scalar
            return Matrix([self.entries[0] * entry for entry in row] for row in other.rows)
        if self.shape[1:] != other.shape[:1]:
            raise Refused("a wrong shape")
        columns = other.T.rows
        return Matrix([reduce(add, map(mul, row, c)) for c in columns] for row in self.rows)

    def rate(self, by: str = TIME) -> Matrix:
        return Matrix([entry.rate(by) for entry in row] for row in self.rows)

    def hat(self) -> Matrix:
        """C(v) of a vector v, the operator v ×."""
        (x,), (y,), (z,) = self.rows
        return Matrix([[ZERO, MINUS * z, y], [z, ZERO, MINUS * x], [MINUS * y, x, ZERO]])

    def determinant(self) -> Number:
        """By the first column and its minors; 1 without rows."""
        total = ZERO if self.rows else ONE
        for row in reversed(self.rows):
            minor = Matrix(other[1:] for other in self.rows if other is not row)
            total = row[0] * minor.determinant() - total
        return total

    def refuse_unless_zero(self, name: str) -> None:
        for k, number in enumerate(self.entries, start=1):
            if any(number.values):
                raise Refused(f"{name}: entry {k} is false at a real point")


IDENTITY = Matrix([[ONE, ZERO, ZERO], [ZERO, ONE, ZERO], [ZERO, ZERO, ONE]])
HALF = Matrix([ONE / TWO])


def turn(*numbers: Number) -> Matrix:
    """Rodrigues' formula R = 1 + s C(v) + (1 - c) C(v)²; whether R is a rotation is tested."""
    *axis, cosine, sine = numbers
    operator = Matrix(axis).hat()
    return IDENTITY + Matrix([sine]) * operator + Matrix([ONE - cosine]) * (operator * operator)


def is_rotation(A: Matrix) -> Matrix:
    """A Aᵀ - 1 and det A - 1, which are zero for a rotation."""
    if A.shape != IDENTITY.shape:
        raise Refused("R or principal axes of a wrong shape")
    return Matrix([*(A * A.T - IDENTITY).entries, A.determinant() - ONE])


@cache
def read(text: str) -> ast.expr:
    """Python's tree of an expression, whose names end in _ so that none is a keyword."""
    try:
        if not re.fullmatch(r"([A-Za-z]\w*+|\d++(?!\w)|[-+*/() ])*+", text, re.ASCII):
            raise SyntaxError  # for one, 0x1 is a number for Python, but reads as a product
        text = re.sub(r"\b[A-Za-z]\w*", r"\g<0>_", text.strip())
        return ast.parse(text, mode="eval").body
    except (SyntaxError, MemoryError, RecursionError) as error:
        raise Refused(f"the expression {text[:60]!r} cannot be read") from error


def without_twins(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    pairs = [*pairs]
    names = [name for name, _ in pairs]
    if len({*names}) < len(names) or not re.fullmatch(r"[ -~]*", "".join(names)):
        raise Refused(f"a name is there twice, or not plain ASCII: {names}"[:200])
    return dict(pairs)


def claims_in(content: Mapping[str, Any]) -> dict[str, Any]:
    """The quantities and first integrals by their names."""
    claims = [(claim["name"], claim) for claim in content["quantities"]]
    claims += [("constant " + claim["name"], claim) for claim in content["first_integrals"]]
    return without_twins(claims)


def printed_in(content: Mapping[str, Any]) -> dict[str, Any]:
    return {name: claim["expression"] for name, claim in claims_in(content).items()}


def turn_of(text: str) -> tuple[str, list[str]]:
    """What a turn such as "z(phi)" is about, and the five texts of TURNS."""
    kind, places = text.partition("(")[0], text.partition("(")[2][:-1].split(",")
    count = len({*re.findall("{.}", " ".join(TURNS.get(kind, ())))})
    if not text.endswith(")") or len(places) != count:
        raise Refused(f"the turn {text!r}")
    for place in places:
        read(place)  # each of them is an expression, and no piece of one
    return kind, [form.format(*(f"({place})" for place in places)) for form in TURNS[kind]]


class Record:
    """A description that does not contradict itself, with random numbers for its names."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content, self.rotation = content, content["rotation"]
        self.turns, matrix = self.rotation.get("turns", []), self.rotation.get("matrix", [])
        if {*self.rotation} not in ROTATIONS or {*map(type, self.rotation.values())} != {list}:
            raise Refused("a rotation has lists of turns (or a matrix) and of conditions")
        forms = [*map(turn_of, self.turns)]
        self.texts = [texts for _, texts in forms] or matrix
        # the names in axes and quaternions, to which conditions may give the length 1
        vectors = [" ".join(texts if "quaternion" in kind else texts[:3]) for kind, texts in forms]
        vectors_of = [{*re.findall(r"[A-Za-z]\w*", vector)} for vector in vectors]
        definitions = ((each["name"], each["expression"]) for each in content["definitions"])
        self.definitions = without_twins(definitions)
        groups = without_twins((g["name"], g["components"]) for g in content["arguments"])
        units = {group: [(c["name"], c["unit"]) for c in each] for group, each in groups.items()}
        self.q, self.constants = ([q for q, _ in units.get(g, [])] for g in ("q", "parameters"))
        self.spheres = list[list[str]]()
        for condition in self.rotation["conditions"]:  # x² + y² + ... - 1 has real roots
            names = re.findall(r"\w+(?=\*\*2)", condition)
            is_sum = re.fullmatch(r"\w+\*\*2( \+ \w+\*\*2)+ - 1", condition)
            is_one_kind = {*names} <= {*self.q} or {*names} <= {*self.constants}
            if not is_sum or not is_one_kind or {*names} not in vectors_of:
                raise Unproved(f"the condition {condition!r}, which gives no vector the length 1")
            self.spheres.append(names)
        without_twins((name, "") for name in chain(*self.spheres))
        self.refuse_words(units)
        numbers = {name: drawn(drawn(drawn())) for name in self.q}
        numbers |= {name: drawn() for name in self.constants}
        for sphere in self.spheres:
            numbers |= zip(sphere, on_sphere([numbers[name] for name in sphere[1:]]), strict=True)
        self.names = {g: {name: drawn() for name in names} for g, (names, _) in LETTERS.items()}
        self.names |= {"q": {}, "q_dot": {}, "q_ddot": {}, "momenta": {}}
        for name, number in numbers.items():
            if name in self.q:
                rate, second = number.rate(TIME), number.rate(TIME).rate(TIME)
                rate.rates[f"{name}_dot"], self.names["q_ddot"][f"{name}_ddot"] = ONE, second
                self.names["q"][name], self.names["q_dot"][f"{name}_dot"] = number, rate
            number.rates[name] = ONE
        self.angles = {name: (n, circle(n)) for name, n in (numbers | {"1": ONE}).items()}
        self.circle = cache(self.circle_of_sum)
        constants = {name: numbers[name] for name in self.constants}
        self.names["constants"] = constants | {"pi": drawn()}  # no polynomial has the root pi
        self.columns = {group: Matrix(names.values()) for group, names in self.names.items()}

    def refuse_words(self, groups: dict[str, list[tuple[str, str]]]) -> None:
        """Refuse words beside the expressions that would give a true claim another meaning."""
        name, presentation = self.content["name"], self.content["presentation"]
        if presentation not in ("active", "passive"):
            raise Refused(f"the presentation {presentation!r}")
        spelled = re.fullmatch("euler_([xyz]{3})_(in|ex)trinsic(_passive)?", name)
        if not re.fullmatch("(?!euler_.*trinsic)[a-z][a-z0-9_]*", name) and not spelled:
            raise Refused(f"the name {name!r}")
        if spelled:
            turns = [f"{axis}({q})" for axis, q in zip(spelled[1], self.q, strict=True)]
            turns = turns[::-1] if spelled[2] == "ex" else turns
            if self.turns != turns or bool(spelled[3]) != (presentation == "passive"):
                raise Refused(f"the turns are not those of {name}")
        nodes = chain(*(ast.walk(read(text)) for text in chain(*self.texts)))
        angles = chain(*(ast.walk(node.args[0]) for node in nodes if isinstance(node, ast.Call)))
        in_angles = [node.id[:-1] for node in angles if isinstance(node, ast.Name)]
        unit = self.unit = dict.fromkeys(self.q, "") | dict.fromkeys(in_angles, "rad")
        unit |= dict.fromkeys(chain(*self.spheres), "")
        expected = {group: [(name, u) for name in names] for group, (names, u) in LETTERS.items()}
        expected["q_dot"] = [(f"{q}_dot", f"{unit[q] or 1}/s") for q in self.q]
        expected["q_ddot"] = [(f"{q}_ddot", f"{unit[q] or 1}/s^2") for q in self.q]
        expected["momenta"] = [(f"p_{q}", "kg m^2/s") for q in self.q]
        expected["t"] = [("t", "s")]
        unit |= dict(chain(*expected.values()))
        body = self.content.get("body", {"parameters": []})
        of_body = {"body": [(each["name"], each["unit"]) for each in body["parameters"]]}
        for group, letters in (groups | of_body).items():
            right = [(name, unit.setdefault(name, printed)) for name, printed in letters]
            of_record = right if group in ("q", "parameters", "y", "body") else None
            if letters != expected.get(group, of_record) or {*dict(letters)} & {*self.definitions}:
                raise Refused(f"{group} are {letters}, or are defined")
        own = [*self.q, *self.constants, *self.definitions]
        taken = {*dict(chain(*expected.values())), "cos", "sin", "tan", "cot", "sqrt", "pi"}
        without_twins((name, "") for name in (*own, *taken))
        if {*in_angles} & {*self.definitions}:  # a definition states no unit
            raise Refused("an angle of a turn is defined")

    def unit_of(self, group: str) -> str:
        """The unit that all names of a group have, or "" if they differ."""
        units = {self.unit[name] for name in self.names[group]}
        return units.pop() if len(units) == 1 else ""

    def read(self, printed: Any, *groups: str) -> Matrix:
        """A scalar, the column of a vector, or a matrix, of constants and some groups of names."""
        names = dict(chain(*(self.names[group].items() for group in ("constants", *groups))))
        rows = printed if isinstance(printed, list) else [printed]
        rows = [row if isinstance(row, list) else [row] for row in rows]
        return Matrix([self.value(read(text), names) for text in row] for row in rows)

    def value(self, node: ast.expr, names: dict[str, Number]) -> Number:
        match node:
            case ast.Name(suffixed):
                name = suffixed[:-1]
                if name not in names and name not in self.definitions:
                    raise Refused(f"{name} must not be in an expression")
                if name not in names:
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
                if function in ("tan_", "cot_"):
                    return sine / cosine if function == "tan_" else cosine / sine
                return cosine if function == "cos_" else sine
        raise Refused(f"the expression {ast.unparse(node)[:60]!r} cannot be read")

    def circle_of_sum(self, angle: Number) -> tuple[Number, Number]:
        """The cosine and the sine of a sum of whole multiples, by the theorems of addition."""
        cosine, sine, rest = ONE, ZERO, angle
        for name, (number, (c, s)) in self.angles.items():  # the number 1 comes last
            count = rest if number is ONE else angle.rate(name)
            rest, turns = rest - count * number, count.values[0]
            if {*count.values} != {turns} or turns not in range(-MOST_TURNS, MOST_TURNS + 1):
                raise Unproved("an angle that is no sum of whole multiples")
            s = s if turns > 0 else MINUS * s
            for _ in range(abs(int(turns))):
                cosine, sine = cosine * c - sine * s, cosine * s + sine * c
        return cosine, sine

    # What is claimed: the unit of a printed x; its value, or what is zero if x is right; and the
    # groups of names that x may hold besides constants where others could hide a false term

    def of_rotation(self) -> Laws:
        factors = [turn(*self.read(forms, "q").entries) for forms in self.texts if self.turns]
        factors = factors or [self.read(self.texts, "q")]
        for factor in factors:
            is_rotation(factor).refuse_unless_zero("R is a rotation")
        R = self.R = reduce(mul, factors)
        presented = R.T if self.content["presentation"] == "passive" else R
        return {
            "rotation_matrix": ("", presented),
            "rotation_rate": ("1/s", presented.rate()),
            "spin_matrix": ("rad/s", presented.rate() * presented.T),
            **self.of_frame("space", R.rate() * R.T),
            **self.of_frame("body", R.T * R.rate()),
        }

    def of_frame(self, frame: str, spin: Matrix) -> Laws:
        """Ω with components in space or in the body: C(Ω) is the spin, and Ω = W q̇."""
        omega = Matrix([spin.rows[2][1], spin.rows[0][2], spin.rows[1][0]])
        W = Matrix(omega.rate(f"{q}_dot").entries for q in self.q).T
        # rates along a radius would leave the sphere of a condition
        spheres = [sphere for sphere in self.spheres if sphere[0] in self.q]
        radii = [[self.names["q"][q] if q in s else ZERO for q in self.q] for s in spheres]
        A, one = Matrix([*W.rows, *radii]), Matrix([*IDENTITY.rows, *([ZERO] * 3 for _ in radii)])
        rates, letters = self.columns["q_dot"], self.columns[f"omega_{frame}"]
        self.W, self.omega, self.is_free = W, omega, not radii  # in the body, which comes last
        from_omega = (self.unit_of("q_dot"), lambda x: A * x - one * letters, "q", f"omega_{frame}")
        return {
            f"angular_velocity_{frame}": ("rad/s", lambda x: x.hat() - spin, "q", "q_dot"),
            f"angular_acceleration_{frame}": ("rad/s^2", omega.rate()),
            f"rate_matrix_{frame}": ("", lambda x: x * rates - omega, "q"),
            f"inverse_rate_matrix_{frame}": ("", lambda x: A * x - one, "q"),
            f"rates_from_angular_velocity_{frame}": from_omega,
        }

    def of_body(self) -> Laws:
        body, omega, letters, R = self.content["body"], self.omega, self.columns, self.R
        mass, centre, inertia = (self.read(body[part]) for part in ("mass", "centre", "inertia"))
        (inertia - inertia.T).refuse_unless_zero("the inertia tensor")
        velocity, arm = letters["centre_dot"], (letters["point"] - centre).hat()
        about_point = inertia + mass * (arm.T * arm)  # the parallel-axis theorem
        momentum, of_centre = inertia * omega, mass * (letters["centre"].hat() * velocity)
        energy, translation = HALF * (omega.T * momentum), HALF * mass * (velocity.T * velocity)
        direction, w = letters["direction"], letters["omega_body"]
        euler = w.hat() * inertia * w - letters["torque"]
        self.centre, self.inertia, self.momentum, self.energy = centre, inertia, momentum, energy
        return {
            "mass": ("kg", mass),
            "centre_of_mass": ("m", centre),
            "inertia_tensor": ("kg m^2", inertia),
            "inertia_tensor_space": ("kg m^2", R * inertia * R.T),
            "inertia_tensor_point": ("kg m^2", about_point),
            "moment_of_inertia": ("kg m^2", direction.T * about_point * direction),
            "principal_axes": ("", self.principal, "constants"),
            "principal_moments": ("kg m^2", self.principal, "constants"),
            "translational_energy": ("J", translation),
            "rotational_energy": ("J", energy),
            "kinetic_energy": ("J", translation + energy),
            "angular_momentum_centre": ("kg m^2/s", of_centre),
            "angular_momentum_rotation_body": ("kg m^2/s", momentum),
            "angular_momentum_rotation": ("kg m^2/s", R * momentum),
            "angular_momentum": ("kg m^2/s", of_centre + R * momentum),
            "angular_acceleration_from_torque": ("rad/s^2", lambda x: inertia * x + euler),
        }

    def principal(self, _: Matrix) -> Matrix:
        """E = (e₁ e₂ e₃) is a rotation, and I E = E diag(I₁, I₂, I₃): the e are eigenvectors."""
        printed = printed_in(self.content)
        if not {*PRINCIPAL} <= {*printed}:
            raise Unproved("axes without moments, or moments without axes")
        axes, moments = (self.read(printed[name]) for name in PRINCIPAL)
        pairs = (zip(row, moments.rows, strict=True) for row in axes.rows)
        products = Matrix([entry * moment for entry, (moment,) in row] for row in pairs)
        return Matrix([*is_rotation(axes).entries, *(self.inertia * axes - products).entries])

    def of_motion(self) -> Laws:
        """d'Alembert's principle: W'ᵀ (dL'/dt + Ω' × L') + ∂V/∂q = Q, which is M q̈ + h = Q."""
        if not self.is_free or len(self.q) > 3 or self.definitions:
            raise Unproved("coordinates that depend on one another, or definitions")
        # the body turns about a fixed point, from which places are counted
        self.centre.refuse_unless_zero("the centre of mass")
        motion, W, energy, moving = self.content["motion"], self.W, self.energy, ("q", "q_dot")
        rates, seconds = self.columns["q_dot"], self.columns["q_ddot"]
        second = self.unit_of("q_ddot")
        potential = self.read(motion["potential"], "q")
        forces, torque = (self.read(motion[part], *moving) for part in ("forces", "torque"))
        turning = self.momentum.rate() + self.omega.hat() * self.momentum
        inertial = W.T * turning + Matrix(potential.rate(q).entries for q in self.q)
        balance = inertial - forces - W.T * torque  # zero along a motion
        masses, momenta = W.T * self.inertia * W, W.T * self.momentum
        ONE / masses.determinant()  # or it is refused
        self.names["momenta"] = {f"p_{q}": p for q, p in zip(self.q, momenta.entries, strict=True)}
        return {
            "potential_energy": ("J", potential),
            "lagrangian": ("J", energy - potential),
            "energy": ("J", energy + potential),
            "generalised_momenta": ("kg m^2/s", momenta),
            "mass_matrix": ("kg m^2", masses),
            "bias_vector": ("N m", inertial - masses * seconds),
            "accelerations": (second, lambda x: masses * (x - seconds) + balance, *moving),
            "hamiltonian": ("J", lambda x: x - energy - potential, "q", "momenta"),
            "constant energy": (None, lambda x: x.rate() - rates.T * balance, *moving),
            **{
                f"constant momentum_{q}": (None, lambda x, row=row: x.rate() - row, *moving)
                for q, row in zip(self.q, map(Matrix, balance.rows), strict=True)
            },
        }


def verify(content: Mapping[str, Any]) -> tuple[list[str], dict[str, str]]:
    """What is proved, and why other claims are not; raises one of BROKEN if something is false."""
    proved, reasons, laws, lack = list[str](), dict[str, str](), Laws(), "it has no definition here"
    try:
        record = Record(content)
        laws |= record.of_rotation()
        proved.append("R is a rotation")
        laws |= record.of_body() if "body" in content else {}
        laws |= record.of_motion() if "motion" in content else {}
    except Unproved as error:
        lack = str(error)
    for name, claim in claims_in(content).items():
        try:
            if name not in laws:
                raise Unproved(lack)
            unit, law, *groups = laws[name]
            groups = groups or [*{*record.names} - {"momenta"}]
            x = record.read(claim["expression"], *{*claim.get("inputs", groups)} & {*groups})
            shape = claim.get("shape", [])  # of a vector, without the 1 column
            if claim.get("unit") != unit or [*shape, 1, 1][:2] != x.shape:
                raise Refused(f"{name} has another unit or shape")
            (law(x) if callable(law) else x - law).refuse_unless_zero(name)
            proved.append(name)
        except (Unproved, RecursionError) as error:
            reasons[name] = str(error)
    return proved, reasons


def load(path: Path) -> Any:
    """JSON without double keys; numbers with a point stay text, and NaN is no fraction."""
    text, hook = path.read_text(encoding="utf-8"), without_twins
    return json.loads(text, object_pairs_hook=hook, parse_float=str, parse_constant=Fraction)


if __name__ == "__main__":
    status, records, lines = 0, 0, list[str]()
    for place in map(Path, sys.argv[1:]):
        for path in sorted(place.rglob("*.json")) if place.is_dir() else [place]:
            try:
                content = load(path)
                if place.is_dir() and content.get("schema") != "rigidsym.derivation":
                    lines.append(f"{path}: skipped, since it is no record of a derivation")
                    continue
                records += 1
                proved, reasons = verify(content)
                lines.append(f"{path}: R is {content['rotation']}")
                lines += [f"  {STRENGTH}", f"  proved: {', '.join(proved)}"] if proved else []
                lines += [f"  not proved: {name}, since {why}" for name, why in reasons.items()]
            except (*BROKEN, OSError) as error:
                status = 1
                lines.append(f"{path}: REFUSED: {error}")
    lines += [] if records or status else ["REFUSED: there is no record of a derivation here"]
    print("\n".join(lines).encode("ascii", "backslashreplace").decode())
    sys.exit(status or not records)
