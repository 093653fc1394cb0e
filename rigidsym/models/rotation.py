"""What may turn: coordinates q and the rotation R(q) they stand for, as data."""

from __future__ import annotations

import re
from dataclasses import dataclass

import sympy as sp
from sympy.printing.pretty.pretty_symbology import pretty_symbol

from rigidsym.errors import ModelError
from rigidsym.models.so3 import TIME

_MODULE_NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True, kw_only=True, slots=True)
class Citation:
    """Where a formula comes from."""

    text: str  # author, title, section
    equation: str = ""  # its number there, where it has one

    def __str__(self) -> str:
        return f"{self.text}, eq. {self.equation}" if self.equation else self.text


LECTURE = "Lecture notes on rigid body motion"


def lecture(equation: str = "", section: str = "") -> Citation:
    """A place in the ground text of this project."""
    return Citation(text=f"{LECTURE}, {section}" if section else LECTURE, equation=equation)


@dataclass(frozen=True, kw_only=True, slots=True)
class Turn:
    """One turn of a product of turns: right-handed, by `angle` about the coordinate `axis`."""

    axis: str  # x, y or z
    angle: sp.Expr  # radians

    def __str__(self) -> str:
        return f"R{self.axis}({pretty_symbol(self.angle.func.__name__)})"


@dataclass(frozen=True, kw_only=True, slots=True)
class RotationModel:
    """Coordinates q(t) and the rotation R(q) they stand for.

    R takes body components to space components: x = R x' (lecture, eq. 15). With `passive` the
    derivation presents the transpose, the direction cosine matrix; R itself stays what it is.
    """

    name: str  # names files and the generated module: lower case, digits, underscores
    title: str  # "Euler angles ZXZ, intrinsic"
    convention: tuple[str, ...]  # the convention in words, a sentence an entry
    coordinates: tuple[sp.Expr, ...]  # functions of time
    matrix: sp.ImmutableMatrix  # R, (3, 3)
    source: Citation
    turns: tuple[Turn, ...] = ()  # where R is a product of turns: left to right as multiplied
    constraints: tuple[sp.Expr, ...] = ()  # each vanishes for all time
    units: tuple[str, ...] = ()  # of the coordinates; radians where nothing is said
    passive: bool = False

    def __post_init__(self) -> None:
        if not _MODULE_NAME.fullmatch(self.name):
            raise ModelError(
                f"{self.name!r} cannot name a model: expected lower-case letters, digits and "
                "underscores, a letter first"
            )
        if self.matrix.shape != (3, 3):
            raise ModelError(f"{self.name}: a rotation matrix is 3x3, got {self.matrix.shape}")
        if not self.coordinates:
            raise ModelError(f"{self.name}: a model needs at least one coordinate")
        self._check_coordinates()

    def _check_coordinates(self) -> None:
        for place, coordinate in enumerate(self.coordinates):
            if coordinate in self.coordinates[:place]:
                raise ModelError(f"{self.name}: the coordinate {coordinate} is named twice")
            if not coordinate.is_Function or coordinate.args != (TIME,):
                raise ModelError(
                    f"{self.name}: the coordinate {coordinate} is not a function of t; "
                    "make it with sympy.physics.vector.dynamicsymbols"
                )
        if self.units and len(self.units) != len(self.coordinates):
            raise ModelError(
                f"{self.name}: {len(self.coordinates)} coordinates, but {len(self.units)} units"
            )

    @property
    def presentation(self) -> str:
        """A sentence: whether the matrix that is shown takes body or space components."""
        if self.passive:
            return (
                "Passive: the matrix shown is A = Rᵀ, the direction cosine matrix; "
                "x′ = A x takes space components to body components."
            )
        return "Active: x = R x′ takes body components to space components."

    @property
    def product(self) -> str:
        """R as a product of turns in plain text, "Rz(φ) Rx(θ) Rz(ψ)"; empty where it is none."""
        return " ".join(str(turn) for turn in self.turns)

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        return self.units or ("rad",) * len(self.coordinates)

    def __str__(self) -> str:
        return self.name
