"""verify: a right kernel passes, a wrong one is found, by either way through the symbolic route."""

import random

import moro_codegen as mc
import numpy as np
import pytest
import sympy as sp
from arms import NAMES, reference_states
from moro_codegen.verify import TOLERANCE, SymbolicRoute
from robots import random_robot

import moro as mr
from moro.abc import l1, l2, q1, q2


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("kernels")


@pytest.mark.parametrize("name", NAMES)
def test_packaged_arms_verify(name, folder):
    robot = mr.load(name)
    verification = mc.verify(mc.compile(robot, directory=folder), robot)
    assert verification.passed
    assert verification.max_error < 1e-12
    assert verification.route == "closed form"


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("time_limit", [60, 0])
def test_symbolic_route_against_reference(name, time_limit):
    robot, states = mr.load(name), reference_states(name)
    q, qd, qdd, tau = (np.array([s[key] for s in states]) for key in ("q", "qd", "qdd", "tau"))
    route = SymbolicRoute(robot, time_limit)
    assert route.is_closed_form == bool(time_limit)
    scale = np.abs(tau).max(axis=1, keepdims=True)
    np.testing.assert_allclose(route.tau(q, qd, qdd, {}) / scale, tau / scale, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_random_arms_verify(seed, folder):
    rng = random.Random(seed)
    robot = random_robot(rng, rng.randint(1, 5), rng.choice(["dh", "mdh"]))
    robot.name = f"random_{seed}"
    robot.viscous_friction = [1] * robot.dof
    robot.coulomb_friction = [(2, 1)] * robot.dof
    robot.rotor_inertias = [3] * robot.dof
    verification = mc.verify(mc.compile(robot, directory=folder), robot)
    assert verification.passed, verification


def test_run_time_parameters_take_part(folder):
    m2 = sp.Symbol("m_2")
    robot = mr.Robot((l1, 0, 0, q1), (l2, 0, 0, q2), name="with_parameters")
    robot.masses = [1, m2]
    robot.cm_positions = [[-l1 / 2, 0, 0], [-l2 / 2, 0, 0]]
    robot.inertia_tensors = [sp.zeros(3, 3)] * 2
    robot.gravity = [0, -9.81, 0]
    robot.parameters = {m2: 3}
    kernel = mc.compile(robot, directory=folder)
    assert list(kernel.parameters) == ["m_2", "l_1", "l_2"]
    assert mc.verify(kernel, robot).passed


def test_a_kernel_of_another_arm_is_found_out(folder):
    robot = mr.load("puma560")
    kernel = mc.compile(robot, directory=folder)
    masses = robot.masses
    masses[5] *= sp.Rational(1001, 1000)
    robot.masses = masses
    verification = mc.verify(kernel, robot)
    assert not verification.passed
    assert verification.max_error > TOLERANCE
    assert "FAILED" in repr(verification)


@pytest.mark.parametrize("quantity", ["rotor_inertias", "viscous_friction", "coulomb_friction"])
def test_a_kernel_without_friction_or_rotors_is_found_out(quantity, folder):
    robot = mr.load("puma560")
    kernel = mc.compile(robot, directory=folder)
    setattr(robot, quantity, None)
    assert not mc.verify(kernel, robot).passed


def test_nan_does_not_pass():
    error = np.array([0.0, np.nan])
    state = np.zeros((2, 1))
    verification = mc.Verification("x", error, state, state, state, "closed form")
    assert not verification.passed
    assert np.isnan(verification.max_error)
