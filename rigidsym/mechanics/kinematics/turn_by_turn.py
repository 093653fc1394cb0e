"""The kinematics of a long product of turns, by recursions over its turns instead of expansion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.configuration import configurations
from rigidsym.algebra.real_values import RealValues
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Formula, Symbol, transpose_of
from rigidsym.mechanics.derivation import Definition, Found, Proof, Singularities
from rigidsym.mechanics.kinematics.derive import (
    FRAMES,
    WORDS,
    Kinematics,
    kind_and_frame,
)
from rigidsym.mechanics.kinematics.recursion import OrthogonalRows, Recursion
from rigidsym.mechanics.kinematics.recursion_proofs import (
    Encoded,
    gram_of_rows,
    residuals,
    rows_residuals,
)
from rigidsym.mechanics.prove import Prover, consequence, identity
from rigidsym.mechanics.quantities.kinematics import BODY, IS_OPERATOR, ROTATION, SPACE
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.rotation import RotationModel, hat


class TurnByTurn(Kinematics):
    """The steps of one derivation, each in the names of the recursions."""

    def __init__(self, model: RotationModel) -> None:
        super().__init__(model)
        self.recursion = Recursion(model)
        self._given = {a.name: a.symbols for a in arguments_of(model)}
        self._proved: dict[str, list[Proof]] = {}  # of the laws of the turns
        self._made: dict[str, OrthogonalRows] = {}

    def find(self, names: Sequence[str]) -> dict[str, Found]:
        return {name: found for name in names if (found := self._found(name)) is not None}

    def _found(self, name: str) -> Found | None:
        expression = self._expression(name)
        if expression is None:
            return None
        kind, _ = kind_and_frame(name)
        words, recursion = _WORDS[name if name in _WORDS else kind]
        words = words or WORDS[name]
        if self.model.passive and name in _PASSIVE_WORDS:
            words, recursion = _PASSIVE_WORDS[name]
        return Found(
            sp.ImmutableMatrix(expression),
            words,
            tuple(self.proofs(name)),
            recursion=self._columns(name)
            if kind == "rate_matrix"
            else self._formula(name, recursion),
        )

    def definitions(self, expressions: Sequence[sp.Basic]) -> tuple[Definition, ...]:
        """The definitions that the expressions rest on, in order."""
        known = {d.symbol: d for d in self.recursion.definitions}
        needed = {s for e in expressions for s in e.free_symbols if s in known}
        for symbol in reversed(known):
            if symbol in needed:
                needed |= known[symbol].expression.free_symbols & known.keys()
        return tuple(d for s, d in known.items() if s in needed)

    def _expression(self, name: str) -> sp.MatrixBase | None:
        """The quantity in the names of the recursions; None if the model does not have it."""
        r, (kind, frame) = self.recursion, kind_and_frame(name)
        is_in_space, passive = frame == "space", self.model.passive
        match kind:
            case "rotation_matrix" | "rotation_rate":
                matrix = r.partial[-1]
                if kind == "rotation_rate":
                    matrix = hat(r.omega_space[0]) * matrix
                return matrix.T if passive else matrix
            case "spin_matrix":
                return -hat(r.omega_body[-1]) if passive else hat(r.omega_space[0])
            case "angular_velocity":
                return r.omega_space[0] if is_in_space else r.omega_body[-1]
            case "angular_acceleration":
                return r.alpha_space[0] if is_in_space else r.alpha_body[-1]
            case "rate_matrix":
                return r.rate_matrix(r.axes_space if is_in_space else r.axes_body)
            case "inverse_rate_matrix" | "rates_from_angular_velocity":
                pass
            case _:
                raise LookupError(f"no recursion for {name}; add one in {__name__}")
        rows = self._rows(frame)
        if rows is None:
            return None
        if kind == "rates_from_angular_velocity":
            return r.least_rates(frame, rows, self._given[f"omega_{frame}"])
        units = ((f"{frame}_{k + 1}", sp.eye(3).col(k)) for k in range(3))
        return sp.Matrix.hstack(*(r.least_rates(label, rows, unit) for label, unit in units))

    def singularities(self) -> Singularities:
        """The determinant of W Wᵀ, in its names; where it vanishes is not solved for."""
        rows = self._rows("space")
        determinant = sp.Mul(*rows.squares) if rows else None
        return Singularities(
            rank=3 if rows else min(2, len(self.model.coordinates)),
            measure="det W Wᵀ" if rows else "minors",
            determinant=None,  # a name of a recursion, which says nothing by itself
            minors=() if determinant is None else (sp.sqrt(determinant),),
            points=(),
            is_solved=False,
        )

    # The recursions as they are printed

    def _formula(self, name: str, recursion: str) -> Formula:
        """#1: W, Ω, ..., what the quantity is made of; #2: its transpose or the right inverse."""
        _, frame = kind_and_frame(name)
        symbols = FRAMES.get(frame, SPACE)
        parts = {
            "rotation_rate": (SPACE.omega, ROTATION),
            "spin_matrix": (BODY.omega if self.model.passive else SPACE.omega,),
            f"inverse_rate_matrix_{frame}": (symbols.matrix, transpose_of(symbols.matrix)),
            f"rates_from_angular_velocity_{frame}": (self.inverse_symbol(symbols), symbols.omega),
        }
        whole = formula(recursion.replace("LAST", str(self.recursion.count)), *parts.get(name, ()))
        if name == "rotation_matrix":
            partial = formula(rf"\mathbf{{P}}_{{{self.recursion.count}}}")
            return formula(r"#1, \quad #2", self._shown(partial), whole)
        return self._shown(whole) if name == "rotation_rate" else whole

    def _shown(self, matrix: Formula) -> Formula:
        if not self.model.passive:
            return matrix
        return transpose_of(matrix if isinstance(matrix, Symbol) else Bracket(matrix))

    def _columns(self, name: str) -> Formula | None:
        """(n₁, P₁ n₂, P₂ n₃, ...); None if an angle is not one coordinate by itself."""
        if tuple(self.recursion.angles) != self.model.coordinates:
            return None
        last = self.recursion.count
        columns = [r"\mathbf{n}_1", r"\mathbf{P}_1\,\mathbf{n}_2", r"\ldots"]
        columns.append(rf"\mathbf{{P}}_{{{last - 1}}}\,\mathbf{{n}}_{{{last}}}")
        if name == "rate_matrix_body":
            columns = [r"\mathbf{B}_2^{\mathsf T}\,\mathbf{n}_1", r"\ldots"]
            columns += [rf"\mathbf{{B}}_{{{last}}}^{{\mathsf T}}\,\mathbf{{n}}_{{{last - 1}}}"]
            columns += [rf"\mathbf{{n}}_{{{last}}}"]
        after = (
            r""
            if name == "rate_matrix_space"
            else r", \quad \mathbf{B}_k = \mathbf{T}_k\,\mathbf{B}_{k+1}"
        )
        row = " & ".join(columns)
        return formula(rf"\begin{{pmatrix}} {row} \end{{pmatrix}}{after}")

    # Proofs

    def proofs(self, name: str) -> Iterator[Proof]:
        """The proofs of a quantity; where C(Ω) is printed, also that it is dR/dt Rᵀ."""
        kind, frame = kind_and_frame(name)
        is_operator = name in ("rotation_rate", "spin_matrix", "angular_acceleration_space")
        extra = is_operator and not (name == "spin_matrix" and self.model.passive)
        for law, claim in (*self.laws[name], *((IS_OPERATOR,) if extra else ())):
            if kind in ("inverse_rate_matrix", "rates_from_angular_velocity"):
                yield self._inverts(frame, claim)
            else:
                yield consequence([p for part in _RESTS_ON[law] for p in self._holds(part)], claim)

    def _inverts(self, frame: str, claim: Formula) -> Proof:
        """W Uᵀ D⁻¹ L⁻¹ = G L⁻ᵀ D⁻¹ L⁻¹, which is 1 if G = L D Lᵀ."""
        rows = self._made[frame]
        columns = self._vanish(rows_residuals(self.recursion, rows), claim)
        gram, product = gram_of_rows()
        return consequence([*columns, identity(gram - product, claim, self.model.name)], claim)

    def _holds(self, law: str) -> list[Proof]:
        """The proofs of a law for every turn."""
        if law not in self._proved:
            self._proved[law] = self._vanish(residuals(self.recursion, law), formula(_LAWS[law]))
        return self._proved[law]

    def _vanish(self, parts: Iterable[Encoded], claim: Formula) -> list[Proof]:
        return [Prover(self.model, codec).vanishes(residual, claim) for codec, residual in parts]

    # Where the rates fail

    def _rows(self, frame: str) -> OrthogonalRows | None:
        """The rate matrix in orthogonal rows; None where W has not rank 3 anywhere we look."""
        if frame not in self._made and self._is_regular:
            matrix = self._expression(f"rate_matrix_{frame}")
            self._made[frame] = self.recursion.orthogonal_rows(frame, matrix)
        return self._made.get(frame)

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


_LAWS = {  # of every turn, in the names of the recursions
    "turns": r"\mathbf{T}_k\,\mathbf{T}_k^{\mathsf T} = \mathbf{1}",
    "product": r"\mathbf{P}_k = \mathbf{P}_{k-1}\,\mathbf{T}_k",
    "axes_space": r"\mathbf{a}_k = \mathbf{P}_{k-1}\,\mathbf{n}_k",
    "axes_body": r"\mathbf{B}_k = \mathbf{T}_k\,\mathbf{B}_{k+1}",
    "omega_space": r"\mathbf{u}_k = \dot{\theta}_k\,\mathbf{n}_k + \mathbf{T}_k\,\mathbf{u}_{k+1}",
    "omega_body": r"\mathbf{w}_k = \dot{\theta}_k\,\mathbf{n}_k + "
    r"\mathbf{T}_k^{\mathsf T}\,\mathbf{w}_{k-1}",
    "alpha_space": r"\dot{\mathbf{u}}_k = \ddot{\theta}_k\,\mathbf{n}_k + "
    r"\dot{\theta}_k\,\mathbf{n}_k\times\mathbf{u}_k + \mathbf{T}_k\,\dot{\mathbf{u}}_{k+1}",
    "alpha_body": r"\dot{\mathbf{w}}_k = \ddot{\theta}_k\,\mathbf{n}_k - "
    r"\dot{\theta}_k\,\mathbf{n}_k\times\mathbf{w}_k + "
    r"\mathbf{T}_k^{\mathsf T}\,\dot{\mathbf{w}}_{k-1}",
}
_TURNS = ("turns", "product")
_SPACE = (*_TURNS, "omega_space")
_BODY = (*_TURNS, "omega_body")
_RESTS_ON = {  # the laws of the turns that a law of the product follows from
    "orthogonal": _TURNS,
    "proper": _TURNS,
    "skew": (*_SPACE, "omega_body"),
    "passive_operator": _BODY,
    "angular_velocity_space": _SPACE,
    "angular_velocity_body": (*_SPACE, "omega_body"),
    "rate_matrix_space": (*_SPACE, "axes_space"),
    "rate_matrix_body": (*_BODY, "axes_body"),
    "angular_acceleration_space": (*_SPACE, "alpha_space"),
    "angular_acceleration_body": (*_SPACE, "omega_body", "alpha_space", "alpha_body"),
}

_TURNING = (
    "Turn k has the matrix Tₖ, the axis nₖ and the angle θₖ; the turns are multiplied one after "
    "the other, from left to right, starting from P₀ = 1"
)
_WORDS = {  # how it follows, and the recursion; of W, the columns are shown
    "rotation_matrix": (f"{_TURNING}.", _LAWS["product"]),
    "rotation_rate": ("The derivative follows from the angular velocity.", r"\mathbf{C}(#1)\,#2"),
    "spin_matrix": ("The derivative times the transpose is the operator of Ω.", r"\mathbf{C}(#1)"),
    "angular_velocity_space": (
        "Each turn adds its rate about its own axis, and rotates the sum of the later turns, "
        "which is 0 for the last one.",
        rf"\mathbf{{u}}_1, \quad {_LAWS['omega_space']}",
    ),
    "angular_velocity_body": (
        "Seen from the body, each turn rotates the sum of the turns before it backwards; for the "
        "first one it is 0.",
        rf"\mathbf{{w}}_{{LAST}}, \quad {_LAWS['omega_body']}",
    ),
    "rate_matrix_space": ("The columns of W are the axes of the turns.", ""),
    "rate_matrix_body": (WORDS["rate_matrix_body"], ""),
    "inverse_rate_matrix_body": (
        "The right inverse of W′ is found in the same way.",
        r"#2\left(#1\,#2\right)^{-1}",
    ),
    "inverse_rate_matrix": (
        "q̇ is not unique, since there are more coordinates than dimensions; we choose the "
        "solution of least norm.",
        r"#2\left(#1\,#2\right)^{-1}",
    ),
    "rates_from_angular_velocity": ("", r"#1\,#2"),
    "angular_acceleration_space": (
        "Differentiating the recursion of Ω gives the angular acceleration.",
        rf"\dot{{\mathbf{{u}}}}_1, \quad {_LAWS['alpha_space']}",
    ),
    "angular_acceleration_body": (
        "Differentiating the recursion of Ω′ gives its body components.",
        rf"\dot{{\mathbf{{w}}}}_{{LAST}}, \quad {_LAWS['alpha_body']}",
    ),
}
_PASSIVE_WORDS = {
    "rotation_matrix": (f"{_TURNING}, and the product is transposed.", _LAWS["product"]),
    "rotation_rate": ("The derivative follows from the angular velocity.", r"\mathbf{C}(#1)\,#2"),
    "spin_matrix": (
        "The derivative times the transpose is the operator of −Ω′, not of Ω.",
        r"-\mathbf{C}(#1)",
    ),
}
