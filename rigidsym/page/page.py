"""A derivation as one HTML file: the note, a figure that moves, and the functions behind it.

Everything stands in the file: no request can leave it, and its script runs by the hash of its text.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

from rigidsym import resources
from rigidsym.kernels.lower import MARGIN
from rigidsym.mechanics.derivation import Derivation, Markup, Step
from rigidsym.notes.document import Document, Equation, Table
from rigidsym.notes.html import escape, rendered
from rigidsym.notes.mathml import mathml
from rigidsym.notes.singular_words import singular
from rigidsym.notes.words import unit_in_words
from rigidsym.page.controls import Control, groups_of
from rigidsym.page.copies import LANGUAGES, LATEX, Copies, copies_of
from rigidsym.page.functions import SHOWN, functions_of
from rigidsym.page.printer import PagePrinter
from rigidsym.page.stage import shown_angles, stage_of

TEMPLATE = "page.html.jinja"
SCRIPT = "page.mjs.jinja"
MOST_BYTES = 150_000

_PLAIN = re.compile(r' alttext="[^"]*"')
_LEFT_OUT = 120  # bytes that say so


@dataclass(frozen=True, kw_only=True, slots=True)
class Part:
    """What a page can do without: a display, a table, or the code of an equation."""

    block: Equation | Table
    is_code: bool
    size: int  # bytes that go with it

    @property
    def weight(self) -> int:
        """What it costs, as far as its use goes: a display is worth three times as many bytes."""
        return self.size if isinstance(self.block, Equation) and not self.is_code else 3 * self.size

    @property
    def is_live(self) -> bool:
        return isinstance(self.block, Equation) and self.block.label in SHOWN


def print_page(derivation: Derivation, document: Document) -> str:
    """The page of a derivation, whose note is given; the same input gives the same bytes.

    It has at most MOST_BYTES. Where all would be longer, formulas come without their plain text,
    which browsers that know no MathML would read; then the largest parts are left to the note and
    the module, code and tables before displays, and those of what is shown live last.
    """
    page = _Page(derivation, document)
    whole = page.text()
    if len(whole.encode()) <= MOST_BYTES:
        return whole
    over = len(_terse(whole).encode()) - MOST_BYTES
    parts = sorted(page.parts(), key=lambda part: (part.is_live, -part.weight))
    saved = accumulate((part.size for part in parts), initial=0)
    left_out = [part for part, before in zip(parts, saved, strict=False) if before < over]
    return _terse(page.text(left_out))


def _terse(html: str) -> str:
    return _PLAIN.sub("", html)


class _Page:
    """One page, which can be printed with more or fewer equations."""

    def __init__(self, derivation: Derivation, document: Document) -> None:
        self.derivation = derivation
        self.document = document.without_sheets  # a page has no room to say it twice
        self.functions = functions_of(derivation.model)
        self.groups = groups_of(
            self.functions.derivation, self.document.notation, shown_angles(derivation.model)
        )
        self.copies = copies_of(derivation, document)

    def parts(self) -> Iterator[Part]:
        """All that can be left out, in the order of the note."""
        printer = PagePrinter(self.document, copied=self.copies.texts)
        for block in (block for section in self.document.sections for block in section.blocks):
            if not isinstance(block, Equation | Table):
                continue
            whole = printer.forms(block) if isinstance(block, Equation) else printer.table(block)
            shown = _terse(whole)
            yield Part(block=block, is_code=False, size=len(shown.encode()) - _LEFT_OUT)
            text = self.copies.texts.get(block.label) if isinstance(block, Equation) else None
            if text is not None:
                size = len(_json(text).encode()) - len(_json({LATEX: text[LATEX]}).encode())
                yield Part(block=block, is_code=True, size=size)

    def text(self, left_out: Collection[Part] = ()) -> str:
        blocks = [part.block for part in left_out if not part.is_code]
        codes = [p.block.label for p in left_out if p.is_code and isinstance(p.block, Equation)]
        copies = self.copies.without_code(codes)
        printer = PagePrinter(self.document, copied=copies.texts, left_out=blocks)
        script = self._script(copies)
        return rendered(
            TEMPLATE,
            printer,
            policy=f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'",
            script=script,
            groups=[
                {"title": group.title, "controls": [*map(_shown, group.controls)]}
                for group in self.groups
            ],
            values=[self._value(step) for step in self.functions.steps],
            pole=self._pole(),
            poles=[*self._messages(printer)],
            stage=self._stage(),
        )

    def _script(self, copies: Copies) -> str:
        """The script of the page; nothing in it can end its element."""
        data = {
            "stage": self._stage(),
            "controls": [_data(c) for group in self.groups for c in group.controls],
            "inputs": self.functions.arguments,
            "poles": [*self._poles()],
            "copies": copies.texts,
            "shared": copies.shared,
            "languages": LANGUAGES,
        }
        written = _json(data)
        text = (
            resources.environment()
            .get_template(SCRIPT)
            .render(
                kernels=self.functions.source,
                names=", ".join(self.functions.arguments),
                data=written,
            )
        )
        return text.replace("</", "<\\/").replace("<!--", "<\\!--")

    def _stage(self) -> dict[str, Any]:
        model = self.derivation.model
        shown = dict(stage_of(model, self.document.notation))
        spoken = "angular velocity in the body"
        return {**shown, "passive": model.passive, "spoken": spoken}

    def _value(self, step: Step) -> dict[str, Any]:
        """A table of numbers, as the template places it."""
        quantity, manner = step.quantity, self.document.notation.manner
        rows, columns = step.expression.shape
        return {
            "id": f"{quantity.name}-value",
            "symbol": _formula(manner.symbol(quantity.symbol)),
            "about": escape(manner.text(quantity.about)),
            "unit": escape(unit_in_words(quantity.unit)) if quantity.unit else "",
            "rows": range(rows),
            "columns": range(columns),
        }

    def _poles(self) -> Iterator[dict[str, Any]]:
        """The places of the coordinates at which the rates fail, in radians."""
        found = self.derivation.singularities
        coordinates = self.derivation.model.coordinates
        for k, point in enumerate(found.points if found else ()):
            is_shown = all(p.coordinate in coordinates and p.value.is_number for p in point.places)
            if point.places and is_shown:
                places = [
                    {
                        "place": coordinates.index(place.coordinate),
                        "value": float(place.value),
                        "period": float(place.period),
                    }
                    for place in point.places
                ]
                yield {"id": f"pole-{k}", "places": places}

    def _messages(self, printer: PagePrinter) -> Iterator[dict[str, str]]:
        found = self.derivation.singularities
        for k, point in enumerate(found.points if found else ()):
            yield {"id": f"pole-{k}", "words": printer.words(singular(point, self.derivation))}

    def _pole(self) -> str:
        """How the margin is called, where there is one."""
        kernel = next((k for k in self.functions.kernels if k.name == MARGIN), None)
        return "" if kernel is None else escape(kernel.symbol)


def _json(data: object) -> str:
    return json.dumps(data, ensure_ascii=False, separators=(",", ":"))


def _shown(control: Control) -> dict[str, str]:
    """A slider as the template places it."""
    unit = {"°": "degrees"}.get(control.unit, control.unit.replace("/s", " per second"))
    return {
        "key": control.key,
        "symbol": _formula(control.symbol),
        "name": escape(f"{control.name}{', in ' if unit else ''}{unit}"),
        "unit": escape(control.unit),
        "low": f"{control.low:g}",
        "high": f"{control.high:g}",
        "step": f"{control.step:g}",
        "start": f"{control.start:g}",
    }


def _data(control: Control) -> dict[str, Any]:
    """A slider as the script knows it."""
    kept = ("kind", "place", "start", "factor", "period", "high")
    return {name: getattr(control, name) for name in kept}


def _formula(symbol: Markup) -> str:
    return mathml(symbol.latex, symbol.text)
