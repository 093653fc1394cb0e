"""What the notes say of rotations, quaternions and vectors is true of the models."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.models.rotation import TIME
from rigidsym.notes.facts.rotation import axes_of_turns
from rigidsym.notes.letters import letters_of
from rigidsym.pipeline import motion_of, read, read_file
from rigidsym.system import resources

COEFFICIENTS = {  # of v × x′ and v × (v × x′), for the length n of the vector
    "rotation_vector": lambda n: (np.sin(n) / n, (1 - np.cos(n)) / n**2),
    "gibbs_vector": lambda n: (2 / (1 + n**2), 2 / (1 + n**2)),
    "modified_rodrigues": lambda n: (4 * (1 - n**2) / (1 + n**2) ** 2, 8 / (1 + n**2) ** 2),
}


def numbers(matrix: sp.MatrixBase, point: dict[sp.Expr, float]) -> np.ndarray:
    """Rates before coordinates, of which they are derivatives."""
    order = sorted(point, key=lambda symbol: not isinstance(symbol, sp.Derivative))
    for symbol in order:
        matrix = matrix.xreplace({symbol: sp.Float(point[symbol])})
    return np.array(matrix, dtype=float)


@pytest.mark.parametrize("name", COEFFICIENTS)
def test_rodrigues_formula_with_these_coefficients_is_the_matrix(name):
    model = rs.derive(name, "rotation_matrix").model
    v, x = np.array([0.3, -0.5, 0.4]), np.array([1.0, 2.0, -0.7])
    matrix = numbers(model.matrix, dict(zip(model.coordinates, v, strict=True)))
    first, second = COEFFICIENTS[name](np.linalg.norm(v))
    expected = x + first * np.cross(v, x) + second * np.cross(v, np.cross(v, x))
    np.testing.assert_allclose(matrix @ x, expected, rtol=1e-12)


def product(p, q):
    (a, u), (b, v) = (p[0], p[1:]), (q[0], q[1:])
    return np.array([a * b - u @ v, *(a * v + b * u + np.cross(u, v))])


def test_the_angular_velocity_is_twice_the_rate_times_the_conjugate():
    motion = rs.derive("quaternion")
    q, rate = np.array([0.8, -0.3, 0.5, 0.2]), np.array([0.1, 0.4, -0.2, 0.3])
    rate -= q * (q @ rate) / (q @ q)  # the length is constant
    coordinates = motion.model.coordinates
    point = dict(zip(coordinates, q, strict=True))
    point |= {c.diff(TIME): r for c, r in zip(coordinates, rate, strict=True)}
    conjugate = q * [1, -1, -1, -1] / (q @ q)
    for name, expected in (
        ("angular_velocity_space", 2 * product(rate, conjugate)),
        ("angular_velocity_body", 2 * product(conjugate, rate)),
    ):
        omega = numbers(getattr(motion, name), point)
        np.testing.assert_allclose([0, *omega.ravel()], expected, atol=1e-14)


def test_a_turn_whose_axis_moves_has_the_angular_velocity_and_the_rates_of_the_note():
    motion = rs.derive("axis_angle")
    e, e_dot, angle, rate = np.array([1, 2, 2]) / 3, np.array([0.2, -0.3, 0.2]), 0.7, 0.4
    coordinates = motion.model.coordinates
    point = dict(zip(coordinates, (*e, angle), strict=True))
    across = np.cross(e, e_dot)
    moved = (1 - np.cos(angle)) * across + np.sin(angle) * e_dot
    rotated = numbers(motion.model.matrix, point) @ across
    np.testing.assert_allclose(across - rotated, moved, atol=1e-14)
    rates = {q.diff(TIME): r for q, r in zip(coordinates, (*e_dot, rate), strict=True)}
    omega = numbers(motion.angular_velocity_space, point | rates).ravel()
    np.testing.assert_allclose(omega, rate * e + moved, atol=1e-14)
    across = np.cross(e, omega)
    expected = -(across + np.cross(e, across) / np.tan(angle / 2)) / 2
    given = dict(zip(motion.argument("omega_space").symbols, omega, strict=True))
    found = numbers(motion.rates_from_angular_velocity_space, given | point)
    np.testing.assert_allclose(found.ravel(), [*expected, e @ omega], atol=1e-14)


@pytest.mark.parametrize("name", ["quaternion", "unit_quaternion", "cayley_klein", "axis_angle"])
def test_the_note_of_each_says_how_it_turns_a_vector(name):
    document = rs.derive(name, "rotation_matrix").note().document
    texts = [equation.sides[0].text for equation in document.displays if equation.sides]
    assert "x" in texts
    assert ("q̇" in texts) is (name != "axis_angle")


def test_extrinsic_rotations_are_the_intrinsic_ones_in_reverse_order():
    (fixed,) = rs.EulerAngles("xyz").convention
    (moving,) = rs.EulerAngles("ZYX", ("psi", "theta", "phi")).convention
    _, _, equivalent = fixed.partition("Equivalently, i")
    assert moving == f"I{equivalent}"


def test_a_chain_adds_its_axes_as_the_factors_before_carry_them_along():
    motion = rs.derive("z(a) x(b) z(c) x(d) y(e) z(f)")
    axes = axes_of_turns(motion.model, letters_of(motion.arguments))
    assert [axis.text for axis in axes] == ["n₁", *(f"P{a} n{b}" for a, b in pairwise("₁₂₃₄₅₆"))]


SHIPPED = resources.names("derivations", ".toml")
EXCHANGED = r"Aerospace texts write $\psi$ for the yaw and $\phi$ for the roll."
READ_AND_MENDED = {  # by file or rotation: what its note says, and what it must not say
    "z(a) x(b) z(c) x(d) y(e) z(f)": (
        (r"first $a$ about $z$", r"Each factor $\mathbf{T} _k$ is the rotation by $\theta _k$"),
        ("Rotation k", "where they are not determined", r"\dot{q}_1"),
    ),
    "lecture": (
        (
            r"I' _{11}\thinspace {\Omega' _1}^2",
            r"L' _{R,1} = I' _{11}\thinspace \Omega' _1",
            "only through its second moments",
            "entries (3,2), (1,3) and (2,1)",
            "# Kinetic energy, inertia tensor and angular momentum of a rigid body",
        ),
        ("might have mattered", "below the diagonal", "The motion of a rigid body"),
    ),
    "heavy_symmetric_top": (
        (
            r"If $A \cos\theta$ is 0, there is one rate only:",
            "every axis perpendicular to $z$",
            "stays between the circles",
        ),
        ("every axis across", "in the time shown"),
    ),
    "kovalevskaya_top": (
        ("in the time shown", "E. Husson, Recherche des intégrales", "S. L. Ziglin, Branching"),
        ("stays between the circles",),
    ),
    "free_body": (("where $a$, $b$ and $c$ are positive, or two of them are negative,",), ()),
    "ZYX": ((EXCHANGED,), ()),
    "aerospace": ((), ("Aerospace texts write",)),
    "XYZ": ((), ("Aerospace texts write",)),
}


@pytest.mark.parametrize("name", READ_AND_MENDED)
def test_sentences_that_readers_found_wrong_are_right(name):
    (spec,) = read_file(name).singles() if name in SHIPPED else (read(name),)
    said = motion_of(spec).note(style=spec.style).markdown()
    right, wrong = READ_AND_MENDED[name]
    assert [words for words in right if words not in said] == []
    assert [words for words in wrong if words in said] == []
