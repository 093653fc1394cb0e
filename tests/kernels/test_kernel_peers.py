"""Generated functions inside Dask and xarray, as they are."""

from __future__ import annotations

import dask.array as da
import numpy as np
import xarray as xr
from numpy.testing import assert_array_equal

from helpers.target_modules import inputs, module


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
