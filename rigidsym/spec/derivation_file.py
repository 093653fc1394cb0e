"""A derivation file (TOML) or the record of a derivation, read into a DerivationSpec."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rigidsym.errors import Fault, SpecError, offer
from rigidsym.kernels.lowering.derivatives import read_request
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.forces import forces_on
from rigidsym.models.library import read_part, rotation_from, rotation_given
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import QUANTITIES, Notation
from rigidsym.notes.note import check_style
from rigidsym.spec.body_table import read_body
from rigidsym.spec.derivation_spec import (
    DerivationSpec,
    fault_of_name,
    repeated,
)
from rigidsym.spec.faults import Place, shortened
from rigidsym.spec.schema import checked, schema_of
from rigidsym.system import resources
from rigidsym.system.files import read_bytes
from rigidsym.text.expression import parse_expression

Data = Mapping[str, Any]
_MOST_CHARACTERS = 50_000
_MOST_BYTES = 4 * _MOST_CHARACTERS  # no character takes more than four
_LONGEST_LINE = 1000  # tomllib's time grows with the square of the dots in a key
_OF_SEQUENCES = ("sequence", "angles", "constants", "scalar_last")
_OF_MATRICES = ("matrix", "coordinates", "constraints", "example")


def read_file(file: str) -> DerivationSpec:
    """Read a derivation file, given by its path or by the name of a shipped one.

    Raises SpecError with all its faults.
    """

    def refused(message: str) -> SpecError:
        return SpecError(file, [Fault(message=message)])

    shipped = resources.names("derivations", ".toml")
    path = Path(file)
    if path.suffix == ".json":
        raise refused("expected a derivation file, NAME.toml; only `check` reads records")
    if file in shipped and not path.is_file():
        path = resources.folder("derivations") / f"{file}.toml"
    try:
        content = read_bytes(path, _MOST_BYTES + 1)
    except FileNotFoundError:
        message = "no such file, and no shipped derivation of this name"
        raise refused(f"{message}; {offer(file, shipped)}") from None
    except OSError as error:
        raise refused(f"cannot be read: {error.strerror}") from None
    if len(content) > _MOST_BYTES:
        raise refused(f"cannot be read: it has more than {_MOST_BYTES} bytes")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise refused(f"not UTF-8 text, at line {line}") from None
    return read_spec(text, source=file, name=path.stem, folder=path.parent)


def read_spec(text: str, *, source: str, name: str, folder: Path | None = None) -> DerivationSpec:
    """The specification in the text of a derivation file.

    `source` is the file in messages; `name` names a single derivation; paths in the text start
    from `folder`. Raises SpecError with all faults.
    """
    place = Place({})
    data = checked(_toml(text, source), schema_of("file"), place)
    if "rotation" not in data and "body" not in data:
        place.at("rotation").fault('missing; expected [rotation] with sequence = "ZXZ" or another')
    models: list[RotationModel] = [EulerAngles("ZXZ")]
    sequence = None
    if "rotation" in data:
        rotation = data["rotation"]
        sequence = rotation and rotation.get("sequence")
        models = _rotation(rotation, place.at("rotation"), name)
    if not isinstance(sequence, list) and (message := fault_of_name(name)):
        place.fault(f"the file name is the name of the derivation: {message}")
    if isinstance(sequence, list) and len(models) == 1:
        name = models[0].name
    output = data.get("output") or {}
    return _spec(data, output, place, place.at("output"), source, name, models, folder or Path())


def read_record(data: object, *, source: str = "request") -> DerivationSpec:
    """The specification that `DerivationSpec.to_data` wrote. Raises SpecError with all faults."""
    if not isinstance(data, Mapping):
        raise SpecError(source, [Fault(message="expected an object")])
    place = Place({})
    read = checked(data, schema_of("record"), place)
    name = read["name"] or ""
    models = [
        model
        for k, rotation in enumerate(read["rotations"] or [])
        for model in _rotation(rotation, place.at("rotations", k), name)
    ]
    return _spec(read, read, place, place, source, name, models, None)


def _toml(text: str, source: str) -> dict[str, Any]:
    """The data of a whole file; raises SpecError for a text that is not TOML, or too long."""
    text = text.removeprefix("\ufeff")  # some editors put this mark before everything else
    faults = [
        Fault(f"line {line} has {length} characters; expected at most {_LONGEST_LINE}")
        for line, length in enumerate(map(len, text.split("\n")), start=1)
        if length > _LONGEST_LINE
    ]
    if len(text) > _MOST_CHARACTERS:
        size = f"a file of {len(text)} characters, which is no derivation file"
        faults = [Fault(f"{size}; expected at most {_MOST_CHARACTERS}")]
    if faults:
        raise SpecError(source, faults)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SpecError(source, [Fault(f"not TOML: {error}")]) from None
    except RecursionError:
        raise SpecError(source, [Fault("lists or tables nested too deeply to be read")]) from None


def _spec(
    data: Data,
    output: Data,
    place: Place,
    output_place: Place,
    source: str,
    name: str,
    models: Sequence[RotationModel],
    folder: Path | None,
) -> DerivationSpec:
    """All but the rotations, and all faults raised together."""
    theory = bool(data.get("theory"))
    if theory and any(model.passive for model in models):
        place.at("theory").fault("the theory is written for active rotations; remove passive")
    for key, message in (
        ("parameters", "parameters belong to a body; expected [body] as well"),
        ("dynamics", "forces act on a body; expected [body] as well"),
    ):
        if data.get(key) and "body" not in data:
            place.at(key).fault(message)
    body = data.get("body")
    if body is not None:
        body = read_body(body, data.get("parameters") or {}, place, name, folder)
    chosen: dict[str, Any] = {
        key: tuple(output[key])
        for key in ("quantities", "kernels", "note")
        if output.get(key) is not None
    }
    chosen |= {key: output[key] for key in ("conversions", "certificates") if output.get(key)}
    if style := output.get("style"):
        with output_place.at("style").noting():
            chosen["style"] = check_style(style)
    notation = data.get("notation")
    dynamics = _dynamics(data.get("dynamics") or {}, place.at("dynamics"), models)
    derivatives = _derivatives(
        output.get("derivatives") or [],
        output_place.at("derivatives"),
        chosen.get("quantities") or QUANTITIES,
    )
    options = {key: output[key] for key in TARGETS if output.get(key)}
    place.raise_faults(source)
    return DerivationSpec(
        name=name,
        title=data.get("title") or None,
        theory=theory,
        models=tuple(models),
        source=source,
        body=body,
        dynamics=dynamics if "dynamics" in data else None,
        notation=None if notation is None else Notation(**notation),
        derivatives=derivatives,
        target_options=options,
        **chosen,
    )


def _dynamics(data: Data, place: Place, models: Sequence[RotationModel]) -> dict[str, Any]:
    """What [dynamics] contains, each key read once with the names of every model."""
    dynamics = {"potential": "0"} | {k: value for k, value in data.items() if not _is_broken(value)}
    for model in models:
        for key, value in dynamics.items():
            with place.at(key).noting():
                forces_on(model, **{key: value})
    return dynamics


def _is_broken(value: Any) -> bool:
    """Whether a part of a value was wrong, so that None stands in its place."""
    entries = value.values() if isinstance(value, Mapping) else value
    return value is None or (
        not isinstance(value, str | float | int) and any(map(_is_broken, entries))
    )


def _derivatives(
    texts: Sequence[str | None], place: Place, quantities: Sequence[str]
) -> tuple[str, ...]:
    """The derivatives of the chosen quantities, each in its one spelling."""
    spelled = []
    for k, text in enumerate(texts):
        with place.at(k).noting():
            request = read_request(text or "")
            if request.quantity not in quantities:
                near = offer(request.quantity, quantities)
                place.at(k).fault(f"no quantity {shortened(request.quantity)}; {near}")
            spelled.append(str(request))
    return tuple(dict.fromkeys(spelled))


# rotations


def _rotation(data: Data | None, place: Place, name: str) -> list[RotationModel]:
    """The models of a table: one per sequence, or one of its matrix, called `name`."""
    if data is None:
        return []
    is_matrix = "matrix" in data
    for key in data.keys() & {*(_OF_SEQUENCES if is_matrix else _OF_MATRICES)}:
        message = "a rotation with matrix does not have this key"
        place.at(key).fault(message if is_matrix else "only a rotation with matrix has this key")
    if is_matrix:
        return _matrix(data, place, name)
    if "sequence" not in data:
        place.at("sequence").mistyped(None, 'a sequence such as "ZXZ", or a list of sequences')
    sequence = data.get("sequence")
    texts: list[tuple[Place, str | None]] = [(place.at("sequence"), sequence)]
    if isinstance(sequence, list):
        texts = [(place.at("sequence", k), text) for k, text in enumerate(sequence)]
    angles, constants = (_whole(data.get(key)) for key in ("angles", "constants"))
    if angles and any("(" in (text or "") for _, text in texts):
        place.at("angles").fault("the sequence names its angles itself; leave this key out")
    models: list[RotationModel] = []
    places: list[Place] = []
    for own, text in texts:
        if text is not None:
            with own.noting():
                make = partial(
                    rotation_from,
                    text,
                    constants=constants or (),
                    scalar_last=bool(data.get("scalar_last")),
                    passive=bool(data.get("passive")),
                )
                model = make()
                if angles and "(" not in text:
                    with place.at("angles").noting():  # what is wrong now, is wrong with them
                        model = make(names=angles)
                models.append(model)
                places.append(own)
    for k, message in repeated(models).items():
        places[k].fault(message)
    return models


def _matrix(data: Data, place: Place, name: str) -> list[RotationModel]:
    if "coordinates" not in data:
        place.at("coordinates").mistyped(None, 'a list of names such as ["phi", "theta"]')
    rows = [[e if e is None else str(e) for e in row or [None]] for row in data["matrix"] or []]
    coordinates = _whole(data.get("coordinates"))
    constraints = [text for text in data.get("constraints") or [] if text is not None]
    point = data.get("example") or {}
    example = {key: str(entry) for key, entry in point.items() if entry is not None}
    for key, text in example.items():
        with place.at("example", key).noting():
            parse_expression(text, {})
    texts = [[entry for entry in row if entry is not None] for row in rows]
    if not coordinates or not rows or texts != rows:
        return []
    for i, row in enumerate(texts):
        for j, text in enumerate(row):
            with place.at("matrix", i, j).noting():
                read_part(text, coordinates)
    for k, text in enumerate(constraints):
        with place.at("constraints", k).noting():
            read_part(text, coordinates)
    with place.noting("matrix"):
        return [
            rotation_given(
                texts,
                name=name,
                coordinates=coordinates,
                constraints=constraints,
                passive=bool(data.get("passive")),
                example=example,
            )
        ]
    return []


def _whole(names: Sequence[str | None] | None) -> list[str] | None:
    """The names of a list; None without it, or if one of them is at fault."""
    whole = [name for name in names or () if name is not None]
    return whole if names is not None and len({*whole}) == len(names) else None
