"""How logs name the components of angles, rates, angular velocities and attitudes."""

from __future__ import annotations

from itertools import product

from rigidsym.data.columns import Names
from rigidsym.system.files import table_beside

_TABLES = table_beside(__file__, "spellings.toml")
RATES, _ACCELERATIONS, _MATRICES = (
    tuple(_TABLES[key].split()) for key in ("rates", "accelerations", "matrices")
)
ANGLES, NAMED_QUATERNIONS, _OTHERS, OMEGAS = (
    tuple(tuple(names.split()) for names in _TABLES[key])
    for key in ("angles", "named_quaternions", "quaternions", "omegas")
)
QUATERNIONS: tuple[Names, ...] = (*NAMED_QUATERNIONS, *_OTHERS)
_INDICES = [f"{row}{column}" for row, column in product("123", repeat=2)]
MATRICES: tuple[Names, ...] = tuple(tuple(head + index for index in _INDICES) for head in _MATRICES)


_GROUPS = {  # first the columns that `eval` and `simulate` write
    **{
        f"omega_{frame}": (tuple(f"angular_velocity_{frame}_{k}" for k in (1, 2, 3)), *OMEGAS)
        for frame in ("space", "body")
    },
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
