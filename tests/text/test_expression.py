"""Text to expressions: what is taken, what is refused and where, and that nothing takes long."""

from __future__ import annotations

from datetime import timedelta

import pytest
import sympy as sp
from hypothesis import example, given, settings, strategies as st

from rigidsym.errors import ExpressionError
from rigidsym.models.rotation import time_function
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.expression import MOST_CHARACTERS, parse_expression, parse_turns
from rigidsym.text.names import GREEK_LETTERS, check_name, spelled

PHI, THETA, LAMBDA = (time_function(name) for name in ("phi", "theta", "lambda"))
M, G = sp.symbols("m g", positive=True)
NAMES = {"phi": PHI, "theta": THETA, "lambda": LAMBDA, "m": M, "g": G}


def outcome(text: str, read=lambda text: parse_expression(text, NAMES)):
    """What was read, and None or the error; any other error goes through."""
    try:
        return read(text), None
    except ExpressionError as error:
        return None, error


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("phi", PHI),
        ("  phi\n\t+ g ", PHI + G),
        ("φ + ϕ", 2 * PHI),
        ("0.1", sp.Rational(1, 10)),
        ("1e-3", sp.Rational(1, 1000)),
        ("2.", sp.Integer(2)),
        ("0.5*m*g*cos(theta)", M * G * sp.cos(THETA) / 2),
        ("-phi**2", -(PHI**2)),
        ("2**-1", sp.Rational(1, 2)),
        ("2**3**2", sp.Integer(512)),
        ("phi**0.5", sp.sqrt(PHI)),
        ("phi - g - m", PHI - G - M),
        ("+-+phi", -PHI),
        ("sin(pi/2 + 0)", sp.Integer(1)),
        ("atan2(1, -1)", 3 * sp.pi / 4),
        ("sqrt(m**2)", M),
        ("csc(phi)*sec(phi)", 1 / (sp.sin(PHI) * sp.cos(PHI))),
        ("exp(-phi)", sp.exp(-PHI)),
    ],
)
def test_what_a_text_stands_for(text, expected):
    assert parse_expression(text, NAMES) == expected


def test_what_is_refused_and_where(answered):
    def answer(text: str) -> str:
        _, error = outcome(text)
        return f"column {error.column}: {error.message}"

    answered("text/refused.txt", answer)


REFUSED = (
    "__import__('os')",
    "phi.__class__",
    "().__class__",
    "(phi := 1)",
    "(lambda: 0)()",
    "phi\x00",
    "𝐬𝐢𝐧(phi)",  # Python's own reader takes these for sin
    "ｐｈｉ",
    # too large
    "9**9**9**9",
    "*".join(["9**64"] * 300),
    "(phi + theta + m + g + 1)**64",
    "*".join(["(phi + theta + m + g)"] * 80),
    "exp(10**30*log(2))",
    "sin(exp(10**30))",
    "cosh(cosh(123456789012345678901234567890))",
    "cos(sinh(exp(theta**64)))",
    "sqrt(123456789012345678901234567891*theta)",
    "1e41",
    "1e0000000300",
    "1e-99999999999999999999",
    "1" * 41,
    "(" * 51 + "phi" + ")" * 51,
    "-" * (MOST_CHARACTERS - 3) + "phi",
    "phi+" * MOST_CHARACTERS,
    "9" * 1_000_000,
    "(" * 1_000_000,
)


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:20])
def test_code_and_what_would_take_for_ever_are_refused_at_once(text):
    assert len(outcome(text)[1].message) < 200  # taken as it is, it would not come to an end


numbers = st.builds(
    lambda whole, places: f"{whole / 10**places:.{places}f}",
    st.integers(0, 10**6),
    st.integers(0, 4),
)
leaves = st.sampled_from([*NAMES, "φ", "pi"]) | numbers


def compound(inner):
    operation = st.tuples(inner, st.sampled_from("+-*/"), inner).map("".join)
    power = st.tuples(inner, st.sampled_from(["**2", "**-3", "**(1/2)", "**64"])).map("".join)
    functions = st.sampled_from(sorted(set(FUNCTIONS) - {"atan2"}))
    call = st.tuples(functions, inner).map("".join)
    return (operation | power | call | inner.map("-{}".format)).map("({})".format)


@settings(max_examples=120, deadline=timedelta(seconds=10))
@given(st.recursive(leaves, compound, max_leaves=12))
def test_a_well_formed_text_is_an_expression_or_refused(text):
    value, error = outcome(text)
    if error is None:
        assert isinstance(value, sp.Expr)
        assert not value.atoms(sp.Float)
        assert value.free_symbols <= {M, G, sp.Symbol("t")}
    else:
        assert 1 <= error.column <= len(text) + 1
        assert len(error.message) < 200


@settings(max_examples=120, deadline=timedelta(seconds=10))
@given(
    st.text(max_size=60)
    | st.text(alphabet="phisncot0123456789.e+-*/(), φλ\n", max_size=60)
    | st.lists(st.sampled_from(["phi", "sin", "(", ")", "**", "-", "2", ".5", ",", "if"])).map(
        " ".join
    )
)
@example("\ud800")
@example("1if phi else 2")
def test_junk_is_refused_with_its_place(text):
    for _, error in (outcome(text), outcome(text, parse_turns)):
        assert error is None or 1 <= error.column <= len(text) + 1


def test_turns_are_read_left_to_right():
    for text, turns in {
        " z(phi)*x( θ )\n*  z(psi) ": (("z", "phi"), ("x", "θ"), ("z", "psi")),
        "z(a)x(b)": (("z", "a"), ("x", "b")),
        "y (2*(a + b))": (("y", "2*(a + b)"),),
    }.items():
        assert tuple(turn[:2] for turn in parse_turns(text)) == turns
        assert all(text[column - 1 :].startswith(angle) for _, angle, column in parse_turns(text))
    for text, message in (("", "a turn: .* the end"), ("z(a" * 1000, f"most {MOST_CHARACTERS}")):
        with pytest.raises(ExpressionError, match=message):
            parse_turns(text)


def test_names_of_coordinates():
    taken = {"φ1": "phi1", "ϕ": "phi", "θ_1": "theta_1", "λ": "lambda", "\u00b5": "mu", "i": "i"}
    assert {text: check_name(text) for text in taken} == taken
    for text in ("", "phi\n"):
        assert outcome(text, check_name)[1] is not None
    for letter in GREEK_LETTERS:
        if spelled(letter) != "pi":
            assert parse_expression(letter, {spelled(letter): M}) == M
