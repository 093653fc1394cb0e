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
from rigidsym.notes.figure.body_mesh import HOLE, Shape, lengths_of, meshed, own_shape
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


@pytest.mark.usefixtures("node")
def test_what_is_nearer_is_drawn_later_also_where_parts_pierce_each_other():
    """A long bar goes through a plate, and a half of it is in front."""
    bar = shaped("box", (4, sp.Rational(1, 5), sp.Rational(1, 5)), density=sp.S.One)
    plate = shaped("box", (sp.Rational(1, 5), 2, 2), density=sp.S.One)
    both = meshed(Composite(parts=(Part(what=bar), Part(what=plate))), {})
    straight = colors_from_the_back(both, 0, 0)
    assert len(set(straight)) == 2  # the end of the bar, before the plate
    assert straight[-1] == colors_from_the_back(meshed(bar, {}), 0, 0)[0]
    seen = colors_from_the_back(both, 25, 20)
    alone = set(colors_from_the_back(meshed(bar, {}), 25, 20))
    is_bar = [color in alone for color in seen]
    assert is_bar[-1]
    assert is_bar[0]  # its other half is behind
    assert sum(is_bar) > len(alone)  # the plate has cut the bar


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
