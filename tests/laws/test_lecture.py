"""The formulas of the lecture, typed from its page, are the formulas of the derivation.

Compared by ==, which in SymPy is equality of the form and not only of the value.
"""

from __future__ import annotations

import pytest
import sympy as sp
from sympy import cos, sin
from sympy.physics.vector import dynamicsymbols

from rigidsym.mechanics.derive import derive
from rigidsym.models.library import PRESETS
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.models.rotation import SOURCES, lecture

phi, theta, psi = dynamicsymbols("phi theta psi")
phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)


def typed(*rows: str) -> sp.ImmutableMatrix:
    """A matrix in the letters c and s of the angles f, t and p, with their rates F, T and P."""
    names = {
        f"{name}{angle}": function(q)
        for name, function in (("c", cos), ("s", sin))
        for angle, q in (("f", phi), ("t", theta), ("p", psi))
    }
    names |= {"F": phi_dot, "T": theta_dot, "P": psi_dot}
    return sp.ImmutableMatrix([[sp.sympify(e, names) for e in row.split(",")] for row in rows])


R_PRINTED = typed(
    "cf*cp - sf*sp*ct, -cf*sp - sf*cp*ct, sf*st",
    "sf*cp + cf*sp*ct, cf*cp*ct - sf*sp, -cf*st",
    "sp*st, cp*st, ct",
)
SPIN_PRINTED = typed(
    "0, -F - P*ct, sf*T - P*cf*st",
    "F + P*ct, 0, -P*sf*st - cf*T",
    "P*cf*st - sf*T, P*sf*st + cf*T, 0",
)
OMEGA_PRINTED = typed("P*sf*st + cf*T", "sf*T - P*cf*st", "F + P*ct")
EQUATION_18 = typed("F*sp*st + T*cp", "F*st*cp - T*sp", "F*ct + P")


MODEL = EulerAngles("ZXZ", angles=("phi", "theta", "psi"))
MOTION = derive(MODEL)


@pytest.mark.parametrize(
    ("quantity", "printed"),
    [
        ("rotation_matrix", R_PRINTED),
        ("spin_matrix", SPIN_PRINTED),
        ("angular_velocity_space", OMEGA_PRINTED),
        ("angular_velocity_body", EQUATION_18),
    ],
    ids=["R", "dR/dt R^T", "Omega", "equation 18"],
)
def test_derived_term_by_term(quantity, printed):
    derived = getattr(MOTION, quantity)
    assert derived.shape == printed.shape
    for entry, expected in zip(derived, printed, strict=True):
        assert entry == expected


def test_equation_17_is_the_product_as_written():
    """Of R_z and R_x as the lecture prints them below it."""

    def turn_z(beta):
        return sp.Matrix([[cos(beta), -sin(beta), 0], [sin(beta), cos(beta), 0], [0, 0, 1]])

    turn_x = sp.Matrix([[1, 0, 0], [0, cos(theta), -sin(theta)], [0, sin(theta), cos(theta)]])
    assert MODEL.matrix == turn_z(phi) * turn_x * turn_z(psi)
    assert EulerAngles("313") == MODEL
    # "for θ = 0 all φ and ψ of one sum lead to one orientation"
    assert [p.places[0].value for p in MOTION.singularities.points] == [0, sp.pi]
    assert [tuple(p.null_rates) for p in MOTION.singularities.points] == [(1, 0, -1), (1, 0, 1)]
    level = MOTION.rotation_matrix.subs(theta, 0) - turn_z(phi + psi).applyfunc(sp.expand_trig)
    assert level.applyfunc(sp.expand) == sp.zeros(3)


def test_sources_are_published_books_and_the_lecture_for_its_own_angles():
    sources = {step.quantity.name: step.quantity.source for step in MOTION.steps}
    assert sources["rotation_matrix"] == SOURCES["Landau 35"]
    assert sources["spin_matrix"] == sources["angular_velocity_body"] == SOURCES["Murray 2.4"]
    assert PRESETS["lecture_angles"].source == lecture("17", "section 3.2")
