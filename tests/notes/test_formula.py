"""Formulas as people read them: exact forms, the order of factors and terms, no ambiguity."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
import sympy as sp
from sympy.physics.vector import dynamicsymbols

import rigidsym as rs
from helpers.motions import derived
from helpers.printing import latex, text
from rigidsym.errors import AlgebraError
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.mathml_pen import MathmlPen
from rigidsym.formula.pen import Segment, break_lines
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import factored
from rigidsym.formula.tree import Big, Rate, Symbol
from rigidsym.formula.unicode_pen import UnicodePen, columns
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.euler_angles import EulerAngles
from rigidsym.notes.formula.derivation_letters import letters_of

phi, theta, psi = dynamicsymbols("phi theta psi")
phi_dot, theta_dot, psi_dot = dynamicsymbols("phi theta psi", 1)
phi_ddot, theta_ddot = dynamicsymbols("phi theta", 2)
omega = sp.symbols("Omega_1:4")
omega_body = sp.symbols("Omega_body_1:4")
A, m, moment = sp.symbols("A m_1 moment")
sin, cos, tan, cot = sp.sin, sp.cos, sp.tan, sp.cot

LETTERS = letters_of(arguments_of(EulerAngles("ZXZ")))

FORMS = [
    # numbers, names, constants
    (sp.Integer(0), "0", "0"),
    (-sp.Rational(1, 2), r"-\frac{1}{2}", "−1/2"),
    (sp.pi / 2, r"\frac{\pi}{2}", "π/2"),
    (-3 * sp.pi / 4, r"-\frac{3 \pi}{4}", "−3π/4"),
    (m, r"m_1", "m₁"),
    (2 * moment, r"2 \mathit{moment}", "2moment"),
    # order of factors
    (sin(psi) * phi_dot * sin(theta), r"\dot{\phi} \sin\theta \sin\psi", "φ̇ sin θ sin ψ"),
    (cos(theta) * sin(theta), r"\sin\theta \cos\theta", "sin θ cos θ"),
    (phi_dot * theta_dot * A * 2, r"2 A\,\dot{\phi}\,\dot{\theta}", "2A φ̇ θ̇"),
    (theta_dot**2 * phi_ddot, r"\ddot{\phi}\,\dot{\theta}^2", "φ̈ θ̇²"),
    (sin(phi) * omega[1], r"\Omega_2 \sin\phi", "Ω₂ sin φ"),
    (sin(psi) * (phi_dot + psi_dot), r"\sin\psi\,(\dot{\phi} + \dot{\psi})", "sin ψ (φ̇ + ψ̇)"),
    (phi_dot * sp.exp(theta), r"\dot{\phi} \exp(\theta)", "φ̇ exp(θ)"),
    # order of terms, signs
    (psi_dot - phi_dot * sin(theta), r"\dot{\psi} - \dot{\phi} \sin\theta", "ψ̇ − φ̇ sin θ"),
    (phi_dot * cos(theta) + psi_dot, r"\dot{\phi} \cos\theta + \dot{\psi}", "φ̇ cos θ + ψ̇"),
    (-phi_dot - psi_dot, r"-\dot{\phi} - \dot{\psi}", "−φ̇ − ψ̇"),
    (theta_dot * psi_dot + phi_ddot, r"\ddot{\phi} + \dot{\theta}\,\dot{\psi}", "φ̈ + θ̇ ψ̇"),
    (1 - cos(theta), r"1 - \cos\theta", "1 − cos θ"),
    (
        cot(theta) * (omega[1] * cos(phi) - omega[0] * sin(phi)) + omega[2],
        r"\Omega_3 + \cot\theta\,(\Omega_2 \cos\phi - \Omega_1 \sin\phi)",
        "Ω₃ + cot θ (Ω₂ cos φ − Ω₁ sin φ)",
    ),
    (
        sin(psi) * (phi_ddot * sin(theta) + theta_dot * (phi_dot * cos(theta) - psi_dot)),
        r"\sin\psi\,(\ddot{\phi} \sin\theta + \dot{\theta}\,(\dot{\phi} \cos\theta - \dot{\psi}))",
        "sin ψ (φ̈ sin θ + θ̇ (φ̇ cos θ − ψ̇))",
    ),
    # powers and roots
    (A * sin(theta) ** 2, r"A \sin^2\theta", "A sin² θ"),
    (phi_dot**2 / 2, r"\frac{1}{2}\,\dot{\phi}^2", "½φ̇²"),
    (omega_body[0] ** 2, r"{\Omega'_1}^2", "Ω′₁²"),
    ((A + m) ** 2, r"(m_1 + A)^2", "(m₁ + A)²"),
    (m * A, r"m_1\,A", "m₁ A"),
    (sp.sqrt(A), r"\sqrt{A}", "√A"),
    (1 / sp.sqrt(A + m), r"\frac{1}{\sqrt{m_1 + A}}", "1/√(m₁ + A)"),
    (A ** sp.Rational(3, 2), r"A^{3/2}", "A^(3/2)"),
    # quotients
    (1 / sin(theta), r"\frac{1}{\sin\theta}", "1/sin θ"),
    (-cos(phi) / sin(theta), r"-\frac{\cos\phi}{\sin\theta}", "−cos φ/sin θ"),
    (phi_dot / (2 * sin(theta)), r"\frac{\dot{\phi}}{2 \sin\theta}", "φ̇/(2 sin θ)"),
    (sin(phi) ** 2 / (1 + cos(psi)), r"\frac{\sin^2\phi}{1 + \cos\psi}", "sin² φ/(1 + cos ψ)"),
    (
        (omega[0] * sin(phi) - omega[1] * cos(phi)) / sin(theta),
        r"\frac{\Omega_1 \sin\phi - \Omega_2 \cos\phi}{\sin\theta}",
        "(Ω₁ sin φ − Ω₂ cos φ)/sin θ",
    ),
    (
        phi_dot * (A + 1 / sin(theta)),
        r"\dot{\phi}\,\left(A + \frac{1}{\sin\theta}\right)",
        "φ̇ (A + 1/sin θ)",
    ),
    # arguments
    (sin(2 * theta), r"\sin 2 \theta", "sin 2θ"),
    (cos(theta / 2), r"\cos\frac{\theta}{2}", "cos(θ/2)"),
    (sin(phi + psi) ** 2, r"\sin^2(\phi + \psi)", "sin²(φ + ψ)"),
    (
        cos(sp.exp(theta)) * theta_dot,
        r"\dot{\theta} \cos(\exp(\theta))",
        "θ̇ cos(exp(θ))",
    ),
    (tan(A * theta), r"\tan(A\,\theta)", "tan(A θ)"),
    (sin(moment), r"\sin\mathit{moment}", "sin moment"),
]


def test_terms_with_brackets_follow_the_rates_in_them():
    """A (φ̇ + ψ̇) comes before m (φ̇ + ψ̇)², like A φ̇ before m φ̇²; a root counts once."""
    total = phi_dot + psi_dot
    for expression, shown in (
        (m * phi_dot**2 + A * phi_dot, "A φ̇ + m₁ φ̇²"),
        (m * total**2 + A * total, "A (φ̇ + ψ̇) + m₁ (φ̇ + ψ̇)²"),
        (m * sp.sqrt(total) + A * (1 + theta), "A (1 + θ) + m₁ √(φ̇ + ψ̇)"),
        (m * sp.sqrt(total) + A * total, "m₁ √(φ̇ + ψ̇) + A (φ̇ + ψ̇)"),
    ):
        assert text(expression, LETTERS) == shown


def test_sums_of_negative_terms_give_their_signs_to_the_product():
    first, second, third = -A - m, -theta_dot - phi_dot, -1 - theta
    assert text(first * second, LETTERS) == "(m₁ + A)(φ̇ + θ̇)"
    assert text(first * second * third, LETTERS) == "−(m₁ + A)(1 + θ)(φ̇ + θ̇)"


@pytest.mark.parametrize(("expression", "as_latex", "as_text"), FORMS, ids=lambda x: str(x)[:40])
def test_exact_forms(expression, as_latex, as_text):
    assert (latex(expression, LETTERS), text(expression, LETTERS)) == (as_latex, as_text)


def test_shorthand():
    expression = -sin(phi) * cos(theta) ** 2 * phi_dot + tan(psi)
    short = latex(expression, LETTERS, short=True)
    assert short == r"\tan\psi - \dot{\phi}\,s_{\phi}\,c_{\theta}^2"


def test_the_lectures_rotation_matrix_and_equation_18():
    motion = derived("ZXZ")
    shown = [text(entry, LETTERS) for entry in motion.rotation_matrix]
    assert shown == [
        "cos φ cos ψ − sin φ cos θ sin ψ",
        "−cos φ sin ψ − sin φ cos θ cos ψ",
        "sin φ sin θ",
        "sin φ cos ψ + cos φ cos θ sin ψ",
        "cos φ cos θ cos ψ − sin φ sin ψ",
        "−cos φ sin θ",
        "sin θ sin ψ",
        "sin θ cos ψ",
        "cos θ",
    ]
    assert [text(entry, LETTERS) for entry in motion.angular_velocity_body] == [
        "φ̇ sin θ sin ψ + θ̇ cos ψ",
        "φ̇ sin θ cos ψ − θ̇ sin ψ",
        "φ̇ cos θ + ψ̇",
    ]


@pytest.mark.parametrize(
    ("expression", "kind"),
    [(sp.Integral(theta, phi), "Integral"), (A**m, "Pow"), (sp.Matrix([1]), "Matrix")],
)
def test_a_node_without_a_form_is_named(expression, kind):
    with pytest.raises(AlgebraError, match=rf"no printed form for .* of type \w*{kind}"):
        latex(expression, LETTERS)


def test_names_come_from_the_notation():
    letters = letters_of(arguments_of(EulerAngles("ZYX", ("heading", "phi_1", "q2"))))
    heading, phi, q = dynamicsymbols("heading phi_1 q2", 1)
    half = sp.Rational(1, 2)
    for rate, as_latex, as_text in (
        (phi, r"\dot{\phi}_1", "φ̇₁"),
        (q, r"\dot{q}_2", "q\u0307₂"),
        (heading, r"\frac{d\,\mathit{heading}}{dt}", "d heading/dt"),
        (heading.diff(), r"\frac{d^2\mathit{heading}}{dt^2}", "d² heading/dt²"),
        (
            half * A * heading**2,
            r"\frac{1}{2}\,A\,\Bigl(\frac{d\,\mathit{heading}}{dt}\Bigr)^2",
            "½A (d heading/dt)²",
        ),
        (half * heading, r"\frac{1}{2}\,\frac{d\,\mathit{heading}}{dt}", "½ d heading/dt"),
    ):
        assert (latex(rate, letters), text(rate, letters)) == (as_latex, as_text)
    assert UnicodePen().write(Rate(Symbol("az"))).text == "d az/dt"
    assert LatexPen().write(Rate(Symbol("az"))).text == r"\frac{d\,\mathit{az}}{dt}"


def test_a_formula_without_any_letters_uses_the_names_of_its_symbols():
    assert text(A * sin(theta) + m, Letters()) == "m₁ + A sin θ"


# --- laws over all conventions ---


def _entries(motion: rs.Motion) -> Iterator[tuple[sp.Expr, str, Letters]]:
    letters = letters_of(motion.arguments)
    for step in motion.steps:
        for entry in step.expression:
            yield entry, text(entry, letters), letters


def test_what_is_printed_reads_back_as_what_was_meant(motion):
    """A reader who binds a function to the next name only reads the right value."""
    for entry, shown, letters in _entries(motion):
        assert sp.expand(_Reader(shown, letters).read() - entry) == 0, shown


def test_no_rate_follows_a_function(motion):
    pattern = re.compile(r"(sin|cos|tan|cot)\S* \S+ (\S[\u0307\u0308]|Ω)")
    assert not [shown for _, shown, _ in _entries(motion) if pattern.search(shown)]


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


class _Reader:
    """Reads one line of Unicode back: a function takes the bracket or the one name after it."""

    _POWERS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")

    def __init__(self, shown: str, letters: Letters) -> None:
        names = sorted((markup.text for markup in letters.names.values()), key=len, reverse=True)
        known = "|".join(map(re.escape, names))
        self.tokens = re.findall(rf"{known}|\d+|sin|cos|tan|cot|[()+−/]|[⁰¹²³⁴-⁹]+", shown)
        assert "".join(self.tokens) == shown.replace(" ", "")
        self.symbols = {markup.text: symbol for symbol, markup in letters.names.items()}

    def read(self) -> sp.Expr:
        value = self._sum()
        assert not self.tokens
        return value

    def _next(self, *wanted: str) -> str:
        return self.tokens.pop(0) if self.tokens and self.tokens[0] in wanted else ""

    def _sum(self) -> sp.Expr:
        value = -self._term() if self._next("−") else self._term()
        while sign := self._next("+", "−"):
            value += self._term() if sign == "+" else -self._term()
        return value

    def _term(self) -> sp.Expr:
        value = self._factor()
        while self.tokens and self.tokens[0] not in ("+", "−", ")"):
            value = value / self._factor() if self._next("/") else value * self._factor()
        return value

    def _factor(self) -> sp.Expr:
        function = self._next("sin", "cos", "tan", "cot")
        if not function:
            base = self._atom()
            return base ** self._power()
        power = self._power()
        return getattr(sp, function)(self._atom()) ** power

    def _power(self) -> int:
        is_power = self.tokens and self.tokens[0][0] in "⁰¹²³⁴⁵⁶⁷⁸⁹"
        return int(self.tokens.pop(0).translate(self._POWERS)) if is_power else 1

    def _atom(self) -> sp.Expr:
        if self._next("("):
            value = self._sum()
            assert self._next(")")
            return value
        token = self.tokens.pop(0)
        return sp.Integer(token) if token.isdigit() else self.symbols[token]


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
