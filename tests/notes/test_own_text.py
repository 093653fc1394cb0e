"""What lecturers add to a note and leave out, in [text] of a file."""

from __future__ import annotations

import json
import re

import pytest
import sympy as sp

import rigidsym as rs
from helpers.motions import derived
from rigidsym.errors import RigidsymError, SpecError
from rigidsym.formula.reader import text_of
from rigidsym.models.rotation import LECTURE
from rigidsym.notes.document.document import Paragraph
from rigidsym.notes.document.own_text import OwnText
from rigidsym.notes.formats.fragment import render as print_fragment
from rigidsym.notes.formats.latex import render as print_latex
from rigidsym.notes.formats.pdf import typeset
from rigidsym.pipeline import output_of, read_record, read_spec

MOTION = derived("ZXZ")
FILE = """
[rotation]
sequence = "ZXZ"
[output]
kernels = []
note = ["fragment.tex"]
[text]
author = "E. Noether"
omit = ["rotation_rate"]
[text.before]
angular_velocity_body = "A gyroscope measures $\\\\Omega'$ [titterton]."
[text.sources]
titterton = "D. Titterton, J. Weston, Strapdown Inertial Navigation Technology (2004)"
"""


def with_text(**own):
    return MOTION.note(text=OwnText(**own)).document


def spoken(document):
    """The paragraphs and the labels of equations, in order."""
    blocks = (block for section in document.sections for block in section.blocks)
    return [
        text_of(b.text) if isinstance(b, Paragraph) else getattr(b, "label", "") for b in blocks
    ]


def test_sentences_stand_before_and_after_an_equation():
    shown = spoken(with_text(before={"spin_matrix": "Before."}, after={"spin_matrix": "After."}))
    place = shown.index("spin_matrix")
    assert shown[place - 2] == "Before."  # and before the sentence that leads to it
    assert shown[place + 1] == "After."


def test_sentences_stand_at_both_ends_of_a_section():
    document = with_text(before={"convention": "First."}, after={"Convention": "Last."})
    assert [text_of(document.sections[0].blocks[k].text) for k in (0, -1)] == ["First.", "Last."]


def test_a_quantity_keeps_its_name_in_every_language():
    """`energy` is also a word that the German catalogue translates"""
    free = {"body": rs.principal_moments(*sp.symbols("A A C")), "potential": "k*cos(theta)"}
    own = OwnText(before={"energy": "Vorher.", "Convention": "Zuerst."})
    document = rs.derive("ZXZ", ["energy"], **free).note(language="de", text=own).document
    shown = spoken(document)
    assert shown[0] == "Zuerst."
    assert "Vorher." in shown[: shown.index("energy")]


def test_what_is_left_out_leaves_no_gap_in_the_numbers_and_no_reference():
    document = with_text(omit=("rotation_rate", "The angular acceleration"))
    numbers = [equation.number for equation in document.equations]
    assert numbers == list(range(1, len(numbers) + 1))
    assert "angular_acceleration_body" not in {e.label for e in document.equations}
    latex = print_latex(document)
    referred = set(re.findall(r"\\eqref\{([^}]*)\}", latex))
    assert referred <= set(re.findall(r"\{resultof\}\{([^}]*)\}", latex))
    assert re.findall(r"\\tag\{\d", latex) == []
    assert "setcounter{equation}" not in latex


def test_own_sources_are_cited_and_the_lecture_can_be_named():
    sources = {"lecture": "E. Noether, Notes", "arnold": "V. Arnold, Methods"}
    own = OwnText(sources=sources, after={"rotation_matrix": "See [arnold]."})
    document = rs.derive("lecture_angles").note(text=own).document
    assert document.sources[0] == "E. Noether, Notes"
    assert "V. Arnold, Methods" in document.sources
    assert LECTURE not in document.sources
    assert set(sources.values()) < set(MOTION.note(text=own).document.sources)


def test_the_byline_stands_below_the_title_in_every_format():
    note = MOTION.note(text=OwnText(author="E. Noether", course="Mechanics", date="1926"))
    for text in (note.latex(), note.html(), note.markdown()):
        assert "E. Noether" in text
        assert "Mechanics" in text


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ({"omit": ("rotation_matrx",)}, "no 'rotation_matrx'; did you mean rotation_matrix"),
        ({"before": {"Sumary": "x"}}, "no 'Sumary'"),
        ({"after": {"Convention": "costs $5"}}, "a dollar sign without its pair"),
        ({"after": {"Convention": r"$\frac{1}$"}}, "no formula"),
        ({"after": {"Convention": "[euller]"}, "sources": {"euler": "x"}}, "did you mean euler"),
    ],
)
def test_a_name_or_a_sentence_that_cannot_be_is_shown(own, message):
    with pytest.raises(RigidsymError, match=message):
        with_text(**own)


def test_a_file_holds_the_text_and_the_record_knows_it():
    spec = read_spec(FILE, source="top.toml", name="top")
    assert read_record(json.loads(json.dumps(spec.to_data()))) == spec
    fragment = output_of(spec).files["top.fragment.tex"]
    assert "A gyroscope measures" in fragment
    assert r"\documentclass" not in fragment
    assert r"\begin{document}" not in fragment
    assert r"\figuretitle{Figure}{top:figure-1}" in fragment
    assert r"see Figure~\ref{top:figure-1}" in fragment
    assert fragment.rindex(r"\section{") < fragment.index(r"\begin{thebibliography}")


@pytest.mark.usefixtures("tex")
def test_a_fragment_goes_into_a_report():
    fragment = print_fragment(MOTION.note(style="lecture").document)
    head = (
        r"\documentclass[11pt,a4paper]{report}\usepackage[T1]{fontenc}\usepackage[margin=25mm]"
        r"{geometry}\usepackage{lmodern,amsmath,array,booktabs,longtable,tikz}"
        r"\usetikzlibrary{arrows.meta}"
    )
    figure = r"\begin{figure}\caption{Mine.}\end{figure}"
    made = typeset(rf"{head}\begin{{document}}\chapter{{One}}{figure}{fragment}\end{{document}}")
    assert not [w for w in made.warnings if "undefined" in w]


def test_a_fault_in_a_sentence_has_its_line():
    with pytest.raises(SpecError, match="line 7: text: a dollar sign"):
        read_spec(FILE.replace("$\\\\Omega'$", "$"), source="top.toml", name="top")
