"""ẏ = f(t, y): equations of motion in the form for integrators, and their first integrals.

The state y is made of two blocks, (q, q̇) in Lagrange's form and (q, Ω′) in Euler's. The rate of a
function F of the state is ∇F·f + ∂F/∂t, reduced in the ring: F is a first integral if it vanishes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import ModelError
from rigidsym.formula.reader import named
from rigidsym.formula.tree import Formula, with_names
from rigidsym.mechanics.derivation import Consequence, FirstIntegral, Proof, Quantity, Step
from rigidsym.mechanics.dynamics.consequences import of_free_body
from rigidsym.mechanics.kinematics.chain import Chain
from rigidsym.mechanics.kinematics.workspace import Workspace
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.table import (
    arguments_of,
    arguments_of_flow,
    arguments_of_motion,
    own_letters,
)
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import OMEGA_BODY, TIME, RotationModel

# A part of the state, and its time derivative as numerators over one divisor.
StateBlock: TypeAlias = tuple[Sequence[sp.Expr], RingMatrix, PolyElement]


class Flow(Workspace):
    """The equations of motion of one rotation, one body and the forces on it.

    A form of the equations gives its `blocks`, the first integrals that it has, and the table of
    its quantities.
    """

    table: Mapping[str, Quantity]
    second: str  # the argument beside q in the state
    kind: tuple[str, ...] = ()  # traits of this form
    lacking: tuple[str, ...] = ("error_state_jacobian",)  # functions of the state
    names: Chain | None = None  # for parts of the expressions, if they have names

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces, codec: Codec) -> None:
        self.model, self.forces, self.codec = model, forces, codec
        self.body: RigidBody = body
        self.arguments = {a.name: a for a in arguments_of(model, body)}
        self.letters = own_letters(self.arguments.values(), body, forces)
        self.added = arguments_of_motion(model)  # by the equations of motion
        self.added += arguments_of_flow([self.arguments["q"], self.arguments[self.second]])
        self.arguments |= {a.name: a for a in self.added}

    def steps(self, only: Sequence[str]) -> Iterator[Step]:
        """The quantities of motion that are wanted and that the system has."""
        steps = (self.step(entry) for n, entry in self.table.items() if not only or n in only)
        return filter(None, steps)

    @cached_property
    def traits(self) -> frozenset[str]:
        potential = self.forces.potential
        holds = {
            "no_potential": not potential,
            "no_gradient": not any(sp.diff(potential, q) for q in self.model.coordinates),
            "unforced": not any((*self.forces.generalised.values(), *self.forces.torque)),
            "driven": not self.driving.is_zero(),
            "stated_point": self.body.fixed_point is not None,
        }
        return frozenset((*self.kind, *(trait for trait in holds if holds[trait])))

    @property
    def blocks(self) -> tuple[StateBlock, StateBlock]:
        raise NotImplementedError

    def rate(self, value: sp.Expr) -> tuple[RingMatrix, PolyElement]:
        """dF/dt along the motion, as a numerator and its divisor."""
        # dF/dt = ∇₁F·n₁/d₁ + ∇₂F·n₂/d₂ + ∂F/∂t for the two blocks of the state, over d₁ d₂. The
        # common divisor keeps the residual a polynomial.
        (first, by_first, over_first), (second, by_second, over_second) = self.blocks
        y, column = self.arguments["y"].symbols, self.codec.column
        moving = (column(slopes_of(value, first, y)).T @ by_first).scale(over_second)
        moving += (column(slopes_of(value, second, y)).T @ by_second).scale(over_first)
        divisor = self.codec.ring.reduce(over_first * over_second)
        return moving + self.explicit_rate(value).scale(divisor), divisor

    def explicit_rate(self, value: sp.Expr) -> RingMatrix:
        """∂F/∂t at a fixed state."""
        return self.codec.column(slopes_of(value, [TIME], [TIME, *self.arguments["y"].symbols]))

    @cached_property
    def driving(self) -> RingMatrix:
        """∂V/∂t, at which a potential that depends on the time changes the energy."""
        return self.explicit_rate(self.forces.potential)

    @cached_property
    def first_integrals(self) -> tuple[FirstIntegral, ...]:
        """What is constant along every motion, with its proof."""
        claimed = (
            self.constant(name, named(name), value)
            for name, value in self.forces.first_integrals.items()
        )
        letters = self.letters
        own = (
            each._replace(
                symbol=letters.get(each.symbol, each.symbol), proof=each.proof.in_letters(letters)
            )
            for each in self.own_integrals()
        )
        return (*own, *claimed)

    def own_integrals(self) -> Iterator[FirstIntegral]:
        """The first integrals that this form of the equations looks for."""
        raise NotImplementedError

    def consequences(self) -> Iterator[Consequence]:
        """What follows of the motion as a whole."""
        if not self.driving.is_zero():
            rate = claims.energy.presented(self.traits).laws[0].claim
            rate, driving = with_names((rate, claims.DRIVING), self.letters)
            yield Consequence(
                name="driven_energy",
                spans={"rate": rate},
                left=driving,
                value=self.present.matrix(self.driving)[0],
            )
        if self.forces.leave_free(self.model):
            # The results for the free body are about dΩ′/dt at N′ = 0.
            still = dict.fromkeys(self.arguments["torque"].symbols, sp.S.Zero)
            slopes = self.free_turning.xreplace(still)
            yield from of_free_body(self, self.body.inertia, [*slopes])

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """The value with Ω′ written in the state."""
        return value

    def constant(self, name: str, symbol: Formula, value: sp.Expr) -> FirstIntegral:
        """One that is claimed. Raises DerivationError if it is not constant."""
        value = self.in_state(value)
        residual, divisor = self.rate(value)
        proof = self.prove.vanishes(residual, claims.is_constant(symbol), divisor)
        return FirstIntegral(name=name, symbol=symbol, expression=value, proof=proof)

    def functions(self, only: Collection[str]) -> Mapping[str, Step]:
        """The derivative of the state, its Jacobians and the first integrals, if wanted."""
        lacking = {*self.lacking} | (set() if self.first_integrals else {"first_integrals"})
        wanted = {*(only or claims.FLOW_QUANTITIES)} - lacking
        steps = (self.step(entry) for n, entry in claims.FLOW_QUANTITIES.items() if n in wanted)
        return {step.quantity.name: step for step in steps if step}

    @cached_property
    def state_derivative(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(
            [e for _, above, below in self.blocks for e in self.present.matrix(above, below)]
        )

    @property
    def state_jacobian(self) -> sp.ImmutableMatrix:
        symbols = self.arguments["y"].symbols
        return sp.ImmutableMatrix([slopes_of(s, symbols, symbols) for s in self.state_derivative])

    @cached_property
    def free_turning(self) -> sp.ImmutableMatrix:
        return free_turning(self.body.inertia, self.arguments["torque"].symbols)

    def excess_torque(self, slopes: sp.MatrixBase) -> sp.MatrixBase:
        """I′ dΩ′/dt + Ω′ × I′ Ω′ − N′."""
        omega, torque = (sp.Matrix(self.arguments[n].symbols) for n in ("omega_body", "torque"))
        # Euler's equations read as a residual: zero if the slopes are right.
        inertia = self.body.inertia
        return inertia * slopes + omega.cross(inertia * omega) - torque


class LagrangeForm(Flow):
    """Lagrange's equations M q̈ + h = Q, of one body in its ring or of a tree in names."""

    table = claims.DYNAMICS_QUANTITIES
    second = "q_dot"
    kinetic: sp.Expr  # T
    momenta: Any  # p = ∂T/∂q̇
    power: Any  # of the forces; 0 of gyroscopic ones as well

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces, codec: Codec) -> None:
        super().__init__(model, body, forces, codec)
        self.q, self.rates = model.coordinates, self.arguments["q_dot"].symbols

    @cached_property
    def whole(self) -> sp.Expr:
        """E = T + V."""
        return self.kinetic + self.forces.potential

    def energy_is_constant(self, claim: Formula) -> Proof:
        """The proof, if nothing does work."""
        raise NotImplementedError

    def momentum_is_constant(self, k: int, claim: Formula) -> Proof | None:
        """The proof for the k-th, if it is."""
        raise NotImplementedError

    def own_integrals(self) -> Iterator[FirstIntegral]:
        """The energy, if nothing does work, and the momenta of coordinates that do not matter."""
        # dE/dt = Q·q̇ + ∂V/∂t
        if self.power.is_zero() and self.driving.is_zero():
            proof = self.energy_is_constant(claims.is_constant(claims.ENERGY))
            yield FirstIntegral("energy", claims.ENERGY, self.whole, proof)
        # Noether's theorem in its simplest case: pₖ is constant if nothing depends on qₖ.
        momenta, symbols = self._printed(self.momenta), self.arguments["momenta"].notation
        for k, q in enumerate(self.q):
            constant = self.momentum_is_constant(k, claims.momentum_is_constant(k + 1))
            if constant is not None:
                name = f"momentum_{q.func.__name__}"
                yield FirstIntegral(name, symbols[k], momenta[k], constant)


def free_turning(inertia: sp.ImmutableMatrix, torque: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
    """dΩ′/dt for free Ω′ and N′, in a ring of their own."""
    # Ω′ and N′ are independent symbols here, so no angle occurs and the ring stays small.
    codec = codec_for([e for e in (*inertia, *OMEGA_BODY, *torque) if e != 0], order=0)
    tensor, w, n = codec.matrix(inertia), *map(codec.column, (OMEGA_BODY, torque))
    above, below = solved_euler(tensor, w, n, codec.ring.one)
    if not inertia.is_diagonal():
        return presenter_for(codec).matrix(above, below)
    # Each component over its own moment: the ring finds no common factor of fractions. Textbooks
    # keep I₂ − I₃ together, unless factors of the moments cancel.
    rows, slopes = (n - turned(tensor, w)).entries, []
    for k, row in enumerate(rows):
        short = presenter_for(codec).matrix(RingMatrix.column(codec.ring, [row]), tensor[k, k])[0]
        i, j = (k + 1) % 3, (k + 2) % 3
        gyroscopic = (inertia[i, i] - inertia[j, j]) * OMEGA_BODY[i] * OMEGA_BODY[j]
        whole = (torque[k] + gyroscopic) / inertia[k, k]
        slopes.append(min(whole, short, key=sp.count_ops))
    return sp.ImmutableMatrix(slopes)


def turned(tensor: RingMatrix, omega: RingMatrix) -> RingMatrix:
    """Ω′ × I′ Ω′."""
    return omega.cross(tensor @ omega)


def solved_euler(
    tensor: RingMatrix, omega: RingMatrix, torque: RingMatrix, below: PolyElement
) -> tuple[RingMatrix, PolyElement]:
    """I′⁻¹ (N′ − Ω′ × I′ Ω′) as n/d, for the torque `torque`/`below`.

    Raises ModelError if the tensor has no inverse.
    """
    if not tensor.det():
        raise ModelError("the inertia tensor has no inverse; expected three positive moments")
    # I′⁻¹ = adj(I′)/det I′, and the torque brings its own divisor.
    left = torque - turned(tensor, omega).scale(below)
    return tensor.adjugate() @ left, tensor.ring.reduce(tensor.det() * below)


def slopes_of(
    value: sp.Expr, symbols: Sequence[sp.Expr], independent: Sequence[sp.Expr]
) -> list[sp.Expr]:
    """The derivatives of a value by symbols; a rate does not follow its coordinate."""
    plain = {symbol: sp.Dummy() for symbol in reversed(independent)}  # the rates first
    back = {dummy: symbol for symbol, dummy in plain.items()}
    frozen = value.xreplace(plain)
    return [sp.diff(frozen, plain[symbol]).xreplace(back) for symbol in symbols]
