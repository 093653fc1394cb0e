"""Generated NumPy functions and arrays: shapes, types, names, `out`, what is refused, memory."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import namedtuple
from importlib import import_module

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.motions import derived
from helpers.target_modules import INVERSES, module

Q = np.zeros((5, 3))
WRITE_PROTECTED = np.broadcast_to(Q, (5, 3))
LAST = "expected (..., 3), the last axis phi, theta, psi"
TYPES = "expected float64, float32 or integers"
REFUSED = [  # q, options, and the message
    (np.zeros((5, 4)), {}, f"q: got shape (5, 4); {LAST}"),
    (1.0, {}, f"q: got shape (); {LAST}"),
    (np.zeros((4, 3)), {}, "axes before the last do not broadcast: q (4, 3), q_dot (5, 3)"),
    ([[1, 2, 3], [1]], {}, f"q: not an array; {LAST}"),
    (Q.astype(np.float16), {}, f"q: got dtype float16; {TYPES}"),
    (Q.astype(complex), {}, f"q: got dtype complex128; {TYPES}"),
    (Q.astype(bool), {}, f"q: got dtype bool; {TYPES}"),
    (None, {}, f"q: got dtype object; {TYPES}"),
    (Q, {"out": [0.0] * 3}, "out: got list; expected a NumPy array"),
    (Q, {"out": Q.astype(np.float32)}, "out: got dtype float32; expected float64"),
    (Q, {"out": Q.astype(">f8")}, "out: got dtype >f8; expected float64"),
    (Q, {"out": np.zeros((1, 5, 3))}, "out: got shape (1, 5, 3); expected (5, 3)"),
    (Q, {"out": WRITE_PROTECTED}, "out: the array is read-only"),
    (Q, {"threads": 0}, "threads: got 0; expected a whole number from 1 up"),
    (Q, {"threads": "2"}, "threads: got '2'; expected a whole number from 1 up"),
]


@pytest.mark.parametrize(("q", "options", "message"), REFUSED)
def test_arguments_that_are_refused(q, options, message):
    with pytest.raises((TypeError, ValueError), match=f"^{re.escape(message)}$"):
        module().angular_velocity_body(q, Q, **options)


def test_the_sign_of_zero_and_the_error_state_of_the_caller_are_kept():
    q = np.array([-0.0, 0.3, 0.0])
    assert np.signbit(module().rotation_matrix(np.stack([q, q]))[0, 0, 2])
    with np.errstate(all="raise"):
        module().rotation_matrix(np.full((2, 3), np.inf))
        assert set(np.geterr().values()) == {"raise"}


def test_columns_of_the_caller_are_read_where_they_are_and_are_not_written():
    functions = derived("ZXZ").kernels(conversions=True).load()
    rows = np.random.default_rng(4).normal(size=(5000, 4))
    columns = np.asfortranarray(rows)
    q, omega = columns[:, :3], columns[:, 1:]
    cases = {"rotation_matrix": [q], INVERSES[2]: [q, omega], "from_quaternion": [columns]}
    for name, arrays in cases.items():
        function, twin = (getattr(functions, name + end) for end in ("", "_scalar"))
        found = function(*arrays)
        out = np.empty_like(found)
        assert function(*arrays, out=out) is out
        assert_array_equal(out, found)
        some = np.hstack(arrays)[::2499].tolist()
        expected = np.reshape([twin(*point) for point in some], found[::2499].shape)
        assert_allclose(found[::2499], expected, rtol=0, atol=1e-12)
    assert_array_equal(columns, rows)


def test_what_depends_on_one_row_for_all_orientations_is_computed_once_a_block():
    row, rows, sizes = np.arange(3.0), np.tile(np.arange(3.0), (30_000, 1)), []

    def block(q, q_dot):
        sizes.append(q_dot.size)
        return q

    assert_array_equal(module()._apply(block, None, (3,), None, 1, q=rows, q_dot=row), rows)
    assert (len(sizes) > 1, {*sizes}) == (True, {3})


ENDS = """
import atexit, os, warnings
import numpy as np
import {name} as m
warnings.simplefilter("ignore")  # newer Pythons warn of any fork beside threads
q = np.ones((30_000, 3))
expected = m.rotation_matrix(q)
assert (m.rotation_matrix(q, threads=2) == expected).all()
if hasattr(os, "fork"):
    child = os.fork()
    if not child:
        os._exit(0 if (m.rotation_matrix(q, threads=2) == expected).all() else 1)
    assert os.waitpid(child, 0)[1] == 0
atexit.register(lambda: print((m.rotation_matrix(q, threads=2) == expected).all()))
"""


def test_threads_work_in_a_forked_process_and_while_the_interpreter_ends(tmp_path):
    made = rs.derive("ZXZ", only=["rotation_matrix"]).kernels().write(tmp_path)
    command = [sys.executable, "-c", ENDS.format(name=made.stem)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("True\n", "")


@pytest.mark.filterwarnings("error")
def test_twins_of_long_functions_agree_with_arrays_and_are_nan_where_these_are():
    functions = rs.derive("z(a) x(b) y(c) z(d)").kernels().load()
    names = [f"rates_from_angular_velocity_body{end}" for end in ("", "_scalar")]
    rates, twin = (getattr(functions, name) for name in names)
    pole, anywhere = [0.0, 0.5 * np.pi, 0.5 * np.pi, 0.0], [0.3, -2.0, 1.1, 0.7]
    for q in (anywhere, [np.inf] * 4, pole, [np.nan, *[1.0] * 3]):
        expected = rates(np.array(q), np.array([1.0, 2.0, 3.0]))
        assert_allclose(twin(*q, 1.0, 2.0, 3.0), expected, rtol=1e-12, atol=1e-12)
    margin = functions.singularity_margin(np.ones((300, 4)))
    assert_allclose(margin, functions.singularity_margin_scalar(*[1.0] * 4), rtol=1e-13)
    assert "√(det W Wᵀ)" in functions.singularity_margin.__doc__


ORDER = ("roll", "pitch", "yaw")
ANGLES = np.array([[0.1, 0.2, 0.3], [-2.0, 0.5, 1.5]])  # in this order, which is not that of q
Attitude = namedtuple("Attitude", ORDER)

NAMED = {  # of packages of which each takes a second to import, in the process that needs it
    "pandas": lambda a: import_module("pandas").DataFrame(a, columns=ORDER).assign(time=0.0),
    "row": lambda a: import_module("pandas").DataFrame(a, columns=ORDER).iloc[1],
    "polars": lambda a: import_module("polars").DataFrame(a, schema=ORDER),
    "arrow": lambda a: pytest.importorskip("pyarrow").table(dict(zip(ORDER, a.T, strict=True))),
    "structured": lambda a: np.rec.fromarrays(a.T, names=ORDER),
    "xarray": lambda a: import_module("xarray").DataArray(
        a, {"angle": list(ORDER)}, ("time", "angle")
    ),
    "data set": lambda a: import_module("xarray").Dataset(
        {n: ("t", a[:, k]) for k, n in enumerate(ORDER)}
    ),
    "mapping": lambda a: {"yaw": a[:, 2], "roll": a[:, 0], "pitch": a[:, 1]},
    "tuples": lambda a: [Attitude(*row) for row in a.tolist()],
}


@pytest.mark.parametrize("form", NAMED)
def test_names_decide_and_not_the_order(form):
    named = rs.kernels("z(yaw) y(pitch) x(roll)", only="rotation_matrix").rotation_matrix
    expected = named((ANGLES[1:] if form == "row" else ANGLES)[:, ::-1])
    found = named(NAMED[form](ANGLES))
    assert_array_equal(found, expected.reshape(found.shape))
    with pytest.raises(ValueError, match=r"q: the columns are named .*; expected each of phi, "):
        module().rotation_matrix(NAMED[form](ANGLES))
