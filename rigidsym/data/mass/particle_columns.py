"""Which columns of a table are masses and coordinates of particles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rigidsym.data.chunk import TableReader
from rigidsym.data.columns import ColumnNames, names_for
from rigidsym.data.mass.blocks import BLOCK, Array
from rigidsym.data.readers import ArrayReader
from rigidsym.errors import BodyError, DataError

_AXES = ("x", "y", "z")
_MASSES = ("m", "mass", "masses")


class ParticleBlock(NamedTuple):
    """Some particles, in kg and m."""

    masses: Array | None  # (n,); None: 1 kg each
    positions: Array  # (3, n)
    first: int  # the row of the first of them
    share: float  # of all particles that have been read with these


@dataclass(frozen=True, kw_only=True, slots=True)
class ParticleColumns:
    """The columns of the coordinates and the mass, and the factors to m and kg."""

    columns: tuple[int, ...]  # x, y, z, then perhaps the mass
    factors: tuple[float, ...]

    @classmethod
    def of(cls, reader: TableReader, names: Sequence[str] | None = None) -> ParticleColumns:
        """By the names given or those of the table, else of 3 (x, y, z) or 4 (m, x, y, z) columns.

        Raises BodyError if x, y or z is missing, if no column is the mass but one looks like it,
        and for units that are not of length and mass.
        """
        try:
            named = names_for(names, reader.width, reader.names)
            if named is None:
                if reader.width not in (3, 4):
                    raise BodyError(
                        "expected 3 columns (x, y, z) or 4 (m, x, y, z), got "
                        f"{reader.width}; --columns names them"
                    )
                named = ("m", *_AXES)[4 - reader.width :]
            header = ColumnNames(named)
            if not any(map(header.has, (*_AXES, *_MASSES))):  # perhaps not to be shown
                size = f"{Path(reader.source).stat().st_size} bytes" if reader.source else ""
                raise BodyError(
                    f"{size or 'an array'} without a column named x, y, z or m; "
                    "--columns names the columns in order"
                )
            return cls._named(header)
        except DataError as error:
            raise BodyError(str(error)) from None

    @classmethod
    def _named(cls, header: ColumnNames) -> ParticleColumns:
        found = [header.find([name]) for name in _AXES]
        mass = header.find(_MASSES)
        columns = [column for column in (*found, mass) if column is not None]
        others = [name for k, name in enumerate(header.plain) if k not in columns]
        if None in found:
            missing = _AXES[found.index(None)]
            near = get_close_matches(missing, others, n=1)
            raise BodyError(
                f"no column {missing} among {', '.join(header.names)}; "
                + (f"did you mean {near[0]}?" if near else "--columns names the columns in order")
            )
        if mass is None and (near := get_close_matches("mass", others, n=1)):
            names = ", ".join(header.names)
            raise BodyError(f"no column m or mass among {names}; is {near[0]} the mass?")
        units = ("m", "m", "m", "kg")[: len(columns)]
        factors = [header.factor(c, unit) or 1.0 for c, unit in zip(columns, units, strict=True)]
        return cls(columns=tuple(columns), factors=tuple(factors))

    def read(
        self, reader: TableReader, start: int = 0, stop: int | None = None
    ) -> Iterator[ParticleBlock]:
        """Blocks of the particles of a table, or of some rows of an array."""
        bounds = (start, stop) if isinstance(reader, ArrayReader) else ()
        for chunk in reader.chunks(self.columns, BLOCK, (), *bounds):
            table = np.ascontiguousarray(chunk.table.T, dtype=np.float64)
            if any(factor != 1 for factor in self.factors):
                table *= np.array(self.factors)[:, None]
            masses = table[3] if len(table) == 4 else None
            yield ParticleBlock(masses, table[:3], int(chunk.rows[0]), chunk.share)
