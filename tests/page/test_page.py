"""The page as a file: valid, of bounded size, with its note; its bodies and its motions."""

from __future__ import annotations

import json
import re
import subprocess
from collections import Counter
from functools import cache
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.command import call
from helpers.pages import (
    MOST_BYTES,
    Elements,
    carried,
    faults_of,
    motion_of,
    note_in,
    odd_page,
    page_of,
)
from helpers.witness import newton_euler
from rigidsym.models.body import Composite, Part
from rigidsym.models.solids import SHAPES as SOLIDS, shaped
from rigidsym.motion import derive
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import BLUE, Face, Shape, lengths_of, meshed, own_shape
from rigidsym.notes.figure.scene import Camera, camera
from rigidsym.page.functions import OF_THE_FIGURE
from rigidsym.page.stage import as_data, spinning_top
from rigidsym.system import resources

SOME = (
    "unit_quaternion",
    "rotation_vector",
    "z(phi) x(theta) [0,b,c](psi)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
)
WITHOUT_A_PAGE = "dual_spin_satellite"  # its parts move
SHIPPED = sorted({*resources.names("derivations", ".toml")} - {"euler_all", WITHOUT_A_PAGE})
A, B, C = sp.symbols("A B C")


@pytest.mark.campaign
def test_every_shipped_derivation_has_a_page_of_bounded_size_with_its_whole_note():
    for name, page in zip(SHIPPED, map(page_of, SHIPPED), strict=True):
        assert len(page.encode()) <= MOST_BYTES, name
        assert note_in(page) == note_in(motion_of(name).note().html()), name
        assert all(f'id="{quantity}-value"' in page for quantity in OF_THE_FIGURE), name
        units = re.findall(r'<label for="parameters-.*?<span class="spoken">(.*?)</span>', page)
        assert all(", in " in constant for constant in units), name


@pytest.mark.parametrize("rotation", ["ZXZ", "rotation_vector"])
def test_the_words_of_the_controls(golden, rotation):
    kinds = r"<(label|button|legend|summary|option|output|figcaption)\b[^>]*>(.*?)</\1>"
    parts = re.findall(kinds, page_of(rotation), flags=re.DOTALL)
    words = [f"{kind}: {' '.join(re.sub('<.*?>', ' ', text).split())}" for kind, text in parts]
    golden(f"page/controls_{rotation}.txt", "\n".join(words) + "\n")


def test_markup_in_text_comes_out_as_text():
    page = odd_page()
    assert page.count("</script>") == page.count("<script type") == 1
    assert not Elements(page).named("img", "iframe", "object", "embed", "link", "base")
    assert not any("src" in attributes for _, attributes in Elements(page).tags)


def test_the_notation_is_that_of_the_motion():
    motion = derive("ZXZ").with_notation(angular_velocity="omega")
    page = motion.page()
    assert '"omega":"ω"' in page
    assert "Ω" not in re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


@pytest.mark.usefixtures("java")
def test_every_page_is_valid(tmp_path: Path):
    assert faults_of((*map(page_of, (*SHIPPED, *SOME)), odd_page()), tmp_path) == ""


@cache
def free_page() -> str:
    """Of a body with two slow spins, about which it flips over."""
    spins = {f"angular_velocity_body_{k}": x for k, x in ((1, 0.01), (2, 1), (3, 0.01))}
    example = {"parameters": {"A": 1, "B": 1.4, "C": 2}, "initial": spins, "time": 40}
    options = {"body": rs.principal_moments(A, B, C), "potential": 0, "examples": [example]}
    return derive("unit_quaternion", ("state_derivative",), **options).page()


def test_a_body_is_drawn_in_its_shape_or_with_its_moments():
    """No slider changes the lengths of what is drawn; a cuboid follows those of the moments."""
    cone = derive("ZXZ", ("body",), body=rs.solid("cone")).page()
    assert re.findall(r'id="parameters-(\d)-number"', cone) == ["0"]  # M
    assert "body" in carried(cone)
    free = carried(free_page())
    assert ("body" in free, free["moments"], free["last"]) == (False, None, 40)
    body = rs.principal_moments(sp.Rational(7, 5), sp.Rational(7, 5), 2)  # free, not on a tip
    page = derive("ZXZ", ("state_derivative",), body=body, potential=0).page()
    assert carried(page)["moments"] == [1.4, 1.4, 2]


def test_a_top_stands_on_its_tip_and_has_the_constants_of_its_first_example():
    page = page_of("heavy_symmetric_top")
    assert 'id="parameters-2-number" step="any" value="0.5"' in page  # C
    assert 'id="q-1" min="-180" max="180" step="1"' in page  # θ
    assert min(z for _, _, z in carried(page)["body"]["points"]) == 0


def test_a_motion_that_the_figure_cannot_show_has_no_page(tmp_path):
    done = call("page", WITHOUT_A_PAGE, cwd=tmp_path, status=2)
    assert "there is no live page of this motion, since its figure" in done.stderr
    assert not list(tmp_path.rglob("*.html"))


FLOW = """
settle();
begin();
const states = TIMES.map((time) => goTo(time) && {
  q: state.q, omega: evaluated("angular_velocity_body"), matrix: evaluated("rotation_matrix"),
});
console.log(JSON.stringify(states));
"""


def check_flow(page, moments, torque, rotation, spin, times, folder):
    """Ω′ and R of the script of a page, with those of SciPy, where `torque` gives N′ of R."""
    (script,) = re.findall(r'<script type="module">(.*)// The page: sliders', page, re.DOTALL)
    file = folder / "flow.mjs"
    file.write_text(script + FLOW.replace("TIMES", str(times)), encoding="utf-8")
    done = subprocess.run(["node", file], capture_output=True, text=True, check=True)
    omega, matrices = newton_euler(moments, torque, spin, times, rotation)
    states = json.loads(done.stdout)
    for name, expected in (("omega", omega), ("matrix", matrices)):
        found = np.reshape([state[name] for state in states], expected.shape)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5)
    return omega


@pytest.mark.usefixtures("node")
def test_the_free_body_of_the_page_flips_as_eulers_equations_have_it(tmp_path):
    times, spin = [4.0, 12.0, 17.0, 18.01, 30.0], [0.01, 1.0, 0.01]
    omega = check_flow(free_page(), (1, 1.4, 2), lambda _: 0, np.eye(3), spin, times, tmp_path)
    assert omega[2, 1] < 0.9 < omega[1, 1] + 0.3


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize("method", ["lagrange", "euler"])
def test_a_heavy_body_of_the_page_moves_as_newton_and_euler_have_it(method, tmp_path):
    """In ZXZ, past the pole at a distance of some hundredths: N′ = −m g l e₃′ × Rᵀ e₃"""
    body = rs.principal_moments(A, A, C)
    only, acting = ("state_derivative",), {"potential": "k*cos(theta)", "method": method}
    motion = derive("ZXZ", only, body=body, **acting)
    spin, third = [-1.5, 0.1, 3.0], np.array([0.0, 0.0, 1.0])
    start = {"theta": 0.6, **{f"angular_velocity_body_{k + 1}": x for k, x in enumerate(spin)}}
    start |= {"A": 1.0, "C": 0.6, "k": 3.0}
    begun = Rotation.from_euler("ZXZ", [0, 0.6, 0]).as_matrix()
    page, times = motion.page(start=start), [0.5, 1.0, 2.0, 5.0]

    def torque(r):
        return -3.0 * np.cross(third, r.T @ third)

    check_flow(page, (1, 1, 0.6), torque, begun, spin, times, tmp_path)


CORNERS = (0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)


def volume(shape: Shape) -> float:
    return sum(
        np.linalg.det([face.corners[0], p, q]) / 6
        for face in shape
        for p, q in pairwise(face.corners[1:])
    )


def is_closed(shape: Shape) -> bool:
    """Whether each edge is passed as often in one direction as in the other."""
    rounded = [[tuple(np.round(p, 6) + 0.0) for p in face.corners] for face in shape]
    passed = Counter(edge for c in rounded for edge in zip(c, (*c[1:], c[0]), strict=True))
    return all(passed[b, a] == count for (a, b), count in passed.items())


def solid(name: str) -> tuple[Shape, dict]:
    """The mesh of a shipped solid, with the lengths that were chosen for it."""
    kind = SOLIDS[name]
    symbols = sp.symbols(kind.names, positive=True) if not kind.has_corners else CORNERS
    what = shaped(name, symbols, mass=sp.Symbol("M", positive=True))
    numbers = lengths_of(what, dict.fromkeys(() if kind.has_corners else symbols))
    assert numbers is not None
    return meshed(what, numbers), {str(key): float(value) for key, value in numbers.items()}


VOLUMES = {
    "box": lambda n: np.prod([*n.values()]),
    "cylinder": lambda n: pi * n["a"] ** 2 * n["h"],
    "cone": lambda n: pi * n["a"] ** 2 * n["h"] / 3,
    "torus": lambda n: 2 * pi**2 * n["a"] * n["b"] ** 2,  # not inside out: b < a
}


@pytest.mark.parametrize("name", SOLIDS)
def test_the_mesh_of_a_solid_is_closed_and_has_its_volume(name):
    shape, lengths = solid(name)
    assert len(shape) >= 2
    assert is_closed(shape)
    if name in VOLUMES:
        assert volume(shape) == pytest.approx(VOLUMES[name](lengths), rel=0.05)


def of_script(expression: str, *values: object):
    """An expression of the figure's script, in which `given` is the list of values."""
    script = resources.text("templates", "page/figure.js")
    line = f"const given = {json.dumps(values)};\nconsole.log(JSON.stringify({expression}));"
    done = subprocess.run(
        ["node", "--input-type=module", "-"],
        input=f"{script}\n{line}",
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def check_order(shape: Shape, drawn: list[tuple[np.ndarray, bool]], view: Camera) -> None:
    """At points of the picture, what was drawn last of two cuboids is nearest to the viewer."""
    halves = [
        np.max([np.abs(f.corners).max(0) for f in shape if (f.color == BLUE) == is_bar], axis=0)
        for is_bar in (False, True)
    ]
    toward, count = np.array(view.toward), 0
    for point in np.random.default_rng(1).uniform(-0.6, 0.6, (1500, 2)):
        start = point @ np.array([view.right, view.up])
        ends = [(np.array([half, -half]) - start) / toward for half in halves]
        sizes = [(np.max(end, 0).min(), np.min(end, 0).max()) for end in ends]  # of each ray
        depths = [leaves for leaves, enters in sizes if leaves > enters + 0.01]
        last = [is_bar for polygon, is_bar in drawn if is_inside(polygon, point)][-1:]
        if last and len(depths) == 2:
            count += 1
            assert last[0] == (depths[1] > depths[0])
    assert count > 50


def is_inside(polygon: np.ndarray, point: np.ndarray) -> bool:
    (x, y), (dx, dy) = (polygon - point).T, (np.roll(polygon, -1, axis=0) - polygon).T
    sides = dx * y - dy * x
    return bool((sides > 0).all() or (sides < 0).all())


@pytest.mark.usefixtures("node")
def test_what_is_nearer_is_drawn_later_also_where_parts_pierce_each_other():
    """In the page and in the note, whose camera this is: a long bar through a plate"""
    fifth, view = sp.Rational(1, 5), camera(35, 24)
    sides = ((4, fifth, fifth), (fifth, 2, 2))
    parts = tuple(Part(what=shaped("box", each, density=sp.S.One)) for each in sides)
    motion = rs.derive("ZXZ", ("body",), body=rs.body_of(Composite(parts=parts)))
    shape = own_shape(motion.body)
    seen = "seenFaces(...given, cameraAt(35, 24, 1)).map(({ points, fill }) => [points, fill])"
    of_page = of_script(seen, as_data(shape), np.eye(3).tolist())
    colored = [(np.array(points), [*map(int, fill[4:-1].split())]) for points, fill in of_page]
    check_order(shape, [(points, color[2] > color[0]) for points, color in colored], view)
    drawing, _ = body_drawing(motion)
    facets = [
        (np.array(f.points), f.color[2] > f.color[0]) for f in drawing.body if hasattr(f, "color")
    ]
    check_order(shape, facets, view)
    away = sp.ImmutableMatrix([round(5 * x) for x in view.toward])
    cube = shaped("box", (1, 1, 1), density=sp.S.One)
    apart = Composite(parts=(Part(what=cube, at=away), Part(what=cube, at=-away)))
    drawing, _ = body_drawing(rs.derive("ZXZ", ("body",), body=rs.body_of(apart)))
    is_nearer = [f.color[2] > f.color[0] for f in drawing.body if hasattr(f, "color")]
    assert is_nearer == sorted(is_nearer)


@pytest.mark.usefixtures("node")
def test_the_top_of_a_page_is_closed_and_seen_from_any_side():
    shape = [Face(np.round(corners, 9) + 0.0, color) for corners, color in spinning_top()]
    assert volume(shape) > 0.01
    assert is_closed(shape)
    assert np.linalg.norm([p for face in shape for p in face.corners], axis=1).max() < 1.3
    for angles in ([0, 0], [90, 0], [37, 58]):
        frame = Rotation.from_euler("ZX", angles, degrees=True).as_matrix().T
        assert of_script("seenFaces(...given, cameraAt(0, 0, 1))", as_data(shape), frame.tolist())


@pytest.mark.usefixtures("node")
def test_the_cuboid_of_a_motion_has_the_moments_of_the_body():
    """I₁ = m (b² + c²)/12 and so on, up to the size"""
    moments = [1.0, 1.4, 2.0]
    body = of_script("cuboidOf(given)", *moments)
    x, y, z = np.ptp(body["points"], axis=0)
    ratios = np.array([y * y + z * z, z * z + x * x, x * x + y * y])
    np.testing.assert_allclose(ratios / ratios[0], np.array(moments) / moments[0], rtol=1e-12)
    for corners in (np.array([body["points"][k] for k in side]) for _, *side in body["faces"]):
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        assert normal @ corners.mean(axis=0) > 0  # it looks outward
