"""The rotations by name, and from the text in a file or a command to a rotation model."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import exact_angle
from rigidsym.errors import AlgebraError, ExpressionError, ModelError
from rigidsym.models.parametrisations import (
    DEFAULT_ANGLES,
    DIGITS,
    EULER_SEQUENCES,
    PARAMETRISATIONS as PARAMETRISATIONS,
    EulerAngles,
    axis_turn,
    chain,
    given,
    parametrised,
)
from rigidsym.models.rotation import (
    AXES,
    SOURCES,
    WORDS,
    Citation,
    RotationModel,
    Turn,
    product_of,
    time_function,
)
from rigidsym.system.records import NamedTuple
from rigidsym.text.expression import names_in, parse_expression, parse_turns
from rigidsym.text.names import check_name


class Preset(NamedTuple):
    """The Euler angles of one text, an entry of rotations.toml."""

    sequence: str
    about: str
    source: Citation
    names: Sequence[str] = DEFAULT_ANGLES
    passive: bool = False
    z_down: bool = False  # whether its z-axis points to the ground


PRESETS: Mapping[str, Preset] = {
    name: Preset(**entry | {"source": SOURCES[entry["source"]]})
    for name, entry in WORDS["presets"].items()
}
LONGEST = 900  # characters of a sequence or of turns
_AT_REST = re.compile(r".*\D0")  # a name that ends in 0: alpha0, b_0; not a_10
_SHOWN = 40  # characters of a wrong text that a message repeats
ALIASES = {"mrp": "modified_rodrigues", "quat": "quaternion", "rotvec": "rotation_vector"}
_A_ROTATION = 'a sequence such as "ZXZ", turns such as "z(phi) x(theta)", or a name'


def rotation_from(
    text: str,
    *,
    names: Sequence[str] | None = None,
    constants: Sequence[str] = (),
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """The rotation that a text describes: an Euler sequence, turns, a parametrisation, a preset.

    `names` are names of the coordinates; turns contain their names. In turns, a name is a
    coordinate, unless it is among `constants` or ends in 0 (`alpha0`, but not `a_10`), and
    the components of an axis are constants. Raises ModelError or ExpressionError, which say what
    was expected.
    """
    if not isinstance(text, str):
        raise ModelError(f"expected {_A_ROTATION}, got {text!r}")
    if len(text) > LONGEST:
        raise ModelError(f"expected {_A_ROTATION}, got {len(text)} characters")
    if constants and "(" not in text:
        raise ModelError(f"{text} has no constants; they go with turns such as z(phi) x(incline)")
    name = text.strip().lower().replace("-", "_").replace(" ", "_")
    name = ALIASES.get(name, name)
    # The spelling is lenient for names, but upper and lower case matter in a sequence: ZXZ is
    # intrinsic and zxz is extrinsic.
    entry, preset = PARAMETRISATIONS.get(name), PRESETS.get(name)
    if scalar_last and "{scalar}" not in (entry.title if entry else ""):
        raise ModelError(f"scalar-last applies only to quaternions; {text} is not one")
    if "(" in text:
        model = _turned(text, names, constants, passive)
    elif entry:
        model = parametrised(name, names, scalar_last=scalar_last, passive=passive)
    elif preset:
        model = replace(
            # The transpose of a transposed matrix is R again, so two flags cancel each other.
            EulerAngles(preset.sequence, names or preset.names, passive=preset.passive != passive),
            name=name + "_transposed" * passive,
            title=preset.about[0].upper() + preset.about[1:] + ", transposed" * passive,
            source=preset.source,
            z_down=preset.z_down,
            request={},
        )
    else:
        letters = text.translate(DIGITS)
        if len(letters) != 3 or not set(letters.lower()) <= {*AXES}:
            from difflib import get_close_matches  # few commands end with a message

            excerpt = text if len(text) <= _SHOWN else text[:_SHOWN] + "…"
            near = get_close_matches(text.lower(), [*PARAMETRISATIONS, *PRESETS], n=1)
            bare = re.sub(r"[\W_]", "", text)  # Z-Y-X, 3-1-3
            near = [bare] if bare.translate(DIGITS) in EULER_SEQUENCES else near
            meant = f"expected {_A_ROTATION} (`rigidsym list`)"
            meant = f"did you mean {near[0]}?" if near else meant
            raise ModelError(f"{excerpt!r} is not a rotation\n{meant}")
        model = EulerAngles(text, DEFAULT_ANGLES if names is None else names, passive=passive)
    if model.request:
        return model  # Euler angles know what asks for them
    return _asked_for(
        model,
        sequence=name if name in ALIASES.values() else text,
        angles=names and list(names),
        constants=list(constants),
        scalar_last=scalar_last,
        passive=passive,
    )


def _asked_for(model: RotationModel, **request: Any) -> RotationModel:
    """The model with what asks for it in a file."""
    return replace(model, request={key: value for key, value in request.items() if value})


def rotation_given(
    rows: Sequence[Sequence[str]],
    *,
    name: str,
    coordinates: Sequence[str],
    constraints: Sequence[str] = (),
    passive: bool = False,
    example: Mapping[str, str] = MappingProxyType({}),
) -> RotationModel:
    """Your own R(q): nine expressions by rows, in the coordinates; other names are constants.

    `constraints` are expressions that vanish for all time, `example` values by name for which
    they do. Raises ModelError or ExpressionError.
    """
    if len(rows) != 3 or any(len(row) != 3 for row in rows):
        raise ModelError("a rotation matrix has three rows of three expressions")
    functions = {check_name(q): time_function(check_name(q)) for q in coordinates}
    if len(functions) != len(coordinates):
        raise ModelError(f"a coordinate is named twice: {', '.join(coordinates)}")
    model = given(
        sp.Matrix([[read_part(text, functions) for text in row] for row in rows]),
        name=name,
        coordinates=tuple(functions.values()),
        constraints=[read_part(text, functions) for text in constraints],
        passive=passive,
        example={check_name(key): parse_expression(text, {}) for key, text in example.items()},
    )
    return _asked_for(
        model,
        matrix=[list(row) for row in rows],
        coordinates=list(functions),
        constraints=list(constraints),
        passive=passive,
        example=dict(example),
    )


def read_part(text: str, coordinates: Iterable[str]) -> sp.Expr:
    """The expression in a text, whose names are coordinates or constants."""
    names = {
        name: time_function(name) if name in coordinates else sp.Symbol(check_name(name))
        for name in names_in(text)
    }
    return parse_expression(text, names)


def turned_by(text: str) -> sp.ImmutableMatrix:
    """The matrix R (3, 3) of constant turns, "z(pi/4) x(alpha)" or "[1,1,0](pi/3)".

    Raises ModelError or ExpressionError for another text.
    """
    if "(" not in text:
        raise ModelError(f'expected turns such as "z(pi/4) x(alpha)", got {text!r}')
    turns = tuple(_turn(*each, lambda n: sp.Symbol(check_name(n))) for each in parse_turns(text))
    if any(part.free_symbols for turn in turns for part in turn.components):
        raise ExpressionError(f"{text}: expected an axis with numbers as components")
    return product_of(turns)


def request_of(model: RotationModel) -> Mapping[str, Any]:
    """What asks for the model again; raises ModelError for one that no text asks for."""
    if model.request:
        return model.request
    raise ModelError(f"{model.name} was made in Python; no derivation file can ask for it")


def _turned(
    text: str, names: Sequence[str] | None, constants: Sequence[str], passive: bool
) -> RotationModel:
    if names is not None:
        raise ModelError(f"{text} names its angles itself; leave the other names out")

    def symbol(name: str) -> sp.Expr:
        plain = check_name(name)
        is_fixed = plain in constants or _AT_REST.fullmatch(plain)
        return sp.Symbol(plain) if is_fixed else time_function(plain)

    try:
        turns = [_turn(*turn, symbol) for turn in parse_turns(text)]
    except ExpressionError as error:
        raise ExpressionError(f"column {error.column}: {error.message}") from None
    letters = "".join(turn.axis for turn in turns).upper()
    angles = [turn.angle for turn in turns]
    # Three turns by three different coordinates are Euler angles, with their name, source and
    # conversions; otherwise the same text would be a chain.
    is_euler = letters in EULER_SEQUENCES and len(set(angles)) == len(angles)
    if is_euler and all(isinstance(angle, AppliedUndef) for angle in angles):
        return EulerAngles(letters, [angle.func.__name__ for angle in angles], passive=passive)
    return chain(turns, passive=passive)


def _turn(axis: str, angle: str, column: int, symbol: Callable[[str], sp.Expr]) -> Turn:
    """One turn, with the symbols of the names in its angle; those in an axis are constants."""
    try:
        value = parse_expression(angle, {name: symbol(name) for name in names_in(angle)})
        exact_angle(value)
    except AlgebraError as error:
        raise ExpressionError(str(error), column=column) from None
    except ExpressionError as error:
        # From the column inside the angle to the column in the whole text.
        raise ExpressionError(error.message, column=column + error.column - 1) from None
    if axis in AXES:
        return Turn(axis=axis, angle=value)
    parts = axis[1:-1].split(",")
    if len(parts) != 3:
        raise ExpressionError(f"the axis {axis} has {len(parts)} components; expected three")
    turn = axis_turn([read_part(part, ()) for part in parts], value)
    return replace(turn, axis=f"[{','.join(part.strip() for part in parts)}]")
