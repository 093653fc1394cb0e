"""A derivation file (TOML), checked: which rotations to derive, and what to print of them."""

from __future__ import annotations

import errno
import keyword
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigidsym.errors import Fault, KernelError, ModelError, SpecError
from rigidsym.kernels.lowering.derivatives import read_request
from rigidsym.kernels.targets import TARGETS
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import QUANTITY_NAMES
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.euler_angles import EulerAngles
from rigidsym.models.rotation import RotationModel
from rigidsym.models.rotation_text import request_of, rotation_from
from rigidsym.notes.formula.manner import CHOICES, DEFAULT, Manner
from rigidsym.spec.rotation_table import KEYS, read_rotation, repeated
from rigidsym.spec.tables import MOST_CHARACTERS, Faults, Table, read_toml, shortened
from rigidsym.system import resources
from rigidsym.text.names import offer

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody

NOTE_FORMATS = ("tex", "html", "md", "ipynb", "page", "pdf")

QUANTITIES = (*QUANTITY_NAMES, *INERTIA_QUANTITIES, *ENERGY_QUANTITIES)
_OUTPUT = {"quantities": QUANTITIES, "kernels": tuple(TARGETS), "note": NOTE_FORMATS}
_MORE_OUTPUT = ("conversions", "derivatives")
_FILE = ("title", "theory", "rotation", "parameters", "body", "notation", "output")
_HINTS = {
    **dict.fromkeys((*CHOICES, "frames"), "it belongs in [notation]"),
    "potential": f"not read yet (known: {', '.join(_FILE)})",
    **dict.fromkeys(_FILE, "it belongs at the top of the file, outside the tables"),
    **dict.fromkeys(KEYS, "it belongs in [rotation]"),
    **dict.fromkeys((*_OUTPUT, *_MORE_OUTPUT), "it belongs in [output]"),
}

A_PAIR_OF_FRAMES = 'two names such as ["inertial", "spacecraft"]'
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
    body: RigidBody | None = None  # what turns, where the file says
    theory: bool = False  # whether what holds for every body and rotation goes before it
    quantities: tuple[str, ...] = ()  # empty: all
    kernels: tuple[str, ...] = ("numpy",)
    note: tuple[str, ...] = ("tex", "html")
    conversions: bool = False  # whether to and from quaternion and matrix, too
    derivatives: tuple[str, ...] = ()  # "angular_velocity_body by q"
    manner: Manner = DEFAULT  # the notation of notes and terminal

    def __post_init__(self) -> None:
        faults = Faults(self.name)
        data = {key: list(getattr(self, key)) for key in ("kernels", "note")}
        for key in ("quantities", "derivatives"):
            if getattr(self, key):
                data[key] = list(getattr(self, key))
        table = Table(data | {"title": self.title}, (), faults)
        _read_title(table)
        _read_output(table)
        if not self.models:
            faults.add(("models",), "expected at least one rotation")
        for message in repeated(self.models).values():
            faults.add(("models",), message)
        for place, model in enumerate(self.models):
            _check_notation(self.manner, model, faults, place)
            for message in _names_of_both(model, self.body):
                faults.add(("models", place), message)
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

        Raises ModelError for a rotation that was made in Python, which no text asks for.
        """
        return {
            "name": self.name,
            "title": self.title,
            "rotations": [dict(request_of(model)) for model in self.models],
            "quantities": list(self.quantities) or None,
            "kernels": list(self.kernels),
            "note": list(self.note),
            **(dict(self.body.request) if self.body else {}),
            **({"theory": True} if self.theory else {}),
            **({"conversions": True} if self.conversions else {}),
            **({"derivatives": list(self.derivatives)} if self.derivatives else {}),
            **({"notation": asdict(self.manner)} if self.manner != DEFAULT else {}),
        }

    @classmethod
    def from_data(cls, data: object, *, source: str = "request") -> DerivationSpec:
        """The specification that `to_data` wrote. Raises SpecError with all faults in it."""
        if not isinstance(data, Mapping):
            raise SpecError(source, [Fault(line=0, path="", message="expected an object")])
        faults = Faults(source)
        table = Table(data, (), faults)
        own = ("name", "title", "theory", "rotations", "parameters", "body", "notation")
        former = ("measured",)  # in old records: errors that were printed with the kernels
        table.refuse_others((*own, *former, *_OUTPUT, *_MORE_OUTPUT))
        rotations = table.tables("rotations", "a list of objects with sequence and angles")
        name, title, output = table.text("name"), _read_title(table), _read_output(table)
        models = [m for rotation in rotations for m in _read_rotation(rotation, name or "")]
        if table.value("name") is None:
            table.fault("missing; expected the name of the derivation", "name")
        manner, body = _read_notation(table), _read_body(table, name or "", Path())
        output["theory"] = _read_theory(table, models)
        faults.raise_if_any()
        return cls(
            name=name or "", title=title, models=tuple(models), body=body, manner=manner, **output
        )


def spec_for(
    rotation: str,
    *,
    angles: Sequence[str] | None = None,
    constants: Sequence[str] = (),
    scalar_last: bool = False,
    passive: bool = False,
) -> DerivationSpec:
    """The specification of one rotation and all that follows from it, named after it.

    Raises ModelError and ExpressionError as `rotation_from` does.
    """
    model = rotation_from(
        rotation, names=angles, constants=constants, scalar_last=scalar_last, passive=passive
    )
    return DerivationSpec(name=model.name, models=(model,))


def spec_of(source: str) -> DerivationSpec:
    """The specification in a derivation file, by path or shipped name, or else of a rotation."""
    if source in resources.names("derivations", ".toml") or Path(source).suffix == ".toml":
        return read_file(source)
    return spec_for(source)


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
    return read_spec(text, source=file, name=path.stem, folder=path.parent)


def read_spec(text: str, *, source: str, name: str, folder: Path | None = None) -> DerivationSpec:
    """The specification that the text of a derivation file holds.

    `source` is the file in messages, `name` names the derivation where the file has only one;
    paths in it start from `folder`.
    Raises SpecError with all faults in the text.
    """
    table, faults = read_toml(text, source)
    table.refuse_others(_FILE, _HINTS)
    title = _read_title(table)
    rotation, output = table.table("rotation"), table.table("output")
    if table.value("rotation") is None and table.value("body") is None:
        table.fault('missing; expected [rotation] with sequence = "ZXZ" or another', "rotation")
    models = _read_rotation(rotation, name) if rotation else [EulerAngles("ZXZ")]
    body = _read_body(table, name, folder or Path())
    if output:
        output.refuse_others((*_OUTPUT, *_MORE_OUTPUT), _HINTS)
    choices = _read_output(output) if output else {}
    choices["theory"] = _read_theory(table, models)
    manner = _read_notation(table)
    is_list = rotation is not None and isinstance(rotation.value("sequence"), list)
    if not is_list and (message := _fault_of_name(name)):
        table.fault(f"the file's name names the derivation: {message}")
    faults.raise_if_any()
    name = models[0].name if is_list and len(models) == 1 else name
    return DerivationSpec(
        name=name, title=title, models=tuple(models), body=body, manner=manner, **choices
    )


def _read_theory(table: Table, models: Sequence[RotationModel]) -> bool:
    """Whether the theory is asked for, which is that of active rotations."""
    is_wanted = bool(table.flag("theory"))
    if is_wanted and any(model.passive for model in models):
        table.fault("the theory is that of active rotations; leave passive out", "theory")
    return is_wanted


def _read_body(table: Table, name: str, folder: Path) -> RigidBody | None:
    """The body of [body] in the symbols of [parameters], where there is one."""
    body, parameters = table.table("body"), table.table("parameters")
    if body is None:
        if table.value("parameters") is not None:
            table.fault("parameters go with a [body]", "parameters")
        return None
    from rigidsym.spec.body_table import read_body  # which few files need

    return read_body(body, parameters, name, folder)


def _names_of_both(model: RotationModel, body: RigidBody | None) -> Iterator[str]:
    """What is said of names that a rotation and its body both have."""
    moving = {coordinate.func.__name__ for coordinate in model.coordinates}
    for parameter in body.parameters if body else ():
        if parameter.symbol.name in moving or parameter.symbol in model.constants:
            yield f"{parameter.symbol} names a parameter of the body, and is in the rotation too"


def _read_rotation(table: Table, name: str) -> list[RotationModel]:
    table.refuse_others(KEYS, _HINTS)
    return read_rotation(table, name)


def _read_title(table: Table) -> str | None:
    title = table.text("title")
    if title is not None and not title.strip():
        table.fault("an empty text; expected a title, or no such key", "title")
    elif title is not None and not (title.isprintable() and len(title) <= _LONGEST_TITLE):
        table.fault(f"expected one line of at most {_LONGEST_TITLE} printable characters", "title")
    return title


def _read_notation(table: Table) -> Manner:
    """The choices of [notation]; the default where one is missing, or wrong and noted."""
    notation = table.table("notation")
    if notation is None:
        return DEFAULT
    notation.refuse_others((*CHOICES, "frames"))
    chosen: dict[str, Any] = {}
    for key, known in CHOICES.items():
        choice = notation.text(key)
        if choice in known:
            chosen[key] = choice
        elif choice is not None:
            message = f"unknown choice {shortened(choice)}; {offer(choice, known)}"
            notation.fault(message, key)
    frames = notation.texts("frames", A_PAIR_OF_FRAMES)
    if frames and None not in frames:
        try:
            chosen["frames"] = tuple(frames)
            return Manner(**chosen)
        except ModelError as error:
            notation.fault(str(error).removeprefix("notation: "), "frames")
            del chosen["frames"]
    return Manner(**chosen)


def _check_notation(manner: Manner, model: RotationModel, faults: Faults, place: int) -> None:
    try:
        manner.check(model)
    except ModelError as error:
        faults.add(("models", place), str(error))


def _read_output(table: Table) -> dict[str, Any]:
    chosen: dict[str, Any] = {
        key: table.choices(key, known, may_be_empty=key == "kernels")
        for key, known in _OUTPUT.items()
    }
    chosen["conversions"] = table.flag("conversions")
    chosen["derivatives"] = _read_derivatives(table, chosen["quantities"] or QUANTITIES)
    return {key: choice for key, choice in chosen.items() if choice is not None}


def _read_derivatives(table: Table, quantities: Sequence[str]) -> tuple[str, ...] | None:
    """The derivatives that are asked for, of the quantities that are, each in one spelling."""
    texts = table.texts("derivatives", 'a list such as ["angular_velocity_body by q"]')
    found = []
    for place, text in enumerate(texts or ()):
        if text is None:
            continue
        try:
            request = read_request(text)
        except KernelError as error:
            table.fault(str(error), "derivatives", place)
            continue
        if request.quantity not in quantities:
            message = f"no quantity {shortened(request.quantity)}; "
            table.fault(message + offer(request.quantity, quantities), "derivatives", place)
        found.append(str(request))
    return None if texts is None else tuple(dict.fromkeys(found))


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
