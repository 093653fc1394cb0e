"""Pictures of motions in notes: examples of derivation files, integrated and drawn."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import ModelError, SpecError
from rigidsym.formula.reader import decimal
from rigidsym.models.forces import OMEGA, OMEGA_COMPONENTS, initial_values
from rigidsym.notes.figure.chart import Range
from rigidsym.notes.figure.motion_picture import ExampleMotion
from rigidsym.pipeline import motion_of, read, read_spec
from rigidsym.system import resources

SYSTEMS = [
    spec
    for spec in map(read, resources.names("derivations", ".toml"))
    if len(spec.models) == 1 and spec.dynamics
]
A_PENDULUM = {
    "model": "x(theta)",
    "body": rs.principal_moments(*sp.symbols("A B C")),
    "potential": "-m*g*l*cos(theta)",
}
NUMBERS = {"A": 1, "B": 1, "C": 1, "m": 1, "g": 10, "l": 1}


@cache
def shipped(name: str) -> rs.Motion:
    return motion_of(read(name))


def figure_of(motion: rs.Motion):
    return motion.note(with_kernels=False).document.figures[-1]


def test_every_shipped_system_has_an_example():
    assert len(SYSTEMS) >= 7
    assert [spec.name for spec in SYSTEMS if not spec.dynamics.get("examples")] == []


@pytest.mark.parametrize("name", ["heavy_symmetric_top", "heavy_asymmetric_body", "free_body"])
def test_the_motion_drawn_is_the_motion_simulated(name):
    motion = shipped(name)
    example = motion.forces.examples[0]
    start = initial_values(motion.model, example.initial)
    omega = [start.pop(component) for component in OMEGA_COMPONENTS if component in start]
    start |= {OMEGA: omega} if omega else {}
    parameters = example.parameters
    simulated = motion.simulate(start, parameters, example.time, samples=401)
    drawn = ExampleMotion(motion, motion.forces, example)
    q = drawn.states[:, : simulated.q.shape[1]]
    assert np.abs(q - simulated.q).max() < 3e-3 * np.ptp(simulated.q)


def test_the_caption_tells_parameters_and_initial_values():
    figure = figure_of(shipped("heavy_symmetric_top"))
    told = "".join(span if isinstance(span, str) else span.text for span in figure.caption)
    for value in ("A = 1", "l = 0.5", "θ = 0.9", "ψ̇ = 12", "φ̇ = 0, φ̇ = 0.4 and φ̇ = -0.5"):
        assert value.replace("-", "−") in told.replace("-", "−")


def caption_of(motion: rs.Motion) -> str:
    return "".join(s if isinstance(s, str) else s.text for s in figure_of(motion).caption)


def test_motions_that_share_no_initial_value_are_told_by_what_differs():
    first = {"parameters": NUMBERS, "initial": {"theta": 0.5}, "time": 2}
    told = caption_of(rs.derive(**A_PENDULUM, examples=[first, {"initial": {"theta": 3}}]))
    assert "begin with" not in told
    assert "l = 1, in SI units" in told
    assert told.endswith("From left to right: θ = 0.5 and θ = 3.")


def test_without_a_trace_each_motion_is_drawn_over_the_time():
    first = {"parameters": NUMBERS, "initial": {"theta": 0.5}, "time": 2}
    one = rs.derive(**A_PENDULUM, examples=[first])
    two = rs.derive(**A_PENDULUM, examples=[first, {"initial": {"theta": 3}}])
    curves = [
        [stroke for stroke in figure_of(motion).drawing.strokes if stroke.kind == "body"]
        for motion in (one, two)
    ]
    assert list(map(len, curves)) == [1, 2]


def test_a_body_without_parameters_that_begins_at_rest_has_a_caption():
    body = rs.principal_moments(*map(sp.Integer, (1, 1, 1)))
    told = caption_of(rs.derive("ZYX", body=body, torque=["1", "0", "0"], examples=[{"time": 2}]))
    assert told == "The motion in SI units and radians; all initial values are 0."


def test_a_free_body_at_rest_has_no_polhode():
    moments = dict(zip("ABC", (1, 2, 2.5), strict=True))
    example = {"parameters": moments, "initial": {"theta": 1}, "time": 2}
    still = rs.derive("ZXZ", body=A_PENDULUM["body"], potential="0", examples=[example])
    assert "polhode" not in str(figure_of(still).description)


@pytest.mark.parametrize(
    ("value", "text"),
    [(-0.5, "−0.5"), (1e-5, "10⁻⁵"), (-2.5e7, "−2.5·10⁷"), (123456, "123456")],
)
def test_a_very_small_or_large_number_has_a_power_of_ten(value, text):
    assert decimal(value).text == text


def test_ticks_of_a_small_range_differ():
    ticks = Range.of([0, 2e-9]).ticks
    assert list(ticks) == pytest.approx([0, 5e-10, 1e-9, 1.5e-9, 2e-9], rel=1e-9)


def test_an_example_takes_from_the_first_what_it_does_not_name():
    first = {"parameters": NUMBERS, "initial": {"theta": 0.5}, "time": 2}
    motion = rs.derive(**A_PENDULUM, examples=[first, {"initial": {"theta_dot": 1}}])
    assert motion.forces.examples[1] == (NUMBERS, {"theta": 0.5, "theta_dot": 1}, 2)


@pytest.mark.parametrize(
    ("example", "message"),
    [
        ({"initial": {"thta": 1}, "time": 1}, "thta; did you mean theta?"),
        ({"initial": {"theta": 1}}, "a time > 0"),
        ({"initial": {"theta": float("nan")}, "time": 1}, "finite numbers"),
        ({"initial": {"theta": "1"}, "time": 1}, "finite numbers"),
        ({"parameters": {"A": "1"}, "time": 1}, "finite numbers"),
        ({"time": "1"}, "finite numbers"),
        ({"parameters": NUMBERS | {"G": 1}, "time": 1}, "unknown parameter G; known: A, B"),
        ({"initial": 1, "time": 1}, "initial values by name"),
        ({"start": {"theta": 1}, "time": 1}, "start; expected parameters, initial, time"),
    ],
)
def test_an_example_that_is_none_is_refused(example, message):
    with pytest.raises(ModelError, match=message):
        rs.derive(**A_PENDULUM, examples=[example])


def test_missing_values_of_an_example_are_named_all_at_once():
    motion = rs.derive(**A_PENDULUM, examples=[{"parameters": {"A": 1}, "time": 1}])
    with pytest.raises(ModelError, match=r"lacks values of g, l, m$"):
        motion.note()


def test_a_motion_too_fast_for_a_picture_is_refused():
    fast = {"parameters": NUMBERS | {"g": 1e9}, "initial": {"theta": 1}, "time": 1e3}
    motion = rs.derive(**A_PENDULUM, examples=[fast])
    with pytest.raises(ModelError, match="cannot be drawn"):
        motion.note()


def test_a_file_tells_the_place_of_a_wrong_example():
    text = (
        '[rotation]\nsequence = "ZXZ"\n[body]\nprincipal_moments = ["A", "A", "C"]\n'
        '[dynamics]\npotential = "0"\n[[dynamics.examples]]\ninitial = { theta = "1" }\ntime = 1\n'
    )
    with pytest.raises(SpecError, match=r"dynamics.examples\[0\].initial.theta"):
        read_spec(text, source="top.toml", name="top")


def test_without_the_equations_of_motion_there_is_no_picture():
    spec = replace(read("heavy_symmetric_top"), quantities=("energy",))
    assert "energy" in motion_of(spec).note(with_kernels=False).latex()
