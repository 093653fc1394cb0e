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
import sympy as sp

from helpers.certificates import NEEDS, of_motion, printed, record_of, run_coq, spoil
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import theorems

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


def with_rates_in_v(content: Content) -> None:
    content["motion"]["potential"] = "k*phi_dot*cos(theta)"


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


def with_another_centre(content: Content) -> None:
    content["body"]["centre"] = ["0", "0", "l"]


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
    moments |= {"name": "principal_moments", "unit": "kg m^2"}
    moments["expression"] = [*(inertia[k][k] for k in range(3)), "17*A"]
    content["quantities"] += [axes, moments]


KNOWN: dict[str, tuple[str, Change]] = {
    "a parameter of the body that is defined": ("top", with_a_parameter_defined),
    "an argument that is defined": ("ZXZ", with_an_argument_defined),
    "two units of one name": ("ZXZ", with_two_units),
    "a centre beside the fixed point": ("top", with_another_centre),
    "turns about other angles than the name says": ("ZXZ", with_other_angles),
    "a principal moment too many": ("top", with_a_moment_too_many),
    "a constant angle in degrees": ("ZXZ", with_a_constant_angle_in_degrees),
    "a power that costs minutes": ("ZXZ", put(VELOCITY, 2, "0*cos(phi)**90000")),
    "sums of 32,768 roots": (
        "ZXZ",
        put(VELOCITY, 2, f"0/({' + '.join(f'sqrt({p})' for p in sp.primerange(50))})"),
    ),
    "a power of degree zero": ("ZXZ", put(VELOCITY, 2, "0*(phi**0)**900000000000")),
    "a rate with the other sign": ("ZXZ", everywhere("phi_dot", "(-phi_dot)")),
    "a comment that hides a rate": ("ZXZ", put(W, 2, 0, "cos(theta) + psi_dot/phi_dot # '")),
    "conditions that contradict each other": (
        "ZXZ",
        conditions("phi - 1", "phi - 1 - 29682952539239999999", then=FALSE),
    ),
    "a condition without a real point": ("ZXZ", conditions("phi**2 + theta**2 + 1", then=FALSE)),
    "a divisor that is zero": ("ZXZ", put("rotation_matrix", 2, 2, f"cos(theta) + 0/{ZERO}")),
    "a potential that holds a rate": ("top", with_rates_in_v),
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
    "a comment after a line break": lambda text: f"{text}\n# + 1",
    "a root of zero": lambda text: f"{text} + sqrt(0)",
    "a number that reads as a product": lambda text: f"{text} + 0x1*0",
    "a root of a negative number": lambda text: f"{text} + 0*sqrt(-1)",
    "the other root": lambda text: f"{text} + sqrt((1 + cos(phi))**2) + 1 + cos(phi)",
    "a root of a square": lambda text: f"{text} + sqrt(sin(phi)**2) - sin(phi)",
    "a root of one square four times": lambda text: (
        f"{text} + sqrt(psi**2 + psi**2 + psi**2 + psi**2) - 2*psi"
    ),
    "a root of a number that may be negative": lambda text: f"{text} + sqrt(cos(4)**2) - cos(4)",
    "a divisor that vanishes": lambda text: f"{text} + 0/(cos(phi)**2 + sin(phi)**2 - 1)",
    "a divisor of roots that vanishes": lambda text: f"{text} + 0/{ZERO}",
    "the sine of pi": lambda text: f"{text} + 0/sin(pi)",
    "a double angle in disguise": lambda text: (
        f"{text} + 0/(cos((phi + phi)*psi/psi) - 2*cos(phi)**2 + 1)"
    ),
    "a divisor nearly zero": lambda text: f"{text} + phi*0/({ZERO}*10**39)",
    "a huge exponent": lambda text: f"({text})**999999999",
    "exponents of exponents": lambda text: f"({text}) + 0*((((1 + phi)**39)**39)**39)**39",
    "a long number": lambda text: f"{text} + 0*{'9' * 5000}",
    "a Greek letter": lambda text: text.replace("phi", "φ") + " + 0*φ",
    "a letter that looks alike": lambda text: f"{text} + 0*\u0440hi",  # Cyrillic р
    "a digit that looks alike": lambda text: f"{text} + \u0660",  # Arabic 0
    "a minus that looks alike": lambda text: f"{text} \u2212 1",
    "a space without width": lambda text: f"{text}\u200b + 1",
    "a name that is not there": lambda text: f"{text} + 0*nothing",
    "a call of Python": lambda text: f"{text} + 0*exec(phi)",
    "a string": lambda text: f"{text} + 0*'phi'",
    "a chain of exponents": lambda text: f"{text} + 0*2**3**4",
    "an attribute": lambda text: f"{text} + 0*phi.real",
    "a lambda": lambda text: f"{text} + 0*(lambda: 1)",
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
    components: list[Content] = next(
        each["components"] for each in content["arguments"] if each["name"] == group
    )
    return components


def renamed(group: str, place: int, name: str) -> Callable[[Content], None]:
    def change(content: Content) -> None:
        _arguments(content, group)[place]["name"] = name

    return change


def defined(name: str, text: str) -> Callable[[Content], None]:
    return lambda content: content["definitions"].append({"name": name, "expression": text})


def turned(*turns: str) -> Callable[[Content], None]:
    return lambda content: content["rotation"].update(turns=list(turns))


def in_motion(part: str, value: Any) -> Callable[[Content], None]:
    return lambda content: content["motion"].update({part: value})


def in_body(part: str, value: Any) -> Callable[[Content], None]:
    return lambda content: content["body"].update({part: value})


def units(name: str, unit: str) -> Change:
    return lambda content: printed(content, name).update(unit=unit)


def others() -> Iterator[tuple[str, str, Change]]:
    """Forgeries of what the record says beside its entries."""
    for turns in ("z(phi) x(theta) x(psi)", "z(phi) y(theta) z(psi)", "z(-phi) x(theta) z(psi)"):
        yield f"R is {turns}", "ZXZ", turned(*turns.split())
    yield "two turns", "ZXZ", turned("z(phi)", "x(theta)")
    yield "a turn with more places", "ZXZ", turned("z(phi, theta)", "x(theta)", "z(psi)")
    pieces = turned("axis_angle(0, 0, 1); cos(phi), phi)", "x(theta)", "z(psi)")
    yield "a turn in more pieces", "ZXZ", pieces
    yield "an unknown turn", "ZXZ", turned("q(phi)", "x(theta)", "z(psi)")
    no_unit = "axis_angle(0, 0, 2, phi)"
    yield "a turn about no unit vector", "ZXZ", turned(no_unit, "x(theta)", "z(psi)")
    yield "a constant turn that is none", "ZXZ", turned("constant_turn(0, 0, 1, 1, 1)")
    yield "the transpose", "ZXZ", lambda content: content.update(presentation="passive")
    yield "neither active nor passive", "ZXZ", lambda c: c.update(presentation="Passive")
    no_rotation = {"matrix": [["1", "0", "0"]] * 3, "conditions": []}
    yield "R by entries that are none", "ZXZ", lambda c: c.update(rotation=no_rotation)
    identity = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
    yield "turns and a matrix", "ZXZ", lambda c: c["rotation"].update(matrix=identity)
    yield "no turns", "ZXZ", turned()
    yield "another convention", "ZXZ", lambda content: content.update(name="euler_zyx_intrinsic")
    for name in ("phi", "sin", "phi_dot", "psi ", "рhi", "pi", "omega_space_1", "torque_1"):
        yield f"a coordinate named {name!r}", "ZXZ", renamed("q", 1, name)
    for name in ("theta_dot", "phidot", "phi_dot "):
        yield f"a rate named {name!r}", "ZXZ", renamed("q_dot", 0, name)

    def rate_by_definition(content: Content) -> None:
        defined("a", "psi_dot/phi_dot")(content)
        put(W, 2, 0, "cos(theta) + a")(content)

    def circle(content: Content) -> None:
        defined("a", "a")(content)
        put(VELOCITY, 2, "a")(content)

    def root_by_definition(content: Content) -> None:
        defined("a", "3*phi")(content)
        defined("b", "4*phi")(content)
        put(VELOCITY, 2, "phi_dot + psi_dot*cos(theta) + sqrt(a**2 + b**2) - 5*phi")(content)

    yield "a root of a square by definition", "ZXZ", root_by_definition

    def double_angle(content: Content) -> None:
        defined("a", "2*phi")(content)
        put(VELOCITY, 2, "phi_dot + psi_dot*cos(theta) + 0/(cos(a) - 2*cos(phi)**2 + 1)")(content)

    def potential_by_definition(content: Content) -> None:
        defined("a", "m*g*l*cos(theta)")(content)
        content["motion"]["potential"] = "a"
        everywhere("g", "0*g")(content)

    yield "a divisor of a double angle by definition", "ZXZ", double_angle
    yield "a potential by definition, without its force", "top", potential_by_definition
    yield "a definition of a rate", "ZXZ", rate_by_definition
    yield "a definition of a coordinate", "ZXZ", defined("phi", "psi")
    yield "a definition in a circle", "ZXZ", circle
    for text in ("phi - phi", "0*phi", "1", "(phi - 1)**2 + 10**-90", "phi**2 - 1", "0 - 1"):
        yield f"the condition {text}", "ZXZ", conditions(text, then=FALSE)
    sphere = "phi**2 + theta**2 - 1"
    yield "a sphere of no real radius", "ZXZ", conditions("phi**2 + pi**2 - 1", then=FALSE)
    imaginary = conditions("pi**2 + g**2 - 1", then=everywhere("g*", "g*(pi**2 + g**2)*"))
    yield "a sphere of constants of no real radius", "top", imaginary
    for pair in ((sphere, sphere), (sphere, "theta**2 + psi**2 - 1")):
        yield f"conditions {pair}", "ZXZ", conditions(*pair, then=FALSE)
    divisor = put(VELOCITY, 2, f"phi_dot + psi_dot*cos(theta) + 0/({sphere})")
    yield "a divisor that vanishes under its condition", "ZXZ", conditions(sphere, then=divisor)
    radius = put(VELOCITY, 2, "phi_dot + psi_dot*cos(theta) + sqrt(phi**2 + theta**2) + phi")
    yield "the negative branch of a root", "ZXZ", radius
    yield (
        "a condition that is missing",
        "unit_quaternion",
        lambda c: c["rotation"].update(conditions=[]),
    )
    yield "a component that is lost", "unit_quaternion", put(VELOCITY, 0, "0")
    yield (
        "a norm that is 2",
        "unit_quaternion",
        everywhere("w", "(w + w**2 + x**2 + y**2 + z**2 - 2)"),
    )
    lines = "a\n  proved: everything"
    yield "a name of two lines", "ZXZ", lambda c: printed(c, W).update(name=lines)
    for name in ("angular_velocity_moon", "__init__", "truth"):
        yield f"a quantity named {name}", "ZXZ", lambda c, n=name: printed(c, W).update(name=n)
    twin = {"name": "q", "components": []}
    yield "two groups of coordinates", "ZXZ", lambda c: c["arguments"].insert(0, twin)
    yield "a quantity printed twice", "ZXZ", lambda c: c["quantities"].append(c["quantities"][0])
    for part, value in (
        ("potential", "k*theta_dot"),
        ("potential", "m*g*l*sin(theta)"),
        ("potential", "m*g*l*cos(theta) + 1/(A - A)"),
        ("forces", ["0", "k", "0"]),
        ("forces", ["0", "theta_ddot", "0"]),
        ("torque", ["1", "0", "0"]),
    ):
        yield f"{part} {value}", "top", in_motion(part, value)
    for tensor in (
        [["A", "0", "0"], ["0", "A", "0"], ["0", "0", "A"]],
        [["A*cos(phi)", "0", "0"], ["0", "A", "0"], ["0", "0", "C"]],
        [["A", "0", "0"], ["0", "A", "0"]],
        [["A", "A", "0"], ["-A", "A", "0"], ["0", "0", "C"]],
    ):
        yield f"a tensor {tensor}", "top", in_body("inertia", tensor)
    yield "a motion under conditions", "top", lambda c: c["rotation"].update(conditions=[sphere])
    yield "degrees a second", "ZXZ", units(VELOCITY, "deg/s")
    for group in ("omega_space", "omega_body"):
        yield (
            f"{group} in degrees",
            "ZXZ",
            lambda c, g=group: _arguments(c, g)[2].update(unit="deg/s"),
        )
    yield "an angle in degrees", "ZXZ", lambda c: _arguments(c, "q")[0].update(unit="deg")
    yield "a rate in degrees", "ZXZ", lambda c: _arguments(c, "q_dot")[0].update(unit="deg/s")
    many = put(VELOCITY, 2, "0*cos(39*phi + 39*theta + 39*psi)")
    yield "too many multiples of angles", "ZXZ", many


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
    ("oblique axes", "principal_moments", "6", "12"),
    ("oblique axes", "principal_axes", "1/2", "-1/2"),
)


def exchanged(*names: str) -> Change:
    def change(content: Content) -> None:
        one, two = (printed(content, name) for name in names)
        one["expression"], two["expression"] = two["expression"], one["expression"]

    return change


def with_axes(*factors: str, moments: Any = ("6 + 2*sqrt(2)", "6", "6 - 2*sqrt(2)")) -> Change:
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
        *("phi[0]", "exp(phi)", "cos(phi", "cos phi", "2**phi", "2**(1/3)", "x**999", "", None),
        *({}, "True", "1.0", "cos(*phi)", "-" * 50_000 + "phi", "cos(phi, phi)", "phi\n"),
    ):
        yield f"the entry {text!r:.20}", "ZXZ", put("rotation_matrix", 0, 0, text)


OTHERS = {name: (of, change) for name, of, change in (*others(), *of_motions())}
# True about the rest, so that only these are not accepted
PARTLY = {"a quantity named angular_velocity_moon": "angular_velocity_moon"}
PARTLY |= {f"a quantity named {name}": name for name in ("__init__", "truth")}
PARTLY |= {"a motion under conditions": "accelerations", "too many multiples of angles": VELOCITY}
PARTLY |= {"a divisor that is zero": "rotation_matrix"}
PARTLY |= {"a divisor of a double angle by definition": VELOCITY}
PARTLY |= {"a root of a square by definition": VELOCITY, "the negative branch of a root": VELOCITY}


@pytest.mark.parametrize("name", OTHERS)
def test_another_forgery_is_refused(name):
    of, change = OTHERS[name]
    is_refused(changed(original(of), change), PARTLY.get(name))


def test_there_are_sixty_forgeries():
    assert len(KNOWN) + len(CHANGES) + len(OTHERS) >= 60


def test_double_keys_are_refused(tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(record_of("ZXZ")).replace('"title"', '"title": "", "title"', 1))
    with pytest.raises(checker.Refused, match="a name is there twice"):
        checker.load(path)


def false_claims(content: Content) -> list[str]:
    """What the checker refuses, each quantity on its own."""
    motion = checker.Motion(checker.Record(content))
    if "body" in content:
        motion.read_body()
    false = []
    for name in checker.printed_in(content):
        try:
            checker.agree(name, motion.claims(name))
        except checker.Unreadable:
            continue
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
    beside = {name: (of, change) for name, of, change in others()}
    for name, (of, change) in {**KNOWN, **beside}.items():
        # nor what leaves no true theorem to state: names and roots that are no longer there
        if not re.search("divisor|singular|potential by definition", name):
            yield name, changed(of_motion("whole top") if of == "top" else record_of(of), change)


def refusal(content: Content, name: str) -> str:
    """A theorem that Coq has to refuse, after the facts that its proof may use."""
    text = theorems(content, [*checker.printed_in(content)]).text
    # Ω of a quaternion is the lemma that F turns with it, from which all else follows
    is_lemma = name == VELOCITY and "turning ltac" in text
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
            false = false_claims(content)
            stated = theorems(content, [*checker.printed_in(content)]).claims
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
