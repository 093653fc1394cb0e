"""Coordinates along a trajectory: which kind of continuity, and what it needs to know."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from rigidsym.kernels.conversions.formulas import Line
from rigidsym.kernels.conversions.writing_lines import LineWriter, Local, number
from rigidsym.kernels.lowering.naming import Names
from rigidsym.mechanics.conversions.closed_forms import ClosedForm
from rigidsym.mechanics.conversions.davenport_angles import ThreeTurns
from rigidsym.mechanics.conversions.turn_chain import ChainTurns
from rigidsym.models.rotation import RotationModel

_HALVES = ("cos_near", "sin_near", "cos_far", "sin_far")  # of half the difference and half the sum
_SHAPE = ("base", "apart", "together", *_HALVES)
_LOCAL = (  # of `unwrap` in every target
    *_SHAPE,
    *("samples", "lost", "angles", "columns", "q", "parameters", "first", "middle", "third"),
    *("sample", "sets", "set", "clear", "nearest", "rows", "row", "k"),
    *(f"turn_{k}{after}" for k in (1, 2, 3) for after in ("", "_all")),
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Unwrapping:
    """Continuity along a trajectory: the kind, and what it needs."""

    kind: str  # "turns", "chain", "quaternion", "axis_angle", "rotation_vector", ...
    remarks: tuple[str, ...]
    numbers: Mapping[str, int | float] = field(default_factory=dict)
    chain: ChainUnwrapping | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class ChainUnwrapping:
    """The angles of turns in terms of samples, and the samples in terms of the angles."""

    size: int  # how many coordinates there are
    constants: tuple[str, ...]  # the components of "parameters"
    used: tuple[tuple[str, int], ...]  # those that are needed, and where they stand
    samples: tuple[tuple[str, int], ...]  # the same of the coordinates
    lines: tuple[Line, ...]  # what the axes are to one another
    angles: tuple[str, ...]  # of the turns, three of them where two sets give one rotation
    is_triangle: bool
    turns: tuple[str, ...]  # names of the followed angles
    placed: tuple[tuple[int, str], ...]  # where the coordinates stand that follow from them


_REMARKS: Mapping[str, str] = {
    "quaternion": "Of p and −p the one nearer to the sample before: exact, as signs alone change.",
    "cayley_klein": "Of the parameters and their negatives those nearer to the sample before: "
    "exact, as signs alone change.",
    "axis_angle": "The axis does not turn by more than π/2 from one sample to the next, and the "
    "angle not by more than π; where there is no turn, the axis is that of the sample before.",
    "rotation_vector": "The axis does not turn by more than π/2 from one sample to the next, and "
    "the length goes on beyond π, also through whole turns.",
    "modified_rodrigues": "Of the two sets the one whose quaternion is nearer to that of the "
    "sample before; at a whole turn it is infinite.",
}
_TWO_SETS = (
    "At each sample the angles are those, of the two sets in [−π, π] that give the rotation and of "
    "all that whole turns add to them, which are nearest to the sample before. At a pole, what is "
    "not determined is taken from the last sample that was not at one; what is within 32 eps "
    "(radians) of a pole counts as there, and R is off by up to twice that."
)
_WHOLE_TURNS = "No angle of a turn changes by more than π from one sample to the next."


def unwrapping_of(
    model: RotationModel,
    rule: ThreeTurns | ChainTurns | ClosedForm,
    constants: Sequence[sp.Expr] = (),
    reserved: Iterable[str] = (),
) -> Unwrapping | None:
    """The continuity of a model's coordinates; None where they are unique.

    `constants` are all that the argument "parameters" holds.
    """
    if isinstance(rule, ThreeTurns):
        return _of_turns(rule)
    if isinstance(rule, ChainTurns):
        return _of_chain(model, rule, constants, reserved)
    if rule.rule not in _REMARKS:
        return None
    kind = "quaternion" if rule.rule == "cayley_klein" else rule.rule
    return Unwrapping(kind=kind, remarks=(_REMARKS[rule.rule],))


def _of_turns(rule: ThreeTurns) -> Unwrapping:
    first, middle, third = rule.places
    return Unwrapping(
        kind="turns",
        remarks=(_TWO_SETS,),
        numbers={
            "first": first,
            "middle": middle,
            "third": third,
            "sign": rule.sign,
            "offset": number(rule.offset),
        },
    )


def _of_chain(
    model: RotationModel,
    rule: ChainTurns,
    constants: Sequence[sp.Expr],
    reserved: Iterable[str],
) -> Unwrapping:
    is_triangle = rule.has_two_sets
    free = Names((*_LOCAL, *reserved))
    names = {symbol: free.fresh(symbol.name) for symbol in constants}
    samples = {q: free.fresh(f"sample_{k}") for k, q in enumerate(model.coordinates, 1)}
    writer = LineWriter({**names, **samples}, taken=_LOCAL)
    angles = rule.solved if is_triangle else rule.solved[: len(rule.places)]
    written = tuple(writer.text(turn.angle) for turn in angles)
    if is_triangle:
        _relations(writer, rule)
    turns = [Local(f"turn_{k + 1}") for k in range(len(angles))]
    kept = sp.Matrix(turns[: len(rule.places)]) - sp.Matrix(rule.offsets)
    placed = tuple(
        (place, writer.text(value))
        for place, value in zip(rule.places, rule.inverse * kept, strict=True)
    )
    texts = " ".join([*written, *(value for _, value in (*writer.lines, *placed))])
    kept_too = "What the rotation does not determine stays as it is." if rule.kept else ""
    return Unwrapping(
        kind="chain",
        remarks=tuple(t for t in (_TWO_SETS if is_triangle else _WHOLE_TURNS, kept_too) if t),
        chain=ChainUnwrapping(
            size=len(samples),
            constants=tuple(names.values()),
            used=_found(names.values(), texts),
            samples=_found(samples.values(), texts),
            lines=tuple(writer.lines),
            angles=written,
            is_triangle=is_triangle,
            turns=tuple(str(t) if k < len(rule.places) else "_" for k, t in enumerate(turns)),
            placed=placed,
        ),
    )


def _found(names: Iterable[str], texts: str) -> tuple[tuple[str, int], ...]:
    """The names that stand in some lines, and their places."""
    words = set(re.findall(r"\w+", texts))
    return tuple((name, place) for place, name in enumerate(names) if name in words)


def _relations(writer: LineWriter, rule: ChainTurns) -> None:
    """The flat middle angle, the difference and the sum of the sides, and halves of them."""
    first, middle, last = (writer.shared(axis) for axis in rule.axes)
    sides = [
        writer.angle(writer.fresh("side"), *pair) for pair in ((first, middle), (middle, last))
    ]
    base = writer.flat("base", first, middle, last)
    if base != "base":
        writer.lines.append(("base", base))
    writer.lines += [
        ("apart", f"{sides[0]} - {sides[1]}"),
        ("together", f"{sides[0]} + {sides[1]}"),
    ]
    if rule.is_across:  # exactly, which no cosine of π/2 is
        writer.lines += zip(_HALVES, ("1.0", "0.0", "0.0", "1.0"), strict=True)
        return
    for name in _HALVES:
        called, half = name.split("_")
        side = "apart" if half == "near" else "together"
        writer.lines.append((name, f"${called}(0.5 * {side})"))
