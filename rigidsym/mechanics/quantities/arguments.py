"""The inputs of a derivation: coordinates, rates, accelerations, a given angular velocity."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import cache, lru_cache
from itertools import repeat
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.algebra.generators import rate_of
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME, time_function

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

POINT = tuple(sp.Symbol(f"p_{axis}") for axis in "xyz")
DIRECTION = tuple(sp.Symbol(f"n_{axis}") for axis in "xyz")
# beside the axes x, y, z of space, a quaternion (w, x, y, z) is printed in other letters
_QUATERNION = {"w": "q_0", "x": "q_1", "y": "q_2", "z": "q_3"}
_SPACE = tuple(sp.Symbol(f"Omega_{k}") for k in (1, 2, 3))


def arguments_of(model: RotationModel, body: RigidBody | None = None) -> tuple[Argument, ...]:
    """The arguments of a model's quantities, in the order of a kernel's signature.

    Those of a body are its centre of mass, in space, and its constants. Raises ModelError for a
    name that would then stand for two things.
    """
    q, units = model.coordinates, model.coordinate_units
    found = (
        _moving("q", q, 0, units, "coordinates"),
        _moving("q_dot", q, 1, units, "their time derivatives"),
        _moving("q_ddot", q, 2, units, "their second time derivatives"),
        _angular_velocity("space", _SPACE, r"\Omega_{}"),
        _angular_velocity("body", OMEGA_BODY, r"\Omega'_{}"),
        *(_of_body() if body else ()),
        *_parameters(model, body),
    )
    if body is not None:
        _check_names(found, model.name)
    return found


@cache
def _of_body() -> tuple[Argument, ...]:
    """The centre of mass, its velocity, and a line in the axes of the body."""
    centre = tuple(map(time_function, ("X", "Y", "Z")))
    of_centre = "space components of the {} of the centre of mass"
    return (
        _moving("centre", centre, 0, ("m",) * 3, of_centre.format("position")),
        _moving("centre_dot", centre, 1, ("m",) * 3, of_centre.format("velocity")),
        _vector("point", POINT, "m", "a point, in the axes of the body"),
        _vector("direction", DIRECTION, "", "the direction of a line, a unit vector"),
    )


def arguments_of_motion(model: RotationModel) -> tuple[Argument, ...]:
    """The generalised momenta and the torque, inputs of Hamilton's and Euler's equations."""
    plain = [coordinate.func.__name__ for coordinate in model.coordinates]
    momenta = [sp.Symbol(f"p_{label}") for label in plain]
    shown = [formula("p_{#1}", named(label)) for label in _shown(plain, model.coordinate_units)]
    torque, components = sp.symbols("torque_1:4"), [formula(f"N'_{k}") for k in (1, 2, 3)]
    about = "body components of the torque about the fixed point"
    return (
        _vector("momenta", momenta, "kg m^2/s", "generalised momenta", shown),
        _vector("torque", torque, "N m", about, components),
    )


def arguments_of_flow(state: Sequence[Argument]) -> tuple[Argument, ...]:
    """The time, and the state y of which `state` are the parts."""
    time = _vector("t", (TIME,), "s", "the time", [formula("t")])._replace(is_scalar=True)
    whole = Argument(
        name="y",
        symbols=tuple(s for part in state for s in part.symbols),
        names=tuple(n for part in state for n in part.names),
        notation=tuple(n for part in state for n in part.notation),
        units=tuple(u for part in state for u in part.units),
        about=f"the state: {', '.join(part.name for part in state)}",
    )
    return time, whole


def _check_names(arguments: Iterable[Argument], model: str) -> None:
    names = [name for argument in arguments for name in argument.names]
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        raise ModelError(
            f"{model}: {twice[0]} is a name both in the rotation and in the body; rename one"
        )


def _parameters(model: RotationModel, body: RigidBody | None) -> tuple[Argument, ...]:
    """The constants of the model and of the body, if there are any."""
    of_body = body.parameters if body else ()
    symbols = (*model.constants, *(parameter.symbol for parameter in of_body))
    if not symbols:
        return ()
    about = ["angles in radians, components of axes"] if model.constants else []
    about += ["masses, moments of inertia, lengths of the body"] if of_body else []
    entries = {sp.Symbol(f"I_{i}{j}") for i in (1, 2, 3) for j in (1, 2, 3)}
    primed = entries & (body.inertia.free_symbols if body else set())  # along axes of the body
    notation = [named(s.name.replace("_", "'_") if s in primed else s.name) for s in symbols]
    found = _vector("parameters", symbols, "", f"constants: {'; '.join(about)}", notation)
    units = ("",) * len(model.constants) + tuple(p.unit for p in of_body)
    return (found._replace(units=units),)


def _vector(
    name: str,
    symbols: Sequence[sp.Symbol],
    unit: str,
    about: str,
    notation: Iterable[Formula] | None = None,
) -> Argument:
    """An argument whose components are symbols of one unit, printed by their names or as given."""
    names = tuple(symbol.name for symbol in symbols)
    return Argument(
        name=name,
        symbols=tuple(symbols),
        names=names,
        notation=tuple(map(named, names) if notation is None else notation),
        units=(unit,) * len(names),
        about=about,
    )


@lru_cache(maxsize=1024)
def _moving(
    name: str, functions: tuple[sp.Expr, ...], order: int, units: tuple[str, ...], about: str
) -> Argument:
    """Functions of time, or their derivatives of an order."""
    plain = [function.func.__name__ for function in functions]
    symbols = functions
    for _ in range(order):
        symbols = tuple(map(rate_of, symbols))
    per = ("", "/s", "/s^2")[order]
    return Argument(
        name=name,
        symbols=symbols,
        names=tuple(label + ("", "_dot", "_ddot")[order] for label in plain),
        notation=tuple(map(named, _shown(plain, units), repeat(order))),
        units=tuple(f"{unit or '1'}{per}" if order else unit for unit in units),
        about=about,
    )


def _shown(names: Sequence[str], units: Sequence[str]) -> Sequence[str]:
    """The letters in print: q₀, q₁, q₂, q₃ for the components of a quaternion."""
    return [_QUATERNION[name] for name in names] if is_quaternion(names, units) else names


def is_quaternion(names: Sequence[str], units: Sequence[str]) -> bool:
    """Whether these are w, x, y, z without units, in any order."""
    return {*names} == {*_QUATERNION} and not any(units)


@cache
def _angular_velocity(frame: str, symbols: tuple[sp.Symbol, ...], typed: str) -> Argument:
    about = f"{frame} components of the angular velocity"
    found = _vector(
        f"omega_{frame}", symbols, "rad/s", about, [formula(typed.format(k)) for k in (1, 2, 3)]
    )
    return found._replace(names=tuple(f"omega_{frame}_{k}" for k in (1, 2, 3)))
