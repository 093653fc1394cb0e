"""Many motions at once are the motions one by one; what cannot be is said."""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest
import sympy as sp
from scipy.integrate import DOP853

import rigidsym as rs
from helpers.command import call
from rigidsym.errors import BodyError

A, C = sp.symbols("A C")
TOP = {"A": 1.3, "C": 0.7, "m": 2.0, "g": 9.81, "l": 0.4}
START = {"phi": 0.0, "psi": 0.0, "phi_dot": 0.1, "theta_dot": 0.0, "psi_dot": 20.0}
MOMENTS = (1, sp.Rational(3, 2), sp.Rational(21, 10))
TILTS = np.array([0.4, 0.8, 1.2])


@pytest.fixture(scope="module")
def top():
    return rs.derive("ZXZ", body=rs.principal_moments(A, A, C), potential="m*g*l*cos(theta)")


def test_an_ensemble_is_its_motions_one_by_one(top):
    weights = np.array([1.0, 2.0, 3.0])
    start = START | {"theta": TILTS}
    found = top.simulate_many(start, TOP | {"m": weights}, 2.0, samples=11)
    assert found.states.shape == (11, 3, 6)
    assert all(values.max() < 1e-10 for values in found.drift.values())
    for k in (0, 2):
        one = top.simulate(START | {"theta": TILTS[k]}, TOP | {"m": weights[k]}, 2.0, samples=11)
        assert np.abs(found.states[:, k, :3] - one.q).max() < 1e-8


def test_rounding_does_not_add_up_over_a_thousand_steps():
    """Angles far from 0 that grow at constant rates: each sum rounds by up to eps/2 of the angle.

    Corrected, all of them together lose 2 eps/2 of the angle. What is added loses (n + 4) eps/2 of
    itself times the sum of the |weights|, for n stages.
    """
    turning = rs.derive("z(phi)", body=rs.principal_moments(1, 1, 1), potential=0)
    rates = np.array([0.1, 0.7, -1 / 3])
    found = turning.simulate_many({"phi": 1000.0, "phi_dot": rates}, {}, 10.0, samples=2, step=0.01)
    exact = 1000 + 10 * rates
    added = (DOP853.n_stages + 4) * np.abs(DOP853.B).sum() * np.abs(10 * rates)
    assert (np.abs(found.states[-1][:, 0] - exact) <= 2.0**-53 * (4 * exact + added)).all()


def test_the_command_simulates_a_grid_and_writes_every_kind_of_file(tmp_path):
    sets = [f"--set={name}={value}" for name, value in TOP.items() if name != "m"]
    grid = ["--grid=theta=0.2:1.2:5", "--grid=m=1:2:3", "--time=0.1", "--samples=3"]
    given = ["simulate", "heavy_symmetric_top", *sets, *grid, "--initial=psi_dot=15"]
    done = call(*given, "--out=grid.npz", cwd=tmp_path)
    assert "15 motions from 0 to 0.1 s" in done.stdout
    with np.load(tmp_path / "grid.npz") as found:
        assert found["states"].shape == (3, 15, 6)
        assert sorted(set(found["theta_start"])) == pytest.approx(np.linspace(0.2, 1.2, 5))
    call(*given, "--out=grid.parquet", cwd=tmp_path)
    table = pl.read_parquet(tmp_path / "grid.parquet")
    assert table["theta_start"].to_list()[-1] == 1.2
    assert table["m"].to_list() == [1.0, 1.5, 2.0] * 5


def test_each_body_of_an_ensemble_can_be(top):
    """The first does not answer for the others"""
    impossible = {"C": [0.7, 2.7, 2.8], "A": [1.3, -1.0, 0.1], "M": [1.0, -1.0, 1.0]}
    for name, values in impossible.items():
        with pytest.raises(BodyError, match=r"^motion 2 of 3: "):
            top.simulate_many(START | {"theta": TILTS}, TOP | {name: np.array(values)}, 0.1)


def test_motions_that_reach_a_pole_are_named(top):
    upright = START | {"theta": np.array([0.5, 0.0, 0.9, 0.0])}
    found = top.simulate_many(upright, TOP, 0.1, samples=2)
    assert found.ended.startswith("2 of 4 motions reached a pole")
    assert found.ended.endswith(": 2, 4")
    given = {"phi": 0, "theta": upright["theta"], "psi": 0, "angular_velocity_body": [0, 1, 9]}
    with pytest.raises(rs.RigidsymError, match="motion 2 of 4 starts at a pole"):
        top.simulate_many(given, TOP, 0.1)


def test_each_motion_of_an_ensemble_starts_with_a_rotation():
    free = rs.derive("unit_quaternion", body=rs.principal_moments(*MOMENTS), potential=0)
    start = {"w": [1, 1, 2], "x": 0, "y": 0, "z": 0, "angular_velocity_body": [0, 0, 1]}
    with pytest.raises(rs.RigidsymError, match="motion 3 of 3: no rotation has the coordinates"):
        free.simulate_many(start, {}, 0.1)


def test_arrays_of_different_lengths_are_refused(top):
    start = START | {"theta": TILTS, "psi_dot": [1.0, 2.0]}
    with pytest.raises(rs.RigidsymError, match="arrays of one length, got 2 and 3"):
        top.simulate_many(start, TOP, 1.0)


def test_what_was_computed_before_an_integrator_fails_is_kept():
    pushed = rs.derive("z(phi)", body=rs.principal_moments(A, A, C), forces={"phi": "k*phi_dot**2"})
    found = pushed.simulate({"phi": 0, "phi_dot": 1}, {"A": 1, "C": 1, "k": 1}, 3.0, samples=301)
    assert found.ended.startswith("the integration stopped at t = 1 s")
    assert 95 < len(found.t) < 102
    exact = -np.log(1 - found.t[:90])
    assert np.abs(found.q[:90, 0] - exact).max() < 1e-8


def test_dry_friction_ends_the_motion_where_the_body_stops():
    """C dω/dt = −k sign ω: at rest its direction changes at once, and no step is short enough"""
    dry = rs.derive(
        "z(phi)", body=rs.principal_moments(A, A, C), forces={"phi": "-k*phi_dot/abs(phi_dot)"}
    )
    found = dry.simulate({"phi_dot": 1}, {"A": 1, "C": 1, "k": 1}, 3.0, samples=31)
    assert "t = 1 s: the accelerations change faster than steps can follow" in found.ended
    assert found.q[:10, 0] == pytest.approx(found.t[:10] - found.t[:10] ** 2 / 2, abs=1e-8)
