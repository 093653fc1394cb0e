"""What the ring holds, what it decides, what it refuses, and the way in and out."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st
from sympy import Rational, cos, cot, csc, pi, sec, sin, sqrt, tan

from helpers.witness import TOLERANCE, mp, number, paths, values_along
from rigidsym.algebra.codec import codec_for
from rigidsym.errors import AlgebraError
from rigidsym.models.rotation import time_function

LAW = settings(max_examples=80, deadline=None, derandomize=True)
TIME = sp.Symbol("t")
a, b, u, x, y, z = map(time_function, ("a", "b", "u", "x", "y", "z"))
k, m, length = sp.symbols("k m l")
squares = x**2 + y**2 + z**2


def are_equal(first: sp.Expr, second: sp.Expr, *constraints: sp.Expr) -> bool:
    """Whether one ring holds both, and decides that they are the same."""
    codec = codec_for([first, second], constraints=constraints)
    return codec.encode_quotient(sp.sympify(first)).equals(
        codec.encode_quotient(sp.sympify(second))
    )


IDENTITIES = [
    (sin(a) ** 2 + cos(a) ** 2, 1),
    (sin(2 * a), 2 * sin(a) * cos(a)),
    (sin(a / 2) ** 2, (1 - cos(a)) / 2),
    (cos(2 * a) * cos(a / 3), (cos(7 * a / 3) + cos(5 * a / 3)) / 2),
    (cos(a / 2 + b / 3) ** 2, (1 + cos(a + 2 * b / 3)) / 2),
    (sin(a + b) * sin(a - b), cos(b) ** 2 - cos(a) ** 2),
    (sin(k * a) ** 2 + cos(k * a) ** 2, 1),
    (cos(k) * cos(k / 5), (cos(6 * k / 5) + cos(4 * k / 5)) / 2),
    (sin((a + b) * u), sin(a * u) * cos(b * u) + cos(a * u) * sin(b * u)),
    (sin(u.diff(TIME)) ** 2, 1 - cos(u.diff(TIME)) ** 2),
    (tan(a), sin(a) / cos(a)),
    (tan(2 * a), 2 * tan(a) / (1 - tan(a) ** 2)),
    (tan(a / 2), sin(a) / (1 + cos(a))),
    (cot(a) * tan(a), 1),
    (csc(a) ** 2 - cot(a) ** 2, 1),
    (sin(a + pi / 3), sin(a) / 2 + sqrt(3) / 2 * cos(a)),
    (cos(a + pi / 5) + cos(a - pi / 5), (1 + sqrt(5)) / 2 * cos(a)),
    (sin(a + pi / 12), (sqrt(6) + sqrt(2)) / 4 * sin(a) + (sqrt(6) - sqrt(2)) / 4 * cos(a)),
    (cos(a + pi / 8) ** 2 + sin(a + pi / 8) ** 2, 1),
    (cos(a - 9 * pi), -cos(a)),
    (1 / sqrt(12), sqrt(3) / 6),
    (sp.Integer(2) ** Rational(1, 4) * sqrt(sqrt(2)) * m, sqrt(2) * m),
    ((1 + sqrt(5)) ** 2, 6 + 2 * sqrt(5)),
    (sp.I**2 * m, -m),
    (1 / (1 + 4 * u**2) + 4 * u**2 / (1 + 4 * u**2), 1),
    (1 / m - 1 / length, (length - m) / (m * length)),
    (squares ** Rational(-3, 2), sqrt(squares) / squares**2),
    (x / sqrt(squares) * sqrt(squares), x),
    (sin(sqrt(squares)) ** 2, 1 - cos(sqrt(squares)) ** 2),
    (sin(sin(a)) ** 2 + cos(sin(a)) ** 2, 1),
    (sqrt(1 - u**2) ** 4, (1 - u**2) ** 2),
    (m ** Rational(3, 2), m * sqrt(m)),
]
DIFFERENCES = [
    (sin(2 * a), 2 * sin(a)),
    (sin(a) ** 2 + cos(b) ** 2, 1),
    (sin(a / 2), (1 - cos(a)) / 2),
    (sin(a + pi / 3), sin(a) / 2),
    (sqrt(2), Rational(665857, 470832)),
    (sqrt(2) + sqrt(3), sqrt(5)),
    (1 / (1 + u**2), 1 / (1 - u**2)),
    (sqrt(squares), x + y + z),
    (sin(k * a), k * sin(a)),
    (a, a.diff(TIME)),
    (m, m + Rational(1, 10**60)),
]


@pytest.mark.parametrize(("first", "second"), IDENTITIES, ids=str)
def test_identities_are_decided(first, second):
    assert are_equal(first, second)


@pytest.mark.parametrize(("first", "second"), DIFFERENCES, ids=str)
def test_what_differs_is_told_apart(first, second):
    assert not are_equal(first, second)


def test_a_constraint_holds_for_all_time():
    unit = squares - 1
    assert are_equal(x**2, 1 - y**2 - z**2, unit)
    rates = sum(q * q.diff(TIME) for q in (x, y, z))
    assert are_equal(rates, 0, unit)
    second = sum(q.diff(TIME) ** 2 + q * q.diff(TIME, 2) for q in (x, y, z))
    assert are_equal(second, 0, unit)
    assert not are_equal(rates, 0)
    assert not are_equal(x * x.diff(TIME), 0, unit)
    assert are_equal(8 * x * x.diff(TIME), -6 * y * y.diff(TIME), 4 * x**2 + 3 * y**2 - 1)


def test_generators_are_as_few_as_can_be():
    def held(*expressions):
        return {generator.expression for generator in codec_for(expressions).ring.generators}

    rates = {a.diff(TIME), a.diff(TIME, 2)}
    assert held(cos(2 * a), cos(a)) == {sin(a), cos(a)} | rates
    assert held(cos(2 * a)) == {sin(2 * a), cos(2 * a)} | rates
    assert held(cos(2 * a), sin(a / 3)) == {sin(a / 3), cos(a / 3)} | rates
    assert held(sin(k), m) == {sin(k), cos(k), m}


def test_independent_sums_are_angles_by_themselves():
    turns = (2 * a - Rational(3, 2) * b + x, Rational(2, 3) * y - z / 4, a + b / 2)
    codec = codec_for([cos(angle) for angle in turns], order=0)
    assert codec.encode(cos(turns[0])) in codec.ring.polynomials.gens
    assert len(codec.angle_pairs) == len(turns)
    codec = codec_for([sin(a + b), sin(a - b)])
    assert codec.encode(sin(2 * a + pi / 2)) == codec.encode(
        cos(a + b) * cos(a - b) - sin(a + b) * sin(a - b)
    )
    with pytest.raises(AlgebraError, match="is not in the ring"):
        codec.encode(sin(a))


ATOMS = [
    sin(a),
    cos(a),
    sin(2 * a - b),
    cos(a / 2),
    sin(b / 3 + pi / 6),
    tan(b),
    1 / (2 + u**2),
    sqrt(3 + u**2),
    u,
    a.diff(TIME),
    b.diff(TIME),
    m,
    sqrt(2),
    Rational(2, 3),
]
EVERY = codec_for(ATOMS)
PATH = paths(1, seed=4)[0]


def at(t) -> dict[sp.Expr, object]:
    """Values on a path, at time t."""
    return {**values_along((a, b, u), PATH, t), m: mp.mpf(3) / 7}


def expressions() -> st.SearchStrategy:
    """Sums of products of a few atoms, held in one ring."""
    products = st.lists(st.sampled_from(ATOMS), min_size=1, max_size=3).map(lambda f: sp.Mul(*f))
    terms = st.tuples(st.integers(-3, 3), products).map(lambda pair: pair[0] * pair[1])
    return st.lists(terms, min_size=1, max_size=3).map(lambda parts: sp.Add(*parts))


@given(expression=expressions())
@LAW
def test_the_way_in_and_out_keeps_the_value(expression):
    decoded = EVERY.decode(EVERY.encode(expression))
    assert EVERY.encode(decoded) == EVERY.encode(expression)
    error = number(decoded, at(0)) - number(expression, at(0))
    assert abs(error) < TOLERANCE * 1000


@given(first=expressions(), second=expressions())
@LAW
def test_encoding_is_a_homomorphism(first, second):
    ring, encode = EVERY.ring, EVERY.encode
    assert encode(first + second) == encode(first) + encode(second)
    assert encode(first * second) == ring.reduce(encode(first) * encode(second))


@given(expression=expressions())
@LAW
def test_dt_is_the_derivative(expression):
    rate = EVERY.ring.dt(EVERY.encode(expression))
    assert rate == EVERY.encode(sp.diff(expression, TIME))


def test_beyond_the_order_there_is_no_derivative():
    for order in (1, 2, 3):
        codec = codec_for([a.diff(TIME)], order=order)
        highest = codec.encode(a.diff(TIME, order))
        with pytest.raises(AlgebraError, match=r"build it with a higher order$") as caught:
            codec.ring.dt(highest)
        assert str(sp.diff(a, TIME, order)) in str(caught.value)


def refusal(expression: sp.Expr) -> str:
    with pytest.raises(AlgebraError) as caught:
        codec_for([expression])
    return str(caught.value)


@pytest.mark.parametrize(
    ("expression", "fraction"),
    [
        (0.5 * sin(a), "1/2"),
        (sin(0.25 * a), "1/4"),
        (sin(a + 0.1), "1/10"),
        (u**0.5, "1/2"),
        (sp.cosh(0.2 * u), "1/5"),
        (1 / (1.5 + u), "3/2"),
        (sp.sqrt(sp.Float("0.75")) * 0 + sp.Float("0.75") * u, "3/4"),
    ],
    ids=str,
)
def test_floats_are_refused_with_the_fraction_to_write(expression, fraction):
    message = refusal(expression)
    assert "is a floating-point number; exact work needs a fraction such as" in message
    assert message.endswith(fraction)


@pytest.mark.parametrize(
    ("expression", "part"),
    [
        (sin(a + 1), "not in the ring"),
        (sin(sp.Integer(2)), "not in the ring"),
        (cos(a + pi / 7), "pi/7"),
        (sp.nan * a, "nan"),
        (sp.zoo + a, "zoo"),
        (sp.gamma(a), "the derivatives of polygamma("),
        (sp.Function("f")(a), "not in the ring"),
        (sp.Function("f")(TIME, a), "not in the ring"),
    ],
    ids=str,
)
def test_what_no_ring_holds_is_refused_in_words(expression, part):
    assert part in refusal(expression)


def test_quotients_and_foreign_expressions_are_not_polynomials():
    codec = codec_for([sin(a), cos(a)])
    for foreign in (sin(b), sin(a / 2), u, sqrt(2), sp.cosh(u)):
        with pytest.raises(AlgebraError, match="not in the ring"):
            codec.encode(foreign)
    with pytest.raises(AlgebraError, match="division by an expression that is zero"):
        codec.encode_quotient(1 / (sin(a) ** 2 + cos(a) ** 2 - 1))
    with pytest.raises(AlgebraError, match=r"is a quotient, and its inverse is not in the ring$"):
        codec.encode(1 / cos(a))
    assert codec.encode_quotient(1 / cos(a)).denominator == codec.encode(cos(a))


@pytest.mark.parametrize(
    "expression", [sp.cosh(u), sp.erf(u), u**k, sqrt(x + y), sqrt(2) * u], ids=str
)
def test_a_ring_that_may_not_know_all_relations_says_so(expression):
    """Roots of related numbers and expressions may depend on one another unseen."""
    assert not codec_for([expression]).ring.complete
    assert codec_for([sin(a), 1 / (1 + u**2), m * x, tan(a / 2)]).ring.complete


RINGS: list[tuple[list[sp.Expr], dict[str, object]]] = [
    ([expression], {})
    for expression in (
        sp.Integer(2) * m,
        m / 2,
        sp.pi * k + x,
        sqrt(6) + sqrt(12) * x,
        2 ** Rational(1, 4) + sqrt(2) * m,
        2 ** Rational(1, 4) + 3 ** Rational(1, 6) + sqrt(3),
        10 ** Rational(-3, 2),
        sp.I * x,
        1 / (1 + x**2),
        m / x**2,
        sqrt(1 + x**2) + 1 / sqrt(x**2 + y**2),
        (x + y) ** Rational(-3, 2),
        tan(a) + sec(2 * a),
        cot(a) * csc(b),
        sin(2 * a) * cos(a / 3) + cos(b / 2),
        sin(-3 * a) + cos(a - 2 * b),
        sin(a + pi / 4) + cos(b - pi / 3),
        sin(pi / 5 + k),
        cos(m * a) + sin(k),
        sin(a * b) + sin(a**2),
        sin(a / x) + cos(sqrt(x)),
        sin(sp.exp(x)),
        sp.exp(x) + sp.Abs(y) + TIME,
        sp.cosh(x) ** 2,
        x**m + m**x,
        a.diff(TIME) * b.diff(TIME, 2),
        sin(a.diff(TIME)),
    )
]
RINGS += [
    ([sin(a) * x], {"order": 0}),
    ([sin(a) * x / y], {"order": 1}),
    ([sp.exp(sin(a))], {"order": 2}),
    ([x, y], {"constraints": [x**2 + y**2 - 1]}),
    ([x, m], {"constraints": [2 * x - m, m**2 - 3], "order": 1}),
    ([sin(a), x], {"constraints": [x - sin(a)]}),
]


def ring_in_words(expressions: list[sp.Expr], options: dict[str, object]) -> list[str]:
    """The generators of a ring, its relations and derivatives, and the expressions in it."""
    try:
        codec = codec_for(expressions, **options)
        encoded = [codec.encode_quotient(expression) for expression in expressions]
    except AlgebraError as error:
        return [str(error)]
    ring = codec.ring
    names = [gen.expression for gen in ring.generators]
    return [
        f"generators over {ring.polynomials.domain}: {', '.join(map(str, names))}",
        f"opaque: {', '.join(str(gen.expression) for gen in ring.generators if gen.opaque)}",
        *(f"0 = {relation}" for relation in ring.relations),
        *(f"d/dt {names[g]} = {codec.decode(rate)}" for g, rate in ring.derivatives.items()),
        *(f"{codec.decode(e.numerator)} over {codec.decode(e.denominator)}" for e in encoded),
        f"angles: {codec.angle_pairs}",
    ]


def test_rings_are_as_they_were(golden):
    lines = []
    for expressions, options in RINGS:
        lines.append(f"{expressions} {options or ''}".strip())
        lines += [f"    {line}" for line in ring_in_words(expressions, options)]
    golden("notes/rings.txt", "\n".join(lines) + "\n")
