"""Notes through TeX: no warning of any kind, for every convention; and TeX kept in its place."""

from __future__ import annotations

import subprocess
from itertools import chain
from pathlib import Path

import pytest
from sympy import Rational, pi, symbols

import rigidsym as rs
from helpers.typesetting import BEGIN, END, warnings_of
from rigidsym.errors import MissingTool, ToolFailed
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.scalars import matrix_of
from rigidsym.formula.tree import Matrix
from rigidsym.mechanics.derive import derive
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import (
    EULER_SEQUENCES,
    EulerAngles,
    axis_turn,
    chain as chain_of,
)
from rigidsym.models.rotation import Citation, RotationModel, Turn, elementary, time_function
from rigidsym.notes.formats import pdf as typesetting
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.letters import letters_of
from rigidsym.notes.note import note

pytestmark = pytest.mark.campaign

GREEK = ("phi", "theta", "psi")
WORDS = ("heading", "elevation", "bank")
INDEXED = ("phi_1", "q2", "phi_body")


def _note(sequence: str) -> str:
    motion = derive(EulerAngles(sequence, GREEK))
    return note(motion, module=f"{motion.name}.py").latex()


def _page(body: str) -> str:
    return rf"\documentclass[11pt]{{article}}\usepackage{{lmodern,amsmath}}{BEGIN}{body}{END}"


@pytest.mark.usefixtures("tex")
def test_notes_of_all_conventions_and_of_chains_compile_without_a_warning():
    motions = [
        derive(EulerAngles(sequence, angles, passive=passive))
        for angles, passive, sequences in (
            (GREEK, False, EULER_SEQUENCES),
            (WORDS, True, EULER_SEQUENCES[::4]),  # the widest
            (INDEXED, False, EULER_SEQUENCES[3::9]),
        )
        for sequence in sequences
    ]
    a, b = time_function("a"), time_function("b")
    for axis in ((Rational(3, 5), 0, Rational(4, 5)), symbols("e_1 e_2 e_3"), ()):
        oblique = axis_turn(axis, b) if axis else Turn(axis="y", angle=pi / 6)
        motions.append(derive(chain_of([oblique, Turn(axis="z", angle=a)])))
    documents = [note(motion, module=f"{motion.name}.py").document for motion in motions]
    assert warnings_of(documents) == ()


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[3,1,-1](psi) [0,-2,3](roll_rate) [2,1,-2](theta)", "The explicit components"),
        ("[3,-1,-3](phi + pi/6) [-3,3,-3](theta)", r"{\freely\begin{align*}"),
        (
            "z(phi) x(theta) [0,b,c](psi)",
            r"from\_\allowbreak quaternion(\allowbreak quaternion, parameters)",
        ),
    ],
)
def test_what_a_page_has_no_room_for_goes_on_on_the_next(text, says):
    """Displays higher than a page, names in the text, words of which no part is in the fonts."""
    motion = rs.derive(rotation_from(text, passive=True))
    written = motion.note(conversions=True, style="audit").latex()
    assert says in written
    assert "[U+" not in written
    assert typeset(written).warnings == ()


@pytest.mark.usefixtures("tex")
def test_the_same_note_gives_the_same_pdf_in_two_runs_of_tex(monkeypatch: pytest.MonkeyPatch):
    """The second run knows the numbers; a table that they made wider would need two more."""
    printed, run = [], typesetting._run
    monkeypatch.setattr(typesetting, "_run", lambda *a: printed.append(run(*a)) or printed[-1])
    text = _note("ZXZ")
    first, second = typeset(text), typeset(text)
    assert [output.count("Run number") for output in printed] == [2, 2]
    assert first.warnings == ()
    assert first.pdf.startswith(b"%PDF-")
    assert first.pdf == second.pdf


@pytest.mark.usefixtures("tex")
def test_odd_text_compiles():
    letters = "".join(map(chr, chain(range(0x21, 0x7F), range(0xA0, 0x180), range(0x391, 0x3CA))))
    a, b = time_function("a"), time_function("b")
    model = RotationModel(
        name="odd",
        title=" ".join(letters),
        convention=("Turns of a\u0307 and φ\u0308, Rᵀ ≠ R⁻¹, − × · ± ∂ √ ∞ ≤ ≥ ≈ → x₁ “x” 中 ẋ.",),
        coordinates=(a, b),
        matrix=elementary("z", a) * elementary("x", b),
        source=Citation(text=" ".join(letters), equation="#1"),
    )
    assert typeset(note(derive(model)).latex()).warnings == ()


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize("angles", [GREEK, WORDS, INDEXED])
def test_no_formula_is_wider_than_it_was_measured(angles):
    """Each formula in a box of its measured width: TeX reports those that stick out."""
    boxes = list(_formulas_with_widths(angles))
    assert len(boxes) > 100
    assert typeset(_boxes(boxes, 1.0)).warnings == ()


@pytest.mark.usefixtures("tex")
def test_most_formulas_are_nearly_as_wide_as_measured():
    boxes = [(formula, width) for formula, width in _formulas_with_widths(GREEK) if width > 5]
    assert len(typeset(_boxes(boxes, 0.85)).warnings) > 0.9 * len(boxes)


def _formulas_with_widths(angles: tuple[str, ...]) -> list[tuple[str, float]]:
    widths: dict[str, float] = {}
    for sequence in ("ZXZ", "ZYX", "yxz"):
        motion = derive(EulerAngles(sequence, angles))
        letters = letters_of(motion.arguments)
        for step in motion.steps:
            formulas = [step.quantity.symbol, *_claims(step)]
            rows = matrix_of(step.expression, letters)
            formulas += [*chain(*rows), Matrix(tuple(map(tuple, rows)))]
            for pen in (LatexPen(), LatexPen(short=True)):
                widths |= {piece.text: piece.width for piece in map(pen.write, formulas)}
    return list(widths.items())


def _claims(step):
    return (proof.claim for proof in step.proofs)


def _boxes(boxes: list[tuple[str, float]], scale: float) -> str:
    lines = (
        rf"\hbox to {scale * width:.4f}em{{$\displaystyle {formula}$}}" for formula, width in boxes
    )
    return _page("\\hbadness=10000 \\hfuzz=0.5pt\n" + "\n\n".join(lines))


# --- TeX kept in its place ---


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize(
    ("body", "said"),
    [
        (r"\hbox to 1em{much too long for this}", "Overfull"),
        (r"\hbox to 30em{short}", "Underfull"),
        (r"\ref{nowhere}", "undefined"),
    ],
)
def test_what_tex_complains_of_is_reported(body, said):
    warnings = typeset(_page(body)).warnings
    assert any(said in warning for warning in warnings), warnings


@pytest.mark.usefixtures("tex")
def test_an_error_of_tex_shows_the_end_of_its_log():
    with pytest.raises(ToolFailed, match=r"(?s)end of its log.*Undefined control sequence"):
        typeset(_page(r"\nosuchmacro"))


@pytest.mark.usefixtures("tex")
def test_tex_that_does_not_stop_is_stopped():
    with pytest.raises(ToolFailed, match="stopped after 2 seconds"):
        typeset(_page(r"\def\x{\x}\x"), timeout=2)


@pytest.mark.usefixtures("tex")
def test_tex_runs_no_program(tmp_path: Path):
    target = tmp_path / "made"
    typeset(_page(rf"\immediate\write18{{touch {target}}}x"))
    assert not target.exists()


@pytest.mark.usefixtures("tex")
def test_tex_reads_no_file_of_the_user(tmp_path: Path):
    secret = tmp_path / "secret.tex"
    secret.write_text("secret")
    with pytest.raises(ToolFailed):
        typeset(_page(rf"\input{{{secret}}}"))


@pytest.mark.usefixtures("tex")
def test_an_interrupt_ends_tex(monkeypatch: pytest.MonkeyPatch):
    started = []

    class Interrupted(typesetting.subprocess.Popen):
        def communicate(self, *args, **kwargs):
            if not started:
                started.append(self)
                raise KeyboardInterrupt
            return super().communicate(*args, **kwargs)

    monkeypatch.setattr(typesetting.subprocess, "Popen", Interrupted)
    with pytest.raises(KeyboardInterrupt):
        typeset(_page(r"\def\x{\x}\x"))
    assert started[0].returncode is not None


def test_without_tex_the_debian_packages_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(MissingTool) as caught:
        typeset(_page("x"))
    assert str(caught.value) == (
        "a PDF needs latexmk and pdflatex, not found here; on Debian: apt install "
        "texlive-latex-recommended texlive-pictures latexmk lmodern"
    )
    assert caught.value.exit_code == 4


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize(
    ("style", "debian", "tex_live"),
    [("tikz", "texlive-pictures", "pgf"), ("booktabs", "texlive-latex-recommended", "booktabs")],
)
def test_without_a_package_of_tex_its_packages_are_named(monkeypatch, style, debian, tex_live):
    found = subprocess.run(["kpsewhich", "article.cls"], capture_output=True, text=True, check=True)
    monkeypatch.setenv("TEXINPUTS", f".:{Path(found.stdout).parent}")  # nothing but LaTeX itself
    with pytest.raises(MissingTool) as caught:
        typeset(rf"\documentclass{{article}}\usepackage{{{style}}}{BEGIN}x{END}")
    assert str(caught.value) == (
        f"a PDF needs {style}.sty, which TeX does not find; on Debian: apt install {debian}, with "
        f"TeX Live: tlmgr install {tex_live}"
    )
