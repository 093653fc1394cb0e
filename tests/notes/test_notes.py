"""The note and the terminal text: what they must say, what they must not lose, and the styles."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
import sympy as sp
from click.testing import CliRunner

import rigidsym as rs
from helpers.motions import derived
from helpers.pages import motion_of
from helpers.typesetting import bound_together
from rigidsym.commands import cli
from rigidsym.errors import ModelError
from rigidsym.formula.letters import TIME
from rigidsym.formula.notation import Notation
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.unicode_pen import columns
from rigidsym.mechanics.derivation import Derivation, Place, Proof, Singularity
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles, given, parametrised
from rigidsym.models.rotation import elementary, time_function
from rigidsym.notes.document import Document
from rigidsym.notes.facts.singular import PointFacts
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.note import STYLES, note
from rigidsym.pipeline import output_of, read_spec

ZXZ = "euler_zxz_intrinsic"


@cache
def audit(rotation: str) -> Document:
    motion = derived(rotation)
    return note(motion, module=f"{motion.name}.py").document


def section(document: Document, title: str):
    (found,) = [section for section in document.sections if section.title == title]
    return found


def titles(document: Document) -> list[str]:
    return [section.title for section in document.sections]


@pytest.mark.parametrize("ending", ["tex", "html", "md"])
def test_the_note_of_the_lectures_rotation(golden, ending):
    motion = derived("ZXZ")
    text = note(motion, module=f"{motion.name}.py").render(ending)
    # the inside of MathML is from the LaTeX, by a package whose versions differ in details
    golden(f"notes/{ZXZ}.{ending}", re.sub(r"(<math .*?>).*?</math>", r"\1", text))


# rotations whose notes say what the note of the lecture has no occasion to say
KINDS = {
    "one_turn": "z(phi)",
    "two_turns": "y(phi) x(theta)",
    "four_turns": "z(alpha) [a,b,c](beta) y(alpha0) x(gamma)",
    "quaternion": "quaternion",
    "unit_quaternion": "unit_quaternion",
    "axis_angle": "axis_angle",
}
FILES = ("heavy_symmetric_top", "lecture")


@pytest.mark.parametrize("kind", [*KINDS, *FILES, "passive_vector", "own_matrix", "cone"])
def test_notes_of_every_kind(golden, kind):
    if kind == "passive_vector":
        motion = rs.derive(rs.rotation_from("rotation_vector", passive=True))
    elif kind == "own_matrix":
        a, b = map(time_function, "ab")
        motion = derive(given(elementary("z", a + b), name="own"))
    elif kind == "cone":
        motion = rs.derive("ZXZ", body=rs.solid("cone"))
    elif kind in FILES:
        motion = motion_of(kind)
    else:
        motion = rs.derive(KINDS[kind])
    golden(f"notes/kinds/{kind}.md", note(motion, style="audit").markdown())


def test_rotations_in_a_terminal(golden):
    golden(f"terminal/{ZXZ}_80.txt", show(derived("ZXZ"), width=80) + "\n")
    motion = derive(EulerAngles("ZYX", ("heading", "elevation", "bank"), passive=True))
    golden(f"terminal/{motion.name}_80.txt", show(motion, width=80) + "\n")


def test_every_quantity_is_one_equation_with_its_number_and_function(motion, sequence):
    equations = audit(sequence).equations
    expected = [(step.number, step.quantity.name, step.expression) for step in motion.steps]
    assert [(e.number, e.label, e.matrix) for e in equations] == expected
    assert [e.function for e in equations] == [
        f"{step.quantity.name}({', '.join(step.quantity.inputs)})" for step in motion.steps
    ]
    boxed = [step.quantity.name for step in motion.steps if step.quantity.is_result]
    assert [e.label for e in equations if e.is_result] == boxed


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
    assert {"  ✗ unproved: a = b", "  ✗ (5)  unproved  a = b", "  Δ = ⎢ 0         ⎥"} <= {*lines}
    assert "✗" not in show(derived("ZXZ"))


@pytest.mark.parametrize("width", [80, 120])
def test_no_line_is_wider_than_the_terminal(motion, width):
    assert max(map(columns, show(motion, width=width).splitlines())) <= width


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


def test_a_lecture_has_every_equation_and_leaves_out_what_an_audit_adds():
    lecture, whole = derived("ZXZ").note(style="lecture").document, audit("ZXZ")
    assert [e.number for e in lecture.equations] == [e.number for e in whole.equations]
    assert [e.sides[0] for e in lecture.equations] == [e.sides[0] for e in whole.equations]
    assert all(e.proved and e.function for e in whole.equations)
    assert not any(e.proved or e.function for e in lecture.equations)
    assert titles(lecture)[-1] == "Appendix: identities verified"
    assert titles(whole)[-3:] == ["Identities verified", "Symbols", "Functions"]


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


OTHER = {
    "rates": "fraction",
    "vectors": "arrow",
    "body": "superscript",
    "angular_velocity": "omega",
}


@pytest.mark.parametrize(
    ("choice", "given", "expected"),
    [
        ("rates", r"\dot{\phi}_1", (r"\frac{d\phi_1}{dt}", "dφ₁/dt")),
        (
            "rates",
            r"\frac{d\mathit{heading}}{dt}",
            (r"\frac{d\,\mathit{heading}}{dt}", "d heading/dt"),
        ),
        ("rates", r"\dot{\phi}^2", (r"\Bigl(\frac{d\phi}{dt}\Bigr)^2", "(dφ/dt)²")),
        (
            "rates",
            r"\frac{\partial \mathbf{u}}{\partial \dot{\mathbf{q}}}",
            (r"\frac{\partial \mathbf{u}}{\partial (d\mathbf{q}/dt)}", "∂u/∂(dq/dt)"),
        ),
        ("vectors", r"\boldsymbol{\Omega}'", (r"\vec{\Omega}'", "Ω⃗′")),
        ("vectors", r"\mathbf{R}\,\mathbf{x}", (r"\mathbf{R}\,\vec{x}", "R x⃗")),
        ("body", r"\mathbf{W}'^{-1}", (r"(\mathbf{W}^{\mathrm{B}})^{-1}", "(Wᴮ)⁻¹")),
        ("body", r"\Omega'_1", (r"\Omega^{\mathrm{B}}_1", "Ωᴮ₁")),
        ("angular_velocity", r"\Omega_2", (r"\omega_2", "ω₂")),
    ],
)
def test_symbols_in_another_notation(choice, given, expected):
    notation = Notation(**{choice: OTHER[choice]})
    symbol = notation.applied(formula(given))
    assert (symbol.latex, symbol.text) == expected
    assert notation.applied(symbol) == symbol


def test_the_form_of_the_lectures_equation_18(golden):
    motion = derived("ZXZ").with_notation(rates="fraction")
    shown = show(motion, width=100, notation=motion.notation)
    golden("terminal/euler_zxz_fractions_100.txt", shown)
    latex = motion.note().latex()  # the lecture prints both matrices whole, with small fractions
    assert "\n\\frac{d\\phi}{dt} \\sin\\theta \\sin\\psi + \\frac{d\\theta}{dt} \\cos\\psi" in latex


def test_no_symbol_is_left_in_the_old_notation():
    motion = derived("ZYX", passive=True).with_notation(**OTHER)
    latex = motion.note().latex().split(r"\begin{document}")[1]
    text = show(motion, notation=motion.notation)
    markdown = motion.note().markdown()
    html = motion.note().html().split("</style>")[1]
    for old in (r"\dot{", r"\ddot{", r"\Omega", "x'", r"\boldsymbol"):
        assert old not in latex
        assert old not in markdown
    for old in ("\u0307", "\u0308", "Ω", "′", "˙", "𝛀"):
        assert old not in text
        assert old not in html
    bundle = motion.step("angular_velocity_body")._repr_mimebundle_()
    assert "Ω" not in bundle["text/plain"]
    assert r"\Omega" not in bundle["text/latex"]
    assert motion.kernels().source == derived("ZYX", passive=True).kernels().source


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize("choices", [OTHER, {"rates": "fraction"}, {"body": "superscript"}])
def test_notes_compile_without_a_warning_in_every_notation(choices):
    motions = (derived("ZXZ"), derived("xyz", passive=True))
    notes = [motion.with_notation(**choices).note().latex() for motion in motions]
    assert typeset(bound_together(notes)).warnings == ()


@pytest.mark.parametrize("scalar_last", [False, True])
def test_a_quaternion_is_printed_in_letters_that_are_no_axes(scalar_last):
    """The functions go on taking w, x, y, z, which the note says once."""
    model = parametrised("unit_quaternion", scalar_last=scalar_last)
    motion = rs.derive(model, ["rotation_matrix"])
    note = motion.note()
    order = "xyzw" if scalar_last else "wxyz"
    blocks = [block for section in note.document.sections for block in section.blocks]
    texts = [text_of(block.text) for block in blocks if hasattr(block, "text")]
    assert sum(f"), in programs {', '.join(order)}" in text for text in texts) == 1
    assert r"q_0^2" in note.latex()
    assert "<mi>w</mi>" not in note.html()
    assert motion.argument("q").names == tuple(order)


def test_a_choice_that_is_none_is_refused():
    with pytest.raises(ModelError, match="notation, rates: expected dot or fraction, got 'dots'"):
        derived("ZXZ").with_notation(rates="dots")


@pytest.mark.parametrize("name", ["omega", "Omega_wheel"])
def test_an_angle_called_omega_is_not_mistaken_for_the_angular_velocity(name):
    motion = rs.derive(EulerAngles("ZXZ", (name, "theta", "psi")))
    motion.note()
    with pytest.raises(ModelError, match=f"cannot be called omega beside {name}"):
        motion.with_notation(angular_velocity="omega").note()


def test_options_go_before_the_file_and_check_knows_them(tmp_path: Path):
    file, out = tmp_path / "top.toml", tmp_path / "out"
    text = '[rotation]\nsequence = "ZXZ"\n[notation]\nrates = "fraction"\nbody = "superscript"\n'
    file.write_text(text, "utf-8")
    done = CliRunner().invoke(cli.commands, ["run", str(file), "--rates", "dot", "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert "φ̇ sin θ sin ψ" in done.output
    assert "Ωᴮ" in done.output
    record = json.loads((out / "top" / "top.json").read_text("utf-8"))
    notation = record["request"]["notation"]
    assert (notation["rates"], notation["body"]) == ("dot", "superscript")
    assert CliRunner().invoke(cli.commands, ["check", str(out)]).exit_code == 0
