"""The [rotation] table of a derivation file, read into models."""

from __future__ import annotations

from typing import Any

from rigidsym.errors import ExpressionError, ModelError
from rigidsym.models.euler_angles import DEFAULT_ANGLES, EULER_SEQUENCES
from rigidsym.models.rotation import RotationModel
from rigidsym.models.rotation_text import faults_in, rotation_from, rotation_given
from rigidsym.spec.derivation_spec import repeated
from rigidsym.spec.tables import Table
from rigidsym.spec.toml_lines import Path as Place
from rigidsym.text.names import check_name

KEYS = (
    *("sequence", "angles", "constants", "scalar_last"),
    *("matrix", "coordinates", "constraints", "passive"),
)
A_SEQUENCE = 'a sequence such as "ZXZ", or a list of sequences'
_THREE_NAMES = 'a list of three names such as ["phi", "theta", "psi"]'
_NAMES = 'a list of names such as ["phi", "theta"]'
_ROWS = "three rows of three expressions in quotes"
_OF_SEQUENCES = ("angles", "constants", "scalar_last")
_OF_MATRICES = ("coordinates", "constraints")


def read_rotation(table: Table, name: str) -> list[RotationModel]:
    """The models of a table: one per sequence, or one of its matrix, called `name`."""
    if table.value("matrix") is not None:
        return _read_matrix(table, name)
    for key in _OF_MATRICES:
        if table.value(key) is not None:
            table.fault("this key goes with matrix", key)
    options: dict[str, Any] = {
        "passive": bool(table.flag("passive")),
        "scalar_last": bool(table.flag("scalar_last")),
        "constants": _read_names(table, "constants", _NAMES) or (),
    }
    sequences = _read_sequences(table)
    angles = _read_angles(table, is_euler=any(_is_euler(text) for _, text in sequences))
    models: dict[Place, RotationModel] = {}
    for at, text in sequences:
        own = None if "(" in text else angles
        try:
            models[at] = rotation_from(text, names=own, **options)
        except (ModelError, ExpressionError) as error:
            table.fault(str(error), *at)
    if any("(" in text for _, text in sequences) and table.value("angles") is not None:
        table.fault("the sequence names its angles itself; leave this key out", "angles")
    for place, message in repeated(models.values()).items():
        table.fault(message, *list(models)[place])
    return list(models.values())


def _is_euler(text: str) -> bool:
    return text.translate(str.maketrans("123", "XYZ")) in EULER_SEQUENCES


def _read_matrix(table: Table, name: str) -> list[RotationModel]:
    for key in ("sequence", *_OF_SEQUENCES):
        if table.value(key) is not None:
            table.fault("this key does not go with matrix", key)
    rows = _read_rows(table)
    coordinates = _read_names(table, "coordinates", _NAMES)
    if table.value("coordinates") is None:
        table.fault(f"missing; expected {_NAMES}", "coordinates")
    constraints = table.texts("constraints", "a list of expressions that are zero") or []
    if rows is None or coordinates is None or None in constraints:
        return []
    conditions = [text for text in constraints if text is not None]
    unread = faults_in(rows, coordinates, conditions)
    for at, message in unread.items():
        table.fault(message, *at)
    if unread:
        return []
    try:
        model = rotation_given(
            rows,
            name=name,
            coordinates=coordinates,
            constraints=conditions,
            passive=bool(table.flag("passive")),
        )
    except (ModelError, ExpressionError) as error:
        table.fault(str(error), "matrix")
        return []
    return [model]


def _read_rows(table: Table) -> list[list[str]] | None:
    value = table.value("matrix")
    rows = value if isinstance(value, list) else []
    if len(rows) == 3 and all(isinstance(row, list) and len(row) == 3 for row in rows):
        texts = [[entry for entry in row if isinstance(entry, str)] for row in rows]
        if all(len(row) == 3 for row in texts):
            return texts
    table.mistyped(value, _ROWS, "matrix")
    return None


def _read_sequences(table: Table) -> list[tuple[Place, str]]:
    """(path, text) of each sequence that is a text."""
    value = table.value("sequence")
    if isinstance(value, list):
        texts = table.texts("sequence", A_SEQUENCE) or []
        return [(("sequence", k), text) for k, text in enumerate(texts) if text is not None]
    if isinstance(value, str):
        return [(("sequence",), value)]
    if value is None:
        table.fault(f"missing; expected {A_SEQUENCE}", "sequence")
    else:
        table.mistyped(value, A_SEQUENCE, "sequence")
    return []


def _read_angles(table: Table, *, is_euler: bool) -> list[str] | None:
    """Different names, three for Euler angles; None if a fault is noted."""
    names = _read_names(table, "angles", _THREE_NAMES if is_euler else _NAMES)
    given = table.value("angles")
    if is_euler and isinstance(given, list) and given and len(given) != len(DEFAULT_ANGLES):
        table.fault(f"expected {_THREE_NAMES}, got {len(given)}", "angles")
        return None
    return names


def _read_names(table: Table, key: str, expected: str) -> list[str] | None:
    """Different names; None if there are none or a fault is noted."""
    texts = table.texts(key, expected)
    if not texts:
        return None
    names = [_read_name(table, key, place, text) for place, text in enumerate(texts)]
    for place, name in enumerate(names):
        if name and name in names[:place]:
            table.fault(f"{name} is named twice", key, place)
    found = [name for name in dict.fromkeys(names) if name]
    return found if len(found) == len(names) else None


def _read_name(table: Table, key: str, place: int, text: str | None) -> str | None:
    try:
        return check_name(text) if text is not None else None
    except ExpressionError as error:
        table.fault(error.message, key, place)
        return None
