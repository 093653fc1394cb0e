"""A body as flat faces, meshed from its description, for the figure of a note and the live page.

A solid is a map of a box of coordinates; its surface is the image of the sides of the box, without
those that shrink to lines and those that meet, as at the angles 0 and 2π.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import cycle, islice, pairwise, permutations, product
from operator import add
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.evaluate import Floats, evaluate
from rigidsym.models import body as bodies
from rigidsym.notes.figure.drawing import RED, Color

Vector = NDArray[Any]  # (3,), or more than one of them: (n, 3)
BLUE, GOLD, GREY = (58, 110, 190), (226, 182, 74), (176, 182, 190)
BRONZE, HOLE = (196, 146, 56), (52, 54, 60)


class Face(NamedTuple):
    """A flat polygon."""

    corners: Vector  # (n, 3), counterclockwise as seen from outside
    color: Color


Shape = tuple[Face, ...]
Numbers = Mapping[sp.Symbol, sp.Float]

_PALETTE = (BLUE, GOLD, GREY, RED, BRONZE)
_SIZE = 0.95  # of the body drawn, from its centre of mass
_LENGTHS = (1.0, 0.22, 0.3, 1.4, 0.6, 0.15, 0.8)  # of parameters without a value
_FEW_LENGTHS = {2: (0.6, 1.0), 3: (1.0, 0.55, 0.8)}
_MOST_TRIES = 500
_ROUND, _CURVED = 24, 8  # divisions of a full circle, and of any other coordinate that bends
_SWELL = sp.Rational(101, 100)  # of a hole, so that its rim is seen on the surface
_THICK = 0.03  # half the width of a line
_PARTICLE = 0.09  # radius
_FLOATS = Floats(np)
_OCTAHEDRON = [  # its faces: signs of the corners on the axes, in counterclockwise order
    np.diag(signs)[:: int(np.prod(signs))] for signs in product((1.0, -1.0), repeat=3)
]


def own_shape(body: bodies.RigidBody | None) -> Shape:
    """The faces of a body, none if only its moments are known.

    Its centre of mass is at the origin, or the fixed point that is stated.
    """
    numbers = numbers_of(body) if body else None
    if body is None or numbers is None:
        return ()
    centre = body.centre if body.fixed_point is None else body.fixed_point
    centre = _floats(centre.xreplace(numbers))
    faces = meshed(_described(body), numbers)
    distances = (np.linalg.norm(face.corners - centre, axis=1).max() for face in faces)
    reach = max(distances, default=0.0)
    if not (reach and np.isfinite(reach)):
        return ()
    return tuple(Face(_SIZE / reach * (corners - centre), color) for corners, color in faces)


def numbers_of(body: bodies.RigidBody) -> Numbers | None:
    """The parameters of a body with their values, or with others that give it a proper shape.

    None if only its moments are known.
    """
    if not _described(body):
        return None
    values = {
        p.symbol: body.example.get(p.symbol.name) if p.value is None else p.value
        for p in (*body.declared, *body.parameters)
    }
    lengths = lengths_of(_described(body), values)
    # Parameters that are no lengths, such as densities, do not change the shape; 1 will do.
    return None if lengths is None else lengths | dict.fromkeys({*values} - {*lengths}, sp.Float(1))


def lengths_in(body: bodies.RigidBody) -> set[sp.Basic]:
    """The constants that the shape of a body is made of; none if only its moments are known."""
    return _constants(_described(body)) if _described(body) else set()


def _described(body: bodies.RigidBody) -> Any:
    return body.distribution or body.drawn


def lengths_of(
    what: bodies.Distribution, values: Mapping[sp.Symbol, float | None]
) -> dict[sp.Symbol, sp.Float] | None:
    """The parameters with their values, or a suitable length if they have none."""
    numbers = {symbol: value for symbol, value in values.items() if value is not None}
    solids = [leaf.what for leaf in _leaves(what) if isinstance(leaf.what, bodies.Solid)]
    missing = sorted(_constants(what) - {*numbers}, key=str)
    lengths = _FEW_LENGTHS.get(len(missing), _LENGTHS[: len(missing)])
    if len(missing) > len(lengths):
        return None
    # The order in which lengths fit is unknown, such as an inner radius below the outer one. All
    # orders are tried, the first ones with the preferred proportions.
    for chosen in islice(permutations(lengths), _MOST_TRIES):
        pairs = {**numbers, **dict(zip(missing, chosen, strict=True))}
        trial = {symbol: sp.Float(value) for symbol, value in pairs.items()}
        if all(_is_proper(solid, trial) for solid in solids):
            return trial
    return None


def meshed(what: bodies.Distribution, numbers: Numbers) -> Shape:
    """The faces of what has mass, in its own axes, in metres."""
    sheets = [(*sheet, leaf.color) for leaf in _leaves(what) for sheet in _sheets(leaf, numbers)]
    if not sheets:
        return ()
    # the size without any thickness, of which those of particles and lines are fractions
    points = np.concatenate([grid.reshape(-1, 3) for grid, _, _ in sheets])
    size = float(np.linalg.norm(points - points[0], axis=1).max()) or 1.0
    return tuple(
        Face(size * corners, color)
        for grid, faces, color in sheets
        for corners in faces(grid / size)
    )


# Points (..., 3) in metres, and how they become faces, in a unit that makes the whole of size 1.
_Sheet = tuple[Vector, Callable[[Vector], Iterator[Vector]]]


class _Leaf(NamedTuple):
    """Part of a body that is not composed, moved into the axes of the whole."""

    what: bodies.Distribution
    at: sp.ImmutableMatrix = bodies.HERE
    turned: sp.ImmutableMatrix = bodies.UPRIGHT
    color: Color = BLUE


def _leaves(what: bodies.Distribution, whole: _Leaf | None = None) -> Iterator[_Leaf]:
    whole = whole or _Leaf(what)
    if not isinstance(what, bodies.Composite):
        yield whole
        return
    for part, tint in zip(what.parts, cycle(_PALETTE), strict=False):
        at, turned = whole.at + whole.turned * part.at, whole.turned * part.turned
        color = HOLE if part.hole or whole.color == HOLE else tint
        swollen = turned * (_SWELL if part.hole else 1)
        yield from _leaves(part.what, _Leaf(part.what, at, swollen, color))


def _constants(what: bodies.Distribution) -> set[sp.Basic]:
    """The symbols in lengths and positions."""
    symbols: set[sp.Basic] = set()
    for leaf in _leaves(what):
        symbols |= leaf.at.free_symbols | leaf.turned.free_symbols
        match leaf.what:
            case bodies.Particles():
                symbols |= {s for p in leaf.what.particles for s in p.position.free_symbols}
            case bodies.Solid():
                lengths = sp.Tuple(leaf.what.place, *(sp.Tuple(*ends) for ends in leaf.what.bounds))
                symbols |= lengths.free_symbols - {*leaf.what.coordinates}
    return symbols


def _floats(column: Any) -> Vector:
    return np.array([*column], float)


def _sheets(leaf: _Leaf, numbers: Numbers) -> Iterator[_Sheet]:
    turned = _floats(leaf.turned.xreplace(numbers)).reshape(3, 3)
    at = _floats(leaf.at.xreplace(numbers))
    sheets: Iterable[_Sheet]
    match leaf.what:
        case bodies.Particles():
            positions = (_floats(p.position.xreplace(numbers)) for p in leaf.what.particles)
            sheets = ((position, _octahedron) for position in positions)
        case bodies.Solid():
            sheets = _of_solid(leaf.what, numbers)
        case bodies.Known():
            sheets = ()
    return ((at + points @ turned.T, faces) for points, faces in sheets)


def _octahedron(centre: Vector) -> Iterator[Vector]:
    return (centre + _PARTICLE * face for face in _OCTAHEDRON)


# A solid


def _map(solid: bodies.Solid, numbers: Numbers, *shares: Any) -> Vector:
    """The points (..., 3) of a solid for coordinates that run from 0 to 1, in metres."""
    values: dict[sp.Expr, Any] = {}
    for symbol, share, pair in zip(solid.coordinates, shares, solid.bounds, strict=True):
        low, high = (evaluate(sp.S(end).xreplace(numbers), _FLOATS, values) for end in pair)
        values[symbol] = low + share * (high - low)
    place = [evaluate(part.xreplace(numbers), _FLOATS, values) for part in solid.place]
    return np.stack(np.broadcast_arrays(*place, *shares)[:3], axis=-1)


def _is_proper(solid: bodies.Solid, numbers: Numbers) -> bool:
    """Whether bounds are in order, and the map never turns inside out."""
    lengths = (sp.S(high - low).xreplace(numbers) for low, high in solid.bounds)
    if any(length.is_negative for length in lengths):
        return False
    # The Jacobian may vanish on the sides of the box, as at the centre of a ball, but it must keep
    # its sign inside.
    shares = np.ix_(*[[0.1, 0.5, 0.9]] * 3)
    return len(solid.coordinates) < 3 or len({*_is_outward(solid, numbers, *shares).flat}) == 1


def _is_outward(solid: bodies.Solid, numbers: Numbers, *shares: Any) -> Vector:
    """Whether the determinant of the map is positive."""
    here = _map(solid, numbers, *shares)
    steps = 1e-4 * np.eye(3)
    moved = [_map(solid, numbers, *map(add, shares, step)) for step in steps]
    return np.linalg.det(np.stack(moved, axis=-2) - here[..., None, :]) > 0


def _of_solid(solid: bodies.Solid, numbers: Numbers) -> Iterator[_Sheet]:
    """A line; both sides of a surface; or the surface of a volume, side by side of its box."""
    counts = [_divisions(solid, symbol) for symbol in solid.coordinates]
    if len(counts) == 1:
        count = 2 * _ROUND if counts[0] > 1 else 1
        yield _map(solid, numbers, np.linspace(0, 1, count + 1)), _tube
        return
    steps = [np.linspace(0, 1, count + 1) for count in counts]
    if len(counts) == 2:
        grid = _map(solid, numbers, *np.ix_(*steps))
        yield from ((grid, tiles), (grid[:, ::-1], tiles))
        return
    # The columns and rows of a side run along k and j. e_j × e_k = e_i points outward on the upper
    # side if the map preserves the orientation; elsewhere the order of the rows is reversed.
    outward = 1 if _is_outward(solid, numbers, 0.5, 0.5, 0.5) else -1
    for axis in range(3):
        others = np.ix_(steps[(axis + 1) % 3], steps[(axis + 2) % 3])
        low, high = (
            _map(solid, numbers, *np.roll(np.array([end, *others], object), axis))
            for end in (0.0, 1.0)
        )
        # a closed coordinate has no ends
        if np.linalg.norm(high - low, axis=-1).max() > 1e-9 * np.abs(high).max():
            yield from ((high[:, ::outward], tiles), (low[:, ::-outward], tiles))


def _divisions(solid: bodies.Solid, symbol: sp.Symbol) -> int:
    if any(wave.has(symbol) for wave in solid.place.atoms(sp.sin, sp.cos)):
        low, high = solid.bounds[solid.coordinates.index(symbol)]
        turns = (high - low) / (2 * sp.pi)
        return int(sp.ceiling(_ROUND * turns)) if turns.is_number else _ROUND
    later = any(bound.has(symbol) for pair in solid.bounds for bound in pair)
    return _CURVED if later or solid.place.diff(symbol).has(symbol) else 1


def tiles(grid: Vector) -> Iterator[Vector]:
    """The tiles of a grid, counterclockwise as seen along (row) × (column); none without area."""
    grid = np.round(grid, 9) + 0.0  # without the errors that would part one corner into two
    for i, j in np.ndindex(len(grid) - 1, grid.shape[1] - 1):
        around = (grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1])
        corners = np.array([*dict.fromkeys(map(tuple, around))])
        if len(corners) > 2 and np.linalg.norm(area_of(corners)) > 1e-9:
            yield corners


def unit(a: Vector) -> Vector:
    return a / np.linalg.norm(a)


def area_of(corners: Vector) -> Vector:
    """Twice the area of a polygon, as a vector along its normal."""
    edges = corners[1:] - corners[0]
    return np.cross(edges[:-1], edges[1:]).sum(axis=0)


def _tube(line: Vector) -> Iterator[Vector]:
    """A thin square tube along a line (n, 3), with its ends, piece by piece."""
    for start, end in pairwise(line):
        along = unit(end - start)
        # The auxiliary axis must not be nearly parallel to the line.
        u = unit(np.cross(along, np.eye(3)[np.abs(along).argmin()]))
        v = np.cross(along, u)
        around = _THICK * np.array([u + v, u - v, -u - v, v - u, u + v])
        yield from tiles(np.array([start + around, end + around]))
        yield from (start + around[:-1], (end + around[:-1])[::-1])
