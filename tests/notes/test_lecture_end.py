"""The note of the lecture ends as every note does: its symbols with units, its results on a sheet.

With its own rotation and with others, whose results are longer and leave less room.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

import rigidsym as rs
from helpers.typesetting import bound_together, pages_of, sheet_of
from rigidsym.notes.document import Document, EquationReference, EquationRow, NoteTable
from rigidsym.pipeline import output_of, read_file

OTHERS = ("unit_quaternion", "rotation_vector", "z(a) x(b) z(c) y(d)")


@cache
def documents() -> tuple[Document, ...]:
    """The lecture, then its theory with other rotations; no two of one name."""
    motions = [output_of(read_file("lecture")).motion]
    motions += [rs.derive(rotation, theory=True) for rotation in OTHERS]
    notes = [motion.note(style="audit").document for motion in motions]
    return tuple(replace(note, name=f"lecture_{place}") for place, note in enumerate(notes))


def section(document: Document, title: str):
    (found,) = [section for section in document.sections if section.title == title]
    return found


@pytest.mark.parametrize("place", range(1 + len(OTHERS)))
def test_every_symbol_of_the_theory_has_a_meaning_and_a_unit_once(place):
    (table,) = [
        b for b in section(documents()[place], "Symbols").blocks if isinstance(b, NoteTable)
    ]
    symbols = [row[0] for row in table.rows]
    assert len(symbols) == len(set(map(str, symbols)))
    assert all(row[1] and row[2] for row in table.rows)
    meanings = {"".join(map(str, row[1])): "".join(map(str, row[2])) for row in table.rows}
    assert meanings["mass of a particle"] == "kg"
    assert meanings["rotation matrix, body to space components"] == "1"
    assert meanings["angular velocity, body components"] == "rad/s"
    assert meanings["kinetic energy"] == "J"  # without a body too


@pytest.mark.parametrize("place", range(1 + len(OTHERS)))
def test_the_symbols_name_equations_that_are_there(place):
    document = documents()[place]
    (table,) = [b for b in section(document, "Symbols").blocks if isinstance(b, NoteTable)]
    named = {
        span.label
        for row in table.rows
        for cell in row
        for span in cell
        if isinstance(span, EquationReference)
    }
    labels = {getattr(block, "label", "") for s in document.sections for block in s.blocks}
    assert named
    assert named <= labels


def test_claims_are_in_the_order_of_their_equations():
    document = documents()[0]
    blocks = section(document, "Identities verified").blocks
    (table,) = [block for block in blocks if isinstance(block, NoteTable)]
    references = [s for row in table.rows for s in row[0] if isinstance(s, EquationReference)]
    numbers = [document.number(reference.label) for reference in references]
    assert numbers == sorted(numbers)
    assert len(numbers) == len(table.rows)


def test_the_sheet_holds_the_boxed_results_of_the_theory():
    document = documents()[0]
    sheet = section(document, "Summary")
    assert sheet.on_own_page
    shown = [e.sides for b in sheet.blocks if isinstance(b, EquationRow) for e in b.equations]
    motion = output_of(read_file("lecture")).motion
    results = [s.sides for s in motion.theory if s.is_result]
    assert results
    assert all(sides in shown for sides in results)


@pytest.mark.usefixtures("tex")
def test_the_sheet_is_one_page():
    sheets = [sheet_of(document) for document in documents()]
    assert pages_of(bound_together(sheets)) == len(sheets)
