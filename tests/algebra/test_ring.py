"""The laws of the ring: normal forms, the zero test and the derivation d/dt."""

from __future__ import annotations

from math import prod

import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st

from rigidsym.algebra.matrix import cross
from rigidsym.algebra.ring import Generator, Quotient, Ring
from rigidsym.errors import AlgebraError
from rigidsym.models.rotation import time_function

LAW = settings(max_examples=60, deadline=None, derandomize=True)
theta, w, x, y, z = map(time_function, ("theta", "w", "x", "y", "z"))
TIME = sp.Symbol("t")


def ring_of(*expressions: sp.Expr, **options) -> Ring:
    return Ring([Generator(expression=expression) for expression in expressions], **options)


def circle(**options) -> Ring:
    """sin θ, cos θ, θ̇, a constant m: one relation, and the derivatives of all but θ̇."""
    ring = ring_of(sp.sin(theta), sp.cos(theta), theta.diff(TIME), sp.Symbol("m"), **options)
    s, c, rate, _ = ring.polynomials.gens
    ring.set_relations([s**2 + c**2 - 1])
    ring.set_derivatives({0: c * rate, 1: -s * rate, 3: ring.zero})
    return ring


def sphere() -> Ring:
    """A unit quaternion and its rates, on the sphere and tangent to it."""
    ring = ring_of(w, x, y, z, *(q.diff(TIME) for q in (w, x, y, z)))
    q, rates = ring.polynomials.gens[:4], ring.polynomials.gens[4:]
    ring.set_relations(
        [
            sum(a**2 for a in q) - 1,
            sum(a * b for a, b in zip(q, rates, strict=True)),
        ]
    )
    ring.set_derivatives(dict(enumerate(rates)))
    return ring


def roots() -> Ring:
    """√2 and an inverse: relations with leading coefficients other than 1."""
    ring = ring_of(sp.sqrt(2), 1 / (1 + 3 * x**2), x)
    root, inverse, q = ring.polynomials.gens
    ring.set_relations([root**2 - 2, inverse * (1 + 3 * q**2) - 1])
    return ring


RINGS = {"circle": circle(), "sphere": sphere(), "roots": roots()}
every_ring = pytest.mark.parametrize("ring", RINGS.values(), ids=RINGS)


def polynomials(ring: Ring, *, without: tuple[int, ...] = ()) -> st.SearchStrategy:
    """Random polynomials in the generators, as they come: not in normal form."""
    gens = [gen for place, gen in enumerate(ring.polynomials.gens) if place not in without]
    monomials = st.lists(st.sampled_from(gens), max_size=4)
    terms = st.lists(st.tuples(st.integers(-9, 9), monomials), max_size=4)
    return terms.map(lambda found: sum((prod(m, start=ring.one) * c for c, m in found), ring.zero))


@every_ring
@given(data=st.data())
@LAW
def test_the_normal_form_is_an_idempotent_homomorphism(ring, data):
    a, b = data.draw(polynomials(ring)), data.draw(polynomials(ring))
    reduce = ring.reduce
    assert reduce(a + b) == reduce(reduce(a) + reduce(b))
    assert reduce(a * b) == reduce(reduce(a) * reduce(b))
    assert reduce(-a) == -reduce(a)
    assert reduce(reduce(a)) == reduce(a)
    assert ring.dot([(a, b), (b, b)]) == reduce(a * b + b * b)


@every_ring
@given(data=st.data())
@LAW
def test_members_of_the_ideal_and_they_alone_are_zero(ring, data):
    member = sum(
        (data.draw(polynomials(ring)) * relation for relation in ring.relations), ring.zero
    )
    other = data.draw(polynomials(ring))
    assert ring.is_zero(member)
    assert ring.reduce(other + member) == ring.reduce(other)
    assert not ring.is_zero(ring.reduce(other) + member + 1) or ring.reduce(other) == -ring.one


SMOOTH = {
    "circle": (RINGS["circle"], (2,)),
    "sphere": (RINGS["sphere"], (4, 5, 6, 7)),
}
every_derivation = pytest.mark.parametrize(("ring", "rates"), SMOOTH.values(), ids=SMOOTH)


@every_derivation
@given(data=st.data())
@LAW
def test_dt_is_linear_and_obeys_leibniz(ring, rates, data):
    a = data.draw(polynomials(ring, without=rates))
    b = data.draw(polynomials(ring, without=rates))
    assert ring.dt(a * 3 - b) == ring.reduce(ring.dt(a) * 3 - ring.dt(b))
    assert ring.dt(a * b) == ring.reduce(ring.dt(a) * b + a * ring.dt(b))
    assert ring.dt(ring.reduce(a)) == ring.dt(a)


@every_derivation
def test_dt_of_a_relation_is_zero(ring, rates):
    q = {place for place in range(len(ring.generators)) if place not in rates}
    assert q == set(ring.derivatives)
    assert ring.dt(ring.relations[0]) == ring.zero
    assert ring.dt(ring.one * 5) == ring.zero


def test_contradictory_relations_are_refused():
    ring = ring_of(x)
    q = ring.generator(0)
    with pytest.raises(AlgebraError, match=r"^the relations contradict one another: .*1 = 0$"):
        ring.set_relations([q - 1, q - 2])


def test_new_relations_replace_what_was_remembered():
    ring = ring_of(x)
    q = ring.generator(0)
    assert ring.reduce(q**2) == q**2
    ring.set_relations([q**2 - 2])
    assert ring.reduce(q**2) == ring.one * 2
    ring.set_relations([])
    assert ring.reduce(q**2) == q**2


def test_what_the_ring_cannot_do_is_said():
    ring = RINGS["circle"]
    s, c, rate, m = ring.polynomials.gens
    assert not ring.can_derive(rate)
    with pytest.raises(AlgebraError, match=r"time derivative of Derivative\(theta\(t\), t\)"):
        ring.dt(rate * m)
    with pytest.raises(AlgebraError, match="zero in the ring"):
        Quotient(ring, s, ring.reduce(s**2 + c**2 - 1))
    # s·(s, c, 0) is held as (1 − c², sc, 0)
    vector = (s, c, ring.zero)
    assert not any(cross(ring, vector, tuple(ring.reduce(s * entry) for entry in vector)))
