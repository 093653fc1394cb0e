"""The catalogue of quantities: each entry by its name, in the order of a derivation."""

from __future__ import annotations

from rigidsym.mechanics.quantities.dynamics import FLOW_QUANTITIES, MOTION_QUANTITIES
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.mechanics.quantities.mass import BODY_ALONE, INERTIA_QUANTITIES

OF_BODY = {**INERTIA_QUANTITIES, **ENERGY_QUANTITIES}
OF_MOTION = {**MOTION_QUANTITIES, **FLOW_QUANTITIES}  # of a body with forces or a potential
QUANTITIES = {**KINEMATICS, **OF_BODY, **OF_MOTION}
NAMES = (*KINEMATICS, BODY_ALONE, *OF_BODY, *OF_MOTION)  # that `only` may list
