"""Derivatives of quantities by a vector of inputs: which are asked for, and their expressions.

The derivative is SymPy's, term by term and exact; nothing is searched for. A kernel of one gives
the value first, then the derivative, from one pass of common subexpressions.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import sympy as sp

from rigidsym.errors import KernelError
from rigidsym.mechanics.derivation import Argument, Derivation, Step

_FREE = (
    "; bound components count as free, so that this is the derivative of the expression as "
    "written, not projected onto what binds them"
)
_TEXT = re.compile(r"(\w+)(?: by |:)(\w+)")
_PRODUCT = re.compile(r".*[ :](jvp|vjp)")

Asked = str | Iterable[str] | Mapping[str, str | Iterable[str]]


class DerivativeRequest(NamedTuple):
    """The derivative of one quantity by one vector of its inputs."""

    quantity: str
    vector: str

    @property
    def name(self) -> str:
        """Of the function: angular_velocity_body_jacobian_q."""
        return f"{self.quantity}_jacobian_{self.vector}"

    def __str__(self) -> str:
        return f"{self.quantity} by {self.vector}"


def read_request(text: str) -> DerivativeRequest:
    """The request in "QUANTITY by VECTOR", or with a colon between the two.

    Raises KernelError for any other text.
    """
    words = _TEXT.fullmatch(text.strip())
    if words is None:
        wanted = "expected a quantity and a vector, such as angular_velocity_body:q"
        if _PRODUCT.fullmatch(text.strip()):
            wanted = "multiply the Jacobian J by your vector instead: J @ v, or w @ J"
        raise KernelError(f"no derivative {text!r}; {wanted}")
    return DerivativeRequest(quantity=words[1], vector=words[2])


def read_requests(asked: Asked) -> tuple[DerivativeRequest, ...]:
    """The requests, each once, in their order; {"angular_velocity_body": ("q", "q_dot")} too.

    Raises KernelError for a text that is none.
    """
    if isinstance(asked, str):
        asked = [asked]
    if isinstance(asked, Mapping):
        vectors = {q: (v,) if isinstance(v, str) else v for q, v in asked.items()}
        asked = [f"{quantity} by {vector}" for quantity in vectors for vector in vectors[quantity]]
    return tuple(dict.fromkeys(map(read_request, asked)))


class Derivative(NamedTuple):
    """One derivative, ready to be lowered."""

    request: DerivativeRequest
    step: Step
    vectors: tuple[Argument, ...]  # the inputs of the quantity
    by: Argument  # what the derivative is taken by
    is_bound: bool = False  # a constraint binds the components of the vector

    @property
    def parts(self) -> tuple[tuple[int, ...], ...]:
        """The shapes of the value and of the derivative."""
        return self.step.shape, (*self.step.shape, len(self.by.symbols))

    @property
    def about(self) -> str:
        """The value and the derivative in words."""
        jacobian = f"its Jacobian by {self.request.vector}, row by row"
        return f"{self.step.quantity.about}; then {jacobian}{_FREE if self.is_bound else ''}"

    def jacobian(self) -> list[sp.Expr]:
        """Row by row: one row an entry of the quantity, one column a component of the vector.

        Inputs are independent of each other, so that each stands for itself while they are
        differentiated by: a rate does not follow its coordinate.
        """
        symbols = [symbol for vector in self.vectors for symbol in vector.symbols]
        plain = {symbol: sp.Dummy() for symbol in symbols}
        back = {dummy: symbol for symbol, dummy in plain.items()}
        entries = [entry.xreplace(plain) for entry in self.step.expression]
        by = [plain[symbol] for symbol in self.by.symbols]
        return [sp.diff(entry, one).xreplace(back) for entry, one in product(entries, by)]


def derivatives_of(
    derivation: Derivation, requests: Iterable[DerivativeRequest]
) -> Iterator[Derivative]:
    """The derivatives that are asked for, ready to be lowered.

    Raises QuantityError for a quantity that is not in the derivation, and KernelError for a
    vector that it does not take.
    """
    for request in requests:
        step = derivation.step(request.quantity)
        inputs = step.quantity.inputs
        if request.vector not in inputs:
            only = " and ".join(inputs)
            raise KernelError(f"{request}: {request.quantity} depends only on {only}")
        by, model = derivation.argument(request.vector), derivation.model
        # whether the vector, or the coordinates whose rates it holds, are bound by a constraint
        is_rates = by.name in ("q_dot", "q_ddot")
        symbols = set(model.coordinates) if is_rates else set(by.symbols)
        is_pulled_back = model.pullback is not None and symbols.intersection(model.coordinates)
        yield Derivative(
            request=request,
            step=replace(step, expression=derivation.spelled(step.expression)),
            vectors=tuple(map(derivation.argument, inputs)),
            by=by,
            is_bound=bool(is_pulled_back)
            or any(symbols.intersection(sp.preorder_traversal(c)) for c in model.constraints),
        )
