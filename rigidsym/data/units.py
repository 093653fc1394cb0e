"""Units in the headers of columns: read, compared and converted."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import pi, prod

from rigidsym.errors import DataError

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


@dataclass(frozen=True, slots=True)
class Unit:
    """A multiple of a product of powers of rad, m, kg and s."""

    factor: float
    powers: tuple[tuple[str, int], ...]  # in alphabetical order, none of them 0


def _product(*units: tuple[Unit, int]) -> Unit:
    powers: dict[str, int] = {}
    for unit, exponent in units:
        for base, power in unit.powers:
            powers[base] = powers.get(base, 0) + power * exponent
    factor = prod((unit.factor**exponent for unit, exponent in units), start=1.0)
    return Unit(factor, tuple(sorted((base, power) for base, power in powers.items() if power)))


def _known() -> dict[str, Unit]:
    known = {name: Unit(factor, (("rad", 1), ("s", -1))) for name, factor in _RATES.items()}
    for names, prefixes, base, multiple in _SPELLINGS:
        for name in names.split():
            for prefix in ("", *prefixes):
                known[prefix + name] = Unit(_PREFIXES[prefix] * multiple, ((base, 1),))
    return known


_KNOWN = _known()


def unit_of(text: str) -> Unit:
    """A unit such as `deg/s`, `°/s`, `dps`, `rad s^-1`, `rad·s⁻¹`, `degrees per second`, `kg m²`.

    Raises DataError, with its name, for one that is not known.
    """
    plain = re.sub(r"\bper\b", "/", text.casefold().translate(_SUPERSCRIPTS)).strip()
    if plain in ("", "-", "1"):
        return Unit(1.0, ())
    units: list[tuple[Unit, int]] = []
    sign = -1 if plain.startswith("1/") else 1
    rest = plain.removeprefix("1/").strip()
    while rest:
        factor = _FACTOR.match(rest)
        if not factor or factor[1] not in _KNOWN:
            raise DataError(f"unknown unit {text!r}")
        units.append((_KNOWN[factor[1]], sign * int(factor[2] or 1)))
        rest = rest[factor.end() :].strip()
        sign = {"/": -1, "*": 1}.get(rest[:1], sign)  # a blank keeps it: rad/s s is rad/s²
        rest = rest.lstrip("*/() ")
    return _product(*units)


def conversion(text: str, expected: str) -> float:
    """The factor from one unit to another: π/180 for deg and rad.

    Raises DataError for an unknown unit, and for one of another quantity.
    """
    unit, wanted = unit_of(text), unit_of(expected)
    if unit.powers != wanted.powers:
        raise DataError(f"expected a unit such as {expected or '1'}, got {text}")
    return unit.factor / wanted.factor


def is_angular(text: str) -> bool:
    """Whether a text is a unit of angles or of their rates."""
    try:
        return ("rad", 1) in unit_of(text).powers
    except DataError:
        return False
