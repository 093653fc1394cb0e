"""What people read: equal to the normal form, found again when read back, never longer.

One evaluation in every arithmetic: intervals enclose the value, floats and arrays come near. The
entire functions c_k of n²: coefficients, switches and bounds, and forms that hold them.
"""

from __future__ import annotations

from functools import cache
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
from rigidsym.algebra.stable_forms import FIRST_SERIES, Stumpff, halved, rewriter_for, series_of
from rigidsym.errors import AlgebraError
from rigidsym.models.library import rotation_from
from rigidsym.models.rotation import TIME, time_function
from rigidsym.motion import derive

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


ORDERS = range(FIRST_SERIES, 8)
NORM = sp.sqrt(x**2 + y**2 + z**2)


def entire(order: int, x) -> mp.mpf:
    """c_k by its integral over (1 − t)^{k−1}/(k−1)! cos nt, which the package does not use."""
    n = mp.sqrt(x)
    if order == 0:
        return mp.cos(n)
    weight = mp.factorial(order - 1)
    return mp.quad(lambda t: (1 - t) ** (order - 1) * mp.cos(n * t), [0, 1]) / weight


@pytest.mark.parametrize("order", ORDERS)
def test_what_the_series_leaves_out_is_within_its_bound(order):
    series = series_of(order)
    for part in (0, 0.1, 0.5, 0.9, 1):
        x = mp.mpf(series.switch.numerator) / series.switch.denominator * part
        terms = (mp.mpf(c.numerator) / c.denominator for c in series.coefficients)
        value = mp.fsum(term * x**j for j, term in enumerate(terms))
        truth = entire(order, x)
        bound = mp.mpf(series.remainder.numerator) / series.remainder.denominator
        assert abs(value - truth) <= bound * truth
        assert bound <= mp.mpf(2) ** -56


@cache
def module():
    return derive(rotation_from("rotation_vector")).kernels().load()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("order", range(6))
def test_arrays_and_floats_keep_the_bound_on_both_sides_of_the_switch(order, dtype):
    """Of c₀ to c₂ the bound is one of the largest value, 1/k!."""
    eps = float(np.finfo(dtype).eps)
    switch = float(series_of(max(order, FIRST_SERIES)).switch)
    sides = np.concatenate([np.linspace(0.97, 1, 12), np.linspace(1, 1.03, 12)]) * switch
    far = np.geomspace(1e-30, 200, 24)
    x = np.concatenate([[0.0], sides, far]).astype(dtype)
    bound = float(series_of(order).error) if order >= FIRST_SERIES else 4.0
    with np.errstate(all="ignore"):
        arrays = module()._entire(x, order)[0]
    assert arrays.dtype == dtype
    for square, value in zip(x.tolist(), arrays.tolist(), strict=True):
        truth = entire(order, mp.mpf(square))
        scale = truth if order >= FIRST_SERIES else 1 / mp.factorial(order)
        spread = 1 if order >= FIRST_SERIES else max(1, float(mp.sqrt(square)))
        assert abs(value - truth) <= bound * spread * eps * scale, square
        if dtype is np.float64:
            twin = module()._entire_scalar(square, order)[0]
            assert abs(twin - truth) <= bound * spread * eps * scale, square


def rewritten(expression: sp.Expr) -> sp.Expr | None:
    rewriter = rewriter_for(codec_for([sp.sin(NORM) / NORM, x]))
    assert rewriter is not None
    return rewriter.rewritten(expression)


@pytest.mark.parametrize(
    ("expression", "form"),
    [
        (sp.sin(NORM) / NORM, Stumpff(1, NORM**2)),
        ((1 - sp.cos(NORM)) / NORM**2, Stumpff(2, NORM**2)),
        ((NORM - sp.sin(NORM)) / NORM**3, Stumpff(3, NORM**2)),
        (x + sp.cos(NORM), x + Stumpff(0, NORM**2)),
        ((sp.sin(NORM) - NORM * sp.cos(NORM)) / NORM**3, Stumpff(2, NORM**2) - Stumpff(3, NORM**2)),
        (NORM * sp.sin(NORM) / (1 - sp.cos(NORM)), Stumpff(1, NORM**2) / Stumpff(2, NORM**2)),
    ],
    ids=str,
)
def test_removable_singularities_are_written_in_entire_functions(expression, form):
    assert rewritten(expression) == form


def test_a_divisor_of_one_minus_a_cosine_goes_over_to_half_the_angle():
    entries = [sp.sin(x) / (1 - sp.cos(x)), y + 1, (1 - sp.cos(x)) * y / (2 - 2 * sp.cos(x))]
    assert halved(entries, [sp.sin(x), y]) == [sp.cot(x / 2), y + 1, y / 2]
    assert halved([sp.sin(x) / (1 + sp.cos(x))], [sp.sin(x)]) == [sp.tan(x / 2)]
    assert halved([1 / (2 + sp.cos(x))], [sp.sin(x)]) == [1 / (2 + sp.cos(x))]
    codec = codec_for([sp.sin(x / 2)])
    assert codec.encode_quotient(entries[0]).equals(codec.encode_quotient(sp.cot(x / 2)))
