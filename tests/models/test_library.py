"""Rotations of the catalogue and others, the checks of a model, and arguments from Python.

A rotation is proved to be one without a change to the ring, any other matrix is refused, and an
undecided one is marked unproved. What the command line refuses is in golden/commands/refused.txt.
"""

from __future__ import annotations

import inspect
from dataclasses import FrozenInstanceError, replace

import pytest
import sympy as sp
from sympy import pi, sech, sin, sqrt, tanh
from sympy.physics.vector import dynamicsymbols
from sympy.printing.pretty.pretty_symbology import pretty_use_unicode

import rigidsym as rs
from helpers.parametrisations import CHAINS, motion_of
from helpers.samples import ROTATIONS, TIME, WRONG, about_z, chain, model
from helpers.witness import CONVENTIONS, agree, evaluate, mp, paths, unhat, values_along
from rigidsym.errors import AlgebraError, DerivationError, ModelError, NotARotation
from rigidsym.mechanics.derive import derive
from rigidsym.models.body import Parameter, RigidBody
from rigidsym.models.forces import no_rotation
from rigidsym.models.library import PRESETS, rotation_from, rotation_given, turned_by
from rigidsym.models.parametrisations import EULER_SEQUENCES, axis_turn
from rigidsym.models.rotation import Turn, elementary, time_function
from rigidsym.notes.problems import sheets_of
from rigidsym.spec.derivation_file import read_record
from rigidsym.spec.derivation_spec import spec_for

a, b = sp.symbols("a b")
q = dynamicsymbols("q")
phi, theta, psi, u = map(time_function, ("phi", "theta", "psi", "u"))
w, x, y, z = map(time_function, "wxyz")
SQUARE = x**2 + y**2 + z**2
IDENTITY = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
M = Parameter(symbol=a, about="mass", unit="kg")
NO_NUMBER = Parameter(symbol=a, positive=False, value=float("nan"))
TURNED = {"rotation": "z(psi)", "principal_moments": [1, 1, 1]}
MANY_TURNS = sp.rot_axis3(q) * sp.rot_axis1(500 * q / 7)
POINT, NEEDLE = (rs.principal_moments(k, k, 0, allow=True) for k in (0, 1))


def body(**changes: object) -> RigidBody:
    given = {"name": "own", "mass": sp.Integer(1), "inertia": sp.eye(3), "parameters": []}
    given |= {"centre": sp.zeros(3, 1), "title": "A body"} | changes
    fixed = {k: sp.ImmutableMatrix(given[k]) for k in ("inertia", "centre")}
    return RigidBody(**given | fixed | {"parameters": tuple(given["parameters"])})


def dynamics(rotation: str = "z(theta)", **acting: object) -> rs.Motion:
    return rs.derive(rotation, **{"body": rs.principal_moments(1, 1, 1), "potential": 0} | acting)


def sample(**change: object) -> rs.RotationModel:
    return replace(model(chain(("z", phi)), phi), **change)


def own(**options: object) -> rs.RotationModel:
    return rs.given(sp.eye(3), name="mine", coordinates=[q], **options)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: rs.solid("sphere", radius="r"), "expected a SymPy expression, got 'r'"),
        (lambda: rs.Turn(axis="u", angle=a), "'u' is not an axis: expected x, y, z"),
        (lambda: rs.Turn(axis="u", angle=a, components="abc"), "axis of a turn: expected a SymPy"),
        (lambda: rs.Turn(axis="u", angle=a, components=(1, 1, 0)), "has the length sqrt(2)"),
        (lambda: rs.Turn(axis="u", angle=a, components=(0, 0, 0)), "has the length 0"),
        (lambda: rs.Turn(axis="u", angle=a, components=(0.6, 0.8, 0)), "expected exact numbers"),
        (lambda: rs.Turn(axis="u", angle=a, components=5), "three components, got 5"),
        (lambda: rs.EulerAngles(3), "expected a sequence such as 'ZXZ', got 3"),
        (lambda: rs.chain("z(a) x(b)"), "expected a list of rs.Turn, got 'z(a) x(b)'"),
        (lambda: rs.derive("ZXZ", timeout="1"), "expected a positive number of seconds, got '1'"),
        (lambda: rs.identify("abc", matrix=sp.eye(3)), "angles: expected real numbers"),
        (lambda: rs.given(IDENTITY, name="mine"), "expected a SymPy expression, got '1'"),
        (lambda: sheets_of("tops", count=1, variant=1), "no problems on 'tops'"),
        (lambda: rs.chain([]), "a chain needs at least one turn, such as z(phi)"),
        (lambda: rotation_given(IDENTITY[:2], name="m", coordinates=["a"]), "three rows of three"),
        (lambda: own(example={"q": 0.5}), "exact"),
        (lambda: turned_by("[u,0,1](a)"), "expected an axis with numbers as comp"),
        (lambda: rotation_from("ZXZ", constants=["k"]), "they go with turns"),
        (lambda: rs.Particles(particles=[]), "expected at least one particle"),
        (lambda: body(name="My body"), "expected lower-case letters, digits and underscores"),
        (lambda: body(mass=a * b, parameters=[M]), "own: b is not among the parameters"),
        (lambda: body(inertia=sp.diag(a, 1, 1), parameters=[NO_NUMBER]), "holds NaN or infinity"),
        (lambda: rs.derive(rs.given(MANY_TURNS, name="mine")), "expected multiples up to 100"),
        (lambda: dynamics(body=NEEDLE), "the mass matrix has no inverse; expected coordinates"),
        (lambda: dynamics("ZXZ", body=POINT, method="euler"), "the inertia tensor has no inverse"),
        (lambda: dynamics("z(a) x(b)", method="euler"), "coordinates whose rates follow from"),
        (lambda: dynamics(method="newton"), "no method 'newton'"),
        (lambda: dynamics(parts=[{"mass": 1}]), "a part with mass; expected rotation and"),
        (lambda: dynamics(parts=[TURNED]), "a part turns by psi, which is not a coordinate"),
        (lambda: dynamics(examples=[{"mass": 1}]), "an example: unknown key mass; exp"),
        (lambda: dynamics(examples=[{"time": 1, "parameters": {"k": 1}}]), "unknown parameter k"),
        (lambda: sample(name="Upper"), "'Upper' cannot name a model"),
        (lambda: sample(matrix=sp.ImmutableMatrix(sp.eye(2))), "matrix is 3x3, got (2, 2)"),
        (lambda: sample(coordinates=()), "needs at least one coordinate"),
        (lambda: sample(coordinates=(phi, phi)), "phi(t) is named twice"),
        (lambda: sample(coordinates=(sp.Symbol("phi"),)), "phi is not a function of t"),
        (lambda: sample(units=("rad", "m")), "1 coordinates, but 2 units"),
        (lambda: sample(turns=(Turn(axis="x", angle=phi),)), "product of its turns, Rx(φ)"),
        (lambda: sample(matrix=sp.GoldenRatio * sp.ImmutableMatrix.eye(3)), "number GoldenRatio"),
    ],
)
def test_a_wrong_argument_is_named(make, said):
    with pytest.raises(rs.RigidsymError) as caught:
        make()
    assert said in str(caught.value)


@pytest.mark.parametrize("arguments", [{"only": 3}, {"only": [3]}, {"body": 3}, {"model": 3}])
def test_an_argument_of_the_wrong_type_is_a_type_error_that_says_what_was_expected(arguments):
    with pytest.raises(TypeError, match="expected"):
        rs.derive(**{"model": "ZXZ", **arguments})


def test_records_are_set_once_by_name_and_show_their_fields():
    turn = rs.Turn(axis="x", angle=sp.nan)
    assert turn == replace(turn)
    assert [*inspect.signature(rs.Turn).parameters] == ["axis", "angle", "components"]
    with pytest.raises(TypeError, match="Turn has the fields"):
        rs.Turn("x", a)
    with pytest.raises(FrozenInstanceError):
        del turn.angle


def test_without_coordinates_of_no_rotation_all_are_zero():
    assert no_rotation(rs.rotation_from("x(pi/2) z(a)")) == {"a": 0.0}
    assert no_rotation(rs.rotation_from("quaternion")) == {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0}
    entries = no_rotation(rs.rotation_from("direction_cosines"))
    assert [*entries.values()] == [1, 0, 0, 0, 1, 0, 0, 0, 1]


def test_arguments_of_other_kinds_that_mean_the_same():
    named = rs.EulerAngles("ZYX", angles=sp.symbols("a b c"))
    assert named == rs.EulerAngles("ZYX", angles=("a", "b", "c"))
    ball = rs.solid("sphere", radius=1, mass=2)
    assert (ball.mass, ball.inertia) == (2, sp.diag(*[sp.Rational(4, 5)] * 3))


@pytest.mark.parametrize("text", ["ZXZ", "unit_quaternion", *PRESETS, *CHAINS[3:8]])
def test_what_was_asked_for_can_be_asked_for_again(text):
    spec = spec_for(text, passive=True)
    assert read_record(spec.to_data()) == spec


def test_names_of_conventions_are_their_own():
    assert set(EULER_SEQUENCES) == set(CONVENTIONS)
    names = {rs.EulerAngles(c, passive=p).name for c in CONVENTIONS for p in (False, True)}
    assert len(names) == 48
    assert {"euler_zxz_intrinsic", "euler_zyx_extrinsic"} <= names


def test_zero_names_a_constant_and_ten_does_not():
    turned = rotation_from("z(a_9) x(alpha0) y(a_10) x(b_0)")
    assert [symbol.name for symbol in turned.constants] == ["alpha0", "b_0"]
    assert [q.func.__name__ for q in turned.coordinates] == ["a_9", "a_10"]


def test_the_scalar_stands_last_on_request_and_rates_have_the_unit_of_the_coordinates():
    first, last = rotation_from("quaternion"), rotation_from("quaternion", scalar_last=True)
    assert last.coordinates == (*first.coordinates[1:], first.coordinates[0])
    assert last.matrix == first.matrix
    assert last.name != first.name
    for text, unit in (("ZXZ", "rad/s"), ("unit_quaternion", "1/s")):
        assert motion_of(text).step("rates_from_angular_velocity_body").quantity.unit == unit


def test_roots_of_roots_are_a_unit_axis_where_they_are_one():
    root = sp.sqrt(2 + sp.sqrt(2)) / 2  # cos π/8
    other = sp.sqrt(2 - sp.sqrt(2)) / 2
    nested = sp.sqrt(5 + 2 * sp.sqrt(6)) - sp.sqrt(2) - sp.sqrt(3)  # zero, not when expanded
    assert rs.chain([axis_turn((root, other, nested), phi)]).constraints == ()
    b, c = sp.symbols("b c", real=True)
    divided = tuple(e / sp.sqrt(b**2 + c**2) for e in (b, c, 0))
    assert rs.chain([axis_turn(divided, phi)]).constraints == ()
    near = (root, other + sp.Rational(1, 10**40), 0)
    assert axis_turn(near, phi).components != near  # made one
    assert axis_turn((1, 1, 0), phi).components == (sp.sqrt(2) / 2, sp.sqrt(2) / 2, 0)


@pytest.mark.parametrize("name", ROTATIONS)
def test_other_rotations_are_data_and_turn_as_the_numbers_do(name):
    """Small coordinates, so that roots and tangents stay where they are real."""
    sample = ROTATIONS[name]
    motion = derive(sample)
    assert motion.is_proved
    assert hasattr(motion, "inverse_rate_matrix_space") == (motion.singularities.rank == 3)
    if sample.constraints:
        return
    (path,) = paths(1, size=len(sample.coordinates), seed=6)
    path = replace(path, q=tuple(value / 9 for value in path.q))
    numbers = (mp.mpf(3) / 7, mp.mpf(5) / 7, mp.mpf(2) / 3)
    constants = dict(zip(sp.symbols("m l alpha"), numbers, strict=True))

    def R(t):
        return evaluate(sample.matrix, {**values_along(sample.coordinates, path, t), **constants})

    def printed(quantity):
        values = {**values_along(sample.coordinates, path), **constants}
        return evaluate(getattr(motion, quantity), values)

    first, second = mp.diff(R, 0), mp.diff(R, 0, 2)
    omega = unhat(first * R(0).T)
    alpha_space = unhat(second * R(0).T + first * first.T)
    assert agree(printed("angular_velocity_body"), R(0).T * omega)
    assert agree(printed("rate_matrix_space") * mp.matrix(path.q_dot), omega)
    assert agree(printed("angular_acceleration_body"), R(0).T * alpha_space)


def test_functions_of_unknown_relations_leave_the_claims_unproved():
    """It is a rotation, but the ring does not know sech² + tanh² = 1."""
    motion = derive(model(about_z(sech(u), tanh(u)), u))
    unproved = [proof for proof in motion.proofs if not proof.is_exact]
    assert not motion.is_proved
    assert {proof.claim.text for proof in unproved} >= {"R Rᵀ = 1", "det R = 1"}
    for proof in unproved:
        assert proof.status == "unproved"
        values = {**values_along([u], paths(1, size=1)[0]), TIME: mp.mpf(0)}
        assert proof.residual is not None
        assert not proof.residual.is_zero_matrix
        assert agree(evaluate(proof.residual, values), mp.zeros(*proof.residual.shape))


@pytest.mark.parametrize(("sample", "claim", "residual"), WRONG.values(), ids=WRONG)
def test_what_is_no_rotation_is_refused_with_what_is_left_over(sample, claim, residual):
    with pytest.raises(NotARotation) as caught:
        derive(sample)
    message = str(caught.value)
    assert message.startswith(f"sample: not a rotation, since {claim} fails; left over: ")
    assert residual in message.split("left over: ", 1)[1]


@pytest.mark.parametrize(
    ("factor", "constraint"),
    [
        (sqrt(4 * SQUARE) / (2 * sqrt(SQUARE)), w - phi),  # dependent roots
        (w, (w - 1) ** 2),  # w = 1, which is not in the ideal that it spans
    ],
)
def test_what_the_ring_does_not_know_refutes_no_rotation(factor, constraint):
    example = {w: sp.S.One, phi: sp.S.One}
    turned = factor * elementary("z", phi)
    bound = {"constraints": (constraint,), "example": example}
    assert not derive(model(turned, *(phi, x, y, z, w), **bound)).is_proved


@pytest.mark.parametrize(
    "angle", [phi + TIME, phi + a * sp.sin(TIME), phi + psi], ids=["time", "drive", "stranger"]
)
def test_motion_that_the_coordinates_do_not_hold_is_refused(angle):
    with pytest.raises((DerivationError, AlgebraError, ModelError)):
        derive(model(elementary("z", angle), phi))


def test_a_double_zero_of_the_determinant_is_one_singular_point():
    turns = ("z", phi), ("x", theta), ("z", psi * sin(theta))
    found = derive(model(chain(*turns), phi, theta, psi)).singularities
    assert (found.is_solved, found.determinant) == (True, -(sin(theta) ** 2))
    places = {(p.places[0].value, p.places[0].period, p.rank) for p in found.points}
    assert places == {(0, 2 * pi, 2), (pi, 2 * pi, 2)}


def test_a_convention_is_said_in_greek_letters_whatever_the_terminal_shows():
    before = pretty_use_unicode(False)  # as SymPy decides where standard output is ASCII
    try:
        model = rs.EulerAngles("ZXZ", ("phi_1", "theta", "psi"))
        assert model.product == "Rz(φ₁) Rx(θ) Rz(ψ)"
        assert "first by φ₁ about the z-axis, then by θ about the new x-axis" in " ".join(
            model.convention
        )
        assert not pretty_use_unicode(False)  # which stays as it was
    finally:
        pretty_use_unicode(before)
