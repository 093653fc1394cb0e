"""The body by itself: tensors about points, lines and in space, principal axes, their proofs."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import BodyError, QuantityError
from rigidsym.mechanics.mass.bodies import body_of
from rigidsym.mechanics.mass.principal import principal_of
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.models.body import Composite, Part, Particle, Particles, Solid, given_inertia
from rigidsym.models.rotation import elementary
from rigidsym.models.solids import SHAPES, shaped

A, B, C, M, a, b, c, d, h, m = sp.symbols("A B C M a b c d h m")
NAMES = tuple(INERTIA_QUANTITIES)


def column(*entries: object) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([sp.sympify(entry) for entry in entries])


def particles(*rows: tuple[object, ...]) -> Particles:
    found = [Particle(mass=sp.sympify(mass), position=column(*at)) for mass, *at in rows]
    return Particles(particles=tuple(found))


BODIES = {
    "general": rs.general_inertia(),
    "symmetric": rs.principal_moments(A, A, C),
    "cylinder": rs.solid("cylinder"),
    "cone": rs.solid("cone"),
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


OF_PRINCIPAL = ("principal_moments", "principal_axes", "inertia_ellipsoid")
ABSENT = {
    "general": ("mass", "centre_of_mass", *OF_PRINCIPAL),
    "symmetric": ("mass", "centre_of_mass"),
    "cylinder": ("mass",),
    "cone": ("mass",),
}


@cache
def motion(body: str) -> rs.Motion:
    return rs.derive("ZXZ", [n for n in NAMES if n not in ABSENT.get(body, ())], body=BODIES[body])


@pytest.mark.parametrize("body", BODIES)
def test_every_step_is_proved(body):
    found = motion(body)
    assert found.is_proved
    assert sum(1 for _ in found.proofs) >= 6


@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_is_proved(shape):
    corners = {"corners": [0, 0, 0, 2, 0, 0, 1, 3, 0, 0, 1, 2]} if shape == "tetrahedron" else {}
    found = rs.derive("ZXZ", ("centre_of_mass", "inertia_tensor"), body=rs.solid(shape, **corners))
    assert found.is_proved


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


def test_eigenvalues_do_not_change_under_a_rotation():
    rotation = {q: k + 0.3 for k, q in enumerate(motion("cylinder").argument("q").symbols)}
    values = {M: 2, a: 3, h: 5}
    space, body = (
        np.array(matrix.subs(rotation).subs(values).evalf().tolist(), dtype=float)
        for matrix in (motion("cylinder").inertia_tensor_space, motion("cylinder").inertia_tensor)
    )
    assert np.allclose(np.linalg.eigvalsh(space), np.linalg.eigvalsh(body))


TENSORS = {
    "diagonal": sp.diag(a, b, c),
    "two equal": sp.diag(a, c, a),
    "one axis apart": sp.Matrix([[a, d, 0], [d, b, 0], [0, 0, c]]),
    "another axis apart": sp.Matrix([[a, 0, d], [0, b, 0], [d, 0, c]]),
    "corner of a cube": sp.Matrix([[a, -d, -d], [-d, a, -d], [-d, -d, a]]),
    "numbers": sp.Matrix([[3, 1, 0], [1, 3, 0], [0, 0, 5]]),
    "one rational root": sp.Matrix([[6, -2, 0], [-2, 6, -2], [0, -2, 6]]),
    "an oblique axis apart": sp.Matrix([[6, 1, 1], [1, 6, 1], [1, 1, 7]]),
    "an oblique axis in symbols": sp.Matrix([[a, d, d], [d, a, d], [d, d, b]]),
}
VALUES = {a: 7.0, b: 6.0, c: 5.0, d: 1.5}


@pytest.mark.parametrize("name", TENSORS)
def test_principal_axes_in_symbols_agree_with_numbers(name):
    tensor = sp.ImmutableMatrix(TENSORS[name])
    found = principal_of(tensor)
    assert found is not None
    numbers = np.array(tensor.subs(VALUES).tolist(), dtype=float)
    moments = np.array(found.moments.subs(VALUES).evalf().tolist(), dtype=float).ravel()
    assert np.allclose(sorted(moments), np.linalg.eigvalsh(numbers))
    axes = np.array(found.axes.subs(VALUES).evalf().tolist(), dtype=float)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert np.allclose(numbers @ axes, axes * moments)
    body = given_inertia(tensor, mass=M)
    steps = ("principal_moments", "principal_axes")
    assert rs.derive("ZXZ", steps, body=body).is_proved


def test_repeated_moments_are_said():
    sentences = {name: principal_of(sp.ImmutableMatrix(t)) for name, t in TENSORS.items()}
    assert "every axis across y" in sentences["two equal"].because
    assert "two moments are equal" in sentences["corner of a cube"].because
    assert "equal" not in sentences["diagonal"].because
    assert "every axis through the centre" in principal_of(sp.ImmutableMatrix(sp.eye(3))).because


def test_an_irreducible_polynomial_is_left_to_numbers():
    assert principal_of(BODIES["general"].inertia) is None


def test_a_polynomial_that_has_no_factors_is_not_factored(monkeypatch):
    monkeypatch.setattr(sp, "factor_list", None)
    assert principal_of(BODIES["general"].inertia) is None
    names = [step.quantity.name for step in motion("general").steps]
    assert "principal_moments" not in names
    assert "inertia_tensor_space" in names


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("mass", "it is given, not added up"),
        ("centre_of_mass", "how its mass is distributed is not given"),
        ("principal_moments", "no closed form was found, which a general tensor has not"),
        ("principal_axes", "no closed form was found, or none that is short enough"),
        ("inertia_ellipsoid", "no principal moments were found, or one of them is 0"),
    ],
)
def test_what_a_body_has_not_is_said_where_it_is_asked_for(name, why):
    with pytest.raises(QuantityError, match=f"has no quantity {name}: {why}"):
        rs.derive("ZXZ", ["inertia_tensor", name], body=BODIES["general"])
    everything = rs.derive("ZXZ", body=BODIES["general"])
    assert name not in [step.quantity.name for step in everything.steps]


def test_axes_too_long_for_use_are_left_out_and_the_moments_proved():
    ring = Part(what=shaped("torus", [b, b / 5], mass=M), at=column(-b / 2, -b / 2, a))
    cone = Part(
        what=shaped("cone", [2 * b, 2 * b], mass=m),
        turned=elementary("y", sp.pi / 2),
        at=column(2 * c, -b / 2, 2 * c),
    )
    body = rs.body_of(Composite(parts=(ring, cone)))
    found = principal_of(body.inertia)
    assert found.axes is None
    assert "too long" in found.because
    assert rs.derive("ZXZ", ["principal_moments"], body=body).is_proved
    values = {a: 0.7, b: 0.45, c: 0.9, M: 2.3, m: 0.8}
    expected = np.linalg.eigvalsh(np.array(body.inertia.xreplace(values), float))
    assert np.allclose(sorted(float(moment.xreplace(values)) for moment in found.moments), expected)


def test_kernels_evaluate_the_body():
    module = motion("cylinder").kernels().load()
    mass, radius, height = 2.0, 3.0, 5.0
    symbols = [s.name for s in motion("cylinder").argument("parameters").symbols]
    parameters = [{"M": mass, "a": radius, "h": height}[name] for name in symbols]
    tensor = module.inertia_tensor(parameters)
    across = mass * (3 * radius**2 + height**2) / 12
    assert np.allclose(tensor, np.diag([across, across, mass * radius**2 / 2]))
    about_edge = module.moment_of_inertia([radius, 0, 0], [0, 0, 1], parameters)
    assert about_edge == pytest.approx(1.5 * mass * radius**2)
    assert np.allclose(module.radii_of_gyration(parameters)[2], radius / np.sqrt(2))
    assert np.allclose(module.inertia_ellipsoid(parameters) ** 2 * np.diag(tensor), 1)


def test_an_unphysical_body_made_in_python_is_refused_with_the_amount():
    with pytest.raises(BodyError, match=r"not positive: its smallest principal moment is -1 kg m²"):
        given_inertia(sp.diag(1, -1, 1), mass=M)
    with pytest.raises(BodyError, match=r"the mass is -2 kg; expected a positive number"):
        rs.principal_moments(A, A, C, mass=sp.Integer(-2))
    with pytest.raises(BodyError, match="the mass is zero"):
        rs.body_of(particles((m, a, 0, 0), (-m, 0, 0, 0)))


def test_a_map_that_folds_over_is_refused():
    """x = u² goes through the same places twice; in the middle of its bounds it does not tell."""
    u, v, w, rho = sp.symbols("u v w rho")
    unit = (sp.S.Zero, sp.S.One)
    folded = Solid(
        title="fold",
        coordinates=(u, v, w),
        place=sp.ImmutableMatrix([u**2, v, w]),
        bounds=((sp.Integer(-1), sp.Integer(3)), unit, unit),
        density=rho,
    )
    with pytest.raises(BodyError, match="the map folds over"):
        body_of(folded)
