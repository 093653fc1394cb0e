"""Motions that many tests derive, each once a process."""

from __future__ import annotations

from functools import cache

import rigidsym as rs
from rigidsym.motion import derive


@cache
def derived(sequence: str, *, passive: bool = False) -> rs.Motion:
    return derive(rs.EulerAngles(sequence, passive=passive))
