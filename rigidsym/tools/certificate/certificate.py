"""A record to its certificate: cofactors for what each printed quantity says.

`checker` reads the printed expressions and states the claims; here each is written as a sum of
multiples of the relations, which `checker`, Coq and Lean can then verify without this package.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import BROKEN, Language, Poly, stated
from rigidsym.tools.certificate.cofactors import Division, UnfinishedError
from rigidsym.tools.certificate.point import point_of

SCHEMA, SCHEMA_VERSION = "rigidsym.certificate", 2
_STATED_TOGETHER = ("principal_moments", "principal_axes")
Equation = tuple[Poly, Poly]
Terms = Sequence[Sequence[str | int]]  # coefficients, each with the places of its names


@dataclass(frozen=True, kw_only=True, slots=True)
class ProvedEquation:
    """left = right, since their difference is the sum of cofactors times relations."""

    left: Poly
    right: Poly
    cofactors: Mapping[int, Terms]  # by the place of the relation


@dataclass(frozen=True, kw_only=True, slots=True)
class Certificate:
    """The claims of a record, each with its cofactors."""

    name: str
    parts: Mapping[str, int]  # φ: n, where cosines and sines are those of φ/n
    names: Sequence[str]
    relations: Sequence[Terms]
    point: Mapping[str, int]  # where all relations hold, modulo PRIME
    claims: Mapping[str, Sequence[ProvedEquation]]
    uncovered: Sequence[str]  # quantities about which the checker states nothing

    @property
    def json(self) -> str:
        content = {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "name": self.name,
            "parts": dict(self.parts),
            "names": list(self.names),
            "relations": self.relations,
            "point": dict(self.point),
            "claims": {
                name: [entry.cofactors for entry in entries]
                for name, entries in self.claims.items()
            },
            "uncovered": list(self.uncovered),
        }
        return json.dumps(content, separators=(",", ":"), ensure_ascii=False) + "\n"


def certificate_of(record: Mapping[str, Any]) -> Certificate:
    """Raises CheckError for a claim without cofactors, and for a rotation that cannot be read."""
    try:
        known, found, uncovered = _claims(record)
        relations = [relation for relation in known.relations.values() if relation.terms]
        point = point_of(known)
    except BROKEN as error:
        raise CheckError(f"{record['name']}: no certificate, since {error}") from error
    residuals = {name: [one + two * -1 for one, two in entries] for name, entries in found.items()}
    division = Division(relations, [poly for entries in residuals.values() for poly in entries])

    def proved(name: str) -> Iterator[ProvedEquation]:
        for (left, right), residual in zip(found[name], residuals[name], strict=True):
            cofactors = division.cofactors(residual)
            terms = {place: division.terms(cofactor) for place, cofactor in cofactors.items()}
            yield ProvedEquation(left=left, right=right, cofactors=terms)

    claims: dict[str, Sequence[ProvedEquation]] = {}
    for name in found:
        try:
            claims[name] = list(proved(name))
        except UnfinishedError:
            uncovered.append(name)
        except CheckError as error:
            raise CheckError(f"{record['name']}: {name}: {error}") from error
    return Certificate(
        name=record["name"],
        parts=known.parts,
        names=division.names,
        relations=[division.terms(division.element(relation)) for relation in relations],
        point=point,
        claims=claims,
        uncovered=uncovered,
    )


def _claims(record: Mapping[str, Any]) -> tuple[Language, dict[str, list[Equation]], list[str]]:
    """The claims, and the names of quantities that the checker does not know or cannot read."""
    parts: dict[str, int] = {}
    for name, denominator in re.findall(r"(\w+)/(\d+)", json.dumps(record["rotation"])):
        parts[name] = math.lcm(parts.get(name, 1), int(denominator))
    asked = printed_names(record)
    names = [*asked]
    while (missing := _missing(record, parts, names)) in names:
        names.remove(missing)
    if missing:
        alone = [name for name in names if not _missing(record, parts, [name])]
        both = [*alone, *(name for name in names if name in _STATED_TOGETHER)]
        names = alone if _missing(record, parts, both) else both
    known = Language(record, parts)
    return known, stated(record, known, names), [name for name in asked if name not in names]


def printed_names(record: Mapping[str, Any]) -> list[str]:
    """The quantities of a record, and its first integrals as the checker names them."""
    constants = [f"constant {integral['name']}" for integral in record["first_integrals"]]
    return [quantity["name"] for quantity in record["quantities"]] + constants


def _missing(record: Mapping[str, Any], parts: Mapping[str, int], names: Sequence[str]) -> str:
    """Why the checker cannot state all claims: a name that it does not know, or a message."""
    try:
        stated(record, Language(record, parts), names)
    except BROKEN as error:
        return str(error.args[0] if error.args else error) or "unreadable"
    return ""
