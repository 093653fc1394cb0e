"""What people read: equal to the normal form, found again when read back, never longer; and one
evaluation in every arithmetic: intervals enclose the value, floats and arrays come near.
"""

from __future__ import annotations

from math import prod

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings, strategies as st
from sympy import Rational, cos, cot, sin, sqrt, tan

from helpers.witness import TOLERANCE, mp, number, paths, values_along
from rigidsym.algebra import present
from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.evaluate import (
    Floats,
    NotReal,
    RealValues,
    Unknown,
    context,
    evaluate,
    is_never_negative,
)
from rigidsym.algebra.generators import added
from rigidsym.algebra.present import Presenter, presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.errors import AlgebraError
from rigidsym.models.rotation import TIME, time_function

a, b, w, x, y, z = map(time_function, ("a", "b", "w", "x", "y", "z"))
a_dot, b_dot = a.diff(TIME), b.diff(TIME)
m = sp.Symbol("m")
UNIT = w**2 + x**2 + y**2 + z**2 - 1


GENERATORS = [sin(a), cos(a), sin(b), cos(b), a_dot, b_dot, m]
CODEC = codec_for(GENERATORS)
PRESENTER = presenter_for(CODEC)


def shown(expression: sp.Expr) -> sp.Expr:
    """The textbook form of an expression."""
    return PRESENTER.quotient(CODEC.encode_quotient(expression))


FOLDED = [
    (sin(a) ** 2 + cos(a) ** 2, 1),
    (2 - cos(a) ** 2 - sin(b) ** 2, sin(a) ** 2 + cos(b) ** 2),
    (m * sin(a) ** 2 * cos(b) ** 2 + m * cos(a) ** 2 * cos(b) ** 2 + m * sin(b) ** 2, m),
    ((sin(a) + cos(a)) ** 2, 1 + 2 * sin(a) * cos(a)),
    (sin(a) * m + cos(b) * m, m * (sin(a) + cos(b))),
    (sin(a) ** 2 / cos(a), sin(a) * tan(a)),
    (m * cos(a) / sin(a) ** 3, m * cot(a) / sin(a) ** 2),
    ((m**2 - 1) / (m - 1), m + 1),
    (m * sin(a) / (m * cos(a) + m), sin(a) / (cos(a) + 1)),
    (cos(a) * cos(b) - sin(a) * sin(b), cos(a + b)),
    (cos(a) * cos(b) + sin(a) * sin(b), cos(a - b)),
    (sin(a) * cos(b) + cos(a) * sin(b), sin(a + b)),
    (2 * m * (sin(a) * cos(b) - cos(a) * sin(b)), 2 * m * sin(a - b)),
    (cos(a) * cos(b) - 2 * sin(a) * sin(b), cos(a) * cos(b) - 2 * sin(a) * sin(b)),
]


@pytest.mark.parametrize(("expression", "expected"), FOLDED, ids=str)
def test_textbook_forms(expression, expected):
    assert shown(expression) == expected


VALUES = {**values_along((a, b), paths(1, size=2, seed=5)[0]), m: mp.mpf(5) / 11}
CODECS = {
    "circles": CODEC,
    "angles": codec_for([sin(a + b), cos(2 * a), m, Rational(1, 2)]),
    "quaternion": codec_for([w, x, y, z, m], constraints=[UNIT]),
    "inverse and root": codec_for([x, y, sqrt(1 + x**2), 1 / (1 + x**2), 1 / (x + y)]),
}


def elements(codec: Codec) -> st.SearchStrategy:
    monomials = st.lists(st.sampled_from(codec.ring.polynomials.gens), max_size=4)
    terms = st.tuples(st.integers(-4, 4), monomials).map(
        lambda p: prod(p[1], start=codec.ring.one * p[0])
    )
    sums = st.lists(terms, min_size=1, max_size=4)
    return sums.map(lambda parts: codec.ring.reduce(sum(parts, codec.ring.zero)))


@pytest.mark.parametrize("codec", CODECS.values(), ids=CODECS)
@given(data=st.data())
@settings(max_examples=40)
def test_a_form_has_the_value_of_the_element_and_is_not_longer(codec, data):
    element = data.draw(elements(codec))
    form, plain = presenter_for(codec).element(element), codec.decode(element)
    assert sp.count_ops(form) <= sp.count_ops(sp.expand(plain))
    assert codec.encode_quotient(form).equals(codec.encode_quotient(plain))
    if codec is CODEC:
        assert PRESENTER.quotient(codec.encode_quotient(form)) == form
        assert abs(number(form, dict(VALUES)) - number(plain, dict(VALUES))) <= 1000 * TOLERANCE


def forgetful(_ring, element):
    """A shortening that loses a term."""
    return element - element.ring.term_new(*next(iter(element.items())))


def test_a_form_with_another_value_is_not_returned(monkeypatch):
    value = CODEC.encode(m * sin(a) + cos(b))
    monkeypatch.setattr(present, "shortest", forgetful)
    with pytest.raises(AlgebraError, match="differs from its normal form"):
        Presenter(CODEC).quotient(Quotient(CODEC.ring, value, CODEC.encode(1 + m)))


def test_rational_functions_cancel_and_are_written_again():
    codec = codec_for([1 / (x + y), 1 / (x - y), m], order=None)
    read, written = codec.encode_quotient, presenter_for(codec).quotient
    assert sp.cancel(written(read(1 / (x + y) + 1 / (x - y))) - 2 * x / (x**2 - y**2)) == 0
    assert read((x**2 - y**2) / (x + y)).equals(read(x - y))
    assert written(read(m / (x + y))) == m / (x + y)


@pytest.mark.parametrize(
    "terms", [(), (a,), (2, a, 3), (a, -a), (2 * a * b, b * a), (a + b, 2 * a), (b, a * m, a, 5)]
)
def test_sums_are_those_of_sympy(terms):
    terms = tuple(map(sp.sympify, terms))
    assert added(*terms).args == sp.Add(*terms).args
    assert added(*terms) == sp.Add(*terms)


@pytest.mark.parametrize("expression", [a, a_dot, sin(a), cos(a - b), 1 / (m + 1), sqrt(2), m])
def test_operations_are_counted_as_by_sympy(expression):
    assert present._operations(expression) == sp.count_ops(expression)


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
