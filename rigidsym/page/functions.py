"""The functions of a live page: live quantities, the margin, the turns, constraints, the motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import sympy as sp

from rigidsym.formula.tree import Symbol
from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.targets import javascript
from rigidsym.mechanics.derivation import Derivation, FirstIntegral, Quantity, Step
from rigidsym.mechanics.derive import derive as derivation_of
from rigidsym.mechanics.quantities.dynamics import MOTION
from rigidsym.models.body import RigidBody
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.figure.scene import MOST_TURNS
from rigidsym.system.records import Record

OF_THE_FIGURE = ("rotation_matrix", "angular_velocity_space", "angular_velocity_body")
_FLOW = ("state_derivative", "first_integrals")


class Functions(Record, kw_only=True):
    """The kernels of a page, and what they are made from."""

    derivation: Derivation  # of all functions
    live: tuple[Step, ...]  # the quantities whose values the page shows
    kernels: tuple[Kernel, ...]
    integrals: tuple[FirstIntegral, ...] = ()  # of the equations of motion

    @property
    def is_motion(self) -> bool:
        """Whether the equations of motion are integrated; else the rates are constant."""
        return any(kernel.name == _FLOW[0] for kernel in self.kernels)

    @property
    def second(self) -> str:
        """What is beside q in the state y: the rates, or Ω′ of a motion in Euler's form."""
        names = {argument.name: argument.names for argument in self.derivation.arguments}
        is_euler = self.is_motion and names["y"][-3:] == names["omega_body"]
        return "omega_body" if is_euler else "q_dot"

    @property
    def constants(self) -> tuple[sp.Expr, ...]:
        """The constants in the order of the functions."""
        arguments = self.derivation.arguments
        return next((a.symbols for a in arguments if a.name == "parameters"), ())


def is_live(quantity: Quantity) -> bool:
    """Whether the page shows it: a result that changes with the orientation and its rates."""
    is_moved = {"q"} <= {*quantity.inputs} <= {"q", "q_dot", "parameters"}
    is_shown = quantity.shape != "matrix" and quantity.section != MOTION  # the motion is played
    return quantity.name in OF_THE_FIGURE or (quantity.is_result and is_moved and is_shown)


def functions_of(derivation: Derivation) -> Functions:
    """All functions that the page of a derivation evaluates."""
    needed = (*OF_THE_FIGURE, "rate_matrix_space")  # with singular orientations, and a margin
    whole = derivation
    if not {step.quantity.name for step in derivation.steps}.issuperset(needed):
        whole = derivation_of(derivation.model, needed)
    live = tuple(step for step in whole.steps if is_live(step.quantity))
    arguments = {argument.name: argument for argument in (*whole.arguments, *derivation.arguments)}
    flow = tuple(derivation.step(name) for name in _FLOW if name in derivation.functions)
    steps = (*live, *_more(derivation), *flow)
    merged = replace(
        whole.select(needed),
        body=None,
        forces=None,
        arguments=tuple(arguments.values()),
        steps=tuple(replace(step, number=0) for step in steps),
        functions={},
    )
    return Functions(
        derivation=merged,
        live=live,
        kernels=lower(merged, javascript.RESERVED).kernels,
        integrals=derivation.first_integrals if flow else (),
    )


def has_turns(model: RotationModel) -> bool:
    """Whether the figure shows the turns one by one; else the single turn that R is."""
    return 1 <= len(model.turns) <= MOST_TURNS


def moments_of(body: RigidBody | None) -> tuple[sp.Expr, ...]:
    """The principal moments, if the axes of the body are principal axes."""
    return tuple(body.inertia.diagonal()) if body and body.inertia.is_diagonal() else ()


def _function(name: str, matrix: sp.MatrixBase, *inputs: str) -> Step:
    """A function that is evaluated like the quantities, but is in no note."""
    quantity = Quantity(name=name, symbol=Symbol(name), inputs=inputs)
    return Step(quantity=quantity, expression=matrix.as_immutable())


def _more(derivation: Derivation) -> Iterator[Step]:
    """The turns, the constraints on the inputs with their slopes, and moments with constants."""
    model, moments = derivation.model, sp.Matrix(moments_of(derivation.body))
    constants = ("parameters",) if model.constants else ()
    if has_turns(model):
        rows = sp.Matrix([[*turn.direction, turn.angle, turn.rate] for turn in model.turns])
        yield _function("turns", rows, "q", "q_dot", *constants)
    conditions = sp.Matrix(model.constraints)
    if model.pullback is not None:  # of a matrix: R Rᵀ = 1
        # R Rᵀ is symmetric, so that R Rᵀ = 1 has six different entries.
        excess = model.matrix * model.matrix.T - sp.eye(3)
        conditions = sp.Matrix([excess[i, j] for i in range(3) for j in range(i, 3)])
    if conditions:
        slopes = conditions.jacobian([*model.coordinates, *model.constants])
        for name, values in (("conditions", conditions), ("condition_slopes", slopes)):
            yield _function(name, values, "q", *constants)
    if moments.free_symbols:
        yield _function("moments", moments, "parameters")
