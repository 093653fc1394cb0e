"""The arguments that quantities are functions of.

They are coordinates, rates, accelerations, a given angular velocity, and what a body and its motion
add.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import chain
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.algebra.generators import rate_of
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, named
from rigidsym.mechanics.derivation import Argument, argument
from rigidsym.models.forces import OMEGA_BODY
from rigidsym.models.rotation import TIME, RotationModel, time_function

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody


POINT = sp.symbols("p_x:z")
DIRECTION = sp.symbols("n_x:z")
# beside the axes x, y, z of space, a quaternion (w, x, y, z) is printed in other letters
_QUATERNION = {"w": "q_0", "x": "q_1", "y": "q_2", "z": "q_3"}
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
    arguments = [*_moving("q", model.coordinates, model.coordinate_units, _OF_COORDINATES)]
    for frame, symbols, prime in (
        ("space", sp.symbols("Omega_1:4"), ""),
        ("body", OMEGA_BODY, "'"),
    ):
        omega = argument(
            f"omega_{frame}",
            symbols,
            f"{frame} components of the angular velocity",
            units="rad/s",
            names=[f"omega_{frame}_{k}" for k in (1, 2, 3)],
            notation=[formula(rf"\Omega{prime}_{k}") for k in (1, 2, 3)],
        )
        arguments.append(omega)
    if body:
        centre = tuple(map(time_function, ("X", "Y", "Z")))
        arguments += _moving("centre", centre, ("m",) * 3, _OF_CENTRE)
        arguments.append(argument("point", POINT, "a point, in the axes of the body", units="m"))
        about = "the direction of a line, a unit vector"
        arguments.append(argument("direction", DIRECTION, about))
    arguments += _parameters(model, body)
    names = [name for each in arguments for name in each.names]
    twice = sorted({name for name in names if names.count(name) > 1}) if body else []
    if twice:
        raise ModelError(
            f"{model.name}: {twice[0]} is a name both in the rotation and in the body; rename one"
        )
    return tuple(arguments)


def arguments_of_motion(model: RotationModel) -> tuple[Argument, ...]:
    """The generalised momenta and the torque, inputs of Hamilton's and Euler's equations."""
    labels = [coordinate.func.__name__ for coordinate in model.coordinates]
    letters = [named(label) for label in _letters(labels, model.coordinate_units)]
    return (
        argument(
            "momenta",
            [sp.Symbol(f"p_{label}") for label in labels],
            "generalised momenta",
            units="kg m^2/s",
            notation=[formula("p_{#1}", letter) for letter in letters],
        ),
        argument(
            "torque",
            sp.symbols("torque_1:4"),
            "body components of the torque about the fixed point",
            units="N m",
            notation=[formula(f"N'_{k}") for k in (1, 2, 3)],
        ),
    )


def arguments_of_flow(state: Sequence[Argument]) -> tuple[Argument, ...]:
    """The time, and the state y of which `state` are the parts."""
    time = argument("t", [TIME], "the time", units="s")._replace(is_scalar=True)

    def joined(field: str) -> tuple[Any, ...]:
        return tuple(chain.from_iterable(getattr(part, field) for part in state))

    return time, Argument(
        name="y",
        symbols=joined("symbols"),
        names=joined("names"),
        notation=joined("notation"),
        units=joined("units"),
        about=f"the state: {', '.join(part.name for part in state)}",
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
    units = ("",) * len(model.constants) + tuple(p.unit for p in of_body)
    words = f"constants: {'; '.join(about)}"
    return (argument("parameters", symbols, words, units=units, notation=notation),)


@lru_cache(maxsize=1024)
def _moving(
    name: str, functions: tuple[sp.Expr, ...], units: tuple[str, ...], about: tuple[str, ...]
) -> tuple[Argument, ...]:
    """Functions of time and their derivatives, as many as are told about."""
    labels, symbols = [function.func.__name__ for function in functions], functions
    arguments = []
    orders = zip(about, ("", "_dot", "_ddot"), ("", "/s", "/s^2"), strict=False)
    for order, (words, suffix, per) in enumerate(orders):
        vector = argument(
            name + suffix,
            symbols,
            words,
            units=[f"{unit or '1'}{per}" if order else unit for unit in units],
            names=[label + suffix for label in labels],
            notation=[named(letter, order) for letter in _letters(labels, units)],
        )
        arguments.append(vector)
        symbols = tuple(map(rate_of, symbols))
    return tuple(arguments)


def _letters(names: Sequence[str], units: Sequence[str]) -> Sequence[str]:
    """The letters in print: q₀, q₁, q₂, q₃ for the components of a quaternion."""
    return [_QUATERNION[name] for name in names] if is_quaternion(names, units) else names


def is_quaternion(names: Sequence[str], units: Sequence[str]) -> bool:
    """Whether these are w, x, y, z without units, in any order."""
    return {*names} == {*_QUATERNION} and not any(units)
