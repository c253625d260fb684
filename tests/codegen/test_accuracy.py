"""Errors of kernels against 50 digits: bounded, single and batch, double and float."""

import moro_codegen as mc
import mpmath
import numpy as np
import pytest
from arms import NAMES, reference_model, reference_states
from moro_codegen.accuracy import exact_tau, sine_errors, tau_errors

import moro as mr


@pytest.mark.parametrize("name", NAMES)
def test_exact_torques_are_those_from_outside(name):
    s = reference_states(name)[3]
    tau = [float(x) for x in exact_tau(reference_model(name), s["q"], s["qd"], s["qdd"])]
    assert tau == pytest.approx(s["tau"], rel=1e-12, abs=1e-12 * max(map(abs, s["tau"])))


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


@pytest.mark.parametrize("scale", [10.0, 1e3, 9e4, 1e8, 1e15])
@pytest.mark.parametrize("name", ["puma560", "ur5", "panda"])
def test_errors_stay_small_at_large_angles(tmp_path, name, scale):
    """Never worse than 1e-12 of the torques, also where angles are added (parallel axes)."""
    robot = mr.load(name)
    kernel = mc.compile(robot, directory=tmp_path)
    q, qd, qdd = np.random.default_rng(6).uniform(-1, 1, (3, 17, robot.dof))
    q[:9] *= scale
    given = q, qd, qdd
    assert np.array_equal(kernel.tau(*given), [kernel.tau(*x) for x in zip(*given, strict=True)])
    assert tau_errors(kernel, robot.model(), *given).max() < 1e-12


def test_errors_are_seen():
    """A sine that is one unit off is one unit off."""
    x = np.array([0.3, -1.2])
    right = np.array([float(mpmath.sin(mpmath.mpf(v))) for v in x])
    assert sine_errors(right, x, "sin").max() <= 0.5
    wrong = np.nextafter(right, 2)
    assert np.all(np.abs(sine_errors(wrong, x, "sin") - 1) <= 0.5)
