"""The door of the room: a rotation, and perhaps a body that turns so, become a Derivation.

1. The kinematics of the rotation follow from R(q), entry by entry of `quantities.kinematics`, in
   the ring of the model (`kinematics.workspace`), or in names for a chain (`kinematics.chain`).
2. The inertia of the body, its energy and its momentum follow; with forces, the equations of motion
   (`body`, `dynamics.lagrange`).
3. The steps are numbered.
4. The singular orientations follow (`singularities.derive`).
5. The equations of the lecture may go before all of it (`lecture`).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.errors import QuantityError
from rigidsym.mechanics.derivation import OF_RATES, Derivation, Step, sentence_of
from rigidsym.mechanics.kinematics.chain import Chain, is_shorter
from rigidsym.mechanics.kinematics.workspace import values_of
from rigidsym.mechanics.quantities import check_quantity
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.mass import BODY_ALONE, OF_BODY_ALONE
from rigidsym.mechanics.singularities import singularities_of
from rigidsym.models.rotation import RotationModel, depends_on_time

if TYPE_CHECKING:
    from rigidsym.mechanics.dynamics.flow import Flow
    from rigidsym.models.body import Body
    from rigidsym.models.forces import Forces


def derive(
    model: RotationModel,
    only: Collection[str] = (),
    *,
    body: Body | None = None,
    forces: Forces | None = None,
    theory: bool = False,
) -> Derivation:
    """The kinematics of a rotation model, each step proved; with a body its energies and momenta.

    `only` names the quantities to derive; all there are if it is empty. With `forces` the
    equations of motion of the body about a fixed point follow. `theory` puts the equations of the
    lecture before them.

    Raises NotARotation for a matrix with R Rᵀ ≠ 1 or det R ≠ 1, AlgebraError for expressions that
    the ring cannot hold, BodyError for a body that cannot be, ModelError if a name means two
    things, and QuantityError for quantities that are unknown or that the model or body lacks.
    """
    if theory:
        from rigidsym.mechanics.lecture import NEEDED, with_theory

        wanted = only and {*only, *NEEDED}
        return with_theory(derive(model, wanted, body=body, forces=forces))
    for name in only:
        check_quantity(name, body=body, forces=forces)
    if BODY_ALONE in only:
        only = {*only, *OF_BODY_ALONE}
    if body is not None:
        from rigidsym.mechanics.body import about_fixed_point, steps_of_body
        from rigidsym.mechanics.mass.bodies import rigid_body

        body = rigid_body(body)
        if forces is not None:
            forces = forces.in_symbols_of(body)
            body = forces.with_parameters(body, model)
            body = about_fixed_point(body, forces)
    taken = [parameter.symbol.name for parameter in body.parameters] if body else []
    chain, values = Chain(model, taken) if is_shorter(model) else None, values_of(model)
    turning = [name for name in only if name in KINEMATICS]
    work, wanted = chain or values, turning or only
    rotation, *others = KINEMATICS.values()
    first = work.step(rotation)  # in any case, since all else rests on its proof
    assert first is not None
    if not model.passive:  # where R is found: equation 17 of the lecture is that of ZXZ
        first = replace(first, quantity=first.quantity._replace(source=model.source))
    steps = [first] if not wanted or rotation.name in wanted else []
    derived = (work.step(entry) for entry in others if not wanted or entry.name in wanted)
    steps += filter(None, derived)
    if absent := set(turning) - {step.quantity.name for step in steps}:
        entries = [KINEMATICS[name].presented(work.traits) for name in turning if name in absent]
        lacking = ", ".join(entry.name for entry in entries)
        reasons = "; ".join(dict.fromkeys(sentence_of(entry.without) for entry in entries))
        raise QuantityError(f"{model.name} has no quantity {lacking}: {reasons}")
    has_rates = not only or any(KINEMATICS[name].section == OF_RATES for name in turning)
    singularities = singularities_of(values) if has_rates and not chain else None
    motion: Flow | None = None
    if body is not None:
        values, moving, motion = steps_of_body(model, body, forces, only, chain)
        steps += moving
    arguments, definer, is_driven = values.arguments, chain, False
    functions = {**motion.functions(only)} if motion else {}
    has_consequences = not only or "effective_potential" in only
    named = [step.expression for step in steps]
    if motion:
        forces, definer = motion.forces, motion.names or chain
        is_driven = forces.depend_on_time
        arguments = arguments | {argument.name: argument for argument in motion.added}
        named += [step.expression for step in functions.values()]
        named += [sp.Matrix([integral.expression]) for integral in motion.first_integrals]
    definitions = definer.definitions_of(named) if definer else ()
    constants = {*arguments["parameters"].symbols} if "parameters" in arguments else set()
    for symbol, expression in definitions:
        if not expression.free_symbols.isdisjoint(constants):
            constants.add(symbol)

    def finished(step: Step, number: int = 0) -> Step:
        """The step with its number, and with the time and the parameters that it depends on."""
        quantity, inputs = step.quantity, step.quantity.inputs
        if is_driven and "t" not in inputs and depends_on_time(step.expression):
            inputs += ("t",)
        if constants and not step.expression.free_symbols.isdisjoint(constants):
            inputs += ("parameters",)
        return replace(step, number=number, quantity=quantity._replace(inputs=inputs))

    return Derivation(
        name=model.name,
        title=model.title,
        model=model,
        arguments=tuple(arguments.values()),
        steps=tuple(map(finished, steps, count(1))),
        functions={name: finished(step) for name, step in functions.items()},
        singularities=singularities,
        body=values.body,
        about_fixed_point=values.has_fixed_point,
        forces=forces,
        definitions=definitions,
        first_integrals=motion.first_integrals if motion else (),
        consequences=tuple(motion.consequences()) if motion and has_consequences else (),
    )
