"""Notes of bodies: in physical names, with a drawing, and of a body alone."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.mechanics.quantities.mass import OF_BODY_ALONE
from rigidsym.mechanics.quantities.table import POINT
from rigidsym.models.body import given_inertia
from rigidsym.motion import Motion
from rigidsym.notes.document import Equation, Figure
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import HOLE
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.named_body import in_names
from rigidsym.pipeline import motion_of, read_spec

DRILLED = """
[rotation]
sequence = "ZXZ"
[output]
{quantities}
[[body.parts]]
shape = "box"
sides = ["2*a", "b", "b/2"]
density = "rho"
[[body.parts]]
shape = "cylinder"
radius = "b/4"
height = "b"
density = "rho"
at = [{at}, 0]
hole = true
"""


@cache
def drilled(at: str = "0, 0", quantities: str = "") -> Motion:
    text = DRILLED.format(at=at, quantities=quantities)
    return motion_of(read_spec(text, source="drilled.toml", name="drilled"))


@cache
def cone(*only: str) -> Motion:
    return rs.derive("ZXZ", only, body=rs.solid("cone"))


@cache
def three_particles() -> Motion:
    a, m = sp.symbols("a m", positive=True)
    places = [sp.ImmutableMatrix(a * sp.eye(3)[:, k]) for k in range(3)]
    pairs = zip((m, 2 * m, m), places, strict=True)
    particles = tuple(rs.Particle(mass=w, position=p) for w, p in pairs)
    return rs.derive("ZXZ", body=rs.body_of(rs.Particles(particles=particles)))


def equation(motion: Motion, label: str) -> Equation:
    return next(e for e in motion.note().document.equations if e.label == label)


@pytest.mark.parametrize("motion", [drilled, cone], ids=["drilled", "cone"])
def test_what_is_shown_in_names_has_the_value_that_was_derived(motion):
    derived = motion()
    shown, moments = in_names(derived)
    offset = zip(sp.symbols("d_x:z"), sp.Matrix(POINT) - derived.body.centre, strict=True)
    values = {sp.Symbol("M"): derived.body.mass, **dict(moments), **dict(offset)}
    rng = np.random.default_rng(1)
    symbols = {s for argument in derived.arguments for s in argument.symbols}
    numbers = {s: sp.Float(x) for s, x in zip(symbols, rng.uniform(0.3, 0.7, 99), strict=False)}
    order = sorted(symbols, key=lambda s: -sp.count_ops(s))  # rates before coordinates
    replaced = 0
    for before, after in zip(derived.steps, shown.steps, strict=True):
        replaced += before.expression != after.expression
        rest = after.expression.xreplace(values) - before.expression
        for symbol in order:
            rest = rest.xreplace({symbol: numbers[symbol]})
        assert max(map(abs, rest)) < 1e-12
    assert replaced > 8


def test_letters_for_entries_need_no_moments_in_closed_form():
    """Equal products of inertia leave moments in closed form, which I₁₂ and I₁₃ do not."""
    mass, length = sp.symbols("M D")
    row = [2 * length, -length * mass, -length * mass]
    inertia = sp.Matrix([row, [row[1], row[0], 0], [row[1], 0, row[0]]])
    body = given_inertia(inertia, mass=mass, allow=True)
    motion = rs.derive("ZXZ", only=("inertia_tensor", "inertia_ellipsoid"), body=body)
    shown, moments = in_names(motion)
    assert [step.quantity.name for step in shown.steps] == [s.quantity.name for s in motion.steps]
    assert moments == ()


def test_the_note_gives_each_moment_once_and_the_energy_by_the_moments():
    blocks = [block for s in cone().note().document.sections for block in s.blocks]
    given = [n.text for b in blocks if isinstance(b, Equation) and not b.sides for n in b.entries]
    assert given.count("I₁") == given.count("I₃") == 1
    energy = equation(cone(), "rotational_energy")
    assert "I₁ Ω′₁² + I₁ Ω′₂² + I₃ Ω′₃²" in energy.sides[-1].text
    assert {s.name for s in energy.scalar.free_symbols} == {"I_1", "I_3", "t"}
    assert r"I_3 = \frac{3}{10}\,M\,a^2" in cone("rotational_energy").note().latex()


def test_components_of_the_angular_velocity_keep_their_names():
    """E_R = ½ I′₁₁ Ω′₁² + ..., and no k is another name of Ω′₁."""
    quantities = ("angular_velocity_body", "inertia_tensor", "rotational_energy")
    motion = rs.derive("ZXZ", quantities, body=rs.general_inertia())
    energy = equation(motion, "rotational_energy")
    names = motion.argument("omega_body").symbols
    assert energy.scalar.free_symbols >= set(names)
    omega = dict(zip(names, motion.angular_velocity_body, strict=True))
    expected = motion.step("rotational_energy").expression[0]
    assert sp.expand(energy.scalar.xreplace(omega) - expected) == 0


def test_momenta_in_space_that_would_need_names_are_said_by_the_momentum_in_the_body():
    momentum = equation(three_particles(), "angular_momentum_rotation")
    assert (momentum.sides[-1].text, momentum.matrix) == ("R L′_R", None)


def test_a_body_alone_has_a_note_and_a_text_without_a_rotation():
    document = cone("body").note().document
    labels = {equation.label for equation in document.equations}
    assert "inertia_tensor" in labels
    assert labels <= set(OF_BODY_ALONE)
    assert [section.title for section in document.sections] == ["The body"]
    assert any(isinstance(block, Figure) for block in document.sections[0].blocks)
    assert "Intrinsic rotations" not in show(cone("body"))
    assert "Intrinsic rotations" in show(cone())


def test_the_mass_of_particles_is_a_sum_and_that_of_a_solid_an_integral():
    for motion, sign in ((three_particles(), "Σ"), (cone(), "∫")):
        steps = {s.quantity.name: s for s in motion.steps}
        for name in ("centre_of_mass", "inertia_tensor"):
            assert sign in steps[name].quantity.definition.text
        claims = {proof.claim.text for step in steps.values() for proof in step.proofs}
        assert any(claim.startswith(f"Iₙ = {sign}") for claim in claims)


def test_principal_moments_that_can_be_compared_are_in_ascending_order():
    moments = three_particles().step("principal_moments").expression
    assert [sp.cancel(2 * moment / moments[0]) for moment in moments] == [2, 3, 5]


# --- the drawing ---


def test_the_body_is_drawn_from_the_back_with_its_holes_and_its_principal_axes():
    drawing, is_principal = body_drawing(drilled())
    assert is_principal
    assert [label.symbol.text for label in drawing.labels] == ["x′", "y′", "z′"]
    holes = [max(facet.color) <= max(HOLE) for facet in drawing.facets]
    assert any(holes)
    assert not all(holes)
    for x, y in (np.array(facet.points).T for facet in drawing.facets):
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0  # each is seen from outside
    (row,) = (line for line in drilled().note().markdown().splitlines() if "(hole)" in line)
    assert row.split("|")[2].startswith(" −")


def test_an_axis_that_is_no_coordinate_axis_is_named_after_its_moment():
    drawing, is_principal = body_drawing(drilled('"a/2", "b/8"', 'quantities = ["body"]'))
    assert not is_principal
    assert [label.symbol.text for label in drawing.labels] == ["I₁", "I₂", "I₃"]


def test_an_angle_that_the_inertia_does_not_hold_is_chosen_for_the_drawing():
    """A cylinder that is turned about its own axis"""
    part = '{ shape = "cylinder", radius = 0.5, density = 2, turned = "y(beta) z(alpha)" }'
    rod = '{ shape = "rod", length = 2, mass = 1.5, turned = "y(beta) z(theta)" }'
    text = f'[rotation]\nsequence = "zxz"\n[body]\nparts = [{part}, {rod}]\n'
    motion = motion_of(read_spec(text, source="turned.toml", name="turned"))
    assert "drawn for" in motion.note().markdown()
