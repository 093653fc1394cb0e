"""The user's choices of notation, and how formulas are rewritten to follow them.

Formulas are composed in one notation: a dot for a rate, bold vectors, a prime for the body, Ω. The
rewriting is textual, which is safe because the symbols it looks for are all made in this package;
rates, whose names are the user's, come through `Manner.rate` one by one.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

from rigidsym.errors import ModelError
from rigidsym.mechanics.derivation import Markup
from rigidsym.models.rotation import RotationModel

CHOICES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "rates": ("dot", "fraction"),
        "vectors": ("bold", "arrow"),
        "body": ("prime", "superscript"),
        "angular_velocity": ("Omega", "omega"),
    }
)

FRAMES = ("space", "body")

_A_FRAME_NAME = re.compile(r"\w(?:[\w .-]{0,28}\w)?")
# what is the body's own, and not that of its frame
_NOT_A_FRAME = "".join(
    f"(?<!{noun} )"
    for noun in (
        "momentum",
        "energy",
        "tensor",
        "principal axes",
        "point",
        "constant",
        "else",
        "mass",
    )
)
# the name before what it qualifies, or after a preposition, where it becomes "the ... frame"
_FRAME_WORDS = (
    re.compile(
        r"\b(?:(?P<before>of|in|from) space(?! components)|space(?P<after> components| to\b))"
    ),
    re.compile(
        _NOT_A_FRAME + r"\b(?:(?P<before>of|in|from) the body|body(?P<after> components| to\b))"
    ),
)
_BODY = r"^{\mathrm{B}}"
_POWER_OF_BODY = re.compile(
    r"((?:\\[A-Za-z]+\{[^{}]*\}|\\[A-Za-z]+|\w))'\^\{(-?\d+|\+|\\mathsf T)\}"
)
# vectors; bold matrices and columns of coordinates stay so
_BOLD = re.compile(r"\\(?:mathbf\{([uvwxyrpmngscdLe])\}|boldsymbol\{(\\[Oo]mega)\})")
_VECTORS = re.compile(r"([Ωω])(?![₀-₉]|[′ᴮ][₀-₉])")
_DOT = re.compile(
    r"\\(d?dot)"
    r"(\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})"  # braces, up to three deep
    r"((?:'|[_^](?:\{(?:[^{}]|\{[^{}]*\})*\}|\w))*)"  # prime, indices
)
_BY_RATES = re.compile(r"\\partial ?\\frac\{d(\\mathbf\{q\})\}\{dt\}")
_DOT_TEXT = re.compile(r"([^\W\d_])([\u0307\u0308])([′ᴮ]?[₀-₉]*(?:_\w+)?)(?!\w)")


@dataclass(frozen=True, kw_only=True, slots=True)
class Manner:
    """One choice each; the first of `CHOICES` where nothing is said."""

    rates: str = "dot"
    vectors: str = "bold"
    body: str = "prime"
    angular_velocity: str = "Omega"
    frames: tuple[str, str] = FRAMES  # what the frames are called in words

    def __post_init__(self) -> None:
        object.__setattr__(self, "frames", _checked(self.frames))
        for name, known in CHOICES.items():
            chosen = getattr(self, name)
            if chosen not in known:
                raise ModelError(f"notation: {name} is {' or '.join(known)}, and not {chosen!r}")

    def words(self, text: str) -> str:
        """A sentence in which the frames have the user's names; twice is the same as once."""
        if self.frames == FRAMES:
            return text
        for pattern, own in zip(_FRAME_WORDS, self.frames, strict=True):
            text = pattern.sub(partial(_named, own), text)
        return text

    def symbol(self, markup: Markup) -> Markup:
        """A formula of this package in this notation; twice is the same as once."""
        if self == DEFAULT:
            return markup
        return Markup(self._latex(markup.latex), self.text(markup.text))

    def rate(self, markup: Markup) -> Markup:
        """A coordinate, or its rate: only the dot is changed."""
        if self.rates == "dot":
            return markup
        return Markup(_DOT.sub(_fraction, markup.latex), _without_dots(markup.text))

    def text(self, text: str) -> str:
        """Words and formulas in Unicode."""
        text = self.words(text)
        if self.angular_velocity == "omega":
            text = text.replace("Ω", "ω")
        if self.body == "superscript":
            text = re.sub("(\\w)′(⁻¹|⁺)", "(\\1ᴮ)\\2", text).replace("′", "ᴮ")
        if self.rates == "fraction":
            text = re.sub(r"∂(d\w/dt)", r"∂(\1)", _without_dots(text))
        if self.vectors == "arrow":
            text = _VECTORS.sub("\\1\u20d7", text.replace("\u20d7", ""))
        return text

    def check(self, model: RotationModel) -> None:
        """Raises ModelError for a name in a model that looks like the angular velocity."""
        names = {coordinate.func.__name__ for coordinate in model.coordinates}
        names |= {symbol.name for symbol in model.matrix.free_symbols}
        alike = sorted(name for name in names if name.split("_")[0].lower() == "omega")
        if alike and self.angular_velocity == "omega":
            raise ModelError(
                f"notation: the angular velocity cannot be called omega beside {alike[0]}; leave "
                "it Omega"
            )

    def _latex(self, latex: str) -> str:
        if self.angular_velocity == "omega":
            latex = latex.replace(r"\Omega", r"\omega")
        if self.body == "superscript":
            latex = _POWER_OF_BODY.sub(rf"\\bigl(\1{_BODY_PATTERN}\\bigr)^{{\2}}", latex)
            latex = latex.replace("'", _BODY)
        if self.rates == "fraction":
            latex = _BY_RATES.sub(r"\\partial(d\1/dt)", _DOT.sub(_fraction, latex))
        if self.vectors == "arrow":
            latex = _BOLD.sub(lambda m: rf"\vec{{{m[1] or m[2]}}}", latex)
        return latex


def _checked(frames: Sequence[str]) -> tuple[str, str]:
    """Two different names of letters, digits, blanks, points and hyphens."""
    names = [frames] if isinstance(frames, str) else list(frames)
    if len(names) != 2 or names[0] == names[1]:
        raise ModelError(f"notation: frames are two different names, got {', '.join(names)}")
    for name in names:
        if not _A_FRAME_NAME.fullmatch(name):
            raise ModelError(
                f"notation: {name!r} cannot name a frame: expected at most 30 letters, digits, "
                "blanks, points and hyphens"
            )
    return names[0], names[1]


def _named(own: str, found: re.Match[str]) -> str:
    if found["before"]:
        return f"{found['before']} the {own} frame"
    return own + found["after"]


_BODY_PATTERN = _BODY.replace("\\", r"\\")
DEFAULT = Manner()  # that in which formulas are composed


def _fraction(dotted: re.Match[str]) -> str:
    """\\dot{\\phi}_{1} as the quotient of differentials."""
    kind, name, scripts = dotted.groups()
    power = "" if kind == "dot" else "^{2}"
    whole = name[1:-1] + scripts
    return rf"\frac{{d{power}{whole}}}{{dt{power}}}"


def _without_dots(text: str) -> str:
    decomposed = unicodedata.normalize("NFD", text)
    return unicodedata.normalize("NFC", _DOT_TEXT.sub(_quotient, decomposed))


def _quotient(dotted: re.Match[str]) -> str:
    first, dots, rest = dotted.groups()
    power = "" if dots == "\u0307" else "²"
    return f"d{power}{first}{rest}/dt{power}"
