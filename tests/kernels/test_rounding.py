"""Bounds on rounding: by hand for single operations, and above what is measured at 50 digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rigidsym as rs
from helpers.errors_of_kernels import SPECIAL
from helpers.motions import derived
from helpers.witness import evaluate, mp
from rigidsym.kernels.ir import Argument, Assignment, Call, Kernel, Name, Number, Product, Sum
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.rounding import rounding

A, B, ONE, TENTH = Name("a"), Name("b"), Number(Fraction(1)), Number(Fraction(1, 10))


def kernel(*values) -> Kernel:
    """Assignments x0, x1, ... of two inputs; the last one is the output."""
    lines = tuple(Assignment(f"x{k}", value) for k, value in enumerate(values))
    q = Argument(name="q", components=("a", "b"), units=("", ""), about="")
    return Kernel(
        name="k", arguments=(q,), assignments=lines, outputs=(Name(lines[-1].name),), shape=()
    )


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ([Sum((A, B))], 1.0),  # half an eps of a sum of at most two
        ([Product((A, B))], 0.5),
        ([Sum((A, B, ONE))], 2.5),  # the error of a + b, and half an eps of three
        ([Product((A,), (Number(Fraction(2)),))], 0.5),
        ([TENTH], 0.05),  # the nearest double
        ([Call("sin", A)], 1.1),
        ([Call("sin", A), Product((Name("x0"), B))], 1.6),
        ([Sum((A, B)), Call("cos", Name("x0"))], 2.1),  # the angle's own error is passed on
    ],
)
def test_single_operations(values, error):
    found = rounding(kernel(*values)).error
    assert error < found <= error + 0.11


@pytest.mark.parametrize("value", [Product((A,), (B,)), Call("sqrt", A)])
def test_where_there_is_no_bound(value):
    assert rounding(kernel(value)) is None


def test_the_words_say_for_what_it_holds():
    assert str(rounding(kernel(Call("sin", A), Product((Name("x0"), B))))) == (
        "Bound on rounding: 1.7 eps in any entry, for components of q up to 1."
    )
    bounds = {k.name: str(rounding(k)) for k in lower(derived("ZXZ")).kernels}
    assert bounds["rotation_matrix"].endswith("eps in any entry, for angles q of any size.")
    assert bounds["angular_velocity_body"].endswith(
        "for angles q of any size; components of q_dot up to 1."
    )


def measured(motion, name: str, function, arrays) -> float:
    """The largest absolute error of an entry, in eps of the type."""
    symbols = [s for n in motion.step(name).quantity.inputs for s in motion.argument(n).symbols]
    found = function(*arrays).reshape(len(arrays[0]), -1)
    worst = 0.0
    for row, *point in zip(found.tolist(), *(a.tolist() for a in arrays), strict=True):
        known = dict(zip(symbols, map(mp.mpf, (x for v in point for x in v)), strict=True))
        truth = evaluate(motion.step(name).expression, known)
        worst = max(worst, *(float(abs(mp.mpf(x) - y)) for x, y in zip(row, truth, strict=True)))
    return worst / float(np.finfo(found.dtype).eps)


NAMES = ("rotation_matrix", "rotation_rate", "angular_velocity_space", "angular_velocity_body")


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("rotation", ["ZXZ", "zyx", "rotation_vector", "z(phi) [1,2,2](theta)"])
def test_what_is_measured_stays_below(rotation, dtype):
    motion = rs.derive(rotation)
    functions = motion.kernels().load()
    bounds = {kernel.name: rounding(kernel) for kernel in lower(motion).kernels}
    random = np.random.default_rng(6)
    count = len(motion.argument("q").symbols)
    size = 1.0 if rotation == "rotation_vector" else 1e4
    q = random.uniform(-size, size, (60, count))
    q = q if size == 1.0 else np.concatenate([q, SPECIAL[::30, :count]])
    for name in NAMES:
        rates = random.uniform(-1.0, 1.0, q.shape)
        arrays = [q, rates][: len(motion.step(name).quantity.inputs)]
        arrays = [array.astype(dtype) for array in arrays]
        error = measured(motion, name, getattr(functions, name), arrays)
        assert 0.2 < error < bounds[name].error, name
