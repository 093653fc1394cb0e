"""The rotation and the angular velocity of one model, over its ring: what entries are derived in.

R → dR/dt → dR/dt Rᵀ = C(Ω) → Ω′ = Rᵀ Ω (lecture, eq. 15 and 16), then W = ∂Ω/∂q̇ and its inverse.
Each is worked out when an entry asks for it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache, cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.matrix import Inverse, RingMatrix, hat, unhat
from rigidsym.algebra.present import Presenter, presenter_for
from rigidsym.algebra.ring import Quotient
from rigidsym.algebra.witness import configurations
from rigidsym.errors import DerivationError, NotARotation
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Argument, Proof, Quantity, Step, VectorForm, VectorTerm
from rigidsym.mechanics.prove import Prover, identity
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.parametrisations import AXIS_SEQUENCES, chain
from rigidsym.models.rotation import AXES, TIME, RotationModel, Turn
from rigidsym.system.records import NamedTuple

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody


def traits_of(model: RotationModel) -> frozenset[str]:
    """What variants of the entries ask of a model."""
    q, angles = model.coordinates, [turn.angle for turn in model.turns]
    traits = {
        "passive": model.passive,
        "given": not angles,  # as a matrix, not by turns
        "one_turn": len(angles) == 1,
        "one_coordinate": len(q) == 1,
        "by_turns": len(angles) == len(q) and {*angles} == {*q},  # each by one coordinate
        # Column k of W is then the axis of turn k.
        "in_order": tuple(angles) == q,
        "wide": len(q) != 3,  # W has no inverse, but perhaps a right inverse
        "vector": bool(model.vector),
        "bound": any(condition.has(*q) for condition in model.constraints),
    }
    return frozenset(trait for trait, holds in traits.items() if holds)


class Workspace:
    """What entries are derived in: a ring, its prover, and a printer of its elements."""

    model: RotationModel
    body: RigidBody | None
    arguments: dict[str, Argument]
    codec: Any
    traits: Any  # what variants of the entries ask of it
    has_fixed_point = False  # whether a body turns about a fixed point, not its centre of mass

    @cached_property
    def prove(self) -> Prover:
        return Prover(self.model, self.codec)

    @cached_property
    def present(self) -> Presenter:
        return presenter_for(self.codec)

    @cached_property
    def inertia(self) -> RingMatrix:
        assert self.body is not None
        return self.codec.matrix(self.body.inertia)

    def scalar(self, element: PolyElement) -> RingMatrix:
        return RingMatrix.column(self.codec.ring, [element])

    def step(self, entry: Quantity) -> Step | None:
        """The value of an entry, with the proofs of its laws; None if the model has no such value.

        Raises NotARotation if the laws of the rotation matrix are false, showing what is left over.
        """
        quantity = entry.presented(self.traits)
        assert quantity.value is not None
        value = quantity.value(self)
        if value is None:
            return None
        proofs, extras = self.proofs(quantity, value), self.extras(quantity, value)
        if form := extras.get("vector_form"):
            proofs += (form.proof,)
        if quantity.unit_of:  # none if its components differ
            units = {*self.arguments[quantity.unit_of].units}
            quantity = quantity._replace(unit=units.pop() if len(units) == 1 else "")
        return Step(
            quantity=quantity,
            expression=self._printed(value),
            proofs=proofs,
            words=quantity.words(self) if quantity.words else "",
            **extras,
        )

    def _printed(self, value: Any) -> sp.ImmutableMatrix:
        """A value as it is shown: read from the ring, over its divisor, or as it is."""
        match value:
            case (matrix, below):
                value = self.present.matrix(matrix, below)
            case RingMatrix():
                value = self.present.matrix(value)
            case sp.Expr():
                value = sp.Matrix([value])
        return sp.ImmutableMatrix(value)

    def extras(self, _quantity: Quantity, _value: Any, /) -> dict[str, Any]:
        """What else a step shows: its form by the vector of the coordinates, its recursion."""
        return {}

    def proofs(self, quantity: Quantity, value: Any) -> tuple[Proof, ...]:
        """What a quantity rests on, and the proofs of its laws."""
        proofs = list(quantity.rests_on(self)) if quantity.rests_on else []
        error = NotARotation if quantity.name == "rotation_matrix" else DerivationError
        for law in quantity.laws:
            residual = law.residual(self, value)
            divisors = [*value[1:]] if isinstance(value, tuple) else []
            if isinstance(residual, tuple):
                residual, *divisors = residual
            if isinstance(residual, sp.MatrixBase):  # in the constants of the body
                assert self.body is not None
                proofs.append(identity(residual, law.claim, self.body.name))
            elif residual is not None:
                proofs.append(self.prove.vanishes(residual, law.claim, *divisors, error=error))
        return tuple(proofs)


class Values(Workspace):
    """R, dR/dt, Ω, Ω′, W, W′ and the inverses of one model, worked out when asked for."""

    def __init__(
        self, model: RotationModel, body: RigidBody | None = None, also: Iterable[sp.Expr] = ()
    ) -> None:
        """`also`: expressions for the ring to hold beside those of the model and the body."""
        self.model = model
        self.body = body
        self.arguments = {argument.name: argument for argument in arguments_of(model, body)}
        self._also = tuple(also)
        self._rate_matrices: dict[str, RingMatrix] = {}
        self._inverses: dict[str, Inverse | None] = {}

    @cached_property
    def traits(self) -> frozenset[str]:
        return traits_of(self.model)

    @cached_property
    def codec(self) -> Codec:
        model, body = self.model, self.body
        if model.constraints:  # before the ring, which contradictory ones would make endless
            configurations(model.name, model.constraints, (), model.example)
        # an energy holds no accelerations, and where constraints relate them to rates none may be
        # taken for an energy
        left_out = ("q", "q_ddot") if body else ("q",)
        inputs = [s for n, a in self.arguments.items() if n not in left_out for s in a.symbols]
        # a ring that holds the turns holds their product, and they are shorter to read
        held = [e for turn in model.turns for e in turn.matrix.flat()] or [*model.matrix]
        if body is not None:
            held += [body.mass, *body.inertia]
        inputs += [*held, *self._also]
        return codec_for(inputs, constraints=model.constraints, order=1 if body else 2)

    @cached_property
    def one(self) -> RingMatrix:
        return RingMatrix.identity(self.codec.ring, 3)

    def argument(self, name: str) -> RingMatrix:
        """The components of an argument as a column."""
        return self.codec.column(self.arguments[name].symbols)

    # The rotation that turns

    @cached_property
    def rotation(self) -> RingMatrix:
        return self.codec.matrix(self.model.matrix)

    @cached_property
    def rotation_rate(self) -> RingMatrix:
        return self.rotation.dt()

    @cached_property
    def spin(self) -> RingMatrix:
        """dR/dt Rᵀ."""
        return self.rotation_rate @ self.rotation.T

    @cached_property
    def spin_rate(self) -> RingMatrix:
        return self.spin.dt()

    @cached_property
    def omega_space(self) -> RingMatrix:
        # R Rᵀ = 1 gives Ṙ Rᵀ + (Ṙ Rᵀ)ᵀ = 0. The spin is skew, so it is C(Ω) for one vector Ω.
        return unhat(self.spin)

    @cached_property
    def omega_body(self) -> RingMatrix:
        # Rᵀ C(Ω) R = C(Rᵀ Ω), so Ω′ = Rᵀ Ω, or directly C(Ω′) = Rᵀ Ṙ.
        if self.model.pullback is None:
            return self.rotation.T @ self.omega_space
        # for the ring of a pullback, RᵀΩ would not become shorter
        return unhat(self.rotation.T @ self.rotation_rate)

    @cached_property
    def alpha_space(self) -> RingMatrix:
        return self.omega_space.dt()

    @cached_property
    def alpha_body(self) -> RingMatrix:
        return self.omega_body.dt()

    @property
    def shown_spin(self) -> RingMatrix:
        """dR/dt Rᵀ, or dA/dt Aᵀ."""
        return self.rotation_rate.T @ self.rotation if "passive" in self.traits else self.spin

    # The rates of the coordinates

    def omega(self, frame: str) -> RingMatrix:
        return self.omega_space if frame == "space" else self.omega_body

    def rate_matrix(self, frame: str) -> RingMatrix:
        """W = ∂Ω/∂q̇ or W′.

        By the generators of the rates themselves, since a constraint may relate them.
        """
        if frame not in self._rate_matrices:
            index = self.codec.ring.index
            places = [index[q] for q in self.arguments["q_dot"].symbols]
            # Ω is linear in the rates, Ω = W q̇, so W is its Jacobian.
            self._rate_matrices[frame] = self.omega(frame).jacobian(places)
        return self._rate_matrices[frame]

    def inverse(self, frame: str) -> Inverse | None:
        """The right inverse of the rate matrix of a frame; None if it has none."""
        if frame not in self._inverses:
            ring, rotation = self.codec.ring, self.rotation
            if tuple(self.model.matrix) == self.model.coordinates:
                # Ṙ = C(Ω) R = R C(Ω′)
                # the coordinates are the entries of R: columns are dR/dt of unit velocities
                skew = [hat(RingMatrix.column(ring, e)) for e in self.one.rows]
                rates = [s @ rotation if frame == "space" else rotation @ s for s in skew]
                self._inverses[frame] = RingMatrix.of(ring, (r.entries for r in rates)).T, ring.one
            else:
                self._inverses[frame] = self.rate_matrix(frame).right_inverse(self.bound)
        return self._inverses[frame]

    def rates(self, frame: str) -> Inverse | None:
        """The inverse times the angular velocity as an argument, q̇ = W⁻¹ Ω."""
        inverse = self.inverse(frame)
        return inverse and (inverse[0] @ self.argument(f"omega_{frame}"), inverse[1])

    def excess(
        self, frame: str, above: RingMatrix, below: PolyElement, goal: RingMatrix
    ) -> RingMatrix:
        """W (above/below) − goal, times the divisor."""
        # Times the divisor, the residual is a polynomial.
        return self.rate_matrix(frame) @ above - goal.scale(below)

    @cached_property
    def bound(self) -> RingMatrix | None:
        """J = ∂(constraints)/∂q, (m, n); None if no constraint binds a coordinate."""
        coordinates = self.model.coordinates
        binding = [c for c in self.model.constraints if c.has(*coordinates)]
        # f(q) = 0 for all time implies (∂f/∂q) q̇ = 0.
        rows = [[sp.diff(c, q) for q in coordinates] for c in binding]
        return self.codec.matrix(sp.Matrix(rows)) if rows else None

    def extras(self, quantity: Quantity, value: Any, /) -> dict[str, Any]:
        return {"vector_form": vector_form(self, quantity, value)}


# Euler angles: twelve orders of axes need four derivations


class Renamed(Values):
    """Euler angles, derived as those whose first turn is about z.

    To rename the axes z → x → y → z, in space and in the body, is a rotation P, which permutes
    components. Turns about the renamed axes give P R Pᵀ, hence P Ω, P W and W⁻¹ Pᵀ, and q̇ with
    the components of Ω renamed: `axes` of an entry states which. The residuals of their laws have
    the entries that the ring has reduced to zero, in another order: P R Pᵀ (P R Pᵀ)ᵀ − 1 is
    P (R Rᵀ − 1) Pᵀ. An entry that states no `axes` is derived for each model by itself.
    """

    def __init__(self, model: RotationModel) -> None:
        super().__init__(model)
        first = AXES.index(model.turns[0].axis)
        self.moves = [(k - first - 1) % 3 for k in range(3)]  # x, y and z are these before
        axes = {AXES[k]: AXES[m] for k, m in enumerate(self.moves)}
        turns = tuple(replace(turn, axis=axes[turn.axis]) for turn in model.turns)
        self.original, self._steps = _original(turns, model.coordinates, model.passive)

    def step(self, entry: Quantity) -> Step | None:
        if entry.axes is None:
            return super().step(entry)
        if entry.name not in self._steps:
            self._steps[entry.name] = self.original.step(entry)
        step, moves = self._steps[entry.name], self.moves
        if step is None or moves == [0, 1, 2]:
            return step
        omegas = [self.arguments[n].symbols for n in entry.inputs if n.startswith("omega")]
        names = {omega[m]: omega[k] for omega in omegas for k, m in enumerate(moves)}
        expression = step.expression.xreplace(names) if names else step.expression
        rows, columns = (moves if n in entry.axes else slice(None) for n in ("rows", "columns"))
        original = step.expression, names
        return replace(step, expression=expression[rows, columns], original=original)


@lru_cache(maxsize=32)
def _original(
    turns: tuple[Turn, ...], coordinates: tuple[sp.Expr, ...], passive: bool
) -> tuple[Values, dict[str, Step | None]]:
    """The workspace of Euler angles, and the steps that it has derived so far."""
    # Forms of an extrinsic sequence are not those of the reverse intrinsic one with the angles
    # renamed: of equally short ones the first is taken, by the order of the coordinates.
    return Values(replace(chain(turns, passive=passive), coordinates=coordinates)), {}


def values_of(model: RotationModel) -> Values:
    """The workspace of a model. Euler angles that differ only in the names of axes share one."""
    # Only turns are shared: a model with conditions or units of its own is derived by itself.
    own = model.constraints, model.pullback, model.units, *(t.components for t in model.turns)
    is_euler = not any(own) and "".join(turn.axis for turn in model.turns) in AXIS_SEQUENCES
    if is_euler and "by_turns" in traits_of(model):
        renamed = Renamed(model)
        # All depends on this: R is P R Pᵀ of the original, entry by entry.
        if model.matrix == renamed.original.model.matrix[renamed.moves, renamed.moves]:
            return renamed
    return Values(model)


# R, Ω and the rates by the vector v of the coordinates: R = 1 + a C(v) + b C(v)², Ω = f v̇ + ...
# The coefficients are those of textbooks, as functions of n = |v| and of the coordinate that is not
# in v. Each form is proved equal to all entries for every v, as it is printed.

LENGTH = sp.Symbol("n", positive=True)  # |v|
V, V_DOT = formula(r"\v"), formula(r"\dot\v")
_BASES = tuple(map(formula, (r"\1", r"\C(\v)", r"\C(\v)^{2}", r"\v\,\v^T", r"\v^T")))
_APPLIED = ("#1", r"\v\times #1", r"\v\times(\v\times #1)", r"(\v\cdot #1)\,\v", r"\v\cdot #1")
CROSS, TWICE = (formula(text, V_DOT) for text in _APPLIED[1:3])

_OTHER = sp.Symbol("w")  # the coordinate that is not in v
_HALF = sp.Rational(1, 2)
Coefficients = tuple[sp.Expr | int, ...]


class Form(NamedTuple):
    """Coefficients of 1, C(v), C(v)² and v vᵀ; in Ω of v̇, v × v̇ and v × (v × v̇)."""

    rotation: Coefficients
    along: sp.Expr | int = 0  # of v in Ω, times the rate of the other coordinate
    inverse: Coefficients = ()  # W⁻¹, if it has three columns of v
    last: int = 0  # of vᵀ, in the row of the other coordinate
    velocity: Coefficients = ()  # unless it equals those of C(v) and C(v)² in R


@cache
def forms() -> dict[tuple[str, int], Form]:
    """By the kind of definition and the number of coordinates."""
    n, w = LENGTH, _OTHER
    sine, rest = sp.sin(n), 1 - sp.cos(n)
    square, gibbs = n**2 + w**2, 2 / (n**2 + 1)
    bracket = (-n * sine - 2 * sp.cos(n) + 2) / (2 * n**2 * rest)
    quarter = sp.Mul(sp.Rational(1, 4), 1 - n**2, evaluate=False)
    modified = 8 / (n**2 + 1) ** 2
    outer = -_HALF * (sp.sin(w) / (1 - sp.cos(w)))
    half_and_outer = (_HALF, -_HALF, 0, _HALF)
    return {
        ("unit_quaternion", 4): Form((1, 2 * w, 2), -2),
        ("quaternion", 4): Form((1, 2 * w / square, 2 / square), -2 / square),
        ("quaternion", 3): Form((1, gibbs, gibbs), inverse=half_and_outer),
        ("axis_angle", 4): Form((1, sp.sin(w), 1 - sp.cos(w)), 1, (0, -_HALF, outer), last=1),
        ("axis_angle", 3): Form(
            (1, sine / n, rest / n**2),
            inverse=(1, -_HALF, bracket),
            velocity=(1, rest / n**2, (n - sine) / n**3),
        ),
        ("modified_rodrigues", 3): Form(
            (1, 4 * ((1 - n**2) / (n**2 + 1) ** 2), modified),
            inverse=(quarter, *half_and_outer[1:]),
            velocity=(4 / (n**2 + 1), modified, modified),
        ),
    }


def vector_form(k: Any, quantity: Quantity, value: Any) -> VectorForm | None:
    """The quantity in terms of the vector of the coordinates; None if there is no such form.

    `k` is the workspace of the quantity (`kinematics.workspace`).
    """
    model, kind, symbol = k.model, quantity.vectors, quantity.symbol
    head = model.definition.partition("(")[0]
    form = forms().get((head, len(model.coordinates))) if model.vector else None
    others = [q for q in model.coordinates if q not in model.vector]
    if form is None or not kind or (kind == "rate_matrix" and others):
        return None
    v = k.codec.column(model.vector)
    names, bases = list(_BASES), [k.one, hat(v), hat(v) @ hat(v), v @ v.T, v.T]
    by_kind = {"rotation": form.rotation, "inverse": form.inverse, "rates": form.inverse}
    coefficients = by_kind.get(kind, form.velocity or (*form.rotation[1:], 0))
    text = r"#1\text{ in terms of }\v"
    factor = V_DOT  # that the matrices are applied to
    if kind in ("velocity", "rates"):
        if kind == "velocity":
            coefficients = (*coefficients, *(form.along * sp.diff(q, TIME) for q in others))
            u = k.codec.column([sp.diff(x, TIME) for x in model.vector])
        else:
            assert quantity.frame is not None
            factor, u = quantity.frame.omega, k.argument(f"omega_{quantity.frame.name}")
        bases = [basis @ u for basis in bases]
        names, text = [formula(each, factor) for each in _APPLIED], text + ", #2"
    if kind == "velocity":
        names[3], bases[3] = V, v
    # C(v) changes its sign with the direction of the turn
    is_backwards = model.passive if quantity.frame is None else quantity.frame.prime != ""
    terms, vectors = [], []
    for place, coefficient in enumerate(map(sp.sympify, coefficients)):
        if coefficient:
            own = coefficient.xreplace(dict(zip([_OTHER], others, strict=False)))
            above, below = sp.fraction(own)
            own = -above / below if place == 1 and is_backwards else own
            terms.append(VectorTerm(own, names[place]))
            vectors.append(bases[place])
    if not terms:
        return None
    matrix, divisor = value if isinstance(value, tuple) else (value, k.codec.ring.one)
    blocks, last = [(terms, vectors, matrix.rows[:3])], None
    if form.last and len(matrix.rows) > 3:
        last = VectorTerm(sp.Integer(form.last), names[4])
        blocks.append(([last], bases[4:], matrix.rows[3:]))
    # The printed terms less the entries over their divisor, with |v| = √(v·v).
    ring, length = k.codec.ring, sp.sqrt(sum(part**2 for part in model.vector))
    residual: list[Quotient] = []
    for own_terms, own_vectors, rows in blocks:
        entries = [Quotient(ring, -entry, divisor) for row in rows for entry in row]
        for term, vector in zip(own_terms, own_vectors, strict=True):
            scale = k.codec.encode_quotient(term.coefficient.xreplace({LENGTH: length}))
            for place, entry in enumerate(vector.entries):
                entries[place] += scale * Quotient.whole(ring, entry)
        residual += entries
    return VectorForm(
        terms=tuple(terms),
        components=model.vector,
        length=LENGTH,
        proof=k.prove.cancel(residual, formula(text, symbol, factor)),
        last=last,
    )
