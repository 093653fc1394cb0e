"""Motion in one dimension: what follows if all momenta but one are constant, as for the heavy top.

The remaining coordinate moves in its effective potential. If it occurs in sines and cosines only,
u = cos θ turns the energy into u̇² = f(u) with a polynomial f; a cubic is solved by Jacobi's sn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Consequence, Proof
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import dynamics as claims
from rigidsym.models.forces import OMEGA_BODY

_E, _U, _P = sp.symbols("E u p")
_SINE = sp.Dummy("sine")
_LONGEST = 40  # operations of a condition for steady motion that tells a reader anything


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """One coordinate θ and its effective potential, the other momenta p_j being constant."""

    name: str  # of the rotation
    coordinate: sp.Expr  # θ
    ignorable: tuple[sp.Expr, ...]  # the other coordinates
    mass: sp.Expr  # m, of ½ m θ̇²
    potential: sp.Expr  # V_eff in θ and p_j
    symbols: tuple[sp.Symbol, ...]  # p_j
    momenta: tuple[sp.Expr, ...]  # p_j in the coordinates and rates
    energy: sp.Expr  # E in the coordinates and rates
    acceleration: sp.Expr  # of θ

    @property
    def rate(self) -> sp.Expr:
        return sp.diff(self.coordinate, sp.Symbol("t"))

    def consequences(self) -> Iterator[Consequence]:
        yield self._one_dimension()
        yield from self._steady()
        potential = self._in_cosine(self.potential)
        if potential is None or self.mass.has(self.coordinate):
            return
        yield from self._sleeping(potential)
        value = self._right_side(potential)
        if sp.cancel(value).is_polynomial(_U):
            yield self._polynomial(value)
            yield from self._elliptic(sp.Poly(sp.expand(value), _U))

    def _proved(self, residual: sp.Expr, claim: str) -> Proof:
        """That a residual vanishes with E and the momenta in terms of the motion."""
        values = {_E: self.energy, **dict(zip(self.symbols, self.momenta, strict=True))}
        held = sp.ImmutableMatrix([[residual.xreplace(values)]])
        return identity(held, formula(claim), self.name)

    def _one_dimension(self) -> Consequence:
        value = self.mass * self.rate**2 / 2 + self.potential
        return Consequence(
            title="The effective potential",
            text="The constant momenta put into the energy leave the motion of {} in one "
            "dimension, in the effective potential {}. It turns back where the potential has the "
            "height {}.",
            spans=(self.coordinate, claims.EFFECTIVE, claims.ENERGY),
            left=claims.ENERGY,
            value=value,
            proofs=(self._proved(_E - value, r"E = \tfrac{1}{2}m\dot{q}^2 + V_{\mathrm{eff}}"),),
        )

    def _steady(self) -> Iterator[Consequence]:
        """θ at rest: a condition on the rates of the others, quadratic for a top."""
        at_rest = self.acceleration.xreplace({self.rate: sp.S.Zero})
        rates = [sp.diff(q, sp.Symbol("t")) for q in self.ignorable]
        plain = {rate: sp.Dummy() for rate in rates}
        for k, spin in enumerate(rates):
            others = [rate for rate in rates if rate != spin]
            if len(others) != 1 or not self.symbols:
                return
            (turning,) = others
            given = self.momenta[k].xreplace(plain)
            slope = sp.diff(given, plain[spin])
            if slope.has(self.coordinate):  # not the spin about an axis of the body
                continue
            own = (self.symbols[k] - given.xreplace({plain[spin]: sp.S.Zero})) / slope
            condition = _factor(
                at_rest.xreplace(plain).xreplace({plain[spin]: own}), plain[turning]
            )
            if condition is None or condition.degree() != 2:
                continue
            if sp.count_ops(condition.as_expr()) > _LONGEST:
                return
            a, b, c = condition.all_coeffs()
            root = sp.sqrt(sp.factor(b**2 - 4 * a * c))
            value = condition.as_expr().xreplace({plain[turning]: turning})
            of_spin = at_rest.xreplace({spin: own.xreplace({plain[turning]: turning})})
            residual = of_spin - sp.cancel(of_spin / value) * value
            yield Consequence(
                title="Steady motion",
                text="With {} at rest, its acceleration vanishes if",
                spans=(self.coordinate,),
                left=formula("0"),
                value=sp.collect(value, turning),
                proofs=(self._proved(residual, r"\ddot{q} = 0"),),
            )
            yield Consequence(
                title="",
                text="This quadratic equation gives a fast and a slow rate if {} is not negative; "
                "if it is negative, no steady motion has this inclination. The slow one is",
                spans=(root**2,),
                left=turning,
                value=(-b - root) / (2 * a),
                proofs=(_roots_proof(a, b, c, self.name),),
            )
            return

    def _in_cosine(self, value: sp.Expr) -> sp.Expr | None:
        """A function of θ in terms of u = cos θ; None if it is none."""
        angle = self.coordinate
        plain = value.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
        plain = plain.replace(sp.cot, lambda x: sp.cos(x) / sp.sin(x))
        plain = plain.xreplace({sp.sin(angle): _SINE, sp.cos(angle): _U})
        if plain.has(angle):
            return None
        parts = [sp.cancel(_without_sine(part)) for part in sp.Add.make_args(plain)]
        return None if any(part.has(_SINE) for part in parts) else sp.Add(*parts)

    def _polynomial(self, value: sp.Expr) -> Consequence:
        angle = self.coordinate
        kind = "cubic polynomial" if sp.degree(sp.cancel(value), _U) == 3 else "polynomial"
        residual = (sp.sin(angle) * self.rate) ** 2 - value.xreplace({_U: sp.cos(angle)})
        return Consequence(
            title="The equation for the cosine",
            text=f"With {{}} the equation of energy becomes {{}}, with the {kind} $f$:",
            spans=(
                formula("u = #1", formula(r"\cos #1", claims.name_of(angle))),
                formula(r"\dot{u}^2 = f(u)"),
            ),
            left=formula("f(u)"),
            value=value,
            proofs=(self._proved(residual, r"\dot{u}^2 = f(u)"),),
        )

    def _right_side(self, potential: sp.Expr) -> sp.Expr:
        """f(u) = 2 (1 − u²)(E − V)/m, with what has a pole at u = ±1 apart."""
        regular, singular = sp.S.Zero, sp.S.Zero
        for part in sp.Add.make_args(potential):
            if sp.denom(part).has(_U):
                singular += sp.factor(sp.cancel(part * (1 - _U**2)))
            else:
                regular += part
        return 2 * ((1 - _U**2) * (_E - regular) - singular) / self.mass

    def _sleeping(self, potential: sp.Expr) -> Iterator[Consequence]:
        """V_eff near θ = 0, where it is regular if the momenta are equal."""
        equal = sp.cancel(potential.xreplace(dict.fromkeys(self.symbols, _P)))
        if len(self.symbols) != 2 or sp.denom(equal).xreplace({_U: sp.S.One}) == 0:
            return
        height, slope = (e.xreplace({_U: sp.S.One}) for e in (equal, sp.diff(equal, _U)))
        line = height + (_U - 1) * slope
        rest = sp.cancel((equal - line) / (1 - _U) ** 2)  # regular at u = 1
        residual = sp.ImmutableMatrix([[equal - line - (1 - _U) ** 2 * rest]])
        yield Consequence(
            title="The upright motion",
            text="If {} is 0, the momenta are equal, {}; near 0 the effective potential is a "
            "constant plus half of {} times {}. The motion upright (the sleeping top) is stable if "
            "this coefficient is positive:",
            spans=(
                self.coordinate,
                formula("#1 = #2 = p", *map(claims.momentum_of, self.ignorable)),
                formula(r"\kappa"),
                self.coordinate**2,
            ),
            left=formula(r"\kappa"),
            value=min(sp.expand(-slope), sp.factor(-slope), key=sp.count_ops),
            proofs=(identity(residual, claims.NEAR_UPRIGHT, self.name),),
        )

    def _elliptic(self, cubic: sp.Poly) -> Iterator[Consequence]:
        """u(t) for a cubic f with the roots u₁ ≤ u₂ ≤ u₃."""
        if cubic.degree() != 3:
            return
        one, two, three, sn, lead = sp.symbols("u_1 u_2 u_3 sn a")
        u = one + (two - one) * sn**2
        modulus = (two - one) / (three - one)
        rate_squared = lead * (three - one) / 4
        slope_squared = 4 * (two - one) ** 2 * sn**2 * (1 - sn**2) * (1 - modulus * sn**2)
        residual = slope_squared * rate_squared - lead * (u - one) * (u - two) * (u - three)
        claim = formula(r"\dot{u}^2 = f(u)")
        yield Consequence(
            title="Nutation in elliptic functions",
            text="Let {} be the roots of $f$. The motion goes to and fro between the first two; "
            "substitution shows that {} with {} and {}, if the time begins at {}. Here $a$ is the "
            "leading coefficient of $f$:",
            spans=(
                formula(r"u_1 \le u_2 \le u_3"),
                formula(r"u = u_1 + (u_2 - u_1)\,\mathrm{sn}^2(\lambda t, k)"),
                formula(r"\lambda^2 = \tfrac{a}{4}(u_3 - u_1)"),
                formula(r"k^2 = \frac{u_2 - u_1}{u_3 - u_1}"),
                one,
            ),
            left=formula("a"),
            value=cubic.LC(),
            proofs=(identity(sp.ImmutableMatrix([[residual]]), claim, self.name),),
        )


def _factor(value: sp.Expr, turning: sp.Symbol) -> sp.Poly | None:
    """The factor of the numerator that holds a rate, as a polynomial in it."""
    _, factors = sp.factor_list(sp.numer(sp.cancel(sp.together(value))))
    held = [base for base, _ in factors if base.has(turning)]
    if len(held) != 1:
        return None
    found = sp.Poly(held[0], turning)
    lead = found.LC()
    return found if not lead.could_extract_minus_sign() else -found


def _without_sine(value: sp.Expr) -> sp.Expr:
    """The same with even powers of the sine in terms of the cosine."""
    above, below = sp.fraction(sp.together(value))
    return _even(above) / _even(below)


def _even(value: sp.Expr) -> sp.Expr:
    powers = sp.Poly(value, _SINE).terms()
    return sp.Add(*(c * _SINE ** (n % 2) * (1 - _U**2) ** (n // 2) for (n,), c in powers))


def _roots_proof(a: sp.Expr, b: sp.Expr, c: sp.Expr, name: str) -> Proof:
    """That the root of a quadratic equation is one; r stands for the root of the discriminant."""
    r = sp.Symbol("r")
    x = (-b - r) / (2 * a)
    residual = sp.ImmutableMatrix([[a * x**2 + b * x + c - (r**2 - (b**2 - 4 * a * c)) / (4 * a)]])
    return identity(residual, formula(r"a x^2 + b x + c = 0"), name)


def of_free_body(
    inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr], name: str
) -> Iterator[Consequence]:
    """Rotations about the principal axes, and the regular precession of a symmetric body.

    `slopes` are dΩ′/dt. A deviation along the axes i and j obeys dΩ_i/dt = a Ω_j and dΩ_j/dt =
    b Ω_i, so that it grows or turns with λ² = a b.
    """
    if not inertia.is_diagonal():
        return
    spin = sp.Symbol("Omega")
    for k, axis in enumerate(("first", "second", "third")):
        i, j = (n for n in range(3) if n != k)
        steady = {s: spin if n == k else sp.S.Zero for n, s in enumerate(OMEGA_BODY)}
        a, b = (sp.diff(slopes[n], OMEGA_BODY[o]).xreplace(steady) for n, o in ((i, j), (j, i)))
        own, one, other = inertia[k, k], inertia[i, i], inertia[j, j]
        squared = spin**2 * (own - one) * (other - own) / (one * other)
        claim = formula(r"\lambda^2 = a b")
        yield Consequence(
            title="Rotation about the principal axes" if k == 0 else "",
            text=f"A small deviation from the rotation about the {axis} axis at the rate {{}} is "
            "proportional to {}, which grows if {} is positive:",
            spans=(spin, formula(r"\exp(\lambda t)"), formula(r"\lambda^2")),
            left=formula(r"\lambda^2"),
            value=squared,
            proofs=(identity(sp.ImmutableMatrix([[a * b - squared]]), claim, name),),
        )
    if inertia[0, 0] == inertia[1, 1] != inertia[2, 2]:
        yield _precession(inertia, slopes, name)


def _precession(inertia: sp.ImmutableMatrix, slopes: Sequence[sp.Expr], name: str) -> Consequence:
    """Ω′ turns about the axis of symmetry: dΩ₁/dt = −κ Ω₂, dΩ₂/dt = κ Ω₁, Ω₃ constant."""
    first, second, third = OMEGA_BODY
    rate = (inertia[2, 2] - inertia[0, 0]) / inertia[0, 0] * third
    residual = [slopes[0] + rate * second, slopes[1] - rate * first, slopes[2]]
    turning = formula(
        r"\Omega'_1 + i\Omega'_2 = \left(\Omega'_1(0) + i\Omega'_2(0)\right)e^{i\kappa t}"
    )
    return Consequence(
        title="The symmetric body",
        text="{} is constant, and the other two components turn about the axis of symmetry, {}, "
        "with the rate",
        spans=(formula(r"\Omega'_3"), turning),
        left=formula(r"\kappa"),
        value=rate,
        proofs=(identity(sp.ImmutableMatrix(residual), claims.PRECESSION, name),),
    )
