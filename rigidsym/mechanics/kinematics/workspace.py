"""The matrices and vectors of one model over its ring."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache, cached_property
from typing import TYPE_CHECKING, NamedTuple

import sympy as sp

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.matrix import Inverse, RingMatrix, hat, unhat
from rigidsym.algebra.present import Presenter, presenter_for
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.parametrisations import DirectionCosines
from rigidsym.models.rotation import RotationModel

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody


class Turning(NamedTuple):
    """R and the angular velocity, over a ring."""

    R: RingMatrix
    R_dot: RingMatrix
    spin: RingMatrix  # dR/dt Rᵀ
    omega_space: RingMatrix
    omega_body: RingMatrix


class Values:
    """R, dR/dt, Ω, Ω′, W, W′ and the inverses of one model, worked out when asked for."""

    def __init__(
        self,
        model: RotationModel,
        body: RigidBody | None = None,
        also: Iterable[sp.Expr] = (),
    ) -> None:
        """`also`: expressions for the ring to hold beside those of the model and the body."""
        self.model = model
        self.body = body
        self.arguments = {argument.name: argument for argument in arguments_of(model, body)}
        self._also = tuple(also)
        self._inverses: dict[str, Inverse | None] = {}

    @cached_property
    def codec(self) -> Codec:
        model, body = self.model, self.body
        if model.constraints:  # before the ring, which contradictory ones would make endless
            configurations(model.name, model.constraints, (), model.example)
        # an energy holds no accelerations, and where constraints relate them to rates none may be
        # taken for an energy
        left_out = ("q", "q_ddot") if body else ("q",)
        inputs = [s for n, a in self.arguments.items() if n not in left_out for s in a.symbols]
        # a ring that holds the turns holds their product, and they are shorter to read
        held = [e for turn in model.turns for e in turn.matrix.flat()] or [*model.matrix]
        if body is not None:
            held += [body.mass, *body.inertia, sp.Rational(1, 2)]
        order = 1 if body else 2
        inputs += [*held, *self._also]
        return codec_for(inputs, constraints=model.constraints, order=order)

    @cached_property
    def prove(self) -> Prover:
        return Prover(self.model, self.codec)

    @cached_property
    def present(self) -> Presenter:
        return presenter_for(self.codec)

    @cached_property
    def turning(self) -> Turning:
        """R → dR/dt → Ω → Ω′ (lecture, eq. 15 and 16)."""
        rotation = self.codec.matrix(self.model.matrix)
        rate, back = rotation.dt(), rotation.T
        spin = rate @ back
        space = unhat(spin)
        # for the ring of a pullback, RᵀΩ would not become shorter
        body = back @ space if self.model.pullback is None else unhat(back @ rate)
        return Turning(rotation, rate, spin, space, body)

    @cached_property
    def rate_matrices(self) -> dict[str, RingMatrix]:
        """W = ∂Ω/∂q̇ and W′ by frame: "space" and "body".

        By the generators of the rates themselves, since a constraint may relate them.
        """
        index, turning = self.codec.ring.index, self.turning
        places = [index[q] for q in self.arguments["q_dot"].symbols]
        in_space, in_body = (
            turning.omega_space.jacobian(places),
            turning.omega_body.jacobian(places),
        )
        return {"space": in_space, "body": in_body}

    def inverse(self, frame: str) -> Inverse | None:
        """The right inverse of the rate matrix of a frame; None if it has none."""
        if frame not in self._inverses:
            found = self._entry_rates(frame)
            self._inverses[frame] = found or self.rate_matrices[frame].right_inverse(self.bound)
        return self._inverses[frame]

    def _entry_rates(self, frame: str) -> Inverse | None:
        """The columns dR/dt of unit angular velocities, where the coordinates are R's entries."""
        if tuple(self.model.matrix) != self.model.coordinates:
            return None
        ring, rotation = self.codec.ring, self.turning.R
        operators = [hat(RingMatrix.column(ring, e)) for e in RingMatrix.identity(ring, 3).rows]
        rates = [skew @ rotation if frame == "space" else rotation @ skew for skew in operators]
        return RingMatrix(ring, tuple(rate.entries for rate in rates)).T, ring.one

    @cached_property
    def bound(self) -> RingMatrix | None:
        """J = ∂(constraints)/∂q, (m, n); None if no constraint binds a coordinate."""
        coordinates = self.model.coordinates
        binding = [c for c in self.model.constraints if c.has(*coordinates)]
        rows = [[sp.diff(c, q) for q in coordinates] for c in binding]
        return self.codec.matrix(sp.Matrix(rows)) if rows else None

    def argument(self, name: str) -> RingMatrix:
        """The components of an argument as a column."""
        return self.codec.column(self.arguments[name].symbols)


class NamedRotation(Values):
    """R, dR/dt, Ω and Ω′ of a body whose rotation is known by names for R and Ω′.

    Of these only R Rᵀ = 1, det R = 1, Ω = R Ω′ and dR/dt = R C(Ω′) are used, which the derivation
    of a long product of turns proves.
    """

    velocity = sp.symbols("omega_body_1:4")

    @staticmethod
    @cache
    def names() -> RotationModel:
        """The nine entries of R by name."""
        return DirectionCosines([f"R_{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)])

    @cached_property
    def codec(self) -> Codec:
        assert self.body is not None
        moving = [*self.arguments["centre"].symbols, *self.arguments["centre_dot"].symbols]
        inputs = [*self.names().matrix, *self.velocity, *moving, self.body.mass, *self.body.inertia]
        return codec_for([*inputs, sp.Rational(1, 2), *self._also], order=1)

    @cached_property
    def prove(self) -> Prover:
        return Prover(self.names(), self.codec)

    @cached_property
    def turning(self) -> Turning:
        rotation = self.codec.matrix(self.names().matrix)
        body = self.codec.column(self.velocity)
        space = rotation @ body
        return Turning(rotation, rotation @ hat(body), hat(space), space, body)
