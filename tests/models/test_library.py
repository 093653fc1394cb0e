"""The library of rotations: vectors, chains, kernels, and what cannot be read."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from helpers.parametrisations import (
    CHAINS,
    CLOSE,
    WITNESSES,
    chain_witness,
    motion_of,
    nearly_straight,
    values_on,
)
from helpers.witness import evaluate, hat, mp, number
from rigidsym.errors import ExpressionError, ModelError, QuantityError
from rigidsym.mechanics.derive import derive as derivation_of
from rigidsym.models.library import PARAMETRISATIONS, PRESETS, rotation_from
from rigidsym.pipeline import read_record
from rigidsym.spec.derivation_spec import spec_for


def agree(first: Any, second: Any) -> bool:
    return max(abs(entry) for entry in first - second) < CLOSE


@pytest.mark.parametrize("text", [*PARAMETRISATIONS, "rpy", *CHAINS[2:7]])
def test_kernels_give_what_the_derivation_says(text):
    motion = motion_of(text)
    module = motion.kernels().load()
    size = len(motion.model.coordinates)
    curve, _ = WITNESSES.get(text) or (nearly_straight(size), chain_witness(motion))
    values = values_on(motion, curve)
    for frame in ("omega_space", "omega_body"):
        values |= dict(zip(motion.argument(frame).symbols, (mp.mpf(1), -2, 3), strict=True))
    for step in motion.steps:
        vectors = [motion.argument(name) for name in step.quantity.inputs]
        given = [np.array([float(values[s]) for s in vector.symbols]) for vector in vectors]
        found = getattr(module, step.quantity.name)(*[np.stack([g, g]) for g in given])
        exact = np.array(evaluate(motion.spelled(step.expression), values).tolist(), dtype=float)
        assert found.shape == (2, *step.shape)
        np.testing.assert_allclose(found[1].reshape(exact.shape), exact, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("text", PARAMETRISATIONS)
def test_vectors_are_shown_as_vectors(text):
    motion = motion_of(text)
    names = ("angular_velocity_space", "angular_velocity_body")
    if not motion.model.vector:
        assert [motion.step(name).vector_form for name in names] == [None, None]
        return
    curve, _ = WITNESSES[text]
    values = values_on(motion, curve)
    vector = mp.matrix([values[part] for part in motion.model.vector])
    rate = mp.matrix([values[sp.Derivative(p, sp.Symbol("t"))] for p in motion.model.vector])
    once = hat(vector) * rate
    named = {
        "v": vector,
        "v̇": rate,
        "v × v̇": once,
        "v × (v × v̇)": hat(vector) * once,
        "(v·v̇) v": (vector.T * rate)[0] * vector,
    }
    for name in names:
        step = motion.step(name)
        lengths = values | {step.vector_form.length: mp.norm(vector)}
        total = mp.matrix(3, 1)
        for term in step.vector_form.terms:
            total += number(term.coefficient, lengths) * named[term.vector.text]
        assert agree(total, evaluate(step.expression, values))


def test_the_rotation_vector_has_the_form_of_the_textbooks():
    n = motion_of("rotation_vector").step("angular_velocity_space").vector_form.length
    terms = motion_of("rotation_vector").step("angular_velocity_space").vector_form.terms
    assert [term.vector.text for term in terms] == ["v̇", "v × v̇", "v × (v × v̇)"]
    expected = [1, (1 - sp.cos(n)) / n**2, (n - sp.sin(n)) / n**3]
    for term, coefficient in zip(terms, expected, strict=True):
        assert sp.expand(term.coefficient - coefficient) == 0


@pytest.mark.parametrize("name", ["quaternion", "unit_quaternion"])
def test_the_scalar_stands_last_on_request(name):
    first, last = rotation_from(name), rotation_from(name, scalar_last=True)
    assert last.coordinates == (*first.coordinates[1:], first.coordinates[0])
    assert last.matrix == first.matrix
    assert last.name != first.name
    assert "scalar last" in last.title


@pytest.mark.parametrize("text", ["ZXZ", "unit_quaternion", *PRESETS, *CHAINS[3:8]])
def test_what_was_asked_for_can_be_asked_for_again(text):
    spec = spec_for(text, passive=True)
    assert read_record(spec.to_data()) == spec


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("w(phi)", "expected a turn"),
        ("[0,0,0](phi)", "the axis must not be the zero vector"),
        ("[1,1](phi)", "expected three"),
        ("[1,1,0,0](phi)", "expected three"),
        ("z(pi/4)", "does not move"),
        ("z(phi", "unclosed"),
        ("quaternoin", "did you mean quaternion"),
        ("goldstien", "did you mean goldstein"),
        ("z(phi_dot)", "reads as a rate"),
        ("z(sin(phi)", "unclosed"),
    ],
)
def test_a_rotation_that_cannot_be_read_says_why(text, message):
    with pytest.raises((ModelError, ExpressionError), match=message):
        rotation_from(text)


def test_wrong_options_are_refused():
    with pytest.raises(ModelError, match="scalar-last applies only to quaternions"):
        rotation_from("ZXZ", scalar_last=True)
    with pytest.raises(ModelError, match="expected 4 different names"):
        rotation_from("quaternion", names=["a", "b", "c"])
    with pytest.raises(QuantityError, match="no quantity speed"):
        derivation_of(rotation_from("ZXZ"), only=("speed",))


def test_zero_names_a_constant_and_ten_does_not():
    model = rotation_from("z(a_9) x(alpha0) y(a_10) x(b_0)")
    assert [symbol.name for symbol in model.constants] == ["alpha0", "b_0"]
    assert [q.func.__name__ for q in model.coordinates] == ["a_9", "a_10"]


def test_a_name_is_a_coordinate_or_a_constant():
    with pytest.raises(ModelError, match="a is both a coordinate and a constant"):
        rotation_from("z(a) [a,b,c](beta)")
    with pytest.raises(ModelError, match="they go with turns"):
        rotation_from("ZXZ", constants=["k"])


def test_rates_have_the_unit_of_the_coordinates():
    assert motion_of("ZXZ").step("rates_from_angular_velocity_body").quantity.unit == "rad/s"
    assert motion_of("unit_quaternion").step("rates_from_angular_velocity_body").quantity.unit == (
        "1/s"
    )
