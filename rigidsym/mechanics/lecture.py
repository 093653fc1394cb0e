"""The lecture's equations 1 to 16 for any body and any rotation, each proved in the ring.

Sums over particles are proved for the generic summand, by the rules of `particles`, using only
Σ m = M and Σ m x = 0. Without loss of generality, R(t) is represented by a unit quaternion; what
holds in its ring holds for every rotation. Vectors without a derivation are free.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache, reduce
from typing import TypeAlias

import sympy as sp
from sympy.polys.rings import PolyElement

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, hat, unhat
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, sentence
from rigidsym.mechanics.derivation import Derivation, Proof, Statement, Step
from rigidsym.mechanics.particles import IN_BODY, MASS, ParticleSums
from rigidsym.mechanics.prove import Conditions, Prover
from rigidsym.models.parametrisations import UnitQuaternion
from rigidsym.models.rotation import TIME, lecture, time_function, unit_example
from rigidsym.system.resources import text

_WHOLE = sp.Symbol("M")
_PLACE = tuple(time_function(f"x_{k}") for k in (1, 2, 3))
_CENTRE = tuple(time_function(f"r_{k}") for k in (1, 2, 3))
_OMEGA, _U, _V, _W = (sp.symbols(f"{name}_1:4") for name in ("Omega", "u", "v", "w"))
_LINE = sp.symbols("e_1:4")
_TENSOR = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j) + 1}{max(i, j) + 1}"))

_ITEM = re.compile(r"\n    (?=(?:=|\w+:) )(\S+) ")  # "=" or the name of a claim

Residual: TypeAlias = "RingMatrix | PolyElement"


@cache
def statements() -> tuple[Statement, ...]:
    """The equations in order, each with its claims."""
    _, *blocks = text("templates/notes", "en/lecture.txt").strip().split("\n\n")
    found, section = [], ""
    for block in blocks:
        heading, _, rest = block.partition("\n")
        if heading.startswith("# "):
            section = heading[2:]
            heading, _, rest = rest.partition("\n")
        found.append(_statement(section, heading, "\n" + rest))
    return tuple(found)


def _statement(section: str, heading: str, body: str) -> Statement:
    number, name, place, *more = heading.split()
    words, *items = _ITEM.split(body)
    pairs = [(mark, formula(item)) for mark, item in zip(items[::2], items[1::2], strict=True)]
    return Statement(
        name=name,
        number=None if number == "-" else int(number),
        section=section,
        because=sentence(" ".join(words.split())),
        sides=tuple(side for mark, side in pairs if mark == "="),
        claims=tuple((mark[:-1], claim) for mark, claim in pairs if mark != "="),
        source=lecture("" if number == "-" else number, f"section {place}"),
        is_result="result" in more,
        shows_summands="summands" in more,
    )


@cache
def theory() -> tuple[Statement, ...]:
    """The equations in order, each with what was proved of it."""
    work = _Theory()
    return tuple(
        statement._replace(proofs=work.proofs(statement), summands=work.summands(statement))
        for statement in statements()
    )


def _rates(functions: Sequence[sp.Expr]) -> list[sp.Expr]:
    return [sp.diff(function, TIME) for function in functions]


class _Theory:
    """Free vectors, one particle and one rotation, over one ring."""

    def __init__(self) -> None:
        model = UnitQuaternion()
        moving = [*model.coordinates, *_PLACE, *_CENTRE]
        fixed = [MASS, _WHOLE, *IN_BODY, *_OMEGA, *_U, *_V, *_W, *_LINE, *_TENSOR]
        unit = sum(part**2 for part in _LINE) - 1
        constraints = (*model.constraints, unit)
        self.codec = codec_for(
            [*moving, *_rates(moving), *fixed, *model.matrix], constraints=constraints, order=1
        )
        self.ring = self.codec.ring
        example = (*model.example, *unit_example(_LINE, 3))
        subject = Conditions("lecture", constraints, tuple(moving), example=example)
        self.prover = Prover(subject, self.codec)
        self.R = self.codec.matrix(model.matrix)
        self.R_dot = self.R.dt()
        self.x, self.x_dot = self.codec.column(_PLACE), self.codec.column(_rates(_PLACE))
        self.r, self.r_dot = self.codec.column(_CENTRE), self.codec.column(_rates(_CENTRE))
        self.at_rest, self.line = self.codec.column(IN_BODY), self.codec.column(_LINE)
        self.omega, self.u, self.v, self.w = map(self.codec.column, (_OMEGA, _U, _V, _W))
        self.I = self.codec.matrix(_TENSOR)
        self.one = RingMatrix.identity(self.ring, 3)
        self.m, self.M = self.codec.encode(MASS), self.codec.encode(_WHOLE)
        own = [MASS, *_PLACE, *_rates(_PLACE)]
        nothing = {MASS * part: sp.S.Zero for part in own[1:]}
        self.sum = ParticleSums(self.codec, own, {MASS: _WHOLE, **nothing})
        moments = {MASS * rate: sum_ for rate, sum_ in zip(own[4:], _V, strict=True)}
        self.sum_of_any = ParticleSums(self.codec, own, {MASS: _WHOLE, **moments})  # Σ m ẋ = v
        pairs = zip(own[1:], [*_CENTRE, *_rates(_CENTRE)], strict=True)
        self.sum_of_places = ParticleSums(
            self.codec, own, {MASS: _WHOLE, **{MASS * part: _WHOLE * mean for part, mean in pairs}}
        )

    def proofs(self, statement: Statement) -> tuple[Proof, ...]:
        """Each claim of a statement, put to the ring."""
        proofs = []
        for name, claim in statement.claims:
            left = _CLAIMS[name](self)
            matrix = left if isinstance(left, RingMatrix) else RingMatrix.column(self.ring, [left])
            proofs.append(self.prover.vanishes(matrix, claim))
        return tuple(proofs)

    def summands(self, statement: Statement) -> sp.ImmutableMatrix | None:
        """The matrix of the generic particle, where the statement shows one."""
        if not statement.shows_summands:
            return None
        tensor = self.inertia(self.at_rest)
        return presenter_for(self.codec).matrix(tensor)

    # One particle.

    def inertia(self, place: RingMatrix) -> RingMatrix:
        """m (e_j × x)·(e_k × x), the summand of equation 4."""
        crossed = [unit.cross(place) for unit in self.units]
        rows = [[self.ring.reduce(self.m * self.dot(u, v)) for v in crossed] for u in crossed]
        return RingMatrix.of(self.ring, rows)

    @property
    def units(self) -> list[RingMatrix]:
        return [RingMatrix.column(self.ring, row) for row in self.one.rows]

    def crossed(self) -> list[RingMatrix]:
        """e_j × x for the three vectors of the basis."""
        return [unit.cross(self.x) for unit in self.units]

    def spin(self) -> RingMatrix:
        """Ω of the rotation, from the skew matrix dR/dt Rᵀ."""
        return unhat(self.R_dot @ self.R.T)

    # Products over the ring.

    def dot(self, first: RingMatrix, second: RingMatrix) -> PolyElement:
        return (first.T @ second)[0, 0]

    def square(self, vector: RingMatrix) -> PolyElement:
        return self.dot(vector, vector)

    def added(self, vectors: Iterable[RingMatrix]) -> RingMatrix:
        return reduce(lambda a, b: a + b, vectors)

    def form(self, matrix: RingMatrix, vector: RingMatrix) -> PolyElement:
        """vᵀ M v."""
        return self.dot(vector, matrix @ vector)

    def diagonal(self) -> RingMatrix:
        """The tensor in its principal axes."""
        zero = self.ring.zero
        rows = [[self.I[j, k] if j == k else zero for k in range(3)] for j in range(3)]
        return RingMatrix.of(self.ring, rows)


_CLAIMS: dict[str, Callable[[_Theory], Residual]] = {
    "no_moment": lambda t: t.sum_of_places.of_matrix((t.x - t.r).scale(t.m)),
    "no_momentum": lambda t: t.sum_of_places.of_matrix((t.x_dot - t.r_dot).scale(t.m)),
    "no_mixed_energy": lambda t: t.sum.of(t.m * t.dot(t.x_dot, t.r_dot)),
    "squares": lambda t: (
        t.square(t.r_dot + t.x_dot)
        - (t.square(t.r_dot) + 2 * t.dot(t.x_dot, t.r_dot) + t.square(t.x_dot))
    ),
    "mass_outside": lambda t: (
        t.sum_of_any.of(t.m * t.square(t.r_dot + t.x_dot))
        - t.sum_of_any.of(t.m * t.square(t.r_dot))
        - 2 * t.dot(t.r_dot, t.v)
        - t.sum_of_any.of(t.m * t.square(t.x_dot))
    ),
    "energy_splits": lambda t: (
        t.sum.of(t.m * t.square(t.r_dot + t.x_dot))
        - t.ring.reduce(t.M * t.square(t.r_dot))
        - t.sum.of(t.m * t.square(t.x_dot))
    ),
    "skew": lambda t: t.R_dot @ t.R.T + (t.R_dot @ t.R.T).T,
    "turning": lambda t: t.R_dot @ t.at_rest - t.spin().cross(t.R @ t.at_rest),
    "in_the_basis": lambda t: (
        t.omega.cross(t.x) - t.added(e.scale(t.omega[j, 0]) for j, e in enumerate(t.crossed()))
    ),
    "coefficients": lambda t: (
        t.square(t.omega.cross(t.x))
        - t.ring.dot(
            (t.omega[j, 0] * t.omega[k, 0], t.dot(u, v))
            for j, u in enumerate(t.crossed())
            for k, v in enumerate(t.crossed())
        )
    ),
    "energy_is_a_form": lambda t: (
        t.sum.of(t.m * t.square(t.omega.cross(t.x))) - t.sum.of(t.form(t.inertia(t.x), t.omega))
    ),
    "symmetric": lambda t: t.inertia(t.x) - t.inertia(t.x).T,
    "whole_vector": lambda t: (
        t.added(e.scale(t.dot(t.omega, e)) for e in (t.R @ unit for unit in t.units)) - t.omega
    ),
    "keeps_products": lambda t: t.dot(t.u, t.v) - t.dot(t.R @ t.u, t.R @ t.v),
    "goes_over": lambda t: t.dot(t.R.T @ t.u, t.v) - t.dot(t.u, t.R @ t.v),
    "components": lambda t: t.R.T @ t.omega - (t.omega.T @ t.R).T,
    "inverse": lambda t: t.R @ t.R.T - t.one,
    "and_back": lambda t: t.R @ (t.R.T @ t.omega) - t.omega,
    "same_energy": lambda t: t.form(t.I, t.R @ t.omega) - t.form(t.R.T @ t.I @ t.R, t.omega),
    "tensor_turns": lambda t: t.R.T @ t.inertia(t.R @ t.at_rest) @ t.R - t.inertia(t.at_rest),
    "entries": lambda t: t.inertia(t.x) - (t.one.scale(t.square(t.x)) - t.x @ t.x.T).scale(t.m),
    "lagrange": lambda t: (
        t.dot(t.u.cross(t.v), t.w.cross(t.omega))
        - t.ring.reduce(
            t.dot(t.u, t.w) * t.dot(t.v, t.omega) - t.dot(t.u, t.omega) * t.dot(t.v, t.w)
        )
    ),
    "about_a_line": lambda t: (
        t.sum.of(t.m * t.square(t.x - t.line.scale(t.dot(t.x, t.line))))
        - t.sum.of(t.form(t.inertia(t.x), t.line))
    ),
    "stays_symmetric": lambda t: t.R.T @ t.I @ t.R - (t.R.T @ t.I @ t.R).T,
    "energy_in_principal_axes": lambda t: (
        t.form(t.diagonal(), t.omega)
        - t.ring.dot((t.I[k, k], t.omega[k, 0] ** 2) for k in range(3))
    ),
    "four_products": lambda t: (
        (t.r + t.x).cross(t.r_dot + t.x_dot)
        - t.added(a.cross(b) for a in (t.r, t.x) for b in (t.r_dot, t.x_dot))
    ),
    "centre_outside": lambda t: (
        t.sum_of_any.of_matrix(t.r.cross(t.r_dot + t.x_dot).scale(t.m))
        - t.r.cross(t.r_dot).scale(t.M)
        - t.r.cross(t.v)
    ),
    "momentum_splits": lambda t: (
        t.sum.of_matrix((t.r + t.x).cross(t.r_dot + t.x_dot).scale(t.m))
        - t.r.cross(t.r_dot).scale(t.M)
        - t.sum.of_matrix(t.x.cross(t.x_dot).scale(t.m))
    ),
    "no_mixed_momentum": lambda t: t.sum.of_matrix(
        (t.r.cross(t.x_dot) + t.x.cross(t.r_dot)).scale(t.m)
    ),
    "double_product": lambda t: (
        t.x.cross(t.omega.cross(t.x))
        - (t.omega.scale(t.square(t.x)) - t.x.scale(t.dot(t.x, t.omega)))
    ),
    "momentum_is_linear": lambda t: t.sum.of_matrix(
        t.x.cross(t.omega.cross(t.x)).scale(t.m) - t.inertia(t.x) @ t.omega
    ),
    "components_of_momentum": lambda t: (
        t.diagonal() @ t.omega
        - RingMatrix.column(t.ring, [t.I[k, k] * t.omega[k, 0] for k in range(3)])
    ),
    "twice_the_energy": lambda t: (
        t.sum.of(t.dot(t.x.cross(t.omega.cross(t.x)).scale(t.m), t.omega))
        - t.sum.of(t.m * t.square(t.omega.cross(t.x)))
    ),
    "velocity": lambda t: t.R_dot @ t.at_rest - t.R_dot @ t.R.T @ (t.R @ t.at_rest),
    "operator": lambda t: hat(t.u) @ t.v - t.u.cross(t.v),
    "spin": lambda t: t.R_dot @ t.R.T - hat(t.spin()),
    "body_spin": lambda t: t.R.T @ t.R_dot - hat(t.R.T @ t.spin()),
}


# The equations of the lecture that these quantities evaluate; steps towards 16 share its number.
NUMBERS = {
    "rotation_rate": 15,
    "spin_matrix": 15,
    "angular_velocity_space": 16,
    "rotation_matrix": 17,
    "angular_velocity_body": 18,
}
NEEDED = ("rotation_matrix", "spin_matrix", "angular_velocity_space", "angular_velocity_body")
LAST = 18


def with_theory(derivation: Derivation) -> Derivation:
    """The theory, and the steps with the lecture's numbers; what follows is numbered from 19.

    Raises ModelError for a passive presentation, which the lecture does not have.
    """
    if derivation.model.passive:
        raise ModelError(
            f"{derivation.name}: the theory is written for active rotations; remove passive"
        )
    return replace(derivation, theory=theory(), steps=tuple(_numbered(derivation.steps)))


def _numbered(steps: Sequence[Step]) -> Iterator[Step]:
    number = LAST
    for step in steps:
        number += step.quantity.name not in NUMBERS
        yield replace(step, number=NUMBERS.get(step.quantity.name, number))
