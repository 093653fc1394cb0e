r"""Equations of motion of bodies on joints, by recursion over the tree of their turns.

Each joint k turns by θₖ about the axis nₖ, with the matrix Tₖ, and carries bodies of the inertia Iₖ
and further joints c. With the angular velocities wₖ of the kinematics (`kinematics.chain`), the
accelerations aₖ that they have for q̈ = 0, and a sum over the joints that k carries,

    Iᶜₖ = Iₖ + Σ T_c Iᶜ_c T_cᵀ                      M: nᵢ · Tᵢ₊₁ ⋯ Tₖ Iᶜₖ nₖ, for joint i before k
    Hₖ = Iₖ wₖ + Σ T_c H_c                          p: nₖ · Hₖ
    Nₖ = Iₖ aₖ + wₖ × Iₖ wₖ + Σ T_c N_c             h: nₖ · Nₖ, and ∂V/∂q
    ∂T/∂θₖ = −nₖ · (wₖ × Hₖ)                        turning all that k carries by dθₖ

Particles add m Jᵀ J and m Jᵀ (dJ/dt) q̇. Every vector has a name, so that M and h take as many
operations as there are pairs of joints. q̈ follows from M = L D Lᵀ, which is shorter than M⁻¹.

Lagrange's equations hold for these since each column of a rate matrix obeys
dW/dt − ∂ω/∂q = W × ω. That is proved for a turn behind any rotation; by induction it holds for all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import combinations
from operator import mul
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.errors import Defect, ModelError
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import FirstIntegral, Proof, Quantity
from rigidsym.mechanics.dynamics.flow import Flow
from rigidsym.mechanics.kinematics.chain import (
    Chain,
    Matrix,
    Vector,
    acceleration,
    kinds_of,
    velocity,
)
from rigidsym.mechanics.prove import Conditions, Prover, consequence
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_BODY, Forces
from rigidsym.models.rotation import TIME, RotationModel, Turn, as_typed

_ZERO = sp.ImmutableMatrix(sp.zeros(3, 1))
_NOTHING = sp.ImmutableMatrix(sp.zeros(3))


@dataclass(eq=False)
class Joint:
    """One turn of the tree, in names; `inertia` is that of the bodies that turn with it."""

    label: str
    turn: Turn
    matrix: Matrix
    speed: sp.Expr
    omega: Vector
    before: Joint | None
    inertia: sp.ImmutableMatrix = _NOTHING
    carried: list[Joint] = field(default_factory=list)

    @property
    def axis(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(self.turn.direction)


class Named(NamedTuple):
    """A name, and its definition as it is printed."""

    name: sp.Expr
    meaning: sp.Expr


class Particle(NamedTuple):
    """A point of mass m with the velocity v = J q̇ in space."""

    mass: sp.Expr
    slopes: sp.ImmutableMatrix  # J as it is given, (3, n)
    jacobian: sp.ImmutableMatrix  # J in names
    velocity: Vector
    gained: Vector  # dv/dt for q̈ = 0


class TreeEquations(Flow):
    """The steps of bodies on joints and of particles, in Lagrange's form and in names."""

    table = claims.DYNAMICS_QUANTITIES
    second = "q_dot"
    lacking = ("state_jacobian", "error_state_jacobian")
    names: Chain

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces, chain: Chain) -> None:
        """Raises ModelError for what is no product of turns, and for velocities of no position."""
        if forces.first_integrals:
            raise ModelError(
                f"{model.name}: first integrals of bodies on joints are not proved; expected none "
                "(`simulate` shows how far a quantity drifts)"
            )
        self.names = chain
        self.q = model.coordinates
        self.rates = [sp.diff(q, TIME) for q in self.q]
        self._at_rest = {sp.diff(q, TIME, 2): sp.S.Zero for q in self.q}
        self.gradient = [sp.diff(forces.potential, q) for q in self.q]
        acting = [*self.gradient, *forces.generalised.values(), *forces.torque]
        entries = [forces.potential, *acting, *self.rates, *OMEGA_BODY]
        codec = codec_for([e for e in entries if e != 0], order=1)
        super().__init__(model, body, forces, codec)
        self.joints = self._joints()
        self.particles = [
            self._particle(str(k), sp.ImmutableMatrix(part.velocity), part.inertia[0])
            for k, part in enumerate(forces.parts, start=1)
            if part.rotation is None
        ]

    def _joints(self) -> dict[tuple[Turn, ...], Joint]:
        """By the turns up to each; those of the body come first."""
        bodies = [(self.model, self.body.inertia)]
        bodies += [
            (part.rotation, sp.ImmutableMatrix(sp.diag(*part.inertia)))
            for part in self.forces.parts
            if part.rotation is not None
        ]
        joints: dict[tuple[Turn, ...], Joint] = {}
        for model, inertia in bodies:
            if not model.turns:
                raise ModelError(
                    f"{model.name} moves with other bodies; expected a product of turns, such as "
                    '"z(phi) x(theta)"'
                )
            before = None
            for count in range(1, len(model.turns) + 1):
                path = model.turns[:count]
                if path not in joints:
                    joints[path] = self._joint(len(joints), path[-1], before)
                before = joints[path]
            joints[model.turns].inertia += inertia
        return joints

    def _joint(self, k: int, turn: Turn, before: Joint | None) -> Joint:
        names, label = self.names, str(k + 1)
        if k < names.count:  # the names that the kinematics of the body has
            joint = Joint(
                label, turn, names.turns[k], names.speeds[k], names.velocities_body[k + 1], before
            )
        else:
            matrix = names.named(f"T{label}", turn.matrix)
            speed = names.define(f"dtheta{label}", turn.rate)
            own, other = sp.ImmutableMatrix(turn.direction) * speed, before and before.omega
            omega = names.named(f"w{label}", velocity(matrix.T, own, other or _ZERO))
            joint = Joint(label, turn, matrix, speed, omega, before)
        if before is not None:
            before.carried.append(joint)
        return joint

    def _particle(self, label: str, given: sp.ImmutableMatrix, mass: sp.Expr) -> Particle:
        """J and v by names; v = J q̇ has to be the rate of a position, ∂Jᵢ/∂qₖ = ∂Jₖ/∂qᵢ."""
        slopes = sp.ImmutableMatrix(given.jacobian(self.rates))
        text = ", ".join(map(as_typed, given))
        if slopes.has(*self.rates) or any(given.xreplace(dict.fromkeys(self.rates, sp.S.Zero))):
            raise ModelError(f"the velocity ({text}) is not linear in the rates")
        turned = [
            sp.diff(one, self.q[k]) - sp.diff(other, self.q[j])
            for j, k in combinations(range(len(self.q)), 2)
            for one, other in zip(slopes.col(j), slopes.col(k), strict=True)
        ]
        codec = codec_for(turned, constraints=self.model.constraints, order=0)
        if not codec.column(turned).is_zero():
            raise ModelError(
                f"the velocity ({text}) is that of no position, as in rolling; expected the time "
                "derivative of a position"
            )
        jacobian = self.names.named(f"J{label}", slopes)
        gained = slopes.diff(TIME) * sp.Matrix(self.rates)
        return Particle(
            mass,
            slopes,
            jacobian,
            self.names.named(f"v{label}", jacobian * sp.Matrix(self.rates)),
            self.names.named(f"b{label}", gained),
        )

    # Sums over the tree

    def _gathered(self, letter: str, own: Any, *, of_tensors: bool = False) -> dict[Joint, Any]:
        """What all that a joint carries adds up to, in the axes of the joint."""
        total: dict[Joint, Any] = {}
        for joint in reversed(self.joints.values()):  # each after those that it carries
            parts = [own(joint)]
            for other in joint.carried:
                back = other.matrix * total[other]
                parts.append(back * other.matrix.T if of_tensors else back)
            whole = sum(parts[1:], parts[0])
            total[joint] = self.names.named(f"{letter}{joint.label}", whole)
        return total

    def _along(self, values: Mapping[Joint, sp.Expr]) -> list[sp.Expr]:
        """From values by angle to values by coordinate."""
        return [
            sp.Add(*(sp.diff(j.turn.angle, q) * value for j, value in values.items()))
            for q in self.q
        ]

    @cached_property
    def _momenta(self) -> dict[Joint, Vector]:
        """Hₖ."""
        return self._gathered("H", lambda joint: joint.inertia * joint.omega)

    @cached_property
    def momenta(self) -> sp.ImmutableMatrix:
        """p = ∂T/∂q̇."""
        parts = self._along({j: j.axis.dot(H) for j, H in self._momenta.items()})
        return sp.ImmutableMatrix(
            [
                part + sp.Add(*(p.mass * p.jacobian.col(k).dot(p.velocity) for p in self.particles))
                for k, part in enumerate(parts)
            ]
        )

    def _felt(self, letter: str, joint: Joint, torque: sp.MatrixBase) -> dict[Joint, sp.Expr]:
        """What each joint up to this one feels of a torque, along its axis."""
        along: dict[Joint, sp.Expr] = {}
        at: Joint | None = joint
        while at is not None:
            torque = self.names.named(f"{letter}{joint.label}_{at.label}", torque)
            along[at] = at.axis.dot(torque)
            torque, at = at.matrix * torque, at.before
        return along

    @cached_property
    def mass_matrix(self) -> sp.ImmutableMatrix:
        total = sp.zeros(len(self.q))
        composite = self._gathered("I", lambda joint: joint.inertia, of_tensors=True)
        for joint, tensor in composite.items():
            felt = self._felt("f", joint, tensor * joint.axis)
            slopes = sp.Matrix([[sp.diff(joint.turn.angle, q) for q in self.q]])
            part = slopes.T * sp.Matrix([self._along(felt)])
            total += part + part.T - slopes.T * slopes * felt[joint]
        for p in self.particles:
            total += p.mass * p.jacobian.T * p.jacobian
        names = self.names.named("M", total)
        return sp.ImmutableMatrix(*names.shape, lambda i, j: names[min(i, j), max(i, j)])

    @cached_property
    def bias(self) -> sp.ImmutableMatrix:
        """h."""
        gained: dict[Joint, Vector] = {}
        for joint in self.joints.values():
            slope = sp.diff(joint.turn.angle, TIME, 2).xreplace(self._at_rest)
            before = gained[joint.before] if joint.before else _ZERO
            turned = joint.omega.cross(joint.axis) * joint.speed
            value = acceleration(joint.matrix.T, joint.axis * slope, turned, before)
            gained[joint] = self.names.named(f"a{joint.label}", value)

        def torque(joint: Joint) -> sp.MatrixBase:
            turning = joint.omega.cross(joint.inertia * joint.omega)
            return joint.inertia * gained[joint] + turning

        needed = self._gathered("N", torque)
        parts = self._along({joint: joint.axis.dot(N) for joint, N in needed.items()})
        return sp.ImmutableMatrix(
            [
                self.names.define(
                    f"h{k + 1}",
                    part
                    + self.gradient[k]
                    + sp.Add(*(p.mass * p.jacobian.col(k).dot(p.gained) for p in self.particles)),
                )
                for k, part in enumerate(parts)
            ]
        )

    @cached_property
    def generalised(self) -> list[sp.Expr]:
        """Q, with the torque on the body."""
        at = self.joints[self.model.turns]
        in_names = dict(zip(OMEGA_BODY, at.omega, strict=True))
        given = [self.forces.generalised.get(q, sp.S.Zero).xreplace(in_names) for q in self.q]
        if not self.forces.torque:
            return given
        torque = sp.ImmutableMatrix(self.forces.torque).xreplace(in_names)
        felt = self._along(self._felt("Q", at, torque))
        return [own + part for own, part in zip(given, felt, strict=True)]

    @cached_property
    def factors(self) -> dict[tuple[int, int], Named]:
        """L below the diagonal and D on it, with M = L D Lᵀ.

        Raises ModelError if the mass matrix has no inverse.
        """
        factors: dict[tuple[int, int], Named] = {}
        for j in range(len(self.q)):
            scaled = [factors[j, k].name * factors[k, k].name for k in range(j)]
            for i in range(j, len(self.q)):
                row = scaled if i == j else [factors[i, k].name for k in range(j)]
                other = [factors[j, k].name for k in range(j)] if i == j else scaled
                rest = self.mass_matrix[i, j] - sp.Add(*map(mul, row, other))
                if i == j:
                    factors[j, j] = self._call(f"D{j + 1}", rest)
                else:
                    factors[i, j] = self._call(f"L{i + 1}_{j + 1}", rest / factors[j, j].name)
            if not self.names.is_nonzero(factors[j, j].name):
                raise ModelError(
                    f"{self.model.name}: the mass matrix has no inverse; expected coordinates "
                    "that move the bodies in different ways"
                )
        return factors

    def _call(self, name: str, value: sp.Expr) -> Named:
        symbol = self.names.define(name, value)
        return Named(symbol, self.names.printed(symbol, value))

    @cached_property
    def forward(self) -> list[Named]:
        """y with L y = Q − h."""
        y: list[Named] = []
        for i in range(len(self.q)):
            rest = sp.Add(*(self.factors[i, k].name * part.name for k, part in enumerate(y)))
            y.append(self._call(f"y{i + 1}", self.generalised[i] - self.bias[i] - rest))
        return y

    @cached_property
    def backward(self) -> list[Named]:
        """q̈ with Lᵀ q̈ = D⁻¹ y, the last first."""
        size, parts = len(self.q), dict[int, Named]()
        for i in reversed(range(size)):
            rest = sp.Add(*(self.factors[k, i].name * parts[k].name for k in range(i + 1, size)))
            value = self.forward[i].name / self.factors[i, i].name - rest
            parts[i] = self._call(f"ddq{i + 1}", value)
        return [parts[i] for i in range(size)]

    @cached_property
    def solved(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([part.name for part in self.backward])

    # What entries ask of a workspace

    @property
    def traits(self) -> frozenset[str]:
        several = len(self.forces.parts) > 0
        return frozenset(("tree", *(["parts"] if several else []), *self._shared_traits))

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Σ wᵀ I w + ½ Σ m v²."""
        turning = [(j.omega.T * j.inertia * j.omega)[0] for j in self.joints.values()]
        moving = [p.mass * p.velocity.dot(p.velocity) for p in self.particles]
        return sp.Add(*turning, *moving) / 2

    @cached_property
    def whole(self) -> sp.Expr:
        return self.kinetic + self.forces.potential

    coriolis = hamiltonian = single = None  # which are shorter multiplied out

    @cached_property
    def state_derivative(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([*self.rates, *self.solved])

    def recursion(self, quantity: Quantity) -> Formula | None:
        return formula(quantity.recursion) if quantity.recursion else None

    # Proofs

    def proofs(self, quantity: Quantity, _value: Any = None) -> tuple[Proof, ...]:
        """The laws of the recursion, from which those of the quantity follow."""
        if quantity.name == claims.accelerations.name:
            return tuple(self._solves(law.claim) for law in quantity.laws)
        return tuple(consequence(self._lemmas, law.claim) for law in quantity.laws)

    @cached_property
    def _lemmas(self) -> list[Proof]:
        self._check()
        turns = kinds_of((joint.turn for joint in self.joints.values()), self.model)
        return [*of_any_body(), *(of_any_turn(*kind) for kind in turns)]

    def _check(self) -> None:
        """M, h, p and T at a real point, against Jacobians of the turns multiplied out in numbers.

        The lemmas say nothing of the parts that the recursion names; raises Defect if one is wrong.
        """
        turns = {joint.turn for joint in self.joints.values()}
        held = [e for turn in turns for e in (*turn.matrix.diff(TIME), *turn.matrix)]
        held += [e for p in self.particles for e in (*p.slopes.diff(TIME), *p.slopes, p.mass)]
        held += [e for joint in self.joints.values() for e in joint.inertia]
        named = [*self.mass_matrix, *self.bias, *self.momenta, self.kinetic]
        work = self.names.values_of([*named, *held, *self.rates, *self.gradient])
        numbers = work.context.matrix

        def read(matrix: sp.MatrixBase) -> Any:
            return numbers([[work(entry) for entry in row] for row in matrix.tolist()])

        q_dot, gradient = (read(sp.Matrix(part)) for part in (self.rates, self.gradient))
        mass, needed = numbers(len(self.q), len(self.q)), gradient
        for path, joint in self.joints.items():
            if joint.inertia.is_zero_matrix:
                continue
            jacobian = rate = numbers(3, len(self.q))
            for turn in path:
                back, back_rate = read(turn.matrix.T), read(turn.matrix.T.diff(TIME))
                slopes = sp.Matrix([[sp.diff(turn.angle, q) for q in self.q]])
                column = sp.Matrix(turn.direction) * slopes
                rate = back_rate * jacobian + back * rate + read(column.diff(TIME))
                jacobian = back * jacobian + read(column)
            tensor, omega = read(joint.inertia), jacobian * q_dot
            (x, y, z), (a, b, c) = omega, tensor * omega
            gyroscopic = numbers([y * c - z * b, z * a - x * c, x * b - y * a])
            mass += jacobian.T * tensor * jacobian
            needed += jacobian.T * (tensor * rate * q_dot + gyroscopic)
        for p in self.particles:
            jacobian, rate = read(p.slopes), read(p.slopes.diff(TIME))
            mass += work(p.mass) * jacobian.T * jacobian
            needed += work(p.mass) * jacobian.T * rate * q_dot
        momenta = mass * q_dot
        off = [*(mass - read(self.mass_matrix)), *(needed - read(self.bias))]
        off += [*(momenta - read(self.momenta)), (q_dot.T * momenta)[0] - 2 * work(self.kinetic)]
        if not all(0 in entry for entry in off):
            raise Defect(
                f"{self.model.name}: the equations of motion are wrong at a point; this is a "
                "defect of rigidsym, please report it"
            )

    def _solves(self, claim: Formula) -> Proof:
        """The rows of M = L D Lᵀ, of L y = Q − h and of D Lᵀ q̈ = y, by the definitions."""
        size, factors, y, solution = len(self.q), self.factors, self.forward, self.backward
        residuals = []
        for i in range(size):
            for j in range(i + 1):
                parts = [
                    factors[i, k].name * factors[k, k].name * factors[j, k].name for k in range(j)
                ]
                last = factors[i, j].meaning * (factors[j, j].name if i != j else 1)
                residuals.append(self.mass_matrix[i, j] - sp.Add(*parts, last))
            below = (factors[i, k].name * y[k].name for k in range(i))
            residuals.append(self.generalised[i] - self.bias[i] - sp.Add(y[i].meaning, *below))
            above = (factors[k, i].name * solution[k].name for k in range(i + 1, size))
            turned = factors[i, i].name * sp.Add(solution[i].meaning, *above)
            residuals.append(turned - y[i].name)
        return self.names.vanish(residuals, claim)

    # First integrals

    def own_integrals(self) -> Iterator[FirstIntegral]:
        """The energy, if nothing does work, and the momenta of coordinates that do not matter."""
        torque = sp.Matrix(self.forces.torque or _ZERO)
        forces = sp.Matrix([self.forces.generalised.get(q, sp.S.Zero) for q in self.q])
        power = forces.dot(sp.Matrix(self.rates)) + torque.dot(sp.Matrix(OMEGA_BODY))
        work = self.codec.column([power])
        if work.is_zero() and self.driving.is_zero():
            claim = claims.is_constant(claims.ENERGY)
            proofs = [*self._lemmas, self.prove.vanishes(work, claim)]
            yield FirstIntegral("energy", claims.ENERGY, self.whole, consequence(proofs, claim))
        for k, q in enumerate(self.q):
            claim = claims.momentum_is_constant(k + 1)
            residual = self._slope_of_kinetic(k) + self.generalised[k] - self.gradient[k]
            if self.names.is_nonzero(residual):
                continue
            for symbol, expression in reversed(self.names.definitions_of([residual])):
                residual = residual.xreplace({symbol: expression})
            proofs = [*self._lemmas, self.names.vanish([residual], claim)]
            yield FirstIntegral(
                name=f"momentum_{q.func.__name__}",
                symbol=self.arguments["momenta"].notation[k],
                expression=self.momenta[k],
                proof=consequence(proofs, claim),
            )

    def _slope_of_kinetic(self, k: int) -> sp.Expr:
        """∂T/∂q."""
        parts = []
        for joint, momentum in self._momenta.items():
            slope = sp.diff(joint.turn.angle, self.q[k])
            parts.append(-slope * joint.axis.dot(joint.omega.cross(momentum)))
            parts.append(sp.diff(slope, TIME) * joint.axis.dot(momentum))
        parts += [p.mass * p.velocity.dot(p.slopes.col(k).diff(TIME)) for p in self.particles]
        return sp.Add(*parts)


# The lemmas


@cache
def of_any_body() -> tuple[Proof, ...]:
    """Lagrange's equations of a body, the power of its inertia, and sums over joints.

    W is a column of its rate matrix, ω its angular velocity, `slope` is ∂ω/∂q and `rate` dω/dt.
    """
    W, omega, slope, rate = (sp.Matrix(sp.symbols(f"{name}_1:4")) for name in "Wwsr")
    tensor = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j)}{max(i, j)}"))
    turn = sp.Matrix(3, 3, sp.symbols("T_1:10"))
    gained = slope + W.cross(omega)  # dW/dt
    torque = tensor * rate + omega.cross(tensor * omega)
    momentum = tensor * omega
    lagrange = gained.dot(momentum) + W.dot(tensor * rate) - slope.dot(momentum) - W.dot(torque)
    carried = (turn.T * W).dot(slope) - W.dot(turn * slope)
    composite = ((turn.T * W).T * tensor * (turn.T * omega))[0]
    composite -= (W.T * (turn * tensor * turn.T) * omega)[0]
    power = omega.dot(tensor * rate) - omega.dot(torque)
    claims_of = {
        r"\frac{d}{dt}\frac{\partial T}{\partial\dot\q} - \frac{\partial T}{\partial\q} = "
        r"\W'^T\left(\I'\,\dot\Om' + \Om'\times\I'\,\Om'\right)": lagrange,
        r"(\T^T\u)\cdot\v = \u\cdot(\T\,\v)": carried,
        r"(\T^T\u)^T\,\I\,(\T^T\v) = \u^T\,(\T\,\I\,\T^T)\,\v": composite,
        r"\Om'\cdot(\I'\,\dot\Om' + \Om'\times\I'\,\Om') = \Om'\cdot\I'\,\dot\Om'": power,
    }
    codec = codec_for([*W, *omega, *slope, *rate, *tensor, *turn], order=0)
    prover = Prover(Conditions("a body"), codec)
    return tuple(
        prover.vanishes(codec.column([residual]), formula(claim))
        for claim, residual in claims_of.items()
    )


@cache
def of_any_turn(turn: Turn, conditions: Conditions) -> Proof:
    """dW/dt − ∂ω/∂q = W × ω for a turn behind a rotation that obeys it.

    Of that rotation a is the angular velocity, A a column and s = ∂a/∂q, so dA/dt = s + A × a.
    The turn has the column n.
    """
    a, A, s = (sp.Matrix(sp.symbols(f"{name}_1:4")) for name in ("a", "A", "s"))
    back, n, angle = turn.matrix.T, sp.Matrix(turn.direction), turn.angle
    speed, unknown = sp.Symbol("speed"), sp.Dummy("theta")
    slope = back.subs(angle, unknown).diff(unknown).subs(unknown, angle)
    omega = n * speed + back * a
    first = slope * speed * A + back * (s + A.cross(a)) - back * s - (back * A).cross(omega)
    second = -slope * a - n.cross(omega)
    residual = [*first, *second]
    codec = codec_for([*residual, *turn.matrix, *n], constraints=conditions.constraints, order=0)
    claim = formula(r"\dot\W' - \frac{\partial\Om'}{\partial\q} = \W'\times\Om'")
    return Prover(conditions, codec).vanishes(codec.column(residual), claim)
