"""Errors of kernels against 50 digits: bounded, single and batch, double and float."""

from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import sympy as sp
from arms import NAMES, reference_model, reference_states

import moro as mr
import moro_codegen as mc
from moro.abc import q1, q2
from moro_codegen.proof.accuracy import exact_tau, sine_errors, tau_errors


@pytest.mark.parametrize("name", NAMES)
def test_exact_torques_are_those_from_outside(name):
    s = reference_states(name)[3]
    tau = [float(x) for x in exact_tau(reference_model(name), s["q"], s["qd"], s["qdd"])]
    assert tau == pytest.approx(s["tau"], rel=1e-12, abs=1e-12 * max(map(abs, s["tau"])))


@pytest.mark.sweep
@pytest.mark.parametrize(("dtype", "roundoff"), [("float64", 2.0**-53), ("float32", 2.0**-24)])
@pytest.mark.parametrize("name", NAMES)
def test_errors_of_tau(tmp_path, name, dtype, roundoff):
    """Typically a few roundings of the largest torque, also in batches, which are the same."""
    robot = mr.load(name)
    kernel = mc.compile(robot, directory=tmp_path, dtype=dtype)
    rng = np.random.default_rng(5)
    given = rng.uniform(-3, 3, (3, 40, robot.dof)).astype(dtype)
    assert np.array_equal(kernel.tau(*given), [kernel.tau(*x) for x in zip(*given, strict=True)])
    errors = tau_errors(kernel, robot.model(), *given)
    assert np.median(errors) < 4 * roundoff
    assert errors.max() < 40 * roundoff


@pytest.mark.sweep
@pytest.mark.parametrize("scale", [10.0, 1e3, 9e4, 1e8, 1e15])
@pytest.mark.parametrize("name", ["puma560", "ur5", "panda"])
def test_errors_stay_small_at_large_angles(tmp_path, name, scale):
    """Never worse than 1e-12 of the torques, also where angles are added (parallel axes)."""
    robot = mr.load(name)
    kernel = mc.compile(robot, directory=tmp_path)
    given = states_far_away(robot, scale)
    assert np.array_equal(kernel.tau(*given), [kernel.tau(*x) for x in zip(*given, strict=True)])
    assert tau_errors(kernel, robot.model(), *given).max() < 1e-12


def states_far_away(robot, scale):
    """Positions, velocities and accelerations: positions of that size in the first half."""
    q, qd, qdd = np.random.default_rng(6).uniform(-1, 1, (3, 17, robot.dof))
    q[:9] *= scale
    return q, qd, qdd


@pytest.mark.parametrize("name", ["puma560", "ur5", "panda"])
def test_errors_of_numpy_stay_small_at_large_angles(tmp_path, name):
    robot = mr.load(name)
    kernel = mc.compile(robot, directory=tmp_path, backend="numpy")
    for scale in (2e3, 1e9):
        given = states_far_away(robot, scale)
        assert tau_errors(kernel, robot.model(), *given).max() < 1e-12
        for k in (0, 8, 12):
            one = kernel.tau(*(x[k] for x in given))
            assert np.abs(one - kernel.tau(*given)[k]).max() < 1e-13 * np.abs(one).max()


def test_errors_of_numpy_in_single_precision_stay_small_at_large_angles(tmp_path):
    robot = mr.load("ur5")
    kernel = mc.compile(robot, directory=tmp_path, backend="numpy", dtype="float32")
    given = [x.astype(np.float32) for x in states_far_away(robot, 1e5)]
    assert tau_errors(kernel, robot.model(), *given).max() < 1e-5


def test_errors_of_lambdified_equations_stay_small_at_large_angles():
    """Torques from M, C and G, for one state and for many: the same bits."""
    robot = mr.load("puma560")
    tau = mc.lambdify(sp.Matrix([equation.lhs for equation in robot.dynamic_model()]), robot)
    given = states_far_away(robot, 1e9)
    many = tau(*given)
    assert np.array_equal(many, [tau(*x) for x in zip(*given, strict=True)])
    lambdified = SimpleNamespace(tau=tau)
    assert tau_errors(lambdified, robot.model(), *given).max() < 1e-12


def test_angles_that_are_not_finite():
    robot = mr.load("two_link")
    f = mc.lambdify(sp.sin(q1 + q2), robot)
    for q in ([np.inf, 0], [np.nan, 1e9], [1e9, -np.inf]):
        assert np.isnan(f(np.array(q)))
        assert np.isnan(f(np.array([q, [1, 2]]))).tolist() == [True, False]


def test_errors_are_seen():
    """A sine that is one unit off is one unit off."""
    x = np.array([0.3, -1.2])
    right = np.array([float(mpmath.sin(mpmath.mpf(v))) for v in x])
    assert sine_errors(right, x, "sin").max() <= 0.5
    wrong = np.nextafter(right, 2)
    assert np.all(np.abs(sine_errors(wrong, x, "sin") - 1) <= 0.5)
