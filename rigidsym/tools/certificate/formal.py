"""A record as theorems for Coq, in its own real numbers: `Rotation.v` says what their words mean.

Coordinates are functions of time, and rates their derivatives. F is the rotation. A theorem states
what the record prints: that F turns with the printed Ω, that p is the derivative of the printed L
by q̇, that the printed energy has the derivative 0. `certificate_of` certifies only claims that
have a theorem here.

Facts, by which all proofs calculate, precede the theorems: squares of cosines and roots, and
conditions such as w² + x² + y² + z² = 1 with their derivatives.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

from rigidsym.tools.certificate.checker import (
    FUNCTIONS,
    PRINCIPAL,
    SQUARES,
    TURNS,
    Names,
    Tree,
    names_in,
    printed_in,
    tree_of,
)

DEFINITIONS = "Rotation.v"
# A coordinate with a name that Coq, its real numbers or Rotation.v use gets an underscore
_WORDS = """
as at cofix else end exists fix for forall fun if in let match mod Prop return Set then Type using
where with R cos sin sqrt tan PI V M C I v1 v2 v3 row1 row2 row3 vec mat dot plus scale cross apply
transpose mul add times det one turn turn_x turn_y turn_z is_rotation rate vector_rate turns
turns_in_body product squares F shown t s u w a b c inertia value derivative entries expand
"""
_TAKEN = frozenset(_WORDS.split())
_VALUE = "eapply value; [ derivative | try ring; field ]"
_TURNS = {"space": "turns", "body": "turns_in_body"}
_ABOUT_POINT = (
    "(add inertia (times {M} (mul (transpose (C (plus (V p_x p_y p_z) (scale (-1) {centre}))))"
    " (C (plus (V p_x p_y p_z) (scale (-1) {centre}))))))"
)
_CENTRE = "(scale {M} (cross (V X Y Z) (V X_dot Y_dot Z_dot)))"
_KINETIC = "dot w (apply inertia w) / 2"
_TRANSLATION = "{M} * dot (V X_dot Y_dot Z_dot) (V X_dot Y_dot Z_dot) / 2"
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


def definitions() -> str:
    """The file that every theorem needs."""
    return Path(__file__).with_name(DEFINITIONS).read_text(encoding="utf-8")


class Unstated(ValueError):
    """There is no theorem for this."""


def coq(record: Mapping[str, Any], claims: Sequence[str]) -> str:
    """The theorems of those claims that can be stated, in the order of the record."""
    head, stated = theorems(record, claims)
    missing = [name for name in claims if name not in stated]
    rotation = " ".join(record["rotation"].get("turns", ())) or "the matrix of its entries"
    return "\n".join(
        [
            f"(* {record['name']}: R = {rotation}, {record['presentation']}.",
            f"   Compile {DEFINITIONS} first; it defines the words of these theorems.",
            f"   Without a theorem here: {', '.join(missing) or 'nothing'}. *)",
            "Require Import Reals Lra Rotation.",
            "Open Scope R_scope.",
            *head,
            *(line for lines in stated.values() for line in lines),
            *(["End Claims."] if head else []),
            "",
        ]
    )


def theorems(
    record: Mapping[str, Any], claims: Sequence[str]
) -> tuple[list[str], dict[str, list[str]]]:
    """What precedes all theorems, and those of each claim that can be stated."""
    stated: dict[str, list[str]] = {}
    try:
        section = _Section(record, claims, stated)
        head = [*section.head()]
    except Unstated:
        return [], {}
    for name in claims:
        try:
            stated[name] = [*section.theorem(name)]
        except Unstated:
            continue
    return head, stated


@dataclass(frozen=True, slots=True)
class _Factor:
    """A turn as a function of s, its angular velocity at t, the proof, and what is in it."""

    text: str
    velocity: str
    proof: str
    trees: Sequence[Tree]


class _Section:
    """The theorems of one record; later ones may use those in `stated`."""

    def __init__(
        self, record: Mapping[str, Any], claims: Sequence[str], stated: Mapping[str, Any]
    ) -> None:
        self.record, self.claims, self.stated = record, claims, stated
        self.names, self.printed = Names(record), printed_in(record)
        self.is_passive = record["presentation"] == "passive"
        self.shown = "shown" if self.is_passive else "F"
        self.factors = [*self._factors()]
        self.facts, self.known, self.apart = list[str](), list[str](), set[tuple[str, ...]]()
        body, motion = record.get("body"), record.get("motion")
        self.parts = {
            "M": self.text(body["mass"]) if body else "",
            "centre": self.text(body["centre"]) if body else "",
            "potential": self.text(motion["potential"]) if motion else "",
        }

    # Texts of the record in Coq

    def letter(self, name: str) -> str:
        return f"{name}_" if name in _TAKEN else name

    def real(self, tree: Tree, at: str = "t", other: Mapping[str, str] | None = None) -> str:
        """A real number at a time; `other` has other texts for some names."""
        kind, *parts = tree
        if kind == "number":
            return str(parts[0])
        if kind == "name":
            return (other or {}).get(parts[0]) or self.name(parts[0], at)
        first = self.real(parts[0], at, other)
        if kind == "**":
            product = f"({' * '.join([first] * abs(parts[1]))})" if parts[1] else "1"
            return product if parts[1] >= 0 else f"(1 / {product})"
        if kind in FUNCTIONS:
            cosine, sine = f"(cos {first})", f"(sin {first})"
            quotients = {"tan": f"({sine} / {cosine})", "cot": f"({cosine} / {sine})"}
            return quotients.get(kind, f"({kind} {first})")
        second = self.real(parts[1], at, other)
        if kind == "-" and parts[0] == ("number", 0):
            return f"(- {second})"
        if kind == "/" and not names_in(parts[1]) - {*self.names.constant}:
            return f"({first} * / {second})"  # a constant factor, whose derivative is short
        return f"({first} {kind} {second})"

    def name(self, name: str, at: str = "t") -> str:
        of_time = {*self.names.q, *self.names.rates, *self.names.definitions}
        letter = "PI" if name == "pi" else self.letter(name)
        return f"({letter} {at})" if name in of_time else letter

    def text(self, printed: Any, at: str = "t", other: Mapping[str, str] | None = None) -> str:
        """A printed number, vector or matrix."""
        if isinstance(printed, str):
            return self.real(tree_of(printed), at, other)
        word = "M" if isinstance(printed[0], list) else "V"
        return f"({word} {' '.join(self.text(part, at, other) for part in printed)})"

    def trees(self, *names: str) -> list[Tree]:
        """All that is printed of some quantities, with the definitions that they need."""
        texts, trees = [self.printed[name] for name in names], dict[Tree, None]()
        while texts:
            text = texts.pop()
            if isinstance(text, list):
                texts += text
            elif (tree := tree_of(text)) not in trees:
                trees[tree] = None
                defined = sorted(names_in(tree) & {*self.names.definitions})
                texts += [self.names.definitions[name] for name in defined]
        return [*trees]

    # The rotation and its angular velocity

    def _factors(self) -> Iterator[_Factor]:
        rotation = self.record["rotation"]
        turns = rotation.get("turns", ())
        if not turns:
            trees = [tree_of(text) for row in rotation["matrix"] for text in row]
            yield self._as_printed(self.text(rotation["matrix"], "s"), trees)
        for turn in turns:
            kind, _, inside = turn.partition("(")
            places = inside[:-1].split(",")
            if kind in ("x", "y", "z"):
                angle = tree_of(places[0])
                function, rate = self.real(angle, "s"), self._rate(angle)
                velocity = f"(V {' '.join(rate if kind == axis else '0' for axis in 'xyz')})"
                proof = f"eapply (turn_{kind}_turns (fun s => {function})); {_VALUE}"
                yield _Factor(f"turn_{kind} {function}", velocity, proof, [("cos", angle)])
                continue
            form = TURNS[kind].replace("N", SQUARES).format(*(f"({place})" for place in places))
            trees = [*map(tree_of, form.split(";"))]
            *axis, cosine, sine = (self.real(tree, "s") for tree in trees)
            text = f"turn (V {' '.join(axis)}) {cosine} {sine}"
            is_fixed = not names_in(("", *trees[:3])) - {*self.names.constant}
            if kind == "constant_turn" and is_fixed:
                yield _Factor(text, "(V 0 0 0)", "apply constant_turns; CALCULATION", trees)
            elif kind == "axis_angle" and is_fixed:
                function = self.real(trees[3][1], "s")
                proof = f"apply (axis_turns {' '.join(axis)} (fun s => {function}));"
                velocity = f"(scale {self._rate(trees[3][1])} (V {' '.join(axis)}))"
                yield _Factor(text, velocity, f"{proof} [ CALCULATION | {_VALUE} ]", trees)
            elif len(turns) == 1:
                yield self._as_printed(text, trees)
            else:
                raise Unstated

    def _as_printed(self, text: str, trees: list[Tree]) -> _Factor:
        """F whose entries Coq differentiates; that it turns with the printed Ω is the claim."""
        if "angular_velocity_space" not in self.claims:
            raise Unstated
        velocity = self.text(self.printed["angular_velocity_space"])
        return _Factor(text, velocity, "turning ltac:(CALCULATION)", trees)

    def _rate(self, angle: Tree) -> str:
        """The rate of a sum of multiples of coordinates."""
        kind, *parts = angle
        if kind == "number" or (kind == "name" and parts[0] in self.names.constant):
            return "0"
        if kind == "name":
            return self.name(f"{parts[0]}_dot")
        if kind in ("+", "-"):
            return f"({self._rate(parts[0])} {kind} {self._rate(parts[1])})"
        if kind == "*" and not names_in(parts[0]):
            return f"({self.real(parts[0])} * {self._rate(parts[1])})"
        if kind == "/" and not names_in(parts[1]):
            return f"({self._rate(parts[0])} * / {self.real(parts[1])})"
        raise Unstated

    def head(self) -> Iterator[str]:
        """Coordinates as functions of time, facts, F, and its angular velocity."""
        names = self.names
        q, rates = ([*map(self.letter, group)] for group in (names.q, names.rates))
        yield "Section Claims."
        if names.constant != ["pi"]:
            yield f"Variables {' '.join(self.letter(n) for n in names.constant if n != 'pi')} : R."
        yield f"Variables {' '.join(q)} : R -> R. (* coordinates, functions of time *)"
        yield f"Variables {' '.join(rates)} : R -> R. (* their derivatives *)"
        for one, two in zip(q, rates, strict=True):
            slope = f"derivable_pt_lim {one} t ({two} t)"
            yield f"Hypothesis {one}_is_differentiable : forall t, {slope}."
        for k, condition in enumerate(self.record["rotation"]["conditions"]):
            yield from self._sphere(k, condition)
        yield from self._roots_and_divisors()
        if "body" in self.record:
            yield f"Definition inertia := {self.text(self.record['body']['inertia'])}."
        texts = [factor.text for factor in self.factors]
        product = reduce(lambda right, left: f"mul ({left}) ({right})", reversed(texts))
        yield f"Definition F s := {product}. (* R *)"
        if self.is_passive:
            yield "Definition shown s := transpose (F s)."
        for name, text in names.definitions.items():
            yield f"Definition {self.letter(name)} t := {self.text(text)}."
        yield from self._turning()

    def _sphere(self, k: int, condition: str) -> Iterator[str]:
        """A condition Σ n² - 1, and what follows for the rates; others are not stated."""
        if not re.fullmatch(r"\w+\*\*2( \+ \w+\*\*2)* - 1", condition):
            raise Unstated
        sphere = re.findall(r"(\w+)\*\*2", condition)
        first, *rest = (self.name(name) for name in sphere)
        at_s = " + ".join(f"{name} * {name}" for name in (self.name(n, "s") for n in sphere))
        yield f"Hypothesis sphere_{k} : forall s, {at_s} = 1."
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
            self.facts += [f"(along_{k} t)", f"(across_{k} t)"]  # to be tried before the square
        self.facts.append(f"(square_{k} t)")

    def _roots_and_divisors(self) -> Iterator[str]:
        """Squares of cosines and roots; divisors in F are not 0, and its roots not of 0."""
        of_rotation = [tree for factor in self.factors for tree in factor.trees]
        trees = [*of_rotation, *self.trees(*self.claims)]
        angles = _arguments(trees, "cos", "sin", "tan", "cot")
        self.facts += [f"(squares {text})" for text in dict.fromkeys(map(self.real, angles))]
        numbers = [root for root in _arguments(trees, "sqrt") if root[0] == "number"]
        self.roots = [*dict.fromkeys((*_arguments(of_rotation, "sqrt"), *numbers))]
        for k, root in enumerate(self.roots):
            text = self.real(root)
            if root in numbers:
                yield f"Lemma positive_{k} (t : R) : 0 < {text}. Proof. lra. Qed."
            else:
                yield f"Hypothesis positive_{k} : forall t, 0 < {text}."
            yield f"Lemma root_{k} (t : R) : sqrt {text} * sqrt {text} = {text}."
            yield f"Proof. apply sqrt_sqrt, Rlt_le, (positive_{k} t). Qed."
            yield f"Lemma real_{k} (t : R) : sqrt {text} <> 0."
            yield f"Proof. apply Rgt_not_eq, sqrt_lt_R0, (positive_{k} t). Qed."
            self.facts.append(f"(root_{k} t)")
            self.known += [f"(positive_{k} t)", f"(real_{k} t)"]
            self.apart |= {self.summands(root), self.summands(("sqrt", root))}
        for k, divisor in enumerate(_divisors(of_rotation)):
            text = self.real(divisor)
            if self.summands(divisor) not in self.apart:
                is_above_one = text.startswith("((((1 * 1) + ")  # of 1 + g², by Gibbs' vector
                yield f"{'Lemma' if is_above_one else 'Hypothesis'} nonzero_{k} :"
                yield f"  forall t, {text} <> 0."
                if is_above_one:
                    yield "Proof. intro; nra. Qed."
                self.known.append(f"(nonzero_{k} t)")
                self.apart.add(self.summands(divisor))

    def calculation(self, *more: str) -> str:
        """A tactic for equations of numbers, vectors and matrices, by the facts."""
        words = ["F", *["shown"] * self.is_passive, *["inertia"] * ("body" in self.record)]
        words += map(self.letter, self.names.definitions)
        using = f" [{' '.join((*self.facts, *more))}]" if self.facts or more else ""
        return (
            f"unfold {', '.join(words)}; entries; "
            f"first [ ring{using} | {self.posed} field{using}; apart ]"
        )

    @property
    def posed(self) -> str:
        return "".join(f"pose proof {fact}; " for fact in self.known)

    def _turning(self) -> Iterator[str]:
        """That F turns with the sum of the angular velocities of its turns."""
        for k, factor in enumerate(self.factors, start=1):
            calculation = self.calculation().replace("unfold F; ", "")
            proof = factor.proof.replace("CALCULATION", calculation)
            yield f"Lemma step_{k} t : turns (fun s => {factor.text}) t {factor.velocity}."
            yield f"Proof. {self.posed}{proof}. Qed."
        velocity, proof = self.factors[-1].velocity, f"(step_{len(self.factors)} t)"
        for k in range(len(self.factors) - 1, 0, -1):
            factor = self.factors[k - 1]
            at = re.sub(r"\bs\)", "t)", factor.text)
            velocity = f"(plus {factor.velocity} (apply ({at}) {velocity}))"
            proof = f"(product _ _ t _ _ (step_{k} t) {proof})"
        yield f"Lemma total t : turns F t {velocity}."
        yield f"Proof. exact {proof}. Qed."

    # The claims

    def theorem(self, name: str) -> Iterator[str]:
        """A theorem about what is printed of a quantity; raises Unstated."""
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
            raise Unstated
        if not {*_arguments(self.trees(name), "sqrt")} <= {*self.roots}:
            raise Unstated
        letters, claim, proof = statement
        yield f"Theorem {name.replace(' ', '_')} (t : R){letters} : {claim}."
        yield f"Proof. intros. {proof}. Qed."

    def need(self, *names: str) -> None:
        """Raise Unstated if there are no theorems about some other quantities."""
        if not {*names} <= {*self.stated}:
            raise Unstated

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

    def of_rotation_matrix(self, name: str) -> _Statement:
        claim = f"{self.divisors(name)}{self.shown} t = {self.text(self.printed[name])}"
        return "", claim, self.calculation()

    def of_rotation_rate(self, name: str) -> _Statement:
        claim = f"{self.divisors(name)}rate {self.shown} t {self.text(self.printed[name])}"
        rate = "rate_of_turns _ _ _ (total t)"
        rate = f"transposed_rate F t _ ({rate})" if self.is_passive else rate
        proof = (
            f"assert (total_t := {rate}). match type of total_t with rate _ _ ?D => match goal "
            "with |- rate _ _ ?E => replace E with D; "
            f"[ exact total_t | {self.calculation()} ] end end"
        )
        return "", claim, proof

    def of_spin_matrix(self, name: str) -> _Statement:
        claim = (
            f"{self.divisors(name)}exists D, rate {self.shown} t D /\\ "
            f"mul D (transpose ({self.shown} t)) = {self.text(self.printed[name])}"
        )
        proof = "destruct (total t) as [f [D [d e]]]. "
        if self.is_passive:
            proof += (
                "exists (transpose D); split; [ exact (transposed_rate F t D d) | ]. unfold shown. "
                "rewrite <- transposed. replace (mul (transpose (F t)) D) with "
                "(mul (mul (transpose (F t)) (mul D (transpose (F t)))) (F t)) by "
                "(rewrite !associative, (proj1 (proj2 f)), one_right; reflexivity). rewrite e. "
            )
        else:
            proof += "exists D; split; [ exact d | ]. rewrite e. "
        return "", claim, proof + self.calculation()

    def of_angular_velocity(self, name: str, frame: str) -> _Statement:
        claim = f"{self.divisors(name)}{_TURNS[frame]} F t {self.text(self.printed[name])}"
        return "", claim, self.turning(frame)

    def turning(self, frame: str, before: str = "") -> str:
        """The proof that F turns with some vector."""
        return (
            f"{'apply in_body. ' * (frame == 'body')}assert (total_t := total t). "
            "match type of total_t with turns _ _ ?w => match goal with |- turns _ _ ?v => "
            f"replace v with w; [ exact total_t | {before}{self.calculation()} ] end end"
        )

    def of_rate_matrix(self, name: str, frame: str) -> _Statement:
        rates = [self.name(rate) for rate in self.names.rates]
        sums = self.combination(self.printed[name], rates)
        return "", f"{self.divisors(name)}{_TURNS[frame]} F t {sums}", self.turning(frame)

    def combination(self, rows: Sequence[Sequence[str]], factors: Sequence[str]) -> str:
        """A matrix times a vector, as the sum over its columns."""
        columns = (self.text([row[k] for row in rows]) for k in range(len(rows[0])))
        terms = [f"(scale {f} {column})" for f, column in zip(factors, columns, strict=True)]
        return reduce(lambda right, left: f"(plus {left} {right})", reversed(terms))

    def of_inverse_rate_matrix(self, name: str, frame: str) -> _Statement:
        """W W⁻¹ a = a for all vectors a."""
        W = f"rate_matrix_{frame}"
        self.need(W)
        rates = [f"(dot {self.text(row)} (V a b c))" for row in self.printed[name]]
        claim = f"{self.combination(self.printed[W], rates)} = V a b c"
        return " a b c", self.divisors(name, W) + claim, self.calculation()

    def of_rates_from_angular_velocity(self, name: str, frame: str) -> _Statement:
        omega = " ".join(f"omega_{frame}_{k}" for k in (1, 2, 3))
        rates = [self.name(rate) for rate in self.names.rates]
        equations = zip(rates, map(self.text, self.printed[name]), strict=True)
        premises = "".join(f"{rate} = {text} -> " for rate, text in equations)
        rewrite = "".join(
            f"try match goal with H : {rate} = _ |- _ => rewrite H; clear H end; " for rate in rates
        )
        claim = f"{self.divisors(name)}{premises}{_TURNS[frame]} F t (V {omega})"
        return f" {omega}", claim, self.turning(frame, rewrite)

    def of_angular_acceleration(self, name: str, frame: str) -> _Statement:
        velocity = f"angular_velocity_{frame}"
        self.need(velocity)
        if self.divisors(velocity):
            raise Unstated
        function = f"(fun s => {self.text(self.printed[velocity], 's')})"
        claim = (
            f"{self.divisors(name)}exists w, (forall s, {_TURNS[frame]} F s (w s)) "
            f"/\\ vector_rate w t {self.text(self.printed[name])}"
        )
        proof = (
            f"{self.posed}exists {function}; split; [ exact {velocity} | ]. "
            f"repeat split; expand; (eapply value; [ derivative | {self.calculation()} ])"
        )
        return self.seconds[0], self.seconds[1] + claim, proof

    @property
    def seconds(self) -> tuple[str, str]:
        """Letters for the derivatives of the rates, and hypotheses that say what they are."""
        letters = [*map(self.letter, self.names.second)]
        pairs = zip(map(self.letter, self.names.rates), letters, strict=True)
        premises = (f"derivable_pt_lim {rate} t {second} -> " for rate, second in pairs)
        return f" {' '.join(letters)}", "".join(premises)

    def of_body(self, name: str) -> _Statement:
        """An equation of `_OF_BODY`, for the w with which the body turns."""
        if "body" not in self.record or ("potential}" in _OF_BODY[name] and not self.potential):
            raise Unstated
        right = _OF_BODY[name].format(**self.parts)
        claim = f"{self.text(self.printed[name])} = {right}"
        free = sorted({*re.findall(r"\b[XYZ](?:_dot)?\b|\b[pn]_[xyz]\b", claim)})
        letters = "".join(f" {letter}" for letter in free)
        if not re.search(r"\bw\b", right):
            return letters, self.divisors(name) + claim, self.calculation()
        return letters, *self.for_velocity(claim, name)

    @property
    def potential(self) -> str:
        return self.parts["potential"]

    def for_velocity(self, claim: str, *names: str) -> tuple[str, str]:
        """A claim for the angular velocity w of the body."""
        velocity = "angular_velocity_body"
        self.need(velocity)
        premises = self.divisors(velocity, *names)
        w = self.text(self.printed[velocity])
        proof = f"exists {w}; split; [ apply {velocity}; assumption | {self.calculation()} ]"
        return f"{premises}exists w, turns_in_body F t w /\\ {claim}", proof

    def of_principal_axes(self, _: str) -> _Statement:
        """The columns e of a rotation, and I' e = m e for the moments m."""
        if not {*PRINCIPAL} <= {*self.claims} or "body" not in self.record:
            raise Unstated
        axes, moments = (self.printed[each] for each in PRINCIPAL)
        columns = [self.text([row[k] for row in axes]) for k in range(3)]
        equations = (
            f"apply inertia {column} = scale {self.text(moment)} {column}"
            for column, moment in zip(columns, moments, strict=True)
        )
        claim = " /\\ ".join((f"is_rotation {self.text(axes)}", *equations))
        return "", self.divisors(*PRINCIPAL) + claim, f"repeat split; {self.calculation()}"

    of_principal_moments = of_principal_axes

    def of_angular_acceleration_from_torque(self, name: str) -> _Statement:
        """I' x + Ω' × I' Ω' = N'."""
        if "body" not in self.record:
            raise Unstated
        omega, torque = (
            " ".join(f"{letter}_{k}" for k in (1, 2, 3)) for letter in ("omega_body", "torque")
        )
        left = f"plus (apply inertia {self.text(self.printed[name])})"
        left += f" (cross (V {omega}) (apply inertia (V {omega})))"
        claim = f"{self.divisors(name)}{left} = V {torque}"
        return f" {omega} {torque}", claim, self.calculation()

    # Lagrange's equations

    def of_generalised_momenta(self, name: str) -> _Statement:
        """∂L/∂q̇ of the printed L."""
        self.need("lagrangian")
        claims = (
            f"derivable_pt_lim {self.slope(rate)} {self.name(rate)} {self.text(text)}"
            for rate, text in zip(self.names.rates, self.printed[name], strict=True)
        )
        proof = f"repeat split; (eapply value; [ derivative | {self.calculation()} ])"
        return "", self.divisors(name, "lagrangian") + " /\\ ".join(claims), proof

    def slope(self, name: str) -> str:
        """The printed L as a function of one name."""
        return f"(fun u => {self.text(self.printed['lagrangian'], 't', {name: 'u'})})"

    def of_mass_matrix(self, name: str) -> _Statement:
        """A symmetric M with 2 T = q̇ · M q̇, for all rates."""
        masses, rates = self.printed[name], [self.name(rate) for rate in self.names.rates]
        n = range(len(rates))
        entry = [[self.text(each) for each in row] for row in masses]
        square = " + ".join(f"{entry[j][k]} * {rates[j]} * {rates[k]}" for j in n for k in n)
        symmetry = (f"{entry[j][k]} = {entry[k][j]}" for j in n for k in range(j))
        twice = f"dot w (apply inertia w) = {square}"
        claim, proof = self.for_velocity(" /\\ ".join((twice, *symmetry)), name)
        return "", claim, proof.replace("; assumption | ", "; assumption | repeat split; ")

    def of_hamiltonian(self, name: str) -> _Statement:
        """T + V, if p has the values of the printed momenta."""
        self.need("generalised_momenta")
        momenta = map(self.text, self.printed["generalised_momenta"])
        text = self.text(
            self.printed[name], "t", dict(zip(self.names.momenta, momenta, strict=True))
        )
        claim = f"{text} = {_KINETIC} + {self.potential}"
        return "", *self.for_velocity(claim, name, "generalised_momenta")

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

    def by_derivatives(self) -> str:
        """The proof of such equations."""
        return (
            "repeat match goal with |- _ /\\ _ => split end; (eexists; eexists; split; "
            f"[ derivative | split; [ derivative | {self.calculation()} ] ])"
        )

    def of_bias_vector(self, name: str) -> _Statement:
        """M q̈ + h, for all q̈."""
        self.need("mass_matrix")
        second = [*map(self.letter, self.names.second)]
        right = []
        for row, h in zip(self.printed["mass_matrix"], self.printed[name], strict=True):
            terms = (f"{self.text(m)} * {each}" for m, each in zip(row, second, strict=True))
            right.append(" + ".join((*terms, self.text(h))))
        claim = self.divisors(name, "mass_matrix", "lagrangian") + self.equations(right)
        return self.seconds[0], self.seconds[1] + claim, self.by_derivatives()

    @property
    def along_the_motion(self) -> tuple[str, str]:
        """Letters and hypotheses: the derivatives of the rates are the printed accelerations."""
        letters, premises = self.seconds
        pairs = zip(letters.split(), self.printed["accelerations"], strict=True)
        equations = "".join(f"{second} = {self.text(text)} -> " for second, text in pairs)
        return letters, self.divisors("accelerations", "lagrangian") + premises + equations

    def of_accelerations(self, _: str) -> _Statement:
        """dp/dt - ∂L/∂q = Q."""
        motion = self.record.get("motion")
        if motion is None or {*motion["torque"]} != {"0"}:
            raise Unstated
        letters, premises = self.along_the_motion
        claim = self.equations([self.text(force) for force in motion["forces"]])
        return letters, premises + claim, f"subst; {self.by_derivatives()}"

    def constant(self, name: str) -> _Statement:
        """A printed expression whose derivative along every motion is 0."""
        self.need("accelerations")
        letters, premises = self.along_the_motion
        function = f"(fun s => {self.text(self.printed[name], 's')})"
        proof = f"subst; eapply value; [ derivative | {self.calculation()} ]"
        return letters, f"{premises}derivable_pt_lim {function} t 0", proof


_Statement = tuple[str, str, str]  # letters besides t, the claim, and its proof


def _arguments(trees: Iterable[Tree], *functions: str) -> list[Tree]:
    """The arguments of some functions, each once."""
    found: dict[Tree, None] = {}
    stack = [*trees]
    while stack:
        kind, *parts = stack.pop()
        if kind in functions:
            found[parts[0]] = None
        stack += [part for part in parts if isinstance(part, tuple)]
    return [*found]


def _divisors(trees: Iterable[Tree]) -> list[Tree]:
    """The factors of all divisors, each once, without numbers, which are not zero."""
    divisors: dict[Tree, None] = {}
    stack = [*trees]
    while stack:
        kind, *parts = stack.pop()
        if kind in ("tan", "cot"):
            divisors["cos" if kind == "tan" else "sin", parts[0]] = None
        if kind == "/" or (kind == "**" and parts[1] < 0):
            factors = [parts[1] if kind == "/" else parts[0]]
            while factors:
                factor = factors.pop()
                if factor[0] in ("*", "**"):
                    factors += [part for part in factor[1:] if isinstance(part, tuple)]
                elif factor[0] != "number":
                    divisors[factor] = None
        stack += [part for part in parts if isinstance(part, tuple)]
    return [*divisors]
