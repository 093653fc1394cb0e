"""The JSON Schema of derivation files, and the check of a file by it.

`keys.toml` declares every key. Here the names that the code knows are filled in, and a file is
compared with the result: all faults are noted with their paths, and what is right is kept.
"""

from __future__ import annotations

import json
import reprlib
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from math import isfinite
from typing import Any
from unicodedata import category

import sympy as sp

from rigidsym.algebra.evaluate import is_never_negative
from rigidsym.errors import offer
from rigidsym.kernels.lowering.derivatives import read_request
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities import check_quantity
from rigidsym.models.library import read_part, turned_by
from rigidsym.models.solids import SHAPES
from rigidsym.motion import CHOICES, QUANTITIES
from rigidsym.notes.note import check_style
from rigidsym.spec.derivation_spec import NOTES
from rigidsym.spec.faults import Place, dotted
from rigidsym.system.files import table_beside
from rigidsym.text.names import check_name

Schema = dict[str, Any]
LENGTHS = {length.key: length for shape in SHAPES.values() for length in shape.lengths}

_TYPES: Mapping[str, tuple[Any, str]] = {  # and what messages call them
    "string": (str, "a text in quotes"),
    "boolean": (bool, "true or false"),
    "number": (int | float, "a number"),
    "integer": (int, "a whole number"),
    "array": (list, "a list"),
    "object": (Mapping, "a table"),
}


def _check_derivative(text: str) -> None:
    """Raise KernelError or QuantityError for a text that is no derivative of a quantity."""
    check_quantity(read_request(text).quantity)


_FORMATS: Mapping[str, Callable[[str], Any]] = {  # that raise an error for other texts
    "name": check_name,
    "expression": lambda text: read_part(text, ()),
    "turns": turned_by,
    "style": check_style,
    "derivative": _check_derivative,
}
_ANYWHERE = dict.fromkeys(sp.symbols("x:z"), (-sp.oo, sp.oo))  # coordinates in a density
_LARGEST = 1e300  # sums and products of numbers in a file stay finite


@cache
def schema_of(kind: str) -> Schema:
    """The schema of a "file", or of the request in a "record"."""
    declared = table_beside(__file__, "keys.toml")
    definitions = declared["definitions"]
    distribution = definitions["distribution"]["properties"]
    for key, length in LENGTHS.items():
        distribution.setdefault(key, {"use": "lengths" if length.names[1:] else "length"})
    for key, names in CHOICES.items():
        choice = {"type": "string", "enum": [*names], "description": f"by default {names[0]}"}
        definitions["notation"]["properties"][key] = choice
    enums: dict[str, Iterable[Any]] = {
        f"{target}.{key}": values
        for target, entry in TARGETS.items()
        for key, values in entry.options.items()
    }
    enums |= {"shapes": SHAPES, "quantities": QUANTITIES, "kernels": TARGETS, "note": NOTES}

    def expanded(entry: Any) -> Any:
        """The entry with what it uses, and with the names that the code knows."""
        if isinstance(entry, list):
            return [expanded(part) for part in entry]
        if not isinstance(entry, dict):
            return entry
        used = entry.get("use", [])
        bases = [used] if isinstance(used, str) else used
        own = {key: expanded(value) for key, value in entry.items() if key != "use"}
        if isinstance(names := own.get("enum"), str):
            own["enum"] = [*enums[names]]
        merged: Schema = {}
        for part in (*(expanded(definitions[name]) for name in bases), own):
            both = {key: merged.get(key, {}) | part.get(key, {}) for key in ("properties", "kinds")}
            merged |= part | {key: entries for key, entries in both.items() if entries}
        if "properties" in merged:
            merged |= {"type": "object", "additionalProperties": False}
        return merged

    schema = expanded(definitions[kind])
    tables = {key: entry for key, entry in schema["properties"].items() if "properties" in entry}
    hints = {key: f"it belongs in [{t}]" for t in tables for key in tables[t]["properties"]}
    top = "it belongs at the top of the file, outside the tables"
    hints = declared["removed"] | hints | dict.fromkeys(schema["properties"], top)
    for name, table in {"": schema, **tables}.items():
        table["hints"] = hints | declared["removed"].get(name, {})
    return schema


def checked(value: Any, schema: Schema, place: Place) -> Any:
    """The value at a place of a file, as far as it is right; every fault is noted.

    A key that is not known is left out; a value that is wrong becomes None. Every value is checked
    by itself: what is wrong with several together is found by those who read them.
    """
    kinds = [schema] if "type" in schema else schema["anyOf"]
    kind = next((kind for kind in kinds if _is_of(value, kind["type"])), None)
    if kind is None:
        place.mistyped(value, expected(schema, place))
    elif isinstance(value, Mapping):
        return _checked_table(value, kind, place)
    elif isinstance(value, list):
        return _checked_list(value, kind, place)
    elif isinstance(value, str):
        return _checked_text(value, kind, place)
    elif not (isfinite(value) and abs(value) < _LARGEST):
        place.fault(f"expected a finite number, got {value:.3g}")
    elif value <= kind.get("exclusiveMinimum", -_LARGEST):
        place.fault(f"expected a positive number, got {value:g}")
    else:
        return value
    return None


def _is_of(value: object, types: str | list[str]) -> bool:
    """Whether a value is of one of the types; true and false are not numbers."""
    names = [types] if isinstance(types, str) else types
    return any(
        isinstance(value, _TYPES[name][0]) and isinstance(value, bool) == (name == "boolean")
        for name in names
    )


def kind_of(table: Mapping[str, Any], name: str = "body") -> str:
    """The key that tells the kind of a body, or of a part of one; "" without one."""
    kinds = schema_of("file")["properties"][name]["kinds"]
    return next((kind for kind in kinds if kind in table), "")


def _checked_table(value: Mapping[str, Any], schema: Schema, place: Place) -> dict[str, Any]:
    value = {key: entry for key, entry in value.items() if entry is not None}  # null in JSON
    all_keys = schema.get("properties", dict.fromkeys(value, schema.get("additionalProperties")))
    keys = dict(all_keys)
    if kinds := schema.get("kinds"):
        present = [kind for kind in kinds if kind in value]
        if len(present) != 1:
            got = " and ".join(present) or "none"
            place.fault(f"expected one of {', '.join(kinds)}; got {got}")
        # without a kind, as if its key has a typing error, those of any are right
        own = {key for kind in present or kinds for key in (kind, *kinds[kind])}
        if "shape" in own:  # keys of an unknown one may be those of any
            shape = value.get("shape")
            own |= {e.key for e in SHAPES[shape].lengths} if shape in [*SHAPES] else {*LENGTHS}
        others = {*kinds, *LENGTHS}.union(*kinds.values()) - own
        keys = {key: entry for key, entry in keys.items() if key not in others}
    for key in value.keys() - keys.keys():
        hint = schema.get("hints", {}).get(key) if key not in all_keys else None
        place.at(key).fault(f"unknown key; {hint or offer(key, keys)}")
    # a missing key that is required is noted as None
    wanted = {*value, *schema.get("required", ())}
    return {key: checked(value.get(key), keys[key], place.at(key)) for key in keys if key in wanted}


def _checked_list(value: list[Any], schema: Schema, place: Place) -> list[Any] | None:
    if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
        place.mistyped(value, expected(schema, place))
        return None
    entries = [checked(entry, schema["items"], place.at(k)) for k, entry in enumerate(value)]
    for k, entry in enumerate(entries):
        if schema.get("uniqueItems") and entry is not None and entry in entries[:k]:
            place.at(k).fault(f"{entry} is named twice")
    return entries


def _checked_text(value: str, schema: Schema, place: Place) -> str | None:
    if value not in schema.get("enum", [value]):
        place.fault(
            f"unknown name {reprlib.repr(value)}; {offer(value, schema['enum'], listed=True)}"
        )
        return None
    # A control character would end a comment or a line of what is printed from the text.
    allowed = "" if schema.get("format") == "line" else "\n\t"
    for character in value:
        if category(character) in ("Cc", "Cs") and character not in allowed:
            place.fault(f"the text contains the control character U+{ord(character):04X}")
            return None
    text: str | None = value
    if check := _FORMATS.get(schema.get("format", "")):
        text = None
        with place.noting():
            result = check(value)
            text = str(result) if schema["format"] == "name" else value  # phi for φ
            if "exclusiveMinimum" in schema and is_never_negative(-result, _ANYWHERE):
                place.fault(f"expected a positive number, got {value}")
    return text


def expected(schema: Schema, place: Place) -> str:
    """What a message says that a value should be."""
    if "type" not in schema:
        return " or ".join(dict.fromkeys(expected(kind, place) for kind in schema["anyOf"]))
    kind = schema["type"]
    if kind == "object" and place.path and isinstance(place.path[-1], str):
        return f"a table [{dotted(place.path)}]"
    if isinstance(kind, list):
        return 'a number, or an expression in quotes such as "2*a"'
    size = f" of {schema['maxItems']} entries" if "maxItems" in schema else ""
    such = [json.dumps(example, ensure_ascii=False) for example in schema.get("examples", ())]
    return _TYPES[kind][1] + size + "".join(f" such as {text}" for text in such)
