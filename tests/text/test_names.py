"""Names of coordinates, and chains of turns, as people write them."""

from __future__ import annotations

import pytest
import sympy as sp

from rigidsym.errors import ExpressionError
from rigidsym.text.expression import MOST_CHARACTERS, parse_expression, parse_turns
from rigidsym.text.names import GREEK_LETTERS, check_name, spelled


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("phi", "phi"),
        ("φ", "phi"),
        ("ϕ", "phi"),
        ("φ1", "phi1"),
        ("θ_1", "theta_1"),
        ("lambda", "lambda"),
        ("λ", "lambda"),
        ("class", "class"),
        ("None", "None"),
        ("\u00b5", "mu"),
        ("Ω", "Omega"),
        ("i", "i"),
        ("a" * 40, "a" * 40),
    ],
)
def test_names_that_are_taken(text, name):
    assert check_name(text) == name


FORM = "expected a letter (Latin or Greek), then letters, digits and single underscores"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("a b", FORM),
        ("_a", FORM),
        ("a_", FORM),
        ("a__b", FORM),
        ("1a", FORM),
        ("Α", FORM),  # a Greek capital that looks like a Latin one
        ("é", FORM),
        ("𝐱", FORM),
        ("phi\n", FORM),
        ("π", "pi is the number π"),
        ("t", "t is the time"),
        ("sin", "sin is a function"),
        ("q", "q is a name that the generated functions use"),
        ("phi_dot", "a name that ends in dot reads as a rate"),
        ("φddot", "a name that ends in dot reads as a rate"),
        ("Omega_body_1", "it is a component of the angular velocity"),
        ("omega_space", "it is a component of the angular velocity"),
    ],
)
def test_names_that_are_not_taken(text, fault):
    with pytest.raises(ExpressionError) as caught:
        check_name(text)
    assert caught.value.message == f"{text!r} is not a valid name: {fault}"


@pytest.mark.parametrize("text", ["", "a" * 41])
def test_names_have_a_length(text):
    with pytest.raises(
        ExpressionError, match=f"^expected a name of 1 to 40 letters, got {len(text)}$"
    ):
        check_name(text)


def test_every_greek_letter_is_a_letter_of_expressions():
    for letter in GREEK_LETTERS:
        if spelled(letter) != "pi":
            assert parse_expression(letter, {spelled(letter): sp.Symbol("m")}) == sp.Symbol("m")


# turns


@pytest.mark.parametrize(
    ("text", "turns"),
    [
        ("z(phi) x(theta) z(psi)", (("z", "phi"), ("x", "theta"), ("z", "psi"))),
        (" z(phi)*x( θ )\n*  z(psi) ", (("z", "phi"), ("x", "θ"), ("z", "psi"))),
        ("z(a)x(b)", (("z", "a"), ("x", "b"))),
        ("y (2*(a + b))", (("y", "2*(a + b)"),)),
    ],
)
def test_turns_are_read_left_to_right(text, turns):
    assert tuple(turn[:2] for turn in parse_turns(text)) == turns
    assert all(text[column - 1 :].startswith(angle) for _, angle, column in parse_turns(text))


A_TURN = "expected a turn: x(...), y(...), z(...) or [1,1,0](...), found"


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 1, f"{A_TURN} the end"),
        ("  ", 3, f"{A_TURN} the end"),
        ("z", 1, f"{A_TURN} 'z'"),
        ("Rz(a)", 1, f"{A_TURN} 'R'"),
        ("z(a) w(b)", 6, f"{A_TURN} 'w'"),
        ("z(a), x(b)", 5, f"{A_TURN} ','"),
        ("* z(a)", 1, f"{A_TURN} '*'"),
        ("z(a) *", 7, "expected a turn after *, found the end"),
        ("z(a) * * x(b)", 8, f"{A_TURN} '*'"),
        ("z(a) x( )", 9, "expected an angle, found ')'"),
        ("z((a)", 2, "unclosed ("),
        ("z(a" * 1000, 1, f"a text of 3000 characters; expected at most {MOST_CHARACTERS}"),
    ],
)
def test_what_is_no_chain_of_turns(text, column, message):
    with pytest.raises(ExpressionError) as caught:
        parse_turns(text)
    assert (caught.value.column, caught.value.message) == (column, message)
