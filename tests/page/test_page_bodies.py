"""Bodies as flat faces: closed surfaces that look outward, drawn from back to front."""

from __future__ import annotations

import json
import subprocess
from collections import Counter
from itertools import combinations, pairwise
from math import pi

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.models.body import Composite, Part, Particle, Particles
from rigidsym.models.solids import SHAPES as SOLIDS, shaped
from rigidsym.notes.figure.body_drawing import body_drawing
from rigidsym.notes.figure.body_mesh import BLUE, HOLE, Shape, lengths_of, meshed, own_shape
from rigidsym.notes.figure.camera import Camera, camera
from rigidsym.page.stage import as_data, body_of_page
from rigidsym.system import resources

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


def test_the_body_of_a_derivation_is_drawn_about_its_centre_of_mass():
    shape = own_shape(rs.derive("ZXZ", body=rs.solid("cone")).body)
    points = np.array([p for face in shape for p in face.corners])
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(0.95)
    low, high = sorted(abs(end(points[:, 2])) for end in (np.min, np.max))
    assert low == pytest.approx(high / 3)
    assert own_shape(None) == ()


def test_holes_are_drawn():
    box = shaped("box", (2, 2, 1), density=sp.S.One)
    hole = shaped("cylinder", (sp.Rational(1, 2), 1), density=sp.S.One)
    pierced = meshed(Composite(parts=(Part(what=box), Part(what=hole, hole=True))), {})
    assert list(HOLE) in [list(color) for color in as_data(pierced)["colors"]]


def test_particles_are_drawn_apart_however_small_the_body_is():
    """A molecule of water, in metres."""
    near, far = sp.Rational(96, 10**12), sp.Rational(152, 10**12)
    at = [(0, 0, 0), (near, 0, 0), (0, far, 0)]
    masses = [Particle(mass=sp.S.One, position=sp.ImmutableMatrix(p)) for p in at]
    shape = own_shape(rigid_body(Particles(particles=tuple(masses))))
    assert len(shape) == 24
    parts = [np.array([face.corners for face in shape[k : k + 8]]) for k in (0, 8, 16)]
    centres = [part.mean(axis=(0, 1)) for part in parts]
    sizes = [np.ptp(part, axis=(0, 1)).max() for part in parts]
    assert max(sizes) < min(np.linalg.norm(a - b) for a, b in combinations(centres, 2)) / 2


# --- in the script of the page


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


def test_axes_leave_a_body_at_its_surface():
    drawing, _ = body_drawing(
        rs.derive("ZXZ", body=rs.body_of(shaped("box", (4, 2, 1), mass=sp.S.One)))
    )
    scale = 0.95 / np.linalg.norm([2, 1, 0.5])
    for stroke, half, axis in zip(drawing.strokes, (2, 1, 0.5), np.eye(3), strict=False):
        end = camera(35, 24).project(scale * half * axis)
        assert stroke.points == (pytest.approx((0, 0)), pytest.approx(end))


def test_parts_are_turned_and_moved_within_parts():
    bar = Part(what=shaped("box", (4, 2, 1), density=sp.S.One), at=sp.ImmutableMatrix([5, 0, 0]))
    quarter = sp.ImmutableMatrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    at = sp.ImmutableMatrix([0, 0, 7])
    whole = Composite(parts=(Part(what=Composite(parts=(bar,)), at=at, turned=quarter),))
    points = np.concatenate([face.corners for face in meshed(whole, {})])
    assert points.min(axis=0) == pytest.approx([-1, 3, 6.5])
    assert points.max(axis=0) == pytest.approx([1, 7, 7.5])


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize("name", ["top", "aircraft"])
def test_the_bodies_of_pages_are_closed_and_seen_from_any_side(name):
    shape = body_of_page(name)
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
