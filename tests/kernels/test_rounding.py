"""Bounds on rounding: by hand for single operations, and above what is measured at 50 digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rigidsym as rs
from benchmarks.bounds import CHAINS, PUBLISHED, bounded_kernels, gappa_bound, rigid_body
from helpers.motions import derived
from helpers.target_modules import exact, row_by_row, worst_error
from helpers.witness import mp
from rigidsym.kernels.ir import Assignment, Call, Kernel, KernelArgument, Name, Number, Product, Sum
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.rounding import Bounded, largest_error, rounding
from rigidsym.kernels.targets.precision import DOUBLE, numbers
from rigidsym.models.library import PARAMETRISATIONS

A, B, ONE, TENTH = Name("a"), Name("b"), Number(Fraction(1)), Number(Fraction(1, 10))


def kernel(*values) -> Kernel:
    """Assignments x0, x1, ... of two inputs; the last one is the output."""
    lines = tuple(Assignment(f"x{k}", value) for k, value in enumerate(values))
    q = KernelArgument(name="q", components=("a", "b"), units=("", ""), about="", shape=(2,))
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
    bound = rounding(kernel(*values)).error
    assert error < bound <= error + 0.11


def test_a_bound_names_the_arguments_it_holds_for_and_quotients_have_none():
    assert rounding(kernel(Call("sin", A), Product((Name("x0"), B)))) == (1.4, (), ("q",))
    bounds = {k.name: rounding(k) for k in lower(derived("ZXZ")).kernels}
    assert bounds["rotation_matrix"][1:] == (("q",), ())
    assert bounds["angular_velocity_body"][1:] == (("q",), ("q_dot",))
    for value in (Product((A,), (B,)), Call("sqrt", A)):
        assert rounding(kernel(value)) is None


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


@pytest.mark.parametrize("rotation", ["ZXZ", "zyx", *PARAMETRISATIONS, *CHAINS])
def test_measured_errors_are_within_the_bounds(rotation):
    motion, random = rs.derive(rotation), np.random.default_rng(6)
    module = motion.kernels("numpy").load()
    for kernel in lower(motion).kernels:
        bound = rounding(kernel)
        if bound is None or not bound.error or kernel.name == "singularity_margin":
            continue
        arrays = [random.uniform(-1.0, 1.0, (8, len(a.components))) for a in kernel.arguments]
        if "q" in bound.of_any_size:
            arrays[0] *= 1e4
            arrays[0][::4] = np.pi * np.array([[-1], [0.25]])
        rows = row_by_row("numpy", getattr(module, kernel.name))(*arrays)
        truth = exact(motion, kernel.name, arrays)
        assert worst_error(rows, truth, np.ones(len(rows))) <= bound.error, kernel.name


def test_the_angle_of_a_point_is_within_one_and_a_half_eps():
    """In all octants and sizes, on the axes and diagonals, and where the formula changes."""
    pytest.importorskip("numba")
    angle_of = rs.derive("ZXZ").kernels("numba", conversions=True).load()._angle_of
    random = np.random.default_rng(3)
    points = random.normal(size=(1000, 2)) * 10.0 ** random.uniform(-15, 15, size=(1000, 2))
    edge = float(numbers(DOUBLE)["edge"]) * (1 + np.linspace(-1e-7, 1e-7, 41))
    for near in np.concatenate([np.linspace(0, 1, 200), edge]):
        points = np.append(points, [[near, 1], [1, near], [-near, -1]], axis=0)
    for y, x in points.tolist():
        exact = mp.atan2(mp.mpf(y), mp.mpf(x))
        assert abs(mp.mpf(angle_of(y, x)) - exact) <= 1.5 * 2.0**-52 * abs(exact)
