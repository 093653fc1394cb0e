"""A derivation as one HTML file: the note, a figure that moves, and the functions behind it.

Everything stands in the file: no request can leave it, and its script runs by the hash of its text.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterator, Sequence
from itertools import accumulate
from typing import Any

from rigidsym.kernels.lowering.lower import MARGIN
from rigidsym.mechanics.derivation import Derivation, Markup, Step
from rigidsym.notes.document.document import Document, Equation, Paragraph
from rigidsym.notes.formats.html import escape, rendered
from rigidsym.notes.formats.mathml import mathml
from rigidsym.notes.layout.text_width import ems
from rigidsym.notes.prose.singular_words import singular
from rigidsym.notes.prose.words import unit_in_words
from rigidsym.page.controls import Control, groups_of
from rigidsym.page.copies import LANGUAGES, copies_of
from rigidsym.page.functions import SHOWN, functions_of
from rigidsym.page.packing import pack
from rigidsym.page.printer import Packable, PagePrinter
from rigidsym.page.stage import shown_angles, stage_of
from rigidsym.system import resources

TEMPLATE = "page.html.jinja"
SCRIPT = "page.mjs.jinja"
MOST_BYTES = 150_000

_FIGURE = "The axes of space and the axes of the body, as the sliders have turned them"
_SAVED = 0.85  # of what is packed
_SHORT = 300  # bytes that are not worth it


def print_page(derivation: Derivation, document: Document) -> str:
    """The page of a derivation, whose note is given; the same input gives the same bytes.

    Nothing of the note is left out. Where all would be longer than MOST_BYTES, parts of it are
    packed, and the script spells them when the page is opened.
    """
    page = _Page(derivation, document)
    packed: list[tuple[Packable, int]] = []
    rest = page.packable()
    while True:
        text = page.text([block for block, _ in packed])
        over = len(text.encode()) - MOST_BYTES
        if over <= 0 or not rest:
            return text
        saved = accumulate((_SAVED * size for _, size in rest), initial=0.0)
        count = sum(before < over for before, _ in zip(saved, rest, strict=False))
        packed, rest = packed + rest[:count], rest[count:]


class _Page:
    """One page, which can be printed with more or fewer displays packed."""

    def __init__(self, derivation: Derivation, document: Document) -> None:
        self.derivation = derivation
        self.document = document
        self.functions = functions_of(derivation.model)
        self.groups = groups_of(
            self.functions.derivation,
            self.document.notation,
            shown_angles(derivation.model, self.document.notation),
        )
        self.copies = copies_of(derivation, document)
        self.printer = PagePrinter(document, copied=self.copies)

    def packable(self) -> list[tuple[Packable, int]]:
        """Parts of the note and their bytes, those first that are missed least without a script.

        First what is said again on a sheet of its own, then displays, those that the page shows
        live after the others, and words last; among equals the larger first.
        """
        ranks: dict[Packable, int] = {}
        for section in self.document.sections:
            for block in section.blocks:
                if isinstance(block, Packable):
                    ranks.setdefault(block, 0 if section.on_own_page else _rank(block))
        sizes = {block: len(self.printer.unpacked(block).encode()) for block in ranks}
        order = sorted(ranks, key=lambda block: (ranks[block], -sizes[block]))
        return [(block, sizes[block]) for block in order if sizes[block] > _SHORT]

    def text(self, packed: Sequence[Packable]) -> str:
        printer = PagePrinter(self.document, copied=self.copies, packed=packed)
        script = self._script([self.printer.unpacked(block) for block in packed])
        return rendered(
            TEMPLATE,
            printer,
            policy=f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'",
            script=script,
            packed=len(packed),
            groups=[
                {"title": group.title, "controls": [*map(_shown, group.controls)]}
                for group in self.groups
            ],
            names=self._names_in_ems(),
            values=[self._value(step) for step in self.functions.steps],
            pole=self._pole(),
            stage=self._stage(),
            title_of_figure=escape(self.document.notation.manner.words(_FIGURE)),
        )

    def _script(self, blocks: Sequence[str]) -> str:
        """The script of the page; nothing in it can end its element."""
        carried = {"copies": self.copies, "poles": [*self._poles()], "blocks": blocks}
        data = {
            "stage": self._stage(),
            "controls": [_data(c) for group in self.groups for c in group.controls],
            "inputs": self.functions.arguments,
            "languages": LANGUAGES,
            "packed": pack(_json(carried)),
        }
        template = resources.environment().get_template(SCRIPT)
        text = template.render(
            kernels=self.functions.source,
            names=", ".join(self.functions.arguments),
            data=_json(data),
        )
        return text.replace("</", "<\\/").replace("<!--", "<\\!--")

    def _names_in_ems(self) -> str:
        """How wide the widest name of a slider is."""
        controls = (control for group in self.groups for control in group.controls)
        return f"{max(2.5, *(1.15 * ems(control.symbol.latex) for control in controls)):.2f}"

    def _stage(self) -> dict[str, Any]:
        model = self.derivation.model
        words = self.document.notation.manner.words
        return {
            **stage_of(model, self.document.notation),
            "passive": model.passive,
            "spoken": words("angular velocity, body components"),
        }

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
        """Where the rates fail, in radians, and what is to be said there."""
        found = self.derivation.singularities
        coordinates = self.derivation.model.coordinates
        points = found.points if found else ()
        for point in points:
            is_shown = all(p.coordinate in coordinates and p.value.is_number for p in point.places)
            if len(points) > 1 and not (point.places and is_shown):
                continue  # which of them is near is not seen by the coordinates
            places = [
                {
                    "place": coordinates.index(place.coordinate),
                    "value": float(place.value),
                    "period": float(place.period),
                }
                for place in point.places
                if is_shown
            ]
            words = self.printer.words(singular(point, self.derivation))
            yield {"places": places, "words": words}

    def _pole(self) -> str:
        """How the margin is called, where there is one."""
        kernel = next((k for k in self.functions.kernels if k.name == MARGIN), None)
        return "" if kernel is None else escape(kernel.symbol)


def _rank(block: Packable) -> int:
    if isinstance(block, Equation):
        return 2 if block.label in SHOWN else 1
    return 3 if isinstance(block, Paragraph) else 1


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
