"""What holds for the 24 conventions of Euler angles: singular angles, short forms, kinship."""

from __future__ import annotations

from itertools import pairwise

import pytest
import sympy as sp

from helpers.parametrisations import MOVING, Moving
from helpers.witness import CONVENTIONS, mp, number

every_case = pytest.mark.parametrize("m", [m for m in MOVING if m.text in CONVENTIONS], ids=repr)


# Singular angles


@every_case
def test_determinant_is_that_of_both_rate_matrices(m: Moving):
    value = number(m.motion.singularities.determinant, dict(m.values))
    for matrix in (m.rate_matrix_space, m.rate_matrix_body):
        assert abs(mp.det(matrix) - value) < mp.mpf(10) ** -40


@every_case
def test_the_stated_angles_are_all(m: Moving):
    """Between them the determinant keeps its sign, so that a count of changes finds them all."""
    found = m.motion.singularities
    middle = m.motion.model.coordinates[1]
    assert found.is_solved
    assert found.determinant.atoms(sp.Function) <= {middle, sp.sin(middle), sp.cos(middle)}
    half = sp.pi / 2
    first, _, last = m.text.lower()
    expected = {0, sp.pi} if first == last else {-half, half}
    places = [place for point in found.points for place in point.places]
    assert {place.value for place in places} == expected
    assert {place.coordinate for place in places} == {middle}
    assert {place.period for place in places} == {2 * sp.pi}
    grid = [2 * mp.pi * (k + mp.mpf(1) / 3) / 97 for k in range(98)]
    signs = [mp.sign(number(found.determinant, {middle: angle})) for angle in grid]
    changes = sum(a != b for a, b in pairwise(signs))
    assert changes == len(found.points)


# Forms
