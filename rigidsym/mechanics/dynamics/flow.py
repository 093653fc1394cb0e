"""ẏ = f(t, y): the equations of motion as an integrator takes them, for kernels only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp

from rigidsym.mechanics.derivation import Argument, Step
from rigidsym.mechanics.quantities.dynamics import FLOW_QUANTITIES


def flow_functions(
    state: Argument, slopes: Sequence[sp.Expr], integrals: Sequence[sp.Expr]
) -> Mapping[str, Step]:
    """The derivative of the state, its Jacobian and the first integrals, by name."""
    values = {
        "state_derivative": sp.ImmutableMatrix(slopes),
        "state_jacobian": _jacobian(slopes, state.symbols),
        "first_integrals": sp.ImmutableMatrix(integrals),
    }
    return {
        name: Step(
            number=0, quantity=FLOW_QUANTITIES[name], expression=value, because="", proofs=()
        )
        for name, value in values.items()
        if len(value)
    }


def _jacobian(entries: Sequence[sp.Expr], symbols: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
    """The derivatives by the components of the state; a rate does not follow its coordinate."""
    plain = {symbol: sp.Dummy() for symbol in reversed(symbols)}  # the rates first
    back = {dummy: symbol for symbol, dummy in plain.items()}
    rows = [entry.xreplace(plain) for entry in entries]
    found = [[sp.diff(row, plain[symbol]).xreplace(back) for symbol in symbols] for row in rows]
    return sp.ImmutableMatrix(found)
