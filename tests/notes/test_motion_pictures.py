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
from rigidsym.notes.figure.camera import STANDARD
from rigidsym.notes.figure.chart import Range, circle, on_ellipsoid
from rigidsym.notes.figure.motion_picture import ExampleMotion
from rigidsym.notes.figure.phase_portrait import phase_portrait
from rigidsym.notes.letters import letters_of
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
FIRST = {"parameters": NUMBERS, "initial": {"theta": 0.5}, "time": 2}


@cache
def shipped(name: str) -> rs.Motion:
    return motion_of(read(name))


def figure_of(motion: rs.Motion):
    return motion.note(with_kernels=False).document.figures[-1]


def caption_of(motion: rs.Motion) -> str:
    return "".join(s if isinstance(s, str) else s.text for s in figure_of(motion).caption)


def test_every_shipped_system_has_an_example():
    assert len(SYSTEMS) >= 7
    assert [spec.name for spec in SYSTEMS if not spec.dynamics.get("examples")] == []


@pytest.mark.parametrize("name", ["heavy_symmetric_top", "free_body"])
def test_the_motion_drawn_is_the_motion_simulated(name):
    motion = shipped(name)
    example = motion.forces.examples[0]
    simulated = motion.simulate(example.initial, example.parameters, example.time, samples=401)
    drawn = ExampleMotion(motion, motion.forces, example)
    q = drawn.states[:, : simulated.q.shape[1]]
    assert np.abs(q - simulated.q).max() < 3e-3 * np.ptp(simulated.q)
    assert np.abs(drawn.omega - simulated.angular_velocity_body).max() < 0.05


def test_each_curve_of_the_phase_portrait_has_one_energy():
    """For constants of 1, V = cos θ + (p_φ − p_ψ cos θ)²/(2 sin² θ)"""
    motion = shipped("heavy_symmetric_top")
    portrait = phase_portrait(motion, letters_of(motion.arguments, model=motion.model))
    p_phi, p_psi = map(float, portrait.momenta.values())
    _, *curves = (s for s in portrait.drawing.strokes if s.kind != "space")  # after the mark
    ticks = {label.symbol.text: label.place for label in portrait.drawing.labels}
    assert len(curves) == 3
    # from the numbers beside the axes
    across, up = ticks["2"][0] - ticks["1"][0], (ticks["5"][1] - ticks["0"][1]) / 5
    for curve in (np.array(stroke.points) for stroke in curves):
        theta = 1 + (curve[:, 0] - ticks["1"][0]) / across
        rate = (curve[:, 1] - ticks["0"][1]) / up
        potential = np.cos(theta) + (p_phi - p_psi * np.cos(theta)) ** 2 / (2 * np.sin(theta) ** 2)
        energy = rate**2 / 2 + potential
        assert np.ptp(energy) < 0.005 * np.ptp(rate) ** 2


def test_captions_tell_parameters_and_initial_values_in_common_and_apart():
    told = caption_of(shipped("heavy_symmetric_top"))
    for value in ("A = 1", "l = 0.5", "θ = 0.9", "ψ̇ = 12", "φ̇ = 0, φ̇ = 0.4 and φ̇ = −0.5"):
        assert value in told
    two = rs.derive(**A_PENDULUM, examples=[FIRST, {"initial": {"theta": 3}}])
    assert "begin with" not in caption_of(two)
    assert caption_of(two).endswith(
        "in SI units and radians; all other initial values are 0. "
        "From left to right: θ = 0.5 and θ = 3."
    )
    curves = [s for s in figure_of(two).drawing.strokes if s.kind == "body"]
    assert len(curves) == 2  # without a trace, each motion is drawn over the time
    body = rs.principal_moments(*map(sp.Integer, (1, 1, 1)))
    still = rs.derive("ZYX", body=body, torque=["1", "0", "0"], examples=[{"time": 2}])
    assert caption_of(still) == "The motion in SI units and radians; all initial values are 0."


def test_a_free_body_at_rest_has_no_polhode():
    moments = dict(zip("ABC", (1, 2, 2.5), strict=True))
    example = {"parameters": moments, "initial": {"theta": 1}, "time": 2}
    still = rs.derive("ZXZ", body=A_PENDULUM["body"], potential="0", examples=[example])
    assert "polhode" not in str(figure_of(still).description)


def test_what_is_behind_a_surface_is_dashed():
    """From above, the farther half of a level circle is higher in the picture."""
    level = on_ellipsoid([circle(STANDARD[2], 0.3)], [], np.ones(3), [])
    heights = {
        is_hidden: [
            y
            for s in level.strokes
            if s.kind == "body"
            for _, y in s.points
            if s.is_hidden == is_hidden
        ]
        for is_hidden in (True, False)
    }
    assert np.mean(heights[True]) > np.mean(heights[False])


def test_numbers_and_ticks():
    for value, text in ((-0.5, "−0.5"), (1e-5, "10⁻⁵"), (-2.5e7, "−2.5·10⁷"), (123456, "123456")):
        assert decimal(value).text == text
    ticks = Range.of([0, 2e-9]).ticks  # of a small range, they differ
    assert list(ticks) == pytest.approx([0, 5e-10, 1e-9, 1.5e-9, 2e-9], rel=1e-9)


def test_an_example_takes_from_the_first_what_it_does_not_name():
    motion = rs.derive(**A_PENDULUM, examples=[FIRST, {"initial": {"theta_dot": 1}}])
    assert motion.forces.examples[1] == (NUMBERS, {"theta": 0.5, "theta_dot": 1}, 2)


@pytest.mark.parametrize(
    ("example", "message"),
    [
        ({"initial": {"thta": 1}, "time": 1}, "thta; did you mean theta?"),
        ({"initial": {"theta": 1}}, "a time > 0"),
        ({"initial": {"theta": float("nan")}, "time": 1}, "finite numbers"),
        ({"parameters": {"A": "1"}, "time": 1}, "finite numbers"),
        ({"parameters": NUMBERS | {"G": 1}, "time": 1}, "unknown parameter G; known: A, B"),
        ({"start": {"theta": 1}, "time": 1}, "start; expected parameters, initial, time"),
    ],
)
def test_an_example_that_is_none_is_refused(example, message):
    with pytest.raises(ModelError, match=message):
        rs.derive(**A_PENDULUM, examples=[example])


def test_a_motion_without_its_constants_or_too_fast_is_not_drawn():
    fast = {"parameters": NUMBERS | {"g": 1e9}, "initial": {"theta": 1}, "time": 1e3}
    for example, message in (
        ({"parameters": {"A": 1}, "time": 1}, "lacks values of g, l, m$"),
        (fast, "cannot be drawn"),
    ):
        with pytest.raises(ModelError, match=message):
            rs.derive(**A_PENDULUM, examples=[example]).note()


def test_without_the_equations_of_motion_there_is_no_picture():
    spec = replace(read("heavy_symmetric_top"), quantities=("energy",))
    assert "energy" in motion_of(spec).note(with_kernels=False).latex()


def test_a_file_tells_the_place_of_a_wrong_example():
    text = (
        '[rotation]\nsequence = "ZXZ"\n[body]\nprincipal_moments = ["A", "A", "C"]\n'
        '[dynamics]\npotential = "0"\n[[dynamics.examples]]\ninitial = { theta = "1" }\ntime = 1\n'
    )
    with pytest.raises(SpecError, match=r"dynamics.examples\[0\].initial.theta"):
        read_spec(text, source="top.toml", name="top")
