"""Every note fits its page: no overfull box and no warning, and long quantities are made short."""

from __future__ import annotations

import pytest
import sympy as sp

import rigidsym as rs
from helpers.motions import values_for
from helpers.typesetting import warnings_of
from helpers.witness import agree, evaluate
from rigidsym.formula.display import PAGE, display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.mechanics.kinematics.workspace import LENGTH
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.rotation import hat
from rigidsym.notes import fitting
from rigidsym.notes.document import Document, Equation
from rigidsym.notes.equations import by_half_angle, sign_outside, sum_of_vectors
from rigidsym.notes.letters import length_of, letters_of

TURNS = (
    "z(phi)",
    "[1,1,0](beta)",
    "z(phi) y(pi/4) x(delta)",
    "z(phi) x(theta) z(psi) y(delta)",
    "z(a) x(b) z(c) y(d) x(e) z(f)",
)
PASSIVE = ("rotation_vector", "unit_quaternion")
EVERYTHING = (*PARAMETRISATIONS, *PRESETS, *TURNS)
VECTORS = ("rotation_vector", "gibbs_vector", "modified_rodrigues")


@pytest.fixture(scope="module")
def documents() -> list[Document]:
    """A note of each, and of the passive form of some; no two of one name."""
    motions = [rs.derive(rotation_from(text)) for text in EVERYTHING]
    motions += [rs.derive(rotation_from(text, passive=True)) for text in PASSIVE]
    moments = rs.principal_moments(*sp.symbols("A B C"))
    motions += [rs.derive("rotation_vector", body=moments)]
    motions += [rs.derive("ZXZ", body=rs.general_inertia())]
    return [motion.note(style="audit").document for motion in motions]


@pytest.mark.usefixtures("tex")
def test_every_note_compiles_without_a_warning(documents):
    assert warnings_of(documents) == ()


@pytest.mark.campaign
def test_no_display_is_wider_than_a_page(documents):
    for document in documents:
        blocks = [block for section in document.sections for block in section.blocks]
        equations = [block for block in blocks if isinstance(block, Equation)]
        for equation in equations:
            shown = display(equation, document.letters, PAGE, LatexPen(document.letters.notation))
            assert shown.width <= PAGE, (document.title, equation.label)


def test_what_is_too_long_is_left_out_behind_its_definition(monkeypatch):
    monkeypatch.setattr(fitting, "_MOST_LINES", 3)
    motion = rs.derive("ZXZ", ("rotational_energy",), body=rs.general_inertia())
    equations = {equation.label: equation for equation in motion.note().document.equations}
    energy = equations["rotational_energy"]
    assert (len(energy.sides), energy.scalar, energy.is_result) == (2, None, False)
    assert "too long for this page" in motion.note().markdown()


@pytest.mark.parametrize("name", ["rotation_vector", "quaternion"])
def test_lengths_change_no_value(name):
    motion = rs.derive(name, only=("rotation_rate", "angular_acceleration_space"))
    length = length_of(motion.model)
    assert length is not None
    rate = sum(q * sp.diff(q, "t") for q in length.components) / length.symbol
    square = sp.sqrt(sum(q**2 for q in length.components))
    for entry in (entry for step in motion.steps for entry in step.expression[:2]):
        short = length.shortened(entry)
        assert short.has(length.symbol)
        plain = short.subs(length.rate, rate).subs(length.symbol, square)
        assert agree(*(evaluate(sp.Matrix([e]), values_for(motion)) for e in (entry, plain)))


@pytest.mark.parametrize("name", VECTORS)
def test_matrices_of_a_vector_are_shown_as_such(name):
    motion = rs.derive(name)
    v = sp.Matrix(motion.model.vector)
    skew, size = hat(v), sp.sqrt(v.dot(v))
    named = {"1": sp.eye(3), "C(v)": skew, "C(v)²": skew * skew, "v vᵀ": v * v.T}
    shown = {s.quantity.name: s for s in motion.steps if s.vector_form is not None}
    assert {"rotation_matrix", "rate_matrix_space", "inverse_rate_matrix_body"} <= shown.keys()
    for step in (step for step in shown.values() if step.expression.shape == (3, 3)):
        total = sp.zeros(3, 3)
        for term in step.vector_form.terms:
            coefficient = term.coefficient.subs(step.vector_form.length, size)
            total += coefficient * named[term.vector.text]
        assert agree(*(evaluate(m, values_for(motion)) for m in (step.expression, total)))


def test_signs_before_fractions_and_half_angles_change_no_coefficient():
    motion = rs.derive("rotation_vector")
    letters = letters_of(motion.arguments, model=motion.model)
    forms = [step.vector_form for step in motion.steps if step.vector_form is not None]
    assert not any("cos n − " in sum_of_vectors(form, letters).text for form in forms)
    for term in (term for form in forms for term in form.terms):
        minus, coefficient = sign_outside(by_half_angle(term.coefficient))
        for n in (0.3, 2.5, 5.0):
            one, other = (float(e.xreplace({LENGTH: n})) for e in (term.coefficient, coefficient))
            assert one == pytest.approx(-other if minus else other, rel=1e-12)
