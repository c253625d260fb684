"""One set of arguments, checks and messages: kernels of every backend, and what is emitted."""

import importlib
import inspect
import pickle
import shutil
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from programs import EVERYTHING, PARAMETERS, program

from moro_codegen.calls import Calls, Operand
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function
from moro_codegen.pipeline import build

SQUARES = Function(
    "squares",
    (Argument("x", (3,), "m", "lengths"),),
    (Argument("y", (3,), "m^2", "their squares"),),
    "Squares.",
    lambda system, x: [[a * a for a in x]],
)


def functions(name):
    return program(EVERYTHING, SQUARES, dof=3, parameters=PARAMETERS, name=name)


@pytest.fixture(scope="module", params=["c", "numpy", "cython", "module", "package"])
def arm(request, tmp_path_factory):
    """Kernels, and what was written for those who have no moro, imported by its own name."""
    folder, form = tmp_path_factory.mktemp("arm"), request.param
    if form == "module":
        kernel = build(functions("in_module"), folder / "arm", "numpy")
        found = imported("in_module", kernel.directory)
    elif form == "package":
        kernel = build(functions("in_package"), folder / "arm", "cython")
        # an extension may be loaded once: the kernel has this one
        shutil.copytree(kernel.directory / "in_package_cython", folder / "site")
        found = imported("in_package_kernel", folder / "site")
    else:
        kernel = found = build(functions("all_ops"), folder / "arm", form)
    return SimpleNamespace(
        everything=found.everything, squares=found.squares, signature=kernel.signatures
    )


def imported(name, folder):
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))


Q, QD = np.random.default_rng(3).uniform(-2, 2, (2, 4, 5, 3))
ONE = np.zeros(3)


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The results of the compiled kernel: a matrix, a vector, a scalar."""
    kernel = build(functions("all_ops"), tmp_path_factory.mktemp("expected") / "arm")
    return kernel.everything(Q, QD, [2.5, 0.3])


def close(found, expected):
    for x, y in zip(found, expected, strict=True):
        assert np.shape(x) == np.shape(y)
        np.testing.assert_allclose(x, y, rtol=1e-12)


def test_arguments_of_every_kind(arm, expected):
    for given in ([2.5, 0.3], {"offset": 0.3}, {"mass": np.full(5, 2.5), "offset": [[0.3]]}):
        close(arm.everything(Q, QD, given), expected)
        close(arm.everything(Q, QD, parameters=given, threads=3), expected)
    close(arm.everything(qd=QD.tolist(), q=Q, parameters={"offset": 0.3}), expected)
    close(arm.everything(Q[1, 2], QD[1, 2], {"offset": 0.3}), [x[1, 2] for x in expected])
    close(arm.everything(Q[:0], QD[:0], {"offset": 0.3}), [x[:0] for x in expected])
    out = tuple(np.empty((2, *x.shape))[1] for x in expected)
    assert arm.everything(Q, QD, {"offset": 0.3}, out=out) is out
    close(out, expected)
    wide = np.empty((7, 6))[:, ::-2]
    assert arm.squares(np.tile([1, 2, 3], (7, 1)), [1, 1], wide) is wide
    assert (wide == [1, 4, 9]).all()


MASKED = np.ma.masked_greater(np.arange(3.0), 1.5)
WINDOWS = np.lib.stride_tricks.sliding_window_view(np.zeros(6), 3, writeable=True)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda f: f(ONE), TypeError, "qd missing"),
        (lambda f: f(), TypeError, "q, qd missing"),
        (lambda f: f(ONE, ONE, output=1), TypeError, "no argument 'output', did you mean 'out'"),
        (lambda f: f(ONE, ONE, None, None, 1), TypeError, "takes 4 arguments, found 5"),
        (lambda f: f(ONE, ONE, q=ONE), TypeError, "q is given twice"),
        (lambda f: f(ONE, ONE[:2], [1, 2]), ValueError,
         r"everything: qd \(the vector qd\) must have shape \(3,\) or \(\.\.\., 3\), found \(2,"),
        (lambda f: f(ONE, 1j * ONE, [1, 2]), TypeError, "qd must hold real numbers, found complex"),
        (lambda f: f(ONE, "one", [1, 2]), TypeError, "qd must hold real numbers"),
        (lambda f: f(ONE, [[1], [1, 2]], [1, 2]), ValueError, "qd is no array"),
        (lambda f: f(Q, QD[:3], [1, 2]), ValueError, "axes in front of the components do not mat"),
        (lambda f: f(ONE, ONE), TypeError, "no value and no default for offset"),
        (lambda f: f(ONE, ONE, {"ofset": 1}), TypeError, "'ofset', did you mean 'offset'"),
        (lambda f: f(ONE, ONE, [1]), ValueError, r"must have shape \(2,\)"),
        (lambda f: f(ONE, ONE, [1, 2], threads=0), ValueError, "threads must be at least 1"),
        (lambda f: f(ONE, ONE, [1, 2], np.empty(3)), TypeError, "out must be a tuple of 3 arrays"),
        (lambda f: f(ONE, MASKED, [1, 2]), ValueError, "qd has masked entries"),
        (lambda f: f([MASKED, ONE], ONE, [1, 2]), ValueError, "q has masked entries"),
        (lambda f: f(ONE, ONE, MASKED[1:]), ValueError, "parameters has masked entries"),
        (lambda f: f(ONE, ONE, {"offset": MASKED}), ValueError, "offset has masked entries"),
    ],
)  # fmt: skip
def test_what_is_refused(arm, call, error, message):
    with pytest.raises(error, match=message):
        call(arm.everything)


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        (np.empty(5), ValueError, r"out must have shape \(3,\), found \(5,\)"),
        (np.empty(3, np.float32), TypeError, "out must hold float64, found float32"),
        ([0.0] * 3, TypeError, "out must be a NumPy array"),
        (np.broadcast_to(0.0, 3), ValueError, "out is read-only"),
        (MASKED.copy(), ValueError, "out has masked entries"),
    ],
)
def test_results_refused(arm, out, error, message):
    with pytest.raises(error, match=message):
        arm.squares(ONE, [1, 1], out=out)


def strided(*strides, shape):
    return np.lib.stride_tricks.as_strided(np.zeros(100), shape, [8 * s for s in strides])


def test_results_that_overlap_themselves(arm):
    rows = np.arange(12.0).reshape(4, 3)
    apart = np.empty((4, 3))[::-1], strided(9, 4, shape=(4, 3)), strided(3, 4, shape=(4, 3))
    for out in apart:
        assert arm.squares(rows, [1, 1], out=out) is out
        assert (out == rows**2).all()
    for out in (WINDOWS, WINDOWS[::-1], strided(0, 1, shape=(4, 3)), strided(2, 2, shape=(4, 3))):
        with pytest.raises(ValueError, match="several components in one place of memory"):
            arm.squares(rows, [1, 1], out=out)
    odd = np.zeros(4 * 8 + 32, np.uint8)[: 4 * 8].view(float)
    for given, out in ((odd[:3], odd[1:]), (odd[:3], odd[:3])):
        with pytest.raises(ValueError, match="out overlaps x in memory"):
            arm.squares(given, [1, 1], out=out)


def test_signature_docstring_and_pickle(arm):
    for f in (arm.everything, arm.squares):
        inputs = [a.name for a in arm.signature[f.__name__].given]
        assert list(inspect.signature(f).parameters) == [*inputs, "parameters", "out", "threads"]
        assert "mass  (default 2.5)" in f.__doc__
        again = pickle.loads(pickle.dumps(f))  # noqa: S301
        assert again.__name__ == f.__name__
    assert (again(ONE + 2, [1, 1]) == 4).all()


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_no_parameters(tmp_path, backend):
    kernel = build(program(SQUARES, name="plain"), tmp_path / "plain", backend)
    for none in (None, {}, [], (), np.empty(0)):
        assert (kernel.squares(ONE + 2, none) == 4).all()
        assert (kernel.squares(ONE + 2, parameters=none) == 4).all()
    for some in ({"m": 1}, [1.0], 1.0):
        with pytest.raises(TypeError, match="squares: the model has no run-time parameters"):
            kernel.squares(ONE, some)


def test_direct_calls_come_first():
    """Arrays that fit go to ``direct``; what it does not take, and keywords, to the checks."""
    asked = []

    def direct(x, parameters):
        asked.append(parameters)
        return NotImplemented if x[0] else "direct"

    calls = Calls("f", (Operand("x", (1,)),), (Operand("y", (1,)),), {"m": 2.0}, 1)
    f = calls.of_arrays(lambda x, parameters: x * parameters)
    assert f([3]) == 6
    f = calls.function(calls.in_chunks(lambda x, parameters: x * parameters), "", direct)
    assert f([0]) == "direct"
    assert f([3]) == 6
    assert f([0], parameters=[1]) == 0
    assert asked == [[2.0], [2.0]]
