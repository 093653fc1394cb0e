"""The pieces of text that one function of a NumPy module is made of."""

from __future__ import annotations

from dataclasses import dataclass

OPTIONS = ("out=None", "threads=1")  # of every function of arrays


@dataclass(frozen=True, kw_only=True, slots=True)
class NumpyFunction:
    """The pieces of text that stand for one kernel in the template."""

    signature: str
    about: str
    body: str
    scalar_signature: str
    scalar_about: str
    scalar_body: str
    exceptional: str
    block: str  # the function of arrays, one a component
    ufunc: str  # the line that states its signature as a generalised ufunc
