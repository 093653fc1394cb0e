"""Turns of every kind from a rotation: any number, any axes, constants and repetitions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.formula.reader import text_of
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.models.rotation_text import rotation_from

EPS = np.finfo(np.float64).eps
NUMBERS = {"a": 1 / 3, "b": 2 / 3, "c": 2 / 3, "alpha0": 0.7, "beta0": -0.4, "tau0": 0.7}
NUMBERS |= {"w": 0.48, "x": 0.64, "turn_1": 0.6}  # an axis whose parts are called like lines
LEAN = {"b": 0.6, "c": 0.8}


@dataclass(frozen=True)
class Case:
    """Turns, whether they reach every rotation, and how many coordinates are given."""

    text: str
    reaches_all: bool = False
    kept: int = 0

    def __str__(self) -> str:
        return self.text


CASES = (
    Case("z(phi)"),
    Case("[a,b,c](beta)"),
    Case("z(2*phi)"),
    Case("z(phi) x(theta)"),
    Case("z(phi) x(pi/4) z(psi)"),
    Case("x(alpha0) z(phi + beta0) x(pi/3) [1,2,2](w)"),
    Case("z(near) [a,b,c](w)"),  # names that the lines use themselves
    Case("z(phi) [w,x,turn_1](theta) z(psi)"),
    Case("z(phi + psi) x(theta)", kept=1),
    Case("z(phi) z(psi) x(theta)", kept=1),
    Case("z(phi) [0,0,-2](psi) x(theta)", kept=1),
    Case("z(phi) x(theta) z(phi)"),
    Case("z(phi) x(theta) z(-phi)"),
    Case("z(phi) [1,1,1](theta) z(phi)"),
    Case("z(phi) [1,1,1](theta) z(-phi)"),
    Case("z(phi) [a,b,c](theta) z(-phi)"),
    Case("z(phi) x(theta) [0,1,2](phi)"),
    Case("[1,2,2](phi) [1,0,1](theta) y(phi)"),
    Case("y(-phi) [a,b,c](theta) [1,2,2](phi)"),
    Case("z(phi) y(tau0) x(theta) y(-tau0) z(phi)"),  # two sets, as the ring knows
    Case("[1,1,0](phi) [1,0,0](theta) z(psi)"),
    Case("[1,0,1](phi) z(theta) [0,1,1](psi)"),
    Case("z(phi) [1,1,1](theta) z(psi)"),
    Case("davenport", reaches_all=True),
    Case("z(phi) x(theta) z(psi) y(pi/3)", reaches_all=True),
    Case("z(2*phi - psi) x(theta) z(psi)", reaches_all=True),
    Case("z(phi) x(theta) z(psi) y(delta)", reaches_all=True, kept=1),
    Case("z(a1) x(alpha0) z(b1) x(c1) y(d1)", reaches_all=True, kept=1),
    Case("z(a1) x(b1) z(c1) y(d1) x(e1) z(f1)", reaches_all=True, kept=3),
)
PARTIAL = tuple(case for case in CASES if not case.reaches_all)


@cache
def module(text: str, *, passive: bool = False) -> ModuleType:
    motion = rs.derive(rotation_from(text, passive=passive), ["rotation_matrix"])
    return motion.kernels(conversions=True).load()


@dataclass(frozen=True)
class Samples:
    """Coordinates, what stands beside them in calls, and the rotations they give."""

    q: np.ndarray
    constants: list[list[float]]
    kept: list[np.ndarray]
    matrix: np.ndarray
    quaternion: np.ndarray


def samples(case: Case, q: np.ndarray, *, passive: bool = False) -> Samples:
    model = rotation_from(case.text)
    names = [symbol.name for symbol in model.constants]
    values = LEAN if "a" not in names else {}
    constants = [[(NUMBERS | values)[name] for name in names]] if names else []
    rule = Conversions(model).inverse
    functions = module(case.text, passive=passive)
    assert len(rule.kept) == case.kept
    return Samples(
        q=q,
        constants=constants,
        kept=[q[:, list(rule.kept)]] if rule.kept else [],
        matrix=functions.rotation_matrix(q, *constants),
        quaternion=functions.quaternion(q, *constants),
    )


def anywhere(case: Case, count: int = 200) -> np.ndarray:
    width = len(rotation_from(case.text).coordinates)
    return np.random.default_rng(7).uniform(-3, 3, (count, width))


@pytest.mark.parametrize("passive", [False, True], ids=["active", "passive"])
@pytest.mark.parametrize("case", CASES, ids=str)
def test_round_trips(case, passive):
    functions, found = module(case.text, passive=passive), samples(case, anywhere(case))
    matrix = functions.rotation_matrix(found.q, *found.constants)
    beside = (*found.constants, *found.kept)
    lengths = np.linspace(-0.01, 50, len(found.q))[:, np.newaxis]
    for q in (
        functions.from_rotation_matrix(matrix, *beside),
        functions.from_quaternion(found.quaternion * lengths, *beside),
    ):
        rebuilt = functions.rotation_matrix(q, *found.constants)
        assert_allclose(rebuilt, matrix, atol=16 * EPS, rtol=0)
        assert ((q >= -4 * np.pi) & (q <= 4 * np.pi)).all()


@pytest.mark.parametrize("case", CASES, ids=str)
def test_scalar_twins_and_single_precision_agree(case):
    functions, found = module(case.text), samples(case, anywhere(case, 30))
    beside = (*found.constants, *found.kept)
    expected = functions.from_quaternion(found.quaternion, *beside)
    given = [np.broadcast_to(values, (30, np.shape(values)[-1])) for values in beside]
    rows = np.concatenate([found.quaternion, *given], axis=-1)
    one_by_one = np.array([functions.from_quaternion_scalar(*row) for row in rows.tolist()])
    assert_allclose(
        functions.rotation_matrix(one_by_one, *found.constants), found.matrix, atol=16 * EPS
    )
    assert_allclose(one_by_one, expected, atol=1e-10)
    narrow = [np.asarray(values, np.float32) for values in (found.quaternion, *beside)]
    single = functions.from_quaternion(*narrow)
    assert single.dtype == np.float32
    rebuilt = functions.rotation_matrix(single.astype(float), *found.constants)
    assert_allclose(rebuilt, found.matrix, atol=3e-6)


MIDDLES = [
    s * (at + d) for at in (0, np.pi) for d in (0, 1e-17, 1e-12, 1e-9, 3e-8, 1e-5) for s in (1, -1)
]
ONE_ANGLE = [
    *((f"z(phi) x(theta) [1,0,{n}](-phi)", []) for n in (10, 1000, 10**5, 10**7)),
    *((f"z(phi) x(theta) [1,1,-{n}](phi)", []) for n in (10, 1000, 10**5, 10**7)),
    *((f"z(phi) [{n},0,1](theta) z(-phi)", []) for n in (10, 1000, 10**5, 10**7)),
    ("[2,-3,3](phi) [-3,-3,-1](theta) [-3,4,-2](phi)", []),
    *(("z(phi) [a,b,c](theta) z(-phi)", axis) for axis in ([1, 0, 0], [0.6, 0.8, 0])),
    ("z(phi) y(tau0) x(theta) y(-tau0) z(-phi)", [0.0]),  # two sets for this tau alone
    ("z(phi) x(theta) [b,0,c](phi)", [0.0, -1.0]),
    ("z(phi) x(theta) [b,0,c](-phi)", [0.0, 1.0]),
]


@pytest.mark.parametrize(("text", "constants"), ONE_ANGLE, ids=str)
def test_one_outer_angle_where_the_two_sets_nearly_meet(text, constants):
    """No turn, half turns, and what is beside them: where the triangle or the half tells little."""
    functions = module(text)
    rng = np.random.default_rng(4)
    near = np.array([[a, b] for a in (0.0, 0.5, -2.5, np.pi) for b in MIDDLES])
    q = np.concatenate([near, rng.uniform(-3, 3, (500, 2))])
    for dtype in (np.float64, np.float32):
        eps = np.finfo(dtype).eps
        beside = [np.asarray(constants, dtype)] if constants else []
        exact = [values.astype(float) for values in beside]
        matrix = functions.rotation_matrix(q.astype(dtype), *beside)
        quaternion = functions.quaternion(q.astype(dtype), *beside)
        for found in (
            functions.from_rotation_matrix(matrix, *beside),
            functions.from_quaternion(quaternion, *beside),
        ):
            rebuilt = functions.rotation_matrix(found.astype(float), *exact)
            assert_allclose(rebuilt, matrix, atol=24 * eps, rtol=0)
    exact = [constants] if constants else []
    rows = np.asarray(functions.quaternion(q, *exact)).tolist()
    one_by_one = [functions.from_quaternion_scalar(*row, *constants) for row in rows]
    rebuilt = functions.rotation_matrix(one_by_one, *exact)
    assert_allclose(rebuilt, functions.rotation_matrix(q, *exact), atol=24 * EPS, rtol=0)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("z(phi) x(pi) z(theta) x(psi)", "about one axis, once those between are taken off"),
        ("z(phi) z(-phi)", "its turns undo one another"),
        ("z(phi) [0,0,-1](phi)", "its turns undo one another"),
    ],
)
def test_turns_that_determine_too_little_are_refused(text, why):
    motion = rs.derive(rotation_from(text), ["rotation_matrix"])
    assert why in motion.conversions.without
    assert not hasattr(motion.kernels(conversions=True).load(), "from_quaternion")


@pytest.mark.parametrize("apart", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("sign", [1, -1], ids=["alike", "opposite"])
@pytest.mark.parametrize("has_constants", [False, True], ids=["numbers", "constants"])
def test_two_axes_nearly_alike_or_opposite(apart, sign, has_constants):
    """Each angle is badly determined; the rotation that both give is not."""
    axis = "b,0,c" if has_constants else f"1/{1 / apart:.0f},0,{sign}"
    functions = module(f"z(phi) [{axis}](theta)")
    constants = [[apart, sign * np.sqrt(1 - apart**2)]] if has_constants else []
    q = np.random.default_rng(5).uniform(-3, 3, (200, 2))
    matrix = functions.rotation_matrix(q, *constants)
    for given, name in (
        (matrix, "from_rotation_matrix"),
        (functions.quaternion(q, *constants), "from_quaternion"),
    ):
        found = getattr(functions, name)(given, *constants)
        rebuilt = functions.rotation_matrix(found, *constants)
        assert_allclose(rebuilt, matrix, atol=16 * EPS, rtol=0)


def beyond(text: str, rotation: Rotation) -> float:
    """How far a rotation is, in radians, from the nearest that three turns with numbers reach."""
    first, middle, last = (np.array(turn.direction, float) for turn in rotation_from(text).turns)
    before, after = np.arccos(first @ middle), np.arccos(middle @ last)
    side = np.arccos(np.clip(first @ rotation.apply(last), -1, 1))
    together = before + after
    return max(abs(before - after) - side, side - min(together, 2 * np.pi - together))


@pytest.mark.parametrize(
    "text",
    [
        "[1,1,0](phi) [1,0,0](theta) z(psi)",
        "[1,0,1](phi) z(theta) [0,1,1](psi)",
        "z(phi) [1,1,1](theta) z(psi)",
    ],
)
def test_a_rotation_out_of_reach_is_nan_and_only_that(text):
    functions, rotations = module(text), Rotation.random(400, rng=np.random.default_rng(3))
    distance = np.array([beyond(text, rotation) for rotation in rotations])
    is_lost = distance > 0
    assert 20 < is_lost.sum() < 380
    for q in (
        functions.from_rotation_matrix(rotations.as_matrix()),
        functions.from_quaternion(rotations.as_quat(scalar_first=True)),
    ):
        assert_array_equal(np.isnan(q).all(axis=-1), is_lost)
        assert_array_equal(np.isnan(q).any(axis=-1), is_lost)
        rebuilt = functions.rotation_matrix(q[~is_lost])
        assert_allclose(rebuilt, rotations.as_matrix()[~is_lost], atol=16 * EPS)


@pytest.mark.parametrize("case", PARTIAL, ids=str)
def test_what_is_reached_to_rounding_is_reached_and_what_is_not_is_nan(case):
    """A rotation turned away by less than √eps comes back, by more than that it does not."""
    functions, found = module(case.text), samples(case, anywhere(case))
    beside = (*found.constants, *found.kept)
    rng = np.random.default_rng(8)
    for size, is_reached in ((1e-9, True), (0.3, False)):
        away = Rotation.from_rotvec(size * Rotation.random(200, rng=rng).as_matrix()[:, 0])
        moved = (away * Rotation.from_matrix(found.matrix)).as_matrix()
        q = functions.from_rotation_matrix(moved, *beside)
        rebuilt = functions.rotation_matrix(q, *found.constants)
        if is_reached:
            assert_allclose(rebuilt, moved, atol=8 * size)
        else:
            is_lost = np.isnan(q).any(axis=-1)
            assert is_lost.sum() >= 5
            assert_allclose(rebuilt[~is_lost], moved[~is_lost], atol=1e-7)


@pytest.mark.parametrize("away", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_at_and_near_the_poles_of_davenports_angles(away):
    """The poles are where the third axis lies along the first, or against it."""
    functions, lean = module("davenport"), [0.6, 0.8]
    pole = np.arctan2(0.6, 0.8)
    for middle in (pole - away, pole + away, pole - np.pi + away):
        matrix = functions.rotation_matrix([0.7, middle, -1.9], lean)
        q = functions.from_rotation_matrix(matrix, lean)
        assert_allclose(functions.rotation_matrix(q, lean), matrix, atol=16 * EPS)
        assert (q[2] == 0) == (away == 0)
        assert pole - np.pi - EPS <= q[1] <= pole + EPS


@pytest.mark.parametrize("away", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_where_the_triangle_of_the_axes_is_flat(away):
    """The edge of what is reached: the angles are true to √eps, the rotation to a few eps."""
    text = "[1,1,0](phi) [1,0,0](theta) z(psi)"
    functions = module(text)
    for flat in (np.pi / 2, -np.pi / 2):
        matrix = functions.rotation_matrix([0.7, flat + away, -1.9])
        q = functions.from_rotation_matrix(matrix)
        assert_allclose(functions.rotation_matrix(q), matrix, atol=32 * EPS)


@pytest.mark.parametrize("passive", [False, True], ids=["active", "passive"])
def test_davenports_angles_are_scipys(passive):
    rotations = Rotation.random(100, rng=np.random.default_rng(11))
    axes = [[0, 0, 1], [1, 0, 0], [0, 0.6, 0.8]]
    expected = rotations.as_davenport(axes, "intrinsic")
    matrix = (rotations.inv() if passive else rotations).as_matrix()
    found = module("davenport", passive=passive).from_rotation_matrix(matrix, [0.6, 0.8])
    rebuilt = Rotation.from_davenport(axes, "intrinsic", found)
    assert (rebuilt * rotations.inv()).magnitude().max() < 16 * EPS
    same = np.abs(found[:, 1] - expected[:, 1]) < 1e-6  # SciPy may count from the other end
    assert same.any()
    assert_allclose(found[same], expected[same], atol=1e-12)


def test_signatures_are_those_of_generalised_ufuncs():
    functions = module("z(a1) x(alpha0) z(b1) x(c1) y(d1)")
    assert functions.from_quaternion.signature == "(4),(1),(1)->(4)"
    assert functions.from_rotation_matrix.signature == "(3,3),(1),(1)->(4)"
    assert functions.quaternion.signature == "(4),(1)->(4)"
    assert module("davenport").from_quaternion.signature == "(4),(2)->(3)"


def test_what_is_not_determined_is_kept_at_what_is_given_and_at_zero():
    functions = module("z(phi) x(theta) z(psi) y(delta)")
    rotations = Rotation.random(50, rng=np.random.default_rng(2))
    delta = np.linspace(-2, 2, 50)[:, np.newaxis]
    for kept in (delta, [0.4], None):
        q = functions.from_rotation_matrix(rotations.as_matrix(), kept)
        assert_array_equal(q[:, 3:], np.broadcast_to(0.0 if kept is None else kept, (50, 1)))
        assert_allclose(functions.rotation_matrix(q), rotations.as_matrix(), atol=16 * EPS)
    alone = functions.from_quaternion_scalar(1.0, 0.0, 0.0, 0.0)
    assert alone[3] == 0.0
    with pytest.raises(ValueError, match=r"kept: got shape \(2,\); expected \(\.\.\., 1\)"):
        functions.from_rotation_matrix(np.eye(3), [0.0, 0.0])


@pytest.mark.parametrize("case", CASES, ids=str)
def test_zero_quaternions_and_nan_give_nan(case):
    functions, found = module(case.text), samples(case, anywhere(case, 1))
    for quaternion in ([0.0] * 4, [np.nan, 0.5, 0.5, 0.5]):
        values = functions.from_quaternion(quaternion, *found.constants)
        assert np.isnan(values).sum() == len(values) - case.kept


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_claim_is_proved_and_said(case):
    found = Conversions(rotation_from(case.text))
    assert all(proof.is_exact for proof in found.proofs)
    branch = text_of(found.inverse.branch)
    assert ("may not reach every rotation" in branch) is not case.reaches_all
    assert ("to the given values" in branch) is bool(case.kept)
    claims = [proof.claim.text for proof in found.proofs]
    assert "p₊ = e^(e₁ σ) m₊" in claims
    rule = found.inverse
    assert any(claim.startswith("R = ") for claim in claims) is bool(rule.before + rule.right)


TIMES = np.linspace(0.01, 12.0, 1201)
PATH = np.stack(
    [
        *(3 * TIMES, 4 * np.sin(2 * TIMES) + 0.1, 1 - 2 * TIMES),
        *(np.sin(TIMES), 0.5 * TIMES, np.cos(TIMES)),
    ],
    axis=-1,
)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_unwrap_follows_a_path_through_folds_poles_and_whole_turns(case):
    functions = module(case.text)
    path = PATH[:, : len(rotation_from(case.text).coordinates)]
    found = samples(case, path)
    given = functions.from_rotation_matrix(found.matrix, *found.constants, *found.kept)
    followed = functions.unwrap(given, *found.constants)
    assert np.abs(np.diff(given, axis=0)).max() > 1
    assert np.abs(np.diff(followed, axis=0)).max() < 0.15
    assert_array_equal(followed[0], given[0])
    rebuilt = functions.rotation_matrix(followed, *found.constants)
    assert_allclose(rebuilt, found.matrix, atol=64 * EPS)


@pytest.mark.parametrize("text", ["davenport", "z(phi) x(theta) z(psi) y(pi/3)"])
def test_a_rest_at_the_pole_does_not_jump(text):
    case = next(case for case in CASES if case.text == text)
    pole = np.arctan2(0.6, 0.8) if text == "davenport" else 0.0
    middle = pole + np.array([-0.02, -0.01, 0.0, 0.0, 0.0, 0.01, 0.02])
    path = np.stack([np.full(7, 0.4), middle, np.full(7, -1.1)], axis=-1)
    found, functions = samples(case, path), module(text)
    given = functions.from_rotation_matrix(found.matrix, *found.constants)
    followed = functions.unwrap(given, *found.constants)
    assert np.abs(np.diff(followed, axis=0)).max() < 0.0101
    rebuilt = functions.rotation_matrix(followed, *found.constants)
    assert_allclose(rebuilt, found.matrix, atol=64 * EPS)


def test_unwrap_passes_over_lost_samples_and_takes_other_axes():
    functions = module("davenport")
    paths = np.stack([PATH[:, :3], -PATH[:, :3]], axis=1)
    given = functions.from_rotation_matrix(functions.rotation_matrix(paths, [0.6, 0.8]), [0.6, 0.8])
    followed = functions.unwrap(given, [0.6, 0.8])
    assert np.abs(np.diff(followed, axis=0)).max() < 0.15
    for k in range(2):
        assert_array_equal(followed[:, k], functions.unwrap(given[:, k], [0.6, 0.8]))
    given[[0, 400]] = np.nan
    lost = functions.unwrap(given, [0.6, 0.8])
    assert_array_equal(np.isnan(lost).all(axis=(1, 2)).nonzero()[0], [0, 400])
    assert functions.unwrap(given.astype(np.float32), [0.6, 0.8]).dtype == np.float32
