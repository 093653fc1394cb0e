"""The sliders of a page: their ranges, units and initial values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees, lcm, pi, radians
from typing import Any, NamedTuple

import sympy as sp

from rigidsym.formula.letters import Letters
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.body import RigidBody
from rigidsym.models.forces import OMEGA_COMPONENTS
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.figure.scene import turns_of
from rigidsym.notes.words import unit_in_words

_VECTOR = (0.4, 0.8, 0.8)  # along the axis in the figure of the note
_SCALAR = 0.84  # beside half of it, the quaternion of about 65°
_NUMBERS = (0.5, -0.7, 0.5, 0.8, 0.6, 0.1, -0.4, 0.3, 0.8)  # of a matrix not far from a rotation
_RATES = (0.4, 0.25, 0.7)
_ANGLE_RATES = (40.0, 25.0, 60.0, 20.0, 35.0)  # degrees per second
_ANGLE = radians(40.0)  # if there is no clear view of a figure
_MOMENTS = (1.0, 0.6, 0.8)  # each is less than the sum of the others
# of a weight, whose arm is short: moments about a fixed point are at least m l²
_WEIGHT = {sp.Symbol("g"): 9.81, sp.Symbol("l"): 0.5}


class _Range(NamedTuple):
    """From −reach to reach in the unit that is shown, with a start if no initial value is known."""

    start: float
    reach: float
    unit: str
    factor: float = 1.0  # from the unit shown to the unit of the functions
    is_periodic: bool = False


def controls_of(
    derivation: Derivation,
    letters: Letters,
    second: str,
    angles: Mapping[sp.Expr, float],
    start: Mapping[str, float],
    constants: Mapping[sp.Symbol, float],
) -> Iterator[dict[str, Any]]:
    """The sliders of the coordinates, of their rates or Ω′ (`second`), and of the constants.

    `angles` are angles in radians that make a clear figure, `start` are initial values by name in
    SI units, `constants` those of the body that are not fixed, with their values. A slider has the
    `kind` of argument and the `place` in it that it sets; its limits are in the unit shown.
    """
    model = derivation.model
    for argument in derivation.arguments:
        names = OMEGA_COMPONENTS if argument.name == "omega_body" else argument.names
        for k, (symbol, name) in enumerate(zip(argument.symbols, names, strict=True)):
            unit = argument.units[k]
            is_coordinate, is_constant = argument.name == "q", argument.name == "parameters"
            period = period_of(model.coordinates[k] if argument.name == "q_dot" else symbol, model)
            if argument.name == second:
                limits = _Range(_RATES[k % 3], 3.0 if unit == "rad/s" else 2.0, unit)
                if period:
                    limits = _Range(_ANGLE_RATES[k % 5], 180.0, "°/s", pi / 180)
            elif is_constant and symbol in constants:
                value = constants[symbol]
                limits = _Range(value, max(2.0, 2 * value), unit)
            elif period and (is_coordinate or is_constant):
                angle = round(degrees(angles.get(symbol, _ANGLE)))
                limits = _Range(angle, round(degrees(period)) / 2, "°", pi / 180, is_periodic=True)
            elif is_coordinate:
                size = 1.0 if unit == "rad" else 0.5
                starts = dict(zip(model.vector, _VECTOR, strict=False))
                begin = size * starts[symbol] if symbol in starts else _SCALAR
                begin = begin if model.vector else _NUMBERS[k % len(_NUMBERS)]
                is_unit = model.constraints or model.pullback
                limits = _Range(begin, 6.5 if unit == "rad" else 1.0 if is_unit else 3.0, unit)
            elif is_constant and symbol in model.constants:
                limits = _Range(_VECTOR[k % 3], 1.0, "")
            else:
                continue
            _, reach, unit, factor, is_periodic = limits
            begin = start[name] / factor if name in start else limits.start
            # An angle is brought into its period [−reach, reach); the reach of anything else grows
            # to its value.
            begin = (begin + reach) % (2 * reach) - reach if is_periodic else begin
            reach = max(reach, abs(begin))
            yield {
                "kind": argument.name,
                "place": k,
                "symbol": letters.name(symbol),
                "name": argument.names[k].replace("_", " "),  # spoken
                "unit": unit_in_words(unit) if unit else "",
                "low": reach / 100 if symbol in constants else -reach,
                "high": reach,
                "step": 0.01 if factor == 1.0 else 1.0,
                "start": begin,
                "factor": factor,
                "period": 2 * reach if is_periodic else 0.0,  # after which all is as before
            }


def constants_of(body: RigidBody | None) -> dict[sp.Symbol, float]:
    """Values of the constants of a body: their own, or those of a body that is possible."""
    if body is None:
        return {}
    from rigidsym.notes.figure.body_mesh import lengths_of  # with NumPy

    values = {p.symbol: p.value for p in body.parameters}
    lengths = lengths_of(body.distribution, values) if body.distribution is not None else None
    chosen = _WEIGHT | dict(zip(dict.fromkeys(body.inertia.diagonal()), _MOMENTS, strict=False))
    chosen |= {symbol: float(length) for symbol, length in (lengths or {}).items()}
    return {s: chosen.get(s, 1.0) if value is None else value for s, value in values.items()}


def period_of(symbol: sp.Expr, model: RotationModel) -> float:
    """After how many radians R is as before; 0 if the symbol is not part of an angle of a turn."""
    turns = turns_of(model)
    angles = [turn.angle for turn in turns if turn.angle.has(symbol)]
    slopes = [sp.S.One if angle == symbol else angle.diff(symbol) for angle in angles]
    is_angle = slopes and not any(part.has(symbol) for turn in turns for part in turn.components)
    # R depends on sines and cosines of p/q times the angle, with whole p and q; each repeats after
    # 2π q.
    is_repeated = is_angle and all(slope.is_Rational for slope in slopes)
    return 2 * pi * lcm(*(int(slope.q) for slope in slopes)) if is_repeated else 0.0
