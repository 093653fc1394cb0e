"""The quantities of motion: a new one is an entry here and in `dynamics.derive`."""

from __future__ import annotations

from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.quantities.claims import transpose_of
from rigidsym.mechanics.quantities.energy import ROTATIONAL
from rigidsym.mechanics.quantities.kinematics import ALPHA_BODY, BODY, RATES
from rigidsym.mechanics.quantities.mass import INERTIA
from rigidsym.mechanics.quantities.table import read_table
from rigidsym.models.rotation import Citation

POTENTIAL = formula("V")
LAGRANGIAN = formula("L")
ENERGY = formula("E")
MOMENTA = formula(r"\mathbf{p}")
MASS_MATRIX = formula(r"\mathbf{M}")
BIAS = formula(r"\mathbf{h}")
ACCELERATIONS = formula(r"\ddot{\mathbf{q}}")
FORCES = formula(r"\mathbf{Q}")
HAMILTONIAN = formula("H")
TORQUE = formula(r"\mathbf{N}'")
_RATE_MATRIX = BODY.matrix
_PLUS, _MINUS = "#1 + #2", "#1 - #2"

_SOURCES = {
    "Goldstein 1.4": Citation(
        text="H. Goldstein, C. Poole, J. Safko, Classical Mechanics (2002)", section="section 1.4"
    ),
    "Goldstein 5.5": Citation(
        text="H. Goldstein, C. Poole, J. Safko, Classical Mechanics (2002)", section="section 5.5"
    ),
    "Goldstein 8.1": Citation(
        text="H. Goldstein, C. Poole, J. Safko, Classical Mechanics (2002)", section="section 8.1"
    ),
}

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
    accelerations                     vector  rad/s^2   q q_dot             Goldstein 1.4
        second derivatives of the coordinates
    hamiltonian                       scalar  J         q momenta           Goldstein 8.1
        Hamiltonian
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
    _SOURCES,
)

EULER_QUANTITIES = read_table(
    """
    potential_energy                  scalar  J         q                   -
        potential energy
    torque_body                       vector  N m       q omega_body        Goldstein 5.5
        torque about the fixed point, body components
    energy                            scalar  J         q omega_body        -
        energy
    angular_acceleration_from_torque  vector  rad/s^2   omega_body torque   Goldstein 5.5
        angular acceleration from the torque, body components (Euler's equations)
    """,
    {
        "potential_energy": (POTENTIAL,),
        "torque_body": (TORQUE,),
        "energy": (ENERGY, formula(_PLUS, ROTATIONAL, POTENTIAL)),
        "angular_acceleration_from_torque": (
            ALPHA_BODY,
            formula(r"#1^{-1}\left(#2 - #3\times#1\,#3\right)", *(INERTIA, TORQUE, BODY.omega)),
        ),
    },
    _SOURCES,
)

FLOW_QUANTITIES = read_table(
    """
    state_derivative  vector  -  t y  -
        time derivative of the state y, in the order of y
    state_jacobian    matrix  -  t y  -
        derivatives of `state_derivative` by y, a column for each component of y
    first_integrals   vector  -  y    -
        quantities that are constant along every motion
    """,
    {
        "state_derivative": (formula(r"\dot{\mathbf{y}}"),),
        "state_jacobian": (formula(r"\mathbf{J}"),),
        "first_integrals": (formula(r"\mathbf{F}"),),
    },
)

# Claims.

MOMENTA_ARE_SLOPES = formula(r"#1 = \frac{\partial #2}{\partial #3}", *(MOMENTA, ROTATIONAL, RATES))
LAGRANGE_IS_EULER = formula(
    r"\frac{d}{dt}\frac{\partial #1}{\partial #2} - \frac{\partial #1}{\partial\mathbf{q}}"
    r" = #3\left(#4\,#5 + #6\times#4\,#6\right)",
    *(ROTATIONAL, RATES, transpose_of(_RATE_MATRIX), INERTIA, ALPHA_BODY, BODY.omega),
)
TWICE_ENERGY = formula("#1#2#3 = 2#4", transpose_of(RATES), MASS_MATRIX, RATES, ROTATIONAL)
EQUATIONS = formula("#1#2 + #3 = #4", MASS_MATRIX, ACCELERATIONS, BIAS, FORCES)
ENERGY_RATE = formula(r"\frac{d#1}{dt} = #2\,#3", ENERGY, transpose_of(RATES), FORCES)
HAMILTONIAN_IS_ENERGY = formula("#1 = #2", HAMILTONIAN, ENERGY)
EULER = formula(r"#1\,#2 + #3\times#1\,#3 = #4", INERTIA, ALPHA_BODY, BODY.omega, TORQUE)
POWER = formula(r"\frac{d#1}{dt} = #2\,#3", ENERGY, transpose_of(BODY.omega), TORQUE)
MOMENTUM_SQUARED = formula(r"\mathbf{L}^2")


def is_constant(symbol: Formula) -> Formula:
    return formula(r"\frac{d#1}{dt} = 0", symbol)


def integral_symbol(name: str) -> Formula:
    """Of a first integral that the user names."""
    return named(name)


def momentum_is_constant(place: int) -> Formula:
    """∂L/∂q = 0 for one coordinate, which makes its momentum constant."""
    return formula(rf"\frac{{\partial #1}}{{\partial q_{place}}} = 0", LAGRANGIAN)
