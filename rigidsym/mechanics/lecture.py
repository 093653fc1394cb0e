"""The lecture's equations 1 to 16 for any body and any rotation, each proved in the ring.

Sums over particles are proved for the generic summand, by the rules of `particles`, using only
Σ m = M and Σ m x = 0. Without loss of generality, R(t) is represented by a unit quaternion; what
holds in its ring holds for every rotation. Vectors without a derivation are free.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix, hat, square, unhat
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, sentence
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation, Proof, Statement, Step, phrases
from rigidsym.mechanics.particles import IN_BODY, MASS, ParticleSums
from rigidsym.mechanics.prove import Conditions, Prover
from rigidsym.models.parametrisations import parametrised
from rigidsym.models.rotation import TIME, lecture, time_function, unit_example

_WHOLE = sp.Symbol("M")
_PLACE = tuple(time_function(f"x_{k}") for k in (1, 2, 3))
_CENTRE = tuple(time_function(f"r_{k}") for k in (1, 2, 3))
_OMEGA, _U, _V, _W = (sp.symbols(f"{name}_1:4") for name in ("Omega", "u", "v", "w"))
_LINE = sp.symbols("e_1:4")
_TENSOR = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"I_{min(i, j) + 1}{max(i, j) + 1}"))


@cache
def theory() -> tuple[Statement, ...]:
    """The equations in order, each with what was proved of its claims."""
    work, statements = Equations(), []
    for name, entry in phrases("lecture").items():
        claims = tuple((key, formula(text)) for key, text in entry["claims"].items())
        has_summands = entry.get("shows_summands", False)
        statement = Statement(
            name=name,
            number=entry.get("number"),
            section=entry["section"],
            because=sentence(" ".join(entry["because"].split())),
            sides=tuple(map(formula, entry["sides"])),
            claims=claims,
            source=lecture(str(entry.get("number", "")), f"section {entry['place']}"),
            proofs=work.proofs(claims),
            is_result=entry.get("is_result", False),
            summands=work.summands() if has_summands else None,
        )
        statements.append(statement)
    return tuple(statements)


def _rates(functions: Sequence[sp.Expr]) -> list[sp.Expr]:
    return [sp.diff(function, TIME) for function in functions]


class Equations:
    """Free vectors, one particle and one rotation, over one ring."""

    def __init__(self) -> None:
        model = parametrised("unit_quaternion")
        moving = [*model.coordinates, *_PLACE, *_CENTRE]
        fixed = [MASS, _WHOLE, *IN_BODY, *_OMEGA, *_U, *_V, *_W, *_LINE, *_TENSOR]
        constraints = (*model.constraints, sum(part**2 for part in _LINE) - 1)
        self.codec = codec_for(
            [*moving, *_rates(moving), *fixed, *model.matrix], constraints=constraints, order=1
        )
        example = (*model.example, *unit_example(_LINE, 3))
        subject = Conditions("lecture", constraints, tuple(moving), example=example)
        self.prover = Prover(subject, self.codec)
        self.R = self.codec.matrix(model.matrix)
        self.m = self.codec.encode(MASS)
        # Σ m = M, and Σ m x = 0 with its derivative, for positions from the centre of mass
        places = [*_PLACE, *_rates(_PLACE)]
        self.about_centre = dict.fromkeys(places, sp.S.Zero)
        self.about_origin = dict(zip(places, [*_CENTRE, *_rates(_CENTRE)], strict=True))

    def proofs(self, claims: Sequence[tuple[str, Formula]]) -> tuple[Proof, ...]:
        """Each claim, put to the ring."""
        return tuple(self.prover.vanishes(self.residuals[name], claim) for name, claim in claims)

    def summands(self) -> sp.ImmutableMatrix:
        """The matrix of the generic particle, whose sum is the inertia tensor."""
        tensor = self.inertia(self.codec.column(IN_BODY)).scale(self.m)
        return presenter_for(self.codec).matrix(tensor)

    @staticmethod
    def inertia(place: RingMatrix) -> RingMatrix:
        """(e_j × x)·(e_k × x), the summand of equation 4 but for the mass."""
        return hat(place).T @ hat(place)  # column j is x × e_j

    def sum_by(self, means: Mapping[sp.Expr, sp.Expr]) -> Callable[[RingMatrix], RingMatrix]:
        """Σ m of a matrix, for the means of the positions and velocities that are known."""
        known = {MASS: _WHOLE, **{MASS * part: _WHOLE * mean for part, mean in means.items()}}
        sums = ParticleSums(self.codec, [MASS, *_PLACE, *_rates(_PLACE)], known)
        return lambda summand: sums.of_matrix(summand.scale(self.m))

    @cached_property
    def residuals(self) -> dict[str, RingMatrix]:
        """What vanishes if a claim holds, by its name."""
        column, inertia, R = self.codec.column, self.inertia, self.R
        x, x_dot, r, r_dot = map(column, (_PLACE, _rates(_PLACE), _CENTRE, _rates(_CENTRE)))
        at_rest, line, omega, u, v, w = map(column, (IN_BODY, _LINE, _OMEGA, _U, _V, _W))
        ring, one = self.codec.ring, RingMatrix.identity(self.codec.ring, 3)
        tensor, mass = self.codec.matrix(_TENSOR), self.codec.encode(_WHOLE)
        principal = self.codec.matrix(sp.diag(*_TENSOR.diagonal()))
        R_dot, spin, two = R.dt(), R.dt() @ R.T, ring.one + ring.one
        turning, carried = unhat(spin), omega.cross(x)
        total, about_origin = self.sum_by(self.about_centre), self.sum_by(self.about_origin)
        mean_rate = dict(zip(_rates(_PLACE), [part / _WHOLE for part in _V], strict=True))
        about_any = self.sum_by(mean_rate)  # Σ m ẋ = v

        def form(matrix: RingMatrix, vector: RingMatrix) -> RingMatrix:
            return vector.T @ matrix @ vector

        return {
            "no_moment": about_origin(x - r),
            "no_momentum": about_origin(x_dot - r_dot),
            "no_mixed_energy": total(x_dot.T @ r_dot),
            "squares": square(r_dot + x_dot)
            - (square(r_dot) + (x_dot.T @ r_dot).scale(two) + square(x_dot)),
            "mass_outside": about_any(square(r_dot + x_dot))
            - square(r_dot).scale(mass)
            - (r_dot.T @ v).scale(two)
            - about_any(square(x_dot)),
            "energy_splits": total(square(r_dot + x_dot))
            - square(r_dot).scale(mass)
            - total(square(x_dot)),
            "skew": spin + spin.T,
            "turning": R_dot @ at_rest - turning.cross(R @ at_rest),
            "in_the_basis": carried + hat(x) @ omega,  # Σ ωⱼ (eⱼ × x)
            "coefficients": square(carried) - form(inertia(x), omega),
            "energy_is_a_form": total(square(carried)) - total(form(inertia(x), omega)),
            "symmetric": inertia(x) - inertia(x).T,
            "whole_vector": R @ (R.T @ omega) - omega,  # Σ (ω·R eⱼ) R eⱼ
            "keeps_products": u.T @ v - (R @ u).T @ (R @ v),
            "goes_over": (R.T @ u).T @ v - u.T @ (R @ v),
            "components": R.T @ omega - (omega.T @ R).T,
            "inverse": R @ R.T - one,
            "and_back": R @ (R.T @ omega) - omega,
            "same_energy": form(tensor, R @ omega) - form(R.T @ tensor @ R, omega),
            "tensor_turns": R.T @ inertia(R @ at_rest) @ R - inertia(at_rest),
            "entries": inertia(x) - (one.scale(square(x)[0, 0]) - x @ x.T),
            "lagrange": u.cross(v).T @ w.cross(omega)
            - ((u.T @ w) @ (v.T @ omega) - (u.T @ omega) @ (v.T @ w)),
            "about_a_line": total(square(x - line @ (x.T @ line))) - total(form(inertia(x), line)),
            "stays_symmetric": R.T @ tensor @ R - (R.T @ tensor @ R).T,
            "energy_in_principal_axes": form(principal, omega)
            - RingMatrix.column(
                ring, [ring.dot((tensor[k, k], omega[k, 0] ** 2) for k in range(3))]
            ),
            "four_products": (r + x).cross(r_dot + x_dot)
            - (r.cross(r_dot) + r.cross(x_dot) + x.cross(r_dot) + x.cross(x_dot)),
            "centre_outside": about_any(r.cross(r_dot + x_dot))
            - r.cross(r_dot).scale(mass)
            - r.cross(v),
            "momentum_splits": total((r + x).cross(r_dot + x_dot))
            - r.cross(r_dot).scale(mass)
            - total(x.cross(x_dot)),
            "no_mixed_momentum": total(r.cross(x_dot) + x.cross(r_dot)),
            "double_product": x.cross(carried) - (omega @ square(x) - x @ (x.T @ omega)),
            "momentum_is_linear": total(x.cross(carried) - inertia(x) @ omega),
            "components_of_momentum": principal @ omega
            - RingMatrix.column(ring, [tensor[k, k] * omega[k, 0] for k in range(3)]),
            "twice_the_energy": total(x.cross(carried).T @ omega - square(carried)),
            "velocity": R_dot @ at_rest - spin @ (R @ at_rest),
            "operator": hat(u) @ v - u.cross(v),
            "spin": spin - hat(turning),
            "body_spin": R.T @ R_dot - hat(R.T @ turning),
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
    steps: list[Step] = []
    number = LAST
    for step in derivation.steps:
        number += step.quantity.name not in NUMBERS
        steps.append(replace(step, number=NUMBERS.get(step.quantity.name, number)))
    return replace(derivation, theory=theory(), steps=tuple(steps))
