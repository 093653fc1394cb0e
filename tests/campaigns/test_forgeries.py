"""Forged certificates: whoever signs a false record, the checker and Coq refuse it.

The first seven were accepted by an earlier checker. A forger may write what he likes into both
files, and signs: every forgery here has the digest of its own record.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import pytest
import sympy as sp

import rigidsym as rs
from helpers.certificates import certified, plain, printed, record_of, run_coq, signed
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import certificate_of
from rigidsym.tools.certificate.formal import coq

Content = dict[str, Any]
Forgery = tuple[Content, Content]  # a record and its certificate, signed
RATES = "phi_dot", "theta_dot", "psi_dot"
VELOCITY, W = "angular_velocity_space", "rate_matrix_body"


@cache
def top() -> tuple[Content, str]:
    A, C = sp.symbols("A C", positive=True)
    names = ["rotation_matrix", "angular_velocity_body", "mass_matrix", "accelerations", "energy"]
    body = rs.principal_moments(A, A, C)
    motion = rs.derive("ZXZ", names, body=body, potential="m*g*l*cos(theta)")
    content = plain(record(motion, {}))
    return content, certificate_of(content).json


def of_rotation(
    text: str, change: Callable[[Content], object], claims: list[str] | None = None, **parts: Any
) -> Forgery:
    content = copy.deepcopy(record_of(text))
    change(content)
    if claims is None:
        claims = json.loads(certified(text))["claims"]
    return content, signed(content, certified(text), claims=claims, **parts)


def of_top(change: Callable[[Content], object], **parts: Any) -> Forgery:
    content, certificate = top()
    content = copy.deepcopy(content)
    change(content)
    return content, signed(content, certificate, **parts)


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
    content["body"]["inertia"][2][2] = "0"
    put("mass_matrix", 2, 2, "0")(content)
    put("accelerations", 2, "1000*phi_dot*psi_dot")(content)


def with_rates_in_v(content: Content) -> None:
    content["motion"]["potential"] = "k*phi_dot*cos(theta)"


KNOWN: dict[str, Callable[[], Forgery]] = {
    "a negative part of an angle": lambda: of_rotation(
        "ZXZ", everywhere("phi_dot", "(-phi_dot)"), parts={"phi": -1}
    ),
    "a comment that hides a rate": lambda: of_rotation(
        "ZXZ", put(W, 2, 0, "cos(theta) + psi_dot/phi_dot # '")
    ),
    "conditions that contradict each other": lambda: of_rotation(
        "ZXZ",
        conditions("phi - 1", "phi - 1 - 29682952539239999999", then=FALSE),
        example={"phi": "1"},
    ),
    "a condition without a real point": lambda: of_rotation(
        "ZXZ", conditions("phi**2 + theta**2 + 1", then=FALSE)
    ),
    "a divisor that is zero": lambda: of_rotation(
        "ZXZ", put("rotation_matrix", 2, 2, f"cos(theta) + 0/{ZERO}")
    ),
    "a potential that holds a rate": lambda: of_top(with_rates_in_v),
    "a singular mass matrix": lambda: of_top(singular),
}


def is_refused(forgery: Forgery) -> None:
    content, certificate = forgery
    with pytest.raises(checker.BROKEN):
        checker.verify(content, certificate)


def test_what_is_forged_here_is_accepted_as_it_was():
    content, certificate = top()
    assert checker.verify(content, signed(content, certificate))
    for text in ("ZXZ", "unit_quaternion"):
        assert checker.verify(record_of(text), signed(record_of(text), certified(text)))


@pytest.mark.parametrize("name", KNOWN)
def test_forgeries_that_were_once_accepted_are_refused(name):
    is_refused(KNOWN[name]())


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
    "a root of a negative number": lambda text: f"{text} + 0*sqrt(-1)",
    "the other root": lambda text: f"{text} + sqrt((1 + cos(phi))**2) + 1 + cos(phi)",
    "a root of a square": lambda text: f"{text} + sqrt(sin(phi)**2) - sin(phi)",
    "a divisor that vanishes": lambda text: f"{text} + 0/(cos(phi)**2 + sin(phi)**2 - 1)",
    "a divisor of roots that vanishes": lambda text: f"{text} + 0/{ZERO}",
    "a divisor nearly zero": lambda text: f"{text} + phi*0/({ZERO}*10**39)",
    "a huge exponent": lambda text: f"({text})**999999999",
    "exponents of exponents": lambda text: f"({text}) + ((1 + phi)**39)**39 - ((1 + phi)**39)**39",
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


@pytest.mark.campaign
@pytest.mark.parametrize(("change", "name"), CHANGED)
def test_a_changed_entry_is_refused(change, name):
    def spoil(content: Content) -> None:
        row, place = first_entry(content, name)
        row[place] = CHANGES[change](row[place])

    is_refused(of_rotation("ZXZ", spoil))
    is_refused(of_rotation("ZXZ", spoil, claims=[name]))


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


def others() -> Iterator[tuple[str, Callable[[], Forgery]]]:
    """Forgeries of what the record says beside its entries, and of the certificate."""
    for turns in ("z(phi) x(theta) x(psi)", "z(phi) y(theta) z(psi)", "z(-phi) x(theta) z(psi)"):
        yield f"R is {turns}", lambda t=turns: of_rotation("ZXZ", turned(*t.split()))
    yield "two turns", lambda: of_rotation("ZXZ", turned("z(phi)", "x(theta)"))
    yield "an unknown turn", lambda: of_rotation("ZXZ", turned("q(phi)", "x(theta)", "z(psi)"))
    yield (
        "a turn about no unit vector",
        lambda: of_rotation(
            "ZXZ", turned("axis_angle(0, 0, 2, phi)", "x(theta)", "z(psi)"), claims=[]
        ),
    )
    yield (
        "a constant turn that is none",
        lambda: of_rotation("ZXZ", turned("constant_turn(0, 0, 1, 1, 1)"), claims=[]),
    )
    yield "the transpose", lambda: of_rotation("ZXZ", lambda c: c.update(presentation="passive"))
    yield (
        "a record of another rotation",
        lambda: (
            record_of("ZYX"),
            signed(record_of("ZYX"), certified("ZXZ")),
        ),
    )
    yield (
        "R by entries that are none",
        lambda: of_rotation(
            "ZXZ",
            lambda c: c.update(rotation={"matrix": [["1", "0", "0"]] * 3, "conditions": []}),
            claims=[],
        ),
    )
    for name in ("phi", "sin", "phi_dot", "psi ", "рhi", "pi", "omega_space_1", "torque_1"):
        yield f"a coordinate named {name!r}", lambda n=name: of_rotation("ZXZ", renamed("q", 1, n))
    for name in ("theta_dot", "phidot", "phi_dot "):
        yield f"a rate named {name!r}", lambda n=name: of_rotation("ZXZ", renamed("q_dot", 0, n))
    yield (
        "a definition of a rate",
        lambda: of_rotation(
            "ZXZ", lambda c: (defined("a", "psi_dot/phi_dot")(c), put(W, 2, 0, "cos(theta) + a")(c))
        ),
    )
    yield "a definition of a coordinate", lambda: of_rotation("ZXZ", defined("phi", "psi"))
    yield (
        "a definition in a circle",
        lambda: of_rotation("ZXZ", lambda c: (defined("a", "a")(c), put(VELOCITY, 2, "a")(c))),
    )
    for text in ("phi - phi", "0*phi", "1", "phi - phi + 10**-70", "(phi - 1)**2 + 10**-90"):
        yield (
            f"the condition {text}",
            lambda t=text: of_rotation("ZXZ", conditions(t, then=FALSE), example={"phi": "1"}),
        )
    for text in ("sqrt(2)", "1/0", "phi", "nan", "10**999"):
        yield (
            f"an example at {text}",
            lambda t=text: of_rotation(
                "ZXZ", conditions("phi - 1", then=FALSE), example={"phi": t}
            ),
        )
    yield (
        "a divisor that vanishes under the condition",
        lambda: of_rotation(
            "ZXZ",
            conditions("phi**2 - 1", then=put(VELOCITY, 2, "phi_dot + 0/(phi**2 - 1)")),
            example={"phi": "1"},
        ),
    )
    yield (
        "cofactors of nothing",
        lambda: of_rotation(
            "unit_quaternion", put(VELOCITY, 0, "0"), cofactors={f"{VELOCITY} 1": {"0": "1/0"}}
        ),
    )
    yield "no cofactors", lambda: of_rotation("unit_quaternion", lambda _: None, cofactors={})
    yield (
        "an example off the sphere",
        lambda: of_rotation("unit_quaternion", lambda _: None, example=dict.fromkeys("wxyz", "1")),
    )
    yield "no example", lambda: of_rotation("unit_quaternion", lambda _: None, example={})
    yield (
        "a claim made twice",
        lambda: of_rotation("ZXZ", lambda _: None, claims=[VELOCITY, VELOCITY]),
    )
    yield (
        "a claim about what is not printed",
        lambda: of_rotation("ZXZ", lambda _: None, claims=["kinetic_energy"]),
    )
    yield (
        "a quantity printed twice",
        lambda: of_rotation(
            "ZXZ", lambda c: c["quantities"].append(copy.deepcopy(c["quantities"][0]))
        ),
    )
    yield (
        "a name without a law",
        lambda: of_rotation(
            "ZXZ", lambda c: printed(c, VELOCITY).update(name="truth"), claims=["truth"]
        ),
    )
    yield (
        "a frame that is none",
        lambda: of_rotation(
            "ZXZ",
            lambda c: printed(c, VELOCITY).update(name="angular_velocity_moon"),
            claims=["angular_velocity_moon"],
        ),
    )
    yield (
        "a method of the checker",
        lambda: of_rotation(
            "ZXZ", lambda c: printed(c, VELOCITY).update(name="__init__"), claims=["__init__"]
        ),
    )
    for part, value in (
        ("potential", "k*theta_dot"),
        ("potential", "m*g*l*sin(theta)"),
        ("potential", "m*g*l*cos(theta) + 1/(A - A)"),
        ("forces", ["0", "k", "0"]),
        ("forces", ["0", "theta_ddot", "0"]),
        ("torque", ["1", "0", "0"]),
    ):
        yield f"{part} {value}", lambda p=part, v=value: of_top(in_motion(p, v))
    for tensor in (
        [["A", "0", "0"], ["0", "A", "0"], ["0", "0", "A"]],
        [["A*cos(phi)", "0", "0"], ["0", "A", "0"], ["0", "0", "C"]],
        [["A", "0", "0"], ["0", "A", "0"]],
    ):
        yield f"a tensor {tensor}", lambda t=tensor: of_top(in_body("inertia", t))
    identity = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
    lies: dict[str, Callable[[Content], object]] = {
        "degrees a second": lambda c: printed(c, VELOCITY).update(unit="deg/s"),
        "an angle in degrees": lambda c: _arguments(c, "q")[0].update(unit="deg"),
        "a rate in degrees": lambda c: _arguments(c, "q_dot")[0].update(unit="deg/s"),
        "turns and a matrix": lambda c: c["rotation"].update(matrix=identity),
        "no turns": lambda c: c["rotation"].update(turns=[]),
        "neither active nor passive": lambda c: c.update(presentation="Passive"),
        "too many multiples of angles": put(VELOCITY, 2, "0*cos(39*phi + 39*theta + 39*psi)"),
    }
    for name, lie in lies.items():
        yield name, lambda lie=lie: of_rotation("ZXZ", lie)
    yield (
        "the name of another convention",
        lambda: of_rotation(
            "ZXZ", lambda c: c.update(name="euler_zyx_intrinsic"), name="euler_zyx_intrinsic"
        ),
    )
    yield (
        "a motion under conditions",
        lambda: of_top(
            lambda c: c["rotation"].update(conditions=["theta - 1"]), example={"theta": "1"}
        ),
    )


OTHERS = dict(others())


@pytest.mark.campaign
@pytest.mark.parametrize("name", OTHERS)
def test_another_forgery_is_refused(name):
    is_refused(OTHERS[name]())


def test_there_are_sixty_forgeries():
    assert len(KNOWN) + len(CHANGES) + len(OTHERS) >= 60


def test_double_keys_and_edits_after_the_fact_are_refused(tmp_path):
    content = record_of("ZXZ")
    path = tmp_path / "a.json"
    path.write_text(json.dumps(content).replace('"title"', '"title": "", "title"', 1))
    with pytest.raises(checker.Refused, match="a key is there twice"):
        checker.load(path)
    with pytest.raises(checker.Refused, match="not the one of this certificate"):
        checker.verify({**content, "title": "another"}, json.loads(certified("ZXZ")))


@pytest.mark.campaign
@pytest.mark.parametrize("change", ["a factor", "a sign", "a small number", "another angle"])
def test_coq_refuses_what_the_checker_would_have_let_through(tmp_path, change):
    names = [quantity["name"] for quantity in record_of("ZXZ")["quantities"]]
    for name in names:
        content = copy.deepcopy(record_of("ZXZ"))
        row, place = first_entry(content, name)
        row[place] = CHANGES[change](row[place])
        assert run_coq(tmp_path, coq(content, [name])) != 0, name
