"""Products of turns of any length, about any constant axes."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import is_identically_zero
from rigidsym.errors import ModelError
from rigidsym.models.rotation import AXES, SOURCES, Citation, RotationModel, Turn, product_of

_NUMBERS = ("Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten")
_SOURCE = SOURCES["Goldstein 4.4"]


def chain(
    turns: Sequence[Turn] | str,
    *,
    name: str = "",
    title: str = "",
    source: Citation = _SOURCE,
    passive: bool = False,
) -> RotationModel:
    """R as a product of turns, left to right as given: R = R_1 R_2 ... R_n.

    The coordinates are the functions of time in the angles, in order of appearance; an angle may be
    a constant, or any combination of coordinates and constants. If components of an axis are
    symbols, the axis is a unit vector by an added condition.

    Raises ModelError if there is no turn, or none with a coordinate.
    """
    if isinstance(turns, str):
        raise ModelError(f"expected a list of rs.Turn; for a text use rs.rotation_from({turns!r})")
    if turns is None:
        raise ModelError("expected a list of rs.Turn, got None")
    for turn in turns:
        if not isinstance(turn, Turn):
            raise ModelError(f"expected a list of rs.Turn, got {turn!r} in it")
    if not turns:
        raise ModelError("a chain needs at least one turn, such as z(phi)")
    moving = (sp.ordered(turn.angle.atoms(AppliedUndef)) for turn in turns)
    coordinates = tuple(dict.fromkeys(atom for atoms in moving for atom in atoms))
    if not coordinates:
        raise ModelError(
            f"{' '.join(map(str, turns))} does not move: expected an angle that is a function "
            "of time"
        )
    units = (sum(part**2 for part in turn.direction) - 1 for turn in turns)
    letters = "".join(turn.axis if turn.axis in AXES else "u" for turn in turns)
    product = " ".join(map(str, turns))
    return RotationModel(
        name=name or f"chain_{letters}" + ("_passive" if passive else ""),
        title=title or f"{_counted(turns)} {product}" + (", passive" if passive else ""),
        convention=(_in_words(turns),),
        coordinates=coordinates,
        matrix=product_of(tuple(turns)),
        turns=tuple(turns),
        constraints=tuple(dict.fromkeys(c for c in units if not is_identically_zero(c))),
        source=source,
        passive=passive,
    )


def _in_words(turns: Sequence[Turn]) -> str:
    steps = [f"{turn.angle_text} about {turn.axis}" for turn in turns]
    if len(steps) == 1:
        return f"One turn: {steps[0]}."
    return (
        f"{_counted(turns)}, each about an axis that the turns before it have moved: first "
        + ", then ".join(steps)
        + "."
    )


def _counted(turns: Sequence[Turn]) -> str:
    """One turn, Two turns, ..., 11 turns."""
    if len(turns) == 1:
        return "One turn"
    numbers = dict(enumerate(_NUMBERS, start=2))
    return f"{numbers.get(len(turns), len(turns))} turns"


def axis_turn(axis: Sequence[sp.Expr], angle: sp.Expr) -> Turn:
    """The turn about a constant axis that is given by its components along x, y and z.

    Raises ModelError for a zero axis and for numbers that are not a unit vector.
    """
    parts = tuple(sp.sympify(part, strict=True) for part in axis)
    square = sum(part**2 for part in parts)
    if all(part.is_number for part in parts) and not is_identically_zero(square - 1):
        raise ModelError(
            f"the axis ({', '.join(map(str, parts))}) has the length {sp.sqrt(square)}; expected a "
            "unit vector"
        )
    label = f"[{', '.join(map(str, parts))}]"
    return Turn(axis=label, angle=angle, components=parts)


def direction(parts: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The unit vector along a direction, as crystallographers write them: [1, 1, 0].

    Symbols are left as they are, for the unit condition to bind. Raises ModelError for [0, 0, 0].
    """
    exact = tuple(sp.sympify(part, strict=True) for part in parts)
    if not all(part.is_number for part in exact):
        return exact
    length = sp.sqrt(sum(part**2 for part in exact))
    if length == 0:
        raise ModelError("the axis must not be the zero vector")
    return tuple(part / length for part in exact)
