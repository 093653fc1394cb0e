"""The Markdown note and the notebook: mathematics that Markdown leaves alone, cells that run."""

from __future__ import annotations

import re
import subprocess
import sys
from base64 import b64decode
from pathlib import Path
from xml.etree import ElementTree

import nbformat
import numpy as np
import pytest
import sympy as sp
from markdown_it import MarkdownIt

import rigidsym as rs
from helpers.motions import derived
from rigidsym.errors import MissingExtra
from rigidsym.formula.latex_pen import MarkdownPen
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derive import derive
from rigidsym.models.euler_angles import EulerAngles
from rigidsym.models.rotation import Citation, elementary, time_function
from rigidsym.notes.formats.markdown import escape
from rigidsym.notes.formats.terminal import show
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


# --- the notebook ---


def test_a_notebook_is_valid_and_the_same_every_time():
    first, second = (note(derive(EulerAngles("ZXZ")), module="m.py").notebook() for _ in range(2))
    assert first == second
    notebook = nbformat.reads(first, as_version=4)
    nbformat.validate(notebook)
    assert [cell.cell_type for cell in notebook.cells].count("code") == 1
    assert notebook.cells[0].source.startswith("# Euler angles ZXZ")


def test_the_notebook_says_what_the_markdown_says():
    printed = note(derived("ZXZ"), module=f"{NAME}.py")
    cells = nbformat.reads(printed.notebook(), as_version=4).cells
    sources = [
        f"```python\n{cell.source}\n```" if cell.cell_type == "code" else cell.source
        for cell in cells
    ]
    _, _, written = printed.markdown().partition("\n\n")  # behind the comment
    picture = re.compile(r"!\[\]\(data:image/svg\+xml;base64,([^)]+)\)\n\n(?=\*\*Figure 1)")
    (drawn,) = picture.findall("\n\n".join(sources))
    assert picture.sub("", "\n\n".join(sources)) + "\n" == written
    labels = ElementTree.fromstring(b64decode(drawn)).iter("{http://www.w3.org/2000/svg}text")
    assert [label.text for label in labels] == [*list("ϕθψxyz"), "x′", "y′", "z′", "N"]


@pytest.mark.parametrize("rotation", ["ZXZ", "quaternion", "z(yaw) y(pitch) x(roll)"])
def test_the_program_of_a_lecture_derives_it_again(rotation):
    cells = nbformat.reads(rs.derive(rotation).note().notebook(), as_version=4).cells
    (program,) = (cell.source for cell in cells if cell.cell_type == "code")
    *lines, call = program.splitlines()
    space: dict[str, object] = {}
    exec("\n".join(lines), space)
    assert np.shape(eval(call, space)) == (3,)


@pytest.mark.parametrize("sequence", ["ZXZ", "xyz"])
def test_the_program_of_a_notebook_runs_beside_its_module(tmp_path: Path, sequence):
    motion = derived(sequence)
    (tmp_path / f"{motion.name}.py").write_text(motion.kernels().source, encoding="utf-8")
    cells = nbformat.reads(motion.note(style="audit").notebook(), as_version=4).cells
    (program,) = (cell.source for cell in cells if cell.cell_type == "code")
    *lines, last = program.splitlines()
    code = "\n".join([*lines, f"print(repr({last}))"])
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("array([")


def test_without_nbformat_the_extra_is_named(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "nbformat", None)
    with pytest.raises(MissingExtra) as caught:
        note(derived("ZXZ")).notebook()
    assert str(caught.value) == (
        "a notebook needs an extra that is missing: pip install '.[notebook]' in the clone"
    )
    assert caught.value.exit_code == 4


# --- in Jupyter ---


def test_a_derivation_shows_itself_in_jupyter():
    motion = derived("ZXZ")
    bundle = motion._repr_mimebundle_(include=None, exclude=None)
    assert bundle["text/markdown"] == motion.note(with_kernels=False).markdown()
    assert bundle["text/plain"] == show(motion)
    assert len(BLOCK.findall(bundle["text/latex"])) == len(motion.steps)
    assert motion._repr_latex_() == bundle["text/latex"]


def test_a_step_shows_itself_in_jupyter():
    step = derived("ZXZ").step("angular_velocity_body")
    bundle = step._repr_mimebundle_(include=None, exclude=None)
    assert bundle["text/latex"].startswith("$$\n\\boldsymbol{\\Omega}' = ")
    assert bundle["text/latex"].endswith("\\tag{5}\n$$")
    assert bundle["text/plain"] in show(derived("ZXZ"))
    assert step._repr_latex_() == bundle["text/latex"]


def test_a_step_of_a_vector_shows_itself_as_one():
    latex = rs.derive("rotation_vector").step("angular_velocity_body")._repr_latex_()
    assert r"= \dot{\mathbf{v}} - \frac{1 - \cos n}{n^2}" in latex
    assert "pmatrix" not in latex


def test_selected_steps_keep_showing_themselves():
    motion = derived("ZXZ").select(["angular_velocity_body"])
    assert motion.steps[0]._repr_latex_().endswith("\\tag{1}\n$$")


def test_a_passive_model_shows_the_matrix_that_its_words_speak_of():
    bundle = rs.rotation_from("z(phi)", passive=True)._repr_mimebundle_()
    assert bundle["text/latex"].startswith(r"$$\mathbf{A} = \mathbf{R}^{\mathsf T} = ")
    assert r"& \sin{\left(\phi \right)}" in bundle["text/latex"]
    assert "the matrix shown is A = Rᵀ" in bundle["text/plain"]


def test_a_body_shows_itself_in_jupyter():
    A, B, C = sp.symbols("A B C", positive=True)
    bundle = rs.principal_moments(A, A, C)._repr_mimebundle_(include=None, exclude=None)
    assert bundle["text/latex"].startswith(r"$$\mathbf{I}' = \left[\begin{matrix}A & 0 & 0")
    assert bundle["text/plain"].startswith("Symmetric body\nmass M = M\ncentre of mass c = (0, 0")
    cone = rs.solid("cone", radius=A, height=B, mass=C)
    assert r"M = C \qquad \mathbf{c} = " in cone._repr_latex_()
    measured = rs.inertia_of(np.array([[1.0, 1, 0, 0], [1, -1, 0, 0], [2, 0, 1, 0]]))
    assert measured._repr_mimebundle_()["text/plain"].startswith("mass                 M = 4 kg")


def test_what_would_fill_pages_is_one_line_at_a_prompt():
    motion = derived("ZXZ")
    assert repr(motion.note()) == f"<Note {NAME}, 13 equations>"
    assert motion.note()._repr_mimebundle_()["text/markdown"] == motion.note().markdown()
    assert repr(motion.kernels()) == f"<KernelModule {NAME}, numpy: {NAME}.py>"
    assert repr(motion.step("spin_matrix")) == "<Step spin_matrix, proved>"
    assert repr(motion.model) == f"<RotationModel {NAME}: Euler angles ZXZ, intrinsic>"


def test_a_model_shows_its_matrix_and_its_convention():
    bundle = rs.EulerAngles("ZXZ")._repr_mimebundle_()
    assert bundle["text/latex"].startswith(r"$$\mathbf{R} = \left[\begin{matrix}")
    assert r"\sin{\left(\phi \right)} \sin{\left(\theta \right)}" in bundle["text/latex"]
    assert bundle["text/plain"].splitlines() == [
        "Euler angles ZXZ, intrinsic",
        "Intrinsic turns: first φ about z, then θ about the turned x, then ψ about the turned z.",
        "Active: x = R x′ takes body components to space components.",
        "R = Rz(φ) Rx(θ) Rz(ψ)",
    ]
    assert "R = " not in rs.RotationVector()._repr_mimebundle_()["text/plain"]
