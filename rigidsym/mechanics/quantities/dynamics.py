r"""The quantities of motion, one entry each, and what is claimed of motions as a whole.

A workspace k (`dynamics.lagrange`, `dynamics.euler`) has the equations of motion in Lagrange's or
Euler's form. Of one body about a fixed point the kinetic energy is E_R, that of its rotation; T has
the energies of all `parts`, or what a turning frame adds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Law, Quantity, by_name, law, when
from rigidsym.mechanics.quantities.kinematics import BODY
from rigidsym.models.rotation import SOURCES

ENERGY = formula("E")
MOTION = "motion"  # section of the note
DRIVING = formula(r"\frac{\partial V}{\partial t}")
_TREE, _EULER, _FREE, _UNFORCED = "tree", "euler", "no_potential", "unforced"  # traits
TORQUE = r"\I'\,\dot\Om' + \Om'\times\I'\,\Om'"  # that a motion takes, by Euler's equations
_LAGRANGE = r"\frac{d}{dt}\frac{\partial {T}}{\partial\dot\q} - \frac{\partial {T}}{\partial\q} = "
_ENERGY: dict[str, Any] = {"unit": "J", "shape": "scalar", "section": MOTION}
_VECTOR: dict[str, Any] = {"shape": "vector", "section": MOTION}
_BY_RATES: dict[str, Any] = {**_VECTOR, "inputs": ("q", "q_dot")}


def _of_kinetic(claim: str, residual: Callable[[Any, Any], Any], **tree: Any) -> dict[str, Any]:
    """A law about the kinetic energy, T of a tree and E_R of one body, and what a tree changes."""
    of_tree = law(tree.pop("of_tree", claim).replace("{T}", "T"), residual)
    return {
        "laws": (law(claim.replace("{T}", "E_R"), residual),),
        "variants": (when(_TREE, laws=(of_tree,), **tree),),
    }


potential_energy = Quantity(
    **_ENERGY,
    symbol=formula("V"),
    inputs=("q",),
    value=lambda k: k.forces.potential,
    reason="potential_energy",
    variants=(when(_FREE, reason="no_potential"),),
)


def _energies(sign: str, **of_tree: str) -> tuple[Any, ...]:
    """The kinetic energy of a body or a tree, and the potential energy if there is one."""
    return (
        when(_FREE, definition=formula("E_R")),
        when(_TREE, definition=formula(f"T {sign} V"), **of_tree),
        when(_TREE, _FREE, definition=formula("T")),
    )


lagrangian = Quantity(
    **_ENERGY,
    symbol=formula("L"),
    inputs=("q", "q_dot"),
    definition=formula("E_R - V"),
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.kinetic - k.forces.potential,
    reason="fixed_point",
    is_result=True,
    variants=(
        when("stated_point", reason="stated_point"),
        *_energies("-", reason="joint_energies"),
    ),
)


def _has_power(symbols: str) -> tuple[Law, ...]:
    """dE/dt is the power of the forces, and ∂V/∂t."""
    claim = formula(rf"\frac{{dE}}{{dt}} = {symbols}", DRIVING)
    return (Law(claim, lambda k, x: k.energy_rate(x)),)


energy = Quantity(
    **_ENERGY,
    symbol=ENERGY,
    inputs=("q", "q_dot"),
    definition=formula("E_R + V"),
    value=lambda k: k.whole,
    laws=_has_power(r"\dot\q^T\,\Q"),
    reason="power_of_forces",
    variants=(
        when("driven", laws=_has_power(r"\dot\q^T\,\Q + #1")),
        *_energies("+"),
        when(
            _EULER,
            inputs=("q", "omega_body"),
            laws=_has_power(r"\Om'^T\,\N'"),
            reason="power_of_torques",
        ),
        when(_EULER, "driven", laws=_has_power(r"\Om'^T\,\N' + #1")),
        when(_UNFORCED, laws=_has_power("0"), reason="constant_energy"),
        when(_UNFORCED, "driven", laws=_has_power("#1"), reason="driven_energy"),
    ),
)

generalised_momenta = Quantity(
    **_BY_RATES,
    symbol=formula(r"\p"),
    unit="kg m^2/s",
    definition=formula(r"\W'^T\I'\Om'"),
    source=SOURCES["Goldstein 8.1"],
    value=lambda k: k.momenta,
    reason="slopes_by_rates",
    **_of_kinetic(
        r"\p = \frac{\partial {T}}{\partial\dot\q}",
        lambda k, x: k.codec.column([sp.diff(k.kinetic, rate) for rate in k.rates]) - x,
        definition=formula(r"\frac{\partial T}{\partial\dot\q}"),
        reason="carried_momentum",
    ),
)

mass_matrix = Quantity(
    symbol=formula(r"\M"),
    unit="kg m^2",
    inputs=("q",),
    definition=formula(r"\W'^T\I'\W'"),
    value=lambda k: k.mass_matrix,
    reason="form_of_rates",
    section=MOTION,
    **_of_kinetic(
        r"\dot\q^T\M\dot\q = 2{T}",
        lambda k, x: k.q_dot.T @ x @ k.q_dot - k.codec.column([2 * k.kinetic]),
        definition=formula(r"\frac{\partial^2 T}{\partial\dot\q\,\partial\dot\q^T}"),
        reason="composite_inertia",
    ),
)

bias_vector = Quantity(
    **_BY_RATES,
    symbol=formula(r"\h"),
    unit="N m",
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.bias,
    reason="rest_of_lagrange",
    **_of_kinetic(
        _LAGRANGE + rf"\W'^T\left({TORQUE}\right)",
        lambda k, x: k.of_lagrange + k.bias - x,
        of_tree=_LAGRANGE + r"\M\ddot\q + \h - \frac{\partial V}{\partial\q}",
        reason="recursion_of_torques",
    ),
)


accelerations = Quantity(
    **_BY_RATES,
    symbol=formula(r"\ddot\q"),
    unit="rad/s^2",
    definition=formula(r"\M^{-1}\left(\Q - \h\right)"),
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.solved,
    laws=(law(r"\M\ddot\q + \h = \Q", lambda k, x: k.mass_matrix @ x[0] - k.needed.scale(x[1])),),
    reason="solved",
    is_result=True,
    variants=(
        when(_TREE, reason="factorised"),
        when(_UNFORCED, reason="solved_without_forces", definition=formula(r"-\M^{-1}\h")),
        when(_TREE, _UNFORCED, reason="factorised_without_forces"),
    ),
)

hamiltonian = Quantity(
    **_ENERGY,
    symbol=formula("H"),
    inputs=("q", "momenta"),
    definition=formula(r"\tfrac{1}{2}\,\p^T\,\M^{-1}\p + V"),
    source=SOURCES["Goldstein 8.1"],
    value=lambda k: k.hamiltonian,
    laws=(law("H = E", lambda k, _: (k.energy_by_momenta, k.mass_matrix.det())),),
    without="too_many_momenta",
    reason="energy_in_momenta",
)

effective_potential = Quantity(
    **_ENERGY,
    symbol=formula(r"V_{\mathrm{eff}}"),
    inputs=("q", "momenta"),
    source=SOURCES["Goldstein 5.7"],
    value=lambda k: None if k.single is None else k.effective,
    without="momenta_vary",
    reason="hamiltonian_at_rest",
)

angular_acceleration_from_torque = Quantity(
    **_VECTOR,
    symbol=formula(r"\dot\Om'"),
    unit="rad/s^2",
    inputs=("omega_body", "torque"),
    frame=BODY,
    definition=formula(r"\I'^{-1}\left(\N' - \Om'\times\I'\,\Om'\right)"),
    source=SOURCES["Goldstein 5.5"],
    value=lambda k: k.free_turning,
    laws=(law(rf"{TORQUE} = \N'", lambda k, x: k.excess_torque(x)),),
    reason="euler_equations",
    is_result=True,
)

DYNAMICS_QUANTITIES = by_name(globals())

torque_body = Quantity(
    **_VECTOR,
    symbol=formula(r"\N'"),
    unit="N m",
    inputs=("q", "omega_body"),
    frame=BODY,
    source=SOURCES["Goldstein 5.5"],
    value=lambda k: k.torque,
    reason="torque_of_potential",
    variants=(when("no_gradient", reason="torque"),),
)

MOTION_QUANTITIES = by_name(globals())
EULER_QUANTITIES = {
    name: MOTION_QUANTITIES[name].presented({_EULER})
    for name in ("potential_energy", "torque_body", "energy", "angular_acceleration_from_torque")
}

# Functions of the state y, for integrators


def _flow(symbol: str, value: Callable[[Any], Any], **fields: Any) -> Quantity:
    return Quantity(symbol=formula(symbol), value=value, **{"inputs": ("t", "y"), **fields})


FLOW_QUANTITIES = by_name(
    {
        "state_derivative": _flow(r"\dot\y", lambda k: k.state_derivative, shape="vector"),
        "state_jacobian": _flow(r"\J", lambda k: k.state_jacobian),
        "error_state_jacobian": _flow(r"\boldsymbol{\Phi}", lambda k: k.error_state_jacobian),
        "first_integrals": _flow(
            r"\F",
            lambda k: sp.ImmutableMatrix([each.expression for each in k.first_integrals]),
            inputs=("y",),
            shape="vector",
        ),
    }
)

# Claims about motions as a whole

MOMENTUM_SQUARED = formula(r"\L^2")
# symbols of the free body, which are printed as LETTERS says
ENERGY_SYMBOL, LENGTH_SYMBOL = sp.Dummy("E"), sp.Dummy("L")
LETTERS = {ENERGY_SYMBOL: ENERGY, LENGTH_SYMBOL: formula(r"\left|\L\right|")}


def is_constant(symbol: Formula) -> Formula:
    return formula(r"\frac{d#1}{dt} = 0", symbol)


def momentum_is_constant(place: int) -> Formula:
    """∂L/∂q = 0 for one coordinate, which makes its momentum constant."""
    return formula(rf"\frac{{\partial L}}{{\partial q_{place}}} = 0")
