"""Quantities that are asked for by name, and conversions beside them, tell the same story."""

from __future__ import annotations

from dataclasses import replace

import pytest

from helpers.command import call
from rigidsym.errors import QuantityError
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.derivation import Proof
from rigidsym.models.library import rotation_from
from rigidsym.motion import derive
from rigidsym.notes.formats.record import record
from rigidsym.notes.formats.terminal import show
from rigidsym.pipeline import output_of
from rigidsym.spec.derivation_spec import spec_for

CHOSEN = [
    ("rotation_matrix", "angular_velocity_body"),
    ("angular_acceleration_space", "rate_matrix_space"),
    ("rates_from_angular_velocity_body",),
]
CHAIN = "z(a) x(b) z(c) x(d) y(e) z(f) x(g) y(h)"


@pytest.mark.parametrize("names", CHOSEN, ids=" ".join)
@pytest.mark.parametrize("text", ["ZYX", "quaternion", "z(phi) x(theta) z(psi) y(delta)"])
def test_what_is_derived_alone_is_what_is_selected(text, names):
    """Also the singular points, and that there are none beside quantities without rates."""
    model = rotation_from(text)
    alone, selected = derive(model, only=names), derive(model).select(names)
    assert alone.steps == selected.steps
    assert alone.singularities == selected.singularities
    assert (alone.singularities is None) == (not any("rate" in name for name in names))


def test_rates_that_a_model_has_not_are_refused_when_asked_for():
    name = "rates_from_angular_velocity_space"
    with pytest.raises(QuantityError, match=f"chain_zx has no quantity {name}: .* no inverse"):
        derive("z(phi) x(theta)", only=(name,))


def test_a_file_derives_what_it_asks_for_alone(monkeypatch):
    """Eight turns: the accelerations, which no one asked for, would take their time."""
    asked = []

    def watched(model, only, **more):
        asked.append(only)
        return derive(model, only, **more)

    monkeypatch.setattr("rigidsym.pipeline.derive", watched)
    names = ["angular_velocity_space"]
    made = output_of(replace(spec_for(CHAIN), quantities=tuple(names)))
    assert [list(only) for only in asked] == [names]
    assert [step.quantity.name for step in made.motion.steps] == names


def test_conversions_are_part_of_what_is_proved(monkeypatch):
    model = rotation_from("gibbs_vector")
    motion, found = derive(model), Conversions(model)
    assert record(motion, {}, found)["is_proved"]
    open_claim = Proof(claim=found.from_matrix.claim, status="unproved")
    monkeypatch.setattr(Conversions, "from_matrix", open_claim)
    assert not record(motion, {}, found)["is_proved"]


def test_the_terminal_shows_conversions_and_their_proofs():
    motion = derive("ZXZ")
    text = show(motion, width=120, conversions=motion.conversions)
    assert "(14) unit quaternion of the rotation, scalar first" in text
    assert "At a pole" in text
    proofs = text.partition("Identities verified")[2]
    for proof in motion.conversions.proofs:
        assert f"exact     {proof.claim.text}" in proofs
    assert "Conversions" not in show(motion, width=120)


def test_the_terminal_says_why_there_is_no_way_back():
    motion = derive("z(phi) x(phi)")
    text = " ".join(show(motion, width=120, conversions=motion.conversions).split())
    assert motion.conversions.without in text


def test_the_summary_counts_the_proofs_of_conversions(tmp_path):
    (tmp_path / "two.toml").write_text(
        '[rotation]\nsequence = ["ZXZ", "ZYX"]\n[output]\nnote = ["tex"]\n'
    )
    counts = [
        int(call("run", "two.toml", *more, cwd=tmp_path).stdout.split()[1])
        for more in ((), ("--conversions",))
    ]
    assert counts[1] > counts[0]


def test_a_prompt_shows_one_line():
    motion = derive("ZXZ", only=["rotation_matrix", "angular_velocity_body"])
    names = "rotation_matrix, angular_velocity_body"
    assert repr(motion) == f"<Motion euler_zxz_intrinsic, proved: {names}>"
    first = motion.steps[0]
    doubtful = replace(first, proofs=(replace(first.proofs[0], status="unproved"),))
    part = replace(motion, steps=(doubtful, *motion.steps[1:]))
    assert repr(part) == f"<Motion euler_zxz_intrinsic, 1 unproved: {names}>"


def test_a_note_has_no_section_on_rates_that_are_not_in_it():
    title = "The rates of the coordinates"
    assert title in derive("ZXZ").note().markdown()
    chosen = derive("ZXZ", only=["rotation_matrix", "angular_velocity_body"]).note().markdown()
    assert title not in chosen
    assert "rate matrices" not in chosen


def test_a_misspelled_quantity_is_answered_with_the_nearest():
    with pytest.raises(AttributeError, match="did you mean angular_velocity_body"):
        derive("ZXZ").anglar_velocity_body  # noqa: B018
