"""A certificate as theorems for Coq and for Lean, in which its names are any real numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from rigidsym.tools.certificate.certificate import Certificate, ProvedEquation, Terms
from rigidsym.tools.certificate.checker import Poly

_START = {"cos(": "cos_", "sin(": "sin_", "1/(": "inverse", "sqrt(": "root"}


def coq(certificate: Certificate) -> str:
    """A file for coqc: each equation by `ring`, from the relations as hypotheses.

    Equations are multiplied by the common denominator of their coefficients.
    """
    work = _Theorems(certificate)
    lines = [
        f"(* {certificate.name}: what each printed quantity says, entry by entry. *)",
        *(f"(* {letter} is {name} *)" for name, letter in work.letters.items()),
        "Require Import Reals.",
        "Open Scope R_scope.",
        "Section Claims.",
        f"Variables {' '.join(work.letters.values())} : R.",
        *(f"Hypothesis r{k} : {text} = 0." for k, text in enumerate(work.relations)),
    ]
    for name, entry in work.theorems():
        used = "".join(f" rewrite r{k}." for k in entry.cofactors)
        combination = work.combination(entry, "({})")
        tactic = (
            "field" if "/" in work.poly(entry.left + entry.right * -1) + combination else "ring"
        )
        lines += [
            f"Theorem {name} : {work.poly(entry.left)} = {work.poly(entry.right)}.",
            "Proof.",
            "  apply Rminus_diag_uniq.",
            f"  transitivity ({combination}).",
            f"  - {tactic}.",
            f"  -{used} now rewrite ?Rmult_0_r, ?Rplus_0_l.",
            "Qed.",
        ]
    return "\n".join([*lines, "End Claims.", ""])


def lean(certificate: Certificate) -> str:
    """The same for Lean 4 with Mathlib; these theorems were not compiled when they were written."""
    work = _Theorems(certificate)
    letters = " ".join(work.letters.values())
    lines = [
        f"-- {certificate.name}: what each printed quantity says, entry by entry.",
        "-- This file has not been compiled.",
        *(f"-- {letter} is {name}" for name, letter in work.letters.items()),
        "import Mathlib.Tactic",
        f"variable ({letters} : ℝ)",
    ]
    for name, entry in work.theorems():
        given = "".join(f"\n    (r{k} : {work.relations[k]} = 0)" for k in entry.cofactors)
        lines += [
            f"theorem {name}{given} :",
            f"    {work.poly(entry.left)} = {work.poly(entry.right)} := by",
            f"  linear_combination {work.combination(entry, 'r{}')}",
        ]
    return "\n".join([*lines, ""])


class _Theorems:
    """Polynomials in letters that both languages take."""

    def __init__(self, certificate: Certificate) -> None:
        self.certificate = certificate
        equations = (entry for entries in certificate.claims.values() for entry in entries)
        held = {name for entry in equations for name in entry.left.names | entry.right.names}
        names = [*certificate.names, *sorted(held - {*certificate.names})]
        self.letters = {name: _letter(name, place) for place, name in enumerate(names)}
        self.relations = list(map(self.terms, certificate.relations))

    def theorems(self) -> Iterator[tuple[str, ProvedEquation]]:
        """Each equation once: R Rᵀ = 1 is symmetric, and a claim may repeat another."""
        seen: set[tuple[str, str]] = set()
        for claim, entries in self.certificate.claims.items():
            for place, entry in enumerate(entries, start=1):
                sides = str(entry.left), str(entry.right)
                if sides not in seen:
                    yield f"{claim.replace(' ', '_')}_{place}", _scaled(entry)
                seen.add(sides)

    def poly(self, poly: Poly) -> str:
        return self._sum([(str(c), *names) for names, c in sorted(poly.terms.items())])

    def terms(self, terms: Terms) -> str:
        names = self.certificate.names
        return self._sum([(str(c), *(names[int(k)] for k in places)) for c, *places in terms])

    def _sum(self, terms: Sequence[Sequence[str]]) -> str:
        return " + ".join(self._product(c, names) for c, *names in terms) or "0"

    def _product(self, coefficient: str, names: Sequence[str]) -> str:
        first = [] if coefficient == "1" and names else [f"({coefficient})"]
        return " * ".join(first + [self.letters[name] for name in names])

    def combination(self, entry: ProvedEquation, form: str) -> str:
        """Σ cofactor · relation, each relation in a form that takes its place or its text."""
        return (
            " + ".join(
                f"({self.terms(terms)}) * {form.format(self.relations[k] if form == '({})' else k)}"
                for k, terms in entry.cofactors.items()
            )
            or "0"
        )


def _scaled(entry: ProvedEquation) -> ProvedEquation:
    """The equation times the common denominator of its coefficients, for `ring`."""
    terms = [term for cofactor in entry.cofactors.values() for term in cofactor]
    numbers = [*entry.left.terms.values(), *entry.right.terms.values(), *(t[0] for t in terms)]
    scale = math.lcm(*(Fraction(number).denominator for number in numbers))
    cofactors = {
        place: [[str(Fraction(c) * scale), *names] for c, *names in cofactor]
        for place, cofactor in entry.cofactors.items()
    }
    return ProvedEquation(left=entry.left * scale, right=entry.right * scale, cofactors=cofactors)


def _letter(name: str, place: int) -> str:
    for start, letter in _START.items():
        if name.startswith(start):
            inside = name.removeprefix(start).removesuffix(")")
            plain = re.fullmatch(r"1(?:/(\d+))?\*(\w+)", inside)
            if plain is None or not letter.endswith("_"):
                return f"{letter}_{place}"
            part, angle = plain.groups()
            return letter + angle + (f"_over_{part}" if part else "")
    return f"v_{name}"
