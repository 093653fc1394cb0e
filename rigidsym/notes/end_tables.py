"""The tables at the end of a note: symbols with their units, functions, claims."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import chain, repeat
from typing import NamedTuple

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Argument, Derivation, Proof
from rigidsym.mechanics.quantities.kinematics import RATES
from rigidsym.notes.document import (
    Equation,
    EquationReference,
    NoteTable,
    Text,
    listed,
)
from rigidsym.notes.facts.rotation import OPERATOR
from rigidsym.notes.facts.singular import WITH_CONDITIONS
from rigidsym.notes.letters import RESIDUAL, VECTOR
from rigidsym.notes.words import (
    BODY_POSITION,
    POSITION,
    is_body_alone,
    symbols_of,
    unit_in_words,
    vector,
    with_symbols,
)

_U, _CROSS = formula(r"\mathbf{u}"), formula(r"\mathbf{u}\times")
_PLACES = ("centre", "point", "direction")
_MOST_SYMBOLS = 6  # in one cell
_SHOWN = "angular_velocity_body"
_CODE_WIDTH = 76  # columns of typewriter type on a page


def symbols(derivation: Derivation, letters: Letters) -> NoteTable:
    """Every symbol with what it means and its unit."""
    known: dict[Text, Row] = {}
    of_motion = (_arguments, partial(_length, letters), _points)
    of_body = (_constants, _of_the_body)
    named = of_body if is_body_alone(derivation) else (*of_motion[:1], *of_body, *of_motion[1:])
    for row in chain.from_iterable(rows(derivation) for rows in named):
        known.setdefault(row[0], row)
    found = derivation.singularities
    if found is not None and found.measure == "det [W, J]":
        bound = "rows by which the conditions bind the rates"
        known[(WITH_CONDITIONS,)] = (WITH_CONDITIONS,), (bound,), ("1",), ()
    found_symbols = symbols_of(derivation)
    for step in derivation.steps:
        quantity = step.quantity
        about = "rates of the coordinates" if quantity.symbol == RATES else quantity.about
        meaning = with_symbols(about, found_symbols)
        row = ((quantity.symbol,), meaning, (unit_in_words(quantity.unit),))
        known.setdefault(row[0], (*row, (EquationReference(quantity.name),)))
    return NoteTable(
        caption="The symbols and their SI units",
        head=(("Symbol",), ("Meaning",), ("Unit",), ("Equation",)),
        rows=tuple(known.values()),
        of_words=1,
    )


Row = tuple[Text, ...]


def _arguments(derivation: Derivation) -> Iterator[Row]:
    """Coordinates; those of one unit share a row."""
    q = derivation.argument("q")
    yield from _rows(zip(q.notation, repeat("coordinates"), q.units))


def _constants(derivation: Derivation) -> Iterator[Row]:
    """Constants with what is known of each; those of one kind share a row."""
    if not any(argument.name == "parameters" for argument in derivation.arguments):
        return
    constants = derivation.argument("parameters")
    of_body = {p.symbol: p for p in derivation.body.parameters} if derivation.body else {}
    axes = {s for turn in derivation.model.turns for c in turn.components for s in c.free_symbols}
    angles = {symbol for turn in derivation.model.turns for symbol in turn.angle.free_symbols}
    named = []
    for symbol, name, unit in zip(
        constants.symbols, constants.notation, constants.units, strict=True
    ):
        if symbol in of_body:
            about = of_body[symbol].about
            # in Python a symbol may come without a word of what it is
            named.append((name, about or "constant of the body", unit if about else unit or "—"))
        elif symbol in axes:
            named.append((name, "components of an axis at rest", unit))
        elif symbol in angles:
            named.append((name, "constant angle", "rad"))
        else:
            named.append((name, "constant", unit))
    yield from _rows(named)


def _of_the_body(derivation: Derivation) -> Iterator[Row]:
    """Where the centre of mass is; the point and the line that moments are taken about."""
    used = {name for step in derivation.steps for name in step.quantity.inputs}
    for argument in derivation.arguments:
        if argument.name in used and argument.name in _PLACES:
            yield (
                _in_a_row([(name,) for name in argument.notation]),
                (argument.about,),
                (unit_in_words(argument.units[0]),),
                (),
            )


def _rows(named: Iterable[tuple[Formula, str, str]]) -> Iterator[Row]:
    """A row for all names that have the meaning and the unit in common."""
    kinds: dict[tuple[str, str], list[Text]] = {}
    for name, about, unit in named:
        kinds.setdefault((about, unit), []).append((name,))
    for (about, unit), names in kinds.items():
        yield _in_a_row(names), (about,), (unit_in_words(unit),), ()


def _in_a_row(symbols: Sequence[Text]) -> Text:
    """All of them, or the first and the last where there are many."""
    if len(symbols) > _MOST_SYMBOLS:
        return (*symbols[0], ", …, ", *symbols[-1])
    return listed(symbols, ", ")


def _length(letters: Letters, derivation: Derivation) -> Iterator[Row]:
    """The vector of the coordinates and its length, where formulas hold them."""
    parts = derivation.model.vector
    if any(step.vector_form for step in derivation.steps):
        units = dict(zip(derivation.model.coordinates, derivation.argument("q").units, strict=True))
        unit = unit_in_words(units[parts[0]])
        yield (VECTOR,), ("the vector ", *vector(parts, letters)), (unit,), ()
    if letters.length is not None:
        unit = unit_in_words(derivation.argument("q").units[0])
        symbol = letters.names[letters.length.symbol]
        yield (symbol,), ("length of the vector",), (unit,), ()


def _points(derivation: Derivation) -> Iterator[Row]:
    whose = "at rest in space" if derivation.model.passive else "of the body"
    yield (POSITION,), (f"position of a point {whose}, space components",), ("m",), ()
    yield (BODY_POSITION,), ("the same, body components",), ("m",), ()
    yield (OPERATOR,), ("matrix of ", _CROSS, ", for a vector ", _U), ("unit of ", _U), ()


def example_of(derivation: Derivation, module: str, names: Sequence[str]) -> str:
    """A call of one function with made-up numbers; of the angular velocity, if it is there."""
    name = _SHOWN if _SHOWN in names else names[0]
    inputs = derivation.step(name).quantity.inputs
    lines = (
        f"import {module.removesuffix('.py')} as kinematics",
        "",
        *map(_given, list(map(derivation.argument, inputs))),
        f"kinematics.{name}({', '.join(inputs)})",
    )
    return "\n".join(lines)


def _given(argument: Argument) -> str:
    """q = [0.1, 0.2, 0.3]  # phi, theta, psi"""
    numbers = ", ".join(f"{k / 10:.1f}" for k in range(1, 1 + len(argument.symbols)))
    line = f"{argument.name} = [{numbers}]"
    explained = f"{line}  # {', '.join(argument.names)}"
    return explained if len(explained) <= _CODE_WIDTH else line


Claim = tuple[str, Proof]  # the label of an equation, and what was claimed there


class ClaimFacts(NamedTuple):
    """A claim, and what became of it."""

    label: str
    proof: Proof

    @property
    def reference(self) -> EquationReference:
        return EquationReference(self.label)

    @property
    def claim(self) -> Formula:
        return self.proof.claim

    @property
    def is_exact(self) -> bool:
        return self.proof.is_exact

    @property
    def status(self) -> str:
        return self.proof.status

    @property
    def residual(self) -> Equation | None:
        """What remains of a claim that could not be decided."""
        residual = self.proof.residual
        return None if residual is None else Equation(sides=(RESIDUAL,), matrix=residual)
