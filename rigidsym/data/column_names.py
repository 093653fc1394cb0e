"""Names of columns, however they are written: `Roll [deg]`, `roll`, `ROLL` are one."""

from __future__ import annotations

import re
from pathlib import Path

_UNIT = re.compile(r"[\[(](.*?)[\])]")
_GREEK = str.maketrans(
    {"φ": "phi", "θ": "theta", "ψ": "psi", "α": "alpha", "β": "beta", "γ": "gamma", "ω": "omega"}
)


def plain(name: str) -> str:
    """A name without its unit, quotes, case, spaces, hyphens and underscores."""
    bare = _UNIT.sub("", name).strip().strip("\"'").translate(_GREEK).lower()
    return bare.replace("_", "").replace(" ", "").replace("-", "")


def counted(count: int, noun: str) -> str:
    """1 column, 2 columns."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def misnumbered(path: Path, columns: int, names: int) -> str:
    """What is wrong where not every column of a file has a name."""
    return f"{path}: {counted(columns, 'column')}, but {counted(names, 'name')}"


def unit_in(name: str) -> str:
    """The unit that stands in a name, as written: deg of `Roll [deg]`; empty without one."""
    found = _UNIT.search(name)
    return found[1].strip() if found else ""
