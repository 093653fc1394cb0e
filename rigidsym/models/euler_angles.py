"""The rotations that come with the package: Euler angles in all 24 conventions."""

from __future__ import annotations

from collections.abc import Sequence

from rigidsym.errors import ModelError
from rigidsym.models.rotation import AXES, SOURCES, RotationModel, Turn, product_of, time_functions
from rigidsym.text.names import lettered

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
    return RotationModel(
        name=f"euler_{letters.lower()}_{manner}" + ("_passive" if passive else ""),
        title=f"Euler angles {letters}, {manner}" + (", passive" if passive else ""),
        convention=(_order_in_words(manner, in_order),),
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
    if letters not in EULER_SEQUENCES:
        raise ModelError(f"{text!r} is not an Euler sequence: {_what_is_wrong(text)}")
    return letters


def _what_is_wrong(text: str) -> str:
    letters = text.translate(DIGITS)
    if letters not in (letters.upper(), letters.lower()):
        return "upper case is intrinsic and lower case extrinsic; do not mix them"
    if len(letters) != 3 or not set(letters.lower()) <= set(AXES):
        return "expected three axes such as ZXZ (intrinsic), zxz (extrinsic) or 313 (intrinsic)"
    place = 1 if letters[0] == letters[1] else 2
    return f"consecutive axes must differ: {text[place]} follows {text[place - 1]}"


def _order_in_words(manner: str, turns: Sequence[Turn]) -> str:
    """The turns in the order in which the body makes them."""
    angles = [lettered(turn.angle.func.__name__) for turn in turns]
    axes = [f"the {'fixed' if manner == 'extrinsic' else 'turned'} {turn.axis}" for turn in turns]
    axes[0] = axes[0].replace("the turned ", "")
    about = [f"{angle} about {axis}" for angle, axis in zip(angles, axes, strict=True)]
    return f"{manner.capitalize()} turns: first {about[0]}, then {about[1]}, then {about[2]}."
