"""The note and the terminal text: what they must say, what they must not lose, what they escape."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import sympy as sp

import rigidsym as rs
from helpers.motions import derived
from rigidsym.formula.letters import TIME
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.tree import indexed
from rigidsym.formula.unicode_pen import columns
from rigidsym.mechanics.derivation import Derivation, Place, Proof, Singularity
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles, given
from rigidsym.models.rotation import (
    LECTURE,
    Citation,
    RotationModel,
    elementary,
    time_function,
)
from rigidsym.notes.compose import equation_of
from rigidsym.notes.document import (
    Cited,
    Document,
    NoteTable,
    Paragraph,
)
from rigidsym.notes.facts.singular import PointFacts
from rigidsym.notes.formats.escape import escape
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.note import Note, note
from rigidsym.notes.words import unit_in_words, with_symbols

ZXZ = "euler_zxz_intrinsic"


def _note(motion: Derivation) -> Note:
    return note(motion, module=f"{motion.name}.py")


def _words(document: Document) -> str:
    """All running text of a note."""
    blocks = [block for section in document.sections for block in section.blocks]
    return "\n".join(text_of(block.text) for block in blocks if isinstance(block, Paragraph))


def _two_turns(**changes: object) -> RotationModel:
    a, b = time_function("a"), time_function("b")
    data = {
        "name": "two_turns",
        "title": "Two turns",
        "convention": ("Turns about two axes.",),
        "coordinates": (a, b),
        "matrix": elementary("z", a) * elementary("x", b),
        "source": Citation(text="A book"),
    }
    return RotationModel(**(data | changes))


def _with_an_unproved_step(motion: Derivation) -> Derivation:
    phi = motion.argument("q").symbols[0]
    left = sp.ImmutableMatrix([sp.sin(phi), 0, 1 - sp.cos(phi)])
    proof = Proof(claim=formula("a = b"), status="unproved", residual=left)
    steps = list(motion.steps)
    steps[4] = replace(steps[4], proofs=(proof,))
    return replace(motion, steps=tuple(steps))


# --- the form, pinned ---


def test_the_note_of_the_lectures_rotation(golden):
    golden(f"notes/{ZXZ}.tex", _note(derived("ZXZ")).latex())


def test_the_lectures_rotation_in_a_terminal(golden):
    golden(f"terminal/{ZXZ}_80.txt", show(derived("ZXZ"), width=80) + "\n")


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
    a, b = map(time_function, "ab")
    if kind == "passive_vector":
        motion = rs.derive(rs.rotation_from("rotation_vector", passive=True))
    elif kind == "own_matrix":
        motion = derive(given(elementary("z", a + b), name="own"))
    elif kind == "cone":
        motion = rs.derive("ZXZ", body=rs.solid("cone"))
    else:
        motion = rs.derive(KINDS[kind])
    golden(f"notes/kinds/{kind}.md", note(motion, style="audit").markdown())


def test_a_passive_rotation_in_a_terminal(golden):
    motion = derive(EulerAngles("ZYX", ("heading", "elevation", "bank"), passive=True))
    golden(f"terminal/{motion.name}_80.txt", show(motion, width=80) + "\n")


# --- what the note holds ---


def test_every_quantity_is_one_equation_with_its_number(motion):
    equations = list(_note(motion).document.equations)
    expected = [(step.number, step.quantity.name, step.expression) for step in motion.steps]
    assert [(e.number, e.label, e.matrix) for e in equations] == expected


def test_every_equation_names_the_function_that_evaluates_it(motion):
    calls = [e.function for e in _note(motion).document.equations]
    assert calls[4] == "angular_velocity_body(q, q_dot)"
    assert all(
        call == f"{step.quantity.name}({', '.join(step.quantity.inputs)})"
        for call, step in zip(calls, motion.steps, strict=True)
    )


def test_results_stand_in_boxes_and_steps_do_not(motion):
    made = _note(motion)
    boxed = [e.label for e in made.document.equations if e.is_result]
    assert boxed == [step.quantity.name for step in motion.steps if step.quantity.is_result]
    assert 0 < len(boxed) < len(motion.steps)
    for text in (made.latex(), made.markdown()):
        assert text.count(r"\boxed{") == len(boxed)
    displays = made.html().split('<div class="equation"')[1:]
    shown = [re.match(r' id="(\w+)"', text) for text in displays if 'class="boxed"' in text]
    assert [found and found[1] for found in shown] == boxed


def test_a_source_is_listed_once_and_its_places_stand_beside_it():
    quantities = ["inertia_tensor_point", "inertia_tensor_space"]
    motion = rs.derive("ZXZ", quantities, body=rs.general_inertia())
    made = motion.note()
    assert len([s for s in made.document.sources if "Landau" in s]) == 1
    assert r"\cite[eq.~32.12]{" in made.latex()


def test_only_the_functions_of_a_module_are_named():
    document = note(derived("ZXZ")).document
    assert not any(equation.function for equation in document.equations)
    assert "Functions" not in [section.title for section in document.sections]
    document = note(derived("ZXZ"), module="m.py", functions=["rotation_matrix"]).document
    assert [e.function for e in document.equations if e.function] == ["rotation_matrix(q)"]


def test_every_claim_stands_in_the_table_of_proofs(motion):
    (section,) = (s for s in _note(motion).document.sections if s.title == "Identities verified")
    (table,) = (block for block in section.blocks if isinstance(block, NoteTable))
    shown = [row[1][0] for row in table.rows]
    assert shown == [proof.claim for proof in motion.proofs]


# --- what could not be proved ---


def test_an_unproved_step_shows_in_the_note():
    document = _note(_with_an_unproved_step(derived("ZXZ"))).document
    (equation,) = (e for e in document.equations if e.unproved)
    assert (equation.label, equation.proved) == ("angular_velocity_body", ())
    latex = _note(_with_an_unproved_step(derived("ZXZ"))).latex()
    assert r"\textbf{Unproved}: $a = b$." in latex
    assert r"\textbf{unproved}" in latex
    assert r"\boldsymbol{\Delta} = \begin{pmatrix}" in latex
    assert r"1 - \cos\phi" in latex


def test_an_unproved_step_shows_in_the_terminal():
    lines = show(_with_an_unproved_step(derived("ZXZ"))).splitlines()
    assert "  ✗ unproved: a = b" in lines
    assert "  ✗ (5)  unproved  a = b" in lines
    assert "  Δ = ⎢ 0         ⎥" in lines
    assert "✗" not in show(derived("ZXZ"))


# --- the terminal ---


@pytest.mark.parametrize("width", [80, 88, 100, 120])
def test_no_line_is_wider_than_the_terminal(motion, width):
    assert max(map(columns, show(motion, width=width).splitlines())) <= width


def test_styles_change_no_column():
    bare = show(derived("ZXZ"))
    styled = show(derived("ZXZ"), style=lambda words, kind: f"<{kind}>{words}</{kind}>")
    assert "<heading>Euler angles ZXZ, intrinsic</heading>" in styled
    for kind in ("heading", "dim"):
        styled = styled.replace(f"<{kind}>", "").replace(f"</{kind}>", "")
    assert styled == bare


# --- words ---


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
    found = with_symbols(sentence, symbols)
    assert text_of(found) == sentence
    assert [span.text for span in found if not isinstance(span, str)] == expected


@pytest.mark.parametrize(
    ("unit", "expected"), [("rad/s^2", "rad/s²"), ("", "1"), ("kg m^2 s^-1", "kg m² s⁻¹")]
)
def test_units_in_words(unit, expected):
    assert unit_in_words(unit) == expected


def test_what_idle_rates_leave_determined():
    a, b, c = q = [sp.Function(name)(TIME) for name in "abc"]
    rates = [angle.diff(TIME) for angle in q]

    def kept(*idle, at=b):
        place = Place(coordinate=at, value=sp.S.Zero, period=2 * sp.pi)
        columns = sp.ImmutableMatrix(sp.Matrix([idle]).T)
        found = Singularity(
            places=(place,), rank=2, lost_axis_space=None, lost_axis_body=None, null_rates=columns
        )
        return PointFacts(found, q).determined

    assert kept(1, 0, -1) == [a + c]
    assert kept(-1, 0, -1) == [a - c]
    assert kept(2, 0, 3) == [3 * a - 2 * c]
    assert kept(0, 0, 1) == [a]
    assert kept(1, 1, 0) == [rates[0] - rates[1], rates[2]]  # they leave the place b = 0
    assert kept(sp.sqrt(2), 0, 1) == []


def test_the_entries_of_a_listed_symbol_are_what_it_lists():
    names = indexed(formula("(k_x, k_y, k_z)"), (3,))
    assert [(name.latex, name.text) for name in names] == [("k_x",) * 2, ("k_y",) * 2, ("k_z",) * 2]


def test_names_of_entries():
    motion = derived("ZXZ")
    names = {step.quantity.name: equation_of(step, motion.arguments).names for step in motion.steps}
    assert names["rotation_matrix"][1] == formula("R_{12}")
    assert names["rotation_rate"][8] == formula(r"\dot{R}_{33}")
    assert names["rate_matrix_body"][0] == formula("W'_{11}")
    assert names["inverse_rate_matrix_space"][1] == formula("(W^{-1})_{12}")
    assert names["angular_velocity_body"][2] == formula(r"\Omega'_3")
    assert names["rates_from_angular_velocity_body"][1].text == "θ\u0307"
    assert names["angular_acceleration_body"][0].latex == r"\dot{\Omega}{}'_1"


# --- escaping ---


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("50 % of A_1 & {B} #1 $x$", r"50 \% of A\_1 \& \{B\} \#1 \$x\$"),
        (r"\input{x}", r"\textbackslash{}input\{x\}"),
        ("a^b ~c", r"a\textasciicircum{}b \textasciitilde{}c"),
        ('<b>|"`', r"\textless{}b\textgreater{}\textbar{}\textquotedbl{}\textasciigrave{}"),
        ("a -- b --- c", "a -{}- b -{}-{}- c"),
        ("''", "'{}'"),
        ("φ Ω λ", r"\ensuremath{\phi} \ensuremath{\Omega} \ensuremath{\lambda}"),
        ("φ\u0307 x\u0308", r"\ensuremath{\dot{\phi}} \"{x}"),
        ("Rᵀ s⁻²", r"R\ensuremath{^{\mathsf T}} s\ensuremath{^{-}}\ensuremath{^{2}}"),
        ("café – déjà", "café – déjà"),
        ("中 Ħ", "[U+4E2D] [U+0126]"),
        ("a\tb\nc\u0000", "a b c "),
        ("a\u00a0b", "a~b"),
    ],
)
def test_any_text_becomes_latex_text(text, expected):
    assert escape(text) == expected


def test_markup_in_a_title_and_a_source_comes_out_as_text():
    odd = r"50% \input{x} & $\alpha$"
    model = _two_turns(title=odd, source=Citation(text=odd, equation="#1"))
    latex = note(derive(model)).latex()
    assert odd not in latex
    assert latex.count(escape(odd)) == 2
    assert r"\cite[eq.~\#1]{two_turns:source-1}" in latex


# --- prose and symbols follow the model


@pytest.mark.parametrize(
    "name", ["ZYX", "zxz", "z(phi) x(theta) [0,b,c](psi)", "z(a) x(b)", "quaternion"]
)
def test_equation_17_of_the_lecture_is_cited_for_its_own_rotation_only(name):
    places = [(s.text, s.equation) for s in _cited(rs.derive(name).note().document)]
    assert (LECTURE, "17") not in places
    own = rs.derive("lecture_angles").note().document
    assert (LECTURE, "17") in [(s.text, s.equation) for s in _cited(own)]


def _cited(document: Document) -> list[Citation]:
    texts = [
        block.text
        for section in document.sections
        for block in section.blocks
        if isinstance(block, Paragraph)
    ]
    return [span.citation for text in texts for span in text if isinstance(span, Cited)]
