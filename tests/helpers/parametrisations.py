"""Rotations of every kind, built at 50 digits by other means than those of the package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import sympy as sp

from helpers.witness import evaluate, hat, mp, number, paths, rotation, unhat
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES
from rigidsym.motion import Motion, derive

Curve = Callable[[Any], list[Any]]  # coordinates at a time
Build = Callable[[list[Any]], Any]  # R from coordinates

CONSTANTS = {"alpha0": (2, 7), "a": (2, 7), "b": (3, 7), "c": (6, 7)}  # a unit vector

IN_A_PLANE = CONSTANTS | {"b": (3, 5), "c": (4, 5)}  # for an axis without a first component

LONG = "x(a_1) y(a_2) [2,1,3](a_3) x(a_4) z(a_5)"  # nothing is multiplied out, nor inverted
CHAINS = (
    "z(phi)",
    "y(phi) x(theta)",
    "z(phi) x(theta) z(psi) y(delta)",
    LONG,
    "x(alpha0) z(phi) y(pi/4) x(theta)",
    "[1,1,0](beta)",
    "z(phi) [a,b,c](beta) [1,2,2](psi)",
    "z(phi) x(phi)",
    "z(2*phi - psi) x(theta) z(psi/3)",
    "z(phi - 2*pi/3) x(theta/2) z(psi)",
    "z(a) x(b) x(c)",
)


def turned(axis: list[Any], angle: Any) -> Any:
    """The turn about a unit axis, by Rodrigues' formula."""
    skew = hat(axis)
    return mp.eye(3) + mp.sin(angle) * skew + (1 - mp.cos(angle)) * skew * skew


def by_quaternion(w: Any, x: Any, y: Any, z: Any) -> Any:
    """R whose columns are q e q*, by the products i j = k."""

    def times(p: list[Any], q: list[Any]) -> list[Any]:
        (a, *u), (b, *v) = p, q
        vector = a * mp.matrix(v) + b * mp.matrix(u) + hat(u) * mp.matrix(v)
        return [a * b - mp.fdot(u, v), *vector]

    size = w * w + x * x + y * y + z * z
    units = ([0, *(int(row == k) for k in range(3))] for row in range(3))
    columns = [times(times([w, x, y, z], unit), [w, -x, -y, -z])[1:] for unit in units]
    return mp.matrix(columns).T / size


def by_cayley(vector: list[Any]) -> Any:
    """(1 − C)⁻¹ (1 + C): Cayley's transform of the skew matrix of a Gibbs vector."""
    return mp.inverse(mp.eye(3) - hat(vector)) * (mp.eye(3) + hat(vector))


def nearly_straight(size: int, unit: int = 0) -> Curve:
    """A path of which the first `unit` coordinates are a unit vector."""
    path = paths(1, size=size, seed=3)[0]

    def at(t: Any) -> list[Any]:
        values = path.at(t)
        length = mp.sqrt(sum(value**2 for value in values[:unit]))
        return [value / length for value in values[:unit]] + [*values[unit:]]

    return at


WITNESSES: dict[str, tuple[Curve, Build]] = {
    "quaternion": (nearly_straight(4), lambda q: by_quaternion(*q)),
    "unit_quaternion": (nearly_straight(4, unit=4), lambda q: by_quaternion(*q)),
    "axis_angle": (nearly_straight(4, unit=3), lambda q: mp.expm(q[3] * hat(q[:3]))),
    "rotation_vector": (nearly_straight(3), lambda q: mp.expm(hat(q))),
    "gibbs_vector": (nearly_straight(3), by_cayley),
    "modified_rodrigues": (nearly_straight(3), lambda q: by_cayley(q) ** 2),
    "direction_cosines": (
        lambda t: list(rotation("ZYX", nearly_straight(3)(t))),
        lambda q: mp.matrix([q[:3], q[3:6], q[6:]]),
    ),
}


@cache
def motion_of(text: str, *, passive: bool = False) -> Motion:
    return derive(rotation_from(text, passive=passive))


def constants_of(motion: Motion) -> dict[sp.Expr, Any]:
    chosen = IN_A_PLANE if motion.name.startswith("chain_zxu") else CONSTANTS
    return {sp.Symbol(name): mp.mpf(p) / q for name, (p, q) in chosen.items()}


def chain_witness(motion: Motion) -> Build:
    """R of a chain: a product of turns about its axes."""

    def build(q: list[Any]) -> Any:
        values = dict(zip(motion.model.coordinates, q, strict=True))
        values |= constants_of(motion)
        result = mp.eye(3)
        for turn in motion.model.turns:
            axis = [number(sp.sympify(part), values) for part in turn.direction]
            result = result * turned(axis, number(turn.angle, values))
        return result

    return build


@cache
def way_of(text: str) -> tuple[Curve, Build]:
    """A path q(t), and R(q) by other means than those of the package."""
    size = len(motion_of(text).model.coordinates)
    if text in EULER_SEQUENCES:
        return paths(1, size=size)[0].at, lambda q: rotation(text, q)
    return WITNESSES.get(text) or (nearly_straight(size), chain_witness(motion_of(text)))


@cache
def turning(text: str) -> tuple[Any, Any, Any]:
    """R and its first two derivatives at t = 0, from body to space components."""
    curve, build = way_of(text)

    def at(t: Any) -> Any:
        return build(list(curve(t)))

    return at(mp.mpf(0)), mp.diff(at, 0), mp.diff(at, 0, 2)


@dataclass(frozen=True, eq=False)
class Moving:
    """A rotation on its way along a path q(t), seen at t = 0.

    Its attributes are the quantities of the derivation by their names, with the numbers of this
    moment put into the printed expressions. `turned` is the same rotation, built by other means.
    """

    text: str
    passive: bool

    def __repr__(self) -> str:
        return f"{self.text}{'-passive' * self.passive}"

    @cached_property
    def motion(self) -> Motion:
        return motion_of(self.text, passive=self.passive)

    @property
    def turned(self) -> Any:
        """R, from body to space components."""
        return turning(self.text)[0]

    @property
    def turned_rate(self) -> Any:
        return turning(self.text)[1]

    @property
    def turned_velocity(self) -> Any:
        """Ω in space components, from the numerical derivative of R."""
        return unhat(self.turned_rate * self.turned.T)

    @property
    def turned_acceleration(self) -> Any:
        second = turning(self.text)[2]
        return unhat(second * self.turned.T + self.turned_rate * self.turned_rate.T)

    @cached_property
    def values(self) -> dict[sp.Expr, Any]:
        """The constants, and the coordinates with their rates and second derivatives."""
        values, curve = constants_of(self.motion), way_of(self.text)[0]
        for order in range(3):
            for place, symbol in enumerate(self.motion.arguments[order].symbols):
                values[symbol] = mp.diff(lambda t, k=place: curve(t)[k], 0, order)
        return values

    def argument(self, name: str) -> Any:
        return mp.matrix([self.values[symbol] for symbol in self.motion.argument(name).symbols])

    def at(self, quantity: str, **given: Any) -> Any:
        """A quantity, with vectors given for some of its arguments."""
        values = dict(self.values)
        for name, vector in given.items():
            values |= zip(self.motion.argument(name).symbols, vector, strict=True)
        return evaluate(self.motion.spelled(self.motion.step(quantity).expression), values)

    @property
    def is_passive(self) -> bool:
        """Whether the transpose of R is printed; some presets are passive by themselves."""
        return self.motion.model.passive

    def has(self, quantity: str) -> bool:
        return any(step.quantity.name == quantity for step in self.motion.steps)

    @property
    def has_inverse(self) -> bool:
        """Whether the rates follow from Ω in closed form."""
        stated = self.motion.singularities
        return stated is not None and stated.rank == 3

    def __getattr__(self, quantity: str) -> Any:
        if quantity.startswith("_") or not self.has(quantity):
            raise AttributeError(quantity)
        self.__dict__[quantity] = self.at(quantity)
        return self.__dict__[quantity]

    @property
    def R(self) -> Any:
        """Body to space components, whichever of R and its transpose is printed."""
        return self.rotation_matrix.T if self.is_passive else self.rotation_matrix


# Every rotation that can be asked for by name, and some chains.
MOVING = tuple(
    Moving(text, passive)
    for text in (*EULER_SEQUENCES, *PARAMETRISATIONS, *PRESETS, *CHAINS)
    for passive in (False, True)
    if not (passive and text.startswith("z(phi) [a"))  # whose proofs take longest
)
