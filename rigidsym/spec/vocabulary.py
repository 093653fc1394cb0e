"""The names that a derivation file may use, collected by the pipeline from the rooms above."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from rigidsym.models.rotation import RotationModel


class NotationChoice(Protocol):
    """The notation of notes and terminal, a dataclass with one field a choice."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def check(self, model: RotationModel) -> None:
        """Raise ModelError for a model whose names could be confused with this notation."""


class RequestedDerivative(Protocol):
    """A derivative of a quantity; its text is "QUANTITY by VECTOR"."""

    @property
    def quantity(self) -> str: ...


@dataclass(frozen=True, kw_only=True, slots=True)
class Vocabulary:
    """What the keys of [output] and [notation] may say."""

    quantities: tuple[str, ...]
    kernels: tuple[str, ...]
    target_options: Mapping[str, Mapping[str, tuple[str | bool, ...]]]  # of [output.TARGET]
    note: tuple[str, ...]
    check_style: Callable[[str], str]  # raises ModelError for a style without a template
    notation: Callable[..., NotationChoice]
    choices: Mapping[str, tuple[str, ...]]  # of [notation], the default first
    derivative: Callable[[str], RequestedDerivative]  # raises KernelError
