"""Mass, first and second moments of a distribution of mass, each integrated or summed, and proved.

∫ dm, ∫ x dm and ∫ x xᵀ dm hold all that the motion of a rigid body depends on; the inertia tensor
is tr(J) 1 − J of the second moments J (lecture, section 2.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, singledispatch
from itertools import product

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec
from rigidsym.algebra.integrate import Integrator, integration_codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import Rationals, presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.errors import BodyError
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Proof
from rigidsym.mechanics.prove import Conditions, Prover
from rigidsym.models.body import (
    Composite,
    Distribution,
    Known,
    Part,
    Particles,
    Solid,
)

_PAIRS = tuple((i, j) for i in range(3) for j in range(i, 3))
_ANTIDERIVATIVES = formula(r"\frac{\partial F}{\partial u} = f \text{ for every integral}")
_ELEMENT = formula(r"\frac{dA}{du\,dv} = \sqrt{\det\mathbf{J}^{\mathsf T}\mathbf{J}}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Moments:
    """∫ dm, ∫ x dm (3, 1) and ∫ x xᵀ dm (3, 3), in the axes of the distribution."""

    mass: sp.Expr
    first: sp.ImmutableMatrix
    second: sp.ImmutableMatrix
    element: sp.Expr | None = None  # of a solid: the integrand for a density of one
    proofs: tuple[Proof, ...] = ()

    @property
    def expressions(self) -> tuple[sp.Expr, ...]:
        return (self.mass, *self.first, *self.second)


@singledispatch
def moments_of(distribution: Distribution) -> Moments:
    """The moments of a distribution. Raises BodyError if it has none."""
    raise BodyError(f"{type(distribution).__name__} is not a distribution of mass")


@moments_of.register
def _(given: Particles) -> Moments:
    """Sums over the particles."""
    field = Rationals.of(e for p in given.particles for e in (p.mass, *p.position))
    masses = [field.read(p.mass) for p in given.particles]
    places = [[field.read(e) for e in p.position] for p in given.particles]
    pairs = list(zip(masses, places, strict=True))
    return _presented(
        field,
        field.total(masses),
        [field.total([m * x[i] for m, x in pairs]) for i in range(3)],
        [field.total([m * x[i] * x[j] for m, x in pairs]) for i, j in _PAIRS],
    )


@moments_of.register
def _(given: Known) -> Moments:
    """What gives the known inertia tensor back: J = ½ tr(I) 1 − I about the centre."""
    half = given.inertia.trace() / 2
    about_centre = sp.eye(3) * half - given.inertia
    second = about_centre + given.mass * given.centre * given.centre.T
    return Moments(
        mass=given.mass,
        first=sp.ImmutableMatrix(given.mass * given.centre),
        second=sp.ImmutableMatrix(second),
    )


@moments_of.register
def _(given: Composite) -> Moments:
    """The parts, each turned, moved and added; a hole is taken away."""
    found: list[Moments] = []
    for place, part in enumerate(given.parts):
        try:
            found.append(moments_of(part.what))
        except BodyError as error:
            raise BodyError(str(error), place=("parts", place, *error.place)) from error
    held = [e for m in found for e in m.expressions]
    held += [e for part in given.parts for e in (*part.at, *part.turned)]
    field = Rationals.of(held)
    masses, firsts, seconds = [], [], []
    for part, m in zip(given.parts, found, strict=True):
        sign = -1 if part.hole else 1
        mass, at, turn = sign * m.mass, part.at, part.turned
        moved = turn * m.first
        cross = moved * at.T
        whole = sign * (turn * m.second * turn.T + cross + cross.T) + mass * at * at.T
        masses.append(field.read(mass))
        firsts.append([field.read(entry) for entry in sign * moved + mass * at])
        seconds.append(field.read_matrix(whole))
    return _presented(
        field,
        field.total(masses),
        [field.total([first[i] for first in firsts]) for i in range(3)],
        [field.total([second[i][j] for second in seconds]) for i, j in _PAIRS],
        proofs=tuple(dict.fromkeys(proof for m in found for proof in m.proofs)),
    )


def about_centre(part: Part) -> tuple[sp.Expr, sp.Matrix, sp.Matrix]:
    """Mass, centre (in the axes of the whole) and tensor about it (in its own); less for a hole."""
    m, sign = moments_of(part.what), -1 if part.hole else 1
    centre = m.first / m.mass
    second = m.second - m.mass * centre * centre.T
    own = second.trace() * sp.eye(3) - second
    return sign * m.mass, part.turned * centre + part.at, sign * own


@moments_of.register
@lru_cache(maxsize=64)
def _(solid: Solid) -> Moments:
    """Integrals over the coordinates, innermost the last one."""
    # the density as a function of the coordinates: the position is put in for x, y and z
    axes = dict(zip(sp.symbols("x y z"), solid.place, strict=True))
    axes = {s: e for s, e in axes.items() if s not in solid.coordinates}
    density = sp.S.One if solid.density is None else solid.density.xreplace(axes)
    held = [*solid.place, density, solid.element or sp.S.One]
    held += [] if solid.mass is None else [solid.mass]
    codec = integration_codec(held, solid.coordinates, solid.bounds)
    work = _Integrals(codec, solid)
    measure, proofs = work.measure()
    if not measure:
        raise BodyError(f"{solid.title}: its points are in a plane, on a line, or all the same")
    constant, varying = work.split(measure)
    weight = codec.ring.dot([(varying, codec.encode(density))])
    place = [codec.encode(entry) for entry in solid.place]
    products = [codec.ring.dot([(place[i], place[j])]) for i, j in _PAIRS]
    weighted = (codec.ring.dot([(weight, each)]) for each in (*place, *products))
    integrals = [work.integral(weight), *map(work.integral, weighted)]
    if not integrals[0]:
        raise BodyError("the solid has no volume, area or length")
    uniform = Quotient.whole(codec.ring, constant)
    if solid.mass is not None:
        uniform = Quotient(codec.ring, codec.encode(solid.mass), integrals[0])
    mass, *others = (Quotient.whole(codec.ring, integral) * uniform for integral in integrals)
    return _presented(
        Rationals(codec),
        mass,
        others[:3],
        others[3:],
        element=presenter_for(codec).element(measure),
        proofs=(*proofs, work.antiderivatives()),
    )


class _Integrals:
    """The integrals of one solid, with the proof of each antiderivative."""

    def __init__(self, codec: Codec, solid: Solid) -> None:
        self.codec, self.ring, self.solid = codec, codec.ring, solid
        self.prove = Prover(Conditions(solid.title), codec)
        self._each = [Integrator(codec, variable) for variable in solid.coordinates]
        self._left: list[PolyElement] = []  # ∂F/∂u − f of every integral

    def integral(self, element: PolyElement) -> PolyElement:
        """Over all coordinates."""
        pairs = list(zip(self._each, self.solid.bounds, strict=True))
        for integrator, bounds in reversed(pairs):
            antiderivative = integrator.antiderivative(element)
            self._left.append(integrator.derivative(antiderivative) - element)
            element = integrator.between(antiderivative, bounds)
        return element

    def antiderivatives(self) -> Proof:
        """That every integrand was the derivative of what was put at the bounds."""
        return self.prove.vanishes(RingMatrix.column(self.ring, self._left), _ANTIDERIVATIVES)

    def measure(self) -> tuple[PolyElement, tuple[Proof, ...]]:
        """The length, area or volume that belongs to a unit of the coordinates."""
        place = [self.codec.encode(entry) for entry in self.solid.place]
        columns = [[each.derivative(x) for x in place] for each in self._each]
        tangents = RingMatrix.of(self.ring, columns)
        if len(columns) == 3:
            determinant = tangents.det()
            return determinant * self._sign(determinant), ()
        given = self.solid.element
        element = self.codec.encode(given)
        residual = self.ring.reduce(element**2) - (tangents @ tangents.T).det()
        if residual:
            raise BodyError(
                f"{self.solid.title}: the element {given} does not belong to the map; its "
                f"square differs by {self.codec.decode(self.ring.reduce(residual))}"
            )
        if self._sign(element) < 0:
            raise BodyError(f"{self.solid.title}: the element {given} is negative; change its sign")
        bounds = dict(zip(self.solid.coordinates, self.solid.bounds, strict=True))
        squared = RingMatrix.column(self.ring, [residual])
        return element, (self.prove.is_root(squared, given, bounds, _ELEMENT),)

    def split(self, measure: PolyElement) -> tuple[PolyElement, PolyElement]:
        """The measure as a constant times an integrand, one of which is 1."""
        names = set(self.solid.coordinates)
        moving = [
            k for k, g in enumerate(self.ring.generators) if g.expression.free_symbols & names
        ]
        if any(monomial[place] for monomial in measure for place in moving):
            return self.ring.one, measure
        return measure, self.ring.one

    def _sign(self, determinant: PolyElement) -> int:
        """Of a determinant or an element, at points within the bounds; the map may not fold over.

        With constants that have no value it is looked at in three places alone, since not every
        choice of values need be one that the solid can have.
        """
        expression = self.codec.decode(determinant)
        names = expression.free_symbols.union(
            *(b.free_symbols for p in self.solid.bounds for b in p)
        )
        free = sorted(names - set(self.solid.coordinates), key=str)
        point = {s: sp.Rational(7 + k, 5 + 3 * k) for k, s in enumerate(free)}
        count = len(self.solid.coordinates)
        sevenths = [(k,) * count for k in (3, 4, 5)] if free else product((1, 3, 6), repeat=count)
        signs = set()
        for shares in sevenths:
            inside = dict(point)  # a place within the bounds, the coordinates one after the other
            pairs = zip(self.solid.coordinates, self.solid.bounds, shares, strict=True)
            for coordinate, (low, high), k in pairs:
                below, above = low.xreplace(inside), high.xreplace(inside)
                inside[coordinate] = below + (above - below) * sp.Rational(k, 7)
            signs.add(sp.sign(expression.xreplace(inside).evalf()))
        signs.discard(sp.S.Zero)
        if len(signs) > 1:
            raise BodyError(f"{self.solid.title}: the map folds over: its determinant changes sign")
        return int(signs.pop()) if signs else 1


def _presented(
    field: Rationals,
    mass: Quotient,
    first: Sequence[Quotient],
    second: Sequence[Quotient],
    *,
    element: sp.Expr | None = None,
    proofs: tuple[Proof, ...] = (),
) -> Moments:
    entries = dict(zip(_PAIRS, map(field.write, second), strict=True))
    return Moments(
        mass=field.write(mass),
        first=sp.ImmutableMatrix([field.write(q) for q in first]),
        second=sp.ImmutableMatrix(3, 3, lambda i, j: entries[min(i, j), max(i, j)]),
        element=element,
        proofs=proofs,
    )
