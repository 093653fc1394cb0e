"""Checks certificates without the program that wrote them: `python checker.py FOLDER...`

Claims about what NAME.json prints are built from definitions; NAME.cert.json makes each a sum of
cofactors times relations, which hold at a point: none contradict, and no divisor is zero.
"""

from __future__ import annotations

import ast
import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

FORMS = {  # a vector v and numbers c and s: R = 1 + s C(v) + (1 - c) C(v)²
    "x": "1; 0; 0; cos({0}); sin({0})",
    "y": "0; 1; 0; cos({0}); sin({0})",
    "z": "0; 0; 1; cos({0}); sin({0})",
    "axis_angle": "{0}; {1}; {2}; cos({3}); sin({3})",
    "constant_turn": "{0}; {1}; {2}; {3}; {4}",
    "unit_quaternion": "{1}; {2}; {3}; -1; 2*{0}",
    "quaternion": "{1}; {2}; {3}; 1 - 2/N; 2*{0}/N",
    "modified_rodrigues": "2*{1}; 2*{2}; 2*{3}; 1 - 2/N**2; 2*(2 - N)/N**2",  # {0} is 1
}
SQUARE = "({0}**2 + {1}**2 + {2}**2 + {3}**2)"  # N
VECTORS = "X Y Z", "X_dot Y_dot Z_dot", "n_x n_y n_z", "p_x p_y p_z", "torque_1 torque_2 torque_3"
PRIME, MOST = 29682952539239999999, 99  # roots to 37 exist modulo PRIME; powers are below MOST
ERRORS = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, SyntaxError)
BROKEN = (*ERRORS, RecursionError, MemoryError)  # raised for what is refused
RATES = "rate_matrix", "inverse_rate_matrix", "rates_from_angular_velocity"  # hold no rates


class Poly:  # coefficients of monomials, which are names in order, as often as they are factors
    def __init__(self, terms: Mapping[tuple[str, ...], Fraction | int] | str) -> None:
        if isinstance(terms, str):  # a name
            terms = {(terms,): 1}
        self.terms = {m: c for m, c in terms.items() if c}
        self.names = {name for m in self.terms for name in m}

    def __add__(self, other: Poly) -> Poly:
        monomials = {**self.terms, **other.terms}
        return Poly({m: self.terms.get(m, 0) + other.terms.get(m, 0) for m in monomials})

    def __mul__(self, other: Poly | Fraction | int) -> Poly:
        total: dict[tuple[str, ...], Fraction | int] = {}
        for n, d in (other.terms if isinstance(other, Poly) else {(): other}).items():
            for m, c in self.terms.items():
                both = tuple(sorted(m + n))
                total[both] = total.get(both, 0) + c * d
        return Poly(total)

    def __str__(self) -> str:
        return " + ".join("*".join((str(c), *m)) for m, c in sorted(self.terms.items())) or "0"

    def derivative(self, name: str) -> Poly:
        whole = {m: (m.index(name), m.count(name) * c) for m, c in self.terms.items() if name in m}
        return Poly({m[:place] + m[place + 1 :]: c for m, (place, c) in whole.items()})


class Array:  # rows of polynomials; a vector is a column, and a scalar one entry
    def __init__(self, rows: Iterable[Iterable[Poly]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Array:
        return Array(zip(*self.rows, strict=True))

    def __add__(self, other: Array) -> Array:
        rows = zip(self.rows, other.rows, strict=True)
        return Array([a + b for a, b in zip(*pair, strict=True)] for pair in rows)

    def __mul__(self, other: Array | Poly | Fraction | int) -> Array:
        if not isinstance(other, Array):
            return Array([entry * other for entry in row] for row in self.rows)
        pairs = [[zip(row, column, strict=True) for column in other.T.rows] for row in self.rows]
        return Array([sum((a * b for a, b in pair), ZERO) for pair in row] for row in pairs)

    def hat(self) -> Array:  # C(v) of a vector v, the operator v ×
        x, y, z = self.entries
        return Array([[ZERO, z * -1, y], [z, ZERO, x * -1], [y * -1, x, ZERO]])

    def rotation_claims(self) -> list[tuple[Poly, Poly]]:  # R Rᵀ = 1 and det R = 1
        lengths = zip((self * self.T).entries, UNITS.entries, strict=True)
        one, two, three = (Array([row]) for row in self.rows)
        return [*lengths, ((one * two.hat() * three.T).entries[0], ONE)]


ZERO, ONE, HALF = Poly({}), Poly({(): 1}), Fraction(1, 2)
UNITS = Array([ONE if j == k else ZERO for k in range(3)] for j in range(3))


class Language:
    """What the texts of a record say, how it changes, and the relations that this needs."""

    def __init__(self, record: Mapping[str, Any], parts: Mapping[str, int]) -> None:
        self.groups = {g["name"]: [c["name"] for c in g["components"]] for g in record["arguments"]}
        self.parts, self.relations = parts, dict[str, Poly]()  # of an angle φ, φ/n has a cosine
        self.meaning, self.momenta = dict[str, Poly](), dict[str, Poly]()  # of names, of p
        self.flow = dict.fromkeys(("pi", *self.groups.get("parameters", ())), ZERO)  # d/dt
        self.rates, self.second = ([q + d for q in self.groups["q"]] for d in ("_dot", "_ddot"))
        rates = map(Poly, self.rates + self.second)
        self.flow |= zip(self.groups["q"] + self.rates, rates, strict=True)

    def matrix(self, given: Any) -> Array:
        rows = given if isinstance(given, list) else [given]
        return Array(map(self.read, row if isinstance(row, list) else [row]) for row in rows)

    def read(self, given: str | ast.expr, power: int = 1) -> Poly:
        """The power of what a text says; a product is raised factor by factor."""
        match given:
            case str():
                return self.read(ast.parse(" ".join(given.split()), mode="eval").body)
            case ast.BinOp(left, ast.Mult() | ast.Div() as op, right):
                sign = -1 if isinstance(op, ast.Div) else 1
                return self.read(left, power) * self.read(right, sign * power)
            case ast.BinOp(left, ast.Add() | ast.Sub() as op, right):
                found = self.read(left) + self.read(right) * (-1) ** isinstance(op, ast.Sub)
            case ast.BinOp(left, ast.Pow(), ast.Constant(int(times))) if abs(times * power) <= MOST:
                return self.read(left, times * power)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                found = self.read(operand) * -1
            case ast.Constant(value=int(value)):
                found = ONE * value
            case ast.Name(id=name):
                found = self.meaning.get(name, Poly(name))
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument]):
                found = self.root(self.read(argument))
            case ast.Call(func=ast.Name(id=name), args=[argument]):
                c, s = self.turn(self.read(argument))
                one, other = {"cos": (c, ONE), "sin": (s, ONE), "tan": (s, c), "cot": (c, s)}[name]
                found = one * self.inverse(other)
            case _:
                raise ValueError(f"cannot read {ast.unparse(given)!r}")
        return math.prod([found if power > 0 else self.inverse(found)] * abs(power), start=ONE)

    def _new(self, x: Poly, relation: Poly, rate: Poly) -> Poly:
        self.relations[str(relation)] = relation
        self.flow |= dict.fromkeys(x.names, rate)
        return x

    def inverse(self, value: Poly) -> Poly:  # 1/value; the point shows that value is not zero
        if not value.names:
            return ONE * (1 / Fraction(value.terms.get((), 0)))
        if f"sqrt({value})" in self.flow:  # of which the inverse is simpler
            return self.inverse(self.root(value)) * self.inverse(self.root(value))
        x = Poly(f"1/({value})")
        return self._new(x, x * value + ONE * -1, x * x * self.rate(value) * -1)

    def root(self, value: Poly) -> Poly:
        """The positive square root; of a whole number, the product of the roots of its factors."""
        whole = 0 if value.names else value.terms[()]
        for k in range(2, min(int(whole), MOST)):
            if whole % k == 0:
                return self.root(ONE * k) * self.root(ONE * (whole // k))
        x, y = Poly(f"sqrt({value})"), Poly(f"1/(1*sqrt({value}))")
        self.inverse(self._new(x, x * x + value * -1, self.rate(value) * y * HALF))  # for the rate
        return x

    def turn(self, angle: Poly) -> tuple[Poly, Poly]:
        """The cosine and the sine of a sum of multiples of names, by the addition theorems."""
        c, s = ONE, ZERO
        for (name,), times in angle.terms.items():
            part = Fraction(1, self.parts.get(name, 1))
            count, sign = int(times / part), 1 if times > 0 else -1
            if count * part != times or abs(count) > MOST:
                raise ValueError(f"cannot take the cosine of {angle}")
            one, other = Poly(f"cos({part}*{name})"), Poly(f"sin({part}*{name})")
            relation, rate = one * one + other * other + ONE * -1, self.flow[name] * part
            self._new(one, relation, other * rate * -1)
            self._new(other, relation, one * rate)
            for _ in range(abs(count)):
                c, s = c * one + s * other * -sign, c * other * sign + s * one
        return c, s

    def rate(self, value: Poly) -> Poly:  # d/dt by the chain rule; KeyError for an unknown letter
        return sum((value.derivative(n) * self.flow[n] for n in sorted(value.names)), ZERO)

    def d(self, x: Array) -> Array:
        return Array(map(self.rate, row) for row in x.rows)

    def slope(self, x: Array) -> Array:  # ∂x/∂q̇
        return Array(map(entry.derivative, self.rates) for entry in x.entries)

    def rotation(self, given: Mapping[str, Any]) -> Array:
        """R, active, as the product of its turns or by its entries, under stated conditions."""
        for value in map(self.read, given["conditions"]):
            rate = self.rate(value)  # it vanishes at all times
            self.relations |= {str(each): each for each in (value, rate, self.rate(rate))}
        found = self.matrix(given["matrix"]) if "matrix" in given else UNITS
        for turn in given.get("turns", ()):
            name, inside = turn.removesuffix(")").split("(", 1)
            form = FORMS[name].replace("N", SQUARE).format(*(f"({p})" for p in inside.split(",")))
            *v, c, s = map(self.read, form.split(";"))
            axis = Array([v]).hat()
            found = found * (UNITS + axis * s + axis * axis * (ONE + c * -1))
        return found


def stated(record: Mapping[str, Any], known: Language, names: Iterable[str]) -> dict[str, Any]:
    """What each of the printed quantities x must satisfy: x = B, A x = B or x q̇ = B, by entries."""
    R, d, slope, read = known.rotation(record["rotation"]), known.d, known.slope, known.matrix
    texts = [(q["name"], q["expression"]) for q in record["quantities"]]
    texts += [("constant " + f["name"], f["expression"]) for f in record["first_integrals"]]
    if len({"R is a rotation", *(printed := dict(texts))}) <= len(texts):
        raise ValueError("two claims have one name")
    found = {"R is a rotation": R.rotation_claims()}
    shown = R.T if record["presentation"] == "passive" else R
    B = {"rotation_matrix": shown, "rotation_rate": d(shown), "spin_matrix": d(shown) * shown.T}
    for f, spin in ("space", d(R) * R.T), ("body", R.T * d(R)):  # C(Ω), C(Ω′)
        w = Array([[spin.rows[2][1]], [spin.rows[0][2]], [spin.rows[1][0]]])
        B[f"angular_velocity_{f}"], B[f"angular_acceleration_{f}"] = w, d(w)
        B[f"rate_matrix_{f}"], B[f"inverse_rate_matrix_{f}"] = w, UNITS
        B[f"rates_from_angular_velocity_{f}"] = omega = read([f"omega_{f}_{k}" for k in "123"])
    A = {f"{k}_{f}": slope(B[f"rate_matrix_{f}"]) for k in RATES[1:] for f in ("space", "body")}
    w = read(printed["angular_velocity_body"]) if "angular_velocity_body" in names else w
    if "body" in record:  # w, as printed if this is proved as well, and omega are those of the body
        m, at, tensor = (read(record["body"][g]) for g in ("mass", "centre", "inertia"))
        r, v, n, p, torque = (read(each.split()) for each in VECTORS)
        arm, orbital, spun = (p + at * -1).hat(), r.hat() * v * m, tensor * w
        moving, turning = v.T * v * m * HALF, w.T * spun * HALF
        B["mass"], B["centre_of_mass"], B["inertia_tensor"] = m, at, tensor
        B["inertia_tensor_point"] = about = tensor + arm.T * arm * m.entries[0]
        B["inertia_tensor_space"], B["moment_of_inertia"] = R * tensor * R.T, n.T * about * n
        B["translational_energy"], B["rotational_energy"] = moving, turning
        B["kinetic_energy"], B["angular_momentum"] = moving + turning, orbital + R * spun
        B["angular_momentum_rotation_body"], B["angular_momentum_rotation"] = spun, R * spun
        B["angular_acceleration_from_torque"] = torque + omega.hat() * tensor * omega * -1
        A["angular_acceleration_from_torque"], B["angular_momentum_centre"] = tensor, orbital
        if "principal_axes" in names and "principal_moments" in names:  # I e = m e
            axes, moments = read(printed["principal_axes"]), read(printed["principal_moments"])
            scaled = [e * m for row in axes.rows for e, m in zip(row, moments.entries, strict=True)]
            pairs = zip((tensor * axes).entries, scaled, strict=True)
            found["principal_axes"] = found["principal_moments"] = [*axes.rotation_claims(), *pairs]
    if "motion" in record:  # Lagrange's equations are 2 dp/dt − ∂(dL/dt)/∂q̇ = M q̈ + h = Q
        u, forces, torque = (read(record["motion"][g]) for g in ("potential", "forces", "torque"))
        forces += slope(w).T * torque
        B["energy"] = B["hamiltonian"] = turning + u
        B["potential_energy"], B["lagrangian"] = u, turning + u * -1
        B["generalised_momenta"] = p = slope(turning).T
        B["mass_matrix"] = A["accelerations"] = mass = slope(p)
        lacking = d(p) * 2 + (slope(d(B["lagrangian"])).T + forces) * -1  # M q̈ + h − Q = 0
        B["accelerations"] = mass * read(known.second) + lacking * -1
        B["bias_vector"] = forces + B["accelerations"] * -1
        B["coriolis_matrix"] = (d(mass) + slope(d(p)) + slope(d(p)).T * -1) * HALF
        B["constant energy"] = read([known.rates]) * lacking
        for q, row, each in zip(known.groups["q"], lacking.rows, p.entries, strict=True):
            B[f"constant momentum_{q}"], known.momenta[f"p_{q}"] = Array([row]), each
    steady = {"sqrt", "cos", "sin", "tan", "cot", *known.flow} - {*known.rates}
    for name, text in ((n, text) for n, text in texts if n in names and n not in found):
        kind, _, frame = name.rpartition("_")
        known.meaning = known.momenta if name == "hamiltonian" else {}
        used = {getattr(n, "id", "pi") for n in ast.walk(ast.parse(str(text).replace("'", "")))}
        left = used - steady - {f"omega_{frame}_{k}" for k in "123"} - {*known.meaning}
        if left and (kind in RATES or name == "hamiltonian"):
            raise ValueError(f"{name} holds {min(left)}")
        x = d(read(text)) if name.startswith("constant ") else read(text)
        x = x * read(known.rates) if kind == RATES[0] else x
        x = A[name] * x if name in A else x
        found[name] = [*zip(x.entries, B[name].entries, strict=True)]
    return found


def verify(record: Mapping[str, Any], certificate: Mapping[str, Any]) -> list[str]:
    """The names of the proved claims; raises ValueError if the cofactors do not prove one."""
    known = Language(record, certificate["parts"])
    ids, at, given = (certificate[key] for key in ("names", "point", "claims"))

    def poly(terms: Sequence[Sequence[Any]]) -> Poly:
        read = ((Fraction(*map(int, c.split("/"))), m) for c, *m in terms)
        return Poly({tuple(sorted(ids[k] for k in m)): c for c, m in read if c.denominator % PRIME})

    found = stated(record, known, given)
    relations = [known.relations[str(poly(terms))] for terms in certificate["relations"]]
    for text, r in known.relations.items():
        terms = [(c.numerator * pow(c.denominator, -1, PRIME), m) for m, c in r.terms.items()]
        if sum(math.prod((int(at[n]) for n in m), start=c) for c, m in terms) % PRIME:
            raise ValueError(f"{text} does not vanish at the point")
    for name, claims in found.items():
        for place, ((one, two), cofactors) in enumerate(zip(claims, given[name], strict=True)):
            products = (poly(terms) * relations[int(k)] for k, terms in cofactors.items())
            if sum(products, one * -1 + two).terms:
                raise ValueError(f"{name}: its cofactors do not prove entry {place + 1}")
    return [*found]


if __name__ == "__main__":
    refused = 0
    for path in sorted(p for folder in sys.argv[1:] for p in Path(folder).rglob("*.cert.json")):
        try:
            files = path.with_name(path.name.replace(".cert", "")), path
            record, certificate = (json.loads(file.read_text("utf-8")) for file in files)
            print(f"{path}: proved for R by {record['rotation']}: {verify(record, certificate)}")
        except (*BROKEN, OSError) as error:
            refused = 1
            print(f"{path}: REFUSED: {error}")
    sys.exit(refused)
