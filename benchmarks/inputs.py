"""Inputs of the campaign "fuzz": texts from a grammar, most of them nearly right, some hostile.

Every input is made by `random.Random` alone, so that its number makes it again.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from random import Random
from typing import Any

Maker = Callable[[Random], str]

NAMES = (
    *("phi", "theta", "psi", "a", "b", "c", "x", "y", "alpha0", "beta_1", "M", "rho", "h", "g"),
    *(
        "φ",
        "λ",
        "lambda",
        "q",
        "phi_dot",
        "t",
        "pi",
        "e",
        "E",
        "I",
        "S",
        "N",
        "class",
        "eps",
        "out",
    ),
    *("__class__", "a__b", "1a", "", "a b", "sin", "None", "é", "x" * 41, "phi_", "_phi", "np"),
)
GOOD_NAMES = ("phi", "theta", "psi", "a", "b", "alpha0", "M", "h")
NUMBERS = (
    *("0", "1", "2", "3", "-1", "1/2", "0.5", "2.5", "1e-3", "1e3", "10**12", "1e40", "9" * 30),
    *("1e400", "inf", "nan", "-0.0", "1_000", "0x10", "1e-320", "7.", ".5", "9**9**9"),
)
FUNCTIONS = ("sin", "cos", "tan", "sqrt", "exp", "log", "atan2", "asin", "abs", "sinh", "lipsum")
SEQUENCES = ("ZXZ", "ZYX", "xyz", "313", "zxz", "XYX", "ZZX", "zXz", "", "quaternion", "mrp", "rpy")
TURNS = ("z({})", "x({})", "y({})", "[1,1,0]({})", "[a,b,c]({})", "[0,sqrt(3),1]({})", "w({})")
ROTATIONS = (
    *("unit_quaternion", "axis_angle", "rotation_vector", "gibbs_vector", "goldstein", "davenport"),
    *("direction_cosines", "cayley_klein", "aerospace", "bunge", "euler", "quaternoin"),
)
SHAPES = {
    "box": "sides",
    "cylinder": "radius height",
    "hollow_cylinder": "inner_radius outer_radius height",
    "cone": "radius height",
    "sphere": "radius",
    "torus": "radius tube_radius",
    "ring": "radius",
    "rod": "length",
    "tetrahedron": "corners",
    "given": "coordinates place bounds element",
    "polyhedron": "vertices faces",
    "cube": "side",
}
HOSTILE = (
    *("\0", "\x1b[2J", "\u202e", "'", '"', "\\", "\n", "]", "}", "{{", "../", "/etc/passwd", "%s"),
    *("#", "=", "é" * 9, "a" * 999, "((((((((", "[[[[[[[[", ")" * 9, "**", "/0", ";", "`", "$(id)"),
)


def expression(rng: Random, depth: int = 3) -> str:
    """An expression in names and numbers; now and then a wrong one."""
    if rng.random() < 0.5:
        return _plain(rng, depth)
    kind = rng.random()
    if depth == 0 or kind < 0.35:
        pool = GOOD_NAMES if rng.random() < 0.6 else NAMES if rng.random() < 0.5 else NUMBERS
        return rng.choice(pool)
    if kind < 0.7:
        operator = rng.choice(("+", "-", "*", "/", "**", " * ", "+-", "^", " "))
        return f"{expression(rng, depth - 1)}{operator}{expression(rng, depth - 1)}"
    if kind < 0.9:
        inside = ", ".join(expression(rng, depth - 1) for _ in range(1 + (rng.random() < 0.15)))
        return f"{rng.choice(FUNCTIONS)}({inside})"
    return rng.choice(("({})", "-{}", "{}**2", "1/({})", "({}", "sqrt({})")).format(
        expression(rng, depth - 1)
    )


def _plain(rng: Random, depth: int) -> str:
    """An expression that can be read."""
    kind = rng.random()
    if depth == 0 or kind < 0.4:
        return rng.choice((*GOOD_NAMES, "1", "2", "3/4", "0.5", "pi"))
    one, other = _plain(rng, depth - 1), _plain(rng, depth - 1)
    if kind < 0.75:
        return f"{one} {rng.choice('+-*')} {other}"
    return rng.choice(("sin({0})", "cos({0})", "({0})/({1} + 2)", "({0})**2", "-({0})")).format(
        one, other
    )


def spoiled(rng: Random, text: str, share: float = 0.15) -> str:
    """The text, or one with something hostile put into it, cut out or doubled."""
    if rng.random() > share:
        return text
    at = rng.randrange(len(text) + 1)
    some = rng.randrange(1, 12)
    return rng.choice(
        (
            text[:at] + rng.choice(HOSTILE) + text[at:],
            text[:at] + text[at + some :],
            text[:at] + text[at : at + some] * 2 + text[at + some :],
        )
    )


def turns(rng: Random) -> str:
    count = rng.choice((1, 2, 2, 3, 3, 3, 4, 5))
    if rng.random() < 0.6:
        names = rng.sample(GOOD_NAMES, count)
        return " ".join(rng.choice(TURNS[:4]).format(name) for name in names)
    return " ".join(rng.choice(TURNS).format(expression(rng, 1)) for _ in range(count))


def rotation(rng: Random) -> str:
    """A sequence, turns or a name."""
    sequences = SEQUENCES[:6] if rng.random() < 0.7 else SEQUENCES
    return rng.choice((rng.choice(sequences), turns(rng), rng.choice(ROTATIONS[:-2]), turns(rng)))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _value(rng: Random, depth: int = 2) -> str:
    """Any value of TOML, mostly the wrong one."""
    kinds: list[Callable[[], str]] = [
        lambda: _quoted(expression(rng, 1)),
        lambda: rng.choice(NUMBERS),
        lambda: rng.choice(("true", "false", "1979-05-27", "07:32:00", "[]", "{}", '""')),
        lambda: _quoted(rng.choice(NAMES)),
    ]
    if depth:
        kinds += [
            lambda: _list(rng, rng.randrange(4), lambda: _value(rng, depth - 1)),
            lambda: f"{{ {rng.choice(GOOD_NAMES)} = {_value(rng, depth - 1)} }}",
        ]
    return rng.choice(kinds)()


def _list(rng: Random, count: int, entry: Callable[[], str]) -> str:
    if rng.random() < 0.05:
        count += rng.choice((-1, 1, 30))
    return f"[{', '.join(entry() for _ in range(count))}]"


def _number(rng: Random) -> str:
    """An expression or a number of a body."""
    if rng.random() < 0.03:
        return rng.choice((_value(rng), rng.choice(NUMBERS)))
    text = _quoted(expression(rng, 1) if rng.random() < 0.1 else _plain(rng, 1))
    return rng.choice((text, "1", "2", "0.5", "1.5", "2.25"))


def _point(rng: Random) -> str:
    return _list(rng, 3, lambda: _number(rng))


def _names(rng: Random, count: int) -> str:
    if rng.random() < 0.8:
        return f"[{', '.join(map(_quoted, rng.sample(GOOD_NAMES, count)))}]"
    return _list(rng, count, lambda: _quoted(rng.choice(NAMES)))


def _rotation_table(rng: Random) -> list[str]:
    if rng.random() < 0.15:
        entry = rng.choice(
            (
                lambda: _quoted(expression(rng, 2)),
                lambda: _quoted(rng.choice(("0", "1", "cos(phi)", "sin(phi)", "-sin(phi)"))),
            )
        )
        lines = [f"matrix = {_list(rng, 3, lambda: _list(rng, 3, entry))}"]
        if rng.random() < 0.5:
            lines = [
                'matrix = [["cos(phi)", "-sin(phi)", "0"], ["sin(phi)", "cos(phi)", "0"], '
                '["0", "0", "1"]]'
            ]
        lines += [f"coordinates = {_names(rng, rng.randrange(1, 4))}"]
        if rng.random() < 0.5:
            count = rng.randrange(1, 3)
            lines += [f"constraints = {_list(rng, count, lambda: _quoted(expression(rng, 2)))}"]
    else:
        one = _quoted(rotation(rng))
        many = _list(rng, 2, lambda: _quoted(rotation(rng)))
        lines = [f"sequence = {one if rng.random() < 0.85 else many}"]
    extras = (
        f"angles = {_names(rng, 3)}",
        "passive = true",
        "passive = false",
        "scalar_last = true",
        f"constants = {_names(rng, 1)}",
    )
    return ["[rotation]", *lines, *(line for line in extras if rng.random() < 0.06)]


def _mass(rng: Random) -> str:
    return rng.choice(("", f", mass = {_number(rng)}", f", density = {_number(rng)}"))


def _solid(rng: Random) -> str:
    """The keys of a shape, between commas."""
    shape = rng.choice(tuple(SHAPES))
    keys = [f'shape = "{shape}"']
    for key in SHAPES[shape].split():
        if rng.random() < 0.6:
            row = _list(rng, 3, lambda: _number(rng))
            rows = _list(rng, 4, lambda: _point(rng))
            of = {"sides": row, "place": row, "corners": rows, "vertices": rows, "bounds": rows}
            of |= {"coordinates": _names(rng, 3), "faces": "[[0, 1, 2], [0, 2, 3], [0, 3, 1]]"}
            keys.append(f"{key} = {of.get(key, _number(rng))}")
    return ", ".join(keys) + _mass(rng)


def _part(rng: Random) -> str:
    place = rng.choice(("", f", at = {_point(rng)}", f", turned = {_quoted(turns(rng))}"))
    hole = ", hole = true" if rng.random() < 0.2 else ""
    return f"{{ {_solid(rng)}{place}{hole} }}"


def _body_table(rng: Random) -> list[str]:
    def particle() -> str:
        return f"{{ mass = {_number(rng)}, at = {_point(rng)} }}"

    kinds = (
        lambda: f"principal_moments = {_point(rng)}",
        lambda: f"inertia = {_list(rng, 3, lambda: _point(rng))}",
        lambda: 'inertia = "general"',
        lambda: f"parts = [{{ {_solid(rng)} }}]",
        lambda: f"particles = {_list(rng, rng.randrange(1, 4), particle)}",
        lambda: f"parts = {_list(rng, rng.randrange(1, 3), lambda: _part(rng))}",
        lambda: f"mesh = {_quoted(rng.choice(('none.stl', '/etc/passwd', '..', 'a.toml')))}",
    )
    lines = ["[body]", rng.choice(kinds)()]
    if rng.random() < 0.1:
        lines.append("allow = true")
    if rng.random() < 0.1:
        value = rng.choice(("", f", value = {_number(rng)}", ", positive = false"))
        lines += ["[parameters]", f'{rng.choice(NAMES) or "A"} = {{ about = "it"{value} }}']
    if rng.random() < 0.1:
        lines += ["[dynamics]", f"potential = {_quoted(expression(rng, 2))}"]
        lines += [f"forces = {{ {rng.choice(GOOD_NAMES)} = {_quoted(expression(rng, 1))} }}"]
    return lines


def _output_table(rng: Random) -> list[str]:
    def some(count: int, *names: str) -> str:
        """Names from a list, the last of which is wrong and rare."""
        known = names if rng.random() < 0.1 else names[:-1]
        return _list(rng, count, lambda: _quoted(rng.choice(known)))

    keys = (
        f"quantities = {some(2, 'rotation_matrix', 'angular_velocity_body', 'rate')}",
        f"kernels = {some(2, 'numpy', 'c', 'jax', 'numba', 'forth')}",
        f"note = {some(1, 'tex', 'html', 'md', 'ipynb', 'doc')}",
        "conversions = true",
        'derivatives = ["angular_velocity_body by q", "rotation_matrix by q vjp"]',
        f"degrees = {_value(rng, 0) if rng.random() < 0.1 else 'true'}",
        f"style = {some(1, 'paper', 'audit', 'prose').strip('[]')}",
    )
    notation = ["[notation]", f"frames = {_names(rng, 2)}"] if rng.random() < 0.2 else []
    precision = f"precision = {_quoted(rng.choice(('double', 'float', 'half')))}"
    lean = ["[output.c]", precision, "libm = true", f"arrays = {_value(rng, 0)}"]
    more = lean[: rng.randrange(2, 5)] if rng.random() < 0.1 else []
    return ["[output]", *(key for key in keys if rng.random() < 0.3), *more, *notation]


def derivation_file(rng: Random) -> str:
    """A derivation file, with a wrong key, value or character now and then."""
    lines = ['title = "A top"'] if rng.random() < 0.2 else []
    lines += _rotation_table(rng) if rng.random() < 0.95 else []
    lines += _body_table(rng) if rng.random() < 0.5 else []
    lines += _output_table(rng) if rng.random() < 0.5 else []
    if rng.random() < 0.08:
        at = rng.randrange(len(lines) + 1)
        lines.insert(at, f"{rng.choice(('angles', 'mass', 'kernels', 'note'))} = {_value(rng)}")
    return spoiled(rng, "\n".join(lines) + "\n", 0.12)


def record(rng: Random) -> str:
    """A record of a derivation, with one of its values changed."""
    request: dict[str, Any] = {
        "name": "top",
        "title": None,
        "rotations": [{"sequence": "ZXZ", "angles": ["phi", "theta", "psi"]}],
        "quantities": ["rotation_matrix"],
        "kernels": ["numpy"],
        "note": ["tex"],
        "body": {"principal_moments": ["A", "A", "C"]},
        "parameters": {"A": {"positive": True}},
        "notation": {"frames": ["space", "body"]},
    }
    odd: tuple[Any, ...] = (
        None,
        [],
        {},
        [[]],
        [{}],
        0,
        -1,
        1e400,
        "",
        "é",
        [None],
        {"a": {"b": []}},
        True,
        ["ZXZ"],
    )
    at = rng.choice([*request, "extra"])
    inner = request.get(at)
    if isinstance(inner, dict) and rng.random() < 0.5:
        inner[rng.choice([*inner, "more"])] = rng.choice(odd)
    else:
        request[at] = rng.choice(odd)
    return json.dumps({"schema": "rigidsym.derivation", "schema_version": 1, "request": request})


_SWITCH: tuple[str, ...] = ()
_NUMBERS = ("1", "0.5", "2", "-1", "0", "nan", "inf")
_QUANTITIES = ("rotation_matrix", "angular_velocity_body", "quaternion", "rate_matrix_body,spin")
OPTIONS: dict[str, dict[str, tuple[str, ...]]] = {
    "derive": {
        "--only": _QUANTITIES,
        "--target": ("numpy", "c", "numpy,javascript", "fortran"),
        "--lean": _SWITCH,
        "--passive": _SWITCH,
        "--scalar-last": _SWITCH,
        "--angles": ("a,b,c", "a,b", "a,a,b", "1,2,3"),
        "--constants": ("a", "beta,gamma"),
        "--json": _SWITCH,
        "--quiet": _SWITCH,
        "--full": _SWITCH,
        "--format": ("latex", "text", "json", "xml"),
        "--rates": ("dot", "fraction", "prime"),
        "--frames": ("inertial,spacecraft", "one", "a,a"),
        "--conversions": _SWITCH,
        "--derivative": ("angular_velocity_body:q", "rotation_matrix:q:vjp", "q"),
        "--degrees": _SWITCH,
        "--style": ("paper", "audit", "poem"),
        "--templates": (".", "none"),
        "--nothing": _SWITCH,
    },
    "run": {
        "--only": _QUANTITIES,
        "--target": ("c", "jax", "numba"),
        "--quiet": _SWITCH,
        "--style": ("paper", "poem"),
        "--derivative": ("rotation_matrix:q",),
    },
    "page": {"--frames": ("inertial,spacecraft",), "--angles": ("a,b,c",), "--passive": _SWITCH},
    "eval": {
        "--quantity": ("rotation_matrix", "quaternion", "from_quaternion", "rotation_rate"),
        "--out": ("r.npy", "r.csv", "-", "r.xml", "log.csv"),
        "--columns": ("phi,theta,psi", ",".join(f"c{k}" for k in range(12))),
        "--given": ("phi=1", "phi_dot=0", "theta=x", "=1", "z=2"),
        "--keep": ("phi", "time", "r11,r12"),
        "--missing": ("nan", "drop", "error", "zero"),
        "--degrees": _SWITCH,
        "--threads": ("2", "0", "x"),
    },
    "identify": {
        "--angles": ("0.1,0.2,0.3", "10,20,30", "roll=1,pitch=2,yaw=3", "1,2", "a,b,c"),
        "--matrix": ("1,0,0,0,1,0,0,0,1", "1,2,3", "0,0,0,0,0,0,0,0,0"),
        "--quaternion": ("1,0,0,0", "0.5,0.5,0.5,0.5", "0,0,0,0", "nan,0,0,1"),
        "--rates": ("1,2,3",),
        "--omega": ("1,2,3", "0,0,0"),
        "--tolerance": _NUMBERS,
        "--all": _SWITCH,
        "--json": _SWITCH,
    },
    "inertia": {
        "--columns": ("m,x,y,z", "x,y,z", "a,b,c,d"),
        "--mass": _NUMBERS,
        "--density": _NUMBERS,
        "--scale": _NUMBERS,
        "--allow": _SWITCH,
        "--json": _SWITCH,
    },
    "simulate": {
        "--set": ("A=1", "C=0.5", "m=1", "g=9.81", "l=1", "A=-1", "A"),
        "--initial": ("theta=0.5", "psi_dot=20", "phi=nan", "chi=1"),
        "--time": _NUMBERS,
        "--samples": ("2", "100", "1"),
    },
    "check": {"--templates": (".", "none")},
    "list": {"--all": _SWITCH},
    "templates": {},
    "integrate": {"--to": ("1",)},
}
_ARGUMENTS = {
    "eval": (
        "ZXZ log.csv",
        "zyx log.csv",
        "ZXZ cloud.npy",
        "quaternion log.csv",
        "top.toml log.csv",
    ),
    "identify": ("log.csv", "cloud.npy", ""),
    "inertia": ("cloud.npy", "part.stl", "log.csv", "top.toml"),
    "simulate": ("heavy_symmetric_top", "lecture", "top.toml"),
    "run": ("top.toml", "none.toml", "top.toml top.toml", "log.csv"),
    "check": (".", "top.toml", "none"),
    "templates": ("new", "."),
    "list": ("",),
}


def command_line(rng: Random) -> list[str]:
    """A command with arguments, options and values most of which belong to it."""
    command = rng.choice(tuple(OPTIONS))
    if rng.random() < 0.85:
        words = [command, *rng.choice(_ARGUMENTS.get(command, ("ZXZ", "zyx", "ZYX"))).split()]
    else:
        words = [command, *(rotation(rng) for _ in range(rng.randrange(3)))]
    options = OPTIONS[command]
    for option in rng.sample(tuple(options), min(len(options), rng.choice((0, 1, 1, 2, 3)))):
        words.append(option)
        if options[option]:
            words.append(spoiled(rng, rng.choice(options[option]), 0.1))
    if command == "eval" and "--out" not in words and rng.random() < 0.9:
        words += ["--out", "r.npy"]
    return words
