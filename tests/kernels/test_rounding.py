"""Bounds on rounding: by hand for single operations, and above what is measured at 50 digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rigidsym as rs
from benchmarks.bounds import PUBLISHED, bounded_kernels, gappa_bound, rigid_body
from helpers.motions import derived
from helpers.node import load
from helpers.target_modules import SPECIAL, row_by_row
from helpers.witness import evaluate, mp
from rigidsym.kernels.ir import Assignment, Call, Kernel, KernelArgument, Name, Number, Product, Sum
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.rounding import Bounded, largest_error, rounding
from rigidsym.models.library import PARAMETRISATIONS

A, B, ONE, TENTH = Name("a"), Name("b"), Number(Fraction(1)), Number(Fraction(1, 10))


def kernel(*values) -> Kernel:
    """Assignments x0, x1, ... of two inputs; the last one is the output."""
    lines = tuple(Assignment(f"x{k}", value) for k, value in enumerate(values))
    q = KernelArgument(name="q", components=("a", "b"), units=("", ""), about="")
    return Kernel(
        name="k", arguments=(q,), assignments=lines, outputs=(Name(lines[-1].name),), shape=()
    )


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ([Sum((A, B))], 0.5),  # half a unit in the last place of a sum of at most two
        ([Product((A, B))], 0.25),
        ([Sum((A, B, ONE))], 1.5),  # the error of a + b, and half a unit below four
        ([Sum((A, B)), Product((Number(Fraction(1, 2)), Name("x0")))], 0.25),  # scaling is exact
        ([Sum((A, B)), Product((Name("x0"),), (Number(Fraction(4)),))], 0.125),
        ([Product((A,), (Number(Fraction(3)),))], 0.125),  # of a third
        ([TENTH], 0.03125),  # the nearest double
        ([Call("sin", A)], 1.1),
        ([Call("sin", A), Product((Name("x0"), B))], 1.35),
        ([Sum((A, B)), Call("cos", Name("x0"))], 1.6),  # the angle's own error is passed on
    ],
)
def test_single_operations(values, error):
    found = rounding(kernel(*values)).error
    assert error < found <= error + 0.11


@pytest.mark.parametrize("value", [Product((A,), (B,)), Call("sqrt", A)])
def test_where_there_is_no_bound(value):
    assert rounding(kernel(value)) is None


def test_a_bound_names_the_arguments_it_holds_for():
    assert rounding(kernel(Call("sin", A), Product((Name("x0"), B)))) == (1.4, (), ("q",))
    bounds = {k.name: rounding(k) for k in lower(derived("ZXZ")).kernels}
    assert bounds["rotation_matrix"][1:] == (("q",), ())
    assert bounds["angular_velocity_body"][1:] == (("q",), ("q_dot",))


@pytest.mark.usefixtures("gappa")
@pytest.mark.parametrize(
    ("rotation", "names"),
    [
        ("ZXZ", ("rotation_matrix", "angular_velocity_body", "rate_matrix_space")),
        ("xyz", ("angular_velocity_space", "singularity_margin")),
        ("quaternion", ("rates_from_angular_velocity_body",)),
        ("rotation_vector", ("rotation_matrix", "singularity_margin")),  # functions c_k
        ("z(phi) [1,2,2](theta)", ("rate_matrix_body",)),  # numbers that are no floats
        ("z(2*phi-psi) x(theta)", ("rate_matrix_space",)),  # sines of rounded angles
    ],
)
def test_gappa_proves_the_stated_bounds(rotation, names):
    stated = {
        kernel.name: (kernel, error) for kernel, error in bounded_kernels(rs.derive(rotation))
    }
    for kernel, error in (stated[name] for name in names):
        for bits in (64, 32):
            assert error - 0.3 < gappa_bound(kernel, bits) <= error


def test_rigid_bodies_of_fpbench_have_the_bounds_that_fptaylor_publishes():
    for name, published in PUBLISHED.items():
        kernel = rigid_body(name)
        inputs = dict.fromkeys(kernel.components, Bounded.rounded(15.0))
        assert largest_error(kernel, inputs) * 2.0**-52 == pytest.approx(published, rel=0.005)


TURNS = ("z(phi) [1,2,2](theta)", "z(2*phi-psi) x(theta)")


def measured(motion, name: str, function, arrays) -> float:
    """The largest absolute error of an entry, in eps of the type."""
    symbols = [s for n in motion.step(name).quantity.inputs for s in motion.argument(n).symbols]
    found = function(*arrays)
    worst = 0.0
    for row, *point in zip(found.tolist(), *(a.tolist() for a in arrays), strict=True):
        known = dict(zip(symbols, map(mp.mpf, (x for v in point for x in v)), strict=True))
        truth = evaluate(motion.step(name).expression, known)
        worst = max(worst, *(float(abs(mp.mpf(x) - y)) for x, y in zip(row, truth, strict=True)))
    return worst / float(np.finfo(found.dtype).eps)


def ratios(motion, target, dtype, count: int) -> dict[str, float]:
    """Measured error over proved bound, for each function that has a bound."""
    module = load(motion.kernels(target))
    random = np.random.default_rng(6)
    found = {}
    for kernel in lower(motion).kernels:
        bound = rounding(kernel)
        if bound is None or not bound.error or kernel.name == "singularity_margin":
            continue
        arrays = [random.uniform(-1.0, 1.0, (count, len(a.components))) for a in kernel.arguments]
        if "q" in bound.of_any_size:
            arrays[0] *= 1e4
            special = SPECIAL[:: len(SPECIAL) // count, : arrays[0].shape[1]]
            arrays[0][::4] = special[: len(arrays[0][::4])]
        function = row_by_row(target, getattr(module, kernel.name))
        given = [array.astype(dtype) for array in arrays]
        found[kernel.name] = measured(motion, kernel.name, function, given) / bound.error
    return found


@pytest.mark.parametrize("rotation", ["ZXZ", "zyx", *PARAMETRISATIONS, *TURNS])
def test_measured_errors_are_within_the_bounds_over_the_catalogue(rotation):
    found = ratios(rs.derive(rotation), "numpy", np.float64, 8)
    assert all(ratio <= 1.0 for ratio in found.values()), found
