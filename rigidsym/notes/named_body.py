"""The quantities of a body in physical names: M, I₁, I₂, I₃ in place of the lengths behind them.

A body that is described by lengths and densities has long moments of inertia. They are shown once;
whatever follows from them is derived again for a body with these letters. A point P has its
distance d = p − c from the centre of mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula, named
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import NOTHING, Formula, with_names
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.quantities.dynamics import DYNAMICS_QUANTITIES
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.mass import INERTIA, INERTIA_QUANTITIES, STEINER
from rigidsym.mechanics.quantities.table import POINT, own_names
from rigidsym.models.rotation import OMEGA_BODY

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody
    from rigidsym.models.forces import Forces

Parts = Sequence[tuple[sp.Symbol, sp.Expr]]  # names with what they stand for

_AS_DESCRIBED = ("mass", "centre_of_mass", "principal_moments", "principal_axes")
_ABOUT_POINT = ("inertia_tensor_point", "moment_of_inertia")
OFFSET = tuple(sp.Symbol(f"d_{axis}") for axis in "xyz")
_SHORT = 3  # operations of a moment such as m l² or 2 A, which needs no letter in a motion
_DISTANCE = formula(r"\mathbf{d}")


def in_names(derivation: Derivation) -> tuple[Derivation, Parts]:
    """The derivation with its body's quantities in names, and the moments behind the names.

    It is returned as it is where its moments are short, or a name is taken.
    """
    body = derivation.body
    if body is None:
        return derivation, ()
    from rigidsym.mechanics.dynamics.flow import free_turning  # with all that bodies need

    is_short = all(entry.is_Atom for entry in body.inertia)
    has_offset = any(body.centre) and body.fixed_point is None
    own = own_names(derivation.arguments, body, derivation.forces)
    moments = [] if is_short else [sp.Symbol(own[f"I_{k}"]) for k in (1, 2, 3)]
    mass = body.mass if isinstance(body.mass, sp.Symbol) else sp.Symbol(own["M"])
    parts, letters = _named(body, mass, moments)
    renamed = [*_ABOUT_POINT] if has_offset else []
    if not is_short or mass != body.mass:
        renamed = [n for n in (*INERTIA_QUANTITIES, *ENERGY_QUANTITIES) if n not in _AS_DESCRIBED]
        if not body.inertia.is_diagonal():
            renamed.remove("inertia_tensor")
    present = {step.quantity.name for step in derivation.steps}
    forces = _moving(derivation)
    renamed += [n for n in DYNAMICS_QUANTITIES if forces]
    taken = {letter for argument in derivation.arguments for letter in argument.notation}
    names = {named(str(name)) for name in OFFSET} if has_offset else set()
    if present.isdisjoint(renamed) or taken & names:
        return derivation, ()
    wanted = [] if forces else [n for n in renamed if n in present]
    again = derive(derivation.model, wanted, body=letters, forces=forces)
    expressions = {step.quantity.name: step.expression for step in again.steps}
    steiner = formula(STEINER, INERTIA, named(letters.mass.name), _DISTANCE, _DISTANCE)
    steps = []
    for step in derivation.steps:
        name, quantity = step.quantity.name, step.quantity
        expression = expressions.get(name, step.expression) if name in renamed else step.expression
        if name in expressions and has_offset and name in _ABOUT_POINT:
            expression = expression.xreplace(dict(zip(POINT, OFFSET, strict=True)))
            if name == "inertia_tensor_point":
                quantity = quantity._replace(definition=steiner)
        elif name == "angular_acceleration_from_torque" and moments:
            short = free_turning(letters.inertia, derivation.argument("torque").symbols)
            expression = min(expression, short, key=sp.count_ops)
        steps.append(replace(step, quantity=quantity, expression=expression))
    if mass != body.mass and "mass" not in present and any(_holds(s, mass) for s in steps):
        parts = (*parts, (mass, body.mass))
    derivation = replace(derivation, steps=tuple(steps))
    if forces:
        integrals = tuple(derivation.first_integrals and again.first_integrals)
        consequences = tuple(derivation.consequences and again.consequences)
        derivation = replace(derivation, first_integrals=integrals, consequences=consequences)
    return derivation, parts


def _moving(derivation: Derivation) -> Forces | None:
    """The forces, if the equations of motion are shorter with letters for the principal moments.

    Claims may rest on the values of the moments, and equations in names have their own letters.
    """
    body, forces = derivation.body, derivation.forces
    if body is None or forces is None or derivation.definitions or forces.first_integrals:
        return None
    is_long = body.inertia.is_diagonal() and max(map(sp.count_ops, body.inertia)) > _SHORT
    return replace(forces, fixed_point=(), examples=()) if is_long else None


def _holds(step: Step, mass: sp.Symbol) -> bool:
    """Whether the letter of the mass is in the equation of a step, or in what is claimed of it."""
    formulas = (step.quantity.definition, *(proof.claim for proof in step.proofs))
    letter = {named(mass.name): NOTHING}
    return step.expression.has(mass) or with_names(formulas, letter) != formulas


def _named(body: RigidBody, mass: sp.Symbol, own: Sequence[sp.Symbol]) -> tuple[Parts, RigidBody]:
    """The body about its centre of mass, with a letter for each moment or product of inertia.

    If the body's own axes are principal axes, each letter comes with its value. A short tensor,
    for which there are none of its `own`, stays as it is.
    """
    from rigidsym.models.body import Parameter, given_inertia

    tensor, parts = body.inertia, []
    if tensor.is_diagonal() and own:
        pairs = [*zip(own, tensor.diagonal(), strict=True)]
        # Reversed, so that equal moments have the first of their names: (I₁, I₁, I₃).
        names = {moment: name for name, moment in reversed(pairs) if moment}
        parts = [(name, moment) for moment, name in reversed(names.items())]
        tensor = sp.diag(*(names.get(moment, moment) for moment in tensor.diagonal()))
    elif own:
        entries = [[f"I'_{min(i, j) + 1}{max(i, j) + 1}" for j in range(3)] for i in range(3)]
        tensor = sp.Matrix(3, 3, lambda i, j: body.inertia[i, j] and sp.Symbol(entries[i][j]))
    return parts, given_inertia(
        tensor,
        mass=mass,
        name=body.name,
        parameters=[Parameter(symbol=s, positive=False) for s in tensor.free_symbols | {mass}],
        allow=True,
    )


def textbook_form(name: str, derivation: Derivation, letters: Letters) -> tuple[Formula, ...]:
    """E_R = ½ (I₁ Ω′₁² + I₂ Ω′₂² + I₃ Ω′₃²).

    Empty for other quantities, and where the axes of the body are no principal axes with names.
    """
    expressions = {step.quantity.name: step.expression for step in derivation.steps}
    inertia = expressions.get("inertia_tensor")
    if name != "rotational_energy" or inertia is None or not inertia.is_diagonal():
        return ()
    moments = [*inertia.diagonal()]
    if not all(moment.is_Atom for moment in moments):
        return ()
    whole = sp.Add(*(i * omega**2 for i, omega in zip(moments, OMEGA_BODY, strict=True)))
    return (formula_of(sp.Mul(sp.Rational(1, 2), whole, evaluate=False), letters),)
