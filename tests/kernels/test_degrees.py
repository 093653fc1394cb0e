"""Functions in degrees: SciPy, complex steps and the functions in radians judge them."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.target_modules import EVERY, STRICT
from rigidsym.commands.cli import commands
from rigidsym.errors import KernelError, SpecError
from rigidsym.kernels.targets import TARGETS
from rigidsym.pipeline import read_record, read_spec

SOME = ("rotation_matrix", "angular_velocity_body", "rates_from_angular_velocity_body")
OMEGA = "angular_velocity_body"
ASKED = (f"{OMEGA} by q", "rotation_matrix by q vjp", f"{OMEGA} by q jvp")
Q, Q_DOT = np.array([[110.0, -35.0, 200.0]]), np.array([[30.0, -4.0, 11.0]])
TOLERANCE = {"rtol": 1e-13, "atol": 1e-12}


@cache
def motion(name: str = "ZYX") -> rs.Motion:
    return rs.derive(name, SOME)


@cache
def module(target: str):
    kernels = motion().kernels(target, degrees=True, conversions=True, derivatives=ASKED)
    return kernels.load()


def called(target: str, name: str, *arrays):
    """A function on one orientation, in double precision."""
    if target != "jax":
        return getattr(module(target), name)(*(array[0] for array in arrays))
    import jax

    with jax.enable_x64(True):
        return getattr(module(target), name)(*(array[0] for array in arrays))


def by_complex_steps(quantity: str, *arrays: np.ndarray) -> np.ndarray:
    """The Jacobian by q, in degrees, of an expression in radians."""
    step = motion().step(quantity)
    symbols = [s for n in step.quantity.inputs for s in motion().argument(n).symbols]
    function = sp.lambdify(symbols, list(step.expression), "numpy")
    point = np.concatenate([array[0] for array in arrays]).astype(complex)
    columns = []
    for place in range(3):
        moved = point.copy()
        moved[place] += 1e-150j
        columns.append(np.array(function(*moved * (np.pi / 180)), complex).imag / 1e-150)
    unit = 180 / np.pi if step.quantity.unit.startswith("rad") else 1.0
    return unit * np.array(columns).T


@pytest.mark.parametrize("target", EVERY)
def test_rotations_and_conversions_are_scipys_in_degrees(target):
    found = np.asarray(called(target, "rotation_matrix", Q))
    expected = Rotation.from_euler("ZYX", Q[0], degrees=True)
    assert_allclose(found, expected.as_matrix(), **TOLERANCE)
    angles = called(target, "from_rotation_matrix", found[None])
    assert_allclose(angles, expected.as_euler("ZYX", degrees=True), **TOLERANCE)
    quaternion = called(target, "quaternion", Q)
    assert_allclose(called(target, "from_quaternion", np.array([quaternion])), angles, **TOLERANCE)


@pytest.mark.parametrize("target", EVERY)
def test_velocities_and_rates_are_in_degrees_per_second(target):
    step = motion().step(OMEGA)
    symbols = [s for n in step.quantity.inputs for s in motion().argument(n).symbols]
    given = np.radians(np.concatenate([Q[0], Q_DOT[0]]))
    expected = np.degrees(sp.lambdify(symbols, list(step.expression), "numpy")(*given))
    omega = np.asarray(called(target, OMEGA, Q, Q_DOT))
    assert_allclose(omega, expected, **TOLERANCE)
    assert_allclose(
        called(target, "rates_from_angular_velocity_body", Q, omega[None]), Q_DOT[0], **TOLERANCE
    )


@pytest.mark.parametrize("target", EVERY)
def test_derivatives_are_by_degrees_as_complex_steps_show(target):
    expected = by_complex_steps(OMEGA, Q, Q_DOT)
    value, jacobian = called(target, f"{OMEGA}_jacobian_q", Q, Q_DOT)
    assert_allclose(value, called(target, OMEGA, Q, Q_DOT), **TOLERANCE)
    assert_allclose(jacobian, expected, **TOLERANCE)
    direction = np.array([[1.0, 2.0, -3.0]])
    pushed = called(target, f"{OMEGA}_jvp_q", Q, Q_DOT, direction)[1]
    assert_allclose(pushed, expected @ direction[0], **TOLERANCE)
    weights = np.arange(1.0, 10).reshape(1, 3, 3)
    pulled = called(target, "rotation_matrix_vjp_q", Q, weights)[1]
    assert_allclose(pulled, weights.ravel() @ by_complex_steps("rotation_matrix", Q), **TOLERANCE)


@pytest.mark.parametrize("target", EVERY)
def test_files_components_and_words_say_degrees(target):
    kernels = motion().kernels(target, degrees=True)
    assert kernels.main.startswith("euler_zyx_intrinsic_deg")
    text = "".join(kernels.files.values())
    assert "Angles are in degrees, " in re.sub(r"\s+(\* )?", " ", text)
    assert re.search(r"phi_deg, theta_deg, psi_deg +in deg\b", text)
    assert not re.search(r" in rad\b", text)
    assert "Bound on rounding" not in text  # it would hold for one degree


# The rates of a quaternion or of an axis are no angles: then W has the unit of Ω over that of q̇.
@pytest.mark.parametrize(
    "name", ["axis_angle", "quaternion", "rotation_vector", "z(a) x(b) y(a + c)"]
)
def test_identities_hold_for_coordinates_of_any_unit(name):
    whole = rs.derive(name)
    plain, found = whole.kernels().load(), whole.kernels(degrees=True).load()
    random = np.random.default_rng(3)
    q, q_dot = (random.uniform(0.2, 1.0, (7, len(whole.argument("q").names))) for _ in "ab")
    q /= np.linalg.norm(q[:, :3], axis=1)[:, None] if name == "axis_angle" else 1.0
    unit = np.array([180 / np.pi if u == "rad" else 1 for u in whole.argument("q").units])
    assert_allclose(found.rotation_matrix(q * unit), plain.rotation_matrix(q), **TOLERANCE)
    omega = found.angular_velocity_body(q * unit, q_dot * unit)
    assert_allclose(omega, np.degrees(plain.angular_velocity_body(q, q_dot)), **TOLERANCE)
    matrix = found.rate_matrix_body(q * unit)
    assert_allclose(np.einsum("kij,kj->ki", matrix, q_dot * unit), omega, **TOLERANCE)
    rates = found.rates_from_angular_velocity_body(q * unit, omega)
    inverse = found.inverse_rate_matrix_body(q * unit)
    assert_allclose(np.einsum("kij,kj->ki", inverse, omega), rates, **TOLERANCE)
    expected = plain.rates_from_angular_velocity_body(q, np.radians(omega)) * unit
    assert_allclose(rates, expected, **TOLERANCE)


def test_derivatives_by_an_angle_of_what_is_per_angle_are_per_degree_squared():
    """The angle of axis and angle stands beside an axis without a unit, over Ω."""
    whole, asked = rs.derive("axis_angle"), ["inverse_rate_matrix_body by q"]
    plain = whole.kernels(derivatives=asked).load()
    found = whole.kernels(derivatives=asked, degrees=True).load()
    q = np.array([0.6, 0.0, 0.8, 0.5])
    unit = np.array([180 / np.pi if u == "rad" else 1 for u in whole.argument("q").units])
    _, expected = plain.inverse_rate_matrix_body_jacobian_q(q)
    _, jacobian = found.inverse_rate_matrix_body_jacobian_q(q * unit)
    expected = expected * unit[:, None, None] / np.degrees(1) / unit
    assert_allclose(jacobian, expected, **TOLERANCE)


def test_motion_keeps_energies_in_si_units_and_returns_angles_in_degrees():
    A, B, C = sp.symbols("A B C", positive=True)
    names = ("energy", "accelerations", "state_derivative", "state_jacobian")
    whole = rs.derive("ZYX", names, body=rs.principal_moments(A, B, C), potential=0)
    asked = ("energy by q_dot", "accelerations by q")
    plain, found = (whole.kernels(degrees=d, derivatives=asked).load() for d in (False, True))
    moments, q, q_dot = [1.0, 1.0, 2.0, 2.5], np.array([0.3, 0.4, -0.2]), np.array([0.1, -0.5, 0.7])
    unit = 180 / np.pi
    state = np.concatenate([q, q_dot])
    assert [*found.energy.signature] == [*plain.energy.signature]
    energy, slope = found.energy_jacobian_q_dot(q * unit, q_dot * unit, moments)
    assert_allclose(energy, plain.energy(q, q_dot, moments))
    assert_allclose(slope * unit, plain.energy_jacobian_q_dot(q, q_dot, moments)[1])
    q_ddot, by_q = found.accelerations_jacobian_q(q * unit, q_dot * unit, moments)
    expected, slopes = plain.accelerations_jacobian_q(q, q_dot, moments)
    assert_allclose(q_ddot, np.degrees(expected))
    assert_allclose(by_q, slopes, atol=1e-14)
    flow = found.state_derivative(0.0, state * unit, moments)
    assert_allclose(flow, np.degrees(plain.state_derivative(0.0, state, moments)))
    assert_allclose(
        found.state_jacobian(0.0, state * unit, moments),
        plain.state_jacobian(0.0, state, moments),
        atol=1e-13,
    )


def test_a_right_angle_in_degrees_is_the_pole_that_it_is():
    rates = module("numpy").rates_from_angular_velocity_body(
        [[10.0, pitch, 0.0] for pitch in (90.0, -90.0, 270.0, 89.9)], [1.0, 2.0, 3.0]
    )
    assert np.isnan(rates).any(axis=1).tolist() == [True, True, True, False]


@pytest.mark.parametrize("name", ["ZXZ", "rotation_vector", "axis_angle"])
def test_unwrap_follows_whole_turns_of_360_degrees(name):
    whole = rs.derive(name, ["rotation_matrix"])
    plain, found = (whole.kernels(degrees=d, conversions=True).load() for d in (False, True))
    unit = np.array([180 / np.pi if u == "rad" else 1 for u in whole.argument("q").units])
    random = np.random.default_rng(5)
    path = np.cumsum(random.uniform(0.0, 0.4, (60, 3)), axis=0)
    wound = plain.from_quaternion(rs.kernels("XYZ", conversions=True).quaternion(path))
    assert_allclose(found.unwrap(wound * unit), plain.unwrap(wound) * unit, atol=1e-10)


@pytest.mark.skipif(bool(TARGETS["c"].missing), reason=TARGETS["c"].missing)
def test_lean_c_passes_the_test_that_is_generated_with_it(tmp_path: Path):
    lean = {"precision": "double", "arrays": False, "libm": True}
    kernels = motion().kernels("c", degrees=True, derivatives=ASKED[:1], **lean)
    kernels.write(tmp_path)
    sources = [name for name in kernels.files if name.endswith(".c")]
    assert len(sources) == 2
    compiler = next(filter(shutil.which, TARGETS["c"].programs))
    subprocess.run([compiler, *STRICT, *sources, "-o", "t", "-lm"], cwd=tmp_path, check=True)
    subprocess.run([tmp_path / "t"], check=True)


FILE = """
[rotation]
sequence = "ZYX"
[output]
quantities = ["rotation_matrix"]
kernels = ["numpy", "c"]
note = ["tex"]
degrees = true
"""


def test_a_file_and_the_command_line_ask_for_them(tmp_path: Path):
    spec = read_spec(FILE, source="a.toml", name="a")
    assert spec.degrees
    assert read_record(spec.to_data()) == spec
    with pytest.raises(SpecError, match=r"line 8: output.degrees: expected true or false"):
        read_spec(FILE.replace("true", '"deg"'), source="a.toml", name="a")
    file = tmp_path / "a.toml"
    file.write_text(FILE.replace("degrees = true\n", ""))
    for options, kept in (([], ""), (["--degrees"], "numpy, c")):
        done = CliRunner().invoke(commands, ["run", str(file), "--out", str(tmp_path), *options])
        assert done.exit_code == 0, done.output
        assert ("keeps files made with other options" in done.output) == bool(kept)
    assert {"a.py", "a_deg.py", "a_deg.c", "a_deg.h"} <= {
        p.name for p in (tmp_path / "a").iterdir()
    }
    assert "void a_deg_rotation_matrix(" in (tmp_path / "a" / "a_deg.h").read_text()
    assert CliRunner().invoke(commands, ["check", str(tmp_path / "a")]).exit_code == 0


def test_a_unit_in_place_of_true_is_refused():
    with pytest.raises(KernelError, match=r"^degrees: expected True or False, got 'deg'$"):
        rs.kernels("ZYX", degrees="deg")  # type: ignore[arg-type]
    with pytest.raises(KernelError, match=r"^numpy has no option angle_unit; .*degrees$"):
        motion().kernels(angle_unit="deg")
