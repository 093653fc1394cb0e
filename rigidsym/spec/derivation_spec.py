"""What to derive and what to print of it: checked data, valid once it is constructed."""

from __future__ import annotations

import keyword
import reprlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, field, replace
from typing import TYPE_CHECKING, Any

from rigidsym.models.library import request_of, rotation_from
from rigidsym.models.rotation import RotationModel
from rigidsym.motion import DEFAULT, Notation
from rigidsym.notes.formats import FORMATS
from rigidsym.spec.faults import Place
from rigidsym.system.records import Record
from rigidsym.text.names import A_MODULE_NAME, MODULE_NAME

if TYPE_CHECKING:
    from rigidsym.models.body import BodyDescription, RigidBody

PDF = "pdf"  # typeset from the LaTeX, which is written beside it
PAGE = "page"  # NAME_page.html: the note with an interactive figure
NOTES = (*FORMATS, PAGE, PDF)  # all that `note` may list


class DerivationSpec(Record, kw_only=True):
    """What to derive and what to print.

    With one rotation, `name` names the derivation: its folder, its files and its module. With
    several, each derivation takes the name of its rotation; `singles` separates them. The names of
    quantities, targets and formats are checked by the reader and by whoever uses them.
    """

    name: str
    title: str | None = None  # None: the rotation's own
    models: tuple[RotationModel, ...]
    body: RigidBody | BodyDescription | None = None
    dynamics: Mapping[str, Any] | None = None  # as `forces_on` reads it; None: no motion
    theory: bool = False  # whether the theory for every body and rotation comes first
    quantities: tuple[str, ...] = ()  # empty: all
    kernels: tuple[str, ...] = ("numpy",)
    target_options: Mapping[str, Mapping[str, str | bool]] = field(default_factory=dict)
    note: tuple[str, ...] = ("tex", "html")
    style: str = "lecture"  # of the note
    conversions: bool = False  # to and from quaternion and matrix
    derivatives: tuple[str, ...] = ()  # "kinetic_energy by q"
    certificates: bool = False  # theorems for Coq
    notation: Notation | None = None  # of notes and terminal; None: the default
    source: str = field(default="", compare=False, repr=False)  # the file, in messages

    def __post_init__(self) -> None:
        place = Place({})
        models = place.at("rotation")
        if not self.models:
            models.fault("expected at least one")
        first: dict[str, int] = {}  # names are lower case, so that every system keeps them apart
        own = {parameter.symbol.name for parameter in self.body.parameters} if self.body else set()
        for k, model in enumerate(self.models):
            here = models.at("sequence", k) if self.models[1:] else models
            if (earlier := first.setdefault(model.name, k)) != k:
                here.fault(f"writes the folder {model.name}, as entry {earlier} does")
            used = {coordinate.func.__name__ for coordinate in model.coordinates}
            used |= {symbol.name for symbol in model.constants}
            for name in sorted(used & own):
                here.fault(f"{name} is also the name of a parameter of the body")
            if self.notation is not None:
                with here.noting():
                    self.notation.check(model)
        if len(self.models) == 1:
            _check_name(self.name, place)
        place.raise_faults(self.source or self.name)

    def singles(self) -> tuple[DerivationSpec, ...]:
        """One specification per rotation; a title given to several rotations is dropped."""
        if len(self.models) == 1:
            return (self,)
        return tuple(replace(self, name=m.name, title=None, models=(m,)) for m in self.models)

    def to_data(self) -> dict[str, Any]:
        """The specification as plain data, which `derivation_file.read_record` reads back.

        Raises ModelError for a rotation that was made in Python and cannot be written as text.
        """
        notation = asdict(self.notation or DEFAULT)
        del notation["vector"]  # which is the model's
        optional: dict[str, Any] = {
            "theory": self.theory,
            "dynamics": dict(self.dynamics or {}),
            "style": self.style if self.style != "lecture" else "",
            "conversions": self.conversions,
            "derivatives": list(self.derivatives),
            "certificates": self.certificates,
            "notation": {} if self.notation in (None, DEFAULT) else notation,
        }
        return {
            "name": self.name,
            "title": self.title,
            "rotations": [dict(request_of(model)) for model in self.models],
            "quantities": list(self.quantities) or None,
            "kernels": list(self.kernels),
            **{target: dict(options) for target, options in self.target_options.items()},
            "note": list(self.note),
            **(self.body.request if self.body else {}),
            **{key: value for key, value in optional.items() if value},
        }


def spec_for(
    rotation: str, *, angles: Sequence[str] | None = None, **options: Any
) -> DerivationSpec:
    """The specification of one rotation, named after it, with all its quantities.

    Options are those of `rotation_from`, which raises ModelError and ExpressionError.
    """
    model = rotation_from(rotation, names=angles, **options)
    return DerivationSpec(name=model.name, models=(model,))


def _check_name(name: str, place: Place) -> None:
    """Note why a derivation, its folder and its Python module cannot have a name."""
    if not MODULE_NAME.fullmatch(name):
        got = f"got {reprlib.repr(name)}"
        place.fault(f"a derivation has the name of its file: {A_MODULE_NAME}, {got}")
    elif keyword.iskeyword(name):
        place.fault(f"a derivation has the name of its file: {name} is a reserved word of Python")
    elif name in sys.stdlib_module_names or name in ("numpy", "sympy", "rigidsym"):
        place.fault(f"{name}.py would hide the Python module of this name")
