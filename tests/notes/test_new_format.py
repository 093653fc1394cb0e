"""A new format is one new file: here a toy one from a temporary folder prints the note of ZXZ."""

from __future__ import annotations

import pytest

from helpers.motions import derived
from rigidsym import pipeline
from rigidsym.errors import ModelError
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.notes import formats, note
from rigidsym.pipeline import output_of, read_spec

TOY = """
from rigidsym.formula.unicode_pen import UnicodePen

ENDING = "toy"


def render(document):
    pen = UnicodePen(document.letters.notation)
    lines = [f"{e.number}. {pen.write(e.sides[0]).text}" for e in document.equations]
    return "\\n".join([document.title, *lines]) + "\\n"
"""


@pytest.fixture
def toy(tmp_path, monkeypatch):
    monkeypatch.setattr(formats, "_KNOWN", known := dict(formats._KNOWN))
    monkeypatch.setattr(formats, "FORMATS", known)
    monkeypatch.setattr(pipeline, "FORMATS", known)
    monkeypatch.setattr(note, "FORMATS", known)
    path = tmp_path / "toy.py"
    path.write_text(TOY, encoding="utf-8")
    return path


def test_a_file_anywhere_adds_a_format(toy):
    found = formats.register(toy)
    motion = derived("ZXZ")
    text = found.render(motion.note().document)
    assert text.startswith(f"{motion.title}\n1. R\n2. dR/dt\n")
    pen = UnicodePen()
    for step in motion.steps:
        assert f"{step.number}. {pen.write(step.quantity.symbol).text}\n" in text


def test_a_derivation_file_asks_for_it_by_its_ending(toy):
    formats.register(toy)
    file = '[rotation]\nsequence = "ZXZ"\n[output]\nnote = ["toy"]\nkernels = []\n'
    spec = read_spec(file, source="top.toml", name="top")
    assert output_of(spec).files["top.toy"].startswith("Euler angles ZXZ")


def test_what_is_not_a_format_is_named(toy):
    toy.write_text("ENDING = 'toy'\n", encoding="utf-8")
    with pytest.raises(ModelError, match="it has no render"):
        formats.register(toy)
    toy.write_text(TOY.replace('"toy"', '"tex"'), encoding="utf-8")
    with pytest.raises(ModelError, match="there is a format 'tex' already"):
        formats.register(toy)
