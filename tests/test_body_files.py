"""The [body] and [parameters] of a derivation file."""

from __future__ import annotations

from textwrap import dedent

import pytest
import sympy as sp

from rigidsym.errors import BodyError, SpecError
from rigidsym.models.body import general_inertia, principal_moments
from rigidsym.spec import DerivationSpec, read_spec

A, B, C, M = sp.symbols("A B C M")


def read(text: str) -> DerivationSpec:
    return read_spec(dedent(text), source="top.toml", name="top")


def faults_of(text: str) -> list[str]:
    with pytest.raises(SpecError) as caught:
        read(text)
    return [str(fault) for fault in caught.value.faults]


def test_a_symmetric_body_in_symbols():
    body = read('[body]\nprincipal_moments = ["A", "A", "C"]').body
    assert body is not None
    assert (body.mass, body.inertia) == (M, sp.ImmutableMatrix(sp.diag(A, A, C)))
    assert body.title == "Symmetric body"
    assert [(str(p.symbol), p.unit) for p in body.parameters] == [
        ("M", "kg"),
        ("A", "kg m^2"),
        ("C", "kg m^2"),
    ]


def test_numbers_with_a_point_are_values_of_parameters():
    body = read("[body]\nprincipal_moments = [1.5, 1.5, 2]\nmass = 3.25").body
    assert body is not None
    assert body.inertia == sp.ImmutableMatrix(sp.diag(A, A, 2))
    assert {str(p.symbol): p.value for p in body.parameters} == {"M": 3.25, "A": 1.5}


def test_parameters_are_described_by_the_file():
    body = read(
        """
        [parameters]
        A = { about = "transverse moment about the fixed point", unit = "kg m^2" }
        [body]
        principal_moments = ["A", "A", "C"]
        """
    ).body
    assert body is not None
    assert body.parameters[1].about == "transverse moment about the fixed point"


@pytest.mark.parametrize(
    "text",
    [
        '[body]\nprincipal_moments = ["A", "A", "C"]\nmass = "rho*V"',
        "[body]\ninertia = [[1.5, 0.1, 0], [0.1, 2.0, 0], [0, 0, 2.5]]\ncentre = [0.1, 0, 0]",
        '[body]\ninertia = "general"',
        "[parameters]\nA = { positive = true, value = 2.0 }\n[body]\n"
        'principal_moments = ["A", "A", "A"]',
    ],
)
def test_a_body_comes_back_from_its_data(text):
    spec = read(text)
    assert DerivationSpec.from_data(spec.to_data()) == spec


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[body]", "body: expected one of principal_moments, inertia"),
        ("[body]\nprincipal_moments = [1, 2]", "expected three moments of inertia, got a list"),
        ("[body]\nprincipal_moments = [1, 1, 2.5]", "exceeds the sum of the others by 0.5 kg m²"),
        ("[body]\nprincipal_moments = [1, 1, nan]", "expected a finite number, got nan"),
        ("[body]\nprincipal_moments = [1, 1, 1]\nmass = -2.0", "expected a positive number"),
        ("[body]\nprincipal_moments = [1, 1, 1]\nmass = 0", "expected a positive number, got 0"),
        ("[body]\nprincipal_moments = [-1, 1, 1]", "smallest principal moment is -1 kg m²"),
        ('[body]\ninertia = [[1, "b", 0], [0, 1, 0], [0, 0, 1]]', "I_xy − I_yx = b"),
        ("[body]\ninertia = [[1, 0, 0], [0, 1, 0]]", "three rows of three expressions"),
        ('[body]\nprincipal_moments = ["phi", 1, 1]', "is in the rotation too"),
        ('[rotation]\nsequence = "ZXZ"\n[parameters]\nA = {}', "parameters go with a [body]"),
        ('[body]\nprincipal_moments = ["A*", 1, 1]', "column 3: expected a number"),
    ],
)
def test_what_is_wrong_is_said(text, fault):
    assert fault in "\n".join(faults_of(text))


def test_an_engineer_may_insist():
    text = "[body]\nprincipal_moments = [1, 1, 2.5]\nallow = true"
    assert read(text).body is not None


def test_bodies_made_in_python():
    assert principal_moments(A, B, C).title == "Body in its principal axes"
    assert principal_moments(A, A, A).title == "Spherical body"
    assert len(general_inertia().parameters) == 7
    with pytest.raises(BodyError, match=r"exceeds the sum of the others by 1 kg m²"):
        principal_moments(sp.Integer(1), sp.Integer(2), sp.Integer(4))
