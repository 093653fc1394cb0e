"""Singular orientations of long chains of turns, in time linear in their number.

The columns of the rate matrix are the axes of the turns; it loses rank if all of them are in one
plane. The axes of neighbouring turns always span a plane. So all axes are in one plane if and only
if every three neighbours are, and their triple product depends only on the angle of the middle
turn.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise, product

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.generators import is_identically_zero
from rigidsym.algebra.present import presenter_for
from rigidsym.algebra.zeros import solver_for
from rigidsym.mechanics.derivation import Place, Singularities, Singularity
from rigidsym.mechanics.kinematics.recursion import Recursion
from rigidsym.models.rotation import RotationModel

_MOST_POINTS = 8  # that are listed


def planes_of_axes(model: RotationModel, minors: Sequence[sp.Expr]) -> Singularities | None:
    """Where all axes of a chain lie in one plane; None if that was not decided.

    `minors` measure how far an orientation is from a singular one.
    """
    recursion = Recursion(model)
    if tuple(recursion.angles) != model.coordinates or not _all_span_planes(recursion.axes):
        return None
    choices: list[list[Place]] = []
    for k in range(1, recursion.count - 1):
        places = _flat(recursion, k)
        if places is None:
            return None
        choices.append(places)
    points = list(product(*choices))
    if len(points) > _MOST_POINTS:
        return None
    return Singularities(
        rank=3,
        measure="det W Wᵀ",
        determinant=None,
        minors=tuple(minors),
        points=tuple(_point(recursion, places) for places in points),
        is_solved=True,
    )


def _all_span_planes(axes: Sequence[sp.ImmutableMatrix]) -> bool:
    """Whether neighbours are certainly not parallel."""
    crossed = [first.cross(second) for first, second in pairwise(axes)]
    return all(
        normal.is_constant() and any(not is_identically_zero(entry) for entry in normal)
        for normal in crossed
    )


def _flat(recursion: Recursion, k: int) -> list[Place] | None:
    """The angles of turn k at which its axis and those of its neighbours lie in one plane."""
    before, axis, after = recursion.axes[k - 1 : k + 2]
    codec = codec_for([*recursion.plain[k], *before, *axis, *after], order=0)
    triple = codec.encode(before.dot(axis.cross(recursion.plain[k] * after)))
    zeros, is_complete = solver_for(codec, (recursion.angles[k],)).common([triple])
    return _by_half_turns([root.place for (root,) in zeros]) if is_complete else None


def _by_half_turns(places: Sequence[Place]) -> list[Place]:
    """Two angles half a turn apart as one, modulo π."""
    if len(places) == 2 and abs(places[0].value - places[1].value) == sp.pi:
        value = next(p.value for p in places if -sp.pi / 2 < p.value <= sp.pi / 2)
        return [Place(coordinate=places[0].coordinate, value=value, period=sp.pi)]
    return list(places)


def _point(recursion: Recursion, places: tuple[Place, ...]) -> Singularity:
    first, second = recursion.axes[:2]
    in_space = in_body = first.cross(second)
    values = {place.coordinate: place.value for place in places}
    for turn in recursion.plain[1:-1]:
        in_body = turn.subs(values).T * in_body
    return Singularity(
        places=places,
        rank=2,
        lost_axis_space=_short(recursion.plain[0] * in_space),
        lost_axis_body=_short(recursion.plain[-1].T * in_body),
        null_rates=sp.ImmutableMatrix(sp.Matrix.hstack(*_null_rates(recursion))),
    )


def _null_rates(recursion: Recursion) -> Iterator[sp.Matrix]:
    """Rates of three neighbours that leave the body at rest if their axes are in one plane."""
    for k in range(recursion.count - 2):
        u, v, after = recursion.axes[k : k + 3]
        w = recursion.plain[k + 1] * after
        square = u.dot(u) * v.dot(v) - u.dot(v) ** 2
        column = sp.zeros(recursion.count, 1)
        column[k] = (w.dot(v) * u.dot(v) - w.dot(u) * v.dot(v)) / square
        column[k + 1] = (w.dot(u) * u.dot(v) - w.dot(v) * u.dot(u)) / square
        column[k + 2] = 1
        yield _short(column)


def _short(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    codec = codec_for(matrix, order=0)
    entries = [presenter_for(codec).quotient(codec.encode_quotient(entry)) for entry in matrix]
    return sp.ImmutableMatrix(*matrix.shape, entries)
