"""The JSON Schema of derivation files, `docs/derivation.schema.json`, and its table.

Editors check and complete TOML by it. Names of quantities, targets and shapes come from the code;
a test compares the file with this module and the schema with the reader.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rigidsym.models.solids import SHAPES
from rigidsym.pipeline import vocabulary

Schema = dict[str, Any]
VOCABULARY = vocabulary()


def text(about: str, *choices: str) -> Schema:
    return {"type": "string", "description": about} | ({"enum": [*choices]} if choices else {})


def flag(about: str) -> Schema:
    return {"type": "boolean", "default": False, "description": about}


def texts(about: str, *choices: str) -> Schema:
    items: Schema = {"type": "string"} | ({"enum": [*choices]} if choices else {})
    return {"type": "array", "items": items, "description": about}


def listed(about: str, items: Schema, count: int | None = None) -> Schema:
    size = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "items": items, "description": about} | size


def either(about: str, *kinds: Schema) -> Schema:
    return {"description": about, "anyOf": [*kinds]}


def obj(about: str, properties: Schema, **more: Any) -> Schema:
    return {
        "type": "object",
        "description": about,
        "properties": properties,
        "additionalProperties": False,
        **more,
    }


NUMBER: Schema = {"type": ["number", "string"]}


def number(about: str) -> Schema:
    return NUMBER | {"description": about}


def schema() -> Schema:
    properties = {
        "title": text("heading of the note, one line; by default the name of the rotation"),
        "theory": flag("begin the note with the equations that hold for every body and rotation"),
        "rotation": _rotation(),
        "parameters": {
            "type": "object",
            "description": "properties of the symbols of the body, one table for each",
            "additionalProperties": _parameter(),
        },
        "body": _body(),
        "dynamics": obj(
            "The forces on a body that turns about a fixed point.",
            {
                "potential": text('potential energy V(q), in joules: "m*g*l*cos(theta)"'),
                "forces": _by_name("generalised forces by coordinate, which may depend on rates"),
                "torque": _three("torque in body components, N m, with omega_body_1 and so on"),
                "frame_rate": _three("angular velocity of the frame of reference, constant in it"),
                "method": text("form of the equations", "lagrange", "euler"),
                "first_integrals": _by_name("constants of the motion by name, to be proved"),
                "parts": {
                    "type": "array",
                    "description": "other moving parts: rotation and principal_moments of a body "
                    "about the fixed point, or velocity and mass of a particle",
                    "items": obj(
                        "another body or a particle",
                        {
                            "rotation": text('its turns: "z(phi) x(theta)"'),
                            "principal_moments": _three("its moments of inertia"),
                            "velocity": _three("its velocity in space, linear in the rates"),
                            "mass": text("its mass"),
                        },
                    ),
                },
                "examples": {
                    "type": "array",
                    "description": "motions that the note draws; simulate uses the first",
                    "items": obj(
                        "a motion; values that it does not name are those of the first",
                        {
                            "parameters": _numbers("values of the constants, by name"),
                            "initial": _numbers("coordinates and rates at t = 0; others are 0"),
                            "time": {"type": "number", "description": "its duration in seconds"},
                        },
                    ),
                },
            },
        ),
        "notation": _notation(),
        "output": _output(),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rigidsym derivation file",
        **obj("A rotation, a body, and the output.", properties),
        "anyOf": [{"required": ["rotation"]}, {"required": ["body"]}],
    }


def _by_name(about: str) -> Schema:
    return {
        "type": "object",
        "description": about,
        "additionalProperties": {"type": "string"},
    }


def _numbers(about: str) -> Schema:
    return _by_name(about) | {"additionalProperties": {"type": "number"}}


def _three(about: str) -> Schema:
    return listed(about, {"type": "string"}, 3)


def _rotation() -> Schema:
    sequence = either(
        'a convention ("ZXZ", "313"), turns ("z(phi) x(theta)") or a name; or a list of these',
        {"type": "string"},
        {"type": "array", "items": {"type": "string"}},
    )
    return obj(
        "The rotation; without it, the angles of the lecture, ZXZ.",
        {
            "sequence": sequence,
            "angles": texts("names of the coordinates, in order"),
            "constants": texts("names in `sequence` that are constants"),
            "scalar_last": flag("order quaternions as (x, y, z, w)"),
            "matrix": listed(
                "your own R: three rows of three entries", listed("a row", NUMBER, 3), 3
            ),
            "coordinates": texts("names in `matrix` that are coordinates"),
            "constraints": texts("expressions in the coordinates of `matrix` that vanish"),
            "example": {
                "type": "object",
                "description": "exact values of coordinates and constants of `matrix`, by name, "
                "that satisfy the constraints",
                "additionalProperties": NUMBER,
            },
            "passive": flag("present Rᵀ, from space to body components"),
        },
    )


def _parameter() -> Schema:
    return obj(
        "A symbol.",
        {
            "positive": flag("whether its value is positive"),
            "about": text("what it means"),
            "unit": text("its unit"),
            "value": {"type": "number", "description": "its value in numerical results"},
        },
    )


def _distribution() -> Schema:
    """The keys of a shape, of particles and of a mesh."""
    triple = listed("three coordinates", NUMBER, 3)
    lengths = {length.key: length for shape in SHAPES.values() for length in shape.lengths}
    named = {key: _length(key, len(length.names)) for key, length in lengths.items()}
    particle = obj(
        "A particle.", {"mass": number("its mass"), "at": triple}, required=["mass", "at"]
    )
    return {
        "shape": text("a solid; see Rotations and solids", *SHAPES, "polyhedron", "given"),
        **named,
        "mass": number("the mass; a symbol by default"),
        "density": number("the density, instead of the mass"),
        "vertices": listed("corners of a polyhedron", triple),
        "faces": listed("its faces, each a list of corner numbers", {"type": "array"}),
        "coordinates": texts("names of the coordinates of a given solid"),
        "place": listed("x, y, z of a given solid in terms of its coordinates", NUMBER, 3),
        "bounds": listed(
            "bounds of a given solid, a pair for each coordinate, the outermost first", {}
        ),
        "element": number("length or area element of a given line or surface"),
        "particles": either(
            "point masses, or a file of them",
            {"type": "string"},
            {"type": "array", "items": particle},
        ),
        "columns": texts("names of the columns of a file of particles, in order"),
        "mesh": text("a closed mesh: an STL, OBJ or PLY file"),
        "scale": number("length unit of a mesh in metres"),
        "inertia": listed("the inertia tensor, three rows", listed("a row", NUMBER, 3), 3),
        "centre": listed("the centre of mass, with `inertia`", NUMBER, 3),
        "outline": obj(
            "the shape to draw, with `inertia`; records contain it instead of a mesh",
            {
                "corners": listed("three coordinates each", {"type": "array"}),
                "faces": listed("each a list of corner numbers", {"type": "array"}),
            },
        ),
    }


def _length(key: str, count: int) -> Schema:
    about = "a length of the shape; a symbol by default"
    if key == "corners":
        return listed("four corners of three coordinates", {"type": "array"}, 4)
    return number(about) if count == 1 else listed(f"{count} lengths of the shape", NUMBER, count)


def _body() -> Schema:
    part = obj(
        "A part of a composite.",
        {
            **_distribution(),
            "label": text("its name in the note"),
            "at": listed("the position of its origin", NUMBER, 3),
            "turned": either(
                "a constant rotation, applied before the shift by `at`",
                {"type": "string"},
                obj(
                    "A rotation by name.",
                    {"rotation": text("the rotation"), "values": listed("its angles", NUMBER)},
                ),
            ),
            "hole": flag("subtract this part"),
        },
    )
    return obj(
        "The body: exactly one of shape, particles, mesh, parts, inertia, principal_moments.",
        {
            **_distribution(),
            "parts": listed("a composite of such tables", part),
            "principal_moments": listed("the three principal moments", NUMBER, 3),
            "allow": flag("accept an unphysical body"),
        },
    )


def _notation() -> Schema:
    choices = {
        key: text(f"by default {values[0]}", *values) for key, values in VOCABULARY.choices.items()
    }
    return obj("The notation of notes and terminal.", choices)


def _output() -> Schema:
    return obj(
        "The output.",
        {
            "quantities": texts("quantities to derive, all by default", *VOCABULARY.quantities),
            "kernels": texts("languages of the functions, numpy by default", *VOCABULARY.kernels),
            **{name: _target(name) for name in VOCABULARY.target_options},
            "note": texts("formats of the note, tex and html by default", *VOCABULARY.note),
            "style": text("style of the note: lecture (default), audit, or a template of yours"),
            "conversions": flag("add functions to and from quaternions and matrices"),
            "derivatives": texts('Jacobians, such as "angular_velocity_body by q"'),
            "certificates": flag("add certificates: NAME.cert.json and NAME.v"),
        },
    )


def _target(name: str) -> Schema:
    properties = {
        key: flag(OPTIONS[name, key]) | {"default": values[0]}
        if isinstance(values[0], bool)
        else text(f"{OPTIONS[name, key]}, by default {values[0]}", *map(str, values))
        for key, values in VOCABULARY.target_options[name].items()
    }
    return obj(f"Options of the target {name}.", properties)


OPTIONS = {
    ("c", "precision"): "precision of the functions",
    ("c", "arrays"): "add functions of many orientations, which a Python module needs",
    ("c", "libm"): "call sin, cos and atan2 of <math.h> instead of built-in functions",
}


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
    kind = entry.get("type")
    if isinstance(kind, list):
        return "number or expression"
    names = {"object": "table", "array": "list", "boolean": "true or false", "string": "text"}
    return names.get(kind or "", kind or "any")
