"""The shipped solids: a map, bounds and, for lines and surfaces, an element, as texts.

They are the entries of solids.toml. Moments of inertia are not stored; all are integrated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

import sympy as sp
from sympy.core.symbol import uniquely_named_symbol

from rigidsym.errors import BodyError, offer
from rigidsym.models.body import Solid
from rigidsym.models.rotation import symbolic
from rigidsym.system.files import table_beside
from rigidsym.system.records import NamedTuple
from rigidsym.text.expression import parse_expression


class Length(NamedTuple):
    """A length that a solid asks for, or several of a kind."""

    key: str  # in a file: radius
    names: Sequence[str]  # of its symbols, by default
    about: str


class Shape(NamedTuple):
    """One kind of solid: its lengths, and its geometry in terms of them and of u, v, w."""

    title: str
    about: str  # where its origin and axes are
    lengths: Sequence[Length]
    place: str  # x, y, z, between commas
    bounds: str  # of u, v, w, as far as they are used
    element: str = ""  # of lines and surfaces
    larger: Sequence[tuple[str, str]] = ()  # keys, the first at least as long as the second

    @property
    def has_corners(self) -> bool:
        """Whether it is described by points, whose coordinates may have any sign."""
        return any(length.key == "corners" for length in self.lengths)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for length in self.lengths for name in length.names)


SHAPES: Mapping[str, Shape] = {
    name: Shape(
        **entry
        | {"lengths": [Length(k, names.split(), about) for k, names, about in entry["lengths"]]}
    )
    for name, entry in table_beside(__file__, "solids.toml").items()
}


def shape_of(name: str) -> Shape:
    """A shipped shape; raises BodyError for another name."""
    if not isinstance(name, str) or name not in SHAPES:
        raise BodyError(f"no shape {name!r}; {offer(str(name), SHAPES, listed=True)}")
    return SHAPES[name]


def shaped(
    name: str,
    lengths: Sequence[sp.Expr],
    *,
    mass: sp.Expr | None = None,
    density: sp.Expr | None = None,
) -> Solid:
    """The solid of a shape with all its lengths (m), in their order. Raises BodyError."""
    shape = shape_of(name)
    if len(lengths) != len(shape.names):
        raise BodyError(f"{name}: expected {', '.join(shape.names)}, got {len(lengths)} lengths")
    lengths = [symbolic(length, f"{name}: a length") for length in lengths]
    for length in lengths:
        if length.is_real is False:
            raise BodyError(f"{name}: {length} is not a length")
    check_lengths(name, [float(e) if e.is_number else None for e in lengths])
    used = [part for part in (*lengths, mass, density) if part is not None]
    # A length may itself be called u, as in radius = "u", and must not be integrated over.
    coordinates = {name: uniquely_named_symbol(name, used) for name in "uvw"}
    names = dict(zip(shape.names, lengths, strict=True)) | coordinates

    # The texts of solids.toml are read with the names of the shape standing for the lengths, so no
    # later substitution can confuse them.
    def read(text: str) -> list[sp.Expr]:
        return [parse_expression(part.strip(), names) for part in text.split(",")]

    bounds = [bound.split("..") for bound in shape.bounds.split(",")]
    # "0..2*pi, -h/2..h/2" holds the bounds of u and of v.
    return Solid(
        title=shape.title,
        coordinates=tuple(coordinates.values())[: len(bounds)],
        place=sp.ImmutableMatrix(read(shape.place)),
        bounds=tuple((*read(low), *read(high)) for low, high in bounds),
        element=read(shape.element)[0] if shape.element else None,
        mass=mass,
        density=density,
    )


def check_lengths(name: str, values: Sequence[float | None]) -> None:
    """Raises BodyError for a number that cannot be a length of the shape; None is not checked."""
    shape = shape_of(name)
    keys = [length.key for length in shape.lengths for _ in length.names]
    numbers = {key: v for key, v in zip(keys, values, strict=True) if v is not None}
    for key, value in zip(keys, values, strict=True):
        if value is not None and not value > 0 and not shape.has_corners:
            raise BodyError(f"{name}: {key} is {value:g} m; expected a positive length")
    for larger, smaller in shape.larger:
        # A length without a value fulfils every such condition.
        if numbers.get(larger, inf) < numbers.get(smaller, 0):
            raise BodyError(
                f"{name}: {larger} is {numbers[larger]:g} m, less than {smaller} with "
                f"{numbers[smaller]:g} m"
            )
