"""Calls of kernels: parameters, several results, what is refused, what a function is."""

import gc
import inspect
import pickle
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from arms import reference_model
from calls import states
from programs import PARAMETERS, program, vector

from moro_codegen import Kernel
from moro_codegen._runtime import Function, Library, gufunc
from moro_codegen.functions.function import Function as Entry
from moro_codegen.pipeline import build
from moro_codegen.program import generate

SIZES = range(101)


# -- run-time parameters -----------------------------------------------------------------------


def test_parameters(hand_made):
    q, qd = np.random.default_rng(10).uniform(-1, 1, (2, 3))
    expected = hand_made.everything(q, qd, parameters=np.array([2.5, 0.75]))

    def same(results):
        return all(np.array_equal(a, b) for a, b in zip(results, expected, strict=True))

    assert hand_made.parameters == dict(PARAMETERS)
    assert same(hand_made.everything(q, qd, parameters=[2.5, 0.75]))
    assert same(hand_made.everything(q, qd, parameters={"offset": 0.75}))
    assert same(hand_made.everything(q, qd, {"offset": 0.75, "mass": 2.5}))
    assert not same(hand_made.everything(q, qd, {"offset": 0.75, "mass": 2}))


def test_parameters_per_sample(hand_made):
    rng = np.random.default_rng(11)
    q, qd = rng.uniform(-1, 1, (2, 9, 3))
    mass = rng.uniform(1, 2, 9)
    results = hand_made.everything(q, qd, parameters={"mass": mass, "offset": 0.5})
    table = np.stack([mass, np.full(9, 0.5)], axis=-1)
    for one, other in zip(results, hand_made.everything(q, qd, table), strict=True):
        assert np.array_equal(one, other)
    single = hand_made.everything(q[4], qd[4], parameters={"mass": mass[4], "offset": 0.5})
    for one, other in zip(results, single, strict=True):
        assert np.array_equal(one[4], other)


def test_parameters_refused(hand_made):
    q, qd = np.zeros((2, 3))
    with pytest.raises(TypeError, match=r"no value and no default for offset.*'offset': \.\.\."):
        hand_made.everything(q, qd)
    with pytest.raises(TypeError, match="no value and no default for offset"):
        hand_made.everything(np.zeros((2, 3)), qd)
    with pytest.raises(TypeError, match="no parameter 'ofset', did you mean 'offset'"):
        hand_made.everything(q, qd, parameters={"ofset": 1})
    with pytest.raises(ValueError, match=r"parameters .* must have shape \(2,\).*found \(3,\)"):
        hand_made.everything(q, qd, parameters=[1, 2, 3])
    with pytest.raises(TypeError, match="mass must hold real numbers"):
        hand_made.everything(q, qd, parameters={"mass": "heavy", "offset": 1})


def test_a_model_without_parameters_takes_none(arm):
    q, qd, qdd = states()
    for parameters in ([1.0], {"m": 1.0}, np.zeros(6)):
        with pytest.raises(TypeError, match="no run-time parameters"):
            arm.tau(q, qd, qdd, parameters=parameters)
    for parameters in (None, [], {}, np.zeros(0)):
        np.testing.assert_array_equal(
            arm.tau(q, qd, qdd, parameters=parameters), arm.tau(q, qd, qdd)
        )


# -- several results ---------------------------------------------------------------------------


def test_several_results(hand_made):
    given = {"parameters": np.array([1.0, 0.5])}
    q, qd = np.random.default_rng(12).uniform(-1, 1, (2, 3))
    results = hand_made.everything(q, qd, **given)
    assert type(results) is tuple
    assert [np.shape(r) for r in results] == [(2, 3), (3,), ()]
    assert type(results[2]) is np.float64
    out = np.empty((2, 3)), np.empty(3), np.empty(())
    assert hand_made.everything(q, qd, **given, out=out) is out
    for a, b in zip(out, results, strict=True):
        assert np.array_equal(a, b)
    out = np.empty((3, 2)).T, np.empty(6)[::2], np.empty(())
    hand_made.everything(q, qd, **given, out=out)
    for a, b in zip(out, results, strict=True):
        assert np.array_equal(a, b)


def test_matrices_of_any_layout(hand_made):
    given = {"parameters": np.array([1.0, 0.5])}
    q, qd = np.random.default_rng(13).uniform(-1, 1, (2, 19, 3))
    results = hand_made.everything(q, qd, **given)
    out = np.empty((3, 2, 19)).T, np.empty((3, 19)).T, np.empty(38)[::-2]
    hand_made.everything(q, qd, **given, out=out)
    for a, b in zip(out, results, strict=True):
        assert np.array_equal(a, b)


def test_several_results_refused(hand_made):
    given = {"parameters": [1.0, 0.5]}
    q, qd = np.zeros((2, 3))
    shared = np.empty(7)
    with pytest.raises(TypeError, match="out must be a tuple of 3 arrays"):
        hand_made.everything(q, qd, **given, out=np.empty((2, 3)))
    with pytest.raises(ValueError, match="out overlaps M in memory"):
        hand_made.everything(
            q, qd, **given, out=(shared[:6].reshape(2, 3), shared[4:7], np.empty(()))
        )
    with pytest.raises(ValueError, match="out overlaps M in memory"):
        hand_made.everything(
            q, qd, parameters=np.ones(2),
            out=(shared[:6].reshape(2, 3), shared[4:7], np.empty(())),
        )  # fmt: skip


# -- what is refused ---------------------------------------------------------------------------

Q = np.zeros(6)


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (np.zeros(5), ValueError, r"q \(joint positions\) must have shape \(6,\) or \(\.\.\., 6\)"),
        (np.zeros(5), ValueError, r"found \(5,\)"),
        (np.zeros(7), ValueError, r"found \(7,\)"),
        (np.zeros((6, 1)), ValueError, r"found \(6, 1\)"),
        (np.zeros((6, 5)), ValueError, r"found \(6, 5\)"),
        (1.0, ValueError, r"found \(\)"),
        ([], ValueError, r"found \(0,\)"),
        ([1, 2, [3]], ValueError, "q is no array"),
        (np.zeros(6, complex), TypeError, "q must hold real numbers, found complex128"),
        ([1j] * 6, TypeError, "complex128"),
        (["1"] * 6, TypeError, "q must hold real numbers, found <U1"),
        (None, TypeError, r"found object \(None\)"),
        ([None] * 6, TypeError, "found object"),
        (np.zeros(6, object), TypeError, "found object"),
        (np.zeros(6, bool), TypeError, "found bool"),
        (np.zeros(6, "m8[s]"), TypeError, "found timedelta64"),
        ({"q": 1}, TypeError, "found object"),
    ],
)  # fmt: skip
def test_inputs_refused(arm, value, error, message):
    with pytest.raises(error, match=message):
        arm.tau(value, Q, Q)
    with pytest.raises(
        error, match=message.replace("q ", "qd ").replace("positions", "velocities")
    ):
        arm.tau(Q, value, Q, out=np.empty(6))


def test_samples_that_do_not_match(arm):
    with pytest.raises(ValueError, match=r"do not match: q \(4, 6\), qd \(5, 6\), qdd \(6,\)"):
        arm.tau(np.zeros((4, 6)), np.zeros((5, 6)), Q)
    with pytest.raises(ValueError, match="do not match"):
        arm.tau(np.zeros((2, 4, 6)), np.zeros((3, 6)), Q)


def frozen():
    out = np.empty(6)
    out.flags.writeable = False
    return out


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        (np.empty(5), ValueError, r"out must have shape \(6,\), found \(5,\)"),
        (np.empty(7), ValueError, r"found \(7,\)"),
        (np.empty((1, 6)), ValueError, r"found \(1, 6\)"),
        (np.empty(6, np.float32), TypeError, "out must hold float64, found float32"),
        (np.empty(6, ">f8"), TypeError, "out must hold float64, found >f8"),
        (np.empty(6, int), TypeError, "out must hold float64, found int64"),
        (np.empty(6, complex), TypeError, "found complex128"),
        (frozen(), ValueError, "out is read-only"),
        ([0.0] * 6, TypeError, "out must be a NumPy array"),
        ((np.empty(6),), TypeError, "out must be a NumPy array"),
        (np.broadcast_to(np.float64(0), 6), ValueError, "out "),
        (np.lib.stride_tricks.as_strided(np.empty(1), (6,), (0,)), ValueError, "one place"),
    ],
)
def test_results_refused(arm, out, error, message):
    with pytest.raises(error, match=message):
        arm.tau(Q, Q, Q, out=out)


def test_results_over_inputs_are_refused(arm):
    memory = np.zeros(40)
    q = memory[:6]
    for out in (q, memory[5:11], memory[:12:2], memory[5::-1]):
        with pytest.raises(ValueError, match="out overlaps q in memory"):
            arm.tau(q, Q, Q, out=out)
    with pytest.raises(ValueError, match="out overlaps qdd in memory"):
        arm.tau(Q, Q, q, out=q)
    for out in (memory[6:12], memory[1:13:2]):
        arm.tau(memory[0:12:2] if out.strides == (16,) else q, Q, Q, out=out)
    table = np.zeros((10, 12))
    arm.tau(table[:, :6], Q, Q, out=table[:, 6:])
    with pytest.raises(ValueError, match="out overlaps q in memory"):
        arm.tau(table[:, :6], Q, Q, out=table[:, 5:11])


def test_calls_refused(arm):
    for call, message in (
        (lambda: arm.tau(Q, Q), "qdd missing"),
        (lambda: arm.tau(), "q, qd, qdd missing"),
        (lambda: arm.tau(Q, Q, Q, None, None, 1), "takes 5 arguments, found 6"),
        (lambda: arm.tau(Q, Q, Q, output=1), "no argument 'output', did you mean 'out'"),
        (lambda: arm.tau(Q, Q, Q, q=Q), "q is given twice"),
    ):
        with pytest.raises(TypeError, match=message):
            call()


# -- what a kernel's function is ---------------------------------------------------------------


def test_documentation(arm):
    assert arm.tau.__name__ == "tau"
    names = list(inspect.signature(arm.tau).parameters)
    assert names == ["q", "qd", "qdd", "parameters", "out", "threads"]
    for text in (
        "Inverse dynamics",
        "q[6]",
        "[rad or m]",
        "joint positions",
        "tau[6]",
        "additions",
    ):
        assert text in arm.tau.__doc__


def test_documentation_of_parameters(hand_made):
    for text in ("mass  (default 2.5)", "offset  (no default)", "M[2][3]  [kg m^2]"):
        assert text in hand_made.everything.__doc__


def test_pickle(compiled):
    q, qd, qdd = states()
    for one in (compiled, compiled.tau):
        again = pickle.loads(pickle.dumps(one))  # noqa: S301
        tau = again.tau if isinstance(again, Kernel) else again
        assert np.array_equal(tau(q, qd, qdd), compiled.tau(q, qd, qdd))


def test_the_library_lives_as_long_as_its_functions(tmp_path):
    kernel = build(generate(reference_model("two_link")), tmp_path / "two_link")
    tau, batch = kernel.tau, kernel.tau.__self__.gufunc
    q = np.ones((9, 2))
    expected = kernel.tau(q, q, q)
    del kernel
    gc.collect()
    assert np.array_equal(tau(q, q, q), expected)
    del tau
    gc.collect()
    assert np.array_equal(batch(q, q, q), expected)


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="needs Linux's /proc/self/maps")
def test_libraries_are_closed(tmp_path):
    """A library that nobody uses any more is no longer mapped."""

    def mapped():
        return str(tmp_path) in Path("/proc/self/maps").read_text()

    kernel = build(generate(reference_model("two_link")), tmp_path / "two_link")
    assert mapped()
    del kernel
    gc.collect()
    assert not mapped()


def test_references_are_kept_right(compiled):
    """Neither leaks nor frees: the counts of what is passed do not change."""
    q, qd, qdd = states()
    batch = states(3)
    out = np.empty(6)
    watched = [q, qd, qdd, out, compiled.tau, *batch]
    before = [sys.getrefcount(x) for x in watched]
    for _ in range(50):
        compiled.tau(q, qd, qdd)
        compiled.tau(q, qd, qdd, out=out)
        compiled.tau(*batch)
        compiled.tau(q.tolist(), qd, qdd)
        with pytest.raises(ValueError, match="shape"):
            compiled.tau(q[:5], qd, qdd)
    assert [sys.getrefcount(x) for x in watched] == before


def test_threads(compiled):
    given = states(200, seed=14)
    expected = compiled.tau(*given)
    wrong = []

    def work():
        for _ in range(20):
            if not np.array_equal(compiled.tau(*given), expected):
                wrong.append("batch")
            single = [compiled.tau(*given[:, k]) for k in range(0, 200, 50)]
            if not np.array_equal(single, expected[::50]):
                wrong.append("single")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_what_cannot_be_loaded(tmp_path, compiled):
    with pytest.raises(FileNotFoundError):
        Library(str(tmp_path / "missing.so"))
    text = tmp_path / "text.so"
    text.write_text("not a library")
    with pytest.raises(OSError, match=r"cannot load .*text\.so"):
        Library(str(text))
    library = Library(str(compiled.library))
    with pytest.raises(OSError, match="does not export nothing"):
        gufunc(library, "nothing", "nothing", "(6)->(6)", 1, 1, "float64")
    with pytest.raises(OSError, match="does not export nothing"):
        Function(
            library, "nothing", None, "nothing", "", [(6,)], [(6,)], None, print, (print, ()), "f8"
        )


def test_too_many_arguments_for_a_straight_call(tmp_path):
    """More pointers than are passed straight: the gufunc takes the call."""
    names = [f"x{i}" for i in range(12)]
    entry = Entry(
        "total",
        tuple(vector(name, 2) for name in names),
        (vector("y", 2),),
        "The sum of all.",
        lambda system, *x: [[sum((v[k] for v in x), system.graph.zero) for k in range(2)]],
    )
    kernel = build(program(entry, name="many"), tmp_path / "many")
    rows = np.random.default_rng(15).uniform(size=(12, 2))
    assert np.allclose(kernel.total(*rows), rows.sum(axis=0), rtol=1e-15, atol=0)
    assert kernel.total(*rows[:, None, :] * np.ones((12, 17, 1))).shape == (17, 2)
