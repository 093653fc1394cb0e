"""The phase portrait of the only coordinate that is not cyclic: θ̇ against θ by energies.

E = ½ M θ̇² + V_eff(θ) is drawn for constants of 1 and momenta for which V_eff has a minimum.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from math import pi
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.evaluate import Floats, evaluate
from rigidsym.formula.letters import Letters
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.rotation import TIME
from rigidsym.notes.figure.chart import chart
from rigidsym.notes.figure.drawing import Drawing

_MOMENTA = (sp.Integer(1), sp.Integer(3))
_SIZE = (3.2, 2.0)
_POINTS = 400  # of the range of θ
_HIGHEST = (0.45, 0.7, 0.95)  # of the range to the nearer end: how far a motion swings


class PhasePortrait(NamedTuple):
    """The drawing, the coordinate, and the momenta for which it is drawn."""

    drawing: Drawing
    name: Formula  # of the coordinate
    momenta: Mapping[sp.Expr, sp.Expr]


def phase_portrait(derivation: Derivation, letters: Letters) -> PhasePortrait | None:
    """None without an effective potential that has a minimum between 0 and π."""
    steps = {step.quantity.name: step.expression for step in derivation.steps}
    if not {"effective_potential", "mass_matrix"} <= steps.keys():
        return None
    potential = steps["effective_potential"][0]
    moving = [k for k, q in enumerate(derivation.model.coordinates) if potential.has(q)]
    if len(moving) != 1:
        return None
    (k,), angle = moving, derivation.model.coordinates[moving[0]]
    symbols = [s for s in derivation.argument("momenta").symbols if potential.has(s)]
    momenta = dict(zip(symbols, cycle(_MOMENTA), strict=False))

    def numbers(expression: sp.Expr, at: NDArray[Any]) -> NDArray[Any]:
        """The values at some angles, with 1 for all constants."""
        ones = dict.fromkeys(expression.free_symbols - {*momenta, TIME}, 1.0)
        values = {angle: at, **ones, **{s: float(p) for s, p in momenta.items()}}
        return np.broadcast_to(evaluate(expression, Floats(np), values), at.shape)

    grid = pi * (np.arange(_POINTS) + 0.5) / _POINTS
    heights = numbers(potential, grid)
    lowest = int(heights.argmin())
    reach = min(lowest, _POINTS - 1 - lowest)
    if not np.isfinite(heights).all() or reach < _POINTS // 8:
        return None
    depth = min(heights[0], heights[-1]) - heights[lowest]  # below it, motions turn back
    curves = []
    for share in _HIGHEST:
        level = min(heights[lowest + round(share * reach)], heights[lowest] + share * depth)
        inside = np.flatnonzero(heights < level)
        # where the potential has the height of the energy, between two points of the grid
        low, high = (
            np.interp(level, heights[pair], grid[pair])
            for pair in ([inside[0], inside[0] - 1], [inside[-1], inside[-1] + 1])
        )
        turn = np.linspace(-pi, pi, 121)
        across = (low + high) / 2 + (high - low) / 2 * np.cos(turn)
        energy = np.maximum(0.0, level - numbers(potential, across))
        rate = np.sqrt(2 * energy / numbers(steps["mass_matrix"][k, k], across))
        curves.append(np.stack([across, np.copysign(rate, -np.sin(turn))], axis=1))
    name, speed = letters.name(angle), letters.name(angle.diff(TIME))
    steady = (float(grid[lowest]), 0.0)
    return PhasePortrait(chart(curves, _SIZE, name, speed, marks=[steady]), name, momenta)
