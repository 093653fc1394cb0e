"""Claims become proofs: what reduces to zero is exact, what does not is refused or left open."""

from __future__ import annotations

from functools import cached_property

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.errors import DerivationError, NotARotation
from rigidsym.mechanics.counterexamples import is_nonzero_somewhere
from rigidsym.mechanics.derivation import Markup, Proof
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME


class Prover:
    """Decides claims about one model in its ring."""

    def __init__(self, model: RotationModel, codec: Codec) -> None:
        self.model = model
        self.codec = codec

    def vanishes(
        self, residual: RingMatrix, claim: Markup, *, divided_by: PolyElement | None = None
    ) -> Proof:
        """The proof that a matrix is zero, and that what was divided by is not.

        Raises DerivationError where the matrix is shown not to be zero; where the ring does not
        know enough to tell, the proof says *unproved* and holds what is left.
        """
        if residual.is_zero():
            return self._unless_zero(divided_by, claim)
        left = self._decoded(residual)
        if self.model.pullback is not None and self._pulled_back(left).is_zero():
            return self._unless_zero(divided_by, claim)
        if self._is_refuted(left):
            raise DerivationError(
                f"{self.model.name}: {claim.text} is false; left over: {self._plain(left)}"
            )
        return Proof(claim=claim, status="unproved", residual=left)

    def _pulled_back(self, left: sp.ImmutableMatrix) -> RingMatrix:
        """What is left, in the ring of the functions that stand for the coordinates."""
        codec, values = self._pullback
        rows = [[codec.encode(entry.xreplace(values)) for entry in row] for row in left.tolist()]
        return RingMatrix.of(codec.ring, rows)

    @cached_property
    def _pullback(self) -> tuple[Codec, dict[sp.Expr, sp.Expr]]:
        """The ring of the pullback, and what the coordinates and their rates become in it."""
        assert self.model.pullback is not None
        values: dict[sp.Expr, sp.Expr] = {}
        pairs = zip(self.model.coordinates, self.model.pullback.coordinates, strict=True)
        for coordinate, value in pairs:
            for order in range(3):
                values[sp.diff(coordinate, TIME, order)] = sp.diff(value, TIME, order)
        given = [gen.expression for gen in self.codec.ring.generators if gen.expression.is_Symbol]
        inputs = [*self.model.pullback.coordinates, *given]
        return codec_for(inputs, constraints=self.model.pullback.constraints), values

    def _unless_zero(self, divisor: PolyElement | None, claim: Markup) -> Proof:
        """Exact, unless the divisor may be zero everywhere; it is then what is left over."""
        if divisor is not None and not self._is_decided:
            left = self._decoded(RingMatrix.of(self.codec.ring, [[divisor]]))
            if not self._is_refuted(left):
                return Proof(claim=claim, status="unproved", residual=left)
        return Proof(claim=claim, status="exact")

    def is_rotation(self, residual: RingMatrix, claim: Markup) -> Proof:
        """As `vanishes`, for the claims that make a matrix a rotation; raises NotARotation."""
        try:
            return self.vanishes(residual, claim)
        except DerivationError as error:
            raise NotARotation(
                f"{self.model.name}: not a rotation, since {claim.text} fails; "
                f"left over: {self._plain(self._decoded(residual))}"
            ) from error

    def _decoded(self, residual: RingMatrix) -> sp.ImmutableMatrix:
        decode = self.codec.decode
        return sp.ImmutableMatrix([[decode(entry) for entry in row] for row in residual.rows])

    def _plain(self, left: sp.ImmutableMatrix) -> str:
        """The entries that are not zero, in the plain names of the coordinates."""
        names = {
            sp.diff(q, TIME, order): sp.Symbol(q.func.__name__ + suffix)
            for order, suffix in ((2, "_ddot"), (1, "_dot"), (0, ""))
            for q in self.model.coordinates
        }
        entries = [
            (f"{left[i, j].xreplace(names)}", f" in row {i + 1}, column {j + 1}")
            for i in range(left.rows)
            for j in range(left.cols)
            if left[i, j] != 0
        ]
        return "; ".join(text + (place if len(left) > 1 else "") for text, place in entries)

    @property
    def _is_decided(self) -> bool:
        """Whether what does not reduce to zero is not zero."""
        return self.codec.ring.complete and not self.model.constraints

    def _is_refuted(self, left: sp.ImmutableMatrix) -> bool:
        """Whether what is left is certainly not zero.

        A ring that knows every relation can tell. Where it does not, and under constraints, whose
        ideal need not hold all that vanishes with them, a value at a point tells.
        """
        return self._is_decided or any(
            is_nonzero_somewhere(entry, self.model.constraints) for entry in left if entry != 0
        )
