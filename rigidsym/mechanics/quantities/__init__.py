"""The catalogue of quantities: each entry by its name, in the order of a derivation."""

from __future__ import annotations

from rigidsym.errors import QuantityError, offer
from rigidsym.mechanics.quantities.dynamics import FLOW_QUANTITIES, MOTION_QUANTITIES
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.mass import BODY_ALONE, INERTIA_QUANTITIES

OF_BODY = {**INERTIA_QUANTITIES, **ENERGY_QUANTITIES}
OF_MOTION = {**MOTION_QUANTITIES, **FLOW_QUANTITIES}  # of a body with forces or a potential
QUANTITIES = {**KINEMATICS, **OF_BODY, **OF_MOTION}
NAMES = (*KINEMATICS, BODY_ALONE, *OF_BODY, *OF_MOTION)  # that `only` may list
CONVERSIONS = {  # and what they take
    "quaternion": "q",
    "from_quaternion": "quaternion",
    "from_rotation_matrix": "matrix",
}


def check_quantity(name: str, *, body: object = True, forces: object = True) -> None:
    """Raise QuantityError for a name that is no quantity, or one of what a derivation lacks."""
    if name not in NAMES:
        writes = "--conversions writes it to files, without --format"
        why = writes if name in CONVERSIONS else offer(name, NAMES, listed=True)
        raise QuantityError(f"no quantity {name!r}; {why}")
    if not (forces if name in OF_MOTION else body or name in KINEMATICS):
        needed = "a body and forces or a potential" if name in OF_MOTION else "a body"
        raise QuantityError(f"no quantity {name}; it needs {needed}")
