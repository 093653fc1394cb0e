"""The quantities of a rotation's kinematics: a new one is an entry here and in `kinematics.derive`.

The table is for the active presentation (R takes body to space components). Entries that differ
follow for the passive one (A = Rᵀ, the direction cosine matrix).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import NamedTuple

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Formula, Rate, equal, row, transpose_of
from rigidsym.mechanics.derivation import Quantity
from rigidsym.mechanics.quantities.table import read_table

Law = tuple[str, Formula]  # what is to be proved, by name, and how it is written

ROTATION = formula(r"\mathbf{R}")
COSINES = formula(r"\mathbf{A}")
RATES = formula(r"\dot{\mathbf{q}}")
ALPHA = formula(r"\dot{\boldsymbol{\Omega}}")
ALPHA_BODY = formula(r"\dot{\boldsymbol{\Omega}}'")


class Presentation(NamedTuple):
    """The matrix that is shown, R or A = Rᵀ, and what is proved of it and its derivative."""

    matrix: Formula
    spin: Formula  # the derivative times the transpose
    orthogonal: Formula
    proper: Formula
    stays_orthogonal: Formula  # the derivative of the statement that it is orthogonal
    skew: Formula


def _presented(matrix: Formula) -> Presentation:
    other = transpose_of(matrix)
    spin = row(Rate(matrix), other)
    return Presentation(
        matrix=matrix,
        spin=spin,
        orthogonal=formula(r"#1#2 = \mathbf{1}", matrix, other),
        proper=formula(r"\det #1 = 1", matrix),
        stays_orthogonal=formula(
            r"#1#2 + #3#4 = \mathbf{0}", *(Rate(matrix), other, matrix, Rate(other))
        ),
        skew=formula(r"#1 + \left(#1\right)^{\mathsf T} = \mathbf{0}", spin),
    )


_ACTIVE, _PASSIVE = _presented(ROTATION), _presented(COSINES)
PRESENTED = {False: _ACTIVE, True: _PASSIVE}  # by `passive`


class Frame(NamedTuple):
    """The symbols of the angular velocity and its rate matrix in one frame."""

    name: str
    omega: Formula
    matrix: Formula
    inverse: Formula
    right_inverse: Formula  # if there are more coordinates than dimensions


SPACE = Frame(
    name="space",
    omega=formula(r"\boldsymbol{\Omega}"),
    matrix=formula(r"\mathbf{W}"),
    inverse=formula(r"\mathbf{W}^{-1}"),
    right_inverse=formula(r"\mathbf{W}^{+}"),
)
BODY = Frame(
    name="body",
    omega=formula(r"\boldsymbol{\Omega}'"),
    matrix=formula(r"\mathbf{W}'"),
    inverse=formula(r"\mathbf{W}'^{-1}"),
    right_inverse=formula(r"\mathbf{W}'^{+}"),
)

_SLOPES = r"\frac{\partial #1}{\partial #2}"
_OF_ROTATION = read_table(
    """
    rotation_matrix                    matrix  -        q                -
        rotation matrix, body to space components
    rotation_rate                      matrix  1/s      q q_dot          -
        time derivative of the rotation matrix
    spin_matrix                        matrix  rad/s    q q_dot          Murray 2.4
        spin matrix, the operator Ω × in space components
    angular_velocity_space             vector  rad/s    q q_dot          Murray 2.4
        angular velocity, space components
    angular_velocity_body              vector  rad/s    q q_dot          Murray 2.4
        angular velocity, body components
    rate_matrix_space                  matrix  -        q                Diebel 5
        rate matrix to space components of the angular velocity
    inverse_rate_matrix_space          matrix  -        q                Diebel 5
        inverse rate matrix from space components
    rates_from_angular_velocity_space  vector  rad/s    q omega_space    Diebel 5
        rates of the coordinates from space components of the angular velocity
    rate_matrix_body                   matrix  -        q                Diebel 5
        rate matrix to body components of the angular velocity
    inverse_rate_matrix_body           matrix  -        q                Diebel 5
        inverse rate matrix from body components
    rates_from_angular_velocity_body   vector  rad/s    q omega_body     Diebel 5
        rates of the coordinates from body components of the angular velocity
    angular_acceleration_space         vector  rad/s^2  q q_dot q_ddot   Diebel 5
        angular acceleration, space components
    angular_acceleration_body          vector  rad/s^2  q q_dot q_ddot   Diebel 5
        angular acceleration, body components
    """,
    {
        "rotation_matrix": (ROTATION,),
        "rotation_rate": (Rate(ROTATION),),
        "spin_matrix": (_ACTIVE.spin, formula(r"\mathbf{C}(#1)", SPACE.omega)),
        "angular_velocity_space": (SPACE.omega, formula(r"\mathbf{C}^{-1}(#1)", _ACTIVE.spin)),
        "angular_velocity_body": (BODY.omega, formula("#1#2", transpose_of(ROTATION), SPACE.omega)),
        "rate_matrix_space": (SPACE.matrix, formula(_SLOPES, SPACE.omega, RATES)),
        "inverse_rate_matrix_space": (SPACE.inverse,),
        "rates_from_angular_velocity_space": (RATES, formula("#1#2", SPACE.inverse, SPACE.omega)),
        "rate_matrix_body": (BODY.matrix, formula(_SLOPES, BODY.omega, RATES)),
        "inverse_rate_matrix_body": (BODY.inverse,),
        "rates_from_angular_velocity_body": (RATES, formula("#1#2", BODY.inverse, BODY.omega)),
        "angular_acceleration_space": (ALPHA, Rate(SPACE.omega)),
        "angular_acceleration_body": (
            ALPHA_BODY,
            formula("#1#2", transpose_of(ROTATION), Rate(SPACE.omega)),
        ),
    },
)
_OF_COSINES = read_table(
    """
    rotation_matrix         matrix  -      q        -
        direction cosine matrix, space to body components
    rotation_rate           matrix  1/s    q q_dot  -
        time derivative of the direction cosine matrix
    spin_matrix             matrix  rad/s  q q_dot  Murray 2.4
        spin matrix of the direction cosines, the operator −Ω′ × in body components
    angular_velocity_space  vector  rad/s  q q_dot  Murray 2.4
        angular velocity, space components
    angular_velocity_body   vector  rad/s  q q_dot  Murray 2.4
        angular velocity, body components
    """,
    {
        "rotation_matrix": (COSINES, transpose_of(ROTATION)),
        "rotation_rate": (Rate(COSINES),),
        "spin_matrix": (_PASSIVE.spin, formula(r"-\mathbf{C}(#1)", BODY.omega)),
        "angular_velocity_space": (
            SPACE.omega,
            formula(r"\mathbf{C}^{-1}(#1\,#2)", Rate(transpose_of(COSINES)), COSINES),
        ),
        "angular_velocity_body": (
            BODY.omega,
            formula(r"#1\,#2", COSINES, SPACE.omega),
        ),
    },
)
QUANTITY_NAMES = tuple(_OF_ROTATION)


@cache
def quantities(
    *, passive: bool = False, coordinates: int = 3, rate_unit: str = "rad/s"
) -> Mapping[str, Quantity]:
    """All quantities by name, in the order of the derivation, for a number of coordinates.

    `rate_unit` is the unit that all rates share; empty if they do not.
    """
    table = {**_OF_ROTATION, **(_OF_COSINES if passive else {})}
    for frame in (SPACE, BODY):
        inverse, rates = (
            f"{name}_{frame.name}"
            for name in ("inverse_rate_matrix", "rates_from_angular_velocity")
        )
        table[rates] = table[rates]._replace(unit=rate_unit)
        if coordinates != 3:
            table[inverse] = table[inverse]._replace(
                symbol=frame.right_inverse,
                about=f"right inverse of the rate matrix from {frame.name} components",
            )
            definition = formula("#1#2", frame.right_inverse, frame.omega)
            table[rates] = table[rates]._replace(definition=definition)
    return MappingProxyType(table)


# Claims.

IS_OPERATOR = (
    "angular_velocity_space",
    formula(r"#2 = \mathbf{C}(#1)", SPACE.omega, _ACTIVE.spin),
)


@cache
def laws(passive: bool, is_square: bool) -> Mapping[str, Sequence[Law]]:
    """What is to be proved of each quantity; W has an inverse if it is square."""
    shown = PRESENTED[passive]
    found: dict[str, Sequence[Law]] = {
        "rotation_matrix": [("orthogonal", shown.orthogonal), ("proper", shown.proper)],
        "rotation_rate": [("skew", shown.stays_orthogonal)],
        "spin_matrix": [("skew", shown.skew)],
        "angular_velocity_space": [IS_OPERATOR],
    }
    if passive:
        claim = formula(r"#2 = -\mathbf{C}(#1)", BODY.omega, shown.spin)
        found["spin_matrix"] = [("skew", shown.skew), ("passive_operator", claim)]
    whole_rate = Rate(Bracket(_ACTIVE.spin))
    claims = {
        "angular_velocity_body": formula(r"#3 = #1\,#2", ROTATION, BODY.omega, SPACE.omega),
        "angular_acceleration_space": formula(r"#2 = \mathbf{C}(#1)", ALPHA, whole_rate),
        "angular_acceleration_body": formula(r"#3 = #1\,#2", ROTATION, ALPHA_BODY, ALPHA),
    }
    for frame in (SPACE, BODY):
        inverse = frame.inverse if is_square else frame.right_inverse
        claims |= {
            f"rate_matrix_{frame.name}": equal(row(frame.matrix, RATES), frame.omega),
            f"inverse_rate_matrix_{frame.name}": formula(
                r"#1#2 = \mathbf{1}", frame.matrix, inverse
            ),
            f"rates_from_angular_velocity_{frame.name}": formula(
                r"#1\,(#2#3) = #3", *(frame.matrix, inverse, frame.omega)
            ),
        }
    for name, claim in claims.items():
        found[name] = [(name, claim)]
    return found
