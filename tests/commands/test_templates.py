"""Templates of the user's own: they stand in for the shipped ones, and their faults are named."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from helpers.motions import derived
from rigidsym.commands.cli import commands
from rigidsym.errors import LimitReached, TemplateFault
from rigidsym.system import resources
from rigidsym.system.processes import time_limit

NAME = "euler_zxz_intrinsic"


def html_with(folder: Path, template: str) -> str:
    (folder / "note.html.jinja").write_text(template, encoding="utf-8")
    with resources.overridden_by(folder):
        return derived("ZXZ").note().html()


@pytest.mark.parametrize(
    ("template", "line", "said"),
    [
        ("a\n{{ titel }}", 2, "'titel' is undefined; names here: byline, language, sections,"),
        ("{% for s in sections %}\n\n{{ s.name }}{% endfor %}", 3, "has no attribute 'name'"),
        ("\n{{ title.__class__.__mro__ }}", 2, "access to attribute '__class__'"),
        ("{% include 'nowhere.jinja' %}", 1, "nowhere.jinja"),
        ("{% include '../note.html.jinja' %}", 1, "note.html.jinja"),
        ("{% include 'note.html.jinja' %}", 1, "it includes itself"),
        ("\n{{ title + 1 }}", 2, "can only concatenate str"),
        ("{{ ['a'].append('b') }}", 1, "access to attribute 'append'"),
    ],
)
def test_a_fault_is_named_with_its_template_and_line(tmp_path: Path, template, line, said):
    with pytest.raises(TemplateFault) as caught:
        html_with(tmp_path, template)
    assert str(caught.value).startswith(f"{tmp_path / 'note.html.jinja'}, line {line}: ")
    assert said in str(caught.value)


def test_a_template_without_end_is_stopped_by_the_time_limit(tmp_path: Path):
    loop = "{% for a in range(99999) %}"
    with pytest.raises(LimitReached), time_limit(0.3):
        html_with(tmp_path, loop * 2 + "{% endfor %}" * 2)


def test_a_lecturer_changes_one_sentence(tmp_path: Path):
    (tmp_path / "en").mkdir()
    own = tmp_path / "en" / "singular.md.jinja"
    own.write_text(
        '{% extends "rigidsym/en/singular.md.jinja" %}{% block gimbal_lock %}'
        "There {{ singular.outer_angles[0] }} **cannot** be told from $\\psi$; see `margin`."
        "{% endblock %}",
        encoding="utf-8",
    )
    before = derived("ZXZ").note()
    with resources.overridden_by(tmp_path):
        note = derived("ZXZ").note()
    assert r"There $\phi$ **cannot** be told from $\psi$; see `margin`." in note.markdown()
    assert r"\textbf{cannot} be told from $\psi$" in note.latex()
    assert "freedom is lost" not in note.markdown()
    assert len(note.document.sections) == len(before.document.sections)


def test_a_misspelt_block_is_refused_and_a_new_one_inside_a_block_is_not(tmp_path: Path):
    text = '{% extends "en/lecture.md.jinja" %}\n{% block rates %}{% block mine %}{% endblock %}\n'
    own(tmp_path, "en/handout.md.jinja", text + "{% endblock %}\n{% block singlar %}{% endblock %}")
    with resources.overridden_by(tmp_path), pytest.raises(TemplateFault) as caught:
        derived("ZXZ").note(style="handout")
    assert str(caught.value) == (
        f"{tmp_path}/en/handout.md.jinja, line 4: there is no block singlar to override; did you "
        "mean singular?"
    )


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

Voici la matrice de rotation :

{{ equation("rotation_matrix") }}

# La vitesse angulaire

Dans le repère du corps, elle vaut

{{ equation("angular_velocity_body") }}

et $\\boldsymbol{\\Omega} = \\mathbf{R}\\,\\boldsymbol{\\Omega}'$.
"""


def own(folder: Path, name: str, text: str) -> None:
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")


def test_a_handout_is_a_style_with_its_own_heading_sentences_and_sections(tmp_path: Path):
    own(tmp_path, "en/handout.md.jinja", HANDOUT)
    with resources.overridden_by(tmp_path):
        note = derived("ZXZ").note(style="handout")
    titles = ["How the body turns", "Convention", "The rotation", "The angular velocity"]
    assert [section.title for section in note.document.sections] == titles
    assert "E. Noether · Mechanics I" in note.markdown()
    said = r"Our course writes $\mathbf{R}$ for the rotation; see (1)."
    assert said in note.markdown()
    assert "E. Noether" in note.html()
    assert "E. Noether" in note.latex()


def test_a_second_language_is_a_folder_of_templates(tmp_path: Path):
    own(tmp_path, "fr/cours.md.jinja", FRENCH)
    done = CliRunner().invoke(
        commands,
        [
            *("derive", "ZXZ", "--style", "fr/cours", "--templates", str(tmp_path)),
            *("--out", str(tmp_path / "out")),
        ],
    )
    assert done.exit_code == 0, done.output
    html = (tmp_path / "out" / NAME / f"{NAME}.html").read_text(encoding="utf-8")
    assert '<html lang="fr">' in html
    assert "Dans le repère du corps, elle vaut" in html
    assert "The rotation" not in html
    missing = CliRunner().invoke(commands, ["derive", "ZXZ", "--style", "fr/cours"])
    assert "no style 'fr/cours': expected lecture, audit, or" in str(missing.exception)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{{ steps("rotatoin") }}', "no section 'rotatoin' of equations; did you mean rotation?"),
        ('{{ equation("spin") }}', "nothing is derived by the name 'spin'"),
    ],
)
def test_a_part_that_there_is_not_is_named(tmp_path: Path, text, says):
    own(tmp_path, "en/mine.md.jinja", f"# One\n\n{text}\n")
    with resources.overridden_by(tmp_path), pytest.raises(TemplateFault) as caught:
        derived("ZXZ").note(style="mine")
    assert f"mine.md.jinja, line 3: {says}" in str(caught.value)


def test_templates_are_copied_out_and_used_again(tmp_path: Path):
    run = CliRunner()
    done = run.invoke(commands, ["templates", str(tmp_path / "own")])
    assert done.exit_code == 0, done.output
    own = tmp_path / "own"
    copies = {file.relative_to(own).as_posix() for file in own.rglob("*.jinja")}
    assert copies == {f"{name}.jinja" for name in resources.names(resources.NOTES, ".jinja")}
    own = tmp_path / "own" / "note.html.jinja"
    own.write_text(own.read_text("utf-8").replace("</main>", "<p>Mine</p></main>"), "utf-8")
    made = run.invoke(
        commands,
        ["derive", "ZXZ", "--templates", str(tmp_path / "own"), "--out", str(tmp_path / "out")],
    )
    assert made.exit_code == 0, made.output
    folder = tmp_path / "out" / NAME
    assert "<p>Mine</p>" in (folder / f"{NAME}.html").read_text("utf-8")
    checked = run.invoke(commands, ["check", str(folder), "--templates", str(tmp_path / "own")])
    assert checked.exit_code == 0, checked.output
    assert run.invoke(commands, ["check", str(folder)]).exit_code == 1
