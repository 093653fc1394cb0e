"""Generated modules and what to feed them, for the tests of kernels."""

from __future__ import annotations

import itertools
from functools import cache
from types import ModuleType

import numpy as np
import sympy as sp

import rigidsym as rs
from helpers.motions import derived
from rigidsym.kernels.module import generate
from rigidsym.models.rotation import RotationModel, elementary, lecture, time_function
from rigidsym.motion import derive

EPS = np.finfo(np.float64).eps
QUANTITIES = {  # arguments and shape of one value, for three angles
    "rotation_matrix": (("q",), (3, 3)),
    "rotation_rate": (("q", "q_dot"), (3, 3)),
    "spin_matrix": (("q", "q_dot"), (3, 3)),
    "angular_velocity_space": (("q", "q_dot"), (3,)),
    "angular_velocity_body": (("q", "q_dot"), (3,)),
    "rate_matrix_space": (("q",), (3, 3)),
    "inverse_rate_matrix_space": (("q",), (3, 3)),
    "rates_from_angular_velocity_space": (("q", "omega_space"), (3,)),
    "rate_matrix_body": (("q",), (3, 3)),
    "inverse_rate_matrix_body": (("q",), (3, 3)),
    "rates_from_angular_velocity_body": (("q", "omega_body"), (3,)),
    "angular_acceleration_space": (("q", "q_dot", "q_ddot"), (3,)),
    "angular_acceleration_body": (("q", "q_dot", "q_ddot"), (3,)),
}


@cache
def module(sequence: str = "ZXZ") -> ModuleType:
    return generate(derived(sequence)).load()


def inputs(name: str, leading: tuple[int, ...] = (7,), seed: int = 1) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(-3, 3, (*leading, 3)) for _ in QUANTITIES[name][0]]


def one_by_one(name: str, arrays: list[np.ndarray], sequence: str = "ZXZ") -> np.ndarray:
    """The function by its scalar twin, after NumPy's own broadcasting."""
    scalar = getattr(module(sequence), f"{name}_scalar")
    shape = np.broadcast_shapes(*(a.shape for a in arrays))
    wide = [np.broadcast_to(a, shape).reshape(-1, 3).tolist() for a in arrays]
    values = [scalar(*itertools.chain(*point)) for point in zip(*wide, strict=True)]
    return np.array(values, float).reshape(*shape[:-1], *QUANTITIES[name][1])


def turned_by(name: str, *angles: str, axes: str = "zxz") -> rs.Motion:
    """Three turns by angles of any names."""
    first, second, third = map(time_function, angles)
    a, b, c = axes
    matrix = elementary(a, first) * elementary(b, second) * elementary(c, third)
    return derive(
        RotationModel(
            name=name,
            title='Turns "by" any \\name """',
            convention=(),
            coordinates=(first, second, third),
            matrix=sp.ImmutableMatrix(matrix),
            source=lecture("17"),
        )
    )
