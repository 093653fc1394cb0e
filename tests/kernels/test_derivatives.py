"""Kernels of derivatives: against finite differences at 50 digits, JAX, and the chain rule."""

from __future__ import annotations

import itertools
import re
import subprocess
import sys
from functools import cache

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.motions import derived
from helpers.witness import evaluate, mp
from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of
from rigidsym.commands.cli import commands
from rigidsym.errors import KernelError, QuantityError, SpecError
from rigidsym.kernels.lowering.derivatives import read_request, read_requests
from rigidsym.kernels.targets import TARGETS
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.pipeline import output_of, read_record, read_spec

MODELS = ("ZXZ", "zyx", "rotation_vector", "modified_rodrigues", "quaternion")
ALONE = ("z(phi) [a,b,c](beta)",)  # with parameters


@cache
def motion(name: str) -> rs.Motion:
    return derived(name) if name in rs.EULER_SEQUENCES else rs.derive(name)


def of(name: str, quantity: str, *vectors: str, target: str = "numpy"):
    """The functions of the derivatives of one quantity."""
    return _module(name, target, tuple(f"{quantity} by {vector}" for vector in vectors))


@cache
def _module(name: str, target: str, asked: tuple[str, ...]):
    return motion(name).kernels(target, derivatives=asked).load()


def arrays_for(name: str, quantity: str, leading: tuple[int, ...] = (), size: float = 1.0):
    rng = np.random.default_rng(4)
    found = {}
    for vector in motion(name).step(quantity).quantity.inputs:
        shape = (*leading, len(motion(name).argument(vector).symbols))
        found[vector] = rng.uniform(-1.0, 1.0, shape) * (size if vector == "q" else 1.0)
    if "parameters" in found:
        found["parameters"] = np.broadcast_to([2 / 3, 1 / 3, 2 / 3], found["parameters"].shape)
    return found


def numerical(motion, quantity: str, vector: str, point: dict) -> tuple[list, np.ndarray]:
    """Value and Jacobian of the derivation's expression, by differences at 50 digits."""
    symbols = {v: motion.argument(v).symbols for v in point}
    expression = motion.step(quantity).expression

    def at(step, place):
        known = {}
        for v, values in point.items():
            numbers = [mp.mpf(float(x)) for x in values]
            if v == vector:
                numbers[place] += step
            known.update(zip(symbols[v], numbers, strict=True))
        return list(evaluate(expression, known))

    step = mp.mpf(10) ** -18
    columns = []
    for place in range(len(point[vector])):
        above, below = at(step, place), at(-step, place)
        columns.append([(a - b) / (2 * step) for a, b in zip(above, below, strict=True)])
    return at(0, 0), np.array(columns, float).T


CASES = [
    *itertools.product(MODELS, ("angular_velocity_body",), ("q", "q_dot")),
    ("ZXZ", "rotation_matrix", "q"),
    ("ZXZ", "rates_from_angular_velocity_space", "q"),
    ("zyx", "angular_acceleration_space", "q_dot"),
    ("rotation_vector", "rotation_matrix", "q"),
    ("rotation_vector", "inverse_rate_matrix_body", "q"),
    (*ALONE, "angular_velocity_space", "parameters"),
]


@pytest.mark.parametrize(("name", "quantity", "vector"), CASES)
def test_jacobians_are_those_of_differences_at_50_digits(name, quantity, vector):
    point = arrays_for(name, quantity)
    value, jacobian = getattr(of(name, quantity, vector), f"{quantity}_jacobian_{vector}")(
        *point.values()
    )
    expected, slopes = numerical(motion(name), quantity, vector, point)
    shape = motion(name).step(quantity).shape
    assert (value.shape, jacobian.shape) == (shape, (*shape, len(point[vector])))
    assert_allclose(value.ravel(), np.array(expected, float), rtol=0, atol=1e-14)
    assert_allclose(jacobian.reshape(slopes.shape), slopes, rtol=1e-12, atol=1e-13)


def test_removable_singularities_stay_removable():
    """The Jacobian of Ω′ by a rotation vector where that vector is zero, or nearly."""
    functions = of("rotation_vector", "angular_velocity_body", "q")
    for size in (0.0, 1e-200, 1e-9, 1e-4):
        point = arrays_for("rotation_vector", "angular_velocity_body", size=size)
        _, found = functions.angular_velocity_body_jacobian_q(*point.values())
        assert_allclose(found, half_cross(point["q_dot"]), atol=2 * size + 1e-15)


SWITCHES = [float(series_of(k).switch) ** 0.5 for k in range(FIRST_SERIES, FIRST_SERIES + 3)]


@pytest.mark.parametrize(
    "size", [1e-9, *(s * side for s in SWITCHES for side in (1 - 1e-9, 1 + 1e-9))]
)
def test_jacobians_are_right_on_both_sides_of_every_switch(size):
    """Series stand in for quotients that cancel at small angles."""
    for quantity in ("angular_velocity_body", "inverse_rate_matrix_body", "rotation_matrix"):
        point = arrays_for("rotation_vector", quantity)
        point["q"] *= size / np.linalg.norm(point["q"])
        functions = of("rotation_vector", quantity, "q")
        _, jacobian = getattr(functions, f"{quantity}_jacobian_q")(*point.values())
        _, slopes = numerical(motion("rotation_vector"), quantity, "q", point)
        assert_allclose(jacobian.reshape(slopes.shape), slopes, rtol=1e-12, atol=2e-14)


def half_cross(v) -> np.ndarray:
    """d(−v × v̇/2)/dv: what Ω′ is to first order in v."""
    return 0.5 * np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


TOGETHER = ("angular_velocity_body", "angular_velocity_space", "rotation_matrix")


@pytest.mark.parametrize("name", ["ZXZ", "zyx", *PARAMETRISATIONS, *ALONE])
def test_jacobians_of_several_quantities_are_right_in_one_module(name):
    motion = rs.derive(name, only=TOGETHER)
    asked = [f"{q} by q" for q in TOGETHER]
    module = motion.kernels(derivatives=asked).load()
    random = np.random.default_rng(8)
    for quantity in TOGETHER:
        step = motion.step(quantity)
        inputs = [
            random.uniform(0.2, 1, len(motion.argument(v).names)) for v in step.quantity.inputs
        ]
        _, jacobian = getattr(module, f"{quantity}_jacobian_q")(*inputs)
        rows = jacobian.reshape(-1, len(motion.argument("q").names))
        point = dict(zip(step.quantity.inputs, inputs, strict=True))
        assert_allclose(rows, numerical(motion, quantity, "q", point)[1], rtol=1e-12, atol=1e-12)


def test_the_jacobian_along_the_motion_is_the_acceleration(sequence):
    """The chain rule: Ω̇ = ∂Ω/∂q q̇ + ∂Ω/∂q̇ q̈."""
    quantity = "angular_velocity_space"
    functions = of(sequence, quantity, "q", "q_dot")
    q, q_dot, q_ddot = arrays_for(sequence, "angular_acceleration_space", (4,)).values()
    _, by_q = functions.angular_velocity_space_jacobian_q(q, q_dot)
    _, by_q_dot = functions.angular_velocity_space_jacobian_q_dot(q, q_dot)
    found = np.einsum("...ij,...j", by_q, q_dot) + np.einsum("...ij,...j", by_q_dot, q_ddot)
    expected = functions.angular_acceleration_space(q, q_dot, q_ddot)
    assert_allclose(found, expected, atol=1e-14)


@pytest.mark.parametrize("name", ["ZXZ", "rotation_vector"])
def test_they_agree_with_jax(name):
    import jax

    quantity, before = "angular_velocity_body", jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    try:
        functions = of(name, quantity, "q", target="jax")
        point = list(arrays_for(name, quantity).values())
        value, jacobian = functions.angular_velocity_body_jacobian_q(*point)
        automatic = jax.jit(jax.jacfwd(functions.angular_velocity_body))(*point)
        plain = of(name, quantity, "q").angular_velocity_body_jacobian_q(*point)
        assert_allclose(jacobian, automatic, atol=1e-14)
        assert_allclose(value, plain[0], atol=1e-14)
        assert_allclose(jacobian, plain[1], atol=1e-14)
    finally:
        jax.config.update("jax_enable_x64", before)


@pytest.mark.parametrize("target", ["c", "numba"])
def test_compiled_targets_give_both(target):
    if TARGETS[target].missing:
        pytest.skip(TARGETS[target].missing)
    alone = motion("ZXZ").select(["angular_velocity_body"])
    asked = ["angular_velocity_body by q", "angular_velocity_body by q_dot"]
    compiled = alone.kernels(target, derivatives=asked).load()
    plain = of("ZXZ", "angular_velocity_body", "q", "q_dot")
    q, q_dot = arrays_for("ZXZ", "angular_velocity_body", (70,)).values()
    for found, expected in zip(
        (
            *compiled.angular_velocity_body_jacobian_q(q, q_dot),
            *compiled.angular_velocity_body_jacobian_q_dot(q, q_dot),
        ),
        (
            *plain.angular_velocity_body_jacobian_q(q, q_dot),
            *plain.angular_velocity_body_jacobian_q_dot(q, q_dot),
        ),
        strict=True,
    ):
        assert_allclose(found, expected, rtol=0, atol=4e-14)
    twin = compiled.angular_velocity_body_jacobian_q_scalar(*q[0], *q_dot[0])
    assert [np.shape(part) for part in twin] == [(3,), (3, 3)]
    assert_allclose(twin[1], plain.angular_velocity_body_jacobian_q(q[0], q_dot[0])[1], atol=4e-14)


def test_value_and_derivative_share_their_subexpressions():
    source = motion("ZXZ").kernels(derivatives={"angular_velocity_body": "q"}).source
    about = source[source.index("def angular_velocity_body_jacobian_q(") :]
    (total, trigonometric) = re.search(r"(\d+) operations: (\d+) sines", about).groups()
    assert (int(total), int(trigonometric)) == (19, 4)  # the value alone takes 13


def test_out_holds_both_and_float32_stays():
    q, q_dot = arrays_for("ZXZ", "angular_velocity_body", (9,)).values()
    function = of("ZXZ", "angular_velocity_body", "q").angular_velocity_body_jacobian_q
    assert function.signature == "(3),(3)->(3),(3,3)"
    out = np.empty((9, 12))
    value, jacobian = function(q, q_dot, out=out, threads=2)
    assert np.shares_memory(value, out)
    assert np.shares_memory(jacobian, out)
    assert_array_equal(jacobian, function(q, q_dot)[1])
    single = function(q.astype(np.float32), q_dot.astype(np.float32))
    assert {part.dtype for part in single} == {np.dtype(np.float32)}


@pytest.mark.parametrize(
    "text",
    ["", "q", "angular_velocity_body", "a by", "a by q hessian", "a by b c d"],
)
def test_texts_that_ask_for_no_derivative(text):
    with pytest.raises(KernelError, match=re.escape(f"no derivative {text!r}; expected")):
        read_request(text)


@pytest.mark.parametrize("text", ["a by q jvp", "a:q:vjp"])
def test_products_with_a_vector_are_left_to_numpy(text):
    with pytest.raises(KernelError, match="multiply the Jacobian J by your vector instead: J @ v"):
        read_request(text)


def test_spellings_of_one_request():
    asked = read_requests(["a by q", "a:q", "a by q_dot", "a:q_dot"])
    assert [*map(str, asked)] == ["a by q", "a by q_dot"]
    assert read_requests({"a": ("q", "q_dot")}) == asked
    assert read_requests({"a": "q"}) == read_requests("a by q") == asked[:1]


def test_what_a_quantity_does_not_take_is_refused():
    with pytest.raises(KernelError, match=r"^rotation_matrix by q_dot: .* depends only on q$"):
        motion("ZXZ").kernels(derivatives=["rotation_matrix by q_dot"])
    with pytest.raises(QuantityError, match="no quantity 'speed'"):
        motion("ZXZ").kernels(derivatives=["speed by q"])


@pytest.mark.campaign
@pytest.mark.parametrize("target", ["numpy", "jax"])
def test_ruff_would_leave_the_modules_as_they_are(tmp_path, target):
    for name in ("ZXZ", "rotation_vector"):
        asked = {"angular_velocity_body": ("q", "q_dot"), "rotation_matrix": "q"}
        motion(name).kernels(target, derivatives=asked).write(tmp_path)
    for command in (("format", "--check"), ("check",)):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, "--isolated", "--no-cache", str(tmp_path)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr


FILE = """
[rotation]
sequence = "ZXZ"
[output]
quantities = ["angular_velocity_body"]
kernels = ["numpy", "javascript"]
note = ["tex"]
derivatives = ["angular_velocity_body by q", "angular_velocity_body:q_dot"]
"""


def test_a_file_asks_for_them():
    spec = read_spec(FILE, source="a.toml", name="a")
    assert spec.derivatives == ("angular_velocity_body by q", "angular_velocity_body by q_dot")
    assert read_record(spec.to_data()) == spec
    files = output_of(spec).files
    assert "def angular_velocity_body_jacobian_q_dot(" in files["a.py"]
    assert "function angular_velocity_body_jacobian_q(q, q_dot)" in files["a.mjs"]


def test_all_faults_of_a_file_are_named_at_once():
    wrong = FILE.replace("angular_velocity_body by q", "angular_velocity_body of q")
    wrong = wrong.replace("angular_velocity_body:q_dot", "rotation_matrix:q")
    with pytest.raises(SpecError) as caught:
        read_spec(wrong, source="a.toml", name="a")
    assert "output.derivatives[0]: no derivative 'angular_velocity_body of q'" in str(caught.value)
    assert "output.derivatives[1]: no quantity " in str(caught.value)


def test_the_command_line_adds_to_a_file(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(FILE.replace(', "angular_velocity_body:q_dot"', ""))
    options = ["--derivative", "angular_velocity_body:q_dot", "--out", str(tmp_path)]
    done = CliRunner().invoke(commands, ["run", str(file), *options])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "a" / "a.py").read_text()
    for name in ("jacobian_q", "jacobian_q_dot"):
        assert f'"angular_velocity_body_{name}",' in text


def test_an_unknown_quantity_on_the_command_line_is_a_fault_of_usage(tmp_path):
    options = ["--derivative", "angular_velocity:q", "--out", str(tmp_path)]
    done = CliRunner().invoke(commands, ["derive", "ZXZ", *options])
    assert isinstance(done.exception, QuantityError)
    assert "--derivative: no quantity 'angular_velocity'\ndid you mean" in str(done.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("rotation", "vector", "is_bound"),
    [
        ("unit_quaternion", "q", True),
        ("unit_quaternion", "q_dot", True),
        ("direction_cosines", "q", True),
        ("z(phi) [a,b,c](beta)", "parameters", True),
        ("z(phi) [a,b,c](beta)", "q", False),
        ("ZXZ", "q", False),
    ],
)
def test_where_inputs_are_bound_the_text_says_what_the_derivative_is(rotation, vector, is_bound):
    alone = rs.derive(rotation, only=["spin_matrix"])
    for target in TARGETS:
        files = alone.kernels(target, derivatives=[f"spin_matrix by {vector}"]).files
        words = " ".join(re.sub(r"\n *\*? *", " ", text) for text in files.values())
        assert ("bound components count as free" in words) == is_bound, target


def test_the_jacobian_of_a_unit_quaternion_is_that_of_the_expression_as_written():
    kernels = rs.derive("unit_quaternion", only=["rotation_matrix"]).kernels(
        derivatives=["rotation_matrix by q"]
    )
    q = np.array([0.7, -0.3, 0.5, 0.2])  # no unit quaternion
    _, jacobian = kernels.load().rotation_matrix_jacobian_q(q)
    w, x, y, z = q
    assert_allclose(jacobian[0, 0], [0, 0, -4 * y, -4 * z], atol=1e-14)  # of 1 - 2y² - 2z²
    assert_allclose(jacobian[0, 1], [-2 * z, 2 * y, 2 * x, -2 * w], atol=1e-14)


def test_scalar_twins_return_value_and_derivative_in_their_shapes():
    asked = ["rotation_matrix by q", "rotational_energy by q_dot"]
    A, B, C = sp.symbols("A B C", positive=True)
    names = ("rotation_matrix", "rotational_energy")
    motion = rs.derive("ZXZ", names, body=rs.principal_moments(A, B, C))
    module = motion.kernels(derivatives=asked).load()
    q = [0.3, 0.4, 0.5]
    moments = [1.0, 2.0, 2.5] if len(motion.argument("parameters").names) == 3 else [1, 1, 2, 2.5]
    for name, given in {
        "rotation_matrix_jacobian_q": (q,),
        "rotational_energy_jacobian_q_dot": (q, q, moments),
    }.items():
        for first in (q[0], float("inf")):  # Python's floats raise an error at infinity
            given[0][0] = first
            flat = [float(x) for array in given for x in np.ravel(array)]
            found = getattr(module, f"{name}_scalar")(*flat)
            assert type(found) is tuple
            for part, expected in zip(found, getattr(module, name)(*given), strict=True):
                assert np.shape(part) == np.shape(expected)
                assert_allclose(part, expected, atol=1e-14)
                assert not isinstance(part, list | np.ndarray)
        given[0][0] = 0.3
