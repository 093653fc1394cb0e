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
from itertools import product
from typing import Any, NamedTuple, TypeAlias

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.codec import Codec, codec_for
from rigidsym.algebra.evaluate import RealValues
from rigidsym.algebra.matrix import RingMatrix, hat as operator
from rigidsym.algebra.witness import configurations
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Definition, Law, Proof, Quantity
from rigidsym.mechanics.kinematics.workspace import Values, Workspace, traits_of
from rigidsym.mechanics.prove import Conditions, Prover, consequence, identity
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.rotation import TIME, RotationModel, Turn, hat, time_function

Vector: TypeAlias = sp.ImmutableMatrix  # (3, 1)
Matrix: TypeAlias = sp.ImmutableMatrix  # (3, 3)
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


class Part(NamedTuple):
    """A factor of a product at one instant: its rotation with two derivatives, Ω, α and W.

    For both factors Ω and α have the same components in space and in the body.
    """

    R: tuple[RingMatrix, RingMatrix, RingMatrix]
    omega: RingMatrix
    alpha: RingMatrix
    rate_matrix: RingMatrix


class Composition(Values):
    """A turn and any rotation Q, one behind the other, composed by the law.

    R and its derivatives are those of the product, so that the laws of the entries prove the law of
    composition. The axes that Q is relative to are chosen so that Q = 1 at the instant that is
    looked at; then dQ/dt = C(v) and d²Q/dt² = C(dv/dt) + C(v)². Its rates are the components of v.
    """

    _v, _v_dot = sp.symbols("v_1:4"), sp.symbols("dv_1:4")

    def __init__(
        self, turn: Turn, conditions: Conditions, passive: bool, comes_first: bool
    ) -> None:
        self._turn, self._conditions, self._comes_first = turn, conditions, comes_first
        self._is_passive = passive
        self._angles = tuple(sorted(turn.angle.atoms(AppliedUndef), key=str))
        self._speeds = [sp.diff(q, TIME) for q in self._angles]
        self._proofs: dict[tuple[Callable[[Any], Any], Law], Proof] = {}

    @cached_property
    def traits(self) -> frozenset[str]:
        return frozenset(("passive",) if self._is_passive else ())

    @cached_property
    def codec(self) -> Codec:
        angle = self._turn.angle
        rates = [sp.diff(angle, TIME, order) for order in (1, 2)]
        held = [*self._turn.matrix, *self._turn.direction, *self._speeds, *rates]
        return codec_for(
            [*held, *self._v, *self._v_dot], constraints=self._conditions.constraints, order=2
        )

    @cached_property
    def prove(self) -> Prover:
        return Prover(self._conditions, self.codec)

    def argument(self, name: str) -> RingMatrix:
        """The rates, in the order of the factors."""
        assert name == "q_dot"
        rates = (self._speeds, self._v)
        first, second = rates if self._comes_first else rates[::-1]
        return self.codec.column([*first, *second])

    @cached_property
    def parts(self) -> tuple[Part, Part]:
        """The two factors in their order."""
        codec, turn = self.codec, self._turn
        axis, T = codec.column(turn.direction), codec.matrix(turn.matrix)
        speed, gain = (codec.encode(sp.diff(turn.angle, TIME, order)) for order in (1, 2))
        slopes = [codec.encode(sp.diff(turn.angle, q)) for q in self._angles]
        columns = tuple(tuple(codec.ring.dot(((n, s),)) for s in slopes) for n in axis.entries)
        own = Part(
            (T, T.dt(), T.dt().dt()),
            axis.scale(speed),
            axis.scale(gain),
            RingMatrix(codec.ring, columns),
        )
        v, v_dot = codec.column(self._v), codec.column(self._v_dot)
        any_rotation = (self.one, operator(v), operator(v_dot) + operator(v) @ operator(v))
        other = Part(any_rotation, v, v_dot, self.one)
        return (own, other) if self._comes_first else (other, own)

    @cached_property
    def rotation(self) -> RingMatrix:
        first, second = self.parts
        return first.R[0] @ second.R[0]

    @cached_property
    def rotation_rate(self) -> RingMatrix:
        first, second = self.parts
        return first.R[1] @ second.R[0] + first.R[0] @ second.R[1]

    @cached_property
    def spin_rate(self) -> RingMatrix:
        """d²R/dt² Rᵀ + dR/dt dRᵀ/dt."""
        (a, a_dot, a_ddot), (b, b_dot, b_ddot) = (part.R for part in self.parts)
        mixed = a_dot @ b_dot
        second = a_ddot @ b + mixed + mixed + a @ b_ddot
        return second @ self.rotation.T + self.rotation_rate @ self.rotation_rate.T

    @cached_property
    def omega_space(self) -> RingMatrix:
        first, second = self.parts
        return velocity(first.R[0], first.omega, second.omega)

    @cached_property
    def omega_body(self) -> RingMatrix:
        first, second = self.parts
        return velocity(second.R[0].T, second.omega, first.omega)

    @cached_property
    def alpha_space(self) -> RingMatrix:
        first, second = self.parts
        gained = first.omega.cross(self.omega_space)
        return acceleration(first.R[0], first.alpha, gained, second.alpha)

    @cached_property
    def alpha_body(self) -> RingMatrix:
        first, second = self.parts
        gained = self.omega_body.cross(second.omega)
        return acceleration(second.R[0].T, second.alpha, gained, first.alpha)

    def rate_matrix(self, frame: str) -> RingMatrix:
        """(W₁, R₁W₂), and (R₂ᵀW₁′, W₂′) in the body."""
        first, second = self.parts
        left, right = first.rate_matrix, second.rate_matrix
        if frame == "space":
            right = first.R[0] @ right
        else:
            left = second.R[0].T @ left
        rows = (a + b for a, b in zip(left.rows, right.rows, strict=True))
        return RingMatrix(self.codec.ring, tuple(rows))

    def proof(self, quantity: Quantity, law: Law) -> Proof:
        """The proof of a law of an entry."""
        assert quantity.value is not None
        key = quantity.value, law
        if key not in self._proofs:
            residual = law.residual(self, quantity.value(self))
            self._proofs[key] = self.prove.vanishes(residual, law.claim)
        return self._proofs[key]


composed = cache(Composition)  # kept, since the same few axes occur in all chains


def kinds_of(turns: Iterable[Turn], model: RotationModel) -> tuple[tuple[Turn, Conditions], ...]:
    """The different axes with the conditions on them; all angles by one coordinate are alike."""
    kinds = []
    for turn in turns:
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

    def __init__(self, model: RotationModel) -> None:
        self.model = model
        self._meanings: dict[sp.Symbol, sp.Expr] = {}
        self._named: dict[str, tuple[sp.ImmutableMatrix, sp.MatrixBase]] = {}  # and its value
        plain = {q.func.__name__ for q in model.coordinates}
        self._taken = plain | {constant.name for constant in model.constants}

    def define(self, name: str, value: sp.Expr) -> sp.Expr:
        """A symbol for the value, the same each time; a number, an input or a sine of one stays."""
        plain = value.as_coeff_Mul()[1]
        if plain.is_Atom or plain.is_Function or plain.is_Derivative:
            return value
        if self._meanings.get(sp.Symbol(name)) == value:
            return sp.Symbol(name)
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        symbol = sp.Symbol(name)
        self._meanings[symbol] = value
        return symbol

    def named(self, group: str, matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
        """The matrix with a name for each entry that is worth one, group_1 or group_12."""
        places = product(range(1, matrix.rows + 1), range(1, matrix.cols + 1))
        entries = [
            self.define(f"{group}_{row}" + (str(column) if matrix.cols > 1 else ""), entry)
            for (row, column), entry in zip(places, matrix, strict=True)
        ]
        names = sp.ImmutableMatrix(*matrix.shape, entries)
        self._named[group] = names, matrix
        return names

    def opened(self, group: str) -> list[sp.Expr]:
        """The entries of a named matrix, by their definitions as they are printed."""
        return list(map(self.printed, *self._named[group]))

    def printed(self, name: sp.Expr, value: sp.Expr) -> sp.Expr:
        """The definition of a name as it is printed; of a value that has none, the value."""
        return value if name == value else self._meanings[name]

    def definitions_of(self, expressions: Iterable[sp.Basic]) -> tuple[Definition, ...]:
        """The definitions that expressions rest on, each in inputs and those before it."""
        needed = set().union(*(e.free_symbols for e in expressions)) & self._meanings.keys()
        for symbol in reversed(self._meanings):
            if symbol in needed:
                needed |= self._meanings[symbol].free_symbols & self._meanings.keys()
        return tuple(Definition(s, value) for s, value in self._meanings.items() if s in needed)

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

    def is_nonzero(self, value: sp.Expr) -> bool:
        """Whether bounds on the value at one point do not contain zero."""
        return 0 not in self.values_of([value])(value)


class Chain(Names, Workspace):
    """The rotation and the angular velocity of a product of turns, in names for their parts."""

    def __init__(self, model: RotationModel) -> None:
        super().__init__(model)
        self.arguments = {argument.name: argument for argument in arguments_of(model)}
        self.angles = [turn.angle for turn in model.turns]
        self.axes = [sp.ImmutableMatrix(turn.direction) for turn in model.turns]
        self.plain = [turn.matrix for turn in model.turns]
        self.turns = [self.named(f"T{k}", turn) for k, turn in enumerate(self.plain, 1)]
        self.count = len(self.turns)
        self._rate_matrices: dict[str, sp.ImmutableMatrix] = {}
        self._rows: dict[str, OrthogonalRows] = {}
        self._factored: dict[str, list[Proof]] = {}

    @cached_property
    def traits(self) -> frozenset[str]:
        return traits_of(self.model) | {"chain"}

    # The compositions, from the first turn to the last or the other way round

    @cached_property
    def partial(self) -> list[Matrix]:
        """P₀ = 1, P₁, ..., Pₙ."""
        return self._each("P", lambda k, before: before * self.turns[k], start=_ONE)

    @cached_property
    def remaining(self) -> list[Matrix]:
        """B₁, ..., Bₙ, Bₙ₊₁ = 1."""
        return self._each("B", lambda k, b: self.turns[k] * b, is_backwards=True, start=_ONE)

    @cached_property
    def speeds(self) -> list[sp.Expr]:
        """θ̇ of each turn."""
        return [self.define(f"dtheta{k}", sp.diff(a, TIME)) for k, a in enumerate(self.angles, 1)]

    @cached_property
    def gains(self) -> list[sp.Expr]:
        """θ̈ of each turn."""
        angles = enumerate(self.angles, 1)
        return [self.define(f"ddtheta{k}", sp.diff(a, TIME, 2)) for k, a in angles]

    @cached_property
    def _from_space(self) -> list[Vector]:
        """u₁, ..., uₙ, uₙ₊₁ = 0."""
        return self._each(
            "u",
            lambda k, u: velocity(self.turns[k], self.axes[k] * self.speeds[k], u),
            is_backwards=True,
        )

    @cached_property
    def velocities_body(self) -> list[Vector]:
        """w₀ = 0, w₁, ..., wₙ."""
        return self._each(
            "w", lambda k, w: velocity(self.turns[k].T, self.axes[k] * self.speeds[k], w)
        )

    @cached_property
    def omega_space(self) -> Vector:
        return self._from_space[0]

    @cached_property
    def omega_body(self) -> Vector:
        return self.velocities_body[-1]

    @cached_property
    def alpha_space(self) -> Vector:
        """u̇₁."""
        u = self._from_space
        return self._each(
            "du",
            lambda k, du: acceleration(self.turns[k], *self._gained(k, u[k]), du),
            is_backwards=True,
        )[0]

    @cached_property
    def alpha_body(self) -> Vector:
        """ẇₙ."""
        w = self.velocities_body
        return self._each(
            "dw", lambda k, dw: acceleration(self.turns[k].T, *self._gained(k, -w[k + 1]), dw)
        )[-1]

    def _gained(self, k: int, omega: Vector) -> tuple[Vector, Vector]:
        """θ̈ n and θ̇ n × omega of one turn."""
        axis = self.axes[k]
        return axis * self.gains[k], axis.cross(omega) * self.speeds[k]

    def _each(
        self,
        name: str,
        follow: Callable[[int, sp.ImmutableMatrix], sp.ImmutableMatrix],
        *,
        is_backwards: bool = False,
        start: sp.ImmutableMatrix = _ZERO,
    ) -> list[sp.ImmutableMatrix]:
        """What follows turn by turn from `start`, which is last if the last turn comes first."""
        parts = [start]
        for k in reversed(range(self.count)) if is_backwards else range(self.count):
            parts.append(self.named(f"{name}{k + 1}", follow(k, parts[-1])))
        return parts[::-1] if is_backwards else parts

    # What entries ask of a workspace

    @property
    def shown(self) -> Matrix:
        return self.partial[-1].T if self.model.passive else self.partial[-1]

    @property
    def shown_rate(self) -> Matrix:
        rate = hat(self.omega_space) * self.partial[-1]
        return rate.T if self.model.passive else rate

    @property
    def shown_spin(self) -> Matrix:
        return -hat(self.omega_body) if self.model.passive else hat(self.omega_space)

    def rate_matrix(self, frame: str) -> sp.ImmutableMatrix:
        """Columns: what each coordinate turns about, ∂θₖ/∂q times axis k, added up; (3, m)."""
        if frame not in self._rate_matrices:
            carried = self.partial if frame == "space" else [b.T for b in self.remaining[1:]]
            letter = "n" if frame == "space" else "m"  # Pₖ₋₁ nₖ, and Bₖ₊₁ᵀ nₖ in the body
            columns = {q: sp.zeros(3, 1) for q in self.model.coordinates}
            for k, (axis, angle) in enumerate(zip(self.axes, self.angles, strict=True)):
                moved = self.named(f"{letter}{k + 1}", carried[k] * axis)
                for q in angle.atoms(AppliedUndef):
                    columns[q] += moved * sp.diff(angle, q)
            matrix = sp.ImmutableMatrix(sp.Matrix.hstack(*columns.values()))
            self._rate_matrices[frame] = matrix
        return self._rate_matrices[frame]

    def inverse(self, frame: str) -> sp.ImmutableMatrix | None:
        """W⁺, column by column; None if the rates do not give every angular velocity."""
        rows = self.orthogonal_rows(frame)
        if rows is None:
            return None
        units = ((f"{frame}_{k + 1}", sp.eye(3).col(k)) for k in range(3))
        columns = (self._least_rates(label, rows, unit) for label, unit in units)
        return sp.ImmutableMatrix(sp.Matrix.hstack(*columns))

    def rates(self, frame: str) -> sp.ImmutableMatrix | None:
        rows = self.orthogonal_rows(frame)
        omega = self.arguments[f"omega_{frame}"].symbols
        return None if rows is None else self._least_rates(frame, rows, omega)

    def orthogonal_rows(self, frame: str) -> OrthogonalRows | None:
        """The rows of W made orthogonal one after the other (Gram and Schmidt).

        None if W has not rank 3 anywhere we look.
        """
        matrix = self.rate_matrix(frame)
        if frame not in self._rows and self._is_regular:
            r1, r2, r3 = (matrix.row(k) for k in range(3))
            d1 = self.define(f"d1_{frame}", r1.dot(r1))
            l21 = self.define(f"l21_{frame}", r2.dot(r1) / d1)
            l31 = self.define(f"l31_{frame}", r3.dot(r1) / d1)
            u2 = self.named(f"v2_{frame}", r2 - l21 * r1)
            d2 = self.define(f"d2_{frame}", u2.dot(u2))
            l32 = self.define(f"l32_{frame}", r3.dot(u2) / d2)
            u3 = self.named(f"v3_{frame}", r3 - l31 * r1 - l32 * u2)
            squares = (d1, d2, self.define(f"d3_{frame}", u3.dot(u3)))
            self._rows[frame] = OrthogonalRows((r1, u2, u3), squares, (l21, l31, l32))
        return self._rows.get(frame)

    def _least_rates(
        self, name: str, rows: OrthogonalRows, omega: Sequence[sp.Expr]
    ) -> sp.ImmutableMatrix:
        """W⁺ Ω, the rates of least norm that give Ω; (n, 1)."""
        l21, l31, l32 = rows.factors
        y1 = omega[0]
        y2 = self.define(f"y2_{name}", omega[1] - l21 * y1)
        y3 = self.define(f"y3_{name}", omega[2] - l31 * y1 - l32 * y2)
        parts = [
            row.T * self.define(f"z{k}_{name}", y / square)
            for k, (row, y, square) in enumerate(
                zip(rows.rows, (y1, y2, y3), rows.squares, strict=True), 1
            )
        ]
        return sp.ImmutableMatrix(parts[0] + parts[1] + parts[2])

    @cached_property
    def _is_regular(self) -> bool:
        """Whether det W Wᵀ is proved not to be zero at some point."""
        matrix = self.rate_matrix("space")
        first, second, third = ((matrix * matrix.T).col(k) for k in range(3))
        return matrix.cols >= 3 and self.is_nonzero(first.cross(second).dot(third))

    # Steps

    def recursion(self, quantity: Quantity) -> Formula | None:
        text = quantity.recursion.replace("LAST", str(self.count))
        return formula(text.replace("BEFORE", str(self.count - 1))) if text else None

    def proofs(self, quantity: Quantity, _value: Any = None) -> tuple[Proof, ...]:
        """The laws of a quantity, and of those that its value is written with."""
        proofs: list[Proof] = []
        laws = [(quantity, law) for law in quantity.laws]
        others = (KINEMATICS[name].presented(self.traits) for name in quantity.also)
        laws += [(other, law) for other in others for law in other.laws]
        for owner, law in laws:
            if law.is_of_inverse:
                assert quantity.frame is not None
                inverts = self._inverts(quantity.frame.name, law.claim)
                proofs.append(consequence(inverts, law.claim))
            else:
                proved = [each.proof(owner, law) for each in self._compositions]
                # the definitions as they are printed are the compositions, if they differ in form
                for group, (_, value) in self._named.items():
                    pairs = zip(self.opened(group), value, strict=True)
                    differences = [printed - entry for printed, entry in pairs if printed != entry]
                    if differences:
                        proved.append(self.vanish(differences, law.claim))
                proofs.append(consequence(proved, law.claim))
        return tuple(proofs)

    @cached_property
    def _compositions(self) -> tuple[Composition, ...]:
        """Each kind of turn before and behind any rotation."""
        kinds = kinds_of(self.model.turns, self.model)
        return tuple(
            composed(turn, conditions, self.model.passive, comes_first)
            for turn, conditions in kinds
            for comes_first in (True, False)
        )

    def _inverts(self, frame: str, claim: Formula) -> list[Proof]:
        """W Uᵀ D⁻¹ L⁻¹ = G L⁻ᵀ D⁻¹ L⁻¹, which is 1 if G = L D Lᵀ."""
        if frame not in self._factored:
            rows, given = self._rows[frame], self.rate_matrix(frame)
            l21, l31, l32 = rows.factors
            u2 = rows.rows[1]
            opened2, opened3 = self.opened(f"v2_{frame}"), self.opened(f"v3_{frame}")
            gram, factored = gram_of_rows()
            proofs = [identity(gram - factored, claim, self.model.name)]
            for j in range(given.cols):
                # the rows of U; their products are those of the rows of W that G = L D Lᵀ is about
                r1, r2, r3 = given.col(j)
                first, second = r2 - l21 * r1, r3 - l31 * r1 - l32 * u2[j]
                proofs.append(self.vanish([opened2[j] - first, opened3[j] - second], claim))
            self._factored[frame] = proofs
        return self._factored[frame]


class OrthogonalRows(NamedTuple):
    """W = L U with L unit lower triangular and rows of U at right angles, so W Wᵀ = L D Lᵀ.

    W⁺ = Uᵀ D⁻¹ L⁻¹ loses as many digits near a pole as W has lost rank; the determinant of
    W Wᵀ would lose twice as many.
    """

    rows: tuple[sp.ImmutableMatrix, ...]  # of U, each (1, n)
    squares: tuple[sp.Expr, ...]  # the diagonal of D, their squared lengths
    factors: tuple[sp.Expr, ...]  # L21, L31, L32


def gram_of_rows() -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """G = W Wᵀ of free entries, and L D Lᵀ by what the rows of U are defined as."""
    g = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"g{min(i, j) + 1}{max(i, j) + 1}"))
    d1, l21, l31 = g[0, 0], g[0, 1] / g[0, 0], g[0, 2] / g[0, 0]
    d2 = g[1, 1] - 2 * l21 * g[0, 1] + l21**2 * g[0, 0]  # |r2 - l21 r1|²
    l32 = (g[1, 2] - l21 * g[0, 2]) / d2  # r3 · (r2 - l21 r1) over it
    last = sp.Matrix([-l31 + l32 * l21, -l32, 1])  # r3 - l31 r1 - l32 (r2 - l21 r1)
    d3 = (last.T * g * last)[0]
    lower = sp.Matrix([[1, 0, 0], [l21, 1, 0], [l31, l32, 1]])
    return g, sp.ImmutableMatrix(lower * sp.diag(d1, d2, d3) * lower.T)
