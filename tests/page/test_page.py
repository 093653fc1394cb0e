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
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.command import call
from helpers.pages import (
    Elements,
    carried,
    faults_of,
    motion_of,
    note_in,
    odd_page,
    page_of,
    script_of,
)
from rigidsym.models.body import Composite, Part
from rigidsym.models.solids import SHAPES as SOLIDS, shaped
from rigidsym.motion import derive
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import BLUE, Shape, lengths_of, meshed, own_shape
from rigidsym.notes.figure.camera import Camera, camera
from rigidsym.page.functions import OF_THE_FIGURE
from rigidsym.page.print_page import MOST_BYTES
from rigidsym.page.stage import as_data, spinning_top
from rigidsym.system import resources

SOME = (
    "unit_quaternion",
    "rotation_vector",
    "z(phi) x(theta) [0,b,c](psi)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
)
# parts move with the body, or the frame of reference turns
WITHOUT_A_PAGE = ("dual_spin_satellite",)


@cache
def shipped_pages() -> dict[str, str]:
    """The pages of all shipped derivations that have one, of few sequences."""
    names = {*resources.names("derivations", ".toml")} - {"euler_all", *WITHOUT_A_PAGE}
    return {name: page_of(name) for name in sorted(names)}


@pytest.mark.campaign
def test_every_shipped_derivation_has_a_page_of_bounded_size_with_its_whole_note():
    assert len(shipped_pages()) >= 10
    for name, page in shipped_pages().items():
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
    motion = derive("ZXZ").with_notation(angular_velocity="omega", body="superscript")
    page = motion.page()
    assert '"omega":"ω"' in page
    rays = carried(page)["scene"]["rays"]
    assert [ray["name"] for ray in rays if ray["kind"] == "body"] == ["xᴮ", "yᴮ", "zᴮ"]
    assert "Ω" not in re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


@pytest.mark.usefixtures("java")
def test_every_page_is_valid(tmp_path: Path):
    assert faults_of((*shipped_pages().values(), *map(page_of, SOME), odd_page()), tmp_path) == ""


def test_a_body_is_drawn_in_its_shape_or_with_its_moments():
    """No slider changes the lengths of what is drawn; a cuboid follows those of the moments."""
    cone, free, top = map(page_of, ("solid_cone", "free_body", "heavy_symmetric_top"))
    assert re.findall(r'id="parameters-(\d)-number"', cone) == ["0"]  # M
    assert 'id="parameters-2-number" step="any" value="0.5"' in top  # C of its first example
    assert "body" in carried(cone)
    assert ("body" in carried(free), carried(free)["moments"]) == (False, None)
    assert min(z for _, _, z in carried(top)["body"]["points"]) == 0  # on its tip
    body = rs.principal_moments(1, sp.Rational(7, 5), 2)
    page = derive("quaternion", ("state_derivative",), body=body, potential=0).page()
    assert carried(page)["moments"] == [1, 1.4, 2]


def test_a_motion_that_the_figure_cannot_show_has_no_page(tmp_path):
    done = call("page", *WITHOUT_A_PAGE, cwd=tmp_path, status=2)
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


def flow_of(page: str, times: list[float], folder: Path) -> list[dict[str, list]]:
    """Coordinates, Ω′ and R at some times, by the script of a page without its document."""
    head, _, _ = script_of(page).partition("// The page: sliders")
    file = folder / "flow.mjs"
    file.write_text(head + FLOW.replace("TIMES", str(times)), encoding="utf-8")
    done = subprocess.run(["node", file], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def newton_euler(moments, torque, start, times):
    """Ω′ and R by SciPy, where `torque` gives N′ of R."""
    tensor = np.diag(moments)

    def slopes(_, y):
        rotation, (a, b, c) = y[:9].reshape(3, 3), y[9:]
        turning = rotation @ [[0, -c, b], [c, 0, -a], [-b, a, 0]]
        forces = torque(rotation) - np.cross(y[9:], tensor @ y[9:])
        return [*turning.ravel(), *np.linalg.solve(tensor, forces)]

    span = (0, times[-1])
    y = solve_ivp(slopes, span, np.hstack(start), "DOP853", times, rtol=1e-12, atol=1e-13).y.T
    return y[:, 9:], y[:, :9].reshape(-1, 3, 3)


def check_flow(page, times, folder, omega, rotation):
    for state, w, r in zip(flow_of(page, times, folder), omega, rotation, strict=True):
        assert np.abs(np.ravel(state["omega"]) - w).max() < 1e-5
        assert np.abs(np.array(state["matrix"]) - r).max() < 1e-5


@pytest.mark.usefixtures("node")
def test_the_free_body_of_the_page_flips_as_eulers_equations_have_it(tmp_path):
    """At 17 s Ω′ = (0.01, 1, 0.01) has turned to (…, −1, …)"""
    times = [4.0, 12.0, 17.0, 18.01, 30.0]
    start = (np.eye(3).ravel(), [0.01, 1.0, 0.01])
    omega, rotation = newton_euler((1, 1.4, 2), lambda _: 0, start, times)
    assert omega[2, 1] < 0.9 < omega[1, 1] + 0.3
    check_flow(page_of("free_body"), times, tmp_path, omega, rotation)
    assert carried(page_of("free_body"))["last"] == 40


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize("method", ["lagrange", "euler"])
def test_a_heavy_body_of_the_page_moves_as_newton_and_euler_have_it(method, tmp_path):
    """In ZXZ, past the pole at a distance of some hundredths: N′ = −m g l e₃′ × Rᵀ e₃"""
    a, c = sp.symbols("A C")
    motion = derive(
        rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")),
        body=rs.principal_moments(a, a, c),
        potential="k*cos(theta)",
        method=method,
    )
    start = {"theta": 0.6, "angular_velocity_body_1": -1.5, "angular_velocity_body_2": 0.1}
    start |= {"angular_velocity_body_3": 3.0}
    values = {"A": 1.0, "C": 0.6, "k": 3.0}
    begun = motion.simulate(start, values, 1e-3, samples=2)
    times = [0.5, 1.0, 2.0, 5.0]
    third = np.array([0.0, 0.0, 1.0])
    begin = (begun.rotation_matrix[0].ravel(), [-1.5, 0.1, 3.0])
    omega, rotation = newton_euler(
        (1, 1, 0.6), lambda r: -3.0 * np.cross(third, r.T @ third), begin, times
    )
    check_flow(motion.page(start=start | values), times, tmp_path, omega, rotation)


LINES = ("rod", "ring")
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


@pytest.mark.parametrize("name", [name for name in SOLIDS if name not in LINES])
def test_any_shipped_solid_has_a_closed_mesh(name):
    shape, _ = solid(name)
    assert len(shape) >= 2
    assert is_closed(shape)


def test_the_meshes_of_solids_have_their_volumes():
    for name, exact in (
        ("box", lambda n: np.prod([*n.values()])),
        ("cylinder", lambda n: pi * n["a"] ** 2 * n["h"]),
        ("cone", lambda n: pi * n["a"] ** 2 * n["h"] / 3),
        ("torus", lambda n: 2 * pi**2 * n["a"] * n["b"] ** 2),  # not inside out: b < a
    ):
        shape, lengths = solid(name)
        assert volume(shape) == pytest.approx(exact(lengths), rel=0.05), name


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


def colors_from_the_back(shape: Shape, *angles: float) -> list[str]:
    """As they are seen along x, from a body turned by these angles."""
    frame = Rotation.from_euler("ZX", angles, degrees=True).as_matrix().T
    seen = "seenFaces(...given, cameraAt(0, 0, 1)).map(({ fill }) => fill)"
    return of_script(seen, as_data(shape), frame.tolist())


def pierced() -> Composite:
    """A long bar through a plate."""
    bar = shaped("box", (4, sp.Rational(1, 5), sp.Rational(1, 5)), density=sp.S.One)
    plate = shaped("box", (sp.Rational(1, 5), 2, 2), density=sp.S.One)
    return Composite(parts=(Part(what=bar), Part(what=plate)))


def check_order(shape: Shape, drawn: list[tuple[np.ndarray, bool]], view: Camera) -> None:
    """At points of the picture, what was drawn last is nearest to the viewer."""
    triangles = [
        (np.array([face.corners[0], *pair]), face.color == BLUE)
        for face in shape
        for pair in pairwise(face.corners[1:])
    ]
    rng, count = np.random.default_rng(1), 0
    for point in rng.uniform(-0.6, 0.6, (400, 2)):
        last = [is_bar for polygon, is_bar in drawn if is_inside(polygon, point)][-1:]
        depths = []
        for corners, is_bar in triangles:
            flat = corners @ np.array([view.right, view.up]).T
            edges = (flat[1:] - flat[0]).T
            if abs(np.linalg.det(edges)) > 1e-9:
                weights = np.linalg.solve(edges, point - flat[0])
                if weights.min() > 0.01 and weights.sum() < 0.99:
                    depth = (corners[0] + weights @ (corners[1:] - corners[0])) @ view.toward
                    depths.append((depth, is_bar))
        if last and depths:
            count += 1
            assert last[0] == max(depths)[1]
    assert count > 50


def is_inside(polygon: np.ndarray, point: np.ndarray) -> bool:
    (x, y), (dx, dy) = (polygon - point).T, (np.roll(polygon, -1, axis=0) - polygon).T
    sides = dx * y - dy * x
    return bool((sides > 0).all() or (sides < 0).all())


@pytest.mark.usefixtures("node")
def test_what_is_nearer_is_drawn_later_also_where_parts_pierce_each_other():
    """In the page and in the note, whose camera this is."""
    motion, view = rs.derive("ZXZ", body=rs.body_of(pierced())), camera(35, 24)
    shape = own_shape(motion.body)
    seen = "seenFaces(...given, cameraAt(35, 24, 1)).map(({ points, fill }) => [points, fill])"
    of_page = of_script(seen, as_data(shape), np.eye(3).tolist())
    parts = [(np.array(points), [*map(int, fill[4:-1].split())]) for points, fill in of_page]
    check_order(shape, [(points, color[2] > color[0]) for points, color in parts], view)
    drawing, _ = body_drawing(motion)
    facets = [(np.array(f.points), f.color[2] > f.color[0]) for f in drawing.facets]
    check_order(shape, facets, view)


@pytest.mark.usefixtures("node")
def test_the_top_of_a_page_is_closed_and_seen_from_any_side():
    shape = spinning_top()
    assert volume(shape) > 0.01
    assert is_closed(shape)
    assert np.linalg.norm([p for face in shape for p in face.corners], axis=1).max() < 1.3
    for angles in ([0, 0], [90, 0], [37, 58]):
        assert colors_from_the_back(shape, *angles)


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
