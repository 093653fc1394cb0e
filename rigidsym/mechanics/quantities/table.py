"""The arguments that quantities are functions of.

They are coordinates, rates, accelerations, a given angular velocity, and what a body and its motion
add.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import chain, count
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.algebra.generators import rate_of
from rigidsym.errors import ModelError
from rigidsym.formula.reader import formula, named
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument, argument
from rigidsym.models.rotation import OMEGA_BODY, TIME, RotationModel, time_function

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody
    from rigidsym.models.forces import Forces


POINT = sp.symbols("p_x:z")
DIRECTION = sp.symbols("n_x:z")
# beside the axes x, y, z of space, a quaternion (w, x, y, z) is printed in other letters
_QUATERNION = {"w": "q_0", "x": "q_1", "y": "q_2", "z": "q_3"}
# The names that we choose. Those of one text change together: if a constant of the system has one
# of them, the next text of the row is tried. After the last text, zeros are put before the indices
# of the first, as many as are needed: I_01 for I_1; E_0, then E_00 for E.
_OWN_NAMES = (
    ("I_1 I_2 I_3", "J_1 J_2 J_3", "K_1 K_2 K_3"),
    ("V V_eff", "U U_eff"),
    ("T", "K"),
    ("alpha beta gamma alpha_0 gamma_0", "xi eta zeta xi_0 zeta_0"),
    *((names,) for names in ("a b c", "L_1 L_2 L_3", "M", "E", "E_C", "E_R", "E_K", "H", "I_n")),
    *((name,) for name in ("L", "d", "f", "k", "p", "u", "kappa", "lambda", "tau")),
)
# The letters of names of parts that no bold letter explains, and letters with no other meaning.
_STEMS, _SPARE = "wHIfaNvJbLDy", "sGFSrcekjABC"


def arguments_of(model: RotationModel, body: RigidBody | None = None) -> tuple[Argument, ...]:
    """The arguments of a model's quantities, in the order of a kernel's signature.

    Those of a body are its centre of mass, in space, and its constants. Raises ModelError for a
    name that would then stand for two things.
    """
    arguments = [*_moving("q", model.coordinates, model.coordinate_units, orders=3)]
    frames = ("space", sp.symbols("Omega_1:4"), ""), ("body", OMEGA_BODY, "'")
    for frame, symbols, prime in frames:
        omega = argument(
            f"omega_{frame}",
            symbols,
            units="rad/s",
            names=[f"omega_{frame}_{k}" for k in (1, 2, 3)],
            notation=[formula(rf"\Omega{prime}_{k}") for k in (1, 2, 3)],
        )
        arguments.append(omega)
    if body:
        centre = tuple(map(time_function, ("X", "Y", "Z")))
        arguments += _moving("centre", centre, ("m",) * 3, orders=2)
        arguments.append(argument("point", POINT, units="m"))
        arguments.append(argument("direction", DIRECTION))
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
            units="kg m^2/s",
            notation=[formula("p_{#1}", letter) for letter in letters],
        ),
        argument(
            "torque",
            sp.symbols("torque_1:4"),
            units="N m",
            notation=[formula(f"N'_{k}") for k in (1, 2, 3)],
        ),
    )


def arguments_of_flow(state: Sequence[Argument]) -> tuple[Argument, ...]:
    """The time, and the state y of which `state` are the parts."""
    time = argument("t", [TIME], units="s")._replace(is_scalar=True)

    def joined(field: str) -> tuple[Any, ...]:
        return tuple(chain.from_iterable(getattr(part, field) for part in state))

    words = f"the state: {', '.join(part.name for part in state)}"
    fields: dict[str, Any] = {f: joined(f) for f in ("symbols", "names", "notation", "units")}
    return time, Argument(name="y", words=words, **fields)


def own_names(
    arguments: Iterable[Argument], body: RigidBody, forces: Forces | None = None
) -> Mapping[str, str]:
    """The names of our own: M, I_1, E, V, ..., or others where the system has a constant so called.

    Its moments may be I₁, I₂, I₃ themselves, and the mass has the name that the system gives it, if
    it has one.
    """
    values = dict(zip(_OWN_NAMES[0][0].split(), body.inertia.diagonal(), strict=True))
    values = (values if body.inertia.is_diagonal() else {}) | {"M": body.mass}
    claimed = forces.first_integrals if forces else ()
    taken: dict[Formula, Any] = dict.fromkeys(map(named, claimed), True)
    for each in arguments:
        if each.name in ("q", "parameters"):
            taken |= zip(each.notation, each.symbols, strict=True)
    names: dict[str, str] = {}
    for texts in _OWN_NAMES:
        own = texts[0].split()
        parts = [name.partition("_") for name in own]
        zeros = ([f"{stem}_{'0' * n}{index}" for stem, _, index in parts] for n in count(1))
        for others in chain(map(str.split, texts), zeros):
            alike = ((taken.get(named(n)), values.get(o)) for n, o in zip(others, own, strict=True))
            if all(symbol is None or symbol == value for symbol, value in alike):
                break
        names |= zip(own, others, strict=True)
    return names | ({"M": body.mass.name} if isinstance(body.mass, sp.Symbol) else {})


def stems_of(names: Iterable[str]) -> Mapping[str, str]:
    """The letters in names of parts, w in w₂₃; others for those of constants and coordinates."""
    taken = {name.partition("_")[0].rstrip("0123456789") for name in names}
    spare = (letter for letter in _SPARE if letter not in taken)
    return {stem: next(spare, 2 * stem) if stem in taken else stem for stem in _STEMS}


def own_letters(
    arguments: Iterable[Argument], body: RigidBody, forces: Forces | None = None
) -> Mapping[Formula, Formula]:
    """In print, for the names of our own that change; a rate as well, with its dot."""
    names = own_names(arguments, body, forces).items()
    changed = [(name, other) for name, other in names if name != other]
    return {_printed(name, n): _printed(other, n) for name, other in changed for n in (0, 1)}


def _printed(name: str, order: int) -> Formula:
    """A name of our own; the index of V_eff is a word, and upright."""
    stem, _, index = name.partition("_")
    return formula(rf"{stem}_{{\mathrm{{{index}}}}}") if "eff" in index else named(name, order)


def _parameters(model: RotationModel, body: RigidBody | None) -> tuple[Argument, ...]:
    """The constants of the model and of the body, if there are any."""
    of_body = body.parameters if body else ()
    symbols = (*model.constants, *(parameter.symbol for parameter in of_body))
    if not symbols:
        return ()
    entries = {sp.Symbol(f"I_{i}{j}") for i in (1, 2, 3) for j in (1, 2, 3)}
    primed = entries & (body.inertia.free_symbols if body else set())  # along axes of the body
    notation = [named(s.name.replace("_", "'_") if s in primed else s.name) for s in symbols]
    # a constant is an angle of R, or a number, such as a component of an axis
    turns, functions = model.turns, model.matrix.atoms(sp.cos, sp.sin) if not model.turns else ()
    angles = sp.Tuple(*(turn.angle for turn in turns), *(f.args[0] for f in functions)).free_symbols
    units = [*("rad" if s in angles else "" for s in model.constants), *(p.unit for p in of_body)]
    meaning = "parameters_of_body" if of_body else "parameters_of_rotation"
    meaning = "parameters" if model.constants and of_body else meaning
    return (argument("parameters", symbols, meaning=meaning, units=units, notation=notation),)


@lru_cache(maxsize=1024)
def _moving(
    name: str, functions: tuple[sp.Expr, ...], units: tuple[str, ...], orders: int
) -> tuple[Argument, ...]:
    """Functions of time and their derivatives, `orders` of them."""
    labels, symbols = [function.func.__name__ for function in functions], functions
    arguments = []
    suffixes = (("", ""), ("_dot", "/s"), ("_ddot", "/s^2"))
    for order, (suffix, per) in enumerate(suffixes[:orders]):
        vector = argument(
            name + suffix,
            symbols,
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
