"""What every pen prints has the value that was meant, and keeps its form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from random import Random

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

from helpers.reading import Formula as Reader, latex_of
from helpers.witness import mp, number
from rigidsym.formula import sheet_pen
from rigidsym.formula.display import Equation, display
from rigidsym.formula.latex_pen import LatexPen, MarkdownPen
from rigidsym.formula.letters import Letters, VectorLength
from rigidsym.formula.mathml_pen import MathmlPen, math
from rigidsym.formula.notation import Notation
from rigidsym.formula.pen import Height
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.sheet_pen import Aligned, SheetPen
from rigidsym.formula.tree import (
    Bracket,
    Formula,
    Fraction,
    Gap,
    Matrix,
    Power,
    Rate,
    Sign,
    Symbol,
    row,
)
from rigidsym.formula.unicode_pen import UnicodePen
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.notes.letters import letters_of

ANGLES = dynamicsymbols("phi theta psi")
RATES = [sp.diff(angle, "t", order) for order in (1, 2) for angle in ANGLES]
OMEGA = [*sp.symbols("Omega_1:4"), *sp.symbols("Omega_body_1:4")]
CONSTANTS = sp.symbols("A m_1 h alpha0")
FUNCTIONS = (sp.sin, sp.cos, sp.tan, sp.cot)
LETTERS = letters_of(arguments_of(EulerAngles("ZXZ")))
PENS: dict[str, SheetPen] = {"latex": LatexPen(), "mathml": MathmlPen()}
NAMES = {  # as the reader calls them
    **dict(zip(ANGLES, ("phi", "theta", "psi"), strict=True)),
    **{
        r: f"{d} {a}"
        for r, (d, a) in zip(
            RATES, [(d, a) for d in ("dot", "ddot") for a in ("phi", "theta", "psi")], strict=True
        )
    },
    **{
        w: f"Omega{p}_{k}"
        for w, (p, k) in zip(OMEGA, [(p, k) for p in ("", "'") for k in "123"], strict=True)
    },
    **dict(zip(CONSTANTS, ("A", "m_1", "h", "alpha_0"), strict=True)),
}
VALUES = {symbol: mp.mpf(7 * k % 19 + 3) / 13 for k, symbol in enumerate(NAMES)}
KNOWN = {NAMES[symbol]: value for symbol, value in VALUES.items()} | {"pi": +mp.pi}


def random_scalar(rng: Random, depth: int) -> sp.Expr:
    """A sum, product, quotient, power, root or function of such, down to names and numbers."""
    kind = rng.random()
    if depth == 0 or kind < 0.1:
        return rng.choice(
            [*ANGLES, *RATES, *OMEGA, *CONSTANTS, sp.pi, *map(sp.Integer, (2, 3, 10))]
        )
    parts = [random_scalar(rng, depth - 1) for _ in range(rng.randint(2, 3))]
    if kind < 0.35:
        return sp.Add(*(rng.choice((1, -1, 2, sp.Rational(-3, 2))) * part for part in parts))
    if kind < 0.6:
        return rng.choice((1, -1, 3, sp.Rational(1, 2), sp.sqrt(2))) * sp.Mul(*parts)
    if kind < 0.7:
        return parts[0] / parts[1]
    if kind < 0.85:
        return parts[0] ** rng.choice((2, 3, -1, -2, 10, sp.Rational(3, 2), sp.Rational(-1, 2)))
    if kind < 0.9:
        return sp.sqrt(parts[0] ** 2 + 1)
    angle = rng.choice((parts[0], rng.choice((1, 2, sp.Rational(1, 2))) * rng.choice(ANGLES)))
    if angle.is_number:
        angle += rng.choice(ANGLES)
    return rng.choice(FUNCTIONS)(angle) ** rng.choice((1, 1, 2, -1))


SCALARS = [random_scalar(Random(f"scalar:{k}"), 1 + k % 4) for k in range(240)]


phi, theta, psi = ANGLES
phi_dot, theta_dot, psi_dot, phi_ddot, theta_ddot, _ = RATES
omega, omega_body = OMEGA[:3], OMEGA[3:]
A, m, moment = sp.symbols("A m_1 moment")
sin, cos, tan, cot = FUNCTIONS
READABLE = (  # what depends on the order of factors and terms, on signs and on brackets
    *(sp.Integer(0), -sp.Rational(1, 2), sp.pi / 2, -3 * sp.pi / 4, m, 2 * moment),
    *(sin(psi) * phi_dot * sin(theta), cos(theta) * sin(theta), phi_dot * theta_dot * A * 2),
    *(theta_dot**2 * phi_ddot, sin(phi) * omega[1], sin(psi) * (phi_dot + psi_dot)),
    *(phi_dot * sp.exp(theta), psi_dot - phi_dot * sin(theta), phi_dot * cos(theta) + psi_dot),
    *(-phi_dot - psi_dot, theta_dot * psi_dot + phi_ddot, 1 - cos(theta)),
    cot(theta) * (omega[1] * cos(phi) - omega[0] * sin(phi)) + omega[2],
    sin(psi) * (phi_ddot * sin(theta) + theta_dot * (phi_dot * cos(theta) - psi_dot)),
    *(A * sin(theta) ** 2, phi_dot**2 / 2, omega_body[0] ** 2, (A + m) ** 2, m * A, sp.sqrt(A)),
    *(1 / sp.sqrt(A + m), A ** sp.Rational(3, 2), 1 / sin(theta), -cos(phi) / sin(theta)),
    *(phi_dot / (2 * sin(theta)), sin(phi) ** 2 / (1 + cos(psi))),
    (omega[0] * sin(phi) - omega[1] * cos(phi)) / sin(theta),
    *(phi_dot * (A + 1 / sin(theta)), sin(2 * theta), cos(theta / 2), sin(phi + psi) ** 2),
    *(cos(sp.exp(theta)) * theta_dot, tan(A * theta), sin(moment)),
    *(m * phi_dot**2 + A * phi_dot, m * (phi_dot + psi_dot) ** 2 + A * (phi_dot + psi_dot)),
    *(m * sp.sqrt(phi_dot + psi_dot) + A * (1 + theta), (-A - m) * (-theta_dot - phi_dot)),
    *((-A - m) * (-theta_dot - phi_dot) * (-1 - theta), tan(psi) - sin(phi) * cos(theta) ** 2 * A),
)


def read(text: str) -> object:
    return Reader(text, KNOWN).value()


@pytest.mark.parametrize("pen", PENS)
def test_a_printed_scalar_is_read_as_the_value_that_it_has(pen):
    for scalar in SCALARS:
        printed = PENS[pen].write(formula_of(scalar, LETTERS)).text
        text = latex_of(math(printed, "")) if pen == "mathml" else printed
        expected = number(scalar, dict(VALUES))
        assert mp.fabs(read(text) - expected) <= mp.mpf(10) ** -30 * (1 + mp.fabs(expected)), (
            printed
        )


BASES = ("a + b", r"a\,b", r"\cos\tau", r"\frac{a}{b}", "x^2")  # each in brackets


def forms() -> Iterator[tuple[str, Formula]]:
    """Formulas with every kind of node, beside random scalars."""
    typed = (
        r"\mathbf{R}' = \boldsymbol{\Omega}\,\mathbf{R}",
        r"\mathbf{C}(\boldsymbol{\Omega}')^\mathsf{T}\,\dot{\mathbf{q}}",
        r"\mathbf{W}'^{-1}_{12} + \mathbf{L}_R + \mathbf{e}^\perp_i",
        r"\boldsymbol{\Omega}'^2 + {\Omega'_1}^2 + \dot{\Omega}'_2 + \ddot{\varphi}^2",
        r"\sum_{i=1}^n m_i\,\mathbf{r}_i + \int_0^{2 \pi} f\,du + \sum_i a_i + \int x\,dm",
        r"\begin{pmatrix} a & \frac{b}{2} \\ \dot{c} & \sqrt{\frac{d}{e}} \\ 0 & 1 \end{pmatrix}",
        r"\begin{pmatrix} \dot{a} \\ \dot{b} \\ c \\ d \end{pmatrix}",
        r"\begin{pmatrix} a \\ \frac{b}{2} \\ \frac{c}{2} \\ d \end{pmatrix}",
        r"\frac{\partial \mathbf{R}}{\partial \theta} \pm a \le b \Leftrightarrow c \in d, e; f",
        r"|\mathbf{v}|^2 + |\frac{a}{b}| + [a, b] + \det\mathbf{W} + \exp(\frac{a}{2})^2",
        r"\sin^2(\frac{\theta}{2} + \varphi) + \operatorname{my_f}(x)",
        r"a \cdot b \times c \qquad \mathit{length}_2 + \mathit{yaw} \text{ if } x \ldots",
        r"\Gamma + \epsilon + h + k + \dot{h} + \dot{\beta} + \dot{m} + \dot{\mathbf{B}}",
        r"\dot{M}' + \ddot{\mathbf{d}}'",
        r"x_{\frac{1}{2}} + x_{(\frac{a}{b})} + I_{12} + \mathbf{I}'_P",
        r"\boldsymbol{\varphi} + \mathbf{h} + \mathsf{T} + \mathrm{Ti} + a < b",
    )
    yield from ((text, formula(text)) for text in typed)
    yield from (("power", formula("#1^2", formula(base))) for base in BASES)
    phi, turn = formula(r"\varphi"), formula(r"\dot{\varphi}")
    heading, both = Symbol("heading", dots=1), formula("a + b")
    yield from (
        ("rate", Rate(phi)),
        ("second rate", Rate(Symbol("R", "bold"), 2)),
        ("rate of a bracket", Rate(Bracket(both))),
        ("rate squared", Power(Bracket(Rate(phi)), formula("2"))),
        ("rate in a bracket", row(formula("a"), Bracket(row(Rate(phi), Sign("+"), turn)))),
        ("square of a fraction", Power(Bracket(Fraction(phi, turn)), formula("2"))),
        ("square of a prime", Power(Symbol("b", prime="′"), formula("2"))),
        ("power of a row", Power(both, formula("2"))),
        ("power of a root", Power(formula(r"\sqrt{a}"), formula("10"))),
        ("superscript", Symbol("Ω", "bold", prime="ᴮ", index=formula("1"))),
        ("superscript squared", Power(Symbol("Ω", prime="ᴮ"), formula("2"))),
        ("arrow", Symbol("d", "arrow", dots=1)),
        ("word with dots", heading),
        ("word of two letters", Symbol("ab")),
        ("unit", Symbol("&", "italic")),
        ("macro", Symbol("φ", macro=r"\varphi")),
        ("double dots", row(Symbol("M", dots=2), Symbol("x", dots=2), Symbol("Ω", "bold", 2, "′"))),
    )
    yield from ((str(scalar), formula_of(scalar, LETTERS)) for scalar in SCALARS[:40])
    yield from ((str(scalar), formula_of(scalar, LETTERS)) for scalar in READABLE)
    names = letters_of(arguments_of(EulerAngles("ZYX", ("heading", "phi_1", "q2"))))
    heading, indexed, q = dynamicsymbols("heading phi_1 q2", 1)
    for rate in (indexed, q, heading, heading.diff(), heading**2 * CONSTANTS[0] / 2, heading / 2):
        yield f"{rate} of angles with names", formula_of(rate, names)
    yield "a sine of the time", formula_of(sp.sin(sp.Symbol("t")) ** 2, LETTERS)
    by_fraction = Notation(rates="fraction", vectors="arrow", body="superscript")
    letters = letters_of(arguments_of(EulerAngles("ZXZ")), by_fraction)
    for scalar in (
        CONSTANTS[0] / 2,
        ANGLES[1] / 2,
        RATES[0] / 2,
        3 * RATES[0] ** 2 * RATES[3],
        (RATES[1] + OMEGA[4]) ** 2 / 2,
    ):
        yield f"{scalar} by fractions", formula_of(scalar, letters)
    x, y, z = components = tuple(map(sp.Function, "xyz"))
    components = tuple(part(sp.Symbol("t")) for part in (x, y, z))
    length = VectorLength(components, *sp.symbols("n n_dot"), "n")
    square = sum(part**2 for part in components)
    for scalar in (
        square,
        1 - 2 * square,
        sp.sin(sp.sqrt(square)),
        sum(components),
        sp.diff(square, "t"),
        square + components[0] ** 2,
        components[0] ** 2 + 2 * components[1] ** 2 + components[2] ** 2,
    ):
        yield (
            f"{scalar} with a length",
            formula_of(scalar, Letters(names=length.names, length=length)),
        )


def test_the_forms_of_the_pens_are_as_they_were(golden):
    lines = []
    for name, tree in forms():
        lines.append(name)
        for pen in (
            LatexPen(),
            LatexPen(short=True),
            LatexPen(loose=True),
            MarkdownPen(),
            MathmlPen(),
            UnicodePen(),
        ):
            written = pen.write(tree).text.replace("\n", "⏎")
            if f"    {written}" not in lines[-6:]:
                lines.append(f"    {written}")
    golden("notes/formulas.txt", "\n".join(lines) + "\n")


def test_lines_below_one_another_are_aligned_at_their_signs(golden):
    rows = (
        Aligned("a", "b + c", "="),
        Aligned("", "d", "=", 0, Height.TALL),
        Aligned("", "+ e", "", 2),
        Aligned("f", "g"),
    )
    texts = [
        f"{type(pen).__name__}, high: {is_high}\n{written}\n"
        for pen in (LatexPen(), MarkdownPen(), MathmlPen())
        for is_high in (False, True)
        for written in (
            pen.aligned(rows, is_high),
            pen.gathered([pen.continued("a", 0), pen.continued("b", 3)], is_high),
        )
    ]
    golden("notes/rows.txt", "\n".join(texts))


@pytest.mark.parametrize("pen", PENS.values(), ids=list(PENS))
def test_widths_add_up(pen):
    def width(markup: str) -> float:
        return pen.write(formula(markup)).width

    both, upper, lower = (
        width(rf"\begin{{pmatrix}} {rows} \end{{pmatrix}}")
        for rows in (r"a & b+c \\ a+b+c & d", "a & b+c", "a+b+c & d")
    )
    assert both == pytest.approx(upper + width("a+b+c") - width("a"))
    assert both == pytest.approx(lower + width("b+c") - width("d"))
    one, two = (width(rf"\begin{{pmatrix}} {row} \end{{pmatrix}}") for row in ("a", "a & a"))
    assert one == pytest.approx(width("a") + sheet_pen.TALL_BRACKETS)
    assert two == pytest.approx(one + width("a") + sheet_pen.COLUMN_GAP)
    assert width(r"\sqrt{a}") == pytest.approx(width("a") + sheet_pen.ROOT)
    assert pen.write(Gap()).width == 2 * sheet_pen.QUAD  # \qquad
    assert width("12") == 2 * width("1")
    assert width("a'") == pytest.approx(width("a") + sheet_pen.PRIME)
    assert width("a_b") == pytest.approx(width("a") + sheet_pen.SCRIPT * width("b"))
    assert width("a^b") == pytest.approx(width("a") + sheet_pen.SCRIPT * width("b"))
    assert width(r"\sin^2 a") == pytest.approx(width(r"\sin a") + sheet_pen.SCRIPT * width("2"))
    for quotient in (r"\frac{a + b}{c}", r"\frac{c}{a + b}"):
        assert width(quotient) == pytest.approx(width("a + b") + sheet_pen.FRACTION)
    assert width("(a)") == pytest.approx(width("a") + 2 * sheet_pen.BRACKET)
    assert width("(a)^2") == pytest.approx(width("(a)") + sheet_pen.SCRIPT * width("2"))
    rate = Rate(formula(r"\varphi"))
    alone, small = pen.write(rate).width, replace(pen, small=True).write(rate).width
    assert small == pytest.approx(sheet_pen.SCRIPT * alone)
    assert pen.write(Matrix(((rate,),))).width == pytest.approx(small + sheet_pen.TALL_BRACKETS)
    sides = 2 * (sheet_pen.BRACKET + sheet_pen.LARGE["large"])
    assert pen.write(Bracket(rate)).width == pytest.approx(alone + sides)
    superscript = Symbol("a", prime="ᴮ")
    assert pen.write(superscript).width == pytest.approx(width("a") + sheet_pen.SCRIPT)


def test_a_quotient_on_one_line_is_bracketed_beside_another_factor_and_nowhere_else():
    quotient, a = formula(r"\frac{b}{c}"), formula("a")
    for parts, text in (
        ((quotient,), "b/c"),
        ((a, quotient), "a (b/c)"),
        ((quotient, a), "(b/c) a"),
        ((a, quotient, a), "a (b/c) a"),
        ((a, Sign("+"), quotient), "a + b/c"),
        ((quotient, Sign("+"), a), "b/c + a"),
        ((a, Sign("·"), quotient), "a·(b/c)"),
    ):
        assert UnicodePen().write(row(*parts)).text == text


def test_rows_of_a_matrix_are_as_far_apart_as_their_heights_need():
    heights = {"letter": "a", "fraction": r"\frac{a}{b}", "root": r"\sqrt{\frac{a}{b}}"}
    trees = {name: formula(typed) for name, typed in heights.items()}
    trees["rate"] = Rate(formula(r"\varphi"))
    for pair, points in {
        "letter letter": 2,
        "rate letter": 5,
        "letter rate": 5,
        "letter fraction": 7,
        "fraction letter": 10,
        "rate fraction": 10,
        "fraction root": 13,
        "root letter": 13,
    }.items():
        rows = tuple((trees[name],) for name in pair.split())
        assert f"\\\\[{points}pt]" in LatexPen().write(Matrix(rows)).text, pair


def test_a_formula_among_words_is_cut_only_if_it_is_too_wide():
    wide = formula(" + ".join(r"\dot{\varphi}\,(a - b)" for _ in range(6)))
    narrow, high, cut = map(MathmlPen().inline, (formula("a + b"), formula(r"\frac{a}{b}"), wide))
    assert [len(piece.chunks) for piece in (narrow, high, cut)] == [1, 1, 6]
    assert [bool(piece.height) for piece in (narrow, high)] == [False, True]
    assert 'class="tall"' in high.text
    assert all("(" in chunk.text and ")" in chunk.text for chunk in cut.chunks)


def test_a_listing_over_pages_has_the_lines_that_it_has_in_one_display():
    """Entries at their signs, and definitions each in the middle."""
    value = sum(sp.Symbol(f"a_{k}") * sp.sin(theta) for k in range(40))
    matrix = sp.ImmutableMatrix([value, value + 1])
    names = (formula("k_1"), formula("k_2"))
    for sides, is_aligned in (((formula(r"\mathbf{w}"),), True), ((), False)):
        equation = Equation(sides=sides, matrix=matrix, entries=names)
        shown = display(equation, LETTERS, 30.0)
        assert (shown.are_aligned, shown.lines > 4) == (is_aligned, True)
        assert shown.joined(LatexPen()) in shown.text
        assert ("&" in shown.text) == is_aligned
