"""The note and the terminal text: what they must say, what they must not lose, and the styles."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
import sympy as sp

import rigidsym as rs
from helpers.motions import derived
from helpers.typesetting import pages_of
from rigidsym.errors import ModelError
from rigidsym.formula.letters import TIME
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.tree import equal, indexed
from rigidsym.formula.unicode_pen import columns
from rigidsym.mechanics.derivation import Derivation, Place, Proof, Singularity
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles, given
from rigidsym.models.rotation import LECTURE, elementary, time_function
from rigidsym.notes.document import Cited, Document, EquationReference, NoteTable, Paragraph
from rigidsym.notes.equations import equation_of
from rigidsym.notes.facts.singular import PointFacts
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.note import STYLES, note
from rigidsym.notes.words import unit_in_words, with_symbols
from rigidsym.pipeline import motion_of, output_of, read_file, read_spec

ZXZ = "euler_zxz_intrinsic"


@cache
def audit(rotation: str) -> Document:
    motion = derived(rotation)
    return note(motion, module=f"{motion.name}.py").document


def section(document: Document, title: str):
    (found,) = [section for section in document.sections if section.title == title]
    return found


def table(document: Document, title: str) -> NoteTable:
    (found,) = [b for b in section(document, title).blocks if isinstance(b, NoteTable)]
    return found


def titles(document: Document) -> list[str]:
    return [section.title for section in document.sections]


# --- the form, pinned ---


@pytest.mark.parametrize("ending", ["tex", "html", "md"])
def test_the_note_of_the_lectures_rotation(golden, ending):
    motion = derived("ZXZ")
    golden(f"notes/{ZXZ}.{ending}", note(motion, module=f"{motion.name}.py").render(ending))


# rotations whose notes say what the note of the lecture has no occasion to say
KINDS = {
    "one_turn": "z(phi)",
    "two_turns": "y(phi) x(theta)",
    "four_turns": "z(alpha) [a,b,c](beta) y(alpha0) x(gamma)",
    "quaternion": "quaternion",
    "unit_quaternion": "unit_quaternion",
    "axis_angle": "axis_angle",
}


@pytest.mark.parametrize("kind", [*KINDS, "passive_vector", "own_matrix", "cone"])
def test_notes_of_every_kind(golden, kind):
    if kind == "passive_vector":
        motion = rs.derive(rs.rotation_from("rotation_vector", passive=True))
    elif kind == "own_matrix":
        a, b = map(time_function, "ab")
        motion = derive(given(elementary("z", a + b), name="own"))
    elif kind == "cone":
        motion = rs.derive("ZXZ", body=rs.solid("cone"))
    else:
        motion = rs.derive(KINDS[kind])
    golden(f"notes/kinds/{kind}.md", note(motion, style="audit").markdown())


def test_rotations_in_a_terminal(golden):
    golden(f"terminal/{ZXZ}_80.txt", show(derived("ZXZ"), width=80) + "\n")
    motion = derive(EulerAngles("ZYX", ("heading", "elevation", "bank"), passive=True))
    golden(f"terminal/{motion.name}_80.txt", show(motion, width=80) + "\n")


# --- what the note holds ---


def test_every_quantity_is_one_equation_with_its_number_and_function(motion, sequence):
    equations = audit(sequence).equations
    expected = [(step.number, step.quantity.name, step.expression) for step in motion.steps]
    assert [(e.number, e.label, e.matrix) for e in equations] == expected
    assert [e.function for e in equations] == [
        f"{step.quantity.name}({', '.join(step.quantity.inputs)})" for step in motion.steps
    ]
    boxed = [step.quantity.name for step in motion.steps if step.quantity.is_result]
    assert [e.label for e in equations if e.is_result] == boxed


def test_every_claim_stands_in_the_table_of_proofs(motion, sequence):
    rows = table(audit(sequence), "Identities verified").rows
    assert [row[1][0] for row in rows] == [proof.claim for proof in motion.proofs]


def test_a_source_is_listed_once_and_its_places_stand_beside_it():
    quantities = ["inertia_tensor_point", "inertia_tensor_space"]
    made = rs.derive("ZXZ", quantities, body=rs.general_inertia()).note()
    assert len([s for s in made.document.sources if "Landau" in s]) == 1
    assert r"\cite[eq.~32.12]{" in made.latex()


def test_only_the_functions_of_a_module_are_named():
    document = note(derived("ZXZ")).document
    assert not any(equation.function for equation in document.equations)
    assert "Functions" not in titles(document)
    document = note(derived("ZXZ"), module="m.py", functions=["rotation_matrix"]).document
    assert [e.function for e in document.equations if e.function] == ["rotation_matrix(q)"]


@pytest.mark.parametrize("name", ["ZYX", "quaternion", "lecture_angles"])
def test_equation_17_of_the_lecture_is_cited_for_its_own_rotation_only(name):
    document = rs.derive(name).note().document
    blocks = [b for s in document.sections for b in s.blocks if isinstance(b, Paragraph)]
    cited = [span.citation for b in blocks for span in b.text if isinstance(span, Cited)]
    is_cited = (LECTURE, "17") in [(c.text, c.equation) for c in cited]
    assert is_cited is (name == "lecture_angles")


# --- what could not be proved ---


def with_an_unproved_step(motion: Derivation) -> Derivation:
    phi = motion.argument("q").symbols[0]
    left = sp.ImmutableMatrix([sp.sin(phi), 0, 1 - sp.cos(phi)])
    proof = Proof(claim=formula("a = b"), status="unproved", residual=left)
    steps = list(motion.steps)
    steps[4] = replace(steps[4], proofs=(proof,))
    return replace(motion, steps=tuple(steps))


@pytest.mark.parametrize("style", STYLES)
def test_an_unproved_step_shows_in_every_style_and_format(style):
    made = note(with_an_unproved_step(derived("ZXZ")), style=style)
    (equation,) = (e for e in made.document.equations if e.unproved)
    assert (equation.label, equation.proved) == ("angular_velocity_body", ())
    latex = made.latex()
    assert r"\textbf{Unproved}: $a = b$." in latex
    assert r"\textbf{unproved}" in latex
    assert r"\boldsymbol{\Delta} = \begin{pmatrix}" in latex
    assert "<strong>Unproved</strong>" in made.html()
    assert "<td><strong>unproved</strong></td>" in made.html()


def test_an_unproved_step_shows_in_the_terminal():
    lines = show(with_an_unproved_step(derived("ZXZ"))).splitlines()
    assert "  ✗ unproved: a = b" in lines
    assert "  ✗ (5)  unproved  a = b" in lines
    assert "  Δ = ⎢ 0         ⎥" in lines
    assert "✗" not in show(derived("ZXZ"))


# --- the terminal ---


@pytest.mark.parametrize("width", [80, 120])
def test_no_line_is_wider_than_the_terminal(motion, width):
    assert max(map(columns, show(motion, width=width).splitlines())) <= width


def test_styles_of_the_terminal_change_no_column():
    styled = show(derived("ZXZ"), style=lambda words, kind: f"<{kind}>{words}</{kind}>")
    assert "<heading>Euler angles ZXZ, intrinsic</heading>" in styled
    for kind in ("heading", "dim"):
        styled = styled.replace(f"<{kind}>", "").replace(f"</{kind}>", "")
    assert styled == show(derived("ZXZ"))


# --- symbols and units ---


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        ("First φ, then φ\u0307 along the banks.", ["φ", "φ\u0307"]),
        ("The quaternion of a turn is a + v.", ["a"]),  # a is a word, unless a sign follows
        ("First a about z.", ["a"]),  # or an axis
    ],
)
def test_symbols_in_a_sentence_become_formulas(sentence, expected):
    typed = (r"\phi", r"\dot{\phi}", r"\mathit{bank}", "a")
    symbols = {symbol.text: symbol for symbol in map(formula, typed)}
    spans = with_symbols(sentence, symbols)
    assert text_of(spans) == sentence
    assert [span.text for span in spans if not isinstance(span, str)] == expected


@pytest.mark.parametrize(
    ("unit", "expected"), [("rad/s^2", "rad/s²"), ("", "1"), ("kg m^2 s^-1", "kg m² s⁻¹")]
)
def test_units_in_words(unit, expected):
    assert unit_in_words(unit) == expected


def test_names_of_entries():
    motion = derived("ZXZ")
    names = {step.quantity.name: equation_of(step, motion.arguments).names for step in motion.steps}
    assert names["rotation_matrix"][1] == formula("R_{12}")
    assert names["rotation_rate"][8] == formula(r"\dot{R}_{33}")
    assert names["inverse_rate_matrix_space"][1] == formula("(W^{-1})_{12}")
    assert names["angular_velocity_body"][2] == formula(r"\Omega'_3")
    assert names["rates_from_angular_velocity_body"][1].text == "θ\u0307"
    assert names["angular_acceleration_body"][0].latex == r"\dot{\Omega}{}'_1"
    listed = indexed(formula("(k_x, k_y, k_z)"), (3,))
    assert [name.text for name in listed] == ["k_x", "k_y", "k_z"]


def test_what_idle_rates_leave_determined():
    a, b, c = q = [sp.Function(name)(TIME) for name in "abc"]
    rates = [angle.diff(TIME) for angle in q]

    def kept(*idle):
        place = Place(coordinate=b, value=sp.S.Zero, period=2 * sp.pi)
        point = Singularity(
            places=(place,),
            rank=2,
            lost_axis_space=None,
            lost_axis_body=None,
            null_rates=sp.ImmutableMatrix(sp.Matrix([idle]).T),
        )
        return PointFacts(point, q).determined

    assert kept(1, 0, -1) == [a + c]
    assert kept(-1, 0, -1) == [a - c]
    assert kept(2, 0, 3) == [3 * a - 2 * c]
    assert kept(0, 0, 1) == [a]
    assert kept(1, 1, 0) == [rates[0] - rates[1], rates[2]]  # they leave the place b = 0
    assert kept(sp.sqrt(2), 0, 1) == []


# --- styles ---


def test_a_lecture_has_every_equation_and_leaves_out_what_an_audit_adds():
    lecture, whole = derived("ZXZ").note(style="lecture").document, audit("ZXZ")
    assert [e.number for e in lecture.equations] == [e.number for e in whole.equations]
    assert [e.sides[0] for e in lecture.equations] == [e.sides[0] for e in whole.equations]
    assert all(e.proved and e.function for e in whole.equations)
    assert not any(e.proved or e.function for e in lecture.equations)
    assert titles(lecture)[-1] == "Appendix: identities verified"
    assert titles(whole)[-3:] == ["Identities verified", "Symbols", "Functions"]


def test_a_lecture_says_nine_long_entries_by_the_chain_rule():
    document = derived("ZXZ").note().document
    rate = next(e for e in document.equations if e.label == "rotation_rate")
    shown = "dR/dt = φ̇ (∂R/∂φ) + θ̇ (∂R/∂θ) + ψ̇ (∂R/∂ψ)"
    assert (rate.matrix, equal(*rate.sides).text) == (None, shown)


@pytest.mark.parametrize("sequence", ["ZXZ", "XYZ", "zyx"])
@pytest.mark.usefixtures("tex")
def test_a_lecture_on_three_turns_takes_four_pages(sequence):
    assert pages_of(derived(sequence).note().latex()) <= 4


def test_a_file_chooses_the_style_and_the_record_knows_it():
    file = '[rotation]\nsequence = "ZXZ"\n[output]\nnote = ["md"]\nstyle = "audit"\nkernels = []\n'
    spec = read_spec(file, source="top.toml", name="top")
    assert spec.to_data()["style"] == "audit"
    assert "Proved: " in output_of(spec).files["top.md"]
    assert "Proved: " not in output_of(replace(spec, style="lecture")).files["top.md"]
    assert "style" not in replace(spec, style="lecture").to_data()


def test_an_unknown_style_is_named():
    with pytest.raises(
        ModelError, match=r"no style 'book': expected lecture, audit, or .* en/book\.md\.jinja"
    ):
        derived("ZXZ").note(style="book")


# --- the lecture, with its own rotation and with another ---


@cache
def lecture(rotation: str) -> Document:
    if rotation == "lecture":
        (spec,) = read_file("lecture").singles()
        return motion_of(spec).note(style="audit").document
    return rs.derive(rotation, theory=True).note(style="audit").document


@pytest.mark.parametrize("rotation", ["lecture", "unit_quaternion"])
def test_every_symbol_of_the_theory_has_a_meaning_a_unit_and_an_equation_once(rotation):
    document = lecture(rotation)
    rows = table(document, "Symbols").rows
    symbols = [row[0] for row in rows]
    assert len(symbols) == len({*map(str, symbols)})
    assert all(row[1] and row[2] for row in rows)
    meanings = {text_of(row[1]): text_of(row[2]) for row in rows}
    assert meanings["mass of a particle"] == "kg"
    assert meanings["rotation matrix, body to space components"] == "1"
    assert meanings["angular velocity, body components"] == "rad/s"
    assert meanings["kinetic energy"] == "J"  # without a body too
    labels = {getattr(block, "label", "") for s in document.sections for block in s.blocks}
    named = {s.label for row in rows for c in row for s in c if isinstance(s, EquationReference)}
    assert named <= labels


def test_claims_of_the_lecture_are_in_the_order_of_their_equations():
    document = lecture("lecture")
    rows = table(document, "Identities verified").rows
    numbers = [document.number(row[0][0].label) for row in rows]
    assert numbers == sorted(numbers)
    assert document.sections[0].title == "The centre of mass and the kinetic energy"
    product = next(e for e in document.equations if e.number == 17)
    assert (product.label, product.sides[-1].text) == ("rotation_matrix", "R_z(φ) R_x(θ) R_z(ψ)")
