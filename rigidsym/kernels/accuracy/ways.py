"""Functions that are no kernels, those that lead back and `unwrap`: how they are known and told of.

Coordinates that follow from a rotation are badly conditioned beside poles, and the rotation that
they give is not. So what is stated of these functions is how far R of what they give lies from R
of what they are given, as it is given; the largest entry counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import TypeVar

import sympy as sp

from rigidsym.kernels.accuracy.digest import DIGITS, digest
from rigidsym.kernels.accuracy.table import SMALL, Measured, Row
from rigidsym.kernels.conversions.conversions import ConversionProgram, Formula
from rigidsym.kernels.conversions.unwrap import Unwrapping
from rigidsym.kernels.ir import Kernel
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.rotation import RotationModel
from rigidsym.system import resources

Told = TypeVar("Told", Formula, Unwrapping)

UNWRAP = "unwrap"
SHORTEST, LONGEST = 1e-3, 1e3  # lengths of quaternions that are given
NEAREST_SINGLE = 1e-4  # to half turns in single precision: a vector is as long as 1/1e-4
_TEMPLATES = ("kernels_unwrap_{}.jinja", "kernels_javascript_unwrap_{}.jinja")


@dataclass(frozen=True, kw_only=True, slots=True)
class Way:
    """One function: what it is given, and the digest of all that its text follows from."""

    name: str
    arguments: tuple[str, ...]  # "p", "matrix", "q", "parameters", "kept"
    digest: str
    model: RotationModel

    @property
    def is_unwrap(self) -> bool:
        return self.name == UNWRAP

    @property
    def angles(self) -> tuple[bool, ...]:
        """Which coordinates are angles that grow along a trajectory."""
        return tuple(self.is_unwrap and unit == "rad" for unit in self.model.coordinate_units)

    def words(self, row: Row, target: str) -> str:
        """The sentence of a docstring."""
        size = ", over the largest angle where that is above 1" if any(self.angles) else ""
        return (
            f"Measured: {row.largest(target)}, between entries of R of what it gives and of what "
            f"it is given{size}; {row.points} points: {'; '.join(self._ranges(row, target))}."
        )

    def _ranges(self, row: Row, target: str) -> Iterator[str]:
        if "p" in self.arguments:
            yield f"quaternions of lengths from {SHORTEST:g} to {LONGEST:g}"
        elif "matrix" in self.arguments:
            yield "matrices as rounded"
        else:
            yield f"q up to {row.reach:.3g}"
        if "parameters" in self.arguments:
            yield "parameters up to 1"
        if "kept" in self.arguments:
            yield f"kept angles up to {SMALL:g}"
        if row.nearest and self.model.turns:
            yield "poles and what is beside them among these"
        elif row.nearest:
            has_single = len(row.errors[target]) > 1
            also = f", in single precision {NEAREST_SINGLE:.0e}" if has_single else ""
            yield f"as near to no turn and to half turns as {row.nearest:.0e}{also}"


def ways_of(
    program: ConversionProgram, derivation: Derivation, kernels: Iterable[Kernel]
) -> tuple[Way, ...]:
    """All functions of a module that are no kernels; `kernels` are those beside them."""
    model, rotation = derivation.model, _rotation(derivation.model)
    matrices = [digest(kernel) for kernel in kernels if kernel.name == "rotation_matrix"]
    found = [
        Way(
            name=formula.name,
            arguments=formula.arguments,
            digest=_hashed(rotation, *_formula(formula), *([] if formula.inputs else matrices)),
            model=model,
        )
        for formula in program.formulas
    ]
    if program.unwrapping is not None:
        chain = program.unwrapping.chain
        given = ("q", "parameters") if chain and chain.constants else ("q",)
        name = _hashed(rotation, *_unwrapping(program.unwrapping))
        found.append(Way(name=UNWRAP, arguments=given, digest=name, model=model))
    return tuple(found)


def stated(
    program: ConversionProgram, ways: Sequence[Way], known: Measured, target: str
) -> ConversionProgram:
    """The program with the measured errors of its functions in words, where they are known."""
    rows = ((way, known.rows.get(way.digest)) for way in ways)
    said = {w.name: w.words(row, target) for w, row in rows if row and target in row.errors}
    unwrapping = program.unwrapping
    return replace(
        program,
        kernels=known.of_kernels(program.kernels, target),
        formulas=tuple(_with(formula, said.get(formula.name)) for formula in program.formulas),
        unwrapping=unwrapping and _with(unwrapping, said.get(UNWRAP)),
    )


def _with(function: Told, sentence: str | None) -> Told:
    if sentence is None:
        return function
    return replace(function, remarks=(*function.remarks, sentence))


def _hashed(*pieces: str) -> str:
    return sha256(";".join(pieces).encode()).hexdigest()[:DIGITS]


def _rotation(model: RotationModel) -> str:
    """R, by which all is measured, whatever its symbols are called."""
    symbols = (*model.coordinates, *model.constants)
    plain = {symbol: sp.Symbol(f"i{k}") for k, symbol in enumerate(symbols)}
    if model.turns:  # shorter than their product
        turns = ((turn.direction, turn.angle) for turn in model.turns)
        return str([sp.Tuple(*axis, angle).xreplace(plain) for axis, angle in turns])
    return str(list(model.matrix.xreplace(plain)))


def _formula(formula: Formula) -> Iterator[str]:
    places = {name: f"i{k}" for k, name in enumerate(formula.inputs)}
    yield formula.name
    yield ",".join(f"{a}:{len(names)}" for a, names in formula.components.items())
    for names, value in formula.lines:
        yield f"{_renamed(names, places)}={_renamed(value, places)}"
    yield from (_renamed(output, places) for output in formula.outputs)


def _renamed(text: str, places: Mapping[str, str]) -> str:
    return re.sub(r"\w+", lambda word: places.get(word[0], word[0]), text)


def _unwrapping(unwrapping: Unwrapping) -> Iterator[str]:
    """Its numbers and lines, and the templates that hold the rest of it."""
    for template in _TEMPLATES:
        for part in (unwrapping.kind, "common"):
            yield resources.template(template.format(part))[0]
    yield str(dict(unwrapping.numbers))
    chain = unwrapping.chain
    if chain is not None:
        named = (*chain.constants, *(name for name, _ in chain.samples))
        places = {name: f"i{k}" for k, name in enumerate(dict.fromkeys(named))}
        lines = (f"{name}={value}" for name, value in chain.lines)
        sides = (*chain.angles, *chain.turns, *(f"{k}:{value}" for k, value in chain.placed))
        yield from (_renamed(text, places) for text in (*lines, *sides))
