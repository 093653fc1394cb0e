"""The equation of a step, for notes and for the terminal; a vector quantity as a sum of vectors."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from rigidsym.formula.display import Equation
from rigidsym.formula.letters import Letters, VectorLength, is_negative
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import MINUS, NOTHING, PLUS, Formula, Matrix, bracketed, row
from rigidsym.mechanics.derivation import Argument, Proof, Statement, Step, VectorForm
from rigidsym.mechanics.particles import MASS

_SUM = formula(r"\sum_i m_i")


def claims_of(proofs: Iterable[Proof]) -> tuple[tuple[Formula, ...], tuple[Formula, ...]]:
    """The proved claims, and the unproved ones."""
    claims: dict[bool, list[Formula]] = {True: [], False: []}
    for proof in proofs:
        claims[proof.is_exact].append(proof.claim)
    return tuple(claims[True]), tuple(claims[False])


def equation_of(step: Step, arguments: Iterable[Argument]) -> Equation:
    """The numbered equation of a step."""
    quantity = step.quantity
    proved, unproved = claims_of(step.proofs)
    is_scalar = quantity.shape == "scalar"
    is_matrix = not (is_scalar or step.recursion)
    definition = step.recursion or quantity.definition
    # the names of the components, if the vector is an argument elsewhere, such as the rates
    is_rates = quantity.name.startswith("rates_from_")
    used_as = "q_dot" if is_rates else quantity.name.replace("angular_velocity_", "omega_")
    names = next((a.notation for a in arguments if a.name == used_as), ())
    return Equation(
        sides=(quantity.symbol, *([] if definition == NOTHING else [definition])),
        matrix=step.expression if is_matrix else None,
        scalar=step.expression[0] if is_scalar else None,
        entries=names if is_matrix else (),
        number=step.number,
        label=quantity.name,
        proved=proved,
        unproved=unproved,
    )


def in_parts(parts: Iterable[tuple[sp.Expr, sp.Expr]], letters: Letters) -> Equation:
    """The definition of each name, one below the other."""
    names, values = zip(*parts, strict=True)
    entries = tuple(formula_of(name, letters) for name in names)
    return Equation(sides=(), matrix=sp.ImmutableMatrix(values), entries=entries)


def sums(statement: Statement, letters: Letters) -> Matrix | None:
    """The matrix of sums Σ mᵢ (b² + c²); None where the statement has no summands."""
    if statement.summands is None:
        return None

    def whole(summand: sp.Expr) -> Formula:
        minus = is_negative(summand)
        rest = (-summand if minus else summand) / MASS
        return row(*[MINUS] * minus, _SUM, bracketed(formula_of(rest, letters)))

    return Matrix(tuple(tuple(map(whole, line)) for line in statement.summands.tolist()))


def sum_of_vectors(form: VectorForm, letters: Letters) -> Formula:
    """The terms with their coefficients: v̇ + (1 − cos n)/n² v × v̇ + ..."""
    form = in_notation(form, letters.length) if letters.length else form
    parts: list[Formula] = []
    for term in form.terms:
        minus, coefficient = sign_outside(by_half_angle(term.coefficient))
        if minus or parts:
            parts.append(MINUS if minus else PLUS)
        parts += [*_factor(coefficient, letters), term.vector]
    if form.last is None:
        return row(*parts)
    last = row(*_factor(form.last.coefficient, letters), form.last.vector)
    return Matrix(((row(*parts),), (last,)))


def _factor(coefficient: sp.Expr, letters: Letters) -> list[Formula]:
    """A coefficient before a vector; 1 is not written, and a sum is in brackets."""
    return [bracketed(formula_of(coefficient, letters))] if coefficient != 1 else []


def in_notation(form: VectorForm, length: VectorLength) -> VectorForm:
    """The form in the length that the notation has; |v|² is n² − w² where n is |q|."""
    if length.components == form.components:
        return form
    others = [part**2 for part in length.components if part not in form.components]
    own = sp.sqrt(length.symbol**2 - sp.Add(*others))
    terms = (t._replace(coefficient=t.coefficient.subs(form.length, own)) for t in form.terms)
    return form._replace(terms=tuple(terms), components=length.components, length=length.symbol)


def by_half_angle(coefficient: sp.Expr) -> sp.Expr:
    """With cot(n/2) for sin n/(1 − cos n): (2 − n cot(n/2))/2n², where 1 − cos n cancels."""
    sine, cotangent = sp.symbols("sine cotangent")  # of n/2
    for cosine in coefficient.atoms(sp.cos):
        (angle,) = cosine.args
        values = {cosine: 1 - 2 * sine**2, sp.sin(angle): 2 * sine**2 * cotangent}
        by_halves = sp.cancel(coefficient.xreplace(values))
        if not by_halves.has(sine):
            return by_halves.xreplace({cotangent: sp.cot(angle / 2)})
    number, rest = coefficient.as_content_primitive()  # 2 − 2 cos n is 2 (1 − cos n)
    return coefficient if number == 1 else number * by_half_angle(rest)


def sign_outside(coefficient: sp.Expr) -> tuple[bool, sp.Expr]:
    """Whether a minus sign goes before, and what is behind: cos n − 1 is −(1 − cos n)."""
    if is_negative(coefficient):
        return True, -coefficient
    for factor in sp.Mul.make_args(sp.fraction(coefficient)[0]):
        if factor.is_Add and factor.as_coeff_Add()[0].is_negative:
            return True, coefficient / factor * sp.Add(*(-term for term in factor.args))
    return False, coefficient
