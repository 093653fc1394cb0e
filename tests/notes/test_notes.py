"""The note and the terminal text: what they must say, what they must not lose, and the styles."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from helpers.motions import GYROSCOPE, derived, motion_in
from helpers.pages import motion_of
from helpers.typesetting import bound_together
from rigidsym.errors import ModelError
from rigidsym.formula.letters import TIME
from rigidsym.formula.notation import Notation
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.unicode_pen import columns
from rigidsym.mechanics.derivation import Place, Proof
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EulerAngles, given, parametrised
from rigidsym.models.rotation import elementary, time_function
from rigidsym.notes.facts.singular import PointFacts
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.formats.terminal import show
from rigidsym.notes.note import note
from rigidsym.system.resources import STYLES

ZXZ = "euler_zxz_intrinsic"


@pytest.mark.parametrize("ending", ["tex", "html", "md"])
def test_the_note_of_the_lectures_rotation(golden, ending):
    motion = derived("ZXZ")
    text = note(motion, module=f"{motion.name}.py").render(ending)
    # the inside of MathML is from the LaTeX, by a package whose versions differ in details
    golden(f"notes/{ZXZ}.{ending}", re.sub(r"(<math .*?>).*?</math>", r"\1", text))


# what the note of the lecture's rotation has no occasion to say
KINDS = {
    "one_turn": "z(phi)",
    "two_turns": "y(phi) x(theta)",
    "four_turns": "z(alpha) [a,b,c](beta) y(alpha0) x(gamma)",
    "passive_vector": rs.rotation_from("rotation_vector", passive=True),
    "own_matrix": given(elementary("z", time_function("a") + time_function("b")), name="own"),
}
ARM = {  # of two links that turn in a plane, the second one a particle
    "body": rs.principal_moments(*sp.symbols("A A C")),
    "potential": "-m*g*l*(cos(a) - cos(b))",
    "parts": [{"velocity": ["-l*sin(a)*a_dot", "l*cos(a)*a_dot", "0"], "mass": "m"}],
    "examples": [
        {"parameters": {"A": 1, "C": 1, "m": 1, "g": 9.81, "l": 1}, "initial": {"a": 1}, "time": 1}
    ],
}
NAMES = ("heavy_symmetric_top", "lecture", "quaternion", "unit_quaternion", "axis_angle")


@pytest.mark.parametrize("kind", [*KINDS, *NAMES, "cone", "arm"])
def test_notes_of_every_kind(golden, kind):
    if kind == "cone":
        motion = rs.derive("ZXZ", body=rs.solid("cone"))
    elif kind == "arm":
        motion = rs.derive("z(a) z(b)", **ARM)
    else:
        motion = rs.derive(KINDS[kind]) if kind in KINDS else motion_of(kind)
    golden(f"notes/kinds/{kind}.md", note(motion, style="audit").markdown())


def test_rotations_in_a_terminal(golden):
    golden(f"terminal/{ZXZ}_80.txt", show(derived("ZXZ"), width=80) + "\n")
    motion = derive(EulerAngles("ZYX", ("heading", "elevation", "bank"), passive=True))
    golden(f"terminal/{motion.name}_80.txt", show(motion, width=80) + "\n")


@pytest.mark.parametrize("style", STYLES)
def test_an_unproved_step_shows_in_every_style_and_format(style):
    motion, theta = derived("ZXZ"), sp.Symbol("theta")
    residual = sp.ImmutableMatrix([sp.sin(theta), 0, 1 - sp.cos(theta)])
    proof = Proof(claim=formula("a = b"), status="unproved", residual=residual)
    steps = [*motion.steps]
    steps[4] = replace(steps[4], proofs=(proof,))
    motion = replace(motion, steps=tuple(steps))
    lines = show(motion).splitlines()
    assert {"  ✗ unproved: a = b", "  ✗ (5)  unproved  a = b", "  Δ = ⎢ 0         ⎥"} <= {*lines}
    made = note(motion, style=style)
    (equation,) = (e for e in made.document.equations if e.unproved)
    assert (equation.label, equation.proved) == ("angular_velocity_body", ())
    for words in (r"\textbf{Unproved}: $a = b$.", r"\textbf{unproved}", r"{\Delta} = \begin{p"):
        assert words in made.latex()
    assert "<strong>Unproved</strong>" in made.html()
    assert "<td><strong>unproved</strong></td>" in made.html()


@pytest.mark.parametrize("width", [80, 120])
def test_no_line_is_wider_than_the_terminal(motion, width):
    assert max(map(columns, show(motion, width=width).splitlines())) <= width


def test_what_idle_rates_leave_determined():
    a, b, c = q = [time_function(name) for name in "abc"]
    rates = [coordinate.diff(TIME) for coordinate in q]
    for fixed, idle, expected in (
        ([b], (2, 0, 3), [3 * a - 2 * c]),
        ([b], (0, 0, 1), [a]),
        ([b], (1, 1, 0), [rates[0] - rates[1], rates[2]]),  # they leave the place b = 0
        ([b], (sp.sqrt(2), 0, 1), []),
        ([b + c], (1, 1, -1), [a - b]),  # and a + c, which is a − b where b + c is fixed
        ([a + b, b + c], (2, -1, 1), [rates[0] + 2 * rates[1], rates[0] - 2 * rates[2]]),
    ):
        places = [Place(coordinate=f, value=sp.S.Zero, period=2 * sp.pi) for f in fixed]
        at = SimpleNamespace(places=places, null_rates=sp.ImmutableMatrix(idle))
        assert [*PointFacts(at, tuple(q)).determined] == expected, idle


def test_a_lecture_has_every_equation_and_leaves_out_what_an_audit_adds():
    lecture, audit = (
        note(derived("ZXZ"), style=style, module="m.py").document for style in ("lecture", "audit")
    )
    assert [(e.number, *e.sides[:1]) for e in lecture.equations] == [
        (e.number, *e.sides[:1]) for e in audit.equations
    ]
    assert all(e.proved and e.function for e in audit.equations)
    assert not any(e.proved or e.function for e in lecture.equations)
    assert lecture.sections[-1].title == "Appendix: identities verified"
    last = [section.title for section in audit.sections[-3:]]
    assert last == ["Identities verified", "Symbols", "Functions"]


def test_equations_of_motion_have_letters_for_long_moments():
    """The moments of a disc on a rod would fill the page, and are in the note once."""
    text = motion_in(GYROSCOPE).note().markdown()
    equations = text.partition("## The equations of motion")[2].partition("## Appendix")[0]
    assert "I _1" in equations
    assert not [words for words in ("r^2", "moves freely") if words in equations]
    assert "r^2" in text


OTHER = {"rates": "fraction", "vectors": "arrow", "angular_velocity": "omega"}


def test_symbols_in_another_notation(answered):
    def answer(question: str) -> str:
        choice, _, text = question.partition(": ")
        notation = Notation(**{choice: OTHER[choice]})
        symbol = notation.applied(formula(text))
        assert notation.applied(symbol) == symbol
        return f"{symbol.latex}\n{symbol.text}"

    answered("notes/notation.txt", answer)


def test_the_form_of_the_lectures_equation_18(golden):
    motion = derived("ZXZ").with_notation(rates="fraction")
    shown = show(motion, width=100, notation=motion.notation)
    golden("terminal/euler_zxz_fractions_100.txt", shown)
    latex = motion.note().latex()  # the lecture prints both matrices whole, with small fractions
    assert "\n\\frac{d\\phi}{dt} \\sin\\theta \\sin\\psi + \\frac{d\\theta}{dt} \\cos\\psi" in latex


def test_no_symbol_is_left_in_the_old_notation():
    motion = derived("ZYX", passive=True).with_notation(**OTHER)
    shown = (
        motion.note().latex().split(r"\begin{document}")[1],
        motion.note().markdown(),
        motion.note().html().split("</style>")[1],
        show(motion, notation=motion.notation),
    )
    tex, characters = (r"\dot{", r"\ddot{", r"\Omega", r"\boldsymbol"), "\u0307\u0308Ω˙𝛀"
    assert [old for old in tex for text in shown[:2] if old in text] == []
    assert [old for old in characters for text in shown[2:] if old in text] == []
    assert "Ω" not in motion.text("angular_velocity_body")
    assert r"\Omega" not in motion._repr_mimebundle_()["text/latex"]
    assert motion.kernels().source == derived("ZYX", passive=True).kernels().source


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize("choices", [OTHER, {"rates": "fraction"}])
def test_notes_compile_without_a_warning_in_every_notation(choices):
    motions = (derived("ZXZ"), derived("xyz", passive=True))
    notes = [motion.with_notation(**choices).note().latex() for motion in motions]
    assert typeset(bound_together(notes)).warnings == ()


@pytest.mark.parametrize("order", ["wxyz", "xyzw"])
def test_a_quaternion_is_printed_in_letters_that_are_no_axes(order):
    """The functions go on taking w, x, y, z, which the note says once."""
    model = parametrised("unit_quaternion", scalar_last=order == "xyzw")
    motion = rs.derive(model, ["rotation_matrix"])
    note = motion.note()
    blocks = [block for section in note.document.sections for block in section.blocks]
    texts = [text_of(block.text) for block in blocks if hasattr(block, "text")]
    assert sum(f"), in programs {', '.join(order)}" in text for text in texts) == 1
    assert r"q_0^2" in note.latex()
    assert "<mi>w</mi>" not in note.html()
    assert motion.argument("q").names == tuple(order)


def test_a_choice_that_is_none_is_refused():
    with pytest.raises(ModelError, match="notation, rates: expected dot or fraction, got 'dots'"):
        derived("ZXZ").with_notation(rates="dots")


@pytest.mark.parametrize(("name", "other"), [("omega", "Omega"), ("Omega", "omega")])
def test_an_angle_called_omega_is_not_mistaken_for_the_angular_velocity(name, other):
    for psi, also in ((other, ";"), ("psi", f", which can also be called {other};")):
        motion = rs.derive(EulerAngles("ZXZ", (name, "theta", psi)))
        with pytest.raises(ModelError, match=f"{name} is printed like the angular velocity{also}"):
            motion.with_notation(angular_velocity=name).note()
    motion.with_notation(angular_velocity=other).note()


def test_options_go_before_the_file_and_check_knows_them(tmp_path: Path):
    text = '[rotation]\nsequence = "ZXZ"\n[notation]\nrates = "fraction"\nvectors = "arrow"\n'
    (tmp_path / "top.toml").write_text(text, "utf-8")
    done = call("run", "top.toml", "--rates", "dot", "--out", "out", cwd=tmp_path)
    assert "φ̇ sin θ sin ψ" in done.stdout
    assert "Ω⃗′" in done.stdout
    record = json.loads((tmp_path / "out/top/top.json").read_text("utf-8"))
    notation = record["request"]["notation"]
    assert (notation["rates"], notation["vectors"]) == ("dot", "arrow")
    call("check", "out", cwd=tmp_path)
