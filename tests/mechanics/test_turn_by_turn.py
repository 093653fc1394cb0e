"""Long products of turns by recursion: the expanded form, true at 50 digits, linear in n."""

from __future__ import annotations

import random

import pytest
import sympy as sp

import rigidsym as rs
from helpers.witness import mp
from rigidsym.algebra.codec import codec_for
from rigidsym.mechanics.derive import derive
from rigidsym.mechanics.kinematics import chain as chain_of_turns
from rigidsym.mechanics.kinematics.chain import Chain, is_shorter
from rigidsym.mechanics.kinematics.workspace import Values
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES
from rigidsym.mechanics.quantities.kinematics import KINEMATICS

LETTERS = "zxzyxyzxyzxyzxzyxyzx"
TOLERANCE = mp.mpf(10) ** -40


def chain(count: int, *, oblique: int = 0) -> rs.RotationModel:
    """`count` turns about coordinate axes, or about axes of small whole numbers by a seed."""
    generator = random.Random(oblique)
    axes = [
        "[{},{},{}]".format(*(generator.randint(1, 3) for _ in range(3))) if oblique else letter
        for letter in LETTERS[:count]
    ]
    return rs.rotation_from(" ".join(f"{axis}(q{k})" for k, axis in enumerate(axes, 1)))


def spelled(work: Chain, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    values: dict[sp.Symbol, sp.Expr] = {}
    for definition in work.definitions_of([matrix]):
        values[definition.symbol] = definition.expression.xreplace(values)
    return matrix.xreplace(values)


@pytest.mark.parametrize(
    ("count", "oblique"), [*((n, 0) for n in range(1, 7)), *((n, 1) for n in range(1, 4))]
)
def test_the_recursion_is_the_expanded_form_in_the_ring(count, oblique):
    model = chain(count, oblique=oblique)
    work, values = Chain(model), Values(model)
    for name, expanded in (
        ("rotation_matrix", values.rotation),
        ("angular_velocity_space", values.omega_space),
        ("angular_velocity_body", values.omega_body),
        ("rate_matrix_space", values.rate_matrix("space")),
        ("rate_matrix_body", values.rate_matrix("body")),
        ("angular_acceleration_space", values.omega_space.dt()),
        ("angular_acceleration_body", values.omega_body.dt()),
    ):
        step = work.step(KINEMATICS[name])
        entries = map(values.codec.encode, spelled(work, step.expression))
        assert not any(e - x for e, x in zip(entries, expanded.entries, strict=True)), name


def numbers(model: rs.RotationModel) -> dict[sp.Expr, sp.Expr]:
    generator = random.Random(7)
    return {
        sp.diff(q, "t", order) if order else q: sp.Rational(generator.randint(-900, 900), 300)
        for q in model.coordinates
        for order in range(3)
    }


def axis_turn(direction, angle):
    """Rodrigues' formula in numbers of 50 digits."""
    x, y, z = direction
    skew = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + mp.sin(angle) * skew + (1 - mp.cos(angle)) * skew * skew


@pytest.mark.campaign
@pytest.mark.parametrize(("count", "oblique"), [(5, 0), (6, 3), (9, 4), (20, 0), (20, 5)])
def test_all_quantities_are_true_at_fifty_digits(count, oblique):
    model = chain(count, oblique=oblique)
    derivation = derive(model)
    assert derivation.is_proved
    at = numbers(model)
    t = sp.Symbol("t")
    values = {k: mp.mpf(v.p) / v.q for k, v in at.items()}
    known = dict(values)
    for argument in derivation.arguments:
        known |= {s: mp.mpf(k) / 7 for k, s in enumerate(argument.symbols, 1) if s.is_Symbol}
    for definition in derivation.definitions:
        known[definition.symbol] = value_of(definition.expression, known)

    def found(name):
        expression = derivation.step(name).expression
        rows = [[value_of(entry, known) for entry in row] for row in expression.tolist()]
        return mp.matrix(rows)

    directions = [[value_of(sp.sympify(e), known) for e in turn.direction] for turn in model.turns]
    turned, columns = mp.eye(3), []
    velocity, acceleration = mp.matrix(3, 1), mp.matrix(3, 1)
    for q, direction in zip(model.coordinates, directions, strict=True):
        axis = turned * mp.matrix(direction)
        columns.append(axis)
        rate, second = values[sp.diff(q, t)], values[sp.diff(q, t, 2)]
        acceleration += second * axis + rate * cross(velocity, axis)
        velocity += rate * axis
        turned = turned * axis_turn(direction, values[q])
    rates = mp.matrix(3, count)
    for place, column in enumerate(columns):
        rates[:, place] = column
    for name, expected in (
        ("rotation_matrix", turned),
        ("angular_velocity_space", velocity),
        ("angular_velocity_body", turned.T * velocity),
        ("rate_matrix_space", rates),
        ("rate_matrix_body", turned.T * rates),
        ("inverse_rate_matrix_space", rates.T * mp.inverse(rates * rates.T)),
        ("angular_acceleration_space", acceleration),
        ("angular_acceleration_body", turned.T * acceleration),
    ):
        assert mp.norm(found(name) - expected) < TOLERANCE, name


def cross(a, b):
    return mp.matrix(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def value_of(expression, known):
    """A number of 50 digits for sums, products, powers, sines and cosines of what is known."""
    if expression in known:
        return known[expression]
    if expression.is_Rational:
        return mp.mpf(int(expression.p)) / int(expression.q)
    parts = [value_of(argument, known) for argument in expression.args]
    if expression.is_Add:
        return mp.fsum(parts)
    if expression.is_Mul:
        return mp.fprod(parts)
    if expression.is_Pow:
        return mp.power(*parts)
    return {sp.sin: mp.sin, sp.cos: mp.cos}[expression.func](*parts)


def test_a_wrong_definition_is_not_proved():
    model = chain(5)
    work = Chain(model)
    broken = work.partial[3]
    (symbol,) = [s for s in broken.free_symbols if s.name == "P3_11"]
    work._groups["P3"][symbol] += symbol
    with pytest.raises(rs.RigidsymError, match="is false"):
        work.step(KINEMATICS["rotation_matrix"])


@pytest.mark.parametrize(
    ("law", "quantity"),
    [
        ("velocity", "angular_velocity_space"),
        ("velocity", "angular_velocity_body"),
        ("acceleration", "angular_acceleration_space"),
        ("acceleration", "angular_acceleration_body"),
    ],
)
def test_a_wrong_law_of_composition_is_refuted(monkeypatch, law, quantity):
    monkeypatch.setattr(chain_of_turns, law, lambda R, own, *others: own - R @ others[-1])
    monkeypatch.setattr(chain_of_turns, "_composition", chain_of_turns._composition.__wrapped__)
    with pytest.raises(rs.RigidsymError, match="is false"):
        Chain(chain(5)).step(KINEMATICS[quantity])


def test_operations_and_definitions_grow_linearly():
    counts = {n: len(derive(chain(n)).definitions) for n in (6, 12, 18)}
    assert counts[18] - counts[12] == counts[12] - counts[6]


def test_three_and_four_turns_keep_their_expanded_form():
    for model in (rs.EulerAngles("ZXZ"), chain(3), chain(4)):
        assert not is_shorter(model)
        assert derive(model).definitions == ()
    assert is_shorter(chain(5))


def test_the_attributes_of_a_motion_are_in_the_coordinates_only():
    motion = rs.derive(chain(5))
    allowed = {q.func for q in motion.model.coordinates}
    matrix = motion.rotation_matrix
    assert not matrix.free_symbols - {sp.Symbol("t")}
    assert {f.func for f in matrix.atoms(sp.core.function.AppliedUndef)} == allowed
    codec = codec_for([*matrix], order=0)
    residual = [codec.encode(entry) for entry in matrix * matrix.T - sp.eye(3)]
    assert not any(residual)


def test_turns_whose_axes_stay_in_a_plane_have_no_right_inverse():
    inverse = KINEMATICS["inverse_rate_matrix_space"]
    assert Chain(rs.rotation_from("z(a) z(b) z(c) x(d)")).step(inverse) is None
    assert Chain(rs.rotation_from("z(a) z(b) z(c) x(d) z(e)")).step(inverse).proofs


def test_a_long_chain_is_shown_in_vector_form():
    motion = rs.derive(chain(12))
    shown = {step.quantity.name: step.text() for step in motion.steps}
    assert "R = P₁₂, Pₖ = Pₖ₋₁ Tₖ" in shown["rotation_matrix"]
    assert "Ω = u₁, uₖ = θ̇ₖ nₖ + Tₖ uₖ₊₁" in shown["angular_velocity_space"]
    assert "W = (n₁, P₁ n₂, …, P₁₁ n₁₂)" in shown["rate_matrix_space"]
    assert motion.singularities.is_solved


def test_a_body_on_a_long_chain_has_the_energy_and_momentum_of_the_expanded_rotation():
    model, body = chain(5), rs.solid("cylinder", radius=sp.Symbol("a"), height=sp.Symbol("h"))
    motion = rs.derive(model, body=body)
    assert all(step.proofs for step in motion.steps if step.quantity.name in ENERGY_QUANTITIES)
    assert motion.is_proved
    values = Values(model, motion.body)
    omega, inertia = values.omega_body, values.codec.matrix(motion.body.inertia)
    encode = values.codec.encode
    assert encode(2 * motion.rotational_energy) == (omega.T @ inertia @ omega)[0, 0]
    momentum = (values.rotation @ (inertia @ omega)).entries
    assert tuple(map(encode, motion.angular_momentum_rotation)) == momentum
    turned = values.rotation @ inertia @ values.rotation.T
    assert tuple(map(encode, motion.inertia_tensor_space)) == turned.entries


@pytest.mark.parametrize(
    "text",
    [
        "z(a) y(b) z(c) x(d) z(e)",
        "z(a) x(b) y(c) z(d) x(e) y(f) z(g)",
        "z(a) [0,1,8](b) z(c) [0,1,8](d) z(e)",
    ],
)
def test_a_long_chain_is_singular_where_all_axes_lie_in_one_plane_and_not_nearby(text):
    motion = rs.derive(rs.rotation_from(text))
    found, coordinates = motion.singularities, motion.model.coordinates
    (point,) = found.points
    assert found.is_solved
    assert [place.coordinate for place in point.places] == [*coordinates[1:-1]]
    generator = random.Random(3)
    for shifted in (None, *point.places):
        free = {q: mp.mpf(generator.randint(-300, 300)) / 100 for q in coordinates}
        half = {p.coordinate: generator.choice((0, 1)) * mp.pi for p in point.places}
        fixed = {p.coordinate: p.value / sp.pi * mp.pi + half[p.coordinate] for p in point.places}
        free |= {q: mp.mpf(value) for q, value in fixed.items()}
        if shifted is not None:
            free[shifted.coordinate] += mp.mpf("0.3")

        def number(matrix, at=free):
            return mp.matrix([[value_of(e, at) for e in row] for row in matrix.tolist()])

        columns, turned = [], mp.eye(3)
        for turn in motion.model.turns:
            direction = [value_of(sp.sympify(e), {}) for e in turn.direction]
            columns.append(turned * mp.matrix(direction))
            turned = turned * axis_turn(direction, free[turn.angle])
        rates = mp.matrix(3, len(columns))
        for place, column in enumerate(columns):
            rates[:, place] = column
        if shifted is None:
            assert mp.norm(number(point.lost_axis_space).T * rates) < TOLERANCE
            assert mp.norm(number(point.lost_axis_body).T * (turned.T * rates)) < TOLERANCE
            assert mp.norm(rates * number(point.null_rates)) < TOLERANCE
        else:
            assert mp.det(rates * rates.T) > 1e-9


def test_a_chain_whose_neighbours_may_share_an_axis_says_that_its_singularities_are_open():
    model = rs.rotation_from("z(a) z(b) x(c) y(d) z(e) x(f)")
    found = rs.derive(model, ["rate_matrix_space"]).singularities
    assert not found.is_solved
    assert found.points == ()


@pytest.mark.parametrize(
    "text",
    [
        " ".join(f"z(a{k})" for k in range(1, 21)),
        f"z({' + '.join(f'sqrt({p})*a' for p in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29))}) x(b)",
        "[a,b,c](x) [d,e,f](y) [g,h,i](z)",
    ],
    ids=["twenty turns about one axis", "ten roots in an angle", "three symbolic axes"],
)
def test_what_grows_exponentially_if_it_is_multiplied_out_is_not(text):
    motion = rs.derive(rs.rotation_from(text))
    assert motion.is_proved
    source = motion.kernels().source
    assert len(source) < 200_000
