"""ẏ = f(t, y): equations of motion in the form for integrators, and their first integrals.

The state y is made of two blocks, (q, q̇) in Lagrange's form and (q, Ω′) in Euler's. The rate of a
function F of the state is ∇F·f + ∂F/∂t, reduced in the ring: F is a first integral if it vanishes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from math import prod
from typing import NamedTuple

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import ModelError
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import (
    Consequence,
    FirstIntegral,
    Found,
    Quantity,
    Step,
)
from rigidsym.mechanics.dynamics.free import of_free_body
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.table import (
    arguments_of,
    arguments_of_flow,
    arguments_of_motion,
)
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import TIME, RotationModel


class StateBlock(NamedTuple):
    """A part of the state, and its time derivative as numerators over one divisor."""

    symbols: Sequence[sp.Expr]
    numerators: RingMatrix
    divisor: PolyElement


class Flow:
    """The equations of motion of one rotation, one body and the forces on it.

    A form of the equations gives its `blocks`, the first integrals that it has, and steps by the
    names of the quantities in `table`.
    """

    table: Mapping[str, Quantity]
    second: str  # the argument beside q in the state

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces, codec: Codec) -> None:
        self.model, self.body, self.forces, self.codec = model, body, forces, codec
        self.present = presenter_for(codec)
        self.prove = Prover(model, codec)
        self.arguments = {a.name: a for a in arguments_of(model)}
        self.added = arguments_of_motion(model)  # by the equations of motion
        self.added += arguments_of_flow([self.arguments["q"], self.arguments[self.second]])
        self.arguments |= {a.name: a for a in self.added}

    def steps(self, only: Sequence[str]) -> Iterator[tuple[str, Found]]:
        """(name, what was found) of the quantities of motion that are wanted."""
        for name in self.table:
            if not only or name in only:
                yield name, getattr(self, name)()

    @property
    def blocks(self) -> tuple[StateBlock, StateBlock]:
        raise NotImplementedError

    def rate(self, value: sp.Expr) -> tuple[RingMatrix, PolyElement]:
        """dF/dt along the motion, as a numerator and its divisor."""
        ring = self.codec.ring
        parts = []
        for block in self.blocks:
            others = [other.divisor for other in self.blocks if other is not block]
            slopes = self.codec.column(slopes_of(value, block.symbols, self.arguments["y"].symbols))
            parts.append((slopes.T @ block.numerators).scale(prod(others, start=ring.one)))
        divisor = prod((block.divisor for block in self.blocks), start=ring.one)
        return parts[0] + parts[1] + self.explicit_rate(value).scale(divisor), ring.reduce(divisor)

    def potential_energy(self) -> Found:
        potential = self.forces.potential
        has_one = "The body has the potential energy:"
        because = has_one if potential else "No potential acts on the body:"
        return Found(sp.ImmutableMatrix([[potential]]), because)

    def explicit_rate(self, value: sp.Expr) -> RingMatrix:
        """∂F/∂t, the state being held."""
        return self.codec.column(slopes_of(value, [TIME], [TIME, *self.arguments["y"].symbols]))

    @cached_property
    def driving(self) -> RingMatrix:
        """∂V/∂t, at which a potential that depends on the time changes the energy."""
        return self.explicit_rate(self.forces.potential)

    @property
    def energy_claim(self) -> Formula:
        return claims.energy_rate(self.second, is_driven=not self.driving.is_zero())

    @cached_property
    def first_integrals(self) -> tuple[FirstIntegral, ...]:
        """What is constant along every motion, with its proof."""
        claimed = (
            self.constant(name, claims.integral_symbol(name), value)
            for name, value in self.forces.first_integrals.items()
        )
        return (*self.own_integrals(), *claimed)

    def own_integrals(self) -> Iterator[FirstIntegral]:
        """The first integrals that this form of the equations looks for."""
        raise NotImplementedError

    def consequences(self) -> Iterator[Consequence]:
        """What follows of the motion as a whole."""
        if not self.driving.is_zero():
            yield Consequence(
                title="The energy",
                text="The potential depends on the time, so that the energy is not constant: {} "
                "with",
                spans=(self.energy_claim,),
                left=claims.DRIVING,
                value=self.present.matrix(self.driving)[0],
            )
        if self.forces.leave_free(self.model):
            still = dict.fromkeys(self.arguments["torque"].symbols, sp.S.Zero)
            slopes = self.angular_acceleration_from_torque().expression.xreplace(still)
            yield from of_free_body(self.body.inertia, list(slopes), self.model.name)

    def in_state(self, value: sp.Expr) -> sp.Expr:
        """The value with Ω′ written in the state."""
        return value

    def constant(self, name: str, symbol: Formula, value: sp.Expr) -> FirstIntegral:
        """One that is claimed. Raises DerivationError if it is not constant."""
        value = self.in_state(value)
        residual, divisor = self.rate(value)
        proof = self.prove.vanishes(residual, claims.is_constant(symbol), divided_by=divisor)
        return FirstIntegral(name=name, symbol=symbol, expression=value, proof=proof)

    def functions(self) -> Mapping[str, Callable[[], Step]]:
        """The derivative of the state, its Jacobians and the first integrals, each when needed."""
        return {
            name: partial(self._function, name)
            for name in claims.FLOW_QUANTITIES
            if hasattr(type(self), f"_{name}")
            and (name != "first_integrals" or self.first_integrals)
        }

    def _function(self, name: str) -> Step:
        return Step(
            number=0,
            quantity=claims.FLOW_QUANTITIES[name],
            expression=getattr(self, f"_{name}"),
            because="",
            proofs=(),
        )

    @cached_property
    def _state_derivative(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(
            [e for b in self.blocks for e in self.present.matrix(b.numerators, b.divisor)]
        )

    @property
    def _state_jacobian(self) -> sp.ImmutableMatrix:
        symbols = self.arguments["y"].symbols
        return sp.ImmutableMatrix([slopes_of(s, symbols, symbols) for s in self._state_derivative])

    @property
    def _first_integrals(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([i.expression for i in self.first_integrals])

    def angular_acceleration_from_torque(self) -> Found:
        """I′⁻¹ (N′ − Ω′ × I′ Ω′) for free Ω′ and N′, in a ring of their own."""
        omega, torque = self.arguments["omega_body"].symbols, self.arguments["torque"].symbols
        inertia = self.body.inertia
        codec = codec_for([e for e in (*inertia, *omega, *torque) if e != 0], order=0)
        w, n, tensor = codec.column(omega), codec.column(torque), codec.matrix(inertia)
        above, below = solved_euler(tensor, w, n, codec.ring.one)
        left = n - turned(tensor, w)
        residual = tensor @ above - left.scale(below)
        proof = Prover(self.model, codec).vanishes(residual, claims.EULER, divided_by=below)
        return Found(
            presenter_for(codec).matrix(above, below),
            "Euler's equations: the torque changes the angular momentum, which is written along "
            "the axes of the body.",
            (proof,),
        )


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
    left = torque - turned(tensor, omega).scale(below)
    return tensor.adjugate() @ left, tensor.ring.reduce(tensor.det() * below)


def slopes_of(
    value: sp.Expr, symbols: Sequence[sp.Expr], independent: Sequence[sp.Expr]
) -> list[sp.Expr]:
    """The derivatives of a value by symbols; a rate does not follow its coordinate."""
    plain = {symbol: sp.Dummy() for symbol in reversed(independent)}  # the rates first
    back = {dummy: symbol for symbol, dummy in plain.items()}
    held = value.xreplace(plain)
    return [sp.diff(held, plain[symbol]).xreplace(back) for symbol in symbols]
