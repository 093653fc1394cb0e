"""Tables, Dask and xarray: columns with names are taken by their names, wherever they are."""

from __future__ import annotations

from collections import namedtuple

import dask.array as da
import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import rigidsym as rs
from helpers.target_modules import inputs, module
from rigidsym.kernels.targets import TARGETS

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


def test_two_columns_of_one_name_are_refused():
    table = pd.DataFrame(np.zeros((2, 4)), columns=[*ORDER, "roll"])
    with pytest.raises(ValueError, match="expected each of yaw, pitch, roll once"):
        kernels("numpy").rotation_matrix(table)


def test_dask_takes_the_signature():
    function, arrays = module().rotation_matrix, inputs("ZXZ", "rotation_matrix", (60,))
    chunked = [da.from_array(array, chunks=(30, 3)) for array in arrays]
    found = da.apply_gufunc(function, function.signature, *chunked, output_dtypes=float)
    assert_array_equal(found.compute(scheduler="sync"), function(*arrays))


def test_xarray_keeps_the_dimensions():
    q, q_dot = inputs("ZXZ", "angular_velocity_body", (60,))
    given = [
        xr.DataArray(q, dims=("time", "angle"), coords={"time": np.arange(60)}),
        xr.DataArray(q_dot, dims=("time", "rate")),
    ]
    cores = {"input_core_dims": [["angle"], ["rate"]], "output_core_dims": [["axis"]]}
    found = xr.apply_ufunc(module().angular_velocity_body, *given, **cores)
    assert found.dims == ("time", "axis")
    assert_array_equal(found, module().angular_velocity_body(q, q_dot))
