"""The one door for proofs: a residual is reduced here, and what reduces to zero is exact.

Nothing else constructs an exact Proof. A residual that does not vanish refutes its claim if the
ring knows every relation or a point shows it; otherwise the claim stays unproved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.evaluate import Bounds, is_never_negative
from rigidsym.algebra.generators import in_names
from rigidsym.algebra.matrix import RingMatrix, Values
from rigidsym.algebra.ring import Quotient
from rigidsym.algebra.witness import Example, witness_for
from rigidsym.errors import Defect, DerivationError, NotARotation, RigidsymError
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Proof
from rigidsym.models.rotation import TIME, Pullback, RotationModel
from rigidsym.system.records import NamedTuple

_LONGEST, _MOST = 200, 3  # characters of an entry, and entries, of a residual in a message


class Conditions(NamedTuple):
    """A subject that is no rotation: a body, say, whose symbols are bound by conditions at most."""

    name: str
    constraints: tuple[sp.Expr, ...] = ()
    coordinates: tuple[sp.Expr, ...] = ()
    pullback: Pullback | None = None
    example: Example = ()


def identity(
    left: sp.MatrixBase,
    claim: Formula,
    name: str,
    conditions: Sequence[sp.Expr] = (),
    example: Example = (),
) -> Proof:
    """The proof that a matrix of rational functions of a body's constants is zero.

    `example` gives exact values of the symbols in the conditions that satisfy them.
    """
    # Conditions on coordinates also hold for their rates, which only a ring with derivatives knows.
    order = 1 if left.has(sp.Derivative) else None
    codec = codec_for(left, constraints=conditions, order=order)
    quotients = list(map(codec.encode_quotient, left))
    subject = Conditions(name, tuple(conditions), example=example)
    return Prover(subject, codec).cancel(quotients, claim)


def consequence(proofs: Sequence[Proof], claim: Formula) -> Proof:
    """The proof of what follows from other claims: exact if all of them are."""
    if not proofs:
        raise ValueError(f"{claim.text} follows from nothing")
    # A conclusion is as certain as its least certain premise.
    left = next((proof for proof in proofs if not proof.is_exact), proofs[0])
    return Proof(claim=claim, status=left.status, residual=left.residual)


class Prover:
    """Decides claims about one subject in its ring."""

    def __init__(self, subject: RotationModel | Conditions, codec: Codec) -> None:
        """Raises ModelError if there is no real configuration, so that nothing can be claimed."""
        self.subject = subject
        self.codec = codec
        self.witness = witness_for(codec, subject.name, subject.constraints, subject.example)
        self._values: dict[RingMatrix, Values] = {}  # at a real point, of the factors of residuals

    def vanishes(
        self,
        residual: RingMatrix,
        claim: Formula,
        *divisors: PolyElement,
        error: type[RigidsymError] = DerivationError,
    ) -> Proof:
        """The proof that a matrix is zero, and that what the claim is divided by is not.

        A residual that reduces to zero is also evaluated at a real point, from its factors and to
        50 digits; raises Defect if that value is not zero.
        Raises the error if the matrix is shown not to be zero. If the ring does not know enough to
        tell, the proof is *unproved* and holds what is left.
        """
        left: sp.ImmutableMatrix | None = None
        if not residual.is_zero():
            left = self._left(residual, claim, error)
        elif self.subject.pullback is None and self.witness.disagrees(residual, self._values):
            raise Defect(
                f"{self.subject.name}: {claim.text} is proved, and yet is false at a point; "
                "this is a defect of rigidsym, please report it"
            )
        if left is None:  # a divisor that may be zero everywhere is the residual
            # n/d = 0 follows from n = 0 only if d is not identically zero.
            unsure = (d for d in divisors if not self.witness.is_nonzero(d))
            divisor = next(unsure, None)
            left = None if divisor is None else sp.ImmutableMatrix([[self.codec.decode(divisor)]])
        return Proof(claim=claim, status="exact" if left is None else "unproved", residual=left)

    def _left(
        self, residual: RingMatrix, claim: Formula, error: type[RigidsymError]
    ) -> sp.ImmutableMatrix | None:
        """What is left of a residual that the ring does not reduce to zero; None if it is zero."""
        left = self.codec.decoded(residual)
        if self.subject.pullback is not None:
            # in the ring of the functions that the coordinates are pulled back to
            codec, values = self._pullback
            if codec.matrix(left.xreplace(values)).is_zero():
                return None
        if any(map(self.witness.is_nonzero, residual.entries)):
            fails = f"{claim.text} is false"
            if error is NotARotation:
                fails = f"not a rotation, since {claim.text} fails"
            entries = [
                f"{text[:_LONGEST]}{' ...' * (len(text) > _LONGEST)}"
                + f" in row {i + 1}, column {j + 1}" * (len(left) > 1)
                for (i, j), entry in sorted(left.todok().items())
                for text in (str(in_names(entry)),)
            ]
            rest = "; ".join(entries[:_MOST])
            more = f"; and {len(entries) - _MOST} more" * (len(entries) > _MOST)
            raise error(f"{self.subject.name}: {fails}; left over: {rest}{more}")
        return left

    def cancel(self, quotients: Sequence[Quotient], claim: Formula) -> Proof:
        """The proof that quotients are zero, and that none of their divisors is."""
        # A quotient vanishes if its numerator does and its denominator does not.
        numerators = RingMatrix.column(self.codec.ring, (q.numerator for q in quotients))
        return self.vanishes(numerators, claim, *dict.fromkeys(q.denominator for q in quotients))

    def is_root(
        self,
        squared: RingMatrix,
        value: sp.Expr,
        bounds: Mapping[sp.Symbol, Bounds],
        claim: Formula,
    ) -> Proof:
        """The proof that a value is the positive root of what its square equals.

        `squared` is the difference of the squares. The sign follows for variables within bounds
        and positive constants; if it does not, the proof is *unproved* and holds the value.
        """
        # r² = s² leaves r = ±s; the sign is decided by r ≥ 0.
        proof = self.vanishes(squared, claim)
        if proof.is_exact and not is_never_negative(value, bounds):
            return Proof(claim=claim, status="unproved", residual=sp.ImmutableMatrix([[value]]))
        return proof

    @cached_property
    def _pullback(self) -> tuple[Codec, dict[sp.Expr, sp.Expr]]:
        """The ring of the pullback, with the coordinates and their rates in terms of it."""
        pullback = self.subject.pullback
        assert pullback is not None
        values: dict[sp.Expr, sp.Expr] = {}
        for coordinate, value in zip(self.subject.coordinates, pullback.coordinates, strict=True):
            for order in range(3):
                # Positions, rates and accelerations are substituted together, so that relations
                # between the rates hold as well.
                values[sp.diff(coordinate, TIME, order)] = sp.diff(value, TIME, order)
        given = [gen.expression for gen in self.codec.ring.generators if gen.expression.is_Symbol]
        return codec_for([*pullback.coordinates, *given], constraints=pullback.constraints), values
