"""Kernels of derivatives: against finite differences at 50 digits, JAX, and the chain rule."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

import rigidsym as rs
from helpers.motions import derived
from helpers.node import load
from helpers.target_modules import OTHERS, row_by_row
from helpers.witness import evaluate, mp
from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of
from rigidsym.errors import KernelError


@cache
def motion(name: str) -> rs.Motion:
    return derived(name) if name in rs.EULER_SEQUENCES else rs.derive(name)


@cache
def of(name: str, quantity: str, vector: str):
    """The functions of the derivatives of one quantity."""
    return motion(name).kernels(derivatives=[f"{quantity} by {vector}"]).load()


def arrays_for(name: str, quantity: str, leading: tuple[int, ...] = (), size: float = 1.0):
    rng = np.random.default_rng(4)
    found = {}
    for vector in motion(name).step(quantity).quantity.inputs:
        shape = (*leading, len(motion(name).argument(vector).symbols))
        found[vector] = rng.uniform(-1.0, 1.0, shape) * (size if vector == "q" else 1.0)
    if "parameters" in found:
        found["parameters"] = np.broadcast_to([2 / 3, 1 / 3, 2 / 3], found["parameters"].shape)
    return found


def numerical(motion, quantity: str, vector: str, point: dict) -> np.ndarray:
    """The Jacobian of the derivation's expression, by differences at 50 digits."""
    symbols = {v: motion.argument(v).symbols for v in point}
    expression = motion.step(quantity).expression

    def at(step, place):
        known = {}
        for v, values in point.items():
            numbers = [mp.mpf(float(x)) for x in values]
            if v == vector:
                numbers[place] += step
            known.update(zip(symbols[v], numbers, strict=True))
        return list(evaluate(expression, known))

    step = mp.mpf(10) ** -18
    columns = []
    for place in range(len(point[vector])):
        above, below = at(step, place), at(-step, place)
        columns.append([(a - b) / (2 * step) for a, b in zip(above, below, strict=True)])
    return np.array(columns, float).T


SWITCHES = [float(series_of(k).switch) ** 0.5 for k in range(FIRST_SERIES, FIRST_SERIES + 3)]
SIZES = (1e-9, *(switch * side for switch in SWITCHES for side in (1 - 1e-9, 1 + 1e-9)))
CASES = [  # sizes of q where series stand in for quotients that cancel, or as it comes
    *(("ZXZ", name, "q", ()) for name in ("angular_velocity_body", "rotation_matrix")),
    ("ZXZ", "rates_from_angular_velocity_space", "q", ()),
    ("zyx", "angular_acceleration_space", "q_dot", ()),
    ("quaternion", "angular_velocity_body", "q", ()),
    ("modified_rodrigues", "angular_velocity_body", "q_dot", ()),
    ("z(phi) [a,b,c](beta)", "angular_velocity_space", "parameters", ()),
    ("rotation_vector", "rotation_matrix", "q", SIZES),
    pytest.param(
        *("rotation_vector", "inverse_rate_matrix_body", "q", SIZES), marks=pytest.mark.campaign
    ),
]


@pytest.mark.parametrize(("name", "quantity", "vector", "sizes"), CASES)
def test_jacobians_are_those_of_differences_at_50_digits(name, quantity, vector, sizes):
    functions, point = of(name, quantity, vector), arrays_for(name, quantity)
    jacobian, twin = (
        getattr(functions, f"{quantity}_jacobian_{vector}{end}") for end in ("", "_scalar")
    )
    for size in sizes or (np.linalg.norm(point["q"]),):
        point["q"] *= size / np.linalg.norm(point["q"])
        found, slopes = jacobian(*point.values()), numerical(motion(name), quantity, vector, point)
        assert found.shape == (*motion(name).step(quantity).shape, len(point[vector]))
        assert_allclose(found.reshape(slopes.shape), slopes, rtol=1e-12, atol=2e-14)
    assert_allclose(twin(*np.concatenate([*point.values()]).tolist()), found, atol=1e-13)


@pytest.mark.parametrize("size", [0.0, 1e-200])
def test_removable_singularities_stay_removable(size):
    """To first order in a rotation vector v, Ω′ is v̇ − v × v̇/2."""
    point = arrays_for("rotation_vector", "angular_velocity_body", size=size)
    functions = of("rotation_vector", "angular_velocity_body", "q")
    jacobian = functions.angular_velocity_body_jacobian_q(*point.values())
    x, y, z = point["q_dot"] / 2
    assert_allclose(jacobian, [[0, -z, y], [z, 0, -x], [-y, x, 0]], atol=1e-15)


@pytest.mark.parametrize("target", OTHERS)
def test_every_target_gives_the_derivative_with_three_axes_too(target):
    asked = {"angular_velocity_body": "q_dot", "rotation_matrix": "q"}
    alone = motion("ZXZ").select([*asked])
    functions, plain = (load(alone.kernels(t, derivatives=asked)) for t in (target, "numpy"))
    q, q_dot = arrays_for("ZXZ", "angular_velocity_body", (70,)).values()
    name = "angular_velocity_body_jacobian_q_dot"
    expected = row_by_row("numpy", getattr(plain, name))(q, q_dot)
    found = row_by_row(target, getattr(functions, name))(q, q_dot)
    assert_allclose(found, expected, rtol=0, atol=4e-14)
    expected, cube = plain.rotation_matrix_jacobian_q(q), functions.rotation_matrix_jacobian_q
    one = np.asarray(cube(q[0]))
    assert one.shape == (3, 3, 3)
    assert_allclose(one, expected[0], rtol=0, atol=1e-6)  # JAX: float32
    if target in ("c", "numba"):
        out = np.empty((3, 70, 3, 3)).transpose(1, 2, 3, 0)
        assert cube(q, out=out) is out
        assert_allclose(out, expected, rtol=0, atol=4e-14)
    assert plain.rotation_matrix_jacobian_q.signature == "(3)->(3,3,3)"


def test_what_has_no_derivative_is_refused():
    with pytest.raises(KernelError, match=r"rotation_matrix by q_dot: .* depends only on q$"):
        motion("ZXZ").kernels(derivatives=["rotation_matrix by q_dot"])


def test_a_header_says_what_a_jacobian_is():
    made = motion("ZXZ").kernels("c", derivatives=["angular_velocity_body by q"])
    header = next(text for name, text in made.files.items() if name.endswith(".h"))
    assert "Jacobian with respect to q of angular velocity, body components" in header
    assert "out[9]  3 by 3, row by row, in rad/s" in header


def test_a_scalar_has_a_gradient():
    A, B, C = sp.symbols("A B C", positive=True)
    body = rs.principal_moments(A, B, C)
    alone = rs.derive("ZXZ", ["rotational_energy"], body=body)
    functions = alone.kernels(derivatives=["rotational_energy by q_dot"]).load()
    q, rates, moments = np.array([[0.3, 0.4, 0.5], [0.1, -0.2, 0.3], [1.0, 2.0, 2.5]])
    moments = np.resize(moments, len(alone.argument("parameters").names))
    energy = functions.rotational_energy(q, rates, moments)
    gradient = functions.rotational_energy_jacobian_q_dot(q, rates, moments)
    assert gradient.shape == (3,)
    assert_allclose(gradient @ rates, 2 * energy, rtol=1e-13)  # Euler: of the second degree
