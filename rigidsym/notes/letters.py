"""The symbols of a derivation: their letters and meanings, and the length of its vector."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import chain, count

import sympy as sp

from rigidsym.formula.letters import Letters, VectorLength
from rigidsym.formula.notation import DEFAULT, Notation
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument, Derivation, phrase
from rigidsym.mechanics.kinematics.workspace import LENGTH
from rigidsym.mechanics.quantities.dynamics import LETTERS
from rigidsym.models.rotation import RotationModel

RESIDUAL = formula(r"\boldsymbol{\Delta}")  # what is left over of a claim
VECTOR = formula(r"\mathbf{v}")
_LENGTHS = ("n", "l", "r")  # one that nothing in the model is called by is taken
_OF_VECTORS = tuple("abegkpsvw")
_ORDERS = {"q": 0, "q_dot": 1, "q_ddot": 2, "centre": 0, "centre_dot": 1}
_GIVEN_RATE = 1  # a given angular velocity is ordered as the rates are
_BEFORE = dict.fromkeys(("centre", "centre_dot"), -3)  # what translates before what turns
_PLACES = ("centre", "point", "direction")  # that moments are taken about
_CONSTANT = "parameters"  # constants go before coordinates, in the order of their names


def letters_of(
    arguments: Iterable[Argument], notation: Notation = DEFAULT, model: RotationModel | None = None
) -> Letters:
    """The letters of a derivation, from its arguments, in the notation of the user.

    With the model, the length of its vector is written for what its components make up. Raises
    ModelError for a name of the model that is printed like a symbol of the notation.
    """
    if model is not None:
        notation.check(model)
    if model is None or not model.vector:
        return _letters(tuple(arguments), notation, None)
    # the vector has the letter of its components, e for (e₁, e₂, e₃), or v
    letter, *others = {part.func.__name__.rstrip("0123456789").rstrip("_") for part in model.vector}
    if others or letter not in _OF_VECTORS:
        letter = VECTOR.text
    return _letters(tuple(arguments), replace(notation, vector=letter), length_of(model))


@lru_cache(maxsize=64)
def _letters(
    arguments: tuple[Argument, ...], notation: Notation, length: VectorLength | None
) -> Letters:
    names = {**LETTERS, **(length.names if length else {})}
    places = {length.rate: (_GIVEN_RATE, -1)} if length else {}
    for argument in arguments:
        names.update(zip(argument.symbols, argument.notation, strict=True))
        if argument.name == "q_ddot":  # solved for under the names ddq1, ddq2, ...
            solved = (sp.Symbol(f"ddq{k}") for k in count(1))
            names.update(zip(solved, argument.notation, strict=False))
        order, first = _ORDERS.get(argument.name, _GIVEN_RATE), _BEFORE.get(argument.name, 0)
        if argument.name != _CONSTANT:
            own = {s: (order, first + k) for k, s in enumerate(argument.symbols)}
            places = own | places  # the state y holds coordinates that have their order already
    return Letters(notation=notation, length=length, names=names, places=places)


@lru_cache(maxsize=64)
def length_of(model: RotationModel) -> VectorLength | None:
    """The length that comes up in the matrix of a model: of its vector, or of all coordinates."""
    if not model.vector:
        return None
    taken = {q.func.__name__ for q in model.coordinates} | {c.name for c in model.constants}
    letter = next(letter for letter in _LENGTHS if letter not in taken)
    # First |q|, which a matrix divides by if q need not be of unit length, then |v|. The first one
    # whose square comes up in R is the length.
    for components in (model.coordinates, model.vector):
        is_of_vector = components == model.vector and letter == LENGTH.name
        symbol = LENGTH if is_of_vector else sp.Symbol(f"{letter}_q", positive=True)
        length = VectorLength(components, symbol, sp.Symbol(f"{symbol.name}_dot"), letter)
        if any(symbol in length.shortened(entry).free_symbols for entry in model.matrix):
            return length
    return None


def meanings_of(
    derivation: Derivation, *, has_rotation: bool
) -> list[tuple[list[Formula], str, str]]:
    """Coordinates, constants, points and lines: symbols of one meaning and one unit."""
    arguments = {argument.name: argument for argument in derivation.arguments}
    used = {name for step in derivation.steps for name in step.quantity.inputs}
    q, turns = arguments["q"], derivation.model.turns
    rows = [(name, q.about, unit) for name, unit in zip(q.notation, q.units, strict=True)]
    rows *= has_rotation
    of_body = {p.symbol: p for p in derivation.body.parameters} if derivation.body else {}
    of_axes = {s for turn in turns for c in turn.components for s in c.free_symbols}
    angles = {symbol for turn in turns for symbol in turn.angle.free_symbols}
    of_all = (a for a in derivation.arguments if a.name == "parameters")
    constants = (zip(a.symbols, a.notation, a.units, strict=True) for a in of_all)
    for symbol, name, unit in chain.from_iterable(constants):
        about = phrase("quantities", "constant")
        if symbol in of_body:  # in Python a symbol may come without a word of what it is
            about = of_body[symbol].about or phrase("quantities", "constant_of_body")
            unit = unit if of_body[symbol].about else unit or "—"
        elif symbol in of_axes:
            about = phrase("quantities", "axis_at_rest")
        elif symbol in angles:
            about, unit = phrase("quantities", "constant_angle"), "rad"
        rows.append((name, about, unit))
    for place in (arguments[name] for name in _PLACES if name in used):
        rows += [(name, place.about, place.units[0]) for name in place.notation]
    groups: dict[tuple[str, str], list[Formula]] = {}
    for name, about, unit in rows:
        groups.setdefault((about, unit), []).append(name)
    return [(names, *meaning) for meaning, names in groups.items()]
