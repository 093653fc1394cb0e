"""The quantities of a body in physical names: M, I₁, I₂, I₃ in place of the lengths behind them.

A body that is described by lengths and densities has long moments of inertia. They are shown once;
whatever follows from them is derived again for a body with these letters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from rigidsym.errors import QuantityError
from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import MINUS, PLUS, Formula, bracketed, joined, row
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.body import Parameter, RigidBody, given_inertia

Parts = Sequence[tuple[sp.Symbol, sp.Expr]]  # names with what they stand for

_AS_DESCRIBED = ("mass", "centre_of_mass", "principal_moments", "principal_axes")
_MOMENTS = sp.symbols("I_1:4")
_TURNED = formula(r"\boldsymbol{\Omega}")


def in_names(derivation: Derivation) -> tuple[Derivation, Parts]:
    """The derivation with its body's quantities in names, and the moments behind the names.

    It is returned as it is where its moments are short, or a name is taken.
    """
    body = derivation.body
    if body is None or all(entry.is_Atom for entry in (*body.inertia, body.mass)):
        return derivation, ()
    parts, letters = _named(body)
    taken = {str(symbol) for argument in derivation.arguments for symbol in argument.symbols}
    given = {symbol.name for symbol in letters.inertia.free_symbols | letters.mass.free_symbols}
    skipped = _AS_DESCRIBED if body.inertia.is_diagonal() else (*_AS_DESCRIBED, "inertia_tensor")
    present = [step.quantity.name for step in derivation.steps]
    of_body = (*INERTIA_QUANTITIES, *ENERGY_QUANTITIES)
    wanted = [name for name in of_body if name in present and name not in skipped]
    if given & taken - {str(body.mass)} or not wanted:
        return derivation, ()
    try:
        found = derive(derivation.model, wanted, body=letters)
    except QuantityError:  # moments in closed form, which the letters of their entries do not have
        wanted = [name for name in wanted if name != "inertia_ellipsoid"]
        found = derive(derivation.model, wanted, body=letters)
    again = {step.quantity.name: step for step in found.steps}
    steps = (
        replace(step, expression=again[step.quantity.name].expression)
        if step.quantity.name in wanted
        else step
        for step in derivation.steps
    )
    return replace(derivation, steps=tuple(steps)), parts if body.inertia.is_diagonal() else ()


def _named(body: RigidBody) -> tuple[Parts, RigidBody]:
    """The body with a letter for its mass and for each moment or product of inertia."""
    inertia = body.inertia
    if inertia.is_diagonal():
        pairs = [*zip(_MOMENTS, inertia.diagonal(), strict=True)]
        letters = {moment: name for name, moment in reversed(pairs)}
        tensor = sp.diag(*(letters[moment] if moment else moment for moment in inertia.diagonal()))
        parts = [(name, moment) for moment, name in reversed(letters.items()) if moment]
    else:
        tensor, parts = sp.Matrix(3, 3, lambda i, j: inertia[i, j] and _entry(i, j)), []
    mass = body.mass if body.mass.is_Symbol else sp.Symbol("M")
    return parts, given_inertia(
        tensor,
        mass=mass,
        centre=body.centre,
        name=body.name,
        parameters=[Parameter(symbol=s, positive=False) for s in tensor.free_symbols | {mass}],
        allow=True,
    )


def _entry(row: int, column: int) -> sp.Symbol:
    return sp.Symbol(f"I'_{min(row, column) + 1}{max(row, column) + 1}")


def textbook_form(name: str, derivation: Derivation) -> tuple[Formula, ...]:
    """E_R = ½ (I₁ Ω′₁² + I₂ Ω′₂² + I₃ Ω′₃²), L_R = I₂ Ω + (I₁ − I₂) Ω′₁ e′₁ + ...

    Empty for other quantities, and where the axes of the body are no principal axes with names.
    """
    inertia = next(
        (s.expression for s in derivation.steps if s.quantity.name == "inertia_tensor"), None
    )
    if inertia is None or not inertia.is_diagonal() or not all(e.is_Atom for e in inertia):
        return ()
    moments = [None if moment == 0 else named(str(moment)) for moment in inertia.diagonal()]
    numbered = [(k, moment) for k, moment in enumerate(moments, start=1) if moment]
    if name == "rotational_energy":
        terms = [formula(rf"#1\,{{\Omega'_{k}}}^2", moment) for k, moment in numbered]
        whole = joined(terms, PLUS)
        half = formula(r"\tfrac{1}{2}\,#1", bracketed(whole) if len(terms) > 1 else whole)
        return (half,)
    if name == "angular_momentum_rotation" and len(numbered) == 3:
        return (_momentum([moment for _, moment in numbered]),)
    return ()


def _momentum(moments: Sequence[Formula]) -> Formula:
    """I₂ Ω + (I₁ − I₂) Ω′₁ e′₁ + (I₃ − I₂) Ω′₃ e′₃, without what vanishes."""
    middle = moments[1]
    terms = [row(middle, _TURNED)]
    for k in (1, 3):
        if moments[k - 1] != middle:
            excess = bracketed(row(moments[k - 1], MINUS, middle))
            terms.append(formula(rf"#1\,\Omega'_{k}\,\mathbf{{e}}'_{k}", excess))
    return joined(terms, PLUS)
