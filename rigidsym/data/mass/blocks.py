"""Mass, centre and inertia tensor of many particles, block by block, in one pass.

Each block is summed about its own centre, where differences of coordinates in double precision
are exact or nearly so however far from the origin the body is; the few sums of the blocks are then
moved to the common centre (parallel axes) and added without rounding (`math.fsum`, after J. R.
Shewchuk, 1997). Blocks are merged as by T. F. Chan, G. H. Golub and R. J. LeVeque,
Updating formulae and a pairwise algorithm for computing sample variances (1979).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import fsum, inf

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.mass.properties import MassProperties
from rigidsym.errors import BodyError

Array = NDArray[np.float64]
BLOCK = 8192  # particles that are summed at once, so that they stay in the cache


@dataclass(frozen=True, slots=True)
class Block:
    """The sums of one block of particles about a point near them."""

    count: int
    mass: float
    lightest: float
    lightest_at: int  # its number, counted from 0
    about: Array  # c, (3,)
    first: Array  # Σ m (x − c), (3,)
    second: Array  # Σ m (x − c)(x − c)ᵀ, (3, 3)


def named(row: int) -> str:
    """How messages name a particle."""
    return f"particle {row}, counted from 0"


def block_of(
    masses: Array | None,
    positions: Array,
    start: int = 0,
    name: Callable[[int], str] = named,
) -> Block:
    """The sums of a block: masses (n,), or None for ones, and positions (3, n).

    `start` is the number of its first particle, `name` names one. Raises BodyError for NaN.
    """
    count = positions.shape[1]
    if masses is None:
        masses = np.ones(count)
    with np.errstate(all="ignore"):  # numbers that are not finite are found below
        mass = float(masses.sum())
        about = positions @ masses / mass if mass else positions[:, 0].copy()
        if not np.isfinite(about).all():
            about = positions[:, 0].copy()
        apart = positions - about[:, None]
        weighted = apart * masses
        first, second = weighted.sum(axis=1), weighted @ apart.T
    block = Block(
        count, mass, float(masses.min()), start + int(masses.argmin()), about, first, second
    )
    if not np.isfinite(block.second).all():
        raise BodyError(_not_finite(masses, positions, start, name))
    return block


def _not_finite(masses: Array, positions: Array, start: int, name: Callable[[int], str]) -> str:
    wrong = ~(np.isfinite(masses) & np.isfinite(positions).all(axis=0))
    if not wrong.any():
        return f"particles from {start} on: their moments are too large for double precision"
    row = int(np.argmax(wrong))
    x, y, z = positions[:, row]
    return (
        f"{name(start + row)}: expected finite numbers, got mass "
        f"{masses[row]:g} at ({x:g}, {y:g}, {z:g})"
    )


def cloud_of(
    blocks: Iterable[Block], name: Callable[[int], str] = named, *, allow: bool = False
) -> MassProperties:
    """All blocks as one body, whatever their order.

    Raises BodyError for no particles, for a total mass that is not positive, and, unless
    `allow`, for a particle of negative mass.
    """
    found = list(blocks)
    if not found:
        raise BodyError("expected at least one particle, got none")
    lightest = min(found, key=lambda block: block.lightest)
    if lightest.lightest < 0 and not allow:
        raise BodyError(
            f"{name(lightest.lightest_at)}: the mass is {lightest.lightest:g} kg; expected a "
            "mass that is not negative"
        )
    mass = fsum(block.mass for block in found)
    if not 0 < mass < inf:
        raise BodyError(f"the total mass is {mass:g} kg; expected a positive mass")
    masses = np.array([block.mass for block in found])
    abouts = np.array([block.about for block in found])
    firsts = np.array([block.first for block in found])
    near = _sums([masses[:, None] * abouts, firsts]) / mass
    moved = abouts - near
    rest = _sums([masses[:, None] * moved, firsts])
    second = np.empty((3, 3))
    for i in range(3):
        for j in range(i, 3):
            second[i, j] = second[j, i] = fsum(
                [
                    *(block.second[i, j] for block in found),
                    *(firsts[:, i] * moved[:, j]),
                    *(firsts[:, j] * moved[:, i]),
                    *(masses * moved[:, i] * moved[:, j]),
                    -rest[i] * (rest[j] / mass),
                ]
            )
    return MassProperties(
        count=sum(block.count for block in found),
        mass=mass,
        centre=near + rest / mass,
        inertia=inertia_from(second),
    )


def _sums(tables: Sequence[Array]) -> Array:
    """The sum of all rows of all tables, (3,), rounded once."""
    return np.array([fsum(np.concatenate([table[:, k] for table in tables])) for k in range(3)])


def inertia_from(second: Array) -> Array:
    """tr(J) 1 − J, without adding numbers that cancel."""
    inertia = -second
    for k in range(3):
        inertia[k, k] = second[(k + 1) % 3, (k + 1) % 3] + second[(k + 2) % 3, (k + 2) % 3]
    return inertia
