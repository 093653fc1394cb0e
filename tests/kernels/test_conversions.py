"""To and from the quaternion and the matrix, in every target, and along a trajectory."""

from __future__ import annotations

from functools import cache
from itertools import permutations
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.node import load
from helpers.parametrisations import WITNESSES, by_quaternion
from helpers.target_modules import OTHERS, row_by_row
from helpers.witness import distance, mp, rotation as exact_rotation
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.models.library import PARAMETRISATIONS, rotation_from

EPS = 10 * np.finfo(np.float64).eps  # ten times what is stated, for other processors
EULER = ("ZXZ", "zyx")
ALL = (*EULER, *PARAMETRISATIONS)
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
TIMES = np.linspace(0.01, 12.0, 2401)

pytestmark = pytest.mark.usefixtures("double")


@cache
def module(text: str, target: str = "numpy", *, passive: bool = False) -> ModuleType:
    motion = rs.derive(rotation_from(text, passive=passive), ["rotation_matrix"])
    return load(motion.kernels(target, conversions=True))


def quaternions(rotations: Rotation) -> np.ndarray:
    return rotations.as_quat(scalar_first=True)


def assert_same_turn(actual: np.ndarray, expected: np.ndarray, atol: float = 4 * EPS) -> None:
    """Quaternions that are equal but for their sign."""
    sign = np.sign((actual * expected).sum(axis=-1, keepdims=True))
    assert_allclose(actual * sign, expected, atol=atol, rtol=0)


@pytest.mark.parametrize("passive", [False, True])
@pytest.mark.parametrize("text", ALL)
def test_round_trips(text, passive):
    functions = module(text, passive=passive)
    for rotations in (ANY, SPECIAL):
        matrix = (rotations.inv() if passive else rotations).as_matrix()
        lengths = np.linspace(-0.01, 50, len(rotations))[:, np.newaxis]
        for q in (
            functions.from_rotation_matrix(matrix),
            functions.from_quaternion(quaternions(rotations) * lengths),
        ):
            kept = np.isfinite(q).all(axis=-1)  # the half turns of a Gibbs vector are not
            assert kept.sum() >= (8 if text == "gibbs_vector" else len(rotations))
            assert_allclose(functions.rotation_matrix(q[kept]), matrix[kept], atol=8 * EPS, rtol=0)
            assert_same_turn(functions.quaternion(q[kept]), quaternions(rotations)[kept])
            if text in EULER and rotations is ANY and not passive:
                assert_allclose(q, ANY.as_euler(text), atol=1e-12)


# The error, as the angle between two rotations in eps, at 50 digits.
MOST_OF_EULER = 160  # near poles too; ten times what was measured
MOST_OF_OTHERS = 40


def near_poles(text: str, count: int) -> np.ndarray:
    """Quaternions (count, 4), every second of them near a pole of Euler angles."""
    source = np.random.default_rng(7)
    random = source.normal(size=(count, 4))
    if text not in EULER:
        return random
    away = source.choice([-1, 1], count) * 10.0 ** -source.uniform(1, 17, count)
    middle = source.choice([0, np.pi] if text == "ZXZ" else [-np.pi / 2, np.pi / 2], count) + away
    angles = np.stack([source.uniform(-3, 3, count), middle, source.uniform(-3, 3, count)], axis=1)
    return np.where(
        np.arange(count)[:, None] % 2, quaternions(Rotation.from_euler(text, angles)), random
    )


def assert_accurate(text: str, target: str, p: np.ndarray) -> None:
    """Both ways back from quaternions, or from their matrices as rounded."""
    matrices = [by_quaternion(*map(mp.mpf, row)) for row in p.astype(float).tolist()]
    rounded = np.array([np.array(R.tolist(), float) for R in matrices]).astype(p.dtype)
    read = [mp.matrix(matrix.astype(float).tolist()) for matrix in rounded]
    for name, values, truths in (
        ("from_quaternion", p, matrices),
        ("from_rotation_matrix", rounded, read),
    ):
        for row, R in zip(
            row_by_row(target, getattr(module(text, target), name))(values), truths, strict=True
        ):
            q = [mp.mpf(float(part)) for part in row]
            turned = exact_rotation(text, q) if text in EULER else WITNESSES[text][1](q)
            error = distance(turned, R) / max(map(abs, R)) / np.finfo(p.dtype).eps
            assert error <= (MOST_OF_EULER if text in EULER else MOST_OF_OTHERS), (name, row)


@pytest.mark.parametrize("text", ALL)
def test_inverse_conversions_are_accurate_near_poles_too(text):
    for dtype in (np.float64, np.float32):
        assert_accurate(text, "numpy", near_poles(text, 16).astype(dtype))


@pytest.mark.parametrize(
    ("text", "target"),
    [
        pytest.param(text, *target.values, marks=target.marks, id=f"{text}-{target.values[0]}")
        for text in ("zyx", "rotation_vector")
        for target in OTHERS
        if text == "zyx" or target.values[0] not in ("numba", "jax")  # which take long to compile
    ],
)
def test_every_target_is_as_accurate_and_has_the_quaternion_of_numpy(text, target):
    p = near_poles(text, 12)
    assert_accurate(text, target, p)
    q = module(text).from_quaternion(p)
    found = module(text, target).quaternion(q)
    assert_allclose(found, module(text).quaternion(q), rtol=1e-13, atol=1e-13)


def test_jax_derives_conversions_at_no_turn_too():
    """There and back is the identity, and so is its derivative."""
    import jax

    functions = module("rotation_vector", "jax")
    back = jax.jit(jax.jacobian(lambda v: functions.from_quaternion(functions.quaternion(v))))
    assert_allclose(back(np.zeros(3)), np.eye(3), atol=1e-14)


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-160, 1e-8, 1e-3, 3.1415926])
def test_rotation_vectors_of_every_length(size):
    functions = module("rotation_vector")
    vector = np.array([0.36, -0.48, 0.8]) * size
    half = mp.sqrt(sum(mp.mpf(part) ** 2 for part in vector.tolist())) / 2
    ratio = mp.sin(half) / half / 2 if half else mp.mpf(1) / 2
    found = functions.quaternion(vector)
    exact = [float(ratio * mp.mpf(part)) for part in vector.tolist()]
    assert_allclose(found[1:], exact, rtol=4 * EPS, atol=0)
    assert_allclose(found[0], float(mp.cos(half)), rtol=4 * EPS, atol=EPS)
    assert_allclose(functions.from_quaternion(found), vector, rtol=8 * EPS, atol=0)


@pytest.mark.parametrize("text", ALL)
def test_scalar_twins_and_single_precision_agree_and_no_rotation_is_nan(text):
    functions, matrix, quaternion = module(text), ANY.as_matrix()[:20], quaternions(ANY)[:20]
    for name, values in (
        ("from_rotation_matrix", matrix),
        ("from_quaternion", quaternion),
        ("quaternion", functions.from_quaternion(quaternion)),
    ):
        function, scalar = getattr(functions, name), getattr(functions, f"{name}_scalar")
        expected = function(values)
        one_by_one = np.array([scalar(*value.ravel().tolist()) for value in values])
        assert_allclose(one_by_one, expected, atol=16 * EPS, rtol=16 * EPS)
        single = function(values.astype(np.float32))
        assert single.dtype == function(values[:0].astype(np.float32)).dtype == np.float32
        assert_allclose(single, expected, atol=1e-4, rtol=1e-3)
    for none in ([0.0] * 4, [np.nan, 0.5, 0.5, 0.5], [1.0, 0.0, 0.0, np.nan]):
        found = functions.from_quaternion([none, *quaternion])
        assert np.isnan(found[0]).any()
        assert np.isfinite(found[1:]).all()
        assert np.isnan(functions.from_quaternion_scalar(*none)).any()
    matrix = np.where(np.eye(3)[::-1] > 0, np.nan, np.eye(3))
    assert np.isnan(functions.from_rotation_matrix(matrix)).any()


@pytest.mark.parametrize("text", ["quaternion", "unit_quaternion"])
@pytest.mark.parametrize("scalar_last", [False, True])
def test_the_scalar_comes_first_or_last_and_any_length_is_a_rotation(text, scalar_last):
    functions = (
        rs.derive(rotation_from(text, scalar_last=scalar_last)).kernels(conversions=True).load()
    )
    quaternion = ANY.as_quat(scalar_first=not scalar_last)
    for size in (1.0,) if text == "unit_quaternion" else (1e-300, 1.0, 1e300):
        found = functions.quaternion(size * quaternion)
        assert_allclose(found, quaternion, rtol=4 * EPS, atol=EPS)
    for name in ("quaternion", "from_quaternion"):
        assert_allclose(getattr(functions, name)(quaternion), quaternion, atol=4 * EPS)
        assert f"scalar {'last' if scalar_last else 'first'}" in getattr(functions, name).__doc__
    found = functions.from_rotation_matrix(ANY.as_matrix())
    assert_allclose(np.abs((found * quaternion).sum(axis=-1)), 1.0, atol=8 * EPS)


def test_half_turns_of_a_gibbs_vector_are_infinite():
    functions = module("gibbs_vector")
    found = functions.from_rotation_matrix(np.diag([1.0, -1.0, -1.0]))
    assert_array_equal(np.abs(found), [np.inf, 0.0, 0.0])
    found = functions.from_quaternion_scalar(0.0, 1.0, 1.0, 0.0)
    assert_array_equal(found, [np.inf, np.inf, 0.0])


@pytest.mark.parametrize("text", EULER)
def test_at_a_pole_the_last_angle_is_zero(text):
    poles = (0.0, np.pi) if text == "ZXZ" else (-np.pi / 2, np.pi / 2)
    exact = Rotation.from_euler(text, [[0.7, middle, -1.9] for middle in poles])
    rebuilt = Rotation.from_euler(text, module(text).from_quaternion(quaternions(exact)))
    assert (rebuilt * exact.inv()).magnitude().max() < 8 * EPS
    found = module(text).from_rotation_matrix(exact.as_matrix())
    assert_array_equal(found[:, 2], 0.0)
    assert_allclose(found[:, 1], poles, atol=4 * EPS)
    usual = quaternions(ANY[:20])
    sizes = np.outer((1e-310, 1e-160, 1e200, 1e308), usual[0])
    nearly_minus_pi = permutations((1.0, -1.0, 0.0, 1e-20))
    for odd in (*quaternions(exact), *sizes, *nearly_minus_pi):  # one row, no short cut for any
        found = module(text).from_quaternion([*usual, odd])
        assert_allclose(found[:-1], module(text).from_quaternion(usual), EPS, EPS)
        assert_allclose(found[-1], module(text).from_quaternion_scalar(*odd), EPS, EPS)


LONG = (
    "z(phi) x(pi/4)",  # the half of π/4 has a root of a root
    "z(a) x(alpha0) z(b) x(c) y(d)",  # too long to be written out
)
CHAINS = (  # whose turns are not read back in closed form
    "z(phi)",
    "y(theta) [1,1,1](psi)",
    "z(phi) x(pi/3) z(psi) y(2*delta)",
    "z(phi) x(theta) [0,b,c](psi)",  # with constants
    *LONG,
)


@pytest.mark.parametrize("text", [*ALL, "rpy", *CHAINS])
def test_every_conversion_is_proved_and_short_chains_have_a_quaternion(text):
    model = rotation_from(text)
    conversions = Conversions(model)
    assert conversions.proofs
    assert all(proof.is_exact for proof in conversions.proofs)
    assert (conversions.inverse is None) == (text in CHAINS)
    if text not in CHAINS:
        return
    functions = rs.derive(model, ["rotation_matrix"]).kernels(conversions=True).load()
    assert conversions.without in " ".join(functions.__doc__.split())
    assert not hasattr(functions, "from_quaternion")
    assert hasattr(functions, "quaternion") == (text not in LONG)
    if text in LONG:
        return
    q = np.random.default_rng(4).uniform(-3, 3, (30, len(model.coordinates)))
    numbers = [0.6, 0.8][: len(model.constants)]
    constants = [numbers] * bool(numbers)
    expected = Rotation.from_matrix(functions.rotation_matrix(q, *constants))
    found = functions.quaternion(q, *constants)
    assert_same_turn(found, quaternions(expected), atol=16 * EPS)
    assert_allclose(functions.quaternion_scalar(*q[0], *numbers), found[0], atol=16 * EPS)


# --- along a trajectory


def nearest(functions, q: np.ndarray) -> np.ndarray:
    """Sample by sample, of all sets of angles of a rotation the one nearest to that before."""

    def near(angles, before):
        return angles - 2 * np.pi * np.round((angles - before) / (2 * np.pi))

    path = [q[0]]
    for first, middle, third in q[1:]:
        before, sets = path[-1], []
        for middle_of_set in (-middle, np.pi - middle, middle):
            turned = 0.0 if middle_of_set == middle else np.pi
            angles = near(np.array([first + turned, middle_of_set, third + turned]), before)
            for sign in (1, -1):  # at a pole, which of first ± third is determined
                step = np.array([1.0, 0.0, -sign])
                short = (angles - before) @ [1.0, 0.0, sign]
                short -= 2 * np.pi * np.round(short / (2 * np.pi))
                along = np.array([before[0] + short / 2, angles[1], before[2] + sign * short / 2])
                same = functions.rotation_matrix(np.stack([angles, angles + step]))
                if np.abs(same[0] - same[1]).max() < 1e-12:
                    sets.append(along)
            sets.append(angles)
        matrices = functions.rotation_matrix(np.array(sets))
        truth = functions.rotation_matrix(np.array([first, middle, third]))
        sets = [s for s, R in zip(sets, matrices, strict=True) if np.abs(R - truth).max() < 1e-9]
        path.append(min(sets, key=lambda angles: ((angles - before) ** 2).sum()))
    return np.array(path)


@pytest.mark.parametrize("text", EULER)
def test_each_sample_gets_the_nearest_of_all_its_sets_of_angles(text):
    """Among samples anywhere, many are at one of the poles, alone or several together."""
    functions, source = module(text), np.random.default_rng(sum(map(ord, text)))
    q = source.uniform(-7, 7, (120, 3))
    pole = 0.0 if text == "ZXZ" else np.pi / 2
    for start in range(5, 120, 10):  # up to 4 samples at a pole: two poles in a row would be a tie
        q[start : start + source.integers(1, 5), 1] = pole + np.pi * source.integers(-2, 3)
    assert_allclose(functions.unwrap(q), nearest(functions, q), atol=1e-11)


def test_a_start_at_a_pole_takes_the_angles_of_the_first_sample_away_from_it():
    q = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [1.2, 0.01, -0.8]])
    expected = [[1.0, 0.0, -1.0], [1.15, 0.0, -0.85], [1.2, 0.01, -0.8]]
    assert_allclose(module("ZXZ").unwrap(q), expected, atol=1e-14)


AXIS = np.array([0.36, -0.48, 0.8])
PATHS = {  # coordinates of turns about one axis, from their angles
    "quaternion": lambda a: np.hstack([np.cos(a / 2), AXIS * np.sin(a / 2)]),
    "rotation_vector": lambda a: AXIS * a,
    "axis_angle": lambda a: np.hstack([AXIS + 0 * a, a]),
    "modified_rodrigues": lambda a: AXIS * np.tan(a / 4),
}


@pytest.mark.parametrize("text", PATHS)
def test_other_coordinates_go_on_through_whole_turns(text):
    """The sign of quaternions, the length of vectors, and the shadow set."""
    functions = module(text)
    angles = np.linspace(-2.0, 5.0, 1001) if text == "modified_rodrigues" else TIMES
    rotations = Rotation.from_rotvec(AXIS * angles[:, np.newaxis])
    wrapped = functions.from_rotation_matrix(rotations.as_matrix())
    assert np.abs(np.diff(wrapped, axis=0)).max() > 1  # somewhere it jumps
    expected = PATHS[text](angles[:, np.newaxis])
    sign = np.sign(wrapped[0] @ expected[0])
    assert_allclose(functions.unwrap(wrapped), sign * expected, atol=1e-12)


def test_other_axes_are_trajectories_and_lost_samples_harm_no_other():
    functions = module("ZXZ")
    paths = np.stack([np.stack([k * TIMES, 0.5 + 0 * TIMES, TIMES], axis=-1) for k in (1, -2)], 1)
    wrapped = functions.from_rotation_matrix(functions.rotation_matrix(paths))
    wrapped[[0, 1, 700], 1] = np.nan
    found = functions.unwrap(wrapped)
    lost = np.isnan(found).any(axis=-1)
    assert np.argwhere(lost).tolist() == [[0, 1], [1, 1], [700, 1]]
    assert_allclose(found[~lost], paths[~lost], atol=1e-12)


@pytest.mark.parametrize("text", ["ZXZ", "quaternion", "axis_angle", "rotation_vector"])
def test_unwrap_keeps_types_and_shapes_and_leaves_its_argument_alone(text):
    functions = module(text)
    single = functions.from_quaternion(np.ones((5, 4), np.float32))
    before = single.copy()
    assert functions.unwrap(single).dtype == np.float32
    assert functions.unwrap(single[:0]).shape == single[:0].shape
    assert functions.unwrap(single[:1].astype(int)).dtype == np.float64
    with pytest.raises(ValueError, match=r"q: got shape \(\d,\); expected \(m, \.\.\., n\)"):
        functions.unwrap(single[0])
    assert_array_equal(single, before)
