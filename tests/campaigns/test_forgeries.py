"""Forged records: whatever is false in one, the checker and Coq refuse it.

Some were accepted by an earlier checker. A forger may write what he likes into a record.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from helpers.certificates import NEEDS, of_motion, printed, record_of, run_coq
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import printed_in, theorems

Content = dict[str, Any]
Change = Callable[[Content], object]
Forgeries = dict[str, dict[str, Change]]  # by the record that is forged, and by name
R, VELOCITY, W = "rotation_matrix", "angular_velocity_space", "rate_matrix_body"
P = "generalised_momenta"
TWICE = "an energy that counts the centre of mass twice"
FREE_TOP = "the centre of mass of a top without its potential"
TORQUE, RATES = "angular_acceleration_from_torque", "rates_from_angular_velocity_space"


def changed(content: Content, change: Change) -> Content:
    content = copy.deepcopy(content)
    change(content)
    return content


# The language of forgers


def at(content: Content, *path: Any) -> Any:
    """The part at a path of keys, places and names; the name of a quantity may begin it."""
    part: Any = content
    for step in path:
        if part is content and step not in content:
            part = printed(content, step)
        elif isinstance(part, list) and isinstance(step, str):
            part = next(each for each in part if each["name"] == step)
        else:
            part = part[step]
    return part


def write(*path: Any) -> Change:
    """Write the last of the path to the place that the others name."""
    *path, last, value = path

    def change(content: Content) -> None:
        at(content, *path)[last] = value

    return change


def put(name: str, *path: Any) -> Change:
    """Write the last of the path to a place in an expression."""
    return write(name, "expression", *path)


def component(group: str, place: int, part: str, value: str) -> Change:
    return write("arguments", group, "components", place, part, value)


def measured(place: int, *units: str) -> Change:
    """Other units of a coordinate, its rate and its acceleration."""
    groups = zip(("q", "q_dot", "q_ddot"), units, strict=True)
    return together(*(component(group, place, "unit", unit) for group, unit in groups))


def together(*changes: Change) -> Change:
    return lambda content: [change(content) for change in changes]


def everywhere(before: str, after: str) -> Change:
    def change(content: Content) -> None:
        for quantity in content["quantities"]:
            text = json.dumps(quantity["expression"]).replace(before, after)
            quantity["expression"] = json.loads(text)

    return change


def once(name: str, before: str, after: str) -> Change:
    """Another text in what is printed of a quantity."""

    def change(content: Content) -> None:
        text = json.dumps(printed(content, name)["expression"])
        assert before in text
        printed(content, name)["expression"] = json.loads(text.replace(before, after, 1))

    return change


def conditions(*texts: str, then: Change) -> Change:
    return together(write("rotation", "conditions", [*texts]), then)


def defined(name: str, text: str) -> Change:
    return lambda content: content["definitions"].append({"name": name, "expression": text})


def turned(*turns: str) -> Change:
    return write("rotation", "turns", [*turns])


def of_velocity(text: str, *definitions: tuple[str, str]) -> Change:
    """Something added to the last component of Ω."""
    return together(*(defined(*each) for each in definitions), put(VELOCITY, 2, f"{TRUE} + {text}"))


def exchanged(*names: str) -> Change:
    def change(content: Content) -> None:
        one, two = (printed(content, name) for name in names)
        one["expression"], two["expression"] = two["expression"], one["expression"]

    return change


def only(*names: str) -> Change:
    """Without the other quantities, and without integrals."""

    def change(content: Content) -> None:
        content["quantities"] = [printed(content, name) for name in names]
        content["first_integrals"] = []

    return change


def added(text: str, *path: Any) -> Change:
    """Something added to a text at a path."""
    *path, last = path

    def change(content: Content) -> None:
        at(content, *path)[last] += text

    return change


def integrals(term: str) -> Change:
    def change(content: Content) -> None:
        for integral in content["first_integrals"]:
            integral["expression"] += term

    return change


def cells(name: str, other: Callable[[Any], Any], shape: Any = None) -> Change:
    """Another expression, with its shape unless that is to be false."""

    def change(content: Content) -> None:
        quantity = printed(content, name)
        quantity["expression"] = other(quantity["expression"])
        first = quantity["expression"][0]
        columns = [len(first)] if isinstance(first, list) else []
        quantity["shape"] = shape or [len(quantity["expression"]), *columns]

    return change


def wider(first: str, rest: str) -> Callable[[Any], Any]:
    """A column more."""
    return lambda rows: [[*rows[0], first], *([*row, rest] for row in rows[1:])]


def grouped(name: str, *components: str) -> Change:
    """Another group of arguments, with the units that they have elsewhere."""
    units = {"psi": "rad", "phi": "rad", "n_x": "", "t": "s", "k": "m", "K": "rad/s", "a": ""}
    listed = [{"name": each, "unit": units[each]} for each in components]
    return lambda c: c["arguments"].append({"name": name, "components": listed})


def with_turns(turn: str, units: dict[str, str], *conditions: str, **definitions: str) -> Change:
    """One turn of coordinates with the units that are said, and R only."""
    components = [{"name": name, "unit": unit} for name, unit in units.items()]
    whole = {"arguments": [{"name": "q", "components": components}]}
    whole |= {"rotation": {"turns": [turn], "conditions": [*conditions]}, "quantities": []}
    whole |= {"definitions": [{"name": n, "expression": e} for n, e in definitions.items()]}
    return lambda content: content.update(whole)


WORDS = "From Coq Require Import Reals Lra. Require Import Rotation."
ZERO = "(sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2))"
FALSE = put(VELOCITY, 2, "phi_dot")  # without ψ̇ cos θ
TRUE = "phi_dot + psi_dot*cos(theta)"
SPHERE = "phi**2 + theta**2 - 1"
IDENTITY = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
ZXZ = ("z(phi)", "x(theta)", "z(psi)")
HALVES = ("constant_turn(0, 0, 1, 2, 0)", "constant_turn(0, 0, 1, 1/2, 0)")
THIN_ROD = together(write("body", "inertia", 2, 2, "0"), write("first_integrals", []))


def with_a_body(*parameters: str) -> Change:
    """A ball, whose parameters have names of something else and are in no group of arguments."""

    def change(content: Content) -> None:
        content["body"] = {"mass": "1", "centre": ["0"] * 3, "inertia": IDENTITY}
        content["body"]["parameters"] = [{"name": name, "unit": ""} for name in parameters]
        content["arguments"] = [g for g in content["arguments"] if g["name"] != "parameters"]

    return change


def with_a_parameter_defined(content: Content) -> None:
    """The potential contains g, but a definition makes g zero."""
    parameters = at(content, "arguments", "parameters")
    parameters["components"] = [c for c in parameters["components"] if c["name"] != "g"]
    content["definitions"] = [{"name": "g", "expression": "0"}]


def constants_read_as(form: str) -> Change:
    """Constant angles, beside coordinates whose names would be read as these."""

    def change(content: Content) -> None:
        constants = at(content, "arguments", "q", "components")
        q = [{"name": form.format(each["name"]), "unit": ""} for each in constants]
        groups = {"q": q, "parameters": constants}
        content["arguments"] = [{"name": n, "components": c} for n, c in groups.items()]
        content["rotation"]["turns"] = [
            f"{axis}({each['name']})" for axis, each in zip("zxz", q, strict=True)
        ]
        content["quantities"] = [at(content, VELOCITY) | {"expression": ["0"] * 3, "inputs": ["q"]}]

    return change


def with_two_units(content: Content) -> None:
    angles = copy.deepcopy(at(content, "arguments", "q"))
    content["arguments"].append(angles | {"name": "again"})
    content["arguments"][0]["components"][0]["unit"] = "deg"


def with_a_moment_too_many(content: Content) -> None:
    inertia = content["body"]["inertia"]
    axes, moments = copy.deepcopy(content["quantities"][:2])
    axes |= {"name": "principal_axes", "unit": "", "expression": [*map(list, IDENTITY)]}
    moments |= {"name": "principal_moments", "unit": "kg m^2", "shape": [4]}
    axes["inputs"] = moments["inputs"] = []
    moments["expression"] = [*(inertia[k][k] for k in range(3)), "17*A"]
    content["quantities"] += [axes, moments]


def with_a_centre(content: Content) -> None:
    centre = {"name": "centre_of_mass", "unit": "m", "inputs": [], "expression": ["0"] * 3}
    content["quantities"].append(at(content, "principal_moments") | centre)


def with_energy_of_the_centre(content: Content) -> None:
    """T = ½ M |ṙ_C|² + ½ Ω' · I' Ω', in which I' is about the fixed point."""
    total, potential = (at(content, name)["expression"] for name in ("energy", "potential_energy"))
    text = f"{total} - ({potential}) + M*(X_dot**2 + Y_dot**2 + Z_dot**2)/2"
    inputs = ["q", "q_dot", "centre_dot", "parameters"]
    energy = {"name": "kinetic_energy", "expression": text, "inputs": inputs}
    content["quantities"].append(at(content, "energy") | energy)


# What a record says beside its entries; Coq gets these too
OF_ZXZ: dict[str, Change] = {
    "an argument that is defined": together(grouped("gains", "K"), of_velocity("K", ("K", "0"))),
    "two units of one name": with_two_units,
    "turns about other angles than the name says": together(
        write("rotation", "turns", 0, "z(0)"),
        *(everywhere("phi_dot", "0"), everywhere("sin(phi)", "0"), everywhere("cos(phi)", "1")),
    ),
    "a constant angle in degrees": together(
        *(write("rotation", "turns", 1, "x(a)"), only(R)),
        *(everywhere("theta", "a"), grouped("parameters", "a")),
        write("arguments", "parameters", "components", "a", "unit", "deg"),
    ),
    "a power that costs minutes": put(VELOCITY, 2, "0*cos(phi)**90000"),
    "a power of degree zero": put(VELOCITY, 2, "0*(phi**0)**900000000000"),
    "a rate with the other sign": everywhere("phi_dot", "(-phi_dot)"),
    "a comment that hides a rate": put(W, 2, 0, "cos(theta) + psi_dot/phi_dot # '"),
    "contradictory conditions": conditions("phi - 1", "phi - 1 - 29682952539239999999", then=FALSE),
    "a condition without a real point": conditions("phi**2 + theta**2 + 1", then=FALSE),
    "a divisor that is zero": put(R, 2, 2, f"cos(theta) + 0/{ZERO}"),
    "R about other axes": turned("z(phi)", "x(theta)", "x(psi)"),
    "R by an angle of the other sense": turned("z(-phi)", "x(theta)", "z(psi)"),
    "half an angle": turned("z(phi/2)", *ZXZ[1:]),
    "two turns": turned("z(phi)", "x(theta)"),
    "a turn with more places": turned("z(phi, theta)", "x(theta)", "z(psi)"),
    "a turn in more pieces": turned("axis_angle(0, 0, 1); cos(phi), phi)", "x(theta)", "z(psi)"),
    "a turn about no unit vector": turned("axis_angle(0, 0, 2, phi)", "x(theta)", "z(psi)"),
    "a constant turn that is none": turned("constant_turn(0, 0, 1, 1, 1)"),
    "no turns": turned(),
    "the transpose": write("presentation", "passive"),
    "neither active nor passive": write("presentation", "Passive"),
    "R of no rotation": write("rotation", {"matrix": [["1", "0", "0"]] * 3, "conditions": []}),
    "turns and a matrix": write("rotation", "matrix", IDENTITY),
    "a defined divisor": of_velocity("0/(10**39*(cos(a) - 2*cos(phi)**2 + 1))", ("a", "2*phi")),
    "a defined rate": together(defined("a", "psi_dot/phi_dot"), put(W, 2, 0, "cos(theta) + a")),
    "a definition of a coordinate": defined("phi", "psi"),
    "a definition in a circle": together(defined("a", "a"), put(VELOCITY, 2, "a")),
    "a sphere of no real radius": conditions("phi**2 + pi**2 - 1", then=FALSE),
    "a divisor that is its condition": conditions(SPHERE, then=of_velocity(f"0/({SPHERE})")),
    "a condition twice": conditions(SPHERE, SPHERE, then=FALSE),
    "two conditions": conditions(SPHERE, "theta**2 + psi**2 - 1", then=FALSE),
    "a name of two lines": write(W, "name", "a\n  proved: everything"),
    **{
        f"a quantity named {name}": write(W, "name", name)
        for name in ("angular_velocity_moon", "truth", "nothing", "R is a rotation")
    },
    "a quantity printed twice": lambda c: c["quantities"].append(c["quantities"][0]),
    "degrees a second": write(VELOCITY, "unit", "deg/s"),
    "a component of Ω in degrees": component("omega_space", 2, "unit", "deg/s"),
    "an angle in degrees": component("q", 0, "unit", "deg"),
    "a rate in degrees": component("q_dot", 0, "unit", "deg/s"),
    "too many multiples of angles": put(VELOCITY, 2, "0*cos(39*phi + 39*theta + 39*psi)"),
    **{
        f"a coordinate named {name!r}": component("q", 1, "name", name)
        for name in ("phi", "sin", "phi_dot", "рhi", "pi", "omega_space_1", "torque_1")
    },
    **{
        f"a rate named {name!r}": component("q_dot", 0, "name", name)
        for name in ("theta_dot", "phi_dot ")
    },
    **{
        f"the condition {text}": conditions(text, then=FALSE)
        for text in ("0*phi", "1", "(phi - 1)**2 + 10**-90", "phi**2 - 1")
    },
}
OF_TOP: dict[str, Change] = {
    "a defined parameter of the body": with_a_parameter_defined,
    "a centre beside the fixed point": write("body", "centre", ["0", "0", "l"]),
    "a principal moment too many": with_a_moment_too_many,
    # of a thin rod, for which every ψ̈ satisfies Lagrange's equations
    "a singular mass matrix": together(
        *(THIN_ROD, everywhere("C", "0"), put("accelerations", 2, "1000*phi_dot*psi_dot"))
    ),
    "a potential by definition": together(
        defined("a", "m*g*l*cos(theta)"),
        *(write("motion", "potential", "a"), everywhere("g", "0*g")),
    ),
    "a sphere of constants of no real radius": conditions(
        "pi**2 + g**2 - 1", then=everywhere("g*", "g*(pi**2 + g**2)*")
    ),
    **{
        name: write("motion", "potential", potential)
        for name, potential in (
            ("a potential that holds a rate", "k*theta_dot"),
            ("another potential", "m*g*l*sin(theta)"),
            ("a potential with a divisor that is zero", "m*g*l*cos(theta) + 1/(A - A)"),
        )
    },
    "a force": write("motion", "forces", ["0", "k", "0"]),
    "a force of an acceleration": write("motion", "forces", ["0", "theta_ddot", "0"]),
    "another tensor": write("body", "inertia", 2, 2, "A"),
    "a tensor that turns": write("body", "inertia", 0, 0, "A*cos(phi)"),
    "a skew tensor": write("body", "inertia", [["A", "A", "0"], ["-A", "A", "0"], ["0", "0", "C"]]),
    "a motion under conditions": write("rotation", "conditions", [SPHERE]),
}
OF_QUATERNION: dict[str, Change] = {
    "a condition that is missing": write("rotation", "conditions", []),
    "a component that is lost": put(VELOCITY, 0, "0"),
    "a norm that is 2": everywhere("w", "(w + w**2 + x**2 + y**2 + z**2 - 2)"),
}
OF_CONE: dict[str, Change] = {
    "another fixed point": write("body", "fixed_point", ["0", "0", "0"]),
    "another centre of mass": write("body", "centre", 2, "h/2"),
    "a tensor that is moved twice": lambda c: c["body"].update(
        inertia=at(c, "inertia_tensor", "expression")
    ),
}
BESIDE: Forgeries = {"ZXZ": OF_ZXZ, "top": OF_TOP, "unit_quaternion": OF_QUATERNION}
BESIDE |= {"cone on its apex": OF_CONE}


# Texts in what is printed of a motion, and what a forger writes for them
SPOILED = (
    ("box", "kinetic_energy", "/24", "/12"),
    ("box", "angular_momentum", "X_dot", "Y_dot"),
    ("box", "moment_of_inertia", "p_x", "p_y"),
    ("box", "inertia_tensor_space", "cos", "sin"),
    ("euler", "angular_acceleration_from_torque", "B - C", "B + C"),
    ("damped top", "lagrangian", "- g*l*m*cos", "+ g*l*m*cos"),
    ("damped top", "potential_energy", "cos", "sin"),
    ("damped top", "generalised_momenta", "C*(", "A*("),
    ("damped top", "mass_matrix", "C", "A"),
    ("damped top", "bias_vector", "g*l*m", "2*g*l*m"),
    ("damped top", "accelerations", "k*", "2*k*"),
    ("damped top", "hamiltonian", "p_theta**2", "p_psi**2"),
    ("damped top", "hamiltonian", "2*p_phi*p_psi", "p_phi*p_psi"),
    ("damped top", "hamiltonian", "g*l*m", "-g*l*m"),
    ("damped top", "constant momentum_phi", "sin(theta)**2", "sin(theta)"),
    ("top", "constant energy", "cos(theta)", "sin(theta)"),
    ("top", "constant energy", "g*l*m", "2*g*l*m"),
    ("top", "constant energy", "A", "C"),
    ("oblique axes", "principal_moments", "50", "51"),
    ("oblique axes", "principal_axes", "4/5", "-4/5"),
)


def with_axes(*factors: str, moments: Any = ("50", "25", "60")) -> Change:
    """Principal axes times factors, which no theorem about lengths and volumes must miss."""

    def change(content: Content) -> None:
        for row in printed(content, "principal_axes")["expression"]:
            row[:] = [f"{factor}*({text})" for factor, text in zip(factors, row, strict=True)]
        printed(content, "principal_moments")["expression"] = list(moments)

    return change


def beside_the_rates(name: str, *conditions: str) -> Change:
    """Rates plus what W does not see, since W q = 0."""

    def change(content: Content) -> None:
        rates = printed(content, "rates_from_angular_velocity_body")["expression"]
        rates[:] = [f"{text} + {q}*{name}" for text, q in zip(rates, "wxyz", strict=True)]
        content["rotation"]["conditions"] = list(conditions)

    return change


def with_a_skew_part(content: Content) -> None:
    """A tensor is printed as it is described, so that nothing else is false."""
    content["quantities"] = [printed(content, "inertia_tensor")]
    content["body"]["inertia"] = content["quantities"][0]["expression"]
    content["body"]["inertia"][0][1] = content["body"]["inertia"][0][0]


def powers_of_powers(form: str) -> Change:
    definitions = [(f"a{k}", form.format(f"a{k - 1}")) for k in range(1, 9)]
    return of_velocity("0*a8", ("a0", "phi"), *definitions)


def called_the_time(content: Content) -> None:
    content |= json.loads(json.dumps(content).replace("theta", "t"))


def coordinates(content: Content) -> None:
    """Nine of them, of which minors of M would be 9! products."""
    for group, end in (("q", ""), ("q_dot", "_dot"), ("q_ddot", "_ddot")):
        unit = at(content, "arguments", group, "components", 0, "unit")
        names = [{"name": f"a{k}{end}", "unit": unit} for k in range(9)]
        at(content, "arguments", group)["components"] = names
    content["arguments"] = [g for g in content["arguments"] if g["name"] not in ("y", "momenta")]
    content["rotation"]["turns"] = [f"{'xyz'[k % 3]}(a{k})" for k in range(9)]
    content["motion"] = {"potential": "a0", "forces": ["0"] * 9, "torque": ["0"] * 3}
    only("mass_matrix")(content)


def with_axis(places: str, condition: str) -> Change:
    turn = with_turns(f"axis_angle({places})", {"phi": "", "theta": "rad"}, condition)
    return together(turn, grouped("parameters", "a"))


# Forgeries of bodies and motions, of rates and of the language of expressions
OTHERS: Forgeries = {
    "ZXZ": {
        "Ω and Ω' are exchanged": exchanged("angular_velocity_space", "angular_velocity_body"),
        **{f"coordinates {form!r}": constants_read_as(form) for form in ("({})", " {}", "{} ")},
        "a coordinate beside the time": together(
            *(
                added([{"name": f"by time{end}", "unit": u}], "arguments", f"q{end}", "components")
                for end, u in (("", ""), ("_dot", "1/s"), ("_ddot", "1/s^2"))
            ),
            only(R),
        ),
        "a rate in W'": put(W, 2, ["cos(theta) + psi_dot/phi_dot", "0", "0"]),
        **{
            f"the entry {text!r:.20}": put(R, 0, 0, text)
            for text in (
                *("phi[0]", "exp(phi)", "cos(phi", "2**phi", "2**(1/3)", "x**999", "", None, "1.0"),
                *("cos(*phi)", "-" * 50_000 + "phi", "cos(phi, phi)"),
            )
        },
        "R in a row of nine": cells(R, lambda rows: [text for row in rows for text in row], [3, 3]),
        "Ω as a row": cells(VELOCITY, lambda rows: [rows], [3]),
        "Ω as a column": cells(VELOCITY, lambda rows: [[row] for row in rows]),
        "degrees in a constant turn": together(
            write("rotation", "turns", 0, "constant_turn(0, 0, 1, cos(phi), sin(phi))"),
            measured(0, "deg", "deg/s", "deg/s^2"),
        ),
        "a letter that is defined": defined("omega_space_1", "0"),
        "a momentum in W": put(W, 2, 0, "cos(theta) + p_phi - p_phi"),
        "the transpose of an inverse": lambda c: put(
            "inverse_rate_matrix_body", 0, printed(c, W)["expression"][0]
        )(c),
        "an inverse of four rows": added(
            [["1", "1", "1"]], "inverse_rate_matrix_body", "expression"
        ),
        "Ω of entries and lists": cells(VELOCITY, lambda rows: [*rows[:2], [rows[2]]]),
        # as a number it would be a multiple of all rates
        "W of one entry": together(
            with_turns("", dict.fromkeys(("phi", "theta", "psi"), "")),
            write("rotation", {"matrix": IDENTITY, "conditions": []}),
            write("quantities", [{"name": W, "expression": [["0"]], "unit": "", "shape": [1, 1]}]),
        ),
        "powers of powers": powers_of_powers("({} + 1)**60"),
        "powers below a line": powers_of_powers("1/({} + 1)**60"),
        "a difference of 1/10**78": of_velocity("phi/10**39/10**39"),
        "pi to 39 places": of_velocity("phi*(pi - 314159265358979/10**14)"),
        "rates in another order": lambda c: at(c, "arguments", "q_dot", "components").reverse(),
        "a turn about coordinates": turned("axis_angle(phi, theta, psi, 1)"),
        "longer rows below": cells(W, lambda rows: [rows[0], *wider("1", "1")(rows)[1:]]),
        "a shorter row below": cells(W, lambda rows: [rows[0], rows[1][:2], rows[2]]),
        "R of four columns": lambda c: together(
            write(
                "rotation", {"matrix": wider("0", "0")(at(c, R, "expression")), "conditions": []}
            ),
            write("quantities", []),
        )(c),
        "another shape": cells(W, lambda rows: rows, shape=[7]),
        "no inputs": write(W, "inputs", []),
        "a coordinate that is the time": called_the_time,
        "rates among constants": lambda c: c["arguments"].append(
            at(c, "arguments", "q_dot") | {"name": "constants"}
        ),
        "turns that are none": turned(*HALVES, *ZXZ),
        "a length of angles": conditions(
            SPHERE, then=together(only(R), added(f" + {SPHERE}", R, "expression", 2, 2))
        ),
        **{f"{name} in kg": write(name, "unit", "kg") for name in (W, RATES)},
        # of a turn, by the name of a coordinate that is said to be no angle
        "an angle without a unit": together(
            *(turned("z(phi)", "x(a)", "z(psi)"), only(R)),
            *(defined("a", "theta"), measured(1, "", "1/s", "1/s^2")),
        ),
        "turns in an object": write("rotation", "turns", dict(zip(ZXZ, (1, 2, 3), strict=True))),
        "conditions in an object": write("rotation", "conditions", {}),
        "a rotation with a sequence": write("rotation", "sequence", ["XYZ"]),
        "an axis of one letter": with_axis("phi, 0, 0, theta", "phi**2 - 1"),
        "an axis that moves in part": with_axis("phi, a, 0, theta", "a**2 + phi**2 - 1"),
        "a state in another order": grouped("y", "psi", "phi", "psi", "n_x", "t"),
        "a group by the name of the body": grouped("body", "t", "t"),
        "parameters of no body": grouped("parameters", "k"),
        **{
            f"the shape {shape}": write(name, "shape", shape)
            for name, shape in (
                *((R, [3, 3, 1]), (VELOCITY, [3, 1, 1])),
                *((VELOCITY, [3, 1]), (VELOCITY, [3, True])),
            )
        },
        **{
            f"inputs {inputs}": write(R, "inputs", inputs)
            for inputs in (["q", "nonsense"], ["q", "q"], ["q", "momenta"], {"q": "space"}, "q")
        },
        "inputs that are not listed": lambda c: write("arguments", [at(c, "arguments", "q")])(c),
        "an angle by definitions": with_turns(
            "constant_turn(0, 0, 1, co, si)", {"phi": ""}, co="cos(phi)", si="sin(phi)"
        ),
        "an angle in defined entries": together(
            with_turns("", {"phi": ""}, co="cos(phi)", si="sin(phi)"),
            write(
                "rotation",
                {"matrix": [["co", "-si", "0"], ["si", "co", "0"], IDENTITY[2]], "conditions": []},
            ),
        ),
        "an axis by definitions": with_turns("axis_angle(0, 0, n, phi)", {"phi": "rad"}, n="-1"),
        "an angle that is a letter of its axis": with_turns(
            "axis_angle(a, b, 0, a)", {"a": "", "b": ""}, "a**2 + b**2 - 1"
        ),
    },
    "unit_quaternion": {"the inverse turn": turned("unit_quaternion(w, -x, -y, -z)")},
    "quaternion": {
        "constants that are called as coordinates": together(
            *(with_a_body(*"wxyz"), only("spin_matrix")),
            write("spin_matrix", "expression", [["0"] * 3] * 3),
        ),
        "a constant that is called as a rate": together(with_a_body("w_dot"), only(VELOCITY)),
        **{
            f"rates that hold {name}": beside_the_rates(name)
            for name in ("w_ddot", "x_dot", "omega_space_2", "anything")
        },
        # R does not depend on the length, which is lost
        "rates off the sphere": beside_the_rates("omega_body_1", "w**2 + x**2 + y**2 + z**2 - 1"),
    },
    "box": {
        "an energy in brackets": cells("kinetic_energy", lambda energy: [energy]),
        "an energy in two brackets": cells("kinetic_energy", lambda energy: [[energy]]),
        "a tensor that is not symmetric": with_a_skew_part,
        "a body that moves": write("body", "centre", ["X", "0", "0"]),
        "a mass that turns": write("body", "mass", "M*phi"),
        "a tensor about a stated point": write("body", "fixed_point", ["1", "0", "0"]),
    },
    "cone on its apex": {
        "a fixed point that moves": write("body", "fixed_point", ["0", "0", "h*phi"]),
        "a fixed point in a plane": write("body", "fixed_point", ["0", "h"]),
        "a fixed point that nobody states": lambda content: content["body"].pop("fixed_point"),
        TWICE: with_energy_of_the_centre,
        "an unknown key of a body": write("body", "offset", ["0", "0", "h"]),
        "an unknown key of a motion": write("motion", "parts", [{"inertia": "M"}]),
    },
    "torque": {"exchanged torques": write("motion", "torque", ["l*F", "k*F", "0"])},
    "euler": {
        "no entries": cells(TORQUE, lambda rows: [[] for _ in rows], shape=[3]),
        "a second column": cells(TORQUE, lambda rows: [[row, "A"] for row in rows]),
    },
    "oblique axes": {
        "left-handed axes": with_axes("(-1)", "1", "1"),
        "axes of a volume of 1 that are no unit vectors": with_axes("2", "1/2", "1"),
        "equal moments": with_axes("1", "1", "1", moments=("6", "6", "6")),
        "another tensor of the axes": write("body", "inertia", [["6", "0", "0"]] * 3),
        "a fourth axis": together(
            cells("principal_axes", wider("0", "0")),
            cells("principal_moments", lambda moments: [*moments, "17*M"]),
        ),
        "moments in a row": cells("principal_moments", lambda m: [m]),
    },
    "damped top": {
        "H in the rates": exchanged("hamiltonian", "energy"),
        # p_psi of a thin rod is 0 for all rates, so that any term with p_psi would do
        "H of a thin rod": together(
            *(THIN_ROD, write("quantities", [{"name": "hamiltonian", "unit": "J"}])),
            write(
                *("quantities", 0, "expression"),
                "(p_theta**2 + p_phi**2/sin(theta)**2)/(2*A) + g*l*m*cos(theta) + p_psi**2",
            ),
        ),
        **{
            f"the energy {text}": added([{"name": "energy", "expression": text}], "first_integrals")
            for text in ("0", "1", "A", "momentum", "phi", "energy")
        },
        "momenta that are themselves": put(P, 0, "p_phi"),
        **{
            f"{name} in kg": write(name, "unit", "kg")
            for name in ("accelerations", "mass_matrix", "bias_vector", P)
        },
    },
    "top": {
        # nowhere defined, while only its slopes are printed
        "an undefined potential": together(
            only("accelerations"), added(" + 1/(A - A)", "motion", "potential")
        ),
        "a potential of unknown angles": together(
            only("accelerations"), added(" + 0*cot(pi)", "motion", "potential")
        ),
        "undefined integrals": integrals(" + 1/(A - A)"),
        "integrals that hold a definition": together(integrals(" + a"), defined("a", "phi")),
        "integrals that hold an acceleration": integrals(" + phi_ddot"),
        **{
            f"{name} in mixed units": added(" + A*g**2", f"constant {name}", "expression")
            for name in ("energy", "momentum_phi")
        },
        "kilojoules": write("energy", "unit", "kJ"),
        "a length of moments": conditions(
            "A**2 + C**2 - 1",
            then=together(only("energy"), added(" + A**2 + C**2 - 1", "energy", "expression")),
        ),
        "an energy in kg": write("constant energy", "unit", "kg"),
        "parameters in other units": write("body", "parameters", [{"name": "A", "unit": "lb ft"}]),
        "nine coordinates": coordinates,
        "a body of coordinates": write("body", "parameters", [{"name": "phi", "unit": "rad"}]),
        "a body without its parameters": write("body", "parameters", []),
        "an integral with a shape": write("constant energy", "shape", [1, 1, 5]),
        "inputs without parameters": write("accelerations", "inputs", ["q", "q_dot"]),
    },
    "whole top": {
        "the centre of mass at the fixed point": with_a_centre,
        # the state of a motion is listed, but not the motion
        FREE_TOP: together(lambda c: c.pop("motion"), with_a_centre),
        "a parameter that is the time": together(
            *(only("energy"), added(" + A*t", "motion", "potential")),
            added(" + A*t", "energy", "expression"),
            added([{"name": "t", "unit": "s"}], "arguments", "parameters", "components"),
        ),
        "another input": write("hamiltonian", "inputs", ["q", "momenta", "parameters", "torque"]),
    },
}


def flat(forgeries: Forgeries) -> dict[str, tuple[str, Change]]:
    return {name: (of, each) for of, changes in forgeries.items() for name, each in changes.items()}


EVERY = flat(BESIDE) | flat(OTHERS)
EVERY |= {f"{text[1]} of {text[0]} is {text[2]}": (of, once(*text)) for of, *text in SPOILED}
# True about the rest, so that only these are not accepted
PARTLY = {
    f"a quantity named {name}": name for name in ("angular_velocity_moon", "truth", "nothing")
}
OF_FORCES = (
    "a potential of unknown angles",
    "a potential by definition",
    "a motion under conditions",
)
OF_TURNS = "powers of powers", "powers below a line", "too many multiples of angles"
for each, names in {
    "accelerations": (*OF_FORCES, "a defined parameter of the body", "an unknown key of a motion"),
    "centre_of_mass": ("the centre of mass at the fixed point", FREE_TOP),
    "kinetic_energy": (TWICE, "a tensor about a stated point"),
    "inertia_tensor": ("an unknown key of a body",),
    P: ("momenta that are themselves",),
    "constant energy": ("integrals that hold a definition",),
    "mass_matrix": ("nine coordinates",),
    R: ("a divisor that is zero", f"the entry {'-' * 50_000!r:.20}"),  # too deep to be read
    VELOCITY: (
        *OF_TURNS,
        "a difference of 1/10**78",
        "a defined divisor",
        "a definition in a circle",
    ),
}.items():
    PARTLY |= dict.fromkeys(names, each)


def is_refused(content: Content, name: str | None = None) -> None:
    """Not accepted as a whole, or at least not what is false in it."""
    try:
        proved, _ = checker.verify(content)
    except checker.BROKEN:
        return
    assert not proved or (name is not None and name not in proved)


def original(name: str) -> Content:
    return of_motion(name) if name in NEEDS else record_of(name)


@pytest.mark.parametrize("name", ["top", "ZXZ", "unit_quaternion", "cone on its apex"])
def test_what_is_forged_here_is_accepted_as_it_was(name):
    assert checker.verify(original(name))[1] == {}


@pytest.mark.parametrize("name", EVERY)
def test_a_forgery_is_refused(name):
    of, change = EVERY[name]
    is_refused(changed(original(of), change), PARTLY.get(name))


def first_entry(content: Content, name: str) -> tuple[Any, int]:
    """The list and the place of the first entry of a quantity that is not a number."""
    rows = printed(content, name)["expression"]
    rows = rows if isinstance(rows[0], list) else [rows]
    return next((row, k) for row in rows for k, t in enumerate(row) if any(map(str.isalpha, t)))


# Changes of one entry: each makes it false, or unreadable
CHANGES: dict[str, Callable[[str], str]] = {
    "a factor": lambda text: f"2*({text})",
    "a sign": lambda text: f"-({text})",
    "a small number": lambda text: f"{text} + 1/10**25*sin(phi)",
    "another angle": lambda t: f"({t})*sin(phi)/sin(psi)" if "psi" in t else f"{t} + psi",
    "a comment": lambda text: f"{text} # + 1",
    "a root of a negative number": lambda text: f"{text} + 0*sqrt(-1)",
    "a divisor that vanishes": lambda text: f"{text} + 0/(cos(phi)**2 + sin(phi)**2 - 1)",
    "the sine of pi": lambda text: f"{text} + 0/sin(pi)",
    "a hidden double angle": lambda t: f"{t} + 0/(cos((phi + phi)*psi/psi) - 2*cos(phi)**2 + 1)",
    "a huge exponent": lambda text: f"({text})**999999999",
    "exponents of exponents": lambda text: f"({text}) + 0*((((1 + phi)**39)**39)**39)**39",
    "a long number": lambda text: f"{text} + 0*{'9' * 5000}",
    "a Greek letter": lambda text: text.replace("phi", "φ") + " + 0*φ",
    "a letter that looks alike": lambda text: f"{text} + 0*\u0440hi",  # Cyrillic р
    "a name that is not there": lambda text: f"{text} + 0*nothing",
    "a call of Python": lambda text: f"{text} + 0*exec(phi)",
    "a chain of exponents": lambda text: f"{text} + 0*2**3**4",
    "a NUL": lambda text: f"{text}\x00",
    "brackets without an end": lambda text: "(" * 2000 + text + ")" * 2000,
}
CHANGED = [
    (change, name)
    for k, change in enumerate(CHANGES)
    for name in (VELOCITY, (R, W, "angular_acceleration_body")[k % 3])
]


@pytest.mark.parametrize(("change", "name"), CHANGED)
def test_a_changed_entry_is_refused(change, name):
    def spoil(content: Content) -> None:
        row, place = first_entry(content, name)
        row[place] = CHANGES[change](row[place])

    is_refused(changed(record_of("ZXZ"), spoil), name)


def test_files_without_a_number_or_with_double_keys_are_refused(tmp_path):
    path, text = tmp_path / "a.json", json.dumps(record_of("ZXZ"))
    for title, fault in (("NaN", "NaN"), ('"", "title": ""', "a name is there twice")):
        path.write_text(text.replace('"title"', f'"title": {title}, "about"', 1))
        with pytest.raises(checker.BROKEN, match=fault):
            checker.load(path)


def false_claims(content: Content) -> list[str]:
    """What the checker refuses, each quantity on its own."""
    false = []
    for name in printed_in(content):
        one = {"quantities": [], "first_integrals": []}
        group = "first_integrals" if name.startswith("constant ") else "quantities"
        one[group] = [printed(content, name)]
        try:
            checker.verify(content | one)
        except checker.BROKEN:
            false.append(name)
    return false


def entries() -> Iterator[tuple[str, Content]]:
    """Every quantity of a top with one entry changed, and the other forgeries."""
    # no divisors that vanish: with the hypothesis that they do not, a theorem says nothing
    changes = ("a factor", "a sign", "a small number", "another angle")

    def spoiled(expression: Any, change: Callable[[str], str]) -> Any:
        if isinstance(expression, str):
            return change(expression) if re.search("[a-zA-Z]", expression) else f"{expression} + 1"
        return [spoiled(expression[0], change), *expression[1:]]

    # another angle is no coordinate of a quaternion
    for of, kinds in (
        (of_motion("whole top"), changes),
        (record_of("unit_quaternion"), changes[:2]),
    ):
        for k, quantity in enumerate(of["quantities"]):
            content, about = copy.deepcopy(of), kinds[k % len(kinds)]
            forged = spoiled(quantity["expression"], CHANGES[about])
            printed(content, quantity["name"])["expression"] = forged
            yield f"{quantity['name']}: {about}", content
    for k, integral in enumerate(of_motion("whole top")["first_integrals"]):
        content = copy.deepcopy(of_motion("whole top"))
        content["first_integrals"][k]["expression"] = f"{integral['expression']} + A*theta_dot"
        yield f"constant {integral['name']}", content
    for name, (of, change) in flat(BESIDE).items():
        # nor what leaves no false theorem to state: names, roots, conditions, units
        if not re.search("divisor|singular|degrees|potential by definition|motion under", name):
            yield name, changed(original("whole top" if of == "top" else of), change)


def refusal(content: Content, name: str) -> str:
    """A theorem that Coq has to refuse, after the facts that its proof may use."""
    text = theorems(content, [*printed_in(content)]).text
    # Ω of a quaternion is the lemma that F turns with it, from which all else follows
    is_lemma = name == VELOCITY and "quaternion_turns" in text
    start = "Lemma step_1 " if is_lemma else f"Theorem {name.replace(' ', '_')} "
    before, theorem = text.split(start, 1)
    facts = re.sub(r"Proof\. intros\..*?Qed\.", "Admitted.", before, flags=re.DOTALL)
    claim, proof = re.split(r"Proof\.(?: intros\.)?", theorem.split("Qed.", 1)[0])
    steps = proof.strip().removesuffix(".").replace(". ", "; ")
    return f"{facts}Theorem forged {claim}Proof. intros. Fail ({steps}). Abort.\nEnd Claims."


def forged_theorems() -> Iterator[tuple[str, str]]:
    """The first false claim of each forgery that can be stated; later ones may follow from it."""
    for about, content in entries():
        try:
            # of a false description of the body or its motion, true theorems may be stated
            checker.verify(content | {"quantities": [], "first_integrals": []})
            false = false_claims(content)
            stated = theorems(content, [*printed_in(content)]).claims
        except checker.BROKEN:
            continue  # it is refused before there is anything to state
        for name in [name for name in stated if name in false][:1]:
            yield f"{about}: {name}", refusal(content, name)


@pytest.mark.usefixtures("coq")
def test_coq_refuses_every_false_claim_that_can_be_stated(tmp_path):
    modules = []
    for k, (about, text) in enumerate(forged_theorems()):
        lines = text.replace(f"{WORDS}\n", "")
        modules.append(f"Module Forgery_{k}. (* {about} *)\n{lines}\nEnd Forgery_{k}.")
    assert len(modules) >= 45
    assert run_coq(tmp_path, "\n".join((WORDS, *modules))) == 0
