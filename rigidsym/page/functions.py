"""The functions of a live page: R, Ω, Ω′, the margin, the turns, the constraints and the motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import sympy as sp

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets import javascript
from rigidsym.mechanics.derivation import Derivation, FirstIntegral, Step
from rigidsym.mechanics.derive import derive as derivation_of
from rigidsym.models.body import RigidBody
from rigidsym.models.rotation import RotationModel
from rigidsym.page.stage import has_turns, step_of, turns_step

SHOWN = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
FLOW = ("state_derivative", "first_integrals")
CONDITIONS = ("conditions", "condition_slopes")

_WITH_A_MARGIN = "rate_matrix_space"


@dataclass(frozen=True, kw_only=True, slots=True)
class Functions:
    """The kernels of a page, and their text."""

    derivation: Derivation  # of the quantities shown
    kernels: tuple[Kernel, ...]
    integrals: tuple[FirstIntegral, ...] = ()  # of the equations of motion

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps of the quantities shown."""
        return tuple(step for step in self.derivation.steps if step.quantity.name in SHOWN)

    @property
    def second(self) -> str:
        """What is beside q in the state y: the rates, or Ω′ of a motion in Euler's form."""
        arguments = {a.name: a for a in self.derivation.arguments}
        if "y" not in arguments or arguments["y"].names[-3:] != arguments["omega_body"].names:
            return "q_dot"
        return "omega_body" if self.is_motion else "q_dot"

    @property
    def is_motion(self) -> bool:
        """Whether the equations of motion are integrated; else the rates are constant."""
        return any(kernel.name == FLOW[0] for kernel in self.kernels)

    @property
    def constants(self) -> tuple[sp.Symbol, ...]:
        """The constants in the order of the functions."""
        constants = [a.symbols for a in self.derivation.arguments if a.name == "parameters"]
        return tuple(constants[0]) if constants else ()

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
    flow = tuple(derivation.step(name) for name in FLOW if name in derivation.functions)
    flow += tuple(_moments(derivation)) if flow else ()
    steps = tuple(replace(s, number=0) for s in (*shown.steps, *_more(shown), *flow))
    shown = replace(shown, arguments=tuple(whole.values()), steps=steps, functions={})
    program = lower(shown, javascript.RESERVED)
    return Functions(
        derivation=shown,
        kernels=tuple(k for k in program.kernels if k.name != _WITH_A_MARGIN),
        integrals=derivation.first_integrals if flow else (),
    )


def moments_of(body: RigidBody | None) -> tuple[sp.Expr, ...]:
    """The principal moments, if the axes of the body are principal axes."""
    if body is None or not body.inertia.is_diagonal():
        return ()
    return tuple(body.inertia.diagonal())


def _moments(derivation: Derivation) -> Iterator[Step]:
    """The principal moments, if they depend on constants."""
    moments = sp.Matrix(moments_of(derivation.body))
    if moments.free_symbols:
        step = step_of("moments", moments, "principal moments", (), derivation.model)
        yield replace(step, quantity=step.quantity._replace(inputs=("parameters",)))


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
