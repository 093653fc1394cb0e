"""The checks of the built documentation find what they are for, and the texts pass the speller."""

from __future__ import annotations

import importlib
import shutil

import pytest

from helpers.command import ROOT

pytestmark = pytest.mark.campaign


@pytest.fixture
def check(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    return importlib.import_module("check")


def site(folder, **pages):
    for name, body in pages.items():
        text = f'<html lang="en"><head><title>{name}</title></head><body>{body}</body></html>'
        (folder / f"{name}.html").write_text(text, encoding="utf-8")
    return folder


def test_broken_links_are_found(check, tmp_path):
    made = site(tmp_path, a='<a href="b.html#here">b</a> <a href="c.html">c</a>', b="<p id=there>")
    assert list(check.broken_links(made)) == [
        "a.html: no place b.html#here",
        "a.html: no file c.html",
    ]


@pytest.mark.usefixtures("chromium")
def test_axe_finds_a_picture_without_text(check, tmp_path):
    made = site(tmp_path, a="<main><h1>A</h1><img src=a.png></main>")
    faults = list(check.inaccessible(made, check.pages(made)))
    assert [fault for fault in faults if "image-alt" in fault]


def test_a_misspelt_word_is_found(check, tmp_path, monkeypatch):
    if shutil.which("hunspell") is None:
        pytest.skip("hunspell is not installed")
    monkeypatch.setattr(check, "ROOT", tmp_path)
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "words.txt").write_text("gyroscopick\n", encoding="utf-8")
    text = tmp_path / "a.md"
    text.write_text("A gyroscopick torqe acts; `cofde` is not prose.\n", encoding="utf-8")
    assert list(check.misspelt([text])) == ["a.md: torqe"]


def test_the_speller_knows_every_word_of_the_texts(check):
    if shutil.which("hunspell") is None:
        pytest.skip("hunspell is not installed")
    assert list(check.misspelt(check.texts())) == []
