"""Units in headers: every common spelling is converted, and what is not a unit is refused."""

from __future__ import annotations

from itertools import product
from math import pi

import pytest

from rigidsym.data.columns import ColumnNames, conversion, is_angular, names_for, unit_of
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
]


def test_units_are_converted_however_they_are_written():
    cases = [*OTHERS]
    for names, angle in ANGLES.items():
        cases += [(name, "rad", angle) for name in names.split()]
        assert all(map(is_angular, names.split()))
    for (names, angle), (times, time) in product(ANGLES.items(), TIMES.items()):
        for unit, second in product(names.split(), times.split()):
            rates = (f"{unit}/{second}", f"{unit} / {second}", f"{unit} {second}^-1")
            cases += [(rate, "rad/s", angle / time) for rate in (*rates, f"{unit} per {second}")]
    for names, rate in RATES.items():
        cases += [(name, "rad/s", rate) for name in names.split(", ")]
    for unit, expected, factor in cases:
        assert conversion(unit, expected) == pytest.approx(factor, rel=1e-14), unit


@pytest.mark.parametrize("unit", ["grad", "rps", "foo", "deg/fortnight", "Hz", "mil", "filtered"])
def test_an_unknown_unit_is_refused_with_its_name(unit):
    with pytest.raises(DataError, match=f"unknown unit '{unit}'"):
        unit_of(unit)


@pytest.mark.parametrize(
    ("unit", "expected"), [("deg", "rad/s"), ("deg/s", "rad"), ("1/s", "rad/s"), ("m", "kg")]
)
def test_a_unit_of_another_quantity_is_refused(unit, expected):
    with pytest.raises(DataError, match=f"expected a unit such as {expected}, got {unit}"):
        conversion(unit, expected)


@pytest.mark.parametrize(
    "name",
    [
        "yaw [deg]",
        "Yaw (deg)",
        "yaw_deg",
        "yaw deg",
        "yaw / deg",
        "yaw/°",
        '"yaw, deg"',
        "att.yaw [deg]",
        "/imu/yaw [deg]",
        "ATT.yaw_deg",
    ],
)
def test_a_name_is_found_with_its_unit_however_it_is_written(name):
    header = ColumnNames(["time", name])
    assert header.find(["yaw"]) == 1
    assert header.factor(1, "rad") == pytest.approx(DEGREE)


def test_an_index_is_no_unit():
    header = ColumnNames(["q[0]", "q[1]", "q[2]", "q[3]"])
    assert [header.find([f"q{k}"]) for k in range(4)] == [0, 1, 2, 3]
    assert header.factor(0, "") is None


@pytest.mark.parametrize(
    "names", [["yaw", "pitch", "yaw"], ["yaw", "Yaw [deg]"], ["a.yaw", "b.yaw"], ["YAW", "y a w"]]
)
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


def test_a_name_that_the_file_gives_to_another_column_is_refused():
    former = ("roll [deg]", "pitch", "yaw")
    assert names_for(["roll", "pitch", "yaw"], 3, former) == ("roll [deg]", "pitch", "yaw")
    with pytest.raises(DataError, match=r"column 1 would be yaw, but the file names it roll"):
        names_for(["yaw", "pitch", "roll"], 3, former)
