"""The quantities of a rotation's kinematics: names, symbols, units and what they follow from.

Written once for the active presentation (R takes body to space components) and once, where it
differs, for the passive one (A = Rᵀ, the direction cosine matrix).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from rigidsym.mechanics.claims import fill, rate_of, spin_of, transpose_of
from rigidsym.mechanics.derivation import Markup, Quantity
from rigidsym.models.rotation import Citation, lecture

_DIEBEL = Citation(
    text="J. Diebel, Representing Attitude: Euler Angles, Unit Quaternions, and Rotation "
    "Vectors (2006), section 5"
)
_LECTURE = "section 3.2"

ROTATION = Markup(r"\mathbf{R}", "R")
COSINES = Markup(r"\mathbf{A}", "A")
RATES = Markup(r"\dot{\mathbf{q}}", "q̇")
ALPHA = Markup(r"\dot{\boldsymbol{\Omega}}", "dΩ/dt")
ALPHA_BODY = Markup(r"\dot{\boldsymbol{\Omega}}'", "dΩ′/dt")


@dataclass(frozen=True, kw_only=True, slots=True)
class Frame:
    """The symbols of the angular velocity and its rate matrix in one frame."""

    name: str
    omega: Markup
    matrix: Markup
    inverse: Markup
    right_inverse: Markup  # where there are more coordinates than dimensions


SPACE = Frame(
    name="space",
    omega=Markup(r"\boldsymbol{\Omega}", "Ω"),
    matrix=Markup(r"\mathbf{W}", "W"),
    inverse=Markup(r"\mathbf{W}^{-1}", "W⁻¹"),
    right_inverse=Markup(r"\mathbf{W}^{+}", "W⁺"),
)
BODY = Frame(
    name="body",
    omega=Markup(r"\boldsymbol{\Omega}'", "Ω′"),
    matrix=Markup(r"\mathbf{W}'", "W′"),
    inverse=Markup(r"\mathbf{W}'^{-1}", "W′⁻¹"),
    right_inverse=Markup(r"\mathbf{W}'^{+}", "W′⁺"),
)

_NONE = Markup("", "")
_Q, _RATES, _ALL = ("q",), ("q", "q_dot"), ("q", "q_dot", "q_ddot")


def _active() -> tuple[Quantity, ...]:
    return (
        Quantity(
            name="rotation_matrix",
            symbol=ROTATION,
            definition=_NONE,
            about="rotation matrix, body to space components",
            unit="",
            inputs=_Q,
            source=lecture("17", _LECTURE),
        ),
        Quantity(
            name="rotation_rate",
            symbol=rate_of(ROTATION),
            definition=_NONE,
            about="time derivative of the rotation matrix",
            unit="1/s",
            inputs=_RATES,
            source=lecture("15", _LECTURE),
        ),
        Quantity(
            name="spin_matrix",
            symbol=spin_of(ROTATION),
            definition=fill(r"\mathbf{{C}}({0})", "C({0})", SPACE.omega),
            about="spin matrix, the operator Ω × in space components",
            unit="rad/s",
            inputs=_RATES,
            source=lecture("15", _LECTURE),
        ),
        _omega_space(fill(r"\mathbf{{C}}^{{-1}}\left({0}\right)", "C⁻¹({0})", spin_of(ROTATION))),
        _omega_body(fill(r"{0}{1}", "{0} {1}", transpose_of(ROTATION), SPACE.omega)),
    )


def _passive() -> tuple[Quantity, ...]:
    return (
        Quantity(
            name="rotation_matrix",
            symbol=COSINES,
            definition=transpose_of(ROTATION),
            about="direction cosine matrix, space to body components",
            unit="",
            inputs=_Q,
            source=lecture("7", "section 2.1"),
        ),
        Quantity(
            name="rotation_rate",
            symbol=rate_of(COSINES),
            definition=_NONE,
            about="time derivative of the direction cosine matrix",
            unit="1/s",
            inputs=_RATES,
            source=lecture("15", _LECTURE),
        ),
        Quantity(
            name="spin_matrix",
            symbol=spin_of(COSINES),
            definition=fill(r"-\mathbf{{C}}({0})", "−C({0})", BODY.omega),
            about="spin matrix of the direction cosines, the operator −Ω′ × in body components",
            unit="rad/s",
            inputs=_RATES,
            source=lecture("15", _LECTURE),
        ),
        _omega_space(
            fill(
                r"\mathbf{{C}}^{{-1}}\left({0}\,{1}\right)",
                "C⁻¹({0}·{1})",
                rate_of(transpose_of(COSINES)),
                COSINES,
            )
        ),
        _omega_body(fill(r"{0}\,{1}", "{0} {1}", COSINES, SPACE.omega)),
    )


def _omega_space(definition: Markup) -> Quantity:
    return Quantity(
        name="angular_velocity_space",
        symbol=SPACE.omega,
        definition=definition,
        about="angular velocity, space components",
        unit="rad/s",
        inputs=_RATES,
        is_vector=True,
        source=lecture("16", _LECTURE),
    )


def _omega_body(definition: Markup) -> Quantity:
    return Quantity(
        name="angular_velocity_body",
        symbol=BODY.omega,
        definition=definition,
        about="angular velocity, body components",
        unit="rad/s",
        inputs=_RATES,
        is_vector=True,
        source=lecture("16", _LECTURE),
    )


def _rates(frame: Frame, rate_unit: str, *, is_square: bool) -> tuple[Quantity, ...]:
    """The rate matrix of one frame, its inverse, and the rates that follow from it."""
    inverse = frame.inverse if is_square else frame.right_inverse
    kind = "inverse" if is_square else "right inverse of the"
    return (
        Quantity(
            name=f"rate_matrix_{frame.name}",
            symbol=frame.matrix,
            definition=fill(
                r"\frac{{\partial {0}}}{{\partial {1}}}", "∂{0}/∂{1}", frame.omega, RATES
            ),
            about=f"rate matrix to {frame.name} components of the angular velocity",
            unit="",
            inputs=_Q,
            source=_DIEBEL,
        ),
        Quantity(
            name=f"inverse_rate_matrix_{frame.name}",
            symbol=inverse,
            definition=_NONE,
            about=f"{kind} rate matrix from {frame.name} components",
            unit="",
            inputs=_Q,
            source=_DIEBEL,
        ),
        Quantity(
            name=f"rates_from_angular_velocity_{frame.name}",
            symbol=RATES,
            definition=fill(r"{0}{1}", "{0} {1}", inverse, frame.omega),
            about=f"rates of the coordinates from {frame.name} components of the angular velocity",
            unit=rate_unit,
            inputs=("q", f"omega_{frame.name}"),
            is_vector=True,
            source=_DIEBEL,
        ),
    )


def _accelerations() -> tuple[Quantity, ...]:
    return (
        Quantity(
            name="angular_acceleration_space",
            symbol=ALPHA,
            definition=rate_of(SPACE.omega),
            about="angular acceleration, space components",
            unit="rad/s^2",
            inputs=_ALL,
            is_vector=True,
            source=_DIEBEL,
        ),
        Quantity(
            name="angular_acceleration_body",
            symbol=ALPHA_BODY,
            definition=fill("{0}{1}", "{0} {1}", transpose_of(ROTATION), rate_of(SPACE.omega)),
            about="angular acceleration, body components",
            unit="rad/s^2",
            inputs=_ALL,
            is_vector=True,
            source=_DIEBEL,
        ),
    )


@cache
def quantities(
    *, passive: bool, coordinates: int = 3, rate_unit: str = "rad/s"
) -> Mapping[str, Quantity]:
    """All quantities by name, in the order of the derivation, for a number of coordinates.

    `rate_unit` is that of the rates, where they have one in common.
    """
    table = (
        *(_passive() if passive else _active()),
        *_rates(SPACE, rate_unit, is_square=coordinates == 3),
        *_rates(BODY, rate_unit, is_square=coordinates == 3),
        *_accelerations(),
    )
    return MappingProxyType({quantity.name: quantity for quantity in table})


QUANTITY_NAMES = tuple(quantities(passive=False))
