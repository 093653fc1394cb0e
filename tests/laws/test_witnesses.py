"""Three witnesses for all 24 conventions: mpmath, SciPy and sympy.physics.vector.

None of them shares code with the derivation; the expressions are compared in numbers.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation
from sympy.physics.vector import ReferenceFrame, dynamicsymbols

from helpers.witness import CONVENTIONS, agree, evaluate, mp, paths, rotation, unhat, values_along
from rigidsym.mechanics.derivation import Derivation
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles

ANGLES = dynamicsymbols("phi theta psi")
PATHS = paths(2, seed=2)
# SciPy's error: up to 5 eps by rounding three angles of up to 3, 12 by two products of quaternions
# with their sines, which count twice, and 2 by the entries of the matrix; one eps was seen.
DOUBLE = 20 * np.finfo(float).eps

every_convention = pytest.mark.parametrize("convention", CONVENTIONS)


@cache
def motion(convention: str) -> Derivation:
    return derive(EulerAngles(convention))


def printed(convention: str, quantity: str, path):
    return evaluate(getattr(motion(convention), quantity), values_along(ANGLES, path))


@every_convention
def test_scipy_has_the_same_rotation(convention):
    for path in PATHS:
        angles = [float(angle) for angle in path.q]
        theirs = Rotation.from_euler(convention, angles).as_matrix()
        ours = np.array(printed(convention, "rotation_matrix", path).tolist(), dtype=float)
        assert np.abs(ours - theirs).max() <= DOUBLE


@every_convention
def test_sympy_has_the_same_rotation_and_velocities(convention):
    space = ReferenceFrame("N")
    manner = "Body" if convention.isupper() else "Space"
    body = space.orientnew("B", manner, ANGLES, convention.upper())
    omega = body.ang_vel_in(space)
    theirs = {
        "rotation_matrix": space.dcm(body),
        "angular_velocity_space": omega.to_matrix(space),
        "angular_velocity_body": omega.to_matrix(body),
    }
    for quantity, expression in theirs.items():
        assert sp.count_ops(getattr(motion(convention), quantity)) <= sp.count_ops(expression)
        for path in PATHS:
            values = values_along(ANGLES, path)
            assert agree(printed(convention, quantity, path), evaluate(expression, values))


def test_a_wrong_convention_is_seen_by_each_witness():
    """The witnesses tell the conventions apart, so that their agreement says something."""
    (path,) = paths(1, seed=3)
    curves = [lambda t, c=convention: rotation(c, path.at(t)) for convention in CONVENTIONS]
    for some in ([R(0) for R in curves], [unhat(mp.diff(R, 0) * R(0).T) for R in curves]):
        for k, one in enumerate(some):
            assert not any(agree(one, other) for other in some[:k])
