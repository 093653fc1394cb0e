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
from rigidsym.formula.scalars import factored, listed_entries
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
    assert [line.level for line in lines_of(LONG, 30)] == [0, 1, 0, 0]


def test_a_line_may_be_as_wide_as_there_is_room():
    for width, lines in (
        (13, ["a + b (c + d)"]),
        (11, ["a", "+ b (c + d)"]),
        (10, ["a", "+ b (c", "+ d)"]),
    ):
        assert [line.text for line in lines_of(r"a + b\,(c + d)", width, 0)] == lines
    assert [line.text for line in lines_of("a + b + c", 5, 0)] == ["a + b", "+ c"]


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


# --- what stands before a matrix, and which of its entries are listed

x, y, z, d = sp.symbols("x y z d")
half = sp.Rational(1, 2)


@pytest.mark.parametrize(
    ("entries", "factor", "rest"),
    [
        ([x / 2, y], half, [x, 2 * y]),
        ([x * y, x * z, 0], x, [y, z, 0]),
        ([x**2 * y, x**3 * z + x**2 * y], x**2, [y, x * z + y]),
        ([2 * x / d, 4 * y / d], 2 / d, [x, 2 * y]),
        ([half, x / 3], half / 3, [3, 2 * x]),
        ([1 - 2 * y**2 / d, 2 * x * y / d], 1 / d, [d - 2 * y**2, 2 * x * y]),
        ([x / d + y / d, x / d], 1 / d, [x + y, x]),
        ([half * x + half * y * (1 + z), half * x], half, [x + y * (1 + z), x]),
        # as short as they can be
        *(
            (entries, 1, entries)
            for entries in (
                [2 * x, 4 * y],
                [2 * sp.sqrt(x), 4 * y],
                [x, 0],
                [x / y, y],
                [1 + x / y, 2 + z / y],
                [x / d + y, x, y],
            )
        ),
    ],
)
def test_a_common_factor_or_divisor_stands_before_the_matrix(entries, factor, rest):
    assert factored(sp.ImmutableMatrix(entries)) == (factor, sp.ImmutableMatrix(rest))


def test_entries_that_are_equal_by_symmetry_are_listed_once():
    names = [formula(f"I_{{{i}{j}}}") for i in "123" for j in "123"]
    a, b, c, d, e, f = sp.symbols("a:f")
    tensor = sp.ImmutableMatrix([[a, b, c], [b, d, e], [c, e, f]])
    listed = [(name.text, value) for name, value in listed_entries(names, tensor)]
    twice = [("I₁₁", a), ("I₁₂ = I₂₁", b), ("I₁₃ = I₃₁", c), ("I₂₂", d), ("I₂₃ = I₃₂", e)]
    assert listed == [*twice, ("I₃₃", f)]
    other = tensor + sp.ImmutableMatrix(3, 3, lambda i, j: 1 if i < j else 0)
    assert [name.text for name, _ in listed_entries(names, other)] == [n.text for n in names]


def test_the_root_of_a_number_stands_above_the_line():
    root = sp.sqrt(2) / 2
    for expression, as_latex, as_text in (
        (root * A, r"\frac{\sqrt{2}}{2}\,A", "(√2/2) A"),
        (3 * sp.sqrt(2) * sin(theta) * A, r"3 \sqrt{2}\,A \sin\theta", "3√2 A sin θ"),
        (root * A / m, r"\frac{\sqrt{2}\,A}{2 m_1}", "√2 A/(2m₁)"),
        (-root, r"-\frac{\sqrt{2}}{2}", "−√2/2"),
    ):
        assert (latex(expression, LETTERS), text(expression, LETTERS)) == (as_latex, as_text)


def test_typed_formulas_and_prompts():
    parts = [formula(letter) for letter in "abcdefghij"]
    assert formula("#10 + #1", *parts) == formula("j + a")
    assert repr(formula(r"\mathbf{R}\,\mathbf{\Omega}'")) == "<R Ω′>"
    assert [formula(rf"p_{{\{name}}}").text for name in ("phi", "theta")] == ["p_φ", "p_θ"]
    integral, total = (MathmlPen().write(formula(rf"\{s}_i^n")).text for s in ("int", "sum"))
    assert "<msubsup>" in integral
    assert "<munderover>" in total
