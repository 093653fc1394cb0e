"""The catalogue of rotations, the checks of a model, and arguments from Python.

What the command line refuses stands in golden/commands/refused.txt.
"""

from __future__ import annotations

import inspect
from dataclasses import FrozenInstanceError, replace

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.parametrisations import CHAINS, motion_of
from helpers.samples import ONE, chain, model, phi
from helpers.witness import CONVENTIONS
from rigidsym.models.body import Parameter, RigidBody
from rigidsym.models.forces import no_rotation
from rigidsym.models.library import PRESETS, rotation_from, rotation_given, turned_by
from rigidsym.models.parametrisations import EULER_SEQUENCES, axis_turn, chain as chain_of
from rigidsym.models.rotation import Turn
from rigidsym.notes.problems import sheets_of
from rigidsym.spec.derivation_file import read_record
from rigidsym.spec.derivation_spec import spec_for

a, b = sp.symbols("a b")
q = dynamicsymbols("q")
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
        (lambda: sample(matrix=sp.GoldenRatio * sp.ImmutableMatrix(ONE)), "number GoldenRatio"),
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
        rates = motion_of(text).step("rates_from_angular_velocity_body")
        assert rates.quantity.unit == unit


def test_roots_of_roots_are_a_unit_axis_where_they_are_one():
    root = sp.sqrt(2 + sp.sqrt(2)) / 2  # cos π/8
    other = sp.sqrt(2 - sp.sqrt(2)) / 2
    nested = sp.sqrt(5 + 2 * sp.sqrt(6)) - sp.sqrt(2) - sp.sqrt(3)  # zero, not when expanded
    assert chain_of([axis_turn((root, other, nested), phi)]).constraints == ()
    b, c = sp.symbols("b c", real=True)
    divided = tuple(e / sp.sqrt(b**2 + c**2) for e in (b, c, 0))
    assert chain_of([axis_turn(divided, phi)]).constraints == ()
    near = (root, other + sp.Rational(1, 10**40), 0)
    assert axis_turn(near, phi).components != near  # made one
    assert axis_turn((1, 1, 0), phi).components == (sp.sqrt(2) / 2, sp.sqrt(2) / 2, 0)
