"""A derivation as one HTML file: the note, a figure that moves, and the functions behind it.

The file is self-contained: its policy blocks every request, and lets only its own script run.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import Any

import sympy as sp

from rigidsym.errors import ModelError
from rigidsym.formula.display import display
from rigidsym.formula.reader import sentence
from rigidsym.formula.tree import NOTHING, Numeral, Symbol
from rigidsym.kernels.lowering.lower import MARGIN
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.kinematics import SPACE
from rigidsym.models.forces import OMEGA_COMPONENTS, initial_values
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document import Document, Equation, Paragraph, Text
from rigidsym.notes.facts.rotation import sum_of_turns
from rigidsym.notes.facts.singular import PointFacts
from rigidsym.notes.figure.body_mesh import Shape, own_shape
from rigidsym.notes.figure.scene import scene_of
from rigidsym.notes.formats.html import HtmlPrinter, escape, rendered
from rigidsym.notes.template import texts_of
from rigidsym.notes.words import unit_in_words
from rigidsym.page.controls import Control, groups_of, starts_of
from rigidsym.page.functions import Functions, functions_of, moments_of
from rigidsym.page.shapes import SHAPES, as_data, on_its_tip
from rigidsym.page.stage import has_turns, label, shown_angles, stage_of
from rigidsym.simulation.problem import Problem, with_motion
from rigidsym.system import resources

TEMPLATE = "page/page.html.jinja"
# in the order of their imports
MODULES = ("vectors", "scene", "body", "drawing", "state", "flow", "main")
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
_NAMES = {"own": "This body", "cuboid": "Cuboid with these moments"}
_SHORTEST, _LONGEST = 30.0, 120.0  # seconds of a motion
_PAPER = 30.0  # ems of a display on paper
_OF_TURNS = ("sum", "rings", "frames")
_IMPORT = re.compile(r"^import [^;]*;\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=\w)", re.MULTILINE)


def print_page(
    derivation: Derivation, document: Document, start: Mapping[str, float] = MappingProxyType({})
) -> str:
    """The page of a derivation and its note; the same input gives the same bytes.

    `start` holds initial values by name, of coordinates, rates or components of Ω′, and constants,
    in SI units; without them the page begins with the first example of the derivation.

    Raises ModelError for a motion that the figure cannot show.
    """
    check_shown(derivation)
    examples = derivation.forces.examples if derivation.forces else ()
    seconds = examples[0].time if examples else 0.0
    if examples and not start:
        start = {**examples[0].parameters, **examples[0].initial}
    functions = functions_of(derivation)
    starts = starts_of(derivation.body)
    starts |= {symbol: start[symbol.name] for symbol in starts if symbol.name in start}
    printer = PagePrinter(document)
    groups = groups_of(
        functions.derivation,
        document.letters,
        shown_angles(derivation.model, document.letters),
        {symbol: start for symbol, start in starts.items() if symbol in functions.symbols},
        second=functions.second,
        flows=functions.is_motion,
    )
    moving = _moving(derivation, functions, start, starts)
    groups = tuple(group.started({**start, **moving}) for group in groups)
    controls = [control for group in groups for control in group.controls]
    stage = stage_of(derivation.model, document.letters)
    in_degrees = any(control.unit == "°" for control in controls)
    shapes, body = _bodies(derivation, functions)
    choices = _choices(derivation.model, printer, flows=functions.is_motion)
    data = {
        "name": derivation.name,
        "scene": stage,
        "bodies": {name: as_data(shape) for name, shape in shapes.items() if shape},
        "body": body,
        "moments": [float(m) for m in moments_of(derivation.body) if m.is_number],
        "last": min(max(_SHORTEST, seconds), _LONGEST),
        "shown": [name for name, _, is_shown in choices if is_shown],
        "controls": [_data(control) for control in controls],
        "parameters": [starts.get(symbol, 0.0) for symbol in functions.constants],
        "inputs": functions.arguments,
        "second": functions.second,
        "in_degrees": in_degrees,
        "passive": derivation.model.passive,
        "spoken": "angular velocity, body components",
        "turn_words": _turn_words(derivation.model, document, printer),
        "copies": dict(_latex(document)),
        "poles": list(_poles(derivation, printer)),
    }
    script = _script(functions, data)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return rendered(
        TEMPLATE,
        printer,
        policy=f"'sha256-{digest}'",
        script=script,
        last=f"{data['last']:g}",
        groups=[
            {
                "title": escape(group.title),
                "controls": [_shown(control, printer) for control in group.controls],
            }
            for group in groups
        ],
        values=[_value(step, printer, in_degrees=in_degrees) for step in functions.steps],
        integrals=[
            (printer.span(integral.symbol), escape(_unit_of(integral.name)))
            for integral in functions.integrals
        ],
        pole=next((escape(k.symbol) for k in functions.kernels if k.name == MARGIN), ""),
        stage=stage,
        bodies=[
            (name, escape(_NAMES.get(name, name.capitalize())), name == body) for name in shapes
        ],
        choices=choices,
        has_turns=has_turns(derivation.model),
        count=len(stage["turns"]),
        title_of_figure=_FIGURE,
    )


def _moving(
    derivation: Derivation,
    functions: Functions,
    start: Mapping[str, float],
    constants: Mapping[sp.Symbol, float],
) -> Mapping[str, float]:
    """The initial state by name, with the rates or Ω′ that the page integrates, if it is given."""
    q, rates = (derivation.argument(name).names for name in ("q", "q_dot"))
    names = {*q, *rates, *OMEGA_COMPONENTS}
    state = {name: value for name, value in start.items() if name in names}
    if not state:
        return {}
    values = initial_values(derivation.model, state)
    wanted = OMEGA_COMPONENTS if functions.second == "omega_body" else rates
    if not functions.is_motion or values.keys() >= {*wanted}:
        return values
    known = {argument.name: argument.names for argument in derivation.arguments}
    parameters = {s.name: x for s, x in constants.items() if s.name in known.get("parameters", ())}
    begun = Problem(with_motion(derivation), state, parameters).start
    return dict(zip((*q, *wanted), begun.tolist(), strict=True))


def check_shown(derivation: Derivation) -> None:
    """Raises ModelError for a motion that the figure, one body about a fixed point, cannot show."""
    forces, why = derivation.forces, ""
    if forces is not None and forces.parts:
        why = "its figure is one body about a fixed point, and other parts move with this body"
    if why:
        raise ModelError(
            f"{derivation.name}: there is no live page of this motion, since {why}; expected a "
            "note (`rigidsym run`) or a picture of the motion (`rigidsym simulate --plot`)"
        )


def _bodies(derivation: Derivation, functions: Functions) -> tuple[dict[str, Shape], str]:
    """The shapes to choose from, and the first to be shown; of a motion, its own body only.

    A body with given moments is drawn as a cuboid with these moments, which the script makes. The
    top on its tip has its weight on an axis of symmetry, and ψ, the angle about it, is cyclic.
    """
    own = own_shape(derivation.body)
    if own:
        return {"own": own}, "own"
    if not functions.is_motion:
        return {name: shape() for name, shape in SHAPES.items()}, _body(derivation.model)
    moments, forces = moments_of(derivation.body), derivation.forces
    conserved = {integral.name for integral in derivation.first_integrals}
    last = derivation.model.coordinates[-1].func.__name__
    has_weight = forces is not None and forces.potential != 0
    is_top = has_weight and f"momentum_{last}" in conserved and moments[:1] == moments[1:2]
    if is_top and _body(derivation.model) == "top":
        return {"top": on_its_tip(SHAPES["top"]())}, "top"
    return ({"cuboid": ()}, "cuboid") if moments else ({}, "none")


def _unit_of(integral: str) -> str:
    """The unit of a first integral; none of a claimed one."""
    if integral == "energy":
        return "J"
    if integral == "angular_momentum_squared":
        return unit_in_words("kg^2 m^4/s^2")
    return unit_in_words("kg m^2/s") if "momentum_" in integral else ""


def _latex(document: Document) -> Iterator[tuple[str, str]]:
    """The numbered equations as LaTeX, by label."""
    for equation in document.equations:
        plain = replace(equation, is_result=False)  # who copies it has boxes of their own
        yield equation.label, f"\\[\n{display(plain, document.letters, _PAPER).text}\n\\]\n"


class PagePrinter(HtmlPrinter):
    """The note of a page, whose equations can be copied."""

    def tools(self, equation: Equation) -> str:
        """Where the script puts the button that copies the equation as LaTeX."""
        return f'<p class="copy" data-of="{escape(equation.label)}">{equation.number}</p>'

    def sentence(self, text: Text) -> str:
        """A sentence, in the notation of the document."""
        return self.block(Paragraph(text))


def _script(functions: Functions, data: object) -> str:
    """The script of the page; nothing in it can end its element."""
    names = ", ".join(functions.arguments)
    literal = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    parts = [
        "// --- the functions of the derivation: every number of this page comes from them\n",
        functions.source,
        f"\nconst kernels = {{ {names} }};\nconst page = {literal};\n",
        _modules(),
    ]
    return "\n".join(parts).replace("</", "<\\/").replace("<!--", "<\\!--")


@cache
def _modules() -> str:
    """The modules as one script, in which nothing is imported."""
    texts = (resources.text("templates", f"page/{name}.mjs") for name in MODULES)
    return "\n".join(_EXPORT.sub("", _IMPORT.sub("", text)) for text in texts)


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
            escape(text.format(omega)),
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
    unit = "°/s" if in_degrees and quantity.unit == "rad/s" else unit_in_words(quantity.unit or "")
    return {
        "id": f"{quantity.name}-value",
        "symbol": printer.span(quantity.symbol),
        "about": escape(quantity.about),
        "unit": escape(unit) if quantity.unit else "",
        "rows": range(rows),
        "columns": range(columns),
    }


def _poles(derivation: Derivation, printer: PagePrinter) -> Iterator[dict[str, Any]]:
    """The singular orientations, in radians, and the sentence about each."""
    singularities = derivation.singularities
    coordinates = derivation.model.coordinates
    points = singularities.points if singularities else ()
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
        facts = PointFacts(point, coordinates)
        (words,) = texts_of("en/singular_point", printer.document.letters, point=facts)
        yield {"places": places, "words": printer.sentence(words)}


def _shown(control: Control, printer: PagePrinter) -> dict[str, str]:
    """A slider as the template places it."""
    unit = control.unit.replace("°/s", "degrees per second").replace("°", "degrees")
    name = control.name
    return {
        "key": control.key,
        "symbol": printer.span(control.symbol),
        "name": escape(f"{name}, in {unit}" if unit else name),
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
