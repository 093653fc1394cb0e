"""A derivation file (TOML), checked: which rotations to derive, and what to print of them."""

from __future__ import annotations

import errno
import keyword
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rigidsym import resources
from rigidsym.errors import ExpressionError, Fault, ModelError, SpecError
from rigidsym.expression import parse_turns
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities import QUANTITY_NAMES
from rigidsym.models.catalogue import DEFAULT_ANGLES, EulerAngles, euler_sequence
from rigidsym.models.rotation import RotationModel
from rigidsym.names import check_name, offer
from rigidsym.tables import MOST_CHARACTERS, Faults, Table, read_toml, shortened
from rigidsym.toml_lines import Path as Place

NOTE_FORMATS = ("tex", "pdf")

_OUTPUT = {"quantities": QUANTITY_NAMES, "kernels": tuple(TARGETS), "note": NOTE_FORMATS}
_FILE = ("title", "rotation", "output")
_ROTATION = ("sequence", "angles", "passive")
_HINTS = {
    **dict.fromkeys(
        ("parameters", "body", "potential"), f"not read yet (known: {', '.join(_FILE)})"
    ),
    **dict.fromkeys(_FILE, "it belongs at the top of the file, outside the tables"),
    **dict.fromkeys(_ROTATION, "it belongs in [rotation]"),
    **dict.fromkeys(_OUTPUT, "it belongs in [output]"),
}
_A_SEQUENCE = 'a sequence such as "ZXZ", or a list of sequences'
_THREE_NAMES = 'a list of three names such as ["phi", "theta", "psi"]'
_LONGEST_SEQUENCE = 200

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_DEVICES = re.compile(r"con|prn|aux|nul|com[1-9]|lpt[1-9]")  # no files on Windows
_LONGEST_TITLE = 200


@dataclass(frozen=True, kw_only=True, slots=True)
class DerivationSpec:
    """What to derive and what to print.

    With one rotation, `name` names the derivation: its folder, its files and its module. With
    several, each derivation takes the name of its rotation; `singles` takes them apart.
    """

    name: str
    title: str | None = None  # None: the rotation's own
    models: tuple[RotationModel, ...]
    quantities: tuple[str, ...] = ()  # empty: all
    kernels: tuple[str, ...] = ("numpy",)
    note: tuple[str, ...] = ("tex",)

    def __post_init__(self) -> None:
        faults = Faults(self.name)
        data = {key: list(getattr(self, key)) for key in ("kernels", "note")}
        if self.quantities:
            data["quantities"] = list(self.quantities)
        table = Table(data | {"title": self.title}, (), faults)
        _read_title(table)
        _read_output(table)
        if not self.models:
            faults.add(("models",), "expected at least one rotation")
        for message in _repeated(self.models).values():
            faults.add(("models",), message)
        if len(self.models) == 1 and (message := _fault_of_name(self.name)):
            faults.add(("name",), message)
        faults.raise_if_any()

    def singles(self) -> tuple[DerivationSpec, ...]:
        """One specification for each rotation. The title of several is not the title of each."""
        if len(self.models) == 1:
            return (self,)
        return tuple(
            replace(self, name=model.name, title=None, models=(model,)) for model in self.models
        )

    def to_data(self) -> dict[str, Any]:
        """All of it as dictionaries, lists, strings and booleans, which `from_data` reads back.

        Raises ModelError for a rotation that is not a sequence of Euler angles.
        """
        return {
            "name": self.name,
            "title": self.title,
            "rotations": [_rotation_data(model) for model in self.models],
            "quantities": list(self.quantities) or None,
            "kernels": list(self.kernels),
            "note": list(self.note),
        }

    @classmethod
    def from_data(cls, data: object, *, source: str = "request") -> DerivationSpec:
        """The specification that `to_data` wrote. Raises SpecError with all faults in it."""
        if not isinstance(data, Mapping):
            raise SpecError(source, [Fault(line=0, path="", message="expected an object")])
        faults = Faults(source)
        table = Table(data, (), faults)
        table.refuse_others(("name", "title", "rotations", *_OUTPUT))
        rotations = table.tables("rotations", "a list of objects with sequence and angles")
        models = [model for rotation in rotations for model in _read_rotation(rotation)]
        name, title, output = table.text("name"), _read_title(table), _read_output(table)
        if table.value("name") is None:
            table.fault("missing; expected the name of the derivation", "name")
        faults.raise_if_any()
        return cls(name=name or "", title=title, models=tuple(models), **output)


def spec_for(
    sequence: str, *, angles: Sequence[str] | None = None, passive: bool = False
) -> DerivationSpec:
    """The specification of one rotation and all that follows from it, named after it.

    Raises ModelError for a wrong sequence or a wrong name of an angle, ExpressionError for turns
    that cannot be read.
    """
    letters, own_angles = _turns(sequence)
    if own_angles and angles is not None:
        raise ModelError(f"{sequence} names its angles itself; leave the other names out")
    names = own_angles or (DEFAULT_ANGLES if angles is None else angles)
    model = EulerAngles(letters, names, passive=passive)
    return DerivationSpec(name=model.name, models=(model,))


def read_file(file: str) -> DerivationSpec:
    """Read a derivation file, given by its path or by the name of a shipped one.

    Raises SpecError with all its faults.
    """
    shipped = resources.names("derivations", ".toml")
    path = Path(file)
    if file in shipped and not path.is_file():
        path = resources.folder("derivations") / f"{file}.toml"
    try:
        text = _read_bytes(path).decode("utf-8")
    except FileNotFoundError:
        missing = f"no such file, and no shipped derivation of this name; {offer(file, shipped)}"
        raise SpecError(file, [Fault(line=0, path="", message=missing)]) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SpecError(file, [_unreadable(error)]) from None
    return read_spec(text, source=file, name=path.stem)


def read_spec(text: str, *, source: str, name: str) -> DerivationSpec:
    """The specification that the text of a derivation file holds.

    `source` is the file in messages, `name` names the derivation where the file has only one.
    Raises SpecError with all faults in the text.
    """
    table, faults = read_toml(text, source)
    table.refuse_others(_FILE, _HINTS)
    title = _read_title(table)
    rotation, output = table.table("rotation"), table.table("output")
    if table.value("rotation") is None:
        table.fault('missing; expected [rotation] with sequence = "ZXZ" or another', "rotation")
    models = _read_rotation(rotation) if rotation else []
    if output:
        output.refuse_others(tuple(_OUTPUT), _HINTS)
    choices = _read_output(output) if output else {}
    is_list = rotation is not None and isinstance(rotation.value("sequence"), list)
    if not is_list and (message := _fault_of_name(name)):
        table.fault(f"the file's name names the derivation: {message}")
    faults.raise_if_any()
    name = models[0].name if is_list and len(models) == 1 else name
    return DerivationSpec(name=name, title=title, models=tuple(models), **choices)


def _read_title(table: Table) -> str | None:
    title = table.text("title")
    if title is not None and not title.strip():
        table.fault("an empty text; expected a title, or no such key", "title")
    elif title is not None and not (title.isprintable() and len(title) <= _LONGEST_TITLE):
        table.fault(f"expected one line of at most {_LONGEST_TITLE} printable characters", "title")
    return title


def _read_output(table: Table) -> dict[str, tuple[str, ...]]:
    chosen = {key: table.choices(key, known) for key, known in _OUTPUT.items()}
    return {key: choice for key, choice in chosen.items() if choice is not None}


def _read_rotation(table: Table) -> list[RotationModel]:
    """The models of a table with sequence, angles and passive."""
    table.refuse_others(_ROTATION, _HINTS)
    passive = bool(table.flag("passive"))
    angles = _read_angles(table)
    names_itself = False
    models: dict[Place, RotationModel] = {}
    for at, text in _read_sequences(table):
        try:
            letters, own_angles = _turns(text)
            names_itself = names_itself or bool(own_angles)
            models[at] = EulerAngles(
                letters, own_angles or angles or DEFAULT_ANGLES, passive=passive
            )
        except (ModelError, ExpressionError) as error:
            table.fault(str(error), *at)
    if names_itself and table.value("angles") is not None:
        table.fault("the sequence names its angles itself; leave this key out", "angles")
    for place, message in _repeated(models.values()).items():
        table.fault(message, *list(models)[place])
    return list(models.values())


def _read_sequences(table: Table) -> list[tuple[Place, str]]:
    """(path, text) of each sequence that is a text."""
    value = table.value("sequence")
    if isinstance(value, list):
        texts = table.texts("sequence", _A_SEQUENCE) or []
        return [(("sequence", k), text) for k, text in enumerate(texts) if text is not None]
    if isinstance(value, str):
        return [(("sequence",), value)]
    if value is None:
        table.fault(f"missing; expected {_A_SEQUENCE}", "sequence")
    else:
        table.mistyped(value, _A_SEQUENCE, "sequence")
    return []


def _read_angles(table: Table) -> list[str] | None:
    """Three different names; None where there are none, or a fault is noted."""
    texts = table.texts("angles", _THREE_NAMES)
    if not texts:
        return None
    names = [_read_angle(table, place, text) for place, text in enumerate(texts)]
    for place, name in enumerate(names):
        if name and name in names[:place]:
            table.fault(f"{name} is named twice", "angles", place)
    if len(names) != len(DEFAULT_ANGLES):
        table.fault(f"expected {_THREE_NAMES}, got {len(names)}", "angles")
    found = [name for name in dict.fromkeys(names) if name]
    return found if len(found) == len(names) == len(DEFAULT_ANGLES) else None


def _read_angle(table: Table, place: int, text: str | None) -> str | None:
    try:
        return check_name(text) if text is not None else None
    except ExpressionError as error:
        table.fault(error.message, "angles", place)
        return None


def _turns(text: str) -> tuple[str, tuple[str, ...]]:
    """The Euler sequence that a text writes, and the angles where it names them.

    Turns `z(phi) x(theta) z(psi)` are multiplied as they are written, left to right, and so they
    are the intrinsic sequence ZXZ.
    """
    if len(text) > _LONGEST_SEQUENCE:
        raise ModelError(f"expected {_A_SEQUENCE}, got {len(text)} characters")
    if "(" not in text:
        return euler_sequence(text), ()
    try:
        turns = parse_turns(text)
    except ExpressionError as error:
        raise ExpressionError(f"column {error.column}: {error.message}") from None
    axes = "".join(axis for axis, _ in turns)
    return euler_sequence(axes.upper()), tuple(angle for _, angle in turns)


def _sequence_of(model: RotationModel) -> str:
    """The Euler sequence of a model, read off its turns: reversed turns are extrinsic."""
    axes = "".join(turn.axis for turn in model.turns)
    angles = tuple(turn.angle for turn in model.turns)
    if angles == model.coordinates:
        return euler_sequence(axes.upper())
    if angles == model.coordinates[::-1]:
        return euler_sequence(axes[::-1])
    raise ModelError(f"{model.name} is not a sequence of Euler angles, and no file can name it")


def _rotation_data(model: RotationModel) -> dict[str, Any]:
    return {
        "sequence": _sequence_of(model),
        "angles": [coordinate.func.__name__ for coordinate in model.coordinates],
        "passive": model.passive,
    }


def _repeated(models: Iterable[RotationModel]) -> dict[int, str]:
    """{place: fault} of the models whose folder an earlier one writes already.

    A model's name has no capitals, so that names which differ are different folders everywhere.
    """
    first: dict[str, int] = {}
    faults: dict[int, str] = {}
    for place, model in enumerate(models):
        earlier = first.setdefault(model.name, place)
        if earlier != place:
            faults[place] = f"writes the folder {model.name}, as entry {earlier} does"
    return faults


def _fault_of_name(name: str) -> str:
    """Why a derivation, its folder and its Python module cannot bear a name; empty if they can."""
    if not _NAME.fullmatch(name):
        return (
            f"expected lower-case letters, digits and underscores, a letter first, "
            f"got {shortened(name)}"
        )
    if keyword.iskeyword(name) or _DEVICES.fullmatch(name):
        return f"{name} is a reserved word, of Python or of Windows"
    if name in sys.stdlib_module_names or name in ("numpy", "sympy", "rigidsym"):
        return f"{name}.py would hide the Python module of this name"
    return ""


def _read_bytes(path: Path) -> bytes:
    """The content of a file that may be anything; OSError where it is no derivation file."""
    most = 4 * MOST_CHARACTERS  # bytes: no character takes more than four
    with path.open("rb") as stream:
        content = stream.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most} bytes")
    return content


def _unreadable(error: OSError | UnicodeDecodeError) -> Fault:
    if isinstance(error, UnicodeDecodeError):
        line = error.object.count(b"\n", 0, error.start) + 1
        return Fault(line=line, path="", message="not UTF-8 text")
    return Fault(line=0, path="", message=f"cannot be read: {error.strerror}")
