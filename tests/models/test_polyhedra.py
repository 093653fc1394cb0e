"""Solids between flat faces: closed, of one sense, and no different from a shape of the list."""

from __future__ import annotations

import pytest
import sympy as sp

from rigidsym.errors import BodyError
from rigidsym.mechanics.mass.bodies import body_of, solid
from rigidsym.models.body import Known, Outline, Polyhedron

M, a, b, c = sp.symbols("M a b c")
CUBE = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))


def cube(faces=CUBE, side=a) -> Polyhedron:
    vertices = tuple(
        sp.ImmutableMatrix([x * side, y * side, z * side]) for z in (0, 1) for x, y in SQUARE
    )
    return Polyhedron(vertices=vertices, faces=faces, mass=M)


def test_a_cube_by_its_faces_is_a_box():
    found = body_of(cube())
    assert found.inertia == solid("box").inertia.subs({b: a, c: a}).applyfunc(sp.factor)
    assert found.centre == sp.ImmutableMatrix([a / 2] * 3)


@pytest.mark.parametrize(
    ("faces", "fault"),
    [
        (CUBE[1:], "the surface is open: the edge 4–0 of face 1 has no other face|is open"),
        ((CUBE[0][::-1], *CUBE[1:]), "in the same direction; one of them is turned over"),
        (((0, 1), *CUBE[1:]), "face 0: expected three or more different corners"),
        (((0, 1, 9), *CUBE[1:]), "face 0: corners are numbered from 0 to 7"),
    ],
)
def test_open_and_torn_surfaces_are_refused(faces, fault):
    with pytest.raises(BodyError, match=fault):
        cube(faces)


def test_a_surface_inside_out_is_refused_with_its_volume():
    inverted = cube(tuple(face[::-1] for face in CUBE), side=sp.Integer(2))
    with pytest.raises(BodyError, match="inside out: its volume is -8 m³"):
        body_of(inverted)


def test_given_mass_properties_need_no_outline():
    known = Known(sp.Integer(1), sp.ImmutableMatrix([0, 0, 0]), sp.ImmutableMatrix(sp.eye(3)))
    assert known.outline == Outline()
