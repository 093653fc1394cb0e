"""Mass and inertia: against particles, trimesh and SymPy; tensors, principal axes, refusals."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
import trimesh

import rigidsym as rs
from rigidsym.algebra.integrate import Integrator, integration_codec
from rigidsym.errors import BodyError, QuantityError
from rigidsym.mechanics.mass.bodies import body_of, solid
from rigidsym.mechanics.mass.moments import moments_of
from rigidsym.mechanics.mass.principal import principal_of
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.body import BodyDescription, Solid, given_inertia
from rigidsym.models.solids import SHAPES, shaped

A, C, M, a, b, c, d, h, m, rho = sp.symbols("A C M a b c d h m rho")
NUMBERS = dict(zip(sp.symbols("a b c h l M"), (1.0, 1.5, 2.0, 2.5, 3.0, 4.0), strict=True))
CORNERS = [0, 0, 0, 2, 0, 0, 1, 3, 0, 0, 1, 2]
UNIT = (sp.S.Zero, sp.S.One)
U, V, W = sp.symbols("u v w")


def column(*entries: object) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([sp.sympify(entry) for entry in entries])


def particles(*rows: tuple[object, ...]) -> rs.Particles:
    found = [rs.Particle(mass=sp.sympify(mass), position=column(*at)) for mass, *at in rows]
    return rs.Particles(particles=tuple(found))


def made(shape: str, **given: object) -> rs.RigidBody:
    return solid(shape, **({"corners": CORNERS} if shape == "tetrahedron" else {}), **given)


body = cache(made)


def numbers(matrix: sp.MatrixBase, values: dict[sp.Symbol, float] = NUMBERS) -> np.ndarray:
    return np.array(matrix.subs(values).evalf().tolist(), dtype=float)


SPREAD: dict[str, Callable[..., tuple[object, ...]]] = {  # points of lines and surfaces
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
INSIDE: dict[str, Callable[..., np.ndarray]] = {  # points of solids, within ±1.5, ±1.5, ±2.5
    "box": lambda x, y, z: (abs(x) < 0.5) & (abs(y) < 0.75) & (abs(z) < 1),
    "cylinder": lambda x, y, z: (x * x + y * y < 1) & (abs(z) < 1.25),
    "hollow_cylinder": lambda x, y, z: (abs(x * x + y * y - 1.625) < 0.625) & (abs(z) < 1.25),
    "cone": lambda x, y, z: (np.hypot(x, y) < 1 - z / 2.5) & (z > 0),
    "frustum": lambda x, y, z: (np.hypot(x, y) < 1 + 0.5 * z / 2.5) & (z > 0),
    "sphere": lambda x, y, z: x * x + y * y + z * z < 1,
    "hollow_sphere": lambda x, y, z: abs(x * x + y * y + z * z - 1.625) < 0.625,
    "hemisphere": lambda x, y, z: (x * x + y * y + z * z < 1) & (z > 0),
    "ellipsoid": lambda x, y, z: x * x + y * y / 2.25 + z * z / 4 < 1,
    "torus": lambda x, y, z: (np.hypot(x, y) - 1) ** 2 + z * z < 0.25,
}
GRID = np.meshgrid(*(np.arange(0.025 - r, r, 0.05) for r in (1.5, 1.5, 2.5)), indexing="ij")
UNIFORM = [grid.ravel() for grid in np.meshgrid(*2 * [(np.arange(200) + 0.5) / 200])]


@pytest.mark.parametrize("shape", [*INSIDE, *SPREAD])
def test_a_shape_is_a_cloud_of_many_particles(shape):
    if shape in SPREAD:
        points = np.array(SPREAD[shape](*UNIFORM), dtype=float)
    else:
        points = np.array([axis[INSIDE[shape](*GRID)] for axis in GRID])
    values = NUMBERS | ({a: 1.0, b: 0.5} if shape == "torus" else {})
    centre = points.mean(axis=1)
    second = 4.0 / points.shape[1] * (points - centre[:, None]) @ (points - centre[:, None]).T
    exact = numbers(body(shape).inertia, values)
    assert np.allclose(centre, numbers(body(shape).centre, values).ravel(), atol=0.03)
    assert np.allclose(np.trace(second) * np.eye(3) - second, exact, atol=0.02 * exact.max())


def test_the_tetrahedron_and_its_mesh():
    corners = np.array(CORNERS, float).reshape(4, 3)
    mesh = trimesh.Trimesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    mesh.density = 4.0 / mesh.volume
    assert np.allclose(mesh.moment_inertia, numbers(body("tetrahedron").inertia))
    assert np.allclose(mesh.center_mass, numbers(body("tetrahedron").centre).ravel())
    turned = [*CORNERS[3:6], *CORNERS[:3], *CORNERS[6:]]  # its map reverses orientation
    assert solid("tetrahedron", corners=turned, density=sp.Integer(2)).mass == 4


@pytest.mark.parametrize("shape", SHAPES)
def test_laws_of_every_shape(shape):
    """Proved, symmetric, physical; with ρ = M/V in place of ρ, the tensor is that of the mass M."""
    whole = body(shape)
    assert rs.derive("ZXZ", ("centre_of_mass", "inertia_tensor"), body=whole).is_proved
    moments = np.linalg.eigvalsh(numbers(whole.inertia))
    assert moments[0] >= -1e-12
    assert moments[0] + moments[1] >= moments[2] - 1e-12
    dense = made(shape, density=rho)
    assert all(p.positive == ("_" not in p.symbol.name) for p in dense.parameters)
    assert whole.mass == M
    difference = dense.inertia.subs(rho, M / sp.cancel(dense.mass / rho)) - whole.inertia
    assert difference.applyfunc(sp.cancel) == sp.zeros(3)


def test_a_solid_of_any_density_by_its_bounds():
    x, y, z = corner = sp.symbols("x y z")
    density = rho * (1 + z / h)
    bounds = ((sp.S.Zero, a), (sp.S.Zero, a - x), (sp.S.Zero, h))
    found = body_of(solid_of(corner, coordinates=corner, bounds=bounds, density=density))

    def whole(integrand: sp.Expr) -> sp.Expr:
        return sp.integrate(density * integrand, (z, 0, h), (y, 0, a - x), (x, 0, a))

    mass = whole(sp.S.One)
    away = sum(whole(s) ** 2 / mass for s in (x, y))
    assert sp.expand(found.mass - mass) == 0
    assert sp.cancel(found.centre[2] - whole(z) / mass) == 0
    assert sp.cancel(found.inertia[2, 2] - whole(x**2 + y**2) + away) == 0


def test_parts_move_turn_and_add_up_and_a_hole_takes_away():
    outer = rs.Part(what=shaped("cylinder", [b, h], density=rho))
    hole = rs.Part(what=shaped("cylinder", [a, h], density=rho), hole=True)
    ring = body_of(rs.Composite(parts=(outer, hole)))
    hollow = solid("hollow_cylinder", density=rho)
    assert (ring.inertia - hollow.inertia).applyfunc(sp.cancel) == sp.zeros(3)
    turn = sp.ImmutableMatrix(sp.Matrix([[3, -4, 0], [0, 0, 5], [-4, -3, 0]]) / 5)
    at, cone = column(1, h, -2), body("cone")  # whose centre is not its origin
    part = rs.Part(what=shaped("cone", [a, h], mass=M), at=at, turned=turn)
    moved = body_of(rs.Composite(parts=(part,)))
    assert (moved.inertia - turn * cone.inertia * turn.T).applyfunc(sp.expand) == sp.zeros(3)
    assert (moved.centre - turn * cone.centre - at).applyfunc(sp.expand) == sp.zeros(3, 1)


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


PARTICLES = particles((m, a, b, 0), (m, -a, -b, 0), (2 * m, 0, 0, h))


def test_the_tensor_of_a_point_and_a_line_are_those_of_the_particles():
    """Against the sums of the lecture, section 2.2, over the particles themselves."""
    motion = rs.derive("ZXZ", [*INERTIA_QUANTITIES], body=rs.body_of(PARTICLES))
    assert motion.is_proved
    p, n = (column(*motion.argument(name).symbols) for name in ("point", "direction"))
    total, moment = sp.zeros(3), sp.S.Zero
    for particle in PARTICLES.particles:
        x = particle.position - p
        total += particle.mass * (x.dot(x) * sp.eye(3) - x * x.T)
        moment += particle.mass * n.cross(x).dot(n.cross(x))
    assert (total - motion.inertia_tensor_point).applyfunc(sp.cancel) == sp.zeros(3)
    assert sp.cancel(moment - motion.moment_of_inertia) == 0


WITHOUT = {
    "mass": "it is given, not added up",
    "centre_of_mass": "how its mass is distributed is not given",
    "principal_moments": "no closed form was found, which a general tensor has not",
    "principal_axes": "no closed form was found, or none that is short enough",
}


def test_what_a_general_tensor_does_not_tell_is_refused_by_name():
    body = rs.general_inertia()
    for name, reason in WITHOUT.items():
        with pytest.raises(QuantityError, match=f"has no quantity {name}: {reason}"):
            rs.derive("ZXZ", ["inertia_tensor", name], body=body)
    names = {step.quantity.name for step in rs.derive("ZXZ", body=body).steps}
    assert names.isdisjoint(WITHOUT)
    assert "inertia_tensor_space" in names


TENSORS = {  # with words of the sentence
    "diagonal": (sp.diag(a, b, c), "body axes are principal axes."),
    "sphere": (sp.diag(a, a, a), "every axis through the centre"),
    "two equal": (sp.diag(a, c, a), "every axis perpendicular to y"),
    "one axis apart": (sp.Matrix([[a, d, 0], [d, b, 0], [0, 0, c]]), "The z-axis is principal"),
    "numbers": (sp.Matrix([[3, 1, 0], [1, 3, 0], [0, 0, 5]]), "roots of a quadratic"),
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


def solid_of(place: tuple[object, ...], **given: object) -> Solid:
    plain = {"title": "T", "coordinates": (U, V, W), "bounds": (UNIT,) * 3, "density": rho}
    return Solid(**{**plain, "place": column(*place), **given})


FLAT = solid_of((U, V, 0))
ARC = {"coordinates": (U,), "bounds": ((sp.S.Zero, sp.pi),), "mass": M, "density": None}
ON_ARC = (a * sp.cos(U), a * sp.sin(U), 0)
NESTED = rs.Composite(parts=(rs.Part(what=rs.Composite(parts=(rs.Part(what=FLAT),))),))
REFUSED = [
    (lambda: solid_of((U, V, W), element=sp.S.One), "lines and surfaces have an element"),
    (lambda: solid_of((U, V, W), bounds=((sp.S.Zero, V), UNIT, UNIT)), "the bounds of u contain v"),
    (lambda: moments_of(solid_of(ON_ARC, **ARC, element=2 * a)), "is false"),
    (lambda: solid("spere"), "no shape 'spere'; did you mean sphere"),
    (lambda: solid("cylinder", side=a), "cylinder has no side; it has radius, height"),
    (lambda: rs.solid("sphere", radius=-1, density=rho), "radius is -1 m; expected a positive"),
    (lambda: rs.principal_moments(1, 2, 2.5), r"2\.5.* is a floating-point number.*5/2"),
    (lambda: rs.body_of(particles((m, a, 0, 0), (-m, 0, 0, 0))), "the mass is zero"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED)
def test_a_body_that_cannot_be_is_refused_with_the_amount(make, message):
    with pytest.raises(rs.RigidsymError, match=message):
        make()


def test_a_body_that_cannot_be_is_refused_with_its_place():
    with pytest.raises(BodyError, match="its points are in a plane") as caught:
        rs.derive("ZXZ", ("rotational_energy",), body=NESTED)
    assert caught.value.place == ("parts", 0, "parts", 0)


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


def test_kernels_evaluate_the_body():
    motion = rs.derive("ZXZ", body=rs.solid("cylinder"))
    module, values = motion.kernels().load(), {"M": 2.0, "a": 3.0, "h": 5.0}
    parameters = [values[s.name] for s in motion.argument("parameters").symbols]
    tensor = module.inertia_tensor(parameters)
    assert np.allclose(tensor, np.diag([2 * (27 + 25) / 12] * 2 + [9]))
    assert np.isclose(module.moment_of_inertia([3, 0, 0], [0, 0, 1], parameters), 27)
    space = module.inertia_tensor_space([0.3, 1.3, 2.3], parameters)
    assert np.allclose(np.linalg.eigvalsh(space), np.linalg.eigvalsh(tensor))


def test_a_constant_keeps_its_letter_and_ours_is_another():
    dense, light = (rs.solid("box", density=sp.Symbol("M")), rs.solid("disc", mass=sp.Symbol("m")))
    for body, letter in ((dense, "M_0"), (light, "m")):
        step = rs.derive("x(phi)", ["translational_energy"], body=body).step("translational_energy")
        assert f"\\,{letter}\\," in step.quantity.definition.latex
    body = rs.principal_moments(*sp.symbols("E L a"))
    motion = rs.derive("ZXZ", body=body, potential="V*H*cos(theta)", first_integrals={"T": "0*phi"})
    letters = {step.quantity.name: step.quantity.symbol.text for step in motion.steps}
    names = ("potential_energy", "lagrangian", "energy", "hamiltonian")
    assert [letters[name] for name in names] == ["U", "L₀", "E₀", "H₀"]
    assert [each.symbol.text for each in motion.first_integrals] == ["E₀", "p_φ", "T"]
    assert {"dE₀/dt = 0", "H₀ = E₀"} <= {proof.claim.text for proof in motion.proofs}
