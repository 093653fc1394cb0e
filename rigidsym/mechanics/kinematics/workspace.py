"""The matrices and vectors of one model over its ring."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import TYPE_CHECKING

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.mechanics.arguments import arguments_of
from rigidsym.mechanics.kinematics import composition
from rigidsym.mechanics.kinematics.composition import Factor, hat, unhat
from rigidsym.mechanics.kinematics.rates import Inverse, bound_on_rates, right_inverse
from rigidsym.models.rotation import RotationModel, Turn
from rigidsym.models.so3 import TIME

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

_FEW_TURNS = 4  # up to here the product is multiplied out; the proof by turns is as exact


class Values:
    """R, dR/dt, Ω, Ω′, W, W′ and the inverses of one model, each worked out when asked for."""

    def __init__(
        self,
        model: RotationModel,
        body: RigidBody | None = None,
        also: Iterable[sp.Expr] = (),
    ) -> None:
        """`also`: expressions for the ring to hold beside those of the model and the body."""
        self.model = model
        self.body = body
        if model.constraints:  # before the ring, which contradictory ones would make endless
            configurations(model.name, model.constraints, (), model.example)
        self.arguments = {argument.name: argument for argument in arguments_of(model, body)}
        # an energy holds no accelerations, and where constraints relate them to rates none may be
        # taken for an energy
        left_out = ("q", "q_ddot") if body else ("q",)
        inputs = [s for n, a in self.arguments.items() if n not in left_out for s in a.symbols]
        # a ring that holds the turns holds their product, and they are shorter to read
        held = [e for turn in model.turns for e in turn.matrix.flat()] or [*model.matrix]
        if body is not None:
            held += [body.mass, *body.inertia, sp.Rational(1, 2)]
        held += also
        order = 1 if body else 2
        self.codec = codec_for([*inputs, *held], constraints=model.constraints, order=order)
        self.ring = self.codec.ring
        self.one = RingMatrix.identity(self.ring, 3)

    @property
    def _many_turns(self) -> tuple[Turn, ...]:
        return self.model.turns if len(self.model.turns) > _FEW_TURNS else ()

    @cached_property
    def factors(self) -> tuple[Factor, ...]:
        """The turns, if there are too many to multiply R Rᵀ and dR/dt Rᵀ out; else none."""
        return tuple(
            Factor(self.encoded(turn.matrix), self._turning(turn)) for turn in self._many_turns
        )

    def _turning(self, turn: Turn) -> RingMatrix:
        """The angular velocity of one turn: its axis, times the rate of its angle."""
        rate = sp.diff(turn.angle, TIME)
        return self.encoded(sp.Matrix([part * rate for part in turn.direction]))

    @cached_property
    def R(self) -> RingMatrix:
        if self.factors:
            return composition.product(self.factors)
        return self.encoded(self.model.matrix)

    @cached_property
    def R_dot(self) -> RingMatrix:
        return self.R.dt()

    @cached_property
    def spin(self) -> RingMatrix:
        """dR/dt Rᵀ."""
        if self.factors:
            return hat(composition.omega_space(self.factors))
        return self.R_dot @ self.R.T

    @cached_property
    def spin_of_transpose(self) -> RingMatrix:
        """dA/dt Aᵀ of A = Rᵀ."""
        if self.factors:
            return hat(self.omega_body).map(lambda entry: -entry)
        return self.R_dot.T @ self.R

    @cached_property
    def omega_space(self) -> RingMatrix:
        return unhat(self.spin)

    @cached_property
    def omega_body(self) -> RingMatrix:
        if self.factors:
            return composition.omega_body(self.factors)
        if self.model.pullback is not None:  # RᵀΩ would not become shorter in this ring
            return unhat(self.R.T @ self.R_dot)
        return self.R.T @ self.omega_space

    @cached_property
    def rate_matrix_space(self) -> RingMatrix:
        return self._jacobian(self.omega_space)

    @cached_property
    def rate_matrix_body(self) -> RingMatrix:
        return self._jacobian(self.omega_body)

    @cached_property
    def inverse_space(self) -> Inverse | None:
        entries = self._entry_rates(lambda skew: skew @ self.R)
        return entries or right_inverse(self.rate_matrix_space, self.bound)

    @cached_property
    def inverse_body(self) -> Inverse | None:
        entries = self._entry_rates(lambda skew: self.R @ skew)
        return entries or right_inverse(self.rate_matrix_body, self.bound)

    def _entry_rates(self, rate_of: Callable[[RingMatrix], RingMatrix]) -> Inverse | None:
        """The columns dR/dt of unit angular velocities, where the coordinates are R's entries."""
        if tuple(self.model.matrix) != self.model.coordinates:
            return None
        units = [self.column(row) for row in self.one.rows]
        columns = [rate_of(hat(unit)).entries for unit in units]
        return RingMatrix(self.ring, tuple(columns)).T, self.ring.one

    @cached_property
    def bound(self) -> RingMatrix | None:
        return bound_on_rates(self.model.constraints, self.model.coordinates, self.codec)

    def _jacobian(self, omega: RingMatrix) -> RingMatrix:
        """∂Ω/∂q̇, by the generators of the rates themselves: a constraint may relate them."""
        ring = self.ring
        places = [ring.index[rate] for rate in self.arguments["q_dot"].symbols]
        return RingMatrix(
            ring, tuple(tuple(ring.partial(o, place) for place in places) for o in omega.entries)
        )

    def argument(self, name: str) -> RingMatrix:
        """The components of an argument as a column."""
        return self.column(map(self.codec.encode, self.arguments[name].symbols))

    def column(self, entries: Iterable[PolyElement]) -> RingMatrix:
        return RingMatrix.column(self.ring, entries)

    def encoded(self, matrix: sp.MatrixBase) -> RingMatrix:
        return encoded(self.codec, matrix)


def encoded(codec: Codec, matrix: sp.MatrixBase) -> RingMatrix:
    """A matrix over the ring of a codec."""
    rows = [[codec.encode(entry) for entry in row] for row in matrix.tolist()]
    return RingMatrix.of(codec.ring, rows)
