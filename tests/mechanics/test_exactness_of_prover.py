"""The prover and its real points, in small rings: what is exact, unproved, false, or a defect."""

from __future__ import annotations

import pytest
import sympy as sp

from helpers.witness import mp
from rigidsym.algebra import witness as witness_module
from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Quotient, Ring
from rigidsym.algebra.witness import Witness, witness_for
from rigidsym.errors import Defect, DerivationError, NotARotation
from rigidsym.formula.reader import formula
from rigidsym.mechanics.prove import Conditions, Prover, consequence, identity
from rigidsym.models.rotation import TIME, Pullback, time_function

x, y, theta = map(time_function, ("x", "y", "theta"))
m = sp.Symbol("m", positive=True)
CLAIM = formula("a = b")
HIDDEN = sp.sqrt(4 * m**2 + 4) - 2 * sp.sqrt(m**2 + 1)  # zero, which the ring does not see
X2 = x**2
NEAR = mp.mpf(10) ** -40


def column(codec: Codec, *entries: sp.Expr) -> RingMatrix:
    return RingMatrix.column(codec.ring, map(codec.encode, map(sp.sympify, entries)))


def prover_of(*entries: sp.Expr, **subject) -> tuple[Prover, RingMatrix]:
    """A prover in a ring that holds the entries, and the entries as a column."""
    known = Conditions("sample", **subject)
    codec = codec_for([*entries, x, y], constraints=known.constraints)
    return Prover(known, codec), column(codec, *entries)


def test_zeros_are_exact_and_anything_else_is_false():
    prover, zeros = prover_of(sp.S.Zero, sp.S.Zero)
    assert prover.vanishes(zeros, CLAIM).is_exact
    prover, entries = prover_of(sp.S.Zero, x)
    with pytest.raises(DerivationError, match=r"left over: x in row 2, column 1"):
        prover.vanishes(entries, CLAIM)


def test_a_hidden_zero_is_neither_proved_nor_refuted():
    prover, entries = prover_of(HIDDEN)
    proof = prover.vanishes(entries, CLAIM)
    assert (proof.status, proof.residual) == ("unproved", sp.ImmutableMatrix([HIDDEN]))
    prover, entries = prover_of(HIDDEN, x)
    with pytest.raises(DerivationError, match="row 2"):
        prover.vanishes(entries, CLAIM)


def test_a_double_root_of_a_condition_is_neither_proved_nor_refuted():
    prover, entries = prover_of(
        x - 1, coordinates=(x,), constraints=((x - 1) ** 2,), example=((x, sp.S.One),)
    )
    assert prover.vanishes(entries, CLAIM).status == "unproved"


def test_a_condition_proves_what_follows_from_it():
    prover, entries = prover_of(
        *(x**2 * y - y, 2 * x**3 - 2 * x),
        coordinates=(x,),
        constraints=(x**2 - 1,),
        example=((x, -sp.S.One),),
    )
    assert prover.vanishes(entries, CLAIM).is_exact


def test_a_divisor_must_not_be_a_hidden_zero():
    prover, entries = prover_of(sp.S.Zero, HIDDEN, 1 + x**2)
    zero, (_, hidden, positive) = column(prover.codec, 0), entries.entries
    assert prover.vanishes(zero, CLAIM, divided_by=positive).is_exact
    proof = prover.vanishes(zero, CLAIM, divided_by=hidden)
    assert (proof.status, proof.residual) == ("unproved", sp.ImmutableMatrix([HIDDEN]))


def test_quotients_cancel_if_their_numerators_do_and_no_divisor_is_a_hidden_zero():
    prover, entries = prover_of(sp.S.Zero, HIDDEN, 1 + x**2)
    ring, (zero, hidden, positive) = prover.codec.ring, entries.entries
    for above, below, status in (
        (zero, positive, "exact"),
        (zero, ring.one, "exact"),
        (zero, hidden, "unproved"),
        (hidden, positive, "unproved"),
    ):
        found = prover.cancel([Quotient(ring, above, below)], CLAIM)
        assert found.status == status
        assert (found.residual is None) == (status == "exact")
    with pytest.raises(DerivationError):
        prover.cancel([Quotient(ring, positive, ring.one)], CLAIM)


def test_a_root_is_exact_only_if_it_is_known_to_be_positive():
    u = sp.Symbol("u")
    bounds = {u: (sp.S.Zero, sp.S.One)}
    prover, entries = prover_of(sp.S.Zero, u - 1)
    zero = column(prover.codec, 0)
    assert prover.is_root(zero, u + 1, bounds, CLAIM).is_exact
    for value in (-u - 1, 2 * u - 1):
        proof = prover.is_root(zero, value, bounds, CLAIM)
        assert (proof.status, proof.residual) == ("unproved", sp.ImmutableMatrix([[value]]))
    with pytest.raises(DerivationError):
        prover.is_root(entries, u + 1, bounds, CLAIM)
    prover, hidden = prover_of(HIDDEN)
    assert prover.is_root(hidden, u + 1, bounds, CLAIM).residual == sp.ImmutableMatrix([HIDDEN])


def test_a_pullback_proves_what_its_coordinates_satisfy():
    circle = Pullback((sp.cos(theta), sp.sin(theta)), ())
    rates = x * x.diff(TIME) + y * y.diff(TIME)
    seconds = rates.diff(TIME)
    for entry in (X2 + y**2 - 1, rates, sp.expand(seconds)):
        prover, entries = prover_of(entry, coordinates=(x, y), pullback=circle)
        assert prover.vanishes(entries, CLAIM).is_exact
    prover, entries = prover_of(x - y, coordinates=(x, y), pullback=circle)
    with pytest.raises(DerivationError):
        prover.vanishes(entries, CLAIM)


def test_a_message_names_coordinates_and_their_rates_plainly():
    entries = [x + x.diff(TIME), sp.S.Zero, x.diff(TIME, 2)]
    prover, found = prover_of(*entries, coordinates=(x, y))
    with pytest.raises(DerivationError) as failed:
        prover.vanishes(found.T, CLAIM)
    assert str(failed.value) == (
        "sample: a = b is false; left over: x + x_dot in row 1, column 1; x_ddot in row 1, column 3"
    )
    with pytest.raises(NotARotation, match=r"since a = b fails; left over: x$"):
        prover.vanish([(column(prover.codec, x), CLAIM, ())], error=NotARotation)


def test_what_follows_from_claims_is_as_exact_as_they_are():
    prover, entries = prover_of(sp.S.Zero, HIDDEN)
    exact = prover.vanishes(column(prover.codec, 0), CLAIM)
    unsure = prover.vanishes(entries, CLAIM)
    other = formula("c = d")
    assert consequence([exact], other).is_exact
    assert consequence([exact, exact], other).claim == other
    for proofs in ([exact, unsure], [unsure, exact], [unsure]):
        found = consequence(proofs, other)
        assert (found.status, found.residual) == (unsure.status, unsure.residual)
    with pytest.raises(ValueError, match="follows from nothing"):
        consequence([], other)


def test_identities_of_rational_functions_cancel():
    a, b = sp.symbols("a b")
    left = sp.Matrix([1 / (a - b) + 1 / (b - a), (a**2 - b**2) / (a - b) - a - b])
    assert identity(left, CLAIM, "sample").is_exact
    assert identity(sp.Matrix([a**2 - 4]), CLAIM, "sample", [a - 2], ((a, sp.Integer(2)),)).is_exact
    with pytest.raises(DerivationError):
        identity(left + sp.Matrix([1, 0]), CLAIM, "sample")


@pytest.mark.parametrize("entries", [(x, 0), (0, x), (x, x)])
def test_a_wrong_entry_beside_a_right_one_is_a_defect(monkeypatch, entries):
    codec = codec_for([x, y])
    prover = Prover(Conditions("sample"), codec)
    zeros, factors, factor = (column(codec, *part) for part in ((0, 0), entries, (x,)))
    monkeypatch.setattr(Ring, "dot", lambda self, *_, **__: self.zero)
    wrong = factors @ factor
    for residual in (wrong, zeros + wrong, zeros - wrong, wrong.T, wrong.scale(codec.encode(x))):
        assert residual.is_zero()
        with pytest.raises(Defect, match="is proved, and yet is false at a point"):
            prover.vanishes(residual, CLAIM)


CASES = {
    "free": ((), codec_for([x, y, sp.sin(theta), sp.Rational(1, 3)])),
    "bound": ((X2 + y**2 - 4,), codec_for([x, y, sp.Rational(2, 3)], constraints=(X2 + y**2 - 4,))),
    "roots": ((), codec_for([sp.sqrt(m + 1), 1 / (X2 + 1), y])),
}


def matrices(codec: Codec) -> list[RingMatrix]:
    """Matrices with every kind of origin."""
    gens = codec.ring.polynomials.gens
    a, b, c = gens[0], gens[1], gens[2 % len(gens)]
    third = codec.ring.one * sp.QQ(1, 3) if codec.ring.polynomials.domain == sp.QQ else 5
    one = RingMatrix.of(codec.ring, [[a * b - 2, third * c**2], [b, a**2 * c + 1]])
    two = RingMatrix.of(codec.ring, [[a, codec.ring.one], [c - b, b * c]])
    return [one, one @ two, one + two, one - two.T, one.scale(a + 2), (one @ two - two @ one).T]


@pytest.mark.parametrize("case", CASES)
def test_values_of_products_are_those_of_their_entries(monkeypatch, case):
    """Both by the fast numbers, and within the bounds of the intervals."""
    constraints, codec = CASES[case]
    example = ((x, sp.Rational(6, 5)), (y, sp.Rational(8, 5))) if constraints else ()
    witness = witness_for(codec, "sample", constraints, example)
    bounds = witness._bounds(witness._first)
    for matrix in matrices(codec):
        number = witness._number
        by_factors = witness_module._values(matrix, {}, number, lambda p: p >> 240)
        for row, values in zip(matrix.rows, by_factors, strict=True):
            for entry, value in zip(row, values, strict=True):
                assert abs(number(entry) - value) < 1 << 80
                exact = mp.mpf(value) / 2**240
                found = witness_module._bounds_of(entry, bounds, witness_module.DIGITS)
                low, high = (
                    mp.mpf(str(end).strip("[]").split(",")[0]) for end in (found.a, found.b)
                )
                assert low - NEAR <= exact <= high + NEAR
        zero = matrix - matrix
        with monkeypatch.context() as patch:
            patch.setattr(Witness, "_bounds", None)  # the fast numbers suffice
            assert not witness.disagrees(zero, {})
            assert not witness.disagrees(matrix - RingMatrix(codec.ring, matrix.rows), {})
        with monkeypatch.context() as patch:
            patch.setattr(Witness, "_number", lambda *_: 1 << 240)  # and the intervals decide
            assert not witness.disagrees(RingMatrix.of(codec.ring, [[codec.ring.zero]]), {})


def test_an_element_is_not_zero_if_it_is_not_zero_at_a_point():
    constraints = (x**3 - x,)
    codec = codec_for([x, y], constraints=constraints)
    witness = witness_for(codec, "sample", constraints, ((x, sp.S.One),))
    assert witness.is_nonzero(codec.encode(x + 1))
    assert not witness.is_nonzero(codec.encode(x - 1))  # zero there, if not elsewhere
    assert witness.is_nonzero(codec.encode(y * x))
    assert not witness.is_nonzero(codec.encode(x**3 - x))
    assert witness.is_nonzero(codec.ring.one)
    assert not witness.is_nonzero(codec.ring.zero)
