"""Simulated motions against exact solutions, and what a simulation cannot begin with."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from rigidsym.pipeline import motion_of, read
from rigidsym.simulation import animation

A, B, C = sp.symbols("A B C")
TOP = {"A": 1.3, "C": 0.7, "m": 2.0, "g": 9.81, "l": 0.4}
REST = dict.fromkeys(("phi", "theta", "psi", "phi_dot", "theta_dot", "psi_dot"), 0.0)


@cache
def top() -> rs.Motion:
    model = rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi"))
    body = rs.principal_moments(A, A, C)
    return rs.derive(model, body=body, potential="m*g*l*cos(theta)")


@cache
def free(symmetric: bool = True) -> rs.Motion:
    model = rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi"))
    return rs.derive(model, body=rs.principal_moments(A, A if symmetric else B, C), potential=0)


def test_the_top_that_rises_to_the_vertical_in_infinite_time():
    """1/cos θ = 1 + 1/cosh γt for θ₀ = π/3, φ̇₀ = 2γ/√3, ψ̇₀ = (3A − C)γ/(C√3), γ² = mgl/A"""
    values = TOP
    gamma = np.sqrt(values["m"] * values["g"] * values["l"] / values["A"])
    start = REST | {
        "theta": np.pi / 3,
        "phi_dot": 2 * gamma / np.sqrt(3),
        "psi_dot": (3 * values["A"] - values["C"]) * gamma / (values["C"] * np.sqrt(3)),
    }
    found = top().simulate(start, values, 3.0, samples=301)
    exact = np.arccos(1 / (1 + 1 / np.cosh(gamma * found.t)))
    assert np.abs(found.q[:, 1] - exact).max() < 1e-8
    assert max(found.drift.values()) < 1e-10


@pytest.mark.parametrize(("choose", "t_end"), [(min, 105.0), (max, 162.0)])
def test_steady_precession_goes_on_for_a_thousand_turns(choose, t_end):
    """A cos θ φ̇² − C ω₃ φ̇ + m g l = 0 keeps θ constant, with ω₃ = ψ̇ + φ̇ cos θ; the slow one for
    a thousand turns of the spin, the fast one for a thousand of its own
    """
    theta, spin = 0.6, 60.0
    a, c, weight = TOP["A"], TOP["C"], TOP["m"] * TOP["g"] * TOP["l"]
    rate = choose(np.roots([a * np.cos(theta), -c * spin, weight]).real)
    start = REST | {
        "theta": theta,
        "phi_dot": rate,
        "psi_dot": spin - rate * np.cos(theta),
    }
    found = top().simulate(start, TOP, t_end, samples=201)
    assert found.q[-1, 0 if choose is max else 2] > 2 * np.pi * 990
    assert np.abs(found.q[:, 1] - theta).max() < 1e-6


def test_the_angular_velocity_of_a_free_symmetric_body_turns_at_a_constant_rate():
    """Ω′₁ + iΩ′₂ turns at (C − A)/A Ω′₃ about the axis of symmetry"""
    values = {"A": 2.0, "C": 1.2}
    start = REST | {"theta": 0.9, "phi_dot": 1.1, "psi_dot": 0.7}
    found = free().simulate(start, values, 12.0)
    omega = found.angular_velocity_body
    rate = (values["C"] - values["A"]) / values["A"] * omega[0, 2]
    exact = (omega[0, 0] + 1j * omega[0, 1]) * np.exp(1j * rate * found.t)
    assert np.abs(omega[:, 0] + 1j * omega[:, 1] - exact).max() < 1e-8
    assert np.abs(omega[:, 2] - omega[0, 2]).max() < 1e-9


def test_a_torque_that_grows_with_the_time_turns_as_its_cube():
    """V = −k t φ gives C φ̈ = k t"""
    driven = rs.derive("z(phi)", body=rs.principal_moments(A, B, C), potential="-k*t*phi")
    found = driven.simulate({"phi": 0, "phi_dot": 0}, {"A": 1, "B": 1, "C": 1.5, "k": 2.0}, 3.0)
    assert np.abs(found.q[:, 0] - 2.0 * found.t**3 / 9).max() < 1e-10
    assert not found.first_integrals


def test_rotation_about_the_intermediate_axis_grows_at_the_known_rate():
    """Small deviations grow as exp(σt), σ² = Ω² (B − A)(C − B)/(A C) about the axis of B"""
    values = {"A": 1.0, "B": 1.5, "C": 2.1}
    spin, small = 2.0, 1e-6
    a, b, c = values.values()
    rate = spin * np.sqrt((b - a) * (c - b) / (a * c))
    # about the second axis: θ = π/2, ψ = 0 gives Ω′ = (θ̇, φ̇, ψ̇); along the growing direction
    start = REST | {"theta": np.pi / 2, "phi_dot": spin, "psi_dot": small}
    start |= {"theta_dot": (b - c) * spin / (a * rate) * small}
    found = free(symmetric=False).simulate(start, values, 6.0)
    size = np.linalg.norm(found.angular_velocity_body[:, [0, 2]], axis=1)
    small_still = size < 1e-2
    slope = np.polyfit(found.t[small_still], np.log(size[small_still]), 1)[0]
    assert slope == pytest.approx(rate, rel=1e-3)


def test_a_motion_straight_through_the_pole_goes_on_with_its_integrals_kept():
    start = REST | {"theta": 1.0, "theta_dot": -1.0}
    found = free().simulate(start, {"A": 1.0, "C": 0.5}, 3.0)
    assert not found.ended
    assert found.q[-1, 1] == pytest.approx(-2.0, abs=1e-9)
    assert max(found.drift.values()) < 1e-9


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


@pytest.mark.parametrize("method", ["DOP853", "lie"])
def test_a_sleeping_top_keeps_its_angular_velocity_and_its_integrals(method):
    """Where only φ + ψ is determined, the rates are the smallest with the angular velocity"""
    found = top().simulate(REST | {"psi_dot": 20.0}, TOP, 1.0, samples=11, method=method)
    assert found.angular_velocity_body == pytest.approx(np.tile([0, 0, 20.0], (11, 1)))
    assert found.q_dot[1:, [0, 2]] == pytest.approx(np.full((10, 2), 10.0))
    for values in found.first_integrals.values():
        assert values == pytest.approx(np.full(11, values[0]))


def test_a_trajectory_through_a_pole_agrees_with_one_in_quaternions():
    """From the pole back in time, and from there on through it: the motion is reversible"""
    values = {"A": 1.0, "B": 1.3, "C": 0.5, "m": 1.0, "g": 9.81, "a": 0.1, "b": 0.05, "l": 0.2}
    body = rs.principal_moments(A, B, C)
    height = "m*g*(2*a*(x*z - w*y) + 2*b*(y*z + w*x) + l*(1 - 2*x**2 - 2*y**2))"
    quaternions = rs.derive("unit_quaternion", ["state_derivative"], body=body, potential=height)
    upright = {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": (-1.0, -0.3, -2.0)}
    back = quaternions.simulate(upright, values, 1.0, samples=2)
    first = dict(zip("wxyz", back.q[-1], strict=True))
    first["angular_velocity_body"] = -back.angular_velocity_body[-1]
    same = quaternions.simulate(first, values, 3.0)

    model = rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi"))
    potential = "m*g*(a*sin(theta)*sin(psi) + b*sin(theta)*cos(psi) + l*cos(theta))"
    motion = rs.derive(model, body=body, potential=potential)
    angles = motion.kernels(conversions=True).load().from_quaternion(back.q[-1])
    start = dict(zip(("phi", "theta", "psi"), angles, strict=True))
    start["angular_velocity_body"] = first["angular_velocity_body"]
    found = motion.simulate(start, values, 3.0)
    assert "near a pole of the coordinates at t = 0.99" in found.report()
    assert str(found) == found.report()
    assert np.abs(found.rotation_matrix - same.rotation_matrix).max() < 1e-7
    assert np.abs(np.diff(found.q[:, [0, 1, 2]].sum(axis=1))).max() < 0.5  # no jumps
    assert max(found.drift.values()) < 1e-7


@pytest.mark.parametrize(
    ("initial", "values", "t_end", "message"),
    [
        ({}, TOP, 1.0, "missing initial values: phi, theta, psi, phi_dot, theta_dot, psi_dot"),
        (REST | {"theta": 1}, {"A": 1}, 1.0, "missing parameters: C, g, l, m"),
        (REST | {"theta": 1, "chi": 1}, TOP, 1.0, "unknown initial values: chi"),
        (REST | {"theta": 1}, TOP, float("nan"), "expected a positive number of seconds"),
        ({"phi": 0, "theta": 0, "psi": 0, "angular_velocity_body": [1, 2, 3]}, TOP, 1.0, "a pole"),
        ({"phi": 0, "theta": 1, "psi": 0, "angular_velocity_body": 1}, TOP, 1.0, "three compon"),
        (REST | {"theta": 1}, TOP | {"C": 9.0}, 1.0, "principal moments"),
        (REST | {"theta": 1}, TOP, -1.0, "expected a positive number of seconds"),
        (REST | {"theta": float("nan")}, TOP, 1.0, "theta is nan; expected a finite number"),
        (REST | {"theta": 1}, TOP | {"A": "x"}, 1.0, "parameters: A is x; expected a finite numb"),
        (REST | {"theta": 1, "theta_dot": 1e200}, TOP, 1.0, "give no finite rates at t = 0 s"),
    ],
)
def test_what_a_simulation_cannot_begin_with_is_said(initial, values, t_end, message):
    with pytest.raises(rs.RigidsymError, match=message):
        top().simulate(initial, values, t_end)


def test_a_state_in_which_the_equations_of_motion_fail_is_refused_at_once():
    """A disc that lies flat; its parts do not move with a quaternion"""
    disc = motion_of(read("rolling_disc"))
    values = {"A": 1, "C": 1.5, "m": 1, "g": 9.81, "a": 0.5}
    with pytest.raises(rs.RigidsymError, match="give no finite rates at t = 0 s"):
        disc.simulate(REST | {"psi_dot": 3.0}, values, 1.0)


def test_a_free_body_goes_through_a_pole_of_its_coordinates():
    values, seen = {"A": 1, "C": 0.5}, []
    start = REST | {"theta": 1e-3, "theta_dot": -1.0}
    found = free().simulate(start, values, 1.0, samples=5, progress=seen.append)
    assert "near a pole of the coordinates" in found.report()
    theta = 1e-3 - found.t
    third = np.stack([0 * theta, -np.sin(theta), np.cos(theta)], axis=1)
    assert np.abs(found.rotation_matrix[:, :, 2] - third).max() < 1e-9
    assert 0.9 < seen[-1] <= 1


def test_a_body_at_rest_stays_where_it_is():
    found = free().simulate(REST | {"theta": 1}, {"A": 1, "C": 2}, 1.0, samples=3, method="exact")
    assert np.ptp(found.rotation_matrix, axis=0).max() == 0


def test_steps_in_the_group_end_where_the_body_turns_too_fast():
    start = REST | {"theta": 1, "psi_dot": 1e7}
    found = free().simulate(start, {"A": 1, "C": 2}, 1.0, samples=3, method="lie")
    assert found.ended == "the integration stopped at t = 0 s: the body turns too fast"


@pytest.mark.parametrize(
    ("simulated", "message"),
    [
        (
            lambda: top().simulate(REST, TOP, 1.0, method="euler"),
            "no method 'euler'; known: DOP853",
        ),
        (lambda: top().simulate_many(REST, TOP, 0.0), "expected a positive number of seconds"),
        (
            lambda: motion_of(read("rolling_disc")).simulate(
                REST | {"theta": 1},
                {"A": 1, "C": 1.5, "m": 1, "g": 9.81, "a": 0.5},
                1.0,
                method="lie",
            ),
            "quaternions can replace the coordinates of one body in an inertial frame only",
        ),
    ],
)
def test_what_cannot_be_simulated_is_said(simulated, message):
    with pytest.raises(rs.RigidsymError, match=message):
        simulated()


def test_a_derivation_without_forces_cannot_be_simulated():
    with pytest.raises(rs.RigidsymError, match="has no equations of motion"):
        rs.derive("ZXZ", ("angular_velocity_body",)).simulate({}, {}, 1.0)


def test_the_command_writes_a_table_and_a_picture(tmp_path):
    out, plot = tmp_path / "top.csv", tmp_path / "top.svg"
    sets = [f"--set={name}={value}" for name, value in TOP.items()]
    options = ["--initial=theta=0.5", "--initial=psi_dot=20", "--time=1", "--samples=50"]
    given = ["simulate", "heavy_symmetric_top", *sets, *options]
    done = call(*given, "--out", str(out), "--plot", str(plot), cwd=tmp_path)
    assert "momentum_psi  drift" in done.stdout
    table = np.genfromtxt(out, delimiter=",", names=True)
    assert table.shape == (50,)
    assert table["theta"][0] == 0.5
    assert plot.read_text(encoding="utf-8").startswith("<?xml")
    turning = [f"--initial=angular_velocity_body_{k}={k}" for k in (1, 2)]
    moments = ["--set=A=1", "--set=B=2", "--set=C=2.5"]
    free = ["simulate", "free_body", "--method=exact", "--time=1", *moments, *turning]
    done = call(*free, "--plot=free.png", "--animate=free.gif", "--samples=3", cwd=tmp_path)
    assert "angular_momentum_squared  drift" in done.stdout
    assert (tmp_path / "free.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "free.gif").read_bytes().startswith(b"GIF89a")
    done = call(*given, "--animate=top.html", cwd=tmp_path)
    page = (tmp_path / "top.html").read_text(encoding="utf-8")
    assert f'"start":{np.degrees(0.5)}'[:14] in page
    assert f'"start":{TOP["A"]}' in page
    wrong = call(*free, "--animate=free.avi", cwd=tmp_path, status=2)
    assert "free.avi: expected a file that ends in .gif, .mp4, .html" in wrong.stderr
    wrong = call("simulate", "heavy_symmetric_top", "--set", "A", cwd=tmp_path, status=2)
    assert "expected NAME=NUMBER" in wrong.stderr


def test_the_command_begins_with_the_first_example_of_the_file(tmp_path):
    done = call("simulate", "heavy_symmetric_top", "--out=top.csv", cwd=tmp_path)
    assert "from 0 to 7 s" in done.stdout
    table = np.genfromtxt(tmp_path / "top.csv", delimiter=",", names=True)
    assert (table["theta"][0], table["psi_dot"][0], table["phi_dot"][0]) == (0.9, 12, 0)
    given = ["--initial=theta=0.5", "--time=1", "--set=C=0.6", "--out=own.csv"]
    call("simulate", "heavy_symmetric_top", *given, cwd=tmp_path)
    table = np.genfromtxt(tmp_path / "own.csv", delimiter=",", names=True)
    assert (table["t"][-1], table["theta"][0], table["psi_dot"][0]) == (1, 0.5, 0)


def test_a_film_is_written_with_the_ffmpeg_of_the_extra(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    found = free().simulate(REST | {"theta": 1, "psi_dot": 3}, {"A": 1, "C": 0.5}, 1.0, samples=5)
    film = found.animate(tmp_path / "free.mp4").read_bytes()
    assert film[4:8] == b"ftyp"


def test_a_film_without_ffmpeg_is_refused_and_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr(animation, "_ffmpeg", lambda: "no-such-program")
    found = free().simulate(REST | {"theta": 1, "psi_dot": 3}, {"A": 1, "C": 0.5}, 1.0, samples=5)
    with pytest.raises(rs.RigidsymError, match=r"ffmpeg, .*'\.\[video\]'") as caught:
        found.animate(tmp_path / "free.mp4")
    assert caught.value.exit_code == 4
    assert not (tmp_path / "free.mp4").exists()


BLOWN_UP = """[rotation]
sequence = "ZXZ"
angles = ["phi", "theta", "psi"]
[body]
principal_moments = [1, 1, 1]
[dynamics]
forces = { psi = "psi_dot**2" }
[[dynamics.examples]]
initial = { theta = 0.5, psi_dot = 1 }
time = 3
"""


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "the integration stopped at t = 0.2"),
        (("--method=lie",), "the body turns too fast"),
        (
            ("--ensemble=2", "--spread=theta=0.01"),
            "2 of 2 motions reached a pole of the coordinates or overflowed: 1, 2",
        ),
    ],
)
def test_a_motion_without_end_is_written_as_far_as_it_goes(options, message, tmp_path):
    (tmp_path / "blown.toml").write_text(BLOWN_UP, encoding="utf-8")
    given = ["simulate", "blown.toml", "--samples=200", "--out=out.csv", *options]
    done = call(*given, cwd=tmp_path, status=1)
    assert message in done.stderr
    table = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    assert 1 < table.size < 200


def test_a_force_that_depends_on_rates_is_the_same_in_both_forms():
    free = {"body": rs.principal_moments(*sp.symbols("A A C")), "potential": "k*cos(theta)"}
    found = []
    for method in ("lagrange", "euler"):
        motion = rs.derive("ZXZ", **free, forces={"psi": "-k*psi_dot*phi_dot"}, method=method)
        start = REST | {"theta": 0.8, "psi_dot": 3, "phi_dot": 0.5}
        found.append(motion.simulate(start, {"A": 1, "C": 0.7, "k": 0.4}, 2.0, samples=3))
    assert found[0].q == pytest.approx(found[1].q, rel=1e-8)


@pytest.mark.parametrize(
    ("acting", "message"),
    [
        (
            {"parts": [{"velocity": ["theta_dot**2", "a*phi_dot", "0"], "mass": "m"}]},
            r"the velocity \(theta_dot\*\*2, a\*phi_dot, 0\) is not linear in the rates",
        ),
        ({"potential": "theta_dot*w"}, r"the potential theta_dot\*w depends on rates"),
        ({"potential": "w*cos(thets)"}, "unknown name thets; did you mean theta?"),
    ],
)
def test_what_cannot_act_is_told_as_it_was_typed(acting, message):
    body = rs.principal_moments(*sp.symbols("A A C"))
    with pytest.raises(rs.RigidsymError, match=message):
        rs.derive("ZXZ", body=body, **acting)
