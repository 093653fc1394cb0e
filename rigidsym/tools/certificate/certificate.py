"""A record to its certificate: the claims that `checker` proves, and the cofactors it needs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rigidsym.errors import CheckError
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.checker import BROKEN, Language, Laws, Names, Unreadable
from rigidsym.tools.certificate.cofactors import Division, UnfinishedError

SCHEMA, SCHEMA_VERSION = "rigidsym.certificate", 3
# Rational points of spheres, for the example of coordinates with a norm
_ON_A_SPHERE = {2: "3/5 4/5", 3: "2/7 3/7 6/7", 4: "2/9 4/9 5/9 2/3"}
# R of the quaternion (2, 4, 5, 6)/9
_ENTRIES = "-41/81 16/81 68/81 64/81 -23/81 44/81 28/81 76/81 -1/81"


@dataclass(frozen=True, kw_only=True, slots=True)
class Certificate:
    """The claims of a record that are certified, and what the checker needs to prove them."""

    name: str
    record: str  # its digest
    claims: Sequence[str]
    uncovered: Sequence[str]  # quantities about which the checker states nothing
    example: Mapping[str, str]  # real numbers that satisfy the conditions
    cofactors: Mapping[str, Mapping[str, str]]  # by "NAME ENTRY" and the position of a condition

    @property
    def json(self) -> str:
        content = {
            "schema": SCHEMA,
            "schema_version": SCHEMA_VERSION,
            "name": self.name,
            "record": self.record,
            "claims": list(self.claims),
            "uncovered": list(self.uncovered),
            "example": dict(self.example),
            "cofactors": self.cofactors,
        }
        return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def certificate_of(record: Mapping[str, Any]) -> Certificate:
    """Raises CheckError for a claim that the checker refuses, or a rotation it cannot read."""
    try:
        return _certificate(record)
    except BROKEN as error:
        raise CheckError(f"{record['name']}: no certificate, since {error}") from error


def _certificate(record: Mapping[str, Any]) -> Certificate:
    names, printed = Names(record), [*checker.printed_in(record)]
    claims, cofactors = printed, dict[str, dict[str, str]]()

    def divide(language: Language, laws: Laws) -> list[str]:
        """Fill in the cofactors; returns claims that are not certified."""
        residuals, dropped = checker.residuals(laws, []), list[str]()
        for name in claims:
            try:
                residuals |= checker.residuals(laws, [name])
            except Unreadable:
                dropped.append(name)
        conditions = checker.conditions_of(record, language)
        division = Division(conditions, [poly for each in residuals.values() for poly in each])
        for name, entries in residuals.items():
            try:
                for k, residual in enumerate(entries, start=1):
                    if residual.terms:
                        cofactors[f"{name} {k}"] = division.cofactors(residual)
            except UnfinishedError:
                dropped.append(name)
            except CheckError as error:
                raise CheckError(f"{record['name']}: {name}: {error}") from error
        return dropped

    while dropped := checker.exactly(record, names, divide, claims):
        claims = [name for name in claims if name not in dropped]
        cofactors.clear()
    certificate = Certificate(
        name=record["name"],
        record=checker.digest(record),
        claims=claims,
        uncovered=[name for name in printed if name not in claims],
        example=_example(record, names),
        cofactors=cofactors,
    )
    checker.agree_in_numbers(record, names, json.loads(certificate.json))
    return certificate


def _example(record: Mapping[str, Any], names: Names) -> dict[str, str]:
    """Numbers that satisfy the conditions: those of the record, or rational points of spheres."""
    rotation = record["rotation"]
    if "example" in rotation or not rotation["conditions"]:
        return dict(rotation.get("example", {}))
    letters = [
        name
        for name in (*names.q, *names.constant)
        if name in checker.names_of(rotation["conditions"], names)
    ]
    groups = [
        [name for name in letters if name in checker.names_of([text], names)]
        for text in rotation["conditions"]
    ]
    if len(letters) == 9:
        return dict(zip(names.q, _ENTRIES.split(), strict=True))
    return {
        name: value
        for group in groups
        for name, value in zip(group, _ON_A_SPHERE[len(group)].split(), strict=True)
    }
