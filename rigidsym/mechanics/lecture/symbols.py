"""What the statements of the lecture are made of: symbols, and one way to write them down."""

from __future__ import annotations

from rigidsym.mechanics.derivation import Markup, Statement
from rigidsym.models.rotation import lecture

Words = tuple[str | Markup, ...]


def f(latex: str, text: str) -> Markup:
    return Markup(latex, text)


R = f(r"\mathbf{R}", "R")
OMEGA, BODY_OMEGA = f(r"\boldsymbol{\Omega}", "Ω"), f(r"\boldsymbol{\Omega}'", "Ω′")
INERTIA, BODY_INERTIA = f(r"\mathbf{I}", "I"), f(r"\mathbf{I}'", "I′")
CENTRE, PLACE = f(r"\mathbf{r}_C", "r_C"), f(r"\mathbf{r}_i", "rᵢ")
RELATIVE, AT_REST = f(r"\mathbf{x}_i", "xᵢ"), f(r"\mathbf{x}'_i", "x′ᵢ")
RELATIVE_RATE = f(r"\dot{\mathbf{x}}_i", "ẋᵢ")
WHOLE, MASS = f("M", "M"), f("m_i", "mᵢ")
SPIN = f(r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}", "dR/dt·Rᵀ")
NO_MOMENT = f(r"\sum_i m_i\,\mathbf{x}_i = \mathbf{0}", "Σ mᵢ xᵢ = 0")
NO_MOMENTUM = f(r"\sum_i m_i\,\dot{\mathbf{x}}_i = \mathbf{0}", "Σ mᵢ ẋᵢ = 0")
MASSES = f(r"\sum_i m_i = M", "Σ mᵢ = M")


def statement(
    number: int | None,
    name: str,
    section: str,
    because: Words,
    sides: tuple[Markup, ...],
    *claims: tuple[str, Markup],
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
