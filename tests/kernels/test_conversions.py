"""Every model to and from the quaternion and the matrix: SciPy and 50 digits say that it is so."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.conversion_modules import module
from helpers.witness import mp
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.models.library import PARAMETRISATIONS, rotation_from
from rigidsym.models.parametrisations import RotationVector, given

EPS = 10 * np.finfo(np.float64).eps  # ten times what is stated, for other processors
CLOSED = tuple(PARAMETRISATIONS)
EULER = ("ZXZ", "zyx")
ALL = (*EULER, *CLOSED)
ANY = Rotation.random(300, rng=np.random.default_rng(5))
SPECIAL = Rotation.concatenate(  # no turn, half turns, nearly none, nearly half a turn
    [
        Rotation.identity(),
        *(Rotation.from_rotvec(np.pi * np.array(a)) for a in np.eye(3)),
        *(Rotation.from_rotvec(np.pi * np.array(a) / 2) for a in (*np.eye(3), *-np.eye(3))),
        Rotation.from_rotvec([1e-9, -2e-9, 1e-12]),
        Rotation.from_rotvec(np.array([0.6, 0.0, 0.8]) * (np.pi - 1e-9)),
    ]
)


def matrices(rotations: Rotation, *, passive: bool) -> np.ndarray:
    return (rotations.inv() if passive else rotations).as_matrix()


def quaternions(rotations: Rotation) -> np.ndarray:
    return rotations.as_quat(scalar_first=True)


def assert_same_turn(found: np.ndarray, expected: np.ndarray, atol: float = 4 * EPS) -> None:
    """Quaternions that are equal but for their sign."""
    sign = np.sign((found * expected).sum(axis=-1, keepdims=True))
    assert_allclose(found * sign, expected, atol=atol, rtol=0)


@pytest.mark.parametrize("passive", [False, True], ids=["active", "passive"])
@pytest.mark.parametrize("text", ALL)
def test_round_trips(text, passive):
    functions = module(text, passive=passive)
    for rotations in (ANY, SPECIAL):
        matrix, quaternion = matrices(rotations, passive=passive), quaternions(rotations)
        from_matrix = functions.from_rotation_matrix(matrix)
        lengths = np.linspace(-0.01, 50, len(rotations))[:, np.newaxis]
        from_quaternion = functions.from_quaternion(quaternion * lengths)
        for q in (from_matrix, from_quaternion):
            kept = np.isfinite(q).all(axis=-1)  # the half turns of a Gibbs vector are not
            assert kept[: len(ANY)].sum() >= (8 if text == "gibbs_vector" else len(rotations))
            assert_allclose(functions.rotation_matrix(q[kept]), matrix[kept], atol=8 * EPS, rtol=0)
            assert_same_turn(functions.quaternion(q[kept]), quaternion[kept])


@pytest.mark.parametrize("text", EULER)
def test_angles_are_scipys(text):
    functions = module(text)
    expected = ANY.as_euler(text)
    assert_allclose(functions.from_rotation_matrix(ANY.as_matrix()), expected, atol=1e-12)
    assert_allclose(functions.from_quaternion(quaternions(ANY)), expected, atol=1e-12)


def poles(text: str) -> tuple[float, float]:
    """The middle angles at which a sequence loses a direction."""
    proper = text[0] == text[2]
    return (0.0, np.pi) if proper else (-np.pi / 2, np.pi / 2)


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-160, 1e-20, 1e-8, 1e-3, 3.1415926])
def test_rotation_vectors_of_every_length(size):
    functions = module("rotation_vector")
    vector = np.array([0.36, -0.48, 0.8]) * size
    half = mp.sqrt(sum(mp.mpf(part) ** 2 for part in vector.tolist())) / 2
    ratio = mp.sin(half) / half / 2 if half else mp.mpf(1) / 2
    exact = [mp.cos(half), *(ratio * mp.mpf(part) for part in vector.tolist())]
    found = functions.quaternion(vector)
    assert_allclose(found[1:], np.array(exact[1:], float), rtol=4 * EPS, atol=0)
    assert_allclose(found[0], float(exact[0]), rtol=4 * EPS, atol=EPS)
    assert_allclose(functions.from_quaternion(found), vector, rtol=8 * EPS, atol=0)


def test_zero_quaternions_and_nan_give_nan():
    for text in ALL:
        functions = module(text)
        for quaternion in ([0.0] * 4, [np.nan, 0.5, 0.5, 0.5], [1.0, 0.0, 0.0, np.nan]):
            found = functions.from_quaternion([quaternion, [1.0, 0.0, 0.0, 0.0]])
            assert np.isnan(found[0]).any(), text
            assert np.isfinite(found[1]).all(), text
            assert np.isnan(functions.from_quaternion_scalar(*quaternion)).any(), text
        matrix = np.where(np.eye(3)[::-1] > 0, np.nan, np.eye(3))
        assert np.isnan(functions.from_rotation_matrix(matrix)).any(), text


@pytest.mark.parametrize("scalar_last", [False, True])
def test_a_quaternion_of_any_length_is_a_rotation_and_zero_is_none(scalar_last):
    model = rotation_from("quaternion", scalar_last=scalar_last)
    functions = rs.derive(model).kernels(conversions=True).load()
    quaternion = ANY.as_quat(scalar_first=not scalar_last)
    lengths = np.logspace(-100, 100, len(quaternion))[:, np.newaxis]
    assert_allclose(functions.rotation_matrix(lengths * quaternion), ANY.as_matrix(), atol=8 * EPS)
    assert np.isnan(functions.rotation_matrix(np.zeros(4))).all()
    assert np.isnan(functions.rotation_matrix_scalar(0.0, 0.0, 0.0, 0.0)).all()
    assert np.isnan(functions.quaternion(np.zeros(4))).all()
    for size in (1e-300, 1e300):
        found = functions.quaternion(size * quaternion)
        assert_allclose(found, quaternion, rtol=4 * EPS, atol=EPS)


def test_half_turns_of_a_gibbs_vector_are_infinite():
    found = module("gibbs_vector").from_rotation_matrix(np.diag([1.0, -1.0, -1.0]))
    assert_array_equal(np.abs(found), [np.inf, 0.0, 0.0])
    assert_array_equal(
        module("gibbs_vector").from_quaternion_scalar(0.0, 1.0, 1.0, 0.0), [np.inf, np.inf, 0.0]
    )


@pytest.mark.parametrize(
    "text", [*ALL, "rpy", "z(phi) x(theta)", "z(phi)", "z(phi) x(theta) [0,b,c](psi)"]
)
def test_every_conversion_is_proved(text):
    found = Conversions(rotation_from(text))
    assert found.proofs
    assert all(proof.is_exact for proof in found.proofs)
    assert (found.inverse is None) == bool(found.without)


@pytest.mark.parametrize(
    "text", ["z(phi) x(theta)", "z(a) x(b) z(-a)", "z(phi) x(theta) [0,b,c](psi)"]
)
def test_other_turns_name_what_to_use(text):
    model = rotation_from(text)
    conversions = Conversions(model)
    assert conversions.inverse is None
    assert "scipy.optimize" in conversions.without
    functions = rs.derive(model, ["rotation_matrix"]).kernels(conversions=True).load()
    assert not hasattr(functions, "from_quaternion")
    assert conversions.without in " ".join(functions.__doc__.split())


@pytest.mark.parametrize(
    "text",
    [
        "z(phi)",
        "y(theta) [1,1,1](psi)",
        "z(phi) x(pi/4)",  # the half of π/4 has a root of a root
        "z(phi) x(pi/3) z(psi) y(2*delta)",
        "z(a) x(b) z(c) x(d) y(e)",  # too long to be written out
        "z(phi) x(theta) [0,b,c](psi)",  # with constants
        "z(a) x(alpha0) z(b) x(c) y(d)",
    ],
)
def test_every_chain_has_a_quaternion(text):
    model = rotation_from(text)
    functions = rs.derive(model, ["rotation_matrix"]).kernels(conversions=True).load()
    q = np.random.default_rng(4).uniform(-3, 3, (30, len(model.coordinates)))
    numbers = [0.6, 0.8][: len(model.constants)]
    constants = [numbers] if numbers else []
    expected = Rotation.from_matrix(functions.rotation_matrix(q, *constants))
    found = functions.quaternion(q, *constants)
    assert_same_turn(found, quaternions(expected), atol=16 * EPS)
    assert_allclose(functions.quaternion_scalar(*q[0], *numbers), found[0], atol=16 * EPS)


def test_a_matrix_of_ones_own_converts_by_what_it_is():
    vector = given(RotationVector().matrix, name="mine")
    assert Conversions(vector).inverse.rule == "rotation_vector"
    phi = sp.Function("phi")(sp.Symbol("t"))
    c, s = sp.cos(phi), sp.sin(phi)
    about_z = given(sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]]), name="own")
    functions = rs.derive(about_z).kernels(conversions=True).load()
    found = functions.quaternion([[1.0], [-1.0], [3.0]])
    angles = np.array([1.0, -1.0, 3.0])
    expected = np.stack([np.cos(angles / 2), 0 * angles, 0 * angles, np.sin(angles / 2)], axis=-1)
    assert_allclose(found, expected, atol=4 * EPS)
    assert "scipy.optimize" in Conversions(about_z).without


@pytest.mark.parametrize("text", ALL)
def test_scalar_twins_and_single_precision_agree(text):
    functions, matrix, quaternion = module(text), ANY.as_matrix()[:20], quaternions(ANY)[:20]
    pairs = (
        (functions.from_rotation_matrix, functions.from_rotation_matrix_scalar, matrix),
        (functions.from_quaternion, functions.from_quaternion_scalar, quaternion),
        (functions.quaternion, functions.quaternion_scalar, functions.from_quaternion(quaternion)),
    )
    for function, scalar, values in pairs:
        expected = function(values)
        one_by_one = np.array([scalar(*value.ravel().tolist()) for value in values])
        assert_allclose(one_by_one, expected, atol=16 * EPS, rtol=16 * EPS)
        single = function(values.astype(np.float32))
        assert single.dtype == np.float32
        assert_allclose(single, expected, atol=1e-4, rtol=1e-3)


@pytest.mark.parametrize("text", EULER)
def test_at_a_pole_the_last_angle_is_zero(text):
    q = np.array([[0.7, middle, -1.9] for middle in poles(text)])
    for rotations in (Rotation.from_euler(text, q), ANY[0] * Rotation.from_euler(text, q)):
        exactly = Rotation.from_euler(text, q) if rotations[0].approx_equal(ANY[0]) else rotations
        found = module(text).from_quaternion(quaternions(exactly))
        rebuilt = Rotation.from_euler(text, found)
        assert (rebuilt * exactly.inv()).magnitude().max() < 8 * EPS
    found = module(text).from_rotation_matrix(Rotation.from_euler(text, q).as_matrix())
    assert_array_equal(found[:, 2], 0.0)
    assert_allclose(found[:, 1], poles(text), atol=4 * EPS)


@pytest.mark.parametrize("text", ["quaternion", "unit_quaternion"])
def test_conversions_of_scalar_last_quaternions_are_scalar_last(text):
    functions = rs.derive(rotation_from(text, scalar_last=True)).kernels(conversions=True).load()
    quaternion = ANY.as_quat()  # SciPy's are scalar last, too
    for name in ("quaternion", "from_quaternion"):
        assert_allclose(getattr(functions, name)(quaternion), quaternion, atol=4 * EPS)
        assert "scalar last" in getattr(functions, name).__doc__
    found = functions.from_rotation_matrix(ANY.as_matrix())
    assert_allclose(np.abs((found * quaternion).sum(axis=-1)), 1.0, atol=8 * EPS)
    assert_allclose(functions.rotation_matrix(found), ANY.as_matrix(), atol=8 * EPS)
