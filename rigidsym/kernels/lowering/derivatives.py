"""Derivatives of quantities by a vector of inputs: which are asked for, and their expressions.

The derivative is SymPy's, term by term and exact; nothing is searched for.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

import sympy as sp

from rigidsym.errors import KernelError
from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.derivation import Derivation, Quantity, Step
from rigidsym.mechanics.quantities import CONVERSIONS
from rigidsym.system.records import NamedTuple

_TEXT = re.compile(r"(\w+)(?: by |:)(\w+)")

Asked = str | Iterable[str] | Mapping[str, str | Iterable[str]]


class DerivativeRequest(NamedTuple):
    """The derivative of one quantity by one vector of its inputs."""

    quantity: str
    vector: str

    @property
    def name(self) -> str:
        """Of the function: rotation_matrix_jacobian_q."""
        return f"{self.quantity}_jacobian_{self.vector}"

    def __str__(self) -> str:
        return f"{self.quantity} by {self.vector}"


def read_request(text: str) -> DerivativeRequest:
    """The request in "QUANTITY by VECTOR", or with a colon between the two.

    Raises KernelError for any other text.
    """
    words = _TEXT.fullmatch(text.strip())
    if words is None:
        raise KernelError(
            f"no derivative {text!r}; expected a quantity and a vector, such as rotation_matrix:q"
        )
    return DerivativeRequest(quantity=words[1], vector=words[2])


def read_requests(asked: Asked) -> tuple[DerivativeRequest, ...]:
    """The requests, each once, in their order; {"rotation_matrix": ("q",)} too.

    Raises KernelError for a text that is none.
    """
    if isinstance(asked, str):
        asked = [asked]
    if isinstance(asked, Mapping):
        vectors = {q: (v,) if isinstance(v, str) else v for q, v in asked.items()}
        asked = [f"{quantity} by {vector}" for quantity in vectors for vector in vectors[quantity]]
    return tuple(dict.fromkeys(map(read_request, asked)))


class Jacobian(Step, kw_only=True):
    """The derivative of a quantity: an entry a row, and a component of the vector a column."""

    of: tuple[int, ...]  # the shape of the quantity

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Shape of one value in kernels."""
        return (*self.of, self.expression.cols)


def derivatives_of(
    derivation: Derivation, requests: Iterable[DerivativeRequest]
) -> Iterator[Jacobian]:
    """The derivatives that are asked for, ready to be lowered.

    Inputs are independent of each other: in a derivative by one of them all others are constant,
    the rate of a coordinate too.

    Raises QuantityError for a quantity that is not in the derivation, and KernelError for a
    conversion and for a vector that the quantity does not take.
    """
    for request in requests:
        if request.quantity in CONVERSIONS:
            raise KernelError(f"{request}: conversions have no Jacobians")
        step = derivation.step(request.quantity)
        quantity = step.quantity
        if request.vector not in quantity.inputs:
            only = " and ".join(quantity.inputs)
            raise KernelError(f"{request}: {request.quantity} depends only on {only}")
        by = derivation.argument(request.vector).symbols
        inputs = [s for name in quantity.inputs for s in derivation.argument(name).symbols]
        plain = {symbol: sp.Dummy() for symbol in inputs}
        back = {dummy: symbol for symbol, dummy in plain.items()}
        entries = derivation.spelled(step.expression).xreplace(plain)
        slopes = sp.Matrix([[sp.diff(entry, plain[s]) for s in by] for entry in entries])
        yield Jacobian(
            quantity=Quantity(
                name=request.name,
                symbol=Symbol(f"∂{quantity.symbol.text}/∂{request.vector}"),
                meaning=quantity.meaning or quantity.name,
                by=request.vector,
                inputs=quantity.inputs,
                unit=quantity.unit,
            ),
            expression=slopes.xreplace(back).as_immutable(),
            of=step.shape,
        )
