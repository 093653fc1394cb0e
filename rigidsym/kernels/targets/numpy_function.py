"""The pieces of text that one function of a NumPy module is made of."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True)
class Function:
    """The pieces of text that stand for one kernel in the template."""

    signature: str
    about: str
    body: str
    scalar_signature: str
    scalar_about: str
    scalar_body: str
    exceptional: str
    block_signature: str
    block_body: str
