"""What the notes say of bodies and their motions is true of the models, and explained."""

from __future__ import annotations

from dataclasses import fields
from functools import cache
from string import ascii_letters

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.motions import motion_in
from rigidsym.formula.scalars import formula_of, matrix_of
from rigidsym.formula.tree import Formula, Symbol
from rigidsym.mechanics.quantities.mass import OF_BODY_ALONE
from rigidsym.mechanics.quantities.table import POINT, own_names
from rigidsym.motion import Motion
from rigidsym.notes.document import Equation, Figure, texts_of
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import HOLE
from rigidsym.notes.figure.drawing import Facet
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.named_body import in_names
from rigidsym.pipeline import motion_of, read

SYSTEMS = ("composite_body", "dual_spin_satellite", "free_body", "free_symmetric_body")
SYSTEMS += ("heavy_asymmetric_body", "heavy_symmetric_top", "kovalevskaya_top", "solid_cone")


DRILLED = """
output.quantities = [
    "body", "kinetic_energy", "inertia_tensor_space", "rotational_energy", "translational_energy",
    "angular_momentum", "angular_momentum_rotation", "angular_momentum_rotation_body",
]
[body]
parts = [{ shape = "box", sides = ["2*a", "b", "b/2"], density = "rho" },
         { shape = "cylinder", radius = "b/4", height = "b", density = "rho", hole = true }]
"""


@cache
def drilled(density: str = "rho", length: str = "a", half: str = "b") -> Motion:
    text = DRILLED.replace("rho", density).replace("2*a", f"2*{length}")
    return motion_in(text.replace('"b/', f'"{half}/'))


@pytest.mark.parametrize("letters", ["I", "J M I2 M0", "I₀ K1 I1 J1"])  # a free one, and taken ones
def test_what_is_shown_in_names_has_the_value_that_was_derived(letters):
    own, *taken = letters.split()
    derived = drilled(*taken)
    shown, moments = in_names(derived)
    assert derived.step("principal_moments").quantity.symbol.text == f"({own}₁, {own}₂, {own}₃)"
    offset = zip(sp.symbols("d_x:z"), sp.Matrix(POINT) - derived.body.centre, strict=True)
    mass = sp.Symbol(own_names(derived.arguments, derived.body)["M"])
    values = {mass: derived.body.mass, **dict(moments), **dict(offset)}
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


def letters_in(part: object) -> set[Symbol]:
    """The letters of formulas, without dots, primes and indices; those of components are light."""
    if isinstance(part, Symbol):
        return {Symbol(part.letter), Symbol(part.letter, part.face)}
    if isinstance(part, Formula):
        part = [getattr(part, field.name) for field in fields(part)]
    return set().union(*map(letters_in, part)) if isinstance(part, tuple | list) else set()


ALIKE = """
body = { principal_moments = ["E", "V", "T"], mass = "M + m" }
dynamics.potential = "M*g*(L + H)*cos(theta)"
dynamics.fixed_point = "centre_of_mass"
output.quantities = ["lagrangian", "hamiltonian", "mass_matrix", "inertia_tensor_point"]
"""
JOINTS = """
rotation.sequence = "z(phi) x(theta) z(psi) z(a)"
body = { principal_moments = ["N", "N", "I"] }
dynamics.forces = { a = "w - b*a_dot" }
dynamics.potential = "f*cos(theta)"
dynamics.parts = [{ rotation = "z(phi) x(theta) z(psi)", principal_moments = ["A", "B", "H"] }]
output.quantities = ["lagrangian", "generalised_momenta", "mass_matrix", "bias_vector"]
"""


@pytest.mark.parametrize(
    "name", [ALIKE, JOINTS, *(pytest.param(n, marks=pytest.mark.campaign) for n in SYSTEMS)]
)
def test_every_letter_of_a_note_is_explained(name):
    motion = motion_of(read(name)) if name in SYSTEMS else motion_in(name)
    document = motion.note().document
    spans = [span for b in document.blocks for text in texts_of(b) for span in text]
    told = [each.notation for each in motion.arguments if each.name in ("q", "parameters")]
    told += [[e.sides[:1], e.entries] for e in document.displays]
    shown, letters = letters_in([e.sides for e in document.displays]), document.letters
    for e in document.displays:
        shown |= letters_in(matrix_of(e.matrix, letters)) if e.matrix else set()
        shown |= letters_in(formula_of(e.scalar, letters)) if e.scalar is not None else set()
    shown -= {Symbol(letter, face) for letter in "T01i" for face in ("italic", "bold", "sans")}
    assert shown <= letters_in([spans, told])
    constants = letters_in([a.notation for a in motion.arguments if a.name in ("q", "parameters")])
    printed = {entry for e in document.displays for entry in e.entries}
    stems = letters_in([*printed & {letters.name(part.symbol) for part in motion.definitions}])
    assert stems <= letters_in(spans) - constants
    told_of = {*map(Symbol, ascii_letters)} & {*spans}
    assert told_of <= shown | letters_in(told) | {*map(Symbol, "NTVxyz")}


def test_a_potential_energy_beside_a_constant_of_this_letter_has_another_one_everywhere():
    body, only = rs.principal_moments(1, 1, 2), ["energy", "effective_potential"]
    top = rs.derive("ZXZ", only, body=body, potential="V*cos(theta)*sin(t)")
    note = top.note().markdown()
    assert r"U _{\mathrm{eff}}" in note
    assert r"\partial V" not in note


def test_names_of_moments_do_not_make_eulers_equations_longer():
    C, only = sp.Symbol("C"), ["rotational_energy", "angular_acceleration_from_torque"]
    top = rs.derive("ZXZ", only, body=rs.principal_moments(2 * C, 2 * C, C), potential=0)
    assert in_names(top)[0].step(only[1]).expression.has(C)


def test_letters_of_one_meaning_come_with_their_parts():
    note = motion_in(DRILLED.replace('rho", hole', 'sigma", hole')).note().markdown()
    assert "is the density of the box, and $\\sigma$ is the density of the solid cylinder." in note


def test_names_of_parts_are_defined_before_the_first_result_that_holds_them():
    moments, part = sp.symbols("A B C"), {"rotation": "x(a)", "principal_moments": "DEF"}
    only = ["mass_matrix", "accelerations", "first_integrals"]
    motion = rs.derive("x(a) z(b)", only, body=rs.principal_moments(*moments), parts=[part])
    defined, needed = set(), {definition.symbol for definition in motion.definitions}
    document = motion.note().document
    for section in document.sections:
        for block in section.blocks:
            if isinstance(block, Equation) and block.matrix:
                defined |= {entry.text for entry in block.entries}
                parts = block.matrix.free_symbols & needed
                assert {document.letters.name(part).text for part in parts} <= defined
    text = show(motion)
    assert len(defined) > 9
    assert all(f"\n  {name} = " in text for name in defined)


@pytest.mark.parametrize("force", ["", "-k*phi_dot"])
@pytest.mark.parametrize("torque", ["", "u"])
def test_forces_beside_the_potential_are_printed_before_their_equations(torque, force):
    top = rs.derive(
        "z(phi)",
        ["bias_vector", "accelerations"],
        body=rs.principal_moments(1, 1, 2),
        torque=["0", "0", torque] if torque else (),
        forces={"phi": force} if force else {},
    )
    note = top.note().markdown()
    assert (r"\mathbf{N}' = \begin{pmatrix}" in note) == bool(torque)
    assert ("The non-conservative generalised forces" in note) == bool(force)
    assert (r"\mathbf{W}'^{\mathsf T}\thinspace \mathbf{N}'" in note) == bool(torque)
    assert ("no other forces act" in note) != bool(torque or force)


def test_a_body_alone_has_a_note_and_a_text_without_a_rotation():
    motion = rs.derive("ZXZ", "body", body=rs.solid("cone"))
    document = motion.note().document
    assert "inertia_tensor" in {equation.label for equation in document.equations}
    assert {equation.label for equation in document.equations} <= set(OF_BODY_ALONE)
    (section,) = document.sections
    assert section.title == "The body"
    assert any(isinstance(block, Figure) for block in section.blocks)
    assert "Intrinsic rotations" not in show(motion)


def test_the_body_is_drawn_from_the_back_with_its_holes_and_its_principal_axes():
    drawing, is_principal = body_drawing(drilled())
    assert is_principal
    assert [label.symbol.text for label in drawing.labels] == ["x′", "y′", "z′"]
    facets = [shape for shape in drawing.body if isinstance(shape, Facet)]
    assert sum(getattr(shape, "has_arrow", False) for shape in drawing.body) == 3
    holes = [max(facet.color) <= max(HOLE) for facet in facets]
    assert any(holes)
    assert not all(holes)
    for x, y in (np.array(facet.points).T for facet in facets):
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0  # each is seen from outside
    (row,) = (line for line in drilled().note().markdown().splitlines() if "(hole)" in line)
    assert row.split("|")[2].startswith(" −")


def test_principal_axes_are_named_after_moments_and_angles_without_inertia_are_chosen():
    """Of a rod across a cylinder that is turned about its own axis"""
    part = '{ shape = "cylinder", radius = 0.5, density = "rho", turned = "y(beta) z(alpha)" }'
    rod = '{ shape = "rod", length = 2, mass = 1.5, turned = "y(beta) z(theta)" }'
    motion = motion_in(f'output.quantities = ["body"]\nbody.parts = [{part}, {rod}]\n')
    assert "drawn for" in motion.note().markdown()
    drawing, is_principal = body_drawing(motion)
    assert not is_principal
    assert [label.symbol.text for label in drawing.labels] == ["I₁", "I₂", "I₃"]
