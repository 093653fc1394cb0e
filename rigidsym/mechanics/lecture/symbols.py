"""Symbols of the lecture, and one way to write a statement down."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Statement
from rigidsym.models.rotation import lecture

Words = tuple[str | Formula, ...]


R = formula(r"\mathbf{R}")
OMEGA, BODY_OMEGA = formula(r"\boldsymbol{\Omega}"), formula(r"\boldsymbol{\Omega}'")
INERTIA, BODY_INERTIA = formula(r"\mathbf{I}"), formula(r"\mathbf{I}'")
CENTRE, PLACE = formula(r"\mathbf{r}_C"), formula(r"\mathbf{r}_i")
RELATIVE, AT_REST = formula(r"\mathbf{x}_i"), formula(r"\mathbf{x}'_i")
RELATIVE_RATE = formula(r"\dot{\mathbf{x}}_i")
WHOLE, MASS = formula("M"), formula("m_i")
SPIN = formula(r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}")
NO_MOMENT = formula(r"\sum_i m_i\,\mathbf{x}_i = \mathbf{0}")
NO_MOMENTUM = formula(r"\sum_i m_i\,\dot{\mathbf{x}}_i = \mathbf{0}")
MASSES = formula(r"\sum_i m_i = M")


def statement(
    number: int | None,
    name: str,
    section: str,
    because: Words,
    sides: tuple[Formula, ...],
    *claims: tuple[str, Formula],
    place: str,
    shows_summands: bool = False,
) -> Statement:
    return Statement(
        name=name,
        number=number,
        section=section,
        because=because,
        sides=sides,
        claims=claims,
        source=lecture(str(number) if number else "", place),
        shows_summands=shows_summands,
    )
