"""The Markdown note: mathematics that Markdown leaves alone."""

from __future__ import annotations

import re

import pytest
from markdown_it import MarkdownIt

import rigidsym as rs
from helpers.motions import derived
from rigidsym.formula.latex_pen import MarkdownPen
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derive import derive
from rigidsym.models.rotation import Citation, elementary, time_function
from rigidsym.notes.formats.markdown import escape
from rigidsym.notes.note import note

NAME = "euler_zxz_intrinsic"
GITHUB = MarkdownIt("commonmark").enable("table")  # knows nothing of mathematics
BLOCK = re.compile(r"\$\$\n(.*?)\n\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![`$])\$([^$`]+)\$(?!`)")


def markdown(motion: rs.Motion) -> str:
    return note(motion, module=f"{motion.name}.py").markdown()


def text_of(source: str) -> str:
    """What a reader of Markdown without mathematics shows, and nothing of its markup."""
    found: list[str] = []
    for token in GITHUB.parse(source):
        for child in token.children or []:
            found.append("\n" if child.type == "softbreak" else child.content)
        found.append("\n")
    return "".join(found)


def test_the_markdown_of_the_lectures_rotation(golden):
    golden(f"notes/{NAME}.md", markdown(derived("ZXZ")))


def test_markdown_changes_no_formula(motion):
    source = markdown(motion)
    shown = text_of(source)
    displays, spans = BLOCK.findall(source), INLINE.findall(BLOCK.sub("", source))
    assert len(displays) > len(motion.steps)
    assert len(spans) > len(motion.steps)
    for mathematics in [*displays, *spans]:
        assert mathematics in shown


def test_every_equation_has_its_tag(motion):
    tags = re.findall(r"\\tag\{(\d+)\}", markdown(motion))
    assert tags == [str(step.number) for step in motion.steps]


@pytest.mark.parametrize(
    ("latex", "expected"),
    [
        (r"\mathbf{R}\,\mathbf{x}'", r"\mathbf{R}\thinspace \mathbf{x}'"),
        (r"\mathbf{R}_z\,R_{12}", r"\mathbf{R} _z\thinspace R _{12}"),
    ],
)
def test_mathematics_in_characters_that_markdown_leaves_alone(latex, expected):
    assert MarkdownPen().write(formula(latex)).text == expected


@pytest.mark.parametrize(
    "text",
    [
        "# no heading",
        "- no list",
        "12. no list",
        "> <b>no</b> &amp; [no](link) ![x](y)",
        "`no code` *no* _no_ ~~no~~ \\",
        "a | b",
        "===",
        "<script>alert(1)</script>",
        "$x$ and $$y$$",
    ],
)
def test_any_text_comes_out_as_text(text):
    assert text_of(escape(text)).strip() == text
    kinds = {token.type for token in GITHUB.parse(escape(text))}
    assert kinds == {"paragraph_open", "inline", "paragraph_close"}


def test_dollars_in_text_are_no_mathematics():
    assert escape("$x$ costs $$") == "`$`x`$` costs `$$`"


def test_markup_in_a_title_and_a_source_comes_out_as_text():
    odd = "<script>alert(1)</script> | $x$ `c` **b** [a](b)"
    a, b = time_function("a"), time_function("b")
    model = rs.RotationModel(
        name="odd",
        title=odd,
        convention=("1. " + odd,),
        coordinates=(a, b),
        matrix=elementary("z", a) * elementary("x", b),
        source=Citation(text=odd, equation=odd),
    )
    _, _, written = markdown(derive(model)).partition("\n")  # the first line is a comment
    shown = text_of(written)
    assert shown.count(odd) == 3  # title, source, equation
    assert "\n1. <script>" in shown
    assert not re.search("(?m)^<", written)
