"""Each quantity is one entry: its reasons are sentences, its laws refute a wrong value."""

from __future__ import annotations

import pickle
import re
import tomllib
from pathlib import Path

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import DerivationError, NotARotation
from rigidsym.mechanics.body import BodyValues
from rigidsym.mechanics.dynamics.lagrange import equations_of_motion
from rigidsym.mechanics.kinematics.chain import Chain
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.mechanics.quantities.catalogue import OF_BODY, QUANTITIES as ENTRIES
from rigidsym.mechanics.quantities.dynamics import DYNAMICS_QUANTITIES, EULER_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.models.forces import Forces
from rigidsym.system.resources import text

REASONS = tomllib.loads(text("templates/notes", "en/reasons.toml"))
MECHANICS = Path(rs.__file__).parent / "mechanics"


def test_every_reason_is_a_sentence_and_every_sentence_a_reason():
    reasons = {entry.reason for entry in (*ENTRIES.values(), *EULER_QUANTITIES.values())} - {""}
    reasons |= {c["reason"] for q in ENTRIES.values() for _, c in q.variants if "reason" in c}
    assert reasons <= REASONS.keys()
    sources = "".join(path.read_text("utf-8") for path in MECHANICS.rglob("*.py"))
    assert set(REASONS) - reasons <= {*re.findall(r'"(\w+)"', sources)}


def doubled(value):
    """Twice a value: of the ring, over a divisor, or as it is printed."""
    if isinstance(value, tuple):
        return doubled(value[0]), value[1]
    return value + value


# proved by their own construction, or without a law of their own
UNSEEN = {"rotation_rate", "potential_energy", "lagrangian", "hamiltonian"}
UNSEEN |= {"effective_potential", "mass", "principal_moments"}  # whose law is that of the axes
UNSEEN |= {"spin_matrix"}  # twice a skew matrix is skew


@pytest.mark.parametrize(
    "name",
    [n for n in (*KINEMATICS, *OF_BODY) if n not in UNSEEN],
)
def test_twice_the_value_of_an_entry_is_refuted(name):
    entry = ENTRIES[name]
    wrong = entry._replace(value=lambda k: doubled(entry.value(k)))
    body = rigid_body(rs.solid("cone", mass=sp.Symbol("M")))
    work = BodyValues(rs.EulerAngles("ZXZ"), body, has_fixed_point=False)
    if name in KINEMATICS:
        work = Values(rs.EulerAngles("ZXZ"))
    assert work.step(entry).proofs
    with pytest.raises((DerivationError, NotARotation), match=r"false|not a rotation"):
        work.step(wrong)


@pytest.mark.parametrize("name", [n for n in DYNAMICS_QUANTITIES if n not in UNSEEN])
def test_twice_a_quantity_of_motion_is_refuted(name):
    top = rs.principal_moments(*sp.symbols("A A C"))
    forces = Forces(potential=sp.cos(rs.EulerAngles("ZXZ").coordinates[1]))
    work = equations_of_motion(rs.EulerAngles("ZXZ"), top, forces)
    entry = ENTRIES[name]
    assert work.step(entry).proofs
    with pytest.raises(DerivationError, match="false"):
        work.step(entry._replace(value=lambda k: doubled(entry.value(k))))


@pytest.mark.parametrize("name", [n for n in KINEMATICS if n not in UNSEEN])
def test_twice_the_value_of_a_chain_is_refuted(name):
    entry, chain = ENTRIES[name], Chain(rs.rotation_from("z(a) x(b) z(c) x(d) z(e)"))
    assert chain.step(entry).proofs
    if any(law.is_of_inverse for law in entry.laws):
        return  # the value is that of the rows, whose factors are proved
    with pytest.raises((DerivationError, NotARotation), match=r"false|not a rotation"):
        Chain(chain.model).step(entry._replace(value=lambda k: doubled(entry.value(k))))


def test_a_step_travels_to_another_process_without_its_functions():
    step = rs.derive("ZXZ", ["rotation_rate"]).step("rotation_rate")
    copy = pickle.loads(pickle.dumps(step.quantity))
    assert copy.value is None
    assert (copy.name, copy.inputs) == ("rotation_rate", step.quantity.inputs)
