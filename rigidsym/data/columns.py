"""Names of columns and their units, however they are written.

`Roll [deg]`, `roll` and `imu.ROLL` are one name; `deg/s`, `°/s` and `dps` are one unit.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from math import degrees, pi

from rigidsym.errors import DataError

COLUMNS = "--columns (in Python `columns`)"  # as messages call the names that a user gives

# Units

_PREFIXES = {"": 1.0, "n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3}
_DEGREE = pi / 180
# Spellings, the prefixes they take, the base unit (rad, m, kg, s) and its multiple. A grad is a
# gradian in English and a degree in German: it is not among them, and so it is refused.
_SPELLINGS = (
    ("rad radian radians", "num", "rad", 1.0),
    ("deg degree degrees °", "umc", "rad", _DEGREE),
    ("arcmin arcminute arcminutes ′ '", "", "rad", _DEGREE / 60),
    ('arcsec arcsecond arcseconds as ″ "', "um", "rad", _DEGREE / 3600),
    ("rev revs revolution revolutions turn turns", "", "rad", 2 * pi),
    ("gon gons gradian gradians", "cm", "rad", pi / 200),
    ("m meter meters metre metres", "numck", "m", 1.0),
    ("g gram grams", "umk", "kg", 1e-3),
    ("s sec second seconds", "num", "s", 1.0),
    ("min minute minutes", "", "s", 60.0),
    ("h hr hour hours", "", "s", 3600.0),
)
_RATES = {"dps": _DEGREE, "mdps": _DEGREE / 1e3, "cdps": _DEGREE / 100, "rpm": 2 * pi / 60}
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻µμ.·⋅∙×", "0123456789-uu*****")
_FACTOR = re.compile(r"([^\d*/^ ()-]+)(?:\^|\*\*)?(-?\d+)?")


Unit = tuple[float, dict[str, int]]  # a multiple of a product of powers of rad, m, kg and s
_KNOWN: dict[str, Unit] = {n: (factor, {"rad": 1, "s": -1}) for n, factor in _RATES.items()} | {
    prefix + name: (_PREFIXES[prefix] * multiple, {base: 1})
    for names, prefixes, base, multiple in _SPELLINGS
    for name in names.split()
    for prefix in ("", *prefixes)
}


def unit_of(text: str) -> Unit:
    """A unit such as `deg/s`, `°/s`, `dps`, `rad s^-1`, `rad·s⁻¹`, `degrees per second`, `kg m²`.

    Raises DataError, with its name, for one that is not known.
    """
    plain = re.sub(r"\bper\b", "/", text.casefold().translate(_SUPERSCRIPTS)).strip()
    sign = -1 if plain.startswith("1/") else 1
    rest = "" if plain in ("-", "1") else plain.removeprefix("1/").strip()
    size, powers = 1.0, Counter[str]()
    while rest:
        match = _FACTOR.match(rest)
        if not match or match[1] not in _KNOWN:
            raise DataError(f"unknown unit {text!r}")
        exponent, (multiple, bases) = sign * int(match[2] or 1), _KNOWN[match[1]]
        size *= multiple**exponent
        powers.update({base: power * exponent for base, power in bases.items()})
        rest = rest[match.end() :].strip()
        sign = {"/": -1, "*": 1}.get(rest[:1], sign)  # a blank keeps it: rad/s s is rad/s²
        rest = rest.lstrip("*/() ")
    return size, {base: power for base, power in powers.items() if power}


def conversion(text: str, expected: str) -> float:
    """The factor from one unit to another: π/180 for deg and rad.

    Raises DataError for an unknown unit, and for one of another quantity.
    """
    (size, powers), (wanted, expected_powers) = unit_of(text), unit_of(expected)
    if powers != expected_powers:
        raise DataError(f"expected a unit such as {expected or '1'}, got {text}")
    return size / wanted


def is_unit(text: str, base: str = "") -> bool:
    """Whether a text is a known unit, perhaps one with a base: `rad` of angles and their rates."""
    try:
        powers = unit_of(text)[1]
    except DataError:
        return False
    return not base or powers.get(base) == 1


# Names

Names = tuple[str, ...]
_BRACKETS = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]")
_TAIL = re.compile(r"(.+?)(?:\s*[,/:]\s*|[_ ])([^,:_ ]+)")
_INDEX = re.compile(r"[\[(](\d+)[\])]")
_GREEK = str.maketrans(
    {"φ": "phi", "θ": "theta", "ψ": "psi", "α": "alpha", "β": "beta", "γ": "gamma", "ω": "omega"}
)


def plain(name: str) -> str:
    """A name without its unit, quotes, case, spaces, hyphens and underscores."""
    bare = _BRACKETS.sub("", _INDEX.sub(r"\1", name)).strip("\"' ").translate(_GREEK).lower()
    return re.sub(r"[_\s./-]", "", bare)


def unit_in(name: str) -> str:
    """The unit in the brackets of a name, as written: deg of `Roll [deg]`; empty without one."""
    unit = _BRACKETS.search(_INDEX.sub(r"\1", name))
    return unit[1] if unit else ""


def counted(count: int, noun: str) -> str:
    """1 column, 2 columns."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def in_both_units(angle: float) -> str:
    """For an angle beyond a turn, which may be meant in degrees."""
    return f"{angle:.6g} radians, which are {degrees(angle):.6g} degrees"


class ColumnNames:
    """The header of a table: where a name is, and in which unit its numbers are.

    Units are in brackets, or of angles at the end of a name: `yaw [deg]`, `yaw_deg`, `"yaw, deg"`.
    A path as in logs of ROS and ArduPilot may precede a name: `field.orientation.x`, `ATT.Roll`.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(name.strip() for name in names)
        self.plain = tuple(map(plain, self.names))
        self._others = [dict(_other_keys(name)) for name in self.names]

    @property
    def listed(self) -> str:
        """The names, for messages; a single column, which may be prose, is only counted."""
        return ", ".join(self.names) if len(self.names) > 1 else "1 column"

    def _columns(self, name: str) -> list[int]:
        """The columns with a name, or else those at whose path or before whose unit it is."""
        key = plain(name)
        exact = [k for k, column in enumerate(self.plain) if column == key]
        return exact or [k for k, others in enumerate(self._others) if key in others]

    def find(self, spellings: Iterable[str]) -> int | None:
        """The column with one of these names, the first of which is preferred.

        Raises DataError for two columns of one name.
        """
        for name in spellings:
            columns = self._columns(name)
            if len(columns) > 1:
                same = ", ".join(self.names[k] for k in columns)
                raise DataError(
                    f"two columns are named {plain(name)}: {same}; {COLUMNS} renames them"
                )
            if columns:
                return columns[0]
        return None

    def has(self, name: str) -> bool:
        """Whether a column has this name."""
        return bool(self._columns(name))

    def unit(self, column: int) -> str:
        """The unit that the name of a column states; empty without one."""
        return unit_in(self.names[column]) or next(filter(None, self._others[column].values()), "")

    def factor(self, column: int, expected: str) -> float | None:
        """The factor from the unit in its name to the expected one; None without a unit.

        Raises DataError for a unit that is unknown or of another quantity.
        """
        stated = self.unit(column)
        if not stated:
            return None
        try:
            return conversion(stated, expected)
        except DataError as error:
            raise DataError(
                f"column {self.names[column]}: {error}; {COLUMNS} gives it another name and unit"
            ) from None


def names_for(
    names: Sequence[str] | None, width: int, former: Sequence[str] | None
) -> tuple[str, ...] | None:
    """Names that a user gives for all columns, in their order; without them those of the file.

    A unit that the `former` name of a column states, in the file, holds unless the new name
    states one. Raises DataError for too few names or too many, and for a name that the file gives
    to another column: the columns of a header are found by their names, in any order.
    """
    if names is None:
        return None if former is None else tuple(former)
    if len(names) != width:
        raise DataError(
            f"{counted(width, 'column')}, but {counted(len(names), 'name')} in {COLUMNS}; "
            "expected one name a column, in order, and - for a column to leave out"
        )
    if former is None:
        return tuple(names)
    before, after = ColumnNames(former), ColumnNames(names)
    for k, name in enumerate(names):
        place = before.find([name]) if before.has(name) else None
        if place not in (None, k):
            raise DataError(
                f"column {k + 1} would be {name}, but the file names it {before.names[k]}, and "
                f"column {place + 1} {before.names[place]}; leave out the names if these are right"
            )
    return tuple(
        f"{name} [{before.unit(k)}]" if before.unit(k) and not after.unit(k) else name
        for k, name in enumerate(names)
    )


def _other_keys(name: str) -> Iterator[tuple[str, str]]:
    """The name without a unit at its end, and without the path before it, with the unit."""
    unit = unit_in(name)
    if not unit and (tail := _TAIL.fullmatch(name.strip("\"' "))) and is_unit(tail[2], "rad"):
        name, unit = tail[1], tail[2]
        yield plain(name), unit
    segments = re.split(r"[./]", _BRACKETS.sub("", _INDEX.sub(r"_\1", name)))
    for start in range(1, len(segments)):
        key = plain("".join(segments[start:]))
        if start < len(segments) - 1 or len(key) > 2:  # x and w are too short to stand for much
            yield key, unit
