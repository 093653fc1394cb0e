r"""The quantities of motion, one entry each, and what is claimed of motions as a whole.

A workspace k (`dynamics.lagrange`, `dynamics.euler`) has the equations of motion in Lagrange's or
Euler's form. Of one body about a fixed point the kinetic energy is E_R, that of its rotation; T has
the energies of all `parts`, or what a turning frame adds.
"""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Law, Quantity, by_name, when
from rigidsym.mechanics.quantities.kinematics import BODY, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA
from rigidsym.models.rotation import SOURCES

EFFECTIVE = formula(r"V_{\mathrm{eff}}")
ENERGY = formula("E")
MOTION = "motion"  # section of the note
DRIVING = formula(r"\frac{\partial V}{\partial t}")
_PARTS, _TURNING, _BOUND, _EULER = "parts", "turning_frame", "bound", "euler"  # traits

potential_energy = Quantity(
    name="potential_energy",
    symbol=formula("V"),
    about="potential energy",
    unit="J",
    inputs=("q",),
    shape="scalar",
    value=lambda k: k.forces.potential,
    reason="potential_energy",
    section=MOTION,
    variants=(when("no_potential", reason="no_potential"),),
)

lagrangian = Quantity(
    name="lagrangian",
    symbol=formula("L"),
    about="Lagrangian",
    unit="J",
    inputs=("q", "q_dot"),
    shape="scalar",
    definition=formula("E_R - V"),
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.kinetic - k.forces.potential if k.is_holonomic else None,
    reason="fixed_point",
    section=MOTION,
    is_result=True,
    variants=(
        when("no_potential", definition=formula("E_R")),
        when(_PARTS, definition=formula("T - V"), reason="energies_of_parts"),
        when(_PARTS, "no_potential", definition=formula("T")),
    ),
)


def power(symbols: str, *, is_driven: bool) -> Formula:
    """dE/dt is the power of the forces, and ∂V/∂t."""
    return formula(rf"\frac{{dE}}{{dt}} = {symbols}" + (" + #1" if is_driven else ""), DRIVING)


_LAGRANGE_POWER, _EULER_POWER = (
    r"\dot{\mathbf{q}}^{\mathsf T}\,\mathbf{Q}",
    r"\boldsymbol{\Omega}'^{\mathsf T}\,\mathbf{N}'",
)

energy = Quantity(
    name="energy",
    symbol=ENERGY,
    about="energy",
    unit="J",
    inputs=("q", "q_dot"),
    shape="scalar",
    definition=formula("E_R + V"),
    value=lambda k: k.whole,
    laws=(Law(power(_LAGRANGE_POWER, is_driven=False), lambda k, x: k.energy_rate(x)),),
    reason="power_of_forces",
    section=MOTION,
    variants=(
        when(
            "driven",
            laws=(Law(power(_LAGRANGE_POWER, is_driven=True), lambda k, x: k.energy_rate(x)),),
        ),
        when("no_potential", definition=formula("E_R")),
        when(_PARTS, definition=formula("T + V")),
        when(_PARTS, "no_potential", definition=formula("T")),
        when(_TURNING, definition=formula("T_2 - T_0 + V"), reason="jacobi_integral"),
        when(_TURNING, "no_potential", definition=formula("T_2 - T_0")),
        when(
            _EULER,
            inputs=("q", "omega_body"),
            laws=(Law(power(_EULER_POWER, is_driven=False), lambda k, x: k.energy_rate(x)),),
            reason="power_of_torques",
        ),
        when(
            _EULER,
            "driven",
            laws=(Law(power(_EULER_POWER, is_driven=True), lambda k, x: k.energy_rate(x)),),
        ),
    ),
)

generalised_momenta = Quantity(
    name="generalised_momenta",
    symbol=formula(r"\mathbf{p}"),
    about="generalised momenta",
    unit="kg m^2/s",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{W}'^{\mathsf T}\mathbf{I}'\boldsymbol{\Omega}'"),
    source=SOURCES["Goldstein 8.1"],
    value=lambda k: k.momenta if k.is_holonomic else None,
    laws=(
        Law(
            formula(r"\mathbf{p} = \frac{\partial E_R}{\partial \dot{\mathbf{q}}}"),
            lambda k, x: k.slopes_by_rates - x,
        ),
    ),
    reason="slopes_by_rates",
    section=MOTION,
    variants=(
        when(
            _PARTS,
            definition=formula(r"\frac{\partial T}{\partial \dot{\mathbf{q}}}"),
            laws=(
                Law(
                    formula(r"\mathbf{p} = \frac{\partial T}{\partial \dot{\mathbf{q}}}"),
                    lambda k, x: k.slopes_by_rates - x,
                ),
            ),
        ),
    ),
)

_FORM_OF_RATES = r"\dot{\mathbf{q}}^{\mathsf T}\mathbf{M}\dot{\mathbf{q}} = 2"

mass_matrix = Quantity(
    name="mass_matrix",
    symbol=formula(r"\mathbf{M}"),
    about="mass matrix",
    unit="kg m^2",
    inputs=("q",),
    definition=formula(r"\mathbf{W}'^{\mathsf T}\mathbf{I}'\mathbf{W}'"),
    value=lambda k: k.mass_matrix,
    laws=(
        Law(formula(_FORM_OF_RATES + "E_R"), lambda k, x: k.form_of_rates(x) - k.twice_quadratic),
    ),
    reason="form_of_rates",
    section=MOTION,
    variants=(
        when(
            _PARTS,
            definition=formula(r"\sum \mathbf{J}^T\mathbf{I}\mathbf{J}"),
            laws=(
                Law(
                    formula(_FORM_OF_RATES + "T"),
                    lambda k, x: k.form_of_rates(x) - k.twice_quadratic,
                ),
            ),
        ),
        when(
            _TURNING,
            laws=(
                Law(
                    formula(_FORM_OF_RATES + "T_2"),
                    lambda k, x: k.form_of_rates(x) - k.twice_quadratic,
                ),
            ),
            reason="quadratic_part",
        ),
    ),
)

bias_vector = Quantity(
    name="bias_vector",
    symbol=formula(r"\mathbf{h}"),
    about="gyroscopic and potential terms of the equations of motion",
    unit="N m",
    inputs=("q", "q_dot"),
    shape="vector",
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.bias,
    laws=(
        Law(
            formula(
                r"\frac{d}{dt}\frac{\partial E_R}{\partial \dot{\mathbf{q}}} "
                r"- \frac{\partial E_R}{\partial\mathbf{q}} = \mathbf{W}'^{\mathsf T}"
                r"\left(\mathbf{I}'\,\dot{\boldsymbol{\Omega}}' + "
                r"\boldsymbol{\Omega}'\times\mathbf{I}'\,\boldsymbol{\Omega}'\right)"
            ),
            lambda k, x: k.of_lagrange + k.bias - x,
        ),
    ),
    reason="rest_of_lagrange",
    section=MOTION,
    variants=(
        when(
            _PARTS,
            laws=(
                Law(
                    formula(
                        r"\frac{d}{dt}\frac{\partial T}{\partial \dot{\mathbf{q}}} "
                        r"- \frac{\partial T}{\partial\mathbf{q}} = "
                        r"\mathbf{M}\ddot{\mathbf{q}} + \mathbf{h} "
                        r"- \frac{\partial V}{\partial\mathbf{q}}"
                    ),
                    lambda k, x: k.of_lagrange + k.bias - x,
                ),
            ),
        ),
        when(_BOUND, laws=()),
        when("rolling", laws=(), reason="possible_rolling"),
    ),
)

coriolis_matrix = Quantity(
    name="coriolis_matrix",
    symbol=formula(r"\mathbf{C}"),
    about="Coriolis matrix",
    unit="kg m^2/s",
    inputs=("q", "q_dot"),
    source=SOURCES["Murray 4.3"],
    value=lambda k: k.coriolis,
    laws=(
        Law(
            formula(
                r"\mathbf{C}\dot{\mathbf{q}} = \mathbf{h} - \frac{\partial V}{\partial\mathbf{q}}"
            ),
            lambda k, x: x @ k.q_dot - k.gyroscopic,
        ),
        Law(
            formula(
                r"\left(\dot{\mathbf{M}} - 2\mathbf{C}\right) + "
                r"\left(\dot{\mathbf{M}} - 2\mathbf{C}\right)^T = 0"
            ),
            lambda k, x: k.skew_part(x) + k.skew_part(x).T,
        ),
    ),
    reason="christoffel",
    section=MOTION,
)

_POSSIBLE = r"\left(\mathbf{W}'^{+}\right)^T\left("  # along possible displacements

accelerations = Quantity(
    name="accelerations",
    symbol=formula(r"\ddot{\mathbf{q}}"),
    about="second derivatives of the coordinates",
    unit="rad/s^2",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{M}^{-1}\left(\mathbf{Q} - \mathbf{h}\right)"),
    source=SOURCES["Goldstein 1.4"],
    value=lambda k: k.solved,
    laws=(
        Law(
            formula(r"\mathbf{M}\ddot{\mathbf{q}} + \mathbf{h} = \mathbf{Q}"),
            lambda k, x: k.left_over(*x),
        ),
    ),
    reason="solved",
    section=MOTION,
    is_result=True,
    variants=(
        when(
            _BOUND,
            definition=formula(r"\frac{d}{dt}\left(\mathbf{W}'^{+}\,\boldsymbol{\Omega}'\right)"),
            laws=(
                Law(
                    formula(
                        _POSSIBLE
                        + r"\mathbf{M}\ddot{\mathbf{q}} + \mathbf{h} - \mathbf{Q}\right) = 0"
                    ),
                    lambda k, x: k.possible[0].T @ k.left_over(*x),
                ),
                Law(
                    formula(
                        _POSSIBLE + r"\frac{d}{dt}\frac{\partial E_R}{\partial \dot{\mathbf{q}}} "
                        r"- \frac{\partial E_R}{\partial\mathbf{q}} "
                        r"+ \frac{\partial V}{\partial\mathbf{q}} - \mathbf{Q}\right) = 0"
                    ),
                    lambda k, _: k.lagrange_along_possible,
                ),
            ),
            reason="possible_displacements",
        ),
        when(
            _BOUND,
            _PARTS,
            laws=(
                Law(
                    formula(
                        _POSSIBLE
                        + r"\mathbf{M}\ddot{\mathbf{q}} + \mathbf{h} - \mathbf{Q}\right) = 0"
                    ),
                    lambda k, x: k.possible[0].T @ k.left_over(*x),
                ),
                Law(
                    formula(
                        _POSSIBLE + r"\frac{d}{dt}\frac{\partial T}{\partial \dot{\mathbf{q}}} "
                        r"- \frac{\partial T}{\partial\mathbf{q}} "
                        r"+ \frac{\partial V}{\partial\mathbf{q}} - \mathbf{Q}\right) = 0"
                    ),
                    lambda k, _: k.lagrange_along_possible,
                ),
            ),
        ),
    ),
)

hamiltonian = Quantity(
    name="hamiltonian",
    symbol=formula("H"),
    about="Hamiltonian",
    unit="J",
    inputs=("q", "momenta"),
    shape="scalar",
    definition=formula(r"\tfrac{1}{2}\,\mathbf{p}^{\mathsf T}\,\mathbf{M}^{-1}\mathbf{p} + V"),
    source=SOURCES["Goldstein 8.1"],
    value=lambda k: k.hamiltonian,
    laws=(Law(formula("H = E"), lambda k, _: (k.energy_by_momenta, k.mass_matrix.det())),),
    reason="energy_in_momenta",
    section=MOTION,
)

effective_potential = Quantity(
    name="effective_potential",
    symbol=EFFECTIVE,
    about="effective potential of the coordinate that is not cyclic",
    unit="J",
    inputs=("q", "momenta"),
    shape="scalar",
    source=SOURCES["Goldstein 5.7"],
    value=lambda k: None if k.single is None else k.effective,
    reason="hamiltonian_at_rest",
    section=MOTION,
)

angular_acceleration_from_torque = Quantity(
    name="angular_acceleration_from_torque",
    symbol=formula(r"\dot{\boldsymbol{\Omega}}'"),
    about="angular acceleration from the torque, body components (Euler's equations)",
    unit="rad/s^2",
    inputs=("omega_body", "torque"),
    shape="vector",
    frame=BODY,
    definition=formula(
        r"\mathbf{I}'^{-1}\left(\mathbf{N}' - "
        r"\boldsymbol{\Omega}'\times\mathbf{I}'\,\boldsymbol{\Omega}'\right)"
    ),
    source=SOURCES["Goldstein 5.5"],
    within=lambda k: k.free_turning,
    value=lambda k: k.solved,
    laws=(
        Law(
            formula(
                r"\mathbf{I}'\,\dot{\boldsymbol{\Omega}}' + "
                r"\boldsymbol{\Omega}'\times\mathbf{I}'\,\boldsymbol{\Omega}' = \mathbf{N}'"
            ),
            lambda k, x: k.inertia @ x[0] - k.left.scale(x[1]),
        ),
    ),
    reason="euler_equations",
    section=MOTION,
    is_result=True,
)

DYNAMICS_QUANTITIES = by_name(globals())

torque_body = Quantity(
    name="torque_body",
    symbol=formula(r"\mathbf{N}'"),
    about="torque about the fixed point, body components",
    unit="N m",
    inputs=("q", "omega_body"),
    shape="vector",
    frame=BODY,
    source=SOURCES["Goldstein 5.5"],
    value=lambda k: k.torque,
    reason="torque_of_potential",
    section=MOTION,
    variants=(when("no_gradient", reason="torque"),),
)

EULER_QUANTITIES = {
    quantity.name: quantity.presented({_EULER})
    for quantity in (potential_energy, torque_body, energy, angular_acceleration_from_torque)
}

# Functions of the state y, for integrators

state_derivative = Quantity(
    name="state_derivative",
    symbol=formula(r"\dot{\mathbf{y}}"),
    about="time derivative of the state y",
    inputs=("t", "y"),
    shape="vector",
    value=lambda k: k.state_derivative,
)

state_jacobian = Quantity(
    name="state_jacobian",
    symbol=formula(r"\mathbf{J}"),
    about="Jacobian of `state_derivative` with respect to y, one column per component of y",
    inputs=("t", "y"),
    value=lambda k: k.state_jacobian,
)

error_state_jacobian = Quantity(
    name="error_state_jacobian",
    symbol=formula(r"\boldsymbol{\Phi}"),
    about="for filters: F in ẋ = F x, for errors x of R (rotation vector) and Ω′, body components",
    inputs=("t", "y"),
    value=lambda k: k.error_state_jacobian,
)

first_integrals = Quantity(
    name="first_integrals",
    symbol=formula(r"\mathbf{F}"),
    about="quantities that are constant along every motion",
    inputs=("y",),
    shape="vector",
    value=lambda k: sp.ImmutableMatrix([each.expression for each in k.first_integrals]),
)

FLOW_QUANTITIES = {
    quantity.name: quantity
    for quantity in (state_derivative, state_jacobian, error_state_jacobian, first_integrals)
}

# Claims about motions as a whole

MOMENTUM = formula(r"\mathbf{L}")
MOMENTUM_SQUARED = formula(r"\mathbf{L}^2")

# The free body. The symbols are printed as LETTERS says.

ENERGY_SYMBOL, LENGTH_SYMBOL = sp.Dummy("E"), sp.Dummy("L")
LENGTH = formula(r"\left|#1\right|", MOMENTUM)
LETTERS = {ENERGY_SYMBOL: ENERGY, LENGTH_SYMBOL: LENGTH}
SQUARED_RATE = formula(r"\lambda^2")
GROWTH = formula(r"\lambda^2 = a b")
NORMAL = formula(
    r"\frac{\partial #1}{\partial #2} = #3\,#2 = #4'", ENERGY, BODY.omega, INERTIA, MOMENTUM
)
TWICE_ENERGY = formula(r"#1\cdot#2 = 2#3", MOMENTUM, SPACE.omega, ENERGY)
EULER_FREE = formula(
    r"\mathbf{I}'\,\dot{\boldsymbol{\Omega}}' + "
    r"\boldsymbol{\Omega}'\times\mathbf{I}'\,\boldsymbol{\Omega}' = 0"
)
CONSTANT_MOMENTUM = formula(
    r"#1\,#2\,#3 = \begin{pmatrix}0 \\ 0 \\ #4\end{pmatrix}",
    *(formula(r"\mathbf{R}"), INERTIA, BODY.omega, LENGTH),
)
THREE_TURNS = r"\mathbf{{R}}_z({})\,\mathbf{{R}}_x({})\,\mathbf{{R}}_z({})"
PRECESSION_RATE = formula(r"\dot{\alpha}")
MOMENTUM_IN_BODY = formula(r"\mathbf{L}' = \mathbf{R}^{\mathsf T}\mathbf{L}")
PRECESSION_OF_AXIS = formula(
    r"\dot{\alpha} = \frac{\Omega'_1\sin\gamma + \Omega'_2\cos\gamma}{\sin\beta}"
)
IN_ELLIPTIC_FUNCTIONS = formula(
    r"\begin{pmatrix}a\,\operatorname{cn}(\tau t, k) \\ b\,\operatorname{sn}(\tau t, k) \\ "
    r"c\,\operatorname{dn}(\tau t, k)\end{pmatrix}"
)


def is_constant(symbol: Formula) -> Formula:
    return formula(r"\frac{d#1}{dt} = 0", symbol)


PRECESSION = formula(r"\dot{\Omega}'_1 + i\dot{\Omega}'_2 = i\kappa(\Omega'_1 + i\Omega'_2)")
DOUBLE_ROOT = formula("f(u) = a(1 - u)^2(u - u_1)")
RATE_OF_IGNORABLE = formula(r"\dot{q} = \frac{\partial #1}{\partial p}", EFFECTIVE)
NEAR_UPRIGHT = formula(r"#1 = #1(0) + \kappa(1 - u) + O((1 - u)^2)", EFFECTIVE)


def name_of(coordinate: sp.Expr, order: int = 0) -> Formula:
    """Of a coordinate or one of its time derivatives."""
    return named(coordinate.func.__name__, order)


def momentum_of(coordinate: sp.Expr) -> Formula:
    return formula("p_{#1}", name_of(coordinate))


def integral_symbol(name: str) -> Formula:
    """Of a first integral that the user names."""
    return named(name)


def momentum_is_constant(place: int) -> Formula:
    """∂L/∂q = 0 for one coordinate, which makes its momentum constant."""
    return formula(rf"\frac{{\partial L}}{{\partial q_{place}}} = 0")
