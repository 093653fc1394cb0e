"""The styles of a note: a lecture leaves out what an audit shows, and no equation."""

from __future__ import annotations

from dataclasses import replace

import pytest

from helpers.motions import derived
from helpers.typesetting import pages_of
from rigidsym.errors import ModelError
from rigidsym.formula.reader import text_of
from rigidsym.formula.tree import equal
from rigidsym.notes.document import Equation, NoteTable, Paragraph
from rigidsym.notes.note import STYLES, plain
from rigidsym.pipeline import motion_of, output_of, read_file, read_spec

NOTES = {style: derived("ZXZ").note(style=style).document for style in STYLES}
AUDIT = NOTES["audit"]


def titles(document):
    return [section.title for section in document.sections]


@pytest.mark.parametrize("style", STYLES)
def test_every_numbered_equation_is_in_every_style(style):
    found = NOTES[style]
    assert [e.number for e in found.equations] == [e.number for e in AUDIT.equations]
    assert [e.sides[0] for e in found.equations] == [e.sides[0] for e in AUDIT.equations]


def test_nine_long_entries_are_said_by_the_chain_rule():
    rate = next(e for e in NOTES["lecture"].equations if e.label == "rotation_rate")
    shown = "dR/dt = φ̇ (∂R/∂φ) + θ̇ (∂R/∂θ) + ψ̇ (∂R/∂ψ)"
    assert (rate.matrix, equal(*rate.sides).text) == (None, shown)


def test_an_audit_shows_identities_and_functions_beside_their_equations():
    assert all(e.proved and e.function for e in AUDIT.equations)
    assert "Functions" in titles(AUDIT)


@pytest.mark.parametrize("sequence", ["ZXZ", "XYZ", "zyx"])
@pytest.mark.usefixtures("tex")
def test_a_lecture_on_three_turns_takes_four_pages(sequence):
    assert pages_of(derived(sequence).note().latex()) <= 4


def test_a_narrow_table_stands_in_three_parts_with_every_row_once():
    note = derived("ZXZ").note()
    (table,) = [b for b in note.document.sections[-1].blocks if isinstance(b, NoteTable)]
    lines = note.latex().split(r"\begin{ruled}")[1].split(r"\end{ruled}")[0].splitlines()[2:]
    assert len(lines) == -(-len(table.rows) // 3)
    assert sum(line.count(r"\eqref{") for line in lines) == len(table.rows)


def test_a_lecture_ends_with_its_identities():
    found = NOTES["lecture"]
    assert titles(found)[-1] == "Appendix: identities verified"
    assert "Functions" not in titles(found)
    assert not any(e.proved or e.function for e in found.equations)


def test_what_is_unproved_is_said_in_every_style():
    first = AUDIT.sections[1]
    blocks = tuple(
        replace(b, proved=(), unproved=b.proved) if isinstance(b, Equation) and b.number else b
        for b in first.blocks
    )
    document = plain(replace(AUDIT, sections=(first._replace(blocks=blocks),)))
    assert all(e.unproved for e in document.equations)


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


def test_the_note_of_the_lecture_begins_with_the_lecture_and_ends_with_how_it_was_proved():
    (spec,) = read_file("lecture").singles()
    first, *_, last = motion_of(spec).note().document.sections
    assert first.title == "The centre of mass and the kinetic energy"
    words = [text_of(block.text) for block in last.blocks if isinstance(block, Paragraph)]
    assert any("generic summand" in text for text in words)
