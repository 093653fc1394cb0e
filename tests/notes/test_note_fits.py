"""Every note fits its page: no overfull box and no warning, and long quantities are made short."""

from __future__ import annotations

import pytest
import sympy as sp

import rigidsym as rs
from helpers.printing import text
from helpers.typesetting import warnings_of
from rigidsym.formula.abbreviations import Namer
from rigidsym.formula.display import PAGE, display
from rigidsym.formula.scalars import factored, listed_entries
from rigidsym.mechanics.kinematics.vector_forms import LENGTH
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.rotation import hat
from rigidsym.notes.document import Document, Equation, EquationReference, Paragraph
from rigidsym.notes.equations import equation_of
from rigidsym.notes.letters import length_of, letters_of
from rigidsym.notes.vectors import (
    by_half_angle,
    in_notation,
    rates_of_form,
    sign_outside,
    sum_of_vectors,
)

TURNS = (
    "z(phi)",
    "[1,1,0](beta)",
    "z(phi) y(pi/4) x(delta)",
    "z(phi) x(theta) z(psi) y(delta)",
    "z(a) x(b) z(c) y(d) x(e) z(f)",
)
PASSIVE = ("rotation_vector", "unit_quaternion")
EVERYTHING = (*PARAMETRISATIONS, *PRESETS, *TURNS)
VECTORS = ("rotation_vector", "gibbs_vector", "modified_rodrigues", "quaternion")


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
def test_no_display_is_wider_than_a_page_and_each_name_is_explained_once(documents):
    for document in documents:
        blocks = [block for section in document.sections for block in section.blocks]
        equations = [block for block in blocks if isinstance(block, Equation)]
        for equation in equations:
            shown = display(equation, document.letters, PAGE)
            assert shown.width <= PAGE, (document.title, equation.label)
        explained = [name.text for e in equations if not e.sides for name in e.entries]
        assert len(explained) == len(set(explained)), document.title


# --- the order: names, breaking, shorthand


def _given(document: Document, label: str) -> tuple[Equation, Equation | None]:
    """The equation with a label, and the names that are given before it."""
    blocks = [block for section in document.sections for block in section.blocks]
    place = next(k for k, b in enumerate(blocks) if isinstance(b, Equation) and b.label == label)
    before = blocks[place - 1]
    return blocks[place], before if isinstance(before, Equation) and not before.sides else None


@pytest.mark.parametrize(
    ("rotation", "label", "done", "names"),
    [
        ("ZXZ", "rotation_matrix", "", 0),  # as it stands
        ("z(phi) x(theta) [0,b,c](psi)", "spin_matrix", "", 2),  # a matrix with names for its sums
        ("z(yaw) y(pitch) x(roll)", "rotation_matrix", "abbreviated", 0),  # products: shorthand
        ("z(yaw) y(pitch) x(roll)", "spin_matrix", "", 4),  # entries of Ω: a matrix, not a list
        ("ZXZ", "rotation_rate", "listed", 0),  # an entry a line, and none broken
    ],
)
def test_names_come_before_breaking_and_shorthand(rotation, label, done, names):
    document = rs.derive(rotation).note(style="audit").document
    equation, given = _given(document, label)
    assert display(equation, document.letters, PAGE).done == done
    assert len(given.entries if given else ()) == names


@pytest.mark.campaign
def test_an_energy_that_no_line_can_break_gets_names_first():
    moments = rs.principal_moments(*sp.symbols("A B C"))
    document = rs.derive("rotation_vector", body=moments).note(style="audit").document
    energy, given = _given(document, "rotational_energy")
    assert given is not None
    assert len(given.entries) == 3
    total, again = _given(document, "kinetic_energy")
    assert again is None  # it refers to them
    assert energy.scalar.free_symbols < total.scalar.free_symbols
    blocks = [b for s in document.sections for b in s.blocks if isinstance(b, Paragraph)]
    spans = [span for b in blocks for span in b.text if isinstance(span, EquationReference)]
    assert "rotational_energy" in [span.label for span in spans]


# --- lengths


def test_the_square_of_a_vector_is_that_of_its_length():
    model = rs.RotationVector()
    letters = letters_of(rs.derive(model).arguments, model=model)
    a, b, c = model.coordinates
    square = a**2 + b**2 + c**2
    for expression, expected in (
        (sp.sqrt(square), "n"),
        (sp.sin(sp.sqrt(square)) / square, "sin n/n²"),
        (1 + 2 * square, "1 + 2n²"),
        (sp.Rational(1, 2) * sp.diff(square, sp.Symbol("t")).doit(), "n ṅ"),
        (a**2 + b**2, "v₁² + v₂²"),
        (a**2 + b**2 + 2 * c**2, "v₁² + v₂² + 2v₃²"),
    ):
        assert text(expression, letters) == expected


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
        assert _agree(entry, short.subs(length.rate, rate).subs(length.symbol, square))


def _agree(one: sp.Expr, other: sp.Expr) -> bool:
    """Whether two expressions have the same value at a point, to 40 digits."""
    moving = sorted(one.atoms(sp.Derivative), key=lambda d: (-d.derivative_count, str(d)))
    moving += sorted(one.atoms(sp.core.function.AppliedUndef, sp.Symbol), key=str)
    point = {part: sp.Rational(k + 2, 7) for k, part in enumerate(moving)}
    left, right = (e.xreplace(point).evalf(60) for e in (one, other))
    return bool(abs(left - right) < sp.Float(10) ** -40)


# --- names of parts


def test_named_parts_stand_for_what_they_replace():
    motion = rs.derive("z(k) x(h) z(b) y(d)", only=("rotation_rate",))
    matrix = motion.rotation_rate
    parts, entries = Namer(letters_of(motion.arguments)).named(matrix, 20.0)
    assert {symbol.name[0] for symbol, _ in parts} == {"m"}  # which the model does not use
    for symbol, value in reversed(parts):
        entries = entries.subs(symbol, value)
    assert all(_agree(entry, restored) for entry, restored in zip(matrix, entries, strict=True))


def test_what_cannot_break_gets_a_name():
    a, b = sp.symbols("alpha beta")
    long = sum((a**k * b for k in range(1, 30)), sp.S.Zero)
    ((symbol, value),), short = Namer(letters_of(())).named(
        sp.ImmutableMatrix([a / (b + long)]), 30.0
    )
    assert (value, short[0]) == (b + long, a / symbol)


def test_no_name_is_the_negative_of_another():
    x, y, theta = sp.symbols("x y theta")
    part = (2 * sp.cos(theta) ** 2 - 1) * x
    matrix = sp.ImmutableMatrix([[(y - part) ** 2, sp.sin(y + part)], [(y - part) * x, part * y]])
    parts, short = Namer(letters_of(())).named(matrix, 40.0)
    values = [value for _, value in parts]
    assert values
    assert not any(-value in values for value in values)
    for symbol, value in reversed(parts):
        short = short.subs(symbol, value)
    assert all(_agree(one, other) for one, other in zip(short, matrix, strict=True))


# --- vectors


@pytest.mark.parametrize("name", ["rotation_vector", "quaternion"])
def test_rates_of_vector_forms_are_the_derivatives(name):
    motion = rs.derive(name)
    model, length = motion.model, length_of(motion.model)
    assert length is not None
    v = sp.Matrix(model.vector)
    first, second = v.diff("t"), v.diff("t", 2)
    named = {
        "v": v,
        "v̇": first,
        "v̈": second,
        "v × v̇": v.cross(first),
        "v × v̈": v.cross(second),
        "v × (v × v̈)": v.cross(v.cross(second)),
        "v̇ × (v × v̇)": first.cross(v.cross(first)),
        "v × (v × v̇)": v.cross(v.cross(first)),
        "(v·v̈) v": v.dot(second) * v,
        "(v̇·v̇) v": first.dot(first) * v,
        "(v·v̇) v̇": v.dot(first) * first,
        "(v·v̇) v": v.dot(first) * v,
    }
    size = sp.sqrt(sum(part**2 for part in length.components))
    for frame in ("space", "body"):
        form = in_notation(motion.step(f"angular_velocity_{frame}").vector_form, length)
        expected = getattr(motion, f"angular_acceleration_{frame}")
        for rates in rates_of_form(form, length.rate):
            total = sp.zeros(3, 1)
            for term in rates.terms:
                coefficient = term.coefficient.subs(length.rate, size.diff("t"))
                total += coefficient.subs(length.symbol, size) * named[term.vector.text]
            assert all(_agree(e, t) for e, t in zip(expected, total, strict=True))


@pytest.mark.parametrize(
    ("name", "quantity", "written"),
    [
        ("quaternion", "angular_velocity_space", "(2/n²) (q₀ v̇ + v × v̇ − q̇₀ v)"),
        ("quaternion", "rotation_matrix", "1 + (2/n²) (q₀ C(v) + C(v)²)"),
        ("rotation_vector", "rotation_matrix", "1 + (sin n/n) C(v) + ((1 − cos n)/n²) C(v)²"),
        ("gibbs_vector", "inverse_rate_matrix_body", "½(1 + C(v) + v vᵀ)"),
        ("modified_rodrigues", "inverse_rate_matrix_space", "¼(1 − n²) 1 − ½(C(v) − v vᵀ)"),
        ("axis_angle", "rotation_matrix", "1 + sin φ C(v) + (1 − cos φ) C(v)²"),
        (
            "axis_angle",
            "rates_from_angular_velocity_space",
            "(−½(v × Ω + cot(φ/2) v × (v × Ω)); v·Ω)",
        ),
        (
            "rotation_vector",
            "inverse_rate_matrix_space",
            "1 − ½C(v) + ((2 − n cot(n/2))/(2n²)) C(v)²",
        ),
    ],
)
def test_a_fraction_that_terms_share_is_written_once(name, quantity, written):
    motion = rs.derive(name, quantity)
    letters = letters_of(motion.arguments, model=motion.model)
    form = motion.step(quantity).vector_form
    assert form.proof.is_exact
    assert sum_of_vectors(form, letters).text == written


def test_a_vector_is_called_by_the_letter_of_its_components():
    models = map(rotation_from, ("axis_angle", "gibbs_vector", "modified_rodrigues", "quaternion"))
    assert [letters_of((), model=model).notation.vector for model in models] == list("egsv")


@pytest.mark.parametrize("name", VECTORS[:3])
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
        assert all(_agree(e, t) for e, t in zip(step.expression, total, strict=True))


def test_signs_before_fractions_and_half_angles_change_no_coefficient():
    motion = rs.derive("rotation_vector")
    letters = letters_of(motion.arguments, model=motion.model)
    forms = [step.vector_form for step in motion.steps if step.vector_form is not None]
    assert not any("cos n − " in sum_of_vectors(form, letters).text for form in forms)
    for term in (term for form in forms for term in form.terms):
        minus, coefficient = sign_outside(by_half_angle(term.coefficient))
        for n in (0.3, 2.5, 5.0):
            point = {LENGTH: n, letters.length.rate: 0.7}
            one, other = (float(e.xreplace(point)) for e in (term.coefficient, coefficient))
            assert one == pytest.approx(-other if minus else other, rel=1e-12)


# --- matrices


def test_of_a_symmetric_tensor_six_entries_are_listed_with_both_names():
    motion = rs.derive("ZXZ", ("inertia_tensor_space",), body=rs.general_inertia())
    (step,) = motion.steps
    assert step.expression == step.expression.T
    listed = listed_entries(equation_of(step, motion.arguments).names, step.expression)
    assert [name.text for name, _ in listed] == [
        "I₁₁", "I₁₂ = I₂₁", "I₁₃ = I₃₁", "I₂₂", "I₂₃ = I₃₂", "I₃₃",
    ]  # fmt: skip
    letters = letters_of(motion.arguments)  # the tensor in the body has primes
    names = {letters.name(symbol).text for symbol in step.expression.free_symbols}
    assert {"I′₁₁", "I′₁₂"} <= names


def test_a_factor_of_all_terms_goes_before_the_matrix():
    a, m = sp.symbols("a m", positive=True)
    entries = [11 * a**2 * m + sp.sqrt(13) * a**2 * m, 22 * a**2 * m]
    factor, rest = factored(sp.ImmutableMatrix(entries))
    assert factor == a**2 * m
    assert rest == sp.ImmutableMatrix([11 + sp.sqrt(13), 22])
