"""Mass, centre, inertia tensors, moments about lines, principal axes: the body by itself.

`moments` computes the sums over the mass; their consequences are proved over the ring of the
body's constants, and, for the tensor in space, over the ring of the rotation too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

import sympy as sp

from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import Rationals
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Found
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.mass.moments import Moments, about_centre, moments_of
from rigidsym.mechanics.mass.principal import Principal, principal_of
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import mass as claims
from rigidsym.mechanics.quantities.table import DIRECTION, POINT
from rigidsym.models.body import RigidBody
from rigidsym.models.distribution import Composite, Known, Part, Particles

_ONE = sp.eye(3)
WITHOUT: Mapping[str, str] = {  # why a body may not have a quantity
    "mass": "it is given, not added up",
    "centre_of_mass": "how its mass is distributed is not given",
    "principal_moments": "no closed form was found, which a general tensor has not",
    "principal_axes": "no closed form was found, or none that is short enough for use",
    "inertia_ellipsoid": "no principal moments were found, or one of them is 0",
}


def steps(values: Values, wanted: Sequence[str]) -> Iterator[tuple[str, Found]]:
    """(name, what was found) of the quantities that are wanted and that the body has."""
    assert values.body is not None
    work = _Inertia(values.body, values)
    for name in wanted:
        found = getattr(work, name)()
        if found is not None:
            yield name, found


class _Inertia:
    """The steps of one body; each is worked out by its own method."""

    def __init__(self, body: RigidBody, values: Values) -> None:
        self.body, self.values = body, values
        self.point, self.direction = sp.Matrix(POINT), sp.Matrix(DIRECTION)

    @cached_property
    def moments(self) -> Moments:
        """The moments of the distribution, or equivalent ones if only the tensor is given."""
        body = self.body
        known = Known(mass=body.mass, centre=body.centre, inertia=body.inertia)
        return moments_of(body.distribution or known)

    def _over_mass(self, integral: Formula) -> Formula:
        """An integral over the mass, which is a sum if the body consists of particles."""
        is_sum = isinstance(self.body.distribution, Particles)
        return claims.summed(integral) if is_sum else integral

    @cached_property
    def principal(self) -> Principal | None:
        return principal_of(self.body.inertia)

    def mass(self) -> Found | None:
        if self.body.distribution is None or self.body.mass.is_Symbol:
            return None
        return Found(
            _scalar(self.body.mass),
            "The total mass is the sum over all parts of the body.",
            self.moments.proofs,
            definition=self._over_mass(claims.TOTAL_MASS),
        )

    def centre_of_mass(self) -> Found | None:
        if self.body.distribution is None:
            return None
        rest = self.moments.first - self.body.mass * self.body.centre
        proofs = () if not self.body.mass.is_Symbol else self.moments.proofs
        return Found(
            self.body.centre,
            "The centre of mass is the mean position, weighted with the mass.",
            (*proofs, identity(rest, self._over_mass(claims.CENTRED), self.body.name)),
            definition=self._over_mass(claims.MASS_FIRST),
        )

    def inertia_tensor(self) -> Found:
        body, moments = self.body, self.moments
        proofs = [identity(body.inertia - body.inertia.T, claims.SYMMETRIC, body.name)]
        if body.distribution is None:
            because = "The inertia tensor of the body is given, about its centre of mass."
            return Found(body.inertia, because, tuple(proofs))
        about_origin = moments.second.trace() * _ONE - moments.second
        rest = about_origin - body.inertia - _moved(body.mass, body.centre)
        proofs.append(identity(rest, claims.ABOUT_ORIGIN, body.name))
        because = "The inertia tensor is taken about the centre of mass."
        if isinstance(body.distribution, Composite):
            rest = self._of_parts(body.distribution.parts) - body.inertia
            conditions = body.distribution.conditions
            proofs.append(identity(rest, claims.OF_PARTS, body.name, conditions))
            because = (
                "The tensors of the parts are turned, moved to the common centre of mass by the "
                "theorem of parallel axes, and added."
            )
        integral = self._over_mass(claims.TENSOR_INTEGRAL)
        return Found(body.inertia, because, tuple(proofs), definition=integral)

    def _of_parts(self, parts: Sequence[Part]) -> sp.Matrix:
        """Σ (R I R ᵀ + m (|d|² 1 − d dᵀ)), a hole with a minus sign."""
        total = sp.zeros(3)
        for part in parts:
            mass, centre, own = about_centre(part)
            total += part.turned * own * part.turned.T + _moved(mass, centre - self.body.centre)
        return total

    def inertia_tensor_point(self) -> Found:
        body, second, d = self.body, self._second_about_point, self.point - self.body.centre
        about_point = second.trace() * _ONE - second  # ∫ (|x − p|² 1 − (x − p)(x − p)ᵀ) dm
        rest = about_point - body.inertia - _moved(body.mass, d)

        def shifted(i: int, j: int) -> sp.Expr:
            """An entry of I′ + M (|d|² 1 − d dᵀ), as short as it can be written."""
            if i != j:
                return body.inertia[i, j] - body.mass * d[i] * d[j]
            return body.inertia[i, i] + body.mass * sum(d[k] ** 2 for k in range(3) if k != i)

        return Found(
            sp.ImmutableMatrix(3, 3, shifted),
            "By the parallel-axis (Steiner) theorem, the mass is added as if concentrated in the "
            "centre of mass.",
            (identity(rest, self._over_mass(claims.OF_POINT), body.name),),
        )

    @property
    def _second_about_point(self) -> sp.Matrix:
        """∫ (x − p)(x − p)ᵀ dm."""
        m, p = self.moments, self.point
        return m.second - m.first * p.T - p * m.first.T + m.mass * p * p.T

    def moment_of_inertia(self) -> Found:
        n, body, second = self.direction, self.body, self._second_about_point
        squares: dict[sp.Expr, sp.Expr] = {}  # by entry, since equal ones have a factor in common
        for k, entry in enumerate(body.inertia.diagonal()):
            squares[entry] = squares.get(entry, sp.S.Zero) + n[k] ** 2
        about_centre = sp.Add(
            *(entry * square for entry, square in squares.items()),
            *(2 * body.inertia[i, j] * n[i] * n[j] for i in range(3) for j in range(i + 1, 3)),
        )
        crossed = n.cross(self.point - body.centre)
        moment = about_centre + body.mass * crossed.dot(crossed)
        # ∫ |n × (x − p)|² dm, where |n × y|² = n·n y·y − (n·y)²
        from_moments = n.dot(n) * second.trace() - (n.T * second * n)[0]
        return Found(
            _scalar(moment),
            "The moment about a line is the quadratic form of the tensor about a point p of it. "
            "The direction n is a unit vector, and |n × (x′ − p)| is the distance from the line.",
            (identity(_scalar(from_moments - moment), self._over_mass(claims.OF_LINE), body.name),),
        )

    def radii_of_gyration(self) -> Found:
        body = self.body
        moments = sp.Matrix(body.inertia.diagonal()).reshape(3, 1)
        field = Rationals([*moments, body.mass])
        inverse = field.read(body.mass).inverse()
        squares = [field.write(field.read(moment) * inverse) for moment in moments]
        radii = sp.ImmutableMatrix([self._root(square) for square in squares])
        rest = sp.Matrix([body.mass * radius**2 for radius in radii]) - moments
        return Found(
            radii,
            "The radius of gyration of an axis is the square root of its moment over the mass.",
            (identity(rest, claims.OF_RADII, body.name),),
        )

    def _root(self, square: sp.Expr) -> sp.Expr:
        """The square root, in which √(a²) is a for a parameter that is positive."""
        positive = {
            p.symbol: sp.Symbol(p.symbol.name, positive=True)
            for p in self.body.parameters
            if p.positive
        }
        back = {new: old for old, new in positive.items()}
        return sp.sqrt(square.xreplace(positive)).xreplace(back)

    def principal_moments(self) -> Found | None:
        found = self.principal
        if found is None:
            return None
        name, inertia = self.body.name, self.body.inertia
        proofs = []
        if found.axes is None:
            values = [_volume(inertia - moment * _ONE) for moment in found.moments]
            proofs.append(identity(sp.Matrix(values), claims.CHARACTERISTIC, name))
        return Found(found.moments, found.because, tuple(proofs))

    def principal_axes(self) -> Found | None:
        found = self.principal
        if found is None or found.axes is None:
            return None
        axes, name = found.axes, self.body.name
        turned = self.body.inertia * axes - axes * sp.diag(*found.moments)
        unit = axes.T * axes - _ONE
        whole = unit.col_join(sp.Matrix([[_volume(axes) - 1, 0, 0]]))
        return Found(
            axes,
            "The principal axes are the eigenvectors of I′.",
            (
                identity(turned, claims.DIAGONAL, name),
                identity(whole, claims.ORTHOGONAL_AXES, name),
            ),
        )

    def inertia_ellipsoid(self) -> Found | None:
        found = self.principal
        if found is None or any(moment == 0 for moment in found.moments):
            return None
        semi_axes = found.moments.applyfunc(lambda moment: 1 / self._root(moment))
        rest = sp.Matrix(
            [a**2 * moment - 1 for a, moment in zip(semi_axes, found.moments, strict=True)]
        )
        return Found(
            sp.ImmutableMatrix(semi_axes),
            "The inertia ellipsoid consists of all points x′ with x′·I′ x′ = 1.",
            (identity(rest, claims.ELLIPSOID, self.body.name),),
        )

    def inertia_tensor_space(self) -> Found:
        values = self.values
        body = values.codec.matrix(self.body.inertia)
        ring, R = values.codec.ring, values.turning.R
        space = R @ (body @ R.T)
        rest = sum((space[k, k] - body[k, k] for k in range(3)), ring.zero)
        trace = RingMatrix.column(ring, [rest])
        prove = values.prove
        return Found(
            values.present.matrix(space),
            "A tensor is rotated from both sides.",
            (
                prove.vanishes(R.T @ (space @ R) - body, claims.BACK),
                prove.vanishes(trace, claims.TRACE),
            ),
        )


def _moved(mass: sp.Expr, by: sp.MatrixBase) -> sp.Matrix:
    """M (|d|² 1 − d dᵀ)."""
    return mass * (by.dot(by) * _ONE - by * by.T)


def _volume(columns: sp.MatrixBase) -> sp.Expr:
    """The determinant of a matrix (3, 3), as it comes; SymPy's own would search for zeros in it."""
    first, second, third = (columns[:, k] for k in range(3))
    return first.dot(second.cross(third))


def _scalar(value: sp.Expr) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([[value]])
