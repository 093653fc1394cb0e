"""Templates of the user's own: they stand in for the shipped ones, and their faults are named."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from helpers.motions import derived
from rigidsym.commands.cli import commands
from rigidsym.errors import TemplateFault
from rigidsym.system import resources
from rigidsym.system.resources import SandboxedTemplates

NAME = "euler_zxz_intrinsic"


def html_with(folder: Path, template: str) -> str:
    (folder / "note.html.jinja").write_text(template, encoding="utf-8")
    with resources.overridden_by(folder):
        return derived("ZXZ").note().html()


def test_an_own_template_stands_in_for_the_shipped_one(tmp_path: Path):
    assert html_with(tmp_path, "<h1>{{ title }}</h1>") == "<h1>Euler angles ZXZ, intrinsic</h1>"
    assert derived("ZXZ").note().html().startswith("<!DOCTYPE html>")


def test_templates_that_are_not_overridden_stay(tmp_path: Path):
    (tmp_path / "note.html.jinja").write_text("x", encoding="utf-8")
    before = derived("ZXZ").note().latex()
    with resources.overridden_by(tmp_path):
        assert derived("ZXZ").note().latex() == before


def test_an_own_template_that_was_changed_is_read_again(tmp_path: Path):
    assert [html_with(tmp_path, text) for text in ("one", "two")] == ["one", "two"]


def test_an_own_template_from_an_older_version_gets_the_commands_that_it_lacks(tmp_path: Path):
    name = "fragment.tex.jinja"
    shipped = resources.text(resources.NOTES, name)
    lacks = r"(?m)^\\newcommand\{\\(numbercell|figuretitle)\}.*\n"
    older = re.sub(lacks, "", shipped) + "((* for section in last *))((* endfor *))"
    (tmp_path / name).write_text(older, encoding="utf-8")
    with resources.overridden_by(tmp_path):
        latex = derived("ZXZ").note(style="lecture").latex()
    assert latex.count(r"\providecommand{\numbercell}") == 1
    assert latex.index(r"\providecommand{\figuretitle}") < latex.index(r"\figuretitle{Figure}")
    assert r"\providecommand" not in derived("ZXZ").note(style="lecture").latex()


def test_an_own_template_may_include_others(tmp_path: Path):
    (tmp_path / "head.jinja").write_text("<b>{{ title }}</b>", encoding="utf-8")
    assert html_with(tmp_path, "{% include 'head.jinja' %}").startswith("<b>Euler")


@pytest.mark.parametrize(
    ("template", "line", "said"),
    [
        (
            "a\n{{ titel }}",
            2,
            "'titel' is undefined; names here: byline, language, sections, sources,",
        ),
        ("{% for s in sections %}\n\n{{ s.name }}{% endfor %}", 3, "has no attribute 'name'"),
        ("{% if x %}", 1, "Unexpected end of template"),
        ("\n{{ title.__class__.__mro__ }}", 2, "access to attribute '__class__'"),
        ("{% include 'nowhere.jinja' %}", 1, "nowhere.jinja"),
        ("\n{% include '/etc/hostname' %}", 2, "hostname"),
        ("{% include '../note.html.jinja' %}", 1, "note.html.jinja"),
        ("{% include 'note.html.jinja' %}", 1, "it includes itself"),
        ("\n{{ title + 1 }}", 2, "can only concatenate str"),
        ("{{ 1 / 0 }}", 1, "division by zero"),
        ("{{ title() }}", 1, "'str' object is not callable"),
        ("{% for i in range(999999) %}{% endfor %}", 1, "Range too big"),
        ("{{ 9**9**9**9 }}", 1, "templates only place text; ** is not allowed"),
        ("{% include 'a\x00b' %}", 1, "no template a\\x00b"),
        ("{{ 'a'.center(9999999999) }}", 1, "unsafe"),
        ("{{ 'a'.replace('a', title) }}", 1, "unsafe"),
        ("{{ '%9999999999d' % 1 }}", 1, "templates only place text; % is not allowed"),
        ("{{ 'a'|center(9999999999) }}", 1, "No filter named 'center'"),
        ("{{ '{:9999999999}'.format(1) }}", 1, "unsafe"),
        ("{{ lipsum(n=999999) }}", 1, "'lipsum' is undefined"),
        ("{{ ['a'].append('b') }}", 1, "access to attribute 'append'"),
        ("\n{% for x in 1 %}{% endfor %}", 2, "'int' object is not iterable"),
        ("{{ title|tojson }}", 1, "No filter named 'tojson'"),
        ("\n{{ range }}", 2, "a function is not text"),
        ("{{ ''.join }}", 1, "access to attribute 'join'"),
        ("{{ 'a' * 9999999999 }}", 1, "templates only place text; * is not allowed"),
    ],
)
def test_a_fault_is_named_with_its_template_and_line(tmp_path: Path, template, line, said):
    with pytest.raises(TemplateFault) as caught:
        html_with(tmp_path, template)
    assert str(caught.value).startswith(f"{tmp_path / 'note.html.jinja'}, line {line}: ")
    assert said in str(caught.value)


def test_the_output_of_a_template_is_bounded(tmp_path: Path):
    loop = "{% for a in range(999) %}"
    text = loop * 3 + "xxxxxxxxxx" + "{% endfor %}" * 3
    with pytest.raises(TemplateFault, match="it prints more than 20000000 characters"):
        html_with(tmp_path, text)


GROWING = (
    "{% set all = namespace(x='ab') %}{% for i in range(90) %}{% set all.x = GROWN %}{% endfor %}"
)


@pytest.mark.parametrize(
    "grown", ["all.x ~ all.x", "all.x + all.x", "(all.x, all.x)|join", "all.x ~ ' ' ~ all.x"]
)
def test_what_a_template_puts_together_is_bounded(tmp_path: Path, grown):
    with pytest.raises(TemplateFault, match="it makes more than 20000000 characters"):
        html_with(tmp_path, GROWING.replace("GROWN", grown))


@pytest.mark.parametrize(
    "endless",
    [
        "{% for a in range(99999) %}{% for b in range(99999) %}{% endfor %}{% endfor %}",
        "{% macro twice(n) %}{% if n %}{{ twice(n - 1) }}{{ twice(n - 1) }}{% endif %}"
        "{% endmacro %}{{ twice(60) }}",
        "{% set all = namespace(depth=n|default(0)) %}"
        "{% if depth|default(60) %}{% set depth = depth|default(60) - 1 %}"
        "{% include 'note.html.jinja' %}{% include 'note.html.jinja' %}{% endif %}",
    ],
    ids=["loops", "macros", "inclusions"],
)
def test_the_time_of_a_template_is_bounded_from_python_too(tmp_path: Path, endless, monkeypatch):
    monkeypatch.setattr("rigidsym.system.resources._SECONDS", 0.3)
    with pytest.raises(TemplateFault, match=r"it takes more than 0\.3 s"):
        html_with(tmp_path, endless)


def test_text_is_put_together_as_jinja_does(tmp_path: Path):
    template = "{{ 1 ~ 'a' ~ title|length }} {{ ['a', 1]|join(', ') }} {{ 1 + 2 }}"
    assert html_with(tmp_path, template) == "1a27 a, 1 3"


def test_a_fault_in_an_included_template_is_named_there(tmp_path: Path):
    (tmp_path / "head.jinja").write_text("\n\n{{ nothing }}", encoding="utf-8")
    with pytest.raises(TemplateFault, match=r"head\.jinja, line 3: 'nothing' is undefined"):
        html_with(tmp_path, "\n{% include 'head.jinja' %}")


def test_a_template_that_is_no_text_is_named(tmp_path: Path):
    (tmp_path / "note.html.jinja").write_bytes(b"\xff")
    with (
        resources.overridden_by(tmp_path),
        pytest.raises(TemplateFault, match="UTF-8"),
    ):
        derived("ZXZ").note().html()


def test_a_folder_without_templates_is_an_error(tmp_path: Path):
    with pytest.raises(TemplateFault, match=r"contains none of the templates: .*note\.tex\.jinja"):
        resources.overridden_by(tmp_path).__enter__()


def test_the_shipped_templates_are_short():
    for name in resources.names(resources.NOTES, ".jinja"):
        assert len(resources.text(resources.NOTES, f"{name}.jinja").splitlines()) < 200


# --- commands ---


def test_templates_are_copied_out_and_used_again(tmp_path: Path):
    run = CliRunner()
    done = run.invoke(commands, ["templates", str(tmp_path / "own")])
    assert done.exit_code == 0, done.output
    copies = {file.name for file in (tmp_path / "own").iterdir()}
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


def test_copying_out_overwrites_nothing(tmp_path: Path):
    (tmp_path / "note.tex.jinja").write_text("mine", encoding="utf-8")
    done = CliRunner().invoke(commands, ["templates", str(tmp_path)])
    assert done.exit_code != 0
    assert [file.name for file in tmp_path.iterdir()] == ["note.tex.jinja"]
    assert (tmp_path / "note.tex.jinja").read_text("utf-8") == "mine"


def test_templates_are_compiled_once_for_all_processes_and_again_after_a_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def rendered(text: str) -> str:
        return SandboxedTemplates(lambda name: (text, name)).get_template("a.jinja").render(x=1)

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first = rendered("{{ x }} once")
    monkeypatch.setattr(SandboxedTemplates, "compile", None)
    assert rendered("{{ x }} once") == first == "1 once"
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert rendered("{{ x }} twice") == "1 twice"
    (kept,) = (tmp_path / "rigidsym" / "templates").iterdir()
    kept.write_bytes(kept.read_bytes()[:60])
    assert rendered("{{ x }} twice") == "1 twice"


def test_templates_need_no_cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rigidsym").write_text("a file where the folder would be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    made = SandboxedTemplates(lambda name: ("{{ x }}", name))
    assert made.get_template("a.jinja").render(x=1) == "1"
