"""The quantities of motion: a new one is an entry here and in `dynamics.derive`."""

from __future__ import annotations

import sympy as sp

from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula, transpose_of
from rigidsym.mechanics.quantities.energy import ROTATIONAL
from rigidsym.mechanics.quantities.kinematics import ALPHA_BODY, BODY, RATES, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA
from rigidsym.mechanics.quantities.table import read_table

POTENTIAL = formula("V")
EFFECTIVE = formula(r"V_{\mathrm{eff}}")
LAGRANGIAN = formula("L")
ENERGY = formula("E")
MOMENTA = formula(r"\mathbf{p}")
MASS_MATRIX = formula(r"\mathbf{M}")
CORIOLIS_MATRIX = formula(r"\mathbf{C}")
KINETIC = formula("T")
BIAS = formula(r"\mathbf{h}")
ACCELERATIONS = formula(r"\ddot{\mathbf{q}}")
FORCES = formula(r"\mathbf{Q}")
HAMILTONIAN = formula("H")
TORQUE = formula(r"\mathbf{N}'")
_RATE_MATRIX = BODY.matrix
_POSSIBLE = formula(r"\left(#1\right)^T", BODY.right_inverse)  # along possible displacements
_PLUS, _MINUS = "#1 + #2", "#1 - #2"

DYNAMICS_QUANTITIES = read_table(
    """
    potential_energy                  scalar  J         q                   -
        potential energy
    lagrangian                        scalar  J         q q_dot             Goldstein 1.4
        Lagrangian
    energy                            scalar  J         q q_dot             -
        energy
    generalised_momenta               vector  kg m^2/s  q q_dot             Goldstein 8.1
        generalised momenta
    mass_matrix                       matrix  kg m^2    q                   -
        mass matrix
    bias_vector                       vector  N m       q q_dot             Goldstein 1.4
        gyroscopic and potential terms of the equations of motion
    coriolis_matrix                   matrix  kg m^2/s  q q_dot             Murray 4.3
        Coriolis matrix
    accelerations                     vector  rad/s^2   q q_dot             Goldstein 1.4
        second derivatives of the coordinates
    hamiltonian                       scalar  J         q momenta           Goldstein 8.1
        Hamiltonian
    effective_potential               scalar  J         q momenta           Goldstein 5.7
        effective potential of the coordinate that is not cyclic
    angular_acceleration_from_torque  vector  rad/s^2   omega_body torque   Goldstein 5.5
        angular acceleration from the torque, body components (Euler's equations)
    """,
    {
        "potential_energy": (POTENTIAL,),
        "lagrangian": (LAGRANGIAN, formula(_MINUS, ROTATIONAL, POTENTIAL)),
        "energy": (ENERGY, formula(_PLUS, ROTATIONAL, POTENTIAL)),
        "generalised_momenta": (
            MOMENTA,
            formula("#1#2#3", transpose_of(_RATE_MATRIX), INERTIA, BODY.omega),
        ),
        "mass_matrix": (
            MASS_MATRIX,
            formula("#1#2#3", transpose_of(_RATE_MATRIX), INERTIA, _RATE_MATRIX),
        ),
        "bias_vector": (BIAS,),
        "coriolis_matrix": (CORIOLIS_MATRIX,),
        "effective_potential": (EFFECTIVE,),
        "accelerations": (
            ACCELERATIONS,
            formula(r"#1^{-1}\left(#2 - #3\right)", MASS_MATRIX, FORCES, BIAS),
        ),
        "hamiltonian": (
            HAMILTONIAN,
            formula(
                r"\tfrac{1}{2}\,#1\,#2^{-1}#3 + #4",
                *(transpose_of(MOMENTA), MASS_MATRIX, MOMENTA, POTENTIAL),
            ),
        ),
        "angular_acceleration_from_torque": (
            ALPHA_BODY,
            formula(r"#1^{-1}\left(#2 - #3\times#1\,#3\right)", *(INERTIA, TORQUE, BODY.omega)),
        ),
    },
)

_EULER = read_table(
    """
    torque_body  vector  N m  q omega_body  Goldstein 5.5
        torque about the fixed point, body components
    energy       scalar  J    q omega_body  -
        energy
    """,
    {"torque_body": (TORQUE,), "energy": (ENERGY, formula(_PLUS, ROTATIONAL, POTENTIAL))},
)
_FROM_TORQUE = "angular_acceleration_from_torque"
EULER_QUANTITIES = {
    "potential_energy": DYNAMICS_QUANTITIES["potential_energy"],
    **_EULER,
    _FROM_TORQUE: DYNAMICS_QUANTITIES[_FROM_TORQUE],
}

FLOW_QUANTITIES = read_table(
    """
    state_derivative  vector  -  t y  -
        time derivative of the state y
    state_jacobian    matrix  -  t y  -
        Jacobian of `state_derivative` with respect to y, one column per component of y
    error_state_jacobian  matrix  -  t y  -
        for filters: F in ẋ = F x, for errors x of R (rotation vector) and Ω′, body components
    first_integrals   vector  -  y    -
        quantities that are constant along every motion
    """,
    {
        "state_derivative": (formula(r"\dot{\mathbf{y}}"),),
        "state_jacobian": (formula(r"\mathbf{J}"),),
        "error_state_jacobian": (formula(r"\boldsymbol{\Phi}"),),
        "first_integrals": (formula(r"\mathbf{F}"),),
    },
)

# Claims.


def momenta_are_slopes(kinetic: Formula) -> Formula:
    return formula("#1 = #2", MOMENTA, slopes(kinetic))


def slopes(kinetic: Formula) -> Formula:
    return formula(r"\frac{\partial #1}{\partial #2}", kinetic, RATES)


def possible_equations_of_lagrange(kinetic: Formula) -> Formula:
    """Of the kinetic energy, with ∂V/∂q among the forces."""
    return formula(
        r"#1\left(\frac{d}{dt}\frac{\partial #2}{\partial #3} "
        r"- \frac{\partial #2}{\partial\mathbf{q}} "
        r"+ \frac{\partial #4}{\partial\mathbf{q}} - #5\right) = 0",
        *(_POSSIBLE, kinetic, RATES, POTENTIAL, FORCES),
    )


def lagrange_is_euler(kinetic: Formula) -> Formula:
    """With E_R the right side is Euler's; else M q̈ + h − ∂V/∂q."""
    left = formula(
        r"\frac{d}{dt}\frac{\partial #1}{\partial #2} - \frac{\partial #1}{\partial\mathbf{q}}",
        *(kinetic, RATES),
    )
    if kinetic is ROTATIONAL:
        return formula(
            r"#1 = #2\left(#3\,#4 + #5\times#3\,#5\right)",
            *(left, transpose_of(_RATE_MATRIX), INERTIA, ALPHA_BODY, BODY.omega),
        )
    return formula(
        r"#1 = #2#3 + #4 - \frac{\partial #5}{\partial\mathbf{q}}",
        *(left, MASS_MATRIX, ACCELERATIONS, BIAS, POTENTIAL),
    )


def twice_energy(kinetic: Formula, *, is_whole: bool) -> Formula:
    """Of the part T₂ that is quadratic in the rates, if the energy has others."""
    symbol = kinetic if is_whole else formula("#1_2", kinetic)
    return formula("#1#2#3 = 2#4", transpose_of(RATES), MASS_MATRIX, RATES, symbol)


def difference(one: Formula, other: Formula) -> Formula:
    return formula(_MINUS, one, other)


def total(kinetic: Formula, *, is_jacobi: bool, has_potential: bool) -> Formula:
    found = formula("#1_2 - #1_0", kinetic) if is_jacobi else kinetic
    return formula(_PLUS, found, POTENTIAL) if has_potential else found


SUM_OF_PARTS = formula(
    r"\sum #1#2#3", *map(formula, (r"\mathbf{J}^T", r"\mathbf{I}", r"\mathbf{J}"))
)
CORIOLIS = formula(
    r"#1#2 = #3 - \frac{\partial #4}{\partial\mathbf{q}}",
    *(CORIOLIS_MATRIX, RATES, BIAS, POTENTIAL),
)
SKEW = formula(
    r"\left(\dot{#1} - 2#2\right) + \left(\dot{#1} - 2#2\right)^T = 0",
    *(MASS_MATRIX, CORIOLIS_MATRIX),
)
POSSIBLE_EQUATIONS = formula(
    r"#1\left(#2#3 + #4 - #5\right) = 0",
    *(_POSSIBLE, MASS_MATRIX, ACCELERATIONS, BIAS, FORCES),
)
ACCELERATIONS_OF_RATES = formula(r"\frac{d}{dt}\left(#1\,#2\right)", BODY.right_inverse, BODY.omega)
EQUATIONS = formula("#1#2 + #3 = #4", MASS_MATRIX, ACCELERATIONS, BIAS, FORCES)
HAMILTONIAN_IS_ENERGY = formula("#1 = #2", HAMILTONIAN, ENERGY)
EULER = formula(r"#1\,#2 + #3\times#1\,#3 = #4", INERTIA, ALPHA_BODY, BODY.omega, TORQUE)
DRIVING = formula(r"\frac{\partial #1}{\partial t}", POTENTIAL)
_POWERS = {"q_dot": (transpose_of(RATES), FORCES), "omega_body": (transpose_of(BODY.omega), TORQUE)}
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
EULER_FREE = formula(r"#1\,#2 + #3\times#1\,#3 = 0", INERTIA, ALPHA_BODY, BODY.omega)
CONSTANT_MOMENTUM = formula(
    r"#1\,#2\,#3 = \begin{pmatrix}0 \\ 0 \\ #4\end{pmatrix}",
    *(formula(r"\mathbf{R}"), INERTIA, BODY.omega, LENGTH),
)
THREE_TURNS = r"\mathbf{{R}}_z({})\,\mathbf{{R}}_x({})\,\mathbf{{R}}_z({})"
PRECESSION_RATE = formula(r"\dot{\alpha}")
MOMENTUM_IN_BODY = formula("#1' = #2#1", MOMENTUM, transpose_of(formula(r"\mathbf{R}")))
PRECESSION_OF_AXIS = formula(
    r"\dot{\alpha} = \frac{\Omega'_1\sin\gamma + \Omega'_2\cos\gamma}{\sin\beta}"
)
IN_ELLIPTIC_FUNCTIONS = formula(
    r"\begin{pmatrix}a\,\operatorname{cn}(\tau t, k) \\ b\,\operatorname{sn}(\tau t, k) \\ "
    r"c\,\operatorname{dn}(\tau t, k)\end{pmatrix}"
)


def energy_rate(second: str, *, is_driven: bool) -> Formula:
    """dE/dt = power of the forces + ∂V/∂t; `second` is the argument beside q in the state."""
    typed = r"\frac{d#1}{dt} = #2\,#3"
    return formula(typed + (" + #4" if is_driven else ""), ENERGY, *_POWERS[second], DRIVING)


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
    return formula(rf"\frac{{\partial #1}}{{\partial q_{place}}} = 0", LAGRANGIAN)
