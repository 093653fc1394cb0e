"""A derivation file (TOML) or the record of a derivation, read into a DerivationSpec."""

from __future__ import annotations

import errno
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rigidsym.errors import Fault, SpecError, offer
from rigidsym.models.forces import forces_on
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.models.rotation import RotationModel
from rigidsym.spec.body_table import read_body
from rigidsym.spec.derivation_spec import DerivationSpec, fault_of_name, fault_of_title
from rigidsym.spec.rotation_table import KEYS, read_rotation
from rigidsym.spec.tables import MOST_CHARACTERS, Faults, Table, read_toml, shortened
from rigidsym.spec.vocabulary import NotationChoice, Vocabulary
from rigidsym.system import resources
from rigidsym.system.files import read_bytes

_OF_BOTH = ("title", "theory", "parameters", "body", "dynamics", "notation")
_FILE = (*_OF_BOTH, "rotation", "output")
_RECORD = (*_OF_BOTH, "name", "rotations")
_DYNAMICS = (
    *("potential", "forces", "torque", "first_integrals", "parts", "frame_rate", "method"),
    "examples",
)
_FORMER = ("measured",)  # in old records: errors that were printed with the kernels
_REMOVED = {
    "language": "another language is a folder of templates of notes, chosen by style",
    "frames": "the frames are called space and body",
    "text": "your own sentences belong in a template of notes; see `rigidsym templates --help`",
}
_OUTPUT = (
    *("quantities", "kernels", "note", "style"),
    *("conversions", "derivatives", "certificates"),
)


def read_file(file: str, words: Vocabulary) -> DerivationSpec:
    """Read a derivation file, given by its path or by the name of a shipped one.

    Raises SpecError with all its faults.
    """
    shipped = resources.names("derivations", ".toml")
    path = Path(file)
    if path.suffix == ".json":
        record = "expected a derivation file, NAME.toml; only `check` reads records (NAME.json)"
        raise SpecError(file, [Fault(message=record)])
    if file in shipped and not path.is_file():
        path = resources.folder("derivations") / f"{file}.toml"
    try:
        text = _read_bytes(path).decode("utf-8")
    except FileNotFoundError:
        missing = f"no such file, and no shipped derivation of this name; {offer(file, shipped)}"
        raise SpecError(file, [Fault(message=missing)]) from None
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise SpecError(file, [Fault(message=f"not UTF-8 text, at line {line}")]) from None
    except OSError as error:
        raise SpecError(file, [Fault(message=f"cannot be read: {error.strerror}")]) from None
    return read_spec(text, words, source=file, name=path.stem, folder=path.parent)


def read_spec(
    text: str, words: Vocabulary, *, source: str, name: str, folder: Path | None = None
) -> DerivationSpec:
    """The specification in the text of a derivation file.

    `source` is the file in messages; `name` names a single derivation; paths in the text start
    from `folder`. Raises SpecError with all faults.
    """
    table, faults = read_toml(text, source)
    reader = _Reader(words)
    table.refuse_others(_FILE, reader.hints)
    rotation, output = table.table("rotation"), table.table("output")
    if table.value("rotation") is None and table.value("body") is None:
        table.fault('missing; expected [rotation] with sequence = "ZXZ" or another', "rotation")
    models = reader.rotation(rotation, name) if rotation else [EulerAngles("ZXZ")]
    is_list = rotation is not None and isinstance(rotation.value("sequence"), list)
    if not is_list and (message := fault_of_name(name)):
        table.fault(f"the file name is the name of the derivation: {message}")
    if output:
        output.refuse_others((*_OUTPUT, *words.target_options), reader.hints)
    name = models[0].name if is_list and len(models) == 1 else name
    return reader.spec(table, output, faults, name=name, models=models, folder=folder or Path())


def from_data(data: object, words: Vocabulary, *, source: str = "request") -> DerivationSpec:
    """The specification that `DerivationSpec.to_data` wrote. Raises SpecError with all faults."""
    if not isinstance(data, Mapping):
        raise SpecError(source, [Fault(message="expected an object")])
    faults = Faults(source)
    faults.refuse_control_characters(data)
    table = Table(data, (), faults)
    reader = _Reader(words)
    table.refuse_others((*_RECORD, *_OUTPUT, *words.target_options, *_FORMER))
    name = table.text("name") or ""
    if table.value("name") is None:
        table.mistyped(None, "the name of the derivation", "name")
    rotations = table.tables("rotations", "a list of objects with sequence and angles")
    models = [model for rotation in rotations for model in reader.rotation(rotation, name)]
    return reader.spec(table, table, faults, name=name, models=models, folder=None)


@dataclass(frozen=True, slots=True)
class _Reader:
    """The tables of a file or a record, with the names that they may use."""

    words: Vocabulary

    @property
    def hints(self) -> dict[str, str]:
        return {
            **_REMOVED,
            **dict.fromkeys(self.words.choices, "it belongs in [notation]"),
            **dict.fromkeys(_DYNAMICS, "it belongs in [dynamics]"),
            **dict.fromkeys(_FILE, "it belongs at the top of the file, outside the tables"),
            **dict.fromkeys(KEYS, "it belongs in [rotation]"),
            **dict.fromkeys(_OUTPUT, "it belongs in [output]"),
            "degrees": "kernels take radians; convert angles with np.radians and np.degrees",
        }

    def spec(
        self,
        table: Table,
        output: Table | None,
        faults: Faults,
        *,
        name: str,
        models: Sequence[RotationModel],
        folder: Path | None,
    ) -> DerivationSpec:
        """All but the rotations, and all faults raised together."""
        title = table.text("title")
        if message := fault_of_title(title):
            table.fault(message, "title")
        theory = bool(table.flag("theory"))
        if theory and any(model.passive for model in models):
            table.fault("the theory is written for active rotations; remove passive", "theory")
        body, parameters = table.table("body"), table.table("parameters")
        if body is None and table.value("parameters") is not None:
            table.fault("parameters belong to a body; expected [body] as well", "parameters")
        choices = {
            "body": body and read_body(body, parameters, name, folder),
            **_read_dynamics(table, models),
            "notation": self.notation(table),
            **(self.output(output) if output else {}),
        }
        faults.raise_if_any()
        return DerivationSpec(
            name=name,
            title=title,
            theory=theory,
            models=tuple(models),
            source=faults.source,
            **choices,
        )

    def rotation(self, table: Table, name: str) -> list[RotationModel]:
        table.refuse_others(KEYS, self.hints)
        return read_rotation(table, name)

    def notation(self, table: Table) -> NotationChoice | None:
        """The choices of [notation]; a wrong one is noted and left out."""
        notation, words = table.table("notation"), self.words
        if notation is None:
            return None
        notation.refuse_others(tuple(words.choices), _REMOVED)
        chosen: dict[str, Any] = {}
        for key, known in words.choices.items():
            choice = notation.text(key)
            if choice in known:
                chosen[key] = choice
            elif choice is not None:
                notation.fault(f"unknown choice {shortened(choice)}; {offer(choice, known)}", key)
        return words.notation(**chosen)

    def output(self, table: Table) -> dict[str, Any]:
        words = self.words
        chosen: dict[str, Any] = {
            "quantities": table.choices("quantities", words.quantities),
            "kernels": table.choices("kernels", words.kernels, may_be_empty=True),
            "note": table.choices("note", words.note, may_be_empty=True),
            "style": self.style(table),
            "conversions": table.flag("conversions"),
            "certificates": table.flag("certificates"),
        }
        chosen["target_options"] = self.target_options(table) or None
        chosen["derivatives"] = self.derivatives(table, chosen["quantities"] or words.quantities)
        return {key: choice for key, choice in chosen.items() if choice is not None}

    def style(self, table: Table) -> str | None:
        """The style of the note, shipped or the user's own."""
        style = table.text("style")
        with table.noting("style"):
            return style and self.words.check_style(style)
        return None

    def target_options(self, table: Table) -> dict[str, dict[str, str | bool]]:
        """What is chosen of the options of targets."""
        found: dict[str, dict[str, str | bool]] = {}
        for target, known in self.words.target_options.items():
            if inner := table.table(target):
                inner.refuse_others(tuple(known))
                texts = {k: [v for v in known[k] if isinstance(v, str)] for k in known}
                read = {k: inner.choice(k, t) if t else inner.flag(k) for k, t in texts.items()}
                found[target] = {key: value for key, value in read.items() if value is not None}
        return found

    def derivatives(self, table: Table, quantities: Sequence[str]) -> tuple[str, ...]:
        """The derivatives of the chosen quantities, each in its one spelling."""
        key = "derivatives"
        found = []
        texts = table.texts(key, 'a list such as ["angular_velocity_body by q"]')
        for place, text in texts.items():
            with table.noting(key, place):
                request = self.words.derivative(text)
                if request.quantity not in quantities:
                    shown = shortened(request.quantity)
                    close = offer(request.quantity, quantities)
                    table.fault(f"no quantity {shown}; {close}", key, place)
                found.append(str(request))
        return tuple(dict.fromkeys(found))


def _read_dynamics(table: Table, models: Sequence[RotationModel]) -> dict[str, Any]:
    """What [dynamics] holds, each key read once with the names of every model."""
    dynamics = table.table("dynamics")
    if dynamics is None:
        return {}
    dynamics.refuse_others(_DYNAMICS)
    if table.value("body") is None:
        table.fault("forces act on a body; expected [body] as well", "dynamics")
    found = dict(_dynamics(dynamics))
    for model in models:
        for key, value in found.items():
            with dynamics.noting(key):
                forces_on(model, **{key: value})
    return {"dynamics": found}


def _dynamics(table: Table) -> Iterator[tuple[str, Any]]:
    """The keys of [dynamics] that are there, with values of the right type."""
    yield "potential", table.text("potential") or "0"
    if method := table.text("method"):
        yield "method", method
    for key in ("forces", "first_integrals"):
        if inner := table.table(key):
            yield key, {name: inner.text(name) or "0" for name in inner.data}
    for key in ("torque", "frame_rate"):
        if components := _expressions(table, key):
            yield key, components
    if table.value("parts") is not None:
        parts = table.tables("parts", "a list of tables: [[dynamics.parts]]")
        yield "parts", [dict(_part(part)) for part in parts]
    if table.value("examples") is not None:
        examples = table.tables("examples", "a list of tables: [[dynamics.examples]]")
        yield "examples", [dict(_example(example)) for example in examples]


def _part(table: Table) -> Iterator[tuple[str, Any]]:
    table.refuse_others(("rotation", "principal_moments", "velocity", "mass"))
    for key in ("rotation", "mass"):
        if text := table.text(key):
            yield key, text
    for key in ("principal_moments", "velocity"):
        if components := _expressions(table, key):
            yield key, components


def _example(table: Table) -> Iterator[tuple[str, Any]]:
    table.refuse_others(("parameters", "initial", "time"))
    for key in ("parameters", "initial"):
        if inner := table.table(key):
            yield key, {name: inner.number(name) or 0 for name in inner.data}
    if (time := table.number("time")) is not None:
        yield "time", time


def _expressions(table: Table, key: str) -> list[str]:
    """A list of texts, of which some may be alike."""
    value = table.value(key)
    if value is None:
        return []
    if isinstance(value, list) and all(isinstance(text, str) for text in value):
        return value
    table.mistyped(value, "a list of three texts in quotes", key)
    return []


def _read_bytes(path: Path) -> bytes:
    """The content of a file; OSError if it is too large for a derivation file."""
    most = 4 * MOST_CHARACTERS  # bytes: no character takes more than four
    content = read_bytes(path, most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most} bytes")
    return content
