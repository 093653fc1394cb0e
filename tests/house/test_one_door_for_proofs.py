"""Only mechanics/prove.py makes exact proofs, and each place that uses it fails if it is wrong."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.algebra.integrate import Integrator
from rigidsym.errors import DerivationError
from rigidsym.mechanics.body import BodyValues
from rigidsym.mechanics.kinematics.vector_forms import FORMS
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models.body import Solid

PACKAGE = Path(rs.__file__).parent
DOOR = PACKAGE / "mechanics" / "prove.py"


def exact_proofs(source: str) -> list[int]:
    """The lines that construct a Proof without a status that is plainly another."""
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    found = []
    for call in calls:
        name = call.func.attr if isinstance(call.func, ast.Attribute) else None
        name = call.func.id if isinstance(call.func, ast.Name) else name
        status = [k.value for k in call.keywords if k.arg == "status"]
        is_open = bool(status) and getattr(status[0], "value", None) == "unproved"
        says_exact = bool(status) and getattr(status[0], "value", None) == "exact"
        if (name == "Proof" and not is_open) or says_exact:
            found.append(call.lineno)
    return found


def test_only_the_door_constructs_exact_proofs():
    found = {path: exact_proofs(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
    assert [path for path, lines in found.items() if lines] == [DOOR]


def test_a_second_door_would_be_seen():
    for source in ("derivation.Proof(**given)", 'replace(proof, status="exact")'):
        assert exact_proofs(source) == [1]


def test_a_wrong_coefficient_of_a_vector_form_is_refused(monkeypatch):
    form = FORMS["quaternion", 3]
    one, *others = form.rotation
    wrong = (one, *(coefficient + 1 for coefficient in others))
    monkeypatch.setitem(FORMS, ("quaternion", 3), form._replace(rotation=wrong))
    with pytest.raises(DerivationError, match=r"in terms of v.* is false"):
        rs.derive("gibbs_vector", ["angular_velocity_space"])


def test_a_wrong_shift_of_an_inertia_tensor_is_refused(monkeypatch):
    right = BodyValues.shifted_inertia
    monkeypatch.setattr(BodyValues, "shifted_inertia", lambda values: 2 * right(values))
    with pytest.raises(DerivationError, match="is false"):
        rs.derive("ZXZ", ["inertia_tensor_point"], body=rs.solid("cone"))


def test_a_wrong_antiderivative_is_refused(monkeypatch):
    right = Integrator.antiderivative
    a, u, v = sp.symbols("a u v")
    disc = Solid(
        title="disc",
        coordinates=(u, v),
        place=sp.ImmutableMatrix([u * sp.cos(v), u * sp.sin(v), 0]),
        bounds=((sp.S.Zero, a), (sp.S.Zero, 2 * sp.pi)),
        element=u,
        density=sp.S.One,
    )

    def wrong(self, element):
        return right(self, element) + self.ring.generator(self.ring.index[self.variable])

    monkeypatch.setattr(Integrator, "antiderivative", wrong)
    with pytest.raises(DerivationError, match="for every integral is false"):
        moments_of(disc)
