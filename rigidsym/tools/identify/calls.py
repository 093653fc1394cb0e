"""The exact calls of SciPy, SymPy and rigidsym that reproduce the data of a reading.

Each is a text of Python statements that end in `matrix` or `quaternion` and, where the data have
it and the library can, `omega`. They start from NumPy as np and from `angles` (and `rates`): the
columns of one sample in the order of the data, (3,); SciPy and rigidsym take (..., 3) too.
"""

from __future__ import annotations

from collections.abc import Iterator

from rigidsym.tools.identify.readings import RATES_IN_DEGREES, RATES_IN_RADIANS, Reading, Velocity

_FRAME, _QUATERNION = "sympy.physics.vector import ReferenceFrame", "sympy import Quaternion"
_CONVERSIONS = {RATES_IN_DEGREES: "np.pi / 180 * ", RATES_IN_RADIANS: "180 / np.pi * "}


def calls(reading: Reading) -> dict[str, str]:
    """The statements by library."""
    velocity = reading.velocity
    sympy = _sympy_motion(reading, velocity) if velocity else _sympy(reading)
    statements = {"SciPy": _scipy(reading), "SymPy": sympy, "rigidsym": _rigidsym(reading)}
    return {library: "\n".join(lines) for library, lines in statements.items()}


def _turns(reading: Reading) -> Iterator[str]:
    """The angles and rates of the turns in their order, where they are not the columns."""
    if not reading.is_plain:
        for columns in ("angles", "rates") if reading.velocity else ("angles",):
            taken = f"{columns}[..., {list(reading.columns)}] * {list(reading.signs)}"
            yield f"{_name(reading, columns)} = {taken}"


def _name(reading: Reading, columns: str) -> str:
    return columns if reading.is_plain else {"angles": "turns", "rates": "turn_rates"}[columns]


def _radians(reading: Reading) -> str:
    turns = _name(reading, "angles")
    return f"np.radians({turns})" if reading.degrees else turns


def _scipy(reading: Reading) -> Iterator[str]:
    degrees = ", degrees=True" if reading.degrees else ""
    inverse = ".inv()" if reading.passive else ""
    turns = _name(reading, "angles")
    yield "from scipy.spatial.transform import Rotation"
    yield from _turns(reading)
    yield f'rotation = Rotation.from_euler("{reading.sequence}", {turns}{degrees}){inverse}'
    if reading.scalar_last is None:
        yield "matrix = rotation.as_matrix()"
    else:
        yield f"quaternion = rotation.as_quat(scalar_first={not reading.scalar_last})"
    if reading.velocity:
        yield "# SciPy has no angular velocity from the rates of Euler angles."


def _sympy(reading: Reading) -> Iterator[str]:
    is_matrix = reading.scalar_last is None
    yield f"from {_FRAME if is_matrix else _QUATERNION}"
    yield from _turns(reading)
    if is_matrix:
        yield from _sympy_frames(reading, f"list({_radians(reading)})")
        yield f"matrix = {_sympy_matrix(reading)}"
    else:
        yield from _sympy_quaternion(reading)


def _sympy_frames(reading: Reading, turns: str) -> Iterator[str]:
    manner = "Body" if reading.is_intrinsic else "Space"
    yield 'N = ReferenceFrame("N")'
    yield f'B = N.orientnew("B", "{manner}", {turns}, "{reading.sequence.upper()}")'


def _sympy_matrix(reading: Reading) -> str:
    return "B.dcm(N)" if reading.passive else "N.dcm(B)"


def _sympy_quaternion(reading: Reading) -> Iterator[str]:
    conjugate = ".conjugate()" if reading.passive else ""
    order = "p.b, p.c, p.d, p.a" if reading.scalar_last else "p.a, p.b, p.c, p.d"
    yield f'p = Quaternion.from_euler(list({_radians(reading)}), "{reading.sequence}"){conjugate}'
    yield f"quaternion = [{order}]"


def _sympy_motion(reading: Reading, velocity: Velocity) -> Iterator[str]:
    """With rates the angles are functions of time, and their values are put in last."""
    if reading.scalar_last is not None:
        yield f"from {_QUATERNION}"
    yield "from sympy.physics.mechanics import ReferenceFrame, dynamicsymbols, msubs"
    yield from _turns(reading)
    yield 'q = dynamicsymbols("q1:4")'
    yield f"at = dict(zip(q, {_radians(reading)}))"
    yield f"rates_at = dict(zip([x.diff() for x in q], {_name(reading, 'rates')}))"
    yield from _sympy_frames(reading, "q")
    if reading.scalar_last is None:
        yield f"matrix = msubs({_sympy_matrix(reading)}, at)"
    else:
        yield from _sympy_quaternion(reading)
    frame = "N" if velocity.frame == "space" else "B"
    yield f"omega = msubs(B.ang_vel_in(N).to_matrix({frame}), rates_at, at)"
    yield from _scaled(velocity)


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
        yield f"omega = kernels.{name}({_radians(reading)}, {_name(reading, 'rates')})"
        yield from _scaled(reading.velocity)


def _scaled(velocity: Velocity) -> Iterator[str]:
    """Ω in the sign and the unit of the data, where it is not so already."""
    factor = ("-" if velocity.is_opposite else "") + _CONVERSIONS.get(velocity.units, "")
    if factor:
        yield f"omega = {factor}omega"
