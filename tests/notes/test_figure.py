"""The figure of a product of turns: one geometry, two pens, labels that touch no line."""

from __future__ import annotations

import re
from itertools import combinations
from math import cos, hypot, isclose, pi, radians, sin

import pytest
import sympy as sp
from hypothesis import given, strategies as st

import rigidsym as rs
from rigidsym.formula.reader import formula, text_of
from rigidsym.formula.tree import Symbol
from rigidsym.mechanics.quantities.table import arguments_of
from rigidsym.models.library import rotation_from
from rigidsym.models.parametrisations import (
    AxisAngle,
    EulerAngles,
    GibbsVector,
    RotationVector,
    UnitQuaternion,
    axis_turn,
    chain,
)
from rigidsym.models.rotation import Citation, RotationModel, Turn, time_function
from rigidsym.models.solids import shaped
from rigidsym.notes.facts.rotation import figure_of
from rigidsym.notes.figure.camera import STANDARD, camera, combined, cross, dot, turned, unit
from rigidsym.notes.figure.drawing import (
    Box,
    Drawing,
    Ellipse,
    Label,
    Stroke,
    beyond,
    boxes,
    labelled,
)
from rigidsym.notes.figure.scene import MOST_TURNS, scene_of
from rigidsym.notes.formats.drawings import svg, tikz
from rigidsym.notes.letters import letters_of

LETTERS = "zxyzxy"
ANGLES = ("heading", "elevation", "bank")


def letters(text: str, *, names: str = "abcdef") -> RotationModel:
    """A chain of turns about coordinate axes."""
    return chain([Turn(axis=a, angle=time_function(n)) for a, n in zip(text, names, strict=False)])


def drawn(model: RotationModel):
    figure = figure_of(model, letters_of(arguments_of(model)))
    assert figure is not None
    return figure


CHAINS = {
    **{f"chain {text}": letters(text) for text in (LETTERS[:n] for n in range(1, 1 + MOST_TURNS))},
    "constant": chain(
        [
            Turn(axis="z", angle=time_function("a")),
            Turn(axis="x", angle=sp.pi / 6),
            Turn(axis="z", angle=time_function("b")),
        ]
    ),
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
    "words": EulerAngles("ZYX", ANGLES),
    "rotation vector": RotationVector(),
    "quaternion": UnitQuaternion(),
}


@pytest.fixture(params=["ZXZ", "ZYX", "xyz", *CHAINS])
def drawing(request: pytest.FixtureRequest) -> Drawing:
    model = CHAINS.get(request.param) or EulerAngles(request.param)
    return drawn(model).drawing


# --- what is in the picture ---


def test_labels_touch_no_line_and_no_other_label(drawing):
    for label, box in zip(drawing.labels, boxes(drawing.labels), strict=True):
        for stroke in drawing.strokes:
            assert not box.crossed_by(stroke.segments), (label, stroke)
    for one, other in combinations(boxes(drawing.labels), 2):
        assert not one.meets(other), (one, other)


def test_labels_stand_near_what_they_name(drawing):
    for label, box in zip(drawing.labels, boxes(drawing.labels), strict=True):
        ends = [p for s in drawing.strokes if s.kind == label.kind for p in s.points]
        reach = hypot(box.half_width, box.half_height)
        x, y = label.place
        assert min(hypot(x - a, y - b) for a, b in ends) < reach + 0.36


def test_circles_are_dashed_at_the_back(drawing):
    circles = [s for s in drawing.strokes if s.is_thin and s.kind in ("space", "body")]
    assert {s.is_hidden for s in circles} in ({True, False}, set())
    assert not any(s.is_hidden for s in drawing.strokes if not s.is_thin)


@pytest.mark.parametrize("name", ["chain zxyz", "four oblique"])
def test_many_turns_are_drawn_without_circles_and_with_their_axes_in_one_direction(name):
    strokes = drawn(CHAINS[name]).drawing.strokes
    assert not any(s.is_hidden for s in strokes)
    assert all(s.points[0] == (0, 0) for s in strokes if s.kind == "node")


def test_the_axes_do_not_run_together(drawing):
    tips = [s.points[-1] for s in drawing.strokes if s.has_arrow and s.kind != "turn"]
    for (a, b), (c, d) in combinations(tips, 2):
        assert hypot(a - c, b - d) > 0.1


@pytest.mark.parametrize("sequence", ["ZXZ", "zyx"])
def test_both_frames_the_nodes_and_three_arcs_are_shown(sequence):
    figure = drawn(EulerAngles(sequence))
    said = {kind: [] for kind in ("space", "body", "node", "turn")}
    for label in figure.drawing.labels:
        said[label.kind].append(label.symbol.text)
    assert said["space"] == ["x", "y", "z"]
    assert said["body"] == ["x′", "y′", "z′"]
    assert said["node"] == ["N"]
    in_order = ["φ", "θ", "ψ"] if sequence.isupper() else ["ψ", "θ", "φ"]
    assert said["turn"] == in_order


def test_what_the_turns_of_the_lecture_do():
    figure = drawn(EulerAngles("ZXZ"))
    assert text_of(figure.caption) == (
        "Shown are the axes x, y, z of space, the axes x′, y′, z′ of the body and the line of "
        "nodes N."
    )
    assert text_of(figure.description) == (
        "The rotation by φ about z takes x to N. The rotation by θ about N takes z to z′. "
        "The rotation by ψ about z′ takes N to x′."
    )


def test_an_axis_that_is_drawn_nowhere_is_called_turned():
    assert "The rotation by θ about N takes the rotated x to x′." in text_of(
        drawn(EulerAngles("ZYX")).description
    )


def test_one_turn_keeps_its_axis():
    figure = drawn(CHAINS["chain z"])
    assert "z = z′" in [label.symbol.text for label in figure.drawing.labels]
    assert text_of(figure.description) == "The rotation by a about z = z′ takes x to x′."


def test_the_axes_between_are_numbered():
    labels = [label.symbol for label in drawn(CHAINS["chain zxyz"]).drawing.labels]
    assert formula("N_1") in labels
    assert formula("N_2") in labels


@pytest.mark.parametrize(
    ("model", "named", "angle"),
    [
        (RotationVector(), "the vector v along the axis", "n"),
        (UnitQuaternion(), "the vector v along the axis", "α"),
        (GibbsVector(), "the vector v along the axis", "α"),
        (AxisAngle(), "the vector v along the axis", "φ"),
        (AxisAngle(("a", "b", "c", "alpha")), "the vector v along the axis", "α"),
    ],
)
def test_a_vector_is_the_axis_of_one_turn(model, named, angle):
    figure = drawn(model)
    letter = named.split()[2]
    assert text_of(figure.caption).endswith(f"z′ of the body and {named} of rotation.")
    assert text_of(figure.description) == f"The rotation by {angle} about {letter} takes x to x′."
    (vector,) = (stroke for stroke in figure.drawing.strokes if stroke.kind == "vector")
    assert vector.has_arrow
    assert vector.points[0] == (0.0, 0.0)


def test_the_axis_of_an_oblique_turn_is_no_line_of_nodes():
    assert "the axis N of a rotation" in text_of(drawn(CHAINS["oblique"]).caption)


def test_what_is_no_product_of_turns_has_no_figure():
    a = time_function("a")
    given_model = RotationModel(
        name="given",
        title="Given",
        convention=(),
        coordinates=(a,),
        matrix=Turn(axis="z", angle=a).matrix,
        source=Citation(text="a book"),
    )
    assert figure_of(given_model, letters_of(())) is None
    assert figure_of(letters(LETTERS), letters_of(())) is None
    symbolic = chain([axis_turn(sp.symbols("u v w"), a)])
    assert figure_of(symbolic, letters_of(())) is None


# --- the pens ---


def test_the_same_figure_every_time():
    first, second = (drawn(EulerAngles("XZY")) for _ in range(2))
    assert first == second
    assert tikz(first.drawing) == tikz(second.drawing)


def test_the_pens_draw_all_of_it(drawing):
    in_tex = tikz(drawing)
    in_html = svg(drawing, title="T", description="D", name="f")
    assert in_tex.count(r"\draw[") == len(drawing.strokes) == in_html.count("<polyline")
    assert in_tex.count(r"\node[") == len(drawing.labels) == in_html.count("<text")
    assert in_tex.count(r"\fill[") == len(drawing.sectors)
    assert in_tex.count(", hidden,") == in_html.count(" hidden")
    assert in_tex.count(" arc (") == sum(s.arc is not None for s in drawing.strokes) + len(
        drawing.sectors
    )
    assert "-0.0" not in re.findall(r"-0\.0+\b", in_html + in_tex)


def test_a_drawing_stays_inside_its_box(drawing):
    box = re.search(
        r'viewBox="(\S+) (\S+) (\S+) (\S+)"', svg(drawing, title="", description="", name="f")
    )
    assert box
    left, top, width, height = map(float, box.groups())
    points = re.findall(r"(-?[\d.]+),(-?[\d.]+)", svg(drawing, title="", description="", name="f"))
    assert all(left <= float(x) <= left + width for x, _ in points)
    assert all(top <= float(y) <= top + height for _, y in points)


def test_words_in_a_picture_are_escaped():
    label = Label(kind="turn", symbol=Symbol("a<b&\u202e"), place=(0.0, 0.0))
    drawing = Drawing(strokes=(Stroke(kind="turn", points=((0, 0), (1, 1))),), labels=(label,))
    written = svg(drawing, title="<t>", description='"d"', name="f")
    assert ">a&lt;b&amp; </text>" in written
    assert "&lt;t&gt;</title>" in written


# --- geometry ---

coordinates = st.floats(-2, 2, allow_nan=False)


@given(st.tuples(coordinates, coordinates, coordinates), st.floats(-7, 7))
def test_a_turn_keeps_lengths_and_its_axis(vector, angle):
    axis = unit((1.0, 2.0, 2.0))
    moved = turned(vector, axis, angle)
    assert isclose(hypot(*moved), hypot(*vector), abs_tol=1e-9)
    assert isclose(dot(moved, axis), dot(vector, axis), abs_tol=1e-9)


def test_a_turn_is_right_handed():
    x, y, z = STANDARD
    assert turned(x, z, pi / 2) == pytest.approx(y)
    assert turned(x, z, radians(30)) == pytest.approx((cos(pi / 6), sin(pi / 6), 0))


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 0), (30, 20), (75, -40)])
def test_a_camera_keeps_the_third_axis_upright(azimuth, elevation):
    for z_down in (False, True):
        view = camera(azimuth, elevation, z_down=z_down)
        across, up = view.project((0.0, 0.0, -1.0 if z_down else 1.0))
        assert across == pytest.approx(0)
        assert up == pytest.approx(cos(radians(elevation)))
        assert cross(view.right, view.up) == pytest.approx(view.toward)


@given(
    st.tuples(coordinates, coordinates),
    st.tuples(coordinates, coordinates),
)
def test_a_segment_crosses_a_box_if_one_of_its_points_is_inside(start, end):
    box = Box((0.1, -0.2), 0.7, 0.4)
    samples = [
        (start[0] + k / 200 * (end[0] - start[0]), start[1] + k / 200 * (end[1] - start[1]))
        for k in range(201)
    ]
    inside = any(abs(x - 0.1) < 0.699 and abs(y + 0.2) < 0.399 for x, y in samples)
    if inside:
        assert box.crossed_by([(start, end)])
    if not box.grown(0.02).crossed_by([(start, end)]):
        assert not inside


def test_a_label_that_has_no_free_place_takes_the_least_bad():
    hatch = [Stroke(kind="guide", points=((x / 20, -3.0), (x / 20, 3.0))) for x in range(-60, 61)]
    labels = labelled([("space", Symbol("x"), beyond([(0, 0), (1, 0)]))], hatch)
    ((label, box),) = zip(labels, boxes(labels), strict=True)
    met = [s for stroke in hatch for s in box.crossed_by(stroke.segments)]
    assert 0 < len(met) <= 3  # it is about as wide as two gaps of the hatch
    assert hypot(*label.place) < 2


@pytest.mark.parametrize("name", ["rotation vector", "oblique", "chain zxyzx", "words"])
def test_the_angle_drawn_is_the_angle_of_the_turn(name):
    """Also where the line that is carried along is not perpendicular to the axis."""
    scene = scene_of(CHAINS[name], letters_of(arguments_of(CHAINS[name])))
    assert scene is not None
    angles = scene.view.angles
    for arc, angle in zip(scene.posed(angles).arcs, angles, strict=True):
        start, end = (combined((1, -1), (v, arc.centre)) for v in (arc.before, arc.after))
        assert dot(start, arc.axis) == pytest.approx(0)
        cosine = dot(start, end) / (hypot(*start) * hypot(*end))
        assert cosine == pytest.approx(cos(angle))
        quarter = combined((0, 1), (arc.start, arc.side))
        assert quarter == pytest.approx(turned(arc.start, arc.axis, pi / 2))


def test_an_ellipse_begins_and_ends_at_its_angles():
    arc = Ellipse(centre=(1.0, 0.0), u=(2.0, 0.0), v=(0.0, 1.0), start=0.0, end=pi / 2)
    assert arc.points[0] == pytest.approx((3, 0))
    assert arc.points[-1] == pytest.approx((1, 1))


def test_the_axes_in_tikz_have_names_that_can_be_used():
    text = tikz(drawn(EulerAngles("ZXZ")).drawing)
    names = re.findall(r"\\coordinate \((.*?)\)", text)
    assert names == ["O", "x", "y", "z", "x'", "y'", "z'", "N"]
    assert r"\draw[space, ->] (O) -- (x);" in text


def test_a_turn_that_is_none_and_a_distant_body_are_drawn():
    cone = shaped("cone", sp.symbols("a h"), mass=sp.Symbol("M"))
    body = rs.body_of(rs.Composite(parts=(rs.Part(what=cone, at=sp.ImmutableMatrix([99, 0, 0])),)))
    motion = rs.derive("z(k*v) x(pi/3-pi/3) [1,2,3](point)", "rotation_matrix", body=body)
    assert "<svg" in motion.note(with_kernels=False).html()


def test_the_z_axis_of_an_aircraft_points_down_and_others_up():
    for name, sign in (("aerospace", -1), ("ZYX", 1)):
        model = rotation_from(name)
        figure = figure_of(model, letters_of((), model=model))
        z = next(label for label in figure.drawing.labels if label.symbol.text == "z")
        assert sign * z.place[1] > 1
        assert ("points down" in text_of(figure.caption)) is (sign < 0)
