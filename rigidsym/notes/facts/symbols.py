"""The symbols of a note with their units, and a call of one function of its module."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple

from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument, Derivation
from rigidsym.notes.document import CodeBlock

_PLACES = ("centre", "point", "direction")
_SHOWN = "angular_velocity_body"
_CODE_WIDTH = 76  # columns of typewriter type on a page


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


def example_of(derivation: Derivation, module: str, names: Sequence[str]) -> CodeBlock | None:
    """A call of one function with made-up numbers; of the angular velocity, if it is there."""
    if not names:
        return None
    name = _SHOWN if _SHOWN in names else names[0]
    inputs = derivation.step(name).quantity.inputs
    lines = (
        f"import {module.removesuffix('.py')} as kinematics",
        "",
        *(_assigned(derivation.argument(each)) for each in inputs),
        f"kinematics.{name}({', '.join(inputs)})",
    )
    return CodeBlock("\n".join(lines))


def _assigned(argument: Argument) -> str:
    """q = [0.1, 0.2, 0.3]  # phi, theta, psi"""
    numbers = ", ".join(f"{k / 10:.1f}" for k in range(1, 1 + len(argument.symbols)))
    line = f"{argument.name} = [{numbers}]"
    explained = f"{line}  # {', '.join(argument.names)}"
    return explained if len(explained) <= _CODE_WIDTH else line
