"""How logs name the components of angles, rates, angular velocities and attitudes."""

from __future__ import annotations

from itertools import product

Names = tuple[str, ...]

RATES = ("{}_dot", "{}_rate", "d_{}")
_ACCELERATIONS = ("{}_ddot", "{}_accel", "dd_{}")
ANGLES: tuple[Names, ...] = (
    ("angle1", "angle2", "angle3"),
    ("a1", "a2", "a3"),
    ("roll", "pitch", "yaw"),
    ("roll", "pitch", "heading"),
    ("phi", "theta", "psi"),
    ("alpha", "beta", "gamma"),
    ("rx", "ry", "rz"),
)
_INDICES = tuple(f"{row}{column}" for row, column in product("123", repeat=2))
MATRICES: tuple[Names, ...] = (
    *(tuple(letter + index for index in _INDICES) for letter in ("r", "m", "a", "c", "dcm")),
    tuple(f"rotation_matrix_{index}" for index in _INDICES),
)
NAMED_QUATERNIONS: tuple[Names, ...] = (  # whose names tell which is the scalar
    ("qw", "qx", "qy", "qz"),
    ("w", "x", "y", "z"),
    ("orientation_w", "orientation_x", "orientation_y", "orientation_z"),
    ("rotation_w", "rotation_x", "rotation_y", "rotation_z"),
)
QUATERNIONS: tuple[Names, ...] = (
    *NAMED_QUATERNIONS,
    ("q0", "q1", "q2", "q3"),
    ("q1", "q2", "q3", "q4"),
    ("quaternion1", "quaternion2", "quaternion3", "quaternion4"),
)
OMEGAS: tuple[Names, ...] = (
    ("omega1", "omega2", "omega3"),
    ("omegax", "omegay", "omegaz"),
    ("wx", "wy", "wz"),
    ("gyrox", "gyroy", "gyroz"),
    ("p", "q", "r"),
    ("angular_velocity_x", "angular_velocity_y", "angular_velocity_z"),
    ("gyrx", "gyry", "gyrz"),  # ArduPilot
    ("gyro_rad_0", "gyro_rad_1", "gyro_rad_2"),  # PX4
    ("xyz_0", "xyz_1", "xyz_2"),  # PX4, vehicle_angular_velocity
)


def _quantity(name: str) -> Names:
    """The columns of a vector that `eval` or `simulate` has written."""
    return (f"{name}_1", f"{name}_2", f"{name}_3")


_GROUPS = {
    "omega_space": (_quantity("angular_velocity_space"), *OMEGAS),
    "omega_body": (_quantity("angular_velocity_body"), *OMEGAS),
    "quaternion": QUATERNIONS[:5],
    "matrix": MATRICES,
}


def groups_of(argument: str, names: Names) -> tuple[Names, ...]:
    """How the components of an argument of a function may be called together, own names first.

    Of a scalar-last quaternion, only by names that tell which is the scalar: q0 would be x or w.
    """
    if argument == "quaternion" and names[-1] == "qw":
        return names, *((*vector, scalar) for scalar, *vector in NAMED_QUATERNIONS)
    return names, *_GROUPS.get(argument, ())


def of_component(argument: str, name: str) -> list[str]:
    """How one component may be called, whatever the others are called; its own name first."""
    forms = {"q_dot": RATES, "q_ddot": _ACCELERATIONS}.get(argument, ())
    bare = name.removesuffix("_dot").removesuffix("_ddot")
    return [name, *(form.format(bare) for form in forms)]
