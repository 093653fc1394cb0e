"""Many motions at once are the motions one by one; what cannot be is said."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call

A, C = sp.symbols("A C")
TOP = {"A": 1.3, "C": 0.7, "m": 2.0, "g": 9.81, "l": 0.4}
START = {"phi": 0.0, "psi": 0.0, "phi_dot": 0.1, "theta_dot": 0.0, "psi_dot": 20.0}
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


def test_arrays_of_different_lengths_are_refused(top):
    start = START | {"theta": TILTS, "psi_dot": [1.0, 2.0]}
    with pytest.raises(rs.RigidsymError, match="arrays of 2 and 3 motions"):
        top.simulate_many(start, TOP, 1.0)


def test_the_command_simulates_an_ensemble(tmp_path):
    sets = [f"--set={name}={value}" for name, value in TOP.items()]
    options = ["--ensemble=20", "--spread=theta=0.05", "--time=0.5", "--out=top.csv"]
    start = ["--initial=theta=0.6", "--initial=psi_dot=15"]
    done = call("simulate", "heavy_symmetric_top", *sets, *start, *options, cwd=tmp_path)
    assert "20 motions from 0 to 0.5 s" in done.stdout
    table = np.genfromtxt(tmp_path / "top.csv", delimiter=",", names=True)
    assert table.shape == (20,)
    assert 0.02 < table["theta_start"].std() < 0.1


def test_what_was_computed_before_an_integrator_fails_is_kept():
    pushed = rs.derive("z(phi)", body=rs.principal_moments(A, A, C), forces={"phi": "k*phi_dot**2"})
    found = pushed.simulate({"phi": 0, "phi_dot": 1}, {"A": 1, "C": 1, "k": 1}, 3.0, samples=301)
    assert found.ended.startswith("ended at t = 1 s")
    assert 95 < len(found.t) < 102
    exact = -np.log(1 - found.t[:90])
    assert np.abs(found.q[:90, 0] - exact).max() < 1e-8


def test_a_name_that_is_all_but_a_coordinate_is_no_constant():
    with pytest.raises(rs.RigidsymError, match="unknown name thetta; did you mean theta"):
        rs.derive(
            rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")),
            body=rs.principal_moments(A, A, C),
            potential="m*g*l*cos(thetta)",
        )
