"""The [rotation] table of a derivation file, read into models."""

from __future__ import annotations

from math import isfinite
from typing import Any

from rigidsym.models.library import faults_in, rotation_from, rotation_given
from rigidsym.models.parametrisations import DEFAULT_ANGLES, DIGITS, EULER_SEQUENCES
from rigidsym.models.rotation import RotationModel
from rigidsym.spec.derivation_spec import repeated
from rigidsym.spec.tables import Path as Place, Table
from rigidsym.text.expression import parse_expression
from rigidsym.text.names import check_name

_OF_SEQUENCES = ("sequence", "angles", "constants", "scalar_last")
_OF_MATRICES = ("coordinates", "constraints", "example")
KEYS = (*_OF_SEQUENCES, "matrix", *_OF_MATRICES, "passive")
A_SEQUENCE = 'a sequence such as "ZXZ", or a list of sequences'
_THREE_NAMES = 'a list of three names such as ["phi", "theta", "psi"]'
_NAMES = 'a list of names such as ["phi", "theta"]'
_ROWS = "three rows of three expressions"


def read_rotation(table: Table, name: str) -> list[RotationModel]:
    """The models of a table: one per sequence, or one of its matrix, called `name`."""
    if table.value("matrix") is not None:
        return _read_matrix(table, name)
    for key in _OF_MATRICES:
        if table.value(key) is not None:
            table.fault("only a rotation with matrix has this key", key)
    options: dict[str, Any] = {
        "passive": bool(table.flag("passive")),
        "scalar_last": bool(table.flag("scalar_last")),
        "constants": _read_names(table, "constants", _NAMES),
    }
    sequences = _read_sequences(table)
    angles = _read_angles(
        table,
        is_euler=any(text.translate(DIGITS) in EULER_SEQUENCES for text in sequences.values()),
    )
    models: dict[Place, RotationModel] = {}
    for at, text in sequences.items():
        with table.noting(*at):
            models[at] = rotation_from(text, names=None if "(" in text else angles, **options)
    if any("(" in text for text in sequences.values()) and table.value("angles") is not None:
        table.fault("the sequence names its angles itself; leave this key out", "angles")
    for place, message in repeated(models.values()).items():
        table.fault(message, *list(models)[place])
    return list(models.values())


def _read_matrix(table: Table, name: str) -> list[RotationModel]:
    for key in _OF_SEQUENCES:
        if table.value(key) is not None:
            table.fault("a rotation with matrix does not have this key", key)
    rows = _read_rows(table)
    coordinates = _read_names(table, "coordinates", _NAMES)
    if table.value("coordinates") is None:
        table.mistyped(None, _NAMES, "coordinates")
    point = table.table("example")
    example = {k: _entry(point, v, k) or "0" for k, v in point.data.items()} if point else {}
    for key, text in example.items():
        with table.noting("example", key):
            parse_expression(text, {})
    constraints = [*table.texts("constraints", "a list of expressions that vanish").values()]
    if not coordinates or not rows:
        return []
    with table.noting("matrix"):
        for at, message in faults_in(rows, coordinates, constraints).items():
            table.fault(message, *at)
        is_passive = bool(table.flag("passive"))
        return [
            rotation_given(
                rows,
                name=name,
                coordinates=coordinates,
                constraints=constraints,
                passive=is_passive,
                example=example,
            )
        ]
    return []


def _read_rows(table: Table) -> list[list[str]]:
    """The texts of the entries of `matrix`; empty if a fault is noted."""
    value = table.value("matrix")
    rows = value if isinstance(value, list) else []
    if [len(row) if isinstance(row, list) else 0 for row in rows] != [3, 3, 3]:
        table.mistyped(value, _ROWS, "matrix")
        return []
    texts = [
        [_entry(table, entry, "matrix", i, k) for k, entry in enumerate(row)]
        for i, row in enumerate(rows)
    ]
    return texts if all(map(all, texts)) else []


def _entry(table: Table, value: object, *at: str | int) -> str:
    """The text of an expression or a number; empty, with the fault noted, for another value."""
    if isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value):
        return str(value)
    if not isinstance(value, str):
        table.mistyped(value, "an expression in quotes or a finite number", *at)
        return ""
    return value


def _read_sequences(table: Table) -> dict[Place, str]:
    """The texts of sequences by their paths."""
    value = table.value("sequence")
    if isinstance(value, str):
        return {("sequence",): value}
    if isinstance(value, list):
        texts = table.texts("sequence", A_SEQUENCE)
        return {("sequence", place): text for place, text in texts.items()}
    table.mistyped(value, A_SEQUENCE, "sequence")
    return {}


def _read_angles(table: Table, *, is_euler: bool) -> list[str] | None:
    """Different names, three for Euler angles; None if a fault is noted."""
    names = _read_names(table, "angles", _THREE_NAMES if is_euler else _NAMES)
    given = table.value("angles")
    if is_euler and isinstance(given, list) and given and len(given) != len(DEFAULT_ANGLES):
        table.fault(f"expected {_THREE_NAMES}, got {len(given)}", "angles")
        return None
    return names or None


def _read_names(table: Table, key: str, expected: str) -> list[str]:
    """Different names; empty if there are none or a fault is noted."""
    texts = table.texts(key, expected)
    names: list[str] = []
    for place, text in texts.items():
        with table.noting(key, place):
            if (name := check_name(text)) in names and text not in names:
                table.fault(f"{name} is named twice", key, place)
            names.append(name)
    given = table.value(key)
    is_whole = isinstance(given, list) and len(set(names)) == len(given)
    return names if is_whole else []
