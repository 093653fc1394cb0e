"""A derivation as one HTML file: the note, a figure that moves, and the functions behind it.

The file is self-contained: its policy blocks every request, and lets only its own script run.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from rigidsym.formula.reader import sentence
from rigidsym.formula.tree import NOTHING, Numeral, Symbol
from rigidsym.kernels.lowering.lower import MARGIN
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.example import OMEGA_COMPONENTS, initial_values
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.document import Document, Equation, Paragraph, Text
from rigidsym.notes.figure.body_mesh import own_shape
from rigidsym.notes.figure.scene import scene_of
from rigidsym.notes.formats.html import HtmlPrinter, escape, rendered
from rigidsym.notes.prose.rotation_words import sum_of_turns
from rigidsym.notes.prose.singular_words import singular
from rigidsym.notes.prose.words import unit_in_words
from rigidsym.page.controls import Control, groups_of, starts_of
from rigidsym.page.copies import LANGUAGES, copies_of
from rigidsym.page.functions import Functions, functions_of
from rigidsym.page.growing_body import growing
from rigidsym.page.shapes import SHAPES, as_data, on_its_tip
from rigidsym.page.stage import has_turns, label, shown_angles, stage_of
from rigidsym.system import resources

TEMPLATE = "page/page.html.jinja"
# in the order of their imports
MODULES = ("vectors", "scene", "body", "drawing", "state", "flow", "main", "sharing")
MOST_BYTES = 400_000

_FIGURE = "The axes of space and of the body, in the orientation given by the sliders"
_SHOWN = {  # what the figure can show, and whether it does at first
    "angles": ("Angles", True),
    "sum": ("{} as a sum", True),
    "rings": ("Gimbal rings", False),
    "circles": ("Circles", False),
    "frames": ("Intermediate frames", False),
    "trace": ("Trace of the axis", True),
}
_NAMES = {"own": "This body"}
_OF_TURNS = ("sum", "rings", "frames")
_IMPORT = re.compile(r"^import [^;]*;\n", re.MULTILINE)
_SAID = re.compile(r'\bsaid\("([^"]+)"\)')  # in a module, words that the page shows
_EXPORT = re.compile(r"^export (?=\w)", re.MULTILINE)


def _first_example(derivation: Derivation) -> Mapping[str, float]:
    """Its values by name; only the constants if the example gives Ω′ in place of rates."""
    if derivation.forces is None or not derivation.forces.examples:
        return {}
    example = derivation.forces.examples[0]
    values = initial_values(derivation.model, example.initial)
    has_rates = set(OMEGA_COMPONENTS).isdisjoint(values)
    return {**example.parameters, **(values if has_rates else {})}


def print_page(
    derivation: Derivation, document: Document, start: Mapping[str, float] = MappingProxyType({})
) -> str:
    """The page of a derivation and its note; the same input gives the same bytes.

    `start` holds initial values by name, of coordinates, rates and constants, in SI units; without
    them the page begins with the first example of the derivation.
    """
    start = start or _first_example(derivation)
    functions = functions_of(derivation)
    starts = starts_of(derivation.body)
    starts |= {symbol: start[symbol.name] for symbol in starts if symbol.name in start}
    copies = copies_of(derivation, document)
    printer = PagePrinter(document, copied=copies)
    groups = groups_of(
        functions.derivation,
        document.letters,
        shown_angles(derivation.model, document.letters),
        {symbol: start for symbol, start in starts.items() if symbol in functions.symbols},
        flows=bool(functions.integrals),
    )
    groups = tuple(group.started(start) for group in groups)
    controls = [control for group in groups for control in group.controls]
    stage = stage_of(derivation.model, document.letters)
    in_degrees = any(control.unit == "°" for control in controls)
    shapes = {name: shape() for name, shape in SHAPES.items()}
    if derivation.forces is not None and derivation.forces.potential != 0:
        shapes["top"] = on_its_tip(shapes["top"])
    own = own_shape(derivation.body)
    shapes |= {"own": own} if own else {}
    body = "own" if own else _body(derivation.model)
    choices = _choices(derivation.model, printer, flows=bool(functions.integrals))
    others = [other | {"title": printer.said(other["title"])} for other in functions.others]
    data = {
        "name": derivation.name,
        "words": {words: printer.said(words) for words in _words()},
        "scene": stage,
        "bodies": {name: as_data(shape) for name, shape in shapes.items()},
        "body": body,
        "growing": growing(derivation.body),
        "others": others,
        "shown": [name for name, _, is_shown in choices if is_shown],
        "controls": [_data(control) for control in controls],
        "parameters": [starts.get(symbol, 0.0) for symbol in functions.constants],
        "inputs": functions.arguments,
        "in_degrees": in_degrees,
        "passive": derivation.model.passive,
        "spoken": printer.named("angular velocity, body components"),
        "turn_words": _turn_words(derivation.model, document, printer),
        "languages": LANGUAGES,
        "decimal": document.language.decimal,
        "copies": copies,
        "poles": list(_poles(derivation, printer)),
    }
    script = _script(functions, data)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return rendered(
        TEMPLATE,
        printer,
        policy=f"'sha256-{digest}'",
        script=script,
        decimal=document.language.decimal,
        groups=[
            {
                "title": escape(printer.said(group.title)),
                "controls": [_shown(control, printer) for control in group.controls],
            }
            for group in groups
        ],
        values=[_value(step, printer, in_degrees=in_degrees) for step in functions.steps],
        others=[(other["key"], escape(other["title"])) for other in others],
        integrals=[printer.span(integral.symbol) for integral in functions.integrals],
        pole=_pole(functions),
        stage=stage,
        bodies=[
            (name, escape(printer.said(_NAMES.get(name, name.capitalize()))), name == body)
            for name in shapes
        ],
        choices=choices,
        has_turns=has_turns(derivation.model),
        count=len(stage["turns"]),
        title_of_figure=escape(printer.named(_FIGURE)),
    )


class PagePrinter(HtmlPrinter):
    """The note of a page, whose equations can be copied."""

    def __init__(self, document: Document, *, copied: Collection[str]) -> None:
        super().__init__(document)
        self.copied = copied

    def tools(self, equation: Equation) -> str:
        """Where the script puts a button for each language, if the equation can be copied."""
        if equation.label not in self.copied:
            return ""
        return f'<p class="copy" data-of="{escape(equation.label)}">{equation.number}</p>'

    def sentence(self, text: Text) -> str:
        """A sentence, in the notation and the language of the document."""
        named = tuple(map(self.notation.named, text))
        return self.block(Paragraph(self.language.text(named)))

    def named(self, english: str) -> str:
        """Words, with the names of the frames, in the language of the document."""
        return self.said(self.notation.words(english))


def _script(functions: Functions, data: object) -> str:
    """The script of the page; nothing in it can end its element."""
    names = ", ".join(functions.arguments)
    parts = [
        "// --- the functions of the derivation: every number of this page comes from them\n",
        functions.source,
        f"\nconst kernels = {{ {names} }};\nconst page = {_json(data)};\n",
        _modules(),
    ]
    return "\n".join(parts).replace("</", "<\\/").replace("<!--", "<\\!--")


@cache
def _modules() -> str:
    """The modules as one script, in which nothing is imported."""
    texts = (resources.text("templates", f"page/{name}.mjs") for name in MODULES)
    return "\n".join(_EXPORT.sub("", _IMPORT.sub("", text)) for text in texts)


@cache
def _words() -> list[str]:
    """What the script shows or says."""
    return _SAID.findall(_modules())


def _json(data: object) -> str:
    return json.dumps(data, ensure_ascii=False, separators=(",", ":"))


def _body(model: RotationModel) -> str:
    """The body shown at first: a top for Euler angles proper about z, else a book."""
    axes = [turn.axis for turn in model.turns]
    if len(axes) == 3 and axes[0] == axes[2] == "z":
        return "top"
    return "aircraft" if axes in (["z", "y", "x"], ["x", "y", "z"]) else "book"


def _choices(
    model: RotationModel, printer: PagePrinter, *, flows: bool
) -> list[tuple[str, str, bool]]:
    """Name, label and initial state of what can be shown in the figure; little of a motion."""
    omega = label(printer.notation.applied(SPACE.omega))
    return [
        (
            name,
            escape(printer.said(text.format(omega))),
            is_shown and not (flows and name != "trace"),
        )
        for name, (text, is_shown) in _SHOWN.items()
        if name not in _OF_TURNS or (has_turns(model) and len(model.turns) > 1)
    ]


def _turn_words(model: RotationModel, document: Document, printer: PagePrinter) -> list[str]:
    """What is seen during each turn, and at the end how Ω is the sum of the turns."""
    if not has_turns(model):
        return ["", ""]
    scene = scene_of(model, document.letters)
    posed = scene.posed(scene.view.angles) if scene else None
    rays = [posed.named(arc.axis) for arc in posed.arcs] if posed else []
    axes = [ray.name if ray else NOTHING for ray in rays]
    if not axes:
        axes = [Symbol("N", index=Numeral(str(k))) for k in range(1, len(model.turns) + 1)]
    angles = [turn["name"] for turn in stage_of(model, document.letters)["turns"]]
    sentences = [
        printer.sentence(
            sentence("Turn {} of {}: by {} about {}", str(k), str(len(axes)), angle, axis)
        )
        for k, (angle, axis) in enumerate(zip(angles, axes, strict=True), start=1)
    ]
    return [*sentences, printer.sentence((sum_of_turns(model, document.letters),))]


def _value(step: Step, printer: PagePrinter, *, in_degrees: bool) -> dict[str, Any]:
    """A table of numbers, as the template places it."""
    quantity = step.quantity
    rows, columns = step.expression.shape
    unit = "°/s" if in_degrees and quantity.unit else unit_in_words(quantity.unit or "")
    return {
        "id": f"{quantity.name}-value",
        "symbol": printer.span(quantity.symbol),
        "about": escape(printer.named(quantity.about)),
        "unit": escape(unit) if quantity.unit else "",
        "rows": range(rows),
        "columns": range(columns),
    }


def _poles(derivation: Derivation, printer: PagePrinter) -> Iterator[dict[str, Any]]:
    """The singular orientations, in radians, and the sentence about each."""
    found = derivation.singularities
    coordinates = derivation.model.coordinates
    points = found.points if found else ()
    for point in points:
        is_shown = all(p.coordinate in coordinates and p.value.is_number for p in point.places)
        if len(points) > 1 and not (point.places and is_shown):
            continue  # the coordinates do not show which of them is near
        places = [
            {
                "place": coordinates.index(place.coordinate),
                "value": float(place.value),
                "period": float(place.period),
            }
            for place in point.places
            if is_shown
        ]
        yield {"places": places, "words": printer.sentence(singular(point, derivation))}


def _pole(functions: Functions) -> str:
    """The symbol of the margin, if there is one."""
    kernel = next((k for k in functions.kernels if k.name == MARGIN), None)
    return "" if kernel is None else escape(kernel.symbol)


def _shown(control: Control, printer: PagePrinter) -> dict[str, str]:
    """A slider as the template places it."""
    unit = control.unit.replace("°/s", "degrees per second").replace("°", "degrees")
    stem, dot, _ = control.name.partition(" dot")
    name = f"{stem} {printer.said('dot')}" if dot else stem
    return {
        "key": control.key,
        "symbol": printer.span(control.symbol),
        "name": escape(f"{name}, {printer.said(f'in {unit}')}" if unit else name),
        "unit": escape(control.unit),
        "low": f"{control.low:g}",
        "high": f"{control.high:g}",
        "step": f"{control.step:g}",
        "start": f"{control.start:g}",
    }


def _data(control: Control) -> dict[str, Any]:
    """A slider as the script knows it."""
    kept = ("kind", "place", "start", "factor", "period", "high", "step")
    return {name: getattr(control, name) for name in kept}
