"""Each quantity is one entry: its reasons are sentences, its laws refute a wrong value.

Quantities that are asked for by name tell the same story as all of them. Those of long products of
turns are found by recursion: the expanded form, linear in the number of turns.
"""

from __future__ import annotations

import pickle
import re
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.errors import DerivationError, NotARotation, QuantityError, TemplateFault
from rigidsym.formula.reader import formula
from rigidsym.mechanics.body import BodyValues
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.derivation import Law, Proof, Quantity, phrase, phrases
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.dynamics.lagrange import equations_of_motion
from rigidsym.mechanics.kinematics import chain as chain_of_turns, workspace
from rigidsym.mechanics.kinematics.chain import Chain, is_shorter
from rigidsym.mechanics.kinematics.workspace import Renamed, Values, values_of
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.mechanics.quantities import OF_BODY, QUANTITIES
from rigidsym.mechanics.quantities.dynamics import DYNAMICS_QUANTITIES, EULER_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS
from rigidsym.models.body import Composite, Part
from rigidsym.models.forces import Forces
from rigidsym.models.rotation import Pullback, Turn
from rigidsym.models.solids import shaped
from rigidsym.notes.formats.record import record

M, h = sp.symbols("M h")
BLIND = {  # laws that hold for twice a value, too, such as that it is symmetric
    "rotation_rate": "dR/dt·Rᵀ + R dRᵀ/dt = 0",
    "spin_matrix": "dR/dt·Rᵀ + (dR/dt·Rᵀ)ᵀ = 0",
    "inertia_tensor": "I′ = I′ᵀ",
    "principal_moments": "det(I′ − Iₖ 1) = 0",  # proved by the axes
    "principal_axes": "I′ E = E diag(I₁, I₂, I₃)",
    "hamiltonian": "H = E",  # of the Hamiltonian that the workspace has
}


SENTENCES = {"reasons": ("reason", "without"), "quantities": ("meaning",), "remarks": ()}


@pytest.mark.parametrize("file", SENTENCES)
def test_every_quantity_has_its_sentences_and_no_sentence_is_left_over(file):
    entries = (*QUANTITIES.values(), *EULER_QUANTITIES.values())
    keys = {getattr(entry, field) for entry in entries for field in SENTENCES[file]} - {""}
    keys |= {c[f] for q in entries for _, c in q.variants for f in SENTENCES[file] if f in c}
    keys |= {*QUANTITIES} if file == "quantities" else set()
    assert keys <= phrases(file).keys()
    sources = "".join(p.read_text("utf-8") for p in Path(rs.__file__).parent.rglob("*.py"))
    assert phrases(file).keys() - keys <= {*re.findall(r'"(\w+)"', sources)}
    with pytest.raises(TemplateFault, match=rf"en/{file}\.toml: no 'angular'; "):
        phrase(file, "angular")


def twice(value_of, k):
    """Twice a value: of the ring, over a divisor, or as it is printed."""
    value = value_of(k)
    return (value[0] + value[0], value[1]) if isinstance(value, tuple) else value + value


def workspaces(name):
    if name in KINEMATICS:
        chain = Chain(rs.rotation_from("z(a) x(b) z(c) x(d) z(e)"))
        has_value = chain.step(KINEMATICS[name]) is not None
        return [Values(rs.EulerAngles("ZXZ")), *([chain] if has_value else [])]
    if name in OF_BODY:
        box, ball = shaped("box", sp.symbols("a b c"), mass=M), shaped("sphere", [h], mass=h)
        parts = (Part(what=box), Part(what=ball, at=sp.ImmutableMatrix([0, 0, h]), hole=True))
        body = rigid_body(Composite(parts=parts))
        return [BodyValues(rs.EulerAngles("ZXZ"), body, has_fixed_point=False)]
    top = rs.principal_moments(*sp.symbols("A A C"))
    forces = Forces(potential=sp.cos(rs.EulerAngles("ZXZ").coordinates[1]))
    return [equations_of_motion(rs.EulerAngles("ZXZ"), top, forces)]


@pytest.mark.parametrize("name", [*KINEMATICS, *OF_BODY, *DYNAMICS_QUANTITIES])
def test_twice_the_value_of_an_entry_is_refuted_by_each_of_its_laws(name):
    for work in workspaces(name):
        entry = QUANTITIES[name].presented(work.traits)
        assert work.step(entry).proofs or not entry.laws or name in BLIND
        wrong = entry._replace(value=partial(twice, entry.value), also=(), variants=())
        for law in entry.laws:
            with suppress(DerivationError, NotARotation):
                work.step(wrong._replace(laws=(law,)))
                assert law.claim.text == BLIND.get(name)


def test_a_wrong_bias_is_refuted():
    (work,) = workspaces("bias_vector")
    work.gyroscopic = work.gyroscopic.scale(work.ring.one * 2)
    with pytest.raises(DerivationError, match="is false"):
        work.step(QUANTITIES["bias_vector"])


# Euler angles about renamed axes

XYX = rs.EulerAngles("XYX")
PHI, THETA, PSI = XYX.coordinates
OBLIQUE = tuple(sp.Matrix([3, 4, 0]) / 5)
MORE = [  # than turns about coordinate axes
    rs.chain([replace(XYX.turns[0], components=OBLIQUE), *XYX.turns[1:]]),
    rs.chain([Turn(axis="zx", angle=PHI, components=OBLIQUE), Turn(axis="z", angle=THETA)]),
    replace(XYX, constraints=(PHI - PSI,), example=tuple((q, sp.S.One) for q in (PHI, PSI))),
    replace(XYX, pullback=Pullback(XYX.coordinates, ())),
    replace(XYX, units=("rad", "", "rad")),
]


def test_only_turns_about_coordinate_axes_share_a_derivation_if_matrices_agree(monkeypatch):
    for model in MORE:
        assert type(values_of(model)) is Values
        assert rs.derive(model).is_proved
    assert type(values_of(XYX)) is Renamed
    monkeypatch.setattr(workspace, "_original", lambda *_: (Values(XYX), {}))
    assert type(values_of(XYX)) is Values


def test_an_entry_that_states_no_axes_is_derived_about_the_axes_of_each_model():
    """Three times the last row of R is no tensor; it ends with cos θ for ZXZ, not for XYX."""

    def residual(k, x):
        return k.scalar(x.rows[2][2]) - k.codec.column([sp.cos(THETA)])

    rows = Quantity(
        name="last_rows",
        symbol=formula(r"\P"),
        value=lambda k: RingMatrix(k.codec.ring, k.rotation.rows[2:] * 3),
        laws=(Law(formula(r"\P_{33} = \cos\theta"), residual),),
    )
    assert values_of(rs.EulerAngles("ZXZ")).step(rows).proofs[0].is_exact
    with pytest.raises(DerivationError, match="is false"):
        values_of(XYX).step(rows)


@pytest.mark.parametrize(
    "names",
    [("rotation_matrix", "angular_velocity_body"), ("rates_from_angular_velocity_body",)],
    ids=" ".join,
)
@pytest.mark.parametrize("text", ["ZXZ", "quaternion", "z(phi) x(theta) z(psi) y(delta)"])
def test_what_is_derived_alone_is_what_is_selected(text, names):
    """Also the singular points, and that there are none beside quantities without rates."""
    alone, selected = rs.derive(text, only=names), rs.derive(text).select(names)
    assert alone.steps == selected.steps
    assert alone.singularities == selected.singularities
    copies = pickle.loads(pickle.dumps(alone)).steps  # in another process, without functions
    assert [copy.expression for copy in copies] == [step.expression for step in alone.steps]
    assert repr(alone).endswith(f", proved: {', '.join(names)}>")
    assert (alone.singularities is None) == (not any("rate" in name for name in names))
    has_rates = "The rates of the coordinates" in alone.note().markdown()
    assert has_rates == (alone.singularities is not None)


def test_quantities_that_there_are_not_are_refused():
    with pytest.raises(QuantityError, match=r"chain_zx has no .* no inverse"):
        rs.derive("z(phi) x(theta)", only="rates_from_angular_velocity_space")
    with pytest.raises(AttributeError, match="did you mean angular_velocity_body"):
        rs.derive("ZXZ").anglar_velocity_body  # noqa: B018
    with pytest.raises(AttributeError, match="no quantity rotational_energy; it needs a body"):
        rs.derive("ZXZ").rotational_energy  # noqa: B018


def test_conversions_are_part_of_what_is_proved(monkeypatch):
    motion = rs.derive("gibbs_vector")
    assert motion.step("rates_from_angular_velocity_body").quantity.unit == "1/s"
    conversions = Conversions(motion.model)
    assert record(motion, {}, conversions)["is_proved"]
    open_claim = Proof(claim=conversions.from_matrix.claim, status="unproved")
    monkeypatch.setattr(Conversions, "from_matrix", open_claim)
    assert not record(motion, {}, Conversions(motion.model))["is_proved"]


LETTERS = "zxzyxyzxyzxyzxzyxyzx"


def long_chain(count: int) -> rs.RotationModel:
    return rs.rotation_from(" ".join(f"{axis}(q{k})" for k, axis in enumerate(LETTERS[:count], 1)))


@pytest.mark.parametrize("law", ["velocity", "acceleration"])
@pytest.mark.parametrize("frame", ["space", "body"])
def test_a_wrong_law_of_composition_is_refuted(monkeypatch, law, frame):
    monkeypatch.setattr(chain_of_turns, law, lambda R, own, *others: own - R @ others[-1])
    monkeypatch.setattr(chain_of_turns, "composed", chain_of_turns.Composition)
    with pytest.raises(rs.RigidsymError, match="is false"):
        Chain(long_chain(5)).step(KINEMATICS[f"angular_{law}_{frame}"])


def test_the_rates_of_a_long_chain_are_left_to_numbers():
    motion = rs.derive(long_chain(5))
    assert motion.singularities is None
    assert not [step for step in motion.steps if step.quantity.name.startswith(("inv", "rates"))]
    with pytest.raises(QuantityError, match=r"numpy\.linalg\.pinv\(W\)"):
        rs.derive(long_chain(5), "rates_from_angular_velocity_space")


def test_definitions_grow_linearly_and_begin_with_five_turns():
    counts = {n: len(derive(long_chain(n)).definitions) for n in (4, 5, 6, 12, 18)}
    assert counts[18] - counts[12] == counts[12] - counts[6]
    assert counts[4] == 0 < counts[5]
    assert not is_shorter(rs.EulerAngles("ZXZ"))


def test_a_body_on_a_long_chain_has_the_energy_and_momentum_of_the_expanded_rotation():
    model, body = long_chain(5), rs.solid("cylinder", radius=sp.Symbol("a"), height=sp.Symbol("h"))
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
