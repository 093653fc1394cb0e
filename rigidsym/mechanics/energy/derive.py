"""Kinetic energy and angular momentum of a body whose orientation a rotation model describes.

One algorithm serves every rotation and every body, in the ring of both (lecture, eq. 2 and 8 to
14). Only the mass and the inertia tensor of the body are used; sums over its particles follow from
them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.squares import half_form, half_of_squares
from rigidsym.mechanics import particles
from rigidsym.mechanics.derivation import Found
from rigidsym.mechanics.energy import momentum_forms
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities import energy as claims

OF_PARTICLES = particles.SYMBOLS  # that the ring of energies has to hold


def steps(values: Values, wanted: Sequence[str]) -> Iterator[tuple[str, Found]]:
    """(name, what was found) of the energies and momenta that are wanted."""
    work = _Energy(values)
    yield from ((name, getattr(work, name)()) for name in wanted)


class _Energy:
    """The steps of one body in one rotation; each is worked out by its own method."""

    def __init__(self, values: Values) -> None:
        assert values.body is not None
        self.body, self.codec = values.body, values.codec
        self.ring, self.turning = values.codec.ring, values.turning
        self.present, self.prove = values.present, values.prove
        self.inertia = values.codec.matrix(self.body.inertia)
        self.mass = self.codec.encode(self.body.mass)
        self.centre = values.argument("centre")
        self.velocity = values.argument("centre_dot")

    # Particles: x = R x′ for a place x′ at rest in the body, r = r_C + x.

    @cached_property
    def _sum(self) -> particles.ParticleSums:
        return particles.sums_of_body(self.codec, self.body.mass, self.body.inertia)

    @cached_property
    def _particle(self) -> tuple[RingMatrix, RingMatrix]:
        """x and ẋ of the generic particle."""
        place = self.codec.column(particles.IN_BODY)
        return self.turning.R @ place, self.turning.R_dot @ place

    def _of_particles(self, summand: RingMatrix) -> RingMatrix:
        """Σ m of a summand."""
        return self._sum.of_matrix(summand.scale(self.codec.encode(particles.MASS)))

    def translational_energy(self) -> Found:
        twice = self.ring.dot([(self.mass, self._square(self.velocity))])
        summed = self._of_particles(self._scalar(self._square(self.velocity)))
        residual = summed - self._scalar(twice)
        return Found(
            sp.ImmutableMatrix([[self._translational]]),
            "The centre of mass has the kinetic energy of a particle with the mass of the body.",
            (self.prove.vanishes(residual, claims.TRANSLATION_OF_PARTICLES),),
        )

    def rotational_energy(self) -> Found:
        turning = self.turning
        turned = turning.R.T @ turning.omega_space  # for Ωᵀ (R I′ Rᵀ) Ω, from the outside inwards
        in_space = turned.T @ self.inertia @ turned
        _, velocity = self._particle
        summed = self._of_particles(self._scalar(self._square(velocity)))
        proofs = (
            self.prove.vanishes(in_space - self._scalar(self._twice), claims.BOTH_FORMS),
            self.prove.vanishes(summed - self._scalar(self._twice), claims.ROTATION_OF_PARTICLES),
        )
        return Found(
            sp.ImmutableMatrix([[self._rotational]]),
            "The energy of the rotation is a quadratic form in the angular velocity.",
            proofs,
        )

    def kinetic_energy(self) -> Found:
        twice = self._twice + self.ring.dot([(self.mass, self._square(self.velocity))])
        whole = self.velocity + self._particle[1]
        summed = self._of_particles(self._scalar(self._square(whole)))
        return Found(
            sp.ImmutableMatrix([[self._translational + self._rotational]]),
            "The energy splits, since the velocities relative to the centre of mass, weighted "
            "with the masses, sum to zero.",
            (self.prove.vanishes(summed - self._scalar(twice), claims.ENERGY_SPLITS),),
        )

    def angular_momentum_centre(self) -> Found:
        momentum = self.centre.cross(self.velocity).scale(self.mass)
        summed = self._of_particles(self.centre.cross(self.velocity))
        return Found(
            self.present.matrix(momentum),
            "The centre of mass has the angular momentum of a particle with the mass of the body.",
            (self.prove.vanishes(summed - momentum, claims.MOMENTUM_OF_CENTRE),),
        )

    def angular_momentum_rotation_body(self) -> Found:
        turning = self.turning
        momentum = self.inertia @ turning.omega_body
        dotted = momentum.T @ turning.omega_body - self._scalar(self._twice)
        return Found(
            momentum_forms.in_body(self.present, self.inertia, turning),
            "The inertia tensor takes the angular velocity to the angular momentum.",
            (self.prove.vanishes(dotted, claims.TWICE_ENERGY_BODY),),
        )

    def angular_momentum_rotation(self) -> Found:
        turning = self.turning
        momentum = self._momentum
        turned = turning.R @ (self.inertia @ (turning.R.T @ turning.omega_space))
        dotted = momentum.T @ turning.omega_space - self._scalar(self._twice)
        summed = self._of_particles(self._particle[0].cross(self._particle[1]))
        return Found(
            momentum_forms.in_space(self.present, self.inertia, turning),
            "Rotating gives the components along the axes of space.",
            (
                self.prove.vanishes(turned - momentum, claims.MOMENTUM_TURNS),
                self.prove.vanishes(dotted, claims.TWICE_ENERGY),
                self.prove.vanishes(summed - momentum, claims.MOMENTUM_OF_PARTICLES),
            ),
        )

    def angular_momentum(self) -> Found:
        of_centre = self.centre.cross(self.velocity).scale(self.mass)
        place, velocity = self._particle
        whole = (self.centre + place).cross(self.velocity + velocity)
        residual = self._of_particles(whole) - of_centre - self._momentum
        rotation = momentum_forms.in_space(self.present, self.inertia, self.turning)
        return Found(
            sp.ImmutableMatrix(self.present.matrix(of_centre) + rotation),
            "Like the energy, the angular momentum is the sum of two parts.",
            (self.prove.vanishes(residual, claims.MOMENTUM_SPLITS),),
        )

    @cached_property
    def _momentum(self) -> RingMatrix:
        """L_R in space components, over the ring."""
        return self.turning.R @ (self.inertia @ self.turning.omega_body)

    @cached_property
    def _twice(self) -> PolyElement:
        """2 E_R, over the ring."""
        omega = self.turning.omega_body
        return (omega.T @ (self.inertia @ omega))[0, 0]

    @cached_property
    def _rotational(self) -> sp.Expr:
        return half_form(self.present, self.inertia, self.turning.omega_body)

    @cached_property
    def _translational(self) -> sp.Expr:
        return half_of_squares(self.present, self.mass, self.velocity.entries)

    def _square(self, vector: RingMatrix) -> PolyElement:
        return (vector.T @ vector)[0, 0]

    def _scalar(self, element: PolyElement) -> RingMatrix:
        return RingMatrix.column(self.ring, [element])
