"""Generated functions inside Dask and xarray, as they are."""

from __future__ import annotations

import pickle
from functools import cache
from types import ModuleType

import dask.array as da
import numpy as np
import pytest
import xarray as xr
from distributed import Client, LocalCluster
from numpy.testing import assert_allclose, assert_array_equal

from helpers.kernel_modules import inputs
from helpers.motions import derived
from rigidsym.kernels.targets import TARGETS

ARRAYS = [
    pytest.param(name, marks=pytest.mark.skipif(bool(TARGETS[name].missing), reason="not here"))
    for name in ("numpy", "c", "numba", "jax")
]


@cache
def of(target: str) -> ModuleType:
    return (
        derived("ZXZ").select(["angular_velocity_body", "rotation_matrix"]).kernels(target).load()
    )


@pytest.mark.parametrize("target", ARRAYS)
def test_apply_gufunc_takes_the_signature(target):
    name = "rotation_matrix"
    arrays = inputs(name, (60,))
    function = getattr(of(target), name)
    chunked = [da.from_array(array, chunks=(30, 3)) for array in arrays]
    found = da.apply_gufunc(function, function.signature, *chunked, output_dtypes=float)
    assert_allclose(found.compute(scheduler="threads"), function(*arrays), rtol=0, atol=1e-5)


def test_apply_gufunc_gives_value_and_jacobian():
    asked = {"angular_velocity_body": "q"}
    function = derived("ZXZ").kernels(derivatives=asked).load().angular_velocity_body_jacobian_q
    arrays = inputs("angular_velocity_body", (50,))
    chunked = [da.from_array(array, chunks=(20, 3)) for array in arrays]
    both = da.apply_gufunc(function, function.signature, *chunked, output_dtypes=(float, float))
    for found, expected in zip(both, function(*arrays), strict=True):
        assert_array_equal(found.compute(scheduler="sync"), expected)


@pytest.mark.parametrize("target", ARRAYS)
@pytest.mark.parametrize("is_chunked", [False, True])
def test_apply_ufunc_keeps_the_dimensions(is_chunked, target):
    q, q_dot = inputs("angular_velocity_body", (60,))
    function = of(target).angular_velocity_body
    given = [
        xr.DataArray(q, dims=("time", "angle"), coords={"time": np.arange(60)}),
        xr.DataArray(q_dot, dims=("time", "rate")),
    ]
    found = xr.apply_ufunc(
        function,
        *([array.chunk(time=30) for array in given] if is_chunked else given),
        input_core_dims=[["angle"], ["rate"]],
        output_core_dims=[["axis"]],
        dask="parallelized",
        output_dtypes=[float],
        dask_gufunc_kwargs={"output_sizes": {"axis": 3}},
    )
    assert found.dims == ("time", "axis")
    assert_allclose(found.compute(), function(q, q_dot), rtol=0, atol=1e-5)  # JAX is in float32


def test_two_workers_of_a_cluster_share_the_chunks(tmp_path, monkeypatch):
    """A written module goes to the workers by its name, as pickle sends it."""
    path = derived("ZYX").kernels().write(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    functions = __import__(path.stem)
    matrix = functions.rotation_matrix
    assert pickle.loads(pickle.dumps(matrix)) is matrix
    q = inputs("rotation_matrix", (1000,))[0]
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path
        ) as cluster,
        Client(cluster) as client,
    ):
        client.upload_file(str(path))
        chunked = da.from_array(q, chunks=(100, 3))
        found = da.apply_gufunc(matrix, matrix.signature, chunked, output_dtypes=float)
        # the last bit of a kernel may depend on the number of rows
        expected = np.concatenate([matrix(q[k : k + 100]) for k in range(0, 1000, 100)])
        assert_array_equal(found.compute(), expected)
        assert len(client.scheduler_info()["workers"]) == 2
