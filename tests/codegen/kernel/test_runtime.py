"""Calls of compiled kernels: straight ones, batches of every layout, and what is refused."""

import shutil
import warnings

import numpy as np
import pytest
from arms import random_model, reference_states
from calls import one_by_one, states
from programs import evaluate, everything_program

from moro_codegen.pipeline import build
from moro_codegen.program import generate

SIZES = range(101)


# -- numbers -----------------------------------------------------------------------------------


def test_reference(arm):
    for s in reference_states("puma560"):
        tau = arm.tau(s["q"], s["qd"], s["qdd"])
        assert np.abs(tau - s["tau"]).max() < 1e-12 * np.abs(s["tau"]).max()


@pytest.mark.parametrize("n", SIZES)
def test_batches_are_single_calls_to_the_last_bit(compiled, n):
    q, qd, qdd = states(n, seed=n)
    tau = compiled.tau(q, qd, qdd)
    assert tau.shape == (n, 6)
    assert np.array_equal(tau, one_by_one(compiled.tau, q, qd, qdd))


@pytest.mark.parametrize("compiler", [c for c in ("gcc", "clang") if shutil.which(c)])
@pytest.mark.parametrize("seed", range(3))
def test_random_arms(tmp_path, monkeypatch, compiler, seed):
    """Single calls, batches and the graph, of arms of every kind, by every compiler at hand."""
    monkeypatch.setenv("CC", compiler)
    rng = np.random.default_rng(seed)
    program = generate(random_model(rng, int(rng.integers(2, 8)), tree=seed == 2))
    kernel = build(program, tmp_path / "arm")
    q, qd, qdd = rng.uniform(-3, 3, (3, 60, program.dof))
    qd[::5] = 0
    tau = kernel.tau(q, qd, qdd)
    single = [kernel.tau(*rows) for rows in zip(q, qd, qdd, strict=True)]
    assert np.array_equal(tau, single)
    (expected,) = evaluate(program.routines[0], q, qd, qdd)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    assert np.abs((tau - expected) / scale).max() < 1e-13


def test_the_same_as_numpy_on_the_same_graph(hand_made):
    (routine,) = everything_program().routines
    rng = np.random.default_rng(3)
    q, qd = rng.uniform(-2, 2, (2, 50, 3))
    parameters = rng.uniform(0.5, 2, (50, 2))
    expected = evaluate(routine, q, qd, parameters=parameters)
    results = hand_made.everything(q, qd, parameters=parameters)
    assert [r.shape for r in results] == [(50, 2, 3), (50, 3), (50,)]
    for result, right in zip(results, expected, strict=True):
        assert np.abs(result - right).max() < 1e-13 * max(1, np.abs(right).max())
    for k in range(50):
        single = hand_made.everything(q[k], qd[k], parameters=parameters[k])
        for result, right in zip(single, results, strict=True):
            assert np.array_equal(result, right[k])


def test_coulomb_friction_at_rest_and_both_ways(arm):
    zero = np.zeros(6)
    q = np.full(6, 0.3)
    for qd in (zero, -zero):
        rest = arm.tau(q, qd, zero)
        there, back = (arm.tau(q, direction * 1e-300 * np.ones(6), zero) for direction in (1, -1))
        assert np.all(there > rest)
        assert np.all(back < rest)
        assert np.all(there - rest != rest - back)


def test_not_a_number_and_infinity_without_warnings(arm):
    q, qd, qdd = states(21, seed=4)
    q[3, 2], qd[7, 1], qdd[20, 5] = np.nan, np.nan, np.nan
    q[9, 1], qd[11, 2] = np.inf, -np.inf
    bad = [3, 7, 9, 11, 20]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tau = arm.tau(q, qd, qdd)
        single = one_by_one(arm.tau, q, qd, qdd)
    assert np.array_equal(tau, single, equal_nan=True)
    for k in range(21):
        assert np.isnan(tau[k]).any() == (k in bad)
    assert np.isnan(tau[9, 1])


def test_huge_angles(arm):
    q, qd, qdd = states(11, seed=5)
    shifted = q.copy()
    shifted[4] = [1e6, -1e9, 1e15, 2e5, 1e300, -1e22]
    tau = arm.tau(shifted, qd, qdd)
    assert np.array_equal(tau, one_by_one(arm.tau, shifted, qd, qdd))
    assert np.array_equal(np.delete(tau, 4, 0), np.delete(arm.tau(q, qd, qdd), 4, 0))
    turned = np.arctan2(np.sin(shifted[4]), np.cos(shifted[4]))
    expected = arm.tau(turned, qd[4], qdd[4])
    assert np.abs(tau[4] - expected).max() < 1e-13 * np.abs(expected).max()


# -- layouts -----------------------------------------------------------------------------------


LAYOUTS = {
    "rows": lambda x: x.copy(),
    "columns": np.asfortranarray,
    "every other row": lambda x: np.repeat(x, 2, axis=0)[::2],
    "every third component": lambda x: np.repeat(x, 3, axis=1)[:, ::3],
    "backwards in time": lambda x: x[::-1].copy()[::-1],
    "backwards in components": lambda x: x[:, ::-1].copy()[:, ::-1],
    "misaligned": lambda x: misaligned(x),
    "byte-swapped": lambda x: x.astype(x.dtype.newbyteorder()),
    "in a record": lambda x: in_a_record(x),
    "read-only": lambda x: read_only(x),
    "columns of a wider table": lambda x: np.hstack([x, x])[:, 6:],
    "lists": lambda x: x.tolist(),
}


def misaligned(x):
    memory = np.empty(x.nbytes + 1, np.uint8)
    array = np.frombuffer(memory.data, np.float64, x.size, 1).reshape(x.shape)
    array[...] = x
    assert not array.flags.aligned or not x.size
    return array


def in_a_record(x):
    records = np.zeros(len(x), [("tag", "i1"), ("value", "f8", 6), ("more", "i4")])
    records["value"] = x
    return records["value"]


def read_only(x):
    x = x.copy()
    x.flags.writeable = False
    return x


@pytest.mark.parametrize("n", [1, 7, 8, 9, 21])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts_of_inputs(compiled, layout, n):
    given = states(n, seed=6)
    expected = one_by_one(compiled.tau, *given)
    assert np.array_equal(compiled.tau(*map(LAYOUTS[layout], given)), expected)
    q, qd, qdd = given
    assert np.array_equal(compiled.tau(q, LAYOUTS[layout](qd), qdd), expected)


@pytest.mark.parametrize(
    "make",
    [
        lambda n: np.empty((n, 6)),
        lambda n: np.empty((6, n)).T,
        lambda n: np.empty((n, 12))[:, ::2],
        lambda n: np.empty((2 * n, 6))[::2],
        lambda n: np.empty((n, 6))[::-1, ::-1],
        lambda n: misaligned(np.empty((n, 6))),
    ],
)
@pytest.mark.parametrize("n", [0, 1, 7, 8, 21])
def test_layouts_of_results(compiled, make, n):
    given = states(n, seed=7)
    out = make(n)
    assert compiled.tau(*given, out=out) is out
    assert np.array_equal(out, one_by_one(compiled.tau, *given))


@pytest.mark.parametrize("n", [1, 5, 8, 13])
def test_nothing_is_written_beside_the_result(compiled, n):
    """Sentinels around the memory of the result, in rows and between the columns."""
    given = states(n, seed=8)
    table = np.full((n + 4, 18), 1e99)
    compiled.tau(*given, out=table[2 : n + 2, 6:12])
    expected = np.full((n + 4, 18), 1e99)
    expected[2 : n + 2, 6:12] = compiled.tau(*given)
    assert np.array_equal(table, expected)
    wide = np.full((n + 4, 18), 1e99)
    compiled.tau(*given, out=wide[2 : n + 2, 1::3])
    expected = np.full((n + 4, 18), 1e99)
    expected[2 : n + 2, 1::3] = compiled.tau(*given)
    assert np.array_equal(wide, expected)


def test_broadcasting(arm):
    q, qd, qdd = states(4, 5, seed=9)
    tau = arm.tau(q, qd, qdd)
    assert tau.shape == (4, 5, 6)
    for i in range(4):
        assert np.array_equal(tau[i], arm.tau(q[i], qd[i], qdd[i]))
    zero = np.zeros(6)
    assert np.array_equal(arm.tau(q, zero, zero), arm.tau(q, 0 * q, 0 * q))
    every = arm.tau(q[:, None, :, :], qd[0], qdd[:1, 0])
    assert every.shape == (4, 1, 5, 6)
    assert np.array_equal(every[2, 0, 3], arm.tau(q[2, 3], qd[0, 3], qdd[0, 0]))


def test_kinds_of_numbers(arm):
    ones = np.ones(6)
    expected = arm.tau(ones, ones, ones)
    for same in (
        [1] * 6,
        (1.0,) * 6,
        np.ones(6, int),
        np.ones(6, np.float32),
        np.ones(6, np.uint8),
    ):
        assert np.array_equal(arm.tau(same, ones, ones), expected)
    assert np.array_equal(arm.tau(ones, ones.astype(np.longdouble), ones), expected)
    assert arm.tau([1] * 6, [1] * 6, [1] * 6).dtype == np.float64


def test_keywords(arm):
    q, qd, qdd = states()
    expected = arm.tau(q, qd, qdd)
    out = np.empty(6)
    assert np.array_equal(arm.tau(qdd=qdd, q=q, qd=qd), expected)
    assert np.array_equal(arm.tau(q, qd, qdd=qdd), expected)
    assert np.array_equal(arm.tau(q, qd, qdd, None), expected)
    assert arm.tau(q, qd, qdd, None, out) is out
    assert np.array_equal(out, expected)
    assert arm.tau(q, qd, qdd, out=None, parameters=None).shape == (6,)


def test_subclasses_of_arrays(arm):
    class Units(np.ndarray):
        pass

    q, qd, qdd = states()
    tau = arm.tau(q.view(Units), qd, qdd)
    assert type(tau) is np.ndarray
    assert np.array_equal(tau, arm.tau(q, qd, qdd))
