"""The figure of a product of turns: one geometry, two pens, labels that touch no line."""

from __future__ import annotations

import re
from itertools import combinations, pairwise
from math import cos, hypot, pi

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import ModelError
from rigidsym.formula.reader import decimal, text_of
from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import EulerAngles, axis_turn, chain, given
from rigidsym.models.rotation import RotationModel, elementary, time_function
from rigidsym.models.solids import shaped
from rigidsym.notes.facts.rotation import RotationFacts
from rigidsym.notes.figure import motion_picture
from rigidsym.notes.figure.drawing import Drawing, Label, Stroke, boxes
from rigidsym.notes.figure.motion_picture import circle, on_ellipsoid
from rigidsym.notes.figure.scene import combined, dot, scene_of, turned, unit
from rigidsym.notes.formats.drawings import svg, tikz
from rigidsym.notes.letters import letters_of


def letters(text: str) -> RotationModel:
    return rotation_from(" ".join(map("{}({})".format, text, "abcdef")))


def drawn(model: RotationModel):
    return RotationFacts(model, letters_of(arguments_of(model), model=model)).figure


CHAINS = {
    **{f"chain {text}": letters(text) for text in ("z", "zxyz", "zxyzx")},
    "right angle": rotation_from("z(pi/2) x(a)"),
    "oblique": rotation_from("z(a) [3,0,4](b)"),
    "four oblique": rotation_from("z(a) [1,2,2](b) x(c) [0,3,4](d)"),
    "words": EulerAngles("ZYX", ("heading", "elevation", "bank")),
    "vector": rotation_from("rotation_vector"),
}


@pytest.fixture(params=["ZXZ", "xyz", *CHAINS])
def drawing(request: pytest.FixtureRequest) -> Drawing:
    return drawn(CHAINS.get(request.param) or EulerAngles(request.param)).drawing


def test_labels_touch_nothing_and_stand_near_what_they_name(drawing):
    lines = [np.linspace(*pair, 50) for s in drawing.strokes for pair in pairwise(s.points)]
    on_lines = np.concatenate(lines)
    for label, box in zip(drawing.labels, boxes(drawing.labels), strict=True):
        half = (box.half_width, box.half_height)
        assert not (np.abs(on_lines - box.centre) < half).all(axis=1).any(), label
        ends = [p for s in drawing.strokes if s.kind == label.kind for p in s.points]
        x, y = label.place
        assert min(hypot(x - a, y - b) for a, b in ends) < (
            hypot(box.half_width, box.half_height) + 0.36
        )
    for one, other in combinations(boxes(drawing.labels), 2):
        assert not one.meets(other), (one, other)


def test_lines_are_dashed_at_the_back_and_do_not_run_together(drawing):
    circles = [s for s in drawing.strokes if s.is_thin and s.kind in ("space", "body")]
    assert {s.is_hidden for s in circles} in ({True, False}, set())
    assert not any(s.is_hidden for s in drawing.strokes if not s.is_thin)
    tips = [s.points[-1] for s in drawing.strokes if s.has_arrow and s.kind != "turn"]
    for (a, b), (c, d) in combinations(tips, 2):
        assert hypot(a - c, b - d) > 0.1


TURNS = {
    "rotation_vector": ("n", "v"),
    "unit_quaternion": ("α", "v"),
    "gibbs_vector": ("α", "g"),
    "axis_angle": ("φ", "e"),
}


@pytest.mark.parametrize("name", TURNS)
def test_a_vector_is_the_axis_of_one_turn(name):
    figure, (angle, axis) = drawn(rotation_from(name)), TURNS[name]
    assert text_of(figure.caption).endswith(f"and the vector {axis} along the axis of rotation.")
    assert text_of(figure.description) == f"The rotation by {angle} about {axis} takes x to x′."
    (vector,) = (stroke for stroke in figure.drawing.strokes if stroke.kind == "vector")
    assert (vector.has_arrow, vector.points[0]) == (True, (0.0, 0.0))


def test_what_is_no_product_of_few_turns_has_no_figure():
    a = time_function("a")
    matrix = given(elementary("z", a), name="matrix")
    symbolic = chain([axis_turn(sp.symbols("u v w"), a)])
    assert list(map(drawn, (matrix, letters("zxyzxy"), symbolic))) == [None] * 3


def test_the_z_axis_of_an_aircraft_points_down_and_others_up():
    for name, sign in (("aerospace", -1), ("ZYX", 1)):
        figure = drawn(rotation_from(name))
        z = next(label for label in figure.drawing.labels if label.symbol.text == "z")
        assert sign * z.place[1] > 1
        assert ("points down" in text_of(figure.caption)) is (sign < 0)


def test_the_pens_draw_all_of_it_inside_the_box(drawing):
    in_tex = tikz(drawing)
    in_html = svg(drawing, title="T", description="D", name="f")
    assert in_tex.count(r"\draw[") == len(drawing.strokes) == in_html.count("<polyline")
    assert in_tex.count(r"\node[") == len(drawing.labels) == in_html.count("<text")
    turns = [s for s in drawing.strokes if s.kind == "turn"]
    assert in_tex.count(r"\fill[") == in_html.count('class="area') == len(turns)
    assert in_tex.count(", hidden]") == in_html.count(" hidden")
    assert not re.findall(r"-0\.0+\b", in_html + in_tex)
    (box,) = re.findall(r'viewBox="(\S+) (\S+) (\S+) (\S+)"', in_html)
    left, top, width, height = map(float, box)
    for x, y in re.findall(r"(-?[\d.]+),(-?[\d.]+)", in_html):
        assert left <= float(x) <= left + width
        assert top <= float(y) <= top + height


def test_words_in_a_picture_are_escaped():
    label = Label(kind="turn", symbol=Symbol("a<b&\u202e"), place=(0.0, 0.0))
    stroke = Stroke(kind="turn", points=((0, 0), (1, 1)))
    written = svg(Drawing(strokes=(stroke,), labels=(label,)), title="<t>", description="", name="")
    assert ">a&lt;b&amp; </text>" in written
    assert "&lt;t&gt;</title>" in written


@pytest.mark.parametrize("name", ["vector", "oblique", "chain zxyzx", "words"])
def test_the_angle_drawn_is_the_angle_of_the_turn(name):
    """Also where the line that is carried along is not perpendicular to the axis."""
    scene = scene_of(CHAINS[name], letters_of(arguments_of(CHAINS[name])))
    assert scene is not None
    for arc, angle in zip(scene.posed(scene.view.angles).arcs, scene.view.angles, strict=True):
        end = combined((1, -1), (arc.after, arc.centre))
        assert dot(arc.start, arc.axis) == pytest.approx(0)
        assert dot(unit(arc.start), unit(end)) == pytest.approx(cos(angle))
        assert arc.side == pytest.approx(turned(arc.start, arc.axis, pi / 2))


def test_a_turn_that_is_none_and_a_distant_body_are_drawn():
    cone = shaped("cone", sp.symbols("a h"), mass=sp.Symbol("M"))
    body = rs.body_of(rs.Composite(parts=(rs.Part(what=cone, at=sp.ImmutableMatrix([99, 0, 0])),)))
    motion = rs.derive("z(k*v) x(pi/3-pi/3) [1,2,3](point)", "rotation_matrix", body=body)
    assert "<svg" in motion.note(with_kernels=False).html()


A_PENDULUM = {
    "model": "x(theta)",
    "body": rs.principal_moments(*sp.symbols("A B C")),
    "potential": "-m*g*l*cos(theta)",
}
NUMBERS = {"A": 1, "B": 1, "C": 1, "m": 1, "g": 10, "l": 1}
FIRST = {"parameters": NUMBERS, "initial": {"theta": 0.5}, "time": 2}


def picture_of(motion: rs.Motion):
    return motion.note(with_kernels=False).document.figures[-1]


def test_a_body_that_spins_about_its_third_axis_keeps_this_axis_and_its_angular_velocity():
    spinning = {"initial": {"theta": 0.9, "psi_dot": 12}, "time": 1}
    body = rs.principal_moments(1, 1, 2)
    picture = picture_of(rs.derive("ZXZ", body=body, potential=0, examples=[spinning]))
    curves = [s.points for s in picture.drawing.strokes if s.kind == "body"]
    assert len(curves) == 2
    assert max(np.ptp(curve, axis=0).max() for curve in curves) < 1e-6


def test_captions_tell_parameters_and_initial_values_in_common_and_apart():
    two = rs.derive(**A_PENDULUM, examples=[FIRST, {"initial": {"theta": 3}}])
    assert text_of(picture_of(two).caption).endswith(
        "in SI units and radians; all other initial values are 0. "
        "From left to right: θ = 0.5 and θ = 3."
    )


def test_polhodes_are_closed_curves_of_constant_momentum_and_energy():
    moments = np.array([1, 1.4, 2])
    for start in ([0.01, 1, 0.01], [0.01, -1, -0.01], [1, 0.5, 0], [0, 0.1, -1], [0, 1, 0]):
        start = np.array(start) / np.linalg.norm(start)
        curve = motion_picture.polhode(moments, start)
        assert np.allclose(curve[0], curve[-1], atol=1e-12)
        assert np.allclose(curve**2 @ moments, moments @ start**2)
        assert np.allclose(np.linalg.norm(curve, axis=1), 1)
        assert np.linalg.norm(curve - start, axis=1).min() < 0.02


def test_what_is_behind_a_surface_is_dashed():
    """From above, the farther half of a level circle is higher in the picture."""
    level = on_ellipsoid([circle(np.eye(3)[2], 0.3)], [], np.ones(3), [])
    farther, nearer = (
        [y for s in level.strokes if s.kind == "body" and s.is_hidden == h for _, y in s.points]
        for h in (True, False)
    )
    assert np.mean(farther) > np.mean(nearer)


def test_the_outline_of_an_ellipsoid_bounds_its_picture():
    points = np.random.default_rng(1).normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    drawing = on_ellipsoid([points], [], np.array([1.0, 0.6, 0.4]), [])
    outline, *pieces = drawing.strokes
    inside = np.array([point for piece in pieces for point in piece.points])
    for direction in ((1, 0), (0, 1), (0.6, -0.8)):
        reach = np.max(np.array(outline.points) @ direction)
        assert reach == pytest.approx(np.max(inside @ direction), abs=0.01)


def test_numbers_of_captions():
    for value, text in ((-0.5, "−0.5"), (1e-5, "10⁻⁵"), (-2.5e7, "−2.5·10⁷"), (123456, "123456")):
        assert decimal(value).text == text


def test_an_example_takes_from_the_first_what_it_does_not_name():
    motion = rs.derive(**A_PENDULUM, examples=[FIRST, {"initial": {"theta_dot": 1}}])
    assert motion.forces.examples[1] == (NUMBERS, {"theta": 0.5, "theta_dot": 1}, 2)


REFUSED = {
    "a time > 0": {"initial": {"theta": 1}},
    "needs finite numbers": {"initial": {"theta": float("nan")}, "time": 1},
    "finite numbers, and a time > 0": {"parameters": {"A": "1"}, "time": 1},
    "unknown parameter G; known: A, B": {"parameters": NUMBERS | {"G": 1}, "time": 1},
    "start; expected parameters, initial, time": {"start": {"theta": 1}, "time": 1},
}


@pytest.mark.parametrize("message", REFUSED)
def test_an_example_that_is_none_is_refused(message):
    with pytest.raises(ModelError, match=message):
        rs.derive(**A_PENDULUM, examples=[REFUSED[message]])


def test_a_motion_without_its_constants_or_too_fast_is_not_drawn(monkeypatch):
    monkeypatch.setattr(motion_picture, "_MOST_STEPS", 4)
    fast = {"parameters": NUMBERS | {"g": 1e9}, "initial": {"theta": 1}, "time": 1e3}
    for example, message in (
        ({"parameters": {"A": 1}, "time": 1}, "missing parameters: B, C, g, l, m$"),
        (fast, "cannot be drawn"),
    ):
        with pytest.raises(ModelError, match=message):
            rs.derive(**A_PENDULUM, examples=[example]).note()
