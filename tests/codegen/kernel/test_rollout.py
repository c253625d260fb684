"""Trajectories: their order, their energy, and that dry friction brings arms to rest."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import moro as mr
import moro_codegen as mc

STEPS = ("step_semi_implicit", "step_rk4")
START = np.array([0.3, -0.4]), np.array([0.5, 1.0])


def arm(**drives):
    robot = mr.load("two_link")
    for name, values in drives.items():
        setattr(robot, name, values)
    return robot


@pytest.fixture(scope="module")
def kernel():
    return mc.compile(arm(), (*STEPS, "kinetic_energy", "potential_energy"), backend="numpy")


def after(kernel, step, dt, time=0.5):
    q, qd = kernel.rollout(*START, np.zeros((round(time / dt), 2)), dt, step=step)
    return np.concatenate([q[-1], qd[-1]])


@pytest.mark.parametrize(("step", "order"), [(STEPS[0], 1), (STEPS[1], 4)])
def test_order(step, order, kernel):
    """Half the step makes the error smaller by two to the order."""
    exact = after(kernel, "step_rk4", 1 / 2048)
    errors = [np.abs(after(kernel, step, dt) - exact).max() for dt in (1 / 128, 1 / 256)]
    assert errors[0] / errors[1] == pytest.approx(2**order, rel=0.25)


def test_energy(kernel):
    """It drifts in proportion to the length of the steps, by Runge-Kutta to its power of four."""

    def drift(step, dt):
        q, qd = kernel.rollout(*START, np.zeros((round(1 / dt), 2)), dt, step=step)
        energy = kernel.kinetic_energy(q, qd) + kernel.potential_energy(q)
        return np.abs(energy - energy[0]).max() / np.ptp(kernel.potential_energy(q))

    for step, order, most in ((STEPS[0], 1, 0.1), (STEPS[1], 4, 1e-7)):
        assert drift(step, 1e-3) < most
        assert drift(step, 2e-3) / drift(step, 1e-3) > 0.8 * 2**order


@pytest.mark.parametrize("magnitudes", ["coulomb", "stribeck"])
def test_dry_friction_brings_to_rest_and_holds(magnitudes):
    robot = arm(coulomb_friction=[(4, 3), (2, 2)], gravity=[0, 0, 0])
    if magnitudes == "stribeck":
        robot = mr.Robot.of(stribeck(robot.model()))
    kernel = mc.compile(robot, ("step_semi_implicit",), backend="numpy")
    push = np.array([1.5, -1.0])  # less than friction holds
    q, qd = kernel.rollout(*START, np.tile(push, (2000, 1)), 1e-3)
    assert (qd[-1] == 0).all()
    assert (q[-1] == q[-500]).all()
    q, qd = kernel.rollout(q[-1], qd[-1], np.tile(push - [0, 3], (100, 1)), 1e-3)
    assert qd[-1, 1] < 0  # more than it holds


def stribeck(model):
    half, slow = sp.Rational(1, 2), sp.Rational(1, 10)
    drives = [
        replace(x.drive, static=tuple(c + half for c in x.drive.coulomb), stribeck_velocity=slow)
        for x in model.coordinates
    ]
    coordinates = zip(model.coordinates, drives, strict=True)
    return replace(model, coordinates=tuple(replace(x, drive=d) for x, d in coordinates))


def test_stiff_drives_are_stable():
    """Springs and dampers far beyond what an explicit step of this length bears."""
    kernel = mc.compile(arm(viscous_friction=[10**5, 10**5]), STEPS, backend="numpy")
    _, qd = kernel.rollout(*START, np.zeros((50, 2)), 0.01)
    assert np.abs(qd[-1]).max() < 1e-3
    with np.errstate(all="ignore"):
        explicit, _ = kernel.rollout(*START, np.zeros((50, 2)), 0.01, step="step_rk4")
    assert not np.isfinite(explicit[-1]).all()


def test_many_side_by_side(kernel):
    rng = np.random.default_rng(0)
    q0, tau = rng.uniform(-1, 1, (3, 1, 2)), rng.uniform(-1, 1, (4, 7, 2))
    q, qd = kernel.rollout(q0, START[1], tau, 0.01)
    assert q.shape == qd.shape == (3, 4, 8, 2)
    one, _ = kernel.rollout(q0[2, 0], START[1], tau[1], 0.01)
    np.testing.assert_array_equal(q[2, 1], one)


def test_a_controller(kernel):
    seen = []

    def controller(k, q, qd):
        seen.append(k)
        return -q - qd

    q, qd = kernel.rollout(*START, controller, 0.01, steps=5)
    tau = -q[:-1] - qd[:-1]
    again = kernel.rollout(*START, tau, 0.01)
    np.testing.assert_array_equal(again, (q, qd))
    assert seen == [0, 1, 2, 3, 4]


def test_what_is_wrong_is_said(kernel):
    with pytest.raises(ValueError, match=r"has no 'step': compile\(robot, functions=\('step'"):
        kernel.rollout(*START, np.zeros((3, 2)), 0.01, step="step")
    with pytest.raises(TypeError, match="needs the number of steps"):
        kernel.rollout(*START, lambda k, q, qd: q, 0.01)
    with pytest.raises(ValueError, match=r"tau has shape \(2,\): a row of torques for every step"):
        kernel.rollout(*START, np.zeros(2), 0.01)
    with pytest.raises(ValueError, match="steps is 4, but tau has rows for 3"):
        kernel.rollout(*START, np.zeros((3, 2)), 0.01, steps=4)
