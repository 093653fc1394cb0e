"""Checks certificates without the program that wrote them: `python checker.py FOLDER...`

A record NAME.json holds printed expressions, NAME.cert.json cofactors. Claims are built here from
definitions: R from its turns, d/dt by the chain rule, C(Ω) = dR/dt Rᵀ, C(Ω′) = Rᵀ dR/dt, energies
and momenta from Ω′ and the body. Each must be a sum of cofactors times relations: cos² + sin² = 1,
the square of a root, a divisor times its inverse, stated conditions. A point modulo PRIME where all
of them hold shows that they do not contradict one another and that no divisor is zero.
"""

from __future__ import annotations

import ast
import json
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial
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
PRIME, MOST = 29682952539239999999, 99  # roots to 37 exist modulo PRIME; powers are below MOST
ERRORS = (LookupError, ArithmeticError, AttributeError, TypeError, ValueError, SyntaxError)
BROKEN = (*ERRORS, RecursionError, MemoryError)  # raised for what is refused


class Poly:
    """Coefficients of monomials; a monomial is its names in order, as often as they are factors."""

    def __init__(self, terms: Mapping[tuple[str, ...], Fraction | int]) -> None:
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


class Array:
    """Rows of polynomials; a vector is a column, and a scalar one entry."""

    def __init__(self, rows: Iterable[Iterable[Poly]]) -> None:
        self.rows = [list(row) for row in rows]
        self.entries = [entry for row in self.rows for entry in row]

    @property
    def T(self) -> Array:
        return Array(zip(*self.rows, strict=True))

    def __add__(self, other: Array) -> Array:
        rows = zip(self.rows, other.rows, strict=True)
        return Array([a + b for a, b in zip(*pair, strict=True)] for pair in rows)

    def __mul__(self, factor: Poly | Fraction | int) -> Array:
        return Array([entry * factor for entry in row] for row in self.rows)

    def __matmul__(self, other: Array) -> Array:
        pairs = [[zip(row, column, strict=True) for column in other.T.rows] for row in self.rows]
        return Array([sum((a * b for a, b in pair), ZERO) for pair in row] for row in pairs)


def letter(name: str) -> Poly:
    return Poly({(name,): 1})


def hat(vector: Array) -> Array:  # C(v), the operator v ×
    x, y, z = vector.entries
    return Array([[ZERO, z * -1, y], [z, ZERO, x * -1], [y * -1, x, ZERO]])


def moved(tensor: Array, mass: Array, by: Array) -> Array:  # the parallel-axis theorem
    return tensor + hat(by) @ hat(by) * mass.entries[0] * -1


def rotates(x: Array) -> Arrays:  # the products of columns, and the determinant
    first, second, third = (Array([row]) for row in x.T.rows)
    return x.T @ x, UNITS, first @ hat(second) @ third.T, Array([[ONE]])


Arrays = tuple[Array, ...]  # each of odd number equals the next
Claims = dict[str, Callable[[Array, str], Arrays]]
ZERO, ONE = Poly({}), Poly({(): 1})
UNITS = Array([ONE if j == k else ZERO for k in range(3)] for j in range(3))


class Language:
    """What the texts of a record say, how it changes, and the relations that this needs."""

    def __init__(self, record: Mapping[str, Any], parts: Mapping[str, int]) -> None:
        self.groups = {g["name"]: [c["name"] for c in g["components"]] for g in record["arguments"]}
        self.parts = parts  # of the angle φ, φ/n has a cosine
        self.relations: dict[str, Poly] = {}
        self.flow = dict.fromkeys(("pi", *self.groups.get("parameters", ())), ZERO)  # d/dt
        self.rates, self.second = ([q + d for q in self.groups["q"]] for d in ("_dot", "_ddot"))
        moving = zip(self.groups["q"] + self.rates, self.rates + self.second, strict=True)
        self.flow |= {name: letter(rate) for name, rate in moving}

    def matrix(self, given: Any) -> Array:
        rows = given if isinstance(given, list) else [given]
        return Array(map(self.read, row if isinstance(row, list) else [row]) for row in rows)

    def read(self, given: str | ast.expr, power: int = 1) -> Poly:
        """The power of what a text says; a product is raised factor by factor."""
        match given:
            case str():
                return self.read(ast.parse(" ".join(given.split()), mode="eval").body)
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
                return self.read(left, power) * self.read(
                    right, power * (-1) ** isinstance(op, ast.Div)
                )
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
                found = self.read(left) + self.read(right) * (-1) ** isinstance(op, ast.Sub)
            case ast.BinOp(left=left, op=ast.Pow(), right=ast.Constant(value=int(times))):
                if abs(times * power) > MOST:
                    raise ValueError(f"cannot raise to the power {times}")
                return self.read(left, times * power)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                found = self.read(operand) * -1
            case ast.Constant(value=int(value)):
                found = ONE * value
            case ast.Name(id=name):
                found = letter(name)
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

    def inverse(self, value: Poly) -> Poly:
        """1/value, of which the point shows that it is not zero."""
        if not value.names:
            return ONE * (1 / Fraction(value.terms.get((), 0)))
        if f"sqrt({value})" in self.flow:  # of which the inverse is simpler
            return self.inverse(self.root(value)) * self.inverse(self.root(value))
        x = letter(f"1/({value})")
        return self._new(x, x * value + ONE * -1, x * x * self.rate(value) * -1)

    def root(self, value: Poly) -> Poly:
        """The positive square root; of a whole number, the product of the roots of its factors."""
        whole = 0 if value.names else int(value.terms[()])
        for k in range(2, min(whole, MOST)):
            if whole % k == 0:
                return self.root(ONE * k) * self.root(ONE * (whole // k))
        x, y = letter(f"sqrt({value})"), letter(f"1/(1*sqrt({value}))")
        self._new(x, x * x + value * -1, self.rate(value) * y * Fraction(1, 2))
        self.inverse(x)  # which the rate needs
        return x

    def turn(self, angle: Poly) -> tuple[Poly, Poly]:
        """The cosine and the sine of a sum of multiples of names, by the addition theorems."""
        c, s = ONE, ZERO
        for (name,), times in angle.terms.items():
            part = Fraction(1, self.parts.get(name, 1))
            count, sign = int(times / part), 1 if times > 0 else -1
            if count * part != times or abs(count) > MOST:
                raise ValueError(f"cannot take the cosine of {angle}")
            one, other = letter(f"cos({part}*{name})"), letter(f"sin({part}*{name})")
            relation, rate = one * one + other * other + ONE * -1, self.flow[name] * part
            self._new(one, relation, other * rate * -1)
            self._new(other, relation, one * rate)
            for _ in range(abs(count)):
                c, s = c * one + s * other * -sign, c * other * sign + s * one
        return c, s

    def rate(self, value: Poly, flow: Mapping[str, Poly] | None = None) -> Poly:
        """d/dt by the chain rule; raises KeyError for a letter whose rate is not known."""
        rates = self.flow if flow is None else flow
        return sum((value.derivative(n) * rates[n] for n in sorted(value.names)), ZERO)

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
            axis = hat(Array([v]))
            found = found @ (UNITS + axis * s + axis @ axis * (ONE + c * -1))
        return found


def stated(record: Mapping[str, Any], known: Language, names: Iterable[str]) -> dict[str, Any]:
    """What each of the printed quantities x must satisfy, entry by entry."""
    R = known.rotation(record["rotation"])
    R_dot = Array(map(known.rate, row) for row in R.rows)
    shown, shown_dot = (R.T, R_dot.T) if record["presentation"] == "passive" else (R, R_dot)
    spin = {"space": R_dot @ R.T, "body": R.T @ R_dot}
    omega = {f: Array([[s.rows[2][1]], [s.rows[0][2]], [s.rows[1][0]]]) for f, s in spin.items()}
    steady = {"sqrt", "cos", "sin", "tan", "cot", *known.flow} - {*known.rates}
    given = {f: known.matrix([f"omega_{f}_{k}" for k in (1, 2, 3)]) for f in spin}
    W = {f: Array(map(w.derivative, known.rates) for w in v.entries) for f, v in omega.items()}
    claims: Claims = {
        "rotation_matrix": lambda x, _: (x, shown),
        "rotation_rate": lambda x, _: (x, shown_dot),
        "spin_matrix": lambda x, _: (x, shown_dot @ shown.T),
        "angular_velocity": lambda x, f: (hat(x), spin[f]),
        "angular_acceleration": lambda x, f: (x, Array(map(known.rate, r) for r in omega[f].rows)),
        "rate_matrix": lambda x, f: (x @ known.matrix(known.rates), omega[f]),
        "inverse_rate_matrix": lambda x, f: (W[f] @ x, UNITS),
        "rates_from_angular_velocity": lambda x, f: (W[f] @ x, given[f]),
        "R is a rotation": lambda _, __: rotates(R.T),
    }
    texts = {"R is a rotation": [], **{q["name"]: q["expression"] for q in record["quantities"]}}
    if len(texts) <= len(record["quantities"]):
        raise ValueError("a quantity is printed twice")
    if "body" in record:
        claims |= of_body(known, R, omega["body"], record["body"], texts)
        texts |= {"sum of parts": []} if "parts" in record["body"] else {}
    if "motion" in record:
        claims |= of_motion(known, omega["body"], record, texts)
        texts |= {f"constant {e['name']}": e["expression"] for e in record["first_integrals"]}
    found = {}
    for name in ("R is a rotation", *(name for name in texts if name in names)):
        kind, _, frame = name.rpartition("_")
        text = str(texts[name]).replace("'", "")
        used = {getattr(n, "id", "pi") for n in ast.walk(ast.parse(text))}
        if "rate" in kind and (left := used - steady - {f"omega_{frame}_{k}" for k in "123"}):
            raise ValueError(f"{name} holds {min(left)}")
        sides = (claims.get(name) or claims[kind])(known.matrix(texts[name]), frame)
        pairs = zip(sides[::2], sides[1::2], strict=True)
        found[name] = [e for a, b in pairs for e in zip(a.entries, b.entries, strict=True)]
    return found


def of_body(known: Language, R: Array, w: Array, body: Any, texts: Mapping[str, Any]) -> Claims:
    """With the mass, the centre of mass, and the tensor about it or about a fixed point."""
    m, at, tensor = (known.matrix(body[g]) for g in ("mass", "centre", "inertia"))
    lines = "X Y Z", "X_dot Y_dot Z_dot", "n_x n_y n_z", "p_x p_y p_z"
    r, v, n, p = (known.matrix(line.split()) for line in lines)
    o, t = (known.matrix([f"{g}_{k}" for k in (1, 2, 3)]) for g in ("omega_body", "torque"))
    spun, about = tensor @ w, moved(tensor, m, p + at * -1)
    sums = [m * 0, at * 0, tensor * 0]
    for part in body.get("parts", ()):
        mass, c, own, turn = (known.matrix(part[g]) for g in ("mass", "centre", "inertia", "turn"))
        parts = mass, c @ mass, moved(turn @ own @ turn.T, mass, c + at * -1)
        sums = [total + part for total, part in zip(sums, parts, strict=True)]

    def principal(_: Array, __: str) -> Arrays:
        axes, moments = (known.matrix(texts[f"principal_{g}"]) for g in ("axes", "moments"))
        columns = zip(axes.T.rows, moments.entries, strict=True)
        return *rotates(axes), tensor @ axes, Array([e * k for e in row] for row, k in columns).T

    return {
        "sum of parts": lambda _, __: (sums[0], m, sums[1], at @ m, sums[2], tensor),
        "mass": lambda x, _: (x, m),
        "centre_of_mass": lambda x, _: (x, at),
        "inertia_tensor": lambda x, _: (x, tensor),
        "inertia_tensor_point": lambda x, _: (x, about),
        "moment_of_inertia": lambda x, _: (x, n.T @ about @ n),
        "inertia_tensor_space": lambda x, _: (x, R @ tensor @ R.T),
        **dict.fromkeys(("principal_moments", "principal_axes"), principal),
        "translational_energy": lambda x, _: (x * 2, v.T @ v @ m),
        "rotational_energy": lambda x, _: (x * 2, w.T @ spun),
        "kinetic_energy": lambda x, _: (x * 2, v.T @ v @ m + w.T @ spun),
        "angular_momentum_centre": lambda x, _: (x, hat(r) @ v @ m),
        "angular_momentum_rotation_body": lambda x, _: (x, spun),
        "angular_momentum_rotation": lambda x, _: (x, R @ spun),
        "angular_momentum": lambda x, _: (x, hat(r) @ v @ m + R @ spun),
        "angular_acceleration_from_torque": lambda x, _: (tensor @ x + hat(o) @ tensor @ o, t),
    }


def of_motion(known: Language, w: Array, record: Any, texts: Mapping[str, Any]) -> Claims:
    """With p = ∂T/∂q̇ and M = ∂p/∂q̇, Lagrange's equations d/dt p − ∂(T − V)/∂q = Q."""
    potential, forces = (known.matrix(record["motion"][g]) for g in ("potential", "forces"))
    kinetic = w.T @ known.matrix(record["body"]["inertia"]) @ w * Fraction(1, 2)
    p = Array(map(e.derivative, known.rates) for e in kinetic.entries).T
    mass = Array(map(e.derivative, known.rates) for e in p.entries)
    momenta, whole, free = known.groups["momenta"], kinetic + potential, kinetic + potential * -1
    own = {"energy": whole} | dict(zip(momenta, (Array([[e]]) for e in p.entries), strict=True))

    def bias() -> Array:
        flows = ({n: rate.derivative(d) for n, rate in known.flow.items()} for d in known.rates)
        slopes = Array([known.rate(e, flow) * -1 for e in free.entries] for flow in flows)
        change = Array([known.rate(e)] for e in p.entries)
        return change + mass @ known.matrix(known.second) * -1 + slopes

    def constant(name: str, x: Array, _: str) -> Arrays:
        solved = known.matrix(texts["accelerations"]).entries
        flow = known.flow | dict(zip(known.rates, solved, strict=True))
        return Array([[known.rate(x.entries[0], flow)]]), x * 0, x, own[name]

    def hamiltonian(x: Array, _: str) -> Arrays:
        slope, given = Array([x.entries[0].derivative(n)] for n in momenta), known.matrix(momenta)
        return mass @ slope, given, (x + potential * -1) * 2, given.T @ slope

    constants = {f"constant {n.replace('p_', 'momentum_', 1)}": partial(constant, n) for n in own}
    return constants | {
        "potential_energy": lambda x, _: (x, potential),
        "lagrangian": lambda x, _: (x, free),
        "energy": lambda x, _: (x, whole),
        "generalised_momenta": lambda x, _: (x, p),
        "mass_matrix": lambda x, _: (x, mass),
        "bias_vector": lambda x, _: (x, bias()),
        "accelerations": lambda x, _: (mass @ x + bias(), forces),
        "hamiltonian": hamiltonian,
    }


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


def main(folders: Sequence[str]) -> int:
    """The exit code: 1 if any certificate is refused."""
    problems = 0
    for path in sorted(path for folder in folders for path in Path(folder).rglob("*.cert.json")):
        try:
            record = json.loads(path.with_name(path.name.replace(".cert", "")).read_text("utf-8"))
            certificate = json.loads(path.read_text("utf-8"))
            print(f"{path}: proved for R by {record['rotation']}: {verify(record, certificate)}")
        except (*BROKEN, OSError) as error:
            problems += 1
            print(f"{path}: REFUSED: {error}")
    return int(problems > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
