"""Rotations as models: Euler angles, products of turns, the parametrisations, and your own matrix.

With n the angle of a turn about the unit axis e, a quaternion w + v with v = (x, y, z) is
cos(n/2) + sin(n/2) e, scalar first unless `scalar_last` is set. Three parameters are the
components of one vector: n e (rotation vector), tan(n/2) e (Gibbs) or tan(n/4) e (modified
Rodrigues parameters).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import is_identically_zero
from rigidsym.errors import ModelError, offer
from rigidsym.models.rotation import (
    AXES,
    SOURCES,
    TIME,
    Citation,
    Pullback,
    RotationModel,
    Turn,
    hat,
    product_of,
    rodrigues,
    rotation_of,
    symbolic,
    time_functions,
    unit_example,
)
from rigidsym.text.names import lettered

# Euler angles in all 24 conventions


AXIS_SEQUENCES = tuple(
    first + second + third
    for first in AXES
    for second in AXES
    for third in AXES
    if first != second != third
)
EULER_SEQUENCES = tuple(s.upper() for s in AXIS_SEQUENCES) + AXIS_SEQUENCES
DEFAULT_ANGLES = ("phi", "theta", "psi")

DIGITS = str.maketrans("123", "XYZ")  # of a sequence, which are letters in upper case
_TO_DIGITS = str.maketrans("XYZ", "123")


def EulerAngles(
    sequence: str, angles: Sequence[str] = DEFAULT_ANGLES, *, passive: bool = False
) -> RotationModel:
    """Three turns about coordinate axes, in radians.

    `sequence` is intrinsic in upper case or digits (`ZXZ`, `313`: about the turning axes, with
    R = R_z(q1) R_x(q2) R_z(q3)) and extrinsic in lower case (`zxz`: about the
    fixed axes, with R = R_z(q3) R_x(q2) R_z(q1)). `angles` are taken in the order of the turns.

    Raises ModelError for a sequence that is not one of the 24, and for angles that are not three
    different names.
    """
    letters = euler_sequence(sequence)
    coordinates = time_functions(angles, 3, "Euler angles need three different names")
    in_order = [
        Turn(axis=axis, angle=angle)
        for axis, angle in zip(letters.lower(), coordinates, strict=True)
    ]
    manner = "intrinsic" if letters.isupper() else "extrinsic"
    turns = tuple(in_order if manner == "intrinsic" else reversed(in_order))
    convention = f"Intrinsic rotations: {_in_order(turns, 'new')}."
    if manner == "extrinsic":
        equivalent = convention[0].lower() + convention[1:]
        convention = (
            f"Extrinsic rotations: {_in_order(in_order, 'fixed')}. Equivalently, {equivalent}"
        )
    return RotationModel(
        name=f"euler_{letters.lower()}_{manner}" + ("_passive" if passive else ""),
        title=f"Euler angles {letters}, {manner}" + (", passive" if passive else ""),
        convention=(convention,),
        coordinates=coordinates,
        matrix=product_of(turns),
        turns=turns,
        source=SOURCES["Landau 35" if letters == "ZXZ" else "Diebel 5"],
        passive=passive,
        request={
            "sequence": letters,
            "angles": [coordinate.func.__name__ for coordinate in coordinates],
            "passive": passive,
        },
    )


def euler_sequence(text: str) -> str:
    """The sequence in letters: `313` becomes `ZXZ`. Raises ModelError for any other text."""
    if not isinstance(text, str):
        raise ModelError(f"expected a sequence such as 'ZXZ', got {text!r}")
    letters = text.translate(DIGITS)
    if letters in EULER_SEQUENCES:
        return letters
    if letters not in (letters.upper(), letters.lower()):
        fault = "upper case is intrinsic and lower case extrinsic; do not mix them"
    elif len(letters) != 3 or not set(letters.lower()) <= set(AXES):
        fault = "expected three axes such as ZXZ (intrinsic), zxz (extrinsic) or 313 (intrinsic)"
    else:
        place = 1 if letters[0] == letters[1] else 2
        alike = [
            sequence for sequence in EULER_SEQUENCES if sequence.isupper() == letters.isupper()
        ]
        if text.isdigit():  # digits are answered in digits
            letters, alike = text, [sequence.translate(_TO_DIGITS) for sequence in alike]
        follows = f"{text[place]} follows {text[place - 1]}"
        fault = f"consecutive axes must differ: {follows}; {offer(letters, alike)}"
    raise ModelError(f"{text!r} is not an Euler sequence: {fault}")


def _in_order(turns: Sequence[Turn], which: str) -> str:
    """First by φ about the z-axis, then by θ about the new x-axis, ..."""
    steps = [f"by {turn.angle_text} about the {which} {turn.axis}-axis" for turn in turns]
    steps[0] = steps[0].replace("new ", "")
    return "first " + ", then ".join(steps)


# Products of turns of any length, about any constant axes


_NUMBERS = ("One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten")
_SOURCE = SOURCES["Goldstein 4.4"]


def chain(
    turns: Sequence[Turn] | str,
    *,
    name: str = "",
    title: str = "",
    source: Citation = _SOURCE,
    passive: bool = False,
    example: Mapping[sp.Expr, sp.Expr] = MappingProxyType({}),
) -> RotationModel:
    """R as a product of turns, left to right as given: R = R_1 R_2 ... R_n.

    The coordinates are the functions of time in the angles, in order of appearance; an angle may be
    a constant, or any combination of coordinates and constants. If components of an axis are
    symbols, the axis is a unit vector by an added condition. `example` gives exact values of such
    symbols that satisfy the conditions, where they are not found here.

    Raises ModelError if there is no turn, or none with a coordinate.
    """
    if isinstance(turns, str):
        raise ModelError(f"expected a list of rs.Turn; for a text use rs.rotation_from({turns!r})")
    if turns is None or not all(isinstance(turn, Turn) for turn in turns):
        raise ModelError(f"expected a list of rs.Turn, got {turns!r}")
    if not turns:
        raise ModelError("a chain needs at least one turn, such as z(phi)")
    moving = (sp.ordered(turn.angle.atoms(AppliedUndef)) for turn in turns)
    coordinates = tuple(dict.fromkeys(atom for atoms in moving for atom in atoms))
    if not coordinates:
        raise ModelError(
            f"{' '.join(map(str, turns))} does not move: expected an angle that is a function "
            "of time; angles are in radians, 30° is pi/6"
        )
    units = (sum(part**2 for part in turn.direction) - 1 for turn in turns)
    constraints = tuple(dict.fromkeys(c for c in units if not is_identically_zero(c)))
    letters = "".join(turn.axis if turn.axis in AXES else "u" for turn in turns)
    product = " ".join(map(str, turns))
    steps = [f"{turn.angle_text} about {turn.axis}" for turn in turns]
    convention = f"One turn: {steps[0]}."
    if len(steps) > 1:
        moved = "each about an axis that the turns before it have moved"
        convention = f"{_counted(turns)}, {moved}: first {', then '.join(steps)}."
    return RotationModel(
        name=name or f"chain_{letters}" + ("_passive" if passive else ""),
        title=title or f"{_counted(turns)} {product}" + (", passive" if passive else ""),
        convention=(convention,),
        coordinates=coordinates,
        matrix=product_of(tuple(turns)),
        turns=tuple(turns),
        constraints=constraints,
        example=axes_example(constraints, example),
        source=source,
        passive=passive,
    )


def axes_example(
    conditions: Sequence[sp.Expr], given: Mapping[sp.Expr, sp.Expr] = MappingProxyType({})
) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
    """Exact values of the symbols in the axes, which make them unit vectors one after the other."""
    values = {sp.sympify(name): sp.sympify(value) for name, value in given.items()}
    fewest = sorted(conditions, key=lambda condition: len(condition.free_symbols))
    for variant, condition in enumerate(fewest):  # n₁ s₁² + n₂ s₂² + ... − rest = 0
        squares = condition.xreplace(values)
        symbols = sorted(squares.free_symbols, key=str)
        numbers = [squares.coeff(symbol, 2) for symbol in symbols]
        rest = -squares.as_coeff_Add()[0]
        own = zip(numbers, symbols, strict=True)
        if not symbols or sp.expand(squares + rest - sum(n * s**2 for n, s in own)):
            continue
        for number, (symbol, part) in zip(numbers, unit_example(symbols, variant), strict=True):
            values[symbol] = sp.sqrt(rest / number) * part
    return tuple(values.items())


def _counted(turns: Sequence[Turn]) -> str:
    """One turn, Two turns, ..., 11 turns."""
    number = dict(enumerate(_NUMBERS, start=1)).get(len(turns), len(turns))
    return f"{number} turn{'s' * (len(turns) > 1)}"


def axis_turn(axis: Sequence[sp.Expr], angle: sp.Expr) -> Turn:
    """The turn about a constant axis that is given by its components along x, y and z.

    Raises ModelError for a zero axis and for numbers that are not a unit vector.
    """
    parts = tuple(sp.sympify(part, strict=True) for part in axis)
    square = sum(part**2 for part in parts)
    if all(part.is_number for part in parts) and not is_identically_zero(square - 1):
        raise ModelError(
            f"the axis ({', '.join(map(str, parts))}) has the length {sp.sqrt(square)}; expected a "
            "unit vector"
        )
    label = f"[{', '.join(map(str, parts))}]"
    return Turn(axis=label, angle=angle, components=parts)


def direction(parts: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The unit vector along a direction, as crystallographers write them: [1, 1, 0].

    Symbols are left as they are, for the unit condition to bind. Raises ModelError for [0, 0, 0].
    """
    exact = tuple(sp.sympify(part, strict=True) for part in parts)
    if not all(part.is_number for part in exact):
        return exact
    length = sp.sqrt(sum(part**2 for part in exact))
    if length == 0:
        raise ModelError("the axis must not be the zero vector")
    return tuple(part / length for part in exact)


# Quaternions, axis and angle, vectors along the axis, and nine cosines


SHUSTER = Citation(
    text="M. Shuster, A Survey of Attitude Representations, Journal of the Astronautical "
    "Sciences 41 (1993)"
)
_SCHAUB = Citation(
    text="H. Schaub, J. Junkins, Stereographic Orientation Parameters for Attitude Dynamics, "
    "Journal of the Astronautical Sciences 44 (1996)"
)
_GOLDSTEIN = Citation(text="H. Goldstein, Classical Mechanics (1950)", section="section 4-5")
_SCALAR = {False: "scalar first", True: "scalar last"}
_QUATERNION = "unit_quaternion({0}, {1}, {2}, {3})"
_SQUARE = "{0}**2 + {1}**2 + {2}**2"
_COSINES = ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33")


def Quaternion(
    names: Sequence[str] = ("w", "x", "y", "z"),
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """Any quaternion but zero; its length does not matter, R = (...)/(w² + v·v).

    `names` are (w, x, y, z) in this order; `scalar_last` makes the coordinates (x, y, z, w).
    Raises ModelError for bad names.
    """
    model = UnitQuaternion(names, scalar_last=scalar_last, passive=passive)
    (condition,) = model.constraints
    return replace(
        model,
        name=model.name.removeprefix("unit_"),
        title=model.title.removeprefix("Unit ").capitalize(),
        convention=(
            f"The quaternion is {_in_parts(_coordinates(names, 4))}, {_SCALAR[scalar_last]}, of "
            "any length but zero; every multiple of it is the same rotation.",
        ),
        matrix=model.matrix / (condition + 1),
        definition=model.definition.removeprefix("unit_"),
        constraints=(),
        example=(),
    )


def UnitQuaternion(
    names: Sequence[str] = ("w", "x", "y", "z"),
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """A unit quaternion, w² + v·v = 1: w = cos(n/2), v = sin(n/2) e.

    `names` are (w, x, y, z) in this order; `scalar_last` makes the coordinates (x, y, z, w).
    Raises ModelError for bad names.
    """
    w, *vector = coordinates = _coordinates(names, 4)
    return _model(
        "unit_quaternion" + ("_xyzw" if scalar_last else ""),
        f"Unit quaternion, {_SCALAR[scalar_last]}",
        f"The quaternion is {_in_parts((w, *vector))}, {_SCALAR[scalar_last]}, of length one: the "
        "cosine of half the angle and the axis times the sine of half the angle.",
        (*vector, w) if scalar_last else (w, *vector),
        rotation_of((w, *vector)),
        SHUSTER,
        passive=passive,
        constraints=(w**2 + _square(vector) - 1,),
        example=unit_example(coordinates),
        definition="unit_quaternion({3}, {0}, {1}, {2})" if scalar_last else _QUATERNION,
        vector=tuple(vector),
    )


def AxisAngle(
    names: Sequence[str] = ("e1", "e2", "e3", "phi"), *, passive: bool = False
) -> RotationModel:
    """A turn by an angle (radians) about a unit axis, both functions of time.

    `names` are the three components of the axis and the angle. Raises ModelError for bad names.
    """
    *axis, angle = _coordinates(names, 4)
    return _model(
        "axis_angle",
        "Axis and angle",
        "The axis is a unit vector, about which the body is turned by the angle.",
        (*axis, angle),
        rodrigues(tuple(axis), angle),
        SHUSTER,
        passive=passive,
        constraints=(_square(axis) - 1,),
        example=unit_example(axis),
        definition="axis_angle({0}, {1}, {2}, {3})",
        units=("", "", "", "rad"),
        vector=tuple(axis),
    )


def RotationVector(
    names: Sequence[str] = ("v1", "v2", "v3"), *, passive: bool = False
) -> RotationModel:
    """R = exp C(v): the turn by |v| radians about v.

    R = 1 + sin n/n C(v) + (1 − cos n)/n² C(v)², n = |v|. Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    square, skew = _square(vector), hat(sp.Matrix(vector))
    angle = sp.sqrt(square)
    return _model(
        "rotation_vector",
        "Rotation vector",
        "The vector v points along the axis of the turn, and its length n is the angle.",
        vector,
        sp.eye(3) + sp.sin(angle) / angle * skew + (1 - sp.cos(angle)) / square * skew * skew,
        SHUSTER,
        passive=passive,
        definition="axis_angle({0}/N, {1}/N, {2}/N, N)".replace("N", f"sqrt({_SQUARE})"),
        units=("rad",) * 3,
        vector=vector,
    )


def GibbsVector(
    names: Sequence[str] = ("g1", "g2", "g3"), *, passive: bool = False
) -> RotationModel:
    """Rodrigues' parameters g = tan(n/2) e; every rotation but the half turns.

    R = 1 + 2/(1 + g·g) (C(g) + C(g)²). Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    skew = hat(sp.Matrix(vector))
    return _model(
        "gibbs_vector",
        "Gibbs vector",
        "The vector points along the axis of the turn, and its length is the tangent of half the "
        "angle; half turns lie at infinity.",
        vector,
        sp.eye(3) + 2 / (1 + _square(vector)) * (skew + skew * skew),
        SHUSTER,
        passive=passive,
        definition="quaternion(1, {0}, {1}, {2})",
        vector=vector,
    )


def ModifiedRodrigues(
    names: Sequence[str] = ("s1", "s2", "s3"), *, passive: bool = False
) -> RotationModel:
    """Modified Rodrigues parameters s = tan(n/4) e; every rotation but whole turns.

    R = 1 + (8 C(s)² + 4 (1 − s·s) C(s))/(1 + s·s)². The shadow set −s/(s·s) is the same rotation;
    one of the two has a length of at most 1. Raises ModelError for bad names.
    """
    vector = _coordinates(names, 3)
    square, skew = _square(vector), hat(sp.Matrix(vector))
    return _model(
        "modified_rodrigues",
        "Modified Rodrigues parameters",
        "The vector points along the axis of the turn, and its length is the tangent of a quarter "
        "of the angle; the shadow set, minus the vector over the square of its length, is the "
        "same rotation.",
        vector,
        sp.eye(3) + (8 * skew * skew + 4 * (1 - square) * skew) / (1 + square) ** 2,
        _SCHAUB,
        passive=passive,
        definition="modified_rodrigues(1, {0}, {1}, {2})",
        vector=vector,
    )


def DirectionCosines(names: Sequence[str] = _COSINES, *, passive: bool = False) -> RotationModel:
    """The nine entries of R, row by row; dR/dt = C(Ω) R are Poisson's equations.

    Results are written in the entries; claims are proved with the entries as functions of a unit
    quaternion, which represents every rotation. Raises ModelError for bad names.
    """
    entries = _coordinates(names, 9)
    quaternion = UnitQuaternion(names=[f"{names[0]}_quaternion_{k}" for k in "wxyz"])
    return _model(
        "direction_cosines",
        "Direction cosines",
        "The coordinates are the nine entries of R, row by row.",
        entries,
        sp.Matrix(3, 3, entries),
        SOURCES["Goldstein 4.2"],
        passive=passive,
        pullback=Pullback(coordinates=tuple(quaternion.matrix), constraints=quaternion.constraints),
    )


def _coordinates(names: Sequence[str], count: int) -> tuple[sp.Expr, ...]:
    return time_functions(names, count, f"expected {count} different names")


def _in_parts(coordinates: Sequence[sp.Expr]) -> str:
    """A quaternion by the names of its parts, the scalar first: w + (x, y, z)."""
    scalar, *vector = (lettered(q.func.__name__) for q in coordinates)
    return f"{scalar} + ({', '.join(vector)})"


def _square(parts: Sequence[sp.Expr]) -> sp.Expr:
    return sum(part**2 for part in parts)


def _model(
    name: str,
    title: str,
    convention: str,
    coordinates: tuple[sp.Expr, ...],
    matrix: sp.MatrixBase,
    source: Citation,
    *,
    passive: bool,
    units: tuple[str, ...] = (),
    definition: str = "",
    **options: Any,
) -> RotationModel:
    """`definition` is a text with {0}, {1}, ... in place of the names of the coordinates."""
    return RotationModel(
        name=name + ("_passive" if passive else ""),
        title=title + (", passive" if passive else ""),
        convention=(convention,),
        coordinates=coordinates,
        matrix=sp.ImmutableMatrix(matrix),
        source=source,
        definition=definition.format(*(q.func.__name__ for q in coordinates)),
        units=units or ("",) * len(coordinates),
        passive=passive,
        **options,
    )


# Your own rotation, given entry by entry


GIVEN = "given by the user"  # the source of a rotation without another


def given(
    matrix: sp.MatrixBase,
    *,
    name: str,
    title: str = "",
    coordinates: Sequence[sp.Expr] = (),
    constraints: Sequence[sp.Expr] = (),
    source: str = GIVEN,
    passive: bool = False,
    example: Mapping[sp.Expr | str, Any] = MappingProxyType({}),
) -> RotationModel:
    """Your own R(q), 3x3, in functions of time; it is proved to be a rotation when derived.

    By default, `coordinates` are the functions of time in the matrix, in alphabetical order.
    With constraints, `example` gives exact values of the coordinates and constants in them, by
    name, that satisfy them: {"c": sp.Rational(3, 5), "s": sp.Rational(4, 5)} for c² + s² = 1.
    Raises ModelError for a matrix that is not 3x3 or has no coordinate, and for an invalid example.
    """
    try:
        entries = [symbolic(entry, f"{name}: an entry") for entry in sp.flatten(matrix)]
        matrix = sp.Matrix(*(matrix.shape if hasattr(matrix, "shape") else (3, 3)), entries)
    except (TypeError, ValueError):
        raise ModelError(f"{name}: expected a 3x3 matrix, got {matrix!r}") from None
    used = tuple(coordinates) or tuple(sp.ordered(matrix.atoms(AppliedUndef)))
    whole = sp.Matrix([*matrix, *constraints])
    symbols = sp.ordered((whole.free_symbols | whole.atoms(AppliedUndef)) - {TIME})
    return RotationModel(
        name=name,
        title=title or name,
        convention=("The rotation is given entry by entry.",),
        coordinates=used,
        matrix=sp.ImmutableMatrix(matrix),
        constraints=tuple(constraints),
        units=("",) * len(used),
        source=Citation(text=source),
        passive=passive,
        example=_named_example(name, example, (*used, *symbols)),
    )


def _named_example(
    model: str, given: Mapping[sp.Expr | str, Any], known: Iterable[sp.Expr]
) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
    """(symbol, value) pairs from values by name; raises ModelError for what is neither."""
    named = {_plain(symbol): symbol for symbol in known}
    pairs = []
    for name, value in ((_plain(key), value) for key, value in given.items()):
        exact = symbolic(value, f"{model}: the example of {name}")
        if name not in named:
            raise ModelError(f"{model}: the example: unknown name {name}; {offer(name, named)}")
        if not exact.is_number or exact.has(sp.Float) or exact.is_real is False:
            raise ModelError(
                f"{model}: the example of {name}: expected an exact number, got {exact}"
            )
        pairs.append((named[name], exact))
    return tuple(pairs)


def _plain(symbol: sp.Expr | str) -> str:
    return str(symbol.func if isinstance(symbol, AppliedUndef) else symbol)
