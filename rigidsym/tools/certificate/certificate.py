"""A record to its certificate: theorems for Coq, in its own real numbers.

`Rotation.v` says what their words mean. Coordinates are functions of time, and rates their
derivatives. F is the rotation. A theorem states what the record prints: that F turns with the
printed Ω, that p is the derivative of the printed L by q̇, that the printed energy has the
derivative 0. Certified is what has a theorem here and is proved by the checker as well.

Facts, by which all proofs calculate, precede the theorems: squares of cosines, and conditions such
as w² + x² + y² + z² = 1 with their derivatives.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache, reduce
from itertools import accumulate, chain, pairwise
from operator import mul
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import (
    BROKEN,
    LETTERS,
    MOST_NUMBER,
    MOST_POWER,
    PRINCIPAL,
    SUM,
    ZERO,
    Matrix,
    Number,
    Record,
    Unproved,
    claims_in,
    read,
    reason,
    turn,
    turn_of,
    verify,
)

Tree = tuple[Any, ...]  # such as ("*", ("number", 2), ("cos", ("name", "phi")))
_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
DEFINITIONS = "Rotation.v"
# Other names get an underscore, so that none is a word of Coq, of Rotation.v or of a proof
_PLAIN = re.compile(
    "(?!([CDFHIMRVabcdestuwy]|v[123])$)([A-Za-z]|alpha|beta|gamma|delta|epsilon|zeta|eta|theta|iota"
    "|kappa|lambda|mu|nu|xi|rho|sigma|tau|upsilon|phi|chi|psi|omega)(_?[0-9]+)*(_d?dot)?"
)
_EXTENSIONALITY = "FunctionalExtensionality.functional_extensionality"
_FIRST = "rotation_matrix", "angular_velocity_space"
# w and u of quaternions w + x i + y j + z k, in the places of a turn: u (w² + x² + y² + z²) = 1
_QUATERNIONS = {
    "unit_quaternion": ("{0}", "1"),
    "quaternion": ("{0}", f"1/{SUM}"),
    "modified_rodrigues": (f"2 - {SUM}", f"1/{SUM}**2"),
}
_TURNS = {"space": "turns", "body": "turns_in_body"}
_ABOUT_POINT = (
    "(add {tensor} (times {M} (mul (transpose (C (plus {point} (scale (-1) {centre}))))"
    " (C (plus {point} (scale (-1) {centre}))))))"
)
_CENTRE = "(scale {M} (cross (V X Y Z) (V X_dot Y_dot Z_dot)))"
_TRANSLATION = "{M} * dot (V X_dot Y_dot Z_dot) (V X_dot Y_dot Z_dot) / 2"
_OF_PRODUCTS = """
Lemma apply_mul A B v : apply (mul A B) v = apply A (apply B v). Proof. entries; ring. Qed.
Lemma apply_plus A v w : apply A (plus v w) = plus (apply A v) (apply A w).
Proof. entries; ring. Qed.
Lemma zero A v : plus v (apply A (V 0 0 0)) = v. Proof. entries; ring. Qed.
""".strip()
_KINETIC = "dot w (apply inertia w) / 2"
# What a quantity of a body is equal to; w is the angular velocity, with components in the body
_OF_BODY = {
    "mass": "{M}",
    "centre_of_mass": "{centre}",
    "inertia_tensor": "inertia",
    "inertia_tensor_space": "mul (mul (F t) inertia) (transpose (F t))",
    "inertia_tensor_point": _ABOUT_POINT,
    "moment_of_inertia": f"dot (V n_x n_y n_z) (apply {_ABOUT_POINT} (V n_x n_y n_z))",
    "translational_energy": _TRANSLATION,
    "rotational_energy": _KINETIC,
    "kinetic_energy": f"{_TRANSLATION} + {_KINETIC}",
    "angular_momentum_centre": _CENTRE,
    "angular_momentum_rotation_body": "apply inertia w",
    "angular_momentum_rotation": "apply (F t) (apply inertia w)",
    "angular_momentum": f"plus {_CENTRE} (apply (F t) (apply inertia w))",
    "potential_energy": "{potential}",
    "lagrangian": f"{_KINETIC} - {{potential}}",
    "energy": f"{_KINETIC} + {{potential}}",
}


class Certificate(NamedTuple):
    """Theorems for Coq about a record, and what they are about."""

    text: str
    claims: Sequence[str]
    uncovered: Sequence[str]  # quantities without a theorem, or that the checker does not prove


def definitions() -> str:
    """The file that every theorem needs."""
    return Path(__file__).with_name(DEFINITIONS).read_text(encoding="utf-8")


def certificate_of(record: Mapping[str, Any]) -> Certificate:
    """Raises CheckError if the checker refuses what is printed."""
    try:
        proved, _ = verify(record)
    except BROKEN as error:
        raise CheckError(f"{record['name']}: no certificate, since {reason(error)}") from error
    return theorems(record, proved[1:])


def theorems(record: Mapping[str, Any], claims: Sequence[str]) -> Certificate:
    """The theorems of those claims that can be stated, whether they are true or not."""
    head, stated = list[str](), dict[str, str]()
    with suppress(Unproved):
        section = (_Chain if record["definitions"] else _Section)(record, claims, stated)
        head = [*section.head()]
        # R and Ω first: what follows is calculated from them as printed, which is shorter
        for name in sorted(claims, key=lambda name: (name not in _FIRST, name == "spin_matrix")):
            with suppress(Unproved):
                stated[name] = section.theorem(name)
    uncovered = [name for name in printed_in(record) if name not in stated]
    rotation = " ".join(record["rotation"].get("turns", ())) or "the matrix of its entries"
    lines = [
        f"(* {record['name']}: R = {rotation}, {record['presentation']}.",
        f"   Compile {DEFINITIONS} first; it defines the words of these theorems.",
        f"   Without a theorem here: {', '.join(uncovered) or 'nothing'}. *)",
        *head,
        *stated.values(),
        *(["End Claims."] if head else []),
    ]
    return Certificate(text="\n".join(lines) + "\n", claims=[*stated], uncovered=uncovered)


def printed_in(record: Mapping[str, Any]) -> dict[str, Any]:
    """The expressions of the quantities and first integrals by their names."""
    return {name: claim["expression"] for name, claim in claims_in(record).items()}


class _Factor(NamedTuple):
    """A turn as a function of s, its angular velocity at t, the proof, and what is in it."""

    text: str
    velocity: str
    proof: str
    trees: Sequence[Tree]


class _Statement(NamedTuple):
    claim: str
    proof: str = "equal t"
    letters: str = ""  # that are in the claim besides t


class _Section:
    """The theorems of one record; later ones may use those in `stated`."""

    definitions: Mapping[str, Tree] = MappingProxyType({})

    def __init__(
        self, record: Mapping[str, Any], claims: Sequence[str], stated: Mapping[str, Any]
    ) -> None:
        self.record, self.claims, self.stated = record, claims, stated
        self.lemmas = dict[str, str]()
        if not claims:
            raise Unproved
        self.names, self.printed = Record(record), printed_in(record)
        letters = chain.from_iterable(letters for letters, _ in LETTERS.values())
        self.own = {*letters, *self.names.definitions}  # names of ours
        self.is_passive = record["presentation"] == "passive"
        self.presented = "(fun s => transpose (F s))" if self.is_passive else "F"
        self.rates, self.seconds = ([q + end for q in self.names.q] for end in ("_dot", "_ddot"))
        self.of_time = {*self.names.q, *self.rates}
        self.speeds = [self.name(rate) for rate in self.rates]
        self.factors = [*self._factors()]
        self.trees_of_rotation = [tree for factor in self.factors for tree in factor.trees]
        self.facts, self.facts_of_rates, self.known = list[str](), list[str](), list[str]()
        self.apart = set[tuple[str, ...]]()
        body, motion = record.get("body"), record.get("motion")
        self.parts = {
            "M": self.text(body["mass"]) if body else "",
            "centre": self.text(body["centre"]) if body else "",
            "potential": self.text(motion["potential"]) if motion else "",
        }

    # Texts of the record in Coq

    def real(self, tree: Tree, at: str = "t", other: Mapping[str, str] | None = None) -> str:
        """A real number at a time; `other` has other texts for some names."""
        kind, *parts = tree
        if kind == "number":
            return str(parts[0])
        if kind == "name":
            return (other or {}).get(parts[0]) or self.name(parts[0], at)
        first = self.real(parts[0], at, other)
        if kind == "**":
            return f"({' * '.join([first] * parts[1]) or '1'})"
        if kind in ("cos", "sin"):
            return f"({kind} {first})"
        second = self.real(parts[1], at, other)
        if kind == "-" and parts[0] == ("number", 0):
            return f"(- {second})"
        if kind == "/" and not _names(parts[1]) - {*self.names.constants, "pi"}:
            return f"({first} * / {second})"  # a constant factor, whose derivative is short
        return f"({first} {kind} {second})"

    def letter(self, name: str) -> str:
        is_plain = name in self.own or _PLAIN.fullmatch(name)
        return name if is_plain else f"{name}_"

    def name(self, name: str, at: str = "t") -> str:
        letter = "PI" if name == "pi" else self.letter(name)
        return f"({letter} {at})" if name in self.of_time else letter

    def text(self, printed: Any, at: str = "t", other: Mapping[str, str] | None = None) -> str:
        """A printed number, vector or matrix."""
        if isinstance(printed, str):
            return self.real(_tree(printed), at, other)
        word = "M" if isinstance(printed[0], list) else "V"
        return f"({word} {' '.join(self.text(part, at, other) for part in printed)})"

    def combination(self, rows: Sequence[Sequence[str]], factors: Sequence[str]) -> str:
        """A matrix times a vector, as the sum over its columns."""
        columns = (self.text([row[k] for row in rows]) for k in range(len(rows[0])))
        terms = (f"(scale {f} {column})" for f, column in zip(factors, columns, strict=True))
        return _nested("plus", [*terms])

    def trees(self, *names: str) -> list[Tree]:
        """All that is printed of some quantities."""
        if not {*names} <= {*self.printed}:
            raise Unproved
        return [*dict.fromkeys(chain(*(_trees(self.printed[name]) for name in names)))]

    def divisors(self, *names: str) -> str:
        """Hypotheses that divisors are not zero, apart from those of F."""
        divisors = _divisors(self.trees(*names))
        texts = [self.real(each) for each in divisors if self.summands(each) not in self.apart]
        return "".join(f"{text} <> 0 -> " for text in dict.fromkeys(texts))

    def summands(self, tree: Tree) -> tuple[str, ...]:
        """The terms of a sum, in an order that does not depend on how it is printed."""
        if tree[0] == "+":
            return tuple(sorted(self.summands(tree[1]) + self.summands(tree[2])))
        return (self.real(tree).replace("(1 * 1)", "1"),)

    def rate(self, angle: Tree) -> Tree:
        """The derivative of a sum of multiples of names."""
        match angle:
            case ("name", name) if name in self.names.q:
                return ("name", f"{name}_dot")
            case ("name" | "number", _):
                return ("number", 0)
            case ("+" | "-" as sign, one, two):
                return (sign, self.rate(one), self.rate(two))
            case ("*", number, part) if not _names(number):
                return ("*", number, self.rate(part))
            case ("/", part, ("number", _) as number):
                return ("/", self.rate(part), number)
        raise Unproved

    # The rotation and its angular velocity

    def _factors(self) -> Iterator[_Factor]:
        rotation = self.record["rotation"]
        if "matrix" in rotation:
            trees = [_tree(text) for row in rotation["matrix"] for text in row]
            yield self._as_printed(self.text(rotation["matrix"], "s"), trees)
            return
        for words in rotation["turns"]:
            kind, forms = turn_of(words)
            trees = [*map(_tree, forms)]
            *axis, cosine, sine = (self.real(tree, "s") for tree in trees)
            is_fixed = not _names(("", *trees[:3])) - {*self.names.constants, "pi"}
            if kind in ("x", "y", "z"):
                angle = trees[3][1]
                function, rate = self.real(angle, "s"), self.real(self.rate(angle))
                velocity = f"(V {' '.join(rate if kind == axis else '0' for axis in 'xyz')})"
                proof = f"apply (turn_{kind}_turns (fun s => {function})); derived t"
                yield _Factor(f"turn_{kind} {function}", velocity, proof, [("cos", angle)])
                continue
            text = f"turn (V {' '.join(axis)}) {cosine} {sine}"
            if is_fixed and kind in ("axis_angle", "constant_turn"):
                rate = self.real(self.rate(trees[3][1])) if kind == "axis_angle" else "0"
                functions = f"(fun s => {cosine}) (fun s => {sine})"
                proof = f"apply (turn_turns (V {' '.join(axis)}) {functions}); cbn; first"
                proof += " [ calculation t | derived t ]"
                yield _Factor(text, f"(scale {rate} (V {' '.join(axis)}))", proof, trees)
            elif len(rotation["turns"]) != 1:
                raise Unproved
            elif kind in _QUATERNIONS:
                places = [f"({place})" for place in words.partition("(")[2][:-1].split(",")]
                w, u = (self.real(_tree(f.format(*places)), "s") for f in _QUATERNIONS[kind])
                functions = " ".join(f"(fun s => {each})" for each in (w, *axis, u, cosine, sine))
                ways = "first [ derivative | intro s; calculation s | calculation t ]"
                proof = f"[ eapply (quaternion_turns {functions}); {ways} | calculation t ]"
                yield self._as_printed(text, trees, f"eapply (same (turns _ t)); {proof}")
            else:
                yield self._as_printed(text, trees)

    def _as_printed(self, text: str, trees: list[Tree], proof: str = "") -> _Factor:
        """F that turns with the printed Ω, which is the claim."""
        if "angular_velocity_space" not in self.claims:
            raise Unproved
        velocity = self.text(self.printed["angular_velocity_space"])
        return _Factor(text, velocity, proof or "turning ltac:(calculation t)", trees)

    def head(self) -> Iterator[str]:
        """Coordinates as functions of time, facts, F, and its angular velocity."""
        names = self.names
        groups = [names.q, self.rates, *([self.seconds] if self.definitions else [])]
        functions = [[*map(self.letter, group)] for group in groups]
        yield "From Coq Require Import Reals Lra. Require Import Rotation.\nOpen Scope R_scope."
        yield "Section Claims."
        if names.constants:
            yield f"Variables {' '.join(map(self.letter, names.constants))} : R."
        yield f"Variables {' '.join(functions[0])} : R -> R. (* coordinates, functions of time *)"
        for one, two in pairwise(functions):
            yield f"Variables {' '.join(two)} : R -> R. (* derivatives of {' '.join(one)} *)"
        for function, rate in chain(*map(zip, functions, functions[1:])):
            slope = f"derivable_pt_lim {function} t ({rate} t)"
            yield f"Hypothesis {function}_is_differentiable : forall t, {slope}."
        for name, tree in self.definitions.items():
            yield f"Definition {name} t := {self.real(tree)}."
        for k, sphere in enumerate(names.spheres):
            yield from self._sphere(k, sphere)
        yield from self._divisors()
        # those of rates are to be tried before squares; without rates, fewer facts are faster
        lists = self.facts_of_rates + self.facts, self.facts, self.facts_of_sums
        using, squares, parts = (f" [{' '.join(facts)}]" if facts else "" for facts in lists)
        known = "; ".join(f"pose proof {fact}" for fact in self.known)
        yield f"Ltac known t := {known or 'idtac'}."
        # an angle may be the sum of two others, whose sines and cosines are printed, too
        sums = f"sums; field{parts}; apart"
        yield "Ltac calculation t :="
        ways = [f"ring{using}", f"known t; field{using}; apart"]  # that is likely comes first
        yield f"  entries; first [ {' | '.join([*ways[:: -1 if self.apart else 1], sums])} ]."
        yield f"Ltac still t := known t; entries; field{squares}; apart."
        if body := self.record.get("body"):
            tensor, fixed = self.text(body["inertia"]), body.get("fixed_point", body["centre"])
            if fixed != body["centre"]:
                tensor = _ABOUT_POINT.format(tensor=tensor, point=self.text(fixed), **self.parts)
            yield f"Definition inertia := {tensor}."
        texts = [factor.text for factor in self.factors]
        product = reduce(lambda right, left: f"mul ({left}) ({right})", reversed(texts))
        yield f"Definition F s := {product}. (* R *)"
        yield f"Ltac equal t := unfold F{', inertia' * ('body' in self.record)}; calculation t."
        way = "still t" if self.apart else "entries; ring"
        yield f"Ltac plain t := unfold F; first [ {way} | calculation t ]."
        yield "Ltac derived t := known t; eapply (same (derivable_pt_lim _ _));"
        yield "  [ derivative | plain t ]."
        yield "Ltac lagrange t := known t; repeat match goal with |- _ /\\ _ => split end;"
        yield "  (eexists; eexists; split; [ derivative | split; [ derivative | equal t ] ])."
        yield from self._turning()

    def _sphere(self, k: int, sphere: Sequence[str]) -> Iterator[str]:
        """A condition Σ n² = 1, and what follows for the rates."""
        first, *rest = (self.name(name) for name in sphere)
        at_s = " + ".join(f"{name} * {name}" for name in (self.name(n, "s") for n in sphere))
        yield f"Hypothesis sphere_{k} : forall s : R, {at_s} = 1."
        others = "".join(f" - {name} * {name}" for name in rest)
        yield f"Lemma square_{k} (t : R) : {first} * {first} = 1{others}."
        yield f"Proof. generalize (sphere_{k} t); lra. Qed."
        if {*sphere} <= {*self.names.q}:
            dot, *dots = (self.name(f"{name}_dot") for name in sphere)
            slopes = "".join(f" - {n} * {d}" for n, d in zip(rest, dots, strict=True))
            # with these three, every order of rewriting ends in the same polynomial
            across = "".join(f" - {dot} * {n} * {n}" for n in rest[1:])
            across += "".join(f" + {first} * {n} * {d}" for n, d in zip(rest, dots, strict=True))
            yield f"Lemma along_{k} t : {first} * {dot} = 0{slopes}."
            yield f"Proof. eassert (H : _ = 0) by (eapply (constant_rate _ t _ 1 sphere_{k});"
            yield "  derivative). lra. Qed."
            yield f"Lemma across_{k} t : {dot} * {rest[0]} * {rest[0]} = {dot}{across}."
            yield f"Proof. pose proof (f_equal (Rmult {dot}) (square_{k} t));"
            yield f"  pose proof (f_equal (Rmult {first}) (along_{k} t)); lra. Qed."
            self.facts_of_rates += [f"(along_{k} t)", f"(across_{k} t)"]
        self.facts.append(f"(square_{k} t)")

    def _divisors(self) -> Iterator[str]:
        """Squares of cosines; divisors in F are not 0."""
        trees = [*self.trees_of_rotation, *self.trees(*self.claims)]
        all_parts = (part for tree in trees for part in _parts(tree))
        angles = [part[1] for part in all_parts if part[0] in ("cos", "sin")]
        self.facts += [f"(squares {text})" for text in dict.fromkeys(map(self.real, angles))]
        parts = (f"(squares {self.name(name)})" for name in sorted(_names(("", *angles))))
        self.facts_of_sums = [*dict.fromkeys((*self.facts, *parts))]
        for k, divisor in enumerate(_divisors(self.trees_of_rotation)):
            yield f"Hypothesis nonzero_{k} : forall t, {self.real(divisor)} <> 0."
            self.known.append(f"(nonzero_{k} t)")
            self.apart.add(self.summands(divisor))

    def _turning(self) -> Iterator[str]:
        """That F turns with the sum of the angular velocities of its turns."""
        for k, factor in enumerate(self.factors, start=1):
            yield f"Lemma step_{k} t : turns (fun s => {factor.text}) t {factor.velocity}."
            yield f"Proof. known t; {factor.proof}. Qed."
        # If A and B turn with Ω_A and Ω_B in space components, A B turns with Ω_A + A Ω_B.
        velocity, proof = self.factors[-1].velocity, f"(step_{len(self.factors)} t)"
        for k in range(len(self.factors) - 1, 0, -1):
            factor = self.factors[k - 1]
            at = re.sub(r"\bs\)", "t)", factor.text)
            velocity = f"(plus {factor.velocity} (apply ({at}) {velocity}))"
            proof = f"(product _ _ t _ _ (step_{k} t) {proof})"
        yield f"Lemma total t : turns F t {velocity}."
        yield f"Proof. exact {proof}. Qed."

    # The claims

    def theorem(self, name: str) -> str:
        """A theorem about what is printed of a quantity; raises Unproved."""
        kind, _, frame = name.rpartition("_")
        if name in _OF_BODY:
            statement = self.of_body(name)
        elif name.startswith("constant "):
            statement = self.constant(name)
        elif law := getattr(self, f"of_{name}", None):
            statement = law(name)
        elif frame in _TURNS and (law := getattr(self, f"of_{kind}", None)):
            statement = law(name, frame)
        else:
            raise Unproved
        return (
            f"Theorem {name.replace(' ', '_')} (t : R){statement.letters} : {statement.claim}.\n"
            f"Proof. intros. {statement.proof}. Qed."
        )

    def is_stated(self, name: str) -> bool:
        """A theorem without premises."""
        return name in self.stated and not self.divisors(name)

    @property
    def total(self) -> str:
        """A theorem that F turns."""
        return f"({_FIRST[1] if self.is_stated(_FIRST[1]) else 'total'} t)"

    @property
    def equal(self) -> str:
        """The tactic for equations in which F may be."""
        is_rewritten = self.is_stated(_FIRST[0]) and not self.is_passive
        return "rewrite ?rotation_matrix; equal t" if is_rewritten else "equal t"

    def need(self, *names: str) -> None:
        """Raise Unproved if there are no theorems about some other quantities."""
        if not {*names} <= {*self.stated, *self.lemmas}:
            raise Unproved

    def of_rotation_matrix(self, name: str) -> _Statement:
        left = "transpose (F t)" if self.is_passive else "F t"
        claim = f"{self.divisors(name)}{left} = {self.text(self.printed[name])}"
        return _Statement(claim, "plain t")

    def of_rotation_rate(self, name: str) -> _Statement:
        claim = f"{self.divisors(name)}rate {self.presented} t {self.text(self.printed[name])}"
        if self.is_stated(_FIRST[0]) and not self.definitions:  # its entries have short derivatives
            printed = f"({_EXTENSIONALITY} {self.presented} _ rotation_matrix)"
            return _Statement(claim, f"rewrite {printed}; repeat split; expand; derived t")
        rate = f"(rate_of_turns _ _ _ {self.total})"
        rate = f"(transpose_rate _ _ _ {rate})" if self.is_passive else rate
        return _Statement(claim, f"apply (same (rate _ t) _ _ {rate}); {self.equal}")

    def of_spin_matrix(self, name: str) -> _Statement:
        """S = D Fᵀ; of the transpose, S = Dᵀ F, which is (Fᵀ D)ᵀ."""
        theorem, change = self.total, ""
        if self.is_passive:
            if not self.is_stated("angular_velocity_body"):
                raise Unproved
            theorem, change = "(angular_velocity_body t)", "apply transpose_rate in d. "
            change += "apply (f_equal transpose) in e. rewrite transposed in e. "
        claim = f"exists D, rate {self.presented} t D /\\ mul D (transpose ({self.presented} t))"
        claim = f"{self.divisors(name)}{claim} = {self.text(self.printed[name])}"
        proof = f"destruct {theorem} as [_ [D [d e]]]. {change}eexists; split; [ exact d | ]. "
        return _Statement(claim, proof + "rewrite e; equal t")

    def turning(self, frame: str, velocity: str, name: str) -> _Statement:
        """F turns with a vector, by the printed angular velocity if that has a theorem."""
        claim, theorem = f"{_TURNS[frame]} F t", f"angular_velocity_{frame}"
        proof = f"apply (same ({claim}) _ _ ({theorem} t)); equal t"
        if not self.is_stated(theorem):
            proof = f"apply {'in_body, ' * (frame == 'body')}(same (turns F t) _ _ {self.total}); "
            proof += self.equal
        return _Statement(f"{self.divisors(name)}{claim} {velocity}", proof)

    def of_angular_velocity(self, name: str, frame: str) -> _Statement:
        return self.turning(frame, self.text(self.printed[name]), name)

    def without_rates(self, name: str) -> str:
        """A remark on what is the same for all rates; else the theorem is true of a false one."""
        if {*self.rates} & _names(("", *self.trees(name))):
            raise Unproved
        return f"(* no rate is in the printed {name} *) "

    def of_rate_matrix(self, name: str, frame: str) -> _Statement:
        statement = self.turning(frame, self.combination(self.printed[name], self.speeds), name)
        return _Statement(self.without_rates(name) + statement.claim, statement.proof)

    def of_inverse_rate_matrix(self, name: str, frame: str) -> _Statement:
        """W W⁻¹ a = a for all vectors a."""
        W = f"rate_matrix_{frame}"
        self.need(W)
        rates = [f"(dot {self.text(row)} (V a b c))" for row in self.printed[name]]
        # For arbitrary a, b and c this is W W⁻¹ = 1.
        claim = f"{self.combination(self.printed[W], rates)} = V a b c"
        return _Statement(self.divisors(name, W) + claim, "still t", " a b c")

    def of_rates_from_angular_velocity(self, name: str, frame: str) -> _Statement:
        W, inverse = others = [f"rate_matrix_{frame}", f"inverse_rate_matrix_{frame}"]
        letters = f" {' '.join(LETTERS[f'omega_{frame}'][0])}"
        equations = zip(self.speeds, map(self.text, self.printed[name]), strict=True)
        premises = "".join(f"{rate} = {text} -> " for rate, text in equations)
        proof = f"rewrite <- ({inverse} t{letters}) by assumption; "
        proof += f"apply (same ({_TURNS[frame]} F t) _ _ ({W} t)); repeat f_equal;"
        proof += " (etransitivity; [ eassumption | plain t ])"
        if not {*others} <= {*self.stated}:
            others, proof = [], self.turning(frame, "", name).proof.rpartition(";")[0]
            proof += "; repeat match goal with H : _ = _ |- _ => rewrite H; clear H end; plain t"
        claim = f"{self.divisors(name, *others)}{premises}{_TURNS[frame]} F t (V{letters})"
        return _Statement(claim, proof, letters)

    def of_angular_acceleration(self, name: str, frame: str) -> _Statement:
        velocity = f"angular_velocity_{frame}"
        if not self.is_stated(velocity):
            raise Unproved
        letters, premises = self.accelerated
        claim = (
            f"{self.divisors(name)}{premises}exists w, (forall s, {_TURNS[frame]} F s (w s)) "
            f"/\\ vector_rate w t {self.text(self.printed[name])}"
        )
        function = f"(fun s => {self.text(self.printed[velocity], 's')})"
        proof = f"exists {function}; split; [ exact {velocity} | repeat split; expand; derived t ]"
        return _Statement(claim, proof, letters)

    @property
    def accelerated(self) -> tuple[str, str]:
        """Letters for the derivatives of the rates, and hypotheses that say what they are."""
        letters = [*map(self.letter, self.seconds)]
        pairs = zip(map(self.letter, self.rates), letters, strict=True)
        premises = (f"derivable_pt_lim {rate} t {second} -> " for rate, second in pairs)
        return f" {' '.join(letters)}", "".join(premises)

    # A body

    def of_body(self, name: str) -> _Statement:
        """An equation of `_OF_BODY`, for the w with which the body turns."""
        right = _OF_BODY[name].format(tensor="inertia", point="(V p_x p_y p_z)", **self.parts)
        claim = f"{self.text(self.printed[name])} = {right}"
        free = sorted({*re.findall(r"\b[XYZ](?:_dot)?\b|\b[pn]_[xyz]\b", claim)})
        letters = "".join(f" {letter}" for letter in free)
        if re.search(r"\bw\b", right):
            return self.for_velocity(claim, name, letters=letters)
        return _Statement(self.divisors(name) + claim, letters=letters)

    def for_velocity(self, claim: str, *names: str, letters: str = "") -> _Statement:
        """A claim for the angular velocity w of the body."""
        velocity = "angular_velocity_body"
        self.need(velocity)
        w, premises = self.text(self.printed[velocity]), self.divisors(velocity, *names)
        proof = f"exists {w}; split; [ apply {velocity}; assumption | repeat split; equal t ]"
        return _Statement(f"{premises}exists w, turns_in_body F t w /\\ {claim}", proof, letters)

    def of_principal_axes(self, _: str) -> _Statement:
        """The columns e of a rotation, and I' e = m e for the moments m."""
        axes, moments = (self.printed[each] for each in PRINCIPAL)
        columns = [self.text([row[k] for row in axes]) for k in range(3)]
        equations = (
            f"apply inertia {column} = scale {self.text(moment)} {column}"
            for column, moment in zip(columns, moments, strict=True)
        )
        claim = " /\\ ".join((f"is_rotation {self.text(axes)}", *equations))
        return _Statement(self.divisors(*PRINCIPAL) + claim, "repeat split; equal t")

    of_principal_moments = of_principal_axes

    def of_angular_acceleration_from_torque(self, name: str) -> _Statement:
        """I' x + Ω' × I' Ω' = N'."""
        omega, torque = " ".join(LETTERS["omega_body"][0]), "torque_1 torque_2 torque_3"
        left = f"plus (apply inertia {self.text(self.printed[name])})"
        left += f" (cross (V {omega}) (apply inertia (V {omega})))"
        return _Statement(f"{self.divisors(name)}{left} = V {torque}", letters=f" {omega} {torque}")

    # Lagrange's equations

    def slope(self, name: str) -> str:
        """The printed L as a function of one name."""
        return f"(fun u => {self.text(self.printed['lagrangian'], 't', {name: 'u'})})"

    def of_generalised_momenta(self, name: str) -> _Statement:
        """∂L/∂q̇ of the printed L."""
        self.need("lagrangian")
        claims = (
            f"derivable_pt_lim {self.slope(rate)} {self.name(rate)} {self.text(text)}"
            for rate, text in zip(self.rates, self.printed[name], strict=True)
        )
        claim = self.divisors(name, "lagrangian") + " /\\ ".join(claims)
        return _Statement(claim, "repeat split; derived t")

    def of_mass_matrix(self, name: str) -> _Statement:
        """A symmetric M with 2 T = q̇ · M q̇, for all rates."""
        masses, rates = self.printed[name], self.speeds
        n = range(len(rates))
        entry = [[self.text(each) for each in row] for row in masses]
        # A symmetric M is determined by its quadratic form, so that 2 T = q̇ᵀ M q̇ for all q̇ says
        # all.
        square = " + ".join(f"{entry[j][k]} * {rates[j]} * {rates[k]}" for j in n for k in n)
        symmetry = (f"{entry[j][k]} = {entry[k][j]}" for j in n for k in range(j))
        # 2 T = Ω′·I′ Ω′
        claims = (f"dot w (apply inertia w) = {square}", *symmetry)
        return self.for_velocity(self.without_rates(name) + " /\\ ".join(claims), name)

    def of_hamiltonian(self, name: str) -> _Statement:
        """T + V, if p has the values of the printed momenta."""
        self.need("generalised_momenta")
        momenta = map(self.text, self.printed["generalised_momenta"])
        values = dict(zip([f"p_{q}" for q in self.names.q], momenta, strict=True))
        energy = f"{_KINETIC} + {self.parts['potential']}"
        claim = f"{self.without_rates(name)}{self.text(self.printed[name], 't', values)} = {energy}"
        return self.for_velocity(claim, name, "generalised_momenta")

    def equations(self, right: Sequence[str]) -> str:
        """dp/dt - ∂L/∂q = right, for the printed L and p."""
        self.need("lagrangian", "generalised_momenta")
        momenta = self.printed["generalised_momenta"]
        claims = (
            f"(exists a b, derivable_pt_lim (fun s => {self.text(p, 's')}) t a /\\ "
            f"derivable_pt_lim {self.slope(q)} {self.name(q)} b /\\ a - b = {side})"
            for q, p, side in zip(self.names.q, momenta, right, strict=True)
        )
        return " /\\ ".join(claims)

    def of_bias_vector(self, name: str) -> _Statement:
        """M q̈ + h, for all q̈."""
        self.need("mass_matrix")
        letters, premises = self.accelerated
        right = []
        for row, h in zip(self.printed["mass_matrix"], self.printed[name], strict=True):
            terms = (f"{self.text(m)} * {q}" for m, q in zip(row, letters.split(), strict=True))
            right.append(" + ".join((*terms, self.text(h))))
        claim = self.divisors(name, "mass_matrix", "lagrangian") + self.equations(right)
        return _Statement(premises + claim, "lagrange t", letters)

    @property
    def along_the_motion(self) -> tuple[str, str]:
        """Letters and hypotheses: the derivatives of the rates are the printed accelerations."""
        letters, premises = self.accelerated
        pairs = zip(letters.split(), self.printed["accelerations"], strict=True)
        equations = "".join(f"{second} = {self.text(text)} -> " for second, text in pairs)
        return letters, self.divisors("accelerations", "lagrangian") + premises + equations

    def of_accelerations(self, _: str) -> _Statement:
        """dp/dt - ∂L/∂q = Q."""
        motion = self.record["motion"]
        if {*motion["torque"]} != {"0"}:
            raise Unproved
        letters, premises = self.along_the_motion
        claim = self.equations([self.text(force) for force in motion["forces"]])
        return _Statement(premises + claim, "subst; lagrange t", letters)

    def constant(self, name: str) -> _Statement:
        """A printed expression whose derivative along every motion is 0."""
        self.need("accelerations")
        letters, premises = self.along_the_motion
        claim = f"{premises}derivable_pt_lim (fun s => {self.text(self.printed[name], 's')}) t 0"
        return _Statement(claim, "subst; derived t", letters)


class _Chain(_Section):
    """Turns T with angular velocities v, whose product is printed in names for its parts.

    By the law of composition (`mechanics/kinematics/chain.py`), each partial product is a short
    expression in the names of the one before, so that all equations are small. A name is recognised
    by its values at random points; Coq proves what it is.
    """

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        record = self.names
        groups = ("parameters", "q", "q_dot", "q_ddot")
        if not {kind for kind, _ in record.turns} <= {*"xyz"} or "body" in self.record:
            raise Unproved
        self.definitions = {name: _tree(text) for name, text in record.definitions.items()}
        self.of_time |= {*self.definitions, *self.seconds}
        angles = [form for _, forms in record.turns for form in forms[3:]]
        texts = [*self.definitions, *angles, *(f"-{angle}" for angle in angles)]
        texts += [*self.rates, *self.seconds, "0", "1", "-1"]
        self.texts = dict[tuple[Any, ...], list[str]]()
        for text, number in zip(texts, record.read(texts, groups).entries, strict=True):
            self.texts.setdefault(tuple(number.values), []).append(text)
        self.T = [f"({factor.text})".replace(" s)", " t)") for factor in self.factors]
        self.v = [factor.velocity for factor in self.factors]
        turns = [turn(*record.read(forms, groups).entries) for _, forms in record.turns]
        pairs = [(T, (T.rate() * T.T()).axis()) for T in turns]
        # their values: P₁ ... Pₙ, w₁ ... wₙ and uₙ ... u₁ of kinematics/chain.py
        self.P = [*accumulate(turns, mul)]
        rest = Matrix([ZERO] * 3)
        self.w = [*accumulate(pairs, lambda w, one: one[1] + one[0].T() * w, initial=rest)][1:]
        self.u = [*accumulate(pairs[::-1], lambda u, one: one[1] + one[0] * u, initial=rest)][1:]

    @property
    def total(self) -> str:
        self.need("space")
        return "(space t)"

    @property
    def equal(self) -> str:
        self.need("matrix")
        return "rewrite ?matrix; equal t"

    def defined(self, *texts: str) -> set[str]:
        """The names in some texts that have a definition."""
        return {*re.findall(r"\w+", " ".join(texts))} & {*self.definitions}

    def named(self, matrix: Matrix, *old: str) -> str:
        """The names of the entries, if they are defined by those in old texts."""
        old_names, definitions = self.defined(*old), self.names.definitions

        def name_of(entry: Number) -> str:
            for text in self.texts.get(tuple(entry.values), ()):
                if text in old_names or self.defined(definitions.get(text, "")) <= old_names:
                    return text
            raise Unproved

        rows = [[*map(name_of, row)] for row in matrix.rows]
        return self.text(rows if len(rows[0]) > 1 else [*chain(*rows)])

    def levels(self, first: str, parts: Iterable[Matrix]) -> list[str]:
        """Names of parts, each defined by those of the one before."""
        return [*accumulate(parts, lambda old, part: self.named(part, old), initial=first)]

    def equation(self, name: str, k: int, claim: str, old: str = "") -> Iterator[str]:
        """About turn k; names are unfolded if they are not in what is old."""
        names = " ".join(sorted(self.defined(claim) - self.defined(old)))
        angle = self.factors[k - 1].trees[0][1]
        square, *parts = (f"(squares {self.real(each)})" for each in _parts(angle) if _names(each))
        ways = f"ring [{square}] | sums; field [{' '.join([square, *parts])}]"
        yield f"Lemma {name}_{k} t{' y' * (name == 'body')} : {claim}."
        yield f"Proof. entries; cbv [Rsqr {names}]; first [ {ways} ]. Qed."

    def _turning(self) -> Iterator[str]:
        yield from super()._turning()
        yield _OF_PRODUCTS
        families = self.matrix, self.space, self.body, self.space_rate, self.body_rate
        for family in (*families, self.space_axes):
            with suppress(Unproved):
                lemmas = [*family()]
                yield from lemmas
                self.lemmas[family.__name__] = "".join(lemmas)

    def matrix(self) -> Iterator[str]:
        """F = Pₙ, by Pₖ = Pₖ₋₁ Tₖ."""
        products = self.levels(self.T[0], self.P[1:])
        pairs = zip(self.T[1:], pairwise(products), strict=True)
        for k, (T, (old, new)) in enumerate(pairs, start=2):
            yield from self.equation("prefix", k, f"mul {old} {T} = {new}", old)
        steps = ", ".join(f"prefix_{k}" for k in range(2, len(products) + 1))
        yield f"Lemma matrix t : F t = {products[-1]}."
        yield f"Proof. unfold F; rewrite <- !associative, {steps}. reflexivity. Qed."

    def space(self) -> Iterator[str]:
        """F turns with u₁, by uₖ = vₖ + Tₖ uₖ₊₁."""
        u = self.levels(self.v[-1], self.u[1:])[::-1]
        for k, (T, v, new, old) in enumerate(zip(self.T, self.v, u, u[1:], strict=False), start=1):
            yield from self.equation("space", k, f"plus {v} (apply {T} {old}) = {new}", old)
        steps = ", ".join(f"<- space_{k}" for k in range(1, len(u)))
        yield f"Lemma space t : turns F t {u[0]}."
        yield f"Proof. rewrite {steps}. exact (total t). Qed."

    def body(self) -> Iterator[str]:
        """F turns with wₙ in the body, by Tₖ wₖ = wₖ₋₁ + vₖ."""
        w = self.levels(self.v[0], self.w[1:])
        for k, (T, v, old, new) in enumerate(zip(self.T, self.v, ["", *w], w, strict=False), 1):
            right = f"(plus {v} (apply {T} y))"
            right = f"plus {old} {right}" if old else right
            yield from self.equation("body", k, f"apply {T} (plus {new} y) = {right}", old)
        steps = ", ".join(f"body_{k}" for k in range(len(w), 0, -1))
        yield f"Lemma body t : turns_in_body F t {w[-1]}."
        yield "Proof. apply in_body, (same (turns F t) _ _ (total t)). unfold F."
        yield f"  rewrite !apply_mul, <- (zero one {w[-1]}), {steps}, <- apply_mul, zero."
        yield "  reflexivity. Qed."

    def space_rate(self) -> Iterator[str]:
        return self.slopes("space_rate", range(len(self.u), 0, -1), self.u)

    def body_rate(self) -> Iterator[str]:
        return self.slopes("body_rate", range(1, len(self.w) + 1), self.w)

    def slopes(self, name: str, places: Iterable[int], parts: Iterable[Matrix]) -> Iterator[str]:
        """The derivatives of angular velocities, from those of the one before."""
        start = new = slope = ""
        for k, part in zip(places, parts, strict=True):
            old, new = new, self.named(part, new)
            before, slope = old + slope, self.named(part.rate(), old, new, slope)
            one = " ".join(sorted(self.defined(new) - self.defined(old)))
            both = " ".join(sorted(self.defined(new, slope) - self.defined(before)))
            function = new.replace(" t)", " s)")
            yield f"Lemma {name}_{k} t : vector_rate (fun s => {function}) t {slope}."
            yield f"Proof. {start}repeat split; cbv [v1 v2 v3] in *; cbv [Rsqr {one}];"
            yield "  (eapply (same (derivable_pt_lim _ _));"
            yield f"  [ derivative | cbv [Rsqr {both}]; ring ]). Qed."
            start = f"destruct ({name}_{k} t) as [? [? ?]]; "

    def space_axes(self) -> Iterator[str]:
        """F turns with the sum of Pₖ₋₁ vₖ."""
        self.need("matrix")
        products = self.levels(self.T[0], self.P[1:-1])
        axes = [f"(apply {P} {v})" for P, v in zip(products, self.v[1:], strict=True)]
        steps = ", ".join(
            f"(apply_plus {P}), <- (apply_mul {P} {T}), prefix_{k}"
            for k, (P, T) in enumerate(zip(products, self.T[1:-1], strict=False), start=2)
        )
        yield f"Lemma space_axes t : turns F t {_nested('plus', [self.v[0], *axes])}."
        yield f"Proof. apply (same (turns F t) _ _ (total t)). rewrite {steps}. reflexivity. Qed."

    def of_rotation_matrix(self, name: str) -> _Statement:
        return super().of_rotation_matrix(name)._replace(proof=self.equal)

    def turning(self, frame: str, velocity: str, name: str) -> _Statement:
        lemma = f"{frame}_axes" if name.startswith("rate_matrix") else frame
        self.need(lemma)
        names = " ".join(sorted(self.defined(velocity) - self.defined(self.lemmas[lemma])))
        claim = f"{_TURNS[frame]} F t"
        proof = f"apply (same ({claim}) _ _ ({lemma} t)); entries; cbv [Rsqr {names}]; ring"
        return _Statement(f"{claim} {velocity}", proof)

    def of_angular_acceleration(self, name: str, frame: str) -> _Statement:
        self.need(frame, f"{frame}_rate")
        claim = f"exists w, (forall s, {_TURNS[frame]} F s (w s)) /\\ vector_rate w t"
        last = 1 if frame == "space" else len(self.w)
        proof = f"eexists; split; [ exact {frame} | apply {frame}_rate_{last} ]"
        return _Statement(f"{claim} {self.text(self.printed[name])}", proof)


def _nested(word: str, parts: Sequence[str]) -> str:
    return reduce(lambda right, left: f"({word} {left} {right})", reversed(parts))


@cache
def _tree(text: str) -> Tree:
    def tree(node: ast.expr) -> Tree:
        match node:
            case ast.Name(name):
                return ("name", name[:-1])
            case ast.Constant(int(number)) if number < MOST_NUMBER:
                return ("number", number)
            case ast.UnaryOp(ast.USub(), operand):
                return ("-", ("number", 0), tree(operand))
            case ast.BinOp(base, ast.Pow(), ast.Constant(int(power))) if 0 < power <= MOST_POWER:
                return ("**", tree(base), power)
            case ast.BinOp(one, operator, two) if type(operator) in _SIGNS:
                return (_SIGNS[type(operator)], tree(one), tree(two))
            case ast.Call(ast.Name("cos_" | "sin_" as function), [angle], []):
                return (function[:-1], tree(angle))
            case ast.Call(ast.Name("tan_" | "cot_" as function), [angle], []):
                parts = ("sin", tree(angle)), ("cos", tree(angle))
                return ("/", *(parts if function == "tan_" else parts[::-1]))
        raise Unproved

    return tree(read(text))


def _trees(printed: Any) -> list[Tree]:
    """All entries of a scalar, a vector or a matrix."""
    return [*chain(*map(_trees, printed))] if isinstance(printed, list) else [_tree(printed)]


def _parts(tree: Tree) -> Iterator[Tree]:
    """A tree and all trees in it."""
    yield tree
    for part in tree[1:]:
        if isinstance(part, tuple):
            yield from _parts(part)


def _names(tree: Tree) -> set[str]:
    return {part[1] for part in _parts(tree) if part[0] == "name"}


def _divisors(trees: Iterable[Tree]) -> list[Tree]:
    """The factors of all divisors, each once, without numbers, which are not zero."""
    divisors: dict[Tree, None] = {}
    factors = [part[2] for tree in trees for part in _parts(tree) if part[0] == "/"]
    while factors:
        factor = factors.pop(0)
        if factor[0] in ("*", "**"):
            factors += [each for each in factor[1:] if isinstance(each, tuple)]
        elif factor[0] != "number":
            divisors[factor] = None
    return [*divisors]
