"""Units in headers: every common spelling is converted, and what is not a unit is refused."""

from __future__ import annotations

from itertools import product
from math import pi

import pytest

from rigidsym.data.columns import ColumnNames, conversion, is_unit, names_for, unit_of
from rigidsym.errors import DataError

DEGREE = pi / 180
ANGLES = {
    "rad Radians": 1,
    "mrad": 1e-3,
    "µrad μrad urad": 1e-6,
    "deg ° Degrees DEG": DEGREE,
    "cdeg": DEGREE / 100,
    "mdeg": DEGREE / 1000,
    "arcmin ′": DEGREE / 60,
    "arcsec": DEGREE / 3600,
    "mas": DEGREE / 3600e3,
    "turn turns rev": 2 * pi,
    "gon gradian": pi / 200,
}
TIMES = {"s sec": 1, "ms": 1e-3, "min": 60, "h hr hour": 3600}
RATES = {
    "dps, deg.s^-1, degrees per second": DEGREE,
    "mdps": DEGREE / 1000,
    "rpm, rev/min": 2 * pi / 60,
    "rad s^-1, rad s-1, rad·s⁻¹, rad*s**-1": 1,
    "deg per hour": DEGREE / 3600,
}
OTHERS = [
    *((unit, "rad/s^2", DEGREE) for unit in ("deg/s^2", "°/s²", "deg/s/s", "deg s^-2")),
    ("mm", "m", 1e-3),
    ("g", "kg", 1e-3),
    ("g cm^2", "kg m^2", 1e-7),
    ("kg/(m s)", "kg/m/s", 1),
    ("1", "-", 1),
]


def test_units_are_converted_however_they_are_written():
    cases = [*OTHERS]
    for names, angle in ANGLES.items():
        cases += [(name, "rad", angle) for name in names.split()]
        assert all(is_unit(name, "rad") for name in names.split())
    for (names, angle), (times, time) in product(ANGLES.items(), TIMES.items()):
        for unit, second in product(names.split(), times.split()):
            rates = (f"{unit}/{second}", f"{unit} / {second}", f"{unit} {second}^-1")
            cases += [(rate, "rad/s", angle / time) for rate in (*rates, f"{unit} per {second}")]
    for names, rate in RATES.items():
        cases += [(name, "rad/s", rate) for name in names.split(", ")]
    for unit, expected, factor in cases:
        assert conversion(unit, expected) == pytest.approx(factor, rel=1e-14), unit


@pytest.mark.parametrize("unit", ["grad", "deg/fortnight", "filtered"])
def test_an_unknown_unit_is_refused_with_its_name(unit):
    with pytest.raises(DataError, match=f"unknown unit '{unit}'"):
        unit_of(unit)


@pytest.mark.parametrize(
    "name", ["yaw [deg]", "yaw_deg", "yaw deg", '"yaw, deg"', "/imu/yaw [deg]"]
)
def test_a_name_is_found_with_its_unit_however_it_is_written(name):
    header = ColumnNames(["time", name])
    assert header.find(["yaw"]) == 1
    assert header.factor(1, "rad") == pytest.approx(DEGREE)


@pytest.mark.parametrize("names", [["yaw", "Yaw [deg]"], ["a.yaw", "b.yaw"]])
def test_a_name_that_occurs_twice_is_refused(names):
    with pytest.raises(DataError, match="two columns are named yaw"):
        ColumnNames(names).find(["yaw"])


def test_the_full_name_is_preferred_to_the_end_of_a_path():
    assert ColumnNames(["desired.yaw", "yaw"]).find(["yaw"]) == 1
    assert ColumnNames(["position.x", "orientation.x"]).find(["x"]) is None


def test_a_new_name_of_a_column_keeps_the_unit_of_the_file():
    former = ("time [ms]", "yaw [mrad]", "roll_deg")
    assert names_for(["t", "psi", "phi"], 3, former) == ("t [ms]", "psi [mrad]", "phi [deg]")
    assert names_for(["t", "psi [deg]", "phi [rad]"], 3, former)[1:] == ("psi [deg]", "phi [rad]")
    assert names_for(["psi"], 1, None) == ("psi",)
    assert names_for(None, 3, former) == former
