"""The free body: exact solutions against mpmath at 50 digits, NASA's case."""

from __future__ import annotations

from functools import cache

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import rigidsym as rs
from rigidsym.simulation.free_body import free_motion

# NASA/TM-2015-218675, atmospheric case 2: a dragless tumbling brick, in slug ft² and °/s.
BRICK = {"I1": 0.001894220, "I2": 0.006211019, "I3": 0.007194665}
TUMBLING = (10, 20, 30)


@cache
def free() -> rs.Motion:
    body = rs.principal_moments(*sp.symbols("I1 I2 I3"))
    return rs.derive("quaternion", body=body, potential=0)


def start_of(omega) -> dict:
    return {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": omega}


def end_of_the_brick(t_end: int) -> tuple[list, list]:
    """Ω′ by Jacobi's functions and the quaternion by quadrature of the precession, in mpmath."""
    a, b, c = (mp.mpf(str(value)) for value in BRICK.values())
    first = [mp.radians(value) for value in TUMBLING]
    square = sum((m * w) ** 2 for m, w in zip((a, b, c), first, strict=True))
    twice = sum(m * w * w for m, w in zip((a, b, c), first, strict=True))
    m = (b - a) * (twice * c - square) / ((c - b) * (square - twice * a))
    rate = mp.sqrt((c - b) * (square - twice * a) / (a * b * c))
    sizes = [mp.sqrt((twice * c - square) / (k * (c - k))) for k in (a, b)]
    sizes.append(mp.sqrt((square - twice * a) / (c * (c - a))))
    phase = mp.ellipf(mp.atan2(first[1] / sizes[1], first[0] / sizes[0]), m)

    def omega(t):
        named = zip(sizes, ("cn", "sn", "dn"), strict=True)
        return [size * mp.ellipfun(name, phase + rate * t, m=m) for size, name in named]

    def precession(t):
        along = c * omega(t)[2]
        return mp.sqrt(square) * (twice - along**2 / c) / (square - along**2)

    def frame(w):
        z = [k * x / mp.sqrt(square) for k, x in zip((a, b, c), w, strict=True)]
        across = mp.hypot(z[0], z[1])
        y = [z[1] / across, -z[0] / across, 0]
        return mp.matrix([[y[1] * z[2], -y[0] * z[2], y[0] * z[1] - y[1] * z[0]], y, z])

    angle = mp.quad(precession, mp.linspace(0, t_end, 21))
    cos, sin = mp.cos(angle), mp.sin(angle)
    turn = mp.matrix([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    return omega(t_end), (frame(first).T * turn * frame(omega(t_end))).tolist()


@pytest.mark.campaign
@pytest.mark.parametrize("method", ["exact", "DOP853"])
def test_the_tumbling_brick_ends_where_fifty_digits_say(method):
    with mp.workdps(30):
        exact = [np.array(part, float) for part in end_of_the_brick(30)]
    start = start_of(np.radians(TUMBLING))
    found = free().simulate(start, BRICK, 30.0, method=method, samples=31, rtol=1e-13, atol=1e-15)
    digits = {"exact": 1e-12, "DOP853": 1e-10}[method]
    assert np.abs(found.angular_velocity_body[-1] - exact[0]).max() < digits
    assert np.abs(found.rotation_matrix[-1] - exact[1]).max() < digits


@pytest.mark.parametrize("moments", [(1, 2, 2.5), (2.5, 1, 2), (2, 2, 1)])
def test_elliptic_functions_agree_with_integration_about_every_axis(moments):
    tensor = np.diag(moments)

    def slopes(_, y):
        rotation, omega = y[:9].reshape(3, 3), y[9:]
        x, y, z = omega
        turning = rotation @ [[0, -z, y], [z, 0, -x], [-y, x, 0]]
        return [*turning.ravel(), *np.linalg.solve(tensor, -np.cross(omega, tensor @ omega))]

    t = np.linspace(0, 9, 10)
    for omega in ((0.3, -0.2, 1.1), (-1.2, 0.1, 0.2), (0.1, 1.5, -0.1), (0, 0, 1), (0, -1, 0)):
        start = [*np.eye(3).ravel(), *omega]
        y = solve_ivp(slopes, (0, 9), start, "DOP853", t, rtol=1e-12, atol=1e-13).y.T
        found, rotation = free_motion(tensor, np.array(omega, float), np.eye(3), t)
        assert np.abs(rotation.reshape(-1, 9) - y[:, :9]).max() < 1e-9
        assert np.abs(found - y[:, 9:]).max() < 1e-9


def test_the_drift_of_a_momentum_that_begins_at_rounding_is_relative_to_the_whole():
    values = dict(zip(BRICK, (1.0, 1.5, 2.1), strict=True))
    found = free().simulate(start_of((0.02, 2.0, 1e-17)), values, 20.0, method="exact", samples=101)
    assert found.drift["angular_momentum_3"] < 1e-13


def test_coordinates_that_are_no_rotation_are_refused():
    with pytest.raises(rs.RigidsymError, match=r"no rotation has the coordinates w = [12], x"):
        rs.derive("unit_quaternion", (), body=rs.principal_moments(*sp.symbols("I1:4"))).simulate(
            start_of((1, 0, 0)) | {"x": 0.5}, BRICK, 1.0
        )
