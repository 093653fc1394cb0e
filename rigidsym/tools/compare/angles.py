"""Euler angles from a rotation matrix or a quaternion: which convention, and is it right?

Three turns R = Rᵢ(α) Rⱼ(β) Rₖ(γ) about coordinate axes have the angles, with e = ±1 for a cyclic
or anticyclic order,

    α = atan2(−e Rⱼₖ, Rₖₖ),  β = asin(e Rᵢₖ),   γ = atan2(−e Rᵢⱼ, Rᵢᵢ)    three different axes,
    α = atan2(Rⱼᵢ, −e Rₗᵢ),  β = acos(Rᵢᵢ),     γ = atan2(Rᵢⱼ, e Rᵢₗ)     k = i, l the third axis.

A formula is compared with these angles, as points of the unit circle, for rotations in all
directions. The sense in which an angle counts is a convention that no formula can get wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import permutations, product

import numpy as np
import sympy as sp

from rigidsym.tools.compare.matching import Comparison
from rigidsym.tools.compare.program import ELEMENT
from rigidsym.tools.compare.repair import KINDS, Repair, variants
from rigidsym.tools.compare.targets import (
    POINTS,
    Array,
    KnownQuantity,
    Values,
    evaluated,
    target,
)

_INVERSE = (sp.atan2, sp.asin, sp.acos, sp.atan)
_CLOSE = 1e-9  # of points of the unit circle
_FLAT = {9: ([*range(9)], False), 16: ([0, 1, 2, 4, 5, 6, 8, 9, 10], True)}  # places, by columns
_ROW = re.compile(r"(?P<stem>.*?)_?(?P<row>[abc])_(?P<column>[xyz])")  # Matrix3 of ArduPilot


def are_angles(formula: sp.MatrixBase) -> bool:
    """Whether each of three entries is an angle by an inverse function."""
    return formula.shape == (3, 1) and all(entry.has(*_INVERSE) for entry in formula)


@cache
def _rotations() -> tuple[Array, Array]:
    """Unit quaternions (4, points), and their matrices (3, 3, points)."""
    quaternion = np.random.default_rng(1775).normal(size=(4, POINTS))
    w, *v = quaternion = quaternion / np.linalg.norm(quaternion, axis=0)
    x, y, z = v
    zero = np.zeros(POINTS)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]])
    outer = np.einsum("ip,jp->ijp", v, v)
    return quaternion, (2 * w**2 - 1) * np.eye(3)[..., None] + 2 * outer + 2 * w * cross


@cache
def _angles(axes: str, *, is_transposed: bool) -> Array:
    """The three angles as points of the unit circle; (points, 3)."""
    matrix = _rotations()[1]
    r = matrix.transpose(1, 0, 2) if is_transposed else matrix
    i, j, k = ("XYZ".index(axis) for axis in axes)
    other = 3 - i - j
    e = 1 if (j - i) % 3 == 1 else -1
    if i == k:
        first = np.arctan2(r[j, i], -e * r[other, i])
        middle, last = np.arccos(r[i, i]), np.arctan2(r[i, j], e * r[i, other])
    else:
        first = np.arctan2(-e * r[j, k], r[k, k])
        middle, last = np.arcsin(e * r[i, k]), np.arctan2(-e * r[i, j], r[i, i])
    return np.exp(1j * np.stack([first, middle, last], axis=-1))


@dataclass(frozen=True, kw_only=True)
class Angles(KnownQuantity):
    """The angles of a convention; a formula for them has no names of angles."""

    @cached_property
    def inputs(self) -> dict[str, tuple[sp.Expr, ...]]:
        return {"constants": ()}


@dataclass(frozen=True)
class _Candidate:
    """A convention under one reading of the names, and where the formula agrees with it."""

    quantity: str
    axes: str
    order: tuple[int, ...]  # entry 1 is angle order[0]
    opposite: tuple[int, ...]  # entries that count in the other sense
    is_transposed: bool
    values: Values
    agrees: Array  # (points, 3)

    @property
    def cost(self) -> tuple[int, bool, bool]:
        return len(self.opposite), self.is_transposed, self.order not in ((0, 1, 2), (2, 1, 0))

    def wanted(self, entry: int) -> Array:
        angles = _angles(self.axes, is_transposed=self.is_transposed)[:, self.order[entry]]
        return angles.conj() if entry in self.opposite else angles

    def known(self) -> KnownQuantity:
        is_reversed = self.order == (2, 1, 0)  # as of turns about fixed axes
        rotation = self.axes[::-1].lower() if is_reversed else self.axes
        words = ["transposed (passive)"] if self.is_transposed else []
        if self.order not in ((0, 1, 2), (2, 1, 0)):
            words.append(f"the angles in the order {', '.join(str(k + 1) for k in self.order)}")
        if self.opposite:
            entries = " and ".join(str(k + 1) for k in self.opposite)
            words.append(f"with the opposite sense of angle {entries}")
        motion = target(rotation, "rotation_matrix").motion
        arrangement = ", ".join(words)
        return Angles(
            motion=motion, rotation=rotation, quantity=self.quantity, arrangement=arrangement
        )


def angles_identified(formula: sp.ImmutableMatrix) -> Comparison:
    """The convention of three angles, the nearest one, or none."""
    candidates = sorted(_candidates(formula), key=lambda each: each.cost)
    right = next((each for each in candidates if each.agrees.all()), None)
    if right is not None:
        return Comparison(formula=formula, asked=None, found=right.known())
    for each in candidates:
        wrong = np.flatnonzero(~each.agrees.all(axis=0))
        repair = _repair(formula, each, int(wrong[0])) if len(wrong) == 1 else None
        if repair is not None:
            return Comparison(formula=formula, asked=None, found=repair.goal, repairs=(repair,))
    return Comparison(formula=formula, asked=None)


def _repair(formula: sp.ImmutableMatrix, candidate: _Candidate, place: int) -> Repair | None:
    """One change that makes an entry right."""
    entry, symbols = formula[place], _symbols(formula)
    changes = set(variants(entry, [symbols])) | set(_exchanged(entry))
    for kind, after in sorted(changes, key=lambda each: (KINDS.index(each[0]), str(each[1]))):
        number = evaluated(sp.Matrix([[after]]), candidate.values)[:, 0, 0]
        if (np.abs(np.exp(1j * number) - candidate.wanted(place)) < _CLOSE).all():
            changed = formula.as_mutable()
            changed[place] = after
            return Repair(
                kind=kind,
                words=f"angle {place + 1}: {entry} should be {after}",
                formula=sp.ImmutableMatrix(changed),
                goal=candidate.known(),
                place=(place + 1, 1),
                before=entry,
                after=after,
            )
    return None


def _exchanged(entry: sp.Expr) -> Iterator[tuple[str, sp.Expr]]:
    """atan2 with its arguments in the other order, and in place of atan."""
    for function in entry.atoms(sp.atan2):
        yield "index", entry.xreplace({function: sp.atan2(*function.args[::-1])})
    for function in entry.atoms(sp.atan):
        above, below = function.args[0].as_numer_denom()
        for sign in (1, -1):
            yield "product", entry.xreplace({function: sp.atan2(sign * above, sign * below)})


def _symbols(formula: sp.MatrixBase) -> list[sp.Symbol]:
    return sorted(formula.free_symbols, key=str)


def _candidates(formula: sp.ImmutableMatrix) -> Iterator[_Candidate]:
    """Conventions of which at least two angles agree."""
    for quantity, values in _readings(_symbols(formula)):
        with np.errstate(all="ignore"):
            numbers = np.exp(1j * evaluated(formula, values)[..., 0])
        for axes, is_transposed in product(_AXES, (False, True)):
            wanted = _angles(axes, is_transposed=is_transposed)
            for order in permutations(range(3)):
                plain = np.abs(numbers - wanted[:, order]) < _CLOSE
                turned = np.abs(numbers.conj() - wanted[:, order]) < _CLOSE
                opposite = plain.sum(axis=0) < turned.sum(axis=0)
                agrees = np.where(opposite, turned, plain)
                if agrees.all(axis=0).sum() >= 2:
                    places = tuple(map(int, np.flatnonzero(opposite)))
                    yield _Candidate(
                        quantity, axes, order, places, is_transposed, dict(values), agrees
                    )


_AXES = [a + b + c for a, b, c in product("XYZ", repeat=3) if a != b != c]


def _readings(symbols: list[sp.Symbol]) -> Iterator[tuple[str, Values]]:
    """(quantity, values of the names): entries of one matrix, or components of a quaternion."""
    quaternion, matrix = _rotations()
    names = [symbol.name for symbol in symbols]
    if len(names) == 4:
        last = {name[-1]: k for k, name in enumerate(names)}
        if set(last) == set("wxyz"):
            orders = [[last[letter] for letter in "wxyz"]]
        else:  # the scalar first, or last
            orders = [[0, 1, 2, 3], [3, 0, 1, 2]] if len({n[:-1] for n in names}) == 1 else []
        for order in orders:
            yield "from_quaternion", {symbols[k]: quaternion[c] for c, k in enumerate(order)}
    for entries in _entries(names):
        values = {s: matrix[entry] for s, entry in zip(symbols, entries, strict=True)}
        yield "from_rotation_matrix", values


def _entries(names: list[str]) -> Iterator[list[tuple[int, int]]]:
    """The row and column of each name, counted from 0: m00, m_1_1, a_x, or m_8 of a flat array."""
    for pattern in (_ROW, ELEMENT):
        matches = [match for name in names if (match := pattern.fullmatch(name))]
        if len(matches) < len(names) or len({match["stem"] for match in matches}) != 1:
            continue
        if pattern is _ROW:
            yield [("abc".index(m["row"]), "xyz".index(m["column"])) for m in matches]
            continue
        indices = [(int(m["row"]), int(m["column"])) for m in matches]
        for first in (0, 1):
            moved = [(i - first, j - first) for i, j in indices]
            if all(0 <= index < 3 for place in moved for index in place):
                yield moved
    flat = [re.fullmatch(r"(.*?)_(\d+)", name) for name in names]
    stems = {match[1] for match in flat if match}
    numbers = [int(match[2]) for match in flat if match]
    if len(stems) == 1 and len(numbers) == len(names):
        for places, is_by_columns in _FLAT.values():
            if set(numbers) <= set(places):
                grid = [divmod(places.index(n), 3) for n in numbers]
                yield [(j, i) if is_by_columns else (i, j) for i, j in grid]
                break
