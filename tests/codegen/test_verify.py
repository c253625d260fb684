"""verify: a right kernel passes, a wrong one is found, by either way through the symbolic route."""

import random

import numpy as np
import pytest
import sympy as sp
from arms import NAMES, reference_states
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro.abc import l1, l2, q1, q2
from moro_codegen.verification import CHECKS, TOLERANCE, TOLERANCES, SymbolicRoute


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


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_single_precision(name, backend, folder):
    """By a factor of two below its tolerance, which finds what is wrong by a few thousandths."""
    robot = mr.load(name)
    functions = ("tau", "inertia_matrix", "tau_with_wrench")
    kernel = mc.compile(robot, functions, folder, backend, dtype="float32")
    verification = mc.verify(kernel, robot)
    assert verification.passed
    assert verification.tolerance == TOLERANCES["float32"]
    assert TOLERANCE < verification.max_error < TOLERANCES["float32"] / 2
    assert np.array_equal(verification.q, verification.q.astype(np.float32))
    robot.masses = [m * sp.Rational(1003, 1000) for m in robot.masses]
    assert not mc.verify(kernel, robot).passed


def test_single_precision_with_parameters(folder):
    m = sp.Symbol("m")
    robot = mr.load("two_link")
    robot.name, robot.masses, robot.parameters = "two_link_m", [1, m], {m: sp.Rational(1, 10)}
    kernel = mc.compile(robot, directory=folder, dtype="float32")
    assert mc.verify(kernel, robot).max_error < 2e-6


@pytest.mark.parametrize("quantity", ["rotor_inertias", "viscous_friction", "coulomb_friction"])
def test_a_kernel_without_friction_or_rotors_is_found_out(quantity, folder):
    robot = mr.load("puma560")
    kernel = mc.compile(robot, directory=folder)
    setattr(robot, quantity, None)
    assert not mc.verify(kernel, robot).passed


def test_nan_does_not_pass():
    error = np.array([0.0, np.nan])
    state = np.zeros((2, 1))
    verification = mc.Verification("x", {"tau": error}, state, state, state, "closed form")
    assert not verification.passed
    assert np.isnan(verification.max_error)


# -- every function ----------------------------------------------------------------------------

RESISTED = [name for name in NAMES if name != "ur5"]  # point masses: nothing resists joint 6
GEOMETRY = {"forward_kinematics", "jacobian"}


@pytest.mark.parametrize("name", RESISTED)
@pytest.mark.parametrize("time_limit", [60, 0])
def test_every_function_of_packaged_arms(name, time_limit, folder):
    robot = mr.load(name)
    functions = [f for f in mc.FUNCTIONS if f in CHECKS]
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    verification = mc.verify(kernel, robot, route=SymbolicRoute(robot, time_limit))
    assert list(verification.errors) == functions
    assert verification.max_error < 1e-12
    assert verification.max_error == max(verification.max_errors.values())
    assert verification.passed


@pytest.mark.parametrize("seed", range(4))
def test_every_function_of_random_arms(seed, folder):
    rng = random.Random(seed)
    robot = random_robot(rng, rng.randint(1, 4), rng.choice(["dh", "mdh"]))
    robot.name = f"random_all_{seed}"
    robot.viscous_friction = list(range(1, robot.dof + 1))
    robot.coulomb_friction = [(2, 1)] * robot.dof
    robot.rotor_inertias = [3] * robot.dof
    functions = [f for f in mc.FUNCTIONS if f in CHECKS]
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors


def test_every_wrong_function_is_found_out(folder):
    """A kernel of an arm with other masses, lengths and friction fails in all that it touches."""
    robot = mr.load("puma560")
    functions = [f for f in mc.FUNCTIONS if f in CHECKS]
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    heavier = mr.load("puma560")
    heavier.masses = [m * sp.Rational(1001, 1000) for m in robot.masses]
    errors = mc.verify(kernel, heavier).max_errors
    assert {name for name, error in errors.items() if error > TOLERANCE} == {*functions} - GEOMETRY
    assert all(errors[name] < 1e-14 for name in GEOMETRY)
    stiffer = mr.load("puma560")
    stiffer.viscous_friction = [x + 1 for x in robot.viscous_friction]
    errors = mc.verify(kernel, stiffer).max_errors
    wrong = {name for name, error in errors.items() if error > TOLERANCE}
    assert wrong == {"tau", "tau_with_wrench", "bias", "forward_dynamics", "tau_derivatives",
                     "forward_dynamics_derivatives", "regressor"}  # fmt: skip
    stanford = mc.compile(mr.load("stanford_arm"), functions=GEOMETRY, directory=folder)
    assert min(mc.verify(stanford, robot).max_errors.values()) > TOLERANCE


def test_functions_together_and_of_ones_own(folder):
    robot = mr.load("two_link")
    own = mc.Function("height", robot.T[1, 3])
    together = ("tau_with_wrench", "inertia_matrix", "forward_dynamics")
    functions = (own, together, ("tau", own))
    verification = mc.verify(mc.compile(robot, functions=functions, directory=folder), robot)
    assert verification.passed
    assert list(verification.errors) == ["tau_with_wrench_inertia_matrix_forward_dynamics"]
    assert verification.unchecked == ("height", "tau_height")
    assert "not checked: height, tau_height" in repr(verification)
    verification = mc.verify(mc.compile(robot, functions=(own,), directory=folder), robot)
    assert not verification.passed
    assert np.isnan(verification.max_error)


def test_the_regressor_is_a_function_by_name(folder):
    robot = mr.load("stanford_arm")
    kernel = mc.compile(robot, ("tau", "regressor"), directory=folder)
    Y, p = kernel.regressor(np.zeros(6), np.ones(6), np.ones(6))
    assert Y.shape == (6, len(robot.base_parameters()))
    values = [float(x) for x in robot.base_parameters().values]
    np.testing.assert_allclose(p, values)
    verification = mc.verify(kernel, robot)
    assert verification.passed
    assert not verification.unchecked
