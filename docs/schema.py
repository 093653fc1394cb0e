"""The JSON Schema of derivation files, `docs/derivation.schema.json`, and its table.

Both are made from `rigidsym/spec/keys.toml`, by which the reader checks a file.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from rigidsym.spec.schema import schema_of

Schema = dict[str, Any]


def schema() -> Schema:
    found = deepcopy(schema_of("file"))  # which keeps its hints for the reader of files
    for table in (found, *found["properties"].values()):
        table.pop("hints", None)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}


def rows(table: Schema, path: str = "") -> Iterator[tuple[str, str, str]]:
    """(key, type, meaning) of every key, tables before what is in them."""
    for key, entry in table["properties"].items():
        place = f"{path}{key}"
        yield place, _kind(entry), entry.get("description", "")
        if entry.get("properties"):
            yield from rows(entry, f"{place}.")
        elif key == "parameters":
            yield from rows(entry["additionalProperties"], f"{place}.NAME.")


def _kind(entry: Schema) -> str:
    if "anyOf" in entry:
        return " or ".join(map(_kind, entry["anyOf"]))
    kind = entry["type"]
    if isinstance(kind, list):
        return "number or expression"
    names = {"object": "table", "array": "list", "boolean": "true or false", "string": "text"}
    return names.get(kind, kind)
