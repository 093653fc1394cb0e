"""The formats of a note: text stays text, formulas stay formulas, and pages are valid."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

import rigidsym as rs
from helpers.browser import chromium
from helpers.motions import derived
from helpers.pages import ODD, Elements, odd_model
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.derive import derive
from rigidsym.notes.formats import FORMATS, escape as latex, html, markdown
from rigidsym.notes.note import note
from rigidsym.pipeline import PAGE, output_of, read
from rigidsym.spec.derivation_file import read_file
from rigidsym.version import OWNERSHIP

KINDS = ("axis_angle", "gibbs_vector", "unit_quaternion", "z(phi) x(theta) [0,b,c](psi)", "z(phi)")
SHIPPED = ("lecture", "solid_cone", "yaw_pitch_roll")
GITHUB = MarkdownIt("commonmark").enable("table")  # knows nothing of mathematics
BLOCK = re.compile(r"\$\$\n(.*?)\n\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![`$])\$([^$`]+)\$(?!`)")


def page_of(motion: rs.Motion) -> str:
    return note(motion, module=f"{motion.name}.py").html()


def text_of(source: str) -> str:
    """What a reader of Markdown without mathematics shows, and nothing of its markup."""
    lines: list[str] = []
    for token in GITHUB.parse(source):
        for child in token.children or []:
            lines.append("\n" if child.type == "softbreak" else child.content)
        lines.append("\n")
    return "".join(lines)


def test_every_generated_file_says_whose_it_is():
    spec = replace(read("ZXZ"), kernels=tuple(TARGETS), note=(*FORMATS, PAGE))
    files = output_of(replace(spec, quantities=("angular_velocity_body",))).files
    assert len(files) > len(FORMATS)
    for name, text in files.items():
        assert OWNERSHIP in " ".join(text.replace("*", " ").split()), name


def test_any_text_becomes_latex_text(answered):
    answered("notes/latex_text.txt", latex.escape)
    for text, expected in (("a\tb\nc\u0000", "a b c "), ("a\u00a0b", "a~b")):
        assert latex.escape(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "# no heading",
        "- no list",
        "12. no list",
        "> <b>no</b> &amp; [no](link) ![x](y)",
        "`no code` *no* _no_ ~~no~~ \\",
        "a | b",
        "===",
        "<script>alert(1)</script>",
        "$x$ and $$y$$",
    ],
)
def test_any_text_comes_out_of_markdown_as_text(text):
    assert text_of(markdown.escape(text)).strip() == text
    kinds = {token.type for token in GITHUB.parse(markdown.escape(text))}
    assert kinds == {"paragraph_open", "inline", "paragraph_close"}


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
    assert latex.cleaned(text) == expected


def test_markup_in_a_title_and_a_source_comes_out_as_text():
    odd = r"<script>alert(1)</script> | 50% \input{x} & $\alpha$ `c` **b** [a](b)"
    made = note(derive(odd_model(odd, "#1")))
    assert odd not in made.latex()
    assert made.latex().count(latex.escape(odd)) == 2
    assert r"\cite[eq.~\#1]{odd:source-1}" in made.latex()
    _, _, written = made.markdown().partition("\n")  # the first line is a comment
    assert text_of(written).count(odd) == 2
    assert "\n1. <script>" in text_of(written)  # no list
    assert not re.search("(?m)^<", written)
    page = page_of(derive(odd_model()))
    assert page.count(html.escape(ODD)) >= 4
    assert not Elements(page).named("script", "img")


def test_markdown_changes_no_formula(motion):
    source = note(motion, module="m.py").markdown()
    shown = text_of(source)
    displays, spans = BLOCK.findall(source), INLINE.findall(BLOCK.sub("", source))
    assert len(displays) > len(motion.steps)
    assert len(spans) > len(motion.steps)
    assert [mathematics for mathematics in (*displays, *spans) if mathematics not in shown] == []
    tags = re.findall(r"\\tag\{(\d+)\}", source)
    assert tags == [str(step.number) for step in motion.steps]


def test_every_equation_is_there_with_its_number_and_links_lead_somewhere(motion):
    elements = Elements(page := page_of(motion))
    for step in motion.steps:
        assert f'<div class="equation" id="{step.quantity.name}"' in page
        assert f'href="#{step.quantity.name}">({step.number})</a>' in page
    places = [attributes["id"] for _, attributes in elements.tags if "id" in attributes]
    assert len(set(places)) == len(places)
    assert {tag["href"] for tag in elements.named("a")} <= {f"#{place}" for place in places}


def test_mathml_is_what_browsers_and_validators_know():
    latex = r"\boxed{\begin{aligned}a' &= \begin{pmatrix} \displaystyle \frac{b}{2} \end{pmatrix} "
    latex += r"+ \Bigl(\frac{d\phi}{dt}\Bigr)^2 \end{aligned}}"
    written = html.math(latex, is_display=True)
    assert written.startswith(r'<math alttext="\boxed{\begin{aligned}a')
    for part in (
        '<mo class="prime">′</mo>',
        '</mo><msup><mspace height="1.1em"/><mn>2</mn></msup>',
    ):
        assert part in written
    assert '<mrow class="tall"><mfrac>' in written
    assert not re.search("menclose|scriptlevel", written)
    assert html.math("a", is_tall=True) == '<math alttext="a" class="tall"><mi>a</mi></math>'


def test_signs_between_the_parts_of_a_cut_formula_stand_apart_from_both():
    page = page_of(rs.derive("z(q1) y(q2) y(q3) x(q4)", only=["spin_matrix"]))
    signs = re.findall(r"</math> <math [^>]*><mo([^>]*)>([+−])</mo>", page)
    assert signs
    assert {attributes for attributes, _ in signs} == {' form="infix" lspace="0"'}


def test_a_note_without_scipy_lacks_the_picture_of_its_examples_and_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.integrate", None)
    (single,) = read_file("heavy_symmetric_top").singles()
    with pytest.warns(UserWarning, match=r"without the picture of its examples: .*simulate"):
        output = output_of(replace(single, note=("html",)))
    assert "equations of motion" in output.files[f"{single.name}.html"]


WIDE = """
[...document.querySelectorAll(".formula, .scroll")]
  .filter((box) => box.offsetParent && box.scrollWidth > box.clientWidth + 1)
  .map((box) => box.textContent.slice(0, 80))
"""


@pytest.mark.usefixtures("chromium")
def test_notes_of_every_kind_fit_a_phone_and_a_screen(tmp_path: Path):
    pages = [page_of(rs.derive(kind)) for kind in KINDS]
    for single in (single for name in SHIPPED for single in read_file(name).singles()):
        output = output_of(replace(single, note=("html",)))
        pages.append(output.files[f"{single.name}.html"])
    pages.append(page_of(derived("XYZ")).replace('"Latin Modern Math", ', ""))  # other fonts
    file = tmp_path / "note.html"
    with chromium(tmp_path) as tab:
        for page in pages:
            file.write_text(page, encoding="utf-8")
            for width in (360, 1280):  # on a phone, wide matrices are scrolled in their boxes
                tab.open(file, width)
                assert tab.run("document.documentElement.scrollWidth") <= width
                assert width == 360 or tab.run(WIDE) == []
                assert tab.complaints == []


def test_a_page_may_end_within_twelve_lines():
    latex = rs.derive("z(a) y(b) y(c) x(d)", ["inverse_rate_matrix_body"]).note().latex()
    assert r"{\freely\begin{align*}" in latex
