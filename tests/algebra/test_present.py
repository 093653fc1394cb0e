"""What people read: equal to the normal form, found again when read back, never longer."""

from __future__ import annotations

from random import Random

import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st
from sympy import Rational, cos, cot, sin, sqrt, tan

from helpers.witness import TOLERANCE, mp, number, paths, values_along
from rigidsym.algebra import present
from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import Presenter, Rationals, presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.errors import AlgebraError
from rigidsym.models.rotation import time_function

LAW = settings(max_examples=150, deadline=None, derandomize=True)
TIME = sp.Symbol("t")
a, b, w, x, y, z = map(time_function, ("a", "b", "w", "x", "y", "z"))
a_dot, b_dot = a.diff(TIME), b.diff(TIME)
m = sp.Symbol("m")
UNIT = w**2 + x**2 + y**2 + z**2 - 1


GENERATORS = [sin(a), cos(a), sin(b), cos(b), a_dot, b_dot, m]
CODEC = codec_for(GENERATORS)
PRESENTER = presenter_for(CODEC)


def shown(expression: sp.Expr, codec: Codec = CODEC) -> sp.Expr:
    """The textbook form of an expression."""
    return presenter_for(codec).quotient(codec.encode_quotient(expression))


FOLDED = [
    (sin(a) ** 2 + cos(a) ** 2, 1),
    (1 - cos(a) ** 2, sin(a) ** 2),
    (2 - cos(a) ** 2 - sin(b) ** 2, sin(a) ** 2 + cos(b) ** 2),
    (
        m * sin(a) ** 2 * cos(b) ** 2 + m * cos(a) ** 2 * cos(b) ** 2 + m * sin(b) ** 2,
        m,
    ),
    (sin(a) ** 3 + sin(a) * cos(a) ** 2, sin(a)),
    ((sin(a) + cos(a)) ** 2, 1 + 2 * sin(a) * cos(a)),
    (sin(a) * m + cos(b) * m, m * (sin(a) + cos(b))),
    (sin(a) / cos(a), tan(a)),
    (m * cos(a) / sin(a), m * cot(a)),
    (sin(a) ** 2 / cos(a), sin(a) * tan(a)),
    (m * cos(a) / sin(a) ** 3, m * cot(a) / sin(a) ** 2),
    ((1 - cos(a) ** 2) * sin(b) / (sin(a) * cos(b)), sin(a) * tan(b)),
    ((m**2 - 1) / (m - 1), m + 1),
    (m * sin(a) / (m * cos(a) + m), sin(a) / (cos(a) + 1)),
    (Rational(-2, 3) * m, -2 * m / 3),
]


@pytest.mark.parametrize(("expression", "expected"), FOLDED, ids=str)
def test_textbook_forms(expression, expected):
    assert shown(expression) == expected


ONE_OVER = 1 / (1 + x**2 + y**2 + z**2)


VALUES = {**values_along((a, b), paths(1, size=2, seed=5)[0]), m: mp.mpf(5) / 11}


def polynomials(largest: int = 4) -> st.SearchStrategy:
    monomials = st.lists(st.sampled_from(GENERATORS), max_size=4).map(lambda f: sp.Mul(*f))
    terms = st.tuples(st.integers(-4, 4), monomials).map(lambda pair: pair[0] * pair[1])
    return st.lists(terms, min_size=1, max_size=largest).map(lambda parts: sp.Add(*parts))


@given(expression=polynomials())
@LAW
def test_a_form_has_the_value_of_the_expression_and_is_not_longer(expression):
    element = CODEC.encode(expression)
    form = PRESENTER.element(element)
    one, other = number(form, dict(VALUES)), number(expression, dict(VALUES))
    assert abs(one - other) <= TOLERANCE * max(1, abs(other))
    assert sp.count_ops(form) <= sp.count_ops(sp.expand(CODEC.decode(element)))
    assert PRESENTER.quotient(CODEC.encode_quotient(form)) == form


def test_matrix_is_presented_entry_by_entry():
    entries = [sin(a) ** 2 + cos(a) ** 2, m * sin(a), cos(a) * m**2, 1 - sin(b) ** 2]
    encoded = [CODEC.encode(entry) for entry in entries]
    matrix = RingMatrix.of(CODEC.ring, [encoded[:2], encoded[2:]])
    assert PRESENTER.matrix(matrix) == sp.Matrix([[1, m * sin(a)], [cos(a) * m**2, cos(b) ** 2]])
    divided = PRESENTER.matrix(matrix, CODEC.encode(m))
    assert divided == sp.Matrix([[1 / m, sin(a)], [cos(a) * m, cos(b) ** 2 / m]])


def forgetful(_ring, element):
    """A shortening that loses a term."""
    return element - element.ring.term_new(*next(iter(element.items())))


def test_a_form_with_another_value_is_not_returned(monkeypatch):
    value = CODEC.encode(m * sin(a) + cos(b))
    monkeypatch.setattr(present, "shortest", forgetful)
    with pytest.raises(AlgebraError, match="differs from its normal form"):
        Presenter(CODEC).quotient(Quotient(CODEC.ring, value, CODEC.encode(1 + m)))


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (cos(a) * cos(b) - sin(a) * sin(b), cos(a + b)),
        (cos(a) * cos(b) + sin(a) * sin(b), cos(a - b)),
        (sin(a) * cos(b) + cos(a) * sin(b), sin(a + b)),
        (sin(a) * cos(b) - cos(a) * sin(b), sin(a - b)),
        (2 * x * (cos(a) * cos(b) - sin(a) * sin(b)), 2 * x * cos(a + b)),
        (
            x * cos(a) ** 2 * cos(b) ** 2 - x * cos(a) * cos(b) * sin(a) * sin(b),
            x * cos(a) * cos(b) * cos(a + b),
        ),
        (cos(a) * cos(b) - 2 * sin(a) * sin(b), cos(a) * cos(b) - 2 * sin(a) * sin(b)),
    ],
    ids=str,
)
def test_angle_sums_are_folded(expression, expected):
    codec = codec_for([expression])
    assert presenter_for(codec).element(codec.encode(expression)) == expected


def random_polynomial(rng: Random, names: list[sp.Expr], terms: int) -> sp.Expr:
    return sp.Add(
        *(
            Rational(rng.choice((1, 1, 2, -1, -1, -3, 4)), rng.choice((1, 1, 1, 2, 3)))
            * sp.Mul(
                *(rng.choice(names) ** rng.choice((1, 1, 2, 3)) for _ in range(rng.randint(0, 3)))
            )
            for _ in range(terms)
        )
    )


RINGS = {
    "circles": codec_for([*GENERATORS, Rational(1, 2)]),
    "whole numbers": CODEC,
    "angles": codec_for([sin(a + b), cos(2 * a), m, Rational(1, 2)]),
    "quaternion": codec_for([w, x, y, z, m], constraints=[UNIT]),
    "inverse": codec_for([x, y, z, m, ONE_OVER, Rational(1, 2)]),
    "inverse and root": codec_for([x, y, sqrt(1 + x**2), 1 / (1 + x**2), 1 / (x + y)]),
}


def forms_in(name: str) -> list[str]:
    """Random elements and quotients, with their forms."""
    codec, rng = RINGS[name], Random(name)
    names = [gen.expression for gen in codec.ring.generators]
    found = []
    for k in range(24):
        above = codec.encode_quotient(random_polynomial(rng, names, 1 + k % 6))
        below = codec.encode_quotient(
            random_polynomial(rng, names, 1 + k % 3) if k % 2 else sp.S.One
        )
        if not below.numerator:
            continue
        value = above * below.inverse()
        form = Presenter(codec).quotient(value)
        found.append(f"{codec.decode(value.numerator)} over {codec.decode(value.denominator)}")
        found.append(f"    {form}")
    if len(codec.angle_pairs) == 2:
        one, two = (sp.Integer(1), *(gen.args[0] for gen in names if gen.func is sin))[1:]
        for part in (
            cos(one - two),
            2 * m * sin(one + two) + 3 * cos(one),
            sin(one + two) * cos(one),
        ):
            value = codec.encode(part)
            found += [f"{part}", f"    {Presenter(codec).element(value)}"]
    return found


def test_forms_are_as_they_were(golden):
    """Which of several equal forms is chosen."""
    lines = [line for name in RINGS for line in (name, *forms_in(name))]
    golden("notes/textbook_forms.txt", "\n".join(lines) + "\n")


def test_rational_functions_cancel_and_are_written_again():
    field = Rationals.of([1 / (x + y), 1 / (x - y), m])
    one, two = field.read(1 / (x + y)), field.read(1 / (x - y))
    assert sp.cancel(field.write(field.total([one, two])) - 2 * x / (x**2 - y**2)) == 0
    assert field.write(field.total([one, -one])) == 0
    assert Rationals(field.codec).read((x**2 - y**2) / (x + y)).equals(field.read(x - y))
    ((again,),) = field.read_matrix(sp.Matrix([[m / (x + y)]]))
    assert field.write(again) == m / (x + y)
