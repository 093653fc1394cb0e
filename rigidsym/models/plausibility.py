"""Whether numbers can be the mass and the inertia tensor of a body.

For a mass distribution that is nowhere negative, the moments are not negative and no moment is
larger than the sum of the other two, since Ix + Iy − Iz = 2 Σ m z² (L. D. Landau and E. M.
Lifshitz, Mechanics, section 32).
"""

from __future__ import annotations

from itertools import permutations
from math import isfinite

import sympy as sp

from rigidsym.errors import BodyError

_ROUNDING = 1e-12  # of the sum of the moments: what arithmetic in double precision leaves


def check_mass(name: str, mass: sp.Expr) -> None:
    """Raises BodyError for a number that is not positive."""
    if not mass.is_number:
        return
    value = float(mass)
    if not (isfinite(value) and value > 0):
        raise BodyError(f"{name}: the mass is {value:g} kg; expected a positive number")


def check_inertia(name: str, inertia: sp.MatrixBase) -> None:
    """Raises BodyError for a matrix of numbers that no body has, with the amount.

    A matrix with symbols left in it is not checked.
    """
    if not all(entry.is_number for entry in inertia):
        return
    import numpy as np

    numbers = np.array(inertia.tolist(), dtype=float)
    if not np.isfinite(numbers).all():
        raise BodyError(f"{name}: the inertia tensor holds NaN or infinity: {numbers.tolist()}")
    moments = [float(moment) for moment in np.linalg.eigvalsh(numbers)]
    slack = _ROUNDING * max(map(abs, moments))
    if moments[0] < -slack:
        raise BodyError(
            f"{name}: the inertia tensor is not positive: its smallest principal moment is "
            f"{moments[0]:.6g} kg m²"
        )
    for a, b, c in permutations(moments):
        if a <= b and a + b < c - slack:
            raise BodyError(
                f"{name}: no body has the principal moments {a:.6g}, {b:.6g}, {c:.6g} kg m²: the "
                f"largest exceeds the sum of the others by {c - a - b:.6g} kg m²"
            )
