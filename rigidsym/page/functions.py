"""The functions of a live page: R, Ω, Ω′, the margin, the turns, and the constraints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets.javascript import printer as javascript
from rigidsym.mechanics.derivation import Derivation, FirstIntegral, Step
from rigidsym.mechanics.derive import derive as derivation_of
from rigidsym.models.rotation import RotationModel
from rigidsym.page.growing_body import SHARE, places_of
from rigidsym.page.other_conventions import others
from rigidsym.page.stage import has_turns, quantity_of, step_of, turns_step

SHOWN = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
OF_BODY = ("mass", "inertia_tensor")  # of one that grows with its parameters
FLOW = ("state_derivative", "first_integrals")
CONDITIONS = ("conditions", "condition_slopes")

_WITH_A_MARGIN = "rate_matrix_space"


@dataclass(frozen=True, kw_only=True, slots=True)
class Functions:
    """The kernels of a page, and their text."""

    derivation: Derivation  # of the quantities shown
    kernels: tuple[Kernel, ...]
    others: tuple[dict[str, Any], ...] = ()  # the conventions to compare with
    integrals: tuple[FirstIntegral, ...] = ()  # of the equations of motion

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps of the quantities shown."""
        shown = (*SHOWN, *OF_BODY) if SHARE in self.derivation.arguments else SHOWN
        return tuple(step for step in self.derivation.steps if step.quantity.name in shown)

    @property
    def constants(self) -> tuple[sp.Symbol, ...]:
        """The constants in the order of the functions."""
        found = [a.symbols for a in self.derivation.arguments if a.name == "parameters"]
        return tuple(found[0]) if found else ()

    @property
    def symbols(self) -> set[sp.Basic]:
        """What the functions depend on."""
        steps = self.derivation.steps
        return {symbol for step in steps for symbol in step.expression.free_symbols}

    @property
    def source(self) -> str:
        return javascript.bare(self.kernels)

    @property
    def arguments(self) -> dict[str, tuple[str, ...]]:
        """The vectors that each function takes."""
        return {k.name: tuple(argument.name for argument in k.arguments) for k in self.kernels}


def functions_of(derivation: Derivation) -> Functions:
    """All functions that the page of a derivation evaluates."""
    names = (*SHOWN, _WITH_A_MARGIN)
    if {step.quantity.name for step in derivation.steps}.issuperset(names):
        shown = replace(derivation.select(names), body=None, forces=None)
    else:
        shown = derivation_of(derivation.model, names)
    whole = {argument.name: argument for argument in (*shown.arguments, *derivation.arguments)}
    flow = _flow(derivation)
    places = places_of(derivation.body)
    whole |= {SHARE.name: SHARE} if places else {}
    more = (*_more(shown), *flow, *_of_body(derivation, places))
    steps = tuple(replace(step, number=0) for step in (*shown.steps, *more))
    shown = replace(shown, arguments=tuple(whole.values()), steps=steps, functions={})
    program = lower(shown, javascript.RESERVED)
    compared = list(others(derivation.model))
    return Functions(
        derivation=shown,
        kernels=(
            *(k for k in program.kernels if k.name != _WITH_A_MARGIN),
            *(kernel for _, kernels in compared for kernel in kernels),
        ),
        others=tuple(data for data, _ in compared),
        integrals=derivation.first_integrals if flow else (),
    )


def _flow(derivation: Derivation) -> tuple[Step, ...]:
    """The equations of motion and what they conserve, where the state is coordinates and rates."""
    if not derivation.functions:
        return ()
    q, q_dot, y = (derivation.argument(name).symbols for name in ("q", "q_dot", "y"))
    is_plain = y == (*q, *q_dot)
    return tuple(f for n, f in derivation.functions.items() if is_plain and n in FLOW)


def _of_body(derivation: Derivation, places: Mapping[str, sp.ImmutableMatrix]) -> Iterator[Step]:
    """The mass, the centre and the moments of a body that grows, and where its points are."""
    if not places:
        return
    yield from (s for s in derivation.steps if s.quantity.name in (*OF_BODY, "centre_of_mass"))
    for name, place in places.items():
        quantity = quantity_of(name, "a point of the body", (SHARE.name, "parameters"))
        yield Step(number=0, quantity=quantity, expression=place, because="", proofs=())


def _more(derivation: Derivation) -> Iterator[Step]:
    model = derivation.model
    if has_turns(model):
        yield turns_step(model)
    bound = sp.Matrix(_conditions(model))
    if bound:
        inputs = [*model.coordinates, *model.constants]
        yield step_of(CONDITIONS[0], bound, "constraints, which vanish", ("q",), model)
        slopes = bound.jacobian(inputs)
        yield step_of(
            CONDITIONS[1], slopes, "derivatives of the constraints by all inputs", ("q",), model
        )


def _conditions(model: RotationModel) -> tuple[sp.Expr, ...]:
    """The constraints on the inputs; R Rᵀ = 1 if they are those of a matrix."""
    if model.pullback is None:
        return model.constraints
    left_over = model.matrix * model.matrix.T - sp.eye(3)
    return tuple(left_over[i, j] for i in range(3) for j in range(i, 3))
