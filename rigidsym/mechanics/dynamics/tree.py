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

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import combinations
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.evaluate import RealValues
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.errors import Defect, ModelError
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Proof, Quantity
from rigidsym.mechanics.dynamics.flow import LagrangeForm
from rigidsym.mechanics.kinematics.chain import Chain, acceleration, kinds_of, velocity
from rigidsym.mechanics.prove import Conditions, Prover, consequence
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.dynamics import TORQUE
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import OMEGA_BODY, TIME, RotationModel, Turn, as_typed, hat

_ZERO = sp.ImmutableMatrix(sp.zeros(3, 1))


@dataclass(eq=False)
class Joint:
    """One turn of the tree, in names; `inertia` is that of the bodies that turn with it."""

    label: str
    turn: Turn
    slopes: sp.ImmutableMatrix  # of its angle by the coordinates, (1, n)
    matrix: sp.ImmutableMatrix  # (3, 3)
    speed: sp.Expr
    omega: sp.ImmutableMatrix  # (3, 1)
    before: Joint | None
    inertia: sp.ImmutableMatrix = field(default_factory=lambda: sp.ImmutableMatrix.zeros(3, 3))

    @property
    def axis(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(self.turn.direction)


class Particle(NamedTuple):
    """A point of mass m with the velocity v = J q̇ in space."""

    mass: sp.Expr
    slopes: sp.ImmutableMatrix  # J as it is given, (3, n)
    slopes_rate: sp.ImmutableMatrix  # dJ/dt
    jacobian: sp.ImmutableMatrix  # J in names
    velocity: sp.ImmutableMatrix  # (3, 1)
    gained: sp.ImmutableMatrix  # dv/dt for q̈ = 0


class Solution(NamedTuple):
    """M = L D Lᵀ, L y = Q − h and D Lᵀ q̈ = y, in names, or in their definitions."""

    L: sp.Matrix
    D: sp.Matrix
    y: sp.Matrix
    accelerations: sp.Matrix


class TreeEquations(LagrangeForm):
    """The steps of bodies on joints and of particles, in names."""

    kind = ("tree",)
    lacking = ("state_jacobian", "error_state_jacobian")
    names: Chain
    hamiltonian = single = None  # which are shorter multiplied out

    def __init__(self, model: RotationModel, body: RigidBody, forces: Forces, chain: Chain) -> None:
        """Raises ModelError for what is no product of turns, and for velocities of no position."""
        if forces.first_integrals:
            raise ModelError(
                f"{model.name}: first integrals of bodies on joints are not proved; expected none "
                "(`simulate` shows how far a quantity drifts)"
            )
        self.names = chain
        self.gradient = [sp.diff(forces.potential, q) for q in model.coordinates]
        acting = [*self.gradient, *forces.generalised.values(), *forces.torque]
        rates = [sp.diff(q, TIME) for q in model.coordinates]
        entries = [forces.potential, *acting, *rates, *OMEGA_BODY]
        super().__init__(model, body, forces, codec_for([e for e in entries if e != 0], order=1))
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
            for count, turn in enumerate(model.turns, start=1):
                # Bodies share the joints up to the turn at which their products part.
                path = model.turns[:count]
                if path not in joints:
                    joints[path] = self._joint(str(len(joints) + 1), turn, before)
                before = joints[path]
            joints[model.turns].inertia += inertia
        return joints

    def _joint(self, label: str, turn: Turn, before: Joint | None) -> Joint:
        """In names, which for the turns of the body are those of its kinematics."""
        matrix = self.names.named(f"T{label}", turn.matrix)
        speed = self.names.define(f"dtheta{label}", turn.rate)
        own = sp.ImmutableMatrix(turn.direction) * speed
        # wₖ = θ̇ₖ nₖ + Tₖᵀ wₖ₋₁
        omega = velocity(matrix.T, own, before.omega if before else _ZERO)
        omega = self.names.named(f"w{label}", omega)
        slopes = sp.ImmutableMatrix([[sp.diff(turn.angle, q) for q in self.q]])
        return Joint(label, turn, slopes, matrix, speed, omega, before)

    def _particle(self, label: str, given: sp.ImmutableMatrix, mass: sp.Expr) -> Particle:
        """J and v by names; v = J q̇ has to be the rate of a position, ∂Jᵢ/∂qₖ = ∂Jₖ/∂qᵢ."""
        rates, count = sp.Matrix(self.rates), len(self.rates)
        text = ", ".join(map(as_typed, given))
        # Column k of J is v at q̇ = eₖ. SymPy differentiates by rates and coordinates through
        # dummies, which takes five times as long as the ring.
        units = (dict(zip(rates, unit, strict=True)) for unit in sp.eye(count).tolist())
        slopes = sp.ImmutableMatrix.hstack(*map(given.xreplace, units))
        is_finite = not slopes.has(sp.zoo, sp.nan)
        entries = [*given, *rates, *(slopes if is_finite else ())]
        codec = codec_for(entries, constraints=self.model.constraints, order=1)
        if not (
            is_finite
            and (codec.column(given) - codec.matrix(slopes) @ codec.column(rates)).is_zero()
        ):
            raise ModelError(f"the velocity ({text}) is not linear in the rates")
        # J q̇ is the rate of a position r(q) exactly if J = ∂r/∂q, which by Schwarz' theorem
        # requires ∂Jⱼ/∂qₖ = ∂Jₖ/∂qⱼ. Rolling without slipping fails it, and Lagrange's equations do
        # not hold for it in this form. ∂Jⱼ/∂qₖ is the coefficient of q̇ₖ in dJⱼ/dt.
        by = codec.matrix(slopes.T).dt().jacobian([codec.ring.index[rate] for rate in rates])
        turned = [
            by[3 * j + i, k] - by[3 * k + i, j]
            for j, k in combinations(range(count), 2)
            for i in range(3)
        ]
        if not RingMatrix.column(codec.ring, turned).is_zero():
            raise ModelError(
                f"the velocity ({text}) is that of no position, as in rolling; expected the time "
                "derivative of a position"
            )
        jacobian = self.names.named(f"J{label}", slopes)
        v = self.names.named(f"v{label}", jacobian * rates)
        slopes_rate = slopes.diff(TIME)
        gained = self.names.named(f"b{label}", slopes_rate * rates)
        return Particle(mass, slopes, slopes_rate, jacobian, v, gained)

    # Sums over the tree

    def _carried(
        self, letter: str, own: Callable[[Joint], Any], *, of_tensors: bool = False
    ) -> dict[Joint, Any]:
        """The sum over all that a joint carries, in the axes of the joint."""
        total = {joint: own(joint) for joint in self.joints.values()}
        for joint in reversed(total):  # each after those that it carries
            total[joint] = self.names.named(f"{letter}{joint.label}", total[joint])
            if joint.before:
                # A vector goes back to the axes of the joint before as T v, a tensor as T I Tᵀ. A
                # tensor that is symmetric about the axis, C(n) I = I C(n), is the same in both.
                back, turn = joint.matrix * total[joint], hat(joint.axis)
                if of_tensors and turn * total[joint] == total[joint] * turn:
                    back = total[joint]
                elif of_tensors:
                    back = back * joint.matrix.T
                total[joint.before] += back
        return total

    def _by_coordinate(self, by_angle: Mapping[Joint, sp.Expr]) -> sp.Matrix:
        """Values by coordinate, (n, 1), from values by angle."""
        parts = (joint.slopes.T * value for joint, value in by_angle.items())
        return sum(parts, sp.zeros(len(self.q), 1))

    def _with_particles(self, total: sp.Matrix, value: Callable[[Particle], Any]) -> sp.Matrix:
        """With Σ m Jᵀ of vectors or Jacobians."""
        return sum((p.mass * (p.jacobian.T * value(p)) for p in self.particles), total)

    @cached_property
    def _momenta(self) -> dict[Joint, sp.ImmutableMatrix]:
        """Hₖ."""
        return self._carried("H", lambda joint: joint.inertia * joint.omega)

    @cached_property
    def momenta(self) -> sp.ImmutableMatrix:
        """p = ∂T/∂q̇."""
        turning = self._by_coordinate({j: j.axis.dot(H) for j, H in self._momenta.items()})
        return sp.ImmutableMatrix(self._with_particles(turning, lambda p: p.velocity))

    def _felt(self, letter: str, joint: Joint, torque: sp.MatrixBase) -> dict[Joint, sp.Expr]:
        """What each joint up to this one feels of a torque, along its axis."""
        along: dict[Joint, sp.Expr] = {}
        at: Joint | None = joint
        # fᵢ = nᵢ · Tᵢ₊₁ ⋯ Tₖ f for all joints i from k down to the root: one product for each.
        while at is not None:
            torque = self.names.named(f"{letter}{joint.label}_{at.label}", torque)
            along[at] = at.axis.dot(torque)
            torque, at = at.matrix * torque, at.before
        return along

    @cached_property
    def mass_matrix(self) -> sp.ImmutableMatrix:
        total = sp.zeros(len(self.q))
        composite = self._carried("I", lambda joint: joint.inertia, of_tensors=True)
        for joint, tensor in composite.items():
            # Row k of the mass matrix by angles: nᵢ · Iᶜₖ nₖ for i up to k. M is symmetric, so the
            # transpose is added, and the diagonal element, which both contain, is subtracted once.
            felt = self._felt("f", joint, tensor * joint.axis)
            part = self._by_coordinate(felt) * joint.slopes
            total += part + part.T - joint.slopes.T * joint.slopes * felt[joint]
        names = self.names.named("M", self._with_particles(total, lambda p: p.jacobian))
        return sp.ImmutableMatrix(*names.shape, lambda i, j: names[min(i, j), max(i, j)])

    @cached_property
    def bias(self) -> sp.ImmutableMatrix:
        """h."""
        gained: dict[Joint, sp.ImmutableMatrix] = {}
        for joint in self.joints.values():
            # θ̈ₖ at q̈ = 0 is d/dt(∂θₖ/∂q) q̇, which vanishes unless the angle is not linear in q.
            own = joint.axis * joint.slopes.diff(TIME) * sp.Matrix(self.rates)
            before = gained[joint.before] if joint.before else _ZERO
            turned = joint.omega.cross(joint.axis) * joint.speed
            value = acceleration(joint.matrix.T, own, turned, before)
            gained[joint] = self.names.named(f"a{joint.label}", value)

        def torque(joint: Joint) -> sp.MatrixBase:
            turning = joint.omega.cross(joint.inertia * joint.omega)
            return joint.inertia * gained[joint] + turning

        needed = self._carried("N", torque)
        total = self._by_coordinate({joint: joint.axis.dot(N) for joint, N in needed.items()})
        total = self._with_particles(total, lambda p: p.gained) + sp.Matrix(self.gradient)
        return sp.ImmutableMatrix(
            [self.names.define(f"h{k}", entry) for k, entry in enumerate(total, start=1)]
        )

    @cached_property
    def generalised(self) -> sp.Matrix:
        """Q, with the torque on the body."""
        body = self.joints[self.model.turns]
        torque = sp.Matrix(self.forces.torque or _ZERO)
        in_names = dict(zip(OMEGA_BODY, body.omega, strict=True))
        felt = self._felt("Q", body, torque.xreplace(in_names)) if any(torque) else {}
        given = sp.Matrix([self.forces.generalised.get(q, sp.S.Zero) for q in self.q])
        return given.xreplace(in_names) + self._by_coordinate(felt)

    @cached_property
    def _solved(self) -> tuple[Solution, Solution]:
        """The names, and their definitions as they are printed.

        Raises ModelError if the mass matrix has no inverse.
        """
        n = len(self.q)
        names, meanings = (
            Solution(sp.eye(n), sp.zeros(n), sp.zeros(n, 1), sp.zeros(n, 1)) for _ in range(2)
        )
        L, D, y, x = names

        def define(which: int, at: tuple[int, int], name: str, value: sp.Expr) -> None:
            symbol = self.names.define(name, value)
            names[which][at] = symbol
            meanings[which][at] = self.names.printed(symbol, value)

        # Column by column: Dⱼ = Mⱼⱼ − Σ_k Lⱼₖ² Dₖ and Lᵢⱼ = (Mᵢⱼ − Σ_k Lᵢₖ Dₖ Lⱼₖ)/Dⱼ over k < j. M
        # is positive definite, so that no pivoting is needed.
        work = self.names.values_of([*self.mass_matrix])
        for j in range(n):
            scaled = D[:j, :j] * L[j, :j].T
            for i in range(j, n):
                rest = self.mass_matrix[i, j] - (L[i, :j] * scaled)[0]
                which, name = (1, f"D{j + 1}") if i == j else (0, f"L{i + 1}_{j + 1}")
                value = rest if i == j else rest / D[j, j]
                define(which, (i, j), name, value)
                work.set(names[which][i, j], work(value))
                if i == j and 0 in work(value):
                    raise ModelError(
                        f"{self.model.name}: the mass matrix has no inverse; expected coordinates "
                        "that move the bodies in different ways"
                    )
        for i in range(n):
            # Forward, yᵢ = Qᵢ − hᵢ − Σ_k Lᵢₖ yₖ over k < i.
            rest = self.generalised[i] - self.bias[i] - (L[i, :i] * y[:i, :])[0]
            define(2, (i, 0), f"y{i + 1}", rest)
        for i in reversed(range(n)):
            # Backward, xᵢ = yᵢ/Dᵢ − Σ_k Lₖᵢ xₖ over k > i.
            rest = (L[i + 1 :, i].T * x[i + 1 :, :])[0]
            define(3, (i, 0), f"ddq{i + 1}", y[i] / D[i, i] - rest)
        return names, meanings

    @property
    def solved(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(self._solved[0].accelerations)

    # What entries ask of a workspace

    @cached_property
    def kinetic(self) -> sp.Expr:
        """T = ½ Σ wᵀ I w + ½ Σ m v²."""
        turning = [(j.omega.T * j.inertia * j.omega)[0] for j in self.joints.values()]
        moving = [p.mass * p.velocity.dot(p.velocity) for p in self.particles]
        return sp.Add(*turning, *moving) / 2

    @cached_property
    def state_derivative(self) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([*self.rates, *self.solved])

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
        import numpy as np  # for matrices of intervals

        turns = {joint.turn for joint in self.joints.values()}
        held = [e for turn in turns for e in (*turn.matrix.diff(TIME), *turn.matrix)]
        held += [e for p in self.particles for e in (*p.slopes_rate, *p.slopes, p.mass)]
        held += [e for joint in self.joints.values() for e in joint.inertia]
        named = [*self.mass_matrix, *self.bias, *self.momenta, self.kinetic]
        work = self.names.values_of([*named, *held, *self.rates, *self.gradient])

        def read(matrix: sp.MatrixBase) -> Any:
            return np.array([[work(entry) for entry in row] for row in matrix.tolist()])

        parts = []  # inertia, J, dJ/dt, and whether it turns
        # Independently of the recursion: J ← Tᵀ J + n ∂θ/∂q from turn to turn, and its time
        # derivative.
        for path, joint in self.joints.items():
            jacobian = rate = np.zeros((3, len(self.q)), int)
            for k, turn in enumerate(path, start=1):
                back, back_rate = read(turn.matrix.T), read(turn.matrix.T.diff(TIME))
                column = sp.Matrix(turn.direction) * self.joints[path[:k]].slopes
                rate = back_rate @ jacobian + back @ rate + read(column.diff(TIME))
                jacobian = back @ jacobian + read(column)
            parts.append((read(joint.inertia), jacobian, rate, True))
        for p in self.particles:
            slopes, one = (p.slopes, p.slopes_rate), np.eye(3, dtype=int)
            parts.append((one * work(p.mass), *map(read, slopes), False))
        q_dot, mass, needed = read(sp.Matrix(self.rates)), 0, read(sp.Matrix(self.gradient))
        # M = Σ Jᵀ I J and h = Σ Jᵀ (I J̇ q̇ + ω × I ω) + ∂V/∂q; a particle has no gyroscopic term.
        for inertia, jacobian, rate, turns_too in parts:
            omega, torque = jacobian @ q_dot, inertia @ rate @ q_dot
            if turns_too:
                torque = torque + np.cross(omega, inertia @ omega, axis=0)
            mass = mass + jacobian.T @ inertia @ jacobian
            needed = needed + jacobian.T @ torque
        # p = M q̇ and 2T = q̇ᵀ M q̇. Intervals are compared: a difference must contain zero.
        momenta = mass @ q_dot
        off = [mass - read(self.mass_matrix), needed - read(self.bias)]
        off += [momenta - read(self.momenta), q_dot.T @ momenta - 2 * work(self.kinetic)]
        if not all(0 in entry for part in off for entry in part.flat):
            raise Defect(
                f"{self.model.name}: the equations of motion are wrong at a point; this is a "
                "defect of rigidsym, please report it"
            )

    def _solves(self, claim: Formula) -> Proof:
        """M = L D Lᵀ, L y = Q − h and D Lᵀ q̈ = y, each row with the definition of its own name."""
        (L, D, y, x), (lower, diagonal, forward, backward) = self._solved
        factors = self.mass_matrix - L * D * L.T + (L - lower) * D + D - diagonal
        needed = self.generalised - sp.Matrix(self.bias)
        residuals = [factors[i, j] for i in range(len(self.q)) for j in range(i + 1)]
        residuals += [*(needed - L * y + y - forward), *(y - D * L.T * x + D * (x - backward))]
        return self.names.vanish(residuals, claim)

    # First integrals

    @cached_property
    def power(self) -> RingMatrix:
        torque = zip(self.forces.torque, OMEGA_BODY, strict=False)
        forces = ((self.forces.generalised.get(q, sp.S.Zero), sp.diff(q, TIME)) for q in self.q)
        return self.codec.column([sp.Add(*(a * b for a, b in (*forces, *torque)))])

    def energy_is_constant(self, claim: Formula) -> Proof:
        return consequence([*self._lemmas, self.prove.vanishes(self.power, claim)], claim)

    def momentum_is_constant(self, k: int, claim: Formula) -> Proof | None:
        # A value at one point refutes it quickly; only what survives is multiplied out and proved.
        rates, work = self._momentum_rates
        residual = rates[k]
        if 0 not in work(residual):
            return None
        for symbol, expression in reversed(self.names.definitions_of([residual])):
            residual = residual.xreplace({symbol: expression})
        return consequence([*self._lemmas, self.names.vanish([residual], claim)], claim)

    @cached_property
    def _momentum_rates(self) -> tuple[sp.Matrix, RealValues]:
        """ṗ = ∂T/∂q + Q − ∂V/∂q, and bounds on its values at a point."""
        slopes = [self._slope_of_kinetic(k) for k in range(len(self.q))]
        rates = sp.Matrix(slopes) + self.generalised - sp.Matrix(self.gradient)
        return rates, self.names.values_of([*rates])

    def _slope_of_kinetic(self, k: int) -> sp.Expr:
        """∂T/∂q."""
        parts = []
        for joint, momentum in self._momenta.items():
            # With the angle θ = θ(q) of a joint, ∂T/∂q = (∂θ/∂q) ∂T/∂θ + (d/dt ∂θ/∂q) ∂T/∂θ̇; the
            # second part vanishes for angles linear in q.
            slope = joint.slopes[k]
            parts.append(-slope * joint.axis.dot(joint.omega.cross(momentum)))
            parts.append(sp.diff(slope, TIME) * joint.axis.dot(momentum))
        parts += [p.mass * p.velocity.dot(p.slopes_rate.col(k)) for p in self.particles]
        return sp.Add(*parts)


# The lemmas


@cache
def of_any_body() -> tuple[Proof, ...]:
    """Lagrange's equations of a body, and the power of its inertia.

    W is a column of its rate matrix, ω its angular velocity, `slope` is ∂ω/∂q and `rate` dω/dt.
    Sums over joints need no lemma: (Tᵀu)·v = u·(Tv) holds for any matrix.
    """
    W, omega, slope, rate = (sp.Matrix(sp.symbols(f"{name}_1:4")) for name in "Wwsr")
    tensor = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j)}{max(i, j)}"))
    gained = slope + W.cross(omega)  # dW/dt
    torque = tensor * rate + omega.cross(tensor * omega)
    momentum = tensor * omega
    # For one column W: d/dt ∂T/∂q̇ = d/dt (W·I ω) = Ẇ·I ω + W·I ω̇ and ∂T/∂q = (∂ω/∂q)·I ω.
    lagrange = gained.dot(momentum) + W.dot(tensor * rate) - slope.dot(momentum) - W.dot(torque)
    power = omega.dot(tensor * rate) - omega.dot(torque)
    claims_of = {
        r"\frac{d}{dt}\frac{\partial T}{\partial\dot\q} - \frac{\partial T}{\partial\q} = "
        rf"\W'^T\left({TORQUE}\right)": lagrange,
        rf"\Om'\cdot({TORQUE}) = \Om'\cdot\I'\,\dot\Om'": power,
    }
    codec = codec_for([*W, *omega, *slope, *rate, *tensor], order=0)
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
    # d(Tᵀ)/dθ. For the old column Tᵀ A the law is dW/dt − Tᵀ s = Tᵀ A × ω, and for the new column
    # n, which is constant, it is −∂ω/∂θ = n × ω.
    slope = back.subs(angle, unknown).diff(unknown).subs(unknown, angle)
    omega = n * speed + back * a
    first = slope * speed * A + back * (s + A.cross(a)) - back * s - (back * A).cross(omega)
    second = -slope * a - n.cross(omega)
    residual = [*first, *second]
    codec = codec_for([*residual, *turn.matrix, *n], constraints=conditions.constraints, order=0)
    claim = formula(r"\dot\W' - \frac{\partial\Om'}{\partial\q} = \W'\times\Om'")
    return Prover(conditions, codec).vanishes(codec.column(residual), claim)
