"""The language of a note: a catalogue of sentences, read from one file of templates/notes.

A note is composed in English. Its texts are then looked up, whole, by sentences or by clauses, as
they stand in the note with {} for every formula, code or reference. A list such as "φ, θ and ψ" is
one {}. The translation holds the same {}, or {1}, {2}, ... where their order changes. Of the holes
with a name, {name} takes one word as it is, {number} an integer, {angle} a sum, {text} any words,
and every other one words that are looked up themselves.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain
from typing import TypeVar

from rigidsym.errors import ModelError
from rigidsym.system import resources

_Span = TypeVar("_Span")
_FIRST = 0xE000  # a span stands in its text as a letter of the private use area, from this one on
_SPAN = "[\ue000-\uf8ff]"
_LIST = rf"{_SPAN}(?:, {_SPAN})*(?:,? (?:and|or) {_SPAN})?"
_JOINT = re.compile(",? (?:and|or) |, ")
_PARTS = re.compile(f"(?s){_LIST}|{_JOINT.pattern}|.")
_HOLE = re.compile(r"\{(\w*)\}")
# holes whose words stay as they are, and what they take
_AS_IT_IS = {
    "name": r"\S+",
    "number": r"\d+",
    "angle": r"\S+(?: [-+−] \S+)*",
    "text": rf"(?:(?!{_SPAN}).)+",
}
_ENDS = (".?!", ".:;?!")  # of a sentence; of a clause
_POINT = re.compile(r"(?<=\d)\.(?=\d)")  # of a number
_CITED = re.compile(rf"\u00a0({_SPAN})([.,:;]?)$")
_WITHOUT_WORDS = re.compile(
    r"(?:[^A-Za-z]|(?<![A-Za-z])(?:rad|kg|[msNJxyz]|[XYZ]{3})(?![A-Za-z]))*"
)


@dataclass(frozen=True, eq=False)
class Catalogue:
    """A language and its sentences by the English ones; English has none."""

    code: str  # as in HTML: "de"
    babel: str  # as in LaTeX; empty where nothing has to be loaded
    sentences: Mapping[str, str]
    decimal: str = "."
    lacked: set[str] | None = None  # collects the sentences that the catalogue lacks

    def words(self, text: str) -> str:
        """A text without formulas; as it is where the catalogue lacks it."""
        return "".join(self._parts(_without_letters(text))) if self.sentences else text

    def text(self, text: Sequence[str | _Span]) -> tuple[str | _Span, ...]:
        """A text with its spans; sentences that the catalogue lacks stay in English."""
        if not self.sentences:
            return tuple(text)
        letters, spans = _lettered(text)
        parts = re.split(f"({_SPAN})", "".join(self._parts(letters)))
        found = (
            spans[ord(p) - _FIRST] if k % 2 else _POINT.sub(self.decimal, p)
            for k, p in enumerate(parts)
        )
        return tuple(span for span in found if span != "")

    def _parts(self, text: str, ends: Sequence[str] = _ENDS) -> Iterator[str]:
        """The text, or else its sentences, or else its clauses, each translated if it can be."""
        found = self._found(text)
        if found is None and ends:
            for part in re.split(f"((?<=[{ends[0]}]) +)", text):
                yield from self._parts(part, ends[1:])
            return
        if found is None and self.lacked is not None:
            self.lacked.add(re.sub(_LIST, "{}", text))
        yield text if found is None else found

    def _found(self, text: str) -> str | None:
        """The translation; None where the catalogue has none."""
        bare = text.strip(" ")
        if bare != text:
            found = self._found(bare)
            return None if found is None else text.replace(bare, found)
        if _WITHOUT_WORDS.fullmatch(re.sub(_LIST, "", text)):
            return re.sub(_LIST, self._joined, text)
        cited = _CITED.search(text)
        found = self._looked_up(text)
        if found is None and cited:
            found = self._looked_up(text[: cited.start()] + cited[2])
            if found is not None:
                end = len(found.rstrip(".,:;"))
                return f"{found[:end]}\u00a0{cited[1]}{found[end:]}"
        return found

    def _looked_up(self, text: str) -> str | None:
        exact = self.sentences.get(re.sub(_LIST, "{}", text))
        if exact is not None:
            return self._filled(exact, re.findall(_LIST, text), {})
        listed = self._list(text)
        if listed is not None:
            return listed
        for pattern, sentence in self._patterns:
            match = pattern.fullmatch(text)
            named = self._translated(match) if match else None
            if match and named is not None:
                places = set(range(1, 1 + pattern.groups)) - set(pattern.groupindex.values())
                return self._filled(sentence, [match[k] for k in sorted(places)], named)
        return None

    def _translated(self, match: re.Match[str]) -> dict[str, str] | None:
        found = {}
        for name, part in match.groupdict().items():
            words = part if name.startswith(tuple(_AS_IT_IS)) else self._found(part)
            if words is None:
                return None
            found[name] = words
        return found

    def _list(self, text: str) -> str | None:
        """A list of words, each of which has a translation."""
        items, joints = [""], []
        for part in _PARTS.findall(text):
            if _JOINT.fullmatch(part):
                joints.append(self._joint(part))
                items.append("")
            else:
                items[-1] += part
        found = [self._found(item) for item in items] if joints else [None]
        if None in found:
            return None
        return "".join(map(str, chain.from_iterable(zip(found, [*joints, ""], strict=True))))

    def _joint(self, joint: str) -> str:
        return self.sentences.get(joint, joint)

    def _joined(self, formulas: re.Match[str]) -> str:
        return _JOINT.sub(lambda joint: self._joint(joint[0]), formulas[0])

    def _filled(self, sentence: str, lists: Sequence[str], named: Mapping[str, str]) -> str:
        lists = [re.sub(_LIST, self._joined, found) for found in lists]
        places = iter(range(len(lists)))

        def given(hole: re.Match[str]) -> str:
            if hole[1] in named:
                return named[hole[1]]
            return lists[int(hole[1]) - 1 if hole[1] else next(places)]

        return _HOLE.sub(given, sentence)

    @cached_property
    def _patterns(self) -> Sequence[tuple[re.Pattern[str], str]]:
        """The sentences with named holes, those with the most words first."""
        named = [text for text in self.sentences if any(_HOLE.findall(text))]
        named.sort(key=lambda text: -len(_HOLE.sub("", text)))
        return [(_pattern(text), self.sentences[text]) for text in named]


def _pattern(text: str) -> re.Pattern[str]:
    parts = _HOLE.split(text)
    written = (_hole(part) if k % 2 else re.escape(part) for k, part in enumerate(parts))
    return re.compile("".join(written), re.DOTALL)


def _hole(name: str) -> str:
    if not name:
        return f"({_LIST})"
    kind = next((kind for start, kind in _AS_IT_IS.items() if name.startswith(start)), ".+?")
    return f"(?P<{name}>{kind})"


def _lettered(text: Sequence[str | _Span]) -> tuple[str, list[_Span]]:
    """The text with a letter for each span that is not words, and those spans."""
    spans = [span for span in text if not isinstance(span, str)]
    letters = map(chr, range(_FIRST, _FIRST + len(spans)))
    words = (_without_letters(s) if isinstance(s, str) else next(letters) for s in text)
    return "".join(words), spans


def _without_letters(text: str) -> str:
    """No text has a letter of the private use area, which no font has, either."""
    return re.sub(_SPAN, " ", text)


ENGLISH = Catalogue(code="en", babel="", sentences={})


@cache
def language_of(code: str) -> Catalogue:
    """A language by its code. Raises ModelError for one that has no catalogue."""
    if code == ENGLISH.code:
        return ENGLISH
    if code not in (known := resources.languages()):
        raise ModelError(f"language is {' or '.join(known)}, and not {code!r}")
    data = tomllib.loads(resources.text(resources.NOTES, f"{code}.toml"))
    return Catalogue(
        code=code,
        babel=data["babel"],
        sentences=data["sentences"],
        decimal=data.get("decimal", ENGLISH.decimal),
    )
