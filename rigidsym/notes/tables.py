"""The tables at the end of a note: symbols with their units, functions, claims."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.mechanics.quantities import RATES
from rigidsym.notes.document import (
    Block,
    Code,
    EquationReference,
    Paragraph,
    Program,
    Table,
    Text,
)
from rigidsym.notes.notation import Notation
from rigidsym.notes.words import (
    BODY_POSITION,
    POSITION,
    listed,
    symbols_of,
    unit_in_words,
    with_symbols,
    words,
)

_MOST_SYMBOLS = 6  # in one cell
_CODE_WIDTH = 76  # columns of typewriter type on a page


def symbols(derivation: Derivation, notation: Notation) -> Table:
    """Every symbol with what it means and its unit."""
    known: dict[str, tuple[Text, ...]] = {}
    for row in (*_arguments(derivation), *_length(derivation, notation), *_points()):
        known.setdefault(str(row[0]), row)
    for step in derivation.steps:
        quantity = step.quantity
        about = "rates of the coordinates" if quantity.symbol == RATES else quantity.about
        meaning = with_symbols(about, symbols_of(derivation))
        row = ((quantity.symbol,), meaning, (unit_in_words(quantity.unit),))
        known.setdefault(str(row[0]), (*row, _reference(step)))
    return Table(
        caption="The symbols and their SI units",
        head=(("Symbol",), ("Meaning",), ("Unit",), ("Equation",)),
        rows=tuple(known.values()),
        of_words=1,
    )


def _arguments(derivation: Derivation) -> Iterator[tuple[Text, ...]]:
    """Coordinates and constants; those of one unit share a row."""
    for argument in derivation.arguments:
        if argument.name in ("q", "parameters"):
            about = "coordinates" if argument.name == "q" else argument.about
            for unit in dict.fromkeys(argument.units):
                chosen = [
                    (name,)
                    for name, own in zip(argument.notation, argument.units, strict=True)
                    if own == unit
                ]
                yield _in_a_row(chosen), (about,), (unit_in_words(unit),), ()


def _in_a_row(symbols: Sequence[Text]) -> Text:
    """All of them, or the first and the last where there are many."""
    if len(symbols) > _MOST_SYMBOLS:
        return (*symbols[0], ", …, ", *symbols[-1])
    return listed(symbols, ", ")


def _length(derivation: Derivation, notation: Notation) -> Iterator[tuple[Text, ...]]:
    if notation.length is not None:
        unit = unit_in_words(derivation.argument("q").units[0])
        symbol = notation.names[notation.length.symbol]
        yield (symbol,), ("length of the vector",), (unit,), ()


def _points() -> Iterator[tuple[Text, ...]]:
    yield (POSITION,), ("position of a point of the body, space components",), ("m",), ()
    yield (BODY_POSITION,), ("the same, body components",), ("m",), ()


def functions(derivation: Derivation, module: str, names: Sequence[str]) -> Iterator[Block]:
    """The functions of a module, and a call of one of them that runs as it stands."""
    yield Paragraph(
        words(
            "The module {} evaluates the equations for arrays of any shape, components last, by "
            "the functions that stand beside them. For example,",
            Code(module),
        )
    )
    yield Program(_example(derivation, module, names))


def _example(derivation: Derivation, module: str, names: Sequence[str]) -> str:
    """A call of one function with made-up numbers; of the angular velocity, if it is there."""
    shown = "angular_velocity_body"
    name = shown if shown in names else names[0]
    inputs = derivation.step(name).quantity.inputs
    return "\n".join(
        [
            f"import {module.removesuffix('.py')} as kinematics",
            "",
            *(_given(derivation.argument(argument)) for argument in inputs),
            f"kinematics.{name}({', '.join(inputs)})",
        ]
    )


def _given(argument: Argument) -> str:
    """q = [0.1, 0.2, 0.3]  # phi, theta, psi"""
    numbers = ", ".join(f"{k / 10:.1f}" for k in range(1, 1 + len(argument.symbols)))
    line = f"{argument.name} = [{numbers}]"
    explained = f"{line}  # {', '.join(argument.names)}"
    return explained if len(explained) <= _CODE_WIDTH else line


def _reference(step: Step) -> Text:
    return (EquationReference(step.quantity.name),)
