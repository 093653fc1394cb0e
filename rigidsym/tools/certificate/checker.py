"""Checks certificates without the program that wrote them: `python checker.py FOLDER...`

A record NAME.json holds printed expressions, and NAME.cert.json cofactors. Each claim is built here
from its definition: R from its turns or its quaternion, d/dt by the chain rule, C(Ω) = dR/dt Rᵀ,
C(Ω′) = Rᵀ dR/dt. It is that a polynomial vanishes, and that polynomial must be the sum of cofactors
times relations: cos² + sin² = 1, the square of a root, a divisor times its inverse, and conditions
that are stated. Nothing is used but whole numbers, fractions and the standard library of Python.
"""

from __future__ import annotations

import ast
import json
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import partial, reduce
from pathlib import Path
from typing import Any

THREE = "({0}**2 + {1}**2 + {2}**2)"
FOUR = "({0}**2 + {1}**2 + {2}**2 + {3}**2)"
FORMS = {  # a vector v and numbers c and s, in the coordinates: R = 1 + s C(v) + (1 - c) C(v)²
    "quaternion": f"{{1}}; {{2}}; {{3}}; 1 - 2/{FOUR}; 2*{{0}}/{FOUR}",
    "unit_quaternion": f"{{1}}; {{2}}; {{3}}; 1 - 2/{FOUR}; 2*{{0}}/{FOUR}",
    "cayley_klein": f"{{3}}; {{2}}; {{1}}; 1 - 2/{FOUR}; 2*{{0}}/{FOUR}",
    "axis_angle": "{0}; {1}; {2}; cos({3}); sin({3})",
    "rotation_vector": "{0}/L; {1}/L; {2}/L; cos(L); sin(L)".replace("L", f"sqrt{THREE}"),
    "gibbs_vector": f"{{0}}; {{1}}; {{2}}; 1 - 2/(1 + {THREE}); 2/(1 + {THREE})",
    "modified_rodrigues": f"2*{{0}}; 2*{{1}}; 2*{{2}}; 1 - 2/(1 + {THREE})**2;"
    f"2*(1 - {THREE})/(1 + {THREE})**2",
}
UNIT = {"unit_quaternion": 4, "cayley_klein": 4, "axis_angle": 3}  # coordinates of length one
PRESETS = {  # turns from left to right; the record says whether Rᵀ is presented
    **dict.fromkeys(("lecture_angles", "goldstein", "landau_lifshitz", "wertz", "bunge"), "ZXZ"),
    **{"aerospace": "ZYX", "rpy": "xyz", "davenport": "z({0}) x({1}) [0,b,c]({2})"},
}
AXES = {"x": "1,0,0", "y": "0,1,0", "z": "0,0,1"}
COSINES: dict[Any, str] = {0: "1", 2: "sqrt(3)/2", 3: "sqrt(2)/2", 4: "1/2", 6: "0"}  # of kπ/12
TURN = r"\s*(?:\[([^][]+)\]|([xyz]))\s*\(([^()]+)\)\s*"


class RefusedError(Exception):
    """A claim that is not proved, or a record that this program cannot read."""


class Poly:
    """Coefficients of monomials; a monomial is its names in order, as often as they are factors."""

    def __init__(self, terms: Mapping[tuple[str, ...], Fraction | int]) -> None:
        self.terms = {m: c for m, c in terms.items() if c}
        self.names = {name for m in self.terms for name in m}

    def __add__(self, other: Poly | int) -> Poly:
        total = dict(self.terms)
        for m, c in (other if isinstance(other, Poly) else Poly({(): other})).terms.items():
            total[m] = total.get(m, 0) + c
        return Poly(total)

    def __mul__(self, other: Poly | Fraction | int) -> Poly:
        total: dict[tuple[str, ...], Fraction | int] = {}
        for m, c in self.terms.items():
            for n, d in (other if isinstance(other, Poly) else Poly({(): other})).terms.items():
                both = tuple(sorted(m + n))
                total[both] = total.get(both, 0) + c * d
        return Poly(total)

    __radd__, __rmul__ = __add__, __mul__

    def __sub__(self, other: Poly | int) -> Poly:
        return self + -1 * other

    def __str__(self) -> str:
        return " + ".join("*".join((str(c), *m)) for m, c in sorted(self.terms.items())) or "0"

    def derivative(self, name: str) -> Poly:
        whole = {m: (m.index(name), m.count(name) * c) for m, c in self.terms.items() if name in m}
        return Poly({m[:place] + m[place + 1 :]: c for m, (place, c) in whole.items()})


Matrix = list[list[Poly]]
Equation = tuple[Poly, Poly]
Change = Callable[[Poly], Poly]
BROKEN = (RefusedError, LookupError, ArithmeticError, AttributeError, TypeError, ValueError)
ZERO, ONE = Poly({}), Poly({(): 1})


class Language:
    """The names of a record, how they change in time, and the relations between them."""

    def __init__(self, record: Mapping[str, Any], parts: Mapping[str, int]) -> None:
        groups = record["arguments"]
        self.arguments = {g["name"]: [c["name"] for c in g["components"]] for g in groups}
        names = [n for g in ("q", "q_dot", "q_ddot") for n in self.arguments[g]]
        if len(set(names)) < len(names) or not all(map(str.isidentifier, names)):
            raise RefusedError(f"the names {', '.join(names)} are not different names")
        self.parts = dict(parts)  # of the angle φ, φ/n has a cosine and a sine
        self.relations: dict[str, Poly] = {}
        self.values = {n: Poly({(n,): 1}) for g in self.arguments.values() for n in ("pi", *g)}
        self.rates = {n: (lambda: ZERO) for n in self.arguments.get("parameters", ())}
        for one, two in (("q", "q_dot"), ("q_dot", "q_ddot")):
            pairs = zip(*map(self.arguments.__getitem__, (one, two)), strict=True)
            self.rates |= {name: partial(self.values.__getitem__, rate) for name, rate in pairs}
        self.at = {name: 0.7 + 0.1 * place for place, name in enumerate(self.values)}  # a point

    def read(self, text: str) -> Poly:
        try:
            return self._value(ast.parse(text.strip(), mode="eval").body)
        except (SyntaxError, KeyError, RecursionError) as error:
            raise RefusedError(f"cannot read {text!r}: {error}") from error

    def _value(self, node: ast.expr) -> Poly:
        match node:
            case ast.Constant(value=int(value)):
                return ONE * value
            case ast.Name(id=name):
                return self.values[name]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -1 * self._value(operand)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                base, exponent = self._value(left), self._value(right)
                power = Fraction(exponent.terms.get((), 0))
                if exponent.names or power.denominator > 2 or abs(power) > 99:
                    raise RefusedError(f"cannot raise to the power {exponent}")
                base = self.root(base) if power.denominator == 2 else base
                base = self.inverse(base) if power < 0 else base
                return math.prod([base] * abs(power.numerator), start=ONE)
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return self._value(left) * self._inverse(right)
            case ast.BinOp(left=left, op=op, right=right):
                acts = {ast.Add: Poly.__add__, ast.Sub: Poly.__sub__, ast.Mult: Poly.__mul__}
                return acts[type(op)](self._value(left), self._value(right))
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                return self.root(self._value(argument))
            case ast.Call(func=ast.Name(id=name), args=[argument]):
                c, s = self.turn(self._value(argument))
                if name in ("tan", "cot"):
                    return s * self.inverse(c) if name == "tan" else c * self.inverse(s)
                return {"cos": c, "sin": s}[name]
        raise RefusedError(f"cannot read {ast.unparse(node)!r}")

    def _inverse(self, node: ast.expr) -> Poly:
        match node:
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return self._inverse(left) * self._inverse(right)
            case ast.BinOp(left=base, op=ast.Pow(), right=ast.Constant(value=int(times))):
                return math.prod([self._inverse(base)] * times, start=ONE)
        return self.inverse(self._value(node))

    def sample(self, value: Poly) -> float:
        """Its value at a point that satisfies the relations."""
        return sum(float(c) * math.prod(self.at[n] for n in m) for m, c in value.terms.items())

    def new(self, name: str, at: float, relation: Change, rate: Change) -> Poly:
        """A name x with relation(x) = 0 and dx/dt = rate(x), and its value at the point."""
        self.at[name] = at
        found = Poly({(name,): 1})
        self.rates[name] = lambda: rate(found)
        self.relations[str(relation(found))] = relation(found)
        return found

    def inverse(self, value: Poly) -> Poly:
        """1/value, which is taken not to be zero."""
        if not value.terms:
            raise RefusedError("an expression divides by zero")
        size = 1 / Fraction(min(value.terms.items())[1])
        if not value.names:
            return ONE * size
        value, at = value * size, self.sample(value * size)
        if f"sqrt({value})" in self.at:  # of which the inverse is simpler
            return math.prod([self.inverse(self.root(value))] * 2, start=ONE * size)
        if abs(at) < 1e-9:
            raise RefusedError(f"{value} is a divisor, and vanishes")
        rate = lambda x: -1 * x * x * self.rate(value)  # noqa: E731
        return size * self.new(f"1/({value})", 1 / at, lambda x: x * value - 1, rate)

    def root(self, value: Poly) -> Poly:
        """The positive root; squares are taken out of numbers."""
        outside = Fraction(1)
        if not value.names:
            size = Fraction(value.terms.get((), 0))
            whole = size.numerator * size.denominator
            square = max(k for k in range(1, math.isqrt(whole) + 1) if whole % k**2 == 0)
            outside, value = Fraction(square, size.denominator), ONE * (whole // square**2)
        if str(value) == "1":
            return ONE * outside
        rate = lambda x: self.rate(value) * self.inverse(2 * x)  # noqa: E731
        return outside * self.new(
            f"sqrt({value})", self.sample(value) ** 0.5, lambda x: x * x - value, rate
        )

    def turn(self, angle: Poly) -> tuple[Poly, Poly]:
        """The cosine and the sine of a sum of multiples of names, by the addition theorems."""
        c, s = ONE, ZERO
        for name, times in angle.terms.items():
            if len(name) != 1:
                raise RefusedError(f"cannot take the cosine of {angle}")
            one, other = self._turn(name[0], Fraction(times))
            c, s = c * one - s * other, c * other + s * one
        return c, s

    def _turn(self, name: str, times: Fraction) -> tuple[Poly, Poly]:
        if name == "pi":
            return self._cosine(times * 12), self._cosine(times * 12 - 6)
        parts = self.parts[name] = math.lcm(self.parts.get(name, 1), times.denominator)
        text = name if parts == 1 else f"{name}/{parts}"
        c, s = (Poly({(f"{function}({text})",): 1}) for function in ("cos", "sin"))
        relation = c * c + s * s - 1
        self.relations[str(relation)] = relation
        self.at[f"cos({text})"] = math.cos(self.at[name] / parts)
        self.at[f"sin({text})"] = math.sin(self.at[name] / parts)
        self.rates[f"cos({text})"] = lambda: s * self.rates[name]() * Fraction(-1, parts)
        self.rates[f"sin({text})"] = lambda: c * self.rates[name]() * Fraction(1, parts)
        found = ONE, ZERO
        for _ in range(abs(int(times * parts))):
            found = found[0] * c - found[1] * s, found[0] * s + found[1] * c
        return found if times > 0 else (found[0], -1 * found[1])

    def _cosine(self, twelfths: Fraction) -> Poly:
        size = min(twelfths % 24, -twelfths % 24)
        return self.read(COSINES[size] if size <= 6 else f"-({COSINES[12 - size]})")

    def rate(self, value: Poly) -> Poly:
        """d/dt; raises KeyError for a name whose rate is not known."""
        return sum((value.derivative(n) * self.rates[n]() for n in sorted(value.names)), ZERO)

    def assume(self, value: Poly) -> None:
        """Take an expression to vanish at all times, and with it its first two derivatives."""
        for _ in range(3):
            if value.terms:
                self.relations[str(value)] = value
            if not value.names <= self.rates.keys():
                return
            value = self.rate(value)

    def assume_unit(self, vector: Sequence[Poly]) -> None:
        length = sum(self.sample(part) ** 2 for part in vector) ** 0.5
        self.at |= {name: self.at[name] / length for part in vector for name in part.names}
        self.assume(dot(vector, vector) - 1)

    def rotation(self, request: Mapping[str, Any]) -> Matrix:
        """R, active, as the request defines it."""
        q, name = self.arguments["q"], request.get("sequence", "")
        q = [*q[-1:], *q[:-1]] if request.get("scalar_last") else q
        if "matrix" in request or name == "direction_cosines":
            entries = request.get("matrix") or [q[k : k + 3] for k in (0, 3, 6)]
            matrix = [[self.read(entry) for entry in row] for row in entries]
            for text in request.get("constraints") or ():
                self.assume(self.read(text))
            for one, two in orthogonal(matrix) if name else ():
                self.assume(one - two)
            return matrix
        if name in UNIT:
            self.assume_unit([self.values[part] for part in q[: UNIT[name]]])
        if name in FORMS:
            *v, cosine, sine = (self.read(part) for part in FORMS[name].format(*q).split(";"))
            return turned(v, cosine, sine)
        turns = self._turns(PRESETS.get(name, name).format(*q), request.get("angles") or q)
        return reduce(product, turns)

    def _turns(self, text: str, angles: Sequence[str]) -> Iterator[Matrix]:
        text = text.translate(str.maketrans("123", "XYZ")) if text.isdigit() else text
        if re.fullmatch("[xyz]{3}|[XYZ]{3}", text):  # about fixed axes, later turns stand left
            pairs = [*zip(text.lower(), angles, strict=True)][:: -1 if text.islower() else 1]
            text = " ".join(f"{axis}({angle})" for axis, angle in pairs)
        if not re.fullmatch(f"({TURN})+", text):
            raise RefusedError(f"cannot read the rotation {text!r}")
        for vector, letter, angle in re.findall(TURN, text):
            axis = [self.read(part) for part in (vector or AXES[letter]).split(",")]
            if dot(axis, axis).names:  # letters in an axis make it a unit vector
                self.assume_unit(axis)
            length = ONE if dot(axis, axis).names else self.root(dot(axis, axis))
            unit = [part * self.inverse(length) for part in axis]
            yield turned(unit, *self.turn(self.read(angle)))


def dot(first: Sequence[Poly], second: Sequence[Poly]) -> Poly:
    return sum((a * b for a, b in zip(first, second, strict=True)), ZERO)


def product(first: Matrix, second: Matrix) -> Matrix:
    return [[dot(row, column) for column in zip(*second, strict=True)] for row in first]


def transposed(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def hat(v: Sequence[Poly]) -> Matrix:
    """C(v), the operator v ×."""
    return [[ZERO, -1 * v[2], v[1]], [v[2], ZERO, -1 * v[0]], [-1 * v[1], v[0], ZERO]]


def turned(axis: Sequence[Poly], cosine: Poly, sine: Poly) -> Matrix:
    """1 + sin β C(e) + (1 − cos β) C(e)²."""
    square = product(hat(axis), hat(axis))
    rows = zip(UNITS, hat(axis), square, strict=True)
    return [[a + sine * b + (ONE - cosine) * c for a, b, c in zip(*r, strict=True)] for r in rows]


def orthogonal(m: Matrix) -> list[Equation]:
    """M Mᵀ = 1 and det M = 1."""
    volume = dot(m[0], [entry for (entry,) in product(hat(m[1]), transposed([m[2]]))])
    return [*sides(product(m, transposed(m)), UNITS), (volume, ONE)]


def sides(first: Matrix, second: Matrix) -> list[Equation]:
    """The equations between the entries of two matrices."""
    return [pair for rows in zip(first, second, strict=True) for pair in zip(*rows, strict=True)]


UNITS = [[ONE if j == k else ZERO for k in range(3)] for j in range(3)]


def claims(record: Mapping[str, Any], known: Language) -> Iterator[tuple[str, list[Equation]]]:
    """What each printed quantity says, entry by entry."""
    R = known.rotation(record["request"]["rotations"][0])
    R_dot = [[*map(known.rate, row)] for row in R]
    yield "R is a rotation", orthogonal(R)
    spins = {"space": product(R_dot, transposed(R)), "body": product(transposed(R), R_dot)}
    is_passive = record["presentation"] == "passive"
    shown, shown_dot = map(transposed, (R, R_dot)) if is_passive else (R, R_dot)
    shown_spin, q_dot = product(shown_dot, transposed(shown)), known.arguments["q_dot"]
    for definition in record["definitions"]:
        known.values[definition["name"]] = known.read(definition["expression"])
    for quantity in record["quantities"]:
        name = quantity["name"]
        frame = "body" if name.endswith("body") else "space"
        kind, spin = name.removesuffix(f"_{frame}"), spins[frame]
        omega = [[spin[j][k]] for j, k in ((2, 1), (0, 2), (1, 0))]
        right = {
            "rotation_matrix": shown,
            "rotation_rate": shown_dot,
            "spin_matrix": shown_spin,
            "angular_velocity": spin,
            "rate_matrix": omega,
            "inverse_rate_matrix": UNITS,
            "rates_from_angular_velocity": [
                [known.values[f"omega_{frame}_{k}"]] for k in (1, 2, 3)
            ],
            "angular_acceleration": [[*map(known.rate, row)] for row in spin if "accel" in kind],
        }
        if kind not in right:
            continue
        rows = (row if isinstance(row, list) else [row] for row in quantity["expression"])
        left = [[*map(known.read, row)] for row in rows]
        words = re.findall(r"\w+", " ".join(str(entry) for row in left for entry in row))
        if kind == "rate_matrix" and not set(words).isdisjoint(q_dot):
            raise RefusedError(f"{name} holds a rate")
        if kind in ("angular_velocity", "angular_acceleration"):
            left = hat(*transposed(left))
        elif kind == "rate_matrix":
            left = product(left, [[known.values[rate]] for rate in q_dot])
        elif kind in ("inverse_rate_matrix", "rates_from_angular_velocity"):
            left = product([[entry.derivative(rate) for rate in q_dot] for (entry,) in omega], left)
        yield name, sides(left, right[kind])


def verify(record: Mapping[str, Any], certificate: Mapping[str, Any]) -> dict[str, list[Equation]]:
    """The claims, all of them proved by the cofactors; raises RefusedError for one that is not."""
    known = Language(record, certificate["parts"])
    found = dict(claims(record, known))
    names = certificate["names"]

    def poly(terms: Sequence[Sequence[Any]]) -> Poly:
        return Poly({tuple(sorted(names[k] for k in m)): Fraction(c) for c, *m in terms})

    relations = [poly(terms) for terms in certificate["relations"]]
    for relation in relations:
        if str(relation) not in known.relations:
            raise RefusedError(f"{relation} = 0 is no relation of this record")
    for name, entries in found.items():
        cofactors = certificate["claims"].get(name, [])
        if len(cofactors) != len(entries):
            raise RefusedError(f"{name}: {len(entries)} entries, cofactors for {len(cofactors)}")
        for place, ((one, two), given) in enumerate(zip(entries, cofactors, strict=True), start=1):
            terms = (poly(terms) * relations[int(k)] for k, terms in given.items())
            if (one - two - sum(terms, ZERO)).terms:
                raise RefusedError(f"{name}: its cofactors do not prove entry {place}")
    return found


def main(folders: Sequence[str]) -> int:
    """The exit code: 1 if any certificate is refused."""
    problems = 0
    for path in sorted(path for folder in folders for path in Path(folder).rglob("*.cert.json")):
        try:
            record = json.loads(path.with_name(path.name.replace(".cert", "")).read_text("utf-8"))
            found = verify(record, json.loads(path.read_text("utf-8")))
            print(f"{path}: proved: {', '.join(found)}")
        except (*BROKEN, OSError) as error:
            problems += 1
            print(f"{path}: REFUSED: {error}")
    return int(problems > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
