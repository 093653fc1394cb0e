"""The sliders of a page: their ranges, units and initial values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import cycle
from math import degrees, lcm, pi

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument, Derivation
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_COMPONENTS
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.figure.body_mesh import lengths_of
from rigidsym.notes.words import unit_in_words

_DEGREE = pi / 180
_SECTIONS = {
    "q": "Coordinates",
    "q_dot": "Rates",
    "omega_body": "Angular velocity in the body",
    "parameters": "Constants",
}
_VECTOR = (0.4, 0.8, 0.8)  # along the axis in the figure of the note
_SCALAR = 1.68  # beside a vector: the quaternion of about 65°, once it is a unit
_MATRIX = (0.5, -0.7, 0.5, 0.8, 0.6, 0.1, -0.4, 0.3, 0.8)  # by rows, not far from a rotation
_RATES = (0.4, 0.25, 0.7)
_ANGLE_RATES = (40.0, 25.0, 60.0, 20.0, 35.0)  # degrees per second
_FLOW_RATES = (30.0, 0.0, 720.0)
_MOMENTS = (1.0, 0.6, 0.8)  # each is less than the sum of the others
_GRAVITY = sp.Symbol("g")
_ARM = sp.Symbol("l")  # of a weight: short, since moments about a fixed point are at least m l²
_ANGLE = 40.0  # degrees, where no figure says better


@dataclass(frozen=True, kw_only=True, slots=True)
class Control:
    """One slider, in the unit that is shown."""

    kind: str  # the argument that it is part of: q, q_dot, parameters
    place: int
    symbol: Formula
    name: str  # spoken: "phi"
    unit: str  # "°", "rad/s"; "" for a pure number
    low: float
    high: float
    step: float
    start: float
    factor: float = 1.0  # from the unit shown to the unit of the functions
    period: float = 0.0  # after which all is as before; 0 where there is none

    @property
    def key(self) -> str:
        return f"{self.kind}-{self.place}"

    def started(self, values: Mapping[str, float]) -> Control:
        """At the value of its name, in SI units, if there is one; an angle within one period."""
        name = self.name.replace(" ", "_")
        if self.kind == "omega_body":
            name = OMEGA_COMPONENTS[self.place]
        value = values.get(name)
        if value is None or self.kind == "parameters":
            return self
        start = value / self.factor
        if self.period:
            start = (start - self.low) % self.period + self.low
        return replace(self, start=start, low=min(self.low, start), high=max(self.high, start))


@dataclass(frozen=True, kw_only=True, slots=True)
class Group:
    """The sliders of one argument."""

    title: str
    controls: tuple[Control, ...]

    def started(self, values: Mapping[str, float]) -> Group:
        return replace(self, controls=tuple(c.started(values) for c in self.controls))


def groups_of(
    derivation: Derivation,
    letters: Letters,
    shown: dict[sp.Expr, float],
    starts: Mapping[sp.Symbol, float],
    *,
    second: str = "q_dot",
    flows: bool = False,
) -> tuple[Group, ...]:
    """The groups of sliders; `shown` are angles in radians that make a clear figure.

    `starts` are the initial values of the constants of a body; a motion that `flows` by its
    equations starts with a fast spin. `second` is what is beside the coordinates in the state.
    """
    model = derivation.model
    arguments = {argument.name: argument for argument in derivation.arguments}
    periods = [period_of(q, model) for q in model.coordinates]
    sliders = {
        "q": _coordinates(arguments["q"], model, shown),
        second: _rates(arguments[second], periods, flows=flows),
        "parameters": _constants(arguments.get("parameters"), model, starts),
    }
    groups = {
        kind: tuple(_named(each, arguments[kind], letters) for each in sliders[kind])
        for kind in sliders
    }
    return tuple(
        Group(title=_SECTIONS[kind], controls=controls)
        for kind, controls in groups.items()
        if controls
    )


def _named(control: Control, argument: Argument, letters: Letters) -> Control:
    """In the notation of the note."""
    return replace(control, symbol=letters.name(argument.symbols[control.place]))


def _coordinates(
    argument: Argument, model: RotationModel, shown: dict[sp.Expr, float]
) -> Iterator[Control]:
    periods = [period_of(coordinate, model) for coordinate in model.coordinates]
    numbers = cycle(_MATRIX if periods.count(0.0) == len(_MATRIX) else _VECTOR)
    size = 0.5 if model.vector and periods.count(0.0) > len(model.vector) else 1.0
    vector = {part: size * start for part, start in zip(model.vector, _VECTOR, strict=False)}
    for place, (coordinate, period) in enumerate(zip(model.coordinates, periods, strict=True)):
        angle = round(degrees(shown[coordinate])) if coordinate in shown else _ANGLE
        number = size * _SCALAR if model.vector else next(numbers)
        start = angle if period else vector.get(coordinate, number)
        yield _control(argument, place, start, period, _reach(argument.units[place], model))


def _reach(unit: str, model: RotationModel) -> float:
    """How far a coordinate that is no angle goes: bound ones to one, a turn's vector to 2π."""
    if unit == "rad":
        return 6.5
    return 1.0 if model.constraints or model.pullback else 3.0


def _rates(argument: Argument, periods: Sequence[float], *, flows: bool) -> Iterator[Control]:
    of_angles = _FLOW_RATES if flows else _ANGLE_RATES
    if argument.name == "omega_body":
        periods = [0.0] * len(argument.units)
    for place, (unit, period) in enumerate(zip(argument.units, periods, strict=True)):
        if period:
            start = of_angles[place % len(of_angles)]
            control = _control(argument, place, start, 0.0, 1440.0 if flows else 180.0)
            yield replace(control, unit="°/s", step=1.0, factor=_DEGREE)
        else:
            start = _RATES[place % len(_RATES)]
            yield _control(argument, place, start, 0.0, 3.0 if unit == "rad/s" else 2.0)


def _constants(
    argument: Argument | None, model: RotationModel, starts: Mapping[sp.Symbol, float]
) -> Iterator[Control]:
    if argument is None:
        return
    for place, symbol in enumerate(argument.symbols):
        if symbol in model.constants:
            period = period_of(symbol, model)
            start = 30.0 if period else _VECTOR[place % len(_VECTOR)]
            yield _control(argument, place, start, period, 1.0)
        elif symbol in starts:
            reach = max(2.0, 2 * starts[symbol])
            control = _control(argument, place, starts[symbol], 0.0, reach)
            yield replace(control, low=reach / 100)


def starts_of(body: RigidBody | None) -> dict[sp.Symbol, float]:
    """Initial values of the constants of a body: their own, or those of a body that is possible."""
    if body is None:
        return {}
    values = {p.symbol: p.value for p in body.parameters}
    lengths = lengths_of(body.distribution, values) if body.distribution is not None else None
    moments = dict(zip(dict.fromkeys(body.inertia.diagonal()), _MOMENTS, strict=False))
    chosen = {_GRAVITY: 9.81, _ARM: 0.5} | moments
    chosen |= {s: float(x) for s, x in (lengths or {}).items()}
    return {s: chosen.get(s, 1.0) if value is None else value for s, value in values.items()}


def _control(argument: Argument, place: int, start: float, period: float, reach: float) -> Control:
    """A slider from −reach to reach, or over a period."""
    unit = unit_in_words(argument.units[place]) if argument.units[place] else ""
    half = round(degrees(period)) / 2
    return Control(
        kind=argument.name,
        place=place,
        symbol=argument.notation[place],
        name=argument.names[place].replace("_", " "),
        unit="°" if period else unit,
        low=-half if period else -reach,
        high=half if period else reach,
        step=1.0 if period else 0.01,
        start=start,
        factor=_DEGREE if period else 1.0,
        period=2 * half,
    )


@lru_cache(maxsize=64)
def period_of(symbol: sp.Expr, model: RotationModel) -> float:
    """After how many radians R is as before; 0 where the symbol is no angle in R."""
    waves, outside = _waves(model.matrix)
    within = [wave for wave in waves if wave.has(symbol)]
    slopes = [_slope(f.args[0], symbol) for f in within]
    if not within or symbol in outside or not all(slope.is_Rational for slope in slopes):
        return 0.0
    return 2 * pi * lcm(*(int(slope.q) for slope in slopes))


@lru_cache(maxsize=64)
def _waves(matrix: sp.ImmutableMatrix) -> tuple[set[sp.Expr], set[sp.Expr]]:
    """The sines and cosines of a matrix, and what it is made of outside them."""
    waves, outside, left = set(), set(), {*matrix}
    while left:
        node = left.pop()
        if isinstance(node, sp.sin | sp.cos):
            waves.add(node)
        elif node not in outside:
            outside.add(node)
            left.update(node.args)
    return waves, outside


@lru_cache(maxsize=1024)
def _slope(angle: sp.Expr, symbol: sp.Expr) -> sp.Expr:
    return angle.diff(symbol)
