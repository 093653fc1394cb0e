r"""Products of turns: one law, by which rotations that turn are composed.

A rotation that turns is a pair (R, Ω). With (R₂, Ω₂) behind it, it is

    (R₁, Ω₁)(R₂, Ω₂) = (R₁R₂, Ω₁ + R₁Ω₂),      d/dt: α = α₁ + Ω₁ × Ω + R₁α₂,

and since the inverse of (R, Ω) is (Rᵀ, −Ω′), the same law in body components reads

    Ω′ = Ω₂′ + R₂ᵀΩ₁′,                          d/dt: α′ = α₂′ + Ω′ × Ω₂′ + R₂ᵀα₁′.

Turn k has the constant axis nₖ and the angle θₖ: it is the pair (Tₖ, θ̇ₖ nₖ). Multiplied out, the
entries of R = T₁ T₂ ⋯ Tₙ have up to 2ⁿ terms; composed with a name for each entry, everything is
linear in n:

    Pₖ = Pₖ₋₁ Tₖ                         R = Pₙ; Pₖ₋₁ nₖ are the axes in space
    Bₖ = Tₖ Bₖ₊₁                         Bₖ₊₁ᵀ nₖ are the axes in the body
    uₖ = θ̇ₖ nₖ + Tₖ uₖ₊₁                 Ω = u₁
    wₖ = θ̇ₖ nₖ + Tₖᵀ wₖ₋₁                Ω′ = wₙ
    u̇ₖ = θ̈ₖ nₖ + θ̇ₖ nₖ × uₖ + Tₖ u̇ₖ₊₁    dΩ/dt = u̇₁
    ẇₖ = θ̈ₖ nₖ − θ̇ₖ nₖ × wₖ + Tₖᵀ ẇₖ₋₁   dΩ′/dt = ẇₙ

The laws of the entries are proved for a turn composed with any rotation, on either side. By
induction over the turns they hold for the chain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache, cached_property
from itertools import product, starmap
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.evaluate import RealValues
from rigidsym.algebra.matrix import RingMatrix, hat as operator
from rigidsym.algebra.witness import configurations
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Definition, Law, Proof, Quantity, argument, needed_of
from rigidsym.mechanics.kinematics.workspace import Values, Workspace, traits_of
from rigidsym.mechanics.prove import Conditions, Prover, consequence
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.table import arguments_of, stems_of
from rigidsym.models.rotation import TIME, RotationModel, Turn, hat, time_function
from rigidsym.system.records import NamedTuple

_WRITTEN_OUT = 3  # turns that textbooks multiply out
_ZERO, _ONE = sp.ImmutableMatrix(sp.zeros(3, 1)), sp.ImmutableMatrix(sp.eye(3))
ANGLE = time_function("angle_of_the_turn")


def is_shorter(model: RotationModel) -> bool:
    """Whether a product of turns is shorter turn by turn than multiplied out.

    Textbooks write out three turns, unless all three axes are symbols: R then has 2,000 operations,
    and proofs about it take minutes. A turn about a slanted axis counts for two, since its matrix
    is full.
    """
    turns = model.turns
    symbolic = {turn.direction for turn in turns if sp.Tuple(*turn.direction).free_symbols}
    slanted = sum(bool(turn.components) for turn in turns)
    is_long = len(turns) > _WRITTEN_OUT and len(turns) + slanted > _WRITTEN_OUT + 1
    return is_long or len(symbolic) >= _WRITTEN_OUT


# The law, over any matrices


def velocity(R: Any, own: Any, other: Any) -> Any:
    """Ω₁ + R₁Ω₂; with R₂ᵀ, Ω₂′ and Ω₁′ it is Ω′."""
    return own + R @ other


def acceleration(R: Any, own: Any, gained: Any, other: Any) -> Any:
    """α₁ + Ω₁ × Ω + R₁α₂; with R₂ᵀ, α₂′, Ω′ × Ω₂′ and α₁′ it is α′."""
    return own + gained + R @ other


# A turn before or behind any rotation


class Composition(Values):
    """A turn and any rotation Q, one behind the other, composed by the law.

    R and its derivatives are those of the product, so that the laws of the entries prove the law of
    composition. The axes that Q is relative to are chosen so that Q = 1 at the instant that is
    looked at; then dQ/dt = C(v) and d²Q/dt² = C(dv/dt) + C(v)². Its rates are the components of v.
    """

    def __init__(self, turn: Turn, conditions: Conditions, passive: bool, is_first: bool) -> None:
        rates, gains = sp.symbols("v_1:4"), sp.symbols("dv_1:4")
        angles = sorted(turn.angle.atoms(AppliedUndef), key=str)
        # An angle may be a combination of coordinates, θ = 2φ − ψ, so its rate is a sum of theirs.
        speed, gain = (sp.diff(turn.angle, TIME, order) for order in (1, 2))
        speeds = [sp.diff(q, TIME) for q in angles]
        entries = [*turn.matrix, *turn.direction, *speeds, speed, gain, *rates, *gains]
        self.codec = codec = codec_for(entries, constraints=conditions.constraints, order=2)
        self.prove = Prover(conditions, codec)
        self.traits = frozenset(("passive",) if passive else ())
        T, axis, v = codec.matrix(turn.matrix), codec.column(turn.direction), codec.column(rates)
        # Ω = n θ̇ = n (∂θ/∂q) q̇, so W = n ∂θ/∂q.
        columns = sp.Matrix(turn.direction) * sp.Matrix([[sp.diff(turn.angle, q) for q in angles]])
        # Of each factor: R with two derivatives, Ω, α, W and q̇. For both, Ω and α have the same
        # components in space and in the body.
        own = (
            (T, T.dt(), T.dt().dt()),
            axis.scale(codec.encode(speed)),
            axis.scale(codec.encode(gain)),
            codec.matrix(columns),
            speeds,
        )
        v_dot = codec.column(gains)
        # dQ/dt = C(v) Q, hence d²Q/dt² = (C(dv/dt) + C(v)²) Q, at Q = 1.
        any_rotation = (self.one, operator(v), operator(v_dot) + operator(v) @ operator(v))
        other = (any_rotation, v, v_dot, self.one, rates)
        first, second = (own, other) if is_first else (other, own)
        (a, a_dot, a_ddot), omega_1, alpha_1, matrix_1, rates_1 = first
        (b, b_dot, b_ddot), omega_2, alpha_2, matrix_2, rates_2 = second
        # The product rule for R = A B: Ṙ = Ȧ B + A Ḃ and R̈ = Ä B + 2 Ȧ Ḃ + A B̈. The spin and its
        # rate follow as Ṙ Rᵀ and R̈ Rᵀ + Ṙ Ṙᵀ, without the law that they are to prove.
        self.rotation = a @ b
        self.rotation_rate = a_dot @ b + a @ b_dot
        mixed = a_dot @ b_dot
        self.spin_rate = (a_ddot @ b + mixed + mixed + a @ b_ddot) @ self.rotation.T
        self.spin_rate += self.rotation_rate @ self.rotation_rate.T
        self.omega_space = velocity(a, omega_1, omega_2)
        self.omega_body = velocity(b.T, omega_2, omega_1)
        # From here on the law itself: Ω = Ω₁ + R₁ Ω₂, and its rate α₁ + Ω₁ × Ω + R₁ α₂.
        self.alpha_space = acceleration(a, alpha_1, omega_1.cross(self.omega_space), alpha_2)
        self.alpha_body = acceleration(b.T, alpha_2, self.omega_body.cross(omega_2), alpha_1)
        # (W₁, R₁W₂), and (R₂ᵀW₁′, W₂′) in the body
        self._rate_matrices = {
            "space": _beside(matrix_1, a @ matrix_2),
            "body": _beside(b.T @ matrix_1, matrix_2),
        }
        # in the order of the factors
        self.arguments = {"q_dot": argument("q_dot", [*rates_1, *rates_2])}


def _beside(left: RingMatrix, right: RingMatrix) -> RingMatrix:
    return RingMatrix(left.ring, tuple(a + b for a, b in zip(left.rows, right.rows, strict=True)))


@cache
def _lemma(work: Composition, value: Callable[[Any], Any], law: Law) -> Proof:
    """The proof of a law of an entry with this value."""
    return work.prove.vanishes(law.residual(work, value(work)), law.claim)


composed = cache(Composition)  # kept, since the same few axes occur in all chains


def kinds_of(turns: Iterable[Turn], model: RotationModel) -> tuple[tuple[Turn, Conditions], ...]:
    """The different axes with the conditions on them; all angles by one coordinate are alike."""
    kinds = []
    for turn in turns:
        # The law for a turn about x does not depend on the name of its angle, so one proof serves
        # all turns about this axis.
        if isinstance(turn.angle, AppliedUndef):
            turn = Turn(axis=turn.axis, components=turn.components, angle=ANGLE)
        symbols = sp.Tuple(*turn.direction).free_symbols
        bound = [c for c in model.constraints if not symbols.isdisjoint(c.free_symbols)]
        conditions = Conditions("a turn", tuple(bound), example=model.example)
        kinds.append((turn, conditions if bound else Conditions("a turn")))
    return tuple(dict.fromkeys(kinds))


# A chain of turns


class Names:
    """Symbols for parts of the expressions about one model, each defined by those before it."""

    def __init__(self, model: RotationModel, taken: Iterable[str] = ()) -> None:
        """`taken` are names that mean something else, as those of a body."""
        self.model = model
        self._meanings: dict[sp.Symbol, sp.Expr] = {}
        plain = {q.func.__name__ for q in model.coordinates}
        self._taken = {*plain, *taken} | {constant.name for constant in model.constants}
        self._stems = stems_of(self._taken)

    def define(self, name: str, value: sp.Expr) -> sp.Expr:
        """A symbol for the value, the same each time; a number, an input or a sine of one stays."""
        # A multiple of a symbol or of a sine costs less than the assignment of a name.
        plain = value.as_coeff_Mul()[1]
        if plain.is_Atom or plain.is_Function or plain.is_Derivative:
            return value
        name = self._stems.get(name[0], name[0]) + name[1:]
        if self._meanings.get(sp.Symbol(name)) == value:
            return sp.Symbol(name)
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        symbol = sp.Symbol(name)
        self._meanings[symbol] = value
        return symbol

    def named(self, group: str, matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
        """The matrix with a name for each entry that is worth one, group_1 or group_12; equal
        entries have one name.
        """
        names: dict[sp.Expr, sp.Expr] = {}
        for place, entry in zip(product(*map(range, matrix.shape)), matrix, strict=True):
            index = "".join(str(k + 1) for k in place[: matrix.cols])
            if entry not in names:
                names[entry] = self.define(f"{group}_{index}", entry)
        return sp.ImmutableMatrix(matrix.applyfunc(names.get))

    def printed(self, name: sp.Expr, value: sp.Expr) -> sp.Expr:
        """The definition of a name as it is printed; of a value that has none, the value."""
        return value if name == value else self._meanings[name]

    def definitions_of(self, expressions: Iterable[sp.Basic]) -> tuple[Definition, ...]:
        """The definitions that expressions rest on, each in inputs and those before it."""
        symbols = set().union(*(expression.free_symbols for expression in expressions))
        return tuple(needed_of([*starmap(Definition, self._meanings.items())], symbols))

    def vanish(self, entries: Sequence[sp.Expr], claim: Formula) -> Proof:
        """The proof that expressions are zero, whatever the names in them stand for."""
        symbols = set().union(*(entry.free_symbols for entry in entries))
        bound = [c for c in self.model.constraints if not symbols.isdisjoint(c.free_symbols)]
        codec = codec_for(entries, constraints=bound)
        return Prover(self.model, codec).vanishes(codec.column(entries), claim)

    def values_of(self, expressions: Sequence[sp.Expr]) -> RealValues:
        """Bounds on the values of expressions in names at one point, and of all that they hold."""
        definitions, model = self.definitions_of(expressions), self.model
        parts = (*(d.expression for d in definitions), *expressions)
        points = configurations(model.name, model.constraints, parts, model.example)
        work = points[0].intervals(parts)
        for symbol, expression in definitions:
            work.set(symbol, work(expression))
        return work


class State(NamedTuple):
    """A partial product of turns with its angular velocity and acceleration, in names."""

    R: sp.ImmutableMatrix = _ONE  # (3, 3)
    omega: sp.ImmutableMatrix = _ZERO  # (3, 1)
    alpha: sp.ImmutableMatrix = _ZERO  # (3, 1)


class Chain(Names, Workspace):
    """The rotation and the angular velocity of a product of turns, in names for their parts."""

    def __init__(self, model: RotationModel, taken: Iterable[str] = ()) -> None:
        super().__init__(model, taken)
        self.arguments = {argument.name: argument for argument in arguments_of(model)}
        self.traits = traits_of(model) | {"chain"}
        self.axes = [sp.ImmutableMatrix(turn.direction) for turn in model.turns]
        self.count, turns = len(model.turns), [*enumerate(model.turns, 1)]
        self.turns = [self.named(f"T{k}", turn.matrix) for k, turn in turns]
        self.speeds = [self.define(f"dtheta{k}", turn.rate) for k, turn in turns]
        self.gains = [self.define(f"ddtheta{k}", sp.diff(turn.rate, TIME)) for k, turn in turns]
        # (1, 0, 0) and (P₁, w₁, ẇ₁), ..., (Pₙ, wₙ, ẇₙ)
        self.from_body = self._states(range(self.count), "w", "P")
        # (B₁, u₁, u̇₁), ..., (Bₙ, uₙ, u̇ₙ) and (1, 0, 0)
        self.from_space = self._states(reversed(range(self.count)), "u", "B")[::-1]
        self.rotation, self.omega_body, self.alpha_body = self.from_body[-1]
        _, self.omega_space, self.alpha_space = self.from_space[0]
        self.rotation_rate = hat(self.omega_space) * self.rotation
        self.shown_spin = -hat(self.omega_body) if model.passive else hat(self.omega_space)

    def _states(self, places: Iterable[int], letter: str, product: str) -> list[State]:
        """The recursion from the identity at rest; each step applies the law to one more turn."""
        states = [State()]
        for k in places:
            T, n, speed, other = self.turns[k], self.axes[k], self.speeds[k], states[-1]
            R, sign = (T * other.R, 1) if letter == "u" else (other.R * T, -1)
            T = T if letter == "u" else T.T
            omega = self.named(f"{letter}{k + 1}", velocity(T, n * speed, other.omega))
            gained = n.cross(sign * omega) * speed
            alpha = acceleration(T, n * self.gains[k], gained, other.alpha)
            R, alpha = self.named(f"{product}{k + 1}", R), self.named(f"d{letter}{k + 1}", alpha)
            states.append(State(R, omega, alpha))
        return states

    def rate_matrix(self, frame: str) -> sp.ImmutableMatrix:
        """Columns: what each coordinate turns about, ∂θₖ/∂q times axis k, added up; (3, m)."""
        letter, carried = "n", [state.R for state in self.from_body]  # Pₖ₋₁ nₖ
        if frame == "body":
            letter, carried = "m", [state.R.T for state in self.from_space[1:]]  # Bₖ₊₁ᵀ nₖ
        # Ω = Σ θ̇ₖ (carried axis k) and θ̇ₖ = Σ (∂θₖ/∂q) q̇, so the column of q is Σ (∂θₖ/∂q)
        # (axis k).
        columns = {q: sp.zeros(3, 1) for q in self.model.coordinates}
        for k, turn in enumerate(self.model.turns):
            moved = self.named(f"{letter}{k + 1}", carried[k] * self.axes[k])
            for q in turn.angle.atoms(AppliedUndef):
                columns[q] += moved * sp.diff(turn.angle, q)
        return sp.ImmutableMatrix(sp.Matrix.hstack(*columns.values()))

    def inverse(self, _frame: str) -> None:
        """None: numbers solve W q̇ = Ω with more digits than a formula for W⁺ in names."""

    rates = inverse

    # Steps

    def extras(self, quantity: Quantity, _value: Any, /) -> dict[str, Any]:
        text = quantity.recursion.replace("LAST", str(self.count))
        text = text.replace("BEFORE", str(self.count - 1))
        return {"recursion": formula(text) if text else None}

    def proofs(self, quantity: Quantity, _value: Any = None) -> tuple[Proof, ...]:
        """The laws of a quantity, and of those that its value is written with."""
        owners = (quantity, *(KINEMATICS[name].presented(self.traits) for name in quantity.also))
        return tuple(
            consequence([_lemma(each, owner.value, law) for each in self._compositions], law.claim)
            for owner in owners
            for law in owner.laws
        )

    @cached_property
    def _compositions(self) -> tuple[Composition, ...]:
        """Each kind of turn before and behind any rotation."""
        kinds = kinds_of(self.model.turns, self.model)
        return tuple(
            composed(turn, conditions, self.model.passive, is_first)
            for turn, conditions in kinds
            for is_first in (True, False)
        )
