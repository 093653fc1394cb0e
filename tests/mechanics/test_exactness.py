"""Nothing false, and nothing empty, is called exact.

Coordinates and constants are real. Each case here was once, or could be, a proof of something
that holds nowhere, divides by zero, or is not real.
"""

from __future__ import annotations

import pytest
import sympy as sp
from sympy import Abs, Rational, acos, asin, atan, cos, cosh, exp, log, pi, sin, sqrt, tan

import rigidsym as rs
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.generators import combination
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.ring import Ring
from rigidsym.algebra.witness import Witness, configurations
from rigidsym.errors import AlgebraError, Defect, ModelError, NotARotation
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.prove import Conditions, Prover
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import chain
from rigidsym.models.rotation import RotationModel, Turn, elementary, time_function

a, b, x, y, z = map(time_function, "abxyz")
phi, psi, chi, theta = map(time_function, ("phi", "psi", "chi", "theta"))
k, m, u, w = sp.symbols("k m u w")
ABOUT_Z = elementary("z", phi)
NOWHERE = "no real value|does not satisfy|needs an `example`"
CLAIM = formula("0 = 0")

ZEROS = {  # numbers that are zero and do not look so
    "a square root of a square": sqrt(5 + 2 * sqrt(6)) - sqrt(2) - sqrt(3),
    "another": sqrt(3 + 2 * sqrt(2)) - 1 - sqrt(2),
    "of a difference": sqrt(7 - 4 * sqrt(3)) - 2 + sqrt(3),
    "a cube root": (7 + 5 * sqrt(2)) ** Rational(1, 3) - 1 - sqrt(2),
    "a fourth root": (17 + 12 * sqrt(2)) ** Rational(1, 4) - 1 - sqrt(2),
    "an inverse": 1 / (sqrt(3) - sqrt(2)) - sqrt(3) - sqrt(2),
}


def own(matrix: sp.Matrix, *constraints: sp.Expr, example=()) -> RotationModel:
    return rs.given(matrix, name="sample", constraints=constraints, example=dict(example))


def turns(*pairs: tuple[str, sp.Expr]) -> RotationModel:
    return chain([Turn(axis=axis, angle=angle) for axis, angle in pairs])


def product(*pairs: tuple[str, sp.Expr]) -> sp.Matrix:
    return turns(*pairs).matrix


def about_z(cosine: sp.Expr, sine: sp.Expr) -> sp.Matrix:
    return sp.Matrix([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def has_inverse(derivation: Derivation) -> bool:
    return any(step.quantity.name.startswith("inverse") for step in derivation.steps)


# Conditions that hold nowhere: everything would follow from them.


@pytest.mark.parametrize(
    "constraints",
    [
        [a**2 + 1],
        [a**2 + b**2 + 1],
        [sin(x) - 2],
        [sqrt(x) + 1],
        [exp(x) + 1],
        [a**4 + a**2 + 1],
        [cos(x) + sin(x) - 2],
        [cosh(x)],
        [Abs(x) + 1],
        [x**2 + y**2 - 1, x - 3],
        [x + y - 1, x + y - 2],
        [x - sqrt(x**2 + 1)],
        [atan(x) - 2],
        [log(x**2 + 1) + 1],
        [exp(x) * exp(y) + m**2],
        [sin(x) ** 2 - 1, cos(x) ** 2 - 1],
        [x * y - 1, x],
        [sqrt(a) + 1],
    ],
    ids=str,
)
def test_conditions_that_no_real_values_satisfy_are_refused(constraints):
    """Without an example, and with one: exact, nearly right, and of numbers that are not real."""
    for matrix in (ABOUT_Z * (1 + constraints[0]), ABOUT_Z):
        with pytest.raises(ModelError, match="needs an `example`: give exact values of"):
            derive(own(matrix, *constraints))
        atoms = set().union(*(c.free_symbols | c.atoms(sp.Function) for c in constraints))
        names = [e for e in atoms if e in (a, b, x, y, m)]
        for value in (0, 1, 3, -1, pi / 2, sp.Rational(1, 3)):
            with pytest.raises(ModelError, match=NOWHERE):
                derive(own(matrix, *constraints, example=dict.fromkeys(names, value)))


@pytest.mark.parametrize(
    ("constraints", "example"),
    [
        ([log(x) ** 2 + pi**2], {x: -1}),  # holds in complex numbers
        ([sqrt(x) * sqrt(y) + 1], {x: -1, y: -1}),
        ([x**2 - 2], {x: Rational(14142135623730950488016887242096980785696718753769, 10**49)}),
        ([x**2 + y**2 - 1], {x: Rational(3, 5)}),
        ([acos(x) - y], {x: Rational(1, 3), y: Rational(1230959417340774682, 10**18)}),
    ],
    ids=str,
)
def test_an_example_is_checked_exactly_and_in_real_numbers(constraints, example):
    with pytest.raises(ModelError, match=NOWHERE):
        derive(own(ABOUT_Z, *constraints, example=example))


@pytest.mark.parametrize(
    ("constraints", "example"),
    [
        ([x**2 + y**2 - 1], {x: Rational(3, 5), y: Rational(4, 5)}),
        ([sin(x) - 1], {x: pi / 2}),
        ([(x - 1) ** 2], {x: 1}),
        ([x**2 + y**2], {x: 0, y: 0}),
        ([exp(x) - 2], {x: log(2)}),
        ([x**3 - 2], {x: sp.cbrt(2)}),
        ([x**2 + y**2 - 1, 2 * x**2 + 2 * y**2 - 2], {x: sqrt(2) / 2, y: -sqrt(2) / 2}),
        ([cosh(x) ** 2 - sp.sinh(x) ** 2 - 1], {}),
        ([sin(x) - cos(y)], {x: pi / 3, y: pi / 6}),
        ([x**2 - 10**6], {x: -1000}),
        ([sqrt(x) - 30], {x: 900}),
        ([acos(x) - 1], {x: cos(1)}),
        ([x * y * z - 1, x + y + z], {x: -1, y: (1 + sqrt(5)) / 2, z: (1 - sqrt(5)) / 2}),
        ([x**2 - sqrt(5 + 2 * sqrt(6))], {x: sqrt(sqrt(2) + sqrt(3))}),
    ],
    ids=str,
)
def test_conditions_that_an_example_satisfies_pass(constraints, example):
    assert derive(own(ABOUT_Z, *constraints, example=example), ["rotation_matrix"]).is_proved


@pytest.mark.parametrize(
    ("constraint", "example"),
    [
        (x**2 + y**2 - 1, {x: Rational(3, 5), y: Rational(4, 5)}),
        (x**3 - 2, {x: sp.cbrt(2)}),
        (exp(x) - 2, {x: log(2)}),
        ((x - 3) ** 2, {x: sp.Integer(3)}),
    ],
)
def test_a_configuration_satisfies_its_constraints_with_its_rates(constraint, example):
    (found,) = configurations("sample", (constraint,), (), tuple(example.items()))
    t = sp.Symbol("t")
    for order in range(3):
        derivative = sp.diff(constraint, t, order)
        assert abs(found.numbers([derivative])(derivative)) < 1e-40
        assert 0 in found.intervals([derivative])(derivative)
    if constraint.has(y):
        assert found.values[x.diff(t)] != 0


PINCHED = x**4 - 2 * x**2 * y + y**2 + (x - 3) ** 2  # zero only for x = 3, y = 9


def test_an_example_is_kept():
    known = own(ABOUT_Z, PINCHED, example={"x": 3, y: 9})
    assert rs.derive(known, only="rotation_matrix").is_proved
    assert dict(known.example) == {x: 3, y: 9}


@pytest.mark.parametrize("example", [{"z": 1}, {"x": 0.5}, {"x": sp.I}, {"x": y}, {"x": "3"}])
def test_an_example_is_of_exact_real_numbers(example):
    with pytest.raises(ModelError):
        rs.given(sp.Matrix(ABOUT_Z), name="sample", constraints=(PINCHED,), example=example)


@pytest.mark.parametrize(
    "axes", ["[a,b,c]", "[a,b,c](p) [c,3/5,0]", "[a,1/2,0]", "[a,a,b]", "[0,b,0]"]
)
def test_symbols_in_axes_have_an_example(axes):
    model = rotation_from(f"{axes}(phi) x(theta)")
    assert derive(model, ["rotation_matrix"]).is_proved
    for condition in model.constraints:
        assert sp.expand(condition.xreplace(dict(model.example))) == 0


# Matrices that are real nowhere, or at a point only.


@pytest.mark.parametrize(
    ("cosine", "sine"),
    [
        (sqrt(2 + x**2), sqrt(-1 - x**2)),
        (sqrt(1 + x**2), sqrt(-(x**2))),
        (sqrt(1 + exp(x)), sqrt(-exp(x))),
        (sqrt(1 + x**2 + y**4), sqrt(-(x**2) - y**4)),
        (sqrt(2), sqrt(-1 - 0 * x)),
        (sqrt(2 - sin(x)), sqrt(sin(x) - 1)),
        (log(-(x**2) - 1), sqrt(1 - log(-(x**2) - 1) ** 2)),
        (asin(2 + x**2), sqrt(1 - asin(2 + x**2) ** 2)),
    ],
    ids=str,
)
def test_matrices_that_are_not_real_are_refused(cosine, sine):
    with pytest.raises((ModelError, AlgebraError)):
        derive(own(about_z(cosine, sine) * ABOUT_Z))


@pytest.mark.parametrize(
    "angle", [sqrt(-(m**2)) * x, sqrt(-1 - x**2), sqrt(-(x**2)), log(-exp(x)), acos(3 + x**2)]
)
def test_angles_that_are_not_real_are_refused(angle):
    with pytest.raises((ModelError, AlgebraError)):
        derive(turns(("z", angle), ("x", phi)))


@pytest.mark.parametrize(
    ("cosine", "sine", "example"),
    [
        (sqrt(1 - x**2), x, {}),
        (sqrt(101 - x), sqrt(x - 100), {x: 100 + Rational(1, 3)}),
        (x / sqrt(x**2 + y**2), y / sqrt(x**2 + y**2), {}),
        (sqrt(x) / sqrt(x + 1), 1 / sqrt(x + 1), {}),
    ],
    ids=str,
)
def test_matrices_that_are_real_somewhere_pass(cosine, sine, example):
    model = own(about_z(cosine, sine), example=example)
    assert derive(model, ["rotation_matrix"]).is_proved


# Zeros in disguise.


@pytest.mark.parametrize("zero", ZEROS.values(), ids=ZEROS)
def test_division_by_a_zero_in_disguise_is_refused(zero):
    with pytest.raises((ModelError, AlgebraError), match=r"division by|contradict one another"):
        derive(own(ABOUT_Z * (1 + (zero**2 + zero) / zero - zero - 1)))


@pytest.mark.parametrize("scale", [1, 10**120])
@pytest.mark.parametrize("zero", ZEROS.values(), ids=ZEROS)
def test_a_turn_by_a_zero_in_disguise_is_no_turn(zero, scale):
    found = derive(turns(("z", phi), ("x", scale * zero * theta), ("z", psi)))
    assert not has_inverse(found)
    assert found.singularities.rank == 1 or found.singularities.points[0].rank == 1


@pytest.mark.parametrize(
    "zero",
    [
        u / (w + 1) + u * w / (w + 1) - u,
        u / w - u**2 / (u * w),
        1 / (u - w) + 1 / (w - u),
        u / (u + w) + w / (u + w) - 1,
        (u**2 - w**2) / (u - w) - u - w,
        u - u,
    ],
    ids=str,
)
def test_an_angle_whose_quotients_cancel_is_none(zero):
    found = derive(turns(("z", phi), ("x", zero), ("z", psi), ("x", zero), ("z", chi)))
    assert not has_inverse(found)
    assert all(point.rank == 1 for point in found.singularities.points)


def test_an_inverse_is_not_claimed_if_the_determinant_may_be_zero():
    hidden = theta * (sqrt(4 * m**2 + 4) - 2 * sqrt(m**2 + 1))
    middle = sp.Matrix([[1, 0, 0], [0, 1, -hidden], [0, hidden, 1]])
    found = derive(own(ABOUT_Z * middle * elementary("z", psi)))
    for step in found.steps:
        if step.quantity.name.startswith(("inverse", "rates_from")):
            assert not all(proof.is_exact for proof in step.proofs)


# True rotations with quotients in their angles.


@pytest.mark.parametrize(
    ("angle", "plain"),
    [
        (phi * u / (u + w) + phi * w / (u + w), phi),
        (x**2 / (x + y) - y**2 / (x + y), x - y),
        (phi / (u + 1) + u * phi / (u + 1), phi),
        (phi + psi * u / (u + w) + psi * w / (u + w), phi + psi),
        (x**3 / (x - 1) - x / (x - 1), x**2 + x),
    ],
    ids=str,
)
def test_rotations_with_quotients_in_their_angles_are_rotations(angle, plain):
    expected = derive(own(elementary("z", plain)))
    for model in (own(elementary("z", angle)), turns(("z", angle))):
        found = derive(model)
        assert found.is_proved
        assert combination(plain) == combination(angle)
        assert sp.expand(found.angular_velocity_space[2] - expected.angular_velocity_space[2]) == 0


def test_parts_of_an_angle_in_several_turns_are_a_rotation():
    found = derive(own(product(("z", phi * u / (u + w)), ("z", phi * w / (u + w)))))
    assert found.is_proved


@pytest.mark.parametrize("angle", [phi / u, phi * psi / (u + w), phi * sqrt(2), pi / 3 + phi / 2])
def test_angles_that_do_not_cancel_stay_as_they_are_written(angle):
    assert Turn(axis="z", angle=angle).angle == angle


# Singular points.


@pytest.mark.parametrize("axes", ["xyzx", "zxzx", "zyxy", "xyxz"])
@pytest.mark.parametrize(
    ("constraint", "value"),
    [(sin(x), pi), (cos(x), pi / 2), (sin(x) - Rational(1, 2), pi / 6)],
    ids=str,
)
def test_singular_points_satisfy_the_conditions(axes, constraint, value):
    matrix = sp.eye(3)
    for axis, angle in zip(axes, (x, y, z, a), strict=True):
        matrix = matrix * elementary(axis, angle)
    found = derive(own(matrix, constraint, example={x: value}), ["rate_matrix_space"])
    for point in found.singularities.points:
        values = {place.coordinate: place.value for place in point.places}
        assert constraint.xreplace(values).has(x) or constraint.xreplace(values) == 0
        assert point.rank > 0


# Claims are evaluated.


def test_a_false_claim_that_the_ring_takes_for_true_is_a_failure(monkeypatch):
    monkeypatch.setattr(RingMatrix, "is_zero", lambda *_: True)
    with pytest.raises(Defect, match="a defect of rigidsym"):
        derive(own(sp.diag(1, 1, -1) * ABOUT_Z))


def test_a_wrong_product_in_the_ring_is_a_failure(monkeypatch):
    """The values are those of the factors, and not of their product in the ring."""
    codec = codec_for([x, y])
    entries = [codec.encode(x), codec.encode(y)]
    row = RingMatrix.of(codec.ring, [entries])
    monkeypatch.setattr(Ring, "dot", lambda self, *_, **__: self.zero)
    wrong = row @ row.T
    assert wrong.is_zero()
    with pytest.raises(Defect, match="is proved, and yet is false at a point"):
        Prover(Conditions("sample"), codec).vanishes(wrong, CLAIM)


@pytest.mark.parametrize("rotation", ["ZXZ", "unit_quaternion", "rotation_vector", "axis_angle"])
def test_every_claim_of_a_derivation_is_evaluated(monkeypatch, rotation):
    seen, values = [], []
    vanish, disagrees = Prover.vanish, Witness.disagrees

    def evaluated(self, residual, known):
        values.append(residual)
        return disagrees(self, residual, known)

    def claimed(self, claims, **given):
        proofs = vanish(self, claims, **given)
        seen.extend(claim for residual, claim, _ in claims if residual in values)
        return proofs

    monkeypatch.setattr(Witness, "disagrees", evaluated)
    monkeypatch.setattr(Prover, "vanish", claimed)
    found = rs.derive(rotation)
    assert {proof.claim for proof in found.proofs} <= set(seen)


def test_what_is_false_on_the_conditions_is_refuted_by_a_value():
    with pytest.raises(NotARotation, match="left over"):
        derive(own(ABOUT_Z * (x**2 + y**2), x**2 + y**2 - 4, example={x: 0, y: 2}))


def test_a_tangent_is_real_and_a_division():
    found = derive(own(about_z(1 / sqrt(1 + tan(x) ** 2), tan(x) / sqrt(1 + tan(x) ** 2))))
    assert found.step("rotation_matrix").proofs[0].is_exact
