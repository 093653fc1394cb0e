"""A rigid body whose parameters all have values, in numbers."""

from __future__ import annotations

import numpy as np

from rigidsym.data.mass.principal_axes import principal_axes_of
from rigidsym.data.mass.properties import Measured
from rigidsym.models.body import RigidBody


def in_numbers(body: RigidBody) -> Measured | None:
    """Mass, centre, inertia tensor, principal moments and axes; None where a symbol is left."""
    mass, centre, inertia = map(body.in_numbers, (body.mass, body.centre, body.inertia))
    if not all(entry.is_number for entry in (mass, *centre, *inertia)):
        return None
    tensor = np.array(inertia.tolist(), dtype=float)
    return Measured(
        count=0,
        mass=float(mass),
        centre=np.array(list(centre), dtype=float),
        inertia=tensor,
        principal=principal_axes_of(tensor),
    )
