"""Forged records: whatever is false in one, the checker and Coq refuse it.

The first seven were accepted by an earlier checker. A forger may write what he likes into a record.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from helpers.certificates import NEEDS, of_motion, printed, record_of, run_coq, spoil
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import printed_in, theorems

Content = dict[str, Any]
Change = Callable[[Content], object]
VELOCITY, W = "angular_velocity_space", "rate_matrix_body"


def changed(content: Content, change: Change) -> Content:
    content = copy.deepcopy(content)
    change(content)
    return content


def put(name: str, *path: Any) -> Callable[[Content], None]:
    """Write the last of `path` to a place in an expression."""

    def change(content: Content) -> None:
        *places, text = path
        part = printed(content, name)
        for place, following in zip(["expression", *places], [*places, None], strict=True):
            if following is None:
                part[place] = text
            else:
                part = part[place]

    return change


def everywhere(before: str, after: str) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        for quantity in content["quantities"]:
            text = json.dumps(quantity["expression"]).replace(before, after)
            quantity["expression"] = json.loads(text)

    return change


def conditions(*texts: str, then: Callable[[Content], None]) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        content["rotation"]["conditions"] = list(texts)
        then(content)

    return change


ZERO = "(sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2))"
FALSE = put(VELOCITY, 2, "phi_dot")  # without ψ̇ cos θ


def singular(content: Content) -> None:
    """A thin rod, for which every ψ̈ satisfies Lagrange's equations."""
    content["body"]["inertia"][2][2], content["first_integrals"] = "0", []
    everywhere("C", "0")(content)
    put("accelerations", 2, "1000*phi_dot*psi_dot")(content)


def with_a_parameter_defined(content: Content) -> None:
    """Gravity is said to act, and all is worked out without it."""
    parameters = next(g for g in content["arguments"] if g["name"] == "parameters")
    parameters["components"] = [c for c in parameters["components"] if c["name"] != "g"]
    content["definitions"] = [{"name": "g", "expression": "0"}]
    put("accelerations", 1, printed(content, "accelerations")["expression"][1])(content)


def with_an_argument_defined(content: Content) -> None:
    component = {"name": "K", "unit": "rad/s", "symbol": "K", "about": ""}
    content["arguments"].append({"name": "gains", "components": [component]})
    content["definitions"] = [{"name": "K", "expression": "0"}]
    put(VELOCITY, 2, "phi_dot + psi_dot*cos(theta) + K")(content)


def with_two_units(content: Content) -> None:
    angles = copy.deepcopy(next(g for g in content["arguments"] if g["name"] == "q"))
    content["arguments"].append(angles | {"name": "again"})
    content["arguments"][0]["components"][0]["unit"] = "deg"


def with_other_angles(content: Content) -> None:
    content["rotation"]["turns"][0] = "z(0)"
    everywhere("phi_dot", "0")(content)
    everywhere("sin(phi)", "0")(content)
    everywhere("cos(phi)", "1")(content)


def with_a_constant_angle_in_degrees(content: Content) -> None:
    content["rotation"]["turns"][1], content["name"] = "x(a)", "chain"
    content["quantities"] = [printed(content, "rotation_matrix")]
    everywhere("theta", "a")(content)
    unit = {"name": "a", "unit": "deg"}
    content["arguments"] += [{"name": "parameters", "components": [unit]}]


def with_a_moment_too_many(content: Content) -> None:
    inertia = content["body"]["inertia"]
    axes, moments = copy.deepcopy(content["quantities"][:2])
    axes |= {"name": "principal_axes", "unit": "", "expression": [["1", "0", "0"]]}
    axes["expression"] += [["0", "1", "0"], ["0", "0", "1"]]
    moments |= {"name": "principal_moments", "unit": "kg m^2", "shape": [4]}
    axes["inputs"] = moments["inputs"] = []
    moments["expression"] = [*(inertia[k][k] for k in range(3)), "17*A"]
    content["quantities"] += [axes, moments]


KNOWN: dict[str, tuple[str, Change]] = {
    "a parameter of the body that is defined": ("top", with_a_parameter_defined),
    "an argument that is defined": ("ZXZ", with_an_argument_defined),
    "two units of one name": ("ZXZ", with_two_units),
    "a centre beside the fixed point": (
        "top",
        lambda content: content["body"].update(centre=["0", "0", "l"]),
    ),
    "turns about other angles than the name says": ("ZXZ", with_other_angles),
    "a principal moment too many": ("top", with_a_moment_too_many),
    "a constant angle in degrees": ("ZXZ", with_a_constant_angle_in_degrees),
    "a power that costs minutes": ("ZXZ", put(VELOCITY, 2, "0*cos(phi)**90000")),
    "a power of degree zero": ("ZXZ", put(VELOCITY, 2, "0*(phi**0)**900000000000")),
    "a rate with the other sign": ("ZXZ", everywhere("phi_dot", "(-phi_dot)")),
    "a comment that hides a rate": ("ZXZ", put(W, 2, 0, "cos(theta) + psi_dot/phi_dot # '")),
    "conditions that contradict each other": (
        "ZXZ",
        conditions("phi - 1", "phi - 1 - 29682952539239999999", then=FALSE),
    ),
    "a condition without a real point": ("ZXZ", conditions("phi**2 + theta**2 + 1", then=FALSE)),
    "a divisor that is zero": ("ZXZ", put("rotation_matrix", 2, 2, f"cos(theta) + 0/{ZERO}")),
    "a singular mass matrix": ("top", singular),
}


def is_refused(content: Content, name: str | None = None) -> None:
    """Not accepted as a whole, or at least not what is false in it."""
    try:
        proved, _ = checker.verify(content)
    except checker.BROKEN:
        return
    assert not proved or (name is not None and name not in proved)


def original(name: str) -> Content:
    return of_motion(name) if name in NEEDS else record_of(name)


@pytest.mark.parametrize("name", ["top", "ZXZ", "unit_quaternion"])
def test_what_is_forged_here_is_accepted_as_it_was(name):
    assert checker.verify(original(name))[1] == {}


@pytest.mark.parametrize("name", KNOWN)
def test_forgeries_that_were_once_accepted_are_refused(name):
    of, change = KNOWN[name]
    is_refused(changed(original(of), change), PARTLY.get(name))


def first_entry(content: Content, name: str) -> tuple[Any, int]:
    """The list and the place of the first entry of a quantity that is not a number."""
    rows = printed(content, name)["expression"]
    rows = rows if isinstance(rows[0], list) else [rows]
    return next(
        (row, k) for row in rows for k, text in enumerate(row) if any(map(str.isalpha, text))
    )


# Changes of one entry: each makes it false, or unreadable
CHANGES: dict[str, Callable[[str], str]] = {
    "a factor": lambda text: f"2*({text})",
    "a sign": lambda text: f"-({text})",
    "a small number": lambda text: f"{text} + 1/10**25*sin(phi)",
    "another angle": lambda text: (
        f"({text})*sin(phi)/sin(psi)" if "psi" in text else f"{text} + psi"
    ),
    "a comment": lambda text: f"{text} # + 1",
    "a root of a negative number": lambda text: f"{text} + 0*sqrt(-1)",
    "a divisor that vanishes": lambda text: f"{text} + 0/(cos(phi)**2 + sin(phi)**2 - 1)",
    "the sine of pi": lambda text: f"{text} + 0/sin(pi)",
    "a double angle in disguise": lambda text: (
        f"{text} + 0/(cos((phi + phi)*psi/psi) - 2*cos(phi)**2 + 1)"
    ),
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
    for name in (VELOCITY, ("rotation_matrix", W, "angular_acceleration_body")[k % 3])
]


@pytest.mark.parametrize(("change", "name"), CHANGED)
def test_a_changed_entry_is_refused(change, name):
    def spoil(content: Content) -> None:
        row, place = first_entry(content, name)
        row[place] = CHANGES[change](row[place])

    is_refused(changed(record_of("ZXZ"), spoil), name)


def _arguments(content: Content, group: str) -> list[Content]:
    components: list[Content] = _groups(content, group)["components"]
    return components


def _groups(content: Content, name: str) -> Content:
    group: Content = next(each for each in content["arguments"] if each["name"] == name)
    return group


def renamed(group: str, place: int, name: str) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        _arguments(content, group)[place]["name"] = name

    return change


def defined(name: str, text: str) -> Callable[[Content], None]:
    return lambda content: content["definitions"].append({"name": name, "expression": text})


def turned(*turns: str) -> Callable[[Content], None]:
    return lambda content: content["rotation"].update(turns=list(turns))


def within(place: str) -> Callable[[str, Any], Change]:
    return lambda part, value: lambda content: content[place].update({part: value})


in_motion, in_body, of_rotation = map(within, ("motion", "body", "rotation"))


def units(name: str, unit: str) -> Change:
    return lambda content: printed(content, name).update(unit=unit)


def rate_by_definition(content: Content) -> None:
    defined("a", "psi_dot/phi_dot")(content)
    put(W, 2, 0, "cos(theta) + a")(content)


def circle(content: Content) -> None:
    defined("a", "a")(content)
    put(VELOCITY, 2, "a")(content)


def double_angle(content: Content) -> None:
    defined("a", "2*phi")(content)
    put(VELOCITY, 2, f"{TRUE} + 0/(10**39*(cos(a) - 2*cos(phi)**2 + 1))")(content)


def potential_by_definition(content: Content) -> None:
    defined("a", "m*g*l*cos(theta)")(content)
    content["motion"]["potential"] = "a"
    everywhere("g", "0*g")(content)


def of_whole(part: str, value: str) -> Change:
    return lambda content: content.update({part: value})


def called(name: str) -> Change:
    return lambda content: printed(content, W).update(name=name)


def in_degrees(group: str, place: int, unit: str = "deg/s") -> Change:
    return lambda content: _arguments(content, group)[place].update(unit=unit)


TRUE = "phi_dot + psi_dot*cos(theta)"
SPHERE = "phi**2 + theta**2 - 1"
IDENTITY = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
OF_ZXZ: dict[str, Change] = {  # forgeries of what the record of ZXZ says beside its entries
    "R about other axes": turned("z(phi)", "x(theta)", "x(psi)"),
    "R by an angle of the other sense": turned("z(-phi)", "x(theta)", "z(psi)"),
    "two turns": turned("z(phi)", "x(theta)"),
    "a turn with more places": turned("z(phi, theta)", "x(theta)", "z(psi)"),
    "a turn in more pieces": turned("axis_angle(0, 0, 1); cos(phi), phi)", "x(theta)", "z(psi)"),
    "a turn about no unit vector": turned("axis_angle(0, 0, 2, phi)", "x(theta)", "z(psi)"),
    "a constant turn that is none": turned("constant_turn(0, 0, 1, 1, 1)"),
    "no turns": turned(),
    "the transpose": of_whole("presentation", "passive"),
    "neither active nor passive": of_whole("presentation", "Passive"),
    "another convention": of_whole("name", "euler_zyx_intrinsic"),
    "R by entries that are none": lambda content: content.update(
        rotation={"matrix": [["1", "0", "0"]] * 3, "conditions": []}
    ),
    "turns and a matrix": of_rotation("matrix", IDENTITY),
    "a divisor of a double angle by definition": double_angle,
    "a definition of a rate": rate_by_definition,
    "a definition of a coordinate": defined("phi", "psi"),
    "a definition in a circle": circle,
    "a sphere of no real radius": conditions("phi**2 + pi**2 - 1", then=FALSE),
    "a divisor that vanishes under its condition": conditions(
        SPHERE, then=put(VELOCITY, 2, f"{TRUE} + 0/({SPHERE})")
    ),
    "a condition twice": conditions(SPHERE, SPHERE, then=FALSE),
    "two conditions": conditions(SPHERE, "theta**2 + psi**2 - 1", then=FALSE),
    "a name of two lines": called("a\n  proved: everything"),
    "a quantity named angular_velocity_moon": called("angular_velocity_moon"),
    "a quantity named truth": called("truth"),
    "a quantity printed twice": lambda c: c["quantities"].append(c["quantities"][0]),
    "degrees a second": units(VELOCITY, "deg/s"),
    "a component of Ω in degrees": in_degrees("omega_space", 2),
    "an angle in degrees": in_degrees("q", 0, "deg"),
    "a rate in degrees": in_degrees("q_dot", 0),
    "too many multiples of angles": put(VELOCITY, 2, "0*cos(39*phi + 39*theta + 39*psi)"),
    **{
        f"a coordinate named {name!r}": renamed("q", 1, name)
        for name in ("phi", "sin", "phi_dot", "рhi", "pi", "omega_space_1", "torque_1")
    },
    **{f"a rate named {name!r}": renamed("q_dot", 0, name) for name in ("theta_dot", "phi_dot ")},
    **{
        f"the condition {text}": conditions(text, then=FALSE)
        for text in ("0*phi", "1", "(phi - 1)**2 + 10**-90", "phi**2 - 1")
    },
}
OF_TOP: dict[str, Change] = {
    "a potential by definition, without its force": potential_by_definition,
    "a sphere of constants of no real radius": conditions(
        "pi**2 + g**2 - 1", then=everywhere("g*", "g*(pi**2 + g**2)*")
    ),
    "a potential that holds a rate": in_motion("potential", "k*theta_dot"),
    "another potential": in_motion("potential", "m*g*l*sin(theta)"),
    "a potential with a divisor that is zero": in_motion(
        "potential", "m*g*l*cos(theta) + 1/(A - A)"
    ),
    "a force": in_motion("forces", ["0", "k", "0"]),
    "a force of an acceleration": in_motion("forces", ["0", "theta_ddot", "0"]),
    "another tensor": in_body("inertia", [["A", "0", "0"], ["0", "A", "0"], ["0", "0", "A"]]),
    "a tensor that turns": in_body(
        "inertia", [["A*cos(phi)", "0", "0"], ["0", "A", "0"], ["0", "0", "C"]]
    ),
    "a skew tensor": in_body("inertia", [["A", "A", "0"], ["-A", "A", "0"], ["0", "0", "C"]]),
    "a motion under conditions": of_rotation("conditions", [SPHERE]),
}
OF_QUATERNION: dict[str, Change] = {
    "a condition that is missing": of_rotation("conditions", []),
    "a component that is lost": put(VELOCITY, 0, "0"),
    "a norm that is 2": everywhere("w", "(w + w**2 + x**2 + y**2 + z**2 - 2)"),
}
BESIDE: dict[str, tuple[str, Change]] = {
    name: (of, change)
    for of, changes in (("ZXZ", OF_ZXZ), ("top", OF_TOP), ("unit_quaternion", OF_QUATERNION))
    for name, change in changes.items()
}


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


def exchanged(*names: str) -> Change:
    def change(content: Content) -> None:
        one, two = (printed(content, name) for name in names)
        one["expression"], two["expression"] = two["expression"], one["expression"]

    return change


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


def of_a_thin_rod(content: Content) -> None:
    """p_psi of a thin rod is 0 for all rates, so that any term with p_psi would do."""
    content["body"]["inertia"][2][2], content["first_integrals"] = "0", []
    text = "(p_theta**2 + p_phi**2/sin(theta)**2)/(2*A) + g*l*m*cos(theta) + p_psi**2"
    content["quantities"] = [{"name": "hamiltonian", "unit": "J", "expression": text}]


def with_a_skew_part(content: Content) -> None:
    """A tensor is printed as it is described, so that nothing else is false."""
    content["quantities"] = [printed(content, "inertia_tensor")]
    content["body"]["inertia"] = content["quantities"][0]["expression"]
    content["body"]["inertia"][0][1] = content["body"]["inertia"][0][0]


def of_motions() -> Iterator[tuple[str, str, Change]]:
    """Forgeries of bodies and motions, of rates and of the language of expressions."""
    for of, name, before, after in SPOILED:
        about = f"{before} of {name} is {after}"
        yield about, of, lambda c, row=(name, before, after): spoil(c, *row)
    velocities = "angular_velocity_space", "angular_velocity_body"
    yield "Ω and Ω' are exchanged", "ZXZ", exchanged(*velocities)
    yield "a rate in W'", "ZXZ", put(W, 2, ["cos(theta) + psi_dot/phi_dot", "0", "0"])
    for name in ("w_ddot", "x_dot", "omega_space_2", "anything"):
        yield f"rates that hold {name}", "quaternion", beside_the_rates(name)
    unit = "w**2 + x**2 + y**2 + z**2 - 1"  # R does not depend on the length, which is lost
    leaving = beside_the_rates("omega_body_1", unit)
    yield "rates that leave the conditions", "quaternion", leaving
    yield "H in the rates", "damped top", exchanged("hamiltonian", "energy")
    yield "H of a thin rod", "damped top", of_a_thin_rod
    yield "a tensor that is not symmetric", "box", with_a_skew_part
    axes = "oblique axes"
    yield "left-handed axes", axes, with_axes("(-1)", "1", "1")
    yield "axes of a volume of 1 that are no unit vectors", axes, with_axes("2", "1/2", "1")
    yield "equal moments", axes, with_axes("1", "1", "1", moments=("6", "6", "6"))
    yield "another tensor of the axes", axes, in_body("inertia", [["6", "0", "0"]] * 3)
    yield "exchanged torques", "torque", in_motion("torque", ["l*F", "k*F", "0"])
    for text in ("0", "1", "A", "momentum", "phi", "energy"):
        constant = {"name": "energy", "expression": text}
        yield (
            f"the energy {text}",
            "damped top",
            lambda c, e=constant: c["first_integrals"].append(e),
        )
    for text in (
        *("phi[0]", "exp(phi)", "cos(phi", "2**phi", "2**(1/3)", "x**999", "", None, "1.0"),
        *("cos(*phi)", "-" * 50_000 + "phi", "cos(phi, phi)"),
    ):
        yield f"the entry {text!r:.20}", "ZXZ", put("rotation_matrix", 0, 0, text)


def cells(name: str, write: Callable[[Any], Any], shape: Any = None) -> Change:
    """Another expression, with its shape unless that is to be false."""

    def change(content: Content) -> None:
        quantity = printed(content, name)
        quantity["expression"] = write(quantity["expression"])
        first = quantity["expression"][0]
        columns = [len(first)] if isinstance(first, list) else []
        quantity["shape"] = shape or [len(quantity["expression"]), *columns]

    return change


def together(*changes: Change) -> Change:
    def change(content: Content) -> None:
        for each in changes:
            each(content)

    return change


def undefined(potential: str) -> Change:
    """A potential that is nowhere defined, of which only the slopes are printed."""

    def change(content: Content) -> None:
        content["quantities"] = [printed(content, "accelerations")]
        content["first_integrals"] = []
        content["motion"]["potential"] += potential

    return change


def integrals(term: str) -> Change:
    def change(content: Content) -> None:
        for integral in content["first_integrals"]:
            integral["expression"] += term

    return change


def by_degrees(content: Content) -> None:
    """Angles in degrees, hidden in a turn with a constant axis."""
    first = "constant_turn(0, 0, 1, cos(phi), sin(phi))"
    content["rotation"]["turns"][0], content["name"] = first, "chain"
    for group, unit in (("q", "deg"), ("q_dot", "deg/s"), ("q_ddot", "deg/s^2")):
        _arguments(content, group)[0]["unit"] = unit


def powers_of_powers(form: str) -> Change:
    definitions = [defined("a0", "phi")]
    definitions += [defined(f"a{k}", form.format(f"a{k - 1}")) for k in range(1, 9)]
    return together(*definitions, put(VELOCITY, 2, f"{TRUE} + 0*a8"))


P = "generalised_momenta"
ATTACKS: dict[str, tuple[str, Change]] = {  # of two strangers who read the checker
    "nine entries of R in a row": (
        "ZXZ",
        cells("rotation_matrix", lambda rows: [text for row in rows for text in row], [3, 3]),
    ),
    "Ω as a row": ("ZXZ", cells(VELOCITY, lambda rows: [rows], [3])),
    "momenta that are themselves": ("damped top", lambda c: put(P, 0, "p_phi")(c)),
    "an undefined potential": ("top", undefined(" + 1/(A - A)")),
    "a potential of unknown angles": ("top", undefined(" + 0*cot(pi)")),
    "undefined integrals": ("top", integrals(" + 1/(A - A)")),
    "integrals that hold a definition": ("top", together(integrals(" + a"), defined("a", "phi"))),
    "integrals that hold an acceleration": ("top", integrals(" + phi_ddot")),
    "degrees in a constant turn": ("ZXZ", by_degrees),
    "a letter that is defined": ("ZXZ", defined("omega_space_1", "0")),
    "kilojoules": ("top", lambda c: printed(c, "energy").update(unit="kJ")),
    "a momentum in W": ("ZXZ", put(W, 2, 0, "cos(theta) + p_phi - p_phi")),
    "the transpose of an inverse": (
        "ZXZ",
        lambda c: put("inverse_rate_matrix_body", 0, printed(c, W)["expression"][0])(c),
    ),
    "an inverse with a row too many": (
        "ZXZ",
        lambda c: printed(c, "inverse_rate_matrix_body")["expression"].append(["1", "1", "1"]),
    ),
    "powers of powers": ("ZXZ", powers_of_powers("({} + 1)**60")),
    "powers below a line": ("ZXZ", powers_of_powers("1/({} + 1)**60")),
    "a difference of 1/10**78": ("ZXZ", put(VELOCITY, 2, f"{TRUE} + phi/10**39/10**39")),
    "pi to 39 places": ("ZXZ", put(VELOCITY, 2, f"{TRUE} + phi*(pi - 314159265358979/10**14)")),
    "rates in another order": ("ZXZ", lambda c: _arguments(c, "q_dot").reverse()),
    "a turn about coordinates": ("ZXZ", turned("axis_angle(phi, theta, psi, 1)")),
    "the inverse turn": ("unit_quaternion", turned("unit_quaternion(w, -x, -y, -z)")),
    "a body that moves": ("box", in_body("centre", ["X", "0", "0"])),
    "a mass that turns": ("box", in_body("mass", "M*phi")),
}


def wider(first: str, rest: str) -> Callable[[Any], Any]:
    """A column more."""
    return lambda rows: [[*rows[0], first], *([*row, rest] for row in rows[1:])]


def of_entries(content: Content) -> None:
    """R of four columns."""
    entries = wider("0", "0")(printed(content, "rotation_matrix")["expression"])
    content["rotation"], content["name"] = {"matrix": entries, "conditions": []}, "any"
    content["quantities"] = []


def only(name: str, text: str, *path: Any) -> Change:
    """One quantity, with something added to an entry."""

    def change(content: Content) -> None:
        content["quantities"], content["first_integrals"] = [printed(content, name)], []
        part = content["quantities"][0]
        for place in ("expression", *path)[:-1]:
            part = part[place]
        part[("expression", *path)[-1]] += text

    return change


def in_time(content: Content) -> None:
    content["motion"]["potential"] += " + A*t"
    only("energy", " + A*t")(content)
    _arguments(content, "parameters").append({"name": "t", "unit": "s"})


def called_the_time(content: Content) -> None:
    content |= json.loads(json.dumps(content).replace("theta", "t"))


def without_a_unit(content: Content) -> None:
    """An angle of a turn by the name of a coordinate that is said to be no angle."""
    turned("z(phi)", "x(a)", "z(psi)")(content)
    content["name"], content["quantities"] = "any", [printed(content, "rotation_matrix")]
    defined("a", "theta")(content)
    for group, unit in (("q", ""), ("q_dot", "1/s"), ("q_ddot", "1/s^2")):
        _arguments(content, group)[1]["unit"] = unit


def coordinates(content: Content) -> None:
    """Nine of them, of which minors of M would be 9! products."""
    for group, end in (("q", ""), ("q_dot", "_dot"), ("q_ddot", "_ddot")):
        unit = _arguments(content, group)[0]["unit"]
        names = [{"name": f"a{k}{end}", "unit": unit} for k in range(9)]
        _groups(content, group)["components"] = names
    content["arguments"] = [g for g in content["arguments"] if g["name"] not in ("y", "momenta")]
    content["name"] = "any"
    content["rotation"]["turns"] = [f"{'xyz'[k % 3]}(a{k})" for k in range(9)]
    content["motion"] = {"potential": "a0", "forces": ["0"] * 9, "torque": ["0"] * 3}
    content["quantities"], content["first_integrals"] = [printed(content, "mass_matrix")], []


def with_axis(places: str, condition: str) -> Change:
    groups = {"q": {"phi": "", "theta": "rad"}, "parameters": {"a": ""}}
    arguments = [
        {"name": group, "components": [{"name": n, "unit": u} for n, u in units.items()]}
        for group, units in groups.items()
    ]
    rotation = {"turns": [f"axis_angle({places})"], "conditions": [condition]}
    whole = {"name": "any", "arguments": arguments, "rotation": rotation, "quantities": []}
    return lambda content: content.update(whole)


def grouped(name: str, *components: str) -> Change:
    """Another group of arguments, with the units that they have elsewhere."""
    units = {"psi": "rad", "phi": "rad", "n_x": "", "t": "s", "k": "m"}
    listed = [{"name": each, "unit": units[each]} for each in components]
    return lambda c: c["arguments"].append({"name": name, "components": listed})


def given(name: str, part: str, value: Any) -> Change:
    return lambda content: printed(content, name).update({part: value})


def with_turns(turn: str, units: dict[str, str], *conditions: str, **definitions: str) -> Change:
    """One turn of coordinates with the units that are said, and R only."""
    components = [{"name": name, "unit": unit} for name, unit in units.items()]
    whole = {"name": "any", "arguments": [{"name": "q", "components": components}]}
    whole |= {"rotation": {"turns": [turn], "conditions": [*conditions]}, "quantities": []}
    whole |= {"definitions": [{"name": n, "expression": e} for n, e in definitions.items()]}
    return lambda content: content.update(whole)


def by_defined_entries(content: Content) -> None:
    with_turns("", {"phi": ""}, co="cos(phi)", si="sin(phi)")(content)
    rows = [["co", "-si", "0"], ["si", "co", "0"], ["0", "0", "1"]]
    content["rotation"] = {"matrix": rows, "conditions": []}


def without_rates(content: Content) -> None:
    content["arguments"] = [_groups(content, "q")]


TORQUE, RATES = "angular_acceleration_from_torque", "rates_from_angular_velocity_space"
ZXZ, HALVES = (
    ("z(phi)", "x(theta)", "z(psi)"),
    ("constant_turn(0, 0, 1, 2, 0)", "constant_turn(0, 0, 1, 1/2, 0)"),
)
HELD = ["q", "momenta", "parameters", "torque"]
STRANGER: dict[str, tuple[str, Change]] = {
    "no entries": ("euler", cells(TORQUE, lambda rows: [[] for _ in rows], shape=[3])),
    "a second column": ("euler", cells(TORQUE, lambda rows: [[row, "A"] for row in rows])),
    "longer rows below": ("ZXZ", cells(W, lambda rows: [rows[0], *wider("1", "1")(rows)[1:]])),
    "a shorter row below": ("ZXZ", cells(W, lambda rows: [rows[0], rows[1][:2], rows[2]])),
    "a fourth axis": (
        "oblique axes",
        together(
            cells("principal_axes", wider("0", "0")),
            cells("principal_moments", lambda moments: [*moments, "17*M"]),
        ),
    ),
    "R of four columns": ("ZXZ", of_entries),
    "moments in a row": ("oblique axes", cells("principal_moments", lambda m: [m])),
    "another shape": ("ZXZ", cells(W, lambda rows: rows, shape=[7])),
    "no inputs": ("ZXZ", lambda c: printed(c, W).update(inputs=[])),
    "a parameter that is the time": ("whole top", in_time),
    "a coordinate that is the time": ("ZXZ", called_the_time),
    "rates among constants": (
        "ZXZ",
        lambda c: c["arguments"].append(_groups(c, "q_dot") | {"name": "constants"}),
    ),
    "turns that are none": ("ZXZ", together(turned(*HALVES, *ZXZ), of_whole("name", "any"))),
    "a length of angles": (
        "ZXZ",
        conditions(SPHERE, then=only("rotation_matrix", f" + {SPHERE}", 2, 2)),
    ),
    "a length of moments": (
        "top",
        conditions("A**2 + C**2 - 1", then=only("energy", " + A**2 + C**2 - 1")),
    ),
    **{f"{name} in kg": ("ZXZ", units(name, "kg")) for name in (W, RATES)},
    **{
        f"{name} in kg": ("damped top", units(name, "kg"))
        for name in ("accelerations", "mass_matrix", "bias_vector", P)
    },
    "an energy in kg": ("top", units("constant energy", "kg")),
    "parameters in other units": ("top", in_body("parameters", [{"name": "A", "unit": "lb ft"}])),
    "an angle without a unit": ("ZXZ", without_a_unit),
    **{
        f"the name {name!r}": ("ZXZ", of_whole("name", name))
        for name in (
            *("euler_zxz_\u0435xtrinsic", "euler_xyz_intrinsic_passive", "Euler_xyz_intrinsic"),
            *("euler_xyz_intrinsic ", "euler_zxz_\ud800"),
        )
    },
    "a passive name of what is active": ("ZXZ", of_whole("name", "euler_zxz_intrinsic_passive")),
    "turns in an object": ("ZXZ", of_rotation("turns", {"z(phi)": 1, "x(theta)": 2, "z(psi)": 3})),
    "conditions in an object": ("ZXZ", of_rotation("conditions", {})),
    "a rotation with a sequence": ("ZXZ", of_rotation("sequence", ["XYZ"])),
    "nine coordinates": ("top", coordinates),
    "an axis of one letter": ("ZXZ", with_axis("phi, 0, 0, theta", "phi**2 - 1")),
    "a state in another order": ("ZXZ", grouped("y", "psi", "phi", "psi", "n_x", "t")),
    "a group by the name of the body": ("ZXZ", grouped("body", "t", "t")),
    "parameters of no body": ("ZXZ", grouped("parameters", "k")),
    "a body of coordinates": ("top", in_body("parameters", [{"name": "phi", "unit": "rad"}])),
    "a body without its parameters": ("top", in_body("parameters", [])),
    **{
        f"the shape {shape}": ("ZXZ", given(name, "shape", shape))
        for name, shape in (
            *(("rotation_matrix", [3, 3, 1]), (VELOCITY, [3, 1, 1])),
            *((VELOCITY, [3, 1]), (VELOCITY, [3, True])),
        )
    },
    "an integral with a shape": ("top", given("constant energy", "shape", [1, 1, 5])),
    **{
        f"inputs {inputs}": ("ZXZ", given("rotation_matrix", "inputs", inputs))
        for inputs in (["q", "nonsense"], ["q", "q"], ["q", "momenta"], {"q": "space"}, "q")
    },
    "inputs of another quantity": ("whole top", given("hamiltonian", "inputs", HELD)),
    "inputs without parameters": ("top", given("accelerations", "inputs", ["q", "q_dot"])),
    "inputs that are not listed": ("ZXZ", without_rates),
    "an angle by definitions": (
        "ZXZ",
        with_turns("constant_turn(0, 0, 1, co, si)", {"phi": ""}, co="cos(phi)", si="sin(phi)"),
    ),
    "an angle in defined entries": ("ZXZ", by_defined_entries),
    "an axis by definitions": (
        "ZXZ",
        with_turns("axis_angle(0, 0, n, phi)", {"phi": "rad"}, n="-1"),
    ),
    "an angle that is a letter of its axis": (
        "ZXZ",
        with_turns("axis_angle(a, b, 0, a)", {"a": "", "b": ""}, "a**2 + b**2 - 1"),
    ),
    "an axis that moves in part": ("ZXZ", with_axis("phi, a, 0, theta", "a**2 + phi**2 - 1")),
}


OTHERS = BESIDE | ATTACKS | STRANGER | {name: (of, change) for name, of, change in of_motions()}
# True about the rest, so that only these are not accepted
PARTLY = {"a quantity named angular_velocity_moon": "angular_velocity_moon"}
PARTLY |= {"a quantity named truth": "truth"}
PARTLY |= {"a motion under conditions": "accelerations", "too many multiples of angles": VELOCITY}
PARTLY |= dict.fromkeys(["powers of powers", "powers below a line"], VELOCITY)
PARTLY |= {"momenta that are themselves": P, "a difference of 1/10**78": VELOCITY}
PARTLY |= dict.fromkeys(["a parameter of the body that is defined"], "accelerations")
PARTLY |= {"a potential of unknown angles": "accelerations"}
PARTLY |= {"integrals that hold a definition": "constant energy"}
PARTLY |= {"a potential by definition, without its force": "accelerations"}
PARTLY |= {"a divisor that is zero": "rotation_matrix"}
PARTLY |= {"a divisor of a double angle by definition": VELOCITY}
PARTLY |= {"a definition in a circle": VELOCITY, "nine coordinates": "mass_matrix"}


@pytest.mark.parametrize("name", OTHERS)
def test_another_forgery_is_refused(name):
    of, change = OTHERS[name]
    is_refused(changed(original(of), change), PARTLY.get(name))


def test_a_file_without_a_number_is_refused(tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(record_of("ZXZ") | {"request": float("nan")}))
    with pytest.raises(checker.BROKEN, match="NaN"):
        checker.load(path)


def test_double_keys_are_refused(tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(record_of("ZXZ")).replace('"title"', '"title": "", "title"', 1))
    with pytest.raises(checker.Refused, match="a name is there twice"):
        checker.load(path)


def false_claims(content: Content) -> list[str]:
    """What the checker refuses, each quantity on its own."""
    false = []
    for name in printed_in(content):
        one = {"quantities": [], "first_integrals": []}
        one["first_integrals" if name.startswith("constant ") else "quantities"] = [
            printed(content, name)
        ]
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
    for name, (of, change) in {**KNOWN, **BESIDE}.items():
        # nor what leaves no false theorem to state: names, roots, conditions, units
        if not re.search("divisor|singular|degrees|potential by definition|motion under", name):
            yield name, changed(of_motion("whole top") if of == "top" else record_of(of), change)


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


@pytest.mark.campaign
def test_coq_refuses_every_false_claim_that_can_be_stated(tmp_path):
    modules = []
    for k, (about, text) in enumerate(forged_theorems()):
        lines = text.replace("Require Import Reals Lra Rotation.\n", "")
        modules.append(f"Module Forgery_{k}. (* {about} *)\n{lines}\nEnd Forgery_{k}.")
    assert len(modules) >= 45
    assert run_coq(tmp_path, "\n".join(("Require Import Reals Lra Rotation.", *modules))) == 0
