"""Notation is the user's: one choice, the same in LaTeX, HTML, Markdown and the terminal."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.motions import derived
from helpers.typesetting import bound_together
from rigidsym import pipeline
from rigidsym.commands import cli
from rigidsym.errors import ModelError, SpecError
from rigidsym.formula.notation import CHOICES, DEFAULT, Notation
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.unicode_pen import columns
from rigidsym.models.parametrisations import EulerAngles, UnitQuaternion
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import read_file, read_record, read_spec

OTHER = {
    "rates": "fraction",
    "vectors": "arrow",
    "body": "superscript",
    "angular_velocity": "omega",
}
ONE_AT_A_TIME = [{name: choice} for name, choice in OTHER.items()]
FILE = '[rotation]\nsequence = "ZXZ"\n'


@pytest.mark.parametrize(
    ("choice", "given", "expected"),
    [
        ("rates", r"\dot{\phi}_1", (r"\frac{d\phi_1}{dt}", "dφ₁/dt")),
        ("rates", r"\ddot{\phi}", (r"\frac{d^2\phi}{dt^2}", "d²φ/dt²")),
        (
            "rates",
            r"\frac{d\mathit{heading}}{dt}",
            (r"\frac{d\,\mathit{heading}}{dt}", "d heading/dt"),
        ),
        ("rates", r"\dot{\mathbf{r}}_C", (r"\frac{d\mathbf{r}_C}{dt}", "dr_C/dt")),
        ("rates", r"\dot{\phi}^2", (r"\Bigl(\frac{d\phi}{dt}\Bigr)^2", "(dφ/dt)²")),
        (
            "rates",
            r"\frac{\partial \mathbf{u}}{\partial \dot{\mathbf{q}}}",
            (r"\frac{\partial \mathbf{u}}{\partial (d\mathbf{q}/dt)}", "∂u/∂(dq/dt)"),
        ),
        ("vectors", r"\boldsymbol{\Omega}'", (r"\vec{\Omega}'", "Ω⃗′")),
        ("vectors", r"\Omega'_1", (r"\Omega'_1", "Ω′₁")),
        ("vectors", r"\mathbf{R}\,\mathbf{x}", (r"\mathbf{R}\,\vec{x}", "R x⃗")),
        ("body", r"\mathbf{W}'^{-1}", (r"(\mathbf{W}^{\mathrm{B}})^{-1}", "(Wᴮ)⁻¹")),
        ("body", r"\mathbf{W}'^{+}", (r"(\mathbf{W}^{\mathrm{B}})^+", "(Wᴮ)⁺")),
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
    assert r"\frac{d\psi}{dt} \cos\phi \sin\theta - \frac{d\theta}{dt} \sin\phi &" in latex


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


@pytest.mark.parametrize("choices", [OTHER, *ONE_AT_A_TIME], ids=lambda c: "-".join(c.values()))
def test_lines_fit_the_terminal_in_every_notation(choices):
    lines = show(derived("ZXZ"), width=100, notation=Notation(**choices)).splitlines()
    assert max(map(columns, lines)) <= 100
    assert {*OTHER} == {*CHOICES}


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize("choices", [OTHER, {"rates": "fraction"}, {"body": "superscript"}])
def test_notes_compile_without_a_warning_in_every_notation(choices):
    motions = (derived("ZXZ"), derived("xyz", passive=True))
    notes = [motion.with_notation(**choices).note().latex() for motion in motions]
    assert typeset(bound_together(notes)).warnings == ()


@pytest.mark.parametrize("rotation", ["unit_quaternion", "axis_angle", "lecture"])
def test_every_kind_of_note_has_no_equation_with_two_equal_sides(rotation):
    if rotation == "lecture":
        (single,) = read_file(rotation).singles()
        motion = pipeline.motion_of(single).with_notation(**OTHER)
    else:
        motion = rs.derive(rotation).with_notation(**OTHER)
    for equation in motion.note().document.equations:
        assert len(set(equation.sides)) == len(equation.sides)


def test_writing_twice_keeps_the_first_choice():
    motion = derived("ZXZ").with_notation(rates="fraction").with_notation(body="superscript")
    assert motion.notation == Notation(rates="fraction", body="superscript")
    assert r"\frac{d\phi}{dt}" in motion.latex("angular_velocity_space")
    assert derived("ZXZ").notation == DEFAULT


@pytest.mark.parametrize("scalar_last", [False, True])
def test_a_quaternion_is_printed_in_letters_that_are_no_axes(scalar_last):
    """The functions go on taking w, x, y, z, which the note says once."""
    motion = rs.derive(UnitQuaternion(scalar_last=scalar_last), ["rotation_matrix"])
    note = motion.note()
    order = "xyzw" if scalar_last else "wxyz"
    blocks = [block for section in note.document.sections for block in section.blocks]
    texts = [text_of(block.text) for block in blocks if hasattr(block, "text")]
    assert sum(f"), in programs {', '.join(order)}" in text for text in texts) == 1
    assert r"q_0^2" in note.latex()
    assert "<mi>w</mi>" not in note.html()
    assert motion.argument("q").names == tuple(order)


def test_angles_called_like_the_parts_of_a_quaternion_keep_their_names():
    motion = rs.derive("z(w) x(x) y(y) z(z)", ["rotation_matrix"])
    assert "q_0" not in motion.latex("rotation_matrix")
    assert "in programs" not in motion.note().markdown()


# --- what is refused ---


def test_a_choice_that_is_none_is_refused():
    with pytest.raises(ModelError, match="notation, rates: expected dot or fraction, got 'dots'"):
        derived("ZXZ").with_notation(rates="dots")


@pytest.mark.parametrize("name", ["omega", "Omega_wheel"])
def test_an_angle_called_omega_is_not_mistaken_for_the_angular_velocity(name):
    motion = rs.derive(EulerAngles("ZXZ", (name, "theta", "psi")))
    motion.note()
    with pytest.raises(ModelError, match=f"cannot be called omega beside {name}"):
        motion.with_notation(angular_velocity="omega").note()


# --- from a file, and from the command line ---


def test_a_file_chooses_its_notation():
    text = FILE + '[notation]\nrates = "fraction"\nangular_velocity = "omega"\n'
    spec = read_spec(text, source="top.toml", name="top")
    assert spec.notation == Notation(rates="fraction", angular_velocity="omega")
    assert read_record(json.loads(json.dumps(spec.to_data()))) == spec


def test_faults_of_a_notation_are_all_named():
    text = FILE + '[notation]\nrates = "dots"\nbody = 1\nvector = "bold"\n'
    with pytest.raises(SpecError) as caught:
        read_spec(text, source="top.toml", name="top")
    assert [str(fault) for fault in caught.value.faults] == [
        "notation.body: expected a text in quotes, got the number 1",
        'notation.rates: unknown name "dots"; did you mean dot?',
        "notation.vector: unknown key; did you mean vectors?",
    ]


def test_options_go_before_the_file_and_check_knows_them(tmp_path: Path):
    file, out = tmp_path / "top.toml", tmp_path / "out"
    file.write_text(FILE + '[notation]\nrates = "fraction"\nbody = "superscript"\n', "utf-8")
    done = CliRunner().invoke(cli.commands, ["run", str(file), "--rates", "dot", "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert "φ̇ sin θ sin ψ" in done.output
    assert "Ωᴮ" in done.output
    record = json.loads((out / "top" / "top.json").read_text("utf-8"))
    notation = record["request"]["notation"]
    assert (notation["rates"], notation["body"]) == ("dot", "superscript")
    assert CliRunner().invoke(cli.commands, ["check", str(out)]).exit_code == 0
