"""The matrices and vectors of one model over its ring."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache, cached_property
from typing import TYPE_CHECKING

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.matrix import RingMatrix, hat, unhat
from rigidsym.algebra.present import Presenter, presenter_for
from rigidsym.algebra.ring import Ring
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities.arguments import arguments_of
from rigidsym.models.parametrisations import DirectionCosines
from rigidsym.models.rotation import RotationModel

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

Inverse = tuple[RingMatrix, PolyElement]  # G and d, for G/d


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
        self.arguments = {argument.name: argument for argument in arguments_of(model, body)}
        self._also = tuple(also)

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

    @property
    def ring(self) -> Ring:
        return self.codec.ring

    @cached_property
    def one(self) -> RingMatrix:
        return RingMatrix.identity(self.ring, 3)

    @cached_property
    def R(self) -> RingMatrix:
        return self.codec.matrix(self.model.matrix)

    @cached_property
    def R_dot(self) -> RingMatrix:
        return self.R.dt()

    @cached_property
    def spin(self) -> RingMatrix:
        """dR/dt Rᵀ."""
        return self.R_dot @ self.R.T

    @cached_property
    def omega_space(self) -> RingMatrix:
        return unhat(self.spin)

    @cached_property
    def omega_body(self) -> RingMatrix:
        if self.model.pullback is not None:  # RᵀΩ would not become shorter in this ring
            return unhat(self.R.T @ self.R_dot)
        return self.R.T @ self.omega_space

    @cached_property
    def alpha_space(self) -> RingMatrix:
        return self.omega_space.dt()

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

    # The same, by the name of the frame: "space" or "body"

    def omega(self, frame: str) -> RingMatrix:
        return self.omega_space if frame == "space" else self.omega_body

    def rate_matrix(self, frame: str) -> RingMatrix:
        return self.rate_matrix_space if frame == "space" else self.rate_matrix_body

    def inverse(self, frame: str) -> Inverse | None:
        return self.inverse_space if frame == "space" else self.inverse_body

    def _entry_rates(self, rate_of: Callable[[RingMatrix], RingMatrix]) -> Inverse | None:
        """The columns dR/dt of unit angular velocities, where the coordinates are R's entries."""
        if tuple(self.model.matrix) != self.model.coordinates:
            return None
        units = [self.column(row) for row in self.one.rows]
        columns = [rate_of(hat(unit)).entries for unit in units]
        return RingMatrix(self.ring, tuple(columns)).T, self.ring.one

    @cached_property
    def bound(self) -> RingMatrix | None:
        """J = ∂(constraints)/∂q, (m, n); None if no constraint binds a coordinate."""
        coordinates = self.model.coordinates
        binding = [c for c in self.model.constraints if c.has(*coordinates)]
        rows = [[sp.diff(c, q) for q in coordinates] for c in binding]
        return self.codec.matrix(sp.Matrix(rows)) if rows else None

    def _jacobian(self, omega: RingMatrix) -> RingMatrix:
        """∂Ω/∂q̇, by the generators of the rates themselves: a constraint may relate them."""
        return omega.jacobian([self.ring.index[q] for q in self.arguments["q_dot"].symbols])

    def argument(self, name: str) -> RingMatrix:
        """The components of an argument as a column."""
        return self.codec.column(self.arguments[name].symbols)

    def column(self, entries: Iterable[PolyElement]) -> RingMatrix:
        return RingMatrix.column(self.ring, entries)


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
    def R(self) -> RingMatrix:
        return self.codec.matrix(self.names().matrix)

    @cached_property
    def R_dot(self) -> RingMatrix:
        return self.R @ hat(self.omega_body)

    @cached_property
    def omega_space(self) -> RingMatrix:
        return self.R @ self.omega_body

    @cached_property
    def omega_body(self) -> RingMatrix:
        return self.codec.column(self.velocity)


def right_inverse(matrix: RingMatrix, bound: RingMatrix | None) -> Inverse | None:
    """G (n, 3) and d with W G = d 1, for a rate matrix W (3, n); None if there is none.

    With as many coordinates as dimensions it is the inverse; with more, the rates of least norm
    are taken, W⁺ = Wᵀ (W Wᵀ)⁻¹. `bound` is the matrix J of the constraints on the rates, J q̇ = 0;
    then J G = 0 as well.
    """
    count = matrix.shape[1]
    if count < 3:
        return None
    if count == 3 and bound is None:
        return _if_regular(matrix.adjugate(), matrix.det())
    gram = matrix.gram()
    least = _if_regular(matrix.T @ gram.adjugate(), gram.det())
    if least is None or bound is None or (bound @ least[0]).is_zero():
        return least
    square = RingMatrix(matrix.ring, (*matrix.rows, *bound.rows))
    if square.shape[0] != count:
        return None
    columns = square.adjugate().T.rows[:3]
    return _if_regular(RingMatrix(matrix.ring, columns).T, square.det())


def _if_regular(inverse: RingMatrix, determinant: PolyElement) -> Inverse | None:
    return (inverse, determinant) if determinant else None
