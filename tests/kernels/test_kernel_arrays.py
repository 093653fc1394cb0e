"""Generated NumPy functions and arrays: shapes, types, names, `out`, what is refused, memory."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tracemalloc
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier, Event

import dask.array as da
import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.target_modules import FEW, inputs as inputs_of, module, motion, one_by_one
from rigidsym.kernels.targets import TARGETS


def inputs(name: str, leading: tuple[int, ...] = (7,)) -> list[np.ndarray]:
    return inputs_of("ZXZ", name, leading)


def shape_of(name: str) -> tuple[int, ...]:
    return motion("ZXZ").step(name).shape


def read_only(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


@pytest.mark.parametrize("count", [6, 7, 79, 80, 119, 120, 239, 240, 4095, 4096])
@pytest.mark.parametrize("arrange", [np.ascontiguousarray, np.asfortranarray])
def test_every_way_to_compute_gives_the_same_within_rounding(count, arrange):
    """One by one, by sines or by tangents, of each angle or of all at once."""
    rows = [0, count // 2, count - 1]
    for name in FEW:
        arrays = [arrange(array) for array in inputs(name, (count,))]
        function = getattr(module(), name)
        expected = one_by_one(name, [a[rows] for a in arrays])
        found, out = function(*arrays), np.empty((count, *shape_of(name)))
        assert function(*arrays, out=out) is out
        assert_array_equal(out, found)
        assert_allclose(found[rows], expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("count", [1, 7, 150, 300])
def test_a_component_that_is_a_result_survives_an_out_that_overlaps(count):
    functions = rs.derive("z(phi)", ["angular_velocity_body"]).kernels().load()
    memory = np.random.default_rng(3).uniform(-3, 3, 3 * count)
    q, q_dot, out = np.zeros((count, 1)), memory[:count, np.newaxis], memory.reshape(count, 3)
    expected = functions.angular_velocity_body(q, q_dot.copy())
    assert_array_equal(functions.angular_velocity_body(q, q_dot, out=out), expected)


class Labelled(np.ndarray):
    """A subclass, as units and tables make them."""


def test_subclasses_and_arrays_without_masked_entries_are_plain_arrays():
    q = inputs("rotation_matrix", (4,))[0]
    expected = module().rotation_matrix(q)
    for given_as in (np.ma.masked_array(q, mask=False), q.view(Labelled)):
        found = module().rotation_matrix(given_as)
        assert type(found) is np.ndarray
        assert_array_equal(found, expected)


Q = np.zeros((5, 3))
LAST = "expected (..., 3), the last axis phi, theta, psi"
TYPES = "expected float64, float32 or integers"
RAGGED = [[1, 2, 3], [1]]
REFUSED = [
    (np.zeros((5, 4)), ValueError, f"q: got shape (5, 4); {LAST}"),
    (1.0, ValueError, f"q: got shape (); {LAST}"),
    ([], ValueError, f"q: got shape (0,); {LAST}"),
    (np.zeros((4, 3)), ValueError, "axes before the last do not broadcast: q (4, 3), q_dot (5, 3)"),
    (RAGGED, ValueError, f"q: not an array; {LAST}"),
    (Q.astype(np.float16), TypeError, f"q: got dtype float16; {TYPES}"),
    (Q.astype(np.longdouble), TypeError, f"q: got dtype {np.dtype(np.longdouble)}; {TYPES}"),
    (Q.astype(complex), TypeError, f"q: got dtype complex128; {TYPES}"),
    (Q.astype(bool), TypeError, f"q: got dtype bool; {TYPES}"),
    (Q.astype(object), TypeError, f"q: got dtype object; {TYPES}"),
    (None, TypeError, f"q: got dtype object; {TYPES}"),
    (["a", "b", "c"], TypeError, f"q: got dtype <U1; {TYPES}"),
    (Q.astype("m8[s]"), TypeError, f"q: got dtype timedelta64[s]; {TYPES}"),
]


@pytest.mark.parametrize(("q", "kind", "message"), REFUSED)
def test_arguments_that_are_refused(q, kind, message):
    with pytest.raises(kind) as caught:
        module().angular_velocity_body(q, Q)
    assert str(caught.value) == message


REFUSED_OUT = [
    ([0.0] * 3, TypeError, "out: got list; expected a NumPy array"),
    (np.zeros((5, 3), np.float32), TypeError, "out: got dtype float32; expected float64"),
    (np.zeros((5, 3), ">f8"), TypeError, "out: got dtype >f8; expected float64"),
    (np.zeros((3, 5)), ValueError, "out: got shape (3, 5); expected (5, 3)"),
    (np.zeros((1, 5, 3)), ValueError, "out: got shape (1, 5, 3); expected (5, 3)"),
    (read_only(np.zeros((5, 3))), ValueError, "out: the array is read-only"),
]


@pytest.mark.parametrize(("out", "kind", "message"), REFUSED_OUT)
def test_outs_that_are_refused(out, kind, message):
    with pytest.raises(kind) as caught:
        module().angular_velocity_body(Q, Q, out=out)
    assert str(caught.value) == message


def test_the_sign_of_zero_is_kept():
    q = np.array([-0.0, 0.3, 0.0])
    assert np.signbit(module().rotation_matrix(np.stack([q, q]))[0, 0, 2])


def test_the_error_state_of_the_caller_is_left_alone():
    with np.errstate(all="raise"):
        module().rotation_matrix(np.full((2, 3), np.inf))
        assert set(np.geterr().values()) == {"raise"}


def peak(call) -> int:
    """The most memory that a call held at one time, in bytes."""
    call()
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", FEW)
def test_memory_is_the_outputs_and_two_megabytes(name):
    arrays = inputs(name, (200_000,))
    size = getattr(module(), name)(*arrays).nbytes
    assert peak(lambda: getattr(module(), name)(*arrays)) <= size + 2e6


@pytest.mark.parametrize("threads", [0, -1, 1.5, None, "2"])
def test_threads_that_are_refused(threads):
    message = f"threads: got {threads!r}; expected a whole number from 1 up"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        module().rotation_matrix(Q, threads=threads)


def test_no_thread_is_at_work_when_others_have_failed(monkeypatch):
    pool, failing, done = ThreadPoolExecutor(2), Barrier(3), []
    monkeypatch.setattr(module(), "_pool", lambda: pool)

    def work(piece):
        failing.wait(timeout=10)  # each thread has one piece
        if piece == 2:
            Event().wait(0.2)
            done.append(piece)
        else:
            raise MemoryError(piece)

    with pytest.raises(MemoryError):
        module()._share(work, range(3), 3)
    assert done == [2]


FORKED = """
import os, warnings
import numpy as np
import {name} as m
warnings.simplefilter("ignore")  # newer Pythons warn of any fork beside threads
q = np.ones((30_000, 3))
expected = m.rotation_matrix(q)
assert (m.rotation_matrix(q, threads=2) == expected).all()
child = os.fork()
if not child:
    os._exit(0 if (m.rotation_matrix(q, threads=2) == expected).all() else 1)
assert os.waitpid(child, 0)[1] == 0
"""


AT_THE_END = """
import atexit
import numpy as np
import {name} as m
q = np.ones((30_000, 3))
expected = m.rotation_matrix(q, threads=2)
atexit.register(lambda: print((m.rotation_matrix(q, threads=2) == expected).all()))
"""


def test_threads_are_done_without_while_the_interpreter_ends(tmp_path):
    made = rs.derive("ZXZ", only=["rotation_matrix"]).kernels().write(tmp_path)
    code = AT_THE_END.format(name=made.stem)
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("True\n", "")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_has_threads_of_its_own(tmp_path):
    made = rs.derive("ZXZ", only=["rotation_matrix"]).kernels().write(tmp_path)
    code = FORKED.format(name=made.stem)
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=60)


# What a call of few rows costs is calls, of Python and of NumPy, since each takes as long as the
# arithmetic of a hundred rows. The time itself is in `benchmarks/run.py sizes`.
@pytest.mark.parametrize(
    ("leading", "most"), [((), 28), ((1,), 28), ((8,), 92), ((9,), 25), ((10,), 25), ((100,), 27)]
)
@pytest.mark.parametrize("name", FEW)
def test_few_rows_take_few_calls(name, leading, most):
    function, arrays = getattr(module(), name), inputs(name, leading)
    for options in ({}, {"out": function(*arrays)}):
        calls: list[str] = []
        sys.setprofile(lambda _, event, __, calls=calls: calls.append(event))
        try:
            function(*arrays, **options)
        finally:
            sys.setprofile(None)
        assert calls.count("call") + calls.count("c_call") <= most + len(options)


@pytest.fixture(scope="module")
def twenty_turns():
    return rs.derive(" ".join(f"{'zxy'[k % 3]}({'abcdefghijklmnopqrst'[k]}1)" for k in range(20)))


@pytest.mark.filterwarnings("error")
def test_twins_of_long_functions_agree_with_arrays_and_are_nan_where_these_are(twenty_turns):
    functions = twenty_turns.kernels().load()
    rates, twin = (
        getattr(functions, f"rates_from_angular_velocity_body{s}") for s in ("", "_scalar")
    )
    straight = [0.0, *[0.5 * np.pi, 0.0, 0.0] * 6, 0.0]
    anywhere = np.random.default_rng(5).uniform(-3, 3, 20).tolist()
    for q in (anywhere, [np.inf] * 20, straight, [np.nan, *[1.0] * 19]):
        expected = rates(np.array(q), np.array([1.0, 2.0, 3.0]))
        assert_allclose(twin(*q, 1.0, 2.0, 3.0), expected, rtol=1e-12, atol=1e-12)
    margin = functions.singularity_margin(np.ones((300, 20)))
    assert_allclose(margin, functions.singularity_margin_scalar(*[1.0] * 20), rtol=1e-13)


ORDER = ("roll", "pitch", "yaw")
ANGLES = np.array([[0.1, 0.2, 0.3], [-2.0, 0.5, 1.5]])  # in this order, which is not that of q
Attitude = namedtuple("Attitude", ORDER)

NAMED = {
    "pandas": lambda a: pd.DataFrame(a, columns=ORDER).assign(time=0.0),
    "row": lambda a: pd.DataFrame(a, columns=ORDER).iloc[1],
    "polars": lambda a: pl.DataFrame(a, schema=ORDER),
    "arrow": lambda a: pytest.importorskip("pyarrow").table(dict(zip(ORDER, a.T, strict=True))),
    "structured": lambda a: np.rec.fromarrays(a.T, names=ORDER),
    "xarray": lambda a: xr.DataArray(a, dims=("time", "angle"), coords={"angle": list(ORDER)}),
    "data set": lambda a: xr.Dataset(dict(zip(ORDER, [("t", c) for c in a.T], strict=True))),
    "mapping": lambda a: {"yaw": a[:, 2], "roll": a[:, 0], "pitch": a[:, 1]},
    "tuples": lambda a: [Attitude(*row) for row in a.tolist()],
}
UNNAMED = {
    "list": lambda a: a.tolist(),
    "numbered": pd.DataFrame,
    "dimension": lambda a: xr.DataArray(a, dims=("time", "angle")),
}


def kernels(target: str):
    return rs.kernels("z(yaw) y(pitch) x(roll)", target, only="rotation_matrix")


@pytest.mark.parametrize("form", NAMED)
@pytest.mark.parametrize("target", ["numpy", "numba", "c", "jax"])
def test_names_decide_and_not_the_order(target, form):
    if TARGETS[target].missing:
        pytest.skip(f"{target} is not installed")
    module = kernels(target)
    rows = ANGLES[1:] if form == "row" else ANGLES
    expected = module.rotation_matrix(rows[:, ::-1])
    found = module.rotation_matrix(NAMED[form](ANGLES))
    assert_allclose(found, expected.reshape(found.shape), rtol=0, atol=1e-6)  # JAX is in float32


@pytest.mark.parametrize("form", UNNAMED)
def test_columns_without_names_keep_their_order(form):
    matrix = kernels("numpy").rotation_matrix
    assert_array_equal(matrix(UNNAMED[form](ANGLES)), matrix(ANGLES))


@pytest.mark.parametrize("form", NAMED)
def test_other_names_are_refused(form):
    module = rs.kernels("ZYX", only="rotation_matrix")
    with pytest.raises(ValueError, match=r"q: the columns are named .*; expected each of phi, "):
        module.rotation_matrix(NAMED[form](ANGLES))


def test_dask_takes_the_signature():
    function, arrays = module().rotation_matrix, inputs_of("ZXZ", "rotation_matrix", (60,))
    chunked = [da.from_array(array, chunks=(30, 3)) for array in arrays]
    found = da.apply_gufunc(function, function.signature, *chunked, output_dtypes=float)
    assert_array_equal(found.compute(scheduler="sync"), function(*arrays))


def test_xarray_keeps_the_dimensions():
    q, q_dot = inputs_of("ZXZ", "angular_velocity_body", (60,))
    given = [
        xr.DataArray(q, dims=("time", "angle"), coords={"time": np.arange(60)}),
        xr.DataArray(q_dot, dims=("time", "rate")),
    ]
    cores = {"input_core_dims": [["angle"], ["rate"]], "output_core_dims": [["axis"]]}
    found = xr.apply_ufunc(module().angular_velocity_body, *given, **cores)
    assert found.dims == ("time", "axis")
    assert_array_equal(found, module().angular_velocity_body(q, q_dot))
