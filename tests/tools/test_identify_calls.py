"""The calls that `identify` prints are run, and give the data back."""

from __future__ import annotations

import numpy as np
import pytest

from helpers.conventions import GENERIC, RATES, sample, some
from rigidsym.tools.identify.fit import calls
from rigidsym.tools.identify.readings import VELOCITIES, Reading


def results_of(statements: str, reading: Reading) -> dict[str, np.ndarray]:
    """What the statements leave behind."""
    names = {"np": np, "angles": np.array(GENERIC[reading.degrees]), "rates": np.array(RATES)}
    exec(compile(statements, "<printed>", "exec"), names)
    wanted = ("matrix", "quaternion", "omega")
    return {name: np.array(names[name], float) for name in wanted if name in names}


READINGS = [
    *some(12, seed=20, layouts=(None, None, False, True), velocities=(None,)),
    *some(10, seed=21, layouts=(None, False, True), velocities=VELOCITIES),
]


@pytest.mark.parametrize("library", ["SciPy", "rigidsym"])
@pytest.mark.parametrize("reading", READINGS, ids=str)
def test_any_order_signs_units_layout_and_velocity(reading, library):
    expected = sample(reading, GENERIC[reading.degrees])
    statements = calls(reading)[library]
    assert "from rigidsym" not in statements  # public names only
    found = results_of(statements, reading)
    if reading.scalar_last is None:
        np.testing.assert_allclose(found["matrix"], expected["matrix"], atol=1e-13)
    else:
        sign = np.sign(found["quaternion"] @ expected["quaternion"])
        np.testing.assert_allclose(sign * found["quaternion"], expected["quaternion"], atol=1e-13)
    if reading.velocity and library != "SciPy":
        np.testing.assert_allclose(found["omega"].ravel(), expected["omega"], atol=1e-6, rtol=1e-6)


@pytest.mark.parametrize("library", ["SciPy", "rigidsym"])
def test_arrays_of_samples(library):
    reading = Reading(sequence="ZYX", columns=(2, 1, 0), signs=(1, -1, 1), degrees=True)
    names = {"np": np, "angles": np.array([GENERIC[True]] * 4)}
    exec(compile(calls(reading)[library], "<printed>", "exec"), names)
    expected = sample(reading, GENERIC[True])["matrix"]
    np.testing.assert_allclose(names["matrix"], [expected] * 4, atol=1e-13)
