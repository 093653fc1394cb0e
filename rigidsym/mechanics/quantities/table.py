"""The arguments that quantities are functions of.

They are coordinates, rates, accelerations, a given angular velocity, and what a body and its motion
add.
"""

from __future__ import annotations

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
from rigidsym.models.rotation import TIME, RotationModel, time_function

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody


POINT = sp.symbols("p_x:z")
DIRECTION = sp.symbols("n_x:z")
# beside the axes x, y, z of space, a quaternion (w, x, y, z) is printed in other letters
_QUATERNION = {"w": "q_0", "x": "q_1", "y": "q_2", "z": "q_3"}
_SPACE = sp.symbols("Omega_1:4")
_SUFFIX, _PER = ("", "_dot", "_ddot"), ("", "/s", "/s^2")  # by the order of a derivative
_OF_COORDINATES = ("coordinates", "their time derivatives", "their second time derivatives")
_OF_CENTRE = (
    "space components of the position of the centre of mass",
    "space components of the velocity of the centre of mass",
)


def arguments_of(model: RotationModel, body: RigidBody | None = None) -> tuple[Argument, ...]:
    """The arguments of a model's quantities, in the order of a kernel's signature.

    Those of a body are its centre of mass, in space, and its constants. Raises ModelError for a
    name that would then stand for two things.
    """
    q, units = model.coordinates, model.coordinate_units
    found = (
        *_moving("q", q, units, _OF_COORDINATES),
        *_angular_velocities(),
        *(_of_body() if body else ()),
        *_parameters(model, body),
    )
    names = [name for argument in found for name in argument.names]
    twice = sorted({name for name in names if names.count(name) > 1}) if body else []
    if twice:
        raise ModelError(
            f"{model.name}: {twice[0]} is a name both in the rotation and in the body; rename one"
        )
    return found


@cache
def _of_body() -> tuple[Argument, ...]:
    """The centre of mass, its velocity, and a line in the axes of the body."""
    centre = tuple(map(time_function, ("X", "Y", "Z")))
    return (
        *_moving("centre", centre, ("m",) * 3, _OF_CENTRE),
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
    name: str, functions: tuple[sp.Expr, ...], units: tuple[str, ...], about: tuple[str, ...]
) -> tuple[Argument, ...]:
    """Functions of time and their derivatives, as many as are told about."""
    plain = [function.func.__name__ for function in functions]
    found: list[Argument] = []
    for order, words in enumerate(about):
        own = [f"{unit or '1'}{_PER[order]}" if order else unit for unit in units]
        found.append(
            Argument(
                name=name + _SUFFIX[order],
                symbols=tuple(map(rate_of, found[-1].symbols)) if order else functions,
                names=tuple(label + _SUFFIX[order] for label in plain),
                notation=tuple(map(named, _shown(plain, units), repeat(order))),
                units=tuple(own),
                about=words,
            )
        )
    return tuple(found)


def _shown(names: Sequence[str], units: Sequence[str]) -> Sequence[str]:
    """The letters in print: q₀, q₁, q₂, q₃ for the components of a quaternion."""
    return [_QUATERNION[name] for name in names] if is_quaternion(names, units) else names


def is_quaternion(names: Sequence[str], units: Sequence[str]) -> bool:
    """Whether these are w, x, y, z without units, in any order."""
    return {*names} == {*_QUATERNION} and not any(units)


@cache
def _angular_velocities() -> tuple[Argument, ...]:
    """The components of the angular velocity in space and in the body."""
    found = []
    for frame, symbols, prime in (("space", _SPACE, ""), ("body", OMEGA_BODY, "'")):
        about = f"{frame} components of the angular velocity"
        notation = [formula(rf"\Omega{prime}_{k}") for k in (1, 2, 3)]
        vector = _vector(f"omega_{frame}", symbols, "rad/s", about, notation)
        found.append(vector._replace(names=tuple(f"omega_{frame}_{k}" for k in (1, 2, 3))))
    return tuple(found)
