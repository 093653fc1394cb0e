"""Arguments from Python are checked like files: a wrong one is named, and what was expected."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs

a, b = sp.symbols("a b")
MASKED = np.ma.masked_array([1.0, 2.0, 3.0], mask=[0, 0, 1])
IDENTITY = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: rs.solid("sphere", radius=-1, density=a), "radius is -1 m; expected a positive"),
        (lambda: rs.solid("box", sides=[1, -1, 1]), "sides is -1 m"),
        (lambda: rs.solid("hollow_cylinder", inner_radius=2, outer_radius=1), "less than inner"),
        (lambda: rs.solid("sphere", radius="r"), "expected a SymPy expression, got 'r'"),
        (lambda: rs.solid(3), "no shape 3"),
        (lambda: rs.Turn(axis="u", angle=a), "'u' is not an axis: expected x, y, z"),
        (lambda: rs.Turn(axis="z", angle="a"), "angle of a turn: expected a SymPy expression"),
        (lambda: rs.EulerAngles(3), "expected a sequence such as 'ZXZ', got 3"),
        (lambda: rs.EulerAngles("ZYX", angles=None), "three different names, got None"),
        (lambda: rs.EulerAngles("ZYX", angles=(1, 2, 3)), "expected a name in quotes, got 1"),
        (lambda: rs.chain("z(a) x(b)"), "for a text use rs.rotation_from('z(a) x(b)')"),
        (lambda: rs.solid("sphere", radius=1j, density=a), "is not a length"),
        (lambda: rs.chain(None), "expected a list of rs.Turn, got None"),
        (lambda: rs.given(sp.eye(3), name="mine", coordinates="a"), "is not a function of t"),
        (lambda: rs.derive("ZXZ", timeout="1"), "expected a positive number of seconds, got '1'"),
        (lambda: rs.identify("abc", matrix=sp.eye(3)), "angles: expected real numbers"),
        (lambda: rs.identify(MASKED, matrix=np.eye(3)), "angles: masked entries"),
        (lambda: rs.chain([1]), "expected a list of rs.Turn, got 1 in it"),
        (lambda: rs.given(IDENTITY, name="mine"), "expected a SymPy expression, got '1'"),
        (lambda: rs.given(None, name="mine"), "expected a"),
        (lambda: rs.principal_moments("A", "B", "C"), "expected a SymPy expression, got 'A'"),
        (lambda: rs.principal_moments(1.0, 2.0, 2.5), "exact work needs a fraction"),
        (lambda: rs.AxisAngle(names=3), "different names, got 3"),
        (lambda: rs.rotation_from(3), "expected a sequence"),
        (lambda: rs.body_of(3), "expected a distribution of mass"),
        (lambda: rs.Particles(particles=[3]), "expected an rs.Particle, got 3"),
        (lambda: rs.Particle(mass=1, position=[1, 2]), "three components, got 2"),
        (lambda: rs.derive("ZXZ", only="weight"), "no quantity 'weight'"),
    ],
)
def test_a_wrong_argument_is_named(make, said):
    with pytest.raises(rs.RigidsymError) as caught:
        make()
    assert said in str(caught.value)


@pytest.mark.parametrize("arguments", [{"only": 3}, {"only": [3]}, {"body": 3}, {"model": 3}])
def test_an_argument_of_the_wrong_type_is_a_type_error_that_says_what_was_expected(arguments):
    with pytest.raises(TypeError, match="expected"):
        rs.derive(**{"model": "ZXZ", **arguments})


def test_symbols_may_name_angles():
    named = rs.EulerAngles("ZYX", angles=sp.symbols("a b c"))
    assert named == rs.EulerAngles("ZYX", angles=("a", "b", "c"))


def test_numbers_describe_a_solid():
    ball = rs.solid("sphere", radius=1, mass=2)
    assert ball.mass == 2
    assert ball.inertia == sp.diag(*[sp.Rational(4, 5)] * 3)
