"""A derivation file (TOML) or the record of a derivation, read into a DerivationSpec.

First every value is checked by itself, by the schema; then what is right is read, table by table.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigidsym.errors import Fault, SpecError, offer
from rigidsym.kernels.lowering.derivatives import read_request, read_requests
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities import check_quantity
from rigidsym.mechanics.quantities.mass import BODY_ALONE, OF_BODY_ALONE
from rigidsym.models.forces import check_fixed_point, forces_on
from rigidsym.models.library import rotation_from, rotation_given
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import Notation
from rigidsym.spec.body_table import Body, read_body
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.spec.faults import Place
from rigidsym.spec.schema import checked, schema_of
from rigidsym.system import resources
from rigidsym.system.files import read_bytes

Data = Mapping[str, Any]
_MOST_BYTES = 100_000
_LONGEST_LINE = 1000  # tomllib's time grows with the square of the dots in a key


def read_file(file: str) -> DerivationSpec:
    """Read a derivation file, given by its path or by the name of a shipped one.

    Raises SpecError with all its faults.
    """
    shipped = resources.names("derivations", ".toml")
    path = Path(file)
    if file in shipped and not path.is_file():
        path = resources.folder("derivations") / f"{file}.toml"
    try:
        text = read_bytes(path, _MOST_BYTES + 1).decode("utf-8")
    except FileNotFoundError:
        near = offer(file, shipped, listed=True)
        fault = Fault(f"no such file, and no shipped derivation of this name; {near}")
    except OSError as error:
        fault = Fault(f"cannot be read: {error.strerror}")
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        fault = Fault(f"not UTF-8 text, at line {line}")
    else:
        return read_spec(text, source=file, name=path.stem, folder=path.parent)
    raise SpecError(file, [fault])


def read_spec(text: str, *, source: str, name: str, folder: Path | None = None) -> DerivationSpec:
    """The specification in the text of a derivation file.

    `source` is the file in messages; `name` names a single derivation; paths in the text start
    from `folder`. Raises SpecError with all faults.
    """
    place = Place({})
    data = checked(_toml(text, source), schema_of("file"), place)
    if "rotation" not in data and "body" not in data:
        place.at("rotation").fault('missing; expected [rotation] with sequence = "ZXZ" or another')
    models: list[RotationModel] = []
    if place.at("rotation").is_clean:
        rotation = data.get("rotation", {"sequence": "ZXZ"})  # the angles of the lecture
        models = [*_rotations(rotation, place.at("rotation"), name)]
        if isinstance(rotation.get("sequence"), list) and len(models) == 1:
            name = models[0].name
    data |= data.pop("output", None) or {}
    return _spec(data, place, source, name, models, folder or Path())


def read_record(data: object, *, source: str = "request") -> DerivationSpec:
    """The specification that `DerivationSpec.to_data` wrote. Raises SpecError with all faults."""
    if not isinstance(data, Mapping):
        raise SpecError(source, [Fault("expected an object")])
    place = Place({})
    read = checked(data, schema_of("record"), place)
    models = [
        model
        for k, rotation in enumerate(read["rotations"] or [])
        if place.at("rotations", k).is_clean
        for model in _rotations(rotation, place.at("rotations", k), read["name"] or "")
    ]
    return _spec(read, place, source, read["name"] or "", models, None)


def _toml(text: str, source: str) -> dict[str, Any]:
    """The data of a whole file; raises SpecError for a text that is not TOML, or too long."""
    text = text.removeprefix("\ufeff")  # some editors put this mark before everything else
    longest = max(map(len, text.split("\n")))
    if len(text) >= _MOST_BYTES:
        fault = Fault(f"no derivation file is so long; expected less than {_MOST_BYTES} bytes")
    elif longest > _LONGEST_LINE:
        fault = Fault(f"a line has {longest} characters; expected at most {_LONGEST_LINE}")
    else:
        try:
            return tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            fault = Fault(f"not TOML: {error}")
        except RecursionError:
            fault = Fault("lists or tables nested too deeply to be read")
    raise SpecError(source, [fault])


def _spec(
    data: Data,
    place: Place,
    source: str,
    name: str,
    models: Sequence[RotationModel],
    folder: Path | None,
) -> DerivationSpec:
    """All but the rotations, and all faults raised together."""
    if data.get("theory") and any(model.passive for model in models):
        place.at("theory").fault("the theory is written for active rotations; remove passive")
    body, dynamics = data.get("body"), data.get("dynamics")
    if body and place.at("body").is_clean and place.at("parameters").is_clean:
        body = read_body(body, data.get("parameters", {}), place, name, folder)
    if dynamics is not None and place.at("dynamics").is_clean:
        dynamics = {"potential": "0"} | dynamics
        for model in models:
            for key, value in dynamics.items():
                with place.at("dynamics", key).noting():
                    forces_on(model, **{key: value})
        if isinstance(body, Body):
            with place.at("dynamics", "fixed_point").noting():
                check_fixed_point(body, dynamics.get("fixed_point"))
    for key in ("parameters", "dynamics"):
        if data.get(key) and "body" not in data:
            place.at(key).fault("expected [body] as well")
    place.raise_faults(source)
    derivatives, selected = data.get("derivatives", ()), data.get("quantities", ())
    table = place if folder is None else place.at("output")
    for k, entry in enumerate(selected):
        with table.at("quantities", k).noting():
            check_quantity(entry, body=body, forces=dynamics is not None)
    of_body = OF_BODY_ALONE if BODY_ALONE in selected else ()
    for k, text in enumerate(derivatives if selected else ()):
        if (entry := read_request(text).quantity) not in {*selected, *of_body}:
            table.at("derivatives", k).fault(f"{entry} is not among the quantities; add it there")
    place.raise_faults(source)
    keys = ("title", "theory", "style", "conversions", "certificates")
    chosen: dict[str, Any] = {key: data[key] for key in keys if key in data}
    chosen |= {key: tuple(data[key]) for key in ("quantities", "kernels", "note") if key in data}
    if "notation" in data:
        chosen["notation"] = Notation(**data["notation"])
    return DerivationSpec(
        name=name,
        models=tuple(models),
        source=source,
        body=body,
        dynamics=dynamics,
        derivatives=tuple(map(str, read_requests(derivatives))),
        target_options={key: data[key] for key in TARGETS if data.get(key)},
        **chosen,
    )


def _rotations(data: Data, place: Place, name: str) -> Iterator[RotationModel]:
    """The models of a table: one per sequence, or one of its matrix, called `name`."""
    if "matrix" in data:
        if "coordinates" not in data:
            place.at("coordinates").mistyped(None, 'a list of names such as ["phi", "theta"]')
            return
        with place.noting("matrix"):
            yield rotation_given(
                [list(map(str, row)) for row in data["matrix"]],
                name=name,
                coordinates=data["coordinates"],
                constraints=data.get("constraints", ()),
                passive=bool(data.get("passive")),
                example={key: str(entry) for key, entry in data.get("example", {}).items()},
            )
        return
    sequence, own = data["sequence"], place.at("sequence")
    is_list = isinstance(sequence, list)
    options = {key: data[key] for key in ("constants", "scalar_last", "passive") if key in data}
    for k, text in enumerate(sequence if is_list else [sequence]):
        with (own.at(k) if is_list else own).noting():
            yield rotation_from(text, names=data.get("angles"), **options)
