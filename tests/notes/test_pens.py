"""What every pen prints has the value that was meant, and keeps its form."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

from helpers.reading import Formula as Reader, latex_of
from helpers.witness import mp, number
from rigidsym.formula import sheet_pen
from rigidsym.formula.latex_pen import LatexPen, MarkdownPen
from rigidsym.formula.letters import Letters, VectorLength
from rigidsym.formula.mathml_pen import MathmlPen, math
from rigidsym.formula.notation import Notation
from rigidsym.formula.pen import Height
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import factored, formula_of, listed_entries
from rigidsym.formula.sheet_pen import Aligned, SheetPen
from rigidsym.formula.tree import (
    Bracket,
    Formula,
    Fraction,
    Gap,
    Indexed,
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


@pytest.mark.parametrize(
    ("base", "latex", "text"),
    [
        ("a + b", "(a + b)^2", "(a + b)²"),
        (r"a\,b", r"(a\,b)^2", "(a b)²"),
        (r"\cos\tau", r"(\cos\tau)^2", "(cos τ)²"),
        (r"\frac{a}{b}", r"\left(\frac{a}{b}\right)^2", "(a/b)²"),
        ("x^2", "(x^2)^2", "(x²)²"),
    ],
)
def test_the_base_of_a_power_is_put_in_brackets(base, latex, text):
    power = formula("#1^2", formula(base))
    assert (power.latex, power.text) == (latex, text)


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


def test_rows_of_a_matrix_are_as_far_apart_as_their_heights_need():
    letter, fraction, root = formula("a"), formula(r"\frac{a}{b}"), formula(r"\sqrt{\frac{a}{b}}")
    rate = Rate(formula(r"\varphi"))
    for above, below, points in (
        (letter, letter, 2),
        (rate, letter, 5),
        (letter, rate, 5),
        (rate, rate, 5),
        (letter, fraction, 7),
        (fraction, letter, 10),
        (fraction, rate, 10),
        (rate, fraction, 10),
        (fraction, root, 13),
        (root, letter, 13),
    ):
        text = LatexPen().write(Matrix(((above,), (below,)))).text
        assert f"\\\\[{points}pt]" in text, text


def test_a_formula_among_words_is_cut_only_if_it_is_too_wide():
    narrow, wide = (
        formula("a + b"),
        formula(" + ".join(r"\dot{\varphi}\,(a - b)" for _ in range(6))),
    )
    high = formula(r"\frac{a}{b}")
    found = MathmlPen().inline([narrow, wide, high])
    assert [len(found[each].parts) for each in (narrow, wide, high)] == [1, 6, 1]
    assert [found[each].is_tall for each in (narrow, wide, high)] == [False, False, True]
    assert [p.count("<mo") >= 2 for p in found[wide].parts] == [True] * 6
    assert 'class="tall"' in found[high].parts[0]
    assert all("(" in part and ")" in part for part in found[wide].parts)


def test_a_common_factor_stands_before_the_matrix():
    a, b, c = sp.symbols("a b c")
    for entries, factor in (
        ([a, b], 1),
        ([a / 2, b], sp.Rational(1, 2)),
        ([a / 2, b / 2], sp.Rational(1, 2)),
        ([a * b, a * c, 0], a),
        ([a**2 * b, a**3 * c + a**2 * b], a**2),
        ([a / c, b / c], 1 / c),
        ([2 * a / 3, 4 * b / 3], sp.Rational(2, 3)),
        ([2 * a, 4 * b], 1),
        ([2 * sp.sqrt(a), 4 * b], 1),
        ([a, 0], 1),
        ([a / b, b], 1),
        ([a**b, 2 * a**b], 1),
        ([-a * b, a], a),
        ([sp.Rational(1, 2), a / 3], sp.Rational(1, 6)),
        ([a * b, sp.sqrt(a) * b], b),
        ([1 - 2 * a / c, b / c], 1 / c),
        ([1 + a / b, 2 + c / b], 1),  # two sums of which each is as short as it can be
    ):
        found, rest = factored(sp.ImmutableMatrix(entries))
        assert found == factor, entries
        assert (found * rest - sp.ImmutableMatrix(entries)).expand() == sp.zeros(len(entries), 1)


def test_entries_over_a_common_divisor_are_written_without_it():
    """As (1 − 2 y²/d, 2 x y/d) is (d − 2 y², 2 x y)/d."""
    x, y, z, d = sp.symbols("x y z d")
    half = sp.Rational(1, 2)
    for entries, factor, rest in (
        ([1 - 2 * y**2 / d, 2 * x * y / d], 1 / d, [d - 2 * y**2, 2 * x * y]),
        ([(x + y) / d, x / d], 1 / d, [x + y, x]),
        ([x / d + y / d, x / d], 1 / d, [x + y, x]),
        ([x / d + y, x, y], 1, [x / d + y, x, y]),
        ([x + z * (1 + y / d), x / d], 1, [x + z * (1 + y / d), x / d]),
        ([half * x + half * y * (1 + z), half * x], half, [x + y * (1 + z), x]),
        ([x + y, x * y], 1, [x + y, x * y]),
        ([x / d, 1 + y / x, y], 1, [x / d, 1 + y / x, y]),
    ):
        assert factored(sp.ImmutableMatrix(entries)) == (factor, sp.ImmutableMatrix(rest))


def test_entries_that_are_equal_by_symmetry_are_listed_once():
    names = [formula(f"I_{{{i}{j}}}") for i in "123" for j in "123"]
    a, b, c, d, e, f = sp.symbols("a:f")
    tensor = sp.ImmutableMatrix([[a, b, c], [b, d, e], [c, e, f]])
    listed = [(name.text, value) for name, value in listed_entries(names, tensor)]
    assert listed == [
        ("I₁₁", a),
        ("I₁₂ = I₂₁", b),
        ("I₁₃ = I₃₁", c),
        ("I₂₂", d),
        ("I₂₃ = I₃₂", e),
        ("I₃₃", f),
    ]
    other = tensor + sp.ImmutableMatrix(3, 3, lambda i, j: 1 if i < j else 0)
    assert [name.text for name, _ in listed_entries(names, other)] == [n.text for n in names]
    assert len(listed_entries(names[:1], sp.ImmutableMatrix([[a]]))) == 1


def test_greek_indices_are_all_written_alike_in_text():
    assert [formula(rf"p_{{\{name}}}").text for name in ("phi", "theta", "psi")] == [
        *("p_φ", "p_θ", "p_ψ")
    ]


def test_a_prompt_shows_a_formula_as_one_reads_it():
    assert repr(formula(r"\mathbf{R}\,\mathbf{\Omega}'")) == "<R Ω′>"


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


@pytest.mark.parametrize("pen", PENS.values(), ids=list(PENS))
def test_widths_of_rates_and_what_stands_around_them_add_up(pen):
    rate, letter = Rate(formula(r"\varphi")), Symbol("a")
    alone, small = pen.write(rate).width, pen.but(small=True).write(rate).width
    assert small == pytest.approx(sheet_pen.SCRIPT * alone)
    assert pen.write(Matrix(((rate,),))).width == pytest.approx(small + sheet_pen.TALL_BRACKETS)
    sides = 2 * (sheet_pen.BRACKET + sheet_pen.LARGE["large"])
    assert pen.write(Bracket(rate)).width == pytest.approx(alone + sides)
    indexed, a = Indexed(letter, letter), pen.write(letter).width
    assert pen.write(indexed).width == pytest.approx(a + sheet_pen.SCRIPT * a)
    superscript = Symbol("a", prime="ᴮ")
    assert pen.write(superscript).width == pytest.approx(a + sheet_pen.SCRIPT)


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


def test_a_pen_keeps_its_settings_but_for_those_that_are_asked_for():
    for name in ("loose", "short", "small"):
        pen = LatexPen(**{name: True})
        assert getattr(pen.but(), name)
        assert getattr(LatexPen().but(**{name: True}), name)
        assert not getattr(LatexPen().but(), name)


def test_a_formula_in_latex_is_tall_if_it_is_higher_than_its_letters():
    flat, tall = formula("a + b"), formula(r"\frac{a}{b}")
    found = LatexPen().inline([flat, tall])
    assert (found[flat].is_tall, found[tall].is_tall) == (False, True)


@pytest.mark.parametrize("pen", PENS.values(), ids=list(PENS))
def test_a_wider_formula_has_more_width(pen):
    def width(markup: str) -> float:
        return pen.write(formula(markup)).width

    assert width("a") < width("a^{b}") < width("a^{b+c}") < width("a b+c")
