"""The library of rotations: vectors, chains, kernels, and what cannot be read."""

from __future__ import annotations

import pytest

from helpers.parametrisations import (
    CHAINS,
    motion_of,
)
from rigidsym.errors import ExpressionError, ModelError
from rigidsym.models.library import PRESETS, rotation_from
from rigidsym.pipeline import read_record
from rigidsym.spec.derivation_spec import spec_for


@pytest.mark.parametrize("text", ["ZXZ", "unit_quaternion", *PRESETS, *CHAINS[3:8]])
def test_what_was_asked_for_can_be_asked_for_again(text):
    spec = spec_for(text, passive=True)
    assert read_record(spec.to_data()) == spec


def test_zero_names_a_constant_and_ten_does_not():
    model = rotation_from("z(a_9) x(alpha0) y(a_10) x(b_0)")
    assert [symbol.name for symbol in model.constants] == ["alpha0", "b_0"]
    assert [q.func.__name__ for q in model.coordinates] == ["a_9", "a_10"]


REFUSED = [  # a rotation and options
    ("w(phi)", {}, "expected a turn"),
    ("[0,0,0](phi)", {}, "the axis must not be the zero vector"),
    ("[1,1](phi)", {}, "expected three"),
    ("z(pi/4)", {}, "does not move"),
    ("z(sin(phi)", {}, "unclosed"),
    ("quaternoin", {}, "did you mean quaternion"),
    ("goldstien", {}, "did you mean goldstein"),
    ("z(phi_dot)", {}, "reads as a rate"),
    ("ZXZ", {"scalar_last": True}, "scalar-last applies only to quaternions"),
    ("quaternion", {"names": ["a", "b", "c"]}, "expected 4 different names"),
    ("z(a) [a,b,c](beta)", {}, "a is both a coordinate and a constant"),
    ("ZXZ", {"constants": ["k"]}, "they go with turns"),
]


@pytest.mark.parametrize(("text", "options", "message"), REFUSED)
def test_a_rotation_that_cannot_be_read_says_why(text, options, message):
    with pytest.raises((ModelError, ExpressionError), match=message):
        rotation_from(text, **options)


def test_the_scalar_stands_last_on_request_and_rates_have_the_unit_of_the_coordinates():
    first, last = rotation_from("quaternion"), rotation_from("quaternion", scalar_last=True)
    assert last.coordinates == (*first.coordinates[1:], first.coordinates[0])
    assert last.matrix == first.matrix
    assert last.name != first.name
    for text, unit in (("ZXZ", "rad/s"), ("unit_quaternion", "1/s")):
        rates = motion_of(text).step("rates_from_angular_velocity_body")
        assert rates.quantity.unit == unit
