"""Throughput of kernels on trajectories in Zarr, from file to file: one loop, and Dask.

    python -m benchmarks.out_of_core [SAMPLES]

States of the PUMA 560, uncompressed, in chunks of 100 000 samples, in the system's folder for
temporary files. Writes out_of_core.json into benchmarks/results, in samples per second: the best
of three runs, start of processes not included.
"""

import argparse
import json
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import dask
import dask.array as da
import distributed
import numpy as np
import zarr

import moro
from benchmarks.machine import provenance
from moro_codegen import Kernel, compile

RESULTS = Path(__file__).parent / "results"
FUNCTIONS = ("tau", "forward_dynamics")
INPUTS = ("x0", "x1", "x2")
CHUNK, RUNS = 100_000, 3


def write_library(samples: int) -> None:
    """Write three inputs of random states."""
    rng = np.random.default_rng(0)
    for name in INPUTS:
        array = new(f"{name}.zarr", samples)
        for start in range(0, samples, CHUNK):
            array[start : start + CHUNK] = rng.uniform(-3, 3, (min(CHUNK, samples - start), 6))


def new(path: str, samples: int) -> zarr.Array:
    """Return an array on disk for as many vectors."""
    return zarr.create_array(
        path, shape=(samples, 6), chunks=(CHUNK, 6), dtype="f8", compressors=None, overwrite=True
    )


def in_a_loop(kernel: Kernel, function: str) -> None:
    """Read, compute and write chunk after chunk."""
    arrays = [zarr.open_array(f"{name}.zarr") for name in INPUTS]
    result = new("result.zarr", arrays[0].shape[0])
    for start in range(0, result.shape[0], CHUNK):
        part = slice(start, start + CHUNK)
        result[part] = getattr(kernel, function)(*(x[part] for x in arrays))


def by_dask(kernel: Kernel, function: str) -> None:
    """Let Dask do it, with the scheduler that is set."""
    arrays = [da.from_zarr(f"{name}.zarr") for name in INPUTS]
    da.store(getattr(kernel, function)(*arrays), new("result.zarr", arrays[0].shape[0]), lock=False)


@contextmanager
def cluster(cores: int) -> Iterator[None]:
    """Start a worker for each core."""
    options = {"threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(n_workers=cores, **options) as workers,
        distributed.Client(workers),
    ):
        yield


def best(run: Callable[[Kernel, str], None], kernel: Kernel, function: str) -> float:
    """Return the seconds of the fastest run, after one that does not count."""
    run(kernel, function)
    seconds = []
    for _ in range(RUNS):
        start = time.perf_counter()
        run(kernel, function)
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def main() -> None:
    """Measure, and write down."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("samples", nargs="?", type=int, default=2_000_000)
    samples, cores = parser.parse_args().samples, os.cpu_count() or 1
    load = os.getloadavg()[0]  # of others
    kernel = compile(moro.load("puma560"), functions=FUNCTIONS)
    ways = {
        "a loop over chunks, one thread": (in_a_loop, lambda: dask.config.set({})),
        "Dask, threads": (by_dask, lambda: dask.config.set(scheduler="threads")),
        f"Dask, LocalCluster of {cores} processes": (by_dask, lambda: cluster(cores)),
    }
    rates: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        write_library(samples)
        for way, (run, setting) in ways.items():
            with setting():
                rates[way] = {f: samples / best(run, kernel, f) for f in FUNCTIONS}
            print(way, {f: f"{rate:.3g}/s" for f, rate in rates[way].items()})
        os.chdir("/")
    versions = {module.__name__: module.__version__ for module in (dask, distributed, zarr)}
    found = {**provenance(versions, {}), "load": load, "samples": samples, "rates": rates}
    text = json.dumps(found, indent=1) + "\n"
    (RESULTS / "out_of_core.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
