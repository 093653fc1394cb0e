"""Derivatives of quantities by a vector of inputs: which are asked for, and their expressions.

The derivative is SymPy's, term by term and exact; nothing is searched for. A kernel of one gives
the value first, then the derivative, from one pass of common subexpressions.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from typing import NamedTuple

import sympy as sp

from rigidsym.errors import KernelError
from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.models.rotation import RotationModel

KINDS = {
    "jacobian": "its Jacobian by {vector}, row by row",
    "jvp": "its Jacobian by {vector} times {given}",
    "vjp": "{given} times its Jacobian by {vector}",
}
_FREE = (
    "; bound components count as free, so that this is the derivative of the expression as "
    "written, not projected onto what binds them"
)
_TEXT = re.compile(r"(\w+)(?: by |:)(\w+)(?:[ :](\w+))?")
_EXPECTED = (
    "expected a quantity and a vector, such as angular_velocity_body:q, or a product with a "
    "vector, such as angular_velocity_body:q:jvp or angular_velocity_body:q:vjp"
)

Asked = str | Iterable[str] | Mapping[str, str | Iterable[str]]


class DerivativeRequest(NamedTuple):
    """The derivative of one quantity by one vector of its inputs."""

    quantity: str
    vector: str
    kind: str = "jacobian"

    @property
    def name(self) -> str:
        """Of the function: angular_velocity_body_jacobian_q."""
        return f"{self.quantity}_{self.kind}_{self.vector}"

    def __str__(self) -> str:
        kind = "" if self.kind == "jacobian" else f" {self.kind}"
        return f"{self.quantity} by {self.vector}{kind}"


def read_request(text: str) -> DerivativeRequest:
    """The request in "QUANTITY by VECTOR [jvp|vjp]", or with colons between its words.

    Raises KernelError for any other text.
    """
    found = _TEXT.fullmatch(text.strip())
    if not found or (found[3] or "jacobian") not in KINDS:
        raise KernelError(f"no derivative {text!r}; {_EXPECTED}")
    return DerivativeRequest(quantity=found[1], vector=found[2], kind=found[3] or "jacobian")


def read_requests(asked: Asked) -> tuple[DerivativeRequest, ...]:
    """The requests, each once, in their order; {"angular_velocity_body": ("q", "q_dot jvp")} too.

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
    vectors: tuple[Argument, ...]  # the inputs of the quantity, then the vector of the product
    by: Argument  # what the derivative is taken by
    given: Argument | None  # the vector of the product
    is_bound: bool = False  # a constraint binds the components of the vector of the request

    @property
    def parts(self) -> tuple[tuple[int, ...], ...]:
        """The shapes of the value and of the derivative."""
        shape, count = self.step.shape, len(self.by.symbols)
        of_kind = {"jacobian": (*shape, count), "jvp": shape, "vjp": (count,)}
        return shape, of_kind[self.request.kind]

    @property
    def about(self) -> str:
        """The value and the derivative in words."""
        given = self.given.name if self.given else ""
        what = KINDS[self.request.kind].format(vector=self.request.vector, given=given)
        return f"{self.step.quantity.about}; then {what}{_FREE if self.is_bound else ''}"

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

    def results(self, jacobian: Sequence[sp.Expr]) -> list[sp.Expr]:
        """What is returned beside the value, from the entries of the Jacobian in any form."""
        if self.given is None:
            return list(jacobian)
        count = len(self.by.symbols)
        rows = [jacobian[k : k + count] for k in range(0, len(jacobian), count)]
        lines = rows if self.request.kind == "jvp" else list(zip(*rows, strict=True))
        return [sp.Add(*map(sp.Mul, line, self.given.symbols)) for line in lines]


def derivatives_of(
    derivation: Derivation, requests: Iterable[DerivativeRequest]
) -> tuple[Derivative, ...]:
    """The derivatives that are asked for, ready to be lowered.

    Raises QuantityError for a quantity that is not in the derivation, and KernelError for a
    vector that it does not take.
    """
    return tuple(_derivative(derivation, request) for request in requests)


def _derivative(derivation: Derivation, request: DerivativeRequest) -> Derivative:
    step = derivation.step(request.quantity)
    step = replace(step, expression=derivation.spelled(step.expression))
    inputs = step.quantity.inputs
    if request.vector not in inputs:
        raise KernelError(f"{request}: {request.quantity} depends only on {' and '.join(inputs)}")
    by = derivation.argument(request.vector)
    given = {"jvp": _tangent(by), "vjp": _cotangent(step)}.get(request.kind)
    vectors = map(derivation.argument, inputs)
    return Derivative(
        request=request,
        step=step,
        vectors=(*vectors, given) if given else tuple(vectors),
        by=by,
        given=given,
        is_bound=_is_bound(derivation.model, by),
    )


def _is_bound(model: RotationModel, by: Argument) -> bool:
    """Whether the vector, or the coordinates whose rates it holds, are bound by a constraint."""
    symbols = set(model.coordinates) if by.name in ("q_dot", "q_ddot") else set(by.symbols)
    if model.pullback is not None and symbols.intersection(model.coordinates):
        return True
    return any(symbols.intersection(sp.preorder_traversal(c)) for c in model.constraints)


@cache
def _symbol(name: str) -> sp.Dummy:
    """A component of the vector of a product: the same for all products."""
    return sp.Dummy(name)


def _tangent(by: Argument) -> Argument:
    names = tuple(f"{name}_tangent" for name in by.names)
    about = f"a direction in the space of {by.name}"
    name = f"{by.name}_tangent"
    return by._replace(name=name, symbols=tuple(map(_symbol, names)), names=names, about=about)


def _cotangent(step: Step) -> Argument:
    names = tuple(f"weight_{k + 1}" for k in range(len(step.expression)))
    return Argument(
        name=f"{step.quantity.name}_weights",
        symbols=tuple(map(_symbol, names)),
        names=names,
        notation=(),  # it is in no note
        units=("",) * len(names),
        about=f"a weight for each entry of {step.quantity.name}",
    )
