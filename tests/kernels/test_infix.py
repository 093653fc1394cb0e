"""The infix notation that Python, C and JavaScript share has the value of its tree."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from random import Random

import pytest

from helpers.witness import mp
from rigidsym.kernels.ir import (
    Call,
    Choice,
    Compare,
    Expression,
    Guarded,
    Name,
    Negative,
    Number,
    Product,
    Sum,
)
from rigidsym.kernels.targets.infix import infix

VALUES = {name: mp.mpf(k) / 7 for name, k in zip("abcde", (3, -5, 11, 16, -2), strict=True)}
NUMBERS = [Number(Fraction(n)) for n in (2, -3, Fraction(1, 3), Fraction(-7, 5), Fraction(1, 2))]


def random_tree(rng: Random, depth: int) -> Expression:
    if depth == 0 or rng.random() < 0.15:
        return rng.choice([*map(Name, VALUES), *NUMBERS, Call("sin", Name("a"))])
    some = [random_tree(rng, depth - 1) for _ in range(rng.randint(1, 3))]
    kind = rng.randrange(4)
    if kind == 0:
        return Negative(some[0])
    if kind == 1:
        return Sum(tuple(some))
    others = [random_tree(rng, depth - 1) for _ in range(rng.randint(0, 2))]
    return Product(tuple(some), tuple(others))


def value_of(tree: Expression) -> object:
    match tree:
        case Name(text):
            return VALUES[text]
        case Number(value):
            return mp.mpf(value.numerator) / value.denominator
        case Negative(operand):
            return -value_of(operand)
        case Sum(terms):
            return mp.fsum(map(value_of, terms))
        case Product(factors, divisors):
            above, below = (mp.fprod(map(value_of, side)) for side in (factors, divisors))
            return above / below
    assert isinstance(tree, Call)
    return mp.sin(VALUES[tree.argument.text])


def test_an_expression_has_the_value_of_its_tree():
    for k in range(400):
        tree = random_tree(Random(f"tree:{k}"), 1 + k % 4)
        try:
            expected = value_of(tree)
        except ZeroDivisionError:
            continue
        exact = re.sub(r"\d+\.\d+", r"mpf(\g<0>)", infix(tree))
        found = eval(exact, {"mpf": mp.mpf, "sin": mp.sin, **VALUES})
        assert mp.fabs(found - expected) <= mp.mpf(10) ** -35 * (1 + mp.fabs(expected)), tree


a, b, c = map(Name, "abc")
OVER = Compare("<", Sum((a, b)), c)


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (Call("atan2", a, b), "atan2(a, b)"),
        (Number(math.nan), "nan"),
        (Number(0.1), "0.1"),
        (Number(Fraction(1, 3)), "1.0 / 3.0"),
        (OVER, "a + b < c"),
        (Compare("==", OVER, c), "(a + b < c) == c"),
        (Choice(OVER, a, Negative(b)), "a if a + b < c else -b"),
        (Sum((Choice(OVER, a, b), c)), "(a if a + b < c else b) + c"),
        (Guarded(a, None), "or_nan(a, None)"),
        (Guarded(a, b), "or_nan(a, b)"),
        (Product((a,), (b,)), "a / b"),
        (Product((a,), (b, c)), "a / (b * c)"),
        (Product((a,), (Product((b,), (c,)),)), "a / (b / c)"),
        (Product((a,), (Product((b,), (c,)), c)), "a / (b / c * c)"),
        (Product((a, Sum((b, c)))), "a * (b + c)"),
        (Sum((a, Negative(Sum((b, c))))), "a - (b + c)"),
        (Negative(Product((a, b))), "-a * b"),
        (Product((Negative(a), b)), "(-a) * b"),
    ],
    ids=str,
)
def test_a_tree_gets_the_brackets_it_needs_and_no_others(tree, text):
    assert infix(tree) == text


def test_a_target_has_its_own_words():
    words = {"sin": "Math.sin", "nan": "NaN", "choice": "{0} ? {1} : {2}", "==": "==="}
    assert infix(Call("sin", a), words) == "Math.sin(a)"
    assert infix(Number(math.nan), words) == "NaN"
    assert infix(Choice(Compare("==", a, b), a, b), words) == "a === b ? a : b"
    assert infix(Number(Fraction(1, 2)), number=lambda value: f"{value}f") == "0.5f"


def test_a_guard_names_its_power_if_it_is_not_one():
    words = {"or_nan": "keep", "None": "null"}
    assert infix(Guarded(a, None), words) == "keep(a, null)"
    assert infix(Guarded(a, b), {"or_nan": "keep({}, eps=e)"}) == "keep(a, b, eps=e)"
    assert infix(Guarded(a, b, 2)) == "or_nan(a, b, 2)"
