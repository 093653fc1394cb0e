"""Shapes that turn in the live page: closed surfaces that look outward, also of any solid."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections import Counter
from itertools import combinations, pairwise
from math import hypot, pi

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.mechanics.mass.bodies import rigid_body
from rigidsym.models.body import Composite, Part, Particle, Particles
from rigidsym.models.solids import SHAPES as SOLIDS, shaped
from rigidsym.notes.figure.body_mesh import HOLE, Shape, lengths_of, meshed, own_shape
from rigidsym.page.shapes import SHAPES, as_data
from rigidsym.system import resources

LINES = ("rod", "ring")
TURNED = ((1, 0, 0), (0, 0, -1), (0, 1, 0))
CORNERS = (0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)


def volume(shape: Shape) -> float:
    return sum(
        np.linalg.det([face.corners[0], p, q]) / 6
        for face in shape
        for p, q in pairwise(face.corners[1:])
    )


def edges(shape: Shape) -> Counter:
    """How often each edge is passed in each direction."""
    rounded = [[tuple(np.round(p, 6) + 0.0) for p in face.corners] for face in shape]
    return Counter(edge for c in rounded for edge in zip(c, (*c[1:], c[0]), strict=True))


def solid(name: str) -> tuple[Shape, dict]:
    """The mesh of a shipped solid, with the lengths that were chosen for it."""
    kind = SOLIDS[name]
    symbols = sp.symbols(kind.names, positive=True) if not kind.has_corners else CORNERS
    what = shaped(name, symbols, mass=sp.Symbol("M", positive=True))
    values = dict.fromkeys(() if kind.has_corners else symbols)
    numbers = lengths_of(what, values)
    assert numbers is not None
    return meshed(what, numbers), {str(key): float(value) for key, value in numbers.items()}


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_is_closed_and_its_faces_are_flat_and_look_outward(name):
    shape = SHAPES[name]()
    assert volume(shape) > 0.01
    if name != "book":  # the tiles of its cover meet longer edges of its sides
        passed = edges(shape)
        assert all(passed[b, a] == count for (a, b), count in passed.items())
    for corners in (np.array(face.corners) for face in shape):
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        assert np.linalg.norm(normal) > 0
        assert np.abs((corners - corners[0]) @ normal).max() < 2e-3 * len(corners)


def test_every_shape_fits_into_the_axes():
    for shape in SHAPES.values():
        assert all(hypot(*p) <= 1.2 for face in shape() for p in face.corners)


@pytest.mark.parametrize("name", [name for name in SOLIDS if name not in LINES])
def test_any_shipped_solid_has_a_closed_mesh(name):
    shape, _ = solid(name)
    assert len(shape) >= 2
    passed = edges(shape)
    assert all(passed[b, a] == count for (a, b), count in passed.items())


def test_the_meshes_of_solids_have_their_volumes():
    for name, exact in (
        ("box", lambda n: np.prod([*n.values()])),
        ("cylinder", lambda n: pi * n["a"] ** 2 * n["h"]),
        ("cone", lambda n: pi * n["a"] ** 2 * n["h"] / 3),
        ("torus", lambda n: 2 * pi**2 * n["a"] * n["b"] ** 2),
    ):
        shape, lengths = solid(name)
        assert volume(shape) == pytest.approx(exact(lengths), rel=0.05), name


def test_lengths_are_chosen_so_that_a_solid_does_not_turn_inside_out():
    _, lengths = solid("torus")
    assert lengths["b"] < lengths["a"]


def test_the_body_of_a_derivation_is_drawn_about_its_centre_of_mass():
    motion = rs.derive("ZXZ", body=rs.solid("cone"))
    shape = own_shape(motion.body)
    points = np.array([p for face in shape for p in face.corners])
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(0.95)
    heights = points[:, 2]
    assert heights.min() == pytest.approx(-heights.max() / 3) or heights.max() == pytest.approx(
        -heights.min() / 3
    )


def test_particles_and_holes_are_drawn():
    particle = Particle(mass=sp.S.One, position=sp.ImmutableMatrix([1, 0, 0]))
    cloud = Particles(particles=(particle,))
    assert volume(meshed(cloud, {})) > 0
    box = shaped("box", (2, 2, 1), density=sp.S.One)
    hole = shaped("cylinder", (sp.Rational(1, 2), 1), density=sp.S.One)
    pierced = meshed(Composite(parts=(Part(what=box), Part(what=hole, hole=True))), {})
    assert list(HOLE) in [list(color) for color in as_data(pierced)["colors"]]


def test_a_body_of_which_only_the_moments_are_known_has_no_shape():
    assert own_shape(None) == ()


ORDER = """
import { seenFaces } from "%s/body.mjs";
const [body, frame] = JSON.parse(process.argv[2] ?? process.argv[1]);
const camera = { right: [0, 1, 0], up: [0, 0, 1], toward: [1, 0, 0] };
console.log(JSON.stringify(seenFaces(body, frame, camera).map(({ fill }) => fill)));
"""


def colors_from_the_back(shape: Shape, frame: np.ndarray) -> list[str]:
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    script = ORDER % (resources.folder("templates") / "page").as_uri()
    given = json.dumps([as_data(shape), frame.tolist()])
    done = subprocess.run(
        [node, "--input-type=module", "-e", script, given],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def test_what_is_nearer_is_drawn_later_also_where_parts_pierce_each_other():
    """Seen along x; a long bar goes through a plate, and a half of it is in front."""
    bar = shaped("box", (4, sp.Rational(1, 5), sp.Rational(1, 5)), density=sp.S.One)
    plate = shaped("box", (sp.Rational(1, 5), 2, 2), density=sp.S.One)
    both = meshed(Composite(parts=(Part(what=bar), Part(what=plate))), {})
    straight = colors_from_the_back(both, np.eye(3))
    assert len(set(straight)) == 2  # the end of the bar, before the plate
    assert straight[-1] == colors_from_the_back(meshed(bar, {}), np.eye(3))[0]
    turned = Rotation.from_euler("ZX", [25, 20], degrees=True).as_matrix().T
    seen = colors_from_the_back(both, turned)
    alone = set(colors_from_the_back(meshed(bar, {}), turned))
    is_bar = [color in alone for color in seen]
    assert is_bar[-1]
    assert is_bar[0]  # its other half is behind
    assert sum(is_bar) > len(alone)  # the plate has cut the bar


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_can_be_drawn_from_any_side(name):
    """Also where rounding has bent the faces a little."""
    shape = SHAPES[name]()
    for angles in ([0, 0], [90, 0], [37, 58]):
        frame = Rotation.from_euler("ZX", angles, degrees=True).as_matrix().T
        assert colors_from_the_back(shape, frame)


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


def test_the_cuboid_of_a_motion_has_the_moments_of_the_body():
    """I₁ = m (b² + c²)/12 and so on, up to the size"""
    moments = [1.0, 1.4, 2.0]
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    module = (resources.folder("templates") / "page" / "body.mjs").as_uri()
    script = (
        f'import {{ cuboidOf }} from "{module}"; console.log(JSON.stringify(cuboidOf({moments})))'
    )
    done = subprocess.run(
        [node, "--input-type=module", "-e", script], capture_output=True, text=True, check=True
    )
    body = json.loads(done.stdout)
    x, y, z = np.ptp(body["points"], axis=0)
    found = np.array([y * y + z * z, z * z + x * x, x * x + y * y])
    np.testing.assert_allclose(found / found[0], np.array(moments) / moments[0], rtol=1e-12)
    faces = [[body["points"][corner] for corner in face[1:]] for face in body["faces"]]
    for corners in map(np.array, faces):
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        assert normal @ corners.mean(axis=0) > 0  # it looks outward
