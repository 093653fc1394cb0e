"""Notes of bodies: in physical names, with a drawing, and of a body alone."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from rigidsym.algebra.evaluate import function_of
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


@pytest.mark.parametrize("motion", [drilled, cone], ids=["drilled", "cone"])
def test_what_is_shown_in_names_has_the_value_that_was_derived(motion):
    derived = motion()
    shown, moments = in_names(derived)
    offset = zip(sp.symbols("d_x:z"), sp.Matrix(POINT) - derived.body.centre, strict=True)
    values = {sp.Symbol("M"): derived.body.mass, **dict(moments), **dict(offset)}
    rng = np.random.default_rng(1)
    symbols = {s for argument in derived.arguments for s in argument.symbols}
    numbers = {s: sp.Float(x) for s, x in zip(symbols, rng.uniform(0.3, 0.7, 99), strict=False)}
    replaced = 0
    for before, after in zip(derived.steps, shown.steps, strict=True):
        replaced += before.expression != after.expression
        named = after.expression.xreplace(values)
        order = sorted(symbols, key=lambda s: -sp.count_ops(s))  # rates before coordinates
        rest = named - before.expression
        for symbol in order:
            rest = rest.xreplace({symbol: numbers[symbol]})
        assert max(map(abs, rest)) < 1e-12
    assert replaced > 8


def test_a_hole_takes_its_mass_away():
    (row,) = (line for line in drilled().note().markdown().splitlines() if "(hole)" in line)
    assert row.split("|")[2].startswith(" −")


def test_the_note_gives_each_moment_once_and_the_energy_by_the_moments():
    equations = [
        block
        for section in cone().note().document.sections
        for block in section.blocks
        if isinstance(block, Equation)
    ]
    given = [name.text for e in equations if not e.sides for name in e.entries]
    assert given.count("I₁") == given.count("I₃") == 1
    energy = next(e for e in equations if e.label == "rotational_energy")
    assert "I₁ Ω′₁² + I₁ Ω′₂² + I₃ Ω′₃²" in energy.sides[-1].text
    assert {s.name for s in energy.scalar.free_symbols} == {"I_1", "I_3", "t"}


def test_components_of_the_angular_velocity_keep_their_names():
    """E_R = ½ I′₁₁ Ω′₁² + ..., and no k is another name of Ω′₁."""
    quantities = ("angular_velocity_body", "inertia_tensor", "rotational_energy")
    motion = rs.derive("ZXZ", quantities, body=rs.general_inertia())
    document = motion.note().document
    energy = next(e for e in document.equations if e.label == "rotational_energy")
    names = motion.argument("omega_body").symbols
    assert energy.scalar.free_symbols >= set(names)
    omega = dict(zip(names, motion.angular_velocity_body, strict=True))
    (step,) = (s for s in motion.steps if s.quantity.name == "rotational_energy")
    assert sp.expand(energy.scalar.xreplace(omega) - step.expression[0]) == 0
    blocks = [block for section in document.sections for block in section.blocks]
    values = [v for b in blocks if isinstance(b, Equation) and not b.sides for v in b.matrix]
    assert not set(values) & set(omega.values())


def test_a_body_alone_has_a_note_without_a_rotation():
    document = cone("body").note().document
    labels = {equation.label for equation in document.equations}
    assert labels <= set(OF_BODY_ALONE)
    assert "inertia_tensor" in labels
    assert [section.title for section in document.sections] == ["The body"]
    assert any(isinstance(block, Figure) for block in document.sections[0].blocks)


def test_a_terminal_shows_a_body_alone_without_a_rotation():
    assert "Intrinsic rotations" not in show(cone("body"))
    assert "Intrinsic rotations" in show(cone())


@cache
def three_particles() -> Motion:
    a, m = sp.symbols("a m", positive=True)
    places = [sp.ImmutableMatrix(a * sp.eye(3)[:, k]) for k in range(3)]
    found = (rs.Particle(mass=w, position=p) for w, p in zip((m, 2 * m, m), places, strict=True))
    return rs.derive("ZXZ", body=rs.body_of(rs.Particles(particles=tuple(found))))


def test_the_mass_of_particles_is_a_sum_and_that_of_a_solid_an_integral():
    for motion, sign in ((three_particles(), "Σ"), (cone(), "∫")):
        steps = {s.quantity.name: s for s in motion.steps}
        for name in ("centre_of_mass", "inertia_tensor"):
            assert sign in steps[name].quantity.definition.text
        claims = {proof.claim.text for step in steps.values() for proof in step.proofs}
        assert any(claim.startswith(f"Iₙ = {sign}") for claim in claims)


def test_principal_moments_that_can_be_compared_are_in_ascending_order():
    (step,) = (s for s in three_particles().steps if s.quantity.name == "principal_moments")
    shares = [sp.cancel(2 * moment / step.expression[0]) for moment in step.expression]
    assert shares == [2, 3, 5]


def test_momenta_in_space_have_no_names_for_their_parts():
    """Where they would need any, they are said by the momentum in the body."""
    document = three_particles().note().document
    momentum = next(e for e in document.equations if e.label == "angular_momentum_rotation")
    assert momentum.sides[-1].text == "R L′_R"
    assert momentum.matrix is None


def test_the_body_is_drawn_from_the_back_with_its_holes_and_its_principal_axes():
    drawing, is_principal = body_drawing(drilled())
    assert is_principal
    assert [label.symbol.text for label in drawing.labels] == ["x′", "y′", "z′"]
    dark = max(HOLE)
    holes = [max(facet.color) <= dark for facet in drawing.facets]
    assert any(holes)
    assert not all(holes)
    areas = [_area(facet.points) for facet in drawing.facets]
    assert all(area > 0 for area in areas)  # each is seen from outside


def test_an_axis_that_is_no_coordinate_axis_is_named_after_its_moment():
    motion = drilled('"a/2", "b/8"', 'quantities = ["body"]')
    found = body_drawing(motion)
    assert found is not None
    drawing, is_principal = found
    assert not is_principal
    assert [label.symbol.text for label in drawing.labels] == ["I₁", "I₂", "I₃"]


def test_expressions_of_a_drawing_may_hold_a_cotangent():
    x = sp.Symbol("x")
    assert function_of(sp.cot(x) * sp.Abs(x), [x])([-0.3]) == pytest.approx(-0.3 / np.tan(0.3))


def _area(points: tuple[tuple[float, float], ...]) -> float:
    x, y = np.array(points).T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)


def test_a_note_on_the_energy_alone_says_what_the_moments_are():
    latex = cone("rotational_energy").note().latex()
    assert r"I_3 = \frac{3}{10}\,M\,a^2" in latex


def test_letters_for_entries_need_no_moments_in_closed_form():
    """Equal products of inertia leave moments in closed form, which I₁₂ and I₁₃ do not."""
    product = sp.Symbol("D") * sp.Symbol("M")
    moment = 2 * sp.Symbol("D")
    inertia = sp.Matrix(
        [[moment, -product, -product], [-product, moment, 0], [-product, 0, moment]]
    )
    body = given_inertia(inertia, mass=sp.Symbol("M"), allow=True)
    motion = rs.derive("ZXZ", only=("inertia_tensor", "inertia_ellipsoid"), body=body)
    shown, moments = in_names(motion)
    assert [step.quantity.name for step in shown.steps] == [s.quantity.name for s in motion.steps]
    assert moments == ()


def test_an_angle_that_the_inertia_does_not_hold_is_chosen_for_the_drawing(tmp_path):
    """A cylinder that is turned about its own axis"""
    file = tmp_path / "turned.toml"
    part = '{ shape = "cylinder", radius = 0.5, density = 2, turned = "y(beta) z(alpha)" }'
    rod = '{ shape = "rod", length = 2, mass = 1.5, turned = "y(beta) z(theta)" }'
    file.write_text(f'[rotation]\nsequence = "zxz"\n[body]\nparts = [{part}, {rod}]\n', "utf-8")
    call("run", str(file), "--quiet", cwd=tmp_path)
    assert "drawn for" in next(tmp_path.rglob("turned.html")).read_text("utf-8")
