"""Torques of trajectories that do not fit into memory: a program that a test runs in its folder."""

import pickle
import resource
import shutil
from pathlib import Path

import dask.array as da
import numpy as np
import pytest
import zarr
from distributed import Client, LocalCluster

import moro
import moro_codegen as mc

NAMES, SAMPLES, CHUNK = ("q", "qd", "qdd"), 4_000_000, 200_000


def write():
    """Three arrays of 64 MB: the first chunk and the last are there, the others are their fill."""
    rng = np.random.default_rng(0)
    for k, name in enumerate(NAMES):
        array = zarr.create_array(
            "library.zarr",
            name=name,
            shape=(SAMPLES, 2),
            chunks=(CHUNK, 2),
            dtype="f8",
            fill_value=0.1 * (k + 1),
            compressors=None,
        )
        array[:CHUNK], array[-9:] = rng.normal(size=(CHUNK, 2)), rng.normal(size=(9, 2))


def library():
    return [da.from_zarr("library.zarr", component=name) for name in NAMES]


def check(path, kernel, count):
    """Compare the ends, where states differ, and the middle, where they do not."""
    tau, states = zarr.open_array(path), [zarr.open_array("library.zarr", path=n) for n in NAMES]
    assert tau.shape == (count, 2), tau.shape
    for part in (slice(0, CHUNK, 97), slice(count // 2, count // 2 + 5), slice(count - 9, count)):
        assert np.array_equal(tau[part], kernel.tau(*(x[part] for x in states)))


def in_little_memory(kernel):
    """Threads get through with 100 MB more than the process has; a single result does not."""
    status = Path("/proc/self/status").read_text()
    now = 1024 * int(status.split("VmData:")[1].split()[0])
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (now + 100_000_000, most))
    da.to_zarr(kernel.tau(*library()), "torques.zarr")
    with pytest.raises(MemoryError):
        kernel.tau(*(x.compute() for x in library()))
    resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def in_a_cluster(kernel):
    """The worker finds no folder of the kernel: it builds one, once for all of its tasks."""
    some = [x[:1_000_000] for x in library()]
    tau = kernel.tau(*some)
    pickle.dumps(kernel)  # which has its texts from here on
    shutil.rmtree(kernel.directory)
    options = {"threads_per_worker": 2, "dashboard_address": None, "memory_limit": None}
    with LocalCluster(n_workers=1, **options) as cluster, Client(cluster):
        da.to_zarr(tau, "by_workers.zarr")
    assert len(list(Path("cache/moro/kernels").glob("two_link-*"))) == 1


if __name__ == "__main__":
    write()
    kernel = mc.compile(moro.load("two_link"), directory="kernels")
    in_little_memory(kernel)
    check("torques.zarr", kernel, SAMPLES)
    in_a_cluster(kernel)
    check("by_workers.zarr", kernel, 1_000_000)
