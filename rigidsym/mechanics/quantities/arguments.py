"""The inputs of a derivation: coordinates, rates, accelerations, a given angular velocity."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import cache, lru_cache
from typing import TYPE_CHECKING

import sympy as sp

from rigidsym.algebra.adjoin import rate_of
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, named
from rigidsym.mechanics.derivation import Argument
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME, time_function

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

_SUFFIXES = ("", "_dot", "_ddot")  # of names, by the order of the derivative
_CENTRE = ("X", "Y", "Z")
POINT = tuple(sp.Symbol(f"p_{axis}") for axis in "xyz")
DIRECTION = tuple(sp.Symbol(f"n_{axis}") for axis in "xyz")
_SPACE = tuple(sp.Symbol(f"Omega_{k}") for k in (1, 2, 3))


def arguments_of(model: RotationModel, body: RigidBody | None = None) -> tuple[Argument, ...]:
    """The arguments of a model's quantities, in the order of a kernel's signature.

    Those of a body are its centre of mass, in space, and its constants. Raises ModelError for a
    name that would then stand for two things.
    """
    found = (
        _coordinates(model, 0, "q", "coordinates"),
        _coordinates(model, 1, "q_dot", "their time derivatives"),
        _coordinates(model, 2, "q_ddot", "their second time derivatives"),
        _angular_velocity("space", _SPACE, r"\Omega_{}"),
        _angular_velocity("body", OMEGA_BODY, r"\Omega'_{}"),
        *((_centre(0), _centre(1), *_of_lines()) if body else ()),
        *_parameters(model, body),
    )
    if body is not None:
        _check_names(found, model.name)
    return found


def arguments_of_motion(model: RotationModel) -> tuple[Argument, ...]:
    """The generalised momenta and the torque, inputs of Hamilton's and Euler's equations."""
    plain = [coordinate.func.__name__ for coordinate in model.coordinates]
    return (
        Argument(
            name="momenta",
            symbols=tuple(sp.Symbol(f"p_{label}") for label in plain),
            names=tuple(f"p_{label}" for label in plain),
            notation=tuple(formula("p_{#1}", named(label)) for label in plain),
            units=("kg m^2/s",) * len(plain),
            about="generalised momenta",
        ),
        Argument(
            name="torque",
            symbols=tuple(sp.Symbol(f"torque_{k}") for k in (1, 2, 3)),
            names=tuple(f"torque_{k}" for k in (1, 2, 3)),
            notation=tuple(formula(f"N'_{k}") for k in (1, 2, 3)),
            units=("N m",) * 3,
            about="body components of the torque about the fixed point",
        ),
    )


def arguments_of_flow(state: Sequence[Argument]) -> tuple[Argument, ...]:
    """The time, and the state y of which `state` are the parts."""
    time = Argument(
        name="t",
        symbols=(TIME,),
        names=("t",),
        notation=(formula("t"),),
        units=("s",),
        about="the time",
        is_scalar=True,
    )
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
        raise ModelError(f"{model}: {twice[0]} names two things, of the rotation and of the body")


def _parameters(model: RotationModel, body: RigidBody | None) -> tuple[Argument, ...]:
    """The constants of the model and of the body, if there are any."""
    of_body = body.parameters if body else ()
    symbols = (*model.constants, *(parameter.symbol for parameter in of_body))
    if not symbols:
        return ()
    names = tuple(symbol.name for symbol in symbols)
    about = ["angles in radians, components of axes"] if model.constants else []
    about += ["masses, moments of inertia, lengths of the body"] if of_body else []
    return (
        Argument(
            name="parameters",
            symbols=symbols,
            names=names,
            notation=tuple(map(named, names)),
            units=("",) * len(model.constants) + tuple(p.unit for p in of_body),
            about=f"constants: {'; '.join(about)}",
        ),
    )


def _centre(order: int) -> Argument:
    """The space components of the position of the centre of mass, or of its velocity."""
    suffix = _SUFFIXES[order]
    return Argument(
        name=f"centre{suffix}",
        symbols=tuple(_derivative(time_function(name), order) for name in _CENTRE),
        names=tuple(name + suffix for name in _CENTRE),
        notation=tuple(named(name, order) for name in _CENTRE),
        units=(_per_second("m", order),) * 3,
        about=f"space components of the {('position', 'velocity')[order]} of the centre of mass",
    )


def _of_lines() -> tuple[Argument, ...]:
    """A point and the direction of a line through it, in the axes of the body."""
    about = "a point, in the axes of the body", "the direction of a line, a unit vector"
    return tuple(
        Argument(
            name=name,
            symbols=symbols,
            names=tuple(symbol.name for symbol in symbols),
            notation=tuple(named(symbol.name) for symbol in symbols),
            units=(unit,) * 3,
            about=words,
        )
        for name, symbols, unit, words in zip(
            ("point", "direction"), (POINT, DIRECTION), ("m", ""), about, strict=True
        )
    )


def _coordinates(model: RotationModel, order: int, name: str, about: str) -> Argument:
    suffix = _SUFFIXES[order]
    plain = [coordinate.func.__name__ for coordinate in model.coordinates]
    return Argument(
        name=name,
        symbols=tuple(_derivative(coordinate, order) for coordinate in model.coordinates),
        names=tuple(label + suffix for label in plain),
        notation=tuple(named(label, order) for label in plain),
        units=tuple(_per_second(unit, order) for unit in model.coordinate_units),
        about=about,
    )


@lru_cache(maxsize=1024)
def _derivative(coordinate: sp.Expr, order: int) -> sp.Expr:
    return rate_of(_derivative(coordinate, order - 1)) if order else coordinate


def _per_second(unit: str, order: int) -> str:
    return unit if order == 0 else f"{unit or '1'}/s{'^' + str(order) if order > 1 else ''}"


@cache
def _angular_velocity(frame: str, symbols: tuple[sp.Symbol, ...], typed: str) -> Argument:
    return Argument(
        name=f"omega_{frame}",
        symbols=symbols,
        names=tuple(f"omega_{frame}_{k}" for k in (1, 2, 3)),
        notation=tuple(formula(typed.format(k)) for k in (1, 2, 3)),
        units=("rad/s",) * 3,
        about=f"{frame} components of the angular velocity",
    )
