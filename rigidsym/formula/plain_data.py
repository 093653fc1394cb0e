"""Data with formulas and expressions in it, as text for programs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from rigidsym.formula.tree import Formula

Names = Mapping[sp.Expr, sp.Symbol]


def plain_data(data: Any, names: Names) -> Any:
    """Formulas in both markups, expressions in plain names, matrices as lists of rows."""
    match data:
        case Formula():
            return data.markup
        case list() | tuple():
            return [plain_data(value, names) for value in data]
        case sp.MatrixBase():
            return plain_data(data.tolist(), names)
        case sp.Basic():
            return _text(data.xreplace(names))
        case Mapping():
            return {key: plain_data(value, names) for key, value in data.items()}
    return data


@lru_cache(maxsize=4096)  # an entry comes up in several quantities, and again in other conventions
def _text(expression: sp.Expr) -> str:
    return str(expression)
