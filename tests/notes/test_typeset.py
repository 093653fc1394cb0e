"""Notes through TeX: no warning of any kind, for every convention; and TeX kept in its place."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import pytest
from sympy import Rational, pi, symbols

import rigidsym as rs
from helpers.motions import derived
from helpers.typesetting import BEGIN, END, warnings_of
from rigidsym.errors import MissingTool, ToolFailed
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.scalars import matrix_of
from rigidsym.mechanics.derive import derive
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import axis_turn
from rigidsym.models.rotation import Turn, time_function
from rigidsym.notes.formats import pdf as typesetting
from rigidsym.notes.formats.pdf import typeset
from rigidsym.notes.letters import letters_of
from rigidsym.notes.note import note

pytestmark = pytest.mark.campaign

GREEK = ("phi", "theta", "psi")
WORDS = ("heading", "elevation", "bank")
INDEXED = ("phi_1", "q2", "phi_body")


def _page(body: str) -> str:
    return rf"\documentclass[11pt]{{article}}\usepackage{{lmodern,amsmath}}{BEGIN}{body}{END}"


@pytest.mark.usefixtures("tex")
def test_notes_of_all_conventions_and_of_chains_compile_without_a_warning():
    motions = [
        derive(rs.EulerAngles(sequence, angles, passive=passive))
        for angles, passive, sequences in (
            (GREEK, False, rs.EULER_SEQUENCES),
            (WORDS, True, rs.EULER_SEQUENCES[::4]),  # the widest
            (INDEXED, False, rs.EULER_SEQUENCES[3::9]),
        )
        for sequence in sequences
    ]
    a, b = time_function("a"), time_function("b")
    for axis in ((Rational(3, 5), 0, Rational(4, 5)), symbols("e_1 e_2 e_3"), ()):
        oblique = axis_turn(axis, b) if axis else Turn(axis="y", angle=pi / 6)
        motions.append(derive(rs.chain([oblique, Turn(axis="z", angle=a)])))
    documents = [note(motion, module=f"{motion.name}.py").document for motion in motions]
    assert warnings_of(documents) == ()


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[3,1,-1](psi) [0,-2,3](roll_rate) [2,1,-2](theta)", "is too long for this page"),
        ("[3,-1,-3](phi + pi/6) [-3,3,-3](theta)", r"{\freely\begin{align*}"),
        (
            "z(phi) x(theta) [0,b,c](psi)",
            r"\texttt{chain\_\allowbreak zxu\_\allowbreak passive.py}",
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
    runs, run = [], typesetting._run
    monkeypatch.setattr(typesetting, "_run", lambda *a: runs.append(run(*a)) or runs[-1])
    text = derived("ZXZ").note().latex()
    first, second = typeset(text), typeset(text)
    assert len(runs) == 2 * 2
    assert first.warnings == ()
    assert first.pdf.startswith(b"%PDF-")
    assert first.pdf == second.pdf


@pytest.mark.usefixtures("tex")
@pytest.mark.parametrize("angles", [GREEK, WORDS, INDEXED])
def test_no_formula_is_wider_than_it_was_measured(angles):
    """Each formula in a box of its measured width: TeX reports those that stick out."""
    boxes = list(_formulas_with_widths(angles))
    assert len(boxes) > 100
    lines = (rf"\hbox to {width:.4f}em{{$\displaystyle {text}$}}" for text, width in boxes)
    assert typeset(_page("\\hbadness=10000 \\hfuzz=0.5pt\n" + "\n\n".join(lines))).warnings == ()


def _formulas_with_widths(angles: tuple[str, ...]) -> list[tuple[str, float]]:
    widths: dict[str, float] = {}
    for sequence in ("ZXZ", "ZYX", "yxz"):
        motion = derive(rs.EulerAngles(sequence, angles))
        letters = letters_of(motion.arguments)
        for step in motion.steps:
            formulas = [step.quantity.symbol, *(proof.claim for proof in step.proofs)]
            matrix = matrix_of(step.expression, letters)
            formulas += [*chain(*matrix.rows), matrix]
            widths |= {piece.text: piece.width for piece in map(LatexPen().write, formulas)}
    return list(widths.items())


@pytest.mark.usefixtures("tex")
def test_what_tex_complains_of_is_reported():
    for body, warning in (
        (r"\hbox to 1em{much too long for this}", "Overfull"),
        (r"\hbox to 30em{short}", "Underfull"),
        (r"\ref{nowhere}", "undefined"),
    ):
        assert warning in "".join(typeset(_page(body)).warnings)
    with pytest.raises(ToolFailed, match=r"(?s)end of its log.*Undefined control sequence"):
        typeset(_page(r"\nosuchmacro"))
    with pytest.raises(MissingTool, match=r"needs no-such\.sty, which TeX does not find"):
        typeset(_page("x").replace("{lmodern,", "{no-such,"))
    with pytest.raises(ToolFailed, match="stopped after 2 seconds"):
        typeset(_page(r"\def\x{\x}\x"), timeout=2)


@pytest.mark.usefixtures("tex")
def test_tex_runs_no_program_and_reads_no_file_of_the_user(tmp_path: Path):
    secret = tmp_path / "secret.tex"
    typeset(_page(rf"\immediate\write18{{touch {secret}}}x"))
    assert not secret.exists()
    secret.write_text("secret")
    with pytest.raises(ToolFailed):
        typeset(_page(rf"\input{{{secret}}}"))
