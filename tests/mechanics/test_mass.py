"""Mass and inertia: against particles, trimesh and SymPy; tensors, principal axes, refusals."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
import trimesh
from sympy.physics.mechanics import Point, ReferenceFrame

import rigidsym as rs
from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.integrate import Integrator, integration_codec
from rigidsym.errors import AlgebraError, BodyError, QuantityError
from rigidsym.mechanics import particles as particle_sums
from rigidsym.mechanics.mass.bodies import body_of, solid
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.mechanics.mass.principal import principal_of
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.body import (
    BodyDescription,
    Composite,
    Part,
    Particle,
    Particles,
    Solid,
    given_inertia,
)
from rigidsym.models.rotation import elementary
from rigidsym.models.solids import SHAPES, shaped

A, C, M, a, b, c, d, h, m, rho = sp.symbols("A C M a b c d h m rho")
NUMBERS = dict(zip(sp.symbols("a b c h l M"), (1.0, 1.5, 2.0, 2.5, 3.0, 4.0), strict=True))
CORNERS = [0, 0, 0, 2, 0, 0, 1, 3, 0, 0, 1, 2]
UNIT = (sp.S.Zero, sp.S.One)
U, V, W = sp.symbols("u v w")


def column(*entries: object) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([sp.sympify(entry) for entry in entries])


def particles(*rows: tuple[object, ...]) -> Particles:
    found = [Particle(mass=sp.sympify(mass), position=column(*at)) for mass, *at in rows]
    return Particles(particles=tuple(found))


def made(shape: str, **given: object) -> rs.RigidBody:
    return solid(shape, **({"corners": CORNERS} if shape == "tetrahedron" else {}), **given)


body = cache(made)


def numbers(matrix: sp.MatrixBase, values: dict[sp.Symbol, float] = NUMBERS) -> np.ndarray:
    return np.array(matrix.subs(values).evalf().tolist(), dtype=float)


# Integrals


@pytest.mark.parametrize(
    "integrand", ["u**2*cos(u)**3", "u*sin(u)*cos(u)**2", "sin(2*u)*cos(u)", "a*u*h*cos(u/2)**4"]
)
def test_an_antiderivative_is_one_and_agrees_with_numerical_quadrature(integrand):
    mpmath = pytest.importorskip("mpmath")
    function = sp.sympify(integrand)
    codec = integration_codec([function], (U,), ((sp.S.Zero, sp.pi / 2),))
    work = Integrator(codec, U)
    element = codec.encode(function)
    found = work.antiderivative(element)
    assert codec.ring.reduce(work.derivative(found) - element) == 0
    exact = codec.decode(work.between(found, (sp.S.Zero, sp.pi / 2))).subs({a: 2, h: 3})
    plain = sp.lambdify(U, function.subs({a: 2, h: 3}), "mpmath")
    with mpmath.workdps(30):
        assert abs(mpmath.quad(plain, [0, mpmath.pi / 2]) - mpmath.mpf(exact.evalf(30))) < 1e-25


def test_what_is_no_polynomial_is_refused():
    codec = codec_for([1 / U, U])
    with pytest.raises(AlgebraError, match="is not integrated over u"):
        Integrator(codec, U).antiderivative(codec.encode(1 / U))


# Every shape


def test_textbook_moments():
    """As printed in C. M. Close and D. K. Frederick's tables and in every formulary."""
    about_z = {
        **{"cylinder": M * a**2 / 2, "cone": 3 * M * a**2 / 10, "sphere": 2 * M * a**2 / 5},
        **{"shell": 2 * M * a**2 / 3, "torus": M * (4 * a**2 + 3 * b**2) / 4, "rod": 0},
    }
    for shape, moment in about_z.items():
        assert body(shape).inertia[2, 2] == moment
    assert body("rod").inertia[0, 0] == M * sp.Symbol("l") ** 2 / 12
    assert body("cone").centre == column(0, 0, h / 4)
    assert body("hemisphere").inertia[0, 0] == 83 * M * a**2 / 320


def _in_tetrahedron(*points: np.ndarray) -> np.ndarray:
    first, *others = np.array(CORNERS, dtype=float).reshape(4, 3)
    weights = np.linalg.solve((np.array(others) - first).T, np.array(points) - first[:, None])
    return (weights > 0).all(axis=0) & (weights.sum(axis=0) < 1)


Inside = Callable[..., np.ndarray]
INSIDE: dict[str, tuple[Inside, tuple[float, ...], tuple[float, ...]]] = {  # within a box
    "box": (
        lambda x, y, z: (abs(x) < 0.5) & (abs(y) < 0.75) & (abs(z) < 1),
        *((-1, -1, -1), (1, 1, 1)),
    ),
    "cylinder": (
        lambda x, y, z: (x * x + y * y < 1) & (abs(z) < 1.25),
        *((-1, -1, -1.3), (1, 1, 1.3)),
    ),
    "hollow_cylinder": (
        lambda x, y, z: (x * x + y * y < 2.25) & (x * x + y * y > 1) & (abs(z) < 1.25),
        *((-1.5, -1.5, -1.3), (1.5, 1.5, 1.3)),
    ),
    "cone": (lambda x, y, z: np.hypot(x, y) < 1 - z / 2.5, (-1, -1, 0), (1, 1, 2.5)),
    "frustum": (
        lambda x, y, z: np.hypot(x, y) < 1 + 0.5 * z / 2.5,
        *((-1.5, -1.5, 0), (1.5, 1.5, 2.5)),
    ),
    "sphere": (lambda x, y, z: x * x + y * y + z * z < 1, (-1, -1, -1), (1, 1, 1)),
    "hollow_sphere": (
        lambda x, y, z: abs(x * x + y * y + z * z - 1.625) < 0.625,
        *((-1.5,) * 3, (1.5,) * 3),
    ),
    "hemisphere": (lambda x, y, z: x * x + y * y + z * z < 1, (-1, -1, 0), (1, 1, 1)),
    "ellipsoid": (
        lambda x, y, z: x * x + y * y / 2.25 + z * z / 4 < 1,
        *((-1, -1.5, -2), (1, 1.5, 2)),
    ),
    "tetrahedron": (_in_tetrahedron, (0, 0, 0), (2, 3, 2)),
}


def cloud(shape: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Centre and inertia tensor of equal particles on a grid, those inside; 4 kg in all."""
    inside, low, high = INSIDE[shape]
    sides = [np.linspace(x, y, 2 * count + 1)[1::2] for x, y in zip(low, high, strict=True)]
    points = np.array([axis.ravel() for axis in np.meshgrid(*sides, indexing="ij")])
    points = points[:, inside(*points)]
    return points.mean(axis=1), tensor_of(points - points.mean(axis=1)[:, None])


def tensor_of(points: np.ndarray) -> np.ndarray:
    second = 4.0 / points.shape[1] * points @ points.T
    return np.trace(second) * np.eye(3) - second


@pytest.mark.parametrize("shape", INSIDE)
def test_a_cloud_of_particles_converges_to_the_solid(shape):
    exact, errors = numbers(body(shape).inertia), []
    for count in (10, 40):
        centre, inertia = cloud(shape, count)
        errors.append(abs(inertia - exact).max() / exact.max())
        assert np.allclose(centre, numbers(body(shape).centre).ravel(), atol=0.6 / count)
    assert errors[1] < min(max(0.4 * errors[0], 1e-3), 0.02)


LINES_AND_SURFACES: dict[str, Callable[[np.ndarray, np.ndarray], tuple[object, ...]]] = {
    "rod": lambda s, _: (0 * s, 0 * s, 3 * (s - 0.5)),
    "plate": lambda s, t: (s - 0.5, 1.5 * (t - 0.5), 0 * s),
    "ring": lambda s, _: (np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), 0 * s),
    "disc": lambda s, t: (*np.sqrt(t) * [np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)], 0 * s),
    "tube": lambda s, t: (np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), 2.5 * (t - 0.5)),
    "shell": lambda s, t: (  # heights on a sphere are uniform (Archimedes)
        *np.sqrt(1 - (2 * t - 1) ** 2) * [np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)],
        2 * t - 1,
    ),
}


@pytest.mark.parametrize("shape", LINES_AND_SURFACES)
def test_points_spread_evenly_converge_to_lines_and_surfaces(shape):
    steps = (np.arange(200) + 0.5) / 200
    s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
    points = np.array(LINES_AND_SURFACES[shape](s, t), dtype=float)
    assert np.allclose(tensor_of(points), numbers(body(shape).inertia), atol=1e-3)


def test_the_torus_and_its_mesh():
    mesh = trimesh.creation.torus(2.0, 0.5, major_sections=256, minor_sections=128)
    mesh.density = 4.0 / mesh.volume
    exact = numbers(body("torus").inertia, {a: 2.0, b: 0.5, M: 4.0})
    assert np.allclose(mesh.moment_inertia, exact, rtol=2e-3, atol=1e-9)


@pytest.mark.parametrize("shape", SHAPES)
def test_laws_of_every_shape(shape):
    """Proved, symmetric, physical; with ρ = M/V in place of ρ, the tensor is that of the mass M."""
    whole = body(shape)
    assert rs.derive("ZXZ", ("centre_of_mass", "inertia_tensor"), body=whole).is_proved
    moments = np.linalg.eigvalsh(numbers(whole.inertia))
    assert moments[0] >= -1e-12
    assert moments[0] + moments[1] >= moments[2] - 1e-12
    dense = made(shape, density=rho)
    assert whole.mass == M
    difference = dense.inertia.subs(rho, M / sp.cancel(dense.mass / rho)) - whole.inertia
    assert difference.applyfunc(sp.cancel) == sp.zeros(3)


def test_a_solid_of_any_density_by_its_bounds():
    x, y, z = sp.symbols("x y z")
    density = rho * (1 + z / h)
    bounds = ((sp.S.Zero, a), (sp.S.Zero, a - x), (sp.S.Zero, h))
    found = body_of(
        Solid(
            title="Wedge",
            coordinates=(x, y, z),
            place=column(x, y, z),
            bounds=bounds,
            density=density,
        )
    )

    def whole(integrand: sp.Expr) -> sp.Expr:
        return sp.integrate(density * integrand, (z, 0, h), (y, 0, a - x), (x, 0, a))

    mass = whole(sp.S.One)
    away = sum(whole(s) ** 2 / mass for s in (x, y))
    assert sp.expand(found.mass - mass) == 0
    assert sp.cancel(found.centre[2] - whole(z) / mass) == 0
    assert sp.cancel(found.inertia[2, 2] - whole(x**2 + y**2) + away) == 0


# What is put together


def test_parallel_axes_agree_with_sympy():
    part = Part(what=shaped("box", [a, b, c], mass=M), at=column(1, h, 0))
    moved = body_of(Composite(parts=(part,)))
    assert moved.inertia == body("box").inertia
    assert moved.centre == column(1, h, 0)
    frame, centre, corner = ReferenceFrame("N"), Point("C"), Point("P")
    centre.set_pos(corner, frame.x + h * frame.y)
    about_centre = sp.physics.mechanics.inertia(frame, *body("box").inertia.diagonal())
    brick = sp.physics.mechanics.RigidBody("B", centre, frame, M, (about_centre, centre))
    moments = moments_of(moved.distribution)
    here = moments.second.trace() * sp.eye(3) - moments.second
    difference = brick.parallel_axis(corner).to_matrix(frame) - here
    assert difference.applyfunc(sp.expand) == sp.zeros(3)


def test_parts_move_turn_and_add_up_and_a_hole_takes_away():
    outer = Part(what=shaped("cylinder", [b, h], density=rho))
    hole = Part(what=shaped("cylinder", [a, h], density=rho), hole=True)
    ring = body_of(Composite(parts=(outer, hole)))
    hollow = solid("hollow_cylinder", density=rho)
    assert (ring.inertia - hollow.inertia).applyfunc(sp.cancel) == sp.zeros(3)
    turn = sp.ImmutableMatrix(sp.Matrix([[3, -4, 0], [0, 0, 5], [-4, -3, 0]]) / 5)
    at, cone = column(1, h, -2), body("cone")  # whose centre is not its origin
    part = Part(what=shaped("cone", [a, h], mass=M), at=at, turned=turn)
    moved = body_of(Composite(parts=(part,)))
    assert (moved.inertia - turn * cone.inertia * turn.T).applyfunc(sp.expand) == sp.zeros(3)
    assert (moved.centre - turn * cone.centre - at).applyfunc(sp.expand) == sp.zeros(3, 1)


@pytest.mark.parametrize("shape", ["sphere", "cylinder", "tetrahedron"])
def test_lengths_mass_and_density_are_positive_and_coordinates_have_any_sign(shape):
    parameters = rs.solid(shape, density=rho).parameters
    signs = {p.symbol.name: p.positive for p in parameters}
    assert signs == {name: "_" not in name for name in signs}
    assert {"rho"} < set(signs)


def test_a_description_in_numbers_keeps_them_as_parameters_with_a_value():
    rows = (
        ("5/4", "1/2", 0, "1/3"),
        ("2.123456789", "-1/4", "1/99999", "-1/5"),
        (1, "1/3", 0, "0.123"),
    )
    cluster = particles(*([sp.Rational(e) for e in row] for row in rows))
    only, exact = ("rotational_energy",), rs.body_of(cluster)
    found = rs.derive("ZXZ", only, body=BodyDescription(distribution=cluster)).body
    assert {p.symbol.name for p in found.parameters} >= {"M", "I_11", "I_12", "I_13", "x_C"}
    for entry, value in zip(found.in_numbers(found.inertia), exact.inertia, strict=True):
        assert abs(float(entry - value)) <= 1e-14 * float(exact.inertia.norm())
    kept = BodyDescription(distribution=cluster, keeps_numbers=True)
    assert rs.derive("ZXZ", only, body=kept).body.inertia == exact.inertia


# The body by itself

BODIES = {
    "general": rs.general_inertia(),
    "symmetric": rs.principal_moments(A, A, C),
    "cylinder": rs.solid("cylinder"),
    "particles": rs.body_of(particles((m, a, b, 0), (m, -a, -b, 0), (2 * m, 0, 0, h))),
    "composite": rs.body_of(
        Composite(
            parts=(
                Part(what=shaped("box", [a, b, c], mass=M)),
                Part(what=shaped("sphere", [d], mass=m), at=column(0, 0, h), hole=True),
            )
        )
    ),
}
WITHOUT = {
    "mass": "it is given, not added up",
    "centre_of_mass": "how its mass is distributed is not given",
    "principal_moments": "no closed form was found, which a general tensor has not",
    "principal_axes": "no closed form was found, or none that is short enough",
    "inertia_ellipsoid": "no principal moments were found, or one of them is 0",
}


@cache
def motion(name: str) -> rs.Motion:
    return rs.derive("ZXZ", [*INERTIA_QUANTITIES, "body"], body=BODIES[name])


@pytest.mark.parametrize("name", ["composite", "particles"])
def test_every_quantity_of_a_distribution_is_proved(name):
    assert {step.quantity.name for step in motion(name).steps} == set(INERTIA_QUANTITIES)
    assert motion(name).is_proved


@pytest.mark.parametrize("name", WITHOUT)
def test_what_a_body_has_not_is_said_where_it_is_asked_for(name):
    with pytest.raises(QuantityError, match=f"has no quantity {name}: {WITHOUT[name]}"):
        rs.derive("ZXZ", ["inertia_tensor", name], body=BODIES["general"])
    names = [step.quantity.name for step in rs.derive("ZXZ", body=BODIES["general"]).steps]
    assert name not in names
    assert "inertia_tensor_space" in names


def test_the_tensor_of_a_point_and_a_line_are_those_of_the_particles():
    """Against the sums of the lecture, section 2.2, over the particles themselves."""
    found = motion("particles")
    p, n = (column(*found.argument(name).symbols) for name in ("point", "direction"))
    total, moment = sp.zeros(3), sp.S.Zero
    for particle in BODIES["particles"].distribution.particles:
        x = particle.position - p
        total += particle.mass * (x.dot(x) * sp.eye(3) - x * x.T)
        moment += particle.mass * n.cross(x).dot(n.cross(x))
    assert (total - found.inertia_tensor_point).applyfunc(sp.cancel) == sp.zeros(3)
    assert sp.cancel(moment - found.moment_of_inertia) == 0


def test_kernels_evaluate_the_body():
    found = rs.derive("ZXZ", body=BODIES["cylinder"])
    module, values = found.kernels().load(), {"M": 2.0, "a": 3.0, "h": 5.0}
    parameters = [values[s.name] for s in found.argument("parameters").symbols]
    tensor = module.inertia_tensor(parameters)
    assert np.allclose(tensor, np.diag([2 * (27 + 25) / 12] * 2 + [9]))
    assert np.isclose(module.moment_of_inertia([3, 0, 0], [0, 0, 1], parameters), 27)
    assert np.allclose(module.radii_of_gyration(parameters)[2], 3 / np.sqrt(2))
    assert np.allclose(module.inertia_ellipsoid(parameters) ** 2 * np.diag(tensor), 1)
    space = module.inertia_tensor_space([0.3, 1.3, 2.3], parameters)
    assert np.allclose(np.linalg.eigvalsh(space), np.linalg.eigvalsh(tensor))


TENSORS = {  # with words of the sentence
    "diagonal": (sp.diag(a, b, c), "body axes are principal axes."),
    "sphere": (sp.diag(a, a, a), "every axis through the centre"),
    "two equal": (sp.diag(a, c, a), "every axis perpendicular to y"),
    "one axis apart": (sp.Matrix([[a, d, 0], [d, b, 0], [0, 0, c]]), "The z-axis is principal"),
    "another axis apart": (sp.Matrix([[a, 0, d], [0, b, 0], [d, 0, c]]), "The y-axis"),
    "corner of a cube": (sp.Matrix([[a, -d, -d], [-d, a, -d], [-d, -d, a]]), "moments are equal"),
    "numbers": (sp.Matrix([[3, 1, 0], [1, 3, 0], [0, 0, 5]]), "polynomial factors"),
    "one rational root": (sp.Matrix([[6, -2, 0], [-2, 6, -2], [0, -2, 6]]), "linear factor"),
    "an oblique axis apart": (sp.Matrix([[6, 1, 1], [1, 6, 1], [1, 1, 7]]), "linear factor"),
    "in symbols": (sp.Matrix([[a, d, d], [d, a, d], [d, d, b]]), "linear factor"),
}


@pytest.mark.parametrize("name", TENSORS)
def test_principal_axes_in_symbols_agree_with_numbers(name):
    tensor, words = TENSORS[name]
    found, values = principal_of(sp.ImmutableMatrix(tensor)), {a: 7.0, b: 6.0, c: 5.0, d: 1.5}
    assert words in found.because
    plain, axes = numbers(tensor, values), numbers(found.axes, values)
    moments = numbers(found.moments, values).ravel()
    assert np.allclose(sorted(moments), np.linalg.eigvalsh(plain))
    assert np.linalg.det(axes) == pytest.approx(1)
    assert np.allclose(plain @ axes, axes * moments)
    whole = given_inertia(sp.ImmutableMatrix(tensor), mass=M)
    assert rs.derive("ZXZ", ("principal_moments", "principal_axes"), body=whole).is_proved


def test_a_polynomial_that_has_no_factors_is_not_factored(monkeypatch):
    monkeypatch.setattr(sp, "factor_list", None)
    assert principal_of(BODIES["general"].inertia) is None


def test_axes_too_long_for_use_are_left_out_and_the_moments_proved():
    ring = Part(what=shaped("torus", [b, b / 5], mass=M), at=column(-b / 2, -b / 2, a))
    cone = Part(
        what=shaped("cone", [2 * b, 2 * b], mass=m),
        turned=elementary("y", sp.pi / 2),
        at=column(2 * c, -b / 2, 2 * c),
    )
    whole = rs.body_of(Composite(parts=(ring, cone)))
    found, values = principal_of(whole.inertia), {a: 0.7, b: 0.45, c: 0.9, M: 2.3, m: 0.8}
    assert found.axes is None
    assert "too long" in found.because
    assert rs.derive("ZXZ", ["principal_moments"], body=whole).is_proved
    expected = np.linalg.eigvalsh(numbers(whole.inertia, values))
    assert np.allclose(sorted(numbers(found.moments, values).ravel()), expected)


def test_a_summand_without_the_mass_of_the_particle_has_no_sum():
    codec = codec_for([*particle_sums.SYMBOLS, M, A, C, sp.Rational(1, 2)])
    sums = particle_sums.sums_of_body(codec, M, sp.ImmutableMatrix(sp.diag(A, A, C)))
    mass, (x, y, z) = particle_sums.MASS, particle_sums.IN_BODY
    assert sums.of(codec.encode(mass * (x**2 + y**2 + 3 * z))) == codec.encode(C)
    with pytest.raises(AlgebraError, match="without the mass of the particle"):
        sums.of(codec.encode(x**2))


# Refusals


def solid_of(place: tuple[object, ...], **given: object) -> Solid:
    plain = {"title": "T", "coordinates": (U, V, W), "bounds": (UNIT,) * 3, "density": rho}
    return Solid(**{**plain, "place": column(*place), **given})


FLAT = solid_of((U, V, 0))
ARC = {"coordinates": (U,), "bounds": ((sp.S.Zero, sp.pi),), "mass": M, "density": None}
ON_ARC = (a * sp.cos(U), a * sp.sin(U), 0)
REFUSED = [
    (lambda: solid_of((U, V, W), bounds=(UNIT, UNIT)), "expected one to three coordinates"),
    (lambda: solid_of((U, V, W), element=sp.S.One), "lines and surfaces have an element"),
    (lambda: solid_of((U, V, W), mass=M), "expected either the mass or the density"),
    (lambda: solid_of((U, V, W), bounds=((sp.S.Zero, V), UNIT, UNIT)), "the bounds of u contain v"),
    (
        lambda: moments_of(solid_of((U**2, V, W), bounds=((-sp.S.One, sp.Integer(3)), UNIT, UNIT))),
        "the map folds over",
    ),
    (lambda: moments_of(solid_of(ON_ARC, **ARC, element=2 * a)), r"square differs by 3\*a\*\*2"),
    (lambda: moments_of(solid_of(ON_ARC, **ARC, element=-a)), r"is negative; change its sign"),
    (lambda: solid("spere"), "no shape 'spere'; did you mean sphere"),
    (lambda: solid("cylinder", side=a), "cylinder has no side; it has radius, height"),
    (lambda: rs.solid("sphere", radius=-1, density=rho), "radius is -1 m; expected a positive"),
    (lambda: rs.solid("box", sides=[1, -1, 1], density=rho), "sides is -1 m"),
    (lambda: rs.solid("rod", length=0, density=rho), "length is 0 m"),
    (
        lambda: rs.solid("hollow_cylinder", inner_radius=2, outer_radius=1, density=rho),
        "less than inner_radius",
    ),
    (lambda: rs.principal_moments(1, 2, 2.5), r"2\.5.* is a floating-point number.*5/2"),
    (lambda: given_inertia(sp.diag(1, -1, 1), mass=M), r"smallest principal moment is -1 kg m²"),
    (lambda: rs.principal_moments(A, A, C, mass=sp.Integer(-2)), r"the mass is -2 kg; expected"),
    (lambda: rs.body_of(particles((m, a, 0, 0), (-m, 0, 0, 0))), "the mass is zero"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[message for _, message in REFUSED])
def test_a_body_that_cannot_be_is_refused_with_the_amount(make, message):
    with pytest.raises(BodyError, match=message):
        make()


@pytest.mark.parametrize(
    ("distribution", "place"),
    [
        (FLAT, ("shape",)),
        (particles((1, 0, 0, 0), (-1, 1, 0, 0)), ("particles",)),
        (
            Composite(parts=(Part(what=Composite(parts=(Part(what=FLAT),))),)),
            ("parts", 0, "parts", 0),
        ),
    ],
)
def test_a_body_that_cannot_be_is_refused_with_its_place(distribution, place):
    with pytest.raises(BodyError) as caught:
        rs.derive("ZXZ", ("rotational_energy",), body=distribution)
    assert caught.value.place == place
