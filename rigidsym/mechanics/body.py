"""A body whose orientation a rotation model describes: its mass, inertia, energy and momentum.

The workspace of the entries in `quantities.mass` and `quantities.energy`. Of the body only the mass
and the inertia tensor are used; sums over its particles follow from them (`mechanics.particles`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cache, cached_property, partial

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, hat, square
from rigidsym.algebra.present import agrees, half_form, half_of_squares, presenter_for, shortest_of
from rigidsym.errors import QuantityError
from rigidsym.formula.tree import Formula, with_names
from rigidsym.mechanics import particles
from rigidsym.mechanics.derivation import Step, sentence_of
from rigidsym.mechanics.dynamics.flow import Flow
from rigidsym.mechanics.dynamics.lagrange import equations_of_motion
from rigidsym.mechanics.kinematics.chain import Chain
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.mass.moments import Moments, about_centre, moments_of
from rigidsym.mechanics.mass.principal import Principal, principal_of
from rigidsym.mechanics.prove import Prover
from rigidsym.mechanics.quantities import OF_BODY
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.mass import AT_REST, BODY_ALONE
from rigidsym.mechanics.quantities.table import DIRECTION, POINT, own_letters
from rigidsym.models.body import Composite, Known, Particles, RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.parametrisations import parametrised
from rigidsym.models.rotation import RotationModel

_MOST_TERMS = 60  # of a component that is worth being presented multiplied out


class BodyValues(Values):
    """A body in one rotation, over the ring of both."""

    point, direction = sp.Matrix(POINT), sp.Matrix(DIRECTION)

    def __init__(self, model: RotationModel, body: RigidBody, *, has_fixed_point: bool) -> None:
        super().__init__(model, body, also=particles.SYMBOLS)
        self.body: RigidBody = body
        self.has_fixed_point = has_fixed_point
        self.point = self.point if body.fixed_point is None else sp.Matrix(body.fixed_point)

    @cached_property
    def traits(self) -> frozenset[str]:
        traits = {
            "distributed": self.is_distributed,
            "particles": isinstance(self.body.distribution, Particles),
            "composite": isinstance(self.body.distribution, Composite),
            "fixed_point": self.has_fixed_point,
            "stated_point": self.body.fixed_point is not None,
        }
        return super().traits | {trait for trait, holds in traits.items() if holds}

    # The body by itself, in its constants

    @property
    def is_distributed(self) -> bool:
        """Whether the distribution of the mass is known, and not only the tensor."""
        return self.body.distribution is not None

    @cached_property
    def moments(self) -> Moments:
        """The moments of the distribution, or equivalent ones if only the tensor is given."""
        b = self.body
        inertia = b.inertia if b.central is None else b.central
        return moments_of(b.distribution or Known(mass=b.mass, centre=b.centre, inertia=inertia))

    @staticmethod
    def steiner(mass: sp.Expr, by: sp.MatrixBase) -> sp.Matrix:
        """M (|d|² 1 − d dᵀ)."""
        return mass * (by.dot(by) * sp.eye(3) - by * by.T)

    @staticmethod
    def tensor(second: sp.MatrixBase) -> sp.Matrix:
        """tr(J) 1 − J of the second moments J."""
        return second.trace() * sp.eye(3) - second

    def inertia_of_parts(self) -> sp.Matrix:
        """Σ (R I R ᵀ + m (|d|² 1 − d dᵀ)), a hole with a minus sign."""
        assert isinstance(self.body.distribution, Composite)
        total = sp.zeros(3)
        for part in self.body.distribution.parts:
            mass, centre, own = about_centre(part)
            total += part.turned * own * part.turned.T
            total += self.steiner(mass, centre - self.body.centre)
        return total

    @property
    def second_about_point(self) -> sp.Matrix:
        """∫ (x − p)(x − p)ᵀ dm."""
        m, p = self.moments, self.point
        return m.second - m.first * p.T - p * m.first.T + m.mass * p * p.T

    def moment_about_line(self) -> sp.Expr:
        """nᵀ I′ n + M |n × (p − c)|²."""
        n, body = self.direction, self.body
        crossed = n.cross(self.point - body.centre)
        about_centre = sp.collect((n.T * body.inertia * n)[0], [*{*body.inertia.diagonal()}])
        return about_centre + body.mass * crossed.dot(crossed)

    @cached_property
    def principal(self) -> Principal | None:
        return principal_of(self.body.inertia)

    @staticmethod
    def volume(columns: sp.MatrixBase) -> sp.Expr:
        """The determinant of a matrix (3, 3); SymPy's own would search for zeros in it."""
        first, second, third = (columns[:, k] for k in range(3))
        return first.dot(second.cross(third))

    # The body in its rotation, over the ring

    def trace(self, matrix: RingMatrix) -> PolyElement:
        return sum((matrix[k, k] for k in range(3)), self.codec.ring.zero)

    @cached_property
    def mass(self) -> PolyElement:
        return self.codec.encode(self.body.mass)

    @cached_property
    def centre(self) -> RingMatrix:
        return self.argument("centre")

    @cached_property
    def velocity(self) -> RingMatrix:
        """Of the centre of mass."""
        return self.argument("centre_dot")

    @cached_property
    def back(self) -> RingMatrix:
        """RᵀΩ, for Ωᵀ (R I′ Rᵀ) Ω from the outside inwards."""
        return self.rotation.T @ self.omega_space

    @cached_property
    def x(self) -> RingMatrix:
        """The place x = R x′ of the generic particle, from the centre of mass."""
        return self.rotation @ self.codec.column(particles.IN_BODY)

    @cached_property
    def x_dot(self) -> RingMatrix:
        return self.rotation_rate @ self.codec.column(particles.IN_BODY)

    def sum(self, summand: RingMatrix) -> RingMatrix:
        """Σ m of a summand."""
        sums = particles.sums_of_body(self.codec, self.body.mass, self.body.inertia)
        return sums.of_matrix(summand.scale(self.codec.encode(particles.MASS)))

    square = staticmethod(square)

    def half_of_squares(self, vector: RingMatrix) -> sp.Expr:
        """½ M |v|², in the shortest form."""
        return half_of_squares(self.present, self.mass, vector.entries)

    def half_form(self, vector: RingMatrix) -> sp.Expr:
        """½ vᵀ I′ v, the squares kept."""
        return half_form(self.present, self.inertia, vector)

    def read(self, value: sp.Expr | sp.MatrixBase) -> RingMatrix:
        """A value as it is printed, over the ring."""
        return self.codec.matrix(value if isinstance(value, sp.MatrixBase) else sp.Matrix([value]))

    @cached_property
    def twice_rotational(self) -> RingMatrix:
        return self.omega_body.T @ self.momentum_body

    @cached_property
    def momentum_of_centre(self) -> RingMatrix:
        return self.centre.cross(self.velocity).scale(self.mass)

    @cached_property
    def momentum_body(self) -> RingMatrix:
        """I′Ω′."""
        return self.inertia @ self.omega_body

    @cached_property
    def momentum(self) -> RingMatrix:
        """L_R = R I′Ω′."""
        return self.rotation @ self.momentum_body

    # The angular momentum in forms that people read: by the moments, not multiplied out

    @cached_property
    def momentum_form_body(self) -> sp.ImmutableMatrix:
        """I′Ω′, (3, 1): each moment times its component."""
        return self.present.matrix(self.inertia) * self.present.matrix(self.omega_body)

    @cached_property
    def momentum_form(self) -> sp.ImmutableMatrix:
        """R I′Ω′: multiplied out, row by row, or as b Ω + R (I′ − b 1) Ω′ for a moment b.

        The shortest form is taken that the ring knows to be equal: where constraints bind the
        coordinates, b Ω may be equal and the ring unable to tell.
        """
        read, momentum = self.present.matrix, self.momentum
        R, along, body = read(self.rotation), read(self.omega_space), read(self.omega_body)
        forms = [R * self.momentum_form_body]
        if max(map(len, momentum.entries)) <= _MOST_TERMS:
            forms.append(read(momentum))
        for moment in dict.fromkeys(self.inertia[k, k] for k in range(3)):
            rest = R * (read(self.inertia - self.one.scale(moment)) * body)
            forms.append(self.present.element(moment) * along + rest)
        is_equal = partial(agrees, self.present)
        return shortest_of([f for f in forms if all(map(is_equal, f, momentum.entries))])


def about_fixed_point(body: RigidBody, forces: Forces) -> RigidBody:
    """The body with its inertia tensor about the fixed point, if one is stated."""
    if not forces.fixed_point or body.fixed_point is not None:
        return body
    point = sp.ImmutableMatrix(forces.fixed_point)
    moved = body.inertia + BodyValues.steiner(body.mass, point - body.centre)
    # in the ring of quotients, where the whole mass in the centre of mass cancels
    codec = codec_for(moved, order=None)
    presented = presenter_for(codec).quotient
    tensor = moved.applyfunc(lambda entry: presented(codec.encode_quotient(entry)))
    return replace(body, inertia=tensor, central=body.inertia, fixed_point=point)


class NamedRotation(BodyValues):
    """A body whose rotation is known by names for R and Ω′.

    Of these only R Rᵀ = 1, det R = 1, Ω = R Ω′ and dR/dt = R C(Ω′) are used, which the derivation
    of a chain of turns proves.
    """

    velocity_names = sp.symbols("omega_body_1:4")

    @staticmethod
    @cache
    def names() -> RotationModel:
        """The nine entries of R by name."""
        entries = [f"R_{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)]
        return parametrised("direction_cosines", entries)

    def __init__(self, model: RotationModel, body: RigidBody, *, has_fixed_point: bool) -> None:
        super().__init__(model, body, has_fixed_point=has_fixed_point)
        moving = [*self.arguments["centre"].symbols, *self.arguments["centre_dot"].symbols]
        inputs = [*self.names().matrix, *self.velocity_names, *moving]
        inputs += [body.mass, *body.inertia, sp.Rational(1, 2), *self._also]
        self.codec = codec_for(inputs, order=1)
        self.prove = Prover(self.names(), self.codec)
        self.omega_body = self.codec.column(self.velocity_names)
        self.rotation = self.codec.matrix(self.names().matrix)
        self.rotation_rate = self.rotation @ hat(self.omega_body)
        self.omega_space = self.rotation @ self.omega_body

    def renamed(self, step: Step, chain: Chain) -> Step:
        """The step with R and Ω′ as a chain names them, and proves them to be."""
        names = dict(zip(self.names().matrix, chain.rotation, strict=True))
        names |= dict(zip(self.velocity_names, chain.omega_body, strict=True))
        if not step.expression.has(*names):
            return step
        rests_on = (KINEMATICS["rotation_matrix"], KINEMATICS["angular_velocity_body"])
        proofs = [p for q in rests_on for p in chain.proofs(q.presented(chain.traits))]
        expression = sp.ImmutableMatrix(step.expression.xreplace(names))
        return replace(step, expression=expression, proofs=(*step.proofs, *proofs))


def _in_letters(step: Step, letters: Mapping[Formula, Formula]) -> Step:
    quantity = step.quantity
    symbol, definition = with_names((quantity.symbol, quantity.definition), letters)
    proofs = [proof.in_letters(letters) for proof in step.proofs]
    recursion = with_names(step.recursion, letters)
    quantity = quantity._replace(symbol=symbol, definition=definition)
    return replace(step, quantity=quantity, proofs=tuple(proofs), recursion=recursion)


def steps_of_body(
    model: RotationModel,
    whole: RigidBody,
    forces: Forces | None,
    only: Collection[str],
    chain: Chain | None,
) -> tuple[BodyValues, list[Step], Flow | None]:
    """The body; the steps to its quantities; and its equations of motion under forces.

    With a `chain`, R and Ω′ are those that it names.
    """
    is_fixed = forces is not None and forces.fixed_point != ()
    lacking = {n for n, q in OF_BODY.items() if is_fixed and q.without == AT_REST}
    wanted = {*(only or OF_BODY)} - lacking
    values = (NamedRotation if chain else BodyValues)(model, whole, has_fixed_point=is_fixed)
    steps = [step for n, q in OF_BODY.items() if n in wanted and (step := values.step(q))]
    if isinstance(values, NamedRotation) and chain:
        steps = [values.renamed(step, chain) for step in steps]
    # of a body alone, all quantities that it has are asked for
    entries = {} if BODY_ALONE in only else {**OF_BODY}
    motion = None
    if forces is not None:
        motion = equations_of_motion(model, whole, forces, chain)
        steps += motion.steps(tuple(only))
        entries |= motion.table
    names = {step.quantity.name for step in steps}
    if absent := [q for n, q in entries.items() if n in only and n not in names]:
        reasons = (f"no quantity {q.name}: {sentence_of(q.without)}" for q in absent)
        raise QuantityError(f"{whole.name} has {'; '.join(reasons)}")
    letters = own_letters(values.arguments.values(), whole, forces)
    return values, [_in_letters(step, letters) for step in steps] if letters else steps, motion
