"""Kernels on arrays that are computed chunk by chunk: Dask's, xarray's, and joblib's parts."""

import pickle
import shutil

import numpy as np
import pytest
from exports import two_link

import moro_codegen as mc

da = pytest.importorskip("dask.array", reason="dask is not installed")
dask = pytest.importorskip("dask")
cloudpickle = pytest.importorskip("cloudpickle")

FUNCTIONS = ("tau", "tau_derivatives", "potential_energy")
X = np.random.default_rng(0).normal(size=(3, 1000, 2))


@pytest.fixture(scope="module", params=["c", "numpy"])
def kernel(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("kernel")
    return mc.compile(two_link(payload=0.5), FUNCTIONS, folder, request.param)


@pytest.fixture
def lazy():
    return [da.from_array(x, chunks=(300, 2)) for x in X]


@pytest.fixture(autouse=True)
def in_this_thread():
    with dask.config.set({"scheduler": "synchronous", "multiprocessing.context": "fork"}):
        yield


def same(lazy, expected):
    return np.array_equal(lazy.compute(), expected)


@pytest.mark.parametrize("scheduler", ["synchronous", "threads", "processes"])
def test_results_are_lazy_and_those_of_numpy(kernel, lazy, scheduler):
    tau = kernel.tau(*lazy)
    assert isinstance(tau, da.Array)
    assert (tau.shape, tau.dtype, tau.chunks[0]) == ((1000, 2), "float64", (300, 300, 300, 100))
    assert np.array_equal(tau.compute(scheduler=scheduler), kernel.tau(*X))


def test_several_results_and_scalars(kernel, lazy):
    for found, expected in zip(
        kernel.tau_derivatives(*lazy), kernel.tau_derivatives(*X), strict=True
    ):
        assert found.shape == (1000, 2, 2)
        assert same(found, expected)
    assert same(kernel.potential_energy(lazy[0]), kernel.potential_energy(X[0]))
    assert kernel.potential_energy(lazy[0][0]).compute() == kernel.potential_energy(X[0, 0])


def test_chunks_are_brought_together(kernel, lazy):
    q, qd, _ = lazy
    expected = kernel.tau(*X)
    assert same(kernel.tau(q.rechunk((200, 1)), qd, X[2]), expected)
    assert same(kernel.tau(q, qd, qdd=X[2].tolist(), threads=2), expected)
    assert same(kernel.tau(q, [0, 0], [1, 2]), kernel.tau(X[0], [0, 0], [1, 2]))
    known = X[0][X[0, :, 0] > 0]
    some = q[q[:, 0] > 0]  # of which Dask does not know how many
    assert same(kernel.tau(some, some, [0, 0]), kernel.tau(known, known, [0, 0]))


def test_parameters(kernel, lazy):
    payloads = np.linspace(0, 1, 1000)
    expected = kernel.tau(*X, {"payload": payloads})
    many = da.from_array(payloads, chunks=100)
    assert same(kernel.tau(*lazy, {"payload": many}), expected)
    assert same(kernel.tau(*X, many[:, None]), expected)


def test_what_is_wrong_is_said_at_once(kernel, lazy):
    q, qd, qdd = lazy
    with pytest.raises(ValueError, match=r"q \(joint positions\) must have shape \(2,\)"):
        kernel.tau(q[:, :1], qd, qdd)
    with pytest.raises(ValueError, match="the axes in front of the components do not match"):
        kernel.tau(q, qd[:5], qdd)
    with pytest.raises(TypeError, match="q must hold real numbers, found complex128"):
        kernel.tau(q * 1j, qd, qdd)
    with pytest.raises(TypeError, match="leave out= out"):
        kernel.tau(q, qd, qdd, out=np.empty((1000, 2)))


def test_dask_learns_what_is_returned(kernel, lazy):
    """It tries functions on arrays of one component or none, which are no states otherwise."""
    expected = kernel.tau(*X)
    for tau in (
        da.map_blocks(kernel.tau, *lazy),
        da.apply_gufunc(kernel.tau, "(i),(i),(i)->(i)", *lazy),
        da.blockwise(kernel.tau, "ti", *(y for x in lazy for y in (x, "ti"))),
    ):
        assert tau.dtype == "float64"
        assert same(tau, expected)
    for none in (np.empty((0, 0)), np.zeros((1, 1))):
        with pytest.raises(ValueError, match="must have shape"):
            kernel.tau(none, none, none)


def test_tasks_are_planned_without_a_kernel(kernel, lazy, tmp_path, monkeypatch):
    """Schedulers unpickle them, who may have no compiler."""
    shutil.copytree(kernel.directory, tmp_path / "two_link")
    moved = mc.Kernel(tmp_path / "two_link")
    sent = cloudpickle.dumps(moved.tau(*lazy))
    shutil.rmtree(moved.directory)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    again = pickle.loads(cloudpickle.dumps(pickle.loads(sent)))  # noqa: S301
    assert not (tmp_path / "cache").exists()
    assert same(again, kernel.tau(*X))
    assert (tmp_path / "cache").exists()


def test_a_module_that_was_emitted(tmp_path, lazy, monkeypatch):
    mc.export(two_link("plain"), tmp_path, targets=("python",))
    monkeypatch.syspath_prepend(str(tmp_path / "python"))
    import plain

    assert np.array_equal(plain.tau(*lazy).compute(scheduler="processes"), plain.tau(*X))


@pytest.mark.parametrize("how", ["parallelized", "allowed"])
def test_named_dimensions(kernel, lazy, how):
    xr = pytest.importorskip("xarray", reason="xarray is not installed")
    q, qd, qdd = (xr.DataArray(x, dims=("time", "joint")) for x in lazy)
    apart = q.transpose("joint", "time")
    core = [["joint"]]
    tau = xr.apply_ufunc(
        kernel.tau, apart, qd, qdd, input_core_dims=core * 3, output_core_dims=core, dask=how
    )
    assert isinstance(tau.data, da.Array)
    assert tau.dims == ("time", "joint")
    assert np.array_equal(tau, kernel.tau(*X))


def test_parts_in_processes_of_joblib(kernel):
    joblib = pytest.importorskip("joblib", reason="joblib is not installed")
    parts = np.array_split(X, 3, axis=1)
    work = (joblib.delayed(kernel.tau)(*part) for part in parts)
    taus = joblib.Parallel(n_jobs=2, max_nbytes=1)(work)  # which shares arrays as files
    assert np.array_equal(np.concatenate(taus), kernel.tau(*X))
