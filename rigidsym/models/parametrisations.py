"""Rotations as models: Euler angles, products of turns, the parametrisations, and your own matrix.

The words of the parametrisations, and what their coordinates mean, are in rotations.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from types import MappingProxyType
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import is_identically_zero
from rigidsym.errors import ExpressionError, ModelError, offer
from rigidsym.models.rotation import (
    AXES,
    SOURCES,
    TIME,
    WORDS,
    Citation,
    Pullback,
    RotationModel,
    Turn,
    hat,
    product_of,
    rodrigues,
    rotation_of,
    symbolic,
    time_function,
    unit_example,
)
from rigidsym.system.records import NamedTuple
from rigidsym.text.names import check_name, lettered

Example = tuple[tuple[sp.Expr, sp.Expr], ...]  # symbols and their values


def _coordinates(names: Sequence[str], count: int, expected: str) -> tuple[sp.Expr, ...]:
    """The functions of time of plain names; raises ModelError unless `count` different ones."""
    try:
        plain = [check_name(name) for name in names] if isinstance(names, Sequence) else []
    except ExpressionError as error:
        raise ModelError(str(error)) from error
    if len(plain) != count or len(set(plain)) != count:
        raise ModelError(f"{expected}, got {', '.join(plain) or repr(names)}")
    return tuple(map(time_function, plain))


def _model(
    name: str, title: str, convention: str, *, passive: bool, **fields: Any
) -> RotationModel:
    return RotationModel(
        name=name + "_passive" * passive,
        title=title + ", passive" * passive,
        convention=(convention,),
        passive=passive,
        **fields,
    )


# Euler angles in all 24 conventions


# Only neighbours must differ, 3·2·2 = 12 sequences: the first and the last axis may be the same
# (proper Euler angles, zxz) or not (Tait-Bryan angles, zyx).
AXIS_SEQUENCES = tuple(a + b + c for a, b, c in product(AXES, repeat=3) if a != b != c)
EULER_SEQUENCES = tuple(s.upper() for s in AXIS_SEQUENCES) + AXIS_SEQUENCES
DEFAULT_ANGLES = ("phi", "theta", "psi")

DIGITS = str.maketrans("123", "XYZ")  # of a sequence, which are letters in upper case


def EulerAngles(
    sequence: str, angles: Sequence[str] = DEFAULT_ANGLES, *, passive: bool = False
) -> RotationModel:
    """Three turns about coordinate axes, in radians.

    Parameters
    ----------
    sequence
        Intrinsic in upper case or digits (`ZXZ`, `313`: about the turning axes, with
        R = R_z(q1) R_x(q2) R_z(q3)), extrinsic in lower case (`zxz`: about the fixed axes, with
        R = R_z(q3) R_x(q2) R_z(q1)).
    angles
        Their names, in the order of the turns.
    passive
        Whether the transpose of R is presented, the direction cosine matrix.

    Raises
    ------
    ModelError
        For a sequence that is not one of the 24, and unless there are three different names.

    Examples
    --------
    >>> EulerAngles("ZYX", angles=("yaw", "pitch", "roll")).product
    'Rz(yaw) Ry(pitch) Rx(roll)'
    """
    letters = _euler_sequence(sequence)
    coordinates = _coordinates(angles, 3, "Euler angles need three different names")
    in_order = [Turn(axis=a, angle=q) for a, q in zip(letters.lower(), coordinates, strict=True)]
    is_intrinsic = letters.isupper()
    # A turn about an axis of the body multiplies from the right, one about an axis in space from
    # the left. So extrinsic turns are the intrinsic ones in the reverse order.
    turns = tuple(in_order if is_intrinsic else in_order[::-1])
    about_new = _in_order(turns, "new").replace("new ", "", 1)
    if is_intrinsic:
        manner, convention = "intrinsic", f"Intrinsic rotations: {about_new}."
    else:
        manner, about_fixed = "extrinsic", _in_order(in_order, "fixed")
        convention = (
            f"Extrinsic rotations: {about_fixed}. Equivalently, intrinsic rotations: {about_new}."
        )
    return _model(
        f"euler_{letters.lower()}_{manner}",
        f"Euler angles {letters}, {manner}",
        convention,
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


def _euler_sequence(text: str) -> str:
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
        alike = [s for s in EULER_SEQUENCES if s.isupper() == letters.isupper()]
        follows = f"{text[place]} follows {text[place - 1]}"
        fault = f"consecutive axes must differ: {follows}; {offer(letters, alike)}"
    raise ModelError(f"{text!r} is not an Euler sequence: {fault}")


def _in_order(turns: Sequence[Turn], which: str) -> str:
    """First by φ about the new z-axis, then by θ about the new x-axis, ..."""
    steps = (f"by {turn.angle_text} about the {which} {turn.axis}-axis" for turn in turns)
    return "first " + ", then ".join(steps)


# Products of turns of any length, about any constant axes


_NUMBERS = ("One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten")


def chain(turns: Sequence[Turn], *, passive: bool = False) -> RotationModel:
    """R as a product of turns, left to right as given: R = R_1 R_2 ... R_n.

    The coordinates are the functions of time in the angles, in order of appearance; an angle may be
    a constant, or any combination of coordinates and constants. If components of an axis are
    symbols, the axis is a unit vector by an added condition.

    Raises ModelError if there is no turn, or none with a coordinate.
    """
    if turns is None or not all(isinstance(turn, Turn) for turn in turns):
        raise ModelError(f"expected a list of rs.Turn, got {turns!r}; a text is rotation_from's")
    if not turns:
        raise ModelError("a chain needs at least one turn, such as z(phi)")
    written = " ".join(map(str, turns))
    moving = (sp.ordered(turn.angle.atoms(AppliedUndef)) for turn in turns)
    # Each coordinate once, in the order of the turns; `ordered` decides only inside one angle.
    coordinates = tuple(dict.fromkeys(atom for atoms in moving for atom in atoms))
    if not coordinates:
        raise ModelError(
            f"{written} does not move: expected an angle that is a function of time; angles are "
            "in radians, 30° is pi/6"
        )
    # Rodrigues' formula is a rotation only for unit axes. Axes in numbers are unit vectors already;
    # those in symbols add the condition n·n = 1.
    units = (_square(turn.direction) - 1 for turn in turns)
    constraints = tuple(dict.fromkeys(c for c in units if not is_identically_zero(c)))
    letters = "".join(turn.axis if turn.axis in AXES else "u" for turn in turns)
    steps = [f"{turn.angle_text} about {turn.axis}" for turn in turns]
    count = dict(enumerate(_NUMBERS, 1)).get(len(steps), len(steps))
    words = WORDS["chains"]["several" if steps[1:] else "single"]
    convention = words.format(count=count, steps=", then ".join(steps))
    return _model(
        f"chain_{letters}",
        f"{count} turn{'s' * (len(steps) > 1)} {written}",
        convention,
        coordinates=coordinates,
        matrix=product_of(tuple(turns)),
        turns=tuple(turns),
        constraints=constraints,
        example=_axes_example(constraints),
        source=SOURCES["Goldstein 4.4"],
        passive=passive,
    )


def _axes_example(conditions: Sequence[sp.Expr]) -> Example:
    """Exact values of the symbols in the axes, which make them unit vectors one after the other."""
    values: dict[sp.Expr, sp.Expr] = {}
    # Axes may share symbols. With the fewest symbols first, each condition leaves one to solve for.
    for condition in sorted(conditions, key=lambda condition: len(condition.free_symbols)):
        *others, last = sorted(condition.xreplace(values).free_symbols, key=str) or [None]
        values |= {symbol: sp.Rational(1, sp.prime(k)) for k, symbol in enumerate(others, 3)}
        if last is not None:
            equation = condition.xreplace(values)
            roots = [root for root in sp.solve(equation, last) if root.is_real]
            if not roots:
                chosen = "".join(f", {symbol} = {value}" for symbol, value in values.items())
                unsolved = f"no real {last} solves {equation} = 0{chosen}"
                raise ModelError(f"the axis cannot have the length 1: {unsolved}")
            values[last] = roots[-1]
    return tuple(values.items())


def axis_turn(axis: Sequence[sp.Expr], angle: sp.Expr) -> Turn:
    """The turn about a constant axis by its components along x, y and z, made a unit vector.

    Symbols are left as they are, for the unit condition to bind. Raises ModelError for a zero axis.
    """
    parts = tuple(sp.sympify(part, strict=True) for part in axis)
    square = _square(parts)
    if square == 0:
        raise ModelError("the axis must not be the zero vector")
    if square.is_number and not is_identically_zero(square - 1):
        parts = tuple(part / sp.sqrt(square) for part in parts)
    return Turn(axis=f"[{', '.join(map(str, parts))}]", angle=angle, components=parts)


# Quaternions, axis and angle, vectors along the axis, and nine cosines


class Parametrisation(NamedTuple):
    """An entry of rotations.toml."""

    title: str
    convention: str
    coordinates: str  # their names, unless others are asked for
    product: str  # R written out
    source: str  # in SOURCES
    definition: str = ""  # R as certificates name it
    vector: str = ""  # the coordinates that are the components of one vector
    unit: str = ""  # the coordinates whose squares add up to one
    radians: str = ""  # the coordinates that are angles
    pullback: str = ""  # the parametrisation that claims are proved in


def _square(parts: Sequence[sp.Expr]) -> sp.Expr:
    return sum(part**2 for part in parts)


def _exponential(v: Sequence[sp.Expr]) -> sp.Matrix:
    # exp C(v) = 1 + (sin n / n) C(v) + ((1 − cos n)/n²) C(v)² with n = |v|
    n, skew = sp.sqrt(_square(v)), hat(v)
    return sp.eye(3) + sp.sin(n) / n * skew + (1 - sp.cos(n)) / n**2 * skew * skew


# Rodrigues' formula for the axis e and the angle β, in half angles for g = e tan(β/2) and in
# quarter angles for s = e tan(β/4): no roots, and the rotations by π and 2π respectively are at
# infinity.
def _gibbs(g: Sequence[sp.Expr]) -> sp.Matrix:
    skew = hat(g)
    return sp.eye(3) + 2 / (1 + _square(g)) * (skew + skew * skew)


def _modified_rodrigues(s: Sequence[sp.Expr]) -> sp.Matrix:
    square, skew = _square(s), hat(s)
    return sp.eye(3) + (8 * skew * skew + 4 * (1 - square) * skew) / (1 + square) ** 2


_MATRICES: Mapping[str, Callable[[Sequence[sp.Expr]], sp.MatrixBase]] = {
    # Over |q|², every multiple of a quaternion gives the same rotation.
    "quaternion": lambda q: rotation_of(q) / _square(q),
    "unit_quaternion": rotation_of,
    "axis_angle": lambda q: rodrigues(tuple(q[:3]), q[3]),
    "rotation_vector": _exponential,
    "gibbs_vector": _gibbs,
    "modified_rodrigues": _modified_rodrigues,
    "direction_cosines": lambda entries: sp.Matrix(3, 3, entries),
}
PARAMETRISATIONS: Mapping[str, Parametrisation] = {
    name: Parametrisation(**entry) for name, entry in WORDS["parametrisations"].items()
}


def parametrised(
    name: str,
    names: Sequence[str] | None = None,
    *,
    scalar_last: bool = False,
    passive: bool = False,
) -> RotationModel:
    """A rotation in one of the PARAMETRISATIONS.

    Parameters
    ----------
    name
        Its key there.
    names
        Of the coordinates, a quaternion's scalar first.
    scalar_last
        Whether the coordinates are (x, y, z, w).
    passive
        Whether the transpose of R is presented.

    Raises
    ------
    ModelError
        Unless there are as many different names as coordinates.
    """
    entry = PARAMETRISATIONS[name]
    default = entry.coordinates.split()
    expected = f"expected {len(default)} different names"
    q = _coordinates(default if names is None else names, len(default), expected)
    by_default = dict(zip(default, q, strict=True))
    vector, unit = (
        tuple(by_default[part] for part in parts.split()) for parts in (entry.vector, entry.unit)
    )
    words = {part: value.func.__name__ for part, value in by_default.items()}
    words["n"] = f"sqrt({' + '.join(f'{part.func.__name__}**2' for part in vector)})"
    words["scalar"] = "scalar last" if scalar_last else "scalar first"
    first, *others = (lettered(part.func.__name__) for part in q)
    words["quaternion"] = f"{first} + ({', '.join(others)})"
    pullback = None
    if entry.pullback:
        quaternion = PARAMETRISATIONS[entry.pullback].coordinates.split()
        # Every matrix with R Rᵀ = 1 and det R = 1 comes from a unit quaternion, so the nine entries
        # may be replaced by its polynomials.
        own = [f"{words[default[0]]}_quaternion_{part}" for part in quaternion]
        other = parametrised(entry.pullback, own)
        pullback = Pullback(coordinates=tuple(other.matrix), constraints=other.constraints)
    return _model(
        name + "_xyzw" * scalar_last,
        entry.title.format(**words),
        entry.convention.format(**words),
        coordinates=(*q[1:], q[0]) if scalar_last else q,
        matrix=sp.ImmutableMatrix(_MATRICES[name](q)),
        source=SOURCES[entry.source],
        definition=entry.definition.format(**words),
        constraints=(_square(unit) - 1,) if unit else (),
        example=unit_example(unit) if unit else (),
        units=tuple("rad" if part in entry.radians.split() else "" for part in default),
        vector=vector,
        pullback=pullback,
        passive=passive,
    )


# Your own rotation, given entry by entry


GIVEN = "given by the user"  # the source of a rotation without another


def given(
    matrix: sp.MatrixBase,
    *,
    name: str,
    coordinates: Sequence[sp.Expr] = (),
    constraints: Sequence[sp.Expr] = (),
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
    named = {_plain(symbol): symbol for symbol in (*used, *symbols)}
    values = {}
    for key, value in ((_plain(key), value) for key, value in example.items()):
        exact = symbolic(value, f"{name}: the example of {key}")
        if key not in named:
            raise ModelError(f"{name}: the example: unknown name {key}; {offer(key, named)}")
        if not exact.is_number or exact.has(sp.Float) or exact.is_real is False:
            raise ModelError(f"{name}: the example of {key}: expected an exact number, got {exact}")
        values[named[key]] = exact
    return RotationModel(
        name=name,
        title=name,
        convention=(WORDS["chains"]["by_entries"],),
        coordinates=used,
        matrix=sp.ImmutableMatrix(matrix),
        constraints=tuple(constraints),
        units=("",) * len(used),
        source=Citation(text=GIVEN),
        passive=passive,
        example=tuple(values.items()),
    )


def _plain(symbol: sp.Expr | str) -> str:
    return str(symbol.func if isinstance(symbol, AppliedUndef) else symbol)
