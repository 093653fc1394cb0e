"""What the functions of a module should give: the derivation's own expressions, by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import sympy as sp

from rigidsym.kernels.lowering.derivatives import Derivative
from rigidsym.kernels.lowering.lower import MARGIN, margins_of, rewritten
from rigidsym.mechanics.derivation import Argument, Derivation


@dataclass(frozen=True, kw_only=True, slots=True)
class Exact:
    """One function: what it is given, and its results, row by row."""

    name: str
    vectors: tuple[Argument, ...]
    entries: tuple[sp.Expr, ...]
    terms: tuple[sp.Expr, ...]  # the same as kernels add them up


def exact_functions(
    derivation: Derivation, derivatives: Iterable[Derivative] = ()
) -> Iterator[Exact]:
    """Those that `lower` makes kernels of, before anything is rewritten for rounding."""
    for step in derivation.steps:
        if step.quantity.inputs:
            yield Exact(
                name=step.quantity.name,
                vectors=tuple(map(derivation.argument, step.quantity.inputs)),
                entries=tuple(step.expression),
                terms=tuple(rewritten(derivation, step.expression)),
            )
    margins = margins_of(derivation)
    if margins is not None:
        vectors = tuple(a for a in derivation.arguments if a.name in ("q", "parameters"))
        yield Exact(name=MARGIN, vectors=vectors, entries=margins[:1], terms=margins[1:])
    for derivative in derivatives:
        entries = [*derivative.step.expression, *derivative.jacobian()]
        yield Exact(
            name=derivative.request.name,
            vectors=derivative.vectors,
            entries=_results(derivative, entries),
            terms=_results(derivative, rewritten(derivation, entries)),
        )


def _results(derivative: Derivative, entries: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The value and its derivative, from the value and the Jacobian in any form."""
    count = len(derivative.step.expression)
    return (*entries[:count], *derivative.results(entries[count:]))
