"""`derive` integrates what it is given for a body, and says where a body cannot be."""

from __future__ import annotations

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import BodyError
from rigidsym.models import solids
from rigidsym.models.body import (
    BodyDescription,
    Composite,
    Part,
    Particle,
    Particles,
    RigidBody,
    Solid,
)
from rigidsym.models.solids import shaped

M, a, h = sp.symbols("M a h")
CYLINDER = shaped("cylinder", [a, h], mass=M)
ONLY = ("rotational_energy",)


def particle(mass: str, *place: str) -> Particle:
    return Particle(
        mass=sp.Rational(mass), position=sp.ImmutableMatrix([sp.Rational(x) for x in place])
    )


FLAT = Solid(
    title="flat",
    coordinates=sp.symbols("u v w"),
    place=sp.ImmutableMatrix([sp.Symbol("u"), sp.Symbol("v"), 0]),
    bounds=((sp.S.Zero, sp.S.One),) * 3,
    density=sp.S.One,
)


def test_a_distribution_is_integrated_by_derive():
    motion = rs.derive("ZXZ", ONLY, body=CYLINDER)
    assert isinstance(motion.body, RigidBody)
    assert motion.body.inertia == rs.solid("cylinder", radius=a, height=h).inertia


def test_a_description_in_numbers_keeps_them_as_parameters_with_a_value():
    cloud = Particles(
        particles=(
            particle("5/4", "1/2", "0", "1/3"),
            particle("2123456789/1000000000", "-1/4", "0", "-1/5"),
            particle("1", "1/3", "0", "0.123456789"),
        )
    )
    body = rs.derive("ZXZ", ONLY, body=BodyDescription(distribution=cloud)).body
    exact = rs.body_of(cloud)
    assert {p.symbol.name for p in body.parameters} >= {"M", "I_11", "I_13", "x_C"}
    for shown, value in zip(body.in_numbers(body.inertia), exact.inertia, strict=True):
        assert abs(float(shown - value)) <= 1e-14 * float(exact.inertia.norm())
    kept = BodyDescription(distribution=cloud, keeps_numbers=True)
    assert rs.derive("ZXZ", ONLY, body=kept).body.inertia == exact.inertia


@pytest.mark.parametrize(
    ("distribution", "place"),
    [
        (FLAT, ("shape",)),
        (Particles(particles=(particle("1", "0", "0", "0"), particle("-1", "1", "0", "0"))), None),
        (Composite(parts=(Part(what=CYLINDER), Part(what=FLAT))), ("parts", 1)),
        (
            Composite(parts=(Part(what=Composite(parts=(Part(what=FLAT),))),)),
            ("parts", 0, "parts", 0),
        ),
    ],
)
def test_a_body_that_cannot_be_is_refused_with_its_place(distribution, place):
    with pytest.raises(BodyError) as caught:
        rs.derive("ZXZ", ONLY, body=distribution)
    assert caught.value.place == (place or ("particles",))


@pytest.mark.parametrize(
    ("shape", "lengths", "message"),
    [
        ("sphere", {"radius": -1}, "radius is -1 m; expected a positive length"),
        ("box", {"sides": [1, -1, 1]}, "sides is -1 m"),
        ("rod", {"length": 0}, "length is 0 m"),
        ("hollow_cylinder", {"inner_radius": 2, "outer_radius": 1}, "less than inner_radius"),
    ],
)
def test_lengths_in_numbers_are_checked_in_python_too(shape, lengths, message):
    with pytest.raises(BodyError, match=message):
        rs.solid(shape, density=sp.Symbol("rho"), **lengths)


def test_plain_numbers_make_a_solid():
    assert rs.solid("sphere", radius=1, mass=2).inertia == sp.eye(3) * sp.Rational(4, 5)


def test_floating_point_moments_are_refused_when_the_body_is_made():
    with pytest.raises(BodyError, match=r"2\.5.* is a floating-point number.*5/2"):
        rs.principal_moments(1, 2, 2.5)


def test_a_new_solid_is_one_entry(monkeypatch):
    lengths = tuple(
        solids.Length(key=key, names=(name,), about=key)
        for key, name in (("side", "a"), ("h", "h"))
    )
    entry = solids.Shape("Wedge", "at the origin", lengths, "u, v, w", "0..a, 0..a - u, 0..h")
    monkeypatch.setattr(solids, "SHAPES", {**solids.SHAPES, "wedge": entry})
    body = rs.solid("wedge")
    assert rs.derive("ZXZ", ["inertia_tensor"], body=body).is_proved
    assert body.centre == sp.ImmutableMatrix([a / 3, a / 3, h / 2])
