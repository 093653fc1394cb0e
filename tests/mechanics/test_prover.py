"""Nothing false, and nothing empty, is called exact.

Coordinates and constants are real. Each rotation here was once, or could be, a proof of something
that holds nowhere, divides by zero, or is not real.
"""

from __future__ import annotations

import pytest
import sympy as sp
from sympy import Abs, Rational, acos, cos, cosh, exp, log, pi, sin, sqrt

import rigidsym as rs
from helpers.samples import about_z
from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.generators import combination
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Quotient, Ring
from rigidsym.algebra.witness import Witness
from rigidsym.errors import AlgebraError, Defect, DerivationError, ModelError, NotARotation
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.prove import Conditions, Prover, consequence, identity
from rigidsym.models.parametrisations import chain
from rigidsym.models.rotation import TIME, Pullback, RotationModel, Turn, elementary, time_function

a, b, x, y, z = map(time_function, "abxyz")
phi, psi, theta = map(time_function, ("phi", "psi", "theta"))
m, u, w = sp.symbols("m u w")
ABOUT_Z = elementary("z", phi)
NOWHERE = "no real value|does not satisfy|needs an `example`"
CLAIM = formula("a = b")
HIDDEN = sqrt(4 * m**2 + 4) - 2 * sqrt(m**2 + 1)  # zero, which the ring does not see


def own(matrix: sp.Matrix, *constraints: sp.Expr, example=()) -> RotationModel:
    return rs.given(matrix, name="sample", constraints=constraints, example=dict(example))


def turns(*pairs: tuple[str, sp.Expr]) -> RotationModel:
    return chain([Turn(axis=axis, angle=angle) for axis, angle in pairs])


# Conditions that hold nowhere: everything would follow from them


@pytest.mark.parametrize(
    "constraints",
    [
        [a**2 + b**2 + 1],
        [sin(x) - 2],
        [sqrt(x) + 1],
        [Abs(x) + 1],
        [x**2 + y**2 - 1, x - 3],
        [sin(x) ** 2 - 1, cos(x) ** 2 - 1],
    ],
    ids=str,
)
def test_conditions_that_no_real_values_satisfy_are_refused(constraints):
    """Without an example, and with one: exact, nearly right, and of numbers that are not real."""
    for matrix in (ABOUT_Z * (1 + constraints[0]), ABOUT_Z):
        with pytest.raises(ModelError, match="needs an `example`: give exact values of"):
            derive(own(matrix, *constraints))
        names = sp.Tuple(*constraints).atoms(sp.Function) & {a, b, x, y}
        for value in (0, 1, -1, pi / 2):
            with pytest.raises(ModelError, match=NOWHERE):
                derive(own(matrix, *constraints, example=dict.fromkeys(names, value)))


@pytest.mark.parametrize(
    ("constraints", "example"),
    [
        ([x**2 + y**2 - 1], {x: Rational(3, 5), y: Rational(4, 5)}),
        ([(x - 1) ** 2], {x: 1}),
        ([exp(x) - 2], {x: log(2)}),
        ([cosh(x) ** 2 - sp.sinh(x) ** 2 - 1], {}),
        ([sin(x) - cos(y)], {x: pi / 3, y: pi / 6}),
        ([(x - y) ** 2 + (x - 3) ** 2], {"x": 3, y: 3}),  # zero only there
        ([x * y * z - 1, x + y + z], {x: -1, y: (1 + sqrt(5)) / 2, z: (1 - sqrt(5)) / 2}),
    ],
    ids=str,
)
def test_conditions_that_an_example_satisfies_pass(constraints, example):
    assert derive(own(ABOUT_Z, *constraints, example=example), ["rotation_matrix"]).is_proved


NO_EXAMPLES = [
    (log(x) ** 2 + pi**2, {x: -1}),  # holds in complex numbers
    (x**2 - 2, {x: Rational(14142135623730950488016887242096980785696718753769, 10**49)}),
    (x**2 + y**2 - 1, {x: Rational(3, 5)}),
    (x - 3, {"z": 1}),
    (x - 3, {"x": 0.5}),
    (x - 3, {"x": sp.I}),
    (x - 3, {"x": y}),
]


@pytest.mark.parametrize(("constraint", "example"), NO_EXAMPLES, ids=str)
def test_an_example_is_checked_exactly_and_in_real_numbers(constraint, example):
    with pytest.raises(ModelError):
        derive(own(ABOUT_Z, constraint, example=example))


@pytest.mark.parametrize("axes", ["[a,b,c](p) [c,3/5,0]", "[a,a,b]"])
def test_symbols_in_axes_have_an_example(axes):
    model = rs.rotation_from(f"{axes}(phi) x(theta)")
    assert derive(model, ["rotation_matrix"]).is_proved
    for condition in model.constraints:
        assert sp.expand(condition.xreplace(dict(model.example))) == 0


@pytest.mark.parametrize(
    "model",
    [
        own(about_z(sqrt(2 + x**2), sqrt(-1 - x**2)) * ABOUT_Z),
        own(about_z(sqrt(1 + x**2), sqrt(-(x**2))) * ABOUT_Z),
        *(turns(("z", e), ("x", phi)) for e in (sqrt(-(x**2)), log(-exp(x)), acos(3 + x**2))),
    ],
    ids=str,
)
def test_rotations_that_are_not_real_are_refused(model):
    with pytest.raises((ModelError, AlgebraError)):
        derive(model)


# Zeros in disguise

ZEROS = {
    "a square root of a square": sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3),
    "of a difference": sqrt(7 - 4 * sqrt(3)) - 2 + sqrt(3),
    "a cube root": (7 + 5 * sqrt(2)) ** Rational(1, 3) - 1 - sqrt(2),
    "an inverse": 1 / (sqrt(3) - sqrt(2)) - sqrt(3) - sqrt(2),
}
QUOTIENTS = (u / (w + 1) + u * w / (w + 1) - u, 1 / (u - w) + 1 / (w - u), u / w - u**2 / (u * w))


@pytest.mark.parametrize("zero", ZEROS.values(), ids=ZEROS)
def test_division_by_a_zero_in_disguise_is_refused(zero):
    with pytest.raises((ModelError, AlgebraError), match=r"division by|contradict one another"):
        derive(own(ABOUT_Z * (1 + (zero**2 + zero) / zero - zero - 1)))


@pytest.mark.parametrize("zero", [*ZEROS.values(), 10**120 * ZEROS["a cube root"], *QUOTIENTS])
def test_a_turn_by_a_zero_in_disguise_is_no_turn(zero):
    found = derive(turns(("z", phi), ("x", zero * theta), ("z", psi)))
    assert not any(step.quantity.name.startswith("inverse") for step in found.steps)
    assert found.singularities.rank == 1 or found.singularities.points[0].rank == 1


def test_an_inverse_is_not_claimed_if_the_determinant_may_be_zero():
    tilt = theta * HIDDEN
    middle = sp.Matrix([[1, 0, 0], [0, 1, -tilt], [0, tilt, 1]])
    found = derive(own(ABOUT_Z * middle * elementary("z", psi)))
    for step in found.steps:
        if step.quantity.name.startswith(("inverse", "rates_from")):
            assert not all(proof.is_exact for proof in step.proofs)


@pytest.mark.parametrize(
    ("angle", "plain"),
    [
        (phi * u / (u + w) + phi * w / (u + w), phi),
        (x**2 / (x + y) - y**2 / (x + y), x - y),
        (x**3 / (x - 1) - x / (x - 1), x**2 + x),
    ],
    ids=str,
)
def test_rotations_with_quotients_in_their_angles_are_rotations(angle, plain):
    expected = derive(own(elementary("z", plain))).angular_velocity_space[2]
    for model in (own(elementary("z", angle)), turns(("z", angle))):
        found = derive(model)
        assert found.is_proved
        assert combination(plain) == combination(angle)
        assert sp.expand(found.angular_velocity_space[2] - expected) == 0


@pytest.mark.parametrize(("constraint", "value"), [(sin(x), pi), (sin(x) - Rational(1, 2), pi / 6)])
def test_singular_points_satisfy_the_conditions(constraint, value):
    matrix = elementary("x", x) * elementary("y", y) * elementary("z", z) * elementary("x", a)
    found = derive(own(matrix, constraint, example={x: value}), ["rate_matrix_space"])
    for point in found.singularities.points:
        values = {place.coordinate: place.value for place in point.places}
        assert constraint.xreplace(values).has(x) or constraint.xreplace(values) == 0
        assert point.rank > 0


def test_a_false_claim_that_the_ring_takes_for_true_is_a_defect(monkeypatch):
    monkeypatch.setattr(RingMatrix, "is_zero", lambda *_: True)
    with pytest.raises(Defect, match="a defect of rigidsym"):
        derive(own(sp.diag(1, 1, -1) * ABOUT_Z))


def test_every_claim_of_a_derivation_is_evaluated(monkeypatch):
    residuals = []
    monkeypatch.setattr(Witness, "disagrees", lambda _, residual, __: residuals.append(residual))
    assert len([*rs.derive("unit_quaternion").proofs]) <= len(residuals)


def test_what_is_false_on_the_conditions_is_refuted_by_a_value():
    with pytest.raises(NotARotation, match="left over"):
        derive(own(ABOUT_Z * (x**2 + y**2), x**2 + y**2 - 4, example={x: 0, y: 2}))


def column(codec: Codec, *entries: sp.Expr) -> RingMatrix:
    return RingMatrix.column(codec.ring, map(codec.encode, map(sp.sympify, entries)))


def prover_of(*entries: sp.Expr, **subject) -> tuple[Prover, RingMatrix]:
    """A prover in a ring that holds the entries, and the entries as a column."""
    known = Conditions("sample", **subject)
    codec = codec_for([*entries, x, y], constraints=known.constraints)
    return Prover(known, codec), column(codec, *entries)


ONE = {"constraints": ((x - 1) ** 2,), "example": ((x, sp.S.One),)}
SIGN = {"constraints": (x**2 - 1,), "example": ((x, -sp.S.One),)}
CIRCLE = {"pullback": Pullback((cos(theta), sin(theta)), ())}


@pytest.mark.parametrize(
    ("entries", "subject", "verdict"),
    [
        ((sp.S.Zero, sp.S.Zero), {}, "exact"),
        ((sp.S.Zero, x), {}, r"left over: x in row 2, column 1"),
        ((x,) * 5, {}, r"row 3, column 1; and 2 more$"),
        ((x * sp.Symbol("y" * 300),), {}, r"left over: x\*y{198} \.\.\.$"),
        ((HIDDEN,), {}, "unproved"),
        ((HIDDEN, x), {}, "row 2"),
        ((x - 1,), ONE, "unproved"),  # a double root
        ((x**2 * y - y, 2 * x**3 - 2 * x), SIGN, "exact"),
        ((x**2 + y**2 - 1,), CIRCLE, "exact"),
        ((sp.expand((x * x.diff(TIME) + y * y.diff(TIME)).diff(TIME)),), CIRCLE, "exact"),
        ((x - y,), CIRCLE, "is false"),
    ],
)
def test_claims_are_exact_unproved_or_false(entries, subject, verdict):
    prover, residual = prover_of(*entries, coordinates=(x, y), **subject)
    if verdict not in ("exact", "unproved"):
        with pytest.raises(DerivationError, match=verdict):
            prover.vanishes(residual, CLAIM)
        return
    proof = prover.vanishes(residual, CLAIM)
    assert proof.status == verdict
    assert proof.residual == (None if verdict == "exact" else sp.ImmutableMatrix(entries))


def test_quotients_cancel_if_their_numerators_do_and_no_divisor_is_a_hidden_zero():
    prover, entries = prover_of(sp.S.Zero, HIDDEN, 1 + x**2)
    ring, (zero, hidden, positive) = prover.codec.ring, entries.entries
    for above, below, status in (
        (zero, positive, "exact"),
        (zero, hidden, "unproved"),
        (hidden, positive, "unproved"),
    ):
        found = prover.cancel([Quotient(ring, above, below)], CLAIM)
        assert (found.status, found.residual is None) == (status, status == "exact")
    with pytest.raises(DerivationError):
        prover.cancel([Quotient(ring, positive, ring.one)], CLAIM)
    divided = prover.vanishes(column(prover.codec, 0), CLAIM, hidden)
    assert divided.residual == sp.ImmutableMatrix([HIDDEN])


def test_a_root_is_exact_only_if_it_is_known_to_be_positive():
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


def test_what_follows_from_claims_is_as_exact_as_they_are():
    prover, entries = prover_of(sp.S.Zero, HIDDEN)
    exact = prover.vanishes(column(prover.codec, 0), CLAIM)
    unsure = prover.vanishes(entries, CLAIM)
    other = formula("c = d")
    assert consequence([exact, exact], other).is_exact
    for proofs in ([exact, unsure], [unsure, exact]):
        found = consequence(proofs, other)
        assert (found.claim, found.status, found.residual) == (other, "unproved", unsure.residual)
    with pytest.raises(ValueError, match="follows from nothing"):
        consequence([], other)


def test_identities_of_rational_functions_cancel():
    left = sp.Matrix([1 / (u - w) + 1 / (w - u), (u**2 - w**2) / (u - w) - u - w])
    assert identity(left, CLAIM, "sample").is_exact
    assert identity(sp.Matrix([u**2 - 4]), CLAIM, "sample", [u - 2], ((u, sp.Integer(2)),)).is_exact
    with pytest.raises(DerivationError):
        identity(left + sp.Matrix([1, 0]), CLAIM, "sample")


@pytest.mark.parametrize("entries", [(x, 0), (0, x)])
def test_a_wrong_product_in_the_ring_is_a_defect(monkeypatch, entries):
    """The values are those of the factors, and not of their product in the ring."""
    codec = codec_for([x, y])
    prover = Prover(Conditions("sample"), codec)
    zeros, factors, factor = (column(codec, *part) for part in ((0, 0), entries, (x,)))
    monkeypatch.setattr(Ring, "dot", lambda self, *_, **__: self.zero)
    wrong = factors @ factor
    for residual in (wrong, zeros - wrong, wrong.T, wrong.scale(codec.encode(x))):
        assert residual.is_zero()
        with pytest.raises(Defect, match="is proved, and yet is false at a point"):
            prover.vanishes(residual, CLAIM)
