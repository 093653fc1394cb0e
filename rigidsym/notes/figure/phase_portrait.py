"""The phase portrait of the only coordinate that is not ignorable: θ̇ against θ by energies.

E = ½ M θ̇² + V_eff(θ) is drawn for constants of 1 and momenta for which V_eff has a minimum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import cycle
from math import isfinite, pi, sqrt
from typing import NamedTuple

import sympy as sp

from rigidsym.algebra.evaluate import function_of
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.rotation import TIME
from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.chart import mark
from rigidsym.notes.figure.drawing import Drawing, Label, Stroke

_MOMENTA = (sp.Integer(1), sp.Integer(3))
_WIDTH, _HEIGHT = 3.2, 1.0  # of the range of θ, and of half the range of θ̇
_POINTS = 96  # of the range of θ
_HIGHEST = (0.45, 0.7, 0.95)  # of the range to the nearer end: how far a motion swings
_GAP = 0.16  # between an axis and its label
_TICK = 0.03  # half its length


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
    q = derivation.model.coordinates
    moving = [k for k, x in enumerate(q) if potential.has(x)]
    if len(moving) != 1:
        return None
    (k,) = moving
    symbols = [s for s in derivation.argument("momenta").symbols if potential.has(s)]
    momenta = dict(zip(symbols, cycle(_MOMENTA), strict=False))
    energy = _numbers(potential.xreplace(momenta), q[k])
    mass = _numbers(steps["mass_matrix"][k, k], q[k])
    grid = [pi * (j + 0.5) / _POINTS for j in range(_POINTS)]
    heights = [energy(x) for x in grid]
    lowest = min(range(_POINTS), key=heights.__getitem__)
    reach = min(lowest, _POINTS - 1 - lowest)
    if not all(map(isfinite, heights)) or reach < _POINTS // 8:
        return None
    depth = min(heights[0], heights[-1]) - heights[lowest]  # below it, motions turn back
    levels = [
        min(heights[lowest + round(share * reach)], heights[lowest] + share * depth)
        for share in _HIGHEST
    ]
    curves = [list(_curve(level, grid, heights, mass)) for level in levels]
    most = max(rate for curve in curves for _, rate in curve)
    name = letters.name(q[k])
    strokes = [Stroke("body", _scaled(curve, most), is_thin=True) for curve in curves]
    drawing = Drawing(
        strokes=(*_axes(), *strokes, mark((grid[lowest] / pi * _WIDTH, 0.0))),
        labels=(
            Label("space", name, (_WIDTH + 0.25 + _GAP, 0.0)),
            Label("space", letters.name(q[k].diff(TIME)), (0.0, _HEIGHT + 0.2 + _GAP)),
            Label("space", formula("0"), (-_GAP, 0.0)),
            Label("space", formula(r"\pi"), (_WIDTH, -_GAP)),
        ),
    )
    return PhasePortrait(drawing, name, momenta)


def _numbers(expression: sp.Expr, coordinate: sp.Expr) -> Callable[[float], float]:
    """The expression as a function of the coordinate, with 1 for all constants."""
    angle = sp.Symbol("angle")
    held = expression.xreplace({coordinate: angle})
    held = held.xreplace(dict.fromkeys(held.free_symbols - {angle}, sp.S.One))
    evaluated = function_of(held, [angle])
    return lambda value: evaluated([value])


def _curve(
    level: float, grid: Sequence[float], heights: Sequence[float], mass: Callable[[float], float]
) -> Iterator[Point]:
    """(θ, θ̇) of one energy: above the axis from left to right, below it back."""
    inside = [k for k, height in enumerate(heights) if height < level]
    first, last = inside[0], inside[-1]
    upper = [(_turning(level, grid, heights, first, first - 1), 0.0)]
    upper += [
        (grid[k], sqrt(2 * max(0.0, level - heights[k]) / mass(grid[k])))
        for k in range(first, last + 1)
    ]
    upper.append((_turning(level, grid, heights, last, last + 1), 0.0))
    yield from upper
    yield from ((x, -rate) for x, rate in reversed(upper[:-1]))


def _turning(
    level: float, grid: Sequence[float], heights: Sequence[float], inside: int, outside: int
) -> float:
    """θ where the potential has the height of the energy, between two points of the grid."""
    if not 0 <= outside < len(grid):
        return grid[inside]
    share = (level - heights[inside]) / (heights[outside] - heights[inside])
    return grid[inside] + share * (grid[outside] - grid[inside])


def _scaled(curve: Sequence[Point], most: float) -> tuple[Point, ...]:
    return tuple((x / pi * _WIDTH, rate / most * _HEIGHT) for x, rate in curve)


def _axes() -> Iterator[Stroke]:
    yield Stroke("space", ((0.0, 0.0), (_WIDTH + 0.25, 0.0)), has_arrow=True)
    yield Stroke("space", ((0.0, -_HEIGHT - 0.1), (0.0, _HEIGHT + 0.2)), has_arrow=True)
    yield Stroke("space", ((_WIDTH, -_TICK), (_WIDTH, _TICK)))
