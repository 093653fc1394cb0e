"""Simulated motions against exact solutions, and what a simulation cannot begin with."""

from __future__ import annotations

from functools import cache

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.command import call
from helpers.motions import GYROSCOPE, motion_in
from helpers.witness import newton_euler
from rigidsym.errors import LimitReached, ModelError
from rigidsym.models.body import Parameter
from rigidsym.models.library import rotation_from
from rigidsym.simulation.free_body import free_motion
from rigidsym.simulation.problem import NEEDED

A, C = sp.symbols("A C")
TOP = {"A": 1.3, "C": 0.7, "m": 2.0, "g": 9.81, "l": 0.4}
REST = dict.fromkeys(("phi", "theta", "psi", "phi_dot", "theta_dot", "psi_dot"), 0.0)


@cache
def top() -> rs.Motion:
    body = rs.principal_moments(A, A, C)
    return rs.derive("ZXZ", NEEDED, body=body, potential="m*g*l*cos(theta)")


CONE = """
body = { shape = "cone", radius = "r", height = "h", mass = "m" }
dynamics = { potential = "-3/4*m*g*h*cos(theta)", fixed_point = [0, 0, "h"] }
"""
SIZES = {"r": 0.1, "h": 0.2, "m": 0.5, "g": 9.81}


@pytest.mark.parametrize(
    ("text", "values", "moments", "weight"),
    [
        # the cone on its apex, from tables: A = 3/20 m r² + 3/5 m h², C = 3/10 m r²
        (CONE, {}, (0.01275, 0.01275, 0.0015), -0.75 * 0.5 * 9.81 * 0.2),
        # the disc at 0.2 m on a rod: A = m (r²/4 + h²) + μ h²/3, C = m r²/2
        (GYROSCOPE, {"mu": 0.06}, (0.02205, 0.02205, 0.0025), 0.53 * 9.81 * 0.2),
    ],
    ids=["cone", "gyroscope"],
)
def test_a_described_body_turns_about_its_fixed_point(text, values, moments, weight):
    """Against Euler's equations about the pivot, with the torque of the weight."""
    start = {"theta": 0.6, "psi_dot": 60, "theta_dot": 1}
    found = motion_in(text, quantities=NEEDED).simulate(start, {**SIZES, **values}, 1.0)
    third, cosine, sine = np.array([0, 0, 1.0]), np.cos(0.6), np.sin(0.6)
    turned = [[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]]
    # the weight at the distance d: d e′ × Rᵀ (0, 0, −M g)
    omega, matrices = newton_euler(
        moments, lambda r: -weight * np.cross(third, r.T @ third), (1, 0, 60), found.t, turned
    )
    assert np.abs(found.angular_velocity_body - omega).max() < 1e-7
    assert np.abs(found.rotation_matrix - matrices).max() < 1e-7


# --- the free body

# NASA/TM-2015-218675, atmospheric case 2: a dragless tumbling brick, in slug ft² and °/s.
BRICK = {"I1": 0.001894220, "I2": 0.006211019, "I3": 0.007194665}
TUMBLING = np.radians((10, 20, 30))


@cache
def free_in_space() -> rs.Motion:
    body = rs.principal_moments(*sp.symbols("I1 I2 I3"))
    return rs.derive("quaternion", NEEDED, body=body, potential=0)


def turning(omega) -> dict:
    return {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": omega}


@pytest.mark.campaign
@pytest.mark.parametrize("method", ["exact", "DOP853"])
def test_the_tumbling_brick_ends_where_twenty_digits_say(method):
    """Against Taylor series of Euler's equations and of the quaternion."""
    moments = [mp.mpf(str(value)) for value in BRICK.values()]

    def slopes(_, y):
        w, x, y, z, *omega = y
        a, b, c = omega
        turned = (-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c)
        rates = [
            (moments[k - 2] - moments[k - 1]) * omega[k - 2] * omega[k - 1] / moments[k]
            for k in range(3)
        ]
        return [*(v / 2 for v in (*turned, w * c + x * b - y * a)), *rates]

    with mp.workdps(20):
        end = mp.odefun(slopes, 0, [1, 0, 0, 0, *map(mp.mpf, TUMBLING)])(20)
    options = {"method": method, "samples": 31, "rtol": 1e-13, "atol": 1e-15}
    found = free_in_space().simulate(turning(TUMBLING), BRICK, 20.0, **options)
    exact, digits = np.array(end, float), {"exact": 1e-12, "DOP853": 1e-10}[method]
    assert np.abs(found.angular_velocity_body[-1] - exact[4:]).max() < digits
    rotation = Rotation.from_quat(exact[[1, 2, 3, 0]]).as_matrix()
    assert np.abs(found.rotation_matrix[-1] - rotation).max() < digits


@pytest.mark.parametrize("moments", [(1, 2, 2.5), (2.5, 1, 2), (2, 2, 1)])
def test_elliptic_functions_agree_with_integration_about_every_axis(moments):
    t = np.linspace(0, 9, 10)
    for omega in ((0.3, -0.2, 1.1), (-1.2, 0.1, 0.2), (0.1, 1.5, -0.1), (0, 0, 1), (0, -1, 0)):
        exact, turned = newton_euler(moments, lambda _: 0, omega, t)
        found, rotation = free_motion(np.diag(moments), np.array(omega, float), np.eye(3), t)
        assert np.abs(rotation - turned).max() < 1e-9
        assert np.abs(found - exact).max() < 1e-9


def test_the_drift_of_a_momentum_that_begins_at_rounding_is_relative_to_the_whole():
    values, start = dict(zip(BRICK, (1.0, 1.5, 2.1), strict=True)), turning((0.02, 2.0, 1e-17))
    found = free_in_space().simulate(start, values, 20.0, method="exact", samples=101)
    assert found.drift["angular_momentum_3"] < 1e-13


def test_coordinates_that_are_no_rotation_are_refused():
    motion = rs.derive("unit_quaternion", NEEDED[0], body=rs.principal_moments(*sp.symbols("I1:4")))
    with pytest.raises(rs.RigidsymError, match=r"no rotation has the coordinates w = 1, x = 0.5"):
        motion.simulate(turning((1, 0, 0)) | {"x": 0.5}, BRICK, 1.0)


@pytest.mark.parametrize("choose", [min, max])
def test_steady_precession_goes_on_for_a_hundred_turns(choose):
    """A cos θ φ̇² − C ω₃ φ̇ + m g l = 0 keeps θ constant, with ω₃ = ψ̇ + φ̇ cos θ"""
    theta, spin = 0.6, 60.0
    a, c, weight = TOP["A"], TOP["C"], TOP["m"] * TOP["g"] * TOP["l"]
    rate = choose(np.roots([a * np.cos(theta), -c * spin, weight]).real)
    start = REST | {"theta": theta, "phi_dot": rate, "psi_dot": spin - rate * np.cos(theta)}
    found = top().simulate(start, TOP, 16.0, samples=21)
    assert found.q[-1, 0 if choose is max else 2] > 2 * np.pi * 98
    assert np.abs(found.q[:, 1] - theta).max() < 1e-6


def test_a_motion_that_starts_at_a_pole_is_that_of_the_quaternion():
    """The sleeping top: upright, and stable if C² ω₃² > 4 A m g l"""
    least = 2 * np.sqrt(TOP["A"] * TOP["m"] * TOP["g"] * TOP["l"]) / TOP["C"]
    for spin, is_stable in ((1.1 * least, True), (0.9 * least, False)):
        start = REST | {"psi_dot": spin, "theta_dot": 1e-4}
        found = top().simulate(start, TOP, 15.0, samples=301)
        assert "near a pole of the coordinates at t = 0 s" in found.report()
        upright = found.rotation_matrix[:, 2, 2].min()
        assert bool(upright > 0.99999) is is_stable
        assert found.drift["energy"] < 1e-9


def test_rotation_matrices_take_body_to_space_components_in_a_passive_convention_too():
    body, start = rs.principal_moments(1, 1, 2), {"theta": 0.5, "psi": 0.3}
    one, other = (
        rs.derive(rotation_from("ZXZ", passive=passive), NEEDED[0], body=body).simulate(
            start, {}, 1.0, samples=2
        )
        for passive in (False, True)
    )
    assert np.array_equal(one.rotation_matrix, other.rotation_matrix)


def test_a_sleeping_top_keeps_its_angular_velocity_and_its_integrals():
    """Where only φ + ψ is determined, the rates are the smallest with the angular velocity"""
    found = top().simulate(REST | {"psi_dot": 20.0}, TOP, 1.0, samples=11)
    assert found.angular_velocity_body == pytest.approx(np.tile([0, 0, 20.0], (11, 1)))
    assert found.q_dot[1:, [0, 2]] == pytest.approx(np.full((10, 2), 10.0))
    for values in found.first_integrals.values():
        assert values == pytest.approx(np.full(11, values[0]))


@pytest.mark.parametrize(
    ("initial", "values", "t_end", "message"),
    [
        (REST | {"angular_velocity_body_1": 1}, TOP, 1.0, "expected rates or angular_velocity_bo"),
        (REST | {"theta": 1}, {"A": 1}, 1.0, "missing parameters: C, g, l, m"),
        (REST | {"theta": 1, "chi": 1}, TOP, 1.0, "unknown initial values: chi"),
        ({"phi": 0, "theta": 0, "psi": 0, "angular_velocity_body": [1, 2, 3]}, TOP, 1.0, "cannot"),
        (REST | {"theta": 1}, TOP | {"C": 9.0}, 1.0, "principal moments"),
        (REST | {"theta": 1}, TOP, -1.0, "expected a positive number of seconds"),
        (REST | {"theta": float("nan")}, TOP, 1.0, "theta is nan; expected a finite number"),
        (REST | {"theta": 1, "theta_dot": 1e200}, TOP, 1.0, "give no finite rates at t = 0 s"),
    ],
)
def test_what_a_simulation_cannot_begin_with_is_said(initial, values, t_end, message):
    with pytest.raises(rs.RigidsymError, match=message):
        top().simulate(initial, values, t_end)


@pytest.mark.parametrize(("moment", "status"), [("0.49", 3), ("0.51", 0)])
def test_moments_about_the_tip_leave_a_body_about_the_centre_of_mass(moment, status, tmp_path):
    """A is at least m l² + C/2 = 0.5 kg m²"""
    words = ["simulate", "heavy_symmetric_top", "--set=C=0.5", "--set=m=1", "--set=l=0.5"]
    done = call(
        *words, f"--set=A={moment}", "--time=0.1", "--samples=2", cwd=tmp_path, status=status
    )
    refusal = "about its centre of mass at (0, 0, 0.5) m: no body has the principal moments 0.24"
    assert (refusal in done.stderr) == bool(status)


def test_a_potential_that_is_not_real_everywhere_is_no_weight():
    g = Parameter(symbol=sp.Symbol("g"), unit="m/s^2")
    body = rs.principal_moments(A, A, C, mass=sp.Symbol("m"), parameters=[g])
    motion = rs.derive("ZXZ", NEEDED, body=body, potential="m*g*l*sqrt(theta)")
    assert len(motion.simulate(REST | {"theta": 1}, TOP, 0.01, samples=2).t) == 2


def test_what_cannot_be_simulated_is_said():
    start = REST | {"theta": 1}
    for kind, options, message in (
        (rs.RigidsymError, {"method": "euler"}, "no method 'euler'; known: DOP853"),
        (rs.RigidsymError, {"method": "exact"}, "expected a free body"),
        (LimitReached, {"timeout": 0.2}, r"stopped after 0\.2 s"),
    ):
        with pytest.raises(kind, match=message):
            top().simulate(start | {"psi_dot": 1e4}, TOP, 1e4, **options)
    with pytest.raises(rs.RigidsymError, match="has no equations of motion"):
        rs.derive("ZXZ", ("angular_velocity_body",)).simulate({}, {}, 1.0)


def test_the_command_writes_a_table(tmp_path):
    own = ["--initial=theta=0.5", "--initial=psi_dot=20", "--set=C=0.6", "--time=1"]
    given = ["simulate", "heavy_symmetric_top", *own]
    done = call(*given, "--samples=50", "--out=top.csv", cwd=tmp_path)
    assert "momentum_psi  drift" in done.stdout
    table = np.genfromtxt(tmp_path / "top.csv", delimiter=",", names=True)
    assert (table["t"][-1], table["theta"][0], table["psi_dot"][0]) == (1, 0.5, 20)
    assert table["angular_velocity_body_3"][0] == pytest.approx(20)


def test_the_command_writes_a_page(tmp_path):
    turning = [f"--initial=angular_velocity_body_{k}={k}" for k in (1, 2)]
    moments = ["--set=A=1", "--set=B=2", "--set=C=2.5"]
    free = ["simulate", "free_body", "--method=exact", "--time=1", *moments, *turning]
    call(*free, "--animate=free.html", cwd=tmp_path)
    page = (tmp_path / "free.html").read_text(encoding="utf-8")
    for place, start in enumerate(("1", "2")):  # rad/s, which Euler's equations change
        assert f'{{"kind":"omega_body","place":{place},"start":{start}.' in page


@pytest.mark.parametrize(
    "rotation", [pytest.param("rotation_vector", marks=pytest.mark.campaign), "ZXZ"]
)
def test_a_heavy_body_is_carried_through_the_poles_of_its_coordinates(rotation):
    """V = k R₃₃, about the fixed point: N′ = −k e₃′ × Rᵀ e₃"""
    model = rs.derive(rotation, "rotation_matrix").model
    k, values, omega = sp.Symbol("k"), {"A": 1, "C": 0.6, "k": 3.9}, (0.5, -0.3, 9.0)
    acting = {"body": rs.principal_moments(A, A, C), "potential": k * model.matrix[2, 2]}
    motion = rs.derive(model, NEEDED, **acting)
    tilt = {"theta": 1e-7} if rotation == "ZXZ" else {}  # next to its pole
    initial = tilt | {f"angular_velocity_body_{n + 1}": w for n, w in enumerate(omega)}
    found = motion.simulate(initial, values, 4.0, samples=101)
    assert not found.ended
    third = np.array([0.0, 0.0, 1.0])
    exact = newton_euler((1, 1, 0.6), lambda r: -3.9 * np.cross(third, r.T @ third), omega, found.t)
    assert np.abs(found.angular_velocity_body - exact[0]).max() < 1e-5
    assert np.abs(found.rotation_matrix - exact[1]).max() < 1e-5
    assert found.drift["energy"] < 1e-8


def test_a_pole_at_which_a_force_has_no_limit_ends_the_motion_with_the_time_and_the_reason():
    """−k φ̇ damps the turn about the line of nodes with k/sin² θ; p_φ = L₃ and p_ψ = L₃′ decay by
    −k φ̇ and −k ψ̇
    """
    friction = {q: f"-k*{q}_dot" for q in ("phi", "theta", "psi")}
    acting = {"potential": "m*g*l*cos(theta)", "forces": friction}
    damped = rs.derive("ZXZ", NEEDED, body=rs.principal_moments(A, A, C), **acting)
    values = {"A": 1, "C": 0.6, "m": 1, "g": 9.81, "l": 0.4, "k": 0.1}
    found = damped.simulate({"theta": 0.5, "psi_dot": 20}, values, 3.0)

    def slopes(_, y):
        theta, rate, along, own = y
        c, s = np.cos(theta), np.sin(theta)
        phi = (along - own * c) / s**2
        psi = own / 0.6 - phi * c
        tilting = s * c * phi**2 - own * s * phi + 9.81 * 0.4 * s - 0.1 * rate
        return [rate, tilting, -0.1 * phi, -0.1 * psi]

    def upright(_, y):
        return y[0] - 1e-4

    upright.terminal = True
    start = [0.5, 0, 12 * np.cos(0.5), 12]
    end = solve_ivp(slopes, (0, 3), start, "Radau", events=upright, rtol=1e-9, atol=1e-11)
    time = float(end.t_events[0][0])
    assert f"a pole of the coordinates, at t = {time:.4g}" in found.ended
    assert "the torque of the forces on phi, theta, psi has no limit there" in found.ended
    assert found.t[-1] == pytest.approx(time, abs=0.0031)  # the last of samples 3 ms apart


@pytest.mark.parametrize(
    ("sequence", "theta", "torque", "goes_on"),
    [
        ("ZXZ", 0.0, "k/(2 + cos(theta))", True),  # a divisor that is not 0 at the pole
        ("ZXZ", 0.0, "k/(1 - cos(theta))", False),
        ("ZYX", np.pi / 2, "k*tan(theta)", False),
        ("ZYX", np.pi / 2, "k*sec(theta/2)", True),
    ],
)
def test_a_torque_stops_a_motion_at_a_pole_only_if_it_has_no_limit_there(
    sequence, theta, torque, goes_on
):
    body = rs.principal_moments(1, 1, 2)
    motion = rs.derive(sequence, NEEDED, body=body, torque=["0", "0", torque])
    start = {"theta": theta - 1e-2, "theta_dot": 1.0}
    found = motion.simulate(start, {"k": 1e-3}, 0.1, samples=11)
    assert ("has no limit there" not in found.ended) is goes_on


def test_one_body_on_four_turns_moves_by_eulers_equations_and_stops_where_their_axes_are_coplanar():
    body = rs.principal_moments(1, 2, 2)
    motion = rs.derive("z(a) x(b) z(c) x(d)", NEEDED, body=body, potential=0)
    spin = {"angular_velocity_body": (0.3, -0.2, 1.1)}
    found = motion.simulate({"c": 0.5} | spin, {}, 3.0, samples=4)
    start = found.rotation_matrix[0]
    omega, turned = newton_euler((1, 2, 2), lambda _: 0, spin["angular_velocity_body"], found.t)
    assert np.abs(found.angular_velocity_body - omega).max() < 1e-9
    assert np.abs(found.rotation_matrix - start @ turned).max() < 1e-9
    rates = motion.simulate({"c": 0.5, "a_dot": 1.0}, {}, 1.0, samples=2)
    assert not found.remarks
    assert f"smallest with the same angular velocity: a_dot = {rates.q_dot[0, 0]:.6g}, b" in str(
        rates
    )
    stopped = motion.simulate({"b": 1e-6} | spin, {}, 1.0)
    assert "at a pole of the coordinates" in stopped.ended
    with pytest.raises(ModelError, match="depend on more than the attitude"):
        rs.derive("z(a) x(b) z(c) x(d)", body=body, potential="k*a**2")


@pytest.mark.parametrize("inertia", [0, 1])
def test_a_gimbal_has_a_pole_only_if_its_frames_have_no_inertia(inertia):
    frame = {"rotation": "z(phi)", "principal_moments": [inertia] * 3}
    body, start = rs.principal_moments(1, 1, 2), {"theta": 1e-6, "psi_dot": 1.0}
    gimbal = rs.derive("z(phi) x(theta) z(psi)", ["energy"], body=body, parts=[frame])
    ended = gimbal.simulate(start, {}, 0.1, samples=2).ended
    assert ("pole of the coordinates" in ended) is not bool(inertia)


def test_large_angles_are_named_in_radians():
    report = top().simulate(REST | {"theta": 30.0}, TOP, 0.01, samples=2).report()
    assert "theta begins at 30 radians, which are 1718.87 degrees" in report


def test_two_links_are_solved_for_their_accelerations_in_numbers():
    """The double pendulum, with its textbook equations"""
    across, along = (f"l*({f}(a)*a_dot + {f}(a + b)*(a_dot + b_dot))" for f in ("cos", "sin"))
    velocities = (["0", "l*a_dot", "0"], ["0", across, along])
    links = rs.derive(
        "x(a) x(b)",
        NEEDED,
        body=rs.principal_moments(*sp.symbols("J J J")),
        potential="-m*g*l*(2*cos(a) + cos(a + b))",
        parts=[{"velocity": velocity, "mass": "m"} for velocity in velocities],
    )
    values = {"l": 0.4, "m": 1.5, "g": 9.81, "J": 0.01}
    found = links.simulate({"a": 1.0, "b": 0.5}, values, 5.0, samples=51)

    def slopes(_, y):  # with the angles to the vertical
        a, c, u, w = y
        mass = [[2, np.cos(a - c)], [np.cos(a - c), 1 + 0.01 / (1.5 * 0.16)]]
        left = [-np.sin(a - c) * w**2 - 2 * 9.81 / 0.4 * np.sin(a)]
        left += [np.sin(a - c) * u**2 - 9.81 / 0.4 * np.sin(c)]
        return [u, w, *np.linalg.solve(mass, left)]

    exact = solve_ivp(slopes, (0, 5), [1, 1.5, 0, 0], "DOP853", found.t, rtol=1e-12, atol=1e-13).y.T
    assert np.abs(found.q.sum(axis=1) - exact[:, 1]).max() < 1e-6
    assert found.drift["energy"] < 1e-8


def test_a_motion_without_end_is_written_as_far_as_it_goes(tmp_path):
    """dω/dt = ω²"""
    text = 'rotation.sequence = "z(phi)"\nbody.principal_moments = [1, 1, 1]\n'
    text += 'dynamics.forces = { phi = "phi_dot**2" }\n'
    (tmp_path / "blown.toml").write_text(text, encoding="utf-8")
    words = ("simulate", "blown.toml", "--initial=phi_dot=1", "--time=3")
    done = call(*words, "--samples=301", "--out=out.csv", cwd=tmp_path, status=1)
    said = "the integration stopped at t = 1 s: the accelerations change faster than"
    assert (done.stdout + done.stderr).count(said) == 1
    table = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    assert 95 < table.size < 102
    assert np.abs(table["phi"][:90] + np.log(1 - table["t"][:90])).max() < 1e-8
    refusal = call(*words, "--method=exact", cwd=tmp_path, status=2).stderr
    assert "blown: expected a free body on three turns, or" in refusal


def test_dry_friction_ends_the_motion_where_the_body_stops():
    """C dω/dt = −k sign ω: at rest its direction changes at once, and no step is short enough"""
    forces = {"phi": "-k*phi_dot/abs(phi_dot)"}
    dry = rs.derive("z(phi)", NEEDED, body=rs.principal_moments(A, A, C), forces=forces)
    found = dry.simulate({"phi_dot": 1}, {"A": 1, "C": 1, "k": 1}, 3.0, samples=31)
    assert "t = 1 s: the accelerations change faster than steps can follow" in found.ended
    assert found.q[:10, 0] == pytest.approx(found.t[:10] - found.t[:10] ** 2 / 2, abs=1e-8)
