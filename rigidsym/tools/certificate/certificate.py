"""A record to its certificate: cofactors for what each printed quantity says.

`checker` reads the printed expressions and states the claims; here each is written as a sum of
multiples of the relations, which `checker`, Coq and Lean can then verify without this package.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rigidsym.errors import CheckError
from rigidsym.tools.certificate.checker import BROKEN, Equation, Language, Poly, claims
from rigidsym.tools.certificate.cofactors import Division

SCHEMA = "rigidsym.certificate"
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
    claims: Mapping[str, Sequence[ProvedEquation]]
    uncovered: Sequence[str]  # quantities about which the checker states nothing

    @property
    def json(self) -> str:
        content = {
            "schema": SCHEMA,
            "schema_version": 1,
            "name": self.name,
            "parts": dict(self.parts),
            "names": list(self.names),
            "relations": self.relations,
            "claims": {
                name: [entry.cofactors for entry in entries]
                for name, entries in self.claims.items()
            },
            "uncovered": list(self.uncovered),
        }
        return json.dumps(content, separators=(",", ":"), ensure_ascii=False) + "\n"


def certificate_of(record: Mapping[str, Any]) -> Certificate:
    """Raises CheckError for a claim without cofactors, and for what the checker cannot read."""
    try:
        known, found = _claims(record)
    except BROKEN as error:
        raise CheckError(f"{record['name']}: no certificate, since {error}") from error
    relations = list(known.relations.values())
    residuals = {name: [one - two for one, two in entries] for name, entries in found.items()}
    division = Division(relations, [poly for entries in residuals.values() for poly in entries])

    def proved(name: str, equation: Equation, residual: Poly) -> ProvedEquation:
        try:
            cofactors = division.cofactors(residual)
        except CheckError as error:
            raise CheckError(f"{record['name']}: {name}: {error}") from error
        terms = {place: division.terms(cofactor) for place, cofactor in cofactors.items()}
        return ProvedEquation(left=equation[0], right=equation[1], cofactors=terms)

    return Certificate(
        name=record["name"],
        parts=known.parts,
        names=division.names,
        relations=[division.terms(division.element(relation)) for relation in relations],
        claims={
            name: [proved(name, *pair) for pair in zip(found[name], residuals[name], strict=True)]
            for name in found
        },
        uncovered=[q["name"] for q in record["quantities"] if q["name"] not in found],
    )


def _claims(record: Mapping[str, Any]) -> tuple[Language, dict[str, list[Equation]]]:
    """The claims, in cosines and sines of the parts of angles that all of them need."""
    first = Language(record, {})
    dict(claims(record, first))
    known = Language(record, first.parts)
    return known, dict(claims(record, known))
