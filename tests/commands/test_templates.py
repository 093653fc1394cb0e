"""Templates of the user's own: they stand in for the shipped ones, and their faults are named."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from helpers.command import call
from helpers.motions import derived
from rigidsym.errors import LimitReached, TemplateFault
from rigidsym.notes.document import said
from rigidsym.notes.formats.terminal import show
from rigidsym.system import resources
from rigidsym.system.processes import time_limit

NAME = "euler_zxz_intrinsic"


def own(folder: Path, name: str, text: str) -> None:
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")


def test_a_fault_is_named_with_its_template_and_line(answered, tmp_path: Path):
    def answer(text: str) -> str:
        own(tmp_path, "en/mine.md.jinja", text)
        with resources.overridden_by(tmp_path), pytest.raises(TemplateFault) as caught:
            derived("ZXZ").note(style="mine").html()
        return str(caught.value).replace(f"{tmp_path}/", "").partition(", are_proved, ")[0]

    answered("commands/template_faults.txt", answer)


def test_a_fault_is_not_ascribed_to_a_template_that_is_not_in_use(tmp_path: Path):
    included = "{% include 'en/part.md.jinja' %}\n{% include 'x' ignore missing %}\n\n$x"
    for name in ("en/first.md.jinja", "en/mine.md.jinja"):
        own(tmp_path, name, included)
    own(tmp_path, "en/part.md.jinja", "as it is")
    with resources.overridden_by(tmp_path), pytest.raises(TemplateFault, match=r"mine.* line 4"):
        derived("ZXZ").note(style="mine")
    own(tmp_path, "en/part.md.jinja", "\n$y\n\n")
    with resources.overridden_by(tmp_path), pytest.raises(TemplateFault, match=r"part.* line 2"):
        derived("ZXZ").note(style="mine")


def test_a_file_that_would_be_ignored_or_misread_is_refused(tmp_path: Path):
    own(tmp_path, "en/lectur.md.jinja", "# Named by --style")
    for name in ("en/lecture_2.md.jinja", "es/lectura.md.jinja", "en/.#body.md.jinja", "a.jinja/b"):
        own(tmp_path, name, "# A style of its own, or no template")

    def read(name: str) -> None:
        derived("ZXZ").note(style="lectur")
        resources.sentences(name)
        said("left_out")

    for name, text, fault in (
        ("lecture.md.jinja", "in no language", "would be ignored, .* did you mean en/lecture"),
        ("en/singlar.md.jinja", "", r"no template refers to it; did you mean en/singular\.md"),
        ("en/lecture.toml", "", "would be ignored"),
        ("en/reasons.toml", "chain_rul = 'It'", "the key chain_rul; did you mean chain_rule"),
        ("en/reasons.toml", "chain_rule = 1", "chain_rule: expected a text"),
        ("en/reasons.toml", "chain_rule = 'Of $x$'", "reasons.toml, chain_rule: expected plain"),
        ("en/equations.toml", "left_out = 'Costs $x'", "equations.toml, left_out: .* pairs of"),
        ("en/equations.toml", "left_out = '{}'", "equations.toml, left_out: .*'{}'"),
        ("en/equations.toml", "left_out = '$\\foo$'", r"equations.toml, left_out: .*'\\foo'"),
        ("en/quantities.toml", "mass", "not TOML"),
    ):
        own(tmp_path, name, text)
        with pytest.raises(TemplateFault, match=fault), resources.overridden_by(tmp_path):
            read(name)
        (tmp_path / name).unlink()


def test_a_template_without_end_is_stopped_by_the_time_limit(tmp_path: Path):
    loop = "{% for a in range(99999) %}"
    own(tmp_path, "note.html.jinja", loop * 2 + "{% endfor %}" * 2)
    with pytest.raises(LimitReached), time_limit(0.3), resources.overridden_by(tmp_path):
        derived("ZXZ").note().html()


OWN = """\
{% extends "rigidsym/en/singular.md.jinja" %}{% block gimbal_lock %}
There {{ singular.outer_angles[0] }} **cannot be *told* from** $\\psi$; ***see*** `margin` and
[a *page*](https://a.org/top_(toy)?b=1&c_d=2#e), \\*2 * 3*4
{{ reference("rotation_matrix") }}{{ cite("G") }}
- a_b
- *{{ model.coordinates[1] }}*

7. seven,
   in 1900
   1899. [b]

8. &lt;nine &copy=1
- {{ "_me_ \\\\- x" }}
{{ 7 }}. {{ "Table:" }}
## Its axes

Table: Its {{ 3 }} axes
| a |
|---|
| b |

$$ a = b \\qquad \\psi = 1 $$
{% endblock %}"""


def test_a_lecturer_changes_one_sentence(golden, tmp_path: Path):
    own(tmp_path, "en/singular.md.jinja", OWN)
    own(tmp_path, "en/reasons.toml", 'chain_rule = "By *my* rule."')
    before = derived("ZXZ").note()
    with resources.overridden_by(tmp_path):
        note = derived("ZXZ").note()
        formats = [note.markdown(), note.latex(), note.html(), show(derived("ZXZ"))]
    starts, ends = r"There <math.*?</math>|There .*?φ|There .*?phi", r"At .*?(theta|θ) = 0|<p>At"
    parts = [re.split(ends, re.split(starts, text)[1])[0].strip() for text in formats]
    # the inside of MathML differs with the versions of a package
    golden(
        "notes/own_sentences.txt", re.sub("(<math .*?>).*?</math>", r"\1", "\n----\n".join(parts))
    )
    assert r"By \*my\* rule." in formats[0]
    assert "freedom is lost" not in formats[0]
    assert len(note.document.sections) == len(before.document.sections) + 1


HANDOUT = """\
{% extends "en/lecture.md.jinja" %}
{% block byline %}
E. Noether

Mechanics I
{% endblock %}
{% block convention %}
# How the body turns

Our course writes {{ equation("rotation_matrix").sides[0] }} for the rotation; see
{{ reference("rotation_matrix") }}.

{{ super() }}
{% endblock %}
{% block rates %}{% endblock %}
{% block singular %}{% endblock %}
{% block acceleration %}{% endblock %}
{% block end %}{% endblock %}
"""
FRENCH = """\
# La rotation

{{ equation("rotation_matrix") }}

Dans le repère du corps, elle vaut
"""


def test_a_handout_is_a_style_with_its_own_heading_sentences_and_sections(tmp_path: Path):
    own(tmp_path, "en/handout.md.jinja", HANDOUT)
    with resources.overridden_by(tmp_path):
        note = derived("ZXZ").note(style="handout")
    titles = ["How the body turns", "Convention", "The rotation", "The angular velocity"]
    assert [section.title for section in note.document.sections] == titles
    assert "E. Noether · Mechanics I" in note.markdown()
    assert r"Our course writes $\mathbf{R}$ for the rotation; see (1)." in note.markdown()
    assert "E. Noether" in note.html()
    assert "E. Noether" in note.latex()


def test_an_equation_is_printed_again_with_its_number(tmp_path: Path):
    again = '{{ super() }}\n{{ equation("angular_velocity_body") }}\n{{ steps("rotation") }} again'
    own(tmp_path, "en/twice.md.jinja", HANDOUT.replace("{{ super() }}", again))
    with resources.overridden_by(tmp_path):
        note = derived("ZXZ").note(style="twice")
    assert re.findall(r"\\tag\{(\d+)\}", note.markdown()) == [*"5112345"]
    assert sorted(e.number for e in note.document.equations) == [1, 2, 3, 4, 5]
    assert re.findall(r"\\(?:tag|setcounter\{equation\})\{\d+\}", note.latex()) == [
        *(rf"\setcounter{{equation}}{{{number}}}" for number in (4, 0)),
        *(rf"\tag{{{number}}}" for number in (1, 5)),
    ]
    assert note.html().count(' id="rotation_matrix"') == 1


def test_a_second_language_is_a_folder_of_templates(tmp_path: Path):
    own(tmp_path, "fr/cours.md.jinja", FRENCH)
    words, own_words = ("derive", "ZXZ", "--style", "fr/cours"), ("--templates", str(tmp_path))
    call(*words, *own_words, cwd=tmp_path)
    html = (tmp_path / "out" / NAME / f"{NAME}.html").read_text(encoding="utf-8")
    assert '<html lang="fr">' in html
    assert "Dans le repère du corps, elle vaut" in html
    assert "The rotation" not in html
    expected = "no style 'fr/cours': expected lecture, audit, or"
    assert expected in call(*words, cwd=tmp_path, status=2).stderr
    call("check", "out", *own_words, cwd=tmp_path)
    without = call("check", "out", cwd=tmp_path, status=1).stdout
    assert f"json: its request cannot be derived: style: {expected}" in without
    assert "or your own fr/cours.md.jinja in --templates DIR" in without


def test_templates_are_copied_out_and_used_again(tmp_path: Path):
    mine = tmp_path / "own"
    call("templates", "own", cwd=tmp_path)
    copies = {file.relative_to(mine).as_posix() for file in mine.rglob("*.*")}
    assert copies == {*resources.replaceable()}
    html = mine / "blocks.html.jinja"
    html.write_text(html.read_text("utf-8").replace("<p>", "<p>Mine: "), "utf-8")
    call("derive", "ZXZ", "--templates", "own", cwd=tmp_path)
    call("check", "out", "--templates", "own", cwd=tmp_path)
    call("check", "out", cwd=tmp_path, status=1)
    assert "<p>Mine: " in (tmp_path / "out" / NAME / f"{NAME}.html").read_text("utf-8")
