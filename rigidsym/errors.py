"""Every exception a user may see. Each says what was wrong, where, and what was expected.

Each class has its exit code of the command line: 1 if a derivation or a check failed, 2 for wrong
usage, 3 for a file with wrong content, 4 if an outside tool is missing, 124 if the time is up.
"""

from __future__ import annotations

import copyreg
from collections.abc import Iterable, Sequence
from typing import ClassVar, NamedTuple

_LONGEST = 40  # letters of a name that a message looks for
_FEW, _MANY = 10, 20  # known names that a message lists
_SHOWN = 3  # of more than that
_SPELLINGS = {  # letters of quantities, and what their names begin with
    "omega": "angular_velocity",
    "alpha": "angular_acceleration",
    "R": "rotation_matrix",
    "W": "rate_matrix",
    "L": "angular_momentum",
    "dcm": "rotation_matrix",
}


def printable(text: str) -> str:
    """The text with control characters escaped, so that it cannot command a terminal."""
    return "".join(
        c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text
    )


def nearest(name: str, known: Sequence[str]) -> list[str]:
    """The known names, two at most, that an unknown one may be meant for."""
    from difflib import get_close_matches  # few commands end with a message

    spelled = "_".join(_SPELLINGS.get(word, word) for word in name.split("_"))
    if spelled != name and [other for other in known if other.startswith(spelled)]:
        name = spelled
    near = get_close_matches(name, known, n=2) if len(name) <= _LONGEST else []
    return near or [other for other in known if name and other.startswith(name)][:2]


def offer(name: str, known: Iterable[str], *, listed: bool = False) -> str:
    """The end of a message about an unknown name: the nearest known ones, or a few of them.

    Of names that `rigidsym list` has as well, fewer are shown.
    """
    known = list(known)
    if near := nearest(name, known):
        return f"did you mean {' or '.join(near)}?"
    if len(known) <= (_FEW if listed else _MANY):
        return f"known: {', '.join(known)}" if known else "no names are known here"
    hint = " (`rigidsym list`)" if listed else ""
    return f"known: {', '.join(known[:_SHOWN])} and {len(known) - _SHOWN} more{hint}"


class RigidsymError(Exception):
    """Base of all errors that rigidsym raises on purpose."""

    exit_code: ClassVar[int] = 1

    def __init_subclass__(cls, *, exit_code: int = 0) -> None:
        cls.exit_code = exit_code or cls.exit_code

    def __str__(self) -> str:
        return printable(super().__str__())

    def __reduce__(self) -> tuple[object, ...]:
        """As it is, from one process to another: subclasses take arguments of their own."""
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


class LimitReached(RigidsymError, exit_code=124):
    """Work that was stopped because it took more time than allowed."""


class AlgebraError(RigidsymError):
    """An expression that exact algebra cannot represent, or a derivative of too high an order."""


class ModelError(RigidsymError, exit_code=2):
    """An invalid rotation model: unknown sequence, repeated coordinate, wrong shape."""


class NotARotation(RigidsymError):
    """A 3x3 matrix with R Rᵀ ≠ 1 or det R ≠ 1; the message shows the residual."""


class BodyError(RigidsymError, exit_code=3):
    """An impossible body: a mass that is not positive, an unphysical inertia tensor, an open mesh.

    `place` leads to the fault within the body, in the keys of a derivation file: ("parts", 2).
    """

    def __init__(self, message: str, *, place: tuple[str | int, ...] = ()) -> None:
        super().__init__(message)
        self.place = place


class DerivationError(RigidsymError):
    """A false claim of a derivation; the message shows the residual."""


class Defect(RigidsymError):
    """A proved claim that is false at a point: a mistake in rigidsym, not in its use."""


class QuantityError(RigidsymError, AttributeError, exit_code=2):
    """An unknown quantity, or one that the derivation does not contain."""


class ExpressionError(RigidsymError, exit_code=2):
    """A text that is not a valid expression in the declared names; `column` counts from 1."""

    def __init__(self, message: str, *, column: int = 1) -> None:
        super().__init__(message)
        self.message = message
        self.column = column


class Fault(NamedTuple):
    """One thing wrong in a derivation file."""

    message: str  # what was found and what was expected
    path: str = ""  # "rotation.angles[1]", in the file's own keys; "" for the file as a whole

    def __str__(self) -> str:
        return f"{self.path}: {self.message}" if self.path else self.message


class SpecError(RigidsymError, exit_code=3):
    """A bad derivation file: all its faults at once."""

    def __init__(self, source: str, faults: Sequence[Fault]) -> None:
        self.source = source
        self.faults = tuple(sorted(faults, key=lambda fault: fault.path))
        lines = "\n".join(f"  {fault}" for fault in self.faults)
        count = "1 fault" if len(self.faults) == 1 else f"{len(self.faults)} faults"
        super().__init__(f"{source}: {count}, nothing written\n{lines}")


class MissingTool(RigidsymError, exit_code=4):
    """A program outside Python that is not installed; the message names the Debian packages."""


class MissingExtra(RigidsymError, exit_code=4):
    """A Python package that an extra brings; the message says how to install it."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(
            f"{what} needs an extra that is missing: pip install '.[{extra}]' in the clone"
        )


class TemplateFault(RigidsymError, exit_code=3):
    """A template that cannot be filled; the message names the template, the line and the fault."""


class ToolFailed(RigidsymError):
    """A program outside Python that failed; the message contains the end of its log."""


class DataError(RigidsymError, exit_code=3):
    """A file of numbers with missing or wrong content; the message says where."""


class RequestError(DataError, exit_code=2):
    """A request that cannot be satisfied, whatever the file contains."""


class KernelError(RigidsymError, exit_code=2):
    """A kernel that cannot be made: unknown target, or a function that no target can print."""


class EditedFiles(RigidsymError):
    """Generated files that were edited and that a command would overwrite."""


class CheckError(RigidsymError, exit_code=2):
    """A path without the record of a derivation that `rigidsym check` needs."""
