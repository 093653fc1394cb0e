"""Textbook results that follow from the equations of motion, each proved.

First the free body: Poinsot's construction, its principal axes and the exact solutions (Landau and
Lifshitz, Mechanics, sections 33, 36 and 37). Then the motion in one dimension that remains if all
momenta but one are constant, as for the heavy top: the coordinate θ moves in its effective
potential, which also gives the rates of the others, dq_j/dt = ∂V_eff/∂p_j. If θ occurs in sines and
cosines only, u = cos θ makes the energy u̇² = f(u), for a top with a cubic polynomial f.

The sentences are the macros of these names in templates/notes/en/consequences.md.jinja.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, TypeAlias

import sympy as sp

from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula, with_names
from rigidsym.mechanics.derivation import Consequence
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.mechanics.quantities.dynamics import TORQUE
from rigidsym.mechanics.quantities.kinematics import BODY
from rigidsym.mechanics.quantities.table import own_names
from rigidsym.models.rotation import OMEGA_BODY, TIME, elementary

Written: TypeAlias = str | Formula | sp.Expr  # a formula, as it is typed or read, or an expression
_LENGTH, _ENERGY = claims.LENGTH_SYMBOL, claims.ENERGY_SYMBOL
_LONGEST = 40  # operations of a condition for steady motion that tells a reader anything


def _consequence(
    work: Any,
    name: str,
    left: Written,
    value: Written,
    *proofs: tuple[Written, Sequence[sp.Expr]],
    where: Sequence[tuple[Written, sp.Expr]] = (),
    **spans: Any,
) -> Consequence:
    """A consequence of the equations of motion `work`, with its claims and their residuals."""

    def read(part: Written) -> Any:
        return with_names(formula(part), work.letters) if isinstance(part, str) else part

    subject = work.model.name
    return Consequence(
        name=name,
        spans=spans,
        left=read(left),
        value=read(value),
        proofs=tuple(identity(sp.ImmutableMatrix([*e]), read(n), subject) for n, e in proofs),
        where=tuple((read(n), e) for n, e in where),
    )


def of_free_body(
    work: Any, inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr]
) -> Iterator[Consequence]:
    """What is known of a body on which nothing acts; `slopes` are dΩ′/dt."""
    omega = sp.Matrix(OMEGA_BODY)
    momentum = inertia * omega
    energy = omega.dot(momentum) / 2
    yield _consequence(  # L is normal to the ellipsoid of energy, whose tangent plane is at rest
        work,
        "poinsot",
        "d",
        2 * _ENERGY / _LENGTH,
        (
            r"\frac{\partial E}{\partial\Om'} = \I'\,\Om' = \L'",
            [*(omega.applyfunc(partial(sp.diff, energy)) - momentum)],
        ),
        (r"\L\cdot\Om = 2E", [omega.dot(momentum) - 2 * energy]),
    )
    if not inertia.is_diagonal():
        return
    moments = A, B, C = tuple(inertia.diagonal())
    yield from _principal_axes(work, moments, slopes)
    if A == B != C:
        yield from _symmetric(work, inertia, slopes)
    elif len({A, B, C}) == 3:
        yield _asymmetric(work, moments)


def _principal_axes(
    work: Any, moments: Sequence[sp.Expr], slopes: Sequence[sp.Expr]
) -> Iterator[Consequence]:
    """A deviation along the axes i and j obeys dΩ_i/dt = a Ω_j and dΩ_j/dt = b Ω_i, so that it
    grows or turns with λ² = a b; axes that the moments do not fix are left out.
    """
    spin, name = sp.Symbol("Omega"), ""
    for k, axis in enumerate(("first", "second", "third")):
        i, j = (n for n in range(3) if n != k)
        steady = {s: spin if n == k else sp.S.Zero for n, s in enumerate(OMEGA_BODY)}
        a, b = (sp.diff(slopes[n], OMEGA_BODY[o]).xreplace(steady) for n, o in ((i, j), (j, i)))
        own, one, other = moments[k], moments[i], moments[j]
        # λ² = Ω² (Iₖ − Iᵢ)(Iⱼ − Iₖ)/(Iᵢ Iⱼ): positive, and so unstable, only about the middle axis.
        squared = spin**2 * (own - one) * (other - own) / (one * other)
        if one == other:
            squared = -((spin * (own - one) / one) ** 2)
        if squared != 0:
            first = "symmetry_axis" if one == other else "principal_axis"
            name = "another_axis" if name else first
            proof = (r"\lambda^2 = a b", [a * b - squared])
            yield _consequence(work, name, r"\lambda^2", squared, proof, axis=axis, rate=spin)


def _symmetric(
    work: Any, inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr]
) -> Iterator[Consequence]:
    """Ω′ turns about the axis of symmetry: dΩ₁/dt = −κ Ω₂, dΩ₂/dt = κ Ω₁, Ω₃ constant.

    Then R(t), with the third axis of space along L, which is proved to stay constant.
    """
    first, second, third = OMEGA_BODY
    across, along = inertia[0, 0], inertia[2, 2]
    kappa = (along - across) / across * third
    residual = [slopes[0] + kappa * second, slopes[1] - kappa * first, slopes[2]]
    claim = r"\dot{\Omega}'_1 + i\dot{\Omega}'_2 = i\kappa(\Omega'_1 + i\Omega'_2)"
    yield _consequence(work, "symmetric_body", r"\kappa", kappa, (claim, residual))
    angle, precession = sp.Dummy("beta"), _LENGTH / across
    spin = -kappa.xreplace({third: _LENGTH * sp.cos(angle) / along})
    # Regular precession: with the third axis of space along L, the angle β is constant,
    # α̇ = |L|/A and γ̇ = −κ.
    alpha, beta, gamma = map(elementary, "zxz", (precession * TIME, angle, spin * TIME))
    rotation = alpha * beta * gamma
    skew = rotation.T * rotation.diff(TIME)
    momentum = rotation * inertia * sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
    claim = r"\R\,\I'\,\Om' = \begin{pmatrix}0 \\ 0 \\ \left|\L\right|\end{pmatrix}"
    yield _consequence(
        work,
        "symmetric_body_in_space",
        r"\mathbf{R}(t)",
        r"\R_z(\alpha_0 + \dot{\alpha}t)\,\R_x(\beta)\,\R_z(\gamma_0 + \dot{\gamma}t)",
        (claim, [*(momentum - sp.Matrix([0, 0, _LENGTH]))]),
        where=(
            (r"\cos\beta", along * third / _LENGTH),
            (r"\dot{\alpha}", precession),
            (r"\dot{\gamma}", (across - along) / across * third),
        ),
    )


def _asymmetric(work: Any, moments: Sequence[sp.Expr]) -> Consequence:
    """Ω′ = (a cn, b sn, c dn) for A < B < C and L² > 2 E B."""
    A, B, C = moments
    # Landau and Lifshitz, section 37. The derivatives cn' = −sn dn, sn' = cn dn and dn' = −k² sn cn
    # turn Euler's equations into three conditions on a, b, c and τ. They are squared, since the
    # letters stand for squares here, and the energy fixes the scale.
    of_c, of_a = 2 * _ENERGY * C - _LENGTH**2, _LENGTH**2 - 2 * _ENERGY * A
    a, b, c = of_c / (A * (C - A)), of_c / (B * (C - B)), of_a / (C * (C - A))
    tau, modulus = (C - B) * of_a / (A * B * C), (B - A) * of_c / ((C - B) * of_a)
    s = sp.Dummy("sn")
    residual = [
        A**2 * a * tau - (C - B) ** 2 * b * c,
        B**2 * b * tau - (C - A) ** 2 * a * c,
        C**2 * c * tau * modulus**2 - (B - A) ** 2 * a * b,
        A * a * (1 - s**2) + B * b * s**2 + C * c * (1 - modulus * s**2) - 2 * _ENERGY,
    ]
    return _consequence(
        work,
        "asymmetric_body",
        BODY.omega,
        r"\begin{pmatrix}a\,\operatorname{cn}(\tau t, k) \\ b\,\operatorname{sn}(\tau t, k) \\ "
        r"c\,\operatorname{dn}(\tau t, k)\end{pmatrix}",
        (f"{TORQUE} = 0", residual),
        where=(("a^2", a), ("b^2", b), ("c^2", c), (r"\tau^2", tau), ("k^2", modulus)),
        moments=moments,
        least=2 * _ENERGY * B,
        momentum_squared=_LENGTH**2,
    )


class OneDimension:
    """The coordinate θ and its effective potential; the other momenta are constant."""

    def __init__(self, work: Any, k: int) -> None:
        """Of the k-th coordinate in `dynamics.lagrange.LagrangeEquations`."""
        q, momenta = work.model.coordinates, work.present.matrix(work.momenta)
        # All but the k-th coordinate are ignorable.
        others = [j for j in range(len(q)) if j != k]
        self.work, self.q, self.rate = work, q[k], sp.diff(q[k], TIME)
        self.mass = work.present.matrix(work.mass_matrix)[k, k]  # m, of ½ m θ̇²
        self.potential = work.effective  # V_eff in θ and p_j
        self.acceleration = work.present.matrix(*work.solved)[k]
        self.momenta = {work.arguments["momenta"].symbols[j]: momenta[j] for j in others}  # p_j
        self.rates = {sp.diff(q[j], TIME): q[j] for j in others}
        # the energy, cos θ, and all momenta if they are equal
        names = own_names(work.arguments.values(), work.body, work.forces)
        self.E, self.u, self.p = (sp.Symbol(names[name]) for name in ("E", "u", "p"))
        self.values = {**self.momenta, self.E: work.whole}

    def consequences(self) -> Iterator[Consequence]:
        value, own = self.mass * self.rate**2 / 2 + self.potential, _name(self.q)
        names = (named(self.E.name), own, _name(self.q, order=1))
        claim = formula(r"#1 = \tfrac{1}{2}\,p_{#2}\,#3 + V_{\mathrm{eff}}", *names)
        yield self._follows("effective_potential", "E", value, claim, self.E - value, q=self.q)
        name = "other_coordinates"
        for (rate, q), p in zip(self.rates.items(), self.momenta, strict=True):
            # each term as one fraction, with its factors if that is shorter
            terms = sp.Add.make_args(sp.diff(self.potential, p))
            value = sp.Add(*(min(sp.cancel(e), sp.factor(e), key=sp.count_ops) for e in terms))
            spans = {"own": own, "angle": _name(q), "rate": _name(q, order=1)}
            of_rate = r"#2 = \frac{\partial V_{\mathrm{eff}}}{\partial p_{#1}}"
            claim = formula(of_rate, spans["angle"], spans["rate"])
            yield self._follows(name, rate, value, claim, rate - value, **spans)
            name = "another_coordinate"
        if len(self.rates) == 2:
            yield from self._steady()
        in_cosine = self._in_cosine()
        if in_cosine is not None and not self.mass.has(self.q):
            if len(self.rates) == 2:
                yield from self._sleeping(in_cosine)
            yield from self._cubic(in_cosine)

    def _follows(
        self,
        name: str,
        left: Written,
        value: sp.Expr,
        claim: Written,
        residual: sp.Expr,
        **spans: Any,
    ) -> Consequence:
        """A consequence; in a residual with θ(t), E and p_j are those of the motion, else free."""
        if residual.has(self.q):
            residual = residual.xreplace(self.values)
        return _consequence(self.work, name, left, value, (claim, [residual]), **spans)

    def _steady(self) -> Iterator[Consequence]:
        """θ at rest: a condition on the rate of the precession, quadratic for a top."""
        at_rest, x = self.acceleration.xreplace({self.rate: sp.S.Zero}), sp.Dummy()
        for spin, turning, (p, momentum) in zip(
            self.rates, reversed(self.rates), self.momenta.items(), strict=True
        ):
            # The spin is eliminated by its constant momentum, ψ̇ = (p − rest)/slope, so that the
            # condition is one on the rate of precession and p.
            slope = sp.diff(momentum, spin)
            if slope.has(self.q):  # no spin about an axis of the body
                continue
            own = (p - momentum.xreplace({spin: sp.S.Zero})) / slope
            of_spin = at_rest.xreplace({spin: own})
            numerator = sp.numer(sp.cancel(sp.together(of_spin.xreplace({turning: x}))))
            factors = [base for base, _ in sp.factor_list(numerator)[1] if base.has(x)]
            condition = sp.Poly(sp.prod(factors), x)
            if len(factors) != 1 or condition.degree() != 2:
                continue
            # The sign of an equation that equals zero is free; a positive leading coefficient reads
            # best.
            if condition.LC().could_extract_minus_sign():
                condition = -condition
            value = condition.as_expr().xreplace({x: turning})
            if sp.count_ops(value) <= _LONGEST:
                residual = of_spin - sp.cancel(of_spin / value) * value
                value, claim = sp.collect(value, turning), _name(self.q, order=2)
                claim = formula("#1 = 0", claim)
                yield self._follows("steady_motion", "0", value, claim, residual, q=self.q)
            return

    def _in_cosine(self) -> sp.Expr | None:
        """V_eff in terms of u; None if it cannot be written so."""
        # an even power of the root is a polynomial, and an odd one stays
        sine = sp.sqrt(1 - self.u**2)
        plain = self.potential.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
        plain = plain.replace(sp.cot, lambda x: sp.cos(x) / sp.sin(x))
        plain = plain.xreplace({sp.sin(self.q): sine, sp.cos(self.q): self.u})
        value = sp.Add(*map(sp.cancel, sp.Add.make_args(plain)))
        return None if value.has(self.q) or value.has(sine) else value

    def _sleeping(self, in_cosine: sp.Expr) -> Iterator[Consequence]:
        """V_eff near θ = 0 for equal momenta, if these alone make it regular there."""
        # At θ = 0 the two momenta of an upright top are the same component of L. The pole of V_eff
        # at u = 1 then cancels, and V_eff has a minimum there if κ > 0.
        u, upright = self.u, {self.u: sp.S.One}
        equal = sp.cancel(in_cosine.xreplace(dict.fromkeys(self.momenta, self.p)))
        poles = [sp.denom(sp.together(e)).xreplace(upright) == 0 for e in (in_cosine, equal)]
        if poles != [True, False]:
            return
        height, slope = (e.xreplace(upright) for e in (equal, sp.diff(equal, u)))
        bend = equal - height - (u - 1) * slope
        rest = sp.cancel(bend / (1 - u) ** 2)  # regular at u = 1
        names = (formula("p_{#1}", _name(q)) for q in self.rates.values())
        yield self._follows(
            "upright_motion",
            r"\kappa",
            min(sp.expand(-slope), sp.factor(-slope), key=sp.count_ops),
            r"V_{\mathrm{eff}} = V_{\mathrm{eff}}(0) + \kappa(1 - u) + O((1 - u)^2)",
            bend - (1 - u) ** 2 * rest,
            q=self.q,
            square=self.q**2,
            momenta=formula("#1 = #2 = #3", *names, named(self.p.name)),
        )

    def _cubic(self, in_cosine: sp.Expr) -> Iterator[Consequence]:
        """u̇² = f(u) = 2 (1 − u²)(E − V_eff)/m, if f is a cubic polynomial."""
        u, regular, singular = self.u, sp.S.Zero, sp.S.Zero
        # u̇ = −θ̇ sin θ, so u̇² = (1 − u²) θ̇² = (1 − u²) 2 (E − V_eff)/m. The factor 1 − u²
        # cancels the poles of the centrifugal terms at u = ±1.
        for part in sp.Add.make_args(in_cosine):
            if sp.denom(part).has(u):  # with a pole at u = ±1
                singular += sp.factor(sp.cancel(part * (1 - u**2)))
            else:
                regular += part
        value = 2 * ((1 - u**2) * (self.E - regular) - singular) / self.mass
        f, name = sp.expand(sp.cancel(value)).as_poly(u), named(u.name)
        if f is not None and f.degree() == 3:
            cosine = formula(r"#1 = \cos #2", name, _name(self.q))
            claim, left = formula(r"\dot{#1}^2 = f(#1)", name), formula("f(#1)", name)
            residual = (sp.sin(self.q) * self.rate) ** 2 - value.xreplace({u: sp.cos(self.q)})
            spans = {"cosine": cosine, "equation": claim}
            yield self._follows("cubic_for_cosine", left, value, claim, residual, **spans)


def _name(coordinate: sp.Expr, order: int = 0) -> Formula:
    """Of a coordinate or one of its time derivatives."""
    return named(coordinate.func.__name__, order)
