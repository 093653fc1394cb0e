"""Your own rotation, given entry by entry."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.errors import ModelError, offer
from rigidsym.models.rotation import TIME, Citation, RotationModel, symbolic

GIVEN = "given by the user"  # the source of a rotation without another


def given(
    matrix: sp.MatrixBase,
    *,
    name: str,
    title: str = "",
    coordinates: Sequence[sp.Expr] = (),
    constraints: Sequence[sp.Expr] = (),
    source: str = GIVEN,
    passive: bool = False,
    example: Mapping[sp.Expr | str, Any] = MappingProxyType({}),
) -> RotationModel:
    """Your own R(q), 3x3, in functions of time; it is proved to be a rotation when derived.

    By default, `coordinates` are the functions of time in the matrix, in alphabetical order.
    `example` gives exact values of coordinates and constants, by name, that satisfy the
    constraints, in case a search finds none: {"a": sp.Rational(3, 5)}.
    Raises ModelError for a matrix that is not 3x3 or has no coordinate, and for an invalid example.
    """
    try:
        entries = [symbolic(entry, f"{name}: an entry") for entry in sp.flatten(matrix)]
        matrix = sp.Matrix(*(matrix.shape if hasattr(matrix, "shape") else (3, 3)), entries)
    except (TypeError, ValueError):
        raise ModelError(f"{name}: expected a 3x3 matrix, got {matrix!r}") from None
    found = tuple(sp.ordered(sp.Matrix(matrix).atoms(AppliedUndef)))
    used = tuple(coordinates) or found
    return RotationModel(
        name=name,
        title=title or name,
        convention=("The rotation is given entry by entry.",),
        coordinates=used,
        matrix=sp.ImmutableMatrix(matrix),
        constraints=tuple(constraints),
        units=("",) * len(used),
        source=Citation(text=source),
        passive=passive,
        example=_example(name, example, (*used, *_symbols(matrix, constraints))),
    )


def _symbols(matrix: sp.MatrixBase, constraints: Sequence[sp.Expr]) -> set[sp.Expr]:
    whole = sp.Matrix([*matrix, *constraints])
    return (whole.free_symbols | whole.atoms(AppliedUndef)) - {TIME}


def _example(
    model: str, given: Mapping[sp.Expr | str, Any], known: Iterable[sp.Expr]
) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
    """(symbol, value) pairs from values by name; raises ModelError for what is neither."""
    named = {
        str(symbol.func if isinstance(symbol, AppliedUndef) else symbol): symbol for symbol in known
    }
    found = []
    for key, value in given.items():
        name = str(key.func if isinstance(key, AppliedUndef) else key)
        exact = symbolic(value, f"{model}: the example of {name}")
        if name not in named:
            raise ModelError(f"{model}: the example: unknown name {name}; {offer(name, named)}")
        if not exact.is_number or exact.has(sp.Float) or exact.is_real is False:
            raise ModelError(
                f"{model}: the example of {name}: expected an exact number, got {exact}"
            )
        found.append((named[name], exact))
    return tuple(found)
