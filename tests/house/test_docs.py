"""Every block of the documentation runs, and says what the page says that it says.

On a page, blocks run in order, in an empty folder: `python` in one namespace, `sh` as a command,
and a `code-block` with a caption becomes a file of that name. The lines of a `text` block that
follows appear in the output, in their order; a line that ends in `...` is its beginning.
"""

from __future__ import annotations

import importlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from helpers.command import ROOT
from rigidsym.commands.cli import commands
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.parametrisations import EULER_SEQUENCES
from rigidsym.models.solids import SHAPES

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
_BLOCK = re.compile(r"^```(\{code-block\} )?(\w+)\n(?::caption: (\S+)\n\n)?(.*?)^```$", re.M | re.S)
_PLAIN = re.compile(r"rigidsym [^|<>&;$`*#~]*$")  # nothing for the shell but quotes
_LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """(language, caption, text) of the blocks of a page, without those made from the code."""
    text = page.read_text(encoding="utf-8")
    return [(m[2], m[3] or "", m[4]) for m in _BLOCK.finditer(text)]


class Reader:
    """Somebody who types in what a page shows."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, Any] = {}
        self.output = ""

    def python(self, text: str) -> None:
        found = StringIO()
        with redirect_stdout(found):
            exec(compile(text, "page", "exec"), self.names)
        self.output = found.getvalue()

    def sh(self, text: str) -> None:
        if "pip install" in text:  # the set-up, which test_packaging runs
            assert text in (ROOT / "README.md").read_text(encoding="utf-8")
            text = text.split(" && ")[-1].replace(".venv/bin/", "")
            if not text.startswith("rigidsym"):
                return
        lines = text.replace("\\\n", " ").splitlines()
        if all(map(_PLAIN.match, lines)):
            self.output = "".join(map(self.rigidsym, lines))
        else:
            self.bash(text)

    def rigidsym(self, line: str) -> str:
        """The output of a command, in this process: the next one needs no imports."""
        done = CliRunner().invoke(commands, shlex.split(line)[1:], catch_exceptions=False)
        assert done.exit_code == 0, done.stderr
        return done.stdout

    def bash(self, text: str) -> None:
        bin_folder = self.folder / ".bin"
        bin_folder.mkdir(exist_ok=True)
        command = bin_folder / "rigidsym"
        main = "from rigidsym.commands.cli import main; main()"
        command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -c "{main}" "$@"\n')
        command.chmod(0o755)
        path = f"{bin_folder}:{os.environ['PATH']}"
        done = subprocess.run(
            ["bash", "-ec", text],
            env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)},
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        self.output = done.stdout

    def text(self, text: str) -> None:
        rest = list(map(single_spaced, self.output.splitlines()))
        for line in filter(None, map(single_spaced, text.splitlines())):
            places = [k for k, shown in enumerate(rest) if fits(shown, line)]
            assert places, f"{line!r} is not in\n{self.output}"
            rest = rest[places[0] + 1 :]


def single_spaced(line: str) -> str:
    return " ".join(line.split())


def fits(shown: str, line: str) -> bool:
    return shown.startswith(line[:-3].rstrip()) if line.endswith("...") else shown == line


@pytest.mark.campaign
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_page_shows_is_what_happens(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("COLUMNS", "88")
    reader = Reader(tmp_path)
    for language, caption, text in blocks(page):
        if caption:
            (tmp_path / caption).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / caption).write_text(text, encoding="utf-8")
        else:
            getattr(reader, language)(text)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_to_files(page):
    for target in _LINK.findall(re.sub(r"`[^`]*`", "", page.read_text(encoding="utf-8"))):
        assert (page.parent / target).is_file(), target


def test_every_page_is_in_the_contents():
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^[a-z_]+(?:/[a-z_]+)?$", index, re.M))
    pages = {str(page.relative_to(DOCS).with_suffix("")) for page in PAGES[1:]}
    assert pages - {"index"} == named


def of_docs(name: str):
    """A module of the documentation."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        return importlib.import_module(name)


@pytest.fixture(scope="module")
def schema():
    return of_docs("schema").schema()


def test_the_schema_is_that_of_the_code(schema, request):
    path = DOCS / "derivation.schema.json"
    if request.config.getoption("--update-golden"):
        path.write_text(json.dumps(schema, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    assert json.loads(path.read_text(encoding="utf-8")) == schema


FILES = {path.stem: path.read_text(encoding="utf-8") for path in ROOT.glob("derivations/*.toml")}
FILES |= {
    f"{page.stem}-{caption}": text
    for page in PAGES
    for _, caption, text in blocks(page)
    if caption.endswith(".toml")
}


@pytest.mark.parametrize("name", FILES)
def test_the_schema_takes_what_the_reader_takes(name, schema):
    jsonschema.validate(tomllib.loads(FILES[name]), schema)


@pytest.mark.parametrize("text", ["rotation = 3", "[rotation]\nsequenc = 'ZXZ'", "[notation]"])
def test_the_schema_refuses_what_the_reader_refuses(text, schema):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(text), schema)


def test_the_gallery_has_every_rotation_solid_and_shipped_file():
    found = {item.name for item in of_docs("gallery").everything()}
    shipped = {path.stem for path in ROOT.glob("derivations/*.toml")}
    assert found >= {*EULER_SEQUENCES, *PARAMETRISATIONS, *PRESETS, *SHAPES} - {"tetrahedron"}
    assert found >= shipped - {"euler_all", "euler_zxz"}  # those are conventions


@pytest.mark.campaign
def test_broken_links_are_found(tmp_path):
    (tmp_path / "a.html").write_text('<a href="b.html#here">b</a> <a href="c.html">c</a>')
    (tmp_path / "b.html").write_text("<p id=there>")
    assert list(of_docs("check").broken_links(tmp_path)) == [
        "a.html: no place b.html#here",
        "a.html: no file c.html",
    ]


@pytest.mark.campaign
def test_the_speller_knows_every_word_of_the_texts():
    if shutil.which("hunspell") is None:
        pytest.skip("hunspell is not installed")
    check = of_docs("check")
    assert list(check.misspelt(check.texts())) == []


@pytest.mark.campaign
def test_every_verdict_on_the_literature_is_that_of_the_prover_and_every_repair_is_proved():
    literature = of_docs("literature")
    for decision in literature.decisions():
        assert decision.verdict == decision.claim.verdict, decision.claim.title
        assert decision.is_repaired or decision.verdict != "wrong", decision.claim.title


@pytest.mark.campaign
def test_a_changed_sign_is_found():
    literature = of_docs("literature")
    claim = next(c for c in literature.claims() if c.place == "eq. (2.14)")
    changed = claim.printed.replace("C(e)*sin", "-C(e)*sin").replace("+ -", "- ")
    decision = literature.decide(replace(claim, printed=changed))
    assert decision.verdict == "wrong"
    assert not decision.is_repaired
    assert any(decision.residual)
