"""Motions that many tests derive, each once a process, and SymPy's equations for them."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import cache
from typing import Any

import sympy as sp
from sympy.physics.mechanics import LagrangesMethod

import rigidsym as rs
from helpers.witness import agree, evaluate, mp
from rigidsym.motion import derive
from rigidsym.pipeline import motion_of
from rigidsym.spec.derivation_file import read_spec

GYROSCOPE = """
[body]
parts = [{ shape = "disc", radius = "r", mass = "m", at = [0, 0, "h"] },
         { shape = "rod", length = "h", mass = "mu", at = [0, 0, "h/2"] }]
[dynamics]
potential = "(m + mu/2)*g*h*cos(theta)"
fixed_point = [0, 0, 0]
"""


def motion_in(text: str, **changes: Any) -> rs.Motion:
    """The motion of a derivation file, for ZXZ unless it has another rotation."""
    return motion_of(replace(read_spec(text, source="top.toml", name="top"), **changes))


@cache
def derived(sequence: str, *, passive: bool = False) -> rs.Motion:
    return derive(rs.EulerAngles(sequence, passive=passive))


def values_for(motion: rs.Motion) -> dict[sp.Expr, Any]:
    """Random values, the same in every run, of all that a motion depends on."""
    generator = random.Random(7)
    symbols = [s for argument in motion.arguments for s in argument.symbols]
    return {symbol: mp.mpf(generator.randint(100, 900)) / 700 for symbol in symbols}


def solves_lagrange(
    motion: rs.Motion, lagrangian: sp.Expr, forces: sp.Matrix | None = None
) -> bool:
    """Whether the accelerations solve the equations that SymPy finds."""
    q = list(motion.model.coordinates)
    equations = LagrangesMethod(lagrangian, q).form_lagranges_equations()
    values = values_for(motion)
    accelerations = evaluate(motion.accelerations, values)
    values |= zip([sp.diff(x, "t", 2) for x in q], accelerations, strict=True)
    acting = sp.zeros(len(q), 1) if forces is None else forces
    return agree(evaluate(equations, values), evaluate(acting, values))
