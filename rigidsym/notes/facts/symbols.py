"""The symbols of a note with their meanings and units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple

from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Derivation

_PLACES = ("centre", "point", "direction")


class SameMeaning(NamedTuple):
    """Symbols that share a meaning and a unit."""

    symbols: tuple[Formula, ...]
    about: str
    unit: str


@dataclass(frozen=True)
class SymbolFacts:
    """Arguments and constants, in groups of the same meaning."""

    derivation: Derivation

    @property
    def coordinates(self) -> list[SameMeaning]:
        q = self.derivation.argument("q")
        return _grouped(zip(q.notation, repeat("coordinates"), q.units, strict=False))

    @property
    def constants(self) -> list[SameMeaning]:
        if not any(argument.name == "parameters" for argument in self.derivation.arguments):
            return []
        return _grouped(self._constants())

    def _constants(self) -> Iterator[tuple[Formula, str, str]]:
        constants, body = self.derivation.argument("parameters"), self.derivation.body
        turns = self.derivation.model.turns
        of_body = {p.symbol: p for p in body.parameters} if body else {}
        of_axes = {s for turn in turns for c in turn.components for s in c.free_symbols}
        angles = {symbol for turn in turns for symbol in turn.angle.free_symbols}
        names = zip(constants.symbols, constants.notation, constants.units, strict=True)
        for symbol, name, unit in names:
            if symbol in of_body:  # in Python a symbol may come without a word of what it is
                about = of_body[symbol].about
                yield name, about or "constant of the body", unit if about else unit or "—"
            elif symbol in of_axes:
                yield name, "components of an axis at rest", unit
            elif symbol in angles:
                yield name, "constant angle", "rad"
            else:
                yield name, "constant", unit

    @property
    def places(self) -> list[SameMeaning]:
        """The centre of mass; the point and the line that moments are taken about."""
        used = {name for step in self.derivation.steps for name in step.quantity.inputs}
        return [
            SameMeaning(a.notation, a.about, a.units[0])
            for a in self.derivation.arguments
            if a.name in used and a.name in _PLACES
        ]

    @property
    def unit_of_vector(self) -> str:
        q, model = self.derivation.argument("q"), self.derivation.model
        return dict(zip(model.coordinates, q.units, strict=True))[model.vector[0]]


def _grouped(named: Iterable[tuple[Formula, str, str]]) -> list[SameMeaning]:
    groups: dict[tuple[str, str], list[Formula]] = {}
    for name, about, unit in named:
        groups.setdefault((about, unit), []).append(name)
    return [SameMeaning(tuple(names), *same) for same, names in groups.items()]
