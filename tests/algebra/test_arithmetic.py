"""The arithmetic of the ring, its quotients and matrices, against SymPy's numbers and matrices.
Every change of one sign, operator or constant of it was seen here.
"""

from __future__ import annotations

import pytest
import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, cross, hat, unhat
from rigidsym.algebra.ring import Quotient, Ring
from rigidsym.errors import AlgebraError
from rigidsym.models.rotation import TIME, time_function

PHI, X = time_function("phi"), time_function("x")


AT = {  # a point of the circle, where all values are rational numbers
    sp.sin(PHI): sp.Rational(3, 5),
    sp.cos(PHI): sp.Rational(4, 5),
    X: sp.Rational(7, 3),
    sp.diff(X, TIME): sp.Rational(2, 5),
    sp.diff(PHI, TIME): sp.Rational(1, 7),
}


def test_the_ring_its_quotients_and_its_matrices_are_right():
    codec = codec_for([sp.sin(PHI), sp.diff(X, TIME), X, sp.Rational(1, 2)], order=1)
    here: Ring = codec.ring
    c, s, x = (here.generator(here.index[e]) for e in (sp.cos(PHI), sp.sin(PHI), X))
    a, b, d = here.reduce(2 * x**2 * c + 3 * s * x - 1), s * c - x + 4, s * x + 2 * c

    def value(found: PolyElement | Quotient) -> sp.Expr:
        if isinstance(found, Quotient):
            return value(found.numerator) / value(found.denominator)
        return codec.decode(found).xreplace(AT)

    def values(found: RingMatrix) -> sp.Matrix:
        return sp.Matrix(*found.shape, list(map(value, found.entries)))

    square = RingMatrix.of(here, [[a, b, x], [c, s, b], [here.one, d, a]])
    four = RingMatrix.of(here, [[a, b, x, c], [c, s, b, d], [x, d, a, s], [s, x, here.one, b]])
    first, second = Quotient(here, a, x), Quotient(here, b, c)
    whole = [Quotient.whole(here, e) for e in (b, x)]
    u, v = (RingMatrix.column(here, e) for e in ((a, b, c), (x, d, s)))
    A, B, C, S, x0 = map(value, (a, b, c, s, x))  # noqa: N806
    derivative = sp.diff(codec.decode(a), TIME).xreplace(AT)
    pairs = [
        (here.dot([(a, b), (x, s)], minus=[(b, b), (s, s)]), A * B + x0 * S - B**2 - S**2),
        (here.dot((x, here.one) for x in (a, b, here.reduce(-a))), B),
        (here.dt(a), derivative),
        (here.reduce(s**3 * x), S**3 * x0),
        (first + second, A / x0 + B / C),
        (first + first, 2 * A / x0),
        (first * second, A * B / x0 / C),
        (second * whole[1], B * x0 / C),
        (second**-2, C**2 / B**2),
        (second**3, B**3 / C**3),
        (Quotient.sum(here, whole), B + x0),
        (Quotient.sum(here, [first, second]), A / x0 + B / C),
        (Quotient.sum(here, [first, whole[0]]), A / x0 + B),
        *((part.det(), values(part).det()) for part in (square, four, u.T @ v, minor(square))),
    ]
    matrices = [
        (square @ square, values(square) ** 2),
        (square - square.T, values(square) - values(square).T),
        *((m.adjugate(), values(m).adjugate()) for m in (square, four, minor(square))),
        (RingMatrix(here, ((a,),)).adjugate(), sp.eye(1)),
        (RingMatrix.column(here, cross(here, u.entries, v.entries)), values(u).cross(values(v))),
        (hat(u) @ v, values(u).cross(values(v))),
        (unhat(hat(u)), values(u)),
    ]
    for found, expected in pairs:
        assert value(found) == expected
    for found, expected in matrices:
        assert values(found) == expected
    whole_sum = Quotient(here, here.dot([(a, c), (b, x)]), here.reduce(x * c))
    assert (first + second).equals(whole_sum)
    assert first.equals(Quotient(here, here.dot([(a, c)]), here.reduce(x * c)))
    for other in (first + second, Quotient(here, b, x), Quotient(here, a, c)):
        assert not first.equals(other)
    assert here.dt(here.one) == here.zero
    assert here.dot([(s, s), (c, c), (x, s)]) == here.one + x * s  # a term that cancels is gone


def minor(of: RingMatrix) -> RingMatrix:
    return RingMatrix(of.ring, tuple(row[:2] for row in of.rows[:2]))


def test_what_the_ring_cannot_do_is_said():
    codec = codec_for([sp.sin(PHI), X], order=1)
    ring = codec.ring
    s, c = (ring.generator(ring.index[e]) for e in (sp.sin(PHI), sp.cos(PHI)))
    with pytest.raises(AlgebraError, match=r"time derivative of Derivative\(phi\(t\), t\)"):
        ring.dt(codec.encode(sp.diff(PHI, TIME)))
    with pytest.raises(AlgebraError, match="zero in the ring"):
        Quotient(ring, s, ring.reduce(s**2 + c**2 - 1))
    with pytest.raises(AlgebraError, match=r"^the relations contradict one another: .*1 = 0$"):
        ring.set_relations([s - 1, s - 2])
    other = codec_for([sp.sin(X), PHI], order=1).ring
    with pytest.raises(AlgebraError, match="different rings"):
        RingMatrix.identity(ring, 2) - RingMatrix.identity(other, 2)


def test_members_of_the_ideal_and_they_alone_are_zero():
    """Also after new relations, which replace what was remembered."""
    w, x, y, z = map(time_function, "wxyz")
    unit = w**2 + x**2 + y**2 + z**2 - 1
    ring = codec_for([w, x, y, z], order=1, constraints=[unit]).ring
    for k, relation in enumerate(ring.relations):
        member = relation * (ring.generator(k % 4) ** 2 * 3 - 1)
        assert ring.is_zero(member)
        assert not ring.is_zero(member + ring.generator(0))
    square = ring.generator(ring.index[w]) ** 2
    assert ring.reduce(square) != ring.one * 2
    ring.set_relations([square - 2])
    assert ring.reduce(square) == ring.one * 2
