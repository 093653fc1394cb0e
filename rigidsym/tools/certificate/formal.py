"""A record as theorems for Coq, in its own real numbers: `Rotation.v` says what their words mean.

The statements hold what the record prints. A claim for which no theorem is written is named in the
head of the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigidsym.tools.certificate.checker import Names, Tree, names_in, printed_in, tree_of

DEFINITIONS = "Rotation.v"
# Words of Coq, its real numbers and Rotation.v: a coordinate of such a name gets an underscore
_WORDS = [
    "as",
    "at",
    "cofix",
    "else",
    "end",
    "exists",
    "fix",
    "for",
    "forall",
    "fun",
    "if",
    "in",
    "let",
    "match",
    "mod",
    "Prop",
    "return",
    "Set",
    "then",
    "Type",
    "using",
    "where",
    "with",
    "R",
    "cos",
    "sin",
    "sqrt",
    "tan",
    "PI",
    "V",
    "M",
    "C",
    "v1",
    "v2",
    "v3",
    "row1",
    "row2",
    "row3",
    "vec",
    "mat",
    "dot",
    "plus",
    "scale",
    "cross",
    "apply",
    "transpose",
    "mul",
    "add",
    "times",
    "det",
    "one",
    "turn",
    "turn_x",
    "turn_y",
    "turn_z",
    "norm",
    "is_rotation",
    "rate",
    "vector_rate",
    "turns",
    "turns_in_body",
    "product",
    "squares",
    "F",
    "shown",
    "t",
    "s",
    "w",
    "value",
    "derivative",
    "entries",
    "expand",
    "algebra",
]


def definitions() -> str:
    """The file that every theorem needs."""
    return Path(__file__).with_name(DEFINITIONS).read_text(encoding="utf-8")


class Unstated(ValueError):
    """There is no theorem for this."""


def coq(record: Mapping[str, Any], claims: Sequence[str]) -> str:
    """The theorems of the claims."""
    names = Names(record)
    theorems: _Theorems | None
    try:
        theorems = _Theorems(record, names)
    except Unstated:
        theorems = None
    stated: dict[str, list[str]] = {}
    head: list[str] = []
    if theorems is not None:
        head = list(theorems.head())
        for name in claims:
            try:
                stated[name] = list(theorems.of(name))
            except Unstated:
                continue
    missing = [name for name in claims if name not in stated]
    return "\n".join(
        [
            f"(* {record['name']}: R = {_words(record['rotation'])}, {record['presentation']}.",
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


def _words(rotation: Mapping[str, Any]) -> str:
    return " ".join(rotation.get("turns", ())) or "the matrix of its entries"


class _Theorems:
    def __init__(self, record: Mapping[str, Any], names: Names) -> None:
        self.record, self.names = record, names
        self.printed = printed_in(record)
        self.is_passive = record["presentation"] == "passive"
        if record["rotation"]["conditions"] or not record["rotation"].get("turns"):
            raise Unstated
        self.steps = list(map(self._step, record["rotation"]["turns"]))

    # ---- text ----

    def letter(self, name: str) -> str:
        return f"{name}_" if name in _WORDS else name

    def real(self, tree: Tree, at: str = "t") -> str:
        """A tree as a real number at a time."""
        kind, *parts = tree
        if kind == "number":
            return str(parts[0])
        if kind == "name":
            return self._name(parts[0], at)
        if kind == "**":
            base, power = self.real(parts[0], at), parts[1]
            product = "(" + " * ".join([base] * abs(power)) + ")" if power else "1"
            return product if power >= 0 else f"(1 / {product})"
        if kind == "-" and parts[0] == ("number", 0):
            return f"(- {self.real(parts[1], at)})"
        if kind == "/" and not names_in(parts[1]) - {*self.names.constant}:
            return f"({self.real(parts[0], at)} * / {self.real(parts[1], at)})"
        if kind in "+-*/":
            return f"({self.real(parts[0], at)} {kind} {self.real(parts[1], at)})"
        inside = self.real(parts[0], at)
        if kind == "tan":
            return f"(sin {inside} / cos {inside})"
        if kind == "cot":
            return f"(cos {inside} / sin {inside})"
        if inside[0] != "(":
            inside = f"({inside})"
        return f"({kind} {inside})"

    def _name(self, name: str, at: str) -> str:
        letter = self.letter(name)
        if name == "pi":
            return "PI"
        if name in (*self.names.q, *self.names.rates, *self.names.definitions):
            return f"({letter} {at})"
        return letter

    def vector(self, texts: Sequence[str], at: str = "t") -> str:
        return f"(V {' '.join(self.real(tree_of(text), at) for text in texts)})"

    def matrix(self, rows: Sequence[Sequence[str]], at: str = "t") -> str:
        return f"(M {' '.join(self.vector(row, at) for row in rows)})"

    def trees(self, *names: str) -> list[Tree]:
        """All that is in some quantities, with the definitions that they need."""
        texts: list[Any] = [self.printed[name] for name in names]
        trees = []
        while texts:
            text = texts.pop()
            if isinstance(text, list):
                texts += text
            elif (tree := tree_of(text)) not in trees:
                trees.append(tree)
                defined = sorted(names_in(tree) & {*self.names.definitions})
                texts += [self.names.definitions[name] for name in defined]
        return trees

    # ---- R ----

    def _step(self, turn: str) -> tuple[str, str, str]:
        """A turn at s, its angular velocity at t, and the proof of this."""
        kind, _, inside = turn.partition("(")
        parts = [tree_of(part) for part in inside[:-1].split(",")]
        if kind in ("x", "y", "z"):
            angle, rate = self.real(parts[0], "s"), self._rate(parts[0])
            entries = [rate if kind == axis else "0" for axis in "xyz"]
            proof = f"eapply (turn_{kind}_turns (fun s => {angle})); {_VALUE}"
            return f"turn_{kind} {angle}", f"(V {' '.join(entries)})", proof
        texts = [self.real(part, "s") for part in parts]
        axis = " ".join(texts[:3])
        roots = sorted({root for part in parts for root in _roots(part)})
        facts = " ".join(_root_facts(roots))
        using = f" [{' '.join(f'root_{k}' for k in range(len(roots)))}]" if roots else ""
        closing = f"first [ ring{using} | field{using}; lra ]"
        if kind == "axis_angle" and not set().union(*map(names_in, parts[:3])):
            rate = self._rate(parts[3])
            entries = [f"({rate} * {text})" for text in texts[:3]]
            step = f"turn (V {axis}) (cos {texts[3]}) (sin {texts[3]})"
            proof = (
                f"{facts} apply (axis_turns {axis} (fun s => {texts[3]})); [ {closing} | {_VALUE} ]"
            )
            return step, f"(V {' '.join(entries)})", proof
        if kind == "constant_turn" and not set().union(*map(names_in, parts)):
            step = f"turn (V {axis}) {texts[3]} {texts[4]}"
            return step, "(V 0 0 0)", f"{facts} apply constant_turns; {closing}"
        raise Unstated

    def _rate(self, angle: Tree) -> str:
        """The rate of a sum of multiples of coordinates."""
        kind, *parts = angle
        if kind == "name":
            return "0" if parts[0] in self.names.constant else self._name(f"{parts[0]}_dot", "t")
        if kind == "number":
            return "0"
        if kind in ("+", "-"):
            return f"({self._rate(parts[0])} {kind} {self._rate(parts[1])})"
        if kind == "*" and not names_in(parts[0]):
            return f"({self.real(parts[0])} * {self._rate(parts[1])})"
        if kind == "/" and not names_in(parts[1]):
            return f"({self._rate(parts[0])} * / {self.real(parts[1])})"
        raise Unstated

    def head(self) -> Iterator[str]:
        """Coordinates as functions of time, R, and its angular velocity as turns add up."""
        names = self.names
        q, rates = (" ".join(map(self.letter, group)) for group in (names.q, names.rates))
        yield "Section Claims."
        if names.constant != ["pi"]:
            yield f"Variables {' '.join(self.letter(n) for n in names.constant if n != 'pi')} : R."
        yield f"Variables {q} : R -> R. (* coordinates, functions of time *)"
        yield f"Variables {rates} : R -> R. (* their derivatives *)"
        for name, rate in zip(names.q, names.rates, strict=True):
            one, two = self.letter(name), self.letter(rate)
            yield f"Hypothesis {name}_rate : forall t, derivable_pt_lim {one} t ({two} t)."
        steps = [step for step, _, _ in self.steps]
        product = steps[-1]
        for step in reversed(steps[:-1]):
            product = f"mul ({step}) ({product})"
        yield f"Definition F s := {product}. (* R *)"
        if self.is_passive:
            yield "Definition shown s := transpose (F s)."
        for name, text in names.definitions.items():
            yield f"Definition {self.letter(name)} t := {self.real(tree_of(text))}."
        for k, (step, velocity, proof) in enumerate(self.steps, start=1):
            yield f"Lemma step_{k} t : turns (fun s => {step}) t {velocity}."
            yield f"Proof. {proof}. Qed."
        velocity, proof = self.steps[-1][1], f"(step_{len(steps)} t)"
        for k in range(len(steps) - 1, 0, -1):
            at = re.sub(r"\bs\)", "t)", self.steps[k - 1][0])
            velocity = f"(plus {self.steps[k - 1][1]} (apply ({at}) {velocity}))"
            proof = f"(product _ _ t _ _ (step_{k} t) {proof})"
        self.velocity = velocity
        yield f"Lemma all_steps t : turns F t {velocity}."
        yield f"Proof. exact {proof}. Qed."

    # ---- the claims ----

    def of(self, name: str) -> Iterator[str]:
        kind, _, frame = name.rpartition("_")
        printed = self.printed[name]
        law = _LAWS.get(name) or _LAWS.get(kind)
        if law is None:
            raise Unstated
        yield from getattr(self, law)(name, printed, frame)

    def theorem(self, name: str, statement: str, proof: str) -> Iterator[str]:
        yield f"Theorem {name} {statement}."
        yield f"Proof. {proof} Qed."

    def algebra(self, *names: str) -> tuple[str, str]:
        """Facts about the cosines and roots in R and some quantities, and a tactic for them."""
        trees = [*self.rotation_trees(), *self.trees(*names)]
        roots = sorted({root for tree in trees for root in _roots(tree)})
        angles = sorted({self.real(angle) for tree in trees for angle in _angles(tree)})
        facts = _root_facts(roots)
        facts += [f"assert (square_{k} := squares {angle})." for k, angle in enumerate(angles)]
        words = [f"root_{k}" for k in range(len(roots))]
        words += [f"square_{k}" for k in range(len(angles))]
        using = f" [{' '.join(words)}]" if words else ""
        unfold = f"unfold {', '.join(['F', *map(self.letter, self.names.definitions)])};"
        by_field = f"field{using}; repeat split; first [ assumption | lra ]"
        tactic = f"{unfold} entries; first [ ring{using} | {by_field} ]"
        return " ".join(facts), tactic

    def rotation_trees(self) -> list[Tree]:
        parts = (turn.partition("(") for turn in self.record["rotation"]["turns"])
        texts = [(kind, text) for kind, _, inside in parts for text in inside[:-1].split(",")]
        return [tree_of(f"cos({t})" if k in "xyz" else t) for k, t in texts] + [
            tree_of(f"cos({turn[:-1].split(',')[3]})")
            for turn in self.record["rotation"]["turns"]
            if turn.startswith("axis_angle")
        ]

    def divisors(self, *names: str) -> str:
        """Hypotheses that divisors are not zero."""
        trees = (part for tree in self.trees(*names) for part in _divisors(tree))
        texts = dict.fromkeys(self.real(tree) for tree in trees)
        return "".join(f"{text} <> 0 -> " for text in texts)

    def rotation_matrix(self, name: str, printed: Any, _: str) -> Iterator[str]:
        facts, tactic = self.algebra(name)
        unfold = "unfold shown; " if self.is_passive else ""
        shown = "shown" if self.is_passive else "F"
        statement = f"t : {self.divisors(name)}{shown} t = {self.matrix(printed)}"
        yield from self.theorem(name, statement, f"intros. {facts} {unfold}{tactic}.")

    def rotation_rate(self, name: str, printed: Any, _: str) -> Iterator[str]:
        facts, tactic = self.algebra(name)
        statement = f"t : {self.divisors(name)}rate {{}} t {self.matrix(printed)}"
        if self.is_passive:
            proof = "assert (H := transposed_rate F t _ (rate_of_turns _ _ _ (all_steps t)))."
        else:
            proof = "assert (H := rate_of_turns _ _ _ (all_steps t))."
        rest = (
            "match type of H with rate _ _ ?D => match goal with |- rate _ _ ?E => "
            f"replace E with D; [ exact H | {tactic} ] end end."
        )
        shown = "shown" if self.is_passive else "F"
        yield from self.theorem(name, statement.format(shown), f"intros. {facts} {proof} {rest}")

    def spin_matrix(self, name: str, printed: Any, _: str) -> Iterator[str]:
        facts, tactic = self.algebra(name)
        shown = "shown" if self.is_passive else "F"
        statement = (
            f"t : {self.divisors(name)}exists D, rate {shown} t D /\\ "
            f"mul D (transpose ({shown} t)) = {self.matrix(printed)}"
        )
        proof = "destruct (all_steps t) as [f [D [d e]]]."
        if self.is_passive:
            first = (
                "exists (transpose D); split; [ exact (transposed_rate F t D d) | ]. unfold shown."
            )
            rest = (
                "rewrite <- transposed. replace (mul (transpose (F t)) D) with "
                "(mul (mul (transpose (F t)) (mul D (transpose (F t)))) (F t)) by "
                "(rewrite !associative, (proj1 (proj2 f)), one_right; reflexivity). rewrite e."
            )
        else:
            first, rest = "exists D; split; [ exact d | ].", "rewrite e."
        yield from self.theorem(
            name, statement, f"intros. {facts} {proof} {first} {rest} {tactic}."
        )

    def angular_velocity(self, name: str, printed: Any, frame: str) -> Iterator[str]:
        statement = f"t : {self.divisors(name)}{_TURNS[frame]} F t {self.vector(printed)}"
        yield from self.theorem(name, statement, self._turning(frame, name))

    def _turning(self, frame: str, *names: str, extra: str = "") -> str:
        facts, tactic = self.algebra(*names)
        body = "apply in_body. " if frame == "body" else ""
        return (
            f"intros. {facts} {body}assert (total := all_steps t). "
            "match type of total with turns _ _ ?w => match goal with "
            f"|- turns _ _ ?v => replace v with w; [ exact total | {extra}{tactic} ] end end."
        )

    def rate_matrix(self, name: str, printed: Any, frame: str) -> Iterator[str]:
        rates = [f"({self.letter(rate)} t)" for rate in self.names.rates]
        columns = self._combination(printed, rates)
        statement = f"t : {self.divisors(name)}{_TURNS[frame]} F t {columns}"
        yield from self.theorem(name, statement, self._turning(frame, name))

    def _combination(self, rows: Sequence[Sequence[str]], factors: Sequence[str]) -> str:
        """W times a vector of rates, as a sum over its columns."""
        columns = [self.vector([row[k] for row in rows]) for k in range(len(rows[0]))]
        terms = [f"(scale {f} {column})" for f, column in zip(factors, columns, strict=True)]
        total = terms[-1]
        for term in reversed(terms[:-1]):
            total = f"(plus {term} {total})"
        return total

    def inverse_rate_matrix(self, name: str, printed: Any, frame: str) -> Iterator[str]:
        """W W⁻¹ a = a for all vectors a."""
        W = self.printed[f"rate_matrix_{frame}"]
        facts, tactic = self.algebra(name, f"rate_matrix_{frame}")
        rates = [f"(dot {self.vector(row)} (V a b c))" for row in printed]
        divisors = self.divisors(name, f"rate_matrix_{frame}")
        statement = f"t a b c : {divisors}{self._combination(W, rates)} = V a b c"
        yield from self.theorem(name, statement, f"intros. {facts} {tactic}.")

    def rates_from_angular_velocity(self, name: str, printed: Any, frame: str) -> Iterator[str]:
        omega = [f"omega_{frame}_{k}" for k in (1, 2, 3)]
        rates = "".join(
            f"{self.letter(rate)} t = {self.real(tree_of(text))} -> "
            for rate, text in zip(self.names.rates, printed, strict=True)
        )
        letters = " ".join(omega)
        statement = f"t {letters} : {self.divisors(name)}{rates}{_TURNS[frame]} F t (V {letters})"
        equations = "".join(
            f"try match goal with H : {self.letter(rate)} t = _ |- _ => rewrite H; clear H end; "
            for rate in self.names.rates
        )
        yield from self.theorem(name, statement, self._turning(frame, name, extra=equations))

    def angular_acceleration(self, name: str, printed: Any, frame: str) -> Iterator[str]:
        velocity = f"angular_velocity_{frame}"
        if velocity not in self.printed or self.divisors(velocity):
            raise Unstated
        seconds = "".join(
            f"derivable_pt_lim {self.letter(rate)} t {self.letter(second)} -> "
            for rate, second in zip(self.names.rates, self.names.second, strict=True)
        )
        facts, tactic = self.algebra(name, velocity)
        function = f"(fun s => {self.vector(self.printed[velocity], 's')})"
        statement = (
            f"t {' '.join(map(self.letter, self.names.second))} : {seconds}{self.divisors(name)}"
            f"exists w, (forall s, {_TURNS[frame]} F s (w s)) "
            f"/\\ vector_rate w t {self.vector(printed)}"
        )
        proof = (
            f"intros. exists {function}; split; [ exact {velocity} | ]. {facts} "
            f"repeat split; expand; (eapply value; [ derivative | {tactic} ])."
        )
        yield from self.theorem(name, statement, proof)


_TURNS = {"space": "turns", "body": "turns_in_body"}
_VALUE = "eapply value; [ derivative | try ring; field ]"
_LAWS = {
    name: name
    for name in (
        *("rotation_matrix", "rotation_rate", "spin_matrix", "angular_velocity", "rate_matrix"),
        *("inverse_rate_matrix", "rates_from_angular_velocity", "angular_acceleration"),
    )
}


def _roots(tree: Tree) -> set[str]:
    """The whole numbers of which roots are taken."""
    if tree[0] == "sqrt" and tree[1][0] == "number":
        return {str(tree[1][1])}
    return set().union(*(_roots(part) for part in tree[1:] if isinstance(part, tuple)))


def _root_facts(roots: Sequence[str]) -> list[str]:
    return [
        f"assert (root_{k} : sqrt {root} * sqrt {root} = {root}) by (apply sqrt_sqrt; lra)."
        for k, root in enumerate(roots)
    ]


def _angles(tree: Tree) -> set[Tree]:
    if tree[0] in ("cos", "sin", "tan", "cot"):
        return {tree[1]}
    return set().union(*(_angles(part) for part in tree[1:] if isinstance(part, tuple)))


def _divisors(tree: Tree) -> Iterator[Tree]:
    """What is divided by, factor by factor; whole numbers are not zero anyway."""
    kind, *parts = tree
    if kind == "/":
        yield from _factors(parts[1])
    elif kind == "**" and parts[1] < 0:
        yield from _factors(parts[0])
    elif kind in ("tan", "cot"):
        yield ("cos" if kind == "tan" else "sin", parts[0])
    for part in parts:
        if isinstance(part, tuple):
            yield from _divisors(part)


def _factors(tree: Tree) -> Iterator[Tree]:
    if tree[0] == "*":
        yield from (*_factors(tree[1]), *_factors(tree[2]))
    elif tree[0] == "**":
        yield from _factors(tree[1])
    elif tree[0] != "number":
        yield tree
