"""The moments of a distribution of mass in one matrix, integrated or summed, and proved.

With X = (x, y, z, 1), the matrix ∫ X Xᵀ dm (4, 4) has the second moments J, the first moments and
the mass, all that the motion of a rigid body depends on. A part that is turned by R and moved by d,
X = G X′ with G = (R d; 0 1), contributes G (∫ X′ X′ᵀ dm) Gᵀ; a hole, the negative of it. The
inertia tensor is tr(J) 1 − J (lecture, section 2.2).
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache, singledispatch

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.integrate import Integrator, integration_codec
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.errors import BodyError
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Proof
from rigidsym.mechanics.prove import Conditions, Prover
from rigidsym.models.body import Composite, Distribution, Known, Part, Particles, Solid
from rigidsym.system.records import Record

_PAIRS = tuple((i, j) for i in range(4) for j in range(i, 4))
_ANTIDERIVATIVES = formula(r"\frac{\partial F}{\partial u} = f \text{ for every integral}")
_ELEMENT = formula(r"\frac{dA}{du\,dv} = \sqrt{\det\mathbf{J}^{\mathsf T}\mathbf{J}}")


class Moments(Record, kw_only=True):
    """∫ X Xᵀ dm (4, 4) with X = (x, y, z, 1), in the axes of the distribution."""

    matrix: sp.ImmutableMatrix
    element: sp.Expr | None = None  # of a solid: the integrand for a density of one
    proofs: tuple[Proof, ...] = ()

    @property
    def mass(self) -> sp.Expr:
        return self.matrix[3, 3]

    @property
    def first(self) -> sp.ImmutableMatrix:
        """∫ x dm, (3, 1)."""
        return self.matrix[:3, 3]

    @property
    def second(self) -> sp.ImmutableMatrix:
        """∫ x xᵀ dm, (3, 3)."""
        return self.matrix[:3, :3]

    def central(self) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
        """The centre c = S/M, (3, 1), and the tensor about it, tr(J) 1 − J of J − M c cᵀ."""
        codec = codec_for(self.matrix, order=None)
        read, written = codec.encode_quotient, presenter_for(codec).quotient
        # Steiner's theorem for second moments, J_c = J − M c cᵀ, and I = tr(J_c) 1 − J_c: the
        # diagonal of I is the sum of the two other diagonal entries, and elsewhere I is −J_c.
        mass, second = read(self.mass), self.second
        centre = [written(read(entry) * mass.inverse()) for entry in self.first]
        # Without the mass in its divisor, as S/M has it before it is cancelled: to find the mass of
        # a tetrahedron with twelve symbols in a moment of degree eight would take a minute.
        c = list(map(read, centre))

        def entry(i: int, j: int) -> sp.Expr:
            if i != j:
                return written(mass * c[i] * c[j] - read(second[i, j]))
            j, k = (i + 1) % 3, (i + 2) % 3
            return written(read(second[j, j] + second[k, k]) - mass * (c[j] * c[j] + c[k] * c[k]))

        return sp.ImmutableMatrix(centre), sp.ImmutableMatrix(3, 3, entry)


def _moments(
    codec: Codec,
    entries: Iterable[Quotient],
    element: sp.Expr | None = None,
    proofs: tuple[Proof, ...] = (),
) -> Moments:
    """From the entries on and above the diagonal."""
    upper = dict(zip(_PAIRS, map(presenter_for(codec).quotient, entries), strict=True))
    matrix = sp.ImmutableMatrix(4, 4, lambda i, j: upper[min(i, j), max(i, j)])
    return Moments(matrix=matrix, element=element, proofs=proofs)


@singledispatch
def moments_of(distribution: Distribution) -> Moments:
    """The moments of a distribution. Raises BodyError if it has none."""
    raise BodyError(f"{type(distribution).__name__} is not a distribution of mass")


@moments_of.register
def _(cloud: Particles) -> Moments:
    """Sums over the particles."""
    places = [(p.mass, (*p.position, sp.S.One)) for p in cloud.particles]
    sums = [sp.Add(*(mass * x[i] * x[j] for mass, x in places)) for i, j in _PAIRS]
    codec = codec_for(sums, order=None)
    return _moments(codec, map(codec.encode_quotient, sums))


@moments_of.register
def _(known: Known) -> Moments:
    """The moments that give the inertia tensor back: J = ½ tr(I) 1 − I about the centre."""
    place = sp.Matrix([*known.centre, 1])
    # I = tr(J) 1 − J has tr I = 2 tr J, so J = ½ tr(I) 1 − I.
    about_centre = sp.eye(3) * known.inertia.trace() / 2 - known.inertia
    matrix = sp.diag(about_centre, 0) + known.mass * place * place.T
    return Moments(matrix=sp.ImmutableMatrix(matrix))


@moments_of.register
def _(whole: Composite) -> Moments:
    """The parts, each turned, moved and added; a hole is taken away."""
    moments: list[Moments] = []
    for k, part in enumerate(whole.parts):
        try:
            moments.append(moments_of(part.what))
        except BodyError as error:
            raise BodyError(str(error), place=("parts", k, *error.place)) from error
    matrices = []
    for part, m in zip(whole.parts, moments, strict=True):
        # x = R x′ + d as one matrix in homogeneous coordinates, G = (R d; 0 1). The last row keeps
        # the mass.
        place = sp.Matrix(part.turned).row_join(part.at).col_join(sp.Matrix([[0, 0, 0, 1]]))
        matrices.append((-1 if part.hole else 1) * place * m.matrix * place.T)
    total = sum(matrices, sp.zeros(4, 4))
    codec = codec_for(total, order=None)
    return _moments(
        codec,
        (codec.encode_quotient(total[pair]) for pair in _PAIRS),
        proofs=tuple(dict.fromkeys(proof for m in moments for proof in m.proofs)),
    )


def about_centre(part: Part) -> tuple[sp.Expr, sp.Matrix, sp.Matrix]:
    """Mass, centre (in the axes of the whole) and tensor about it (in its own); less for a hole."""
    m, sign = moments_of(part.what), -1 if part.hole else 1
    centre, inertia = m.central()
    return sign * m.mass, part.turned * centre + part.at, sign * inertia


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
    ring, work = codec.ring, _Integrals(codec, solid)
    measure, proofs = work.measure()
    if not measure:
        raise BodyError(f"{solid.title}: its points are in a plane, on a line, or all the same")
    # A constant measure, the Jacobian determinant of an affine map, stays outside of the integrals.
    constant, varying = work.split(measure)
    weight = ring.dot([(varying, codec.encode(density))])
    place = [codec.encode(entry) for entry in (*solid.place, sp.S.One)]
    weighted = [ring.dot([(weight, entry)]) for entry in place]
    integrals = [work.integral(ring.dot([(weighted[i], place[j])])) for i, j in _PAIRS]
    if not integrals[-1]:
        raise BodyError("the solid has no volume, area or length")
    # With a given mass the density is M/∫ dV, and the constant part of the measure cancels.
    uniform = Quotient.whole(ring, constant)
    if solid.mass is not None:
        uniform = Quotient(ring, codec.encode(solid.mass), integrals[-1])
    return _moments(
        codec,
        (Quotient.whole(ring, integral) * uniform for integral in integrals),
        presenter_for(codec).element(measure),
        (*proofs, work.antiderivatives()),
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
        # Iterated integrals, ∫ du ∫ dv ∫ dw: the bounds of w may hold u and v.
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
        # dV = |det ∂x/∂(u, v, w)| du dv dw. In fewer dimensions the Gram determinant of the
        # tangents takes its place, dA = √(det JᵀJ) du dv, whose root is given with the solid and
        # proved by its square.
        if len(columns) == 3:
            determinant = tangents.det()
            return determinant * self._sign(determinant), ()
        element = self.codec.encode(self.solid.element)
        residual = self.ring.reduce(element**2) - (tangents @ tangents.T).det()
        bounds = dict(zip(self.solid.coordinates, self.solid.bounds, strict=True))
        squared = RingMatrix.column(self.ring, [residual])
        return element, (self.prove.is_root(squared, self.solid.element, bounds, _ELEMENT),)

    def split(self, measure: PolyElement) -> tuple[PolyElement, PolyElement]:
        """The measure as a constant times an integrand, one of which is 1."""
        own = {*self.solid.coordinates}
        moving = [k for k, g in enumerate(self.ring.generators) if g.expression.free_symbols & own]
        if any(monomial[place] for monomial in measure for place in moving):
            return self.ring.one, measure
        return measure, self.ring.one

    def _sign(self, determinant: PolyElement) -> int:
        """Of a determinant at a point within the bounds; it is the same everywhere."""
        expression = self.codec.decode(determinant)
        bounds = (bound for pair in self.solid.bounds for bound in pair)
        names = expression.free_symbols.union(*(bound.free_symbols for bound in bounds))
        point = {s: sp.Rational(7 + k, 5 + 3 * k) for k, s in enumerate(sorted(names, key=str))}
        # Each bound is evaluated at the coordinates before it.
        for coordinate, pair in zip(self.solid.coordinates, self.solid.bounds, strict=True):
            low, high = (bound.xreplace(point) for bound in pair)
            point[coordinate] = low + (high - low) * sp.Rational(3, 7)
        return -1 if expression.xreplace(point).evalf() < 0 else 1
