"""Torques of trajectories that do not fit into memory, from Zarr to Zarr."""

import sys
from pathlib import Path

import pytest
from exports import python

PROGRAM = Path(__file__).parents[2] / "support/out_of_core.py"


@pytest.mark.sweep
@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory hold on Linux only")
def test_from_zarr_to_zarr(tmp_path):
    for name in ("zarr", "dask", "distributed"):
        pytest.importorskip(name, reason=f"{name} is not installed")
    python(PROGRAM, cwd=tmp_path, XDG_CACHE_HOME=str(tmp_path / "cache"))
