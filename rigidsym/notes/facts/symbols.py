"""The symbols of a note with their meanings and units."""

from __future__ import annotations

from itertools import chain

from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation

_PLACES = ("centre", "point", "direction")  # that moments are taken about


def meanings_of(derivation: Derivation) -> list[tuple[list[Formula], str, str]]:
    """Coordinates, constants, points and lines: symbols of one meaning and one unit."""
    arguments = {argument.name: argument for argument in derivation.arguments}
    used = {name for step in derivation.steps for name in step.quantity.inputs}
    q, turns = arguments["q"], derivation.model.turns
    rows = [(name, "coordinates", unit) for name, unit in zip(q.notation, q.units, strict=True)]
    of_body = {p.symbol: p for p in derivation.body.parameters} if derivation.body else {}
    of_axes = {s for turn in turns for c in turn.components for s in c.free_symbols}
    angles = {symbol for turn in turns for symbol in turn.angle.free_symbols}
    of_all = (a for a in derivation.arguments if a.name == "parameters")
    constants = (zip(a.symbols, a.notation, a.units, strict=True) for a in of_all)
    for symbol, name, unit in chain.from_iterable(constants):
        about = "constant"
        if symbol in of_body:  # in Python a symbol may come without a word of what it is
            about = of_body[symbol].about or "constant of the body"
            unit = unit if of_body[symbol].about else unit or "—"
        elif symbol in of_axes:
            about = "components of an axis at rest"
        elif symbol in angles:
            about, unit = "constant angle", "rad"
        rows.append((name, about, unit))
    for place in (arguments[name] for name in _PLACES if name in used):
        rows += [(name, place.about, place.units[0]) for name in place.notation]
    groups: dict[tuple[str, str], list[Formula]] = {}
    for name, about, unit in rows:
        groups.setdefault((about, unit), []).append(name)
    return [(names, *meaning) for meaning, names in groups.items()]
