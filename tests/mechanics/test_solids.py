"""Solids, integrated: against clouds of particles, trimesh and SymPy; laws of every shape."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
import trimesh
from sympy.physics.mechanics import Point, ReferenceFrame, inertia_of_point_mass

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.integrate import Integrator, integration_codec
from rigidsym.errors import AlgebraError, BodyError
from rigidsym.mechanics.mass.bodies import body_of, solid
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.models.body import Composite, Part, Particle, Particles, RigidBody, Solid
from rigidsym.models.solids import SHAPES, shaped

M, a, b, c, h, rho = sp.symbols("M a b c h rho")
NUMBERS = dict(zip(sp.symbols("a b c h l M"), (1.0, 1.5, 2.0, 2.5, 3.0, 4.0), strict=True))
CORNERS = [0, 0, 0, 2, 0, 0, 1, 3, 0, 0, 1, 2]
Inside = Callable[..., np.ndarray]


def column(*entries: object) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([sp.sympify(entry) for entry in entries])


@cache
def body(shape: str) -> RigidBody:
    return solid(shape, **({"corners": CORNERS} if shape == "tetrahedron" else {}))


def numbers(matrix: sp.MatrixBase, values: dict[sp.Symbol, float] = NUMBERS) -> np.ndarray:
    return np.array(matrix.subs(values).evalf().tolist(), dtype=float)


# integrals


@pytest.mark.parametrize(
    "integrand",
    [
        "u**3",
        "u**2*cos(u)**3",
        "u*sin(u)*cos(u)**2",
        "sin(2*u)*cos(u)",
        "u**2*cos(u/2)**4",
        "a*u*h",
    ],
)
def test_an_antiderivative_is_one_and_agrees_with_numerical_quadrature(integrand):
    mpmath = pytest.importorskip("mpmath")
    u = sp.Symbol("u")
    function = sp.sympify(integrand)
    codec = integration_codec([function], (u,), ((sp.S.Zero, sp.pi / 2),))
    work = Integrator(codec, u)
    element = codec.encode(function)
    found = work.antiderivative(element)
    assert codec.ring.reduce(work.derivative(found) - element) == 0
    exact = codec.decode(work.between(found, (sp.S.Zero, sp.pi / 2))).subs({a: 2, h: 3})
    plain = sp.lambdify(u, function.subs({a: 2, h: 3}), "mpmath")
    with mpmath.workdps(30):
        assert abs(mpmath.quad(plain, [0, mpmath.pi / 2]) - mpmath.mpf(exact.evalf(30))) < 1e-25


def test_what_is_no_polynomial_is_refused():
    u = sp.Symbol("u")
    codec = codec_for([1 / u, u])
    with pytest.raises(AlgebraError, match="is not integrated over u"):
        Integrator(codec, u).antiderivative(codec.encode(1 / u))


# every shape


def test_textbook_moments():
    """As printed in C. M. Close and D. K. Frederick's tables and in every formulary."""
    found = {
        name: body(name).inertia.diagonal()[::-1][0] for name in SHAPES if name != "tetrahedron"
    }
    assert found["cylinder"] == M * a**2 / 2
    assert found["cone"] == 3 * M * a**2 / 10
    assert found["sphere"] == 2 * M * a**2 / 5
    assert found["shell"] == 2 * M * a**2 / 3
    assert found["torus"] == M * (4 * a**2 + 3 * b**2) / 4
    assert body("rod").inertia == sp.diag(
        M * sp.Symbol("l") ** 2 / 12, M * sp.Symbol("l") ** 2 / 12, 0
    )
    assert body("cone").centre == column(0, 0, h / 4)
    assert body("hemisphere").inertia[0, 0] == 83 * M * a**2 / 320


INSIDE: dict[str, tuple[Inside, tuple[float, float, float], tuple[float, float, float]]] = {
    "box": (
        lambda x, y, z: (abs(x) < 0.5) & (abs(y) < 0.75) & (abs(z) < 1),
        (-1, -1, -1),
        (1, 1, 1),
    ),
    "cylinder": (
        lambda x, y, z: (x * x + y * y < 1) & (abs(z) < 1.25),
        (-1, -1, -1.3),
        (1, 1, 1.3),
    ),
    "hollow_cylinder": (
        lambda x, y, z: (x * x + y * y < 2.25) & (x * x + y * y > 1) & (abs(z) < 1.25),
        (-1.5, -1.5, -1.3),
        (1.5, 1.5, 1.3),
    ),
    "cone": (
        lambda x, y, z: (np.hypot(x, y) < 1 - z / 2.5) & (z > 0) & (z < 2.5),
        (-1, -1, 0),
        (1, 1, 2.5),
    ),
    "frustum": (
        lambda x, y, z: (np.hypot(x, y) < 1 + 0.5 * z / 2.5) & (z > 0) & (z < 2.5),
        (-1.5, -1.5, 0),
        (1.5, 1.5, 2.5),
    ),
    "sphere": (lambda x, y, z: x * x + y * y + z * z < 1, (-1, -1, -1), (1, 1, 1)),
    "hollow_sphere": (
        lambda x, y, z: (x * x + y * y + z * z < 2.25) & (x * x + y * y + z * z > 1),
        (-1.5,) * 3,
        (1.5,) * 3,
    ),
    "hemisphere": (lambda x, y, z: (x * x + y * y + z * z < 1) & (z > 0), (-1, -1, 0), (1, 1, 1)),
    "ellipsoid": (
        lambda x, y, z: x * x + y * y / 2.25 + z * z / 4 < 1,
        (-1, -1.5, -2),
        (1, 1.5, 2),
    ),
    "tetrahedron": (
        lambda x, y, z: _in_tetrahedron(np.array([x, y, z])),
        (0, 0, 0),
        (2, 3, 2),
    ),
}


def _in_tetrahedron(points: np.ndarray) -> np.ndarray:
    first, *others = np.array(CORNERS, dtype=float).reshape(4, 3)
    weights = np.linalg.solve((np.array(others) - first).T, points - first[:, None])
    return (weights > 0).all(axis=0) & (weights.sum(axis=0) < 1)


def cloud(shape: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Centre and inertia tensor of equal particles on a grid, those inside; 4 kg in all."""
    inside, low, high = INSIDE[shape]
    sides = [np.linspace(x, y, 2 * count + 1)[1::2] for x, y in zip(low, high, strict=True)]
    points = np.array([axis.ravel() for axis in np.meshgrid(*sides, indexing="ij")])
    points = points[:, inside(*points)]
    centre = points.mean(axis=1)
    apart = points - centre[:, None]
    second = 4.0 / points.shape[1] * apart @ apart.T
    return centre, np.trace(second) * np.eye(3) - second


@pytest.mark.parametrize("shape", INSIDE)
def test_a_cloud_of_particles_converges_to_the_solid(shape):
    exact = numbers(body(shape).inertia)
    errors = []
    for count in (10, 40):
        centre, inertia = cloud(shape, count)
        errors.append(abs(inertia - exact).max() / exact.max())
        assert np.allclose(centre, numbers(body(shape).centre).ravel(), atol=0.6 / count)
    assert errors[1] < max(0.4 * errors[0], 1e-3)
    assert errors[1] < 0.02


LINES_AND_SURFACES: dict[str, Callable[[np.ndarray, np.ndarray], tuple[object, ...]]] = {
    "rod": lambda s, _: (0 * s, 0 * s, 3 * (s - 0.5)),
    "plate": lambda s, t: (s - 0.5, 1.5 * (t - 0.5), 0 * s),
    "ring": lambda s, _: (np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), 0 * s),
    "disc": lambda s, t: (
        np.sqrt(t) * np.cos(2 * np.pi * s),
        np.sqrt(t) * np.sin(2 * np.pi * s),
        0 * s,
    ),
    "tube": lambda s, t: (np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), 2.5 * (t - 0.5)),
    "shell": lambda s, t: (  # heights on a sphere are uniform (Archimedes)
        np.sqrt(1 - (2 * t - 1) ** 2) * np.cos(2 * np.pi * s),
        np.sqrt(1 - (2 * t - 1) ** 2) * np.sin(2 * np.pi * s),
        2 * t - 1,
    ),
}


@pytest.mark.parametrize("shape", LINES_AND_SURFACES)
def test_points_spread_evenly_converge_to_lines_and_surfaces(shape):
    steps = (np.arange(200) + 0.5) / 200
    s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
    points = np.array(LINES_AND_SURFACES[shape](s, t), dtype=float)
    second = 4.0 / points.shape[1] * points @ points.T
    inertia = np.trace(second) * np.eye(3) - second
    assert np.allclose(inertia, numbers(body(shape).inertia), atol=1e-3)


def test_the_torus_and_its_mesh():
    mesh = trimesh.creation.torus(2.0, 0.5, major_sections=256, minor_sections=128)
    mesh.density = 4.0 / mesh.volume
    values = {a: 2.0, b: 0.5, M: 4.0}
    assert np.allclose(
        mesh.moment_inertia, numbers(body("torus").inertia, values), rtol=2e-3, atol=1e-9
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_laws_of_every_shape(shape):
    inertia = numbers(body(shape).inertia)
    moments = np.linalg.eigvalsh(inertia)
    assert body(shape).inertia == body(shape).inertia.T
    assert moments[0] >= -1e-12
    assert moments[0] + moments[1] >= moments[2] - 1e-12
    assert body(shape).mass == M


@pytest.mark.parametrize("shape", SHAPES)
def test_density_and_mass_say_the_same(shape):
    """With ρ = M/V in place of ρ, the inertia tensor is that of the mass M."""
    given = {"corners": CORNERS} if shape == "tetrahedron" else {}
    dense, massive = solid(shape, density=rho, **given), body(shape)
    volume = sp.cancel(dense.mass / rho)
    difference = dense.inertia.subs(rho, M / volume) - massive.inertia
    assert difference.applyfunc(sp.cancel) == sp.zeros(3)


# what is put together


def _particles() -> Particles:
    places = [(a, 0, 0), (0, b, h), (a, b, -h), (-a, 1, 2)]
    return Particles(
        particles=tuple(
            Particle(mass=mass, position=column(*place))
            for mass, place in zip((M, rho, sp.Integer(2), M), places, strict=True)
        )
    )


def test_particles_agree_with_sympy():
    frame, origin = ReferenceFrame("N"), Point("O")
    total = sp.zeros(3)
    given, found = _particles(), body_of(_particles())
    for particle in given.particles:
        x, y, z = particle.position - found.centre
        place = x * frame.x + y * frame.y + z * frame.z
        total += inertia_of_point_mass(particle.mass, place, frame).to_matrix(frame)
    assert origin is not None
    assert (total - found.inertia).applyfunc(sp.cancel) == sp.zeros(3)


def test_parallel_axes_agree_with_sympy():
    moved = body_of(
        Composite(parts=(Part(what=shaped("box", [a, b, c], mass=M), at=column(1, h, 0)),))
    )
    assert moved.inertia == body("box").inertia
    assert moved.centre == column(1, h, 0)
    frame = ReferenceFrame("N")
    centre, corner = Point("C"), Point("P")
    centre.set_pos(corner, frame.x + h * frame.y)
    brick = sp.physics.mechanics.RigidBody(
        "B",
        centre,
        frame,
        M,
        (sp.physics.mechanics.inertia(frame, *body("box").inertia.diagonal()), centre),
    )
    about_corner = brick.parallel_axis(corner).to_matrix(frame)
    moments = moments_of(moved.distribution)
    here = moments.second.trace() * sp.eye(3) - moments.second
    assert (about_corner - here).applyfunc(sp.expand) == sp.zeros(3)


def test_parts_add_up_and_a_hole_takes_away():
    outer = Part(what=shaped("cylinder", [b, h], density=rho))
    hole = Part(what=shaped("cylinder", [a, h], density=rho), hole=True)
    ring = body_of(Composite(parts=(outer, hole)))
    hollow = solid("hollow_cylinder", density=rho)
    assert (ring.inertia - hollow.inertia).applyfunc(sp.cancel) == sp.zeros(3)
    whole = body_of(Composite(parts=(outer, hole, Part(what=hole.what))))
    assert (whole.inertia - body_of(outer.what).inertia).applyfunc(sp.cancel) == sp.zeros(3)


def test_a_part_moves_as_it_is():
    """A cone, whose centre is not its origin: its tensor stays, and its centre goes along."""
    at = column(1, h, -2)
    moved = body_of(Composite(parts=(Part(what=shaped("cone", [a, h], mass=M), at=at),)))
    assert moved.inertia == body("cone").inertia
    assert (moved.centre - body("cone").centre - at).applyfunc(sp.expand) == sp.zeros(3, 1)


def test_a_turn_keeps_the_principal_moments():
    turn = sp.ImmutableMatrix(sp.Matrix([[3, -4, 0], [4, 3, 0], [0, 0, 5]]) / 5)
    box = shaped("box", [sp.Integer(1), sp.Integer(2), sp.Integer(3)], mass=sp.Integer(6))
    turned = body_of(Composite(parts=(Part(what=box, turned=turn),)))
    assert turned.inertia == turn * body_of(box).inertia * turn.T
    assert np.allclose(
        np.linalg.eigvalsh(numbers(turned.inertia)),
        np.linalg.eigvalsh(numbers(body_of(box).inertia)),
    )


def test_a_solid_of_any_density_by_its_bounds():
    x, y, z = sp.symbols("x y z")
    wedge = Solid(
        title="Wedge",
        coordinates=(x, y, z),
        place=column(x, y, z),
        bounds=((sp.S.Zero, a), (sp.S.Zero, a - x), (sp.S.Zero, h)),
        density=rho * (1 + z / h),
    )
    found = body_of(wedge)
    density = rho * (1 + z / h)
    limits = ((z, 0, h), (y, 0, a - x), (x, 0, a))
    mass = sp.integrate(density, *limits)
    height = sp.integrate(density * z, *limits) / mass
    square = sp.integrate(density * (x**2 + y**2), *limits)
    away = sum(sp.integrate(density * s, *limits) ** 2 / mass for s in (x, y))
    assert sp.expand(found.mass - mass) == 0
    assert sp.cancel(found.centre[2] - height) == 0
    assert sp.cancel(found.inertia[2, 2] - square + away) == 0


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"bounds": ((0, a), (0, 1))}, "expected one to three coordinates, bounds for each"),
        ({"element": sp.S.One}, "lines and surfaces have an element"),
        ({"mass": M}, "expected either the mass or the density"),
        ({"bounds": ((0, sp.Symbol("y")), (0, 1), (0, 1))}, "the bounds of x contain y"),
    ],
)
def test_a_solid_that_is_none_is_refused(change, fault):
    x, y, z = sp.symbols("x y z")
    plain = {
        "title": "T",
        "coordinates": (x, y, z),
        "place": column(x, y, z),
        "bounds": ((0, 1), (0, 1), (0, 1)),
        "density": rho,
    } | change
    plain["bounds"] = tuple((sp.sympify(low), sp.sympify(high)) for low, high in plain["bounds"])
    with pytest.raises(BodyError, match=fault):
        Solid(**plain)


def test_a_wrong_element_is_refused_with_what_is_left():
    u = sp.Symbol("u")
    arc = Solid(
        title="Arc",
        coordinates=(u,),
        place=column(a * sp.cos(u), a * sp.sin(u), 0),
        bounds=((sp.S.Zero, sp.pi),),
        element=2 * a,
        mass=M,
    )
    with pytest.raises(
        BodyError, match=r"does not belong to the map; its square differs by 3\*a\*\*2"
    ):
        moments_of(arc)


def test_shapes_and_lengths_that_there_are_not():
    with pytest.raises(BodyError, match="no shape 'spere'; did you mean sphere"):
        solid("spere")
    with pytest.raises(BodyError, match="cylinder has no side; it has radius, height"):
        solid("cylinder", side=a)
