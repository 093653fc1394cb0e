"""What every pen prints has the value that was meant, keeps its form, and breaks between terms."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterator
from random import Random

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

from helpers.reading import Formula as Reader
from helpers.witness import mp, number
from rigidsym.formula import latex_pen
from rigidsym.formula.display import Equation, display
from rigidsym.formula.latex_pen import LatexPen, MarkdownPen, WebPen
from rigidsym.formula.letters import Letters, VectorLength
from rigidsym.formula.notation import Notation
from rigidsym.formula.pen import break_lines
from rigidsym.formula.reader import formula, named
from rigidsym.formula.scalars import factored, formula_of, listed_entries
from rigidsym.formula.tree import Bracket, Formula, Fraction, Power, Rate, Sign, Symbol, row
from rigidsym.formula.unicode_pen import UnicodePen, columns
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.notes.letters import letters_of

ANGLES = dynamicsymbols("phi theta psi")
RATES = [sp.diff(angle, "t", order) for order in (1, 2) for angle in ANGLES]
OMEGA = [*sp.symbols("Omega_1:4"), *sp.symbols("Omega_body_1:4")]
CONSTANTS = sp.symbols("A m_1 h alpha0")
FUNCTIONS = (sp.sin, sp.cos, sp.tan, sp.cot)
LETTERS = letters_of(arguments_of(EulerAngles("ZXZ")))
PEN = LatexPen()
READ = [f"{dots}{angle}" for dots in ("", "dot ", "ddot ") for angle in ("phi", "theta", "psi")]
READ += [f"Omega{prime}_{k}" for prime in ("", "'") for k in "123"]
NAMES = dict(  # as the reader calls them
    zip((*ANGLES, *RATES, *OMEGA, *CONSTANTS), (*READ, "A", "m_1", "h", "alpha_0"), strict=True)
)
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
    *(m * sp.sqrt(phi_dot + psi_dot) + A * (1 + theta), tan(psi) - sin(phi) * cos(theta) ** 2 * A),
)


def read(text: str) -> object:
    return Reader(text, KNOWN).value()


def test_a_printed_scalar_is_read_as_the_value_that_it_has():
    for scalar in SCALARS:
        printed = PEN.write(formula_of(scalar, LETTERS)).text
        expected = number(scalar, dict(VALUES))
        assert mp.fabs(read(printed) - expected) <= mp.mpf(10) ** -30 * (1 + mp.fabs(expected)), (
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
        ("arrow", Symbol("d", "arrow", dots=1)),
        ("word with dots", heading),
        ("word of two letters", Symbol("ab")),
        ("unit", Symbol("&", "italic")),
        ("names", row(*map(named, ("varphi", "Alpha_lamda", "hbar", "I'_12", "x__2")))),
        ("double dots", row(Symbol("M", dots=2), Symbol("x", dots=2), Symbol("Ω", "bold", 2, "′"))),
    )
    yield from ((str(scalar), formula_of(scalar, LETTERS)) for scalar in SCALARS[:40])
    yield from ((str(scalar), formula_of(scalar, LETTERS)) for scalar in READABLE)
    names = letters_of(arguments_of(EulerAngles("ZYX", ("heading", "phi_1", "q2"))))
    heading, indexed, q = dynamicsymbols("heading phi_1 q2", 1)
    for rate in (indexed, q, heading, heading.diff(), heading**2 * CONSTANTS[0] / 2, heading / 2):
        yield f"{rate} of angles with names", formula_of(rate, names)
    yield "a sine of the time", formula_of(sp.sin(sp.Symbol("t")) ** 2, LETTERS)
    by_fraction = Notation(rates="fraction", vectors="arrow")
    letters = letters_of(arguments_of(EulerAngles("ZXZ")), by_fraction)
    scalars = [A / 2, theta / 2, phi_dot / 2, 3 * phi_dot**2 * phi_ddot]
    for scalar in (*scalars, (theta_dot + omega_body[1]) ** 2 / 2):
        yield f"{scalar} by fractions", formula_of(scalar, letters)
    x, y, z = components = tuple(map(sp.Function, "xyz"))
    components = tuple(part(sp.Symbol("t")) for part in (x, y, z))
    length = VectorLength(components, *sp.symbols("n n_dot"), "n")
    square = sum(part**2 for part in components)
    letters = Letters(names=length.names, length=length)
    scalars = [square, 1 - 2 * square, sin(sp.sqrt(square)), sum(components), sp.diff(square, "t")]
    for scalar in (*scalars, square + components[0] ** 2, square + components[1] ** 2):
        yield f"{scalar} with a length", formula_of(scalar, letters)


def test_the_forms_of_the_pens_are_as_they_were(golden):
    lines = []
    for name, tree in forms():
        lines.append(name)
        for pen in (LatexPen(), MarkdownPen(), WebPen(), UnicodePen()):
            written = pen.write(tree).text.replace("\n", "⏎")
            if f"    {written}" not in lines[-6:]:
                lines.append(f"    {written}")
    golden("notes/formulas.txt", "\n".join(lines) + "\n")


def test_widths_add_up():
    def width(markup: str) -> float:
        return PEN.write(formula(markup)).width

    both, upper, lower = (
        width(rf"\begin{{pmatrix}} {rows} \end{{pmatrix}}")
        for rows in (r"a & b+c \\ a+b+c & d", "a & b+c", "a+b+c & d")
    )
    assert both == pytest.approx(upper + width("a+b+c") - width("a"))
    assert both == pytest.approx(lower + width("b+c") - width("d"))
    script = latex_pen.SCRIPT
    for markup, expected in (
        (r"\begin{pmatrix} a \end{pmatrix}", width("a") + latex_pen.TALL_BRACKETS),
        (r"\sqrt{a}", width("a") + latex_pen.ROOT),
        ("12", 2 * width("1")),
        ("a'", width("a") + latex_pen.PRIME),
        ("a_b", width("a") + script * width("b")),
        ("a^b", width("a") + script * width("b")),
        (r"\sin^2 a", width(r"\sin a") + script * width("2")),
        (r"\frac{c}{a + b}", width("a + b") + latex_pen.FRACTION),
        ("(a)^2", width("a") + 2 * latex_pen.BRACKET + script * width("2")),
    ):
        assert width(markup) == pytest.approx(expected), markup
    rate = Rate(formula(r"\varphi"))
    sides = 2 * (latex_pen.BRACKET + latex_pen.LARGE)
    assert PEN.write(Bracket(rate)).width == pytest.approx(PEN.write(rate).width + sides)


def test_a_listing_is_aligned_at_its_signs_and_definitions_stand_in_the_middle():
    value = sum(sp.Symbol(f"a_{k}") * sp.sin(theta) for k in range(40))
    matrix = sp.ImmutableMatrix([value, value + 1])
    names = (formula("k_1"), formula("k_2"))
    for sides, environment in (((formula(r"\mathbf{w}"),), "aligned"), ((), "gathered")):
        equation = Equation(sides=sides, matrix=matrix, entries=names)
        shown = display(equation, LETTERS, 30.0, PEN)
        assert (shown.environment, shown.lines > 4) == (environment, True)
        assert shown.text == f"\\begin{{{environment}}}\n{shown.inside}\n\\end{{{environment}}}"
        assert ("&" in shown.inside) == (environment == "aligned")


@pytest.mark.parametrize(("gaps", "beside"), [(1.9, 0), (2.0, 3), (3.9, 3), (4.0, 4)])
def test_short_definitions_share_a_line_as_far_as_they_fit(gaps, beside):
    names = tuple(formula(f"k_{k}") for k in range(6))
    matrix = sp.ImmutableMatrix([sp.Symbol("a")] * 6)
    own = display(Equation(sides=(), matrix=matrix, entries=names), LETTERS, 1.0, PEN).width
    count = 2 if gaps < 3 else 3
    width = count * own + gaps + 1e-9
    shown = display(Equation(sides=(), matrix=matrix, entries=names), LETTERS, width, PEN)
    assert shown.inside.count(r"\qquad") == beside


def test_lines_break_before_signs_in_the_outermost_bracket(answered):
    """Each open bracket costs the next lines an indent; a divisor is broken only at need."""

    def answer(question: str) -> str:
        width, indent, typed = question.split(" ", 2)
        written = UnicodePen().write(formula(typed))
        broken = break_lines(written, int(width), int(indent), UnicodePen.blank)
        assert [line.width for line in broken] == [columns(line.text) for line in broken]
        return "\n".join(line.text for line in broken)

    answered("notes/broken_lines.txt", answer)


x, y, z, d = sp.symbols("x y z d")
half = sp.Rational(1, 2)


@pytest.mark.parametrize(
    ("entries", "factor", "rest"),
    [
        ([x / 2, y], half, [x, 2 * y]),
        ([x**2 * y, x**3 * z + x**2 * y, 0], x**2, [y, x * z + y, 0]),
        ([2 * x / d, 4 * y / d], 2 / d, [x, 2 * y]),
        ([half, x / 3], half / 3, [3, 2 * x]),
        ([1 - 2 * y**2 / d, 2 * x * y / d], 1 / d, [d - 2 * y**2, 2 * x * y]),
        ([half * x + half * y * (1 + z), half * x], half, [x + y * (1 + z), x]),
        ([(11 + sp.sqrt(13)) * x * y, 22 * x * y], x * y, [11 + sp.sqrt(13), 22]),
        # as short as they can be
        *((entries, 1, entries) for entries in ([2 * x, 4 * y], [x, 0], [x / d + y, x, y])),
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
    other = sp.ImmutableMatrix(3, 3, range(9))
    assert len([*listed_entries(names, other)]) == 9


def test_a_formula_from_another_process_is_the_same():
    # strings have other hashes there
    program = "import pickle, sys; from rigidsym.formula.reader import formula; f = formula('a+b')"
    program += "; hash(f); sys.stdout.buffer.write(pickle.dumps(f))"
    pickled = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)
    assert pickle.loads(pickled.stdout) in {formula("a+b")}
