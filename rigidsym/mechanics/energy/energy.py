"""Kinetic energy and angular momentum of a body that turns as a rotation model says.

One algorithm for every rotation and every body, in the ring of both (lecture, eq. 2 and 8 to 14).
The body is known by its mass and its inertia tensor alone; the sums over its particles that the
energies are follow from these two.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.matrix import RingMatrix, cross
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.squares import half_form, half_of_squares
from rigidsym.errors import QuantityError
from rigidsym.mechanics import particles
from rigidsym.mechanics.arguments import arguments_of
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.energy import energy_claims as claims, momentum_forms
from rigidsym.mechanics.kinematics import derive as kinematics
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.mass import inertia
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.mechanics.mass.inertia import Found
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import QUANTITY_NAMES
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.body import BodyDescription, RigidBody
from rigidsym.models.distribution import Distribution
from rigidsym.models.rotation import RotationModel

BODY_QUANTITIES = MappingProxyType({**INERTIA_QUANTITIES, **ENERGY_QUANTITIES})


def derive(
    model: RotationModel,
    body: RigidBody | BodyDescription | Distribution,
    only: Collection[str] = (),
) -> Derivation:
    """The kinematics of a rotation model, then the energies and momenta of a body that turns so.

    The moments of a description are integrated first; BodyError if that fails.

    `only` names the quantities to derive; all there are where it is empty. Raises what
    `kinematics.derive` raises, ModelError where a name stands for two things, and QuantityError
    for quantities that the body has not.
    """
    known = (*QUANTITY_NAMES, *BODY_QUANTITIES)
    unknown = ", ".join(name for name in only if name not in known)
    if unknown:
        raise QuantityError(f"no quantity {unknown}; there are {', '.join(known)}")
    body = rigid_body(body)
    arguments = arguments_of(model, body)
    turning = [name for name in only if name in QUANTITY_NAMES]
    motion = kinematics.derive(model, turning or ("rotation_matrix",) if only else ())
    steps = motion.steps if turning or not only else ()
    found = tuple(_numbered(Values(model, body), only, first=len(steps) + 1))
    _raise_if_absent(body, only, {step.quantity.name for step in found})
    return replace(motion, arguments=arguments, body=body, steps=(*steps, *found))


def _raise_if_absent(body: RigidBody, only: Collection[str], found: Collection[str]) -> None:
    absent = [name for name in BODY_QUANTITIES if name in only and name not in found]
    if absent:
        reasons = (f"no quantity {name}: {inertia.WITHOUT[name]}" for name in absent)
        raise QuantityError(f"{body.name} has {'; '.join(reasons)}")


def _numbered(values: Values, only: Collection[str], *, first: int) -> Iterator[Step]:
    """The steps of the body by itself, and of its energy and momentum."""
    wanted = [name for name in BODY_QUANTITIES if not only or name in only]
    parameters = values.arguments.get("parameters")
    constants = set(parameters.symbols) if parameters else set()
    for number, (name, found) in enumerate(_found(values, wanted), start=first):
        quantity = BODY_QUANTITIES[name]
        if not constants.isdisjoint(found.expression.free_symbols):
            quantity = replace(quantity, inputs=(*quantity.inputs, "parameters"))
        if found.definition is not None:
            quantity = replace(quantity, definition=found.definition)
        yield Step(
            number=number,
            quantity=quantity,
            expression=found.expression,
            because=found.because,
            proofs=found.proofs,
        )


def _found(values: Values, wanted: Sequence[str]) -> Iterator[tuple[str, Found]]:
    yield from inertia.steps_of(values, [name for name in wanted if name in INERTIA_QUANTITIES])
    work = _Energy(values)
    yield from ((name, _STEPS[name](work)) for name in wanted if name in ENERGY_QUANTITIES)


class _Energy:
    """The steps of one body in one rotation; each is worked out by its own method."""

    def __init__(self, values: Values) -> None:
        assert values.body is not None
        self.values, self.body, self.codec = values, values.body, values.codec
        self.ring = values.ring
        self.present = presenter_for(values.codec)
        self.prove = Prover(values.model, values.codec)
        self.inertia = values.encoded(self.body.inertia)
        self.mass = self.codec.encode(self.body.mass)
        self.centre = values.argument("centre")
        self.velocity = values.argument("centre_dot")

    # Particles: x = R x′ for a place x′ at rest in the body, r = r_C + x.

    @cached_property
    def _sum(self) -> particles.Sum:
        return particles.sums_of_body(self.codec, self.body.mass, self.body.inertia)

    @cached_property
    def _particle(self) -> tuple[RingMatrix, RingMatrix]:
        """x and ẋ of the generic particle."""
        place = particles.vector(self.codec, particles.IN_BODY)
        return self.values.R @ place, self.values.R_dot @ place

    def _of_particles(self, summand: RingMatrix) -> RingMatrix:
        """Σ m of a summand."""
        return self._sum.of_matrix(summand.scale(self.codec.encode(particles.MASS)))

    @property
    def _has_particles(self) -> bool:
        """For many turns R x′ is not multiplied out; the proofs in Ω′ are as exact."""
        return not self.values.factors

    def translational_energy(self) -> Found:
        twice = self.ring.dot([(self.mass, self._square(self.velocity))])
        summed = self._of_particles(self._scalar(self._square(self.velocity)))
        residual = summed - self._scalar(twice)
        return Found(
            sp.ImmutableMatrix([[self._translational]]),
            "All the mass moves with the centre of mass.",
            (self.prove.vanishes(residual, claims.translation_of_particles()),),
        )

    def rotational_energy(self) -> Found:
        values = self.values
        turned = values.R.T @ values.omega_space  # for Ωᵀ (R I′ Rᵀ) Ω, from the outside inwards
        in_space = turned.T @ self.inertia @ turned
        proofs = [self.prove.vanishes(in_space - self._scalar(self._twice), claims.both_forms())]
        if self._has_particles:
            _, velocity = self._particle
            summed = self._of_particles(self._scalar(self._square(velocity)))
            residual = summed - self._scalar(self._twice)
            proofs.append(self.prove.vanishes(residual, claims.rotation_of_particles()))
        return Found(
            sp.ImmutableMatrix([[self._rotational]]),
            "The energy of the rotation is a quadratic form in the angular velocity.",
            tuple(proofs),
        )

    def kinetic_energy(self) -> Found:
        twice = self._twice + self.ring.dot([(self.mass, self._square(self.velocity))])
        proofs = []
        if self._has_particles:
            whole = self.velocity + self._particle[1]
            summed = self._of_particles(self._scalar(self._square(whole)))
            residual = summed - self._scalar(twice)
            proofs.append(self.prove.vanishes(residual, claims.energy_splits()))
        else:
            proofs.append(self.prove.vanishes(self._cross_term(), claims.no_cross_term()))
        return Found(
            sp.ImmutableMatrix([[self._translational + self._rotational]]),
            "The energy splits, since the velocities relative to the centre of mass add up to "
            "nothing.",
            tuple(proofs),
        )

    def _cross_term(self) -> RingMatrix:
        """Σ m Ω′ × x′, which is Σ m ẋ along the axes of the body."""
        place = particles.vector(self.codec, particles.IN_BODY)
        return self._of_particles(self._crossed(self.values.argument("omega_body"), place))

    def angular_momentum_centre(self) -> Found:
        momentum = self._crossed(self.centre, self.velocity).scale(self.mass)
        summed = self._of_particles(self._crossed(self.centre, self.velocity))
        return Found(
            self.present.matrix(momentum),
            "It is that of the whole mass in the centre of mass.",
            (self.prove.vanishes(summed - momentum, claims.momentum_of_centre()),),
        )

    def angular_momentum_rotation_body(self) -> Found:
        values = self.values
        momentum = self.inertia @ values.omega_body
        dotted = momentum.T @ values.omega_body - self._scalar(self._twice)
        return Found(
            momentum_forms.in_body(self.present, self.inertia, values),
            "The inertia tensor takes the angular velocity to the angular momentum.",
            (self.prove.vanishes(dotted, claims.twice_energy_body()),),
        )

    def angular_momentum_rotation(self) -> Found:
        values = self.values
        momentum = self._momentum
        turned = values.R @ (self.inertia @ (values.R.T @ values.omega_space))
        dotted = momentum.T @ values.omega_space - self._scalar(self._twice)
        proofs = [
            self.prove.vanishes(turned - momentum, claims.momentum_turns()),
            self.prove.vanishes(dotted, claims.twice_energy()),
        ]
        if self._has_particles:
            summed = self._of_particles(self._crossed(*self._particle))
            proofs.append(self.prove.vanishes(summed - momentum, claims.momentum_of_particles()))
        return Found(
            momentum_forms.in_space(self.present, self.inertia, values),
            "The components along the axes of space follow by the rotation.",
            tuple(proofs),
        )

    def angular_momentum(self) -> Found:
        of_centre = self._crossed(self.centre, self.velocity).scale(self.mass)
        if self._has_particles:
            place, velocity = self._particle
            whole = self._crossed(self.centre + place, self.velocity + velocity)
            residual = self._of_particles(whole) - of_centre - self._momentum
            proof = self.prove.vanishes(residual, claims.momentum_splits())
        else:
            proof = self.prove.vanishes(self._cross_term(), claims.no_cross_term())
        rotation = momentum_forms.in_space(self.present, self.inertia, self.values)
        return Found(
            sp.ImmutableMatrix(self.present.matrix(of_centre) + rotation),
            "The momentum splits as the energy does.",
            (proof,),
        )

    @cached_property
    def _momentum(self) -> RingMatrix:
        """L_R in space components, over the ring."""
        return self.values.R @ (self.inertia @ self.values.omega_body)

    @cached_property
    def _twice(self) -> PolyElement:
        """2 E_R, over the ring."""
        omega = self.values.omega_body
        return (omega.T @ (self.inertia @ omega))[0, 0]

    @cached_property
    def _rotational(self) -> sp.Expr:
        return half_form(self.present, self.inertia, self.values.omega_body)

    @cached_property
    def _translational(self) -> sp.Expr:
        return half_of_squares(self.present, self.mass, self.velocity.entries)

    def _square(self, vector: RingMatrix) -> PolyElement:
        return (vector.T @ vector)[0, 0]

    def _scalar(self, element: PolyElement) -> RingMatrix:
        return self.values.column([element])

    def _crossed(self, first: RingMatrix, second: RingMatrix) -> RingMatrix:
        return self.values.column(cross(self.ring, first.entries, second.entries))


_STEPS: Mapping[str, Callable[[_Energy], Found]] = MappingProxyType(
    {
        "translational_energy": _Energy.translational_energy,
        "rotational_energy": _Energy.rotational_energy,
        "kinetic_energy": _Energy.kinetic_energy,
        "angular_momentum_centre": _Energy.angular_momentum_centre,
        "angular_momentum_rotation_body": _Energy.angular_momentum_rotation_body,
        "angular_momentum_rotation": _Energy.angular_momentum_rotation,
        "angular_momentum": _Energy.angular_momentum,
    }
)
