"""One evaluation in every arithmetic: intervals enclose the value, floats and arrays come near."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings, strategies as st

from helpers.witness import mp
from rigidsym.algebra.evaluate import (
    Floats,
    NotReal,
    RealValues,
    Unknown,
    context,
    evaluate,
    is_never_negative,
)

X, Y = sp.symbols("x y")
LEAVES = st.sampled_from([X, Y, sp.pi, sp.E, sp.Integer(2), sp.Rational(-3, 7), sp.sqrt(2)])
TREES = st.recursive(
    LEAVES,
    lambda part: st.one_of(
        st.tuples(part, part).map(sum),
        st.tuples(part, part).map(lambda pair: pair[0] * pair[1]),
        st.tuples(
            st.sampled_from([sp.sin, sp.cos, sp.atan, sp.Abs, sp.cot, sp.sech, sp.asinh]), part
        ).map(lambda pair: pair[0](pair[1])),
        st.tuples(part, st.sampled_from([-2, -1, 2, sp.Rational(1, 2)])).map(
            lambda pair: (1 + pair[0] ** 2) ** pair[1]
        ),
    ),
    max_leaves=8,
)


@settings(max_examples=150)
@given(TREES)
def test_all_arithmetics_agree_with_fifty_digits(expression):
    assume(not expression.has(sp.zoo, sp.nan))
    at = {X: sp.Rational(3, 11), Y: sp.Rational(-17, 13)}
    work = RealValues(at, 50)
    try:
        bounds = work(expression)
    except NotReal:  # a cotangent of zero
        return
    exact = mp.mpf(str(sp.N(expression.xreplace(at), 45)))
    middle, width = (mp.mpf(str(context(50).mpf(part.mid))) for part in (bounds, bounds.delta))
    assert abs(middle - exact) <= width + mp.mpf(10) ** -40 * (1 + abs(exact))
    assert width <= mp.mpf(10) ** -25 * (1 + abs(exact))
    floats = [float(at[X]), float(at[Y])]
    limit = 1e-9 * (1 + abs(float(exact)))
    columns = {s: np.full(3, value) for s, value in zip((X, Y), floats, strict=True)}
    assert np.all(np.abs(evaluate(expression, Floats(np), columns) - float(exact)) <= limit)


@pytest.mark.parametrize(
    "expression", [sp.sqrt(X - 4), 1 / (X - 3), sp.log(3 - X), sp.asin(X), sp.atan2(X - 3, X - 3)]
)
def test_intervals_have_no_value_where_there_is_none(expression):
    with pytest.raises(NotReal):
        RealValues({X: sp.Integer(3)}, 50)(expression)


def test_a_symbol_without_a_value_is_named():
    with pytest.raises(Unknown, match="y"):
        evaluate(X + Y, Floats(np), {X: 1.0})


R = sp.Symbol("R")


@pytest.mark.parametrize(
    ("expression", "bounds", "is_told"),
    [
        (X**2 * sp.cos(Y), {X: (sp.S.Zero, R), Y: (-sp.pi / 2, sp.pi / 2)}, True),  # latitude
        (X * sp.sin(Y), {X: (sp.S.Zero, R), Y: (sp.S.Zero, sp.pi)}, True),
        (sp.sin(2 * X), {X: (sp.S.Zero, sp.pi / 2)}, True),
        (sp.sin(2 * X), {X: (sp.S.Zero, sp.pi)}, False),
        (-X, {X: (-R, sp.S.Zero)}, True),
        (X, {X: (-R, sp.S.Zero)}, False),
    ],
)
def test_signs_within_bounds(expression, bounds, is_told):
    assert is_never_negative(expression, bounds) == is_told
