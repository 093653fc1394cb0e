"""Many motions at once are the motions one by one; what cannot be is said."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from rigidsym.errors import BodyError
from rigidsym.simulation import ensemble

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


@pytest.mark.parametrize("weights", [2.0, np.linspace(1.0, 3.0, 700)], ids=["one", "of each"])
def test_c_takes_the_steps_that_numpy_takes(top, weights):
    """More motions than a block holds, with parameters of all or of each"""
    start = START | {"theta": np.linspace(0.3, 1.2, 700)}
    options = {"samples": 3, "step": 0.01}
    shares = []
    one, other = (
        top.simulate_many(
            start, TOP | {"m": weights}, 0.2, target=target, progress=shares.append, **options
        )
        for target in ("numpy", "c")
    )
    assert np.abs(one.states - other.states).max() < 1e-13 * np.abs(one.states).max()
    assert shares[-1] == 1.0


def test_a_body_without_parameters_takes_its_steps_in_c():
    ball = rs.derive("z(phi)", body=rs.principal_moments(1, 1, 1), potential="-cos(phi)")
    found = [
        ball.simulate_many({"phi": TILTS, "phi_dot": 0}, {}, 1.0, target=target, samples=2)
        for target in ("numpy", "c")
    ]
    assert np.abs(found[0].states - found[1].states).max() < 1e-14


@pytest.mark.parametrize(("seconds", "target"), [(5.0, "numpy"), (500.0, "c")])
def test_few_motions_of_many_steps_are_computed_in_c(top, monkeypatch, seconds, target):
    asked = []
    whole = ensemble.generate
    monkeypatch.setattr(ensemble, "_has_compiler", lambda: True)
    monkeypatch.setattr(ensemble, "generate", lambda d, name: asked.append(name) or whole(d, name))
    top.simulate_many(START | {"theta": TILTS}, TOP, seconds, samples=2, step=0.1)
    assert asked == [target]


def test_rounding_does_not_add_up_over_a_thousand_steps():
    free = rs.derive("unit_quaternion", body=rs.principal_moments(*MOMENTS), potential=0)
    omega = np.random.default_rng(2).normal(size=(5, 3))
    start = {"w": 1, "x": 0, "y": 0, "z": 0}
    found = free.simulate_many(
        start | {"angular_velocity_body": omega}, {}, 50.0, samples=2, step=0.05, target="numpy"
    )
    for end, each in zip(found.states[-1], omega, strict=True):
        given = start | {"angular_velocity_body": each}
        exact = free.simulate(given, {}, 50.0, method="exact", samples=2).angular_velocity_body[-1]
        assert np.abs(end[4:] - exact).max() < 2e-14


def test_a_cluster_gives_the_same_ensemble(top):
    from distributed import LocalCluster

    start = START | {"theta": np.linspace(0.3, 1.2, 600)}
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address
        found = top.simulate_many(start, TOP, 0.1, samples=2, scheduler=address)
    assert np.array_equal(found.states, top.simulate_many(start, TOP, 0.1, samples=2).states)


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
    from pyarrow import parquet

    table = parquet.read_table(tmp_path / "grid.parquet")
    assert table["theta_start"].to_pylist()[-1] == 1.2
    assert table["m"].to_pylist() == [1.0, 1.5, 2.0] * 5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--grid=theta=0.2:1.2"], "expected NAME=FROM:TO:COUNT"),
        (["--grid=theta=0:1:2", "--ensemble=3"], "expected --grid or --ensemble, not both"),
        (["--spread=theta=1"], "--spread is for ensembles; expected --ens"),
        (["--ensemble=3", "--spread=phi=1"], "--spread phi: expected its mean"),
        (["--ensemble=3"], "--ensemble 3: all motions would be the same; expected --spread"),
        (["--ensemble=3", "--plot=top.svg"], "--plot and --animate show one motion"),
        (["--ensemble=3", "--method=lie"], "an ensemble has its own integrator"),
        (["--grid=theta=0.2:1:0"], "expected NAME=FROM:TO:COUNT"),
        (["--ensemble=3", "--spread=theta=-1"], "--spread theta=-1: expected a standard deviation"),
        (["--ensemble=3", "--seed=-1"], "-1 is not in the range x>=0"),
        (
            ["--ensemble=3", "--out=x.foo"],
            "the ending .foo; expected .npy, .csv, .txt, .parquet, .pq, .npz",
        ),
    ],
)
def test_what_an_ensemble_cannot_be_is_said(options, message, tmp_path):
    wrong = call("simulate", "heavy_symmetric_top", *options, cwd=tmp_path, status=2)
    assert message in wrong.stderr


def test_each_body_of_an_ensemble_can_be(top):
    """The first does not answer for the others"""
    for name, values in (("C", [0.7, 2.7, 2.8]), ("A", [1.3, -1.0, 0.1])):
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


def test_long_work_goes_without_a_compiler(top, monkeypatch, tmp_path):
    start = START | {"theta": TILTS}
    found = top.simulate_many(start, TOP, 0.1, samples=2)
    assert str(found) == found.report()
    monkeypatch.setattr("rigidsym.simulation.ensemble._WORTH_COMPILING", 0)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert np.array_equal(top.simulate_many(start, TOP, 0.1, samples=2).states, found.states)


def test_arrays_of_different_lengths_are_refused(top):
    start = START | {"theta": TILTS, "psi_dot": [1.0, 2.0]}
    with pytest.raises(rs.RigidsymError, match="arrays of one length, got 2 and 3"):
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
    assert found.ended.startswith("the integration stopped at t = 1 s")
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
