"""The figure of a product of turns: one geometry, two pens, labels that touch no line."""

from __future__ import annotations

import re
from itertools import combinations, pairwise
from math import cos, hypot, pi, radians

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, strategies as st

import rigidsym as rs
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import EulerAngles, axis_turn, chain
from rigidsym.models.rotation import Citation, RotationModel, Turn, time_function
from rigidsym.models.solids import shaped
from rigidsym.notes.facts.rotation import RotationFacts
from rigidsym.notes.figure.camera import STANDARD, camera, turned, unit
from rigidsym.notes.figure.drawing import (
    Box,
    Drawing,
    Ellipse,
    Label,
    Stroke,
    beyond,
    boxes,
    labelled,
    segments_of,
)
from rigidsym.notes.figure.scene import scene_of
from rigidsym.notes.formats.drawings import svg, tikz
from rigidsym.notes.letters import letters_of

LETTERS = "zxyzxy"  # one more turn than is drawn


def figure_of(model, letters):
    return RotationFacts(model, letters).figure


def letters(text: str) -> RotationModel:
    """A chain of turns about coordinate axes."""
    pairs = zip(text, "abcdef", strict=False)
    return chain([Turn(axis=axis, angle=time_function(name)) for axis, name in pairs])


def drawn(model: RotationModel):
    figure = figure_of(model, letters_of(arguments_of(model)))
    assert figure is not None
    return figure


CHAINS = {
    **{f"chain {text}": letters(text) for text in ("z", "zxyz", "zxyzx")},
    "right angle": chain(
        [Turn(axis="z", angle=sp.pi / 2), Turn(axis="x", angle=time_function("a"))]
    ),
    "oblique": chain(
        [
            Turn(axis="z", angle=time_function("a")),
            axis_turn((sp.Rational(3, 5), 0, sp.Rational(4, 5)), time_function("b")),
        ]
    ),
    "four oblique": rotation_from("z(a) [1,2,2](b) x(c) [0,3,4](d)"),
    "words": EulerAngles("ZYX", ("heading", "elevation", "bank")),
    "vector": rotation_from("rotation_vector"),
}


@pytest.fixture(params=["ZXZ", "xyz", *CHAINS])
def drawing(request: pytest.FixtureRequest) -> Drawing:
    return drawn(CHAINS.get(request.param) or EulerAngles(request.param)).drawing


# --- what is in the picture


def test_labels_touch_nothing_and_stand_near_what_they_name(drawing):
    segments = segments_of(drawing.strokes)
    for label, box in zip(drawing.labels, boxes(drawing.labels), strict=True):
        assert box.crossings(segments) == 0, label
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


def test_many_turns_are_drawn_without_circles_and_with_their_axes_in_one_direction():
    strokes = drawn(CHAINS["four oblique"]).drawing.strokes
    assert not any(s.is_hidden for s in strokes)
    assert all(s.points[0] == (0, 0) for s in strokes if s.kind == "node")
    labels = [label.symbol for label in drawn(CHAINS["chain zxyz"]).drawing.labels]
    assert {formula("N_1"), formula("N_2")} <= {*labels}


@pytest.mark.parametrize(("sequence", "angles"), [("ZXZ", "φθψ"), ("zyx", "ψθφ")])
def test_both_frames_the_nodes_and_three_arcs_are_shown(sequence, angles):
    said = {kind: [] for kind in ("space", "body", "node", "turn")}
    for label in drawn(EulerAngles(sequence)).drawing.labels:
        said[label.kind].append(label.symbol.text)
    assert said == {
        "space": ["x", "y", "z"],
        "body": ["x′", "y′", "z′"],
        "node": ["N"],
        "turn": [*angles],
    }


def test_the_words_below_say_what_each_turn_does():
    zxz, zyx = drawn(EulerAngles("ZXZ")), drawn(EulerAngles("ZYX"))
    assert text_of(zxz.description) == (
        "The rotation by φ about z takes x to N. The rotation by θ about N takes z to z′. "
        "The rotation by ψ about z′ takes N to x′."
    )
    # an axis that is drawn nowhere
    assert "The rotation by θ about N takes the rotated x to x′." in text_of(zyx.description)
    one = drawn(CHAINS["chain z"])
    assert "z = z′" in [label.symbol.text for label in one.drawing.labels]
    assert text_of(one.description) == "The rotation by a about z = z′ takes x to x′."
    assert "the axis N of a rotation" in text_of(drawn(CHAINS["oblique"]).caption)


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        ("rotation_vector", "n"),
        ("unit_quaternion", "α"),
        ("gibbs_vector", "α"),
        ("axis_angle", "φ"),
    ],
)
def test_a_vector_is_the_axis_of_one_turn(name, angle):
    figure = drawn(rotation_from(name))
    assert text_of(figure.caption).endswith("and the vector v along the axis of rotation.")
    assert text_of(figure.description) == f"The rotation by {angle} about v takes x to x′."
    (vector,) = (stroke for stroke in figure.drawing.strokes if stroke.kind == "vector")
    assert (vector.has_arrow, vector.points[0]) == (True, (0.0, 0.0))


def test_what_is_no_product_of_few_turns_has_no_figure():
    a = time_function("a")
    matrix = RotationModel(
        name="matrix",
        title="Matrix",
        convention=(),
        coordinates=(a,),
        matrix=Turn(axis="z", angle=a).matrix,
        source=Citation(text="a book"),
    )
    symbolic = chain([axis_turn(sp.symbols("u v w"), a)])
    for model in (matrix, letters(LETTERS), symbolic):
        assert figure_of(model, letters_of(())) is None


def test_the_z_axis_of_an_aircraft_points_down_and_others_up():
    for name, sign in (("aerospace", -1), ("ZYX", 1)):
        model = rotation_from(name)
        figure = figure_of(model, letters_of((), model=model))
        z = next(label for label in figure.drawing.labels if label.symbol.text == "z")
        assert sign * z.place[1] > 1
        assert ("points down" in text_of(figure.caption)) is (sign < 0)


# --- the pens


def test_the_pens_draw_all_of_it_inside_the_box(drawing):
    in_tex = tikz(drawing)
    in_html = svg(drawing, title="T", description="D", name="f")
    assert in_tex.count(r"\draw[") == len(drawing.strokes) == in_html.count("<polyline")
    assert in_tex.count(r"\node[") == len(drawing.labels) == in_html.count("<text")
    assert in_tex.count(r"\fill[") == len(drawing.sectors)
    assert in_tex.count(", hidden,") == in_html.count(" hidden")
    arcs = sum(s.arc is not None for s in drawing.strokes)
    assert in_tex.count(" arc (") == arcs + len(drawing.sectors)
    assert not re.findall(r"-0\.0+\b", in_html + in_tex)
    (box,) = re.findall(r'viewBox="(\S+) (\S+) (\S+) (\S+)"', in_html)
    left, top, width, height = map(float, box)
    for x, y in re.findall(r"(-?[\d.]+),(-?[\d.]+)", in_html):
        assert left <= float(x) <= left + width
        assert top <= float(y) <= top + height


def test_words_in_a_picture_are_escaped():
    label = Label(kind="turn", symbol=Symbol("a<b&\u202e"), place=(0.0, 0.0))
    drawing = Drawing(strokes=(Stroke(kind="turn", points=((0, 0), (1, 1))),), labels=(label,))
    written = svg(drawing, title="<t>", description='"d"', name="f")
    assert ">a&lt;b&amp; </text>" in written
    assert "&lt;t&gt;</title>" in written


def test_the_axes_in_tikz_have_names_that_can_be_used():
    text = tikz(drawn(EulerAngles("ZXZ")).drawing)
    names = re.findall(r"\\coordinate \((.*?)\)", text)
    assert names == ["O", "x", "y", "z", "x'", "y'", "z'", "N"]
    assert r"\draw[space, ->] (O) -- (x);" in text


# --- geometry

coordinates = st.floats(-2, 2, allow_nan=False)
points = st.tuples(coordinates, coordinates)


@given(st.tuples(coordinates, coordinates, coordinates), st.floats(-7, 7))
def test_a_turn_keeps_lengths_and_its_axis(vector, angle):
    axis = unit(np.array([1.0, 2.0, 2.0]))
    moved = turned(np.array(vector), axis, angle)
    assert np.linalg.norm(moved) == pytest.approx(np.linalg.norm(vector), abs=1e-9)
    assert moved @ axis == pytest.approx(np.array(vector) @ axis, abs=1e-9)
    x, y, z = STANDARD
    assert turned(x, z, pi / 2) == pytest.approx(y)  # right-handed


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (75, -40)])
def test_a_camera_keeps_the_third_axis_upright(azimuth, elevation):
    for z_down in (False, True):
        view = camera(azimuth, elevation, z_down=z_down)
        across, up = view.project(np.array([0.0, 0.0, -1.0 if z_down else 1.0]))
        assert across == pytest.approx(0)
        assert up == pytest.approx(cos(radians(elevation)))
        assert np.cross(view.right, view.up) == pytest.approx(view.toward)


@given(points, points)
def test_a_segment_crosses_a_box_if_one_of_its_points_is_inside(start, end):
    box = Box((0.1, -0.2), 0.7, 0.4)
    along = np.linspace(start, end, 201)
    inside = (np.abs(along - box.centre) < (0.699, 0.399)).all(axis=1).any()
    segment = np.array([[start, end]])
    assert box.grown(0.02).crossings(segment) >= inside
    assert box.crossings(segment) >= inside
    if not box.grown(0.02).crossings(segment):
        assert not inside


def test_a_label_that_has_no_free_place_takes_the_least_bad():
    hatch = [Stroke(kind="guide", points=((x / 20, -3.0), (x / 20, 3.0))) for x in range(-60, 61)]
    labels = labelled([("space", Symbol("x"), beyond([(0, 0), (1, 0)]))], hatch)
    ((label, box),) = zip(labels, boxes(labels), strict=True)
    assert 0 < box.crossings(segments_of(hatch)) <= 3  # it is about as wide as two gaps
    assert hypot(*label.place) < 2


@pytest.mark.parametrize("name", ["vector", "oblique", "chain zxyzx", "words"])
def test_the_angle_drawn_is_the_angle_of_the_turn(name):
    """Also where the line that is carried along is not perpendicular to the axis."""
    scene = scene_of(CHAINS[name], letters_of(arguments_of(CHAINS[name])))
    assert scene is not None
    for arc, angle in zip(scene.posed(scene.view.angles).arcs, scene.view.angles, strict=True):
        start, end = arc.before - arc.centre, arc.after - arc.centre
        assert start @ arc.axis == pytest.approx(0)
        assert unit(start) @ unit(end) == pytest.approx(cos(angle))
        assert arc.side == pytest.approx(turned(arc.start, arc.axis, pi / 2))


def test_an_ellipse_begins_and_ends_at_its_angles():
    arc = Ellipse(centre=(1.0, 0.0), u=(2.0, 0.0), v=(0.0, 1.0), start=0.0, end=pi / 2)
    assert np.array(arc.points)[[0, -1]] == pytest.approx(np.array([(3, 0), (1, 1)]))
    assert all(hypot(a - c, b - d) < 0.3 for (a, b), (c, d) in pairwise(arc.points))


def test_a_turn_that_is_none_and_a_distant_body_are_drawn():
    cone = shaped("cone", sp.symbols("a h"), mass=sp.Symbol("M"))
    body = rs.body_of(rs.Composite(parts=(rs.Part(what=cone, at=sp.ImmutableMatrix([99, 0, 0])),)))
    motion = rs.derive("z(k*v) x(pi/3-pi/3) [1,2,3](point)", "rotation_matrix", body=body)
    assert "<svg" in motion.note(with_kernels=False).html()
