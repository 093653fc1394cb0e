"""The door of the room: a rotation, and perhaps a body that turns so, become a Derivation.

1. A body that is only described is integrated (`mass.bodies`).
2. The kinematics of the rotation follow from R(q) (`kinematics.derive`), or for a long product
   of turns turn by turn (`kinematics.turn_by_turn`).
3. The inertia of the body, its energy and its momentum follow (`mass.derive`, `energy.derive`).
4. The steps are numbered, and described by the tables of `quantities`.
5. With forces, the equations of motion follow (`dynamics.derive`).
6. The singular orientations follow (`singularities.derive`).
7. The equations of the lecture may go before all of it (`lecture.derive`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.errors import QuantityError, offer
from rigidsym.mechanics.derivation import (
    OF_RATES,
    Definition,
    Derivation,
    Found,
    OfBody,
    Quantity,
    Singularities,
    Step,
)
from rigidsym.mechanics.kinematics.derive import Expanded, is_shorter
from rigidsym.mechanics.kinematics.turn_by_turn import TurnByTurn
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities.dynamics import (
    DYNAMICS_QUANTITIES,
    EULER_QUANTITIES,
    FLOW_QUANTITIES,
)
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import QUANTITY_NAMES, quantities
from rigidsym.mechanics.quantities.mass import BODY_ALONE, INERTIA_QUANTITIES, OF_BODY_ALONE
from rigidsym.mechanics.singularities.chains import planes_of_axes
from rigidsym.mechanics.singularities.derive import singularities_of
from rigidsym.models.body import BodyDescription, RigidBody
from rigidsym.models.distribution import Distribution
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import RotationModel, depends_on_time

_STUDIED = 5  # turns up to which the minors of W are few enough to solve for their zeros

Body = RigidBody | BodyDescription | Distribution


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
        from rigidsym.mechanics.lecture.derive import NEEDED, with_theory

        wanted = only and {*only, *NEEDED}
        return with_theory(derive(model, wanted, body=body, forces=forces))
    _check_names(only, has_body=body is not None, has_forces=forces is not None)
    if BODY_ALONE in only:
        only = {*only, *OF_BODY_ALONE}
    turns = TurnByTurn(model) if is_shorter(model) else None
    values = Values(model)
    turning = [name for name in only if name in QUANTITY_NAMES]
    found = dict((turns or Expanded(values)).steps(turning or only))
    absent = ", ".join(name for name in turning if name not in found)
    if absent:
        raise QuantityError(
            f"{model.name} has no quantity {absent}: its rate matrix has no inverse, since its "
            "rates do not give every angular velocity"
        )
    of_body = OfBody(values.arguments)
    if body is not None:
        from rigidsym.mechanics.body_steps import steps_of_body

        of_body = steps_of_body(model, body, forces, only, turns)
        found |= of_body.steps
    arguments = of_body.arguments
    has_rates = not only or not OF_RATES.isdisjoint(only)
    singularities = _singularities(values, turns) if has_rates else None
    named = [*(step.expression for step in found.values())]
    named += singularities.minors if singularities else ()
    definitions = turns.definitions(named) if turns else ()
    constants = set(arguments["parameters"].symbols) if "parameters" in arguments else set()
    constants |= _resting_on(constants, definitions)
    inputs = _Inputs(constants, is_driven=forces is not None and forces.depend_on_time)
    return Derivation(
        name=model.name,
        title=model.title,
        model=model,
        arguments=tuple(arguments.values()),
        steps=tuple(map(inputs.of, _numbered(found, {**_table(values), **of_body.table}))),
        functions=_LazySteps(
            {name: partial(inputs.of_made, make) for name, make in of_body.functions.items()}
        ),
        singularities=singularities,
        body=of_body.body,
        forces=forces,
        definitions=definitions,
        first_integrals=of_body.first_integrals,
        consequences=of_body.consequences,
    )


def _singularities(values: Values, turns: TurnByTurn | None) -> Singularities:
    """Where the rates fail; of many turns as far as that is easily told."""
    if turns is None:
        return singularities_of(values)
    margin = turns.singularities()
    found = planes_of_axes(values.model, margin.minors) if margin.rank == 3 else None
    is_easy = len(values.model.turns) <= _STUDIED and not any(
        turn.components for turn in values.model.turns
    )
    return found or (singularities_of(values) if is_easy else margin)


def _resting_on(
    constants: Collection[sp.Symbol], definitions: Sequence[Definition]
) -> set[sp.Symbol]:
    """The named intermediate quantities that depend on a constant."""
    found: set[sp.Symbol] = set()
    for definition in definitions:
        if not definition.expression.free_symbols.isdisjoint({*constants, *found}):
            found.add(definition.symbol)
    return found


def _check_names(only: Collection[str], *, has_body: bool, has_forces: bool) -> None:
    of_body = (BODY_ALONE, *INERTIA_QUANTITIES, *ENERGY_QUANTITIES)
    of_motion = (*DYNAMICS_QUANTITIES, *EULER_QUANTITIES, *FLOW_QUANTITIES)
    known = (*QUANTITY_NAMES, *(of_body if has_body else ()), *(of_motion if has_forces else ()))
    for name in only:
        if name not in known:
            lacking = "a body" if name in of_body else "a body and forces or a potential"
            why = f"it needs {lacking}" if name in (*of_body, *of_motion) else offer(name, known)
            raise QuantityError(f"no quantity {name}; {why}")


def _table(values: Values) -> dict[str, Quantity]:
    """Every quantity by name, as it is called for this model."""
    units = set(values.arguments["q_dot"].units)
    of_rotation = quantities(
        passive=values.model.passive,
        coordinates=len(values.model.coordinates),
        rate_unit=units.pop() if len(units) == 1 else "",
    )
    matrix = of_rotation["rotation_matrix"]
    if not values.model.passive:  # where R is found: equation 17 of the lecture is that of ZXZ
        matrix = matrix._replace(source=values.model.source)
    of_rotation = {**of_rotation, "rotation_matrix": matrix}
    return {**of_rotation, **INERTIA_QUANTITIES, **ENERGY_QUANTITIES}


def _numbered(found: Mapping[str, Found], table: Mapping[str, Quantity]) -> Iterator[Step]:
    for number, (name, step) in enumerate(found.items(), start=1):
        quantity = table[name]
        if step.definition is not None:
            quantity = quantity._replace(definition=step.definition)
        yield Step(
            number=number,
            quantity=quantity,
            expression=step.expression,
            because=step.because,
            proofs=step.proofs,
            vector_form=step.vector_form,
            recursion=step.recursion,
        )


class _LazySteps(Mapping[str, Step]):
    """Steps by name, each derived when it is first asked for."""

    def __init__(self, makers: Mapping[str, Callable[[], Step]]) -> None:
        self._makers, self._made = makers, dict[str, Step]()

    def __getitem__(self, name: str) -> Step:
        if name not in self._made:
            self._made[name] = self._makers[name]()
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


class _Inputs(NamedTuple):
    """What quantities may depend on besides the inputs that their table names."""

    constants: Collection[sp.Symbol]
    is_driven: bool  # whether the time may occur by itself

    def of_made(self, make: Callable[[], Step]) -> Step:
        return self.of(make())

    def of(self, step: Step) -> Step:
        """The step with the time and the parameters among its inputs if it depends on them."""
        inputs = step.quantity.inputs
        if self.is_driven and "t" not in inputs and depends_on_time(step.expression):
            inputs += ("t",)
        if self.constants and not step.expression.free_symbols.isdisjoint(self.constants):
            inputs += ("parameters",)
        if inputs == step.quantity.inputs:
            return step
        return replace(step, quantity=step.quantity._replace(inputs=inputs))
