"""Formulas as people read them: exact forms, the order of factors and terms, no ambiguity."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.printing import latex, text
from rigidsym.errors import AlgebraError
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.mathml_pen import MathmlPen
from rigidsym.formula.pen import Segment, break_lines
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import factored
from rigidsym.formula.tree import Big, Symbol
from rigidsym.formula.unicode_pen import UnicodePen, columns
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.notes.letters import letters_of

phi, theta, psi = dynamicsymbols("phi theta psi")
phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)
phi_ddot, theta_ddot = dynamicsymbols("phi theta", 2)
omega = sp.symbols("Omega_1:4")
omega_body = sp.symbols("Omega_body_1:4")
A, m, moment = sp.symbols("A m_1 moment")
sin, cos, tan, cot = sp.sin, sp.cos, sp.tan, sp.cot

LETTERS = letters_of(arguments_of(EulerAngles("ZXZ")))


@pytest.mark.parametrize(
    ("expression", "kind"),
    [(sp.Integral(theta, phi), "Integral"), (A**m, "Pow"), (sp.Matrix([1]), "Matrix")],
)
def test_a_node_without_a_form_is_named(expression, kind):
    with pytest.raises(AlgebraError, match=rf"no printed form for .* of type \w*{kind}"):
        latex(expression, LETTERS)


def test_the_tenth_part_of_a_typed_formula_is_not_the_first_part_and_a_zero():
    parts = [formula(letter) for letter in "abcdefghij"]
    assert formula("#10 + #1", *parts) == formula("j + a")


# --- laws ---


def _entries(motion: rs.Motion) -> Iterator[tuple[sp.Expr, str, Letters]]:
    letters = letters_of(motion.arguments)
    for step in motion.steps:
        for entry in step.expression:
            yield entry, text(entry, letters), letters


def test_no_sum_starts_with_a_minus_if_it_has_a_positive_term(motion):
    for entry, _, letters in _entries(motion):
        for node in sp.preorder_traversal(entry):
            if node.is_Add and text(node, letters).startswith("−"):
                assert all(term.as_coeff_Mul()[0] < 0 for term in node.args), node


# Macros that LaTeX, math-core and MathJax know.
MACROS = {
    *(r"\sin", r"\cos", r"\tan", r"\cot", r"\frac", r"\left", r"\right", r"\dot", r"\ddot"),
    *(r"\phi", r"\theta", r"\psi", r"\Omega"),
}


def test_formulas_use_only_macros_that_every_printer_knows(motion):
    letters = letters_of(motion.arguments)
    for entry, _, _ in _entries(motion):
        assert set(re.findall(r"\\[A-Za-z]+", latex(entry, letters))) <= MACROS


# --- breaking ---

LONG = (
    r"\sin\psi\,(\ddot{\phi}\sin\theta + \dot{\theta}\,(\dot{\phi}\cos\theta - \dot{\psi}))"
    r" + \cos\psi\,(\ddot{\theta} + \dot{\phi}\,\dot{\psi}\sin\theta)"
    r" - \frac{\dot{\phi}}{1 + \cos\theta}"
)


def lines_of(typed: str, width: float, indent: float = 2) -> list[Segment]:
    return break_lines(UnicodePen().write(formula(typed)), width, indent, UnicodePen.blank)


@pytest.mark.parametrize(
    ("width", "lines"),
    [
        (
            100,
            [
                "sin ψ (φ̈ sin θ + θ̇ (φ̇ cos θ − ψ̇)) + cos ψ (θ̈ + φ̇ ψ̇ sin θ) − φ̇/(1 + cos θ)",
            ],
        ),
        (
            70,
            [
                "sin ψ (φ̈ sin θ + θ̇ (φ̇ cos θ − ψ̇)) + cos ψ (θ̈ + φ̇ ψ̇ sin θ)",
                "− φ̇/(1 + cos θ)",
            ],
        ),
        (
            30,
            [
                "sin ψ (φ̈ sin θ",
                "+ θ̇ (φ̇ cos θ − ψ̇))",
                "+ cos ψ (θ̈ + φ̇ ψ̇ sin θ)",
                "− φ̇/(1 + cos θ)",
            ],
        ),
    ],
)
def test_lines_break_before_signs_in_the_outermost_bracket(width, lines):
    broken = lines_of(LONG, width)
    assert [line.text for line in broken] == lines
    assert [line.width for line in broken] == list(map(columns, lines))
    assert all(columns(line) <= width for line in lines)


@pytest.mark.parametrize(
    ("width", "lines"),
    [
        (13, ["a + b (c + d)"]),
        (12, ["a", "+ b (c + d)"]),
        (11, ["a", "+ b (c + d)"]),
        (10, ["a", "+ b (c", "+ d)"]),
    ],
)
def test_a_line_may_be_as_wide_as_there_is_room(width, lines):
    assert [line.text for line in lines_of(r"a + b\,(c + d)", width, 0)] == lines
    longer = [line.text for line in lines_of("a + b + c", 5, 0)]
    assert longer == ["a + b", "+ c"]


def test_a_line_inside_a_bracket_knows_how_deep_it_is():
    assert [line.level for line in lines_of(LONG, 30)] == [0, 1, 0, 0]


def test_lines_lose_their_indent_for_each_bracket_that_is_open():
    for inside, indent, lines in (
        (r"c\,(d + e + f + g)", 0, ["a (b", "+ c (d + e + f", "+ g))"]),
        (r"c\,(d + e + f + g)", 2, ["a (b", "+ c (d + e", "+ f + g))"]),
        (r"\mathit{ccc}\,(d + e + f)", 2, ["a (b", "+ ccc (d + e", "+ f))"]),
        (r"\mathit{ccc}\,(d + e)", 2, ["a (b", "+ ccc (d + e))"]),
        (r"\mathit{ccc}\,(d + e + f)", 3, ["a (b", "+ ccc (d", "+ e + f))"]),
    ):
        found = lines_of(rf"a\,(b + {inside})", 14, indent)
        assert [line.text for line in found] == lines


def test_a_divisor_is_broken_where_nothing_else_can_be():
    quotient = r"\frac{4\,(a + b)}{(1 + n^2)^2}"
    assert [line.text for line in lines_of(quotient, 16, 0)] == ["4(a", "+ b)/(1 + n²)²"]
    quotient = r"\frac{4 a}{1 + n^2}"
    assert [line.text for line in lines_of(quotient, 8, 0)] == ["4a/(1", "+ n²)"]
    for below in ("1 + n^2", "(1 + n^2)^2"):  # one bracket is open, written or not
        lines = lines_of(rf"\frac{{4 a}}{{{below}}}", 8, 0)
        assert [line.level for line in lines] == [0, 1], below


def test_fractions_and_stretched_brackets_are_never_broken_in_a_note():
    quotient = LatexPen().write(formula(r"\frac{a + b}{c} + (d + e + \frac{f}{g})"))
    lines = break_lines(quotient, 1, 1)
    assert [line.text for line in lines] == [
        r"\frac{a + b}{c}",
        r"+ \left(d + e + \frac{f}{g}\right)",
    ]


@pytest.mark.parametrize(("word", "width"), [("φ̇", 1), ("abc", 3), ("Ω̇′₁", 3), ("中", 2)])
def test_columns_of_a_terminal(word, width):
    assert columns(word) == width


def test_no_line_ends_between_left_and_right():
    """Also behind a bracket that a line before has opened."""
    typed = formula(r"a\,(b + c)^2\,(d + e + \frac{f}{g})")
    for width in range(4, 40, 4):
        for line in break_lines(LatexPen().write(typed), float(width), 2.0):
            assert line.text.count(r"\left") == line.text.count(r"\right")
        loose = break_lines(LatexPen(loose=True).write(typed), float(width), 2.0)
        assert not any(r"\left" in line.text for line in loose)


def test_the_root_of_a_number_stands_above_the_line():
    half = sp.sqrt(2) / 2
    for expression, as_latex, as_text in (
        (half * A, r"\frac{\sqrt{2}}{2}\,A", "(√2/2) A"),
        (3 * sp.sqrt(2) * sin(theta) * A, r"3 \sqrt{2}\,A \sin\theta", "3√2 A sin θ"),
        (half * A / m, r"\frac{\sqrt{2}\,A}{2 m_1}", "√2 A/(2m₁)"),
        (sp.sqrt(m) * A / 2, r"\frac{1}{2}\,A\,\sqrt{m_1}", "½A √m₁"),
    ):
        assert (latex(expression, LETTERS), text(expression, LETTERS)) == (as_latex, as_text)
    assert text(half, LETTERS) == "√2/2"
    assert latex(half, LETTERS) == r"\frac{\sqrt{2}}{2}"
    assert text(-half, LETTERS) == "−√2/2"


def test_what_all_entries_share_is_taken_out_only_if_that_is_shorter():
    x, y = sp.symbols("x y")
    whole = sp.ImmutableMatrix([[2 * x, 4], [6 * y, 8]])
    assert factored(whole) == (1, whole)  # whole numbers stay
    number, rest = factored(whole / 3)
    assert (number, rest) == (sp.Rational(2, 3), whole / 2)
    shared, rest = factored(m * whole)
    assert (shared, rest) == (2 * m, whole / 2)


def test_a_sum_and_an_integral_have_their_bounds():
    i, n = Symbol("i", "italic"), Symbol("n", "italic")
    pen = LatexPen(LETTERS.notation)
    assert pen.write(Big("∫", i, n)).text == r"\int_i^n"
    assert pen.write(Big("∑", i, n)).text == r"\sum_i^n"
    mathml = MathmlPen(LETTERS.notation)
    integral, total = (mathml.write(Big(sign, i, n)).text for sign in "∫∑")
    assert re.findall(r"<(m\w+)>", integral)[0] == "msubsup"
    assert re.findall(r"<(m\w+)>", total)[0] == "munderover"
