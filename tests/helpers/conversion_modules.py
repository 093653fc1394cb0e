"""NumPy modules with conversions, each generated once."""

from __future__ import annotations

from functools import cache
from types import ModuleType

import rigidsym as rs
from helpers.motions import derived
from rigidsym.models.library import rotation_from


@cache
def module(text: str, *, passive: bool = False) -> ModuleType:
    if text in rs.EULER_SEQUENCES:
        motion = derived(text, passive=passive)
    else:
        motion = rs.derive(rotation_from(text, passive=passive), ["rotation_matrix"])
    return motion.select(["rotation_matrix"]).kernels(conversions=True).load()
