"""Names in kernels: identifiers, each given once, whatever a person calls the coordinates."""

from __future__ import annotations

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.naming import Names, identifier
from rigidsym.models.rotation import RotationModel, lecture
from rigidsym.models.so3 import elementary, time_function
from rigidsym.motion import derive


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("phi", "phi"),
        ("θ", "θ"),
        ("ϕ", "φ"),
        (r"\theta'", "theta"),
        ("2nd angle", "v2nd_angle"),
        ("__init__", "init"),
        ("_", "v"),
    ],
)
def test_names_become_identifiers(text, name):
    assert identifier(text) == name


def test_names_are_given_once():
    names = Names(["lambda", "x0"])
    assert [names.fresh(n) for n in ("lambda", "phi", "phi", "lambda")] == [
        "lambda_",
        "phi",
        "phi_",
        "lambda__",
    ]
    assert [names.numbered("x"), names.numbered("x")] == ["x1", "x2"]


def turned_by(*names: str) -> rs.Motion:
    """Turns about z, x and z by angles of any names."""
    angles = [time_function(name) for name in names]
    matrix = elementary("z", angles[0]) * elementary("x", angles[1]) * elementary("z", angles[2])
    return derive(
        RotationModel(
            name="clashes",
            title="Names that clash",
            convention=(),
            coordinates=tuple(angles),
            matrix=sp.ImmutableMatrix(matrix),
            source=lecture("17"),
        )
    )


@pytest.mark.parametrize(
    "names", [("x0", "x1", "x2"), ("phi", "sin_phi", "phi_dot"), ("lambda", "np", "out")]
)
def test_names_of_a_person_clash_with_nothing(names):
    kernels = lower(turned_by(*names), {"lambda", "np"}).kernels
    for kernel in kernels:  # each Kernel refuses a name that is defined twice
        assert not {"lambda", "np"} & {*kernel.components, *(a.name for a in kernel.assignments)}
