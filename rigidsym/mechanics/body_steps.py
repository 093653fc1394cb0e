"""What a rotation and a body have together: inertia, energy, momentum and equations of motion."""

from __future__ import annotations

from collections.abc import Collection

import sympy as sp

from rigidsym.errors import QuantityError
from rigidsym.mechanics.derivation import OF_CENTRE, Found, OfBody, Quantity
from rigidsym.mechanics.dynamics.derive import equations_of_motion
from rigidsym.mechanics.energy import derive as energy
from rigidsym.mechanics.kinematics.turn_by_turn import TurnByTurn
from rigidsym.mechanics.kinematics.workspace import NamedRotation, Values
from rigidsym.mechanics.mass import derive as mass
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.mechanics.quantities.dynamics import FLOW_QUANTITIES
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.mass import BODY_ALONE, INERTIA_QUANTITIES, OF_BODY_ALONE
from rigidsym.models.body import BodyDescription, RigidBody
from rigidsym.models.distribution import Distribution
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import RotationModel


def steps_of_body(
    model: RotationModel,
    body: RigidBody | BodyDescription | Distribution,
    forces: Forces | None,
    only: Collection[str],
    turns: TurnByTurn | None,
) -> OfBody:
    """The body, integrated, with the steps to its quantities.

    With `turns` R and Ω′ are those that their recursions name.
    """
    whole = rigid_body(body)
    if forces is not None:
        whole = forces.with_parameters(whole, model)
    is_fixed = forces is not None and forces.fix_a_point and whole.distribution is None
    is_fixed = is_fixed and OF_CENTRE.isdisjoint(only)
    wanted = only or {*INERTIA_QUANTITIES, *ENERGY_QUANTITIES} - (OF_CENTRE if is_fixed else set())
    values = (NamedRotation if turns else Values)(model, whole, also=energy.OF_PARTICLES)
    found = dict(mass.steps(values, [n for n in INERTIA_QUANTITIES if n in wanted]))
    asked = set(only) - (set(OF_BODY_ALONE) if BODY_ALONE in only else set())
    absent = [name for name in INERTIA_QUANTITIES if name in asked and name not in found]
    if absent:
        reasons = (f"no quantity {name}: {mass.WITHOUT[name]}" for name in absent)
        raise QuantityError(f"{whole.name} has {'; '.join(reasons)}")
    if is_fixed and "inertia_tensor" in found:
        because = "The inertia tensor of the body is given, about the fixed point."
        found["inertia_tensor"] = found["inertia_tensor"]._replace(because=because)
    found |= energy.steps(values, [n for n in ENERGY_QUANTITIES if n in wanted])
    if turns is not None:
        found = {name: _renamed(step, turns) for name, step in found.items()}
    if forces is None:
        return OfBody(values.arguments, found, whole)
    motion = equations_of_motion(model, whole, forces)
    found |= motion.steps(tuple(only))
    asks = not only or not {*only}.isdisjoint(FLOW_QUANTITIES)
    functions = motion.functions() if asks else {}
    follows = not only or "effective_potential" in only
    return OfBody(
        arguments={**values.arguments, **{a.name: a for a in motion.added}},
        steps=found,
        body=whole,
        functions={n: f for n, f in functions.items() if not only or n in only},
        first_integrals=motion.first_integrals,
        consequences=tuple(motion.consequences()) if follows else (),
        table={**motion.table, **(_about_fixed_point() if is_fixed else {})},
    )


def _about_fixed_point() -> dict[str, Quantity]:
    """The quantities that are otherwise about the centre of mass."""
    return {
        name: q._replace(about=q.about.replace("the centre of mass", "the fixed point"))
        for name, q in {**INERTIA_QUANTITIES, **ENERGY_QUANTITIES}.items()
        if "about the centre of mass" in q.about
    }


def _renamed(step: Found, turns: TurnByTurn) -> Found:
    """The step with R and Ω′ as the recursions over the turns name them, and are proved to be."""
    recursion = turns.recursion
    names = dict(zip(NamedRotation.names().matrix, recursion.partial[-1], strict=True))
    names |= dict(zip(NamedRotation.velocity, recursion.omega_body[-1], strict=True))
    if not step.expression.has(*names):
        return step
    proofs = [p for n in ("rotation_matrix", "angular_velocity_body") for p in turns.proofs(n)]
    expression = sp.ImmutableMatrix(step.expression.xreplace(names))
    return step._replace(expression=expression, proofs=(*step.proofs, *proofs))
