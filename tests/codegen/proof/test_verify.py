"""verify: a right kernel passes, a wrong one is found, by either way through the symbolic route."""

import random

import numpy as np
import pytest
import sympy as sp
from arms import NAMES, reference_states
from functions import COMMON, SHORT
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro.abc import l1, l2, q1, q2, q3
from moro_codegen.proof.expected import ExpectedDynamics
from moro_codegen.proof.verification import TOLERANCE, TOLERANCES, SymbolicRoute


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
    np.testing.assert_allclose(
        ExpectedDynamics(route, q, qd, qdd, {}).tau / scale, tau / scale, atol=1e-12
    )


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


@pytest.mark.sweep
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
    verification = mc.Verification("x", {"tau": error}, state, state, state, {"tau": "closed form"})
    assert not verification.passed
    assert np.isnan(verification.max_error)


# -- every function ----------------------------------------------------------------------------

RESISTED = [name for name in NAMES if name != "ur5"]  # point masses: nothing resists joint 6
GEOMETRY = {
    "forward_kinematics", "jacobian", "jacobian_rate", "jacobian_rate_qd", "frame_velocity",
    "frame_acceleration", "jacobian_position_hessian",
}  # fmt: skip


@pytest.mark.sweep
@pytest.mark.parametrize("name", RESISTED)
def test_every_function_of_packaged_arms(name, folder):
    robot = mr.load(name)
    functions = list(SHORT)
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    for time_limit in (60, 0):
        verification = mc.verify(kernel, robot, route=SymbolicRoute(robot, time_limit))
        assert list(verification.errors) == functions
        assert verification.max_error < 1e-12
        assert verification.max_error == max(verification.max_errors.values())
        assert verification.passed


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(4))
def test_every_function_of_random_arms(seed, folder):
    rng = random.Random(seed)
    robot = random_robot(rng, rng.randint(1, 4), rng.choice(["dh", "mdh"]))
    robot.name = f"random_all_{seed}"
    robot.viscous_friction = list(range(1, robot.dof + 1))
    robot.coulomb_friction = [(2, 1)] * robot.dof
    robot.rotor_inertias = [3] * robot.dof
    functions = list(SHORT)
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors


def test_every_wrong_function_is_found_out(folder):
    """A kernel of an arm with other masses, lengths and friction fails in all that it touches."""
    robot = mr.load("puma560")
    functions = list(SHORT)
    kernel = mc.compile(robot, functions=functions, directory=folder, backend="numpy")
    heavier = mr.load("puma560")
    heavier.masses = [m * sp.Rational(1001, 1000) for m in robot.masses]
    errors = mc.verify(kernel, heavier).max_errors
    same = GEOMETRY | {"center_of_mass"}  # all masses are larger by the same factor
    assert {name for name, error in errors.items() if error > TOLERANCE} == {*functions} - same
    assert all(errors[name] < 1e-13 for name in same)
    stiffer = mr.load("puma560")
    stiffer.viscous_friction = [x + 1 for x in robot.viscous_friction]
    errors = mc.verify(kernel, stiffer).max_errors
    wrong = {name for name, error in errors.items() if error > TOLERANCE}
    assert wrong == {
        "tau", "tau_with_wrench", "bias", "tau_passivity", "momentum_bias", "forward_dynamics",
        "tau_derivatives", "forward_dynamics_derivatives", "tau_jvp", "tau_vjp",
        "forward_dynamics_jvp", "forward_dynamics_vjp", "step_semi_implicit", "regressor",
        "passivity_regressor", "standard_regressor",
    }  # fmt: skip
    stanford = mc.compile(mr.load("stanford_arm"), GEOMETRY, folder, "numpy")
    assert min(mc.verify(stanford, robot).max_errors.values()) > TOLERANCE


def test_functions_together_and_of_ones_own(folder):
    robot = mr.load("two_link")
    own = mc.Function("height", robot.T[1, 3])
    together = ("tau_with_wrench", "inertia_matrix", "forward_dynamics")
    functions = (own, together, ("tau", own))
    verification = mc.verify(mc.compile(robot, functions=functions, directory=folder), robot)
    assert verification.passed
    joined = "tau_with_wrench_inertia_matrix_forward_dynamics"
    assert list(verification.errors) == [joined, "tau_height"]
    assert verification.unchecked == ("height",)
    assert "not checked: height" in repr(verification)
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


def test_functions_are_known_by_what_they_are_not_by_their_names(folder):
    robot = mr.load("two_link")
    first, second = robot.qs
    own = (
        mc.Function("tau_bias", sp.sqrt(first) + robot.T[1, 3] * first.diff(sp.Symbol("t"))),
        mc.Function("tau_gravity_vector", [second**2, robot.T]),
    )
    kernel = mc.compile(robot, (*own, "tau", ("tau", "bias", own[0])), directory=folder)
    verification = mc.verify(kernel, robot)
    assert verification.unchecked == ("tau_bias", "tau_gravity_vector")
    assert list(verification.errors) == ["tau", "tau_bias_tau_bias"]
    assert verification.passed
    verification = mc.verify(mc.Kernel(kernel.directory), robot, functions=own)
    assert not verification.unchecked
    assert set(verification.errors) == set(kernel.signatures)
    assert verification.passed
    wrong = mc.Function("tau_gravity_vector", [second**2 * 1.001, robot.T])
    verification = mc.verify(kernel, robot, functions=(own[0], wrong))
    assert verification.max_errors["tau_gravity_vector"] > TOLERANCE
    assert verification.max_errors["tau_bias"] < TOLERANCE


def test_names_of_parameters_meet_none_of_the_route(folder):
    """qd_1 was a velocity, sin and sign functions, of what the route is evaluated with."""
    names = dict(zip("mlvcd", sp.symbols("qd_1 sin sign q_1 M"), strict=True))
    robot = mr.Robot((names["l"], 0, 0, q1), (sp.sqrt(names["l"]), 0, 0, q2), name="named")
    robot.masses = [1, names["m"]]
    robot.cm_positions = [[-names["l"] / 2, 0, 0], [0, 0, 0]]
    robot.inertia_tensors = [sp.eye(3) / 10] * 2
    robot.gravity = [0, -9.81, 0]
    robot.viscous_friction, robot.coulomb_friction = [names["v"], 0], [names["c"], names["d"]]
    kernel = mc.compile(robot, ("tau", "tau_derivatives"), directory=folder, backend="numpy")
    for time_limit in (60, 0):
        assert mc.verify(kernel, robot, route=SymbolicRoute(robot, time_limit)).passed


# -- states --------------------------------------------------------------------------------------


def turn_and_slide(limits):
    """M = diag(2 q2^2, 2): singular where nothing is slid out."""
    rows = [(0, -sp.pi / 2, 0, sp.pi / 2 + q1), (0, sp.pi / 2, q2, sp.pi / 2, "p")]
    robot = mr.Robot(*rows, name="turn_and_slide")
    robot.masses, robot.cm_positions = [0, 2], [[0, 0, 0]] * 2
    robot.inertia_tensors = [sp.zeros(3, 3)] * 2
    robot.gravity = [0, sp.Rational(-981, 100), 0]
    robot.joint_limits = [(-sp.pi, sp.pi), limits]
    return robot


def point_masses(*rows, name, masses):
    """Masses at the origins of frames: M is singular where some motion leaves them at rest."""
    robot = mr.Robot(*rows, name=name)
    robot.masses, robot.cm_positions = masses, [[0, 0, 0]] * len(masses)
    robot.inertia_tensors = [sp.zeros(3, 3)] * len(masses)
    robot.gravity = [0, -10, 0]
    return robot


def upright():
    """Joint 1 has nothing to turn where the arm stands up straight, along its axis."""
    rows = (0, sp.pi / 2, 0, q1), (1, 0, 0, q2), (1, 0, 0, q3)
    return point_masses(*rows, name="upright", masses=[1, 1, 1])


def stretched():
    """One mass, at the tip: no torques move it along the arm where that is straight."""
    return point_masses((1, 0, 0, q1), (1, 0, 0, q2), name="stretched", masses=[0, 1])


EVERYTHING = COMMON


@pytest.mark.filterwarnings("error")
def test_states_are_those_that_the_robot_can_be_in(folder):
    robot = turn_and_slide((sp.Rational(1, 10), 1))
    verification = mc.verify(mc.compile(robot, EVERYTHING, folder, "numpy"), robot)
    assert verification.passed, verification.max_errors
    assert len(verification.singular) == 0
    lower, upper = np.array(robot.joint_limits, dtype=float).T
    slid = verification.q[:, 1]
    assert slid.min() == lower[1]
    assert slid.max() == upper[1]
    assert np.abs(verification.q[:, 0]).max() > 20  # no limits were set that keep it from turning
    puma = mr.load("puma560")
    puma.joint_limits = [(-1, 1), (1, 2), (-3, -2), (2, 8), (0.1, 0.2), (-4, 4)]
    q = mc.verify(mc.compile(puma, directory=folder), puma).q
    lower, upper = np.array(puma.joint_limits, dtype=float).T
    assert ((lower <= q) & (q <= upper)).all()
    quarters = np.abs(q % (np.pi / 2)) < 1e-9
    assert quarters[-8:, [0, 1, 3, 5]].all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_singular_postures_inside_the_limits_are_named(backend, folder):
    robot = turn_and_slide((-1, 1))
    verification = mc.verify(mc.compile(robot, EVERYTHING, folder, backend), robot)
    assert verification.passed, verification.max_errors
    assert np.unique(verification.singular[:, 1]).tolist() == [0.0]
    assert "M singular at q = (0, 0)" in repr(verification)
    assert len(verification.errors["forward_dynamics"]) == len(verification.q) - 1
    assert len(verification.errors["tau"]) == len(verification.q)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("make", [upright, stretched])
def test_huge_accelerations_are_not_taken_for_right_ones(make, dtype, folder):
    """cos(pi/2) is 6e-17, not 0: M is not quite singular, and accelerations are 1e32."""
    robot = make()
    functions = ("forward_dynamics", "inertia_matrix")
    kernel = mc.compile(robot, functions, folder, "numpy", dtype)
    verification = mc.verify(kernel, robot, seed=2)
    assert verification.passed, verification.max_errors
    assert 0 < len(verification.singular) < 16
    straight = verification.singular @ ([[0], [1], [0]] if make is upright else [[0], [1]])
    assert np.abs((np.cos if make is upright else np.sin)(straight)).max() < 1e-6
    kernel = mc.compile(robot, ("inertia_matrix",), folder, "numpy", dtype)
    assert len(mc.verify(kernel, robot).singular) == 0  # nothing has to be inverted


def test_nothing_is_verified_where_every_posture_is_singular(folder):
    m = sp.Symbol("m")
    robot = stretched()
    robot.masses, robot.parameters = [1, m], {m: 0}
    kernel = mc.compile(robot, ("forward_dynamics", "tau"), folder, "numpy")
    verification = mc.verify(kernel, robot)
    assert not verification.passed
    assert np.isnan(verification.max_errors["forward_dynamics"])
    assert verification.max_errors["tau"] < TOLERANCE
    assert len(verification.singular) == len(verification.q)


def test_near_singular_postures_are_judged_by_what_a_solver_can_do(folder):
    """At condition numbers of 1e8 and more accelerations have few digits, their torques all."""
    robot = stretched()
    robot.joint_limits = [(-1, 1), (sp.Rational(1, 10**5), sp.Rational(1, 10**4))]
    kernel = mc.compile(robot, ("forward_dynamics", "forward_dynamics_derivatives"), folder)
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors
    assert len(verification.singular) == 0
    robot.masses = [0, sp.Rational(1001, 1000)]
    assert mc.verify(kernel, robot).max_errors["forward_dynamics"] > TOLERANCE


# -- long arms, and others -----------------------------------------------------------------------


def test_a_route_without_closed_forms_has_no_terms():
    route = SymbolicRoute(mr.load("two_link"), time_limit=0)
    assert route.terms is None
    assert SymbolicRoute(mr.load("two_link")).terms > 10


def test_states_are_left_out_when_time_is_short(folder, monkeypatch):
    robot = mr.load("two_link")
    monkeypatch.setattr(SymbolicRoute, "affordable", lambda *_: 5)
    verification = mc.verify(mc.compile(robot, directory=folder), robot)
    assert verification.passed
    assert len(verification.q) == len(verification.errors["tau"]) == 5
    assert verification.left_out == 79
    assert "5 of 84 states" in repr(verification)


def test_another_robot_gets_one_clear_message(folder):
    kernel = mc.compile(mr.load("puma560"), directory=folder)
    with pytest.raises(ValueError, match=r"puma560 has 6 joints, the robot two_link has 2"):
        mc.verify(kernel, mr.load("two_link"))
    robot = mr.load("two_link")
    robot.name, robot.masses = "heavy", [1, sp.Symbol("m")]
    kernel = mc.compile(robot, directory=folder)
    with pytest.raises(ValueError, match=r"heavy takes m, which the robot two_link does not have"):
        mc.verify(kernel, mr.load("two_link"))
