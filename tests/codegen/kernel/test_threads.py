"""threads=: large batches over several cores, to the last bit what one thread computes."""

import multiprocessing
import os
import threading
import time

import numpy as np
import pytest
from arms import reference_model
from programs import everything_program

from moro_codegen import calls
from moro_codegen.calls import in_threads
from moro_codegen.pipeline import build
from moro_codegen.program import generate


@pytest.fixture(scope="module", params=["c", "numpy"])
def arm(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("puma560") / "puma560"
    return build(generate(reference_model("puma560")), folder, request.param)


@pytest.fixture
def small_parts(monkeypatch):
    """Let every batch, however small, be divided."""
    monkeypatch.setattr(calls, "WORTHWHILE", 1)


def states(*shape, seed=0):
    return np.random.default_rng(seed).uniform(-2, 2, (3, *shape, 6))


@pytest.mark.usefixtures("small_parts")
@pytest.mark.parametrize("threads", [1, 2, 3, 7])
@pytest.mark.parametrize("shape", [(), (0,), (1,), (2,), (9,), (61,), (3, 20), (40, 2), (2, 0, 5)])
def test_the_same_bits(arm, threads, shape):
    given = states(*shape)
    expected = arm.tau(*given)
    assert np.array_equal(arm.tau(*given, threads=threads), expected)
    out = np.empty((*reversed(shape), 6)).transpose(*range(len(shape) - 1, -1, -1), len(shape))
    assert arm.tau(*given, out=out, threads=threads) is out
    assert np.array_equal(out, expected)


@pytest.mark.usefixtures("small_parts")
def test_broadcast_inputs_and_several_results(tmp_path, arm):
    q, qd, qdd = states(30, 4)
    expected = arm.tau(q, qd[:, :1], qdd[0, 0])
    assert np.array_equal(arm.tau(q, qd[:, :1], qdd[0, 0], threads=4), expected)
    kernel = build(everything_program(), tmp_path / "all_ops")
    given = q[..., :3], qd[..., :3], {"offset": q[:, 0, 0, None]}
    for one, several in zip(
        kernel.everything(*given), kernel.everything(*given, threads=3), strict=True
    ):
        assert np.array_equal(one, several)


@pytest.mark.usefixtures("small_parts")
def test_many_threads_call_one_kernel(arm):
    """Each of them divides its batch among threads, too."""
    given = states(60)
    expected = arm.tau(*given)
    found = []
    callers = [
        threading.Thread(target=lambda: found.extend(arm.tau(*given, threads=3) for _ in range(10)))
        for _ in range(5)
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(found) == 50
    assert all(np.array_equal(tau, expected) for tau in found)


def test_small_batches_stay_in_one_thread(arm, monkeypatch):
    asked = []
    monkeypatch.setattr(calls, "in_threads", lambda *a: (asked.append(a[-1]), in_threads(*a)))
    operations = sum(arm.ops["tau"].values())
    for samples in (
        1,
        calls.WORTHWHILE // operations,
        2 * calls.WORTHWHILE // operations + 2,
    ):
        arm.tau(np.zeros((samples, 6)), np.zeros(6), np.zeros(6), threads=8)
    assert asked[:2] == [0, 0]
    assert asked[2] == 2


def test_every_part_in_a_thread_of_its_own():
    """All parts are at work at the same time: none would pass the barrier alone."""
    barrier = threading.Barrier(4, timeout=30)
    names = []

    def run(inputs, results):
        barrier.wait()
        names.append(threading.current_thread().name)
        results[0][...] = 2 * inputs[0]

    x, y = np.arange(10.0), np.empty(10)
    in_threads(run, [x], [y], (10,), 4)
    assert np.array_equal(y, 2 * x)
    assert len(set(names)) == 4


def test_errors_of_any_part_come_back():
    def run(inputs, results):
        if inputs[0][-1] == 9:
            raise OSError("the last part")

    with pytest.raises(OSError, match="the last part"):
        in_threads(run, [np.arange(10.0)], [np.empty(10)], (10,), 3)


def test_the_interpreter_goes_on_during_a_batch(tmp_path):
    """The lock is not held: another thread runs Python code while C computes."""
    kernel = build(generate(reference_model("puma560")), tmp_path / "puma560")
    given, out = states(1_000_000), np.empty((1_000_000, 6))
    times = []

    def batch():
        start = time.perf_counter()
        kernel.tau(*given, out=out)
        times.extend([start, time.perf_counter()])

    worker = threading.Thread(target=batch)
    worker.start()
    ticks = []
    while worker.is_alive():
        ticks.append(time.perf_counter())
    start, end = times
    margin = (end - start) / 5
    assert any(start + margin < tick < end - margin for tick in ticks)


def _in_a_child(given, kernel, answer):
    answer.put(kernel.tau(*given, threads=2))


@pytest.mark.usefixtures("small_parts")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
def test_after_a_fork(arm):
    """The child has no thread of its parent's, and starts others."""
    given = states(50)
    expected = arm.tau(*given, threads=2)
    fork = multiprocessing.get_context("fork")
    answer = fork.Queue()
    child = fork.Process(target=_in_a_child, args=(given, arm, answer))
    child.start()
    try:
        assert np.array_equal(answer.get(timeout=30), expected)
    finally:
        child.join(10)


@pytest.mark.parametrize(
    ("threads", "error", "message"),
    [
        (0, ValueError, "threads must be at least 1, not 0"),
        (-2, ValueError, "threads must be at least 1, not -2"),
        (1.5, TypeError, "threads must be an integer, not 1.5"),
        ("two", TypeError, "threads must be an integer, not 'two'"),
        (None, TypeError, "threads must be an integer, not None"),
    ],
)
def test_counts_refused(arm, threads, error, message):
    with pytest.raises(error, match=message):
        arm.tau(*states(3), threads=threads)
