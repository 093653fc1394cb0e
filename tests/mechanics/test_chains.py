"""Long products of turns by recursion: the expanded form, true at 50 digits, linear in n."""

from __future__ import annotations

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import QuantityError
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.kinematics import chain as chain_of_turns
from rigidsym.mechanics.kinematics.chain import Chain, is_shorter
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities.kinematics import KINEMATICS

LETTERS = "zxzyxyzxyzxyzxzyxyzx"


def chain(count: int) -> rs.RotationModel:
    return rs.rotation_from(" ".join(f"{axis}(q{k})" for k, axis in enumerate(LETTERS[:count], 1)))


@pytest.mark.parametrize("law", ["velocity", "acceleration"])
@pytest.mark.parametrize("frame", ["space", "body"])
def test_a_wrong_law_of_composition_is_refuted(monkeypatch, law, frame):
    monkeypatch.setattr(chain_of_turns, law, lambda R, own, *others: own - R @ others[-1])
    monkeypatch.setattr(chain_of_turns, "composed", chain_of_turns.Composition)
    with pytest.raises(rs.RigidsymError, match="is false"):
        Chain(chain(5)).step(KINEMATICS[f"angular_{law}_{frame}"])


def test_the_rates_of_a_long_chain_are_left_to_numbers():
    motion = rs.derive(chain(5))
    assert motion.singularities is None
    assert not [step for step in motion.steps if step.quantity.name.startswith(("inv", "rates"))]
    with pytest.raises(QuantityError, match=r"numpy\.linalg\.pinv\(W\)"):
        rs.derive(chain(5), "rates_from_angular_velocity_space")


def test_definitions_grow_linearly_and_begin_with_five_turns():
    counts = {n: len(derive(chain(n)).definitions) for n in (4, 5, 6, 12, 18)}
    assert counts[18] - counts[12] == counts[12] - counts[6]
    assert counts[4] == 0 < counts[5]
    assert not is_shorter(rs.EulerAngles("ZXZ"))


def test_a_body_on_a_long_chain_has_the_energy_and_momentum_of_the_expanded_rotation():
    model, body = chain(5), rs.solid("cylinder", radius=sp.Symbol("a"), height=sp.Symbol("h"))
    names = ["rotational_energy", "angular_momentum_rotation", "inertia_tensor_space"]
    motion = rs.derive(model, names, body=body)
    assert motion.is_proved
    values = Values(model, motion.body)
    omega, inertia = values.omega_body, values.codec.matrix(motion.body.inertia)
    encode = values.codec.encode
    assert encode(2 * motion.rotational_energy) == (omega.T @ inertia @ omega)[0, 0]
    momentum = (values.rotation @ (inertia @ omega)).entries
    assert tuple(map(encode, motion.angular_momentum_rotation)) == momentum
    turned = values.rotation @ inertia @ values.rotation.T
    assert tuple(map(encode, motion.inertia_tensor_space)) == turned.entries


@pytest.mark.parametrize(
    "text",
    [
        " ".join(f"z(a{k})" for k in range(1, 21)),
        f"z({' + '.join(f'sqrt({p})*a' for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29))}) x(b)",
        "[a,b,c](x) [d,e,f](y) [g,h,i](z)",
    ],
    ids=["twenty turns about one axis", "ten roots in an angle", "three symbolic axes"],
)
def test_what_grows_exponentially_if_it_is_multiplied_out_is_not(text):
    motion = rs.derive(rs.rotation_from(text))
    assert motion.is_proved
    assert len(motion.kernels().source) < 200_000
