"""A derivation as one HTML file: the note, a figure that moves, and the functions behind it.

The file is self-contained: its policy blocks every request, and lets only its own script run.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from math import pi
from types import MappingProxyType
from typing import Any

import sympy as sp

from rigidsym.errors import ModelError
from rigidsym.kernels.lowering.lower import MARGIN
from rigidsym.kernels.targets import javascript
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.models.forces import OMEGA_COMPONENTS, initial_values
from rigidsym.notes.document import Document
from rigidsym.notes.facts.rotation import sum_of_turns
from rigidsym.notes.formats.html import escape, printer_of, rendered
from rigidsym.notes.words import unit_in_words
from rigidsym.page.controls import constants_of, controls_of
from rigidsym.page.functions import Functions, functions_of, has_turns
from rigidsym.page.stage import body_of, shown_angles, stage_of
from rigidsym.system import resources

TEMPLATE = "page/page.html.jinja"
SCRIPTS = ("figure", "motion", "main")  # each uses those before it

_SHORTEST, _LONGEST = 30.0, 120.0  # seconds of a motion
_DEGREE = pi / 180
# of first integrals that are no momenta
_UNITS = {"energy": "J", "angular_momentum_squared": "kg² m⁴/s²"}
_OF_SCRIPT = ("kind", "place", "start", "factor", "period", "high", "step")


def print_page(
    derivation: Derivation, document: Document, start: Mapping[str, float] = MappingProxyType({})
) -> str:
    """The page of a derivation and its note; the same input gives the same bytes.

    `start` holds initial values by name, of coordinates, rates or components of Ω′, and constants,
    in SI units; without them the page begins with the first example of the derivation.

    Raises ModelError for a motion that the figure cannot show.
    """
    check_shown(derivation)
    model, letters = derivation.model, document.letters
    examples = derivation.forces.examples if derivation.forces else ()
    if examples and not start:
        start = {**examples[0].parameters, **examples[0].initial}
    functions = functions_of(derivation)
    constants = constants_of(derivation.body)
    constants |= {s: start[s.name] for s in constants if s.name in start}
    steps = functions.derivation.steps
    sliding = {symbol for step in steps for symbol in step.expression.free_symbols}
    if derivation.body:
        from rigidsym.notes.figure.body_mesh import lengths_in  # with NumPy

        sliding -= lengths_in(derivation.body)  # the body is drawn with the lengths that it has
    controls = [
        *controls_of(
            functions.derivation,
            letters,
            functions.second,
            shown_angles(model, letters),
            {**start, **_moving(derivation, functions, start, constants)},
            {symbol: value for symbol, value in constants.items() if symbol in sliding},
        )
    ]
    in_degrees = any(control["unit"] == "°" for control in controls)
    printer = printer_of(document)
    values = [_value(step, in_degrees=in_degrees) for step in functions.live]
    factors = {value["quantity"].name: value["factor"] for value in values}
    factors |= {"first_integrals": 1} if functions.integrals else {}
    data: dict[str, Any] = {
        "scene": stage_of(model, letters),
        **body_of(derivation, functions),
        "last": min(max(_SHORTEST, examples[0].time if examples else 0.0), _LONGEST),
        "controls": [{key: control[key] for key in _OF_SCRIPT} for control in controls],
        "parameters": [constants.get(symbol, 0.0) for symbol in functions.constants],
        "inputs": {k.name: [a.name for a in k.arguments] for k in functions.kernels},
        "second": functions.second,
        "values": factors,
        "passive": model.passive,
    }
    literal = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    parts = [
        "// --- the functions of the derivation: every number of this page comes from them\n",
        javascript.bare(functions.kernels),
        f"\nconst kernels = {{ {', '.join(data['inputs'])} }};\nconst page = {literal};\n",
        *(resources.text("templates", f"page/{name}.js") for name in SCRIPTS),
    ]
    # Nothing in the script can end its element. In a string of JavaScript `<\/` is `</`; HTML would
    # end the script at `</script`, and read `<!--` as the start of a comment.
    script = "\n".join(parts).replace("</", "<\\/").replace("<!--", "<\\!--")
    # The policy of the page names the digest of its only script, and blocks any other.
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return rendered(
        TEMPLATE,
        printer,
        policy=f"'sha256-{digest}'",
        script=script,
        page=data,
        controls=controls,
        values=values,
        integrals=[
            (i.symbol, _UNITS.get(i.name, "kg m²/s" if "momentum_" in i.name else ""))
            for i in functions.integrals
        ],
        pole=next((k.symbol for k in functions.kernels if k.name == MARGIN), ""),
        is_motion=functions.is_motion,
        has_turns=has_turns(model),
        sum_of_turns=sum_of_turns(model, letters) if has_turns(model) else None,
        formula=printer.span,
        escape=escape,
        number="{:g}".format,
    )


def _moving(
    derivation: Derivation,
    functions: Functions,
    start: Mapping[str, float],
    constants: Mapping[sp.Symbol, float],
) -> Mapping[str, float]:
    """The initial state by name, with the rates or Ω′ that the page integrates, if it is given."""
    arguments = {argument.name: argument.names for argument in derivation.arguments}
    q, rates = arguments["q"], arguments["q_dot"]
    state = {k: v for k, v in start.items() if k in {*q, *rates, *OMEGA_COMPONENTS}}
    if not state:
        return {}
    values = initial_values(derivation.model, state)
    wanted = OMEGA_COMPONENTS if functions.second == "omega_body" else rates
    if not functions.is_motion or values.keys() >= {*wanted}:
        return values
    names = arguments.get("parameters", ())
    parameters = {s.name: value for s, value in constants.items() if s.name in names}
    from rigidsym.simulation.problem import Problem, with_motion

    begun = Problem(with_motion(derivation), state, parameters).start
    return dict(zip((*q, *wanted), begun.tolist(), strict=True))


def check_shown(derivation: Derivation) -> None:
    """Raises ModelError for a motion that the figure, one body about a fixed point, cannot show."""
    if derivation.forces is not None and derivation.forces.parts:
        raise ModelError(
            f"{derivation.name}: there is no live page of this motion, since its figure is one "
            "body about a fixed point, and other parts move with this body; expected a note "
            "(`rigidsym run`) or a table of the motion (`rigidsym simulate --out`)"
        )


def _value(step: Step, *, in_degrees: bool) -> dict[str, Any]:
    """A table of numbers, as the template places it."""
    quantity = step.quantity
    is_turned = in_degrees and quantity.unit == "rad/s"
    unit = "°/s" if is_turned else unit_in_words(quantity.unit) if quantity.unit else ""
    return {
        "quantity": quantity,
        "unit": unit,
        "shape": step.expression.shape,
        "is_scalar": quantity.shape == "scalar",
        "factor": _DEGREE if is_turned else 1,
    }
