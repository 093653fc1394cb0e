"""The exact calls of SciPy and rigidsym that reproduce the data of a reading.

Each is a text of Python statements that end in `matrix` or `quaternion` and, if the data have it
and the library can, `omega`. They start from NumPy as np and from `angles` (and `rates`): the
columns of one sample in the order of the data, (3,); SciPy and rigidsym take (..., 3) too.
"""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.tools.identify.readings import (
    RATES_IN_DEGREES,
    RATES_IN_RADIANS,
    Reading,
    Velocity,
)

_CONVERSIONS = {RATES_IN_DEGREES: "np.pi / 180 * ", RATES_IN_RADIANS: "180 / np.pi * "}


def calls(reading: Reading) -> dict[str, str]:
    """The statements by library."""
    of_libraries = {"SciPy": _scipy, "rigidsym": _rigidsym}
    return {library: "\n".join(lines(reading)) for library, lines in of_libraries.items()}


def _turns(reading: Reading) -> Iterator[str]:
    """The angles and rates of the turns in their order, if they are not the columns."""
    if not reading.is_plain:
        is_in_order = [*reading.columns] == sorted(reading.columns)
        taken = "" if is_in_order else f"[..., {list(reading.columns)}]"
        taken += f" * {list(reading.signs)}" if reading.flips else ""
        yield f"turns = angles{taken}"
        if reading.velocity:
            yield f"turn_rates = rates{taken}"


def _angles(reading: Reading) -> str:
    return "angles" if reading.is_plain else "turns"


def _rates(reading: Reading) -> str:
    return "rates" if reading.is_plain else "turn_rates"


def _radians(reading: Reading) -> str:
    return f"np.radians({_angles(reading)})" if reading.degrees else _angles(reading)


def _scipy(reading: Reading) -> Iterator[str]:
    degrees = ", degrees=True" if reading.degrees else ""
    inverse = ".inv()" if reading.passive else ""
    yield "from scipy.spatial.transform import Rotation"
    yield from _turns(reading)
    arguments = f'"{reading.sequence}", {_angles(reading)}{degrees}'
    yield f"rotation = Rotation.from_euler({arguments}){inverse}"
    if reading.scalar_last is None:
        yield "matrix = rotation.as_matrix()"
    else:
        yield f"quaternion = rotation.as_quat(scalar_first={not reading.scalar_last})"
    if reading.velocity:
        yield "# SciPy has no angular velocity from the rates of Euler angles."


def _rigidsym(reading: Reading) -> Iterator[str]:
    passive = ", passive=True" if reading.passive else ""
    yield "import rigidsym as rs"
    yield from _turns(reading)
    yield f'model = rs.EulerAngles("{reading.sequence}"{passive})'
    if reading.scalar_last is None:
        yield "kernels = rs.derive(model).kernels().load()"
        yield f"matrix = kernels.rotation_matrix({_radians(reading)})"
    else:
        conjugate = " * [1, -1, -1, -1]" if reading.passive else ""
        yield "kernels = rs.derive(model).kernels(conversions=True).load()"
        yield f"quaternion = kernels.quaternion({_radians(reading)}){conjugate}"
        if reading.scalar_last:
            yield "quaternion = quaternion[..., [1, 2, 3, 0]]"
    if reading.velocity:
        name = f"angular_velocity_{reading.velocity.frame}"
        yield f"omega = kernels.{name}({_radians(reading)}, {_rates(reading)})"
        yield from _scaled(reading.velocity)


def _scaled(velocity: Velocity) -> Iterator[str]:
    """Ω with the sign and the unit of the data, if they differ."""
    factor = ("-" if velocity.is_opposite else "") + _CONVERSIONS.get(velocity.units, "")
    if factor:
        yield f"omega = {factor}omega"
