"""The pieces of text that one function of an ES module is made of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rigidsym.kernels.targets.text.python_layout import filled

WIDTH = 88

Paragraph = str | Sequence[str]


@dataclass(frozen=True, kw_only=True, slots=True)
class Vector:
    """An argument: as it is called, as it is called in messages, and its size."""

    name: str
    given: str
    components: tuple[str, ...]
    about: str  # what its comment says
    entries: str = ""  # the flat array that it is made of, where that is another
    default: str = ""

    @property
    def size(self) -> int:
        return len(self.components)

    @property
    def parameter(self) -> str:
        return f"{self.name} = {self.default}" if self.default else self.name


@dataclass(frozen=True, kw_only=True, slots=True)
class JavaScriptFunction:
    """One kernel or conversion, in the pieces that the template places."""

    name: str
    about: str  # lines of its comment
    vectors: tuple[Vector, ...]
    places: tuple[str, ...]  # where each vector begins
    body: str
    returned: str  # the result of one orientation from `values`
    count: int  # of entries

    @property
    def parameters(self) -> str:
        return ", ".join(vector.parameter for vector in self.vectors)

    @property
    def given(self) -> str:
        """The parameters of the arithmetic: q, q_at, q_dot, q_dot_at."""
        pairs = zip(self.vectors, self.places, strict=True)
        return ", ".join(f"{vector.name}, {place}" for vector, place in pairs)

    @property
    def taken(self) -> str:
        """What the arithmetic is given for one orientation."""
        return ", ".join(
            f'_taken("{v.given}", {v.entries or v.name}, {v.size}), 0' for v in self.vectors
        )

    @property
    def checked(self) -> str:
        """What is said of the arguments for many orientations."""
        return ", ".join(f'["{v.given}", {v.name}, {v.size}]' for v in self.vectors)

    @property
    def stepped(self) -> str:
        """What the arithmetic is given for one orientation of many."""
        return ", ".join(f"{v.name}, i * steps[{k}]" for k, v in enumerate(self.vectors))


def taken_from(vector: Vector, place: str) -> Iterator[tuple[str, str]]:
    """name, and the line that takes it from its vector."""
    for k, name in enumerate(vector.components):
        yield name, f"  const {name} = {vector.name}[{placed(place, k)}];"


def placed(place: str, count: int) -> str:
    return f"{place} + {count}" if count else place


def comment(paragraphs: Sequence[Paragraph]) -> str:
    """The lines of a JSDoc comment; no text can end it."""
    margin = " * "
    blocks = (filled(paragraph, WIDTH - len(margin)) for paragraph in paragraphs)
    text = "\n\n".join("\n".join(block) for block in blocks).replace("*/", "*\u200b/")
    return "\n".join(f"{margin}{line}".rstrip() for line in text.split("\n"))
