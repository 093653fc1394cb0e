"""NumPy modules with conversions, each generated once."""

from __future__ import annotations

from functools import cache
from types import ModuleType

import rigidsym as rs
from helpers.motions import derived
from rigidsym.models.rotation_text import rotation_from

CHAINS = (  # three turns about axes of any kind, the second across the others
    "[1,1,0](a) [1,-1,1](b) [1,1,0](c)",
    "z(phi) x(b) [0,3,4](c)",
    "z(phi) x(b) [0,-3,4](c)",
    "z(phi) x(b) [0,3,-4](c)",
    "z(phi) x(b) [0,0,-1](c)",
    "z(phi) x(b) [0,-1,0](c)",
)


@cache
def module(text: str, *, passive: bool = False) -> ModuleType:
    if text in rs.EULER_SEQUENCES:
        motion = derived(text, passive=passive)
    else:
        motion = rs.derive(rotation_from(text, passive=passive), ["rotation_matrix"])
    return motion.select(["rotation_matrix"]).kernels(conversions=True).load()
