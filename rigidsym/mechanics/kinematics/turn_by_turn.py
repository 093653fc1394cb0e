"""The kinematics of a long product of turns, by recursions over its turns instead of expansion."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.real_values import RealValues
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Formula, Symbol
from rigidsym.mechanics.derivation import Definition, Found, Proof, Singularities
from rigidsym.mechanics.kinematics.recursion import OrthogonalRows, Recursion
from rigidsym.mechanics.kinematics.recursion_proofs import (
    Encoded,
    gram_of_rows,
    residuals,
    rows_residuals,
)
from rigidsym.mechanics.prove import Prover, identity
from rigidsym.mechanics.quantities import claims
from rigidsym.mechanics.quantities.arguments import arguments_of
from rigidsym.mechanics.quantities.kinematics import (
    ALPHA,
    ALPHA_BODY,
    BODY,
    COSINES,
    RATES,
    ROTATION,
    SPACE,
    Frame,
)
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import hat

_CLOSED_FORM = 3  # turns whose inverse rates and singular places textbooks write out


def is_shorter(model: RotationModel) -> bool:
    """Whether a product of more than three turns is shorter turn by turn than multiplied out."""
    return len(model.turns) > _CLOSED_FORM and _composed(model) < _expanded(model)


def _expanded(model: RotationModel) -> int:
    """About how many operations R takes multiplied out: a product and a sum for each term."""
    terms = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    for turn in model.turns:
        own = [
            [len(sp.Add.make_args(e)) * int(e != 0) for e in row] for row in turn.matrix.tolist()
        ]
        terms = [[sum(row[j] * own[j][k] for j in range(3)) for k in range(3)] for row in terms]
    return 2 * sum(map(sum, terms)) - 9


def _composed(model: RotationModel) -> int:
    """How many operations R takes turn by turn; the product of two turns has hardly any sums."""
    return sum(45 if turn.components else 18 for turn in model.turns[2:]) + 4


class TurnByTurn:
    """The steps of one derivation, each in the names of the recursions."""

    def __init__(self, model: RotationModel) -> None:
        self.model = model
        self.recursion = Recursion(model)
        self._given = {
            argument.name.removeprefix("omega_"): argument.symbols
            for argument in arguments_of(model)
            if argument.name.startswith("omega_")
        }

    def steps(self, only: Collection[str] = ()) -> Iterator[tuple[str, Found]]:
        """(name, what was found) of the quantities that are wanted and that the model has."""
        self.rotation_matrix()  # all else rests on its being a rotation
        for name, find in _STEPS.items():
            if (not only or name in only) and (found := find(self)) is not None:
                yield name, found

    def definitions(self, expressions: Sequence[sp.Basic]) -> tuple[Definition, ...]:
        """The definitions that the expressions rest on, in order."""
        known = {d.symbol: d for d in self.recursion.definitions}
        needed = {s for e in expressions for s in e.free_symbols if s in known}
        for symbol in reversed(known):
            if symbol in needed:
                needed |= known[symbol].expression.free_symbols & known.keys()
        return tuple(d for s, d in known.items() if s in needed)

    # The steps

    def rotation_matrix(self) -> Found:
        symbol = COSINES if self.model.passive else ROTATION
        return Found(
            self._shown(self.recursion.partial[-1]),
            "Turn k has the matrix Tₖ, the axis nₖ and the angle θₖ; the turns are multiplied one "
            "after the other, from left to right"
            + (", and the product is transposed." if self.model.passive else "."),
            (
                self._holds(claims.orthogonal(symbol), *_TURNS),
                self._holds(claims.proper(symbol), *_TURNS),
            ),
            recursion=formula(
                r"#1, \quad \mathbf{P}_k = \mathbf{P}_{k-1}\,\mathbf{T}_k",
                self._shown_formula(formula(rf"\mathbf{{P}}_{{{self.recursion.count}}}")),
            ),
        )

    def rotation_rate(self) -> Found:
        symbol = COSINES if self.model.passive else ROTATION
        spin = hat(self.recursion.omega_space[0])
        return Found(
            self._shown(spin * self.recursion.partial[-1]),
            "The derivative is C(Ω) R" + (", transposed." if self.model.passive else "."),
            (self._holds(claims.stays_orthogonal(symbol), *_SPACE), self._is_operator()),
            recursion=self._shown_formula(formula(r"\mathbf{C}(#1)\,#2", SPACE.omega, ROTATION)),
        )

    def spin_matrix(self) -> Found:
        if self.model.passive:
            spin, symbol = -hat(self.recursion.omega_body[-1]), claims.spin_of(COSINES)
            operator = self._holds(claims.is_operator(BODY.omega, symbol, "-"), *_BODY)
            because = "The derivative times the transpose is the operator of −Ω′, not of Ω."
        else:
            spin, symbol = hat(self.recursion.omega_space[0]), claims.spin_of(ROTATION)
            operator = self._is_operator()
            because = "The derivative times the transpose is the operator of Ω."
        skew = self._holds(claims.skew(symbol), *(_BODY if self.model.passive else _SPACE))
        shown = formula(r"-\mathbf{C}(#1)", BODY.omega)
        if not self.model.passive:
            shown = formula(r"\mathbf{C}(#1)", SPACE.omega)
        return Found(spin, because, (skew, operator), recursion=shown)

    def _is_operator(self) -> Proof:
        return self._holds(claims.is_operator(SPACE.omega, claims.spin_of(ROTATION)), *_SPACE)

    def angular_velocity_space(self) -> Found:
        return Found(
            self.recursion.omega_space[0],
            "Each turn adds its rate about its own axis, and turns what the later turns add.",
            (self._is_operator(),),
            recursion=formula(
                r"\mathbf{u}_1, \quad "
                r"\mathbf{u}_k = \dot{\theta}_k\,\mathbf{n}_k + \mathbf{T}_k\,\mathbf{u}_{k+1}"
            ),
        )

    def angular_velocity_body(self) -> Found:
        claim = claims.rotates(ROTATION, BODY.omega, SPACE.omega)
        return Found(
            self.recursion.omega_body[-1],
            "Seen from the body each turn moves what the turns before it have added.",
            (self._holds(claim, *_SPACE, *_BODY),),
            recursion=formula(
                rf"\mathbf{{w}}_{{{self.recursion.count}}}, \quad \mathbf{{w}}_k = "
                r"\dot{\theta}_k\,\mathbf{n}_k + \mathbf{T}_k^{\mathsf T}\,\mathbf{w}_{k-1}"
            ),
        )

    def rate_matrix(self, frame: Frame) -> Found:
        law = f"axes_{frame.name}"
        claim = claims.maps_rates(frame.matrix, RATES, frame.omega)
        return Found(
            self._rate_matrix(frame),
            "The columns of the rate matrix are the axes of the turns.",
            (self._holds(claim, *(_SPACE if frame is SPACE else _BODY), law),),
            recursion=self._columns(frame),
        )

    def inverse(self, frame: Frame) -> Found | None:
        rows = self._rows(frame)
        if rows is None:
            return None
        units = sp.eye(3)
        columns = [
            self.recursion.least_rates(f"{frame.name}_{k + 1}", rows, units.col(k))
            for k in range(3)
        ]
        return Found(
            sp.ImmutableMatrix(sp.Matrix.hstack(*columns)),
            "q̇ is not unique, since there are more coordinates than dimensions; we choose the "
            "solution of least norm.",
            self._inverts(rows, claims.inverse_of(frame.matrix, self._inverse_symbol(frame))),
            recursion=formula(
                r"#2\left(#1\,#2\right)^{-1}", frame.matrix, claims.transpose_of(frame.matrix)
            ),
        )

    def rates(self, frame: Frame) -> Found | None:
        rows = self._rows(frame)
        if rows is None:
            return None
        claim = claims.solves(frame.matrix, self._inverse_symbol(frame), frame.omega)
        return Found(
            self.recursion.least_rates(frame.name, rows, self._given[frame.name]),
            "The right inverse is applied to a given angular velocity.",
            self._inverts(rows, claim),
            recursion=formula(r"#1\,#2", self._inverse_symbol(frame), frame.omega),
        )

    def acceleration(self, frame: Frame) -> Found:
        recursion = self.recursion
        if frame is SPACE:
            claim = claims.is_operator(ALPHA, claims.rate_of_whole(claims.spin_of(ROTATION)))
            return Found(
                recursion.alpha_space[0],
                "The recursion of the angular velocity is differentiated.",
                (self._holds(claim, *_SPACE, "alpha_space"), self._is_operator()),
                recursion=formula(
                    r"\dot{\mathbf{u}}_1, \quad "
                    r"\dot{\mathbf{u}}_k = \ddot{\theta}_k\,\mathbf{n}_k + "
                    r"\dot{\theta}_k\,\mathbf{n}_k\times\mathbf{u}_k + "
                    r"\mathbf{T}_k\,\dot{\mathbf{u}}_{k+1}"
                ),
            )
        claim = claims.rotates(ROTATION, ALPHA_BODY, ALPHA)
        return Found(
            recursion.alpha_body[-1],
            "The recursion of its body components is differentiated.",
            (self._holds(claim, *_SPACE, *_BODY, "alpha_space", "alpha_body"),),
            recursion=formula(
                rf"\dot{{\mathbf{{w}}}}_{{{recursion.count}}}, \quad \dot{{\mathbf{{w}}}}_k = "
                r"\ddot{\theta}_k\,\mathbf{n}_k - \dot{\theta}_k\,\mathbf{n}_k\times\mathbf{w}_k + "
                r"\mathbf{T}_k^{\mathsf T}\,\dot{\mathbf{w}}_{k-1}"
            ),
        )

    def singularities(self) -> Singularities:
        """The determinant of W Wᵀ, in its names; where it vanishes is not solved for."""
        rows = self._rows(SPACE)
        determinant = sp.Mul(*rows.squares) if rows else None
        return Singularities(
            rank=3 if rows else min(2, len(self.model.coordinates)),
            measure="det W Wᵀ" if rows else "minors",
            determinant=None,  # a name of a recursion, which says nothing by itself
            minors=() if determinant is None else (sp.sqrt(determinant),),
            points=(),
            is_solved=False,
        )

    # Parts of the steps

    def _shown(self, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(matrix.T if self.model.passive else matrix)

    def _shown_formula(self, matrix: Formula) -> Formula:
        if not self.model.passive:
            return matrix
        whole = matrix if isinstance(matrix, Symbol) else Bracket(matrix)
        return claims.transpose_of(whole)

    def _columns(self, frame: Frame) -> Formula | None:
        """(n₁, P₁ n₂, P₂ n₃, ...); None if an angle is not one coordinate by itself."""
        if tuple(self.recursion.angles) != self.model.coordinates:
            return None
        last = self.recursion.count
        columns = [r"\mathbf{n}_1", r"\mathbf{P}_1\,\mathbf{n}_2", r"\ldots"]
        columns.append(rf"\mathbf{{P}}_{{{last - 1}}}\,\mathbf{{n}}_{{{last}}}")
        if frame is BODY:
            columns = [r"\mathbf{B}_2^{\mathsf T}\,\mathbf{n}_1", r"\ldots"]
            columns += [rf"\mathbf{{B}}_{{{last}}}^{{\mathsf T}}\,\mathbf{{n}}_{{{last - 1}}}"]
            columns += [rf"\mathbf{{n}}_{{{last}}}"]
        after = r"" if frame is SPACE else r", \quad \mathbf{B}_k = \mathbf{T}_k\,\mathbf{B}_{k+1}"
        row = " & ".join(columns)
        return formula(rf"\begin{{pmatrix}} {row} \end{{pmatrix}}{after}")

    def _inverse_symbol(self, frame: Frame) -> Formula:
        return frame.inverse if len(self.model.coordinates) == 3 else frame.right_inverse

    def _rate_matrix(self, frame: Frame) -> sp.ImmutableMatrix:
        recursion = self.recursion
        axes = recursion.axes_space if frame is SPACE else recursion.axes_body
        return recursion.rate_matrix(axes)

    def _rows(self, frame: Frame) -> OrthogonalRows | None:
        """The rate matrix in orthogonal rows; None where W has not rank 3 anywhere we look."""
        if frame.name not in self._made and self._is_regular:
            made = self.recursion.orthogonal_rows(frame.name, self._rate_matrix(frame))
            self._made[frame.name] = made
        return self._made.get(frame.name)

    @cached_property
    def _made(self) -> dict[str, OrthogonalRows]:
        return {}

    @cached_property
    def _is_regular(self) -> bool:
        """Whether det W Wᵀ is proved not to be zero at some point."""
        model = self.model
        if len(model.coordinates) < 3:
            return False
        parts = tuple(e for turn in model.turns for e in (turn.angle, *turn.direction))
        found = configurations(model.name, model.constraints, parts, model.example)
        return any(0 not in self._determinant(each.intervals(parts)) for each in found)

    def _determinant(self, work: RealValues) -> Any:
        """Bounds on det W Wᵀ at one point, from the turns themselves."""
        matrix, before = work.context.matrix, work.context.eye(3)
        rates = {q: matrix([0, 0, 0]) for q in self.model.coordinates}
        for turn in self.model.turns:
            axis = before * matrix([work(entry) for entry in turn.direction])
            for q in turn.angle.atoms(AppliedUndef):
                rates[q] += axis * work(sp.diff(turn.angle, q))
            before *= matrix([[work(entry) for entry in row] for row in turn.matrix.tolist()])
        gram = sum((column * column.T for column in rates.values()), matrix(3, 3))
        (a, b, c), (_, d, e), (_, _, f) = gram.tolist()
        return a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c)

    def _inverts(self, rows: OrthogonalRows, claim: Formula) -> tuple[Proof, ...]:
        """W Uᵀ D⁻¹ L⁻¹ = G L⁻ᵀ D⁻¹ L⁻¹, which is 1 if G = L D Lᵀ."""
        gram, product = gram_of_rows()
        columns = self._proved(list(rows_residuals(self.recursion, rows)), claim)
        if not columns.is_exact:
            return (columns,)
        return (identity(gram - product, claim, self.model.name),)

    def _holds(self, claim: Formula, *laws: str) -> Proof:
        """The proof of a claim from laws that hold for every turn."""
        return self._proved([part for law in laws for part in self._residuals(law)], claim)

    def _residuals(self, law: str) -> list[Encoded]:
        if law not in self._by_law:
            self._by_law[law] = list(residuals(self.recursion, law))
        return self._by_law[law]

    @cached_property
    def _by_law(self) -> dict[str, list[Encoded]]:
        return {}

    def _proved(self, parts: Sequence[Encoded], claim: Formula) -> Proof:
        """Exact where all parts are; else the first that is not."""
        proofs = [Prover(self.model, codec).vanishes(residual, claim) for codec, residual in parts]
        return next((proof for proof in proofs if not proof.is_exact), proofs[-1])


_TURNS = ("turns", "product")
_SPACE = (*_TURNS, "omega_space")
_BODY = (*_TURNS, "omega_body")

_STEPS: Mapping[str, Callable[[TurnByTurn], Found | None]] = MappingProxyType(
    {
        "rotation_matrix": TurnByTurn.rotation_matrix,
        "rotation_rate": TurnByTurn.rotation_rate,
        "spin_matrix": TurnByTurn.spin_matrix,
        "angular_velocity_space": TurnByTurn.angular_velocity_space,
        "angular_velocity_body": TurnByTurn.angular_velocity_body,
        "rate_matrix_space": lambda work: work.rate_matrix(SPACE),
        "inverse_rate_matrix_space": lambda work: work.inverse(SPACE),
        "rates_from_angular_velocity_space": lambda work: work.rates(SPACE),
        "rate_matrix_body": lambda work: work.rate_matrix(BODY),
        "inverse_rate_matrix_body": lambda work: work.inverse(BODY),
        "rates_from_angular_velocity_body": lambda work: work.rates(BODY),
        "angular_acceleration_space": lambda work: work.acceleration(SPACE),
        "angular_acceleration_body": lambda work: work.acceleration(BODY),
    }
)
