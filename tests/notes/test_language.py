"""Notes in German: every sentence has a translation, and what a user wrote stays as it is."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.motions import derived
from rigidsym.commands.cli import commands
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, sentence
from rigidsym.notes.document.catalogue import Catalogue, language_of
from rigidsym.notes.document.document import Document, Figure, Section
from rigidsym.notes.document.own_text import OwnText
from rigidsym.notes.figure.chart import Range, chart
from rigidsym.notes.formats import FORMATS
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.problems.exercise import sheet_of
from rigidsym.notes.problems.subjects import SUBJECTS
from rigidsym.page.print_page import MOST_BYTES, print_page
from rigidsym.pipeline import motion_of, output_of, read, read_record, read_spec

GERMAN = language_of("de")
PARTICLES = '{mass = "m_1", at = ["a", 0, 0]}, {mass = "m_2", at = [0, "b", 0]}'
BODIES = {  # written out; the other derivations are names of rotations and of shipped files
    "three_lengths": 'shape = "box"\nsides = [1.0, 2.0, 3.0]\nmass = 2.0',
    "two_particles": f"particles = [{PARTICLES}]",
    "a_frustum": 'shape = "frustum"',
    "a_plate": 'shape = "plate"',
}
CATALOGUE = (
    *("ZXZ", "XYZ", "zyx", "aerospace", "rpy", "davenport", "z(phi)", "z(a) x(b)"),
    *("quaternion", "unit_quaternion", "axis_angle", "rotation_vector", "gibbs_vector"),
    *("modified_rodrigues", "cayley_klein", "direction_cosines", "lecture", "solid_cone"),
    *("composite_body", "heavy_symmetric_top", "free_body", "rolling_disc"),
    *("gravity_gradient_satellite", "dual_spin_satellite"),
)


def audit(name: str) -> Document:
    """The English note with all that it may hold."""
    text = f'[body]\n{BODIES.get(name)}\n[output]\nquantities = ["body"]'
    spec = read_spec(text, source=name, name=name) if name in BODIES else read(name)
    return motion_of(spec).note(style="audit", conversions=not spec.body).document


def untranslated(document: Document) -> set[str]:
    """What a document and its page hold that the catalogue lacks; the names of sources stay."""
    lacked: set[str] = set()
    german = document.translated(replace(GERMAN, lacked=lacked))
    for ending in ("html", "md"):
        FORMATS[ending].render(german)
    return {sentence for sentence in lacked if sentence not in " ".join(document.sources)}


@pytest.mark.parametrize("name", [*CATALOGUE, *BODIES])
def test_every_sentence_of_a_note_has_a_german_one(name):
    assert untranslated(audit(name)) == set()


@pytest.mark.parametrize("variant", [1, 2, 3])
def test_every_sentence_of_a_sheet_has_a_german_one(variant):
    assert (
        untranslated(sheet_of("all", SUBJECTS, count=7, variant=variant).document(solved=True))
        == set()
    )


@pytest.mark.parametrize("name", ["ZXZ", "quaternion", "composite_body", "heavy_symmetric_top"])
def test_every_sentence_of_a_live_page_has_a_german_one(name):
    motion, lacked = motion_of(read(name)), set()
    into = replace(GERMAN, lacked=lacked)
    document = motion.note(style="paper").document.translated(into)
    page = print_page(motion, document)
    assert {sentence for sentence in lacked if sentence not in " ".join(document.sources)} == set()
    assert '<html lang="de">' in page
    assert len(page.encode()) <= MOST_BYTES


def test_a_translation_has_the_holes_of_its_sentence():
    for english, german in GERMAN.sentences.items():
        holes, kept = (sorted(re.findall(r"\{\w*\}", text)) for text in (english, german))
        numbered = [f"{{{k + 1}}}" for k in range(holes.count("{}"))]
        assert kept in (holes, sorted([*numbered, *filter("{}".__ne__, holes)])), english
        assert not re.search(r"\{\}(, | and | or )\{\}", english), "a list is one {}"


def test_the_german_note_is_that_of_the_golden_file(golden):
    golden("notes/euler_zxz_intrinsic.de.md", derived("ZXZ").note(language="de").markdown())


def test_formulas_and_numbers_of_equations_are_those_of_the_english_note():
    english, german = (derived("ZXZ").note(language=code).document for code in ("en", "de"))
    assert list(german.equations) == list(english.equations)
    assert set(german.formulas) == set(english.formulas)


def test_a_page_says_its_language():
    page = derived("ZXZ").note(language="de").html()
    assert '<html lang="de">' in page
    assert not {"Contents", "Sources", "Figure", "Equation", "Skip"} & set(re.findall(r"\w+", page))


def test_what_the_catalogue_lacks_stays_in_english():
    text = sentence(r"The axis $\mathbf{e}$ stays. This is gimbal lock. My own words.")
    assert GERMAN.text(text) == (
        "The axis ",
        formula(r"\mathbf{e}"),
        " stays. Dies ist die kardanische Blockade (Gimbal Lock). My own words.",
    )


def test_holes_may_change_their_order_and_lists_get_a_german_and():
    turned = Catalogue(code="xx", babel="", sentences={"{} of {}.": "{2}: {1}.", " and ": " und "})
    a, b, c = map(formula, "abc")
    assert turned.text(sentence("{} of {} and {}.", a, b, c)) == (b, " und ", c, ": ", a, ".")


def test_a_title_with_braces_and_strange_letters_is_left_alone():
    for title in ("Set {1} of {}", "one\ntwo, three and four", "private \ue000 use {name}"):
        assert GERMAN.words(title) == title.replace("\ue000", " ")


def test_own_text_stays_and_finds_sections_by_either_title():
    own = OwnText(before={"The rotation": "My words."}, after={"Die Drehung": "The rotation"})
    sections = derived("ZXZ").note(language="de", text=own).document.sections
    (turned,) = (s for s in sections if s.title == "Die Drehung")
    assert [turned.blocks[k].text for k in (0, -1)] == [("My words.",), ("The rotation",)]


def test_an_unknown_language_and_frames_in_german_are_refused():
    with pytest.raises(ModelError, match="language is en or de, and not 'fr'"):
        derived("ZXZ").note(language="fr")
    renamed = derived("ZXZ").with_notation(frames=("inertial", "rotor"))
    with pytest.raises(ModelError, match="only English notes take names"):
        renamed.note(language="de")


def test_a_file_its_record_and_its_live_page_have_one_language():
    text = '[rotation]\nsequence = "ZXZ"\n[output]\nkernels = []\nlanguage = "de"\n'
    spec = read_spec(f'{text}note = ["md", "page"]', source="x.toml", name="x")
    assert read_record(spec.to_data()).language == spec.language == "de"
    files = output_of(spec).files
    assert "## Konvention" in files["x.md"]
    assert '<html lang="de">' in files["x_page.html"]
    assert ">Abspielen</button>" in files["x_page.html"]


def test_the_command_page_takes_a_language(tmp_path):
    options = ("--language", "de", "--out", str(tmp_path))
    done = CliRunner().invoke(commands, ["page", "z(phi)", *options])
    assert done.exit_code == 0, done.output
    assert '<html lang="de">' in Path(done.output.strip()).read_text(encoding="utf-8")


def test_a_sheet_in_german_asks_in_german(tmp_path):
    options = ("--language", "de", "--moodle", "--number", "2", "--out", str(tmp_path))
    done = CliRunner().invoke(commands, ["problems", "bodies", *options])
    assert done.exit_code == 0, done.output
    quiz = (tmp_path / "problems_bodies_1" / "problems_bodies_1.xml").read_text(encoding="utf-8")
    assert "<name><text>Der Satz von Steiner</text></name>" in quiz


def test_numbers_have_a_decimal_comma_in_words_and_formulas():
    sheet = sheet_of("all", SUBJECTS, count=6, variant=3, language="de").document(solved=True)
    top = motion_of(read("heavy_symmetric_top")).note(language="de").document
    for document in (sheet, top):
        text, *_ = FORMATS["md"].render(document).split("## Quellen")
        assert re.findall(r"[^.]*\d\.\d[^.]*", re.sub(r"\[\d+, [^]]*\]", "", text)) == []
    assert "1,76 bei XZX" in FORMATS["md"].render(sheet)
    assert r"(251{,}5; 251{,}5; 306{,}7)" in FORMATS["tex"].render(sheet)
    assert "<mn>0,977</mn>" in FORMATS["html"].render(sheet)


def test_numbers_have_a_decimal_comma_in_figures():
    drawing = chart(Range.of([0, 1]), [(formula("x"), [(0, 0), (1, 1)])], (2, 1), formula("t"))
    sections = (Section("Chart", (Figure(drawing, (), ()),)),)
    document = replace(derived("ZXZ").note().document, sections=sections).translated(GERMAN)
    labels = [label.symbol.text for label in document.figures[0].drawing.labels]
    assert "0,2" in labels
    assert not any("." in label for label in labels)


def test_numbers_that_are_data_keep_their_point_in_german():
    assert "NUMERICAL:=3.17" in sheet_of("all", SUBJECTS, count=2, variant=3, language="de").moodle


@pytest.mark.usefixtures("tex")
def test_a_german_note_compiles_without_a_warning():
    note = motion_of(read("lecture")).note(style="audit", language="de")
    assert typeset(note.latex()).warnings == ()


def test_the_same_note_in_english_has_no_trace_of_languages():
    assert "babel" not in derived("ZXZ").note().latex()
    assert rs.derive("ZXZ", only=["rotation_matrix"]).note().document.language.code == "en"
